"""The attitude table: every column by name, unit, decimals and meaning, and where it comes from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.uncertainty import ANGLES, SHARES


@dataclass(frozen=True)
class Column:
    """One column of the table.

    `decimals` is for text; None where the values are words, whole numbers, or
    written with an exponent. `source` is the attribute of `History` the values
    come from, a number at its end the place in the last axis.
    """

    name: str
    unit: str
    decimals: int | None
    source: str
    meaning: str

    def values(self, history: History) -> NDArray[Any]:
        """The column of one job, a value a frame; NaN where the job has none."""
        found: Any = history
        for step in self.source.split("."):
            if step.isdigit():
                found = found[..., int(step)]
            elif isinstance(found, dict):
                frames = len(history.results.frame)
                found = found.get(step, np.full((frames, len(ANGLES)), np.nan))
            else:
                found = getattr(found, step)
        return np.asarray(found)


FIXED = tuple(
    Column(*row)
    for row in (
        ("deck", "", None, "deck_name", "the deck's file"),
        ("job", "", None, "job_number", "the job's number in its deck, from 1"),
        ("frame", "", None, "results.frame", "frame number"),
        ("status", "", None, "status", "solved, ignored, exact (no residuals at all), stopped"),
        ("time_s", "s", 6, "results.time_s", "flight time"),
        ("camera_yaw_deg", "deg", 6, "results.camera_deg.0", "SIG1, 0 to 360"),
        ("camera_pitch_deg", "deg", 6, "results.camera_deg.1", "SIG2, -180 to 180"),
        ("camera_roll_deg", "deg", 6, "results.camera_deg.2", "SIG3, 0 to 360"),
        ("vehicle_yaw_deg", "deg", 6, "results.vehicle_deg.0", "PSI, 0 to 360"),
        ("vehicle_pitch_deg", "deg", 6, "results.vehicle_deg.1", "THETA, -180 to 180"),
        ("vehicle_roll_deg", "deg", 6, "results.vehicle_deg.2", "PHI, 0 to 360"),
        ("alpha_deg", "deg", 6, "results.alpha_deg", "ALPHA, angle of attack in pitch"),
        ("beta_deg", "deg", 6, "results.beta_deg", "BETA, angle of attack in yaw"),
        ("eta_deg", "deg", 6, "results.eta_deg", "ETA, total angle of attack, 0 to 180"),
        ("airspeed_ft_s", "ft/s", 4, "results.airspeed_ft_s", "speed relative to the air"),
        ("vehicle_east_ft", "ft", 4, "results.vehicle_ft.0", "X, east of group 8's origin"),
        ("vehicle_north_ft", "ft", 4, "results.vehicle_ft.1", "Y, north of it"),
        ("vehicle_up_ft", "ft", 4, "results.vehicle_ft.2", "Z, up along its vertical"),
        ("latitude_deg", "deg", 8, "place.latitude_deg", "of the vehicle, geodetic, as the deck's"),
        ("longitude_deg", "deg", 8, "place.longitude_deg", "positive east, -180 to 180"),
        ("altitude_ft", "ft", 4, "place.altitude_ft", "H, above sea level"),
        ("quaternion_w", "", 10, "quaternion.0", "local north-east-down to body; scalar, >= 0"),
        ("quaternion_x", "", 10, "quaternion.1", "north and forward part"),
        ("quaternion_y", "", 10, "quaternion.2", "east and right part"),
        ("quaternion_z", "", 10, "quaternion.3", "down part"),
        ("landmarks", "", None, "landmarks", "how many take part"),
        ("residual_rms_mm", "mm", 8, "residual_rms_mm", "root mean square of the 2N residuals"),
        ("condition", "", 4, "geometry.condition", "of the partials by turns of the camera"),
        ("last_correction_rad", "rad", None, "last_correction_rad", "the 22nd, largest of three"),
        ("flags", "", None, "flag_text", "what to distrust; a colon before a detail"),
    )
)
"""The columns of every table, in their order."""


def columns_of(histories: Sequence[History]) -> tuple[Column, ...]:
    """The columns of a table: `FIXED`, the nine sigmas, and the nine of each share apart."""
    shares = [s for s in SHARES if any(s in h.uncertainty.shares for h in histories)]
    places = [("", "total", "standard deviation, all shares together")]
    places += [(f"{s}_", f"shares.{s}", f"standard deviation, share of {s}") for s in shares]
    sigmas = [
        Column(f"sigma_{share}{angle}_deg", "deg", 6, f"uncertainty.{source}.{k}", meaning)
        for share, source, meaning in places
        for k, angle in enumerate(ANGLES)
    ]
    return (*FIXED, *sigmas)


def table(histories: Sequence[History]) -> dict[str, NDArray[Any]]:
    """All rows of all jobs: an array for each column, a row a frame in the deck's order.

    What a frame does not have is NaN; words are arrays of str.
    """
    return {
        column.name: np.concatenate([column.values(h) for h in histories])
        for column in columns_of(histories)
    }
