"""The pages that program VOPD printed (TM X-3050, Appendix G): text from results."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from functools import cache, lru_cache
from itertools import groupby, islice, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import refuse_other_kind
from vopd.listing.formats import LINES, Field, exponential, fixed, general, line_without_numbers
from vopd.records import alike_together
from vopd.results import Outcome, Results, Stage, Stop

CHUNK = 4000  # pages made at a time


def listing_text(results: Results | Sequence[Results]) -> str:
    """Return the printed pages of one job, or of all jobs of a run, as text.

    Column 1 is carriage control. The title is printed again at the end of each job;
    a corrected run has a second line under each title. Lines end in a newline. A run
    ends with `end_of_case()`, unless a table out of order stopped it.
    """
    if isinstance(results, Results):
        return b"".join(pages(results)).decode("ascii")
    for one in results if isinstance(results, Sequence) else [results]:
        refuse_other_kind(one, Results, "vopd.listing_text", "what vopd.run returns")
    text = "".join(listing_text(one) for one in results)
    stopped = len(results) > 0 and results[-1].stop is not None
    return text if stopped else text + end_of_case().decode("ascii")


def end_of_case() -> bytes:
    """Print the lines that end a run."""
    return line_without_numbers(LINES["end of case"]).encode("ascii")


def pages(results: Results) -> Iterator[bytes]:
    """Print one job, in pieces of about `CHUNK` pages, so that long runs need little memory."""
    yield from frame_pages(results)
    yield end_of_job(results)


def frame_pages(results: Results, first: int = 0, last: int | None = None) -> Iterator[bytes]:
    """Print consecutive frames, in pieces of about `CHUNK` pages.

    Args:
        results: the job.
        first: index of the first frame.
        last: index behind the last frame; to the end by default.
    """
    stop = len(results.outcome) if last is None else last
    for start in range(first, stop, CHUNK):
        some = results.take(slice(start, min(start + CHUNK, stop)))
        yield b"".join(pages_of_frames(frames_of([some])))


def pages_of_jobs(jobs: Sequence[Results]) -> list[Iterable[bytes]]:
    """Print several jobs, each in pieces; short jobs together take less time than alone."""
    made: dict[int, Iterable[bytes]] = {}
    kinds = ((_kind(one, k), len(one.frame)) for k, one in enumerate(jobs))
    for indices in alike_together(kinds, CHUNK):
        some = [jobs[k] for k in indices]
        if len(some) == 1:
            made[indices[0]] = pages(some[0])
            continue
        printed = iter(pages_of_frames(frames_of(some)))
        for k, one in zip(indices, some, strict=True):
            made[k] = [*islice(printed, len(one.frame)), end_of_job(one)]
    return [made[k] for k in range(len(jobs))]


def _kind(job: Results, index: int) -> Hashable:
    """Group jobs with heads of one length; a long one, and one that stops, is printed alone."""
    return -1 - index if job.stop is not None or len(job.frame) >= CHUNK else len(head(job))


def end_of_job(results: Results) -> bytes:
    """Print the lines after a job's pages: its title again, or the table that stopped the run."""
    last = head(results) + "\n" if results.stop is None else table_out_of_order(results.stop)
    return last.encode("ascii")


def table_out_of_order(stop: Stop) -> str:
    """Print the table that is out of order, as FTLUP does before it stops the run.

    Source: TM X-3050, Appendix D.
    """
    order, location = LINES["table out of order"], LINES["table location"]
    text = order.text.ljust(order.fields[0].first - 1)
    text += fixed(stop.position, order.fields[0]) + "\n" + line_without_numbers(location) + "\n"
    for table in (stop.vari, stop.vard):
        for first in range(0, len(table), 8):
            text += " " + "".join(general(v, 15, 8) for v in table[first : first + 8]) + "\n"
    return text


# The pages of frames

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
    """Print the title card, the first line of a page; in a corrected run, a second line says so."""
    if not results.fixes:
        return results.job.title
    return f"{results.job.title}\n CORRECTED RUN, NOT THE ORIGINAL: {results.fixes}"


class PrintedFrames(NamedTuple):
    """Frames of one job, or of several of which none was stopped, and what their jobs print."""

    results: Results
    head: Bytes  # (F, characters)
    focal_length_mm: Floats  # (F,)

    def take(self, frames: Ints | slice) -> PrintedFrames:
        """Select some of the frames."""
        return PrintedFrames(
            self.results.take(frames), self.head[frames], self.focal_length_mm[frames]
        )


def frames_of(jobs: Sequence[Results]) -> PrintedFrames:
    """Join the frames of jobs whose heads have one length."""
    text = b"".join([head(one).encode("ascii") + b"\n" for one in jobs])
    heads = np.frombuffer(text, np.uint8).reshape(len(jobs), -1)
    return PrintedFrames(
        Results.concat(jobs),
        np.repeat(heads, [len(one.frame) for one in jobs], axis=0),
        np.concatenate([one.focal_length_mm for one in jobs]),
    )


