"""Formats of files of picks, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.files import InputFormat
from vopd.flight.formats import picks as cvat
from vopd.flight.pick_formats import csv_picks, gcp_picks, labelme
from vopd.flight.pick_formats.pick_rows import PickRows

PICK_FORMATS: tuple[InputFormat[PickRows], ...] = (
    InputFormat("CVAT XML", cvat.recognises, cvat.read),
    InputFormat("LabelMe JSON or a folder of it", labelme.recognises, labelme.read),
    InputFormat("gcp_list.txt", gcp_picks.recognises, gcp_picks.read),
    InputFormat("CSV (frame,landmark,u_px,v_px)", csv_picks.recognises, csv_picks.read),
)
