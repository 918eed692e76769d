"""Averages, lens correction and the input of the solve, of frames small enough to work by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.appendix_a import solve_input
from tests.kit.jobs import film, reread
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.job import Job
from vopd.program import orient
from vopd.program.orient import FilmSight, Sight
from vopd.program.tgtcam import Dircos
from vopd.program.vopd import run, run_jobs
from vopd.results import Results

NAN, MM_PER_IN = np.nan, 0.713816400205


def lens(frames: int, *um: float) -> Job:
    """A job whose lens table is at 0, 5, 10 mm."""
    job = film(frames)
    camera = replace(
        job.camera, lens_radius_mm=np.array([0.0, 5.0, 10.0]), lens_distortion_um=np.array(um)
    )
    return replace(job, camera=camera)


def placed(job: Job, away_mm: list[list[float]]) -> Job:
    """The job with its frame centres at 0, 0 and its landmarks this far from them, in mm."""
    frames = len(job.readings.frame)
    marks = np.array(away_mm).reshape(frames, 5, 1, 2) / MM_PER_IN + np.zeros((3, 2))
    readings = reread(job.readings, landmark_in=marks, fiducial_in=np.zeros((frames, 4, 3, 2)))
    return replace(job, readings=readings)


AWAY = [[3.0, 4.0], [0.0, 0.0], [0.0, -2.5], [-6.0, 8.0], [-9.0, -12.0]]
RADIUS = [5.0, 0.0, 2.5, 10.0, 15.0]


def test_each_landmark_by_its_distance_and_the_table_of_its_job() -> None:
    """DELTA R is minus the table, in mm; beyond the table its last interval goes on."""
    jobs = [placed(lens(1, 8.0, 20.0, 50.0), AWAY), placed(lens(1, 0.0, -10.0, -30.0), AWAY)]
    for k, number in enumerate((12, 13)):
        cards = np.array([[number, 0, 0, 0, 0, 0]])
        ignored = replace(jobs[k].ignored, frame=np.array([1]), landmark=cards)
        jobs[k] = replace(jobs[k], ignored=ignored)
    found = [one for one in run_jobs(jobs, fixes("eight-digits")) if isinstance(one, Results)]
    radius_mm, distortion_mm = (
        np.concatenate([getattr(one, name)[0] for one in found])
        for name in ("radius_mm", "distortion_mm")
    )
    used = np.ones(10, bool)
    used[[1, 7]] = False
    radius = np.where(used, RADIUS * 2, NAN)
    delr = [-0.020, NAN, -0.014, -0.050, -0.080, 0.010, -0.0, NAN, 0.030, 0.050]
    assert_close("film length", radius_mm[used], radius[used])
    assert_close("film length", distortion_mm[used], np.array(delr)[used])
    assert np.isnan(radius_mm[~used]).all() and np.isnan(distortion_mm[~used]).all()
    centred = np.concatenate([one.at_centre[0] for one in found])
    assert np.flatnonzero(centred).tolist() == [6]  # of 1 and 6, the one that takes part


@pytest.mark.parametrize("away", [1e-9, -1e-9])
@pytest.mark.parametrize("axis", [0, 1])
def test_only_a_landmark_just_at_the_centre_is_there(axis: int, away: float) -> None:
    near = [[0.0, 0.0] for _ in range(5)]
    near[3][axis] = away
    found = run(placed(lens(1, 0.0, 1.0, 2.0), near))
    assert found.at_centre.tolist() == [[True, True, True, False, True]]


def test_a_lens_table_out_of_order_is_that_of_group_1() -> None:
    job = lens(1, 0.0, 1.0, 2.0)
    radius = np.array([0.0, 5.0, 5.0])
    stop = run(replace(job, camera=replace(job.camera, lens_radius_mm=radius))).stop
    assert stop is not None
    assert (stop.group, stop.table, stop.position) == (1, "radial distances", 3)


def test_the_distortion_is_taken_off_along_the_radius() -> None:
    """A landmark 5 mm away with DELTA R .5 mm comes to 4.5 mm; one at the centre stays."""
    job = film(1)
    camera = replace(
        job.camera,
        lens_radius_mm=np.array([0.0, 2.5, 5.0, 10.0, 15.0]),
        lens_distortion_um=np.array([-500.0, 250.0, -500.0, -1000.0, 0.0]),
    )
    away = [[3.0, 4.0], [0.0, 0.0], [0.0, -2.5], [-6.0, 8.0], [-9.0, -12.0]]
    found = solve_input([placed(replace(job, camera=camera), away)], fixes("eight-digits")).point
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
    readings = reread(job.readings, landmark_in=marks, fiducial_in=corners)
    found = run(replace(job, readings=readings), fixes(*names))
    point = [1.6666667, 7.6666667] if digits else [5 / 3, 23 / 3]
    centre = [10.083333, 19.916667] if digits else [121 / 12, 239 / 12]
    assert_close("mean reading", found.point_in[0, 2], point)
    assert_close("mean reading", found.centre_in[0], centre)
    assert_close("film length", found.point_mm[0, 2], np.array(point) * 0.713816400205)
    assert_close("film length", found.centre_mm[0], np.array(centre) * 0.713816400205)


def ignoring(numbers: list[list[int]]) -> Job:
    """Frames 1, 2 ... of landmarks 11 to 15, of which these are ignored."""
    job = film(len(numbers))
    cards = np.array([[*some, *[0] * (6 - len(some))] for some in numbers])
    frames = np.arange(len(numbers)) + 1
    return replace(job, ignored=replace(job.ignored, frame=frames, landmark=cards))


@pytest.mark.parametrize(
    ("ignored", "first"),
    [([[], []], [11, 11]), ([[11], [12]], [12, 11]), ([[11, 12, 13], [11, 12]], [14, 13])],
)
def test_whose_xmu_stands_for_all_of_a_frame(ignored: list[list[int]], first: list[int]) -> None:
    """That of the first landmark that takes part; with the erratum corrected each has its own."""
    job = ignoring(ignored)
    mu = solve_input([film(2)], fixes("first-landmark")).direction[:, 1].reshape(2, 5)
    taking_part = [[n for n in range(11, 16) if n not in some] for some in ignored]
    expected = [mu[f, first[f] - 11] for f in (0, 1) for _ in taking_part[f]]
    assert solve_input([job]).xmu1.tolist() == expected
    own = [mu[f, n - 11] for f in (0, 1) for n in taking_part[f]]
    assert solve_input([job], fixes("first-landmark")).xmu1.tolist() == own


def flat() -> FilmSight:
    """Frames of 2, 0, 3, 2 landmarks; landmark n has cosines n, 10 n, 100 n."""
    number = np.arange(1.0, 8.0)
    return FilmSight(
        nj=np.array([2, 0, 3, 2]),
        direction=number[:, None] * np.array([1.0, 10.0, 100.0]),
        point=np.arange(1.0, 15.0).reshape(7, 2),
        xmu1=number + 0.5,
        cc=np.array([7.0, 8.0, 9.0, 6.0]),
    )


def test_the_input_of_the_solve_by_landmark_and_frame() -> None:
    part: Sight = flat().of(np.array([3, 0]))  # as many in both
    assert part.cc.tolist() == [6.0, 7.0]
    assert part.x.tolist() == [[11.0, 1.0], [13.0, 3.0]]
    assert part.y.tolist() == [[12.0, 2.0], [14.0, 4.0]]
    assert isinstance(part.dircos, Dircos)
    for k, factor in enumerate((1.0, 10.0, 100.0)):
        assert part.dircos[k].tolist() == [[6.0 * factor, factor], [7.0 * factor, 2.0 * factor]]
    assert part.used.tolist() == [[True, True]] * 2
    assert part.xmu1.tolist() == [[6.5, 1.5], [7.5, 2.5]]
    assert flat().of(np.array([1])).x.shape == (0, 1)
    uneven = flat().of(np.array([1, 0, 2]))
    assert uneven.used.tolist() == [[False, True, True]] * 2 + [[False, False, True]]
    assert uneven.x.T[uneven.used.T].tolist() == [1.0, 3.0, 5.0, 7.0, 9.0]


@pytest.mark.parametrize(
    ("landmarks", "blocks"),
    [(9, [[1], [0, 3], [2]]), (3, [[1], [0], [3], [2]]), (1, [[1], [0], [3], [2]])],
)
def test_frames_with_one_number_of_landmarks(
    landmarks: int, blocks: list[list[int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """About so many landmarks at a time, and a frame at least; few frames are taken together."""
    few = [some.tolist() for some in flat().alike(np.arange(4), 9)]
    assert few == [[1, 0, 3], [2]]
    monkeypatch.setattr(orient, "FEW_EMPTY", 1)  # 2 with the first, 2 more with the last
    assert [some.tolist() for some in flat().alike(np.arange(4), landmarks)] == blocks
    assert [some.tolist() for some in flat().alike(np.array([2, 3]), 9)] == [[3, 2]]
    monkeypatch.setattr(orient, "FEW_EMPTY", 2)
    assert [some.tolist() for some in flat().alike(np.arange(4), 9)] == [[1, 0, 3], [2]]


def test_what_is_solved_together_stands_in_order() -> None:
    one, other = ignoring([[11], []]), ignoring([[]])
    parts, both = [solve_input([job]) for job in (one, other, one)], solve_input([one, other, one])
    assert both.nj.tolist() == [4, 5, 5, 4, 5]
    for name in ("direction", "point", "xmu1", "cc"):
        assert getattr(both, name).tolist() == [v for p in parts for v in getattr(p, name).tolist()]
