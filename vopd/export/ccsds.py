"""What the two CCSDS attitude messages of 504.0-B share: AEM and ACM, in KVN.

The quaternion "from frame A to frame B" carries the axes of A into those of B
(504.0-B-2, annex F2), as `vopd.geometry.rotations` has it, with the scalar last.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.export.file_request import FileRequest, statements, title, utc
from vopd.export.times import TimedAttitude, continuous, timed_attitudes
from vopd.findings import Finding, Report, VopdError

FRAME_A, FRAME_B = "NED", "SC_BODY_1"  # the registries have no name for north, east, down
QUATERNION = (
    "columns Q1 Q2 Q3 QC, scalar last; it is the rotation that carries the axes of NED into those "
    "of SC_BODY_1; rotating a vector's components in SC_BODY_1 by it gives its components in NED; "
    "neighbours have signs that make them near, QC may be negative"
)
FRAMES = {"from frame": f"REF_FRAME_A, {FRAME_A}", "to frame": f"REF_FRAME_B, {FRAME_B}"}
"""What the comments call the conventions of the two frames."""

WIDTH = 120  # a line of an AEM may have 254 characters
DECIMALS = 10


def text_value(text: str) -> str:
    """Convert a text for a message, where values may not mix capitals and small letters (6.8.6).

    An empty text becomes UNKNOWN.

    Raises:
        VopdError: unless it is printable ASCII of 200 characters at most
    """
    value = " ".join(text.split()) or "UNKNOWN"
    if not (value.isascii() and value.isprintable() and len(value) <= 200):
        raise VopdError(f"{text!r}: a text in a CCSDS message has at most 200 ASCII characters")
    return value if value.islower() else value.upper()


def segments_in_order(
    histories: Sequence[History], request: FileRequest, report: Report
) -> list[TimedAttitude]:
    """The attitudes of each job, in the order of their first times.

    Args:
        histories: the jobs
        request: has the epoch
        report: is given warnings: frames that are left out, and jobs that overlap in
            time, of which a reader cannot tell which one holds
    """
    segments = sorted(
        timed_attitudes(histories, request.epoch, report), key=lambda one: one.microseconds[0]
    )
    latest = segments[0]
    for one in segments[1:]:
        first = one.microseconds[0]
        if first < latest.microseconds[-1] or first == latest.microseconds[0]:
            report(_overlap(latest, one))
        latest = max(latest, one, key=lambda two: two.microseconds[-1])
    return segments


def _overlap(one: TimedAttitude, other: TimedAttitude) -> Finding:
    return Finding(
        f"overlaps {one.history.about.label} in time: readers cannot tell which one applies",
        deck=other.history.about.source,
        job=other.history.about.job,
        severity="warning",
    )


def stated_comments(
    histories: Sequence[History], request: FileRequest, *more: str
) -> dict[str, str]:
    """What the header of a message states: short names and a sentence each.

    Args:
        histories: the jobs
        request: has the epoch
        more: names of conventions that this message states besides those of every message
    """
    stated = statements(histories, request, quaternion=QUATERNION)
    source = histories[0].about.words.source
    names = ("program", source, "fixes", *FRAMES, "vertical", "quaternion", "position", "time")
    return {FRAMES.get(key, key): stated[key] for key in (*names, *more) if key in stated}


def header(
    keyword: str, version: int, comments: dict[str, str], request: FileRequest
) -> Iterator[str]:
    """The lines of the header: the version, what the file states, its date and originator.

    Args:
        keyword: that of the version
        version: of the message
        comments: short names and a sentence each
        request: date and originator
    """
    yield f"{keyword} = {version}.0"
    for key, sentence in comments.items():
        yield from comment(f"{key}: {sentence}")
    yield f"CREATION_DATE = {utc(request.created, 0)[:19]}"
    yield f"ORIGINATOR = {text_value(request.originator)}"


def job_text(history: History) -> str:
    """What names a job in a comment: source, number and title."""
    return f"{history.about.words.source} {history.about.label}: {title(history)}"


def quaternions_scalar_last(quaternion: Floats) -> Floats:
    """(T, 4) x y z w to the decimals written, without the -0 that the standard rules out.

    Args:
        quaternion: w x y z, (T, 4)
    """
    q = np.roll(continuous(quaternion), -1, axis=1)
    return np.asarray(np.round(q, DECIMALS) + 0.0)


def comment(text: str) -> list[str]:
    """Comment lines with this text in ASCII."""
    ascii_text = text.encode("ascii", "backslashreplace").decode()
    return [f"COMMENT {line}" for line in textwrap.wrap(ascii_text, WIDTH - 8)]


def encoded(lines: Sequence[str]) -> bytes:
    """The file of these lines."""
    return ("\n".join(lines) + "\n").encode("ascii", "backslashreplace")
