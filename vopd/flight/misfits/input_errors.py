"""Errors of a flight's inputs: which of them its residuals speak for, how large, by what chance.

An error of an input that changes the images by d a unit has the estimate d'Wr / d'Wd with the
variance 1 / d'Wd: W weighs the residuals r as all that is stated does, once everything else is
fitted. That takes no other solve. Where one is significant, the flight is solved again with each
error unknown, and these solutions are compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc

from vopd.arrays import Floats
from vopd.attitude.residuals import SIGNIFICANCE, chance_text
from vopd.findings import VopdError
from vopd.flight.flight import CameraPath, Flight, Shutter
from vopd.flight.solve.equations import LENS_COEFFICIENTS, SHIFT, Priors, Readout
from vopd.flight.solve.errors import every_prior, priors_of
from vopd.flight.solve.free import value_text
from vopd.flight.solve.joint import (
    JointSolution,
    covariance_of_sums,
    propagated,
    solve_jointly,
    weighed,
)
from vopd.flight.solve.readout import LONG_READOUT, part_of_interval, row_parts, turning_rates
from vopd.flight.solve.rotations import FlightBlocks, FlightPart
from vopd.flight.solve.sizes import size_of_errors
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.lenses import Lenses, LensKind

REJECTED = 1.5  # times the stated standard deviation of a pick
ALIKE = 6.0  # in chi-square: errors that explain the residuals as well
CHANCE_LIKENESS = 400.0  # in chi-square: 20 sigmas, which have a line by chance once in 400
MOST_PICKS = 6_000  # of a longer flight frames are drawn: it is solved a dozen times
MOST_LANDMARKS = 40  # that are tried one by one
LEAST_FREEDOM = 4.0  # beside what is tried
MOST_UNSETTLED = 2  # trials that do not converge: after more of them no other error is tried
MOST_SOLVED = 2  # landmarks with which a flight is solved again
PLAIN = 4.0  # times the least gain: an error is named whatever it does to angles
MOST_LEFT = 0.1  # of the residuals' squares, where an error is named that leaves a misfit
MOVES = 1.0  # standard deviations of an angle: an error that moves none by more does no harm
NOTHING_SHOWS = 1e-9  # of an error's squares in the image: less is rounding
CENTRE = ("centre_u", "centre_v")
USUAL = {
    "clock": 10.0, "clock_rate": 0.3, "focal": 0.3, "k1": 0.3, "refraction": 0.3, "readout": 0.03,
    "east": 100.0, "north": 100.0, "up": 100.0, "centre_u": 100.0, "centre_v": 100.0,
}  # fmt: skip
"""Sizes of errors as they happen, standard deviations: s, px a px, m, px of the principal point; a
landmark's is that up."""
SPEAK_FOR = "the residuals speak for"
SHIFTED = f"{SPEAK_FOR} a picture that is shifted from frame to frame"
OF_LANDMARK = "are its coordinates and its name right?"


TYPICAL = "in a typical frame"
UNEXPLAINED = (
    "no usual mistake explains them; look at the coordinates and names of the landmarks, at the "
    "camera's positions, at the lens (of this camera, at this image size?), and at what the "
    "frames' numbers and times mean"
)


class TriedError(NamedTuple):
    """An error of the inputs that a flight may have: where its columns are, and its words."""

    columns: tuple[int, ...]
    text: Callable[[Floats, Floats], str]  # by its values and their standard deviations
    parameters: tuple[str, ...] = ()  # of `vopd.flight.solve.equations`; a landmark's: none
    landmark: int = -1  # index of the one that it is of


class Significant(NamedTuple):
    """An error of the inputs that the residuals speak for."""

    error: TriedError
    value: Floats  # of its columns
    sigma: Floats  # their standard deviations
    chance: float
    gain: float  # in chi-square
    evidence: float  # the gain, less what its values cost (Schwarz)
    rest: float  # variance of what it leaves, in those of the picks


