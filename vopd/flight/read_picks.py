"""The picks of a project: on one grid, and each landmark once a frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding
from vopd.flight.flight import Picks
from vopd.flight.input_file import InputFile, did_you_mean
from vopd.flight.lens_formats.lens_parameters import GRID_TO_CENTRE
from vopd.flight.pick_formats import PICK_FORMATS
from vopd.flight.pick_formats.pick_rows import PickRows
from vopd.flight.project_file import Project

APART = 20.0  # standard deviations between picks of one point that cannot both be right


class PicksRead(NamedTuple):
    """The picks of a project before their landmarks are looked up."""

    rows: PickRows
    pixel: Floats  # (P, 2) from the first pixel's centre
    sigma_px: Floats  # (P,)
    stated: bool  # whether the project or the file states it
    file: InputFile
    said: str


def read_pick_rows(project: Project, size_px: tuple[int, int]) -> PicksRead:
    """All picks of a project as they stand in its file, on the grid of the package.

    Raises:
        VopdError: where the grid is not known, or the images are not those of the lens
    """
    section = project.section("picks")
    file = project.open("picks")
    rows = project.read("picks", file, PICK_FORMATS)
    if rows.size_px is not None and rows.size_px != size_px:
        (w, h), (width, height) = rows.size_px, size_px
        turned = ": they were turned when they were picked" if (w, h) == (height, width) else ""
        message = f"{file.name} has images of {w} x {h}, the lens is for {width} x {height}{turned}"
        raise section.error("file", message)
    grid = rows.grid or section.text("pixel_grid", list(GRID_TO_CENTRE))
    if section.has("pixel_grid") and section.text("pixel_grid") != grid:
        raise section.error("pixel_grid", f"{rows.said} has the {grid} grid: leave the key out")
    pixel = rows.pixel + GRID_TO_CENTRE[grid]
    way = section.text("v", ("down", "up"), "down")
    if way == "up":
        pixel[:, 1] = size_px[1] - 1 - pixel[:, 1]
    stated = section.number("sigma_px", 1.0, above=0.0)
    sigma = np.where(np.isfinite(rows.sigma_px), rows.sigma_px, stated)
    said = f"{file.name}: {rows.said}, {len(sigma)} picks, {grid} grid, v {way}"
    known = section.has("sigma_px") or bool(np.isfinite(rows.sigma_px).any())
    return PicksRead(rows, pixel, sigma, known, file, said)


def join_picks(
    read: PicksRead,
    frame: Ints,
    frame_label: list[str],
    landmarks: tuple[str, ...],
    project: str,
) -> tuple[Picks, list[Finding]]:
    """The picks by landmark, several of one point in one frame averaged.

    Picks of a landmark that the project does not have, and picks of one point that
    contradict each other, take no part and are told.

    Args:
        read: the picks
        frame: index of each pick's frame, (P,)
        frame_label: what to call each frame
        landmarks: the names of the landmarks
        project: the project's name, for findings
    """
    findings = []
    index = {name: k for k, name in enumerate(landmarks)}
    names = read.rows.landmark
    own_of = np.array([index.get(name, -1) for name in names.known])
    own = own_of[names.which]
    picked_of = dict(zip(names.known, np.bincount(names.which).tolist(), strict=True))
    for name in sorted(name for name in names.known if name not in index):
        picked = picked_of[name]
        many = f"{picked} pick{'s'[: picked != 1]}"
        message = f"no landmark {name} ({many}){did_you_mean(name, landmarks[:20])}"
        findings.append(Finding(message, project, severity="warning"))
    known = np.flatnonzero(own >= 0)
    pair = frame[known] * max(len(landmarks), 1) + own[known]
    points, inverse, count = np.unique(pair, return_inverse=True, return_counts=True)
    weight = read.sigma_px[known] ** -2.0
    total = np.bincount(inverse, weight)
    mean = np.stack(
        [np.bincount(inverse, weight * read.pixel[known, k]) / total for k in (0, 1)], axis=1
    )
    away = read.pixel[known] - mean[inverse]
    contrary = _contrary(away, read.sigma_px[known], inverse, len(points))
    for k in np.flatnonzero(contrary):
        one, other = divmod(int(points[k]), len(landmarks))
        label, name = frame_label[one], landmarks[other]
        apart = 2.0 * np.hypot(*away[inverse == k].T).max()
        message = (
            f"{label}: {name} is picked {count[k]} times, up to {apart:.0f} px apart; "
            "none of these picks is used"
        )
        findings.append(Finding(message, project, severity="warning"))
    again = (count > 1) & ~contrary
    freedom = 2.0 * (count[again] - 1).sum()
    squares = (away[again[inverse]] ** 2).sum()
    kept = ~contrary
    picks = Picks(
        frame=points[kept] // max(len(landmarks), 1),
        landmark=points[kept] % max(len(landmarks), 1),
        pixel=mean[kept],
        sigma_px=np.asarray(total[kept] ** -0.5),
        repeatability_px=float(np.sqrt(squares / freedom)) if freedom else float("nan"),
        **_usual(read),
    )
    return picks, findings


def _usual(read: PicksRead) -> dict[str, float]:
    """The usual sigma of one pick; where it is stated, a smaller one is not believed."""
    usual = float(np.median(read.sigma_px)) if len(read.sigma_px) else 1.0
    return {"one_sigma_px": usual} | ({"least_sigma_px": usual} if read.stated else {})


def _contrary(away: Floats, sigma: Floats, inverse: Ints, points: int) -> Bools:
    """Points with a pick that is too far from the mean of its picks, (points,)."""
    far = np.hypot(*away.T) > APART / 2.0 * sigma
    return np.asarray(np.bincount(inverse[far], minlength=points) > 0)
