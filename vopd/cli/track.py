"""`vopd track`: follow clicked landmarks through a video."""

from __future__ import annotations

import click

from vopd.cli.console import Messages, Progress
from vopd.cli.options import NUMBER, SOURCE_NAME, NumberRange, WholeRange, quiet_option
from vopd.cli.output import refuse_to_overwrite

GOES_ON = "the same command goes on"


@click.command("track")
@click.argument("project", type=SOURCE_NAME, metavar="PROJECT")
@click.option(
    "--from", "from_s", type=NUMBER, metavar="T", help="Time of the first frame, seconds."
)
@click.option("--to", "to_s", type=NUMBER, metavar="T", help="Time of the last frame, seconds.")
@click.option(
    "--every", type=WholeRange(1), default=1, metavar="N", help="Write only each Nth frame."
)
@click.option(
    "--reach",
    type=WholeRange(1, 10_000),
    default=70,
    show_default=True,
    metavar="N",
    help="Frames from a click in which it is matched beside nearer ones.",
)
@click.option(
    "--patch",
    "patch_px",
    type=WholeRange(7, 101),
    default=25,
    show_default=True,
    metavar="PX",
    help="Side of the patches, pixels.",
)
@click.option(
    "--least-correlation",
    type=NumberRange(0.0, 1.0, min_open=True, max_open=True),
    default=0.6,
    show_default=True,
    metavar="R",
    help="Correlation with its click from which a patch is found.",
)
@click.option(
    "--residual",
    "residual_px",
    type=NumberRange(0.0, 100.0, min_open=True),
    default=0.8,
    show_default=True,
    metavar="PX",
    help="How far a patch may be from where the other landmarks have it, pixels.",
)
@quiet_option
@click.pass_context
def command(
    ctx: click.Context, /, project: str, from_s: float | None, to_s: float | None, every: int,
    reach: int, patch_px: int, least_correlation: float, residual_px: float, quiet: bool,
) -> None:  # fmt: skip
    """Follow clicked landmarks through a video, for vopd attitude.

    PROJECT is a flight project. Its [picks] names three files: file, your clicks,
    as vopd pick saves them; video, which they are clicked in, or a folder of
    numbered images; and tracked, which this command writes:

    \b
        [picks]
        file = "clicks.csv"
        video = "flight.mp4"
        times = "video"
        tracked = "tracked.csv"

    Two landmarks clicked in one frame are enough to begin; six to thirty clicks
    serve a minute. Position and lens are known, so that the look of a landmark
    in any frame follows from its click: the patch around the click is laid on the
    ground, seen from where the camera is now, and found to a tenth of a pixel.
    The match is always with a click, never with the frame before: errors do not
    add up. A landmark that is hidden, at the edge or elsewhere has that as its
    status and no pixel; nothing is guessed.

    A plume over a third of the picture, and cuts, are survived; after a cut
    tracking begins anew at the next frame with two clicks. Masts need a small
    patch: a column patch_px in the landmarks, 13. Ctrl-C loses nothing: the same
    command goes on. Needs PyAV for videos, Pillow for images: pip install av.

    \b
    Examples:
        vopd track flight.toml
        vopd track flight.toml --from 10 --to 25
        vopd attitude flight.toml

    Exit status: 0 written; 1 failed; 2 wrong usage; 3 written, and doubtful.
    """
    from vopd.flight.project.keys import read_project
    from vopd.tracking.follow import TrackOptions, follow

    read = read_project(project)
    section = read.section("picks")
    if section.has("tracked"):
        output = read.folder / section.text("tracked")
        inputs = tuple(
            str(read.folder / value)
            for name, one in read.sections.items() for key in one.values
            if read.names_file(name, key) and (name, key) != ("picks", "tracked")
            for value in (one.files(key) if key == "video" else (one.text(key),))
        )  # fmt: skip
        refuse_to_overwrite(inputs, str(output))
        if output.exists() and output.samefile(project):
            raise section.error("tracked", "is this project itself: name a file of its own")
    progress = Progress("frames", stopped=GOES_ON, rate=True)

    def count(total: int) -> None:
        progress.total = total

    options = TrackOptions(from_s, to_s, every, reach, patch_px, least_correlation, residual_px)
    messages = Messages(quiet)
    try:
        done = follow(read, options, lambda: progress.add(1), count, messages)
    finally:
        progress.close()
    for finding in done.findings:
        messages(finding)
    messages.close()
    for line in done.lines:
        click.echo(line, err=True)
    click.echo(f"{done.output}: written; next: vopd attitude {project}", err=True)
    ctx.exit(3 if messages.warnings else 0)
