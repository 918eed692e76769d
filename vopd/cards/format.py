"""The format of a deck: FORMATs, groups of cards, and the fields in their columns."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

from vopd.findings import BASIC_DATA as BASIC_DATA_NUMBER
from vopd.findings import group_text

# The input FORMATs as FORTRAN text, and the columns of their fields

FORMATS = {
    76: "(2F10.3)",
    77: "(80A1)",  # the listing reads the title into a Hollerith field: (80H...)
    78: "(2I5,6F5.0)",
    79: "(3F10.1)",
    80: "(16I5)",
    81: "(I5,F10.1)",
    82: "(8F10.1)",
    83: "(I10,5F10.2)",
    84: "(7I5)",
    86: "(8X,I2,30X,F7.3,3X,F7.3,6X,I4)",
}
"""FORMAT by statement number. Source: A 459 to A 470, as the printed pages confirm them."""

_EDIT_DESCRIPTOR = re.compile(r"(\d*)([IFAX])(\d*)(?:\.(\d+))?")


class FormatItem(NamedTuple):
    """One field of a FORMAT."""

    kind: str  # "I" for a whole number, "F" for a real number, "A" for text
    first: int  # first column, from 1
    last: int  # last column
    decimals: int = 0  # how many decimals a number without a punched point has

    @property
    def width(self) -> int:
        """How many columns the field has."""
        return self.last - self.first + 1

    @property
    def implied(self) -> float:
        """What a number without a punched point is divided by."""
        return 10.0**self.decimals

    @property
    def descriptor(self) -> str:
        """The FORTRAN edit descriptor of this field alone, such as `F10.3`."""
        return f"I{self.width}" if self.kind == "I" else f"F{self.width}.{self.decimals}"


@cache
def format_items(number: int) -> tuple[FormatItem, ...]:
    """List the fields of a FORMAT in order."""
    column, found = 1, []
    for repeat, kind, width, decimals in _EDIT_DESCRIPTOR.findall(FORMATS[number]):
        for _ in range(int(repeat or 1)):
            last = column + int(width or 1) - 1
            if kind != "X":
                found.append(FormatItem(kind, column, last, int(decimals or 0)))
            column = last + 1
    return tuple(found)


# The twelve input groups and the basic data: fields, columns, units, meaning
#
# Source: TM X-3050, Appendix F (groups) and Appendix E (basic data), with the
# FORMATs of the listing where the two differ.


class CardField(NamedTuple):
    """One field of the cards of a group: its FORTRAN name, its meaning and its unit."""

    name: str
    meaning: str
    unit: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class CardGroup:
    """One input group of the deck."""

    number: int  # 1 to 12, or `vopd.findings.BASIC_DATA`
    title: str  # what the group is about
    format: int  # statement number of its FORMAT
    cards: str  # how many cards it has, in words
    # the fields of one card; the last one repeats as often as the FORMAT has it
    fields: tuple[CardField, ...]
    is_list: bool = False  # whether the fields go on from card to card as one list of numbers

    @property
    def label(self) -> str:
        """The group's name in messages: `group 9`, or `basic data`."""
        return group_text(self.number)

    @cached_property
    def layout(self) -> tuple[tuple[CardField, FormatItem], ...]:
        """Each field of one card with its columns."""
        items = format_items(self.format)
        last = len(self.fields) - 1
        return tuple((self.fields[min(i, last)], item) for i, item in enumerate(items))

    @cached_property
    def columns(self) -> dict[str, int | slice]:
        """The index of each field among those of a card by its name, and of one that repeats."""
        repeats = len(self.layout) - len(self.fields)
        last = len(self.fields) - 1
        columns: dict[str, int | slice] = {f.name: k for k, f in enumerate(self.fields)}
        if repeats:
            columns[self.fields[last].name] = slice(last, None)
        return columns

    @cached_property
    def alike(self) -> tuple[tuple[int, ...], ...]:
        """The fields of one card by their index, those that are read alike together."""
        kinds: dict[tuple[str, int, int], list[int]] = {}
        for k, item in enumerate(format_items(self.format)):
            kinds.setdefault((item.kind, item.width, item.decimals), []).append(k)
        return tuple(map(tuple, kinds.values()))


def _group(
    number: int, title: str, fmt: int, cards: str, *fields: CardField, is_list: bool = False
) -> CardGroup:
    return CardGroup(number, title, fmt, cards, fields, is_list)


