"""`vopd errata` and `vopd diff`: what they write, line by line; runs that errata correct."""

from __future__ import annotations

import json
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, vopd
from vopd.cli import diff, errata
from vopd.errata import VOPD_ERRATA, Erratum
from vopd.listing.compare import Comparison, Difference


def test_an_erratum_as_text() -> None:
    """Its name, then its parts in order, each wrapped at 80 columns with an indent of 12."""
    words = " ".join(["seven77"] * 12)
    one = Erratum("name", "vopd", "A 1", "x", words, "read", "none")
    assert errata.text(one).splitlines() == [
        "name",
        "  where     A 1",
        "  original  x",
        "  fix       " + " ".join(["seven77"] * 8),
        "            " + " ".join(["seven77"] * 4),
        "  evidence  read",
        "  effect    none",
    ]
    lines = errata.text(one._replace(fix="x", effect="x" * 68)).splitlines()
    assert len(lines) == 6 and max(map(len, lines)) == 80


def test_errata_are_parted_by_an_empty_line_and_json_is_indented() -> None:
    text = vopd("errata", "restart", "earth").stdout
    assert text.count("\n\n") == 1 and "\n\nearth\n" in text and text[-2:] != "\n\n"
    lines = vopd("errata", "restart", "--format", "json").stdout.splitlines()
    assert lines[:3] == ["[", "  {", '    "name": "restart",'] and lines[-1] == "]"
    known = [one.name for one in errata.errata_of("rae")]
    assert f"There are: {', '.join(known)}." in vopd("errata", "--program", "rae", "zz").stderr
    ran = vopd("rmu")
    assert ran.status == 2
    assert_approved(ran.stderr)
    ran = vopd("zzzz")
    names = (
        "run, cards, diff, errata, demo, new, pick, track, punch, check, attitude, adjust, "
        "plot, report, batch, stars, help"
    )
    assert_approved(ran.stderr, parts=[names])


# diff

FIELD = Difference("field", 2, "730", 18, 19, "75.837", "75.836", "66", "PHI", Decimal("1.5"))


def test_differences_in_json() -> None:
    """One object; each difference on a line of its own, with every field; then the counts."""
    counts = Comparison(
        pages=2, pages_missing=4, pages_extra=5, fields_compared=82, fields_illegible=3
    )
    written: list[bytes] = []
    file: Any = SimpleNamespace(write=written.append)
    assert diff._write_json(file, [FIELD, FIELD], counts) == 2
    text = b"".join(written).decode()
    lines = text.splitlines()
    assert lines[0] == '{"differences": [' and lines[1].endswith("},") and text.endswith("}\n")
    assert len(lines) == 4 and lines[3].startswith('], "')
    found = json.loads(text)
    assert found["differences"][1] == {
        "kind": "field", "page": 2, "frame": "730", "expected_line": 18, "actual_line": 19,
        "expected": "75.837", "actual": "75.836", "landmark": "66", "field": "PHI",
        "off_by": 1.5, "determined": True, "apart": None, "unit": "",
    }  # fmt: skip
    assert {name: found[name] for name in found if name != "differences"} == {
        "pages": 2, "pages_missing": 4, "pages_extra": 5, "fields_compared": 82,
        "fields_illegible": 3, "fields_undetermined": 0, "fields_within": 0,
    }  # fmt: skip


