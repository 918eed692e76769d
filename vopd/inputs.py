"""Limits of input files: kind of file, bytes, lines, columns, depth, elements, digits.

A file from somebody else may ask for gigabytes or for ever in a few bytes. Every reader of a file
goes through the functions of this module, and what is beyond a limit is an error in one sentence.
"""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Protocol

from vopd.findings import VopdError, count_text, shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

# A limit and its comment are a row of docs/promises.md: python tools/limits.py --write
MOST_BYTES = 400_000_000  # bytes of a file that is read whole: XML, JSON, stars; tables have none
MOST_SETTINGS = 1_000_000  # bytes of TOML and YAML, whose parsers take microseconds a byte
LONGEST_LINE = 1_000_000  # characters of a line of a table
MOST_COLUMNS = 1_000  # columns of a table
MOST_ELEMENTS = 5_000_000  # elements of XML, lists and mappings of JSON, some 100 bytes each
MOST_VALUES = 20_000_000  # values of JSON, some 32 bytes each
MOST_NODES = 100_000  # values of YAML
DEEPEST = 50  # lists and mappings of YAML that stand in each other
DEEPEST_XML = 100  # elements of XML that stand in each other
MOST_DIGITS = 18  # digits of a whole number: of a frame (15 in a CSV), a camera, a pixel
MOST_NUMBER = 1_000_000_000_000  # of a flight's number: seconds, metres, degrees, pixels
LEAST_SIGMA, MOST_SIGMA = 1e-9, 1e9  # of standard deviations: their squares are numbers still
LONGEST_NAME = 1_000  # characters of the name of a landmark, an image or a frame
MOST_PARTS = 50  # parts of a dotted key of TOML, whose parser takes the square of them

TOO_DEEP = "lists or tables stand in each other by the hundreds"
DOTTED = re.compile(
    rf"""(?<![\w-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){{{MOST_PARTS}}}"""
)


YEAR = re.compile(r"=\s*\d{5,}-\d\d-\d\d[T ]")


def no_date(text: str) -> str:
    """Say of a line of TOML with a date that datetime does not have what to write instead.

    Args:
        text: the line

    Returns:
        Empty for others.
    """
    found = LEAP_SECOND.search(text)
    return leap_second(found[0]) if found else "a year has four digits" * bool(YEAR.search(text))


# Files


class Readable(Protocol):
    """Something that bytes are read from."""

    def read(self, size: int, /) -> bytes:
        """Read at most `size` bytes; none at the end."""


def no_file(path: str | os.PathLike[str], pipes: bool = False) -> str:
    """Say why a path is not to be read: it is a device, a pipe or a socket; empty if it may be."""
    try:
        mode = os.stat(path).st_mode  # noqa: PTH116
    except OSError:  # opening it says why
        return ""
    except ValueError:
        return "no file can have this name: a null character or half a character is in it"
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return ""
    if stat.S_ISCHR(mode):
        if pipes and _ends(path):
            return ""
        return "is a device, not a file"
    return "" if pipes else "is a pipe or a socket, not a file: write what comes from it to a file"


def _ends(path: str | os.PathLike[str]) -> bool:
    """Tell a terminal, and the device that is empty, from devices without an end."""
    if os.stat(path).st_rdev == os.stat(os.devnull).st_rdev:  # noqa: PTH116
        return True
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY)
    try:
        return os.isatty(descriptor)
    finally:
        os.close(descriptor)


def read_limited(file: Readable, most: int = MOST_BYTES) -> bytes:
    """Read a file to its end.

    Raises:
        ValueError: if it has more
    """
    blocks, size = [], 0
    while block := file.read(1 << 20):
        blocks.append(block)
        size += len(block)
        if size > most:
            raise ValueError(too_many_bytes(most))
    return b"".join(blocks)


def too_many_bytes(most: int = MOST_BYTES) -> str:
    """Say that a file has more bytes than are read."""
    return f"the file has more than {most // 1_000_000} MB"


# Formats that nest


def parse_toml(data: bytes) -> dict[str, Any]:
    """Read TOML.

    Raises:
        ValueError: if it is not valid, or beyond a limit
        RecursionError: if its values are nested too deep
    """
    if len(data) > MOST_SETTINGS:
        raise ValueError(too_many_bytes(MOST_SETTINGS))
    text = data.decode("utf-8-sig")
    if found := DOTTED.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise ValueError(f"line {line}: a key has more than {MOST_PARTS} parts")
    return tomllib.loads(text)


