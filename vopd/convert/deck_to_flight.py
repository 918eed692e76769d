"""One job of 1974 cards as a flight, or as the files of its project.

Both have the deck's readings, landmarks, track and lens. The project's Earth is WGS 84, as with
`--fix all`; a flight in memory has the Earth of any run, so that both solve the same problem.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fixes
from vopd.findings import VopdError, count_text, size_text
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, Refraction
from vopd.flight.formats.lens import make_lens
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.tables import EXACT
from vopd.flight.project.inspect import NewProject
from vopd.flight.project.keys import KeyValues, project_text, toml_numbers, toml_text
from vopd.flight.project.picks import join_picks
from vopd.geometry.earth import M_PER_KM, Geodetic, geodetic
from vopd.geometry.ellipsoids import WGS84
from vopd.geometry.rotations import FORWARD, mount_by_angles
from vopd.job import Job, Landmarks, Wind
from vopd.program.average import averages
from vopd.program.constants import factor, ftpkm
from vopd.program.earth import ellipsoidal_position
from vopd.program.frames import LENS_RADII, WIND_ALTITUDES
from vopd.program.ftlup import TableOutOfOrder, ftlup
from vopd.program.ignored import kept
from vopd.program.positions import (
    TRAJECTORY_TIMES,
    earth_fixed,
    group_9,
    landmarks_earth_fixed,
    origin_of,
    time_and_position,
)
from vopd.program.vopd import radial_factor

PX_PER_IN = 1000.0
MM_PER_PX = factor / PX_PER_IN
M_PER_FT = 1000.0 / ftpkm
MARGIN_PX = 50
WIDEST_IN = 100.0  # no film reader is wider
NOTED_FT = 30.0  # in so many the wind changes by .1 ft/s, as a rule
_EXACT = f'"{EXACT}"'
HEAD = """\
A flight project, made of a deck of program VOPD (NASA TM X-3050). A pixel is a thousandth of
an inch on the film reader, counted from the frame's centre as the fiducials have it. Each of
the three readings of a point is a pick, the lens's distortion (group 1) taken off. Heights
are those of the cards, taken as above the ellipsoid as vopd run --fix all takes them; the
cards know no refraction. They do not say how exact landmarks, positions, velocities and
times are: "exact" leaves these out of the uncertainty until you write what they are; then
leave out position = "fixed", which holds the positions between those of the cards, too. The
three readings tell how exact the picks are."""


Made = TypeVar("Made")


@np.errstate(all="ignore")
def deck_project(job: Job) -> NewProject:
    """Convert a job to the files of a project.

    Returns:
        The files, and a sentence for each thing that they do not hold.

    Raises:
        VopdError: where the job has no readings, or its tables are not in order
    """
    return _checked(job, _project)


@np.errstate(all="ignore")
def deck_flight(job: Job, fixes: Fixes, source: str = "") -> Flight:
    """Convert a job to a flight in memory, on the Earth of a run of the deck.

    Landmarks, positions and times are exact, as the cards do not say how exact they are; a
    landmark that the job ignores in all frames is a check landmark. Landmarks have their numbers
    as names. There is no wind.

    Args:
        job: one job of a deck
        fixes: those of the run: with `earth` positions are those of the ellipsoid, without it
            those of the sphere of 1974
        source: the deck's name, for messages

    Raises:
        VopdError: where the job has no readings, or its tables are not in order
    """
    return _checked(job, lambda one: _flight(one, fixes, source))


def _checked(job: Job, make: Callable[[Job], Made]) -> Made:
    if not len(job.readings.frame):
        raise VopdError("the job has no frame")
    if not job.camera.focal_length_mm > MM_PER_PX:
        raise VopdError(f"group 8: a focal length of {job.camera.focal_length_mm:g} mm is none")
    try:
        return make(job)
    except TableOutOfOrder as error:
        group, variable = error.table or (0, "")
        table, what = (f"group {group}", f"{variable} ") if group else ("a table", "")
        message = f"{table}: {what}must increase, and do not at position {error.position}"
        raise VopdError(message) from error


def _project(job: Job) -> NewProject:
    """Write the files of a job whose tables are in order."""
    notes: list[str] = []
    job = _continued(job, notes)
    frame, landmark, pixel, size_px = film_picks(job, notes)
    values = _values(job, size_px, notes)
    if np.any(job.camera.lens_distortion_um):
        notes.append("the lens's distortion (group 1) is taken off the picks: the lens has none")
    numbers = np.repeat(job.readings.frame[frame], 3), np.repeat(landmark, 3)
    picks = *numbers, *pixel.reshape(-1, 2).T
    contents = {
        "picks.csv": _table("frame,landmark,u_px,v_px", *picks, form="%d,%d,%.4f,%.4f"),
        "landmarks.csv": _landmarks(job),
        "times.csv": _times(job),
    }
    if len(job.trajectory.time_s) > 1:
        contents["track.csv"] = _track(job)
    else:
        notes.append("a trajectory of one row (group 7) is a position: no velocity and no wind")
    if np.any(job.wind.velocity_ft_s) and "track.csv" in contents:
        contents["wind.csv"] = _wind(job)
        values["wind", "file"] = '"wind.csv"'
    contents["flight.toml"] = project_text(values, {}, HEAD)
    return NewProject({name: text.encode() for name, text in contents.items()}, notes)


def _continued(job: Job, notes: list[str]) -> Job:
    """Continue trajectory and wind to all frames, as FTLUP does; a project's tables end.

    A wind of one row gets a second one, by which it is the same at all altitudes.
    """
    path, wind = job.trajectory, job.wind
    time_s, _ = time_and_position(job)
    altitude_ft = ftlup(time_s, path.time_s, path.altitude_ft, TRAJECTORY_TIMES)

    def until(table: Floats, values: Floats, name: str, file: str) -> Floats:
        outside = (values < table[0]) | (values > table[-1])
        if len(table) == 1:
            return np.append(table, table + 1.0)
        if outside.any():
            count = count_text(int(outside.sum()), "frame is", "frames are")
            notes.append(f"{count} outside of {name}, and {file} goes on to there, as a run does")
            return np.unique([*table, values.min(), values.max()])
        return table

    if len(path.time_s) == 1:
        return job
    at = until(path.time_s, time_s, "the trajectory (group 7)", "track.csv")
    path = replace(
        path,
        time_s=at,
        position_ft=ftlup(at, path.time_s, path.position_ft),
        velocity_ft_s=ftlup(at, path.time_s, path.velocity_ft_s),
        altitude_ft=ftlup(at, path.time_s, path.altitude_ft),
    )
    if np.any(wind.velocity_ft_s):
        apart_ft = np.abs(_positions(job).height_m / M_PER_FT - job.trajectory.altitude_ft).max()
        if apart_ft > NOTED_FT:
            notes.append(
                f"H of group 7 is up to {size_text(float(apart_ft), 3)} ft from the altitude of X, "
                "Y, Z, by which a project looks up its wind"
            )
        at = until(wind.altitude_ft, altitude_ft, "the wind (group 4)", "wind.csv")
        wind = Wind(at, ftlup(at, wind.altitude_ft, wind.velocity_ft_s, WIND_ALTITUDES))
    return replace(job, trajectory=path, wind=wind)


def check_landmarks(job: Job) -> Ints:
    """Find the landmarks that group 12 leaves out of all frames; one that a frame keeps is none."""
    _, used = kept(job.readings, job.ignored)
    return np.setdiff1d(job.ignored.everywhere, [0, *job.readings.points.landmark[used]])


def film_picks(job: Job, notes: list[str]) -> tuple[Ints, Ints, Floats, tuple[int, int]]:
    """Convert readings to pixels of an image without distortion, three of each of n points.

    Args:
        job: gives the readings; points that it ignores in one frame are left out, those that it
            ignores in all frames are not
        notes: of points that are left out, added to

    Returns:
        Of each point the index of its frame in the job and the number of its landmark, (n,); its
        readings u, v from the first pixel's centre, (n, 3, 2); and the size of the image.

    Raises:
        VopdError: if no landmark is read in any frame
    """
    readings = job.readings
    _, first = np.unique(readings.frame, return_index=True)
    if len(first) < len(readings.frame):
        notes.append("frames that are read more than once: the first time is kept")
    once = np.zeros(len(readings.frame), bool)
    once[first] = True
    points, layout = readings.points, readings.layout
    dropped, used = kept(readings, job.ignored)
    everywhere = np.isin(points.landmark, check_landmarks(job))
    held: Bools = (used | everywhere) & (once & ~dropped)[layout.frame]
    frame, landmark = layout.frame[held], points.landmark[held]
    centre_in, point_in = averages(readings, rounded=False)
    from_centre = point_in * factor - (centre_in * factor)[layout.frame]
    radius = np.sqrt(from_centre[:, 0] ** 2 + from_centre[:, 1] ** 2)
    camera = job.camera
    delr = ftlup(radius, camera.lens_radius_mm, camera.lens_distortion_um, LENS_RADII) / -1000.0
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
    return frame, landmark, (np.array(size) - 1.0) / 2.0 - away, size


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
        values["solve", "position"] = '"fixed"'
    else:
        latitude, longitude, height = _positions(job)
        keys = ("lat_deg", "lon_deg", "h_m")
        for key, number in zip(keys, (latitude, longitude, height), strict=True):
            values["position", key] = repr(float(number[0]))
        values["position", "height"], values["position", "sigma_m"] = '"ellipsoid"', _EXACT
    check = np.intersect1d(check_landmarks(job), job.landmarks.number)
    if len(check):
        values["solve", "check_landmarks"] = str([str(n) for n in check.tolist()]).replace("'", '"')
    _mount(job, values, notes)
    return values


def _mount(job: Job, values: KeyValues, notes: list[str]) -> None:
    """Write the mount; a group 3 that is none is noted as lost."""
    turn = _roll_deg(job)
    if turn is None:
        notes.append(
            "group 3 takes the vehicle's angles from the camera's one by one, which no mount "
            "does: the project's vehicle is the camera"
        )
    elif turn:
        values["vehicle", "mount"] = f"{{ ypr_deg = {toml_numbers(0.0, 0.0, turn)} }}"


def _roll_deg(job: Job) -> float | None:
    """Find the mount's turn about the optical axis; None if group 3 is another one."""
    camera = job.camera
    if np.any(camera.multiplier != 1.0) or np.any(camera.offset_deg[:2] % 360.0):
        return None
    return -float(camera.offset_deg[2])