def significant_errors(
    joint: JointSolution, known: bool, expected_px: float | None = None
) -> list[Significant]:
    """Find the errors of the inputs that explain the residuals best; empty if there is none.

    All trials together find one where there is none in `SIGNIFICANCE` of flights. The flight is
    then solved again with each error unknown under its `USUAL` size. One explains it if it leaves
    what is stated, or a tenth of the squares; that of the most evidence is named, with those that
    explain as well: by the evidence or by the gain, to `ALIKE`; more values beside fewer only
    where they may do so by chance. None is named where none of these moves an angle, or its
    mean over the frames, by more than its standard deviation, unless it is `PLAIN`.

    Args:
        joint: the solution of a flight
        known: whether the standard deviation of the picks is stated, and believed
        expected_px: standard deviation of a pick where nothing is wrong; None: that in force
    """
    path, stated = even_path(joint), joint.stated[1]
    errors, trial = input_errors(joint, path)
    first = _first_order(joint, known, errors, trial, stated)
    limit = SIGNIFICANCE / max(len(first), 1)
    if not first or min(one.chance for one in first) > limit:
        return []
    marks = sorted((o for o in first if o.error.landmark >= 0), key=lambda one: -one.evidence)
    tried = [one.error for one in first if one.error.landmark < 0]
    tried += [one.error for one in marks[:MOST_SOLVED]]
    found = [
        one for one in _solved_again(joint, known, expected_px, tried, path) if one.chance <= limit
    ]
    found.sort(key=lambda one: -one.evidence)
    most = max((one.gain for one in found), default=0.0)
    alike = [
        one
        for one in found
        if (one.evidence > found[0].evidence - ALIKE or one.gain > most - ALIKE)
        and (len(one.value) <= len(found[0].value) or most < CHANCE_LIKENESS)
    ]
    if not alike or alike[0].gain > PLAIN * float(chdtri(len(alike[0].value), limit)):
        return alike
    moving = any(_moves_an_angle(joint, trial, stated, one) for one in alike)
    return alike if moving else []


def _first_order(
    joint: JointSolution, known: bool, errors: list[TriedError], trial: Floats, stated: Floats
) -> list[Significant]:
    """Estimate each error that the picks can tell, to first order, and test it.

    Args:
        joint: the solution of a flight
        known: whether the standard deviation of the picks is stated, and believed
        errors: that are tried
        trial: changes of the images by them, (P, 2, K)
        stated: changes by errors that are stated and not solved for, (P, 2, C)
    """
    square, right = weighed(joint, np.concatenate([stated, trial], axis=2))
    fixed, cost = stated.shape[2], joint.normal.cost
    if fixed:  # what is stated and not solved for is a part of the residuals' covariance
        by_stated = np.linalg.solve(
            np.eye(fixed) + square[:fixed, :fixed],
            np.column_stack([square[:fixed, fixed:], right[:fixed]]),
        )
        cost -= float(right[:fixed] @ by_stated[:, -1])
        right = right[fixed:] - square[fixed:, :fixed] @ by_stated[:, -1]
        square = square[fixed:, fixed:] - square[fixed:, :fixed] @ by_stated[:, :-1]
    power, freedom, found = (trial**2).sum(axis=(0, 1)), residuals_freedom(joint), []
    for one in errors:
        index = list(one.columns)
        own, scale = square[np.ix_(index, index)], np.sqrt(power[index])
        seen = np.diag(own) > NOTHING_SHOWS * power[index]
        if not seen.all() or freedom - len(index) < LEAST_FREEDOM:
            continue
        scaled = own / scale[:, None] / scale
        if np.linalg.cond(scaled) > 1.0 / NOTHING_SHOWS:
            continue
        value = np.linalg.solve(scaled, right[index] / scale) / scale
        sigma = np.sqrt(np.diag(np.linalg.inv(scaled))) / scale
        gain = float(right[index] @ value)
        rest = max((cost - gain) / (freedom - len(index)), joint.model.flight.picks.least_variance)
        found.append(
            Significant(
                one, value, sigma, _chance(joint, known, len(index), gain, rest), gain, gain, rest
            )
        )
    return found


