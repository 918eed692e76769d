"""All that conversions make, of jobs that have a bit of everything."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import ROOT
from tests.kit.jobs import without
from tests.kit.whole import whole
from vopd.arrays import Floats
from vopd.convert.deck_to_flight import deck_flight, deck_project
from vopd.convert.feature import coordinates_of, ignoring, locate_feature, with_coordinates
from vopd.convert.feature_trials import search_feature
from vopd.errata import NO_FIXES, fixes
from vopd.job import Job, Trajectory, Wind
from vopd.pipeline import read_deck
from vopd.program.positions import time_and_position
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

ALL = fixes("all")


@cache
def film() -> Job:
    """Four frames of five landmarks, with distortion and wind."""
    return make(Plan(frames=4, landmarks=5, seed=4))[0][0]


def at(path: Trajectory, time_s: Floats) -> Trajectory:
    """The trajectory at other times."""
    new = [
        np.stack([np.interp(time_s, path.time_s, one) for one in values.T], axis=1)
        for values in (path.position_ft, path.velocity_ft_s, path.altitude_ft[:, None])
    ]
    return replace(
        path, time_s=time_s, position_ft=new[0], velocity_ft_s=new[1], altitude_ft=new[2][:, 0]
    )


def beyond() -> Job:
    """Trajectory and wind end among the frames; H is off; group 3 turns about the view."""
    one = film()
    second, third = time_and_position(one)[0][1:3]
    path = at(one.trajectory, second + (third - second) * np.array([0.3, 0.7]))
    path = replace(path, altitude_ft=path.altitude_ft + 321.5)
    low, high = np.sort(path.altitude_ft)
    wind = Wind(np.array([low + 1.0, high - 1.0]), np.array([[11.0, -7.0], [-3.0, 5.0]]))
    camera = replace(one.camera, offset_deg=np.array([0.0, 360.0, 25.5]))
    return replace(one, trajectory=path, wind=wind, camera=camera, title="1  11 A TITLE".ljust(80))


def ignored() -> Job:
    """Landmarks and a frame are ignored, one is given twice, one is unknown, one read too far."""
    one = without(film(), int(film().readings.frame[2]))
    readings, marks = one.readings, one.landmarks
    inches = readings.points.landmark_in.copy()
    inches[1] += 200.0
    number = marks.number
    asked = np.zeros((2, 6), np.int64)
    asked[0, 0], asked[1, :2] = 100, number[3:5]
    frames = np.append(one.ignored.frame, readings.frame[0])
    everywhere = np.array([number[2], 0, 77], np.int64)
    marks = marks.take(np.array([0, 1, 2, 3, 1]))
    longer = marks.altitude_ft + 100.0 * np.arange(5)
    return replace(
        one, landmarks=replace(marks, altitude_ft=longer),
        ignored=replace(one.ignored, frame=frames, landmark=asked, everywhere=everywhere),
        readings=replace(readings, points=replace(readings.points, landmark_in=inches)),
        wind=Wind(np.array([0.0]), np.array([[8.0, 6.0]])),
        camera=replace(one.camera, multiplier=np.array([1.0, -1.0, 1.0])),
    )  # fmt: skip


def still() -> Job:
    """Frames of one place, the second of which is read twice, through a lens without distortion."""
    one = film()
    readings = one.readings.take(np.array([0, 1, 1, 3]))
    path = at(one.trajectory, time_and_position(one)[0][:1])
    flat = replace(one.camera, lens_distortion_um=np.zeros(25))
    return replace(one, trajectory=path, readings=readings, camera=flat)


JOBS = {"plain": film, "beyond": beyond, "ignored": ignored, "still": still}


@pytest.mark.parametrize("name", JOBS)
def test_everything_in_the_project_of_a_deck(name: str) -> None:
    project = deck_project(JOBS[name]())
    assert_approved([text.decode() for text in project.contents.values()])
    assert_approved(project.said)


@pytest.mark.parametrize("name", JOBS)
def test_everything_in_the_flight_of_a_deck(name: str) -> None:
    chosen = NO_FIXES if name == "beyond" else ALL
    assert_approved(whole(deck_flight(JOBS[name](), chosen, "a.dat"), form=".9g"))


# A feature

NUMBER = 13


@cache
def feature() -> Job:
    """A deck in six frames of which the landmark is read."""
    return read_deck(ROOT / "tests" / "approved" / "inputs" / "feature.dat")[0]


def moved(*off: float) -> Job:
    """The landmark elsewhere, by degrees and feet."""
    return with_coordinates(feature(), NUMBER, coordinates_of(feature(), NUMBER) + off)


def one_frame() -> Job:
    """The landmark is ignored in all frames but the first that has it."""
    readings = feature().readings
    own = readings.layout.frame[readings.points.landmark == NUMBER]
    return replace(
        feature(), readings=readings.take(np.setdiff1d(np.arange(len(readings.frame)), own[1:]))
    )


def left_out() -> Job:
    """The landmark is ignored in the first frame that has it, by group 11."""
    readings = feature().readings
    own = readings.layout.frame[readings.points.landmark == NUMBER]
    asked = np.zeros((1, 6), np.int64)
    asked[0, 0] = NUMBER
    frame = readings.frame[own[:1]]
    return replace(feature(), ignored=replace(feature().ignored, frame=frame, landmark=asked))


LOCATED = {
    "as it is": (feature(), None),
    "beside what is stated": (moved(0.002, -0.003, 800.0), 800.0),
    "left out of a frame": (left_out(), None),
    "ignored on its card": (ignoring(feature(), NUMBER, True), 1e5),
    "of one frame": (one_frame(), 1000.0),
}


@pytest.mark.parametrize("name", LOCATED)
def test_everything_of_a_located_feature(name: str) -> None:
    job, sigma_ft = LOCATED[name]
    found = locate_feature(job, NUMBER, ALL, "a.dat", sigma_ft)
    told = [found.number, found.frames, found.sigma_ft, found.rounded_ft]
    assert_approved("\n".join([
        whole(found.adjustment.parameters, "parameters", ".6g"),
        whole(found.adjustment.covariance, "covariance", ".6g"),
        *map(str, found.adjustment.result.findings), *found.notes,
        whole(told, "told", ".6g"), whole(found.job.landmarks, "landmarks", ".9g"),
    ]))  # fmt: skip


def two_frames() -> Job:
    """Of the frames that have the landmark only two are left; the next job begins at group 7."""
    readings = feature().readings
    own = readings.layout.frame[readings.points.landmark == NUMBER]
    kept = np.setdiff1d(np.arange(len(readings.frame)), own[1:-1])
    return replace(moved(0.001, 0.001, 50.0), readings=readings.take(kept), return_group=7)


SEARCHED = {
    "near": moved(0.004, -0.006, 3000.0),
    "far": moved(-0.02, 0.03, -2000.0),
    "two frames": two_frames(),
}


@pytest.mark.parametrize("name", SEARCHED)
def test_everything_of_a_search_by_trials(name: str) -> None:
    told: list[int] = []
    found = search_feature(SEARCHED[name], NUMBER, ALL, "a.dat", told.append)
    assert_approved(
        [
            " ".join(text.split(": ", 1)[1] for text in whole(one, form=".5g").split("\n"))
            for one in found.trials
        ]
    )
    told_last = [found.coordinates, found.last_step, found.frames, found.stands]
    first, last = found.jobs[0], found.jobs[-1]
    assert_approved([
        whole(told_last, "found", ".6g"), told, [one.return_group for one in found.jobs],
    ])  # fmt: skip
    for name, one in (
        ("first", first.ignored),
        ("ignored", last.ignored),
        ("marks", last.landmarks),
    ):
        assert_approved(whole(one, name, ".9g"))
