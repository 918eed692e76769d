"""Parameters of a flight that its frames can be asked for together: names, units and priors."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, VopdError, did_you_mean, size_text
from vopd.flight.flight import Flight, NotHeld
from vopd.flight.solve.equations import (
    LENS_COEFFICIENTS,
    SHIFT,
    lacking_text,
    parameters_of,
    with_parameters,
)
from vopd.flight.solve.readout import row_shifts_px
from vopd.geometry.lenses import Lenses, LensKind

if TYPE_CHECKING:
    from vopd.flight.solve.joint import JointSolution


LANDMARKS, LANDMARK, MOUNT = "landmarks", "landmark:", "mount"
FREE = {
    "focal": ("focal",),
    "aspect": ("aspect",),  # fy over fx
    "centre": ("centre_u", "centre_v"),
    "k1": ("k1",),
    "k2": ("k2",),
    "p1p2": ("p1", "p2"),
    "clock": ("clock",),  # frames later than the track
    "clock-rate": ("clock_rate",),
    "readout": ("readout",),
    "track-offset": SHIFT,
}
"""Parameters of `vopd.flight.solve.equations` by the names that `[solve] free` and `--free` take.

Landmarks are no rows: they are solved for in any case, and only reported.
"""

OF_A_LENS = ("focal", "aspect", "centre", "k1", "k2", "p1p2")  # those of them that are of the lens
SHOWN_NAME = {"clock_rate": "clock-rate"} | {axis: f"track-offset {axis}" for axis in SHIFT}
"""Parameters that a table names otherwise."""
COMMON = {
    ("uncertainty", "focal_rel"): ("focal",),
    ("uncertainty", "principal_px"): ("centre_u", "centre_v"),
    ("uncertainty", "k1"): ("k1",),
    ("uncertainty", "k2"): ("k2",),
    ("uncertainty", "p1p2"): ("p1", "p2"),
    ("track", "sigma_t_s"): ("clock",),
    ("uncertainty", "clock_rate_ppm"): ("clock_rate",),
    ("uncertainty", "readout_ms"): ("readout",),
    ("atmosphere", "sigma_k"): ("refraction",),
}
"""Parameters whose standard deviations a key states, by section and key."""
UNIT = {
    **dict.fromkeys(("focal", "centre_u", "centre_v"), "px"),
    **{"clock": "s", "clock_rate": "ppm", "readout": "ms"},
    **dict.fromkeys(SHIFT, "m"),
}
"""Units in a table; 1 for the others."""
FACTOR = {"clock_rate": 1e6, "readout": 1e3}
"""Values in a table over those of `vopd.flight.solve.equations`."""


def names_of(text: str, landmarks: Sequence[str] = ()) -> list[str]:
    """Split a list of names at commas; at spaces too, but for landmarks'. Each is there once.

    Args:
        text: the list
        landmarks: names that are known, whose own commas split nothing
    """
    whole = sorted((re.escape(LANDMARK + one) for one in landmarks if "," in one), key=len)
    own = "|".join([*(rf"{one}(?=\s*(?:,|$))" for one in whole[::-1]), "[^,]*"])
    parts = [part.strip() for part in re.findall(rf"(?:^|,)\s*({own})", text)]
    each = ([part] if part.startswith(LANDMARK) else part.split() for part in parts)
    return list(dict.fromkeys(name for names in each for name in names))


def free_parameters(flight: Flight) -> tuple[str, ...]:
    """List the parameters that a flight is solved for by `options.free`, in the order of `FREE`."""
    options = flight.options
    kept = {one.name for one in options.kept}
    if flight.path.turning_rad_s is None:  # a readout shows by them alone
        kept.add("readout")
    named = [p for name, own in FREE.items() if name in options.free for p in own]
    return tuple(name for name in named if name not in kept)


def prior_sigma(flight: Flight, parameter: str) -> float:
    """Look up the prior standard deviation of a parameter; infinite where none is stated."""
    if parameter in SHIFT:
        bias = flight.path.bias_sigma_m
        return float(bias[SHIFT.index(parameter)]) if bias.any() else float("inf")
    return flight.options.parameter_sigma.get(parameter, float("inf"))


def free_landmarks(flight: Flight) -> list[int]:
    """List the landmarks that are reported, by their indices."""
    marks, free = flight.landmarks, flight.options.free
    seen = np.bincount(flight.picks.landmark, minlength=len(marks.name)) > 0
    used = marks.used or (True,) * len(marks.name)
    uncertain = np.asarray(marks.sigma_m.any(axis=1))
    return [
        k
        for k, name in enumerate(marks.name)
        if (LANDMARK + name in free or LANDMARKS in free) and seen[k] and used[k] and uncertain[k]
    ]


# What cannot be freed


def check_free(flight: Flight) -> None:
    """Refuse names in `options.free` that are not known, or that this flight does not have.

    Raises:
        VopdError: saying what to write instead
    """
    for name in flight.options.free:
        message = _refused(flight, name)
        if message:
            raise VopdError(f"{flight.source}: free {name}: {message}")


def _refused(flight: Flight, name: str) -> str:
    """Say why a name cannot be freed; empty if it can."""
    if name == LANDMARKS or name.startswith(LANDMARK):
        return _refused_landmark(flight, name)
    if name == MOUNT:
        if flight.vehicle is not None:
            return ""
        return (
            "no pick depends on how the camera is mounted, which turns the vehicle's angles and "
            "not the camera's: name a file with the vehicle's attitudes in [vehicle] attitude (or "
            "the folder of images whose tags have those of the gimbal), or measure it, state it in "
            "[vehicle] mount, and its error in mount_sigma_deg"
        )
    if name not in FREE:
        known = (*FREE, LANDMARKS, MOUNT, f"{LANDMARK}NAME")
        return f"there is no such parameter{did_you_mean(name, known)}"
    parameters, path = FREE[name], flight.path
    if isinstance(flight.lens, Lenses) and name in OF_A_LENS:
        return (
            f"the images have {len(flight.lens.each)} lenses ([camera] of_images), and one is "
            "solved for at a time: leave it out, or write a project for the images of each camera"
        )
    if name in OF_A_LENS and parameters[0] not in parameters_of(flight.lens):
        return lacking_text(flight.lens, name)
    if name == "aspect" and flight.lens.kind is LensKind.RADIAL_TABLE:  # no project could say it
        return "a radial table has one focal length: leave aspect out"
    if name in ("clock", "clock-rate") and path.velocity_m_s is None:
        why = "stands still" if path.stands else "has positions that belong to images"
        return f"the camera {why}, and no clock moves it: leave {name} out"
    if name == "readout" and flight.shutter is None:
        return "[camera] has no rolling shutter: add readout_ms, readout and frame_time"
    if name == "track-offset" and path.stands:
        return (
            "the camera does not move: its place is solved for within [position] sigma_m "
            "already. Leave track-offset out"
        )
    exact = any(prior_sigma(flight, parameter) == 0.0 for parameter in parameters)
    if name == "track-offset":
        exact = not path.bias_sigma_m.any() and "bias" in flight.options.exact
    if exact:
        rather = "" if name == "clock" else ", or leave the key out where nothing is known"
        return (
            f'{_key_of(parameters[0])} calls it "exact": state a standard deviation there{rather}'
        )
    return ""


def _key_of(parameter: str) -> str:
    """Name the key that states a parameter's standard deviation; empty if none does."""
    if parameter in SHIFT:
        return "[track] sigma_bias_m"
    keys = (f"[{section}] {key}" for (section, key), own in COMMON.items() if parameter in own)
    return next(keys, "")


