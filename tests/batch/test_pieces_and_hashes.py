"""How sources are put together in pieces of work, and the hash of what a source is made of."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from tests.kit.batch import sources
from tests.tolerances import assert_close
from vopd.batch import run as pieces
from vopd.batch.folder import file_sha256, input_sha256, named_files
from vopd.batch.run import chunks, even_chunk_bytes


def test_the_largest_pieces() -> None:
    assert (pieces.CHUNK_BYTES, pieces.CHUNK_SOURCES, pieces.LEAST_CHUNKS) == (4_000_000, 200, 4)


@pytest.mark.parametrize(
    ("sizes", "processes", "expected"),
    [
        ([1000] * 8, 1, 2000.0),  # four pieces for each process
        ([1000] * 8, 2, 1000.0),
        ([1000] * 8 + ["9999"], 2, 1000.0),  # flights are pieces by themselves
        ([40_000_000], 1, 4_000_000.0),
        ([40_000_001], 1, 40_000_001 / 11),
        ([40_000_000], 2, 4_000_000.0),  # five for each
        ([40_000_001], 2, 40_000_001 / 12),
        ([10] * 1001, 1, 10_010 / 6),  # 200 decks at most
        ([10] * 1001, 2, 10_010 / 8),
        ([], 3, 1 / 12),
        ([0, 0], 3, 1 / 12),
        (["500"], 3, 1 / 12),
    ],
)
def test_bytes_of_even_pieces_by_hand(
    sizes: list[int | str], processes: int, expected: float
) -> None:
    assert_close("ratio", even_chunk_bytes(sources(*sizes), processes) / expected, 1.0)


@pytest.mark.parametrize(
    ("sizes", "expected"),
    [
        ([10, 10, 10, 10], ["01", "23"]),
        ([10, 10, "10", 10, 10], ["01", "2", "34"]),
        (["10", 10, 10, 10], ["0", "12", "3"]),  # a flight does not count
        ([10, "999", 10, 10], ["0", "1", "2", "3"]),
        (["1", "1"], ["0", "1"]),
        ([30, 10], ["0", "1"]),
        ([10, 30, 10], ["0", "1", "2"]),
        ([39], ["0"]),
        ([0, 0, 0], ["012"]),
    ],
)  # fmt: skip
def test_pieces_of_twenty_bytes(sizes: list[int | str], expected: list[str]) -> None:
    found = [*chunks(sources(*sizes), 20.0)]
    assert ["".join(one.name for one in chunk) for chunk in found] == expected


# Hashes


def hash_of(folder: Path, text: bytes, **files: str) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_text(content)
    (folder / "flight.toml").write_bytes(text)
    return input_sha256(str(folder / "flight.toml"))


def test_the_hash_of_a_project_by_hand(tmp_path: Path) -> None:
    """Its bytes, then the name of each file between zeros and the hash of it, by names."""
    text = b'\xef\xbb\xbfb = "two"\na = ["one", "one", "", "none", "bad\\u0000name"]\n'
    expected = hashlib.sha256(text)
    for name in ("one", "two"):
        expected.update(f"\0{name}\0".encode())
        expected.update(hashlib.sha256(name.encode()).hexdigest().encode())
    assert hash_of(tmp_path / "a", text, one="one", two="two") == expected.hexdigest()
    assert hash_of(tmp_path / "b", text, one="one", two="two") == expected.hexdigest()
    assert hash_of(tmp_path / "c", text, one="two", two="one") != expected.hexdigest()


def test_a_source_that_cannot_be_read_has_no_hash(tmp_path: Path) -> None:
    """None that is not there, a folder, and a loop of links: solving it says what is wrong."""
    (tmp_path / "loop.dat").symlink_to(tmp_path / "loop.dat")
    (tmp_path / "folder.dat").mkdir()
    for name in ("loop.dat", "folder.dat", "missing.dat"):
        assert input_sha256(str(tmp_path / name)) == file_sha256(tmp_path / name) == ""


def test_a_name_that_cannot_be_a_path_hides_no_other(tmp_path: Path) -> None:
    (tmp_path / "z").write_text("")
    text = ('a = "bad\\u0000name"\nb = "%s"\nc = "z"\nd = ""\n' % ("x" * 5000)).encode()
    assert [name for name, _ in named_files(text, tmp_path)] == ["z"]
    inner = tmp_path / "inner"
    inner.mkdir()
    for name in "dbca":
        (inner / name).write_text("")
    found = named_files(b'a = "inner"', tmp_path)
    assert [name for name, _ in found] == ["inner/a", "inner/b", "inner/c", "inner/d"]
