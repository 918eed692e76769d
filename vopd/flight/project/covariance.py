"""The covariance file of an adjusted project: what it names is held, with one covariance.

`vopd adjust -o` writes it, and `[uncertainty] covariance` names it. It speaks of the files that
there were, and of how they were read: with other picks, another track or another grid of pixels
the same parameters would come out otherwise.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from math import inf, isfinite
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.reading_sigma import SOURCES
from vopd.files import size_and_ends
from vopd.findings import count_text, did_you_mean, shown
from vopd.flight.flight import CameraPath, Flight, HeldParameters
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.image_lenses import lens_files
from vopd.flight.project.keys import ROWS, VIDEO, Project, Section, mount_moves
from vopd.flight.solve.equations import COMPONENT, SHIFT, coefficients_of, parameters_of
from vopd.flight.solve.free import LANDMARK, UNIT, shown_name, stated_value, unit_factor
from vopd.geometry.earth import NED_FROM_ENU, axes_at, geodetic
from vopd.inputs import MOST_NUMBER, beyond_sigmas

# The file

VERSION = 1
FIELDS = (
    "version", "adjusted_from", "free", "names", "units", "values", "covariance", "by_picks",
    "unknowns", "offset_s_before", "sigma_px", "reading_sigma_px", "degrees_of_freedom",
    "reading_sigma_by", "sha256",
)  # fmt: skip
MATRICES = ("covariance", "by_picks")
MOST_NAMES = 3_000
LARGEST = float(MOST_NUMBER) ** 2  # of a variance; with larger ones eigenvalues overflow
ROUNDING = 1e-6  # of a correlation
SAME_S = 1e-6  # between offsets of a clock
SAME, SAME_ZERO = 1e-6, 1e-12  # between values of a lens, as a part of them, and where they are 0
SPEAKS_OF = (
    ("picks", "file"), ("picks", "tracked"), ("picks", "times"), ("track", "file"),
    ("camera", "lens"), ("camera", "of_images"), ("landmarks", "file"),
)  # fmt: skip
"""Keys of the files of which the covariance speaks."""
READ_BY = ("flight", "camera", "picks", "landmarks", "track", "position", "atmosphere")
"""Sections whose keys say how these files are read, and where camera and landmarks are."""
WITH_LEVER_ARM = ("vehicle",)
"""Sections that do so besides where there is a lever arm."""
OTHERS = {("flight", "name"), ("picks", "sigma_px"), ("track", "offset_s")}
"""Keys of these sections that do not; of the offset `with_stated_offset` takes care."""
VALUES = "values"
"""Key of the digest of the file's own values: some, as a rate, stand nowhere else."""
TAGS = 65_536  # bytes from the beginning of an image: its tags are there


@dataclass(frozen=True, eq=False)
class CovarianceFile:
    """A covariance file, as it is written; K parameters."""

    adjusted_from: str  # the project that was adjusted, relative to the file
    free: tuple[str, ...]  # as `[solve] free` has it
    name: tuple[str, ...]  # as `vopd adjust` shows them
    unit: tuple[str, ...]
    value: Floats  # (K,)
    covariance: Floats  # (K, K) in those units
    by_picks: Floats  # (K, K) the part of it that comes from errors of the picks
    unknowns: int  # how many of them had no standard deviation before
    offset_before_s: float | None  # [track] offset_s as stated, where that has the clock now
    sigma_px: float  # standard deviation of a pick with which all was solved
    reading_sigma_px: float  # the reading sigma that came out
    freedom: float
    source: str
    digest: dict[str, str]  # SHA-256 by the keys of files, and by keys of their values

    def digest_of_values(self) -> str:
        """Digest the values of the parameters, as they are written."""
        return sha256(json.dumps(self.value.tolist()).encode()).hexdigest()

    def text(self) -> str:
        """Write the file: JSON, a row of the covariance in a line."""
        values = {
            "version": VERSION,
            "adjusted_from": self.adjusted_from,
            "free": list(self.free),
            "names": list(self.name),
            "units": list(self.unit),
            "values": self.value.tolist(),
            "unknowns": self.unknowns,
            "offset_s_before": self.offset_before_s,
            "sigma_px": self.sigma_px,
            "reading_sigma_px": self.reading_sigma_px,
            "degrees_of_freedom": self.freedom if isfinite(self.freedom) else None,
            "reading_sigma_by": self.source,
            "sha256": self.digest | {VALUES: self.digest_of_values()},
        }
        lines = [f'  "{key}": {json.dumps(value)},' for key, value in values.items()]
        for key, matrix in zip(MATRICES, (self.covariance, self.by_picks), strict=True):
            rows = ",\n    ".join(json.dumps(row) for row in matrix.tolist())
            lines += [f'  "{key}": [', f"    {rows}", f"  ]{',' * (matrix is self.covariance)}"]
        return "\n".join(["{", *lines, "}", ""])