def _refused_landmark(flight: Flight, name: str) -> str:
    """Say why landmarks cannot be freed; empty if they can."""
    marks, wanted = flight.landmarks, name.removeprefix(LANDMARK)
    if not flight.options.solve_position:
        return '[solve] position = "fixed" holds all landmarks: leave that key out'
    if name == LANDMARKS:
        if marks.sigma_m.any():
            return ""
        return "all landmarks are exact: state [landmarks] sigma_m, metres, as 0.05 by survey"
    if wanted not in marks.name:
        return f"there is no landmark {wanted}{did_you_mean(wanted, marks.name[:20])}"
    k = marks.name.index(wanted)
    if marks.used and not marks.used[k]:
        return "it is in [solve] check_landmarks, and takes no part: take it out of that list"
    frames = flight.picks.frame[flight.picks.landmark == k]
    if not len(frames):
        return "no frame shows it: pick it in some, better in frames far from each other"
    count = np.bincount(flight.picks.frame, minlength=len(flight.frame))
    if not (count[frames] > 1).any():
        return (
            "it is alone in its frames, which so have no attitude: pick a second landmark there, "
            "whose coordinates are known"
        )
    if not marks.sigma_m[k].any():
        return (
            "it is exact: state how uncertain it is, in the landmarks' file a column sigma_m with "
            f"a number in the row of {wanted} (100 where next to nothing is known)"
        )
    return ""


# A flight with its parameters as solved


