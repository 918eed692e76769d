"""Options from both sides of their limits, what wrong ones say, and what is refused before work."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from itertools import permutations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS, ROOT, handed, vopd
from vopd.attitude.history import HistoryOptions
from vopd.batch import workers as runs
from vopd.cli import batch, cli, diff, plot
from vopd.cli.attitude import _request
from vopd.cli.batch import _shard
from vopd.cli.cards import SHOWN, CardChoice
from vopd.cli.options import SharedOptions
from vopd.cli.stars.options import _place, image_axes, sky_request
from vopd.export import FORMATS
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions
from vopd.stellar.files import table as read_solution
from vopd.stellar.files.table import ReadSolution
from vopd.synthetic import LIMITS, Plan

EPOCH = "1974-08-27T17:30:00Z"


@pytest.mark.parametrize("form", ["aem", "acm"])
@pytest.mark.parametrize("option", ["originator", "object_name", "object_id"])
@pytest.mark.parametrize(
    ("text", "good"),
    [("x" * 200, True), ("x" * 201, False), ("Zürich", False), ("a\x01b", False), (" a  b ", True)],
)
def test_texts_in_messages_have_200_ascii_characters(
    form: str, option: str, text: str, good: bool
) -> None:
    if good:
        asked = _request(FORMATS[form], EPOCH, {option: text}, False)
        assert getattr(asked, option) == text
    else:
        with refused(click.UsageError):
            _request(FORMATS[form], EPOCH, {option: text}, False)


@pytest.mark.parametrize("form", ["czml", "kml"])
def test_a_viewer_shows_any_name(form: str) -> None:
    asked = _request(FORMATS[form], EPOCH, {"object_name": "Zürich" * 99}, False)
    assert asked.object_name == "Zürich" * 99 and asked.originator == "VOPD"


@pytest.mark.parametrize("form", FORMATS)
def test_each_format_takes_its_options_and_no_others(form: str) -> None:
    """Every other one is refused, with the formats that take it."""
    takers = {
        "aem_version": ["aem"], "originator": ["aem", "acm"], "object_id": ["aem", "acm"],
        "object_name": ["aem", "acm", "czml", "kml"],
    }  # fmt: skip
    for name, formats in takers.items():
        given = {name: "1"}
        if form in formats:
            asked = _request(FORMATS[form], EPOCH, given, False)
            assert str(getattr(asked, name)) == "1"
            continue
        with pytest.raises(click.UsageError) as refusal:
            _request(FORMATS[form], EPOCH, given, False)
        option = "--" + name.replace("_", "-")
        assert refusal.value.message == f"{option} is for {', '.join(formats)}, not {form}."


def test_what_a_file_has_without_an_option() -> None:
    """Version 2 of the message, from VOPD; the vehicle has no name."""
    asked = _request(FORMATS["aem"], EPOCH, {}, False)
    assert (asked.aem_version, asked.originator) == (2, "VOPD")
    assert (asked.object_name, asked.object_id) == ("", "")
    assert asked.epoch == datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
    assert _request(FORMATS["aem"], EPOCH, {"aem_version": 1}, False).aem_version == 1


@pytest.mark.parametrize("form", FORMATS)
def test_formats_with_dates_need_an_epoch_unless_a_flight_may_have_one(form: str) -> None:
    needs = form in ("aem", "acm", "czml")
    assert _request(FORMATS[form], None, {}, True).epoch is None
    if needs:
        with refused(click.UsageError):
            _request(FORMATS[form], None, {}, False)
    else:
        assert _request(FORMATS[form], None, {}, False).epoch is None


@pytest.mark.parametrize(
    ("spread", "is_wrong"),
    [("nan", True), ("-0.001", True),
     ("x", True), ("0", False), ("1e9", False)],
)  # fmt: skip
def test_the_spread_of_readings_is_0_inches_or_more(spread: str, is_wrong: bool) -> None:
    ran = vopd("check", CASE_1, "--spread", spread)
    if is_wrong:
        assert (ran.status, ran.stdout) == (2, "")
        assert_approved(ran.stderr)
    else:
        assert ran.status == 0 and ("readings" in ran.stdout) == (spread == "0")


@pytest.mark.parametrize("option", ["track --residual", "track --least-correlation", "pick --dpi"])
def test_nan_is_in_no_range(option: str) -> None:
    command, name = option.split()
    ran = vopd(command, "frame_0001.png", name, "nan")
    assert ran.status == 2
    assert_approved(ran.stderr)


@pytest.mark.parametrize(
    ("size", "dpi", "largest"),
    [
        ("100x100", 150, None), ("100.1x6", 150, "100"), ("8x100.1", 150, "100"),
        ("100x100", 200, None), ("99.6x6", 201, "99.5025"), ("20x20", 1000, None),
        ("20.1x6", 1000, "20"), ("8x20.1", 1000, "20"),
    ],
)  # fmt: skip
def test_a_picture_has_100_inches_and_20000_dots_at_most(
    size: str, dpi: int, largest: str | None
) -> None:
    if largest is None:
        assert plot._inches("attitude", size, dpi) == tuple(map(float, size.split("x")))
        return
    with pytest.raises(click.UsageError) as refusal:
        plot._inches("attitude", size, dpi)
    assert_approved(refusal.value.message, parts=[f"{size!r}", largest])


@pytest.mark.parametrize("size", ["9", "9x6x3", "axb", "", "9;6"])
def test_a_size_is_two_numbers(size: str) -> None:
    with refused(click.UsageError):
        plot._inches("attitude", size, 150)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("1/1", (1, 1)), ("3/3", (3, 3)), ("1/999999999", (1, 999999999)), ("0/3", None),
        ("4/3", None), ("1/1234567890", None), ("-1/3", None), ("1/3x", None), (None, (1, 1)),
    ],
)  # fmt: skip
def test_a_part_of_a_batch(text: str | None, part: tuple[int, int] | None) -> None:
    given: Any = None
    if part is None:
        with refused(click.BadParameter):
            _shard(given, given, text)
    else:
        assert part is not None and _shard(given, given, text) == part


def test_failures_that_are_not_shown_are_counted_without_the_others(tmp_path: Path) -> None:
    missing = [tmp_path / f"no-{k:02d}.dat" for k in range(21)]
    ran = vopd("batch", CASE_1, *missing, "-d", tmp_path / "out")
    assert ran.status == 3
    assert_approved(ran.stderr.splitlines()[20:])


@pytest.mark.parametrize(("job", "status"), [("0", 2), ("1", 0), ("2", 1)])
def test_a_deck_has_jobs_up_to_its_last(job: str, status: int, tmp_path: Path) -> None:
    ran = vopd("new", tmp_path / "p", "--deck", CASE_1, "--job", job)
    assert ran.status == status
    if status == 1:
        assert_approved(ran.stderr, parts=[CASE_1])
    assert (tmp_path / "p" / "flight.toml").exists() == (status == 0)


# Options of star photographs

IMAGE: dict[str, Any] = dict.fromkeys(("focal", "focal_px", "pitch_um", "centre", "size", "k1"))
IMAGE["y_down"] = None
SKY: dict[str, Any] = dict.fromkeys(
    ("date", "place", "pressure", "temperature", "ephemeris", "catalogue", "mount")
)


@pytest.mark.parametrize(
    ("given", "is_wrong"),
    [
        ({"size": (0.0, 5.0)}, True),
        ({"size": (5.0, 0.0)}, True),
        ({"size": (0.1, 0.1)}, False),
        ({"focal": 50.0, "focal_px": 900.0}, True),
        ({"pitch_um": 5.0}, True),
        ({"pitch_um": 5.0, "focal_px": 900.0}, True),
        ({"pitch_um": 5.0, "focal": 50.0}, False),
    ],
)
def test_options_of_the_image(given: dict[str, Any], is_wrong: bool) -> None:
    if is_wrong:
        with pytest.raises(click.UsageError) as refusal:
            image_axes(IMAGE | given)
        assert_approved(refusal.value.message)
        return
    axes = image_axes(IMAGE | given | {"k1": (0.25,), "y_down": True, "centre": (1.0, 2.0)})
    assert (axes.focal_mm, axes.pitch_um) == (given.get("focal"), given.get("pitch_um"))
    assert (axes.size_px, axes.centre_px) == (given.get("size"), (1.0, 2.0))
    assert axes.k1 == 0.25 and axes.y_down
    assert image_axes(IMAGE).k1 == 0.0


@pytest.mark.parametrize(
    ("place", "good"),
    [
        ("90,0,0", True), ("-90,0,0", True), ("90.1,0,0", False), ("-90.1,0,0", False),
        ("0,360,0", True), ("0,-360,0", True), ("0,360.1,0", False), ("0,-360.1,0", False),
        ("0,0,999999", True), ("0,0,1e6", False), ("0,0,-1e6", False), ("0,0", False),
    ],
)  # fmt: skip
def test_a_place_is_on_the_earth(place: str, good: bool) -> None:
    given: Any = click.Option(["--place"])
    context = click.Context(click.Command("solve"))
    if good:
        assert _place(context, given, place) == tuple(map(float, place.split(",")))
    else:
        with pytest.raises(click.BadParameter):
            _place(context, given, place)


@pytest.mark.parametrize(
    ("given", "is_wrong"),
    [
        ({"pressure": (0.0,)}, False), ({"pressure": (-0.1,)}, True),
        ({"pressure": (814.0,)}, False), ({"pressure": (813.0,)}, True),
        ({"pressure": (1064.0,)}, False), ({"pressure": (1065.0,)}, True),
        ({"pressure": (28.9,)}, True), ({"pressure": (733.0,)}, True),
        ({"pressure": (97.7,)}, True),
        ({"temperature": (-100.0,)}, False), ({"temperature": (-101.0,)}, True),
        ({"temperature": (60.0,)}, False), ({"temperature": (283.0,)}, True),
    ],
)  # fmt: skip
def test_options_of_the_air(given: dict[str, Any], is_wrong: bool) -> None:
    """Limits of the pressure by hand: 850 mbar exp(-300 / 6800) and 1100 mbar exp(-300 / 9100)."""
    there = {"place": (47.0, 16.0, 300.0)}
    with refused(click.UsageError):
        sky_request(SKY | given)
    if is_wrong:
        with pytest.raises(click.UsageError) as refusal:
            sky_request(SKY | there | given)
        assert_approved(refusal.value.message)
        return
    asked = sky_request(SKY | there | given)
    assert asked.place == there["place"]
    assert asked.pressure_mbar == given.get("pressure", (None,))[0]
    assert asked.temperature_c == given.get("temperature", (10.0,))[0]


# Cards, photographs and limits of the help


def chosen(*groups: str, cards: tuple[str, ...] = ()) -> list[int]:
    """Of a deck of cards 1 to 60, of group 8 up to 10 and then basic data, those explained."""
    choice = CardChoice(groups, cards)
    return [card for card in range(1, 61) if choice(8 if card <= 10 else 0, card)]


def test_cards_are_chosen_by_group_and_by_number() -> None:
    """With both, cards of that group among those numbers; basic data is held back unasked."""
    assert SHOWN == 21
    assert chosen() == [*range(1, 32)]
    assert chosen("8") == [*range(1, 11)]
    assert chosen("basic") == [*range(11, 61)]
    assert chosen("8", "basic") == [*range(1, 61)]
    assert chosen(cards=("9-12", "40")) == [9, 10, 11, 12, 40]
    assert chosen("8", cards=("9-12", "40")) == [9, 10]
    assert chosen("basic", cards=("9-12", "40")) == [11, 12, 40]
    assert chosen("9") == []
    choice = CardChoice((), ())
    for card in range(1, 61):
        choice(0, card)
    assert choice.held_back == 60 - 21


@pytest.mark.parametrize(
    ("groups", "cards", "is_wrong"),
    [
        ((), ("61",), True),
        ((), ("5-61", "3"), True),
        (("9",), (), True),
        (("9", "1"), (), True),
        (("9", "basic"), (), False),
        (("9", "12"), ("1-5",), True),
        ((), ("60",), False),
    ],
)
def test_cards_that_are_not_there(
    groups: tuple[str, ...], cards: tuple[str, ...], is_wrong: bool
) -> None:
    choice = CardChoice(groups, cards)
    for card in range(1, 61):
        choice(8 if card <= 10 else 0, card)
    if is_wrong:
        with refused(VopdError):
            choice.check_all_found("d")
    else:
        choice.check_all_found("d")


def test_the_help_of_demo_has_every_default_and_both_limits() -> None:
    text = re.sub(r"\s+", " ", vopd("demo", "--help").stdout)
    for part, (low, high) in LIMITS.items():
        default = getattr(Plan, part)
        shown = " ".join(map(str, default)) if isinstance(default, tuple) else f"{default:g}"
        if part == "seed":
            assert f"[default: {shown}]" in text
        else:
            limits = [f"{one:,.0f}" if one == int(one) else repr(one) for one in (low, high)]
            assert f"[default: {shown}; {limits[0]} to {limits[1]}]" in text, part


def photograph(image: str, stars: int) -> Any:
    some = np.zeros((stars, 2))
    return ReadSolution(image, "svd", (), some, some, "mm", (1.0, 2.0, 3.0), (), "", None)


def test_of_star_photographs_the_one_asked_for_or_with_the_most_stars_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held = {"a.json": [photograph("one", 3), photograph("two", 7)], "b.json": [photograph("", 5)]}
    monkeypatch.setattr(read_solution, "read_solutions", held.__getitem__)
    monkeypatch.setattr(plot, "draw_star_residuals", lambda picture, size: picture)
    found, _ = plot.plot_stars(["b.json", "a.json"], None, None)
    assert found.title.startswith("a.json, two: svd, 7 stars, ")
    found, _ = plot.plot_stars(["a.json", "b.json"], None, None)
    assert found.title.startswith("a.json, two: svd, 7 stars, ")
    assert plot.plot_stars(["a.json"], "one", None)[0].title.startswith("a.json, one: svd, 3 st")
    assert plot.plot_stars(["b.json"], None, None)[0].title.startswith("b.json: svd, 5 stars")
    with refused(VopdError):
        plot.plot_stars(["a.json", "b.json"], "three", None)
    with refused(VopdError):
        plot.plot_stars(["b.json"], "three", None)


OF_DECKS = [
    option.opts[0]
    for option in plot.command.params
    if isinstance(option, click.Option)
    and option.opts[0]
    not in (
        "-o", "--format", "--frame", "--size", "--dpi", "--images", "-q", "--help", "--help-decks",
    )
]  # fmt: skip


@pytest.mark.parametrize("option", OF_DECKS)
def test_options_of_decks_are_not_for_star_photographs(option: str, tmp_path: Path) -> None:
    """Every one but those of the picture itself."""
    (parameter,) = [one for one in plot.command.params if option in one.opts]
    flag = isinstance(parameter, click.Option) and parameter.is_flag
    values = {"--figure": "attitude", "--initial": "closed-form", "--ellipsoid": "wgs84",
              "--vertical": "geodetic", "--fix": "earth"}  # fmt: skip
    given = [option] if flag else [option, values.get(option, "1")]
    more = {"--ellipsoid": ["--fix", "earth"], "--compare-initial": ["--initial", "closed-form"]}
    ran = vopd("plot", tmp_path / "a.json", "-o", tmp_path / "a.svg", *given, *more.get(option, []))
    assert ran.status == 2
    first = more.get(option, [option])[0]
    assert_approved(ran.stderr, parts=[first])
    assert {"--figure", "--job", "--vertical", "--max-rate", "--strict"} <= set(OF_DECKS)


def test_warnings_about_a_star_photograph_are_not_printed_if_it_is_quiet(tmp_path: Path) -> None:
    stars, solution = DECKS / "stars" / "orion_misidentified.csv", tmp_path / "a.json"
    vopd("stars", "solve", stars, "--focal", "76", "-q", "-o", solution)
    for quiet in (False, True):
        ran = vopd("plot", solution, "-o", tmp_path / "a.svg", *["-q"] * quiet)
        assert ran.status == 3 and bool(ran.stderr) is not quiet


def test_star_photographs_and_decks_are_not_drawn_together(tmp_path: Path) -> None:
    ran = vopd("plot", tmp_path / "a.json", CASE_1, "-o", tmp_path / "a.svg")
    assert ran.status == 2
    assert_approved(ran.stderr)


# Lists and refusals

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
    *written, largest, last = ran.stdout.splitlines()
    assert largest == "largest: 0.001 deg (frame 730, PHI)"
    assert written == [
        f"page {k}, frame 730, line {line}, PHI: expected 75.837, actual 75.836 (off by 0.001 deg)"
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


# Figures


def job(number: int) -> Any:
    return SimpleNamespace(about=SimpleNamespace(job=number))


@pytest.mark.parametrize(
    "options",
    [
        "",
        "--figure attack",
        "--figure image",
        "-q",
    ],
)
def test_jobs_that_are_not_drawn_are_told(
    options: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(plot, "collect_histories", lambda *_, **__: ([job(1)], 0))
    monkeypatch.setattr(plot, "left_out_text", lambda _: "20 of 30 jobs, with the worst")
    monkeypatch.setattr(plot, "figure_names", lambda names, _: names)
    monkeypatch.setattr(plot, "draw", lambda *_: None)
    monkeypatch.setattr(plot, "save", lambda *_: b"saved")
    ran = vopd("plot", "a.dat", "-o", tmp_path / "f.svg", *options.split())
    assert (ran.status, ran.stdout) == (0, "")
    assert_approved(ran.stderr)


REFUSED = [
    ("f.svg --dpi 100", 2),
    ("f.pdf --dpi 150", 2),
    ("f.png --format svg --dpi 100", 2),
    ("f.txt", 2),
    ("f", 2),
]


@pytest.mark.parametrize(("options", "status"), REFUSED)
def test_figures_that_are_refused(
    options: str, status: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plot, "collect_histories", lambda *_, **__: ([job(1), job(2)], 0))
    ran = vopd("plot", "a.dat", "b.dat", "-o", *options.split())
    assert ran.status == status
    assert_approved(ran.stderr.splitlines()[-1])
    assert not [*tmp_path.iterdir()]


# Batches

USUAL = SharedOptions(SolveOptions(), HistoryOptions(), strict=False, quiet=False)
STRICT = replace(USUAL, strict=True)
Said = pytest.CaptureFixture[str]


def record(status: str, flagged: int = 0, error: str = "", unread: int = 0) -> Any:
    return SimpleNamespace(
        status=status, flagged=flagged, error=error, mistaken=0, errata=0, unread=unread
    )


GOOD, FLAGGED, LOST = record("solved"), record("solved", 1), record("not converged", 1)
FAILED, UNREAD = record("failed", error="a: wrong"), record("solved", unread=2)
BATCHES = [
    ([], False, 0),
    ([], True, 0),
    ([GOOD], True, 0),
    ([FLAGGED, GOOD], False, 0),
    ([FLAGGED, GOOD], True, 3),
    ([GOOD, LOST], False, 3),
    ([GOOD, FAILED], False, 3),
    ([LOST, FAILED], False, 3),
    ([FAILED], False, 1),
    ([FAILED] * 20, False, 1),
    ([FAILED] * 21, True, 1),
    ([GOOD, *[FAILED] * 45], False, 3),
    ([GOOD, UNREAD], False, 0),
    ([GOOD, UNREAD], True, 3),
]


@pytest.mark.parametrize(("records", "strict", "status"), BATCHES)
def test_the_status_of_a_batch(records: list[Any], strict: bool, status: int, capsys: Said) -> None:
    assert batch._status(records, STRICT if strict else USUAL) == status
    ended = capsys.readouterr()
    assert ended.out == ""
    assert_approved(ended.err.splitlines())


PLACES: list[tuple[str, tuple[int, str | None, bool]]] = [
    ("", (1, None, False)),
    ("--jobs 2", (2, None, False)),
    ("--dask tcp://a:1 --jobs 1", (1, "tcp://a:1", False)),
    ("--dask tcp://a:1 --shared-filesystem", (1, "tcp://a:1", True)),
]


@pytest.mark.parametrize(("options", "place"), PLACES)
def test_where_a_batch_is_solved(
    options: str,
    place: tuple[int, str | None, bool],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: Said,
) -> None:
    """In processes, or on a cluster, whose messages go to standard error."""
    monkeypatch.setattr("vopd.batch.workers.load_ahead", lambda: None)
    words = ("batch", CASE_1, "-d", tmp_path / "out", *options.split())
    *_, jobs, dask, shared, warn = handed(monkeypatch, runs, "run_batch", *words)
    assert (jobs, dask, shared) == place
    warn("a worker is refused")
    assert capsys.readouterr() == ("", "a worker is refused\n")


def test_a_quiet_part_of_a_batch_says_nothing(tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, "-d", tmp_path / "out", "--shard", "1/2", "-q")
    assert (ran.status, ran.stderr) == (0, "")


REFUSED_BATCH = [
    "-d out",
    "a.dat -d=",
    "a.dat -d out --dask tcp://a:1 --jobs 2",
    "a.dat -d out --shared-filesystem",
    "a.dat",
    "a.dat -d out --shard 0/3",
    "a.dat -d out --jobs 0",
    "a.dat -d out --format aem",
]  # fmt: skip


@pytest.mark.parametrize("options", REFUSED_BATCH)
def test_batches_that_are_refused(options: str, tmp_path: Path) -> None:
    words = ["--directory=" if word == "-d=" else word for word in options.split()]
    ran = vopd("batch", *words)
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize("options", ["--format csv --format parquet", "--report"])
def test_packages_of_a_batch_are_looked_for_first(
    options: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("pyarrow", "jinja2"):
        monkeypatch.setitem(sys.modules, name, None)
    ran = vopd("batch", "a.dat", "-d", "out", *options.split())
    assert ran.status == 1
    assert_approved(ran.stderr)


def test_a_date_of_making_is_read_before_any_library_stops_at_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """numpy.f2py, which scipy imports, reads it too, and ends with a traceback."""
    for text in ("abc", "1e9"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", text)
        ran = vopd("cards", CASE_1)
        assert ran.status == 1
        assert_approved(ran.stderr)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "")
    assert vopd("cards", CASE_1).status == 0 and "SOURCE_DATE_EPOCH" not in os.environ


def leaves(command: click.Command) -> Iterator[click.Command]:
    """List the commands below a group."""
    if not isinstance(command, click.Group):
        yield command
        return
    context = click.Context(command)
    for name in command.list_commands(context):
        below = command.get_command(context, name)
        assert below is not None
        yield from leaves(below)


@pytest.mark.parametrize("text", ["\u0663", "1_0"])
def test_options_take_plain_digits_alone(text: str) -> None:
    """Python's numbers have those of other scripts, and separators."""
    kinds = (click.types.IntParamType, click.types.FloatParamType)
    numbers = [
        option
        for command in leaves(cli)
        for option in command.params
        if isinstance(option.type, kinds)
    ]
    assert len(numbers) > 40
    for option in numbers:
        with pytest.raises(click.BadParameter):
            option.type.convert(text, option, None)


def test_a_search_that_does_not_settle_is_status_3(monkeypatch: pytest.MonkeyPatch) -> None:
    """By so few rounds it settles nowhere."""
    monkeypatch.setattr("vopd.convert.feature_trials.MOST_ROUNDS", 1)
    monkeypatch.chdir(ROOT / "tests" / "approved" / "inputs")
    ran = vopd("adjust", "feature.dat", "--free", "landmark:13", "--trials", "--format", "csv")
    assert ran.status == 3
    assert_approved(ran.stderr)
