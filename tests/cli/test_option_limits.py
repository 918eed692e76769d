"""Options from both sides of their limits, and what wrong ones say; nothing is solved for it."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import click
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, vopd
from vopd.cli import plot
from vopd.cli.attitude import _request
from vopd.cli.batch import _shard
from vopd.cli.stars.options import _place, image_axes, sky_request
from vopd.export import FORMATS

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
    assert _request(FORMATS["aem"], EPOCH, {"aem_version": "1"}, False).aem_version == 1


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
    ("spread", "message"),
    [("nan", "--spread: nan is not a number of inches."), ("-0.001", "-0.001 is not in the range"),
     ("x", "'x' is not a valid float"), ("0", ""), ("1e9", "")],
)  # fmt: skip
def test_the_spread_of_readings_is_0_inches_or_more(spread: str, message: str) -> None:
    ran = vopd("check", CASE_1, "--spread", spread)
    if message:
        assert (ran.status, ran.stdout) == (2, "")
        assert_approved(ran.stderr)
    else:
        assert ran.status == 0 and ("readings" in ran.stdout) == (spread == "0")


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


@pytest.mark.parametrize("size", ["9", "9x6x3", "axb", "", "9,6"])
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
IMAGE["y_down"] = False
SKY: dict[str, Any] = dict.fromkeys(
    ("date", "place", "pressure", "temperature", "ephemeris", "catalogue", "mount")
)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"size": (0.0, 5.0)}, "--size must be above 0."),
        ({"size": (5.0, 0.0)}, "--size must be above 0."),
        ({"size": (0.1, 0.1)}, ""),
        ({"focal": 50.0, "focal_px": 900.0}, "--focal and --focal-px exclude each other."),
        ({"pitch_um": 5.0}, "--pitch-um goes with --focal."),
        ({"pitch_um": 5.0, "focal_px": 900.0}, "--pitch-um goes with --focal."),
        ({"pitch_um": 5.0, "focal": 50.0}, ""),
    ],
)
def test_options_of_the_image(given: dict[str, Any], message: str) -> None:
    if message:
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
    ("given", "message"),
    [
        ({"pressure": (0.0,)}, ""), ({"pressure": (1999.9,)}, ""),
        ({"pressure": (2000.0,)}, "--pressure is 0 to 2000 mbar."),
        ({"pressure": (-0.1,)}, "--pressure is 0 to 2000 mbar."),
        ({"temperature": (-149.9,)}, ""), ({"temperature": (99.9,)}, ""),
        ({"temperature": (-150.0,)}, "--temperature is -150 to 100 degrees C."),
        ({"temperature": (100.0,)}, "--temperature is -150 to 100 degrees C."),
    ],
)  # fmt: skip
def test_options_of_the_air(given: dict[str, Any], message: str) -> None:
    there = {"place": (47.0, 16.0, 300.0)}
    with refused(click.UsageError):
        sky_request(SKY | given)
    if message:
        with pytest.raises(click.UsageError) as refusal:
            sky_request(SKY | there | given)
        assert_approved(refusal.value.message)
        return
    asked = sky_request(SKY | there | given)
    assert asked.place == there["place"]
    assert asked.pressure_mbar == given.get("pressure", (None,))[0]
    assert asked.temperature_c == given.get("temperature", (10.0,))[0]
