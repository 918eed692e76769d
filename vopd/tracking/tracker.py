"""The run through a video: forward and backward from the clicks, and again against all of them.

The attitude of a frame runs along: the whole frame is aligned with the one before, patches of
clicks are found near where that has them, and those that agree with one turn of the camera correct
it. It serves to predict; the attitudes of the result are those of `vopd attitude`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.formats.tracked import STATUSES
from vopd.flight.solve.rotations import solve_rotations
from vopd.tracking.alignment import Alignment, Level, reduced
from vopd.tracking.journal import ATTITUDE, ROW
from vopd.tracking.patches import (
    LEAST_CORRELATION,
    GroundedPatch,
    Matches,
    Patch,
    Warps,
    cut_patch,
    ground_patch,
    match,
    no_matches,
    search,
    subset,
    warp,
)
from vopd.tracking.scene import Scene, View, turn_between, turned_by

WIDENING_PX = (4.0, 12.0, 30.0)  # from where a patch is predicted, one after the other
NEAR_PX = 3.0  # once others have corrected the prediction, or a search has found the place
RESIDUAL_PX = 0.8  # against the running attitude
REACH = 70  # frames from a click, before and after
LIKENESS = 0.6  # of two aligned frames: below it is a cut, or something hides the view
HIDDEN = 45  # frames whose view may be hidden before it is a cut
PREDICTED = 300  # frames by the alignment alone before the track is given up
SURE = 3  # landmarks that agree are enough also where whole frames are not alike
PAIRS = 200  # of patches that are tried for the turn that most agree with
SLACK = 2.0  # standard deviations of the camera's place
SHAKE_RAD = 0.003  # of a turn within a readout, besides what the frames beside a frame show
PRIOR_RAD = 0.03  # of a turn, where landmarks do not determine it

CLICKED, FOUND, OCCLUDED, EDGE, LOST, AMBIGUOUS = map(
    STATUSES.index, ("clicked", "tracked", "occluded", "edge", "lost", "ambiguous")
)

UNKNOWN, PREDICTED_ONLY, TRACKED = 0, 1, 2
"""How the attitude of a frame is known."""


@dataclass(frozen=True, eq=False)
class ClickedPixels:
    """A person's picks, P of them, each landmark once a frame.

    Args:
        frame: index of the frame in the video, (P,)
        landmark: index of the landmark, (P,)
        pixel: u, v from the centre of the first pixel, (P, 2)
        sigma_px: standard deviation of u and of v, (P,)
    """

    frame: Ints
    landmark: Ints
    pixel: Floats
    sigma_px: Floats


@dataclass(eq=False)
class RunningAttitudes:
    """The running attitudes of F frames."""

    rotation: Floats  # (F, 3, 3) NaN where it is not known
    known: Ints  # (F,) UNKNOWN, PREDICTED_ONLY or TRACKED
    segment: Ints  # (F,) frames of one number hang together; -1: none
    time_s: Floats  # (F,)

    def turning_rad_s(self, frame: int) -> Floats:
        """Estimate how fast the camera turns in a frame, by its neighbours, (3,)."""
        rotation, last = self.rotation, len(self.rotation) - 1
        before, after = max(frame - 1, 0), min(frame + 1, last)
        same = self.segment[frame]
        before = before if self.segment[before] == same else frame
        after = after if self.segment[after] == same else frame
        step_s = self.time_s[after] - self.time_s[before]
        if same < 0 or before == after or not step_s > 0.0:
            return np.zeros(3)
        return np.asarray(turn_between(rotation[before], rotation[after]) / step_s)


class _State(NamedTuple):
    """The last frame whose attitude is known in a run."""

    frame: int
    levels: tuple[Level, Level]
    hidden: int = 0  # frames since
    predicted: int = 0  # frames without landmarks up to it


class Beginning(NamedTuple):
    """A frame with clicks at which tracking begins, and the frame from which it was lost, or -1."""

    frame: int
    cut: int


@dataclass(eq=False)
class Tracker:
    """One run of the tracker.

    Args:
        scene: all but the attitudes
        clicks: a person's
        time_s: of the frames, (F,); NaN where not known
        patch_px: side of the patch of each landmark, (N,)
        reach: frames from a click within which all of it are matched
        least_correlation: of a patch that is found
        residual_px: of a patch against the turn of the camera that most agree with, at most
    """

    scene: Scene
    clicks: ClickedPixels
    time_s: Floats
    patch_px: Ints
    reach: int = REACH
    least_correlation: float = LEAST_CORRELATION
    residual_px: float = RESIDUAL_PX
    attitudes: RunningAttitudes = field(init=False)
    patches: dict[int, Patch] = field(default_factory=dict)
    grounded: dict[int, GroundedPatch | None] = field(default_factory=dict)
    beginnings: list[Beginning] = field(default_factory=list)

    def __post_init__(self) -> None:
        frames = len(self.time_s)
        self.attitudes = RunningAttitudes(
            np.full((frames, 3, 3), np.nan), np.zeros(frames, int), np.full(frames, -1),
            self.time_s,
        )  # fmt: skip
        self.alignment = Alignment(self.scene)
        self._at: dict[int, list[int]] = {}
        for k, frame in enumerate(self.clicks.frame.tolist()):
            self._at.setdefault(frame, []).append(k)
        self._first = self._first_rotations()
        self._state: _State | None = None
        self._segment, self._lost = -1, -1

    # Beginning at a frame with clicks

    def _first_rotations(self) -> dict[int, Floats]:
        """Solve the frames with clicks of two landmarks or more by themselves."""
        clicks, scene = self.clicks, self.scene
        frames = np.unique(clicks.frame)
        at = np.searchsorted(frames, clicks.frame)
        away, found = np.empty((len(at), 3)), dict[int, Floats]()
        several = np.bincount(at)[at] > 3
        for _ in range(2):  # where the lens is beside its antenna depends on the attitude
            for k, frame in enumerate(frames.tolist()):
                place = scene.camera_m(frame, found.get(frame, np.eye(3))) - scene.raised_m(frame)
                own = at == k
                away[own] = scene.landmark_m[clicks.landmark[own]] - place[clicks.landmark[own]]
            away /= np.linalg.norm(away, axis=1, keepdims=True)
            for loss, used in (("least-squares", ~several), ("cauchy", several)):
                solved = solve_rotations(
                    scene.lens, len(frames), at, clicks.pixel, clicks.sigma_px, away, used, loss
                )
                known = np.isfinite(solved.rotation).all(axis=(1, 2))
                found |= {int(frames[k]): solved.rotation[k] for k in np.flatnonzero(known)}
        return found

    def view(self, frame: int, rotation: Floats | None = None, rate: Floats | None = None) -> View:
        """Take a frame with its attitude, its turning rate and its velocity."""
        if rotation is None:
            rotation = self.attitudes.rotation[frame]
        if self.scene.shutter is None:
            return View(frame, rotation, np.zeros(3), np.zeros(3))
        if rate is None:
            rate = self.attitudes.turning_rad_s(frame)
        return View(frame, rotation, rate, self.scene.velocity_m_s(frame))

    def _by_clicks(self, view: View, rows: list[int]) -> View:
        """Fit the attitude of a frame to its clicks, robustly; their rows have their own times."""
        scene, clicks = self.scene, self.clicks
        which = np.array(rows)
        for _ in range(8):
            place = scene.camera_m(view.frame, view.rotation) - scene.raised_m(view.frame)
            mark = clicks.landmark[which]
            pixel, by = scene.pixels(view, scene.landmark_m[mark] - place[mark])
            off = clicks.pixel[which] - pixel
            seen = np.isfinite(off).all(axis=1)
            length = np.hypot(*off.T) / clicks.sigma_px[which]
            weight = 1.0 / (1.0 + (length / 3.0) ** 2) / clicks.sigma_px[which] ** 2
            if seen.sum() < 2:
                break
            (step,) = _turns(by[seen][None], off[seen][None], weight[seen][None])
            view = View(view.frame, turned_by(step, view.rotation), view.rate_rad_s,
                        view.velocity_m_s)  # fmt: skip
            if np.abs(step).max() < 1e-9:
                break
        return view

    @property
    def starts(self) -> list[int]:
        """The frames at which tracking begins."""
        return [one.frame for one in self.beginnings]

    def _set(self, frame: int, rotation: Floats, known: int) -> None:
        self.attitudes.rotation[frame] = rotation
        self.attitudes.known[frame] = known
        self.attitudes.segment[frame] = self._segment
        self._ground(frame)
        if self.scene.shutter is not None:
            for near in (frame - 1, frame + 1):  # which know now how fast they turn
                if near in self.starts:
                    self._ground(near)

    def _ground(self, frame: int) -> None:
        """Lay the patches of a frame's clicks on the ground."""
        for click in self._at.get(frame, ()):
            if click in self.patches:
                self.grounded[click] = ground_patch(
                    self.scene, self.view(frame), self.patches[click]
                )

    def _cut_patches(self, frame: int, grey: Any) -> None:
        for click in self._at.get(frame, ()):
            mark = int(self.clicks.landmark[click])
            patch = cut_patch(
                grey, click, mark, frame, self.clicks.pixel[click], int(self.patch_px[mark])
            )
            if patch is not None:
                self.patches[click] = patch

    # Forward and backward

    def forward(
        self, pictures: Iterable[tuple[int, Any]], done: dict[int, Any]
    ) -> Iterator[NDArray[Any]]:
        """Run through frames in their order.

        Args:
            pictures: of the frames
            done: what an earlier run wrote down of the first ones

        Yields:
            A record of each frame, to write down; nothing of a frame that was done.
        """
        self._state = None
        resume = done[max(done)] if done else None
        for frame, grey in pictures:
            self._cut_patches(frame, grey)
            if frame in done:
                self._replay(done[frame])
                if resume is not None and frame == resume["state"]:
                    self._state = _State(
                        frame, reduced(grey), int(resume["hidden"]), int(resume["predicted"])
                    )
                continue
            count = len(self.beginnings)
            self._step(frame, grey, +1)
            yield self._record(frame, len(self.beginnings) > count)

    def _record(self, frame: int, begins: bool) -> NDArray[Any]:
        own, state = self.attitudes, self._state
        cut = self.beginnings[-1].cut if begins else -1
        left = (-1, 0, 0) if state is None else (state.frame, state.hidden, state.predicted)
        known = own.known[frame], own.segment[frame], own.rotation[frame]
        return np.array([(frame, *known, begins, cut, *left, self._lost)], ATTITUDE)

    def _replay(self, one: Any) -> None:
        """Take a frame as an earlier run left it."""
        frame = int(one["frame"])
        if one["begins"]:
            self.beginnings.append(Beginning(frame, int(one["cut"])))
        self._lost = int(one["lost"])
        if one["known"]:
            self._segment = int(one["segment"])
            self._set(frame, one["rotation"], int(one["known"]))

    def backward(self, pictures: Iterable[tuple[int, Any]]) -> Iterator[int]:
        """Run from a frame whose attitude is known back to the last one that it hangs with."""
        self._state = None
        for frame, grey in pictures:
            if self._state is None:
                self._segment = int(self.attitudes.segment[frame])
                self._state = _State(frame, reduced(grey))
                continue
            self._step(frame, grey, -1)
            yield frame
            if self._state is None:
                return

    def gaps(self) -> list[tuple[int, int]]:
        """List the gaps before each beginning: the frame that begins, and the first of the gap."""
        found = []
        for start in sorted(self.starts):
            low = start
            while low > 0 and self.attitudes.known[low - 1] == UNKNOWN:
                low -= 1
            if low < start:
                found.append((start, low))
        return found

    def _step(self, frame: int, grey: Any, way: int) -> None:
        levels = reduced(grey)
        state = self._state
        found = None if state is None else self._follow(state, frame, grey, levels, way)
        if state is not None and found is None:
            self._state = state._replace(hidden=state.hidden + 1)
            if state.hidden >= HIDDEN:
                self._lose(state.frame + 1)
        elif state is not None and found is not None:
            rotation, known = found
            predicted = 0 if known == TRACKED else state.predicted + 1
            self._set(frame, rotation, known)
            self._state = _State(frame, levels, 0, predicted)
            if predicted > PREDICTED:
                self._lose(frame + 1 - predicted)
        if frame in self._first:
            self._begin_if_needed(frame, levels)

    def _lose(self, frame: int) -> None:
        self._state, self._lost = None, frame

    def _begin_if_needed(self, frame: int, levels: tuple[Level, Level]) -> None:
        """Begin anew at a frame with clicks, if it is not tracked or they contradict the track."""
        if self.attitudes.known[frame] == TRACKED and not self._contradicted(frame):
            return
        state, lost = self._state, self._lost
        if state is not None:
            lost = frame if state.frame == frame else state.frame + 1
        self._segment += 1
        self.beginnings.append(Beginning(frame, lost))
        self._set(frame, self._first[frame], TRACKED)
        self._state, self._lost = _State(frame, levels), -1

    def _contradicted(self, frame: int) -> bool:
        """Tell whether clicks agree with one another, and not with the running attitude."""
        rows = self._at[frame]
        view = self.view(frame)
        mark = self.clicks.landmark[rows]
        if len(rows) < 3:
            return False
        place = self.scene.camera_m(frame, view.rotation) - self.scene.raised_m(frame)
        limit = np.maximum(10.0 * self.clicks.sigma_px[rows], 8.0)

        def far(one: View) -> Bools:
            pixel, _ = self.scene.pixels(one, self.scene.landmark_m[mark] - place[mark])
            off = self.clicks.pixel[rows] - pixel
            return np.asarray(~(np.hypot(off[:, 0], off[:, 1]) < limit))

        own = self._by_clicks(view, rows)
        return bool(far(view).mean() > 0.5 and far(own).mean() < 0.5)

    def _follow(
        self, state: _State, frame: int, grey: Any, levels: tuple[Level, Level], way: int
    ) -> tuple[Floats, int] | None:
        """Find the attitude of the next frame, and whether landmarks confirm it."""
        attitudes = self.attitudes
        if not np.isfinite(self.scene.camera_m(frame, np.eye(3))).all():
            return None
        last = attitudes.rotation[state.frame]
        before = state.frame - way
        turn = np.zeros(3)
        if 0 <= before < len(attitudes.known) and attitudes.segment[before] == self._segment:
            turn = turn_between(attitudes.rotation[before], last)
        steps = abs(frame - state.frame)
        step_s = self.time_s[frame] - self.time_s[state.frame]
        old = self.view(state.frame)
        best, likeness = turned_by(turn * steps, last), -1.0
        for start in (turn * steps, np.zeros(3)):
            first = self.view(frame, turned_by(start, last), np.zeros(3))
            rotation, like = self.alignment.turn(old, state.levels, first, levels)
            if like > likeness:
                best, likeness = rotation, like
            if like > 0.8 or not turn.any():
                break
        rate = turn_between(last, best) / step_s if abs(step_s) > 0.0 else np.zeros(3)
        if self.scene.shutter is not None and state.frame in self.starts and way > 0:
            # the first frame could not know how fast it turns
            again = self._by_clicks(self.view(state.frame, last, rate), self._at[state.frame])
            attitudes.rotation[state.frame] = again.rotation
            best = best @ last.T @ again.rotation
            for click in self._at[state.frame]:
                if click in self.patches:
                    self.grounded[click] = ground_patch(self.scene, again, self.patches[click])
        near = self._nearest(frame)
        located = self.locate(frame, grey, self.view(frame, best, rate), near)
        if located is not None and (likeness > LIKENESS or located.landmarks >= SURE):
            return located.view.rotation, TRACKED
        if likeness > LIKENESS:
            return best, PREDICTED_ONLY
        return None

    def _nearest(self, frame: int) -> list[GroundedPatch]:
        """Choose the patch of each landmark whose click is nearest to a frame in its segment."""
        best: dict[int, GroundedPatch] = {}
        for one in self.grounded.values():
            if one is None or self.attitudes.segment[one.patch.frame] != self._segment:
                continue
            other = best.get(one.patch.landmark)
            if other is None or abs(one.patch.frame - frame) < abs(other.patch.frame - frame):
                best[one.patch.landmark] = one
        return list(best.values())

    # One frame

    def locate(
        self, frame: int, grey: Any, view: View, patches: list[GroundedPatch]
    ) -> Located | None:
        """Find patches in a frame, and the turn of the camera that they agree with.

        Args:
            frame: its index
            grey: its picture
            view: its first attitude
            patches: of the clicks

        Returns:
            None where fewer than two landmarks agree.
        """
        if len({one.patch.landmark for one in patches}) < 2:
            return None
        least = self.least_correlation
        for radius in WIDENING_PX:
            warps, places = self._warps(view, patches)
            start = np.zeros((len(patches), 2))
            several = np.zeros(len(patches), bool)
            if radius > WIDENING_PX[0]:
                start, several = search(grey, warps, places, radius, least)
                rows = np.flatnonzero(np.isfinite(start[:, 0]) & ~several)
                found = no_matches(len(places))
                if len(rows):
                    some = [places[k] for k in rows]
                    part = _matched(grey, subset(warps, rows), some, start[rows], NEAR_PX, least)
                    found.put(rows, part)
            else:
                found = _matched(grey, warps, places, start, radius, least)
            agreed = agreement(
                warps, found, places, self._limit_px(view, places), self._late(warps)
            )
            if agreed is None:
                continue
            for _ in range(2):
                rotation = turned_by(agreed[0], view.rotation)
                view = View(frame, rotation, view.rate_rad_s, view.velocity_m_s)
                warps, places = self._warps(view, patches)
                found = _matched(grey, warps, places, np.zeros((len(places), 2)), NEAR_PX, least)
                agreed = agreement(
                    warps, found, places, self._limit_px(view, places), self._late(warps)
                )
                if agreed is None:
                    break
                if np.abs(agreed[0]).max() * self.scene.lens.focal_px[0] < 0.3:
                    break
            if agreed is None:
                continue
            turn, inlier, residual = agreed
            final = View(frame, turned_by(turn, view.rotation), view.rate_rad_s, view.velocity_m_s)
            marks = {one.patch.landmark for one, ok in zip(places, inlier, strict=True) if ok}
            return Located(final, warps, found, inlier, residual, len(marks))
        return None

    def _limit_px(self, view: View, patches: list[GroundedPatch]) -> Floats:
        """Find the largest residuals, with the errors of the camera's place, pixels, (C,)."""
        sigma_m = self.scene.place_sigma_m
        if sigma_m is None:
            return np.full(len(patches), self.residual_px)
        place = self.scene.camera_m(view.frame, view.rotation)
        away = [np.linalg.norm(one.clicked_m - place) for one in patches]
        each = np.array([np.hypot(sigma_m[view.frame], sigma_m[p.patch.frame]) for p in patches])
        slack_px = SLACK * self.scene.lens.focal_px[0] * each / np.array(away)
        return np.asarray(self.residual_px + slack_px)

    def _late(self, warps: Warps) -> Floats | None:
        """Find when the rows of patches are read, from -.5 to .5 of the readout, (C,)."""
        if self.scene.shutter is None:
            return None
        axis = int(self.scene.shutter.way in ("down", "up"))
        part = np.nan_to_num(warps.clicked[:, axis]) / self.scene.lens.size_px[axis] - 0.5
        return np.asarray(part)

    def _warps(self, view: View, patches: list[GroundedPatch]) -> tuple[Warps, list[GroundedPatch]]:
        """Lay patches on a frame: those of one size together, in the order given."""
        sides = sorted({one.patch.side for one in patches})
        if len(sides) == 1:
            return warp(self.scene, view, patches), patches
        parts, order = [], []
        for side in sides:
            rows = [k for k, one in enumerate(patches) if one.patch.side == side]
            parts.append(warp(self.scene, view, [patches[k] for k in rows]))
            order += rows
        back = np.argsort(order)
        widest = max(one.pixel.shape[1] for one in parts)
        pixel = np.concatenate([
            np.pad(one.pixel, ((0, 0), (0, widest - one.pixel.shape[1]), (0, 0)), "edge")
            for one in parts
        ])  # fmt: skip
        rest = [np.concatenate([one[k] for one in parts])[back] for k in range(1, 5)]
        return Warps(pixel[back], *rest), patches

    # Once more, against all clicks in reach

    def second(self, pictures: Iterable[tuple[int, Any]], wanted: Bools) -> Iterator[NDArray[Any]]:
        """Match frames with all clicks in reach, all attitudes known.

        Args:
            pictures: of the frames, in their order
            wanted: which of them have rows, (F,)
        """
        for frame in self._at:
            if self.attitudes.known[frame] != UNKNOWN:
                self._ground(frame)
        for frame, grey in pictures:
            if wanted[frame]:
                yield self._rows(frame, grey)

    def _in_reach(self, frame: int) -> list[GroundedPatch]:
        """List the patches of all clicks in reach; of a landmark without one, of the nearest."""
        segment = self.attitudes.segment[frame]
        found: list[GroundedPatch] = []
        best: dict[int, tuple[int, GroundedPatch]] = {}
        near = set()
        for one in self.grounded.values():
            if one is None or self.attitudes.segment[one.patch.frame] != segment:
                continue
            away, mark = abs(one.patch.frame - frame), one.patch.landmark
            if away == 0:
                continue
            if away <= self.reach:
                found.append(one)
                near.add(mark)
            elif mark not in best or away < best[mark][0]:
                best[mark] = away, one
        clicked = {int(self.clicks.landmark[k]) for k in self._at.get(frame, ())}
        found += [one for mark, (_, one) in best.items() if mark not in near | clicked]
        return sorted(found, key=lambda one: (one.patch.landmark, one.patch.frame))

    def _rows(self, frame: int, grey: Any) -> NDArray[Any]:
        """Match a frame: its rows, by landmark and click."""
        clicks = self.clicks
        patches = self._in_reach(frame) if self.attitudes.known[frame] != UNKNOWN else []
        located = self.locate(frame, grey, self.view(frame), patches) if patches else None
        nothing, one_to_one = np.full(2, np.nan), np.eye(2)
        rows: list[tuple[Any, ...]] = [
            (frame, clicks.landmark[k], k, clicks.pixel[k], clicks.sigma_px[k], one_to_one, np.nan,
             CLICKED, nothing)
            for k in self._at.get(frame, ())
        ]  # fmt: skip
        for k, one in enumerate(patches):
            mark, click = one.patch.landmark, one.patch.click
            status, likeness = LOST, np.nan
            if located is not None:
                found, warps = located.found, located.warps
                likeness = found.correlation[k]
                if located.inlier[k]:
                    rows.append(
                        (frame, mark, click, warps.clicked[k] + found.shift[k], found.sigma_px[k],
                         warps.by_click[k], likeness, FOUND, located.residual[k])
                    )  # fmt: skip
                    continue
                status = OCCLUDED if not found.good[k] else AMBIGUOUS
                status = status if warps.inside[k] else EDGE
            rows.append(
                (frame, mark, click, nothing, np.nan, one_to_one, likeness, status, nothing)
            )
        there = {int(row[1]) for row in rows}
        rows += [
            (frame, mark, -1, nothing, np.nan, one_to_one, np.nan, LOST, nothing)
            for mark in range(len(self.scene.landmark_m))
            if mark not in there
        ]
        rows.sort(key=lambda row: (row[1], row[7], row[2]))
        return np.array(rows, ROW)