def residuals_freedom(joint: JointSolution) -> float:
    """Count the degrees of freedom of the residuals, with errors that are stated taken as known."""
    free = (~np.isfinite(joint.model.common_sigma)).sum()
    return float(2.0 * len(joint.model.pick) - 3.0 * joint.model.solved - free)


def _chance(joint: JointSolution, known: bool, count: int, gain: float, rest: float) -> float:
    """Test the gain of some values in chi-square, by F where the variance is not known."""
    if known and rest < REJECTED**2:
        return float(chdtrc(count, gain))
    return float(fdtrc(count, residuals_freedom(joint) - count, gain / count / rest))


def _solved_again(
    joint: JointSolution, known: bool, expected_px: float | None, errors: list[TriedError],
    path: CameraPath,
) -> list[Significant]:  # fmt: skip
    """Solve a flight with each error unknown in turn, and find those that explain its residuals.

    Estimates to first order fail where an error is large: three values then seem to explain more
    than the right one. A value costs the logarithm of the number of residuals (Schwarz, Estimating
    the dimension of a model, Annals of Statistics 6, 1978), and its square over its usual size.

    Args:
        joint: the solution of the flight
        known: whether the standard deviation of the picks is stated, and believed
        expected_px: standard deviation of a pick where nothing is wrong; None: that in force
        errors: those tried
        path: the camera's, without the noise of its fixes
    """
    flight, priors = joint.model.flight, joint.model.priors
    sigma_px = expected_px or flight.picks.one_sigma_px
    flight = replace(flight, path=path, picks=flight.picks.with_sigma(sigma_px))
    priors = replace(priors, parameter={**priors.parameter, **joint.stated[0]})
    without = _solved_with(joint, flight, priors)
    if without is None:
        return []
    freedom, cost = residuals_freedom(joint), without.normal.cost
    solved: list[tuple[TriedError, JointSolution, float]] = []
    unsettled = 0
    for one in errors:
        again = _solved_with(joint, flight, priors, one)
        if again is not None and not again.settles:
            unsettled += 1
            if unsettled > MOST_UNSETTLED:
                break
        elif again is not None:
            rest = again.normal.cost / (freedom - len(one.columns))
            solved.append((one, again, max(rest, flight.picks.least_variance)))
    least = min((rest for *_, rest in solved), default=1.0)
    variance = 1.0 if known and least < REJECTED**2 else least
    # matches that are better than stated make no click better
    of_values = variance if flight.picks.clicks is None else max(variance, 1.0)
    found = []
    for one, again, rest in solved:
        left = 0.0 if unsettled > MOST_UNSETTLED else MOST_LEFT * cost / freedom
        if rest > max(REJECTED**2, left):  # where hardly a trial converges, all is explained
            continue
        if one.landmark >= 0:
            place = int(np.searchsorted(again.model.free, one.landmark))
            index = len(again.model.names) + 3 * place + np.arange(3)
            value = again.state.landmark_m[one.landmark]
        else:
            index = np.array([again.model.names.index(name) for name in one.parameters])
            value = again.state.parameter[index]
        sigma = np.sqrt(of_values * np.diag(np.asarray(again.factored.common))[index])
        gain = max(cost - again.normal.cost, 0.0)
        chance = _chance(joint, known, len(index), gain, rest)
        gain /= variance
        evidence = gain - len(index) * float(np.log(2.0 * len(joint.model.pick)))
        found.append(Significant(one, value, sigma, chance, gain, evidence, rest))
    return found


