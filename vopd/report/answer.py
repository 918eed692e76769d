"""The answer of a report: angles, how sure, what is doubtful, what no sigma includes."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log10
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.conventions import doubts_text, included_statements
from vopd.attitude.findings import errata_text, summary_of
from vopd.attitude.flags import meanings
from vopd.attitude.history import History, is_turned
from vopd.figures.attitude import (
    TOLD_BY,
    brought_by,
    from_cut,
    in_half_circle,
    interval_of,
    shows_attack,
    unwrapped_about,
    values_of,
)
from vopd.findings import angle_text, count_text

Rows = list[list[str]]


class Doubt(NamedTuple):
    """Something doubtful: how many frames, and the flag that they have, if it is one."""

    text: str
    flag: str = ""


def angle_table(histories: Sequence[History]) -> tuple[list[str], Rows]:
    """Tabulate the angles: of one frame their values, else their range, with 95 % intervals.

    Args:
        histories: the jobs
    """
    bodies = ["vehicle"]
    if any(map(is_turned, histories)):
        bodies.append("camera")
    names = [(f"{body} {one}", f"{body}_{one}") for body in bodies for one in AXES]
    if len(bodies) == 1:
        names = [(one, f"vehicle_{one}") for one in AXES]
    if shows_attack(histories):
        names += [(one, one) for one in ("alpha", "beta", "eta")]
    single = sum(int(h.has_attitude.sum()) for h in histories) == 1
    head = ["angle", "degrees", "± (95 %)"] if single else ["angle", *RANGE]
    rows = [[label, *_angle_row(histories, name, single)] for label, name in names]
    return head, rows


AXES = ("yaw", "pitch", "roll")
RANGE = ("least, degrees", "greatest, degrees", "± (95 %), median", "± (95 %), largest")


def _angle_row(histories: Sequence[History], name: str, single: bool) -> list[str]:
    angle = np.concatenate([values_of(h, name)[h.has_attitude] for h in histories])
    ends = np.concatenate([interval_of(h, name)[:, h.has_attitude] for h in histories], axis=1)
    here = np.isfinite(angle)
    angle, half = angle[here], (ends[1] - ends[0])[here] / 2.0
    if not len(angle):
        return ["unknown"] * (2 if single else 4)
    known = half[np.isfinite(half)]
    widths = [np.median(known), known.max()] if len(known) else []
    decimals = _decimals(float(widths[0])) if widths else 2
    whole = from_cut(angle, unwrapped_about(angle))
    shown = [whole[0]] if single else [whole.min(), whole.max()]
    half_circle = in_half_circle(name, float(whole.min()), float(whole.max()))
    texts = [angle_text(float(one), decimals, half_circle) for one in shown]
    widths_text = [
        f"{one:#.2g}" if one < 9.95 else f"{one:.0f}" for one in widths[: 1 if single else 2]
    ]
    none = ["unknown"] * (1 if single else 2)
    unknown = len(half) - len(known)
    if widths and unknown and not single:
        widths_text[1] += f"; unknown in {count_text(unknown, 'frame')}"
    return [*texts, *(widths_text or none)]


def _decimals(half: float) -> int:
    """Choose decimals of an angle: one digit beyond the first of its half-width."""
    return min(max(1 - ceil(log10(half)) + 1, 2), 6) if half > 0.0 else 6


def doubts(histories: Sequence[History]) -> list[Doubt]:
    """List what is doubtful: flights that misfit, frames without an attitude, and frames by flag.

    The flag of most frames comes first.

    Args:
        histories: the jobs
    """
    total = sum(len(h.status) for h in histories)
    of = count_text(total, "frame")
    words = meanings(histories[0].about.words)
    found = []
    for name, (meaning, _) in words.items():
        count = 0
        for h in histories:
            frames = h.flags.raised[name]
            if name in TOLD_BY:
                frames = frames & ~h.flags.raised[TOLD_BY[name]]
            count += int(frames.sum())
        if count:
            told = "; ".join([meaning, *(words[one][0] for one in brought_by(name, histories))])
            found.append((count, Doubt(f"{count} of {of}: {told}", name)))
    listed = [one for _, one in sorted(found, key=lambda one: -one[0])]
    none = [
        word
        for h in histories
        for word, has in zip(h.status, h.has_attitude, strict=True)
        if not has
    ]
    if none:
        kinds = ", ".join(f"{none.count(word)} {word}" for word in dict.fromkeys(none))
        listed.insert(0, Doubt(f"{len(none)} of {of}: no attitude ({kinds})"))
    return [*map(Doubt, doubts_text(histories)), *listed]


def not_included(histories: Sequence[History]) -> list[str]:
    """List what the standard deviations leave out: errors that nobody stated, and errata.

    Args:
        histories: the jobs
    """
    texts = []
    stated = included_statements(histories)
    if stated:
        texts.append(stated["sigmas_not_included"])
    elif left := [what for what, _, value in sigmas_in_force(histories[0]) if not np.any(value)]:
        texts.append(f"errors of {', '.join(left)}: no standard deviation is stated for them")
    for h in histories:
        if told := errata_text(summary_of([h])):
            texts.append((f"{h.about.label}: " if len(histories) > 1 else "") + told)
    more = [f"{count_text(len(texts) - MOST, 'more job')} likewise"] if len(texts) > MOST else []
    return [*texts[:MOST], *more]


MOST = 4  # sentences

Sigma = float | tuple[float, ...] | Floats


def sigmas_in_force(history: History) -> list[tuple[str, str, Sigma]]:
    """List the standard deviations besides that of the readings: what, unit, value; 0: not stated.

    Args:
        history: the job
    """
    sigmas, units = history.uncertainty.sigmas, history.estimate.units
    return [
        ("centre by the fiducials", units.image, sigmas.centre),
        ("principal point", units.image, sigmas.principal_point),
        ("landmark positions", units.length, sigmas.landmark),
        ("camera position", units.length, np.hypot(sigmas.position, sigmas.place)),
        ("focal length", units.image, sigmas.focal_length),
        ("times of frames", "s", sigmas.time_s),
        ("mounting", "degree", sigmas.mount_deg),
        ("velocity", f"{units.length}/s", sigmas.velocity),
        ("wind", f"{units.length}/s", sigmas.wind),
    ]
