"""Figures of attitude histories, frames and stars, drawn with matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from vopd.attitude.history import History
from vopd.figures.attitude import NO_ATTACK, attack, attitude, has_attack
from vopd.figures.image import image
from vopd.figures.residuals import residuals
from vopd.figures.style import Inches, matplotlib_figure
from vopd.findings import VopdError

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

    draw: Callable[[Any, Sequence[History], int | str | None], str]  # gives a line below the title
    title: str
    size_in: Inches
    least_in: Inches  # smaller ones cannot hold its panels and their labels


FIGURES = {
    "attitude": FigureKind(attitude, "Camera and vehicle attitude", (9.0, 8.0), (7.5, 6.0)),
    "attack": FigureKind(attack, "Angles of attack", (9.0, 7.0), (5.0, 5.5)),
    "residuals": FigureKind(residuals, "Residuals by landmark", (9.0, 5.0), (5.0, 3.5)),
    "image": FigureKind(image, "One frame's image", (9.0, 6.5), (6.0, 4.0)),
}
"""Every kind of figure by its name."""


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
            frame has none, no frame has angles of attack for `attack`, or the size cannot
            hold the panels
    """
    refuse_small(name, size_in)
    if not any(h.has_attitude.any() for h in histories):
        raise VopdError("no frame has an attitude")
    names = list(FIGURES) if name == "all" else [name]
    drawn, left_out = drawn_jobs(histories), left_out_text(histories)
    if name == "attack" and not has_attack(drawn):
        raise VopdError(NO_ATTACK)
    heights = [FIGURES[one].size_in[1] for one in names]
    with matplotlib_figure(size_in or (9.0, sum(heights))) as figure:
        parts = figure.subfigures(len(names), 1, height_ratios=heights, squeeze=False)[:, 0]
        for one, part in zip(names, parts, strict=True):
            kind = FIGURES[one]
            if one == "image":  # of one frame, which can be that of any job
                more = kind.draw(part, histories, frame)
            else:
                more = kind.draw(part, drawn, frame) + (left_out and f"\n{left_out}")
            part.suptitle(f"{kind.title}\n{more}", fontsize="medium")
        made: Figure = figure
    return made


def least_size_in(name: str) -> Inches:
    """Find the smallest width and height, inches, of a figure, or of "all"."""
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