def _solved_with(
    joint: JointSolution, flight: Flight, priors: Priors, one: TriedError | None = None
) -> JointSolution | None:
    """Solve a flight from its solution with an error unknown; None if there is no solution."""
    parameter, landmark_m, readout = dict(priors.parameter), priors.landmark_m, None
    if one is not None and one.landmark >= 0:
        landmark_m = np.array(joint.state.landmark_m * 0.0 if landmark_m is None else landmark_m)
        landmark_m[one.landmark] = USUAL["up"]
    elif one is not None:
        usual = {**USUAL, "focal": USUAL["focal"] * float(flight.lens.focal_px.mean())}
        parameter |= {name: usual[name] for name in one.parameters}
        readout = _readout(joint) if "readout" in one.parameters else None
    value = np.array([joint.model.value(joint.state, name) for name in parameter])
    priors = replace(priors, parameter=parameter, landmark_m=landmark_m)
    start, since_s = joint.state._replace(parameter=value), _since_first_s(flight)
    try:
        return solve_jointly(
            flight, priors, joint.model.used, start, readout, joint.solved, since_s
        )
    except VopdError:
        return None


def _moves_an_angle(joint: JointSolution, trial: Floats, stated: Floats, one: Significant) -> bool:
    """Tell whether an error turns a frame, or all in the mean, by more than may be neglected."""
    columns = trial[..., list(one.error.columns)] @ one.value[:, None]
    turn, _, _ = propagated(joint, np.concatenate([columns, stated], axis=2))
    variance = np.einsum("fii->fi", joint.covariance.turn) + (turn[..., 1:] ** 2).sum(axis=2)
    with np.errstate(invalid="ignore"):
        if (np.abs(turn[..., 0]) > MOVES * np.sqrt(variance)).any():
            return True
    weight = np.tile(np.eye(3) / joint.model.solved, (joint.model.frames, 1, 1))
    mean = turn.sum(axis=0) / joint.model.solved
    own, _ = covariance_of_sums(joint, weight)
    variance = np.diag(own) + (mean[:, 1:] ** 2).sum(axis=1)
    return bool((np.abs(mean[:, 0]) > MOVES * np.sqrt(variance)).any())


def input_errors(joint: JointSolution, path: CameraPath) -> tuple[list[TriedError], Floats]:
    """List the errors that are tried, and differentiate the images by them.

    Returns:
        The errors, and the changes of the computed images by a unit of each of their columns, in
        standard deviations of the picks, (P, 2, K).
    """
    model, flight = joint.model, joint.model.flight
    timed = flight.path.velocity_m_s is not None and flight.path.acceleration_m_s2 is not None
    names, one_lens = list(SHIFT), not isinstance(flight.lens, Lenses)
    names += ["focal", *CENTRE] if one_lens else []
    names += ["k1"] if one_lens and "k1" in LENS_COEFFICIENTS[flight.lens.kind] else []
    names += ["refraction"] if flight.refraction.k else []
    names += ["clock", "clock_rate"] if timed else []
    readout = _readout(joint) if timed else None
    names += ["readout"] if readout is not None else []
    more = {name: 1.0 for name in names if name not in model.names}
    full = model.with_priors(replace(model.priors, parameter={**model.priors.parameter, **more}))
    full.readout = readout
    start = joint.state._replace(
        parameter=np.concatenate([joint.state.parameter, np.zeros(len(more))])
    )
    marks = np.unique(model.landmark)
    marks = marks[: len(marks) * (len(marks) <= MOST_LANDMARKS)]
    out = np.zeros((len(model.pick), 2, len(names) + 3 * len(marks)))
    where = [full.names.index(name) for name in names]
    slot = np.full(len(flight.landmarks.name), -1)
    slot[marks] = np.arange(len(marks))
    since_s = _since_first_s(flight)
    velocity = np.zeros((model.frames, 3))
    if path.velocity_m_s is not None:
        velocity = np.nan_to_num(path.velocity_m_s @ NED_FROM_ENU)
    for rows in full.rows(start):
        out[rows.picks, :, : len(names)] = rows.by_parameter[..., where]
        if timed:
            moved = (rows.by_place @ velocity[rows.frames, None, :, None])[..., 0]
            out[rows.picks, :, names.index("clock")] = moved
            later = moved * since_s[rows.frames, None, None]
            out[rows.picks, :, names.index("clock_rate")] = later
        own = slot[model.landmark[rows.picks]]
        if len(marks):
            for axis in range(3):
                flat = rows.picks.ravel()
                column = len(names) + 3 * own.ravel() + axis
                out[flat, :, column] = rows.by_landmark[..., axis].reshape(-1, 2)
    errors = [*_common_errors(flight, names)]
    for k, mark in enumerate(marks):
        first = len(names) + 3 * k
        columns = (first, first + 1, first + 2)
        errors.append(TriedError(columns, _landmark_text(flight, int(mark)), (), int(mark)))
    return errors, out


