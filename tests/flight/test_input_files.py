"""Files that a project names: their text, where an error is, how a format is found."""

from __future__ import annotations

import os
import sys
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.tolerances import assert_close
from vopd.files import A_VIDEO, install_command, kind_by_first_bytes, optional_package, reason
from vopd.findings import VopdError, did_you_mean
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import InputFile, open_input
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.lens import LENS_FORMATS
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS, TrackRows
from vopd.flight.formats.wind import WIND_FORMATS
from vopd.flight.project.keys import Section
from vopd.flight.project.times import times_of_csv
from vopd.flight.project.track import track_height
from vopd.flight.solve.rotations import first_attitude
from vopd.inputs import no_file, parse_json, parse_toml, parse_xml


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        action()
    return str(refusal.value)


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
    """Counted from 0, the first of the file."""
    (tmp_path / "a").write_bytes(mark + b"x" * before + b"\xc3(" + b"y" * 9000)
    said = told(lambda: open_input("a", tmp_path).text)
    assert_approved(said, parts=[len(mark) + before])


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("at", [1 << 20, (1 << 20) + 5, (1 << 21) - 1])
def test_a_text_that_ends_within_a_letter(mark: bytes, at: int, tmp_path: Path) -> None:
    """Bytes are counted over the blocks that are read, and the half letter is the first wrong."""
    (tmp_path / "a").write_bytes(mark + b"x" * at + b"\xe2\x82")
    said = told(lambda: open_input("a", tmp_path).text)
    assert_approved(said, parts=[len(mark) + at])


def test_files_that_are_too_large_are_not_read(tmp_path: Path) -> None:
    own = InputFile("a", tmp_path / "a")
    with own.path.open("wb") as file:
        file.truncate(400_000_001)
    assert_approved(told(lambda: own.text))
    with own.path.open("wb") as file:
        file.truncate(1_000_001)
    assert_approved(told(own.matlab))


def test_a_folder_that_cannot_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def closed(self: Path) -> Any:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "iterdir", closed)
    (tmp_path / "images").mkdir()
    assert_approved(told(lambda: open_input("images", tmp_path)), parts=[tmp_path])


def test_a_file_that_cannot_be_opened_is_said_at_once(tmp_path: Path) -> None:
    assert_approved(told(lambda: open_input("x/a", tmp_path)), parts=[tmp_path])
    for name in ("", " \t"):
        assert_approved(told(lambda name=name: open_input(name, tmp_path)))


def test_formats_are_named_where_none_is_recognised() -> None:
    """And in the order in which they are tried."""
    file = InputFile("a", Path("nowhere"), "hello\nyou\n")
    for formats in (LENS_FORMATS, LANDMARK_FORMATS, PICK_FORMATS, TRACK_FORMATS, WIND_FORMATS):
        assert_approved(told(lambda formats=formats: read_by_content(formats, file)))


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
    assert_approved(told(lambda: read_by_content(formats, file)))
    assert read_by_content(formats, file, 3, 4) == 7
    assert read_by_content(formats, InputFile("b", Path(), ""), 3, 4) == -1


@pytest.mark.parametrize(
    ("parse", "text"),
    [(parse_json, "[" * 5_000_001), (parse_json, "," * 20_000_001), (parse_xml, "<" * 5_000_001)],
    ids=["lists", "values", "elements"],
)
def test_more_elements_than_are_made(parse: Any, text: str) -> None:
    """They are counted before any is made, for each takes a hundred bytes."""
    with refused(ValueError):
        parse(text)


def test_hints_for_mistyped_words() -> None:
    """Six of ten letters in common are near, the nearest one is named."""
    assert_approved(did_you_mean("wrod", ["world", "word"]))
    assert_approved(did_you_mean("abcde", ["abcxy"]))
    assert_approved(did_you_mean("ab\u200bc", ["abc"]))
    assert_approved(did_you_mean("Ko\u0308", ["Ks", "K\xf6"]))  # as macOS writes it
    assert_approved(did_you_mean("church ", ["church"]))  # as a label of JSON or XML
    assert_approved(did_you_mean("old\xa0 church", ["old church"]))
    assert_approved(did_you_mean("1", ["11", "10", "01"]))
    assert did_you_mean("abcde", ["abxyz", "b"]) == "; known are abxyz, b"  # ratio .4


