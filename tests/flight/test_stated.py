"""Standard deviations of rows, of what is common to a flight, and missing ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import TOML, lens_of, read_text, write_project
from tests.tolerances import assert_close
from vopd import solve_flight
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.formats.image_tags import sigma_of_tags
from vopd.flight.formats.landmarks import LANDMARK_FORMATS
from vopd.flight.formats.track import TRACK_FORMATS
from vopd.flight.project.keys import Section
from vopd.flight.project.read import read_flight
from vopd.flight.project.stated import Notes, RowSigmas, row_sigmas
from vopd.flight.solve.rotations import solve
from vopd.flight.words import flight_words

NAN = float("nan")
OWN = np.array([[0.1, 0.2, 0.3], [NAN, NAN, NAN], [0.0, 0.0, 0.0]])


def chosen(own: Any, *, usual: Any = None, **keys: Any) -> tuple[Any, Notes]:
    """The standard deviations of three rows in lines 2 to 4 of t.csv, and what is said."""
    notes = Notes([], {})
    rows = RowSigmas("t.csv", own, 3, [2, 3, 4], "column sigma_m", usual)
    return row_sigmas(Section("p.toml", "track", keys), "sigma_m", rows, notes), notes


# Rows


def test_a_row_s_own_come_before_the_key_s_and_the_usual_ones() -> None:
    found, notes = chosen(OWN, sigma_m=[1, 2, 4])
    assert found.tolist() == [[0.1, 0.2, 0.3], [1.0, 2.0, 4.0], [0.0, 0.0, 0.0]]
    assert notes.missing == {}
    assert_approved(notes.said)
    found, notes = chosen(OWN, usual=(3.0, 3.0, 5.0))
    assert found[1].tolist() == [3.0, 3.0, 5.0] and notes.missing == {}
    assert_approved(notes.said)
    found, notes = chosen(None, usual=(3.0, 3.0, 5.0))
    assert found.tolist() == [[3.0, 3.0, 5.0]] * 3
    assert_approved(notes.said)


def test_a_key_beside_a_column_without_empty_cells_is_said_to_be_unused() -> None:
    found, notes = chosen(np.full((3, 3), 0.5), sigma_m="exact")
    assert found.tolist() == [[0.5] * 3] * 3
    assert_approved(notes.said)


def test_a_component_of_a_row_may_be_the_key_s() -> None:
    found, _ = chosen(np.array([[0.1, NAN, 0.3]] * 3), sigma_m=[7, 8, 9])
    assert found.tolist() == [[0.1, 8.0, 0.3]] * 3


@pytest.mark.parametrize("own", [None, OWN, np.where(OWN > 0.0, OWN, NAN)], ids=["no", "1", "2"])
def test_rows_that_nothing_states_are_missing_by_their_lines(own: Any) -> None:
    found, notes = chosen(own)
    assert found[1].tolist() == [0.0] * 3
    assert [*notes.missing] == [("track", "sigma_m")]
    assert_approved(notes.missing["track", "sigma_m"])


# Files


def test_columns_of_three_axes_and_the_word_exact() -> None:
    head = "landmark,lat_deg,lon_deg,h_m"
    text = f"{head},sigma_e_m,sigma_n_m,sigma_u_m\na,1,2,3,.1,.2,.3\nb,1,2,3,exact,exact,\n"
    rows = read_text(LANDMARK_FORMATS, "m.csv", text)
    expected = [[0.1, 0.2, 0.3], [0.0, 0.0, NAN]]
    assert np.array_equal(rows.sigma_m, expected, equal_nan=True)
    for wrong in (
        f"{head},sigma_e_m,sigma_n_m\na,1,2,3,.1,.2\n",
        f"{head},sigma_m,sigma_e_m,sigma_n_m,sigma_u_m\na,1,2,3,1,.1,.2,.3\n",
        f"{head},sigma_m\na,1,2,3,0\n",
        f"{head},sigma_m\na,1,2,3,exakt\n",
    ):
        with refused(VopdError):
            read_text(LANDMARK_FORMATS, "m.csv", wrong)


def test_velocities_have_columns_of_their_own() -> None:
    head = "t_s,x_m,y_m,z_m,vn_m_s,ve_m_s,vd_m_s,sigma_vn_m_s,sigma_ve_m_s,sigma_vd_m_s"
    rows = read_text(TRACK_FORMATS, "t.csv", f"{head}\n0,1,2,3,4,5,6,.1,.2,.3\n")
    assert rows.velocity_sigma_m_s.tolist() == [[0.1, 0.2, 0.3]] and rows.sigma_m is None


def test_standard_deviations_of_velocities_that_are_not_there_are_told(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    head, *rows = (tmp_path / "track.csv").read_text().split()
    more = ",sigma_vn_m_s,sigma_ve_m_s,sigma_vd_m_s"
    text = "\n".join([head + more, *(f"{row},.1,.1,.2" for row in rows), ""])
    (tmp_path / "track.csv").write_text(text)
    assert_approved([one.message for one in read_flight(str(path)).findings])


def test_a_receiver_s_own_sigmas_need_what_is_common_to_its_positions(tmp_path: Path) -> None:
    """Four positions 3 m off each would be 1.5 m off in the mean; a CSV's columns are stated."""
    path = write_project(tmp_path, TOML.replace('"track.csv"', '"t.gpx"'))
    rows = [row.split(",") for row in (tmp_path / "track.csv").read_text().split()[1:]]
    here = "<trkpt lat='{}' lon='{}'><ele>{}</ele><time>2026-05-01T11:58:{:02.0f}Z</time>"
    points = [
        here.format(b, c, h, 42.0 + float(t)) + "<hdop>{}</hdop></trkpt>" for t, b, c, h in rows
    ]
    head = "<gpx version='1.1' creator='x' xmlns='http://www.topografix.com/GPX/1/1'><trk><trkseg>"
    text = head + "".join(points) + "</trkseg></trk></gpx>"

    def told() -> list[str]:
        found = [one.message for one in read_flight(str(path)).findings]
        return [one for one in found if "sigma_bias_m" in one]

    (tmp_path / "t.gpx").write_text(text.replace("{}", "1.0"))
    assert_approved(told())
    path.write_text(path.read_text().replace("sigma_t_s", "sigma_bias_m = 2.0\nsigma_t_s"))
    assert told() == []
    path.write_text(path.read_text().replace("sigma_bias_m = 2.0\n", ""))
    (tmp_path / "t.gpx").write_text(text.replace("{}", "0.05"))  # .15 m, .25 m upward
    assert told() == []


