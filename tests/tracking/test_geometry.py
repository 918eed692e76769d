"""Warps by hand, matches of drawn patches, the turn that most agree with, frames aligned."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit.drawn_ground import EARTH_M, LENS, NADIR, SIZE, drawn
from tests.kit.whole import whole
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.flight import CameraPath, LandmarkSet, Refraction, Shutter
from vopd.flight.project.keys import Section
from vopd.flight.project.terrain import Terrain, relief_text
from vopd.geometry.earth import earth_centred_m
from vopd.tracking import follow
from vopd.tracking.alignment import Alignment, reduced
from vopd.tracking.patches import (
    GroundedPatch,
    Warps,
    cut_patch,
    ground_patch,
    match,
    no_matches,
    search,
    warp,
)
from vopd.tracking.scene import Scene, View, turn_between, turned_by
from vopd.tracking.tracker import FOUND, RESIDUAL_PX, RunningAttitudes, Tracker, agreement


def test_gaps_are_before_beginnings_and_as_long_as_nothing_is_known() -> None:
    """Frames 0 to 3, 7, 8 and 10 have no attitude; 4, 6, 9 and 11 begin."""
    known = np.array([0, 0, 0, 0, 2, 2, 1, 0, 0, 2, 0, 2])
    tracker: Any = SimpleNamespace(starts={4, 6, 9, 11}, attitudes=SimpleNamespace(known=known))
    assert Tracker.gaps(tracker) == [(4, 0), (9, 7), (11, 10)]


@pytest.mark.parametrize(("first", "second"), [(0.7, 0.6), (0.6, 0.7)])
def test_of_two_starts_the_one_whose_frames_are_more_alike_counts(
    first: float, second: float
) -> None:
    """On as it turned, and without a turn; the camera turned between the frames before."""
    found = [(turned_by(np.array([0.0, 0.0, one]), np.eye(3)), one) for one in (first, second)]
    answers = iter(found)
    known = SimpleNamespace(
        rotation=np.stack([np.eye(3), turned_by(np.array([0.0, 0.1, 0.0]), np.eye(3))]),
        known=np.ones(3, int), segment=np.zeros(3, int),
    )  # fmt: skip
    tracker: Any = SimpleNamespace(
        attitudes=known, _segment=0, time_s=np.arange(3.0), starts=set(),
        view=lambda *_: None, locate=lambda *_: None, _nearest=lambda _: None,
        alignment=SimpleNamespace(turn=lambda *_: next(answers)),
        scene=SimpleNamespace(camera_m=lambda *_: np.zeros(3), shutter=None),
    )  # fmt: skip
    state: Any = SimpleNamespace(frame=1, levels=None)
    levels: Any = None
    answer = Tracker._follow(tracker, state, 2, None, levels, 1)
    assert answer is not None
    assert np.array_equal(answer[0], max(found, key=lambda one: one[1])[0])


NORTH_RIGHT = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


def above(*height_m: float, shutter: Shutter | None = None) -> Scene:
    """A camera above a landmark on the equator, where up is x, east y and north z."""
    place = np.array([[EARTH_M + one, 0.0, 0.0] for one in height_m])
    marks = LandmarkSet(("a",), np.array([[EARTH_M, 0.0, 0.0]]), np.zeros((1, 3)))
    path = CameraPath(place, velocity_m_s=np.tile([0.0, 50.0, 0.0], (len(place), 1)))
    return Scene(LENS, path, marks, Refraction(0.0, False), np.eye(3), shutter)


def view(frame: int, rotation: Floats, rate: Floats | None = None, east_m_s: float = 0.0) -> View:
    speed = np.array([east_m_s, 0.0, 0.0])
    return View(frame, rotation, np.zeros(3) if rate is None else rate, speed)


def picture(
    shift: tuple[float, float] = (0.0, 0.0), gain: float = 1.0, bias: float = 0.0
) -> Floats:
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    return gain * drawn(u - shift[0], v - shift[1]) + bias


def laid(scene: Scene, grey: Floats, pixel: tuple[float, float], side: int = 25) -> GroundedPatch:
    patch = cut_patch(grey, 0, 0, 0, np.array(pixel), side)
    assert patch is not None
    found = ground_patch(scene, view(0, NADIR), patch)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("rotation", "by_click", "pixel"),
    [
        (NADIR, [[0.5, 0.0], [0.0, 0.5]], (110.25, 75.0)),
        (NORTH_RIGHT, [[0.0, -0.5], [0.5, 0.0]], (105.0, 90.25)),
    ],
)
def test_the_ground_from_twice_as_high(
    rotation: Floats, by_click: list[list[float]], pixel: tuple[float, float]
) -> None:
    """At 1000 m and a focal length of 1000 px a pixel is a metre; 20.5 m east, 10 m south."""
    scene = above(1000.0, 2000.0)
    found = warp(scene, view(1, rotation), [laid(scene, picture(), (120.5, 70.0))])
    assert_close("warp of a patch", found.clicked[0], pixel)
    assert_close("warp of a patch", found.by_click[0], by_click)
    assert found.inside.all()


class Rising:
    """A terrain that rises by a tenth to the east, 7 m below the landmark, unknown in the west.

    Or, along axis 2, to the north, and unknown in the south.
    """

    def __init__(self, axis: int = 1) -> None:
        self._axis = axis

    def above_m(self, position_m: Floats) -> Floats:
        along = position_m[:, self._axis]
        found = position_m[:, 0] - EARTH_M + 7.0 - 0.1 * along
        return np.asarray(np.where(along < -200.0, np.nan, found))


DOWNWARD = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""A camera that looks down from its vehicle, ahead at the top: to axes forward, right, down."""


