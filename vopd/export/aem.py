"""CCSDS Attitude Ephemeris Message, KVN: version 2 (504.0-B-2) or version 1 (504.0-B-1).

Keywords stand in the order of tables 4-2 and 4-3 of either issue.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.export.ccsds import (
    DECIMALS,
    FRAME_A,
    FRAME_B,
    comment,
    encoded,
    header,
    job_text,
    quaternions_scalar_last,
    segments_in_order,
    stated_comments,
    text_value,
)
from vopd.export.file_request import FileRequest, utc
from vopd.export.times import TimedAttitude
from vopd.findings import Report, VopdError


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
    segments = segments_in_order(histories, request, report)
    comments = stated_comments(histories, request)
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
    lines = [*header("CCSDS_AEM_VERS", request.aem_version, comments, request)]
    for segment in segments:
        lines += ["", *_segment_lines(segment, request)]
    return encoded(lines)


def _segment(segment: TimedAttitude, request: FileRequest) -> AemSegment:
    assert request.epoch is not None
    return AemSegment(
        job_text(segment.history),
        FRAME_A,
        FRAME_B,
        [utc(request.epoch, moment) for moment in segment.microseconds],
        segment.quaternion,
    )


def _segment_lines(segment: AemSegment, request: FileRequest) -> Iterator[str]:
    yield "META_START"
    yield from comment(segment.comment)
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
    for epoch, row in zip(segment.epochs, quaternions_scalar_last(segment.quaternion), strict=True):
        yield epoch + "".join(f" {q:.{DECIMALS}f}" for q in row)
    yield "DATA_STOP"
