"""Lists that are written in pieces, the order of what is asked for, and what a refusal names."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import permutations
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, vopd
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.batch.sources import BatchSettings
from vopd.cli import diff
from vopd.errata import fixes
from vopd.pipeline import SolveOptions

PAGE = (Path(__file__).parents[1] / "listing" / "case1_page.lst").read_text(encoding="ascii")
LINES = PAGE.count("\n")


@pytest.mark.parametrize("at_once", [1, 2, 4, 5, 6])
@pytest.mark.parametrize("form", ["text", "json"])
def test_every_difference_is_written_however_many_go_at_once(
    at_once: int, form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Five pages differ in line 18 each, which is 75.837 in one listing and 75.836 in the other."""
    monkeypatch.setattr(diff, "WRITTEN_AT_ONCE", at_once)
    for name, page in (("a", PAGE), ("b", PAGE.replace(" 75.837", " 75.836"))):
        (tmp_path / name).write_text(page * 5, encoding="ascii")
    ran = vopd("diff", "--units", "0", "--format", form, tmp_path / "a", tmp_path / "b")
    assert ran.status == 1
    lines = [18 + k * LINES for k in range(5)]
    if form == "json":
        written = json.loads(ran.stdout)["differences"]
        assert [one["page"] for one in written] == [1, 2, 3, 4, 5]
        assert [one["expected_line"] for one in written] == lines
        return
    *written, last = ran.stdout.splitlines()
    assert written == [
        f"page {k}, frame 730, line {line}, PHI: expected 75.837, actual 75.836 (off by 1)"
        for k, line in enumerate(lines, 1)
    ]
    assert last.startswith("5 differences; 405 fields on 5 pages compared")


@pytest.mark.parametrize("names", [*permutations(["restart", "earth", "sin-6phi"])])
def test_errata_come_in_the_order_in_which_they_are_asked_for(names: tuple[str, ...]) -> None:
    rows = json.loads(vopd("errata", *names, "--format", "json").stdout)
    assert [row["name"] for row in rows] == list(names)
    text = vopd("errata", *names).stdout
    headings = [line for line in text.splitlines() if line and not line.startswith(" ")]
    assert headings == list(names)


@pytest.mark.parametrize("units", ["-1", "-0.001", "nan", "inf", "one", ""])
def test_a_refused_number_of_units_is_named_with_its_option(units: str, tmp_path: Path) -> None:
    (tmp_path / "a").write_text(PAGE, encoding="ascii")
    ran = vopd("diff", tmp_path / "a", tmp_path / "a", f"--units={units}")
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1], parts=[f"{units!r}"])


@pytest.mark.parametrize("units", ["0", "0.001", "-0"])
def test_numbers_of_units_from_0_on_are_taken(units: str, tmp_path: Path) -> None:
    (tmp_path / "a").write_text(PAGE, encoding="ascii")
    assert vopd("diff", tmp_path / "a", tmp_path / "a", f"--units={units}").status == 0


@pytest.mark.parametrize(
    "command",
    [
        ("run",), ("run", CASE_1), ("attitude",), ("cards",), ("check",), ("punch",), ("report",),
        ("plot",), ("diff", CASE_1), ("diff", "--undetermined", CASE_1, CASE_1, CASE_1),
    ],
)  # fmt: skip
def test_no_command_writes_over_its_last_input(
    command: tuple[str | Path, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is refused by whatever name, whatever is in it, and is what it was."""
    monkeypatch.chdir(tmp_path)
    suffix = {"punch": ".toml", "plot": ".svg", "attitude": ".csv", "report": ".html"}
    name = "in" + suffix.get(str(command[0]), ".txt")
    content = PAGE if command[0] == "diff" else CASE_1.read_text()
    (tmp_path / name).write_text(content)
    listing = tmp_path / "page"
    listing.write_text(PAGE)
    given = [listing if one == CASE_1 and command[0] == "diff" else one for one in command]
    ran = vopd(*given, name, "-o", f"./{name}")
    assert (ran.status, ran.stdout) == (1, "")
    assert_approved(ran.stderr.splitlines()[-1], parts=[name])
    assert (tmp_path / name).read_text() == content


OPTIONS: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {
    "none": ((), {}),
    "reading": (("--reading-sigma", "2"), {"history": HistoryOptions(Sigmas(reading=2.0))}),
    "fiducial": (("--fiducial-sigma", "2"), {"history": HistoryOptions(Sigmas(fiducial=2.0))}),
    "wind": (("--wind-sigma", "2"), {"history": HistoryOptions(Sigmas(wind=2.0))}),
    "rate": (("--max-rate", "40"), {"history": HistoryOptions(max_rate_deg_s=40.0)}),
    "geocentric": (
        ("--vertical", "geocentric"),
        {"history": HistoryOptions(vertical="geocentric")},
    ),
    "geodetic": (("--vertical", "geodetic"), {"history": HistoryOptions(vertical="geodetic")}),
    "formats": (("--format", "kml", "--format", "csv"), {"formats": ("kml", "csv")}),
    "report": (("--report",), {"report": True}),
    "fix": (("--fix", "restart"), {"solve": SolveOptions(fixes("restart"))}),
    "initial": (("--initial", "closed-form"), {"solve": SolveOptions(initial="closed-form")}),
    "limits": (("--limits-1974",), {"solve": SolveOptions(limits_1974=True)}),
    "strict": (("--strict",), {}),
    "quiet": (("--quiet",), {}),
}


@pytest.mark.parametrize("name", OPTIONS)
def test_every_option_of_a_batch_is_in_its_settings_and_no_other(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given, changes = OPTIONS[name]
    made: list[BatchSettings] = []

    def run(_: object, settings: BatchSettings, *__: object, **places: object) -> list[Any]:
        made.append(settings)
        return []

    monkeypatch.setattr("vopd.batch.workers.run_batch", run)
    out = tmp_path / "out"
    assert vopd("batch", CASE_1, "-d", out, *given).status == 0
    (settings,) = made
    usual = BatchSettings(str(out), settings.working, SolveOptions(), HistoryOptions(), ("csv",))
    assert settings == replace(usual, **changes)


@pytest.mark.parametrize(
    "given",
    [
        ("--job", "1"),
        ("--job", "1", "--gcp", "marks.csv"),
        ("--deck", CASE_1, "--gcp", "marks.csv"),
        ("--deck", CASE_1, "--lens", "l.json", "--job", "1"),
    ],
)
def test_options_of_a_new_project_that_exclude_each_other(
    given: tuple[str | Path, ...], tmp_path: Path
) -> None:
    ran = vopd("new", tmp_path / "p", *given)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1])
    assert not (tmp_path / "p").exists()
