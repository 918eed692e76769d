"""The report's words: what there is, what was corrected, how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.uncertainty import ANGLES


def fixes_banner(histories: Sequence[History]) -> str:
    """Which slips were corrected, where it cannot be overlooked."""
    fixes = histories[0].about.fixes
    if not fixes:
        return '<p class="banner">Fixes in force: none; these are the original\'s numbers.</p>'
    return (
        '<p class="banner corrected"><strong>Corrected run, not the original.</strong> '
        f"Fixes in force: {escape(fixes)}.</p>"
    )


def failed_banner(failed: bool) -> str:
    """That the page is not all that was asked for."""
    if not failed:
        return ""
    return (
        '<p class="banner corrected"><strong>A deck failed.</strong> What it left, and the other '
        'decks, are here; <a href="#remarks">warnings and faults</a> say why.</p>'
    )


def summary(histories: Sequence[History]) -> str:
    """Counts, the span of time, and medians, as a list of terms."""
    status = [word for h in histories for word in h.status]
    has = np.concatenate([h.has_attitude for h in histories])
    time_s = np.concatenate([h.estimate.time_s for h in histories])[has]
    flagged = np.concatenate([h.flags.any() for h in histories])
    strays = np.concatenate([h.flags.raised["not_converged"] for h in histories])
    rms = np.concatenate([h.residual_rms for h in histories])[has]
    sigma = np.concatenate([h.uncertainty.total for h in histories])[has]
    rows = {
        "Jobs": str(len(histories)),
        "Frames": f"{len(status)}: "
        + ", ".join(f"{status.count(word)} {word}" for word in dict.fromkeys(status)),
        "Frames with an attitude": str(int(has.sum())),
        "Flagged": str(int(flagged.sum())),
        "Not converged": str(int(strays.sum())),
        "Time of flight": f"{time_s.min():.3f} to {time_s.max():.3f} s",
        "Median residual (root mean square)": _median(rms * 1000.0, "µm on the film"),
    }
    for body in ("camera", "vehicle"):
        names = [f"{body}_{angle}" for angle in ("yaw", "pitch", "roll")]
        rows[f"Median sigma of {body} yaw, pitch, roll"] = _medians(sigma, names)
    rows["Median sigma of alpha, beta, eta"] = _medians(sigma, ["alpha", "beta", "eta"])
    for h in histories:
        count = len(h.estimate.frame)
        frames = "1 frame" if count == 1 else f"{count} frames"
        rows[h.about.label] = f"{h.about.title or 'no title'}; {frames}"
    body = "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in rows.items())
    return f"<dl>{body}</dl>"


def _median(values: np.ndarray, unit: str) -> str:
    known = values[np.isfinite(values)]
    return f"{np.median(known):.4g} {unit}" if len(known) else "unknown"


def _medians(sigma: np.ndarray, names: list[str]) -> str:
    columns = [sigma[:, ANGLES.index(name)] for name in names]
    if not any(np.isfinite(column).any() for column in columns):
        return "unknown"
    return ", ".join(_median(column, "").strip() for column in columns) + " degree"


def uncertainty_said(
    histories: Sequence[History], sigmas: Sigmas, max_rate_deg_s: float | None
) -> str:
    """From what the standard deviations come, in sentences."""
    readings = [
        "Standard deviations are those of the attitude angles by the partials of the collinearity "
        "equations. With three landmarks or more the reading share has the scale of the frame's "
        "own residuals; with two it has that of the readings."
    ]
    for h in histories:
        source = "as asked" if sigmas.reading_mm is not None else "by its three readings"
        readings.append(
            f"{h.about.label}: a landmark's film coordinate has a standard deviation of "
            f"{h.uncertainty.reading_sigma * 1000.0:.3g} µm, {source}."
        )
    asked = {
        "landmarks' places, each way": f"{sigmas.landmark_ft:g} ft",
        "vehicle's place, each way": f"{sigmas.position_ft:g} ft",
        "focal length": f"{sigmas.focal_mm:g} mm",
        "frames' times": f"{sigmas.time_s:g} s",
    }
    items = "; ".join(f"{what} {value}" for what, value in asked.items())
    readings.append(f"Further standard deviations, 0 where none was given: {items}.")
    if max_rate_deg_s is None:
        readings.append("Jumps were not looked for: no --max-rate was given.")
    else:
        readings.append(f"Jumps are flagged above {max_rate_deg_s:g} degrees a second.")
    return "".join(f"<p>{escape(sentence)}</p>" for sentence in readings)
