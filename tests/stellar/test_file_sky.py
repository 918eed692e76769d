"""Stars of a file by coordinates, by name and with a date: directions, epochs, what is said."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.stellar import sky as file_sky
from vopd.stellar.field import star_directions
from vopd.stellar.files.read import StarFile
from vopd.stellar.sky import (
    ApparentPlaces,
    FileSky,
    PlacesOfStars,
    SkyFrame,
    SkyRequest,
    needs_no_date,
    sky_directions,
)

SKY = np.array([[10.0, 20.0], [30.0, 40.0], [350.0, -60.0]])
UTC_2020 = datetime(2020, 1, 15, 21, 5, 9, 900000, tzinfo=UTC)


def star_file(kind: str = "ra_deg,dec_deg", names: tuple[str, ...] = ("", "", "")) -> StarFile:
    image = np.zeros((3, 2))
    return StarFile("a.csv", (12, 13, 14), names, image, "mm", kind, SKY)


def catalogue(folder: Path) -> str:
    """Three stars of 1991.25 by lines of hip_main.dat: one moves east, one north, one is still."""
    lines = []
    for number, ra, dec, east, north in (
        (7, 10.0, 60.0, 4000.0, 0.0), (8, 20.0, -30.0, 0.0, -8000.0), (123456, 40.0, 50.0, 0.0, 0.0)
    ):  # fmt: skip
        cells = [""] * 20
        cells[0], cells[1], cells[5] = "H", f"{number:12d}", f"{number % 10}.25"
        cells[8], cells[9], cells[11] = str(ra), str(dec), "100.5"
        cells[12], cells[13] = str(east), str(north)
        lines.append("|".join(cells))
    file = folder / "hip_main.dat"
    file.write_text("\n".join(lines) + "\n")
    return str(file)


NAMES = ("HIP 123456", "7", "hip8")
ICRF = "ICRF axes (J2000)"


def solve(file: StarFile, sky: SkyRequest) -> tuple[FileSky, list[Finding]]:
    found: list[Finding] = []
    return sky_directions(file, sky, found.append), found


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg"])
def test_stars_by_coordinates(kind: str) -> None:
    sky, found = solve(star_file(kind), SkyRequest())
    assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
    said = "stars as the file has them: no proper motion, aberration or refraction"
    assert (sky.epoch, sky.frame, sky.magnitude, found) == (f"{ICRF}, {said}", None, None, [])


def test_stars_by_name(tmp_path: Path) -> None:
    """8.75 years of motion: 35 seconds of arc of a great circle eastward, 70 southward."""
    sky, _ = solve(star_file("name", NAMES), SkyRequest(catalogue=catalogue(tmp_path)))
    east = 35.0 / 3600.0 / np.cos(np.radians(60.0))
    ra, dec = np.array([40.0, 10.0 + east, 20.0]), np.array([50.0, 60.0, -30.0 - 70.0 / 3600.0])
    assert_close("rae element", sky.directions, star_directions(ra, dec))
    assert sky.magnitude is not None and sky.magnitude.tolist() == [6.25, 7.25, 8.25]
    said = "stars of the Hipparcos catalogue at 2000.0: no aberration or refraction"
    assert (sky.epoch, sky.frame) == (f"{ICRF}, {said}", None)


REFUSED = {
    ("7", "Vulcan", "x"): "line 13: 'Vulcan' is no star's name or Hipparcos number "
    "(Betelgeuse, HIP 27989)",
    ("", "7", "8"): "line 12: '' is no star's name or Hipparcos number (Betelgeuse, HIP 27989)",
    ("7", "HIP 8", "99"): "line 14: the catalogue has no star HIP 99",
    ("99", "7", "98"): "line 12: the catalogue has no star HIP 99",
}


@pytest.mark.parametrize("names", REFUSED)
def test_stars_that_are_not_known(names: tuple[str, ...], tmp_path: Path) -> None:
    pytest.importorskip("skyfield")
    with pytest.raises(InputError) as caught:
        solve(star_file("name", names), SkyRequest(catalogue=catalogue(tmp_path)))
    assert str(caught.value) == f"a.csv: {REFUSED[names]}"


def seen(
    monkeypatch: pytest.MonkeyPatch, altitude: list[float] | None, pressure: float, frame: bool
) -> list[PlacesOfStars]:
    """Let stars be seen at these altitudes; the places that are asked for."""
    asked: list[PlacesOfStars] = []

    def apparent(stars: PlacesOfStars, sky: SkyRequest) -> ApparentPlaces:
        assert sky.utc == UTC_2020
        asked.append(stars)
        local = np.eye(3) if frame else None
        heights = None if altitude is None else np.array(altitude)
        return ApparentPlaces(np.full((3, 3), 0.5), heights, SkyFrame(np.eye(3), local, pressure))

    monkeypatch.setattr(file_sky, "apparent_places", apparent)
    return asked


EFFECTS: list[tuple[bool, float, str]] = [
    (False, 0.0, "aberration and light deflection"),
    (True, 0.0, "aberration and light deflection"),
    (True, 900.0, "aberration, light deflection and refraction"),
]


@pytest.mark.parametrize(("frame", "pressure", "effects"), EFFECTS)
@pytest.mark.parametrize("named", [False, True])
def test_stars_of_a_date(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, frame: bool, pressure: float, effects: str,
    named: bool,
) -> None:  # fmt: skip
    asked = seen(monkeypatch, None, pressure, frame)
    file = star_file("name", NAMES) if named else star_file()
    sky, found = solve(file, SkyRequest(utc=UTC_2020, catalogue=catalogue(tmp_path)))
    source = "the Hipparcos catalogue" if named else "the file, without proper motion"
    assert sky.epoch == (
        f"{ICRF}, and where it says of date the true equator and equinox of "
        f"2020-01-15T21:05:09Z; stars of {source}, seen with {effects}"
    )
    assert (sky.magnitude is not None) == named and found == []
    assert sky.frame is not None and sky.frame.pressure_mbar == pressure
    assert sky.directions.tolist() == np.full((3, 3), 0.5).tolist()
    (stars,) = asked
    if named:
        assert stars.year == 1991.25
        assert stars.ra_deg.tolist() == [40.0, 10.0, 20.0]
        assert stars.dec_deg.tolist() == [50.0, 60.0, -30.0]
        motion: Any = (stars.ra_mas_per_year, stars.dec_mas_per_year, stars.parallax_mas)
        assert [one.tolist() for one in motion] == [
            [0.0, 4000.0, 0.0], [0.0, 0.0, -8000.0], [100.5, 100.5, 100.5],
        ]  # fmt: skip
    else:
        assert (stars.year, stars.ra_mas_per_year, stars.parallax_mas) == (2000.0, 0.0, 0.0)
        assert stars.ra_deg.tolist() == [10.0, 30.0, 350.0]


ASK = "below the horizon at that time and place: "
ASK += "is the date in UTC, is the longitude positive toward east?"
LOW: list[tuple[list[float], str]] = [
    ([5.0, -0.99, 0.0], ""),
    ([5.0, -1.0, 0.0], ""),
    ([5.0, -1.04, 0.0], f"line 13: the star is 1.0 degrees {ASK}"),
    ([-30.26, 5.0, -2.0], f"lines 12 and 14: these stars are up to 30.3 degrees {ASK}"),
    ([-2.0, -3.0, -4.0], f"lines 12, 13 and 14: these stars are up to 4.0 degrees {ASK}"),
]


@pytest.mark.parametrize(("altitude", "said"), LOW)
def test_stars_below_the_horizon(
    monkeypatch: pytest.MonkeyPatch, altitude: list[float], said: str
) -> None:
    seen(monkeypatch, altitude, 900.0, True)
    _, found = solve(star_file(), SkyRequest(utc=UTC_2020))
    assert [str(one) for one in found] == ([f"a.csv: {said}"] if said else [])
    assert {one.severity for one in found} <= {"warning"}


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg", "name", "u,v,w"])
def test_what_a_date_is_for(kind: str) -> None:
    place = (48.0, 11.0, 500.0)
    assert needs_no_date(star_file(kind), SkyRequest()) is None
    for sky in (SkyRequest(utc=UTC_2020), SkyRequest(place=place)):
        found = needs_no_date(star_file(kind), sky)
        said = "a.csv: a date and a place are for stars by ra and dec or by name, not u,v,w"
        assert (None if found is None else str(found)) == (said if kind == "u,v,w" else None)
