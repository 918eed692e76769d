"""`vopd track`: from a project with clicks and a video to its tracked file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import islice
from pathlib import Path
from shlex import quote
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.files import whole_file
from vopd.findings import Finding, VopdError, count_text, first_of
from vopd.flight.flight import CameraPath, Flight
from vopd.flight.formats.picks import Names
from vopd.flight.formats.tracked import STATUSES, TrackedRows, tracked_lines
from vopd.flight.misfits.exchanged import exchanged_places
from vopd.flight.misfits.input_errors import SPEAK_FOR, TYPICAL
from vopd.flight.misfits.misfit import MISFITS
from vopd.flight.misfits.mistakes import usual_mistakes
from vopd.flight.misfits.unsolved import require_two_landmarks
from vopd.flight.project.camera import read_camera
from vopd.flight.project.covariance import adjusted_from, with_stated_offset
from vopd.flight.project.keys import Project
from vopd.flight.project.picks import NO_LANDMARK, NONE_USED
from vopd.flight.project.read import flight_or_errors, read_pick_rows, require_clicks
from vopd.flight.project.terrain import read_terrain, relief_text
from vopd.flight.project.times import frames_of
from vopd.flight.project.track import read_path
from vopd.flight.project.tracked_picks import track_digests
from vopd.flight.result import solve_flight_read
from vopd.geometry.lenses import Lens
from vopd.tracking.journal import AT_ONCE, ATTITUDE, ROW, Journal
from vopd.tracking.patches import LEAST_CORRELATION, PATCH_PX
from vopd.tracking.scene import Scene
from vopd.tracking.tracker import (
    AMBIGUOUS,
    CLICKED,
    FOUND,
    LOST,
    OCCLUDED,
    REACH,
    RESIDUAL_PX,
    ClickedPixels,
    Tracker,
)
from vopd.version import __version__
from vopd.video import (
    VideoFrames,
    grey_frames,
    grey_frames_backward,
    image_numbers,
    images_without_number,
    open_frames,
)

LEAST_FREEDOM = 30  # of residuals from which the sigma of a match is scaled
SCALES = (0.4, 5.0)  # of it, at least and at most
LEAST_MATCH_PX = 0.03  # standard deviation of a match below which it is not believed
FAR_CLICK, FAR_CLICK_PX = 6.0, 4.0  # standard deviations, and pixels at least
SHOWN = 3  # stretches of lost frames in a summary


OPTION = {
    "from_s": "--from",
    "to_s": "--to",
    "every": "--every",
    "reach": "--reach",
    "patch_px": "--patch",
    "least_correlation": "--least-correlation",
    "residual_px": "--residual",
}
"""Options of `vopd track` by their names here."""


class TrackOptions(NamedTuple):
    """The options of a run.

    Attributes:
        from_s: time of the first frame, seconds on the frames' clock; None: from the first one
        to_s: of the last frame
        every: only each so manieth frame has rows
        reach: frames from a click within which all are matched with it
        patch_px: side of a patch, unless a landmark's row has another
        least_correlation: of a patch that is found
        residual_px: of a patch against the turn of the camera that most agree with, at most
    """

    from_s: float | None = None
    to_s: float | None = None
    every: int = 1
    reach: int = REACH
    patch_px: int = PATCH_PX
    least_correlation: float = LEAST_CORRELATION
    residual_px: float = RESIDUAL_PX

    @property
    def as_text(self) -> str:
        """The options that are not the usual ones, as they are given to `vopd track`."""
        usual = TrackOptions()._asdict()
        return " ".join(
            f"{OPTION[name]} {value:.12g}"
            for name, value in self._asdict().items()
            if value != usual[name]
        )


@dataclass(frozen=True, eq=False)
class Footage:
    """A project's video, and all that is known of its F frames but attitudes."""

    project: Project
    flight: Flight  # of the frames that are clicked
    frames: VideoFrames
    number: Ints  # (F,) of each frame, as it stands in files
    time_s: Floats  # (F,)
    scene: Scene
    clicks: ClickedPixels


class Tracked(NamedTuple):
    """What a run has come to.

    Attributes:
        output: the file that was written
        lines: the summary, a line each
        findings: warnings
    """

    output: str
    lines: tuple[str, ...]
    findings: tuple[Finding, ...]


