"""Frames in order of time, each time once; dates, and both sides of every limit."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit.estimates import estimate
from tests.kit.histories import about, with_estimate
from vopd.attitude.history import History, history
from vopd.export import FORMATS, FileRequest, created_now, has_date, utc
from vopd.export.ccsds import (
    DatedAttitudes,
    continuous,
    dated_aem,
    in_order,
    timed_attitudes,
)
from vopd.export.viewers import dated_czml
from vopd.findings import Finding, VopdError
from vopd.inputs import utc_moment
from vopd.job import Deck
from vopd.pipeline import run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

ZERO = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)


@pytest.fixture(scope="module")
def flight() -> History:
    """A flight of 40 frames, all of them with an attitude."""
    (job,), _ = make(Plan(frames=40, landmarks=5, seed=3))
    (one,) = run(Deck((job,), "flight.dat")).histories()
    return one


def at(history: History, times: Sequence[float]) -> History:
    """The same frames at other times."""
    return with_estimate(history, time_s=np.array(times))


def test_all_dated_formats_hold_times_once(flight: History) -> None:
    double = at(flight, [0.0] * 40)
    said: list[Finding] = []
    request = FileRequest(epoch=ZERO)
    aem = FORMATS["aem"].render([double], request, said.append).decode()
    assert len(said) == 39 and aem.count("\n1974-08-27T17:30:00.000000 ") == 1
    czml = FORMATS["czml"].render([double], request, said.append).decode()
    assert '"cartographicDegrees": [0.0, ' in czml
    kml = FORMATS["kml"].render([double], request, said.append).decode()
    assert kml.count("<when>") == 2  # the track's and the frame's
    rows = FORMATS["csv"].render([double], request, said.append).decode().splitlines()
    assert sum(not row.startswith("#") for row in rows) == 41  # the table keeps all


def test_frames_without_a_time_are_left_out(flight: History) -> None:
    times = np.full(40, np.nan)
    times[7] = 1.0
    (one,) = timed_attitudes([at(flight, times)], ZERO, lambda _: None)
    assert one.frames.tolist() == [7]
    with refused(VopdError):
        timed_attitudes([at(flight, np.full(40, np.inf))], ZERO, lambda _: None)
    times[7] = 1e13  # a time is known, which has no date
    with refused(VopdError):
        timed_attitudes([at(flight, times)], ZERO, lambda _: None)


@pytest.mark.parametrize("time_s", [1e300, -1e13, 3e11, -7e10])
def test_a_time_without_a_date_costs_one_frame(flight: History, time_s: float) -> None:
    """Years 1 to 9999 are 6.2e10 s before and 2.5e11 s after 1974."""
    times = np.arange(40.0)
    times[3] = time_s
    said: list[Finding] = []
    for form in ("aem", "czml", "kml"):
        FORMATS[form].render([at(flight, times)], FileRequest(epoch=ZERO), said.append)
    left_out = [str(one) for one in said if "on WGS 84" not in str(one)]
    assert ["row 4, is left out" in one for one in left_out] == [True] * 3
    assert "outside the years 1 to 9999" in left_out[0]


def test_files_have_near_neighbours_and_no_minus_zero(flight: History) -> None:
    """Half a turn about forward, now a little more, now less: the table's x jumps, w is 0."""
    half = np.array([1e-12, 1.0, -1e-12, 0.0])
    turns = replace(flight, quaternion=np.where(np.arange(40)[:, None] % 2, half, -half))
    request = FileRequest(epoch=ZERO)
    aem = FORMATS["aem"].render([turns], request).decode()
    data = aem.partition("DATA_START\n")[2].partition("DATA_STOP")[0].splitlines()
    assert {line.partition(" ")[2] for line in data} == {
        "-1.0000000000 0.0000000000 0.0000000000 0.0000000000"
    }


def test_czml_has_near_neighbours(flight: History) -> None:
    """Earth-fixed, 179 and 181 degrees about X: as -179 the second's signs would be opposite."""
    degrees = np.where(np.arange(40) % 2, 179.0, 181.0)
    fixed = Rotation.from_rotvec(degrees[:, None] * [1.0, 0.0, 0.0], degrees=True)
    local = Rotation.from_matrix(flight.estimate.position.north_east_down) * fixed
    turns = replace(flight, quaternion=np.roll(local.as_quat(canonical=True), 1, axis=1))
    packet = json.loads(FORMATS["czml"].render([turns], FileRequest(epoch=ZERO)))[1]
    turn = np.reshape(packet["orientation"]["unitQuaternion"], (-1, 5))[:, 1:]
    assert ((turn[1:] * turn[:-1]).sum(axis=1) > 0.0).all()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1974-08-27T17:30:00Z", "1974-08-27T17:30:00.000000"),
        ("1974-08-27T17:30:00", "1974-08-27T17:30:00.000000"),
        ("1974-08-27 19:30:00.25+02:00", "1974-08-27T17:30:00.250000"),
        ("0099-01-01", "0099-01-01T00:00:00.000000"),
    ],
)
def test_epochs(text: str, expected: str) -> None:
    assert utc(utc_moment(text), 0) == expected


