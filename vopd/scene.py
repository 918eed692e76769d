"""The surroundings of a job's frames, for figures: landmarks, track, lines of sight, photograph."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError


@dataclass(frozen=True, eq=False)
class ImageScene:
    """One frame's image: P picks, and every landmark of the scene. Pixels are u right, v down."""

    size_px: tuple[int, int]  # width, height
    landmark: Ints  # (P,) index of each pick's landmark in the scene
    pixel: Floats  # (P, 2) as picked
    fitted: Floats  # (P, 2) computed for that pick; NaN: it has no image
    used: Bools  # (P,) which take part
    computed: Floats  # (N, 2) of every landmark; NaN: it has no image
    pixel_of: Callable[[Floats], Floats]  # pixels of directions east, north, up, (n, 3)
    direction_of: Callable[[Floats], Floats]  # directions east, north, up, of pixels, (n, 2)


@dataclass(frozen=True, eq=False)
class Views:
    """The images of n frames at once, with their P picks."""

    size_px: Ints  # (n, 2) width, height
    frame: Ints  # (P,) index of each pick's frame in these
    landmark: Ints  # (P,) index of each pick's landmark in the scene
    pixel: Floats  # (P, 2) as picked
    fitted: Floats  # (P, 2) computed for that pick; NaN: it has no image
    used: Bools  # (P,) which take part
    ray: Floats  # (P, 3) Earth-centred unit vectors along which they were picked
    computed: Floats  # (n, N, 2) of every landmark; NaN: it has no image
    border: Floats  # (n, B, 3) directions east, north, up, around the image
    middle: Floats  # (n, 3) direction east, north, up of its middle
    pixel_of: Callable[[Floats], Floats]  # pixels of directions east, north, up, (n, H, 3)


class FilmView(NamedTuple):
    """Films, n of them, and directions: lengths are mm, x to the left and y up."""

    axes: Floats  # of the cameras as rows x, y, z, in components east, north, up, (..., 3, 3)
    focal_length: Floats | float

    @np.errstate(all="ignore")  # of a damaged film
    def pixel_of(self, direction: Floats) -> Floats:
        """Find the places of directions east, north, up (..., H, 3); NaN behind the camera."""
        seen = direction @ self.axes.swapaxes(-1, -2)
        depth = np.where(seen[..., 2:] > 0.0, seen[..., 2:], np.nan)
        return np.asarray(self.focal_length * seen[..., :2] / depth)

    @np.errstate(all="ignore")  # of a damaged film
    def direction_of(self, place: Floats) -> Floats:
        """Find the directions east, north, up of places (..., H, 2)."""
        focal = np.full((*place.shape[:-1], 1), self.focal_length)
        ray = np.concatenate([place, focal], axis=-1)
        return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True) @ self.axes)


class Change(NamedTuple):
    """A parameter of a solve before and after."""

    name: str
    told: str  # its values with their unit
    moved: float  # in standard deviations; NaN: it is kept
    sigma: float  # after, in the same
    stated: bool  # whether they are those before; else those after


Adjusted = tuple[Sequence[Change], Sequence[str], Floats]
"""Free parameters, names of landmarks, and sizes of residuals, as `JobScene.adjusted` has them."""


@dataclass(frozen=True, eq=False)
class JobScene:
    """Where the landmarks and the camera of a job are, N landmarks and F frames.

    Positions are Earth-centred, metres. Frames are named by number and image, as the job may
    have been divided.
    """

    names: tuple[str, ...]  # of the landmarks
    landmark_m: Floats  # (N, 3) as solved, if they are solved for
    check: Bools  # (N,) check landmarks: predicted, not used
    camera_m: Floats  # (F, 3) NaN where not known
    index: Callable[[int, str], int]  # of a frame in these, by its number and its image's name
    sight: Callable[[int, str], tuple[Ints, Floats]]
    """Measured lines of sight of a frame: landmarks (n,), Earth-centred unit vectors (n, 3)."""
    image: Callable[[int, str], ImageScene] | None = None  # None: a film, which has no pixels
    views: Callable[[Ints], Views] | None = None  # of frames by their indices in these, in order
    photograph: Callable[[int, str], Any] | None = None  # a PIL image; None: none is named
    photographs: Callable[[list[tuple[int, str]]], Iterator[tuple[int, Any]]] | None = None
    """Of many frames: the place of each in the list, and its image or the error that it has."""
    crs: str = ""  # of the landmarks, if it is projected
    clicks: Callable[[], tuple[Ints, Ints, Floats, Bools]] | None = None
    """Clicks that were followed through a video: frames, landmarks, pixels (C, 2), and which of
    them do not fit and are not used; None: each pick stands for itself."""
    plane: Callable[[Floats], tuple[Floats, Floats]] | None = None
    """Metres east and north in `crs`, and the convergence of its grid, degrees, of positions."""
    adjusted: Callable[[], Adjusted] | None = None
    """Parameters that were solved for, and names of M landmarks with the root mean square of a
    residual's coordinates before and after, of each and of all, pixels, (M + 1, 2)."""
    film: Callable[[Ints], tuple[Floats, Floats, Floats]] | None = None
    """Of frames of a film by their indices in these: the corners that its fiducials are, in order
    (n, 4, 2), and the computed places of all landmarks (n, N, 2), NaN behind the camera; mm x to
    the left and y up from the frame's centre; and the axes x, y, z of the camera as rows, z where
    it looks, in components east, north, up (n, 3, 3)."""

    def has_photograph(self, number: int, name: str) -> bool:
        """Tell whether the photograph of a frame can be read."""
        try:
            return self.photograph is not None and self.photograph(number, name) is not None
        except VopdError:
            return False