@pytest.mark.parametrize(
    ("mount", "place"), [(np.eye(3), [1.0, -2.0, 997.0]), (DOWNWARD, [2.0, 1.0, 997.0])]
)
def test_a_camera_is_a_lever_arm_from_its_antenna(mount: Floats, place: list[float]) -> None:
    """1, 2, 3 m to the right, down in the picture and ahead; or forward, right, down, north."""
    scene = above(1000.0)
    path = replace(scene.path, lever_arm_m=np.array([1.0, 2.0, 3.0]))
    scene = replace(scene, path=path, mount=mount)
    assert_close("table value", scene.camera_m(0, NADIR), place)


def test_a_velocity_that_is_not_known_is_none() -> None:
    scene = above(1000.0)
    assert_close("table value", scene.velocity_m_s(0), [50.0, 0.0, 0.0])
    unknown = replace(scene, path=replace(scene.path, velocity_m_s=None))
    assert unknown.velocity_m_s(0).tolist() == [0.0, 0.0, 0.0]


def test_a_line_of_sight_that_grazes_the_ground_ends_across_it() -> None:
    """Of a landmark 1000 m north; 10 px to the right and 5 up are 10 and 5 m.

    There the vertical is .00904 degree north of the camera's, which so is .158 m lower.
    """
    scene = above(0.0)
    north = replace(scene.landmarks, position_m=np.array([[EARTH_M, 0.0, 1000.0]]))
    looks = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    found = replace(scene, landmarks=north).ground(view(0, looks), np.array([110.0, 75.0]), 0)
    assert_close("ground on a terrain", found, [10.0, 0.0, 5.0 - 0.158])


def test_a_line_of_sight_that_grazes_a_slope_ends_across_it() -> None:
    """Of a landmark 1000 m west and 176 m down, 10 degrees: 4.3 above ground that rises by 5.7."""
    scene = above(176.0)
    scene.path.position_m[0, 1] = 1000.0
    ahead = np.array([-1000.0, 0.0, -176.0]) / np.hypot(1000.0, 176.0)
    looks = np.array([[0.0, 1.0, 0.0], [ahead[2], 0.0, -ahead[0]], ahead])
    found = replace(scene, terrain=Rising()).ground(view(0, looks), np.array([110.0, 75.0]), 0)
    away_m = np.hypot(1000.0, 176.0)
    expected = away_m * (0.01 * looks[0] - 0.005 * looks[1])
    assert_close("ground on a terrain", found, expected)


def test_the_ground_of_a_landmark_that_refraction_raises_is_at_the_landmark() -> None:
    """14 km to the north and 1 km below: by more than a metre."""
    scene = replace(above(1000.0), refraction=Refraction(0.13, False))
    marks = replace(scene.landmarks, position_m=np.array([[EARTH_M, 0.0, 14000.0]]))
    scene = replace(scene, landmarks=marks)
    looks = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    raised_m = scene.raised_m(0)
    assert raised_m[0, 2] > 1.0
    away = scene.landmark_m + raised_m - scene.camera_m(0, looks)
    pixel, _ = scene.pixels(view(0, looks), away)
    assert_close("ground on a terrain", scene.ground(view(0, looks), pixel[0], 0), [0.0, 0.0, 0.0])


class Falling:
    """A terrain that falls from the landmark on, by .1125 of the square of what is east."""

    def above_m(self, position_m: Floats) -> Floats:
        return np.asarray(position_m[:, 0] - EARTH_M + 0.1125 * position_m[:, 1] ** 2)


def test_the_ground_on_a_terrain_that_is_bent() -> None:
    """40 m east in 1000 m: t - 1000 = .1125 (.04 t)^2, where a step by the slope leaves a half."""
    scene = replace(above(1000.0), terrain=Falling())
    found = scene.ground(view(0, NADIR), np.array([[140.0, 80.0]]), 0)
    t = (1.0 - np.sqrt(1.0 - 0.72)) / 0.00036
    assert_close("ground on a terrain", found, [[0.04 * t, 0.0, 1000.0 - t]])


def test_the_ground_on_a_terrain() -> None:
    """40 m east in 1000 m: t below the camera is .04 t east, so 1000 - t = .1 * .04 t."""
    scene = replace(above(1000.0), terrain=Rising())
    found = scene.ground(view(0, NADIR), np.array([[140.0, 80.0], [100.0, 80.0]]), 0)
    t = 1000.0 / 1.004
    assert_close("ground on a terrain", found, [[0.04 * t, 0.0, 1000.0 - t], [0.0, 0.0, 0.0]])
    unknown = scene.ground(view(0, NADIR), np.array([[-150.0, 80.0]]), 0)  # along the slope
    t = 1000.0 / 0.975
    assert_close("ground on a terrain", unknown, [[-0.25 * t, 0.0, 1000.0 - t]])
    north = replace(above(1000.0), terrain=Rising(2))
    unknown = north.ground(view(0, NADIR), np.array([[100.0, 330.0]]), 0)
    assert_close("ground on a terrain", unknown, [[0.0, -0.25 * t, 1000.0 - t]])


def test_a_file_s_heights_are_those_of_the_middles_of_its_cells(tmp_path: Path) -> None:
    """A metre a cell to the east and ten a cell to the south, from 100 m in the first cell."""
    rasterio, affine = pytest.importorskip("rasterio"), pytest.importorskip("affine")
    row, column = np.mgrid[:8, :6]
    heights = (100.0 + column + 10.0 * row).astype(np.float32)
    with rasterio.open(
        tmp_path / "a.tif", "w", driver="GTiff", width=6, height=8, count=1, dtype="float32",
        crs="EPSG:4326", transform=affine.Affine(0.002, 0.0, 8.0, 0.0, -0.001, 47.0),
    ) as file:  # fmt: skip
        file.write(heights[None])
    cell = np.array([[0.5, 0.5], [3.5, 5.5], [2.75, 4.5], [2.5, 4.25]])  # from the corner
    where = earth_centred_m(47.0 - 0.001 * cell[:, 1], 8.0 + 0.002 * cell[:, 0], np.zeros(4))
    with rasterio.open(tmp_path / "a.tif") as file:
        found = Terrain("a.tif", file, Section("p.toml", "landmarks", {})).heights_m(where)
    assert_close("height of a terrain", found, [100.0, 153.0, 142.25, 139.5])


