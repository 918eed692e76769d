"""Picks of a project: their grid, standard deviations, several of one point, and what is told."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import read_text, text_told
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight.flight import FrameSlots
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.lens import LensRead, make_lens
from vopd.flight.formats.picks import CLICKS, PICK_FORMATS, Names, PickRows, clicks_of
from vopd.flight.project import picks as picks_module
from vopd.flight.project.camera import CameraLens
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.picks import join_picks
from vopd.flight.project.read import read_pick_rows

MARKS = ("mast", "well", "arch")
LENS = make_lens("brown", (64, 48), (50.0, 50.0), (31.5, 23.5))


def pick_rows(*picks: tuple[int, str, float, float, float]) -> PickRows:
    frame, name, u, v, sigma = zip(*picks, strict=True)
    pixel = np.array([u, v], dtype=np.float64).T
    return PickRows(np.array(frame), Names(name), pixel, np.array(sigma), None, None, "CSV")


def joined(*picks: tuple[int, str, float, float, float], stated: bool = True) -> Any:
    rows = pick_rows(*picks)
    read = replace(rows, grid="centre", stated=stated)
    return join_picks(read, lambda k: f"frame {k + 10}", MARKS, "p.toml")


def test_marks_of_interpolated_picks_stay_theirs_where_others_are_not_used() -> None:
    """The first, which no image holds, and one of two that contradict each other."""
    rows = pick_rows(
        (0, "arch", 5e6, 6, 0.5), (0, "mast", 7, 8, 0.5), (1, "arch", 1, 2, 0.5),
        (1, "arch", 900, 2, 0.5), (1, "mast", 3, 4, 0.5), (2, "mast", 5, 6, 0.5),
    )  # fmt: skip
    interpolated = np.array([True, False, True, True, True, False])
    read = replace(rows, grid="centre", stated=True, interpolated=interpolated)
    picks, _ = join_picks(read, lambda k: f"frame {k}", MARKS, "p.toml")
    assert picks.frame.tolist() == [0, 1, 2]
    assert picks.followed.tolist() == [False, True, False]


def test_a_pick_that_is_there_twice_says_nothing_of_its_error() -> None:
    """As in a file that two exports were put together in; it has the usual sigma still."""
    twice = [(frame, name, 1.0, 2.0, 1.0) for frame in (0, 1) for name in ("mast", "well")] * 2
    picks, findings = joined(*twice, stated=False)
    assert picks.one_sigma_px == 1.0 and (picks.sigma_px > 0.7).all()
    assert picks.pixel.tolist() == [[1.0, 2.0]] * 4 and not findings


@pytest.mark.parametrize("at_once", [1, 2, 100])
def test_picks_of_one_point_are_averaged_by_their_weights(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sigmas 1 and 2 have weights 1 and 1/4: (10 + 15 / 4) / 1.25 is 11; 1 / sqrt(1.25)."""
    monkeypatch.setattr(picks_module, "POINTS_AT_ONCE", at_once)
    picks, findings = joined(
        (1, "well", 10, 20, 1.0), (0, "arch", 5, 6, 0.5), (1, "well", 15, 10, 2.0),
        (0, "mast", 7, 8, 1.5), (1, "mast", 1, 2, 1.0), (1, "arch", 3, 4, 1.0),
    )  # fmt: skip
    assert findings == []
    assert picks.frame.tolist() == [0, 0, 1, 1, 1] and picks.landmark.tolist() == [0, 2, 0, 1, 2]
    assert_close("ratio", picks.pixel, [[7, 8], [5, 6], [1, 2], [11, 18], [3, 4]])
    assert_close("ratio", picks.sigma_px, [1.5, 0.5, 1.0, 1.25**-0.5, 1.0])
    # (1, 2) and (4, 8) from the mean: 85 over two degrees of freedom
    assert_close("ratio", picks.repeatability_px, np.sqrt(85.0 / 2.0))
    assert (picks.one_sigma_px, picks.least_sigma_px) == (1.0, 1.0)  # of .5 1 1 1 1.5 2
    other, _ = joined((0, "mast", 1, 2, 3.0), (0, "well", 1, 2, 5.0), (1, "well", 1, 2, 9.0))
    assert other.one_sigma_px == other.least_sigma_px == 5.0 and np.isnan(other.repeatability_px)


