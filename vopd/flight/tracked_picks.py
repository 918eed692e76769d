"""Picks that `vopd track` has found from a person's clicks, as a flight takes them."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Ints
from vopd.findings import Finding, count_text
from vopd.flight.flight import Clicks, Picks
from vopd.flight.formats.picks import PickRows
from vopd.flight.formats.tracked import (
    AGAIN,
    CLICKED,
    TRACKED,
    TrackedRows,
    read_tracked,
    recognises_tracked,
    refuse_stale,
)
from vopd.flight.project import Project
from vopd.flight.read import by_point, known_landmarks

MOST_SIZES = 10.0  # of the image, from its first pixel to a tracked one
CLICK_ALONE = 0.01  # of a click's standard deviation that no track of it shares
LEAST_MATCH_PX = 0.02  # standard deviation of a match below which it is not believed


def read_tracked_picks(project: Project, size_px: tuple[int, int]) -> PickRows:
    """Read the picks that `vopd track` has found from a person's clicks.

    Args:
        project: whose `[picks] tracked` names the file
        size_px: of the images

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
    doubts = refuse_stale(file, rows, project)
    rows = rows.where(np.isin(rows.status, (CLICKED, TRACKED)))
    if not len(rows.landmark):
        raise file.error(f"no landmark is found in any frame: {AGAIN}")
    far = np.abs(rows.pixel).max(axis=1) > MOST_SIZES * max(size_px)
    if far.any():
        k = int(np.argmax(far))
        message = f"{rows.landmark[k]} in frame {rows.frame[k]} is far outside the image"
        raise file.error(f"{message} of {size_px[0]} x {size_px[1]}: {AGAIN}")
    clicked = int((rows.status == CLICKED).sum())
    said = f"{file.name}: {count_text(clicked, 'click')} and {len(rows.frame) - clicked} tracked "
    said += "places from them"
    return PickRows(
        rows.frame,
        rows.landmark,
        rows.pixel,
        rows.sigma_px,
        "centre",
        None,
        said,
        tracks=rows,
        doubts=() if project.section("uncertainty").has("covariance") else tuple(doubts),
    )


def join_tracks(
    read: PickRows, number: Ints, landmarks: tuple[str, ...], project: str
) -> tuple[Picks, list[Finding]]:
    """Join the places of each landmark in each frame by the clicks that they were tracked from.

    Args:
        read: the picks, `frame` the index of its frame for each
        number: of the frames, (F,)
        landmarks: the names of the landmarks
        project: the project's name, for findings
    """
    tracks, frame = read.tracks, np.asarray(read.frame)
    assert tracks is not None
    own_of, findings = known_landmarks(read.landmark, landmarks, project)
    rows, first = by_point(frame, own_of[read.landmark.which])
    clicked = tracks.status[rows] == CLICKED
    own_px = np.where(clicked, CLICK_ALONE * tracks.sigma_px[rows], tracks.sigma_px[rows])
    pick = np.repeat(np.arange(len(first) - 1), np.diff(first))
    if tracks.shared:  # together they are no better than one
        matches = np.bincount(pick, ~clicked)[pick]
        own_px = np.where(clicked, own_px, own_px * np.sqrt(np.maximum(matches, 1)))
    mark, source = own_of[read.landmark.which[rows]], tracks.from_frame[rows]
    keys, click = np.unique(np.stack([mark, source]), axis=1, return_inverse=True)
    click_px = np.ones(keys.shape[1])
    click_px[click[clicked]] = tracks.sigma_px[rows][clicked]
    weight = own_px**-2.0
    total = np.bincount(pick, weight, len(first) - 1)
    pixel = np.zeros((len(total), 2))
    np.add.at(pixel, pick, tracks.pixel[rows] * weight[:, None])
    pixel /= total[:, None]
    usual = float(np.median(tracks.sigma_px[rows][~clicked] if not clicked.all() else own_px))
    clicks = Clicks(
        np.searchsorted(number, keys[1]), keys[0], click_px, pick, click,
        tracks.pixel[rows] - pixel[pick], tracks.by_click[rows], own_px, tracks.lost,
        tracks.shared,
    )  # fmt: skip
    at = rows[first[:-1]]
    picks = Picks(
        frame[at], own_of[read.landmark.which[at]], pixel, np.asarray(total**-0.5),
        one_sigma_px=usual, least_sigma_px=LEAST_MATCH_PX, clicks=clicks,
    )  # fmt: skip
    return picks, findings
