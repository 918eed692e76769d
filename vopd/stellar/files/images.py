"""Image coordinates of a star file, and their errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import Finding, VopdError, input_error, size_text
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import LensOfStars, without_lens

# Image coordinates from the principal point, y up

MOST_TIMES = 2.0  # as far out as without distortion

UM_PER_MM = 1000.0
_FOCAL = "--focal-px PX (or --focal MM with --pitch-um UM, or --free focal)"
_POINT = "--size W,H (or --centre X,Y)"
_BOTH = "--images PHOTOGRAPH takes both from it"


class MissingOption(VopdError):
    """An option that a file needs is not given."""


@dataclass(frozen=True)
class ImageAxes:
    """The camera of a star file, as the user states it."""

    focal_mm: float | None = None  # principal distance, mm
    focal_px: float | None = None  # principal distance, pixels
    pitch_um: float | None = None  # distance of neighbouring pixels, micrometres
    # the principal point in the file's pixel coordinates
    centre_px: tuple[float, ...] | None = None
    size_px: tuple[float, ...] | None = None  # width and height of the image
    # whether the file's y axis points down; None leaves it to the file's format
    y_down: bool | None = None
    # radial distortion of the lens: images lie (1 + k1 r**2) times as far out, r the tangent of the
    # angle from the optical axis
    k1: float = 0.0
    free: tuple[str, ...] = ()  # what of it the user has solved for, which advice repeats

    def flipped(self, file: StarFile) -> bool:
        """Test whether y is turned upward: the user, or else the file's format, has it down."""
        return file.pixels.y_down if self.y_down is None else self.y_down

    def has_focal(self, file: StarFile) -> bool:
        """Test whether the principal distance of a file is stated."""
        if file.unit == "mm":
            return self.focal_mm is not None
        by_pitch = self.focal_mm is not None and self.pitch_um is not None
        return by_pitch or self.focal_px is not None or file.pixels.field_of_view_deg is not None

    def with_focal(self, focal: float, unit: str) -> ImageAxes:
        """State the principal distance in the unit of the images, "mm" or "px"."""
        return replace(self, focal_mm=focal) if unit == "mm" else replace(self, focal_px=focal)

    def focal_advice(self, focal: float, unit: str) -> str:
        """Format a principal distance in the unit of the images, with the option that states it."""
        if unit == "px" and self.pitch_um is None:
            return f"{focal:.6g} px: --focal-px {focal:.6g}"
        if unit == "px":
            focal *= (self.pitch_um or 0.0) / UM_PER_MM
        return f"{focal:.4g} mm: --focal {focal:.4g}"


def centred_images(file: StarFile, axes: ImageAxes) -> tuple[Floats, float]:
    """Count a file's image coordinates from the principal point, with y up.

    Returns:
        Images, (n, 2), and principal distance, in the unit of the file.

    Raises:
        MissingOption: a file of pixels lacks its scale or its principal point.
        InputError: options for pixels with a file in mm, or an image outside the field of k1.
    """
    points, focal = centred_points(file.image, file, axes)
    if axes.k1:
        far, _ = centred_points(file.image, file, replace(axes, k1=0.0))
        outside = np.flatnonzero(~np.isfinite(points).all(axis=1))
        if outside.size:
            text = "the image lies outside the field in which --k1 holds"
            raise file.error(text, int(outside[0]))
        times = np.hypot(*far.T) / np.maximum(np.hypot(*points.T), np.finfo(float).tiny)
        if times.max(initial=0.0) > MOST_TIMES:
            most = size_text(times.max(), 3)
            text = (
                f"--k1 {axes.k1:g} puts the image {most} times as far out as a lens without it, "
                "which no lens does: write the lens's own, as -0.1, or --free k1"
            )
            raise file.error(text, int(times.argmax()))
    return points, focal