def test_a_sigma_that_is_not_stated_may_be_smaller() -> None:
    picks, _ = joined((0, "mast", 1, 2, 3.0), (0, "well", 1, 2, 5.0), stated=False)
    assert (picks.one_sigma_px, picks.least_sigma_px) == (4.0, 0.3)


def test_the_repeatability_is_of_all_points_picked_several_times() -> None:
    """Three picks at 0, 3, 3 of u are off by -2, 1, 1: 6; two at 0, 2 of v: 2; over 2 (2 + 1)."""
    picks, _ = joined(
        (0, "mast", 0, 5, 1.0), (0, "mast", 3, 5, 1.0), (0, "mast", 3, 5, 1.0),
        (1, "mast", 5, 0, 1.0), (1, "mast", 5, 2, 1.0), (2, "mast", 99, 99, 1.0),
    )  # fmt: skip
    assert_close("ratio", picks.repeatability_px, np.sqrt(8.0 / 6.0))
    assert picks.frame.tolist() == [0, 1, 2]


def test_picks_without_a_sigma_have_that_of_their_spread() -> None:
    """4 px apart, where most points are picked twice; none is contrary within 20 px."""
    twice = [(0, "mast", u, 5.0, 1.0) for u in (0.0, 4.0)]
    picks, _ = joined(*twice, (1, "mast", 3, 5, 1.0), stated=False)
    assert picks.one_sigma_px == 1.0  # half of the points are not most
    picks, _ = joined(*twice, stated=False)
    assert (picks.one_sigma_px, picks.sigma_px.tolist()) == (2.0, [np.sqrt(2.0)])
    close = [(1, name, u, 5.0, 1.0) for name in ("well", "arch") for u in (0.0, 0.1)]
    assert not joined(*twice, *close, stated=False)[1]


@pytest.mark.parametrize(("apart", "told"), [(19.9, 0), (20.1, 1)])
def test_picks_that_spread_by_ten_pixels_are_of_several_frames(apart: float, told: int) -> None:
    """Of two picks that are d apart, d / 2 by two degrees of freedom."""
    _, findings = joined(
        (0, "mast", 0, 5, 1.0), (0, "mast", apart, 5, 1.0),
        (0, "well", 50, 5, 1.0), (0, "well", 50, 5 + apart, 1.0), stated=False,
    )  # fmt: skip
    assert len(findings) == told
    if told:
        assert_approved(findings[0].message)


@pytest.mark.parametrize(
    ("sigma", "apart", "told"),
    [(1.0, 19.98, False), (1.0, 20.02, True), (2.0, 39.9, False), (2.0, 40.1, True)],
)
def test_picks_of_one_point_twenty_sigmas_apart_contradict_each_other(
    sigma: float, apart: float, told: bool
) -> None:
    """Along both axes; the points that are left keep their order and their repeatability."""
    for du, dv in ((apart, 0.0), (0.0, -apart), (0.6 * apart, 0.8 * apart)):
        picks, findings = joined(
            (0, "well", 50, 60, sigma), (3, "arch", 1, 2, sigma),
            (3, "arch", 1 + du, 2 + dv, sigma),
            (3, "mast", 7, 5, sigma), (3, "mast", 7, 7, sigma), (4, "mast", 8, 8, sigma),
        )  # fmt: skip
        if told:
            (finding,) = findings
            assert (finding.source, finding.severity) == ("p.toml", "warning")
            assert_approved(finding.message, parts=["frame 13", "arch", 2, f"{apart:.0f} px"])
            assert picks.frame.tolist() == [0, 3, 4] and picks.landmark.tolist() == [1, 0, 0]
            assert_close("ratio", picks.pixel, [[50, 60], [7, 6], [8, 8]])
            assert_close("ratio", picks.sigma_px, [sigma, sigma / np.sqrt(2.0), sigma])
            assert_close("ratio", picks.repeatability_px, 1.0)  # 1 and 1 over 2
        else:
            assert findings == [] and picks.frame.tolist() == [0, 3, 3, 4]
            assert_close("ratio", picks.repeatability_px, np.sqrt((apart**2 / 2.0 + 2.0) / 4.0))


