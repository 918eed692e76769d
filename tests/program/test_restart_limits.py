"""Which angles a frame hands to the next: the limits of the restart rule, from both sides.

Without a focal length angles stay what they are but for the circle that is taken off, so the
angle that is carried is another than that of group 8 (A 432 to A 437, A 449 to A 454).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import film, without
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.program.vopd import run_jobs
from vopd.results import Results

CIRCLE = 359.999999569273  # 2 * 3.14159265 * 57.29577951


def starts(angles: list[list[float]], *names: str, dropped: tuple[int, ...] = ()) -> list[Results]:
    """Three frames that start from these angles, and as many from each of the others."""
    job = without(film(3), *dropped)
    cameras = [
        replace(job.camera, focal_length_mm=0.0, initial_deg=np.array(one)) for one in angles
    ]
    found = run_jobs([replace(job, camera=camera) for camera in cameras], fixes(*names))
    return [one for one in found if isinstance(one, Results)]


def about(axis: int, angle: float) -> list[float]:
    """One degree in two angles, and this one in the third."""
    return [angle if k == axis else 1.0 for k in range(3)]


LIMITS = {  # an angle of group 8; whether it is carried, with one circle taken off
    "yaw": (0, [(361.0, True), (366.28, True), (366.29, False), (380.0, False), (-10.0, False)]),
    "pitch": (1, [
        (361.0, True), (363.14, True), (363.15, False), (366.2, False), (190.0, False),
        (-361.0, True), (-363.14, True), (-363.15, False), (-190.0, False),
    ]),
    "roll": (2, [(361.0, True), (366.28, True), (366.29, False), (380.0, False), (-10.0, False)]),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_which_angles_are_carried(name: str) -> None:
    """From 0 to 2 pi degrees, 6.2832, or of pitch -3.1416 to 3.1416; others begin at group 8."""
    axis, cases = LIMITS[name]
    found = starts([about(axis, angle) for angle, _ in cases])
    for (angle, carried), one in zip(cases, found, strict=True):
        expected = angle - CIRCLE * np.sign(angle) if carried else angle
        assert_close("wrapped angle", one.start_deg[0], about(axis, angle))
        assert_close("wrapped angle", one.start_deg[1], about(axis, expected))


@pytest.mark.parametrize("name", LIMITS)
def test_all_angles_are_carried_where_that_is_corrected(name: str) -> None:
    """The limits are 0 to 360 degrees, or of pitch -180 to 180."""
    axis, cases = LIMITS[name]
    found = starts([about(axis, angle) for angle, _ in cases], "restart")
    for (angle, _), one in zip(cases, found, strict=True):
        assert_close("wrapped angle", one.start_deg[1, axis], angle - CIRCLE * np.sign(angle))


def test_a_dropped_frame_hands_nothing_on() -> None:
    """Frame 3 starts where frame 1 ended, and frame 1 at group 8."""
    (found,) = starts([[361.0, 1.0, 1.0]], dropped=(2,))
    assert_close("wrapped angle", found.start_deg[[0, 2], 0], [361.0, 361.0 - CIRCLE])
    (found,) = starts([[361.0, 1.0, 1.0]], dropped=(1,))
    assert_close("wrapped angle", found.start_deg[1:, 0], [361.0, 361.0 - CIRCLE])


def test_what_is_carried_is_what_the_22nd_correction_leaves() -> None:
    """A circle is taken off in each pass: 21 in pass 22, whose angle is printed, and then 22."""
    more, less = starts([[7925.0, 1.0, 1.0], [7565.0, 1.0, 1.0]])
    assert_close("wrapped angle", more.camera_deg[0, 0], 7925.0 - 21 * CIRCLE)
    assert_close("wrapped angle", more.start_deg[1, 0], 7925.0 - 22 * CIRCLE)
    assert_close("wrapped angle", less.camera_deg[0, 0], 7565.0 - 21 * CIRCLE)
    assert_close("wrapped angle", less.start_deg[1, 0], 7565.0 - 21 * CIRCLE)
