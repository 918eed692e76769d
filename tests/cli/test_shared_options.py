"""Every option that several commands share: which columns of the table it changes, and no others.

The standard deviation of the readings is given, so that the other ones do not change its estimate.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import ROOT, handed, vopd
from tests.kit.histories import table_text
from vopd.cards.write import write_deck
from vopd.cli import attitude, batch, plot, report, run
from vopd.export import FORMATS
from vopd.findings import Finding, VopdError
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

HILL = ROOT / "examples" / "hill" / "flight.toml"
READING = {"deck": "--reading-sigma .002", "flight": "--reading-sigma 1"}
CAMERA, VEHICLE = (
    tuple(f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")) for body in ("camera", "vehicle")
)
ATTACK = ("alpha", "beta", "eta")
ANGLES = (*CAMERA, *VEHICLE, *ATTACK)
PAIRS = ("forward_forward", "forward_right", "forward_down", "right_right", "right_down")
COVARIANCE = {f"covariance_{pair}_deg2" for pair in (*PAIRS, "down_down")}
VARIANCES = {f"covariance_{one}_{one}_deg2" for one in ("forward", "right", "down")}


def degrees(prefix: str, *angles: str) -> set[str]:
    """The columns of some angles."""
    return {f"{prefix}{angle}_deg" for angle in angles}


def total(*angles: str) -> set[str]:
    """The columns of the whole uncertainty of some angles: standard deviation and interval."""
    widths = degrees("half_width_95_", *(angle for angle in angles if angle != "eta"))
    return degrees("sigma_", *angles) | widths | degrees("eta_", "low_95", "high_95")


def common(columns: set[str]) -> set[str]:
    """The columns of the covariance that all frames have in common."""
    return {one.replace("covariance_", "covariance_common_") for one in columns}


def component(name: str) -> set[str]:
    """The columns of one component of the uncertainty."""
    return degrees(f"sigma_{name}_", *ANGLES)


ALL = total(*ANGLES) | COVARIANCE | {"misfit_chance"}
QUATERNION = {f"quaternion_{one}" for one in "wxyz"}
RATE = "--max-rate .0001"


class Case(NamedTuple):
    """An option, and the columns that it changes besides the flags, which it may change."""

    option: str
    columns: set[str]
    solves: bool = False  # it may change all else that a solve finds


SIGMAS = [
    Case("--landmark-sigma 3000", ALL | component("landmark") | common(COVARIANCE)),
    Case("--position-sigma 4000", ALL | component("position")),
    Case("--focal-sigma 30", ALL | component("focal") | common(COVARIANCE)),
    Case("--time-sigma 3", ALL | component("time") | common(COVARIANCE)),
    Case("--velocity-sigma 100", total(*ATTACK) | component("velocity")),
    Case("--wind-sigma 200", total(*ATTACK) | component("wind")),
    Case(
        "--mount-sigma 2",
        total(*VEHICLE, *ATTACK) | component("mount") | VARIANCES | common(VARIANCES),
    ),
    Case(RATE, {"flags"}),
]
SOLVED_FOR = ("--landmark", "--position")
GIVEN = {"project", "job", "frame", "status", "time_s", "landmarks"}
CASES = {
    "deck": [
        *SIGMAS,
        Case("--reading-sigma .05", ALL | component("reading") | {"reading_sigma_mm"}),
        Case("--fiducial-sigma .02", ALL | component("centre")),
    ],
    "flight": [
        *(
            one._replace(solves=one.option.startswith(SOLVED_FOR))
            for one in SIGMAS
            if "velocity" not in one.option
        ),
        # the table has the component already, by the fit to the track
        Case("--velocity-sigma 100", total(*ATTACK) | degrees("sigma_velocity_", *ATTACK)),
        Case("--reading-sigma 7", ALL | component("reading") | {"reading_sigma_px"}, solves=True),
    ],
}


def film(*start_deg: float) -> str:
    """A synthetic flight of four frames as a deck, with another first estimate if one is given."""
    (job,) = make(Plan(frames=4))[0]
    camera = replace(job.camera, initial_deg=np.array(start_deg or job.camera.initial_deg))
    return write_deck([replace(job, camera=camera)])


DECK = film()
LOST = film(176.0, 80.0, 288.0)
"""The first estimate looks the other way: from there the solve ends with the landmarks behind."""


def table(*options: str, source: str = "deck", text: str = DECK) -> dict[str, list[str]]:
    """The columns of the table that `vopd attitude` writes."""
    name, stdin = (HILL, None) if source == "flight" else ("-", text)
    ran = vopd("attitude", name, "-q", *(" ".join(options).split()), stdin=stdin)
    found = columns_of(ran.stdout)
    lost = any("not_converged" in flags for flags in found["flags"])
    assert ran.status == (3 if lost else 0), ran.stderr
    return found


def columns_of(text: str) -> dict[str, list[str]]:
    """The columns of a CSV file."""
    head, *rows = csv.reader(line for line in text.splitlines() if line[:1] != "#")
    return dict(zip(head, map(list, zip(*rows, strict=True)), strict=True))


def changed(before: dict[str, list[str]], after: dict[str, list[str]]) -> set[str]:
    """The columns that differ, or that only one table has."""
    return {name for name in before | after if before.get(name) != after.get(name)}


@pytest.mark.parametrize(
    ("source", "case"),
    [(source, case) for source, cases in CASES.items() for case in cases],
    ids=lambda one: one if isinstance(one, str) else one.option,
)
def test_a_standard_deviation_changes_its_columns_and_no_others(source: str, case: Case) -> None:
    before = table(READING[source], source=source)
    known = () if case.option.startswith("--reading-sigma") else (READING[source],)
    after = table(*known, case.option, source=source)
    found = changed(before, after)
    assert case.columns <= found
    assert not found & GIVEN if case.solves else found <= case.columns | {"flags"}


GIVEN = {
    *("deck", "job", "frame", "status", "time_s", "landmarks", "altitude_ft", "airspeed_ft_s"),
    *(f"vehicle_{axis}_ft" for axis in ("east", "north", "up")),
}
"""What a table takes from the cards: no option of a solve changes it."""
EARTH = {"latitude_deg", "longitude_deg"}
SOLVES = [  # an option, those that both tables have, what it must change and what it must not
    ("--initial closed-form", "", degrees("", *ANGLES) | {"flags"}, GIVEN | EARTH),
    ("--fix restart", "", degrees("", *ANGLES), GIVEN | EARTH),
    ("--fix earth", "--initial closed-form", degrees("", *ANGLES) | EARTH, GIVEN),
    ("--ellipsoid clarke1866", "--fix earth", degrees("", *ANGLES) | EARTH, GIVEN),
    (
        "--vertical geodetic",
        "",
        degrees("", *CAMERA, *VEHICLE) | QUATERNION,
        GIVEN | EARTH | degrees("", *ATTACK) | total(*ATTACK) | COVARIANCE,
    ),
]


@pytest.mark.parametrize(
    ("option", "both", "columns", "others"), SOLVES, ids=[one[0] for one in SOLVES]
)
def test_an_option_of_the_solve_changes_the_angles_and_not_the_cards(
    option: str, both: str, columns: set[str], others: set[str]
) -> None:
    found = changed(table(both, text=LOST), table(both, option, text=LOST))
    assert columns <= found and not found & others


def test_options_that_change_no_column() -> None:
    """They say something, and set the status."""
    closed = ("attitude", "-", "--initial", "closed-form")
    plain = vopd(*closed, stdin=LOST)
    compared = vopd(*closed, "--compare-initial", stdin=LOST)
    assert (compared.status, compared.stdout) == (0, plain.stdout)
    told = "warning: -: job 1, group 8: frames 1-4: the deck's first estimate leads to another"
    assert told in compared.stderr and told not in plain.stderr
    assert vopd(*closed, "--compare-initial", "--quiet", stdin=LOST).stderr == ""
    strict = vopd(*closed, "--strict", stdin=LOST)
    assert (strict.status, strict.stdout) == (3, plain.stdout)
    many = DECK.replace("\n   50   10", "\n   51   10")
    limited = vopd("attitude", "-", "--limits-1974", stdin=many)
    assert limited.status == 1
    assert_approved(limited.stderr)


TOGETHER = (
    "--reading-sigma .002 --fiducial-sigma .003 --landmark-sigma 40 --position-sigma 300 "
    "--focal-sigma .1 --time-sigma .02 --velocity-sigma 5 --wind-sigma 8 --mount-sigma .2 "
    "--vertical geocentric --initial closed-form --fix earth --ellipsoid clarke1866 --max-rate .5"
)
"""Every option that changes a column, each with an effect."""


def test_each_of_the_options_together_has_an_effect() -> None:
    """So that a command that ignores one of them makes another table."""
    options = [f"--{one.strip()}" for one in TOGETHER.split("--")[1:]]
    full = table(TOGETHER, text=LOST)
    for one in options:
        rest = [option for option in options if option != one]
        if one.startswith("--fix"):  # an ellipsoid alone is wrong usage
            rest = [option for option in rest if not option.startswith("--ellipsoid")]
        assert changed(full, table(*rest, text=LOST)), one


def test_every_command_with_histories_makes_the_table_of_vopd_attitude(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`vopd plot`, `vopd report` and `vopd batch` are handed the same options."""
    monkeypatch.chdir(tmp_path)
    Path("lost.dat").write_text(LOST)
    own = {"deck": ["lost.dat"] * 4}
    expected = table(TOGETHER, text=LOST) | own
    drawn: list[Any] = []

    def keep(*given: Any, **_: Any) -> bytes:
        drawn.extend(given)
        return b"a picture"

    monkeypatch.setattr(plot, "draw", keep)
    monkeypatch.setattr(plot, "save", lambda picture, *_: picture)
    monkeypatch.setattr(report, "report", keep)
    options = TOGETHER.split()
    assert vopd("plot", "lost.dat", "-o", "lost.svg", *options).status == 0
    assert {name: list(text) for name, text in table_text(drawn[1]).items()} == expected
    drawn.clear()
    assert vopd("report", "lost.dat", "-o", "lost.html", *options).status == 0
    assert {name: list(text) for name, text in table_text(drawn[0]).items()} == expected
    assert drawn[2] == 0.5  # degrees a second, which the page states
    assert vopd("batch", "lost.dat", "-d", "solved", *options).status == 0
    assert columns_of(Path("solved/lost.csv").read_text()) == expected


