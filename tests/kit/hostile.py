"""The table of hostile constants: files that ask for much in few bytes, by format.

A row is an input that somebody may send. `test_hostile.py` puts every row through its commands on
a pseudo-terminal and watches time, memory, traceback, control characters and the sentence.
"""

from __future__ import annotations

import os
import re
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from tests.kit import flight_files
from tests.kit.command import CASE_4, DECKS, ROOT
from tests.kit.tagged_images import tagged_image

Content = str | bytes | Callable[[Path], object]
Files = dict[str, Content]

HILL: dict[str, bytes] = {
    path.name: path.read_bytes() for path in (ROOT / "examples" / "hill").iterdir()
}
TOML = (ROOT / "examples" / "hill" / "flight.toml").read_text()
PICKS = (ROOT / "examples" / "hill" / "picks.csv").read_text()
STARS = (DECKS / "stars" / "table_6_3.csv").read_text()

SECONDS = 1.0  # of the processor that a command may take, after imports
MEGABYTES = 100.0  # by which its memory may grow
LONGEST = 4_000  # characters that it may say


class Hostile(NamedTuple):
    """An input; tests/approved has the sentences."""

    name: str
    files: Files
    commands: tuple[str, ...] = ("attitude flight.toml -o out.csv", "check flight.toml")
    seconds: float = SECONDS
    megabytes: float = MEGABYTES
    others_after: str = ""  # words after which another package goes on in its own


# Files of a project, one of which is replaced


def project(addition: str = "", **replaced: Content) -> Files:
    """Write the project of examples/hill with lines added to its end, and files replaced."""
    files = HILL | {"flight.toml": TOML + addition}
    return files | {name.replace("__", "."): content for name, content in replaced.items()}


def solve(line: str) -> Files:
    """Add a line to the section [solve]."""
    return project(f"\n[solve]\n{line}\n")


def lens(suffix: str, text: str) -> Files:
    """Write a project whose lens is in a file."""
    name = f"lens.{suffix}"
    toml = re.sub(r"(?m)^lens = \{.*$", f'lens = "{name}"', TOML)
    return HILL | {"flight.toml": toml, name: text}


def other(key: str, name: str, content: Content) -> Files:
    """Write a project whose picks, landmarks or track are in another file."""
    toml = TOML.replace(f'file = "{key}.csv"', f'file = "{name}"')
    return HILL | {"flight.toml": toml, name: content}


def solved_places(landmarks: str, track: str, old: str, new: str) -> Files:
    """Write a project that solves for places too, with a number replaced in its files."""
    files = flight_files.project(
        flight_files.LENSES["inline"], flight_files.PICKS["CSV of frames"],
        flight_files.LANDMARKS[landmarks], flight_files.TRACKS[track],
    )  # fmt: skip
    return {name: text.replace(old, new) for name, text in files.items()}


def first_number(text: str) -> str:
    """Replace the first number with decimals of the picks."""
    return re.sub(r"\d+\.\d+", text, PICKS, count=1)


def cell(table: str, column: int, text: str) -> str:
    """Replace a cell of the second row of a table of the project."""
    lines = [line.split(",") for line in HILL[f"{table}.csv"].decode().splitlines()]
    lines[2][column] = text
    return "\n".join(map(",".join, lines)) + "\n"


# What is hostile


def pipe(path: Path) -> None:
    os.mkfifo(path)


def zeros(path: Path) -> None:
    path.symlink_to("/dev/zero")


def sparse(path: Path) -> None:
    """A file of 4 GB that takes no room."""
    with path.open("wb") as file:
        file.truncate(4 << 30)


def itself(path: Path) -> None:
    """A link that leads to itself."""
    path.symlink_to(path.name)


