"""`vopd track`: follow clicked landmarks through a video."""

from __future__ import annotations

from shlex import quote

import click

from vopd.cli.console import Messages, Progress
from vopd.cli.options import NUMBER, NumberRange, WholeRange, project_argument, quiet_option
from vopd.cli.output import refuse_to_overwrite

GOES_ON = "the same command goes on"


@click.command("track")
@project_argument
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
    help="Match with every click up to N frames away, else with the nearest.",
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
    help="Smallest correlation with the click at which a patch counts as found.",
)
@click.option(
    "--residual",
    "residual_px",
    type=NumberRange(0.0, 100.0, min_open=True),
    default=0.8,
    show_default=True,
    metavar="PX",
    help="Largest distance of a patch from where the other landmarks predict it, pixels.",
)
@quiet_option
@click.pass_context
def command(
    ctx: click.Context, /, project: str, from_s: float | None, to_s: float | None, every: int,
    reach: int, patch_px: int, least_correlation: float, residual_px: float, quiet: bool,
) -> None:  # fmt: skip
    """Follow clicked landmarks through a video, for vopd attitude.

    PROJECT is a flight project. Its [picks] names three files: your clicks, as
    vopd pick saves them (file); the video or the folder of numbered images in
    which you clicked (video); and the file that this command writes (tracked):

    \b
        [picks]
        file = "clicks.csv"
        video = "flight.mp4"
        times = "video"
        tracked = "tracked.csv"

    Two landmarks clicked in one frame are enough to begin; a minute of video needs
    six to thirty clicks. Because position and lens are known, a click determines
    how its landmark looks in every frame. The command lays the patch around the
    click on the ground, views it from the camera's position in the frame, and
    finds it to a tenth of a pixel. It always matches with a click, never with the
    frame before, so that errors do not add up. It guesses nothing: a landmark that
    is hidden, at the edge or not found gets a status that says so, and no pixel.

    Tracking continues behind a plume that covers a third of the picture. After a
    cut it begins anew at the next frame with two clicks. Masts need a small patch:
    write 13 in a column patch_px of the landmarks. Ctrl-C loses nothing: run the
    same command again. Videos need PyAV (pip install av), images Pillow.

    \b
    Examples:
        vopd track flight.toml
        vopd track flight.toml --from 10 --to 25
        vopd attitude flight.toml

    Exit status: 0 the file is written; 1 failed; 2 wrong usage; 3 the file is
    written, but there are warnings.
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
    click.echo(f"{done.output}: written; next: vopd attitude {quote(project)}", err=True)
    ctx.exit(3 if messages.warnings else 0)
