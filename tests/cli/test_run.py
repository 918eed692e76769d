"""`vopd run`: what it prints, where it stops, what it says, how it ends."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest
from scipy.io import FortranFile

from tests.approved.texts import assert_approved
from tests.kit.cards import landmarks_again, two_frames
from tests.kit.command import Ran, vopd
from vopd.cli.console import ReaderGone, at_the_boundary
from vopd.errata import fixes
from vopd.findings import Finding, VopdError
from vopd.pipeline import SolveOptions, in_groups
from vopd.results import SolvedJob, SourceEnd

DECKS = Path(__file__).parents[2] / "decks" / "appendix_h"
CASE_1 = (DECKS / "case1.dat").read_text().splitlines()
CASE_4 = (DECKS / "case4.dat").read_text().splitlines()
# case 1: cards 1-25 group 1, 26 title, 27 group 3, 28-30 group 4, 31 group 5, 32-33 group 6,
# 34-37 group 7, 38 group 8, 39-41 group 9, 42 group 10, 43 group 12, 44-64 basic data
GROUP_9 = slice(38, 41)


def run(*cards: str, options: tuple[str, ...] = ()) -> Ran:
    return vopd("run", *options, "-", stdin="\n".join(cards) + "\n")


def pages(result: Ran) -> int:
    return result.stdout.count("STANDARD DEVIATION")


def punched(card: int, first: int, text: str, cards: list[str] = CASE_1) -> list[str]:
    """The deck with `text` punched into a card from column `first`, counted from 1."""
    line = cards[card - 1].ljust(80)
    line = line[: first - 1] + text + line[first - 1 + len(text) :]
    return [*cards[: card - 1], line, *cards[card:]]


def stacked(ngo: int, *more: str) -> list[str]:
    """Case 1 with another return group, and the cards that follow it."""
    return [*punched(43, 1, f"{ngo:5d}"), *more]


STOP = "   13    0    0    0"


@pytest.mark.parametrize(
    ("ngo", "more"),
    [
        (1, punched(43, 1, STOP)),  # the lens table and all the rest, basic data too
        (2, punched(43, 1, STOP)[25:]),
        *((ngo, punched(43, 1, STOP)[first - 1 : 43]) for ngo, first in
          ((3, 27), (4, 28), (5, 31), (6, 32), (7, 34), (8, 38), (9, 39), (10, 42))),
        (11, [STOP]),  # NOUT is 0: group 11 has no card
        (12, [STOP]),
        (13, []),
    ],
)  # fmt: skip
def test_every_return_group(ngo: int, more: list[str]) -> None:
    """The same cards again from the return group on print the same page again."""
    result = run(*stacked(ngo, *more))
    assert result.status == 0, result.stderr
    one = run(*CASE_1).stdout
    page = one.removesuffix("\n\n END OF CASE\n")
    assert result.stdout == (page if ngo != 13 else "") + one


def test_the_title_card_is_where_a_deck_may_end() -> None:
    """Return group 2 and no card: the normal end. Return group 1 wants the lens table."""
    assert run(*stacked(2)).stdout == run(*CASE_1).stdout
    ended = run(*stacked(1))
    assert ended.status == 1
    assert_approved(ended.stderr)
    assert pages(ended) == 1 and "END OF CASE" not in ended.stdout


def test_old_landmarks_stay_and_a_new_one_counts() -> None:
    """Group 9 again with 65 to the last: 66 moved by .3 minute prints case 2's latitude."""
    moved = CASE_1[39].replace(" 50. ", "50.3 ")
    more = [CASE_1[38], moved, CASE_1[40], "    0", "   13   65    0    0"]
    result = run(*stacked(9, *more))
    assert result.status == 0
    assert "   66  -106.54500  32.66227" in result.stdout.split("\n1")[2]  # Appendix H, case 2


def test_fewer_landmarks_again_leave_the_others_as_they_were() -> None:
    """Group 9 again with two landmarks of three: the second job prints the pages of the first."""
    once, twice = run(*two_frames()), run(*landmarks_again(two_frames()))
    assert once.status == twice.status == 0, twice.stderr
    page = once.stdout.removesuffix("\n\n END OF CASE\n")
    assert twice.stdout == page + once.stdout


