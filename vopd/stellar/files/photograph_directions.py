"""Directions of the stars or ground points of a photograph, by the options that were given."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding, Report
from vopd.stellar.files.images import MissingOption
from vopd.stellar.files.star_file import StarFile, file_directions
from vopd.stellar.files.star_request import StarRequest
from vopd.stellar.sky.file_sky import EQUATORIAL, FileSky, needs_no_date, sky_directions


def photograph_directions(file: StarFile, request: StarRequest, report: Report) -> FileSky:
    """The directions of the stars, or of the ground points.

    Args:
        file: the photograph
        request: date, place and camera position
        report: takes warnings

    Raises:
        MissingOption: an option needs another one.
        DeckError: an option is not for this kind of file, or a direction cannot be found.
    """
    sky = request.sky
    if sky.utc is None and (sky.place is not None or sky.ephemeris is not None):
        option = "--place" if sky.place is not None else "--ephemeris"
        raise MissingOption(f"{file.deck}: {option} needs --date, or a column utc")
    if sky.mount is not None and sky.place is None:
        raise MissingOption(f"{file.deck}: --mount needs --place, for the vehicle's yaw and pitch")
    if file.kind in EQUATORIAL:
        if request.camera_m is not None:
            raise file.error(f"--camera is for ground points; the file has {file.kind}")
        return sky_directions(file, request.sky, report)
    wrong = needs_no_date(file, request.sky)
    if wrong is not None:
        raise DeckError(wrong)
    directions = file_directions(file, _camera(file, request.camera_m), report)
    return FileSky(directions, None, "the axes of u, v, w" if file.kind == "u,v,w" else "")


def _camera(file: StarFile, camera_m: tuple[float, ...] | None) -> Floats | None:
    ground = file.kind == "x_m,y_m,z_m"
    if ground and camera_m is None:
        raise DeckError(
            Finding("ground points need --camera X,Y,Z, or --resection", deck=file.deck)
        )
    if camera_m is not None and not ground:
        message = f"--camera is for ground points; the file has {file.kind}"
        raise DeckError(Finding(message, deck=file.deck))
    return None if camera_m is None else np.array(camera_m)