def centred_points(image: Floats, file: StarFile, axes: ImageAxes) -> tuple[Floats, float]:
    """Count points of a file's picture from the principal point, with y up.

    Args:
        image: the points in the file's coordinates, (n, 2)
        file: the photograph
        axes: how its image coordinates are read

    Returns:
        Points, (n, 2), NaN outside the field in which k1 holds, and principal distance.

    Raises:
        MissingOption: a file of pixels lacks its scale or its principal point.
        InputError: options for pixels with a file in mm.
    """
    upward = np.array([1.0, -1.0 if axes.flipped(file) else 1.0])
    if file.unit == "mm":
        for_pixels = (axes.focal_px, axes.pitch_um, axes.centre_px, axes.size_px)
        if any(one is not None for one in for_pixels):
            message = "--focal-px, --pitch-um, --centre, --size are for pixels; the file has mm"
            raise input_error(message, file.source)
        if axes.focal_mm is None:
            raise _missing(file, "--focal MM is needed (or --free focal)")
        points, focal = image * upward, axes.focal_mm
    else:
        if not axes.has_focal(file) and axes.centre_px is None and axes.size_px is None:
            raise _missing(
                file, f"the file has pixels: {_FOCAL}, and {_POINT}, are needed; {_BOTH}"
            )
        points = image - _principal_point(file, axes)
        if file.pixels.distortion:
            points = undistorted(points, file.pixels.distortion, _width(file, axes))
        points, focal = points * upward, _focal_px(file, axes)
    if axes.k1:
        points = without_lens(points, LensOfStars(focal, k1=axes.k1))
    return points, focal


def outside_image(file: StarFile, axes: ImageAxes) -> list[Finding]:
    """Warn of stars that were read outside of an image of the size that is given."""
    out = np.flatnonzero(beyond_edges(file.image, file, axes)).tolist()
    return [file.finding(outside_text(axes), *out).warned()] if out else []


def beyond_edges(image: Floats, file: StarFile, axes: ImageAxes) -> Bools:
    """Mark points (n, 2) outside of the picture, where its size in pixels is given, (n,)."""
    if axes.size_px is None or file.unit != "px":
        return np.zeros(len(image), bool)
    low = file.pixels.first_centre - 0.5
    far = (image < low) | (image > low + np.array(axes.size_px))
    return np.asarray(far.any(axis=1))


def outside_text(axes: ImageAxes) -> str:
    """Say of which picture something lies outside."""
    wide, high = (f"{one:g}" for one in axes.size_px or ())
    return f"outside the image of {wide} x {high} px"


def in_file_coordinates(point: Floats, file: StarFile, axes: ImageAxes) -> Floats:
    """Convert a point given from the principal point, y up, to the file's coordinates, (2,)."""
    upward = np.array([1.0, -1.0 if axes.flipped(file) else 1.0])
    origin = np.zeros(2) if file.unit == "mm" else _principal_point(file, axes)
    return np.asarray(origin + point * upward)


def image_edges(
    file: StarFile, axes: ImageAxes, focal: float, solved: Mapping[str, float]
) -> Floats:
    """Find the edges of an image of pixels at the height of its principal point, and above it.

    Args:
        file: the photograph
        axes: the camera as stated, with the size of the image
        focal: principal distance, as solved where it was
        solved: what else of the camera was solved, by its names; the centre as the file counts

    Returns:
        x of the left and the right edge and y of the first and the last, from the principal point
        and without the lens, (2, 2); NaN where the lens does not reach them.
    """
    stated = in_file_coordinates(np.zeros(2), file, axes)
    point = np.array([solved.get(f"centre_{one}", stated[k]) for k, one in enumerate("xy")])
    first = np.full(2, file.pixels.first_centre - 0.5) - point
    last = first + (axes.size_px or (np.nan, np.nan))
    edges = np.array([[first[0], 0.0], [last[0], 0.0], [0.0, first[1]], [0.0, last[1]]])
    if file.pixels.distortion:
        edges = undistorted(edges, file.pixels.distortion, _width(file, axes))
    edges = without_lens(edges, LensOfStars(focal, k1=axes.k1 + solved.get("k1", 0.0)))
    return np.stack([edges[:2, 0], edges[2:, 1]], axis=1)


def _focal_px(file: StarFile, axes: ImageAxes) -> float:
    """Find the principal distance in pixels: as given, by the pitch, or by the field of view."""
    if axes.focal_px is not None:
        return axes.focal_px
    if axes.focal_mm is not None:
        if axes.pitch_um is None:
            text = (
                "the file has pixels: with --focal give --pitch-um, or --focal-px, or --free focal"
            )
            raise _missing(file, text)
        return axes.focal_mm * UM_PER_MM / axes.pitch_um
    field_deg = file.pixels.field_of_view_deg
    if field_deg is None:
        raise _missing(file, f"the file has pixels: {_FOCAL} is needed")
    return _width(file, axes) / 2.0 / float(np.tan(np.radians(field_deg) / 2.0))


