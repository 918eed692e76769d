"""Which mistakes are tried, in which order, from which freedom on, and what is said of each."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight import mistakes as mistake_trials
from vopd.flight.mistakes import _clocks, _feet, _from_feet, _landmarks, _upward, trials
from vopd.flight.project import read_project
from vopd.geometry.earth import earth_centred_m, geodetic

ANY: Any = None


def project(**sections: dict[str, Any]) -> Any:
    """A project whose sections have these keys; `changed` gives section, key and number."""

    def section(name: str) -> Any:
        keys = sections[name]
        return SimpleNamespace(
            number=lambda key, default: keys.get(key, default),
            text=lambda key, choices=(), default=None: keys.get(key, default),
            has=lambda key: key in keys,
        )

    return SimpleNamespace(
        has=lambda name: name in sections, section=section, changed=lambda *what: what
    )


@pytest.mark.parametrize(("free", "tried"), [(3, 0), (4, 7), (5, 7)])
def test_mistakes_are_tried_from_four_residuals_more_than_angles_on(
    free: int, tried: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("_upward", "_feet", "_clocks", "another_level", "another_offset",
             "another_focal_length", "_landmarks")  # fmt: skip
    for name in names:
        monkeypatch.setattr(mistake_trials, name, lambda *_, name=name: iter([name]))
    monkeypatch.setattr(mistake_trials, "freedom", lambda _: free)
    assert [*map(str, trials(ANY, ANY, ANY))] == list(names)[:tried]


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> None:
    """The residual of a flight stands for the flight."""
    monkeypatch.setattr(mistake_trials, "_typical_of", lambda flight: flight)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("keys", "way", "key"),
    [({}, "upward", "up"), ({"v": "down"}, "upward", "up"), ({"v": "up"}, "downward", "down")],
)
def test_v_is_turned_over_within_the_height_of_the_image(
    keys: dict[str, str], way: str, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mistake_trials, "replace", lambda one, **new: SimpleNamespace(**new))
    flight: Any = SimpleNamespace(
        picks=SimpleNamespace(pixel=np.array([[3.0, 0.0], [4.0, 99.0], [5.0, 10.5]])),
        lens=SimpleNamespace(size_px=(300, 100)),
    )
    (trial,) = _upward(project(picks=keys), flight)
    turned: Any = trial.typical_px
    assert turned.picks.pixel.tolist() == [[3.0, 99.0], [4.0, 0.0], [5.0, 88.5]]
    assert trial.message == f'with v counted {way}: give [picks] v = "{key}"?'


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("where", ["track", "position"])
def test_heights_in_feet_of_marks_of_the_camera_and_of_both(
    where: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def replaced(one: Any, **new: Any) -> Any:
        return SimpleNamespace(**(vars(one) | new))

    monkeypatch.setattr(mistake_trials, "replace", replaced)
    monkeypatch.setattr(mistake_trials, "_from_feet", lambda _, section, position: section)
    flight: Any = SimpleNamespace(
        landmarks=SimpleNamespace(position_m="marks"), path=SimpleNamespace(position_m="camera")
    )
    found = [
        (one.message, of.landmarks.position_m, of.path.position_m)
        for one in _feet(project(**{where: {}}), flight)
        for of in [_any(one.typical_px)]
    ]
    assert found == [
        ("with the landmarks' heights taken for feet: are they in feet?", "landmarks", "camera"),
        ("with the camera's heights taken for feet: are they in feet?", "marks", where),
        ("with all heights taken for feet: are they in feet?", "landmarks", where),
    ]


def _any(value: Any) -> Any:
    return value


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("own", [0.0, 2.5])
def test_both_clocks_are_tried_on_top_of_the_own_offset(
    own: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mistake_trials, "some_frames", lambda one: one)
    made: list[Any] = []

    def flight_of(changed: Any) -> Any:
        made.append(changed)
        if failing and changed[2] < own:
            raise VopdError("does not cover any frame")
        return SimpleNamespace(path=SimpleNamespace(velocity_m_s=velocity))

    monkeypatch.setattr(mistake_trials, "flight_of", flight_of)
    one = project(track={"offset_s": own} if own else {})
    velocity, failing = np.zeros((1, 3)), False
    said = [trial.message for trial in _clocks(one)]
    assert said == [
        "with the track -18 s: is its clock GPS time?",
        "with the track +18 s: is its clock UTC and not GPS time?",
    ]
    assert made == [("track", "offset_s", own - 18.0), ("track", "offset_s", own + 18.0)]
    failing = True
    assert [trial.message for trial in _clocks(one)] == said[1:]
    failing, velocity = False, None  # positions of images do not depend on a clock
    assert [*_clocks(one)] == [] == [*_clocks(project(position={}))]


@pytest.mark.parametrize(("free", "told"), [(3, False), (4, True)])
def test_each_landmark_that_is_picked_and_used_is_left_out_once(
    free: int, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second is a check landmark, the fourth is never picked."""

    def replaced(one: Any, **new: Any) -> Any:
        return SimpleNamespace(**(vars(one) | new))

    monkeypatch.setattr(mistake_trials, "replace", replaced)
    monkeypatch.setattr(mistake_trials, "solved_trial", lambda one: one.landmarks.used)
    monkeypatch.setattr(mistake_trials, "freedom", lambda _: free)
    monkeypatch.setattr(mistake_trials, "typical_px", lambda one, estimate: estimate)
    flight: Any = SimpleNamespace(
        landmarks=SimpleNamespace(name=("a", "b", "c", "d", "e"), used=(True, False) + (True,) * 3),
        picks=SimpleNamespace(landmark=np.array([0, 1, 2, 4, 0, 1, 2])),
    )
    flight.picks.frame = flight.picks.landmark
    T, F = True, False
    expected = [
        ((F, F, T, T, T), "without a: are its coordinates and its name right?"),
        ((T, F, F, T, T), "without c: are its coordinates and its name right?"),
        ((T, F, T, T, F), "without e: are its coordinates and its name right?"),
    ]
    assert [tuple(one) for one in _landmarks(flight)] == (expected if told else [])
    assert mistake_trials.TRIAL_PICKS == 100_000
    monkeypatch.setattr(mistake_trials, "TRIAL_PICKS", 21)  # 3 of them times 7 picks
    assert len([*_landmarks(flight)]) == (3 if told else 0)
    monkeypatch.setattr(mistake_trials, "TRIAL_PICKS", 20)
    assert [*_landmarks(flight)] == []


@pytest.mark.parametrize(
    ("said", "expected_m"),
    [
        ('height = "ellipsoid"', 304.8),
        ("", 304.8),
        ("height = {undulation_m = 45.7}", 45.7 + 0.3048 * (1000.0 - 45.7)),
    ],
)
def test_a_height_taken_for_feet_by_hand(tmp_path: Path, said: str, expected_m: float) -> None:
    """1,000 are 304.8 m above what the heights are counted from; where it stands stays."""
    text = TOML.replace('height = "ellipsoid"', said)
    project = read_project(str(write_project(tmp_path, text)))
    where = geodetic(_from_feet(project, "landmarks", earth_centred_m(47.0, 16.0, 1000.0)))
    assert_close("flight position", where.height_m, expected_m)
    assert_close("angle wrapped 22 times", [where.latitude_deg, where.longitude_deg], [47.0, 16.0])
