"""One photograph with its solutions: what every output is made from."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from vopd.arrays import Floats, Ints
from vopd.stellar.field import StarField
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.methods.solved_stars import SolvedStars


@dataclass(frozen=True, eq=False)
class SolvedPhotograph:
    """One photograph with its solutions.

    Attributes:
        label: what tells it from others; empty where it is the only one
        file: its stars as they were read
        stars: its problem
        used: the stars that are not rejected, counted from 0
        solved: the solutions to show
        findings: errors and warnings
        status: exit status 0, 1 or 3
        epoch: what right ascensions and declinations refer to; empty for ground points
        utc: when it was taken, if that is known
        local: from ICRF axes to east, north, up at the place, (3, 3), if these are known
    """

    label: str
    file: StarFile
    stars: StarField
    used: Ints
    solved: tuple[SolvedStars, ...]
    findings: tuple[KindOfFinding, ...]
    status: int
    epoch: str = ""
    utc: datetime | None = None
    local: Floats | None = None
