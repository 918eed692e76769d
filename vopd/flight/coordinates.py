"""Coordinates of files to Earth-centred positions on WGS 84, by their CRS and height datum.

Latitude, longitude and ellipsoidal height on WGS 84 need no other package; any other
coordinate reference system goes through pyproj, which must know the exact
transformation and have its grids: nothing is guessed.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import MapGrid
from vopd.files import optional_package
from vopd.findings import NeededError, VopdError
from vopd.geometry.earth import axes_at, earth_centred_m, geodetic
from vopd.inputs import MOST_NUMBER

M_PER_FT = 0.3048
ELLIPSOIDAL = "EPSG:4979"  # longitude, latitude and height above the ellipsoid
WGS84_NAMES = ("EPSG:4326", ELLIPSOIDAL, "WGS84", "WGS 84")
GEOIDS = {"egm96": "EPSG:5773", "egm2008": "EPSG:3855", "navd88": "EPSG:5703"}
HEIGHTS = ("ellipsoid", *GEOIDS, "same")
UTM = re.compile(r"^WGS ?84 ?UTM ?(\d{1,2}) ?([NS])$", re.I)
CODE = re.compile(r"^(?:urn:ogc:def:crs:EPSG:[\d.]*|EPSG):(\d+)$", re.I)
CRS84 = re.compile(r"^(?:urn:ogc:def:crs:OGC:[\d.]*|OGC):CRS84$", re.I)


@dataclass(frozen=True)
class HeightDatum:
    """What heights are counted from: a name of `HEIGHTS`, or a geoid by its undulation.

    `same`: landmarks and camera have one datum, whose height above the ellipsoid is
    not known and cancels.
    """

    name: str
    undulation_m: float = 0.0
    ground_m: float = 0.0  # on it, of what heights count from: the ground, a launch pad

    @property
    def said(self) -> str:
        """For a sentence."""
        if self.name == "undulation":
            return f"heights above a geoid {self.undulation_m:g} m above the ellipsoid"
        above = {
            "ellipsoid": "heights above the ellipsoid",
            "same": "heights above one level, not stated",
        }
        return above.get(self.name, f"heights above {self.name.upper()}")


def earth_centred_positions(
    coordinate: Floats, geodetic: bool, crs: str | None, height: HeightDatum | None, where: str
) -> Floats:
    """Transform coordinates to Earth-centred positions (N, 3), metres.

    Args:
        coordinate: longitude, latitude, height, or x (east), y (north), z, (N, 3)
        geodetic: whether they are longitude and latitude
        crs: the coordinate reference system; None for WGS 84 longitude and latitude
        height: what the heights are counted from; None where the CRS has a vertical axis
        where: file or section, for errors

    Raises:
        VopdError: where the CRS is not known or the transformation is not exact
    """
    name = crs_name(crs) if crs is not None else "EPSG:4326"
    if (np.abs(coordinate) > MOST_NUMBER).any():
        row, axis = np.unravel_index(np.nanargmax(np.abs(coordinate)), coordinate.shape)
        largest = f"{coordinate[row, axis]:g} is too large for a coordinate"
        raise VopdError(f"{where}: {largest}, that of position {row + 1}")
    if name in WGS84_NAMES:
        longitude, latitude, h = coordinate.T
        if (np.abs(latitude) > 360.0).any() and (np.abs(longitude) > 360.0).any():
            raise VopdError(
                f"{where}: {longitude[0]:g}, {latitude[0]:g} are metres of a grid and no degrees: "
                f"{GIVE_METRES}"
            )
        if (far := np.abs(latitude) > 90.0).any():
            raise VopdError(f"{where}: latitude {latitude[far][0]:g}: x is the longitude")
        if (far := np.abs(longitude) > 360.0).any():
            raise VopdError(f"{where}: longitude {longitude[far][0]:g}: it is -180 to 360")
        vertical = name == ELLIPSOIDAL
    else:
        if geodetic and not crs_is_geographic(name, where):
            raise VopdError(f"{where}: latitude and longitude with {name}, a CRS that has none")
        vertical = has_height_axis(name, where)
        target = ELLIPSOIDAL if vertical else "EPSG:4326"
        longitude, latitude, h = _transform(name, target, coordinate, where)
    if vertical != (height is None):
        message = "the CRS has heights of its own: leave `height` out" if vertical else MISSING
        raise (VopdError if vertical else NeededError)(f"{where}: {message}")
    if name not in WGS84_NAMES and not geodetic:
        _refuse_degrees(name, coordinate, (latitude, longitude), where)
    if height is not None:
        h = _ellipsoidal(longitude, latitude, h, height, where)
    return earth_centred_m(latitude, longitude, h)


def _refuse_degrees(
    name: str, coordinate: Floats, found_deg: tuple[Floats, Floats], where: str
) -> None:
    """Refuse degrees in the place of metres of a grid: they are far outside the grid's area."""
    x, y = np.abs(coordinate[:, :2]).T
    if not ((x <= 360.0) & (y <= 360.0)).all() or crs_is_geographic(name, where):
        return
    if outside_area(name, earth_centred_m(*found_deg, np.zeros(len(x)))) is not None:
        raise VopdError(
            f"{where}: {coordinate[0, 0]:g}, {coordinate[0, 1]:g} are degrees and no metres of "
            f"{name}: give them as lat_deg and lon_deg, without crs"
        )


