"""Shapes and rows of files of picks: CVAT, LabelMe, tables; names that are kept once."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import read_text, text_told
from vopd.findings import VopdError
from vopd.flight.files import InputFile, open_input, read_by_content
from vopd.flight.formats.picks import PICK_FORMATS, Names


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
    assert np.isnan(rows.sigma_px).all() and rows.sigma_px.shape == (3,)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (cvat(image("a", "")), "no points are in the file: landmarks are drawn as points"),
        (cvat(track((1, 'outside="1"'))), "no points are in the file: landmarks are drawn as po"),
        (cvat(image("a"), image("b").replace("mast", "")), "some points have no label: the label"),
        (cvat(image("a"), track((1, ""))), "images and video tracks are in one file: give them"),
        (cvat(image("a"), image("b", width=41)), "the images are not all of one size: one proj"),
        (cvat(image("a"), image("b", height=31)), "the images are not all of one size: one proj"),
        (cvat(SIZE.format(9, 9), SIZE.format(9, 8), track((1, ""))), "the images are not all of"),
        (cvat(image("a", "1,2;x,4")), "points '1,2;x,4': could not convert string to float: 'x'"),
        (cvat(image("a", "1,2,3")), "points '1,2,3': too many values to unpack"),
        (cvat(image("a"))[:-1], "not valid XML: unclosed token: line 1"),
    ],
)  # fmt: skip
def test_annotations_of_cvat_that_are_refused(text: str, message: str) -> None:
    assert told(text).startswith(f"p: {message}")


def test_annotations_of_other_tools_are_not_cvat_s() -> None:
    """Pascal VOC has one annotation a file."""
    said = told("<annotation><filename>a.jpg</filename></annotation>")
    assert said.startswith("p: the format is not recognised; known are CVAT XML, LabelMe JSON")


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
        tmp_path, c=label("C:\\x\\1.png"), a=label("../é/2.png", label=7), b=label("3.png")
    )
    assert [*rows.frame] == ["2.png"] * 2 + ["3.png"] * 2 + ["1.png"] * 2
    assert [*rows.landmark] == ["7"] * 2 + ["mast"] * 4
    assert rows.pixel.tolist() == [[1.5, 2.0], [3.0, 4.0]] * 3
    assert (rows.grid, rows.size_px, rows.said) == ("corner", (40, 30), "LabelMe")
    assert np.isnan(rows.sigma_px).all() and rows.sigma_px.shape == (6,)
    one = "\n " + json.dumps(label("é.png"), ensure_ascii=False)
    (tmp_path / "d").write_text(one, encoding="utf-8-sig")
    assert [*read_by_content(PICK_FORMATS, open_input("d", tmp_path)).frame] == ["é.png"] * 2


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("[", "b.json: not a LabelMe file: JSONDecodeError("),
        ("[1]", "b.json: not a LabelMe file: TypeError("),
        ({"imageWidth": 40}, "b.json: not a LabelMe file: KeyError('imageHeight')"),
        (label() | {"imageWidth": "x"}, "b.json: not a LabelMe file: ValueError("),
        (label() | {"imageHeight": None}, "b.json: not a LabelMe file: TypeError("),
        (label(points=[[1]]), "b.json: not a LabelMe file: IndexError("),
        (label(points=[["x", 2]]), "b.json: not a LabelMe file: ValueError("),
        (label(height=31), "labels: the images are not all of one size: one project is one camer"),
        (label(width=41), "labels: the images are not all of one size: one project is one camer"),
    ],
)  # fmt: skip
def test_labels_that_are_refused(wrong: Any, message: str, tmp_path: Path) -> None:
    with pytest.raises(VopdError) as refused:
        in_folder(tmp_path, a=label(), b=wrong)
    assert str(refused.value).startswith(message)


def test_folders_without_points(tmp_path: Path) -> None:
    with pytest.raises(VopdError, match="labels: no shape is a point: landmarks are drawn as poi"):
        in_folder(tmp_path, a=label(shape_type="circle"))
    (tmp_path / "a.json").unlink()
    with pytest.raises(VopdError, match="labels: the format is not recognised"):
        in_folder(tmp_path)
    assert told('{"shape": 1}').startswith("p: the format is not recognised")


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
        ("landmark", "frame"), ("u_px", "landmark"), ("v_px", "landmark"),
        ("landmark,u_px", "frame"), ("landmark,u_px,v_px", "frame"),
        ("frame,u_px,v_px", "landmark"),
        ("frame,landmark,v_px", "u_px"), ("frame,landmark,u_px", "v_px"),
    ],
)  # fmt: skip
def test_a_table_that_has_part_of_picks(header: str, missing: str) -> None:
    said = told(f"{header}\n{','.join('1' * (header.count(',') + 1))}\n")
    assert said.startswith(f"p: line 1: no column {missing}")
    assert told("frame,mark\n1,2\n").startswith("p: the format is not recognised")


def test_an_empty_name_far_into_a_table_is_named_by_its_line() -> None:
    """Rows of about 10 characters: the third block of 20000 characters."""
    rows = [f"{k},m{k % 9},{k}.5,1" for k in range(4000)]
    head = "frame,landmark,u_px,v_px\n"
    good = read(head + "\n".join(rows))
    assert good.frame.tolist() == [*range(4000)] and good.landmark[3999] == "m3"
    assert good.pixel[3999].tolist() == [3999.5, 1.0]
    rows[3900] = "3900,,1,1"
    assert told(head + "\n".join(rows)) == "p: line 3902, column landmark: the cell is empty"
    rows[3900] = "x,m,1,1"
    message = "'x' is not the number of a frame, and other rows have numbers"
    assert told(head + "\n".join(rows)) == f"p: line 3902, column frame: {message}"
    names = [f"a{k},m,1,1" for k in range(4000)]
    assert [*read(head + "\n".join(names)).frame] == [f"a{k}" for k in range(4000)]
    names[3900] = " ,m,1,1"
    assert told(head + "\n".join(names)) == "p: line 3902, column frame: the cell is empty"
