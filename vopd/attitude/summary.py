"""Attitude histories in short, for reading: a table of frames, how sure it is, what is doubtful."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from functools import partial
from html import escape
from math import floor, isfinite, log10
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.conventions import doubts_text, own_words
from vopd.attitude.findings import HistorySummary, errata_text, misfits
from vopd.attitude.flags import meanings
from vopd.attitude.history import History, are_others
from vopd.attitude.included import errors_texts, names_mount, one_turn_texts
from vopd.attitude.long_history import HistoryParts
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import FrameEstimate
from vopd.findings import (
    Finding,
    angle_text,
    count_text,
    first_of_each_kind,
    frames_text,
    size_text,
)
from vopd.screen import LEAST, aligned, shortened, width, wrapped

ROWS = 20  # frames of a table
NAME = 28  # columns of the name of an image or a source, if there is room
LEAST_NAME = 12  # and if there is none
CONTRADICTED = "?"  # in the place of a 95 % half-width that the residuals contradict

# Frames of one kind of source, counted, and the first of them kept


@dataclass
class ShownFrames:
    """The first frames of some jobs, and counts of all."""

    jobs: list[HistoryParts]
    head: list[History] = field(default_factory=list)  # parts, with `ROWS` frames or more
    known: list[History] = field(default_factory=list)  # the same of frames with an attitude alone
    count: int = 0
    attitudes: int = 0
    attack: bool = False  # whether any frame has angles of attack
    half_deg: list[Floats] = field(default_factory=list)  # of vehicle yaw, pitch, roll, 95 %
    flagged: dict[str, list[str]] = field(default_factory=dict)  # labels of frames by flag
    with_attitude: dict[str, int] = field(
        default_factory=dict
    )  # how many of these have an attitude
    details: dict[str, set[str]] = field(default_factory=dict)  # of each flag, all that there are
    summary: HistorySummary = field(default_factory=HistorySummary)
    roll_180: bool = True  # whether roll is -180 to 180 in the table, and not 0 to 360

    def add(self, part: History, several: bool) -> None:
        """Count some more frames.

        Args:
            part: their history
            several: whether the name of the job is part of a frame's
        """
        estimate, has = part.estimate, part.has_attitude
        if self.count < ROWS:
            self.head.append(part)
        if self.attitudes < ROWS and has.any():
            self.known.append(part if has.all() else part.take(has))
        self.count += len(has)
        self.attitudes += int(has.sum())
        self.attack |= bool(np.isfinite(estimate.attack_deg[:, :2]).any())
        self.half_deg.append(part.uncertainty.half_width_95[has, 3:6])
        self.summary.add(part)
        prefix = f"{part.about.label}: " if several else ""
        for name, raised in part.flags.raised.items():
            frames = np.flatnonzero(raised).tolist()
            if frames:
                labels = self.flagged.setdefault(name, [])
                labels += [prefix + estimate.frame_label(k) for k in frames]
                known = self.with_attitude.get(name, 0) + int((raised & has).sum())
                self.with_attitude[name] = known
                own = part.flags.detail.get(name)
                self.details.setdefault(name, set()).update(own[k] if own else "" for k in frames)

    def flags_all(self, name: str) -> bool:
        """Tell whether a flag is of all frames with an attitude, and of no other."""
        return len(self.flagged[name]) == self.with_attitude[name] == self.attitudes

    @property
    def without_rows(self) -> bool:
        """Whether frames without an attitude have no rows: there are more frames than rows."""
        return self.count > ROWS and 0 < self.attitudes < self.count

    @property
    def more_text(self) -> str:
        """Count the frames that have no row; empty if all have one."""
        rows = min(ROWS, self.attitudes if self.without_rows else self.count)
        if rows == self.count:
            return ""
        none = f", {self.count - self.attitudes} without an attitude" if self.without_rows else ""
        return f"{count_text(self.count - rows, 'more frame')}{none}"


def frames_of(jobs: Iterable[HistoryParts], roll_180: bool = True) -> list[ShownFrames]:
    """Count the frames of jobs, those of each kind of source by themselves."""
    kinds: dict[object, list[HistoryParts]] = {}
    for job in jobs:
        estimate = job.head.estimate
        kinds.setdefault((estimate.units, job.about.words.source), []).append(job)
    made = []
    for some in kinds.values():
        own = ShownFrames(some, roll_180=roll_180)
        for job in some:
            for part in job:
                own.add(part, len(some) > 1)
        made.append(own)
    return made


# The table


class ShownColumn(NamedTuple):
    """A column of the table.

    Those of a lower rank are left out first if the screen is narrow. `close` belongs to the
    column before it.
    """

    name: str
    unit: str
    cells: list[str]
    rank: int = 9
    left: bool = False
    close: bool = False


def columns(frames: ShownFrames, digits: int = 2) -> list[ShownColumn]:
    """List the columns of the table of the first frames.

    Args:
        frames: of one kind of source
        digits: significant ones of the 95 % half-widths; the angles have the same decimals
    """
    parts = frames.known if frames.without_rows else frames.head
    e = [part.estimate for part in parts]
    camera, vehicle, attack = (
        np.concatenate([getattr(one, name) for one in e])[:ROWS]
        for name in ("camera_deg", "vehicle_deg", "attack_deg")
    )
    half = np.concatenate([part.uncertainty.half_width_95 for part in parts])[:ROWS]
    time_s = np.concatenate([one.time_s for one in e])[:ROWS]
    rms = np.concatenate([part.residual_rms for part in parts])[:ROWS]
    marks = np.concatenate([part.landmarks for part in parts])[:ROWS]
    has = np.concatenate([part.has_attitude for part in parts])[:ROWS]
    misfit = np.concatenate([part.flags.raised["misfit"] for part in parts])[:ROWS]
    half = np.where(misfit[:, None], -np.inf, half)  # printed as contradicted
    labels = [one.frame_label(k) for one in e for k in range(len(one.frame))][:ROWS]
    sources = [one.about.source for one in e for _ in one.frame][:ROWS]
    numbers = [str(one.about.job) for one in e for _ in one.frame][:ROWS]
    status = [word for part in parts for word in part.status][:ROWS]
    found = []
    angle = partial(_angle, has=has, digits=digits, roll_180=frames.roll_180)
    if len({job.about.source for job in frames.jobs}) > 1:
        found.append(ShownColumn(e[0].about.words.source, "", sources, left=True))
    if len(frames.jobs) > 1 and e[0].about.words.jobs:
        found.append(ShownColumn("job", "", numbers))
    named = any(one.frame_names for one in e)
    found.append(ShownColumn("image" if named else "frame", "", labels, left=named))
    if np.isfinite(time_s).any():
        found.append(ShownColumn("time", "s", _fixed(time_s, _decimals_of_times(time_s)), 2))
    for k, name in enumerate(ANGLES[3:6]):
        label = name.removeprefix("vehicle_")
        found += angle(label, vehicle[:, k], half[:, 3 + k])
    if frames.attack and e[0].about.words.attack:
        for k, name in enumerate(ANGLES[6:8]):
            own = angle(name, attack[:, k], half[:, 6 + k])
            found += [own[0]._replace(rank=3), own[1]._replace(rank=0)]
    if are_others(camera, vehicle):
        for k, name in enumerate(ANGLES[:3]):
            own = angle(name.replace("_", " "), camera[:, k], half[:, k])
            found.append(own[0]._replace(rank=1))
    rms, unit = rms * e[0].units.residuals_per_image, e[0].units.residual
    found.append(ShownColumn("land-", "marks", [str(n) for n in marks.tolist()]))
    found.append(ShownColumn("rms", unit, _fixed(rms, decimals_for(rms, 2))))
    letters = flag_letters(frames)
    texts = []
    for part in parts:
        raised = part.flags.raised
        texts += [
            " ".join(letter for name, letter in letters.items() if raised[name][k])
            for k in range(len(part.landmarks))
        ]
    words = [
        text if one else " ".join([word, text]).strip()
        for text, one, word in zip(texts, has.tolist(), status, strict=False)
    ]
    if any(words):
        found.append(ShownColumn("flags", "", words, left=True))
    return found


def _angle(
    name: str, values: Floats, half: Floats, has: Bools, digits: int, roll_180: bool = True
) -> tuple[ShownColumn, ShownColumn]:
    """List the column of an angle and that of its 95 % half-width."""
    decimals = decimals_for(half[has], digits)
    known = has & np.isfinite(values)
    widths = [
        _half_text(h, decimals) if one else ""
        for h, one in zip(half.tolist(), known.tolist(), strict=True)
    ]
    body, _, angle = name.rpartition(" ")
    head = (body, angle) if body else (angle, "deg")
    texts = _fixed(np.where(known, values, np.nan), decimals)
    for k in np.flatnonzero(known).tolist():
        if angle == "roll" or (angle == "yaw" and 0.0 <= values[k] < 360.0):
            texts[k] = angle_text(float(values[k]), decimals, angle == "roll" and roll_180)
    return ShownColumn(*head, texts), ShownColumn("+-", "", widths, close=True)


def _half_text(half: float, decimals: int) -> str:
    if half < 0.0:
        return CONTRADICTED
    return f"{half:.{decimals}f}" if isfinite(half) else "free"


def decimals_for(sizes: Floats, digits: int) -> int:
    """Choose the decimals that give the usual one of some sizes so many digits."""
    known = sizes[np.isfinite(sizes) & (sizes > 0.0)]
    if not len(known):
        return 3
    return min(max(digits - 1 - floor(log10(float(np.median(known)) * 1.005)), 0), 6)


def _decimals_of_times(time_s: Floats) -> int:
    """Choose the decimals that tell all times apart as well as more would."""
    known = time_s[np.isfinite(time_s)]
    return next((d for d in range(3) if (np.abs(known - known.round(d)) < 5e-4).all()), 3)


def _fixed(values: Floats, decimals: int) -> list[str]:
    texts = [f"{one:.{decimals}f}" if isfinite(one) else "" for one in values.tolist()]
    return [one.lstrip("-") if one and not one.strip("-0.") else one for one in texts]


def flag_letters(frames: ShownFrames) -> dict[str, str]:
    """Choose a letter for each flag that some frames have; one that all have needs none."""
    some = [
        name for name, labels in frames.flagged.items()
        if not frames.flags_all(name) and len(labels) < frames.count
    ]  # fmt: skip
    order = list(frames.head[0].flags.raised)
    return {name: chr(97 + k) for k, name in enumerate(sorted(some, key=order.index))}


def _laid_out(shown: Sequence[ShownColumn], most_name: int) -> list[str]:
    """Align columns; names are shortened."""
    cells = [[one.name, one.unit, *(shortened(c, most_name) for c in one.cells)] for one in shown]
    return aligned(
        list(zip(*cells, strict=True)),
        {k for k, one in enumerate(shown) if one.left},
        {k for k, one in enumerate(shown) if one.close},
    )


def table_lines(frames: ShownFrames, columns_wide: int) -> tuple[list[str], list[str]]:
    """Lay the table out for a screen.

    Returns:
        Its lines, and the names of columns that did not fit.
    """
    every = columns(frames)
    for digits, least, most_name in (
        (2, 0, NAME), (2, 1, NAME), (2, 2, NAME), (1, 2, NAME), (1, 2, LEAST_NAME),
        (1, 3, LEAST_NAME), (1, 4, LEAST_NAME),
    ):  # fmt: skip
        shown = [one for one in columns(frames, digits) if one.rank >= least]
        lines = _laid_out(shown, most_name)
        spare = columns_wide - max(map(width, lines))
        if spare >= 0:
            lines = _laid_out(shown, most_name + spare // 2)
            break
    names = [one[:2] for one in shown]
    left = [one for one in every if one[:2] not in names and not one.close]
    return lines, [f"{one.name} {one.unit}" if one.name == "camera" else one.name for one in left]


# What stands below it


def sure_text(frames: ShownFrames) -> str:
    """Say how sure the angles are, and which errors that leaves out."""
    half = np.concatenate(frames.half_deg)
    told = "no frame has an attitude"
    if len(half):
        middle = np.median(np.where(np.isnan(half), np.inf, half), axis=0)
        median = "in the median " if len(half) > 1 else ""
        told = "+- is half of the 95 % interval, degrees"
        if "misfit" in frames.flagged:
            told += f" ({CONTRADICTED}: the residuals contradict it)"
        told += f": {median}" + ", ".join(
            f"{name} {'free' if not isfinite(size) else size_text(size)}"
            for name, size in zip(("yaw", "pitch", "roll"), middle.tolist(), strict=True)
        )
    included = dict.fromkeys(one for _, one, _ in errors_texts([job.head for job in frames.jobs]))
    of_decks = one_turn_texts(job.head for job in frames.jobs if not job.about.words.sigma_keys)
    told = "; ".join([told, *of_decks[:1]])
    return "; ".join([told, *(f"the sigmas include errors of: {one}" for one in included if one)])


def left_text(frames: ShownFrames) -> str:
    """Name the errors that the sigmas leave out, and where to state each."""
    left = dict.fromkeys(one for _, _, one in errors_texts([job.head for job in frames.jobs]))
    return "; ".join(one for one in left if one)


NAMED = 60  # characters of the frames of a flag


def doubt_lines(frames: ShownFrames) -> list[str]:
    """Explain the flags, a line each: the letter, the frames, what to do."""
    letters = flag_letters(frames)
    said = meanings(frames.head[0].about.words)
    repairs, _ = misfits(frames.summary)
    lines = []
    for name in (one for one in frames.head[0].flags.raised if one in frames.flagged):
        labels, own = frames.flagged[name], frames.details[name]
        where = frames_text(labels)
        if frames.flags_all(name) and len(labels) > 1:
            where = f"every frame ({len(labels)})"
        elif len(where) > NAMED:
            where = count_text(len(labels), "frame")
        detail = f" ({next(iter(own))})" if len(own) == 1 and any(own) else ""
        if name == "misfit" and repairs:
            detail = f" ({repairs[0][1]})"
        lines.append(f"{letters.get(name, '')} {name}, {where}{detail}: {said[name][1]}".strip())
    lines += filter(None, [errata_text(frames.summary)])
    missing = frames.count - frames.attitudes
    if missing:
        lines.insert(0, f"{count_text(missing, 'frame')} without an attitude")
    return lines


def heading(frames: ShownFrames) -> str:
    """Name the sources, with the numbers of jobs and frames."""
    names = list(dict.fromkeys(job.about.source for job in frames.jobs))
    about = frames.jobs[0].about
    told = names[0] if len(names) == 1 else count_text(len(names), about.words.source)
    if about.words.jobs and len(frames.jobs) > 1:
        told += f", {count_text(len(frames.jobs), 'job')}"
    told += f": {count_text(frames.count, 'frame')}"
    if len(frames.jobs) == 1 and about.title.strip():
        told += f", {about.title.strip()}"
    return told


DOWN_DEG = -60.0
LOOKS_DOWN = (
    '; the camera looks down, and these are its own angles: [vehicle] mount = "down" gives those '
    "of the vehicle that carries it"
)


def own_angles(frames: ShownFrames) -> Floats:
    """Collect the camera's angles of a project whose camera counts as the vehicle itself.

    Returns:
        Yaw, pitch, roll of the first frames, (T, 3); none of any other source.
    """
    camera, vehicle = (
        np.concatenate([getattr(part.estimate, name)[part.has_attitude] for part in frames.head])
        for name in ("camera_deg", "vehicle_deg")
    )
    is_project = frames.head[0].about.words.source == "project"
    return camera if is_project and not are_others(camera, vehicle) else camera[:0]


def looks_down(frames: ShownFrames) -> bool:
    """Test whether the camera of a project looks down, and counts as the vehicle itself."""
    camera = own_angles(frames)
    return bool(len(camera) and np.median(camera[:, 1]) < DOWN_DEG)


def azimuth_text(frames: ShownFrames) -> str:
    """Say how yaw and pitch are azimuth and tilt, where landmarks are on a map's grid."""
    grid = frames.jobs[0].about.words.conventions.get("grid azimuth")
    if grid is None or not len(own_angles(frames)):
        return ""
    return (
        f"yaw is the azimuth of the view from true north; grid azimuth: {grid}; pitch is its "
        "elevation, and 90 degrees more its tilt from straight down"
    )


