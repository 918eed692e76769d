"""`vopd new`: write a flight project from the files that there are, or an example."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from vopd.cli.file_options import FILE_NAME
from vopd.cli.output import OutputError, whole_file

if TYPE_CHECKING:
    from vopd.flight.new_project import NewProject

_FILES = (
    ("--gcp", "gcp", "gcp_list.txt of OpenDroneMap: picks and landmarks in one."),
    ("--lens", "lens", "The lens: OpenCV, COLMAP, OpenSfM or ODM, Metashape, mrcal."),
    ("--picks", "picks", "The picks: CSV, CVAT, LabelMe, gcp_list.txt."),
    ("--landmarks", "landmarks", "The landmarks: CSV, GeoJSON, gcp_list.txt."),
    ("--track", "track", "The camera's track: CSV, GPX, ODM geo.txt."),
    ("--wind", "wind", "The wind: CSV, University of Wyoming."),
)


@click.command("new")
@click.argument("folder", type=FILE_NAME, metavar="DIR")
@click.pass_context
def command(ctx: click.Context, /, folder: str, **given: str | None) -> None:
    """Write a new flight project: DIR/flight.toml, with every key explained.

    Given files, it looks what they are and says so, and names them in the
    project; they stay where they are. What no file says and the project must
    know (what heights are counted from, the pixel grid of a CSV, ...) is marked
    NEEDED in flight.toml and listed.

    Given none, it writes an example that runs at once, with frames of a video,
    picks, landmarks, track, lens, wind, and the true angles.

    \b
    Examples:
        vopd new example
        vopd attitude example/flight.toml
        vopd new survey --gcp gcp_list.txt --lens cameras.json --track geo.txt

    A flight.toml that is there already is not touched: that is an error.

    Exit status: 0 the project is written; 1 a file could not be read, or one that
    would be written is there already; 2 wrong usage.
    """
    from vopd.flight.new_project import NAME, example_project, project_of_files

    files = {key: name for key, name in given.items() if name is not None}
    _refuse_existing(Path(folder), [NAME])
    new = project_of_files(Path(folder), files) if files else example_project()
    write_project(Path(folder), new)
    ctx.exit(0)


for _option, _key, _help in reversed(_FILES):
    command = click.option(_option, _key, type=FILE_NAME, metavar="FILE", help=_help)(command)


def write_project(folder: Path, new: NewProject) -> None:
    """Write the files of a project, all of them or none, and say what is in them.

    Args:
        folder: where to; it is made where it is not there
        new: what to write

    Raises:
        OutputError: where a file is there already, or cannot be written
    """
    _refuse_existing(folder, list(new.contents))
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
    for sentence in new.said:
        click.echo(sentence)
    project = (folder / "flight.toml").as_posix()
    click.echo(f"{project}: written")
    for (section, key), why in new.needed.items():
        click.echo(f"needed: [{section}] {key} ({why})")
    click.echo(f"next: vopd {'check' if new.needed else 'attitude'} {project}")


def _refuse_existing(folder: Path, names: list[str]) -> None:
    for name in names:
        if (folder / name).exists():
            raise OutputError(f"{folder / name}: is there already; name another folder")
