"""New flight projects, from the files that there are or as an example."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from vopd.files import from_folder, reason
from vopd.findings import VopdError, raise_all
from vopd.flight.coordinates import crs_is_geographic, crs_name
from vopd.flight.formats.image_tags import images_in
from vopd.flight.formats.tables import EXACT
from vopd.flight.project.inspect import (
    CLICKS,
    EPOCH,
    GROUND,
    OF_CLICKS,
    TRACKED,
    NewProject,
    ask_sigma,
    has_positions,
    is_film,
    look_at_focal,
    look_at_landmarks,
    look_at_lens,
    look_at_numbers,
    look_at_picks,
    look_at_pictures,
    look_at_times,
    look_at_track,
    look_at_video,
    look_at_wind,
    name_images,
    named_from,
    take_size,
)
from vopd.flight.project.keys import (
    ROWS,
    VIDEO,
    KeyValues,
    Project,
    Section,
    from_toml,
    keys_of,
    project_text,
    toml_numbers,
    toml_text,
    with_common_error,
)
from vopd.flight.project.stated import NO_BASE_M
from vopd.flight.project.track import not_in_metres
from vopd.inputs import is_number, no_date
from vopd.video import open_frames, stills_in

R = TypeVar("R")
NAME = "flight.toml"
EXAMPLE = (
    "flight.mp4", CLICKS, "landmarks.csv", "track.csv", "lens.json", "wind.csv", "truth.csv",
)  # fmt: skip
"""The files of the example; tools/example_flight.py makes them."""
EXAMPLE_VALUES: KeyValues = {
    ("flight", "name"): '"drone over fields"',
    EPOCH: "2026-05-01T09:30:00.240Z",
    ("camera", "lens"): '"lens.json"',
    ("camera", "image_size_px"): "[640, 360]",
    ("picks", "file"): toml_text(CLICKS),
    ("picks", "sigma_px"): "0.5",
    ("picks", "video"): '"flight.mp4"',
    ("picks", "tracked"): toml_text(TRACKED),
    ("picks", "frame_rate_hz"): "25.0",
    ("picks", "first_frame_t_s"): "0.0",
    ("landmarks", "file"): '"landmarks.csv"',
    ("landmarks", "height"): '"ellipsoid"',
    ("landmarks", "sigma_m"): "[0.05, 0.05, 0.1]",
    ("track", "file"): '"track.csv"',
    ("track", "height"): '"ellipsoid"',
    ("track", "clock"): '"utc"',
    ("track", "sigma_m"): "[0.02, 0.02, 0.04]",
    ("track", "sigma_t_s"): "0.002",
    ("wind", "file"): '"wind.csv"',
}
HEAD = "A flight project: vopd check, attitude, plot and report take this file.\n"
SAYS_EXAMPLE = (
    "The example: the video of a drone over fields, with clicks of six landmarks in its first"
)
EXAMPLE_HEAD = (
    HEAD
    + f"""\
{SAYS_EXAMPLE}
frame: of pond and yard the lowest corner in the picture, of barn and hall the lower right one,
of court and lawn the lower left one. The frames are rendered, the clicks have errors of half a
pixel, and truth.csv has the true angles. vopd track follows the clicks through the video, vopd
attitude solves both.
To make it yours, replace the files and the values that differ. Lines that begin with #
are keys that are not used here, each with an example."""
)
OWN_HEAD = (
    HEAD
    + """\
