"""The project that `vopd adjust -o` writes: new lens, landmarks, offsets, and their covariance."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.files import from_folder
from vopd.findings import VopdError, count_text, shown
from vopd.flight.adjust.adjustment import Adjustment
from vopd.flight.coordinates import (
    ELLIPSOIDAL,
    STEPS,
    coordinates_at,
    crs_is_geographic,
    crs_name,
    earth_centred_positions,
    units_of_crs,
)
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.columns import coordinate_columns
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, PATCH, SIGMAS
from vopd.flight.formats.tables import EXACT, name_cell
from vopd.flight.project.covariance import (
    CovarianceFile,
    digests,
    digests_of_keys,
    files_spoken_of,
)
from vopd.flight.project.inspect import NewProject
from vopd.flight.project.keys import Project, from_toml, project_text, toml_text
from vopd.flight.project.new import NAME
from vopd.flight.project.read import landmark_crs
from vopd.flight.project.track import height_datum
from vopd.flight.solve.equations import SHIFT, parameters_of
from vopd.flight.solve.free import LANDMARK, MOUNT, UNIT, shown_name, stated_value, unit_factor
from vopd.flight.solve.joint import JointSolution, covariance_by_picks
from vopd.geometry.lenses import Lens, LensKind

COVARIANCE, LENS, LANDMARKS = "covariance.json", "lens.json", "landmarks.csv"
HEAD = """\
A flight project as vopd adjust left it: lens, landmarks and offsets are as solved, and
{covariance} has their covariance. vopd attitude, plot and report hold them and propagate
that covariance, so that the same picks do not count twice. Standard deviations that are
stated below are those from before; where {covariance} names something it has precedence.
With other picks or another track, adjust again: vopd adjust {source}"""


def adjusted_project(project: Project, adjustment: Adjustment, folder: Path) -> NewProject:
    """Write the files of an adjusted project.

    Picks, track and whatever else is unchanged stay where they are, and the project names them from
    its own folder.

    Raises:
        VopdError: where nothing was solved for that all frames have in common
    """
    joint = adjustment.result.estimates.joint
    assert joint is not None
    flight, solved = joint.model.flight, adjustment.result.flight
    new, changes = NewProject(), _with_paths(project, folder)
    names = set(joint.model.names)
    if names & {*parameters_of(flight.lens)}:
        _write_lens(new, changes, solved.lens)
    if len(joint.model.free):
        _write_landmarks(new, changes, project, joint)
    if flight.path.stands and names & set(SHIFT):
        _move_position(changes, project, joint)
    if "readout" in names and solved.shutter is not None:
        changes["camera", "readout_ms"] = repr(_above_zero(project, solved.shutter.readout_s * 1e3))
    before_s = None
    if "clock" in names and flight.path.row_s is not None:
        before_s = project.section("track").number("offset_s")
        changes["track", "offset_s"] = repr(before_s - joint.model.value(joint.state, "clock"))
    if solved.vehicle is not None and solved.vehicle.turned_deg is not None:
        changes["vehicle", "mount"] = toml_value({"matrix": solved.mount.tolist()})
        changes["vehicle", "mount_sigma_deg"] = repr(solved.mount_sigma_deg)
        changes["vehicle", "attitude"] = changes["vehicle", "attitude_sigma_deg"] = None
        new.said.append("[vehicle] mount: as solved, with its standard deviation")
    source = from_folder(Path(project.folder) / Path(project.name).name, folder)
    free = flight.options.free
    if len(joint.model.common_sigma) or MOUNT not in free:
        file = _covariance_file(adjustment, source, free, before_s, project, new, changes)
        new.contents[COVARIANCE] = file.text().encode()
        changes["uncertainty", "covariance"] = toml_text(COVARIANCE)
        count = count_text(len(file.name), "parameter")
        new.said.append(f"{COVARIANCE}: {count} with their covariance")
    again = f"{quote(source)} --free {quote(','.join(free))} -o DIR"
    head = HEAD.format(covariance=COVARIANCE, source=again)
    text = project_text({k: v for k, v in changes.items() if v is not None}, {}, head)
    new.contents[NAME] = text.encode()
    return new


def _above_zero(project: Project, readout_ms: float) -> float:
    """Refuse a readout that no shutter has."""
    if readout_ms > 0.0:
        return readout_ms
    raise VopdError(
        f"{project.name}: free readout: it comes out at {readout_ms:.3g} ms, and a project has one "
        "above 0: are the rows read the other way ([camera] readout), or all at one time? Leave "
        "readout out of --free"
    )


# Keys of the project


Changes = dict[tuple[str, str], str | None]
"""TOML texts of values by section and key; None: the key is left out."""


def _with_paths(project: Project, folder: Path) -> Changes:
    """Copy all keys, files as they are named from another folder."""
    found: Changes = {}
    for name, section in project.sections.items():
        for key, value in section.values.items():
            if project.names_file(name, key):
                several = value if isinstance(value, list) else [value]
                found_there = [from_folder(project.folder / one, folder) for one in several]
                value = found_there if isinstance(value, list) else found_there[0]
            found[name, key] = toml_value(value)
    found.pop(("solve", "free"), None)
    return found


def toml_value(value: Any) -> str:
    """Write a value that has been read from TOML, as TOML has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return toml_text(value)
    if isinstance(value, datetime):
        return value.isoformat().replace("+00:00", "Z")
    if isinstance(value, Mapping):
        inside = ", ".join(f"{key} = {toml_value(one)}" for key, one in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(toml_value(one) for one in value)}]"
    return repr(value)


