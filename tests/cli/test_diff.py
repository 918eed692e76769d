"""`vopd diff` from the outside: what it writes, what it refuses, how it ends."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import Ran, vopd

PAGE = (Path(__file__).parents[1] / "listing" / "case1_page.lst").read_text(encoding="ascii")
END = PAGE.splitlines()[0] + "\n\n\n END OF CASE\n"
PHI = PAGE.replace(" 75.837", " 75.836")


@pytest.fixture(autouse=True)
def listings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A directory with the sample page and some other files in it."""
    monkeypatch.chdir(tmp_path)
    Path("page.lst").write_text(PAGE, encoding="ascii")
    Path("phi.lst").write_text(PHI, encoding="ascii")


def diff(*arguments: str, stdin: str | bytes | None = None) -> Ran:
    return vopd("diff", *arguments, stdin=stdin)


def test_no_difference() -> None:
    result = diff("page.lst", "phi.lst")
    assert (result.status, result.stderr) == (0, "")
    assert_approved(result.stdout)


def test_differences() -> None:
    result = diff("page.lst", "phi.lst", "--units", "0.5")
    assert (result.status, result.stderr) == (1, "")
    assert result.stdout == (
        "page 1, frame 730, line 18, PHI: expected 75.837, actual 75.836 (off by 0.001 deg)\n"
        "largest: 0.001 deg (frame 730, PHI)\n"
        "1 difference; 81 fields on 1 page compared, 0 illegible\n"
    )


def test_the_largest_may_come_behind_those_that_are_sorted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two frames' differences, a thousandth of a degree and two, only the first is held."""
    monkeypatch.setattr("vopd.cli.diff.SORTED", 1)
    Path("two.lst").write_text(PAGE + PAGE.replace("  730 ", "   60 "), encoding="ascii")
    more = PHI + PAGE.replace("  730 ", "   60 ").replace(" 75.837", " 75.839")
    result = diff("two.lst", "-", "--units", "0", stdin=more)
    assert (result.status, result.stderr) == (1, "")
    assert result.stdout.splitlines()[-2] == "largest: 0.002 deg (frame 60, PHI)"


def test_a_long_text_is_no_listing_by_its_first_megabyte() -> None:
    result = diff("page.lst", "-", stdin="a line of text\n" * 80_000)
    assert result.status == 1
    assert_approved(result.stderr)


def test_lines_and_pages_that_only_one_has() -> None:
    lines = PAGE.splitlines(keepends=True)
    shorter = "".join(lines[:10] + lines[11:])
    Path("one").write_text(PAGE + PAGE.replace("  730 ", "   60 "), encoding="ascii")
    result = diff("one", "-", stdin=shorter)
    assert_approved(result.stdout)
    result = diff("-", "one", stdin=shorter.replace("PHI", "PSI"))
    assert_approved(result.stdout, parts=[lines[16].replace("PHI", "PSI"), lines[16]])


def test_quiet_writes_nothing() -> None:
    for units, status in (("0", 1), ("1", 0)):
        result = diff("-q", "--units", units, "page.lst", "phi.lst")
        assert result[:3] == (status, "", "")


@pytest.mark.parametrize("form", ["text", "json"])
def test_output_to_a_file(form: str) -> None:
    arguments = ("page.lst", "phi.lst", "--units", "0", "--format", form)
    printed = diff(*arguments)
    assert diff(*arguments, "-o", "out")[:3] == (1, "", "")
    assert Path("out").read_bytes() == printed.output != b""
    refused = diff(*arguments, "-o", "phi.lst")
    assert refused.status == 1 and refused.stderr.startswith("phi.lst: ")
    assert Path("phi.lst").read_text(encoding="ascii") == PHI


def test_json() -> None:
    result = diff("page.lst", "phi.lst", "--units=0", "--format=json")
    assert result.status == 1
    assert json.loads(result.stdout) == {
        "differences": [
            {
                "kind": "field",
                "page": 1,
                "frame": "730",
                "expected_line": 18,
                "actual_line": 18,
                "expected": "75.837",
                "actual": "75.836",
                "landmark": "",
                "field": "PHI",
                "off_by": 1.0,
                "determined": True,
                "apart": 0.001,
                "unit": "deg",
            }
        ],
        "pages": 1,
        "fields_compared": 81,
        "fields_illegible": 0,
        "fields_undetermined": 0,
        "fields_within": 0,
        "pages_missing": 0,
        "pages_extra": 0,
    }
    result = diff("page.lst", "page.lst", "--format=json")
    assert (result.status, json.loads(result.stdout)["differences"]) == (0, [])
    both = json.loads(diff("page.lst", "-", "--format=json", stdin=PHI[:-200]).stdout)
    assert len(both["differences"]) > 1