# Read the project


def read_footage(project: Project) -> Footage:
    """Read a project with clicks and a video, and where the camera was in all frames of it.

    Raises:
        VopdError: where a key is missing, or clicks, images and video do not belong together
    """
    section = project.section("picks")
    for key, example in (("video", "flight.mp4"), ("tracked", "tracked.csv")):
        if not section.has(key):
            told = "the video" if key == "video" else "the file that is to be written"
            raise section.error(key, f'is missing: {told}, as {key} = "{example}"')
    require_clicks(project)
    if (source := adjusted_from(project)) is not None:
        message = (
            "was solved for with the tracks that there were: track the project that was adjusted, "
            f"vopd track {quote(source)}, and adjust it again"
        )
        raise project.section("uncertainty").error("covariance", message)
    clicked = project.without("picks", "tracked", "tracked_from")
    if clicked.section("solve").has("frames"):
        clicked = clicked.changed("solve", "frames", "each")
    flight = flight_or_errors(clicked)
    frames = open_frames([str(project.folder / one) for one in section.files("video")])
    camera = read_camera(clicked)
    if camera.several:
        message = "a video is of one camera: give [camera] lens"
        raise project.section("camera").error("of_images", message)
    rows = read_pick_rows(clicked, camera)
    if flight.image_name and not frames.image_name:
        message = "the clicks name images, and the video is no folder of them"
        raise section.error("video", message)
    every: Any = Names(frames.image_name) if flight.image_name else _numbers(project, frames)
    _, times, index = frames_of(clicked, replace(rows, frame=every))
    if frames.image_name:  # in time: in the order of names 10.png is before 9.png
        order = np.lexsort((_numbers(project, frames), times.time_s[index])).tolist()
        names, images = (tuple(one[k] for k in order) for one in (frames.image_name, frames.images))
        frames, index = replace(frames, image_name=names, images=images), index[order]
    read = read_path(with_stated_offset(clicked), times)
    path = CameraPath(
        read.path.position_m[index],
        velocity_m_s=None if read.path.velocity_m_s is None else read.path.velocity_m_s[index],
        lever_arm_m=read.path.lever_arm_m,
    )
    fixes = read.path.fixes
    own_m = None if fixes is None else np.linalg.norm(fixes.frame_sigma_m[index], axis=1)
    scene = Scene(
        flight.lens, path, flight.landmarks, flight.refraction, flight.mount, flight.shutter, own_m,
        read_terrain(clicked),
    )  # fmt: skip
    own = _numbers(project, frames)
    by_name = list(frames.image_name) if flight.image_name else own.tolist()
    place = {name: k for k, name in enumerate(by_name)}
    label = flight.image_name or flight.frame.tolist()
    missing = [one for one in label if one not in place]
    if missing:
        has = f"{frames.source} has {count_text(len(frames), 'frame')}, {own[0]} to {own[-1]}"
        what = missing[0] if flight.image_name else f"frame {missing[0]}"
        how = ": clicks name an image as its file is named" if flight.image_name else ""
        raise section.error("video", f"{what} is clicked, and {has}{how}")
    at = np.array([place[one] for one in label])
    clicks = ClickedPixels(
        at[flight.picks.frame], flight.picks.landmark, flight.picks.pixel, flight.picks.sigma_px
    )
    return Footage(clicked, flight, frames, own, read.times.time_s[index], scene, clicks)


def _numbers(project: Project, frames: VideoFrames) -> Ints:
    """Number the frames: those of a video from 0, images by the numbers in their names."""
    if not frames.image_name:
        return np.arange(len(frames))
    return np.array(_image_numbers(project, frames))


def _image_numbers(project: Project, frames: VideoFrames) -> list[int]:
    for why in images_without_number(frames.image_name).values():
        raise project.section("picks").error("video", why)
    return image_numbers(frames.image_name)


