"""What clicks alone tell of a flight, against the covariance of a frame by hand."""

from __future__ import annotations

import numpy as np

from tests.tolerances import within
from tools.click_limit import drawn, turns_deg
from tools.render_video import Settings


def test_clicks_of_one_frame_are_a_solve_of_their_own() -> None:
    """Matches without a weight leave the frame to its six clicks: .25 px2 (J^T J)^-1."""
    one = drawn(Settings(seed=7, size=(480, 270), frames=4, clicks=6))
    alone = one._replace(seen=one.seen[:1])
    rng = np.random.default_rng(1)
    clicks = rng.normal(0.0, 0.5, (4000, 12))
    turn = turns_deg(alone, clicks, 1e-6, rng)
    j = one.by_turn[0, [mark for _, mark in one.click]].reshape(-1, 3)
    stated = np.degrees(np.sqrt(0.25 * np.trace(np.linalg.inv(j.T @ j))))
    assert abs(np.sqrt((turn**2).mean()) / stated - 1.0) < within("turns of 4,000 draws")
