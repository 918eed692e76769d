"""Every column that an attitude table may have: name, unit, decimals, meaning, source of values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from vopd.attitude.uncertainty import ANGLES


@dataclass(frozen=True)
class TableColumn:
    """One column of the attitude table.

    `decimals` is for text; None where the values are words, whole numbers, or
    written with an exponent. `source` is the attribute of `History` that the values
    come from; a number at its end is the index in the last axis.
    """

    name: str
    unit: str
    decimals: int | None
    source: str
    meaning: str

    @cached_property
    def path(self) -> tuple[str, tuple[int, ...]]:
        """The attribute of `History`, and the indices in its last axis, then in the one before."""
        steps = self.source.split(".")
        indices = tuple(int(step) for step in steps if step.isdigit())
        return ".".join(steps[: len(steps) - len(indices)]), indices


def _columns(prefix: str, *rows: tuple[str, str, int | None, str, str]) -> list[TableColumn]:
    """Columns whose sources begin alike."""
    return [
        TableColumn(name, unit, decimals, prefix + source, meaning)
        for name, unit, decimals, source, meaning in rows
    ]


FIXED = (
    *_columns(
        "",
        ("{source}", "", None, "source_name", "the file"),
        ("job", "", None, "job_number", "the job's number in its file, from 1"),
        ("frame", "", None, "estimate.frame", "frame number"),
        ("status", "", None, "status", "solved, ignored, exact (no residuals at all), stopped"),
    ),
    *_columns(
        "estimate.",
        ("time_s", "s", 6, "time_s", "time"),
        (
            "camera_yaw_deg",
            "deg",
            6,
            "camera_deg.0",
            "of the optical axis, clockwise from north, 0 to 360",
        ),
        (
            "camera_pitch_deg",
            "deg",
            6,
            "camera_deg.1",
            "of the optical axis, above the horizontal, -180 to 180",
        ),
        ("camera_roll_deg", "deg", 6, "camera_deg.2", "about the optical axis, 0 to 360"),
        ("vehicle_yaw_deg", "deg", 6, "vehicle_deg.0", "heading, clockwise from north, 0 to 360"),
        ("vehicle_pitch_deg", "deg", 6, "vehicle_deg.1", "nose above the horizontal, -180 to 180"),
        ("vehicle_roll_deg", "deg", 6, "vehicle_deg.2", "right wing down, 0 to 360"),
        ("alpha_deg", "deg", 6, "attack_deg.0", "angle of attack in pitch"),
        ("beta_deg", "deg", 6, "attack_deg.1", "angle of attack in yaw"),
        ("eta_deg", "deg", 6, "attack_deg.2", "total angle of attack, 0 to 180"),
        ("airspeed_{length}_s", "{length}/s", 4, "airspeed", "speed relative to the air"),
        ("vehicle_east_{length}", "{length}", 4, "displacement.0", "east of the track's origin"),
        ("vehicle_north_{length}", "{length}", 4, "displacement.1", "north of it"),
        ("vehicle_up_{length}", "{length}", 4, "displacement.2", "up along its vertical"),
    ),
    *_columns(
        "estimate.position.",
        ("latitude_deg", "deg", 8, "latitude_deg", "of the vehicle, geodetic"),
        ("longitude_deg", "deg", 8, "longitude_deg", "positive east, -180 to 180"),
        ("altitude_{length}", "{length}", 4, "altitude", "above the ellipsoid"),
    ),
    *_columns(
        "",
        ("quaternion_w", "", 10, "quaternion.0", "local north-east-down to body; scalar, >= 0"),
        ("quaternion_x", "", 10, "quaternion.1", "north and forward part"),
        ("quaternion_y", "", 10, "quaternion.2", "east and right part"),
        ("quaternion_z", "", 10, "quaternion.3", "down part"),
        ("landmarks", "", None, "landmarks", "how many take part"),
        ("residual_rms_{image}", "{image}", 8, "residual_rms", "root mean square of the residuals"),
        (
            "reading_sigma_{image}",
            "{image}",
            8,
            "reading_sigma",
            "standard deviation of an image coordinate, one for the job",
        ),
        (
            "degrees_of_freedom",
            "",
            1,
            "reading_freedom",
            "of the reading sigma, where it was estimated from residuals",
        ),
        (
            "misfit_chance",
            "",
            6,
            "uncertainty.reading.chance",
            "of residuals as large as the frame's, or larger",
        ),
        ("condition", "", 4, "geometry.condition", "of the partials by turns of the camera"),
        (
            "last_correction_rad",
            "rad",
            None,
            "last_correction_rad",
            "of the last pass, largest of three",
        ),
        ("flags", "", None, "flag_text", "what to distrust; a colon before a detail"),
    ),
)
"""The columns of every table in their order.

`{length}` and `{image}` in names are the estimate's units, `{source}` is the kind of its
source. The meanings suit any source; its `Words` may have others.
"""

SLIP_EFFECTS = _columns(
    "estimate.slip_effect_deg.",
    *(
        (
            f"slip_effect_{angle}_deg",
            "deg",
            6,
            str(k),
            "the angle with all errata corrected minus this one; no sigma includes it",
        )
        for k, angle in enumerate(ANGLES)
    ),
)
"""Stand at the end where any job has errata of the original program in it."""

IMAGE_NAME = TableColumn("image", "", None, "image_name", "the name of the frame's image")
"""Stands after `frame` where the frames have names."""

GIMBAL = tuple(
    TableColumn(
        f"gimbal_{angle}_deg", "deg", 6, f"estimate.gimbal_deg.{k}", "in the image's tags, not used"
    )
    for k, angle in enumerate(("yaw", "pitch", "roll"))
)
"""Stand before the standard deviations where images have a gimbal's angles."""


INTERVALS = (
    *_columns(
        "uncertainty.half_width_95.",
        *(
            (f"half_width_95_{angle}_deg", "deg", 6, str(k), "half of the 95 % interval's width")
            for k, angle in enumerate(ANGLES[:8])
        ),
    ),
    *_columns(
        "uncertainty.eta_interval_95_deg.",
        ("eta_low_95_deg", "deg", 6, "0", "lower end of the 95 % interval of eta"),
        ("eta_high_95_deg", "deg", 6, "1", "upper end of the 95 % interval of eta"),
    ),
)
"""95 % intervals, the same for every source."""

BODY_AXES = ("forward", "right", "down")
PARTS = (
    ("", "covariance_deg2", "all components"),
    ("common_", "covariance_common_deg2", "errors that are the same in all frames"),
)
COVARIANCES = tuple(
    TableColumn(
        f"covariance_{part}{BODY_AXES[i]}_{BODY_AXES[j]}_deg2",
        "deg2",
        None,
        f"uncertainty.{source}.{i}.{j}",
        f"of small turns of the vehicle about its {BODY_AXES[i]} and {BODY_AXES[j]} axes, {what}",
    )
    for part, source, what in PARTS
    for i in range(3)
    for j in range(i, 3)
)
"""Covariances, upper triangle row by row, the same for every source."""

MATRICES = tuple(
    TableColumn(
        f"covariance_{part}deg2",
        "deg2",
        None,
        f"uncertainty.{source}",
        "3 x 3, of small turns of the vehicle about its forward, right and down axes, rows and "
        f"columns in this order, {what}",
    )
    for part, source, what in PARTS
)
"""The same covariances as a matrix a frame; see `matrices`."""
