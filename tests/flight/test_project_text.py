"""Every line of the text of a project, and of the example."""

from __future__ import annotations

from vopd.flight.new import example_project
from vopd.flight.project import project_text, toml_numbers, toml_text

ALL = """\
# one
#
# two

[flight]
# name = "my flight" # a title
# epoch = 2026-05-01T11:58:42Z # the moment of t = 0

[camera]
# lens = "lens.yml" # or a table: { model = "brown", fx_px = 1500.0 }
# model = "brown" # brown or fisheye, where 4 coefficients do not say
# camera = "1" # which camera, where the file has several
image_size_px = [64, 48] # width and height of the images
# pixel_grid = "centre" # of cx_px, cy_px; centre: (0, 0) is the first pixel's centre; corner; one-based

[picks]
# file = "picks.csv" # columns frame,landmark,u_px,v_px, or another format
# pixel_grid = "centre" # NEEDED, centre: (0, 0) is the first pixel's centre; corner; one-based
# v = "down" # down or up
# sigma_px = 1.0 # standard deviation of a pick
# frame_rate_hz = 25.0 # frames a second, for numbered frames
# first_frame_t_s = 0.0 # time of frame 0, seconds after the epoch
# times = "times.csv" # instead: frame or image, t_s or t_utc; or the images
# utc_offset_h = 2.0 # hours: clock of the images in `times` less UTC

[landmarks]
# file = "landmarks.csv" # landmark,lat_deg,lon_deg,h_m, or another format
# crs = "EPSG:32633" # coordinate reference system of x and y
# height = "ellipsoid" # heights are above: ellipsoid, egm96, egm2008, navd88, same; or { undulation_m = -37.9 }
# sigma_m = 0.1 # metres, or [east, north, up]: 0.05 by survey, 1 to 5 from a map

[track]
# file = "track.csv" # NEEDED, t_utc,lat_deg,lon_deg,h_m, or another format
# crs = "EPSG:32633" # coordinate reference system of x and y
# height = "ellipsoid" # heights are above: ellipsoid, egm96, egm2008, navd88, same; or { undulation_m = -37.9 }
# clock = "utc" # utc, or gps, which is 18 s ahead
# offset_s = 0.0 # added to the track's times
# sigma_m = 3.0 # NEEDED, metres, or [east, north, up]: 3 for a usual receiver, 0.02 for RTK
# sigma_t_s = 0.02 # of a frame's time against the track
# lever_arm_m = [0.0, 0.0, 0.0] # antenna to camera: forward, right, down
# interpolate = "linear" # linear or cubic

# [position]
# lat_deg = 48.0 # or x_m, y_m, z_m with crs
# lon_deg = 15.0 # positive east
# h_m = 300.0 # height
# height = "ellipsoid" # heights are above: ellipsoid, egm96, egm2008, navd88, same; or { undulation_m = -37.9 }
# sigma_m = 0.1 # NEEDED, metres, or [east, north, up]: 0.05 by survey, 1 to 5 from a map

# [vehicle]
# mount = "forward" # forward, down, { ypr_deg = [..] } or { matrix = [..] }

[wind]
file = "w.csv" # h_m,from_deg,speed_m_s; without it against the ground

# [atmosphere]
# refraction = "standard" # standard, off or { k = 0.13 }

# [solve]
# loss = "least-squares" # least-squares, huber or cauchy
# blunders = "name" # name (tell and keep) or drop
# check_landmarks = [] # landmarks that are not used
# frames = "each" # each, or one for a camera that does not move

# [uncertainty]
# focal_rel = 0.001 # of the focal length, as a part of it
# principal_px = [1.0, 1.0] # of the principal point
"""  # noqa: E501
VALUES = {("camera", "image_size_px"): "[64, 48]", ("wind", "file"): '"w.csv"'}
NEEDED = {
    ("picks", "pixel_grid"): "why",
    ("track", "file"): "why",
    ("track", "sigma_m"): "why",
}


def test_every_line_of_a_new_project() -> None:
    """Comments begin in column 44, or a blank after a longer value."""
    text = project_text(VALUES, NEEDED, "one\n\ntwo")
    found = text.split("\n")
    for line, expected in zip(found, ALL.split("\n"), strict=True):
        before, mark, comment = (
            expected.partition(" # ") if " = " in expected else (expected, "", "")
        )
        if expected.startswith("# ") and " = " in expected:
            key, mark, comment = expected[2:].partition(" # ")
            before = f"# {key}"
        assert line == (f"{before:43}{mark}{comment}" if mark else expected)


def sections(values: dict[tuple[str, str], str], needed: dict[tuple[str, str], str]) -> list[str]:
    lines = project_text(values, needed, "x").splitlines()
    return [line for line in lines if line.removeprefix("# ").startswith("[")]


def test_a_new_project_has_a_track_or_a_position() -> None:
    rest = ["# [vehicle]", "# [wind]", "# [atmosphere]", "# [solve]", "# [uncertainty]"]
    usual = ["[flight]", "[camera]", "[picks]", "[landmarks]"]
    assert sections({}, {}) == [*usual, "[track]", *rest]
    assert sections({("track", "file"): '"t"'}, {}) == [*usual, "[track]", *rest]
    assert sections({("position", "h_m"): "1"}, {}) == [*usual, "[position]", *rest]
    assert sections({}, {("track", "file"): ""}) == [*usual, "[track]", "# [position]", *rest]
    assert sections({}, {("solve", "loss"): ""})[-2:] == ["[solve]", "# [uncertainty]"]


def test_values_as_toml() -> None:
    assert toml_text('é "a" \\ b') == '"é \\"a\\" \\\\ b"'
    assert toml_numbers(1920, 0.1, 123456.789012) == "[1920, 0.1, 123456.789012]"


def test_the_example() -> None:
    new = example_project()
    assert [*new.contents] == [
        "picks.csv", "landmarks.csv", "track.csv", "lens.json", "wind.csv", "truth.csv",
        "frame_000.png", "frame_050.png", "frame_100.png", "flight.toml",
    ]  # fmt: skip
    assert new.said == [
        "an example: 21 frames of a drone's video over six landmarks, with its truth"
    ]
    assert new.needed == {}
    lines = new.contents["flight.toml"].decode().split("\n")
    assert lines[:6] == [
        "# A flight project: vopd check, attitude, plot and report take this file.",
        "# The example: a drone with a video camera over fields with six landmarks. The frames are",
        "# rendered, the picks have errors of half a pixel, and truth.csv has the true angles.",
        "# To make it yours, replace the files and the values that differ. Lines that begin with #",
        "# are keys that are not used here, each with an example.",
        "",
    ]
    given = [line.partition(" # ")[0].rstrip() for line in lines if line and line[0] != "#"]
    assert given == [
        "[flight]", 'name = "drone over six masts"', "epoch = 2026-05-01T09:30:00.240Z",
        "[camera]", 'lens = "lens.json"', "image_size_px = [640, 360]",
        "[picks]", 'file = "picks.csv"', 'pixel_grid = "centre"', "sigma_px = 0.5",
        "frame_rate_hz = 25.0", "first_frame_t_s = 0.0",
        "[landmarks]", 'file = "landmarks.csv"', 'height = "ellipsoid"',
        "sigma_m = [0.05, 0.05, 0.1]",
        "[track]", 'file = "track.csv"', 'height = "ellipsoid"', 'clock = "utc"',
        "sigma_m = [0.02, 0.02, 0.04]", "sigma_t_s = 0.002",
        "[wind]", 'file = "wind.csv"',
    ]  # fmt: skip
