"""Every kind of line of the 1974 listing: its FORMAT and the fields that stand in it.

All FORMATs of the listing (A 471 to A 490, as the printed pages prove them) are in
this table: printing and comparing both read it. `LINES` names the kinds; a
line's FORMAT is FORTRAN 77 text that fortranformat and gfortran accept, and the
columns of its fields are worked out from it. Column 1 is carriage control.

Quantities are the rows of `vopd.listing.compare`. The film measures are
millimetres, though appendix G says inches; only the readings are inches.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

_ITEM = re.compile(r"'([^']*)'|(/)|(\d+)X|\d+P(?=\d*E)|(\d*)([IFEGA])(\d+)(?:\.(\d+))?")


class Field(NamedTuple):
    """One field of a line: its name in the heading, its quantity, and its columns from 1."""

    name: str
    quantity: str
    descriptor: str  # the letter of its edit descriptor: I, F, E, G or A
    first: int
    last: int
    decimals: int = 0

    @property
    def width(self) -> int:
        """How many columns the field has."""
        return self.last - self.first + 1

    @property
    def columns(self) -> slice:
        """The columns of the field as a slice of a line of text."""
        return slice(self.first - 1, self.last)


@dataclass(frozen=True, eq=False, repr=False)
class Line:
    """One kind of line of the listing, with its FORMAT and its fields.

    `under` names the heading that the line follows, for lines that can only be
    recognised by it.
    """

    name: str
    format: str
    fields: tuple[Field, ...]
    literals: tuple[tuple[int, str], ...]  # (first column, text)
    under: str = ""

    @cached_property
    def text(self) -> str:
        """The text of the line with its fields blank, without trailing blanks."""
        line = ""
        for first, literal in self.literals:
            line = line.ljust(first - 1) + literal
        return line.rstrip()

    @cached_property
    def blank_lines(self) -> int:
        """How many blank lines the FORMAT puts before the line."""
        return len(self.format) - len(self.format[1:].lstrip("/")) - 1

    @cached_property
    def gaps(self) -> tuple[slice, ...]:
        """The columns between the fields; the last gap is the rest of the line."""
        starts = [0, *(field.last for field in self.fields)]
        ends = [*(field.first - 1 for field in self.fields), None]
        return tuple(slice(*gap) for gap in zip(starts, ends, strict=True) if gap[0] != gap[1])

    @cached_property
    def identity(self) -> Field | None:
        """The field that names what the line is about: a landmark or a frame."""
        names = ("landmark number", "frame number")
        return next((field for field in self.fields if field.quantity in names), None)


def _line(name: str, format_text: str, *named: tuple[str, str], under: str = "") -> Line:
    """Lay out a kind of line by its FORMAT and the name and quantity of each field in order."""
    column, names = 1, iter(named)
    fields: list[Field] = []
    literals: list[tuple[int, str]] = []
    for literal, slash, blanks, repeat, letter, width, decimals in _ITEM.findall(format_text):
        if literal:
            literals.append((column, literal))
        column = 1 if slash else column + len(literal) + int(blanks or 0)
        for _ in range(int(repeat or 1) if letter else 0):
            last = column + int(width) - 1
            fields.append(Field(*next(names), letter, column, last, int(decimals or 0)))
            column = last + 1
    if len(fields) != len(named):
        raise ValueError(f"{name}: {len(named)} names for {len(fields)} fields")
    return Line(name, format_text, tuple(fields), tuple(literals), under)


_LANDMARK = ("L-MARK", "landmark number")
_FRAME = ("FRAME", "frame number")

_TABLE = (
    # FORMAT 77, the title card: the 1 stands in the card's own column 1
    _line("title", "('1',A79)", ("TITLE", "text")),
    # FORMAT 88
    _line("frame ignored", "(///6X,'FRAME',I4,'IGNORED BY USERS DIRECTION')", _FRAME),
    # FORMAT 89 to 91: output group 1
    _line(
        "landmark heading",
        "(/1X,'L-MARK LONGITUDE  LAT-GOCN RAD ER KM  LAT-GODT  ALTITUDE-FT"
        "    XLAM       XMU       XNU')",
    ),
    _line("landmark ignored", "(I5,2X,'IGNORED BY USERS DIRECTION')", _LANDMARK),
    _line(
        "landmark",
        "(I5,2X,2F10.5,F10.3,F10.5,F11.3,3F10.7)",
        _LANDMARK,
        ("LONGITUDE", "landmark longitude"),
        ("LAT-GOCN", "geocentric latitude"),
        ("RAD ER KM", "landmark radius"),
        ("LAT-GODT", "geodetic latitude"),
        ("ALTITUDE-FT", "landmark altitude"),
        ("XLAM", "direction cosine"),
        ("XMU", "direction cosine"),
        ("XNU", "direction cosine"),
        under="landmark heading",
    ),
    # FORMAT 92 and 93: output group 2
    _line("vehicle heading", "('0VEHICLE        X         Y         Z     XPC       YPC      CC')"),
    _line(
        "vehicle",
        "(7X,3F10.2,3F10.5)",
        ("X", "vehicle position"),
        ("Y", "vehicle position"),
        ("Z", "vehicle position"),
        ("XPC", "frame centre reading"),
        ("YPC", "frame centre reading"),
        ("CC", "focal length"),
        under="vehicle heading",
    ),
    # FORMAT 95 and 94: output group 3
    _line("reading heading", "('0 L-MARK  XCO FINAL     YCO FINAL')"),
    _line(
        "reading",
        "(I4,2F15.8)",
        _LANDMARK,
        ("XCO FINAL", "landmark reading"),
        ("YCO FINAL", "landmark reading"),
        under="reading heading",
    ),
    # FORMAT 96 and 97: output group 4
    _line("film heading", "('0L-MARK        X              Y           R DIST         DELTA R')"),
    _line(
        "film",
        "(' ',I3,4F15.5)",
        _LANDMARK,
        ("X", "film coordinate"),
        ("Y", "film coordinate"),
        ("R DIST", "film radius"),
        ("DELTA R", "lens distortion"),
        under="film heading",
    ),
    # FORMAT 98 and 99: output group 5
    _line(
        "attitude heading",
        "('0 FRAME   TIME     SIG1     SIG2     SIG3     XP     YP        PSI      THETA"
        "      PHI   ALPHA    BETA     ETA')",
    ),
    _line(
        "attitude",
        "(I5,4F9.3,2F7.3,2F11.3,F9.3,3F8.3)",
        _FRAME,
        ("TIME", "time"),
        ("SIG1", "camera yaw"),
        ("SIG2", "camera pitch"),
        ("SIG3", "camera roll"),
        ("XP", "frame centre"),
        ("YP", "frame centre"),
        ("PSI", "vehicle yaw"),
        ("THETA", "vehicle pitch"),
        ("PHI", "vehicle roll"),
        ("ALPHA", "angle of attack"),
        ("BETA", "angle of sideslip"),
        ("ETA", "total angle of attack"),
        under="attitude heading",
    ),
    # FORMAT 100 and 101: output group 6
    _line("residual heading", "('0 RESIDUALS  RX(I)           RY(I)        L-MARK')"),
    _line(
        "residual",
        "(2X,2F16.8,I10)",
        ("RX(I)", "residual"),
        ("RY(I)", "residual"),
        _LANDMARK,
        under="residual heading",
    ),
    # FORMAT 102 and 103: a frame whose residuals are all exactly zero; once for every landmark
    _line("zero residual", "(//1P2E21.8)", ("RX(I)", "residual"), ("RY(I)", "residual")),
    _line("end of job", "(///' END OF JOB')"),
    # FORMAT 104: output group 7
    _line(
        "standard deviation",
        "('0',8X,'STANDARD DEVIATION OF RESIDUALS',F13.5)",
        ("STANDARD DEVIATION", "standard deviation"),
    ),
    # FORMAT 105
    _line("end of case", "(//1X,'END OF CASE')"),
    # FTLUP (appendix D); a blank line follows the location, then VARI, then VARD
    _line(
        "table out of order",
        "('1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION ',I5)",
        ("POSITION", "table position"),
    ),
    _line("table location", "(' TABLE IS STORED IN LOCATION 000000'/)"),
    _line(
        "table values",
        "(1X,8G15.8)",
        *((f"VALUE {place}", "table value") for place in range(1, 9)),
        under="table location",
    ),
)

LINES = {line.name: line for line in _TABLE}
"""Every kind of line by its name, in the order in which a page prints them."""


# Numbers in their fields, one by one


def line_without_numbers(line: Line) -> str:
    """Write a line with its fields blank, with its line end and the blank lines before it."""
    width = max((field.last for field in line.fields), default=0)
    return "\n" * line.blank_lines + line.text.ljust(width) + "\n"


def fixed(value: float, field: Field) -> str:
    """Write a number in an F or I field; asterisks if it does not fit."""
    width = field.width
    if not math.isfinite(value):
        sign = "-" if value < 0 else ""
        text = "NaN" if math.isnan(value) else sign + "Infinity"
        if len(text) > width:
            text = sign + "Inf"
    elif field.descriptor == "I":
        text = str(int(value))
    else:
        text = f"{value:.{field.decimals}f}"
        if text.startswith(("0.", "-0.")):
            text = text.replace("0.", ".", 1)
    return text.rjust(width) if len(text) <= width else "*" * width


def exponential(value: float, field: Field) -> str:
    """Write a number with an exponent, as FORMAT 102 prints it: one digit before the point."""
    return f"{value:.{field.decimals}E}".rjust(field.width)


def general(value: float, width: int, digits: int) -> str:
    """Write a number in a field G `width`.`digits`, as FTLUP prints its tables."""
    if not math.isfinite(value):
        return f"{value:.0f}".replace("inf", "Infinity").rjust(width)
    mantissa, power = f"{abs(value):.{digits - 1}E}".split("E")
    places = digits - 1 - int(power)  # behind the point
    sign = "-" if math.copysign(1.0, value) < 0.0 else ""
    if 0 <= places <= digits:
        text = f"{abs(value):.{places}f}".removeprefix("0")
        return f"{sign}{text if '.' in text else text + '.'}    ".rjust(width)
    exponent = int(power) + 1
    letter = "E" if abs(exponent) < 100 else ""  # which makes room for a third digit
    return f"{sign}.{mantissa.replace('.', '')}{letter}{exponent:+03d}".rjust(width)
