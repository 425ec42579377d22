"""Full disks and limits of the system: a sentence that names the place, and old results whole."""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import gearwhine as gw
from gearwhine import workers
from gearwhine.cli import run_command
from gearwhine.failures import WorkersError, explain
from gearwhine.housing.storage.netcdf import reserve_space, write_netcdf
from gearwhine.output import staging
from gearwhine.output.checkpoints import stored_record
from gearwhine.output.manifest import require_as_written


@contextmanager
def room_for(size: int) -> Iterator[None]:
    """Let no file grow beyond a size, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_arrays_without_room_are_an_error_that_names_the_folder(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=str(tmp_path)) as caught, room_for(10_000), staging(tmp_path) as place:
        write_netcdf(place / "results.nc", {"a": ("x", np.zeros(10_000), {})}, {})
    assert explain(caught.value) == (1, f"File too large: {tmp_path}")
    assert not any(tmp_path.iterdir())


def test_long_histories_are_refused_their_room_before_they_are_appended(tmp_path: Path) -> None:
    path = tmp_path / "results.nc"
    write_netcdf(path, {"a": ("x", np.zeros(10), {})}, {})
    before = path.read_bytes()
    with pytest.raises(OSError, match="large"), room_for(100_000):
        reserve_space(path, 200_000)
    assert path.read_bytes()[: len(before)] == before


@pytest.mark.slow
def test_a_command_on_a_full_disk_leaves_the_old_results_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    gw.load("spur-pair").gears().write(tmp_path, pictures=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with room_for(8_000):
        assert run_command(["gears", "spur-pair", "-o", str(tmp_path), "-q"]) == 1
    assert f"File too large: {tmp_path}" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert require_as_written(tmp_path) == []


def test_too_few_open_files_for_the_workers_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers.resource, "getrlimit", lambda _: (40, 40))
    with pytest.raises(WorkersError, match="which may have 40: take fewer --workers, or raise"):
        workers._require_open_files(44)


def test_the_limit_of_open_files_is_raised_where_the_system_lets_us(monkeypatch: pytest.MonkeyPatch) -> None:
    raised = []
    monkeypatch.setattr(workers.resource, "getrlimit", lambda _: (40, 4096))
    monkeypatch.setattr(workers.resource, "setrlimit", lambda _, limits: raised.append(limits))
    workers._require_open_files(1000)
    ((soft, hard),) = raised
    assert soft >= 1000
    assert hard == 4096


def test_a_full_disk_keeps_what_was_marched_and_says_where(tmp_path: Path) -> None:
    def march() -> None:
        with room_for(40_000), stored_record(tmp_path, "key") as blocks:
            for size in (10, 10_000):
                blocks.append({"a": np.zeros(size)})

    with pytest.raises(OSError, match="large") as caught:
        march()
    (place,) = tmp_path.iterdir()
    assert [path.name for path in place.iterdir()] == ["block-00000000.npz"]
    assert explain(caught.value) == (1, f"File too large: {tmp_path}")
    (note,) = caught.value.__notes__
    assert str(place) in note
    with stored_record(tmp_path, "key") as blocks:
        assert len(blocks) == 1
    assert not any(tmp_path.iterdir())
