"""Sections [track] and [position]: CRS, heights, by time or by image, and every refusal."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.track import TrackRows
from vopd.flight.project import Section
from vopd.flight.track import FrameTimes, PathRead, _nowhere, height_datum, read_path
from vopd.geometry.earth import earth_centred_m, geodetic

PLACE = np.array([[15.0, 45.0, 100.0], [15.0, 45.0, 130.0], [15.0, 45.0, 160.0]])  # 30 m/s up
ELLIPSOID = {"height": "ellipsoid"}


def track(**given: Any) -> TrackRows:
    usual = {"crs": None, "clock": "seconds", "time_s": np.arange(3.0), "said": "CSV, 3 rows"}
    return TrackRows(PLACE, **({"geodetic": True} | usual | given))


def times(time_s: Any = (0.5, 1.0), image: tuple[str, ...] = (), **more: Any) -> FrameTimes:
    return FrameTimes(np.array(time_s, dtype=float), image, None, **more)


def read(section: str, keys: dict[str, Any], rows: Any, when: FrameTimes) -> PathRead:
    """What is read of a project with one section, whose file holds these rows."""
    project: Any = SimpleNamespace(
        name="p.toml",
        has=lambda name: name == section,
        section=lambda name: Section("p.toml", name, keys),
        open=lambda name: SimpleNamespace(name="t.csv"),
        read=lambda *_: rows,
    )
    return read_path(project, when)


def refused(section: str, keys: dict[str, Any], rows: Any = None, when: Any = None) -> str:
    with pytest.raises(VopdError) as error:
        read(section, keys, rows, when or times())
    return str(error.value)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"lat_deg": 45.0, "lon_deg": 15.0, "h_m": 100.0}, earth_centred_m(45.0, 15.0, 100.0)),
        (
            {"lat_deg": 45.0, "lon_deg": 15.0, "h_m": 100.0, "height": {"undulation_m": 40.0}},
            earth_centred_m(45.0, 15.0, 140.0),
        ),
    ],
)
def test_a_fixed_position_is_that_of_every_frame(keys: Any, expected: Any) -> None:
    more = {"lever_arm_m": [1.0, 2.0, 3.0], "sigma_m": 0.5}
    found = read("position", ELLIPSOID | keys | more, None, times())
    assert_close("flight position", found.path.position_m, [expected, expected])
    assert found.path.sigma_m.tolist() == [0.5, 0.5, 0.5]
    assert found.path.lever_arm_m is not None
    assert found.path.lever_arm_m.tolist() == [1.0, 2.0, 3.0]
    assert found.path.velocity_m_s is None and found.path.sigma_time_s == 0.0
    assert (found.said, found.doubts) == (["one fixed position"], [])
    assert found.times.time_s.tolist() == [0.5, 1.0]


def test_a_fixed_position_in_map_coordinates_has_x_to_the_east() -> None:
    """On the central meridian of zone 33 at the equator: 500,000 east is 15 degrees."""
    keys = {"x_m": 500000.0, "y_m": 0.0, "z_m": 7.0, "crs": "EPSG:32633"}
    where = geodetic(read("position", ELLIPSOID | keys, None, times()).path.position_m)
    assert_close("latitude on either Earth", where.longitude_deg, [15.0, 15.0])
    assert_close("latitude on either Earth", where.latitude_deg, [0.0, 0.0])
    assert_close("flight position", where.height_m, [7.0, 7.0])


def test_positions_that_cannot_be_used_name_their_section() -> None:
    xyz = {"x_m": 1.0, "y_m": 2.0, "z_m": 3.0}
    assert refused("position", xyz) == "p.toml: [position] crs: is needed with x_m and y_m"
    wrong = ELLIPSOID | {"lat_deg": 95.0, "lon_deg": 15.0, "h_m": 100.0}
    assert refused("position", wrong).startswith("p.toml: [position]: latitude 95: x is")
    assert refused("track", {}, track(geodetic=False)) == (
        "p.toml: [track] crs: is needed: the file has x and y"
    )
    rows = replace(track(), coordinate=PLACE + np.array([0.0, 50.0, 0.0]))
    assert refused("track", ELLIPSOID, rows).startswith("p.toml: [track]: latitude 95: x is")


def test_the_crs_of_a_track_is_the_file_s_under_any_of_its_names() -> None:
    """WGS 84 in zone 33 is EPSG:32633; on its central meridian 15 degrees are 500,000 m."""
    own = track(crs="EPSG:32633", geodetic=False)
    own = replace(own, coordinate=np.array([[500000.0, 0.0, 30.0 * k] for k in range(3)]))
    assert refused("track", ELLIPSOID | {"crs": "EPSG:32634"}, own) == (
        "p.toml: [track] crs: the file says EPSG:32633: leave the key out"
    )
    for given in ({}, {"crs": "EPSG:32633"}, {"crs": "WGS84 UTM 33N"}):
        where = geodetic(read("track", ELLIPSOID | given, own, times()).path.position_m)
        assert_close("latitude on either Earth", where.longitude_deg, [15.0, 15.0])
        assert_close("flight position", where.height_m, [15.0, 30.0])


def test_a_track_by_time_says_its_file_and_goes_up() -> None:
    found = read("track", ELLIPSOID, track(), times())
    assert_close("flight position", found.path.position_m[0], earth_centred_m(45, 15, 115))
    assert_close("flight speed", found.path.velocity_m_s, [[0, 0, -30], [0, 0, -30]])
    assert found.said == [
        "t.csv: CSV, 3 rows",
        "positions between those of the track: linear",
        "velocity by the differences of the track's positions",
    ]


def test_heights_of_a_track_are_the_format_s_or_the_project_s() -> None:
    above = {"height": {"undulation_m": 40.0}}
    found = read("track", above, track(), times())
    assert_close("flight position", found.path.position_m[1], earth_centred_m(45, 15, 170))
    found = read("track", {}, track(height="ellipsoid"), times())
    assert_close("flight position", found.path.position_m[1], earth_centred_m(45, 15, 130))
    assert height_datum(Section("p.toml", "track", {})) is None
    said = refused("track", {"height": "geoid"}, track())
    assert said.startswith("p.toml: [track] height: 'geoid' is not known")


IMAGES = ("a.jpg", "b.jpg")


@pytest.mark.parametrize(
    ("time_s", "image", "by_image"),
    [(None, IMAGES, True), (np.arange(3.0), IMAGES, True), (np.arange(3.0), (), False)],
)
def test_images_have_their_own_rows_where_the_picks_have_images(
    time_s: Any, image: tuple[str, ...], by_image: bool
) -> None:
    """A frame at .5 s is between the rows; image b.jpg is the first."""
    rows = track(image=["b.jpg", "c.jpg", "a.jpg"], time_s=time_s)
    found = read("track", ELLIPSOID, rows, times(image=image)).path.position_m[:, 0]
    heights = [160.0, 100.0] if by_image else [115.0, 130.0]
    assert_close("flight position", found, [earth_centred_m(45, 15, h)[0] for h in heights])


def test_some_frames_without_a_position_are_no_error_and_all_are() -> None:
    found = read("track", ELLIPSOID, track(), times((1.0, 9.0)))
    assert np.isfinite(found.path.position_m[:, 0]).tolist() == [True, False]
    assert refused(
        "track", ELLIPSOID | {"offset_s": 1000.0}, track(), times((7.0, np.nan, 3.5))
    ) == (
        "p.toml: [track] file: does not cover any frame: the track is from 1000 to 1002 s, the "
        "frames from 3.5 to 7 s; look at the clocks, [flight] epoch and [track] offset_s"
    )
    rows = track(image=["x.jpg", "y.jpg", "z.jpg"], time_s=None)
    assert refused("track", ELLIPSOID, rows, times(image=IMAGES)).endswith(
        "file: has none of the images that were picked (a.jpg for one); it has x.jpg for one"
    )


def test_what_is_said_of_a_track_that_has_other_images_or_another_clock() -> None:
    section = Section("p.toml", "track", {"offset_s": 0.25})
    rows = track(image=["x.jpg", "A.JPG", "B.jpg"])
    assert _nowhere(section, rows, times(image=IMAGES)).endswith(
        "it has A.JPG: letters must be of one case"
    )
    since = 1.7e9 + np.array([12345.25, 12400.0, 86400.0])
    when = times((5.0,))._replace(epoch=datetime.fromtimestamp(1.7e9 - 60.0, UTC))
    said = _nowhere(section, track(clock="utc", time_s=since), when)
    assert "the track is from 12405.5 to 86460.25 s, the frames from 5 to 5 s" in said


def test_whole_seconds_are_doubted_where_a_track_is_by_time() -> None:
    """At 30 m/s; and not where the project allows for it, or seconds have parts."""
    told = "the images' times are whole seconds, in which the camera moves 30.0 m: give [track] "
    found = read("track", ELLIPSOID, track(), times(whole_seconds=True))
    assert found.doubts == [told + "sigma_t_s, .3 for times that are cut off so"]
    allowed = read("track", ELLIPSOID | {"sigma_t_s": 0.3}, track(), times(whole_seconds=True))
    assert allowed.doubts == [] and allowed.path.sigma_time_s == 0.3
    assert read("track", ELLIPSOID, track(), times()).doubts == []