Lines that begin with # are keys that are not used, each with an example. Those that are
marked NEEDED lack a value: remove their # and give it, or repeat vopd new with the option
that stands beside NEEDED, which writes this file again as long as it is not edited."""
)


def example_project() -> NewProject:
    """Build the example: a project that runs at once, with its truth."""
    folder = files("vopd.flight") / "example"
    new = NewProject({name: (folder / name).read_bytes() for name in EXAMPLE})
    new.contents[NAME] = project_text(EXAMPLE_VALUES, {}, EXAMPLE_HEAD).encode()
    new.said.append("an example: a drone's video, clicks of six landmarks in it, and its truth")
    new.then = OF_CLICKS
    return new


def project_of_files(
    folder: Path,
    given: Mapping[str, str],
    answers: Sequence[Answer] = (),
    ask: Callable[[NewProject, KeyValues], None] = lambda new, values: None,
    video: Sequence[str] = (),
    before: Mapping[tuple[str, str], str] | None = None,
) -> NewProject:
    """Build a project from files of the user, which stay where they are.

    Args:
        folder: where the project will be
        given: the files by what they are: lens, picks, landmarks, track, wind, gcp (picks
            and landmarks in one), images (a folder or one, whose tags are the track, or with
            another track by time the frames' times)
        answers: what the user says that no file does
        ask: asks for what is needed still, and adds it to the values
        video: the files of the video
        before: values of a project that this one takes the place of

    Raises:
        VopdError: where a file cannot be read, or is not of a known format
    """
    new, values = NewProject(), KeyValues(before or {})
    own_name = toml_text(Path(os.path.abspath(folder)).name)  # noqa: PTH100
    values.setdefault(("flight", "name"), own_name)
    for one in [one for one in answers if one.at_once]:
        for section, key in one.keys:
            values[section, key] = one.value
            if key == "columns":
                new.columns[section] = from_toml(one.value)
    for (section, key), value in (before or {}).items():
        if key in ("columns", "crs"):
            known: dict[str, Any] = new.columns if key == "columns" else new.crs
            known.setdefault(section, from_toml(value))
    for one in answers:
        given_crs = [section for section, key in one.keys if key == "crs"]
        new.crs |= dict.fromkeys(given_crs, str(from_toml(one.value)))
    own = "track", "clock"
    for clock in [(before or {}).get(own), *(one.value for one in answers if own in one.keys)]:
        new.clock = from_toml(clock) if clock else new.clock
    new.answered = {key: one.value for one in answers for key in one.keys}
    look_at_files(new, values, folder, given, video)
    for one in [one for one in answers if one.at_once]:
        for section, key in one.keys:
            if section == "track" and any(own == "position" for own, _ in values):
                new.said.append(f"{one.option}: [track] {key} is not used beside [position]")
            if from_toml(other := values[section, key]) != from_toml(one.value):
                raise VopdError(
                    f"{one.option}: [{section}] {key} = {one.value}, and by a file or option it is "
                    f"{other}: leave one out"
                )
    _refuse_lost_files(folder, answers)
    said = sure_keys(answers)
    for one in [one for one in answers if not one.at_once]:
        others = {key for key, option in new.options.items() if option != one.option}
        keys = [key for key in one.keys if key in new.needed or key in values or key == EPOCH]
        keys = [key for key in keys if key not in said | others]
        # it gives what is open; what was given before stays, unless nothing is open
        keys = [key for key in keys if key not in (before or {})] or keys
        values |= dict.fromkeys(keys, one.value)
        if not keys:
            new.said.append(f"{one.option}: not used: nothing here needs it")
        elif EPOCH in keys and EPOCH not in new.needed:
            new.said.append(f"{one.option}: dates t = 0, and moves no frame along the track")
    first = "picks", "first_frame_t_s"
    timed = bool({("picks", "frame_rate_hz"), ("picks", "times")} & {*values})
    of_frame_0 = EPOCH in new.needed and EPOCH in values
    if first in new.needed and first not in values and timed and of_frame_0:
        values[first] = "0.0"
        new.said.append("frame 0 is at the epoch: first_frame_t_s = 0.0")
    new.needed = {key: why for key, why in new.needed.items() if key not in values}
    ask(new, values)
    new.needed = {key: why for key, why in new.needed.items() if key not in values}
    name_same_height(new, values)
    if ("track", "sigma_m") not in said:  # which is meant as it is
        share_receiver_error(new, values)
    if ("landmarks", "file") in new.needed:  # nothing to click yet
        new.then = ""
    elif ("picks", "tracked") in values and not new.needed:
        new.then = new.then or OF_CLICKS
    needed = with_common_error(new.needed)
    new.contents[NAME] = project_text(values, needed, OWN_HEAD, new.options).encode()
    return new


WRITTEN_LATER = (("picks", "file"), ("picks", "tracked"))


def _refuse_lost_files(folder: Path, answers: Sequence[Answer]) -> None:
    """Refuse files of `--set` that are not there; they count from the project's folder."""
    for one in [one for one in answers if one.option == "--set"]:
        key = one.keys[0]
        given = from_toml(one.value)
        names = given if isinstance(given, list) else [given]
        if ROWS[key].kind not in ("file", "files") or key in WRITTEN_LATER or VIDEO in names:
            continue
        for name in [name for name in names if isinstance(name, str)]:
            if not Path(os.path.normpath(folder / name)).exists():  # the folder need not be
                there = f": write {from_folder(name, folder)}" if Path(name).exists() else ""
                raise VopdError(
                    f"--set {'.'.join(key)}: {name} is not there, as its path is relative to the "
                    f"project's folder {folder}{there}"
                )


def name_same_height(new: NewProject, values: KeyValues) -> None:
    """Write the datum of landmarks with heights like those of a track whose format says it.

    Args:
        new: what is said, to be added to
        values: the keys that are known, to be added to
    """
    key = "landmarks", "height"
    if new.track_height and values.get(key) == toml_text("same"):
        values[key] = toml_text(new.track_height)
        new.said.append(
            f"[landmarks] height = {values[key]}: the same as the track's, by its format"
        )


def share_receiver_error(new: NewProject, values: KeyValues) -> None:
    """Divide the error of a receiver's track: all positions of some minutes are off together.

    Half of it remains each position's own, or as much as they scatter about a smooth path; as
    errors of each by itself hundreds of positions would be taken for exact in the mean.

    Args:
        new: what is said, to be added to
        values: the keys that are known
    """
    own, common = ("track", "sigma_m"), ("track", "sigma_bias_m")
    if own not in values or common in values:
        return
    stated = from_toml(values[own])
    sizes = stated if isinstance(stated, list) else [stated]
    if EXACT in sizes or max(sizes) < NO_BASE_M:
        return
    values[common] = values[own]
    half = np.array(sizes) / 2.0
    scatter = np.zeros(3) if new.scatter_m is None else np.nan_to_num(new.scatter_m)
    each = np.clip(scatter if len(half) == 3 else scatter.max(), half, 2.0 * half)
    each = [float(f"{one:.2g}") for one in each.tolist()]
    values[own] = toml_numbers(*each) if isinstance(stated, list) else f"{each[0]:g}"
    why = "half of it" if np.allclose(each, half) else "as they scatter about a smooth path"
    new.said.append(
        f"[track] sigma_bias_m = {values[common]}: a receiver without a base is off by as much for "
        f"minutes; sigma_m = {values[own]}, {why}, for each position by itself"
    )


def look_at_files(
    new: NewProject, values: KeyValues, folder: Path, given: Mapping[str, str],
    video: Sequence[str] = (),
) -> None:  # fmt: skip
    """Say what each file is, and ask what they leave open.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        given: as for `project_of_files`
        video: as for `project_of_files`
    """
    errors = list[VopdError]()

    def look(at: Callable[..., R], *more: Any) -> R | None:
        """Look at a file, and keep its error: the other files may have some, too."""
        try:
            return at(new, values, folder, *more)
        except VopdError as error:
            errors.append(error)
            return None

    for crs in dict.fromkeys(new.crs.values()):  # it is known, and pyproj is there
        look(_known_crs, crs)
    named = dict(given)
    if "gcp" in named:
        gcp = named.pop("gcp")
        named = {"picks": gcp, "landmarks": gcp} | named
    images = named.pop("images", None)
    tagged = images  # whose tags are read: of one photograph's neighbours, too
    if images is not None:
        if Path(images).is_file() and not stills_in(Path(images)):
            raise VopdError(
                f"{images}: neither an image nor a folder of images; a video is given as --video"
            )
        open_frames([images])
        if not Path(images).is_dir():
            tagged = str(Path(images).parent)
    fixed = "position" in {section for section, _ in values}
    # images of kinds that have no tags bring no positions
    bare = images is not None and bool(stills_in(Path(images))) and not images_in(Path(images))
    film = images is not None and is_film(Path(images))
    if images is not None and film:
        tagged = None
        if not name_images(new, named.get("picks")):
            video, images = [images], None
    of_tags = None if bare or fixed or "track" in named else tagged
    if of_tags is not None and look(has_positions, of_tags):
        named["track"] = of_tags
    elif of_tags is not None and of_tags != images:  # one photograph has one position
        fixed = True
    if ("camera", "lens") not in values or "lens" in named:
        look(look_at_lens, named.get("lens"))
        own = images or named.get("track")  # and not whatever images the working folder has
        if "lens" not in named and own and images_in(Path(own)):
            look_at_focal(new, values, Path(own))
    elif values["camera", "lens"].startswith("{"):
        look_at_numbers(new, values)
    frames = 0
    if video:
        frames = look_at_video(new, values, folder, video, named)
        new.needed.pop(("camera", "image_size_px"), None)
    by_number = True
    if "picks" not in named and images is not None and stills_in(Path(images)):
        by_number = False
        values["picks", "video"] = named_from(images, folder)
        values["picks", "file"] = toml_text(CLICKS)
        take_size(new, values, Path(images))
        new.then = "pick {} -o pick.html"
        new.said.append(
            f"no picks yet: click landmarks with vopd pick, and save {CLICKS} in {folder}"
        )
    elif "picks" in named or not video:
        by_number = bool(look(look_at_picks, named.get("picks"), frames))
        if images is not None and not by_number:
            look_at_pictures(new, values, folder, images)
    look(look_at_landmarks, named.get("landmarks"))
    if fixed:
        if ("position", "x_m") not in values:
            new.needed |= {("position", key): "its place" for key in ("lat_deg", "lon_deg", "h_m")}
        new.needed["position", "height"] = "no file says what its heights are counted from"
        if ("position", "x_m") in values:
            new.needed["position", "crs"] = "it has x and y"
            if wrong := not_in_metres(new.crs.get("position"), "--crs"):
                errors.append(VopdError(f"--position: {wrong}"))
        ask_sigma(new, "position", "sigma_m")
    else:
        track = look(look_at_track, named.get("track"))
        if track is not None and named["track"] != tagged:
            by_number |= (film or bool(video)) and not track.image
            look_at_times(new, values, folder, track, tagged, by_number)
    if "wind" in named:
        look(look_at_wind, named["wind"])
    raise_all(errors)


def _known_crs(new: NewProject, values: KeyValues, folder: Path, crs: str) -> None:
    """Refuse a CRS that is none, or that takes a package which is not there."""
    crs_is_geographic(crs_name(crs), "--crs")


def open_keys(project: Project) -> dict[tuple[str, str], str]:
    """List the keys that a project needs and neither it nor a file has, and why; none if unknown.

    Args:
        project: its sections
    """
    new, values = NewProject(), KeyValues()
    given = {}
    for name, section in project.sections.items():
        values |= {(name, key): "" for key in section.values or ("",)}
        file = section.values.get("lens" if name == "camera" else "file")
        clicked = not section.has("video") or (project.folder / str(file)).exists()
        if isinstance(file, str) and clicked:
            given["lens" if name == "camera" else name] = str(project.folder / file)
        if (columns := section.columns() if section.has("columns") else None) is not None:
            new.columns[name] = columns
    try:
        look_at_files(new, values, project.folder, given)
    except VopdError:  # the error that there is says more
        return {}
    return project.lacking(with_common_error(project.lacking(new.needed)))


# What a user says: options, and answers on a terminal


class Answer(NamedTuple):
    """What a user says of one or more keys, before any file is looked at or after."""

    option: str
    keys: Sequence[tuple[str, str]]
    value: str  # TOML
    at_once: bool = False


def sure_keys(answers: Sequence[Answer]) -> set[tuple[str, str]]:
    """List the keys that count as they are said, whatever files say of them."""
    return {key for one in answers if one.at_once for key in one.keys}


def answer_value(option: str, key: tuple[str, str], text: str) -> str:
    """Check a value that a user gives for a key, and write it as TOML.

    Args:
        option: what it was given by, for errors
        key: section and key
        text: as the user wrote it

    Raises:
        VopdError: where it is not of the key's kind
    """
    row, text = ROWS[key], text.strip()
    table = text[:1] in "{[" and text[:1] != ""
    if (
        row.kind in ("number", "numbers", "size", "sigma") or key[1] == "height"
    ):  # TOML knows no .05
        text = re.sub(r"(?<![\w.])\.(?=\d)", "0.", text)
    if row.kind == "size":  # 1920x1080
        text = text.replace("x", ", ")
    if key[1] == "height" and is_number(text):
        text = f"{{ {'ground_m' if option == GROUND else 'undulation_m'} = {text} }}"
    elif option == GROUND:
        raise VopdError(f"{option}: {text} is not a number of metres")
    elif row.kind in ("text", "file", "files") or text == EXACT:
        text = text if table else toml_text(text.strip("\"'"))
    elif row.kind in ("numbers", "size", "sigma") and "," in text and not table:
        text = f"[{text}]"
    elif row.kind == "texts" and not table:
        text = "[" + ", ".join(toml_text(one.strip()) for one in text.split(",")) + "]"
    try:
        value = from_toml(text)
    except (ValueError, RecursionError) as error:
        if table or row.kind == "other":
            raise VopdError(f"{option}: {text} is not a value of TOML: {reason(error)}") from error
        if row.kind == "date" and (wrong := no_date(f"x = {text}")):
            raise VopdError(f"{option}: {wrong}") from error
        value = text  # of which its reader says what is wrong
    section = Section(option, key[0], {key[1]: value})
    readers: dict[str, Callable[[str], object]] = {
        "texts": section.texts,
        "files": section.files,
        "number": section.number,
        "numbers": section.numbers,
        "size": section.size,
        "sigma": section.sigma,
        "date": section.date,
    }
    if isinstance(value, dict) and keys_of(f"{key[0]}.{key[1]}"):
        section.section(key[1])
    elif row.kind != "other":
        readers.get(row.kind, section.text)(key[1])
    return text
