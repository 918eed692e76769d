"""The tables of the report: jobs, frames, flags, landmarks; cells have the text of the CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.conventions import reading_sigma_text
from vopd.attitude.flags import meanings
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.table_columns import column_name, columns_of
from vopd.export.tables import table_text
from vopd.report.summary import other_sigmas_text

SHOWN = (
    *("job", "frame", "status", "time_s", "flags"),
    *("camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("half_width_95_vehicle_yaw_deg", "half_width_95_vehicle_pitch_deg"),
    *("half_width_95_vehicle_roll_deg", "alpha_deg", "beta_deg", "eta_deg"),
    *("half_width_95_alpha_deg", "half_width_95_beta_deg", "eta_low_95_deg", "eta_high_95_deg"),
    *("airspeed_{length}_s", "landmarks", "residual_rms_{image}", "misfit_chance"),
    *("condition", "last_correction_rad"),
)
"""The columns of the table of frames, of those of the attitude table.

The source stands before them where there are several, `image` after `frame` where
frames have names.
"""

WORDS = ("status", "flags", "image")


class PageColumn(NamedTuple):
    """A column of a table on the page; with `words` it is sorted as words, not as numbers."""

    name: str
    meaning: str
    words: bool = False


class FrameRow(NamedTuple):
    """A row of the table of frames."""

    label: str  # the frame's number or name
    flags: str  # without their details, spaces between them
    cells: list[str]


class FrameTable(NamedTuple):
    """The table of frames."""

    columns: list[PageColumn]
    rows: list[FrameRow]


class FlagRow(NamedTuple):
    """A row of the table of flags."""

    name: str
    frames: int  # how many have it
    meaning: str
    advice: str


class CellTable(NamedTuple):
    """A table of cells: that of jobs, or that of landmarks."""

    columns: list[PageColumn]
    rows: list[list[str]]


def job_table(histories: Sequence[History]) -> CellTable:
    """The table of jobs, one row for each job."""
    words, units = histories[0].about.words, histories[0].estimate.units
    several = _several(histories)
    columns = [
        PageColumn("job", "its number"),
        *([PageColumn(words.source, "", True)] if several else []),
        PageColumn("title", "", True),
        PageColumn("frames", "of the job"),
        PageColumn("attitudes", "frames with an attitude"),
        PageColumn("not_converged", "frames that did not converge"),
        PageColumn("misfit", "frames whose residuals do not agree with the standard deviations"),
        PageColumn("flagged", "frames with any flag"),
        PageColumn(f"reading_sigma_{units.image}", f"standard deviation of {words.reading}"),
        PageColumn("from", "where that is from, and how well it is known", True),
        PageColumn("other standard deviations", "those in force", True),
    ]
    return CellTable(columns, [_job_row(h, several) for h in histories])


def _job_row(h: History, several: bool) -> list[str]:
    raised = h.flags.raised
    _, _, source = reading_sigma_text(h).partition(", ")
    return [
        str(h.about.job),
        *([h.about.source] if several else []),
        h.about.title,
        str(len(h.status)),
        str(int(h.has_attitude.sum())),
        str(int(raised["not_converged"].sum())),
        str(int(raised["misfit"].sum())),
        str(int(h.flags.any().sum())),
        f"{h.uncertainty.reading.sigma:.3g}",
        source,
        other_sigmas_text(h),
    ]


def frame_table(histories: Sequence[History]) -> FrameTable:
    """The table of frames, one row for each frame."""
    text = table_text(histories)
    estimate = histories[0].estimate
    source = estimate.about.words.source
    meaning = {column.name: column.meaning for column in columns_of(histories)}
    names = [column_name(one, estimate) for one in SHOWN]
    if "image" in text:
        names.insert(names.index("frame") + 1, "image")
    if _several(histories):
        names.insert(0, source)
    labels = [h.estimate.frame_label(k) for h in histories for k in range(len(h.status))]
    columns = [PageColumn(name, meaning[name], name in (*WORDS, source)) for name in names]
    rows = []
    for k, flags in enumerate(text["flags"]):
        raised = (flag.partition(":")[0] for flag in flags.split(";"))
        rows.append(FrameRow(labels[k], " ".join(raised), [text[name][k] for name in names]))
    return FrameTable(columns, rows)


def flag_rows(histories: Sequence[History]) -> list[FlagRow]:
    """What every flag means, what to do, and how many frames have it."""
    return [
        FlagRow(name, sum(int(h.flags.raised[name].sum()) for h in histories), meaning, advice)
        for name, (meaning, advice) in meanings(histories[0].about.words).items()
    ]


def landmark_table(histories: Sequence[History]) -> CellTable:
    """Statistics of the residuals of each landmark of each job."""
    units, words = histories[0].estimate.units, histories[0].about.words
    several = _several(histories)
    columns = [
        PageColumn("landmark", words.landmark, bool(histories[0].estimate.landmark_names)),
        *([PageColumn(words.source, "", True)] if several else []),
        PageColumn("job", ""),
        PageColumn("frames", "in which it takes part"),
        PageColumn("ignored", "frames from which it is left out"),
        PageColumn(f"mean x, {units.residual}", "of the residuals"),
        PageColumn(f"mean y, {units.residual}", "of the residuals"),
        PageColumn(f"rms x, {units.residual}", "root mean square of the residuals"),
        PageColumn(f"rms y, {units.residual}", "root mean square of the residuals"),
        PageColumn(f"largest, {units.residual}", "the longest residual"),
        PageColumn("in frame", "where that is", bool(histories[0].estimate.frame_names)),
        PageColumn("outlier", "frames in which it is the outlier"),
    ]
    return CellTable(columns, [row for h in histories for row in _frame_landmarks(h, several)])


def _several(histories: Sequence[History]) -> bool:
    return len({h.about.source for h in histories}) > 1


def _frame_landmarks(h: History, several: bool) -> list[list[str]]:
    e = h.estimate
    of = frame_landmarks(h)
    residual = of.residual * e.units.residuals_per_image
    here = of.used & np.isfinite(residual).all(axis=1)
    rows = []
    for number in np.unique(of.landmark[here | of.ignored]).tolist():
        mine = here & (of.landmark == number)
        left_out = int((of.ignored & (of.landmark == number)).sum())
        outlier = int((of.outlier & (of.landmark == number)).sum())
        frames = of.frame[mine]
        rows.append([
            e.landmark_label(number),
            *([h.about.source] if several else []),
            str(h.about.job),
            str(len(frames)),
            str(left_out),
            *_statistics(residual[mine]),
            e.frame_label(_worst(residual[mine], frames)) if len(frames) else "",
            str(outlier),
        ])  # fmt: skip
    return rows


def _statistics(residual: Floats) -> list[str]:
    """Mean x and y, root mean square x and y, and the largest, of residuals (n, 2)."""
    if not len(residual):
        return [""] * 5
    numbers = [*residual.mean(axis=0), *np.sqrt((residual**2).mean(axis=0))]
    return [f"{value:.3f}" for value in (*numbers, np.hypot(*residual.T).max())]


def _worst(residual: Floats, frames: Ints) -> int:
    """The frame, by its index, of the longest residual."""
    return int(frames[np.hypot(*residual.T).argmax()])
