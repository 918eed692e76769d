"""CZML: one packet a job with its position and orientation on the Earth, for Cesium.

The orientation turns components in the body (x forward, y right, z down) into
Earth-fixed ones, with the scalar last, as Cesium has it.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.own_position import report_own_position
from vopd.export.file_request import FileRequest, html, name, statements, utc
from vopd.export.times import TimedAttitude, continuous, timed_attitudes
from vopd.findings import Report
from vopd.geometry.rotations import from_axes, product

ORIENTATION = (
    "unitQuaternion x y z w, scalar last: rotating a vector's components in the vehicle body by it "
    "gives its Earth-fixed components (WGS 84); neighbours have signs that make them near"
)
STATED = (
    *("program", "fixes", "from frame", "vertical", "to frame"),
    *("orientation", "position", "time"),
)
POSITION = "cartographicDegrees, degrees and metres; a viewer takes altitude as above the ellipsoid"
BOX_M = (300.0, 100.0, 30.0)  # forward, right, down; large enough to be seen, not to scale
GOLD, WHITE = [255, 196, 0, 255], [255, 255, 255, 255]


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the document, one packet a line; times are seconds after the epoch.

    Args:
        histories: the jobs
        request: epoch and name
        report: is given warnings about frames that are left out
    """
    assert request.epoch is not None
    found = timed_attitudes(histories, request.epoch, report)
    report_own_position(histories, report)
    stated = statements(histories, request, orientation=ORIENTATION)
    stated["position"] += f"; {POSITION}"
    source = histories[0].about.words.source
    about = {key: stated[key] for key in (source, *STATED) if key in stated}
    packets = [_document(found, request, about)]
    packets += [_vehicle(k, one, request, about) for k, one in enumerate(found, 1)]
    lines = ",\n".join(json.dumps(packet, allow_nan=False) for packet in packets)
    return f"[\n{lines}\n]\n".encode()


def _document(
    found: Sequence[TimedAttitude], request: FileRequest, about: dict[str, str]
) -> dict[str, Any]:
    first = min(one.microseconds[0] for one in found)
    last = max(one.microseconds[-1] for one in found)
    return {
        "id": "document",
        "name": name(request, found[0].history),
        "version": "1.0",
        "description": html(about),
        "clock": {
            "interval": _interval(request, first, last),
            "currentTime": _interval(request, first, last).partition("/")[0],
            "multiplier": 1,
            "range": "LOOP_STOP",
            "step": "SYSTEM_CLOCK_MULTIPLIER",
        },
    }


def _vehicle(
    k: int, one: TimedAttitude, request: FileRequest, about: dict[str, str]
) -> dict[str, Any]:
    assert request.epoch is not None
    epoch = utc(request.epoch, 0) + "Z"
    called = name(request, one.history)
    where = f"{one.history.about.label}: {called}"
    sampled = {"epoch": epoch, "interpolationAlgorithm": "LINEAR", "interpolationDegree": 1}
    return {
        "id": f"vehicle-{k}",
        "name": called,
        "description": f"<p>{escape(where)}</p>" + html(about),
        "availability": _interval(request, one.microseconds[0], one.microseconds[-1]),
        "position": sampled | {"cartographicDegrees": _samples(one, one.position, 9)},
        "orientation": sampled | {"unitQuaternion": _samples(one, earth_fixed(one), 12)},
        "path": {"width": 2, "material": {"solidColor": {"color": {"rgba": GOLD}}}},
        "point": {"pixelSize": 6, "color": {"rgba": GOLD}},
        "label": {
            "text": called,
            "font": "14px sans-serif",
            "fillColor": {"rgba": WHITE},
            "horizontalOrigin": "LEFT",
            "pixelOffset": {"cartesian2": [12, 0]},
        },
        "box": {
            "dimensions": {"cartesian": list(BOX_M)},
            "material": {"solidColor": {"color": {"rgba": GOLD}}},
        },
    }


def earth_fixed(one: TimedAttitude) -> Floats:
    """Quaternions from body to Earth-fixed axes, x y z w, (T, 4)."""
    local = from_axes(one.history.estimate.position.north_east_down[one.frames])
    return np.roll(continuous(product(local, one.quaternion)), -1, axis=1)


def _samples(one: TimedAttitude, values: Floats, decimals: int) -> list[float]:
    seconds = np.array(one.microseconds)[:, None] / 1e6
    flat: list[float] = np.hstack([seconds, np.round(values, decimals)]).ravel().tolist()
    return flat


def _interval(request: FileRequest, first: int, last: int) -> str:
    assert request.epoch is not None
    return f"{utc(request.epoch, first)}Z/{utc(request.epoch, last)}Z"
