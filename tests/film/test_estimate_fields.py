"""The estimate of a deck's job, field by field; of many jobs together; its words."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import DECKS
from tests.kit.jobs import case, film, reread, without
from tests.kit.spherical_film import uneven
from tests.tolerances import assert_close
from vopd import film as estimates
from vopd.errata import NO_FIXES, Fixes, fixes
from vopd.estimate import FrameStatus, Units
from vopd.film import DECK_WORDS, estimates_of_jobs, film_estimate
from vopd.job import Job
from vopd.program.vopd import run
from vopd.results import Outcome, SolvedJob
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

MADE = {  # the fixes in force, their names, and what down is
    "none": NO_FIXES,
    "some": fixes("feet-per-km", "restart"),
    "earth": fixes("earth"),
    "all": fixes("all", ellipsoid="clarke1866"),
}


@pytest.mark.parametrize("name", MADE)
def test_what_it_says_about_itself(name: str) -> None:
    """Column 1 of the title card is the printer's carriage control and no part of the title."""
    chosen = MADE[name]
    about = film_estimate(run(case(1), chosen), "flight.dat", 7).about
    assert about.title == case(1).title[1:].strip() and not about.title.startswith("1")
    assert (about.source, about.job) == ("flight.dat", 7)
    assert_approved((about.fixes, about.down))
    assert about.words is DECK_WORDS and about.epoch is None


def test_the_title_is_without_carriage_control_and_blanks() -> None:
    titled = replace(film(1), title="1  1 BALLOON 12  ".ljust(80))
    assert film_estimate(run(titled)).about.title == "1 BALLOON 12"


def test_fields_that_are_those_of_the_results() -> None:
    """Of frames that are solved and one that is dropped."""
    results = run(without(film(3), 2))
    one = film_estimate(results)
    same = {
        "frame": "frame", "time_s": "time_s", "displacement": "vehicle_ft",
        "camera_deg": "camera_deg", "vehicle_deg": "vehicle_deg", "airspeed": "airspeed_ft_s",
        "landmark": "landmark", "used": "used", "ignored": "ignored", "direction": "direction",
        "solved": "solved", "converged": "converged", "correction_rad": "correction_rad",
    }  # fmt: skip
    for mine, theirs in same.items():
        np.testing.assert_array_equal(getattr(one, mine), getattr(results, theirs), mine)
    for k, theirs in enumerate(("alpha_deg", "beta_deg", "eta_deg")):
        np.testing.assert_array_equal(one.attack_deg[:, k], getattr(results, theirs))
    assert one.position.altitude.tolist() == [120000.0, 119950.0, 119900.0]  # of group 7
    names = [FrameStatus(status).name for status in one.status]
    assert names == ["SOLVED", "IGNORED", "SOLVED"]
    assert one.units == Units() and one.focal_length == results.job.camera.focal_length_mm
    assert (one.relative_sigma == 1.0).all() and one.relative_sigma.shape == one.used.shape


def test_each_of_several_jobs_has_its_own() -> None:
    """Of jobs made together: source, number, title, camera and mounting."""
    camera = film(2).camera
    other = replace(camera, multiplier=np.array([1.0, -1.0, 0.5]), focal_length_mm=12.5)
    jobs = [film(2), replace(film(3), camera=other, title="1SECOND".ljust(80))]
    solved = [SolvedJob("a.dat", 1, run(jobs[0]), ()), SolvedJob("b.dat", 2, run(jobs[1]), ())]
    (first,), (second,) = estimates_of_jobs(solved)
    assert (first[1].about.label, second[1].about.label) == (
        "a.dat, job 1",
        "b.dat, job 2",
    )
    assert second[1].about.title == "SECOND"
    assert second[1].focal_length == 12.5
    assert first[0].tolist() == [0, 1] and second[0].tolist() == [0, 1, 2]
    for made, job in ((first, jobs[0]), (second, jobs[1])):
        assert (made[1].vehicle_by_camera == np.diag(job.camera.multiplier)).all()
        alone = film_estimate(run(job))
        assert made[1].slip_effect_deg is not None and alone.slip_effect_deg is not None
        np.testing.assert_array_equal(made[1].slip_effect_deg, alone.slip_effect_deg)


ENDS = {  # how a frame ended in the run, and what the estimate says of it
    "SOLVED": "SOLVED",
    "DROPPED": "IGNORED",
    "EXACT": "EXACT",
    "EXACT_LATE": "EXACT",
    "STOPPED": "STOPPED",
}


def test_how_every_frame_ended() -> None:
    results = run(film(len(Outcome)))
    ended = replace(results, outcome=np.array(list(Outcome)))
    status = [FrameStatus(one).name for one in film_estimate(ended).status]
    assert status == [ENDS[one.name] for one in Outcome] and len(Outcome) == len(ENDS)


def test_without_a_deck_it_is_the_first_job_of_no_deck() -> None:
    about = film_estimate(run(film(1))).about
    assert (about.source, about.job) == ("", 1)


