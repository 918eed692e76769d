"""tools/size.py counts a small made-up tree as a person does."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]

LENS = '''"""Lenses."""

from __future__ import annotations

from typing import (
    NamedTuple,
)


class Lens(NamedTuple):
    """A lens."""

    focal_mm: float


def focal(lens: Lens) -> float:
    """Estimate the focal length."""
    # a comment
    if lens.focal_mm < 0:
        raise ValueError(f"{lens}: the focal length is below zero")
    if lens.focal_mm == 0:
        raise ValueError("no focal length is known")
    return lens.focal_mm


def _name() -> str:
    """Name of a lens, which is a noun."""
    return "too few words"
'''
TEST = '''"""no focal length is known"""
from vopd.lens import Lens, _name, focal as _focal

TOLD = "f.toml: the focal length is below zero"
'''


@pytest.fixture(scope="module")
def size() -> ModuleType:
    spec = importlib.util.spec_from_file_location("size", ROOT / "tools" / "size.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_small_tree(tmp_path: Path, size: ModuleType) -> None:
    lens, test = tmp_path / "lens.py", tmp_path / "test_lens.py"
    lens.write_text(LENS)
    test.write_text(TEST)
    assert size.lines([lens]) == 28
    assert size.records([lens]) == 1
    assert round(size.import_share([lens]), 3) == 28.571
    assert size.repeated_sentences([lens], [test]) == 50.0
    assert size.private_names([test]) == 1
    assert size.verb_share([lens]) == 50.0


@pytest.mark.parametrize(
    ("docstring", "verb"),
    [
        ("Read a file.", True), ("Name the file.", True), ("Name of the file.", False),
        ("The file.", False), ("Group 9 of a job.", False), ("What is in the file.", False),
        ("Whether it is there.", False), ("Reading a file.", False), ("Weighted sums.", False),
        ("A file read.", False), ("", False),
    ],
)  # fmt: skip
def test_first_words(size: ModuleType, docstring: str, verb: bool) -> None:
    assert size.begins_with_verb(docstring) is verb


def test_the_page_has_every_count(size: ModuleType) -> None:
    page = (ROOT / size.PAGE).read_text(encoding="utf-8")
    shown = page.split(size.BEGIN)[1].split(size.END)[0]
    for what, before, aim in size.AIMS:
        row = next(row for row in shown.splitlines() if row.startswith(f"| {what} |"))
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[1] == before and cells[3] == aim
