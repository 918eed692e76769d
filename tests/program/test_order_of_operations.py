"""Sums, roots and quotients to the last bit, in the order in which the listing has them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from tests.kit import appendix_a
from tests.kit.jobs import film, reread
from vopd.job import Readings
from vopd.program.alpbet import alpbet
from vopd.program.average import averages
from vopd.program.orient import orient
from vopd.program.vopd import run

RD = 57.29577951


def test_the_distance_from_the_centre_is_the_root_of_the_sum_of_squares() -> None:
    """A 343 to A 347; another routine for the length of a vector rounds otherwise."""
    job = film(40)
    read = np.random.default_rng(1).uniform(-9.0, 9.0, (40, 5, 3, 2))
    corners = np.zeros((40, 4, 3, 2))
    found = run(replace(job, readings=reread(job.readings, landmark_in=read, fiducial_in=corners)))
    point = found.point_mm.reshape(-1, 2)  # the centre is at 0, 0
    expected = [math.sqrt(x * x + y * y) for x, y in point.tolist()]
    assert found.radius_mm.ravel().tolist() == expected
    assert expected != [math.hypot(x, y) for x, y in point.tolist()]


def test_eta_and_the_airspeed_are_from_roots_of_sums_of_squares() -> None:
    """C 1 to C 40, of a vehicle that looks north and level in still air."""
    velocity = np.random.default_rng(2).uniform(-900.0, 900.0, (200, 3))
    zero = np.zeros(200)
    found = alpbet(velocity, np.zeros((200, 2)), theta=zero, psi=zero, phi=zero)
    across = [math.sqrt(v * v + w * w) for _, v, w in velocity.tolist()]
    assert found.etad.tolist() == (np.arctan2(across, velocity[:, 0]) * RD).tolist()
    speed = [math.sqrt(u * u + v * v + w * w) for u, v, w in velocity.tolist()]
    assert found.cvp.tolist() == speed


def test_a_mean_is_a_sum_of_quotients() -> None:
    """A 84 to A 104: each reading over 12, or over 3, and then the sum, from the least reading."""
    random = np.random.default_rng(3)
    corners, marks = (
        random.uniform(0.0, 9.0, (30, 4, 3, 2)),
        random.uniform(0.0, 9.0, (30, 1, 3, 2)),
    )
    one = np.ones((30, 1), np.int64)
    readings = Readings.of(
        frame=np.arange(30), fiducial_in=corners, landmark=one, present=one > 0, landmark_in=marks
    )
    centre, point = averages(readings, rounded=False)
    for frame in range(30):
        for axis in (0, 1):
            mean = 0.0
            for corner in range(4):
                for value in sorted(corners[frame, corner, :, axis].tolist()):
                    mean = mean + value / 12.0
            assert centre[frame, axis] == mean
            low, middle, high = sorted(marks[frame, 0, :, axis].tolist())
            assert point[frame, axis] == low / 3.0 + middle / 3.0 + high / 3.0


def test_the_angles_of_a_frame_that_rests_at_once_have_been_radians() -> None:
    """Those printed are radians times RAD; where all residuals vanish at once, group 8's own."""
    start = np.random.default_rng(4).uniform([[0.0], [-170.0], [0.0]], 170.0, (3, 50))
    cosines = np.tile([0.1, 0.9, -0.4], (50, 3, 1))
    back = start / RD * RD
    assert (back != start).any()
    for film_mm, expected in ((1.0, back), (0.0, start)):
        seen = appendix_a.sight(cosines, np.full((50, 3, 2), film_mm), 0.0)
        assert orient(start, seen).angles.tolist() == expected.tolist()


def test_a_frame_whose_residuals_vanish_at_once_is_not_wrapped() -> None:
    """It ends in its first pass, at angles beyond a circle too."""
    start = np.array([[361.0, -1.0, 10.0], [2.0, 181.0, -190.0], [3.0, 400.0, -5.0]])
    cosines = np.tile([0.1, 0.9, -0.4], (3, 3, 1))
    found = orient(start, appendix_a.sight(cosines, np.zeros((3, 3, 2)), 0.0))
    assert found.angles.tolist() == start.tolist()
    assert found.last_pass.tolist() == [1, 1, 1] and not found.singular.any()
