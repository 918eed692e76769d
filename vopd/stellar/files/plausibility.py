"""Whether the residuals of a photograph are plausible, and which mistake explains them if not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.stellar.files.image_axes import ImageAxes
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.files.usual_mistakes import UsualMistake, mended_mistakes
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.outlier_search import (
    AttitudeFit,
    Outlier,
    OutlierStart,
    find_outliers,
    fit_attitude,
)
from vopd.stellar.star_field import StarField

LARGEST_RESIDUAL = 0.01
"""Standard deviation of the residuals, in principal distances, that no reading has: half a degree.

The report's perturbed sample, with its large errors of .1 to .3 mm, has .003."""

MIRROR_RATIO, MIRROR_RATIO_OF_FEW, FEW = 5.0, 50.0, 4
"""Ratio of residuals to the reading error of the interstar angles that no chance explains.

A mirrored photograph keeps its interstar angles and fits no attitude. The few
angles of four stars or less tell their reading error roughly: of 400 good
photographs of three stars, five had a ratio above 5."""

CHANCE = 1e-4
"""Chance below which a reading sigma is wrong (chi-square test)."""


class Plausibility(NamedTuple):
    """Whether the residuals of a photograph are plausible, and which mistake explains them if not.

    Attributes:
        sigma: standard deviation of the residuals, image units; infinite without a solution
        expected: what they should be, as a clause; empty if they are plausible
        mistake: the mistake that mends them best, if one does
        outliers: stars that do not fit the others, if no other mistake explains them
    """

    sigma: float
    expected: str = ""
    mistake: UsualMistake | None = None
    outliers: tuple[Outlier, ...] = ()

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
        stars: its problem, three stars or more
        reading_sigma: standard deviation of an image coordinate, if it is known, image units
        axes: how the file's image coordinates were read
        start: how the search for stars that do not fit begins

    Returns:
        What was found.
    """
    fit = fit_attitude(stars)
    sigma = float(np.sqrt(fit.variance_mm2))
    outliers = find_outliers(stars, start=start)
    mends = mended_mistakes(file, stars, fit, outliers, axes)
    mistake = min(mends, key=lambda mend: mend.sigma, default=None)
    about_stars = mistake is None or mistake.stars
    kept = tuple(outliers) if about_stars else ()
    expected = _implausible(fit, stars, reading_sigma, file.unit)
    if not expected and mistake is not None:
        expected = f"mending the mistake named below leaves {mistake.sigma:.3g} {file.unit}"
    return Plausibility(sigma, expected, mistake, kept)


def _implausible(fit: AttitudeFit, stars: StarField, reading_sigma: float | None, unit: str) -> str:
    """What the residuals should be, as a clause; empty if they are plausible."""
    focal = float(stars.focal_length_mm[0])
    if reading_sigma is not None:
        from scipy.special import chdtrc  # slow to import, and most files do without

        ratio = fit.variance_mm2 / reading_sigma**2
        large = chdtrc(fit.freedom, fit.freedom * ratio) < CHANCE
        return f"--reading-sigma allows {reading_sigma:.3g} {unit}" if large else ""
    interstar = interstar_reading_sigma_mm(stars)
    ratio = MIRROR_RATIO if int(stars.count) > FEW else MIRROR_RATIO_OF_FEW
    if fit.variance_mm2 > max(ratio * interstar, 1e-6 * focal) ** 2:
        return f"the interstar angles allow {interstar:.3g} {unit}"
    if fit.variance_mm2 > (LARGEST_RESIDUAL * focal) ** 2:
        return f"a photograph allows {LARGEST_RESIDUAL * focal:.3g} {unit} at most"
    return ""
