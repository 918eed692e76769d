"""`vopd new`: write a flight project from the files that there are, or an example."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from vopd.cli.console import Messages
from vopd.cli.options import FILE_NAME, FOLDER_NAME, WholeRange
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError, count_text
from vopd.inputs import is_number

if TYPE_CHECKING:
    from vopd.flight.project.inspect import NewProject
    from vopd.flight.project.keys import KeyValues
    from vopd.flight.project.new import Answer

_FILES = (
    ("--gcp", "gcp", "gcp_list.txt of OpenDroneMap: picks and landmarks in one."),
    (
        "--lens",
        "lens",
        "The lens: OpenCV, Kalibr, COLMAP, OpenSfM or ODM, Metashape, mrcal; or FX,FY,CX,CY,K1,K2.",
    ),
    ("--picks", "picks", "The picks: CSV, CVAT, LabelMe, gcp_list.txt."),
    ("--landmarks", "landmarks", "The landmarks: CSV, GeoJSON, gcp_list.txt."),
    (
        "--track",
        "track",
        "The camera's track: CSV, GPX, geo.txt, .MRK, .pos, .SRT, a GoPro's video.",
    ),
    (
        "--images",
        "images",
        "One image or a folder of them: their tags give the positions or, with --track, the times; "
        "or the numbered frames of a video.",
    ),
    ("--wind", "wind", "The wind: CSV, University of Wyoming."),
)

_ANSWERS = (
    (
        "--height",
        "NAME",
        "Zero of heights: ellipsoid, egm96, egm2008, navd88, same, or the height of the geoid in "
        "metres.",
    ),
    ("--ground", "METRES", "Height of the ground or pad, if the track's heights count from it."),
    ("--crs", "CODE", "Coordinate reference system of x and y, such as EPSG:32633."),
    ("--clock", "NAME", "Clock of the track's dates: utc or gps."),
    ("--fps", "HZ", "Frames per second; --epoch is then the moment of frame 0."),
    ("--epoch", "TIME", "The moment of t = 0, such as 2026-05-01T11:58:42Z."),
    ("--first-frame", "SECONDS", "Time of frame 0, after the epoch."),
    ("--pixel-grid", "NAME", "Where picks count from: centre, corner, one-based."),
    ("--image-size", "W,H", "Width and height of the images, pixels."),
    (
        "--sigma-position",
        "METRES",
        "Standard deviation of track or position: 3, or 2,2,4. A track's value of .3 or more "
        "becomes sigma_bias_m, and half of it, or the positions' scatter, sigma_m.",
    ),
    ("--sigma-landmarks", "METRES", "Standard deviation of the landmarks."),
    ("--sigma-time", "SECONDS", "Standard deviation of the frames' times."),
)
"""Options for what no file says: name, value, help. `KEYS` has the keys that they answer."""


@click.command("new")
@click.argument("folder", type=FOLDER_NAME, metavar="DIR")
@click.option(
    "--video",
    multiple=True,
    type=FILE_NAME,
    metavar="FILE",
    help="The video to pick in; repeat it if the camera wrote several files.",
)
@click.option("--deck", type=FILE_NAME, metavar="DECK", help="A card deck to write as a project.")
@click.option("--job", type=WholeRange(min=1), metavar="N", help="Which job of the deck.")
@click.option(
    "--position",
    metavar="LAT,LON,H",
    help="Place of a camera that does not move; or X,Y,Z of --crs.",
)
@click.option(
    "--columns",
    multiple=True,
    metavar="FILE:NAMES",
    help="Columns of a CSV: track:h_m=alt,lat_deg=y; of a CSV without header, all: picks:frame,...",
)
@click.option(
    "--set",
    "keys",
    multiple=True,
    metavar="KEY=VALUE",
    help="Any other key: picks.v=up; paths of files are relative to DIR.",
)
@click.pass_context
def command(
    ctx: click.Context,
    /,
    folder: str,
    video: tuple[str, ...],
    deck: str | None,
    job: int | None,
    position: str | None,
    columns: tuple[str, ...],
    keys: tuple[str, ...],
    **given: str | None,
) -> None:
    """Write a new flight project: DIR/flight.toml, with its keys explained.

    From your files: the command recognises the format of each file, reports it,
    and names the file in the project. The files stay where they are. A project
    also needs values that no file holds, such as the zero of heights or the pixel
    grid of a CSV. Give them by the options from --height on; on a terminal the
    command asks for them. Values still missing are marked NEEDED in flight.toml,
    and listed.

    From a video: it gives the times and the size of the frames. It may also give
    the track: GoPro's GPMF inside it, or DJI's .SRT beside it. Without picks, the
    next step is vopd pick.

    From a deck: --deck writes one job of a card deck as a project, with the
    warnings of vopd check. vopd punch does the reverse.

    From nothing: without files, the command writes an example that runs at once,
    with a short video, six clicks, landmarks, track, lens, wind and true angles.

    \b
    Examples:
        vopd new example
        vopd track example/flight.toml
        vopd attitude example/flight.toml
        vopd new survey --gcp gcp_list.txt --lens cameras.json --track geo.txt
        vopd new hill --picks p.csv --landmarks l.csv --position 47.6,16.4,540 --height same
        vopd new flight --video flight.mp4 --landmarks l.csv --track t.gpx --lens lens.yml
        vopd new case1 --deck decks/appendix_h/case1.dat

    Run again with further options, the command completes a flight.toml that it
    wrote and that nobody has edited. It refuses to touch any other flight.toml.

    Exit status: 0 the project is written; 1 a file could not be read, or a file to
    be written exists already; 2 wrong usage.
    """
    from vopd.flight.project.earlier import earlier_project
    from vopd.flight.project.inspect import lens_of_numbers
    from vopd.flight.project.new import NAME, Answer, example_project, project_of_files

    files = {key: name for _, key, _ in _FILES if (name := given[key]) is not None}
    answers = _answers(given, position, columns, keys)
    if position is not None and "track" in files:
        raise click.UsageError("--position is of a camera that does not move: leave out --track.")
    if {"gcp", "picks", "landmarks"} <= files.keys():
        raise click.UsageError("--gcp is not for --picks and --landmarks, which have both.")
    model = next((one for one in answers if ("camera", "model") in one.keys), None)
    try:
        table = lens_of_numbers(files.get("lens", ""), model.value if model else '"brown"')
    except VopdError as error:
        raise click.UsageError(f"--lens: {error}.") from error
    if table:
        del files["lens"]
        answers = [one for one in answers if one is not model]
        answers.append(Answer("--lens", [("camera", "lens")], table, at_once=True))
    again = deck is None and bool(answers or files or video) and (Path(folder) / NAME).exists()
    own = bool(files or video or table)
    if answers and not own and not again:
        raise click.UsageError(f"{answers[0].option} is for a project of files: give --picks, ...")
    if deck is not None and own:
        raise click.UsageError("--deck has everything: leave the other files out.")
    if job is not None and deck is None:
        raise click.UsageError("--job is for --deck.")
    if again:
        before = earlier_project(Path(folder), files, video, answers)
        files, video = before.files | files, video or before.video
        new = project_of_files(Path(folder), files, answers, _ask, video, before.values)
    else:
        refuse_existing(Path(folder), [NAME])
        if deck is not None:
            new = _of_deck(deck, job)
        elif own:
            new = project_of_files(Path(folder), files, answers, _ask, video)
        else:
            new = example_project()
    write_project(Path(folder), new, again=again)
    ctx.exit(0)


def _answers(
    given: Mapping[str, str | None],
    position: str | None,
    columns: tuple[str, ...],
    keys: tuple[str, ...],
) -> list[Answer]:
    """Read the options for what no file says.

    Raises:
        click.UsageError: where one is not a value of its key
    """
    from vopd.findings import did_you_mean
    from vopd.flight.project.inspect import GROUND
    from vopd.flight.project.keys import KEYS, ROWS
    from vopd.flight.project.new import Answer, answer_value

    found = []
    try:
        for option, _, _ in _ANSWERS:
            text = given[option[2:].replace("-", "_")]
            if text is not None:
                targets = [(row.section, row.name) for row in KEYS if row.option == option]
                targets = targets or [("track", "height")]  # from the ground
                at_once = option == GROUND
                value = answer_value(option, targets[0], text)
                found.append(Answer(option, targets, value, at_once))
        if position is not None:
            found += _position(position, given["crs"])
        found += [_columns(one) for one in columns]
        for one in keys:
            name, _, text = one.partition("=")
            section, _, last = name.strip().partition(".")
            key = section, last
            if key not in ROWS:
                near = did_you_mean(name.strip(), [f"{a}.{b}" for a, b in ROWS if "." not in a])
                if "lens" in name.split(".") or ("camera.lens", last) in ROWS:
                    near = "; numbers of a lens: --lens FX,FY,CX,CY,K1,K2, of a fisheye with "
                    near += "--set camera.model=fisheye"
                raise click.UsageError(f"--set: there is no key {name}{near}")
            value = answer_value("--set", key, text)
            found.append(Answer("--set", [key], value, at_once=True))
    except VopdError as error:
        raise click.UsageError(str(error)) from error
    return found


def _position(text: str, crs: str | None) -> list[Answer]:
    """Read the place of a camera: degrees, or metres of the grid of `--crs`.

    Numbers that only fit the other kind are taken for it: degrees beside a `--crs` of the
    landmarks, or metres without one, whose grid is asked for.
    """
    from vopd.flight.project.new import Answer, answer_value

    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 3 or not all(map(is_number, parts)):
        raise click.UsageError(f"--position: {text} is not three numbers with commas.")
    degrees, metres = ("lat_deg", "lon_deg", "h_m"), ("x_m", "y_m", "z_m")
    values = [
        answer_value("--position", ("position", name), part)
        for name, part in zip(metres, parts, strict=True)
    ]
    largest = max(abs(float(one)) for one in values[:2])
    of_a_code = crs is not None and crs.strip().upper().startswith("EPSG:")
    is_degrees = largest <= 360.0 if crs is None or of_a_code else False
    keys = [("position", name) for name in (degrees if is_degrees else metres)]
    return [
        Answer("--position", [key], answer_value("--position", key, value), at_once=True)
        for key, value in zip(keys, values, strict=True)
    ]


def _columns(text: str) -> Answer:
    """Read what --columns says of a CSV: the names of some of its columns, or of all."""
    from vopd.flight.project.keys import ROWS, toml_text
    from vopd.flight.project.new import Answer

    section, _, names = text.partition(":")
    if (section, "columns") not in ROWS or not names:
        known = ", ".join(name for name, key in ROWS if key == "columns")
        raise click.UsageError(f"--columns: {text}: write FILE:NAMES, of {known}.")
    parts = [part.strip() for part in names.split(",")]
    value = f"[{', '.join(map(toml_text, parts))}]"
    if "=" in names:
        pairs = [part.partition("=") for part in parts]
        given = [name.strip() for name, _, _ in pairs]
        for name in given:
            if not re.fullmatch(r"\w+", name, re.ASCII) or given.count(name) > 1:
                what = "is there twice" if given.count(name) > 1 else "is no name of a column here"
                raise click.UsageError(f"--columns: {text}: {name!r} {what}.")
        mapped = [f"{a.strip()} = {toml_text(b.strip())}" for a, _, b in pairs]
        value = f"{{ {', '.join(mapped)} }}"
    return Answer("--columns", [(section, "columns")], value, at_once=True)


def _ask(new: NewProject, values: KeyValues) -> None:
    """Ask on a terminal for what no file says; Enter alone leaves a key open, Ctrl-D all others."""
    from vopd.flight.project.keys import ROWS
    from vopd.flight.project.new import answer_value

    asked = [one for one in new.needed if ROWS[one].kind != "file"]
    if not asked or not (sys.stdin.isatty() and sys.stdout.isatty()):
        return
    for sentence in new.said:
        click.echo(sentence)
    new.said.clear()
    click.echo("No file says the following; Enter leaves a value open, Ctrl-D all that follow.")
    height = ""  # as answered for another section
    for section, key in asked:
        row = ROWS[section, key]
        choices = f" ({', '.join(row.choices)})" if row.choices else f", such as {row.example}"
        about = row.comment + (choices if key != "height" else "")
        own = new.options.get((section, key), "")
        why = new.needed[section, key]
        click.echo(f"[{section}] {key}: {why if own or row.kind == 'sigma' else about}")
        while (section, key) not in values:
            usual = height if key == "height" and not own else ""
            try:
                text = click.prompt(
                    "  " + key, usual, show_default=bool(usual), prompt_suffix=" = "
                )
            except click.Abort as ended:
                if not isinstance(ended.__context__, EOFError):
                    raise
                click.echo()  # what was answered stays
                return
            if not text.strip():
                break
            try:
                values[section, key] = answer_value(own or "answer", (section, key), text)
                height = text if key == "height" and not own else height
            except VopdError as error:
                click.echo(f"  {error}")


def _of_deck(name: str, number: int | None) -> NewProject:
    """Write the project of one job of a deck, and warn of what is doubtful on its cards."""
    from vopd.convert.deck_to_flight import deck_project
    from vopd.pipeline import read_deck

    deck = read_deck(name)
    job, messages = deck.chosen(number), Messages()
    for finding in deck.findings:
        messages(finding)
    messages.close()
    try:
        new = deck_project(job)
    except VopdError as error:
        raise VopdError(f"{name}, job {number or 1}: {error}") from error
    frames = count_text(len(job.readings.frame), "frame")
    new.said.insert(0, f"{name}, job {number or 1}: {frames} on cards")
    return new


for _option, _key, _help in _FILES:
    _metavar = "DIR|IMAGE" if _key == "images" else "FILE"
    command = click.option(_option, _key, type=FILE_NAME, metavar=_metavar, help=_help)(command)


for _option, _metavar, _help in _ANSWERS:
    command = click.option(_option, metavar=_metavar, help=_help)(command)


def write_project(
    folder: Path,
    new: NewProject,
    to_errors: bool = False,
    quiet: bool = False,
    again: bool = False,
) -> None:
    """Write the files of a project, all of them or none, and say what is in them.

    Args:
        folder: where to; it is made where it is not there
        new: what to write
        to_errors: whether it is said on standard error
        quiet: whether nothing is said
        again: whether it takes the place of a project that was written before

    Raises:
        OutputError: where a file is there already and is not to be replaced, or cannot be written
    """
    if not again:
        refuse_existing(folder, list(new.contents))
    made: list[Path] = []
    folders: list[Path] = []
    there = {name for name in new.contents if (folder / name).exists()}  # which stays
    try:
        folders += [one for one in (folder, *folder.parents) if not one.exists()]
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
                if path.name not in there:
                    path.unlink()
            with suppress(OSError):  # not made, or something else is in it
                for one in folders:
                    one.rmdir()
    from vopd.flight.project.keys import ROWS

    project = (folder / "flight.toml").as_posix()
    said = [*new.said, f"{project}: written{' again; its other values are kept' * again}"]
    said += [f"needed: [{section}] {key} ({why})" for (section, key), why in new.needed.items()]
    then = f"vopd {(new.then or 'attitude {}').format(quote(project))}"
    if new.needed:
        options = dict.fromkeys(new.options.get(key, ROWS[key].new_option) for key in new.needed)
        if "--epoch" in options:  # of frame 0, which says when that is
            options.pop("--first-frame", None)
        values = " ".join(one + ("=..." if "." in one else " ...") for one in options)
        then = f"vopd new {quote(folder.as_posix())} {values}"
    said.append(f"next: {then}")
    for sentence in [] if quiet else said:
        click.echo(sentence, err=to_errors)


def refuse_existing(folder: Path, names: list[str]) -> None:
    """Refuse to overwrite files.

    Raises:
        OutputError: where one is there already, or the folder is a file or named as one
    """
    if folder.suffix.lower() == ".toml" and not folder.exists():
        inside = folder.parent if folder.name == "flight.toml" else folder.with_suffix("")
        raise OutputError(f"{folder}: name the folder that flight.toml is written into: {inside}")
    if not folder.is_dir() and (folder.exists() or folder.is_symlink()):
        kind = "a file" if folder.is_file() else "no folder"
        raise OutputError(f"{folder}: is {kind}; name a folder, which is made")
    for name in names:
        if (folder / name).exists():
            raise OutputError(f"{folder / name}: is there already; name another folder")
