"""Decks read and jobs solved, in turn and together: numbers, warnings, errors, ends of sources."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.cards import CardLines, landmarks_again, punch, two_frames
from tests.kit.command import CASE_1, DECKS
from tests.kit.jobs import film, reread, turned
from vopd import pipeline
from vopd.errata import Fix, Fixes, fixes
from vopd.findings import Finding, InputError, VopdError
from vopd.job import Deck, Job
from vopd.pipeline import (
    ReadJob,
    SolveOptions,
    check_project,
    read_decks,
    solve_decks,
    solve_film,
    solve_jobs,
    solve_sources,
    stop_error,
)
from vopd.program.vopd import run
from vopd.results import SolvedJob, SourceEnd

STACKED, SINGLE = (str(DECKS / "appendix_h" / name) for name in ("cases_1_2_3.dat", "case1.dat"))
WIND_DECK = str(DECKS / "regression" / "wind_out_of_order.dat")


def written(folder: Path, name: str, cards: CardLines) -> str:
    path = folder / name
    path.write_text("\n".join(cards) + "\n")
    return str(path)


def outline(items: object) -> list[tuple[str, object]]:
    """Each item as its deck and the job's number, or the error's text (None at a good end)."""
    found: list[tuple[str, object]] = []
    for item in items:  # type: ignore[attr-defined]
        if isinstance(item, SourceEnd):
            found.append((item.source, item.error and str(item.error)))
        else:
            assert isinstance(item, ReadJob | SolvedJob)
            found.append((item.source, item.number))
    return found


def test_jobs_are_numbered_in_each_deck() -> None:
    found = outline(read_decks([STACKED, SINGLE]))
    assert found == [
        (STACKED, 1), (STACKED, 2), (STACKED, 3), (STACKED, None), (SINGLE, 1), (SINGLE, None),
    ]  # fmt: skip
    assert outline(read_decks([])) == []


def test_they_are_solved_in_the_same_order() -> None:
    given = [STACKED, SINGLE]
    assert outline(solve_jobs(read_decks(given), SolveOptions())) == outline(read_decks(given))


def test_a_deck_may_be_elsewhere_than_its_name() -> None:
    found = list(read_decks(["film"], locations={"film": STACKED}))
    assert [item.source for item in found] == 4 * ["film"]
    assert [len(item.job.readings.frame) for item in found if isinstance(item, ReadJob)] == [
        1,
        1,
        1,
    ]


def test_an_error_ends_its_deck_and_not_the_next(tmp_path: Path) -> None:
    """The second job's group 9 cannot be read; there is no third file."""
    cards = landmarks_again(two_frames())
    second = 85 + 5  # the deck's cards, then group 5 and more of the second job
    punch(second, 1, "        xx")(cards)
    broken, none = written(tmp_path, "broken.dat", cards), str(tmp_path / "none.dat")
    found = outline(read_decks([broken, none, SINGLE]))
    assert found[0] == (broken, 1) and found[3:] == [(SINGLE, 1), (SINGLE, None)]
    (deck, error), (missing, why) = found[1:3]
    assert deck == broken and "card 90" in str(error)
    assert missing == none and "No such file" in str(why)


def test_a_table_out_of_order_ends_the_deck_after_its_job() -> None:
    found = outline(solve_jobs(read_decks([WIND_DECK, SINGLE]), SolveOptions()))
    numbers = [number for deck, number in found if deck == WIND_DECK]
    assert numbers[0] == 1 and isinstance(numbers[-1], str)
    assert found[-2:] == [(SINGLE, 1), (SINGLE, None)]


@pytest.mark.parametrize(("card", "job"), [(35, 1), (90, 2)])
def test_warnings_stay_with_the_job_they_are_about(tmp_path: Path, card: int, job: int) -> None:
    """A time with a blank in it, which is read as a zero, 70.0 s: a warning."""
    cards = landmarks_again(two_frames())
    clean = written(tmp_path, "clean.dat", cards)
    assert [item.findings for item in read_decks([clean])] == [(), (), ()]
    punch(card, 1, "       7 0")(cards)
    name = written(tmp_path, "deck.dat", cards)
    first, second, end = (item.findings for item in read_decks([name]))
    about, other = (first, second) if job == 1 else (second, first)
    assert [finding.card for finding in about] == [card]
    assert other == end == ()


# Jobs in turn


ELSEWHERE = {"a": str(CASE_1), "b": str(CASE_1)}


def items(*outline: tuple[str, Any]) -> Iterable[ReadJob | SourceEnd]:
    """Jobs that solve to a result, an error or a stopped run, and ends of decks."""
    for number, (deck, what) in enumerate(outline):
        if what == "end":
            yield SourceEnd(deck, None, (Finding(f"late {number}"),))
        elif isinstance(what, VopdError) and deck.startswith("lost"):
            yield SourceEnd(deck, what)
        else:
            yield ReadJob(deck, number, what, ())


