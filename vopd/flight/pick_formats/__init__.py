"""Formats of files of picks, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.input_file import FileFormat
from vopd.flight.pick_formats import csv_picks, cvat, gcp_picks, labelme
from vopd.flight.pick_formats.pick_rows import PickRows

PICK_FORMATS: tuple[FileFormat[PickRows], ...] = (
    FileFormat("CVAT XML", cvat.recognises, cvat.read),
    FileFormat("LabelMe JSON or a folder of it", labelme.recognises, labelme.read),
    FileFormat("gcp_list.txt", gcp_picks.recognises, gcp_picks.read),
    FileFormat("CSV (frame,landmark,u_px,v_px)", csv_picks.recognises, csv_picks.read),
)
