"""Digits that depend on the last bits of sines: named and counted, and no failure; all others are.

The deck's first frame does not converge: its angles and residuals are where the 22nd
pass left them, which other sines change.
"""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

from tests.approved.texts import refused
from tests.kit.command import ROOT, vopd
from vopd.findings import VopdError
from vopd.listing.compare import compare_listings, may_hold, undetermined_fields
from vopd.listing.formats import LINES

PAGE = (Path(__file__).parents[1] / "listing" / "case1_page.lst").read_text(encoding="ascii")
DECK = Path(__file__).with_name("frame_that_does_not_converge.dat")
KINDS = ("attitude", "residual", "standard deviation")
FIELDS = {field.name: field for kind in KINDS for field in LINES[kind].fields}


@pytest.fixture
def tools(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(ROOT / "tools")
    return import_module("goldens")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The deck's own listing, one by other sines, and the two between which they lie."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(ROOT / "tools")
    tool = ROOT / "tools" / "listing_range.py"
    subprocess.run([sys.executable, tool, DECK, "low.lst", "high.lst"], check=True)
    (tmp_path / "own.lst").write_bytes(import_module("goldens").listing(DECK))
    with import_module("other_sines").other_sines(99, 1):
        (tmp_path / "other.lst").write_bytes(import_module("goldens").listing(DECK))
    return tmp_path


def diff(*arguments: str) -> tuple[int, list[str]]:
    ran = vopd("diff", "--units", "0", *arguments)
    return ran.status, ran.stdout.splitlines()


def test_digits_that_are_not_determined_are_no_failure(folder: Path) -> None:
    assert diff("own.lst", "other.lst")[0] == 1
    status, lines = diff("own.lst", "other.lst", "--undetermined", "low.lst", "high.lst")
    assert status == 0
    assert all(line.endswith("not determined)") for line in lines[:-1])
    assert {line.split(", ")[1] for line in lines[:-1]} == {"frame 1"}
    assert lines[-1].startswith(f"no differences; {len(lines) - 1} fields not determined; 304")
    assert diff("-q", "own.lst", "other.lst", "--undetermined", "low.lst", "high.lst")[0] == 0


def test_any_other_digit_is_a_failure(folder: Path) -> None:
    """Every digit of the listing made another one, but in the fields that are not determined."""
    own = (folder / "own.lst").read_text()
    free = undetermined_fields((folder / "low.lst").read_text(), (folder / "high.lst").read_text())
    assert len({line for line, _ in free}) == 6  # of frame 1: attitude, residuals, deviation
    lines = {line for line, _ in free}
    places = [at for at in range(0, len(own), 7) if own[at].isdigit()]
    places = [at for at in places if own[:at].count("\n") + 1 not in lines]
    assert len(places) > 200
    for at in places:
        wrong = own[:at] + str((int(own[at]) + 5) % 10) + own[at + 1 :]
        assert any(one.determined for one in compare_listings(own, wrong, 0, free).differences)
    # in a field that is not determined the leading digit still is, whatever the others are
    printed = own.splitlines(keepends=True)
    for line, name in free:
        number = printed[line - 1][FIELDS[name].columns]
        digit = next(one for one in number if one in "123456789")
        other = number.replace(digit, str((int(digit) + 5) % 10), 1)
        text = printed[line - 1].replace(number, other, 1)
        wrong = "".join([*printed[: line - 1], text, *printed[line:]])
        assert any(one.determined for one in compare_listings(own, wrong, 0, free).differences)


def test_a_digit_that_is_determined_is_a_failure_of_the_command(folder: Path) -> None:
    """SIG1 of the first frame, a degree larger than printed; only its last digit is left open."""
    own = (folder / "own.lst").read_text()
    frame = next(line for line in own.splitlines() if "   1   40.032" in line)
    printed = frame[FIELDS["SIG1"].columns].strip()
    wrong = f"{float(printed) + 1.0:.3f}"
    (folder / "wrong.lst").write_text(own.replace(f" {printed}", f" {wrong}", 1))
    status, lines = diff("own.lst", "wrong.lst", "--undetermined", "low.lst", "high.lst")
    assert status == 1
    assert lines[0].endswith(f"SIG1: expected {printed}, actual {wrong} (off by 1 deg)")


def test_the_check_of_regression_listings(
    folder: Path, tools: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    other = (folder / "other.lst").read_bytes()
    assert other != tools.listing(DECK)
    assert tools.is_kept(DECK, other)
    assert "0 differ" in capsys.readouterr().out
    wrong = other.replace(b"  5.160  3.732", b"  5.161  3.732", 1)  # XP, which is determined
    assert wrong != other
    assert not tools.is_kept(DECK, wrong)
    assert "XP: expected 5.161, actual 5.160 (off by 0.001 mm)" in capsys.readouterr().out
    assert not tools.is_kept(DECK, other + b"\n")
    assert not tools.is_kept(DECK, b"")


@pytest.mark.parametrize(
    ("name", "low", "high", "held", "not_held"),
    [
        ("TIME", "1.234", "1.235", ("1.234", "1.235"), ("1.233", "1.236", "2.234", "*****", "")),
        ("SIG1", "359.999", "0.001", ("0.000", "360.000", "359.999"), ("0.002", "180.0")),
        ("SIG1", "-0.001", "720.001", ("0.000", "360.000", "360.001"), ("0.002",)),
        ("SIG1", "*********", "9999.000", ("*********", "9999.000"), ("9998.999", "1.000")),
    ],
)
def test_what_an_undetermined_field_may_hold(
    name: str, low: str, high: str, held: tuple[str, ...], not_held: tuple[str, ...]
) -> None:
    for text in held:
        assert may_hold(FIELDS[name], text, low, high), text
    for text in not_held:
        assert not may_hold(FIELDS[name], text, low, high), text


def test_both_listings_must_lie_between() -> None:
    high = PAGE.replace(" 75.837", " 75.839")
    free = undetermined_fields(PAGE, high)
    assert list(free.values()) == [("75.837", "75.839")]
    between = PAGE.replace(" 75.837", " 75.838")
    beyond = PAGE.replace(" 75.837", " 75.840")
    for one, other, determined in (
        (PAGE, between, False),
        (between, high, False),
        (PAGE, beyond, True),
        (beyond, PAGE, True),
    ):
        (difference,) = compare_listings(one, other, 0, free).differences
        assert difference.determined is determined


def test_listings_of_other_frames_are_refused(folder: Path) -> None:
    with refused(VopdError):
        undetermined_fields(PAGE, PAGE + PAGE)
    assert vopd("diff", "own.lst", "own.lst", "--undetermined", "low.lst", "-").status == 2
    assert vopd("diff", "own.lst", "own.lst", "--undetermined", "low.lst", "no.lst").status == 1


def test_other_sines_are_near_and_the_same_each_time(
    tools: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    import numpy as np

    at = np.linspace(-7.0, 7.0, 1001)
    plain = np.sin(at)
    with import_module("other_sines").other_sines(3, 4):
        one, again = np.sin(at), np.sin(at)
        alone = np.sin(at[17])
    with import_module("other_sines").other_sines(4, 4):
        other = np.sin(at)
    assert np.sin is not None and np.array_equal(np.sin(at), plain)
    units = (one - plain) / np.spacing(np.abs(plain))
    assert sorted(set(units[plain != 0.0].tolist())) == list(range(-4, 5))
    assert np.array_equal(one, again) and alone == one[17]
    assert not np.array_equal(one, other)