class Located(NamedTuple):
    """A frame with the patches found in it, C of them."""

    view: View
    warps: Warps
    found: Matches
    inlier: Bools  # (C,) patches that agree with the attitude
    residual: Floats  # (C, 2)
    landmarks: int  # that agree


def _matched(
    grey: Any, warps: Warps, patches: list[GroundedPatch], start: Floats, reach_px: float,
    least: float,
) -> Matches:  # fmt: skip
    """Match patches of several sizes."""
    found = no_matches(len(patches))
    for side in sorted({one.patch.side for one in patches}):
        rows = np.array([k for k, one in enumerate(patches) if one.patch.side == side])
        some = subset(warps, rows)
        some = some._replace(pixel=some.pixel[:, : side * side])
        own = [patches[k] for k in rows]
        found.put(rows, match(grey, some, own, start[rows], reach_px, least))
    return found


def _turns(by_turns: Floats, shift: Floats, weight: Floats) -> Floats:
    """Fit small turns of the camera to shifts, (P, 3); or those and one within the readout, (P, 6).

    Args:
        by_turns: of C places for each turn, (P, C, 2, 3 or 6)
        shift: (P, C, 2)
        weight: (P, C)
    """
    count, places, _, size = by_turns.shape
    design = by_turns.reshape(count, 2 * places, size)
    across = (design * np.repeat(weight, 2, axis=1)[..., None]).swapaxes(1, 2)
    normal = across @ design
    normal += np.diag(np.repeat([PRIOR_RAD, SHAKE_RAD], 3)[:size] ** -2.0)
    right = across @ shift.reshape(count, 2 * places, 1)
    return np.asarray(np.linalg.solve(normal, right)[..., 0])


