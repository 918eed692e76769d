"""Conventions stated in every output file: axes, rotations, ranges, sigmas, source, version."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.included import included_text, left_out_text
from vopd.attitude.reading_sigma import SOURCES
from vopd.attitude.uncertainty import ANGLES
from vopd.attitude.vertical import lean_deg
from vopd.estimate import Position, Vertical, Words
from vopd.findings import Report, count_text, size_text
from vopd.version import __version__

if TYPE_CHECKING:
    from vopd.attitude.long_history import HistoryParts
    from vopd.attitude.mean import MeanAttitude

Told = TypeVar("Told", History, "HistoryParts")

# Offset of a file's positions from the source's own coordinates.

WORTH_SAYING_M = 1.0


def report_own_position(histories: Sequence[History], report: Report) -> None:
    """Warn of every job whose positions are not where its own coordinates put the vehicle."""
    for one in histories:
        text = farthest_from_own_text([one])
        if text:
            report(one.about.warning(f"in this file {text.removeprefix('; ')}"))


def farthest_from_own_text(histories: Sequence[History]) -> str:
    """Describe the largest offset of a file's positions, as the end of a sentence.

    Empty where no position is off by `WORTH_SAYING_M`.
    """
    given = [h.estimate.position.to_own_m for h in histories]
    known = [off for off in given if off is not None]
    if not known:
        return ""
    east_north = np.concatenate(known)
    metres = np.hypot(*east_north.T)
    metres = np.where(np.isfinite(metres), metres, 0.0)
    k = int(metres.argmax()) if len(metres) else -1
    if k < 0 or metres[k] < WORTH_SAYING_M:
        return ""
    east, north = -east_north[k]  # from there to the file's position
    parts = [(north, "north", "south"), (east, "east", "west")]
    off = [
        f"{abs(by):.0f} m {one if by > 0.0 else other}" for by, one, other in parts if abs(by) > 0.5
    ]
    words = histories[0].about.words.own_position
    return f"; the vehicle is up to {' and '.join(off)} of {words}"


# Sentences of every output file.

POSITION = "longitude east, geodetic latitude, WGS 84; altitude {altitude}"
GENERAL = {
    "to frame": "vehicle body: x forward, y right, z down",
    "sequence": (
        "intrinsic z-y-x: yaw about down, then pitch about the new right, then roll about the "
        "new forward; right-handed"
    ),
    "quaternion": (
        "scalar first (w x y z), w >= 0; it is the rotation that carries the axes north, east, "
        "down into forward, right, down of the vehicle; rotating a vector's components in the body "
        "by it gives its components in north, east, down"
    ),
    "camera angles": (
        "camera yaw of the optical axis clockwise from north, pitch above the horizontal, roll "
        "clockwise about the optical axis seen from behind"
    ),
    "ranges": "yaw and roll 0 to 360, pitch -180 to 180, alpha and beta -180 to 180, eta 0 to 180",
    "angles of attack": (
        "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w in the body"
    ),
    "position": POSITION.format(altitude=Words.altitude),
    "time": "seconds, of the source's own clock",
}
"""What is so for every source unless its `Words` say otherwise, a short name and a sentence."""

SIGMAS = (
    "one standard deviation, degrees, without Student's factor; infinite where the landmarks do "
    "not determine the angle, missing where a frame has no attitude"
)
INTERVALS = (
    "95 %, with Student's factor; half_width_95 is half the width of an angle's interval; that of "
    "eta, which cannot be below 0, goes from eta_low_95 to eta_high_95; those of a frame with the "
    "flag misfit are contradicted by its residuals"
)
COVARIANCE = (
    "of small turns of the vehicle about its forward, right and down axes, degrees squared, "
    "without Student's factor; times covariance_factor_95 it is the ellipsoid that contains the "
    "true attitude with 95 %"
)
DEFLECTION = (
    "; down is the ellipsoid's normal, from which a level differs by the deflection of the "
    "vertical, up to .03 degree in mountains"
)
MOST_JOBS = 8  # whose reading sigma, and what else is their own, is stated


def conventions(histories: Sequence[History]) -> dict[str, str]:
    """State the conventions of a file about these jobs: short names, and a sentence for each."""
    about = histories[0].about
    sources = ", ".join(dict.fromkeys(h.about.source for h in histories))
    components = dict.fromkeys(c for h in histories for c in h.uncertainty.components)
    doubts = doubts_text(histories)
    left = [f"{len(doubts) - MOST_JOBS} more"] * (len(doubts) > MOST_JOBS)
    stated = {
        "program": f"vopd {__version__}",
        about.words.source: sources,
        "doubtful": "; ".join(doubts[:MOST_JOBS] + left),
        "fixes": about.fixes or about.words.no_fixes,
        "from frame": "north, east, down at the vehicle; down "
        + of_each(histories, lambda one: one.about.down),
        "vertical": _vertical(histories),
        **(GENERAL | _own_words(histories)),
        **included_statements(histories),
        "sigmas": f"{SIGMAS}; components: {', '.join(components)}{_model_error(histories)}",
        "intervals": INTERVALS,
        "covariance": COVARIANCE,
        "common errors": _common_errors(
            list(dict.fromkeys(c for h in histories for c in h.uncertainty.common))
        ),
        "reading sigma": _reading_sigmas(histories),
    }
    stated["position"] += farthest_from_own_text(histories)
    return {name: sentence for name, sentence in stated.items() if sentence}


def doubts_text(histories: Sequence[History]) -> list[str]:
    """Say which sources are contradicted by their residuals, and how: a sentence each."""
    doubt = {h.about.source: h.about.doubt for h in histories}
    if len(doubt) == 1:
        return [one for one in doubt.values() if one]
    return [f"{source}: {one}" for source, one in doubt.items() if one]


def _own_words(histories: Sequence[History]) -> dict[str, str]:
    """State what the words of each source say: once where all say the same.

    The zero of the time, which need not be one, is stated by the file's format.
    """
    own = [h.about.words.conventions for h in histories[: MOST_JOBS + 1]]
    return {
        name: own[0][name] if name == "time" else own_words(histories, name)
        for name in dict.fromkeys(name for one in own for name in one)
    }


def own_words(jobs: Sequence[Told], name: str) -> str:
    """State what the words of each source have under a name, as `of_each` does."""
    return of_each(jobs, lambda one: one.about.words.conventions.get(name, ""))


def of_each(jobs: Sequence[Told], say: Callable[[Told], str]) -> str:
    """State something of sources: once where all have the same, else of each with its name.

    Args:
        jobs: the jobs, of which `MOST_JOBS` are named
        say: what is stated of one; nothing where it is empty
    """
    texts: dict[str, str] = {one.about.source: say(one) for one in jobs[: MOST_JOBS + 1]}
    if len({*texts.values()}) == 1:
        return texts.popitem()[1]
    told = [f"{source}: {text}" for source, text in [*texts.items()][:MOST_JOBS] if text]
    if (more := len(jobs) - MOST_JOBS) > 0:
        told.append(f"{count_text(more, 'more source')}: see its own table")
    return "; ".join(told)


def included_statements(
    histories: Sequence[History], means: Sequence[MeanAttitude] = ()
) -> dict[str, str]:
    """Name the errors that the standard deviations include and leave out, where keys state them."""
    if not histories[0].about.words.sigma_keys:
        return {}
    mean = dict(zip(map(id, histories), means, strict=False))  # none of frames
    none = "nothing that the project can state"

    def left_out(one: History) -> str:
        return left_out_text(one, one.about.words.sigma_keys, mean.get(id(one))) or none

    return {
        "sigmas_include": of_each(histories, lambda one: included_text(one, mean.get(id(one)))),
        "sigmas_not_included": of_each(histories, left_out),
    }


def _common_errors(names: Sequence[str]) -> str:
    """Name the components that a mean over frames does not reduce."""
    if not names:
        return "none stated: the errors of every component differ from frame to frame"
    return (
        f"those of {', '.join(names)} are the same in all frames, and a mean over frames does not "
        "reduce them; their part of the covariance is in covariance_common"
    )


def _reading_sigmas(histories: Sequence[History]) -> str:
    """State the reading sigma of each job."""
    several = len({h.about.source for h in histories}) > 1
    stated = [
        f"{h.about.label if several else f'job {h.about.job}'}: {reading_sigma_text(h)}"
        for h in histories[:MOST_JOBS]
    ]
    left = len(histories) - len(stated)
    more = [f"{count_text(left, 'more job')}: see the columns reading_sigma and degrees_of_freedom"]
    return "; ".join(stated + (more if left else []))


def reading_sigma_text(history: History) -> str:
    """Describe the reading sigma of a job: size, origin, degrees of freedom."""
    scale, e = history.uncertainty.reading, history.estimate
    parts = [f"{size_text(scale.sigma, 3)} {e.units.image}", SOURCES[scale.source]]
    if np.isfinite(scale.freedom):
        parts.append(f"{scale.freedom:.1f} degrees of freedom")
    if e.reading_spread > 0.0 and scale.sigma > 0.0:
        parts.append(
            f"{size_text(scale.sigma / e.reading_spread, 3)} times the spread of repeated readings"
        )
    return ", ".join(parts)


def _vertical(histories: Sequence[History]) -> str:
    """Name the vertical of the angles, and how far the other one and a level differ from it."""
    lean = max(_largest_lean_deg(h.estimate.position) for h in histories)
    apart = f"; geodetic and geocentric vertical are up to {lean:.3f} degree apart here"

    def told(one: History) -> str:
        own, left_open = one.estimate.position.vertical, one.about.words.vertical
        level = DEFLECTION if own is Vertical.GEODETIC else ""
        text = f"{own}{apart if lean > 0.0 else ''}{level}"
        return f"{text}; {left_open}" if left_open else text

    return of_each(histories, told)


def _largest_lean_deg(position: Position) -> float:
    known = position.largest_lean_deg
    return float(_largest(lean_deg(position))) if known is None else known


def _model_error(histories: Sequence[History]) -> str:
    """State the effect of the errata, which the standard deviations leave out."""
    effects = [h.estimate.slip_effect_deg for h in histories]
    known = [effect[:, :6] for effect in effects if effect is not None]
    if not known:
        return ""
    worst = _largest(np.abs(np.concatenate(known)))
    k = int(np.argmax(worst))
    return (
        "; they exclude the errata of the original program, whose effect on each angle is in the "
        f"columns slip_effect: up to {worst[k]:.3f} degree ({ANGLES[k]})"
    )


def _largest(values: Floats) -> Floats:
    """Find the largest finite value of any frame; 0 if there is none."""
    return np.asarray(np.where(np.isfinite(values), values, 0.0).max(axis=0, initial=0.0))