def test_a_batch_solves_a_flight_with_the_sigmas_of_its_command(tmp_path: Path) -> None:
    """Its angles weigh by them, too, which those of a deck do not."""
    options = "--reading-sigma 1 --position-sigma 4000 --landmark-sigma 3"
    expected = table(options, source="flight")
    angles = degrees("", *CAMERA)
    assert angles <= changed(table(READING["flight"], source="flight"), expected)
    assert vopd("batch", HILL, "-d", tmp_path / "solved", "-q", *options.split()).status == 0
    (made,) = (tmp_path / "solved").rglob("flight.csv")
    assert columns_of(made.read_text()) == expected


def test_vopd_run_solves_as_vopd_attitude_does() -> None:
    """The angles of the listing, to its three decimals."""
    for options in (
        "",
        "--initial closed-form",
        "--fix earth",
        "--fix earth --ellipsoid clarke1866",
    ):
        expected = table(options, text=LOST)
        listed = vopd("run", "-", *options.split(), stdin=LOST).stdout.splitlines()
        rows = [listed[k + 1].split() for k, line in enumerate(listed) if line[:8] == "0 FRAME "]
        names = [f"{angle}_deg" for angle in CAMERA]
        shown = [[f"{float(expected[name][k]):.3f}" for name in names] for k in range(4)]
        assert [row[2:5] for row in rows] == shown, options