def as_solved(flight: Flight, joint: JointSolution) -> Flight:
    """Put values of freed parameters and clicks, and what is left of their errors, into a flight.

    Landmarks, fixes of the track and the place of a camera that stands stay where they are
    stated; nothing is free any more.

    Args:
        flight: the flight, whose picks are not scaled
        joint: its solution
    """
    model, state = joint.model, joint.state
    if model.clicks is not None:
        flight = _as_clicked(flight, joint)
    if not flight.options.free:
        return flight
    variance = np.diag(joint.factored.common)[: len(model.names)]
    after = dict(zip(model.names, np.sqrt(variance).tolist(), strict=True))
    freed = [name for name in free_parameters(flight) if name in after]
    parameter = np.where(np.isin(model.names, freed), state.parameter, 0.0)
    given = state._replace(parameter=parameter, fix_m=np.zeros_like(state.fix_m))
    path = flight.path
    moved = model.moved_m(given)
    position = path.position_m + np.einsum("fji,fj->fi", model.axes, moved)
    path = path.later(model.late_s(given))
    bias = path.bias_sigma_m
    if set(SHIFT) & set(freed):
        bias = np.array([after.get(name, own) for name, own in zip(SHIFT, bias, strict=True)])
    sigma = dict(flight.options.parameter_sigma)
    sigma |= {name: after[name] for name in freed if name not in SHIFT}
    solved = replace(
        flight,
        lens=with_parameters(flight.lens, model.names, parameter),
        path=replace(path, position_m=position, bias_sigma_m=bias),
        options=replace(flight.options, free=(), kept=(), parameter_sigma=sigma),
    )
    more_s = model.value(given, "readout")
    if more_s and flight.shutter is not None and path.turning_rad_s is not None:
        later = replace(solved, shutter=replace(flight.shutter, readout_s=more_s))
        shift = row_shifts_px(later, state.rotation, later.pick_range_m)
        total = replace(flight.shutter, readout_s=flight.shutter.readout_s + more_s)
        picks = replace(solved.picks, pixel=solved.picks.pixel - shift)
        solved = replace(solved, picks=picks, shutter=total)
    return solved


def _as_clicked(flight: Flight, joint: JointSolution) -> Flight:
    """Take the errors of clicks off the picks, and leave what is not known of them."""
    from vopd.flight.solve.clicks import ClickEquations  # of few flights

    model, picks = joint.model, flight.picks
    clicks = picks.clicks
    assert clicks is not None
    every = ClickEquations(clicks, np.arange(len(picks.frame)))
    left = np.asarray(joint.factored.common)[model.of_clicks, model.of_clicks]
    at = (2 * model.clicked[:, None] + np.arange(2)).ravel()
    root = np.diag(np.repeat(clicks.sigma_px, 2))
    root[np.ix_(at, at)] = np.linalg.cholesky((left + left.T) / 2.0)
    sigma_px = np.sqrt((root**2).sum(axis=1).reshape(-1, 2).mean(axis=1))
    pixel = picks.pixel - every.shift_px(joint.state.click_px)
    clicks = replace(clicks, sigma_px=sigma_px, root=root)
    return replace(flight, picks=replace(picks, pixel=pixel, clicks=clicks))


def stated_value(flight: Flight, parameter: str) -> float:
    """Look up the value of a parameter before the solve, in the units of a table.

    Args:
        flight: as it was read
        parameter: of `vopd.flight.solve.equations`
    """
    lens = flight.lens
    coefficients: Sequence[str] = LENS_COEFFICIENTS[lens.kind]
    if parameter in coefficients:
        return float(lens.k[coefficients.index(parameter)])
    readout = 0.0 if flight.shutter is None else flight.shutter.readout_s
    values = {
        "focal": float(lens.focal_px.mean()),
        "aspect": float(lens.focal_px[1] / lens.focal_px[0]),
        "centre_u": float(lens.centre_px[0]),
        "centre_v": float(lens.centre_px[1]),
        "readout": FACTOR["readout"] * readout,
    }
    return values.get(parameter, 0.0)


def unit_factor(flight: Flight, parameter: str) -> float:
    """Look up by how much a parameter is larger in the units of a table.

    Args:
        flight: as it was read
        parameter: of `vopd.flight.solve.equations`
    """
    if parameter == "aspect":
        return stated_value(flight, parameter)
    return FACTOR.get(parameter, 1.0)


def shown_name(parameter: str, stands: bool = False) -> str:
    """Name a parameter as tables do.

    Args:
        parameter: of `vopd.flight.solve.equations`
        stands: whether the camera does
    """
    if stands and parameter in SHIFT:
        return f"position {parameter}"
    return SHOWN_NAME.get(parameter, parameter)


