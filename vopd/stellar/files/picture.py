"""What a picture of a star photograph needs beside its solution: camera, sky, stars in doubt."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.angles import orthogonality_defect
from vopd.stellar.field import right_ascension_declination_deg
from vopd.stellar.files.images import ImageAxes, distorted, in_file_coordinates, undistorted
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.methods.calibration import LensOfStars, with_lens, without_lens
from vopd.stellar.methods.run import SolvedStars

ROUNDED = 1e-6  # of the products of a matrix's rows
LEAST, MOST = 1e-6, 1e9  # of coordinates and a principal distance, image units


RejectedStar = tuple[int, str, Floats, Floats]
"""A star that was read and not solved: its number, from 1, and label; its image (2,) from the
principal point, y up, without the lens; and its residual, observed minus computed (2,)."""


class StarCamera(NamedTuple):
    """The camera of a photograph in its file's coordinates, and its stars in doubt."""

    focal: float  # principal distance, image units
    centre: Floats  # principal point, file's coordinates, (2,)
    k1: float
    distortion: float  # that of tetra3; 0: none
    y_down: bool  # where the file's y axis points
    size_px: Floats | None  # width and height of the image, (2,), if known
    first_centre_px: float  # coordinate of the centre of the first pixel
    matrix: Floats  # from object to camera axes, (3, 3)
    sky: bool  # whether the object axes are celestial ones
    source: str  # the file that was solved: photographs lie beside it
    odd: tuple[int, ...]  # numbers of the stars that do not fit, counted from 1
    left_out: tuple[RejectedStar, ...]

    def centred(self, points: Floats) -> Floats:
        """Count points of the file from the principal point, y up, without the lens, (n, 2)."""
        found = np.asarray(points) - self.centre
        if self.distortion and self.size_px is not None:
            found = undistorted(found, self.distortion, self.size_px[0])
        found = found * [1.0, -1.0 if self.y_down else 1.0]
        return without_lens(found, LensOfStars(self.focal, k1=self.k1)) if self.k1 else found

    @np.errstate(all="ignore")
    def in_file(self, images: Floats) -> Floats:
        """Find the file's coordinates of images from the principal point, (n, 2)."""
        upward = np.array([1.0, -1.0 if self.y_down else 1.0])
        found = with_lens(images, LensOfStars(self.focal, k1=self.k1)) * upward
        if self.distortion and self.size_px is not None:
            found = distorted(found, self.distortion, self.size_px[0])
        return np.asarray(found + self.centre)

    @np.errstate(all="ignore")
    def sky_at(self, points: Floats, in_file: bool) -> Floats:
        """Find right ascension and declination at points, degrees, (n, 2).

        Args:
            points: (n, 2)
            in_file: whether they are the file's, and not from the principal point without the lens
        """
        centred = self.centred(points) if in_file else points
        ray = np.column_stack([centred, np.full(len(centred), -self.focal)]) @ self.matrix
        ray /= np.linalg.norm(ray, axis=1, keepdims=True)
        return np.column_stack(right_ascension_declination_deg(ray))


def picture_as_dict(
    photograph: SolvedPhotograph, axes: ImageAxes, one: SolvedStars
) -> dict[str, Any]:
    """Describe the picture of one solution for its JSON."""
    file, stars = photograph.file, photograph.stars
    camera = one.camera or {}
    centre = in_file_coordinates(np.zeros(2), file, axes).tolist()
    matrix = np.array(one.matrix)
    rejected = np.setdiff1d(np.arange(len(file.lines)), photograph.used)
    seen = stars.select(rejected)
    ray = seen.directions @ matrix.T
    with np.errstate(divide="ignore", invalid="ignore"):
        computed = -stars.focal_length_mm[0] * ray[:, :2] / ray[:, 2:]
    left_out = [
        {
            "star": int(star) + 1,
            "name": file.names[star],
            "image": image.tolist(),
            "residual": (image - there).tolist(),
        }
        for star, image, there, z in zip(
            rejected, seen.image_mm, computed, ray[:, 2].tolist(), strict=True
        )
        if z < 0.0
    ]
    return {
        "focal": float(stars.focal_length_mm[0]),
        "centre": [camera.get("centre_x", centre[0]), camera.get("centre_y", centre[1])],
        "k1": axes.k1 + camera.get("k1", 0.0),
        "distortion": file.pixels.distortion,
        "y_down": axes.flipped(file),
        "size_px": None if axes.size_px is None else list(axes.size_px),
        "first_centre_px": file.pixels.first_centre,
        "sky": file.kind != "x_m,y_m,z_m",
        "source": file.source,
        "odd": list(photograph.odd),
        "left_out": left_out,
    }


def read_picture(row: dict[str, Any]) -> StarCamera:
    """Read one of a solution's JSON; raise KeyError, TypeError or ValueError for another object."""
    found = row["picture"]
    numbers = [float(found[name]) for name in ("focal", "k1", "distortion", "first_centre_px")]
    matrix = np.array(row["matrix"], dtype=np.float64)
    if not (LEAST < numbers[0] < MOST and np.abs(numbers).max() < MOST and abs(numbers[2]) < 0.9):
        raise ValueError("a number of the picture is not one that a camera has")
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise ValueError("the matrix is not 3 by 3 finite numbers")
    as_solved = float(row["orthogonality_defect"])  # more than 0 in a matrix that is drawn as such
    if orthogonality_defect(matrix) > as_solved + ROUNDED or np.linalg.det(matrix) <= 0.0:
        raise ValueError("the matrix is not that of a rotation")
    size = None if found["size_px"] is None else _pair(found["size_px"])
    return StarCamera(
        numbers[0],
        _pair(found["centre"]),
        numbers[1],
        numbers[2],
        bool(found["y_down"]),
        size if size is not None and (size > 0.0).all() else None,
        numbers[3],
        matrix,
        bool(found["sky"]),
        str(found["source"]),
        tuple(int(star) for star in found["odd"]),
        tuple(
            (int(o["star"]), str(o["name"] or o["star"]), _pair(o["image"]), _pair(o["residual"]))
            for o in found["left_out"]
        ),
    )


def _pair(values: Any) -> Floats:
    """Read two numbers that coordinates can be."""
    found = np.array(values, dtype=np.float64)
    if found.shape != (2,) or not (np.abs(found) < MOST).all():
        raise ValueError("a point of the picture is not two numbers that coordinates can be")
    return found