def _range(footage: Footage, options: TrackOptions) -> tuple[int, int]:
    """Find the first and the last frame of a run."""
    time_s, last = footage.time_s, len(footage.frames) - 1
    if options.from_s is None and options.to_s is None:
        return 0, last
    if not np.isfinite(time_s).any():
        raise VopdError(f"{footage.frames.source}: --from and --to: the frames have no times")
    low = np.nanmin(time_s) if options.from_s is None else options.from_s
    high = np.nanmax(time_s) if options.to_s is None else options.to_s
    inside = np.flatnonzero((time_s >= low) & (time_s <= high))
    if not len(inside):
        raise VopdError(
            f"{footage.frames.source}: no frame is between --from {low:g} and --to {high:g} s; "
            f"they are from {np.nanmin(time_s):.6g} to {np.nanmax(time_s):.6g} s"
        )
    return int(inside[0]), int(inside[-1])


def _in_range(footage: Footage, first: int, last: int) -> ClickedPixels:
    """Take the clicks in a range of frames, two landmarks of one frame at least."""
    own = footage.clicks
    section = footage.project.section("picks")
    inside = (own.frame >= first) & (own.frame <= last)
    name = section.text("file")
    where = f"frames {footage.number[first]} to {footage.number[last]}"
    if not len(inside):
        require_two_landmarks(footage.flight)
    if not inside.any():
        clicked = f"frames {footage.number[own.frame.min()]} to {footage.number[own.frame.max()]}"
        raise section.error("file", f"{name}: no click is in {where}; they are in {clicked}")
    inside &= np.isfinite(footage.scene.path.position_m[own.frame, 0])
    if not inside.any():
        raise section.error("file", f"{name}: the track has no position for any click in {where}")
    clicks = ClickedPixels(
        own.frame[inside], own.landmark[inside], own.pixel[inside], own.sigma_px[inside]
    )
    if np.bincount(clicks.frame).max() < 2:
        only = len(set(clicks.landmark.tolist())) == 1
        what = "only one landmark is clicked" if only else "no frame has clicks of two landmarks"
        raise section.error(
            "file", f"{name}: {what}: two landmarks in one frame are needed to begin, far apart"
        )
    return clicks


def _checked(
    pictures: Iterator[tuple[int, Any]], lens: Lens, footage: Footage,
    tell: Callable[[str], object] = lambda _: None,
) -> Iterator[tuple[int, Any]]:  # fmt: skip
    """Check the size of frames as they come: one of another size is black, and is told.

    Raises:
        VopdError: where it is a frame with clicks
    """
    clicked = {*footage.clicks.frame.tolist()}
    width, height = lens.size_px
    for frame, grey in pictures:
        size = grey.shape[1], grey.shape[0]
        if size == lens.size_px:
            yield frame, grey
            continue
        known = grey.any()  # one that cannot be read is black, and is told already
        if known and frame in clicked:
            name = footage.frames.label(frame)
            what = name if footage.frames.image_name else footage.frames.source
            raise footage.project.section("camera").error(
                "image_size_px",
                f"the lens is for {width} x {height}, and {what} has "
                f"{size[0]} x {size[1]}; a calibration serves the pictures that it was made of",
            )
        if known:
            name = footage.frames.label(frame)
            what = name if footage.frames.image_name else f"{footage.frames.source}: frame {name}"
            tell(f"{what} has {size[0]} x {size[1]}, and the lens is for {width} x {height}")
        yield frame, np.zeros((height, width), np.uint8)


# The run