def test_the_largest_distance_of_three_picks_is_told_twice_from_their_mean() -> None:
    """Means at 40: off by 40, 50 and 10, twice 50."""
    _, findings = joined(
        (0, "mast", 0, 0, 1.0), (0, "mast", 90, 0, 1.0), (0, "mast", 30, 0, 1.0),
        (1, "mast", 0, 0, 1.0), (1, "mast", 0, 50.6, 1.0),
    )  # fmt: skip
    assert [one.message.partition(";")[0] for one in findings] == [
        "frame 10: mast is picked 3 times, up to 100 px apart",
        "frame 11: mast is picked 2 times, up to 51 px apart",
    ]


def test_landmarks_that_the_project_does_not_have_are_told_by_name() -> None:
    picks, findings = joined(
        (0, "tower", 1, 2, 1.0), (0, "mast", 5, 6, 1.0), (1, "tower", 1, 2, 1.0),
        (1, "masst", 1, 2, 1.0), (1, "arch", 7, 8, 1.0),
    )  # fmt: skip
    assert findings == [
        Finding("no landmark masst (1 pick); did you mean mast?", "p.toml", severity="warning"),
        Finding(
            "no landmark tower (2 picks); known are mast, well, arch", "p.toml", severity="warning"
        ),
    ]
    assert picks.frame.tolist() == [0, 1] and picks.landmark.tolist() == [0, 2]
    assert picks.pixel.tolist() == [[5.0, 6.0], [7.0, 8.0]]


def test_a_name_that_begins_with_a_number_sign_is_no_comment_in_quotes() -> None:
    _, findings = joined((0, "#3", 1, 2, 1.0), (0, "P#3", 1, 2, 1.0), (0, "mast", 5, 6, 1.0))
    assert_approved([one.message for one in findings])


# The rows as they stand


def project_picks(folder: Path, text: str, **keys: Any) -> PickRows:
    (folder / "p").write_text(text)
    section = Section("p.toml", "picks", {"file": "p"} | keys)
    camera = CameraLens(LensRead(LENS, "lens"))
    return read_pick_rows(Project("p.toml", folder, {"picks": section}), camera)


TABLE = "frame,landmark,u_px,v_px{}\n0,mast,1,2{}\n0,well,3,4{}\n1,well,3,4{}\n"
PLAIN = TABLE.format("", "", "", "")


@pytest.mark.parametrize(
    ("grid", "shift"), [("centre", 0.0), ("corner", -0.5), ("one-based", -1.0)]
)
@pytest.mark.parametrize("way", ["down", "up", None])
def test_the_grid_and_the_way_of_v(
    grid: str, shift: float, way: str | None, tmp_path: Path
) -> None:
    """The last of 48 rows is 47: v up of 2 is 45 down."""
    found = project_picks(tmp_path, PLAIN, pixel_grid=grid, **({} if way is None else {"v": way}))
    pixel = found.centred_px(np.array([1, 0]))
    v = [47.0 - 4.0 - shift, 47.0 - 2.0 - shift] if way == "up" else [4.0 + shift, 2.0 + shift]
    assert pixel.tolist() == [[3.0 + shift, v[0]], [1.0 + shift, v[1]]]
    assert found.pixel[0].tolist() == [1.0, 2.0]
    assert found.said == f"p: CSV, 3 picks, {grid} grid, v {way or 'down'}"


