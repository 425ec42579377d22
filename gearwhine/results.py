"""The results file: labelled arrays with units, as NetCDF4 that any tool opens."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import xarray as xr

from gearwhine import __version__
from gearwhine.case import Case, dump_case
from gearwhine.gear_results import write_gears
from gearwhine.rotor_results import Variables, write_rotors
from gearwhine.signature_results import write_signature
from gearwhine.stages.gear_analysis import PairAnalysis
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.rotors import SolvedRotor
from gearwhine.stages.signature import SolvedSignature
from gearwhine.stages.system import SolvedSystem
from gearwhine.stages.transient import SolvedTransient
from gearwhine.system_results import write_system

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


def write(
    path: Path,
    case: Case,
    housing: SolvedHousing | None,
    rotors: tuple[SolvedRotor, ...],
    pairs: tuple[PairAnalysis, ...],
    system: SolvedSystem | None,
    transient: SolvedTransient | None,
    signature: SolvedSignature | None = None,
) -> None:
    """Write what was solved; the rest is left out."""
    variables: Variables = {}
    coordinates: Variables = {}
    if housing is not None:
        _housing(housing, variables, coordinates)
    if rotors:
        write_rotors(rotors, variables, coordinates)
    if pairs:
        write_gears(pairs, variables, coordinates)
    if system is not None:
        write_system(system, variables, coordinates)
    if transient is not None:
        _transient(transient, variables, coordinates)
    if transient is not None and signature is not None:
        write_signature(transient, signature, variables, coordinates)
    if case.operation is not None:
        coordinates["speed"] = ((), case.operation.speed * 60.0 / _HERTZ, _unit("rpm", "speed of the first driver"))
    attributes = {
        "title": case.title,
        "source": f"gearwhine {__version__}",
        "case": dump_case(case),
        "amplitude_convention": "peak: the amplitude of a sine a sin(2 pi f t) is a",
    }
    dataset = xr.Dataset(variables, coordinates, attributes)
    dataset.to_netcdf(path, engine="h5netcdf")


def write_shapes(path: Path, housing: SolvedHousing) -> None:
    """Write the mesh with every mode shape as a point array, for ParaView and its like."""
    import meshio

    shapes = {
        f"mode {number:02d}, {frequency:.1f} Hz": shape
        for number, (frequency, shape) in enumerate(
            zip(housing.modes.frequencies_hz, housing.modes.shapes, strict=True), start=1
        )
    }
    cells = [(block.kind, block.nodes) for block in housing.mesh.blocks]
    # Uncompressed: packing shapes takes ten times as long as writing them, and saves a tenth.
    content = meshio.Mesh(housing.mesh.points, cells, point_data=shapes)
    meshio.write(path, content, file_format="vtu", compression=None)


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}


def _housing(solved: SolvedHousing, variables: Variables, coordinates: Variables) -> None:
    numbers = np.arange(1, len(solved.modes.frequencies) + 1)
    survey = (solved.survey.matrix @ solved.modes.shapes.reshape(len(numbers), -1).T).T
    coordinates["housing_mode"] = ("housing_mode", numbers, _unit("1", "number of the housing mode"))
    coordinates["component"] = ("component", ["x", "y", "z"], {})
    mode = "housing_mode"
    variables["housing_frequency"] = (mode, solved.modes.frequencies_hz, _unit("Hz", "housing natural frequency"))
    variables["housing_damping_ratio"] = (mode, solved.total_damping_ratios, _unit("1", "housing modal damping ratio"))
    if solved.strengths is not None:
        strength = solved.strengths.acceleration
        variables["housing_strength"] = (mode, strength, _unit("kg-1", "lateral acceleration strength"))
    variables["survey_position"] = (
        ("survey_point", "component"),
        solved.survey.positions,
        _unit("m", "survey points on the housing's outer faces"),
    )
    variables["survey_normal"] = (("survey_point", "component"), solved.survey.normals, _unit("1", "outward normals"))
    variables["survey_shape"] = (
        (mode, "survey_point", "component"),
        survey.reshape(len(numbers), -1, 3),
        _unit("kg-0.5", "mass-normalised mode shapes at the survey points"),
    )


def _transient(solved: SolvedTransient, variables: Variables, coordinates: Variables) -> None:
    """Histories in single precision, seven digits, since there are many; spectra in double."""
    named = solved.histories
    coordinates["time"] = ("time", named.times, _unit("s", "time from static equilibrium"))
    if named.sensor_acceleration:
        coordinates["sensor"] = ("sensor", list(named.sensor_acceleration), {})
        variables["sensor_acceleration"] = (
            ("sensor", "time"),
            np.array(list(named.sensor_acceleration.values()), dtype=np.float32),
            _unit("m/s2", "acceleration along the sensor"),
        )
    if named.bearing_force:
        coordinates["bearing"] = ("bearing", list(named.bearing_force), {})
        coordinates["axis"] = ("axis", ["x", "y"], {})
        variables["bearing_force"] = (
            ("bearing", "time", "axis"),
            np.array(list(named.bearing_force.values()), dtype=np.float32),
            _unit("N", "force of the shaft on its bearing"),
        )
    if named.mesh_force:
        coordinates["contact"] = ("contact", list(named.mesh_force), {})
        for name, values, unit, what in (
            ("mesh_force", named.mesh_force, "N", "gear-mesh force along the line of action"),
            ("mesh_compression", named.mesh_compression, "m", "compression of the mesh along the line of action"),
        ):
            variables[name] = (
                ("contact", "time"),
                np.array(list(values.values()), dtype=np.float32),
                _unit(unit, what),
            )
        coordinates["gear"] = ("gear", list(named.gear_motion), {})
        motion = np.array(list(named.gear_motion.values()), dtype=np.float32)
        variables["gear_displacement"] = (
            ("gear", "time", "axis"),
            motion[:, :, :2],
            _unit("m", "motion of the gear's centre"),
        )
        variables["gear_rotation"] = (
            ("gear", "time"),
            motion[:, :, 2],
            _unit("rad", "rotation of the gear beside the steady one"),
        )
        coordinates.setdefault("axis", ("axis", ["x", "y"], {}))
    for name, spectra, dimension, unit, what in (
        ("sensor_spectrum", solved.sensor_spectra, "sensor", "m/s2", "peak amplitude of acceleration"),
        ("mesh_force_spectrum", solved.force_spectra, "contact", "N", "peak amplitude of the gear-mesh force"),
    ):
        if not spectra:
            continue
        first = next(iter(spectra.values()))
        coordinates["frequency"] = ("frequency", first.frequencies, _unit("Hz", "frequency"))
        amplitude = np.array([spectrum.amplitude for spectrum in spectra.values()])
        phase = np.array([spectrum.phase for spectrum in spectra.values()])
        attributes = _unit(unit, what) | {"window": first.window}
        variables[name] = ((dimension, "frequency"), amplitude, attributes)
        variables[f"{name}_phase"] = ((dimension, "frequency"), phase, _unit("rad", f"phase of {what[18:]}"))
