"""`vopd plot`: decks in, a picture out."""

from __future__ import annotations

from pathlib import PurePath

import click

from vopd.cli.file_options import decks_argument, output_option
from vopd.cli.histories import collect_histories
from vopd.cli.options import HistoryOptions, history_options
from vopd.cli.output import refuse_to_overwrite, whole_file
from vopd.figures import FIGURES, SUFFIXES, draw, ready, save
from vopd.findings import VopdError

LARGEST_IN, LARGEST_DOTS = 100.0, 20_000


@click.command("plot")
@decks_argument
@output_option("The picture: .png, .svg or .pdf.", required=True)
@click.option(
    "--plot",
    "name",
    type=click.Choice(["all", *FIGURES]),
    default="all",
    show_default=True,
    help="Which picture; all are one below the other.",
)
@click.option("--frame", type=int, metavar="N", help="The frame whose image is drawn.")
@click.option("--job", type=int, metavar="N", help="Only this job of each deck, from 1.")
@click.option("--size", metavar="WxH", help="Width and height in inches, as 9x6.")
@click.option(
    "--dpi", type=click.IntRange(20, 1200), help="Dots an inch of a .png.  [default: 150]"
)
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    decks: tuple[str, ...],
    output: str,
    name: str,
    frame: int | None,
    job: int | None,
    size: str | None,
    dpi: int | None,
    asked: HistoryOptions,
) -> None:
    """Draw the attitude history of card decks.

    Camera and vehicle attitude and the angles of attack against time, with bands
    of one standard deviation; residuals by landmark; and the image of one
    frame, by default that with the most landmarks. Lines break where frames are
    missing and where an angle wraps. It takes matplotlib: pip install 'vopd[plots]'.

    \b
    Examples:
        vopd plot decks/appendix_h/case4.dat -o case4.png
        vopd plot flight.dat -o image.svg --plot image --frame 120
        vopd plot flight.dat -o attack.pdf --plot attack --size 7x5

    Exit status: 0 all well; 1 a deck could not be read or its run failed, or
    nothing can be drawn; 2 wrong usage; 3 it ran, but some frame did not
    converge, or with --strict was flagged.
    """
    suffix = PurePath(output).suffix.lower()
    if suffix not in SUFFIXES:
        raise click.UsageError(f"{output}: name the file .png, .svg or .pdf.")
    if dpi is not None and suffix != ".png":
        raise click.UsageError(f"--dpi is for .png, not {suffix}.")
    inches = _inches(size, dpi or 150)
    refuse_to_overwrite(decks, output)
    ready()
    histories, status = collect_histories(decks, asked)
    if job is not None:
        histories = [one for one in histories if one.about.job == job]
        if not histories:
            raise VopdError(f"{', '.join(decks)}: no job {job}")
    content = save(draw(name, histories, frame, inches), suffix, dpi or 150)
    with whole_file(output) as file:
        file.write(content)
    ctx.exit(status)


def _inches(size: str | None, dpi: int) -> tuple[float, float] | None:
    if size is None:
        return None
    try:
        width, height = (float(part) for part in size.lower().split("x"))
    except ValueError:
        raise click.UsageError(f"--size: {size!r} is no width and height, as 9x6.") from None
    largest = min(LARGEST_IN, LARGEST_DOTS / dpi)
    if not (1.0 <= width <= largest and 1.0 <= height <= largest):
        raise click.UsageError(f"--size: {size!r} is not within 1 and {largest:g} inches.")
    return width, height
