"""What check, diff and attitude are asked for, and what is not sent to a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, Told, handed, telling, vopd
from vopd.cli import attitude, check, diff, plot, report
from vopd.cli.histories import Collected
from vopd.estimate import Words
from vopd.findings import Finding


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


@pytest.mark.parametrize(
    ("options", "spread", "limits"),
    [("", None, False), ("--spread .25", 0.25, False), ("--limits-1974", None, True)],
)
def test_what_a_check_of_a_deck_is_asked_for(
    options: str, spread: float | None, limits: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = handed(monkeypatch, check, "check_deck", "check", CASE_1, *options.split())
    assert found[1:] == (str(CASE_1), spread, limits)


def test_what_a_comparison_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Expected before actual; what lies between two listings."""
    monkeypatch.setattr(diff, "read_listing", lambda name: f"text of {name}")
    monkeypatch.setattr(diff, "undetermined_fields", lambda *texts: {"free": texts})
    words = ("diff", "e", "a", "--units", "2.5", "--undetermined", "l", "h")
    expected, actual, units, _, free = handed(monkeypatch, diff, "find_differences", *words)
    assert (expected, actual, str(units)) == ("text of e", "text of a", "2.5")
    assert free == {"free": ("text of l", "text of h")}
    found = handed(monkeypatch, diff, "find_differences", "diff", "e", "a")
    assert (str(found[2]), found[4]) == ("1", {})


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
        def __init__(self, unit: str, total: int) -> None:
            events.append((unit, total))

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

    found = Collected([Job(), Job()], [], False)  # type: ignore[list-item]
    monkeypatch.setattr(Collected, "status", lambda *_: 3)
    monkeypatch.setattr(attitude, "Progress", Noted)
    monkeypatch.setattr(attitude, "collect_jobs", lambda *_: found)
    monkeypatch.setattr("vopd.export.AttitudeFormat.pages", lambda _, *rest: pages(*rest))
    ran = vopd("attitude", "a.dat", "-o", tmp_path / "t.csv")
    assert ran.status == 3 and (tmp_path / "t.csv").read_bytes() == b"onetwo"
    assert events == [("frames written", 14), 7, 7, ("jobs", [7, 7]), "wiped"]
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
