"""Picks whose name begins with #: comments, of which it is told where they seem to be rows."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import FRAMES, MARKS, TOML, camera_m, pixels, write_project
from vopd.flight.project.read import read_flight
from vopd.geometry.earth import geodetic

BY_IMAGE = TOML.replace("frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n", "").replace(
    'sigma_t_s = "exact"\n', ""
)
HASH = 2  # the frame whose image has a # at the beginning of its name


def told(folder: Path, picked: str, placed: str, more: str = "") -> list[str]:
    """What is warned of where the third image stands so in the picks, and so in the track."""
    path = write_project(folder, BY_IMAGE)
    images = [f"a{k}.jpg" for k in range(FRAMES)]
    rows = [
        f"{picked if k == HASH else images[k]},{name},{u:.9f},{v:.9f}"
        for k, seen in enumerate(pixels())
        for name, (u, v) in zip(MARKS, seen, strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["image,landmark,u_px,v_px", *rows, more, ""]))
    where = zip(*geodetic(camera_m([2.0 + k / 10.0 for k in range(FRAMES)])), strict=True)
    rows = [
        f"{placed if k == HASH else images[k]},{a:.12f},{b:.12f},{h:.6f}"
        for k, (a, b, h) in enumerate(where)
    ]
    (folder / "track.csv").write_text("\n".join(["image,lat_deg,lon_deg,h_m", *rows, ""]))
    return [one.message for one in read_flight(str(path)).findings]


@pytest.mark.parametrize(
    ("picked", "placed"),
    [("#2.jpg", "#2.jpg"), ("#2.jpg", '"#2.jpg"'), ('"#2.jpg"', "#2.jpg")],
    ids=["both", "picks", "track"],
)
def test_a_row_that_is_taken_for_a_comment_is_told(
    tmp_path: Path, picked: str, placed: str
) -> None:
    (message,) = told(tmp_path, picked, placed)
    assert_approved(message)


@pytest.mark.parametrize(
    ("picked", "placed"),
    [
        ('"#2.jpg"', '"#2.jpg"'),  # names that are read
        ("# 2.jpg", "# 2.jpg"),  # comments, as the blank says
        ("#a2.jpg", "a2.jpg"),  # rows that a person has put a # before
    ],
    ids=["quoted", "blank", "put out"],
)
def test_comments_are_not_told(tmp_path: Path, picked: str, placed: str) -> None:
    assert told(tmp_path, picked, placed) == []


def test_a_comment_of_fewer_cells_is_none_of_the_rows(tmp_path: Path) -> None:
    assert told(tmp_path, "a2.jpg", "a2.jpg", "#2.jpg,church,3\n#image,landmark,u_px,v_px") == []


def test_a_folder_of_images_has_the_name(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "#2.jpg").touch()
    path = tmp_path / "flight.toml"
    told(tmp_path, "#2.jpg", "a2.jpg")
    path.write_text(BY_IMAGE.replace("[picks]", '[picks]\nvideo = "images"'))
    assert_approved([one.message for one in read_flight(str(path)).findings])
