"""The image of one frame: the photograph or the film, landmarks measured and computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.estimate import Units
from vopd.figures.style import (
    BEHIND,
    COLOURS,
    FLAGGED,
    caption,
    halo,
    legend_below,
    name_text,
    place_names,
    plain,
    round_number,
    short,
)
from vopd.findings import VopdError, count_text
from vopd.geometry.earth import geodetic
from vopd.scene import FilmView

if TYPE_CHECKING:
    from vopd.scene import ImageScene, JobScene

# Draw the image of one frame: where its landmarks were measured and where they were computed.

LONGEST = 0.12  # about the length of the longest arrow, in terms of the width of the figure
LABELLED = 200  # up to this many landmarks have their label
NAME_SHOWN, FRAME_SHOWN = 24, 60  # characters of a landmark's name, and of a frame's in a title
ROOM = 1.35  # how far the axes go, in terms of the farthest point


Photograph = Callable[[int, str], Any]
"""Reads the photograph of a frame, by its number and its image's name, as a PIL image."""


def draw_image(
    figure: Any, histories: Sequence[History], frame: int | str | None, photograph: Any = None
) -> str:
    """Draw the image of a frame: in pixels as it was taken, or of a film in its plane.

    Args:
        figure: to draw in
        histories: the jobs
        frame: number or name; None takes the one with the most landmarks
        photograph: reads a photograph; None takes that of the project, false draws none
    """
    history, k = chosen(histories, frame)
    if history.estimate.scene is not None:
        scene = history.estimate.scene()
        if scene.image is not None:
            return _draw_pixels(figure, history, k, scene, photograph)
    return _draw_film(figure, history, k)


# The image as it was taken: pixels u right, v down

MOST_SHOWN_PX = 1600  # width or height of a photograph in the figure: larger ones are reduced
TRUE_LENGTH = 0.3  # of the image's width: an arrow that would be longer is drawn as it is
ALONG = np.linspace(0.1, 1.0, 12)[:, None]  # parts of an arrow that names keep clear of
ROOM_IN = (0.9, 1.9)  # width and height of a figure that labels, title and legend take, inches


