"""The lens of a project: an inline table, or a file in any of the known formats."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import read_by_content, shown
from vopd.flight.formats.lens import COUNTS
from vopd.flight.lens_formats import LENS_FORMATS
from vopd.flight.lens_formats.lens_parameters import (
    GRID_TO_CENTRE,
    LensQuestion,
    LensRead,
    coefficients_said,
    image_centre,
    make_lens,
)
from vopd.flight.project import Project, Section
from vopd.geometry.lenses import Lens, LensKind

INLINE = (
    "model", "fx_px", "fy_px", "cx_px", "cy_px", "k", "skew_px", "focal_mm", "sensor_mm",
    "table_px",
)  # fmt: skip
MODELS = ("brown", "fisheye", "radial-table")


def read_lens(project: Project) -> LensRead:
    """The lens of a project.

    Raises:
        VopdError: where it is missing, or its image size is not that of the project
    """
    section = project.section("camera")
    size = None
    if section.has("image_size_px"):
        width, height = section.numbers("image_size_px", 2)
        if min(width, height) < 1 or width % 1 or height % 1:
            raise section.error("image_size_px", "is width and height, whole numbers of pixels")
        size = int(width), int(height)
    if isinstance(section.values.get("lens"), dict):
        return _inline(section, section.section("lens", INLINE), size)
    file = project.open("camera", "lens")
    name = file.name
    model = section.text("model", MODELS[:2]) if section.has("model") else None
    camera = section.text("camera") if section.has("camera") else None
    found = read_by_content(LENS_FORMATS, file, LensQuestion(model, camera, size))
    if size is not None and found.lens.size_px != size:
        w, h = found.lens.size_px
        turned = " (turned by 90 degrees)" if (h, w) == size else ""
        raise section.error(
            "image_size_px",
            f"{size[0]} x {size[1]}, but {name} is a calibration for {w} x {h}{turned}; "
            "a calibration serves the pictures that it was made of",
        )
    return found


def _inline(section: Section, table: Section, size: tuple[int, int] | None) -> LensRead:
    if size is None:
        raise section.error("image_size_px", "is needed with an inline lens")
    model = table.text("model", MODELS)
    focal, assumed = _focal(table, size)
    middle = image_centre(size)
    centre = middle
    if table.has("cx_px") or table.has("cy_px"):
        grid = section.text("pixel_grid", list(GRID_TO_CENTRE))
        shift = GRID_TO_CENTRE[grid]
        centre = table.number("cx_px") + shift, table.number("cy_px") + shift
        assumed += f", {grid} grid"
    else:
        assumed += ", principal point in the image's middle as none is given"
    if model == "radial-table":
        return LensRead(_radial_table(table, size, focal, centre), f"lens: radial table{assumed}")
    values = table.values.get("k", [])
    if not isinstance(values, list):
        raise table.error("k", f"{shown(values)} is not a list of coefficients")
    k = table.numbers("k", len(values)) if values else ()
    counts = (0, 1, 2, 3, 4) if model == "fisheye" else COUNTS
    if len(k) not in counts:
        raise table.error("k", f"{len(k)} coefficients; {', '.join(map(str, counts))} are known")
    skew = table.number("skew_px", 0.0)
    lens = make_lens(model, size, focal, centre, k, skew)
    return LensRead(lens, f"lens: {coefficients_said(k, model)}{assumed}")


def _focal(table: Section, size: tuple[int, int]) -> tuple[tuple[float, float], str]:
    if table.has("focal_mm"):
        width, height = table.numbers("sensor_mm", 2)
        if min(width, height) <= 0.0:
            raise table.error("sensor_mm", "is the sensor's width and height, both above 0")
        if table.has("fx_px"):
            raise table.error("focal_mm", "fx_px is there too: give one of them")
        f = table.number("focal_mm", above=0.0)
        return (f * size[0] / width, f * size[1] / height), ", focal length by the sensor's size"
    if not table.has("fx_px"):
        raise table.error("fx_px", "is needed, or focal_mm and sensor_mm")
    fx = table.number("fx_px", above=1.0)
    return (fx, table.number("fy_px", fx, above=1.0)), ""


def _radial_table(
    table: Section, size: tuple[int, int], focal: tuple[float, float], centre: tuple[float, float]
) -> Lens:
    """The table of radius and what is added to it; it begins at the centre with nothing."""
    rows = table.values.get("table_px")
    if (
        not isinstance(rows, list)
        or len(rows) < 2
        or not all(isinstance(row, list) and len(row) == 2 for row in rows)
    ):
        raise table.error("table_px", "is a list of [radius, what is added to it], two at least")
    try:
        values = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise table.error("table_px", f"has something that is not a number: {error}") from error
    if not np.isfinite(values).all():
        raise table.error("table_px", "has a number that is not finite")
    if values[0, 0] > 0.0:
        values = np.vstack([[0.0, 0.0], values])
    if focal[0] != focal[1]:
        raise table.error("fy_px", "a radial table has one focal length: leave fy_px out")
    grow = np.diff(values, axis=0)
    if values[0].any() or not (grow[:, 0] > 0.0).all() or not (grow.sum(axis=1) > 0.0).all():
        raise table.error(
            "table_px", "begins with nothing at radius 0, and both radius and what comes out grow"
        )
    return Lens(
        LensKind.RADIAL_TABLE, size, np.array(focal), np.array(centre), np.zeros(0), 0.0, values
    )
