"""The errors of the images of a star file: from its columns of sigma, magnitude and elongation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding
from vopd.stellar.files.star_file import StarFile

LEAST_ELONGATION = 1.0


class ErrorModel(NamedTuple):
    """How the reading error of a star depends on the star.

    Attributes:
        magnitude_limit: the magnitude at which the noise of the star's light is as
            large as all other errors together; None: errors do not depend on it
        by_elongation: whether errors grow with the length of an image over its width
    """

    magnitude_limit: float | None = None
    by_elongation: bool = False


class ReadingErrors(NamedTuple):
    """Errors of the images of one photograph.

    Attributes:
        relative: covariance matrices of x and y for a reading sigma of 1, (n, 2, 2);
            None where all are alike
        sigma: the reading sigma, image units; None where the file does not state it
    """

    relative: Floats | None = None
    sigma: float | None = None


def reading_errors(file: StarFile, model: ErrorModel, *, flipped: bool) -> ReadingErrors:
    """The errors of a file's images.

    The noise of a star's light falls with the root of its brightness, so that the
    variance at magnitude m is 1 + 10**(0.4 (m - limit)) times that of a bright star.
    The sigma of an elongated image is multiplied by its elongation. Where the file
    states standard deviations the reading sigma is their root mean square.

    Args:
        file: the file
        model: how errors depend on the star
        flipped: whether y is turned, and with it the sign of the correlation

    Raises:
        DeckError: a star lacks the magnitude or elongation that is asked for.

    Source: Rae (1987), eqs. 2.13 and 3.13, recommendations 1 and 2.
    """
    factor = np.ones(len(file.lines))
    if model.magnitude_limit is not None:
        magnitude = _known(file, file.magnitude, "mag", "--magnitude-limit")
        factor *= 1.0 + 10.0 ** (0.4 * np.clip(magnitude - model.magnitude_limit, -50.0, 50.0))
    if model.by_elongation:
        elongation = _known(file, file.elongation, "elongation", "--weigh-elongation")
        short = np.flatnonzero(elongation < LEAST_ELONGATION)
        if short.size:
            raise file.error("elongation: length over width is 1 or more", int(short[0]))
        factor *= elongation**2
    if file.sigmas is None:
        if (factor == factor[0]).all():
            return ReadingErrors()
        return ReadingErrors(factor[:, None, None] / factor.mean() * np.eye(2))
    x, y, correlation = file.sigmas.T
    mixed = x * y * (-correlation if flipped else correlation)
    covariance = np.stack([np.stack([x**2, mixed], -1), np.stack([mixed, y**2], -1)], axis=-2)
    covariance *= factor[:, None, None]
    mean = float(np.trace(covariance, axis1=1, axis2=2).mean() / 2.0)
    return ReadingErrors(covariance / mean, mean**0.5)


def _known(file: StarFile, values: Floats | None, column: str, option: str) -> Floats:
    """A column that every star needs."""
    if values is None:
        message = f"{option} needs a column {column}"
        raise DeckError(Finding(message, deck=file.deck))
    missing = np.flatnonzero(~np.isfinite(values))
    if missing.size:
        raise file.error(f"{option} needs {column}", int(missing[0]))
    return values