@np.errstate(all="ignore")
def agreement(
    warps: Warps,
    found: Matches,
    patches: list[GroundedPatch],
    limit: Floats,
    late: Floats | None = None,
) -> tuple[Floats, Bools, Floats] | None:
    """Find the turn of the camera that the shifts of most landmarks agree with.

    Args:
        warps: the patches laid on a frame
        found: their shifts
        patches: the patches, C
        limit: of the residuals, pixels, (C,)
        late: of a rolling shutter: when their rows are read, in readouts, (C,)

    Returns:
        The turn (3,), the patches that agree (C,), and their residuals (C, 2); None where fewer
        than two landmarks agree, or fewer than half of those that were found.
    """
    mark = np.array([one.patch.landmark for one in patches])
    usable = np.flatnonzero(found.good & np.isfinite(warps.by_turns).all(axis=(1, 2)))
    marks = np.unique(mark[usable])
    if len(marks) < 2:
        return None
    by, shift = warps.by_turns, found.shift
    if late is not None:  # shake between frames turns the camera while its rows are read
        by = np.concatenate([by, by * late[:, None, None]], axis=2)
    weight = found.sigma_px**-2.0
    pairs = np.array([(a, b) for a, b in combinations(usable.tolist(), 2) if mark[a] != mark[b]])
    pairs = pairs[:: -(-len(pairs) // PAIRS)]
    turns = _turns(by[pairs], shift[pairs], np.full(pairs.shape, 100.0))
    off = np.hypot(*np.moveaxis(shift[usable] - np.einsum("cij,pj->pci", by[usable], turns), 2, 0))
    near = off < limit[usable]
    # the pair that most landmarks agree with, and of those the one that they agree with best
    agrees = np.stack([near[:, mark[usable] == one].any(axis=1) for one in marks]).sum(axis=0)
    best = np.lexsort((np.minimum(off, limit[usable]).sum(axis=1), -agrees))[0]
    if agrees[best] < max(2, (len(marks) + 1) // 2):
        return None
    rows = usable[near[best]]
    for _ in range(3):
        (turn,) = _turns(by[rows][None], shift[rows][None], weight[rows][None])
        off = shift - by @ turn
        near = usable[np.hypot(*off[usable].T) < limit[usable]]
        if np.array_equal(near, rows):
            break
        rows = near
    if len(np.unique(mark[rows])) < 2:
        return None
    inlier = np.zeros(len(patches), bool)
    inlier[rows] = True
    return turn[:3], inlier, off