def test_times_after_the_epoch() -> None:
    assert utc(ZERO, -697_000) == "1974-08-27T17:29:59.303000"
    assert utc(datetime(1972, 2, 28, 23, 59, 59, tzinfo=UTC), 1_000_001) == (
        "1972-02-29T00:00:00.000001"
    )
    assert has_date(datetime(9999, 12, 31, 23, 59, 59, tzinfo=UTC), 999_999)
    assert not has_date(datetime(9999, 12, 31, 23, 59, 59, tzinfo=UTC), 1_000_000)
    assert not has_date(ZERO, 10**30)


@pytest.mark.parametrize("text", ["", "soon", "1974-13-01", "17:30", "0001-01-01T00:00+05:00"])
def test_what_is_no_epoch(text: str) -> None:
    with refused(VopdError):
        utc_moment(text)


def test_the_date_of_making(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    assert created_now() == datetime(2001, 9, 9, 1, 46, 40, tzinfo=UTC)
    for bad in ("today", "1e9", "9" * 30):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", bad)
        with refused(VopdError):
            created_now()
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    assert abs((created_now() - datetime.now(UTC)).total_seconds()) < 60


def test_the_library_refuses_as_the_command_does(flight: History) -> None:
    with refused(VopdError):
        FORMATS["czml"].render([flight], FileRequest())
    with refused(VopdError):
        FORMATS["csv"].render([], FileRequest())
    with refused(VopdError):
        FORMATS["aem"].render([flight], FileRequest(epoch=ZERO, originator="\u00e9"))
    with refused(VopdError):
        FORMATS["aem"].render([flight], FileRequest(epoch=ZERO, aem_version=3))


def test_every_job_that_overlaps_an_earlier_one_is_told(flight: History) -> None:
    """The first lasts until 39 s; the third begins after the second has ended, and in the first."""
    spans = [(0.0, 39.0), (5.0, 10.0), (20.0, 30.0), (39.0, 50.0)]
    jobs = [
        about(at(flight, np.linspace(*span, 40).tolist()), job=k) for k, span in enumerate(spans, 1)
    ]
    said: list[Finding] = []
    FORMATS["aem"].render(jobs, FileRequest(epoch=ZERO), said.append)
    assert [one.job for one in said] == [2, 3]
    assert all("overlaps flight.dat, job 1 in time" in one.message for one in said)


# Both sides of every limit

ZERO_LIMITS = datetime(2026, 5, 1, tzinfo=UTC)
FRAMES = 4


def flight_limits(**changes: Any) -> History:
    """Four frames, at 0, 1, 2 and 3 s."""
    return history(estimate(np.tile([140.0, -60.0, 20.0], (FRAMES, 1)), **changes))


PLAIN = flight_limits()


def kept(one: History, epoch: datetime | None = ZERO_LIMITS) -> tuple[list[int], list[str]]:
    said: list[Finding] = []
    (found,) = timed_attitudes([one], epoch, said.append)
    assert {one.severity for one in said} <= {"warning"}
    return found.frames.tolist(), [str(one) for one in said]


def moved(time_s: list[float]) -> History:
    return replace(PLAIN, estimate=replace(PLAIN.estimate, time_s=np.array(time_s)))


def put(**changes: Any) -> History:
    here = replace(PLAIN.estimate.position, **changes)
    return replace(PLAIN, estimate=replace(PLAIN.estimate, position=here))


GONE = "hand.toml: job 1: frame DJI_000{}.JPG, row {}, is left out: {}"


@pytest.mark.parametrize(
    ("time_s", "frames", "twice"),
    [
        ([0.0, 1.0, 2.0, 3.0], [0, 1, 2, 3], []),
        ([3.0, 2.0, 1.0, 0.0], [3, 2, 1, 0], []),
        ([5.0, 5.0, 5.0, 1.0], [3, 0], [(1, 2, 1), (2, 3, 1)]),
        ([2.0, 1.0, 2.0000004, 1.0000006], [1, 3, 0], [(2, 3, 1)]),
        ([1.0000005, 1.0000015, 9.0, 8.0], [0, 1, 3, 2], []),
        ([-1.0, -1.0000004, 0.0, -0.0], [1, 2], [(0, 1, 2), (3, 4, 3)]),
    ],
)
def test_frames_are_in_order_and_each_microsecond_stands_once(
    time_s: list[float], frames: list[int], twice: list[tuple[int, int, int]]
) -> None:
    told = [GONE.format(k, row, f"it has the time of row {first}") for k, row, first in twice]
    assert kept(moved(time_s)) == (frames, told)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("time_s", "epoch", "there"),
    [
        (1e12, None, True),
        (1.001e12, None, False),
        (1e12, ZERO_LIMITS, False),
        (5e10, ZERO_LIMITS, True),
    ],
)  # fmt: skip
def test_times_that_have_no_date(
    time_s: float, epoch: datetime | None, there: bool, sign: float
) -> None:
    """Without an epoch up to a million million seconds; with one the years 1 to 9999."""
    frames, said = kept(moved([0.0, sign * time_s, 2.0, 3.0]), epoch)
    assert (1 in frames, len(frames)) == (there, 3 + there)
    zero = "" if epoch is None else f" after {epoch:%Y-%m-%dT%H:%M:%S}Z"
    why = f"its time of {sign * time_s:g} s{zero} is outside the years 1 to 9999"
    assert said == ([] if there else [GONE.format(1, 2, why)])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_leaves_a_frame_out(value: float) -> None:
    """A time, an angle, each part of a position, an axis, a part of the quaternion."""
    e = PLAIN.estimate
    for name in ("longitude_deg", "latitude_deg", "altitude"):
        spoiled = getattr(e.position, name).copy()
        spoiled[2] = value
        assert kept(put(**{name: spoiled})) == ([0, 1, 3], []), name
    axes = e.position.north_east_down.copy()
    axes[2, 1, 2] = value
    assert kept(put(north_east_down=axes)) == ([0, 1, 3], [])
    for part in range(4):
        turn = PLAIN.quaternion.copy()
        turn[2, part] = value
        assert kept(replace(PLAIN, quaternion=turn)) == ([0, 1, 3], [])
    angles = e.vehicle_deg.copy()
    angles[2, 1] = value
    assert kept(replace(PLAIN, estimate=replace(e, vehicle_deg=angles))) == ([0, 1, 3], [])
    assert kept(moved([0.0, 1.0, value, 3.0])) == ([0, 1, 3], [])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_positions_farther_than_1e15_m_are_left_out(sign: float) -> None:
    for altitude, there in ((0.999e15, True), (1e15, False)):
        high = put(altitude=np.array([0.0, 0.0, sign * altitude, 0.0]))
        assert (2 in kept(high)[0]) == there


