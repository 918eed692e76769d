"""The project file, flight.toml: its keys, and errors that name them."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from vopd.findings import VopdError
from vopd.flight.coordinates import HEIGHTS
from vopd.flight.files import (
    InputFile,
    InputFormat,
    did_you_mean,
    open_input,
    read_by_content,
    reason,
    shown,
)

R = TypeVar("R")

KEYS: dict[str, tuple[str, ...]] = {
    "flight": ("name", "epoch"),
    "camera": ("lens", "model", "camera", "pixel_grid", "image_size_px"),
    "picks": (
        "file", "pixel_grid", "v", "sigma_px", "frame_rate_hz", "first_frame_t_s", "times",
        "utc_offset_h",
    ),
    "landmarks": ("file", "crs", "height", "sigma_m"),
    "track": (
        "file", "crs", "height", "clock", "offset_s", "sigma_m", "sigma_t_s", "lever_arm_m",
        "interpolate",
    ),
    "position": (
        "lat_deg", "lon_deg", "h_m", "x_m", "y_m", "z_m", "crs", "height", "sigma_m", "lever_arm_m",
    ),
    "vehicle": ("mount",),
    "wind": ("file",),
    "atmosphere": ("refraction",),
    "solve": ("loss", "blunders", "check_landmarks", "frames"),
    "uncertainty": ("focal_rel", "principal_px"),
}  # fmt: skip
"""Every section of a project and its keys."""
REQUIRED = ("camera", "picks", "landmarks")


@dataclass(frozen=True)
class Section:
    """One section of a project, with a getter for each kind of value."""

    project: str
    name: str
    values: dict[str, Any]

    def error(self, key: str, message: str) -> VopdError:
        """An error about one key."""
        return VopdError(f"{self.project}: [{self.name}] {key}: {message}")

    def has(self, key: str) -> bool:
        """Tell whether the key is given."""
        return key in self.values

    def text(self, key: str, choices: Sequence[str] = (), default: str | None = None) -> str:
        """Read a text, one of the choices if there are any.

        Raises:
            VopdError: where it is missing, or is another
        """
        value = self.values.get(key, default)
        if value is None:
            known = f": {', '.join(choices)}" if choices else ""
            raise self.error(key, f"is needed{known}")
        if not isinstance(value, str):
            raise self.error(key, f"{shown(value)} is not a text in quotes")
        if choices and value not in choices:
            raise self.error(key, f"{shown(value)} is not known{did_you_mean(value, choices)}")
        return value

    def number(self, key: str, default: float | None = None, above: float | None = None) -> float:
        """Read a finite number."""
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, "is needed")
        return self._number(key, value, above)

    def sigma(self, key: str, count: int = 1) -> tuple[float, ...] | None:
        """Read standard deviations, none below 0, or one that stands for all; None if not given."""
        if not self.has(key):
            return None
        alone = not isinstance(self.values[key], list | tuple)
        found = (self.number(key),) * count if alone else self.numbers(key, count)
        if min(found) < 0.0:
            raise self.error(key, f"{min(found):g}: a standard deviation is not below 0")
        return found

    def numbers(
        self, key: str, count: int, default: Sequence[float] | None = None
    ) -> tuple[float, ...]:
        """Read a list of so many finite numbers."""
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, f"is needed, {count} numbers")
        if not isinstance(value, list | tuple) or len(value) != count:
            raise self.error(key, f"{shown(value)} is not a list of {count} numbers")
        return tuple(self._number(key, one, None) for one in value)

    def texts(self, key: str) -> tuple[str, ...]:
        """Read a list of texts; none if the key is not given."""
        value = self.values.get(key, [])
        if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
            raise self.error(key, f"{shown(value)} is not a list of texts in quotes")
        return tuple(value)

    def section(self, key: str, known: Sequence[str]) -> Section:
        """An inline table, whose keys are all known."""
        value = self.values[key]
        if not isinstance(value, dict):
            raise self.error(key, f"{shown(value)} is not a table, {{ {known[0]} = ... }}")
        found = Section(self.project, f"{self.name}.{key}", value)
        found.check(known)
        return found

    def check(self, known: Sequence[str]) -> None:
        """Refuse keys that are not known."""
        for key in self.values:
            if key not in known:
                raise self.error(key, f"there is no such key{did_you_mean(key, known)}")

    def _number(self, key: str, value: Any, above: float | None) -> float:
        try:
            finite = not isinstance(value, bool) and isfinite(value)
        except (TypeError, OverflowError):  # another kind of value, a whole number beyond 1e308
            finite = False
        if not finite:
            raise self.error(key, f"{shown(value)} is not a finite number")
        if above is not None and not value > above:
            raise self.error(key, f"{value:g} is not above {above:g}")
        return float(value)


@dataclass(frozen=True)
class Project:
    """A project file that has been read: its sections, all keys known."""

    name: str  # as the user gave it
    folder: Path
    sections: dict[str, Section]
    held: dict[tuple[str, str], Any] = field(default_factory=dict, repr=False, compare=False)

    def section(self, name: str) -> Section:
        """A section, empty where the project has none."""
        return self.sections.get(name, Section(self.name, name, {}))

    def has(self, name: str) -> bool:
        """Tell whether the project has that section."""
        return name in self.sections

    def changed(self, section: str, key: str, value: Any) -> Project:
        """Change the value of one key."""
        before = self.section(section)
        new = replace(before, values=before.values | {key: value})
        return replace(self, sections=self.sections | {section: new})

    def read(self, section: str, file: InputFile, formats: Sequence[InputFormat[R]]) -> R:
        """Read the file of a section; copies made by `changed` do not read it again."""
        key = section, file.name
        if key not in self.held:
            self.held[key] = read_by_content(formats, file)
        rows: R = self.held[key]
        return rows

    def open(self, section: str, key: str = "file") -> InputFile:
        """Open the file that a key names."""
        where = self.section(section)
        try:
            return open_input(where.text(key), self.folder)
        except VopdError as error:
            raise error if where.project in str(error) else where.error(key, str(error)) from error


def read_project(name: str, location: str | None = None) -> Project:
    """Read a project file and refuse what is not known.

    Args:
        name: its path
        location: where it is, if not under its name

    Raises:
        VopdError: where it cannot be read, or has an unknown section or key
    """
    path = Path(location or name)
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise VopdError(f"{name}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise VopdError(f"{name}: not a text file in UTF-8") from error
    except (ValueError, RecursionError) as error:
        raise VopdError(f"{name}: not valid TOML: {reason(error, str(error))}") from error
    sections = {}
    for section, inside in values.items():
        if section not in KEYS:
            raise VopdError(f"{name}: [{section}] is not known{did_you_mean(section, list(KEYS))}")
        if not isinstance(inside, dict):
            raise VopdError(f"{name}: {section} is a section: write [{section}]")
        sections[section] = Section(name, section, inside)
        sections[section].check(KEYS[section])
    for section in REQUIRED:
        if section not in sections:
            raise VopdError(f"{name}: the section [{section}] is needed")
    if ("track" in sections) == ("position" in sections):
        which = "both are there" if "track" in sections else "neither is there"
        raise VopdError(
            f"{name}: [track] for a camera that moves, or [position] for one that does not: {which}"
        )
    return Project(name, path.parent, sections)


def epoch_of(project: Project) -> datetime | None:
    """Read the date and time of t = 0, UTC, if the project gives one.

    Raises:
        VopdError: where it does not say its zone
    """
    section = project.section("flight")
    value = section.values.get("epoch")
    if value is None:
        return None
    try:
        if isinstance(value, datetime) and value.tzinfo is not None:
            return value.astimezone(UTC)
    except OverflowError:  # before the year 1 or after 9999 once it is in UTC
        pass
    raise section.error("epoch", "is a date and time with its zone, as 2026-05-01T11:58:42Z")


# The text of a project file with all keys, what each is for, and what is still to be said

WIDTH = 44  # columns before a comment
OPTIONAL = ("vehicle", "wind", "atmosphere", "solve", "uncertainty")
"""Sections that stand in the file as comments where nothing is said of them."""


LANDMARK_SIGMAS = "0.05 by survey, 1 to 5 from a map"
TRACK_SIGMAS = "3 for a usual receiver, 0.02 for RTK"


class KeyText(NamedTuple):
    """A key as it stands in a new project: an example of its value, and a comment."""

    section: str
    key: str
    example: str
    comment: str


_DATUM = f"heights are above: {', '.join(HEIGHTS)}; or {{ undulation_m = -37.9 }}"
_SIGMA = "metres, or [east, north, up]: "
_CRS = "coordinate reference system of x and y"
_GRID = "centre: (0, 0) is the first pixel's centre; corner; one-based"

KEY_TEXTS = tuple(
    KeyText(*row)
    for row in (
        ("flight", "name", '"my flight"', "a title"),
        ("flight", "epoch", "2026-05-01T11:58:42Z", "the moment of t = 0"),
        ("camera", "lens", '"lens.yml"', 'or a table: { model = "brown", fx_px = 1500.0 }'),
        ("camera", "model", '"brown"', "brown or fisheye, where 4 coefficients do not say"),
        ("camera", "camera", '"1"', "which camera, where the file has several"),
        ("camera", "image_size_px", "[1920, 1080]", "width and height of the images"),
        ("camera", "pixel_grid", '"centre"', f"of cx_px, cy_px; {_GRID}"),
        ("picks", "file", '"picks.csv"', "columns frame,landmark,u_px,v_px, or another format"),
        ("picks", "pixel_grid", '"centre"', _GRID),
        ("picks", "v", '"down"', "down or up"),
        ("picks", "sigma_px", "1.0", "standard deviation of a pick"),
        ("picks", "frame_rate_hz", "25.0", "frames a second, for numbered frames"),
        ("picks", "first_frame_t_s", "0.0", "time of frame 0, seconds after the epoch"),
        ("picks", "times", '"times.csv"', "instead: frame or image, t_s or t_utc; or the images"),
        ("picks", "utc_offset_h", "2.0", "hours: clock of the images in `times` less UTC"),
        ("landmarks", "file", '"landmarks.csv"', "landmark,lat_deg,lon_deg,h_m, or another format"),
        ("landmarks", "crs", '"EPSG:32633"', _CRS),
        ("landmarks", "height", '"ellipsoid"', _DATUM),
        ("landmarks", "sigma_m", "0.1", f"{_SIGMA}{LANDMARK_SIGMAS}"),
        ("track", "file", '"track.csv"', "t_utc,lat_deg,lon_deg,h_m, or another format"),
        ("track", "crs", '"EPSG:32633"', _CRS),
        ("track", "height", '"ellipsoid"', _DATUM),
        ("track", "clock", '"utc"', "utc, or gps, which is 18 s ahead"),
        ("track", "offset_s", "0.0", "added to the track's times"),
        ("track", "sigma_m", "3.0", f"{_SIGMA}{TRACK_SIGMAS}"),
        ("track", "sigma_t_s", "0.02", "of a frame's time against the track"),
        ("track", "lever_arm_m", "[0.0, 0.0, 0.0]", "antenna to camera: forward, right, down"),
        ("track", "interpolate", '"linear"', "linear or cubic"),
        ("position", "lat_deg", "48.0", "or x_m, y_m, z_m with crs"),
        ("position", "lon_deg", "15.0", "positive east"),
        ("position", "h_m", "300.0", "height"),
        ("position", "height", '"ellipsoid"', _DATUM),
        ("position", "sigma_m", "0.1", f"{_SIGMA}{LANDMARK_SIGMAS}"),
        ("vehicle", "mount", '"forward"', "forward, down, { ypr_deg = [..] } or { matrix = [..] }"),
        ("wind", "file", '"wind.csv"', "h_m,from_deg,speed_m_s; without it against the ground"),
        ("atmosphere", "refraction", '"standard"', "standard, off or { k = 0.13 }"),
        ("solve", "loss", '"least-squares"', "least-squares, huber or cauchy"),
        ("solve", "blunders", '"name"', "name (tell and keep) or drop"),
        ("solve", "check_landmarks", "[]", "landmarks that are not used"),
        ("solve", "frames", '"each"', "each, or one for a camera that does not move"),
        ("uncertainty", "focal_rel", "0.001", "of the focal length, as a part of it"),
        ("uncertainty", "principal_px", "[1.0, 1.0]", "of the principal point"),
    )
)
"""Every key of a new project in its order."""

KeyValues = dict[tuple[str, str], str]
"""TOML texts of values by section and key."""


def toml_text(text: str) -> str:
    """Quote a text, as TOML has it."""
    return json.dumps(text, ensure_ascii=False)


def toml_numbers(*numbers: float) -> str:
    """Write a list of numbers, as TOML has it."""
    return "[" + ", ".join(f"{number:.12g}" for number in numbers) + "]"


def project_text(values: KeyValues, needed: Mapping[tuple[str, str], str], head: str) -> str:
    """Write the text of a project file.

    Keys without a value stand as comments with an example. Sections that stand
    for others, and have no value, are left out: `[track]` beside `[position]`. Where
    neither is known both are there, `[position]` as a comment, which needs what `[track]` does.

    Args:
        values: the values that are known
        needed: keys that the user must give, and why; they are marked
        head: sentences for the beginning
    """
    fixed = any(section == "position" for section, _ in values)
    either = ("track", "file") in needed
    left_out = ("track",) if fixed else () if either else ("position",)
    comments = OPTIONAL if fixed else (*OPTIONAL, "position")
    lines = [f"# {line}".rstrip() for line in head.splitlines()]
    section = ""
    for row in KEY_TEXTS:
        if row.section in left_out:
            continue
        said = any(name == row.section for name, _ in [*values, *needed])
        if row.section != section:
            section = row.section
            out = section in comments and not said
            lines += ["", f"{'# ' * out}[{section}]"]
        lines.append(_line(row, values.get((row.section, row.key)), needed))
    return "\n".join(lines) + "\n"


def _line(row: KeyText, value: str | None, needed: Mapping[tuple[str, str], str]) -> str:
    section = "track" if row.section == "position" else row.section
    mark = "NEEDED, " if (section, row.key) in needed and value is None else ""
    text = f"# {row.key} = {row.example}" if value is None else f"{row.key} = {value}"
    return f"{text:{WIDTH - 1}} # {mark}{row.comment}"
