"""Frames of a project and their times: by numbers, a table, a video, or tags of images."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints, in_four_bytes
from vopd.findings import VopdError, count_text, first_of
from vopd.flight.formats.columns import TIME
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_tags import images_in, tags_of
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.tables import frame_names, has_columns, read_csv, whole_numbers
from vopd.flight.project.keys import VIDEO, Project, Section
from vopd.inputs import since_1970
from vopd.video import find_images

ZONE = "utc_offset_h"


BRING_TIMES = (
    "give [picks] frame_rate_hz and first_frame_t_s, or times, a CSV or the folder of the images"
)


class FrameTimes(NamedTuple):
    """When and of what each frame is: seconds on a clock, and its image's name."""

    time_s: Floats  # (F,) NaN where not known
    image: tuple[str, ...]  # (F,) or none
    epoch: datetime | None  # the date of zero, where it is known
    said: str = ""  # where the times come from, for a sentence
    whole_seconds: bool = False  # a camera's clock without parts of a second
    doubts: tuple[str, ...] = ()  # warnings about images that have no time
    bring: str = BRING_TIMES  # what to give where frames need times and have none


YEAR_S = 365.25 * 86_400.0
MOST_YEARS = 3.0  # of a frame from t = 0


def doubt_of_years(times: FrameTimes, label: Callable[[int], str]) -> list[str]:
    """Warn of the frame that is farthest from t = 0, if it is years away from it.

    The seconds since 1970 are as many, and are meant so.
    """
    years = np.nan_to_num(times.time_s) / YEAR_S
    far = int(np.argmax(np.abs(years)))
    if times.epoch is None or not times.epoch.timestamp() or abs(years[far]) < MOST_YEARS:
        return []
    way = "before" if years[far] < 0.0 else "after"
    return [
        f"{label(far)} is {abs(years[far]):.1f} years {way} t = 0, {times.epoch:%Y-%m-%d}: was a "
        "clock not set (one that loses 1024 weeks of GPS is 19.6 years late)? Look at [flight] "
        "epoch and the dates of the file"
    ]


def frames_of(project: Project, rows: PickRows) -> tuple[Ints, FrameTimes, Ints]:
    """Number the frames (F,), with their times, and the index of each pick's frame (P,)."""
    number, image, index = number_frames(rows.frame)
    if not image or not project.section("picks").has("frame_rate_hz"):
        return number, _times(project, number, image), index
    from vopd.video import image_numbers, images_without_number  # of few flights

    lost = images_without_number(image)
    has = np.array([name not in lost for name in image])
    own = np.where(has, image_numbers(image), -1)
    own[~has] = own.max() + 1 + np.arange(len(lost))  # behind those that have a number
    order = np.argsort(own)
    number, image, has = own[order], tuple(image[k] for k in order), has[order]
    times = _times(project, number, image)
    times = times._replace(time_s=np.where(has, times.time_s, np.nan))
    index = in_four_bytes(np.argsort(order)[index])
    return number, times._replace(doubts=_doubts_of_images(project, lost)), index


def _doubts_of_images(project: Project, lost: Mapping[str, str]) -> tuple[str, ...]:
    """Warn of images that have no time.

    Args:
        project: with the file that names them
        lost: why, by their names
    """
    for name, why in lost.items():
        section = project.section("picks")
        tracked = section.has("tracked") and section.text("tracked_from") != "clicks"
        file = project.open("picks", "tracked" if tracked else "file")
        message = f"{why}; [picks] frame_rate_hz gives no time to {first_of(list(lost), 3)}"
        return (str(file.error(message, file.line_of(name))),)
    return ()


def number_frames(frame: Ints | Names) -> tuple[Ints, tuple[str, ...], Ints]:
    """Number the frames (F,); names of images (F,) or none; index of each pick's frame (P,)."""
    if isinstance(frame, Names):
        image = sorted(frame.known)
        place = {name: k for k, name in enumerate(image)}
        by_known = in_four_bytes(np.array([place[name] for name in frame.known]))
        return np.arange(len(image)), tuple(image), by_known[frame.which]
    number = np.unique(frame)
    return number, (), in_four_bytes(np.searchsorted(number, frame))


