"""Picks that a program has followed from frame to frame: those of `vopd track`, and others' tracks.

`vopd track` says which click each of its picks is from, and their errors are solved for. The errors
of other tracks are those of clicks that nobody knows, nearly the same from one frame to the next:
many frames are not as many picks.
"""

from __future__ import annotations

import json
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.files import readable, size_and_ends
from vopd.findings import Finding, count_text, shown
from vopd.flight.flight import Clicks, Flight, Picks
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.picks import PICK_FORMATS, Names, PickRows, read_hidden
from vopd.flight.formats.tracked import (
    AGAIN,
    CLICKED,
    TRACKED,
    TrackedRows,
    digest_of_rows,
    read_tracked,
    recognises_tracked,
)
from vopd.flight.project.keys import ROWS, Project, mount_moves
from vopd.flight.project.picks import by_point, known_landmarks
from vopd.flight.solve.joint import JointSolution

MOST_SIZES = 10.0  # of the image, from its first pixel to a tracked one
LEAST_MATCH_PX = 0.02  # standard deviation of a match below which it is not believed
ALIKE = 0.5  # correlation from one frame to the next that is told
FEWEST = 30  # pairs of following frames: fewer tell nothing of it


def read_tracked_picks(project: Project, size_px: tuple[int, int]) -> PickRows:
    """Read the picks that `vopd track` has found from a person's clicks.

    Raises:
        VopdError: where the file is not as `vopd track` writes it, or is of other clicks
    """
    section = project.section("picks")
    if not (project.folder / section.text("tracked")).exists():
        raise section.error("tracked", f"{section.text('tracked')} is not there: run vopd track")
    file = project.open("picks", "tracked")
    if not recognises_tracked(file):
        raise section.error(
            "tracked",
            f"{file.name} is not what vopd track writes; for picks by another program write "
            'tracked_from = "unknown"',
        )
    key = "tracked", file.name
    if key not in project.held:
        project.held[key] = read_tracked(file)
    rows: TrackedRows = project.held[key]
    changed = refuse_stale(file, rows, project)
    adjusted = project.section("uncertainty").has("covariance")
    rows = _with_stated_sigma(rows.where(np.isin(rows.status, (CLICKED, TRACKED))), project)
    if not len(rows.landmark):
        raise file.error(f"no landmark is found in any frame: {AGAIN}")
    far = np.abs(rows.pixel).max(axis=1) > MOST_SIZES * max(size_px)
    if far.any():
        k = int(np.argmax(far))
        message = f"{rows.landmark[k]} in frame {rows.frame[k]} is far outside the image"
        click = "click it again, and " * bool(rows.status[k] == CLICKED)
        raise file.error(f"{message} of {size_px[0]} x {size_px[1]}: {click}{AGAIN}")
    clicked = int((rows.status == CLICKED).sum())
    said = f"{file.name}: {count_text(clicked, 'click')} and {len(rows.frame) - clicked} tracked "
    said += "places from them"
    if options := rows.digest.get("options"):
        said += f", by vopd track {readable(options)}"
    return PickRows(
        rows.frame,
        rows.landmark,
        rows.pixel,
        rows.sigma_px,
        "centre",
        None,
        said,
        tracks=rows,
        doubts=rows.doubts if adjusted else (*rows.doubts, *changed),
    )


def _with_stated_sigma(rows: TrackedRows, project: Project) -> TrackedRows:
    """Take the clicks' `[picks] sigma_px` as it is stated now; it may have changed since the run.

    Sigmas of the clicks' own rows, and those of points that are clicked several times, stay.
    """
    section = project.section("picks")
    if not (section.has("file") and section.has("sigma_px")):
        return rows
    read = project.read("picks", project.open("picks", "file"), PICK_FORMATS)
    frame = list(read.frame) if isinstance(read.frame, Names) else read.frame.tolist()
    own = dict(zip(zip(frame, read.landmark, strict=True), read.sigma_px.tolist(), strict=True))
    if len(own) < len(frame) or (isinstance(frame[0], str) and np.isfinite(read.sigma_px).any()):
        return rows
    sigma_px, stated_px = rows.sigma_px.copy(), section.number("sigma_px")
    names = list(rows.landmark)
    for row in np.flatnonzero(rows.status == CLICKED).tolist():
        of_row = own.get((int(rows.frame[row]), names[row]), np.nan)
        sigma_px[row] = stated_px if np.isnan(of_row) else sigma_px[row]
    return replace(rows, sigma_px=sigma_px)


