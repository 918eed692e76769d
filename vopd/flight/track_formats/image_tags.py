"""A folder of images: positions from their EXIF and XMP tags, and the angles of the gimbal.

The tags do not say what heights are counted from: makers differ, and so do receivers.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.input_file import InputFile, needed
from vopd.flight.track_formats.track_rows import TrackRows

SUFFIXES = (".jpg", ".jpeg", ".tif", ".tiff")
GPS, XMP = 0x8825, 700  # tags of EXIF and of TIFF
LATITUDE = ("GpsLatitude", "Latitude")
LONGITUDE = ("GpsLongitude", "GpsLongtitude", "Longitude")  # the second is what DJI writes
ALTITUDE = ("AbsoluteAltitude",)
GIMBAL = ("GimbalYawDegree", "GimbalPitchDegree", "GimbalRollDegree")
UNREADABLE = (OSError, ValueError, TypeError, KeyError, IndexError, ZeroDivisionError, SyntaxError)


class ImageTags(NamedTuple):
    """What the tags of an image say; NaN where they do not."""

    position: tuple[float, float, float]  # longitude, latitude, degrees, and altitude, metres
    gimbal_deg: tuple[float, float, float]  # yaw, pitch, roll of the view
    size_px: tuple[int, int]


def images_in(folder: Path) -> list[Path]:
    """The images of a folder, in order of their names."""
    if not folder.is_dir():
        return []
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)


def recognises(file: InputFile) -> bool:
    """Whether it is a folder with images."""
    return bool(images_in(file.path))


def read(file: InputFile) -> TrackRows:
    """The positions of the images of a folder that have one.

    Raises:
        VopdError: where no image has a position, or Pillow is not installed
    """
    paths = images_in(file.path)
    tags = [read_tags(path) for path in paths]
    position = np.array([one.position for one in tags])
    kept = np.isfinite(position).all(axis=1)
    if not kept.any():
        raise file.error(f"none of the {len(paths)} images has a position in its tags")
    gimbal: Floats = np.array([one.gimbal_deg for one in tags])[kept]
    without = f", {(~kept).sum()} without position" if not kept.all() else ""
    angles = "; gimbal angles for comparison only" if np.isfinite(gimbal).any() else ""
    return TrackRows(
        position[kept],
        True,
        "EPSG:4326",
        None,
        None,
        f"EXIF and XMP tags of {len(paths)} images{without}{angles}",
        [path.name for path, keep in zip(paths, kept, strict=True) if keep],
        gimbal_deg=gimbal if np.isfinite(gimbal).any() else None,
    )


def read_tags(path: Path) -> ImageTags:
    """The tags of one image: XMP's position, which has more digits, before EXIF's.

    Args:
        path: the image

    Raises:
        VopdError: where it is no image, or Pillow is not installed
    """
    pillow = needed("PIL.Image", "images", "reading the tags of images")
    try:
        with pillow.open(path) as image:
            gps = dict(image.getexif().get_ifd(GPS))
            xmp = _xmp_text(image)
            size = (int(image.size[0]), int(image.size[1]))
    except UNREADABLE as error:
        raise VopdError(f"{path.name}: not an image that can be read: {error}") from error
    try:
        longitude, latitude, altitude = _exif_position(gps)
    except UNREADABLE as error:
        raise VopdError(f"{path.name}: the GPS tags are not as EXIF has them: {error}") from error
    own = [_number(xmp, names) for names in (LONGITUDE, LATITUDE, ALTITUDE)]
    if np.isfinite(own[:2]).all() and any(own[:2]):
        longitude, latitude = own[:2]
    if np.isfinite(own[2]):
        altitude = own[2]
    yaw, pitch, roll = (_number(xmp, (name,)) for name in GIMBAL)
    return ImageTags((longitude, latitude, altitude), (yaw, pitch, roll), size)


def _xmp_text(image: Any) -> str:
    found = image.info.get("xmp") or getattr(image, "tag_v2", {}).get(XMP, b"")
    return found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found)


def _exif_position(gps: dict[int, Any]) -> tuple[float, float, float]:
    """Longitude, latitude, altitude by the GPS tags; altitude reference 1 is below sea level."""
    angles = []
    for reference, tag, negative in ((3, 4, "W"), (1, 2, "S")):
        if tag not in gps:
            return float("nan"), float("nan"), float("nan")
        degrees, minutes, seconds = (float(part) for part in gps[tag])
        size = degrees + minutes / 60.0 + seconds / 3600.0
        angles.append(-size if str(gps.get(reference, "")).strip("\0 ") == negative else size)
    altitude = float(gps[6]) if 6 in gps else float("nan")
    below = gps.get(5, b"\0")
    if below in (1, b"\x01"):
        altitude = -altitude
    return angles[0], angles[1], altitude


def _number(xmp: str, names: tuple[str, ...]) -> float:
    """The number of the first of these properties: an attribute or an element of any namespace."""
    for name in names:
        found = re.search(rf':{name}\s*=\s*"([^"]*)"|:{name}\s*>([^<]*)<', xmp)
        if found:
            try:
                return float((found[1] or found[2] or "").strip())
            except ValueError:
                continue
    return float("nan")