# The lens, as OpenCV writes it; one that OpenCV does not have, as a table in the project


def _write_lens(new: NewProject, changes: Changes, lens: Lens) -> None:
    for key in ("model", "camera", "of_images", "pixel_grid", "lens_size_px"):
        changes["camera", key] = None
    changes["camera", "image_size_px"] = toml_value(list(lens.size_px))
    if lens.table is None and not lens.skew_px:
        new.contents[LENS] = opencv_text(lens).encode()
        changes["camera", "lens"] = toml_text(LENS)
        new.said.append(f"{LENS}: the lens as solved, as OpenCV writes it")
        return
    (fx, fy), (cx, cy) = lens.focal_px.tolist(), lens.centre_px.tolist()
    values: dict[str, Any] = {"model": lens.kind.value, "fx_px": fx, "cx_px": cx, "cy_px": cy}
    if lens.table is not None:
        values["table_px"] = lens.table.tolist()
    else:
        values |= {"fy_px": fy, "k": _coefficients(lens), "skew_px": lens.skew_px}
    changes["camera", "lens"], changes["camera", "pixel_grid"] = toml_value(values), '"centre"'
    new.said.append("[camera] lens: the lens as solved, a table, as OpenCV has none like it")


def opencv_text(lens: Lens) -> str:
    """Write a lens as OpenCV's FileStorage does, in JSON."""
    (fx, fy), (cx, cy) = lens.focal_px.tolist(), lens.centre_px.tolist()
    k, width, height = _coefficients(lens), *lens.size_px
    brown = "plumb_bob" if len(k) <= 5 else "rational_polynomial"
    values = {
        "image_width": width,
        "image_height": height,
        "distortion_model": "equidistant" if lens.kind is LensKind.FISHEYE else brown,
        "camera_matrix": _matrix([fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0], 3),
        "distortion_coefficients": _matrix(k, 1),
    }
    return json.dumps(values, indent=4) + "\n"


