"""Epochs, dates, names and statements of files: every case of each."""

from __future__ import annotations

import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone

import pytest

import vopd.export as file_request
from tests.kit.estimates import level_flight
from vopd.attitude.history import History
from vopd.export import (
    FileRequest,
    created_now,
    has_date,
    html,
    name,
    own_epoch,
    parse_epoch,
    printable,
    statements,
    title,
    utc,
)
from vopd.findings import VopdError

NINE = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)


def about(**changes: object) -> History:
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
        assert parse_epoch("2026-05-01T09:00") == NINE
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
    with pytest.raises(VopdError) as refused:
        created_now()
    said = f"SOURCE_DATE_EPOCH: {text!r} is not a number of seconds since 1970"
    assert str(refused.value) == said


@pytest.mark.parametrize(
    ("epochs", "own"),
    [
        ([None], None), ([NINE], NINE), ([NINE, NINE], NINE), ([NINE, None], None),
        ([None, NINE], None), ([NINE, NINE + timedelta(seconds=1)], None),
    ],
)  # fmt: skip
def test_the_epoch_of_several_sources(epochs: list[datetime | None], own: datetime | None) -> None:
    assert own_epoch([about(epoch=one) for one in epochs]) == own


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
    found = parse_epoch(text)
    assert found == moment and found.utcoffset() == timedelta(0)


@pytest.mark.parametrize("text", ["", "now", "2026-13-01", "9999-12-31T23:59-01:00", "27.8.1974"])
def test_what_is_no_epoch(text: str) -> None:
    with pytest.raises(VopdError) as refused:
        parse_epoch(text)
    said = f"{text!r} is not an ISO 8601 date and time, for instance 1974-08-27T17:30:00Z"
    assert str(refused.value) == said


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
    job = about(title=own)
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
