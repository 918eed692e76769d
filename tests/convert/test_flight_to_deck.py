"""A flight on cards: the 1974 solve of the deck has the flight's angles."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit.command import vopd as run
from tests.kit.flight_project import MARKS, TOML, write_project
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.errata import fixes
from vopd.findings import VopdError

PLAIN = re.sub("lens = .*", 'lens = { model = "brown", fx_px = 1500.0 }', TOML)
RADIAL = PLAIN.replace("fx_px = 1500.0", "fx_px = 1500.0, k = [-0.1, 0.02, 0, 0, 3e-3]")
TABLE = PLAIN.replace(
    '"brown", fx_px = 1500.0', '"radial-table", fx_px = 1500.0, table_px = [[500, 4.0], [1300, -3]]'
)
TO_SIDE = PLAIN + "[vehicle]\nmount = { ypr_deg = [0, 0, 30] }\n"


def angles_apart(one: Floats, other: Floats) -> float:
    return float(np.abs((one - other + 180.0) % 360.0 - 180.0).max())


def punched(folder: Path, toml: str, noise_px: float = 0.3) -> tuple[vopd.FlightResult, vopd.Run]:
    """The flight, and the run of its deck with all fixes."""
    flight = vopd.solve_flight(path := write_project(folder, toml, noise_px))
    assert run("punch", path, "-o", folder / "deck.dat").status == 0
    return flight, vopd.run(vopd.read_deck(folder / "deck.dat"), fixes("all"))


@pytest.mark.parametrize("toml", [PLAIN, RADIAL, TABLE, TO_SIDE, TOML])
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


def test_names_become_numbers_and_a_table_says_which(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    ran = run("punch", path, "--numbers", tmp_path / "numbers.csv", "-o", tmp_path / "deck.dat")
    assert ran.status == 0
    rows = (tmp_path / "numbers.csv").read_text().splitlines()
    assert rows == ["kind,number,name", *(f"landmark,{k},{n}" for k, n in enumerate(MARKS, 1))]
    ran = run("punch", path)
    assert "    landmark,2,mast\n" in ran.stderr and ran.stdout.splitlines()[25] == "1   F12"
    assert run("punch", path, "-q").stderr == ""


def test_check_landmarks_are_ignored_in_all_frames(tmp_path: Path) -> None:
    """Group 12 names them, and the solve is that of the flight without them."""
    toml = PLAIN + '[solve]\ncheck_landmarks = ["mast", "well"]\n'
    flight, deck = punched(tmp_path, toml)
    (job,) = vopd.read_deck(tmp_path / "deck.dat")
    named = job.ignored.everywhere
    assert named[named > 0].tolist() == [2, 6]
    assert angles_apart(deck.camera_deg, flight.camera_deg) < within("angle by cards")


@pytest.mark.parametrize(
    ("own", "numbers"), [("7", [7, 20, 30, 40, 50, 60]), ("0", range(1, 7)), ("100", range(1, 7))]
)
def test_landmarks_keep_numbers_that_a_card_can_have(
    own: str, numbers: list[int], tmp_path: Path
) -> None:
    """1 to 99, or all are numbered anew: 0 would be no landmark."""
    path = write_project(tmp_path, PLAIN)
    names = dict(zip(MARKS, [own, "20", "30", "40", "50", "60"], strict=True))
    for name in ("picks.csv", "landmarks.csv"):
        text = (tmp_path / name).read_text()
        for old, new in names.items():
            text = text.replace(old, new)
        (tmp_path / name).write_text(text)
    assert run("punch", path, "-o", tmp_path / "deck.dat").status == 0
    (job,) = vopd.read_deck(tmp_path / "deck.dat")
    assert job.landmarks.number.tolist() == list(numbers)


def test_images_are_numbered_and_get_times(tmp_path: Path) -> None:
    fixed = "[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 540.0\nheight = 'ellipsoid'\n"
    toml = PLAIN[: PLAIN.index("[track]")] + fixed
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
    assert "landmarks: cards have numbers for 99; punch a part of them" in ran.stderr
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
