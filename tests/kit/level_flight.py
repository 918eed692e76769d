"""A flight of two frames whose attitudes are worked out by hand, and its files.

The camera looks straight down from longitude 90 on the equator, where north is Z, east is -X and
down is -Y of Earth-fixed axes; first with the top of the picture to the north, then, 100 m higher
and 2.5 s later, to the east. The vehicle is level and heads north, then east.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from tests.kit.estimates import ABOUT, estimate
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import Position
from vopd.export import FORMATS, FileRequest
from vopd.findings import Finding

EPOCH = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
REQUEST = FileRequest(
    epoch=EPOCH, originator="Who made it", object_name="The Kite", object_id="2026-001A",
    created=datetime(2027, 6, 5, 4, 3, 2, tzinfo=UTC),
)  # fmt: skip
HALF = "0.7071067812"


def flight(job: int = 1, start_s: float = 10.0, **changes: Any) -> History:
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
    content = FORMATS[form].render(list(jobs or (flight(),)), request, said.append)
    assert {one.severity for one in said} <= {"warning"}
    text = content.decode()
    assert "\r" not in text and text.endswith("\n")
    return text, [str(one) for one in said]
