"""CZML of a camera that stands at one place: its position and orientation on the Earth."""

from __future__ import annotations

import json
from html import escape
from typing import Any

from vopd.export.dated_attitudes import DatedAttitudes, in_order, scalar_last, seconds_after
from vopd.export.file_request import FileRequest, html, printable, utc
from vopd.findings import Report, VopdError

DECIMALS = 12
BOX_M = (3.0, 1.0, 1.0)  # forward, right, down; large enough to be seen


def dated_czml(attitudes: DatedAttitudes, request: FileRequest, report: Report) -> bytes:
    """Make the document, one packet a line; times are seconds after the first attitude.

    Args:
        attitudes: with place and Earth-fixed quaternions
        request: has the object's name
        report: is given warnings about attitudes that are left out

    Raises:
        VopdError: the place is not known
    """
    ordered = in_order(attitudes, report)
    if ordered.place is None or ordered.earth_fixed is None:
        raise VopdError("czml needs the place of the camera")
    first, last = (utc(ordered.moments[k], 0) + "Z" for k in (0, -1))
    interval = f"{first}/{last}"
    called = printable(request.object_name.strip()) or printable(ordered.title)
    rows = scalar_last(ordered.earth_fixed).round(DECIMALS).tolist()
    samples: list[float] = []
    for second, row in zip(seconds_after(ordered.moments), rows, strict=True):
        samples += [second, *row]
    clock = {"interval": interval, "currentTime": first, "multiplier": 1}
    packets: list[dict[str, Any]] = [
        {
            "id": "document",
            "name": called,
            "version": "1.0",
            "description": html(ordered.stated),
            "clock": clock,
        },
        {
            "id": "camera",
            "name": called,
            "description": f"<p>{escape(ordered.title)}</p>" + html(ordered.stated),
            "availability": interval,
            "position": {"cartographicDegrees": list(ordered.place)},
            "orientation": {
                "epoch": first,
                "interpolationAlgorithm": "LINEAR",
                "interpolationDegree": 1,
                "unitQuaternion": samples,
            },
            "point": {"pixelSize": 6, "color": {"rgba": [255, 196, 0, 255]}},
            "box": {"dimensions": {"cartesian": list(BOX_M)}},
        },
    ]
    lines = ",\n".join(json.dumps(packet, allow_nan=False) for packet in packets)
    return f"[\n{lines}\n]\n".encode()