def test_dilutions_of_gpx_are_times_3_m_and_5_m_upward() -> None:
    """hdop .8 and vdop 1.2; pdop 2 for both; none; one that is none."""
    points = ("<hdop>0.8</hdop><vdop>1.2</vdop>", "<pdop>2</pdop>", "", "<pdop>-1</pdop>")
    body = "".join(
        f'<trkpt lat="1" lon="2"><ele>3</ele><time>2026-05-01T00:00:0{k}Z</time>{one}</trkpt>'
        for k, one in enumerate(points)
    )
    head = '<gpx version="1.1" creator="x" xmlns="http://www.topografix.com/GPX/1/1">'
    rows = read_text(TRACK_FORMATS, "t.gpx", f"{head}<trk><trkseg>{body}</trkseg></trk></gpx>")
    assert_close("table value", rows.sigma_m[:2], [[2.4, 2.4, 6.0], [6.0, 6.0, 10.0]])
    assert np.isnan(rows.sigma_m[2:]).all()


def test_accuracies_of_geo_txt_are_above_0() -> None:
    line = "A.JPG 1 2 3 0 0 0 {} {}"
    for accuracies, expected in ((("0.5", "0.9"), [0.5, 0.5, 0.9]), (("0", "nan"), None)):
        text = f"EPSG:4326\n{line.format(*accuracies)}\n"
        rows = read_text(TRACK_FORMATS, "geo.txt", text)
        assert (None if rows.sigma_m is None else rows.sigma_m[0].tolist()) == expected
    with refused(VopdError):
        read_text(TRACK_FORMATS, "geo.txt", f"EPSG:4326\n{line.format('-1', '2')}\n")


