"""Inspect a user's files: what they tell a new project, and what it must ask."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np

from vopd.arrays import Floats
from vopd.files import from_folder
from vopd.findings import VopdError, count_text, shown
from vopd.flight.coordinates import crs_name, has_height_axis
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import Columns, InputFile, open_input
from vopd.flight.formats.image_tags import ReadTags, images_in, read_tags, tags_of
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion
from vopd.flight.formats.photographs import lost_images, other_images
from vopd.flight.formats.picks import PICK_FORMATS, Names
from vopd.flight.formats.tables import EXACT
from vopd.flight.formats.track import (
    NO_ZONE,
    TRACK_FORMATS,
    TrackRows,
    no_position_text,
    row_out_of_order,
)
from vopd.flight.formats.wind import WIND_FORMATS
from vopd.flight.project.keys import (
    ROWS,
    VIDEO,
    KeyValues,
    from_toml,
    toml_numbers,
    toml_text,
)
from vopd.flight.project.track import scatter_of
from vopd.geometry.earth import earth_centred_m
from vopd.inputs import is_number
from vopd.video import grey_frames, image_numbers, open_frames, stills_in

R = TypeVar("R")


@dataclass
class NewProject:
    """What `vopd new` is to write, and to say."""

    contents: dict[str, bytes] = field(default_factory=dict)  # by the name of the file
    said: list[str] = field(default_factory=list)  # a sentence for each file that was looked at
    needed: dict[tuple[str, str], str] = field(default_factory=dict)  # keys, and why
    columns: dict[str, Columns] = field(default_factory=dict)  # of CSV files, by section
    crs: dict[str, str] = field(default_factory=dict)  # that the user gives, by section
    clock: str | None = None  # that the user gives the track's times
    answered: dict[tuple[str, str], str] = field(default_factory=dict)  # by options, as TOML
    picked: tuple[str, ...] = ()  # names of the images that have picks
    options: dict[tuple[str, str], str] = field(default_factory=dict)  # those that are not usual
    track_height: str = ""  # what heights of the track are counted from, where its format says it
    scatter_m: Floats | None = None  # of the track's positions, east, north, up, (3,)
    then: str = ""  # the command to go on with, {} for the project; empty for the usual one
    read: dict[Path, ReadTags] = field(default_factory=dict)  # by the folder, or the one image

    def tags(self, images: Path) -> ReadTags:
        """Read the tags of a folder's images, or of one, as `tags_of` does, once."""
        if images not in self.read:
            self.read[images] = tags_of(images_in(images))
        return self.read[images]


def named_from(name: str, folder: Path) -> str:
    """Name a user's file as the project does."""
    return toml_text(from_folder(name, folder))


def _missing(new: NewProject, section: str, what: str) -> None:
    new.needed[section, "file"] = what
    new.said.append(f"no {section}: {what}")


def _read(
    new: NewProject, values: KeyValues, folder: Path, section: str, name: str,
    formats: Sequence[InputFormat[R]],
) -> tuple[InputFile, R]:  # fmt: skip
    """Read a user's file by its content, and name it in the project."""
    clock = new.clock if section == "track" else None
    file = open_input(name, Path(), new.columns.get(section), new.crs.get(section), clock)
    try:
        rows = read_by_content(formats, file)
    except VopdError as error:
        if mapped := re.search(r"columns = \{ (.*?) \}", str(error)):
            pairs = re.sub(r' = "(.*?)"(, |$)', r"=\1,", mapped[1]).rstrip(",")
            option = f"--columns {shlex.quote(f'{section}:{pairs}')}"
            raise VopdError(f"{error}, or give {option}") from error
        raise
    values[section, "file"] = named_from(file.name, folder)
    return file, rows


NO_LENS = "no lens: give [camera] lens, a calibration file or a table"


