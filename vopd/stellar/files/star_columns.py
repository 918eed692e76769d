"""The columns of a star file: which there are, and how a cell of each is read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from vopd.geometry.sexagesimal import parse_angle_deg, parse_number

UNITS = ("mm", "px")
"""Units of image coordinates; they stand in the names of the columns, `x_mm` or `x_px`."""

KINDS = {
    "ra_deg,dec_deg": ("ra_deg", "dec_deg"),
    "ra_hours,dec_deg": ("ra_hours", "dec_deg"),
    "u,v,w": ("u", "v", "w"),
    "x_m,y_m,z_m": ("x_m", "y_m", "z_m"),
}
"""Columns that tell where a star or point is; a file has one of these sets, or only names."""

WORDS = ("name", "image", "utc")
"""Columns of text: the star's name, the photograph that it is in, and its date."""

NUMBERS = ("mag", "elongation")
"""Columns of numbers that may be empty: a star's magnitude, and its image's length over width."""


def _right_ascension_of_hours(text: str) -> float:
    """Degrees of a right ascension in hours: `5.2008`, `5 12 3` or `5h12m3s`."""
    degrees = parse_angle_deg(text, hours=True) * (1.0 if "h" in text else 15.0)
    if abs(degrees) > 360.0:
        raise ValueError(f"{text.strip()} is beyond +-24 hours (degrees go in column ra_deg)")
    return degrees


READERS: dict[str, Callable[[str], float]] = {
    "ra_deg": partial(parse_angle_deg, hours=True),
    "ra_hours": _right_ascension_of_hours,
    "dec_deg": parse_angle_deg,
}
"""How a column is read that is not a plain number."""

LIMITS = {"ra_deg": 360.0, "dec_deg": 90.0, "rho_xy": 0.999999}
LIMIT = 1e12
"""Largest size of any other number: nothing measured is larger, and no square overflows."""

SMALLEST_SIGMA, LARGEST_SIGMA = 1e-9, 1e6
"""Standard deviations of image coordinates: no weight made of them overflows."""


class ColumnError(ValueError):
    """A header or a cell that cannot be read; the text says why."""


@dataclass(frozen=True)
class StarColumns:
    """What the header of a star file says.

    Attributes:
        names: all columns, in their order
        unit: of the image coordinates, "mm" or "px"
        kind: a key of KINDS, or "" for a file of images alone
        sigmas: the columns of standard deviations: none, one, or x, y and possibly rho_xy
        ignored: columns that mean nothing here
    """

    names: tuple[str, ...]
    unit: str
    kind: str
    sigmas: tuple[str, ...]
    ignored: tuple[str, ...]

    @property
    def image(self) -> tuple[str, str]:
        """The columns of the image coordinates."""
        return f"x_{self.unit}", f"y_{self.unit}"


def read_columns(names: tuple[str, ...], *, images_only: bool) -> StarColumns:
    """Find out what a header's columns are.

    Args:
        names: the names, in small letters
        images_only: only image coordinates are asked for

    Raises:
        ColumnError: a column stands twice or is missing, or two are of different kinds.
    """
    twice = sorted({name for name in names if name and names.count(name) > 1})
    if twice:
        raise ColumnError(f"the header names a column twice: {', '.join(twice)}")
    given = [unit for unit in UNITS if f"x_{unit}" in names or f"y_{unit}" in names]
    if len(given) > 1:
        raise ColumnError("the header must name x_mm and y_mm, or x_px and y_px, not both")
    unit = given[0] if given else "mm"
    image = (f"x_{unit}", f"y_{unit}")
    if missing := [name for name in image if name not in names]:
        other = "" if given else " (or x_px and y_px)"
        raise ColumnError(
            f"the header must name {image[0]} and {image[1]}{other}: {', '.join(missing)} missing"
        )
    kind = "" if images_only else _kind(names)
    sigmas = () if images_only else _sigmas(names, unit)
    known = {*image, *KINDS.get(kind, ()), *WORDS, *NUMBERS, *sigmas}
    ignored = (
        () if images_only else tuple(filter(None, (name for name in names if name not in known)))
    )
    return StarColumns(names, unit, kind, sigmas, ignored)


def read_cell(text: str, name: str) -> float:
    """Read the number in one cell.

    Args:
        text: the cell
        name: its column

    Raises:
        ColumnError: it is not a number, or too large.
    """
    if not text.strip():
        raise ColumnError(f"{name}: the cell is empty")
    try:
        value = READERS.get(name, parse_number)(text)
    except ValueError as error:
        hint = " (with a decimal point, not a comma)" if "," in text else ""
        raise ColumnError(f"{name}: {error}{hint}") from None
    limit = LIMITS.get(name, LIMIT)
    if abs(value) > limit:
        hint = " (are right ascension and declination exchanged?)" if name == "dec_deg" else ""
        raise ColumnError(f"{name}: {text.strip()} is beyond +-{limit:g}{hint}")
    if name.startswith("sigma") and not SMALLEST_SIGMA <= value <= LARGEST_SIGMA:
        raise ColumnError(
            f"{name}: {text.strip()} is not a standard deviation: "
            f"{SMALLEST_SIGMA:g} to {LARGEST_SIGMA:g}"
        )
    return value


def _kind(names: tuple[str, ...]) -> str:
    """Which set of KINDS the header names."""
    choices = ", ".join(f"`{kind}`" for kind in KINDS)
    given = [kind for kind, columns in KINDS.items() if any(name in names for name in columns)]
    if not given and "name" in names:
        return "name"
    if "ra_deg" in names or "ra_hours" in names:  # dec_deg stands in two sets
        given = [kind for kind in given if not kind.startswith("ra_") or KINDS[kind][0] in names]
    elif "dec_deg" in names and len(given) == 2:
        given = given[:1]
    if len(given) != 1:
        raise ColumnError(f"the header must name one of {choices}, or name")
    if missing := [name for name in KINDS[given[0]] if name not in names]:
        raise ColumnError(f"the header lacks {', '.join(missing)}")
    return given[0]


def _sigmas(names: tuple[str, ...], unit: str) -> tuple[str, ...]:
    """The columns of standard deviations: `sigma` or `sigma_mm`, or one each for x and y."""
    alone = [name for name in ("sigma", f"sigma_{unit}") if name in names]
    both = [name for name in (f"sigma_x_{unit}", f"sigma_y_{unit}") if name in names]
    for other in (one for one in UNITS if one != unit):
        wrong = [name for name in names if name.startswith("sigma") and name.endswith(f"_{other}")]
        if wrong:
            raise ColumnError(f"{wrong[0]}: the images are in {unit}, and so must be their sigmas")
    if len(alone) + bool(both) > 1:
        raise ColumnError(f"the header names two standard deviations: {', '.join(alone + both)}")
    if len(both) == 1:
        raise ColumnError(f"the header must name sigma_x_{unit} and sigma_y_{unit}, or neither")
    if "rho_xy" in names and not both:
        raise ColumnError(f"rho_xy goes with sigma_x_{unit} and sigma_y_{unit}")
    return (*alone, *both, *(["rho_xy"] if both and "rho_xy" in names else []))
