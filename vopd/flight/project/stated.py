"""Standard deviations of a flight's inputs: those of files and project, and missing ones."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import inf
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import NeededError, VopdError, size_text
from vopd.flight.coordinates import (
    M_PER_FT,
    crs_is_geographic,
    crs_name,
    units_of_crs,
)
from vopd.flight.flight import CameraPath, FlightOptions, LandmarkSet, Refraction
from vopd.flight.project.camera import CameraLens
from vopd.flight.project.keys import (
    ROWS,
    WIDTH,
    Project,
    Section,
    toml_numbers,
    with_common_error,
)
from vopd.flight.solve.equations import COMPONENT, coefficients_of, lacking_text
from vopd.flight.solve.free import COMMON
from vopd.inputs import LEAST_SIGMA, MOST_SIGMA, beyond_sigmas


class Notes(NamedTuple):
    """What is said of files as they are read, and standard deviations that are missing."""

    said: list[str]
    missing: dict[tuple[str, str], str]  # by section and key: which file has none


# Positions, landmarks, velocities: rows of a file


class RowSigmas(NamedTuple):
    """The standard deviations that a file has for its N rows."""

    file: str  # its name
    own: Floats | None  # (N, 3); NaN where not given
    total: int  # N
    line: Sequence[int] = ()  # of each row, where they have lines
    by: str = ""  # where the file has them from
    usual: tuple[float, float, float] | None = None  # of such files, where nothing else is known


def row_sigmas(section: Section, key: str, rows: RowSigmas, notes: Notes) -> Floats:
    """Choose the standard deviations of rows (N, 3): their own, else the key's, else usual ones.

    Args:
        section: of the project
        key: of that section
        rows: what the file has
        notes: added to
    """
    stated = section.sigma(key)
    own = np.full((rows.total, 3), np.nan) if rows.own is None else rows.own
    beyond = ((own > 0.0) & (own < LEAST_SIGMA)) | (own > MOST_SIGMA)
    for k in np.flatnonzero(beyond.any(axis=1)).tolist():
        where = f"line {rows.line[k]}" if len(rows.line) else f"position {k + 1}"
        raise VopdError(f"{rows.file}: {where}: {beyond_sigmas(own[k].tolist())}, or 0")
    lacking: Bools = np.asarray(np.isnan(own).any(axis=1))
    without = int(lacking.sum())
    if without < rows.total:
        notes.said.append(_said(rows, without, f"[{section.name}] {key}", stated is not None))
    if without and stated is None:
        if rows.usual is None:
            notes.missing[section.name, key] = _which(rows, lacking)
        elif without == rows.total:
            sizes = "{:g}, {:g} and {:g} m east, north and up".format(*rows.usual)
            notes.said.append(f"{rows.file}: has no accuracy of its positions: {sizes} is assumed")
        stated = rows.usual or (0.0,) * 3
    return own if stated is None else np.where(np.isnan(own), stated, own)


def _said(rows: RowSigmas, without: int, key: str, stated: bool) -> str:
    """Say that the rows have their own, and what the key is for."""
    text = f"{rows.file}: standard deviations by {rows.by}"
    if without:
        other = key if stated else "usual ones"
        return f"{text}; {other} for {without} of {rows.total} rows, which have none"
    return f"{text}; {key} is not used" if stated else text


def _which(rows: RowSigmas, lacking: Bools) -> str:
    """Name the rows without standard deviations."""
    if rows.own is None or lacking.all():
        return f"{rows.file} has none"
    first = int(np.argmax(lacking))
    where = f"line {rows.line[first]}" if len(rows.line) else f"position {first + 1}"
    more = int(lacking.sum()) - 1
    return f"{rows.file}: {where} " + (f"and {more} more have none" if more else "has none")


def key_sigma(section: Section, key: str, why: str, notes: Notes) -> tuple[float, ...]:
    """Read standard deviations that only a key can state."""
    stated = section.sigma(key)
    if stated is None:
        notes.missing[section.name, key] = why
    return stated or (0.0,) * ROWS[section.name, key].size


# What is common to a flight: lens, clock, readout, refraction

UNITS = {"clock_rate_ppm": 1e-6, "readout_ms": 1e-3}  # of such keys; 1 for the others
HALF = 0.5  # of the coefficient of refraction is its standard deviation if none is stated
ALONE = (
    ("wind", "wind", "sigma_m_s"), ("mount", "vehicle", "mount_sigma_deg"),
    ("bias", "track", "sigma_bias_m"),
)  # fmt: skip
"""Errors besides those of parameters that a key alone states: name, section and key."""


def flight_options(
    project: Project,
    camera: CameraLens,
    refraction: Refraction,
    path: CameraPath,
    landmarks: LandmarkSet,
) -> FlightOptions:
    """Read how a flight is solved, and what is uncertain of all that is common to its frames.

    Raises:
        VopdError: where a value is not as it should be, or the lens has no such coefficient
    """
    solve, found = project.section("solve"), dict(camera.read.sigma)
    if refraction.k:
        found["refraction"] = HALF * abs(refraction.k)
    for (section_name, key), names in COMMON.items():
        section = project.section(section_name)
        values = section.sigma(key)
        if values is None:
            continue
        rolls = project.section("camera").has("readout_ms")
        if key == "readout_ms" and max(values) > 0.0 and not rolls:
            message = (
                "the camera has no rolling shutter: give its [camera] readout_ms, readout and "
                "frame_time, or leave the key out"
            )
            raise section.error(key, message)
        unit = UNITS.get(key, 1.0)
        if key == "focal_rel":
            unit = float(camera.read.lens.focal_px.mean())
        for name, value in zip(names, values * (len(names) // len(values)), strict=True):
            distorts = value > 0.0 and COMPONENT[name] == "distortion"
            if distorts and name not in coefficients_of(camera.lens):
                raise section.error(key, lacking_text(camera.lens, name))
            found[name] = value * unit
    own = {one for names in COMMON.values() for one in names} & {*coefficients_of(camera.lens)}
    sizes = {
        "position": float(path.bias_sigma_m.max())
        if path.fixes is None or path.fixes.exact
        else 1.0,
        "landmark": float(landmarks.sigma_m.max(initial=0.0)),
    }
    for name, sigma in found.items():
        sizes[COMPONENT[name]] = max(sigma, sizes.get(COMPONENT[name], 0.0))
    sizes["distortion"] = max((found.get(one, inf) for one in own), default=0.0)
    if path.velocity_sigma_m_s is not None:
        sizes["velocity"] = float(np.fmax.reduce(path.velocity_sigma_m_s, axis=None))
    for name, where, key in ALONE:
        stated = project.section(where).sigma(key)
        if stated is not None:
            sizes[name] = max(stated)
    return FlightOptions(
        loss=solve.text("loss"),
        drop_blunders=solve.text("blunders") == "drop",
        solve_position=solve.text("position") == "solve",
        parameter_sigma=found,
        exact=tuple(name for name, size in sizes.items() if size == 0.0),
        free=tuple(dict.fromkeys(solve.texts("free"))),
    )


# Missing standard deviations


def refuse_missing(project: Project, missing: Mapping[tuple[str, str], str]) -> None:
    """Raise an error with the lines to paste, if any standard deviation is missing."""
    if missing:
        keys = with_common_error(missing)
        raise NeededError(
            f"{project.name}: standard deviations are missing, and nothing counts as exact unless "
            "you say so. Add these lines, with numbers of your own:\n"
            + lines_to_add(project.lacking(keys))
        )


def lines_to_add(keys: Mapping[tuple[str, str], str]) -> str:
    """Write the lines that a project lacks, with examples, under the headers of their sections.

    Args:
        keys: why each is needed, by section and key
    """
    lines, section, order = list[str](), "", list(ROWS)
    for one in sorted(keys, key=order.index):
        if one[0] != section:
            section = one[0]
            lines += ["", f"under [{section}]"]
        row, why = ROWS[one], keys[one]
        own = re.search(r"\{ \w+ = [-\d.]+ \}", why)  # which the files themselves suggest
        example = own[0] if own else row.example or ROWS["landmarks", row.name].example
        repeats = why.partition(",")[0] == row.comment.partition(",")[0]
        why = "" if not why or repeats or why.startswith(row.comment) else f" ({why})"
        lines.append(f"{f'{row.name} = {example}':{WIDTH - 1}} # {row.comment}{why}")
    if any(ROWS[one].kind == "sigma" for one in keys):
        lines += [
            "",
            'If you do not know one, state it rather too large than too small. "exact" in',
            "the place of a number is for what has no error, as in a simulation.",
        ]
    return "\n".join(lines)


# What files say of themselves: a receiver's standard deviations, and decimals that are too few

NO_BASE_M = 0.3
"""Standard deviation from which positions are of a receiver without a base station (RTK)."""


def doubts_of_own_sigmas(
    section: Section, file: str, said_by: str, sigma_m: Floats | None
) -> list[str]:
    """Warn of a receiver's own standard deviations that count for each position by itself.

    A hundred positions would be taken for exact in the mean, and what is off in all of them for
    minutes is in no standard deviation. Columns of a CSV are the user's own statement.

    Args:
        section: `[track]`
        file: its name
        said_by: where the standard deviations come from
        sigma_m: of each position, east, north, up, (T, 3), NaN where there is none; None: nowhere
    """
    if sigma_m is None or said_by.startswith("column") or section.has("sigma_bias_m"):
        return []
    known = sigma_m[np.isfinite(sigma_m).all(axis=1)]
    if len(known) < 2 or (usual := np.median(known, axis=0)).max() < NO_BASE_M:
        return []
    stated = toml_numbers(*(float(f"{one:.2g}") for one in usual))
    return [
        f"{file}: its standard deviations, by {said_by}, count for each position by itself, and a "
        f"receiver without a base is off by as much in all of them for minutes: [track] "
        f"sigma_bias_m = {stated} says so, or 0 that it is not"
    ]


M_PER_DEG = 111_320.0  # of latitude, and of longitude at the equator
MOST_DECIMALS = 9
FEWEST = 5  # different values of a coordinate: fewer may have the same decimals by themselves
ROUNDING = 1e-6  # of a step, by which numbers differ from whole ones
ROWS_LOOKED_AT = 10_000
MORE = 2.0  # times the standard deviation that is stated
UNIFORM = 12.0**-0.5  # standard deviation of what rounding leaves, in steps


def doubts_of_rounding(
    section: str, file: str, coordinate: Floats, geodetic: bool, crs: str | None, sigma_m: Floats
) -> list[str]:
    """Warn of coordinates that are rounded to more than their standard deviations say.

    Args:
        section: of the file: landmarks or track
        file: its name
        coordinate: longitude, latitude, height, or x, y, z, as the file has them, (N, 3)
        geodetic: whether they are longitude and latitude
        crs: their coordinate reference system, if any
        sigma_m: stated of each by itself, east, north, up, (N, 3); 0: exact
    """
    some = coordinate[:ROWS_LOOKED_AT]
    unit_m = _units_m(some, geodetic, crs, file)
    step_m = np.array([_step(column) for column in some.T]) * unit_m
    feet_m = _step(some[:, 2] * unit_m[2] / M_PER_FT) * M_PER_FT  # as a column of feet is read
    step_m[2] = max(step_m[2], feet_m)
    rounding_m, stated_m = UNIFORM * step_m, np.median(sigma_m, axis=0)
    wrong = (rounding_m > MORE * stated_m) & (stated_m > 0.0)
    if not wrong.any():
        return []
    names = np.array(["longitude", "latitude", "height"] if unit_m[0] > 1e3 else ["x", "y", "z"])
    steps = ", ".join(
        f"{name} to {size_text(step)} m"
        for name, step in zip(names[wrong], step_m[wrong].tolist(), strict=True)
    )
    whole_m = np.hypot(np.where(wrong, rounding_m, 0.0), stated_m)
    stated = toml_numbers(*(float(f"{one:.2g}") for one in whole_m))
    return [
        f"{file}: its numbers are rounded, {steps}: that alone is an error of "
        f"{size_text(rounding_m[wrong].max())} m, and {size_text(stated_m[wrong].min())} m is "
        f"stated: give all decimals, or [{section}] sigma_m = {stated}"
    ]


def _units_m(coordinate: Floats, geodetic: bool, crs: str | None, where: str) -> Floats:
    """Find the metres in a unit of each coordinate, (3,)."""
    grid, heights = units_of_crs(crs, where)
    height_m = [one.metres for one in heights] or [1.0]
    with suppress(VopdError):  # a grid that is not known is told elsewhere
        if geodetic or (crs is not None and crs_is_geographic(crs_name(crs), where)):
            latitude = np.radians(np.median(coordinate[:, 1]))
            return np.array([M_PER_DEG * np.cos(latitude), M_PER_DEG, *height_m])
    return np.array([*([one.metres for one in grid] or [1.0, 1.0]), *height_m])


def _step(values: Floats) -> float:
    """Find the step to which numbers are rounded, a power of 10 of 1 at most; 0 if none is seen."""
    known = values[np.isfinite(values)]
    if len(np.unique(known)) < FEWEST:
        return 0.0
    for decimals in range(MOST_DECIMALS + 1):
        scaled = known * 10.0**decimals
        if (np.abs(scaled - np.rint(scaled)) < ROUNDING).all():
            return float(10.0**-decimals)
    return 0.0
