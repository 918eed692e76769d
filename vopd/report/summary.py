"""The summary of the report, and its sentences about the uncertainty."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.conventions import reading_sigma_text
from vopd.attitude.findings import misfits
from vopd.attitude.history import History
from vopd.attitude.uncertainty import ANGLES

MOST_TOLD = 6  # explanations of frames that misfit


def summary(histories: Sequence[History]) -> dict[str, str]:
    """Numbers of frames, the span of time, medians, and the job's title if there is one job."""
    units, words = histories[0].estimate.units, histories[0].about.words
    status = [word for h in histories for word in h.status]
    counts = (f"{status.count(word)} {word}" for word in dict.fromkeys(status))
    has = np.concatenate([h.has_attitude for h in histories])
    flagged = np.concatenate([h.flags.any() for h in histories])
    strays = np.concatenate([h.flags.raised["not_converged"] for h in histories])
    rms = np.concatenate([h.residual_rms for h in histories])[has] * units.residuals_per_image
    half = np.concatenate([_half_widths(h) for h in histories])[has]
    rows = {
        "Jobs": str(len(histories)),
        "Frames": f"{len(status)}: {', '.join(counts)}",
        "Frames with an attitude": str(int(has.sum())),
        "Frames with a flag": str(int(flagged.sum())),
        "Frames that did not converge": str(int(strays.sum())),
        "Frames that misfit": _misfits(histories),
        **_model_error(histories),
        "Time": _span(np.concatenate([h.estimate.time_s for h in histories])[has]),
        "Median residual (root mean square)": _median(rms, f"{units.residual} {words.surface}"),
    }
    for body in ("camera", "vehicle"):
        names = [f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")]
        rows[f"Median half-width of 95 %, {body} yaw, pitch, roll"] = _medians(half, names)
    rows["Median half-width of 95 %, alpha, beta, eta"] = _medians(half, ["alpha", "beta", "eta"])
    if len(histories) == 1:
        frames = "1 frame" if len(status) == 1 else f"{len(status)} frames"
        rows[histories[0].about.label] = f"{histories[0].about.title or 'no title'}; {frames}"
    return rows


def _half_widths(history: History) -> Floats:
    """Half of the width of the 95 % interval of each of `ANGLES`, (F, 9) degrees."""
    doubt = history.uncertainty
    half = doubt.half_width_95.copy()
    half[:, 8] = (doubt.eta_interval_95_deg[:, 1] - doubt.eta_interval_95_deg[:, 0]) / 2.0
    return half


def _misfits(histories: Sequence[History]) -> str:
    """How many frames misfit, and what explains them."""
    count = sum(int(h.flags.raised["misfit"].sum()) for h in histories)
    told: list[str] = []
    for h in histories:
        found = misfits(h)
        job = f"{h.about.label}, " if len(histories) > 1 else ""
        told += [f"{job}{frames}: {repair}" for frames, repair in found.repairs]
    more = ["others: see the table of frames"] if len(told) > MOST_TOLD else []
    return "; ".join([str(count), *told[:MOST_TOLD], *more])


def _model_error(histories: Sequence[History]) -> dict[str, str]:
    """How many frames the errata change by more than one sigma, and which angles most of all."""
    if all(h.estimate.slip_effect_deg is None for h in histories):
        return {}
    worst = Counter(
        angle
        for h in histories
        for angle, raised in zip(
            h.flags.detail["model_error"], h.flags.raised["model_error"], strict=True
        )
        if raised
    )
    told = [f"{angle.replace('_', ' ')} in {count}" for angle, count in worst.most_common()]
    most = ["the angle changed most is " + ", ".join(told)] if told else []
    name = "Frames that the errata change by more than one sigma"
    return {name: "; ".join([str(worst.total()), *most])}


def _span(time_s: Floats) -> str:
    known = time_s[np.isfinite(time_s)]
    return f"{known.min():.3f} to {known.max():.3f} s" if len(known) else "unknown"


def _median(values: Floats, unit: str) -> str:
    known = values[np.isfinite(values)]
    return f"{np.median(known):.4g} {unit}".strip() if len(known) else "unknown"


def _medians(sigma: Floats, names: list[str]) -> str:
    columns = [sigma[:, ANGLES.index(name)] for name in names]
    if not any(np.isfinite(column).any() for column in columns):
        return "unknown"
    return ", ".join(_median(column, "") for column in columns) + " degree"


def uncertainty_sentences(histories: Sequence[History], max_rate_deg_s: float | None) -> list[str]:
    """Sentences that say where the standard deviations come from."""
    sentences = [
        "Intervals are those of 95 %. Standard deviations are those of the attitude angles by the "
        "partials of the collinearity equations. The readings of a job have one standard "
        "deviation, estimated from the residuals of all its frames, and never below the spread of "
        "repeated readings or the resolution of the readings. With few degrees of freedom it has "
        "the factor of Student's t."
    ]
    if len(histories) == 1:
        (h,) = histories
        sentences.append(
            f"{h.about.label}: the standard deviation of {h.about.words.reading} is "
            f"{reading_sigma_text(h)}."
        )
        sentences.append(f"{h.about.label}: other standard deviations: {other_sigmas_text(h)}.")
    else:
        sentences.append("The table of jobs has the standard deviations of each job.")
    if max_rate_deg_s is None:
        sentences.append("Jumps were not looked for: no --max-rate was given.")
    else:
        sentences.append(
            f"Frames that turn faster than {max_rate_deg_s:g} degrees a second are jumps."
        )
    return sentences


def other_sigmas_text(history: History) -> str:
    """The standard deviations in force besides that of the readings, with their units.

    Args:
        history: the job
    """
    sigmas, units = history.uncertainty.sigmas, history.estimate.units
    rows = (
        ("centre by the fiducials", sigmas.centre, units.image),
        ("principal point", sigmas.principal_point, units.image),
        ("landmark positions", sigmas.landmark, units.length),
        ("camera position", sigmas.position, units.length),
        ("focal length", sigmas.focal_length, units.image),
        ("times of frames", sigmas.time_s, "s"),
        ("mounting", sigmas.mount_deg, "degree"),
        ("velocity", sigmas.velocity, f"{units.length}/s"),
        ("wind", sigmas.wind, f"{units.length}/s"),
    )
    return (
        "; ".join(f"{what} {_size(value)} {unit}" for what, value, unit in rows if np.any(value))
        or "none"
    )


def _size(value: float | tuple[float, float] | Floats) -> str:
    """One number, or several with commas where they differ."""
    return ", ".join(dict.fromkeys(f"{one:.3g}" for one in np.atleast_1d(value)))
