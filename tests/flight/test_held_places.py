"""What errors of places do that `[solve] position = "fixed"` holds, by differences of solves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.kit.joint_flights import axes, drone, flight_of, turned_out
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.adjust.adjustment import Adjustment, adjust
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.result import solve_flight_read
from vopd.flight.solve import held_places
from vopd.flight.solve.equations import Priors
from vopd.flight.solve.joint import JointSolution

FRAMES, LANDMARKS, STEP = 8, 5, 0.02  # of a standard deviation
MARK_M, FIX_M, BIAS_M = 0.1, (0.4, 0.4, 0.8), np.array([0.5, 0.5, 1.0])
FREE = ["focal", "clock"]


def fixes_beside() -> TrackFixes:
    """Fixes a second apart, of frames three a second between them."""
    time = np.arange(FRAMES) / 3.0
    part, first = time % 1.0, time.astype(np.int64)
    return TrackFixes(first, np.stack([1.0 - part, part], axis=1), np.tile(FIX_M, (4, 1)))


@cache
def perfect() -> Flight:
    """A flight of picks without errors, which states those of all places, and holds these."""
    rng = np.random.default_rng(3)
    scene = drone(rng, FRAMES, LANDMARKS)
    flight = flight_of(rng, scene, 1e-6, Priors(), velocity_m_s=(4.0, 2.0, 0.3))
    sigma_m = np.full((LANDMARKS, 3), MARK_M)
    return replace(
        flight,
        picks=replace(flight.picks, sigma_px=np.ones(len(scene.frame)), stated=True),
        landmarks=replace(flight.landmarks, sigma_m=sigma_m),
        path=replace(flight.path, fixes=fixes_beside(), bias_sigma_m=BIAS_M),
        options=replace(
            flight.options, solve_position=False, parameter_sigma={"focal": 50.0, "clock": 1.0}
        ),
    )


def exact() -> Flight:
    """The same, but all places count as exact."""
    flight = perfect()
    return replace(
        flight,
        landmarks=replace(flight.landmarks, sigma_m=np.zeros((LANDMARKS, 3))),
        path=replace(flight.path, fixes=None, bias_sigma_m=np.zeros(3)),
    )


def moved(flight: Flight, frames_m: Floats | float, marks_m: Floats | float) -> Flight:
    """State all positions and landmarks elsewhere, east, north, up."""
    path, marks = flight.path, flight.landmarks
    frames_m, marks_m = (
        np.broadcast_to(m, (n, 3)) for m, n in ((frames_m, FRAMES), (marks_m, len(marks.name)))
    )
    position_m = path.position_m + turned_out(axes(path.position_m), frames_m)
    mark_m = marks.position_m + turned_out(axes(marks.position_m), marks_m)
    return replace(
        flight,
        path=replace(path, position_m=position_m),
        landmarks=replace(marks, position_m=mark_m),
    )


def causes() -> Iterator[tuple[str, Floats, Floats]]:
    """Each error of one standard deviation: its component, and what it moves of the places."""
    nothing, no_marks = np.zeros((FRAMES, 3)), np.zeros((LANDMARKS, 3))
    fixes = fixes_beside()
    for axis in range(3):
        unit = np.eye(3)[axis]
        for mark in range(LANDMARKS):
            own = no_marks.copy()
            own[mark] = MARK_M * unit
            yield "landmark", nothing, own
        for fix in range(len(fixes.sigma_m)):
            each = np.zeros((len(fixes.sigma_m), 3, 1))
            each[fix, :, 0] = fixes.sigma_m[fix] * unit
            yield "position", fixes.at_frames(each)[..., 0], no_marks
        yield "position", nothing + BIAS_M * unit, no_marks


def by_component(value: Callable[[Flight], Floats]) -> dict[str, Floats]:
    """Add up the squares of what each error changes, by differences of two solves."""
    found: dict[str, Floats] = {}
    for name, frames_m, marks_m in causes():
        plus, minus = (
            value(moved(exact(), side * STEP * frames_m, side * STEP * marks_m))
            for side in (1.0, -1.0)
        )
        found[name] = found.get(name, 0.0) + ((plus - minus) / (2.0 * STEP)) ** 2
    return {name: np.sqrt(one) for name, one in found.items()}


def test_means_have_the_errors_of_places_that_are_held() -> None:
    """They had those of the picks alone: of this flight, a hundredth of the whole."""

    def mean_deg(flight: Flight) -> Floats:
        mean = solve_flight_read(flight).history().mean()
        return np.concatenate([mean.camera_deg, mean.vehicle_deg])

    stated = solve_flight_read(perfect()).history().mean().components
    for name, expected in by_component(mean_deg).items():
        assert_close("errors of held places", stated[name] / expected, np.ones(6))


@cache
def solved() -> Adjustment:
    return adjust(perfect(), FREE)


def after(flight: Flight) -> Floats:
    return np.array([one.after for one in adjust(flight, FREE).parameters])


def test_parameters_have_the_errors_of_places_that_are_held() -> None:
    by_picks = np.array([one.sigma_after for one in adjust(exact(), FREE).parameters])
    squares = sum(one**2 for one in by_component(after).values())
    found = np.array([one.sigma_after for one in solved().parameters])
    assert (found > 1.5 * by_picks).all()
    assert_close("errors of held places", found / np.sqrt(by_picks**2 + squares), np.ones(2))


def test_frames_have_the_errors_of_places_through_parameters() -> None:
    """An error of a landmark turns a frame by itself, and by the focal length that it moves."""
    one = solved().result.history()

    def values(flight: Flight) -> Floats:
        result = adjust(flight, FREE).result
        away_m = result.estimates.solved.camera_m - perfect().path.position_m
        place_m = np.einsum("fij,fj->fi", axes(perfect().path.position_m), away_m)
        return np.concatenate([result.camera_deg, place_m], axis=1)

    expected = by_component(values)
    for name, sigma in expected.items():
        found = one.uncertainty.components[name][:, :3]
        assert_close("errors of held places", found / sigma[:, :3], np.ones((FRAMES, 3)))
    ((_, estimate),) = one.estimates()
    clock_m = np.sqrt(sum(own[:, 3:] ** 2 for own in expected.values()))
    assert estimate.position_sigma is not None
    # the picks' part in the clock is beside it
    assert (estimate.position_sigma > clock_m * (1.0 - 1e-3)).all()
    assert (estimate.position_sigma < 1.05 * clock_m).all()


def test_errors_of_held_places_are_propagated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of all landmarks, and of the place of all frames: for angles and positions together."""
    flight, calls, own = perfect(), [], held_places.propagated

    def counted(solution: JointSolution, change: Floats) -> tuple[Floats, Floats, Floats]:
        calls.append(solution)
        return own(solution, change)

    monkeypatch.setattr(held_places, "propagated", counted)
    one = adjust(flight, FREE).result.history()
    assert np.isfinite(one.uncertainty.components["landmark"]).all()
    ((_, estimate),) = one.estimates()
    assert estimate.position_sigma is not None
    assert (len(calls), len(set(map(id, calls)))) == (2, 1)


