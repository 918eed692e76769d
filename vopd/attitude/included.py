"""Errors that the standard deviations of a history include, and those that they leave out."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History, is_turned
from vopd.attitude.sigmas import INPUTS, Sigmas, angle_gains, given_components, in_force
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import Block, Estimate, Units
from vopd.findings import size_text

if TYPE_CHECKING:
    from vopd.attitude.mean import MeanAttitude


def label(component: str) -> str:
    """Name a component of the uncertainty in a sentence."""
    return component.replace("_", " ")


SIGMA_OPTIONS = {
    "position": "--position-sigma",
    "landmark": "--landmark-sigma",
    "focal": "--focal-sigma",
    "time": "--time-sigma",
    "mount": "--mount-sigma",
    "velocity": "--velocity-sigma",
    "wind": "--wind-sigma",
}
"""The option that states the standard deviation of a component of a deck's uncertainty."""


def errors_texts(
    heads: Sequence[History], means: Sequence[MeanAttitude] = ()
) -> list[tuple[str, str, str]]:
    """Say which errors the sigmas contain and which not, once for sources that are alike.

    Returns:
        The sources, the errors that are included, and those that are not; empty if not known.
    """
    sources: dict[tuple[str, str], dict[str, None]] = {}
    for one, mean in zip_longest(heads, means):
        keys = one.about.words.sigma_keys
        left = left_out_text(one, keys or SIGMA_OPTIONS, mean)
        told = included_text(one, mean) if keys else ""
        if left or told:
            sources.setdefault((told, left), {})[one.about.source] = None
    return [
        (f"{next(iter(some))}{f' and {len(some) - 1} more' * (len(some) > 1)}", *told)
        for told, some in sources.items()
    ]


def included_text(history: History, mean: MeanAttitude | None = None) -> str:
    """Describe the errors that the standard deviations include, and how large they are.

    The sizes are those of the mean, or medians over the frames that have an attitude; of a job
    that is made in parts those of its middle frame.
    """
    of, each = "the mean attitude", {}
    if mean is None:
        history = history.typical or history
        frames = _with_attitude(history)
        of = f"the median of {len(frames)} frames"
        if len(frames) == 1:
            of = f"frame {history.estimate.frame_label(int(frames[0]))}"
        each = {name: own[frames] for name, own in history.uncertainty.components.items()}
    else:
        each = {name: own[None] for name, own in mean.components.items()}
    sizes: dict[str, list[str]] = {OF_VEHICLE: [], "alpha, beta and eta": []}
    both = {name: _sizes(own) for name, own in each.items()}
    tells_deg = max(LEAST_DEG, TELLS * max((turn for turn, _ in both.values()), default=0.0))
    for name, (turn_deg, attack_deg) in both.items():
        alone = attack_deg > OF_ATTACK * turn_deg
        told = {"alpha, beta and eta": attack_deg} if alone else {}
        if not alone or turn_deg >= tells_deg:
            told[OF_VEHICLE] = turn_deg
        for angles, size_deg in told.items():
            size = f"below {LEAST_DEG}" if size_deg < LEAST_DEG else size_text(size_deg)
            sizes[angles].append(f"{label(name)} {size}")
    texts = [
        f"{', '.join(some)} degree, the largest of {angles}"
        for angles, some in sizes.items()
        if some
    ]
    turn = one_turn_text(history, mean)
    return "; ".join([*texts, of, *filter(None, [turn])])


def one_turn_text(history: History, mean: MeanAttitude | None = None, body: str = "vehicle") -> str:
    """Say how sure the attitude is where yaw and roll are nearly one turn, and so unsure.

    Args:
        history: of a job
        mean: the mean attitude of the job, if its standard deviations are meant; else medians of
            the frames are
        body: whose angles: of the vehicle, or the camera

    Returns:
        A sentence; nothing where yaw and roll are two turns.
    """
    half_deg = _half_of_one_turn(history, mean, body)
    if half_deg is None:
        return ""
    return (
        f"{f'{body} ' * is_turned(history)}yaw and roll are nearly one turn at this pitch, each by "
        f"itself is unsure; the attitude, as one turn about any axis, is sure to "
        f"{size_text(half_deg)} degree (95 %)" + MOUNTED_DOWN * _counts_as_vehicle(history)
    )


