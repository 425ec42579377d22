"""Displacement fields of a housing at an operating point and in adjoint states, and its ports under a machine."""

from collections.abc import Sequence

import numpy as np
from scipy import sparse

from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import Adjoint
from gearwhine.housing import Housing, HousingModes
from gearwhine.housing.material import element_constants
from gearwhine.housing.model.seats import bearing_port
from gearwhine.housing.updating.static_sensitivity import StaticSensitivity


def bearing_ports(housing: Housing, machine: Machine) -> dict[str, sparse.csr_array]:
    """Motions of the places where a machine bears on the housing from the nodes', shape (5, 3 n_nodes) each."""
    ports, centers = housing.seat_ports(), {seat.name: seat.center[2] for seat in housing.seats}
    return {
        one.bearing.name: bearing_port(
            ports[one.seat], machine.shaft(one.rotor).start + one.bearing.at - centers[one.seat]
        )
        for one in machine.bearings
        if one.seat in ports
    }


def housing_fields(housing: HousingModes, point: OperatingPoint, adjoints: Sequence[Adjoint]) -> StaticSensitivity:
    """Return the displacements of the nodes at an operating point and of adjoint states, with their forces."""
    assert point.housing is not None
    described = housing.housing
    every = np.arange(len(housing.mesh.points))
    return StaticSensitivity(
        housing.mesh,
        element_constants(housing.mesh, described.material, described.materials),
        housing.modes.displacement(point.housing, every),
        np.array([housing.modes.displacement(adjoint.housing, every) for adjoint in adjoints]),
        {load.name: load.force for load in point.bearings},
        {load.name: np.array([adjoint.force(load.name) for adjoint in adjoints]) for load in point.bearings},
        np.zeros(3) if point.gravity is None else np.array(point.gravity),
    )
