"""The equations of picks: every derivative against differences, parts of fixes against loops."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.joint_flights import at_frames, drone, flight_of
from tests.kit.random_flights import lenses
from tests.kit.simulated_flights import Errors, Plan, write_flight
from tests.tolerances import assert_close
from vopd import adjust
from vopd.arrays import Floats
from vopd.flight.flight import Flight, Refraction, TrackFixes
from vopd.flight.solve import joint, normal
from vopd.flight.solve.equations import (
    LENS_COEFFICIENTS,
    Model,
    Priors,
    Readout,
    State,
    by_lens_parameters,
    with_parameters,
)
from vopd.flight.solve.joint import JointSolution, places_by_fixes
from vopd.flight.solve.lines_of_sight import apparent, sight_lines, vertical_by_position
from vopd.flight.solve.normal import Factored
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import Lens, project

# Lines of sight

AWAY = np.array(
    [[0.0, 300.0, -100.0], [20e3, -15e3, 4e3], [30.0, 1.0, 2.0], [5e3, 5e3, 0.5], [1.0, 0.0, 900.0]]
)
"""East, north, up from a camera 1200 m high."""


@pytest.mark.parametrize("decays", [True, False])
def test_apparent_directions_and_their_derivatives(decays: bool) -> None:
    """Directions by `sight_lines`, which knows no derivative."""
    camera = earth_centred_m(47.0, 8.0, 1200.0)
    own = local_axes(camera)
    landmark_m = camera + AWAY @ own
    heights = np.full(len(AWAY), 1200.0), geodetic(landmark_m).height_m
    bends = Refraction(0.13, decays)

    def direction(away: Floats, up: float = 0.0, k: float = 0.0) -> Floats:
        both = heights[0] + up, heights[1] + (away - AWAY)[:, 2] + up
        return apparent(away, *both, Refraction(0.13 + k, decays)).direction

    found = apparent(AWAY, *heights, bends)
    zero = np.zeros(len(AWAY), np.int64)
    lines = sight_lines(camera[None], landmark_m, zero, np.arange(len(AWAY)), bends)
    assert_close("flight direction", found.direction, lines.direction)
    distance = np.linalg.norm(AWAY, axis=1)
    for axis, step in enumerate(np.eye(3)):
        # over a thousandth of the distance; the landmark's height moves with it
        move = 1e-3 * distance[:, None] * step
        moved = (direction(AWAY + move) - direction(AWAY - move)) / 2e-3
        assert_close("direction by place", found.by_away[..., axis] * distance[:, None], moved)
    higher = (direction(AWAY, 8.0) - direction(AWAY, -8.0)) / 16.0
    assert_close("direction by height", found.by_height, higher)
    bent = (direction(AWAY, k=1.0) - direction(AWAY, k=-1.0)) / 2.0
    assert_close("direction by refraction", found.by_refraction, bent)


def test_a_line_straight_down_has_derivatives() -> None:
    straight = np.array([[0.0, 0.0, -100.0]])
    found = apparent(straight, np.array([100.0]), np.zeros(1), Refraction())
    assert_close("flight direction", found.direction[0], [0.0, 0.0, -1.0])
    assert_close("flight direction", 100.0 * found.by_away[0, 2], np.zeros(3))
    # refraction raises by 1E-5 of the level distance; beside that it is the turn of a rod
    assert_close("rod's turn", 100.0 * found.by_away[0, :2, :2], np.eye(2))


def test_the_vertical_turns_with_the_place() -> None:
    """By axes 100 m to either side."""
    place = np.array([[47.0, 8.0, 1200.0], [-33.0, 151.0, 0.0], [1.0, -70.0, 30e3]])
    position_m = earth_centred_m(*place.T)
    found, own = vertical_by_position(geodetic(position_m)), local_axes(position_m)
    for column in range(3):
        sides = [local_axes(position_m + side * own[:, column]) for side in (100.0, -100.0)]
        both = sides[0] @ own.swapaxes(1, 2), sides[1] @ own.swapaxes(1, 2)
        turned = [Rotation.from_matrix(one).as_rotvec() for one in both]
        # axes that turn by w see all that stands still turn by -w
        assert_close("vertical by place", found[..., column], -(turned[0] - turned[1]) / 200.0)


# Fixes

FIXES = {
    "own": TrackFixes(np.arange(4), np.ones((4, 1)), np.ones((4, 3))),
    "between two": TrackFixes(
        np.array([0, 0, 1, 2]),
        np.array([[1.0, 0.0], [0.25, 0.75], [0.5, 0.5], [0.0, 1.0]]),
        np.ones((4, 3)),
    ),
    "of four": TrackFixes(
        np.array([0, 1, 3, 3, 5]),
        np.array([[0.1, 0.4, 0.4, 0.1]] * 4 + [[1.0, 0.0, 0.0, 0.0]]),
        np.ones((7, 3)),
    ),
}


@pytest.mark.parametrize("name", FIXES)
def test_frames_have_their_parts_of_fixes(name: str) -> None:
    fixes = FIXES[name]
    error = np.random.default_rng(1).normal(size=(len(fixes.sigma_m), 3))
    expected = at_frames(fixes, error)
    assert_close("table value", fixes.at_frames(error[..., None])[..., 0], expected)
    # and by blocks, the last of which is filled up
    padded = np.zeros((fixes.blocks * fixes.together, 3))
    padded[: len(error)] = error
    for frame, (block, part) in enumerate(zip(fixes.block, fixes.by_block, strict=True)):
        rows = padded[block * fixes.together :][: len(part)]
        assert_close("table value", part @ rows, expected[frame])


def test_the_costs_of_fixes_are_shared_by_frames_that_have_a_part_in_them() -> None:
    rng = np.random.default_rng(2)
    scene = drone(rng, 4, 4)
    priors = Priors(replace(FIXES["between two"], sigma_m=np.full((4, 3), 2.0)))
    flight = flight_of(rng, scene, 1.0, priors)
    model = model_of(flight, priors)
    state = model.start(scene.rotation)._replace(
        fix_m=np.array([[2.0, 0, 0]] * 2 + [[4, 0, 0]] * 2)
    )
    # squares 1, 1, 4, 4 of fixes; the first has parts 1 and .25, the second .75 and .5, the
    # third .5 and 0, the last 1
    expected = [1 / 1.25, 0.25 / 1.25 + 0.75 / 1.25, 0.5 / 1.25 + 4.0, 4.0]
    assert_close("table value", model.prior_cost_of_frames(state), expected)
    assert_close("table value", model.prior_cost(state), 10.0)


def test_the_costs_of_the_shape_of_a_path_are_shared_though_its_parts_are_below_0() -> None:
    """A path that bends by c over 10 s moves its middle by -c 10^2 / 8: squares stay squares."""
    rng = np.random.default_rng(2)
    scene = drone(rng, 4, 4)
    weight = np.array([[1.0, -12.5], [0.5, -12.5], [0.25, -6.25], [0.0, 0.0]])
    fixes = TrackFixes(np.zeros(4, np.int64), weight, np.ones((2, 3)))
    model = model_of(flight_of(rng, scene, 1.0, Priors(fixes)), Priors(fixes))
    state = model.start(scene.rotation)._replace(fix_m=np.array([[7.0, 0, 0], [5.0, 0, 0]]))
    # 49 in parts of 1, .5 and .25, and 25 in parts of .4, .4 and .2
    expected = [49 / 1.75 + 10.0, 24.5 / 1.75 + 10.0, 12.25 / 1.75 + 5.0, 0.0]
    assert_close("table value", model.prior_cost_of_frames(state), expected)


WEAVES = Plan(
    Errors(landmark_m=(0.1,), fix_m=((0.5, 0.5, 1.0),), clock_s=0.1, clock_rate_ppm=1e4),
    frames=20, landmarks=5, fix_hz=1.0, weave_m=20.0, sigma_px=True,
)  # fmt: skip
"""A path that bends between its fixes: they have the shape of each gap among them."""


@pytest.fixture(scope="module")
def weaves(tmp_path_factory: pytest.TempPathFactory) -> JointSolution:
    """A flight with a free clock beside a track without velocities, solved."""
    folder = tmp_path_factory.mktemp("weaves")
    write_flight(folder, WEAVES, np.random.default_rng(1))
    found = adjust(folder / "flight.toml", ["clock", "clock-rate"]).result.estimates.joint
    assert found is not None
    return found


def test_errors_of_fixes_are_errors_of_the_velocity(weaves: JointSolution) -> None:
    """Places by each error of the track and by the clock, against differences."""
    model, state = weaves.model, weaves.state
    fixes = weaves.normal.fixes
    assert fixes is not None and fixes.between is not None and model.late_s(state).any()
    for fix in range(len(state.fix_m)):
        step = np.zeros_like(state.fix_m)
        step[fix] = 1.0
        moved = model.moved_m(state._replace(fix_m=state.fix_m + step)) - model.moved_m(state)
        assert_close("table value", moved, fixes.at_frames(step[..., None])[..., 0])
    ends = []
    for side in (1e-4, -1e-4):
        parameter = state.parameter + side * (np.array(model.names) == "clock")
        ends.append(model.moved_m(state._replace(parameter=parameter)))
    assert_close("velocity by differences", (ends[0] - ends[1]) / 2e-4, model.speed_m_s(state))


def test_blocks_of_many_fixes_are_formed_as_those_of_few(
    weaves: JointSolution, monkeypatch: pytest.MonkeyPatch
) -> None:
    fixes = weaves.normal.fixes
    assert fixes is not None and fixes.together > normal.NARROW
    wide = places_by_fixes(weaves.factored)
    for module in (normal, joint):
        monkeypatch.setattr(module, "NARROW", fixes.together)
    narrow = Factored(weaves.normal)
    assert_close("part of a sigma", narrow.common / weaves.factored.common, 1.0)
    scale_m2 = np.abs(wide).max()
    assert_close("part of a sigma", places_by_fixes(narrow) / scale_m2, wide / scale_m2)


# Priors and lenses


def test_priors_are_scaled_by_component() -> None:
    fixes, landmark_m, click_px = FIXES["own"], np.full((2, 3), 0.5), np.full(4, 0.5)
    parameter = {"east": 2.0, "focal": 3.0, "aspect": 0.1, "k1": 0.01}
    priors = Priors(fixes, landmark_m, parameter, click_px)
    place = priors.scaled("position", 10.0)
    assert place.fixes is not None and place.landmark_m is landmark_m
    assert np.array_equal(place.fixes.sigma_m, np.full((4, 3), 10.0))
    assert place.parameter == {"east": 20.0, "focal": 3.0, "aspect": 0.1, "k1": 0.01}
    lens = priors.scaled("focal", 10.0)
    assert lens.parameter == {"east": 2.0, "focal": 30.0, "aspect": 1.0, "k1": 0.01}
    marks = priors.scaled("landmark", 10.0)
    assert marks.landmark_m is not None and np.array_equal(marks.landmark_m, np.full((2, 3), 5.0))
    assert marks.parameter == priors.parameter and marks.fixes is fixes
    assert marks.click_px is click_px
    clicks = priors.scaled("click", 10.0)
    assert clicks.click_px is not None and np.array_equal(clicks.click_px, np.full(4, 5.0))
    assert clicks.parameter == priors.parameter and clicks.landmark_m is landmark_m


RAYS = np.array([[0.1, -0.2, 1.0], [-0.35, 0.2, 1.1], [0.0, 0.0, 1.0], [0.3, 0.3, 0.9]])


@pytest.mark.parametrize("kind", ["pinhole", "brown", "skew", "fisheye", "table"])
def test_images_by_parameters_of_every_lens(kind: str) -> None:
    """By differences of images of lenses that are built with other numbers."""
    lens = lenses()[kind]
    names = ("focal", "aspect", "centre_u", "centre_v", *LENS_COEFFICIENTS[lens.kind], "clock")
    values = np.array([2.0, 1e-3, 1.0, -2.0, *[1e-3] * (len(names) - 5), 7.0])
    now = with_parameters(lens, names, values)
    found = by_lens_parameters(lens, names, values, RAYS, project(now, RAYS))
    for column, name in enumerate(names):
        step = 1e-2 if name in ("focal", "centre_u", "centre_v") else 1e-6
        sides = []
        for side in (step, -step):
            moved = values.copy()
            moved[column] += side
            sides.append(project(built(lens, names, moved), RAYS).pixel)
        expected = (sides[0] - sides[1]) / (2.0 * step)
        scale = max(float(np.abs(expected).max()), 1.0)
        assert_close("image by a parameter", found[..., column] / scale, expected / scale)
    assert not found[..., -1].any()  # the clock is no part of a lens


def built(lens: Lens, names: tuple[str, ...], values: Floats) -> Lens:
    """The lens with other numbers."""
    by, k = dict(zip(names, values.tolist(), strict=True)), lens.k.copy()
    for index, name in enumerate(LENS_COEFFICIENTS[lens.kind]):
        k[index] += by[name]
    mean = lens.focal_px.mean()
    focal_px = lens.focal_px * ((mean + by["focal"]) / mean) * [1.0, 1.0 + by["aspect"]]
    centre_px = lens.centre_px + np.array([by["centre_u"], by["centre_v"]])
    return replace(lens, focal_px=focal_px, centre_px=centre_px, k=k)


# The picks of a flight


def model_of(flight: Flight, priors: Priors, readout: Readout | None = None) -> Model:
    """All picks of a flight."""
    picks = np.ones(len(flight.picks.frame), bool)
    frames = np.ones(len(flight.frame), bool)
    return Model(flight, priors, picks, frames, flight.picks.sigma_px, readout)


def rows_of(model: Model, state: State) -> dict[str, Floats]:
    """Residuals and derivatives of all picks, (P, 2) and (P, 2, ...)."""
    out: dict[str, Floats] = {}
    for rows in model.rows(state):
        for name in ("residual", "by_turn", "by_place", "by_parameter", "by_landmark"):
            part = getattr(rows, name)
            each = out.setdefault(name, np.zeros((len(model.pick), *part.shape[2:])))
            each[rows.picks] = part
    return out


@pytest.mark.parametrize("shutter", ["global", "rolling"])
@pytest.mark.parametrize("lens", ["brown", "fisheye"])
def test_the_rows_of_picks_are_derivatives(lens: str, shutter: str) -> None:
    """Of a drone with a lever arm, refraction and errors of all kinds, away from the stated."""
    rng = np.random.default_rng(3)
    scene = drone(rng, 6, 5, seen=0.9)
    names = ("east", "north", "up", "focal", "aspect", "centre_u", "centre_v", "k1", "k2")
    names += (*LENS_COEFFICIENTS[lenses()[lens].kind][2:4], "clock", "clock_rate", "refraction")
    names += ("readout",) if shutter == "rolling" else ()
    weight = rng.dirichlet([1.0, 1.0], 6)
    fixes = TrackFixes(np.array([0, 0, 1, 1, 2, 2]), weight, np.full((4, 3), 1.0))
    priors = Priors(fixes, np.full((5, 3), 0.1), dict.fromkeys(names, 1.0))
    flight = flight_of(rng, scene, 2.0, Priors(), velocity_m_s=(3.0, 4.0, 0.5))
    arm_m, mount = np.array([0.3, 0.2, -0.1]), Rotation.from_rotvec([0.1, -0.2, 0.3]).as_matrix()
    flight = replace(
        flight,
        lens=replace(lenses()[lens], focal_px=np.array([900.0, 890.0])),
        path=replace(flight.path, lever_arm_m=arm_m, acceleration_m_s2=rng.normal(size=(6, 3))),
        refraction=Refraction(),
        mount=mount,
    )
    readout = None
    if shutter == "rolling":
        part = rng.uniform(-0.5, 0.5, len(scene.frame))
        readout = Readout(0.01, part, rng.normal(0.0, 0.3, (6, 3)))
    model = model_of(flight, priors, readout)
    state = model.start(scene.rotation)._replace(
        fix_m=rng.normal(size=(4, 3)), landmark_m=rng.normal(0.0, 0.1, (5, 3))
    )
    rows = rows_of(model, state)

    for name, column, step, moved in steps(state, model.names):
        images = (-rows_of(model, moved(side))["residual"] for side in (step, -step))
        expected = np.subtract(*images) / (2.0 * step)
        scale = float(np.abs(expected).max())
        late = name == "by_parameter" and names[column] == "readout"
        quantity = "row by readout" if late else "row by an unknown"
        assert_close(quantity, rows[name][..., column] / scale, expected / scale)


STEP = {
    **dict.fromkeys(("east", "north", "up"), 1e-2),
    **{"focal": 0.1, "clock": 1e-3, "clock_rate": 1e-3, "refraction": 0.1, "readout": 1e-3},
}
"""Steps of differences; 1E-5 for coefficients and pixels of the centre."""


def steps(
    state: State, names: tuple[str, ...]
) -> Iterator[tuple[str, int, float, Callable[[float], State]]]:
    """Rows, their column, a step, and the state moved by so much of that unknown."""
    for axis, unit in enumerate(np.eye(3)):

        def turned(by: float, unit: Floats = unit) -> State:
            turn = Rotation.from_rotvec(by * unit).as_matrix()
            return state._replace(rotation=turn @ state.rotation)

        def placed(by: float, unit: Floats = unit) -> State:
            return state._replace(fix_m=state.fix_m + by * unit)

        def marked(by: float, unit: Floats = unit) -> State:
            return state._replace(landmark_m=state.landmark_m + by * unit)

        yield "by_turn", axis, 1e-5, turned
        yield "by_place", axis, 1e-2, placed
        yield "by_landmark", axis, 1e-2, marked
    for column, unit in enumerate(np.eye(len(names))):

        def changed(by: float, unit: Floats = unit) -> State:
            return state._replace(parameter=state.parameter + by * unit)

        yield "by_parameter", column, STEP.get(names[column], 1e-5), changed