def look_at_lens(new: NewProject, values: KeyValues, folder: Path, name: str | None) -> None:
    """Say what the lens file is, and ask what it leaves open.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        name: the file; None where there is none
    """
    if name is None and ("camera", "of_images") in {*values, *new.answered}:
        return
    if name is None:
        new.needed["camera", "lens"] = "a calibration, or a table"
        new.needed["camera", "image_size_px"] = "width and height"
        new.said.append(NO_LENS)
        return
    file = open_input(name, Path())
    values["camera", "lens"] = named_from(file.name, folder)
    values.pop(("camera", "pixel_grid"), None)  # which was of a table
    stated = {
        key: from_toml(text)
        for key in ("model", "camera", "image_size_px", "lens_size_px")
        if (text := values.get(("camera", key), new.answered.get(("camera", key))))
    }
    size = stated.get("lens_size_px", stated.get("image_size_px"))
    question = LensQuestion(stated.get("model"), stated.get("camera"), size and tuple(size))
    try:
        found = read_by_content(LENS_FORMATS, file, question)
    except VopdError as error:
        if "not recognised" in str(error):
            raise VopdError(f"{error}; numbers serve, too: --lens FX,FY,CX,CY,K1,K2") from error
        keys = [
            key for key in ("image_size_px", "model", "camera") if f"[camera] {key}" in str(error)
        ]
        if not keys:
            raise
        new.needed["camera", keys[0]] = str(error)
        new.said.append(str(error))
        return
    if "lens_size_px" not in stated:
        values["camera", "image_size_px"] = toml_numbers(*found.lens.size_px)
    elif "image_size_px" not in stated:
        new.needed["camera", "image_size_px"] = "that of the lens is another, lens_size_px"
    new.said.append(found.said)


def lens_of_numbers(text: str, model: str = '"brown"') -> str:
    """Write a lens that is given as numbers as a table of TOML; empty if these are no numbers.

    Args:
        text: focal length, or fx, fy, cx, cy and up to five coefficients k1, k2, p1, p2, k3 of
            OpenCV, of a fisheye k1 to k4, pixels
        model: of the lens, as TOML

    Raises:
        VopdError: where they are not so many, or are no lens
    """
    numbers = [part.strip() for part in text.split(",")]
    if not all(map(is_number, numbers)):
        return ""
    if len(numbers) not in (1, 4, 5, 6, 8, 9):
        raise VopdError(
            f"{len(numbers)} numbers: give FX; FX,FY,CX,CY; or these and K1; K1,K2; K1,K2,P1,P2; "
            "K1,K2,P1,P2,K3"
        )
    pixels = [float(one) for one in numbers]
    if not (np.isfinite(pixels).all() and min(pixels[:2]) > 1.0):
        raise VopdError(f"{text}: a focal length is above 1 px, and all numbers are finite")
    values = [*map(repr, pixels)]
    told = [
        f"{name}_px = {one}" for name, one in zip(("fx", "fy", "cx", "cy"), values, strict=False)
    ]
    if k := values[4:]:
        k += ["0.0"] * (-len(k) % 4 if len(k) < 4 else 0)
        told.append(f"k = [{', '.join(k)}]")
    return f"{{ model = {model}, {', '.join(told)} }}"


def look_at_numbers(new: NewProject, values: KeyValues) -> None:
    """Ask what a lens that is a table leaves open.

    Args:
        new: what is asked, to be added to
        values: the keys that are known
    """
    if ("camera", "image_size_px") not in values:
        new.needed["camera", "image_size_px"] = "the lens's table does not say it"
    lens = values["camera", "lens"]
    if ("cx_px" in lens or "cy_px" in lens) and ("camera", "pixel_grid") not in values:
        new.needed["camera", "pixel_grid"] = "where the lens's cx_px and cy_px count from"


OF_FOCAL, FOCAL_REL = ("uncertainty", "focal_rel"), 0.05
"""Standard deviation of a focal length by EXIF, as a part of it: whole millimetres of film, and
two ways to count them that differ by 4 %."""


