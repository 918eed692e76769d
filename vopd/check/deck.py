"""A whole deck read without solving, all that is wrong with it collected."""

from __future__ import annotations

from typing import BinaryIO

from vopd.cards.reader import read_jobs
from vopd.check.rules import RULES, SPREAD_IN
from vopd.check.trace import Trace
from vopd.findings import DeckError, Finding
from vopd.job import Job
from vopd.program.ignored import kept


def check_deck(
    file: BinaryIO, name: str, *, spread_in: float = SPREAD_IN, limits_1974: bool = False
) -> list[Finding]:
    """All errors and warnings of a deck, in the order of its cards.

    Reading goes on after a field that is no number; it ends at a count that
    leaves open where the next group begins. `spread_in` is how far three
    readings of one point may differ, inches.
    """
    found: list[Finding] = []
    trace = Trace()
    jobs = read_jobs(file, name, found.append, limits_1974=limits_1974, trace=trace)
    try:
        for job in jobs:
            for rule, groups in RULES:
                if any(map(trace.read_again, groups)):
                    found += rule(job, trace, spread_in)
            found += _undefined(job)
            trace.next_job()
    except DeckError as error:
        found.append(error.finding)
    unique = list(dict.fromkeys(found))
    return sorted(unique, key=lambda finding: (finding.card or 0, finding.columns or (0, 0)))


def _undefined(job: Job) -> list[Finding]:
    """Landmarks that take part and that group 9 does not define."""
    used = kept(job.readings, job.ignored).used
    numbers = sorted(set(job.readings.landmark[used].tolist()) - set(job.landmarks.number.tolist()))
    return [job.readings.first_card[n] for n in numbers if n in job.readings.first_card]