def test_standard_deviations_of_picks(tmp_path: Path) -> None:
    """The file's, else the project's, else 1; they are stated where each has one of them."""
    grid = {"pixel_grid": "centre"}
    some = TABLE.format(",sigma_px", ",0.25", ",", ",3")
    for text, keys, sigma, stated in (
        (PLAIN, {}, [1.0, 1.0, 1.0], False), (PLAIN, {"sigma_px": 0.5}, [0.5, 0.5, 0.5], True),
        (some, {}, [0.25, 1.0, 3.0], False), (some, {"sigma_px": 2}, [0.25, 2.0, 3.0], True),
        (TABLE.format(",sigma_px", ",", ",", ","), {}, [1.0, 1.0, 1.0], False),
    ):  # fmt: skip
        found = project_picks(tmp_path, text, **grid, **keys)
        assert (found.sigma_px.tolist(), found.stated) == (sigma, stated)
        assert bool(found.doubts) == (text == some and not keys)
        if found.doubts:
            assert_approved(found.doubts)
    every = TABLE.format(",sigma_px", ",0.25", ",1", ",3")
    assert project_picks(tmp_path, every, **grid).stated
    for beyond in (9e-10, 1.1e9):
        with pytest.raises(VopdError, match=r"\[picks\] sigma_px: .* standard deviation must be"):
            project_picks(tmp_path, PLAIN, **grid, sigma_px=beyond)


def test_a_sigma_that_no_pick_has_is_told_by_its_line(tmp_path: Path) -> None:
    """A ten-thousandth of a pixel is not; the first one of a file is named."""
    one, other, usual = (
        TABLE.format(",sigma_px", ",1e-4", *x)
        for x in ((",", ",1e-9"), (",9e-5", ",1e-9"), (",1", ","))
    )
    keys = {"pixel_grid": "centre", "sigma_px": 1.0}
    found = [project_picks(tmp_path, text, **keys).doubts for text in (one, other)]
    assert_approved([text for doubts in found for text in doubts])
    assert project_picks(tmp_path, usual, **keys).doubts == ()


IMAGES = (
    '<annotations><image name="a" width="{}" height="{}"><points label="m" points="1,2"/></image>'
    "</annotations>"
)


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        (PLAIN, {}),
        (PLAIN, {"pixel_grid": "edge"}),
        (PLAIN, {"pixel_grid": "corner", "v": "left"}),
        (PLAIN, {"pixel_grid": "corner", "sigma_px": 0}),
        (IMAGES.format(64, 48), {"pixel_grid": "centre"}),
        (IMAGES.format(64, 47), {}),
        (IMAGES.format(63, 48), {}),
        (IMAGES.format(48, 64), {}),
        (IMAGES.format(64, 48), {"v": "up"}),
        (f"{CLICKS}\n{PLAIN}", {"v": "up"}),
    ],
)
def test_picks_that_a_project_refuses(text: str, keys: dict[str, Any], tmp_path: Path) -> None:
    with refused(VopdError):
        project_picks(tmp_path, text, **keys)


@pytest.mark.parametrize("odd", ["nan,2", "1,nan", "inf,2", "1,-inf"])
def test_picks_that_are_not_finite_are_refused_in_every_format(odd: str, tmp_path: Path) -> None:
    """A table refuses them with their line; these formats have none."""
    with refused(VopdError):
        project_picks(tmp_path, IMAGES.format(64, 48).replace("1,2", f"3,4;{odd}"))


def test_a_grid_that_the_file_has_may_be_repeated(tmp_path: Path) -> None:
    found = project_picks(tmp_path, IMAGES.format(64, 48), pixel_grid="corner")
    assert found.centred_px(np.array([0])).tolist() == [[0.5, 1.5]] and not found.stated


