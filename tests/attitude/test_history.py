"""Attitude histories of one job and of many: values of frames, kinds of jobs, searches."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import DECKS
from tests.kit.estimates import ABOUT, POINTS, estimate
from tests.kit.jobs import reread
from tests.tolerances import assert_close
from vopd.attitude import history as attitude_history
from vopd.attitude import long_history
from vopd.attitude.conventions import conventions
from vopd.attitude.geometry import second_solution_rms
from vopd.attitude.history import (
    History,
    HistoryOptions,
    histories,
    histories_without_jumps,
    history,
    taken_together,
)
from vopd.attitude.long_history import history_of_long_job, with_about
from vopd.attitude.mistakes import MOST_FRAMES, NOT_SEARCHED, NOTHING
from vopd.attitude.reading_sigma import JobReadingSigma, least_sigmas
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import FIXED, INTERVALS, table
from vopd.attitude.vertical import with_vertical
from vopd.errata import fixes
from vopd.estimate import Estimate, FrameStatus, StatedSigmas, Units
from vopd.export import FORMATS, FileRequest
from vopd.film import film_estimate
from vopd.findings import VopdError, strict
from vopd.job import Job
from vopd.landmark_layout import LandmarkLayout
from vopd.listing.pages import pages, pages_of_jobs
from vopd.program.vopd import run
from vopd.results import Results
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

ANGLES = np.tile([140.0, -60.0, 20.0], (5, 1))


def made(**changes: Any) -> History:
    """Five frames: solved, ignored, exact, stopped and unsolved; only two have angles."""
    known = np.array([True, False, True, False, False])
    e = estimate(ANGLES)
    angles = np.where(known[:, None], ANGLES, np.nan)
    gain = np.where(known[:, None, None], e.gain, np.nan)
    correction = np.array([[1e-9, -3e-7, 2e-8], [0, 0, 0], [0, 0, 4e-8], [0, 0, 0], [0, 0, 0.0]])
    status = np.array([*FrameStatus])
    return history(
        estimate(
            ANGLES, about=ABOUT._replace(job=7), camera_deg=angles, vehicle_deg=angles, gain=gain,
            body_gain=gain, solved=known, correction_rad=correction, status=status,
            used=np.tile(np.arange(4) < 3, (5, 1)), **changes,
        ),
        sigmas=Sigmas(reading=0.25),
    )  # fmt: skip


def test_values_of_frames_that_are_solved_and_that_are_not() -> None:
    one = made()
    assert one.status == ["solved", "ignored", "exact", "stopped", "unsolved"]
    assert one.has_attitude.tolist() == [True, False, True, False, False]
    assert np.array_equal(
        one.last_correction_rad, [3e-7, np.nan, 4e-8, np.nan, np.nan], equal_nan=True
    )
    assert one.job_number.tolist() == [7] * 5
    assert one.landmarks.tolist() == [3] * 5
    assert one.reading_sigma.tolist() == [0.25] * 5
    assert one.reading_freedom.tolist() == [np.inf] * 5
    assert one.source_name == ["hand.toml"] * 5
    assert one.image_name == [f"DJI_{k:04}.JPG" for k in range(5)]
    assert made(frame_names=()).image_name == [""] * 5
    assert np.isnan(one.quaternion[[1, 3, 4]]).all() and np.isfinite(one.quaternion[[0, 2]]).all()
    assert np.isnan(one.residual_rms[[1, 3, 4]]).all() and not one.residual_rms[[0, 2]].any()


def test_the_last_correction_is_that_of_frames_that_were_solved() -> None:
    """Of three the largest by its size, also where that is 0; whatever stands in other frames."""
    correction = np.array([[0.0, 0.0, 0.0], [1e-3, 0.0, 0.0], [1e-9, -5e-9, 3e-9]])
    one = history(
        estimate(ANGLES[:3], correction_rad=correction, solved=np.array([True, False, True])),
        sigmas=Sigmas(reading=0.25),
    )
    assert np.array_equal(one.last_correction_rad, [0.0, np.nan, 5e-9], equal_nan=True)


def test_columns_of_these_values() -> None:
    """Infinite degrees of freedom are a missing number: they are no part of the uncertainty."""
    found = table([made(), made()])
    assert found["job"].tolist() == [7] * 10
    assert found["status"].tolist() == ["solved", "ignored", "exact", "stopped", "unsolved"] * 2
    assert np.isnan(found["degrees_of_freedom"]).all()
    assert np.isnan(found["last_correction_rad"][[1, 3, 4]]).all()
    assert found["landmarks"].tolist() == [3] * 10


def test_columns_of_jobs_of_which_one_lacks_a_component() -> None:
    """NaN for the job without; the others keep their values."""
    plain = history(estimate(ANGLES), sigmas=Sigmas(reading=0.25))
    moved = history(estimate(ANGLES), sigmas=Sigmas(reading=0.25, position=2.0))
    found = table([plain, moved])["sigma_position_camera_pitch_deg"]
    assert np.isnan(found[:5]).all()
    assert_close("ratio", found[5:], moved.uncertainty.components["position"][:, 1])
    effect = np.arange(45.0).reshape(5, 9)
    slips = history(estimate(ANGLES, slip_effect_deg=effect), sigmas=Sigmas(reading=0.25))
    found = table([plain, slips])["slip_effect_vehicle_roll_deg"]
    assert np.isnan(found[:5]).all() and found[5:].tolist() == effect[:, 5].tolist()


def test_the_axis_of_figures_is_the_time_where_any_frame_has_one() -> None:
    times = np.array([np.nan, 1.0, np.nan, np.nan, 2.0])
    values, label = made(time_s=times).order_axis
    assert label == "time, s" and np.array_equal(values, times, equal_nan=True)
    values, label = made(time_s=np.full(5, np.nan)).order_axis
    assert (label, values.tolist()) == ("frame", [1.0, 2.0, 3.0, 4.0, 5.0])


def test_other_words_about_a_history_leave_it_as_it_was() -> None:
    one = made()
    other = with_about(one, ABOUT._replace(source="b.toml"))
    assert other.about.source == other.estimate.about.source == "b.toml"
    assert one.about.source == one.estimate.about.source == "hand.toml"
    assert other.estimate.camera_deg is one.estimate.camera_deg


def test_the_effect_of_the_velocity_goes_with_the_axes() -> None:
    """A change of the velocity in space has the same effect by either vertical."""
    rng = np.random.default_rng(3)
    e = estimate(ANGLES)
    by_velocity = rng.normal(size=(5, 3, 3))
    e = estimate(ANGLES, responses=replace(e.responses, attack_by_velocity=by_velocity))
    other = with_vertical(e, "geocentric")
    push = rng.normal(size=3)
    for one in (e, other):
        by_axes = one.position.north_east_down @ push
        effect = np.einsum("fij,fj->fi", one.responses.attack_by_velocity, by_axes)
        expected = np.einsum("fij,fj->fi", by_velocity, e.position.north_east_down @ push)
        assert_close("ratio", effect, expected)
    turn = other.position.north_east_down @ e.position.north_east_down.swapaxes(1, 2)
    assert_close("ratio", np.abs(turn[:, 0, 2]), np.sin(np.radians(0.19)))
    assert other.responses.attack_by_time is e.responses.attack_by_time


@pytest.mark.parametrize("most", [0, 1, 4, 5, 6, 11])
def test_so_many_frames_of_a_long_job_are_searched(
    most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten frames that all misfit, in runs of two blocks of two: the first ones are searched."""
    assert MOST_FRAMES == 1000
    monkeypatch.setattr(long_history, "MOST_FRAMES", most)
    monkeypatch.setattr(long_history, "TOGETHER", 20)
    monkeypatch.setattr(long_history, "AT_ONCE", 8)
    e = estimate(np.repeat(ANGLES, 2, axis=0), noise=1.0)
    layout, options = LandmarkLayout(np.full(10, 4)), HistoryOptions(Sigmas(reading=1e-3))
    job = history_of_long_job(layout, e.take, options)
    for made_of in ([*job], [job.whole]):
        assert all(one.flags.raised["misfit"].all() for one in made_of)
        told = [text != NOT_SEARCHED for one in made_of for text in one.flags.detail["misfit"]]
        assert told == [k < most for k in range(10)]


