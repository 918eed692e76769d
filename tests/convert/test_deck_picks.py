"""Readings of a deck as picks: pixels, the size of the image, sigma, and what is left out."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.kit.readings import reread
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.convert.deck_to_flight import DeckProject, deck_project
from vopd.findings import VopdError
from vopd.job import Job
from vopd.synthetic import Plan, make


@cache
def made() -> Job:
    return make(Plan(frames=3, landmarks=5, seed=4))[0][0]


def job(**changes: Any) -> Job:
    """Three frames of five landmarks, read without distortion."""
    one = made()
    camera = replace(one.camera, lens_distortion_um=np.zeros(25))
    return replace(one, **({"camera": camera} | changes))


def reading(change: Any) -> Job:
    """The job with its readings of landmarks, (F, L, 3, 2), changed in place."""
    one = job()
    inches = one.readings.landmark_in.copy()
    change(inches)
    return job(readings=reread(one.readings, landmark_in=inches))


def table(project: DeckProject, name: str) -> Floats:
    return np.array([row.split(",") for row in project.contents[name].decode().split()[1:]], float)


def keys(project: DeckProject) -> dict[str, Any]:
    return tomllib.loads(project.contents["flight.toml"].decode())


def away_px(one: Job) -> Floats:
    """To the right and up of the middle of the four fiducials, thousandths of an inch."""
    centre = one.readings.fiducial_in.mean(axis=(1, 2))[:, None, None]
    return np.asarray((one.readings.landmark_in - centre) * 1000.0)


def test_a_pixel_is_a_thousandth_of_an_inch_from_the_centre_of_the_frame() -> None:
    """x grows to the left and y up on film; u to the right and v down from the first pixel."""
    one = job()
    project, away = deck_project(one), away_px(one)
    width, height = keys(project)["camera"]["image_size_px"]
    found = table(project, "picks.csv")
    assert found[:, 0].tolist() == np.repeat(one.readings.frame, 15).tolist()
    assert found[:, 1].tolist() == np.repeat(one.readings.landmark.ravel(), 3).tolist()
    middle = np.array([width - 1, height - 1]) / 2.0
    assert_close("four decimals", found[:, 2:], middle - away.reshape(-1, 2))
    farthest = np.ceil(np.abs(away).max(axis=(0, 1, 2)))
    assert [width, height] == (2 * (farthest + 50)).tolist()
    cells = project.contents["picks.csv"].decode().split()[1].split(",")
    assert [len(cell.partition(".")[2]) for cell in cells] == [0, 0, 4, 4]


def test_sigma_is_that_of_the_three_readings() -> None:
    """The root of the mean of the variances, over two degrees of freedom each."""
    one = job()
    found = keys(deck_project(one))["picks"]
    sigma = np.sqrt(away_px(one).var(axis=2, ddof=1).mean())
    assert found["sigma_px"] == float(f"{sigma:.6g}")
    assert found["pixel_grid"] == "centre"

    def alike(inches: Floats) -> None:
        inches[:] = inches[:, :, :1]

    assert keys(deck_project(reading(alike)))["picks"]["sigma_px"] == 1.0


def test_distortion_is_taken_off_by_the_table() -> None:
    """100 um at every radius: a point at r mm has its ideal place at r + .1."""
    one = job()
    camera = replace(one.camera, lens_distortion_um=np.full(25, 100.0))
    plain, shifted = (
        table(deck_project(each), "picks.csv")[:, 2:]
        - (np.array(keys(deck_project(each))["camera"]["image_size_px"]) - 1.0) / 2.0
        for each in (one, job(camera=camera))
    )
    mean = plain.reshape(-1, 3, 2).mean(axis=1)
    r_mm = np.hypot(*mean.T) * 0.000713816400205
    expected = plain * np.repeat((r_mm + 0.1) / r_mm, 3)[:, None]
    assert_close("printed feet", shifted, expected)


@pytest.mark.parametrize(
    ("away_in", "said"),
    [
        ([99.9], None),
        ([100.1], "1 point is read more than 100 in from the centre and left out"),
        ([-100.1], "1 point is read more than 100 in from the centre and left out"),
        ([200.0, 300.0], "2 points are read more than 100 in from the centre and left out"),
    ],
)
def test_points_that_no_film_reader_has(away_in: list[float], said: str | None) -> None:
    """One coordinate of one of three readings is enough; the other frames keep theirs."""
    centre = job().readings.fiducial_in.mean(axis=(1, 2))

    def far(inches: Floats) -> None:
        for frame, away in enumerate(away_in):
            inches[frame, 2, 1, 0] = centre[frame, 0] + away

    project = deck_project(reading(far))
    assert [note for note in project.notes if "point" in note] == ([said] if said else [])
    picks = table(project, "picks.csv")
    assert len(picks) == 45 - 3 * len(away_in) * bool(said)


def test_no_landmark_at_all_is_refused() -> None:
    def far(inches: Floats) -> None:
        inches[...] = 1e6

    with pytest.raises(VopdError, match="no landmark is read in any frame"):
        deck_project(reading(far))


def test_what_the_deck_ignores_is_no_pick_and_what_it_ignores_everywhere_is() -> None:
    """A landmark in one frame, and a whole frame, are left out; one everywhere is a check."""
    one = job()
    marks, frames = one.readings.landmark[0], one.readings.frame
    ignored = replace(
        one.ignored,
        frame=frames[[0, 1]],
        landmark=np.array([[marks[1], 0, 0, 0, 0, 0], [100, 0, 0, 0, 0, 0]]),
        everywhere=np.array([marks[3], 0, 0, 0, 0]),
    )
    picks = table(deck_project(job(ignored=ignored)), "picks.csv")
    kept = [(frames[0], m) for m in np.delete(marks, 1)] + [(frames[2], m) for m in marks]
    assert [tuple(row) for row in picks[::3, :2].astype(int)] == [tuple(map(int, k)) for k in kept]


@pytest.mark.parametrize(("rows", "moving"), [(1, False), (2, True)])
def test_one_position_is_no_track(rows: int, moving: bool) -> None:
    one = job()
    path = one.trajectory
    names = ("time_s", "position_ft", "velocity_ft_s", "altitude_ft")
    few = replace(path, **{name: getattr(path, name)[:rows] for name in names})
    project = deck_project(job(trajectory=few))
    found = keys(project)
    assert ("track.csv" in project.contents) == moving == ("track" in found)
    first = table(deck_project(one), "track.csv")[0]
    if moving:
        assert found["track"] == {"file": "track.csv", "height": "ellipsoid"}
        assert_close("ratio", table(project, "track.csv")[0], first)
    else:
        place = found["position"]
        assert place["height"] == "ellipsoid"
        numbers = [place["lat_deg"], place["lon_deg"], place["h_m"]]
        assert_close("five decimals", numbers, first[1:4])


@pytest.mark.parametrize(
    ("name", "decimals"),
    [
        ("picks.csv", [0, 0, 4, 4]),
        ("landmarks.csv", [0, 10, 10, 5]),
        ("times.csv", [0, 9]),
        ("track.csv", [9, 11, 11, 6, 6, 6, 6]),
        ("wind.csv", [4, 7, 6]),
    ],
)
def test_decimals_of_every_column(name: str, decimals: list[int]) -> None:
    """A micrometre of a position, a tenth of a nanosecond of a time, 1E-4 of a pixel."""
    one = job()
    wind = replace(one.wind, altitude_ft=np.array([1.0]), velocity_ft_s=np.array([[3.0, 4.0]]))
    cells = deck_project(job(wind=wind)).contents[name].decode().split()[1].split(",")
    assert [len(cell.partition(".")[2]) for cell in cells] == decimals


def test_a_table_out_of_order_names_its_group_and_position() -> None:
    one = job()
    time_s = one.trajectory.time_s.copy()
    time_s[2] = time_s[1]
    with pytest.raises(VopdError) as refused:
        deck_project(job(trajectory=replace(one.trajectory, time_s=time_s)))
    said = str(refused.value)
    assert said == "group 7: times must increase, and do not at position 3"