def parse_json(text: str) -> Any:
    """Read JSON.

    Raises:
        ValueError: if it is not valid, has a key twice, or has too many elements
        RecursionError: if its values are nested too deep
    """
    _refuse_many(text, "[{", MOST_ELEMENTS)
    _refuse_many(text, ",", MOST_VALUES)
    return json.loads(text, object_pairs_hook=_each_once)


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Make a mapping, of which other parsers of JSON take the last value of a key in silence."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError(twice(key for key, _ in pairs))
    return found


def twice(keys: Iterable[str]) -> str:
    """Say which key one mapping has twice, perhaps with two values; empty if each is there once."""
    first = set[str]()
    for key in keys:
        if key in first:
            return f"{shown(key)} stands there twice: remove one"
        first.add(key)
    return ""


def parse_xml(text: str) -> Element:
    """Read XML; entities may not be declared, of which few lines can make gigabytes.

    Raises:
        ValueError, ParseError: if it is not valid, declares an entity, or has too many elements or
            too deep ones, through all of which readers would go once for each level
    """
    from xml.etree import ElementTree

    if "<!ENTITY" in text:
        line = text.count("\n", 0, text.index("<!ENTITY")) + 1
        raise ValueError(f"line {line}: it declares an entity; write the text itself")
    _refuse_many(text, "<", MOST_ELEMENTS)
    root = ElementTree.fromstring(text.strip())
    level, depth = [root], 0
    while level:
        level, depth = [one for above in level for one in above], depth + 1
        if depth > DEEPEST_XML:
            raise ValueError(f"more than {DEEPEST_XML} elements stand in each other")
    return root


def _refuse_many(text: str, signs: str, most: int) -> None:
    if len(text) > most and sum(map(text.count, signs)) > most:
        raise ValueError(f"it has more than {most // 1_000_000} million elements")


def check_yaml(events: Iterable[Any]) -> None:
    """Check the events of a YAML file, before anything is made of them.

    Raises:
        ValueError: if there are too many, or they are nested too deep
    """
    depth = 0
    for number, event in enumerate(events):
        name = type(event).__name__
        depth += name.endswith("StartEvent") - name.endswith("EndEvent")
        if depth > DEEPEST:
            raise ValueError(TOO_DEEP)
        if number > MOST_NODES:
            raise ValueError(f"it has more than {MOST_NODES} values")


# Numbers


