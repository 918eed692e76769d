"""Formats of wind soundings, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.files import InputFormat
from vopd.flight.formats import wind as wyoming
from vopd.flight.wind_formats import csv_wind
from vopd.flight.wind_formats.wind_rows import WindRows

WIND_FORMATS: tuple[InputFormat[WindRows], ...] = (
    InputFormat("Wyoming CSV", wyoming.recognises_csv, wyoming.read_csv_list),
    InputFormat("Wyoming text list", wyoming.recognises_text, wyoming.read_text),
    InputFormat("CSV (h_m,from_deg,speed_m_s)", csv_wind.recognises, csv_wind.read),
)
