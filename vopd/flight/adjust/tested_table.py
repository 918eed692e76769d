"""The tests of a flight as text, CSV and JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

import numpy as np

from vopd.attitude.residuals import SIGNIFICANCE, chance_text
from vopd.files import not_a_formula
from vopd.findings import count_text, listed, size_text
from vopd.flight.adjust.tested import Named, Prediction, TestedFlight
from vopd.flight.angles import turned_vehicle_deg
from vopd.flight.flight import Flight, frame_label, pick_label
from vopd.flight.misfits.leave_out import FIX, FRAME, KINDS, LANDMARK, PICK, POSITION, TIME, LeftOut
from vopd.geometry.linear import norm
from vopd.screen import aligned

SHOWN = 10  # tests in a text besides what is named, the least chances first
MOST_LANDMARKS = 12  # that a text has all of
COUNTED = {
    LANDMARK: ("landmark", "landmarks"),
    FRAME: ("frame", "frames"),
    TIME: ("frame's time", "frames' times"),
    POSITION: ("frame's position", "frames' positions"),
    FIX: ("fix", "fixes"),
    PICK: ("pick", "picks"),
}
COLUMNS = (
    "left_out", "frame", "landmark", "named", "normalised", "degrees_of_freedom", "chance",
    "chance_of_all", "off_u_px", "off_v_px", "fits_east_m", "fits_north_m", "fits_up_m",
    "fits_later_s", "rms_without_px", "moved_frame", "moved_deg", "moved_yaw_deg",
    "moved_pitch_deg", "moved_roll_deg", "moved_mean_deg",
)  # fmt: skip


def label(tests: LeftOut, k: int, flight: Flight) -> str:
    """Name what a test leaves out."""
    kind, frame = int(tests.kind[k]), int(tests.frame[k])
    if kind == LANDMARK:
        return f"landmark {flight.landmarks.name[tests.landmark[k]]}"
    if kind == PICK:
        return f"pick {pick_label(flight, int(tests.pick[k]))}"
    if kind == FIX:
        return _fix_label(int(tests.fix[k]), flight)
    of = frame_label(flight, frame)
    return {FRAME: of, TIME: f"{of}: its time", POSITION: f"{of}: its position"}[kind]


def _fix_label(fix: int, flight: Flight) -> str:
    """Name a fix by the frame that depends on it, or by its row where several or none do."""
    fixes = flight.path.fixes
    assert fixes is not None
    # the shape of the path between two fixes stands among them
    row = fix + 1 if fixes.between is None else int((~fixes.between[: fix + 1]).sum())
    own = fixes.frames_of(fix)
    if not len(own):  # by the velocity of the track alone
        near = int(np.abs(fixes.first - fix).argmin())
        side = "before" if fix < fixes.first[near] else "after"
        return f"fix {row}, {side} {frame_label(flight, near)}"
    first, last = (frame_label(flight, int(k)) for k in own[[0, -1]])
    if len(own) == 1:
        parts = np.flatnonzero(fixes.weight[own[0]])
        which = "fix before it" if fix == fixes.first[own[0]] + parts[0] else "fix after it"
        return f"{first}: {which if len(parts) > 1 else 'its fix'}"
    return f"fix {row}, of {first} to {last.removeprefix('frame ')}"


def rows(tested: TestedFlight) -> list[dict[str, object]]:
    """List the tests, what is named first, then by their chances; None where there is no value."""
    tests, flight = tested.tests, tested.flight
    count = len(tested.named)
    rest = count + np.argsort(-tests.evidence[count:], kind="stable")
    turned = turned_vehicle_deg(tested.estimates.solved, tests.moved_frame, tests.moved_rad)
    moved, mean = (
        np.degrees(np.linalg.norm(one, axis=1)) for one in (tests.moved_rad, tests.mean_moved_rad)
    )
    table = []
    for k in [*range(count), *rest.tolist()]:
        kind, frame = int(tests.kind[k]), int(tests.frame[k])
        off = tests.off_px[k]
        fits = tests.error[k] if kind in (LANDMARK, POSITION, FIX) else [np.nan] * 3
        later = tests.error[k, 0] if kind == TIME else np.nan
        at = int(tests.moved_frame[k])
        mark = int(tests.landmark[k])
        values = [
            KINDS[kind], frame_label(flight, frame) if frame >= 0 else None,
            flight.landmarks.name[mark] if mark >= 0 else None, k + 1 if k < count else None,
            tests.normalised[k], int(tests.freedom[k]), tests.chance[k], tests.chance_of_all[k],
            *off, *fits, later, tests.rms_px[k], frame_label(flight, at) if at >= 0 else None,
            moved[k], *turned[k], mean[k],
        ]  # fmt: skip
        if kind == FIX:
            values[1] = _fix_label(int(tests.fix[k]), flight)
        table.append(dict(zip(COLUMNS, map(_plain, values), strict=True)))
    return table


def _plain(value: object) -> object:
    if isinstance(value, float | np.floating):
        return float(f"{float(value):.6g}") if np.isfinite(value) else None
    return value


def as_csv(tested: TestedFlight) -> str:
    """Write the tests as CSV; an empty cell is none."""
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows(tested):
        texts = (not_a_formula(v) if isinstance(v, str) else v for v in row.values())
        writer.writerow(["" if v is None else v for v in texts])
    return page.getvalue()


def as_dict(tested: TestedFlight, prediction: Prediction | None) -> dict[str, object]:
    """Make what stands in JSON.

    Args:
        tested: the flight
        prediction: against the flight with all parameters as stated; None: nothing is free
    """
    own = tested.predicted_px[tested.predicts]
    found: dict[str, object] = {
        "named": [named_text(one, tested) for one in tested.named],
        "predicted": {
            "picks": len(own),
            "median_px": _plain(_median(own)),
            "rms_px": _plain(_rms(own)),
        },
        "left_out": rows(tested),
    }
    if prediction is not None:
        found["prediction"] = {
            "picks": prediction.picks,
            "median_px": dict(zip(WAYS, map(_plain, prediction.median_px), strict=True)),
            "rms_px": dict(zip(WAYS, map(_plain, prediction.rms_px), strict=True)),
            "frames": prediction.frames,
            "frames_better": prediction.better,
            "chance": _plain(prediction.chance),
        }
    return found


WAYS = ("stated", "freed")
IN_FORCE = "all else is tested without; what is solved has it still: correct it or take it out"


def _median(values: np.ndarray) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean())) if len(values) else float("nan")


# For reading


def as_text(tested: TestedFlight, prediction: Prediction | None, free: Sequence[str]) -> str:
    """Write the tests for reading.

    Args:
        tested: the flight
        prediction: against the flight with all parameters as stated; None: nothing is free
        free: names of the freed parameters
    """
    tests, flight = tested.tests, tested.flight
    counted = ", ".join(
        count_text(int((tests.kind == kind).sum()), *words)
        for kind, words in COUNTED.items()
        if (tests.kind == kind).any()
    )
    joint = tested.estimates.joint
    assert joint is not None
    rms_px = _rms(joint.normal.residual / joint.model.scale[:, None])
    without = " without what does not fit" * bool(tested.named)
    lines = [f"left out one by one: {counted}; residuals{without} {size_text(rms_px, 3)} px rms"]
    limit = f"{SIGNIFICANCE:g} with all tests counted".removeprefix("0")
    if tested.named:
        lines += [f"does not fit (chance below {limit}):"]
        lines += [f"  {named_text(one, tested)}" for one in tested.named]
        lines += [IN_FORCE]
    else:
        k = int(tests.evidence.argmax())
        lines += [
            f"all fit: the smallest chance is {chance_text(tests.chance[k])}, of "
            f"{label(tests, k, flight)}; {chance_text(tests.chance_of_all[k])} with all tests "
            f"counted (below {limit.split()[0]} it would be named)"
        ]
    lines += ["", *_table(tested), "", *prediction_lines(tested, prediction, free)]
    return "\n".join(lines) + "\n"


def named_text(one: Named, tested: TestedFlight) -> str:
    """Say what does not fit, and how angles change without it."""
    flight, tests = tested.flight, one.tests
    if one.exchanged:
        which = listed([flight.landmarks.name[flight.picks.landmark[k]] for k in one.exchanged])
        of = frame_label(flight, int(flight.picks.frame[one.exchanged[0]]))
        return f"{of}: {which} are exchanged: with their labels so all picks fit"
    texts = [label(tests, k, flight) + _fits(tests, k) for k in range(len(tests.kind))]
    turns = np.degrees(np.linalg.norm(tests.moved_rad[0]))
    moves = ""
    if tests.moved_frame[0] >= 0:
        moves = f"; without it {frame_label(flight, int(tests.moved_frame[0]))} turns by "
        moves += f"{_degrees(turns)} degree"
        mean = np.degrees(np.linalg.norm(tests.mean_moved_rad[0]))
        moves += f", the mean by {_degrees(mean)}" * bool(np.isfinite(mean))
    return f"{' or '.join(texts)}: chance {chance_text(tests.chance_of_all[0])}{moves}"


def _fits(tests: LeftOut, k: int) -> str:
    """Say how far something is off."""
    if np.isfinite(tests.off_px[k, 0]):
        return f", {_off(tests, k)} off"
    if np.isnan(tests.error[k, 0]):
        return ""
    if tests.kind[k] == TIME:
        return f" (it fits {tests.error[k, 0]:+.3g} s later)"
    return " (it fits {:+.3g} m east, {:+.3g} m north, {:+.3g} m up)".format(*tests.error[k])


def _degrees(value: float) -> str:
    """Write the size of a turn, which beyond half a circle says nothing."""
    if not value <= 180.0:
        return "over 180" if np.isfinite(value) else ""
    return size_text(value)


HEAD = (
    "left out", "normalised", "chance", "of all", "off", "turns, deg", "mean, deg", "rms without",
)  # fmt: skip


def _table(tested: TestedFlight) -> list[str]:
    """Tabulate what is named, all landmarks if they are few, and the least chances."""
    tests, flight = tested.tests, tested.flight
    order = np.argsort(-tests.evidence, kind="stable")
    own = np.flatnonzero(tests.kind == LANDMARK)
    shown = np.zeros(len(tests.kind), bool)
    shown[: len(tested.named)] = True
    shown[own] |= len(own) <= MOST_LANDMARKS
    shown[order[~shown[order]][:SHOWN]] = True
    table = [list(HEAD)]
    for k in order[shown[order]].tolist():
        moved, mean = (
            np.degrees(np.linalg.norm(one[k])) for one in (tests.moved_rad, tests.mean_moved_rad)
        )
        rms = f"{size_text(tests.rms_px[k], 3)} px" if np.isfinite(tests.rms_px[k]) else ""
        table.append([
            label(tests, k, flight), f"{tests.normalised[k]:.2f}", chance_text(tests.chance[k]),
            chance_text(tests.chance_of_all[k]), _off(tests, k), _degrees(moved), _degrees(mean),
            rms,
        ])  # fmt: skip
    keep = [any(row[c] for row in table[1:]) for c in range(len(HEAD))]
    table = [[cell for cell, kept in zip(row, keep, strict=True) if kept] for row in table]
    lines = aligned(table, {0})
    rest = tests.take(~shown)
    if len(rest.kind):
        lines.append(
            f"and {len(rest.kind)} more: normalised {_median(rest.normalised):.2f} in the median, "
            f"{rest.normalised.max():.2f} at most; smallest chance {chance_text(rest.chance.min())}"
        )
    return lines


def _off(tests: LeftOut, k: int) -> str:
    if np.isfinite(tests.off_px[k, 0]):
        return f"{size_text(np.hypot(*tests.off_px[k]), 3)} px"
    if np.isnan(tests.error[k, 0]):
        return ""
    if tests.kind[k] == TIME:
        return f"{size_text(abs(tests.error[k, 0]), 3)} s"
    return f"{size_text(float(norm(tests.error[k])), 3)} m"


def prediction_lines(
    tested: TestedFlight, prediction: Prediction | None, free: Sequence[str]
) -> list[str]:
    """Say how well each pick is predicted by all others, and whether freeing helped.

    Args:
        tested: the flight
        prediction: against the flight with all parameters as stated; None: nothing is free
        free: names of the freed parameters
    """
    own = tested.predicted_px[tested.predicts]
    if prediction is None or not prediction.picks:
        if not len(own):
            return ["no pick is predicted by others"]
        return [
            f"{count_text(len(own), 'pick')} predicted by all others: error "
            f"{size_text(_median(own), 3)} px in the median, {size_text(_rms(own), 3)} px rms"
        ]
    (stated, freed), (rms_stated, rms_freed) = prediction.median_px, prediction.rms_px
    names, frames = ", ".join(free), count_text(prediction.frames, "frame")
    if prediction.helps:
        verdict = "freeing helps"
    elif prediction.helps is None and freed < stated:
        verdict = "no clear difference"
    else:
        verdict = "keep what is stated"
    return [
        f"{count_text(prediction.picks, 'pick')} predicted by all others: with all as stated "
        f"{size_text(stated, 3)} px in the median, with {names} free {size_text(freed, 3)} px "
        f"(rms {size_text(rms_stated, 3)} and {size_text(rms_freed, 3)} px)",
        f"better in {prediction.better} of {frames} (chance {chance_text(prediction.chance)}): "
        f"{verdict}",
    ]
