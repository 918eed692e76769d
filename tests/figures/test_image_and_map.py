"""The photograph with its landmarks, and the map: by the files of an example."""

from __future__ import annotations

import base64
import csv
import io
import json
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation
from PIL import Image

from tests.approved.texts import assert_approved
from tests.kit import wgs84_film
from tests.kit.command import ROOT, peak, vopd
from tests.kit.figures import labelled, points
from tests.kit.flight_project import TOML, write_project
from tests.kit.histories import histories, with_estimate
from tests.kit.joint_flights import LensTruth, drone, flight_of
from tests.kit.video import number_of, write_video
from tests.tolerances import assert_close, within
from vopd.attitude.history import History
from vopd.attitude.history import history as from_estimate
from vopd.errata import fixes
from vopd.figures import draw, patches
from vopd.figures.image import chosen
from vopd.figures.map import LOOKS_UP, MISSES, STEPS, ground
from vopd.figures.style import doubts_text, place_names
from vopd.film import film_estimate
from vopd.findings import VopdError
from vopd.flight.result import solve_flight, solve_flight_read
from vopd.flight.solve.equations import Priors
from vopd.geometry.earth import earth_centred_m, geodetic
from vopd.pipeline import run
from vopd.program.vopd import run as solve
from vopd.report import embedded_photographs
from vopd.report.answer import doubts
from vopd.report.frames import frames_json

HILL = ROOT / "examples" / "hill"


@cache
def hill() -> History:
    return solve_flight(HILL / "flight.toml").history()


def panel(name: str, history: History, **given: Any) -> tuple[Any, str]:
    figure = draw(name, [history], 0, **given)
    (part,) = figure.subfigs
    return part.axes[0], part.get_suptitle()


def picks_of(frame: str) -> dict[str, list[float]]:
    with (HILL / "picks.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {
        row["landmark"]: [float(row["u_px"]), float(row["v_px"])]
        for row in rows
        if row["frame"] == frame
    }


def test_an_azimuth_whose_label_would_leave_the_picture_is_not_named() -> None:
    """In frame 2 of 1920 pixels 40 degrees is at 1899."""
    figure = draw("image", [hill()], 2, photograph=False)
    named = {text.get_text() for text in figure.subfigs[0].axes[0].texts}
    assert {"340°", "030°"} <= named and "040°" not in named


def test_picks_stand_in_the_photograph_s_own_pixels() -> None:
    """u right and v down, within the border of the image; arrows from the computed places."""
    picture = Image.new("RGB", (1920, 1080), "teal")
    axis, said = panel("image", hill(), photograph=lambda number, name: picture)
    (drawn,) = axis.images
    assert drawn.get_extent() == [-0.5, 1919.5, 1079.5, -0.5]
    assert axis.get_xlim()[0] < axis.get_xlim()[1] and axis.get_ylim()[0] > axis.get_ylim()[1]
    lines, picks = labelled(axis), picks_of("0")
    assert sorted(points(lines["picked"])) == sorted(picks.values())
    residual = hill().estimate.residual_xy[0]  # x to the left, y up
    computed = np.array(points(lines["picked"]), float) + residual
    assert_close("flight pixel", np.array(points(lines["computed"]), float), computed)
    (arrows,) = (one for one in axis.collections if isinstance(one, Quiver) and len(one.U) > 1)
    assert_close("flight pixel", np.column_stack([arrows.X, arrows.Y]), computed)
    assert_close("flight pixel", np.column_stack([arrows.U, arrows.V]), -residual)
    assert {text.get_text() for text in axis.texts} >= {*picks, "000° N"}
    assert "times as long" in said and "no photograph" not in said
    assert "not the size" not in said  # of 1920 pixels, of which 1600 are shown
    larger = Image.new("RGB", (3840, 2160))
    assert "3840 x 2160: not the size" in panel("image", hill(), photograph=lambda *_: larger)[1]


def test_photographs_of_a_video_are_read_once_each(tmp_path: Path) -> None:
    """In one pass; of frames that it does not have, behind them, the error of each."""
    write_video(tmp_path / "flight.mp4", range(0, 500, 100))
    named = TOML.replace("[picks]\n", '[picks]\nvideo = "flight.mp4"\n')
    estimate = solve_flight(write_project(tmp_path, named)).history().estimate
    scene = estimate.scene() if estimate.scene else None
    assert scene is not None and scene.photographs is not None
    found = list(scene.photographs([(one, "") for one in (2, 0, 9, 1)]))
    assert [place for place, _ in found] == [1, 3, 0, 2]
    shown = [number_of(picture) for _, picture in found[:3]]
    assert_close("frame by its grey level", shown, [0.0, 1.0, 2.0])
    assert isinstance(found[3][1], VopdError)


