"""Which frames were picked, and when each was taken: by their numbers, a CSV, or images' tags."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints, in_four_bytes
from vopd.findings import VopdError
from vopd.flight.csv_table import frames_of_column
from vopd.flight.files import InputFile
from vopd.flight.image_tags import images_in, read_tags
from vopd.flight.pick_formats.pick_rows import Names, PickRows
from vopd.flight.project import Project, Section, epoch_of
from vopd.flight.read_csv import read_csv

ZONE = "utc_offset_h"


class FrameTimes(NamedTuple):
    """When and of what each frame is: seconds on a clock, and its image's name."""

    time_s: Floats  # (F,) NaN where not known
    image: tuple[str, ...]  # (F,) or none
    epoch: datetime | None  # the date of zero, where it is known
    said: str = ""  # where the times come from, for a sentence
    whole_seconds: bool = False  # a camera's clock without parts of a second


class _Times(NamedTuple):
    """The times of a file, by the name of an image or the number of a frame."""

    known: dict[str, float]
    utc: bool  # seconds since 1970, and not of the flight
    said: str
    whole_seconds: bool = False


def frames_of(project: Project, rows: PickRows) -> tuple[Ints, FrameTimes, Ints]:
    """Frame numbers (F,), their times, and the index of each pick's frame (P,)."""
    number, image, index = _frames(rows.frame)
    return number, _times(project, number, image), index


def _frames(frame: Ints | Names) -> tuple[Ints, tuple[str, ...], Ints]:
    """Frame numbers (F,), names of images (F,) or none, and the index of each pick's frame (P,)."""
    if isinstance(frame, Names):
        image = sorted(frame.known)
        place = {name: k for k, name in enumerate(image)}
        by_known = in_four_bytes(np.array([place[name] for name in frame.known]))
        return np.arange(len(image)), tuple(image), by_known[frame.which]
    number = np.unique(frame)
    return number, (), in_four_bytes(np.searchsorted(number, frame))


def first_whole_second(utc_s: Floats) -> datetime:
    """The date and time of zero where a project gives none: the second of the first time."""
    try:
        return datetime.fromtimestamp(float(np.floor(np.nanmin(utc_s))), UTC)
    except (OverflowError, ValueError, OSError) as error:
        raise VopdError(f"{np.nanmin(utc_s):g} s after 1970 is no date of a frame") from error


def _times(project: Project, number: Ints, image: tuple[str, ...]) -> FrameTimes:
    section = project.section("picks")
    epoch = epoch_of(project)
    if section.has("times") and section.has("frame_rate_hz"):
        raise section.error("times", "frame_rate_hz is there too: give one of them")
    if not image and section.has("frame_rate_hz"):
        rate = section.number("frame_rate_hz", above=0.0)
        time_s = section.number("first_frame_t_s") + number / rate
        return FrameTimes(time_s, image, epoch)
    if not section.has("times"):
        return FrameTimes(np.full(len(number), np.nan), image, epoch)
    file = project.open("picks", "times")
    read = _of_images(section, file) if file.path.is_dir() else _of_csv(section, file, bool(image))
    wanted = list(image) or [str(n) for n in number.tolist()]
    time_s = np.array([read.known.get(one, np.nan) for one in wanted])
    if not np.isfinite(time_s).any():
        raise section.error("times", f"{file.name}: none of the frames is there ({wanted[0]})")
    if read.utc:
        epoch = epoch or first_whole_second(time_s)
        time_s = time_s - epoch.timestamp()
    return FrameTimes(time_s, image, epoch, read.said, read.whole_seconds)


def _of_csv(section: Section, file: InputFile, by_image: bool) -> _Times:
    """The times in a CSV with frame or image, and t_s or t_utc."""
    table = read_csv(file)
    keys = table.column("image" if by_image else "frame")
    utc = not table.has("t_s")
    time_s = table.times("t_utc") if utc else table.numbers("t_s")
    if not by_image:
        frame = np.array(frames_of_column(table))
        keys = [str(one) for one in frame.tolist()]
        order = np.argsort(frame, kind="stable")
        back = np.flatnonzero((np.diff(frame[order]) > 0) & ~(np.diff(time_s[order]) > 0.0))
        if len(back):
            earlier, later = order[back[0]], order[back[0] + 1]
            message = f"frame {keys[later]} is not after frame {keys[earlier]}"
            raise table.error(message, int(later), "t_utc" if utc else "t_s")
    known = dict(zip(keys, time_s.tolist(), strict=True))
    if len(known) < len(keys):
        raise section.error("times", f"{file.name}: a frame has two times")
    return _Times(known, utc, f"{file.name}: times of {len(known)} frames")


def _of_images(section: Section, file: InputFile) -> _Times:
    """The times in the tags of a folder of images, in UTC by their zone or the project's.

    Raises:
        VopdError: where the zone is not known, or there is no time
    """
    paths = images_in(file.path)
    tags = {path.name: read_tags(path) for path in paths}
    dated = {name: one for name, one in tags.items() if np.isfinite(one.clock_s)}
    if not dated:
        raise section.error(
            "times", f"{file.name}: none of its {len(paths)} images has a time in its tags"
        )
    zones = {one.zone_s for one in dated.values() if np.isfinite(one.zone_s)}
    without = [name for name, one in dated.items() if not np.isfinite(one.zone_s)]
    own = "by their own zone"
    if without:
        if not section.has(ZONE):
            raise section.error(
                ZONE,
                f"is needed: the tags of {without[0]} have a time and not its zone; give the hours "
                "by which the camera's clock is ahead of UTC, 2.0 for summer in central Europe",
            )
        own = f"{section.number(ZONE):+g} h ahead of UTC"
    elif section.has(ZONE):
        named = ", ".join(f"{zone / 3600.0:+g} h" for zone in sorted(zones))
        raise section.error(ZONE, f"the tags have their zone, {named}: leave the key out")
    hours = section.number(ZONE, 0.0)
    if not -12.0 <= hours <= 14.0:
        raise section.error(ZONE, f"{hours:g} is not of any zone: -12 to 14 hours")
    ahead = hours * 3600.0
    known = {
        name: one.clock_s - (one.zone_s if np.isfinite(one.zone_s) else ahead)
        for name, one in dated.items()
    }
    whole = any(one.whole_second for one in dated.values())
    said = f"{file.name}: times of {len(dated)} images by their EXIF tags, {own}"
    return _Times(known, True, said + (", whole seconds" if whole else ""), whole)
