"""What went wrong with a star file's solution, said with the lines it concerns."""

from __future__ import annotations

import numpy as np

from vopd.findings import Finding
from vopd.geometry.vectors import transform
from vopd.stellar.failures import REASONS, Failure
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.interstar_angles import outliers, star_pairs
from vopd.stellar.methods.church import AT_PRINCIPAL_POINT, NEAR_GREAT_CIRCLE, flatness
from vopd.stellar.methods.collinearity import LIMIT
from vopd.stellar.methods.run_methods import SolvedField
from vopd.stellar.methods.single_rotation import ILL_CONDITIONED
from vopd.stellar.star_field import StarField, coincide

FAR_IMAGE = 1e3
"""Distance of an image from the principal point, in focal lengths, that no lens covers."""


def check(file: StarFile, stars: StarField) -> None:
    """Refuse what no method can solve: raises DeckError naming the lines.

    Fewer than two stars, a star or an image given twice (to .2 seconds of
    arc), and an image that no lens could have made.
    """
    far = np.abs(stars.image_mm).max(axis=-1) > FAR_IMAGE * stars.focal_length_mm
    if far.any():
        raise file.error(
            f"the image is more than {FAR_IMAGE:g} focal lengths out", int(np.argmax(far))
        )
    if len(file.lines) < 2:
        raise file.error("the only star: an attitude takes two at least", 0)
    one, other = star_pairs(len(file.lines)).T
    for vectors, what in ((stars.directions, "star"), (stars.photo, "image")):
        same = coincide(vectors[one], vectors[other])
        if same.any():
            first, second = int(one[np.argmax(same)]), int(other[np.argmax(same)])
            opposite = float(vectors[first] @ vectors[second]) < 0.0
            text = "two stars in opposite directions" if opposite else f"the same {what} twice"
            raise file.error(text, first, second)


def explain(record: SolvedField, file: StarFile, stars: StarField) -> list[Finding]:
    """Errors and warnings about one solution."""
    used = [star - 1 for star in record.stars]
    about = f"{record.method}: "
    if record.failure == Failure.NONE:
        return _warnings(record, file, stars)
    if record.failure == Failure.TOO_FEW_STARS:
        return [file.finding(about + "takes three stars at least", *used)]
    if record.failure == Failure.BEHIND_CAMERA:
        depth = transform(np.array(record.matrix), stars.directions[used])[:, 2]
        behind = [star for star, z in zip(used, depth.tolist(), strict=True) if z >= 0.0]
        subject = "the star lies" if len(behind) == 1 else "these stars lie"
        text = f"{subject} behind the camera in the solution"
        return [file.finding(about + text, *behind)]
    if record.failure == Failure.PRINCIPAL_POINT:
        radius = np.hypot(stars.image_mm[used, 0], stars.image_mm[used, 1])
        near = radius < AT_PRINCIPAL_POINT * stars.focal_length_mm
        used = [star for star, central in zip(used, near.tolist(), strict=True) if central]
        text = f"{REASONS[record.failure]}; a reading sigma bounds it (--reading-sigma)"
        return [file.finding(about + text, *used)]
    if record.failure == Failure.NO_CONVERGENCE:
        return [file.finding(f"{about}no convergence in {LIMIT} corrections", *used)]
    return [file.finding(about + REASONS[record.failure], *used)]


def explain_outliers(file: StarFile, stars: StarField) -> list[Finding]:
    """A warning for each star that disagrees with all the others."""
    return [
        file.finding(
            f"star {star + 1} disagrees with the others: misidentified, or misread?", int(star)
        ).warned()
        for star in np.flatnonzero(outliers(stars))
    ]


def _warnings(record: SolvedField, file: StarFile, stars: StarField) -> list[Finding]:
    used = [star - 1 for star in record.stars]
    found = []
    conditioning = record.values.get("conditioning")
    if conditioning is not None and conditioning < ILL_CONDITIONED:
        found.append(
            f"the rotation axis lies near the plane of the two stars: sin(D1, D2) = "
            f"{conditioning:.3f} is below {ILL_CONDITIONED:g}, and reading errors grow "
            f"about {1.0 / conditioning:.0f} times"
        )
    if record.method.startswith("church"):
        flat = float(flatness(stars.select(np.array([used])))[0])
        if flat < NEAR_GREAT_CIRCLE:
            found.append(
                f"the stars lie nearly on one great circle ({flat:.1e}): "
                f"reading errors grow up to {1.0 / flat:.0f} times"
            )
    return [file.finding(f"{record.method}: {text}", *used).warned() for text in found]
