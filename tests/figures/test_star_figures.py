"""Pictures of star photographs, of errors by pair, and of the report's figures 6.1 to 6.3."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.approved.texts import assert_approved
from tests.kit.command import DECKS, Ran, vopd
from tests.kit.figures import OKABE_ITO, arrows_and_key, labelled, points, texts, ticks
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.cli.plot import plot_stars
from vopd.figures.stars import StarPicture, _draw_sky, draw_errors_by_pair, draw_star_residuals
from vopd.stellar.files.picture import StarCamera
from vopd.stellar.files.table import read_solutions

ORION = DECKS / "stars" / "orion.csv"


@pytest.fixture
def solved(tmp_path: Path) -> Path:
    path = tmp_path / "solved.json"
    other = DECKS / "stars" / "table_6_3.csv"
    done = vopd("stars", "solve", ORION, other, "--focal", "76", "-o", path)
    assert done.status == 0, done.stderr
    return path


def plot(*arguments: str | Path) -> Ran:
    return vopd("plot", *arguments)


def test_a_photograph_is_drawn_to_scale() -> None:
    images = np.array([[1.0, 2.0], [-3.0, 4.0], [10.0, -10.0]])
    residuals = np.array([[0.01, 0.0], [0.0, -0.02], [0.0, 0.0]])
    picture = StarPicture("a $title$", images, residuals, ("a", "b", "c"), "mm")
    (axis,) = draw_star_residuals(picture).axes
    computed, measured, centre = axis.lines
    assert_close("unit element", np.transpose(measured.get_data()), images)
    assert_close("unit element", np.transpose(computed.get_data()), images - residuals)
    assert_close("unit element", centre.get_data(), [[0.0], [0.0]])
    assert [text.get_text() for text in axis.texts] == ["a", "b", "c"]
    assert axis.get_xlim()[0] < -10.0 and axis.get_xlim()[1] > 10.0  # x to the right
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    assert_close("unit element", np.column_stack([arrows.U, arrows.V]), residuals)


@pytest.mark.parametrize("shown", [True, False])
def test_a_border_covers_no_photograph(shown: bool) -> None:
    images, edges = np.array([[10.0, 20.0], [40.0, 5.0]]), (0.0, 60.0, 40.0, 0.0)
    photograph = pytest.importorskip("PIL.Image").new("L", (60, 40), 20) if shown else None
    picture = StarPicture(
        "", images, 0.0 * images, ("a", "b"), "px", edges=edges, in_file=True, y_down=True,
        photograph=photograph,
    )  # fmt: skip
    (axis,) = draw_star_residuals(picture).axes
    (border,) = axis.patches
    assert (border.get_facecolor()[3], len(axis.images)) == ((0.0, 1) if shown else (1.0, 0))


UNITS = {  # of the images: of the longest residual, .03, in the unit of residuals, and of the axes
    "mm": ("20 µm", 0.02, "x, mm in the image, to the right", "y, mm in the image, up"),
    "px": ("0.02 px", 0.02, "x, px in the image, to the right", "y, px in the image, up"),
}


@pytest.mark.parametrize("unit", UNITS)
def test_the_units_of_a_photograph(unit: str) -> None:
    """The key is a round length, and as long as it says; residuals of mm are in micrometres."""
    images = np.array([[1.0, 2.0], [-3.0, 4.0]])
    residuals = np.array([[0.03, 0.0], [0.0, -0.02]])
    figure = draw_star_residuals(StarPicture("title", images, residuals, ("a", "b"), unit))
    (axis,) = figure.axes
    (key,) = [artist for artist in axis.get_children() if type(artist).__name__ == "QuiverKey"]
    label, length, x, y = UNITS[unit]
    assert key.text.get_text() == label
    assert_close("unit element", key.U, length)
    assert (axis.get_xlabel(), axis.get_ylabel()) == (x, y)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend == ["computed", "measured", "principal point"]
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    title, words = figure.get_suptitle().split("\n")
    assert title == "title" and words == (
        f"arrows: residuals, measured minus computed, {1.0 / arrows.scale:g} times as long"
    )


@pytest.mark.usefixtures("not_laid_out")
@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_tables_to_a_picture(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"figures{suffix}"
    result = vopd("stars", "tables", "-o", file)
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}[suffix]
    assert result.status == 0 and file.read_bytes().startswith(begins)
    if suffix == ".svg":
        titles = re.findall(r">(Figure 6[^<]*)</text>", file.read_text(encoding="utf-8"))
        assert titles == [
            f"Figure 6.{number}. Error of {name}, truth minus estimate, degrees"
            for number, name in enumerate(("omega", "phi", "kappa"), 1)
        ]


@pytest.mark.usefixtures("not_laid_out")
def test_plot_takes_a_star_solution(tmp_path: Path, solved: Path) -> None:
    file = tmp_path / "picture.svg"
    assert plot(solved, "-o", file).status == 0 and b"<svg" in file.read_bytes()
    other = tmp_path / "other.svg"
    assert plot(solved, "-o", other, "--frame", str(DECKS / "stars" / "table_6_3.csv")).status == 0
    assert file.read_bytes() != other.read_bytes()
    missing = plot(solved, "-o", file, "--frame", "nothing")
    assert missing.status == 1 and "no photograph nothing: there are" in missing.stderr


def test_ground_points_are_not_called_stars(tmp_path: Path) -> None:
    """Four points in the north, one of them outside of an image that the camera took there."""
    points = tmp_path / "points.csv"
    points.write_text(
        "x_px,y_px,x_m,y_m,z_m\n40.1,50,-100,1000,0\n60,50.1,100,1000,0\n50,59.9,0,1000,-100\n"
        "49.9,-20,0,1000,700\n"
    )
    options = ("--camera", "0,0,0", "--focal-px", "100", "--centre", "50,50", "--size", "101,101")
    file = tmp_path / "ground.json"
    assert vopd("stars", "solve", points, *options, "-o", file).status == 0
    title = plot_stars([str(file)], None, None)[0].get_suptitle().partition(": ")[2]
    assert_approved(" ".join(title.split()))  # lines break by the length of the file's path


def test_what_is_read_back_is_what_was_read(solved: Path) -> None:
    first, second = read_solutions(str(solved))
    assert first.labels[0] == "Betelgeuse" and second.labels == ("1", "2", "3", "4")
    assert_close("unit element", first.images[1], [1.816, -12.990])
    assert first.unit == "mm" and len(first.residuals) == 8


BAD: dict[str, Any] = {
    "not json": "{",
    "another array": [1],
    "no images": [{"method": "x", "stars": [1]}],
    "too few": [{"images_mm": [[1, 2]], "residuals_mm": [[1, 2], [3, 4]]}],
    "nothing": [],
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_solution_is_refused(tmp_path: Path, name: str) -> None:
    file = tmp_path / "bad.json"
    file.write_text(BAD[name] if isinstance(BAD[name], str) else json.dumps(BAD[name]))
    result = plot(file, "-o", tmp_path / "x.png")
    assert result.status == 1 and result.stderr.startswith(f"{file}: ")


def test_options_that_are_not_for_photographs_are_refused(tmp_path: Path, solved: Path) -> None:
    result = plot(solved, "-o", tmp_path / "x.png", "--job", "1")
    assert result.status == 2 and "--job is not for star photographs" in result.stderr
    mixed = plot(solved, DECKS / "appendix_h" / "case1.dat", "-o", tmp_path / "x.png")
    assert mixed.status == 2 and "not drawn together" in mixed.stderr


# Marks, labels and arrows

IMAGES = np.array([[1.0, 2.0], [-10.0, 4.0], [3.0, -6.0]])
RESIDUALS = np.array([[0.0, 0.0], [0.0303, -0.0404], [0.0, 0.01]])  # the longest is .0505
LABELS = ("Deneb", "$a$", "7")


def drawn(unit: str = "mm", **changes: Any) -> Any:
    picture = StarPicture("a $title$", IMAGES, RESIDUALS, LABELS, unit)
    figure = draw_star_residuals(picture._replace(**changes))
    (axis,) = figure.axes
    return axis


def test_what_is_drawn() -> None:
    """As seen by the camera: x to the right, y up; 1.35 times as far as the farthest star, 10."""
    axis = drawn()
    lines = labelled(axis)
    assert list(lines) == texts(axis.get_figure().legends[0])
    assert list(lines) == ["computed", "measured", "principal point"]
    assert points(lines["measured"]) == IMAGES.tolist()
    assert_close("table value", np.array(points(lines["computed"])), IMAGES - RESIDUALS)
    assert points(lines["principal point"]) == [[0.0, 0.0]]
    looks = [(line.get_marker(), line.get_markersize()) for line in lines.values()]
    assert looks == [("+", 12), ("o", 7), ("x", 8)]
    assert lines["measured"].get_markeredgecolor() == OKABE_ITO[0]
    assert lines["measured"].get_markerfacecolor() == "none"
    far = 1.35 * np.abs(IMAGES - RESIDUALS).max()
    assert_close("table value", [axis.get_xlim(), axis.get_ylim()], [(-far, far)] * 2)
    assert axis.get_aspect() == 1.0
    names = {text.get_text(): tuple(text.xy) for text in axis.texts}
    assert names == dict(zip(["Deneb", r"\$a\$", "7"], map(tuple, IMAGES), strict=True))


def test_a_star_that_does_not_fit() -> None:
    """It has a square and a bold name; one that is left out too says so; its arrow is no scale."""
    far = np.vstack([RESIDUALS[:2], [[4.0, 0.0]]])
    axis = drawn(residuals=far, odd=[False, False, True], left_out=[False, False, True])
    lines = labelled(axis)
    assert points(lines["does not fit, left out"]) == [IMAGES[2].tolist()]
    assert points(lines["residual as long as it is"]) == [[-1.0, -6.0], [3.0, -6.0]]
    assert points(lines["measured"]) == IMAGES[:2].tolist()
    (odd,) = [one for one in axis.texts if one.get_fontweight() == "bold"]
    assert odd.get_text().startswith("7")
    assert len(arrows_and_key(axis)[0].U) == 2
    out = drawn(residuals=far, left_out=[False, False, True])  # nor is that of one left out alone
    assert "residual as long as it is" in labelled(out)


@pytest.mark.parametrize(("unit", "key"), [("mm", "50 µm"), ("px", "0.05 px")])
def test_arrows(unit: str, key: str) -> None:
    """From the computed position, the longest about .12 of the width: 3.24 of 27."""
    axis = drawn(unit)
    arrows, label = arrows_and_key(axis)
    assert_close("table value", np.column_stack([arrows.X, arrows.Y]), IMAGES - RESIDUALS)
    assert_close("table value", np.column_stack([arrows.U, arrows.V]), RESIDUALS)
    assert_close("table value", [arrows.scale, label.U], [1.0 / 50.0, 0.05])
    assert label.text.get_text() == key
    assert axis.get_xlabel() == f"x, {unit} in the image, to the right"
    assert axis.get_ylabel() == f"y, {unit} in the image, up"
    assert axis.get_figure().get_suptitle() == (
        "a \\$title\\$\narrows: residuals, measured minus computed, 50 times as long"
    )


def test_sizes() -> None:
    picture = StarPicture("", IMAGES, RESIDUALS, LABELS, "mm")
    assert draw_star_residuals(picture).get_size_inches().tolist() == [9.0, 6.5]
    assert draw_star_residuals(picture, (4.0, 3.0)).get_size_inches().tolist() == [4.0, 3.0]


def test_names_that_have_no_room_are_counted() -> None:
    zero = np.zeros((230, 2))
    axis = drawn(images=zero, residuals=zero, labels=["a"] * 230)
    assert len(axis.texts) == 4  # right, left, above, below
    assert_close("table value", axis.get_xlim(), (-0.00135, 0.00135))
    assert arrows_and_key(axis)[1] is None
    assert "226 names left out" in axis.get_figure().get_suptitle()


# The photograph's own frame

PIXELS = DECKS / "stars" / "orion_pixels.csv"
LENSES: dict[str, Any] = {
    "without distortion": {},
    "k1": {"k1": -0.08},
    "tetra3": {"distortion": 0.03},
    "both": {"k1": -0.08, "distortion": 0.03},
    "barrel": {"k1": -0.2, "focal": 800.0},  # stars to 45 degrees off the axis
    "pincushion": {"k1": 1.0, "focal": 400.0},
}


def camera_of(**changes: Any) -> StarCamera:
    turned = np.eye(3)[[0, 2, 1]] * [[1.0], [1.0], [-1.0]]  # x along U, y along W, z along -V
    values = {
        "focal": 1200.0, "centre": np.array([500.0, 380.0]), "k1": 0.0, "distortion": 0.0,
        "y_down": True, "size_px": np.array([1000.0, 800.0]), "first_centre_px": 0.0,
        "matrix": turned, "sky": True, "source": "stars.csv", "odd": (), "left_out": (),
    }  # fmt: skip
    return StarCamera(**(values | changes))


@pytest.mark.parametrize("name", LENSES)
def test_the_coordinates_of_the_file(name: str) -> None:
    """Through the lens and back; of a lens with k1 by its formula."""
    camera = camera_of(**LENSES[name])
    at = np.array([[500.0, 380.0], [0.0, 0.0], [999.0, 100.0], [321.0, 799.0]])
    centred = camera.centred(at)
    assert_close("flight pixel", camera.in_file(centred), at)
    assert_close("flight pixel", centred[0], [0.0, 0.0])
    if name == "k1":
        tangent = centred / 1200.0
        seen = tangent * (1.0 - 0.08 * (tangent**2).sum(axis=1, keepdims=True)) * 1200.0
        assert_close("flight pixel", seen * [1.0, -1.0] + [500.0, 380.0], at)


@pytest.mark.parametrize(("y_down", "up"), [(True, -20.0), (False, 20.0)])
def test_which_way_y_counts(y_down: bool, up: float) -> None:
    """A point 10 px right of the principal point, whose y is 20 more."""
    camera = camera_of(y_down=y_down)
    assert_close("flight pixel", camera.centred(np.array([[510.0, 400.0]])), [[10.0, up]])
    assert_close("flight pixel", camera.in_file(np.array([[10.0, up]])), [[510.0, 400.0]])


def test_a_distortion_counts_from_the_width_of_an_image_that_is_known() -> None:
    """Without a size it is left: nobody knows how far out a star lies."""
    at = np.array([[0.0, 0.0], [999.0, 100.0]])
    plain, unknown = camera_of(), camera_of(distortion=0.03, size_px=None)
    assert_close("flight pixel", unknown.centred(at), plain.centred(at))
    assert_close("flight pixel", unknown.in_file(plain.centred(at)), at)
    bent = camera_of(distortion=0.03).centred(at) - plain.centred(at)
    assert np.abs(bent).max() > 1.0


def test_the_sky_of_a_picture() -> None:
    """The camera looks along V: right ascension 90 degrees; right is toward U, up toward W."""
    camera = camera_of()
    points = [[500.0, 380.0], [500.0, 380.0 - 1200.0], [500.0 + 1200.0, 380.0]]
    sky = camera.sky_at(np.array(points), in_file=True)
    assert_close("table value", sky, [[90.0, 0.0], [90.0, 45.0], [45.0, 0.0]])


@pytest.mark.parametrize("middle_deg", [90.0, 0.0, 359.0])
def test_the_sky_has_the_same_lines_across_zero_hours(middle_deg: float) -> None:
    """Ten degrees by ten: meridians every 10 minutes, parallels every 2 degrees."""
    axis = Figure().add_subplot()
    edges = (-5.1, 5.1, -5.1, 5.1)
    axis.set(xlim=edges[:2], ylim=edges[2:])

    def sky(at: Floats) -> Floats:
        return np.stack([(at[:, 0] + middle_deg) % 360.0, at[:, 1]], axis=1)

    _draw_sky(axis, sky, edges, "black", np.zeros((1, 2)))
    assert_approved(sorted(one.get_text() for one in axis.texts))


def test_a_narrow_field_has_its_lines_in_minutes_and_seconds() -> None:
    """Twelve minutes of arc by twelve, about 5h36m and 10 degrees south."""
    axis = Figure().add_subplot()
    edges = (-0.1, 0.1, -0.1, 0.1)
    axis.set(xlim=edges[:2], ylim=edges[2:])
    _draw_sky(axis, lambda at: at + np.array([84.0, -10.0]), edges, "black", np.zeros((1, 2)))
    assert_approved(sorted(one.get_text() for one in axis.texts))


def test_a_field_between_two_lines_has_none() -> None:
    """A hundredth of a second of arc, which no whole second crosses."""
    axis = Figure().add_subplot()
    edges = (-1e-6, 1e-6, -1e-6, 1e-6)
    sky = np.array([84.00123, -10.00012])
    assert len(_draw_sky(axis, lambda at: at + sky, edges, "black", np.zeros((1, 2)))) == 0
    assert not axis.texts and not axis.collections


@pytest.mark.parametrize("name", ["orion.csv", "orion_misidentified.csv"])
def test_no_number_of_the_sky_is_covered(name: str, tmp_path: Path) -> None:
    """Each line has one at most, and it is off the stars' names, marks and the panel's edge."""
    file = tmp_path / "solved.json"
    vopd("stars", "solve", DECKS / "stars" / name, "--focal", "76", "--reject", "-o", file)
    figure, _ = plot_stars([str(file)], None, None)
    figure.draw_without_rendering()
    (axis,) = figure.axes
    drawn = [one for one in axis.texts if one.get_text()]
    numbers = [one for one in drawn if re.search(r"°|\dh\d\dm", one.get_text())]
    assert len(numbers) >= 6
    panel = axis.get_window_extent()
    middle = {one.get_text(): one.get_window_extent() for one in numbers}
    assert len(middle) == len(numbers)
    others = [one.get_window_extent() for one in drawn if one not in numbers]
    marks = np.vstack(
        [axis.transData.transform(np.array(points(one), float)) for one in axis.lines]
    )
    for box in middle.values():
        assert panel.x0 < box.x0 < box.x1 < panel.x1 and panel.y0 < box.y0 < box.y1 < panel.y1
        assert not any(box.overlaps(other) for other in others)
        assert not any(box.contains(*mark) for mark in marks)


def test_a_misidentified_star_is_marked(tmp_path: Path) -> None:
    wrong = DECKS / "stars" / "orion_misidentified.csv"
    for options, label, status in (
        ((), "does not fit", 3),  # as `stars solve` ends
        (("--reject",), "does not fit, left out", 0),
    ):
        file = tmp_path / "solved.json"
        vopd("stars", "solve", wrong, "--focal", "76", *options, "-o", file)
        (solution,) = read_solutions(str(file))
        assert solution.picture is not None and solution.picture.odd == (8,)
        done = plot(file, "-o", tmp_path / "a.svg")
        assert done.status == status and done.stderr.startswith("warning: ") == (status == 3)
        shown = re.findall(r">([^<>]+)</text>", (tmp_path / "a.svg").read_text(encoding="utf-8"))
        assert label in shown and "Tabit: does not fit" in shown
        assert [one for one in shown if one.startswith("5h")]  # meridians


DAMAGED: dict[str, dict[str, Any]] = {
    "a centre far away": {"centre": [1e308, 0.0]},
    "no lens": {"distortion": 1.0},
    "no focal length": {"focal": 1e-300},
    "no size": {"size_px": [1e300, 1e-300]},
    "no number": {"odd": ["x"]},
    "a star nowhere": {
        "left_out": [{"star": 1, "name": "", "image": [1e200, 0], "residual": [0, 0]}]
    },
    "no stars": {"left_out": {"a": 1}},
    "three coordinates": {"centre": [1.0, 2.0, 3.0]},
    "a matrix of another size": {"matrix": [[1.0, 0.0], [0.0, 1.0]]},
    "a matrix that is not finite": {"matrix": [[1e999, 0, 0], [0, 1, 0], [0, 0, 1]]},
    "a matrix of zeros": {"matrix": [[0, 0, 0], [0, 0, 0], [0, 0, 0]]},
    "a mirror": {"matrix": [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    "a matrix that stretches": {"matrix": [[1, 0, 0], [0, 2, 0], [0, 0, 1]]},
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_picture_is_refused(tmp_path: Path, solved: Path, name: str) -> None:
    rows = json.loads(solved.read_text(encoding="utf-8"))
    (rows[0] if "matrix" in DAMAGED[name] else rows[0]["picture"]).update(DAMAGED[name])
    solved.write_text(json.dumps(rows), encoding="utf-8")
    result = plot(solved, "-o", tmp_path / "x.png")
    assert result.status == 1
    assert_approved(result.stderr)


@pytest.mark.usefixtures("not_laid_out")
def test_a_matrix_as_solved_is_drawn(tmp_path: Path) -> None:
    """It is no rotation by as much as its file says."""
    file = tmp_path / "solved.json"
    how = ("--focal", "76", "--method", "church", "--rotation", "as-solved", "-q")
    assert vopd("stars", "solve", DECKS / "stars" / "orion.csv", *how, "-o", file).status == 0
    assert json.loads(file.read_text(encoding="utf-8"))[0]["orthogonality_defect"] > 1e-5
    assert plot(file, "-o", tmp_path / "a.svg").status == 0


@pytest.mark.usefixtures("not_laid_out")
def test_a_photograph_stands_under_its_stars(tmp_path: Path) -> None:
    """It is beside the star file, under the name of column image, or where --images says.

    Its border is half a pixel beyond the first and the last one, and the panel's 3 % more.
    """
    pillow = pytest.importorskip("PIL.Image")
    lines = [line for line in PIXELS.read_text().splitlines() if not line.startswith("#")]
    text = "\n".join([f"image,{lines[0]}", *(f"orion.png,{line}" for line in lines[1:])])
    (tmp_path / "stars.csv").write_text(text + "\n", encoding="utf-8")
    scale = ("--focal", "76", "--pitch-um", "5", "--size", "6000,5200")
    file, picture = tmp_path / "solved.json", tmp_path / "a.svg"
    vopd("stars", "solve", tmp_path / "stars.csv", *scale, "-o", file)

    def images() -> int:
        assert plot(file, "-o", picture).status == 0
        return picture.read_text(encoding="utf-8").count("<image")

    assert images() == 0

    def border() -> Any:
        axis = plot_stars([str(file)], None, None)[0].axes[0]
        (one,) = axis.patches
        for shown in axis.images:
            edges = np.reshape(shown.get_extent(), (2, 2)).T
            assert_close("table value", np.sort(edges, axis=0), np.sort(one.get_bbox(), axis=0))
        return [*np.sort(one.get_bbox().get_points(), axis=0).ravel(), *axis.get_ylim()]

    whole = [-0.5, -0.5, 5999.5, 5199.5, 2599.5 + 0.515 * 5200, 2599.5 - 0.515 * 5200]
    assert_close("table value", border(), whole)
    pillow.new("L", (600, 400), 20).save(tmp_path / "orion.png")
    assert images() == 1 and "600 x 400" in picture.read_text(encoding="utf-8")
    text = file.read_text(encoding="utf-8")
    unsaid = re.sub(r'"size_px": \[[^]]*\]', '"size_px": null', text)
    assert unsaid != text
    file.write_text(unsaid, encoding="utf-8")
    assert images() == 1 and "600 x 400" not in picture.read_text(encoding="utf-8")
    assert_close("table value", border()[:4], [-0.5, -0.5, 599.5, 399.5])
    file.write_text(text, encoding="utf-8")
    assert_close("table value", border(), whole)
    (tmp_path / "orion.png").rename(tmp_path / "whole.png")
    (tmp_path / "orion.png").write_bytes(b"no image")
    assert images() == 0 and "no photograph" not in picture.read_text(encoding="utf-8")
    (tmp_path / "whole.png").rename(tmp_path / "orion.png")
    (tmp_path / "again.csv").write_bytes((tmp_path / "stars.csv").read_bytes())
    both = tmp_path / "stars.csv", tmp_path / "again.csv"  # whose names stand before that
    vopd("stars", "solve", *both, *scale, "-o", file)
    assert images() == 1
    file.write_text(text, encoding="utf-8")
    (tmp_path / "broken.png").write_bytes(b"no image")
    broken = plot(file, "-o", picture, "--images", tmp_path / "broken.png")
    assert broken.status == 0 and "no photograph: " in picture.read_text(encoding="utf-8")
    (tmp_path / "other").mkdir()
    (tmp_path / "orion.png").rename(tmp_path / "other.png")
    assert images() == 0
    named = plot(file, "-o", picture, "--images", tmp_path / "other.png")
    assert named.status == 0 and "<image" in picture.read_text(encoding="utf-8")
    unnamed = json.loads(text)
    unnamed[0]["image"] = ""
    file.write_text(json.dumps(unnamed), encoding="utf-8")
    by_hand = plot(file, "-o", picture, "--images", tmp_path / "other.png")
    assert by_hand.status == 0 and "<image" in picture.read_text(encoding="utf-8")
    assert images() == 0
    file.write_text(text, encoding="utf-8")
    missing = plot(file, "-o", picture, "--images", tmp_path / "other")
    assert missing.status == 0 and "no photograph" in picture.read_text(encoding="utf-8")


def test_stars_outside_of_what_a_lens_shows_are_drawn_without_the_lens(tmp_path: Path) -> None:
    """A lens with k1 = -30 images nothing beyond 6 degrees, where its radius is the largest."""
    file = tmp_path / "solved.json"
    scale = ("--focal", "76", "--pitch-um", "5", "--size", "6000,5200")
    assert vopd("stars", "solve", PIXELS, *scale, "-o", file).status == 0
    rows = json.loads(file.read_text(encoding="utf-8"))
    for k1, axis_x in ((-0.1, "x, px, to the right"), (-30.0, UNITS["px"][2])):
        rows[0]["picture"]["k1"] = k1
        file.write_text(json.dumps(rows), encoding="utf-8")
        (axis,) = plot_stars([str(file)], None, None)[0].axes
        assert axis.get_xlabel() == axis_x


@pytest.mark.usefixtures("not_laid_out")
def test_the_border_and_stars_outside(tmp_path: Path) -> None:
    """Rigel and Saiph were read below an image of the size that is stated: the border shows it."""
    file = tmp_path / "solved.json"
    vopd("stars", "solve", PIXELS, "--focal", "76", "--pitch-um", "5", "--size", "6000,4000",
         "--centre", "2999.5,2599.5", "-o", file)  # fmt: skip
    assert plot(file, "-o", tmp_path / "a.svg").status == 0
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "2 stars outside the image" in text and ">y, px, down<" in text


@pytest.mark.usefixtures("not_laid_out")
@pytest.mark.parametrize("y_down", [True, False])
def test_images_beyond_the_border_are_inside_the_axes(y_down: bool) -> None:
    """Of 64 by 48 pixels and 3 percent around them, and images to y = 95 and a tenth of 37.5 more.

    x -.5 - .96 to 63.5 + .96; y -.5 - .72 to 95 + 3.75.
    """
    edges = (-0.5, 63.5, 47.5, -0.5) if y_down else (-0.5, 63.5, -0.5, 47.5)
    picture = StarPicture(
        "", np.array([[10.0, 20.0], [50.0, 95.0]]), np.full((2, 2), 0.01), ("a", "b"), "px",
        edges=edges, y_down=y_down, in_file=True,
    )  # fmt: skip
    (axis,) = draw_star_residuals(picture).axes
    low, high = -1.22, 98.75
    assert_close("table value", axis.get_xlim(), [-1.46, 64.46])
    assert_close("table value", axis.get_ylim(), [high, low] if y_down else [low, high])
    assert axis.get_ylabel().endswith("down" if y_down else "up")


def test_errors_by_pair() -> None:
    """A panel for each angle; the marks of a pair stand side by side, .12 apart."""
    methods = [f"method {k}" for k in range(7)]
    errors = np.arange(14.0).reshape(2, 7) - 5.0
    panels = {"omega": errors, "phi": -errors}
    figure = draw_errors_by_pair(["1-2", "1-3"], methods, panels)
    assert figure.get_size_inches().tolist() == [9.0, 10.0]
    for axis, sign in zip(figure.axes, (1.0, -1.0), strict=True):
        zero, *lines = axis.lines
        assert list(zero.get_ydata()) == [0.0, 0.0]
        for k, line in enumerate(lines):
            x = np.array([0.0, 1.0]) + 0.12 * (k - 3)
            assert_close("table value", points(line), np.column_stack([x, sign * errors[:, k]]))
            assert line.get_label() == methods[k] and line.get_linestyle() == "None"
        assert [line.get_marker() for line in lines] == list("osD^v*o")
        colours = [to_hex(line.get_color()) for line in lines]
        assert colours == [*OKABE_ITO, OKABE_ITO[0]]
        assert axis.get_ylabel() == "degrees"
        assert axis.get_shared_x_axes().joined(axis, figure.axes[0])
    assert ticks(figure.axes[1]) == ([0, 1], ["1-2", "1-3"])
    assert [axis.get_title() for axis in figure.axes] == ["omega", "phi"]
    assert texts(figure.axes[0].get_legend()) == methods
    assert figure.axes[0].get_legend()._ncols == 7
    assert figure.axes[1].get_legend() is None
    anchor = figure.axes[0].get_legend().get_bbox_to_anchor()
    assert anchor.y0 > figure.axes[0].bbox.y1  # above the first panel


def test_two_methods_stand_on_both_sides_of_their_pair() -> None:
    figure = draw_errors_by_pair(["a"], ["one", "two"], {"": np.zeros((1, 2))})
    _, one, two = figure.axes[0].lines
    assert_close("table value", [*one.get_xdata(), *two.get_xdata()], [-0.06, 0.06])
