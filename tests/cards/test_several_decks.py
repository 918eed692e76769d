"""Several decks: each is read as it is by itself, with its own findings and its own error."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.jobs import APPENDIX_H
from vopd.findings import InputError
from vopd.pipeline import ReadJob, read_decks
from vopd.results import DeckEnd

ROOT = Path(__file__).parents[2]
REGRESSION = sorted((ROOT / "decks" / "regression").glob("*.dat"))
HOSTILE = sorted((ROOT / "tests" / "robustness" / "inputs").glob("*.dat"))
CASES = [APPENDIX_H / f"case{number}.dat" for number in range(1, 5)]


def said(item: ReadJob | DeckEnd) -> list[str]:
    """The messages of a job or of the end of a deck."""
    error = [str(item.error)] if isinstance(item, DeckEnd) else []
    return [item.deck, *map(str, item.findings), *error]


@pytest.mark.parametrize("limits_1974", [False, True])
def test_together_as_alone(limits_1974: bool, tmp_path: Path) -> None:
    """Decks of the report, with several jobs, with errors, without a card, and no decks at all."""
    names = [str(path) for path in (*CASES, *REGRESSION, *HOSTILE, ROOT / "README.md")]
    names += [str(tmp_path), str(tmp_path / "none.dat")]
    assert len(REGRESSION) > 5 and len(HOSTILE) > 10
    together = list(read_decks(names, limits_1974))
    alone = [item for name in names for item in read_decks([name], limits_1974)]
    assert [said(item) for item in together] == [said(item) for item in alone]
    for ours, theirs in zip(together, alone, strict=True):
        assert isinstance(ours, ReadJob) == isinstance(theirs, ReadJob)
        if isinstance(ours, ReadJob) and isinstance(theirs, ReadJob):
            assert (ours.number, ours.job) == (theirs.number, theirs.job)
            assert ours.job.readings.first_card == theirs.job.readings.first_card
    ends = [item for item in together if isinstance(item, DeckEnd)]
    assert [end.deck for end in ends] == names
    assert 5 < sum(end.error is None for end in ends) < len(ends) - 10


def test_an_error_is_that_of_its_own_deck(tmp_path: Path) -> None:
    """Case 1 has 43 cards before the basic data, so that the 50th is the seventh of them."""
    lines = CASES[0].read_text().splitlines()
    short, odd, good = (tmp_path / f"{name}.dat" for name in ("short", "odd", "good"))
    short.write_text("\n".join(lines[:49]) + "\n")
    odd.write_text("\n".join([lines[0], "     X.000" + lines[1][10:], *lines[2:]]) + "\n")
    good.write_text("\n".join(lines) + "\n")
    decks = [str(path) for path in (good, short, odd, good)]
    read = list(read_decks(decks))
    assert [type(item).__name__ for item in read] == [
        "ReadJob", "DeckEnd", "DeckEnd", "DeckEnd", "ReadJob", "DeckEnd",
    ]  # fmt: skip
    errors = [str(item.error).splitlines()[0] for item in read if isinstance(item, DeckEnd)]
    assert errors[0] == errors[3] == "None"
    assert errors[1].startswith(f"{short}: card 50, basic data: the deck ends here")
    assert errors[2].startswith(
        f"{odd}: card 2, group 1, radial distance (columns 1-10): not a number"
    )


def test_warnings_stay_with_their_deck_and_job(tmp_path: Path) -> None:
    """A blank among the digits of card 3 of the second deck."""
    lines = CASES[0].read_text().splitlines()
    lines[2] = "     1 .5 " + lines[2][10:]
    doubtful = tmp_path / "doubtful.dat"
    doubtful.write_text("\n".join(lines) + "\n")
    names = [str(path) for path in (CASES[1], doubtful, CASES[0])]
    jobs = [item for item in read_decks(names) if isinstance(item, ReadJob)]
    assert [len(job.findings) for job in jobs] == [0, 1, 0]
    (finding,) = jobs[1].findings
    assert (finding.deck, finding.card, finding.group) == (str(doubtful), 3, 1)


@pytest.mark.parametrize("limits_1974", [False, True])
def test_findings_have_the_name_of_the_deck_and_not_its_path(
    limits_1974: bool, tmp_path: Path
) -> None:
    """A warning, an error, and a limit where it is asked for; and a file that is not there."""
    lines = CASES[0].read_text().splitlines()
    doubtful = [*lines[:2], "     1 .5 " + lines[2][10:], *lines[3:]]
    wrong = [*lines[:38], "        xx" + lines[38][10:], *lines[39:]]
    large = [*lines[:40], f"{91:10d}" + lines[40][10:], *lines[41:]]
    decks = []
    for name, cards in (("doubtful", doubtful), ("wrong", wrong), ("large", large)):
        (tmp_path / f"{name}.dat").write_text("\n".join(cards))
        decks.append(str(tmp_path / f"{name}.dat"))
    where = dict(zip(("doubtful", "wrong", "large"), decks, strict=True))
    read = list(read_decks(where, limits_1974, where))
    jobs = [item for item in read if isinstance(item, ReadJob)]
    one, other, third = (item for item in read if isinstance(item, DeckEnd))
    assert [(found.deck, found.card) for found in jobs[0].findings] == [("doubtful", 3)]
    assert one.error is None and one.findings == ()
    assert isinstance(other.error, InputError) and [job.deck for job in jobs][1:2] != ["wrong"]
    assert (other.error.finding.deck, other.error.finding.card) == ("wrong", 39)
    if limits_1974:
        assert isinstance(third.error, InputError) and third.error.finding.deck == "large"
    else:
        assert third.error is None and [job.deck for job in jobs] == ["doubtful", "large"]
    missing, good, _ = read_decks(
        ["x", "doubtful"], locations={"x": str(tmp_path / "none"), **where}
    )
    assert isinstance(missing, DeckEnd) and "No such file" in str(missing.error)
    assert isinstance(good, ReadJob)
