"""Levels, clocks and focal lengths that are fitted: limits, what is changed, what is said."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight import mistakes as fitted_mistakes
from vopd.flight.mistakes import _common, another_focal_length, another_level, another_offset
from vopd.geometry.earth import earth_centred_m, geodetic

ANY: Any = None
MARKS_M = earth_centred_m([47.0, -30.0], [16.0, -80.0], [400.0, 0.0])


def replaced(one: Any, **new: Any) -> Any:
    return SimpleNamespace(**(vars(one) | new))


class Fitted:
    """In the place of `_fitted`: what it is given, and the number that it finds."""

    def __init__(self, number: float, monkeypatch: pytest.MonkeyPatch) -> None:
        self.number = number
        monkeypatch.setattr(fitted_mistakes, "_fitted", self)
        monkeypatch.setattr(fitted_mistakes, "replace", replaced)

    def __call__(self, estimate: Any, responses: Any, changed: Any, limits: Any) -> Any:
        values = np.arange(12.0).reshape(2, 2, 3)
        self.responses = responses(
            SimpleNamespace(responses=SimpleNamespace(landmark=values, time=7.0, focal_length=8.0))
        )
        self.changed, self.limits = changed, limits
        return self.number, 0.25


@pytest.mark.parametrize(
    ("height_m", "named"),
    [(5.0, False), (5.01, True), (-5.01, True), (-5.0, False), (0.0, False), (46.4, True),
     (129.9, True), (130.0, False), (-129.9, True), (-130.0, False)],
)  # fmt: skip
def test_another_level(height_m: float, named: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    fitted = Fitted(height_m, monkeypatch)
    flight: Any = SimpleNamespace(landmarks=SimpleNamespace(position_m=MARKS_M))
    found = [*another_level(flight, ANY)]
    said = (
        f"with all landmarks {height_m:+.0f} m: are the heights of camera and landmarks counted "
        "from the same level? A geoid is up to 100 m from the ellipsoid"
    )
    assert [tuple(one) for one in found] == [(0.25, said)] * named
    assert fitted.limits == (-130.0, 130.0)
    assert fitted.responses.tolist() == [[2.0, 5.0], [8.0, 11.0]]  # up
    raised = geodetic(fitted.changed(12.5).landmarks.position_m)
    assert_close("flight position", raised.height_m, [412.5, 12.5])
    assert_close("ratio", raised.latitude_deg, [47.0, -30.0])


@pytest.mark.parametrize(("own", "time_s"), [(0.0, 1.504), (2.5, -0.25), (-40.0, 3600.0)])
def test_another_offset(own: float, time_s: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames that are later see the track earlier."""
    fitted = Fitted(time_s, monkeypatch)
    monkeypatch.setattr(fitted_mistakes, "flight_of", lambda changed: changed)
    monkeypatch.setattr(fitted_mistakes, "some_frames", lambda flight: flight)
    project: Any = SimpleNamespace(
        has=lambda name: name == "track",
        section=lambda name: SimpleNamespace(number=lambda key, default: own or default),
        changed=lambda *what: what,
    )
    moving: Any = SimpleNamespace(path=SimpleNamespace(acceleration_m_s2=np.zeros((1, 3))))
    ((typical, said),) = another_offset(project, moving, ANY)
    assert typical == 0.25 and fitted.limits == (-3600.0, 3600.0) and fitted.responses == 7.0
    assert said == (
        f"with the track {-time_s:+.2f} s: do the clocks differ? Then give [track] "
        f"offset_s = {own - time_s:.2f}"
    )
    assert fitted.changed(0.5) == ("track", "offset_s", own - 0.5)
    by_image: Any = SimpleNamespace(path=SimpleNamespace(acceleration_m_s2=None))
    assert [*another_offset(project, by_image, ANY)] == []
    project.has = lambda name: name == "position"
    assert [*another_offset(project, moving, ANY)] == []


def test_another_focal_length(monkeypatch: pytest.MonkeyPatch) -> None:
    """1,000 px is the mean of 1,100 and 900; 250 more are a quarter of each; 4 times at most."""
    fitted = Fitted(250.4, monkeypatch)
    lens = SimpleNamespace(focal_px=np.array([1100.0, 900.0]))
    flight: Any = SimpleNamespace(lens=lens)
    ((typical, said),) = another_focal_length(flight, ANY)
    assert typical == 0.25 and fitted.limits == (-750.0, 3000.0) and fitted.responses == 8.0
    assert said == (
        "with a focal length of 1250 px in the place of 1000: is the lens that of this camera, "
        "at this zoom and image size?"
    )
    assert fitted.changed(250.0).lens.focal_px.tolist() == [1375.0, 1125.0]
    assert lens.focal_px.tolist() == [1100.0, 900.0]


def test_the_shift_that_takes_most_of_all_residuals_away() -> None:
    """What turns cannot take up: the first coordinates of two frames by 2 and 1 a unit.

    Their residuals are 6 and 1, and the best shift is -(2 6 + 1 1) / (4 + 1). The third
    coordinate is taken up by a turn, and the last frame has no attitude.
    """
    partials = np.zeros((3, 4, 3))
    partials[:, 2, 0] = 1.0
    gain = np.zeros((3, 3, 4))
    gain[:, 0, 2] = 1.0
    gain[2] = np.nan
    residual = np.array([[6.0, 0.0, 9.0, 0.0], [1.0, 0.0, -5.0, 0.0], [99.0] * 4])
    estimate: Any = SimpleNamespace(partials=partials, gain=gain, residual=residual)
    responses = np.array([[2.0, 0.0, 7.0, 0.0], [1.0, 0.0, 3.0, 0.0], [1.0] * 4])
    assert_close("ratio", _common(estimate, responses), -13.0 / 5.0)
    with np.errstate(all="ignore"):
        assert _common(estimate, np.zeros((3, 4))) == 0.0


def test_a_number_that_can_no_longer_be_read_fits_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first step of 50 can be read and fits, the next cannot."""
    monkeypatch.setattr(fitted_mistakes, "_common", lambda *_: 50.0)
    monkeypatch.setattr(fitted_mistakes, "solved_trial", lambda flight: flight)
    monkeypatch.setattr(fitted_mistakes, "typical_px", lambda *_: 0.5)

    def changed(number: float) -> Any:
        if number > 60.0:
            raise VopdError("does not cover any frame")

    assert fitted_mistakes._fitted(ANY, str, changed, (-200.0, 200.0)) == (100.0, np.inf)