GIVE_METRES = "give them as x_m and y_m, and the grid as crs"
LONGEST_CRS = 20_000  # characters of a `crs`: a definition as WKT has some thousand

MISSING = (
    "`height` is needed: what heights are counted from, "
    f"{', '.join(HEIGHTS)} or {{ undulation_m = ... }}"
)
NO_GRID = (
    "give the geoid's height above the ellipsoid there, height = { undulation_m = ... }, or "
    '"same" where camera and landmarks have heights above one level'
)
NAMED_GRID = re.compile(r"Grid (\S+) is not available")


def _ellipsoidal(
    longitude: Floats, latitude: Floats, h: Floats, height: HeightDatum, where: str
) -> Floats:
    h = h + height.ground_m
    if height.name in GEOIDS:
        source = f"EPSG:4326+{GEOIDS[height.name].removeprefix('EPSG:')}"
        coordinate = np.stack([longitude, latitude, h], axis=1)
        where = f"{where} height: {height.name}"
        return _transform(source, ELLIPSOIDAL, coordinate, where, NO_GRID)[2]
    return h + height.undulation_m


def crs_name(text: str) -> str:
    """Name a CRS by its code; `WGS84 UTM 16N` is known to ODM only, and urn:ogc:... of GeoJSON."""
    stripped = text.strip().strip("'\"")
    if code := CODE.match(stripped):
        return f"EPSG:{code[1]}"
    if CRS84.match(stripped):  # the axes of all files are x before y
        return "EPSG:4326"
    utm = UTM.match(stripped)
    if utm and 1 <= int(utm[1]) <= 60:  # EPSG's codes go on with other grids
        return f"EPSG:{326 if utm[2].upper() == 'N' else 327}{int(utm[1]):02d}"
    return stripped


OWN_AXES = (
    "axes of your own, x true east and y true north of a point, it is +proj=tmerc "
    "+lat_0=LATITUDE +lon_0=LONGITUDE +datum=WGS84"
)