def even_path(joint: JointSolution) -> CameraPath:
    """Take the noise of the fixes out of velocity and acceleration.

    Where the positions are as near to an even motion, or to one that changes evenly, as their
    standard deviations allow, these are that motion's; else they stay what they are.
    """
    flight = joint.model.flight
    path, time_s = flight.path, flight.time_s
    if path.velocity_m_s is None or path.fixes is None:
        return path
    known = np.isfinite(time_s) & joint.model.velocity_m_s.any(axis=1)
    if known.sum() < 4:
        return path
    away_m = path.position_m - path.position_m[known][0]
    place_m = np.einsum("fij,fj->fi", joint.model.axes, away_m)[known]
    since_s = time_s[known] - time_s[known].mean()
    noise = float((path.fixes.sigma_m**2).mean())
    for degree in (1, 2):
        powers = since_s[:, None] ** np.arange(degree + 1)
        fit, *_ = np.linalg.lstsq(powers, place_m, rcond=None)
        if ((place_m - powers @ fit) ** 2).mean() < 2.0 * noise:
            velocity, acceleration = (np.full_like(path.velocity_m_s, np.nan) for _ in range(2))
            rate = np.arange(1, degree + 1)
            velocity[known] = (powers[:, :-1] * rate) @ fit[1:] @ NED_FROM_ENU
            acceleration[known] = (2.0 * fit[2] if degree == 2 else np.zeros(3)) @ NED_FROM_ENU
            return replace(path, velocity_m_s=velocity, acceleration_m_s2=acceleration)
    return path


def _since_first_s(flight: Flight) -> Floats:
    """Times since that from which a wrong frame rate counts, (F,); 0 where not known."""
    if flight.frame_rate_hz is not None:
        return np.asarray(flight.frame / flight.frame_rate_hz)
    known = np.isfinite(flight.time_s)
    first_s = flight.time_s[known].min() if known.any() else 0.0
    return np.nan_to_num(flight.time_s - first_s)


WHOLE_FRAMES = 0.3  # of a frame: a standard deviation that still tells whole frames apart
MOST_FRAMES = 5.5  # by which numbers are taken to be off: more are whole by chance
HALF_SIZE = (1.8, 2.2)  # ratio of focal lengths that a picture of half the size would have


def _frames_off_text(frames: float, sigma: float) -> str:
    """Say that the clocks differ by whole frames, if they do: their numbers may be off."""
    count = round(frames)
    whole = abs(frames - count) < max(2.0 * sigma, 0.05) and sigma < WHOLE_FRAMES
    if not count or not whole or abs(frames) > MOST_FRAMES:
        return ""
    return f" (as if the frames' numbers were {abs(count)} too {'high' if count > 0 else 'low'})"


def _other_size_text(ratio: float) -> str:
    """Say that a focal length is near half or twice the stated one: of pictures of another size."""
    least, most = HALF_SIZE
    if not least < max(ratio, 1.0 / ratio if ratio else 0.0) < most:
        return ""
    size = "half the size" if ratio > 1.0 else "twice the size"
    return f" (near that of a calibration at {size} of the images: [camera] lens_size_px)"


