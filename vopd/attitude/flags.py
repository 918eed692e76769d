"""Flags of doubtful frames: conditions, limits, meanings, and details."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats, distinct_in_rows
from vopd.attitude.geometry import LandmarkGeometry, free_turn_text, weak_axis_text
from vopd.attitude.residuals import outliers
from vopd.attitude.uncertainty import Uncertainty
from vopd.estimate import COMMON_PART, Estimate, Words
from vopd.geometry.rotations import LARGEST_DEG, angle_between_deg
from vopd.records import Rows

# Table of flags.

MAX_CONDITION = 20.0
NEAR_POLE_DEG = 5.0
SECOND_RATIO = 3.0

MEANING = {
    "not_converged": (
        "the last correction exceeds 1e-6 rad or is not a number",
        "look at the measured coordinates and at the first estimate",
    ),
    "undetermined": (
        "fewer than two landmarks, or equations without a solution: the angles are one of many "
        "attitudes that fit; what is not known is named",
        "measure more landmarks",
    ),
    "out_of_range": (
        "an angle of camera or vehicle is beyond a full circle: the solve diverged",
        "look at the measured coordinates and at the first estimate",
    ),
    "behind_camera": (
        "a landmark lies behind the camera: the solve ended at the other solution",
        "give a first estimate that looks at the landmarks",
    ),
    "two_landmarks": (
        "two landmarks only: one degree of freedom, and an exchanged pair cannot be seen",
        "measure a third landmark",
    ),
    "weak_geometry": (
        "one rotation axis is determined 20 times worse than the best one (condition number); "
        "it is named",
        "measure landmarks farther apart in the image",
    ),
    "second_solution": (
        "an attitude with the landmarks on the camera's other side fits as well, its residuals "
        "at most 3 times these or 3 times the reading sigma (root mean square)",
        "make sure that the first estimate looks at the ground",
    ),
    "position_not_held": (
        "the attitude depends on the position as it was stated, and the picks hardly improve it: "
        "its errors turn the attitude by more than .1 degree, which is more than half of the "
        "variance, and along some direction its standard deviation after the solve is above .9 of "
        "that before",
        "measure more landmarks, far apart and at different distances, or the position itself",
    ),
    "pitch_near_90": (
        "camera or vehicle pitch within 5 degrees of 90: yaw and roll are not separate",
        "use the quaternion",
    ),
    "outlier": (
        "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); "
        "it is named",
        "measure it again, or leave it out",
    ),
    "misfit": (
        "the residuals do not agree with the standard deviations in force (chi-square or F test, "
        ".001 a frame, two landmarks or more); an exchange of two labels, one landmark or another "
        "position that explains it is named, with the chance of the residuals that then remain",
        "look at the landmarks that are named, or at the position",
    ),
    "rate_unknown": (
        "no other frame within three frame intervals and half a second says how fast the camera "
        "turns while the rows of this one are read; its picks count as of one time",
        "pick landmarks in a frame next to it",
    ),
    "extrapolated": (
        "the frame lies beyond a table, which is named, and the values of that are extrapolated",
        "extend the table",
    ),
    "jump": (
        "turns faster than --max-rate against a neighbour",
        "look at the frame's landmarks and time",
    ),
}
"""Every flag: what it means and what to do, unless the `Words` of the source say otherwise.