@pytest.mark.usefixtures("not_laid_out")
def test_picks_outside_the_image_are_named(tmp_path: Path) -> None:
    """They end half a pixel beyond the last one; three are named."""
    shutil.copytree(HILL, tmp_path / "hill")
    project = tmp_path / "hill" / "flight.toml"
    text = project.read_text(encoding="utf-8")
    width = 800
    assert "[1920, 1080]" in text
    project.write_text(text.replace("[1920, 1080]", f"[{width}, 1080]"), encoding="utf-8")
    outside = [name for name, (u, _) in picks_of("0").items() if u > width - 0.5]
    assert len(outside) > 3
    _, said = panel("image", solve_flight(project).history(), photograph=False)
    said = " ".join(said.split())
    assert f"{len(outside)} picks outside the image: " in said
    names = said.partition("outside the image: ")[2].partition(", ...")[0].split(", ")
    assert len(names) == 3 and {*names} <= {*outside}
    *_, (u, third), (_, second), (_, last) = sorted((u, n) for n, (u, _) in picks_of("0").items())
    project.write_text(text.replace("[1920, 1080]", f"[{int(u)}, 1080]"), encoding="utf-8")
    _, said = panel("image", solve_flight(project).history(), photograph=False)
    said, _, arrows = said.rpartition("\n")
    said, _, names = " ".join(said.split()).partition("3 picks outside the image: ")
    assert {*names.replace(",", " ").split()} == {third, second, last} and "..." not in names
    assert arrows.startswith("arrows")


@pytest.mark.usefixtures("not_laid_out")
def test_a_photograph_is_found_by_its_name(tmp_path: Path) -> None:
    """In a folder within that of the project, or in that of --images; else the title says so."""
    shutil.copytree(ROOT / "examples" / "summits", tmp_path / "post")
    project, name = tmp_path / "post" / "flight.toml", "2026-05-01_0900.jpg"
    one = solve_flight(project).history()
    assert (
        f"{name} is not in the project's folder" in draw("image", [one]).subfigs[0].get_suptitle()
    )
    for folder in ("post/photographs", "elsewhere"):
        (tmp_path / folder).mkdir()
        Image.new("RGB", (40, 30)).save(tmp_path / folder / name)
    assert draw("image", [one]).subfigs[0].axes[0].images
    made = tmp_path / "a.svg"
    images = ("--figure", "image", "--images", tmp_path / "elsewhere")
    assert vopd("plot", project, "-o", made, *images).status == 0
    assert "40 x 30: not the size" in " ".join(made.read_text().split())


@pytest.mark.usefixtures("not_laid_out")
def test_a_photograph_is_found_by_its_number(tmp_path: Path) -> None:
    """Of a folder of numbered images: that of --images, or [picks] video of the project."""
    shutil.copytree(ROOT / "examples" / "hill", tmp_path / "hill")
    project, folder, made = (
        tmp_path / "hill" / "flight.toml",
        tmp_path / "frames",
        tmp_path / "a.svg",
    )
    folder.mkdir()
    for frame in (1, 3, 4):
        Image.new("RGB", (40 + frame, 30)).save(folder / f"frame_{frame:04d}.png")
    for given in (("--images", folder), ()):
        if not given:
            text = project.read_text()
            project.write_text(text.replace("[picks]", '[picks]\nvideo = "../frames"'))
            found, why = embedded_photographs([solve_flight(project).history()])
            assert [frame for frame, _ in found] == [1, 3, 4] and "frame 0" in why
        for frame in range(5) if given else (2, 3):
            options = ("--figure", "image", "--frame", str(frame), *given)
            ran = vopd("plot", project, "-o", made, *options)
            assert ran.status == 0
            said = " ".join(made.read_text().split())
            assert (f"{40 + frame} x 30: not the size" in said) == (frame in (1, 3, 4))


