"""Jobs that are solved together: what each is given, and the warnings and errors that come back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import film, turned
from vopd.errata import Fix, Fixes, fixes
from vopd.findings import Finding, InputError
from vopd.job import Job
from vopd.pipeline import ReadJob, SolveOptions, solve_film, stop_error
from vopd.program.vopd import run
from vopd.results import SolvedJob

BY_PAIR = SolveOptions(initial="closed-form")
COMPARED = SolveOptions(initial="closed-form", compare_initial=True)
OPTIONS = ("from the deck", "by pairs", "compared")
BLANK = Finding("blanks read as zeros", "a.dat", card=3, severity="warning")


def solved(jobs: Sequence[ReadJob], options: SolveOptions = BY_PAIR) -> list[SolvedJob]:
    found = solve_film(jobs, options)
    assert all(isinstance(one, SolvedJob) for one in found)
    return [one for one in found if isinstance(one, SolvedJob)]


def outside_wind(job: Job) -> Job:
    """The frames are from 120000 ft downward, the wind ends below them."""
    return replace(job, wind=replace(job.wind, altitude_ft=np.array([0.0, 1e5])))


def test_what_is_done_where_nothing_is_asked_for() -> None:
    none = SolveOptions()
    assert (none.fixes, none.initial) == (Fixes(frozenset()), "deck")
    assert none.compare_initial is False and none.limits_1974 is False
    assert ReadJob("a.dat", 1, film(1))[3:] == ((), None)


@pytest.mark.parametrize("initial", ["deck", "closed-form"])
def test_fixes_reach_every_job(initial: Any) -> None:
    chosen = SolveOptions(fixes("earth", "restart"), initial, compare_initial=True)
    jobs = [ReadJob("a.dat", 1, film(2)), ReadJob("b.dat", 4, film(1))]
    for one in solved(jobs, chosen):
        assert one.results.fixes.chosen == {Fix.EARTH, Fix.RESTART}


@pytest.mark.parametrize("options", [SolveOptions(), BY_PAIR, COMPARED], ids=OPTIONS)
def test_given_angles_are_where_a_frame_starts(options: SolveOptions) -> None:
    """Of two jobs the first has angles to start from, and the other its deck's or a pair's."""
    given = np.array([[141.0, -79.0, 61.0], [139.0, -81.0, 59.0]])
    jobs = [ReadJob("a.dat", 1, film(2), start_deg=given), ReadJob("a.dat", 2, film(1))]
    first, second = solved(jobs, options)
    assert first.results.start_deg.tolist() == given.tolist()
    by_deck = second.results.start_deg.tolist() == [[140.0, -80.0, 60.0]]
    assert by_deck == (options.initial == "deck")


def test_each_job_starts_from_its_own_pairs() -> None:
    """Both decks begin far off; the closed form is near the truth in every frame."""
    truths = [
        np.array([[140.0, -80.0, 60.0], [141.0, -79.0, 61.0]]),
        np.array([[20.0, -70.0, 200.0]]),
    ]
    jobs = [ReadJob("a.dat", k, turned(truth, np.zeros(3))) for k, truth in enumerate(truths, 1)]
    for one, truth in zip(solved(jobs), truths, strict=True):
        assert one.results.start_deg.round().tolist() == truth.tolist()


def test_warnings_are_those_of_the_cards_then_of_the_frames() -> None:
    jobs = [
        ReadJob("a.dat", 1, outside_wind(film(2)), (BLANK,)),
        ReadJob("a.dat", 2, film(1)),
        ReadJob("b.dat", 1, outside_wind(film(1))),
    ]
    text = "outside the wind table; values are extrapolated"
    wind = [
        Finding(f"{which}: {text}", deck, job=1, group=4, severity="warning")
        for which, deck in (("frames 1-2", "a.dat"), ("frame 1", "b.dat"))
    ]
    for options in (SolveOptions(), BY_PAIR):
        found = solved(jobs, options)
        assert [(one.deck, one.number) for one in found] == [
            ("a.dat", 1),
            ("a.dat", 2),
            ("b.dat", 1),
        ]
        assert [one.findings for one in found] == [(BLANK, wind[0]), (), (wind[1],)]


def undefined(cards: bool) -> Job:
    """Landmarks 13 and 15 are not in group 9; where they are first read is known or not."""
    job = film(2)
    known = replace(job.landmarks, number=np.array([11, 12, 93, 14, 95]))
    where = {
        n: Finding("", "a.dat", card=100 + n, job=7, field="landmark number") for n in (13, 15)
    }
    readings = replace(job.readings, first_card=where if cards else {})
    return replace(job, landmarks=known, readings=readings)


@pytest.mark.parametrize("options", [SolveOptions(), BY_PAIR, COMPARED], ids=OPTIONS)
def test_an_undefined_landmark_is_an_error_at_its_card(options: SolveOptions) -> None:
    jobs = [undefined(True), film(1), undefined(False)]
    found = solve_film([ReadJob("a.dat", k, job) for k, job in enumerate(jobs, 1)], options)
    first, good, last = found
    text = "frame 1: landmark 13 is not defined in group 9"
    assert isinstance(first, InputError) and isinstance(last, InputError)
    assert first.finding == Finding(text, "a.dat", card=113, job=7, field="landmark number")
    assert last.finding == Finding(text, "a.dat")
    assert isinstance(good, SolvedJob) and good.number == 2


STOPS = {  # a table whose second value does not exceed the first, and its name and group
    "wind": ("altitude_ft", "altitudes", 4),
    "trajectory": ("time_s", "times", 7),
    "clock": ("frame", "frame numbers", 6),
    "camera": ("lens_radius_mm", "radial distances", 1),
}


@pytest.mark.parametrize("part", STOPS)
def test_a_table_out_of_order_ends_the_deck_with_an_error(part: str) -> None:
    name, table, group = STOPS[part]
    job = film(3)
    values = getattr(getattr(job, part), name).copy()
    values[1] = values[0]
    stopped = run(replace(job, **{part: replace(getattr(job, part), **{name: values})}))
    error = stop_error(SolvedJob("a.dat", 3, stopped))
    message = f"{table} out of order at position 2: FTLUP stops the run"
    assert error is not None
    assert error.finding == Finding(message, "a.dat", job=3, group=group)
    assert stop_error(SolvedJob("a.dat", 3, run(job))) is None