def digests(files: dict[str, bytes | Path]) -> dict[str, str]:
    """Digest files, by the keys that name them.

    Args:
        files: their contents, or where they are; of the images of a folder their names, sizes and
            tags count, of a video its size and both ends
    """
    found = {}
    for key, one in files.items():
        content = one
        if isinstance(one, Path):
            if one.is_dir():
                content = _folder(one)
            else:
                large = InputFile(one.name, one).is_video
                content = b"".join(size_and_ends(one)) if large else one.read_bytes()
            if key == "[camera] of_images":
                content += b"".join(lens.read_bytes() for _, lens in lens_files(one))
        found[key] = sha256(content).hexdigest()  # type: ignore[arg-type]
    return found


def _folder(path: Path) -> bytes:
    """Concatenate what counts of the images of a folder."""
    parts = []
    for one in sorted(path.iterdir()):
        if one.is_file():
            with one.open("rb") as image:
                parts += [one.name.encode(), str(one.stat().st_size).encode(), image.read(TAGS)]
    return b"\0".join(parts)


def digests_of_keys(sections: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Digest the values of the keys that the covariance speaks of, by their names.

    Standard deviations may change, and files have digests of their own.
    """
    found = {}
    for name in (*READ_BY, *WITH_LEVER_ARM * mount_moves(sections)):
        for key, value in sections.get(name, {}).items():
            row = ROWS[name, key]
            is_file = row.kind in ("file", "files") and not isinstance(value, Mapping)
            left_out = is_file or row.kind == "sigma" or (name, key) in OTHERS
            if not left_out and value != row.default:
                text = json.dumps(_in_floats(value), sort_keys=True, default=str)
                found[f"[{name}] {key}"] = sha256(text.encode()).hexdigest()
    return found


def _in_floats(value: Any) -> Any:
    """Write whole numbers as others: 10 is 10.0."""
    if isinstance(value, Mapping):
        return {key: _in_floats(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_in_floats(one) for one in value]
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def files_spoken_of(project: Project) -> dict[str, InputFile]:
    """List the files of a project that its covariance speaks of, by the keys that name them."""
    if project.awaits_tracks():
        project = project.without("picks", "tracked")
    found = {
        f"[{section}] {key}": project.open(section, key)
        for section, key in SPEAKS_OF
        if project.names_file(section, key)
    }
    picks = project.section("picks")
    if picks.values.get("times") == VIDEO:
        for k, name in enumerate(picks.files("video"), 1):
            found[f"[picks] video{f' {k}' * (k > 1)}"] = open_input(name, project.folder)
    return found


# Read and check it


def adjusted_from(project: Project) -> str | None:
    """Look up the project that this one was adjusted from; None where it was not adjusted.

    Raises:
        VopdError: where the covariance file is not as it should be
    """
    found = read_covariance(project, same_files=False)
    return None if found is None else _from_here(project, found)


def _from_here(project: Project, found: CovarianceFile) -> str:
    """Name the project that was adjusted as the command line takes it."""
    return Path(os.path.normpath(project.folder / found.adjusted_from)).as_posix()


def read_covariance(project: Project, same_files: bool = True) -> CovarianceFile | None:
    """Read the covariance file of a project; None where it names none.

    Raises:
        VopdError: where it is not as `vopd adjust -o` writes it, or speaks of other files
    """
    section = project.section("uncertainty")
    if not section.has("covariance"):
        return None
    file = project.open("uncertainty", "covariance")
    key = "uncertainty", file.name
    if key not in project.held:
        project.held[key] = _checked(file, _fields(file))
    found: CovarianceFile = project.held[key]
    if same_files:
        _refuse_changed(project, section, file, found)
    return found


def with_stated_offset(project: Project) -> Project:
    """Take `[track] offset_s` as it was before `vopd adjust` wrote the clock that it found there.

    Positions belong to the times that were stated: the clock moves the cameras from there, by
    velocity and acceleration, as in the solve in which it was found.

    Raises:
        VopdError: where the key has another value than was written
    """
    found = read_covariance(project, same_files=False)
    if found is None or found.offset_before_s is None:
        return project
    section = project.section("track")
    written = found.offset_before_s - float(found.value[found.name.index("clock")])
    if abs(section.number("offset_s") - written) > SAME_S:
        raise section.error(
            "offset_s",
            f"has changed since {section.project} was adjusted, which wrote {written:.6f}: write "
            f"that again, or change it in {_from_here(project, found)} and adjust that",
        )
    return project.changed("track", "offset_s", found.offset_before_s)


def _fields(file: InputFile) -> dict[str, Any]:
    """Read the JSON, with all fields."""
    file.refuse_folder()
    values = file.json(AGAIN)
    if not isinstance(values, dict):
        raise file.error(f"is not what vopd adjust -o writes: no fields are in it{AGAIN}")
    for field in FIELDS:
        if field not in values:
            raise file.error(f"is missing{AGAIN}", column=field)
    if values["version"] != VERSION:
        message = f"{shown(values['version'])} is not known; {VERSION} is"
        raise file.error(message, column="version")
    return values


AGAIN = "; write it again with vopd adjust -o"


def _checked(file: InputFile, values: dict[str, Any]) -> CovarianceFile:
    """Check names, numbers and matrix."""
    name = _texts(file, values, "names")
    if not 1 <= len(name) <= MOST_NAMES:
        message = f"has {len(name)} names, and 1 to {MOST_NAMES} are read{AGAIN}"
        raise file.error(message, column="names")
    doubled = next((one for k, one in enumerate(name) if one in name[:k]), None)
    if doubled is not None:
        raise file.error(f"{doubled} stands twice{AGAIN}", column="names")
    unit = _texts(file, values, "units", len(name))
    value = _numbers(file, "values", values["values"], len(name))
    digest = values["sha256"]
    if not isinstance(digest, dict) or not all(isinstance(one, str) for one in digest.values()):
        raise file.error(f"is not a table of digests{AGAIN}", column="sha256")
    source = values["reading_sigma_by"]
    if not isinstance(source, str) or source not in SOURCES:
        message = f"{shown(source)} is not known; {', '.join(SOURCES)} are"
        raise file.error(message, column="reading_sigma_by")
    unknowns = values["unknowns"]
    if not isinstance(unknowns, int) or isinstance(unknowns, bool) or unknowns < 0:
        raise file.error(f"{shown(unknowns)} is not a number of parameters", column="unknowns")
    whence = values["adjusted_from"]
    if not _is_line(whence) or not whence:
        raise file.error(f"{shown(whence)} is not the name of a project", column="adjusted_from")
    freedom, before_s = values["degrees_of_freedom"], values["offset_s_before"]
    if before_s is not None and "clock" not in name:
        raise file.error(f"is there without a clock{AGAIN}", column="offset_s_before")
    whole = _covariance(file, MATRICES[0], name, values[MATRICES[0]])
    scale = _sizes(whole)  # in whose parts that of the picks may be rounding alone
    by_picks = _covariance(file, MATRICES[1], name, values[MATRICES[1]], scale)
    if np.linalg.eigvalsh((whole - by_picks) / np.outer(scale, scale))[0] < -ROUNDING * len(name):
        raise file.error(f"is more than the whole covariance{AGAIN}", column="by_picks")
    return CovarianceFile(
        whence,
        _texts(file, values, "free"),
        name,
        unit,
        value,
        whole,
        by_picks,
        unknowns,
        None if before_s is None else float(_numbers(file, "offset_s_before", [before_s], 1)[0]),
        _sigma(file, "sigma_px", values),
        _sigma(file, "reading_sigma_px", values),
        inf if freedom is None else _positive(file, "degrees_of_freedom", freedom),
        source,
        digest,
    )


def _is_line(value: object) -> bool:
    """Tell a text of one line, as a command has it that a message names."""
    return isinstance(value, str) and value.splitlines() in ([], [value])


def _texts(
    file: InputFile, values: dict[str, Any], key: str, count: int | None = None
) -> tuple[str, ...]:
    found = values[key]
    if not isinstance(found, list) or not all(map(_is_line, found)):
        raise file.error(f"{shown(found)} is not a list of texts{AGAIN}", column=key)
    if count is not None and len(found) != count:
        message = f"has {len(found)} texts, and there are {count_text(count, 'name')}{AGAIN}"
        raise file.error(message, column=key)
    return tuple(found)


def _numbers(file: InputFile, where: str, found: Any, count: int) -> Floats:
    if not isinstance(found, list) or len(found) != count:
        size = f"{len(found)} numbers" if isinstance(found, list) else shown(found)
        raise file.error(
            f"has {size}, and {count_text(count, 'name')} need {count}{AGAIN}", column=where
        )
    for one in found:
        if isinstance(one, bool) or not isinstance(one, int | float) or not _in_range(one):
            message = f"{shown(one)} is not a number up to {LARGEST:g}{AGAIN}"
            raise file.error(message, column=where)
    return np.array(found, dtype=np.float64)


def _in_range(number: float) -> bool:
    return -LARGEST <= number <= LARGEST


def _positive(file: InputFile, where: str, found: Any) -> float:
    (number,) = _numbers(file, where, [found], 1).tolist()
    if not number > 0.0:
        raise file.error(f"{number:g} is not above 0{AGAIN}", column=where)
    return float(number)


def _sigma(file: InputFile, key: str, values: dict[str, Any]) -> float:
    """Read a standard deviation, whose limits are those of `[picks] sigma_px`."""
    number = _positive(file, key, values[key])
    if beyond := beyond_sigmas([number]):
        raise file.error(f"{beyond}{AGAIN}", column=key)
    return number


def _sizes(covariance: Floats) -> Floats:
    """Take the standard deviations of a covariance, 1 for those that are 0, (K,)."""
    variance = np.diag(covariance)
    return np.asarray(np.sqrt(np.where(variance > 0.0, variance, 1.0)))


def _covariance(
    file: InputFile, key: str, name: Sequence[str], rows: Any, scale: Floats | None = None
) -> Floats:
    """Read a matrix that can be a covariance: symmetric, and of no direction below 0.

    Args:
        file: the covariance file
        key: of the matrix in it
        name: of the parameters, (K,)
        rows: what stands there
        scale: standard deviations in which rounding counts, (K,); without them its own
    """
    if not isinstance(rows, list) or len(rows) != len(name):
        count = f"{len(rows)} rows" if isinstance(rows, list) else shown(rows)
        message = f"has {count}, and {count_text(len(name), 'name')} need {len(name)}{AGAIN}"
        raise file.error(message, column=key)
    named = zip(name, rows, strict=True)
    matrix = np.array([_numbers(file, f"{key}, row {n}", row, len(name)) for n, row in named])
    variance = np.diag(matrix)
    least_variance = 0.0 if scale is None else -ROUNDING * scale**2
    if not (variance >= least_variance).all():
        worst = int(np.argmin(variance))
        message = f"the variance of {name[worst]} is {variance[worst]:g}, below 0{AGAIN}"
        raise file.error(message, column=key)
    scale = _sizes(matrix) if scale is None else scale
    correlation = matrix / scale / scale[:, None]
    size = np.maximum(np.abs(correlation), np.abs(correlation.T))
    gap = np.abs(correlation - correlation.T) / np.maximum(size, 1.0)
    if not gap.max() <= ROUNDING:
        row, column = (int(one) for one in np.unravel_index(gap.argmax(), gap.shape))
        raise file.error(
            f"is not symmetric: {name[row]} with {name[column]} is {matrix[row, column]:g}, "
            f"and the other way {matrix[column, row]:g}{AGAIN}",
            column=key,
        )
    least = float(np.linalg.eigvalsh((correlation + correlation.T) / 2.0)[0])
    if least < -ROUNDING * len(name):
        raise file.error(
            f"is no covariance: some sum of the parameters would have a variance below 0{AGAIN}",
            column=key,
        )
    return np.asarray((matrix + matrix.T) / 2.0)


def _refuse_changed(
    project: Project, section: Section, file: InputFile, found: CovarianceFile
) -> None:
    """Refuse files that are not those of which the covariance speaks, and other values of keys."""
    files = files_spoken_of(project)
    now = digests({key: one.path for key, one in files.items()})
    of_files = {f"[{name}] {key}" for name, key in SPEAKS_OF}
    if {*found.digest} - of_files:  # earlier versions spoke of files alone
        now |= digests_of_keys({name: one.values for name, one in project.sections.items()})
    for key in dict.fromkeys((*files, *found.digest, *now)):
        if now.get(key) == found.digest.get(key) or key == VALUES:  # see `with_held`
            continue
        if key not in now:
            what = f"{key} is not in the project any more"
        elif key not in found.digest:
            what = f"{key} is new"
        else:
            what = f"{files[key].name} ({key})" if key in files else key
            what += " has changed"
            what += ", or a lens that it names," * (key == "[camera] of_images")
        raise section.error(
            "covariance",
            f"{what} since {file.name} was written, which speaks of what there was. "
            "Adjust again with what is new: vopd adjust "
            f"{quote(_from_here(project, found))} --free {quote(','.join(found.free) or 'NAME')} "
            "-o DIR",
        )


# Hold what it names


def with_held(project: Project, flight: Flight) -> Flight:
    """Hold what the covariance file of a project names, as far as there is one.

    Raises:
        VopdError: where the file is not as it should be, or names what the flight does not have
    """
    found = read_covariance(project)
    if found is None:
        return flight
    if flight.options.free:
        raise project.section("solve").error(
            "free",
            "this project is adjusted already, and [uncertainty] covariance holds what it was "
            f"solved for: leave the key out, or take {_from_here(project, found)}",
        )
    file = project.open("uncertainty", "covariance")
    stands = flight.path.stands
    known = {shown_name(one, stands): one for one in sorted(COMPONENT, key=SHIFT.__contains__)}
    marks = {name: k for k, name in enumerate(flight.landmarks.name)}
    parameter: dict[str, int] = {}
    coordinate: dict[int, dict[str, int]] = {}
    for row, (name, unit) in enumerate(zip(found.name, found.unit, strict=True)):
        own = ""
        if name.startswith(LANDMARK):
            mark, _, axis = name.removeprefix(LANDMARK).rpartition(" ")
            if mark not in marks or axis not in SHIFT:
                near = did_you_mean(mark or axis, flight.landmarks.name[:20])
                raise file.error(f"there is no landmark for {name}{near}", column="names")
            coordinate.setdefault(marks[mark], {})[axis] = row
            own = "m"
        elif name not in known or not _is_there(flight, known[name]):
            near = did_you_mean(name, tuple(n for n, p in known.items() if _is_there(flight, p)))
            raise file.error(f"there is no parameter {name}{near}", column="names")
        else:
            parameter[known[name]] = row
            own = UNIT.get(known[name], "")
        if unit != own:
            raise file.error(f"{name} is in {own}, not in {unit}", column="units")
    _refuse_other_values(flight, found, file, parameter)
    shifts = [axis in parameter for axis in SHIFT]
    lacking = [shown_name(a, stands) for a, there in zip(SHIFT, shifts, strict=True) if not there]
    lacking = lacking if any(shifts) else []
    for mark_row, axes in coordinate.items():
        name = flight.landmarks.name[mark_row]
        lacking += [f"{LANDMARK}{name} {axis}" for axis in SHIFT if axis not in axes]
    if lacking:
        message = f"{lacking[0]} is missing beside its other coordinates{AGAIN}"
        raise file.error(message, column="names")
    if found.digest.get(VALUES, own_digest := found.digest_of_values()) != own_digest:
        raise file.error(f"are not those that vopd adjust wrote{AGAIN}", column="values")
    return _held(flight, found, file.name, parameter, coordinate)


def _refuse_other_values(
    flight: Flight, found: CovarianceFile, file: InputFile, parameter: dict[str, int]
) -> None:
    """Refuse values that are not those of lens, shutter and clock, which the solve takes."""
    lens = {*parameters_of(flight.lens)}
    if "aspect" in parameter:  # the focal length is then that from which the aspect was solved
        lens.remove("focal")
    own = {*lens, "readout"}
    if found.offset_before_s is None and flight.path.row_s is not None:
        own.add("clock")  # which is stated alone then: one that is solved for is in offset_s
    for one, row in parameter.items():
        stated, value = stated_value(flight, one), float(found.value[row])
        if one in own and not np.isclose(value, stated, rtol=SAME, atol=SAME_ZERO):
            has = f"is {value:.9g}, and {stated:.9g} in what the project names{AGAIN}"
            raise file.error(f"{found.name[row]} {has}", column="values")


def _is_there(flight: Flight, parameter: str) -> bool:
    """Tell whether a flight has a parameter."""
    if COMPONENT[parameter] == "distortion":
        return parameter in coefficients_of(flight.lens)
    return parameter != "readout" or flight.shutter is not None


def _held(
    flight: Flight, found: CovarianceFile, name: str, parameter: dict[str, int],
    coordinate: dict[int, dict[str, int]],
) -> Flight:  # fmt: skip
    """Hold parameters and landmarks, by their rows in a covariance file."""
    unit = {one: unit_factor(flight, one) for one in parameter}
    order = [*parameter.values(), *(rows[axis] for rows in coordinate.values() for axis in SHIFT)]
    scale = np.array([1.0 / unit[one] for one in parameter] + [1.0] * (3 * len(coordinate)))
    whole, by_picks = (
        one[np.ix_(order, order)] * scale * scale[:, None]
        for one in (found.covariance, found.by_picks)
    )
    landmark = np.array(list(coordinate), dtype=np.int64)
    roots = [_root(one, _sizes(whole)) for one in (by_picks, whole - by_picks)]
    held = HeldParameters(
        name, tuple(parameter), landmark, np.hstack(roots), len(order), found.sigma_px,
        found.reading_sigma_px, found.freedom, found.source, found.unknowns,
    )  # fmt: skip
    added = {one: float(found.value[row]) / unit[one] for one, row in parameter.items()}
    sigma_m = flight.landmarks.sigma_m.copy()
    sigma_m[landmark] = 0.0
    options = flight.options
    exact = [COMPONENT[one] for one in parameter] + ["landmark"] * bool(len(landmark))
    return replace(
        flight,
        path=_path(flight, added),
        landmarks=replace(flight.landmarks, sigma_m=sigma_m),
        options=replace(
            options,
            held=held,
            parameter_sigma={n: s for n, s in options.parameter_sigma.items() if n not in added},
            exact=tuple(dict.fromkeys((*options.exact, *exact))),
        ),
        about=(*flight.about, f"{name}: {held_text(flight, held)} as vopd adjust left them"),
    )


def _root(covariance: Floats, scale: Floats) -> Floats:
    """Take a root of a covariance (K, C), in whose parts by `scale` (K,) rounding counts."""
    sizes, axes = np.linalg.eigh(covariance / scale / scale[:, None])
    return np.asarray(scale[:, None] * axes * np.sqrt(np.maximum(sizes, 0.0)))


def _path(flight: Flight, added: dict[str, float]) -> CameraPath:
    """Move a path by the errors of its clock and of all its positions."""
    path = flight.path
    named = any(axis in added for axis in SHIFT)
    path = replace(path, bias_sigma_m=np.zeros(3)) if named else path
    shift = np.array([added.get(axis, 0.0) for axis in SHIFT]) * (not path.stands)
    late_s = added.get("clock", 0.0) + added.get("clock_rate", 0.0) * flight.since_middle_s
    moved = np.tile(shift, (len(late_s), 1))
    speed, change = path.velocity_m_s, path.acceleration_m_s2
    slopes = None if path.fixes is None else path.fixes.slopes
    if slopes is not None and flight.options.solve_position:
        speed, change = slopes.velocity_m_s, slopes.acceleration_m_s2
    for one, after_s in ((speed, late_s), (change, late_s**2 / 2.0)):
        if one is not None:
            moved = moved + np.nan_to_num(one * after_s[:, None]) @ NED_FROM_ENU
    path = path.later(late_s)
    if not moved.any():
        return path
    axes = axes_at(geodetic(path.position_m))
    position_m = path.position_m + np.einsum("fji,fj->fi", axes, moved)
    return replace(path, position_m=position_m)


def held_text(flight: Flight, held: HeldParameters) -> str:
    """Name what is held, for a sentence."""
    names = [shown_name(one) for one in held.parameter if one not in SHIFT]
    if set(SHIFT) & set(held.parameter):
        names.append("position" if flight.path.stands else "track-offset")
    if len(held.landmark):
        names.append(count_text(len(held.landmark), "landmark"))
    return ", ".join(names)