def test_photographs_of_a_report_are_reduced() -> None:
    scene: Any = SimpleNamespace(
        photographs=lambda names: [(k, Image.new("L", (3000, 1500))) for k in range(len(names))]
    )
    found, why = embedded_photographs([with_estimate(hill(), scene=lambda: scene)])
    assert embedded_photographs([with_estimate(hill(), scene=None)])[0] == []
    assert_approved(embedded_photographs([with_estimate(hill(), scene=None)])[1])
    sizes = {Image.open(io.BytesIO(base64.b64decode(one))).size for _, one in found}
    assert ([frame for frame, _ in found], sizes, why) == ([0, 1, 2, 3, 4], {(1024, 512)}, "")
    angles_deg = hill().estimate.vehicle_deg.copy()
    angles_deg[1] = np.nan
    lost = with_estimate(hill(), scene=lambda: scene, vehicle_deg=angles_deg)
    numbers = [frame for frame, _ in embedded_photographs([lost, lost])[0]]
    assert numbers == [0, 2, 3, 4, 5, 7, 8, 9]  # those of the second are counted on
    scene.photographs = lambda names: [(len(names) - 1, VopdError("is gone"))]
    assert "frame 4: is gone" in embedded_photographs([lost])[1]


def test_landmarks_that_are_ignored_have_no_line_of_sight() -> None:
    """Of four in each frame one is, and two in the first."""
    deck = ROOT / "tests" / "approved" / "inputs" / "ignored_frames.dat"
    (film,) = run(deck).histories()
    e = film.estimate
    assert e.scene is not None
    scene, counts = e.scene(), [2, 0, 3, 3, 3]
    assert [len(scene.sight(int(one), "")[0]) for one in e.frame] == counts
    for k in (0, 2):
        seen = [scene.names[one] for one in scene.sight(int(e.frame[k]), "")[0]]
        assert seen == [str(one) for one in e.landmark[k][e.used[k]]]
    picks = json.loads(frames_json([film]))["jobs"][0]["picks"]
    assert picks["count"] == counts
    for name, mm in zip(("du", "dv"), e.residual_xy[0, 2:].T, strict=True):  # on the page in µm
        assert picks[name][:2] == np.round(1000.0 * mm, 2).tolist()


def test_lines_of_sight_meet_their_landmarks() -> None:
    """To a metre: the picks are of the third of a pixel at some hundred metres."""
    axis, said = panel("map", hill())
    marks = np.array(points(labelled(axis)["landmark picked in this frame"]), float)
    names = hill().estimate.landmark_names
    assert len(marks) == len(names) and "miss" not in said
    ends = np.array([one.get_xydata()[-1] for one in axis.lines if len(one.get_xdata()) == STEPS])
    apart_m = np.linalg.norm(ends[:, None] - marks, axis=2).min(axis=1)
    assert len(ends) == len(marks) and apart_m.max() < 1.0


