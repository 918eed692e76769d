"""Each flag raised where it should be, and nowhere else."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit import estimates, spherical_film, wgs84_film
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from tests.kit.estimates import POINTS, WORDS, estimate
from tests.kit.jobs import case, film, only, turned, without
from tests.tolerances import assert_close, within
from vopd.attitude.conventions import GENERAL, conventions
from vopd.attitude.findings import HistorySummary, errata_text, findings_of, summary_of
from vopd.attitude.flags import MEANING, Flags, flags, jumps, meanings
from vopd.attitude.geometry import LandmarkGeometry
from vopd.attitude.history import History, history
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import FIXED, columns_of
from vopd.cards.format import GROUPS
from vopd.cards.write import write_deck
from vopd.export import FORMATS, FileRequest
from vopd.figures import draw
from vopd.film import DECK_WORDS, film_estimate
from vopd.findings import VopdError
from vopd.job import Job, Readings
from vopd.pipeline import read_deck, run
from vopd.program.vopd import run as solve

TRUTH = np.array([140.0, -80.0, 60.0])


def history_of(job: Job) -> History:
    (one,) = run(job).histories()
    return one


def flagged(job: Job, rate: float | None = None) -> dict[str, list[int]]:
    """The indices of the frames that have each flag, of the flags that are raised."""
    (one,) = run(job).histories(max_rate_deg_s=rate)
    raised = one.flags.raised
    return {name: np.flatnonzero(here).tolist() for name, here in raised.items() if here.any()}


def test_a_good_film_has_none() -> None:
    assert flagged(turned(np.tile([140.0, -70.0, 60.0], (4, 1)), np.array([140.0, -70, 60]))) == {}


@pytest.mark.parametrize(
    ("table", "name", "lowest", "beyond"),
    [("clock", "frame", 2, [0]), ("clock", "frame", 1, []), ("trajectory", "time_s", 0.5, [0]),
     ("wind", "altitude_ft", 119_949.0, [2, 3]), ("wind", "altitude_ft", 119_851.0, [3]),
     ("wind", "altitude_ft", 119_849.0, []), ("trajectory", "time_s", 0.0, [])],
)  # fmt: skip
def test_frames_beyond_a_table_of_the_deck_are_flagged(
    table: str, name: str, lowest: float, beyond: list[int]
) -> None:
    """Frames 1 to 4 at 0 to 3 s, at 120,000 ft and 50 less a second: the table begins there."""
    job = turned(np.tile([140.0, -70.0, 60.0], (4, 1)), np.array([140.0, -70, 60]))
    rows = getattr(job, table)
    job = replace(job, **{table: replace(rows, **{name: np.maximum(getattr(rows, name), lowest)})})
    one = history_of(job)
    assert np.flatnonzero(one.flags.raised["extrapolated"]).tolist() == beyond
    named = {"clock": "time"}.get(table, table)
    assert all(named in one.flags.detail["extrapolated"][k].split("+") for k in beyond)


def test_two_landmarks_have_no_redundancy_and_another_side() -> None:
    job = only(turned(np.array([[140.0, -70.0, 60.0]]), np.array([140.0, -70, 60])), 0, 3)
    assert set(flagged(job)) == {"two_landmarks", "second_solution"}


def test_one_landmark_determines_nothing() -> None:
    one = history_of(only(film(1), 2))
    assert one.flags.raised["undetermined"].all()
    assert np.isposinf(one.uncertainty.total).all()
    assert not np.isfinite(one.geometry.condition[0])


def test_one_landmark_read_twice_is_one_landmark() -> None:
    """A turn about the line to it is held by nothing: no deviation, and not a small one."""
    job = only(turned(np.array([[140.0, -70.0, 60.0]]), np.array([140.0, -70, 60])), 2, 2)
    one = history_of(job)
    assert one.flags.raised["undetermined"].all()
    assert np.isposinf(one.uncertainty.total).all()


def test_the_camera_that_looks_at_the_sky() -> None:
    """Case 1 from 18, 80, 285 ends with the ground behind it (docs/conventions.md)."""
    (one,) = run(case(1), start_deg=np.array([[18.0, 80.0, 285.0]])).histories()
    assert_close("printed angle", one.estimate.camera_deg[0, 1], 70.273)
    assert one.flags.raised["behind_camera"].all()
    assert not history_of(case(1)).flags.raised["behind_camera"].any()


def test_what_does_not_converge() -> None:
    start = np.array([60.0, 5.0, 200.0])
    job = only(turned(np.array([TRUTH]), start), 0, 1)
    one = history_of(job)
    assert one.flags.raised["not_converged"].tolist() == (~one.estimate.converged).tolist()
    results = solve(job)
    for largest, expected in ((1.1e-6, True), (0.9e-6, False)):
        bent = replace(results, correction_rad=np.array([[0.0, largest, 0.0]]))
        raised = history(film_estimate(bent)).flags.raised["not_converged"]
        assert raised.all() == expected


@pytest.mark.parametrize(
    ("pitch", "detail"),
    [(-84.9, None), (-85.1, "camera_pitch+vehicle_pitch"), (-94.9, "camera_pitch+vehicle_pitch")],
)
def test_pitch_within_five_degrees_of_the_pole(pitch: float, detail: str | None) -> None:
    angles = np.array([[140.0, pitch, 60.0]])
    one = history_of(turned(angles, angles[0]))
    assert one.flags.raised["pitch_near_90"].tolist() == [detail is not None]
    if detail:
        assert f"pitch_near_90:{detail}" in one.flags.text()[0].split(";")


def test_which_pitch_is_named() -> None:
    angles = np.array([[140.0, -87.0, 60.0]])
    job = spherical_film.job(angles, angles[0], (1.0, 0.5, 1.0))
    assert history_of(job).flags.detail["pitch_near_90"] == ["camera_pitch"]


def spike(at: int, size: float, count: int = 8) -> np.ndarray:
    angles = np.tile([140.0, -70.0, 60.0], (count, 1))
    angles[at:, 0] += 0.0
    angles[at, 0] += size
    return angles


@pytest.mark.parametrize(
    ("at", "expected"), [(3, [3]), (0, [0]), (7, [7])], ids=["amid", "first", "last"]
)
def test_a_frame_that_jumps_out_is_flagged_and_not_its_neighbours(
    at: int, expected: list[int]
) -> None:
    """Frames are a second apart; 8 degrees of yaw at a pitch of -70 are 8 degrees of turn."""
    job = turned(spike(at, 8.0), np.array([140.0, -70.0, 60.0]))
    assert flagged(job, 7.9) == {"jump": expected}
    assert flagged(job, 8.1) == {} and flagged(job) == {}


def test_a_step_flags_both_sides_of_it() -> None:
    angles = np.tile([140.0, -70.0, 60.0], (6, 1))
    angles[3:, 2] += 5.0
    job = turned(angles, np.array([140.0, -70.0, 60.0]))
    assert flagged(job, 4.9) == {"jump": [2, 3]}
    gone = without(job, int(job.readings.frame[2]))  # neighbours are two seconds apart then
    assert flagged(gone, 4.9) == {} and flagged(gone, 2.4) == {"jump": [1, 3]}


def test_a_rate_of_nothing_is_refused() -> None:
    none: Any = (True, "5")  # nor are these numbers
    for rate in (0.0, -1.0, float("nan"), *none):
        with refused(VopdError):
            run(film(1)).histories(max_rate_deg_s=rate)


def test_every_flag_is_explained() -> None:
    assert list(history_of(film(2)).flags.raised) == list(MEANING)
    page = (ROOT / "docs" / "uncertainty.md").read_text(encoding="utf-8")
    for name, (meaning, advice) in meanings(DECK_WORDS).items():
        assert meaning and advice and f"| `{name}` | {meaning} | {advice} |\n" in page


ABOUT_GROUPS = {  # what the words for decks say of a group, and what its table calls that
    "group 8's first estimate": "initial camera yaw",
    "ignore it (group 11 in one frame": "ignored in one frame",
    "group 12 in all)": "ignored in all frames",
    "group 3 has a large multiplier or offset": "yaw multiplier",
    "its number in group 9": "landmark number",
    "group 8's origin": "origin geodetic latitude",
    "altitude above sea level, group 7": "altitude above sea level",
    "group 7's X, Y, Z": "vehicle X, + east",
    "seconds of flight, group 6": "flight time",
}


def test_advice_about_groups_is_right() -> None:
    """Every group that the words for decks name has that content in the table of groups."""
    said = json.dumps(asdict(DECK_WORDS))
    for sentence, content in ABOUT_GROUPS.items():
        number = int(re.findall(r"group (\d+)", sentence)[0])
        group = GROUPS[number]
        contents = [group.title, *(field.meaning for field in group.fields)]
        assert sentence in said and any(content in one for one in contents), sentence
        said = said.replace(sentence, "")
    assert re.findall(r"group \d+", said) == ["group 3"]  # where to look, said once more


def test_words_for_any_source_name_no_card() -> None:
    """The general words of flags, columns and statements say nothing of decks."""
    general = [*(text for pair in MEANING.values() for text in pair), *GENERAL.values()]
    general += [column.meaning for column in FIXED]
    for sentence in general:
        assert not re.search(r"group \d|deck|card|film|22nd|\bH\b|sea level", sentence), sentence


@pytest.mark.parametrize("deck", sorted(DECKS.glob("*/*.dat")), ids=lambda path: path.stem)
def test_any_deck_has_a_history(deck: Path) -> None:
    """Stopped, exact, ignored, asterisks: never a traceback, never a warning."""
    for one in run(read_deck(deck)).histories(
        Sigmas(landmark=30.0, position=60.0, focal_length=0.01, time_s=0.1), 10.0
    ):
        frames = len(one.estimate.frame)
        assert len(one.flags.text()) == len(one.status) == frames
        assert one.uncertainty.total.shape == (frames, 9)


@pytest.mark.parametrize(
    ("rms", "second", "flagged"),
    [
        (0.1, 1.49, True),  # three times the reading sigma of .5
        (0.1, 1.51, False),
        (0.6, 1.79, True),  # three times the residuals
        (0.6, 1.81, False),
        (0.6, np.nan, False),  # there is none
    ],
)
def test_the_second_solution_against_residuals_and_reading_sigma(
    rms: float, second: float, flagged: bool
) -> None:
    e = estimate([[10.0, -60.0, 20.0]])
    made = history(e, sigmas=Sigmas(reading=0.5))
    raised = flags(
        e, made.geometry, made.quaternion, np.array([rms]), made.uncertainty,
        np.array([0.5]), [""], np.array([second]),
    ).raised  # fmt: skip
    assert raised["second_solution"].tolist() == [flagged]


@pytest.mark.parametrize(
    ("landmarks", "flag"),
    [((7, 7), "undetermined"), ((7, 8), "two_landmarks"), ((7, 8, 7), "two_landmarks")],
)
def test_a_landmark_that_is_seen_twice_counts_once(landmarks: tuple[int, ...], flag: str) -> None:
    e = estimate([[10.0, -60.0, 20.0]], POINTS[: len(landmarks)], landmark=np.array([landmarks]))
    raised = history(e).flags.raised
    counted = ("undetermined", "two_landmarks")
    assert [name for name in counted if raised[name][0]] == [flag]


# Every flag: its words for any source, and the condition that raises it, from both sides


def test_the_words_of_every_flag_for_any_source() -> None:
    assert_approved(MEANING)
    assert_approved(meanings(WORDS))
    other = ("what", "do")
    assert_approved(meanings(replace(WORDS, flags={"misfit": other})))


FRAMES = 3
ANGLES = np.tile([140.0, -60.0, 20.0], (FRAMES, 1))
NOTHING = np.full((FRAMES, 3), np.nan)


def made(
    shape: dict[str, Any] | None = None, second: float = np.nan, **changes: Any
) -> tuple[Flags, History]:
    """The flags of three alike frames, of which the landmark geometry may be another."""
    e = estimate(ANGLES, **({"frame_names": ()} | changes))
    one = history(e, sigmas=Sigmas(reading=0.5))
    geometry = LandmarkGeometry(
        **({"condition": np.full(FRAMES, 5.0), "weak_axis": np.zeros(FRAMES, np.int64),
            "behind": np.zeros(FRAMES, bool)} | (shape or {}))
    )  # fmt: skip
    every = np.ones(FRAMES)
    found = flags(
        e, geometry, one.quaternion, 0.1 * every, one.uncertainty, 0.5 * every, [""] * FRAMES,
        second * every,
    )  # fmt: skip
    return found, one


def raised(found: Flags) -> dict[str, list[int]]:
    return {name: np.flatnonzero(on).tolist() for name, on in found.raised.items() if on.any()}


def pitched(which: str, pitch: float) -> dict[str, Any]:
    angles = ANGLES.copy()
    angles[1, 1] = pitch
    return {which: angles}


def at_angle(which: str, angle: int, value: float) -> dict[str, Any]:
    angles = ANGLES.copy()
    angles[2, angle] = value
    return {which: angles}


def of_frame(frame: int, **values: Any) -> dict[str, Any]:
    """Arrays in which one frame has another value than usual."""
    usual = {"condition": np.full(FRAMES, 5.0), "behind": np.zeros(FRAMES, bool),
             "converged": np.ones(FRAMES, bool), "used": np.ones((FRAMES, 4), bool)}  # fmt: skip
    for name, value in values.items():
        usual[name] = usual[name].copy()
        usual[name][frame] = value
    return {name: usual[name] for name in values}


OUT = {"out_of_range": [2]}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, {}),
        (of_frame(1, converged=False), {"not_converged": [1]}),
        (of_frame(1, used=[True, True, True, False]), {}),
        (of_frame(1, used=[True, True, False, False]), {"two_landmarks": [1]}),
        (of_frame(1, used=[False, True, False, False]), {"undetermined": [1]}),
        (of_frame(1, used=False), {"undetermined": [1]}),
        ({"shape": of_frame(2, condition=20.0)}, {}),
        ({"shape": of_frame(2, condition=20.001)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(2, condition=np.inf)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(2, condition=np.nan)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(0, behind=True)}, {"behind_camera": [0]}),
        ({"second": 1.5}, {"second_solution": [0, 1, 2]}), ({"second": 1.5001}, {}),
        (at_angle("camera_deg", 0, 360.0009), {}), (at_angle("camera_deg", 0, 360.0011), OUT),
        (at_angle("camera_deg", 2, -361.0), OUT), (at_angle("vehicle_deg", 2, 361.0), OUT),
        (at_angle("vehicle_deg", 2, -359.0), {}),
        (pitched("camera_deg", -84.99), {}),
        (pitched("camera_deg", -85.01), {"pitch_near_90": [1]}),
        (pitched("camera_deg", 94.99), {"pitch_near_90": [1]}),
        (pitched("camera_deg", 95.01), {}), (pitched("camera_deg", 180.0), {}),
        (pitched("vehicle_deg", 85.01), {"pitch_near_90": [1]}),
        (pitched("vehicle_deg", 84.99), {}),
        (at_angle("vehicle_deg", 2, 90.0), {}), (at_angle("vehicle_deg", 0, 90.0), {}),
        (at_angle("camera_deg", 2, 90.0), {}), (at_angle("camera_deg", 0, 270.0), {}),
    ],
)  # fmt: skip
def test_what_raises_a_flag_and_what_does_not(
    changes: dict[str, Any], expected: dict[str, list[int]]
) -> None:
    """One frame of three is changed, to a value at each side of a limit."""
    found, _ = made(**changes)
    assert raised(found) == expected
    assert found.any().tolist() == [
        any(k in frames for frames in expected.values()) for k in range(FRAMES)
    ]


def test_frames_without_an_attitude_have_no_flag_but_that_they_are_undetermined() -> None:
    """Nothing is said of geometry, pitch or landmarks behind a camera that looks nowhere."""
    none = np.full((FRAMES, 3, 8), np.nan)
    lost: dict[str, Any] = {
        "camera_deg": NOTHING, "vehicle_deg": NOTHING, "gain": none, "body_gain": none,
        "shape": {"condition": np.full(FRAMES, np.nan), "behind": np.ones(FRAMES, bool)},
        "second": 0.1,
    }  # fmt: skip
    assert raised(made(**lost)[0]) == {"undetermined": [0, 1, 2]}
    left_out = {"solved": np.zeros(FRAMES, bool), "used": np.zeros((FRAMES, 4), bool)}
    assert raised(made(**lost, **left_out)[0]) == {}
    pair = np.tile([True, True, False, False], (FRAMES, 1))
    unsolved = {"solved": np.zeros(FRAMES, bool), "used": pair}
    assert raised(made(**lost, **unsolved)[0]) == {}


def test_what_is_said_of_frames_of_which_only_something_is_known() -> None:
    """A correction that is not a number has not converged; what a source has tested stands; and
    the vehicle's angles are not needed for what is said of the camera.
    """
    none = np.full((FRAMES, 3, 8), np.nan)
    outlier = np.zeros((FRAMES, 4), bool)
    outlier[1, 2] = True
    lost, _ = made(
        camera_deg=NOTHING, vehicle_deg=NOTHING, gain=none, body_gain=none, outlier=outlier,
        **of_frame(0, converged=False),
    )  # fmt: skip
    assert raised(lost) == {"not_converged": [0], "undetermined": [0, 1, 2], "outlier": [1]}
    weak = {"condition": np.full(FRAMES, 30.0), "behind": np.ones(FRAMES, bool)}
    level, _ = made(shape=weak, vehicle_deg=NOTHING, second=0.1)
    assert [*raised(level)] == ["behind_camera", "weak_geometry", "second_solution"]


def test_equations_without_a_solution_are_undetermined_and_not_weak() -> None:
    gain = np.tile(np.linalg.pinv(estimate(ANGLES[:1]).partials[0]), (FRAMES, 1, 1))
    gain[1, 2, 5] = np.nan
    found, _ = made(gain=gain, body_gain=gain, shape=of_frame(1, condition=1e9))
    assert raised(found) == {"undetermined": [1]}


def test_details_stand_behind_a_colon_and_flags_between_semicolons() -> None:
    outlier = np.zeros((FRAMES, 4), bool)
    outlier[1, 2] = True
    found, _ = made(
        **pitched("camera_deg", -87.0), vehicle_deg=np.tile([140.0, -88.0, 20.0], (FRAMES, 1)),
        outlier=outlier, shape=of_frame(1, condition=30.0), **of_frame(0, converged=False),
    )  # fmt: skip
    text = found.text()
    assert text[0] == "not_converged;pitch_near_90:vehicle_pitch"
    assert text[1].startswith("weak_geometry:image_x_axis sigma ")
    assert text[1].endswith(";pitch_near_90:camera_pitch+vehicle_pitch;outlier:=A1")
    assert text[2] == "pitch_near_90:vehicle_pitch"
    some = found.take(slice(1, 3))
    assert some.text() == text[1:]


def test_the_landmark_that_a_source_has_tested_already_counts() -> None:
    """And not the test made anew, by which the first one would be named here."""
    residual = np.zeros((FRAMES, 10))
    residual[:, 0] = 30.0
    residual += np.random.default_rng(2).normal(0.0, 0.01, residual.shape)
    points = np.vstack([POINTS, [[-1.0, 3.0]]])
    marked = np.zeros((FRAMES, 5), bool)
    marked[1, 3] = True
    ours = history(estimate(ANGLES, points, residual=residual))
    assert frame_landmarks(ours).outlier.tolist() == [True, False, False, False, False] * FRAMES
    assert ours.flags.raised["outlier"].all()
    theirs = history(estimate(ANGLES, points, residual=residual, outlier=marked))
    assert frame_landmarks(theirs).outlier.tolist() == marked.ravel().tolist()
    assert theirs.flags.detail["outlier"] == ["", "<crossing>", ""]


# Which frames turn too fast against their neighbours, by yaws and times


NONE = float("nan")


def jumped(yaws: list[float], times: list[float], rate: float | None) -> list[int]:
    half = np.radians(yaws) / 2.0
    q = np.stack([np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)], axis=1)
    return np.flatnonzero(jumps(np.array(times), q, rate)).tolist()


@pytest.mark.parametrize(
    ("yaws", "times", "expected"),
    [
        ([0.0, 9.9], [0.0, 1.0], []), ([0.0, 10.1], [0.0, 1.0], [0, 1]),
        ([0.0, 10.1], [1.0, 0.0], [0, 1]), ([0.0, 9.9], [1.0, 0.0], []),  # times go back
        ([0.0, 18.0, 9.0, 41.0, 50.0], [0.0, 2.0, 1.0, 3.0, 4.0], [1, 3]),  # in order of time
        ([0.0, 19.9], [0.0, 2.0], []), ([0.0, 20.1], [0.0, 2.0], [0, 1]),
        ([0.0, 0.1], [3.0, 3.0], [0, 1]), ([5.0, 5.0], [3.0, 3.0], []),  # no time between them
        ([0.0], [0.0], []), ([], [], []), ([NONE, 3.0], [0.0, 1.0], []),
        ([0.0, NONE, 15.0], [0.0, 1.0, 2.0], []),  # two seconds apart
        ([0.0, NONE, 25.0], [0.0, 1.0, 2.0], [0, 2]),
        ([0.0, 90.0, 3.0], [0.0, NONE, 1.0], []),  # a frame without a time
        ([0.0, 90.0, 13.0], [0.0, NONE, 1.0], [0, 2]),
        ([355.0, 4.0, 13.0], [0.0, 1.0, 2.0], []), ([0.0, 359.0, 350.0], [0.0, 1.0, 2.0], []),
        ([0.0, 1.0, 30.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0, 4.0], [2]),
        ([30.0, 0.0, 1.0], [0.0, 1.0, 2.0], [0]), ([0.0, 1.0, 30.0], [0.0, 1.0, 2.0], [2]),
        ([0.0, 1.0, 30.0, 31.0], [0.0, 1.0, 2.0, 3.0], [1, 2]),
        ([0.0, 30.0, 60.0, 61.0, 62.0], [0.0, 1.0, 2.0, 3.0, 4.0], [0, 1]),
        ([0.0, 1.0, 2.0, 30.0, 60.0], [0.0, 1.0, 2.0, 3.0, 4.0], [3, 4]),
        ([0.0, 1.0, 30.0, 60.0, 61.0, 62.0], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [2]),
    ],
)  # fmt: skip
def test_more_than_ten_degrees_a_second(
    yaws: list[float], times: list[float], expected: list[int]
) -> None:
    """Both neighbours, or one that is not itself fast against its other neighbour."""
    assert jumped(yaws, times, 10.0) == expected
    assert jumped(yaws, times, None) == []


# The flag of frames whose errata exceed a sigma, and the columns and words that go with it


SLIP_TRUTH = np.tile([40.0, -60.0, 10.0], (5, 1))
SIGMA = np.full((5, 9), 0.1)


def effect(*rows: dict[int, float]) -> np.ndarray:
    """Five frames with these effects, an index in the nine angles and degrees; 0 elsewhere."""
    found = np.zeros((5, 9))
    for k, row in enumerate(rows):
        for index, degrees in row.items():
            found[k, index] = degrees
    return found


def told(given: np.ndarray, sigma: np.ndarray) -> HistorySummary:
    """The summary of a job with these effects and standard deviations."""
    one = history(estimates.estimate(SLIP_TRUTH, slip_effect_deg=given))
    return summary_of([replace(one, uncertainty=replace(one.uncertainty, total=sigma))])


def test_an_angle_of_vehicle_or_camera_beyond_one_sigma() -> None:
    """Below sigma; above; an angle of attack alone; negative, in sigmas; not determined."""
    given = effect({3: 0.099}, {4: 0.101}, {6: 5.0}, {0: -0.3, 5: 0.4}, {})
    given[4] = np.nan
    sigma = SIGMA.copy()
    sigma[3, 5] = 0.2  # two sigmas of vehicle roll, three of camera yaw
    one = told(given, sigma)
    assert (one.frames, one.errata) == (5, 2)
    assert one.errata_deg == (0.0, 0.101, 0.4, 0.3, 0.0, 0.0)
    assert_close("unit rotation", np.array(one.errata_sigmas), [0.0, 1.01, 2.0, 3.0, 0.0, 0.0])
    assert_approved(errata_text(one))


def test_of_the_same_angle_of_camera_and_vehicle_the_vehicle_is_named() -> None:
    one = told(effect({1: 0.3, 4: -0.3 * (1.0 - 1e-12)}, *[{}] * 4), SIGMA)
    assert "vehicle pitch by up to 0.3 degree" in errata_text(one)


def test_parts_of_a_job_are_told_as_one() -> None:
    """The most of either part, and the frames of both."""
    one = history(
        estimates.estimate(SLIP_TRUTH, slip_effect_deg=effect({3: 0.2}, {4: 0.7}, {}, {3: 0.3}, {}))
    )
    one = replace(one, uncertainty=replace(one.uncertainty, total=SIGMA))
    parts = [one.take(slice(0, 2)), one.take(slice(2, 5))]
    assert summary_of(parts) == summary_of([one]) and summary_of(parts).errata == 3


def test_no_sigma_no_warning() -> None:
    given = effect({4: 100.0}, *[{}] * 4)
    for sigma in (np.nan, np.inf):
        one = told(given, np.full((5, 9), sigma))
        assert not one.errata and errata_text(one) == ""


def test_without_errata_there_are_neither_flags_nor_columns_nor_words() -> None:
    one = history(estimates.estimate(SLIP_TRUTH))
    assert not findings_of(one.about, summary_of([one]))
    assert not [column.name for column in columns_of([one]) if "slip" in column.name]
    assert "errata" not in conventions([one])["sigmas"]


def low_film() -> History:
    """From 120 m above the landmarks, where the Earth of 1974 is 1.7 degrees wrong."""
    job, _ = wgs84_film.film(46.6, 7.4, decimals=None, scale=1 / 300)
    (one,) = run(job).histories()
    return one


def test_a_low_flight_is_warned_of_once() -> None:
    one = low_film()
    (found,) = findings_of(one.about, summary_of([one]))
    worst = np.abs(one.estimate.slip_effect_deg[:, :6]).max()
    frames = len(one.landmarks)
    assert f"in {frames} of {frames} frames" in found.message
    assert f"vehicle pitch by up to {worst:.3g} degree" in found.message
    assert f"up to {worst:.3f} degree" in conventions([one])["sigmas"]


def table(*arguments: object) -> tuple[dict[str, str], list[dict[str, str]]]:
    done = vopd("attitude", *arguments)
    assert done.status == 0, done.stderr
    lines = done.stdout.splitlines()
    said = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    rows = csv.DictReader(io.StringIO("\n".join(one for one in lines if one[0] != "#")))
    return said, list(rows)


def test_the_table_has_what_all_fixes_change() -> None:
    """Case 1 with and without the fixes: the difference of the two tables."""
    said, (plain,) = table(CASE_1)
    said_fixed, (fixed,) = table(CASE_1, "--fix", "all", "-q")
    for angle in ("camera_pitch", "vehicle_yaw", "vehicle_roll", "alpha", "eta"):
        change = float(fixed[f"{angle}_deg"]) - float(plain[f"{angle}_deg"])
        assert_close("six decimals", float(plain[f"slip_effect_{angle}_deg"]), change)
    assert_approved(said["sigmas"])
    assert "camera_pitch" in said["sigmas"]
    assert "slip_effect_alpha_deg" not in fixed and "errata" not in said_fixed["sigmas"]


@pytest.mark.parametrize("fix", [(), ("--fix", "all")], ids=["faithful", "fixed"])
def test_strict_sees_it(fix: tuple[str, ...]) -> None:
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    done = vopd("attitude", "-", "--strict", *fix, stdin=write_deck([job]))
    assert done.status == (0 if fix else 3)
    assert "errata of the program" in done.stderr or fix


# Readings and tables with absurd numbers: one bad frame is flagged, the others come out


EVERY_SIGMA = Sigmas(None, 0.01, 30.0, 60.0, 0.01, 0.1, 10.0, 10.0, 0.1)
EPOCH = datetime(1974, 1, 1, tzinfo=UTC)
HUGE = (1e30, 1e150, 1e300, np.nan, np.inf, -np.inf)
BAD = 2  # the index of the frame that is damaged


def damaged(part: str, field: str, where: Any, value: float) -> Job:
    """Five good frames of five landmarks, with one number replaced."""
    job = film(5)
    record = getattr(job, part)
    array = np.array(getattr(record, field), float)
    array[where] = value
    if field == "landmark_in":
        changed = Readings.of(
            record.frame, record.fiducial_in, record.landmark, record.present, array
        )
        return replace(job, readings=changed)
    return replace(job, **{part: replace(record, **{field: array})})


def history_of_extreme(job: Job) -> History:
    (one,) = run(job).histories(EVERY_SIGMA, 10.0)
    return one


@pytest.mark.parametrize("value", HUGE, ids=str)
@pytest.mark.parametrize(
    ("field", "where"),
    [("fiducial_in", (BAD, 0, 0, 0)), ("landmark_in", (BAD, 1)), ("landmark_in", BAD)],
    ids=["fiducial", "landmark", "all landmarks"],
)
def test_one_bad_reading_costs_one_frame(field: str, where: Any, value: float) -> None:
    good, one = (
        history_of_extreme(film(5)),
        history_of_extreme(damaged("readings", field, where, value)),
    )
    assert one.flags.raised["not_converged"][BAD] or one.flags.raised["out_of_range"][BAD]
    before = slice(0, BAD)
    np.testing.assert_array_equal(one.estimate.camera_deg[before], good.estimate.camera_deg[before])
    np.testing.assert_array_equal(one.geometry.condition[before], good.geometry.condition[before])
    if not np.isfinite(value) or value > 1e200:  # NaN: the next frame starts from group 8 again
        np.testing.assert_array_equal(one.has_attitude, [True, True, False, True, True])
        np.testing.assert_array_equal(one.estimate.camera_deg[3:], good.estimate.camera_deg[3:])
        assert np.isfinite(one.quaternion[3:]).all()


@pytest.mark.parametrize("value", HUGE, ids=str)
def test_one_bad_reading_is_not_the_noise_of_all_frames(value: float) -> None:
    """One of three readings of one landmark: the deviations of the other frames do not grow."""
    good = history_of_extreme(film(5))
    one = history_of_extreme(damaged("readings", "landmark_in", (BAD, 1, 0, 0), value))
    ratio = one.uncertainty.reading.sigma / good.uncertainty.reading.sigma
    assert abs(ratio - 1.0) < within("ratio")
    first = one.uncertainty.total[:BAD] / good.uncertainty.total[:BAD]
    assert_close("ratio", first, 1.0)
    assert one.flags.text()[:BAD] == good.flags.text()[:BAD]


MAY_BE_INFINITE = ("sigma_", "half_width_95_", "covariance_", "status", "deck", "flags")

CASES = {
    "position": damaged("trajectory", "position_ft", (BAD, 0), 1e300),
    "altitude": damaged("trajectory", "altitude_ft", BAD, 1e300),
    "velocity": damaged("trajectory", "velocity_ft_s", (BAD, 0), np.inf),
    "no velocity": damaged("trajectory", "velocity_ft_s", slice(None), 0.0),
    "landmark": damaged("landmarks", "altitude_ft", BAD, 1e30),
    "multiplier": damaged("camera", "multiplier", 0, 1e30),
    "first estimate": damaged("camera", "initial_deg", 0, 1e300),
    "focal length": damaged("camera", "focal_length_mm", (), 1e30),
    "no focal length": damaged("camera", "focal_length_mm", (), 0.0),
    "short focal length": damaged("camera", "focal_length_mm", (), 1e-30),
    "time": damaged("clock", "time_s", 1, 1e300),
}


@pytest.mark.parametrize("name", CASES)
def test_every_format_takes_absurd_numbers(name: str) -> None:
    """No exception, no numpy warning, and no number that is not finite, but sigmas in a CSV."""
    one = history_of_extreme(CASES[name])
    for form in FORMATS:
        content = FORMATS[form].render([one], FileRequest(epoch=EPOCH), lambda _: None)
        if not FORMATS[form].binary:
            text = content.decode()
            for wrong in (">inf<", ">nan<", ",nan,", "Infinity", ": NaN", " nan", " inf "):
                assert wrong not in text, (form, wrong)
        if form == "csv":
            rows = [line for line in content.decode().splitlines() if not line.startswith("#")]
            for row in csv.DictReader(rows):
                infinite = {column for column, cell in row.items() if "inf" in cell}
                assert all(column.startswith(MAY_BE_INFINITE) for column in infinite)
        if form in ("czml",):
            json.loads(content)


@pytest.mark.parametrize("name", ["image", "residuals", "attack"])
def test_figures_take_absurd_numbers(name: str) -> None:
    for job in (CASES["position"], damaged("readings", "landmark_in", (BAD, 1), 1e30)):
        draw(name, [history_of_extreme(job)]).draw_without_rendering()


def test_angles_that_the_listing_cannot_print_are_flagged() -> None:
    """A frame that converges, to a vehicle yaw that is printed as asterisks."""
    one = history_of_extreme(CASES["multiplier"])
    assert one.estimate.converged.all()
    assert (np.abs(one.estimate.vehicle_deg[:, 0]) > 1e5).all()
    assert one.flags.raised["out_of_range"].all() and "out_of_range" in MEANING


@pytest.mark.usefixtures("no_figures")
@pytest.mark.parametrize("command", ["attitude", "report"])
def test_a_deck_with_a_fiducial_reading_of_1e30(command: str, tmp_path: Path) -> None:
    """The frame is flagged, the exit status says so, and the rest comes out."""
    cards = vopd("demo", "--frames", "4", "--landmarks", "3", "--seed", "3").stdout.splitlines()
    k = next(k for k, card in enumerate(cards) if card.startswith("10000") and card[-4:] == "0003")
    cards[k] = cards[k][:40] + "  1.E30" + cards[k][47:]
    deck = tmp_path / "damaged.dat"
    deck.write_text("\n".join(cards) + "\n")
    suffix = {"attitude": "csv", "report": "html"}[command]
    done = vopd(command, deck, "-o", tmp_path / f"out.{suffix}", "-q")
    assert done.status == 3, done.stderr
    if command == "attitude":
        lines = (tmp_path / "out.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        assert [row["status"] for row in rows] == ["solved"] * 4
        assert "not_converged" in rows[2]["flags"]
        assert "not_converged" not in rows[0]["flags"] + rows[1]["flags"]
