"""The frames of a report as compact numbers: table, curves, images, map, for its script."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.flags import meanings
from vopd.attitude.history import History, is_turned
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.table import TableColumn, column_name, columns_of, table_values
from vopd.estimate import Units
from vopd.export.tables import as_text
from vopd.figures.attitude import TOLD_BY, shows_attack
from vopd.figures.image import camera_index, film_ends, film_frames, horizon_dip_deg, toward
from vopd.figures.map import MISSED, ground, rise_m
from vopd.files import readable
from vopd.findings import count_text
from vopd.geometry.earth import geodetic, local_axes
from vopd.scene import FilmView, JobScene, Views

SHOWN = (
    *("job", "frame", "status", "time_s", "flags"),
    *("camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("half_width_95_vehicle_yaw_deg", "half_width_95_vehicle_pitch_deg"),
    *("half_width_95_vehicle_roll_deg", "alpha_deg", "beta_deg", "eta_deg"),
    *("half_width_95_alpha_deg", "half_width_95_beta_deg", "eta_low_95_deg", "eta_high_95_deg"),
    *("airspeed_{length}_s", "landmarks", "residual_rms_{image}", "misfit_chance"),
    *("condition", "last_correction_rad"),
)
"""The columns of the table of frames, of those of the attitude table.

