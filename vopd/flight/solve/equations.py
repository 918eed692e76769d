"""The equations of a flight's picks: images and their derivatives by all that may be unknown.

Unknown are the rotation of each frame, errors of the fixes of its track, and what is common to
the flight: the place of a camera that stands, landmarks, lens, clock, readout, refraction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.flight import Flight, Refraction, TrackFixes
from vopd.flight.solve.lines_of_sight import apparent, vertical_by_position
from vopd.flight.solve.readout import row_parts
from vopd.flight.solve.rotations import LOSSES, Loss
from vopd.geometry.earth import NED_FROM_ENU, Geodetic, axes_at, geodetic
from vopd.geometry.lenses import Lens, Lenses, LensKind, Projection, project
from vopd.geometry.linear import crossing
from vopd.geometry.rotations import rotation_matrices

if TYPE_CHECKING:
    from vopd.flight.solve.clicks import ClickEquations

# Unknowns and their priors

SHIFT = ("east", "north", "up")  # m, of all positions: a standing camera's place, a track's bias
LENS_COEFFICIENTS = {
    LensKind.BROWN: ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    LensKind.FISHEYE: ("k1", "k2", "k3", "k4"),
    LensKind.RADIAL_TABLE: (),
}
COMPONENT = {
    **dict.fromkeys(SHIFT, "position"),
    **{"focal": "focal", "aspect": "focal", "centre_u": "principal_point"},
    **{"centre_v": "principal_point", "clock": "time", "clock_rate": "time"},
    **{"readout": "readout", "refraction": "refraction"},
    **dict.fromkeys(LENS_COEFFICIENTS[LensKind.BROWN], "distortion"),
}
"""The parameters of a flight, with the component of the uncertainty that each belongs to."""


def coefficients_of(lens: Lens) -> list[str]:
    """List the coefficients that a lens has, or any of several."""
    every = LENS_COEFFICIENTS[LensKind.BROWN]
    return [one for one in every if any(one in LENS_COEFFICIENTS[kind] for kind in lens.kinds)]


def parameters_of(lens: Lens) -> list[str]:
    """List the parameters of a lens, or of any of several, that a solve may change."""
    return ["focal", "aspect", "centre_u", "centre_v", *coefficients_of(lens)]


def lacking_text(lens: Lens, name: str) -> str:
    """Say that a lens has no such coefficient."""
    has = f"it has {', '.join(coefficients_of(lens)) or 'no coefficients'}"
    return f"a lens of the model {lens.kind.value} has no {name}: {has}"


LEAST_SIGMA_M = 1e-7  # of one coordinate that is exact among others that are not


@dataclass(frozen=True, eq=False)
class Priors:
    """The unknowns of a flight besides its rotations, with their prior standard deviations.

    Args:
        fixes: of the track; None: the positions are exact
        landmark_m: of every landmark's east, north, up, (N, 3); 0: exact; None: all are
        click_px: of u and of v of every click whose error picks carry, (C,); None: there is none
        parameter: by the names of `COMPONENT`; infinite: nothing is known before
    """

    fixes: TrackFixes | None = None
    landmark_m: Floats | None = None
    parameter: dict[str, float] = field(default_factory=dict)
    click_px: Floats | None = None

    def scaled(self, component: str, factor: float) -> Priors:
        """Multiply the standard deviations of a component."""
        fixes, landmark, click = self.fixes, self.landmark_m, self.click_px
        if component in ("position", "interpolation") and fixes is not None:
            gaps = np.zeros(len(fixes.sigma_m), bool) if fixes.between is None else fixes.between
            chosen = gaps if component == "interpolation" else ~gaps
            own_m = np.where(chosen[:, None], fixes.sigma_m * factor, fixes.sigma_m)
            fixes = replace(fixes, sigma_m=own_m)
        if component == "landmark" and landmark is not None:
            landmark = landmark * factor
        if component == "click" and click is not None:
            click = click * factor
        own = {
            n: s * (factor if COMPONENT[n] == component else 1.0) for n, s in self.parameter.items()
        }
        return Priors(fixes, landmark, own, click)


class State(NamedTuple):
    """A point of the solve."""

    rotation: Floats  # (F, 3, 3) from local axes at the camera to camera axes
    fix_m: Floats  # (J, 3) errors of the fixes: to be added, east, north, up
    parameter: Floats  # (M,)
    landmark_m: Floats  # (N, 3) likewise
    click_px: Floats  # (C, 2) errors of the clicks: to be taken off, u and v

    def moved(
        self, turn: Floats, fix: Floats, common: Floats, free: Ints, clicked: Ints
    ) -> State:  # fmt: skip
        """Add a step to all unknowns.

        Args:
            turn: of each frame, (F, 3)
            fix: (J, 3)
            common: parameters, then coordinates of the free landmarks, then clicks, (K,)
            free: indices of those landmarks
            clicked: indices of those clicks
        """
        landmark_m, click_px, count = (
            self.landmark_m.copy(),
            self.click_px.copy(),
            len(self.parameter),
        )
        last = count + 3 * len(free)
        landmark_m[free] += common[count:last].reshape(-1, 3)
        click_px[clicked] += common[last:].reshape(-1, 2)
        return State(
            rotation_matrices(turn) @ self.rotation,
            self.fix_m + fix,
            self.parameter + common[:count],
            landmark_m,
            click_px,
        )


# The lens, with its derivatives


def with_parameters(lens: Lens, names: tuple[str, ...], values: Floats) -> Lens:
    """Change a lens by parameters: pixels of focal length and centre, and coefficients.

    Of several lenses all are changed, their focal lengths in proportion.

    Args:
        lens: the lens as it is stated
        names: of the parameters, those of other things among them
        values: what is to be added, (M,)
    """
    if isinstance(lens, Lenses):
        each = zip(lens.each, _own_values(lens, names, values), strict=True)
        return Lenses.join(tuple(with_parameters(one, names, own) for one, own in each), lens.which)
    focal, centre, k = lens.focal_px.copy(), lens.centre_px.copy(), lens.k.copy()
    coefficients = LENS_COEFFICIENTS[lens.kind]
    for name, value in zip(names, values.tolist(), strict=True):
        if name == "focal":
            focal *= 1.0 + value / lens.focal_px.mean()
        elif name == "aspect":
            focal[1] *= 1.0 + value
        elif name in ("centre_u", "centre_v"):
            centre[int(name == "centre_v")] += value
        elif name in coefficients:
            k[coefficients.index(name)] += value
    return replace(lens, focal_px=focal, centre_px=centre, k=k)


def _own_values(lens: Lenses, names: tuple[str, ...], values: Floats) -> Floats:
    """Write parameters for each of L lenses, (L, M): the focal length counts by the first one's."""
    ratio = np.array([one.focal_px.mean() for one in lens.each]) / lens.focal_px.mean()
    return np.where(np.array(names, str) == "focal", values * ratio[:, None], values)


