"""Lines of a run near a coupled mode whose free vibration has not died away when the record begins."""

import numpy as np
import pytest

import gearwhine as gw

pytestmark = pytest.mark.usefixtures("mechanisms_left_out")

SETTINGS = {
    "housing.box.mesh_size": "60 mm",
    "transient.revolutions": 4,
    "transient.discard": 1,
    "transient.tolerance": 1e-3,
}


def settling(study: gw.CaseStudy) -> list[dict[str, object]]:
    return [dict(one) for one in study.run().document["warnings"] if one["name"] == "settling"]


@pytest.mark.slow
def test_a_line_near_a_mode_that_still_rings_is_warned_of() -> None:
    """A torque that ripples at a mode of 1 % damping: e^(-ζωt) is left of its free vibration after the time t."""
    study = gw.load("small-gearbox", SETTINGS)
    modes = [one for one in study.system().document["modes"] if 0.005 < one["damping_ratio"] < 0.02]
    mode = min(modes, key=lambda one: abs(one["frequency_hz"] - 1000.0))
    hertz, ratio = mode["frequency_hz"], mode["damping_ratio"]
    decay = 2.0 * np.pi * hertz * ratio / np.sqrt(1.0 - ratio**2)
    turn = 60.0 / 5500.0
    ripple = [{"amplitude": "200 N*m", "frequency": f"{hertz!r} Hz"}]
    (told,) = [one for one in settling(study.changed({"operation.ripple": ripple})) if one["mode_hz"] == hertz]
    assert told["frequency_hz"] == pytest.approx(hertz, rel=0.01)
    assert told["left"] == pytest.approx(np.exp(-decay * turn), rel=1e-3)
    turns = int(np.ceil(np.log(50.0) / decay / turn))
    assert f"transient.discard = {turns} revolutions for 2 %" in str(told["message"])
    longer = {"operation.ripple": ripple, "transient.discard": turns, "transient.revolutions": turns + 3}
    assert not [one for one in settling(study.changed(longer)) if one["mode_hz"] == hertz]
