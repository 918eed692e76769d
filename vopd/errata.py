"""The programs' known slips as data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Erratum:
    """One slip of an original program or report.

    `name` is what a command line calls it; `where` is the place in the source;
    `slip` what stands there, `remedy` what should; `evidence` how it is known;
    `effect` what it does to a result.
    """

    name: str
    program: str
    where: str
    slip: str
    remedy: str
    evidence: str
    effect: str