def value_text(parameter: str, value: float, sigma: float, sign: str = "") -> str:
    """Write the value of a parameter and its standard deviation, with the digits that this has.

    Args:
        parameter: of `vopd.flight.solve.equations`
        value: in the units of a table
        sigma: likewise; infinite: there is none
        sign: "+" writes it before positive values
    """
    unit, digits = UNIT.get(parameter, ""), decimals(sigma)
    if digits is None:
        return f"{value:{sign}.7g} {unit}".rstrip()
    return f"{value:{sign}.{digits}f} +- {size_text(sigma)} {unit}".rstrip()


def decimals(sigma: float) -> int | None:
    """Choose as many decimals for a value as show two digits of its standard deviation.

    Returns:
        Their number; None where the standard deviation is none.
    """
    if not (np.isfinite(sigma) and sigma > 0.0):
        return None
    return int(np.clip(1 - np.floor(np.log10(sigma)), 0, 12))


def free_text(joint: JointSolution, covariance: Floats) -> str:
    """Say which parameters were solved for, what they are now, and which were kept.

    Args:
        joint: the solution of a flight in which some are free
        covariance: of what is common to the flight, (K, K)
    """
    model, flight = joint.model, joint.model.flight
    sigma = np.sqrt(np.diag(covariance))
    parts = []
    for name in free_parameters(flight):
        k, factor = model.names.index(name), unit_factor(flight, name)
        before = stated_value(flight, name)
        after = before + factor * float(joint.state.parameter[k])
        text = value_text(name, after, factor * float(sigma[k]))
        parts.append(f"{shown_name(name)} {text} ({before:.7g} stated)")
    kept = [shown_name(one.name) for one in flight.options.kept]
    if kept:
        parts.append(f"kept as stated, as the picks do not hold them: {', '.join(kept)}")
    return "; ".join(parts) or "landmarks"


# Parameters that the picks do not hold


def without_parameter(flight: Flight, lost: NotHeld) -> Flight:
    """Keep a parameter as it is stated."""
    return replace(flight, options=replace(flight.options, kept=(*flight.options.kept, lost)))


ADVICE = {
    "focal": "landmarks near and far, or frames from other places, would hold it",
    "aspect": "landmarks all over the image would hold it",
    "centre_u": "a moved principal point makes the images of yaw and pitch, but in wide pictures",
    "centre_v": "a moved principal point makes the images of yaw and pitch, but in wide pictures",
    "k1": "landmarks in the corners of the images as well as in the middle would hold it",
    "k2": "landmarks in the corners of the images as well as in the middle would hold it",
    "p1": "the tangential part is small, and a centre makes nearly the same images",
    "p2": "the tangential part is small, and a centre makes nearly the same images",
    "clock": "a track that turns, or is flown both ways, would hold it",
    "clock_rate": "a longer flight would hold it",
    "readout": "frames in which the camera turns fast would hold it",
    **dict.fromkeys(SHIFT, "landmarks on more than one side would hold it"),
}
"""What would hold a parameter."""


def not_held_findings(flight: Flight) -> list[Finding]:
    """Warn of parameters that were to be free and are kept.

    An axis that is exact among others (`sigma_bias_m = [1, 1, 0]`) is kept as it is meant.
    """
    kept = [one for one in flight.options.kept if prior_sigma(flight, one.name) > 0.0]
    texts = [_not_held_text(flight, one) for one in kept]
    return [Finding(text, flight.source, severity="warning") for text in texts]


def _not_held_text(flight: Flight, lost: NotHeld) -> str:
    prior = prior_sigma(flight, lost.name)
    why = f"it trades with {joined(lost.trades_with)}"
    if not lost.trades_with:
        why = "what is left of it moves an angle by more than its half-width"
        if np.isfinite(prior):
            part = min(lost.sigma / prior, 1.0)
            why = f"the picks leave {part:.2f} of its stated standard deviation"
    value = f"{stated_value(flight, lost.name):.7g} {UNIT.get(lost.name, '')}".rstrip()
    if lost.spoiled_by:
        by = next((n for n, own in FREE.items() if lost.spoiled_by in own), "")
        advice = f"Free {by} as well" if by else f"A better {lost.spoiled_by} would hold it"
        return (
            f"free {shown_name(lost.name)}: the picks hold it, but not beside the error of "
            f"{shown_name(lost.spoiled_by)}, which is stated and not solved for, and it stays "
            f"{value}. {advice}"
        )
    key = _key_of(lost.name)
    rather = f": state {key} instead" if key and not np.isfinite(prior) else ""
    advice = ADVICE[lost.name]
    return (
        f"free {shown_name(lost.name)}: the picks do not hold it, and it stays {value}; {why}. "
        f"{advice[:1].upper()}{advice[1:]}{rather}"
    )


def joined(names: Sequence[str]) -> str:
    """List names in a sentence: `a, b and c`."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))