The source stands before them where there are several, `image` after `frame` where
frames have names.
"""

OF_CURVES = tuple(f"half_width_95_camera_{angle}_deg" for angle in ("yaw", "pitch", "roll"))
"""Columns for the curves alone, where a camera is turned against its vehicle."""

WORDS = ("status", "flags", "image")
MOST_PICKS = 150_000  # of a page: beyond them its frames have no images
MOST_OTHERS = 30_000  # computed places of landmarks that are not picked, of a page
MOST_FOOTPRINTS = 1000  # frames of a page: beyond them the map has none
FAR_M = 10_000.0  # of a job's places: beyond it they are written in whole metres, else in cm


class Token(str):
    """JSON that is text already."""

    __slots__ = ()


def frames_json(histories: Sequence[History]) -> str:
    """Write the frames of some jobs as JSON, safe inside a script of a page.

    Args:
        histories: one or more jobs, of one kind of source
    """
    raised = {
        name: any(bool(h.flags.raised[name].any()) for h in histories)
        for name in histories[0].flags.raised
    }
    told = meanings(histories[0].about.words)
    content = {
        "columns": frame_columns(histories),
        "flags": {name: told[name][0] for name, any_frame in raised.items() if any_frame},
        "told_by": TOLD_BY,
        "jobs": _jobs(histories),
    }
    text = _encoded(content)
    for one in "<>&":
        text = text.replace(one, f"\\u{ord(one):04x}")
    return text


def _encoded(value: Any) -> str:
    if isinstance(value, Token):
        return value
    if isinstance(value, dict):
        inside = (f"{json.dumps(name)}: {_encoded(one)}" for name, one in value.items())
        return "{" + ",\n".join(inside) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(_encoded, value)) + "]"
    value = readable(value) if isinstance(value, str) else value
    return json.dumps(value, ensure_ascii=False)


def _numbers(values: Floats | Ints, decimals: int = 0) -> Token:
    """Write numbers as a list; null where they are not finite."""
    form = f"%.{decimals}f"
    flat = np.asarray(values).ravel()
    if flat.dtype.kind != "f":
        return Token("[" + ",".join(map(str, flat.tolist())) + "]")
    texts = ("null" if one != one else form % one for one in flat.tolist())
    return Token("[" + ",".join(texts) + "]")


# The table: every cell has the text of the CSV file


def shown_columns(histories: Sequence[History]) -> list[TableColumn]:
    """List the columns of the table of frames.

    Args:
        histories: one or more jobs, of one kind of source
    """
    every = {one.name: one for one in columns_of(histories)}
    estimate = histories[0].estimate
    names = [column_name(one, estimate) for one in SHOWN]
    if "image" in every:
        names.insert(names.index("frame") + 1, "image")
    if len({h.about.source for h in histories}) > 1:
        names.insert(0, estimate.about.words.source)
    return [every[name] for name in names]


def frame_columns(histories: Sequence[History]) -> list[dict[str, Any]]:
    """Tabulate the frames by columns, with those that the curves need besides.

    A column has `name`, `meaning` and `values`; `decimals` of numbers with a point, "e" if
    they have an exponent; `words`, of which `values` are indices; `same`, the name of an
    earlier column in place of equal values; `hidden`, if it is for the curves alone.

    Args:
        histories: one or more jobs, of one kind of source
    """
    shown = shown_columns(histories)
    source = histories[0].about.words.source
    more = []
    if any(map(is_turned, histories)):
        more = [one for one in columns_of(histories) if one.name in OF_CURVES]
    values = table_values([*shown, *more], histories)
    made: list[dict[str, Any]] = []
    known: dict[Token, str] = {}
    for column, texts in zip(
        [*shown, *more], as_text(values, [*shown, *more]).values(), strict=True
    ):
        about: dict[str, Any] = {"name": column.name, "meaning": column.meaning}
        if column in more:
            about["hidden"] = True
        if column.name in (*WORDS, source):
            words = list(dict.fromkeys(texts))
            index = {word: k for k, word in enumerate(words)}
            about |= {"words": words, "values": _numbers(np.array([index[one] for one in texts]))}
        else:
            if values[column.name].dtype.kind == "f":
                about["decimals"] = "e" if column.decimals is None else column.decimals
            cells = (one if _is_number(one) else _encoded(one) for one in texts)
            tokens = Token("[" + ",".join(one if one != '""' else "null" for one in cells) + "]")
            if tokens in known and "e" not in str(about.get("decimals")):
                about["same"] = known[tokens]
            else:
                about["values"] = tokens
                known[tokens] = column.name
        made.append(about)
    return made


def _is_number(text: str) -> bool:
    """Tell whether a cell is a number in JSON too, which knows no infinity."""
    return text not in ("", "inf", "-inf")


# Scenes: what was picked and computed in each image, and where everything is


def _jobs(histories: Sequence[History]) -> list[dict[str, Any]]:
    made, first = [], 0
    picks = sum(int(h.landmarks.sum()) for h in histories)
    frames = sum(len(h.status) for h in histories)
    for h in histories:
        e, words = h.estimate, h.about.words
        job: dict[str, Any] = {
            "label": h.about.label,
            "first": first,
            "count": len(h.status),
            "axis": h.order_axis[1],
            "turned": is_turned(h),
            "attack": shows_attack([h]),
            "unit": e.units.image,
            "residual": e.units.residual,
            "per": e.units.residuals_per_image,
            "surface": words.surface,
        }
        first += len(h.status)
        if picks <= MOST_PICKS:
            job |= _scene(h, frames <= MOST_FOOTPRINTS)
        made.append(job)
    others = sum(one["others"]["landmark"].count(",") for one in made if "others" in one)
    for one in made:
        if others > MOST_OTHERS:
            one.pop("others", None)
    return made


def undrawn(histories: Sequence[History]) -> str:
    """Say which frames the page does not draw; empty if it draws all.

    Args:
        histories: the jobs of the page
    """
    picks = sum(int(h.landmarks.sum()) for h in histories)
    if picks <= MOST_PICKS:
        return ""
    return (
        f"The images of the frames and the map are left out: {count_text(picks, 'pick')} are "
        f"more than {MOST_PICKS}. vopd plot --figure image --frame N draws one."
    )


def residual_names(units: Units) -> list[str]:
    """Name the columns of a frame's residuals: of pixels u and v, of a film x and y."""
    names = residual_directions(units)
    return [*(f"residual {one}, {units.residual}" for one in names), f"length, {units.residual}"]


def residual_directions(units: Units) -> tuple[str, str]:
    """Name the two directions of residuals."""
    return ("u right", "v down") if units.image == "px" else ("x left", "y up")