def follow(
    project: Project, options: TrackOptions, tell: Callable[[], object] = lambda: None,
    count: Callable[[int], object] = lambda _: None,
    warn: Callable[[Finding], object] = lambda _: None,
) -> Tracked:  # fmt: skip
    """Follow the landmarks of a project through its video, and write its tracked file.

    Args:
        project: with `[picks] file`, `video` and `tracked`
        options: of the run
        tell: is called after each frame that is looked at
        count: is given how many there will be
        warn: is given, before the first frame, the warnings of a flight whose clicks misfit, or
            speak for an error of its inputs

    Raises:
        VopdError: where something is missing or wrong
    """
    footage = read_footage(project)
    first, last = _range(footage, options)
    clicks = _in_range(footage, first, last)
    for finding in _misfit_of_clicks(footage):
        warn(finding)
    output = str(project.folder / project.section("picks").text("tracked"))
    digests = track_digests(footage.project)
    if text := options.as_text:
        digests["options"] = text
    terrain = footage.scene.terrain
    marks = np.unique(clicks.landmark)
    lines, findings = (
        (relief_text(footage.scene.landmark_m[marks]), []) if terrain is None
        else terrain.about(footage.flight.landmarks, marks)
    )  # fmt: skip
    about = digests | options._asdict() | {"version": __version__, "frames": len(footage.number)}
    about["keys"] = {name: one.values for name, one in footage.project.sections.items()}
    journal = Journal(Path(f"{output}.part"), about)
    sides = np.full(len(footage.flight.landmarks.name), options.patch_px | 1)
    own_px = footage.flight.landmarks.patch_px
    if own_px is not None:
        sides = np.where(np.isfinite(own_px), np.nan_to_num(own_px).astype(int) | 1, sides)
    run = Tracker(
        footage.scene, clicks, footage.time_s, sides, options.reach, options.least_correlation,
        options.residual_px,
    )  # fmt: skip
    count(2 * (last - first + 1))

    unread: list[str] = []

    def pictures(low: int, high: int) -> Iterator[tuple[int, Any]]:
        read = grey_frames(footage.frames, low, high, unread.append)
        for one in _checked(read, run.scene.lens, footage, unread.append):
            yield one
            tell()

    seen = _forward(run, journal, pictures(first, last))
    _backward(run, journal, footage)
    wanted = np.zeros(len(footage.number), bool)
    wanted[first : last + 1 : options.every] = True
    _second(run, journal, pictures, first, min(seen, last), wanted)
    scale, by = _scale(journal, clicks)
    if footage.scene.place_sigma_m is not None:
        scale, by = 1.0, False  # residuals are of the places, too
    rows = sha256()
    for text in islice(_lines(journal, footage, clicks, scale, digests), 3 + len(digests), None):
        rows.update(text.encode())
    digests["rows"] = rows.hexdigest()
    with whole_file(output) as file:
        for text in _lines(journal, footage, clicks, scale, digests):
            file.write(text.encode())
    summary, elsewhere = _summary(journal, footage, run, scale, by)
    findings += _findings(journal, footage, run, clicks)
    if elsewhere:
        message = (
            f"{', '.join(elsewhere)}: hidden, or not where the others have it, in more frames than "
            "found: "
        )
        few = 2 * len(elsewhere) < len(set(clicks.landmark.tolist()))
        message += (
            "is it water, a shadow, something that moves, or a click on another point? leave its "
            "clicks out if it is" if few
            else "do clicks, lens, track and video belong together? vopd check tells more"
        )  # fmt: skip
        if run.scene.path.stands:
            message += "; a camera that hovers moves: give it [track], a position for each frame"
        findings.append(Finding(message, project.name, severity="warning"))
    beside = (
        (block["status"] == FOUND) & ~np.isin(block["frame"], clicks.frame)
        for block in _frames_whole(journal)
    )
    if not any(one.any() for one in beside):
        less = f" (--every {options.every})" if options.every > 1 else ""
        frames = count_text(int(wanted[: seen + 1].sum()), "frame")
        message = "nothing was followed: outside the clicked frames no landmark is found, in "
        message += f"{frames}{less}"
        findings.append(Finding(message, project.name, severity="warning"))
    if unread:
        kind = "image" if footage.frames.images else "frame"
        text = f"{count_text(len({*unread}), kind)} not tracked: {unread[0]}"
        findings.insert(0, Finding(text, project.name, severity="warning"))
    if seen < last:
        message = (
            f"{footage.frames.source}: decoding ends behind frame {footage.number[seen]}, and "
            "frames after it are not tracked: is the file complete, or a part of it damaged?"
        )
        findings.insert(0, Finding(message, project.name, severity="warning"))
    journal.remove()
    return Tracked(output, (*summary, *lines), tuple(findings))


def _misfit_of_clicks(footage: Footage) -> list[Finding]:
    """List the warnings of clicks that are not used, and of a misfit or error that they show."""
    unused = [
        one for one in footage.flight.findings
        if one.message.startswith(NO_LANDMARK) or one.message.endswith(NONE_USED)
    ]  # fmt: skip
    try:
        solved = solve_flight_read(footage.flight, project=lambda: footage.project)
    except VopdError:  # the clicks that a solve needs may be in other frames than tracking's
        return unused
    words, name = (MISFITS, SPEAK_FOR, TYPICAL), footage.project.name
    found = [one for one in solved.findings if any(some in one.message for some in words)]
    more = [] if solved.misfits or found else usual_mistakes(footage.project, solved.estimates)
    return [*unused, *found, *(Finding(text, name, severity="warning") for text in more)]


