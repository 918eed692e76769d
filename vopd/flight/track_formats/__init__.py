"""Formats of tracks, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.files import InputFormat
from vopd.flight.formats import track as dji_mrk
from vopd.flight.track_formats import csv_track, gpx, image_folder, odm_geo
from vopd.flight.track_formats.track_rows import TrackRows

TRACK_FORMATS: tuple[InputFormat[TrackRows], ...] = (
    InputFormat("GPX", gpx.recognises, gpx.read),
    InputFormat("ODM geo.txt", odm_geo.recognises, odm_geo.read),
    InputFormat(
        "CSV (t_s or t_utc or image, lat_deg,lon_deg,h_m or x_m,y_m,z_m)",
        csv_track.recognises,
        csv_track.read,
    ),
    InputFormat("MRK of a drone", dji_mrk.recognises, dji_mrk.read),
    InputFormat("a folder of images", image_folder.recognises, image_folder.read),
)
