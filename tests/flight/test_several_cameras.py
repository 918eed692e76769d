"""Images of several cameras in one flight, each with the lens of its own."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.command import vopd
from tests.kit.flight_project import FRAMES, LENS, MARKS, TOML, pixels, truth_deg, write_project
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.batch.sources import input_sha256
from vopd.convert.flight_to_deck import flight_job
from vopd.findings import VopdError
from vopd.flight.formats.image_lenses import lens_files
from vopd.flight.formats.lens import make_lens
from vopd.flight.formats.picks import Names, PickRows
from vopd.flight.project.camera import read_camera
from vopd.flight.project.directions import plain_lenses
from vopd.flight.project.keys import read_project
from vopd.flight.project.named import named_files
from vopd.flight.project.picks import sizes_px
from vopd.flight.project.read import read_flight
from vopd.flight.result import solve_flight
from vopd.flight.solve.equations import by_lens_parameters, with_parameters
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import Lens, Lenses, project, ray_of_pixel
from vopd.report.frames import frames_json

OTHER = make_lens("fisheye", (1280, 960), (700.0, 700.0), (641.2, 476.4), (0.03, -0.01))
INLINE = next(line for line in TOML.splitlines() if line.startswith("lens = "))
SIZE_KEY = "image_size_px = [1920, 1080]\n"
STATED = "[uncertainty]\nfocal_rel = 0.002\nprincipal_px = 2.0\n"


def camera_file(lens: Lens, model: str) -> str:
    """The lens as OpenCV writes it in JSON."""
    (fx, fy), (cx, cy) = lens.focal_px.tolist(), lens.centre_px.tolist()
    k = lens.k[:5].tolist() if model == "brown" else lens.k.tolist()
    return json.dumps({
        "image_width": lens.size_px[0], "image_height": lens.size_px[1],
        "camera_matrix": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], "distortion_coefficients": k,
        **({"fisheye_model": 1} if model == "fisheye" else {}),
    })  # fmt: skip


def two_cameras(folder: Path, more: str = "", noise_px: float = 0.0) -> Path:
    """A project whose frames 1 and 3 were taken by a fisheye of another size."""
    toml = TOML.replace(INLINE, 'of_images = "cameras/lenses.csv"').replace(SIZE_KEY, "")
    toml = toml.replace('pixel_grid = "centre"\n', "", 1)
    path = write_project(folder, toml + more, noise_px)
    seen = pixels(noise_px)
    for frame in (1, 3):
        seen[frame] = project(OTHER, ray_of_pixel(LENS, seen[frame])).pixel
    write_picks(folder, seen, range(FRAMES))
    (folder / "cameras").mkdir(exist_ok=True)
    (folder / "cameras" / "a.json").write_text(camera_file(LENS, "brown"))
    (folder / "cameras" / "b.json").write_text(camera_file(OTHER, "fisheye"))
    rows = [f"{frame},{'ab'[frame % 2]}.json" for frame in range(FRAMES)]
    (folder / "cameras" / "lenses.csv").write_text("\n".join(["frame,lens", *rows, ""]))
    return path


def write_picks(folder: Path, seen: Floats, frames: range) -> None:
    rows = [
        f"{frame},{name},{u:.12f},{v:.12f}"
        for frame in frames
        for name, (u, v) in zip(MARKS, seen[frame], strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))


def test_each_frame_is_solved_with_its_own_lens(tmp_path: Path) -> None:
    result = solve_flight(str(two_cameras(tmp_path)))
    assert_close("solved angle", result.camera_deg, truth_deg())
    assert isinstance(result.flight.lens, Lenses) and result.flight.lens.which.tolist() == [
        0,
        1,
    ] * 2 + [0]
    assert result.estimate.lens is not None and result.estimate.lens.tolist() == [0, 1, 0, 1, 0]


@pytest.mark.parametrize(("header", "name"), [("frame", "{:03d}"), ("image", "of b/{}.png")])
def test_rows_of_lenses_may_spell_a_frame_otherwise(header: str, name: str, tmp_path: Path) -> None:
    path = two_cameras(tmp_path)
    rows = [f"{name.format(frame)},{'ab'[frame % 2]}.json" for frame in range(FRAMES)]
    table = "\n".join([f"{header},lens", *rows, ""])
    (tmp_path / "cameras" / "lenses.csv").write_text(table)
    if header == "image":
        head, *lines = (tmp_path / "picks.csv").read_text().splitlines()
        images = [f"of a/{one.replace(',', '.png,', 1)}" for one in lines]
        text = "\n".join([head.replace("frame", "image"), *images, ""])
        (tmp_path / "picks.csv").write_text(text)
    lens = read_flight(str(path)).lens
    assert isinstance(lens, Lenses) and lens.which.tolist() == [0, 1, 0, 1, 0]


def test_a_shot_of_two_reconstructions_has_one_camera(tmp_path: Path) -> None:
    """The camera of the last one was taken, and its place is refused only where that is used."""
    toml = TOML.replace(INLINE, 'of_images = "r.json"').replace(SIZE_KEY, "")
    path = write_project(tmp_path, toml)
    camera = {"projection_type": "perspective", "width": 1920, "height": 1080, "focal": 0.8}
    parts = [
        {"cameras": {"a": camera, "b": camera}, "shots": {"0.png": {"camera": one}}}
        for one in ("a", "a", "b")
    ]
    (tmp_path / "r.json").write_text(json.dumps(parts[:2]))
    assert read_camera(read_project(str(path))).of_image == {"0.png": 0}
    (tmp_path / "r.json").write_text(json.dumps(parts))
    with refused(VopdError):
        read_camera(read_project(str(path)))


def test_the_order_of_the_lenses_does_not_matter(tmp_path: Path) -> None:
    """A fisheye has no p1 and p2, and the other lens has errors of them."""
    path = two_cameras(tmp_path, "[uncertainty]\np1p2 = 0.001\n")
    table = tmp_path / "cameras" / "lenses.csv"
    head, first, *rows = table.read_text().splitlines()
    found = []
    for lines in ([head, first, *rows], [head, *rows, first]):
        table.write_text("\n".join([*lines, ""]))
        result = solve_flight(str(path))
        assert result.history().about.words.sigma_keys["distortion"].endswith("p1p2")
        found.append(result.history().uncertainty.components["distortion"])
    assert_close("ratio", found[1][::2, :6] / found[0][::2, :6], np.ones((3, 6)))
    assert not found[1][1::2].any()


def test_a_point_of_a_frame_is_seen_through_its_own_lens(tmp_path: Path) -> None:
    """The middle of each lens is where its camera looks, and a pixel there is 1 / f."""
    result = solve_flight(str(two_cameras(tmp_path, STATED)))
    for frame, lens in ((0, LENS), (1, OTHER)):
        found, (yaw, pitch, _) = result.direction(frame, *lens.centre_px, 1.0), truth_deg()[frame]
        assert_close("solved angle", [found.azimuth_deg, found.elevation_deg], [yaw % 360.0, pitch])
        ratio = found.components["pick"] / np.degrees(1.0 / lens.focal_px)
        assert_close("direction by differences", ratio, np.ones(2))


def test_the_image_of_a_frame_has_its_own_lens(tmp_path: Path) -> None:
    """Size, computed places and lines of sight of one frame of each camera."""
    scene_of = solve_flight(str(two_cameras(tmp_path))).estimate.scene
    assert scene_of is not None
    scene = scene_of()
    assert scene.image is not None
    for frame, lens in ((0, LENS), (1, OTHER)):
        image = scene.image(frame, "")
        assert tuple(image.size_px) == lens.size_px
        assert_close("trial without noise", image.fitted, image.pixel)
        _, ray = scene.sight(frame, "")
        axes = local_axes(scene.camera_m[scene.index(frame, "")][None])[0]
        assert_close("flight ray", ray @ axes.T, image.direction_of(image.pixel))


def test_frames_of_a_report_have_the_sizes_of_their_images(tmp_path: Path) -> None:
    """The lens of frames 1 and 3 is of 1280 x 960."""
    history = solve_flight(str(two_cameras(tmp_path))).history()
    (job,) = [one for one in json.loads(frames_json([history]))["jobs"] if "sizes" in one]
    assert job["sizes"] == [[1280, 960], [1920, 1080]] and job["size"] == [1, 0, 1, 0, 1]


@pytest.mark.parametrize("camera", ["a", "b"])
def test_frames_of_one_camera_have_the_uncertainty_that_they_have_alone(
    camera: str, tmp_path: Path
) -> None:
    """Angles, sigmas by focal length and centre: as in a project of that camera's frames."""
    toml = (
        two_cameras(tmp_path / "both", STATED, 0.5)
        .read_text()
        .replace("first_frame_t_s", "sigma_px = 0.5\nfirst_frame_t_s")
    )
    both = tmp_path / "both" / "flight.toml"
    both.write_text(toml)
    lens = f'lens = "../both/cameras/{camera}.json"'
    alone = write_project(
        tmp_path / "alone", toml.replace('of_images = "cameras/lenses.csv"', lens)
    )
    text = (tmp_path / "both" / "picks.csv").read_text().splitlines()
    mine = [row for row in text[1:] if int(row[0]) % 2 == "ab".index(camera)]
    (tmp_path / "alone" / "picks.csv").write_text("\n".join([text[0], *mine, ""]))
    one, all_frames = (solve_flight(str(path)).to_dataframe() for path in (alone, both))
    here = all_frames[all_frames["frame"] % 2 == "ab".index(camera)].reset_index(drop=True)
    for column in (
        "camera_yaw_deg",
        "camera_roll_deg",
        "sigma_camera_yaw_deg",
        "sigma_camera_pitch_deg",
    ):
        assert_close("solved angle", here[column], one[column])