def _forward(run: Tracker, journal: Journal, pictures: Iterator[tuple[int, Any]]) -> int:
    """Run forward, from where an earlier run stopped; the last frame that was decoded."""
    blocks = list(journal.blocks("forward"))
    complete = bool(blocks) and not len(blocks[-1])
    done = {int(one["frame"]): one for block in blocks for one in block}
    seen = [-1]

    def noticed() -> Iterator[tuple[int, Any]]:
        for frame, grey in pictures:
            seen[0] = frame
            yield frame, grey

    pending: list[Any] = []
    for record in run.forward(noticed(), done):
        pending.append(record)
        if len(pending) > AT_ONCE + 2:
            # a beginning is corrected by the frame after it, once it is known how fast it turns
            _write_attitudes(run, journal, pending[:-2])
            pending = pending[-2:]
    if not complete:
        _write_attitudes(run, journal, pending)
        journal.add("forward", np.zeros(0, ATTITUDE))
    return seen[0]


def _write_attitudes(run: Tracker, journal: Journal, records: list[Any]) -> None:
    if records:
        block = np.concatenate(records)
        block["rotation"] = run.attitudes.rotation[block["frame"]]
        journal.add("forward", block)


def _backward(run: Tracker, journal: Journal, footage: Footage) -> None:
    """Run backward from each beginning to where the frames are known."""
    blocks = list(journal.blocks("backward"))
    if blocks and not len(blocks[-1]):
        for block in blocks:
            for one in block:
                frame = int(one["frame"])
                run.attitudes.rotation[frame] = one["rotation"]
                run.attitudes.known[frame] = one["known"]
                run.attitudes.segment[frame] = one["segment"]
        return
    found = []
    for start, low in run.gaps():
        read = grey_frames_backward(footage.frames, start, low)
        found += list(run.backward(_checked(read, run.scene.lens, footage)))
    block = np.zeros(len(found), ATTITUDE)
    block["frame"] = found
    for name, values in (
        ("rotation", run.attitudes.rotation), ("known", run.attitudes.known),
        ("segment", run.attitudes.segment),
    ):  # fmt: skip
        block[name] = values[found]
    if len(block):
        journal.add("backward", block)
    journal.add("backward", np.zeros(0, ATTITUDE))


def _second(
    run: Tracker, journal: Journal, pictures: Callable[[int, int], Iterator[tuple[int, Any]]],
    first: int, last: int, wanted: Bools,
) -> None:  # fmt: skip
    """Match all frames with all clicks in reach, from where an earlier run stopped."""
    ended = False
    for block in journal.blocks("row"):
        ended = not len(block)
        first = first if ended else int(block["frame"].max()) + 1
    if ended or first > last:
        return
    pending: list[Any] = []
    for rows in run.second(pictures(first, last), wanted):
        pending.append(rows)
        if len(pending) >= AT_ONCE:
            journal.add("row", np.concatenate(pending))
            pending = []
    if pending:
        journal.add("row", np.concatenate(pending))
    journal.add("row", np.zeros(0, ROW))


# The standard deviation of a match, from the residuals


def _scale(journal: Journal, clicks: ClickedPixels) -> tuple[float, bool]:
    """Estimate by how much matches scatter, in their sigmas; and whether residuals tell it.

    The errors of one landmark in one frame are nearly the same from whichever click it is found:
    they count once.
    """
    squares, freedom = 0.0, -2.0 * len(clicks.frame)
    for block in _frames_whole(journal):
        own = block[block["status"] == FOUND]
        points = np.stack([own["frame"], own["landmark"]])
        pairs, point = np.unique(points, axis=1, return_inverse=True)
        each = (own["residual"].astype(float) ** 2).sum(axis=1) / own["sigma"] ** 2
        squares += float((np.bincount(point, each) / np.bincount(point)).sum())
        _, count = np.unique(pairs[0], return_counts=True)
        freedom += float((2 * count - 3).sum())
    if freedom < LEAST_FREEDOM:
        return 1.0, False
    return float(np.clip(np.sqrt(squares / freedom), *SCALES)), True


