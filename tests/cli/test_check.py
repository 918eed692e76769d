"""`vopd check`: how it ends and what it writes; the last lines and checks of other commands."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
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
from vopd.listing.compare import Comparison, Difference


@pytest.mark.parametrize(
    ("severities", "strict", "status"),
    [
        ([], False, 0), ([], True, 0), (["warning"], False, 0), (["warning"], True, 3),
        (["error"], False, 1), (["error", "warning"], True, 1),
    ],
)  # fmt: skip
def test_the_status_of_a_check(severities: list[Any], strict: bool, status: int) -> None:
    found = [Finding("odd", severity=one) for one in severities]
    assert check._status({"a": [], "b": found}, strict) == status


def test_a_check_in_json_has_every_field_of_a_finding() -> None:
    error = Finding("wrong", "a", 3, 1, 9, "longitude", (11, 20), "  card", "error")
    text = check._as_json({"a": [replace(error, message="odd", severity="warning"), error]})
    fields = {"card": 3, "job": 1, "group": 9, "field": "longitude", "columns": [11, 20]}
    assert text.startswith('[\n  {\n    "deck": "a",\n    "errors": [\n') and text.endswith("]\n")
    (report,) = json.loads(text)
    assert report == {
        "deck": "a",
        "errors": [{"message": "wrong", **fields, "image": "  card"}],
        "warnings": [{"message": "odd", **fields, "image": "  card"}],
    }
    assert [*report] == ["deck", "errors", "warnings"]


def test_findings_of_a_deck_in_text() -> None:
    """Errors first; one with a ruler is followed by an empty line; the count is of its kind."""
    ruled = Finding("wrong", "a", 3, 1, 9, "longitude", (11, 13), "0123456789abc", "error")
    odd = [
        Finding("odd", "a", k, 1, 9, "x", (1, 2), "card", severity="warning") for k in range(1, 9)
    ]
    lines = check._as_text({"a": [*odd, ruled]}, show_all=False).splitlines()
    assert lines[0] == "error: a: card 3, job 1, group 9, longitude (columns 11-13): wrong"
    assert lines[3:6] == ["    0123456789abc", " " * 14 + "^^^", ""]
    assert_approved(lines[-2])
    assert lines[-1] == "a: 1 error, 8 warnings"


@pytest.mark.parametrize("source", ["a.dat", "a.toml"])
def test_what_the_command_writes(
    source: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of a deck or a flight: the first of a kind, or all, or JSON, into a file or not at all."""
    found = [Finding("odd \udcfc", source, severity="warning")] * 5
    monkeypatch.setattr(check, "check_deck", lambda *_, **__: found)
    monkeypatch.setattr(check, "check_project", lambda _: found)
    monkeypatch.chdir(tmp_path)
    Path("a.dat").write_text("")
    odd = f"warning: {source}: odd \\udcfc"
    last = f"{source}: no errors, 5 warnings"
    assert_approved(vopd("check", source).stdout.splitlines(), parts=[source])
    ran = vopd("check", source, "--all", "--strict")
    assert ran.stdout.splitlines() == [odd] * 5 + [last] and ran.status == 3
    (report,) = json.loads(vopd("check", source, "--format", "json").stdout)
    assert len(report["warnings"]) == 5 and report["errors"] == []
    ran = vopd("check", source, "-q", "--strict")
    assert (ran.status, ran.stdout, ran.stderr) == (3, "", "")
    ran = vopd("check", source, "-o", "out.txt")
    assert (ran.status, ran.stdout) == (0, "")
    assert Path("out.txt").read_bytes().decode("ascii").splitlines()[0] == odd
    ran = vopd("check", source, "-q", "-o", "out.txt")
    assert ran.status == 2
    assert_approved(ran.stderr)


def test_a_deck_that_cannot_be_opened_is_a_finding(tmp_path: Path) -> None:
    """Its name stands once; the other sources are checked."""
    none = tmp_path / "none.dat"
    ran = vopd("check", none, none)
    lines = [f"error: {none}: No such file or directory", f"{none}: 1 error, no warnings"]
    assert ran.status == 1 and ran.stdout.splitlines() == lines


def test_errors_that_are_not_shown_are_counted_as_errors() -> None:
    found = [Finding("wrong", "a", card=card) for card in range(1, 6)]
    lines = check._as_text({"a": found}, show_all=False).splitlines()
    assert_approved(lines[3:])


def test_every_kind_that_is_not_shown_whole_has_its_count() -> None:
    found = [Finding("wrong", "a", card=card, group=9) for card in range(1, 5)]
    found += [Finding("wrong", "a", card=card) for card in range(1, 6)]
    lines = check._as_text({"a": found}, show_all=False).splitlines()
    assert_approved(lines[6:])


# Before any work, and the last lines

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
    some = [
        Difference("line", k, "", 1, 1, "a", "b") for k in range(found)
    ]  # texts: how far they are apart is not known
    assert diff._write_text(SimpleNamespace(write=written.append), some, counts) == found
    lines = b"".join(written).decode().splitlines()
    assert lines == [*"\n".join(map(str, some)).splitlines(), summary]


def test_findings_that_are_not_shown_are_counted_by_kind() -> None:
    """Three of five are shown, with --all every one; each deck ends with its counts."""
    some = [Finding("odd", "a", card=k, group=9, severity="warning") for k in range(1, 6)]
    reports = {"a": [*some, Finding("wrong", "a")], "b": []}
    shown = [f"warning: a: card {k}, group 9: odd" for k in range(1, 6)]
    last = ["a: 1 error, 5 warnings", "b: no errors, no warnings"]
    lines = check._as_text(reports, show_all=False).splitlines()
    assert_approved(lines)
    assert check._as_text(reports, show_all=True).splitlines() == ["error: a: wrong", *shown, *last]