def test_one_camera_of_all_images_is_a_lens_of_the_project(tmp_path: Path) -> None:
    path = two_cameras(tmp_path)
    rows = [f"{frame},a.json" for frame in range(FRAMES)]
    (tmp_path / "cameras" / "lenses.csv").write_text("\n".join(["frame,lens", *rows, ""]))
    write_picks(tmp_path, pixels(), range(FRAMES))
    result = solve_flight(str(path))
    assert isinstance(result.flight.lens, Lens) and result.flight.lens.size_px == LENS.size_px
    assert_close("solved angle", result.camera_deg, truth_deg())


def test_the_largest_sigma_of_several_lenses_counts(tmp_path: Path) -> None:
    """That of a focal length in proportion: 4 of 1000 px are 6 of the first lens's 1500."""
    path = two_cameras(tmp_path)
    for name, focal, sigmas in (("a", 1500.0, (5.0, 1.0)), ("b", 1000.0, (4.0, 3.0))):
        square = [sigmas[0] ** 2, 0.0, 0.0, sigmas[1] ** 2]
        (tmp_path / "cameras" / f"{name}.xml").write_text(
            "<calibration><projection>frame</projection><width>1920</width><height>1080</height>"
            f"<f>{focal}</f><covariance><params>f cx</params><coeffs>"
            f"{' '.join(map(str, square))}</coeffs></covariance></calibration>"
        )
    table = tmp_path / "cameras" / "lenses.csv"
    table.write_text(table.read_text().replace(".json", ".xml"))
    read = read_camera(read_project(str(path))).read
    assert read.sigma == {"focal": 6.0, "centre_u": 3.0}
    assert read.lens.focal_px.tolist() == [1500.0, 1500.0]