The order is that of the flags of a frame.
"""


def meanings(words: Words) -> dict[str, tuple[str, str]]:
    """Look up the meaning of every flag for one kind of source, and the remedy."""
    return {name: words.flags.get(name, general) for name, general in MEANING.items()}


@dataclass(frozen=True, eq=False, repr=False)
class Flags(Rows):
    """The flags of every frame, with details such as the axis or the landmark concerned."""

    raised: dict[str, Bools]  # (F,) each, in the order of `MEANING`
    detail: dict[str, list[str]]  # F texts each, for the flags that have a detail

    def text(self) -> list[str]:
        """Write the flags of each frame as text: `flag;flag:detail`."""
        names, raised = list(self.raised), np.array(list(self.raised.values()))
        texts: list[list[str]] = [[] for _ in range(raised.shape[1])]
        for flag, k in np.argwhere(raised).tolist():
            name = names[flag]
            detail = self.detail[name][k] if name in self.detail else ""
            texts[k].append(f"{name}:{detail}" if detail else name)
        return [";".join(of_frame) for of_frame in texts]

    def any(self) -> Bools:
        """Mark the frames that have a flag (F,)."""
        return np.asarray(np.any(list(self.raised.values()), axis=0))


@np.errstate(all="ignore")
def flags(
    estimate: Estimate,
    shape: LandmarkGeometry,
    quaternion: Floats,
    rms: Floats,
    doubt: Uncertainty,
    reading_sigma: Floats,
    misfit_text: list[str],
    second_rms: Floats,
) -> Flags:
    """Test every frame that has an attitude for every condition in `MEANING` but for jumps.

    Args:
        estimate: the job
        shape: its landmark geometry
        quaternion: local north-east-down to body, (F, 4)
        rms: root mean square of the residuals, image units, (F,)
        doubt: its uncertainty, and the frames that do not agree with the sigmas in force
        reading_sigma: the reading sigma in force, (F,)
        misfit_text: what mends each of these frames
        second_rms: of the residuals of the second solution, (F,); it matters up to `fits_as_well`
    """
    e = estimate
    count = distinct_in_rows(e.landmark, e.used)
    angles = np.hstack([e.camera_deg, e.vehicle_deg])
    has = np.asarray(np.isfinite(e.camera_deg).all(axis=1))
    determined = np.isfinite(e.gain).all(axis=(1, 2))
    outlier = outliers(e) if e.outlier is None else e.outlier
    poles = {"camera_pitch": e.camera_deg[:, 1], "vehicle_pitch": e.vehicle_deg[:, 1]}
    near = {name: np.abs(np.cos(np.radians(a))) < _NEAR for name, a in poles.items()}
    other_deg = e.other_solution_deg
    elsewhere = np.zeros(len(has), bool) if other_deg is None else np.isfinite(other_deg)
    undetermined = (e.solved & ~determined) | (has & (count < 2))
    weak = np.asarray(has & determined & ~(shape.condition <= MAX_CONDITION))
    raised = {
        "not_converged": ~e.converged,
        "undetermined": undetermined,
        "out_of_range": e.solved & (np.abs(angles).max(axis=1) > LARGEST_DEG),
        "behind_camera": has & shape.behind,
        "two_landmarks": has & (count == 2),
        "weak_geometry": weak,
        "second_solution": has & (second_rms <= fits_as_well(rms, reading_sigma)) | elsewhere,
        "position_not_held": position_not_held(e, doubt.covariance_deg2),
        "pitch_near_90": has & np.any(list(near.values()), axis=0),
        "outlier": outlier.any(axis=1),
        "misfit": doubt.reading.misfit,
        "rate_unknown": np.zeros_like(has) if e.rate_unknown is None else has & e.rate_unknown,
        "extrapolated": has & np.any([np.zeros_like(has), *e.extrapolated.values()], axis=0),
    }
    detail = {
        "undetermined": free_turn_text(e, doubt.free_turn),
        "weak_geometry": weak_axis_text(shape, doubt.covariance_deg2, weak),
        "second_solution": _turned(other_deg, elsewhere),
        "pitch_near_90": _names_of(near),
        "outlier": _names(e, outlier),
        "misfit": misfit_text,
        "extrapolated": _names_of(e.extrapolated) if e.extrapolated else [""] * len(has),
    }
    return Flags(raised, detail)


HELD = 0.9  # of its standard deviation, to which picks that say something reduce a position's
LEAST_HELD_DEG = 0.1  # of the attitude by the position; those of a survey's receiver make less


@np.errstate(all="ignore")
def position_not_held(estimate: Estimate, covariance_deg2: Floats) -> Bools:
    """Find the frames whose picks hardly improve a position on which the attitude depends, (F,).

    Args:
        estimate: the job
        covariance_deg2: of turns by all components, (F, 3, 3)
    """
    if estimate.position_ratio is None or estimate.errors is None:
        return np.zeros(len(estimate.frame), bool)
    names = ("position", "position" + COMMON_PART)
    parts = [estimate.errors[name] for name in names if name in estimate.errors]
    variance = np.sum([(np.degrees(one.body) ** 2).sum(axis=(1, 2)) for one in parts], axis=0)
    most = variance > 0.5 * np.trace(covariance_deg2, axis1=1, axis2=2)
    return np.asarray(most & (variance > LEAST_HELD_DEG**2) & (estimate.position_ratio > HELD))


def _turned(other_deg: Floats | None, marked: Bools) -> list[str]:
    """Write by how much the attitude of another position is turned; empty for other frames."""
    if other_deg is None:
        return [""] * len(marked)
    return [
        f"{angle:.2f} degrees away at another position" if one else ""
        for angle, one in zip(other_deg.tolist(), marked.tolist(), strict=True)
    ]


def fits_as_well(rms: Floats, reading_sigma: Floats) -> Floats:
    """Calculate the largest residuals of a second solution that is flagged, (F,).

    Args:
        rms: root mean square of the residuals of the solution, image units, (F,)
        reading_sigma: the reading sigma in force, (F,)
    """
    return np.maximum(rms, reading_sigma) * SECOND_RATIO


def _names_of(marks: Mapping[str, Bools]) -> list[str]:
    """Join the names of the marks of each frame with `+`; empty for most frames."""
    names = [""] * len(next(iter(marks.values())))
    for name, marked in marks.items():
        for k in np.flatnonzero(marked).tolist():
            names[k] += f"+{name}" if names[k] else name
    return names


def _names(estimate: Estimate, outlier: Bools) -> list[str]:
    """Name the outliers of each frame, joined with `+`; empty where all landmarks fit."""
    names = [""] * len(outlier)
    for k, i in np.argwhere(outlier):
        label = estimate.landmark_label(estimate.landmark[k, i])
        label = label.replace(";", ",")  # semicolons separate flags
        names[k] += f"+{label}" if names[k] else label
    return names


_NEAR = float(np.sin(np.radians(NEAR_POLE_DEG)))


def jumps(time_s: Floats, quaternion: Floats, max_rate_deg_s: float | None) -> Bools:
    """Find frames that turn too fast against both neighbours, or against one that does not itself.

    Neighbours are those in time. The first and the last frame have one; frames without an attitude
    are skipped.

    Args:
        time_s: the times of the frames, (F,)
        quaternion: local north-east-down to body, (F, 4)
        max_rate_deg_s: as `history` takes it
    """
    jump = np.zeros(len(time_s), bool)
    have = np.flatnonzero(np.isfinite(quaternion).all(axis=1) & np.isfinite(time_s))
    have = have[np.argsort(time_s[have], kind="stable")]
    if max_rate_deg_s is None or len(have) < 2:
        return jump
    q, time_s = quaternion[have], time_s[have]
    fast = angle_between_deg(q[:-1], q[1:]) > max_rate_deg_s * np.diff(time_s)
    before, after = np.append(fast[0], fast), np.append(fast, fast[-1])
    both = before & after
    step = fast & ~both[:-1] & ~both[1:]
    jump[have] = both | np.append(step, False) | np.append(False, step)
    return jump