def _draw_pixels(figure: Any, history: History, k: int, scene: JobScene, photograph: Any) -> str:
    e = history.estimate
    number, name = e.frame_key(k)
    assert scene.image is not None
    view = scene.image(number, name)
    width, height = view.size_px
    read = scene.photograph if photograph is None else photograph
    picture, said = _photograph(read, number, name) if read else (None, "")
    axis = figure.subplots()
    axis.grid(visible=False)
    edges = (-0.5, width - 0.5, height - 0.5, -0.5)
    if picture is not None:
        if picture.size != view.size_px:
            wide, high = picture.size
            said = f"photograph of {wide} x {high}: not the size of the lens's images"
        picture.thumbnail((MOST_SHOWN_PX, MOST_SHOWN_PX))
        axis.imshow(np.asarray(picture), extent=edges, interpolation="antialiased", zorder=0)
    axis.add_patch(image_border(edges, "none" if picture is not None else "0.97"))
    axis.set(xlim=(-0.03 * width, 1.03 * width), ylim=(1.03 * height, -0.03 * height))
    axis.set_aspect("equal")
    for side in axis.spines.values():
        side.set_visible(False)
    axis.set_xlabel("u, px, to the right")
    axis.set_ylabel("v, px, down")

    culprit = _culprits(history, k, scene, view)
    residual = view.pixel - view.fitted
    fits = np.isfinite(residual).all(axis=1)
    scale, along = draw_arrows(
        axis, view.fitted, residual, view.used & ~culprit, float(width), e.units
    )
    unpicked = _inside(view.computed, view.size_px)
    unpicked[view.landmark] = False
    look = {"ls": "", "mfc": "none", "path_effects": halo(3.0)}
    read_as = reading_word(scene)
    axis.plot(*view.fitted[fits].T, "+", mec="black", ms=14, label="computed", **look)
    for marks, mark, colour, size, text in (
        (view.pixel[view.used], "o", COLOURS[0], 9, read_as),
        (view.pixel[~view.used & ~culprit], "D", COLOURS[3], 7, f"{read_as}, not used"),
        (view.pixel[culprit], "s", FLAGGED, 13, "does not fit"),
        (view.computed[unpicked], "^", "0.3", 6, f"not {read_as}: computed place"),
    ):
        if len(marks):
            axis.plot(*marks.T, mark, mec=colour, mew=1.5, ms=size, label=text, zorder=4, **look)
    ends = np.array([[-0.5, height - 0.5], [width - 0.5, -0.5]])
    more = _horizon(axis, history, k, scene, view, ends)

    outside = ~_inside(view.pixel, view.size_px)
    if outside.any():
        some = ", ".join(
            name_text(scene.names[one], NAME_SHOWN) for one in view.landmark[outside][:3]
        )
        few = ", ..." if outside.sum() > 3 else ""
        more.append(f"{count_text(int(outside.sum()), 'pick')} outside the image: {some}{few}")
    own = [name_text(scene.names[one], NAME_SHOWN) for one in view.landmark]
    own = [f"{one}: does not fit" if odd else one for one, odd in zip(own, culprit, strict=True)]
    rest = np.flatnonzero(unpicked)
    order = np.argsort(~culprit, kind="stable")
    order = order[~outside[order]]
    places = np.concatenate([view.pixel[order], view.computed[rest]])[:LABELLED]
    names = [own[one] for one in order] + [name_text(scene.names[one], NAME_SHOWN) for one in rest]
    size_in = _size_in(figure)
    unit = min((size_in[0] - ROOM_IN[0]) / width, (size_in[1] - ROOM_IN[1]) / height) * 72.0
    bold = np.arange(len(places)) < int((culprit & ~outside).sum())
    corners = np.array([[-0.5, -0.5], [width - 0.5, height - 0.5]])
    pt = np.array([unit, -unit])
    nameless = place_names(axis, places, names[:LABELLED], pt, corners, bold, along)
    nameless += len(names) - len(places)
    if nameless:
        more.append(f"{count_text(nameless, 'name')} left out for want of room")
    handles, texts = axis.get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=5)
    when = f", {e.time_s[k]:.3f} s" if np.isfinite(e.time_s[k]) else ""
    told = [f"frame {name_text(e.frame_label(k), FRAME_SHOWN)}{when}", *filter(None, [said]), *more]
    return (
        f"{caption([history])}\n{'; '.join(told)}\n"
        f"arrows: residuals, picked minus computed, {scale:g} times as long{_misfit(history, k)}"
    )


def reading_word(scene: JobScene) -> str:
    """Choose the word for how landmarks came to their places in an image."""
    if scene.image is None:
        return "measured"
    return "picked" if scene.clicks is None else "clicked or tracked"


def _size_in(figure: Any) -> Floats:
    """Find the size of a figure, or of a part of one, inches."""
    box = figure.bbox
    return np.array([box.width / figure.dpi, box.height / figure.dpi])


def image_border(edges: tuple[float, float, float, float], colour: str) -> Any:
    """Outline an image by its left, right, lower and upper edge."""
    from matplotlib.patches import Rectangle

    left, right, low, high = edges
    return Rectangle((left, high), right - left, low - high, fc=colour, ec="black", lw=1.0)


def _photograph(read: Photograph, number: int, name: str) -> tuple[Any, str]:
    """Read a photograph; without one, say why."""
    try:
        return read(number, name), ""
    except VopdError as error:
        return None, f"no photograph: {plain(str(error))}"


def _culprits(history: History, k: int, scene: JobScene, view: ImageScene) -> Bools:
    """Mark the picks of a frame that do not fit, or were set aside as blunders, (P,)."""
    rows = frame_landmarks(history)
    odd = {history.estimate.landmark_label(one) for one in rows.odd_in(k)}
    named = np.array([scene.names[one] in odd for one in view.landmark], dtype=bool)
    return named | (~view.used & ~scene.check[view.landmark])


# Horizon and north

