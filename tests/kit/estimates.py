"""Estimates made by hand, without a deck: metres and pixels, named landmarks and images.

Directions, image points and partials come from `tests.kit.appendix_a`, which was written apart from
the program.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from tests.kit import appendix_a
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import About, Estimate, FrameStatus, Position, Responses, Units, Words
from vopd.export import FORMATS, FileRequest
from vopd.findings import Finding

FOCAL = 10.4
PIXELS = Units("m", "px", 1.0, "px", 1.0)
WORDS = Words(source="flight", reading="a pick")
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
        "frame_names": [f"DJI_{k:04}.JPG" for k in range(frames)],
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


# A level flight of two frames: the camera looks straight down from longitude 90 on the equator,
# where north is Z, east is -X and down is -Y of Earth-fixed axes; first with the top of the picture
# to the north, then, 100 m higher and 2.5 s later, to the east. The vehicle is level and heads
# north, then east.


EPOCH = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
REQUEST = FileRequest(
    epoch=EPOCH, originator="Who made it", object_name="The Kite", object_id="2026-001A",
    created=datetime(2027, 6, 5, 4, 3, 2, tzinfo=UTC),
)  # fmt: skip
HALF = "0.7071067812"


def level_flight(job: int = 1, start_s: float = 10.0, **changes: Any) -> History:
    """The two frames, with variances of .25, 4E-6 and 900, and -, 1 and 2 squared degrees."""
    axes = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    where = Position(
        np.zeros(2), np.full(2, 90.0), np.array([100.0, 200.0]), np.stack([axes] * 2), np.zeros(2)
    )
    one = history(
        estimate(
            [[0.0, -90.0, 0.0], [90.0, -90.0, 0.0]],
            vehicle_deg=np.array([[0.0, 0.0, 0.0], [90.0, 0.0, 0.0]]),
            **{
                "position": where, "time_s": np.array([start_s, start_s + 2.5]),
                "about": ABOUT._replace(job=job), "frame": np.array([7, 8]),
            } | changes,
        ),
        sigmas=Sigmas(reading=1.0),
    )  # fmt: skip
    covariance = np.stack([np.diag([0.25, 4e-6, 900.0]), np.diag([1.0, np.inf, 2.0])])
    covariance[0, 0, 1] = covariance[0, 1, 0] = 5.0
    return replace(one, uncertainty=replace(one.uncertainty, covariance_deg2=covariance))


def text_of(form: str, *jobs: History, request: FileRequest = REQUEST) -> tuple[str, list[str]]:
    said: list[Finding] = []
    content = FORMATS[form].render(list(jobs or (level_flight(),)), request, said.append)
    assert {one.severity for one in said} <= {"warning"}
    text = content.decode()
    assert "\r" not in text and text.endswith("\n")
    return text, [str(one) for one in said]


# Frames of one landmark or none


def one_landmark(*used: int, frames: int = 2) -> Estimate:
    """Frames in the first of which only some landmarks take part, by default the first.

    Args:
        used: indices of these
        frames: how many frames there are; the others have all four landmarks
    """
    return only(used or (0,), frames)


def no_landmark() -> Estimate:
    """Two frames, the first of which has no landmark."""
    return only((), 2)


def only(used: tuple[int, ...], frames: int) -> Estimate:
    """Frames in the first of which only these landmarks take part."""
    one = estimate(np.tile([140.0, -60.0, 20.0], (frames, 1)), noise=0.01)
    takes_part, gain = one.used.copy(), one.gain.copy()
    takes_part[0] = False
    takes_part[0, list(used)] = True
    gain[0] = np.nan
    return replace(one, used=takes_part, gain=gain, body_gain=gain.copy())


def assert_same_landmarks(block: Estimate, whole: Estimate) -> None:
    """Compare the landmarks of frames in arrays of a few columns with those in arrays of more."""
    count, widest = block.used.shape[1], whole.used.shape[1]
    coordinates = np.append(np.arange(count), widest + np.arange(count))  # x, then y
    known = np.isfinite(whole.gain).all(axis=(1, 2))
    for name in ("used", "ignored", "landmark", "image", "direction", "relative_sigma"):
        _same(getattr(block, name), getattr(whole, name)[:, :count])
    for name in ("residual", "partials"):
        _same(getattr(block, name), getattr(whole, name)[:, coordinates])
    for name in ("gain", "body_gain"):
        _same(getattr(block, name)[known], getattr(whole, name)[known][:, :, coordinates])
    for name in ("landmark", "position", "focal_length", "time"):
        _same(getattr(block.responses, name), getattr(whole.responses, name)[:, coordinates])


def _same(one: np.ndarray, other: np.ndarray) -> None:
    if one.dtype.kind == "f":
        size = np.maximum(np.abs(other), 1.0)
        assert_close("relative, in blocks or not", one / size, other / size)
    else:
        np.testing.assert_array_equal(one, other)