def _principal_point(file: StarFile, axes: ImageAxes) -> Floats:
    """Find the principal point, given or the middle of the image, in the file's coordinates."""
    if axes.centre_px is not None:
        return np.array(axes.centre_px)
    if axes.size_px is None:
        raise _missing(file, f"the file has pixels: {_POINT} is needed")
    return (np.array(axes.size_px) - 1.0) / 2.0 + file.pixels.first_centre


def undistorted(points: Floats, distortion: float, width_px: float) -> Floats:
    """Remove the distortion that tetra3 states: r (1 - k (2r/width)**2) / (1 - k).

    Args:
        points: images from the principal point, pixels, (n, 2)
        distortion: k, at half the width, a fraction
        width_px: of the image
    """
    square = (points**2).sum(axis=1, keepdims=True) * (2.0 / width_px) ** 2
    return np.asarray(points * (1.0 - distortion * square) / (1.0 - distortion))


def distorted(points: Floats, distortion: float, width_px: float) -> Floats:
    """Put images where tetra3's distortion shows them: the inverse of `undistorted`, (n, 2)."""
    lens = LensOfStars(width_px / 2.0, k1=-distortion)
    return without_lens(points * (1.0 - distortion), lens)


def _missing(file: StarFile, text: str) -> MissingOption:
    return MissingOption(str(file.finding(text + f" ({file.read_as})" * bool(file.read_as))))


def _width(file: StarFile, axes: ImageAxes) -> float:
    if axes.size_px is None:
        raise _missing(file, "the plate solution needs --size W,H")
    return axes.size_px[0]


# Reading errors by columns of sigma, magnitude and elongation

LEAST_ELONGATION = 1.0


def reading_errors(
    file: StarFile, magnitude_limit: float | None, *, by_elongation: bool, flipped: bool
) -> tuple[Floats | None, float]:
    """Estimate the covariance of a file's images, relative to the reading sigma.

    The noise of a star's light falls with the root of its brightness, so that the
    variance at magnitude m is 1 + 10**(0.4 (m - limit)) times that of a bright star.
    The sigma of an elongated image is multiplied by its elongation. The reading sigma is the
    root mean square of all.

    Args:
        file: the file
        magnitude_limit: the magnitude at which the noise of a star's light is as large as
            all other errors together; None: errors do not depend on it
        by_elongation: whether errors grow with the length of an image over its width
        flipped: whether y is turned, and with it the sign of the correlation

    Returns:
        Covariance matrices of x and y for a reading sigma of 1, (n, 2, 2), or None if all
        errors are alike; and the reading sigma, in image units where the file states standard
        deviations, else in that of a bright star with a round image.

    Raises:
        InputError: a star lacks the magnitude or elongation that is asked for.

    Source: Rae (1987), eqs. 2.13 and 3.13, recommendations 1 and 2.
    """
    factor = np.ones(len(file.lines))
    if magnitude_limit is not None:
        magnitude = _known(file, file.magnitude, "mag", "--magnitude-limit")
        factor *= 1.0 + 10.0 ** (0.4 * np.clip(magnitude - magnitude_limit, -50.0, 50.0))
    if by_elongation:
        elongation = _known(file, file.elongation, "elongation", "--weigh-elongation")
        short = np.flatnonzero(elongation < LEAST_ELONGATION)
        if short.size:
            raise file.error("elongation: length over width is 1 or more", int(short[0]))
        factor *= elongation**2
    if file.sigmas is None:
        mean = float(factor.mean())
        alike = bool((factor == factor[0]).all())
        return None if alike else factor[:, None, None] / mean * np.eye(2), mean**0.5
    x, y, correlation = file.sigmas.T
    mixed = x * y * (-correlation if flipped else correlation)
    covariance = np.stack([np.stack([x**2, mixed], -1), np.stack([mixed, y**2], -1)], axis=-2)
    covariance *= factor[:, None, None]
    mean = float(np.trace(covariance, axis1=1, axis2=2).mean() / 2.0)
    return covariance / mean, mean**0.5


def _known(file: StarFile, values: Floats | None, column: str, option: str) -> Floats:
    """Check a column that every star needs."""
    if values is None:
        message = f"{option} needs a column {column}"
        raise input_error(message, file.source)
    missing = np.flatnonzero(~np.isfinite(values))
    if missing.size:
        raise file.error(f"{option} needs {column}", int(missing[0]))
    return values
