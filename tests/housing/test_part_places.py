"""Sensors and masses beside the surface of a block of 0.3 m by 0.4 m by 1.2 m, whose diagonal is 1.3 m."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.housing import STEEL, Housing, LumpedMass, Seat, Sensor
from gearwhine.housing.model.seats import sensor_findings
from gearwhine.housing.model_warnings import surface_point_warnings
from gearwhine.meshes import Mesh

BlockOf = Callable[..., Mesh]


def test_what_is_beside_the_surface_is_told_where_it_sits(block_of: BlockOf) -> None:
    """A hundredth of the diagonal, 13 mm, may be between a point and the surface, a tenth is refused."""
    mesh = block_of("tetra", (0.3, 0.4, 1.2))
    places = {"near": (0.1, 0.2, 1.2125), "top": (0.1, 0.2, 1.2140625), "side": (-0.1, 0.05, 0.3)}
    sensors = [Sensor(name, place) for name, place in places.items()]
    masses = [
        LumpedMass("motor", 1.0, position=(0.4, 0.2, 0.6)),
        LumpedMass("pump", 1.0, position=(0.3, 0.2, 0.6)),
    ]
    top, side, motor = surface_point_warnings(mesh, sensors, masses)
    assert top["message"] == ('sensor "top": its position is 14.1 mm from the surface; it sits at (100, 200, 1200) mm')
    assert (top["name"], top["sensor"], top["beside_m"]) == ("sensor place", "top", pytest.approx(0.0140625))
    assert side["message"].endswith("is 100 mm from the surface; it sits at (0, 50, 300) mm")
    assert motor["message"] == ('mass "motor": its position is 100 mm from the surface; it sits at (300, 200, 600) mm')
    assert (motor["name"], motor["mass"], motor["beside_m"]) == ("mass place", "motor", pytest.approx(0.1))

    assert list(sensor_findings(mesh, Sensor("here", (-0.129, 0.05, 0.0)))) == []
    (far,) = sensor_findings(mesh, Sensor("far", (-0.15, 0.05, 0.3)))
    assert (far.part, far.attribute, far.value) == (("sensor", "far"), "position", (-0.15, 0.05, 0.3))
    assert far.expected == "a point on the surface of the housing; this one is 150 mm from it"


def test_a_housing_shows_what_is_on_it(block_of: BlockOf) -> None:
    mesh = block_of("hexahedron", (0.3, 0.4, 1.2))
    housing = Housing(mesh, STEEL)
    nodes = len(np.unique(mesh.points, axis=0))
    assert repr(housing) == f"<Housing: {nodes} nodes; nothing on it>"
    mesh = replace(mesh, surfaces={"bore": mesh.boundary})
    parts = Housing(
        mesh, STEEL, {}, [LumpedMass("pump", 1.0, position=(0.3, 0.2, 0.6))], [Seat("bore", (0.0, 0.0, 0.0))]
    )
    assert repr(parts) == f"<Housing: {nodes} nodes; seats bore; fixtures pump>"
