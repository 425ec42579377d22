"""A transient that is killed goes on from what it wrote, to the same result bit for bit."""

import multiprocessing
import os
import random
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

import gearwhine as gw
from gearwhine.case import load_case
from gearwhine.coupling.analyses.transient import SolvedTransient, integrate_blocks, solve_transient
from gearwhine.output.checkpoints import BlockFiles, stored_record
from gearwhine.output.files import held_lock
from gearwhine.solve.machine import plan_of

KILLS = 6
BLOCK = 1024  # samples: some eighty checkpoints
FORK = multiprocessing.get_context("fork")
Solve = Callable[..., SolvedTransient]


@pytest.fixture(scope="module")
def solve() -> Solve:
    """The transient of a pair of gears on two rotors, five revolutions of which three count."""
    settings = ["transient.revolutions=5", "transient.discard=2", "rotor.input.modes=6", "rotor.output.modes=6"]
    case = load_case("spur-pair", settings).case
    machine = coupled(case)

    def solve(**options: Any) -> SolvedTransient:
        return solve_transient(machine, plan_of(case), samples_per_block=BLOCK, **options)

    return solve


def bits(solved: SolvedTransient) -> list[bytes]:
    """All that a transient says, but for the time it took."""
    figures = {name: value for name, value in vars(solved.result).items() if name not in ("seconds", "energy")}
    spectra = [*solved.sensor_spectra.values(), *solved.force_spectra.values()]
    parts = [piece.columns for piece in solved.record.pieces()] + [piece.times for piece in solved.record.pieces()]
    parts += [array for spectrum in spectra for array in (spectrum.frequencies, spectrum.amplitude, spectrum.phase)]
    parts += [np.asarray(value) for value in (*figures.values(), *vars(solved.result.energy).values())]
    return [part.tobytes() for part in parts]


def block_count(folder: Path) -> int:
    return len(list(folder.glob(".resume-*/block-*.npz")))


