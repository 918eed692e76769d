"""Averages of the readings (A 84 to A 104), lens correction and the input of the solve."""

from __future__ import annotations

from dataclasses import replace
from decimal import ROUND_HALF_EVEN, Context, Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.kit.appendix_a import solve_input
from tests.kit.jobs import film, reread
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.job import Job, Readings
from vopd.program import orient
from vopd.program.average import averages, eight_digits
from vopd.program.orient import FilmSight, Sight
from vopd.program.vopd import run, run_jobs
from vopd.results import Results


def readings(fiducials: np.ndarray, landmarks: np.ndarray) -> Readings:
    """A record of these inches, (F, 4, 3, 2) and (F, L, 3, 2)."""
    shape = landmarks.shape[:2]
    return Readings.of(
        frame=np.arange(shape[0]),
        fiducial_in=fiducials,
        landmark=np.ones(shape, np.int64),
        present=np.ones(shape, bool),
        landmark_in=landmarks,
    )


def test_the_first_landmark_of_case_1() -> None:
    """x (10.178 + 10.174 + 10.174)/3 = 30.526/3, y (1.655 + 1.651 + 1.649)/3 = 4.955/3."""
    three = np.array([[10.178, 1.655], [10.174, 1.651], [10.174, 1.649]])
    _, point = averages(readings(np.zeros((1, 4, 3, 2)), three[None, None]))
    assert point[0].tolist() == [10.175333, 1.6516667]
    _, full = averages(readings(np.zeros((1, 4, 3, 2)), three[None, None]), rounded=False)
    assert_close("mean reading", full[0], [30.526 / 3, 4.955 / 3])


def test_a_frame_centre() -> None:
    """Twelve readings: x sums to 36 + .003, y to -12, over 12."""
    fiducials = np.zeros((1, 4, 3, 2))
    fiducials[0, :, :, 0] = [[0.001] * 3, [3.0] * 3, [6.0, 6.0, 6.0], [3.0] * 3]
    fiducials[0, :, :, 1] = [[-1.0] * 3, [1.0] * 3, [-2.0] * 3, [-2.0] * 3]
    centre, _ = averages(readings(fiducials, np.zeros((1, 1, 3, 2))))
    assert centre.tolist() == [[3.00025, -1.0]]


INCHES = st.integers(-99999, 999999).map(lambda thousandths: thousandths / 1000)


@given(
    arrays(float, (2, 4, 3, 2), elements=INCHES),
    arrays(float, (2, 2, 3, 2), elements=INCHES),
    st.permutations(range(3)),
    st.booleans(),
)
def test_the_order_of_the_three_readings_does_not_matter(
    fiducials: np.ndarray, landmarks: np.ndarray, order: list[int], rounded: bool
) -> None:
    first = averages(readings(fiducials, landmarks), rounded)
    other = averages(readings(fiducials[:, :, order], landmarks[:, :, order]), rounded)
    for one, two in zip(first, other, strict=True):
        np.testing.assert_array_equal(one, two)


@given(arrays(float, (1, 4, 3, 2), elements=INCHES), arrays(float, (1, 2, 3, 2), elements=INCHES))
def test_arguments_are_not_changed(fiducials: np.ndarray, landmarks: np.ndarray) -> None:
    before = fiducials.tobytes(), landmarks.tobytes()
    averages(readings(fiducials, landmarks))
    assert (fiducials.tobytes(), landmarks.tobytes()) == before


EIGHT = Context(prec=8, rounding=ROUND_HALF_EVEN)


@pytest.mark.parametrize(
    ("value", "kept"),
    [
        (10.1753333333333, 10.175333),
        (1.65166666666667, 1.6516667),
        (-10.1753333333333, -10.175333),  # the sign has a column of its own
        (0.00123456785, 0.0012345679),  # 1.23456785000000007...E-3 in binary: no tie
        (9.99999995, 9.9999999),  # 9.99999994999999971... in binary
        (9.99999996, 10.0),
        (99999999.5, 100000000.0),  # a tie, exactly: to the even digit
        (0.5, 0.5),
        (0.0, 0.0),
        (1.23456789e-7, 1.2345679e-7),
        (123456789012.0, 123456790000.0),
    ],
)
def test_eight_digits_by_hand(value: float, kept: float) -> None:
    assert eight_digits(np.array([value]))[0] == kept


@given(
    st.one_of(
        st.floats(-1e12, 1e12),
        st.integers(-99999, 999999).map(lambda n: n / 3000),
        st.integers(-(10**9), 10**9).map(lambda n: n / 2**10),  # ties among them
    )
)
def test_eight_digits_are_those_of_exact_decimals(value: float) -> None:
    """Decimal(value) is the double without rounding; rounding it once is what printf does."""
    assert eight_digits(np.array([value]))[0] == float(EIGHT.create_decimal(Decimal(value)))


@pytest.mark.parametrize("size", [1e-6, 9.9e-4, 1e-3, 0.1, 1.0, 9.5, 1e4, 9.9e7, 1e8, 3e9])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_eight_digits_are_those_that_are_printed(size: float, sign: float) -> None:
    """Numbers on a tie of the eighth digit, a last bit beside one, and any others."""
    random = np.random.default_rng(8)
    power = 10.0 ** np.floor(np.log10(size))
    ties = (random.integers(10**7, 10**8, 300) + 0.5) / 1e7 * power
    numbers = sign * np.concatenate([
        [0.0, size], ties, np.nextafter(ties, 0.0), np.nextafter(ties, 1e99),
        random.uniform(1.0, 10.0, 300) * power,
    ])  # fmt: skip
    printed = [float(f"{number:.7e}") for number in numbers]
    assert eight_digits(numbers).tolist() == printed


# Frames small enough to work by hand


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