def pages_of_frames(frames: PrintedFrames) -> list[bytes]:
    """Print the page of each frame; those with the same lines together."""
    some = frames.results
    look = some.outcome
    for count in (some.used_count, some.layout.counted(some.points.ignored)):
        look = look * (some.layout.widest + 1) + count
    order = np.argsort(look, kind="stable")
    begins = np.flatnonzero(np.diff(look[order], prepend=-1, append=-1)).tolist()
    by_kind = frames.take(order) if len(begins) > 2 else frames
    made: list[bytes] = []
    for first, last in pairwise(begins):
        made += _pages_alike(by_kind.take(slice(first, last)))
    in_order = [b""] * len(made)
    for index, page in zip(order.tolist(), made, strict=True):
        in_order[index] = page
    return in_order


def _pages_alike(frames: PrintedFrames) -> list[bytes]:
    """Print frames with the same outcome and the same numbers of landmarks."""
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
    """List the lines of these pages in order, down to `last`, and their values, a row a page."""
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
    """Print the end of a page whose residuals are all exactly zero (FORMATs 102 and 103)."""
    line = LINES["zero residual"]
    text = ""
    span = results.layout.span(k)
    for pair in results.points.residual_mm[span][results.points.used[span]]:
        edited = (exponential(float(v), f) for v, f in zip(pair, line.fields, strict=True))
        text += "\n" * line.blank_lines + "".join(edited) + "\n"
    return (text + line_without_numbers(LINES["end of job"])).encode("ascii")


# A page as text into which the numbers of many pages are written
#
# Numbers below one have no zero before the point, as the 1974 printer left it; rounding is that
# of C's printf, which rounds the exact value of a number.

Bytes = NDArray[np.uint8]
FEW_PAGES = 2  # whose numbers are edited one by one, without a table of digits


