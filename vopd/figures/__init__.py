"""Pictures of attitude histories, with matplotlib; nothing is imported before it is drawn.

Every picture takes all histories it is given, those of several jobs and decks
too. Lines break where frames are missing, between jobs, and at a wrap.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from vopd.attitude.history import History
from vopd.findings import VopdError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURES = {
    "attitude": ("Camera and vehicle attitude", "histories", (9.0, 8.0)),
    "attack": ("Angles of attack", "histories", (9.0, 7.0)),
    "residuals": ("Residuals by landmark", "residuals", (9.0, 5.0)),
    "image": ("One frame's image", "image", (9.0, 6.5)),
}
"""Every picture: its title, the module whose function of its name draws it, its size in inches."""

SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED: dict[str, dict[str, Any]] = {  # the same picture is the same file
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def draw(
    name: str,
    histories: Sequence[History],
    frame: int | None = None,
    size_in: tuple[float, float] | None = None,
) -> Figure:
    """One picture of `FIGURES`, or `all` of them one below the other.

    `frame` is the number of the frame whose image is drawn, in the first job
    that has it; by default the one with the most landmarks. Raises `VopdError`
    where matplotlib is not installed, no frame has an attitude, or that frame
    has none.
    """
    figure_class, style = _matplotlib()
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame is left with an attitude")
    names = list(FIGURES) if name == "all" else [name]
    heights = [FIGURES[one][2][1] for one in names]
    with style():
        figure = figure_class(figsize=size_in or (9.0, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, part in zip(names, parts, strict=True):
            title, module, _ = FIGURES[one]
            function: Callable[..., str] = getattr(import_module(f"vopd.figures.{module}"), one)
            more = function(part, histories, frame)
            part.suptitle(f"{title}\n{more}", fontsize="medium")
    return figure  # type: ignore[no-any-return]


def save(figure: Figure, suffix: str, dpi: int = 150) -> bytes:
    """The picture as a file of `SUFFIXES`; the same picture gives the same .png."""
    _, style = _matplotlib()
    file = io.BytesIO()
    with style():
        figure.savefig(file, format=suffix[1:], metadata=_UNDATED[suffix], dpi=dpi)
    return _renamed(file.getvalue()) if suffix == ".svg" else file.getvalue()


def _renamed(text: bytes) -> bytes:
    """The SVG with its ids in order: matplotlib makes some of where things lie in memory."""
    ids = dict.fromkeys(re.findall(rb'\bid="([^"]+)"', text))
    names = {old: b"v%d" % number for number, old in enumerate(ids)}
    return re.sub(rb'(\bid="|#)([^"#)]+)(?=["\)])', lambda m: m[1] + names.get(m[2], m[2]), text)


def svg(figure: Figure) -> str:
    """The picture as SVG text."""
    return save(figure, ".svg").decode("utf-8")


def ready() -> None:
    """Raise `VopdError` where matplotlib is not installed."""
    _matplotlib()


def _matplotlib() -> tuple[Any, Any]:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise VopdError("matplotlib is not installed: pip install 'vopd[plots]'") from error
    from vopd.figures.style import style

    return Figure, style
