"""GPX tracks: latitude, longitude, elevation and UTC. The schema leaves the height's datum open."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile, needed
from vopd.flight.track_formats.track_rows import TrackRows


def recognises(file: InputFile) -> bool:
    """Whether it is GPX."""
    return "<gpx" in file.text


def read(file: InputFile) -> TrackRows:
    """All points of all tracks of a GPX file, in their order."""
    gpxpy = needed("gpxpy", "gpx", f"{file.name}: a GPX track")
    try:
        parsed = gpxpy.parse(file.text)
    except (gpxpy.gpx.GPXException, ValueError) as error:
        raise file.error(f"not valid GPX: {' '.join(str(error).split())}") from error
    points = [p for track in parsed.tracks for segment in track.segments for p in segment.points]
    if not points:
        raise file.error("no track point is in the file")
    for k, point in enumerate(points, 1):
        if point.time is None or point.elevation is None:
            raise file.error(f"track point {k} has no {'ele' if point.time else 'time'}")
    coordinate = np.array([[p.longitude, p.latitude, p.elevation] for p in points])
    wrong = np.flatnonzero(~np.isfinite(coordinate).all(axis=1) | (abs(coordinate[:, 1]) > 90.0))
    if len(wrong):
        raise file.error(f"track point {wrong[0] + 1} has a number that is no position")
    time_s = np.array([p.time.timestamp() for p in points])
    return TrackRows(
        coordinate, True, "EPSG:4326", "utc", time_s, f"GPX, {len(points)} positions, UTC"
    )