class PageTemplate:
    """The text of the lines of a page, and where the numbers go in it.

    Args:
        names: the kinds of the lines in order, keys of `LINES`.
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        text: list[str] = []
        alike: dict[tuple[str, int, int], tuple[Field, list[tuple[Ints, Ints]]]] = {}
        length = fields = 0
        for name, several in groupby(names):
            line, count = LINES[name], len(list(several))
            one, row = line_without_numbers(line), np.arange(count)
            for k, field in enumerate(line.fields):
                kind = field.descriptor, field.width, field.decimals
                starts = length + line.blank_lines + field.first - 1 + row * len(one)
                _, parts = alike.setdefault(kind, (field, []))
                parts.append((fields + k + row * len(line.fields), starts))
            text.append(one * count)
            length += count * len(one)
            fields += count * len(line.fields)
        self.text = np.frombuffer("".join(text).encode("ascii"), np.uint8).copy()
        self._alike: list[tuple[Field, Ints, Ints]] = []  # field, indices in the page, starts
        for (descriptor, width, decimals), (field, parts) in alike.items():
            which, starts = (np.concatenate(part) for part in zip(*parts, strict=True))
            self._alike.append((field, which, starts))
            if descriptor == "F":
                self.text[starts + width - 1 - decimals] = ord(".")

    @np.errstate(all="ignore")  # infinities and NaN are edited one by one
    def fill(self, values: Floats, heads: Bytes | None = None) -> list[bytes]:
        """Write the numbers of many pages into the text, one page for each row of values.

        Args:
            values: the numbers of each page (pages, fields), in the order of the fields.
            heads: the text in front of each page's lines (pages, characters).
        """
        count, head = len(values), 0 if heads is None else heads.shape[1]
        size = head + len(self.text)
        pages = np.empty((count, size), np.uint8)
        if heads is not None:
            pages[:, :head] = heads
        pages[:, head:] = self.text
        for field, which, begins in self._alike:
            numbers = np.ascontiguousarray(values[:, which].T)
            starts = head + begins
            few = count <= FEW_PAGES
            alone = np.ndindex(numbers.shape) if few else _write(pages, starts, numbers, field)
            for k, row in alone:
                text = fixed(float(numbers[k, row]), field).encode("ascii")
                pages[row, starts[k] : starts[k] + field.width] = np.frombuffer(text, np.uint8)
        whole = pages.tobytes()
        return [whole[first : first + size] for first in range(0, count * size, size)]


@lru_cache(maxsize=64)
def page_template(names: tuple[str, ...]) -> PageTemplate:
    """Lay out the lines of a page; a template that was made before is used again."""
    return PageTemplate(names)


def _write(pages: Bytes, starts: Ints, values: Floats, field: Field) -> NDArray[np.intp]:
    """Write `values` (fields, pages) into fields that are edited alike and begin at `starts`.

    Returns:
        The indices (n, 2) of numbers that must be edited one by one: those that do not
        fit, are NaN, or lie so near a tie that their exact value decides.
    """
    fixed_point = field.descriptor == "F"
    decimals = field.decimals if fixed_point else 0
    columns = field.width - (decimals + 1 if fixed_point else 0)  # before the point
    negative = np.signbit(values)
    scaled = np.abs(values) * 10.0**decimals
    rounded = np.rint(scaled)
    odd = _odd(negative, scaled, rounded, columns, decimals)
    any_odd = odd.any()
    if any_odd:
        rounded[odd] = 0.0
    whole = rounded.astype(np.int64 if rounded.max(initial=0.0) >= 2**31 else np.int32)
    before = whole // 10**decimals
    _put(pages, starts, signed_groups(before, negative, columns, not fixed_point), columns)
    if decimals:
        behind = starts + columns + 1
        _put(pages, behind, padded_groups(whole - before * 10**decimals, decimals), decimals)
    return np.argwhere(odd) if any_odd else np.empty((0, 2), np.intp)


def _put(pages: Bytes, starts: Ints, groups: Sequence[Codes | None], columns: int) -> None:
    """Write groups of characters, one after the other, at each of the `starts`."""
    count, size = pages.shape
    for width, group in zip(widths(columns), groups, strict=True):
        if group is not None:
            for start, codes in zip(starts.tolist(), group, strict=True):
                np.ndarray((count,), code_type(width), pages, start, (size,))[:] = codes
        starts = starts + width


def _odd(negative: Bools, scaled: Floats, rounded: Floats, columns: int, decimals: int) -> Bools:
    """Find numbers that do not fit into the columns before the point, or lie near a tie."""
    room = np.where(negative, 10.0 ** (columns - 1 + decimals), 10.0 ** (columns + decimals))
    slack = scaled * 4e-16 + 1e-9  # of the product's last bit, generously
    near_tie = np.abs(scaled - rounded) > 0.5 - slack
    odd: Bools = ~((rounded < room) & (scaled < 2.0**53)) | near_tie
    return odd


# Digits of many numbers: up to four at a time are looked up in a table

GROUP = 4  # digits that are looked up together
_DTYPE = {1: "u1", 2: "<u2", 3: "V3", 4: "<u4"}  # a group of 1 to 4 characters as one element
_ZERO, _BLANK, _MINUS = (ord(char) for char in "0 -")

Codes = NDArray[np.generic]  # groups of characters, each one element of as many bytes
Whole = NDArray[np.integer]


def widths(digits: int) -> list[int]:
    """Split a number of digits into groups, and list their widths from left to right."""
    first = digits % GROUP
    return ([first] if first else []) + [GROUP] * (digits // GROUP)


def code_type(width: int) -> np.dtype[np.generic]:
    """Choose the numpy type that holds a group of characters as one element.

    Args:
        width: how many characters, 1 to 4.
    """
    return np.dtype(_DTYPE[width])


@cache
def _table(width: int, shows_zero: bool) -> Codes:
    """Tabulate the numbers below 10**width: without sign, then with a minus, then zero-padded.

    The first two are blank in front; a minus that has no room is left out. Zero is
    blank, as in front of a decimal point, unless it is to be shown.
    """
    numbers = np.arange(10**width)
    powers = 10 ** np.arange(width - 1, -1, -1)
    padded = (numbers[:, None] // powers % 10 + _ZERO).astype(np.uint8)
    begun = numbers[:, None] >= powers
    if shows_zero:
        begun[0, -1] = True
    plain = np.where(begun, padded, np.uint8(_BLANK))
    before_first = np.append(begun[:, 1:], np.ones((len(numbers), 1), bool), axis=1) & ~begun
    minus = np.where(before_first, np.uint8(_MINUS), plain)
    groups = np.ascontiguousarray(np.concatenate([plain, minus, padded]))
    return groups.view(code_type(width))[:, 0]


def padded_groups(numbers: Whole, digits: int) -> list[Codes]:
    """Write numbers with leading zeros, in groups from left to right.

    Args:
        numbers: whole numbers, 0 or more, (n,).
        digits: how many digits each has.
    """
    groups: list[Codes] = []
    for width in reversed(widths(digits)):
        upper = numbers // 10**width
        low = numbers - upper * 10**width
        groups.append(_table(width, False).take(low + 2 * 10**width))
        numbers = upper
    return groups[::-1]


def signed_groups(
    numbers: Whole, negative: Bools, columns: int, shows_zero: bool
) -> list[Codes | None]:
    """Write numbers with blanks and a minus before them, in groups from left to right.

    Args:
        numbers: absolute values, which fit with their sign into the columns.
        negative: which have a minus.
        columns: how many characters.
        shows_zero: whether zero is a digit or blank.

    Returns:
        The groups, each (n,); None for a group that is blank in every number.
    """
    groups: list[Codes | None] = []
    sign = negative.astype(numbers.dtype)
    for width in reversed(widths(columns)):
        if groups and not (numbers.any() or sign.any()):
            groups.append(None)
            continue
        upper = numbers // 10**width
        low = numbers - upper * 10**width
        more = upper > 0
        kind = np.where(more, 2, sign) if more.any() else sign
        groups.append(_table(width, shows_zero and not groups).take(low + kind * 10**width))
        if sign.any():
            sign = sign * (more | (low >= 10 ** (width - 1)))
        numbers = upper
    return groups[::-1]