HORIZON = "#7a3b9a"
LABEL_SHARE = 0.03  # half of the width of an azimuth, in terms of the image's
AZIMUTHS = {0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW"}


def _horizon(
    axis: Any, history: History, k: int, scene: JobScene, view: ImageScene | FilmView, ends: Floats
) -> list[str]:
    """Draw the horizon with azimuths, or if it is not in the picture the way north; say what.

    Args:
        axis: to draw in
        history: the job
        k: index of the frame
        scene: its surroundings
        view: of the frame
        ends: the corners of the picture, its lower left and upper right one, (2, 2)
    """
    camera = scene.camera_m[camera_index(history, k, scene)]
    dip = float(horizon_dip_deg(camera, scene.landmark_m))
    azimuth = np.arange(0.0, 360.0, 0.25)
    line = view.pixel_of(toward(azimuth, -dip))
    inside = _between(line, ends)
    if inside.sum() > 1:
        broken = np.where(inside[:, None], line, np.nan)
        axis.plot(*broken.T, "--", color=HORIZON, lw=1.2, path_effects=halo(), label="horizon")
        span = float(inside.sum()) * 0.25
        step = next(one for one in (5, 10, 15, 30, 45) if span / one < 9 or one == 45)
        ticks = np.arange(0, 360, step)
        at = view.pixel_of(toward(ticks.astype(float), -dip))
        seen = _between(at, ends)
        across = (at[:, 0] - ends[0, 0]) / (ends[1, 0] - ends[0, 0])
        seen &= np.abs(across - 0.5) < 0.5 - LABEL_SHARE
        for degrees, point in zip(ticks[seen].tolist(), at[seen], strict=True):
            axis.plot(*point, "|", color=HORIZON, ms=8, path_effects=halo())
            text = f"{degrees:03d}° {AZIMUTHS.get(degrees, '')}".strip()
            axis.annotate(
                text, point, (0, 9), textcoords="offset points", ha="center", fontsize=7.5,
                color=HORIZON, bbox=BEHIND, zorder=6,
            )  # fmt: skip
        return ["horizon: of a plain as high as the lowest landmark, azimuths from true north"]
    middle = ends.mean(axis=0, keepdims=True)
    direction = view.direction_of(middle)
    moved = direction + 0.02 * np.array([[0.0, 1.0, 0.0]])
    way = (view.pixel_of(moved) - middle)[0]
    length = float(np.hypot(*way))
    if not length > 0.0:
        return []
    way *= 0.05 * abs(ends[1, 0] - ends[0, 0]) / length
    foot = ends[0] + (ends[1] - ends[0]) * [0.91, 0.85]
    axis.annotate(
        "", foot + way, foot - way, zorder=6,
        arrowprops={"arrowstyle": "-|>", "color": HORIZON, "lw": 2.0, "path_effects": halo(4.0)},
    )  # fmt: skip
    axis.text(
        *(foot + 1.35 * way), "N", ha="center", va="center", color=HORIZON, fontweight="bold",
        bbox=BEHIND, zorder=6,
    )  # fmt: skip
    return ["N: the way to true north in the picture's middle"]


BENT, EARTH_M = 0.13, 6371e3  # of standard refraction, for the horizon


def horizon_dip_deg(camera_m: Floats, landmark_m: Floats) -> Floats:
    """Find how far below level the horizon of a plain is that is as high as the lowest landmark.

    Args:
        camera_m: Earth-centred, (..., 3)
        landmark_m: Earth-centred, (N, 3)
    """
    height_m = geodetic(camera_m).height_m - geodetic(landmark_m).height_m.min()
    below = 2.0 * np.maximum(height_m, 0.0) * (1.0 - BENT) / EARTH_M
    return np.asarray(np.degrees(np.sqrt(below)))


def toward(azimuth_deg: Floats, elevation_deg: Floats | float) -> Floats:
    """Find directions east, north, up, (..., 3)."""
    around, up = np.radians(azimuth_deg), np.radians(elevation_deg)
    level = np.cos(up)
    above = np.broadcast_to(np.sin(up), np.shape(around))
    return np.stack([np.sin(around) * level, np.cos(around) * level, above], axis=-1)


def _inside(pixel: Floats, size_px: tuple[int, int]) -> Bools:
    """Mark pixels within the image."""
    return _between(pixel, np.array([[-0.5, -0.5], np.array(size_px) - 0.5]))


def _between(points: Floats, ends: Floats) -> Bools:
    """Mark points of a plane (n, 2) between two corners (2, 2)."""
    low, high = np.sort(ends, axis=0)
    with np.errstate(invalid="ignore"):
        return np.asarray(((points >= low) & (points <= high)).all(axis=1))


def camera_index(history: History, k: int, scene: JobScene) -> int:
    """Find a frame of a history among those of its scene."""
    e = history.estimate
    return scene.index(*e.frame_key(k))


# The film, as the report of 1974 has it


def _draw_film(figure: Any, history: History, k: int) -> str:
    """Draw the image as seen from behind the camera, in image units from its centre."""
    e, words = history.estimate, history.about.words
    rows = frame_landmarks(history)
    shown = (rows.frame == k) & rows.used
    shown &= np.isfinite(rows.image).all(axis=1) & np.isfinite(rows.residual).all(axis=1)
    measured, residual, odd = rows.image[shown], rows.residual[shown], rows.odd[shown]
    scene = e.scene() if e.scene is not None else None
    corner, inside, computed, axes = (one[0] for one in film_frames(history, scene, [k]))
    corners = corner[np.isfinite(corner).all(axis=1)]
    others = np.array(scene.names if scene is not None else (), dtype=str)[inside].tolist()
    axis = figure.subplots()
    extent = np.vstack([measured, corners])
    far = np.maximum(np.abs(extent).max(axis=0, initial=0.0), 1e-3)
    far = far * (1.03 if len(corners) else ROOM)
    if len(corners):
        axis.fill(*corners.T, fc="0.97", ec="black", lw=1.0, zorder=0, label="joins the fiducials")
    else:
        far[:] = far.max()
    fitted = measured - residual
    scale = max(arrow_scale(residual, 2.0 * far[0]), 1.0)
    residual_arrows(axis, fitted, residual, scale, e.units)
    axis.plot(*fitted.T, "+", color="0.2", ms=12, label="computed")
    for marks, mark, colour, size, text in (
        (measured, "o", COLOURS[0], 7, "measured"),
        (measured[odd], "s", FLAGGED, 12, "does not fit"),
        (computed[inside], "^", "0.3", 6, "not used: computed place"),
    ):
        if len(marks):
            axis.plot(*marks.T, mark, mfc="none", mec=colour, ms=size, label=text)
    axis.plot(0.0, 0.0, "x", color="0.5", ms=8, label=words.centre)
    more = []
    if scene is not None and len(corners):
        view = FilmView(axes, e.focal_length)
        more = _horizon(axis, history, k, scene, view, film_ends(corners))
    order = np.argsort(~odd, kind="stable")
    numbers = rows.landmark[shown][order].tolist()
    names = [name_text(e.landmark_label(one), NAME_SHOWN) for one in numbers]
    names = [f"{one}: does not fit" if n < odd.sum() else one for n, one in enumerate(names)]
    names = [*names, *(name_text(one, NAME_SHOWN) for one in others)][:LABELLED]
    places = np.vstack([measured[order], computed[inside]])
    unit = float((72.0 * (_size_in(figure) - FILM_ROOM_IN) / (2.0 * far)).min())
    along = (fitted[:, None] + residual[:, None] * scale * ALONG).reshape(-1, 2)
    nameless = place_names(
        axis, places[:LABELLED], names, np.array([-unit, unit]), np.stack([-far, far]),
        np.arange(len(names)) < odd.sum(), along,
    )  # fmt: skip
    nameless += len(places) - len(names)
    axis.set(xlim=(far[0], -far[0]), ylim=(-far[1], far[1]), aspect="equal")  # x grows to the left
    axis.set_xlabel(f"x, {e.units.image} {words.surface}, to the left")
    axis.set_ylabel(f"y, {e.units.image} {words.surface}, up")
    handles, texts = axis.get_legend_handles_labels()
    legend_below(figure, handles, texts, 4)
    when = f"{e.time_s[k]:.3f} s, " if np.isfinite(e.time_s[k]) else ""
    landmarks = count_text(history.landmarks[k], "landmark")
    if nameless:
        more.append(f"{count_text(nameless, 'name')} left out for want of room")
    return (
        f"{caption([history])}\nframe {name_text(e.frame_label(k), FRAME_SHOWN)}, {when}"
        f"{'; '.join([landmarks, 'corrected for distortion', *more])}\n"
        f"arrows: residuals, measured minus computed, {scale:g} times as long"
        f"{_misfit(history, k)}"
    )


FILM_ROOM_IN = (2.0, 2.2)  # width and height of a figure that labels, title, key and legend take


def film_ends(corners: Floats) -> Floats:
    """Find the lower left and the upper right end of films (..., 2, 2) by their corners."""
    most = np.abs(corners).max(axis=-2)
    return np.asarray(most[..., None, :] * np.array([[1.0, -1.0], [-1.0, 1.0]]))


def film_frames(
    history: History, scene: JobScene | None, frames: Sequence[int] | Ints
) -> tuple[Floats, Bools, Floats, Floats]:
    """Find the frames of a film, and the landmarks in them that no residual shows.

    Args:
        history: the job
        scene: its surroundings of N landmarks; None: nothing is found
        frames: indices of n frames

    Returns:
        Corners in order, NaN where they are not known, (n, 4, 2); which landmarks are in the
        frame and were not measured or not used, (n, N); where they were computed (n, N, 2); and
        the camera's axes as rows, in components east, north, up (n, 3, 3).
    """
    if scene is None or scene.film is None:
        none = np.full((len(frames), 4, 3), np.nan)
        return none[..., :2], np.zeros((len(frames), 0), bool), none[:, :0, :2], none[:, :3]
    corners, computed, axes = scene.film(
        np.array([camera_index(history, k, scene) for k in frames])
    )
    known = np.isfinite(corners).all(axis=(1, 2)) & np.ptp(corners, axis=1).all(axis=1)
    corners = np.where(known[:, None, None], corners, np.nan)
    with np.errstate(invalid="ignore"):
        shown = (np.abs(computed) <= np.abs(corners).max(axis=1)[:, None]).all(axis=2)
    rows = frame_landmarks(history)
    index = {name: n for n, name in enumerate(scene.names)}
    place = {int(k): n for n, k in enumerate(frames)}
    measured = np.isfinite(rows.image).all(axis=1) & rows.used
    for frame, number in zip(rows.frame[measured], rows.landmark[measured], strict=True):
        if int(frame) in place:
            shown[place[int(frame)], index[history.estimate.landmark_label(int(number))]] = False
    return corners, shown, computed, axes


def _misfit(history: History, k: int) -> str:
    """Explain the misfit of a frame in one line, with names as they stand beside landmarks."""
    flags = history.flags
    if not flags.raised["misfit"][k]:
        return ""
    text = str(flags.detail["misfit"][k])
    for name in sorted(history.estimate.landmark_names.values(), key=len, reverse=True):
        text = text.replace(name, short(name, NAME_SHOWN)) if len(name) > NAME_SHOWN else text
    return f"\nmisfit: {plain(text)}"


def draw_arrows(
    axis: Any, fitted: Floats, residual: Floats, usual: Bools, width: float, units: Units
) -> tuple[float, Floats]:
    """Draw residuals many times as long, and those that would be too long as they are, broken.

    Args:
        axis: to draw in
        fitted: where they begin, (P, 2)
        residual: (P, 2); NaN: none
        usual: which have the size that arrows are drawn for, (P,)
        width: of the picture, in the same unit
        units: of the residuals

    Returns:
        How many times as long arrows are, and points along them.
    """
    fits = np.isfinite(residual).all(axis=1)
    length = np.hypot(*residual.T)
    plainly = fits & usual
    scale = max(arrow_scale(residual[plainly if plainly.any() else fits], width), 1.0)
    arrow = fits & ((length * scale <= TRUE_LENGTH * width) | (scale == 1.0))
    residual_arrows(axis, fitted[arrow], residual[arrow], scale, units, most_px=width)
    for pick in np.flatnonzero(fits & ~arrow):
        ends = np.stack([fitted[pick], fitted[pick] + residual[pick]])
        line = axis.plot(*ends.T, "--", color=FLAGGED, lw=1.2, path_effects=halo(), zorder=3)
    if (fits & ~arrow).any():
        line[0].set_label("residual as long as it is")
    drawn = residual * np.where(arrow, scale, 1.0)[:, None]
    return scale, (fitted[fits, None] + drawn[fits, None] * ALONG).reshape(-1, 2)


def residual_arrows(
    axis: Any, start: Floats, residual: Floats, scale: float, units: Units, most_px: float = 0.0
) -> None:
    """Draw the residuals as arrows, and one of a round length as the key.

    Args:
        axis: to draw in
        start: where they begin, (n, 2)
        residual: (n, 2)
        scale: how many times as long they are drawn
        units: of the residuals
        most_px: width of the picture that they are drawn on; 0: there is none
    """
    look = {"path_effects": halo()} if most_px else {}
    arrows = axis.quiver(
        *start.T, *residual.T, angles="xy", scale_units="xy", scale=1.0 / scale,
        color=COLOURS[1], width=0.004, zorder=5 if most_px else 2, **look,
    )  # fmt: skip
    longest = float(np.hypot(*residual.T).max(initial=0.0)) * units.residuals_per_image
    if longest > 0.0:
        key = round_number(longest)
        length, label = key / units.residuals_per_image, f"{key:g} {units.residual}"
        if units.residual == "µm" and key >= 1000.0:
            label = f"{key / 1000.0:g} mm"
        where = (0.88, 0.06, "N") if most_px else (1.05, 0.06, "S")
        key_drawn = axis.quiverkey(
            arrows, *where[:2], length, label, labelpos=where[2], coordinates="axes"
        )
        if most_px:
            key_drawn.text.set_bbox(BEHIND)


def chosen(histories: Sequence[History], frame: int | str | None) -> tuple[History, int]:
    """Find the history that has a frame, and the index of the frame in it.

    Args:
        histories: the jobs
        frame: its number or name, in the first job that has it; None takes the
            frame with the most landmarks, the first of several; of clicks tracked through a video
            the one of those without clicks that fits worst, as clicks fit by their own errors

    Raises:
        VopdError: where no job has that frame, or it has no attitude
    """
    have = [(h, int(k)) for h in histories for k in np.flatnonzero(h.has_attitude)]
    if frame is None:
        counts = np.concatenate([h.landmarks[h.has_attitude] for h in histories])
        first = have[int(counts.argmax())]
        return first[0], _worst_tracked(first[0], first[1])
    asked = str(frame).strip()
    for history, k in have:
        if history.estimate.frame_label(k) == asked:
            return history, k
    if any(asked == h.estimate.frame_label(k) for h in histories for k in range(len(h.status))):
        raise VopdError(f"frame {asked} has no attitude: it is ignored, or the run stopped there")
    labels = [h.estimate.frame_label(k) for h, k in have]
    files = ", ".join(dict.fromkeys(h.about.source for h in histories))
    raise VopdError(f"{files}: no frame {asked}: there are {labels[0]} to {labels[-1]}")


def _worst_tracked(history: History, k: int) -> int:
    """Choose the tracked frame that fits worst, of those with as many landmarks as frame k."""
    estimate = history.estimate
    scene = estimate.scene() if estimate.scene is not None else None
    if scene is None or scene.clicks is None:
        return k
    tracked = history.has_attitude & (history.landmarks == history.landmarks[k])
    tracked[scene.clicks()[0]] = False
    rms = np.where(tracked, history.residual_rms, np.nan)
    return k if np.isnan(rms).all() else int(np.nanargmax(rms))


def arrow_scale(residual: Floats, width: float) -> float:
    """Choose the scale of arrows, a round number."""
    longest = float(np.hypot(*residual.T).max(initial=0.0))
    return round_number(LONGEST * width / longest) if longest > 0.0 else 1.0