def _lines(
    journal: Journal, footage: Footage, clicks: ClickedPixels, scale: float, digests: dict[str, str]
) -> Iterator[str]:
    """Write the lines of the tracked file."""
    head = 3 + len(digests)
    names = footage.flight.landmarks.name
    for index, block in enumerate(_frames_whole(journal)):
        tracked = block["status"] == FOUND
        match = np.maximum(scale * block["sigma"], LEAST_MATCH_PX)
        source = np.where(block["click"] < 0, 0, block["click"])
        rows = TrackedRows(
            footage.number[block["frame"]],
            Names(names[k] for k in block["landmark"].tolist()),
            block["pixel"],
            np.where(tracked, match, block["sigma"]),
            np.where(block["click"] < 0, -1, footage.number[clicks.frame[source]]),
            block["by_click"],
            block["correlation"].astype(float),
            block["status"].astype(np.int64),
            digests,
        )
        yield from islice(tracked_lines(rows), head if index else 0, None)


def _frames_whole(journal: Journal) -> Iterator[Any]:
    return (block for block in journal.blocks("row") if len(block))


# The summary


def _summary(
    journal: Journal, footage: Footage, run: Tracker, scale: float, by: bool
) -> tuple[list[str], list[str]]:
    """Sum up which landmarks were found in how many frames, where not, and why.

    Returns:
        The lines, and the names of landmarks that are elsewhere, or hidden, in more frames than
        they are found in.
    """
    names = footage.flight.landmarks.name
    found: Counter[tuple[int, int]] = Counter()
    frames: set[int] = set()
    lost: list[int] = []
    sigma: list[Floats] = []
    for block in _frames_whole(journal):
        status, mark = block["status"], block["landmark"]
        taken = np.isin(status, (CLICKED, FOUND))
        sigma.append(block["sigma"][status == FOUND])
        for frame in np.unique(block["frame"]).tolist():
            own = block["frame"] == frame
            seen = set(mark[own & taken].tolist())
            frames.add(frame)
            if len(seen) < 2:
                lost.append(frame)
            for k in range(len(names)):
                if k in seen:
                    found[k, FOUND] += 1
                else:
                    others = status[own & (mark == k)]
                    found[k, int(others[0]) if len(others) else LOST] += 1
    lines = [
        f"{footage.frames.source}: {count_text(len(frames), 'frame')}, "
        f"{count_text(len(footage.clicks.frame), 'click')} of "
        f"{count_text(len(set(footage.clicks.landmark.tolist())), 'landmark')}"
    ]
    if footage.frames.missing:
        lines.append(footage.frames.about)
    clicked = set(footage.clicks.landmark.tolist())
    width = max(len(name) for name in names)
    elsewhere = [
        names[k] for k in sorted(clicked)
        if found[k, AMBIGUOUS] + found[k, OCCLUDED] > found[k, FOUND]
    ]  # fmt: skip
    for k in sorted(clicked):
        others = [f"{STATUSES[s]} in {found[k, s]}" for s in range(2, len(STATUSES)) if found[k, s]]
        told = f"  {names[k]:{width}}  in {count_text(found[k, FOUND], 'frame')}"
        lines.append(told + (f"; {', '.join(others)}" if others else ""))
    every = np.concatenate(sigma) if sigma else np.zeros(0)
    if len(every):
        usual = float(np.median(np.maximum(scale * every, LEAST_MATCH_PX)))
        source = (
            "from the residuals" if by
            else "from the images alone: the residuals "
            + ("hold errors of the positions, too" if footage.scene.place_sigma_m is not None
               else "are too few to tell")
        )  # fmt: skip
        lines.append(f"standard deviation of a match: {usual:.3f} px, {source}")
    for one in run.beginnings[1:]:
        at = footage.number[one.frame]
        where = f"from frame {footage.number[one.cut]}" if one.cut >= 0 else "before it"
        lines.append(f"lost {where}: tracking begins anew with the clicks of frame {at}")
    for k in range(len(run.clicks.frame)):
        if k not in run.patches:
            frame = footage.number[run.clicks.frame[k]]
            mark = names[run.clicks.landmark[k]]
            lines.append(
                f"frame {frame}: {mark} is too near to the edge: nothing is tracked from it"
            )
    stretches = _stretches(sorted(lost))
    if stretches:
        ends = [(footage.number[first], footage.number[last]) for first, last in stretches]
        told = first_of([f"{a} to {b}" if a != b else str(a) for a, b in ends], SHOWN)
        first, last = max(stretches, key=lambda one: one[1] - one[0])
        lines.append(
            f"fewer than two landmarks in {count_text(len(lost), 'frame')}: {told}; "
            f"click two in frame {footage.number[(first + last) // 2]}"
        )
    return lines, elsewhere


