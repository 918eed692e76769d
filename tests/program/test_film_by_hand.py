"""Averages, lens correction and the input of the solve, of frames small enough to work by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import film
from tests.tolerances import assert_close
from vopd.errata import Fixes, fixes
from vopd.job import Job
from vopd.landmark_layout import LandmarkLayout
from vopd.program.average import FilmCoordinates, film_coordinates
from vopd.program.film_jobs import film_jobs
from vopd.program.ftlup import TableOutOfOrder
from vopd.program.lens_correction import LensCorrection, corrected, lens_correction
from vopd.program.sight import FilmSight, sight

NAN = np.nan


def lens(frames: int, *um: float) -> Job:
    """A job whose lens table is at 0, 5, 10 mm."""
    job = film(frames)
    camera = replace(
        job.camera, lens_radius_mm=np.array([0.0, 5.0, 10.0]), lens_distortion_um=np.array(um)
    )
    return replace(job, camera=camera)


def coordinates(frames: int, away: list[list[float]]) -> FilmCoordinates:
    """Frame centres at 1, 2 and 11, 12 and so on; landmarks this far from them, in mm."""
    centre = np.array([[1.0, 2.0]]) + 10.0 * np.arange(frames)[:, None]
    point = np.repeat(centre, 5, axis=0) + np.array(away)
    return FilmCoordinates(centre * NAN, point * NAN, centre, point)


AWAY = [[3.0, 4.0], [0.0, 0.0], [0.0, -2.5], [-6.0, 8.0], [-9.0, -12.0]]
RADIUS = [5.0, 0.0, 2.5, 10.0, 15.0]


def test_each_landmark_by_its_distance_and_the_table_of_its_job() -> None:
    """DELTA R is minus the table, in mm; beyond the table its last interval goes on."""
    jobs = film_jobs([lens(1, 8.0, 20.0, 50.0), lens(1, 0.0, -10.0, -30.0)])
    used = np.ones(10, bool)
    used[[1, 7]] = False
    found = lens_correction(jobs, coordinates(2, AWAY * 2), used)
    radius = np.where(used, RADIUS * 2, NAN)
    delr = [-0.020, NAN, -0.014, -0.050, -0.080, 0.010, -0.0, NAN, 0.030, 0.050]
    assert_close("film length", found.radius_mm[used], radius[used])
    assert_close("film length", found.distortion_mm[used], np.array(delr)[used])
    assert np.isnan(found.radius_mm[~used]).all() and np.isnan(found.distortion_mm[~used]).all()
    assert np.flatnonzero(found.at_centre).tolist() == [6]  # of 1 and 6, the one that takes part


@pytest.mark.parametrize("away", [1e-9, -1e-9])
@pytest.mark.parametrize("axis", [0, 1])
def test_only_a_landmark_just_at_the_centre_is_there(axis: int, away: float) -> None:
    near = [[0.0, 0.0] for _ in range(5)]
    near[3][axis] = away
    points = coordinates(1, near)._replace(centre_mm=np.zeros((1, 2)), point_mm=np.array(near))
    found = lens_correction(film_jobs([lens(1, 0.0, 1.0, 2.0)]), points, np.ones(5, bool))
    assert found.at_centre.tolist() == [True, True, True, False, True]


def test_a_lens_table_out_of_order_is_that_of_group_1() -> None:
    job = lens(1, 0.0, 1.0, 2.0)
    radius = np.array([0.0, 5.0, 5.0])
    bad = replace(job, camera=replace(job.camera, lens_radius_mm=radius))
    with pytest.raises(TableOutOfOrder) as caught:
        lens_correction(film_jobs([bad]), coordinates(1, AWAY), np.ones(5, bool))
    assert caught.value.table == (1, "radial distances") and caught.value.position == 3


def test_the_distortion_is_taken_off_along_the_radius() -> None:
    """A landmark 5 mm away with DELTA R .5 mm comes to 4.5 mm; one at the centre stays."""
    points = coordinates(1, AWAY)
    given = LensCorrection(
        np.array(RADIUS), np.array([0.5, 0.5, -0.25, 1.0, 0.0]), np.zeros(5, bool)
    )
    found = corrected(points, given, LandmarkLayout(np.array([5])))
    expected = [[2.7, 3.6], [0.0, 0.0], [0.0, -2.75], [-5.4, 7.2], [-9.0, -12.0]]
    assert_close("film length", found, expected)


@pytest.mark.parametrize(("names", "digits"), [((), True), (("eight-digits",), False)])
def test_inches_and_millimetres(names: tuple[str, ...], digits: bool) -> None:
    """Means of 3 readings and of 12, to eight digits unless that is corrected, by .713816400205."""
    job = film(1)
    marks, corners = job.readings.landmark_in.copy(), job.readings.fiducial_in.copy()
    marks[0, 2] = [[2.0, 7.0], [1.0, 9.0], [2.0, 7.0]]  # 5/3 and 23/3
    corners[0] = [10.0, 20.0]
    corners[0, 3, 1] = [11.0, 19.0]  # 10 1/12 and 19 11/12
    readings = replace(job.readings, landmark_in=marks, fiducial_in=corners)
    found = film_coordinates(readings, fixes(*names))
    point = [1.6666667, 7.6666667] if digits else [5 / 3, 23 / 3]
    centre = [10.083333, 19.916667] if digits else [121 / 12, 239 / 12]
    assert_close("mean reading", found.point_in[2], point)
    assert_close("mean reading", found.centre_in[0], centre)
    assert_close("film length", found.point_mm[2], np.array(point) * 0.713816400205)
    assert_close("film length", found.centre_mm[0], np.array(centre) * 0.713816400205)


def seen(used: list[bool], chosen: Fixes) -> FilmSight:
    """Frames of 2, 0 and 3 landmarks; landmark n has cosines n, 10 n, 100 n."""
    layout = LandmarkLayout(np.array([2, 0, 3]))
    cosines = np.arange(1.0, 6.0)[:, None] * np.array([1.0, 10.0, 100.0])
    points = FilmCoordinates(
        np.zeros((3, 2)), np.zeros((5, 2)), np.zeros((3, 2)),
        np.arange(1.0, 11.0).reshape(5, 2),
    )  # fmt: skip
    none = LensCorrection(np.ones(5), np.zeros(5), np.zeros(5, bool))
    focal_length = np.array([7.0, 8.0, 9.0])
    return sight(points, none, cosines, np.array(used), focal_length, chosen, layout)


@pytest.mark.parametrize(
    ("used", "first"),
    [
        ([True, True, True, True, True], [10.0, 10.0, 30.0, 30.0, 30.0]),
        ([False, True, False, True, True], [20.0, 20.0, 40.0, 40.0, 40.0]),
        ([True, False, False, False, True], [10.0, 10.0, 50.0, 50.0, 50.0]),
    ],
)
def test_whose_xmu_stands_for_all_of_a_frame(used: list[bool], first: list[float]) -> None:
    """That of the first landmark that takes part; with the erratum corrected each has its own."""
    assert seen(used, fixes()).xmu1.tolist() == first
    own = [10.0, 20.0, 30.0, 40.0, 50.0]
    assert seen(used, fixes("first-landmark")).xmu1.tolist() == own


def test_the_input_of_the_solve_by_landmark_and_frame() -> None:
    whole = seen([True, False, True, True, False], fixes())
    part = whole.of(np.array([2, 0]))
    assert part.cc.tolist() == [9.0, 7.0]
    np.testing.assert_array_equal(part.x, [[5.0, 1.0], [7.0, 3.0], [9.0, NAN]])
    np.testing.assert_array_equal(part.y, [[6.0, 2.0], [8.0, 4.0], [10.0, NAN]])
    for k, factor in enumerate((1.0, 10.0, 100.0)):
        expected = np.array([[3.0, 1.0], [4.0, 2.0], [5.0, NAN]]) * factor
        np.testing.assert_array_equal(part.dircos[k], expected)
    assert part.used.tolist() == [[True, True], [True, False], [False, False]]
    np.testing.assert_array_equal(part.xmu1, [[30.0, 10.0], [30.0, 10.0], [30.0, NAN]])


def test_films_are_joined_in_order() -> None:
    one, other = seen([True] * 5, fixes()), seen([False] * 5, fixes("first-landmark"))
    both = FilmSight.joined([one, other, one])
    assert both.layout.count.tolist() == [2, 0, 3] * 3
    assert both.cc.tolist() == [7.0, 8.0, 9.0] * 3
    assert both.used.tolist() == [True] * 5 + [False] * 5 + [True] * 5
    for name in ("direction", "point", "xmu1"):
        parts = [getattr(each, name).tolist() for each in (one, other, one)]
        assert getattr(both, name).tolist() == [*parts[0], *parts[1], *parts[2]]