def test_an_estimate_without_landmarks_has_the_same_frames() -> None:
    one = estimate(ANGLES, POINTS)
    bare = one.without_landmarks()
    assert bare.camera_deg is one.camera_deg and bare.frame_names is one.frame_names
    assert {*vars(one)} - {*vars(bare)} == {
        "landmark", "used", "ignored", "direction", "image", "residual", "partials", "gain",
        "body_gain", "vehicle_by_camera", "responses", "relative_sigma", "outlier",
        "image_by_ray", "test_residual", "fix_sigma", "landmark_sigma", "further", "errors",
        "position_ratio", "other_solution_deg", "velocity_sigma", "exchanged", "late_s",
    }  # fmt: skip


# Histories, tables and pages of many jobs, made together, are those of each job alone


def jobs() -> list[Job]:
    """Films of one camera, two with misread frames; a run that is stopped, and other cameras."""
    made: list[Job] = []
    for seed, (frames, landmarks, noise) in enumerate(
        [(12, 4, 0.003), (1, 4, 0.003), (9, 4, 0.3), (6, 2, 0.003), (5, 4, 0.0), (8, 4, 0.02)]
    ):
        (job,), _ = make(Plan(frames=frames, landmarks=landmarks, seed=seed, noise_in=noise))
        made.append(job)
    read = made[0].readings
    landmark = read.landmark.copy()
    landmark[3, :2] = landmark[3, 1::-1]  # an exchange of two labels
    made.append(replace(made[0], readings=reread(read, landmark=landmark)))
    for name in ("wind_out_of_order", "time_out_of_order", "ignored", "zero_residuals", "vanished"):
        made += vopd.read_deck(DECKS / "regression" / f"{name}.dat")
    return made


