"""Air, ephemeris and packages of apparent places; refraction against bisection of its formula."""

from __future__ import annotations

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit import night_sky
from tests.tolerances import assert_close, within
from vopd.findings import InputError, VopdError

pytest.importorskip("skyfield")
from skyfield import jpllib
from skyfield.errors import EphemerisRangeError

from vopd.stellar import sky as places
from vopd.stellar.sky import (
    PlacesOfStars,
    SkyFrame,
    SkyRequest,
    _ephemeris,
    apparent_places,
    refracted,
)

MOMENT = datetime.fromisoformat(night_sky.DATE).replace(tzinfo=UTC)
STAR = PlacesOfStars(np.array([80.0]), np.array([20.0]))
LOCAL = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]])
"""From ICRF axes to east, north, up."""


def test_refraction() -> None:
    """It raises by the formula for pressure and temperature, and turns nothing aside."""
    altitude = np.radians([3.0, 10.0, 45.0, 89.0])
    azimuth = np.radians([10.0, 100.0, 200.0, 300.0])
    true = night_sky.east_north_up(altitude, azimuth)
    frame = SkyFrame(np.eye(3), LOCAL, night_sky.PRESSURE)
    found = refracted(true @ LOCAL, frame, night_sky.TEMPERATURE)
    raised = night_sky.raised(altitude)
    expected = night_sky.east_north_up(raised, azimuth)
    off = np.linalg.norm(found.directions @ LOCAL.T - expected, axis=1)
    assert np.degrees(off).max() * 3600.0 < within("sky direction")
    assert found.altitude_deg is not None
    assert_close("rae angle of nine digits", found.altitude_deg, np.degrees(raised))
    assert found.frame is frame


def test_no_air() -> None:
    true = night_sky.east_north_up(np.radians([-5.0, 30.0]), np.radians([10.0, 350.0]))
    found = refracted(true @ LOCAL, SkyFrame(np.eye(3), LOCAL, 0.0), 10.0)
    assert_close("rae element", found.directions, true @ LOCAL)
    assert found.altitude_deg is not None
    assert_close("rae angle", found.altitude_deg, [-5.0, 30.0])


PRESSURES = [
    (None, 0.0, 1010.0), (None, -400.0, 1010.0), (None, 9100.0, 1010.0 / np.e),
    (0.0, 500.0, 0.0), (960.0, 500.0, 960.0),
]  # fmt: skip


@pytest.mark.parametrize(("given", "height_m", "pressure"), PRESSURES)
def test_pressure_of_the_air(given: float | None, height_m: float, pressure: float) -> None:
    """As it is stated; or 1010 mbar at the level of the sea, and 1/e of it 9.1 km higher."""
    sky = SkyRequest(MOMENT, (48.0, 11.0, height_m), given)
    assert_close("rae angle", apparent_places(STAR, sky).frame.pressure_mbar, pressure)


def test_without_a_place_there_is_no_horizon() -> None:
    found = apparent_places(STAR, SkyRequest(MOMENT, pressure_mbar=960.0))
    assert found.altitude_deg is None and found.frame.local is None
    assert found.frame.pressure_mbar == 0.0
    assert_close("rae element", found.frame.of_date @ found.frame.of_date.T, np.eye(3))
    assert np.abs(found.frame.of_date - np.eye(3)).max() > 0.001  # precession of 20 years


def test_the_equator_and_equinox_of_the_date() -> None:
    """Precession and nutation by ERFA; the two turn by .28 degree and 9 seconds of arc by 2020."""
    erfa = pytest.importorskip("erfa")
    found = apparent_places(STAR, SkyRequest(MOMENT)).frame.of_date
    days = (MOMENT - datetime(2000, 1, 1, 12, tzinfo=UTC)).total_seconds() / 86400.0
    expected = erfa.pnm06a(2451545.0, days + 69.184 / 86400.0)  # TT is 37 + 32.184 s ahead of UTC
    off = np.degrees(np.abs(found - expected)).max() * 3600.0
    assert off < within("sky direction")


class Api:
    """Keeps what a star is made of."""

    @staticmethod
    def Star(**fields: Any) -> dict[str, list[float]]:
        return {name: np.asarray(value).tolist() for name, value in fields.items()}


