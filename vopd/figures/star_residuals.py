"""Draw a photograph of stars: where they were read and where the attitude puts them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Units
from vopd.figures import Inches, matplotlib_figure
from vopd.figures.frame_image import ROOM, arrow_scale, residual_arrows
from vopd.figures.style import COLOURS, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE_IN = (9.0, 6.5)
MOST_LABELS = 60
"""Above this number of stars their names would hide each other and are left out."""


class StarPicture(NamedTuple):
    """What is drawn of one photograph.

    Attributes:
        title: what is solved, and how
        images: x right and y up from the principal point, (n, 2)
        residuals: observed minus computed, (n, 2)
        labels: the stars' names or numbers
        unit: of the images, "mm" or "px"
    """

    title: str
    images: Floats
    residuals: Floats
    labels: Sequence[str]
    unit: str


def draw_star_residuals(picture: StarPicture, size_in: Inches | None = None) -> Figure:
    """Draw the image of a photograph as seen from behind the camera, with its residuals as arrows.

    Args:
        picture: what to draw
        size_in: width and height, inches

    Raises:
        VopdError: where matplotlib is not installed
    """
    units = Units(image=picture.unit)
    if picture.unit == "px":
        units = Units(image="px", residual="px", residuals_per_image=1.0)
    images, residuals = picture.images, picture.residuals
    with matplotlib_figure(size_in or SIZE_IN) as figure:
        axis = figure.subplots()
        far = max(float(np.abs(images).max(initial=0.0)), 1e-3) * ROOM
        scale = arrow_scale(residuals, 2.0 * far)
        residual_arrows(axis, images - residuals, residuals, scale, units)
        axis.plot(*(images - residuals).T, "+", color="0.2", ms=9, label="computed")
        axis.plot(*images.T, "o", mfc="none", mec=COLOURS[0], ms=7, label="measured")
        axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label="principal point")
        if len(images) <= MOST_LABELS:
            for label, point in zip(picture.labels, images, strict=True):
                axis.annotate(plain(label), point, (7, 7), textcoords="offset points")
        axis.set(xlim=(-far, far), ylim=(-far, far), aspect="equal")
        axis.set_xlabel(f"x, {picture.unit} in the image, to the right")
        axis.set_ylabel(f"y, {picture.unit} in the image, up")
        axis.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))
        arrows = f"arrows: residuals, measured minus computed, {scale:g} times as long"
        figure.suptitle(f"{plain(picture.title)}\n{arrows}", fontsize="medium")
        drawn: Figure = figure
    return drawn
