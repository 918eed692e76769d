"""Residuals of a frame: weights, tests, outliers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2, f

from tests.kit import repeated_frame as draws
from tests.kit.estimates import ABOUT, FOCAL, NAMES, POINTS, estimate
from tests.kit.histories import histories
from tests.kit.jobs import film, only, reread
from tests.tolerances import assert_close
from vopd.arrays import Bools, Floats
from vopd.attitude import residuals as residual_test
from vopd.attitude.history import History, history
from vopd.attitude.long_history import HistoryParts, frame_landmarks, one_part
from vopd.attitude.residuals import (
    SIGNIFICANCE,
    Pool,
    ResidualEquations,
    ResidualWeights,
    chance_of,
    equations_of,
    finite,
    outliers,
)
from vopd.attitude.sigmas import ErrorComponent, Sigmas
from vopd.attitude.table import columns_of
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.geometry.linear import crossing
from vopd.geometry.rotation_fit import Sights
from vopd.program.vopd import run

ANGLES = np.tile([140.0, -60.0, 20.0], (5, 1))


def equations(frames: int = 3, landmarks: int = 5, causes: int = 2) -> ResidualEquations:
    """Random ones; the last landmark of each frame takes no part, x and y differ in variance."""
    rng = np.random.default_rng(8)
    two = 2 * landmarks
    used = np.tile(np.arange(landmarks) < landmarks - 1, (frames, 2))
    return ResidualEquations(
        np.where(used, rng.normal(size=(frames, two)), 0.0),
        np.where(used[..., None], rng.normal(size=(frames, two, 3)), 0.0),
        np.where(used, rng.uniform(0.5, 4.0, (frames, two)), 0.0),
        np.where(used[..., None], rng.normal(size=(frames, two, causes)), 0.0),
        np.where(used[..., None], 0.3 * rng.normal(size=(frames, two, 3)), 0.0),
    )


def dense(one: ResidualEquations, k: int, sigma: float) -> tuple[Floats, Floats, Floats]:
    """Indices of a frame's used coordinates, W of these, and the variances in reading sigmas."""
    used = np.flatnonzero(one.variance[k] > 0.0)
    count = one.variance.shape[1] // 2
    same = np.equal.outer(used % count, used % count)
    own = one.own[k][used]
    v = sigma**2 * np.diag(one.variance[k][used]) + np.where(same, own @ own.T, 0.0)
    v += one.shared[k][used] @ one.shared[k][used].T
    b, p = one.partials[k][used], np.linalg.inv(v)
    return used, p - p @ b @ np.linalg.inv(b.T @ p @ b) @ b.T @ p, one.variance[k][used]


@pytest.mark.parametrize("causes", [0, 1, 2])
@pytest.mark.parametrize("sigmas", [0.7, (0.5, 1.0, 2.0)])
def test_weights_are_those_of_the_whole_covariance(causes: int, sigmas: Any) -> None:
    one = equations(causes=causes)
    weights = ResidualWeights(one, np.array(sigmas) if isinstance(sigmas, tuple) else sigmas)
    weighted = weights.of(one.residual[..., None])[..., 0]
    for k in range(3):
        sigma = sigmas[k] if isinstance(sigmas, tuple) else sigmas
        used, w, variance = dense(one, k, sigma)
        expected = np.zeros(10)
        expected[used] = w @ one.residual[k][used]
        assert_close("ratio", weighted[k], expected)
        assert_close("ratio", weights.trace[k] / np.trace(w @ np.diag(variance)), 1.0)
    assert one.freedom.tolist() == [5.0] * 3


def test_names_of_outliers_keep_no_semicolon() -> None:
    """Landmark 8 is called "bridge; north end"; a semicolon parts flags."""
    outlier = np.zeros((5, 4), bool)
    outlier[1, 1] = outlier[3, 0] = True
    assert NAMES[8] == "bridge; north end"
    named = history(estimate(ANGLES, outlier=outlier)).flags.detail["outlier"]
    assert named == ["", "bridge, north end", "", NAMES[7], ""]
    numbered = history(estimate(ANGLES, outlier=outlier, landmark_names={}))
    assert numbered.flags.detail["outlier"] == ["", "8", "", "7", ""]


FIRST = ["flight", "job", "frame", "image", "status", "time_s", "camera_yaw_deg"]


