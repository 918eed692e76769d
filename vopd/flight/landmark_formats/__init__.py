"""Formats of files of landmarks, one row each; the next format is one more file and row."""

from __future__ import annotations

from vopd.flight.files import InputFormat
from vopd.flight.landmark_formats import csv_landmarks, gcp_landmarks, geojson
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows

LANDMARK_FORMATS: tuple[InputFormat[LandmarkRows], ...] = (
    InputFormat("GeoJSON", geojson.recognises, geojson.read),
    InputFormat("gcp_list.txt", gcp_landmarks.recognises, gcp_landmarks.read),
    InputFormat(
        "CSV (landmark,lat_deg,lon_deg,h_m or landmark,x_m,y_m,z_m)",
        csv_landmarks.recognises,
        csv_landmarks.read,
    ),
)
