"""A flight on cards: the 1974 solve of the deck has the flight's angles."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd as run
from tests.kit.flight_project import (
    LENS,
    MARK,
    MARKS,
    TOML,
    local_to_camera,
    three_frames,
    truth_deg,
    write_project,
)
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.convert.flight_to_deck import (
    CardFilm,
    NumberRow,
    card_film,
    card_trajectory,
    card_wind,
    flight_job,
    lost_on_cards,
    not_radial_text,
    roll_offset_deg,
    to_ten_columns,
)
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Clicks, Flight, FlightOptions, Refraction
from vopd.flight.result import FlightResult
from vopd.flight.solve.rotations import SolvedFlight, solve
from vopd.geometry.earth import geodetic
from vopd.geometry.lenses import Lens, LensKind, project
from vopd.geometry.rotations import DOWN, mount_by_angles
from vopd.job import Job

PLAIN = re.sub("lens = .*", 'lens = { model = "brown", fx_px = 1500.0 }', TOML)
RADIAL = PLAIN.replace("fx_px = 1500.0", "fx_px = 1500.0, k = [-0.1, 0.02, 0, 0, 3e-3]")
TABLE = PLAIN.replace(
    '"brown", fx_px = 1500.0', '"radial-table", fx_px = 1500.0, table_px = [[500, 4.0], [1300, -3]]'
)
UNCERTAIN = TOML.replace('\nsigma_m = "exact"', "\nsigma_m = 3.0")
TO_SIDE = PLAIN + "[vehicle]\nmount = { ypr_deg = [0, 0, 30] }\n"


def angles_apart(one: Floats, other: Floats) -> float:
    return float(np.abs((one - other + 180.0) % 360.0 - 180.0).max())


def punched(folder: Path, toml: str, noise_px: float = 0.3) -> tuple[vopd.FlightResult, vopd.Run]:
    """The flight, and the run of its deck with all fixes."""
    flight = vopd.solve_flight(path := write_project(folder, toml, noise_px))
    assert run("punch", path, "-o", folder / "deck.dat").status == 0
    return flight, vopd.run(vopd.read_deck(folder / "deck.dat"), fixes("all"))


@pytest.mark.parametrize("toml", [PLAIN, RADIAL, TABLE, TO_SIDE, TOML, UNCERTAIN])
def test_the_deck_has_the_angles_of_the_flight(tmp_path: Path, toml: str) -> None:
    flight, deck = punched(tmp_path, toml)
    assert deck.converged.all()
    assert angles_apart(deck.camera_deg, flight.camera_deg) < within("angle by cards")
    assert angles_apart(deck.vehicle_deg, flight.vehicle_deg) < within("angle by cards")
    attack = np.stack([deck.alpha_deg, deck.beta_deg, deck.eta_deg], axis=1)
    assert angles_apart(attack, flight.attack_deg) < within("angle by cards")
    assert_close("flight time", deck.time_s, flight.time_s)


def test_a_radial_lens_is_in_group_1_and_another_is_taken_off_the_picks(tmp_path: Path) -> None:
    _, deck = punched(tmp_path / "a", RADIAL)
    camera = deck[0].job.camera
    # 300 px of .005 in on the reader; the ideal radius is 300 (1 + .1 / 25 - ...) px
    mm = 0.005 * 0.713816400205
    ideal = np.interp(300.0 * mm, camera.lens_radius_mm, camera.lens_radius_mm
                      + camera.lens_distortion_um / 1000.0) / mm  # fmt: skip
    r = ideal / 1500.0
    assert abs(ideal * (1 - 0.1 * r**2 + 0.02 * r**4 + 3e-3 * r**6) - 300.0) < within(
        "lens by table"
    )
    _, deck = punched(tmp_path / "b", TOML)
    assert not deck[0].job.camera.lens_distortion_um.any()


def test_a_table_of_few_rows_goes_on_along_its_last_line(tmp_path: Path) -> None:
    """Group 1 has 25 rows: 4 px at 500, -3 at 1300, and from there -7 more each 800 px."""
    _, deck = punched(tmp_path, TABLE)
    camera, mm = deck[0].job.camera, 0.005 * 0.713816400205
    radius_px, added_px = camera.lens_radius_mm / mm, camera.lens_distortion_um / mm / 1000.0
    assert len(radius_px) == 25 and (np.diff(radius_px) > 0.0).all()
    assert np.abs(radius_px[1:3] - [500.0, 1300.0]).max() < within("lens by table")
    beyond = radius_px[3:]
    expected = [0.0, 4.0, -3.0, *(-3.0 - 7.0 * (beyond - 1300.0) / 800.0)]
    assert np.abs(added_px - expected).max() < within("lens by table")


def test_the_deck_states_the_standard_deviation_of_a_pick(tmp_path: Path) -> None:
    _, deck = punched(tmp_path, PLAIN.replace('.csv"\npixel', '.csv"\nsigma_px = 0.7\npixel'))
    sigma_mm = deck.histories()[0].estimate.reading_spread
    assert abs(sigma_mm / (0.005 * 0.713816400205) - 0.7) < within("pick by readings")


def test_without_a_stated_one_it_is_that_of_the_flight(tmp_path: Path) -> None:
    """Picks are .1 px off: .3 px is the least that is believed."""
    _, deck = punched(tmp_path, TOML, 0.1)
    sigma_mm = deck.histories()[0].estimate.reading_spread
    assert abs(sigma_mm / (0.005 * 0.713816400205) - 0.3) < within("pick by readings")


def test_names_become_numbers_and_a_table_says_which(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    ran = run("punch", path, "--numbers", tmp_path / "numbers.csv", "-o", tmp_path / "deck.dat")
    assert ran.status == 0
    rows = (tmp_path / "numbers.csv").read_text().splitlines()
    assert rows == ["kind,number,name", *(f"landmark,{k},{n}" for k, n in enumerate(MARKS, 1))]
    ran = run("punch", path)
    assert "    landmark,2,mast\n" in ran.stderr and ran.stdout.splitlines()[25] == "1   F12"
    assert run("punch", path, "-q").stderr == ""


@pytest.mark.parametrize("more", [0, 2])
def test_twelve_of_the_numbers_are_told(more: int, tmp_path: Path) -> None:
    """Landmarks 1 to 6, and others that no picks show."""
    path = write_project(tmp_path)
    every = [*MARKS, *(f"more {k}" for k in range(6 + more))]
    picks, landmarks = tmp_path / "picks.csv", tmp_path / "landmarks.csv"
    place = landmarks.read_text().splitlines()[1].partition(",")[2]
    seen = picks.read_text().splitlines()[1].split(",", 2)
    for name in every[6:]:
        with landmarks.open("a") as file, picks.open("a") as other:
            file.write(f"{name},{place}\n")
            other.write(f"{seen[0]},{name},{seen[2]}\n")
    told = run("punch", path).stderr.partition("numbered anew")[2].splitlines()[1:]
    assert told[:12] == [f"    landmark,{k},{name}" for k, name in enumerate(every, 1)][:12]
    assert len(told) == (13 if more else 12)
    assert_approved(told[12:])


def test_check_landmarks_are_ignored_in_all_frames(tmp_path: Path) -> None:
    """Group 12 names them, and the solve is that of the flight without them."""
    toml = PLAIN + '[solve]\ncheck_landmarks = ["mast", "well"]\n'
    flight, deck = punched(tmp_path, toml)
    (job,) = vopd.read_deck(tmp_path / "deck.dat")
    named = job.ignored.everywhere
    assert named[named > 0].tolist() == [2, 6]
    assert angles_apart(deck.camera_deg, flight.camera_deg) < within("angle by cards")


def test_images_are_numbered_and_get_times(tmp_path: Path) -> None:
    fixed = (
        "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
        "height = 'ellipsoid'\nsigma_m = 'exact'\n"
    )
    toml = PLAIN[: PLAIN.index("[track]")].replace("frame_rate_hz", "# frame_rate_hz") + fixed
    path = write_project(tmp_path, toml)
    picks = tmp_path / "picks.csv"
    rows = [f"IMG_{row[0]}.jpg{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    ran = run("punch", path, "-o", tmp_path / "deck.dat")
    assert "    frame,2,IMG_1.jpg\n" in ran.stderr and "they are a second apart" in ran.stderr
    assert "the velocity is not known" in ran.stderr
    flight = vopd.solve_flight(path)
    deck = vopd.run(vopd.read_deck(tmp_path / "deck.dat"), fixes("all"))
    assert angles_apart(deck.camera_deg, flight.camera_deg) < within("angle by cards")


def test_images_whose_names_go_back_in_time_are_on_cards_in_time(tmp_path: Path) -> None:
    """The last image by name is the first one taken."""
    toml = re.sub("(?m)^(frame_rate_hz|first_frame).*\n", "", PLAIN)
    path = write_project(tmp_path, toml.replace("[picks]\n", '[picks]\ntimes = "times.csv"\n', 1))
    picks, frames = tmp_path / "picks.csv", range(5)
    rows = [f"{9 - int(row[0])}.jpg{row[1:]}" for row in picks.read_text().splitlines()[1:]]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *rows]))
    times = [f"{9 - k}.jpg,{2.0 + 0.1 * k:.1f}" for k in frames]
    (tmp_path / "times.csv").write_text("\n".join(["image,t_s", *times]))
    ran = run("punch", path, "-o", tmp_path / "deck.dat")
    assert ran.status == 0 and "    frame,1,9.jpg\n" in ran.stderr
    deck = vopd.run(vopd.read_deck(tmp_path / "deck.dat"), fixes("all"))
    assert deck.time_s.round(3).tolist() == [2.0, 2.1, 2.2, 2.3, 2.4]
    flight = vopd.solve_flight(path)
    assert flight.image_name[0] == "5.jpg"
    assert angles_apart(deck.camera_deg, flight.camera_deg[::-1]) < within("angle by cards")


STANDS = (
    "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\n"
    "height = 'ellipsoid'\nsigma_m = 5.0\n"
)


def test_images_without_times_are_on_cards_by_their_names(tmp_path: Path) -> None:
    """Forty of them, of five pictures: so many that a sort may exchange what is alike."""
    toml = re.sub("(?m)^(frame_rate_hz|first_frame).*\n", "", PLAIN)
    toml = re.sub(r"(?s)\[track\].*?(?=\n\[|\Z)", STANDS, toml)
    path = write_project(tmp_path, toml)
    picks = tmp_path / "picks.csv"
    rows = [row.split(",", 1) for row in picks.read_text().splitlines()[1:]]
    named = [f"{8 * int(k) + n:02d}.jpg,{rest}" for n in range(8) for k, rest in rows]
    picks.write_text("\n".join(["image,landmark,u_px,v_px", *named]))
    numbers = tmp_path / "numbers.csv"
    assert run("punch", path, "-o", tmp_path / "deck.dat", "--numbers", numbers).status == 0
    listed = [one for one in numbers.read_text().splitlines() if one.startswith("frame,")]
    assert listed == [f"frame,{k + 1},{k:02d}.jpg" for k in range(40)]


def test_names_of_numbers_are_no_formulas(tmp_path: Path) -> None:
    """A spreadsheet opens this table."""
    path = write_project(tmp_path)
    for name in ("picks.csv", "landmarks.csv"):
        text = (tmp_path / name).read_text()
        assert "church," in text
        (tmp_path / name).write_text(text.replace("church,", "=1+1,"))
    ran = run("punch", path, "-o", tmp_path / "deck.dat", "--numbers", tmp_path / "numbers.csv")
    assert ran.status == 0
    assert "landmark,1,'=1+1\n" in (tmp_path / "numbers.csv").read_text()


def test_what_does_not_fit_the_cards_is_refused(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "landmarks.csv").read_text().splitlines()
    more = [f"more{k},47.{650 + k},16.47,460" for k in range(100)]
    (tmp_path / "landmarks.csv").write_text("\n".join([*rows, *more]))
    picks = (tmp_path / "picks.csv").read_text().splitlines()
    extra = [f"4,more{k},{100 + k},{50 + k}" for k in range(100)]
    (tmp_path / "picks.csv").write_text("\n".join([*picks, *extra]))
    ran = run("punch", path, "-o", tmp_path / "deck.dat")
    assert ran.status == 1
    assert_approved(ran.stderr, parts=[99])
    assert not (tmp_path / "deck.dat").exists()
    ran = run("punch", tmp_path / "deck.dat")
    assert ran.status == 2 and "ends in .toml" in ran.stderr
    ran = run("punch", path, "-o", path)
    assert ran.status == 1 and path.read_text() == TOML


def test_there_and_back_again(tmp_path: Path) -> None:
    flight, _ = punched(tmp_path, TOML)
    assert run("new", tmp_path / "back", "--deck", tmp_path / "deck.dat").status == 0
    back = vopd.solve_flight(tmp_path / "back" / "flight.toml")
    assert angles_apart(back.camera_deg, flight.camera_deg) < within("angle by cards")
    assert back.findings == ()
    with refused(VopdError):
        vopd.solve_flight(tmp_path / "none.toml")


# A flight's picks on a film reader: its steps, the centre, where points are, and what is noted


CENTRE = np.array([950.0, 530.0])
PICK = 5


@pytest.fixture(scope="module")
def solved() -> SolvedFlight:
    return solve(three_frames())


def film(solved: SolvedFlight, lens: Lens) -> CardFilm:
    return card_film(replace(solved.flight, lens=lens), solved)


@pytest.mark.parametrize(
    ("size", "inches"),
    [
        ((494, 9), 0.02), ((9, 494), 0.02), ((496, 9), 0.01), ((9, 496), 0.01), ((989, 9), 0.01),
        ((991, 9), 0.005), ((1920, 1080), 0.005), ((1980, 9), 0.005), ((1981, 9), 0.002),
        ((4950, 9), 0.002), ((4951, 9), 0.001), ((9899, 9), 0.001), ((9901, 9), 0.0005),
        ((19799, 9), 0.0005), ((19801, 9), 0.0002), ((49499, 9), 0.0002), ((49501, 9), 0.0001),
        ((500_000, 9), 0.0001),
    ],
)  # fmt: skip
def test_a_pixel_is_the_largest_step_that_keeps_the_image_below_9_9_inches(
    size: tuple[int, int], inches: float, solved: SolvedFlight
) -> None:
    found = film(solved, replace(LENS, size_px=size))
    assert found.inches_per_px == inches
    assert_close("ratio", found.focal_length_mm, 1495.0 * inches * 0.713816400205)


def test_the_centre_is_to_a_hundredth_of_an_inch(solved: SolvedFlight) -> None:
    """Of 4.8025 and 2.7075, half of the image."""
    found = film(solved, replace(LENS, size_px=(1921, 1083))).centre_in
    assert_close("film length", found, [4.8, 2.71])


def of_lens(lens: Lens, refraction: Refraction) -> Flight:
    """The flight as this lens shows it at the truth."""
    base = replace(three_frames(), refraction=refraction)
    lines = solve(base).lines.direction
    turn = np.array([local_to_camera(angles) for angles in truth_deg()])[base.picks.frame]
    pixel = project(lens, np.einsum("pij,pj->pi", turn, lines)).pixel
    return replace(base, lens=lens, picks=replace(base.picks, pixel=pixel))


def test_points_of_a_pinhole_are_its_pixels_to_the_left_and_up() -> None:
    focal = np.array([1500.0, 1500.0])
    lens = Lens(LensKind.BROWN, (1920, 1080), focal, CENTRE, np.zeros(12))
    flight = of_lens(lens, Refraction(0.0))
    found = card_film(flight, solve(flight))
    expected = np.array([4.8, 2.7]) - (flight.picks.pixel - CENTRE) * 0.005
    assert_close("five decimals", found.point_in[4:], expected[4:])
    assert np.isnan(found.point_in[:4]).all()  # the first frame has no attitude
    assert found.notes == () and not found.distortion_um.any()
    assert found.radius_mm.shape == found.distortion_um.shape == (25,)


def test_points_of_a_radial_lens_are_where_its_table_has_them() -> None:
    """The table takes each to its ideal place, of which 1 + k1 r2 is the image."""
    k = np.zeros(12)
    k[0] = -0.1
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array([1500.0, 1500.0]), CENTRE, k)
    flight = of_lens(lens, Refraction(0.0))
    found = card_film(flight, solve(flight))
    pinhole = of_lens(replace(lens, k=np.zeros(12)), Refraction(0.0))
    mm = 0.005 * 0.713816400205
    ideal = np.hypot(*(pinhole.picks.pixel - CENTRE)[4:].T) * mm
    measured = np.hypot(*(found.point_in - found.centre_in)[4:].T) / 0.005 * mm
    added = np.interp(measured, found.radius_mm, found.distortion_um) / 1000.0
    assert_close("five decimals", measured + added, ideal)
    assert (found.distortion_um[1:] > 0.0).all() and found.notes == ()


def moved(solved: SolvedFlight, off_px: Floats) -> float:
    """How far the same gradient puts a pick from where the lens shows it, pixels.

    With D the derivative of pixels by the plane: D' r / f2 and not the inverse of D by r.
    """
    flight, step = solved.flight, 1e-5
    ray = solved.attitudes.rotation[flight.picks.frame[PICK]] @ solved.lines.direction[PICK]
    ray = ray / ray[2]
    columns = [
        (project(LENS, ray + way).pixel - project(LENS, ray - way).pixel) / (2 * step)
        for way in step * np.eye(3)[:2]
    ]
    by_plane, focal = np.stack(columns, axis=1), 1495.0
    apart = np.linalg.solve(by_plane, off_px) - by_plane.T @ off_px / focal**2
    return float(np.linalg.norm(apart) * focal)


@pytest.mark.parametrize(("wanted", "noted"), [(0.0045, False), (0.0055, True), (0.0123, True)])
def test_picks_that_are_moved_by_more_than_five_thousandths_are_noted(
    wanted: float, noted: bool, solved: SolvedFlight
) -> None:
    """And so is a lens that is not radial."""
    way = np.array([0.6, -0.8])
    pixel = solved.flight.picks.pixel.copy()
    pixel[PICK] += way * (wanted / moved(solved, way))
    flight = replace(solved.flight, picks=replace(solved.flight.picks, pixel=pixel))
    first, *more = card_film(flight, replace(solved, flight=flight)).notes
    assert_approved(first)
    assert len(more) == noted
    if noted:
        assert_approved(more[0], parts=[f"{wanted:.2g} px"])


@pytest.mark.parametrize(
    ("focal_px", "skew_px", "p1", "told"),
    [
        ((2000.0, 2000.1), 0.0, 0.0, "fx and fy differ by 0.005 %"),
        ((2000.0, 1900.0), 0.25, 0.0, "fx and fy differ by 5 %, its skew is 0.25 px"),
        ((2000.0, 2000.0), 0.0, 1e-4, "it has coefficients beside those of the radius"),
        ((2000.0, 2000.0), 0.0, 0.0, ""),
    ],
)
def test_by_what_a_lens_is_not_radial(
    focal_px: tuple[float, float], skew_px: float, p1: float, told: str
) -> None:
    k = np.array([-0.1, 0.02, p1, *np.zeros(9)])
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array(focal_px), CENTRE, k, skew_px=skew_px)
    assert not_radial_text(lens) == told and lens.is_radial == (told == "")


def test_refraction_is_taken_off_the_points() -> None:
    """By so much that it is seen: k = 1 raises lines by 5E-5, .07 px."""
    lens = Lens(LensKind.BROWN, (1920, 1080), np.array([1500.0, 1500.0]), CENTRE, np.zeros(12))
    bent, straight = (of_lens(lens, Refraction(k, False)) for k in (1.0, 0.0))
    found = card_film(bent, solve(bent))
    plain = card_film(straight, solve(straight))
    raised = np.abs(bent.picks.pixel - straight.picks.pixel)[4:, 1] * 0.005
    assert raised.min() > 1e-4
    assert_close("pick by readings", found.point_in * 10, plain.point_in * 10)


# The job of a flight: every record of it, its title, its mount and its wind


FT = 3.2808336


def result(flight: Flight) -> FlightResult:
    return FlightResult(FlightEstimates(solve(flight)), ())


Punched = tuple[Job, list[NumberRow], list[str]]


@pytest.fixture(scope="module")
def punched_job() -> Punched:
    return flight_job(result(three_frames()))


def test_every_record_of_the_job(punched_job: Punched) -> None:
    """Frames b and c of three have an attitude; the fourth landmark is a check landmark."""
    job = punched_job[0]
    assert job.return_group == 13 and job.title == "1   F12".ljust(80)
    assert job.clock.frame.tolist() == job.readings.frame.tolist() == [1, 2]
    assert_close("flight time", job.clock.time_s, [2.1, 2.2])
    assert_close("flight time", job.trajectory.time_s, [2.1, 2.2])
    assert job.landmarks.number.tolist() == [1, 2, 3, 4]
    assert job.readings.landmark.tolist() == [[1, 2, 3, 4]] * 2
    assert job.ignored.everywhere.tolist() == [4, 0, 0, 0]
    camera = job.camera
    assert_close("five decimals", camera.focal_length_mm, 1495.0 * 0.005 * 0.713816400205)
    assert camera.multiplier.tolist() == [1, 1, 1] and (camera.offset_deg == 0.0).all()
    first = truth_deg()[1] % 360.0 - [0, 360, 0]
    assert_close("printed angle", camera.initial_deg, first)
    assert (np.round(camera.initial_deg, 3) == camera.initial_deg).all()
    velocity = np.tile(np.array([20.0, 5.0, -2.0]) * FT, (2, 1))
    assert_close("motion on cards", job.trajectory.velocity_ft_s, velocity)
    assert_close("motion on cards", job.wind.velocity_ft_s, np.tile([3.0, -1.0], (2, 1)) * FT)


def test_errors_of_clicks_count_among_those_of_the_readings() -> None:
    """Each match has .4 px, and the .3 px of its click: .5 px, and so 3 ** .5 * .5 px apart."""
    flight = three_frames()
    count = len(flight.picks.frame)
    clicks = Clicks(
        np.zeros(MARK, int), np.arange(MARK), np.full(MARK, 0.3), np.arange(count),
        flight.picks.landmark, np.zeros((count, 2)), np.tile(np.eye(2), (count, 1, 1)),
        np.full(count, 0.4), np.zeros(0, int),
    )  # fmt: skip
    picks = replace(flight.picks, sigma_px=np.full(count, 0.4), one_sigma_px=0.4, clicks=clicks)
    readings = flight_job(result(replace(flight, picks=picks)))[0].readings.landmark_in
    apart_px = (readings[:, :, 1] - readings[:, :, 0]) / 0.005
    assert np.abs(apart_px - 3**0.5 * 0.5).max() < within("pick by readings")


def test_numbers_of_frames_and_then_of_landmarks(punched_job: Punched) -> None:
    frames = [("frame", 1, "b.jpg"), ("frame", 2, "c.jpg")]
    marks = [("landmark", k, n) for k, n in enumerate(("church", "mast", "bridge", "corner"), 1)]
    assert punched_job[1] == frames + marks


@pytest.mark.parametrize(
    ("name", "title"),
    [("", "1   FLIGHT"), ("Flüg 2", "1   Fl?g 2"), ("x" * 90, "1   " + "x" * 76)],
)
def test_the_title_is_eighty_columns_of_ascii(name: str, title: str) -> None:
    job = flight_job(result(replace(three_frames(), name=name)))[0]
    assert job.title == title.ljust(80) and len(job.title) == 80


def test_a_flight_without_an_attitude_is_refused() -> None:
    flight = three_frames()
    path = replace(flight.path, position_m=np.full((3, 3), np.nan))
    with refused(VopdError):
        flight_job(result(replace(flight, path=path)))


@pytest.mark.parametrize(
    ("mount", "roll"),
    [
        (mount_by_angles([0.0, 0.0, 0.0]), 0.0),
        (mount_by_angles([0.0, 0.0, 30.0]), -30.0),
        (mount_by_angles([0.0, 0.0, -170.0]), 170.0),
        (mount_by_angles([1e-4, 0.0, 0.0]), None),  # the cosine is 1.5E-12 below 1
        (mount_by_angles([1e-5, 0.0, 0.0]), 0.0),
        (DOWN, None),
    ],
)
def test_a_mount_that_is_a_turn_about_the_view(mount: Any, roll: float | None) -> None:
    found = roll_offset_deg(replace(three_frames(), mount=mount))
    assert (found is None) == (roll is None)
    assert_close("angle of a matrix", found or 0.0, roll or 0.0)


def test_notes_of_the_film_and_of_times_come_first() -> None:
    """The lens is not radial; a time is not known."""
    flight = replace(three_frames(), time_s=np.array([1.0, 2.0, np.nan]))
    notes = flight_job(result(flight))[2]
    assert notes[0].startswith("the lens is not radial: its distortion is taken off the picks")
    assert notes[1].startswith("the frames have no times that increase")
    assert notes[2].startswith("1 of 3 frames has no attitude") and notes[-1].startswith(
        "altitudes"
    )


def test_the_wind_is_by_altitude_upward_each_once_and_calm_where_there_is_none() -> None:
    flight = three_frames()
    wind = np.array([[9.0, 9.0], [1.0, 2.0], [3.0, 4.0]])
    windy = replace(flight, path=replace(flight.path, wind_m_s=wind))
    given: Any = type("Trajectory", (), {"altitude_ft": np.array([700.0, 300.0])})
    found = card_wind(windy, given, np.array([1, 2]))
    assert found.altitude_ft.tolist() == [300.0, 700.0]
    assert_close("five decimals", found.velocity_ft_s, np.array([[3.0, 4.0], [1.0, 2.0]]) * FT)
    given.altitude_ft = np.array([300.0, 300.0])
    assert_close(
        "five decimals", card_wind(windy, given, np.array([1, 2])).velocity_ft_s, wind[[1]] * FT
    )
    calm = card_wind(replace(flight, path=replace(flight.path, wind_m_s=None)), given, np.arange(2))
    assert (calm.altitude_ft.tolist(), calm.velocity_ft_s.tolist()) == ([0.0], [[0.0, 0.0]])


@pytest.mark.parametrize("value", [-0.0, -1e-12])
def test_no_minus_zero_is_written(value: float) -> None:
    assert np.signbit(to_ten_columns(np.array([value]))).tolist() == [False]


def test_the_trajectory_is_about_an_origin_that_the_card_holds() -> None:
    """Latitude and longitude of the first frame that is written, to ten columns; its own speed."""
    flight = three_frames()
    velocity = np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    flight = replace(flight, path=replace(flight.path, velocity_m_s=velocity))
    found = card_trajectory(solve(flight), flight, np.array([1, 2]), np.array([5.0, 6.0]))
    assert_close("five decimals", found.velocity_ft_s, velocity[1:] * FT)
    where = geodetic(flight.path.position_m)
    for own, full in (
        (found.origin_latitude_deg, where.latitude_deg[1]),
        (found.origin_longitude_deg, where.longitude_deg[1]),
    ):
        assert own == float(f"{own:.7f}") and own != full
        assert_close("angle at a pole", own, full)
    assert_close("cards of a flight", found.altitude_ft, where.height_m[1:] * FT)
    still = replace(flight, path=replace(flight.path, velocity_m_s=None))
    found = card_trajectory(solve(still), still, np.array([1, 2]), np.array([5.0, 6.0]))
    assert found.velocity_ft_s.tolist() == [[0.0] * 3] * 2


# Every sentence about what cards do not hold of a flight, and no other


HELD = np.arange(12) >= 4


def plain() -> Flight:
    """Of which the cards lose nothing but the first frame."""
    base = three_frames()
    return replace(
        base,
        epoch=None,
        refraction=Refraction(0.0),
        picks=replace(base.picks, sigma_px=np.ones(12)),
        landmarks=replace(base.landmarks, sigma_m=np.zeros((4, 3))),
        path=replace(base.path, fixes=None),
        options=FlightOptions(),
    )


def path(**new: Any) -> dict[str, Any]:
    return {"path": replace(plain().path, **new)}


LOST: list[dict[str, Any]] = [
    {"epoch": datetime(2026, 5, 1, tzinfo=UTC)},
    {"refraction": Refraction(0.1, False)},
    path(lever_arm_m=np.array([0.0, 0.0, 0.1])),
    {"picks": replace(plain().picks, sigma_px=np.where(np.arange(12) == 5, 1.01, 1.0))},
    {"options": replace(plain().options, loss="huber")},
    {"options": replace(plain().options, loss="cauchy")},
    {"mount": DOWN},
    path(velocity_m_s=None),
    {"landmarks": replace(plain().landmarks, sigma_m=np.full((4, 3), 0.01))},
    path(fixes=three_frames().path.fixes),
    path(bias_sigma_m=np.array([0.0, 0.0, 0.5])),
    {"options": FlightOptions(parameter_sigma={"clock": 0.01})},
    {"options": FlightOptions(parameter_sigma={"focal": 3.0, "k1": 0.0})},
    {"options": FlightOptions(parameter_sigma={"focal": 0.0, "k1": 0.01})},
    {"options": FlightOptions(parameter_sigma={"k3": 0.01})},  # of Metashape's covariance
]
NOT_LOST: list[dict[str, Any]] = [
    {},
    path(lever_arm_m=np.zeros(3)),
    {"picks": replace(plain().picks, sigma_px=np.where(np.arange(12) == 1, 1.5, 1.0))},
    {"mount": mount_by_angles([0, 0, 9])},
    {"options": FlightOptions(parameter_sigma={"focal": 0.0, "k1": 0.0})},
]


def lost(changes: dict[str, Any]) -> list[str]:
    """What is said where the first of three frames, and the picks of it, take no part."""
    given: Any = type("Result", (), {"solved": np.array([False, True, True])})
    return lost_on_cards(replace(plain(), **changes), given, HELD)


@pytest.mark.parametrize("k", range(len(LOST)))
def test_what_cards_lose(k: int) -> None:
    """One sentence more than of a flight of which nothing else is lost."""
    found = lost(LOST[k])
    assert [one for one in found if one in lost({})] == lost({})
    (said,) = (one for one in found if one not in lost({}))
    assert_approved(said)


@pytest.mark.parametrize("k", range(len(NOT_LOST)))
def test_what_cards_do_not_lose(k: int) -> None:
    assert lost(NOT_LOST[k]) == lost({})


def test_frames_and_picks_that_are_left_out_are_counted() -> None:
    assert_approved(lost({}), parts=["1 of 3", 4])
    given: Any = type("Result", (), {"solved": np.ones(3, bool)})
    assert_approved(lost_on_cards(plain(), given, np.ones(12, bool)))
    assert_approved(lost_on_cards(plain(), given, np.zeros(12, bool)), parts=[12])
