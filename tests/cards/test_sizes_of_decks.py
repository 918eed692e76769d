"""Which decks are read together, by sizes of files: 256 KiB is small, 2 MiB or 64 is a group."""

from __future__ import annotations

from pathlib import Path

import pytest

from vopd.cards.read import DeckFile, groups_of_decks

SMALL = 262_144
GROUPS = {  # sizes of files in order: how many are read together
    (): [],
    (SMALL,): [1],
    (SMALL + 1,): [1],
    (SMALL,) * 20: [8, 8, 4],
    (SMALL,) * 7 + (SMALL - 1, 1, 1): [9, 1],
    (1, SMALL + 1, 1, 1): [1, 1, 2],
    (SMALL + 1, SMALL + 1): [1, 1],
    (*(SMALL,) * 5, SMALL + 1, *(SMALL,) * 5): [5, 1, 5],
    (*(SMALL,) * 5, 4 * SMALL, *(SMALL,) * 9): [5, 1, 8, 1],
    (1,) * 130: [64, 64, 2],
    (1,) * 64: [64],
    (*(1,) * 64, SMALL + 1): [64, 1],
    (0, 0): [2],
}


@pytest.mark.parametrize("sizes", GROUPS, ids=lambda sizes: f"{len(sizes)} files")
def test_how_many_decks_are_read_together(sizes: tuple[int, ...], tmp_path: Path) -> None:
    """In order, each once; the count of bytes and of files begins anew with every group."""
    for size in set(sizes):
        with (tmp_path / str(size)).open("wb") as file:
            file.truncate(size)
    decks = [DeckFile(f"{k}", str(tmp_path / str(size))) for k, size in enumerate(sizes)]
    groups = list(groups_of_decks(iter(decks)))
    assert [len(group) for group in groups] == GROUPS[sizes]
    assert [deck for group in groups for deck in group] == decks


@pytest.mark.parametrize("path", ["-", "no such file", "a\0b", "."])
def test_what_is_no_file_is_by_itself(path: str, tmp_path: Path) -> None:
    """Standard input, a name that cannot be one, and a folder."""
    (tmp_path / "good").write_bytes(b"1")
    good = DeckFile("good", str(tmp_path / "good"))
    odd = DeckFile("odd", path)
    assert list(groups_of_decks([good, odd, good])) == [[good], [odd], [good]]