@pytest.mark.parametrize(
    ("gps", "xmp", "expected"),
    [
        ({}, 'd:RtkStdLon="0.01" d:RtkStdLat="0.02" d:RtkStdHgt="0.03"', [0.01, 0.02, 0.03]),
        ({0x1F: 6.0}, 'c:GPSXYAccuracy="1.5" c:GPSZAccuracy="2"', [1.5, 1.5, 2.0]),
        ({0x1F: 6.0, 0x0B: 9.0}, 'd:RtkStdLon="0" d:RtkStdLat="0"', [6.0, 6.0, 10.0]),
        ({0x0B: 2.0}, "", [6.0, 6.0, 10.0]),
        ({0x0B: 0.0, 0x1F: "?"}, "", [NAN] * 3),
    ],
)
def test_accuracies_of_an_image_s_tags(
    gps: dict[int, Any], xmp: str, expected: list[float]
) -> None:
    found, by = sigma_of_tags(gps, xmp)
    assert_close("table value", found, expected)
    assert_approved(by) if by else None


METASHAPE = """<calibration><projection>frame</projection><width>64</width><height>48</height>
<f>70</f><k1>-0.1</k1><covariance><params>f cx K1 p1</params>
<coeffs>4 0 0 0  0 9 0 0  0 0 .0001 0  0 0 0 {}</coeffs></covariance></calibration>"""


def test_a_calibration_s_covariance_has_the_sigmas_of_the_lens() -> None:
    """Its p1 is p2 here; the roots of its diagonal."""
    found = lens_of(METASHAPE.format("1e-6"))
    expected = {"focal": 2.0, "centre_u": 3.0, "k1": 0.01, "p2": 0.001}
    assert {name: round(one, 12) for name, one in found.sigma.items()} == expected
    assert_approved(found.said)
    for wrong in ("-1", "", "x", "nan"):
        with refused(VopdError):
            lens_of(METASHAPE.format(wrong))


# A flight


def flight(folder: Path, *changes: tuple[str, str], more: str = "") -> Flight:
    toml = TOML
    for old, new in changes:
        assert old in toml
        toml = toml.replace(old, new)
    return read_flight(str(write_project(folder, toml + more)))


def test_frames_have_their_parts_in_the_fixes_about_them(tmp_path: Path) -> None:
    """Positions are at 1, 2, 3 and 4 s, and frames at 2, 2.1 ... 2.4 s."""
    exact = 'sigma_m = "exact"\nsigma_t_s = "exact"'
    path = flight(tmp_path, (exact, "sigma_m = [1, 2, 3]\nsigma_bias_m = 4\nsigma_t_s = 5")).path
    assert path.fixes is not None and path.fixes.first.tolist() == [1] * 5
    part = np.arange(5) / 10.0
    assert_close("ratio", path.fixes.weight, np.stack([1.0 - part, part], axis=1))
    assert path.fixes.sigma_m.tolist() == [[1.0, 2.0, 3.0]] * 4
    assert path.bias_sigma_m.tolist() == [4.0] * 3


def test_what_is_exact_and_what_is_not_stated(tmp_path: Path) -> None:
    options = flight(tmp_path, more='[uncertainty]\nfocal_rel = "exact"\nk1 = 0.01\n').options
    assert options.exact == ("position", "landmark", "focal", "time")
    assert options.parameter_sigma == {"focal": 0.0, "k1": 0.01, "clock": 0.0, "refraction": 0.065}
    with refused(VopdError):  # without a rolling shutter
        flight(tmp_path, more="[uncertainty]\nreadout_ms = 2\n")
    more = "[uncertainty]\np1p2 = 0.1\nclock_rate_ppm = 20\n[atmosphere]\n"
    options = flight(tmp_path, more=f'{more}refraction = "off"\n').options
    assert "refraction" not in options.exact
    options = flight(tmp_path, more=f'{more}refraction = "off"\nsigma_k = 0.5\n').options
    expected = {"p1": 0.1, "p2": 0.1, "clock_rate": 2e-5, "refraction": 0.5}
    expected["clock"] = 0.0
    assert {name: round(one, 12) for name, one in options.parameter_sigma.items()} == expected


