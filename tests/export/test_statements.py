"""What files state of their conventions, epochs and names: every case of each."""

from __future__ import annotations

import json
import re
import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from html import unescape

import numpy as np
import pytest

import vopd.export as file_request
from tests.approved.texts import assert_approved, refused
from tests.kit.estimates import ABOUT, estimate, level_flight
from tests.kit.histories import about
from vopd.attitude import summary
from vopd.attitude.history import History, history
from vopd.attitude.long_history import one_part
from vopd.attitude.sigmas import Sigmas
from vopd.export import (
    FORMATS,
    FileRequest,
    created_now,
    has_date,
    html,
    name,
    own_epoch,
    printable,
    statements,
    title,
    utc,
)
from vopd.findings import Finding, VopdError
from vopd.inputs import utc_moment

EPOCH = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
REQUEST = FileRequest(epoch=EPOCH, created=EPOCH)


def one() -> History:
    """Three frames of a hand-made flight with corrected errata that misfits: all is stated."""
    fixed = ABOUT._replace(fixes="restart", doubt="it misfits")
    return history(estimate(np.tile([140.0, -60.0, 20.0], (3, 1)), about=fixed))


EVERY = {
    "program", "flight", "doubtful", "fixes", "from frame", "vertical", "to frame", "sequence",
    "quaternion", "camera angles", "ranges", "angles of attack", "position", "time", "sigmas",
    "intervals", "covariance", "common errors", "reading sigma",
}  # fmt: skip
MESSAGE = {
    "program", "flight", "doubtful", "fixes", "REF_FRAME_A, NED", "REF_FRAME_B, SC_BODY_1",
    "vertical", "quaternion", "position", "time",
}  # fmt: skip
STATED = {
    "csv": EVERY,
    "jsonl": EVERY,
    "kml": EVERY | {"gx:angles"},
    "czml": {
        "flight", "program", "doubtful", "fixes", "from frame", "vertical", "to frame",
        "orientation", "position", "time",
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


def test_sources_that_their_residuals_contradict_are_named() -> None:
    jobs = [about(one(), source=f"{k}.toml", doubt="it misfits" * (k != 1)) for k in range(11)]
    assert statements(jobs[:2], REQUEST)["doubtful"] == "0.toml: it misfits"
    assert statements(jobs, REQUEST)["doubtful"].endswith("; 8.toml: it misfits; 2 more")
    assert "doubtful" not in statements(jobs[1:2], REQUEST)
    for form in ("odm", "colmap", "opk"):
        text = FORMATS[form].render(jobs[:1], REQUEST, lambda _: None).decode()
        assert "\n# doubtful: it misfits\n" in text
    for told in (summary.text, summary.html):
        assert told(map(one_part, jobs[:1])).count("it misfits") == 1
    assert "it misfits" not in summary.text(map(one_part, jobs[:1]), printed=1)
    assert summary.means_text(jobs[:1]).count("it misfits") == 1


def test_a_viewer_s_own_meaning_of_the_altitude_is_stated() -> None:
    taken = "degrees and metres; a viewer takes altitude as above "
    assert stated("czml")["position"].endswith(f"cartographicDegrees, {taken}the ellipsoid")
    assert stated("kml")["position"].endswith(f"; {taken}sea level")
    for form in ("csv", "aem"):
        assert "a viewer" not in stated(form)["position"]


def test_what_is_said_of_time_zero_where_there_are_several() -> None:
    dated = about(one(), epoch=EPOCH)
    assert own_epoch([dated, dated]) == EPOCH and own_epoch([dated, one()]) is None
    none = FileRequest(created=EPOCH)
    assert_approved(statements([one(), one()], none)["time"])
    assert_approved(statements([dated, one()], none)["time"])
    assert_approved(
        statements([dated, one()], REQUEST)["time"], parts=["2026-05-01T09:00:00.000000Z"]
    )
    told = estimate([[0.0, 0.0, 0.0]]).about.words
    clock = replace(told, conventions={"time": "seconds; zero is noon"})
    own = about(one(), words=clock)
    assert statements([own], none)["time"] == "seconds; zero is noon"


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
    _, level = said  # the first says that two names stand twice
    assert level.severity == "warning" and level.deck == "hand.toml"
    assert_approved(level.message, parts=["3 frames"])


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


# Every case of each

NINE = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)


def about_texts(**changes: object) -> History:
    one = level_flight()
    return replace(one, estimate=replace(one.estimate, about=one.about._replace(**changes)))


def test_what_is_asked_for_unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    one = FileRequest()
    assert (one.epoch, one.aem_version, one.originator) == (None, 2, "VOPD")
    assert (one.object_name, one.object_id) == ("", "")
    assert one.created == datetime(1970, 1, 1, tzinfo=UTC)


def test_the_date_is_utc_and_has_whole_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the zone of the machine is."""
    monkeypatch.setenv("TZ", "XXX-5")
    time.tzset()
    try:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
        given = created_now()
        assert given.replace(tzinfo=None) == datetime(2001, 9, 9, 1, 46, 40)
        assert given.utcoffset() == timedelta(0)
        assert utc_moment("2026-05-01T09:00") == NINE
        for empty in ("", None):
            if empty is None:
                monkeypatch.delenv("SOURCE_DATE_EPOCH")
            else:
                monkeypatch.setenv("SOURCE_DATE_EPOCH", empty)
            now = created_now()
            assert now.microsecond == 0 and now.utcoffset() == timedelta(0)
            assert abs(now - datetime.now(UTC)) < timedelta(minutes=1)
    finally:
        monkeypatch.delenv("TZ")
        time.tzset()


@pytest.mark.parametrize("text", ["1.5", "1e9", "x", "9" * 12, "9" * 25, "-" + "9" * 18])
def test_a_date_that_is_no_number_of_seconds(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", text)
    with refused(VopdError):
        created_now()


@pytest.mark.parametrize(
    ("epochs", "own"),
    [
        ([None], None), ([NINE], NINE), ([NINE, NINE], NINE), ([NINE, None], None),
        ([None, NINE], None), ([NINE, NINE + timedelta(seconds=1)], None),
    ],
)  # fmt: skip
def test_the_epoch_of_several_sources(epochs: list[datetime | None], own: datetime | None) -> None:
    assert own_epoch([about_texts(epoch=one) for one in epochs]) == own


@pytest.mark.parametrize(
    ("text", "moment"),
    [
        ("2026-05-01T09:00:00Z", NINE), ("2026-05-01 09", NINE),
        ("2026-05-01T11:00:00+02:00", NINE),
        ("2026-05-01", NINE - timedelta(hours=9)), ("2026-05-01T04:30-04:30", NINE),
        ("2026-05-01T09:00:00.000001", NINE + timedelta(microseconds=1)),
    ],
)  # fmt: skip
def test_an_epoch_is_utc_unless_it_names_a_zone(text: str, moment: datetime) -> None:
    found = utc_moment(text)
    assert found == moment and found.utcoffset() == timedelta(0)


@pytest.mark.parametrize("text", ["", "now", "2026-13-01", "9999-12-31T23:59-01:00", "27.8.1974"])
def test_what_is_no_epoch(text: str) -> None:
    with refused(VopdError):
        utc_moment(text)


def test_moments_have_microseconds_and_no_zone() -> None:
    assert utc(NINE, 0) == "2026-05-01T09:00:00.000000"
    assert utc(NINE, 1) == "2026-05-01T09:00:00.000001"
    assert utc(NINE, -1_500_000) == "2026-05-01T08:59:58.500000"
    west = datetime(2026, 5, 1, 4, 30, tzinfo=timezone(timedelta(hours=-4.5)))
    assert utc(west, 3_600_000_000) == "2026-05-01T10:00:00.000000"
    first = datetime(1, 1, 1, tzinfo=UTC)
    assert has_date(first, 0) and not has_date(first, -1)
    assert utc(first, 0) == "0001-01-01T00:00:00.000000"


def test_statements_of_the_format_take_the_place_of_those_of_the_table() -> None:
    plain = statements([level_flight()], FileRequest())
    own = statements([level_flight()], FileRequest(), quaternion="a\nb", more="x")
    assert own == plain | {"quaternion": "a\\nb", "more": "x"}
    assert [*own][: len(plain)] == [*plain] and plain["quaternion"] != own["quaternion"]
    dated = statements([level_flight()], FileRequest(epoch=NINE))
    assert dated["time"] == f"{plain['time']}; zero is 2026-05-01T09:00:00.000000Z"
    assert {key for key in plain if plain[key] != dated[key]} == {"time"}


def test_statements_in_html_are_escaped() -> None:
    assert html({"a<": "b & c", "d": '"'}) == (
        "<table><tr><th>a&lt;</th><td>b &amp; c</td></tr><tr><th>d</th><td>&quot;</td></tr></table>"
    )
    assert html({}) == "<table></table>"


@pytest.mark.parametrize(
    ("given", "own", "shown", "called"),
    [
        ("", "the job", "the job", "the job"), ("kite", "the job", "the job", "kite"),
        (" kite\t", "the job", "the job", "kite"), ("  ", "the job", "the job", "the job"),
        ("", "", "hand.toml, job 1", "hand.toml, job 1"), ("a\nb", "c\x7fd", "c\\x7fd", "a\\nb"),
        ("Zürich", "東", "東", "Zürich"),
    ],
)  # fmt: skip
def test_names_and_titles(given: str, own: str, shown: str, called: str) -> None:
    job = about_texts(title=own)
    assert title(job) == shown
    assert name(FileRequest(object_name=given), job) == called


@pytest.mark.parametrize(
    ("text", "safe"),
    [
        ("", ""), ("a b", "a b"), ("a\nb", "a\\nb"), ("\t", "\\t"), ("\udcff", "\\udcff"),
        ("ü\r", "ü\\r"), ("\u2028", "\\u2028"), ("\\n", "\\n"),
    ],
)  # fmt: skip
def test_what_does_not_print_is_escaped(text: str, safe: str) -> None:
    assert printable(text) == safe
    assert file_request.printable(safe) == safe
