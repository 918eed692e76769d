"""The attitude table: its columns and their values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.attitude.history import History
from vopd.attitude.long_history import HistoryParts
from vopd.attitude.sigmas import COMPONENTS
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import FrameEstimate, Units
from vopd.findings import VopdError, nearest_word, several

# Columns.


WHOLE_TURN = ("camera_yaw_deg", "camera_roll_deg", "vehicle_yaw_deg", "vehicle_roll_deg")
"""Columns of angles from 0 to 360."""


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
    lowest: float | None = None  # values are brought into the full circle that begins there

    @property
    def is_whole_turn(self) -> bool:
        """Whether the values are from 0 to below 360, so that 360 is written as 0."""
        return self.name in WHOLE_TURN and self.lowest is None

    @cached_property
    def path(self) -> tuple[str, tuple[int, ...]]:
        """The attribute of `History`, and the indices in its last axis, then in the one before."""
        steps = self.source.split(".")
        indices = tuple(int(step) for step in steps if step.isdigit())
        return ".".join(steps[: len(steps) - len(indices)]), indices


def _columns(prefix: str, *rows: tuple[str, str, int | None, str, str]) -> list[TableColumn]:
    """List columns whose sources have a common prefix."""
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
        (
            "status",
            "",
            None,
            "status",
            "solved, ignored, exact (no residuals at all), stopped, unsolved (no attitude)",
        ),
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

PLACES = _columns(
    "estimate.",
    *(
        (f"moved_{axis}_m", "m", 4, f"moved.{k}", "from the stated position to that as solved")
        for k, axis in enumerate(("east", "north", "up"))
    ),
    *(
        (f"sigma_{axis}_m", "m", 4, f"position_sigma.{k}", "standard deviation of the position")
        for k, axis in enumerate(("east", "north", "up"))
    ),
)
"""Stand there too where positions were solved for."""


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
    *_columns(
        "uncertainty.",
        (
            "covariance_factor_95",
            "",
            6,
            "covariance_factor_95",
            "of the covariance: the ellipsoid of it times this factor contains the true attitude "
            "with 95 %",
        ),
    ),
)
"""95 % intervals and ellipsoid, the same for every source."""

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


# Columns of a table of some jobs.


@cache
def _fixed(source: str, units: Units, meanings: tuple[tuple[str, str], ...]) -> list[TableColumn]:
    """Fill the units into `FIXED`, and the meanings of one kind of source."""
    columns = []
    for one in FIXED:
        name, unit = (
            text.format(source=source, **units._asdict()) for text in (one.name, one.unit)
        )
        meaning = dict(meanings).get(name, one.meaning)
        columns.append(replace(one, name=name, unit=unit, meaning=meaning))
    return columns


def column_name(template: str, estimate: FrameEstimate) -> str:
    """Name a column of `FIXED`: `{length}`, `{image}` and `{source}` are replaced."""
    return template.format(source=estimate.about.words.source, **estimate.units._asdict())


def columns_of(histories: Sequence[History]) -> tuple[TableColumn, ...]:
    """List the columns of a table of these jobs.

    They are `FIXED`, with `IMAGE_NAME` where any frame has a name; then the standard
    deviations of the nine angles, first all components together and then each
    component that any job has; then, where any job has errata to correct, what they
    change in the nine angles.

    Raises:
        VopdError: where they have different units
    """
    estimate = histories[0].estimate
    kind = estimate.units, estimate.about.words.source
    for one in histories:
        if (one.estimate.units, one.about.words.source) != kind:
            sources = f"{histories[0].about.source} and {one.about.source}"
            raise VopdError(f"{sources} have different kinds or units: write a table for each")
    words = estimate.about.words
    fixed = [*_fixed(words.source, estimate.units, tuple(words.columns.items()))]
    if any(h.estimate.frame_names for h in histories):
        fixed.insert(3, IMAGE_NAME)
    if any(h.estimate.gimbal_deg is not None for h in histories):
        fixed += GIMBAL
    if any(h.estimate.moved is not None for h in histories):
        fixed += PLACES
    components = [c for c in COMPONENTS if any(c in h.uncertainty.components for h in histories)]
    faulty = any(h.estimate.slip_effect_deg is not None for h in histories)
    effects = SLIP_EFFECTS if faulty else ()
    return (*fixed, *_sigmas(tuple(components)), *INTERVALS, *COVARIANCES, *effects)


BASIC = (
    "frame", "image", "time_s", "vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg",
    "half_width_95_vehicle_yaw_deg", "half_width_95_vehicle_pitch_deg",
    "half_width_95_vehicle_roll_deg", "alpha_deg", "beta_deg", "landmarks",
    "residual_rms_{image}", "flags",
)  # fmt: skip
"""The columns that a reader looks at first."""


OTHER_WORDS = {
    "azimuth": "camera_yaw_deg is the azimuth of the view, clockwise from true north; with that "
    "from the map's grid: --format opk",
    "tilt": "camera_pitch_deg is the elevation of the view, and 90 degrees more its tilt from "
    "straight down",
    "swing": "camera_roll_deg is clockwise about the view as seen from behind, swing the other way",
}
"""Angles by the words of photogrammetry, and which column has each."""
OTHER_WORDS["heading"] = OTHER_WORDS["azimuth"]
OTHER_WORDS["elevation"] = OTHER_WORDS["tilt"]
MOST_HINTED = 2  # columns that have a word in their names


def _instead_of(name: str, every: Sequence[str]) -> str:
    """Say which column to write in the place of one that there is not."""
    word = name.lower().removeprefix("camera_").removesuffix("_deg")
    if word in OTHER_WORDS:
        return OTHER_WORDS[word]
    having = [one for one in every if {*word.split("_")} <= {*one.split("_")}]
    shortest = min((one.count("_") for one in having), default=0)
    near = [one for one in having if one.count("_") == shortest][:MOST_HINTED]
    near = near or nearest_word(name, every)
    parts = dict.fromkeys(part for one in every for part in one.split("_") if one[:4] != "half")
    for part in (word, *nearest_word(word, parts)):
        near = near or [one for one in every if part in one.split("_")][:MOST_HINTED]
    return f"did you mean {' or '.join(near)}?" if near else several(every)


def chosen_columns(
    histories: Sequence[History], names: Sequence[str] = ("all",), roll_180: bool = False
) -> tuple[TableColumn, ...]:
    """List some columns of a table of these jobs.

    Args:
        histories: one or more jobs
        names: of columns; "all" and "basic" stand for several
        roll_180: whether roll is -180 to 180, and not 0 to 360

    Raises:
        VopdError: where there is no such column
    """
    every = {one.name: one for one in columns_of(histories)}
    if roll_180:
        for name in WHOLE_TURN[1::2]:
            meaning = every[name].meaning.replace("0 to 360", "-180 to 180")
            every[name] = replace(every[name], meaning=meaning, lowest=-180.0)
    several = len({(h.about.source, h.about.job) for h in histories}) > 1
    about, units = histories[0].about, histories[0].estimate.units
    which = [about.words.source, "job"] if several else []
    basic = [*which, *(one.format(**units._asdict()) for one in BASIC)]
    found: dict[str, TableColumn] = {}
    for name in names:
        if name in ("all", "basic"):
            found |= {one: every[one] for one in every if name == "all" or one in basic}
        elif name in every:
            found[name] = every[name]
        else:
            raise VopdError(f"no column {name!r}; {_instead_of(name, list(every))}")
    return tuple(found.values())


@cache
def _sigmas(components: tuple[str, ...]) -> list[TableColumn]:
    """List the columns of the standard deviations: all components together, and each of these."""
    sources = [("", "total", "standard deviation, all components together")]
    sources += [
        (f"{c}_", f"components.{c}", f"standard deviation, component {c}") for c in components
    ]
    return [
        TableColumn(f"sigma_{name}{angle}_deg", "deg", 6, f"uncertainty.{source}.{k}", meaning)
        for name, source, meaning in sources
        for k, angle in enumerate(ANGLES)
    ]


# Values.

TableArrays = dict[str, NDArray[Any]]  # the columns of a table: names, and as many values each
MAY_BE_INFINITE = "uncertainty."
ROWS_AT_ONCE = 1000


def table_values(columns: Sequence[TableColumn], histories: Sequence[History]) -> TableArrays:
    """Collect the values of columns, one a frame, one job after the other; NaN if missing.

    Only what belongs to the uncertainty may be infinite: what nothing determines.
    """
    arrays: dict[str, NDArray[Any]] = {}
    table: TableArrays = {}
    for column in columns:
        attribute, indices = column.path
        if attribute not in arrays:
            found = _joined(attribute, len(indices), histories)
            if found.dtype.kind == "f" and not attribute.startswith(MAY_BE_INFINITE):
                found = np.where(np.isfinite(found), found, np.nan)
            arrays[attribute] = found
        values = arrays[attribute]
        for index in indices:
            values = values[..., index]
        if column.lowest is not None:
            values = column.lowest + (values - column.lowest) % 360.0
        table[column.name] = values
    return table


def _joined(attribute: str, axes: int, histories: Sequence[History]) -> NDArray[Any]:
    """Concatenate an attribute of all jobs; NaN for those that do not have it."""
    parts = [_attribute(history, attribute) for history in histories]
    have = [part for part in parts if part is not None]
    if len(have) == len(parts) == 1:
        return have[0]
    shape = have[0].shape[1:] if have else (len(ANGLES),) * axes
    return np.concatenate(
        [
            np.full((len(one.estimate.frame), *shape), np.nan) if part is None else part
            for one, part in zip(histories, parts, strict=True)
        ]
    )


def _attribute(history: History, attribute: str) -> NDArray[Any] | None:
    found: Any = history
    for step in attribute.split("."):
        found = found.get(step) if isinstance(found, dict) else getattr(found, step)
        if found is None:  # a job without what another job of the table has
            return None
    return np.asarray(found)


def table(histories: Sequence[History]) -> TableArrays:
    """Tabulate all jobs: an array for each column, with one row for each frame.

    Numbers that a frame does not have are NaN; words are arrays of str.
    """
    return table_values(columns_of(histories), histories)


def table_blocks(
    jobs: Sequence[HistoryParts], columns: Sequence[TableColumn]
) -> Iterator[TableArrays]:
    """Iterate over the rows of `table` in blocks; no more than a part of a job is kept."""
    for job in jobs:
        for part in job:
            yield from row_blocks(table_values(columns, [part]))


def row_blocks(values: TableArrays) -> Iterator[TableArrays]:
    """Iterate over a table, `ROWS_AT_ONCE` rows at a time, to be written as text."""
    rows = len(next(iter(values.values())))
    for first in range(0, rows, ROWS_AT_ONCE):
        yield {name: column[first : first + ROWS_AT_ONCE] for name, column in values.items()}


def matrices(histories: Sequence[History]) -> TableArrays:
    """Tabulate the covariances of each frame as matrices, (F, 3, 3) each.

    A frame without an attitude has a matrix of NaN. Formats that hold arrays have these
    besides the columns of `table`.
    """
    return table_values(MATRICES, histories)