@pytest.mark.parametrize(
    ("clicks", "wrong", "strip"),
    [
        ([1, 6], [], "1 click, 6 click, 8 found, 12 found"),  # 6 is half way between 4 and 8
        ([1, 10], [], "1 click, 4 found, 10 click, 12 found"),
        ([3, 5], [], "3 click, 0 found, 8 found, 12 found"),
        ([1, 2, 7], [2], "1 click, 2 wrong, 4 found, 7 click"),
        ([2], [2], "2 wrong, 4 found, 8 found, 12 found"),
        ([1, 2, 7], [1], "2 click, 1 wrong, 7 click, 12 found"),
    ],
)
def test_a_strip_has_the_clicks_near_its_places(
    clicks: list[int], wrong: list[int], strip: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 13 frames four places: 0, 4, 8, 12; a click stands for the first as near as half way.

    A wrong one goes before others, and the first good one stands at the left. One in a frame
    without an attitude has no patch. The scene has 20 frames more, before the history's.
    """
    monkeypatch.setattr(patches, "camera_index", lambda history, k, scene: k + 20)
    history: Any = SimpleNamespace(estimate=None, has_attitude=np.ones(13, bool))
    at = np.array([*clicks, 13])
    every = at + 20, np.zeros(len(at), int), np.zeros((len(at), 2)), np.isin(at, wrong)
    scene: Any = SimpleNamespace(clicks=lambda: every)
    (found,) = patches._strips(history, scene, 4).values()
    assert ", ".join(f"{one.k} {one.kind}" for one in found) == strip


def test_patches_are_alike_whatever_their_light() -> None:
    """The correlation of brightness; none of a patch without contrast, or beyond the picture."""
    one = np.random.default_rng(1).normal(size=(patches.SIDE, patches.SIDE))
    for other, alike in ((2.0 * one + 3.0, 1.0), (-one, -1.0), (one * 0.0, np.nan),
                         (one * np.nan, np.nan)):  # fmt: skip
        assert_close("ratio", patches._correlation(one, other), alike)


def test_patches_of_picks_are_of_frames_over_the_whole_flight() -> None:
    """All five frames have all six landmarks; each patch is that of its frame's own photograph."""
    grey = np.random.default_rng(1).integers(0, 255, (1080, 1920), dtype=np.uint8)
    pictures = {k: Image.fromarray(np.roll(grey, k, axis=1)) for k in range(5)}

    def read(number: int, name: str) -> Any:
        return pictures[number]

    odd = np.zeros_like(hill().estimate.used)
    odd[2, 0] = True
    axis, said = panel("patches", with_estimate(hill(), outlier=odd), photograph=read)
    assert [one.get_text()[0] for one in axis.texts if one.get_fontweight() == "bold"] == ["2"]
    narrow = Figure(figsize=(3.0, 5.0))
    patches.draw_patches(narrow, [hill()], None, read)
    assert len(narrow.axes[0].patches) == 4 * 6
    assert [one.get_text() for one in axis.get_yticklabels()] == list(picks_of("0"))
    boxes = [(box.get_x(), box.get_y()) for box in axis.patches]
    assert len({*boxes}) == len(boxes) == 30
    shown = [text.get_text().split()[0] for text in axis.texts]
    assert shown == ["0", "1", "2", "3", "4"] * 6
    assert "blue border" not in said and "not found: where it should be" in said


def test_patches_hold_a_byte_a_pixel_of_each_photograph() -> None:
    """Of five frames; eight bytes a pixel were gigabytes of those of a survey."""
    picture = Image.new("L", (1920, 1080))
    used = peak(lambda: panel("patches", hill(), photograph=lambda number, name: picture))
    assert used < 5 * 1920 * 1080 * 4


def test_true_north_on_the_map_of_a_grid() -> None:
    """It is to the left of the grid's by sin(latitude) of the degrees east of the meridian, 15."""
    history = solve_flight(ROOT / "examples" / "summits" / "flight.toml").history()
    assert history.estimate.scene is not None
    camera = geodetic(history.estimate.scene().camera_m[:1])
    east_deg = float(camera.longitude_deg[0]) - 15.0
    axis = draw("map", [history]).subfigs[0].axes[0]
    (north,) = (one for one in axis.texts if one.get_text() == "N")
    right, up = -np.array(north.xyann)
    expected = -np.sin(np.radians(camera.latitude_deg[0])) * east_deg
    assert abs(expected) > 2.0 * within("true north on a map")
    assert_close("true north on a map", np.degrees(np.arctan2(right, up)), expected)


def test_the_arrow_of_a_picture_from_above_points_to_true_north() -> None:
    """From its foot to its head and on to the N: as the truth's ray in the picture's middle moves.

    A pinhole has the images of a ray that is moved north by any length on one line.
    """
    scene = drone(np.random.default_rng(1), 6, 8)
    history = solve_flight_read(
        flight_of(np.random.default_rng(2), scene, 0.01, Priors())
    ).history()
    axis = draw("image", [history], 2).subfigs[0].axes[0]
    (letter,) = (one for one in axis.texts if one.get_text() == "N")
    (arrow,) = (
        one for one in axis.texts if isinstance(one, Annotation) and one.arrow_patch and one.xyann
    )
    head, foot = np.array(arrow.xy), np.array(arrow.xyann)
    style = arrow.arrow_patch.get_arrowstyle()
    assert style.arrow.endswith(">") and not style.arrow.startswith("<")
    moved = scene.rotation[2].T[:, 2] + [0.0, 0.01, 0.0]  # east, north, up
    north = LensTruth().image(scene.rotation[2] @ moved) - LensTruth().image(np.eye(3)[2])
    for way in (head - foot, np.array(letter.get_position()) - foot):
        off = np.arctan2(north[0] * way[1] - north[1] * way[0], north @ way)
        assert_close("true north on a map", np.degrees(off), 0.0)


def test_the_side_view_is_along_an_azimuth_from_true_north() -> None:
    """The mean of the ways to the landmarks, on the plane at the camera; as in the report."""
    history = solve_flight(ROOT / "examples" / "summits" / "flight.toml").history()
    assert history.estimate.scene is not None
    scene = history.estimate.scene()
    own, marks = geodetic(scene.camera_m[:1]), geodetic(scene.landmark_m)
    north = marks.latitude_deg - own.latitude_deg
    east = (marks.longitude_deg - own.longitude_deg) * np.cos(np.radians(own.latitude_deg))
    north, east = (np.sum(one / np.hypot(north, east)) for one in (north, east))
    expected = np.degrees(np.arctan2(east, north)) % 360.0
    side = draw("map", [history]).subfigs[0].axes[1]
    assert f"toward {expected:.0f}° from true north" in side.get_xlabel()
    assert {text.get_text() for text in side.texts} == set(scene.names)
    (job,) = json.loads(frames_json([history]))["jobs"]
    east_deg = float(own.longitude_deg[0]) - 15.0
    convergence = np.sin(np.radians(own.latitude_deg[0])) * east_deg
    assert_close("true north on a map", job["convergence"], convergence)
    assert scene.plane is not None and job["origin"][0] == 396167.0
    easting = job["origin"][0] + np.array(job["places"]["east_m"])
    assert_close("miss on a map", easting, scene.plane(scene.landmark_m)[0][:, 0])


def test_a_camera_below_its_landmarks_has_a_sector_in_place_of_ground() -> None:
    """From the camera on, between the azimuths of its picture: 4000 px of 35 mm, 35.9 wide."""
    history = solve_flight(ROOT / "examples" / "summits" / "flight.toml").history()
    axis = draw("map", [history]).subfigs[0].axes[0]
    (sector,) = (one for one in axis.patches if one.get_label() == LOOKS_UP)
    corners = sector.get_xy()
    (camera,) = labelled(axis)["camera of this frame"].get_xydata()
    assert_close("miss on a map", corners[0], camera)
    ways = corners[1:-1] - camera
    azimuth = np.degrees(np.arctan2(ways[:, 0], ways[:, 1]))
    half = np.degrees(np.arctan(35.9 / 2.0 / 35.0))  # and more in the corners, by the pitch
    assert half < np.ptp(azimuth) / 2.0 < half + 2.0


def test_a_view_above_the_horizon_meets_no_ground() -> None:
    """Of a camera 100 m above its landmarks: rays upward, and one that goes down."""
    camera_m = np.array([6378137.0, 0.0, 0.0])
    axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # east, north, up
    marks = camera_m + np.array([[-100.0, 0.0, 300.0], [-100.0, 50.0, 300.0]])
    up = np.array([[0.0, 0.8, 0.6], [0.6, 0.0, 0.8]])
    assert ground(up, marks, camera_m, axes, 320.0) == (None, False)
    met, endless = ground(np.array([[0.0, 0.8, -0.6], up[0]]), marks, camera_m, axes, 320.0)
    assert met is not None and endless
    assert_close("miss on a map", met[0] - camera_m, [-100.0, 0.0, 400.0 / 3.0])


@pytest.mark.parametrize("azimuth_deg", [45.0, 270.0])
def test_a_sector_is_about_the_way_of_its_view(azimuth_deg: float) -> None:
    """Of 60 degrees, from the camera on, as wide to either side."""
    camera_m = np.array([6378137.0, 0.0, 0.0])
    axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # east, north, up
    border = np.radians(azimuth_deg + np.array([-30.0, 30.0]))
    up = np.stack([0.8 * np.sin(border), 0.8 * np.cos(border), [0.6, 0.6]], axis=1)
    marks = camera_m + np.array([[100.0, 0.0, 300.0]])
    met, endless = ground(up, marks, camera_m, axes, 320.0)
    assert met is not None and not endless
    east, north = (met[1:] - camera_m).T[1:]
    found_deg = np.degrees(np.arctan2(east, north)) % 360.0
    expected_deg = azimuth_deg + np.linspace(30.0, -30.0, 30)
    assert_close("rotation on a page", found_deg, expected_deg)


def test_heights_are_not_drawn_smaller_than_distances() -> None:
    """Of case 4, 37 km above landmarks that are 10 km away."""
    (history,) = histories("appendix_h/case4")
    figure = draw("map", [history])
    figure.draw_without_rendering()
    (part,) = figure.subfigs
    axis = part.axes[1]
    box = axis.get_window_extent()
    per = [box.width / np.ptp(axis.get_xlim()), box.height / np.ptp(axis.get_ylim())]
    assert 0.8 < per[1] / per[0] < 1.25  # labels take what the figure did not foresee
    assert part.get_suptitle().endswith("to scale")


def test_a_map_of_far_landmarks_is_in_kilometres_but_on_a_grid() -> None:
    """Those of case 4 are 40 km away; a grid, here of Earth-centred x and y, is in metres."""
    (history,) = histories("appendix_h/case4")
    assert history.estimate.scene is not None
    scene = history.estimate.scene()
    on_grid = replace(scene, crs="EPSG:9", plane=lambda m: (m[:, :2], np.zeros(len(m))))
    east_m = []
    for own, unit, per_m in ((scene, "km", 1000.0), (on_grid, "m", 1.0)):
        estimate = replace(history.estimate, scene=lambda own=own: own)
        axis, side = draw("map", [replace(history, estimate=estimate)]).subfigs[0].axes
        labels = axis.get_xlabel(), axis.get_ylabel(), side.get_xlabel(), side.get_ylabel()
        assert all(one.endswith(f", {unit}") for one in labels)
        east_m.append(np.ptp(axis.get_xlim()) * per_m)
    assert 0.2 < east_m[0] / east_m[1] < 5.0


def test_the_report_s_lines_of_sight_miss_as_those_of_the_figure_do() -> None:
    """Case 1: by 811 m at most, of landmark 65."""
    (history,) = histories("appendix_h/case1")
    said = " ".join(draw("map", [history]).subfigs[0].get_suptitle().split())
    assert "most 65: 811 m" in said
    (job,) = json.loads(frames_json([history]))["jobs"]
    ends = np.transpose([job["missed"][one] for one in ("east_m", "north_m", "height_m")])
    marks = np.transpose([job["places"][one] for one in ("east_m", "north_m", "height_m")])
    of = [job["picks"]["landmark"][one] for one in job["missed"]["pick"]]
    miss_m = np.linalg.norm(ends - marks[of], axis=1)
    assert [job["names"][one] for one in of].index("65") == int(miss_m.argmax())
    assert len(of) == 3
    assert_close("miss on a map", miss_m.max(), 811.0)


@cache
def from_above() -> tuple[History, Any]:
    """A film over New Mexico from a camera that looks down, and its true angles."""
    job, truth = wgs84_film.film(33.08, -106.33, decimals=None)
    return from_estimate(film_estimate(solve(job, fixes("all")))), truth


def test_the_way_north_on_a_film() -> None:
    one, truth = from_above()
    axes = wgs84_film.camera_matrix(*truth[0])  # x to the left, y up
    figure = draw("image", [one], 1)
    (arrow,) = (one for one in figure.subfigs[0].axes[0].texts if not one.get_text())
    way = np.subtract(arrow.xy, arrow.xyann)
    assert_close("way north", way / np.hypot(*way), axes[:2, 1] / np.hypot(*axes[:2, 1]))
    (job,) = json.loads(frames_json([one]))["jobs"]
    shown = [job["north"]["u"][0], job["north"]["v"][0]]
    assert_close("way north", shown, -way / np.hypot(*way))  # to the right, down
    assert set(job["horizon"]["count"]) == {0}


def test_the_horizon_of_a_film() -> None:
    """Of a camera that looks toward azimuth 30 degrees, 8 below level, turned by 20."""
    one, _ = from_above()
    estimate = one.estimate
    assert estimate.scene is not None
    scene, axes = estimate.scene(), wgs84_film.camera_matrix(30.0, -8.0, 20.0)
    assert scene.film is not None
    corners, computed, _ = scene.film(np.arange(wgs84_film.FRAMES))
    turned = np.tile(axes, (wgs84_film.FRAMES, 1, 1))

    def film(indices: Any) -> Any:
        return corners[indices], computed[indices], turned[indices]

    one = with_estimate(one, scene=lambda: replace(scene, film=film))
    camera, marks = geodetic(scene.camera_m), geodetic(scene.landmark_m)
    dip = np.sqrt(2.0 * (camera.height_m - marks.height_m.min()) * 0.87 / 6371e3)

    def seen(places: Any) -> tuple[Any, Any]:
        ray = np.column_stack([places, np.full(len(places), estimate.focal_length)]) @ axes
        azimuth = np.degrees(np.arctan2(ray[:, 0], ray[:, 1]))
        return azimuth, np.degrees(np.arctan2(ray[:, 2], np.hypot(*ray.T[:2])))

    axis = draw("image", [one], 1).subfigs[0].axes[0]
    line = np.array(points(labelled(axis)["horizon"]), float)
    azimuth, elevation = seen(line[np.isfinite(line).all(axis=1)])
    assert_close("horizon of a film", elevation, np.full(len(elevation), -np.degrees(dip[0])))
    assert azimuth.min() < 20.0 < 40.0 < azimuth.max()
    assert {"020°", "040°"} <= {text.get_text() for text in axis.texts}
    (job,) = json.loads(frames_json([one]))["jobs"]
    horizon, at = job["horizon"], 0
    assert min(horizon["count"]) > 6
    for k, count in enumerate(horizon["count"]):
        own = np.transpose([horizon[name][at : at + count] for name in "uv"])
        azimuth, elevation = seen(own)
        along = horizon["first"][k] + horizon["step"][k] / 2.0 * np.arange(count)
        assert_close("horizon of a film", azimuth, along)
        assert_close("horizon of a film", elevation, np.full(count, -np.degrees(dip[k])))
        at += count


def test_the_second_flight_s_photographs_stand_behind_the_first_s(tmp_path: Path) -> None:
    """Frames are counted through: five of the first, then those of the second."""
    shutil.copytree(HILL, tmp_path / "hill")
    (tmp_path / "frames").mkdir()
    for frame in (1, 4):
        Image.new("RGB", (40, 30)).save(tmp_path / "frames" / f"{frame}.png")
    project = tmp_path / "hill" / "flight.toml"
    text = project.read_text()
    project.write_text(text.replace("[picks]", '[picks]\nvideo = "../frames"'))
    history = solve_flight(project).history()
    found, _ = embedded_photographs([hill(), history])
    assert [frame for frame, _ in found] == [6, 9]


def test_heights_in_feet_are_seen() -> None:
    """Of landmarks 3.28 times as high the lines of sight pass below."""
    estimate = hill().estimate
    assert estimate.scene is not None
    scene = estimate.scene()
    where = geodetic(scene.landmark_m)
    high = earth_centred_m(where.latitude_deg, where.longitude_deg, where.height_m / 0.3048)
    raised = replace(scene, landmark_m=high)
    axis, said = panel("map", with_estimate(hill(), scene=lambda: raised))
    assert "6 lines of sight that miss their landmarks" in said
    assert MISSES in labelled(axis)
    away = scene.landmark_m - scene.camera_m[0]
    nearest, *_, farthest = np.argsort(np.linalg.norm(away, axis=1))
    moved = scene.landmark_m.copy()
    aside = np.cross(away[nearest], away[farthest])
    moved[nearest] += 0.012 * np.linalg.norm(away[nearest]) * aside / np.linalg.norm(aside)
    _, said = panel("map", with_estimate(hill(), scene=lambda: replace(scene, landmark_m=moved)))
    assert "1 line of sight that misses its landmark" in " ".join(said.split())


def test_a_tracked_frame_that_fits_worst_is_shown_and_none_with_a_click() -> None:
    worst, second = np.argsort(-hill().residual_rms)[:2]
    scene: Any = SimpleNamespace(clicks=lambda: (np.array([worst]),))
    assert chosen([with_estimate(hill(), scene=lambda: scene)], None)[1] == second


def test_a_check_landmark_is_no_misfit_and_one_without_a_pick_is_named_last(tmp_path: Path) -> None:
    """On the image the check landmark is not used; on the map names of picks have room first."""
    project = shutil.copytree(HILL, tmp_path / "p") / "flight.toml"
    first, second, *_ = picks_of("0")
    project.write_text(f'{project.read_text()}\n[solve]\ncheck_landmarks = ["{second}"]\n')
    rows = (tmp_path / "p" / "picks.csv").read_text().splitlines()
    left = [row for row in rows if not row.startswith(f"0,{first},")]
    (tmp_path / "p" / "picks.csv").write_text("\n".join(left))
    one = solve_flight(project).history()
    drawn = labelled(panel("image", one, photograph=False)[0])
    assert len(points(drawn["picked, not used"])) == 1 and "does not fit" not in drawn
    named = [text.get_text() for text in panel("map", one)[0].texts]
    assert [name for name in named if name in picks_of("0")][-1] == first


@pytest.mark.usefixtures("not_laid_out")
def test_a_pdf_has_a_page_a_figure(tmp_path: Path) -> None:
    made = tmp_path / "a.pdf"
    which = ("--figure", "image", "--figure", "map")
    assert vopd("plot", HILL / "flight.toml", "-o", made, *which).status == 0
    assert b"/Count 2" in made.read_bytes()
    assert b"CreationDate" not in made.read_bytes()  # the same file again has the same bytes


@pytest.mark.parametrize("count", [2, 60])
@pytest.mark.parametrize("upward", [1.0, -1.0])
def test_names_do_not_cover_each_other(upward: float, count: int) -> None:
    """Those that have no room are left out, and counted; also where y grows downward."""
    figure = Figure(figsize=(6.0, 6.0), dpi=72)
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axis.set(xlim=(0.0, 432.0), ylim=(0.0, 432.0)[:: int(upward)])
    at = np.random.default_rng(3).uniform(150.0, 280.0, (count, 2))
    names, whole = [f"landmark {k}" for k in range(count)], np.array([[0.0, 0.0], [432.0, 432.0]])
    left_out = place_names(axis, at, names, np.array([1.0, upward]), whole)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in axis.texts]
    assert len(boxes) == count - left_out and (left_out > 0) == (count > 2)
    for k, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[:k])


