"""Picks of a project: their grid, standard deviations, several of one point, and what is told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight import read as read_picks
from vopd.flight.files import InputFile
from vopd.flight.flight import FrameSlots
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.project import Project, Section
from vopd.flight.read import PicksRead, join_picks, read_pick_rows

MARKS = ("mast", "well", "arch")


def pick_rows(*picks: tuple[int, str, float, float, float]) -> PickRows:
    frame, name, u, v, sigma = zip(*picks, strict=True)
    pixel = np.array([u, v], dtype=np.float64).T
    return PickRows(np.array(frame), Names(name), pixel, np.array(sigma), None, None, "CSV")


def joined(*picks: tuple[int, str, float, float, float], stated: bool = True) -> Any:
    rows = pick_rows(*picks)
    read = PicksRead(rows, "centre", None, rows.sigma_px, stated, InputFile("p", Path()), "")
    return join_picks(read, lambda k: f"frame {k + 10}", MARKS, "p.toml")


@pytest.mark.parametrize("at_once", [1, 2, 100])
def test_picks_of_one_point_are_averaged_by_their_weights(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sigmas 1 and 2 have weights 1 and 1/4: (10 + 15 / 4) / 1.25 is 11; 1 / sqrt(1.25)."""
    monkeypatch.setattr(read_picks, "POINTS_AT_ONCE", at_once)
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
            message = (
                f"frame 13: arch is picked 2 times, up to {apart:.0f} px apart; "
                "none of these picks is used"
            )
            assert findings == [Finding(message, "p.toml", severity="warning")]
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


# The rows as they stand


def read(folder: Path, text: str, **keys: Any) -> PicksRead:
    (folder / "p").write_text(text)
    section = Section("p.toml", "picks", {"file": "p"} | keys)
    return read_pick_rows(Project("p.toml", folder, {"picks": section}), (64, 48))


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
    found = read(tmp_path, PLAIN, pixel_grid=grid, **({} if way is None else {"v": way}))
    pixel = found.pixel(np.array([1, 0]))
    v = [47.0 - 4.0 - shift, 47.0 - 2.0 - shift] if way == "up" else [4.0 + shift, 2.0 + shift]
    assert pixel.tolist() == [[3.0 + shift, v[0]], [1.0 + shift, v[1]]]
    assert found.rows.pixel[0].tolist() == [1.0, 2.0]
    assert found.said == f"p: CSV, 3 picks, {grid} grid, v {way or 'down'}"


def test_standard_deviations_of_picks(tmp_path: Path) -> None:
    """The file's, else the project's, else 1; they are stated where one of them is there."""
    grid = {"pixel_grid": "centre"}
    some = TABLE.format(",sigma_px", ",0.25", ",", ",3")
    for text, keys, sigma, stated in (
        (PLAIN, {}, [1.0, 1.0, 1.0], False), (PLAIN, {"sigma_px": 0.5}, [0.5, 0.5, 0.5], True),
        (some, {}, [0.25, 1.0, 3.0], True), (some, {"sigma_px": 2}, [0.25, 2.0, 3.0], True),
        (TABLE.format(",sigma_px", ",", ",", ","), {}, [1.0, 1.0, 1.0], False),
    ):  # fmt: skip
        found = read(tmp_path, text, **grid, **keys)
        assert (found.sigma_px.tolist(), found.stated) == (sigma, stated)


IMAGES = (
    '<annotations><image name="a" width="{}" height="{}"><points label="m" points="1,2"/></image>'
    "</annotations>"
)


@pytest.mark.parametrize(
    ("text", "keys", "message"),
    [
        (PLAIN, {}, "pixel_grid: is needed: centre, corner, one-based"),
        (PLAIN, {"pixel_grid": "edge"}, "pixel_grid: 'edge' is not known; "),
        (PLAIN, {"pixel_grid": "corner", "v": "left"},
         "v: 'left' is not known; known are down, up"),
        (PLAIN, {"pixel_grid": "corner", "sigma_px": 0}, "sigma_px: 0 is not above 0"),
        (IMAGES.format(64, 48), {"pixel_grid": "centre"},
         "pixel_grid: CVAT images has the corner grid: leave the key out"),
        (IMAGES.format(64, 47), {}, "file: p has images of 64 x 47, the lens is for 64 x 48"),
        (IMAGES.format(63, 48), {}, "file: p has images of 63 x 48, the lens is for 64 x 48"),
        (IMAGES.format(48, 64), {}, "file: p has images of 48 x 64, the lens is for 64 x 48: they "
         "were turned when they were picked"),
    ],
)  # fmt: skip
def test_picks_that_a_project_refuses(
    text: str, keys: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(VopdError) as refused:
        read(tmp_path, text, **keys)
    said = str(refused.value)
    assert said.startswith(f"p.toml: [picks] {message}") and ("turned" in said) == (
        "turn" in message
    )


@pytest.mark.parametrize("odd", ["nan,2", "1,nan", "inf,2", "1,-inf"])
def test_picks_that_are_not_finite_are_refused_in_every_format(odd: str, tmp_path: Path) -> None:
    """A table refuses them with their line; these formats have none."""
    with pytest.raises(VopdError) as refused:
        read(tmp_path, IMAGES.format(64, 48).replace("1,2", f"3,4;{odd}"))
    assert str(refused.value) == "p: m in a: u or v is not finite"


def test_a_grid_that_the_file_has_may_be_repeated(tmp_path: Path) -> None:
    found = read(tmp_path, IMAGES.format(64, 48), pixel_grid="corner")
    assert found.pixel(np.array([0])).tolist() == [[0.5, 1.5]] and not found.stated


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
