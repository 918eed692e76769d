"""A project file and all the files that it names, read into a flight."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import MapGrid
from vopd.findings import Finding
from vopd.flight.coordinates import crs_name, earth_centred_positions, map_grid
from vopd.flight.files import did_you_mean, read_by_content
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, Refraction
from vopd.flight.frame_times import FrameTimes, frames_of
from vopd.flight.landmark_formats import LANDMARK_FORMATS
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows
from vopd.flight.project import Project, Section, read_project
from vopd.flight.read_lens import read_lens
from vopd.flight.read_picks import join_picks, read_pick_rows
from vopd.flight.robust_loss import LOSSES
from vopd.flight.track import height_datum, read_path
from vopd.flight.wind_formats import WIND_FORMATS
from vopd.geometry.camera_mount import DOWN, FORWARD, mount_by_angles
from vopd.geometry.earth import geodetic


def read_flight(name: str, location: str | None = None) -> Flight:
    """The flight of a project file.

    Args:
        name: the path of the project file, `flight.toml`
        location: where it is, if not under its name

    Raises:
        VopdError: where a key or a file is not as it should be
    """
    return flight_of(read_project(name, location))


@np.errstate(all="ignore")
def flight_of(project: Project) -> Flight:
    """The flight of a project whose keys have been read.

    Args:
        project: its sections

    Raises:
        VopdError: where a value or a file is not as it should be
    """
    name = project.name
    lens = read_lens(project)
    picks = read_pick_rows(project, lens.lens.size_px)
    number, times, index = frames_of(project, picks.rows)
    one = _all_as_one(project)
    if one:
        number, times, index = number[:1], _first(times), np.zeros_like(index)
    picks = picks._replace(rows=replace(picks.rows, frame=index))
    rows, landmarks, said = _landmarks(project)
    path = read_path(project, times)
    times = path.times
    _one_datum(project)

    def label(k: int) -> str:
        return "all frames" if one else times.image[k] if times.image else f"frame {number[k]}"

    joined, findings = join_picks(picks, label, landmarks.name, name)
    camera, wind_said = _with_wind(project, path.path)
    findings += [Finding(doubt, name, severity="warning") for doubt in path.doubts]
    findings += _uncovered(project, camera, label)
    return Flight(
        name=project.section("flight").text("name", default=""),
        source=name,
        lens=lens.lens,
        frame=number,
        image_name=times.image,
        time_s=times.time_s,
        epoch=times.epoch,
        picks=joined,
        landmarks=landmarks,
        path=camera,
        mount=_mount(project.section("vehicle")),
        refraction=_refraction(project.section("atmosphere")),
        options=_options(project),
        grid=_grid(project, rows, camera),
        about=(lens.said, picks.said, *filter(None, [times.said]), said, *path.said, *wind_said),
        findings=tuple(findings),
    )


def _all_as_one(project: Project) -> bool:
    """Whether all frames are one, which is so for a camera that does not move."""
    section = project.section("solve")
    one = section.text("frames", ("each", "one"), "each") == "one"
    if one and not project.has("position"):
        raise section.error("frames", '"one" is for a camera that does not move: give [position]')
    return one


def _first(times: FrameTimes) -> FrameTimes:
    return times._replace(time_s=times.time_s[:1], image=times.image[:1])


def _landmarks(project: Project) -> tuple[LandmarkRows, LandmarkSet, str]:
    section = project.section("landmarks")
    file = project.open("landmarks")
    rows = read_by_content(LANDMARK_FORMATS, file)
    doubled = [name for name, count in Counter(rows.name).items() if count > 1]
    if doubled:
        raise file.error(f"{sorted(doubled)[0]} has two positions")
    crs = _crs(section, rows)
    datum = height_datum(section)
    where = f"{section.project}: [landmarks]"
    position = earth_centred_positions(rows.coordinate, rows.geodetic, crs, datum, where)
    check = set(_known_names(project.section("solve"), "check_landmarks", rows.name))
    said = f"{file.name}: {rows.said}, {len(rows.name)} landmarks, {crs or 'WGS 84'}"
    if datum is not None:
        said += f", {datum.said}"
    return (
        rows,
        LandmarkSet(
            tuple(rows.name),
            position,
            _sigma(section, rows),
            tuple(name not in check for name in rows.name),
        ),
        said,
    )


def _crs(section: Section, rows: LandmarkRows) -> str | None:
    if rows.crs is not None:
        if section.has("crs") and crs_name(section.text("crs")) != crs_name(rows.crs):
            raise section.error("crs", f"the file says {rows.crs}: leave the key out")
        return rows.crs
    if rows.geodetic and not section.has("crs"):
        return None
    return section.text("crs")


def _known_names(section: Section, key: str, known: list[str]) -> tuple[str, ...]:
    """A list of names that must all be known."""
    found, there = section.texts(key), set(known)
    for name in found:
        if name not in there:
            raise section.error(key, f"there is no landmark {name}{did_you_mean(name, known[:20])}")
    return found


def _sigma(section: Section, rows: LandmarkRows) -> Floats:
    """East, north, up of each landmark (N, 3): the file's, else the project's, else NaN."""
    stated = section.sigma("sigma_m", 3) or (np.nan,) * 3
    own = np.tile(rows.sigma_m[:, None], 3)
    return np.where(np.isfinite(own), own, stated)


def _one_datum(project: Project) -> None:
    """Refuse heights of one unknown datum on one side only."""
    where = "track" if project.has("track") else "position"
    same = [project.section(name).values.get("height") == "same" for name in ("landmarks", where)]
    if same[0] != same[1]:
        raise project.section("landmarks" if same[0] else where).error(
            "height", f'"same" must stand in [landmarks] and in [{where}], or in neither'
        )


def _with_wind(project: Project, path: CameraPath) -> tuple[CameraPath, list[str]]:
    if not project.has("wind"):
        return path, []
    rows = read_by_content(WIND_FORMATS, project.open("wind"))
    if path.velocity_m_s is None:
        message = "is of no use: the velocity is not known without a track by time"
        raise project.section("wind").error("file", message)
    height = geodetic(path.position_m).height_m
    wind = np.stack([np.interp(height, rows.height_m, w) for w in rows.toward_m_s.T], axis=1)
    said = f"{rows.said}, linear in height, the last level held beyond the ends"
    return replace(path, wind_m_s=wind), [said]


def _uncovered(project: Project, path: CameraPath, label: Callable[[int], str]) -> list[Finding]:
    lost = np.flatnonzero(np.isnan(path.position_m[:, 0])).tolist()
    if not lost:
        return []
    named = ", ".join(map(label, lost[:3])) + (
        f" and {len(lost) - 3} more" if len(lost) > 3 else ""
    )
    return [Finding(f"the track has no position for {named}", project.name, severity="warning")]


def _mount(section: Section) -> Floats:
    """Camera axes to body axes."""
    value = section.values.get("mount", "forward")
    if isinstance(value, str):
        return {"forward": FORWARD, "down": DOWN}[section.text("mount", ("forward", "down"), value)]
    inside = section.section("mount", ("ypr_deg", "matrix"))
    if inside.has("ypr_deg"):
        return mount_by_angles(inside.numbers("ypr_deg", 3))
    rows = inside.values.get("matrix")
    try:
        matrix = np.array(rows, dtype=np.float64)
        turn = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6)
    except (TypeError, ValueError, OverflowError):
        turn = False
    if not turn or np.linalg.det(matrix) < 0.0:
        raise inside.error("matrix", "is not a rotation: three rows of three, right-handed")
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray(u @ vt)


def _refraction(section: Section) -> Refraction:
    value = section.values.get("refraction", "standard")
    if isinstance(value, dict):
        return Refraction(section.section("refraction", ("k",)).number("k"), False)
    name = section.text("refraction", ("standard", "off"), "standard")
    return Refraction() if name == "standard" else Refraction(0.0, False)


def _options(project: Project) -> FlightOptions:
    solve, doubt = project.section("solve"), project.section("uncertainty")
    x, y = doubt.sigma("principal_px", 2) or (0.0, 0.0)
    (focal,) = doubt.sigma("focal_rel") or (0.0,)
    return FlightOptions(
        solve.text("loss", list(LOSSES), "least-squares"),
        solve.text("blunders", ("name", "drop"), "name") == "drop",
        focal,
        (x, y),
    )


def _grid(project: Project, rows: LandmarkRows, path: CameraPath) -> MapGrid | None:
    crs = _crs(project.section("landmarks"), rows)
    return None if crs is None else map_grid(crs_name(crs), path.position_m)