def test_rows_of_a_rolling_shutter() -> None:
    """The row 80 of 160 is read at half of .1 s, in which 50 m/s east are 2.5 m; 1 deg/s of yaw."""
    scene = above(1000.0, 1000.0, shutter=Shutter(0.1, "down", False))
    pixel, _ = scene.pixels(view(0, NADIR, east_m_s=50.0), np.array([0.0, 0.0, -1000.0]))
    assert_close("row of a rolling shutter", pixel, [97.5, 80.0])
    rate = np.array([0.0, 0.0, np.radians(1.0)])
    pixel, _ = scene.pixels(view(0, NADIR, rate), np.array([50.0, 0.0, -1000.0]))
    turned = np.radians(0.05 * (1.0 + 50.0 * np.radians(0.05) / 80.0))
    expected = [100.0 + 50.0 * np.cos(turned), 80.0 + 50.0 * np.sin(turned)]
    assert_close("row of a rolling shutter", pixel, expected)
    back, start = scene.rays(view(0, NADIR, rate, 50.0), pixel)
    moved = view(0, NADIR, rate, 50.0)
    again, _ = scene.pixels(moved, start + back * 1000.0)
    assert_close("row of a rolling shutter", again, pixel)


@pytest.mark.parametrize(("way", "part"), [("down", 0.25), ("up", 0.25), ("left", -0.4)])
def test_when_a_patch_is_read(way: Any, part: float) -> None:
    """Pixel 20.1, 120.75 of 201 by 161: a quarter behind the middle row, .4 before the column."""
    scene = above(1000.0, 1000.0, shutter=Shutter(0.1, way, False))
    tracker = SimpleNamespace(scene=scene)
    late = Tracker._late(tracker, SimpleNamespace(clicked=np.array([[20.1, 120.75]])))
    assert_close("row of a rolling shutter", late, [part])


def test_a_patch_moved_brighter_and_flatter() -> None:
    scene = above(1000.0, 1000.0)
    patch = laid(scene, picture(), (120.3, 70.8))
    warps = warp(scene, view(1, NADIR), [patch])
    found = match(picture((1.37, -0.64), 0.7, 30.0), warps, [patch], np.zeros((1, 2)), 4.0)
    assert found.good.all() and found.correlation[0] > 0.99
    assert_close("match of a drawn patch", found.shift[0], [1.37, -0.64])
    far = match(picture((6.3, 0.0)), warps, [patch], np.zeros((1, 2)), 4.0)
    assert not far.good.any()  # beyond its reach
    near = match(picture((6.3, 0.0)), warps, [patch], np.array([[5.0, 1.0]]), 4.0)
    assert near.good.all()  # which counts from where it begins
    assert_close("match of a drawn patch", near.shift[0], [6.3, 0.0])
    shift, several = search(picture((11.0, -9.0)), warps, [patch], 12.0)
    assert not several.any()
    assert shift[0].tolist() == [11.0, -9.0]


@pytest.mark.parametrize("u", [20.3, 180.3])
@pytest.mark.parametrize("way", [1, -1], ids=["landscape", "portrait"])
def test_a_patch_is_searched_in_the_whole_picture(way: int, u: float) -> None:
    """Also right of the width of one that is higher than broad; and near an edge."""
    shape = SIZE[::way]
    lens = replace(LENS, size_px=shape, centre_px=LENS.centre_px[::way])
    scene = replace(above(1000.0, 1000.0), lens=lens)
    pixel = (u, 70.8)[::way]
    first, moved = (
        drawn(*np.mgrid[: shape[0], : shape[1]].astype(float) - np.reshape(off, (2, 1, 1))).T
        for off in ((0.0, 0.0), (5.0, -4.0))
    )
    patch = laid(scene, first, pixel)
    warps = warp(scene, view(1, NADIR), [patch])
    shift, _ = search(moved, warps, [patch], 7.0)
    assert shift[0].tolist() == [5.0, -4.0]


def test_the_sigma_of_a_match_is_that_of_its_noise_over_its_contrast() -> None:
    """Half as bright, noise included, it is the same; of noise twice as strong it is twice that."""
    scene = above(1000.0, 1000.0)
    patch = laid(scene, picture(), (120.3, 70.8))
    warps = warp(scene, view(1, NADIR), [patch])
    noise = np.random.default_rng(12).normal(0.0, 4.0, SIZE[::-1])
    sigma_px = [
        match(gain * (picture() + times * noise), warps, [patch], np.zeros((1, 2)), 4.0).sigma_px[0]
        for gain, times in ((1.0, 1.0), (0.5, 1.0), (1.0, 2.0))
    ]
    assert_close("ratio of sigmas of matches", np.array(sigma_px) / sigma_px[0], [1.0, 1.0, 2.0])


def test_a_patch_seen_from_farther_away_is_blurred() -> None:
    """From twice the height the frame does not show waves that are three pixels long."""
    scene = above(1000.0, 2000.0)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    patch = laid(scene, picture() + 60.0 * np.cos(2.0 / 3.0 * np.pi * (u + v)), (120.0, 70.0))
    warps = warp(scene, view(1, NADIR), [patch])
    seen = drawn(100.0 + 2.0 * (u - 105.7), 80.0 + 2.0 * (v - 77.6))
    found = match(seen, warps, [patch], np.array([[5.0, -2.0]]), 4.0)
    assert found.good.all() and found.correlation[0] > 0.9
    assert_close("match of a drawn patch", found.shift[0], [5.7, -2.4])
    shift, _ = search(seen, warps, [patch], 8.0, least=0.8)
    assert_close("match of a searched patch", shift[0], [5.7, -2.4])