def test_the_columns_in_their_order() -> None:
    """The image stands after the frame, the gimbal before the standard deviations."""
    one = history(estimate(ANGLES, gimbal_deg=ANGLES), sigmas=Sigmas(reading=1.0, position=1.0))
    names = [column.name for column in columns_of([one])]
    assert names[:7] == FIRST and len(set(names)) == len(names)
    at = names.index("gimbal_yaw_deg")
    assert names[at - 1 : at + 4] == [
        "flags", "gimbal_yaw_deg", "gimbal_pitch_deg", "gimbal_roll_deg", "sigma_camera_yaw_deg",
    ]  # fmt: skip
    parts = [name.removesuffix("_camera_yaw_deg") for name in names if name.startswith("sigma_")]
    assert [part for part in parts if not part.endswith("_deg")] == [
        "sigma", "sigma_reading", "sigma_position",
    ]  # fmt: skip
    plain = history(estimate(ANGLES, frame_names=()), sigmas=Sigmas(reading=1.0))
    names = [column.name for column in columns_of([plain])]
    assert names[:6] == [name for name in FIRST[:7] if name != "image"]
    assert not any("gimbal" in name or "slip_effect" in name for name in names)
    (deck,) = histories("appendix_h/case1")
    names = [column.name for column in columns_of([deck])]
    assert names[0] == "deck" and names[-9].startswith("slip_effect_camera_yaw")
    assert names[-10] == "covariance_common_down_down_deg2"
    assert {"altitude_ft", "residual_rms_mm", "vehicle_up_ft", "airspeed_ft_s"} <= set(names)


# Parts of a history


def parts_of(*parts: History) -> HistoryParts:
    return HistoryParts(parts[0], 5 * len(parts), lambda: iter(parts), lambda: parts[0])


def part(flagged: list[int], lost: list[int], misfit: dict[int, str]) -> Any:
    """Five frames with these flags."""
    e = estimate(ANGLES, about=ABOUT)
    raised = {
        "not_converged": np.isin(np.arange(5), lost),
        "misfit": np.isin(np.arange(5), [*misfit]),
        "jump": np.isin(np.arange(5), flagged),
        "outlier": np.isin(np.arange(5), [k for k in misfit if k != 2]),
    }
    outlier = ["", "mast", "", "", "hall"]
    flags = SimpleNamespace(
        raised=raised, any=lambda: np.any([*raised.values()], axis=0),
        detail={"misfit": [misfit.get(k, "") for k in range(5)], "outlier": outlier},
    )  # fmt: skip
    return SimpleNamespace(flags=flags, estimate=e, has_attitude=np.arange(5) > 5)


def test_a_summary_is_known_once_all_parts_have_been_made() -> None:
    alone, other = "without mast (chance 0.31)", "without well (chance 0.20)"
    some = part([0, 1], [1], {1: alone, 2: alone, 4: other}), part([], [2], {})
    job = parts_of(*some)
    assert not job.counted and job.frames == 10
    for _ in job:
        assert not job.counted
    assert job.counted
    summary = job.summary
    assert (summary.unconverged, summary.flagged) == (2, 5)
    named = ["DJI_0001.JPG", "DJI_0002.JPG", "DJI_0004.JPG"]
    assert summary.misfits == [*zip(named, [alone, alone, other], strict=True)]
    assert summary.without_outlier == {"DJI_0001.JPG"}
    later = parts_of(*some)
    assert later.summary == summary and later.counted
    assert not later.has_attitude()
    whole = one_part(some[0])
    assert whole.counted and [*whole] == [some[0]] and whole.whole is some[0]
    told: list[int] = []
    assert len([*job.watched(told.append)]) == 2 and told == [5, 5]


@np.errstate(all="ignore")
def test_landmarks_that_take_no_part_have_no_equations() -> None:
    """Whatever stands in their columns; the others have -u / r and -v / r of their directions."""
    axes = np.array([[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]])
    direction = np.array([[[3.0, -4.0, 2.0], [np.nan, 0.0, 0.0], [1.0, -2.0, -1.0]]])
    image = np.array([[[8.0, 4.5], [np.nan, 7.0], [5.0, -5.25]]])
    sights = Sights(direction, image, np.array([[True, False, True]]), 10.0)
    residual, partials = sights.equations(axes)
    assert_close("ratio", residual, [[8.0 - 7.5, 0.0, 5.0 - 5.0, 4.5 - 5.0, 0.0, -5.25 + 5.0]])
    assert not partials[0, [1, 4]].any() and partials[0, [0, 2, 3, 5]].any(axis=1).all()
    step = 1e-5
    for axis in range(3):
        turn = step * crossing(np.eye(3)[axis])
        (there, _), (back, _) = (
            sights.equations((np.eye(3) + way) @ axes) for way in (-turn, turn)
        )
        assert_close("flight partial", (there - back) / (2.0 * step), -partials[..., axis])


