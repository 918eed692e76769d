"""`vopd new`: write a flight project from the files that there are, or an example."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from vopd.cli.options import FILE_NAME
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError, count_text

if TYPE_CHECKING:
    from vopd.flight.new import NewProject

_FILES = (
    ("--gcp", "gcp", "gcp_list.txt of OpenDroneMap: picks and landmarks in one."),
    ("--lens", "lens", "The lens: OpenCV, COLMAP, OpenSfM or ODM, Metashape, mrcal."),
    ("--picks", "picks", "The picks: CSV, CVAT, LabelMe, gcp_list.txt."),
    ("--landmarks", "landmarks", "The landmarks: CSV, GeoJSON, gcp_list.txt."),
    ("--track", "track", "The camera's track: CSV, GPX, ODM geo.txt, .MRK."),
    (
        "--images",
        "images",
        "A folder of images: positions from their tags, or with --track the frames' times.",
    ),
    ("--wind", "wind", "The wind: CSV, University of Wyoming."),
)


@click.command("new")
@click.argument("folder", type=FILE_NAME, metavar="DIR")
@click.option("--deck", type=FILE_NAME, metavar="DECK", help="A card deck, to be made a project.")
@click.option("--job", type=click.IntRange(min=1), metavar="N", help="Which job of the deck.")
@click.pass_context
def command(
    ctx: click.Context, /, folder: str, deck: str | None, job: int | None, **given: str | None
) -> None:
    """Write a new flight project: DIR/flight.toml, with every key explained.

    Given files, it finds out what each of them is, says so, and names them in the
    project; they stay where they are. What no file says and the project must
    know (what heights are counted from, the pixel grid of a CSV, ...) is marked
    NEEDED in flight.toml and listed.

    With --deck it writes the project that is the same problem as one job of a card
    deck; vopd punch goes the other way.

    Given none, it writes an example that runs at once, with frames of a video,
    picks, landmarks, track, lens, wind, and the true angles.

    \b
    Examples:
        vopd new example
        vopd attitude example/flight.toml
        vopd new survey --gcp gcp_list.txt --lens cameras.json --track geo.txt
        vopd new case1 --deck decks/appendix_h/case1.dat

    A flight.toml that is there already is not touched: that is an error.

    Exit status: 0 the project is written; 1 a file could not be read, or one that
    would be written is there already; 2 wrong usage.
    """
    from vopd.flight.new import NAME, example_project, project_of_files

    files = {key: name for key, name in given.items() if name is not None}
    if deck is not None and files:
        raise click.UsageError("--deck has everything: leave the other files out.")
    if job is not None and deck is None:
        raise click.UsageError("--job is for --deck.")
    refuse_existing(Path(folder), [NAME])
    if deck is not None:
        new = _of_deck(deck, job)
    else:
        new = project_of_files(Path(folder), files) if files else example_project()
    write_project(Path(folder), new)
    ctx.exit(0)


def _of_deck(name: str, number: int | None) -> NewProject:
    """Write the project of one job of a deck."""
    from vopd.convert.deck_to_flight import deck_project
    from vopd.pipeline import read_deck

    job = read_deck(name).chosen(number)
    try:
        new = deck_project(job)
    except VopdError as error:
        raise VopdError(f"{name}, job {number or 1}: {error}") from error
    frames = count_text(len(job.readings.frame), "frame")
    new.said.insert(0, f"{name}, job {number or 1}: {frames} on cards")
    return new


for _option, _key, _help in _FILES:
    _metavar = "DIR" if _key == "images" else "FILE"
    command = click.option(_option, _key, type=FILE_NAME, metavar=_metavar, help=_help)(command)


def write_project(
    folder: Path, new: NewProject, to_errors: bool = False, quiet: bool = False
) -> None:
    """Write the files of a project, all of them or none, and say what is in them.

    Args:
        folder: where to; it is made where it is not there
        new: what to write
        to_errors: whether it is said on standard error
        quiet: whether nothing is said

    Raises:
        OutputError: where a file is there already, or cannot be written
    """
    refuse_existing(folder, list(new.contents))
    made: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in new.contents.items():
            with whole_file(str(folder / name)) as file:
                file.write(content)
            made.append(folder / name)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        if len(made) < len(new.contents):
            for path in made:
                path.unlink()
    project = (folder / "flight.toml").as_posix()
    said = [*new.said, f"{project}: written"]
    said += [f"needed: [{section}] {key} ({why})" for (section, key), why in new.needed.items()]
    said.append(f"next: vopd {'check' if new.needed else 'attitude'} {project}")
    for sentence in [] if quiet else said:
        click.echo(sentence, err=to_errors)


def refuse_existing(folder: Path, names: list[str]) -> None:
    """Refuse to overwrite files.

    Args:
        folder: of them
        names: of the files

    Raises:
        OutputError: where one is there already
    """
    for name in names:
        if (folder / name).exists():
            raise OutputError(f"{folder / name}: is there already; name another folder")
