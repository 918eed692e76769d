"""The twelve input groups and the basic data as one table: field, columns, unit, meaning.

Source: TM X-3050, Appendix F (groups) and Appendix E (basic data), with the
FORMATs of the listing where the two differ.
"""

from __future__ import annotations

from dataclasses import dataclass

from vopd.cards.formats import Item, items
from vopd.findings import BASIC_DATA as BASIC_DATA_NUMBER
from vopd.findings import group_text


@dataclass(frozen=True)
class Field:
    """One field of a group's card: the listing's name for it, what it is, its unit."""

    name: str
    meaning: str
    unit: str = ""


@dataclass(frozen=True)
class Group:
    """One input group: its number, its FORMAT, how many cards it has, and its fields.

    A `list` group goes on over as many cards as it needs; its last field repeats.
    """

    number: int
    title: str
    format: int
    cards: str
    fields: tuple[Field, ...]
    is_list: bool = False

    @property
    def label(self) -> str:
        """What a reader calls it: `group 9`, or `basic data`."""
        return group_text(self.number)

    def layout(self) -> list[tuple[Field, Item]]:
        """Each field of one card with its columns; the last field repeats as the FORMAT does."""
        places = items(self.format)
        last = len(self.fields) - 1
        return [(self.fields[min(i, last)], item) for i, item in enumerate(places)]


def _group(
    number: int, title: str, fmt: int, cards: str, *fields: Field, is_list: bool = False
) -> Group:
    return Group(number, title, fmt, cards, fields, is_list)


GROUPS = {
    1: _group(
        1, "lens distortion", 76, "25",
        Field("XRR", "radial distance", "mm"),
        Field("RRR", "radial distortion", "micrometre"),
    ),
    2: _group(2, "title", 77, "1", Field("TITLE", "title, a 1 in column 1")),
    3: _group(
        3, "camera in the vehicle", 78, "1",
        Field("III", "number of trajectory cards (group 7)"),
        Field("IWV", "number of wind cards (group 4)"),
        Field("S1M", "yaw multiplier"), Field("S1A", "yaw offset", "deg"),
        Field("S2M", "pitch multiplier"), Field("S2A", "pitch offset", "deg"),
        Field("S3M", "roll multiplier"), Field("S3A", "roll offset", "deg"),
    ),
    4: _group(
        4, "wind", 79, "IWV",
        Field("ALT", "altitude above sea level", "ft"),
        Field("VXO", "wind velocity, + from south", "ft/s"),
        Field("VYO", "wind velocity, + from west", "ft/s"),
    ),
    5: _group(
        5, "counts", 80, "(NFR + 3)/16, rounded up",
        Field("NT", "number of landmarks (group 9)"),
        Field("NFR", "number of frames"),
        Field("NTFR", "number of time cards (group 6)"),
        Field("NPT", "number of landmarks in a frame"),
        is_list=True,
    ),
    6: _group(
        6, "time of frames", 81, "NTFR",
        Field("IFRM", "frame number"), Field("TIMX", "flight time", "s"),
    ),
    7: _group(
        7, "trajectory", 82, "III",
        Field("TX", "time", "s"),
        Field("XXX", "vehicle X, + east", "ft"),
        Field("YYY", "vehicle Y, + north", "ft"),
        Field("ZZZ", "vehicle Z, + up", "ft"),
        Field("VVX", "vehicle velocity, + north", "ft/s"),
        Field("VVY", "vehicle velocity, + east", "ft/s"),
        Field("VVZ", "vehicle velocity, + down", "ft/s"),
        Field("H", "vehicle altitude above sea level", "ft"),
    ),
    8: _group(
        8, "focal length, origin, first guess", 82, "1",
        Field("CC", "focal length", "mm"),
        Field("PHI", "origin geodetic latitude", "deg"),
        Field("THZ", "origin longitude, + east", "deg"),
        Field("RZ", "origin distance from Earth's centre", "1000 ft"),
        Field("SIG1", "initial camera yaw", "deg"),
        Field("SIG2", "initial camera pitch", "deg"),
        Field("SIG3", "initial camera roll", "deg"),
        Field("", "unused"),
    ),
    9: _group(
        9, "landmarks", 83, "NT",
        Field("ITGT", "landmark number"),
        Field("THJ", "landmark longitude degrees, + east", "deg"),
        Field("THJMI", "landmark longitude minutes", "min"),
        Field("PHIJ", "landmark latitude degrees", "deg"),
        Field("PHIJMI", "landmark latitude minutes", "min"),
        Field("RJ", "landmark altitude", "ft"),
    ),
    10: _group(
        10, "number of group 11 cards", 80, "1", Field("NOUT", "number of group 11 cards"),
        is_list=True,
    ),
    11: _group(
        11, "ignored in one frame", 84, "NOUT",
        Field("IFM", "frame number"),
        Field("JOUT", "landmark to ignore (100 first: the whole frame)"),
    ),
    12: _group(
        12, "return group, ignored in all frames", 80, "(NT + 1)/16, rounded up",
        Field("NGO", "return group"),
        Field("IOUT", "landmark to ignore"),
        is_list=True,
    ),
}  # fmt: skip

BASIC_DATA = Group(
    BASIC_DATA_NUMBER, "readings of the film", 86, "12 + 3 NPT a frame",
    (
        Field("ISAVE", "landmark number"),
        Field("XSAVE", "x on the reader", "in"),
        Field("YSAVE", "y on the reader", "in"),
        Field("IFRAM", "frame number"),
    ),
)  # fmt: skip


def group_of(number: int) -> Group:
    """The group of that number, 1 to 12, or the basic data."""
    return BASIC_DATA if number == BASIC_DATA_NUMBER else GROUPS[number]
