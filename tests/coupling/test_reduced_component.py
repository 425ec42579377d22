"""A box reduced to its seats and sensors, by matrices of files, in the machine that has the same basis inside.

The basis of the box, its modes and residual modes, is written in the coordinates of Craig and Bampton: motions of seats
and sensors, and amplitudes of its modes with these held. Both span the same motions.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from case_housings import full_component
from coupled_cases import coupled
from reduced_frames import FRAME_COORDINATES, MASS, PLACES, frame, write_dmig, write_matrix_market
from scipy import linalg

import gearwhine as gw
from gearwhine.coupling.linear.frequency_response import mesh_error_response
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.reduced_component import component_of_reduced_housing
from gearwhine.housing.reduced import NodeSeat, NodeSensor, ReducedHousing, ReducedMatrices, read_matrix
from gearwhine.housing.reduced import reduced_matrices as matrices_of
from gearwhine.numerics.arrays import FloatArray

LIMIT = 2.0 * np.pi * 3000.0
NUMBERS = {"input-back": 11, "input-front": 12, "output-back": 21, "output-front": 22}
SENSORS = {"top": (31, 2), "right wall": (32, 1)}


@cache
def box() -> tuple[gw.CaseStudy, HousingComponent]:
    study = gw.load("small-gearbox", {"housing.box.mesh_size": "40 mm"})
    assert study.housing is not None
    return study, replace(full_component(study.case, study.housing), displacement_field=None)


@cache
def craig_bampton() -> tuple[FloatArray, FloatArray, tuple[tuple[int, int], ...]]:
    """Mass, stiffness and coordinates of the box: with q = T (b, η), B T = (I, 0) for the motions B q of the ports."""
    _, component = box()
    rows = [component.seats[name].T for name in NUMBERS]
    rows += [component.sensors[name][None] for name in SENSORS]
    ports = np.vstack(rows)
    held = linalg.null_space(ports)
    squares, vectors = np.linalg.eigh(held.T @ component.stiffness @ held)
    inner = held @ vectors
    static = np.linalg.pinv(ports)
    static -= inner @ ((inner.T @ component.stiffness @ static) / squares[:, None])
    basis = np.hstack([static, inner])
    coordinates = [(node, axis) for node in NUMBERS.values() for axis in range(1, 7)] + list(SENSORS.values())
    coordinates += [(1000 + number, 0) for number in range(inner.shape[1])]
    return basis.T @ basis, basis.T @ component.stiffness @ basis, tuple(coordinates)


def reduced(matrices: ReducedMatrices) -> HousingComponent:
    study, component = box()
    assert study.case.housing is not None
    seats = [NodeSeat(seat.name, NUMBERS[seat.name], seat.center) for seat in study.case.housing.seat]
    sensors = []
    for name, (node, axis) in SENSORS.items():
        place = component.sensor_places[name]
        x, y, z = place.position
        direction = tuple(float(one == axis) for one in (1, 2, 3))
        np.testing.assert_allclose(place.direction, direction, atol=1e-9)
        sensors.append(NodeSensor(name, node, (x, y, z), direction))
    return component_of_reduced_housing(ReducedHousing(matrices, seats, sensors, damping_ratio=0.01, limit=LIMIT))


@pytest.mark.parametrize("form", ["free", "large", "mtx", "npz"])
def test_the_lines_are_those_of_the_same_basis_inside(tmp_path: Path, form: str) -> None:
    mass, stiffness, coordinates = craig_bampton()
    mass, stiffness = 0.5 * (mass + mass.T), 0.5 * (stiffness + stiffness.T)
    if form in ("free", "large"):
        path = write_dmig(tmp_path / "box.pch", {"MAAX": mass, "KAAX": stiffness}, coordinates, field=form)
        read = {"mass": read_matrix(path, name="MAAX"), "stiffness": read_matrix(path, name="KAAX")}
        matrices = matrices_of(read)
    else:
        if form == "mtx":
            files = [write_matrix_market(tmp_path / f"{k}.mtx", one) for k, one in (("m", mass), ("k", stiffness))]
            values = [read_matrix(path).values for path in files]
        else:
            np.savez(tmp_path / "box.npz", mass=mass, stiffness=stiffness)
            values = [read_matrix(tmp_path / "box.npz", name=name).values for name in ("mass", "stiffness")]
        matrices = ReducedMatrices(values[0], values[1], coordinates)
    study, component = box()
    ours, theirs = reduced(matrices), component
    known = ours.kinds.count("housing")
    assert known == theirs.kinds.count("housing")
    np.testing.assert_allclose(ours.frequencies_hz, theirs.frequencies_hz, rtol=1e-6)
    frequencies = 2.0 * np.pi * np.arange(100.0, 3000.0, 50.0)
    one, other = (mesh_error_response(coupled(study.case, part), frequencies) for part in (ours, theirs))
    for name, line in other.sensor_acceleration.items():
        np.testing.assert_allclose(one.sensor_acceleration[name], line, rtol=1e-6, atol=1e-6 * np.abs(line).max())


def test_a_free_housing_takes_part_in_gravity() -> None:
    """Participation in a motion of the base is that of the total mass: the squares over all coordinates add to it."""
    seats = [NodeSeat(f"seat {node}", node, place) for node, place in PLACES.items()]
    housing = ReducedHousing(ReducedMatrices(*frame(), tuple(FRAME_COORDINATES)), seats, limit=1e6)
    component = component_of_reduced_housing(housing)
    assert component.participation is not None
    totals = np.sum(component.participation[:, :3] ** 2, axis=0)
    np.testing.assert_allclose(totals, 2.0 * MASS, rtol=1e-10)


def test_a_held_housing_does_not() -> None:
    mass, stiffness, coordinates = craig_bampton()
    assert reduced(ReducedMatrices(mass, stiffness, coordinates)).participation is None


def test_a_machine_on_pedestals_of_arrays_sinks_by_their_compliance() -> None:
    # A force F amid a shaft on two pedestals: each sinks by F / 2k. Alone each has the frequency √(k / m) three times.
    stiffness, mass, force = 2e8, 5.0, 1e3
    arrays = {
        "mass": np.diag([mass] * 3 + [0.05] * 3 + [mass] * 3 + [0.05] * 3),
        "stiffness": np.diag(([stiffness] * 3 + [1e6] * 3) * 2),
    }
    matrices = matrices_of(arrays, nodes={0: range(6), 1: range(6, 12)})
    places = (0.05, 0.35)
    seats = [NodeSeat(f"at {z}", node, (0.0, 0.0, z)) for node, z in enumerate(places)]
    pedestals = ReducedHousing(matrices, seats, limit=LIMIT)
    shaft = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.4, 0.03, material=gw.STEEL)]))
    bearings = [gw.MountedBearing(gw.Bearing.isotropic(f"at {z}", z, 1e8), "shaft", f"at {z}") for z in places]
    machine = gw.Machine([shaft], bearings, housing=pedestals, forces=[gw.ShaftForce("shaft", 0.2, (0.0, -force, 0.0))])
    point = gw.Study(machine).operating_point().dataset
    np.testing.assert_allclose(point["seat_displacement"].values[:, 1], -0.5 * force / stiffness, rtol=1e-9)
    alone = gw.HousingStudy(pedestals)
    document = alone.modes().document["reduced_housing"]
    natural = np.sqrt(stiffness / mass) / (2.0 * np.pi)
    assert sum(abs(mode["frequency_hz"] / natural - 1.0) < 1e-9 for mode in document["modes"]) == 6
    assert alone.compare([2.0 * np.pi * natural]).document["pairs"][0]["error_percent"] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(gw.HousingError, match="expected a housing with its mesh"):
        alone.survey(3)
    with pytest.raises(gw.CouplingError, match=r"result of Housing\.modes\(\), a ReducedHousing, or None"):
        replace(machine, housing=arrays)  # type: ignore[arg-type]
