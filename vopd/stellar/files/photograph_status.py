"""How the solution of a photograph ended: exit status, and warnings about what was asked for."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.findings import Finding
from vopd.stellar.failures import Failure
from vopd.stellar.files.counted_findings import KindOfFinding
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.methods.run import ONLY_PAIRS
from vopd.stellar.methods.solved_stars import SolvedStars


def exit_status(solved: Sequence[SolvedStars], judged: Plausibility, request: StarRequest) -> int:
    """1 where a method failed, 3 where one did not converge or the residuals are implausible."""
    failures = {one.failure for one in solved} - {Failure.NONE}
    by_residuals = {Failure.NO_CONVERGENCE}
    if judged.expected:
        by_residuals |= {Failure.TOO_UNCERTAIN, Failure.NOT_A_ROTATION}
    if failures - by_residuals:
        return 1
    return 3 if failures or implausible(judged, request) else 0


def implausible(judged: Plausibility, request: StarRequest) -> bool:
    """Whether the residuals are implausible, and not for stars that the solution allows for."""
    allowed_for = judged.about_stars and (request.rejects or request.options.weights == "robust")
    return bool(judged.expected) and not allowed_for


def only_one_pair(
    solved: Sequence[SolvedStars], file: StarFile, request: StarRequest
) -> list[KindOfFinding]:
    """A warning where a method for two stars has solved the first two of many."""
    if request.all_pairs or request.pair is not None or len(file.lines) < 3:
        return []
    alone = [one for one in solved if one.method in ONLY_PAIRS]
    if not alone:
        return []
    first, second = alone[0].stars
    message = (
        f"{' and '.join(one.method for one in alone)}: stars {first} and {second} of "
        f"{len(file.lines)}, as listed; --pair or --all-pairs for others"
    )
    return [KindOfFinding("pair", Finding(message, deck=file.deck, severity="warning"))]