@pytest.mark.parametrize("quiet", [False, True])
@pytest.mark.parametrize(
    ("determined", "status"), [([], 0), ([False], 0), ([True], 1), ([False, True], 1)]
)
def test_only_digits_that_are_determined_fail(
    determined: list[bool], status: int, quiet: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def differences(*given: Any) -> Any:
        given[3].fields_undetermined = determined.count(False)
        return [replace(FIELD, determined=one) for one in determined]

    monkeypatch.setattr(diff, "read_listing", str)
    monkeypatch.setattr(diff, "find_differences", differences)
    assert vopd("diff", "a", "b", *(["-q"] if quiet else [])).status == status


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (("-", "-"), 2),
        (("a", "b", "--undetermined", "-", "c"), 2),
        (("a", "b", "--undetermined", "c", "-"), 2),
        (("a", "b", "-q", "-o", "c"), 2),
        *((("a", "b", "--undetermined", "c", "d", "-o", name), 1)
          for name in ("a", "b", "c", "d")),
    ],
)  # fmt: skip
def test_comparisons_that_are_refused(
    arguments: tuple[str, ...], status: int, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(diff, "read_listing", str)
    for name in "abcd":
        Path(name).write_text(name)
    ran = vopd("diff", *arguments)
    assert ran.status == status
    assert_approved(ran.stderr.splitlines()[-1])


def test_the_table_of_tolerances_has_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 22, 9, 12 and 8 characters, without blanks at the end of a line."""
    rows = [("quantity", "field", "format", "units", "why"), ("a", "b", "c", "d", "")]
    monkeypatch.setattr(diff, "tolerance_rows", lambda: rows)
    ran = vopd("diff", "--tolerances")
    assert (ran.status, ran.stderr) == (0, "")
    assert ran.stdout.splitlines() == [
        "quantity" + " " * 14 + "field    " + "format      " + "units   " + "why",
        "a" + " " * 21 + "b        " + "c           " + "d",
    ]


# plot of stars


# Errata, and runs that they correct


def test_lists_every_erratum_with_all_its_parts() -> None:
    ran = vopd("errata")
    lines = ran.stdout.splitlines()
    assert [line for line in lines if not line.startswith(" ") and line] == [
        "latitude-series", "first-landmark", "restart", "earth",
        "sin-6phi", "feet-per-km", "eight-digits", "standard-deviation",
    ]  # fmt: skip
    for part in ("where", "original", "fix", "evidence", "effect"):
        assert sum(line.startswith(f"  {part:10}") for line in lines) == len(VOPD_ERRATA) == 8
    assert max(map(len, lines)) <= 80


def test_json_and_choice_and_program() -> None:
    (row,) = json.loads(vopd("errata", "restart", "--format", "json").stdout)
    assert row["name"] == "restart" and row["program"] == "vopd"
    assert list(row)[2:] == ["where", "original", "fix", "evidence", "effect"]
    rae = json.loads(vopd("errata", "--program", "rae", "--format", "json").stdout)
    assert {row["program"] for row in rae} == {"rae"}


def test_output_to_a_file(tmp_path: Path) -> None:
    ran = vopd("errata", "earth", "-o", tmp_path / "earth.txt")
    assert ran[:3] == (0, "", "")
    assert (tmp_path / "earth.txt").read_text() == vopd("errata", "earth").stdout


def test_unknown_erratum() -> None:
    ran = vopd("errata", "nothing")
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)
    assert_approved(vopd("errata", "restrat").stderr)
    other = vopd("errata", "--program", "rae", "restart")
    assert other.status == 2
    assert_approved(other.stderr)


def test_run_with_fixes_says_so_and_refuses_unknown_ones() -> None:
    plain = vopd("run", CASE_1)
    fixed = vopd("run", CASE_1, "--fix", "earth", "--fix", "restart", "--ellipsoid", "clarke1866")
    listed = "restart, earth (Clarke 1866)"
    assert_approved(fixed.stderr, parts=[listed])
    assert f"\n CORRECTED RUN, NOT THE ORIGINAL: {listed}\n" in fixed.stdout
    assert "CORRECTED" not in plain.stdout + plain.stderr
    unknown = vopd("run", CASE_1, "--fix", "nothing")
    assert unknown.status == 2
    assert_approved(unknown.stderr)
    alone = vopd("run", CASE_1, "--ellipsoid", "wgs84")
    assert alone.status == 2 and "--fix earth" in alone.stderr
    assert vopd("run", CASE_1, "--fix", "all", "--ellipsoid", "clarke1866").status == 0
