"""Errors and warnings about a star file's solutions; many of one kind are counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, size_text
from vopd.geometry.linear import transform
from vopd.stellar.field import DEGENERATE, REASONS, Failure, StarField, coincide
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.church import AT_PRINCIPAL_POINT, NEAR_GREAT_CIRCLE, flatness
from vopd.stellar.methods.collinearity import LIMIT
from vopd.stellar.methods.run import SolvedStars
from vopd.stellar.methods.single_rotation import ILL_CONDITIONED
from vopd.stellar.uncertainty import LARGEST_SIGMA_DEG

SHOWN_OF_A_KIND = 3  # how many findings of one kind are shown; the others are counted


KindOfFinding = tuple[str, Finding]
"""A finding after its kind, by which many of one kind are counted: `method: what` or `what`."""


def counted(findings: Iterable[KindOfFinding]) -> list[Finding]:
    """Keep the first three findings of each kind, and count the others."""
    seen: Counter[str] = Counter()
    shown: list[Finding] = []
    last: dict[str, Finding] = {}
    for kind, finding in findings:
        seen[kind] += 1
        if seen[kind] <= SHOWN_OF_A_KIND or kind == "plausibility":
            shown.append(finding)
        last[kind] = finding
    for kind, count in seen.items():
        if count > SHOWN_OF_A_KIND and kind != "plausibility":
            method, colon, _ = kind.partition(":")
            text = f"{method}: " * bool(colon) + f"{count - SHOWN_OF_A_KIND} more like these"
            more = Finding(text, last[kind].source, severity=last[kind].severity)
            shown.append(more)
    return shown


FAR_IMAGE = 1e3
"""Distance of an image from the principal point, in focal lengths, that no lens covers."""

PLANE = np.array([0.48, -0.64, 0.6])  # unit normal of a plane that no catalogue is aligned with


def refuse_unsolvable(file: StarFile, stars: StarField) -> None:
    """Refuse a file that no method can solve.

    Raises:
        InputError: fewer than two stars, a star or an image given twice (to .2
            seconds of arc), or an image that no lens could have made.
    """
    far = np.abs(stars.image_mm).max(axis=-1) > FAR_IMAGE * stars.focal_length_mm
    if far.any():
        raise file.error(
            f"the image is more than {FAR_IMAGE:g} focal lengths out", int(np.argmax(far))
        )
    if len(file.lines) < 2:
        raise file.error("the only star: an attitude takes two at least", 0)
    for vectors, what in ((stars.directions, "star"), (stars.photo, "image")):
        same = _first_coincidence(vectors)
        if same is not None:
            first, second = same
            opposite = float(vectors[first] @ vectors[second]) < 0.0
            text = "two stars in opposite directions" if opposite else f"the same {what} twice"
            raise file.error(text, first, second)


def _first_coincidence(vectors: Floats) -> tuple[int, int] | None:
    """Find the first two unit vectors (n, 3) that are the same or opposite; None if there are none.

    Only those are compared whose distances from one plane are the same, sorted by them.
    """
    distance = np.abs(vectors @ PLANE)
    order = np.argsort(distance, kind="stable")
    found: tuple[int, int] | None = None
    for offset in range(1, len(vectors)):
        first, second = order[:-offset], order[offset:]
        near = distance[second] - distance[first] < DEGENERATE
        if not near.any():
            break
        if found is not None:  # of thousands of stars that are the same, few pairs come before
            near &= np.minimum(first, second) <= found[0]
        first, second = first[near], second[near]
        same = coincide(vectors[first], vectors[second])
        pairs = np.sort(np.column_stack([first, second])[same], axis=1)
        if len(pairs):
            one, other = pairs[np.lexsort(pairs.T[::-1])[0]].tolist()
            found = min(found or (one, other), (one, other))
    return found


def explain(solved: SolvedStars, file: StarFile, stars: StarField) -> list[KindOfFinding]:
    """Explain why one solution failed or is poor: errors and warnings.

    Returns:
        An error where there is no solution, warnings where it is poor.
    """
    used = [star - 1 for star in solved.stars]
    if solved.failure == Failure.NONE:
        return _warnings(solved, file, stars)
    text = REASONS[solved.failure]
    if solved.failure == Failure.TOO_FEW_STARS:
        text = "takes three stars at least"
    elif solved.failure == Failure.BEHIND_CAMERA:
        depth = transform(np.array(solved.matrix), stars.directions[used])[:, 2]
        used = [star for star, z in zip(used, depth.tolist(), strict=True) if z >= 0.0] or used
        subject = "the star lies" if len(used) == 1 else "these stars lie"
        text = f"{subject} behind the camera in the solution"
    elif solved.failure == Failure.PRINCIPAL_POINT:
        radius = np.hypot(stars.image_mm[used, 0], stars.image_mm[used, 1])
        near = radius < AT_PRINCIPAL_POINT * stars.focal_length_mm
        used = [star for star, central in zip(used, near.tolist(), strict=True) if central]
        text += "; a reading sigma bounds it (--reading-sigma)"
    elif solved.failure == Failure.NO_CONVERGENCE:
        text += f" in {LIMIT} corrections"
    elif solved.failure == Failure.TOO_UNCERTAIN and solved.rotation_sigma_arcsec is not None:
        sigma_deg = max(solved.rotation_sigma_arcsec) / 3600.0
        text += f": its standard deviation is {size_text(sigma_deg)} degrees"
        text += f", above {LARGEST_SIGMA_DEG:g}"
    finding = file.finding(f"{solved.method}: {text}", *used)
    return [(f"{solved.method}: {solved.failure.name}", finding)]


def _warnings(solved: SolvedStars, file: StarFile, stars: StarField) -> list[KindOfFinding]:
    """Warn of a solution that reading errors change much."""
    used = [star - 1 for star in solved.stars]
    found = []
    sine = solved.conditioning
    if sine is not None and sine < ILL_CONDITIONED:
        text = (
            f"the rotation axis lies near the plane of the two stars: sin(D1, D2) = "
            f"{sine:.3f} is below {ILL_CONDITIONED:g}, and reading errors grow "
            f"about {1.0 / sine:.0f} times"
        )
        found.append(("axis", text))
    if solved.method.startswith("church"):
        flat = float(flatness(stars.select(np.array(used))))
        if flat < NEAR_GREAT_CIRCLE:
            text = (
                f"the stars lie nearly on one great circle ({flat:.1e}): "
                f"reading errors grow up to {1.0 / flat:.0f} times"
            )
            found.append(("great circle", text))
    return [
        (f"{solved.method}: {kind}", file.finding(f"{solved.method}: {text}", *used).warned())
        for kind, text in found
    ]


MANY = 0.4  # part of the stars that are left out, from which the others are doubted


def explain_plausibility(
    judged: Plausibility, file: StarFile, *, rejected: bool
) -> list[KindOfFinding]:
    """Warn of residuals that are too large and of stars that do not fit."""
    found = []
    mistake = judged.mistake
    only_stars = judged.about_stars
    if judged.expected and not (rejected and only_stars):
        known = np.isfinite(judged.sigma)
        size = f"{size_text(judged.sigma, 3)} {file.unit}" if known else "no attitude fits"
        text = f"the residuals are implausible: {size}, where {judged.expected}"
        found.append(file.finding(text))
        if mistake is None:
            found.append(file.finding(judged.unexplained))
        else:
            left = size_text(mistake.residual, 3)
            text = f"{mistake.advice}; the residuals are then {left} {file.unit}"
            found.append(file.finding(text, *mistake.points))
    for outlier in judged.outliers if rejected or not only_stars else ():
        fate = "left out" if rejected else "does not fit the others"
        far = size_text(outlier.distance_mm, 3)
        text = (
            f"star {outlier.star + 1} {'is ' if rejected else ''}{fate}: "
            f"its image is {far} {file.unit} from where their attitude puts it "
            f"(chance {outlier.chance:.1g})"
        )
        found.append(file.finding(text, outlier.star))
    kinds = [("plausibility", finding.warned()) for finding in found]
    out, count = len(judged.outliers), len(file.lines)
    if rejected and out >= MANY * count:
        text = (
            f"{out} of {count} stars are left out: where half of them are wrong the others need "
            "not be right; are they identified well?"
        )
        kinds.insert(0, ("many left out", file.finding(text).warned()))
    return kinds