def spread(job: Job, by_in: float) -> Job:
    """The readings of landmarks at 0 and by_in either side of the middle of the three."""
    landmark = np.repeat(job.readings.landmark_in[:, :, 1:2], 3, axis=2)
    landmark = landmark + np.array([-by_in, 0.0, by_in])[:, None]
    return replace(job, readings=reread(job.readings, landmark_in=landmark))


@pytest.mark.parametrize("whole_in", [None, 0.002])
def test_the_noise_is_that_of_the_whole_job(whole_in: float | None) -> None:
    """Readings d apart have a variance of d squared, and their mean a third of it."""
    whole = None if whole_in is None else spread(film(4), whole_in)
    one = film_estimate(run(spread(film(2), 0.001)), "a.dat", 1, whole)
    expected = (whole_in or 0.001) / np.sqrt(3.0) * 0.713816400205
    assert_close("film length", one.reading_spread, expected)
    assert_close("film length", one.reading_floor, 0.001 / np.sqrt(12.0) * 0.713816400205)


def test_blocks_of_one_job_have_the_noise_and_the_name_of_the_job() -> None:
    """One frame of very many landmarks is apart from frames of few."""
    job = uneven([3000, 3, 3])
    solved = run(job)
    (blocks,) = estimates_of_jobs([SolvedJob("a.dat", 3, solved)])
    alone = film_estimate(solved, "a.dat", 3)
    assert len(blocks) == 2
    for _, block in blocks:
        assert block.about == alone.about
        for name in ("reading_spread", "reading_floor", "fiducial_sigma", "focal_length"):
            assert getattr(block, name) == getattr(alone, name)


def test_jobs_are_taken_together_up_to_a_number_of_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of five jobs with 2, 2, 3, 1 and 1 frames, at 4 frames: the first two, two more, the last."""
    taken: list[list[int]] = []
    real = estimates.slip_effects_deg

    def counted(results: Any, determined: Any) -> Any:
        taken.append([len(one.frame) for one in results])
        return real(results, determined)

    monkeypatch.setattr(estimates, "slip_effects_deg", counted)
    monkeypatch.setattr(estimates, "TOGETHER", 4)
    made = estimates_of_jobs([SolvedJob("a.dat", n, run(film(n))) for n in (2, 2, 3, 1, 1)])
    assert taken == [[2, 2], [3, 1], [1]]
    assert [block.about.job for ((_, block),) in made] == [2, 2, 3, 1, 1]


# Many jobs together


def different_jobs() -> list[Job]:
    """Jobs with different cameras, origins, tables and numbers of frames and landmarks."""
    jobs: list[Job] = []
    for seed, (frames, landmarks) in enumerate([(3, 4), (1, 4), (2, 2), (5, 4), (1, 2), (4, 3)]):
        (job,), _ = make(Plan(frames=frames, landmarks=landmarks, seed=seed))
        path, camera = job.trajectory, job.camera
        shifted = replace(path, origin_longitude_deg=path.origin_longitude_deg + 0.01 * seed)
        mounted = replace(
            camera,
            multiplier=camera.multiplier * [1.0, -1.0, 1.0],
            focal_length_mm=camera.focal_length_mm + 0.01 * seed,
        )
        jobs.append(replace(job, trajectory=shifted, camera=mounted))
    for name in ("wind_out_of_order", "trajectory_out_of_order", "ignored", "zero_residuals"):
        jobs += vopd.read_deck(DECKS / "regression" / f"{name}.dat")
    return jobs


@pytest.mark.parametrize("chosen", [fixes(), fixes("earth")])
def test_together_is_as_alone(chosen: Fixes) -> None:
    solved = [run(job, chosen) for job in different_jobs()]
    together = estimates_of_jobs([SolvedJob("deck", 1, one) for one in solved])
    assert len(together) == len(solved) >= 10
    for results, ((_, block),) in zip(solved, together, strict=True):
        alone = film_estimate(results, "deck")
        for field in fields(alone):
            same(getattr(block, field.name), getattr(alone, field.name))


def same(one: Any, other: Any) -> None:
    if isinstance(other, np.ndarray):
        assert one.shape == other.shape
        np.testing.assert_array_equal(one, other)
    elif isinstance(other, dict):
        same(tuple(one.values()), tuple(other.values()))
    elif isinstance(other, tuple):
        for mine, theirs in zip(one, other, strict=True):
            same(mine, theirs)
    elif isinstance(other, float):
        assert one == other or (np.isnan(one) and np.isnan(other))
    elif callable(other):  # makes the scene of the job
        assert callable(one)
    else:
        assert one == other


# Words


SENTENCES = (
    "source",
    "no_fixes",
    "surface",
    "centre",
    "landmark",
    "reading",
    "vertical",
    "own_position",
)


@pytest.mark.parametrize("name", SENTENCES)
def test_a_sentence(name: str) -> None:
    assert_approved(getattr(DECK_WORDS, name))


def test_columns_flags_and_conventions() -> None:
    """Meaning of every column; meaning and advice of every flag; what angles refer to."""
    assert_approved(DECK_WORDS.columns)
    assert_approved(DECK_WORDS.flags)
    assert_approved(DECK_WORDS.conventions)
