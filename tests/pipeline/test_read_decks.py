"""Decks one after the other: every job with its number and its warnings, and the end of each."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.cards import CardLines, landmarks_again, punch, two_frames
from tests.kit.command import DECKS
from vopd.pipeline import ReadJob, SolveOptions, read_decks, solve_jobs
from vopd.results import DeckEnd, SolvedJob

STACKED, CASE_1 = (str(DECKS / "appendix_h" / name) for name in ("cases_1_2_3.dat", "case1.dat"))
WIND_DECK = str(DECKS / "regression" / "wind_out_of_order.dat")


def written(folder: Path, name: str, cards: CardLines) -> str:
    path = folder / name
    path.write_text("\n".join(cards) + "\n")
    return str(path)


def outline(items: object) -> list[tuple[str, object]]:
    """Each item as its deck and the job's number, or the error's text (None at a good end)."""
    found: list[tuple[str, object]] = []
    for item in items:  # type: ignore[attr-defined]
        if isinstance(item, DeckEnd):
            found.append((item.deck, item.error and str(item.error)))
        else:
            assert isinstance(item, ReadJob | SolvedJob)
            found.append((item.deck, item.number))
    return found


def test_jobs_are_numbered_in_each_deck() -> None:
    found = outline(read_decks([STACKED, CASE_1]))
    assert found == [
        (STACKED, 1), (STACKED, 2), (STACKED, 3), (STACKED, None), (CASE_1, 1), (CASE_1, None),
    ]  # fmt: skip
    assert outline(read_decks([])) == []


def test_they_are_solved_in_the_same_order() -> None:
    given = [STACKED, CASE_1]
    assert outline(solve_jobs(read_decks(given), SolveOptions())) == outline(read_decks(given))


def test_a_deck_may_be_elsewhere_than_its_name() -> None:
    found = list(read_decks(["film"], locations={"film": STACKED}))
    assert [item.deck for item in found] == 4 * ["film"]
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
    found = outline(read_decks([broken, none, CASE_1]))
    assert found[0] == (broken, 1) and found[3:] == [(CASE_1, 1), (CASE_1, None)]
    (deck, error), (missing, why) = found[1:3]
    assert deck == broken and "card 90" in str(error)
    assert missing == none and "No such file" in str(why)


def test_a_table_out_of_order_ends_the_deck_after_its_job() -> None:
    found = outline(solve_jobs(read_decks([WIND_DECK, CASE_1]), SolveOptions()))
    numbers = [number for deck, number in found if deck == WIND_DECK]
    assert numbers[0] == 1 and isinstance(numbers[-1], str)
    assert found[-2:] == [(CASE_1, 1), (CASE_1, None)]


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
