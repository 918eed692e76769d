"""Attitudes with dates that come from no attitude history, such as those of star photographs."""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.export.aem import AemSegment, aem_message
from vopd.export.file_request import FileRequest, utc
from vopd.export.times import continuous
from vopd.findings import Finding, Report, VopdError

MICROSECOND = timedelta(microseconds=1)


class DatedAttitudes(NamedTuple):
    """T attitudes.

    Attributes:
        title: what they are of
        moments: their times, with time zone
        quaternion: of frame A to frame B, w x y z, (T, 4), as in `vopd.geometry.rotations`
        frame_a: its name in an AEM, such as ICRF
        frame_b: its name in an AEM, such as SC_BODY_1
        stated: what a file states about them: short names and a sentence each
        place: longitude and latitude in degrees, height in metres; None: unknown
        earth_fixed: quaternion of Earth-fixed axes to the body, w x y z, (T, 4); None: unknown
    """

    title: str
    moments: tuple[datetime, ...]
    quaternion: Floats
    frame_a: str
    frame_b: str
    stated: dict[str, str]
    place: tuple[float, float, float] | None = None
    earth_fixed: Floats | None = None


def in_order(attitudes: DatedAttitudes, report: Report) -> DatedAttitudes:
    """The attitudes in order of time, each time once; the first of several is kept.

    Args:
        attitudes: in any order
        report: is given a warning for each that is left out

    Raises:
        VopdError: there is none
    """
    kept: dict[datetime, int] = {}
    for k, moment in enumerate(attitudes.moments):
        if moment in kept:
            text = f"attitude {k + 1} is left out: it has the time of {kept[moment] + 1}"
            report(Finding(text, deck=attitudes.title, severity="warning"))
        else:
            kept[moment] = k
    if not kept:
        raise VopdError("there is no attitude with a date")
    order = [kept[moment] for moment in sorted(kept)]
    fixed = attitudes.earth_fixed
    return attitudes._replace(
        moments=tuple(sorted(kept)),
        quaternion=attitudes.quaternion[order],
        earth_fixed=None if fixed is None else fixed[order],
    )


def dated_aem(attitudes: DatedAttitudes, request: FileRequest, report: Report) -> bytes:
    """Make an AEM of one segment; arguments as `in_order`, and `request` for the names."""
    ordered = in_order(attitudes, report)
    stamps = [utc(moment, 0) for moment in ordered.moments]
    segment = AemSegment(
        ordered.title, ordered.frame_a, ordered.frame_b, stamps, ordered.quaternion
    )
    return aem_message(ordered.stated, [segment], request)


def seconds_after(moments: tuple[datetime, ...]) -> list[float]:
    """Seconds after the first of some moments."""
    return [(moment - moments[0]) / MICROSECOND / 1e6 for moment in moments]


def scalar_last(quaternion: Floats) -> Floats:
    """Quaternions x y z w with signs that make neighbours near, (T, 4)."""
    return np.asarray(np.roll(continuous(quaternion), -1, axis=1))
