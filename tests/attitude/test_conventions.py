"""What every file states about standard deviations and intervals, one fact in a statement."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit import estimates, wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.kit.estimates import ABOUT, WORDS, estimate, position
from tests.kit.histories import histories
from tests.kit.jobs import case
from tests.kit.wgs84_film import FOOT_M, ecef, enu, geodetic
from tests.tolerances import assert_close, within
from vopd import film
from vopd.attitude.conventions import (
    MOST_JOBS,
    conventions,
    farthest_from_own_text,
    reading_sigma_text,
    report_own_position,
)
from vopd.attitude.findings import HistorySummary, findings_of
from vopd.attitude.history import History, history
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.errata import fixes
from vopd.estimate import Vertical
from vopd.findings import Finding
from vopd.program.vopd import run
from vopd.results import Results

STILL = np.tile([140.0, -60.0, 20.0], (8, 1))


def test_a_reading_sigma_that_is_given() -> None:
    one = history(estimate(STILL), sigmas=Sigmas(reading=0.6))
    assert_approved(reading_sigma_text(one))


def test_a_reading_sigma_of_the_resolution() -> None:
    """Without residuals it is the larger of spread and resolution, not estimated."""
    spread = history(estimate(STILL, reading_spread=0.3, reading_floor=0.1))
    floor = history(estimate(STILL, reading_spread=np.nan, reading_floor=0.1))
    assert_approved(reading_sigma_text(spread))
    assert_approved(reading_sigma_text(floor))


def test_a_reading_sigma_of_the_residuals() -> None:
    """Eight frames of four landmarks are 8 (2 * 4 - 3) = 40 degrees of freedom."""
    one = history(estimate(STILL, noise=2.0, reading_spread=0.01))
    text = reading_sigma_text(one)
    assert_approved(text, parts=["40.0 degrees of freedom"])
    said = re.fullmatch(r"([\d.]+) px, .*, (\d+) times .*", text)
    assert said and float(said[1]) / 0.01 == float(said[2])


def test_copies_have_no_ratio() -> None:
    one = history(estimate(STILL, reading_spread=0.0))
    assert "times" not in reading_sigma_text(one)


def test_jobs_are_told_apart_and_many_are_counted() -> None:
    said = conventions(histories("appendix_h/cases_1_2_3"))["reading sigma"]
    assert [part.partition(":")[0] for part in said.split("; ")] == ["job 1", "job 2", "job 3"]
    two = conventions(histories("appendix_h/case1", "appendix_h/case4"))["reading sigma"]
    assert "appendix_h/case1.dat, job 1: " in two and "; appendix_h/case4.dat, job 1: " in two
    many = conventions(histories("appendix_h/case1") * (MOST_JOBS + 5))["reading sigma"]
    assert many.count("job 1: ") == MOST_JOBS
    assert_approved(many)


@pytest.mark.parametrize(
    "sigmas",
    [
        Sigmas(),
        Sigmas(position=10.0),
        Sigmas(landmark=1.0, focal_length=0.1),
        Sigmas(time_s=0.1, mount_deg=0.1),
    ],
)
def test_components_that_are_the_same_in_all_frames(sigmas: Sigmas) -> None:
    assert_approved(conventions([history(estimate(STILL), sigmas=sigmas)])["common errors"])


def test_intervals_and_what_sigmas_leave_out() -> None:
    said = conventions([history(estimate(STILL))])
    assert said["intervals"].startswith("95 %") and "exclude" not in said["sigmas"]
    effect = np.full((8, 9), 0.25)
    faulty = conventions([history(replace(estimate(STILL), slip_effect_deg=effect))])
    assert_approved(faulty["sigmas"])
    assert "up to 0.250 degree" in faulty["sigmas"]


def test_the_quaternion_in_words_is_the_quaternion() -> None:
    """The forward axis, 1 0 0 in the body, has its components in north, east, down."""
    one = history(estimate(STILL))
    said = conventions([one])["quaternion"]
    assert_approved(said)
    w, x, y, z = one.quaternion[0]
    forward = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    yaw, pitch, _ = np.radians(one.estimate.vehicle_deg[0])
    level = np.cos(pitch)
    textbook = [level * np.cos(yaw), level * np.sin(yaw), -np.sin(pitch)]
    assert_close("attitude in space", forward, textbook)


def test_the_quaternion_turns_as_is_stated() -> None:
    """A level vehicle with yaw 90: its forward axis, (1, 0, 0) in the body, is east."""
    made = history(estimate([[90.0, 0.0, 0.0]]))
    w, *xyz = made.quaternion[0]
    turned = Rotation.from_quat([*xyz, w]).apply([1.0, 0.0, 0.0])
    assert_close("table value", turned, [0.0, 1.0, 0.0])
    stated = conventions([made])["quaternion"]
    assert stated.startswith("scalar first (w x y z)")
    assert_approved(stated)


# Every statement that a file makes about its numbers, in full, and what it depends on


ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))


def made(
    sigmas: Sigmas | None = None, words: dict[str, Any] | None = None, **changes: Any
) -> History:
    """Two frames with a reading sigma of .25 px, and repeated readings of .5 px."""
    about = ABOUT._replace(words=replace(WORDS, **(words or {})))
    of_about = {name: changes.pop(name) for name in about._fields if name in changes}
    e = estimate(ANGLES, about=about._replace(**of_about), reading_spread=0.5, **changes)
    return history(e, sigmas=sigmas or Sigmas(reading=0.25))


def changed(*several: History) -> dict[str, str]:
    """The statements that differ from those of the usual job."""
    usual, found = conventions([made()]), conventions(several)
    assert set(usual) <= set(found)
    return {name: text for name, text in found.items() if usual.get(name) != text}


def test_each_source_has_its_own_vertical() -> None:
    """A flight has the ellipsoid's normal, and a deck beside it the Earth's centre."""
    position = replace(made().estimate.position, vertical=Vertical.GEOCENTRIC)
    deck = made(source="film.dat", down="toward the Earth's centre", position=position)
    both = changed(made(), deck)
    assert_approved({name: both[name] for name in ("from frame", "vertical")})
    alike = changed(made(), made(source="other.toml"))
    assert not {"from frame", "vertical"} & set(alike)


def test_every_statement_about_a_usual_job() -> None:
    assert_approved(conventions([made()]))


@pytest.mark.parametrize(
    "changes",
    [
        {"words": {"no_fixes": "none"}},
        {"words": {"no_fixes": "none"}, "fixes": "restart"},
        {"fixes": "earth (WGS 84)"},
        {"words": {"conventions": {"time": "s", "position": "here"}}},
        {"words": {"vertical": "open"}},
        {"down": "to the centre"},
        {"source": "b.toml"},
        {"job": 3},
    ],
)
def test_what_a_source_says_otherwise(changes: dict[str, Any]) -> None:
    assert_approved(changed(made(**changes)))


def test_an_empty_statement_is_none() -> None:
    assert_approved(conventions([made(words={"conventions": {"time": "", "more": "said"}})]))


def test_the_lean_between_the_verticals_is_the_largest_of_all_jobs() -> None:
    place = position(2)
    away = {
        lean: made(
            position=replace(
                place, geocentric_latitude_deg=place.latitude_deg - np.array([lean, np.nan])
            )
        )
        for lean in (0.0, 0.05, 0.1239, -0.15)
    }  # fmt: skip
    assert_approved(changed(away[0.05]))
    assert_approved(conventions([away[-0.15], away[0.05]])["vertical"])
    assert_approved(conventions([away[0.05], away[0.1239]])["vertical"])
    assert_approved(conventions([away[0.0]])["vertical"])
    known = made(position=replace(place, largest_lean_deg=0.175))
    assert_approved(changed(known))
    other = made(position=replace(place, vertical="geocentric"))
    assert_approved(changed(other))
    none = position(0)
    empty = [made(), made()]
    object.__setattr__(empty[1].estimate, "position", none)
    assert_approved(conventions(empty)["vertical"])
    assert_approved(conventions(empty[1:])["vertical"])


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ([(0, 0, 0.25)], "0.250 degree (camera_yaw)"),
        ([(1, 1, -0.3)], "0.300 degree (camera_pitch)"),
        ([(1, 2, 0.3), (0, 5, -0.4004)], "0.400 degree (vehicle_roll)"),
        ([(0, 3, 0.1), (0, 8, 0.9)], "0.100 degree (vehicle_yaw)"),
        ([(0, 4, 0.1), (1, 5, np.nan)], "0.100 degree (vehicle_pitch)"),
    ],
)  # fmt: skip
def test_the_largest_effect_of_the_errata(effects: list[tuple[int, int, float]], said: str) -> None:
    """Of camera and vehicle, in any frame of any job; not of the angles of attack."""
    jobs = [np.zeros((2, 9)), np.zeros((2, 9))]
    for k, (frame, angle, size) in enumerate(effects):
        jobs[k][frame, angle] = size
    several = [made(slip_effect_deg=jobs[0]), made(slip_effect_deg=jobs[1]), made()]
    assert_approved(conventions(several)["sigmas"], parts=[said])
    assert_approved(conventions(several[::-1])["sigmas"], parts=[said])


def test_components_of_all_jobs_are_named_once() -> None:
    one = made(Sigmas(reading=0.25, position=1.0, focal_length=0.1))
    other = made(Sigmas(reading=0.25, position=1.0, landmark=2.0, time_s=0.1))
    found = changed(made(), one, other)
    assert_approved(found["sigmas"])
    assert_approved(found["common errors"])


def scaled(**changes: Any) -> History:
    """A job with such a reading sigma."""
    one = made()
    scale = replace(JobReadingSigma(0.25, np.inf, "given", np.ones(2), 0.25), **changes)
    return replace(one, uncertainty=replace(one.uncertainty, reading=scale))


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"sigma": 0.0},
        {"sigma": 0.123456},
        {"freedom": 12.34},
        {"sigma": 0.0, "source": "residuals"},
        {"sigma": 0.0, "source": "sample"},
        {"sigma": 0.0, "source": "repeated"},
        {"sigma": 0.0, "source": "resolution"},
    ],
)
def test_every_source_of_a_reading_sigma(changes: dict[str, Any]) -> None:
    text = reading_sigma_text(scaled(**changes))
    assert_approved(text)
    said = changed(scaled(**changes))
    assert said == ({"reading sigma": f"job 1: {text}"} if changes else {})


@pytest.mark.parametrize("count", [1, 8, 9, 12])
def test_reading_sigmas_of_the_first_eight_jobs_are_stated(count: int) -> None:
    for sources in ("a", "ab"):
        jobs = [made(source=sources[k % len(sources)], job=k + 1) for k in range(count)]
        if len(sources) == 2 and count == 1:
            continue
        assert_approved(conventions(jobs)["reading sigma"])


# Where a deck's own coordinates put the vehicle on WGS 84, against geometry written apart


EPOCH = "1974-08-27T17:30:00Z"
CASE_1_IS = "the vehicle is up to 133 m south and 9 m east of where the deck's own coordinates put"


def east_north_m(results: Results, origin_m: float = 0.0) -> np.ndarray:
    """From each position to the deck's own on WGS 84, both at the height of the latter."""
    path, here = results.job.trajectory, film.position(film.joined_jobs([results]))
    lon, lat = np.radians([path.origin_longitude_deg, path.origin_latitude_deg])
    origin = ecef(path.origin_latitude_deg, path.origin_longitude_deg, origin_m)
    found = []
    for k, feet in enumerate(results.vehicle_ft):
        own = origin + feet * FOOT_M @ enu(lon, lat)
        there = geodetic(own)
        height_m = float(
            own @ enu(*there)[2] - ecef(*np.degrees(there[::-1]), 0.0) @ enu(*there)[2]
        )
        seen = ecef(here.latitude_deg[k], here.longitude_deg[k], height_m)
        found.append((enu(*there) @ (own - seen))[:2])
    return np.array(found)