@pytest.mark.parametrize(
    ("more", "gone", "left"),
    [
        ('[uncertainty]\nk1 = "exact"\n', "", "distortion"),
        ('[uncertainty]\nk1 = "exact"\nk2 = 0\np1p2 = "exact"\n', "distortion", "mount"),
        ('[uncertainty]\nk1 = "exact"\nk2 = 0\np1p2 = 1e-5\n', "", "mount"),
        ('[vehicle]\nmount_sigma_deg = "exact"\n', "mount", "wind"),
        ("[vehicle]\nmount_sigma_deg = 0.1\n", "", "wind"),
    ],
)
def test_errors_that_are_exact_are_not_left_out(
    more: str, gone: str, left: str, tmp_path: Path
) -> None:
    """A lens is so if all coefficients are that a key states."""
    named = left_out(flight(tmp_path, more=more))
    assert left in named and (gone not in named or not gone)


@pytest.mark.parametrize(("model", "of"), [
    ("fisheye\", fx_px = 1500, k = [0.01]", "k1, k2"),
    ("radial-table\", fx_px = 1500, table_px = [[9, 0], [2000, 9]]", ""),
])  # fmt: skip
def test_the_keys_of_coefficients_are_those_that_the_lens_has(
    model: str, of: str, tmp_path: Path
) -> None:
    lens = next(line for line in TOML.splitlines() if line.startswith("lens = "))
    named = left_out(flight(tmp_path, (lens, f'lens = {{ model = "{model} }}')))
    assert named.get("distortion", "") == (f"[uncertainty] {of}" if of else "")


def left_out(one: Flight) -> Mapping[str, str]:
    """The errors that could be stated, and where."""
    return flight_words(solve(one)).sigma_keys


def test_a_weave_that_the_noise_of_positions_hides_is_left_out(tmp_path: Path) -> None:
    """One of 6 m in 12 s moves by 3.1 m/s, across the track's 20.7 at most."""
    read = flight(tmp_path)
    assert read.path.weave is not None and "weaving" not in left_out(read)  # of exact positions

    def with_weave(size_m: float, sigma_m_s: float, **more: Any) -> Flight:
        sigma = np.full((5, 3), sigma_m_s)
        path = replace(read.path, weave=(size_m, 12.0), velocity_sigma_m_s=sigma, **more)
        return replace(read, path=path)

    assert_approved(left_out(with_weave(6.0, 2.2))["weaving"])
    wind = np.tile([20.0, 0.0], (5, 1))
    assert_approved(left_out(with_weave(6.0, 2.2, wind_m_s=wind))["weaving"])
    assert "weaving" not in left_out(with_weave(6.0, 2.3))  # the fit is as unsure itself
    assert "weaving" not in left_out(with_weave(0.0005, 0.0))
    unknown = np.full((5, 3), np.nan)
    assert "weaving" not in left_out(with_weave(6.0, 2.2, velocity_m_s=unknown))
    own = flight(tmp_path, ('sigma_t_s = "exact"', 'sigma_t_s = "exact"\nvelocity_sigma_m_s = 1'))
    assert own.path.weave is None


def test_exact_velocities_are_exact_where_the_track_ends_before_the_frames(tmp_path: Path) -> None:
    """Of frames 3.8 to 4.2 s the track has those up to 4 s."""
    project = write_project(
        tmp_path,
        TOML.replace("first_frame_t_s = 2.0", "first_frame_t_s = 3.8").replace(
            'sigma_t_s = "exact"', 'sigma_t_s = "exact"\nvelocity_sigma_m_s = "exact"'
        ),
    )
    head, *rows = (tmp_path / "track.csv").read_text().splitlines()
    rows = [head + ",vn_m_s,ve_m_s,vd_m_s", *(f"{row},20,5,-2" for row in rows), ""]
    (tmp_path / "track.csv").write_text("\n".join(rows))
    read = read_flight(str(project))
    assert np.isnan(read.path.position_m[:, 0]).tolist() == [False] * 3 + [True] * 2
    assert "velocity" in read.options.exact


