"""Write the true attitude of a synthetic flight as a CSV table."""

from __future__ import annotations

import numpy as np

from vopd.synthetic.scene import Truth

COLUMNS = (
    *("frame", "time_s"),
    *("camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("east_ft", "north_ft", "up_ft"),
)


def truth_csv(truth: Truth) -> str:
    """The true attitude as CSV: a header, then a line a frame, in seconds, degrees and feet."""
    columns = (
        truth.frame, truth.time_s, truth.camera_deg, truth.vehicle_deg, truth.position_ft
    )  # fmt: skip
    line = ",".join(["%d", "%.5f", *["%.6f"] * 6, *["%.4f"] * 3]) + "\n"
    rows = np.column_stack(columns).tolist()
    return ",".join(COLUMNS) + "\n" + "".join([line % tuple(row) for row in rows])