OTHER_MODEL = {LensKind.BROWN: LensKind.FISHEYE, LensKind.FISHEYE: LensKind.BROWN}
THIRD, NEAR_THIRD = 1.0 / 3.0, 0.1  # k1 of the other model is as much more: tan t = t + t^3/3
NEAR_NONE = 0.35  # of the stated k1: what remains of it in pictures without distortion
MOST_ALIKE = 2.0  # times the stated k1, as which one of the other sign may be


def of_other_model(kind: LensKind) -> float:
    """Say by how much k1 of the other model's lens is more than that of a lens with its images."""
    return THIRD if kind is LensKind.FISHEYE else -THIRD


def of_stated_text(k1: float, stated: float) -> str:
    """Say that a k1 is near 0, or has the other sign than the stated one; empty if neither."""
    if abs(k1) < NEAR_NONE * abs(stated):
        return "near 0: were the pictures free of distortion already?"
    if stated and -MOST_ALIKE < k1 / stated < 0.0:
        return "of the other sign: does the calibration lead from distorted pixels to true ones?"
    return ""


def _of_another_kind_text(kind: LensKind, k1: float, sigma: float, stated: float) -> str:
    """Say that a k1 is near 0, has the other sign, or is that of the other model's lens."""
    hints = []
    if abs(k1 - stated - of_other_model(kind)) < NEAR_THIRD:
        hints.append(f'as if the coefficients were those of model = "{OTHER_MODEL[kind].value}"')
    if abs(stated) >= 5.0 * sigma and (hint := of_stated_text(k1, stated)):
        hints.append(hint)
    return f" ({', or '.join(hints)})" if hints else ""


def _common_errors(flight: Flight, names: list[str]) -> Iterator[TriedError]:
    """List the errors of inputs that are one for the flight, the simplest first."""
    lens = flight.lens

    def at(*some: str) -> tuple[int, ...]:
        return tuple(names.index(name) for name in some)

    def keyed(name: str, stated: float, key: str) -> Callable[[Floats, Floats], str]:
        return lambda v, s: (
            f"{key}{value_text(name, stated + v[0], s[0])} in the place of {stated:.5g}"
        )

    if "clock" in names:
        given_s, rate_hz = flight.offset_s, flight.frame_rate_hz or 0.0
        yield TriedError(
            at("clock"),
            lambda v, s: (
                "clocks of track and frames that differ, [track] offset_s = "
                f"{value_text('', given_s - v[0], s[0])} in the place of {given_s:g}"
                + _frames_off_text(-v[0] * rate_hz, s[0] * rate_hz)
            ),
            ("clock",),
        )
        yield TriedError(at("clock_rate"), _rate_text(flight), ("clock_rate",))
    if "focal" in names:
        focal_px = float(lens.focal_px.mean())
        focal = keyed("focal", focal_px, "[camera] lens: a focal length of ")

        def focal_text(value: Floats, sigma: Floats) -> str:
            """Name it above 0: with the other sign the image is the same, turned by half a turn."""
            value = np.abs(focal_px + value) - focal_px
            return focal(value, sigma) + _other_size_text((focal_px + value[0]) / focal_px)

        yield TriedError(at("focal"), focal_text, ("focal",))
    if "k1" in names:
        stated_k1 = float(lens.k[0])
        k1 = keyed("", stated_k1, "[camera] lens: k1 = ")
        yield TriedError(
            at("k1"),
            lambda v, s: (
                k1(v, s) + _of_another_kind_text(lens.kind, stated_k1 + v[0], s[0], stated_k1)
            ),
            ("k1",),
        )
    if "refraction" in names:
        key = "[atmosphere] refraction: a coefficient of "
        yield TriedError(at("refraction"), keyed("", flight.refraction.k, key), ("refraction",))
    where = "[position]" if flight.path.of_position else "[track]"
    yield TriedError(
        at("up"),
        lambda v, s: (
            f"all landmarks {value_text('up', -v[0], s[0], '+')}: are the heights of camera and "
            f"landmarks counted from the same level ([landmarks] height, {where} height)?"
        ),
        ("up",),
    )
    yield TriedError(
        at(*SHIFT),
        lambda v, s: f"the camera's position {_metres_text(v, s)} ({where})",
        SHIFT,
    )
    if "readout" in names:
        yield TriedError(at("readout"), _readout_text(flight), ("readout",))
    if CENTRE[0] in names:
        yield TriedError(at(*CENTRE), _centre_text(lens.centre_px), CENTRE)