def first_whole_second(utc_s: Floats, section: Section, key: str) -> datetime:
    """Find the date and time of zero where a project gives none: the second of the first time.

    Args:
        utc_s: times since 1970, (F,)
        section: that of the file with the times
        key: which names it
    """
    try:
        return datetime.fromtimestamp(float(np.floor(np.nanmin(utc_s))), UTC)
    except (OverflowError, ValueError, OSError) as error:
        text = f"{section.values.get(key)}: {np.nanmin(utc_s):g} s after 1970 is no date of a frame"
        raise section.error(key, f"{text}: it is beyond the years 1 to 9999") from error


def refuse_since_1970(project: str, times: FrameTimes) -> FrameTimes:
    """Refuse frames in seconds since 1970 beside the date of another zero.

    Args:
        project: its name
        times: of the frames, on a clock whose zero the project's epoch is
    """
    if wrong := since_1970(times.epoch, float(np.fmin.reduce(times.time_s, initial=np.inf))):
        raise Section(project, "flight", {}).error("epoch", wrong)
    return times


def refuse_seconds(project: Project, times: FrameTimes, what: str) -> None:
    """Refuse seconds of a file beside frames with dates, where the date of their zero is not known.

    Args:
        project: which states it, or not
        times: of the frames; their epoch is another than the stated one where none is
        what: has the seconds
    """
    section = project.section("flight")
    if times.epoch != section.date("epoch"):
        message = f"is needed: the frames have dates, and {what} seconds after it"
        raise section.error("epoch", message)


def _times(project: Project, number: Ints, image: tuple[str, ...]) -> FrameTimes:
    section = project.section("picks")
    epoch = project.section("flight").date("epoch")
    if section.has("times") and section.has("frame_rate_hz"):
        raise section.error("times", "frame_rate_hz is there too: give one of them")
    of_video_s, said = np.zeros(0), ""
    if not image and section.has("video"):
        of_video_s, said = _shown(project, number)
    shown_s = of_video_s[number] if len(of_video_s) else np.full(len(number), np.nan)
    if section.has("frame_rate_hz"):
        rate = section.number("frame_rate_hz")
        time_s = section.number("first_frame_t_s") + number / rate
        by_click = section.has("tracked") and section.text("tracked_from") == "clicks"
        followed = by_click and len(of_video_s) > 0  # through all of the video
        rated = np.arange(len(of_video_s)) if followed else number
        off_s = np.ptp(rated / rate - (of_video_s if followed else shown_s))
        if off_s * rate > 1.0:
            raise section.error(
                "frame_rate_hz",
                f"{rate:g} a second, and by its own times the frames of {said}: they differ by "
                f'{off_s:.3g} s over the flight; write times = "video" in its place',
            )
        said = "" if np.isfinite(shown_s).all() else said
        return refuse_since_1970(project.name, FrameTimes(time_s, image, epoch, said))
    if not section.has("times"):
        times = FrameTimes(np.full(len(number), np.nan), image, epoch)
        return times._replace(bring=_bring_times(project))
    if section.text("times") == VIDEO:
        if image or not section.has("video"):
            message = "the picks name images, which have no place in a video" if image else ""
            raise section.error("times", message or "the key video is missing, which names it")
        time_s = section.number("first_frame_t_s") + shown_s
        return refuse_since_1970(project.name, FrameTimes(time_s, image, epoch, said))
    file = project.open("picks", "times")
    whole = False
    if file.path.is_dir():
        (known, said, whole), utc = times_of_images(section, file), True
    else:
        known, utc, others = times_of_csv(section, file, bool(image))
        said = f"{file.name}: times of {count_text(len(known), 'frame')}"
        said += f" (not used: {', '.join(others)})" if others else ""
    wanted = list(image) or [str(n) for n in number.tolist()]
    time_s = np.array([*known.values(), np.nan])[find_images([*known], wanted)]
    if not np.isfinite(time_s).any():
        raise section.error("times", f"{file.name}: none of the frames is there ({wanted[0]})")
    if not utc:
        return refuse_since_1970(project.name, FrameTimes(time_s, image, epoch, said))
    epoch = epoch or first_whole_second(time_s, section, "times")
    return FrameTimes(time_s - epoch.timestamp(), image, epoch, said, whole)