@pytest.mark.parametrize("names", [(), ("earth",)], ids=["faithful", "earth"])
def test_the_distance_to_the_deck_s_own_coordinates(names: tuple[str, ...]) -> None:
    """Case 1: 133 m with the Earth of 1974, and nothing with the ellipsoid."""
    results = run(case(1), fixes(*names))
    expected = east_north_m(results)
    found = film.position(film.joined_jobs([results])).to_own_m
    assert found is not None
    assert np.abs(found - expected).max() < within("flight height")
    if names:
        assert np.abs(expected).max() < within("flight height")
    else:
        assert expected[0, 1] > 133.0 and expected[0, 0] < -8.0


def test_in_the_south_and_the_east() -> None:
    job, _ = wgs84_film.film(-33.9, 18.4, decimals=None)
    results = run(job)
    found = film.position(film.joined_jobs([results])).to_own_m
    assert found is not None
    expected = east_north_m(results, 1200.0 * FOOT_M)
    assert np.abs(found - expected).max() < within("flight height")
    assert (expected[:, 1] < -100.0).all()  # its position is too far north


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8").replace("&amp;#x27;", "'").replace("&#x27;", "'")


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "kml", "czml"])
def test_files_say_it_in_metres(suffix: str, tmp_path: Path) -> None:
    plain, fixed = tmp_path / f"plain.{suffix}", tmp_path / f"fixed.{suffix}"
    said = vopd("attitude", CASE_1, "-o", plain, "--epoch", EPOCH).stderr
    assert CASE_1_IS in text_of(plain) and "--fix earth puts it there" in text_of(plain)
    assert (CASE_1_IS in said) == (
        suffix in ("kml", "czml")
    )  # where a viewer shows it on the Earth
    said = vopd("attitude", CASE_1, "-o", fixed, "--epoch", EPOCH, "--fix", "earth").stderr
    assert "own coordinates" not in text_of(fixed) and "own coordinates" not in said


