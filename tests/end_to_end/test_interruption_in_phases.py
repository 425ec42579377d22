"""Ctrl-C in long phases of a command: it ends by exit code 130, and leaves nothing half-written."""

import json
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from lopsided_case import FEW_WHIRLS

pytestmark = pytest.mark.slow

COARSE = ("--set", "housing.box.mesh_size=60 mm", "--set", "housing.frequency_limit=2.2 kHz")
SHORT = (*COARSE, "--set", "transient.revolutions=2", "--set", "transient.discard=1", "--set", FEW_WHIRLS)
SOUND = ("--set", "acoustics.mesh_size=45 mm", "--set", "acoustics.highest_frequency=2 kHz")
PHASES = (
    ("run", "small-gearbox", "meshing the housing", COARSE),
    ("modes", "steel-box", "counting the modes below the limit", COARSE),
    ("run", "small-gearbox", "drawing", SHORT),
    ("sound", "steel-box", "sound of the housing's modes", SOUND),
)


@pytest.mark.parametrize(("command", "case", "words", "options"), PHASES)
def test_an_interruption_in_a_phase_ends_the_command(
    start_process: Callable[..., "subprocess.Popen[str]"],
    tmp_path: Path,
    command: str,
    case: str,
    words: str,
    options: tuple[str, ...],
) -> None:
    process = start_process(command, case, *options, "-o", "out")
    assert process.stderr is not None
    seen = []
    for line in process.stderr:
        seen.append(line)
        if words in line:
            break
    else:
        pytest.fail(f"{words!r} is not among the progress: {''.join(seen)}")
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    assert "interrupted; the output folder holds no half-written file" in errors
    assert "Traceback" not in errors
    out = tmp_path / "out"
    # Of a run that has its modes these stay, whole, and the blocks of its motion.
    for path in out.rglob("*") if out.exists() else ():
        assert not path.name.startswith((".partial-", ".complete-"))
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        assert path.is_dir() or path.suffix in (".json", ".nc", ".npz")
