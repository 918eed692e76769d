"""Read a project file and all files that it names into a flight."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TypeVar

import numpy as np

from vopd.arrays import Floats
from vopd.findings import (
    Finding,
    NeededError,
    VopdError,
    count_text,
    did_you_mean,
    first_of,
    raise_all,
)
from vopd.flight.coordinates import (
    crs_name,
    doubt_of_heights,
    earth_centred_positions,
    level_of_heights_m,
    map_grid,
    outside_area,
)
from vopd.flight.flight import (
    CameraPath,
    Flight,
    LandmarkSet,
    Refraction,
    Shutter,
    VehicleAttitudes,
)
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.landmarks import LANDMARK_FORMATS, LandmarkRows
from vopd.flight.formats.picks import LEAST_PX, PICK_FORMATS, SMALL_SIGMA, Names, PickRows
from vopd.flight.formats.tables import COMMENTS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.formats.wind import WIND_FORMATS
from vopd.flight.project.camera import CameraLens, doubts_of_lens, doubts_of_tags, read_camera
from vopd.flight.project.covariance import with_held, with_stated_offset
from vopd.flight.project.keys import ROWS, Project, Section, read_project
from vopd.flight.project.picks import COPIED_PX, join_picks, sizes_px
from vopd.flight.project.stated import (
    Notes,
    RowSigmas,
    doubts_of_rounding,
    flight_options,
    lines_to_add,
    refuse_missing,
    row_sigmas,
)
from vopd.flight.project.times import FrameTimes, doubt_of_years, frames_of, number_frames
from vopd.flight.project.track import (
    covering_text,
    height_datum,
    level_said,
    read_path,
    refuse_other_level,
)
from vopd.flight.project.unused import unused_keys
from vopd.flight.solve.free import check_free
from vopd.flight.solve.readout import frame_interval_s
from vopd.geometry.earth import geodetic
from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles
from vopd.inputs import LONGEST_NAME, MOST_NUMBER, beyond_sigmas
from vopd.video import twins_text

R = TypeVar("R")
COPIED = (
    "picks of one landmark in one frame are the same to the last digit: if these are copies, "
    "remove them, for they make the angles look surer than they are"
)
NO_POSITION = "the track has no position for"
LONGEST_READOUT = 1.1  # of a rolling shutter, in the time from a frame to the next
SHORTEST_READOUT_S = 0.0005  # of a rolling shutter: less is a second in the place of a millisecond
ONLY_CLICKS = (
    "only the frames with clicks are solved; vopd track follows the clicks through the video"
)


def read_pick_rows(project: Project, camera: CameraLens) -> PickRows:
    """Read all picks of a project, with their standard deviations and how pixels are counted.

    Raises:
        VopdError: where the grid is not known, a pick is not finite, or the images are not those
            of the lens
    """
    section = project.section("picks")
    if section.has("tracked_from") and not section.has("tracked"):
        raise section.error("tracked_from", "is of the key tracked, which is missing")
    tracked, not_yet = section.has("tracked"), ""
    if tracked and section.text("tracked_from") == "clicks":
        from vopd.flight.project.tracked_picks import read_tracked_picks  # of few flights

        if camera.several:
            message = "picks tracked from clicks are of one camera's video: give [camera] lens"
            raise project.section("camera").error("of_images", message)
        if not project.awaits_tracks():
            return read_tracked_picks(project, camera.read.lens.size_px)
        tracked, not_yet = False, f"{section.text('tracked')} is not there: {ONLY_CLICKS}"
        require_clicks(project)
    file = project.open("picks", "tracked" if tracked else "file")
    rows = project.read("picks", file, PICK_FORMATS)
    frames = rows.frame.known if isinstance(rows.frame, Names) else []
    _refuse_long(file, [*rows.landmark.known, *frames])
    if tracked:
        rows = replace(rows, interpolated=np.ones(len(rows.landmark), bool))
    elif section.text("interpolated") == "drop" and rows.interpolated is not None:
        if rows.interpolated.all():
            message = (
                f'"drop" leaves no pick of {file.name}: a program has interpolated all of them'
            )
            raise section.error("interpolated", message)
        rows = rows.where(~rows.interpolated)
    finite = np.isfinite(rows.pixel).all(axis=1)
    if not finite.all():
        k = int(np.argmin(finite))
        raise file.error(f"{rows.landmark[k]} in {rows.frame[k]}: u or v is not finite")
    far = np.abs(rows.pixel).max(axis=1, initial=0.0)
    if (far > MOST_NUMBER).any():
        k = int(np.argmax(far))
        raise file.error(f"{rows.landmark[k]} in {rows.frame[k]}: {far[k]:g} px is too large")
    size_px = sizes_px(section, file, rows, camera)
    if rows.by_size:
        long = size_px.max(axis=-1, keepdims=True)
        rows = replace(rows, pixel=rows.pixel * long + (size_px - 1.0) / 2.0)
    grid = rows.grid or section.text("pixel_grid")
    if section.has("pixel_grid") and section.text("pixel_grid") != grid:
        raise section.error("pixel_grid", f"{rows.said} has the {grid} grid: leave the key out")
    way, v_said = section.text("v"), rows.grid is not None
    if v_said and way == "up":
        raise section.error("v", f"v counts down in {file.name}: leave the key out")
    up_from = size_px[..., 1] - 1.0 if way == "up" else None
    stated = section.number("sigma_px")
    if beyond := beyond_sigmas([stated]):
        raise section.error("sigma_px", beyond)
    own = np.isfinite(rows.sigma_px)
    sigma = np.where(own, rows.sigma_px, stated) if own.any() else np.broadcast_to(stated, own.size)
    said = f"{file.name}: {rows.said}, {count_text(len(sigma), 'pick')}, {grid} grid, v {way}"
    known = section.has("sigma_px") or bool(own.all())
    some = ""
    if own.any() and not known:  # some are stated, and the others are of no known size
        lacking = count_text(len(own) - int(own.sum()), "pick")
        some = (
            f"{file.name}: {lacking} of {len(own)} without sigma_px: they count {stated:g} px "
            "beside the others, and the residuals say how much all are off; [picks] sigma_px "
            "states it"
        )
    doubts = (*rows.doubts, *filter(None, [not_yet, some]))
    return replace(
        rows, grid=grid, up_from=up_from, v_said=v_said, sigma_px=sigma, stated=known, said=said,
        doubts=doubts,
    )  # fmt: skip


def require_clicks(project: Project) -> None:
    """Check that the file of clicks is there.

    Raises:
        VopdError: with the command that makes the page to click on
    """
    section = project.section("picks")
    clicks = section.text("file")
    if not (project.folder / clicks).exists():
        raise section.error(
            "file",
            f"{clicks} is not there: vopd pick {quote(project.name)} -o pick.html makes the page "
            f"to click on, and your browser saves {clicks} among its downloads: move it to "
            f"{project.folder}",
        )


# The flight of a project file


def read_flight(name: str, location: str | None = None) -> Flight:
    """Read the flight of a project file.

    Args:
        name: the path of the project file, `flight.toml`
        location: where it is, if not under its name

    Raises:
        VopdError: where keys or files are not as they should be, all that are
    """
    return flight_or_errors(read_project(name, location))


def flight_or_errors(project: Project) -> Flight:
    """Read the files of a project as `flight_of` does, each of them also where another is wrong.

    The sizes of pictures are looked at here, once, and not for each trial of another reading.

    Raises:
        VopdError: with the errors of all files
    """
    try:
        return _with_doubt_of_size(flight_of(project))
    except VopdError as error:
        raise_all([error, *_further_errors(project, error)])
        raise


def _with_doubt_of_size(flight: Flight) -> Flight:
    """Warn of a picture of another size than its lens, among the first that the project names."""
    if not flight.video:
        return flight
    from vopd.flight.formats.photographs import MOST_SIZES, other_size  # of few flights

    other = other_size(flight, MOST_SIZES)
    found = [Finding(other, flight.source, severity="warning")] if other else []
    return replace(flight, findings=(*flight.findings, *found))


def flight_of(project: Project, rows: PickRows | None = None) -> Flight:
    """Read the files of a project whose keys have been read.

    Args:
        project: its sections
        rows: picks that take the place of its own

    Raises:
        VopdError: where a value or a file is not as it should be; all values that are missing are
            named at once
    """
    try:
        return _flight_of(project, rows)
    except NeededError as error:
        from vopd.flight.project.new import open_keys  # what no file says, as for a new project

        keys = open_keys(project)
        if len(keys) < 2 or all(ROWS[one].kind == "sigma" for one in keys):
            raise
        raise NeededError(
            f"{project.name}: {len(keys)} values are needed that no file has. Add these lines, "
            f"with values of your own:\n{lines_to_add(keys)}"
        ) from error


def _further_errors(project: Project, first: VopdError) -> list[VopdError]:
    """Find errors beside the first by reading each file of a project by itself."""
    errors: list[VopdError] = []

    def found(read: Callable[[], R]) -> R | None:
        try:
            return read()
        except VopdError as error:
            errors.append(error)
            return None

    camera = found(lambda: read_camera(project))
    picks = found(lambda: read_pick_rows(project, camera)) if camera else None
    frames = found(lambda: frames_of(project, picks)) if picks else None
    found(lambda: _landmarks(project, Notes([], {})))
    if frames:
        found(lambda: read_path(with_stated_offset(project), frames[1]))
    elif project.has("track"):
        found(lambda: project.read("track", project.open("track"), TRACK_FORMATS))
    if project.has("wind"):
        found(lambda: read_by_content(WIND_FORMATS, project.open("wind")))
    epoch = project.section("flight").date("epoch")
    times = frames[1] if frames else FrameTimes(np.zeros(0), (), epoch)
    found(lambda: shutter_of(project.section("camera")))
    found(lambda: mount_of(project.section("vehicle")))
    found(lambda: _vehicle(project, 0.0, times))
    # which the first one names, where all values that are needed are known
    all_needed = isinstance(first, NeededError) and "\n" in str(first)
    return [one for one in errors if not (all_needed and isinstance(one, NeededError))]


@np.errstate(all="ignore")
def _flight_of(project: Project, given: PickRows | None) -> Flight:
    name = project.name
    camera_lens = read_camera(project)
    lens, picks = camera_lens.read, given or read_pick_rows(project, camera_lens)
    number, times, index = frames_of(project, picks)
    one = _all_as_one(project)
    flight_name, frames = project.section("flight").text("name"), len(number)
    turned: list[str] = []
    if one:
        if picks.tracks is None:
            from vopd.flight.project.turned import doubts_of_turn  # of few flights

            names = times.image or [f"frame {k}" for k in number.tolist()]
            turned = doubts_of_turn(picks, index, names)
        noun = "image" if times.image else "frame"
        flight_name += f"{', ' if flight_name else ''}{count_text(frames, noun)} solved as one"
        number, times, index = number[:1], _first(times), np.zeros_like(index)
    picks = replace(picks, frame=index)
    notes = Notes([], {})
    rows, landmarks = _landmarks(project, notes)
    path = read_path(with_stated_offset(project), times)
    times = path.times
    refuse_missing(project, notes.missing | path.missing)
    _one_datum(project, rows.heights, "" if path.rows is None else path.rows.heights)

    def label(k: int) -> str:
        return "all frames" if one else times.image[k] if times.image else f"frame {number[k]}"

    if picks.tracks is not None:
        if one:
            message = '"one" is for picks of a camera that does not turn, not for tracked ones'
            raise project.section("solve").error("frames", message)
        from vopd.flight.project.tracked_picks import hidden_marks, join_tracks  # likewise

        hidden = hidden_marks(project, landmarks.name)
        joined, findings = join_tracks(picks, number, landmarks.name, name, hidden)
        clicked, of_clicks = _join_clicks(project, camera_lens, landmarks.name)
        joined = replace(joined, unused=clicked - {*joined.landmark.tolist()})
        findings += [one for one in of_clicks if one not in findings]
    else:
        joined, findings = join_picks(picks, label, landmarks.name, name)
        if joined.repeatability_px < COPIED_PX:
            findings.append(Finding(COPIED, name, severity="warning"))
    crs = landmark_crs(project.section("landmarks"), rows)
    camera, wind_said, wind_doubts = add_wind(project, path.path, crs)
    outside = outside_area(crs, landmarks.position_m)
    doubts = [*picks.doubts, *turned, *times.doubts, *rows.doubts, *path.doubts, *wind_doubts]
    doubts += [f"[landmarks] crs: {outside}"] if outside else []
    if picks.commented:
        from vopd.flight.project.commented import doubts_of_comments  # of few flights

        known = (*times.image, *landmarks.name)
        doubts += doubts_of_comments(project, picks.commented, known)
    doubts += doubt_of_years(times, label)
    doubts += _doubt_of_geoids(project, path.path.position_m, landmarks.position_m)
    doubts += doubt_of_heights("landmarks", rows.names_units, crs)
    file = project.section("landmarks").text("file")
    doubts += doubts_of_rounding(
        "landmarks", file, rows.coordinate, rows.geodetic, crs, landmarks.sigma_m
    )
    if (sigma_px := project.section("picks").number("sigma_px")) < LEAST_PX:
        doubts.append(f"[picks] sigma_px: {sigma_px:g} {SMALL_SIGMA}")
    for where, own in camera_lens.lenses.items():
        doubts += doubts_of_lens(own, where)
        if path.rows is not None and len(camera_lens.lenses) == 1:
            doubts += doubts_of_tags(path.rows.tags, times.image, own)
    shutter, section = shutter_of(project.section("camera")), project.section("picks")
    rate_hz = section.number("frame_rate_hz") if section.has("frame_rate_hz") else None
    interval_s = frame_interval_s(number, times.time_s, times.image, rate_hz)
    if shutter is not None and shutter.readout_s > LONGEST_READOUT * interval_s:
        frame = f"a frame of {1e3 * interval_s:.4g} ms"
        doubts.append(
            f"[camera] readout_ms: {1e3 * shutter.readout_s:g} is longer than {frame}: write the "
            "milliseconds from the first row to the last, 10 to 30 of most cameras, or the frames' "
            f"own [picks] {'frame_rate_hz' if rate_hz else 'times'}"
        )
    if shutter is not None and shutter.readout_s < SHORTEST_READOUT_S:
        doubts.append(
            f"[camera] readout_ms: {1e3 * shutter.readout_s:g} ms are less than any rolling "
            "shutter takes: is it in seconds? Of most cameras it is 10 to 30"
        )
    findings += [Finding(doubt, name, severity="warning") for doubt in doubts]
    findings += frames_uncovered(project, camera, times, label)
    findings += [
        Finding(one, name, severity="warning")
        for one in unused_keys(project, camera_lens.leaves_out)
    ]
    refraction = refraction_of(project.section("atmosphere"))
    offset_s = project.section("track").number("offset_s") if project.has("track") else 0.0
    flight = Flight(
        name=flight_name,
        source=name,
        lens=camera_lens.of_names(times.image or [str(one) for one in number.tolist()]),
        frame=number,
        image_name=times.image,
        time_s=times.time_s,
        epoch=times.epoch,
        picks=joined,
        landmarks=landmarks,
        path=camera,
        mount=mount_of(project.section("vehicle")),
        mount_sigma_deg=(project.section("vehicle").sigma("mount_sigma_deg") or (0.0,))[0],
        vehicle=_vehicle(project, offset_s, times),
        refraction=refraction,
        shutter=shutter,
        frame_rate_hz=rate_hz,
        offset_s=offset_s,
        options=flight_options(project, camera_lens, refraction, camera, landmarks),
        own_level=project.section("landmarks").values.get("height") == "same",
        grid=None if crs is None else map_grid(crs_name(crs), camera.position_m),
        folder=project.folder.absolute(),
        video=_video(project),
        about=(
            *(lens.said, picks.said),
            *filter(None, [times.said]),
            *(*notes.said, *path.said, *wind_said),
        ),
        findings=tuple(findings),
    )
    check_free(flight)
    return with_held(project, flight)


def _join_clicks(
    project: Project, camera: CameraLens, landmarks: tuple[str, ...]
) -> tuple[frozenset[int], list[Finding]]:
    """Join the clicks that a tracked file was made of, to tell which take no part.

    Returns:
        The landmarks that are clicked, by their indices, and what `vopd track` has said of clicks.
    """
    section = project.section("picks")
    if not (section.has("file") and (project.folder / section.text("file")).exists()):
        return frozenset(), []
    rows = read_pick_rows(project.without("picks", "tracked", "tracked_from"), camera)
    number, image, index = number_frames(rows.frame)

    def label(k: int) -> str:
        return image[k] if image else f"frame {number[k]}"

    joined, findings = join_picks(replace(rows, frame=index), label, landmarks, project.name)
    return joined.unused | {*joined.landmark.tolist()}, findings


def _video(project: Project) -> tuple[Path, ...]:
    """Find the files of the video that was picked in."""
    section = project.section("picks")
    names = section.files("video") if section.has("video") else ()
    return tuple(project.folder.absolute() / name for name in names)


def _all_as_one(project: Project) -> bool:
    """Tell whether all frames are one, which is so for a camera that does not move."""
    section = project.section("solve")
    one = section.text("frames") == "one"
    if one and not project.has("position"):
        raise section.error("frames", '"one" is for a camera that does not move: give [position]')
    return one


def _first(times: FrameTimes) -> FrameTimes:
    return times._replace(time_s=times.time_s[:1], image=times.image[:1])


def _landmarks(project: Project, notes: Notes) -> tuple[LandmarkRows, LandmarkSet]:
    section = project.section("landmarks")
    file = project.open("landmarks")
    rows = read_by_content(LANDMARK_FORMATS, file)
    if not rows.name:
        below = file.head.splitlines()[1:]
        commented = f": {COMMENTS}" * any(line.lstrip().startswith("#") for line in below)
        raise file.error(f"no landmark is in the file{commented}")
    _refuse_long(file, rows.name)
    doubled = [name for name, count in Counter(rows.name).items() if count > 1]
    if doubled:
        name = sorted(doubled)[0]
        at = [rows.line[k] for k, one in enumerate(rows.name) if one == name]
        where = f", in lines {at[0]} and {at[1]}" if at[0] else ""
        raise file.error(f"{name} has two positions{where}")
    crs = landmark_crs(section, rows)
    datum = height_datum(section)
    refuse_other_level(section, rows.heights)
    where = f"{section.project}: [landmarks]"
    position = earth_centred_positions(rows.coordinate, rows.geodetic, crs, datum, where)
    check = set(_known_names(project.section("solve"), "check_landmarks", rows.name))
    system = crs or "WGS 84"
    if system.startswith("+"):  # which a spreadsheet would take for a formula
        system = f"PROJ {system}"
    said = f"{file.name}: {rows.said}, {count_text(len(rows.name), 'landmark')}, {system}"
    if datum is not None:
        said += f", {datum.said}"
    notes.said.append(said)
    own = RowSigmas(file.name, rows.sigma_m, len(rows.name), rows.line, rows.sigma_by)
    sigma_m = row_sigmas(section, "sigma_m", own, notes)
    used = tuple(name not in check for name in rows.name)
    return rows, LandmarkSet(tuple(rows.name), position, sigma_m, used, rows.patch_px)


def _refuse_long(file: InputFile, names: Iterable[str]) -> None:
    """Refuse names that no message could show."""
    longest = max(names, key=len, default="")
    if len(longest) > LONGEST_NAME:
        line = file.line_of(longest)
        raise file.error(f"a name of {len(longest)} characters: {LONGEST_NAME} at most", line)


def landmark_crs(section: Section, rows: LandmarkRows) -> str | None:
    """Choose the coordinate reference system of landmarks: the file's, or the project's."""
    if rows.crs is not None:
        if section.has("crs") and crs_name(section.text("crs")) != crs_name(rows.crs):
            raise section.error("crs", f"the file says {rows.crs}: leave the key out")
        return rows.crs
    if rows.geodetic and not section.has("crs"):
        return None
    return section.text("crs")


def _known_names(section: Section, key: str, known: list[str]) -> tuple[str, ...]:
    """Check a list of names that must all be known."""
    found, there = section.texts(key), set(known)
    for name in found:
        if name not in there:
            raise section.error(key, f"there is no landmark {name}{did_you_mean(name, known[:20])}")
    return found


def _one_datum(project: Project, of_landmarks: str, of_track: str) -> None:
    """Refuse heights of one unknown datum on one side only, or in columns of two levels.

    Args:
        project: its sections
        of_landmarks: the column of their heights, as the file names it
        of_track: likewise of the camera
    """
    where = "track" if project.has("track") else "position"
    given = [project.section(name).values.get("height") for name in ("landmarks", where)]
    from_ground = isinstance(given[1], dict) and "ground_m" in given[1]
    same = [height == "same" for height in given]
    if same[0] != same[1] and not from_ground:
        raise project.section("landmarks" if same[0] else where).error(
            "height", f'"same" must stand in [landmarks] and in [{where}], or in neither'
        )
    levels = [level_said(one) for one in (of_landmarks, of_track)]
    if all(same) and all(levels) and levels[0] != levels[1]:
        raise project.section(where).error(
            "height",
            f'"same", and by their names column {of_landmarks} of the landmarks counts from '
            f"{levels[0]}, and column {of_track} from {levels[1]}: say which with each",
        )


GEOID_SLOPE = 5e-4  # the steepest deflection of the vertical, 100 seconds of arc
GEOID_ROUNDED_M = 1.0
MOST_GEOID_M = 110.0  # a level that is farther from the ellipsoid is the ground's


def _doubt_of_geoids(project: Project, position_m: Floats, landmarks_m: Floats) -> list[str]:
    """Warn of two heights of the geoid that are farther apart than it can be between the places.

    Args:
        project: its sections
        position_m: of the camera, (F, 3)
        landmarks_m: of the landmarks, (N, 3)
    """
    where = "track" if project.has("track") else "position"
    given = [project.section(name).values.get("height") for name in ("landmarks", where)]
    level_m = [one["undulation_m"] for one in given if isinstance(one, dict) and len(one) == 1
               and "undulation_m" in one]  # fmt: skip
    if len(level_m) < 2 or max(map(abs, level_m)) > MOST_GEOID_M:
        return []
    every_m = np.concatenate([position_m, landmarks_m])
    apart_m = np.linalg.norm(np.nanmax(every_m, axis=0) - np.nanmin(every_m, axis=0))
    most_m = GEOID_ROUNDED_M + GEOID_SLOPE * float(apart_m)
    if abs(level_m[0] - level_m[1]) <= most_m:
        return []
    return [
        f"[{where}] height: a geoid {level_m[1]:g} m above the ellipsoid, and {level_m[0]:g} m at "
        f"the landmarks: within their distance it changes by {most_m:.2g} m at most; write the "
        "same number in both, unless one counts from the ground"
    ]


SAME_LEVEL_M = 1e-3  # between levels of heights: that of the ellipsoid is no geoid's
WIND_BEYOND_M = 500.0  # of the wind's levels: how far away they are is said
FASTEST_WIND_M_S = 150.0  # faster than any jet stream


def add_wind(
    project: Project, path: CameraPath, crs: str | None
) -> tuple[CameraPath, list[str], list[str]]:
    """Interpolate the wind at the camera's heights.

    Args:
        project: its sections
        path: the camera's
        crs: of the landmarks

    Returns:
        The path with it, sentences about the sounding, and what is doubtful of it.
    """
    if not project.has("wind"):
        return path, [], []
    rows = read_by_content(WIND_FORMATS, project.open("wind"))
    if path.velocity_m_s is None:
        message = "is of no use: the velocity is not known without a track by time"
        raise project.section("wind").error("file", message)
    sea_m, counted = _sea_level(project, path, crs)
    height, level = geodetic(path.position_m).height_m - sea_m, rows.height_m
    wind = np.stack([np.interp(height, level, w) for w in rows.toward_m_s.T], axis=1)
    said = f"{rows.said}, linear in height, the last level held beyond the ends; levels {counted}"
    doubts = []
    beyond = np.fmax(level[0] - height, height - level[-1])
    if (beyond > WIND_BEYOND_M).any():
        doubts.append(
            f"[wind] file: its levels are {level[0]:.0f} to {level[-1]:.0f} m high, the camera is "
            f"{np.nanmin(height):.0f} to {np.nanmax(height):.0f} m: the nearest level is taken, up "
            f"to {np.nanmax(beyond):.0f} m away"
        )
    fastest = float(np.linalg.norm(rows.toward_m_s, axis=1).max())
    if fastest > FASTEST_WIND_M_S:
        doubts.append(
            f"[wind] file: {fastest:.4g} m/s is no wind: are its speeds in the unit that is named?"
        )
    (sigma_m_s,) = project.section("wind").sigma("sigma_m_s") or (0.0,)
    return replace(path, wind_m_s=wind, wind_sigma_m_s=sigma_m_s), [said], doubts


def _sea_level(project: Project, path: CameraPath, crs: str | None) -> tuple[float, str]:
    """Find the sea's height above the ellipsoid at the camera, and say where levels count from.

    Soundings count from the sea. Its height is 0 where no section of the project has a geoid.
    """
    landmarks, where = project.section("landmarks"), f"{project.name}: [wind]"
    place = path.position_m[np.isfinite(path.position_m[:, 0])][:1]
    for name in ("track", "position", "landmarks"):
        section = project.section(name)
        own = crs if name == "landmarks" else section.values.get("crs")
        datum = height_datum(section, landmarks)
        if datum is not None and datum.name == "same":
            return 0.0, "counted as the camera's heights"
        sea = None if datum is None else replace(datum, ground_m=0.0)
        sea_m = level_of_heights_m(sea, own, place, where)
        if abs(sea_m) > SAME_LEVEL_M or (sea is not None and sea.name != "ellipsoid"):
            return sea_m, f"above the sea, which is {sea_m:.4g} m above the ellipsoid"
    return 0.0, "taken as above the ellipsoid, as no geoid is stated"


def frames_uncovered(
    project: Project, path: CameraPath, times: FrameTimes, label: Callable[[int], str]
) -> list[Finding]:
    """Warn of frames that have no time, or for which the track has no position."""
    by_time, lost = path.row_s is not None, np.isnan(path.position_m[:, 0])
    untimed = lost & by_time & np.isnan(times.time_s)
    messages = []
    for some, what in ((untimed, "there is no time for"), (lost & ~untimed, NO_POSITION)):
        if some.any():
            labels = [label(k) for k in np.flatnonzero(some).tolist()]
            hint = f"; {COMMENTS}" * any(one.startswith("#") for one in labels)
            hint = hint or (twins_text(labels) if times.image else "")
            messages.append(f"{what} {first_of(labels, 3)}{hint}")
    if path.row_s is not None and (lost & ~untimed).any():
        offset_s = project.section("track").number("offset_s")
        messages[-1] += covering_text(path.row_s, times.time_s, offset_s)
    return [Finding(one, project.name, severity="warning") for one in messages]


def mount_of(section: Section) -> Floats:
    """Read the rotation from camera axes to body axes."""
    if isinstance(section.values.get("mount", ""), str):
        return {"forward": FORWARD, "down": DOWN}[section.text("mount")]
    inside = section.section("mount")
    if inside.has("ypr_deg") == inside.has("matrix"):
        raise section.error("mount", "give either ypr_deg or matrix")
    if inside.has("ypr_deg"):
        ypr_deg = inside.numbers("ypr_deg")
        if not (np.abs(ypr_deg) <= 360.0).all():
            raise inside.error("ypr_deg", "yaw, pitch and roll are -360 to 360 degrees")
        return mount_by_angles(ypr_deg)
    rows = inside.values.get("matrix")
    try:
        matrix = np.array(rows, dtype=np.float64)
        numbers = {type(one) for row in rows or [] for one in row} <= {int, float}
        square = numbers and matrix.shape == (3, 3) and bool((np.abs(matrix) < 2.0).all())
        turn = square and np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-6)
    except (TypeError, ValueError, OverflowError):
        turn = False
    if not turn or np.linalg.det(matrix) < 0.0:
        raise inside.error("matrix", "is not a rotation: three rows of three, right-handed")
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray(u @ vt)


def _vehicle(project: Project, offset_s: float, times: FrameTimes) -> VehicleAttitudes | None:
    """Read the vehicle's attitudes, as far as a file of them is named."""
    if not project.section("vehicle").has("attitude"):
        return None
    from vopd.flight.project.vehicle import read_vehicle

    return read_vehicle(project, offset_s, times)


def shutter_of(section: Section) -> Shutter | None:
    """Read the rolling shutter of `[camera]`; None if there is none."""
    if not section.has("readout_ms"):
        for key in ("readout", "frame_time"):
            if section.has(key):
                raise section.error(key, "is of a rolling shutter: give readout_ms too")
        return None
    said: dict[str, str] = {}
    errors: list[VopdError] = []
    for key in ("readout", "frame_time"):
        try:
            said[key] = section.text(key)
        except VopdError as error:
            errors.append(error)
    raise_all(errors)
    readout_s = section.number("readout_ms") * 1e-3
    return Shutter(readout_s, said["readout"], said["frame_time"] == "middle")


def refraction_of(section: Section) -> Refraction:
    """Read the refraction from `[atmosphere]`."""
    if isinstance(section.values.get("refraction"), dict):
        return Refraction(section.section("refraction").number("k"), False)
    standard = section.text("refraction") == "standard"
    return Refraction() if standard else Refraction(0.0, False)