def plain_number(text: str) -> float:
    """Read a number as FORTRAN, C and spreadsheets write it: Python also takes 2_95 and ٢٩٥.

    Raises:
        ValueError: if it is none
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"{text!r} is not a number")
    return float(text)


def is_number(text: str) -> bool:
    """Tell whether `plain_number` reads a text."""
    try:
        plain_number(text)
    except ValueError:
        return False
    return True


def whole_number(text: str) -> int:
    """Read a whole number.

    Raises:
        ValueError: if it is none, or has more than `MOST_DIGITS` digits
    """
    text = text.strip()
    digits = text.removeprefix("-")
    if not (digits.isascii() and digits.isdigit()):
        raise ValueError(f"{text[:100]!r} is not a whole number")
    if len(digits) > MOST_DIGITS:
        raise ValueError(f"a whole number has {count_text(len(digits), 'digit')}")
    return int(text)


LATE_S = 3e8
"""No flight lasts so many seconds: they are counted from 1970."""
LAST_S = 1e10  # since 1970, in 2286
LATEST_CLOCK_S = 1e9
"""In 2001: clocks count from a date before, of 1970, 1980 or 2000; a flight from its own."""


GPS_AHEAD_S = (  # of UTC, from a date on
    (datetime(2017, 1, 1, tzinfo=UTC), 18.0),
    (datetime(2015, 7, 1, tzinfo=UTC), 17.0),
    (datetime(2012, 7, 1, tzinfo=UTC), 16.0),
    (datetime(2009, 1, 1, tzinfo=UTC), 15.0),
    (datetime(2006, 1, 1, tzinfo=UTC), 14.0),
)


def gps_ahead_s(moment: datetime | float | None) -> float:
    """Look up by how much GPS time is ahead of UTC, now where no date is known; NaN before 2006.

    Args:
        moment: a date, or seconds since 1970, of any size
    """
    if moment is None:
        return GPS_AHEAD_S[0][1]
    at_s = moment.timestamp() if isinstance(moment, datetime) else moment
    return next((ahead for since, ahead in GPS_AHEAD_S if at_s >= since.timestamp()), float("nan"))


GPS_ZERO_S = 315_964_800.0  # 1980-01-06, from which GPS counts its seconds, since 1970
A_DAY_S = 86_400.0


def gps_second(moment: datetime) -> float:
    """Convert a date to GPS seconds, those since 1980-01-06 on its clock; NaN before 2006."""
    return moment.timestamp() - GPS_ZERO_S + gps_ahead_s(moment)


def is_gps_second(second: float, epoch: datetime) -> bool:
    """Tell whether a time, as GPS seconds, is within a day of a date."""
    return abs(second - gps_second(epoch)) < A_DAY_S


def since_1970(epoch: datetime | None, first_s: float) -> str:
    """Say of times that are counted from 1970, or from 1980, that their zero is another date.

    Args:
        epoch: the date that is stated for t = 0, if any
        first_s: the least of the times

    Returns:
        Empty for others.
    """
    if epoch is None or not LATE_S <= first_s <= LAST_S or epoch.timestamp() < LATEST_CLOCK_S:
        return ""
    what, zero = "seconds since 1970", "1970-01-01T00:00:00Z"
    if is_gps_second(first_s, epoch):
        what = "GPS seconds, since 1980-01-06,"
        zero = f"{datetime.fromtimestamp(GPS_ZERO_S - gps_ahead_s(epoch), UTC):%Y-%m-%dT%H:%M:%SZ}"
    return (
        f"is the moment of t = 0, and the frames' times are from {first_s:.10g} s on, as {what} "
        f"are: write {zero}"
    )


MOMENT = re.compile(r"[\dW-]+.\d\d(:?\d\d(:?\d\d([.,]\d+)?)?)? ?(Z|[+-][\d:.]+)?|[\dW-]+", re.ASCII)
"""A date, or a date and time; Python also takes `11:58,5` for half a second after 11:58, and the
frame of a time code, `11:58:43:12`, for 12 hundredths."""


def read_moment(text: str) -> datetime:
    """Read a date and time in ISO 8601, of which only seconds may have a fraction.

    Raises:
        ValueError: if it is none
    """
    if not MOMENT.fullmatch(text):
        raise ValueError(f"{text!r} is not a date and time")
    return datetime.fromisoformat(text)


LEAP_SECOND = re.compile(r"(?<![\d-])[\d-]*[T ]\d\d:?59:?60(?!\d)[\d.Z:+-]*")


def leap_second(text: str) -> str:
    """Say of a date and time in a leap second, which datetime does not have, what to write instead.

    Args:
        text: any that is not read as a date and time

    Returns:
        Empty for others.
    """
    if not LEAP_SECOND.search(text):
        return ""
    return f"{text!r} is in a leap second, which is not read: write the second before or after it"


DATE_ALONE = re.compile(r"[\dW-]+", re.ASCII)


def date_alone(text: str) -> str:
    """Say of a date without a time of day, at which a photograph was taken, what to write instead.

    Args:
        text: any date, with a time or not

    Returns:
        Empty for others.
    """
    if not DATE_ALONE.fullmatch(text.strip()):
        return ""
    return f"{text!r} has no time of day: write the time, too, UTC, as {text.strip()}T21:00Z"


def utc_moment(text: str, of_day: bool = False) -> datetime:
    """Read a date and time in ISO 8601; it is UTC if it names no time zone.

    Args:
        text: as the user wrote it
        of_day: whether a date alone is refused

    Raises:
        VopdError: with what is wrong, and what to write instead
    """
    try:
        moment = read_moment(text)
        moment = moment.replace(tzinfo=moment.tzinfo or UTC).astimezone(UTC)
    except (ValueError, OverflowError) as error:
        message = f"{text!r} is not an ISO 8601 date and time, for instance 1974-08-27T17:30:00Z"
        raise VopdError(leap_second(text) or message) from error
    if of_day and (message := date_alone(text)):
        raise VopdError(message)
    return moment


def beyond_sigmas(values: Iterable[float]) -> str:
    """Describe the first standard deviation that is too small or too large to be meant.

    Args:
        values: standard deviations; 0 is exact, NaN is none

    Returns:
        What is wrong; empty if nothing is.
    """
    for value in values:
        if 0.0 < value < LEAST_SIGMA or value > MOST_SIGMA:
            limits = f"between {LEAST_SIGMA:g} and {MOST_SIGMA:g}"
            return f"{value:g}: a standard deviation must be {limits}"
    return ""


def plain_digits(texts: Sequence[str]) -> bool:
    """Tell whether no text has a digit or a separator that only Python takes."""
    joined = "".join(texts)
    return joined.isascii() and "_" not in joined
