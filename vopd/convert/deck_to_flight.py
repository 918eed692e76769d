"""One job of 1974 cards as a flight project: the same readings, landmarks, track and lens."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError, count_text
from vopd.flight.files import EXACT
from vopd.flight.new import NewProject
from vopd.flight.project import KeyValues, project_text, toml_numbers, toml_text
from vopd.geometry.earth import Geodetic, geodetic
from vopd.geometry.ellipsoids import WGS84
from vopd.geometry.film_lens import radial_factor
from vopd.job import Job
from vopd.program.average import averages
from vopd.program.constants import factor, ftpkm
from vopd.program.earth import ellipsoidal_position
from vopd.program.frames import LENS_RADII
from vopd.program.ftlup import TableOutOfOrder, check_order, ftlup
from vopd.program.ignored import kept
from vopd.program.positions import TRAJECTORY_TIMES, origin_of, time_and_position

PX_PER_IN = 1000.0
MM_PER_PX = factor / PX_PER_IN
M_PER_FT = 1000.0 / ftpkm
MARGIN_PX = 50
WIDEST_IN = 100.0  # no film reader is wider
_EXACT = f'"{EXACT}"'
HEAD = """\
A flight project, made of a deck of program VOPD (NASA TM X-3050). A pixel is a thousandth of
an inch on the film reader, counted from the frame's centre as the fiducials have it. Each of
the three readings of a point is a pick, the lens's distortion (group 1) taken off. Heights
are those of the cards, taken as above the ellipsoid as vopd run --fix all takes them; the
cards know no refraction. They do not say how exact landmarks, positions, velocities and
times are: "exact" leaves these out of the uncertainty until you write what they are. The
three readings tell how exact the picks are."""


@np.errstate(all="ignore")
def deck_project(job: Job) -> NewProject:
    """Convert a job to the files of a project.

    Args:
        job: one job of a deck

    Returns:
        The files, and a sentence for each thing that they do not hold.

    Raises:
        VopdError: where the job has no readings, or its tables are not in order
    """
    if not len(job.readings.frame):
        raise VopdError("the job has no frame")
    if not job.camera.focal_length_mm > MM_PER_PX:
        raise VopdError(f"group 8: a focal length of {job.camera.focal_length_mm:g} mm is none")
    try:
        return _project(job)
    except TableOutOfOrder as error:
        group, variable = error.table or (0, "")
        table, what = (f"group {group}", f"{variable} ") if group else ("a table", "")
        message = f"{table}: {what}must increase, and do not at position {error.position}"
        raise VopdError(message) from error


def _project(job: Job) -> NewProject:
    """Write the files of a job whose tables are in order."""
    path = job.trajectory
    check_order(1, path.time_s, path.altitude_ft, TRAJECTORY_TIMES)
    notes: list[str] = []
    picks, size_px = _picks(job, notes)
    values = _values(job, size_px, notes)
    if np.any(job.camera.lens_distortion_um):
        notes.append("the lens's distortion (group 1) is taken off the picks: the lens has none")
    contents = {
        "picks.csv": picks,
        "landmarks.csv": _landmarks(job),
        "times.csv": _times(job),
    }
    if len(job.trajectory.time_s) > 1:
        contents["track.csv"] = _track(job)
    if np.any(job.wind.velocity_ft_s):
        contents["wind.csv"] = _wind(job)
        values["wind", "file"] = '"wind.csv"'
    contents["flight.toml"] = project_text(values, {}, HEAD)
    return NewProject({name: text.encode() for name, text in contents.items()}, notes)


def _picks(job: Job, notes: list[str]) -> tuple[str, tuple[int, int]]:
    """Tabulate readings as picks without distortion; and the size of their image."""
    readings = job.readings
    _, first = np.unique(readings.frame, return_index=True)
    if len(first) < len(readings.frame):
        notes.append("frames that are read more than once: the first time is kept")
    once = np.zeros(len(readings.frame), bool)
    once[first] = True
    points, layout = readings.points, readings.layout
    dropped, used = kept(readings, job.ignored)
    everywhere = np.isin(points.landmark, job.ignored.everywhere)
    held: Bools = (used | everywhere) & (once & ~dropped)[layout.frame]
    frame, landmark = layout.frame[held], points.landmark[held]
    centre_in, point_in = averages(readings, rounded=False)
    from_centre = point_in * factor - (centre_in * factor)[layout.frame]
    radius = np.sqrt(from_centre[:, 0] ** 2 + from_centre[:, 1] ** 2)
    camera = job.camera
    delr = ftlup(radius, 1, camera.lens_radius_mm, camera.lens_distortion_um, LENS_RADII) / -1000.0
    scale = radial_factor(radius, delr)[held]
    away = (points.landmark_in[held] - centre_in[frame, None]) * PX_PER_IN
    away = away * scale[:, None, None]
    near = (np.abs(away) < WIDEST_IN * PX_PER_IN).all(axis=(1, 2))
    if not near.all():
        count = int((~near).sum())
        which = count_text(count, "point is", "points are")
        notes.append(f"{which} read more than {WIDEST_IN:.0f} in from the centre and left out")
        frame, landmark, away = frame[near], landmark[near], away[near]
    if not near.any():
        raise VopdError("no landmark is read in any frame")
    half = np.ceil(np.abs(away).max(axis=(0, 1), initial=1.0)) + MARGIN_PX
    size = int(2 * half[0]), int(2 * half[1])
    pixel = (np.array(size) - 1.0) / 2.0 - away.reshape(-1, 2)
    numbers = np.repeat(readings.frame[frame], 3), np.repeat(landmark, 3)
    text = _table("frame,landmark,u_px,v_px", *numbers, *pixel.T, form="%d,%d,%.4f,%.4f")
    return text, size


def _values(job: Job, size_px: tuple[int, int], notes: list[str]) -> KeyValues:
    """Fill in the keys of flight.toml."""
    path, focal_px = job.trajectory, job.camera.focal_length_mm / MM_PER_PX
    values: KeyValues = {
        ("flight", "name"): toml_text(job.title[1:].strip()),
        ("camera", "lens"): f'{{ model = "brown", fx_px = {focal_px!r} }}',
        ("camera", "image_size_px"): toml_numbers(*size_px),
        ("picks", "file"): '"picks.csv"',
        ("picks", "pixel_grid"): '"centre"',
        ("picks", "times"): '"times.csv"',
        ("landmarks", "file"): '"landmarks.csv"',
        ("landmarks", "height"): '"ellipsoid"',
        ("landmarks", "sigma_m"): _EXACT,
        ("atmosphere", "refraction"): '"off"',
    }
    if len(path.time_s) > 1:
        values["track", "file"], values["track", "height"] = '"track.csv"', '"ellipsoid"'
        for key in ("sigma_m", "sigma_t_s", "velocity_sigma_m_s"):
            values["track", key] = _EXACT
    else:
        latitude, longitude, height = _positions(job)
        keys = ("lat_deg", "lon_deg", "h_m")
        for key, number in zip(keys, (latitude, longitude, height), strict=True):
            values["position", key] = repr(float(number[0]))
        values["position", "height"], values["position", "sigma_m"] = '"ellipsoid"', _EXACT
    check = np.unique(job.ignored.everywhere[job.ignored.everywhere > 0])
    check = check[np.isin(check, job.landmarks.number)]
    if len(check):
        values["solve", "check_landmarks"] = str([str(n) for n in check.tolist()]).replace("'", '"')
    _mount(job, values, notes)
    return values


def _mount(job: Job, values: KeyValues, notes: list[str]) -> None:
    """Write the mount: a turn about the optical axis; any other group 3 is noted as lost."""
    camera = job.camera
    if np.any(camera.multiplier != 1.0) or np.any(camera.offset_deg[:2] % 360.0):
        notes.append(
            "group 3 takes the vehicle's angles from the camera's one by one, which no mount "
            "does: the project's vehicle is the camera"
        )
    elif camera.offset_deg[2]:
        turn = toml_numbers(0.0, 0.0, -camera.offset_deg[2])
        values["vehicle", "mount"] = f"{{ ypr_deg = {turn} }}"


def _positions(job: Job) -> Geodetic:
    """Convert every row of the trajectory to latitude and longitude, degrees, height, metres."""
    xyz = job.trajectory.position_ft.T / ftpkm
    return geodetic(ellipsoidal_position(WGS84, origin_of(job), xyz).T * 1000.0)


def _table(header: str, *columns: Floats | Ints, form: str) -> str:
    rows = (form % row for row in zip(*(column.tolist() for column in columns), strict=True))
    return "\n".join([header, *rows, ""])


def _landmarks(job: Job) -> str:
    """Tabulate the landmarks; one that is given twice counts as it was given last."""
    marks = job.landmarks
    last = {number: k for k, number in enumerate(marks.number.tolist())}
    rows = np.array(list(last.values()), dtype=np.int64)
    return _table(
        "landmark,lat_deg,lon_deg,h_m",
        marks.number[rows],
        (marks.latitude_deg + marks.latitude_min / 60.0)[rows],
        (marks.longitude_deg + marks.longitude_min / 60.0)[rows],
        marks.altitude_ft[rows] * M_PER_FT,
        form="%d,%.10f,%.10f,%.5f",
    )


def _times(job: Job) -> str:
    frame, first = np.unique(job.readings.frame, return_index=True)
    return _table("frame,t_s", frame, time_and_position(job)[0][first], form="%d,%.9f")


def _track(job: Job) -> str:
    path = job.trajectory
    return _table(
        "t_s,lat_deg,lon_deg,h_m,vn_m_s,ve_m_s,vd_m_s",
        path.time_s,
        *_positions(job),
        *(path.velocity_ft_s * M_PER_FT).T,
        form="%.9f,%.11f,%.11f,%.6f,%.6f,%.6f,%.6f",
    )


def _wind(job: Job) -> str:
    """Tabulate the wind: the direction from which it blows, and its speed."""
    north, east = job.wind.velocity_ft_s.T * M_PER_FT
    return _table(
        "h_m,from_deg,speed_m_s",
        job.wind.altitude_ft * M_PER_FT,
        np.degrees(np.arctan2(-east, -north)) % 360.0,
        np.hypot(north, east),
        form="%.4f,%.7f,%.6f",
    )