def test_this_page_has_every_shared_option() -> None:
    shared = {
        name
        for parameter in attitude.command.params
        if any(parameter.name == other.name for other in report.command.params)
        for name in parameter.opts
        if name.startswith("--")
    } - {"--output"}
    tested = {option for option in TOGETHER.split() if option.startswith("--")}
    alone = {"--compare-initial", "--limits-1974", "--strict", "--quiet", "--help-decks"}
    assert shared == tested | alone
    for command in (plot.command, batch.command):
        assert shared <= {name for parameter in command.params for name in parameter.opts}
    solve = {"--fix", "--ellipsoid", "--initial", "--compare-initial", "--limits-1974"}
    assert solve <= {name for parameter in run.command.params for name in parameter.opts}


# Options that are wrong, and the epoch

WRONG = [
    "--max-rate 0",
    "--max-rate -1.5",
    "--max-rate nan",
    "--ellipsoid wgs84",
    "--ellipsoid wgs84 --fix restart",
    "--compare-initial",
    "--fix nothing",
]


@pytest.mark.parametrize("options", WRONG)
def test_options_that_are_wrong_or_have_no_effect(options: str) -> None:
    ran = vopd("attitude", "none.dat", *options.split())
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)


@pytest.mark.parametrize("form", FORMATS)
def test_only_formats_with_rows_are_written_by_parts(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    dated = ["--epoch", "2000-01-01"] * FORMATS[form].needs_epoch
    words = ("attitude", "a.dat", "--format", form, *dated)
    by_parts = handed(monkeypatch, attitude, "collect_jobs", *words)[2]
    assert by_parts == (form in ("csv", "jsonl"))


EPOCH = datetime(2000, 1, 1, tzinfo=UTC)


@pytest.mark.parametrize("form", ["csv", "aem", "acm", "czml", "kml"])
@pytest.mark.parametrize("given", [None, EPOCH])
@pytest.mark.parametrize("own", [(None, None), (EPOCH, EPOCH), (None, EPOCH)])
def test_the_epoch_is_that_of_the_option_or_of_all_sources(
    form: str, given: datetime | None, own: tuple[datetime | None, ...]
) -> None:
    other = datetime(1999, 1, 1, tzinfo=UTC)
    request = attitude._request(FORMATS["csv"], None, {}, True)
    request = replace(request, epoch=other if given else None)
    jobs: Any = [
        SimpleNamespace(
            about=SimpleNamespace(epoch=one, source=f"{k}.toml"),
            estimate=SimpleNamespace(time_s=np.array([2.0])),
        )
        for k, one in enumerate(own)
    ]
    said = list[Finding]()
    if given:
        assert attitude._with_epoch(FORMATS[form], request, jobs, said.append).epoch == other
        assert len(said) == len([one for one in own if one is not None])
    elif own == (EPOCH, EPOCH):
        assert attitude._with_epoch(FORMATS[form], request, jobs, said.append).epoch == EPOCH
    elif form in ("csv", "kml"):
        assert attitude._with_epoch(FORMATS[form], request, jobs, said.append).epoch is None
    else:
        with refused(VopdError, parts=[form]):
            attitude._with_epoch(FORMATS[form], request, jobs, said.append)
