"""How well landmarks determine the rotation of a frame: condition number and weakest axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.estimate import Estimate
from vopd.geometry.camera_axes import ahead, angles_by_turns, camera_axes
from vopd.geometry.linear import singular_values

AXES = ("image x axis", "image y axis", "optical axis")


@dataclass(frozen=True, eq=False)
class LandmarkGeometry:
    """How well the landmarks determine the rotation of each of F frames, L landmarks.

    `condition` is the ratio of the largest to the smallest singular value of the
    image coordinates' partials by small turns about the camera's own three axes;
    unlike yaw and roll these turns stay separate where the camera looks straight
    down. `weak_axis` is the index in `AXES` of the axis nearest to the turn that
    is determined worst. `ahead` (F, L) is the cosine between the optical axis and
    each landmark, negative behind the camera.
    """

    condition: Floats
    weak_axis: Ints
    ahead: Floats

    def of(self, frames: slice) -> LandmarkGeometry:
        """The geometry of some frames."""
        return LandmarkGeometry(self.condition[frames], self.weak_axis[frames], self.ahead[frames])


@np.errstate(all="ignore")
def landmark_geometry(estimate: Estimate) -> LandmarkGeometry:
    """Compute the geometry of every frame; NaN, and axis 0, where there is no solution.

    Args:
        estimate: the job
    """
    radians = np.radians(estimate.camera_deg)
    turns = estimate.partials @ angles_by_turns(radians)
    # one landmark has two rows, and three singular values are needed
    sizes, axes = singular_values(np.pad(turns, ((0, 0), (0, 1), (0, 0))))
    return LandmarkGeometry(
        condition=sizes[:, 0] / sizes[:, 2],
        weak_axis=np.abs(axes[:, 2]).argmax(axis=1),
        ahead=ahead(camera_axes(radians), estimate.direction),
    )
