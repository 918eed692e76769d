"""Keys and columns that nothing uses: what is said of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import ROOT, vopd
from tests.kit.flight_project import TOML, read_text, write_project
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.findings import VopdError
from vopd.flight.coordinates import doubt_of_heights
from vopd.flight.flight import Flight
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.picks import PICK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.formats.wind import WIND_FORMATS
from vopd.flight.project.read import read_flight
from vopd.flight.result import solve_flight, unused_options
from vopd.inputs import utc_moment

OPENCV = (
    '{"image_width": 1920, "image_height": 1080, "camera_matrix": [[1500, 0, 960], '
    '[0, 1500, 540], [0, 0, 1]], "distortion_coefficients": [0, 0, 0, 0, 0]}'
)
TABLE = TOML[TOML.index("lens =") : TOML.index("[picks]")]
PLACE = '[position]\nlat_deg = 47.6\nlon_deg = 16.4\nh_m = 540\nheight = "ellipsoid"\nsigma_m = 1\n'


def flight(folder: Path, *changes: tuple[str, str]) -> Flight:
    toml = TOML
    for before, after in changes:
        assert before in toml
        toml = toml.replace(before, after)
    return read_flight(str(write_project(folder, toml)))


def by_image(folder: Path, times: str = "") -> list[tuple[str, str]]:
    """Change the project to picks in images and a track of these."""
    write_project(folder)
    picks = (folder / "picks.csv").read_text().replace("frame,", "image,")
    (folder / "named.csv").write_text(picks.replace("\n", "\na")[:-1])
    rows = (folder / "track.csv").read_text().splitlines()[2]
    of_images = [f"a{k},{2 + k / 10},{rows.partition(',')[2]}" for k in range(5)]
    header = "image,t_s,lat_deg,lon_deg,h_m"
    if not times:
        of_images = [",".join(one.split(",")[:1] + one.split(",")[2:]) for one in of_images]
        header = header.replace(",t_s", "")
    (folder / "places.csv").write_text("\n".join([header, *of_images, ""]))
    timed = "frame_rate_hz = 10.0\nfirst_frame_t_s = 2.0\n"
    return [("picks.csv", "named.csv"), ("track.csv", "places.csv"), (timed, "")]


KEYS = {
    "a pixel grid beside a lens file": [
        (TABLE, 'lens = "lens.json"\n'), ('"centre"\nlens', '"corner"\nlens'),
    ],
    "a zone without images": [("[landmarks]", "utc_offset_h = 2.0\n[landmarks]")],
    "a first frame without a rate": [("frame_rate_hz = 10.0", 'times = "times.csv"')],
    "attitudes without a file": [("[picks]\n", "[vehicle]\nattitude_sigma_deg = 0.2\n[picks]\n")],
    "a clock of a camera in one place": [
        (TOML[TOML.index("[track]") :], f"{PLACE}[uncertainty]\nclock_rate_ppm = 20\n"),
    ],
    "a lens beside those of images": [("[camera]\n", '[camera]\nof_images = "lenses.csv"\n')],
    "a sensor of another shape": [
        ("fx_px = 1500.0, fy_px = 1490.0", "focal_mm = 28.0, sensor_mm = [36.0, 24.0]"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", KEYS)
def test_keys_without_an_effect(name: str, tmp_path: Path) -> None:
    (tmp_path / "lens.json").write_text(OPENCV)
    rows = ["frame,lens", *(f"{k},lens.json" for k in range(5)), ""]
    (tmp_path / "lenses.csv").write_text("\n".join(rows))
    (tmp_path / "times.csv").write_text("".join(["frame,t_s\n", *(f"{k},2\n" for k in range(1))]))
    found = flight(tmp_path, *KEYS[name]).findings
    assert_approved([str(one).rpartition("flight.toml: ")[2] for one in found[-1:]])


@pytest.mark.parametrize("times", ["", "times"])
def test_keys_of_a_track_by_time(times: str, tmp_path: Path) -> None:
    """Without times none of them moves anything, with times interpolation does not."""
    clock = '[uncertainty]\nclock_rate_ppm = 20\n[track]\nclock = "seconds"\noffset_s = 1\n'
    changes = [("[track]\n", f'{clock}interpolate = "cubic"\n'), *by_image(tmp_path, times)]
    found = flight(tmp_path, *changes).findings
    assert_approved([str(one).rpartition("flight.toml: ")[2] for one in found])


def test_a_sensor_of_nearly_the_shape_of_the_image(tmp_path: Path) -> None:
    """Sizes of sensors are rounded: 6.17 by 3.4 mm of 16 to 9."""
    sensor = "focal_mm = 5.0, sensor_mm = [6.17, 3.4]"
    assert not flight(tmp_path, ("fx_px = 1500.0, fy_px = 1490.0", sensor)).findings
    off = sensor.replace("3.4", "3.61")  # 4 %
    assert flight(tmp_path, ("fx_px = 1500.0, fy_px = 1490.0", off)).findings


def test_a_place_in_degrees_and_metres(tmp_path: Path) -> None:
    place = "[position]\nlat_deg = 47.6\nlon_deg = 16.4\nh_m = 540\nx_m = 5\nsigma_m = 1\n"
    with refused(VopdError):
        flight(tmp_path, (TOML[TOML.index("[track]") :], f'{place}height = "ellipsoid"\n'))


def test_a_camera_of_a_table(tmp_path: Path) -> None:
    with refused(VopdError):
        flight(tmp_path, ("[picks]\n", 'camera = "1"\n[picks]\n'))


def test_heights_beside_a_grid_in_feet() -> None:
    """They are metres in files without columns, which nothing said."""
    assert_approved(doubt_of_heights("landmarks", False, "EPSG:2229"))
    for named, crs in ((True, "EPSG:2229"), (False, "EPSG:32633"), (False, None)):
        assert doubt_of_heights("track", named, crs) == []
    assert doubt_of_heights("track", False, "EPSG:2229+6360") == []  # it says that heights are feet


@pytest.mark.parametrize(
    ("formats", "text", "named"),
    [
        (LANDMARK_FORMATS, "landmark,x_m,y_m,z_m\na,1,2,3\n", True),
        (LANDMARK_FORMATS, "EPSG:2229\n500000 5300000 300 4 5 a.jpg n\n", False),
        (TRACK_FORMATS, "t_s,x_m,y_m,z_m\n1,1,2,3\n2,1,2,3\n", True),
    ],
)
def test_a_csv_names_the_unit_of_its_heights(formats: Any, text: str, named: bool) -> None:
    assert read_text(formats, "f", text).names_units == named


# Options

NOT_OF_ONE_FRAME = [
    "--max-rate",
    "3",
    "--time-sigma",
    "1",
    "--velocity-sigma",
    "2",
    "--wind-sigma",
    "2",
]
OPTIONS = HistoryOptions(Sigmas(time_s=1.0, velocity=2.0, wind=2.0), max_rate_deg_s=3.0)
STANDING = TOML[TOML.index("[track]") :], PLACE


def test_options_without_an_effect(tmp_path: Path) -> None:
    summits = solve_flight(ROOT / "examples" / "summits" / "flight.toml")
    assert_approved([str(one) for one in unused_options(summits, OPTIONS)])
    standing = solve_flight(flight(tmp_path, STANDING))
    assert_approved([one.message for one in unused_options(standing, OPTIONS)])


def test_one_frame_with_a_time_has_no_rate(tmp_path: Path) -> None:
    project = write_project(tmp_path, TOML.replace(*STANDING))
    picks = tmp_path / "picks.csv"
    lines = picks.read_text(encoding="utf-8").splitlines(keepends=True)
    picks.write_text("".join(lines[:7]), encoding="utf-8")
    result = solve_flight(project)
    assert np.isfinite(result.time_s).tolist() == [True]
    (told,) = unused_options(result, HistoryOptions(max_rate_deg_s=3.0))
    assert told.message.startswith("maximum rate: is not used")


def test_a_track_of_a_camera_that_stands_has_no_use_for_errors_of_time(tmp_path: Path) -> None:
    project = write_project(tmp_path)
    head, row, *_ = (tmp_path / "track.csv").read_text(encoding="utf-8").splitlines()
    place = row.partition(",")[2]
    rows = "".join(f"{second},{place}\n" for second in (1, 2, 3, 4))
    (tmp_path / "track.csv").write_text(f"{head}\n{rows}", encoding="utf-8")
    (told,) = unused_options(solve_flight(project), HistoryOptions(Sigmas(time_s=1.0)))
    assert told.message.startswith("time sigma: is not used")


def test_options_that_have_one_or_are_not_given(tmp_path: Path) -> None:
    assert not unused_options(solve_flight(flight(tmp_path)), OPTIONS)
    summits = solve_flight(ROOT / "examples" / "summits" / "flight.toml")
    assert not unused_options(summits, HistoryOptions(Sigmas(landmark=1.0)))


@pytest.mark.parametrize("command", ["attitude -o a.csv", "attitude --format text", "batch -d out"])
def test_commands_say_it(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    summits = ROOT / "examples" / "summits" / "flight.toml"
    name, *rest = command.split()
    done = vopd(name, summits, *rest, *NOT_OF_ONE_FRAME)
    said = done.stderr if name == "attitude" else Path("out/summary.jsonl").read_text()
    assert ("sigma: is not used" if name == "attitude" else '"warnings": 4') in said


# Columns

TRACK = "t_s,lat_deg,lon_deg,h_m"


@pytest.mark.parametrize(
    ("formats", "text"),
    [
        (TRACK_FORMATS, f"{TRACK},speed,heading\n1,2,3,4,5,6\n"),
        (TRACK_FORMATS, "date,time_utc,lat,lon,h,t_s\n2026-05-01,1:2:3,2,3,4,5\n"),
        (TRACK_FORMATS, "date,time_utc,utc_date,lat,lon,h\n2026-05-01,01:02:03,2026-05-02,2,3,4\n"),
        (TRACK_FORMATS, "date,t_utc,lat,lon,h\n2026-05-02,2026-05-01T01:02:03Z,2,3,4\n"),
        (LANDMARK_FORMATS, "name,lat,lon,alt,alt_sigma\na,2,3,4,5\n"),
        (PICK_FORMATS, "frame,image,landmark,u,v,x,y\n1,a.png,b,3,4,5,6\n"),
        (PICK_FORMATS, "frame,landmark,u,v," + ",".join("abcdefghijklmno") + "\n1,a,3,4"
         + ",5" * 15),
    ],
)  # fmt: skip
def test_columns_that_are_not_read(formats: object, text: str) -> None:
    assert_approved(read_text(formats, "t.csv", text).said)  # type: ignore[arg-type]


def test_columns_that_a_project_names_are_known_to_it(tmp_path: Path) -> None:
    (tmp_path / "marks.csv").write_text("a,2,3,4,5\n")
    columns = 'columns = ["landmark", "lat_deg", "lon_deg", "h_m", "note"]'
    changes = ("landmarks.csv", "marks.csv"), ('marks.csv"\n', f'marks.csv"\n{columns}\n')
    assert "not used" not in " ".join(flight(tmp_path, *changes).about)


@pytest.mark.parametrize("name", ["height_agl", "Alt AGL (ft)", "height above ground"])
def test_heights_from_the_ground_of_winds(name: str) -> None:
    """They were taken for heights above the level of the track's; a track's own are asked for."""
    with refused(VopdError):
        read_text(WIND_FORMATS, "t.csv", f"{name},from_deg,speed_m_s\n0,240,3\n9,240,3\n")
    assert read_text(TRACK_FORMATS, "t.csv", f"t_s,lat_deg,lon_deg,{name}\n1,2,3,4\n").from_ground


SAID = {"landmarks": "height_msl", "track": "Ellipsoidal height"}
"""Columns of heights of two levels."""
GROUND = "{ ground_m = 400.0 }"


@pytest.mark.parametrize(
    ("section", "column", "height"),
    [
        ("landmarks", "h_m (ellipsoid)", '"egm2008"'),
        ("landmarks", "ell_height", "{ undulation_m = 5 }"),
        ("landmarks", "alt_amsl", '"ellipsoid"'),
        ("landmarks", "alt_agl", '"ellipsoid"'),
        ("track", "alt_agl", '"egm96"'),
        ("track", "altitude_above_seaLevel", GROUND),
        ("track", "HAE", GROUND),
    ],
)
def test_a_height_of_another_level_than_its_column_says(
    section: str, column: str, height: str, tmp_path: Path
) -> None:
    project = with_column(tmp_path, section, column, height)
    with refused(VopdError):
        read_flight(str(project))


@pytest.mark.parametrize(
    ("section", "column", "height"),
    [
        ("landmarks", "ellipsoidal height", '"ellipsoid"'),
        ("landmarks", "alt_msl", "{ undulation_m = 45.0 }"),
        ("landmarks", "alt_agl", "{ undulation_m = 400.0 }"),
        ("track", "alt_agl", GROUND),
    ],
)
def test_a_height_of_the_level_that_its_column_says(
    section: str, column: str, height: str, tmp_path: Path
) -> None:
    assert read_flight(str(with_column(tmp_path, section, column, height))).name


def test_one_level_that_is_not_stated_is_not_of_two_names(tmp_path: Path) -> None:
    for section, column in SAID.items():
        project = with_column(tmp_path, section, column, '"same"')
    with refused(VopdError):
        read_flight(str(project))
    assert read_flight(str(with_column(tmp_path, "track", SAID["landmarks"], '"same"'))).name


def with_column(folder: Path, section: str, column: str, height: str) -> Path:
    """A project whose file of a section has heights of this name, and this `height`."""
    project = folder / "flight.toml"
    if not project.exists():
        write_project(folder)
    head, own, rest = project.read_text().partition(f"[{section}]\n")
    before, _, after = rest.partition("height =")
    project.write_text(f"{head}{own}{before}height = {height}\n{after.partition(chr(10))[2]}")
    file = folder / f"{section}.csv"
    head, _, rows = file.read_text().partition("\n")
    file.write_text(f"{head.rpartition(',')[0]},{column}\n{rows}")
    return project


@pytest.mark.parametrize("name", ["Sigma_m", "SIGMA (m)", "sigma_m"])
def test_standard_deviations_in_any_spelling(name: str) -> None:
    """A column `Sigma_m` was left out, and its positions counted as exact."""
    rows = read_text(TRACK_FORMATS, "t.csv", f"{TRACK},{name}\n1,2,3,4,5\n")
    assert rows.sigma_m.tolist() == [[5.0] * 3]


SIGNS = "name,lat,ns,lon,ew,h\n"


@pytest.mark.parametrize(
    "row",
    [
        "a,2,S,3,E,4",
        "a,2,N,3,w,4",
        "a,2,,3,E,4\nb,2,s,3,E,4",
        "a,2,South,3,East,4",
        "a,2,N,3,E,4\nb,2,N,5,O,4",
    ],
)
def test_a_sign_in_a_column_of_its_own(row: str) -> None:
    """Of a place in the south-west all angles were turned by 180 degrees, with no residual."""
    with refused(VopdError):
        read_text(LANDMARK_FORMATS, "t.csv", f"{SIGNS}{row}\n")
    header, timed = SIGNS.replace("name", "t_s"), row.replace("a,", "1,").replace("b,", "2,")
    with pytest.raises(VopdError, match="sign"):
        read_text(TRACK_FORMATS, "t.csv", f"{header}{timed}\n")


@pytest.mark.parametrize(
    "row",
    [
        "a,-2,S,-3,W,4",
        "a,2,N,3,E,4",
        "a,2,S1,3,S2,4",
        "a,2,,3,,4",
        "a,2,North,3,O,4",
        "a,2,N,-3,W,4\nb,2,N,5,O,4",
    ],
)
def test_signs_that_the_numbers_have(row: str) -> None:
    assert read_text(LANDMARK_FORMATS, "t.csv", f"{SIGNS}{row}\n").coordinate[0, 2] == 4.0


@pytest.mark.parametrize("cell", ["47 38 50.2", "47.6N", "47°38'50\""])
def test_degrees_in_other_notations(cell: str) -> None:
    with refused(VopdError):
        read_text(LANDMARK_FORMATS, "t.csv", f"landmark,lat_deg,lon_deg,h_m\na,{cell},3,4\n")


# Moments

LOOSE = ["2026-05-01T11:58,5Z", "2026-05-01T11:58:43:12Z", "2026-05-01T11:58:43:Z"]


@pytest.mark.parametrize("text", LOOSE)
def test_fractions_that_no_second_has(text: str) -> None:
    """Half a minute was read as half a second, and the frame of a time code as hundredths."""
    with refused(VopdError):
        read_text(TRACK_FORMATS, "t.csv", f"t_utc;lat_deg;lon_deg;h_m\n{text};2;3;4\n")
    with pytest.raises(VopdError):
        utc_moment(text)


@pytest.mark.parametrize(
    "text",
    ["2026-05-01T11:58:43.5Z", "2026-05-01 13:58:43,5+02:00", "20260501T115843.5Z",
     "2026-W18-5T11:58:43.5Z"],
)  # fmt: skip
def test_moments_in_iso_8601(text: str) -> None:
    rows = read_text(TRACK_FORMATS, "t.csv", f"t_utc;lat_deg;lon_deg;h_m\n{text};2;3;4\n")
    assert rows.time_s.tolist() == [1777636723.5]  # date -u -d 2026-05-01T11:58:43Z +%s
