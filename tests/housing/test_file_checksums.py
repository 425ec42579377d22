"""Digests at the end of files."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearwhine.housing.storage.atomic_file import checksum_holds, write_checksum

anywhere = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@anywhere
@given(content=st.binary(max_size=300), data=st.data())
def test_damage_before_the_seal_is_told(content: bytes, data: st.DataObject, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(content)
    assert checksum_holds(path) is None
    write_checksum(path)
    assert checksum_holds(path)
    whole = path.read_bytes()
    assert whole.startswith(content)
    if content:
        damaged = bytearray(whole)
        damaged[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
        path.write_bytes(damaged)
        assert checksum_holds(path) is False
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole) - 1))])
    assert not checksum_holds(path)


def test_a_digest_is_of_all_pieces(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(bytes(3 << 20))
    write_checksum(path)
    whole = bytearray(path.read_bytes())
    whole[(3 << 20) - 1] = 1
    path.write_bytes(whole)
    assert checksum_holds(path) is False


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        checksum_holds(tmp_path / "none")
