"""CCSDS Attitude Ephemeris Message, KVN: version 2 (504.0-B-2) or version 1 (504.0-B-1).

The quaternion "from frame A to frame B" carries the axes of A into those of B
(504.0-B-2, annex F2), as `vopd.attitude.quaternion` has it, with the scalar
last. Keywords stand in the order of tables 4-2 and 4-3 of either issue.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.export.file_request import FileRequest, statements, title, utc
from vopd.export.timed_attitude import TimedAttitude, continuous, timed_attitudes
from vopd.findings import Finding, Report, VopdError

FRAME_A, FRAME_B = "NED", "SC_BODY_1"  # the registries have no name for north, east, down
QUATERNION = (
    "NED to SC_BODY_1, Hamilton, columns Q1 Q2 Q3 QC, scalar last; components in NED are "
    "q v q* of those in SC_BODY_1; neighbours have signs that make them near, QC may be negative"
)
FRAMES = {"from frame": f"REF_FRAME_A, {FRAME_A}", "to frame": f"REF_FRAME_B, {FRAME_B}"}
"""What the comments call the conventions of the two frames."""

WIDTH = 120  # a line may have 254 characters
DECIMALS = 10


def text_value(text: str) -> str:
    """Convert a text for an AEM, where values may not mix capitals and small letters (6.8.6).

    An empty text becomes UNKNOWN.

    Raises:
        VopdError: unless it is printable ASCII of 200 characters at most
    """
    value = " ".join(text.split()) or "UNKNOWN"
    if not (value.isascii() and value.isprintable() and len(value) <= 200):
        raise VopdError(f"{text!r}: a text in an AEM has at most 200 ASCII characters")
    return value if value.islower() else value.upper()


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the message: one segment for each job, in the order of their first times.

    Args:
        histories: the jobs
        request: epoch, names, version
        report: is given warnings: frames that are left out, and jobs that overlap in
            time, of which a reader cannot tell which one holds
    """
    if request.aem_version not in (1, 2):
        raise VopdError(f"AEM version {request.aem_version}: the versions are 1 and 2")
    segments = sorted(
        timed_attitudes(histories, request.epoch, report), key=lambda one: one.microseconds[0]
    )
    latest = segments[0]
    for one in segments[1:]:
        first = one.microseconds[0]
        if first < latest.microseconds[-1] or first == latest.microseconds[0]:
            report(_overlap(latest, one))
        latest = max(latest, one, key=lambda two: two.microseconds[-1])
    stated = statements(histories, request, quaternion=QUATERNION)
    source = histories[0].about.words.source
    keys = ("program", source, "fixes", *FRAMES, "quaternion", "position", "time")
    comments = {FRAMES.get(key, key): stated[key] for key in keys if key in stated}
    return aem_message(comments, [_segment(segment, request) for segment in segments], request)


class AemSegment(NamedTuple):
    """One segment of a message.

    Attributes:
        comment: what it is of
        frame_a: name of the frame from which
        frame_b: name of the frame to which
        epochs: times in UTC, increasing
        quaternion: of frame A to frame B, w x y z, (T, 4)
    """

    comment: str
    frame_a: str
    frame_b: str
    epochs: list[str]
    quaternion: Floats


def aem_message(
    comments: dict[str, str], segments: Sequence[AemSegment], request: FileRequest
) -> bytes:
    """Make a message of any segments.

    Args:
        comments: what the header states: short names and a sentence each
        segments: in the order of their first times
        request: names and version
    """
    lines = [*_header(comments, request)]
    for segment in segments:
        lines += ["", *_segment_lines(segment, request)]
    return ("\n".join(lines) + "\n").encode("ascii", "backslashreplace")


def _header(comments: dict[str, str], request: FileRequest) -> Iterator[str]:
    yield f"CCSDS_AEM_VERS = {request.aem_version}.0"
    for key, sentence in comments.items():
        yield from _comment(f"{key}: {sentence}")
    yield f"CREATION_DATE = {utc(request.created, 0)[:19]}"
    yield f"ORIGINATOR = {text_value(request.originator)}"


def _segment(segment: TimedAttitude, request: FileRequest) -> AemSegment:
    assert request.epoch is not None
    history = segment.history
    return AemSegment(
        f"{history.about.words.source} {history.about.label}: {title(history)}",
        FRAME_A,
        FRAME_B,
        [utc(request.epoch, moment) for moment in segment.microseconds],
        segment.quaternion,
    )


def _segment_lines(segment: AemSegment, request: FileRequest) -> Iterator[str]:
    yield "META_START"
    yield from _comment(segment.comment)
    yield f"OBJECT_NAME = {text_value(request.object_name)}"
    yield f"OBJECT_ID = {text_value(request.object_id)}"
    yield "CENTER_NAME = EARTH"
    yield f"REF_FRAME_A = {segment.frame_a}"
    yield f"REF_FRAME_B = {segment.frame_b}"
    if request.aem_version == 1:
        yield "ATTITUDE_DIR = A2B"
    yield "TIME_SYSTEM = UTC"
    yield f"START_TIME = {segment.epochs[0]}"
    yield f"STOP_TIME = {segment.epochs[-1]}"
    yield "ATTITUDE_TYPE = QUATERNION"
    if request.aem_version == 1:
        yield "QUATERNION_TYPE = LAST"
    yield "META_STOP"
    yield ""
    yield "DATA_START"
    for epoch, row in zip(segment.epochs, _scalar_last(segment), strict=True):
        yield epoch + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "DATA_STOP"


def _scalar_last(segment: AemSegment) -> Floats:
    """(T, 4) x y z w to the decimals written, without the -0 that the standard rules out."""
    q = np.roll(continuous(segment.quaternion), -1, axis=1)
    return np.asarray(np.round(q, DECIMALS) + 0.0)


def _comment(text: str) -> list[str]:
    ascii_text = text.encode("ascii", "backslashreplace").decode()
    return [f"COMMENT {line}" for line in textwrap.wrap(ascii_text, WIDTH - 8)]


def _overlap(one: TimedAttitude, other: TimedAttitude) -> Finding:
    return Finding(
        f"overlaps {one.history.about.label} in time: readers cannot tell which one applies",
        deck=other.history.about.source,
        job=other.history.about.job,
        severity="warning",
    )
