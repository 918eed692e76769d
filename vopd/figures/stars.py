"""Photographs of stars, and the errors of several methods for every pair of stars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Units
from vopd.figures.image import ROOM, arrow_scale, residual_arrows
from vopd.figures.style import COLOURS, Inches, matplotlib_figure, plain, short

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Draw the errors of several methods for every pair of stars, one panel for each angle.

SIZE_IN = (9.0, 10.0)
MARKERS = "osD^v*"
APART = 0.12  # distance of the methods' marks of one pair, in distances of the pairs


def draw_errors_by_pair(
    pairs: Sequence[str], methods: Sequence[str], panels: dict[str, Floats]
) -> Figure:
    """Draw panels one below the other, a mark for each pair and method.

    Args:
        pairs: names of the pairs
        methods: names of the methods
        panels: errors in degrees of each method (columns) by pair (rows), by the panel's title

    Raises:
        VopdError: where matplotlib is not installed
    """
    with matplotlib_figure(SIZE_IN) as figure:
        axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
        place = np.arange(len(pairs))
        for axis, (title, errors) in zip(axes, panels.items(), strict=True):
            axis.axhline(0.0, color="0.5", lw=0.8)
            for k, method in enumerate(methods):
                shift = (k - (len(methods) - 1) / 2.0) * APART
                axis.plot(
                    place + shift, errors[:, k], MARKERS[k % len(MARKERS)], ms=6,
                    color=COLOURS[k % len(COLOURS)], label=method,
                )  # fmt: skip
            axis.set_title(title, fontsize="medium")
            axis.set_ylabel("degrees")
            axis.set_xticks(place, pairs)
        axes[0].legend(ncols=len(methods), loc="lower center", bbox_to_anchor=(0.5, 1.12))
        drawn: Figure = figure
    return drawn


# Draw a photograph of stars: where they were read and where the attitude puts them.

STARS_SIZE_IN = (9.0, 6.5)
MOST_LABELS = 60  # above this number of stars their names would hide each other and are left out


class StarPicture(NamedTuple):
    """What is drawn of one photograph."""

    title: str  # what is solved, and how
    images: Floats  # x right and y up from the principal point, (n, 2)
    residuals: Floats  # observed minus computed, (n, 2)
    labels: Sequence[str]  # the stars' names or numbers
    unit: str  # of the images, "mm" or "px"


def draw_star_residuals(picture: StarPicture, size_in: Inches | None = None) -> Figure:
    """Draw the image of a photograph as seen from behind the camera, with its residuals as arrows.

    Raises:
        VopdError: where matplotlib is not installed
    """
    units = Units(image=picture.unit)
    if picture.unit == "px":
        units = Units(image="px", residual="px", residuals_per_image=1.0)
    images, residuals = picture.images, picture.residuals
    with matplotlib_figure(size_in or STARS_SIZE_IN) as figure:
        axis = figure.subplots()
        far = max(float(np.abs(images).max(initial=0.0)), 1e-3) * ROOM
        scale = arrow_scale(residuals, 2.0 * far)
        residual_arrows(axis, images - residuals, residuals, scale, units)
        axis.plot(*(images - residuals).T, "+", color="0.2", ms=9, label="computed")
        axis.plot(*images.T, "o", mfc="none", mec=COLOURS[0], ms=7, label="measured")
        axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label="principal point")
        if len(images) <= MOST_LABELS:
            for label, point in zip(picture.labels, images, strict=True):
                axis.annotate(plain(short(label, 40)), point, (7, 7), textcoords="offset points")
        axis.set(xlim=(-far, far), ylim=(-far, far), aspect="equal")
        axis.set_xlabel(f"x, {picture.unit} in the image, to the right")
        axis.set_ylabel(f"y, {picture.unit} in the image, up")
        axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
        arrows = f"arrows: residuals, measured minus computed, {scale:g} times as long"
        figure.suptitle(f"{plain(picture.title)}\n{arrows}", fontsize="medium")
        drawn: Figure = figure
    return drawn