# The chance of a frame's residuals, by chi-square and by F, and which frames are tested


CHANCE_ANGLES = np.tile([140.0, -60.0, 20.0], (3, 1))
FREEDOM = 5  # of four landmarks
NONE = np.nan


def job() -> Estimate:
    return estimate(CHANCE_ANGLES, noise=0.5, relative_sigma=np.tile([1.0, 1.5, 1.0, 2.0], (3, 1)))


def squares(e: Estimate, sigma: float) -> Floats:
    """The weighted sums of squares that least squares leave, in squares of sigma."""
    w = 1.0 / np.tile([1.0, 1.5, 1.0, 2.0], 2)
    found = []
    for b, r in zip(e.partials, e.residual, strict=True):
        fit, *_ = np.linalg.lstsq(b * w[:, None], r * w, rcond=None)
        found.append(((r * w - (b * w[:, None]) @ fit) ** 2).sum() / sigma**2)
    return np.array(found)


ALL = np.arange(3)


def chance(e: Estimate, pool: Pool, *components: ErrorComponent) -> Floats:
    return chance_of(equations_of(e, list(components), ALL), pool)


def test_significance() -> None:
    assert SIGNIFICANCE == 0.001


def test_a_known_sigma_is_tested_by_chi_square() -> None:
    e = job()
    for sigma in (0.4, 0.7):
        found = chance(e, Pool(sigma, np.inf, None))
        assert_close("dense algebra", found, chi2.sf(squares(e, sigma), FREEDOM))
    each = np.array([0.4, 0.5, 0.7])
    found = chance(e, Pool(each, np.full(3, np.inf), None))
    expected = [chi2.sf(squares(e, each[k])[k], FREEDOM) for k in range(3)]
    assert_close("dense algebra", found, expected)


def test_an_estimate_from_other_frames_is_tested_by_f() -> None:
    e = job()
    found = chance(e, Pool(0.4, 12.0, None))
    assert_close("dense algebra", found, f.sf(squares(e, 0.4) / FREEDOM, FREEDOM, 12.0))
    none = chance(e, Pool(0.4, 12.0, np.zeros(3, bool)))
    assert_close("dense algebra", none, found)


def test_a_frame_is_tested_against_the_others_that_made_the_estimate() -> None:
    """Their variance is what the frame leaves of the whole: of 15 degrees 10."""
    e = job()
    s = squares(e, 0.5)
    found = chance(e, Pool(0.5, 15.0, np.array([True, False, True])))
    against = f.sf((s / FREEDOM) / ((15.0 - s) / 10.0), FREEDOM, 10.0)
    others = f.sf(s / FREEDOM, FREEDOM, 15.0)
    assert_close("dense algebra", found, np.where([True, False, True], against, others))


def test_where_nothing_is_left_of_the_others() -> None:
    """All of the variance is the frame's: no chance. All of the degrees are: not known."""
    e = job()
    s = squares(e, 0.2)
    more = Pool(0.2, float(s[0]) - 1e-6, np.array([True, False, False]))
    assert more.freedom > FREEDOM + 0.5  # or the case is another one
    assert chance(e, more)[0] == 0.0
    for freedom, known in ((5.4, False), (5.6, True)):
        found = chance(e, Pool(5.0, freedom, np.array([True, True, False])))
        assert np.isfinite(found).tolist() == [known, known, True]


def test_frames_of_a_known_and_of_an_estimated_sigma_together() -> None:
    e = job()
    sigma, freedom = np.array([0.4, 0.5, 0.6]), np.array([np.inf, 12.0, np.inf])
    found = chance(e, Pool(sigma, freedom, np.zeros(3, bool)))
    expected = [chi2.sf(squares(e, 0.4)[0], FREEDOM), 0.0, chi2.sf(squares(e, 0.6)[2], FREEDOM)]
    expected[1] = f.sf(squares(e, 0.5)[1] / FREEDOM, FREEDOM, 12.0)
    assert_close("dense algebra", found, expected)


def test_other_errors_are_known_whatever_the_readings() -> None:
    """Where other errors are nearly all of the variance an estimate is as good as a known one."""
    e = job()
    rng = np.random.default_rng(2)
    shift = ErrorComponent("position", 300.0 * rng.normal(size=(3, 8, 8)), *np.zeros((2, 3, 1, 1)))
    known, estimated = (chance(e, Pool(0.01, free, None), shift) for free in (np.inf, 6.0))
    assert_close("chance by readings of nothing", estimated, known)