def test_the_farthest_frame_of_all_jobs_counts() -> None:
    def text(*east_north: tuple[float, float]) -> str:
        one = estimates.estimate(np.zeros((len(east_north), 3)))
        here = replace(one.position, to_own_m=np.array(east_north))
        return farthest_from_own_text([history(estimates.estimate(one.camera_deg, position=here))])

    assert_approved(text((0.0, 0.2), (-30.0, 40.0)))
    assert_approved(text((12.0, 0.4), (np.nan, np.nan)))
    assert text((0.9, 0.0)) == text((np.nan, np.nan)) == ""


def test_a_flight_has_no_such_words() -> None:
    assert farthest_from_own_text([history(estimates.estimate(np.zeros((2, 3))))]) == ""


def test_a_spreadsheet_takes_no_part_of_it_for_a_formula() -> None:
    done = vopd("attitude", CASE_1)
    (line,) = [one for one in done.stdout.splitlines() if one.startswith("# position")]
    for cell in (part for row in csv.reader([line], delimiter=";") for part in row):
        assert cell.strip()[0] not in "=+-@'"


def test_json_has_the_sentence_too() -> None:
    done = vopd("attitude", CASE_1, "--format", "jsonl")
    stated = json.loads(done.stdout.splitlines()[0])["conventions"]
    assert CASE_1_IS in stated["position"]


