"""What the user specifies for a file besides the table, such as epoch and names."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from html import escape
from typing import NamedTuple

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.findings import Report, VopdError, strict

ZERO = "; zero is "
"""What a statement of the time says before the epoch."""


def created_now() -> datetime:
    """The current time in UTC, to the second; or SOURCE_DATE_EPOCH if the environment sets it.

    Raises:
        VopdError: where that is not a number of seconds since 1970
    """
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        return datetime.now(UTC).replace(microsecond=0)
    try:
        return datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise VopdError(
            f"SOURCE_DATE_EPOCH: {given!r} is not a number of seconds since 1970"
        ) from error


@dataclass(frozen=True)
class FileRequest:
    """What the user specifies for a file.

    Args:
        epoch: the moment of time zero, with its time zone; None if unknown
        aem_version: of CCSDS 504.0-B, 1 or 2
        originator: who made an AEM or ACM
        object_name: what the vehicle is called; empty if unknown
        object_id: its international designator, in an AEM or ACM; empty if unknown
        created: the date that an AEM or ACM bears
    """

    epoch: datetime | None = None
    aem_version: int = 2
    originator: str = "VOPD"
    object_name: str = ""
    object_id: str = ""
    created: datetime = field(default_factory=created_now)


class TableFile(NamedTuple):
    """A file that is to be made: its jobs, and what the user specifies for it."""

    histories: Sequence[History]
    request: FileRequest
    report: Report = strict


def own_epoch(histories: Sequence[History]) -> datetime | None:
    """The epoch that all sources state; None if one states none or another."""
    stated = {h.about.epoch for h in histories}
    return stated.pop() if len(stated) == 1 else None


def parse_epoch(text: str) -> datetime:
    """Read a date and time in ISO 8601; it is UTC if it names no time zone.

    Raises:
        VopdError: where the text is not a date and time
    """
    try:
        moment = datetime.fromisoformat(text)
        if moment.tzinfo is None:
            moment = moment.replace(tzinfo=UTC)
        return moment.astimezone(UTC)
    except (ValueError, OverflowError) as error:
        example = "1974-08-27T17:30:00Z"
        raise VopdError(
            f"{text!r} is not an ISO 8601 date and time, for instance {example}"
        ) from error


def utc(epoch: datetime, microseconds: int) -> str:
    """Date and time in ISO 8601, without Z, some microseconds after the epoch.

    Leap seconds are not counted.
    """
    moment = (epoch + timedelta(microseconds=microseconds)).astimezone(UTC)
    return moment.replace(tzinfo=None).isoformat(timespec="microseconds")


def has_date(epoch: datetime, microseconds: int) -> bool:
    """Whether `utc` can write this moment: it lies in the years 1 to 9999."""
    try:
        utc(epoch, microseconds)
    except OverflowError:
        return False
    return True


def statements(histories: Sequence[History], request: FileRequest, **own: str) -> dict[str, str]:
    """The conventions, with the epoch added.

    Args:
        histories: the jobs of the file
        request: has the epoch
        own: statements of the format, in place of those of the table
    """
    stated = conventions(histories)
    time, _, zero = stated["time"].partition(ZERO)
    if request.epoch is not None:
        zero = f"{utc(request.epoch, 0)}Z"
    elif len({h.about.epoch for h in histories}) > 1:
        zero = "each source's own epoch"
    stated["time"] = f"{time}{ZERO}{zero}" if zero else time
    return {key: printable(text) for key, text in (stated | own).items()}


def html(stated: dict[str, str]) -> str:
    """Statements as an HTML table, for viewers that show a description as HTML."""
    rows = (f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in stated.items())
    return f"<table>{''.join(rows)}</table>"


def title(history: History) -> str:
    """The job's title, or its source and number where it has none."""
    return printable(history.about.title) or history.about.label


def name(request: FileRequest, history: History) -> str:
    """The name of the vehicle for a viewer: as given by the user, else the title of the job."""
    return printable(request.object_name.strip()) or title(history)


def printable(text: str) -> str:
    """The text with escapes for what is not printable: line ends, bytes that are not UTF-8."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