def test_picks_in_one_row_a_frame() -> None:
    """Of frames 2, 0, 2, 3, 2 of five: three columns; the first of a frame stands first."""
    slots = FrameSlots.of(np.array([2, 0, 2, 3, 2]), 5)
    assert slots.slot.tolist() == [0, 0, 1, 0, 2] and (slots.frames, slots.slots) == (5, 3)
    spread = slots.spread(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    assert spread.tolist() == [[2, 0, 0], [0, 0, 0], [1, 3, 5], [4, 0, 0], [0, 0, 0]]
    assert slots.spread(np.ones(5, bool)).sum() == 5
    pairs = np.array([[1.0, 6.0], [2.0, 7.0], [3.0, 8.0], [4.0, 9.0], [5.0, 10.0]])
    assert slots.coordinates(pairs)[2].tolist() == [1, 3, 5, 6, 8, 10]
    assert slots.coordinates(pairs)[0].tolist() == [2, 0, 0, 7, 0, 0]
    empty = FrameSlots.of(np.zeros(0, int), 2)
    assert (empty.slots, empty.spread(np.zeros(0)).shape) == (1, (2, 1))
    many = np.arange(400) % 2  # a sort that is not stable would mix them
    assert FrameSlots.of(many, 2).slot.tolist() == [k // 2 for k in range(400)]


# Shapes and rows of files of picks: CVAT, LabelMe, tables; names that are kept once


def read(text: str) -> Any:
    return read_text(PICK_FORMATS, "p", text)


def told(text: str) -> str:
    return text_told(PICK_FORMATS, "p", text)


def test_names_are_kept_once_in_the_order_in_which_they_come() -> None:
    names = Names(["well", "mast", "well", "arch"])
    assert names.known == ["well", "mast", "arch"] and names.which.tolist() == [0, 1, 0, 2]
    names.extend(iter(["arch", "tower", "well"]))
    assert [*names] == ["well", "mast", "well", "arch", "arch", "tower", "well"]
    assert names.known == ["well", "mast", "arch", "tower"] and len(names) == 7
    assert (names[2], names[-2], names.index("arch"), len(Names())) == ("well", "tower", 3, 0)


# CVAT


def image(name: str, points: str = "1,2", width: int = 40, height: int = 30) -> str:
    inside = f'<points label="mast" points="{points}"/><box label="mast" xtl="1"/>'
    return f'<image id="9" name="{name}" width="{width}" height="{height}">{inside}</image>'


def cvat(*inside: str) -> str:
    return f"\n <annotations>{''.join(inside)}</annotations>"


def track(*points: tuple[int, str]) -> str:
    inside = "".join(
        f'<points frame="{frame}" {state} points="{frame + 0.5},2"/>' for frame, state in points
    )
    return f'<track id="3" label="well">{inside}</track>'


SIZE = "<meta><original_size><width>{}</width><height>{}</height></original_size></meta>"


def test_points_of_cvat_images() -> None:
    rows = read(cvat(image("b/2.png", "1.5,2;3,4.25;"), image("a", "")))
    assert ([*rows.frame], [*rows.landmark]) == (["b/2.png"] * 2, ["mast"] * 2)
    assert rows.pixel.tolist() == [[1.5, 2.0], [3.0, 4.25]]
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (40, 30), "CVAT images")
    assert np.isnan(rows.sigma_px).all() and rows.sigma_px.shape == (2,)
    version = '<?xml version="1.0" encoding="utf-8"?>\n<annotations created="x">'
    assert [*read(cvat(image("a")).strip().replace("<annotations>", version)).frame] == ["a"]


def test_points_of_cvat_videos() -> None:
    """A point without a state is seen; one that is outside is not; a track may come back."""
    states = ((4, 'outside="0"'), (5, ""), (6, 'outside="1"'), (8, 'outside="0"'))
    rows = read(cvat(SIZE.format(64, 48), track(*states)))
    assert rows.frame.tolist() == [4, 5, 8] and [*rows.landmark] == ["well"] * 3
    assert rows.pixel.tolist() == [[4.5, 2.0], [5.5, 2.0], [8.5, 2.0]]
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (64, 48), "CVAT video")
    assert read(cvat(track((1, "")))).size_px is None
    for lost in (' width="40"', ' height="30"'):  # by a converter that knows none
        assert read(cvat(image("a").replace(lost, ""))).size_px is None
    sizes = read(cvat(image("a"), image("b", width=41), image("c", height=31))).size_px
    assert sizes == {"a": (40, 30), "b": (41, 30), "c": (40, 31)}
    assert np.isnan(rows.sigma_px).all() and rows.sigma_px.shape == (3,)