def test_the_rate_of_the_clock_where_all_else_is_exact(tmp_path: Path) -> None:
    """It was in no sigma of a flight whose positions and landmarks are exact."""
    exact, stated = 'sigma_t_s = "exact"', "sigma_t_s = 0.1"
    name, rate = "sigma_time_camera_yaw_deg", "[uncertainty]\nclock_rate_ppm = 1e5\n"
    late = solve_flight(write_project(tmp_path, TOML.replace(exact, stated))).to_dataframe()
    path = write_project(tmp_path, TOML + rate)
    slow = solve_flight(path).to_dataframe()
    since_s = np.array([-0.2, -0.1, 0.0, 0.1, 0.2])  # of the middle; a tenth of it is the error
    expected = np.abs(since_s)[[0, 1, 3, 4]] * late[name].to_numpy()[[0, 1, 3, 4]]
    found = slow[name].to_numpy()[[0, 1, 3, 4]]
    assert_close("ratio", found / expected, np.ones(4))
    path.write_text(TOML.replace(exact, stated) + rate)
    both = solve_flight(path).to_dataframe()[name].to_numpy()[[0, 1, 3, 4]]
    together = np.hypot(found, late[name].to_numpy()[[0, 1, 3, 4]])
    assert_close("ratio", both / together, np.ones(4))


def test_a_lens_has_only_its_own_coefficients(tmp_path: Path) -> None:
    fisheye = ('"brown"', '"fisheye"'), (", -2e-3, 3e-3]", "]")
    with refused(VopdError):
        flight(tmp_path, *fisheye, more="[uncertainty]\np1p2 = 0.1\n")
    assert flight(tmp_path, *fisheye, more='[uncertainty]\np1p2 = "exact"\n').path.fixes is None


@pytest.mark.parametrize(
    ("key", "value"),
    [("sigma_m", '"exakt"'), ("sigma_m", '[1, "exact", 1]'), ("sigma_m", "-1"),
     ("sigma_m", "[1, 2]"), ("sigma_m", "true"), ("velocity_sigma_m_s", "[1, 2]")],
)  # fmt: skip
def test_wrong_values_are_named(key: str, value: str, tmp_path: Path) -> None:
    exact = 'sigma_m = "exact"\nsigma_t_s'
    new = f"{key} = {value}\nsigma_t_s" if key == "sigma_m" else f"{key} = {value}\n{exact}"
    with refused(VopdError, parts=[key]):
        flight(tmp_path, (exact, new))


def test_all_missing_ones_are_named_at_once_with_the_lines_to_paste(tmp_path: Path) -> None:
    with refused(VopdError):
        flight(tmp_path, ('sigma_m = "exact"\n', ""), ('sigma_t_s = "exact"\n', ""))


def test_a_common_error_that_is_stated_is_not_among_the_lines_to_paste(tmp_path: Path) -> None:
    track = (
        '[track]\nfile = "track.csv"\nheight = "ellipsoid"\nsigma_m = "exact"\n',
        '[track]\nfile = "track.csv"\nheight = "ellipsoid"\nsigma_bias_m = 2.0\n',
    )
    with refused(VopdError):
        flight(tmp_path, track)


def test_an_empty_cell_without_a_key_is_named_by_its_line(tmp_path: Path) -> None:
    project = write_project(tmp_path, TOML.replace('sigma_m = "exact"\n[track]', "[track]"))
    head, *rows = (tmp_path / "landmarks.csv").read_text().split()
    cells = [f"{row},{0.1 if k else ''}" for k, row in enumerate(rows)]
    (tmp_path / "landmarks.csv").write_text("\n".join([f"{head},sigma_m", *cells]))
    with refused(VopdError, parts=["line 2"]):
        read_flight(str(project))


@pytest.mark.parametrize("size", [1e-10, 1e10, 1e300])
def test_a_size_that_nobody_means_is_refused(size: float) -> None:
    own = OWN.copy()
    own[1, 2] = size
    with refused():
        chosen(own, sigma_m=1)
    with refused():
        chosen(OWN, sigma_m=size)


@pytest.mark.parametrize(
    ("section", "key", "most", "beyond"),
    [
        ("uncertainty", "focal_rel", 0.5, 5.0), ("uncertainty", "clock_rate_ppm", 5e5, 1e6),
        ("atmosphere", "sigma_k", 5.0, 13.0),
    ],
)  # fmt: skip
def test_standard_deviations_of_another_unit(
    section: str, key: str, most: float, beyond: float
) -> None:
    """Percents in the place of a part made intervals of 30 degrees, and nothing said why."""
    assert Section("p.toml", section, {key: most}).sigma(key) == (most,)
    with refused(VopdError):
        Section("p.toml", section, {key: beyond}).sigma(key)