def _stretches(frames: list[int]) -> list[tuple[int, int]]:
    """Join frames that follow one another, by their indices: first and last of each stretch."""
    found: list[tuple[int, int]] = []
    for one in frames:
        if found and one == found[-1][1] + 1:
            found[-1] = found[-1][0], one
        else:
            found.append((one, one))
    return found


def _findings(
    journal: Journal, footage: Footage, run: Tracker, clicks: ClickedPixels
) -> list[Finding]:
    """Name clicks that are far from where the other clicks of their landmark have it.

    Of clicks that contradict each other the one that contradicts the most is named, then those
    that are left. Two of one frame that lie where the other should be are exchanged.
    """
    against: dict[int, dict[int, float]] = {}  # clicks that contradict, and by how many pixels
    place: dict[int, Floats] = {}  # where such a click should be
    at = {(f, m): k for k, (f, m) in enumerate(zip(clicks.frame, clicks.landmark, strict=True))}
    for block in _frames_whole(journal):
        for one in block[block["status"] == FOUND]:
            own = at.get((int(one["frame"]), int(one["landmark"])))
            if own is None:
                continue
            other = int(one["click"])
            away = float(np.hypot(*(clicks.pixel[own] - one["pixel"])))
            grown = np.linalg.norm(one["by_click"], 2)
            sigma = float(np.hypot(clicks.sigma_px[own], grown * clicks.sigma_px[other]))
            if away > max(FAR_CLICK * sigma, FAR_CLICK_PX):
                place[own] = one["pixel"]
                for k, o in ((own, other), (other, own)):
                    against.setdefault(k, {})[o] = max(away, against.get(k, {}).get(o, 0.0))
    name, number = footage.flight.landmarks.name, footage.number
    found: list[Finding] = []

    def tell(message: str, of: list[int]) -> None:
        found.append(Finding(message, footage.project.name, severity="warning"))
        for k in of:
            for o in against.pop(k):
                against.get(o, {}).pop(k, None)

    odd = np.array(sorted(place), int)
    crossed = exchanged_places(
        clicks.frame[odd], clicks.pixel[odd], np.array([place[k] for k in odd]),
        np.maximum(FAR_CLICK * clicks.sigma_px[odd], FAR_CLICK_PX),
    )  # fmt: skip
    for one, other in sorted(
        odd[crossed].tolist() if crossed else [],
        key=lambda pair: -sum(len(against[k]) for k in pair),
    ):
        if not (against.get(one) and against.get(other)):
            continue
        tell(
            f"frame {number[clicks.frame[one]]}: the clicks of {name[clicks.landmark[one]]} and "
            f"{name[clicks.landmark[other]]} are exchanged: each lies where the other should be; "
            f"exchange their names in {footage.project.section('picks').text('file')}",
            [one, other],
        )
    while any(against.values()):
        k = min(against, key=lambda k: (-len(against[k]), k))
        alike = [k, *(o for o in against[k] if len(against[k]) == len(against[o]) == 1)]
        told = [(k, sorted(against[k]), max(against[k].values())) for k in alike]
        for k, others, away in told:
            frames = ", ".join(str(number[clicks.frame[o]]) for o in others[:SHOWN])
            tell(
                f"frame {number[clicks.frame[k]]}: {name[clicks.landmark[k]]} is clicked "
                f"{away:.0f} px from where the clicks of frame {frames} have it: is it another "
                "point?",
                [k],
            )
    return found