@pytest.fixture(scope="module")
def results() -> list[Results]:
    return [run(job) for job in jobs()]


@pytest.fixture(scope="module")
def estimates(results: list[Results]) -> list[Estimate]:
    return [film_estimate(one, "film.dat", k) for k, one in enumerate(results, 1)]


ALL = Sigmas(landmark=50.0, position=30.0, focal_length=0.01, time_s=0.01, velocity=3.0, wind=2.0)


@pytest.mark.parametrize(
    ("sigmas", "rate"),
    [(Sigmas(), None), (ALL, 20.0), (Sigmas(reading=0.01, fiducial=0.0), 1.0), (Sigmas(0.0), None)],
)
def test_histories(estimates: list[Estimate], sigmas: Sigmas, rate: float | None) -> None:
    """All values of the table, to the last bit, and the reading sigmas."""
    two = np.cumsum(estimates[1].used, axis=1) <= 2
    pairs = replace(estimates[1], used=estimates[1].used & two)
    several = [*estimates, *(replace(pairs, focal_length=one) for one in (3.0, 11.0))]
    together = histories(several, HistoryOptions(sigmas, rate))
    for one, given in zip(together, several, strict=True):
        alone = history(given, sigmas=sigmas, max_rate_deg_s=rate)
        assert one.estimate is given
        assert one.uncertainty.reading == alone.uncertainty.reading
        assert list(one.flags.raised) == list(alone.flags.raised)
        values = table([one])
        for name, expected in table([alone]).items():
            np.testing.assert_array_equal(values[name], expected, err_msg=name)


def test_what_is_taken_together(estimates: list[Estimate], monkeypatch: pytest.MonkeyPatch) -> None:
    """Jobs with other numbers of landmarks or names are not, nor too many frames."""
    camera = replace(estimates[1], focal_length=11.0)
    named = replace(estimates[1], frame_names=["a.jpg"] * len(estimates[1].frame))
    some = [*estimates[:4], camera, named, estimates[4]]
    assert sorted(taken_together(some)) == [[0, 1, 2, 4, 6], [3], [5]]
    monkeypatch.setattr(attitude_history, "JOBS_TOGETHER", 13)  # frames
    assert sorted(taken_together(some)) == [[0, 1], [2, 4, 6], [3], [5]]


def test_pages(results: list[Results]) -> None:
    corrected = run(results[0].job, fixes("all"))
    several = [*results, corrected]
    printed = [b"".join(pieces) for pieces in pages_of_jobs(several)]
    assert printed == [b"".join(pages(one)) for one in several]


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_files(estimates: list[Estimate], form: str) -> None:
    """Files of one job and of two; the components of the uncertainty differ between them."""
    made = histories(estimates, HistoryOptions())
    other = histories(estimates[:3], HistoryOptions(ALL))
    several: list[list[History]] = [[one] for one in made] + [made[:2], other, made[3:4] * 2]
    request = FileRequest()
    files = [(some, request, strict) for some in several]
    alone = [FORMATS[form].render(some, request) for some in several]
    assert FORMATS[form].render_files(files) == alone


def test_a_file_that_cannot_be_made_costs_no_other(estimates: list[Estimate]) -> None:
    made = histories(estimates[:2], HistoryOptions())
    files = [([one], FileRequest(), strict) for one in made]
    found = FORMATS["aem"].render_files(files)
    assert_approved([str(one) for one in found])
    assert all(isinstance(one, VopdError) for one in found)


# How much of a job is searched for repairs and second solutions, and what is taken for granted


SEARCH_ANGLES = np.tile([140.0, -60.0, 20.0], (4, 1))
GIVEN = Sigmas(reading=0.01)


