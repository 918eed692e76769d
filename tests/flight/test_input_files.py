"""Files that a project names: their text, where an error is, how a format is found."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from vopd.files import optional_package
from vopd.findings import VopdError
from vopd.flight.files import (
    InputFile,
    InputFormat,
    did_you_mean,
    open_input,
    read_by_content,
)
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.formats.wind import WIND_FORMATS


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


def test_text_is_utf_8_with_or_without_its_mark_and_any_ends_of_lines(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes("\ufeffé,b\r\n1,2\r3\n".encode())
    file = open_input("a", tmp_path)
    assert (file.text, file.head, file.name) == ("é,b\n1,2\n3\n",) * 2 + ("a",)
    given = InputFile("b", tmp_path, "of a folder")
    assert (given.text, given.head, [*given.chunks()]) == (*("of a folder",) * 2, ["of a folder"])


def test_a_text_is_read_twenty_thousand_characters_at_a_time_to_the_end_of_a_line(
    tmp_path: Path,
) -> None:
    line = "x" * 99 + "\n"
    (tmp_path / "a").write_text("12345\n" + 450 * line)
    chunks = [*open_input("a", tmp_path).chunks()]
    assert [len(one) for one in chunks] == [20006, 20100, 45006 - 40106]
    # 20000 ends within a line; 40006 at the end of one, and the next is read with it
    assert all(one.endswith("\n") for one in chunks)
    assert open_input("a", tmp_path).head == chunks[0]
    assert open_input("a", tmp_path).text == "".join(chunks) == "12345\n" + 450 * line


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("before", [0, 7, 8191, 8193, 30_000])
def test_the_first_byte_that_is_not_utf_8_is_named(
    mark: bytes, before: int, tmp_path: Path
) -> None:
    """Counted from 0, behind the mark."""
    (tmp_path / "a").write_bytes(mark + b"x" * before + b"\xc3(" + b"y" * 9000)
    said = told(lambda: open_input("a", tmp_path).text)
    assert said == f"a: not a text file in UTF-8, at byte {before}"


def test_a_file_that_cannot_be_opened_is_said_at_once(tmp_path: Path) -> None:
    assert told(lambda: open_input("x/a", tmp_path)) == (
        f"x/a: No such file or directory (paths are relative to {tmp_path})"
    )
    for name in ("", " \t"):
        assert told(lambda name=name: open_input(name, tmp_path)) == "the name of a file is needed"


def test_formats_are_named_where_none_is_recognised() -> None:
    """And in the order in which they are tried."""
    of = {
        "mrcal, Metashape XML, OpenSfM or ODM cameras.json, OpenCV yml, xml or json, COLMAP "
        "cameras.txt": LENS_FORMATS,
        "GeoJSON, gcp_list.txt, CSV (landmark,lat_deg,lon_deg,h_m or landmark,x_m,y_m,z_m)":
            LANDMARK_FORMATS,
        "CVAT XML, LabelMe JSON or a folder of it, gcp_list.txt, CSV (frame,landmark,u_px,v_px)":
            PICK_FORMATS,
        "GPX, ODM geo.txt, CSV (t_s or t_utc or image, lat_deg,lon_deg,h_m or x_m,y_m,z_m), MRK "
        "of a drone, a folder of images": TRACK_FORMATS,
        "Wyoming CSV, Wyoming text list, CSV (h_m,from_deg,speed_m_s)": WIND_FORMATS,
    }  # fmt: skip
    file = InputFile("a", Path("nowhere"), "hello\nyou\n")
    for names, formats in of.items():
        said = told(lambda formats=formats: read_by_content(formats, file))
        assert said == f"a: the format is not recognised; known are {names}"


@pytest.mark.parametrize(
    "error",
    [ValueError("v"), TypeError("v"), KeyError("v"), IndexError("v"), AttributeError("v"),
     ZeroDivisionError("v")],
)  # fmt: skip
def test_a_reader_that_fails_says_which_format_it_is(error: Exception) -> None:
    def read(file: InputFile, *more: int) -> int:
        if not more:
            raise error
        return sum(more)

    formats = [
        InputFormat("no", lambda file: False, lambda file: 0),
        InputFormat("one", lambda file: file.name == "a", read),
        InputFormat("last", lambda file: True, lambda file, *more: -1),
    ]
    file = InputFile("a", Path(), "")
    assert told(lambda: read_by_content(formats, file)) == f"a: not as one should be: {error!r}"
    assert read_by_content(formats, file, 3, 4) == 7
    assert read_by_content(formats, InputFile("b", Path(), ""), 3, 4) == -1


def test_hints_for_mistyped_words() -> None:
    """Six of ten letters in common are near, the nearest one is named."""
    assert did_you_mean("wrod", ["world", "word"]) == "; did you mean word?"
    assert did_you_mean("abcde", ["abcxy"]) == "; did you mean abcxy?"  # ratio .6
    assert did_you_mean("abcde", ["abxyz", "b"]) == "; known are abxyz, b"  # ratio .4


def test_a_package_that_is_missing_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gpxpy", None)
    assert told(lambda: optional_package("gpxpy", "gpx", "a track")) == (
        "a track needs gpxpy, which is not installed: pip install 'vopd[gpx]'"
    )
    gpx = InputFile("t.gpx", Path(), "<gpx></gpx>")
    assert told(lambda: read_by_content(TRACK_FORMATS, gpx)) == (
        "t.gpx: a GPX track needs gpxpy, which is not installed: pip install 'vopd[gpx]'"
    )
    monkeypatch.setitem(sys.modules, "yaml", None)
    lens = InputFile("l.yml", Path(), "camera_matrix: 1\n")
    assert told(lambda: read_by_content(LENS_FORMATS, lens, None)) == (
        "a lens in YAML needs yaml, which is not installed: pip install 'vopd[yaml]'"
    )
    assert optional_package("json", "", "").loads("[1]") == [1]

    def broken(module: str) -> None:
        raise ImportError("a library of it is not there")

    monkeypatch.setattr("vopd.files.import_module", broken)
    assert told(lambda: optional_package("json", "x", "a file")).startswith("a file needs json, wh")