def hidden_marks(project: Project, landmarks: tuple[str, ...]) -> frozenset[tuple[str, int]]:
    """Read which landmarks a person has marked as hidden, by frame and index of the landmark."""
    section = project.section("picks")
    if not section.has("file") or not (project.folder / section.text("file")).is_file():
        return frozenset()
    place = {name: k for k, name in enumerate(landmarks)}
    marked = read_hidden(project.open("picks", "file"))
    return frozenset((frame, place[name]) for frame, name in marked if name in place)


def join_tracks(
    read: PickRows,
    number: Ints,
    landmarks: tuple[str, ...],
    project: str,
    hidden: frozenset[tuple[str, int]] = frozenset(),
) -> tuple[Picks, list[Finding]]:
    """Join the places of each landmark in each frame by the clicks that they were tracked from.

    Args:
        read: the picks, `frame` the index of its frame for each
        number: of the frames, (F,)
        landmarks: the names of the landmarks
        project: the project's name, for findings
        hidden: frames and landmarks that a person has marked as hidden
    """
    tracks, frame = read.tracks, np.asarray(read.frame)
    assert tracks is not None
    own_of, findings = known_landmarks(read.landmark, landmarks, project)
    rows, first = by_point(frame, own_of[read.landmark.which])
    clicked = tracks.status[rows] == CLICKED
    pick = np.repeat(np.arange(len(first) - 1), np.diff(first))
    matched_px = tracks.sigma_px[rows][~clicked]
    usual = float(np.median(matched_px)) if len(matched_px) else LEAST_MATCH_PX
    # the patch of a click is off as a match in its frame is, and takes that to all its matches
    own_px = np.where(clicked, usual, tracks.sigma_px[rows])
    own_px *= np.sqrt(np.bincount(pick)[pick])  # one error, the frame's: no better than one
    mark, source = own_of[read.landmark.which[rows]], tracks.from_frame[rows]
    keys, click = np.unique(np.stack([mark, source]), axis=1, return_inverse=True)
    click_px = np.ones(keys.shape[1])
    click_px[click[clicked]] = tracks.sigma_px[rows][clicked]
    weight = own_px**-2.0
    total = np.bincount(pick, weight, len(first) - 1)
    pixel = np.zeros((len(total), 2))
    np.add.at(pixel, pick, tracks.pixel[rows] * weight[:, None])
    pixel /= total[:, None]
    clicks = Clicks(
        np.searchsorted(number, keys[1]), keys[0], click_px, pick, click,
        tracks.pixel[rows] - pixel[pick], tracks.by_click[rows], own_px, tracks.lost, hidden=hidden,
    )  # fmt: skip
    at = rows[first[:-1]]
    picks = Picks(
        frame[at], own_of[read.landmark.which[at]], pixel, np.asarray(total**-0.5),
        one_sigma_px=usual, least_sigma_px=LEAST_MATCH_PX, v_said=True, clicks=clicks,
    )  # fmt: skip
    return picks, findings


# Tracks of other programs


def followed_findings(flight: Flight, joint: JointSolution) -> list[Finding]:
    """Warn of tracks of other programs whose residuals agree from frame to frame."""
    alike = correlation_of_neighbours(joint)
    if not alike > ALIKE:
        return []
    frames = joint.model.solved
    worth = max(frames * (1.0 - alike) / (1.0 + alike), 1.0)
    return [
        Finding(
            f"tracked picks: their residuals agree from one frame to the next (correlation "
            f"{alike:.2f}), as those of one click do that is carried on: in a mean over frames, or "
            f"a curve through them, {frames} frames tell no more than {worth:.0f}, and it is "
            f"{np.sqrt(frames / worth):.1f} times less certain than is stated. vopd track says "
            "which click each pick is from, and their errors are solved for",
            flight.source,
            severity="warning",
        )
    ]


def correlation_of_neighbours(joint: JointSolution) -> float:
    """Correlate residuals of followed picks with those of the same landmark in the next frame.

    Returns:
        The correlation of u and v together; NaN where there are few such picks.
    """
    model, picks = joint.model, joint.model.flight.picks
    if picks.followed is None:
        return float("nan")
    own = np.flatnonzero(picks.followed[model.pick])
    frame, landmark = picks.frame[model.pick[own]], model.landmark[own]
    order = np.lexsort((frame, landmark))
    residual: Floats = joint.normal.residual[own[order]]
    frame, landmark = frame[order], landmark[order]
    near = (np.diff(frame) == 1) & (np.diff(landmark) == 0)
    if near.sum() < FEWEST:
        return float("nan")
    before, after = residual[:-1][near], residual[1:][near]
    square = float((before**2).sum() * (after**2).sum())
    return float((before * after).sum() / np.sqrt(square)) if square > 0.0 else float("nan")


