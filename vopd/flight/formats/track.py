"""The .MRK file of drones with an RTK receiver (DJI, Autel): GPS time and position of each photo.

A line has the number of the photo, GPS seconds of week, [GPS week], what the antenna is
off from the camera in mm north, east, down, latitude, longitude, height above the
ellipsoid, three standard deviations in m north, east, up, and the state of the receiver.
DJI's manuals call latitude and longitude compensated, and the tags of the photos repeat
them: positions are taken as they stand.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime

import numpy as np

from vopd.flight.files import InputFile, reason
from vopd.flight.track_formats.track_rows import TrackRows

GPS_ZERO_S = datetime(1980, 1, 6, tzinfo=UTC).timestamp()
WEEK_S = 604_800.0
LABELS = {4: "N", 6: "E", 8: "V", 10: "Lat", 12: "Lon", 14: "Ellh", 19: "Q"}
LAYOUT = "a line is number, seconds, [week], N, E, V, Lat, Lon, Ellh, three sigmas and Q"
FIRST = re.compile(r"\s*\d+\s+[\d.]+\s+\[\d+\]\s")
FIXED, NO_POSITION = 50, 0  # states of the receiver


def recognises(file: InputFile) -> bool:
    """Whether the first line begins with a number, seconds and a week in brackets."""
    return bool(FIRST.match(file.text))


def read(file: InputFile) -> TrackRows:
    """The photos of a .MRK file, by their numbers; those without a position are left out."""
    photos, values, lines = [], [], []
    for line, text in enumerate(file.text.splitlines(), 1):
        fields = re.split(r"[\s,]+", text.strip())
        if fields == [""]:
            continue
        if len(fields) != 20 or any(fields[k] != label for k, label in LABELS.items()):
            raise file.error(LAYOUT, line)
        try:
            week = int(fields[2].strip("[]"))
            row = [float(fields[k]) for k in (1, 3, 5, 7, 9, 11, 13, 15, 16, 17, 18)]
            photo = int(fields[0])
        except ValueError as error:
            raise file.error(reason(error, str(error)), line) from error
        if not np.isfinite(row).all() or abs(row[4]) > 90.0 or not 0 < week < 10_000:
            raise file.error("a number is not finite, or no latitude or GPS week", line)
        if row[-1] != NO_POSITION:
            photos.append(str(photo))
            values.append([GPS_ZERO_S + week * WEEK_S + row[0], *row[1:]])
            lines.append(line)
    if not photos:
        raise file.error("no photo has a position")
    table = np.array(values)
    offset = np.linalg.norm(table[:, 1:4], axis=1).max() / 1000.0
    loose = int((table[:, 10] != FIXED).sum())
    said = f"MRK, {len(photos)} photos by number, GPS time, heights above the ellipsoid"
    said += f", {loose} without an RTK fix" if loose else ""
    return TrackRows(
        table[:, [5, 4, 6]],
        True,
        "EPSG:4326",
        "gps",
        table[:, 0],
        f"{said}; its antenna offsets of up to {offset:.2f} m are not added",
        photos,
        line=lines,
        sigma_m=table[:, [8, 7, 9]],
        height="ellipsoid",
        image_key=photo_number,
    )


def photo_number(name: str) -> str:
    """The number of a photo in its name: 29 of MAX_0029.JPG, of DJI_20230101120000_0029_V.JPG."""
    stem = name.rpartition("/")[2].rpartition(".")[0]
    found = re.search(r"_\d{14}_(\d{4})(?!\d)", stem) or re.search(r"(\d+)(?:_\D*)?$", stem)
    return str(int(found[1])) if found else name
