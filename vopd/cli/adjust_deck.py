"""`vopd adjust` of a deck: one landmark of group 9 located, by all frames or by stacked trials."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING

import click

from vopd.cli.console import Progress
from vopd.errata import Fixes
from vopd.files import whole_file
from vopd.findings import count_text
from vopd.screen import aligned

if TYPE_CHECKING:
    from vopd.convert.feature_trials import FeatureTrials
    from vopd.flight.adjust.adjustment import Adjustment

PREFIX = "landmark:"
COLUMNS = (
    "job",
    "round",
    "varied",
    "latitude_deg",
    "longitude_deg",
    "altitude_ft",
    "yaw_difference_deg",
    "pitch_difference_deg",
    "roll_difference_deg",
    "apart_in",
    "best",
)
"""Of the table of a search: differences are those of the vehicle's angles, rms over the frames."""
DECIMALS = (0, 0, 0, 7, 7, 1, 5, 5, 5, 6)


def landmark_number(names: Sequence[str]) -> int:
    """Read which landmark of a deck is to be located.

    Raises:
        click.UsageError: if they are not one landmark
    """
    marks = [name for name in names if name.startswith(PREFIX)]
    if not names or len(marks) < len(names):
        raise click.UsageError(
            "of a deck one landmark can be free, --free landmark:NUMBER; make a project of the "
            "deck for anything else (vopd new --deck)."
        )
    if len(marks) > 1:
        raise click.UsageError(
            f"--free {','.join(marks)}: of a deck one landmark is located at a time: free one, "
            "and the next in the deck of -o."
        )
    number = marks[0].removeprefix(PREFIX)
    if not (number.isascii() and number.isdigit() and len(number) < 10):
        raise click.UsageError(
            f"--free {marks[0]}: landmarks of a deck have numbers, as --free landmark:66."
        )
    return int(number)


def adjusted_deck(
    source: str, job_number: int | None, names: Sequence[str], fixes: Fixes,
    sigma_ft: float | None, output: str | None, quiet: bool,
) -> Adjustment:  # fmt: skip
    """Locate a landmark by all frames; write the deck with it in group 9.

    Args:
        source: the deck
        job_number: which of its jobs, from 1; None: the only one
        names: what is free; none: the deck is solved as it is, to be tested
        fixes: errata that are corrected, which choose the Earth
        sigma_ft: prior standard deviation of the landmark; None: none
        output: the deck to write; None: none
        quiet: whether notes are left out
    """
    from vopd.cards.write import write_deck
    from vopd.convert.deck_to_flight import deck_flight
    from vopd.convert.feature import deck_with_landmark, locate_feature
    from vopd.convert.feature_trials import END
    from vopd.flight.adjust.adjustment import adjust
    from vopd.pipeline import read_deck

    number = landmark_number(names) if names else 0
    if output is not None and not names:
        raise click.UsageError("-o: nothing is located that could be written: give --free.")
    if sigma_ft is not None and not names:
        raise click.UsageError("--landmark-sigma: no landmark is located: give --free.")
    if output is not None and source == "-":
        raise click.UsageError("-o: name the file of the deck, of which one card is changed.")
    deck = read_deck(source)
    job = deck.chosen(job_number)
    if not names:
        return adjust(deck_flight(job, fixes, source), [])
    found = locate_feature(job, number, fixes, source, sigma_ft)
    if output is not None:
        if len(deck) > 1:  # a job whose cards are partly those of the ones before it
            written = write_deck([replace(found.job, return_group=END)]).encode("ascii")
        else:
            with open(source, "rb") as file:  # noqa: PTH123
                written = deck_with_landmark(file.read(), source, found.job, number)
        with whole_file(output) as target:
            target.write(written)
    for note in () if quiet else found.notes:
        click.echo(f"{source}: {note}", err=True)
    return found.adjustment


def searched_deck(
    source: str, job_number: int | None, names: Sequence[str], fixes: Fixes, output: str | None,
    form: str, quiet: bool,
) -> int:  # fmt: skip
    """Locate a landmark by stacked trials, print the table of the search, and write the stack.

    Args:
        source: the deck
        job_number: which of its jobs, from 1; None: the only one
        names: what is free
        fixes: errata that are corrected in all jobs
        output: the stacked deck to write; None: none
        form: of the table: text, csv or json
        quiet: whether notes are left out

    Returns:
        The exit status.
    """
    from vopd.cards.write import write_deck
    from vopd.convert.feature_trials import search_feature
    from vopd.pipeline import read_deck

    number = landmark_number(names)
    job = read_deck(source).chosen(job_number)
    progress, run = Progress("jobs"), [0]

    def count(jobs: int) -> None:
        progress.add(jobs - run[0])
        run[0] = jobs

    try:
        found = search_feature(job, number, fixes, source, count)
    finally:
        progress.close()
    if output is not None:
        with whole_file(output) as target:
            target.write(write_deck(found.jobs).encode("ascii"))
    if form == "text":
        head = f"{source}: landmark {number}, {count_text(found.frames, 'frame')} compared, "
        click.echo(head + count_text(len(found.jobs), "job") + "\n")
    click.echo({"text": _text, "csv": _csv, "json": _json}[form](found), nl=False)
    if not quiet:
        minute, foot = float(found.last_step[0] * 60.0), float(found.last_step[2])
        click.echo(f"{source}: {_stands(found)}; its steps are {minute:g} minute and {foot:g} ft",
                   err=True)  # fmt: skip
    return 0 if found.stands else 3


def _stands(found: FeatureTrials) -> str:
    rounds = found.trials[-1].round
    if found.stands:
        return f"the coordinates stand in round {rounds}"
    return (
        f"the coordinates do not stand after {count_text(rounds, 'round')}: free the landmark "
        "without --trials, which says how well its frames hold it"
    )


def _rows(found: FeatureTrials) -> list[list[object]]:
    """List the trials by the columns of the table; None where there is no number."""
    rows = []
    for one in found.trials:
        numbers = [*one.coordinates.tolist(), *one.difference_deg.tolist(), one.apart_in]
        values = [round(v, d) if isfinite(v) else None for v, d in zip(numbers, DECIMALS[3:],
                                                                      strict=True)]  # fmt: skip
        rows.append([one.job, one.round, one.varied, *values, one.best])
    return rows


def _text(found: FeatureTrials) -> str:
    cells = [["job", "round", "varied", "latitude", "longitude", "altitude",
              "yaw", "pitch", "roll", "apart in", ""]]  # fmt: skip
    for row in _rows(found):
        shown = [
            "-" if v is None else v if isinstance(v, str) else f"{v:.{d}f}"
            for v, d in zip(row[:-1], DECIMALS, strict=True)
        ]
        cells.append([*shown, "best" if row[-1] else ""])
    return "\n".join(aligned(cells, {2})) + "\n"


def _csv(found: FeatureTrials) -> str:
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerow(COLUMNS)
    for *values, best in _rows(found):
        writer.writerow([*("" if v is None else v for v in values), "yes" if best else "no"])
    return page.getvalue()


def _json(found: FeatureTrials) -> str:
    table = {
        "frames": found.frames,
        "stands": found.stands,
        "latitude_deg": float(found.coordinates[0]),
        "longitude_deg": float(found.coordinates[1]),
        "altitude_ft": float(found.coordinates[2]),
        "trials": [dict(zip(COLUMNS, row, strict=True)) for row in _rows(found)],
    }
    return json.dumps(table, indent=2, allow_nan=False) + "\n"
