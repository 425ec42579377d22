"""The bundled planetary stage: its drawing, `check`, load sharing on its housing, and lines of its motion."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.cli import run_command
from gearwhine.coupling.load_analysis import planetary_load

NAME = "planetary-stage"
COARSE = ("--set", "housing.cad.mesh_size=24 mm", "--set", "housing.frequency_limit=1.6 kHz")


def test_the_script_draws_the_bundled_file(drawing_script: Any, solid_measures: Any, tmp_path: Path) -> None:
    script = drawing_script("make_planetary_stage")
    script.write(tmp_path / "drawn.step")
    bundled, size = solid_measures(script.TARGET), script.Stage()
    assert bundled == pytest.approx(solid_measures(tmp_path / "drawn.step"), rel=1e-6, abs=1e-4)
    assert bundled[2] == pytest.approx(0.0, abs=1e-5)
    assert bundled[3::3] == pytest.approx([-size.half - size.back.length, size.half + size.front.length], abs=1e-5)


def test_check_tells_the_turns_of_the_carrier_in_a_record_and_the_outside_of_the_ring(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run_command(["check", NAME, "-q", "--verbose", "--set", "transient.revolutions=60"]) == 0
    told = capsys.readouterr().out
    # 41 revolutions by 24 / (24 + 90); a root circle of 185 mm with 6.5 mm around it.
    assert "the last 41 recorded, 8.6316 turns of carrier, whole ones in multiples of 19 revolutions" in told
    assert "root 185 mm; outside of the rim 198;" in told


@pytest.mark.slow
@pytest.mark.usefixtures("linear_drawings", "few_slices")
def test_planets_share_the_load_on_the_housing(gearwhine: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planetary_load, "ANGLES", 4)
    out = tmp_path / "out"
    document = gearwhine("load", NAME, "--carrier-turn", "-o", str(out), *COARSE, "-q", "--json").document
    (stage,) = document["planetary"]
    torques = {member["role"]: member["torque_n_m"] for member in stage["members"]}
    assert [torques[role] for role in ("sun", "ring", "carrier")] == pytest.approx([60.0, 225.0, -285.0])
    shares = np.array([planet["load_share"] for planet in stage["planets"]])
    assert shares.sum() == pytest.approx(1.0, abs=1e-9)
    assert shares[0] < 1.0 / 3.0 < shares[1]
    # Tangential forces of both meshes on a planet of 57 mm: what its pin takes of the torque on the carrier.
    tangential = 285.0 / 0.057 * shares
    assert [planet["bearing_force_n"] for planet in stage["planets"]] == pytest.approx(tangential, rel=0.02)
    (turn,) = document["carrier_turns"]
    assert np.sum(turn["sets"][0]["load_share"], axis=0) == pytest.approx(np.ones(4), abs=1e-9)
    assert {"load-planetary-stage.png", "load-carrier-turn-carrier.png"} <= {path.name for path in out.iterdir()}
    assert run_command(["report", str(out), "-q"]) == 0
    page = (out / "report.html").read_text(encoding="utf-8")
    assert f"mesh load factor K_γ {stage['mesh_load_factor']:.4g} of planetary set stage, whose planet " in page
    assert "Front view of the set" in page
    # The error of its pin is a part of the first planet's deflection, and tilts by the carrier are not the housing's.
    assert any(pair["misalignment_by_cause_rad"]["carrier"] for pair in document["gear_pairs"])
