"""The project file, flight.toml: its keys, and errors that name them."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

from vopd.findings import VopdError
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
        """Whether the key is given."""
        return key in self.values

    def text(self, key: str, choices: Sequence[str] = (), default: str | None = None) -> str:
        """A text, one of the choices where there are any.

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
        """A finite number."""
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, "is needed")
        return self._number(key, value, above)

    def sigma(self, key: str, count: int = 1) -> tuple[float, ...] | None:
        """Standard deviations, none below 0, or one that stands for all; None where not given."""
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
        """A list of so many finite numbers."""
        value = self.values.get(key, default)
        if value is None:
            raise self.error(key, f"is needed, {count} numbers")
        if not isinstance(value, list | tuple) or len(value) != count:
            raise self.error(key, f"{shown(value)} is not a list of {count} numbers")
        return tuple(self._number(key, one, None) for one in value)

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts; none where the key is not given."""
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
        """Whether the project has that section."""
        return name in self.sections

    def changed(self, section: str, key: str, value: Any) -> Project:
        """The same project with another value of one key."""
        before = self.section(section)
        new = replace(before, values=before.values | {key: value})
        return replace(self, sections=self.sections | {section: new})

    def read(self, section: str, file: InputFile, formats: Sequence[InputFormat[R]]) -> R:
        """What the file of a section holds; copies made by `changed` do not read it again."""
        key = section, file.name
        if key not in self.held:
            self.held[key] = read_by_content(formats, file)
        rows: R = self.held[key]
        return rows

    def open(self, section: str, key: str = "file") -> InputFile:
        """The file that a key names."""
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
    """The date and time of t = 0, UTC, where the project gives one.

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
