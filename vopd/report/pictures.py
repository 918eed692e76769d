"""The report's pictures, each as a data URI; or the sentence that says how to get them."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape

from vopd.attitude.history import History
from vopd.figures import FIGURES, draw, ready, svg
from vopd.findings import VopdError

SAYS = {
    "attitude": "Camera and vehicle yaw, pitch and roll against time, with one standard deviation.",
    "attack": "Alpha, beta and eta against time, with one standard deviation.",
    "residuals": "Residuals x and y of every frame, a column a landmark; their numbers are in "
    "the table of landmarks.",
    "image": "One frame's landmarks on the film, measured and computed, with their residuals.",
}


def pictures(histories: Sequence[History]) -> str:
    """A figure for each of `FIGURES`."""
    try:
        ready()
    except VopdError as error:
        return f"<p>No pictures: {escape(str(error))}</p>"
    made = []
    for name, (title, _, _) in FIGURES.items():
        data = base64.b64encode(svg(draw(name, histories)).encode()).decode()
        made.append(
            f'<figure id="picture-{name}"><div class="picture" tabindex="0" role="region" '
            f'aria-label="{escape(title)}"><img alt="{escape(title)}" '
            f'src="data:image/svg+xml;base64,{data}"></div>'
            f"<figcaption>{escape(SAYS[name])}</figcaption></figure>"
        )
    return "".join(made)
