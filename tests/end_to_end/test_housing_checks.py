"""The housing's own checks as the command shows them: health, effective masses, static error, modes that matter."""

import json

import numpy as np
import pytest

COARSE = ("--set", "housing.box.mesh_size=45 mm")


@pytest.fixture(scope="module")
def gearbox_modes(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """The small gearbox's modes in detail, solved once."""
    from gearwhine.cli import run_command

    folder = tmp_path_factory.mktemp("modes") / "out"
    assert run_command(["modes", "small-gearbox", "-q", "--detail", "-o", str(folder), "--json", *COARSE]) == 0
    document: dict = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return document


def test_health_in_json(gearbox_modes: dict) -> None:
    health = gearbox_modes["health"]
    # The mesh is coarse, so that the tests are quick, and that alone is wrong.
    assert [line["name"] for line in health["lines"] if not line["ok"]] == ["discretisation"]
    assert health["ok"] is False
    assert {"name", "value", "bound", "ok", "essential", "why"} <= set(health["lines"][0])
    for line in health["lines"]:
        assert line["ok"] == (line["bound"] is None or line["value"] <= line["bound"])
    assert health["mass_kg"] == pytest.approx(gearbox_modes["mass_kg"], rel=1e-9)
    # Four equal springs at the corners of a box that is symmetric about x = 0 and z = 0.
    assert health["free_motions"] == 0
    assert [foot["share"]["y"] for foot in health["supports"]] == pytest.approx([0.25] * 4)
    assert sum(foot["stiffness_n_per_m"][1] for foot in health["supports"]) == pytest.approx(4 * 5e9)
    x, _, z = health["center_of_gravity_m"]
    assert abs(x) + abs(z) < 1e-6


def test_modes_of_a_coarse_mesh_are_told_with_the_size_of_their_error(gearbox_modes: dict) -> None:
    """Every mode has its estimate, the health's figure is the largest, and the warning has a size that is finer."""
    errors = [mode["discretisation_error"] for mode in gearbox_modes["modes"]]
    (line,) = [line for line in gearbox_modes["health"]["lines"] if line["name"] == "discretisation"]
    (warning,) = [entry for entry in gearbox_modes["warnings"] if entry["name"] == "discretisation"]
    assert max(errors) == line["value"] == warning["largest_error"] > line["bound"]
    assert warning["count"] == np.count_nonzero(np.array(errors) > line["bound"])
    assert warning["mesh_size_m"] < 0.045
    assert "higher ones that belong below the limit may be missing" in warning["message"]


def test_effective_masses_add_up(gearbox_modes: dict) -> None:
    parts = np.array([mode["effective_mass"] for mode in gearbox_modes["modes"]])
    mass = gearbox_modes["effective_mass"]
    assert mass["directions"] == ["x", "y", "z", "rotation_x", "rotation_y", "rotation_z"]
    np.testing.assert_allclose(parts.sum(axis=0), mass["captured"], rtol=1e-12)
    np.testing.assert_allclose(np.add(mass["captured"], mass["missing"]), 1.0, rtol=1e-9)  # no patch is fixed
    assert (parts >= 0.0).all()


def test_static_error_is_told_with_and_without(gearbox_modes: dict) -> None:
    error = gearbox_modes["static_error"]
    assert error["with_attachments"] <= 1e-10
    assert 0.01 < error["without_attachments"] < 1.0
    assert set(error["without_attachments_at"]) == {"input-back", "input-front", "output-back", "output-front"}
    # Five motions under each of four bearings, with three responses each.
    assert error["attachments"] == 60
    assert error["directions"] == ["x", "y", "z", "rotation_x", "rotation_y"]
    for name, parts in error["without_attachments_along"].items():
        assert len(parts) == 5
        assert max(parts) == error["without_attachments_at"][name]


def test_a_housing_that_can_still_slide_is_told(gearwhine) -> None:
    foot = '{name="slide", surface="foot-1", fixed=["y"]}'
    outcome = gearwhine("modes", "steel-box", "-q", *COARSE, "--set", f"housing.support=[{foot}]")
    assert outcome.code == 0
    assert "the housing can still move: x, z, rotation y" in " ".join(outcome.out.split())
    assert "look" in outcome.out


def test_a_bearing_off_its_seat_loads_the_seats_rotation(gearwhine, gearbox_modes: dict) -> None:
    """4 mm outward the seat's rotations join in: another port, other compliance, exact as well."""
    centred = gearbox_modes["static_error"]
    moved = gearwhine("modes", "small-gearbox", "--json", "-q", *COARSE, "--set", "bearing.0.at=16 mm").document[
        "static_error"
    ]
    assert moved["with_attachments"] <= 1e-10
    where, others = "input-back", ("input-front", "output-back", "output-front")
    before, after = centred["without_attachments_along"], moved["without_attachments_along"]
    # Forces along x and y now turn the seat too; motions along z and rotations are the same at any arm.
    assert after[where][:2] != pytest.approx(before[where][:2], rel=1e-6)
    assert after[where][2:] == pytest.approx(before[where][2:], rel=1e-6)
    for name in others:
        assert after[name] == pytest.approx(before[name], rel=1e-6)


@pytest.mark.slow
def test_detail_on_the_screen(gearwhine) -> None:
    outcome = gearwhine("modes", "small-gearbox", "-q", "--detail", "-o", "out", *COARSE)
    for text in ("rigid-body strain", "Effective modal mass", "higher modes", "foot 1", "carry the receptance"):
        assert text in outcome.out
    brief = gearwhine("modes", "small-gearbox", "-q", "-o", "out", *COARSE).out
    assert "checks keep their bounds" in brief
    assert "rigid-body strain" not in brief
    assert "Effective modal mass" not in brief