def test_parameters_change_all_lenses_and_focal_lengths_in_proportion() -> None:
    """14.95 of 1495 px are 7 of 700; derivatives are differences of images by these lenses."""
    lenses, names = Lenses.join((LENS, OTHER), np.array([0, 1, 1])), ("focal", "clock", "k1")
    given = np.array([14.95, 3.0, 0.01])
    first, second = (one.focal_px for one in with_parameters(lenses, names, given).each)
    assert_close("table value", first, LENS.focal_px * 1.01)
    assert_close("table value", second, 707.0)
    ray = np.array([[0.1, -0.2, 1.0], [0.3, 0.1, 1.0], [-0.2, 0.4, 1.0]])
    found = by_lens_parameters(lenses, names, 0.0 * given, ray, project(lenses, ray))
    step = np.array([1e-3, 1.0, 1e-6])
    for k, unit in enumerate(np.diag(step)):
        more, less = (project(with_parameters(lenses, names, one), ray) for one in (unit, -unit))
        expected = (more.pixel - less.pixel) / (2.0 * step[k])
        size = max(np.abs(expected).max(), 1.0)
        assert_close("image by a parameter", found[..., k] / size, expected / size)


def test_the_lenses_are_of_what_a_project_names(tmp_path: Path) -> None:
    """A batch that goes on kept the results of earlier lenses, and so did an adjusted project."""
    path = two_cameras(tmp_path / "own", noise_px=0.3)
    path.write_text(path.read_text().replace('sigma_t_s = "exact"', "sigma_t_s = 0.05"))
    before = input_sha256(str(path))
    found = named_files(path.read_bytes(), path.parent)
    assert [name for name, _ in found][-2:] == ["cameras/a.json", "cameras/b.json"]
    adjusted = tmp_path / "adjusted"
    assert vopd("adjust", path, "--free", "clock", "-o", adjusted).status == 0
    read_flight(str(adjusted / "flight.toml"))
    (path.parent / "cameras" / "b.json").write_text(camera_file(LENS, "brown"))
    assert input_sha256(str(path)) != before
    with refused(VopdError):
        read_flight(str(adjusted / "flight.toml"))


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("# of two\n\nimage;Lens ;camera\na.jpg;'b.json;1\na.jpg; a.json ;1\n", ["a.json"]),
        ('image,lens\na.jpg,"a.json"\nc.jpg,../own/a.json\n', ["../own/a.json", "a.json"]),
        ("image,lens\na.jpg,a.json\nb.jpg\n", []),  # it is refused
        ("image,lens\n" + "a.jpg,b.json\n" * 100_000 + "b.jpg,a.json\n", ["a.json"]),
        ("image,lens\na.jpg," + "x" * 5000 + "\nb.jpg,a.json\n", ["a.json"]),
        ('[{"shots": {}}]', []),
        ("image,camera\na.jpg,a.json\n", []),
        ("", []),
        ("image,lens\na.jpg,\x00\n", []),
    ],
)
def test_tables_of_lenses(text: str, names: list[str], tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    (own / "a.json").write_text("")
    (own / "t.csv").write_text(text)
    assert [name for name, _ in lens_files(own / "t.csv")] == names
    assert lens_files(own) == lens_files(own / "none.csv") == []


def test_the_cards_have_one_lens(tmp_path: Path) -> None:
    """And so a flight of several is not punched."""
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        flight_job(solve_flight(str(two_cameras(tmp_path))))


def test_images_have_the_sizes_of_their_lenses(tmp_path: Path) -> None:
    """As far as the file of picks states them: of the second image it is another, or upright."""
    project = read_project(str(two_cameras(tmp_path)))
    camera, section = read_camera(project), project.section("picks")
    file, frames = project.open("picks"), Names(["0", "1", "1"])
    sizes = {"0": (1920, 1080), "1": (1280, 960)}
    for known in (sizes, {"1": sizes["1"]}, None):
        rows = PickRows(
            frames, Names("abc"), np.zeros((3, 2)), np.full(3, np.nan), "centre", known, ""
        )
        found = sizes_px(section, file, rows, camera)
        assert found.tolist() == [[1920, 1080], [1280, 960], [1280, 960]]
    for wrong in ((640, 480), (960, 1280)):
        with refused(VopdError, parts=[tmp_path.as_posix()]):
            sizes_px(section, file, replace(rows, size_px=sizes | {"1": wrong}), camera)


def test_a_table_of_one_lens_is_that_lens(tmp_path: Path) -> None:
    path = two_cameras(tmp_path)
    (tmp_path / "cameras" / "lenses.csv").write_text(
        "frame,lens\n" + "".join(f"{frame},a.json\n" for frame in range(FRAMES))
    )
    assert not isinstance(read_flight(str(path)).lens, Lenses)


def test_the_lens_of_a_page_has_its_field() -> None:
    """Beyond it a page predicts no landmark: r - .3 r^3 grows until .9 r^2 is 1."""
    pinhole, barrel = (replace(LENS, k=np.array([k1, *[0.0] * 11])) for k1 in (0.0, -0.3))
    (of_pinhole,), which = plain_lenses(pinhole, 3)
    (of_barrel,), _ = plain_lenses(barrel, 3)
    assert (of_pinhole["field"], which) == (None, [0, 0, 0])
    assert_close("ratio", of_barrel["field"], 0.9**-0.5)


def test_each_lens_of_a_table_is_doubted_by_its_name(tmp_path: Path) -> None:
    """A calibration at half of the size, beside one that is right: landmarks were blamed."""
    path = two_cameras(tmp_path)
    assert not read_flight(str(path)).findings
    half = replace(OTHER, centre_px=OTHER.centre_px / 2.0)
    (tmp_path / "cameras" / "b.json").write_text(camera_file(half, "fisheye"))
    (doubt,) = read_flight(str(path)).findings
    assert doubt.message.startswith("cameras/lenses.csv: b.json: the principal point ")


def test_images_and_cameras_that_are_refused(tmp_path: Path) -> None:
    path = two_cameras(tmp_path)
    toml, table = path.read_text(), tmp_path / "cameras" / "lenses.csv"
    rows = table.read_text()
    for text, keys in (
        (rows.replace("3,b.json\n", ""), ""),
        (rows + "3,a.json\n", ""),
        ("frame,lens\n", ""),
        (rows.replace("3,b.json", "3,"), ""),
        (rows.replace("3,b.json", "3,c.json"), ""),
        ("frame,lens\n" + "".join(f"{k},a.json\n" for k in (0, 1, 2, 4)), ""),
        (rows, '[solve]\nfree = ["focal"]\n'),
        (rows, '[solve]\nframes = "one"\n'),
    ):
        table.write_text(text)
        path.write_text(toml + keys)
        with refused(VopdError):
            read_flight(str(path))


def test_a_new_project_with_a_table_of_lenses_needs_no_lens(tmp_path: Path) -> None:
    two_cameras(tmp_path)
    files = [f"--{one}={tmp_path / one}.csv" for one in ("landmarks", "picks", "track")]
    answers = [
        "--set=picks.frame_rate_hz=10.0", "--set=picks.first_frame_t_s=2.0",
        "--pixel-grid=centre", "--height=ellipsoid", "--sigma-landmarks=exact",
        "--sigma-position=exact", "--sigma-time=exact",
    ]  # fmt: skip
    table = "--set=camera.of_images=../cameras/lenses.csv"
    ran = vopd("new", tmp_path / "new", *files, *answers, table)
    assert ran.status == 0 and "needed" not in ran.stdout
    result = solve_flight(str(tmp_path / "new" / "flight.toml"))
    assert_close("solved angle", result.camera_deg, truth_deg())