@pytest.mark.parametrize("at", [(429.0, 429.0), (216.0, 431.0), (431.0, 216.0)])
def test_names_stay_in_the_picture(at: tuple[float, float]) -> None:
    figure = Figure(figsize=(6.0, 6.0), dpi=72)
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axis.set(xlim=(0.0, 432.0), ylim=(0.0, 432.0))
    whole = np.array([[0.0, 0.0], [432.0, 432.0]])
    assert place_names(axis, np.array([at]), ["landmark"], np.ones(2), whole) == 0
    figure.draw_without_rendering()
    for text in axis.texts:
        box = text.get_window_extent()
        assert box.x1 <= 432.0 and box.y1 <= 432.0


@pytest.mark.usefixtures("not_laid_out")
def test_names_of_a_flight_without_room_are_counted() -> None:
    """Of 230 landmarks 200 have a name at most, in the image and in both panels of the map."""
    scene = drone(np.random.default_rng(1), 3, 230)
    history = solve_flight_read(flight_of(np.random.default_rng(2), scene, 0.3, Priors())).history()
    for name, panels in {"image": 1, "map": 2}.items():
        (part,) = draw(name, [history], 1).subfigs
        shown = [
            sum(text.get_text().startswith("P") for text in axis.texts)
            for axis in part.axes[:panels]
        ]
        assert all(0 < count < 200 for count in shown)
        left = 30 + 200 * panels - sum(shown)
        assert f"{left} names left out for want of room" in part.get_suptitle()
    assert history.estimate.scene is not None
    image = history.estimate.scene().image
    assert image is not None
    picture = Image.new("L", image(*history.estimate.frame_key(1)).size_px)
    axis, said = panel("patches", history, photograph=lambda *_: picture)
    assert len(axis.get_yticks()) == 12 and "218 landmarks more" in said


def test_every_title_says_that_a_flight_misfits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tower and mast have each other's coordinates; alone, and beside the flight as it is."""
    shutil.copytree(HILL, tmp_path / "wrong")
    shutil.copytree(HILL, tmp_path / "right")
    monkeypatch.chdir(tmp_path)
    marks, other = Path("wrong/landmarks.csv"), {"tower": "mast", "mast": "tower"}
    rows = [line.partition(",") for line in marks.read_text().splitlines()]
    marks.write_text("".join(f"{other.get(name, name)},{rest}\n" for name, _, rest in rows))
    wrong, right = (solve_flight(f"{name}/flight.toml").history() for name in ("wrong", "right"))
    told = [doubts_text(made) for made in ([wrong], [wrong, right], [right])]
    assert_approved(str(told))
    for name in ("attitude", "residuals", "image", "map"):
        title = " ".join(draw(name, [wrong]).subfigs[0].get_suptitle().split())
        assert told[0][0] in title
    both = draw("residuals", [wrong, right]).subfigs[0].get_suptitle()
    assert told[1][0] in " ".join(both.split())
    assert doubts([wrong])[0].text == told[0][0] and not doubts([right])
