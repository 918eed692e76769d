"""`vopd pick`: make a page on which landmarks are picked in frames."""

from __future__ import annotations

from pathlib import Path

import click

from vopd.cli.console import Progress
from vopd.cli.options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.report import check_page_name
from vopd.files import whole_file
from vopd.findings import count_text

SPREAD = 12  # frames of a video, if none are named
MOST_STILLS = 60  # images that are all taken


@click.command("pick")
@click.argument("frames", type=FILE_NAME, metavar="FRAMES...", nargs=-1, required=True)
@output_option("The page: .html; - is standard output.", required=True)
@click.option("--at", metavar="N,N,...", help="Which frames, counted from 0; images, too.")
@click.option("--landmarks", type=FILE_NAME, metavar="FILE", help="Landmarks: names to offer.")
@click.option("--clicks", type=FILE_NAME, metavar="FILE", help="Picks that there are already.")
@click.pass_context
def command(
    ctx: click.Context, /, frames: tuple[str, ...], output: str, at: str | None,
    landmarks: str | None, clicks: str | None,
) -> None:  # fmt: skip
    """Make a page on which landmarks are picked: one HTML file, for any browser.

    FRAMES is a video, or its files in their order, a folder of images, images, or a
    flight project, or its folder, whose [picks] video names a video. Of a video the page has 12
    frames that are spread over it, or those of --at; of images all, up to 60. They
    are inside the page: it loads nothing, and nothing leaves the browser. It zooms
    to 16 times, moves a pick by a tenth of a pixel with the arrow keys, keeps each
    change, and saves clicks.csv, which a flight project reads without a further
    key: [picks] file = "clicks.csv".

    Frames count from 0 in the order in which they are shown. Images that a tag
    says are turned are shown upright, and pixels are those of the upright image.

    It needs jinja2 and Pillow, and for a video PyAV (pip install jinja2 pillow av)
    or the program ffmpeg.

    \b
    Examples:
        vopd pick flight.mp4 -o pick.html --landmarks landmarks.csv
        vopd pick flight.mp4 -o pick.html --at 0,150,300 --clicks clicks.csv
        vopd pick photographs -o pick.html

    Exit status: 0 the page is written; 1 a file could not be read; 2 wrong usage.
    """
    from vopd.flight.files import open_input, read_by_content
    from vopd.flight.formats.landmarks import LANDMARK_FORMATS
    from vopd.flight.formats.picks import CLICKS, read_clicks
    from vopd.report.pick import pick_page
    from vopd.video import STILLS, open_frames, spread

    check_page_name(output)
    refuse_to_overwrite((*frames, *filter(None, (landmarks, clicks))), output)
    named = _numbers(at)
    own = Path(frames[0], "flight.toml")
    if own.is_file() and not any(one.suffix.lower() in STILLS for one in own.parent.iterdir()):
        frames = (str(own), *frames[1:])
    if frames[0].endswith(".toml"):
        frames, landmarks = _of_project(frames, landmarks)
    names: list[str] = []
    if landmarks is not None:
        names = read_by_content(LANDMARK_FORMATS, open_input(landmarks, Path())).name
    known = () if clicks is None else read_clicks(open_input(clicks, Path()))
    found = open_frames(frames)
    wrong = [k for k in named if k >= len(found)]
    if wrong:
        has = f"{found.source} has {len(found)} of them, counted from 0"
        raise click.UsageError(f"--at {wrong[0]}: {has}.")
    if not named and found.image_name and len(found) > MOST_STILLS:
        raise click.UsageError(f"{found.about}; choose up to {MOST_STILLS} of them with --at.")
    chosen = named or (range(len(found)) if found.image_name else spread(found, SPREAD))
    progress = Progress("frames", total=len(chosen))
    try:
        page = pick_page(found, chosen, names, known, CLICKS, tell=lambda: progress.add(1))
    finally:
        progress.close()
    with whole_file(output) as file:
        file.write(page)
    click.echo(found.about, err=True)
    size = f"{count_text(len(chosen), 'frame')}, {len(page) / 1e6:.1f} MB"
    click.echo(
        f"{output}: {size}; open it in a browser, pick, and save clicks.csv beside flight.toml",
        err=True,
    )
    ctx.exit(0)


def _of_project(sources: tuple[str, ...], landmarks: str | None) -> tuple[tuple[str, ...], str]:
    """Find the video of a project, and its landmarks if no others are given."""
    from vopd.flight.project import read_project

    if len(sources) > 1:
        raise click.UsageError(f"{sources[0]}: a project is given alone.")
    project = read_project(sources[0])
    section = project.section("picks")
    if not section.has("video"):
        raise section.error("video", "is missing: the name of the video that is picked in")
    own = landmarks or str(project.folder / project.section("landmarks").text("file"))
    return tuple(str(project.folder / name) for name in section.files("video")), own


def _numbers(at: str | None) -> list[int]:
    """Read the numbers of frames.

    Raises:
        UsageError: if one is none
    """
    if at is None:
        return []
    words = at.split(",")
    for word in words:
        if not (word.strip().isascii() and word.strip().isdigit() and len(word) < 10):
            raise click.UsageError(f"--at {word}: not the number of a frame, as in --at 0,60,120.")
    return sorted({int(word) for word in words})
