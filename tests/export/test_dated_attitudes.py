"""Attitudes with dates of their own: their order, and every value of their AEM and CZML."""

from __future__ import annotations

import json
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from vopd.export import FileRequest
from vopd.export.ccsds import DatedAttitudes, dated_aem, in_order, seconds_after
from vopd.export.viewers import dated_czml
from vopd.findings import Finding, VopdError

NINE = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
LATER = datetime(2026, 5, 1, 11, 0, 30, 500_000, tzinfo=timezone(timedelta(hours=2)))
REQUEST = FileRequest(object_name="eye", created=datetime(2027, 6, 5, 4, 3, 2, tzinfo=UTC))
X, Y, Z = np.eye(4)[1:]
"""Half turns about an axis, w x y z."""


def dated(**changes: Any) -> DatedAttitudes:
    """Three attitudes, the later one first, and the last one at the time of the second."""
    return DatedAttitudes(
        "<a>.csv", (LATER, NINE, NINE), np.array([X, -Y, Z]), "ICRF", "SENSOR_1",
        {"program": "vopd", "from <": "a & b"}, (11.0, 48.0, 500.0), np.array([Z, -X, Y]),
    )._replace(**changes)  # fmt: skip


def test_they_are_in_order_of_time_and_each_time_stands_once() -> None:
    said: list[Finding] = []
    found = in_order(dated(), said.append)
    assert found.moments == (NINE, LATER)
    assert found.quaternion.tolist() == [(-Y).tolist(), X.tolist()]
    assert found.earth_fixed is not None
    assert found.earth_fixed.tolist() == [(-X).tolist(), Z.tolist()]
    told = "attitude 3 is left out: it has the time of 2"
    assert said == [Finding(told, source="<a>.csv", severity="warning")]
    assert in_order(dated(earth_fixed=None), print).earth_fixed is None
    with refused(VopdError):
        in_order(dated(moments=()), print)


def test_seconds_are_counted_from_the_first() -> None:
    moments = (NINE, LATER, NINE + timedelta(days=10_000, microseconds=1))
    assert seconds_after(moments) == [0.0, 30.5, 864_000_000.000001]


def test_an_aem() -> None:
    said: list[Finding] = []
    lines = dated_aem(dated(), REQUEST, said.append).decode().splitlines()
    assert len(said) == 1
    assert lines == [
        "CCSDS_AEM_VERS = 2.0", "COMMENT program: vopd", "COMMENT from <: a & b",
        "CREATION_DATE = 2027-06-05T04:03:02", "ORIGINATOR = VOPD", "",
        "META_START", "COMMENT <a>.csv", "OBJECT_NAME = eye", "OBJECT_ID = UNKNOWN",
        "CENTER_NAME = EARTH", "REF_FRAME_A = ICRF", "REF_FRAME_B = SENSOR_1",
        "TIME_SYSTEM = UTC", "START_TIME = 2026-05-01T09:00:00.000000",
        "STOP_TIME = 2026-05-01T09:00:30.500000", "ATTITUDE_TYPE = QUATERNION", "META_STOP", "",
        "DATA_START",
        "2026-05-01T09:00:00.000000 0.0000000000 -1.0000000000 0.0000000000 0.0000000000",
        "2026-05-01T09:00:30.500000 1.0000000000 0.0000000000 0.0000000000 0.0000000000",
        "DATA_STOP",
    ]  # fmt: skip


INTERVAL = "2026-05-01T09:00:00.000000Z/2026-05-01T09:00:30.500000Z"
ABOUT = (
    "<table><tr><th>program</th><td>vopd</td></tr>"
    "<tr><th>from &lt;</th><td>a &amp; b</td></tr></table>"
)


@pytest.mark.parametrize(("name", "called"), [("eye", "eye"), (" ", "<a>.csv")])
def test_a_czml(name: str, called: str) -> None:
    text = dated_czml(dated(), FileRequest(object_name=name), lambda _: None).decode()
    assert text.startswith('[\n{"id": "document"') and text.endswith("}\n]\n")
    first = "2026-05-01T09:00:00.000000Z"
    assert json.loads(text) == [
        {
            "id": "document", "name": called, "version": "1.0", "description": ABOUT,
            "clock": {"interval": INTERVAL, "currentTime": first, "multiplier": 1},
        },
        {
            "id": "camera", "name": called, "description": f"<p>&lt;a&gt;.csv</p>{ABOUT}",
            "availability": INTERVAL, "position": {"cartographicDegrees": [11.0, 48.0, 500.0]},
            "orientation": {
                "epoch": first, "interpolationAlgorithm": "LINEAR", "interpolationDegree": 1,
                "unitQuaternion": [0.0, -1.0, 0.0, 0.0, 0.0, 30.5, 0.0, 0.0, 1.0, 0.0],
            },
            "point": {"pixelSize": 6, "color": {"rgba": [255, 196, 0, 255]}},
            "box": {"dimensions": {"cartesian": [3.0, 1.0, 1.0]}},
        },
    ]  # fmt: skip


def test_neighbours_are_near_and_twelve_decimals_are_kept() -> None:
    near = np.array([0.5, 0.5, 0.5, 0.5 + 1.4e-12])
    far = dated(moments=(NINE, LATER), earth_fixed=np.array([near, -near]))
    packet = json.loads(dated_czml(far, REQUEST, print))[1]
    values = packet["orientation"]["unitQuaternion"]
    assert values == [0.0, 0.5, 0.5, 0.500000000001, 0.5, 30.5, 0.5, 0.5, 0.500000000001, 0.5]


@pytest.mark.parametrize("missing", ["place", "earth_fixed"])
def test_a_czml_needs_place_and_turns(missing: str) -> None:
    with refused(VopdError):
        dated_czml(dated(**{missing: None}), REQUEST, lambda _: None)