def _bring_times(project: Project) -> str:
    """Say what brings the frames their times; the picks themselves if they have a column of it."""
    section = project.section("picks")
    name = section.values.get("file")
    if isinstance(name, str) and (project.folder / name).is_file():  # not yet, where nobody clicked
        file = replace(project.open("picks"), columns=None)
        if has_columns(file, TIME, *((name,) for name in TIME)):
            return f'{file.name} has a column of times: write [picks] times = "{file.name}"'
    return BRING_TIMES


def _shown(project: Project, number: Ints) -> tuple[Floats, str]:
    """Read when all frames of the video are shown after its first, seconds, and a sentence.

    There are none of images, and where nothing decodes the video and the project has a frame rate.
    """
    from vopd.video import has_decoder, open_frames

    section = project.section("picks")
    paths = [project.folder / name for name in section.files("video")]
    try:
        frames = open_frames(map(str, paths))
    except VopdError as error:
        rated = section.values.get("times") != VIDEO
        if rated and not has_decoder() and all(one.is_file() for one in paths):
            return np.zeros(0), f"frame_rate_hz is not checked: {error}"
        raise section.error("video", str(error)) from error
    if frames.image_name:
        if section.values.get("times") != VIDEO:
            return np.zeros(0), frames.about if frames.missing else ""
        raise section.error("video", f"{frames.source}: images have no times of presentation")
    if number[-1] >= len(frames):
        has = f"{frames.source} has {count_text(len(frames), 'frame')}, counted from 0"
        if frames.lost:
            has += f", and {frames.lost} more that are not in the file: is it complete?"
        if frames.hidden:
            has += f", and {frames.hidden} more that its edit list does not show"
        raise section.error("video", f"frame {number[-1]} is picked, and {has}")
    if frames.lost and section.values.get("times") != VIDEO:  # those at the end may be any
        return np.zeros(0), f"frame_rate_hz is not checked: {frames.about}"
    return frames.time_s, frames.about


def times_of_csv(
    section: Section, file: InputFile, by_image: bool
) -> tuple[dict[str, float], bool, list[str]]:
    """Read the times from a CSV with frame or image, and t_s or t_utc.

    Returns:
        The times by the name of an image or the number of a frame, whether they are seconds since
        1970 and not of the flight, and the columns of further times, which are not read.
    """
    table = read_csv(file, ("frame", "image", *TIME))
    keys = frame_names(table, by_image)
    time_s, utc = table.clock(TIME)
    numbers = None if by_image else whole_numbers(table, "frame")
    frame = np.zeros(0, np.int64) if numbers is None else numbers
    known = dict[str, float]()
    for row, (frame_key, one) in enumerate(zip(keys, time_s.tolist(), strict=True)):
        if known.setdefault(frame_key, one) != one:  # as often as it has picks
            message = f"{frame_key} has two times, {known[frame_key]:.10g} and {one:.10g} s"
            raise section.error("times", str(table.error(message, row)))
    order = np.argsort(frame, kind="stable")  # of names none
    back = np.flatnonzero((np.diff(frame[order]) > 0) & ~(np.diff(time_s[order]) > 0.0))
    if len(back):
        earlier, later = order[back[0]], order[back[0] + 1]
        message = f"frame {keys[later]} is not after frame {keys[earlier]}"
        raise table.error(message, int(later), "t_utc" if utc else "t_s")
    there = [table.own[table.header.index(name)] for name in TIME if table.has(name)]
    return known, utc, there[1:]


def times_of_images(section: Section, file: InputFile) -> tuple[dict[str, float], str, bool]:
    """Read the times from the tags of a folder of images, in UTC by their zone or the project's.

    Returns:
        The times by the names of the images, where they come from as a sentence, and whether the
        camera's clock has whole seconds.

    Raises:
        VopdError: where the zone is not known, or there is no time
    """
    paths = images_in(file.path)
    tags = {path.name: one for path, one in tags_of(paths)[0].items()}
    dated = {name: one for name, one in tags.items() if np.isfinite(one.clock_s)}
    if not dated:
        of_all = "the image has no" if len(paths) == 1 else f"none of its {len(paths)} images has a"
        raise section.error("times", f"{file.name}: {of_all} time in its tags")
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
    said = f"{file.name}: times of {count_text(len(dated), 'image')} by their EXIF tags, {own}"
    return known, said + (", whole seconds" if whole else ""), whole