# What is said of a whole job: how far its positions are off, and what misfits


NONE = float("nan")


def off(*east_north: tuple[float, float], source: str = "a.dat", job: int = 1) -> Any:
    """A job whose own coordinates put the vehicle so many metres east and north of the file's."""
    about = ABOUT._replace(
        source=source, job=job, words=replace(WORDS, own_position=f"where {source} has it")
    )
    to_own = np.array(east_north).reshape(-1, 2) if east_north != ((),) else None
    position = SimpleNamespace(to_own_m=to_own)
    return SimpleNamespace(about=about, estimate=SimpleNamespace(position=position))


@pytest.mark.parametrize(
    ("east_north", "said"),
    [
        ((0.0, 5.0), "5 m south"), ((0.0, -5.0), "5 m north"), ((5.0, 0.0), "5 m west"),
        ((-5.0, 0.0), "5 m east"), ((3.0, 40.0), "40 m south and 3 m west"),
        ((-3.0, -40.0), "40 m north and 3 m east"), ((0.49, 7.0), "7 m south"),
        ((0.51, 7.0), "7 m south and 1 m west"), ((7.0, 0.49), "7 m west"),
        ((7.0, -0.5), "7 m west"), ((0.0, 1.0), "1 m south"), ((0.0, 0.999), ""),
        ((0.6, 0.8), "1 m south and 1 m west"), ((0.6, 0.79), ""), ((NONE, 9.0), ""),
        ((0.0, 12345.6), "12346 m south"), ((0.0, np.inf), ""),
    ],
)  # fmt: skip
def test_how_far_the_farthest_position_is_off(east_north: tuple[float, float], said: str) -> None:
    """The file's position is on the other side; less than a metre, or half of one, is not said."""
    found = farthest_from_own_text([off(east_north)])
    assert bool(found) == bool(said)
    assert_approved(found, parts=[said] if said else [])
    near = off((0.3, 0.3), (NONE, NONE))
    for several in ([near, off(east_north)], [off((0.1, 0.1), east_north, (0.2, 0.0))]):
        found = farthest_from_own_text(several)
        assert bool(found) == bool(said)
        assert_approved(found, parts=[said] if said else [])
    found = farthest_from_own_text([off(()), off(east_north)])
    assert bool(found) == bool(said)
    assert_approved(found, parts=[said] if said else [])


def test_no_frame_and_no_own_coordinates() -> None:
    assert farthest_from_own_text([off(())]) == ""
    empty = off((0.0, 0.0))
    empty.estimate.position.to_own_m = np.zeros((0, 2))
    assert farthest_from_own_text([empty]) == ""


def test_a_warning_for_every_job_that_is_off() -> None:
    told: list[Finding] = []
    jobs = [off((0.0, 5.0)), off((0.0, 0.1), job=2), off((7.0, 0.0), source="b.dat", job=3)]
    report_own_position(jobs, told.append)
    assert_approved(told, parts=["5 m south", "a.dat", "7 m west", "b.dat"])


def misfits(*told: str) -> list[Finding]:
    labels = [(str(10 * k), text) for k, text in enumerate(told, 1)]
    return findings_of(ABOUT._replace(job=4), HistorySummary(misfits=labels))


@pytest.mark.parametrize(
    "told",
    [
        ["a (chance 0.50)"],
        ["not searched"],
        ["a (chance 0.50)", "b (chance 0.40)", "a (chance 0.07)"],
        ["c", "b", "a"],
        ["a", "b", "c", "d"],
        ["a", "b", "c", "d", "e", "d"],
        ["a", "b", "c", "d"] * 2,
        [],
    ],
)  # fmt: skip
def test_warnings_about_frames_that_misfit(told: list[str]) -> None:
    """Three repairs at most, those of the most frames first, in the order of the frames; each
    with the least of its chances.
    """
    assert_approved(misfits(*told))
