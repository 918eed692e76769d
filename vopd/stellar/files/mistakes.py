"""Whether the residuals of a photograph are plausible, and which mistake explains them if not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.stellar.field import StarField
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistake_trials import LARGEST_RESIDUAL, UsualMistake
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.files.usual_mistakes import one_mistake, two_mistakes
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.outlier_search import (
    AttitudeFit,
    Outlier,
    OutlierStart,
    find_outliers,
    fit_attitude,
)

MIRROR_RATIO, MIRROR_RATIO_OF_FEW, FEW = 5.0, 50.0, 4
"""Ratio of residuals to the reading error of the interstar angles that no chance explains.

A mirrored photograph keeps its interstar angles and fits no attitude. The few
angles of four stars or less tell their reading error roughly: of 400 good
photographs of three stars, five had a ratio above 5."""

LARGEST_PLATE_MM = 500.0
"""Image coordinates beyond this are hardly mm: the plates of the largest cameras have 360."""

CHANCE = 1e-4
"""Chance below which a reading sigma is wrong (chi-square test)."""


class Plausibility(NamedTuple):
    """Whether the residuals of a photograph are plausible, and which mistake explains them if not.

    Attributes:
        sigma: standard deviation of the residuals, image units; infinite without a solution
        expected: what they should be, as a clause; empty if they are plausible
        mistake: the mistake that mends them best, if one does
        outliers: stars that do not fit the others, if no other mistake explains them
        unexplained: what to do where the residuals are implausible and no mistake mends them
    """

    sigma: float
    expected: str = ""
    mistake: UsualMistake | None = None
    outliers: tuple[Outlier, ...] = ()
    unexplained: str = ""

    @property
    def about_stars(self) -> bool:
        """Whether the mistake found is about some of the stars only."""
        return self.mistake is not None and bool(self.mistake.stars)


def judge(
    file: StarFile,
    stars: StarField,
    reading_sigma: float | None,
    axes: ImageAxes,
    start: OutlierStart = "interstar",
) -> Plausibility:
    """Test the residuals of all stars of a file, and try the common mistakes.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem, two stars or more
        reading_sigma: standard deviation of an image coordinate, if it is known, image units
        axes: how the file's image coordinates were read
        start: how the search for stars that do not fit begins

    Returns:
        What was found.
    """
    fit = fit_attitude(stars)
    sigma = float(np.sqrt(fit.variance_mm2))
    outliers = find_outliers(stars, start=start)
    expected = _implausible(fit, stars, reading_sigma, file.unit)
    mistake = None
    if int(stars.count) > 2 and not (expected and _beyond_plates(file)):
        mistake = one_mistake(file, stars, fit, outliers, axes)
        if expected and mistake is None:
            mistake = two_mistakes(file, stars, fit, axes)
    if not expected and mistake is not None:
        expected = f"mending the mistake named below leaves {mistake.sigma:.3g} {file.unit}"
    unexplained = ""
    if expected and mistake is None:
        agree = reading_sigma is not None and not _implausible(fit, stars, None, file.unit)
        unexplained = _unexplained(file, f"{sigma:.3g} {file.unit}" if agree else "")
    kept = tuple(outliers) if mistake is None or mistake.stars else ()
    return Plausibility(sigma, expected, mistake, kept, unexplained)


def _unexplained(file: StarFile, agreement: str) -> str:
    """What to do about implausible residuals that no mistake mends.

    Args:
        file: the file
        agreement: how well the stars agree with each other; empty if they do not
    """
    if _beyond_plates(file):
        largest = float(np.abs(file.image).max())
        return f"coordinates of {largest:.0f} mm: are they pixels? Name their columns x_px, y_px"
    if len(file.lines) < 3:
        return (
            "two stars cannot tell what is wrong (which stars they are, their coordinates, "
            "the principal distance): add a third one"
        )
    if agreement:
        return f"the stars agree with each other to {agreement}: is the stated sigma too small?"
    return (
        "none of the common mistakes explains this (mirrored or exchanged coordinates, wrong "
        "units, another camera, wrong stars)"
    )


def _beyond_plates(file: StarFile) -> bool:
    """Whether coordinates in mm are larger than photographs are."""
    return file.unit == "mm" and float(np.abs(file.image).max()) > LARGEST_PLATE_MM


def _implausible(fit: AttitudeFit, stars: StarField, reading_sigma: float | None, unit: str) -> str:
    """What the residuals should be, as a clause; empty if they are plausible."""
    focal = float(stars.focal_length_mm[0])
    if reading_sigma is not None:
        from scipy.special import chdtrc  # slow to import, and most files do without

        ratio = fit.variance_mm2 / reading_sigma**2
        large = chdtrc(fit.freedom, fit.freedom * ratio) < CHANCE
        return f"the stated sigma allows {reading_sigma:.3g} {unit}" if large else ""
    interstar = interstar_reading_sigma_mm(stars)
    ratio = MIRROR_RATIO if int(stars.count) > FEW else MIRROR_RATIO_OF_FEW
    known = bool(np.isfinite(interstar))  # it takes three stars
    if known and fit.variance_mm2 > max(ratio * interstar, 1e-6 * focal) ** 2:
        return f"the interstar angles allow {interstar:.3g} {unit}"
    if fit.variance_mm2 > (LARGEST_RESIDUAL * focal) ** 2:
        return f"a photograph allows {LARGEST_RESIDUAL * focal:.3g} {unit} at most"
    return ""
