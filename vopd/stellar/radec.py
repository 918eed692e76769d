"""The fictitious data generator (appendix A, program RADEC2)."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, Report, input_error, strict
from vopd.geometry.linear import transform
from vopd.stellar.angles import orientation_matrix
from vopd.stellar.field import image_directions, right_ascension_declination_deg
from vopd.stellar.files.read import read_images_mm, read_text

END_OF_IMAGES = 9999.0  # IF((TEMP .GT. 9999.0) ...
MOST_IMAGES = 50
F15_6 = re.compile(r"[+-]?(\d+\.?\d*|\.\d+|\.)?([EDed][+-]?\d+|[+-]\d+)?")


@dataclass(frozen=True)
class FictitiousStars:
    """Stars that a camera of known attitude would image at given coordinates."""

    matrix: Floats  # the attitude, (..., 3, 3)
    image_mm: Floats  # x, y of the images, (..., n, 2), mm
    photo: Floats  # unit vectors P, Q, R in camera axes, (..., n, 3)
    directions: Floats  # unit vectors U, V, W in celestial axes, (..., n, 3)
    ra_deg: Floats  # right ascension, (..., n), degrees, -180 to 180
    dec_deg: Floats  # declination, (..., n), degrees


def radec2(
    image_mm: Floats, focal_length_mm: float, omega_phi_kappa_deg: Floats
) -> FictitiousStars:
    """Find the directions of stars that have given images.

    Args:
        image_mm: x, y from the principal point, (..., n, 2), mm
        focal_length_mm: principal distance, mm
        omega_phi_kappa_deg: attitudes, (..., 3), degrees

    Returns:
        The stars, [U V W]' = M' [P Q R]'.

    Source: Rae (1987), appendix A, program RADEC2.
    """
    matrix = orientation_matrix(omega_phi_kappa_deg)
    photo = image_directions(np.asarray(image_mm, dtype=float), focal_length_mm)
    directions = transform(np.swapaxes(matrix, -1, -2), photo)
    ra_deg, dec_deg = right_ascension_declination_deg(directions)
    return FictitiousStars(matrix, np.asarray(image_mm), photo, directions, ra_deg, dec_deg)


def read_typed(
    text: str, source: str = "", report: Report = strict
) -> tuple[float, Floats, Floats]:
    """Read the answers to RADEC2's prompts: a number a line, in format F15.6.

    They are the focal length, omega, phi, kappa, then x and y of each image until
    an x above 9999 or 50 images. By the rules of the format, blanks are ignored,
    a number without a point counts millionths (76 is .000076), and only columns
    1 to 15 are read.

    Returns:
        The focal length, mm; omega, phi, kappa, (3,), degrees; and the images, (n, 2), mm.

    Raises:
        InputError: something is no number, or the input ends too early; it names
            the line.
    """
    lines = text.splitlines()

    def number(index: int, what: str) -> float:
        if index >= len(lines):
            raise input_error(f"the input ends before line {index + 1}, {what}", source)
        return _f15_6(lines[index], index + 1, what, source, report)

    head = [number(k, what) for k, what in enumerate(("focal length", "omega", "phi", "kappa"))]
    if head[0] <= 0.0:
        raise input_error(f"line 1: focal length must be positive: {head[0]:g}", source)
    images: list[tuple[float, float]] = []
    at = len(head)
    while at < len(lines) and len(images) < MOST_IMAGES:
        x = number(at, "image x")
        if x > END_OF_IMAGES:
            break
        images.append((x, number(at + 1, "image y")))
        at += 2
    if not images:
        raise input_error(f"line {at + 1}: no image: x and y, a line each", source)
    if at >= len(lines):
        report(Finding("no 9999.9 after the last image", source=source, severity="warning"))
    return head[0], np.array(head[1:]), np.array(images)


def _f15_6(line: str, number: int, what: str, source: str, report: Report) -> float:
    field, rest = line[:15].replace(" ", ""), line[15:].strip()
    if not field.isascii() or F15_6.fullmatch(field) is None:
        raise input_error(f"line {number}: {what} is not a number: {field!r}", source)
    notes = [f"columns 16 on are not read: {rest!r}"] if rest else []
    mantissa, exponent = re.fullmatch(r"([+-]?[\d.]*)(.*)", field).groups()  # type: ignore[union-attr]
    power = int(exponent.lstrip("EDed") or "0")
    value = float(mantissa) if mantissa.strip("+-.") else 0.0
    if "." not in mantissa and value:
        power -= 6
        notes.append(f"{what} {field!r} has no point, so that F15.6 reads millionths")
    for note in notes:
        report(Finding(f"line {number}: {note}", source=source, severity="warning"))
    value = value * 10.0**power if abs(power) < 300 else np.inf
    if not abs(value) < 1e9:
        raise input_error(f"line {number}: {what} is too large: {field!r}", source)
    return value


def printout(stars: FictitiousStars) -> str:
    """Print stars as RADEC2 does, without prompts (formats 10, 20, 28 to 31)."""
    from fortranformat import FortranRecordWriter

    write = {
        "matrix": FortranRecordWriter("(3(6X, F12.9, 6X))"),
        "image": FortranRecordWriter("(' N ', I3, 4X, 'X ', F10.3, 4X, 'Y ', F10.3)"),
        "photo": FortranRecordWriter("('COSALP', F11.9, ' COSBET', F11.9, ' COSGAM', F11.9)"),
        "star": FortranRecordWriter("(' U', F11.9, ' V', F11.9, ' W', F11.9)"),
        "angles": FortranRecordWriter("(' RIGHT ASCENSION', F15.8, '   DECLINATION', F15.8)"),
    }
    lines = ["", " " * 9 + " ORIENTATION MATRIX"]
    for row in stars.matrix.tolist():
        lines += [write["matrix"].write(row), ""]
    for k, image in enumerate(stars.image_mm.tolist()):
        lines.append(write["image"].write([k + 1, *image]))
        lines.append(write["photo"].write(stars.photo[k].tolist()))
        lines.append(write["star"].write(stars.directions[k].tolist()))
        lines.append(write["angles"].write([float(stars.ra_deg[k]), float(stars.dec_deg[k])]))
    return "\n".join(line.rstrip() for line in lines) + "\n"


# Output as text, JSON or CSV


def radec_text(
    name: str | None,
    focal_length_mm: float | None,
    omega_phi_kappa_deg: Sequence[float] | None,
    images: Sequence[Sequence[float]],
    form: str,
    report: Report,
) -> str:
    """Make fictitious stars and write them.

    Args:
        name: a file of images; None: `images`; `-` is standard input
        focal_length_mm: principal distance, mm; without it and the attitude the
            file holds what was typed to RADEC2
        omega_phi_kappa_deg: the attitude, degrees
        images: x, y of each image, mm
        form: "text", "json" or "csv"
        report: takes the warnings

    Returns:
        The stars as text.

    Raises:
        InputError: the file cannot be read, or is not what it should be.
    """
    if focal_length_mm is None or omega_phi_kappa_deg is None:
        notes: list[Finding] = []
        focal, angles, image_mm = read_typed(*read_text(name or "-"), notes.append)
        for note in notes:  # of a file that can be read
            report(note)
        made = radec2(image_mm, focal, angles)
    else:
        image_mm = np.array(images)
        if name is not None:
            image_mm = read_images_mm(*read_text(name))
        made = radec2(image_mm, focal_length_mm, np.array(omega_phi_kappa_deg))
    if form == "text":
        return printout(made)
    return _made_json(made) if form == "json" else _made_csv(made)


MADE_COLUMNS = ("x_mm", "y_mm", "ra_deg", "dec_deg")


def _made_rows(made: FictitiousStars) -> list[list[float]]:
    rows: list[list[float]] = np.column_stack([made.image_mm, made.ra_deg, made.dec_deg]).tolist()
    return rows


def _made_csv(made: FictitiousStars) -> str:
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerows([MADE_COLUMNS, *_made_rows(made)])
    return page.getvalue()


def _made_json(made: FictitiousStars) -> str:
    stars = [
        {
            **dict(zip(MADE_COLUMNS, row, strict=True)),
            **dict(zip("uvw", made.directions[k].tolist(), strict=True)),
            **dict(zip("pqr", made.photo[k].tolist(), strict=True)),
        }
        for k, row in enumerate(_made_rows(made))
    ]
    return "[\n" + ",\n".join(json.dumps(star, allow_nan=False) for star in stars) + "\n]\n"