# Digests of what was tracked

SEEN_BY = {
    "flight": ("epoch",),
    "camera": (),
    "landmarks": (),
    "track": (),
    "position": (),
    "atmosphere": (),
    "picks": ("times", "frame_rate_hz", "first_frame_t_s", "utc_offset_h"),
}
"""Sections, and keys of them if not all count, on which the prediction of landmarks depends."""
WITH_LEVER_ARM = {"vehicle": ("mount",)}
"""The same, where there is a lever arm."""
READ_BY = ("columns", "pixel_grid", "v", "interpolated")
"""Keys of `[picks]` that say how the file of clicks is read."""


def track_digests(project: Project) -> dict[str, str]:
    """Digest what `vopd track` follows: `clicks`, `video` and `project`.

    Of the clicks their file counts, and how it is read; of a video its size and both ends; of the
    project what predicts where landmarks are, with the files that it names. Standard deviations do
    not count.

    Args:
        project: the project; what it does not name, or is not there, has no digest
    """
    section = project.section("picks")
    found = {}
    if section.has("file"):
        found["clicks"] = _of_files([project.folder / section.text("file")])
        read_by = {
            key: section.values[key] for key in READ_BY
            if section.values.get(key, default := ROWS["picks", key].default) != default
        }  # fmt: skip
        if found["clicks"] and read_by:
            text = found["clicks"] + json.dumps(read_by, sort_keys=True)
            found["clicks"] = sha256(text.encode()).hexdigest()
    video = section.values.get("video")
    names = video if isinstance(video, list) else [video] if video else []
    found["video"] = _of_files([project.folder / str(name) for name in names])
    found["project"] = _of_project(project)
    return {name: one for name, one in found.items() if one}


def _of_files(paths: list[Path]) -> str:
    """Digest files by their sizes and ends, a folder by its files; empty if one is not there."""
    digest = sha256()
    for path in paths:
        inside = sorted(path.iterdir()) if path.is_dir() else [path]
        for one in inside:
            if not one.is_file():
                if one == path:
                    return ""
                continue
            digest.update(f"{one.name if path.is_dir() else ''}\0".encode())
            for part in size_and_ends(one):
                digest.update(part)
    return digest.hexdigest() if paths else ""


def _of_project(project: Project) -> str:
    """Digest the keys of a project that predict where landmarks are, and their files."""
    digest = sha256()
    sections = {name: one.values for name, one in project.sections.items()}
    seen_by = SEEN_BY | (WITH_LEVER_ARM if mount_moves(sections) else {})
    for name, only in seen_by.items():
        values = sections.get(name, {})
        for key in sorted(only or values):
            if key in values and ROWS[name, key].kind != "sigma":
                value: Any = values[key]
                if project.names_file(name, key):
                    value = _of_files([project.folder / value])
                digest.update(json.dumps([name, key, value], default=str).encode())
    return digest.hexdigest()


def refuse_stale(file: InputFile, rows: TrackedRows, project: Project) -> list[str]:
    """Compare the digests of a tracked file with what its project names now.

    Returns:
        Sentences on what has changed without harm to the picks.

    Raises:
        VopdError: where the clicks or the video are others
    """
    now = track_digests(project)
    section = project.section("picks")
    for name, key in (("clicks", "file"), ("video", "video")):
        if name in now and name not in rows.digest:
            raise section.error(
                "tracked", f"{file.name} does not say which {name} it was made of, in a line "
                f"# {name}: ... above its header: {AGAIN}"
            )  # fmt: skip
        if name in now and rows.digest.get(name) != now[name]:
            raise section.error(
                "tracked", f"{file.name} was made of {key} = {shown(section.values[key])} as it "
                f"was{', or was read,' * (name == 'clicks')} before: {AGAIN}"
            )  # fmt: skip
    told = []
    if rows.digest.get("rows") != digest_of_rows(file.path):
        edited = "edited since vopd track wrote it"
        if "rows" not in rows.digest:
            edited = f"whether it was {edited} is not known, as its line # rows: ... is missing"
        told.append(f"{file.name}: {edited}: what is said of clicks may come from that; {AGAIN}")
    if rows.digest.get("project") != now["project"]:
        told.append(
            f"{file.name}: lens, landmarks or positions have changed since: the picks serve, and "
            f"their patches were predicted by others; {AGAIN}"
        )
    return told