def _scene(h: History, footprints: bool) -> dict[str, Any]:
    """Describe the picks of a job's frames, its landmarks and the camera's places."""
    e = h.estimate
    scene = e.scene() if e.scene else None
    names = list(scene.names) if scene else []
    rows = frame_landmarks(h)
    index = {name: k for k, name in enumerate(names)}
    label = {number: e.landmark_label(number) for number in np.unique(rows.landmark).tolist()}
    for one in label.values():
        if one not in index:
            index[one] = len(names)
            names.append(one)
    own = np.array([index[label[n]] for n in rows.landmark.tolist()], dtype=np.int64)
    if scene is None:
        return {"names": names, "picks": _film_picks(h, rows.frame, own)}
    frames = np.array([camera_index(h, k, scene) for k in range(len(h.status))])
    made: dict[str, Any] = {"names": names}
    camera_m = scene.camera_m[frames]
    away_m = float(np.nanmax(_distances(scene, camera_m), initial=1.0))
    known = np.flatnonzero(np.isfinite(camera_m[:, 0]))
    if not len(known):
        return made | {"picks": _film_picks(h, rows.frame, own)}
    plan = _Plan(scene, camera_m[known].mean(axis=0), away_m)
    made |= {
        "crs": scene.crs,
        "convergence": round(plan.convergence_deg, 3),
        "origin": _numbers(plan.origin, 2),
        "places": plan.places(scene.landmark_m),
        "camera": plan.places(camera_m),
        "up": plan.is_below(scene.landmark_m),
    }
    if scene.views is None:
        made["picks"] = _film_picks(h, rows.frame, own)
        if footprints:
            made |= _film_frames(h, scene, camera_m)
            seen = _film_sights(h, scene, rows.frame, own)
            made |= plan.missed(*seen, camera_m, rows.odd[_film_shown(h)])
        return made
    views = scene.views(frames)
    if footprints:
        dip_deg = horizon_dip_deg(camera_m, scene.landmark_m)
        edge = views.size_px[:, None].astype(np.float64)
        ends = np.array([[0.0, 1.0], [1.0, 0.0]]) * edge - 0.5
        made |= _horizons(views, views.border, views.middle, ends, dip_deg)
    odd = np.zeros((len(frames), len(names)), bool)
    odd[rows.frame[rows.odd], own[rows.odd]] = True
    culprit = odd[views.frame, views.landmark]
    culprit |= ~views.used & ~scene.check[views.landmark]
    residual = (views.pixel - views.fitted) * e.units.residuals_per_image
    made["sizes"] = [list(map(int, one)) for one in np.unique(views.size_px, axis=0)]
    if len(made["sizes"]) > 1:
        which = np.unique(views.size_px, axis=0, return_inverse=True)[1]
        made["size"] = _numbers(which.ravel())
    made["picks"] = {
        "count": _numbers(np.bincount(views.frame, minlength=len(frames))),
        "landmark": _numbers(views.landmark),
        "u": _numbers(views.pixel[:, 0], 2),
        "v": _numbers(views.pixel[:, 1], 2),
        "du": _numbers(residual[:, 0], 3),
        "dv": _numbers(residual[:, 1], 3),
        "state": _numbers(np.where(culprit, 2, np.where(views.used, 0, 1))),
    }
    made |= plan.missed(views.frame, views.landmark, views.ray, camera_m, culprit)
    low, high = -0.5, views.size_px[:, None] - 0.5
    with np.errstate(invalid="ignore"):
        inside: Bools = np.all((views.computed >= low) & (views.computed <= high), axis=2)
    inside[views.frame, views.landmark] = False
    at, mark = np.nonzero(inside)
    made["others"] = {
        "count": _numbers(np.bincount(at, minlength=len(frames))),
        "landmark": _numbers(mark),
        "u": _numbers(views.computed[at, mark, 0]),
        "v": _numbers(views.computed[at, mark, 1]),
    }
    if footprints:
        made["footprint"] = plan.footprints(views.border, camera_m, away_m)
    return made


def _distances(scene: JobScene, camera_m: Floats) -> Floats:
    """Measure how far landmarks are from nine places of the camera, (9, N), metres."""
    known = camera_m[np.isfinite(camera_m[:, 0])]
    some = known[np.unique(np.linspace(0, len(known) - 1, 9).astype(int))] if len(known) else known
    return np.asarray(np.linalg.norm(scene.landmark_m - some[:, None], axis=2))


HALF_STEPS_DEG = (0.5, 1.0, 2.5, 5.0, 7.5, 15.0, 22.5)  # half of those between azimuths
MOST_AZIMUTHS = 9  # named along a horizon


