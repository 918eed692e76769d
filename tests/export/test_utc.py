"""Times in files are UTC, whatever the time zone of the machine."""

from __future__ import annotations

import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta

import pytest

from tests.kit.attitude_files import EPOCH, deck_text
from tests.kit.command import vopd
from vopd.export import created_now, utc
from vopd.inputs import utc_moment

pytestmark = pytest.mark.skipif(not hasattr(time, "tzset"), reason="no time zone by environment")


@pytest.fixture(params=["America/New_York", "Asia/Kolkata"])
def elsewhere(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A machine whose clock shows local time."""
    with monkeypatch.context() as patch:
        patch.setenv(
            "TZ", {"America/New_York": "EST5EDT", "Asia/Kolkata": "IST-5:30"}[request.param]
        )
        time.tzset()
        yield
    time.tzset()


@pytest.mark.usefixtures("elsewhere")
def test_a_time_without_a_zone_is_utc() -> None:
    assert utc_moment("1974-08-27T17:30:00") == datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
    assert utc(utc_moment("1974-08-27T17:30:00"), 1_500_000) == "1974-08-27T17:30:01.500000"
    assert utc(utc_moment("1974-08-27T17:30:00+02:00"), 0) == "1974-08-27T15:30:00.000000"


@pytest.mark.usefixtures("elsewhere")
def test_the_date_of_a_file_is_utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    now = created_now()
    assert now.utcoffset() == timedelta(0) and abs(now - datetime.now(UTC)) < timedelta(minutes=5)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert created_now().isoformat() == "1970-01-02T00:00:00+00:00"


DATES = {
    "aem": "START_TIME = 1974-08-27T17:29:59.303000",
    "acm": "EPOCH_TZERO = 1974-08-27T17:30:00.000000",
    "czml": '"epoch": "1974-08-27T17:30:00.000000Z"',
    "kml": "<when>1974-08-27T17:29:59.303000Z</when>",
}


@pytest.mark.usefixtures("elsewhere")
@pytest.mark.parametrize("form", DATES)
def test_files_with_dates(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The epoch and the frames' dates: case 4's first is ignored, the next at -.697 s."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    options = ("--format", form, "--epoch", EPOCH.removesuffix("Z"))
    text = vopd("attitude", "-", *options, stdin=deck_text("case4")).stdout
    assert DATES[form] in text
    assert ("1970-01-02T00:00:00" in text) == (form in ("aem", "acm"))