def test_equations_of_some_frames() -> None:
    """Errors that landmarks share stand side by side, and those of each landmark's own."""
    e = job()
    used = np.array([[True, True, False, True]] * 3)
    e = replace(e, used=used)
    rng = np.random.default_rng(1)
    one, two, own, other = (rng.normal(size=(3, 8, k)) for k in (2, 1, 3, 3))
    one[2, 0, 0] = NONE
    none = np.zeros((2, 3, 1, 1))
    components = [
        ErrorComponent("centre", one, *none), ErrorComponent("landmark", own, *none, True),
        ErrorComponent("focal", two, *none), ErrorComponent("landmark", other, *none, True),
    ]  # fmt: skip
    found = equations_of(e, components, np.array([2, 0]))
    here = np.tile(used[0], 2)
    expected = np.concatenate([np.nan_to_num(one), two], axis=2)[[2, 0]] * here[:, None]
    assert np.array_equal(found.shared, expected)
    assert np.array_equal(found.own, np.concatenate([own, other], axis=2)[[2, 0]] * here[:, None])
    assert np.array_equal(found.variance[0], np.array([1.0, 2.25, 0.0, 4.0] * 2))
    assert np.array_equal(found.residual, e.residual[[2, 0]] * here)
    assert np.array_equal(found.partials, e.partials[[2, 0]] * here[:, None])
    assert found.freedom.tolist() == [3.0, 3.0]
    columns = np.array([[[1.0, NONE], [2.0, 3.0], [np.inf, 4.0]]])
    assert finite(columns, np.array([[True, False, True]])).tolist() == [
        [[1.0, 0.0], [0.0, 0.0], [0.0, 4.0]]
    ]


@pytest.mark.parametrize(
    ("name", "index"), [("gain", (1, 2, 3)), ("residual", (1, 4)), ("partials", (1, 2, 0)),
                        ("camera_deg", (1, 2))],
)  # fmt: skip
def test_frames_of_which_something_is_not_known_are_not_tested(name: str, index: Any) -> None:
    e = job()
    assert residual_test.testable(e).all()
    values = getattr(e, name).copy()
    values[index] = NONE
    assert residual_test.testable(replace(e, **{name: values})).tolist() == [True, False, True]


def test_two_landmarks_of_a_solved_frame_are_tested() -> None:
    solved = np.array([True, False, True])
    assert residual_test.testable(replace(job(), solved=solved)).tolist() == solved.tolist()
    for numbers, tested in (((7, 8), True), ((7, 7), False), ((7,), False)):
        one = estimate(CHANCE_ANGLES[:1], POINTS[: len(numbers)], landmark=np.array([numbers]))
        assert residual_test.testable(one).tolist() == [tested]


# The landmark that does not fit the others: false alarms as rare as stated, misreadings found


@pytest.mark.parametrize(("names", "count"), [((), 4), (("first-landmark",), 5)])
def test_false_alarms_are_as_rare_as_stated(names: tuple[str, ...], count: int) -> None:
    """One frame in a thousand; of 16,000 frames 16 are expected, 33 would be four sigmas."""
    rng = np.random.default_rng(count)
    job = draws.repeated((30.0, -62.0, 200.0), range(count), draws=16_000)
    found = outliers(film_estimate(run(draws.misread(job, 0.003, rng), fixes(*names))))
    assert 3 <= found.any(axis=1).sum() <= 32
    assert found.sum(axis=1).max() == 1


@pytest.mark.parametrize("which", range(5))
def test_the_landmark_that_is_off_is_named(which: int) -> None:
    """By .05 in where readings have .001; every time."""
    job = draws.repeated((30.0, -62.0, 200.0), draws=200)
    job = draws.misread(job, 0.001, np.random.default_rng(which))
    readings = job.readings.landmark_in.copy()
    readings[:, which, :, 0] += 0.05
    misread = replace(job, readings=reread(job.readings, landmark_in=readings))
    one = history(film_estimate(run(misread)))
    marked = frame_landmarks(one).outlier.reshape(200, 5)
    assert marked[:, which].all() and marked.sum() == 200
    assert f"outlier:{11 + which}" in one.flags.text()[0]


def test_of_three_none_can_be_told() -> None:
    job = only(film(1), 0, 1, 2)
    readings = job.readings.landmark_in.copy()
    readings[:, 1] += 0.5
    bent = replace(job, readings=reread(job.readings, landmark_in=readings))
    assert not outliers(film_estimate(run(bent))).any()


# The limit of an outlier from both sides, by leaving landmarks out with another solver


MORE = np.vstack([POINTS, [[-1.0, 3.0], [-3.0, -2.0]]])