def test_after_an_error_the_rest_of_that_deck_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """One error a deck, at its end; the next decks are passed on whole."""
    (job,) = vopd.read_deck(CASE_1)
    error, stopped = VopdError("undefined"), VopdError("out of order")

    def solve_film(jobs: list[ReadJob], _: SolveOptions) -> list[Any]:
        results: Any = SimpleNamespace(stop=None)
        return [
            error if one.number in (1, 2) else SolvedJob(one.source, one.number, results)
            for one in jobs
        ]

    monkeypatch.setattr(pipeline, "solve_film", solve_film)
    monkeypatch.setattr(
        pipeline, "stop_error", lambda one: stopped if one.number in (7, 8) else None
    )
    outline = [
        ("a", job), ("a", job), ("a", job), ("a", "end"), ("b", job), ("b", "end"),
        ("c", job), ("c", job), ("c", job), ("c", "end"), ("lost", error), ("d", job), ("d", "end"),
    ]  # fmt: skip
    found = [*solve_jobs(items(*outline), SolveOptions())]
    told = [
        (one.source, one.number)
        if isinstance(one, SolvedJob)
        else (one.source, str(one.error), len(one.findings))
        for one in found
    ]
    assert told == [
        ("a", 0), ("a", "undefined", 0), ("b", 4), ("b", "None", 1), ("c", 6), ("c", 7),
        ("c", "out of order", 0), ("lost", "undefined", 0), ("d", 11), ("d", "None", 1),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("frames", "films"),
    [([3999, 1], [[3999, 1]]), ([4000, 1], [[4000], [1]]), ([2500, 1499, 1, 5], [[2500, 1499, 1],
                                                                            [5]]),
     ([5000, 3999], [[5000], [3999]])],
)  # fmt: skip
def test_jobs_are_gathered_until_they_have_4000_frames(
    frames: list[int], films: list[list[int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sixteen landmarks of a job's table count as a frame."""
    counts: list[list[int]] = []

    def solve_film(jobs: list[ReadJob], _: SolveOptions) -> list[SolvedJob]:
        counts.append([len(one.job.readings.frame) for one in jobs])
        results: Any = SimpleNamespace(stop=None)
        return [SolvedJob(one.source, one.number, results) for one in jobs]

    monkeypatch.setattr(pipeline, "solve_film", solve_film)
    for landmarks in (15, 16):
        counts.clear()
        some: list[Any] = [
            SimpleNamespace(
                readings=SimpleNamespace(frame=np.zeros(count - landmarks // 16)),
                landmarks=SimpleNamespace(number=np.zeros(landmarks)),
            )
            for count in frames
        ]
        read = [ReadJob("a", k, one, ()) for k, one in enumerate(some)]
        assert len([*solve_jobs(read, SolveOptions())]) == len(frames)
        least = landmarks // 16
        told = [[one + least for one in film] for film in counts if film]
        assert told == films


def test_warnings_of_the_deck_come_first_and_errors_are_raised() -> None:
    """A landmark that is not defined; a table out of order does not raise, nor what follows it."""
    (job,) = vopd.read_deck(CASE_1)
    warning = Finding("odd", severity="warning")
    assert vopd.run(Deck((job, job), "a", (warning,))).findings == (warning,)
    assert vopd.run(Deck((job,), "a")).findings == ()
    missing = reread(job.readings, landmark=job.readings.landmark + 40)
    with refused(InputError):
        vopd.run([job, replace(job, readings=missing)])
    stops = vopd.read_deck(DECKS / "regression" / "wind_out_of_order.dat")
    run = vopd.run([*stops, replace(job, readings=missing)])
    assert len(run) == len(stops) and run[-1].stop is not None
    assert not vopd.run([job]).jobs[0].results.fixes
    assert Fix.RESTART in vopd.run([job], fixes("restart"))[0].fixes


def test_the_findings_of_each_job_and_deck_are_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of each job, and behind the last job those of the deck's end, with its error."""
    own, late = Finding("own", severity="warning"), Finding("late", severity="warning")
    error = VopdError("broken")
    (job,) = vopd.read_deck(CASE_1)

    def jobs(_: object, name: str, report: Any, **__: object) -> Iterator[Job]:
        if name == "a":
            yield job
        report(own)
        yield job
        if name == "a":
            report(late)
            raise error

    monkeypatch.setattr("vopd.check.checked_jobs", jobs)
    found = [*read_decks(["a", "b"], locations=dict.fromkeys("ab", str(CASE_1)))]
    assert [one.findings for one in found] == [(), (own,), (late,), (own,), ()]
    assert [one.source for one in found] == ["a", "a", "a", "b", "b"]
    assert [one.error for one in found if isinstance(one, SourceEnd)] == [error, None]
    assert [one.number for one in found if isinstance(one, ReadJob)] == [1, 2, 1]


# Jobs solved together


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
    for options in (SolveOptions(), BY_PAIR):
        found = solved(jobs, options)
        assert [(one.source, one.number) for one in found] == [
            ("a.dat", 1),
            ("a.dat", 2),
            ("b.dat", 1),
        ]
        (blank, first), none, (last,) = (one.findings for one in found)
        assert (blank, none) == (BLANK, ())
        for wind, deck in ((first, "a.dat"), (last, "b.dat")):
            assert replace(wind, message="") == Finding(
                "", deck, job=1, group=4, severity="warning"
            )
            assert_approved(wind.message)


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
    assert isinstance(first, InputError) and isinstance(last, InputError)
    text = first.finding.message
    assert_approved(text, parts=["frame 1", "landmark 13"])
    assert first.finding == Finding(text, "a.dat", card=113, job=7, field="landmark number")
    assert last.finding == Finding(text, "a.dat")
    assert isinstance(good, SolvedJob) and good.number == 2


STOPS = {  # a table whose second value does not exceed the first, and its group
    "wind": ("altitude_ft", 4),
    "trajectory": ("time_s", 7),
    "clock": ("frame", 6),
    "camera": ("lens_radius_mm", 1),
}


@pytest.mark.parametrize("part", STOPS)
def test_a_table_out_of_order_ends_the_deck_with_an_error(part: str) -> None:
    name, group = STOPS[part]
    job = film(3)
    values = getattr(getattr(job, part), name).copy()
    values[1] = values[0]
    stopped = run(replace(job, **{part: replace(getattr(job, part), **{name: values})}))
    error = stop_error(SolvedJob("a.dat", 3, stopped))
    assert error is not None
    assert replace(error.finding, message="") == Finding("", "a.dat", job=3, group=group)
    assert_approved(error.finding.message, parts=["position 2"])
    assert stop_error(SolvedJob("a.dat", 3, run(job))) is None


# Options, locations and flights: runs whose answers change with each


def test_options_of_decks_change_their_runs() -> None:
    """As `vopd.run` solves the same jobs; without an option the answer is another."""
    where = {"a": str(CASE_1), "b": STACKED}
    closed = SolveOptions(fixes("restart"), "closed-form", True)
    for solve in (solve_decks, solve_sources):
        found = [*solve(["a", "b", "a"], closed, where)]
        ends = [one.source for one in found if isinstance(one, SourceEnd)]
        solved = [one for one in found if isinstance(one, SolvedJob)]
        assert ends == ["a", "b", "a"]
        assert [(one.source, one.number) for one in solved] == [
            ("a", 1), ("b", 1), ("b", 2), ("b", 3), ("a", 1),
        ]  # fmt: skip
        jobs = vopd.read_deck(STACKED)
        expected = vopd.run(jobs, fixes("restart"), initial="closed-form", compare_initial=True)
        for one, other in zip(solved[1:4], expected, strict=True):
            assert one.results.start_deg.tolist() == other.start_deg.tolist()
            assert one.results.fixes == other.fixes == fixes("restart")
        assert expected.start_deg.tolist() != vopd.run(jobs).start_deg.tolist()


@pytest.mark.parametrize("shape", [(2, 3), (3, 2), (9,), (3, 3, 1), (4, 3)])
def test_starts_have_a_row_for_every_frame(shape: tuple[int, ...]) -> None:
    with refused(VopdError):
        vopd.run(vopd.read_deck(STACKED), start_deg=np.zeros(shape))


def test_starts_of_all_jobs_one_after_the_other() -> None:
    jobs = vopd.read_deck(STACKED)
    start = vopd.run(jobs).camera_deg + np.arange(9.0).reshape(3, 3) / 30.0
    assert vopd.run(jobs, start_deg=start).start_deg.tolist() == start.tolist()


def test_flights_among_decks_keep_their_order_and_locations() -> None:
    hill = str(DECKS.parent / "examples" / "hill" / "flight.toml")
    where = {"a": str(CASE_1), "F.TOML": hill}
    found = [*solve_sources(["F.TOML", "a", "bad.toml", "a"], SolveOptions(), where)]
    assert [type(one).__name__ for one in found] == [
        "FlightResult", "SourceEnd", "SolvedJob", "SourceEnd", "SourceEnd",
        "SolvedJob", "SourceEnd",
    ]  # fmt: skip
    ends = [one for one in found if isinstance(one, SourceEnd)]
    assert [one.source for one in ends] == ["F.TOML", "a", "bad.toml", "a"]
    assert [one.error is None for one in ends] == [True, True, False, True]


def test_a_project_is_checked_under_its_name(tmp_path: Path) -> None:
    (found,) = check_project(str(tmp_path / "none.toml"))
    assert "none.toml" in str(found) and found.severity == "error"
