"""The hand-made faults of tests/faults still fit the code; that tests catch them, faults.py itself shows."""

import sys
from dataclasses import replace
from pathlib import Path

sys.path.append(str(Path(__file__).parent.parent / "benchmarks"))

from faults import misfits, read_faults


def test_every_fault_has_its_place_in_the_code_and_tests_that_exist() -> None:
    faults, tests = read_faults()
    assert misfits(faults, tests) == []
    assert sum(fault.area.startswith("physics") for fault in faults) >= 36
    assert len({(fault.file, fault.before, fault.after) for fault in faults}) == len(faults) >= 266


def test_a_fault_that_does_not_fit_is_told() -> None:
    faults, _ = read_faults()
    first = faults[0]
    lost = replace(first, file="gearwhine/nowhere.py")
    moved = replace(first, before="a piece that stands nowhere")
    broken = replace(first, after=f"{first.before} (")
    told = misfits([lost, moved, broken], {"area": ["tests/test_nowhere.py"]})
    assert len(told) == 4
    for sentence, words in zip(told, ("no test", "no file", "stands 0 times", "fault 1"), strict=True):
        assert words in sentence