def mount_text(frames: ShownFrames) -> str:
    """Say how the camera is mounted, where its angles are not those of the vehicle."""
    return own_words(frames.jobs, "mount")


def gimbal_text(frames: ShownFrames) -> str:
    """Compare the camera's attitudes with those of its gimbal, where the images' tags have them."""
    gimbal = own_words(frames.jobs, "gimbal")
    return gimbal and f"gimbal: {gimbal}"


def check_text(frames: ShownFrames) -> str:
    """Say how far landmarks that take no part are from where they were picked."""
    return own_words(frames.jobs, "check landmarks")


def where_text(estimates: Iterable[FrameEstimate]) -> str:
    """Say where on the Earth a flight begins, and when: a wrong sign or zone shows there alone."""
    for one in estimates:
        known = np.flatnonzero(np.isfinite(one.position.latitude_deg)).tolist()
        if one.about.words.source == "project" and known:
            place, k = one.position, known[0]
            parts = [
                f"{abs(degrees[k]):.4f} {sides[int(degrees[k] < 0.0)]}"
                for degrees, sides in ((place.latitude_deg, "NS"), (place.longitude_deg, "EW"))
            ]
            parts.append(f"{place.altitude[k]:.0f} {one.units.length} {one.about.words.altitude}")
            parts += filter(None, [_moment_text(one.about.epoch, float(one.time_s[k]))])
            name = "" if one.frame_names else "frame "
            return f"{name}{one.frame_label(k)} at {', '.join(parts)}"
    return ""


