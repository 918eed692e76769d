"""What every file states about standard deviations and intervals, one fact in a statement."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit.estimates import estimate
from tests.kit.histories import histories
from tests.tolerances import assert_close
from vopd.attitude.conventions import MOST_JOBS, conventions, reading_sigma_text
from vopd.attitude.history import history
from vopd.attitude.sigmas import Sigmas

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
    said = re.fullmatch(
        r"([\d.]+) px, from the residuals of all frames, 40\.0 degrees of freedom, (\d+) times the "
        "spread of repeated readings",
        text,
    )
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
