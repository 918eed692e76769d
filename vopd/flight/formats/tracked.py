"""The file of `vopd track`: where landmarks are in frames, found from clicks by their patches.

A row is of one frame, landmark and click. Its error is that of the match, and that of the click as
the warp of the patch carries it: rows of one click share it, in all their frames.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import did_you_mean, shown
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.picks import Names, doubt_of_small_sigma
from vopd.flight.formats.tables import (
    UNKNOWN,
    CsvTable,
    csv_blocks,
    has_columns,
    header_names,
    name_cell,
    no_frame,
    whole_numbers,
)

COLUMNS = (
    "frame", "landmark", "u_px", "v_px", "sigma_px", "from_frame", "duu", "duv", "dvu", "dvv",
    "correlation", "status",
)  # fmt: skip
MATRIX = COLUMNS[6:10]
STATUSES = ("clicked", "tracked", "occluded", "edge", "lost", "ambiguous")
CLICKED, TRACKED = 0, 1
HEAD = "# vopd track; pixels: u right, v down, (0, 0) the centre of the first pixel"
"""The first line; those of the digests follow: `# clicks: 0a1b...`."""
SHARED = "# matches of a landmark in a frame from several clicks have one error"
"""The line that follows them."""
AGAIN = "run vopd track again"
MOST_STRETCH = 1e3  # of a patch: more is no image of it


@dataclass(frozen=True, eq=False)
class TrackedRows:
    """The rows of a tracked file, R of them."""

    frame: Ints  # numbers of frames, (R,)
    landmark: Names  # names, (R,)
    # u right, v down from the centre of the first pixel, (R, 2); NaN where there is none
    pixel: Floats
    # standard deviation of u and of v by the match alone; of a row `clicked` that of the click,
    # (R,); NaN where there is no pixel
    sigma_px: Floats
    from_frame: Ints  # the frame in which the landmark was clicked, (R,); -1: none
    by_click: Floats  # shift here per shift of the click, (R, 2, 2)
    correlation: Floats  # of the patch with the image, (R,); NaN where there is none
    status: Ints  # index of `STATUSES`, (R,)
    # of the files that were tracked, `clicks`, `video`, `project`, and of its `rows`; and the
    # `options` of the run, those that are not the usual ones
    digest: Mapping[str, str] = field(default_factory=dict)
    # as read: numbers of frames in which fewer than two landmarks are found
    lost: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    doubts: tuple[str, ...] = ()  # as read: warnings about rows

    def where(self, kept: Bools) -> TrackedRows:
        """Take some of the rows, (R,)."""
        names = Names(name for name, one in zip(self.landmark, kept.tolist(), strict=True) if one)
        return TrackedRows(
            self.frame[kept], names, self.pixel[kept], self.sigma_px[kept],
            self.from_frame[kept], self.by_click[kept], self.correlation[kept],
            self.status[kept], self.digest, self.lost, self.doubts,
        )  # fmt: skip


def digest_of_rows(path: Path) -> str:
    """Digest the rows of a tracked file, whatever ends its lines.

    Args:
        path: of the file
    """
    digest, is_row = sha256(), False
    with path.open("rb") as file:
        for line in file:
            if is_row:
                digest.update(line.rstrip(b"\r\n") + b"\n")
            is_row = is_row or line.startswith(b"frame,")
    return digest.hexdigest()


# Write it


def tracked_lines(rows: TrackedRows) -> Iterator[str]:
    """Write the lines of a tracked file."""
    yield HEAD + "\n"
    for name, digest in rows.digest.items():
        yield f"# {name}: {digest}\n"
    yield SHARED + "\n"
    yield ",".join(COLUMNS) + "\n"
    numbers = np.hstack([rows.pixel, rows.sigma_px[:, None]]).tolist()
    each = zip(
        rows.frame.tolist(), rows.landmark, numbers, rows.from_frame.tolist(),
        rows.by_click.reshape(-1, 4).tolist(), rows.correlation.tolist(), rows.status.tolist(),
        strict=True,
    )  # fmt: skip
    for frame, landmark, (u, v, sigma), source, matrix, correlation, status in each:
        seen = u == u
        place = [_number(u, 4), _number(v, 4), _number(sigma, 4)]
        by = [_number(one, 6) for one in matrix] if seen else [""] * 4
        cells = [str(frame), name_cell(landmark), *place, str(source) if source >= 0 else "", *by]
        yield ",".join([*cells, _number(correlation, 4), STATUSES[status]]) + "\n"


def _number(value: float, decimals: int) -> str:
    return "" if value != value else f"{value:.{decimals}f}"


# Read it


def recognises_tracked(file: InputFile) -> bool:
    """Tell whether the header is that of a tracked file, or near to it."""
    return file.head.startswith("# vopd track") or has_columns(
        file, COLUMNS, ("from_frame", "duu"), ("from_frame", "status")
    )


def read_tracked(file: InputFile) -> TrackedRows:
    """Read a tracked file.

    Raises:
        VopdError: where a column is missing, a status is not known, a row with a pixel has no
            click, or a number is not as it should be
    """
    frame, source, status, matrix = array("q"), array("q"), array("b"), array("d")
    pixel, sigma, correlation, names = array("d"), array("d"), array("d"), Names()
    doubts: tuple[str, ...] = ()
    header = header_names(file)
    if header and not file.columns and not {*header} & {*COLUMNS}:
        raise file.error(f"its header, {','.join(COLUMNS[:4])},..., is missing: {AGAIN}")
    for block in csv_blocks(file, COLUMNS):
        for column in COLUMNS:
            if not block.has(column):
                block.column(column)  # it is an error that says so
        states = _statuses(block)
        names.extend(_names(block))
        both = np.stack([block.numbers(name, UNKNOWN) for name in ("u_px", "v_px")], axis=1)
        own = block.sigmas("sigma_px")
        doubts = doubts or doubt_of_small_sigma(block, own)
        by = np.stack([block.numbers(name, UNKNOWN) for name in MATRIX], axis=1)
        frames, sources = _frames(block, "frame"), _frames(block, "from_frame")
        like = block.numbers("correlation", UNKNOWN)
        _check(block, states, both, own, by, frames, sources, like)
        clicked = states == CLICKED
        sources = np.where(clicked, frames, sources)
        by = np.where(clicked[:, None] & np.isnan(by), [1.0, 0.0, 0.0, 1.0], by)
        for to, values in (
            (frame, frames), (source, sources), (status, states.astype(np.int8)), (matrix, by),
            (pixel, both), (sigma, own), (correlation, like),
        ):  # fmt: skip
            to.frombytes(np.ascontiguousarray(values).tobytes())
    if not len(names):
        raise file.error(f"no row is in the file: {AGAIN}")
    rows = TrackedRows(
        np.asarray(frame), names, np.asarray(pixel).reshape(-1, 2), np.asarray(sigma),
        np.asarray(source), np.asarray(matrix).reshape(-1, 2, 2), np.asarray(correlation),
        np.asarray(status).astype(np.int64), _digests(file),
    )  # fmt: skip
    _check_clicks(file, rows)
    return replace(rows, lost=_lost(rows), doubts=doubts)


def _statuses(block: CsvTable) -> Ints:
    """Read the statuses of rows by their indices."""
    index = {name: k for k, name in enumerate(STATUSES)}
    texts = block.column("status")
    found = np.array([index.get(text, -1) for text in texts], dtype=np.int64)
    if (found < 0).any():
        row = int(np.argmin(found))
        message = f"{shown(texts[row])} is no status{did_you_mean(texts[row], STATUSES)}"
        raise block.error(message, row, "status")
    return found


def _names(block: CsvTable) -> list[str]:
    texts = block.column("landmark")
    if "" in texts:
        raise block.error("the cell is empty", texts.index(""), "landmark")
    return texts


def _frames(block: CsvTable, column: str) -> Ints:
    """Read numbers of frames; -1 for an empty cell of `from_frame`."""
    found = whole_numbers(block, column)
    if found is not None:
        return found
    texts = block.column(column)
    empty = column == "from_frame"
    for k, text in enumerate(texts):
        if (message := no_frame(text)) and (text or not empty):
            raise block.error(message, k, column)
    return np.array([int(text) if text else -1 for text in texts], dtype=np.int64)


def _check(
    block: CsvTable, status: Ints, pixel: Floats, sigma: Floats, by: Floats, frame: Ints,
    source: Ints, correlation: Floats,
) -> None:  # fmt: skip
    """Check that rows have what their status says."""
    seen = np.isfinite(pixel).all(axis=1)
    clicked, taken = status == CLICKED, (status == CLICKED) | (status == TRACKED)
    singular = np.abs(by).max(axis=1, initial=0.0) > MOST_STRETCH
    wrong: tuple[tuple[Any, str, str], ...] = (
        (np.isfinite(pixel).any(axis=1) & ~seen, "u_px and v_px stand together", "u_px"),
        (taken & ~seen, "a row that is clicked or tracked has u_px and v_px", "u_px"),
        (seen & np.isnan(sigma), "the cell is empty", "sigma_px"),
        (clicked & (source >= 0) & (source != frame), "a click is from its own frame",
         "from_frame"),
        (seen & ~clicked & (source < 0), "the cell is empty", "from_frame"),
        (seen & ~clicked & np.isnan(by).any(axis=1), "the matrix duu, duv, dvu, dvv is not whole",
         "duu"),
        (np.abs(correlation) > 1.0, "a correlation is -1 to 1", "correlation"),
        (singular, f"a shift is {MOST_STRETCH:g} times that of the click at most", "duu"),
    )  # fmt: skip
    for rows, message, column in wrong:
        if rows.any():
            raise block.error(f"{message}; {AGAIN}", int(np.argmax(rows)), column)


def _lost(rows: TrackedRows) -> Ints:
    """List the numbers of frames in which fewer than two landmarks are found."""
    seen = np.isfinite(rows.pixel[:, 0]) & np.isin(rows.status, (CLICKED, TRACKED))
    pairs = np.unique(np.stack([rows.frame, rows.landmark.which])[:, seen], axis=1)
    every = np.unique(rows.frame)
    count = np.bincount(np.searchsorted(every, pairs[0]), minlength=len(every))
    return np.asarray(every[count < 2])


def _digests(file: InputFile) -> dict[str, str]:
    """Read the digests in the comments above the header."""
    found = {}
    for line in file.head.splitlines():
        if not line.startswith("#"):
            break
        match = re.fullmatch(
            r"# (?:(clicks|video|project|rows): ([0-9a-f]{64})|(options): (\S.*))", line.strip()
        )
        if match:
            name, value = filter(None, match.groups())
            found[name] = value
    return found


def _check_clicks(file: InputFile, rows: TrackedRows) -> None:
    """Check that each row with a pixel is of a click, and stands once."""
    seen = np.isfinite(rows.pixel[:, 0])
    which, clicked = rows.landmark.which, rows.status == CLICKED
    names = rows.landmark.known
    click = {*zip(which[clicked].tolist(), rows.frame[clicked].tolist(), strict=True)}
    needed = np.unique(np.stack([which[seen], rows.from_frame[seen]], axis=1), axis=0).tolist()
    for mark, source in needed:
        if (mark, source) not in click:
            own = rows.status[(which == mark) & (rows.frame == source)].tolist()
            other = f", its status there is {STATUSES[own[0]]}" if own else ""
            raise file.error(f"no click of {names[mark]} is in frame {source}{other}: {AGAIN}")
    some = np.flatnonzero(rows.from_frame >= 0)
    order = some[np.lexsort((rows.from_frame[some], which[some], rows.frame[some]))]
    keys = np.stack([rows.frame[order], which[order], rows.from_frame[order]], axis=1)
    twice = (np.diff(keys, axis=0) == 0).all(axis=1)
    if twice.any():
        frame, mark, source = keys[int(np.argmax(twice))].tolist()
        message = f"{names[mark]} in frame {frame} from frame {source} stands twice: {AGAIN}"
        raise file.error(message)
