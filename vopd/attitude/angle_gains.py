"""How the angles of a frame and the attitude of its vehicle change with its residuals."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, distinct_in_rows
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate
from vopd.geometry.body_angles import turns_by_body_angles
from vopd.geometry.camera_axes import angles_by_turns
from vopd.geometry.linear import singular_values

NO_EFFECT = 1e-6  # of a turn on an angle: less is rounding


class Effect(NamedTuple):
    """What errors of one standard deviation in each of C causes change, degrees."""

    angles_deg: Floats  # (F, 9, C) the nine angles
    body_deg: Floats  # (F, 3, C) small turns about forward, right, down


class AngleGains(NamedTuple):
    """Derivatives of angles by residuals, and what the landmarks leave undetermined.

    Where the landmarks leave a turn of the camera free, the gains are without that turn.
    """

    angles: Floats  # (F, 9, 2L) the nine angles, radians by image units
    body: Floats  # (F, 3, 2L) small turns about forward, right, down
    free: Bools  # (F, 9) angles that a free turn changes
    free_turn: Floats  # (F, 3) its axis along forward, right, down, a unit vector; 0 where none

    def effect(self, component: ErrorComponent) -> Effect:
        """The effect of a component on angles and attitude."""
        if component.each_landmark:
            return Effect(
                _each_landmark(self.angles, component.residual),
                _each_landmark(self.body, component.residual),
            )
        return Effect(
            np.degrees(self.angles @ component.residual + component.angles),
            np.degrees(self.body @ component.residual + component.body),
        )

    def readings(self, sigma: Floats) -> Effect:
        """The effect of every image coordinate by itself, with these sigmas (F, 2L)."""
        scale = sigma[:, None]
        return Effect(np.degrees(self.angles * scale), np.degrees(self.body * scale))

    def covariance_deg2(self, effects: Iterable[Effect]) -> Floats:
        """The covariance of small turns about forward, right, down (F, 3, 3).

        Infinite where a free turn has a part in both axes.
        """
        total = np.where(np.isfinite(self.body[:, :, :1]), 0.0, np.nan) * np.ones((1, 1, 3))
        for one in effects:
            total = total + one.body_deg @ one.body_deg.swapaxes(1, 2)
        both = self.free_turn[:, :, None] * self.free_turn[:, None, :]
        return np.where(np.abs(both) > NO_EFFECT, np.copysign(np.inf, both), total)


def _each_landmark(gain: Floats, change: Floats) -> Floats:
    """Change, in degrees, when one landmark moves along one of its axes, (F, A, 3L)."""
    count = change.shape[1] // 2
    own = gain[..., None] * change[:, None]  # (F, A, 2L, 3)
    return np.degrees((own[:, :, :count] + own[:, :, count:]).reshape(*own.shape[:2], -1))


@np.errstate(all="ignore")
def angle_gains(estimate: Estimate) -> AngleGains:
    """Compute the derivatives of all frames.

    Args:
        estimate: the job
    """
    e = estimate
    frames = len(e.frame)
    chain = np.zeros((frames, 9, 3))
    chain[:, 0:3] = np.eye(3)
    chain[:, 3:6] = e.vehicle_by_camera
    chain[:, 6:9] = e.responses.attack_by_camera
    gains = AngleGains(
        chain @ e.gain, e.body_gain.copy(), np.zeros((frames, 9), bool), np.zeros((frames, 3))
    )
    some = np.flatnonzero(~np.isfinite(e.gain).all(axis=(1, 2)) & _seen(e))
    if not len(some):
        return gains
    by_turns = angles_by_turns(np.radians(e.camera_deg[some]))
    body = turns_by_body_angles(np.radians(e.vehicle_deg[some])) @ e.vehicle_by_camera[some]
    rows = np.where(np.tile(e.used[some], 2)[..., None], e.partials[some], 0.0) @ by_turns
    sizes, axes = singular_values(np.pad(rows, ((0, 0), (0, 1), (0, 0))))
    rank = np.stack([axes[:, k, :, None] / sizes[:, k, None, None] ** 2 for k in (0, 1)])
    limited = (rank @ axes[:, :2].swapaxes(0, 1)[..., None, :]).sum(axis=0) @ rows.swapaxes(1, 2)
    gains.angles[some] = chain[some] @ by_turns @ limited
    gains.body[some] = body @ by_turns @ limited
    turn = axes[:, 2, :, None]
    gains.free[some] = np.abs((chain[some] @ by_turns @ turn)[..., 0]) > NO_EFFECT
    axis = (body @ by_turns @ turn)[..., 0]
    gains.free_turn[some] = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    return gains


def _seen(estimate: Estimate) -> Bools:
    """Frames with angles and at least one landmark (F,)."""
    has = np.isfinite(estimate.camera_deg).all(axis=1)
    return np.asarray(has & (distinct_in_rows(estimate.landmark, estimate.used) >= 1))