def look_at_pictures(new: NewProject, values: KeyValues, folder: Path, images: str) -> None:
    """Name the images that were picked in, and take their size.

    Args:
        new: what is found out
        values: values by section and key
        folder: where the project will be
        images: their folder, or the one
    """
    values.setdefault(("picks", "video"), named_from(images, folder))
    inside = Path(images) if Path(images).is_dir() else Path(images).parent
    if lost := lost_images(new.picked, [inside]):
        new.said.append(
            f"{images}: {lost} picked and not there, {other_images([Path(images)])}: figures have "
            "a photograph where the picks name it as its file is named"
        )
    take_size(new, values, Path(images))


def take_size(new: NewProject, values: KeyValues, images: Path) -> None:
    """Take the size of images from the tags of the first, or its pixels, where it is not known.

    Args:
        new: what is asked
        values: the keys that are known, to be added to
        images: their folder, or the one; of other files nothing is taken
    """
    stills = stills_in(images)
    if ("camera", "image_size_px") in values or not stills:
        return
    if images_in(images):
        sizes = {one.size_px for one in new.tags(images)[0].values()}
        if len(sizes) > 1:
            several = " and ".join(f"{w} x {h}" for w, h in sorted(sizes)[:2])
            new.said.append(
                f"{images}: images of {several}: name the lens of each in [camera] of_images, or "
                "leave those of one size there"
            )
            return
        (size_px,) = sizes
    else:
        size_px = next(open_frames([str(stills[0])]).pictures([0])).size
    values["camera", "image_size_px"] = toml_numbers(*size_px)


def has_positions(new: NewProject, values: KeyValues, folder: Path, images: str) -> bool:
    """Tell whether the tags of images have positions, and say so where none has."""
    every, unread = new.tags(Path(images))
    if any(one.is_placed for one in every.values()):
        return True
    new.said.append(f"{images}: {no_position_text(every, unread)}")
    return False


def look_at_focal(new: NewProject, values: KeyValues, images: Path) -> None:
    """Take the focal length from the tags of images, where there is no lens.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        images: their folder, or the one
    """
    tags = new.tags(images)[0].values()
    found = {(round(one.focal_px, 1), one.size_px, one.focal_by) for one in tags if one.focal_by}
    if len(found) != 1 or not all(one.focal_by for one in tags):
        if found:
            message = (
                "the tags of the images have several focal lengths or sizes, or some have none"
            )
            new.said.append(f"{images}: {message}: name the lens of each in [camera] of_images")
        return
    ((focal_px, size_px, by),) = found
    new.said[:] = [one for one in new.said if one != NO_LENS]
    values["camera", "lens"] = f'{{ model = "brown", fx_px = {focal_px:g} }}'
    values["camera", "image_size_px"] = toml_numbers(*size_px)
    values[OF_FOCAL] = f"{FOCAL_REL:g}"
    for key in ("lens", "image_size_px"):
        new.needed.pop(("camera", key), None)
    new.said.append(
        f"focal length {focal_px:g} px by {by}, uncertain by {100 * FOCAL_REL:g} %; the distortion "
        "is not known: calibrate, or free focal and k1 in vopd adjust"
    )


def look_at_picks(
    new: NewProject, values: KeyValues, folder: Path, name: str | None, of_video: int = 0
) -> bool:
    """Say what the picks are, and ask what they leave open.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        name: the file; None where there is none
        of_video: how many frames the video has; 0: there is none

    Returns:
        Whether the frames have numbers and not names.

    Raises:
        VopdError: where the frames of a video have names
    """
    if name is None:
        _missing(new, "picks", "a CSV with frame,landmark,u_px,v_px, or another format")
        return True
    file, rows = _read(new, values, folder, "picks", name, PICK_FORMATS)
    if of_video and isinstance(rows.frame, Names):
        raise file.error(
            f"it names images ({shown(rows.frame[0])}), which have no place in a video: give their "
            "folder as --images in the place of --video, or the numbers of the video's frames"
        )
    if rows.grid is None:
        new.needed["picks", "pixel_grid"] = "the file does not say it"
    if isinstance(rows.size_px, tuple) and ("camera", "image_size_px") not in values:
        values["camera", "image_size_px"] = toml_numbers(*rows.size_px)
    frames = len(set(rows.frame))
    grid = f", {rows.grid} grid" if rows.grid else ""
    picks = f"{count_text(len(rows.landmark), 'pick')} in {count_text(frames, 'frame')}{grid}"
    new.said.append(f"{file.name}: {rows.said}, {picks}")
    if frames < of_video * FEW_PICKED:
        values["picks", "tracked"] = toml_text(TRACKED)
        new.said.append(f"vopd track follows them through the {of_video} frames of the video")
    if isinstance(rows.frame, Names):
        new.picked = tuple(dict.fromkeys(rows.frame))
    return len(rows.frame) == 0 or not isinstance(rows.frame, Names)


