"""Frames in order of time, each time once; dates; what the library says of wrong requests."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit.histories import about, with_estimate
from vopd.attitude.history import History
from vopd.export import FORMATS, FileRequest, created_now, has_date, parse_epoch, utc
from vopd.export.ccsds import continuous, timed_attitudes
from vopd.findings import Finding, VopdError
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


def test_frames_are_sorted_and_times_stand_once(flight: History) -> None:
    times = np.arange(40.0)
    times[:5] = [3.0, 1.0, 2.0, 1.0000004, 0.5]  # the fourth is the second to the microsecond
    said: list[Finding] = []
    (one,) = timed_attitudes([at(flight, times)], ZERO, said.append)
    assert one.frames[:4].tolist() == [4, 1, 2, 0] and len(one.frames) == 39
    assert one.microseconds[:4] == [500_000, 1_000_000, 2_000_000, 3_000_000]
    np.testing.assert_array_equal(one.quaternion, flight.quaternion[one.frames])
    (warning,) = said
    fourth = flight.estimate.frame[3]
    assert str(warning) == (
        f"flight.dat: job 1: frame {fourth}, row 4, is left out: it has the time of row 2"
    )
    assert warning.severity == "warning"


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


def test_frames_without_a_position_are_left_out(flight: History) -> None:
    here = flight.estimate.position
    altitude = here.altitude.copy()
    altitude[3] = np.nan
    bent = with_estimate(flight, position=replace(here, altitude=altitude))
    (one,) = timed_attitudes([bent], ZERO, print)
    assert 3 not in one.frames and len(one.frames) == 39


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


def test_signs_are_continuous() -> None:
    q = np.array([[1.0, 0, 0, 0], [-0.9, 0.1, 0, 0], [0.8, -0.2, 0, 0], [0.7, -0.3, 0, 0]])
    wanted = q * [[1.0], [-1.0], [1.0], [1.0]]
    np.testing.assert_array_equal(continuous(q), wanted)
    np.testing.assert_array_equal(continuous(q[:1]), q[:1])
    np.testing.assert_array_equal(continuous(-q), -wanted)


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
    assert utc(parse_epoch(text), 0) == expected


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
        parse_epoch(text)


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