def drawn(seed: int) -> Flight:
    """A flight whose places are wrong by what it states, and held."""
    rng = np.random.default_rng(seed)
    priors = Priors(fixes_beside(), np.full((6, 3), MARK_M))
    flight = flight_of(rng, drone(rng, FRAMES, 6), 0.5, priors)
    options = replace(flight.options, solve_position=False)
    return replace(flight, picks=replace(flight.picks, stated=True), options=options)


@pytest.mark.parametrize("seed", range(3))
def test_held_places_that_are_wrong_by_what_is_stated_are_no_misfit(seed: int) -> None:
    """Each of these flights was called doubtful, as if its places were exact."""
    flight = drawn(seed)
    result = solve_flight_read(flight)
    assert not result.misfits
    assert not result.findings
    marks_m = np.zeros((6, 3))
    marks_m[0, 0] = 60.0 * MARK_M
    assert solve_flight_read(moved(flight, 0.0, marks_m)).findings


@pytest.mark.parametrize("seed", [4, 7])
def test_free_parameters_beside_held_places_make_no_misfit(seed: int) -> None:
    """The focal length follows the error of the place: what it leaves passed for the picks'."""
    rng = np.random.default_rng(seed)
    priors = Priors(parameter={"east": 1.5, "north": 1.5, "up": 3.0})
    flight = flight_of(rng, drone(rng, 12, 6, spacing_m=0.0), 0.7, priors)
    picks = replace(flight.picks, stated=True)
    options = replace(flight.options, solve_position=False, free=("focal",))
    flight = replace(flight, picks=picks, options=options)
    result = solve_flight_read(flight)
    assert not result.misfits
    assert not result.findings
    assert result.estimates.reading is not None
    assert result.estimates.reading.source == "stated"
    pixel = picks.pixel.copy()
    pixel[20] += 25.0
    pick, _ = solve_flight_read(replace(flight, picks=replace(picks, pixel=pixel))).findings
    assert pick.message.startswith("frame 3: P2 does not fit the others")
