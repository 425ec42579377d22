"""Lines of sensors by linear response about the mean load, against the periodic motion under the whole tooth law."""

import numpy as np
import pytest
from coupled_cases import coupled
from scipy import linalg

from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.coupling import periodic_response
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.loaded.transmission_error import loaded_transmission_error
from gearwhine.coupling.linear.line_outputs import SensorAmplitude
from gearwhine.coupling.linear.line_sensitivity import LineModel
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.from_case.machine import describe_machine, solve_gears
from gearwhine.numerics.arrays import FloatArray
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import reduce_housing

HELIX = 15.0  # degrees
HARMONICS = 6
SAMPLES = 4096
HELD = np.diag([1.0, 1.0, 1.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def case() -> Case:
    """The small gearbox with wide helical gears, whose mesh stiffness varies by 2 %; all repeats with the mesh."""
    overrides = ["housing.box.mesh_size=60 mm", "rotor.input.unbalance="]
    document = case_document(load_case("small-gearbox", overrides).case)
    for gear, hand in zip(document["gear"], (1.0, -1.0), strict=True):
        # Normal module at the same centre distance.
        gear["module"] = f"{3.175 * np.cos(np.radians(HELIX))} mm"
        gear["helix_angle"] = f"{hand * HELIX} deg"
        gear["face_width"] = "40 mm"
        gear["tip_relief"] = {"amount": "10 um", "length": "1.5 mm"}
    for bearing in document["bearing"]:
        if bearing["name"].endswith("back"):
            bearing["stiffness"] = {"matrix": (1.2e8 * HELD).tolist()}
            bearing["damping"] = {"matrix": (500.0 * HELD).tolist()}
    return parse_case(document)


def static_by_the_motions_law(contact: ToothContact, force: float, phases: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compression and tangent of the tables that the motion follows, in static equilibrium, by Newton's method."""
    compression = loaded_transmission_error(contact, force, phases).transmission_error.copy()
    tangent = np.zeros_like(compression)
    for place, phase in enumerate(phases.tolist()):
        for _ in range(50):
            found, tangent[place] = tooth_force(phase, compression[place], 0.0, *contact.kernel_arguments)[:2]
            step = (force - found) / tangent[place]
            compression[place] += step
            if abs(step) < 1e-17:
                break
    return compression, tangent


@pytest.mark.slow
def test_lines_are_those_of_the_motion_where_the_mesh_hardly_varies(case: Case) -> None:
    """To the force that linear response neglects, by the linear response to a unit mesh force.

    About the mean load the mesh force is F + k(t) (δ − δ_s(t)), linear response has the mean of k. So the force that it
    neglects is (k(t)/k − 1) times the varying part of the mesh force. The motion's tables have the static deflection
    δ_s of the slices, tilt of the bodies included, to half a nanometre in each harmonic; k times that is the rest.
    """
    housing = solve_housing(case)
    pairs = solve_gears(case.parts)
    machine = coupled(case, housing)
    point = describe_machine(case, reduce_housing(case, housing)).operating_point()
    drive, _ = machine.system.contacts
    assert drive.contact.faces is not None
    assert drive.contact.faces.shared.size
    response = periodic_response(machine.system)
    motion = histories(machine, response.record(transient_outputs(machine), SAMPLES))
    force = motion.mesh_force[drive.name]
    assert force.min() > 0.0
    first, mean, varying = 2.0 * np.pi / response.period, float(force.mean()), float(np.abs(force - force.mean()).max())

    model = LineModel(machine, point, pairs, (False,), (False,))
    phases = np.arange(SAMPLES) / SAMPLES
    compression, tangent = static_by_the_motions_law(drive.contact, mean, phases)
    of_slices = loaded_transmission_error(drive.contact, mean, phases).transmission_error
    even, _ = static_by_the_motions_law(drive.contact.under_load(0.0), mean, phases)
    apart, without_tilt = (
        2.0 / SAMPLES * np.abs(np.fft.rfft(one - of_slices))[1 : HARMONICS + 1] for one in (compression, even)
    )
    assert np.linalg.norm(apart) < 0.2 * np.linalg.norm(without_tilt)
    variation = float(np.abs(tangent / model.contact.stiffness[0] - 1.0).max())
    assert variation < 0.03
    parts = {}
    for one in model.lines((HARMONICS + 0.5) * first, HARMONICS):
        assert isinstance(one.output, SensorAmplitude)
        sensor, harmonic = one.output.sensor, round(one.frequency / first)
        row = machine.sensor_rows[sensor]
        by_force = one.frequency**2 * abs(row @ linalg.solve(model._dynamic(one.frequency), drive.direction + 0j))
        of_motion = 2.0 / SAMPLES * np.fft.rfft(motion.sensor_acceleration[sensor])[harmonic]
        difference = abs(-(one.frequency**2) * (row @ one.motion) - of_motion)
        parts[sensor, harmonic] = difference / (
            by_force * (model.contact.stiffness[0] * apart[harmonic - 1] + variation * varying)
        )
    assert len(parts) == 2 * HARMONICS
    assert max(parts.values()) < 1.0, parts
