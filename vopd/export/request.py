"""What a file is to say besides the table: the epoch, names, and when it was made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from html import escape

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.findings import VopdError


def created_now() -> datetime:
    """This second, UTC, or the one of the environment's SOURCE_DATE_EPOCH.

    Raises `VopdError` where that is no number of seconds since 1970.
    """
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        return datetime.now(UTC).replace(microsecond=0)
    try:
        return datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise VopdError(f"SOURCE_DATE_EPOCH: {given!r} is no number of seconds") from error


@dataclass(frozen=True)
class Request:
    """What the user asks of a file. An empty name is not known.

    `epoch` is time zero of flight, with its time zone; None where the file
    need not know. Only an AEM has a version, an originator and an object's id.
    """

    epoch: datetime | None = None
    aem_version: int = 2
    originator: str = "VOPD"
    object_name: str = ""
    object_id: str = ""
    created: datetime = field(default_factory=created_now)


def parse_epoch(text: str) -> datetime:
    """An ISO 8601 date and time, UTC where it names no zone. Raises `VopdError`."""
    try:
        moment = datetime.fromisoformat(text)
        if moment.tzinfo is None:
            moment = moment.replace(tzinfo=UTC)
        return moment.astimezone(UTC)
    except (ValueError, OverflowError) as error:
        example = "1974-08-27T17:30:00Z"
        raise VopdError(f"{text!r} is no ISO 8601 date and time, as {example}") from error


def utc(epoch: datetime, microseconds: int) -> str:
    """Date and time that long after the epoch, to the microsecond, without Z.

    Leap seconds are not counted. Raises `VopdError` outside the years 1 to 9999.
    """
    try:
        moment = (epoch + timedelta(microseconds=microseconds)).astimezone(UTC)
    except OverflowError as error:
        seconds = microseconds / 1e6
        raise VopdError(
            f"a frame's time, {seconds:g} s after the epoch, is outside the years 1 to 9999"
        ) from error
    return moment.replace(tzinfo=None).isoformat(timespec="microseconds")


def statements(histories: Sequence[History], request: Request, **own: str) -> dict[str, str]:
    """The conventions with the epoch, and a format's `own` in place of the table's."""
    said = conventions(histories)
    if request.epoch is not None:
        said["time"] += f"; zero is {utc(request.epoch, 0)}Z"
    return {key: printable(text) for key, text in (said | own).items()}


def html(said: dict[str, str]) -> str:
    """Statements as a table, for the viewers that show a description as HTML."""
    rows = (f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in said.items())
    return f"<table>{''.join(rows)}</table>"


def title(history: History) -> str:
    """The job's title, or source and job."""
    return printable(history.about.title) or history.about.label


def name(request: Request, history: History) -> str:
    """What to call the vehicle where people look: its name if there is one, or the job's title."""
    return printable(request.object_name.strip()) or title(history)


def printable(text: str) -> str:
    """The text with escapes for what does not print: line ends, and bytes that are no UTF-8."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