def cut_ephemeris(path: Path) -> None:
    """The ephemeris of skyfield-data, whose last nine tenths are missing."""
    import skyfield_data

    whole = Path(skyfield_data.__file__).parent / "data" / "de421.bsp"
    with whole.open("rb") as file:
        path.write_bytes(file.read(whole.stat().st_size // 10))


def ephemeris_of_no_summary(path: Path) -> None:
    """The same, whose summaries have -1 numbers: jplephem never comes to their end."""
    cut_ephemeris(path)
    content = path.read_bytes()
    path.write_bytes(content[:8] + b"\xff" * 8 + content[16:])


def damaged_matlab(path: Path) -> None:
    """Caltech's calibration with one wrong byte, which ends the process of scipy's reader."""
    from scipy.io import savemat

    savemat(path, {"fc": [9.0, 9.0], "cc": [9.0, 5.0], "kc": [0.0] * 5, "nx": 19, "ny": 10})
    content = path.read_bytes()
    path.write_bytes(content[:177] + b"\1" + content[178:])


def matlab_zeros(path: Path) -> None:
    """A variable of 1,000,000 cells, each of no bytes, in 8 kB."""
    empty = struct.pack("<II", 14, 0)
    parts = struct.pack("<IIII", 6, 8, 1, 0) + struct.pack("<IIii", 5, 8, 1_000_000, 1)
    parts += struct.pack("<II", 0x20001, 0x6366) + empty * 1_000_000
    packed = zlib.compress(struct.pack("<II", 14, len(parts)) + parts, 9)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM"
    path.write_bytes(head + struct.pack("<II", 15, len(packed)) + packed)


def pixels(width: int, height: int) -> Callable[[Path], None]:
    """An image whose header says a size."""

    def make(path: Path) -> None:
        tagged_image(path, (48, 0, 0.0), (15, 0, 0.0), altitude_m=300.0)
        content = path.read_bytes()
        start = content.rindex(b"\xff\xc0") + 5
        size = height.to_bytes(2, "big") + width.to_bytes(2, "big")
        path.write_bytes(content[:start] + size + content[start + 4 :])

    return make


def xmp(text: bytes) -> bytes:
    """A TIFF of its header and a packet of XMP alone."""
    tags = (
        (256, 4, 1, 4), (257, 4, 1, 4), (258, 3, 1, 8), (262, 3, 1, 1), (273, 4, 1, 8),
        (700, 7, len(text), 86),
    )  # fmt: skip
    entries = b"".join(struct.pack("<HHII", *one) for one in tags)
    return b"II*\0\x08\0\0\0" + struct.pack("<H", len(tags)) + entries + bytes(4) + text


def damaged(path: Path) -> None:
    """An image whose list of tags has other numbers of values than are there."""
    tagged_image(path, (48, 0, 0.0), (15, 0, 0.0), altitude_m=300.0, taken="2026:01:01 00:00:00")
    content = bytearray(path.read_bytes())
    start = content.index(b"Exif\0\0") + 6
    content[start + 20 : start + 60 : 3] = b"\xee" * 14
    path.write_bytes(content)


def aliases(count: int) -> str:
    """YAML of 9 ** count elements in `count` lines."""
    lines = ["a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for k in range(1, count):
        here = chr(97 + k)
        lines.append(f"{here}: &{here} [" + ", ".join([f"*{chr(96 + k)}"] * 9) + "]")
    return "\n".join([*lines, ""])


DEEP = "[" * 5000 + "]" * 5000
LARGE, LONG = "9" * 400, "9" * 5000
PARTS = ".".join(["a"] * 50_000)
BOMB = '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">' for k in range(10)
)
ESCAPE = "\x1b]0;title\x07\x9b31m"
CVAT = '<annotations><track label="a"><points frame="{}" points="1,2"/></track></annotations>'
SHAPES = '{{"imageWidth": 1920, "imageHeight": 1080, "imagePath": "a.jpg", "shapes": {}}}'
OPENSFM = '{{"a": {{"width": 1920, "height": 1080, "focal": {}, "k1": 0, "k2": 0}}}}'
KML = (
    "<kml><Placemark><name>{}</name><Point><coordinates>15,48,300</coordinates></Point>"
    "</Placemark></kml>"
)
GPX = '<gpx version="1.1">{}</gpx>'
SRT = "".join(
    f"{k}\n00:00:0{k},000 --> 00:00:0{k + 1},000\n[latitude: 47.6435] [longitude: 16.4759] "
    f"[rel_alt: 1 abs_alt: 540.{k}]\n\n" for k in range(1, 6)
)  # fmt: skip
BATCH = ("batch in -d out",)
IMAGES = ("new made --images img",)
PAGE = ("pick img -o page.html",)
SKY = "stars solve s.csv --focal 76 --date 2020-01-15T21:00Z"
NAMED = "name,x_mm,y_mm\nHIP 27989,1,2\nHIP 24436,3,-1\nHIP 25336,-2,1\n"
STAR = ("stars solve s.csv --focal 76",)

TABLE = (
    # TOML
    Hostile("toml key of 50,000 parts", project(f"\n{PARTS} = 1\n")),
    Hostile("toml section of 50,000 parts", project(f"\n[{PARTS}]\n")),
    Hostile("toml mapping of 50,000 parts", solve(f"loss = {{{PARTS} = 1}}")),
    Hostile("toml lists", solve(f"loss = {DEEP}")),
    Hostile("toml 5,000 digits", solve(f"loss = {LONG}")),
    Hostile("toml 400 digits", solve(f"loss = {LARGE}")),
    Hostile("toml hexadecimal", solve(f"loss = 0x{'f' * 5000}")),
    Hostile("toml 5 MB", solve(f"loss = 1.{'1' * 5_000_000}")),
    Hostile("toml sections", project("\n".join(f"[s{k}]" for k in range(5_000)))),
    Hostile("toml null", project(flight__toml=TOML.replace("picks.csv", "p\\u0000"))),
    Hostile("toml escape", project(f'\n["{ascii(ESCAPE)[1:-1].replace("x", "u00")}"]\n')),
    Hostile("toml utf-16", project(flight__toml=TOML.encode("utf-16"))),
    Hostile("toml pipe", project(flight__toml=pipe)),
    Hostile("toml device", project(flight__toml=zeros)),
    Hostile("name of two lines", project(flight__toml=re.sub("name = .*", r'name = "a\\nb"', TOML)),
            ("punch flight.toml", "check flight.toml")),
    Hostile("key that is not read", project(flight__toml=TOML.replace(
            "[picks]", '[picks]\nutc_offset_h = "x"'))),
    Hostile("image of one pixel", solved_places("CSV, geodetic", "CSV by seconds", "1080]", "1]"),
            ("attitude flight.toml -o out.csv",)),
    Hostile("mount of 1e300", project("\n[vehicle]\nmount = {matrix = [[1e300, 0, 0], [0, 1, 0], "
            "[0, 0, 1]]}\n")),
    Hostile("refraction of 1e18", project("\n[atmosphere]\nrefraction = {k = 1e18}\n")),
    # lenses
    Hostile("colmap blank lines", lens("txt", "\n" * 200_000)),
    Hostile("json lists", lens("json", f'{{"camera_matrix": {DEEP}}}')),
    Hostile("json 5,000 digits", lens("json", f'{{"camera_matrix": {LONG}}}')),
    Hostile("json 400 digits", lens("json", f'{{"image_width": {LARGE}, "image_height": 9, '
            '"camera_matrix": [1, 0, 1, 0, 1, 1, 0, 0, 1]}')),
    Hostile("opensfm lists", lens("json", f'{{"width": 1, "focal": {DEEP}}}')),
    Hostile("mrcal lists", lens("cameramodel", f'{{"lensmodel": "LENSMODEL_A", "a": {DEEP}}}')),
    Hostile("mrcal signs", lens("cameramodel", f'{{"a": "LENSMODEL_A", "b": {"-" * 50_000}1}}')),
    Hostile("yaml lists", lens("yml", f"camera_matrix: {DEEP}")),
    Hostile("yaml lines", lens("yml", "camera_matrix: \n" + "- " * 20_000)),
    Hostile("yaml aliases", lens("yml", f"{aliases(9)}camera_matrix: *i")),
    Hostile("yaml in itself", lens("yml", "camera_matrix: &a {data: *a}")),
    Hostile("yaml digits", lens("yml", f"camera_matrix: {LONG}")),
    Hostile("yaml 2 MB", lens("yml", f"camera_matrix: [{'1,' * 1_000_000}1]")),
    Hostile("yaml 120,000 values", lens("yml", f"camera_matrix: [{'1,' * 120_000}1]")),
    Hostile("yaml date", lens("yml", "camera_matrix: 9999-99-99"), others_after="not valid YAML:"),
    Hostile("xml entities", lens("xml", f"{BOMB}]><opencv_storage>&k;</opencv_storage>")),
    Hostile("xml depth", lens("xml", f"<opencv_storage>{'<a>' * 10_000}{'</a>' * 10_000}"
            "</opencv_storage>")),
    Hostile("colmap arabic", lens("txt", "1 PINHOLE 1920 1080 1000 1000 ٩٦٠ 540\n")),
    Hostile("colmap focal length of 1e308", lens("txt",
            "1 PINHOLE 1920 1080 1500 1e308 960 540\n")),
    Hostile("colmap coefficient of 1e-320", lens("txt",
            "1 RADIAL 1920 1080 1500 960 540 0 1e-320\n"), ("attitude flight.toml -o out.csv",),
            others_after="speak for"),
    Hostile("colmap fov", lens("txt", "1 FOV 1920 1080 1500 1500 960 540 .9\n")),
    Hostile("opensfm true", lens("json", OPENSFM.format("true"))),
    Hostile("cvat pixel of 1e308", other("picks", "p.xml", CVAT.format("0").replace("1,2",
            "1e308,2"))),
    Hostile("mrcal separator", lens("cameramodel", "{'lensmodel': 'LENSMODEL_PINHOLE', "
            "'intrinsics': ['1_000', 1000, 960, 540], 'imagersize': [1920, 1080]}")),
    Hostile("mrcal numbers", lens("cameramodel", "{'a': 'LENSMODEL_PINHOLE', 'intrinsics': ["
            + "1," * 500_000 + "]}")),
    Hostile("lens pipe", lens("yml", "") | {"lens.yml": pipe}),
    Hostile("matlab damaged", lens("mat", "") | {"lens.mat": damaged_matlab}),
    Hostile("matlab zeros", lens("mat", "") | {"lens.mat": matlab_zeros}),
    # picks
    Hostile("cvat 30 digits", other("picks", "p.xml", CVAT.format("9" * 30))),
    Hostile("cvat separator", other("picks", "p.xml", CVAT.format("1_0"))),
    Hostile("cvat entities", other("picks", "p.xml", f"{BOMB}]><annotations>&k;</annotations>")),
    Hostile("marker entities", other("landmarks", "m.xml", f'{BOMB}]><marker label="&k;"/>')),
    Hostile("cvat points", other("picks", "p.xml", '<annotations><track label="a"><points '
            f'frame="0" points="{"x" * 1_000_000}"/></track></annotations>')),
    Hostile("labelme lists", other("picks", "p.json", SHAPES.format(DEEP))),
    Hostile("labelme 400 digits", other("picks", "p.json", SHAPES.format(
            f'[{{"label": "a", "shape_type": "point", "points": [[{LARGE}, 1]]}}]'))),
    Hostile("labelme arabic", other("picks", "p.json", SHAPES.format(
            '[{"label": "a", "shape_type": "point", "points": [["٣", 1]]}]'))),
    Hostile("labelme null", other("picks", "p.json", SHAPES.format(
            '[{"label": null, "shape_type": "point", "points": [[1, 2]]}]'))),
    Hostile("picks separator", project(picks__csv=first_number("2_95.684"))),
    Hostile("picks arabic", project(picks__csv=first_number("٢٩٥.٦٨٤"))),
    Hostile("picks fullwidth", project(picks__csv=first_number("\uff12\uff19"))),
    Hostile("picks cell", project(picks__csv=first_number("1" * 100_000))),
    Hostile("picks line", project(picks__csv=PICKS + "x" * 5_000_000)),
    Hostile("picks columns", project(picks__csv="landmark,u_px,v_px" + ",a" * 100_000)),
    Hostile("picks quotes", project(picks__csv=PICKS + '0,"' + "x\n" * 100_000)),
    Hostile("picks null", project(picks__csv=PICKS + "0,\0,1,2\n")),
    Hostile("picks escape", project(picks__csv=PICKS + f"0,{ESCAPE},1,2\n")),
    Hostile("picks 4 GB", project(picks__csv=sparse)),
    Hostile("picks sigma of 1e-300", project(picks__csv=re.sub(r"(?m)(\d)$", r"\1,1e-300",
            PICKS).replace("v_px", "v_px,sigma_px"))),
    Hostile("picks sigma of 1e-300 for all", project(flight__toml=TOML.replace(
            "[picks]", "[picks]\nsigma_px = 1e-300"))),
    Hostile("picks of images of one number", project(picks__csv="image,landmark,u_px,v_px\n"
            + "".join(f"n{k}_1.png,church,{k + 1},3\n" for k in range(15_000)))),
    Hostile("picks pipe", project(picks__csv=pipe)),
    Hostile("picks device", project(picks__csv=zeros)),
    # landmarks
    Hostile("geojson lists", other("landmarks", "l.json", f'{{"type": "Feature", "a": {DEEP}}}')),
    Hostile("geojson escape", other("landmarks", "l.json", '{"type": "Feature", "geometry": '
            '{"type": "Point", "coordinates": [1, 2, 3]}, "properties": {"name": "\\u001b[2J"}}'),
            ("check flight.toml",)),
    Hostile("name that turns the line", project(landmarks__csv=cell("landmarks", 0, "\u202eeht")),
            ("check flight.toml",)),
    Hostile("geojson name of two lines", other("landmarks", "l.json", '{"type": "Feature", '
            '"geometry": {"type": "Point", "coordinates": [1, 2, 3]}, "properties": {"name": '
            '"a\\nb"}}'), ("check flight.toml",)),
    Hostile("gcp system", other("landmarks", "g.txt", "+proj=utm +zone=33 " + "+x " * 50_000
            + "\n1 2 3 4 5 a.jpg n\n")),
    Hostile("gcp grids", other("landmarks", "g.txt", "+proj=utm +zone=33 +nadgrids=/etc/passwd\n"
            "500000 5300000 3 4 5 a.jpg n\n"), others_after="(PROJ:"),
    Hostile("kml places in each other", other("landmarks", "l.kml", "<kml>"
            + "<Placemark><Point/>" * 9_000 + "</Placemark>" * 9_000 + "</kml>")),
    Hostile("kml name", other("landmarks", "l.kml", KML.format("a" * 100_000))),
    Hostile("landmarks device", project(landmarks__csv=zeros)),
    # tracks
    Hostile("gpx entities", other("track", "t.gpx", BOMB + "]>" + GPX.format("&k;"))),
    Hostile("gpx comments", other("track", "t.gpx", "<!--a-->" * 200 + GPX.format(""))),
    Hostile("gpx depth", other("track", "t.gpx", GPX.format("<trk>" * 5_000 + "</trk>" * 5_000)),
            others_after="not valid GPX:"),
    Hostile("srt digits", {"t.srt": SRT + "1" * 900_000}, ("new made --track t.srt",)),
    Hostile("srt blank lines", other("track", "t.srt", "1" + "\n" * 19_999 + " " * 900_000)),
    Hostile("srt decimal comma", other("track", "t.srt", SRT.replace("47.6435", "47,6435"))),
    Hostile("gpx without a time, 300,000 digits", other("track", "t.gpx", GPX.format(
        '<trk><trkseg><trkpt lat="1" lon="2"><ele>1</ele><desc>' + "1" * 300_000
        + "</desc></trkpt></trkseg></trk>"))),
    Hostile("wind of blank lines", project('\n[wind]\nfile = "w.txt"\n', w__txt="\n" * 300_000)),
    Hostile("gpx latitude of nan", other("track", "t.gpx", GPX.format('<trk><trkseg><trkpt '
            'lat="nan.6" lon="16"/></trkseg></trk>'))),
    Hostile("srt longitude of 400 digits", other("track", "t.srt", SRT.replace("16.4759", LARGE))),
    Hostile("srt hours of 400 digits", other("track", "t.srt", SRT.replace("00:00:05", LARGE
            + ":00:05"))),
    Hostile("track column of 20,000 words", project(track__csv=re.sub(r"(?m)(\d)$", r"\1,1",
            HILL["track.csv"].decode()).replace("lat_deg,lon_deg,h_m", "lat,lon,alt,"
            + "above_" * 20_000 + "x1")), ("check flight.toml",)),
    Hostile("track marks that nobody sees", project(track__csv="\ufeff\ufeff".encode()
            + HILL["track.csv"])),
    Hostile("track year 1", other("track", "t.csv", "t_utc,lat_deg,lon_deg,h_m\n"
            "0001-01-01T00:00:00+14:00,48,15,300\n")),
    Hostile("track year 9999", other("track", "t.csv", "t_utc,lat_deg,lon_deg,h_m\n"
            "9999-12-31T23:59:59-14:00,48,15,300\n")),
    Hostile("epoch year 1", project(flight__toml=re.sub("(?m)^epoch = .*",
            "epoch = 0001-01-01T00:00:00+14:00", TOML))),
    Hostile("epoch year 9999", project(flight__toml=re.sub("(?m)^epoch = .*",
            "epoch = 9999-12-31T23:59:59-14:00", TOML))),
    Hostile("track height of 1e308", project(track__csv=cell("track", 3, "1e308"))),
    Hostile("track longitude of 1e300", project(track__csv=cell("track", 2, "1e300"))),
    Hostile("landmark longitude of 400", project(landmarks__csv=cell("landmarks", 2, "400"))),
    Hostile("landmark of the other hemisphere", project(flight__toml=TOML.replace('m = "exact"',
            "m = 0.3"), landmarks__csv=HILL["landmarks.csv"].replace(b"47.647277", b"-7.647277")),
            ("check flight.toml",), seconds=4.0),
    Hostile("landmark 1,200 km away", solved_places("GeoJSON", "CSV by seconds",
            "16.475367657481932", "0"), seconds=8.0),  # 5 on a slow processor
    Hostile("track latitude of 0", solved_places("CSV, geodetic", "GPX", 'lat="47.6435"',
            'lat="0"'), ("attitude flight.toml -o out.csv",), seconds=4.0),
    Hostile("landmark height of 1e8", project(landmarks__csv=cell("landmarks", 3, "1e8")),
            ("attitude flight.toml -o out.csv",), seconds=8.0, others_after="have no image"),
    # images
    Hostile("image 196 megapixels", {"img/a.jpg": pixels(14_000, 14_000)}, IMAGES),
    Hostile("image 4 gigapixels", {"img/a.jpg": pixels(65_000, 65_000)}, IMAGES),
    Hostile("image damaged", {"img/a.jpg": damaged}, IMAGES),
    Hostile("image with marks that do not end", {"img/a.tif": xmp(b":Latitude>" * 90_000)}, IMAGES),
    Hostile("image pipe", {"img/a.jpg": pipe}, IMAGES),
    Hostile("picture 196 megapixels", {"img/a.jpg": pixels(14_000, 14_000)}, PAGE),
    Hostile("picture for another program", {"img/a.jpg": "%!PS-Adobe-3.0 EPSF-3.0\n"
            "%%BoundingBox: 0 0 9 9\n%%EndComments\n"}, PAGE),
    Hostile("picture damaged", {"img/a.jpg": damaged}, PAGE),
    Hostile("picture pipe", {"img/a.jpg": pipe}, PAGE),
    Hostile("video that is a list", {"v.mp4": "ffconcat version 1.0\nfile v.mp4\n"},
            ("pick v.mp4 -o page.html",)),
    Hostile("image beside the picks", {"p.csv": PICKS, "a.jpg": b"\xff\xd8\xff"},
            ("new made --picks p.csv",)),
    Hostile("folder that leads to itself", {"made": itself}, ("new made",)),
    # decks, stars, listings, manifests, folders
    Hostile("deck device", {"x.dat": zeros},
            ("run x.dat", "check x.dat", "attitude x.dat", "cards x.dat")),
    Hostile("deck of 4 GB without line ends", {"x.dat": sparse},
            ("run x.dat", "check x.dat", "attitude x.dat")),
    Hostile("deck of 4 GB to be stripped", {"x.dat": sparse}, ("cards x.dat --strip-sequence",),
            megabytes=500.0, seconds=3.0),
    Hostile("deck escape", {"x.dat": CASE_4.read_bytes().replace(b"1", b"\x9b", 1)},
            ("run x.dat", "check x.dat")),
    Hostile("folder with a pipe", {"in/x.dat": pipe, "in/y.dat": CASE_4.read_bytes()},
            BATCH),
    Hostile("folder with a device", {"in/x.dat": zeros}, BATCH),
    Hostile("manifest null", {"m": "a\0b.dat\n"}, ("batch --manifest m -d o",)),
    Hostile("manifest name", {"m": "a" * 1_000_000}, ("batch --manifest m -d o",)),
    Hostile("manifest device", {"m": zeros}, ("batch --manifest m -d out",)),
    Hostile("stars device", {"s.csv": zeros}, STAR),
    Hostile("stars separator", {"s.csv": re.sub(r"(?m)^-?[\d.]+,", "1_0.5,", STARS)}, STAR),
    Hostile("stars blanks", {"s.csv": f"{STARS.rstrip()}\n1,2,1{' ' * 100_000}x,5\n"}, STAR),
    Hostile("stars columns", {"s.csv": "x_mm,y_mm" + ",a" * 1_000_000 + "\n1,2\n"},
            (*STAR, "stars radec s.csv --focal 76 --attitude 1,2,3")),
    Hostile("stars arabic", {"s.csv": NAMED.replace("27989", "٢٧٩٨٩")}, (SKY,)),
    Hostile("stars 5,000 times the same", {"s.csv": STARS.rstrip() + "\n" + 4_990
            * (STARS.rstrip().rpartition("\n")[2] + "\n")}, STAR, seconds=4.0),
    Hostile("listing of a million blank lines", {"a.lst": "\n" * 1_000_000}, (
            "diff a.lst a.lst",)),
    Hostile("stars lists", {"s.json": f'{{"matched_centroids": {DEEP}}}'},
            ("stars solve s.json --focal 76",)),
    Hostile("ephemeris cut short", {"s.csv": NAMED, "e.bsp": cut_ephemeris},
            (f"{SKY} --ephemeris e.bsp",)),
    Hostile("ephemeris of no summary", {"s.csv": NAMED, "e.bsp": ephemeris_of_no_summary},
            (f"{SKY} --ephemeris e.bsp",)),
    Hostile("ephemeris pipe", {"s.csv": NAMED, "e.bsp": pipe},
            (f"{SKY} --ephemeris e.bsp",)),
    Hostile("catalogue device", {"s.csv": NAMED, "h.dat": zeros},
            (f"{SKY} --catalogue h.dat",)),
    Hostile("catalogue 4 GB", {"s.csv": NAMED, "h.dat": sparse},
            (f"{SKY} --catalogue h.dat",), megabytes=250.0),
    Hostile("catalogue empty", {"s.csv": NAMED, "h.dat": ""},
            (f"{SKY} --catalogue h.dat",)),
    Hostile("reading sigma of 1e-300", {"s.csv": STARS},
            ("stars solve s.csv --focal 76 --reading-sigma 1e-300",)),
    Hostile("option of 900 lists", {}, (f"new made --set flight.name={'[' * 900}",)),
    Hostile("option of 5,000 characters", {"s.csv": STARS},
            (f"stars solve s.csv --size {'a' * 5000}", f"check s.csv --{'a' * 5000}")),
    Hostile("name of a file", {}, ("check a\x1b[31m", "stars solve a\x1b[31m")),
    Hostile("name of a project of 300 characters", HILL | {"m": f"flight.toml\n{'a' * 300}.toml\n"},
            (f"attitude -q {'a' * 300}.toml flight.toml -o o.csv", "batch -q --manifest m -d out"),
            seconds=4.0),
    Hostile("whole number of 400 digits", {}, (f"demo --jobs {LARGE}", f"demo --frames -{LARGE}")),
    Hostile("column of no name", {"x.dat": CASE_4.read_bytes()}, (
            "attitude x.dat --columns ''",)),
)  # fmt: skip
