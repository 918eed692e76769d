"""Directions of points of a photograph, other than its stars: a fireball, a satellite, a lamp."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, input_error
from vopd.geometry.linear import unit
from vopd.geometry.rotations import nearest_rotation
from vopd.stellar.angles import ARCSEC, alpha_delta_swing_deg
from vopd.stellar.field import image_directions, image_points_mm
from vopd.stellar.files.images import ImageAxes, beyond_edges, centred_points, outside_text
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import (
    Calibration,
    LensOfStars,
    differentiated_images,
    without_lens,
)
from vopd.stellar.methods.run import SolvedStars
from vopd.stellar.sky import SkyFrame, sky_pointing
from vopd.stellar.uncertainty import angle_sigmas_rad

ACROSS = ("alpha_deg", "delta_deg")  # in axes that are not those of the sky
ROLL = ("camera_roll_deg", "sigma_camera_roll_deg")  # a point has none


def point_directions(
    points: Sequence[Sequence[float]],
    file: StarFile,
    axes: ImageAxes,
    solved: SolvedStars,
    focal: float,
    calibration: Calibration | None,
    frame: SkyFrame | None,
    *,
    equatorial: bool,
) -> list[dict[str, float]]:
    """Find the directions in which points of a photograph are seen, and their uncertainty.

    The errors are those of the attitude, of the camera if it is solved for, and of the point's own
    reading, which is as good as a star's.

    Args:
        points: x, y in the coordinates of the file's images
        file: the photograph
        axes: how image coordinates are read
        solved: its solution; without a covariance there are no standard deviations
        focal: principal distance with which it was solved, image units
        calibration: the camera, where it was solved with the attitude
        frame: axes of the date and the place
        equatorial: whether the solution's axes are those of the sky

    Returns:
        Of each point x, y and angles by the names of columns, with standard deviations, degrees.

    Raises:
        InputError: a point is not in the picture, or the lens does not reach it
    """
    lens = calibration.lens if calibration is not None else LensOfStars(focal)
    rotation, _ = nearest_rotation(np.array(solved.matrix))
    found = []
    for point in points:
        where = f"{point[0]:g},{point[1]:g}"
        if beyond_edges(np.array([point]), file, axes).any():
            raise input_error(f"--point {where} is {outside_text(axes)}", file.source)
        as_read, _ = centred_points(np.array([point], dtype=float), file, axes)
        image = without_lens(as_read, lens) if calibration is not None else as_read
        if not np.isfinite(image).all():
            text = f"--point {where} lies outside the field in which k1 holds"
            raise input_error(text, file.source)
        ray = image_directions(image[0], lens.focal)
        turned = _axis_along(ray) @ rotation
        covariance = _covariance(ray, turned @ rotation.T, lens, solved, calibration)
        if equatorial:
            values = sky_pointing(turned, frame, None, covariance)
        else:
            values = dict(zip(ACROSS, alpha_delta_swing_deg(turned).tolist(), strict=False))
        if covariance is not None:
            in_degrees = np.array(covariance)[None] / 3600.0**2
            sigmas = angle_sigmas_rad(turned[None], in_degrees)[0, 3:5].tolist()
            names = ("ra_deg", "dec_deg") if equatorial else ACROSS
            values |= {f"sigma_{name}": one for name, one in zip(names, sigmas, strict=True)}
        values = {name: one for name, one in values.items() if name not in ROLL}
        found.append({"x": float(point[0]), "y": float(point[1])} | values)
    return found


def beyond_the_stars(
    points: Sequence[Sequence[float]], file: StarFile, axes: ImageAxes, stars: Floats
) -> list[Finding]:
    """Warn of points that lie farther out than all stars, where nothing tests the lens.

    Args:
        points: x, y in the coordinates of the file's images
        file: the photograph
        axes: how image coordinates are read
        stars: their images from the principal point, (n, 2)
    """
    if not points:
        return []
    farthest = float(np.hypot(*stars.T).max())
    centred, _ = centred_points(np.array(points, dtype=float), file, axes)
    out = [
        f"{x:g},{y:g}"
        for (x, y), far in zip(points, np.hypot(*centred.T) > farthest, strict=True)
        if far
    ]
    text = (
        f"--point {' and '.join(out)}: farther from the principal point than all stars, which "
        f"reach {farthest:.3g} {file.unit}: no star tests there how the lens distorts"
    )
    return [Finding(text, source=file.source, severity="warning")] if out else []


def _axis_along(ray: Floats) -> Floats:
    """Build the axes of a camera whose optical axis, -z, lies along a ray (3,)."""
    x = unit(np.cross(np.eye(3)[np.abs(ray).argmin()], ray))
    return np.stack([x, np.cross(-ray, x), -ray])


def _covariance(
    ray: Floats,
    turn: Floats,
    lens: LensOfStars,
    solved: SolvedStars,
    calibration: Calibration | None,
) -> list[list[float]] | None:
    """Estimate the covariance of turns of a camera that looks along a ray, arcsec^2 (3, 3).

    Those about the ray are none.
    """
    if solved.rotation_covariance_arcsec2 is None or solved.reading_sigma is None:
        return None
    covariance = np.array(solved.rotation_covariance_arcsec2) / ARCSEC**2
    variance = solved.reading_sigma**2
    free: tuple[str, ...] = ()
    if calibration is not None:
        covariance, free = calibration.covariance * variance, calibration.free
    tangents = image_points_mm(ray, 1.0)
    _, design = differentiated_images(tangents[None], np.array(lens))
    design = design[0][:, [0, 1, 2, *(3 + LensOfStars._fields.index(name) for name in free)]]
    # the image of a direction that moves along x or y of the turned camera, radian by radian
    by_place = design[:, :3] @ np.cross(ray, turn[:2]).T
    gain = np.linalg.inv(by_place)
    moved = gain @ (design @ covariance @ design.T + variance * np.eye(2)) @ gain.T
    (xx, xy), (_, yy) = moved * ARCSEC**2
    return [[yy, -xy, 0.0], [-xy, xx, 0.0], [0.0, 0.0, 0.0]]
