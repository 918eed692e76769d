"""`vopd plot`: the figures of flights, decks and star photographs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from vopd.cli.console import notes
from vopd.cli.histories import collect_histories
from vopd.cli.options import (
    FILE_NAME,
    SharedOptions,
    WholeRange,
    history_options,
    output_option,
    sources_argument,
)
from vopd.cli.output import refuse_to_overwrite
from vopd.figures import (
    FIGURES,
    MOST_DRAWN,
    OF_ONE_FRAME,
    draw,
    figure_names,
    left_out_text,
    refuse_small,
)
from vopd.figures.image import FRAME_SHOWN
from vopd.figures.stars import StarPicture, draw_star_residuals
from vopd.figures.style import SUFFIXES, Inches, ready, save, short
from vopd.files import whole_file
from vopd.findings import VopdError, count_text, size_text

if TYPE_CHECKING:
    from vopd.figures import Photograph
    from vopd.stellar.files.picture import StarCamera
    from vopd.stellar.files.table import ReadSolution


# What `vopd plot` draws of star photographs: the residuals over the image.


def plot_stars(
    names: Sequence[str],
    frame: str | None,
    size_in: tuple[float, float] | None,
    images: str | None = None,
) -> tuple[Any, list[str]]:
    """Draw one solution: of the photograph asked for, or of that with the most stars.

    Args:
        names: files that `vopd stars solve --format json` wrote
        frame: the photograph's name
        size_in: width and height, inches
        images: the photograph, or a folder that it is in; None: beside the star file

    Returns:
        The figure, and warnings of why the solution is doubtful.

    Raises:
        VopdError: no such photograph, or a file is not such a file.
    """
    from vopd.stellar.files.table import read_solutions

    found = [(name, one) for name in names for one in read_solutions(name)]
    wanted = [pair for pair in found if frame in (None, pair[1].image)]
    if not wanted:
        known = ", ".join(dict.fromkeys(one.image for _, one in found if one.image))
        raise VopdError(f"no photograph {frame}" + (f": there are {known}" if known else ""))
    name, solution = max(wanted, key=lambda pair: len(pair[1].images))
    figure = draw_star_residuals(_picture(name, solution, images), size_in)
    return figure, [f"warning: {name}: {text}" for text in solution.doubtful]


def _picture(name: str, one: ReadSolution, images: str | None) -> StarPicture:
    alpha, delta, swing = one.pointing
    image = f", {short(one.image, FRAME_SHOWN)}" if one.image else ""
    about = one.picture
    point, axes = ("star", "") if about is None or about.sky else ("ground point", " in their axes")
    from vopd.stellar.files.text import hours_text

    angles = zip(("alpha", "delta", "swing"), (alpha, delta, swing), one.half_95_deg, strict=True)
    told = [f"{name} {_with_half(angle, half)}" for name, angle, half in angles]
    if point == "star":
        told[0] += f" ({hours_text(alpha % 360.0, 0)})"
    rms = float(np.sqrt(np.mean(one.residuals**2)))
    title = (
        f"{name}{image}: {one.method}, {count_text(len(one.images), point)}, "
        f"rms of a coordinate {size_text(rms, 3)} {one.unit}\n{', '.join(told)} degrees{axes}"
    )
    if None in one.half_95_deg:
        title += "; no uncertainty is known"
    else:
        title += "; ± is half of the 95 % interval"
    title = "\n".join([title, *(f"doubtful: {text}" for text in one.doubtful[:MOST_DOUBTS])])
    if about is None:  # of an earlier version
        return StarPicture(title, one.images, one.residuals, one.labels, one.unit)
    measured = np.vstack([one.images, *(image for _, _, image, _ in about.left_out)])
    residual = np.vstack([one.residuals, *(off for *_, off in about.left_out)])
    numbers = [*one.numbers, *(number for number, *_ in about.left_out)]
    labels = (*one.labels, *(label for _, label, *_ in about.left_out))
    drawn = StarPicture(
        title, measured, residual, labels, one.unit, [star in about.odd for star in numbers],
        [k >= len(one.images) for k in range(len(measured))],
    )  # fmt: skip
    in_file = one.unit == "px"
    sky = partial(about.sky_at, in_file=in_file) if about.sky else None
    drawn = drawn._replace(sky=sky, epoch=one.epoch.partition(",")[0], point=point)
    if not in_file:
        return drawn
    at, computed = about.in_file(measured), about.in_file(measured - residual)
    if not (np.isfinite(at).all() and np.isfinite(computed).all()):
        return drawn  # a star lies outside the field in which the lens can be inverted
    drawn = drawn._replace(
        images=at, residuals=at - computed, centre=tuple(about.centre.tolist()), in_file=True,
        y_down=about.y_down,
    )  # fmt: skip
    photograph, said = _star_photograph(one, about, images)
    size_px = None if about.size_px is None else tuple(about.size_px.tolist())
    if photograph is not None and size_px not in (None, photograph.size):
        said = f"photograph: {photograph.size[0]} x {photograph.size[1]}, not the size stated"
    size_px = size_px or (photograph.size if photograph is not None else None)
    if size_px is not None:
        first = about.first_centre_px - 0.5
        right, far = (first + size for size in size_px)
        edges = (first, right, far, first) if about.y_down else (first, right, first, far)
        drawn = drawn._replace(edges=edges, photograph=photograph)
    return drawn._replace(title=f"{title}\n{said}" if said else title)


MOST_DOUBTS = 2  # of a solution, in the title


def _with_half(angle: float, half: float | None) -> str:
    """Write an angle and half of its interval; without one to two decimals."""
    from vopd.stellar.files.text import with_half

    return with_half(angle, half, 2)[0] if half is None else " ± ".join(with_half(angle, half))


def _star_photograph(one: ReadSolution, about: StarCamera, images: str | None) -> tuple[Any, str]:
    """Read the photograph of a solution as a PIL image, or say why there is none."""
    from vopd.flight.formats.photographs import image_file, image_places
    from vopd.video import open_frames

    beside = Path(about.source).parent if images is None else Path(images)
    name = PurePath(one.image.removeprefix(f"{about.source}: ")).name
    given = images is not None and beside.is_file()
    found = beside if given else image_file(image_places([beside]), name)
    if found is None or (not name and not beside.is_file()):
        return None, "" if images is None else f"no photograph {name or 'named'} in {images}"
    try:
        (photograph,) = open_frames([str(found)]).pictures([0])
    except VopdError as error:
        return None, "" if images is None else f"no photograph: {error}"
    return photograph, ""


# `vopd plot`: draw the attitude history of flights and decks.

STAR_SOLUTION = ".json"  # the suffix of what `vopd stars solve` writes for this command
LARGEST_IN, LARGEST_DOTS = 100.0, 20_000


@click.command("plot")
@sources_argument
@output_option("The figure: .png, .svg or .pdf; - is standard output.", required=True)
@click.option(
    "--format",
    "form",
    type=click.Choice([suffix[1:] for suffix in SUFFIXES]),
    help="By default what FILE's suffix says.",
)
@click.option(
    "--figure",
    "names",
    type=click.Choice(["all", *FIGURES]),
    default=("all",),
    multiple=True,
    show_default=True,
    help="Which figure; may be repeated. A .pdf has a page for each; in other files they stand "
    "one below the other.",
)
@click.option(
    "--frame",
    metavar="N",
    help="The frame of image and map. By default the one with the most landmarks; if several "
    "have as many, in a tracked video the one that fits worst.",
)
@click.option(
    "--images",
    type=FILE_NAME,
    metavar="FILE",
    help="The photographs: a folder of images, or a video, if the project does not name them.",
)
@click.option(
    "--job",
    type=WholeRange(min=1),
    metavar="N",
    help="Draw only this job of each deck, counted from 1. Without it, the worst "
    f"{MOST_DRAWN} of more than {MOST_DRAWN} jobs are drawn.",
)
@click.option("--size", metavar="WxH", help="Width and height in inches, for instance 9x6.")
@click.option(
    "--dpi",
    type=WholeRange(20, 1200),
    help="Resolution of a .png, dots per inch.  [default: 150]",
)
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    sources: tuple[str, ...],
    output: str,
    form: str | None,
    names: tuple[str, ...],
    frame: str | None,
    images: str | None,
    job: int | None,
    size: str | None,
    dpi: int | None,
    options: SharedOptions,
) -> None:
    """Draw the image of a frame, the map, the attitude against time, and the residuals.

    SOURCE is a flight project, whose name ends in .toml, or a deck of 80-column
    cards; - is a deck on standard input. It can also be a file of star solutions,
    written by vopd stars solve -o FILE.json. Then --frame names the photograph to
    draw, and --images its file or folder, if it is not beside the star file.

    \b
    The figures, and the question that each answers:
      attitude   where did it point, how sure is that, and which frames are doubtful?
      attack     at which angles did it meet the air? Left out without a velocity
      residuals  which landmark does not fit, from when on, and is sigma right?
      image      do picks and computed places of landmarks meet in the photograph?
      map        where are camera and landmarks, and do the lines of sight meet them?
      patches    did each landmark stay the same through the video? Only after vopd track

    The photograph comes from the project: an image that the picks name, in the
    project's folder or a folder within it, or a frame of [picks] video. Otherwise
    --images names it. The film of a deck is drawn in mm, in the axes of the 1974
    program. If a source has only one frame, a table takes the place of the curves.
    Figures need matplotlib, photographs Pillow, videos PyAV.

    \b
    Examples:
        vopd plot examples/hill/flight.toml -o hill.png
        vopd plot flight.toml -o map.png --figure map --frame 120
        vopd plot flight.toml -o look.pdf --figure image --figure map
        vopd plot flight.toml -o image.png --figure image --images photographs
        vopd plot decks/appendix_h/case4.dat -o case4.svg --figure attitude
        vopd demo | vopd plot - -o - --format png | display

    Exit status: 0 the figure is drawn; 1 a source could not be read or
    solved, or nothing can be drawn; 2 wrong usage; 3 the figure is drawn, but some
    frame did not converge, a flight or star photograph misfits, or with --strict some
    frame has a flag.
    """
    suffix = _suffix(output, form)
    if dpi is not None and suffix != ".png":
        raise click.UsageError(f"--dpi is for .png, not {suffix}.")
    stars = any(PurePath(deck).suffix.lower() == STAR_SOLUTION for deck in sources)
    inches = _inches(("image",) if stars else names, size, dpi or 150)
    refuse_to_overwrite((*sources, *filter(None, [images])), output)
    ready()
    note = notes(options.quiet)
    if stars:
        content, status = _stars(ctx, sources, frame, images, inches, suffix, dpi or 150, note)
        with whole_file(output) as file:
            file.write(content)
        ctx.exit(status)
    for option, value in (("--frame", frame), ("--images", images)):
        if value is not None and not {"all", *OF_ONE_FRAME} & {*names}:
            one = ", ".join(OF_ONE_FRAME)
            raise click.UsageError(f"{option} is for the figures {one}, not {', '.join(names)}.")
    histories, status = collect_histories(sources, options, job=job)
    left_out = left_out_text(histories)
    if left_out and set(names) - set(OF_ONE_FRAME):
        note(f"drawn are {left_out}; --job draws another")
    scenes = [h.estimate.scene() for h in histories if images and h.estimate.scene]
    if images is not None and not any(scene.image for scene in scenes):
        raise click.UsageError(
            "--images is for flights: a deck's readings are millimetres on film. vopd new DIR "
            "--deck DECK makes a flight project of one of its jobs."
        )
    reads = None if images is None else _photographs(images)
    wanted = figure_names(names, histories)
    drawn: Any
    if suffix == ".pdf" and len(wanted) > 1:
        drawn = [draw(one, histories, frame, inches, reads) for one in wanted]
    else:
        drawn = draw(wanted, histories, frame, inches, reads)
    content = save(drawn, suffix, dpi or 150, note)
    with whole_file(output) as file:
        file.write(content)
    ctx.exit(status)


def _photographs(name: str) -> Photograph:
    """Read photographs of a folder, or frames of a video.

    Raises:
        VopdError: if it cannot be read
    """
    from vopd.video import open_frames

    frames = open_frames([name])

    def read(number: int, image: str) -> Any:
        return next(frames.pictures([frames.place(number, image)]))

    return read


def _stars(
    ctx: click.Context,
    names: tuple[str, ...],
    frame: str | None,
    images: str | None,
    inches: Inches | None,
    suffix: str,
    dpi: int,
    note: Callable[[str], None],
) -> tuple[bytes, int]:
    """Draw a star photograph: the file, and 3 as exit status if its solution is doubtful.

    Raises:
        click.UsageError: decks are named too, or an option that is for decks
    """
    if not all(PurePath(name).suffix.lower() == STAR_SOLUTION for name in names):
        raise click.UsageError("star photographs and decks are not drawn together.")
    known = ("output", "form", "frame", "images", "size", "dpi", "sources", "quiet")
    for parameter in ctx.command.params:
        source = ctx.get_parameter_source(parameter.name or "")
        if source == click.core.ParameterSource.COMMANDLINE and parameter.name not in known:
            raise click.UsageError(f"{parameter.opts[0]} is not for star photographs.")
    figure, warnings = plot_stars(names, frame, inches, images)
    for text in warnings:
        note(text)
    return save(figure, suffix, dpi, note), 3 if warnings else 0


def _suffix(output: str, form: str | None) -> str:
    if output == "-" and sys.stdout.isatty():
        raise click.UsageError("a figure is not sent to a terminal: name a file with -o.")
    suffix = f".{form}" if form else PurePath(output).suffix.lower()
    if suffix not in SUFFIXES:
        raise click.UsageError(f"{output}: name the file .png, .svg or .pdf, or give --format.")
    return suffix


def _inches(names: Sequence[str], size: str | None, dpi: int) -> Inches | None:
    if size is None:
        return None
    try:
        width, height = (float(part) for part in size.lower().replace(",", "x").split("x"))
    except ValueError:
        width = height = np.nan
    if np.isnan([width, height]).any():
        raise click.UsageError(f"--size: {size!r} is not a width and height, for instance 9x6.")
    largest = min(LARGEST_IN, LARGEST_DOTS / dpi)
    try:
        refuse_small(names[0] if len(names) == 1 else names, (width, height))
    except VopdError as error:
        raise click.UsageError(f"--size: {error}.") from error
    if not (width <= largest and height <= largest):
        raise click.UsageError(f"--size: {size!r} is more than {largest:g} inches.")
    return width, height