def _horizons(
    view: Views | FilmView,
    border: Floats,
    middle: Floats,
    ends: Floats,
    dip_deg: Floats,
    decimals: int = 0,
) -> dict[str, Any]:
    """Describe the horizon of each image, or if it is not in the picture the way north.

    Every second of its points has an azimuth of whole degrees, the first the first that is given.

    Args:
        view: of n images
        border: directions east, north, up, around each image, (n, B, 3)
        middle: of its middle, (n, 3)
        ends: lower left and upper right corner of the picture, (n, 2, 2)
        dip_deg: how far below level the horizon is, (n,)
        decimals: of places in the image
    """
    level = np.hypot(*middle.T[:2])
    cosine = np.einsum("nbj,nj->nb", border, middle)
    with np.errstate(invalid="ignore", divide="ignore"):
        radius = np.arccos(np.clip(np.fmin.reduce(cosine, axis=1), -1.0, 1.0))
        ratio = np.where(radius < np.pi / 2.0, np.sin(radius) / level, 2.0)
        span = np.where(ratio < 1.0, np.degrees(np.arcsin(np.clip(ratio, 0.0, 1.0))), 180.0)
    azimuth = np.degrees(np.arctan2(middle[:, 0], middle[:, 1]))
    known = np.isfinite(azimuth) & np.isfinite(span)
    steps = np.array(HALF_STEPS_DEG)
    own = np.searchsorted(steps * MOST_AZIMUTHS, np.where(known, span, 0.0))
    half_deg = steps[np.minimum(own, len(steps) - 1)]
    first = 2.0 * half_deg * np.floor((azimuth - span) / (2.0 * half_deg))
    at = first[:, None] + half_deg[:, None] * np.arange(4 * MOST_AZIMUTHS + 3)
    pixel = view.pixel_of(toward(at, -dip_deg[:, None]))
    low, high = np.sort(ends, axis=1).swapaxes(0, 1)[..., None, :]
    with np.errstate(invalid="ignore"):
        inside = np.all((pixel >= low) & (pixel <= high), axis=2)
    inside &= (at < first[:, None] + 360.0) & known[:, None]
    shown = inside.copy()  # with the next beyond each edge
    shown[:, 1:] |= inside[:, :-1]
    shown[:, :-1] |= inside[:, 1:]
    shown &= np.isfinite(pixel).all(axis=2) & (inside.sum(axis=1) > 1)[:, None]
    start, end = shown.argmax(axis=1), shown.shape[1] - shown[:, ::-1].argmax(axis=1)
    start -= start % 2  # at a whole degree
    there = shown.any(axis=1)
    pixel = np.where((np.abs(pixel) < FAR_PX).all(axis=2, keepdims=True), pixel, np.nan)
    points = [pixel[k, start[k] : end[k]] if there[k] else pixel[k, :0] for k in range(len(pixel))]
    moved = middle + 0.02 * np.array([0.0, 1.0, 0.0])
    way = view.pixel_of(np.stack([middle, moved], axis=1))
    north = (way[:, 1] - way[:, 0]) * np.sign(ends[:, 1] - ends[:, 0]) * [1.0, -1.0]
    with np.errstate(invalid="ignore", divide="ignore"):
        north = np.where(there[:, None], np.nan, north / np.hypot(*north.T)[:, None])
    along = np.concatenate(points)
    return {
        "horizon": {
            "count": _numbers(np.array([len(one) for one in points])),
            "first": _numbers((first + half_deg * start) % 360.0),
            "step": _numbers(2.0 * half_deg),
            "u": _numbers(along[:, 0], decimals),
            "v": _numbers(along[:, 1], decimals),
        },
        "north": {"u": _numbers(north[:, 0], 2), "v": _numbers(north[:, 1], 2)},
    }


FAR_PX = 1e5  # of a point beside the image; beyond it there is none
BORDER = 8  # points along each side of a film


def _film_picks(h: History, frame: Ints, own: Ints) -> dict[str, Any]:
    """Describe the picks of a film: in its plane, corrected for distortion, x to the left."""
    rows, units, here = frame_landmarks(h), h.estimate.units, _film_shown(h)
    residual = rows.residual[here] * units.residuals_per_image
    state = np.where(rows.odd, 2, np.where(rows.used, 0, 1))[here]
    return {
        "count": _numbers(np.bincount(frame[here], minlength=len(h.status))),
        "landmark": _numbers(own[here]),
        "u": _numbers(rows.image[here, 0], 4),
        "v": _numbers(rows.image[here, 1], 4),
        "du": _numbers(residual[:, 0], 2),
        "dv": _numbers(residual[:, 1], 2),
        "state": _numbers(state),
    }


def _film_shown(h: History) -> Bools:
    """Mark the landmarks of frames that a film has as picks."""
    rows = frame_landmarks(h)
    return np.asarray(np.isfinite(rows.image).all(axis=1) & (rows.used | rows.ignored))


def _film_sights(h: History, scene: JobScene, frame: Ints, own: Ints) -> tuple[Ints, Ints, Floats]:
    """List frame, landmark and line of sight of each pick of a film; NaN: it has none."""
    e, here = h.estimate, _film_shown(h)
    frame, own = frame[here], own[here]
    ray = np.full((len(frame), 3), np.nan)
    for k in np.unique(frame).tolist():
        marks, rays = scene.sight(*e.frame_key(k))
        of_mark = dict(zip(marks.tolist(), rays, strict=True))
        for n in np.flatnonzero(frame == k).tolist():
            ray[n] = of_mark.get(int(own[n]), ray[n])
    return frame, own, ray