def test_a_star_as_skyfield_takes_it() -> None:
    """Hours, degrees, mas a year; the epoch of the Hipparcos catalogue is JD 2448349.0625."""
    two = PlacesOfStars(np.array([15.0, 30.0]), np.array([40.0, -50.0]))
    moving = two._replace(
        year=1991.25, ra_mas_per_year=np.array([1.0, 2.0]), dec_mas_per_year=np.array([3.0, 4.0]),
        parallax_mas=np.array([5.0, 6.0]),
    )  # fmt: skip
    assert places._star(Api, moving) == {
        "ra_hours": [1.0, 2.0], "dec_degrees": [40.0, -50.0], "ra_mas_per_year": [1.0, 2.0],
        "dec_mas_per_year": [3.0, 4.0], "parallax_mas": [5.0, 6.0], "epoch": 2448349.0625,
    }  # fmt: skip
    still = places._star(Api, two)
    assert still["epoch"] == 2451545.0
    names = ("ra_mas_per_year", "dec_mas_per_year", "parallax_mas")
    assert [still[name] for name in names] == [[0.0, 0.0]] * 3


def test_the_height_of_the_place_counts() -> None:
    """100 km higher the Earth's rotation is 4.88 m/s faster at latitude 48: an aberration."""
    low, high = (
        apparent_places(STAR, SkyRequest(MOMENT, (48.0, 11.0, height), 0.0)).directions[0]
        for height in (0.0, 1e5)
    )
    frame = apparent_places(STAR, SkyRequest(MOMENT, (48.0, 11.0, 0.0), 0.0)).frame
    assert frame.local is not None
    faster = 7.292115e-5 * 1e5 * np.cos(np.radians(48.0)) / 299_792_458.0 * frame.local[0]
    assert_close("flight direction", high - low, faster - (faster @ low) * low)


class Kernel:
    """An ephemeris without planets, which can be closed."""

    closed = False

    def close(self) -> None:
        self.closed = True


BROKEN: list[tuple[Exception, str]] = [
    (FileNotFoundError(2, "No such file"), "cannot be read: No such file"),
    (OSError("bad kernel"), "cannot be read: bad kernel"),
    (ValueError("what"), "not an ephemeris (.bsp)"),
    (KeyError("what"), "not an ephemeris (.bsp)"),
]  # fmt: skip


@pytest.mark.parametrize(("error", "said"), BROKEN)
def test_an_ephemeris_that_cannot_be_opened(
    monkeypatch: pytest.MonkeyPatch, error: Exception, said: str
) -> None:
    def opened(path: str) -> Any:
        raise error

    monkeypatch.setattr(jpllib, "SpiceKernel", opened)
    with pytest.raises(InputError) as caught, _ephemeris("de421.bsp"):
        pass
    assert str(caught.value) == f"de421.bsp: {said}"


LACKING: list[tuple[Exception | None, str]] = [
    (None, ""),
    (EphemerisRangeError("only 1900 to 2050", None, None, None, None), "it does not have the date: "
     "only 1900 to 2050"),
    (KeyError("no earth"), "it does not have 'no earth'"),
]  # fmt: skip


@pytest.mark.parametrize(("error", "said"), LACKING)
def test_an_ephemeris_that_lacks_something(
    monkeypatch: pytest.MonkeyPatch, error: Exception | None, said: str
) -> None:
    """It is closed in any case."""
    kernel, given = Kernel(), list[str]()
    monkeypatch.setattr(jpllib, "SpiceKernel", lambda path: given.append(path) or kernel)
    if error is None:
        with _ephemeris("de421.bsp") as planets:
            assert planets is kernel and not kernel.closed
    else:
        with pytest.raises(InputError) as caught, _ephemeris("de421.bsp"):
            raise error
        assert str(caught.value) == f"de421.bsp: {said}"
    assert kernel.closed and given == ["de421.bsp"]


def test_packages_that_lack(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Path(places._packaged_ephemeris()).name == "de421.bsp"
    monkeypatch.setitem(sys.modules, "skyfield_data", None)
    with pytest.raises(VopdError) as caught:
        places._packaged_ephemeris()
    said = "no ephemeris: --ephemeris FILE, or pip install 'vopd[stars]'"
    assert str(caught.value) == said
    monkeypatch.setitem(sys.modules, "skyfield", None)
    with pytest.raises(VopdError) as caught:
        apparent_places(STAR, SkyRequest(MOMENT))
    assert str(caught.value) == "skyfield is not installed: pip install 'vopd[stars]'"
