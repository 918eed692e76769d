"""What files state of their conventions: names of the statements, and what a format adds."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from html import unescape

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, estimate
from tests.kit.histories import about
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.export import FORMATS, FileRequest, own_epoch, statements, utc
from vopd.findings import Finding

EPOCH = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
REQUEST = FileRequest(epoch=EPOCH, created=EPOCH)


def one() -> History:
    """Three frames of a hand-made flight that has corrected errata, so that all is stated."""
    fixed = ABOUT._replace(fixes="restart")
    return history(estimate(np.tile([140.0, -60.0, 20.0], (3, 1)), about=fixed))


EVERY = {
    "program", "flight", "fixes", "from frame", "vertical", "to frame", "sequence", "quaternion",
    "camera angles", "ranges", "angles of attack", "position", "time", "sigmas", "intervals",
    "covariance", "common errors", "reading sigma",
}  # fmt: skip
MESSAGE = {
    "program", "flight", "fixes", "REF_FRAME_A, NED", "REF_FRAME_B, SC_BODY_1", "vertical",
    "quaternion", "position", "time",
}  # fmt: skip
STATED = {
    "csv": EVERY,
    "jsonl": EVERY,
    "kml": EVERY | {"gx:angles"},
    "czml": {
        "flight", "program", "fixes", "from frame", "vertical", "to frame", "orientation",
        "position", "time",
    },
    "aem": MESSAGE,
    "acm": MESSAGE | {"sigmas", "common errors", "reading sigma"},
}  # fmt: skip


def stated(form: str) -> dict[str, str]:
    """The statements of a file as it has them."""
    text = FORMATS[form].render([one()], REQUEST).decode()
    if form == "csv":
        lines = [line for line in text.splitlines() if line.startswith("# ")]
        return dict(line[2:].split(": ", 1) for line in lines)
    if form == "jsonl":
        found: dict[str, str] = json.loads(text.splitlines()[0])["conventions"]
        return found
    if form in ("kml", "czml"):
        table = json.loads(text)[0]["description"] if form == "czml" else unescape(text)
        cells = re.findall(r"<tr><th>(.*?)</th><td>(.*?)</td></tr>", table)
        return {key: unescape(sentence) for key, sentence in cells}
    head = text.split("CREATION_DATE")[0].splitlines()[1:]
    joined = " ".join(line.removeprefix("COMMENT ") for line in head)
    names = "|".join(map(re.escape, EVERY | MESSAGE))
    parts = re.split(rf"(?:^| )({names}): ", joined)[1:]
    return dict(zip(parts[::2], parts[1::2], strict=True))


@pytest.mark.parametrize("form", STATED)
def test_every_format_states_these(form: str) -> None:
    assert set(stated(form)) == STATED[form]


@pytest.mark.parametrize("form", STATED)
def test_the_moment_of_time_zero_is_stated(form: str) -> None:
    assert stated(form)["time"].endswith("; zero is 2026-05-01T09:00:00.000000Z")


def test_a_viewer_s_own_meaning_of_the_altitude_is_stated() -> None:
    taken = "degrees and metres; a viewer takes altitude as above "
    assert stated("czml")["position"].endswith(f"cartographicDegrees, {taken}the ellipsoid")
    assert stated("kml")["position"].endswith(f"; {taken}sea level")
    for form in ("csv", "aem"):
        assert "a viewer" not in stated(form)["position"]


def test_what_is_said_of_time_zero_where_there_are_several() -> None:
    dated = about(one(), epoch=EPOCH)
    assert own_epoch([dated, dated]) == EPOCH and own_epoch([dated, one()]) is None
    time = "seconds, of the source's own clock"
    none = FileRequest(created=EPOCH)
    assert statements([one(), one()], none)["time"] == time
    assert statements([dated, one()], none)["time"] == f"{time}; zero is each source's own epoch"
    both = statements([dated, one()], REQUEST)["time"]
    assert both == f"{time}; zero is 2026-05-01T09:00:00.000000Z"
    told = estimate([[0.0, 0.0, 0.0]]).about.words
    clock = replace(told, conventions={"time": "seconds of the flight; zero is noon"})
    own = about(one(), words=clock)
    assert statements([own], none)["time"] == "seconds of the flight; zero is noon"


@pytest.mark.parametrize(
    ("zone_h", "expected"),
    [(0.0, "2026-05-01T09:00:00.250000"), (2.0, "2026-05-01T07:00:00.250000"),
     (-4.5, "2026-05-01T13:30:00.250000"), (10.0, "2026-04-30T23:00:00.250000")],
)  # fmt: skip
def test_dates_are_utc_whatever_the_zone_of_the_epoch(zone_h: float, expected: str) -> None:
    local = datetime(2026, 5, 1, 9, 0, tzinfo=timezone(timedelta(hours=zone_h)))
    assert utc(local, 250_000) == expected


def test_warnings_about_level_views_count_the_frames_of_all_jobs() -> None:
    """Two frames of one job and one of the other look within 5 degrees of the horizon."""
    jobs = [
        history(estimate([[10.0, pitch, 0.0] for pitch in pitches], about=ABOUT._replace(job=job)))
        for job, pitches in ((1, (-3.0, -40.0, 2.0)), (2, (-4.9, -5.1)))
    ]
    said: list[Finding] = []
    FORMATS["odm"].render(jobs, REQUEST, said.append)
    (level,) = said
    assert level.severity == "warning" and level.deck == "hand.toml"
    expected = "3 frames look nearly level or upward, where yaw and roll are ill defined"
    assert level.message == expected


def test_blocks_of_several_jobs_are_told_apart() -> None:
    """An attitude and a covariance block for each, by the same name; of one job without a name."""
    jobs = [
        history(
            estimate(np.tile([140.0, -60.0, 20.0], (3, 1)), about=ABOUT._replace(job=job),
                     time_s=np.arange(3.0) + 10.0 * job),
            sigmas=Sigmas(reading=1.0),
        )
        for job in (1, 2)
    ]  # fmt: skip
    lines = FORMATS["acm"].render(jobs, REQUEST).decode().splitlines()
    named = [line for line in lines if "_BASIS_ID = " in line]
    assert named == [f"{block}_BASIS_ID = JOB {job}" for block in ("ATT", "COV") for job in (1, 2)]
    assert "ACM_DATA_ELEMENTS = ATT, ATT, COV, COV" in lines
    assert lines.count("START_TIME = 10.000000") == lines.count("STOP_TIME = 22.000000") == 1
    alone = FORMATS["acm"].render(jobs[:1], REQUEST).decode()
    assert "_BASIS_ID" not in alone and "ACM_DATA_ELEMENTS = ATT, COV\n" in alone