def names_mount(history: History) -> bool:
    """Tell whether `included_text` of a job, by its frames, names the mount that gives sure angles.

    Args:
        history: of the job
    """
    history = history.typical or history
    return _half_of_one_turn(history) is not None and _counts_as_vehicle(history)


def _counts_as_vehicle(history: History) -> bool:
    """Tell whether a project's camera looks down, and counts as the vehicle itself."""
    pitch_deg = float(np.median(history.estimate.vehicle_deg[history.has_attitude, 1]))
    return history.about.words.source == "project" and not is_turned(history) and pitch_deg < 0.0


def _half_of_one_turn(
    history: History, mean: MeanAttitude | None = None, body: str = "vehicle"
) -> float | None:
    """Find the 95 % half-width, degrees, of one turn that yaw and roll nearly are; None of two.

    The arguments are those of `one_turn_text`.
    """
    doubt, has = (history.uncertainty, history.has_attitude) if mean is None else (mean, True)
    columns = [ANGLES.index(f"{body}_{name}") for name in ("yaw", "roll")]
    total, half = (np.atleast_2d(one)[:, columns] for one in (doubt.total, doubt.half_width_95))
    covariance = doubt.covariance_deg2.reshape(-1, 3, 3)
    known = np.isfinite(covariance).all(axis=(1, 2)) & np.isfinite(total).all(axis=1) & has
    known &= (total > 0.0).all(axis=1)
    if not known.any():
        return None
    total, half = total[known], half[known]
    turn = np.sqrt(np.linalg.eigvalsh(covariance[known])[:, 2])
    if np.median(total.min(axis=1) / turn) < NEARLY_ONE:
        return None
    return float(np.median(turn * half[:, 0] / total[:, 0]))


def one_turn_texts(histories: Iterable[History]) -> list[str]:
    """Say how sure attitudes are where yaw and roll of vehicle or camera are unsure by their pitch.

    Args:
        histories: the jobs
    """
    found, jobs = dict[str, History](), list(histories)
    for h in jobs:
        for body in ("vehicle", "camera")[: 1 + is_turned(h)]:
            if told := one_turn_text(h, body=body):
                found.setdefault(told, h)
    several = len(found) > 1 and len(jobs) > 1
    return [(f"{h.about.label}: " if several else "") + told for told, h in found.items()]


NEARLY_ONE = 2.0  # yaw and roll both are so many times as unsure as a turn about any axis
MOUNTED_DOWN = '; [vehicle] mount = "down" gives angles of the vehicle, each of them sure'


def largest_component(history: History) -> str:
    """Name the component that the angles of the vehicle are least sure by, in a median frame."""
    history = history.typical or history
    frames = _with_attitude(history)
    sizes = {name: _sizes(own[frames]) for name, own in history.uncertainty.components.items()}
    return max(sizes, key=lambda name: sizes[name][0])


OF_VEHICLE = "yaw, pitch and roll"
WEAVING = "weaving"  # of the path, which the noise of its positions hides; only ever left out
ATTACK_ALONE = "velocity", "wind", WEAVING  # move the angles of attack, which a mean has not
LEAST_DEG = 0.0001  # smaller errors are told without their size
OF_ATTACK = 100.0  # times the vehicle's: an error of the angles of attack
TELLS = 0.1  # of the largest error of the vehicle's angles: one that is told beside those of attack


def _sizes(angles_deg: Floats) -> tuple[float, float]:
    """Take the largest of the vehicle's angles and the largest of those of attack.

    Args:
        angles_deg: of camera, vehicle and attack, (F, 9), or without attack, (F, 6): the median
            of the frames counts
    """
    known = np.nan_to_num(angles_deg, posinf=np.inf)
    vehicle, attack = (
        float(np.median(known[:, some].max(axis=1, initial=0.0)))
        for some in (slice(3, 6), slice(6, 9))
    )
    return vehicle, attack