def _centre_text(stated_px: Floats) -> Callable[[Floats, Floats], str]:
    def text(value: Floats, sigma: Floats) -> str:
        u, v = (
            value_text("", float(one), s)
            for one, s in zip(stated_px + value, sigma.tolist(), strict=True)
        )
        return (
            f"[camera] lens: a principal point of {u}, {v} in the place of {stated_px[0]:.5g}, "
            f"{stated_px[1]:.5g} (were the pictures cut off at a side?)"
        )

    return text


def _metres_text(value: Floats, sigma: Floats) -> str:
    return ", ".join(
        f"{value_text('up', v, s, '+')} {way}"
        for v, s, way in zip(value.tolist(), sigma.tolist(), SHIFT, strict=True)
    )


def _landmark_text(flight: Flight, mark: int) -> Callable[[Floats, Floats], str]:
    name, more = flight.landmarks.name[mark], ""
    if flight.picks.clicks is not None:
        more = ", or for a patch that is no level ground: a slope (terrain), a mast (patch_px)"
    return lambda v, s: f"the coordinates of {name}, {_metres_text(v, s)} ([landmarks]){more}"


def _rate_text(flight: Flight) -> Callable[[Floats, Floats], str]:
    stated = flight.frame_rate_hz
    if stated is None:
        return lambda v, s: (
            f"the frames' clock slower by {value_text('clock_rate', 1e6 * v[0], 1e6 * s[0])}: "
            "are [picks] times right?"
        )
    return lambda v, s: (
        f"[picks] frame_rate_hz = {value_text('', stated / (1 + v[0]), stated * s[0])} in the "
        f"place of {stated:g}"
    )


OPPOSITE = {"down": "up", "up": "down", "right": "left", "left": "right"}


def _readout_text(flight: Flight) -> Callable[[Floats, Floats], str]:
    shutter = flight.shutter

    def text(v: Floats, s: Floats) -> str:
        more_ms, sigma_ms = 1000.0 * float(v[0]), 1000.0 * float(s[0])
        if shutter is not None:
            stated_ms = 1000.0 * shutter.readout_s
            value = value_text("readout", abs(stated_ms + more_ms), sigma_ms)
            way = f' and readout = "{OPPOSITE[shutter.way]}"' * (stated_ms + more_ms < 0.0)
            return f"[camera] readout_ms = {value}{way} in the place of {stated_ms:.3g}" + (
                f' and "{shutter.way}"' if way else ""
            )
        way = "down" if more_ms > 0.0 else "up"
        value = value_text("readout", abs(more_ms), sigma_ms)
        return f'a rolling shutter, [camera] readout_ms = {value} and readout = "{way}"'

    return text


def _readout(joint: JointSolution) -> Readout | None:
    """Take the readout of the flight, or of rows downward; None if no turning rate is known.

    Nor is one known well enough while a long readout lasts.
    """
    model, flight = joint.model, joint.model.flight
    if part_of_interval(flight) > LONG_READOUT:
        return None
    turning = np.nan_to_num(turning_rates(flight, joint.solved.attitudes.rotation)[0])
    if not turning.any():
        return None
    rows = flight.shutter or Shutter(0.0, "down", False)
    part = row_parts(replace(flight, shutter=rows))
    return Readout(0.0 if model.readout is None else model.readout.seconds, part, turning)


FAR = 5.0  # times what is stated: errors that nothing but a mistake explains