def _moment_text(epoch: datetime | None, time_s: float) -> str:
    """Write a moment some seconds after an epoch; empty where it has no date."""
    if epoch is None or not isfinite(time_s):
        return ""
    try:
        return f"{epoch.astimezone(UTC) + timedelta(seconds=time_s):%Y-%m-%d %H:%M:%S} UTC"
    except OverflowError:  # before the year 1 or after 9999
        return ""


SURE, LEFT, DOUBTFUL, NEXT = "how sure", "not in it", "doubtful", "next"
LABELS = ("angles", "where", SURE, LEFT, DOUBTFUL, NEXT)
INDENT = " " * (max(map(len, LABELS)) + 2)


def text(
    jobs: Iterable[HistoryParts],
    columns_wide: int = LEAST,
    findings: Sequence[str] = (),
    steps: Mapping[str, str] | None = None,
    printed: int = 0,
    roll_180: bool = True,
) -> str:
    """Write the short table of jobs, and what is to be known about it.

    Args:
        jobs: one or more
        columns_wide: of the screen
        findings: warnings about files and solution
        steps: how to get all columns (`table`) and what to do next (`next`); None: those of the
            library
        printed: warnings that have been printed before
        roll_180: whether roll is -180 to 180 in the table, and not 0 to 360
    """
    steps = steps or {"table": ".to_dataframe() has all", "next": ".plot() draws it"}
    pages = []
    for frames in frames_of(jobs, roll_180):
        lines, narrow = table_lines(frames, columns_wide)
        lines = [wrapped(heading(frames), columns_wide), "", *lines]
        if frames.more_text:
            lines.append(f"{frames.more_text}: {steps['table']}")
        if narrow:
            lines.append(wrapped(f"no room for {', '.join(narrow)}", columns_wide))
        doubts = doubt_lines(frames)
        doubts += findings or doubts_text([job.head for job in frames.jobs if not printed])
        if printed:
            doubts.append(f"{count_text(printed, 'warning')} above")
        hint = looks_down(frames) and not any(names_mount(job.head) for job in frames.jobs)
        paragraphs = (
            [*filter(None, [azimuth_text(frames), mount_text(frames), gimbal_text(frames)])],
            [*filter(None, [where_text(part.estimate for part in frames.head)])],
            [sure_text(frames), *filter(None, [check_text(frames)])],
            [left_text(frames) or "nothing that can be stated"],
            doubts or ["no frame has a flag"],
            [steps["next"] + f"; {steps['table']}" * (not frames.more_text) + LOOKS_DOWN * hint],
        )
        lines.append("")
        for label, said in zip(LABELS, paragraphs, strict=True):
            begin = f"{label:{len(INDENT)}}"
            for one in said:
                lines.append(wrapped(begin + one, columns_wide, INDENT))
                begin = INDENT
        pages.append("\n".join(lines) + "\n")
    return "\n".join(pages)