def _film_frames(h: History, scene: JobScene, camera_m: Floats) -> dict[str, Any]:
    """Describe the frames of a film by their corners, and the landmarks in them without a pick."""
    frames = np.arange(len(h.status))
    corners, shown, computed, axes = film_frames(h, scene, frames)
    known = np.isfinite(corners).all(axis=(1, 2))
    view = FilmView(axes, h.estimate.focal_length)
    ends = film_ends(corners)
    along = np.linspace(corners, np.roll(corners, 1, axis=1), BORDER, endpoint=False, axis=2)
    border = view.direction_of(along.reshape(len(frames), -1, 2))
    dip_deg = horizon_dip_deg(camera_m, scene.landmark_m)
    at, mark = np.nonzero(shown)
    return _horizons(view, border, axes[:, 2], ends, dip_deg, 3) | {
        "corners": {
            "count": _numbers(np.where(known, 4, 0)),
            "u": _numbers(corners[known][..., 0], 2),
            "v": _numbers(corners[known][..., 1], 2),
        },
        "others": {
            "count": _numbers(np.bincount(at, minlength=len(corners))),
            "landmark": _numbers(mark),
            "u": _numbers(computed[at, mark, 0], 2),
            "v": _numbers(computed[at, mark, 1], 2),
        },
    }


class _Plan:
    """Places east and north of a job's middle, or on a grid, and heights, metres."""

    def __init__(self, scene: JobScene, middle_m: Floats, away_m: float) -> None:
        self._scene, self._middle_m = scene, middle_m
        self._axes = local_axes(middle_m[None])[0]
        self._decimals = 2 if away_m < FAR_M else 0
        self.origin, self.convergence_deg = np.zeros(2), 0.0
        if scene.plane is not None:
            place, convergence = scene.plane(middle_m[None])
            self.origin, self.convergence_deg = np.round(place[0]), float(convergence[0])

    def places(self, position_m: Floats, with_height: bool = True) -> dict[str, Token]:
        """Write Earth-centred positions (n, 3)."""
        if self._scene.plane is not None:
            level = self._scene.plane(position_m)[0] - self.origin
        else:
            level = (position_m - self._middle_m) @ self._axes[:2].T
        made = {"east_m": _numbers(level[:, 0], self._decimals)}
        made["north_m"] = _numbers(level[:, 1], self._decimals)
        if with_height:
            made["height_m"] = _numbers(geodetic(position_m).height_m, self._decimals)
        return made

    def is_below(self, landmark_m: Floats) -> bool:
        """Tell whether the job's middle is below the landmarks on the whole."""
        return rise_m(landmark_m, self._middle_m, self._axes) > 0.0

    def missed(
        self, frame: Ints, landmark: Ints, ray: Floats, camera_m: Floats, culprit: Bools
    ) -> dict[str, Any]:
        """Write where lines of sight end that miss their landmarks, as far away as these.

        Args:
            frame: index of the frame of each of P lines
            landmark: index of its landmark
            ray: Earth-centred unit vector along it, (P, 3); NaN: there is none
            camera_m: Earth-centred places, (F, 3)
            culprit: which lines do not fit, (P,)
        """
        mark_m, from_m = self._scene.landmark_m[landmark], camera_m[frame]
        away = ((mark_m - from_m) * ray).sum(axis=1)
        with np.errstate(invalid="ignore"):
            away = np.where(away > 0.0, away, np.linalg.norm(mark_m - from_m, axis=1))
            end_m = from_m + away[:, None] * ray
            far = culprit | (np.linalg.norm(mark_m - end_m, axis=1) > MISSED * away)
        here = np.flatnonzero(far & np.isfinite(end_m).all(axis=1))
        if not len(here):
            return {}
        return {"missed": {"pick": _numbers(here), **self.places(end_m[here])}}

    def footprints(self, border: Floats, camera_m: Floats, away_m: float) -> dict[str, Token]:
        """Write where the borders of the images meet the mean height of the landmarks."""
        corners, count = [np.zeros((0, 3))], []
        for own_m, axes, around in zip(camera_m, local_axes(camera_m), border, strict=True):
            found, _ = ground(around, self._scene.landmark_m, own_m, axes, away_m)
            count.append(0 if found is None else len(found))
            corners += [] if found is None else [found]
        places = self.places(np.concatenate(corners), with_height=False)
        return {"count": _numbers(np.array(count)), **places}
