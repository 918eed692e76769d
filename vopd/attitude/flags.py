"""What is to be distrusted in a frame, by name: the tests and their limits as one table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.landmark_geometry import AXES, Geometry
from vopd.attitude.outliers import outliers
from vopd.attitude.quaternion import angle_between_deg
from vopd.attitude.second_solution import second_rms_mm
from vopd.attitude.solution import Solution
from vopd.results import Results

MAX_CONDITION = 20.0
NEAR_POLE_DEG = 5.0
SECOND_RATIO = 3.0

MEANING = {
    "not_converged": (
        "the 22nd correction exceeds 1e-6 rad or is not a number",
        "look at the readings and at group 8's estimate; try --initial closed-form",
    ),
    "undetermined": (
        "fewer than two landmarks, or equations without a solution: the angles mean nothing",
        "read more landmarks",
    ),
    "behind_camera": (
        "a landmark lies behind the camera: the solve ended at the other solution",
        "try --initial closed-form",
    ),
    "two_landmarks": (
        "two landmarks only: no redundancy, and a swapped pair cannot be seen",
        "read a third landmark",
    ),
    "weak_geometry": (
        "one axis is held 20 times less well than the best (condition number); it is named",
        "read landmarks farther apart on the film",
    ),
    "second_solution": (
        "an attitude with the landmarks on the camera's other side fits as well, its residuals "
        "at most 3 times these or 3 times the reading sigma (root mean square)",
        "make sure that the first estimate looks at the ground",
    ),
    "pitch_near_90": (
        "camera or vehicle pitch within 5 degrees of 90: yaw and roll are not separate",
        "use the quaternion",
    ),
    "outlier": (
        "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); "
        "it is named",
        "read it again, or ignore it (group 10)",
    ),
    "jump": (
        "turns faster than --max-rate against a neighbour",
        "look at the frame's landmarks and time",
    ),
}
"""Every flag: what it means and what to do. The order is that of the flags of a frame."""


@dataclass(frozen=True)
class Flags:
    """Which flags each frame has; `detail` names the axis, angle or landmark where there is one."""

    raised: dict[str, Bools]  # (F,) each, in the order of `MEANING`
    detail: dict[str, list[str]]  # of F texts
    misfit: Bools  # (F, L) the landmark that is the outlier

    def text(self) -> list[str]:
        """One text a frame: names with a colon before the detail, semicolons between; or none."""
        frames = len(next(iter(self.raised.values())))
        return [";".join(self._of(k)) for k in range(frames)]

    def any(self) -> Bools:
        """The frames that have one (F,)."""
        return np.asarray(np.any(list(self.raised.values()), axis=0))

    def _of(self, k: int) -> list[str]:
        return [
            f"{name}:{self.detail[name][k]}" if name in self.detail else name
            for name, raised in self.raised.items()
            if raised[k]
        ]


@np.errstate(all="ignore")
def flags(
    solved: Solution,
    shape: Geometry,
    quaternion: Floats,
    rms_mm: Floats,
    reading_mm: float,
    max_rate_deg_s: float | None = None,
) -> Flags:
    """Look for everything in `MEANING`, in every frame that has an attitude."""
    r = solved.results
    count = r.used.sum(axis=1)
    has = np.asarray(np.isfinite(r.camera_deg).all(axis=1))
    free = np.isfinite(solved.gain).all(axis=(1, 2))
    misfit = outliers(solved)
    poles = {"camera_pitch": r.camera_deg[:, 1], "vehicle_pitch": r.vehicle_deg[:, 1]}
    near = {name: np.abs(np.cos(np.radians(a))) < _NEAR for name, a in poles.items()}
    fits = np.maximum(rms_mm, reading_mm) * SECOND_RATIO
    raised = {
        "not_converged": ~r.converged,
        "undetermined": r.solved & ~free,
        "behind_camera": has & (r.used & (shape.ahead < 0.0)).any(axis=1),
        "two_landmarks": has & (count == 2),
        "weak_geometry": has & free & ~(shape.condition <= MAX_CONDITION),
        "second_solution": has & (second_rms_mm(solved) <= fits),
        "pitch_near_90": has & np.any(list(near.values()), axis=0),
        "outlier": misfit.any(axis=1),
        "jump": _jumps(r, quaternion, max_rate_deg_s),
    }
    detail = {
        "weak_geometry": [AXES[k].replace(" ", "_") for k in shape.weak_axis],
        "pitch_near_90": [
            "+".join(name for name in near if near[name][k]) for k in range(len(has))
        ],
        "outlier": [str(int(n)) for n in np.where(misfit, r.landmark, 0).sum(axis=1)],
    }
    return Flags(raised, detail, misfit)


_NEAR = float(np.sin(np.radians(NEAR_POLE_DEG)))


def _jumps(r: Results, quaternion: Floats, max_rate_deg_s: float | None) -> Bools:
    """Frames that turn too fast against both neighbours, or against one that does not itself.

    A frame at the end has one neighbour; frames without an attitude are none.
    """
    jump = np.zeros(len(r.frame), bool)
    have = np.flatnonzero(np.isfinite(quaternion).all(axis=1) & np.isfinite(r.time_s))
    if max_rate_deg_s is None or len(have) < 2:
        return jump
    q, time_s = quaternion[have], r.time_s[have]
    fast = angle_between_deg(q[:-1], q[1:]) > max_rate_deg_s * np.abs(np.diff(time_s))
    before, after = np.append(fast[0], fast), np.append(fast, fast[-1])
    both = before & after
    step = fast & ~both[:-1] & ~both[1:]
    jump[have] = both | np.append(step, False) | np.append(False, step)
    return jump