def test_a_patch_seen_from_nearer_by_is_compared_with_a_blurred_frame() -> None:
    """From half the height the frame shows what the patch's pixels, twice as large, cannot.

    Here the patch's picture twice as large, and waves as strong that are three pixels long.
    """
    scene = above(1000.0, 500.0)
    patch = laid(scene, picture(), (120.0, 70.0))
    warps = warp(scene, view(1, NADIR), [patch])
    assert_close("warp of a patch", warps.by_click[0], 2.0 * np.eye(2))
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    seen = drawn(100.0 + (u - 100.7) / 2.0, 80.0 + (v - 79.6) / 2.0)
    fine = seen + 80.0 * np.cos(2.0 / 3.0 * np.pi * (u + v))
    found = match(fine, warps, [patch], np.zeros((1, 2)), 4.0)
    assert found.good.all() and found.correlation[0] > 0.99
    assert_close("match of a drawn patch", found.shift[0], [0.7, -0.4])


def test_a_mast_in_front_of_ground_that_moves_otherwise() -> None:
    """A small patch follows what is in its middle, and not what moves by 1.5 px at its rim."""
    scene = above(1000.0, 1000.0)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    top = np.maximum(abs(u - 120.0), abs(v - 70.0)) <= 4
    patch = laid(scene, picture(), (120.0, 70.0), 13)
    seen = np.where(top, picture(), picture((1.5, -1.5)))
    warps = warp(scene, view(1, NADIR), [patch])
    found = match(seen, warps, [patch], np.zeros((1, 2)), 4.0)
    assert found.good.all()
    assert_close("match of a small patch", found.shift[0], [0.0, 0.0])
    assert patch.patch.weight.max() == patch.patch.weight[6 * 13 + 6] == 1.0
    assert np.all(laid(scene, picture(), (9.0, 70.0)).patch.weight == 1.0)  # cut by the edge


def test_what_is_no_match() -> None:
    """Another picture, a flat one, an edge, a patch at the edge of the frame."""
    scene = above(1000.0, 1000.0)
    patch = laid(scene, picture(), (120.0, 70.0))
    warps = warp(scene, view(1, NADIR), [patch])
    noise = np.random.default_rng(3).normal(120.0, 30.0, SIZE[::-1])
    v, _ = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    edge = 120.0 + 40.0 * np.tanh((v - 70.0) / 3.0)
    for other in (noise, np.full(SIZE[::-1], 99.0)):
        assert not match(other, warps, [patch], np.zeros((1, 2)), 4.0).good.any()
    along = laid(scene, edge, (120.0, 70.0))
    assert not match(edge, warps, [along], np.zeros((1, 2)), 4.0).good.any()
    turned = turned_by([0.0, 0.07, 0.0], NADIR)
    assert not warp(scene, view(1, turned), [patch]).inside.any()
    assert cut_patch(picture(), 0, 0, 0, np.array([3.0, 70.0]), 25) is None
    near = cut_patch(picture(), 0, 0, 0, np.array([9.0, 70.0]), 25)
    assert near is not None and near.side == 17
    small = cut_patch(picture(), 0, 0, 0, np.array([120.0, 70.0]), 9)  # as is asked for
    assert small is not None and small.side == 9


@pytest.mark.parametrize(("grows", "told"), [(4.0, 2), (4.2, 0)])
def test_a_click_is_far_by_what_the_error_of_the_other_has_grown_to(
    grows: float, told: int
) -> None:
    """From a click of 2 px to one of 1 px, 50 px away: six sigmas are 48.4 and 50.8 px.

    The growth is the largest of all directions.
    """
    kind = [("frame", int), ("landmark", int), ("click", int), ("status", int)]
    block = np.zeros(1, [*kind, ("pixel", float, 2), ("by_click", float, (2, 2))])
    block["frame"], block["status"] = 5, FOUND
    block["by_click"][0] = [[0.6 * grows, 0.0], [0.8 * grows, 0.0]]
    clicks: Any = SimpleNamespace(
        frame=np.array([0, 5]), landmark=np.zeros(2, int),
        pixel=np.array([[10.0, 20.0], [30.0, 40.0]]), sigma_px=np.array([2.0, 1.0]),
    )  # fmt: skip
    block["pixel"] = clicks.pixel[1] + [30.0, 40.0]
    journal: Any = SimpleNamespace(blocks=lambda _: [block])
    flight = SimpleNamespace(landmarks=SimpleNamespace(name=("a",)))
    project = SimpleNamespace(name="p.toml")
    footage: Any = SimpleNamespace(flight=flight, number=np.arange(6), project=project)
    nobody: Any = None
    assert len(follow._findings(journal, footage, nobody, clicks)) == told


def test_most_landmarks_outvote_one() -> None:
    """Five landmarks, one of which has jumped by 9 px; of two that contradict none is believed."""
    rng = np.random.default_rng(5)
    by_turns = rng.normal(0.0, 800.0, (5, 2, 3))
    turn = np.array([1e-3, -2e-3, 5e-4])
    shift = by_turns @ turn
    shift[3] += [9.0, 0.0]
    scene = above(1000.0)
    one = laid(scene, picture(), (120.0, 70.0))
    patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in range(5)]
    eye = np.tile(np.eye(2), (5, 1, 1))
    warps = Warps(np.zeros((5, 625, 2)), np.zeros((5, 2)), eye, by_turns, np.ones(5, bool))
    found = no_matches(5)._replace(shift=shift, good=np.ones(5, bool), sigma_px=np.full(5, 0.05))
    agreed = agreement(warps, found, patches, np.full(5, RESIDUAL_PX))
    assert agreed is not None
    assert agreed[1].tolist() == [True, True, True, False, True]
    assert_close("turn by drawn shifts", agreed[0], turn)
    same = np.tile(by_turns[:1], (5, 1, 1))
    apart = found._replace(shift=np.array([[0.0, 0.0], [7.0, 0.0]] + [[0.0, 0.0]] * 3))
    apart.good[2:] = False
    limit_px = np.full(5, RESIDUAL_PX)
    assert agreement(warps._replace(by_turns=same), apart, patches, limit_px) is None