def name_images(new: NewProject, picks: str | None) -> bool:
    """Tell whether the frames of a file of picks have names; not of one that cannot be read."""
    if picks is None:
        return False
    with suppress(VopdError):
        file = open_input(picks, Path(), new.columns.get("picks"))
        return isinstance(read_by_content(PICK_FORMATS, file).frame, Names)
    return False


def look_at_landmarks(new: NewProject, values: KeyValues, folder: Path, name: str | None) -> None:
    """Say what the landmarks are, and ask what they leave open.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        name: the file; None where there is none
    """
    if name is None:
        _missing(new, "landmarks", "a CSV with landmark,lat_deg,lon_deg,h_m, or another format")
        ask_height(new, "landmarks", None)
        ask_sigma(new, "landmarks", "sigma_m")
        return
    file, rows = _read(new, values, folder, "landmarks", name, LANDMARK_FORMATS)
    new.said.append(f"{file.name}: {rows.said}, {count_text(len(rows.name), 'landmark')}")
    new.said += rows.doubts
    if rows.crs is None and not rows.geodetic:
        new.needed["landmarks", "crs"] = "the file has x and y"
    ask_height(new, "landmarks", rows.crs)
    if not _in_every_row(rows.sigma_m):
        ask_sigma(new, "landmarks", "sigma_m")


def ask_height(new: NewProject, section: str, crs: str | None) -> None:
    """Ask what heights are counted from, where the file's CRS does not say it."""
    try:
        known = crs is not None and has_height_axis(crs_name(crs), section)
    except VopdError:  # without pyproj the check of the project tells what is missing
        known = False
    if not known:
        new.needed[section, "height"] = "no file says what its heights are counted from"


def _in_every_row(sigma: Floats | None) -> bool:
    return sigma is not None and bool(np.isfinite(sigma).all())


def ask_sigma(new: NewProject, section: str, key: str) -> None:
    """Ask for standard deviations that no file has."""
    new.needed[section, key] = f'{ROWS[section, key].comment}; or "{EXACT}"'


GROUND = "--ground"
"""The option of `vopd new` for the height of the ground, where a track's heights count from it."""
POSITION_ERROR = (
    f'metres, or [east, north, up]: 2, 2, 4 by GPS, 0.02, 0.02, 0.04 by RTK; or "{EXACT}"'
)
"""Of a position of a track as a whole; `share_receiver_error` divides it."""


