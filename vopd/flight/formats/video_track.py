"""Tracks that come with a video: GoPro's GPMF inside it, and DJI's subtitles (.SRT) beside it.

Both are on the video's own clock: seconds after its first frame.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.files import reason
from vopd.findings import count_text, shown
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_tags import DILUTION_SAID
from vopd.flight.formats.track import TrackRows, sigma_of_dilution_m
from vopd.inputs import LAST_S, plain_number, whole_number
from vopd.video import payloads

# GPMF: a packet of data a second or so, in which each sensor has a stream of keys and values.
# A key has four letters, the type of a value, its size, and how many there are.

NUMBERS = {
    "b": "b", "B": "B", "s": "h", "S": "H", "l": "i", "L": "I", "f": "f", "d": "d", "j": "q",
    "J": "Q",
}  # fmt: skip
"""Types of numbers, and what `struct` calls them; all begin with the highest byte."""
BEGIN = b"DEVC"
GOOD_FIX = 3.0  # of three dimensions
DAY_ZERO = datetime(2000, 1, 1, tzinfo=UTC)


class Gps(NamedTuple):
    """A kind of GPS stream: columns of its samples, by number."""

    key: bytes  # of the samples
    name: str  # for a sentence
    place: tuple[int, int, int]  # latitude, longitude, height
    fix: int | None = None  # state of the receiver; None: in the stream's key GPSF
    dilution: int | None = None  # of precision; None: in the stream's key GPSP, or there are sigmas
    sigma: tuple[int, int] | None = None  # standard deviations, horizontal and vertical
    # columns and seconds of a unit whose sum is a clock of the samples' own
    clock: tuple[tuple[int, float], ...] = ()


STREAMS = (
    Gps(b"GPS9", "GPS9", (0, 1, 2), fix=8, dilution=7, clock=((5, 86_400.0), (6, 1.0))),
    Gps(b"GPS5", "GPS5", (0, 1, 2)),
    Gps(b"GPRI", "GPS RAW of a Karma", (1, 2, 3), fix=8, sigma=(4, 5), clock=((0, 1.0),)),
)
"""Streams of positions; the first of which a video has a fix is read."""


def read_gpmf(file: InputFile) -> TrackRows:
    """Read the positions in the GPMF of a video, those with a fix of three dimensions.

    Raises:
        VopdError: where there is none, or the video cannot be read
    """
    packets = payloads(file.path, BEGIN)
    if not packets:
        raise file.error("the video has no track inside (GoPro's GPMF): give the track as a file")
    reason = "no stream of positions (GPS5, GPS9)"
    for kind in STREAMS:
        samples = [
            _samples(kind, stream, start_s, lasts_s)
            for start_s, lasts_s, content in packets
            for stream in _streams(content)
            if kind.key in stream
        ]
        table = np.concatenate([*samples, np.empty((0, 8))])
        good = (table[:, 4] >= GOOD_FIX) & (table[:, 1:3] != 0.0).any(axis=1)
        good &= np.isfinite(table[:, 1:4]).all(axis=1) & (np.abs(table[:, 1]) <= 90.0)
        if good.any():
            return _track(kind, table[good], len(table))
        if len(table):
            reason = f"{count_text(len(table), 'position')}, none with a fix of three dimensions"
    raise file.error(f"the GPMF of the video has {reason}")


def _track(kind: Gps, table: Floats, count: int) -> TrackRows:
    """Put samples together: columns video_s, lat, lon, h, fix, horizontal, vertical, own_s."""
    time_s, own_s = table[:, 0], table[:, 7]
    said = f"GPMF of the video, {kind.name}, {count_text(len(table), 'position')}"
    said += f", {count - len(table)} more without a fix" if count > len(table) else ""
    if np.isfinite(own_s).all() and (np.diff(own_s) > 0.0).all():
        ahead_s = float(np.median(own_s - time_s))
        time_s = own_s - ahead_s
        if 1e8 < ahead_s < LAST_S - DAY_ZERO.timestamp():
            first = DAY_ZERO + timedelta(seconds=round(ahead_s))
            said += f", UTC of the first frame about {first:%Y-%m-%dT%H:%M:%SZ}"
    later = np.append(True, time_s[1:] > np.maximum.accumulate(time_s)[:-1])
    sigma: Floats = table[:, [5, 5, 6]]
    if kind.sigma is None:
        sigma = sigma_of_dilution_m(table[:, 5], table[:, 6])
    sigma = np.where(sigma > 0.0, sigma, np.nan)
    return TrackRows(
        table[later][:, [2, 1, 3]],
        True,
        "EPSG:4326",
        "seconds",
        time_s[later],
        f"{said}; seconds of the video, behind which a GPS may lag: sigma_t_s",
        sigma_m=sigma[later] if np.isfinite(sigma).any() else None,
        sigma_by=DILUTION_SAID if kind.sigma is None else "the receiver",
        by_video=True,
    )


Stream = dict[bytes, tuple[str, int, int, bytes]]
"""Type, size, number and content of values by their key."""


def _streams(content: bytes) -> Iterator[Stream]:
    """List the streams of a packet, through devices."""
    for key, (kind, _, _, inside) in _entries(content):
        if key == BEGIN and kind == "\0":
            yield from _streams(inside)
        elif key == b"STRM" and kind == "\0":
            yield dict(_entries(inside))


def _entries(content: bytes) -> Iterator[tuple[bytes, tuple[str, int, int, bytes]]]:
    """List keys, types, sizes, numbers and contents, as far as they are whole."""
    at = 0
    while at + 8 <= len(content):
        key, kind, size, count = struct.unpack_from(">4sBBH", content, at)
        inside = content[at + 8 : at + 8 + size * count]
        if len(inside) < size * count:
            return
        yield key, (chr(kind), size, count, inside)
        at += 8 + (size * count + 3) // 4 * 4


def _samples(kind: Gps, stream: Stream, start_s: float, lasts_s: float) -> Floats:
    """Read the samples of a packet, spread over its time; columns as for `_track`."""
    values = _numbers(stream, kind.key, scaled=True)
    table = np.full((len(values), 8), np.nan)
    table[:, 0] = start_s + lasts_s * np.arange(len(values)) / max(len(values), 1)
    table[:, 1:4] = values[:, kind.place]
    fix = _numbers(stream, b"GPSF").ravel()
    dilution = _numbers(stream, b"GPSP").ravel() / 100.0
    table[:, 4] = values[:, kind.fix] if kind.fix is not None else fix[:1] if len(fix) else GOOD_FIX
    if kind.sigma is not None:
        table[:, 5:7] = values[:, kind.sigma]
    elif kind.dilution is not None:
        table[:, 5:7] = values[:, [kind.dilution]]
    elif len(dilution):
        table[:, 5:7] = dilution[0]
    if kind.clock:
        table[:, 7] = sum(values[:, column] * unit_s for column, unit_s in kind.clock)
    return table


def _numbers(stream: Stream, key: bytes, scaled: bool = False) -> Floats:
    """Read the values of a key, (n, columns), perhaps each column divided by its scale."""
    if key not in stream:
        return np.empty((0, 1))
    kind, size, count, content = stream[key]
    letters, name = kind, key.decode("latin-1")
    if kind == "?":
        if b"TYPE" not in stream:
            raise ValueError(f"TYPE is missing, which lists the types of the values of {name}")
        letters = stream[b"TYPE"][3].rstrip(b"\0").decode("latin-1")
    unknown = [letter for letter in letters if letter not in NUMBERS]
    if unknown or not letters:
        raise ValueError(f"{name} has values of an unknown type, {''.join(unknown[:1])!a}")
    one = struct.Struct(">" + "".join(NUMBERS[letter] for letter in letters))
    if size % one.size or (kind == "?" and size != one.size):
        raise ValueError(f"{name} has values of {size} bytes, not {one.size}")
    values: Floats = np.array(list(one.iter_unpack(content)), float)
    values = values.reshape(count, (size // one.size) * len(letters))
    scale = _numbers(stream, b"SCAL") if scaled else np.empty(0)
    if scale.size not in (0, 1, values.shape[1]):
        raise ValueError(f"SCAL has {scale.size} numbers, and {name} has {values.shape[1]}")
    with np.errstate(all="ignore"):
        return values / scale.ravel() if scale.size else values


# Subtitles of a DJI drone: a block a frame, with the position in brackets; or, of older drones, a
# block a second, longitude first, with the number of satellites behind the place, and the height
# above the take-off. A Matrice 300 has latitude first, and metres in the place of satellites.

ARROW = re.compile("-->")
BLOCK = re.compile(r"(?<!\d)(\d+):(\d\d):(\d\d)[,.](\d{1,3})\s*-->", re.ASCII)
NUMBER = r"(-?[\d.][^\s\])<,;]*(?:,\d[^\s\])<,;]*)?(?: (?:ft|[NSEW])\b)?)"
"""A number to its end, whatever is in it."""
UNITS = re.compile("(?<=[0-9.])°$"), re.compile("(?<=[0-9.])[mM]$")  # of angles, of heights
FIELDS = tuple(
    re.compile(rf"\b(?:{names})\s*:\s*{NUMBER}")
    for names in ("latitude", "longitude|longtitude", "abs_alt|altitude")
)
BEFORE = re.compile(r"\bGPS\s*\(\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*,\s*(?:\d+|-?[\d.]+(M))\s*\)")
ABOVE = re.compile(rf"\b(?:BAROMETER:|Hb:|H )\s*{NUMBER}")
HEIGHTS_ABOVE = "BAROMETER, Hb or H"
NO_BRACKETS = (
    "no block has [latitude: ..] [longitude: ..] and abs_alt or altitude, or GPS(..) with "
    "BAROMETER or H; other .SRT are not read: make a CSV of it, t_s,lat_deg,lon_deg,h_m"
)
TAKE_OFF = (
    "heights are above the take-off: height = { ground_m = 412.0 } if that is at 412 m; GPS of "
    "four decimals is to 11 m"
)

UNSAID = (
    "altitude does not say what it counts from: by model it is the sea or the take-off, and a DJI "
    "FPV writes a tenth of it; compare it with a height that you know"
)


def read_srt(file: InputFile) -> TrackRows:
    """Read the positions of a DJI drone's subtitles, those that differ from the one before.

    A receiver finds fewer positions than there are frames, and the blocks between repeat the last.
    """
    arrows = [one.end() for one in ARROW.finditer(file.text)]
    values, lines, damaged = list[list[float]](), list[int](), list[int]()
    line, counted, above, unsaid = 1, 0, 0, False
    for at, end in zip(arrows, [*arrows[1:], len(file.text)], strict=True):
        line += file.text.count("\n", counted, at)
        start = BLOCK.search(file.text, max(counted, file.text.rfind("\n", counted, at)), at)
        counted = at
        found = [field.search(file.text, at, end) for field in FIELDS]
        several = [
            {one[1]: one[0] for one in field.finditer(file.text, at, end)} for field in FIELDS
        ]
        words = [one[1] for one in found if one is not None]
        before, high = (one.search(file.text, at, end) for one in (BEFORE, ABOVE))
        if older := len(words) < 3 and before is not None and high is not None:
            words = [before[1], before[2]] if before[3] else [before[2], before[1]]
            words.append(high[1])
        if start is None or len(words) < 3:
            damaged.append(line)
            continue
        for one, other, *_ in (list(texts.values()) for texts in several if len(texts) > 1):
            message = f"{shown(one)} and {shown(other)} are both there"
            raise file.error(f"{message}: remove one of them from all blocks", line)
        above += older
        unsaid |= found[2] is not None and found[2][0].startswith("altitude")
        hours, minutes, seconds, parts = start.groups()
        try:
            t = whole_number(hours) * 3600.0 + int(minutes) * 60.0 + int(seconds)
            own = [UNITS[k == 2].sub("", one) for k, one in enumerate(words)]
            place = [plain_number(one) for one in own]
        except ValueError as error:
            raise file.error(reason(error), line) from error
        if not np.isfinite(place).all():
            raise file.error("a number is too large", line)
        values.append([t + int(parts.ljust(3, "0")) / 1000.0, *place])
        lines.append(line)
    table = np.array(values).reshape(-1, 4)
    if not len(table):
        raise file.error(NO_BRACKETS)
    if 0 < above < len(table):
        raise file.error("some blocks have heights above the take-off, others above the sea")
    there = (table[:, 1:3] != 0.0).any(axis=1)
    new = np.append(True, (np.diff(table[:, 1:], axis=0) != 0.0).any(axis=1))
    new[-1] = True  # a drone that hovers
    kept = np.flatnonzero(there & new)
    if not len(kept):
        raise file.error("no block has a position: latitude and longitude are 0")
    if np.abs(table[kept, 1]).max() > 90.0:
        k = int(kept[np.argmax(np.abs(table[kept, 1]))])
        raise file.error(f"{table[k, 1]:g} is no latitude", lines[k])
    said = f"SRT of a DJI drone, {count_text(len(kept), 'position')} in {len(arrows)} blocks"
    if damaged:
        said += f", {len(damaged)} without time or position, the first in line {damaged[0]}"
    said += f"; {TAKE_OFF}" if above else f"; {UNSAID}" if unsaid else ""
    return TrackRows(
        table[kept][:, [2, 1, 3]],
        True,
        "EPSG:4326",
        "seconds",
        table[kept, 0],
        f"{said}; seconds of the video, behind which a GPS may lag: sigma_t_s",
        line=[lines[k] for k in kept.tolist()],
        by_video=True,
        from_ground=HEIGHTS_ABOVE if above else "",
    )