DENOMINATOR = ("k4", "k5", "k6")  # of Brown's lens
DENOMINATOR_STEP = 1e-4


@np.errstate(all="ignore")
def by_lens_parameters(
    lens: Lens, names: tuple[str, ...], values: Floats, ray: Floats, seen: Projection
) -> Floats:
    """Differentiate images by parameters of the lens, (..., 2, M).

    Images are linear in focal length, centre and most coefficients, for which differences are
    exact.

    Args:
        lens: the lens as it is stated
        names: of the parameters; those of other things have 0
        values: what has been added, (M,)
        ray: in camera axes, (..., 3)
        seen: its images
    """
    out = np.zeros((*ray.shape[:-1], 2, len(names)))
    if isinstance(lens, Lenses):
        own, unit = (_own_values(lens, names, one) for one in (values, np.ones(len(names))))
        for k, one in enumerate(lens.each):
            rows = lens.which == k
            part = Projection._make(of_all[rows] for of_all in seen)
            out[rows] = by_lens_parameters(one, names, own[k], ray[rows], part) * unit[k]
        return out
    coefficients, table = LENS_COEFFICIENTS[lens.kind], lens.table is not None
    x, y = (ray[..., k] / ray[..., 2] for k in (0, 1))
    for column, name in enumerate(names):
        if name in ("centre_u", "centre_v"):
            out[..., int(name == "centre_v"), column] = 1.0
        elif name in coefficients and not (lens.kind is LensKind.BROWN and name in DENOMINATOR):
            moved = with_parameters(lens, names, values + _unit(column, len(names)))
            at = np.stack(moved.model.distort(moved.coefficients, x, y)[0], axis=-1)
            out[..., column] = (at - seen.distorted) @ moved.pixels_by_distorted.T
        elif name in (*coefficients, "focal", "aspect"):
            found = []
            step = DENOMINATOR_STEP if name in coefficients else 1.0
            for side in (step, -step):
                moved = with_parameters(lens, names, values + side * _unit(column, len(names)))
                at = seen.distorted
                if name in coefficients or table:
                    at = np.stack(moved.model.distort(moved.coefficients, x, y)[0], axis=-1)
                found.append(at @ moved.pixels_by_distorted.T)
            out[..., column] = (found[0] - found[1]) / (2.0 * step)
    return out