def test_tasks_of_a_project_of_cvat_have_frames_of_their_own() -> None:
    """Its export has those of all tasks: they were one video, or one image where names agree."""
    one, other = (track((4, "")).replace("id=", f'task_id="{k}" id=') for k in (1, 2))
    assert_approved(told(cvat(one, other)))
    assert len(read(cvat(one, one.replace("well", "mast"))).frame) == 2
    first, second = (image("a").replace("id=", f'task_id="{k}" id=') for k in (1, 2))
    assert_approved(told(cvat(first, second)))
    assert len(read(cvat(first, second.replace('"a"', '"b"'))).frame) == 2
    assert_approved(told(cvat(image("a"), image("a", width=80))))


def test_points_between_key_frames_are_no_clicks() -> None:
    """CVAT marks with keyframe 0 what it has interpolated; pixels are from the first's centre."""
    states = ((4, 'keyframe="1"'), (5, 'keyframe="0"'), (6, ""))
    clicks = clicks_of(read(cvat(track(*states))))
    assert clicks == [("4", "well", 4.0, 1.5), ("6", "well", 6.0, 1.5)]


@pytest.mark.parametrize(
    "text",
    [
        cvat(image("a", "")),
        cvat(track((1, 'outside="1"'))),
        cvat(image("a"), image("b").replace("mast", "")),
        cvat(image("a"), track((1, ""))),
        cvat(track((0, ""), (-1, ""))),
        cvat(track((1, "")).replace("frame=", "f=")),
        cvat(track((1, "")).replace("frame=", 'frame="1" f=').replace('"1"', '"1.0"')),
        cvat(track((10**15, ""))),
    ],
)
def test_annotations_of_cvat_that_are_refused(text: str) -> None:
    assert_approved(told(text))


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (cvat(image("a", "1,2;x,4")), "points '1,2;x,4':"),
        (cvat(image("a", "1,2,3")), "points '1,2,3':"),
        (cvat(image("a"))[:-1], "not valid XML:"),
    ],
)
def test_annotations_of_cvat_that_python_does_not_read(text: str, start: str) -> None:
    assert_approved(told(text), others_after=start)


def test_a_shape_of_cvat_with_more_points_than_anybody_clicks() -> None:
    """Three million, of 12 MB, took 1.1 GB."""

    def well(count: int) -> str:
        points = ";".join(["1,2"] * count)
        return cvat(f'<image name="a"><points label="well" points="{points}"/></image>')

    assert len(read(well(10_000)).landmark) == 10_000
    assert_approved(told(well(10_001)))


def test_shapes_of_cvat_that_are_no_points_are_counted() -> None:
    """Each in its frame, and not where its track has ended; points without a place too."""
    boxes = '<box frame="1" outside="0"/><box frame="2" outside="1"/><points frame="1" points=""/>'
    video = cvat(track((1, "")), f'<track label="car">{boxes}<polygon frame="1"/></track>')
    tag = '<tag label="dusk"/><polyline/><polyline/></image>'
    images = cvat(image("a"), image("b", "").replace("</image>", tag))
    assert_approved([*read(video).doubts, *read(images).doubts])
    assert read(cvat(track((1, "")))).doubts == ()


