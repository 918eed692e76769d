"""Errors in tables of picks and times, with line and column; names of files; exact trials."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.files import InputFile, open_input, read_by_content
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Section
from vopd.flight.solve import first_attitude
from vopd.flight.track import _of_csv, _track_height

PICKS = "frame,landmark,u_px,v_px\n"


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PICKS, "no pick is in the file"),
        (PICKS + "# none\n\n", "no pick is in the file"),
        ("", "the format is not recognised"),
        (PICKS + "0,a,1,2\n1,,3,4\n", "line 3, column landmark: the cell is empty"),
        ("image,landmark,u_px,v_px\na,b,1,2\n ,c,3,4\n", "line 3, column image: the cell is"),
        (PICKS + "0,a,1,2\n,b,3,4\n", "line 3, column frame: '' is not the number of a frame"),
        (PICKS + "0,a,1,2\nx,b,3,4\n", "line 3, column frame: 'x' is not the number of a frame"),
        (PICKS + "x,a,1,2\n5,b,3,4\n", "line 2, column frame: 'x' is not the number of a fram"),
        (PICKS + "0,a,1,2\n1.5,b,3,4\n", "line 3, column frame: 1.5 is not the number of a fr"),
        (PICKS + "0,a,1,2\n-1,b,3,4\n", "line 3, column frame: -1 is not the number of a fram"),
        (PICKS + "0,a,1,2\n1,b,3\n", "line 3: 3 cells, the header has 4"),
        (PICKS + "0,a,1,2\n1,b,3,4,5\n", "line 3: 5 cells, the header has 4; decimals take a"),
        (PICKS + "0,a,1,2\n1,b,,4\n", "line 3, column u_px: the cell is empty"),
        (PICKS + "0,a,1,2\n1,b,3,x\n", "line 3, column v_px: 'x' is not a number"),
        (PICKS + "0,a,1,2\n1,b,3,1e999\n", "line 3, column v_px: 1e999 is not a finite number"),
        ("frame;landmark;u_px;v_px\n1;a;3,5;4\n", "line 2, column u_px: '3,5' is not a number;"),
        (PICKS.replace("u_px", "v_px"), "line 1: two columns are called v_px"),
        (PICKS.replace("v_px", "v_pix") + "0,a,1,2\n", "line 1: no column v_px; did you mean v"),
        (PICKS + '0,"a,1,2\n', "line 2: a quoted cell goes over the end of the line"),
    ],
)  # fmt: skip
def test_errors_in_picks_name_line_and_column(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "picks").write_text(text)
    file = open_input("picks", tmp_path)
    said = told(lambda: read_by_content(PICK_FORMATS, file))
    assert said.startswith(f"picks: {message}")


def test_frames_by_name_and_by_number(tmp_path: Path) -> None:
    (tmp_path / "picks").write_text(PICKS + "b,m,1,2\na 7,m,3,4\n")
    rows = read_by_content(PICK_FORMATS, open_input("picks", tmp_path))
    assert [*rows.frame] == ["b", "a 7"] and rows.said == "CSV"
    (tmp_path / "picks").write_text(PICKS + "007,m,1,2\n0,m,3,4\n")
    assert read_by_content(PICK_FORMATS, open_input("picks", tmp_path)).frame.tolist() == [7, 0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frame,t_s\n5,1\n7,3\n6,3\n", "times: line 3, column t_s: frame 7 is not after frame 6"),
        ("frame,t_s\n5,1\n6,0.5\n", "times: line 3, column t_s: frame 6 is not after frame 5"),
        (
            "frame,t_utc\n6,2026-05-01T00:00:00Z\n5,2026-05-01T00:00:01Z\n",
            "times: line 2, column t_utc: frame 6 is not after frame 5",
        ),
        ("frame,t_s\n5,1\n5,2\n", "p.toml: [picks] times: times: a frame has two times"),
        ("image,t_s\na,1\nb,3\nb,4\n", "p.toml: [picks] times: times: a frame has two times"),
        ("image,t_s\na,1\nb,\n", "times: line 3, column t_s: the cell is empty"),
        ("image,t_utc\na,2026-05-01T00:00:00\n", "times: line 2, column t_utc: 2026-05-01"),
        ("image,t_utc\na,noon\n", "times: line 2, column t_utc: 'noon' is not a date and"),
        ("image,t\na,1\n", "times: line 1: no column t_utc"),
    ],
)  # fmt: skip
def test_errors_in_times_name_line_and_column(text: str, message: str) -> None:
    file, section = InputFile("times", Path(), text), Section("p.toml", "picks", {})
    assert told(lambda: _of_csv(section, file, text.startswith("image"))).startswith(message)


def test_times_of_frames_in_any_order() -> None:
    """A later frame may stand first; a time for images may be the same twice."""
    section = Section("p.toml", "picks", {})
    found = _of_csv(section, InputFile("times", Path(), "frame,t_s\n9,3\n5,1\n7,2\n"), False)
    assert found.known == {"9": 3.0, "5": 1.0, "7": 2.0} and not found.utc
    assert found.said == "times: times of 3 frames"
    found = _of_csv(section, InputFile("t", Path(), "image,t_utc\nb,1970-01-01T00:00:05Z\n"), True)
    assert found.known == {"b": 5.0} and found.utc


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("", "the name of a file is needed"), ("  ", "the name of a file is needed"),
        ("none.csv", "none.csv: No such file or directory (paths are relative to {})"),
        ("a\0b", "'a\\x00b': embedded null byte"),
        ("latin.csv", "latin.csv: not a text file in UTF-8, at byte 30005"),
    ],
)  # fmt: skip
def test_files_that_cannot_be_opened(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "latin.csv").write_bytes(b"12345" + b"x" * 30000 + b"\xfc")

    def read() -> None:
        _ = open_input(name, tmp_path).text

    assert told(read) == message.format(tmp_path)


def test_a_folder_is_a_file_without_text(tmp_path: Path) -> None:
    file = open_input(".", tmp_path)
    assert (file.text, file.head) == ("", "")
    assert str(file.error("odd")) == ".: odd"
    assert str(file.error("odd", 3)) == ".: line 3: odd"
    assert str(file.error("odd", 3, "u")) == ".: line 3, column u: odd"
    assert str(file.error("odd", column="key")) == ".: key: odd"


@pytest.mark.parametrize(
    ("own", "given", "found"),
    [
        (None, None, None), (None, "egm96", "egm96"), (None, "same", "same"),
        ("ellipsoid", None, "ellipsoid"), ("ellipsoid", "ellipsoid", "ellipsoid"),
        ("ellipsoid", "same", "ellipsoid"), ("ellipsoid", "egm96", "the file has heights above"),
        ("ellipsoid", {"undulation_m": 40.0}, "the file has heights above the ellipsoid: leave it"),
        (None, {"undulation_m": 40.0}, "undulation"),
    ],
)  # fmt: skip
def test_heights_of_a_track_by_its_format_and_the_project(
    own: str | None, given: Any, found: str | None
) -> None:
    rows = TrackRows(np.zeros((1, 3)), True, None, None, None, "", height=own)
    section = Section("p.toml", "track", {} if given is None else {"height": given})
    if found is not None and found.startswith("the file"):
        said = told(lambda: _track_height(section, rows))
        assert said.startswith(f"p.toml: [track] height: {found}")
        return
    datum = _track_height(section, rows)
    assert (datum.name if datum else None) == found
    assert datum is None or datum.undulation_m == (40.0 if found == "undulation" else 0.0)


@pytest.mark.parametrize("scale", [1e-14, 1.0, 1e12])
def test_a_first_attitude_does_not_depend_on_the_size_of_weights(scale: float) -> None:
    """Rays of a known turn; one of the frames has two alike."""
    rng = np.random.default_rng(2)
    direction = rng.normal(size=(2, 4, 3))
    direction /= np.linalg.norm(direction, axis=2, keepdims=True)
    direction[1] = direction[1, 0]
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    weight = scale * rng.uniform(0.5, 2.0, (2, 4))
    found = first_attitude(direction @ turn.T, direction, weight)
    assert found.determined.tolist() == [True, False]
    assert_close("unit rotation", found.rotation[0], turn)