def times_as_far(joint: JointSolution) -> float:
    """Measure how many times as far as stated the errors that were solved for come out.

    Errors that are stated and not solved for, such as those of a lens, move them: where they come
    out far, these are solved for as well.

    Returns:
        The ratio; 0 where it is not beyond `FAR`.
    """
    if not joint.passes:
        return 0.0
    ratio, chance = size_of_errors(joint)
    if ratio > FAR and chance < SIGNIFICANCE and joint.stated[0]:
        flight, used = joint.model.flight, joint.model.used
        try:
            every = solve_jointly(flight, every_prior(flight), used, first=joint.solved)
            ratio, chance = size_of_errors(every)
        except (VopdError, np.linalg.LinAlgError):  # then they explain nothing
            pass
    return ratio if ratio > FAR and chance < SIGNIFICANCE else 0.0


def with_stated_exact(joint: JointSolution, sigma_px: float) -> JointSolution:
    """Take parameters as exact if errors of them within what is stated explain a misfit.

    They are then tried as large as they are; otherwise what they leave would be named.

    Args:
        joint: the solution of a flight that misfits with them as stated
        sigma_px: standard deviation of a pick where nothing is wrong
    """
    flight, used = joint.model.flight, joint.model.used
    if not joint.stated[0]:
        return joint
    expected = replace(flight, picks=flight.picks.with_sigma(sigma_px))
    every = solve_jointly(expected, every_prior(expected), used, first=joint.solved)
    if every.normal.cost > REJECTED**2 * residuals_freedom(joint):
        return joint
    options = replace(flight.options, parameter_sigma={})
    return solve_jointly(replace(flight, options=options), joint.model.priors, used, joint.state)


def within_stated_text(joint: JointSolution, sigma_px: float) -> str:
    """Name errors within what is stated that explain large residuals; or nothing.

    Args:
        joint: the solution of a flight
        sigma_px: standard deviation of a pick where nothing is wrong
    """
    try:
        joint = of_sampled(joint)
        exact = with_stated_exact(joint, sigma_px)
        found = [] if exact is joint else significant_errors(exact, True)
    except (VopdError, np.linalg.LinAlgError):  # the angles stand without
        return ""
    return named_text(found) if found else ""


def named_text(found: list[Significant]) -> str:
    names = ", or ".join(one.error.text(one.value, one.sigma) for one in found)
    return f"{SPEAK_FOR} {names} (chance {chance_text(max(one.chance for one in found))})"


# Flights of many frames, of which some are drawn


def sampled(flight: Flight) -> FlightPart:
    """Draw frames over a whole flight, those with many landmarks first, up to `MOST_PICKS`."""
    blocks = FlightBlocks(flight)
    if len(flight.picks.frame) <= MOST_PICKS:
        return blocks.part(np.arange(len(flight.frame)))
    count, runs = blocks.layout.count, 50
    stretch = np.arange(len(count)) * runs // len(count)
    order = np.lexsort((-count, stretch))
    rank = np.arange(len(count)) - np.searchsorted(stretch[order], stretch[order])
    order = order[np.lexsort((stretch[order], rank))]  # the best of each stretch, then the next
    chosen = order[np.cumsum(count[order]) <= MOST_PICKS]
    return blocks.part(np.sort(chosen))


def of_sampled(joint: JointSolution) -> JointSolution:
    """Solve a longer flight by its drawn frames alone."""
    if len(joint.model.pick) <= MOST_PICKS:
        return joint
    some = sampled(joint.model.flight)
    used, start, first = joint.model.used[some.picks], None, joint.solved.part(some)
    if joint.passes:
        fixes, fix_m = joint.model.priors.fixes, joint.state.fix_m
        if fixes is not None:
            fix_m = fix_m[fixes.seen_by(some.frames)]
        start = joint.state._replace(rotation=joint.state.rotation[some.frames], fix_m=fix_m)
    return solve_jointly(some.flight, priors_of(some.flight), used, start, first=first)