def test_a_package_that_is_missing_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gpxpy", None)
    assert_approved(told(lambda: optional_package("gpxpy", "gpx", "a track")))
    gpx = InputFile("t.gpx", Path(), "<gpx></gpx>")
    assert_approved(told(lambda: read_by_content(TRACK_FORMATS, gpx)))
    monkeypatch.setitem(sys.modules, "yaml", None)
    lens = InputFile("l.yml", Path(), "camera_matrix: 1\n")
    assert_approved(told(lambda: read_by_content(LENS_FORMATS, lens, None)))
    assert optional_package("json", "", "").loads("[1]") == [1]

    def broken(module: str) -> None:
        raise ImportError("a library of it is not there")

    monkeypatch.setattr("vopd.files.import_module", broken)
    assert_approved(told(lambda: optional_package("json", "x", "a file")))


def test_a_folder_of_the_name_of_a_package_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python imports a folder of the working directory as an empty package."""
    (tmp_path / "geodata").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    assert_approved(told(lambda: optional_package("geodata", "geo", "a track")))

    def unknown(_: str) -> None:
        raise PackageNotFoundError

    monkeypatch.setattr("vopd.files.ROOT", tmp_path)
    monkeypatch.setattr("importlib.metadata.requires", unknown)
    assert install_command("geo", ": ") == ""


def test_kinds_of_videos_by_their_first_bytes() -> None:
    assert kind_by_first_bytes(b"RIFF\0\0\0\0AVI LIST") == A_VIDEO
    assert kind_by_first_bytes(b"RIFF\0\0\0\0WAVEfmt ") != A_VIDEO


@pytest.mark.parametrize(
    "error",
    [OverflowError("int too large"), UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid"),
     RecursionError("maximum recursion depth"), ZeroDivisionError("division by zero"),
     ValueError("Invalid initial character for a key part (at line 2, column 26)"),
     ValueError("Unclosed inline table (at line 2, column 25)")],
    ids=["large", "bytes", "deep", "zero", "key", "braces"],
)  # fmt: skip
def test_reasons_in_plain_words(error: Exception) -> None:
    assert_approved(reason(error))


def test_settings_above_a_megabyte_and_what_is_no_file(tmp_path: Path) -> None:
    with refused(ValueError):
        parse_toml(b"#" * 1_000_001)
    assert no_file(tmp_path / "none") == "" and no_file(os.devnull, pipes=True) == ""
    assert no_file(tmp_path) == ""


@pytest.mark.parametrize("at", [1, 19_999, 20_000, 20_009, 20_010, 40_000])
def test_a_null_character_is_no_text(at: int) -> None:
    """Text is read 20,000 characters at a time, and on to the end of the line."""
    lines = "".join(f"{k:09d}\n" for k in range(6_000))
    file = InputFile("t", Path(), lines[:at] + "\0" + lines[at:])
    with pytest.raises(VopdError, match="null"):
        list(file.chunks())


def test_packages_are_installed_by_their_names(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """From a clone by its pyproject.toml, from a wheel by its metadata; vopd is on no registry."""
    wheel = ["numpy>=1.26", "geodata>=1; extra == 'geometry'", "pyproj>=3.6; extra == 'geo'"]
    assert install_command("geo", ": ") == ": pip install pyproj"
    monkeypatch.setattr("vopd.files.ROOT", tmp_path)
    monkeypatch.setattr("importlib.metadata.requires", lambda _: wheel)
    assert install_command("geo", ": ") == ": pip install pyproj"
    assert install_command("yaml") == ""


# Errors in tables of picks and times, with line and column; names of files; exact trials


PICKS = "frame,landmark,u_px,v_px\n"


@pytest.mark.parametrize(
    "text",
    [
        PICKS,
        PICKS + "# none\n\n",
        "",
        PICKS + "0,a,1,2\n1,,3,4\n",
        "image,landmark,u_px,v_px\na,b,1,2\n ,c,3,4\n",
        PICKS + "0,a,1,2\n,b,3,4\n",
        PICKS + "0,a,1,2\nx,b,3,4\n",
        PICKS + "x,a,1,2\n5,b,3,4\n",
        PICKS + "0,a,1,2\n1.5,b,3,4\n",
        PICKS + "0,a,1,2\n-1,b,3,4\n",
        PICKS + "0,a,1,2\n1,b,3\n",
        PICKS + "0,a,1,2\n1,b,3,4,5\n",
        PICKS + "0,a,1,2\n1,b,,4\n",
        PICKS + "0,a,1,2\n1,b,3,x\n",
        PICKS + "0,a,1,2\n1,b,3,1e999\n",
        "frame;landmark;u_px;v_px\n1;a;3,5;4\n",
        PICKS.replace("u_px", "v_px"),
        PICKS.replace("v_px", "v_pix") + "0,a,1,2\n",
        PICKS + '0,"a,1,2\n',
    ],
)  # fmt: skip
def test_errors_in_picks_name_line_and_column(text: str, tmp_path: Path) -> None:
    (tmp_path / "picks").write_text(text)
    file = open_input("picks", tmp_path)
    said = told(lambda: read_by_content(PICK_FORMATS, file))
    assert_approved(said)


def test_frames_by_name_and_by_number(tmp_path: Path) -> None:
    (tmp_path / "picks").write_text(PICKS + "b,m,1,2\na 7,m,3,4\n")
    rows = read_by_content(PICK_FORMATS, open_input("picks", tmp_path))
    assert [*rows.frame] == ["b", "a 7"] and rows.said == "CSV"
    (tmp_path / "picks").write_text(PICKS + "007,m,1,2\n0,m,3,4\n")
    assert read_by_content(PICK_FORMATS, open_input("picks", tmp_path)).frame.tolist() == [7, 0]


@pytest.mark.parametrize(
    "text",
    [
        "frame,t_s\n5,1\n7,3\n6,3\n",
        "frame,t_s\n5,1\n6,0.5\n",
        "frame,t_utc\n6,2026-05-01T00:00:00Z\n5,2026-05-01T00:00:01Z\n",
        "frame,t_s\n5,1\n5,2\n",
        "image,t_s\na,1\nb,3\nb,4\n",
        "image,t_s\na,1\nb,\n",
        "image,t_utc\na,2026-05-01T00:00:00\n",
        "image,t_utc\na,noon\n",
        "image,when\na,1\n",
        "frame,t_s\n5,1\n6,2\n7,3\n5,2.5\n",
    ],
)  # fmt: skip
def test_errors_in_times_name_line_and_column(text: str) -> None:
    file, section = InputFile("times", Path(), text), Section("p.toml", "picks", {})
    assert_approved(told(lambda: times_of_csv(section, file, text.startswith("image"))))


def test_times_of_frames_in_any_order() -> None:
    """A later frame may stand first; a time for images may be the same twice."""
    section = Section("p.toml", "picks", {})
    file = InputFile("times", Path(), "frame,t_s\n9,3\n5,1\n7,2\n")
    assert times_of_csv(section, file, False) == ({"9": 3.0, "5": 1.0, "7": 2.0}, False, [])
    file = InputFile("t", Path(), "image,t_utc\nb,1970-01-01T00:00:05Z\n")
    assert times_of_csv(section, file, True) == ({"b": 5.0}, True, [])


@pytest.mark.parametrize(
    "name",
    [
        "", "  ",
        "none.csv",
        "a\0b",
        "latin.csv",
    ],
)  # fmt: skip
def test_files_that_cannot_be_opened(name: str, tmp_path: Path) -> None:
    (tmp_path / "latin.csv").write_bytes(b"12345" + b"x" * 30000 + b"\xfc")

    def read() -> None:
        _ = open_input(name, tmp_path).text

    assert_approved(told(read))


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
        said = told(lambda: track_height(section, rows))
        assert_approved(said)
        return
    datum = track_height(section, rows)
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
    rotation, determined = first_attitude(direction @ turn.T, direction, weight)
    assert determined.tolist() == [True, False]
    assert_close("unit rotation", rotation[0], turn)