def look_at_track(
    new: NewProject, values: KeyValues, folder: Path, name: str | None
) -> TrackRows | None:
    """Say what the track is, and ask what it leaves open.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        name: the file; None where there is none

    Returns:
        Its positions; None without a track.
    """
    if name is None:
        new.said.append("no track: give [track], or [position] for a camera that does not move")
        new.needed["track", "file"] = "or [position] for a camera that does not move"
        ask_height(new, "track", None)
        new.needed["track", "sigma_m"] = POSITION_ERROR
        return None
    file, rows = _read(new, values, folder, "track", name, TRACK_FORMATS)
    if rows.time_s is not None and not rows.image and (wrong := row_out_of_order(rows)):
        raise VopdError(f"{file.name}: {wrong}")
    what, mark, more = rows.said.partition(";")
    new.said.append(f"{file.name}: {what}{_span(rows)}{mark}{more}")
    new.said += rows.doubts
    if NO_ZONE in rows.said and ("picks", "times") not in values:
        own = named_from(name, folder).strip('"')
        new.said.append(
            f"to use their times: --set picks.times={shlex.quote(own)} --set "
            "picks.utc_offset_h=2.0, the hours by which the camera's clock is ahead of UTC"
        )
    take_size(new, values, file.path)
    if rows.crs is None and not rows.geodetic:
        new.needed["track", "crs"] = "the file has x and y"
    if rows.time_s is not None and rows.geodetic:
        longitude, latitude, height = rows.coordinate.T
        new.scatter_m = scatter_of(rows.time_s, earth_centred_m(latitude, longitude, height))
    new.track_height = rows.height or ""
    if rows.height is None:
        ask_height(new, "track", rows.crs)
        if rows.from_ground and ("track", "height") in new.needed:
            new.options["track", "height"] = GROUND
            new.needed["track", "height"] = rows.asks_ground
    if not _in_every_row(rows.sigma_m):
        if rows.usual_sigma_m is None:
            new.needed["track", "sigma_m"] = POSITION_ERROR
        else:
            values.setdefault(("track", "sigma_m"), toml_numbers(*rows.usual_sigma_m))
    if rows.velocity_m_s is not None and not _in_every_row(rows.velocity_sigma_m_s):
        ask_sigma(new, "track", "velocity_sigma_m_s")
    if rows.clock == "utc-column":
        new.needed["track", "clock"] = "the file does not say it"
    return rows


def _span(rows: TrackRows) -> str:
    """Say from when to when a track is; nothing of one without times."""
    if rows.time_s is None or not np.isfinite(rows.time_s).all() or not len(rows.time_s):
        return ""
    first_s, last_s = float(rows.time_s.min()), float(rows.time_s.max())
    if rows.clock == "seconds":
        told, unit = [f"{first_s:g}", f"{last_s:g}"], " s"
    else:
        dates = np.array([first_s * 1e3, last_s * 1e3]).round().astype("datetime64[ms]")
        told, unit = dates.astype(str).tolist(), ""
    return f", {' to '.join(dict.fromkeys(told))}{unit}"


CLICKS = "clicks.csv"
"""What `vopd pick` saves."""
TRACKED = "tracked.csv"
"""What `vopd track` writes."""
OF_CLICKS = "attitude {0} solves the frames with clicks, and all frames after vopd track {0}"
"""The commands to go on with where there are clicks to follow."""
FEW_PICKED = 0.5
"""Part of a video's frames; picks in fewer are to be followed through the others."""


def look_at_video(
    new: NewProject, values: KeyValues, folder: Path, names: Sequence[str], named: dict[str, str]
) -> int:
    """Say what the video is, and what it brings: times, size of the frames, perhaps a track.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        names: its files, or the folder of its frames
        named: the other files by what they are; a track in the video or beside it is added

    Returns:
        How many frames it has.
    """
    frames = open_frames(names)
    if frames.image_name and not is_film(Path(names[0])):
        raise VopdError(f"{frames.source}: images, not a video: give them as --images")
    several = [named_from(name, folder) for name in names]
    values["picks", "video"] = several[0] if len(several) == 1 else f"[{', '.join(several)}]"
    if not frames.image_name:
        values["picks", "times"] = toml_text(VIDEO)
    new.said.append(frames.about)
    ((_, picture),) = grey_frames(frames, 0, 0)
    own = toml_numbers(picture.shape[1], picture.shape[0])
    if (of_lens := values.get(("camera", "image_size_px"), own)) != own:
        new.said.append(
            f"{frames.source} has frames of {own}, upright, the lens is for {of_lens}: calibrate "
            "with video; or, if both are the same picture in two sizes, --set "
            f"camera.lens_size_px={of_lens.replace(' ', '')}"
        )
    values["camera", "image_size_px"] = own
    if "picks" not in named:
        values["picks", "file"] = toml_text(CLICKS)
        values["picks", "tracked"] = toml_text(TRACKED)
        new.then = "pick {} -o pick.html"
        new.said.append(
            f"no picks yet: click landmarks in a few frames with vopd pick, save {CLICKS} in "
            f"{folder}, and follow them through the others with vopd track"
        )
    at_a_place = any(section == "position" for section, _ in values)
    if "track" in named or at_a_place or frames.image_name:
        return len(frames)
    beside = [Path(names[0]).with_suffix(suffix) for suffix in (".SRT", ".srt")]
    for track in [*(str(one) for one in beside if one.is_file()), names[0]]:
        file = open_input(track, Path())
        try:
            read_by_content(TRACK_FORMATS, file)
        except VopdError:
            continue
        named["track"] = track
        if len(names) > 1:
            new.said.append(f"{track}: the track of the first file of the video alone")
        break
    return len(frames)


