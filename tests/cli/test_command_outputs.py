"""What commands check before any work, and the last lines and bytes of what they write."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, vopd
from tests.kit.flight_project import MARKS, write_project
from vopd.cli import check, diff
from vopd.cli import histories as collect_histories
from vopd.findings import Finding
from vopd.listing.compare import Comparison

MISSING = {
    "attitude": ("pyarrow", ["-o", "t.parquet"]),
    "batch": ("pyarrow", ["-d", "out", "--format", "parquet"]),
    "report": ("jinja2", ["-o", "t.html"]),
    "plot": ("matplotlib.figure", ["-o", "t.png"]),
}


@pytest.mark.parametrize("command", MISSING)
def test_a_package_that_is_missing_is_said_before_anything_is_solved(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module, options = MISSING[command]

    def solved(*_: object) -> Iterator[Any]:
        raise AssertionError("solved")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(collect_histories, "solve_sources", solved)
    monkeypatch.setattr("vopd.batch.solve.solve_sources", solved)
    monkeypatch.setitem(sys.modules, module, None)
    ran = vopd(command, CASE_1, *options)
    assert (ran.status, ran.stdout) == (1, "")
    assert_approved(ran.stderr)
    assert not [*tmp_path.iterdir()]


def test_the_table_of_numbers_of_a_punched_flight(tmp_path: Path) -> None:
    """A line for each landmark that was numbered anew, the last one ended; names in quotes."""
    path = write_project(tmp_path)
    for name in ("picks.csv", "landmarks.csv"):
        text = (tmp_path / name).read_text().replace("mast,", '"mast, old",')
        (tmp_path / name).write_text(text)
    numbers, deck = tmp_path / "n.csv", tmp_path / "d.dat"
    ran = vopd("punch", path, "--numbers", numbers, "-o", deck)
    assert ran.status == 0 and "numbered anew" not in ran.stderr
    names = [f'"{name}, old"' if name == "mast" else name for name in MARKS]
    rows = [f"landmark,{k},{name}\n" for k, name in enumerate(names, 1)]
    assert numbers.read_bytes() == "".join(["kind,number,name\n", *rows]).encode()
    ran = vopd("punch", path, "-o", deck)
    assert_approved(ran.stderr, parts=[path])


@pytest.mark.parametrize(
    ("found", "free", "fields", "pages", "illegible", "summary"),
    [
        (0, 0, 82, 2, 0, "no differences; 82 fields on 2 pages compared, 0 illegible"),
        (1, 0, 1, 1, 3, "1 difference; 1 field on 1 page compared, 3 illegible"),
        (
            3, 1, 82, 2, 0,
            "2 differences; 1 field not determined; 82 fields on 2 pages compared, 0 illegible",
        ),
        (
            2, 2, 82, 0, 0,
            "no differences; 2 fields not determined; 82 fields on no pages compared, 0 illegible",
        ),
    ],
)  # fmt: skip
def test_the_last_line_of_a_comparison(
    found: int, free: int, fields: int, pages: int, illegible: int, summary: str
) -> None:
    """Differences in digits that are not determined are no differences."""
    counts = Comparison(
        pages=pages, fields_compared=fields, fields_illegible=illegible, fields_undetermined=free
    )
    written: list[bytes] = []
    some: Any = [f"difference {k}" for k in range(found)]
    assert diff._write_text(SimpleNamespace(write=written.append), some, counts) == found
    lines = b"".join(written).decode().splitlines()
    assert lines == [*some, summary]


def test_findings_that_are_not_shown_are_counted_by_kind() -> None:
    """Three of five are shown, with --all every one; each deck ends with its counts."""
    some = [Finding("odd", "a", card=k, group=9, severity="warning") for k in range(1, 6)]
    reports = {"a": [*some, Finding("wrong", "a")], "b": []}
    shown = [f"warning: a: card {k}, group 9: odd" for k in range(1, 6)]
    last = ["a: 1 error, 5 warnings", "b: no errors, no warnings"]
    lines = check._as_text(reports, show_all=False).splitlines()
    assert_approved(lines)
    assert check._as_text(reports, show_all=True).splitlines() == ["error: a: wrong", *shown, *last]
