"""The pages of frames, of one job or of several whose pages are printed together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.listing.line_formats import LINES
from vopd.listing.one_number import exponential, line_without_numbers
from vopd.listing.page_template import Bytes, page_template
from vopd.results import Outcome, Results, Stage

_CONTENTS: dict[str, tuple[str, ...]] = {
    "landmark heading": (),
    "landmark ignored": ("landmark",),
    "landmark": (
        "landmark", "longitude_deg", "geocentric_latitude_deg", "radius_kft", "latitude_deg",
        "altitude_ft", "direction",
    ),
    "vehicle heading": (),
    "vehicle": ("vehicle_ft", "centre_in", "focal_length_mm"),
    "reading heading": (),
    "reading": ("landmark", "point_in"),
    "film heading": (),
    "film": ("landmark", "point_mm", "radius_mm", "distortion_mm"),
    "attitude heading": (),
    "attitude": (
        "frame", "time_s", "camera_deg", "centre_mm", "vehicle_deg", "alpha_deg", "beta_deg",
        "eta_deg",
    ),
    "residual heading": (),
    "residual": ("residual_mm", "landmark"),
    "standard deviation": ("residual_deviation_mm",),
}  # fmt: skip
"""The lines of a page in order, and the fields of `Results` that stand in each."""

_OF_USED = ("landmark", "reading", "film", "residual")  # a line for each landmark that takes part
_OF_IGNORED = ("landmark ignored",)

_LAST_LINE = {
    Outcome.SOLVED: "standard deviation",
    Outcome.EXACT: "reading",
    Outcome.EXACT_LATE: "residual",
    Stage.LENS: "reading",
    Stage.WIND: "film",
}
"""How far a page goes, by how its frame ended or where its run stopped."""


def head(results: Results) -> str:
    """The first line of a page, which is the title card; in a corrected run, a second line says so.

    Args:
        results: the job.
    """
    if not results.fixes:
        return results.job.title
    return f"{results.job.title}\n CORRECTED RUN, NOT THE ORIGINAL: {results.fixes}"


class PrintedFrames(NamedTuple):
    """Frames of one job, or of several of which none was stopped, and what their jobs print."""

    results: Results
    head: Bytes  # (F, characters)
    focal_length_mm: Floats  # (F,)

    def only(self, frames: Ints | slice) -> PrintedFrames:
        """Some of the frames."""
        own = self.head[frames], self.focal_length_mm[frames]
        return PrintedFrames(self.results.take(frames), *own)


def frames_of(jobs: Sequence[Results]) -> PrintedFrames:
    """The frames of jobs whose heads have one length."""
    text = b"".join([head(one).encode("ascii") + b"\n" for one in jobs])
    heads = np.frombuffer(text, np.uint8).reshape(len(jobs), -1)
    return PrintedFrames(
        Results.concat(jobs),
        np.repeat(heads, [len(one.frame) for one in jobs], axis=0),
        np.concatenate([one.focal_length_mm for one in jobs]),
    )


def pages_of_frames(frames: PrintedFrames) -> list[bytes]:
    """The page of each frame; those with the same lines are printed together."""
    some = frames.results
    look = some.outcome
    for count in (some.used_count, some.layout.counted(some.points.ignored)):
        look = look * (some.layout.widest + 1) + count
    order = np.argsort(look, kind="stable")
    begins = np.flatnonzero(np.diff(look[order], prepend=-1, append=-1)).tolist()
    by_kind = frames.only(order) if len(begins) > 2 else frames
    made: list[bytes] = []
    for first, last in pairwise(begins):
        made += _pages_alike(by_kind.only(slice(first, last)))
    in_order = [b""] * len(made)
    for index, page in zip(order.tolist(), made, strict=True):
        in_order[index] = page
    return in_order


def _pages_alike(frames: PrintedFrames) -> list[bytes]:
    """Pages of frames with the same outcome and the same numbers of landmarks."""
    results = frames.results
    numbers = results.frame
    outcome = Outcome(results.outcome[0])
    if outcome == Outcome.DROPPED:
        template = page_template(("frame ignored",))
        return template.fill(numbers[:, None].astype(float))
    end: Outcome | Stage = outcome
    if outcome == Outcome.STOPPED and results.stop is not None:
        end = results.stop.stage
        if end == Stage.TIME:
            return [b""] * len(numbers)
    names, values = _lines(frames, _LAST_LINE[end])
    made = page_template(names).fill(values, frames.head)
    if outcome in (Outcome.EXACT, Outcome.EXACT_LATE):
        made = [page + _vanished(results, k) for k, page in enumerate(made)]
    return made


def _lines(printed: PrintedFrames, last: str) -> tuple[tuple[str, ...], Floats]:
    """The lines of these pages in order, down to `last`, and their values, a row a page."""
    results = printed.results
    frames, points = len(results.frame), results.points
    of_jobs = {"focal_length_mm": printed.focal_length_mm}
    names: list[str] = []
    values: list[Floats] = []
    for name, fields in _CONTENTS.items():
        if name in (*_OF_USED, *_OF_IGNORED):
            mask = points.used if name in _OF_USED else points.ignored
            rows = slice(None) if mask.all() else np.flatnonzero(mask)
            columns = [getattr(points, field)[rows] for field in fields]
            lines = len(columns[0]) // frames
            names += [name] * lines
        else:
            columns = [of_jobs[n] if n in of_jobs else getattr(results, n) for n in fields]
            lines = 1
            names.append(name)
        if columns and lines:
            parts = [column.reshape(frames, lines, -1) for column in columns]
            values.append(np.concatenate(parts, axis=2, dtype=np.float64).reshape(frames, -1))
        if name == last:
            break
    return tuple(names), np.concatenate(values, axis=1)


def _vanished(results: Results, k: int) -> bytes:
    """The end of a page whose residuals are all exactly zero (FORMATs 102 and 103)."""
    line = LINES["zero residual"]
    text = ""
    span = results.layout.span(k)
    for pair in results.points.residual_mm[span][results.points.used[span]]:
        edited = (exponential(float(v), f) for v, f in zip(pair, line.fields, strict=True))
        text += "\n" * line.blank_lines + "".join(edited) + "\n"
    return (text + line_without_numbers(LINES["end of job"])).encode("ascii")