def test_group_11_again_with_the_old_count() -> None:
    """Case 4's three cards of group 11, given anew by return group 11: frame 60 dropped now."""
    first = next(k for k, card in enumerate(CASE_4) if card.startswith("   55  100"))
    cards = punched(first + 4, 1, "   11", CASE_4)
    again = ["   60  100", "   55   69", "   65   69", "   13    0    0    0"]
    result = run(*cards, *again)
    assert result.status == 0, result.stderr
    attitudes = [line[:5] for line in result.stdout.splitlines() if line[5:14].strip() == "-.697"]
    assert attitudes == ["   60"]  # by the first job only
    dropped = [
        line.strip() for line in result.stdout.splitlines() if "FRAME" in line and "IGNORED" in line
    ]
    assert dropped == [f"FRAME  {n}IGNORED BY USERS DIRECTION" for n in (55, 60)]
    assert pages(result) == 4


# Bad input: the deck, what is said, and how many pages come first

BAD = {
    "ends early": (CASE_1[:40], "card 41, group 9: the deck ends here: 3 cards expected, 2 found"),
    "unreadable": (
        punched(40, 41, "      5O.3"),
        "group 9, landmark latitude minutes (columns 41-",
    ),
    "count below one": (punched(27, 1, "    0"), "trajectory cards (group 7) (columns 1-5): 0: at"),
    "frames below one": (punched(31, 6, "    0"), "number of frames (columns 6-10): 0: at least 1"),
    "landmarks below one": (punched(31, 16, "   -1"), "landmarks in a frame (columns 16-20): -1:"),
    "requests below none": (punched(42, 1, "   -1"), "group 10, number of group 11 cards"),
    "too many landmarks": (punched(31, 16, "    4"), "basic data: the deck ends here: 24 cards"),
    "too few landmarks": (punched(31, 16, "    2"), "group 5 counts 2 landmarks for frame 730"),
    "another frame": (punched(50, 64, "0731"), "card 50, basic data, frame number (columns 64-67)"),
    "odd landmark": (punched(58, 9, "66"), "card 58, basic data, landmark number (columns 9-10)"),
    "undefined landmark": (punched(39, 9, "68"), "landmark 65 is not defined in group 9"),
    "a tab": (punched(28, 5, "\t"), "card 28, group 4, (column 5): a tab"),
    "a character": (punched(28, 5, "\x07"), "byte 0x07 is not a printable ASCII character"),
    "column 81": (punched(28, 81, "x"), "card 28, group 4, (column 81): a card has 80 columns"),
    "no cards": ([""], "the deck is empty"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_prints_no_page_of_its_job(name: str) -> None:
    cards, _said = BAD[name]
    result = run(*cards)
    assert result.status == 1
    assert_approved(result.stderr)
    assert result.stdout == ""


@pytest.mark.parametrize(
    "name", [name for name in BAD if name not in ("no cards", "undefined landmark")]
)
def test_a_bad_second_job_keeps_the_pages_of_the_first(name: str) -> None:
    """Return group 1, and the same deck with its error: one page, then the same words."""
    cards, said = BAD[name]
    result = run(*stacked(1, *cards))
    assert result.status == 1
    number = said.split(",")[0].removeprefix("card ")
    if number.isdigit():
        said = said.replace(number, str(int(number) + len(CASE_1)), 1)
    assert_approved(result.stderr)
    assert pages(result) == 1 and result.stdout.endswith(CASE_1[25].ljust(80) + "\n")


LATER = {
    "more frames": ["    3    2    2    3    3"],
    "other landmarks": ["    3    1    2    2"],
}


@pytest.mark.parametrize("name", LATER)
def test_a_later_group_5_cannot_change_what_is_stored(name: str) -> None:
    cards = LATER[name]
    result = run(*stacked(5, *cards))
    assert result.status == 1 and pages(result) == 1
    assert "group 5" in result.stderr
    assert_approved(result.stderr)


def test_a_later_group_5_may_drop_frames() -> None:
    """Case 4, then its first two frames only: frame 55 is dropped, so one page more."""
    first = next(k for k, card in enumerate(CASE_4) if card.split()[:3] == ["3", "3", "2"])
    last = next(k for k, card in enumerate(CASE_4) if card.split() == ["13"]) + 1
    job = ["    3    2    2    3    3", *CASE_4[first + 1 : last]]
    result = run(*punched(last, 1, "    5", CASE_4), *job)
    assert result.status == 0, result.stderr
    assert pages(result) == 3


@pytest.mark.parametrize("ngo", [0, 14, -1])
def test_the_return_group_is_looked_at_after_the_last_page(ngo: int) -> None:
    result = run(*stacked(ngo))
    assert result.status == 1 and pages(result) == 1
    assert f"return group (columns 1-5): {ngo} is not a return group" in result.stderr
    assert "END OF CASE" not in result.stdout


OUT_OF_ORDER = {  # what stands on the page before FTLUP's words
    "time": (punched(33, 1, "    0"), 0, 2),
    "trajectory": (punched(36, 1, "      69.5"), 0, 3),
    "lens": (punched(5, 1, "        1."), 12, 5),
    "wind": (punched(29, 1, "   120000."), 16, 2),
}


@pytest.mark.parametrize("table", OUT_OF_ORDER)
def test_a_table_out_of_order_stops_in_mid_page(table: str) -> None:
    cards, lines, position = OUT_OF_ORDER[table]
    result = run(*cards)
    assert result.status == 1
    assert_approved(result.stderr, parts=[position])
    page, said = result.stdout.split("1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION ")
    assert page == "".join(run(*CASE_1).stdout.splitlines(True)[:lines])
    assert said.startswith(f"{position:5d}\n TABLE IS STORED IN LOCATION 000000\n\n ")


def test_ftlup_prints_its_table() -> None:
    """8G15.8 after one blank: 150000, 140000, 130000, as the original's eight digits."""
    cards = [*CASE_1[:27], CASE_1[29], CASE_1[28], *CASE_1[27:28], *CASE_1[30:]]
    assert run(*cards).stdout.endswith(
        "AT POSITION     2\n TABLE IS STORED IN LOCATION 000000\n\n"
        "   150000.00      140000.00      130000.00    \n"
        "  -2.0000000     -4.0000000      32.000000    \n"
    )


LIMITS = {
    "III": punched(27, 1, "   51"), "IWV": punched(27, 6, "   51"), "NT": punched(31, 1, "  101"),
    "NFR": punched(31, 6, "  201"), "NTFR": punched(31, 11, "  101"),
    "NPT": punched(31, 16, "    7"), "NOUT": punched(42, 1, "  101"),
    "TTHJ": punched(39, 9, "91"),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_the_array_sizes_of_1974_bind_when_asked_for(name: str) -> None:
    bound = run(*LIMITS[name], options=("--limits-1974",))
    assert bound.status == 1
    assert_approved(bound.stderr)
    free = run(*LIMITS[name])
    assert "the original's array " not in free.stderr


WARNED = {
    "clock": (punched(33, 1, "  729"), "group 6: frame 730: outside the time table"),
    "trajectory": (
        punched(37, 1, "      70.8", punched(36, 1, "      70.5")),
        "group 7: frame 730: outside the trajectory table",
    ),
    "wind": (punched(30, 1, "   141000."), "group 4: frame 730: outside the wind table"),
    "integer": (punched(32, 1, "   0 "), "group 6, frame number (columns 1-5): blanks read as"),
    "real": (punched(37, 71, "   151014 "), "altitude above sea level (columns 71-80): blanks"),
    "after the end": ([*CASE_1, "one more card"], "card 65: the deck goes on after the job"),
}


@pytest.mark.parametrize("name", WARNED)
def test_warnings_change_no_status(name: str) -> None:
    cards, _said = WARNED[name]
    result = run(*cards)
    assert result.status == 0 and pages(result) == 1
    assert_approved(result.stderr)
    assert run(*cards, options=("-q",)).stderr == ""


def test_one_landmark_is_warned_about_and_printed() -> None:
    cards = punched(31, 16, "    1")[:58]
    result = run(*cards)
    assert pages(result) == 1
    assert_approved(result.stderr)


def test_no_focal_length_keeps_every_angle_and_says_singular() -> None:
    """Group 8's 198, -36, 285 come out as they went in: the corrections are zero."""
    result = run(*punched(38, 1, "        0."))
    assert result.status == 0
    assert "  730   70.871  198.000  -36.000  285.000" in result.stdout
    assert_approved(result.stderr)


def test_a_landmark_at_the_centre_is_not_corrected() -> None:
    """Landmark 65 read three times at the centre, 7.23925 5.22825 by ten columns: no such
    reading has seven, so the fiducials are all put at 7. and 5. instead."""
    cards = list(CASE_1)
    for card in range(44, 59):
        cards = punched(card, 41, "     7.", cards)
        cards = punched(card, 51, "     5.", cards)
    result = run(*cards)
    assert_approved(result.stderr)
    assert "  65        4.99671        3.56908         .00000        -.00000" in result.stdout
    assert "NaN" not in result.stdout


def test_a_frame_that_does_not_converge_is_named_and_the_status_is_3() -> None:
    """At 5 million feet west the landmarks lie below the horizon of any solution."""
    cards = CASE_1[:33] + [card[:10] + " -9999999." + card[20:] for card in CASE_1[33:37]]
    result = run(*cards, *CASE_1[37:])
    assert result.status == 3
    assert "frame 730: not converged" in result.stderr
    assert result.stdout.endswith("END OF CASE\n")


def test_case_4_on_tape(tmp_path: Path) -> None:
    """Seven numbers a frame that was solved, as FORTRAN reads them; the printed ones."""
    tape = tmp_path / "tape"
    assert run(*CASE_4, options=("--tape10", str(tape))).status == 0
    with FortranFile(tape) as records:
        rows = [records.read_reals(np.float64) for _ in range(2)]
    assert tape.stat().st_size == 2 * (7 * 8 + 8)
    printed = [
        "-0.697 225.133 -86.339 181.954 112.219 -156.597 111.912",
        "-0.612 225.465 -86.386 181.407 112.175 -158.836 111.930",
    ]
    assert [" ".join(f"{x:.3f}" for x in row) for row in rows] == printed


def test_a_file_appears_whole_and_holds_what_was_earned(tmp_path: Path) -> None:
    out = tmp_path / "listing"
    failed = run(*stacked(14), options=("-o", str(out)))
    assert failed.status == 1 and failed.stdout == ""
    assert out.read_text() == run(*stacked(14)).stdout
    assert [path.name for path in tmp_path.iterdir()] == ["listing"]


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    deck = tmp_path / "deck.dat"
    deck.write_text("\n".join(CASE_1))
    for output in (
        tmp_path / "no" / "where",
        deck,
    ):
        result = vopd("run", deck, "-o", output)
        assert result.status == 1
        assert_approved(result.stderr)
    result = vopd("run", deck, "-o", tmp_path)
    assert result.status == 1 and "Is a directory" in result.stderr
    assert deck.read_text() == "\n".join(CASE_1)


def test_several_decks_and_the_worst_status(tmp_path: Path) -> None:
    """The rest still run; 1 outranks 3."""
    case = str(DECKS / "case1.dat")
    result = vopd("run", tmp_path / "none", case, tmp_path)
    assert result.status == 1 and pages(result) == 1
    assert "none: No such file or directory" in result.stderr
    assert f"{tmp_path}: is a folder, without" in result.stderr


def test_an_error_outranks_a_frame_that_did_not_converge(tmp_path: Path) -> None:
    """For the listing and for the table, whichever deck comes first; alone it is status 3."""
    far, missing = tmp_path / "far.dat", tmp_path / "none.dat"
    cards = CASE_1[:33] + [card[:10] + " -9999999." + card[20:] for card in CASE_1[33:37]]
    far.write_text("\n".join([*cards, *CASE_1[37:]]))
    for command in ("run", "attitude"):
        assert vopd(command, far).status == 3
        assert vopd(command, far, missing).status == 1
        assert vopd(command, missing, far).status == 1
        assert vopd(command, far, missing, "--strict").status == 1


def test_strict_is_status_3_where_there_is_a_warning() -> None:
    cards = WARNED["wind"][0]
    assert run(*cards, options=("--strict",)).status == 3
    assert run(*cards, options=("--strict", "-q")).status == 3
    assert run(*CASE_1, options=("--strict",)).status == 3  # a reading of .020 in
    assert run(*CASE_4, options=("--strict",)).status == 0
    assert vopd("run", "-", "none.dat", "--strict", stdin="\n".join(cards)).status == 1


def test_standard_input_is_read_once() -> None:
    result = vopd("run", "-", "-", stdin="\n".join(CASE_1))
    assert result.status == 1 and pages(result) == 1
    assert_approved(result.stderr)


def test_binary_and_a_million_cards_of_garbage(tmp_path: Path) -> None:
    """Refused at the first card, in little memory: a block of the file, not all of it."""
    import tracemalloc

    binary, garbage = tmp_path / "binary", tmp_path / "garbage"
    binary.write_bytes(bytes(range(256)) * 40000)
    garbage.write_bytes(b"garbage all over the card\n" * 1_000_000)
    tracemalloc.start()
    for path, said in ((binary, "byte 0x00"), (garbage, "not a number: 'garbage al'")):
        result = vopd("run", path)
        assert result.status == 1 and said in result.stderr
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 15e6


def process(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "vopd", *arguments]
    return subprocess.run(command, capture_output=True, text=True, **options)  # type: ignore[call-overload,no-any-return]


def test_the_process_itself(tmp_path: Path) -> None:
    """`python -m vopd`: statuses, no traceback, and a reader who leaves early."""
    case = str(DECKS / "case1.dat")
    assert process("run", case).stdout == run(*CASE_1).stdout
    assert process("run").returncode == 2
    missing = process("run", "none.dat", cwd=tmp_path)
    assert missing.returncode == 1 and missing.stderr == "none.dat: No such file or directory\n"
    bad = process("run", "-", input="\n".join(punched(40, 41, "      5O.3")))
    assert bad.returncode == 1 and "Traceback" not in bad.stderr
    assert bad.stderr.splitlines()[1:3] == [
        "             1         2         3         4         5         6         7         8",
        "    " + "1234567890" * 8,
    ]
    assert bad.stderr.splitlines()[4] == " " * 44 + "^" * 10
    many = ["-q", *[case] * 200]
    head = subprocess.run(
        ["bash", "-c", '"$@" 2>&1 | head -1', "-", sys.executable, "-m", "vopd", "run", *many],
        capture_output=True, text=True,
    )  # fmt: skip
    assert head.stdout == CASE_1[25].ljust(80) + "\n" and head.stderr == ""


# How a run ends

ODD = Finding("odd", "a.dat", severity="warning")
Said = pytest.CaptureFixture[str]


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    ("converged", "error", "warned", "status"),
    [
        ([[True, True]], None, False, (0, 0)),
        ([[True, True]], None, True, (0, 3)),
        ([[True, False]], None, False, (3, 3)),
        ([[True, False], [True]], None, False, (3, 3)),
        ([[True], [False, True]], None, True, (3, 3)),
        ([[False]], VopdError("a: wrong"), False, (1, 1)),
        ([[True]], VopdError("a: wrong"), True, (1, 1)),
    ],
)
def test_the_status_of_a_run(
    converged: list[list[bool]], error: VopdError | None, warned: bool, status: tuple[int, int],
    strict: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said,
) -> None:  # fmt: skip
    """And the end of the case is printed only where the deck came to its end."""
    results: list[Any] = [
        SimpleNamespace(frame=one, converged=np.array(one, bool)) for one in converged
    ]
    jobs = [SolvedJob("a", k, one) for k, one in enumerate(results, 1)]
    ends = SourceEnd("a", error, (ODD,) if warned else ())
    monkeypatch.setattr("vopd.cli.run.solve_decks", lambda *_: iter([*jobs, ends]))
    monkeypatch.setattr("vopd.cli.run.pages_of_jobs", lambda jobs: [[b"page\n"] for _ in jobs])
    monkeypatch.setattr("vopd.cli.run.end_of_case", lambda: b"end\n")
    ran = vopd("run", "a", *(["--strict"] if strict else []))
    assert ran.status == status[strict]
    assert ran.stdout == "page\n" * len(jobs) + ("" if error else "end\n")
    assert ran.stderr == "warning: a.dat: odd\n" * warned + ("a: wrong\n" if error else "")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (None, 0),
        (BrokenPipeError(), 0),
        (ReaderGone(), 0),
        (OSError(28, "No space left on device"), 1),
        (OSError(28, "No space left on device", "a.lst"), 1),
        (MemoryError(), 1),
        (VopdError("a.dat: wrong"), 1),
        (click.UsageError("no such option"), 2),
        (click.ClickException("wrong"), 1),
        (click.UsageError("option " * 999), 2),
        (click.Abort(), 130),
        (OSError(23, "Too many open files in system", "a.dat"), 1),
        (OSError(24, "Too many open files"), 1),
        (ImportError("libblas.so: failed to map segment from shared object"), 1),
        (FileNotFoundError(2, "No such file or directory"), 1),
        (FileNotFoundError(2, "No such file or directory", "a.dat"), 1),
    ],
)
def test_what_each_exception_becomes(
    error: BaseException | None, status: int, monkeypatch: pytest.MonkeyPatch,
    capsys: Said) -> None:  # fmt: skip
    """Where nothing more can be written, the rest of standard output is thrown away."""
    thrown: list[str] = []
    monkeypatch.setattr("vopd.cli.console.discard_output", lambda: thrown.append("away"))

    def command() -> None:
        if error is not None:
            raise error

    assert at_the_boundary(command) == status
    ended = capsys.readouterr()
    assert ended.out == ""
    assert_approved(ended.err)
    assert bool(thrown) == isinstance(error, OSError | ReaderGone)