@pytest.mark.parametrize(
    ("way", "first_ms"), [("down", 25.0), ("up", 75.0), ("right", 50.0), ("left", 50.0)]
)
def test_when_the_row_of_a_pixel_is_read(way: str, first_ms: float) -> None:
    """A pixel in the middle of a row of 201, a quarter down 161 rows, read within 100 ms."""
    pixel = np.array([[100.0, 40.0], [200.0, 160.0]])
    last_ms = 100.0 if way in ("down", "right") else 0.0
    for middle, sooner_ms in ((False, 0.0), (True, 50.0)):
        scene = above(1000.0, shutter=Shutter(0.1, way, middle))
        expected = np.array([first_ms, last_ms]) - sooner_ms
        assert_close("turn by drawn shifts", scene.late_s(pixel), expected / 1000.0)


def test_shake_while_rows_are_read_is_told_from_a_turn() -> None:
    """Of eight landmarks whose rows are read at different times."""
    rng = np.random.default_rng(8)
    by_turns, late = rng.normal(0.0, 800.0, (8, 2, 3)), np.linspace(-0.5, 0.5, 8)
    turn, shake = np.array([1e-3, -2e-3, 5e-4]), np.array([-4e-3, 1e-3, 2e-3])
    shift = by_turns @ turn + late[:, None] * (by_turns @ shake)
    one = laid(above(1000.0), picture(), (120.0, 70.0))
    patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in range(8)]
    eye, all_of_them = np.tile(np.eye(2), (8, 1, 1)), np.ones(8, bool)
    warps = Warps(np.zeros((8, 625, 2)), np.zeros((8, 2)), eye, by_turns, all_of_them)
    found = no_matches(8)._replace(shift=shift, good=all_of_them, sigma_px=np.full(8, 0.05))
    limit_px = np.full(8, 2.0 * RESIDUAL_PX)
    agreed = agreement(warps, found, patches, limit_px, late)
    assert agreed is not None and agreed[1].all()
    assert_close("turn by drawn shifts", agreed[0], turn)
    without = agreement(warps, found, patches, limit_px)
    assert without is None or not without[1].all()


def test_of_many_patches_some_pairs_are_tried() -> None:
    """Of forty patches, the first ten of which have moved by 9 px; 780 pairs are too many."""
    rng = np.random.default_rng(6)
    by_turns, turn = rng.normal(0.0, 800.0, (40, 2, 3)), np.array([1e-3, -2e-3, 5e-4])
    moved = np.arange(40) < 10
    shift = by_turns @ turn + 9.0 * moved[:, None]
    one = laid(above(1000.0), picture(), (120.0, 70.0))
    patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in range(40)]
    eye, usable = np.tile(np.eye(2), (40, 1, 1)), np.ones(40, bool)
    warps = Warps(np.zeros((40, 625, 2)), np.zeros((40, 2)), eye, by_turns, usable)
    found = no_matches(40)._replace(shift=shift, good=usable, sigma_px=np.full(40, 0.05))
    agreed = agreement(warps, found, patches, np.full(40, RESIDUAL_PX))
    assert agreed is not None and agreed[1].tolist() == (~moved).tolist()
    assert_close("turn by drawn shifts", agreed[0], turn)


def test_landmarks_agree_and_not_their_clicks() -> None:
    """One of five has six clicks, which another agrees with; the other three do not."""
    rng = np.random.default_rng(7)
    by_turns, turn = rng.normal(0.0, 800.0, (10, 2, 3)), np.array([0.01, -0.02, 0.005])
    mark = np.array([0] * 6 + [1, 2, 3, 4])
    shift = by_turns @ np.where(mark[:, None] > 1, turn, -turn)[..., None]
    one = laid(above(1000.0), picture(), (120.0, 70.0))
    patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in mark.tolist()]
    eye, usable = np.tile(np.eye(2), (10, 1, 1)), np.ones(10, bool)
    warps = Warps(np.zeros((10, 625, 2)), np.zeros((10, 2)), eye, by_turns, usable)
    sigma_px = np.full(10, 0.05)
    found = no_matches(10)._replace(shift=shift[..., 0], good=usable, sigma_px=sigma_px)
    agreed = agreement(warps, found, patches, np.full(10, RESIDUAL_PX))
    assert agreed is not None and agreed[1].tolist() == (mark > 1).tolist()


def test_patches_of_one_landmark_make_no_turn() -> None:
    """One, clicked twice, has moved left and another right: by their weights only the first agrees.

    Both are half the limit off the mean, and the second is 1.2 of it off the first.
    """
    one = laid(above(1000.0), picture(), (120.0, 70.0))
    patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in (0, 0, 1)]
    by_turns = np.array([[[0.0, 800.0, 0.0], [800.0, 0.0, 0.0]]] * 3)
    by_turns[2, :, 2] = [0.0, 400.0]
    warps = Warps(
        np.zeros((3, 625, 2)), np.zeros((3, 2)), np.tile(np.eye(2), (3, 1, 1)), by_turns,
        np.ones(3, bool),
    )  # fmt: skip
    shift = RESIDUAL_PX * np.array([[-0.6, 0.0], [-0.6, 0.0], [0.6, 0.0]])
    sigma_px = np.array([0.05, 0.05, 0.9])
    found = no_matches(3)._replace(shift=shift, good=np.ones(3, bool), sigma_px=sigma_px)
    limit_px = np.full(3, RESIDUAL_PX)
    assert agreement(warps, found, patches, limit_px) is None
    own = [replace(one, patch=replace(one.patch, landmark=k)) for k in range(3)]
    agreed = agreement(warps, found, own, limit_px)
    assert agreed is not None and agreed[1].tolist() == [True, True, False]


