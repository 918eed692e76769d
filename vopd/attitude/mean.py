"""The mean attitude of frames, with the uncertainty of the mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats
from vopd.attitude.conventions import included_statements
from vopd.attitude.sigmas import COMMON
from vopd.attitude.table import MATRICES, TableArrays, TableColumn, columns_of
from vopd.attitude.uncertainty import student_factor, total_freedom
from vopd.estimate import About
from vopd.findings import VopdError, shown
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.linear import covariance_factor_95, crossing
from vopd.geometry.rotations import (
    angles_by_turns,
    body_angles_by_turns,
    body_angles_deg,
    body_axes,
    camera_angles_deg,
    camera_axes,
    from_yaw_pitch_roll,
    rotation_matrices,
    rotation_vectors_deg,
)
from vopd.records import Record

if TYPE_CHECKING:
    from vopd.attitude.history import History

# Mean attitude

FARTHEST_DEG = 90.0  # from the mean: farther apart no attitude is the middle of the others
SETTLED_DEG = 1e-11  # a mean of turns about the mean that is none
PASSES = 50


@dataclass(frozen=True, eq=False, repr=False)
class MeanAttitude(Record):
    """The mean attitude of frames of one job; angles in degrees.

    The small turns of the frames about it, about the vehicle's axes, have the mean zero.
    Standard deviations are of the mean itself, those of the angles in the order of the first six
    of `ANGLES`; the covariance is of a small turn about the vehicle's forward, right and down
    axes at the mean.

    Attributes:
        about: of which job
        frames: how many it is the mean of
        flagged: how many of those have a flag
        reading_sigma: in image units
        reading_freedom: its degrees of freedom
        camera_deg: yaw, pitch, roll (3,)
        vehicle_deg: yaw, pitch, roll (3,)
        quaternion: local north-east-down to vehicle body, w x y z, w >= 0 (4,)
        total: standard deviations of camera and vehicle yaw, pitch, roll, all components (6,)
        half_width_95: half-widths of 95 % intervals, with Student's factor (6,)
        freedom: degrees of freedom of that; infinite where no sigma was estimated (6,)
        components: standard deviations by component (6,) each
        covariance_deg2: (3, 3)
        covariance_factor_95: times that: the ellipsoid that contains the truth with 95 %
    """

    about: About = field(repr=False)
    frames: int
    flagged: int
    reading_sigma: float
    reading_freedom: float
    camera_deg: Floats
    vehicle_deg: Floats
    quaternion: Floats
    total: Floats
    half_width_95: Floats
    freedom: Floats
    components: dict[str, Floats]
    covariance_deg2: Floats
    covariance_factor_95: float


class Middle(NamedTuple):
    """The attitude about which the small turns of frames have the mean zero."""

    some: Bools  # (all frames of the job,) which it is the middle of: F
    away: Floats  # (F, 3) rotation vectors from it to them, about its axes, radians
    axes: Floats  # (1, 3, 3) forward, right, down
    quaternion: Floats  # (1, 4)
    deg: Floats  # (1, 3) yaw, pitch, roll


def middle_of(history: History, frames: ArrayLike | slice | None) -> Middle:
    """Find the middle of the attitudes of some frames.

    The arguments and errors are those of `mean_attitude`.
    """
    label, some = history.about.label, with_attitude(history, frames)
    if not some.any():
        raise VopdError(f"{label}: no mean attitude: none of the frames has an attitude")
    of_frames = history.quaternion[some]
    mean = body_axes(np.radians(history.estimate.vehicle_deg[some][:1]))
    for _ in range(PASSES):
        vehicle_deg = body_angles_deg(mean)
        quaternion = from_yaw_pitch_roll(vehicle_deg)
        away_deg = rotation_vectors_deg(np.repeat(quaternion, len(of_frames), axis=0), of_frames)
        move_deg = away_deg.mean(axis=0)
        if np.abs(move_deg).max() < SETTLED_DEG:
            break
        mean = mean @ rotation_matrices(np.radians(move_deg)[None])
    farthest = float(np.linalg.norm(away_deg, axis=1).max())
    if not farthest < FARTHEST_DEG:
        raise VopdError(
            f"{label}: no mean attitude: one of the frames is {farthest:.0f} degrees from "
            "it; average frames with similar attitudes"
        )
    return Middle(some, np.radians(away_deg), mean, quaternion, vehicle_deg)


def with_attitude(history: History, frames: ArrayLike | slice | None) -> Bools:
    """Mark those of some frames whose attitude is known, and how well, (all frames of the job,).

    The arguments and errors are those of `mean_attitude`.
    """
    known = np.isfinite(history.uncertainty.covariance_deg2).all(axis=(1, 2))
    chosen = _marked(frames, len(history.landmarks), history.about.label)
    return np.asarray(chosen & known & history.has_attitude)


def _marked(frames: ArrayLike | slice | None, count: int, label: str) -> Bools:
    """Mark the frames that are chosen by their indices, or by a mark for each.

    Raises:
        VopdError: where there is no such frame, or they are chosen in another way
    """
    each = np.arange(count)
    if frames is None or isinstance(frames, slice):
        return np.isin(each, each[frames or slice(None)])
    try:
        chosen = np.asarray(frames).reshape(-1)
    except ValueError:  # lists of several lengths
        chosen = np.array([None])
    if chosen.dtype.kind == "b" and chosen.shape == each.shape:
        return np.asarray(chosen)
    indices = np.unique(chosen) if chosen.dtype.kind in "iu" or not chosen.size else None
    if indices is None or not np.isin(indices, np.arange(-count, count)).all():
        raise VopdError(
            f"{label}: frames to average are named by their indices, from 0 to {count - 1} "
            f"whatever their numbers, or by a mark for each of the {count}, not by {shown(frames)}"
        )
    return np.isin(each, indices % count)


def mean_attitude(history: History, frames: ArrayLike | slice | None = None) -> MeanAttitude:
    """Average the attitude over frames.

    Errors that are the same in all frames do not average out, and those of a fix of the track do
    not over the frames beside it: if the frames were solved together, the mean has the whole
    covariance of that solve. If each was solved by itself, it has the mean of the covariances of
    what is common, and of the others a part in F.

    Args:
        history: of one job
        frames: their indices, or a mark for each frame; None: all. Frames without an attitude, or
            with one that the landmarks do not determine, are left out.

    Raises:
        VopdError: if no frame is left, one is 90 degrees or more from the mean, or there is no
            such frame
    """
    doubt, about = history.uncertainty, history.about
    middle = middle_of(history, frames)
    some, mean, quaternion, vehicle_deg = middle.some, middle.axes, middle.quaternion, middle.deg
    axes = body_axes(np.radians(history.estimate.vehicle_deg[some][:1]))
    camera = camera_axes(np.radians(history.estimate.camera_deg[some][:1]))
    to_camera = camera @ NED_FROM_ENU @ axes  # from the vehicle's axes, in any frame
    by_left, by_right = by_turns_of(middle.away)
    by_frames = np.linalg.solve(by_left.sum(axis=0), by_right)
    camera_deg = camera_angles_deg(to_camera @ mean.swapaxes(1, 2) @ NED_FROM_ENU)
    by_turns = np.concatenate(
        [
            angles_by_turns(np.radians(camera_deg))[0] @ to_camera[0],
            body_angles_by_turns(np.radians(vehicle_deg))[0],
        ]
    )
    if history.sum_errors is None:
        covariance, components = _by_frames(history, some, by_frames)
    else:
        covariance, components = _by_sums(history, some, by_frames, by_turns)
    total = np.sqrt(sum(one**2 for one in components.values()))
    freedom = total_freedom(doubt.reading.freedom, total**2, components["reading"] ** 2)
    return MeanAttitude(
        about,
        int(some.sum()),
        int(history.flags.any()[some].sum()),
        doubt.reading.sigma,
        doubt.reading.freedom,
        camera_deg[0],
        vehicle_deg[0],
        quaternion[0],
        total,
        total * student_factor(freedom),
        freedom,
        components,
        covariance,
        float(covariance_factor_95(freedom[3:].min())),
    )


def covariances_of_sums(history: History, some: Bools, weights: Floats) -> dict[str, Floats]:
    """Find the covariances, by component, of k sums over frames that were solved together.

    Args:
        history: of the job
        some: marks of F of its frames
        weights: of a small turn of each of them about the vehicle's axes, (F, k, 3)

    Returns:
        Matrices (k, k), degrees squared for weights without a unit.
    """
    assert history.sum_errors is not None
    weight = np.zeros((len(some), 3, weights.shape[1]))
    weight[some] = weights.swapaxes(1, 2)
    found = {name: np.degrees(np.degrees(one)) for name, one in history.sum_errors(weight).items()}
    mount_deg = history.uncertainty.sigmas.mount_deg
    if mount_deg > 0.0:
        whole = mount_deg * weights.sum(axis=0)
        found["mount"] = whole @ whole.T
    return found


def by_turns_of(away: Floats) -> tuple[Floats, Floats]:
    """Differentiate how frames are turned from an attitude by small turns, (F, 3, 3) each.

    Args:
        away: rotation vectors from the attitude to the frames, radians (F, 3)

    Returns:
        By the attitude's turns about its own axes, which take from the vectors, and by those of
        each frame, which add to them.
    """
    angle = np.linalg.norm(away, axis=1)[:, None, None]
    across = crossing(away)
    near = angle < 1e-3
    safe = np.where(near, 1.0, angle)
    series = 1.0 / 12.0 + angle**2 / 720.0
    second = np.where(near, series, (1.0 - 0.5 * safe / np.tan(0.5 * safe)) / safe**2)
    even = np.eye(3) + second * across @ across
    return even - 0.5 * across, even + 0.5 * across


def _by_frames(
    history: History, some: Bools, by_frames: Floats
) -> tuple[Floats, dict[str, Floats]]:
    """Average covariances, and components, of frames that were solved each by itself."""
    doubt, count = history.uncertainty, int(some.sum())
    common = count * doubt.covariance_common_deg2[some]
    each = by_frames @ (common + doubt.covariance_independent_deg2[some])
    covariance = (each @ by_frames.swapaxes(1, 2)).sum(axis=0)
    squares = {name: (one[some, :6] ** 2).mean(axis=0) for name, one in doubt.components.items()}
    return covariance, {
        name: np.sqrt(one if name in COMMON else one / count) for name, one in squares.items()
    }


def _by_sums(
    history: History, some: Bools, by_frames: Floats, by_turns: Floats
) -> tuple[Floats, dict[str, Floats]]:
    """Find the covariance of the mean, and its components, of frames that were solved together."""
    found = covariances_of_sums(history, some, by_frames)
    squares = {n: np.einsum("ai,ij,aj->a", by_turns, one, by_turns) for n, one in found.items()}
    components = {name: np.sqrt(np.maximum(one, 0.0)) for name, one in squares.items()}
    if "mount" in components:
        components["mount"][:3] = 0.0  # it turns the vehicle against the camera
    return sum(found.values(), np.zeros((3, 3))), components


# Table of means

COUNTS = (
    TableColumn("frames", "", None, "frames", "how many the mean is of"),
    TableColumn("flagged", "", None, "flagged", "how many of them have a flag"),
)


def mean_table(
    histories: Sequence[History], means: Sequence[MeanAttitude]
) -> tuple[list[TableColumn], TableArrays]:
    """Tabulate the means of jobs: those columns of the histories that a mean has, and their values.

    The covariance is there by its elements and as a matrix.

    Raises:
        VopdError: if they have different units
    """
    names = dict.fromkeys(name for one in means for name in one.components)
    missing = np.full(6, np.nan)
    values = {
        "source_name": [one.about.source for one in means],
        "job_number": [one.about.job for one in means],
        "frames": [one.frames for one in means],
        "flagged": [one.flagged for one in means],
        "estimate.camera_deg": [one.camera_deg for one in means],
        "estimate.vehicle_deg": [one.vehicle_deg for one in means],
        "quaternion": [one.quaternion for one in means],
        "reading_sigma": [one.reading_sigma for one in means],
        "reading_freedom": [one.reading_freedom for one in means],
        "uncertainty.total": [one.total for one in means],
        "uncertainty.half_width_95": [one.half_width_95 for one in means],
        "uncertainty.covariance_deg2": [one.covariance_deg2 for one in means],
        "uncertainty.covariance_factor_95": [one.covariance_factor_95 for one in means],
    } | {
        f"uncertainty.components.{name}": [one.components.get(name, missing) for one in means]
        for name in names
    }
    arrays = {name: np.array(own) for name, own in values.items()}
    freedom = arrays["reading_freedom"]
    arrays["reading_freedom"] = np.where(np.isfinite(freedom), freedom, np.nan)
    source, job, *others = columns_of(histories)
    columns, table = [], {}
    for column in (source, job, *COUNTS, *others, MATRICES[0]):
        attribute, indices = column.path
        own = arrays.get(attribute)
        if own is None or any(index >= own.shape[-1] for index in indices):
            continue  # alpha, beta and eta among the nine angles
        for index in indices:
            own = own[..., index]
        columns.append(column)
        table[column.name] = own
    return columns, table


NOT_OF_MEANS = ("angles of attack", "position", "time", "common errors")
"""Statements about columns that a table of means does not have."""


def mean_statements(
    stated: dict[str, str], histories: Sequence[History], means: Sequence[MeanAttitude]
) -> dict[str, str]:
    """State the conventions of a table of means."""
    kept = {name: text for name, text in stated.items() if name not in NOT_OF_MEANS}
    components = ", ".join(dict.fromkeys(name for one in means for name in one.components))
    together = any(one.sum_errors is not None for one in histories)
    return kept | {
        **included_statements(histories, means),
        "sigmas": "one standard deviation of the mean, degrees, without Student's factor; "
        f"components: {components}",
        "intervals": "95 %, with Student's factor; half_width_95 is half the width of an interval",
        "mean": f"{MEAN}; {TOGETHER if together else APART}",
    }


MEAN = (
    "of all frames with an attitude: the one about which their small turns have the mean zero; "
    "angles of the mean attitude, not means of angles"
)
TOGETHER = (
    "its covariance is that of the solve of all frames together: errors that are common to the "
    "frames do not average out, nor those of a fix of the track over the frames beside it"
)
APART = (
    "its covariance is common + (all - common) / F: errors that are the same in all frames do not "
    "average out"
)