@cache
def _crs(name: str, where: str) -> Any:
    if len(name) > LONGEST_CRS:
        raise VopdError(f"{where}: crs has more than {LONGEST_CRS} characters: write a code")
    pyproj = optional_package("pyproj", "geo", f"{where}: the CRS {name}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of +init=epsg:, which is understood
            crs = pyproj.CRS.from_user_input(name)
            if crs.is_projected:
                pyproj.Proj(crs)
    except pyproj.exceptions.CRSError as error:
        raise VopdError(
            f"{where}: crs {name!r} is not known: write a code, for instance EPSG:32633; of "
            f"{OWN_AXES}"
        ) from error
    except pyproj.exceptions.ProjError as error:
        message = "cannot be set up: write a code, for instance EPSG:32633"
        raise VopdError(f"{where}: crs {name!r} {message} (PROJ: {_short(error)})") from error
    if len(crs.axis_info) == 1:
        raise VopdError(
            f"{where}: crs {name!r} has heights alone: write that of x and y, too, for instance "
            f"EPSG:32633+{name.rpartition(':')[2]}"
        )
    return crs


def crs_is_geographic(name: str, where: str) -> bool:
    """Tell whether a CRS has latitude and longitude."""
    return name in WGS84_NAMES or bool(_crs(name, where).is_geographic)


def has_height_axis(name: str, where: str) -> bool:
    """Tell whether a CRS has three axes, and so says itself what heights are."""
    if name in WGS84_NAMES:
        return name == ELLIPSOIDAL
    return len(_crs(name, where).axis_info) == 3


def level_of_heights_m(
    height: HeightDatum | None, crs: str | None, position_m: Floats, where: str
) -> float:
    """Find how high above the ellipsoid heights begin at a place: what counts as 0 there.

    Args:
        height: what they are counted from; None where the CRS has heights of its own, or nothing
            is said
        crs: of the coordinates; None for WGS 84 longitude and latitude
        position_m: Earth-centred, (1, 3)
        where: file or section, for errors
    """
    here = geodetic(position_m)
    longitude, latitude, height_m = here.longitude_deg, here.latitude_deg, here.height_m
    if height is not None:
        begin = np.stack([longitude, latitude, 0.0 * height_m], axis=1)
        begin_m = earth_centred_positions(begin, True, None, height, where)
        return float(geodetic(begin_m).height_m[0])
    _, units = units_of_crs(crs, where)
    if crs is None or not units:
        return 0.0
    pyproj, own = optional_package("pyproj", "geo", f"{where}: {crs}"), _crs(crs_name(crs), where)
    lists = longitude.tolist(), latitude.tolist(), height_m.tolist()
    *_, (above,) = _transformer(pyproj, own, ELLIPSOIDAL).transform(*lists, direction="INVERSE")
    return float(height_m[0]) - float(above) * units[0].metres


class AxisUnit(NamedTuple):
    """The unit of an axis of a grid."""

    name: str  # in the plural
    metres: float

    @property
    def is_metre(self) -> bool:
        return abs(self.metres - 1.0) < SAME_UNIT

    @property
    def is_foot(self) -> bool:
        """Tell whether it is one of the feet, which differ by parts in a million."""
        return abs(self.metres / M_PER_FT - 1.0) < SAME_UNIT


SAME_UNIT = 1e-4  # of it


def units_of_crs(crs: str | None, where: str) -> tuple[list[AxisUnit], list[AxisUnit]]:
    """List the units of x and y, none of latitude and longitude, and that of heights of its own.

    None of a CRS that is not known, which is told elsewhere.
    """
    with suppress(VopdError):
        name = ELLIPSOIDAL if crs is None else crs_name(crs)
        if name not in WGS84_NAMES:
            units = [
                AxisUnit(f"{one.unit_name}s".replace("foots", "feet"), one.unit_conversion_factor)
                for one in _crs(name, where).axis_info
            ]
            of_heights = [] if _crs(name, where).is_geocentric else units[2:]
            return ([] if crs_is_geographic(name, where) else units[:2]), of_heights
    return [], []


UTM_ZONE = re.compile(r"(?:UTM ?)?0?(\d{1,2}) ?([C-HJ-NP-X]?)", re.I)
WORLD = re.compile(r"(World Geodetic|European Terrestrial Reference) System|International Terr")
"""Names of datums that are alike as far as WGS 84 itself is told."""


def other_system(crs: str | None, cell: str, where: str) -> str:
    """Say that a cell names another datum or UTM zone than a CRS has; empty for the same, or none.

    Args:
        crs: of coordinates; None for WGS 84 longitude and latitude
        cell: of a column beside them
        where: file or section, for errors
    """
    other = ""
    with suppress(VopdError):  # it is no datum, or pyproj is not there
        own, said = _crs(crs_name(crs or ELLIPSOIDAL), where), crs or "WGS 84"
        if zone := UTM_ZONE.fullmatch(cell):
            stated, band = own.utm_zone, zone[2].upper()  # S may be a band in the north, too
            north = band in ("", "S") or (band >= "N") == (stated or "N").endswith("N")
            if stated and (int(zone[1]) != int(stated[:-1]) or not north):
                other = f"{cell} is not the zone of {said}"
        elif cell:
            pair = [own.geodetic_crs.datum.name, _crs(cell, where).geodetic_crs.datum.name]
            if len({"world" if WORLD.match(one) else one for one in pair}) > 1:
                other = f"{cell} is not the datum of {said}"
    return f"{other}: give the crs of these coordinates, or remove the column" if other else ""


def other_angle(crs: str | None, where: str) -> str:
    """Name the unit of latitude and longitude of a CRS that does not count in degrees; or nothing.

    Nothing for a CRS that is not known, which is told elsewhere.
    """
    name = ELLIPSOIDAL if crs is None else crs_name(crs)
    try:
        if name in WGS84_NAMES or not crs_is_geographic(name, where):
            return ""
        unit = str(_crs(name, where).axis_info[0].unit_name)
    except VopdError:
        return ""
    return "" if unit == "degree" else unit


def doubt_of_heights(section: str, named: bool, crs: str | None) -> list[str]:
    """Doubt heights in metres beside x and y in feet, where no column says their unit.

    Args:
        section: of the file
        named: whether a column of the file names the unit of its heights
        crs: of its coordinates
    """
    units, heights = units_of_crs(crs, section)
    if named or heights or not units or units[0].is_metre:
        return []
    return [
        f"[{section}] file: x and y are {units[0].name}, by the grid {crs}, and heights are taken "
        "for metres: if they are feet as well, give a CSV with x_ft, y_ft, z_ft"
    ]


@np.errstate(all="ignore")
def map_grid(name: str, position_m: Floats) -> MapGrid | None:
    """Project positions on the grid of a projected CRS; None for one that is not projected.

    Args:
        name: of the CRS
        position_m: Earth-centred, (F, 3); NaN where not known
    """
    if name in WGS84_NAMES or not _crs(name, "crs").is_projected:
        return None
    (to_wgs84, level_m, counted), known = _plane(name), np.isfinite(position_m[:, 0])
    where = geodetic(position_m[known])
    here = where.longitude_deg.tolist(), where.latitude_deg.tolist(), where.height_m.tolist()
    # a projection alone takes WGS 84 for the CRS's own datum, hundreds of metres from it
    x_y = np.array(to_wgs84.transform(*here, direction="INVERSE")[:2]).T
    x_y[~np.isfinite(x_y[:, 0])] = np.nan  # outside the area of the transformation
    aside = np.array([0.0, ASIDE_M]) @ np.linalg.inv(level_m)
    ends = [to_wgs84.transform(*(x_y + side).T.tolist()) for side in (aside, -aside)]
    ahead, behind = (earth_centred_m(end[1], end[0], 0.0) for end in ends)
    east, north, _ = np.einsum("fij,fj->if", axes_at(where), ahead - behind)
    easting, northing, convergence_deg = columns = np.full((3, len(position_m)), np.nan)
    columns[:, known] = *x_y.T, np.degrees(np.arctan2(east, north))
    return MapGrid(name, easting, northing, convergence_deg, counted)


ASIDE_M = 100.0
"""Of a place on either side of it: by these the north of a grid is found. What the formulas of a
projection say of it holds on the grid's own datum, which may be turned against WGS 84, and from its
own meridian, which may be that of Paris."""


def east_north_m(name: str, position_m: Floats) -> tuple[Floats, Floats]:
    """Project positions on a grid: metres toward its east and north (F, 2), and its convergence.

    Args:
        name: of a projected CRS, whatever its unit, and the way in which its axes count
        position_m: Earth-centred, (F, 3); NaN where not known
    """
    grid, (_, level_m, _) = map_grid(name, position_m), _plane(name)
    assert grid is not None
    return np.stack([grid.easting, grid.northing], axis=1) @ level_m, grid.convergence_deg


TOWARD = {"east": (1.0, 0.0), "west": (-1.0, 0.0), "north": (0.0, 1.0), "south": (0.0, -1.0)}
"""Metres east and north by one metre along an axis of a grid, by its direction."""


@cache
def _plane(name: str) -> tuple[Any, Floats, str]:
    """Look up how x and y of a projected CRS count.

    Returns:
        The transformation to WGS 84, which takes milliseconds to make; metres east and north, as
        columns, by x and y; and what x and y are called, with their unit unless it is the metre.
    """
    pyproj = optional_package("pyproj", "geo", f"the CRS {name}")
    crs, ((unit, *_), _) = _crs(name, "crs").to_2d(), units_of_crs(name, "crs")
    sides = [one.direction for one in crs.axis_info]
    if sides == ["north", "east"] or not {*sides} & {"east", "west"}:  # or about a pole
        sides = ["east", "north"]
    counted = " and ".join(f"{one}ing" for one in sides)
    level_m = unit.metres * np.array([TOWARD[one] for one in sides])
    in_unit = counted if unit.is_metre else f"{counted} in {unit.name}"
    return _transformer(pyproj, crs, "EPSG:4326"), level_m, in_unit


def _transform(
    source: str, target: str, coordinate: Floats, where: str, hint: str = ""
) -> tuple[Floats, ...]:
    crs = _crs(source, where)
    pyproj = optional_package("pyproj", "geo", f"{where}: the CRS {source}")
    try:
        lists = coordinate.T.tolist()  # an array of one element has a path of its own, deprecated
        transformer = _transformer(pyproj, crs, target)
        return tuple(np.asarray(a) for a in transformer.transform(*lists, errcheck=True))
    except pyproj.exceptions.ProjError as error:
        if not hint and "+" in source and "=" not in source:
            hint = NO_GRID.replace("give", "give a CRS without heights, and")
        if hint:
            grids = _missing_grids(str(error), crs, target, coordinate)
            fetch = " and ".join(f"pyproj sync --file {grid}" for grid in grids)
            hint += f", or fetch its grid: {fetch}" if grids else "; no grid covers this place"
        named = NAMED_GRID.search(str(error))
        hint = hint or (
            f"fetch its grid: pyproj sync --file {named[1]}"
            if named
            else "these coordinates have no exact transformation: look at them and at the CRS"
        )
        raise VopdError(f"{where}: {source} to WGS 84: {hint} (PROJ: {_short(error)})") from error


def _transformer(pyproj: Any, crs: Any, target: str) -> Any:
    """Make the best transformation of a CRS to another, x before y in both."""
    return pyproj.Transformer.from_crs(
        crs, target, always_xy=True, allow_ballpark=False, only_best=True
    )


def _short(error: Exception) -> str:
    """Take PROJ's own sentence from the middle of pyproj's."""
    text = " ".join(str(error).split())
    inner = re.search(r"\(Internal Proj Error: (?:proj_\w+: )?(.*?)\)?$", text)
    return (inner[1] if inner else text)[:300]


def _missing_grids(message: str, crs: Any, target: str, coordinate: Floats) -> list[str]:
    """Name the grids without which coordinates cannot be transformed; none if none would do.

    Args:
        message: of PROJ, which may name one
        crs: of the coordinates, longitude and latitude or x and y
        target: the other CRS
        coordinate: (N, 3)
    """
    if named := NAMED_GRID.search(message):
        return [named[1]]
    pyproj = optional_package("pyproj.transformer", "geo")
    plane = pyproj.Transformer.from_crs(crs.to_2d(), "EPSG:4326", always_xy=True)
    here = np.array(plane.transform(*coordinate[:, :2].T.tolist()))
    if not np.isfinite(here).all():
        return []
    around = pyproj.AreaOfInterest(*here.min(axis=1), *here.max(axis=1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a grid is missing
        group = pyproj.TransformerGroup(crs, target, always_xy=True, area_of_interest=around)
    for one in group.unavailable_operations:
        if grids := [grid.short_name for grid in one.grids if not grid.available]:
            return grids
    return []


# Coordinates under the wrong CRS

BESIDE_DEG = 0.25  # beyond its area a CRS is still used where a site lies across its edge


def outside_area(crs: str | None, position_m: Floats) -> str | None:
    """Say that positions lie outside the area in which their CRS is used; None if they do not.

    Args:
        crs: its name; None for longitude and latitude on WGS 84
        position_m: Earth-centred, (N, 3)
    """
    name = crs_name(crs) if crs is not None else ELLIPSOIDAL
    area = None if name in WGS84_NAMES else _crs(name, "crs").area_of_use
    if area is None:
        return None
    where = geodetic(position_m)
    west = (where.longitude_deg - area.west + BESIDE_DEG) % 360.0
    across = area.east - area.west  # below 0 across 180 degrees
    wide = across + 360.0 * (across < 0.0) + 2.0 * BESIDE_DEG
    outside = (west > wide) | (where.latitude_deg < area.south - BESIDE_DEG)
    outside |= where.latitude_deg > area.north + BESIDE_DEG
    if not outside.any():
        return None
    k = int(np.argmax(outside))
    of = f"longitude {area.west:.6g} to {area.east:.6g}, latitude {area.south:.6g} to "
    return (
        f"{name} ({_crs(name, 'crs').name}) puts them at latitude {where.latitude_deg[k]:.2f}, "
        f"longitude {where.longitude_deg[k]:.2f}, outside its area ({of}{area.north:.6g}): are "
        "they of another coordinate reference system, in feet, or x and y exchanged? Of "
        f"{OWN_AXES}"
    )


# Coordinates by positions

ROUNDS = 6  # of Newton's method: the third moves by rounding
STEPS = ((1.0, 1.0, 1.0), (1e-5, 1e-5, 1.0))
"""Of its differences: metres; longitude and latitude, degrees, and height."""


def coordinates_at(
    wanted_m: Floats, near: Floats, positions: Callable[[Floats], Floats], steps: Sequence[float]
) -> Floats:
    """Find the coordinates of positions, by Newton's method from known ones near them, (N, 3).

    Args:
        wanted_m: Earth-centred positions, (N, 3)
        near: coordinates near them, (N, 3)
        positions: transforms coordinates to Earth-centred positions
        steps: of each coordinate, over which it differentiates
    """
    found = near
    for _ in range(ROUNDS):
        here = positions(found)
        sides = [(positions(found + one) - here, k) for k, one in enumerate(np.diag(steps))]
        by = np.stack([side / steps[k] for side, k in sides], axis=-1)
        found = found + np.linalg.solve(by, (wanted_m - here)[..., None])[..., 0]
    return found