def _matrix(values: list[float], rows: int) -> dict[str, Any]:
    size = {"rows": rows, "cols": len(values) // rows}
    return {"type_id": "opencv-matrix", **size, "dt": "d", "data": values}


def _coefficients(lens: Lens) -> list[float]:
    """List the coefficients of a lens without zeros at the end, as many as the model can have."""
    k: list[float] = lens.k.tolist()
    used = max((n for n, value in enumerate(k, 1) if value), default=0)
    least = 5 if lens.kind is LensKind.BROWN else 4
    return k[: min(n for n in lens.model.counts if n >= max(used, least))]


# Landmarks and a fixed position: in the coordinates of their own files


def _write_landmarks(
    new: NewProject, changes: Changes, project: Project, joint: JointSolution
) -> None:
    section, model = project.section("landmarks"), joint.model
    rows = read_by_content(LANDMARK_FORMATS, project.open("landmarks"))
    crs, marks = landmark_crs(section, rows), model.flight.landmarks
    where = f"{section.project}: [landmarks]"
    for name in marks.name:
        if name.splitlines() != [name] or name != name.strip():
            message = f"{LANDMARKS} would not have the name {shown(name)} as it is"
            raise VopdError(f"{where}: {message}: rename it here and in the picks")
    degrees = rows.geodetic or crs_is_geographic(crs_name(crs or ELLIPSOIDAL), where)

    def positions(coordinate: Floats) -> Floats:
        return earth_centred_positions(coordinate, rows.geodetic, crs, height_datum(section), where)

    wanted = marks.position_m + model.landmark_by_m(joint.state)
    free, coordinate = model.free, rows.coordinate.copy()
    coordinate[free] = coordinates_at(wanted[free], coordinate[free], positions, STEPS[degrees])
    sigma_m = marks.sigma_m.copy()
    after = np.sqrt(np.diag(covariance_by_picks(joint)[0])[model.of_landmarks])
    sigma_m[model.free] = np.minimum(after.reshape(-1, 3), sigma_m[model.free])
    columns = ["lat_deg", "lon_deg", "h_m"] if rows.geodetic else ["x_m", "y_m", "z_m"]
    grid, heights = units_of_crs(crs, where)
    in_metres = all(one.is_metre for one in (*grid, *heights))
    if degrees > rows.geodetic or not in_metres:  # as the CRS counts
        columns[:2] = columns[:2] if rows.geodetic else ["x", "y"]
        columns[2:] = [columns[2][:1]] if heights else columns[2:]
    order, digits = [1, 0, 2] if rows.geodetic else [0, 1, 2], (11, 11, 6) if degrees else (6,) * 3
    patches = [] if marks.patch_px is None else [PATCH]
    sides = np.full(len(marks.name), np.nan) if marks.patch_px is None else marks.patch_px
    lines = [",".join(["landmark", *columns, *SIGMAS, *patches])]
    numbers = coordinate[:, order].tolist(), sigma_m.tolist(), sides.tolist()
    for name, own, sigma, side in zip(marks.name, *numbers, strict=True):
        cells = [f"{value:.{n}f}" for value, n in zip(own, digits, strict=True)]
        cells += [f"{value:.6g}" if value else EXACT for value in sigma]
        cells += ["" if np.isnan(side) else f"{side:g}" for _ in patches]
        lines.append(",".join([name_cell(name), *cells]))
    new.contents[LANDMARKS] = "\n".join([*lines, ""]).encode()
    changes["landmarks", "file"], changes["landmarks", "columns"] = toml_text(LANDMARKS), None
    if crs is not None:
        changes["landmarks", "crs"] = toml_text(crs)
    new.said.append(
        f"{LANDMARKS}: {count_text(len(free), 'landmark')} as solved, with standard deviations "
        "as they are now"
    )


def _move_position(changes: Changes, project: Project, joint: JointSolution) -> None:
    """Move the place of a camera that stands."""
    section, model = project.section("position"), joint.model
    geodetic = section.has("lat_deg")
    keys = coordinate_columns(geodetic)
    crs = section.text("crs") if section.has("crs") else None
    where = f"{section.project}: [position]"
    datum = height_datum(section, project.section("landmarks"))

    def positions(coordinate: Floats) -> Floats:
        return earth_centred_positions(coordinate, geodetic, crs, datum, where)

    before = np.array([[section.number(key) for key in keys]])
    shift_m = np.array([model.value(joint.state, axis) for axis in SHIFT])
    wanted = model.flight.path.position_m[:1] + shift_m @ model.axes[0]
    after = coordinates_at(wanted, before, positions, STEPS[geodetic])[0]
    for key, value in zip(keys, after.tolist(), strict=True):
        changes["position", key] = repr(value)


# The covariance of all that is common to the frames


def _covariance_file(
    adjustment: Adjustment, source: str, free: Sequence[str], before_s: float | None,
    project: Project, new: NewProject, changes: Changes,
) -> CovarianceFile:  # fmt: skip
    """Collect parameters, their covariance, and the digests of the new project's files."""
    joint, reading = adjustment.result.estimates.joint, adjustment.result.estimates.reading
    assert joint is not None and reading is not None
    model = joint.model
    flight = model.flight
    name, unit, value, scale = [], [], [], []
    common, by_picks, further = common_with_stated(joint)
    if not len(common):
        raise VopdError(
            f"{flight.source}: nothing was solved for that all frames have in common, and so there "
            "is nothing to write: free what the picks hold"
        )
    for one in (*model.names, *further):
        factor = unit_factor(flight, one)
        name.append(shown_name(one, flight.path.stands))
        unit.append(UNIT.get(one, ""))
        value.append(stated_value(flight, one) + factor * model.value(joint.state, one))
        scale.append(factor)
    for k in model.free.tolist():
        name += [f"{LANDMARK}{flight.landmarks.name[k]} {axis}" for axis in SHIFT]
        unit += ["m"] * 3
        value += joint.state.landmark_m[k].tolist()
        scale += [1.0] * 3
    return CovarianceFile(
        source, tuple(free), tuple(name), tuple(unit), np.array(value),
        common * np.outer(scale, scale), by_picks * np.outer(scale, scale),
        int((~np.isfinite(model.common_sigma)).sum()), before_s,
        flight.picks.one_sigma_px, reading.sigma, reading.freedom, reading.source,
        _digests(project, new, changes),
    )  # fmt: skip


def common_with_stated(joint: JointSolution) -> tuple[Floats, Floats, list[str]]:
    """Estimate the covariance of all that is common to the frames, what is only stated included.

    An error s that is stated and not solved for moves what is: by dc/ds s.

    Returns:
        The covariance of the parameters of the solution, those that are only stated, and the
        landmarks of the solution; its part by the picks; and the names of the second ones.
    """
    first, last = len(joint.model.names), joint.model.of_landmarks.stop  # clicks come after
    solved, own_picks = (one[:last, :last] for one in covariance_by_picks(joint))
    sigma, moved = joint.stated[0], joint.by_stated[2][:last]  # by one sigma of each
    own = np.diag(list(sigma.values())) if sigma else np.zeros((0, 0))
    by = np.concatenate([moved[:first], own, moved[first:]])
    total, by_picks = by @ by.T, np.zeros((len(by), len(by)))
    at = np.r_[:first, first + len(sigma) : len(total)]
    total[np.ix_(at, at)] += solved
    if joint.holds_places:
        total[np.ix_(at, at)] += joint.by_held_places.of_common[:last, :last]
    by_picks[np.ix_(at, at)] = own_picks
    return total, by_picks, list(sigma)


def _digests(project: Project, new: NewProject, changes: Changes) -> dict[str, str]:
    """Digest files and keys of the new project, as far as the covariance speaks of them."""
    files: dict[str, bytes | Path] = {
        key: file.path for key, file in files_spoken_of(project).items()
    }
    for written, named in ((LENS, "[camera] lens"), (LANDMARKS, "[landmarks] file")):
        if written in new.contents:
            files[named] = new.contents[written]
    sections: dict[str, dict[str, Any]] = {}
    for (section, key), value in changes.items():
        if value is None or not value.startswith('"'):  # it names no file any more
            files.pop(f"[{section}] {key}", None)
        if value is not None:
            sections.setdefault(section, {})[key] = from_toml(value)
    return digests(files) | digests_of_keys(sections)
