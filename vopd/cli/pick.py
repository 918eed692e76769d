"""`vopd pick`: make a page on which landmarks are picked in frames."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from vopd.cli.console import Progress
from vopd.cli.options import FILE_NAME, NumberRange, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.report import check_page_name
from vopd.files import optional_package, whole_file
from vopd.findings import Finding, VopdError, count_text

if TYPE_CHECKING:
    from vopd.flight.formats.picks import Click
    from vopd.flight.project.keys import Project
    from vopd.flight.solve.next_click import NextPlace
    from vopd.report.pick import PageContent
    from vopd.video import VideoFrames

SPREAD = 12  # frames of a video, if none are named
MOST_STILLS = 60  # images that are all taken, and frames with picks
MOST_PLACES = 3  # where to click next


@click.command("pick")
@click.argument("frames", type=FILE_NAME, metavar="FRAMES...", nargs=-1, required=True)
@output_option("The page: .html; - is standard output.", required=True)
@click.option("--at", metavar="N,N,...", help="Frames or images to show, counted from 0.")
@click.option("--landmarks", type=FILE_NAME, metavar="FILE", help="Landmark names to offer.")
@click.option("--clicks", type=FILE_NAME, metavar="FILE", help="Picks to begin with.")
@click.option("--cards", type=FILE_NAME, metavar="DECK", help="Read a film for this deck.")
@click.option(
    "--dpi",
    type=NumberRange(1, 100_000),
    metavar="N",
    help="With --cards: pixels per inch of film.",
)
@click.pass_context
def command(
    ctx: click.Context, /, frames: tuple[str, ...], output: str, at: str | None,
    landmarks: str | None, clicks: str | None, cards: str | None, dpi: float | None,
) -> None:  # fmt: skip
    """Make a page for picking landmarks: one HTML file, for any browser.

    FRAMES is a video (or its files, in order), images or a folder of them, or a
    flight project or its folder, if [picks] video names a video or images. The
    page shows 12 frames spread over a video, or all images up to 60; --at chooses
    others. The frames are inside the page: it loads nothing, and nothing leaves
    the browser.

    The page zooms up to 16 times. The arrow keys move a pick by a tenth of a pixel.
    Each change is kept. The page saves clicks.csv, which a flight project reads by
    [picks] file = "clicks.csv" alone.

    From a project with lens and camera positions, the page predicts. After two
    picks in a frame it shows where the other landmarks are; from the third on it
    shows residuals, and names two exchanged labels. It solves the rotation alone,
    as [solve] position = "fixed" does. It begins with the project's own picks, and
    after vopd track it opens at the frames where a click helps most.

    With --cards the page is the film reader of 1974. FRAMES are scans of a film,
    whose file names end in frame numbers. You read the four fiducials and the
    landmarks of group 9 three times each. The page saves a deck for vopd run: DECK,
    which needs groups 1 to 12 only, with group 5 and the basic data filled in.

    Frames count from 0, in the order shown. An image whose tag says that it is
    turned is shown upright, and its picks are pixels of the upright image.

    It needs jinja2 and Pillow, and for a video PyAV (pip install jinja2 pillow av)
    or the program ffmpeg.

    \b
    Examples:
        vopd pick flight.mp4 -o pick.html --landmarks landmarks.csv
        vopd pick flight.mp4 -o pick.html --at 0,150,300 --clicks clicks.csv
        vopd pick photographs -o pick.html
        vopd pick flight.toml -o pick.html
        vopd pick scans -o reader.html --cards head.dat --dpi 4000

    Exit status: 0 the page is written; 1 a file could not be read; 2 wrong usage.
    """
    from vopd.flight.formats.by_content import read_by_content
    from vopd.flight.formats.files import open_input
    from vopd.flight.formats.landmarks import LANDMARK_FORMATS
    from vopd.flight.formats.picks import CLICKS, HIDDEN, read_clicks, read_hidden
    from vopd.flight.project.directions import directions_of, names_of
    from vopd.pipeline import is_flight
    from vopd.report.pick import PageContent, Predicted, pick_page
    from vopd.video import open_frames, spread, stills_in

    for package in ("jinja2", "PIL.Image"):  # one command for both, before anything is read
        optional_package(package, "pick", "vopd pick")
    check_page_name(output)
    refuse_to_overwrite((*frames, *filter(None, (landmarks, clicks, cards))), output)
    named, project, opened = _numbers(at), None, ProjectPicks()
    if (cards is None) != (dpi is None):
        raise click.UsageError("--cards and --dpi go together: the scan's pixels an inch of film.")
    if cards is not None and landmarks is not None:
        raise click.UsageError("--landmarks is not for --cards: the deck has them in group 9.")
    own = Path(frames[0], "flight.toml")
    if own.is_file() and not stills_in(own.parent):
        frames = (str(own), *frames[1:])
    if is_flight(frames[0]):
        if cards is not None:
            raise click.UsageError("--cards: a film has no project; name its scans.")
        project, frames = _of_project(frames)
        opened = _picks_of(project) if clicks is None else opened
    content = PageContent(
        clicks=opened.clicks, hidden=opened.hidden, head=CLICKS, hidden_head=HIDDEN,
        places=opened.places,
    )  # fmt: skip
    if landmarks is not None:
        names = read_by_content(LANDMARK_FORMATS, open_input(landmarks, Path())).name
        content = content._replace(landmarks=names)
    elif project is not None:
        rows = project.read("landmarks", project.open("landmarks"), LANDMARK_FORMATS)
        content = content._replace(landmarks=rows.name)
    if clicks is not None:
        file = open_input(clicks, Path())
        content = content._replace(clicks=read_clicks(file), hidden=read_hidden(file))
    found = open_frames(frames)
    wrong = [k for k in named if k >= len(found)]
    if wrong:
        has = f"{found.source} has {len(found)} of them, counted from 0"
        raise click.UsageError(f"--at {wrong[0]}: {has}.")
    if not named and found.image_name and len(found) > MOST_STILLS:
        raise click.UsageError(f"{found.about}; choose up to {MOST_STILLS} of them with --at.")
    chosen = named or (range(len(found)) if found.image_name else spread(found, SPREAD))
    if not named and not found.image_name and opened.clicks:
        of = {found.label(k): k for k in range(len(found))}
        picked = sorted({of[one] for one, *_ in opened.clicks if one in of})
        picked = picked[:: -(-len(picked) // MOST_STILLS)] if picked else []
        chosen = sorted({*picked, *(of[one.frame] for one in opened.places if one.frame in of)})
        there = {*chosen}
        for count in range(SPREAD - len(there), SPREAD + 1):  # some are there already
            if len(chosen) < SPREAD:
                chosen = sorted(there | {*spread(found, count)})
    if cards is not None and dpi is not None:
        content = _of_film(content, cards, dpi, found, chosen)
    known = {str(one[0]) for one in (*content.clicks, *content.hidden)}
    content, said = content._replace(name=names_of(found, known, project)), ""
    if project is not None:
        try:
            by = Predicted(*directions_of(project, found, chosen, content.name))
            said = f"{project.name}: {count_text(len(by.landmark), 'landmark')}, predicted "
            said += "after two picks in a frame"
            content = content._replace(predicted=by)
        except VopdError as error:
            said = f"nothing is predicted on the page: {error}"
            content = content._replace(unpredicted=str(error).splitlines()[0])
    progress = Progress("frames", total=len(chosen))
    try:
        page = pick_page(found, chosen, content, opened.file, lambda: progress.add(1))
    finally:
        progress.close()
    with whole_file(output) as file_written:
        file_written.write(page)
    for line in filter(None, (found.about, said)):
        click.echo(line, err=True)
    size = f"{count_text(len(chosen), 'frame')}, {len(page) / 1e6:.1f} MB"
    saved = f"{opened.file} beside flight.toml"
    if content.deck is not None:
        saved = "the deck"
    click.echo(f"{output}: {size}; open it in a browser, pick, and save {saved}", err=True)
    ctx.exit(0)


def _of_project(sources: tuple[str, ...]) -> tuple[Project, tuple[str, ...]]:
    """Find a project and its video."""
    from vopd.flight.project.keys import read_project

    if len(sources) > 1:
        raise click.UsageError(f"{sources[0]}: a project is given alone.")
    project = read_project(sources[0])
    section = project.section("picks")
    if not section.has("video"):
        raise section.error("video", "is missing: the name of the video that is picked in")
    return project, tuple(str(project.folder / name) for name in section.files("video"))


class ProjectPicks(NamedTuple):
    """The picks of a project, and where its tracked flight asks for more."""

    clicks: Sequence[Click] = ()
    hidden: Sequence[tuple[str, str]] = ()
    places: Sequence[NextPlace] = ()
    file: str = "clicks.csv"


def _picks_of(project: Project) -> ProjectPicks:
    """Read the picks that a project has already."""
    from vopd.flight.formats.picks import CLICKS, clicks_of, read_hidden
    from vopd.flight.project.camera import read_camera
    from vopd.flight.project.read import read_pick_rows
    from vopd.flight.result import solve_flight
    from vopd.flight.solve.next_click import next_places

    section = project.section("picks")
    if not section.has("file") or not (project.folder / section.text("file")).exists():
        return ProjectPicks()
    person = project.without("picks", "tracked", "tracked_from")
    file = person.open("picks")
    rows = read_pick_rows(person, read_camera(person))
    for text in rows.doubts:
        click.echo(f"warning: {Finding(text, project.name)}", err=True)
    clicks = clicks_of(rows)
    saved = file.head.startswith(CLICKS)
    hidden = read_hidden(file) if saved else []
    name = Path(section.text("file")).name if saved else "clicks.csv"
    places: Sequence[NextPlace] = ()
    if section.has("tracked") and section.text("tracked_from") == "clicks":
        try:
            joint = solve_flight(project).estimates.joint
            places = [] if joint is None else next_places(joint, MOST_PLACES + len(hidden))
        except VopdError as error:
            click.echo(f"where to click next is not known: {error}", err=True)
    places = [one for one in places if (one.frame, one.landmark) not in hidden][:MOST_PLACES]
    return ProjectPicks(clicks, hidden, places, name)


def _of_film(
    content: PageContent, cards: str, dpi: float, frames: VideoFrames, chosen: Sequence[int]
) -> PageContent:
    """Make a page that of a film reader, for a deck.

    Raises:
        VopdError: where a card cannot be read, or a frame has no number that a card has room for
    """
    from vopd.cards.head import read_head
    from vopd.cards.read import open_deck
    from vopd.program.constants import factor
    from vopd.video import image_numbers

    with open_deck(cards) as file:
        head = read_head(file.read(), cards)
    own = image_numbers(frames.image_name) or range(len(frames))
    numbers = [own[k] for k in chosen]
    for k, number in zip(chosen, numbers, strict=True):
        if not 0 <= number < 10_000 or numbers.count(number) > 1:
            raise VopdError(
                f"{frames.label(k)}: name each image by the number of its frame on the film, as "
                "frame_0730.png; a card has four columns for it"
            )
    names = [*(f"fiducial {k}" for k in range(1, 5)), *head.landmarks]
    deck = {**head._asdict(), "inch": 25.4 / dpi / factor}
    return content._replace(landmarks=names, deck=deck, film_number=numbers)


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