def test_illegible_fields_are_counted() -> None:
    damaged = PAGE.replace("-.04424", "???????").replace(" .11718", "??????")
    result = diff("-", "page.lst", "--units", "0", stdin=damaged + "?\n")
    assert "line missing" in result.stdout
    assert "1 difference; 79 fields on 1 page compared, 2 illegible" in result.stdout


def test_tolerances_need_no_listings() -> None:
    result = diff("--tolerances")
    assert result.status == 0
    rows = result.stdout.splitlines()
    assert rows[0].split() == ["quantity", "unit", "at", "1", "unit", "modulo", "reason"]
    assert any(row.startswith("camera roll           deg      0.001       360 ") for row in rows)


def test_the_example_in_the_help_is_what_it_writes() -> None:
    Path("case1.lst").write_text(PAGE + END, encoding="ascii")
    result = diff("--units", "0", "case1.lst", "-", stdin=PHI + END)
    shown = diff("--help").stdout
    assert result.stdout.count("\n") == 3
    words = " ".join(shown.split())  # a long line is broken in the help
    assert all(line in words for line in result.stdout.splitlines())
    assert max(map(len, shown.splitlines())) <= 80


@pytest.mark.parametrize(
    "arguments",
    [
        ("-", "-"),
        ("page.lst",),
        ("page.lst", "page.lst", "page.lst"),
        ("page.lst", "page.lst", "--units", "-1"),
        ("page.lst", "page.lst", "--units", "nan"),
        ("page.lst", "page.lst", "--units", "inf"),
        ("page.lst", "page.lst", "--units", "one"),
        ("page.lst", "page.lst", "--format", "xml"),
        ("page.lst", "page.lst", "--loose"),
        ("page.lst", "phi.lst", "-q", "-o", "out"),
    ],
)
def test_wrong_usage(arguments: tuple[str, ...]) -> None:
    result = diff(*arguments)
    assert (result.status, result.stdout) == (2, "")
    assert "Error" in result.stderr


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n\n",
        b"1 A title\n and text below\n",
        b"\x7fELF\x02\x01",
        PAGE.encode() + b"  \x00",
        PAGE.encode() * 99 + b"\n\xe9",
        PAGE.encode().replace(b"  66 ", b"\t66 ", 1),
        PAGE.encode("utf-16"),
    ],
)
def test_what_is_no_listing(content: bytes) -> None:
    Path("other").write_bytes(content)
    for arguments in (("other", "page.lst"), ("page.lst", "other")):
        result = diff(*arguments)
        assert (result.status, result.stdout) == (1, "")
        assert result.stderr.startswith("other: ")
        assert_approved(result.stderr)
        assert result.stderr.count("\n") == 1
    result = diff("-", "page.lst", stdin=content)
    assert (result.status, result.stdout) == (1, "")
    assert result.stderr.startswith("standard input: ")
    assert_approved(result.stderr)


@pytest.mark.parametrize(
    ("name", "reason"),
    [(".", "is a folder"), ("none.lst", "no such file or directory")],
)
def test_what_cannot_be_read(name: str, reason: str) -> None:
    result = diff("page.lst", name)
    assert (result.status, result.stdout) == (1, "")
    assert result.stderr.startswith(f"{name}: ") and reason in result.stderr


def test_an_endless_binary_file_is_refused_at_once() -> None:
    result = diff("page.lst", "/dev/zero")
    assert result.status == 1 and "byte 0x00" in result.stderr


def test_standard_input_that_is_closed() -> None:
    command = [sys.executable, "-m", "vopd", "diff", "page.lst", "-"]
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(  # the descriptor itself is closed, not only empty
        ["sh", "-c", '"$@" <&-', "sh", *command], env=environment, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (
        1,
        "",
        "standard input: bad file descriptor\n",
    )


def test_a_long_listing_is_compared_whole() -> None:
    def listing(drift: str) -> str:
        numbered = (PAGE.replace("  730 ", f"{number:5d} ") for number in range(1, 3001))
        return "".join(numbered).replace("-.04424", drift)

    Path("long").write_text(listing("-.04424"), encoding="ascii")
    result = diff("long", "-", "-q", stdin=listing("-.04424"))
    assert result.status == 0
    result = diff("long", "-", stdin=listing("-.04429"))
    assert "3000 differences; 243000 fields on 3000 pages" in result.stdout