def test_annotations_of_other_tools_are_not_cvat_s() -> None:
    """Pascal VOC has one annotation a file."""
    assert_approved(told("<annotation><filename>a.jpg</filename></annotation>"))


# LabelMe


def label(path: str = "a.png", width: int = 40, height: int = 30, **shape: Any) -> dict[str, Any]:
    usual = {"label": "mast", "points": [[1.5, 2], [3, 4]], "shape_type": "point"}
    shapes = [usual | shape, usual | {"shape_type": "line"}, {"label": "x", "points": []}]
    return {"imagePath": path, "imageWidth": width, "imageHeight": height, "shapes": shapes}


def in_folder(folder: Path, **labels: Any) -> Any:
    for name, one in labels.items():
        text = one if isinstance(one, str) else json.dumps(one)
        (folder / f"{name}.json").write_text(text, encoding="utf-8-sig")
    return read_by_content(PICK_FORMATS, InputFile("labels", folder))


def test_a_folder_of_labels_is_read_in_the_order_of_its_names(tmp_path: Path) -> None:
    (tmp_path / "0.txt").write_text("not read")
    rows = in_folder(
        tmp_path,
        c=label("C:\\x\\1.png"),
        a=label("../é/2.png", label=7),
        b=label("3.png", shape_type="points"),
    )
    assert [*rows.frame] == ["2.png"] * 2 + ["3.png"] * 2 + ["1.png"] * 2
    assert [*rows.landmark] == ["7"] * 2 + ["mast"] * 4
    assert rows.pixel.tolist() == [[1.5, 2.0], [3.0, 4.0]] * 3
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (40, 30), "LabelMe")
    assert np.isnan(rows.sigma_px).all() and rows.sigma_px.shape == (6,)
    one = "\n " + json.dumps(label("é.png"), ensure_ascii=False)
    (tmp_path / "d").write_text(one, encoding="utf-8-sig")
    assert [*read_by_content(PICK_FORMATS, open_input("d", tmp_path)).frame] == ["é.png"] * 2


def test_images_that_only_their_folders_tell_apart_are_two(tmp_path: Path) -> None:
    """Their points were picks of one image."""
    rows = in_folder(
        tmp_path, a=label("..\\cam1\\1.png"), b=label("../cam2/1.png", 50), c=label("x/2.png")
    )
    assert rows.frame.known == ["../cam1/1.png", "../cam2/1.png", "2.png"]
    assert rows.size_px["../cam1/1.png"] == (40, 30) and rows.size_px["../cam2/1.png"] == (50, 30)


@pytest.mark.parametrize(
    "wrong",
    [
        "[", "[1]", {"imageWidth": 40}, label() | {"imageWidth": "x"},
        label() | {"imageHeight": None}, label(points=[[1]]), label(points=[["x", 2]]),
        label() | {"imageWidth": 1920.9}, label() | {"imageWidth": 80},
        label(points=[[1, 519, 93]]), label(points=["12"]), label(points=[[]]),
    ],
)  # fmt: skip
def test_labels_that_are_refused(wrong: Any, tmp_path: Path) -> None:
    with refused(VopdError):
        in_folder(tmp_path, a=label(), b=wrong)


def test_shapes_of_labelme_that_are_no_points_are_counted(tmp_path: Path) -> None:
    """A shape without a type is a polygon, as LabelMe takes it."""
    shapes = [{"shape_type": one, "label": "x", "points": []} for one in ("mask", "star", "point")]
    more = label() | {"shapes": [*label()["shapes"], *shapes]}
    assert_approved(in_folder(tmp_path, a=label(), b=more).doubts)


