"""The picks of a project: on one grid, and each landmark once a frame."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints, in_four_bytes
from vopd.findings import Finding
from vopd.flight.files import InputFile, did_you_mean
from vopd.flight.flight import Picks
from vopd.flight.lens_formats.lens_parameters import GRID_TO_CENTRE
from vopd.flight.pick_formats import PICK_FORMATS
from vopd.flight.pick_formats.pick_rows import PickRows
from vopd.flight.project import Project

APART = 20.0  # standard deviations between picks of one point that cannot both be right


POINTS_AT_ONCE = 100_000


class PicksRead(NamedTuple):
    """The picks of a project before their landmarks are looked up."""

    rows: PickRows
    grid: str  # where the file counts pixels from
    up_from: float | None  # the v of the last row, where v counts upward
    sigma_px: Floats  # (P,)
    stated: bool  # whether the project or the file states it
    file: InputFile
    said: str

    def pixel(self, picks: Ints) -> Floats:
        """The u and v of some picks, from the first pixel's centre, (n, 2)."""
        found = self.rows.pixel[picks] + GRID_TO_CENTRE[self.grid]
        if self.up_from is not None:
            found[:, 1] = self.up_from - found[:, 1]
        return np.asarray(found)


def read_pick_rows(project: Project, size_px: tuple[int, int]) -> PicksRead:
    """All picks of a project as they stand in its file, and how the file counts pixels.

    Raises:
        VopdError: where the grid is not known, a pick is not finite, or the images are not those
            of the lens
    """
    section = project.section("picks")
    file = project.open("picks")
    rows = project.read("picks", file, PICK_FORMATS)
    finite = np.isfinite(rows.pixel).all(axis=1)
    if not finite.all():
        k = int(np.argmin(finite))
        raise file.error(f"{rows.landmark[k]} in {rows.frame[k]}: u or v is not finite")
    if rows.size_px is not None and rows.size_px != size_px:
        (w, h), (width, height) = rows.size_px, size_px
        turned = ": they were turned when they were picked" if (w, h) == (height, width) else ""
        message = f"{file.name} has images of {w} x {h}, the lens is for {width} x {height}{turned}"
        raise section.error("file", message)
    grid = rows.grid or section.text("pixel_grid", list(GRID_TO_CENTRE))
    if section.has("pixel_grid") and section.text("pixel_grid") != grid:
        raise section.error("pixel_grid", f"{rows.said} has the {grid} grid: leave the key out")
    way = section.text("v", ("down", "up"), "down")
    up_from = size_px[1] - 1.0 if way == "up" else None
    stated = section.number("sigma_px", 1.0, above=0.0)
    own = np.isfinite(rows.sigma_px)
    sigma = np.where(own, rows.sigma_px, stated) if own.any() else np.broadcast_to(stated, own.size)
    said = f"{file.name}: {rows.said}, {len(sigma)} picks, {grid} grid, v {way}"
    known = section.has("sigma_px") or bool(own.any())
    return PicksRead(rows, grid, up_from, sigma, known, file, said)


def join_picks(
    read: PicksRead,
    frame_label: Callable[[int], str],
    landmarks: tuple[str, ...],
    project: str,
) -> tuple[Picks, list[Finding]]:
    """The picks by landmark, several of one point in one frame averaged.

    Picks of a landmark that the project does not have, and picks of one point that
    contradict each other, take no part and are told.

    Args:
        read: the picks, the index of its frame for each
        frame_label: what to call a frame, by its index
        landmarks: the names of the landmarks
        project: the project's name, for findings
    """
    findings = []
    frame = np.asarray(read.rows.frame)
    index = {name: k for k, name in enumerate(landmarks)}
    names = read.rows.landmark
    own_of = in_four_bytes(np.array([index.get(name, -1) for name in names.known]))
    picked_of = dict(zip(names.known, np.bincount(names.which).tolist(), strict=True))
    for name in sorted(name for name in names.known if name not in index):
        picked = picked_of[name]
        many = f"{picked} pick{'s'[: picked != 1]}"
        message = f"no landmark {name} ({many}){did_you_mean(name, landmarks[:20])}"
        findings.append(Finding(message, project, severity="warning"))
    rows, first = _by_point(frame, own_of[names.which])
    count = np.diff(first)
    mean, sigma = _means(read, rows, first)
    own, frame = own_of[names.which[rows[first[:-1]]]], frame[rows[first[:-1]]]
    several = np.flatnonzero(count > 1)  # points picked several times
    again = rows[np.repeat(count > 1, count)]
    inverse = np.repeat(np.arange(len(several)), count[several])
    away = read.pixel(again) - mean[several][inverse]
    contrary = _contrary(away, read.sigma_px[again], inverse, len(several))
    for k in np.flatnonzero(contrary):
        point = several[k]
        label, name = frame_label(int(frame[point])), landmarks[own[point]]
        apart = 2.0 * np.hypot(*away[inverse == k].T).max()
        message = (
            f"{label}: {name} is picked {count[point]} times, up to {apart:.0f} px apart; "
            "none of these picks is used"
        )
        findings.append(Finding(message, project, severity="warning"))
    freedom = 2.0 * (count[several[~contrary]] - 1).sum()
    squares = (away[~contrary[inverse]] ** 2).sum()
    kept: Bools | slice = slice(None)
    if contrary.any():
        kept = np.ones(len(count), bool)
        kept[several[contrary]] = False
    picks = Picks(
        frame=frame[kept],
        landmark=own[kept],
        pixel=mean[kept],
        sigma_px=sigma[kept],
        repeatability_px=float(np.sqrt(squares / freedom)) if freedom else float("nan"),
        **_usual(read),
    )
    return picks, findings


def _by_point(frame: Ints, own: Ints) -> tuple[Ints, Ints]:
    """The picks of known landmarks, those of one point together, by frame and landmark.

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


def _means(read: PicksRead, rows: Ints, first: Ints) -> tuple[Floats, Floats]:
    """Weighted means (points, 2) of the picks of each point, and their sigmas (points,)."""
    points = len(first) - 1
    mean, sigma = np.empty((points, 2)), np.empty(points)
    for k in range(0, points, POINTS_AT_ONCE):
        end = min(k + POINTS_AT_ONCE, points)
        some, start = rows[first[k] : first[end]], first[k:end] - first[k]
        weight = read.sigma_px[some] ** -2.0
        total = np.add.reduceat(weight, start)
        weighted = np.add.reduceat(weight[:, None] * read.pixel(some), start)
        mean[k:end] = weighted / total[:, None]
        sigma[k:end] = total**-0.5
    return mean, sigma


def _usual(read: PicksRead) -> dict[str, float]:
    """The usual sigma of one pick; where it is stated, a smaller one is not believed."""
    usual = float(np.median(read.sigma_px)) if len(read.sigma_px) else 1.0
    return {"one_sigma_px": usual} | ({"least_sigma_px": usual} if read.stated else {})


def _contrary(away: Floats, sigma: Floats, inverse: Ints, points: int) -> Bools:
    """Points with a pick that is too far from the mean of its picks, (points,)."""
    far = np.hypot(*away.T) > APART / 2.0 * sigma
    return np.asarray(np.bincount(inverse[far], minlength=points) > 0)
