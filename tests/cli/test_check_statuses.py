"""How a check ends, and what it writes of each finding."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.cli import check
from vopd.findings import Finding


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