def test_positions_are_longitude_latitude_and_metres() -> None:
    """Of a source in feet too; jobs without a frame are left out, and where all are, said."""
    feet = replace(PLAIN.estimate, units=PLAIN.estimate.units._replace(metres_per_length=0.25))
    none = moved([np.nan] * FRAMES)
    found = timed_attitudes([none, replace(PLAIN, estimate=feet), PLAIN], ZERO_LIMITS, print)
    assert len(found) == 2
    assert np.round(found[0].position[1], 9).tolist() == [7.441, 46.95, 300.0]
    assert np.round(found[1].position[3], 9).tolist() == [7.443, 46.95, 1200.0]
    assert found[0].microseconds == [0, 1_000_000, 2_000_000, 3_000_000]
    assert found[0].quaternion.tolist() == PLAIN.quaternion.tolist()
    for jobs in ([], [none]):
        with refused(VopdError):
            timed_attitudes(jobs, ZERO_LIMITS, print)


@pytest.mark.parametrize(
    ("given", "signs"),
    [
        ([1, 1, 1], [1, 1, 1]), ([1, -1, 1], [1, -1, 1]), ([-1, 1, 1], [1, -1, -1]),
        ([1, -1, -1], [1, -1, -1]), ([1], [1]), ([], []),
    ],
)  # fmt: skip
def test_signs_that_make_neighbours_near(given: list[int], signs: list[int]) -> None:
    """The first keeps its sign; quaternions at right angles keep theirs."""
    q = np.array(given, float)[:, None] * np.array([[0.5, 0.5, -0.5, 0.5]])
    assert continuous(q).tolist() == (q * np.array(signs, float)[:, None]).tolist()
    across = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0]])
    assert continuous(across)[1].tolist() == [0.0, 1.0, 0.0, 0.0]


# Attitudes with dates of their own

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
    later = dated(moments=(NINE, NINE + timedelta(days=10_000, microseconds=1)))
    packet = json.loads(dated_czml(later, REQUEST, print))[1]
    assert packet["orientation"]["unitQuaternion"][5] == 864_000_000.000001


@pytest.mark.parametrize("missing", ["place", "earth_fixed"])
def test_a_czml_needs_place_and_turns(missing: str) -> None:
    with refused(VopdError):
        dated_czml(dated(**{missing: None}), REQUEST, lambda _: None)
