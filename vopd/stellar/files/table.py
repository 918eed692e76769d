"""Star attitudes as a table, JSON and CSV, and read back."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Floats
from vopd.files import STAR_SOLUTIONS, not_a_formula, reason, written_by_vopd
from vopd.findings import input_error
from vopd.inputs import MOST_NUMBER
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.picture import StarCamera, picture_as_dict, read_picture
from vopd.stellar.files.read import UNITS, read_text
from vopd.stellar.files.text import half_widths
from vopd.stellar.methods.run import ANGLE_NAMES, ANGLE_SIGMA_NAMES, SolvedStars
from vopd.stellar.sky import OF_DATE, OF_PLACE, OF_VEHICLE
from vopd.version import __version__

# Columns: name, unit and meaning


class SolutionColumn(NamedTuple):
    """One column; `{unit}` in a name or unit is that of the image coordinates.

    Lists (stars, residuals) are one cell of text with spaces between.
    """

    name: str
    unit: str
    meaning: str
    text: bool = False


MATRIX_COLUMNS = tuple(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3))
AXIS_COLUMNS = ("axis_x", "axis_y", "axis_z")
SIGMA_COLUMNS = ("sigma_x_arcsec", "sigma_y_arcsec", "sigma_z_arcsec")
COVARIANCE_COLUMNS = tuple(
    f"covariance_{pair}_arcsec2" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")
)
REGION_COLUMNS = ("boresight_95_major_arcsec", "boresight_95_minor_arcsec")

_ANGLES = {
    "omega_deg": "first turn of the camera axes, about x",
    "phi_deg": "second turn, about the new y",
    "kappa_deg": "third turn, about the new z",
    "alpha_deg": "right ascension of the optical axis, -180 to 180",
    "delta_deg": "declination of the optical axis",
    "swing_deg": "of the photograph's y axis from north toward increasing right ascension",
}

IMAGE = SolutionColumn("image", "", "the photograph", text=True)

COLUMNS = (
    SolutionColumn("method", "", "how it was solved", text=True),
    SolutionColumn("stars", "", "the stars solved, counted from 1", text=True),
    *(SolutionColumn(name, "deg", _ANGLES[name]) for name in ANGLE_NAMES),
    *(SolutionColumn(name, "", "of the matrix from object to camera axes")
      for name in MATRIX_COLUMNS),
    SolutionColumn("orthogonality_defect", "", "of the matrix as solved"),
    SolutionColumn("rms_{unit}", "{unit}", "root mean square of the residuals' coordinates"),
    SolutionColumn("residuals_{unit}", "{unit}", "observed minus computed x, y by star", text=True),
    SolutionColumn("iterations", "", "corrections made"),
    SolutionColumn("converged", "", "whether no further correction would change it", text=True),
    SolutionColumn("reading_sigma_{unit}", "{unit}", "standard deviation of an image coordinate"),
    SolutionColumn("reading_freedom", "", "degrees of freedom of that; missing where it is given"),
    *(SolutionColumn(name, "arcsec", "standard deviation about a camera axis")
      for name in SIGMA_COLUMNS),
    *(SolutionColumn(name, "arcsec2", "covariance about two camera axes")
      for name in COVARIANCE_COLUMNS),
    SolutionColumn("covariance_factor_95", "", "of the covariance: the ellipsoid of it times this "
                   "factor contains the true attitude with 95 percent"),
    *(SolutionColumn(name, "deg", "standard deviation") for name in ANGLE_SIGMA_NAMES),
    *(SolutionColumn(name, "arcsec", "semi-axis of the 95 percent ellipse of the optical axis")
      for name in REGION_COLUMNS),
    SolutionColumn("boresight_95_angle_deg", "deg", "of its longer axis from north toward east"),
    SolutionColumn("weighted_rms_{unit}", "{unit}", "rms of the residuals with their weights"),
    *(SolutionColumn(name, "", "axis of the single rotation") for name in AXIS_COLUMNS),
    SolutionColumn("axis_ra_deg", "deg", "right ascension of that axis"),
    SolutionColumn("axis_dec_deg", "deg", "its declination"),
    SolutionColumn("angle_deg", "deg", "angle of the single rotation"),
    SolutionColumn("conditioning", "", "sin(D1, D2) of the single rotation"),
    SolutionColumn("interstar_discrepancy_arcsec", "arcsec", "of a pair: sky minus photograph"),
    SolutionColumn("disagreement_arcsec", "arcsec", "of each star with all others", text=True),
    SolutionColumn("weights", "", "of the residuals, x, y by star", text=True),
    SolutionColumn("images_{unit}", "{unit}", "x right, y up from the principal point", text=True),
    *(SolutionColumn(f"{name}_{{unit}}", "{unit}", f"{name}, solved with the attitude")
      for name in ("focal", "centre_x", "centre_y")),
    SolutionColumn("k1", "", "radial distortion, solved with the attitude"),
    *(SolutionColumn(f"sigma_{name}_{{unit}}", "{unit}", f"standard deviation of {name}")
      for name in ("focal", "centre_x", "centre_y")),
    SolutionColumn("sigma_k1", "", "standard deviation of k1"),
    SolutionColumn("ra_deg", "deg", "right ascension of the optical axis, 0 to 360"),
    SolutionColumn("ra_hours", "h", "the same in hours"),
    SolutionColumn("dec_deg", "deg", "declination of the optical axis"),
    SolutionColumn("ra_of_date_deg", "deg", "right ascension, equator and equinox of date"),
    SolutionColumn("ra_of_date_hours", "h", "the same in hours"),
    SolutionColumn("dec_of_date_deg", "deg", "declination, equator of date"),
    SolutionColumn("azimuth_deg", "deg", "of the optical axis, clockwise from north"),
    SolutionColumn("elevation_deg", "deg", "of the optical axis above the horizon"),
    SolutionColumn("camera_roll_deg", "deg", "of the camera about the optical axis"),
    *(SolutionColumn(f"vehicle_{name}_deg", "deg", f"{name} of the vehicle")
      for name in ("yaw", "pitch", "roll")),
    *(SolutionColumn(f"sigma_{name}", "deg", "standard deviation; date and place count as exact")
      for name in (*OF_DATE, *OF_PLACE, *OF_VEHICLE)),
    SolutionColumn("epoch", "", "what right ascensions and declinations refer to", text=True),
    SolutionColumn("camera_m", "m", "position of the camera, where it is solved", text=True),
    SolutionColumn("camera_sigma_m", "m", "its standard deviations", text=True),
    SolutionColumn("doubtful", "", "why the exit status is not 0", text=True),
)  # fmt: skip
"""The columns of every table in their order; IMAGE stands before them where there are several."""

CONVENTIONS = {
    "matrix": "M from object axes (U V W, or those of the ground points) to camera axes: x, y of "
    "the photograph, a positive seen from behind, y up; z backward",
    "sequence": "M = Rz(kappa) Ry(phi) Rx(omega); alpha, delta, swing from the same matrix",
    "sigmas": "one standard deviation, without Student's factor; the 95 percent ellipse and "
    "covariance_factor_95 allow for the degrees of freedom",
}
"""What every file of star attitudes states."""


# Rows and arrays


def columns_of(photographs: Sequence[SolvedPhotograph]) -> list[SolutionColumn]:
    """List the columns of a table of these photographs, with the units of their images."""
    units = list(dict.fromkeys(one.file.unit for one in photographs)) or ["mm"]
    named = {
        column.name.format(unit=unit): column._replace(
            name=column.name.format(unit=unit), unit=column.unit.format(unit=unit)
        )
        for column in COLUMNS
        for unit in units
    }
    several = any(one.label for one in photographs)
    return [*([IMAGE] if several else []), *named.values()]


def rows_of(photographs: Sequence[SolvedPhotograph]) -> list[dict[str, Any]]:
    """List a row for each solution: plain values by the names of columns, or ""."""
    return [_row(photograph, one) for photograph in photographs for one in photograph.solved]


def solution_table(
    photographs: Sequence[SolvedPhotograph],
) -> tuple[dict[str, NDArray[Any]], dict[str, dict[str, str]]]:
    """Build the table as arrays: numbers are NaN where there are none, text is empty.

    Returns:
        The array, and the unit and meaning, of each column by its name.
    """
    columns, rows = columns_of(photographs), rows_of(photographs)
    values = {
        column.name: np.array([str(row.get(column.name, "")) for row in rows], dtype=str)
        if column.text
        else np.array([_number(row.get(column.name, "")) for row in rows], dtype=np.float64)
        for column in columns
    }
    return values, {one.name: {"unit": one.unit, "meaning": one.meaning} for one in columns}


def stated_conventions(photographs: Sequence[SolvedPhotograph]) -> dict[str, str]:
    """State program, source files and conventions of a table."""
    sources = ", ".join(dict.fromkeys(one.file.source for one in photographs))
    doubts = [
        f"{one.label or one.file.source}: {'; '.join(one.doubts)}"
        for one in photographs
        if one.doubts
    ]
    return {
        "program": f"vopd {__version__}",
        "source": sources,
        **({"doubtful": "; ".join(doubts)} if doubts else {}),
        **CONVENTIONS,
    }


def _row(photograph: SolvedPhotograph, one: SolvedStars) -> dict[str, Any]:
    row = one.as_dict(photograph.file.unit)
    row.pop("points", None)
    elements = [element for line in row.pop("matrix") for element in line]
    covariance = row.pop("rotation_covariance_arcsec2", None)
    upper = covariance and [covariance[i][j] for i in range(3) for j in range(i, 3)]
    for names, values in (
        (MATRIX_COLUMNS, elements),
        (AXIS_COLUMNS, row.pop("axis", None)),
        (SIGMA_COLUMNS, row.pop("rotation_sigma_arcsec", None)),
        (COVARIANCE_COLUMNS, upper),
        (REGION_COLUMNS, row.pop("boresight_95_arcsec", None)),
    ):
        row.update(zip(names, values or [""] * len(names), strict=True))
    row["converged"] = str(one.converged).lower()
    if photograph.epoch:
        row["epoch"] = photograph.epoch
    if photograph.label:
        row["image"] = photograph.label
    row["doubtful"] = "; ".join(photograph.doubts)
    return {name: _cell(value) for name, value in row.items()}


def _cell(value: Any) -> Any:
    """Format a value, or the values of a list with spaces between."""
    if isinstance(value, list):
        return " ".join(str(_cell(item)) for item in value)
    return value


def _number(value: Any) -> float:
    return float("nan") if value == "" else float(value)


# JSON and CSV


def as_json(photographs: Sequence[SolvedPhotograph]) -> str:
    """Write the solutions as a JSON array; numbers have all their digits."""
    solutions = []
    for photograph in photographs:
        image = {"image": photograph.label} if photograph.label else {}
        for one in photograph.solved:
            names = [photograph.file.names[star - 1] for star in one.stars]
            row = image | one.as_dict(photograph.file.unit)
            row |= {"names": names} if any(names) else {}
            row |= {"epoch": photograph.epoch} if photograph.epoch else {}
            row |= {"doubtful": photograph.doubts} if photograph.doubts else {}
            if photograph.axes is not None:
                row |= {"picture": picture_as_dict(photograph, photograph.axes, one)}
            solutions.append(json.dumps(row, allow_nan=False))
    return "[\n" + ",\n".join(solutions) + "\n]\n"


def as_csv(photographs: Sequence[SolvedPhotograph]) -> str:
    """Write the solutions as CSV, one line each; a list (stars, residuals) is one cell."""
    page = io.StringIO()
    columns = [column.name for column in columns_of(photographs)]
    writer = csv.DictWriter(page, columns, lineterminator="\n", restval="")
    writer.writeheader()
    for row in rows_of(photographs):
        writer.writerow(row | {"image": not_a_formula(row["image"])} if "image" in row else row)
    return page.getvalue()


# Solutions read back from JSON


class ReadSolution(NamedTuple):
    """One solution, as far as a picture of it needs it."""

    image: str  # the photograph's name; empty where there is only one
    method: str  # how it was solved
    labels: tuple[str, ...]  # the stars' names, or numbers
    images: Floats  # x right and y up from the principal point, (n, 2)
    residuals: Floats  # observed minus computed, (n, 2)
    unit: str  # of the images
    pointing: tuple[float, float, float]  # alpha, delta, swing, degrees
    numbers: tuple[int, ...]  # of the stars, counted from 1
    epoch: str  # what right ascensions and declinations refer to
    picture: StarCamera | None  # None: an earlier version wrote the file
    half_95_deg: tuple[float | None, ...] = (None, None, None)  # of the 95 % intervals of pointing
    doubtful: tuple[str, ...] = ()  # why it was not solved with exit status 0


def read_solutions(name: str) -> list[ReadSolution]:
    """Read a file of solutions.

    Args:
        name: the file's name; `-` is standard input

    Raises:
        InputError: it is not what `vopd stars solve --format json` writes, or has no solution.
    """
    text, source = read_text(name)
    what = "not the JSON of `vopd stars solve`"
    try:
        found = [_solution(one) for one in json.loads(text)]
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
        own = written_by_vopd(text[:4096])
        if own is not None and own[0] != STAR_SOLUTIONS:
            raise input_error(f"this is {own[0]}, {what}; {own[1]}", source) from None
        raise input_error(f"{what}: {reason(error)}", source) from None
    if not found:
        raise input_error("it has no solution", source)
    return found


def _solution(row: dict[str, Any]) -> ReadSolution:
    """Read one object of the array; raise KeyError, TypeError or ValueError for others."""
    unit = next((unit for unit in UNITS if f"images_{unit}" in row), UNITS[0])
    images = np.array(row[f"images_{unit}"], dtype=np.float64)
    residuals = np.array(row[f"residuals_{unit}"], dtype=np.float64)
    if images.ndim != 2 or images.shape[1] != 2 or images.shape != residuals.shape:
        raise ValueError("images and residuals do not go together")
    if not (np.abs([images, residuals]) <= MOST_NUMBER).all():
        raise ValueError(f"a coordinate is not a number up to {MOST_NUMBER:g}")
    numbers = [str(star) for star in row["stars"]]
    names = [str(name) for name in row.get("names", numbers)]
    if not len(names) == len(numbers) == len(images):
        raise ValueError("names and stars do not go together")
    labels = tuple(name or number for name, number in zip(names, numbers, strict=True))
    alpha, delta, swing = (float(row[name]) for name in ANGLE_NAMES[3:])
    known = all(name in row for name in ANGLE_SIGMA_NAMES)
    sigmas = [float(row[name]) for name in ANGLE_SIGMA_NAMES[3:]] if known else None
    return ReadSolution(
        str(row.get("image", "")),
        str(row["method"]),
        labels,
        images,
        residuals,
        unit,
        (alpha, delta, swing),
        tuple(int(star) for star in row["stars"]),
        str(row.get("epoch", "")),
        read_picture(row) if "picture" in row else None,
        tuple(half_widths(sigmas, row.get("reading_freedom"))),
        tuple(str(one) for one in row.get("doubtful", ())),
    )