def _positions(job: Job) -> Geodetic:
    """Convert every row of the trajectory to latitude and longitude, degrees, height, metres."""
    xyz = job.trajectory.position_ft.T / ftpkm
    return geodetic(ellipsoidal_position(WGS84, origin_of(job), xyz).T * 1000.0)


def _table(header: str, *columns: Floats | Ints, form: str) -> str:
    rows = (form % row for row in zip(*(column.tolist() for column in columns), strict=True))
    return "\n".join([header, *rows, ""])


def _landmarks(job: Job) -> str:
    marks = once_each(job.landmarks)
    return _table(
        "landmark,lat_deg,lon_deg,h_m",
        marks.number,
        marks.latitude_deg + marks.latitude_min / 60.0,
        marks.longitude_deg + marks.longitude_min / 60.0,
        marks.altitude_ft * M_PER_FT,
        form="%d,%.10f,%.10f,%.5f",
    )


def _times(job: Job) -> str:
    frame, first = np.unique(job.readings.frame, return_index=True)
    time_s = time_and_position(job)[0][first]
    later = np.diff(time_s) > 0.0
    if not later.all():
        at = frame[int(later.argmin()) + 1]
        raise VopdError(f"group 6: times must increase with the frames, and do not at frame {at}")
    return _table("frame,t_s", frame, time_s, form="%d,%.9f")


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


