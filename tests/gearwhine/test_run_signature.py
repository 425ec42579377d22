"""Orders along a run, whatever the tooth numbers: windows need no whole turns of every shaft."""

import numpy as np
import pytest

from gearwhine.case import Case, load_case, mesh_frequencies
from gearwhine.figures.transient import _speed
from gearwhine.stages.gears import solve_gears
from gearwhine.stages.machine import build_machine
from gearwhine.stages.run_up import run_signature_document, run_signature_warnings, solve_run_signature
from gearwhine.stages.transient import SolvedTransient, solve_transient

FEW = ("rotor.input.modes=2", "rotor.output.modes=2", "transient.tolerance=1e-2", "transient.discard=0")


def run_up(teeth: tuple[int, int], seconds: float) -> tuple[Case, SolvedTransient]:
    """The spur pair with other tooth numbers, of the same sum, along a run-up to 4500 rpm."""
    changes = (
        *FEW,
        f"gear.0.teeth={teeth[0]}",
        f"gear.1.teeth={teeth[1]}",
        f"transient.run={{ from = '1500 rpm', to = '4500 rpm', time = '{seconds} s' }}",
        "transient.revolutions=",
    )
    case = load_case("spur-pair", changes).case
    machine = build_machine(case, None, solve_gears(case))
    return case, solve_transient(case, machine, mesh_frequencies(case))


@pytest.mark.parametrize("teeth", [(27, 29), (26, 30)])
def test_tooth_numbers_without_common_turns_have_their_orders(teeth: tuple[int, int]) -> None:
    case, solved = run_up(teeth, 0.6)
    found = solve_run_signature(case, solved)
    assert found is not None
    rows = run_signature_document(found)["orders"]
    assert {row["order"] for row in rows} >= {teeth[0], 2 * teeth[0]}
    # 30 turns do not part one shaft from another that turns 27/29 or 26/30 times: it is said.
    (told,) = run_signature_warnings(case, solved)
    assert told["name"] == "run signature"
    assert "output" in told["message"]
    for orders in found.orders.values():
        assert len(orders.speeds) >= 8
        assert np.all(np.diff(orders.speeds) > 0.0)


def test_a_run_too_short_for_orders_says_so() -> None:
    case, solved = run_up((27, 29), 0.06)
    assert solve_run_signature(case, solved) is None
    (told,) = run_signature_warnings(case, solved)
    assert "no spectra and orders along the run" in told["message"]


def test_captions_of_a_run_name_its_speeds() -> None:
    assert _speed(*run_up((27, 29), 0.06)) == "1500 to 4500 rpm, averaged over the run"