def misfits(most: int = MOST_FRAMES) -> History:
    """Four frames of which the last three misfit, and nothing explains them."""
    residual = 5.0 * np.array([1.0, -1, 1, -1, 1, 1, -1, -1]) * np.array([[0.0], [1], [1], [1]])
    image = POINTS + residual.reshape(4, 2, 4).swapaxes(1, 2)
    e = estimate(SEARCH_ANGLES, residual=residual)
    e.__dict__["image"] = image
    return histories_without_jumps([e], GIVEN, most_searched=most)[0]


@pytest.mark.parametrize("most", [0, 1, 2, 3])
def test_no_more_frames_are_searched_than_are_asked_for(most: int) -> None:
    found = misfits(most)
    assert found.flags.raised["misfit"].tolist() == [False, True, True, True]
    expected = ["", *[NOTHING] * most, *[NOT_SEARCHED] * (3 - most)]
    assert found.flags.detail["misfit"] == expected


def test_usually_all_are_searched() -> None:
    assert misfits().flags.detail["misfit"] == ["", NOTHING, NOTHING, NOTHING]


def test_a_reading_sigma_that_is_handed_on_is_the_one_in_force() -> None:
    """Frames are not tested anew, and the degrees of freedom are those of the job."""
    chance = np.array([0.5, 0.0001, np.nan, 0.0011])
    scale = JobReadingSigma(0.125, 7.0, "sample", chance, 0.25)
    (made,) = histories_without_jumps([estimate(SEARCH_ANGLES)], Sigmas(), scale)
    assert made.uncertainty.reading is scale
    assert made.flags.raised["misfit"].tolist() == [False, True, False, False]
    assert made.reading_sigma.tolist() == [0.125] * 4
    assert made.reading_freedom.tolist() == [7.0] * 4
    assert (made.uncertainty.freedom == 7.0).all()


FLAT = np.array([[3.0, 0.05], [-4.0, -0.04], [1.0, -0.05], [2.0, 0.03]])


@pytest.mark.parametrize(("sigma", "flagged"), [(0.5, True), (1e-4, False)])
def test_second_solutions_are_searched_as_far_as_they_are_flagged(
    sigma: float, flagged: bool
) -> None:
    """Landmarks nearly in a plane with the camera: the other side fits to some hundredths, which
    is more than the residuals of nothing, and less than three reading sigmas of .5.
    """
    e = estimate(SEARCH_ANGLES, FLAT)
    (worse, *_) = second_solution_rms(e)
    assert 3e-4 < worse < 1.5
    raised = history(e, sigmas=Sigmas(reading=sigma)).flags.raised["second_solution"]
    assert raised.tolist() == [flagged] * 4


def test_a_second_solution_that_fits_far_better_is_flagged() -> None:
    """Residuals of 1 here, and of some hundredths on the other side."""
    e = estimate(SEARCH_ANGLES, FLAT, residual=np.ones((4, 8)))
    raised = history(e, sigmas=Sigmas(reading=1e-4)).flags.raised["second_solution"]
    assert raised.tolist() == [True] * 4


# The least reading sigma, which jobs are joined, parts of a covariance, and decimals of tables


OF_KIND_ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))


@pytest.mark.parametrize(
    ("spread", "floor", "least", "repeated"),
    [
        (0.3, 0.1, 0.3, True), (0.1, 0.3, 0.3, False), (0.2, 0.2, 0.2, False),
        (0.2000001, 0.2, 0.2000001, True), (np.nan, 0.2, 0.2, False), (0.2, np.nan, 0.2, True),
        (np.nan, np.nan, 1.04e-8, False), (0.0, 0.0, 1.04e-8, False), (2e-8, 0.0, 2e-8, True),
        (0.0, 2e-8, 2e-8, False), (1e-9, 0.0, 1.04e-8, True),
    ],
)  # fmt: skip
def test_the_least_reading_sigma(spread: float, floor: float, least: float, repeated: bool) -> None:
    """The larger of spread and resolution, and at least 1e-9 of the focal length, 10.4; where
    both are alike it is by resolution.
    """
    other = estimate(OF_KIND_ANGLES, reading_spread=5.0, reading_floor=6.0)
    one = estimate(OF_KIND_ANGLES, reading_spread=spread, reading_floor=floor)
    sigma, by_repeated = least_sigmas([other, one])
    assert_close("ratio", sigma / [6.0, least], [1.0, 1.0])
    assert by_repeated.tolist() == [False, repeated]


def job(**changes: Any) -> Estimate:
    """A job without names, as decks have it."""
    return estimate(OF_KIND_ANGLES, landmark_names={}, frame_names=(), **changes)


