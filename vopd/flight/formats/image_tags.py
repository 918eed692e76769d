"""EXIF and XMP tags of an image: position, time, and the angles of the gimbal.

The tags do not say what heights are counted from: makers differ, and so do receivers.
DJI's UTCAtExposure is not read: where it was compared with the drone's .MRK file it was
GPS time, whatever its name says.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.files import optional_package, reason
from vopd.findings import VopdError, first_of, shown, size_text
from vopd.geometry.earth import earth_centred_m
from vopd.inputs import no_file, plain_number
from vopd.video import open_image, size_as_shown, stills_in

SUFFIXES = (".jpg", ".jpeg", ".tif", ".tiff")
GPS, EXIF, XMP = 0x8825, 0x8769, 700  # tags of EXIF and of TIFF
TAKEN, PART_OF_SECOND = 0x9003, 0x9291  # DateTimeOriginal, SubSecTimeOriginal
ZONES = (0x9011, 0x9010)  # OffsetTimeOriginal, OffsetTime
LATITUDE = ("GpsLatitude", "Latitude")
LONGITUDE = ("GpsLongitude", "GpsLongtitude", "Longitude")  # the second is what DJI writes
ALTITUDE = ("AbsoluteAltitude",)
ACCURACIES = (  # of XMP: names for east, north and up, m
    ("RtkStdLon", "RtkStdLat", "RtkStdHgt"),
    ("GPSXYAccuracy", "GPSXYAccuracy", "GPSZAccuracy"),
)
DATUM = 0x12  # GPSMapDatum
AS_WGS84 = re.compile(r"WGS(19)?84|ITRF|ETRS|JGD|GDA|NZGD2000|CGCS2000|SIRGAS", re.IGNORECASE)
"""Beginnings of datums that are WGS 84 within two metres, without blanks and hyphens."""
HORIZONTAL_ERROR, DILUTION = 0x1F, 0x0B  # GPSHPositioningError, GPSDOP
FOCAL_ON_FILM, FOCAL = 0xA405, 0x920A  # FocalLengthIn35mmFilm, FocalLength
PIXELS_A_UNIT, PIXEL_UNIT = 0xA20E, 0xA210  # FocalPlaneXResolution, FocalPlaneResolutionUnit
UNIT_MM = {2: 25.4, 3: 10.0, 4: 1.0}
FILM_MM = 36.0
USUAL_SIGMA_M = (3.0, 3.0, 5.0)  # of a receiver's position, east, north, up
DILUTION_SAID = "the dilution of precision, times 3 m, and upward 5 m"
GIMBAL = ("GimbalYawDegree", "GimbalPitchDegree", "GimbalRollDegree")
UNREADABLE = (OSError, ValueError, TypeError, KeyError, IndexError, ZeroDivisionError, SyntaxError)
NONE = float("nan")
NO_FIX = "latitude 0, longitude 0: a receiver without a fix writes that"
FARTHEST_ZONE_S = 14 * 3600.0  # from UTC
MOST_PIXELS = 20_000_000  # pixels of an image that is neither JPEG nor TIFF


class ImageTags(NamedTuple):
    """What the tags of an image say; NaN where they do not."""

    position: tuple[float, float, float]  # longitude, latitude, degrees, and altitude, metres
    gimbal_deg: tuple[float, float, float]  # yaw, pitch, roll of the view
    size_px: tuple[int, int]  # as it is shown upright
    clock_s: float  # what the camera's clock showed, seconds since 1970-01-01 of its own zone
    zone_s: float  # what that zone is ahead of UTC, seconds
    whole_second: bool  # the time has no part of a second
    sigma_m: tuple[float, float, float] = (NONE,) * 3  # of the position: east, north, up
    sigma_by: str = ""  # the tags it comes from
    damage: str = ""  # why some tags cannot be read, or make no position
    focal_px: float = NONE
    focal_by: str = ""  # the tags it comes from
    apart_m: float = NONE  # of the places in XMP and in EXIF, where both have one
    heights_apart_m: float = NONE  # likewise of the heights, where both may be of one kind

    @property
    def is_placed(self) -> bool:
        """Whether longitude, latitude and altitude are known."""
        return all(map(isfinite, self.position))


def images_in(folder: Path) -> list[Path]:
    """List the images of a folder that may have tags, or the one image that it is."""
    return [path for path in stills_in(folder) if path.suffix.lower() in SUFFIXES]


def read_tags(path: Path) -> ImageTags:
    """Read the tags of one image: XMP's position, which has more digits, before EXIF's.

    Raises:
        VopdError: where it is no image, or Pillow is not installed
    """
    optional_package("PIL.Image", "images", "reading the tags of images")
    if kind := no_file(path):
        raise VopdError(f"{path.name}: {kind}")
    try:
        with warnings.catch_warnings(record=True) as damage:
            warnings.simplefilter("always")  # Pillow warns of tags that it cannot read
            with _opened(path) as image:
                every = image.getexif()
                gps, exif = dict(every.get_ifd(GPS)), dict(every.get_ifd(EXIF))
                xmp = xmp_text(image)
                size = size_as_shown(image)
    except UNREADABLE as error:
        raise VopdError(f"{path.name}: not an image that can be read: {reason(error)}") from error
    why = "damaged tags" * bool(damage)
    try:
        longitude, latitude, altitude = exif_position(gps)
    except UNREADABLE as error:  # of one image, which costs the others nothing
        longitude = latitude = altitude = NONE
        why = f"the GPS tags give no position: {reason(error)}"
    own = [xmp_number(xmp, names) for names in (LONGITUDE, LATITUDE, ALTITUDE)]
    apart_m = heights_apart_m = NONE
    if abs(own[0]) <= 360.0 and abs(own[1]) <= 90.0 and any(own[:2]):
        here, there = earth_centred_m([own[1], latitude], [own[0], longitude], 0.0)
        apart_m = float(np.linalg.norm(here - there))
        longitude, latitude = own[:2]
    if isfinite(own[2]):
        heights_apart_m = _heights_apart_m(gps, own[2], altitude)
        altitude = own[2]
    if isfinite(longitude) and isfinite(latitude) and not isfinite(altitude):
        why = why or "there is no height beside its latitude and longitude"
    sigma_m, sigma_by = sigma_of_tags(gps, xmp)
    yaw, pitch, roll = (xmp_number(xmp, (name,)) for name in GIMBAL)
    return ImageTags(
        (longitude, latitude, altitude), (yaw, pitch, roll), size, *clock_of_tags(exif),
        sigma_m, sigma_by, why, *focal_of_tags(exif, size), apart_m,
        heights_apart_m,
    )  # fmt: skip


OF_ELLIPSOID = (2, 3, b"\x02", b"\x03")  # of GPSAltitudeRef, since EXIF 3.0


def _heights_apart_m(gps: Mapping[int, Any], own_m: float, exif_m: float) -> float:
    """Find by how much the heights of XMP and of EXIF differ; NaN where they may well do so.

    Drones write one height into both, some without its sign in XMP or 0 in EXIF. A height that
    EXIF says is above the ellipsoid is another than one above the sea.

    Args:
        gps: EXIF's tags
        own_m: the height in XMP
        exif_m: that in EXIF
    """
    if exif_m == 0.0 or gps.get(5) in OF_ELLIPSOID:
        return NONE
    return min(abs(own_m - exif_m), abs(own_m + exif_m))


FAR_APART_M = 30.0  # a second of latitude: EXIF's tags may be rounded to one
FAR_HEIGHTS_M = 10.0  # EXIF repeats XMP's height to a metre; a geoid's is 10 to 100
MOST_NAMED = 3


def doubts_of_places(every: Mapping[Path, ImageTags], name: str) -> tuple[str, ...]:
    """Doubt places and heights of XMP that are far from those of EXIF, which geotagging writes.

    Args:
        every: the tags of images
        name: of their folder
    """
    places = {path.name: one.apart_m for path, one in every.items() if one.apart_m > FAR_APART_M}
    heights = {
        path.name: one.heights_apart_m
        for path, one in every.items()
        if one.heights_apart_m > FAR_HEIGHTS_M and path.name not in places
    }
    pairs = (
        ("place in XMP (GpsLatitude, GpsLongitude)", places),
        ("height in XMP (AbsoluteAltitude)", heights),
    )
    return tuple(_doubt_of_xmp(name, what, apart) for what, apart in pairs if apart)


def _doubt_of_xmp(name: str, what: str, apart_m: Mapping[str, float]) -> str:
    """Say that something in XMP is taken, and how far that in EXIF is away, by names of images."""
    most_m = max(apart_m.values())
    far = f"{size_text(most_m)} m" if most_m < 1000.0 else f"{size_text(most_m / 1000.0)} km"
    return (
        f"{name}: {first_of([*apart_m], MOST_NAMED)}: the {what} is taken, and that in EXIF is "
        f"{'up to ' * (len(apart_m) > 1)}{far} away: images that were geotagged later have the "
        f"newer {what.split()[0]} in EXIF; if that is the right one, give the places as a CSV with "
        "image, lat_deg, lon_deg, h_m, or remove those in XMP"
    )


ReadTags = tuple[dict[Path, ImageTags], list[str]]
"""The tags of the images that can be read, and why others cannot be."""


def tags_of(paths: Sequence[Path]) -> ReadTags:
    """Read the tags of the images that can be read.

    Args:
        paths: of the images

    Returns:
        The tags, and why others cannot be read.

    Raises:
        VopdError: where none can, or Pillow is not installed
    """
    found, errors = dict[Path, ImageTags](), list[str]()
    for path in paths:
        try:
            found[path] = read_tags(path)
        except VopdError as error:
            errors.append(str(error))
    if errors and not found:
        raise VopdError(errors[0])
    return found, errors


def _opened(path: Path) -> Any:
    """Open an image for its tags, also one of more pixels than Pillow would decode.

    The pixels are not read, and so Pillow's refusal of images above 179 megapixels, which
    `PIL.Image.open` makes by the header alone, does not apply.
    """
    for kind in ("JpegImagePlugin.JpegImageFile", "TiffImagePlugin.TiffImageFile"):
        module, name = kind.split(".")
        try:
            return getattr(import_module(f"PIL.{module}"), name)(path)
        except SyntaxError:  # of another kind than its suffix says
            continue
    image = open_image(path)
    if image.width * image.height > MOST_PIXELS:  # of these all are decoded for their tags
        image.close()
        raise ValueError(f"{image.format} of more than {MOST_PIXELS // 1_000_000} megapixels")
    return image


def xmp_text(image: Any) -> str:
    """Read the XMP packet of an image; empty if there is none."""
    found = image.info.get("xmp") or getattr(image, "tag_v2", {}).get(XMP, b"")
    if not isinstance(found, bytes):
        return str(found)
    found = found.removeprefix(b"\xff\xfe").removeprefix(b"\xfe\xff")
    name = {b"\0": "utf-16-be"}.get(found[:1], "utf-8")  # it begins with < or a blank
    return found.decode("utf-16-le" if found[1:2] == b"\0" else name, "replace")


def exif_position(gps: dict[int, Any]) -> tuple[float, float, float]:
    """Read longitude, latitude, altitude from the GPS tags.

    References 1 and 3 are below sea level and below the ellipsoid.

    Raises:
        ValueError: where a tag says no place on the Earth
    """
    angles = []
    for axis, reference, tag, signs, most in (
        ("Longitude", 3, 4, "EW", 360.0), ("Latitude", 1, 2, "NS", 90.0),
    ):  # fmt: skip
        if tag not in gps:
            return NONE, NONE, NONE
        degrees, minutes, seconds = (float(part) for part in gps[tag])
        size = degrees + minutes / 60.0 + seconds / 3600.0
        side = _text(gps.get(reference, ""))
        if not side:
            raise ValueError(f"there is no GPS{axis}Ref, {signs[0]} or {signs[1]}")
        if side[0] not in signs:
            raise ValueError(f"GPS{axis}Ref is {side!r}, neither {signs[0]} nor {signs[1]}")
        if size > most or not (degrees >= 0.0 <= minutes <= 60.0 and 0.0 <= seconds <= 60.0):
            raise ValueError(f"GPS{axis} is {degrees:g} degrees {minutes:g}' {seconds:g}\"")
        angles.append(-size if side.startswith(signs[1]) else size)
    if not any(angles):
        raise ValueError(NO_FIX)
    datum = re.sub(r"\W", "", _text(gps.get(DATUM, "")))
    if datum and not AS_WGS84.match(datum):
        raise ValueError(f"GPSMapDatum is {shown(_text(gps[DATUM]))}, not WGS-84")
    altitude = float(gps[6]) if 6 in gps else NONE
    below = gps.get(5, b"\0")
    if below in (1, 3, b"\x01", b"\x03"):
        altitude = -altitude
    return angles[0], angles[1], altitude


def sigma_of_tags(gps: dict[int, Any], xmp: str) -> tuple[tuple[float, float, float], str]:
    """Read sigmas east, north, up of the position, m, and the tags that have them; NaN if none.

    XMP's own come before EXIF's horizontal error, and that before the dilution of precision.
    EXIF has nothing for the height: upward it is taken as 5/3 of the horizontal one, the ratio of
    `USUAL_SIGMA_M`, which is an assumption of ours.
    """
    for names in ACCURACIES:
        east, north, up = (xmp_number(xmp, (name,)) for name in names)
        if all(0.0 < one < float("inf") for one in (east, north, up)):
            return (east, north, up), f"XMP {', '.join(dict.fromkeys(names))}"
    for tag, by, factor in (
        (HORIZONTAL_ERROR, "GPSHPositioningError, and upward 5/3 of it", 1.0 / USUAL_SIGMA_M[0]),
        (DILUTION, DILUTION_SAID, 1.0),
    ):
        try:
            size = factor * float(gps.get(tag, 0.0))
        except UNREADABLE:  # 0/0 where the receiver had no fix
            continue
        if 0.0 < size < float("inf"):
            east, north, up = (size * usual for usual in USUAL_SIGMA_M)
            return (east, north, up), by
    return (NONE,) * 3, ""


def focal_of_tags(exif: dict[int, Any], size_px: tuple[int, int]) -> tuple[float, str]:
    """Estimate the focal length, pixels, and name the tags it comes from; NaN if there is none.

    The length for 35-mm film is by the longer side of its frame, 36 mm, as OpenSfM has it; by the
    diagonal, as some makers count, it is 4 % less in images of 4 to 3.
    """
    try:
        film_mm = float(exif.get(FOCAL_ON_FILM, 0.0))
        if 0.0 < film_mm < float("inf"):
            by = f"FocalLengthIn35mmFilm, {film_mm:g} mm"
            return film_mm / FILM_MM * max(size_px), by
        focal_mm, pixels = (float(exif.get(tag, 0.0)) for tag in (FOCAL, PIXELS_A_UNIT))
        unit_mm = UNIT_MM.get(int(exif.get(PIXEL_UNIT, 2)), 0.0)
        if 0.0 < focal_mm * pixels * unit_mm < float("inf"):
            return focal_mm * pixels / unit_mm, "FocalLength and FocalPlaneXResolution"
    except UNREADABLE:
        pass
    return NONE, ""


def clock_of_tags(exif: dict[int, Any]) -> tuple[float, float, bool]:
    """Read the camera's clock, its zone, and whether the time is in whole seconds."""
    try:
        taken = datetime.strptime(_text(exif.get(TAKEN, "")), "%Y:%m:%d %H:%M:%S")
        clock = taken.replace(tzinfo=UTC).timestamp()
    except ValueError:  # no time, or the blanks of a clock that was never set
        return NONE, NONE, True
    part = _text(exif.get(PART_OF_SECOND, ""))
    known = part.isascii() and part.isdigit()
    return clock + (float(f"0.{part}") if known else 0.0), zone_of_tags(exif), not known


def zone_of_tags(exif: dict[int, Any]) -> float:
    """Read how far the camera's zone is ahead of UTC, seconds; NaN if no tag says it."""
    for tag in ZONES:
        found = re.fullmatch(r"([+-])(\d\d):(\d\d)", _text(exif.get(tag, "")), re.ASCII)
        if found:
            size = 3600.0 * int(found[2]) + 60.0 * int(found[3])
            if size <= FARTHEST_ZONE_S and int(found[3]) < 60:
                return -size if found[1] == "-" else size
    return NONE


def _text(value: Any) -> str:
    return str(value).strip("\0 ")


def xmp_number(xmp: str, names: tuple[str, ...]) -> float:
    """Read the first of these properties as a number, of any namespace; NaN if there is none."""
    for name in names:
        found = re.search(rf""":{name}\s*(?:=\s*(?:"([^"]*)"|'([^']*)')|>([^<]{{0,100}})<)""", xmp)
        if found:
            try:
                return plain_number("".join(filter(None, found.groups())).strip())
            except ValueError:
                continue
    return NONE
