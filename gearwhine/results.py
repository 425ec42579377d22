"""The results file: labelled arrays with units, as NetCDF4 that any tool opens."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from gearwhine import __version__
from gearwhine.case import Case, dump_case
from housing.netcdf import Variables, write_netcdf

if TYPE_CHECKING:
    import xarray as xr

    from gearwhine.stages.gear_analysis import PairAnalysis
    from gearwhine.stages.housing import SolvedHousing
    from gearwhine.stages.rotors import SolvedRotor
    from gearwhine.stages.run_up import RunSignature
    from gearwhine.stages.signature import SolvedSignature
    from gearwhine.stages.steady import SolvedSteady
    from gearwhine.stages.system import SolvedSystem
    from gearwhine.stages.transient import SolvedTransient

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


@dataclass(frozen=True)
class LabelledArrays:
    """What an analysis found, as arrays with dimensions, units and long names.

    Attributes
    ----------
    variables, coordinates : mapping of str to (dimensions, values, attributes)
    attributes : mapping of str to str
        Of the whole.
    transient : SolvedTransient or None
        Whose histories belong to it; they are written piece by piece.
    """

    variables: Variables
    coordinates: Variables
    attributes: dict[str, str]
    transient: SolvedTransient | None = None

    def write(self, path: Path) -> None:
        """Write a NetCDF4 file that any tool opens."""
        write_netcdf(path, self.variables, self.attributes, coordinates=self.coordinates)
        if self.transient is not None:
            from gearwhine.transient_results import append_histories

            append_histories(path, self.transient)

    def dataset(self) -> xr.Dataset:
        """The same as an xarray dataset."""
        import xarray as xr

        variables, coordinates = dict(self.variables), dict(self.coordinates)
        if self.transient is not None:
            from gearwhine.transient_results import add_histories

            add_histories(self.transient, variables, coordinates)
        return xr.Dataset(variables, coordinates, self.attributes)


def labelled(
    case: Case,
    *,
    housing: SolvedHousing | None = None,
    rotors: tuple[SolvedRotor, ...] = (),
    pairs: tuple[PairAnalysis, ...] = (),
    system: SolvedSystem | None = None,
    transient: SolvedTransient | None = None,
    signature: SolvedSignature | None = None,
    steady: SolvedSteady | None = None,
    run: RunSignature | None = None,
) -> LabelledArrays:
    """What was solved as labelled arrays; the rest is left out, and what would label it is not imported."""
    variables: Variables = {}
    coordinates: Variables = {}
    if housing is not None:
        _housing(housing, variables, coordinates)
    if rotors:
        from gearwhine.rotor_results import write_rotors

        write_rotors(rotors, variables, coordinates)
    if pairs:
        from gearwhine.gear_results import write_gears

        write_gears(pairs, variables, coordinates)
    if system is not None:
        from gearwhine.system_results import write_system

        write_system(system, variables, coordinates)
    if transient is not None:
        from gearwhine.transient_results import write_transient

        write_transient(transient, variables, coordinates)
    if transient is not None and signature is not None:
        from gearwhine.signature_results import write_signature

        write_signature(transient, signature, variables, coordinates)
    if run is not None:
        from gearwhine.signature_results import write_run_signature

        write_run_signature(run, variables, coordinates)
    if steady is not None:
        from gearwhine.steady_results import write_steady

        write_steady(steady, variables, coordinates)
    if case.operation is not None:
        coordinates["speed"] = ((), case.operation.speed * 60.0 / _HERTZ, _unit("rpm", "speed of the first driver"))
    return LabelledArrays(variables, coordinates, file_attributes(case), transient)


def file_attributes(case: Case) -> dict[str, str]:
    """What every file of results says of itself."""
    return {
        "title": case.title,
        "source": f"gearwhine {__version__}",
        "case": dump_case(case),
        "amplitude_convention": "peak: the amplitude of a sine a sin(2 pi f t) is a",
    }


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
