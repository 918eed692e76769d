"""`vopd attitude`: formats, exit statuses, what is said of each source, what sigmas leave out."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.attitude_files import EPOCH, deck_text
from tests.kit.command import CASE_1, DECKS, ROOT, Told, handed, telling, vopd
from tests.kit.flight_project import TOML, write_project
from tests.kit.jobs import reread
from vopd.attitude.findings import HistorySummary
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.cards.write import write_deck
from vopd.cli import adjust, attitude, histories, plot, report
from vopd.cli.console import Messages
from vopd.cli.histories import Collected
from vopd.cli.options import SharedOptions
from vopd.estimate import Words
from vopd.export import FORMATS
from vopd.figures import style
from vopd.findings import Finding, VopdError
from vopd.flight import result as flight_result
from vopd.job import GOES_ON
from vopd.pipeline import SolveOptions, read_deck
from vopd.results import SourceEnd

FIRST_BYTES = {
    "csv": b"# program: vopd",
    "jsonl": b'{"conventions": ',
    "npz": b"PK\x03\x04",
    "parquet": b"PAR1",
    "aem": b"CCSDS_AEM_VERS = 2.0\n",
    "acm": b"CCSDS_ACM_VERS = 2.0\n",
    "czml": b'[\n{"id": "document"',
    "kml": b"<?xml version='1.0' encoding='UTF-8'?>\n<kml ",
    "odm": b"EPSG:4326\n# vopd ",
    "colmap": b"# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n",
    "opk": b"# vopd ",
}
SUFFIXES = [(suffix, one.name) for one in FORMATS.values() for suffix in one.suffixes]


def dated(form: str) -> list[str]:
    """The option of an epoch, where a format has times."""
    return ["--epoch", EPOCH] if "epoch" in FORMATS[form].options else []


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with case 4 as `deck.dat`, and in it."""
    (tmp_path / "deck.dat").write_text(deck_text("case4"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("suffix", "form"), [*SUFFIXES, (".CSV", "csv"), (".Kml", "kml")])
def test_the_suffix_says_the_format(suffix: str, form: str, place: Path) -> None:
    assert vopd("attitude", "deck.dat", "-o", f"t{suffix}", *dated(form)).status == 0
    assert (place / f"t{suffix}").read_bytes().startswith(FIRST_BYTES[form])


@pytest.mark.parametrize("form", FORMATS)
def test_format_by_name_to_standard_output_and_file(form: str, place: Path) -> None:
    options = ("--format", form, *dated(form))
    result = vopd("attitude", "-", *options, stdin=deck_text("case4"))
    assert result.status == 0 and result.output.startswith(FIRST_BYTES[form])
    assert vopd("attitude", "deck.dat", *options, "-o", "t.txt").status == 0
    assert (place / "t.txt").read_bytes().startswith(FIRST_BYTES[form])


def test_csv_is_the_default(place: Path) -> None:
    assert vopd("attitude", "deck.dat").output.startswith(FIRST_BYTES["csv"])


BAD = [  # options, exit status, what is said
    (("-o", "t.xyz"), 2),
    (("-o", "table"), 2),
    (("-o", ""), 2),
    (("-o", "t.csv.gz"), 2),
    (("--format", "xlsx"), 2),
    (("-o", "t.aem"), 2),
    (("-o", "t.czml"), 2),
    (("-o", "t.aem", "--epoch", "yesterday"), 2),
    (("-o", "t.csv", "--epoch", "1974-02-30"), 2),
    (("-o", "t.kml", "--epoch", ""), 2),
    (("-o", "t.aem", "--epoch", "0001-01-01"), 1),
    (("-o", "t.aem", "--epoch", EPOCH, "--aem-version", "3"), 2),
    (("-o", "t.aem", "--epoch", EPOCH, "--originator", "\u00e9"), 2),
    (("-o", "t.aem", "--epoch", EPOCH, "--object-id", "x" * 201), 2),
    (("-o", "t.csv", "--aem-version", "1"), 2),
    (("-o", "t.csv", "--object-name", "X"), 2),
    (("-o", "t.kml", "--object-id", "X"), 2),
    (("-o", "t.csv", "--reading-sigma", "-1"), 2),
    (("-o", "t.csv", "--landmark-sigma", "nan"), 2),
    (("-o", "t.csv", "--max-rate", "0"), 2),
    (("-o", "t.csv", "--fix", "everything"), 2),
    (("-o", "missing/t.csv"), 1),
    (("-o", "folder.csv"), 1),
    (("-o", "deck.dat/t.csv"), 1),
    (("-o", "deck.dat", "--format", "csv"), 1),
    (("-o", "geo.txt", "--epoch", EPOCH), 2),
]


@pytest.mark.parametrize(("options", "expected"), BAD)
def test_bad_input_is_said_and_leaves_nothing(
    options: tuple[str, ...], expected: int, place: Path
) -> None:
    (place / "folder.csv").mkdir()
    result = vopd("attitude", "deck.dat", *options)
    assert (result.status, result.stdout) == (expected, "")
    assert_approved(" ".join(result.stderr.split()))
    assert sorted(path.name for path in place.rglob("*")) == ["deck.dat", "folder.csv"]
    assert (place / "deck.dat").read_text() == deck_text("case4")


def test_standard_input_is_no_folder_of_that_name(place: Path) -> None:
    (place / "-").mkdir()
    (place / "-" / "flight.toml").write_text("")
    result = vopd("attitude", "-", "-q", stdin=deck_text("case4"))
    assert result.status == 0 and "project" not in result.stdout


def test_no_deck_and_no_such_deck(place: Path) -> None:
    assert vopd("attitude").status == 2
    result = vopd("attitude", "none.dat", "-o", "t.csv")
    assert result.status == 1 and "none.dat" in result.stderr
    assert [path.name for path in place.iterdir()] == ["deck.dat"]


@pytest.mark.parametrize("form", FORMATS)
def test_no_frame_left(form: str, place: Path) -> None:
    """A deck whose only frame is ignored."""
    (job,) = read_deck("deck.dat")
    names = ("frame", "fiducial_in", "landmark", "present", "landmark_in")
    only = {name: getattr(job.readings, name)[:1] for name in names}
    alone = replace(job, readings=reread(job.readings, **only))
    (place / "one.dat").write_text(write_deck([alone]))
    (place / f"t{FORMATS[form].suffixes[0]}").write_text("what was there")
    result = vopd("attitude", "one.dat", "-o", f"t{FORMATS[form].suffixes[0]}", *dated(form))
    assert result.status == 1
    assert_approved(result.stderr)
    assert (place / f"t{FORMATS[form].suffixes[0]}").read_text() == "what was there"


def test_parquet_without_its_extra(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    result = vopd("attitude", "deck.dat", "-o", "t.parquet")
    assert result.status == 1
    assert_approved(result.stderr)
    assert [path.name for path in place.iterdir()] == ["deck.dat"]
    assert vopd("attitude", "deck.dat", "-o", "t.npz").status == 0


def test_a_wrong_source_date_epoch(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "today")
    result = vopd("attitude", "deck.dat", "-o", "t.aem", "--epoch", EPOCH)
    assert result.status == 1 and "SOURCE_DATE_EPOCH: 'today'" in result.stderr
    assert [path.name for path in place.iterdir()] == ["deck.dat"]


def test_a_binary_file_is_not_sent_to_a_terminal(place: Path) -> None:
    main, terminal = os.openpty()
    try:
        run = subprocess.run(
            [sys.executable, "-m", "vopd", "attitude", "deck.dat", "--format", "npz"],
            stdout=terminal, stderr=subprocess.PIPE, text=True,
            env=os.environ | {"PYTHONPATH": str(ROOT)}, check=False,
        )  # fmt: skip
    finally:
        os.close(terminal)
        os.close(main)
    assert run.returncode == 2 and "npz is binary: name a file with -o" in run.stderr


def test_one_deck_that_fails_does_not_keep_the_others(place: Path) -> None:
    result = vopd("attitude", "none.dat", "deck.dat", "-o", "t.npz", "-q")
    assert result.status == 1 and "none.dat" in result.stderr
    with np.load(place / "t.npz") as table:
        assert table["frame"].tolist() == [55, 60, 65]


def test_exit_status_of_flags(place: Path) -> None:
    """Two landmarks are a flag."""
    assert vopd("attitude", "deck.dat", "-o", "t.csv").status == 0
    result = vopd("attitude", "deck.dat", "-o", "s.csv", "--strict")
    assert result.status == 3 and "--strict: 2 frames are flagged" in result.stderr
    assert (place / "s.csv").read_bytes() == (place / "t.csv").read_bytes()
    one = vopd("attitude", DECKS / "appendix_h" / "case2.dat", "-o", "one.csv", "--strict")
    assert one.status == 3 and "--strict: 1 frame is flagged" in one.stderr


def test_a_frame_that_does_not_converge_is_status_3(place: Path) -> None:
    """Case 1 with the vehicle ten million feet to the west, as the run's own test has it."""
    cards = deck_text("case1").splitlines()
    cards[33:37] = [card[:10] + " -9999999." + card[20:] for card in cards[33:37]]
    (place / "far.dat").write_text("\n".join(cards) + "\n")
    result = vopd("attitude", "far.dat", "-o", "t.jsonl")
    assert result.status == 3 and "not_converged" in (place / "t.jsonl").read_text()
    both = vopd("attitude", "far.dat", "none.dat", "-o", "s.jsonl")
    assert both.status == 1


@cache
def status_of_run(deck: Path) -> int:
    """The exit status of `vopd run` with a deck, in the folder of the test that asks first."""
    return vopd("run", deck, "-o", "t.lst").status


@pytest.mark.parametrize("name", ["vanished", "zero_residuals", "asterisks", "ignored", "restart"])
@pytest.mark.parametrize("form", FORMATS)
def test_odd_decks_end_as_their_run_does(name: str, form: str, place: Path) -> None:
    """Frames without landmarks, without residuals, dropped: every format takes them."""
    deck = DECKS / "regression" / f"{name}.dat"
    result = vopd("attitude", deck, "-o", f"t{FORMATS[form].suffixes[0]}", "-q", *dated(form))
    assert result.status == status_of_run(deck), result.stderr
    assert (place / f"t{FORMATS[form].suffixes[0]}").read_bytes().startswith(FIRST_BYTES[form])


def test_a_corrected_run_says_so(place: Path) -> None:
    result = vopd("attitude", "deck.dat", "--fix", "earth")
    assert_approved(result.stderr)
    assert "\n# fixes: earth (WGS 84)\n" in result.stdout
    assert vopd("attitude", "deck.dat", "--fix", "earth", "-q").stderr == ""


def test_the_help_names_every_format_and_status() -> None:
    text = vopd("attitude", "--help").stdout
    for one in FORMATS.values():
        assert one.about in text and all(suffix in text for suffix in one.suffixes)
    assert all(f"{k} " in text.split("Exit status:")[1] for k in range(4))


# Errors that the sigmas leave out

SIGMAS = ["position", "landmark", "focal", "time", "mount", "velocity", "wind"]
KEYS = {
    "position": "[track] or [position] sigma_m",
    "landmark": "[landmarks] sigma_m",
    "focal": "[uncertainty] focal_rel",
    "principal point": "[uncertainty] principal_px",
    "time": "[track] sigma_t_s",
    "distortion": "[uncertainty] k1, k2, p1p2",
    "mount": "[vehicle] mount_sigma_deg",
    "velocity": "[track] velocity_sigma_m_s",
    "wind": "[wind] sigma_m_s",
}
START = re.compile(r"(?:the sigmas do not include errors of|not included): ")
ITEM = re.compile(r"([a-z][a-z ]*) \(([^:)]+)[^)]*\)")
"""A cause, and where it is to be stated; of flights with the effect of a round size."""


def named(source: object, *options: str) -> dict[str, str]:
    """The causes that are left out, and where each is to be stated."""
    ran = vopd("attitude", str(source), *options)
    assert ran.status == 0
    told = [line for line in ran.stderr.splitlines() if START.search(line)]
    assert len(told) <= 1 and all(line.startswith(f"{source}: ") for line in told)
    return dict(ITEM.findall(START.split(told[0])[1])) if told else {}


def test_a_deck_names_the_options_that_are_not_given() -> None:
    assert named(CASE_1) == {name: f"--{name}-sigma" for name in SIGMAS}
    for name in SIGMAS:
        assert named(CASE_1, f"--{name}-sigma", ".01").keys() == set(SIGMAS) - {name}
    assert named(CASE_1, *(word for name in SIGMAS for word in (f"--{name}-sigma", ".01"))) == {}
    assert named(CASE_1, "--quiet") == {}


def test_a_project_names_its_keys(tmp_path: Path) -> None:
    assert_approved(named(ROOT / "examples" / "hill" / "flight.toml"))
    project = write_project(tmp_path)
    text = project.read_text().replace('sigma_m = "exact"', "sigma_m = 0.1")
    project.write_text(f"{text}\n[uncertainty]\nfocal_rel = 0.001\n")
    left = ("principal point", "distortion", "mount", "wind")
    assert named(project) == {name: KEYS[name] for name in left}


def test_what_cannot_change_the_angles_is_not_named(tmp_path: Path) -> None:
    """A camera that does not move has no error by time, and no angles of attack."""
    project = write_project(tmp_path)
    fixed = '[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nheight = "ellipsoid"\n'
    project.write_text(f"{TOML[: TOML.index('[track]')]}{fixed}sigma_m = 3.0\n")
    assert_approved(named(project))


def test_sources_that_are_alike_are_said_once() -> None:
    decks = sorted((DECKS / "appendix_h").glob("case*.dat"))[:3]
    ran = vopd("attitude", *decks)
    assert_approved(ran.stderr, parts=[decks[0]])
    assert len(START.findall(ran.stderr)) == 1


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_the_table_is_the_same(form: str) -> None:
    quiet = vopd("attitude", CASE_1, "-q", "--format", form)
    assert vopd("attitude", CASE_1, "--format", form).output == quiet.output and not quiet.stderr


# How commands with histories end

USUAL = SharedOptions(SolveOptions(), HistoryOptions(), strict=False, quiet=False)
STRICT = replace(USUAL, strict=True)
QUIET = replace(STRICT, quiet=True)
ODD = Finding("odd", "a.dat", severity="warning")
Said = pytest.CaptureFixture[str]


def counted(*jobs: tuple[int, int]) -> list[Any]:
    """Jobs with so many frames that did not converge, and that are flagged."""
    return [SimpleNamespace(about=None, summary=HistorySummary(*one)) for one in jobs]


HISTORIES: list[tuple[list[Any], bool, SharedOptions, int, str]] = [
    (counted((0, 0)), False, USUAL, 0, ""),
    (counted((0, 0)), False, STRICT, 0, ""),
    (counted((0, 1)), False, USUAL, 0, ""),
    (counted((0, 1), (0, 0)), False, STRICT, 3, "--strict: 1 frame is flagged\n"),
    (counted((0, 1), (0, 1)), False, STRICT, 3, "--strict: 2 frames are flagged\n"),
    (counted((0, 2), (0, 3)), False, STRICT, 3, "--strict: 5 frames are flagged\n"),
    (counted((0, 2), (0, 3)), False, QUIET, 3, ""),
    (counted((0, 0), (1, 1)), False, USUAL, 3, ""),
    (counted((1, 1), (0, 0)), False, USUAL, 3, ""),
    (counted((1, 1)), True, USUAL, 1, ""),
    (counted((1, 1)), True, STRICT, 1, ""),
    (counted((0, 0)), True, QUIET, 1, ""),
]


@pytest.mark.parametrize(("jobs", "failed", "asked", "status", "said"), HISTORIES)
def test_the_status_of_attitude_histories(
    jobs: list[Any], failed: bool, asked: SharedOptions, status: int, said: str, capsys: Said
) -> None:
    assert Collected(Messages(asked.quiet), jobs, [], failed, False, 0).status(asked) == status
    assert capsys.readouterr().err == said


@pytest.mark.parametrize("flights", [1, 2])
def test_flights_whose_inputs_seem_wrong_are_counted(flights: int, capsys: Said) -> None:
    assert Collected(Messages(), [], [], False, False, flights).status(USUAL) == 0
    assert capsys.readouterr().err == ""
    assert Collected(Messages(), [], [], False, False, flights).status(STRICT) == 3
    assert_approved(capsys.readouterr().err)


def test_misfits_of_long_jobs_are_told_at_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """Of every job whose frames had not been counted, with the number that is not shown."""
    found = [replace(ODD, card=k) for k in range(1, 6)]
    monkeypatch.setattr(histories, "findings_of", lambda about, summary: found)
    jobs = counted((0, 0), (0, 0))
    assert Collected(Messages(), jobs, jobs[1:], False, False, 0).status(USUAL) == 0
    assert_approved(capsys.readouterr().err.splitlines(), parts=[1, 2, 3, 2])


class Job:
    """A flight that has been solved, or its history."""

    frames = 4
    misfits = mistaken = False
    next_clicks: tuple[str, ...] = ()
    unused: tuple[Finding, ...] = ()

    def __init__(self, name: str, has: bool = True, is_counted: bool = True) -> None:
        self.findings = (Finding(f"{name} is odd", severity="warning"),)
        self.about, self.summary, self.has, self.counted = name, HistorySummary(), has, is_counted
        self.whole = f"whole {name}"

    def history_parts(self, options: HistoryOptions) -> Job:
        assert options == SOLVED.history
        return self

    def has_attitude(self) -> bool:
        return self.has


SOLVED = replace(USUAL, history=HistoryOptions(Sigmas(reading=2.0), 7.0, "geodetic"))


def collected(
    monkeypatch: pytest.MonkeyPatch, *sources: Any, by_parts: bool = True, **asked: Any
) -> tuple[Collected, list[str]]:
    heard: list[str] = []
    names = tuple(asked.pop("names", "ab"))
    job = asked.pop("job", None)

    def solve(decks: tuple[str, ...], options: SolveOptions, sigmas: Sigmas) -> Iterator[Any]:
        assert sigmas == SOLVED.history.sigmas
        assert (decks, options) == (names, asked.get("solve", SolveOptions()))
        return iter(sources)

    def misfits(about: str, _: object) -> list[Finding]:
        return [Finding(f"{about} misfits", severity="warning")]

    def one_part(whole: str) -> Any:
        return Job(f"part of {whole}")

    monkeypatch.setattr(histories, "solve_sources", solve)
    monkeypatch.setattr(histories, "findings_of", misfits)
    monkeypatch.setattr(histories, "one_part", one_part)
    monkeypatch.setattr(flight_result, "unused_options", lambda one, options: one.unused)
    how = replace(SOLVED, **asked)
    return histories.collect_jobs(names, how, by_parts, heard.append, job=job), heard


def test_what_is_said_of_sources_in_their_order(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """Warnings, then the misfits of what is counted; an error of one does not stop the next."""
    sources = (Job("a"), SourceEnd("a", None, (ODD,)), SourceEnd("b", VopdError("b: wrong")),
               Job("c", is_counted=False))  # fmt: skip
    found, heard = collected(monkeypatch, *sources)
    expected = ["a is odd", "a misfits", "a.dat: odd", "b: wrong", "c is odd"]
    assert heard == expected
    lines = [one if one.startswith("b") else f"warning: {one}" for one in expected]
    assert capsys.readouterr().err.splitlines() == lines
    assert [one.about for one in found.jobs] == ["a", "c"] and found.failed
    assert [one.about for one in found.untold] == ["c"]
    found, heard = collected(monkeypatch, *sources, quiet=True)
    assert heard == expected and capsys.readouterr().err == "b: wrong\n"


def test_an_error_names_its_source_among_several(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """One of a file that the source names does not say it itself."""
    of_file = SourceEnd("b", VopdError("picks.csv: line 3: no number"))
    collected(monkeypatch, Job("a"), of_file, quiet=True)
    assert capsys.readouterr().err == "b: picks.csv: line 3: no number\n"


def test_flights_that_are_doubted_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those whose inputs seem wrong; one that misfits is enough."""
    jobs = [Job(name) for name in "abc"]
    jobs[0].misfits = jobs[0].mistaken = jobs[1].mistaken = True
    jobs[0].next_clicks, jobs[2].next_clicks = ("here", "there"), ("elsewhere",)
    jobs[1].unused = (ODD,)
    unread = SourceEnd("c", None, (Finding(GOES_ON, severity="warning"),))
    found, heard = collected(monkeypatch, *jobs, unread, SourceEnd("d"))
    assert (found.misfits, found.mistaken, found.unread) == (True, 2, 1)
    assert found.clicks == ("here", "there", "elsewhere") and str(ODD) in heard
    assert [one.about for one in collected(monkeypatch, *jobs, job=1)[0].jobs] == ["a", "b", "c"]
    with refused(VopdError):
        collected(monkeypatch, *jobs, job=2)


def test_where_parts_are_not_wanted_a_job_is_made_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    (job,) = collected(monkeypatch, Job("a", is_counted=False), by_parts=False)[0].jobs
    assert job.about == "part of whole a"  # type: ignore[comparison-overlap]


@pytest.mark.parametrize("quiet", [False, True])
def test_a_corrected_run_is_told(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    from vopd.errata import fixes

    solve = SolveOptions(fixes("restart"))
    collected(monkeypatch, Job("a"), quiet=True, solve=solve, names=("a.toml", "b.toml"))
    assert capsys.readouterr().err == ""
    collected(monkeypatch, Job("a"), quiet=quiet, solve=solve, names=("a.toml", "b"))
    shown = "warning: a is odd\nwarning: a misfits\n"
    found = capsys.readouterr().err
    assert bool(found) == (not quiet)
    assert_approved(found, parts=[shown] if not quiet else [])


def test_the_warnings_of_each_deck_are_counted_by_themselves(
    monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    ends = (SourceEnd("a", None, (ODD,) * 5), SourceEnd("b"), SourceEnd("c", None, (ODD,) * 4))
    collected(monkeypatch, Job("a"), *ends)
    lines = capsys.readouterr().err.splitlines()[2:]
    assert_approved(lines, parts=[2, 1])


def test_no_attitude_in_any_job(monkeypatch: pytest.MonkeyPatch) -> None:
    """One frame of one job suffices; what failed has been said already."""
    collected(monkeypatch, Job("a", has=False), Job("b"))
    with refused(VopdError):
        collected(monkeypatch, Job("a", has=False))
    with pytest.raises(click.exceptions.Exit) as ended:
        collected(monkeypatch, SourceEnd("a", VopdError("a: wrong")))
    assert ended.value.exit_code == 1


@pytest.mark.parametrize("quiet", [False, True])
def test_whole_histories_and_the_status_of_all(
    quiet: bool, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    """What is found at the end is heard too, and printed unless it is quiet."""
    heard: list[str] = []
    given: list[Any] = []
    asked = replace(USUAL, quiet=quiet)

    class Found:
        jobs = (SimpleNamespace(whole="one"), SimpleNamespace(whole="two"))

        def __init__(self, on_message: Any) -> None:
            self.messages = Messages(quiet, on_message)

        def status(self, how: SharedOptions) -> int:
            assert how == asked
            self.messages(ODD)
            return 3

    def collect(decks: Any, how: Any, by_parts: bool, on_message: Any, job: Any) -> Any:
        assert job is None
        given.append((decks, how, by_parts, on_message))
        return Found(on_message)

    monkeypatch.setattr(histories, "collect_jobs", collect)
    found = histories.collect_histories(("a", "b"), asked, heard.append)
    assert found == (["one", "two"], 3) and heard == ["a.dat: odd"]
    assert given[0][:3] == (("a", "b"), asked, False)
    given[0][3]("more")
    assert heard == ["a.dat: odd", "more"]
    assert capsys.readouterr().err == ("" if quiet else "warning: a.dat: odd\n")


def test_the_progress_counts_frames_and_is_wiped_at_the_end_of_a_deck(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    events: list[Any] = []
    line = SimpleNamespace(add=events.append, close=lambda: events.append("wiped"))
    monkeypatch.setattr(histories, "Progress", lambda unit, **_: events.append(unit) or line)
    collected(monkeypatch, Job("a"), Job("b"), SourceEnd("a"), Job("c"))
    assert events == ["frames solved", 4, 4, "wiped", 4]


# What is not sent to a terminal, and epochs


def test_what_is_missing_in_a_figure_is_noted_unless_it_is_quiet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Said
) -> None:
    flight = ROOT / "examples" / "hill" / "flight.toml"
    for quiet in ([], ["-q"]):
        words = "adjust", flight, "--free", "focal", "--figure", tmp_path / "a.svg", *quiet
        noted = handed(monkeypatch, style, "save", *words)[-1]
        words = "report", CASE_1, "-o", tmp_path / "a.html", *quiet
        for note in (noted, handed(monkeypatch, report, "report", *words)[-1]):
            note("a letter")
        assert capsys.readouterr().err == ("" if quiet else "a letter\na letter\n")


def test_the_name_of_a_page_and_of_a_figure() -> None:
    assert [adjust.figure_suffix(f"a{one}") for one in (".PNG", ".svg")] == [".png", ".svg"]
    for name in ("a.html", "a.HTM", "-"):
        report.check_page_name(name)
    for name in ("a.htmlx", "html", "a"):
        with refused(click.UsageError):
            report.check_page_name(name)


@pytest.mark.parametrize("command", ["plot", "report"])
def test_pictures_and_pages_are_not_sent_to_a_terminal(
    command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if command == "plot":
        monkeypatch.setattr(plot, "sys", SimpleNamespace(stdout=SimpleNamespace(isatty=bool_true)))
        words = ["--format", "png"]
    else:
        stdout = SimpleNamespace(isatty=bool_true)
        monkeypatch.setattr(report, "sys", SimpleNamespace(stdout=stdout))
        words = []
    ran = vopd(command, CASE_1, "-o", "-", *words)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)


def bool_true() -> bool:
    return True


@pytest.mark.parametrize("binary", [False, True])
def test_only_a_binary_table_is_not_sent_to_a_terminal(
    binary: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    stdout = SimpleNamespace(isatty=bool_true)
    monkeypatch.setattr(attitude, "sys", SimpleNamespace(stdout=stdout))
    monkeypatch.setattr(attitude, "collect_jobs", telling([]))
    words = ("attitude", "a.dat", "--format", "npz" if binary else "jsonl")
    if binary:
        ran = vopd(*words)
        assert ran.status == 2
        assert_approved(ran.stderr)
    else:
        with pytest.raises(Told):
            vopd(*words)


def test_the_progress_and_the_status_of_a_table(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Frames are counted as their parts are written, out of all; then the line is wiped."""
    events: list[Any] = []

    class Noted:
        def __init__(self, unit: str, total: int, stopped: str) -> None:
            events.append((unit, total, stopped))

        def add(self, count: int) -> None:
            events.append(count)

        def close(self) -> None:
            events.append("wiped")

    class Job:
        about = SimpleNamespace(epoch=None, source="a.dat", words=Words())
        uncertainty = SimpleNamespace(components={"reading": None, "mount": None})
        responses = SimpleNamespace(time=np.zeros(2))
        estimate = SimpleNamespace(attack_deg=np.array([[np.nan]]), responses=responses)
        head = SimpleNamespace(
            about=about, uncertainty=uncertainty, estimates=lambda: [(np.zeros(1), Job.estimate)]
        )
        frames = 7

        def watched(self, tell: Callable[[int], None]) -> int:
            tell(7)
            return 7

    def pages(jobs: list[int], _: object, report: Callable[[Finding], None]) -> Iterator[bytes]:
        events.append(("jobs", jobs))
        report(Finding("left out", "a.dat", severity="warning"))
        yield b"one"
        yield b"two"

    def found(_: object, how: SharedOptions, *__: object, **___: object) -> Collected:
        jobs: Any = [Job(), Job()]
        return Collected(Messages(how.quiet), jobs, [], False, False, 0)

    monkeypatch.setattr(Collected, "status", lambda *_: 3)
    monkeypatch.setattr(attitude, "Progress", Noted)
    monkeypatch.setattr(attitude, "collect_jobs", found)
    monkeypatch.setattr("vopd.export.AttitudeFormat.pages", lambda _, *rest: pages(*rest))
    ran = vopd("attitude", "a.dat", "-o", tmp_path / "t.csv")
    assert ran.status == 3 and (tmp_path / "t.csv").read_bytes() == b"onetwo"
    assert events == [
        ("frames written", 14, f"{tmp_path / 't.csv'} is not written"),
        7,
        7,
        ("jobs", [7, 7]),
        "wiped",
    ]
    assert_approved(ran.stderr)
    assert vopd("attitude", "a.dat", "-q").stderr == ""


@pytest.mark.parametrize(
    ("sources", "form", "told"),
    [
        (("a.dat", "b.toml"), "aem", True), (("b.toml", "a.dat"), "czml", True),
        (("b.TOML",), "acm", True), (("a.dat",), "aem", False), (("a.dat", "b.dat"), "acm", False),
        (("-",), "czml", False), (("a.dat",), "kml", True),
    ],
)  # fmt: skip
def test_only_a_flight_may_have_an_epoch_of_its_own(
    sources: tuple[str, ...], form: str, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(attitude, "collect_jobs", telling([]))
    if told:
        with pytest.raises(Told):
            vopd("attitude", *sources, "--format", form)
        return
    ran = vopd("attitude", *sources, "--format", form)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1], parts=[form])


@pytest.mark.parametrize(
    "name",
    [
        "t.xyz",
        "t",
    ],
)
def test_a_file_whose_suffix_names_no_format(name: str) -> None:
    ran = vopd("attitude", "a.dat", "-o", name)
    assert ran.status == 2
    assert_approved(ran.stderr.splitlines()[-1])
    assert_approved(ran.stderr)


@pytest.mark.parametrize("command", ["attitude", "plot", "report", "check", "run", "punch"])
def test_an_output_is_refused_before_a_source_is_read(command: str, tmp_path: Path) -> None:
    """The source is not there, but what is said is that the output cannot be written."""
    suffix = {"plot": ".svg", "report": ".html", "attitude": ".csv"}.get(command, ".txt")
    out = tmp_path / f"folder{suffix}"
    out.mkdir()
    ran = vopd(command, tmp_path / "none.toml", "-o", out)
    assert (ran.status, ran.stdout) == (1, "")
    assert_approved(ran.stderr, parts=[out])


@pytest.mark.parametrize(("given", "roll"), [((), "-178"), (("--roll", "360"), "182")])
def test_the_short_table_has_roll_as_it_is_asked_for(given: tuple[str, ...], roll: str) -> None:
    """181.95 degrees of frame 60: the option was taken and not used."""
    case_4 = DECKS / "appendix_h" / "case4.dat"
    shown = vopd("attitude", case_4, "--format", "text", *given).stdout
    (row,) = (line.split() for line in shown.splitlines() if line.startswith("   60"))
    assert row[6] == roll


def test_columns_may_stand_behind_blanks() -> None:
    ran = vopd("attitude", CASE_1, "--columns", "frame, vehicle_yaw_deg ,flags")
    assert "\nframe,vehicle_yaw_deg,flags\n" in ran.stdout
