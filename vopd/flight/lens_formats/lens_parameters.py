"""Lenses from the numbers that files hold, on the grid whose (0, 0) is the first pixel's centre."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.flight.files import InputFile
from vopd.geometry.lenses import Lens, LensKind

GRID_TO_CENTRE = {"centre": 0.0, "corner": -0.5, "one-based": -1.0}
"""What is added to u and v of a grid, by its name, to count from the first pixel's centre."""


class LensQuestion(NamedTuple):
    """What the project says of a lens besides the file."""

    model: str | None = None  # brown or fisheye, where the file cannot say
    camera: str | None = None  # which camera of a file with several
    size_px: tuple[int, int] | None = None


class LensRead(NamedTuple):
    """A lens, and a sentence about what was read."""

    lens: Lens
    said: str


def make_lens(
    model: str,
    size_px: tuple[int, int],
    focal: Sequence[float],
    centre: Sequence[float],
    k: Sequence[float] = (),
    skew_px: float = 0.0,
) -> Lens:
    """A lens of the models brown and fisheye.

    Args:
        model: brown or fisheye
        size_px: width and height
        focal: fx, fy, pixels
        centre: cx, cy, pixels from the first pixel's centre
        k: coefficients in OpenCV's order, as many as there are
        skew_px: of u by yd
    """
    kind = LensKind(model)
    count = 4 if kind is LensKind.FISHEYE else 12
    coefficients = np.zeros(count)
    coefficients[: len(k)] = k
    return Lens(
        kind, size_px, np.array(focal, float), np.array(centre, float), coefficients, skew_px
    )


def checked(file: InputFile, lens: Lens) -> Lens:
    """The lens, if its numbers can be those of one.

    Raises:
        VopdError: where they cannot
    """
    numbers = np.concatenate([lens.focal_px, lens.centre_px, lens.k, [lens.skew_px]])
    if not np.isfinite(numbers).all():
        raise file.error("the lens has a number that is not finite")
    if min(lens.size_px) < 1:
        raise file.error("the image's size is {} x {} px".format(*lens.size_px))
    if not (lens.focal_px > 1.0).all():
        raise file.error(f"focal length {lens.focal_px.min():g} px: is it in pixels?")
    return lens


def image_centre(size_px: tuple[int, int]) -> tuple[float, float]:
    """The middle of the image, pixels from the first pixel's centre."""
    return (size_px[0] - 1) / 2.0, (size_px[1] - 1) / 2.0


def coefficients_said(k: Sequence[float], model: str) -> str:
    """How many coefficients, for a sentence."""
    count = len(k)
    named = "no distortion" if not count else f"{count} coefficient{'s'[: count != 1]}"
    return f"{model}, {named}"