def left(e: Estimate, residual: Floats, keep: Bools) -> float:
    """The sum of squares of these landmarks when the attitude is fitted to them alone."""
    rows = np.tile(keep, 2)
    b = e.partials[0][rows]
    fit, *_ = np.linalg.lstsq(b, residual[rows], rcond=None)
    return float(((residual[rows] - b @ fit) ** 2).sum())


def worst(e: Estimate, residual: Floats, used: Bools) -> tuple[int, float]:
    """The landmark without which the others fit best, and the chance of that by itself."""
    count = int(used.sum())
    total = left(e, residual, used)
    without = {
        k: left(e, residual, used & (np.arange(len(used)) != k)) for k in np.flatnonzero(used)
    }
    k = min(without, key=lambda one: without[one])
    ratio = ((total - without[k]) / 2.0) / (without[k] / (2 * count - 5))
    return int(k), float(f.sf(ratio, 2, 2 * count - 5))


@pytest.mark.parametrize(
    ("count", "which", "unused"),
    [(4, 1, None), (4, 2, 0), (4, 1, 4), (5, 2, 3), (5, 3, None), (6, 5, None)],
)
def test_a_landmark_is_an_outlier_below_a_chance_of_a_thousandth(
    count: int, which: int, unused: int | None
) -> None:
    """A thousandth of a frame, and so less by as many landmarks as there are."""
    total = count + (unused is not None)
    used = np.arange(total) != (-1 if unused is None else unused)
    noise = np.random.default_rng(10 * count + which).normal(0.0, 0.01, 2 * total)
    noise *= np.tile(used, 2)
    e = estimate([[140.0, -60.0, 20.0]], MORE[:total])
    partials = e.partials * np.tile(used, 2)[:, None]
    bump = np.zeros(2 * total)
    bump[[which, total + which]] = 0.6, -0.8
    limit = 0.001 / used.sum()
    low, high = 1e-3, 1e3
    for _ in range(24):
        middle = np.sqrt(low * high)
        k, chance = worst(e, noise + middle * bump, used)
        low, high = (low, middle) if k == which and chance < limit else (middle, high)
    for size, found in ((high * 1.002, [which]), (low * 0.998, [])):
        residual = (noise + size * bump)[None]
        one = estimate(
            e.camera_deg, MORE[:total], residual=residual, used=used[None], partials=partials
        )
        assert np.flatnonzero(outliers(one)[0]).tolist() == found


def test_three_landmarks_have_none_and_four_may() -> None:
    bump = np.zeros(6)
    bump[[0, 3]] = 5.0, -3.0
    three = estimate([[140.0, -60.0, 20.0]], POINTS[:3], residual=bump[None])
    assert not outliers(three).any()
    used = np.array([[True, True, True, False]])
    bump = np.zeros(8)
    bump[[0, 4]] = 5.0, -3.0
    bump += np.tile(used[0], 2) * np.random.default_rng(1).normal(0.0, 1e-6, 8)
    unused = estimate([[140.0, -60.0, 20.0]], residual=bump[None], used=used)
    assert not outliers(unused).any()
    assert outliers(estimate([[140.0, -60.0, 20.0]], residual=bump[None]))[0].tolist() == [
        True, False, False, False,
    ]  # fmt: skip


@pytest.mark.parametrize(("size", "found"), [(1.3e-9, True), (0.7e-9, False)])
def test_rounding_is_no_misfit(size: float, found: bool) -> None:
    """Residuals of less than a thousand-millionth of the focal length, all together."""
    e = estimate([[140.0, -60.0, 20.0]], MORE)
    rng = np.random.default_rng(3)
    residual = rng.normal(0.0, 1e-3, 12)
    residual[2] += 1.0
    fit, *_ = np.linalg.lstsq(e.partials[0], residual, rcond=None)
    residual = residual - e.partials[0] @ fit
    residual *= size * FOCAL / np.sqrt((residual**2).sum())
    one = estimate([[140.0, -60.0, 20.0]], MORE, residual=residual[None])
    assert outliers(one).any() == found


def test_frames_without_equations_have_no_outlier_and_disturb_no_other() -> None:
    residual = np.random.default_rng(4).normal(0.0, 1e-3, (2, 12))
    residual[:, 1] += 3.0
    e = estimate(np.tile([140.0, -60.0, 20.0], (2, 1)), MORE, residual=residual)
    partials = e.partials.copy()
    partials[0] = np.nan
    residual[0] = np.nan
    lost = estimate(e.camera_deg, MORE, residual=residual, partials=partials)
    assert outliers(lost).sum(axis=1).tolist() == [0, 1]
