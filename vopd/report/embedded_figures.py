"""Draw the figures of the report as data URIs, or say why there are none."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from typing import NamedTuple

from vopd.attitude.history import History
from vopd.figures import FIGURES, draw, ready, svg
from vopd.findings import VopdError

CAPTIONS = {
    "attitude": "Camera and vehicle yaw, pitch and roll against time, with bands of 95 %.",
    "attack": "Alpha, beta and eta against time, with bands of 95 %; eta is never below 0.",
    "residuals": "Residuals x and y of every frame, a column for each landmark; the numbers are in "
    "the table of landmarks.",
    "image": "One frame's landmarks, measured and computed, with their residuals.",
}


class EmbeddedFigure(NamedTuple):
    """A figure of the page; `data` is its SVG as a data URI."""

    name: str
    title: str
    caption: str
    data: str


class NoFigures(NamedTuple):
    """Why the page has no figures."""

    reason: str


def embedded_figures(histories: Sequence[History]) -> list[EmbeddedFigure] | NoFigures:
    """Every figure of `FIGURES`."""
    try:
        ready()
    except VopdError as error:
        return NoFigures(str(error))
    return [
        EmbeddedFigure(name, kind.title, CAPTIONS[name], _data(svg(draw(name, histories))))
        for name, kind in FIGURES.items()
    ]


def _data(picture: str) -> str:
    return "data:image/svg+xml;base64," + base64.b64encode(picture.encode()).decode()