@pytest.mark.parametrize("shapes", [5, [{"shape_type": "point", "label": "x", "points": [1]}]])
def test_the_shape_that_is_none_is_named(shapes: object, tmp_path: Path) -> None:
    with refused(VopdError):
        in_folder(tmp_path, a=label() | {"shapes": shapes})


def test_folders_without_points(tmp_path: Path) -> None:
    with refused(VopdError):
        in_folder(tmp_path, a=label(shape_type="circle"))
    (tmp_path / "a.json").unlink()
    with refused(VopdError):
        in_folder(tmp_path)
    assert told('{"shape": 1}').startswith("p: the format is not recognised")


def test_what_is_doubtful_of_clicks_is_told_beside_missing_tracks(tmp_path: Path) -> None:
    text = IMAGES.format(64, 48).replace("</image>", "<box/></image>")
    assert_approved(project_picks(tmp_path, text, tracked="tracked.csv").doubts)


# Tables


def test_rows_of_a_table_of_picks() -> None:
    rows = read("u_px,landmark,v_px,frame,sigma_px\n1,b,2,7,\n# x\n3,a,4.5,5,0.25\n")
    assert rows.frame.tolist() == [7, 5] and [*rows.landmark] == ["b", "a"]
    assert rows.pixel.tolist() == [[1.0, 2.0], [3.0, 4.5]]
    assert np.isnan(rows.sigma_px[0]) and rows.sigma_px[1] == 0.25
    assert (rows.grid, rows.size_px, rows.said) == (None, None, "CSV")
    both = read("frame,image,landmark,u_px,v_px\n1,x.jpg,a,2,3\n")
    assert [*both.frame] == ["x.jpg"] and np.isnan(both.sigma_px).all()
    assert both.sigma_px.shape == (1,)


@pytest.mark.parametrize(
    ("header", "missing"),
    [
        ("landmark", "u_px"), ("u_px", "landmark"), ("v_px", "landmark"), ("landmark,u_px", "v_px"),
        ("frame,u_px,v_px", "landmark"),
        ("frame,landmark,v_px", "u_px"), ("frame,landmark,u_px", "v_px"),
    ],
)  # fmt: skip
def test_a_table_that_has_part_of_picks(header: str, missing: str) -> None:
    said = told(f"{header}\n{','.join('1' * (header.count(',') + 1))}\n")
    assert_approved(said, parts=[missing])


def test_picks_of_one_image_need_no_frame() -> None:
    """Unless a landmark stands twice: then they are of several."""
    rows = read("landmark,u_px,v_px\nmast,1,2\npond,3,4\n")
    assert np.asarray(rows.frame).tolist() == [0, 0]
    assert_approved(rows.said)
    assert_approved(told("landmark,u_px,v_px\nmast,1,2\nmast,3,4\n"))


def test_a_table_of_other_columns_is_none_of_picks() -> None:
    assert_approved(told("frame,mark\n1,2\n"))


def test_an_empty_name_far_into_a_table_is_named_by_its_line() -> None:
    """Rows of about 10 characters: the third block of 20000 characters."""
    rows = [f"{k},m{k % 9},{k}.5,1" for k in range(4000)]
    head = "frame,landmark,u_px,v_px\n"
    good = read(head + "\n".join(rows))
    assert good.frame.tolist() == [*range(4000)] and good.landmark[3999] == "m3"
    assert good.pixel[3999].tolist() == [3999.5, 1.0]
    rows[3900] = "3900,,1,1"
    assert_approved(told(head + "\n".join(rows)), parts=["line 3902"])
    rows[3900] = "x,m,1,1"
    assert_approved(told(head + "\n".join(rows)), parts=["line 3902"])
    names = [f"a{k},m,1,1" for k in range(4000)]
    assert [*read(head + "\n".join(names)).frame] == [f"a{k}" for k in range(4000)]
    names[3900] = " ,m,1,1"
    assert_approved(told(head + "\n".join(names)), parts=["line 3902"])