GROUPS = {
    1: _group(
        1, "lens distortion", 76, "25",
        CardField("XRR", "radial distance", "mm"),
        CardField("RRR", "radial distortion", "micrometre"),
    ),
    2: _group(2, "title", 77, "1", CardField("TITLE", "title, a 1 in column 1")),
    3: _group(
        3, "camera in the vehicle", 78, "1",
        CardField("III", "number of trajectory cards (group 7)"),
        CardField("IWV", "number of wind cards (group 4)"),
        CardField("S1M", "yaw multiplier"), CardField("S1A", "yaw offset", "deg"),
        CardField("S2M", "pitch multiplier"), CardField("S2A", "pitch offset", "deg"),
        CardField("S3M", "roll multiplier"), CardField("S3A", "roll offset", "deg"),
    ),
    4: _group(
        4, "wind", 79, "IWV",
        CardField("ALT", "altitude above sea level", "ft"),
        CardField("VXO", "wind velocity, + from south", "ft/s"),
        CardField("VYO", "wind velocity, + from west", "ft/s"),
    ),
    5: _group(
        5, "counts", 80, "(NFR + 3)/16, rounded up",
        CardField("NT", "number of landmarks (group 9)"),
        CardField("NFR", "number of frames"),
        CardField("NTFR", "number of time cards (group 6)"),
        CardField("NPT", "number of landmarks in a frame"),
        is_list=True,
    ),
    6: _group(
        6, "time of frames", 81, "NTFR",
        CardField("IFRM", "frame number"), CardField("TIMX", "flight time", "s"),
    ),
    7: _group(
        7, "trajectory", 82, "III",
        CardField("TX", "time", "s"),
        CardField("XXX", "vehicle X, + east", "ft"),
        CardField("YYY", "vehicle Y, + north", "ft"),
        CardField("ZZZ", "vehicle Z, + up", "ft"),
        CardField("VVX", "vehicle velocity, + north", "ft/s"),
        CardField("VVY", "vehicle velocity, + east", "ft/s"),
        CardField("VVZ", "vehicle velocity, + down", "ft/s"),
        CardField("H", "vehicle altitude above sea level", "ft"),
    ),
    8: _group(
        8, "focal length, origin, first estimate", 82, "1",
        CardField("CC", "focal length", "mm"),
        CardField("PHI", "origin geodetic latitude", "deg"),
        CardField("THZ", "origin longitude, + east", "deg"),
        CardField("RZ", "origin distance from Earth's centre", "1000 ft"),
        CardField("SIG1", "initial camera yaw", "deg"),
        CardField("SIG2", "initial camera pitch", "deg"),
        CardField("SIG3", "initial camera roll", "deg"),
        CardField("", "unused"),
    ),
    9: _group(
        9, "landmarks", 83, "NT",
        CardField("ITGT", "landmark number"),
        CardField("THJ", "landmark longitude degrees, + east", "deg"),
        CardField("THJMI", "landmark longitude minutes", "min"),
        CardField("PHIJ", "landmark latitude degrees", "deg"),
        CardField("PHIJMI", "landmark latitude minutes", "min"),
        CardField("RJ", "landmark altitude", "ft"),
    ),
    10: _group(
        10, "number of group 11 cards", 80, "1", CardField("NOUT", "number of group 11 cards"),
        is_list=True,
    ),
    11: _group(
        11, "ignored in one frame", 84, "NOUT",
        CardField("IFM", "frame number"),
        CardField("JOUT", "landmark to ignore (100 first: the whole frame)"),
    ),
    12: _group(
        12, "return group, ignored in all frames", 80, "(NT + 1)/16, rounded up",
        CardField("NGO", "return group"),
        CardField("IOUT", "landmark to ignore"),
        is_list=True,
    ),
}  # fmt: skip

BASIC_DATA = CardGroup(
    BASIC_DATA_NUMBER, "readings of the film", 86, "12 + 3 NPT a frame",
    (
        CardField("ISAVE", "landmark number"),
        CardField("XSAVE", "x on the reader", "in"),
        CardField("YSAVE", "y on the reader", "in"),
        CardField("IFRAM", "frame number"),
    ),
)  # fmt: skip


def group_of(number: int) -> CardGroup:
    """Look up the description of a group, or of the basic data.

    Args:
        number: 1 to 12, or `BASIC_DATA_NUMBER`
    """
    return BASIC_DATA if number == BASIC_DATA_NUMBER else GROUPS[number]
