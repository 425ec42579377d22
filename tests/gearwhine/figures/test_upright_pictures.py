"""Which way is up in the pictures of a case."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearwhine.case import load_case
from gearwhine.meshes import Mesh, write_mesh
from gearwhine.solve.housing_modes import solve_housing

CASE = """
title = "block"
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
modes = 7
mesh = {{ file = "block.inp", unit = "mm", shafts_along = "{axis}" }}
"""
GRAVITY = """
[[rotor]]
name = "shaft"
material = "steel"
segments = [{ length = "100 mm", diameter = "20 mm" }]
[operation]
speed = "1000 rpm"
gravity = [0, "-9.81 m/s^2", 0]
"""


@pytest.mark.parametrize(
    ("axis", "more", "up"),
    [("x", "", (0, 1, 0)), ("y", "", (1, 0, 0)), ("z", "", (0, 1, 0)), ("y", GRAVITY, (0, 1, 0))],
)
def test_the_z_of_a_file_stays_up_and_gravity_has_the_last_word(
    tmp_path: Path, block_of: Callable[..., Mesh], axis: str, more: str, up: tuple[int, ...]
) -> None:
    write_mesh(block_of("hexahedron", (100.0, 200.0, 300.0)), tmp_path / "block.inp")
    (tmp_path / "case.toml").write_text(CASE.format(axis=axis) + more, encoding="utf-8")
    solved = solve_housing(load_case(str(tmp_path / "case.toml")).case)
    assert solved.up == pytest.approx(up)
    if axis != "z" and not more:  # 300 mm along the file's z
        assert np.ptp(solved.mesh.points @ np.array(up)) == pytest.approx(0.3)