def is_film(images: Path) -> bool:
    """Whether a folder of images is the frames of a video: by numbers, without times or places."""
    if not images.is_dir():
        return False
    stills = stills_in(images)
    numbers = image_numbers([one.name for one in stills])
    if -1 in numbers or not len(set(numbers)) == len(stills) > 1:
        return False
    tags = [read_tags(one) for one in images_in(images)[:1]]
    return not any(np.isfinite([one.clock_s, one.position[0]]).any() for one in tags)


def look_at_times(
    new: NewProject,
    values: KeyValues,
    folder: Path,
    rows: TrackRows,
    images: str | None,
    by_number: bool,
) -> None:
    """Say or ask what gives the frames their times, where the track is by time.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        rows: the track
        images: the folder of the images; None where there is none
        by_number: whether the frames have numbers and not names
    """
    if rows.time_s is None or (rows.image and not by_number):
        return
    ask_sigma(new, "track", "sigma_t_s")
    if rows.by_video and images is None:
        values.setdefault(("picks", "first_frame_t_s"), "0.0")
    if values.get(("picks", "times")) == toml_text(VIDEO):
        if rows.by_video:
            return
        _begin(new, rows)
        return
    if ("picks", "times") in values and images is None:
        return
    if images is not None:
        values["picks", "times"] = named_from(images, folder)
        tags = new.tags(Path(images))[0].values()
        zone = all(np.isfinite(one.zone_s) for one in tags if np.isfinite(one.clock_s))
        new.said.append(
            f"{images}: {count_text(len(tags), 'image')}, whose tags give the frames' times"
        )
        if not zone:
            new.needed["picks", "utc_offset_h"] = "the images' times do not say their zone"
        if rows.clock == "seconds":
            new.needed[EPOCH] = "UTC of the track's t = 0, as the images have dates"
    elif by_number or ("picks", "frame_rate_hz") in {*new.answered, *values}:
        new.needed["picks", "frame_rate_hz"] = "that of the video; the track is by time"
        _begin(new, rows)
    else:
        where = "--video names the video" if rows.by_video else "--images names the folder"
        new.needed["picks", "times"] = (
            f"the track is by time; {where}, --fps serves numbers in names, or "
            "--set picks.times=FILE, a CSV with image and t_s or t_utc"
        )


EPOCH = "flight", "epoch"


def _begin(new: NewProject, rows: TrackRows) -> None:
    """Ask when frame 0 is, by the clock of a track."""
    if rows.clock == "seconds":
        new.needed["picks", "first_frame_t_s"] = (
            "the track's time at frame 0, in seconds: 0 where both begin together"
        )
        return
    new.needed["picks", "first_frame_t_s"] = (
        "seconds of frame 0 after the epoch: 0 where that is its own time"
    )
    new.needed[EPOCH] = "UTC of frame 0, as the track is in UTC"


def look_at_wind(new: NewProject, values: KeyValues, folder: Path, name: str) -> None:
    """Say what the sounding of the wind is.

    Args:
        new: what is said and asked, to be added to
        values: the keys that are known, to be added to
        folder: where the project will be
        name: the file
    """
    new.said.append(_read(new, values, folder, "wind", name, WIND_FORMATS)[1].said)