def _unit(index: int, count: int) -> Floats:
    return np.asarray(np.arange(count) == index, dtype=np.float64)


# The picks of a flight as equations


class Readout(NamedTuple):
    """The rows of a rolling shutter."""

    seconds: float  # from the first row to the last, as stated
    part: Floats  # (P,) when a pick's row is read, less the frame's time, in readout times
    turning_rad_s: Floats  # (F, 3) rate of the camera about its own axes


class LinearisedPicks(NamedTuple):
    """The equations of B frames with n picks each, in standard deviations of the picks."""

    frames: Ints  # (B,)
    picks: Ints  # (B, n) among those that take part
    residual: Floats  # (B, n, 2) measured minus computed
    by_turn: Floats  # (B, n, 2, 3) of the computed image, by a turn of the camera about its axes
    by_place: Floats  # (B, n, 2, 3) by the camera's east, north, up, m
    by_parameter: Floats  # (B, n, 2, M)
    by_landmark: Floats  # (B, n, 2, 3) by the landmark's east, north, up, m


AT_ONCE = 4_000  # picks whose equations are formed together: their arrays fit a cache


class Model:
    """The picks of a flight that take part, and what is unknown.

    Attributes:
        pick: indices of the picks that take part, frame after frame, (P,)
        landmark: index of each one's landmark, (P,)
        parts: frames (B,) with like numbers of picks, and their picks (B, n) among those
        frames: how many frames the flight has
        solved: how many of them take part
        names: of the parameters
        sigma: their prior standard deviations, (M,)
        free: indices of the landmarks that have a prior and are seen
        clicks: the readings that carry errors of clicks; None: there is none
        clicked: indices of those clicks
        common_sigma: prior standard deviations of the K unknowns in common: the parameters,
            then east, north, up of each free landmark, then u, v of each of those clicks
        component: the component of the uncertainty of each of those, (K,)
        since_s: times of the frames since their middle, by which the clock's rate counts, (F,)
    """

    def __init__(
        self, flight: Flight, priors: Priors, used: Bools, solved: Bools, sigma_px: Floats,
        readout: Readout | None = None, loss: Loss = LOSSES["least-squares"],
    ) -> None:  # fmt: skip
        turning = flight.path.turning_rad_s
        if readout is None and turning is not None:
            # picks are those of the frame's time already: the readout's error alone is left
            readout = Readout(0.0, row_parts(flight), np.nan_to_num(turning))
        self.flight, self.priors, self.readout, self.loss = flight, priors, readout, loss
        picks, self.frames = flight.picks, len(flight.frame)
        known = used & solved[picks.frame]
        self.pick = np.flatnonzero(known)[np.argsort(picks.frame[known], kind="stable")]
        self.landmark = picks.landmark[self.pick]
        self.scale = 1.0 / sigma_px[self.pick]
        self.parts = _parts(np.bincount(picks.frame[self.pick], minlength=self.frames))
        self.solved = sum(len(frames) for frames, _ in self.parts)
        self.names = tuple(priors.parameter)
        self.sigma = np.array([priors.parameter[name] for name in self.names], dtype=np.float64)
        stated = np.zeros((len(flight.landmarks.name), 3))
        if priors.landmark_m is not None:
            stated = priors.landmark_m
        seen = np.bincount(self.landmark, minlength=len(stated)) > 0
        self.free = np.flatnonzero(seen & (stated > 0.0).any(axis=1))
        own = np.maximum(stated[self.free], LEAST_SIGMA_M).ravel()
        self.clicks: ClickEquations | None = None
        self.clicked, by_click = np.zeros(0, np.int64), np.zeros(0)
        if picks.clicks is not None and priors.click_px is not None:
            from vopd.flight.solve.clicks import ClickEquations  # of few flights

            self.clicks = ClickEquations(picks.clicks, self.pick)
            self.clicked = self.clicks.seen
            by_click = np.repeat(priors.click_px[self.clicked], 2)
        self.common_sigma = np.concatenate([self.sigma, own, by_click])
        self.component = [COMPONENT[name] for name in self.names] + ["landmark"] * len(own)
        self.component += ["click"] * len(by_click)
        # where landmarks are in what is common; those that are exact are behind it
        self._column = np.full(len(stated), len(self.common_sigma))
        self._column[self.free] = len(self.names) + 3 * np.arange(len(self.free))
        self.fix_sigma_m = np.zeros((0, 3))
        if priors.fixes is not None:
            self.fix_sigma_m = np.maximum(priors.fixes.sigma_m, LEAST_SIGMA_M)
        path = flight.path
        self.axes = axes_at(geodetic(path.position_m))
        # where frames may be late, errors of fixes are errors of the velocity as well
        clock = {"clock", "clock-rate"} & set(flight.options.free)
        slopes = None if priors.fixes is None else priors.fixes.slopes
        self._slopes = slopes is not None and (bool(clock) or bool(slopes.late_s.any()))
        speed, change = path.velocity_m_s, path.acceleration_m_s2
        if slopes is not None and self._slopes:
            change = slopes.acceleration_m_s2
            speed = slopes.velocity_m_s + change * slopes.late_s[:, None]
        self.velocity_m_s, self.acceleration_m_s2 = self._enu(speed), self._enu(change)
        self.since_s = flight.since_middle_s

    def with_priors(self, priors: Priors) -> Model:
        """Take the same picks with other unknowns."""
        every = np.ones(self.frames, bool)
        picks = self.flight.picks.sigma_px
        return Model(self.flight, priors, self.used, every, picks, self.readout, self.loss)

    @property
    def used(self) -> Bools:
        """Mark the picks of the flight that take part, (P,)."""
        used = np.zeros(len(self.flight.picks.frame), bool)
        used[self.pick] = True
        return used

    def _enu(self, ned: Floats | None) -> Floats:
        """Convert vectors to east, north, up (F, 3); 0 where they are not known."""
        return np.zeros((self.frames, 3)) if ned is None else np.nan_to_num(ned @ NED_FROM_ENU)

    def start(self, rotation: Floats) -> State:
        """Begin at the stated places.

        Args:
            rotation: of each frame, (F, 3, 3)
        """
        landmark_m = np.zeros((len(self.flight.landmarks.name), 3))
        clicks = self.flight.picks.clicks
        click_px = np.zeros((0 if clicks is None else len(clicks.frame), 2))
        return State(
            rotation, np.zeros_like(self.fix_sigma_m), np.zeros(len(self.names)), landmark_m,
            click_px,
        )  # fmt: skip

    @property
    def of_landmarks(self) -> slice:
        """Where coordinates of the free landmarks are among what is common."""
        return slice(len(self.names), len(self.names) + 3 * len(self.free))

    @property
    def of_clicks(self) -> slice:
        """Where the errors of clicks are among what is common."""
        return slice(self.of_landmarks.stop, len(self.common_sigma))

    def common_of(self, state: State) -> Floats:
        """Concatenate what is common to the frames, (K,)."""
        marks, clicks = state.landmark_m[self.free], state.click_px[self.clicked]
        return np.concatenate([state.parameter, marks.ravel(), clicks.ravel()])

    def value(self, state: State, name: str) -> float:
        """Look up a parameter; 0 for one that is not free."""
        return float(state.parameter[self.names.index(name)]) if name in self.names else 0.0

    def late_s(self, state: State) -> Floats:
        """Add up the errors of the frames' times (F,)."""
        rate = self.value(state, "clock_rate")
        return np.asarray(self.value(state, "clock") + rate * self.since_s)

    def late_by(self, names: Sequence[str]) -> Floats:
        """Differentiate the errors of the frames' times by parameters, (F, len(names))."""
        out = np.zeros((self.frames, len(names)))
        for column, name in enumerate(names):
            if name in ("clock", "clock_rate"):
                out[:, column] = self.since_s if name == "clock_rate" else 1.0
        return out

    def fixes_at(self, state: State) -> TrackFixes | None:
        """Look up the parts that frames have in the errors of fixes, by how late they are."""
        fixes = self.priors.fixes
        return fixes.later(self.late_s(state)) if fixes is not None and self._slopes else fixes

    def speed_m_s(self, state: State) -> Floats:
        """Differentiate the places of cameras by their frames' times, east, north, up (F, 3)."""
        late_s = self.late_s(state)
        speed = self.velocity_m_s + self.acceleration_m_s2 * late_s[:, None]
        if self.priors.fixes is not None and self._slopes:
            parts = self.priors.fixes.speeds(late_s)
            speed = speed + parts.at_frames(state.fix_m[..., None])[..., 0]
        return speed

    def moved_m(self, state: State) -> Floats:
        """Add up how far each camera is from its stated place, its east, north, up (F, 3)."""
        moved = np.tile([self.value(state, name) for name in SHIFT], (self.frames, 1))
        fixes = self.fixes_at(state)
        if fixes is not None:
            moved += fixes.at_frames(state.fix_m[..., None])[..., 0]
        late = self.late_s(state)[:, None]
        if late.any():
            moved += self.velocity_m_s * late + 0.5 * self.acceleration_m_s2 * late**2
        return moved

    def place_by_common(self, frames: Ints) -> Floats:
        """Differentiate places of cameras by what is common, (B, 3, K).

        Args:
            frames: indices, (B,)
        """
        out = np.zeros((len(frames), 3, len(self.common_sigma)))
        for column, name in enumerate(self.names):
            if name in SHIFT:
                out[:, SHIFT.index(name), column] = 1.0
            elif name in ("clock", "clock_rate"):
                since = self.since_s[frames, None] if name == "clock_rate" else 1.0
                out[:, :, column] = self.velocity_m_s[frames] * since
        return out

    def camera_by_m(self, state: State) -> Floats:
        """Move the cameras from their stated places, lever arm included, Earth-centred (F, 3)."""
        moved, path = self.moved_m(state), self.flight.path
        if path.lever_arm_m is not None:
            arm = self.flight.mount.T @ path.lever_arm_m
            moved = moved + np.einsum("fji,j->fi", state.rotation, arm)
        return np.asarray(np.einsum("fji,fj->fi", self.axes, moved))

    def landmark_by_m(self, state: State) -> Floats:
        """Move the landmarks from their stated positions, Earth-centred (N, 3)."""
        axes = self.flight.landmarks.axes
        return np.asarray(np.einsum("nji,nj->ni", axes, state.landmark_m))

    def prior_cost(self, state: State) -> float:
        """Add up the squares of all errors over their prior standard deviations."""
        own = (self.common_of(state) / self.common_sigma) ** 2
        return float(own.sum() + ((state.fix_m / self.fix_sigma_m) ** 2).sum())

    def prior_cost_of_frames(self, state: State) -> Floats:
        """Share the squares of the fixes' errors among their frames (F,).

        By the sizes of the frames' parts in them: those in the shape of a path are below 0.
        """
        fixes = self.priors.fixes
        if fixes is None:
            return np.zeros(self.frames)
        fixes = replace(fixes, weight=np.abs(fixes.weight))
        squares = ((state.fix_m / self.fix_sigma_m) ** 2).sum(axis=1)
        parts = np.zeros(len(squares) + fixes.weight.shape[1])
        for slot, weight in enumerate(fixes.weight.T):
            np.add.at(parts, fixes.first + slot, weight)
        each = squares / np.where(parts > 0.0, parts, 1.0)[: len(squares)]
        return np.asarray(fixes.at_frames(each[:, None, None])[:, 0, 0])

    @np.errstate(all="ignore")
    def rows(self, state: State) -> Iterator[LinearisedPicks]:
        """Linearise the equations of all picks, some frames at a time."""
        flight = self.flight
        camera_by = self.camera_by_m(state)
        landmark_by = self.landmark_by_m(state)
        height_m, seen = np.full(len(landmark_by), np.nan), np.unique(self.landmark)
        place_m = flight.landmarks.position_m[seen] + landmark_by[seen]
        every = geodetic(np.concatenate([flight.path.position_m + camera_by, place_m]))
        height_m[seen] = every.height_m[self.frames :]
        lens = with_parameters(flight.lens, self.names, state.parameter)
        shift_px = None if self.clicks is None else self.clicks.shift_px(state.click_px)
        for frames, picks in self.parts:
            landmark = self.landmark[picks]
            # moves are added to the stated lines: beside the Earth's radius 1e-9 m would be lost
            away_m = flight.landmarks.position_m[landmark] - flight.path.position_m[frames, None]
            away_m += landmark_by[landmark] - camera_by[frames, None]
            camera = Geodetic(*(one[frames] for one in every))
            yield self._linearised(
                state, lens.of(frames), frames, picks, away_m, camera, height_m[landmark],
                shift_px,
            )  # fmt: skip

    def further(self, rows: LinearisedPicks) -> tuple[Floats, Ints]:
        """Concatenate the rows by all unknowns but the turns (B, 2n, q), with their index.

        They are the camera's place by the fixes, if it is not exact, the parameters, the
        landmarks of the frame, if any is free, and the clicks that its picks carry; the index is
        of those in common.
        """
        count, n = rows.picks.shape
        first, known = 0 if self.priors.fixes is None else 3, len(self.names)
        marks = 3 * n if len(self.free) else 0
        slots, clicks = 0, self.clicks
        if clicks is not None:
            column = clicks.column[rows.picks]
            slots = int((column < len(self.clicked)).any(axis=(0, 1)).sum())
        before = first + known + marks
        out = np.zeros((count, n, 2, before + 2 * n * slots))
        out[..., :first] = rows.by_place[..., :first]
        out[..., first : first + known] = rows.by_parameter
        index = np.tile(np.arange(known), (count, 1))
        if marks:
            for k in range(n):
                at = first + known + 3 * k
                out[:, k, :, at : at + 3] = rows.by_landmark[:, k]
            column = self._column[self.landmark[rows.picks]]
            index = np.hstack([index, (column[..., None] + np.arange(3)).reshape(count, 3 * n)])
        if clicks is not None:
            by_click = clicks.by_click[rows.picks] * self.scale[rows.picks, None, None, None]
            for k in range(n):
                for slot in range(slots):
                    at = before + 2 * (k * slots + slot)
                    out[:, k, :, at : at + 2] = by_click[:, k, slot]
            carried = self.of_clicks.start + 2 * clicks.column[rows.picks][:, :, :slots]
            index = np.hstack(
                [index, (carried[..., None] + np.arange(2)).reshape(count, 2 * n * slots)]
            )
        return out.reshape(count, 2 * n, -1), index

    def _linearised(
        self, state: State, lens: Lens, frames: Ints, picks: Ints, away_m: Floats,
        camera: Geodetic, height_m: Floats, shift_px: Floats | None,
    ) -> LinearisedPicks:  # fmt: skip
        """Linearise the equations of frames whose lines of sight are known."""
        flight, axes = self.flight, axes_at(camera)
        late_s, row_turn = self._rows_late(state, frames, picks)
        if row_turn is not None:
            further = self.velocity_m_s[frames, None] * late_s[..., None]
            away_m = away_m - further @ self.axes[frames]
        k = flight.refraction.k + self.value(state, "refraction")
        refraction = Refraction(k, flight.refraction.decays)
        line = apparent(
            away_m @ axes.swapaxes(1, 2), camera.height_m[:, None], height_m, refraction
        )
        turning = state.rotation[frames]
        ray = direction = line.direction @ turning.swapaxes(1, 2)
        if row_turn is not None:
            ray = (row_turn @ direction[..., None])[..., 0]
        seen = project(lens, ray)
        by_turn = seen.by_turns if row_turn is None else seen.by_turns @ row_turn
        by_direction = _of_frames(by_turn @ crossing(direction), turning)
        by_away = by_direction @ line.by_away
        by_place = -by_away - _of_frames(by_turn, turning @ vertical_by_position(camera))
        by_place[..., 2] += (by_direction @ line.by_height[..., None])[..., 0]
        by_place = _of_frames(by_place, axes @ self.axes[frames].swapaxes(1, 2))
        if flight.path.lever_arm_m is not None:
            arm = crossing(flight.mount.T @ flight.path.lever_arm_m)
            by_turn = by_turn + _of_frames(by_place, turning.swapaxes(1, 2) @ arm)
        by_landmark = by_away
        if len(self.free):
            own_axes = flight.landmarks.axes[self.landmark[picks]].swapaxes(2, 3)
            by_landmark = _of_frames(by_away, axes) @ own_axes
        by_parameter = by_lens_parameters(
            flight.lens.of(frames), self.names, state.parameter, ray, seen
        )
        by_refraction = by_direction @ line.by_refraction[..., None]
        self._by_others(by_parameter, state, frames, picks, by_place, by_refraction, seen.by_turns)
        scale = self.scale[picks][..., None]
        measured = flight.picks.pixel[self.pick[picks]]
        if shift_px is not None:
            measured = measured - shift_px[picks]
        residual = (measured - seen.pixel) * scale
        each = (one * scale[..., None] for one in (by_turn, by_place, by_parameter, by_landmark))
        return LinearisedPicks(frames, picks, residual, *each)

    def _rows_late(self, state: State, frames: Ints, picks: Ints) -> tuple[Floats, Floats | None]:
        """When the rows of picks are read (B, n), and how far the camera has turned then."""
        if self.readout is None:
            return np.zeros(picks.shape), None
        late_s = self.readout.part[self.pick[picks]]
        late_s = late_s * (self.readout.seconds + self.value(state, "readout"))
        turned = self.readout.turning_rad_s[frames, None] * late_s[..., None]
        return late_s, rotation_matrices(turned.reshape(-1, 3)).reshape(*picks.shape, 3, 3)

    def _by_others(
        self, out: Floats, state: State, frames: Ints, picks: Ints, by_place: Floats,
        by_refraction: Floats, by_turns: Floats,
    ) -> None:  # fmt: skip
        """Differentiate images by the parameters that are not the lens's, (B, n, 2, M)."""
        speed = self.speed_m_s(state)[frames]
        for column, name in enumerate(self.names):
            if name in SHIFT:
                out[..., column] = by_place[..., SHIFT.index(name)]
            elif name in ("clock", "clock_rate"):
                own = speed * (self.since_s[frames, None] if name == "clock_rate" else 1.0)
                out[..., column] = (by_place @ own[:, None, :, None])[..., 0]
            elif name == "refraction":
                out[..., column] = by_refraction[..., 0]
            elif name == "readout" and self.readout is not None:
                turned = by_turns @ self.readout.turning_rad_s[frames, None, :, None]
                moved = by_place @ self.velocity_m_s[frames, None, :, None]
                part = self.readout.part[self.pick[picks]][..., None]
                out[..., column] = (turned + moved)[..., 0] * part


def _of_frames(rows: Floats, matrix: Floats) -> Floats:
    """Multiply rows of picks (B, n, 2, 3) by the matrices of their frames (B, 3, 3)."""
    return np.asarray((rows.reshape(len(rows), -1, 3) @ matrix).reshape(rows.shape))


def _parts(count: Ints) -> list[tuple[Ints, Ints]]:
    """Cut frames with like numbers of picks into parts: frames (B,) and their picks (B, n)."""
    first = np.cumsum(count) - count
    parts = []
    for n in np.unique(count[count > 0]):
        frames, step = np.flatnonzero(count == n), max(AT_ONCE // n, 1)
        for k in range(0, len(frames), step):
            some = frames[k : k + step]
            parts.append((some, first[some][:, None] + np.arange(n)))
    return parts