# A flight in memory

SAID_EXACT = ("position", "landmark", "time", "velocity")


def _flight(job: Job, fixes: Fixes, source: str) -> Flight:
    picked, landmark, pixel, size_px = film_picks(job, [])
    frame, first = np.unique(job.readings.frame, return_index=True)
    seen = np.isin(first, picked)
    frame, first = frame[seen], first[seen]
    time_s, vehicle_ft = (part[first] for part in time_and_position(job))
    path = job.trajectory
    velocity = ftlup(time_s, path.time_s, path.velocity_ft_s, TRAJECTORY_TIMES) * M_PER_FT
    marks = once_each(job.landmarks)
    names = tuple(map(str, marks.number.tolist()))
    pixels = pixel.reshape(-1, 2)
    read = PickRows(
        frame=np.repeat(np.searchsorted(frame, job.readings.frame[picked]), 3),
        landmark=Names(map(str, np.repeat(landmark, 3).tolist())),
        pixel=pixels,
        sigma_px=np.ones(len(pixels)),
        grid="centre",
        size_px=size_px,
        said="",
    )
    picks, findings = join_picks(read, lambda k: f"frame {frame[k]}", names, source)
    focal_px = job.camera.focal_length_mm / MM_PER_PX
    centre = (size_px[0] - 1) / 2.0, (size_px[1] - 1) / 2.0
    turn = _roll_deg(job)
    return Flight(
        name=job.title[1:].strip(),
        source=source,
        lens=make_lens("brown", size_px, (focal_px, focal_px), centre),
        frame=frame,
        image_name=(),
        time_s=time_s,
        epoch=None,
        picks=picks,
        landmarks=LandmarkSet(
            names,
            landmark_positions_m(marks, fixes),
            np.zeros((len(names), 3)),
            tuple((~np.isin(marks.number, check_landmarks(job))).tolist()),
        ),
        path=CameraPath(
            earth_fixed(origin_of(job), fixes, vehicle_ft) * M_PER_KM,
            velocity_m_s=velocity,
            velocity_sigma_m_s=np.zeros_like(velocity),
            acceleration_m_s2=np.zeros_like(velocity),
        ),
        mount=mount_by_angles([0.0, 0.0, turn]) if turn else FORWARD,
        refraction=Refraction(0.0, False),
        options=FlightOptions(exact=SAID_EXACT, may_misfit=False),
        findings=tuple(findings),
    )


def once_each(marks: Landmarks) -> Landmarks:
    """Take each landmark of group 9 once: as it was given last."""
    last = {number: k for k, number in enumerate(marks.number.tolist())}
    return marks.take(np.array(list(last.values()), dtype=np.int64))


def landmark_positions_m(marks: Landmarks, fixes: Fixes) -> Floats:
    """Place landmarks in Earth-fixed axes, metres (n, 3), as a run does.

    Args:
        marks: of group 9
        fixes: those of the run
    """
    return landmarks_earth_fixed(*group_9(marks, fixes)) * M_PER_KM
