"""Draw figures of attitude histories with matplotlib, which is imported when first needed.

Every figure shows all histories it is given, those of several jobs and sources
too. Lines break where frames are missing, between jobs, and where an angle wraps.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

from vopd.attitude.history import History
from vopd.figures.drawn_jobs import drawn_jobs, left_out_text
from vopd.findings import VopdError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Inches = tuple[float, float]


class FigureKind(NamedTuple):
    """A kind of figure, drawn by the function of its name in `module`. Sizes are width, height."""

    title: str
    module: str
    size_in: Inches
    least_in: Inches  # smaller ones cannot hold its panels and their labels


FIGURES = {
    "attitude": FigureKind(
        "Camera and vehicle attitude", "angles_against_time", (9.0, 8.0), (7.5, 6.0)
    ),
    "attack": FigureKind("Angles of attack", "angles_against_time", (9.0, 7.0), (5.0, 5.5)),
    "residuals": FigureKind(
        "Residuals by landmark", "residuals_by_landmark", (9.0, 5.0), (5.0, 3.5)
    ),
    "image": FigureKind("One frame's image", "frame_image", (9.0, 6.5), (6.0, 4.0)),
}
"""Every kind of figure by its name."""

SUFFIXES = (".png", ".svg", ".pdf")
_UNDATED: dict[str, dict[str, Any]] = {  # without dates, so that the same figure is the same file
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def draw(
    name: str,
    histories: Sequence[History],
    frame: int | str | None = None,
    size_in: Inches | None = None,
) -> Figure:
    """Draw one figure of `FIGURES`, or `all` of them one below the other.

    Args:
        name: of `FIGURES`, or "all"
        histories: one or more jobs; of many the worst are drawn (`drawn_jobs`)
        frame: number, or name, of the frame whose image is drawn, in the first job
            that has it; None takes the frame with the most landmarks
        size_in: width and height, inches; None takes the usual size

    Raises:
        VopdError: where matplotlib is not installed, no frame has an attitude, that
            frame has none, or the size cannot hold the panels
    """
    refuse_small(name, size_in)
    figure_class, style = _matplotlib()
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    names = list(FIGURES) if name == "all" else [name]
    drawn, left_out = drawn_jobs(histories), left_out_text(histories)
    heights = [FIGURES[one].size_in[1] for one in names]
    with style():
        figure = figure_class(figsize=size_in or (9.0, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, part in zip(names, parts, strict=True):
            kind = FIGURES[one]
            module = import_module(f"vopd.figures.{kind.module}")
            function: Callable[..., str] = getattr(module, one)
            if one == "image":  # of one frame, which can be that of any job
                more = function(part, histories, frame)
            else:
                more = function(part, drawn, frame) + (left_out and f"\n{left_out}")
            part.suptitle(f"{kind.title}\n{more}", fontsize="medium")
    return figure  # type: ignore[no-any-return]


@contextmanager
def matplotlib_figure(size_in: Inches) -> Iterator[Any]:
    """A new figure to draw in, with the style of all figures in force.

    Args:
        size_in: width and height, inches

    Raises:
        VopdError: where matplotlib is not installed
    """
    figure_class, style = _matplotlib()
    with style():
        yield figure_class(figsize=size_in, layout="constrained")


def least_size_in(name: str) -> Inches:
    """The smallest width and height, inches, of a figure of that name, or of "all"."""
    if name != "all":
        return FIGURES[name].least_in
    total = sum(kind.size_in[1] for kind in FIGURES.values())
    stretch = max(kind.least_in[1] / kind.size_in[1] for kind in FIGURES.values())
    return max(kind.least_in[0] for kind in FIGURES.values()), round(total * stretch, 1)


def refuse_small(name: str, size_in: Inches | None) -> None:
    """Check that a figure fits in a size.

    Raises:
        VopdError: where it does not, with the smallest size that does
    """
    width, height = least_size_in(name)
    if size_in is not None and not (size_in[0] >= width and size_in[1] >= height):
        raise VopdError(
            f"the figure {name!r} does not fit in {size_in[0]:g}x{size_in[1]:g} inches: "
            f"the smallest size is {width:g}x{height:g}"
        )


def save(figure: Figure, suffix: str, dpi: int = 150) -> bytes:
    """Write the figure to a file; the same figure always gives the same bytes.

    Args:
        figure: what `draw` has made
        suffix: of `SUFFIXES`
        dpi: dots an inch, for .png
    """
    _, style = _matplotlib()
    file = io.BytesIO()
    with style():
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine(None)  # with one, savefig draws everything twice
        figure.savefig(file, format=suffix[1:], metadata=_UNDATED[suffix], dpi=dpi)
        figure.set_layout_engine(engine)
    return _renamed(file.getvalue()) if suffix == ".svg" else file.getvalue()


def _renamed(text: bytes) -> bytes:
    """The SVG with its ids numbered in order: some of matplotlib's depend on memory addresses."""
    ids = dict.fromkeys(re.findall(rb'\bid="([^"]+)"', text))
    names = {old: b"v%d" % number for number, old in enumerate(ids)}
    return re.sub(rb'(\bid="|#)([^"#)]+)(?=["\)])', lambda m: m[1] + names.get(m[2], m[2]), text)


def svg(figure: Figure) -> str:
    """The figure as SVG text."""
    return save(figure, ".svg").decode("utf-8")


def ready() -> None:
    """Check that matplotlib is installed.

    Raises:
        VopdError: where matplotlib is not installed
    """
    _matplotlib()


def _matplotlib() -> tuple[Any, Any]:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise VopdError("matplotlib is not installed: pip install 'vopd[plots]'") from error
    from vopd.figures.style import style

    return Figure, style
