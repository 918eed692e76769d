"""The directions of a project's landmarks in frames of its video, by which a page predicts them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.formats.tables import has_columns
from vopd.flight.project.keys import VIDEO, Project
from vopd.flight.project.read import flight_of
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.lenses import Lens, Lenses
from vopd.video import VideoFrames, image_numbers

PlainLenses = list[dict[str, Any]]


def plain_lenses(lens: Lens, frames: int) -> tuple[PlainLenses, list[int]]:
    """Write the lenses of frames as plain values, and say which of them each frame has."""
    if not isinstance(lens, Lenses):
        lens = Lenses.join((lens,), np.zeros(frames, np.int64))
    written = [
        {
            "kind": one.kind.value,
            "focal": one.focal_px.tolist(),
            "centre": one.centre_px.tolist(),
            "skew": one.skew_px,
            "k": one.coefficients.tolist(),
            "field": one.field_radius if np.isfinite(one.field_radius) else None,
        }
        for one in lens.each
    ]
    return written, lens.which.tolist()


def names_of(frames: VideoFrames, picked: Collection[str], project: Project | None) -> list[str]:
    """Name all frames as rows of picks do: images by the numbers in their names, if these do.

    Args:
        frames: of a video or a folder of images
        picked: the frames or images of the picks that there are
        project: whose times are by number or by image where there are no picks; or none
    """
    label = [frames.label(k) for k in range(len(frames))]
    number = [str(one) for one in image_numbers(frames.image_name)]
    if not frames.image_name:
        return label
    by_number = {*picked} <= {*number} if picked else project is not None and _by_number(project)
    return number if by_number else label


def _by_number(project: Project) -> bool:
    """Tell whether the table of a project's times has numbers of frames and no images."""
    section = project.section("picks")
    if not section.has("times") or section.text("times") == VIDEO:
        return False
    if not (project.folder / section.text("times")).is_file():
        return False
    file = project.open("picks", "times")
    known = ("frame", "image")
    return has_columns(file, known, ("frame",)) and not has_columns(file, known, ("image",))


def directions_of(
    project: Project, frames: VideoFrames, chosen: Sequence[int], name: Sequence[str]
) -> tuple[tuple[str, ...], Floats, PlainLenses, list[int], float, str]:
    """Trace the lines of sight to all landmarks of a project in frames of its video.

    Args:
        project: with the landmarks, the lens and the camera's places
        frames: of a video or a folder of images
        chosen: the indices of those that are wanted
        name: of each of the frames, as picks have it

    Returns:
        Names of landmarks, (N,); unit vectors east, north, up to them from the camera's stated
        places, raised by refraction, (F, N, 3); lenses, and which of them each frame has; the
        standard deviation of one pick, pixels; and what a solve has besides, for a sentence, empty
        for nothing.

    Raises:
        VopdError: where the project lacks what tells the camera's places, or the lens, or that is
            not of frames of this size
    """
    label = [name[k] for k in chosen]
    by_image = label[0] in frames.image_name
    own: Any = Names(label) if by_image else np.array(list(map(int, label)))
    section = project.section("picks")
    sigma_px = section.number("sigma_px")
    none = np.zeros((len(label), 2))
    rows = PickRows(
        own, Names([""] * len(label)), none, np.full(len(label), sigma_px), "centre", None, ""
    )
    if project.section("solve").has("frames"):
        project = project.changed("solve", "frames", "each")
    flight = flight_of(project, rows)
    known = list(flight.image_name) or [str(one) for one in flight.frame.tolist()]
    at = np.array([known.index(one) for one in label])
    marks = flight.landmarks
    frame, mark = (one.ravel() for one in np.indices((len(at), len(marks.name))))
    lines = sight_lines(
        flight.path.position_m[at], marks.position_m, frame, mark, flight.refraction
    )
    lens = flight.lens.of(at)
    width, height = next(frames.pictures(chosen[:1])).size
    own_px = lens.by_rows("size_px").reshape(-1, 2)[0].astype(int).tolist()
    if [width, height] != own_px:
        raise project.section("camera").error(
            "lens", f"is for {own_px[0]} x {own_px[1]}, and {label[0]} has {width} x {height}"
        )
    arm = flight.path.lever_arm_m
    left_out = ["the lever arm"] if arm is not None and np.any(arm) else []
    left_out += ["the rolling shutter"] if flight.shutter is not None else []
    direction = lines.direction.reshape(len(at), len(marks.name), 3)
    lenses = plain_lenses(lens, len(at))
    return marks.name, direction, *lenses, sigma_px, " and ".join(left_out)
