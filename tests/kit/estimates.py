"""Estimates made by hand, without a deck: metres and pixels, named landmarks and images.

Directions, image points and partials come from `tests.kit.appendix_a`, which was
written apart from the program.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.kit import appendix_a
from vopd.arrays import Floats
from vopd.estimate import About, Estimate, FrameStatus, Position, Responses, Units, Words

FOCAL = 10.4
PIXELS = Units("m", "px", 1.0, "px", 1.0)
WORDS = Words(source="flight", reading="a pick", repeated="by points picked several times")
ABOUT = About("hand.toml", 1, "a flight by hand", words=WORDS)
POINTS = np.array([[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0], [2.0, 2.0]])
NAMES = {7: "church tower", 8: "bridge; north end", 9: "=A1", 10: "<crossing>"}


def estimate(
    truth_deg: Floats,
    image: Floats = POINTS,
    noise: float = 0.0,
    **changes: Any,
) -> Estimate:
    """Frames with these camera angles that show landmarks at these image points.

    Args:
        truth_deg: camera yaw, pitch, roll, (F, 3)
        image: image coordinates, (F, L, 2), or (L, 2) for all frames
        noise: standard deviation of the residuals, which are not solved for
        changes: of fields of the estimate
    """
    truth = np.atleast_2d(np.asarray(truth_deg, float))
    frames = len(truth)
    points = np.broadcast_to(image, (frames, *np.shape(image)[-2:])).astype(float)
    count = points.shape[1]
    cosines = np.array([
        appendix_a.ahead(angles / appendix_a.RAD, one, FOCAL)
        for angles, one in zip(truth, points, strict=True)
    ])  # fmt: skip
    slopes = np.array([
        -appendix_a.partials(angles / appendix_a.RAD, one, FOCAL, erratum=False)
        for angles, one in zip(truth, cosines, strict=True)
    ])  # fmt: skip
    partials = np.moveaxis(slopes, 2, 1).reshape(frames, 2 * count, 3)
    rng = np.random.default_rng(count)
    residual = (
        rng.normal(0.0, noise, (frames, 2 * count)) if noise else np.zeros((frames, 2 * count))
    )
    gain = np.array([_gain(one) for one in partials])
    fields: dict[str, Any] = {
        "about": ABOUT,
        "units": PIXELS,
        "frame": np.arange(frames) + 1,
        "status": np.full(frames, FrameStatus.SOLVED),
        "solved": np.ones(frames, bool),
        "converged": np.ones(frames, bool),
        "correction_rad": np.zeros((frames, 3)),
        "time_s": np.arange(frames, dtype=float),
        "position": position(frames),
        "displacement": np.zeros((frames, 3)),
        "camera_deg": truth,
        "vehicle_deg": truth,
        "vehicle_by_camera": np.tile(np.eye(3), (frames, 1, 1)),
        "attack_deg": np.tile([1.0, 2.0, 3.0], (frames, 1)),
        "airspeed": np.full(frames, 30.0),
        "landmark": np.tile(np.arange(count) + 7, (frames, 1)),
        "used": np.ones((frames, count), bool),
        "ignored": np.zeros((frames, count), bool),
        "direction": cosines,
        "image": points,
        "focal_length": FOCAL,
        "residual": residual,
        "partials": partials,
        "gain": gain,
        "body_gain": gain,
        "responses": responses(frames, count),
        "reading_spread": 0.3,
        "reading_floor": 0.1,
        "relative_sigma": np.ones((frames, count)),
        "landmark_names": NAMES,
        "frame_names": tuple(f"DJI_{k:04}.JPG" for k in range(frames)),
    }
    return Estimate(**(fields | changes))


def _gain(partials: Floats) -> Floats:
    if not np.isfinite(partials).all():
        return np.full(partials.T.shape, np.nan)
    return np.asarray(np.linalg.pinv(partials))


def position(frames: int) -> Position:
    """Above Bern, going east; the axes by the textbook."""
    latitude, longitude = np.full(frames, 46.95), 7.44 + 0.001 * np.arange(frames)
    (sp, st), (cp, ct) = (f(np.radians([latitude, longitude])) for f in (np.sin, np.cos))
    north = np.stack([-sp * ct, -sp * st, cp], axis=1)
    east = np.stack([-st, ct, 0.0 * st], axis=1)
    up = np.stack([cp * ct, cp * st, sp], axis=1)
    axes = np.stack([north, east, -up], axis=1)
    return Position(latitude, longitude, np.full(frames, 1200.0), axes, latitude - 0.19)


def responses(frames: int, count: int) -> Responses:
    """Image coordinates that move by .01 px a metre, 1 px a unit of focal length, 2 px a second."""
    return Responses(
        landmark=np.full((frames, 2 * count, 3), 0.01),
        position=np.full((frames, 2 * count, 3), -0.01),
        focal_length=np.ones((frames, 2 * count)),
        time=np.full((frames, 2 * count), 2.0),
        attack_by_camera=np.tile(np.eye(3), (frames, 1, 1)),
        attack_by_time=np.zeros((frames, 3)),
        attack_by_velocity=np.tile(0.01 * np.eye(3), (frames, 1, 1)),
    )