def means_text(
    histories: Sequence[History],
    columns_wide: int = LEAST,
    steps: Mapping[str, str] | None = None,
) -> str:
    """Write the mean attitude of each job in short, and what is to be known about it.

    Args:
        histories: of one or more jobs
        columns_wide: of the screen
        steps: how to get all columns (`table`); None: those of the library

    Raises:
        VopdError: if no frame of a job has an attitude, or frames are 90 degrees or more apart
    """
    means = [one.mean() for one in histories]
    estimates = [one.estimate for one in histories]
    camera, vehicle = (
        np.array([getattr(one, name) for one in means]) for name in ("camera_deg", "vehicle_deg")
    )
    half = np.array([one.half_width_95 for one in means])
    shown = [ShownColumn(estimates[0].about.words.source, "", [e.about.source for e in estimates],
                         left=True)]  # fmt: skip
    if estimates[0].about.words.jobs:
        shown.append(ShownColumn("job", "", [str(e.about.job) for e in estimates]))
    shown.append(ShownColumn("frames", "", [str(one.frames) for one in means]))
    shown.append(ShownColumn("flagged", "", [str(one.flagged) for one in means]))
    both = [(name, vehicle[:, k], half[:, 3 + k]) for k, name in enumerate(ANGLES[3:6])]
    if are_others(camera, vehicle):
        both += [(name, camera[:, k], half[:, k]) for k, name in enumerate(ANGLES[:3])]
    for name, values, widths in both:
        label = name.removeprefix("vehicle_").replace("_", " ")
        rows = [_angle(label, values[k : k + 1], widths[k : k + 1], np.ones(1, bool), 2)
                for k in range(len(means))]  # fmt: skip
        for of_all in zip(*rows, strict=True):
            shown.append(of_all[0]._replace(cells=[one.cells[0] for one in of_all]))
    if max(map(width, _laid_out(shown, LEAST_NAME))) > columns_wide:
        shown = [one for k, one in enumerate(shown) if k < len(shown) - 6 or len(both) == 3]
    lines = _laid_out(shown, NAME)
    if max(map(width, lines)) > columns_wide:
        lines = _laid_out(shown, LEAST_NAME)
    lines.append("")
    told = ["+- is half of the 95 % interval of the mean, degrees"]
    left = []
    for _, included, missing in errors_texts(histories, means):
        told += [f"the sigmas include errors of: {included}"] * bool(included)
        left += [missing] * bool(missing)
    table = (steps or {"table": ".mean() has all"})["table"]
    doubts = "; ".join(doubts_text(histories))
    paragraphs = ("; ".join(told), "; ".join(left) or "nothing that can be stated", doubts, table)
    for label, said in zip((SURE, LEFT, DOUBTFUL, NEXT), paragraphs, strict=True):
        if said:
            lines.append(wrapped(f"{label:{len(INDENT)}}{said}", columns_wide, INDENT))
    return "\n".join(lines) + "\n"


