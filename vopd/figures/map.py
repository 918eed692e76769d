"""The map: track, landmarks, and one frame's footprint and lines of sight, with their heights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.history import History
from vopd.attitude.long_history import frame_landmarks
from vopd.figures.image import (
    FRAME_SHOWN,
    LABELLED,
    NAME_SHOWN,
    camera_index,
    chosen,
    reading_word,
)
from vopd.figures.style import (
    BEHIND,
    COLOURS,
    FLAGGED,
    caption,
    legend_below,
    name_text,
    place_names,
    round_number,
)
from vopd.findings import VopdError, angle_text, count_text
from vopd.geometry.earth import geodetic, local_axes

if TYPE_CHECKING:
    from vopd.scene import JobScene

NO_MAP = "no map: where landmarks and camera are is not known"
BEYOND = 1.3  # how far the footprint of a view toward the horizon goes: of the farthest landmark
MISSED = 0.01  # of the distance to a landmark: a line of sight that passes it farther is marked
MISSES = "passes its landmark (dots)\nby over 1 % of the distance"
STEPS = 40  # of a line of sight, so that over a long way the Earth's curvature shows
SEEN = 0.02  # of the plan: a track that is smaller is not seen behind the camera's mark
ROOM = 0.08  # around all that is drawn
GATHERED = 0.1  # mean of level directions to landmarks: above it they lie to one side
IN_IMAGE = "ground in the image, of the\nlandmarks' mean height"
LOOKS_UP = "azimuths in the image, which\nlooks up at the landmarks"
SIDE = 0.32  # of the height of the figure: the side view


def draw_map(
    figure: Any, histories: Sequence[History], frame: int | str | None, _: Any = None
) -> str:
    """Draw the map of one job, from above and from the side, with the view of one frame.

    Args:
        figure: to draw in
        histories: the jobs
        frame: number or name; None takes the one with the most landmarks
    """
    history, k = chosen(histories, frame)
    if history.estimate.scene is None:
        raise VopdError(NO_MAP)
    scene = history.estimate.scene()
    e = history.estimate
    number, name = e.frame_key(k)
    camera_m = scene.camera_m[camera_index(history, k, scene)]
    known = scene.camera_m[np.isfinite(scene.camera_m[:, 0])]
    unit_m, unit, axes = 1.0, "m", local_axes(camera_m[None])[0]
    away_m = float(np.linalg.norm(scene.landmark_m - camera_m, axis=1).max(initial=1.0))
    if away_m > 20_000.0 and scene.plane is None:
        unit_m, unit = 1000.0, "km"

    def plan(position_m: Floats) -> Floats:
        if scene.plane is not None:
            return scene.plane(position_m.reshape(-1, 3))[0].reshape(*position_m.shape[:-1], 2)
        return np.asarray((position_m - camera_m) @ axes[:2].T / unit_m)

    read = reading_word(scene)
    picked, ray = scene.sight(number, name)
    mark_m = scene.landmark_m[picked]
    along = ((mark_m - camera_m) * ray).sum(axis=1)
    along = np.where(along > 0.0, along, np.linalg.norm(mark_m - camera_m, axis=1))
    steps = np.linspace(0.0, 1.0, STEPS)[:, None]
    line_m = camera_m + (along[:, None] * ray)[:, None, :] * steps  # (n, STEPS, 3)
    miss_m = np.linalg.norm(mark_m - line_m[:, -1], axis=1)
    culprit = _culprits(history, k, scene)
    missed = (miss_m > MISSED * along) | np.isin(picked, np.flatnonzero(culprit))
    flat = (mark_m - camera_m) @ axes[:2].T
    level = (flat / np.maximum(np.hypot(*flat.T), 1e-9)[:, None]).sum(axis=0)
    gathered = np.hypot(*level) > GATHERED * len(ray)
    azimuth = np.degrees(np.arctan2(level[0], level[1])) if gathered else 90.0

    def beside(position_m: Floats) -> Floats:
        """The distance along the view, and the height."""
        flat = (position_m - camera_m) @ axes[:2].T
        way = np.radians(azimuth)
        along = flat @ np.array([np.sin(way), np.cos(way)]) / unit_m
        height = geodetic(position_m).height_m
        return np.stack([along, height / unit_m], axis=-1)

    shown_m = np.vstack([plan(known), plan(scene.landmark_m), plan(camera_m)[None]])
    above, side = figure.subplots(2, 1, height_ratios=(1.0 - SIDE, SIDE))
    foot, cut_short = _footprint(scene, history, k, camera_m, axes, away_m)
    looks_up = rise_m(scene.landmark_m, camera_m, axes) > 0.0
    for axis, to in ((above, plan), (side, beside)):
        if axis is above and foot is not None:
            at = to(foot)
            axis.fill(*at.T, fc=f"{COLOURS[4]}2e", ec=COLOURS[4], zorder=0,
                      label=LOOKS_UP if looks_up else IN_IMAGE)  # fmt: skip
        if (
            len(known) > 1
            and np.ptp(to(known), axis=0).max() > SEEN * np.ptp(shown_m, axis=0).max()
        ):
            axis.plot(
                *to(known).T, ".-", color="0.25", ms=3, lw=0.8, zorder=2, label="camera's track",
                rasterized=len(known) > 2000,
            )  # fmt: skip
        for n, (one, odd) in enumerate(zip(line_m, missed, strict=True)):
            text = MISSES if odd else "line of sight"
            axis.plot(
                *to(one).T, "--" if odd else "-", color=FLAGGED if odd else COLOURS[0], zorder=3,
                lw=1.4 if odd else 0.9, label=text if odd not in missed[:n] else None,
            )  # fmt: skip
            if odd:
                ends = np.stack([one[-1], mark_m[n]])
                axis.plot(*to(ends).T, ":", color=FLAGGED, lw=2.5, zorder=7)
        used = np.zeros(len(scene.names), bool)
        used[picked] = True
        for here, mark, colour, text in (
            (~used, "^", "0.45", f"landmark not {read} in this frame"),
            (used & ~culprit, "^", COLOURS[0], f"landmark {read} in this frame"),
            (culprit, "s", FLAGGED, "does not fit"),
        ):
            if here.any():
                axis.plot(
                    *to(scene.landmark_m[here]).T, mark, color=colour, label=text, zorder=5,
                    mfc=colour if mark == "^" and colour != "0.45" else "white",
                    ms=9 if mark == "s" else 7, mew=1.4,
                )  # fmt: skip
        axis.plot(
            *to(camera_m), "o", color=COLOURS[1], ms=8, mec="black", zorder=6,
            label="camera of this frame",
        )  # fmt: skip
    size_in = np.array([figure.bbox.width, figure.bbox.height]) / figure.dpi
    box_in = np.array([size_in[0] - 1.1, (size_in[1] - 2.3) * (1.0 - SIDE)])
    shown = np.vstack([plan(known), plan(scene.landmark_m), plan(line_m).reshape(-1, 2)])
    low, high = _limits(shown, box_in)
    above.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    above.set_aspect("equal")
    side_in = np.array([size_in[0] - 0.6, (size_in[1] - 2.3) * SIDE])
    heights = np.vstack([beside(known), beside(scene.landmark_m), beside(line_m).reshape(-1, 2)])
    least, most = heights.min(axis=0), heights.max(axis=0)
    span = np.maximum(most - least, 1e-3 * max(float((most - least).max()), 1.0))
    span[1] = max(span[1], span[0] * side_in[1] / side_in[0] * 0.02)
    wide = span[1] * (1.0 + 4.0 * ROOM) / (1.0 + 2.0 * ROOM) * side_in[0] / side_in[1]
    if span[0] < wide:  # to scale: heights are never drawn smaller than distances
        middle = (least[0] + most[0]) / 2.0
        least[0], most[0], span[0] = middle - wide / 2.0, middle + wide / 2.0, wide
    around = np.array([ROOM, 2.0 * ROOM]) * span
    in_view = np.stack([least - around, most + around])
    side.set(xlim=in_view[:, 0], ylim=in_view[:, 1])
    side_pt = 72.0 * side_in / (span + 2.0 * around)
    stretched = side_pt[1] / side_pt[0]

    order = np.argsort(np.where(culprit, 0, np.where(used, 1, 2)), kind="stable")[:LABELLED]
    names = [name_text(scene.names[one], NAME_SHOWN) for one in order]
    names = [
        f"{n}: does not fit" if culprit[one] else n for n, one in zip(names, order, strict=True)
    ]
    nameless = len(scene.names) - len(order)
    pt = 72.0 * box_in / (high - low)
    at = plan(scene.landmark_m[order])
    nameless += place_names(above, at, names, pt, np.stack([low, high]), culprit[order])
    at = beside(scene.landmark_m[order])
    names = [name_text(scene.names[one], NAME_SHOWN) for one in order]
    nameless += place_names(side, at, names, side_pt, in_view)

    where = f"in {scene.crs}, m" if scene.plane is not None else f"of this frame's camera, {unit}"
    above.set_xlabel(f"easting {where}" if scene.plane is not None else f"east {where}")
    above.set_ylabel("northing, m" if scene.plane is not None else f"north, {unit}")
    toward = angle_text(azimuth, 0)
    side.set_xlabel(f"distance from the camera toward {toward}° from true north, {unit}")
    side.set_ylabel(f"height, {unit}")
    for axis in (above, side):
        axis.ticklabel_format(style="plain", useOffset=False)
    _scale_bar(above, low, high, unit)
    _north(above, scene, camera_m)
    handles, texts = above.get_legend_handles_labels()
    legend_below(figure, handles, texts, 3)
    told = [f"frame {name_text(e.frame_label(k), FRAME_SHOWN)}", f"lines of sight as {read}"]
    told.append("N: true north")
    if missed.any():
        worst = int(np.where(missed, miss_m / along, 0.0).argmax())
        told.append(
            f"red: {count_text(int(missed.sum()), 'line')} of sight that "
            f"{'misses its landmark' if missed.sum() == 1 else 'miss their landmarks'} by more "
            f"than {MISSED:.0%} of the distance, or do not fit, "
            f"most {name_text(scene.names[picked[worst]], NAME_SHOWN)}: {miss_m[worst]:.3g} m"
        )
    if cut_short:
        told.append("the image shows more ground, farther away than is drawn")
    if nameless:
        told.append(f"{count_text(nameless, 'name')} left out for want of room")
    scale = f"heights drawn {stretched:.2g} times as large as distances"
    told.append(f"below: from the side, {scale if f'{stretched:.2g}' != '1' else 'to scale'}")
    return f"{caption([history])}\n{'; '.join(told)}"


def _culprits(history: History, k: int, scene: JobScene) -> Bools:
    """Mark the landmarks that do not fit in this frame, (N,)."""
    rows = frame_landmarks(history)
    odd = {history.estimate.landmark_label(one) for one in rows.odd_in(k)}
    return np.array([name in odd for name in scene.names], dtype=bool)


def _limits(points: Floats, box_in: Floats) -> tuple[Floats, Floats]:
    """Choose the corners of the plan, of the shape of its box, with room around all points."""
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    middle, span = (low + high) / 2.0, np.maximum(high - low, 1e-3) * (1.0 + 2.0 * ROOM)
    per_in = float((span / box_in).max())
    return middle - per_in * box_in / 2.0, middle + per_in * box_in / 2.0


def _footprint(
    scene: JobScene, history: History, k: int, camera_m: Floats, axes: Floats, away_m: float
) -> tuple[Floats | None, bool]:
    """Find where the image's border meets the mean height of the landmarks, Earth-centred.

    Of a view that reaches the horizon it ends somewhat beyond the farthest landmark.
    """
    if scene.image is None:
        return None, False
    e = history.estimate
    view = scene.image(*e.frame_key(k))
    width, height = view.size_px
    edge = np.linspace(0.0, 1.0, 30)[:-1]
    around = [
        (edge, 0 * edge),
        (0 * edge + 1, edge),
        (1 - edge, 0 * edge + 1),
        (0 * edge, 1 - edge),
    ]
    share = np.hstack([np.stack(one) for one in around]).T
    direction = view.direction_of(share * [width - 1.0, height - 1.0])
    return ground(direction, scene.landmark_m, camera_m, axes, away_m)


def ground(
    direction: Floats, landmark_m: Floats, camera_m: Floats, axes: Floats, away_m: float
) -> tuple[Floats | None, bool]:
    """Find where lines of sight meet the mean height of the landmarks, Earth-centred (n, 3).

    Those that do not, or too far away, end somewhat beyond the farthest landmark. Where the
    landmarks are above the camera it is the sector of azimuths that the image has.

    Args:
        direction: unit vectors east, north, up, (n, 3); NaN ones are left out
        landmark_m: Earth-centred, (N, 3)
        camera_m: Earth-centred, (3,)
        axes: east, north, up at the camera as rows, (3, 3)
        away_m: how far the farthest landmark is

    Returns:
        The places, None if no line meets the ground; and whether some line does not.
    """
    direction = direction[np.isfinite(direction).all(axis=1)]
    below_m = rise_m(landmark_m, camera_m, axes)
    if below_m > 0.0 and len(direction):  # a plane above the camera is no ground
        return camera_m + _sector(direction) * (BEYOND * away_m) @ axes, False
    with np.errstate(divide="ignore", invalid="ignore"):
        far = below_m / direction[:, 2]
    level = np.hypot(direction[:, 0], direction[:, 1])
    most = BEYOND * away_m
    endless = ~((far > 0.0) & (far * level < most))
    if endless.all():
        return None, False
    reach = np.where(endless, most / np.maximum(level, 1e-9), far)
    flat = direction[:, :2] * reach[:, None]
    flat = np.hstack([flat, np.full((len(flat), 1), below_m)])
    return camera_m + flat @ axes, bool(endless.any())


def rise_m(landmark_m: Floats, camera_m: Floats, axes: Floats) -> float:
    """Measure how much higher than the camera the landmarks are in the mean, along its vertical."""
    return float(((landmark_m - camera_m) @ axes[2]).mean())


def _sector(direction: Floats) -> Floats:
    """Find the level directions between the azimuths of an image's border, and its apex, (n, 3).

    Args:
        direction: unit vectors east, north, up, (n, 3)
    """
    level = direction[:, 0] + 1j * direction[:, 1]
    middle = level.sum()
    apart = np.angle(level / middle) if abs(middle) > 0.0 else np.zeros(1)
    turn = np.exp(1j * np.linspace(apart.min(), apart.max(), 30)) * middle / max(abs(middle), 1e-9)
    around = np.stack([turn.real, turn.imag, np.zeros(30)], axis=1)
    return np.vstack([np.zeros((1, 3)), around])


def _scale_bar(axis: Any, low: Floats, high: Floats, unit: str) -> None:
    """Draw a bar of a round length in the lower left corner."""
    span = high - low
    length = round_number(0.2 * float(span[0]))
    x, y = low[0] + 0.03 * span[0], low[1] + 0.05 * span[1]
    axis.plot([x, x + length], [y, y], color="black", lw=3.0, solid_capstyle="butt", zorder=7)
    text = f"{length:g} {unit}" if unit == "km" or length < 1e4 else f"{length / 1000.0:g} km"
    axis.annotate(
        text, (x + length / 2.0, y), (0, 4), textcoords="offset points", ha="center",
        bbox=BEHIND, zorder=7,
    )  # fmt: skip


def _north(axis: Any, scene: JobScene, camera_m: Floats) -> None:
    """Draw the way to true north in the upper right corner; on a grid it is not straight up."""
    turned = 0.0
    if scene.plane is not None:
        turned = -float(scene.plane(camera_m[None])[1][0])  # true less grid azimuth
    way = np.array([np.sin(np.radians(turned)), np.cos(np.radians(turned))]) * 26.0
    axis.annotate(
        "N", (0.96, 0.96), -way, xycoords="axes fraction", textcoords="offset points",
        ha="center", va="center", fontweight="bold", zorder=7,
        arrowprops={"arrowstyle": "-|>", "color": "black", "lw": 1.6},
    )  # fmt: skip
