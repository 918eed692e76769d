"""Picks of a project: on one grid, with their standard deviations, each landmark once a frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints, in_four_bytes
from vopd.findings import Finding, count_text, did_you_mean
from vopd.flight.flight import Picks
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.tables import COMMENTS
from vopd.flight.project.camera import CameraLens, check_size
from vopd.flight.project.keys import Section

COPIED_PX = 1e-9  # between picks of one landmark in one frame
APART = 20.0  # standard deviations between picks of one point that cannot both be right
POINTS_AT_ONCE = 100_000


def sizes_px(section: Section, file: InputFile, rows: PickRows, camera: CameraLens) -> Floats:
    """Look up the size of the picks' image by its lens, (2,), or of each pick's (P, 2).

    Raises:
        VopdError: where an image has another size than its lens
    """
    if not camera.several:
        if isinstance(rows.size_px, dict):
            message = "the images are not all of one size: name the lens of each image in "
            raise file.error(f"{message}[camera] of_images")
        own, size = rows.size_px, camera.read.lens.size_px
        check_size(section, own or size, size, f"{file.name} has images of")
        return camera.read.lens.by_rows("size_px")
    names = rows.frame if isinstance(rows.frame, Names) else Names(map(str, rows.frame.tolist()))
    every = camera.of_names(names.known).by_rows("size_px")
    for name, (width, height) in zip(names.known, every.astype(int).tolist(), strict=True):
        own = rows.size_px.get(name) if isinstance(rows.size_px, dict) else rows.size_px
        check_size(section, own or (width, height), (width, height), f"{file.name}: {name} has")
    return np.asarray(every[names.which])


def join_picks(
    read: PickRows,
    frame_label: Callable[[int], str],
    landmarks: tuple[str, ...],
    project: str,
) -> tuple[Picks, list[Finding]]:
    """Join the picks by landmark, several of one point in one frame averaged.

    Picks of a landmark that the project does not have, and picks of one point that
    contradict each other, take no part and are told.

    Args:
        read: the picks, `frame` the index of its frame for each
        frame_label: what to call a frame, by its index
        landmarks: the names of the landmarks
        project: the project's name, for findings
    """
    frame, names = np.asarray(read.frame), read.landmark
    own_of, findings = known_landmarks(names, landmarks, project)
    rows, first = by_point(frame, own_of[names.which])
    count = np.diff(first)
    mean, sigma = _means(read, rows, first)
    own, frame = own_of[names.which[rows[first[:-1]]]], frame[rows[first[:-1]]]
    several = np.flatnonzero(count > 1)  # points picked several times
    again = rows[np.repeat(count > 1, count)]
    inverse = np.repeat(np.arange(len(several)), count[several])
    away = read.centred_px(again) - mean[several][inverse]
    expected = read.sigma_px[again]
    by_spread = not read.stated and 2 * len(several) > len(count)  # most points tell it
    if by_spread:
        variance = np.bincount(inverse, (away**2).sum(axis=1)) / (2.0 * (count[several] - 1))
        expected = np.maximum(expected, np.sqrt(np.median(variance)))
    contrary = _contrary(away, expected, inverse, len(several))
    for k in np.flatnonzero(contrary):
        point = several[k]
        label, name = frame_label(int(frame[point])), landmarks[own[point]]
        apart = 2.0 * np.hypot(*away[inverse == k].T).max()
        message = (
            f"{label}: {name} is picked {count[point]} times, up to {apart:.0f} px apart; "
            f"{NONE_USED}"
        )
        findings.append(Finding(message, project, severity="warning"))
    freedom = 2.0 * (count[several[~contrary]] - 1).sum()
    squares = (away[~contrary[inverse]] ** 2).sum()
    repeatability = float(np.sqrt(squares / freedom)) if freedom else float("nan")
    usual = _usual(read)
    if by_spread and repeatability > LARGE_SPREAD_PX:
        message = (
            f"picks of one landmark in one frame differ by {repeatability:.0f} px, root mean "
            "square: are several frames under one name, or has the camera turned between them?"
        )
        findings.append(Finding(message, project, severity="warning"))
    if by_spread and repeatability > 0.0:
        sigma *= repeatability / usual["one_sigma_px"]
        usual["one_sigma_px"] = repeatability
    followed = None
    if read.interpolated is not None:
        followed = np.logical_or.reduceat(read.interpolated[rows], first[:-1])
    absurd = np.flatnonzero((np.abs(mean) > MOST_PX).any(axis=1))
    for point in absurd:
        label, (u, v) = frame_label(int(frame[point])), mean[point]
        message = f"{label}: {landmarks[own[point]]} at {u:g}, {v:g} is in no image; not used"
        findings.append(Finding(message, project, severity="warning"))
    kept = np.ones(len(count), bool)
    kept[several[contrary]] = kept[absurd] = False
    picks = Picks(
        frame=frame[kept],
        landmark=own[kept],
        pixel=mean[kept],
        sigma_px=sigma[kept],
        repeatability_px=repeatability,
        v_up=read.up_from is not None,
        v_said=read.v_said,
        followed=None if followed is None else followed[kept],
        unused=frozenset({*own.tolist()} - {*own[kept].tolist()}),
        **usual,
    )
    return picks, findings


def known_landmarks(
    names: Names, landmarks: tuple[str, ...], project: str
) -> tuple[Ints, list[Finding]]:
    """Look up the landmarks that are picked, and warn of those that the project does not have.

    Args:
        names: of the picks
        landmarks: the names of the project's
        project: the project's name, for findings

    Returns:
        The index of each of `names.known`, -1 for one that is not known, and the warnings.
    """
    index = {name: k for k, name in enumerate(landmarks)}
    picked_of, findings = np.bincount(names.which).tolist(), []
    for name, picked in sorted(zip(names.known, picked_of, strict=True)):
        if name not in index:
            many = count_text(picked, "pick")
            message = f"{NO_LANDMARK} {name} ({many}){did_you_mean(name, landmarks[:20])}"
            message += f"; {COMMENTS}" * name.startswith("#")
            findings.append(Finding(message, project, severity="warning"))
    return in_four_bytes(np.array([index.get(name, -1) for name in names.known])), findings


LARGE_SPREAD_PX = 10.0  # of picks of one landmark in one frame: no hand is so unsure
NONE_USED = "none of these picks is used"
MOST_PX = 1e6  # from the image's middle: squares of such a pick would hide all others

NO_LANDMARK = "no landmark"
"""How a warning about picks of an unknown landmark begins."""


def by_point(frame: Ints, own: Ints) -> tuple[Ints, Ints]:
    """Sort the picks of known landmarks by frame and landmark, those of one point together.

    Args:
        frame: index of each pick's frame, (P,)
        own: index of each pick's landmark, -1 where it is not known, (P,)

    Returns:
        The indices of the picks, and where in them each point begins, and the last one ends.
    """
    rows = np.lexsort((own, frame))
    rows = in_four_bytes(rows)
    if own.min(initial=0) < 0:
        rows = rows[own[rows] >= 0]
    new = np.ones(len(rows) + 1, bool)
    new[1:-1] = (np.diff(frame[rows]) != 0) | (np.diff(own[rows]) != 0)
    return rows, in_four_bytes(np.flatnonzero(new))


def _means(read: PickRows, rows: Ints, first: Ints) -> tuple[Floats, Floats]:
    """Average the picks of each point by weight, (points, 2), with their sigmas (points,)."""
    points = len(first) - 1
    mean, sigma = np.empty((points, 2)), np.empty(points)
    for k in range(0, points, POINTS_AT_ONCE):
        end = min(k + POINTS_AT_ONCE, points)
        some, start = rows[first[k] : first[end]], first[k:end] - first[k]
        weight = read.sigma_px[some] ** -2.0
        total = np.add.reduceat(weight, start)
        weighted = np.add.reduceat(weight[:, None] * read.centred_px(some), start)
        mean[k:end] = weighted / total[:, None]
        sigma[k:end] = total**-0.5
    return mean, sigma


def _usual(read: PickRows) -> dict[str, Any]:
    """Estimate the usual sigma of one pick; a smaller one than stated is not believed."""
    usual = float(np.median(read.sigma_px)) if len(read.sigma_px) else 1.0
    return {"one_sigma_px": usual} | (
        {"least_sigma_px": usual, "stated": True} if read.stated else {}
    )


def _contrary(away: Floats, sigma: Floats, inverse: Ints, points: int) -> Bools:
    """Find points with a pick that is too far from the mean of its picks, (points,)."""
    far = np.hypot(*away.T) > APART / 2.0 * sigma
    return np.asarray(np.bincount(inverse[far], minlength=points) > 0)