def test_a_package_that_is_missing_is_no_lack_of_memory() -> None:
    def command() -> None:
        raise ImportError("No module named 'lost'")

    with pytest.raises(ImportError):
        at_the_boundary(command)


@pytest.mark.parametrize(("returned", "status"), [(3, 3), (None, 0), ("text", 0), (0, 0)])
def test_the_status_is_what_a_command_returns(returned: object, status: int) -> None:
    assert at_the_boundary(lambda: returned) == status


def test_jobs_are_grouped_by_their_frames() -> None:
    """A group ends with the job that brings it to 2000 frames, or with a flight."""

    def solved(frames: int) -> SolvedJob:
        results: Any = SimpleNamespace(frame=range(frames))
        return SolvedJob("a", 1, results)

    end, flight = SourceEnd("a"), object()
    sources = [solved(1999), end, solved(1), solved(1999), flight, solved(1), flight, end]
    sources += [solved(2000), solved(1000), solved(999), end]
    assert [len(group) for group in in_groups(iter(sources))] == [3, 2, 2, 2, 3]
    assert [one for group in in_groups(iter(sources)) for one in group] == sources
    assert not [*in_groups(iter(()))]


@pytest.mark.parametrize("quiet", [False, True])
def test_what_a_run_says_and_writes(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Warnings of jobs and decks; the fixes also if it is quiet; tape 10 beside a listing."""
    results: list[Any] = [
        SimpleNamespace(frame=[k], converged=np.array([True])) for k in (1, 2, 3, 4)
    ]
    jobs = [SolvedJob("a", k, one, (replace(ODD, card=k),)) for k, one in enumerate(results, 1)]
    ends = [SourceEnd("a", None, (replace(ODD, card=5),)), SourceEnd("b", None, (ODD,))]
    given: list[Any] = []
    events: list[Any] = []
    line = SimpleNamespace(add=events.append, close=lambda: events.append("wiped"))
    monkeypatch.setattr("vopd.cli.run.Progress", lambda unit: events.append(unit) or line)
    monkeypatch.setattr(
        "vopd.cli.run.solve_decks", lambda *one: given.append(one) or iter([*jobs, *ends])
    )
    page = b"STANDARD DEVIATION " * 2
    monkeypatch.setattr("vopd.cli.run.pages_of_jobs", lambda jobs: [[page, b"page "] for _ in jobs])
    monkeypatch.setattr("vopd.cli.run.end_of_case", lambda: b"end\n")
    monkeypatch.setattr("vopd.cli.run.tape_records", lambda one: b"tape %d " % one.frame[0])
    tape = tmp_path / "tape"
    options = ["--fix", "restart", "--tape10", tape, *(["-q"] if quiet else [])]
    ran = vopd("run", "a", "b", *options)
    assert ran.status == 0 and tape.read_bytes() == b"tape 1 tape 2 tape 3 tape 4 "
    assert ran.output == (page + b"page ") * 4 + b"end\nend\n"
    assert_approved(ran.stderr.splitlines())
    ((decks, solve),) = given
    assert decks == ("a", "b") and solve == SolveOptions(fixes("restart"))
    assert events == ["frames", *[2, 0] * 4, "wiped", "wiped"]
    assert vopd("run", "a", "--tape10", tape, "-o", tape).status == 1


def test_no_deck_is_read_where_the_tape_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vopd.cli.run.solve_decks", None)
    for options in (("--tape10", tmp_path), ("-o", tmp_path), ("--tape10", "in"), ("-o", "in")):
        monkeypatch.chdir(tmp_path)
        Path("in").write_text("before")
        assert vopd("run", "in", *options).status == 1
        assert Path("in").read_text() == "before"
