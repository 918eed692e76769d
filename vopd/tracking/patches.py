"""Patches of clicked frames found again in other frames, to a tenth of a pixel.

The patch of a click is laid on the ground about its landmark, and from there on the other frame, by
positions, lens and a first attitude. Two shifts, a gain and a bias remain, which Gauss-Newton finds
(inverse compositional: Lucas and Kanade 1981, Baker and Matthews 2004). The patch is always that of
the click, so that errors do not add up from frame to frame.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.tracking.scene import Scene, View

PATCH_PX = 25  # side of a patch, if the landmark has no other
LEAST_PX = 13  # of a patch that is made smaller at the edge of the frame
WINDOW = 6.0  # sides of a patch below PATCH_PX a standard deviation of the weights of its pixels
MARGIN_PX = 8  # of the clicked frame around a patch that is kept, for blurring
ROUNDS = 12
SETTLED_PX = 0.003
BLURS = (0.0, 0.6, 1.0, 1.6, 2.6)  # pixels of the clicked frame: of patches seen from farther away

LEAST_CORRELATION = 0.6
LEAST_CONTRAST = 2.5  # grey levels: the scatter of a patch
LEAST_CURVATURE = 0.03  # of the smaller curvature over the larger one: an edge has none along it
SIGMA_FACTOR, LEAST_SIGMA_PX = 3.5, 0.05  # of the inverse Hessian; docs/track.md has where from
ALIKE, APART_PX = 0.92, 3.0  # of the best correlation: another place as good makes it ambiguous


@dataclass(frozen=True, eq=False)
class Patch:
    """What was around a click.

    Args:
        click: index of the click
        landmark: index of its landmark
        frame: index of its frame
        pixel: u, v of the click, (2,)
        corner: u, v of the first pixel of `grey`, whole numbers, (2,)
        grey: the frame there, with a margin, (h, w)
        side: of the patch, pixels, odd
        spread_px: standard deviation of the weights of its pixels about the middle; infinite: all
            weigh alike
    """

    click: int
    landmark: int
    frame: int
    pixel: Floats
    corner: Ints
    grey: Floats
    side: int
    spread_px: float = np.inf

    @cached_property
    def grid(self) -> Floats:
        """Pixels of the patch, u and v, (n, 2)."""
        return np.asarray(self.offset + np.round(self.pixel))

    @cached_property
    def offset(self) -> Floats:
        """The same from the pixel in the middle, (n, 2)."""
        half = self.side // 2
        v, u = np.mgrid[-half : half + 1, -half : half + 1]
        return np.stack([u.ravel(), v.ravel()], axis=1).astype(float)

    @cached_property
    def weight(self) -> Floats:
        """Weights of its pixels, 1 in the middle, (n,).

        A small patch is asked for where a mast or a roof stands above the ground: what is around
        it moves otherwise, the more the farther from the middle.
        """
        return np.asarray(np.exp(-0.5 * (self.offset**2).sum(axis=1) / self.spread_px**2))

    @cached_property
    def blurred(self) -> tuple[tuple[Floats, Floats], ...]:
        """Grey (n,) and its derivatives by u and v (n, 2), as sharp and blurred by `BLURS`."""
        from scipy.ndimage import gaussian_filter

        found = []
        u, v = np.round(self.grid - self.corner).astype(int).T
        for sigma in BLURS:
            grey = gaussian_filter(self.grey, sigma, mode="nearest") if sigma else self.grey
            down, right = (np.asarray(one) for one in np.gradient(grey))
            slope = np.stack([right[v, u], down[v, u]], axis=1)
            found.append((grey[v, u], slope))
        return tuple(found)


def cut_patch(
    grey: Floats, click: int, landmark: int, frame: int, pixel: Floats, side: int
) -> Patch | None:
    """Cut the patch of a click out of its frame: a smaller one near the edge, or none.

    One of less than PATCH_PX is weighed about its middle.

    Args:
        grey: the frame, (H, W)
        click: index of the click
        landmark: index of its landmark
        frame: index of the frame
        pixel: u, v of the click, (2,)
        side: of the patch, pixels, odd
    """
    middle, size = np.round(pixel).astype(int), np.array(grey.shape[::-1])
    half = min(side // 2, int(np.minimum(middle - 1, size - 2 - middle).min()))
    if half < min(side, LEAST_PX) // 2:
        return None
    low = np.maximum(middle - half - MARGIN_PX, 0)
    high = np.minimum(middle + half + MARGIN_PX + 1, size)
    part = np.array(grey[low[1] : high[1], low[0] : high[0]], dtype=float)
    spread_px = side / WINDOW if side < PATCH_PX else np.inf
    return Patch(
        click, landmark, frame, np.asarray(pixel, float), low, part, 2 * half + 1, spread_px
    )


@dataclass(frozen=True, eq=False)
class GroundedPatch:
    """A patch on the ground: where each of its pixels is, and the point that was clicked.

    Args:
        patch: the patch
        place_m: of its n pixels, site axes, (n, 3)
        clicked_m: of the click itself, (3,)
    """

    patch: Patch
    place_m: Floats
    clicked_m: Floats


def ground_patch(scene: Scene, view: View, patch: Patch) -> GroundedPatch | None:
    """Lay a patch on the ground; None where its rays do not meet it.

    Args:
        scene: all but the attitude
        view: of the clicked frame
        patch: the patch
    """
    pixels = np.concatenate([patch.grid, patch.pixel[None]])
    place = scene.ground(view, pixels, patch.landmark)
    if not np.isfinite(place).all():
        return None
    return GroundedPatch(patch, place[:-1], place[-1])


class Warps(NamedTuple):
    """Patches laid on a frame by its first attitude, C of them with n pixels each."""

    pixel: Floats  # (C, n, 2) u, v
    clicked: Floats  # (C, 2) the points that were clicked
    by_click: Floats  # (C, 2, 2) shift here per shift of the click
    by_turns: Floats  # (C, 2, 3) of the points that were clicked, by small turns of the camera
    inside: Bools  # (C,) all pixels of the patch, and what it is searched in, are in the picture


@np.errstate(all="ignore")
def warp(scene: Scene, view: View, patches: list[GroundedPatch]) -> Warps:
    """Lay patches of one size on a frame.

    Args:
        scene: all but the attitude
        view: the frame with its first attitude
        patches: one or more, with n pixels each
    """
    camera = scene.camera_m(view.frame, view.rotation) - scene.raised_m(view.frame)
    places = np.stack([np.concatenate([one.place_m, one.clicked_m[None]]) for one in patches])
    away = places - camera[[one.patch.landmark for one in patches]][:, None]
    pixel, by_turns = scene.pixels(view, away)
    offset = patches[0].patch.offset
    own = pixel[:, :-1] - pixel[:, :-1].mean(axis=1, keepdims=True)
    by_click = np.einsum("cni,nj->cij", own, offset) / (offset[:, 0] ** 2).sum()
    width, height = scene.lens.size_px
    inside = np.isfinite(pixel).all(axis=(1, 2))
    inside &= (pixel[..., 0].min(axis=1) >= 1.0) & (pixel[..., 0].max(axis=1) <= width - 2.0)
    inside &= (pixel[..., 1].min(axis=1) >= 1.0) & (pixel[..., 1].max(axis=1) <= height - 2.0)
    return Warps(pixel[:, :-1], pixel[:, -1], by_click, by_turns[:, -1], inside)


class Matches(NamedTuple):
    """Patches found in a frame, or not, C of them."""

    shift: Floats  # (C, 2) from where the first attitude has them
    sigma_px: Floats  # (C,) of u and of v, by the inverse Hessian, its factor and its floor
    correlation: Floats  # (C,)
    good: Bools  # (C,) correlation, contrast and curvature are above their limits

    def put(self, rows: Ints, part: Matches) -> None:
        """Write down those of some patches."""
        for own, some in zip(self, part, strict=True):
            own[rows] = some


def no_matches(count: int) -> Matches:
    """Make the matches of patches before any search."""
    nan = np.full(count, np.nan)
    return Matches(np.zeros((count, 2)), nan, nan.copy(), np.zeros(count, bool))


@np.errstate(all="ignore")
def match(
    grey: Floats, warps: Warps, patches: list[GroundedPatch], start: Floats, reach_px: float,
    least: float = LEAST_CORRELATION,
) -> Matches:  # fmt: skip
    """Find patches in a frame, each near where it is laid.

    Args:
        grey: the frame, (H, W)
        warps: the patches laid on it
        patches: the same patches
        start: first shifts, (C, 2)
        reach_px: a patch that moves farther from there is not found
        least: correlation of a patch that is found
    """
    by = warps.by_click
    scale = np.sqrt(np.abs(by[:, 0, 0] * by[:, 1, 1] - by[:, 0, 1] * by[:, 1, 0]))
    found = no_matches(len(patches))
    usable = np.flatnonzero(warps.inside & (scale > 0.05) & (scale < 20.0))
    if not len(usable):
        return found
    own, slope = _as_seen(patches, scale, usable)
    inverse = np.linalg.inv(by[usable])
    # derivatives by pixels of this frame, of the patch as its gain and bias leave it
    slope = slope @ inverse
    design = np.concatenate([slope, own[..., None], np.ones((*own.shape, 1))], axis=2)
    weight = np.stack([patches[k].patch.weight for k in usable])
    weighed = design * weight[..., None]
    normal = design.swapaxes(1, 2) @ weighed
    # what has no slope along an axis has curvature zero there, and is refused for it below
    normal += np.eye(4) * (1e-9 * np.trace(normal, axis1=1, axis2=2))[:, None, None]
    solver = np.linalg.solve(normal, weighed.swapaxes(1, 2))  # (C, 4, n)
    picture = _softened(grey, warps, usable, scale[usable])
    shift = start[usable].copy()
    moving = np.ones(len(usable), bool)
    for _ in range(ROUNDS):
        here = np.flatnonzero(moving)
        seen = picture(here, shift[here])
        fitted = np.einsum("ckn,cn->ck", solver[here], seen)
        step = -fitted[:, :2] / fitted[:, 2:3]
        length = np.hypot(*step.T)
        wild = ~(fitted[:, 2] > 0.1) | ~np.isfinite(length)
        step = np.where(wild[:, None], 0.0, step * np.minimum(1.0, 3.0 / length)[:, None])
        shift[here] += step
        far = np.hypot(*(shift[here] - start[usable][here]).T) > reach_px
        moving[here] = ~wild & ~far & (length > SETTLED_PX)
        if not moving.any():
            break
    seen = picture(np.arange(len(usable)), shift)
    fitted = np.einsum("ckn,cn->ck", solver, seen)
    misfit = seen - np.einsum("cnk,ck->cn", design[..., 2:], fitted[:, 2:])
    gain = fitted[:, 2]
    centred = own - own.mean(axis=1, keepdims=True), seen - seen.mean(axis=1, keepdims=True)
    size = np.sqrt((centred[0] ** 2).sum(axis=1) * (centred[1] ** 2).sum(axis=1))
    correlation = (centred[0] * centred[1]).sum(axis=1) / np.maximum(size, 1e-9)
    curvature = np.linalg.inv(np.linalg.inv(normal)[:, :2, :2])  # gain and bias eliminated
    wide = np.trace(curvature, axis1=1, axis2=2)
    both = np.linalg.det(curvature)
    larger = wide / 2.0 + np.sqrt(np.maximum(wide**2 / 4.0 - both, 0.0))
    freedom = np.maximum(weight.sum(axis=1) - 4.0, 1.0)
    variance = (weight * misfit**2).sum(axis=1) / freedom / gain**2
    # sigma of u and of v, the mean of both
    each = np.sqrt(variance * wide / (2.0 * both))
    far = np.hypot(*(shift - start[usable]).T) > reach_px
    good = (correlation > least) & (gain > 0.1) & ~far
    good &= (own.std(axis=1) > LEAST_CONTRAST) & (seen.std(axis=1) > LEAST_CONTRAST)
    good &= both / larger**2 > LEAST_CURVATURE
    sigma = np.maximum(SIGMA_FACTOR * each, LEAST_SIGMA_PX)
    found.put(usable, Matches(shift, sigma, correlation, good))
    return found


def _as_seen(patches: list[GroundedPatch], scale: Floats, usable: Ints) -> tuple[Floats, Floats]:
    """Take grey and slopes of patches, blurred as they are seen from farther away."""
    grey, slope = [], []
    for k in usable:
        blur = 0.5 * np.sqrt(max(scale[k] ** -2.0 - 1.0, 0.0))
        level = int(np.argmin(np.abs(np.array(BLURS) - blur)))
        one = patches[k].patch.blurred[level]
        grey.append(one[0])
        slope.append(one[1])
    return np.stack(grey).astype(float), np.stack(slope).astype(float)


def _softened(
    grey: Floats, warps: Warps, usable: Ints, scale: Floats
) -> Callable[[Ints, Floats], Floats]:
    """Prepare sampling of a frame; where a patch is seen from nearer by, the frame is blurred."""
    from scipy.ndimage import gaussian_filter

    height, width = grey.shape
    flat = grey.ravel()
    near: dict[int, tuple[Floats, Floats]] = {}
    for k, one in enumerate(scale):
        if one > 1.25:
            around = warps.pixel[usable[k]]
            low = np.maximum(np.floor(around.min(axis=0)).astype(int) - 40, 0)
            high = np.minimum(np.ceil(around.max(axis=0)).astype(int) + 41, [width, height])
            part = grey[low[1] : high[1], low[0] : high[0]].astype(np.float32)
            blur = 0.5 * np.sqrt(one**2 - 1.0)
            near[k] = gaussian_filter(part, blur, mode="nearest"), low

    def sampled(which: Ints, shift: Floats) -> Floats:
        at = warps.pixel[usable[which]] + shift[:, None]
        out = _bilinear(flat, width, height, at)
        for row, k in enumerate(which):
            if int(k) in near:
                part, low = near[int(k)]
                out[row] = _bilinear(part.ravel(), part.shape[1], part.shape[0], at[row] - low)
        return out

    return sampled


def _bilinear(flat: Floats, width: int, height: int, at: Floats) -> Floats:
    """Sample between four pixels; beyond the edge the last ones are held."""
    x = np.clip(at[..., 0], 0.0, width - 1.001)
    y = np.clip(at[..., 1], 0.0, height - 1.001)
    left, top = x.astype(np.int64), y.astype(np.int64)
    right, down = x - left, y - top
    index = top * width + left
    upper = flat[index] * (1.0 - right) + flat[index + 1] * right
    lower = flat[index + width] * (1.0 - right) + flat[index + width + 1] * right
    return np.asarray(upper * (1.0 - down) + lower * down)


@np.errstate(all="ignore")
def search(
    grey: Floats,
    warps: Warps,
    patches: list[GroundedPatch],
    radius_px: float,
    least: float = LEAST_CORRELATION,
) -> tuple[Floats, Bools]:
    """Search patches in a square around where each is laid, to whole pixels of the patch.

    Args:
        grey: the frame, (H, W)
        warps: the patches laid on it
        patches: the same patches
        radius_px: half the side of the square, pixels of this frame
        least: correlation of a patch that is found

    Returns:
        Shifts of the best places, (C, 2), NaN where there is none, and whether another one is
        nearly as good, (C,).
    """
    shift, several = np.full((len(patches), 2), np.nan), np.zeros(len(patches), bool)
    height, width = grey.shape
    for k, one in enumerate(patches):
        by = warps.by_click[k]
        scale = np.sqrt(abs(np.linalg.det(by)))
        if not (np.isfinite(warps.clicked[k]).all() and 0.05 < scale < 20.0):
            continue
        side = one.patch.side
        wide = int(min(np.ceil(radius_px / scale), 48))
        line = np.arange(-(side // 2) - wide, side // 2 + wide + 1, dtype=float)
        v, u = np.meshgrid(line, line, indexing="ij")
        middle = warps.pixel[k].mean(axis=0)
        at = middle + np.stack([u, v], axis=-1) @ by.T
        outside = ~(
            (at[..., 0] >= 0) & (at[..., 0] <= width - 1) & (at[..., 1] >= 0)
            & (at[..., 1] <= height - 1)
        )  # fmt: skip
        seen = _bilinear(grey.ravel(), width, height, at)
        own = one.patch.blurred[1 if scale < 0.8 else 0][0].reshape(side, side).astype(float)
        likeness = _correlations(seen, own)
        windows = np.lib.stride_tricks.sliding_window_view(outside, (side, side))
        beyond = windows[:, :, :: side - 1, :: side - 1].any(axis=(2, 3))
        likeness = np.where(beyond, -1.0, likeness)
        best = np.unravel_index(int(np.argmax(likeness)), likeness.shape)
        if not likeness[best] > least:
            continue
        shift[k] = by @ np.array([best[1] - wide, best[0] - wide], dtype=float)
        row, column = np.ogrid[: likeness.shape[0], : likeness.shape[1]]
        away = np.hypot(row - best[0], column - best[1]) > APART_PX + side / 4
        several[k] = bool((likeness[away] > ALIKE * likeness[best]).any())
    return shift, several


def _correlations(seen: Floats, own: Floats) -> Floats:
    """Correlate a patch with all squares of its size in a picture."""
    from scipy.signal import fftconvolve

    side = own.shape[0]
    own = own - own.mean()
    seen = seen - seen.mean()
    total = fftconvolve(seen, own[::-1, ::-1], mode="valid")
    sums = np.cumsum(np.cumsum(np.pad(seen, ((1, 0), (1, 0))), axis=0), axis=1)
    squares = np.cumsum(np.cumsum(np.pad(seen**2, ((1, 0), (1, 0))), axis=0), axis=1)

    def over(table: Floats) -> Floats:
        return np.asarray(
            table[side:, side:] - table[:-side, side:] - table[side:, :-side]
            + table[:-side, :-side]
        )  # fmt: skip

    spread = np.maximum(over(squares) - over(sums) ** 2 / side**2, side**2 * 1.0)
    return np.asarray(total / np.sqrt(spread * (own**2).sum()))


def subset(warps: Warps, rows: Ints) -> Warps:
    """Take the warps of some patches."""
    return Warps._make(one[rows] for one in warps)
