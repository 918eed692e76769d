"""Checks a whole deck without solving it and collects every finding."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from vopd.cards.reader import read_jobs
from vopd.check.card_locations import CardLocations
from vopd.check.rules import RULES
from vopd.findings import DeckError, Finding
from vopd.job import Job
from vopd.program.ignored import kept


@np.errstate(all="ignore")  # numbers punched too large overflow in what the rules compute
def check_deck(
    file: BinaryIO, name: str, *, spread_in: float | None = None, limits_1974: bool = False
) -> list[Finding]:
    """Find all errors and warnings of a deck.

    After a field that is not a number, reading goes on. It ends where the cards
    leave open where the next group or the next frame begins.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        spread_in: how far three readings of one point may differ, inches; None takes the limit
            from the noise of the deck's own readings (`vopd.check.reading_spread`)
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Returns:
        The findings in the order of the deck's cards.

    Raises:
        VopdError: where the file is empty or is not a deck.
    """
    found: list[Finding] = []
    locations = CardLocations()
    jobs = read_jobs(file, name, found.append, limits_1974=limits_1974, on_cards=locations.add)
    job = None
    try:
        for job in jobs:
            for rule, groups in RULES:
                if any(map(locations.was_read, groups)):
                    with np.errstate(all="ignore"):  # a number beyond all bounds is a finding
                        found += rule(job, locations, spread_in)
            found += _undefined_landmarks(job)
            locations.next_job()
        if job is None and not any(one.severity == "error" for one in found):
            found.append(Finding("the deck ends after group 1: it has no job", name).warned())
    except DeckError as error:
        found.append(error.finding)
    unique = list(dict.fromkeys(found))
    return sorted(unique, key=lambda finding: (finding.card or 0, finding.columns or (0, 0)))


def _undefined_landmarks(job: Job) -> list[Finding]:
    """An error for each landmark that is used in a frame and is not defined by group 9."""
    if not job.readings.first_card:
        return []
    used = kept(job.readings, job.ignored).used
    read = set(job.readings.points.landmark[used].tolist())
    numbers = sorted(read - set(job.landmarks.number.tolist()))
    return [job.readings.first_card[n] for n in numbers if n in job.readings.first_card]