@pytest.mark.parametrize(
    ("changes", "alike"),
    [
        ({}, True), ({"fiducial_sigma": 0.2}, True), ({"reading_spread": 9.0}, True),
        ({"image": POINTS[:3]}, False), ({"focal_length": 10.5}, True),
        ({"units": Units("ft", "in", 25.4, "mm", 1.0)}, False),
        ({"about": ABOUT._replace(words=replace(ABOUT.words, reading="a point"))}, False),
        ({"about": ABOUT._replace(source="other.toml", job=2)}, True),
        ({"stated": StatedSigmas(focal_length=0.1)}, False),
        ({"stated": StatedSigmas(position=(0.0, 0.0, 1.0))}, False),
        ({"fiducial_sigma": 0.0}, False), ({"slip_effect_deg": np.zeros((2, 9))}, False),
        ({"landmark_names": {7: "church"}}, False), ({"frame_names": ("a", "b")}, False),
        ({"gimbal_deg": np.zeros((2, 3))}, False), ({"grid": "centre"}, False),
    ],
)  # fmt: skip
def test_jobs_that_are_joined_are_of_one_kind(changes: dict[str, Any], alike: bool) -> None:
    """What a whole job has one of, and what is asked of the first of several, is the same."""
    usual = {"landmark_names": {}, "frame_names": (), "fiducial_sigma": 0.1}
    pair = [job(fiducial_sigma=0.1), estimate(OF_KIND_ANGLES, **(usual | changes))]
    assert sorted(taken_together(pair)) == ([[0, 1]] if alike else [[0], [1]])


@pytest.mark.parametrize(
    ("name", "value"), [("vertical", "geocentric"), ("to_own_m", np.zeros((2, 2)))]
)
def test_jobs_with_other_positions_are_not_joined(name: str, value: Any) -> None:
    one = job()
    other = replace(one, position=replace(one.position, **{name: value}))
    assert sorted(taken_together([one, other])) == [[0], [1]]


def made_of_kind(**changes: Any) -> History:
    return history(estimate(OF_KIND_ANGLES, **changes))


def test_the_independent_part_of_a_covariance() -> None:
    """The whole less the common part; infinite where the whole is, whatever the common part."""
    whole = np.full((2, 3, 3), 5.0)
    common = np.full((2, 3, 3), 2.0)
    whole[0, 0, 0] = common[0, 0, 0] = np.inf
    whole[0, 1, 2], common[0, 2, 1] = -np.inf, -1.0
    uncertainty = replace(
        made_of_kind().uncertainty, covariance_deg2=whole, covariance_common_deg2=common
    )
    expected = np.full((2, 3, 3), 3.0)
    expected[0, 0, 0], expected[0, 1, 2], expected[0, 2, 1] = np.inf, -np.inf, 6.0
    assert uncertainty.covariance_independent_deg2.tolist() == expected.tolist()


@pytest.mark.parametrize(
    ("sources", "said"),
    [
        (["a.toml"], "a.toml"), (["b.toml", "a.toml"], "b.toml, a.toml"),
        (["b", "a", "b", "c", "a"], "b, a, c"),
    ],
)  # fmt: skip
def test_every_source_of_a_file_is_named_once(sources: list[str], said: str) -> None:
    several = [made_of_kind(about=ABOUT._replace(source=one)) for one in sources]
    assert conventions(several)["flight"] == said


def test_decimals_of_every_column() -> None:
    """Degrees and factors have 6 decimals, but of positions 8; lengths 4; no decimals are words,
    counts or numbers with an exponent.
    """
    known = [*FIXED, *INTERVALS]
    by_decimals = {
        None: ["{source}", "job", "frame", "status", "landmarks", "last_correction_rad", "flags"],
        1: ["degrees_of_freedom"],
        4: [
            "airspeed_{length}_s", "vehicle_east_{length}", "vehicle_north_{length}",
            "vehicle_up_{length}", "altitude_{length}", "condition",
        ],
        8: ["latitude_deg", "longitude_deg", "residual_rms_{image}", "reading_sigma_{image}"],
        10: [f"quaternion_{one}" for one in "wxyz"],
    }  # fmt: skip
    listed = [name for names in by_decimals.values() for name in names]
    by_decimals[6] = [one.name for one in known if one.name not in listed]
    for decimals, names in by_decimals.items():
        assert [one.name for one in known if one.decimals == decimals] == names
    assert len(by_decimals[6]) == 1 + 9 + 1 + 10 + 1
    sixes = {one.unit for one in known if one.decimals == 6 and one.name != "misfit_chance"}
    assert sixes == {"s", "deg", ""}
