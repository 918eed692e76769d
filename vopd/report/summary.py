"""The summary of the report, and its sentences about the uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.input_sigmas import Sigmas
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


def uncertainty_sentences(
    histories: Sequence[History], sigmas: Sigmas, max_rate_deg_s: float | None
) -> list[str]:
    """Sentences that say where the standard deviations come from."""
    units = histories[0].estimate.units
    sentences = [
        "Standard deviations are those of the attitude angles by the partials of the collinearity "
        "equations. With three landmarks or more the reading component has the scale of the "
        "frame's own residuals; with two it has the scale of the reading sigma."
    ]
    for h in histories:
        words = h.about.words
        source = "as given" if sigmas.reading_mm is not None else words.repeated
        reading = h.uncertainty.reading_sigma * units.residuals_per_image
        size = f"{reading:.3g} {units.residual}" if np.isfinite(reading) else "unknown size"
        sentences.append(
            f"{h.about.label}: {words.reading} has a standard deviation of {size}, {source}."
        )
    others = (
        ("landmark positions, along each axis", sigmas.landmark_ft, "ft"),
        ("vehicle position, along each axis", sigmas.position_ft, "ft"),
        ("focal length", sigmas.focal_mm, "mm"),
        ("times of frames", sigmas.time_s, "s"),
    )
    given = [f"{what} {value:g} {unit}" for what, value, unit in others if value > 0.0]
    sentences.append(f"Other standard deviations that were given: {'; '.join(given) or 'none'}.")
    if max_rate_deg_s is None:
        sentences.append("Jumps were not looked for: no --max-rate was given.")
    else:
        sentences.append(
            f"Frames that turn faster than {max_rate_deg_s:g} degrees a second are jumps."
        )
    return sentences
