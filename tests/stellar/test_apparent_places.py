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
from vopd.findings import DeckError, VopdError

pytest.importorskip("skyfield")
from skyfield import jpllib
from skyfield.errors import EphemerisRangeError

from vopd.stellar.sky import apparent_places as places
from vopd.stellar.sky.apparent_places import (
    PlacesOfStars,
    SkyFrame,
    _ephemeris,
    apparent_places,
    refracted,
)
from vopd.stellar.sky.sky_request import SkyRequest

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
    with pytest.raises(DeckError) as caught, _ephemeris("de421.bsp"):
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
        with pytest.raises(DeckError) as caught, _ephemeris("de421.bsp"):
            raise error
        assert str(caught.value) == f"de421.bsp: {said}"
    assert kernel.closed and given == ["de421.bsp"]


def test_packages_that_lack(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Path(places._packaged()).name == "de421.bsp"
    monkeypatch.setitem(sys.modules, "skyfield_data", None)
    with pytest.raises(VopdError) as caught:
        places._packaged()
    said = "no ephemeris: --ephemeris FILE, or pip install 'vopd[stars]'"
    assert str(caught.value) == said
    monkeypatch.setitem(sys.modules, "skyfield", None)
    with pytest.raises(VopdError) as caught:
        apparent_places(STAR, SkyRequest(MOMENT))
    assert str(caught.value) == "skyfield is not installed: pip install 'vopd[stars]'"
