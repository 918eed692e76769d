"""Figures of attitude histories, frames and stars, drawn with matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from vopd.attitude.history import History
from vopd.figures.attitude import (
    NO_ATTACK,
    draw_attack,
    draw_attitude,
    has_attack,
    shows_attack,
    single_frames,
)
from vopd.figures.image import Photograph as Photograph
from vopd.figures.image import draw_image
from vopd.figures.map import draw_map
from vopd.figures.patches import draw_patches, has_patches
from vopd.figures.residuals import draw_residuals
from vopd.figures.style import Inches, matplotlib_figure, ready, wrapped
from vopd.findings import VopdError, refuse_other_kind

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Choose the jobs that a figure shows: of many, those that a person should look at first.

MOST_DRAWN = 20
"""Jobs of one figure: with more, none can be told from another, and each takes .2 s."""

WORST = "the most frames that did not converge, misfit or have a flag"


def drawn_jobs(histories: Sequence[History]) -> list[History]:
    """Select the jobs to draw: all, or of more than `MOST_DRAWN` the worst, in their order.

    Args:
        histories: the jobs
    """
    if len(histories) <= MOST_DRAWN:
        return list(histories)
    have = [k for k, one in enumerate(histories) if one.has_attitude.any()]
    have.sort(key=lambda k: _badness(histories[k]), reverse=True)
    return [histories[k] for k in sorted(have[:MOST_DRAWN])]


def left_out_text(histories: Sequence[History]) -> str:
    """Say which jobs a figure shows if it does not show all; else empty.

    Args:
        histories: the jobs
    """
    drawn = len(drawn_jobs(histories))
    return "" if drawn == len(histories) else f"{drawn} of {len(histories)} jobs, with {WORST}"


def _badness(history: History) -> tuple[int, int, int]:
    """Count the frames that did not converge, misfit, and have any flag."""
    raised = history.flags.raised
    return (
        int(raised["not_converged"].sum()),
        int(raised["misfit"].sum()),
        int(history.flags.any().sum()),
    )


# Figures by their names


class FigureKind(NamedTuple):
    """A kind of figure. Sizes are width, height."""

    draw: Callable[[Any, Sequence[History], int | str | None, Any], str]
    """Takes the figure, the jobs, a frame, what reads photographs; gives lines below the title."""
    title: str
    size_in: Inches
    least_in: Inches  # smaller ones cannot hold its panels and their labels
    column_in: Inches | None = None
    """The smallest with its panels one below the other, as a telephone or a column of text has
    room for; None: it has no such form."""


WIDTH_IN, TABLE_IN, ROW_IN = 9.0, 3.5, 0.25
"""Inches: width of a figure, height of a table of one job in its place, and of a further job."""

FIGURES = {
    "attitude": FigureKind(draw_attitude, "Attitude", (9.0, 8.0), (7.5, 6.0)),
    "attack": FigureKind(draw_attack, "Angles of attack", (9.0, 7.0), (5.0, 5.5)),
    "residuals": FigureKind(draw_residuals, "Residuals", (9.0, 7.0), (8.0, 5.0), (4.0, 8.0)),
    "image": FigureKind(draw_image, "One frame's image", (9.0, 6.5), (6.0, 4.0)),
    "map": FigureKind(draw_map, "Map", (9.0, 9.0), (7.0, 6.5)),
    "patches": FigureKind(draw_patches, "Patches", (9.0, 6.0), (7.0, 4.0), (4.0, 5.0)),
}
"""Every kind of figure by its name."""

OF_CLICKS = ("patches",)
"""Those that only clicks followed through a video have."""
OF_ONE_FRAME = ("image", "map", "patches")


def _as_names(name: str | Sequence[str]) -> list[str]:
    """List names of figures.

    Raises:
        VopdError: where there is no such figure
    """
    refuse_other_kind(name, (str, Sequence), "plot", "the name of a figure, or several")
    names = [name] if isinstance(name, str) else list(name)
    if not names:
        raise VopdError(f"no figure is named: there are {', '.join(FIGURES)}, and all")
    for one in names:
        if one not in (*FIGURES, "all"):
            raise VopdError(f"no figure {one!r}: there are {', '.join(FIGURES)}, and all")
    return names


def figure_names(name: str | Sequence[str], histories: Sequence[History]) -> list[str]:
    """List the figures that a name stands for; of all those that some job can have.

    Args:
        name: of `FIGURES`, several, or "all"
        histories: the jobs

    Raises:
        VopdError: where there is no such figure
    """
    names = _as_names(name)
    if "all" not in names:
        return list(dict.fromkeys(names))
    missing: set[str] = set() if shows_attack(drawn_jobs(histories)) else {"attack"}
    missing |= set() if any(h.estimate.scene for h in histories) else {"map"}
    missing |= set() if has_patches(histories) else {"patches"}
    return [one for one in FIGURES if one not in missing]


def draw(
    name: str | Sequence[str],
    histories: Sequence[History],
    frame: int | str | None = None,
    size_in: Inches | None = None,
    photograph: Photograph | Literal[False] | None = None,
) -> Figure:
    """Draw figures of `FIGURES`, several one below the other.

    Args:
        name: of `FIGURES`, several names, or "all"
        histories: one or more jobs; of many the worst are drawn (`drawn_jobs`)
        frame: number, or name, of the frame whose image and view are drawn, in the first job
            that has it; None takes the frame with the most landmarks
        size_in: width and height, inches; None takes the usual size
        photograph: reads the photograph of a frame, by its number and its image's name, as a PIL
            image; None takes those that the project names, false draws none

    Raises:
        VopdError: where matplotlib is not installed, there is no such figure, no frame has an
            attitude, that frame has none, no frame has angles of attack for `attack`, or the size
            cannot hold the panels
    """
    takes = "attitude histories, as run.histories() and [flight.history()]"
    refuse_other_kind(histories, Sequence, "vopd.figures.draw", takes)
    for history in histories:
        refuse_other_kind(history, History, "vopd.figures.draw", takes)
    if not any(h.has_attitude.any() for h in histories):
        ready()
        raise VopdError("no frame has an attitude")
    refuse_small(name, size_in)
    names = figure_names(name, histories)
    drawn, left_out = drawn_jobs(histories), left_out_text(histories)
    if "attack" in names and not has_attack(drawn):
        raise VopdError(NO_ATTACK)
    tables = ("attitude", "attack") if single_frames(drawn) else ()
    table_in = TABLE_IN + ROW_IN * max(len(drawn) - 1, 0)
    heights = [table_in if one in tables else FIGURES[one].size_in[1] for one in names]
    width_in = size_in[0] if size_in else WIDTH_IN
    with matplotlib_figure(size_in or (width_in, sum(heights))) as figure:
        parts = figure.subfigures(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, part in zip(names, parts, strict=True):
            kind = FIGURES[one]
            if one in OF_ONE_FRAME:  # which can be that of any job
                more = kind.draw(part, histories, frame, photograph)
            else:
                more = kind.draw(part, drawn, frame, photograph) + (left_out and f"\n{left_out}")
            part.suptitle(wrapped(f"{kind.title}\n{more}", width_in), fontsize="medium")
    made: Figure = figure
    return made


def least_size_in(name: str | Sequence[str]) -> Inches:
    """Find the smallest width and height, inches, of a figure, of several, or of "all"."""
    names = _as_names(name)
    if "all" in names:
        names = [one for one in FIGURES if one not in OF_CLICKS]
    kinds = [FIGURES[one] for one in names]
    if len(kinds) == 1:
        return kinds[0].least_in
    total = sum(kind.size_in[1] for kind in kinds)
    stretch = max(kind.least_in[1] / kind.size_in[1] for kind in kinds)
    return max(kind.least_in[0] for kind in kinds), round(total * stretch, 1)


def refuse_small(name: str | Sequence[str], size_in: Inches | None) -> None:
    """Check that a figure fits in a size.

    Raises:
        VopdError: where it does not, with the smallest size that does
    """
    names = _as_names(name)
    alone = names[0] in FIGURES and len(names) == 1
    column_in = FIGURES[names[0]].column_in if alone else None
    least = [one for one in (least_size_in(name), column_in) if one is not None]
    if size_in is not None and not any(
        size_in[0] >= width and size_in[1] >= height for width, height in least
    ):
        sizes = ", or ".join(f"{width:g}x{height:g}" for width, height in least)
        raise VopdError(
            f"the figure {', '.join(names)!r} does not fit in {size_in[0]:g}x{size_in[1]:g} "
            f"inches: the smallest size is {sizes}"
        )
