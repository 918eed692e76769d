"""Each flag raised where it should be, and nowhere else."""

from __future__ import annotations

import json
import re
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit import spherical_film
from tests.kit.command import DECKS, ROOT
from tests.kit.estimates import POINTS, estimate
from tests.kit.jobs import case, film, only, turned, without
from tests.tolerances import assert_close
from vopd.attitude.conventions import GENERAL
from vopd.attitude.flags import MEANING, flags, meanings
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import FIXED
from vopd.cards.format import GROUPS
from vopd.cards.read import read_deck
from vopd.film import DECK_WORDS, film_estimate
from vopd.findings import VopdError
from vopd.job import Job
from vopd.pipeline import run
from vopd.program.vopd import run as solve

TRUTH = np.array([140.0, -80.0, 60.0])


def history_of(job: Job) -> History:
    (one,) = run(job).histories()
    return one


def flagged(job: Job, rate: float | None = None) -> dict[str, list[int]]:
    """The indices of the frames that have each flag, of the flags that are raised.

    The films here are on the Earth of 1974, which is an error only on a real one.
    """
    (one,) = run(job).histories(max_rate_deg_s=rate)
    raised = {name: here for name, here in one.flags.raised.items() if name != "model_error"}
    return {name: np.flatnonzero(here).tolist() for name, here in raised.items() if here.any()}


def test_a_good_film_has_none() -> None:
    assert flagged(turned(np.tile([140.0, -70.0, 60.0], (4, 1)), np.array([140.0, -70, 60]))) == {}


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
    for rate in (0.0, -1.0, float("nan")):
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
