"""The summary of the report, and its sentences about the uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.reading_scale import SOURCES
from vopd.attitude.uncertainty import ANGLES


def summary(histories: Sequence[History]) -> dict[str, str]:
    """Numbers of frames, the span of time, medians, and a line for every job."""
    units, words = histories[0].estimate.units, histories[0].about.words
    status = [word for h in histories for word in h.status]
    counts = (f"{status.count(word)} {word}" for word in dict.fromkeys(status))
    has = np.concatenate([h.has_attitude for h in histories])
    flagged = np.concatenate([h.flags.any() for h in histories])
    strays = np.concatenate([h.flags.raised["not_converged"] for h in histories])
    rms = np.concatenate([h.residual_rms for h in histories])[has] * units.residuals_per_image
    sigma = np.concatenate([h.uncertainty.total for h in histories])[has]
    rows = {
        "Jobs": str(len(histories)),
        "Frames": f"{len(status)}: {', '.join(counts)}",
        "Frames with an attitude": str(int(has.sum())),
        "Frames with a flag": str(int(flagged.sum())),
        "Frames that did not converge": str(int(strays.sum())),
        "Time": _span(np.concatenate([h.estimate.time_s for h in histories])[has]),
        "Median residual (root mean square)": _median(rms, f"{units.residual} {words.surface}"),
    }
    for body in ("camera", "vehicle"):
        names = [f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")]
        rows[f"Median sigma of {body} yaw, pitch, roll"] = _medians(sigma, names)
    rows["Median sigma of alpha, beta, eta"] = _medians(sigma, ["alpha", "beta", "eta"])
    for h in histories:
        count = len(h.status)
        frames = "1 frame" if count == 1 else f"{count} frames"
        rows[h.about.label] = f"{h.about.title or 'no title'}; {frames}"
    return rows


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
    units = histories[0].estimate.units
    sentences = [
        "Standard deviations are those of the attitude angles by the partials of the collinearity "
        "equations. The readings of a job have one standard deviation, estimated from the "
        "residuals of all its frames, and never below the spread of repeated readings or the "
        "resolution of the readings. With few degrees of freedom it has the factor of Student's t."
    ]
    for h in histories:
        reading = h.uncertainty.reading
        sigma = reading.sigma * units.residuals_per_image
        size = f"{sigma:.3g} {units.residual}" if np.isfinite(sigma) else "unknown size"
        freedom = (
            f" ({reading.freedom:.1f} degrees of freedom)" if np.isfinite(reading.freedom) else ""
        )
        sentences.append(
            f"{h.about.label}: {h.about.words.reading} has a standard deviation of {size}"
            f"{freedom}, {SOURCES[reading.source]}."
        )
        sentences.append(f"{h.about.label}: other standard deviations: {_others(h)}.")
    if max_rate_deg_s is None:
        sentences.append("Jumps were not looked for: no --max-rate was given.")
    else:
        sentences.append(
            f"Frames that turn faster than {max_rate_deg_s:g} degrees a second are jumps."
        )
    return sentences


def _others(history: History) -> str:
    """The standard deviations in force besides that of the readings, with their units."""
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