def html(jobs: Iterable[HistoryParts], findings: Sequence[Finding] = ()) -> str:
    """Write the same for a notebook: the table with all its columns, flags and warnings."""
    parts = []
    for frames in frames_of(jobs):
        shown = columns(frames)
        head = "".join(f"<th>{escape(one.name)}<br>{escape(one.unit)}</th>" for one in shown)
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>"
            for row in zip(*(one.cells for one in shown), strict=True)
        )
        after = [f"{frames.more_text}: .to_dataframe()"] if frames.more_text else []
        where = where_text(part.estimate for part in frames.head)
        after += filter(None, [azimuth_text(frames), mount_text(frames), where])
        after += filter(None, [sure_text(frames), check_text(frames)])
        after += [f"not in it: {left_text(frames)}"]
        parts.append(
            f"<p>{escape(heading(frames))}</p><table><thead><tr>{head}</tr></thead>"
            f"<tbody>{rows}</tbody></table>" + "".join(f"<p>{escape(one)}</p>" for one in after)
        )
        doubts = doubt_lines(frames)
        doubts += [] if findings else doubts_text([job.head for job in frames.jobs])
        parts += [f"<p>{escape(one)}</p>" for one in doubts]
    return "".join([*parts, *(f"<p>{escape(one)}</p>" for one in finding_texts(findings))])


ALIKE = 3  # findings of one kind


def finding_texts(findings: Sequence[Finding]) -> list[str]:
    """Write the first warnings of each kind, and the numbers of the others."""
    kept, rest = first_of_each_kind(findings, ALIKE)
    return [
        *(f"warning: {one.headline()}" for one in kept),
        *(f"warning: {count_text(n, 'more warning')} like: {one.headline()}" for one, n in rest),
    ]