def wait_for(met: Callable[[], bool]) -> None:
    limit = time.monotonic() + 60.0
    while not met():
        assert time.monotonic() < limit, "waited for too long"
        time.sleep(1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("record_bytes", [1 << 30, 1 << 20], ids=["whole", "decimated"])
def test_six_kills_leave_no_trace(solve: Solve, tmp_path: Path, record_bytes: int) -> None:
    expected = solve(record_bytes=record_bytes)
    assert expected.record.sampling.is_long == (record_bytes < 1 << 30)
    total = len(expected.record.blocks)
    assert total > 4 * KILLS

    def march() -> None:
        with stored_record(tmp_path, "key") as blocks:
            solve(record_bytes=record_bytes, keep=lambda key: blocks)
            os._exit(1)  # not reached: killed before

    chance = random.Random(record_bytes)
    first_written = None
    for kill in range(KILLS):
        child = FORK.Process(target=march)
        child.start()
        stop = (kill + 1) * (total - 4) // KILLS - chance.randrange(3)
        wait_for(lambda stop=stop: block_count(tmp_path) >= stop)  # type: ignore[misc]
        time.sleep(chance.uniform(0.0, 0.02))  # anywhere in a block, or in the writing of one
        assert child.pid is not None
        os.kill(child.pid, signal.SIGKILL)
        child.join()
        assert child.exitcode == -signal.SIGKILL
        (block,) = tmp_path.glob(".resume-*/block-00000000.npz")
        first_written = first_written or block.stat().st_mtime_ns
        assert block.stat().st_mtime_ns == first_written  # gone on, not begun again

    with stored_record(tmp_path, "key") as blocks:
        assert 0 < len(blocks) < total
        assert bits(solve(record_bytes=record_bytes, keep=lambda key: blocks)) == bits(expected)
    assert not list(tmp_path.iterdir())


def some(number: int) -> dict[str, np.ndarray]:
    return {"columns": np.full((3, 2), float(number)), "time": np.asarray(0.1 * number)}


def stop(folder: Path, key: str, count: int, error: type[BaseException] = KeyboardInterrupt) -> BaseException:
    """A run that writes some blocks more and then ends badly."""
    raised = error()
    with suppress(error), stored_record(folder, key) as blocks:
        for number in range(len(blocks), len(blocks) + count):
            blocks.append(some(number))
        raise raised
    return raised


def test_blocks_come_back_until_the_work_is_done(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "the same command goes on" in stop(out, "a", 2).__notes__[0]
    stop(out, "a", 1, ValueError)
    with stored_record(out, "a") as blocks:
        assert len(blocks) == 3
        assert [float(blocks[n]["columns"][0, 0]) for n in range(3)] == [0.0, 1.0, 2.0]
        assert blocks[2]["time"].shape == ()
    assert not list(out.iterdir())


def test_a_motion_stays_for_pictures_unless_it_is_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with stored_record(tmp_path, "a", stays=True) as blocks:
        blocks.append(some(4))
    with stored_record(tmp_path, "a") as blocks:
        assert float(blocks[0]["columns"][0, 0]) == 4.0
    assert not list(tmp_path.iterdir())

    monkeypatch.setattr("gearwhine.output.checkpoints._MOST_KEPT", 10.0)
    with stored_record(tmp_path, "a", stays=True) as blocks:
        blocks.append(some(4))
    assert not list(tmp_path.iterdir())


def test_pictures_are_drawn_of_the_motion_that_a_run_without_them_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = gw.load("spur-pair", {"transient.revolutions": 4, "transient.discard": 1})
    first = study.run_into(tmp_path, pictures=False).document
    left = []

    def rest(*arguments: Any, **options: Any) -> Iterator[Any]:
        left.extend(integrate_blocks(*arguments, **options))
        return iter(left)

    monkeypatch.setattr("gearwhine.coupling.analyses.transient.integrate_blocks", rest)
    drawn = study.run_into(tmp_path).document
    assert not left
    assert all(drawn[part] == first[part] for part in ("steps", "energy_j", "gear_pairs", "bearings"))
    assert any(tmp_path.glob("*.png"))
    assert not any(tmp_path.glob(".resume-*"))


def test_another_march_and_a_fresh_one_begin_anew(tmp_path: Path) -> None:
    stop(tmp_path, "a", 2)
    with stored_record(tmp_path, "b") as blocks:
        assert len(blocks) == 0
        assert len(list(tmp_path.iterdir())) == 1  # what the other kept is cleared away
    stop(tmp_path, "a", 2)
    with stored_record(tmp_path, "a", fresh=True) as blocks:
        assert len(blocks) == 0


def test_a_march_that_runs_is_left_alone(tmp_path: Path) -> None:
    stop(tmp_path, "a", 2)
    (kept,) = tmp_path.iterdir()
    with held_lock(kept):
        with stored_record(tmp_path, "b"):
            assert kept.exists()
        with stored_record(tmp_path, "a") as blocks:
            assert len(blocks) == 0
            blocks.append(some(7))
        assert len(BlockFiles(kept)) == 2
    assert list(tmp_path.iterdir()) == [kept]


def test_nothing_is_left_of_a_march_that_never_began(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert not hasattr(stop(out, "a", 0), "__notes__")
    assert not out.exists()


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 half a file"])
def test_the_march_goes_on_before_a_damaged_block(tmp_path: Path, damage: bytes) -> None:
    stop(tmp_path, "a", 4)
    (kept,) = tmp_path.iterdir()
    (kept / "block-00000003.npz").write_bytes(damage)
    (kept / "block-00000004.part").write_bytes(damage)
    with stored_record(tmp_path, "a") as blocks:
        assert len(blocks) == 3
        blocks.append(some(3))
        assert float(blocks[3]["columns"][0, 0]) == 3.0
    assert not list(tmp_path.iterdir())


def test_an_interruption_while_a_block_is_put_in_its_place_keeps_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(folder: Path) -> None:
        raise KeyboardInterrupt

    # Between the block's renaming and its being counted.
    monkeypatch.setattr("gearwhine.output.checkpoints._force_names", interrupted)
    with pytest.raises(KeyboardInterrupt) as stop, stored_record(tmp_path, "key") as blocks:
        blocks.append({"columns": np.ones(3)})
    assert "goes on from there" in stop.value.__notes__[0]
    with stored_record(tmp_path, "key") as blocks:
        assert len(blocks) == 1


@pytest.mark.parametrize("number", range(4))
def test_damage_to_any_block_is_found_and_its_span_marched_again(tmp_path: Path, number: int) -> None:
    """Blocks before the damage count; those behind it are written anew."""
    stop(tmp_path, "a", 4)
    (block,) = tmp_path.glob(f".resume-*/block-{number:08d}.npz")
    whole = block.read_bytes()
    data = np.full((3, 2), float(number)).tobytes()
    for place in range(0, len(whole), 7):
        damaged = bytearray(whole)
        damaged[place] ^= 0x10
        block.write_bytes(damaged)
        # Dates and attributes in the file's frame may change; the arrays may not.
        count = len(BlockFiles(block.parent))
        assert count == number or (
            count == 4 and data in damaged and BlockFiles(block.parent)[number].keys() == {"columns", "time"}
        )
    place = whole.index(data) + 1 if number else whole.index(b"(3, 2)")
    damaged = bytearray(whole)
    damaged[place] ^= 0x10
    block.write_bytes(damaged)
    stop(tmp_path, "a", 4 - number)
    with stored_record(tmp_path, "a") as blocks:
        assert [float(blocks[n]["columns"][0, 0]) for n in range(len(blocks))] == [0.0, 1.0, 2.0, 3.0]