def left_out_text(
    history: History, where: Mapping[str, str], mean: MeanAttitude | None = None
) -> str:
    """Describe the errors that the standard deviations leave out; of a flight with round sizes.

    Args:
        history: of a job, or of its first frames
        where: where each component can be stated; those that are not here are not named
        mean: the mean attitude of the job, if its standard deviations are meant
    """
    blocks = history.estimates()
    if history.about.words.sigma_keys:
        history = history.typical or history
        blocks = ((frames, one) for frames, one in [_middle_frame(history)])
    kept = [one for _, one in blocks]
    known = history.uncertainty.components
    if mean is not None:
        known = dict.fromkeys((*mean.components, *ATTACK_ALONE), known["reading"])
    told = [one for one in left_out(kept, known) if one in where]
    effects = usual_effects(kept[0], told) if history.about.words.sigma_keys else {}
    return ", ".join(
        f"{label(name)} ({where[name]}{': ' * (name in effects)}{effects.get(name, '')})"
        for name in told
    )


def _with_attitude(history: History) -> Ints:
    """List the frames that have an attitude, else the first one."""
    return np.flatnonzero(history.has_attitude) if history.has_attitude.any() else np.zeros(1, int)


def _middle_frame(history: History) -> Block:
    """Take the middle one of the frames that have an attitude, else the first one."""
    known = _with_attitude(history)
    middle = int(known[len(known) // 2])
    for frames, one in history.estimates():
        if middle in frames:
            return np.array([middle]), one.take(np.flatnonzero(frames == middle))
    raise AssertionError(middle)


def left_out(blocks: Iterable[Estimate], components: Collection[str]) -> list[str]:
    """List the causes of errors that the standard deviations of a job do not contain.

    Those that cannot change its angles are not listed: times of a camera that stands still,
    and velocity and wind where no angle of attack is known.
    """
    attack = moves = False
    for one in blocks:
        attack |= bool(np.isfinite(one.attack_deg).any())
        moves |= bool(np.nan_to_num(one.responses.time).any())
        if attack and moves:
            break
    without_effect = {"time": not moves, **dict.fromkeys(ATTACK_ALONE, not attack)}
    return [
        name
        for name in (*INPUTS, WEAVING)
        if name not in components and not without_effect.get(name, False)
    ]


@np.errstate(all="ignore")
def usual_effects(estimate: Estimate, names: Collection[str]) -> dict[str, str]:
    """Describe the effect of a round size of errors on the angles, such as `1 m is 0.46 degree`."""
    sizes = _round_sizes(estimate.units, float(estimate.focal_length))
    gains, found = angle_gains(estimate), {}
    for name in names:
        if name not in sizes:
            continue
        field, size, text = sizes[name]
        force = in_force(estimate, Sigmas(reading=0.0, fiducial=0.0))
        none: dict[str, Any] = dict.fromkeys(force._fields, 0.0)
        none |= {one: np.zeros(3) for one in ("landmark", "position", "place", "velocity")}
        none["principal_point"] = (0.0, 0.0)
        of_one = given_components(estimate, type(force)(**none | {field: size}))
        own = [gains.effect(one).angles_deg for one in of_one if one.name == name]
        if own:
            turn, attack = _sizes(np.sqrt(sum((one**2).sum(axis=2) for one in own)))
            degrees = attack if attack > OF_ATTACK * turn else turn
            if 0.0 < degrees < np.inf:
                found[name] = f"{text} is {size_text(degrees)} degree"
    return found


def _round_sizes(units: Units, focal_length: float) -> dict[str, tuple[str, Any, str]]:
    """List of each component its field of `SigmasInForce`, a round size, and the size in words."""
    one = np.ones(3)
    return {
        "position": ("position", one, f"1 {units.length}"),
        "landmark": ("landmark", one, f"1 {units.length}"),
        "focal": ("focal_length", 1e-3 * focal_length, "0.1 % of it"),
        "principal_point": ("principal_point", (1.0, 1.0), f"1 {units.image}"),
        "time": ("time_s", 0.1, "0.1 s"),
        "velocity": ("velocity", one, f"1 {units.length}/s"),
        "wind": ("wind", 1.0, f"1 {units.length}/s"),
    }