def test_how_fast_a_camera_turns_by_its_neighbours() -> None:
    """By both of the same segment, or one; not at all of a frame by itself, or of none."""
    angle_rad = np.array([0.0, 0.01, 0.04, 1.0, 1.05, 2.0, 3.0])
    attitudes = RunningAttitudes(
        Rotation.from_rotvec(np.outer(angle_rad, [0.0, 0.0, 1.0])).as_matrix(),
        np.full(7, 2), np.array([0, 0, 0, 1, 1, 2, -1]), np.arange(7) / 10.0,
    )  # fmt: skip
    rates = np.array([attitudes.turning_rad_s(frame) for frame in range(7)])
    assert_close("turn by drawn shifts", np.abs(rates[:, 2]), [0.1, 0.2, 0.3, 0.5, 0.5, 0.0, 0.0])
    assert_close("turn by drawn shifts", rates[:, :2], 0.0 * rates[:, :2])


@pytest.mark.parametrize(("times", "larger"), [(1.0, 1), (2.3, 1), (1.0, 2)])
def test_a_frame_that_has_turned(times: float, larger: int) -> None:
    """The picture of a camera that has turned by .4 degree, aligned from no turn at all.

    By 2.3 times as much it is found in the coarse level alone, and then in the fine one. Of a frame
    with twice as many pixels along its sides both levels are reduced. A tenth of the frame is
    hidden by a rail of the vehicle, which does not turn.
    """
    size = larger * SIZE[0], larger * SIZE[1]
    lens = replace(
        LENS, size_px=size, focal_px=larger * LENS.focal_px, centre_px=larger * LENS.centre_px
    )
    scene = replace(above(1000.0, 1000.0), lens=lens)
    turn = times * np.array([0.0015, -0.001, 0.006])
    after = turned_by(turn, NADIR)
    v, u = np.mgrid[: size[1], : size[0]].astype(float)
    ray, _ = scene.rays(view(1, after), np.stack([u, v], axis=-1))
    at, _ = scene.pixels(view(0, NADIR), ray)
    turned, before = (drawn(x / larger, y / larger) for x, y in ((at[..., 0], at[..., 1]), (u, v)))
    for grey in (turned, before):
        grey[:, : size[0] // 10] = drawn(2.0 * v / larger, u / larger)[:, : size[0] // 10]
    found, likeness = Alignment(scene).turn(
        view(0, NADIR), reduced(before), view(1, NADIR), reduced(turned)
    )
    assert likeness > 0.95
    assert_close("turn by whole frames", turn_between(NADIR, found), turn)


def test_a_level_begins_where_the_coarser_one_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of two levels turns by as much again, and the likeness is that of the last."""
    step, likenesses = np.array([0.001, 0.002, -0.003]), iter((0.5, 0.75))

    def turned(_: object, before: View, old: object, after: View, new: object) -> Any:
        return turned_by(step, after.rotation), next(likenesses)

    monkeypatch.setattr(Alignment, "_level", turned)
    levels: Any = ("coarse", "fine")
    scene = above(1000.0, 1000.0)
    found, likeness = Alignment(scene).turn(view(0, NADIR), levels, view(1, NADIR), levels)
    assert_close("turn by whole frames", turn_between(NADIR, found), 2.0 * step)
    assert likeness == 0.75


def test_frames_are_aligned_that_were_taken_from_other_places() -> None:
    """30 m east and 20 m higher: what is on the ground is seen elsewhere, by its distance."""
    scene = above(1000.0, 1020.0)
    scene.path.position_m[1, 1] = 30.0
    turn = np.array([0.001, -0.002, 0.004])
    after = turned_by(turn, NADIR)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    on_it = scene.ground(view(1, after), np.stack([u, v], axis=-1), 0)
    at, _ = scene.pixels(view(0, NADIR), on_it - [0.0, 0.0, 1000.0])
    turned = drawn(at[..., 0], at[..., 1])
    found, likeness = Alignment(scene).turn(
        view(0, NADIR), reduced(picture()), view(1, NADIR), reduced(turned)
    )
    assert likeness > 0.95
    assert_close("turn by whole frames", turn_between(NADIR, found), turn)


@pytest.mark.parametrize(("width", "factor"), [(361, 2), (360, 1), (720, 2), (721, 4)])
def test_frames_are_reduced_by_averaging_squares(width: int, factor: int) -> None:
    """To 360 pixels or fewer across, and again by half; what is left over is cut off."""
    grey = np.arange(9.0)[:, None] * 1000.0 + np.arange(float(width))
    coarse, fine = reduced(grey)
    assert (fine.factor, coarse.factor) == (factor, 2 * factor)
    for level in (coarse, fine):
        high, wide = 9 // level.factor, width // level.factor
        down, right = np.arange(high)[:, None], np.arange(wide)
        mean = (level.factor - 1) / 2.0
        expected = 1000.0 * (level.factor * down + mean) + level.factor * right + mean
        assert_close("grey of a reduced frame", level.grey, expected)


@pytest.mark.parametrize(
    ("wide_m", "high_m", "said"),
    [(1000.0, 29.0, 0), (1000.0, 31.0, 1), (100.0, 9.0, 0), (100.0, 11.0, 1)],
)
def test_a_terrain_is_advised_where_it_helps(wide_m: float, high_m: float, said: int) -> None:
    """From 3 percent of the landmarks' extent on, and from 10 m on."""
    told = relief_text(np.array([[0.0, 0.0, 5.0], [0.0, wide_m, 5.0 + high_m]]))
    assert len(told) == said
    if said:
        assert_approved(told[0], parts=[f"{high_m:.0f}"])


# Number by number


def shown(height_m: float, other: float = 0.0, waves: float = 0.0) -> Floats:
    """The ground from some height, with a part of another ground and with waves of 3 px."""
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    x, y = (u - 100.0) * height_m / 1000.0, (v - 80.0) * height_m / 1000.0
    grey = (1.0 - other) * drawn(100.0 + x, 80.0 + y) + other * drawn(300.0 - y, 200.0 + x)
    return np.asarray(grey + waves * np.cos(2.0 / 3.0 * np.pi * (u + v)))


@pytest.mark.parametrize("height_m", [300.0, 500.0, 850.0, 1300.0, 2000.0, 4000.0])
def test_patches_from_other_heights(height_m: float) -> None:
    """Of every size, in the middle and at edges; the camera has turned about all its axes."""
    scene = above(1000.0, height_m)
    turned = view(1, turned_by(np.array([0.002, -0.003, 0.02]), NADIR))
    said = []
    for place, side in (
        ((105.3, 83.8), 13), ((60.2, 61.0), 25), ((98.0, 80.6), 31), ((9.4, 70.0), 25),
        ((104.0, 151.2), 17),
    ):  # fmt: skip
        one = laid(scene, shown(1000.0, waves=9.0), place, side)
        warps = warp(scene, turned, [one])
        found = match(shown(height_m, 0.1), warps, [one], np.zeros((1, 2)), 4.0)
        less = {"side": one.patch.side, "corner": one.patch.corner, "size": one.patch.grey.shape}
        less |= {"spread_px": one.patch.spread_px, "weight": one.patch.weight.sum()}
        place_m = {"first_m": one.place_m[0], "last_m": one.place_m[-1], "click_m": one.clicked_m}
        said.append(whole(less | place_m | warps._replace(pixel=warps.pixel[:, ::99])._asdict()))
        said.append(whole(found, form=".5f"))
        for radius_px, least in ((8.0, 0.6), (14.0, 0.9)):
            said.append(whole(search(shown(height_m, 0.1), warps, [one], radius_px, least)))
    assert_approved("\n".join(said))


def test_what_is_just_a_match_and_what_is_not() -> None:
    """Of contrast, likeness, gain, distance, curvature and room, some values about each limit."""
    scene, start = above(1000.0, 1000.0), np.zeros((1, 2))
    v, _ = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    said = []

    def tell(name: str, first: Floats, then: Floats, least: float = 0.6, side: int = 25) -> None:
        one = laid(scene, first, (120.3, 70.8), side)
        found = match(then, warp(scene, view(1, NADIR), [one]), [one], start, 4.0, least)
        said.append(f"{name}: {whole(found._asdict(), form='.5f')}".replace("\n", ", "))

    for part in (0.06, 0.075, 0.09, 0.14, 0.2):
        little = 120.0 + part * (shown(1000.0) - 120.0)
        tell(f"contrast {part}", little, little)
        tell(f"contrast then {part}", shown(1000.0), little)
        tell(f"contrast before {part}", little, shown(1000.0))
    for part in (0.2, 0.35, 0.45, 0.5, 0.55, 0.65):
        for least in (0.6, 0.8):
            tell(f"other {part} {least}", shown(1000.0), shown(1000.0, part), least)
    for x, y in ((3.9, 0.0), (4.1, 0.0), (-2.7, 2.7), (-2.9, 2.9), (0.0, -1.5)):
        tell(f"shift {x} {y}", picture(), picture((x, y)))
    for part in (0.03, 0.05, 0.07, 0.1, 0.2, 0.5):
        along = 120.0 + 40.0 * np.tanh((v - 70.0) / 3.0) + part * (shown(1000.0) - 120.0)
        tell(f"edge {part}", along, along)
    noise = np.random.default_rng(9).normal(0.0, 6.0, SIZE[::-1])
    for side in (25, 15, 9):
        tell(f"noise {side}", picture(), picture((0.4, -0.3)) + noise, side=side)
    one = laid(scene, picture(), (120.3, 70.8))
    for axis, limits in ((0, (-0.076, 0.058)), (1, (-0.107, 0.0675))):
        for angle in np.add.outer(limits, [-0.0015, -0.0005, 0.0005, 0.0015]).ravel():
            there = warp(scene, view(1, turned_by(angle * np.eye(3)[axis], NADIR)), [one]).inside
            said.append(f"room {axis} {angle:.4f}: {there.tolist()}")
    sides = [cut_patch(picture(), 0, 0, 0, np.array([x, 80.0]), 25) for x in np.arange(5.0, 16.0)]
    said.append(f"sides {[one and one.side for one in sides]}")
    sides = [cut_patch(picture(), 0, 0, 0, np.array([90.0, y]), 9) for y in np.arange(150.0, 160.0)]
    said.append(f"sides {[one and one.side for one in sides]}")
    assert_approved(said)


def test_places_that_are_nearly_as_good() -> None:
    """Ground that repeats after some pixels, with a difference; near an edge, too."""
    scene = above(1000.0, 1000.0)
    v, u = np.mgrid[: SIZE[1], : SIZE[0]].astype(float)
    said = []
    for period in (6.0, 12.0, 15.0, 22.0):
        for part in (0.1, 0.3, 0.5):
            waves = np.sin(2.0 * np.pi * u / period) + np.sin(2.0 * np.pi * v / period)
            grey = 120.0 + 25.0 * waves + part * (shown(1000.0) - 120.0)
            for side in (13, 25):
                one = laid(scene, grey, (120.3, 70.8), side)
                warps = warp(scene, view(1, turned_by([0.004, -0.007, 0.0], NADIR)), [one])
                shift, several = search(grey, warps, [one], 16.0)
                said.append(f"{period} {part} {side}: {whole(shift, 'shift')} {several}")
    assert_approved(said)


@pytest.mark.parametrize("larger", [1, 2, 4])
def test_aligned_frames_number_by_number(larger: int) -> None:
    """Alike, brighter, partly or wholly of another ground, far apart, from another place."""
    size = larger * SIZE[0], larger * SIZE[1]
    lens = replace(
        LENS, size_px=size, focal_px=larger * LENS.focal_px, centre_px=larger * LENS.centre_px,
        k=np.array([-12.0 * (larger == 4), *np.zeros(11)]),  # its corners are no image then
    )  # fmt: skip
    scene = replace(above(1000.0, 1010.0), lens=lens)
    scene.path.position_m[1, 1] = 7.0
    v, u = np.mgrid[: size[1], : size[0]] / larger
    before, beside = drawn(u, v), np.arange(size[0]) < size[0] // 4
    noise = np.random.default_rng(4).normal(0.0, 8.0, before.shape)
    said = []
    frames = (
        ("alike", drawn(u + 2.0, v - 1.5), [0.0, 0.002, 0.0]),
        ("alike", drawn(u + 2.0, v - 1.5), [0.001, 0.003, -0.02]),
        ("brighter", 40.0 + 0.6 * drawn(u + 3.0, v) + noise, [0.0, 0.0, 0.0]),
        ("a quarter is other", np.where(beside, drawn(v, u), drawn(u + 6.0, v)), [0.0, 0.0, 0.0]),
        ("nine tenths are other", np.where(v < 145, drawn(v, u), drawn(u + 6.0, v)), [0.0] * 3),
        ("black", 0.0 * u, [0.0, 0.0, 0.0]),
        ("darker", 0.1 * drawn(u + 5.0, v), [0.0, 0.0, 0.0]),
        ("half", drawn(u - 93.0, v), [0.0, 0.101, 0.0]),
        ("a quarter", drawn(u - 140.0, v), [0.0, 0.146, 0.0]),
        ("a sixth", drawn(u - 155.0, v), [0.0, 0.161, 0.0]),
        ("nothing", drawn(u - 175.0, v), [0.0, 0.181, 0.0]),
    )
    for name, after, first in frames[: 7 if larger == 4 else None]:
        found, likeness = Alignment(scene).turn(
            view(0, NADIR), reduced(before), view(1, turned_by(first, NADIR)), reduced(after)
        )
        turn = turn_between(NADIR, found)
        said.append(f"{name}: {whole(turn, 'turn')}, {whole(likeness, 'alike')}")
    assert_approved(said)


@pytest.mark.parametrize("terrain", [None, Rising(), Rising(2), Falling()])
@pytest.mark.parametrize("way", ["down", "left"])
def test_an_oblique_view_number_by_number(terrain: Any, way: Any) -> None:
    """Of four landmarks, one of them beside and one high above the others, by moving rows."""
    scene = above(700.0, 710.0, shutter=Shutter(0.05, way, True))
    marks = np.array([EARTH_M, 0.0, 0.0]) + np.array(
        [
            [0.0, -11.0, -440.0],
            [30.0, 60.0, -500.0],
            [-20.0, -120.0, -380.0],
            [650.0, -20.0, -900.0],
        ]
    )
    scene = replace(
        scene, landmarks=LandmarkSet(tuple("abcd"), marks, np.zeros((4, 3))),
        refraction=Refraction(0.2, False), terrain=terrain, mount=DOWNWARD,
        path=replace(scene.path, lever_arm_m=np.array([1.0, -2.0, 0.5])),
    )  # fmt: skip
    tilted = turned_by(np.array([0.55, 0.1, 0.3]), NADIR)
    looks = View(1, tilted, np.array([0.1, -0.2, 0.3]), scene.velocity_m_s(1))
    pixel = np.array([[0.0, 0.0], [200.0, 0.0], [100.0, 80.0], [20.0, 160.0], [180.0, 150.0]])
    with np.errstate(all="ignore"):
        grounds = [scene.ground(looks, pixel, mark) for mark in range(4)]
    away = scene.landmark_m + scene.raised_m(1) - scene.camera_m(1, tilted)
    assert_approved(
        whole({
            "landmark_m": scene.landmark_m, "up": scene.up, "raised_m": scene.raised_m(1),
            "camera_m": scene.camera_m(1, tilted), "velocity_m_s": scene.velocity_m_s(1),
            "late_s": scene.late_s(pixel), "pixels": list(scene.pixels(looks, away)),
            "rays": list(scene.rays(looks, pixel)), "ground_m": grounds,
        }, form=".5f")
    )  # fmt: skip


@pytest.mark.parametrize("count", [6, 14, 40])
@pytest.mark.parametrize("late", [False, True])
def test_agreements_number_by_number(count: int, late: bool) -> None:
    """Shifts with errors as large as their limits, of landmarks with one click or several."""
    one = laid(above(1000.0), picture(), (120.0, 70.0))
    said = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        mark = rng.integers(0, 3 + count // 3, count)
        patches = [replace(one, patch=replace(one.patch, landmark=k)) for k in mark.tolist()]
        by_turns = rng.normal(0.0, 800.0, (count, 2, 3)) + 600.0
        sigma_px = rng.uniform(0.05, 0.8, count)
        shift = by_turns @ rng.normal(0.0, 0.02, 3) + rng.normal(0.0, 0.45, (count, 2))
        shift[rng.random(count) < 0.3] += 4.0
        part = rng.uniform(-0.5, 0.5, count) if late else None
        eye = np.tile(np.eye(2), (count, 1, 1))
        warps = Warps(np.zeros((count, 9, 2)), np.zeros((count, 2)), eye, by_turns, mark >= 0)
        good = rng.random(count) < 0.9
        found = no_matches(count)._replace(shift=shift, good=good, sigma_px=sigma_px)
        agreed = agreement(warps, found, patches, rng.uniform(0.7, 1.0, count), part)
        said.append(whole(agreed, "none" if agreed is None else "", 7))
    assert_approved("\n".join(said))
