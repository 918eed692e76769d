"""What leaving out names of a flight, and what it predicts; many flights are in tools.coverage."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit.flight_blunders import BLUNDER_ROWS, BlunderRow, blunders_named
from tests.kit.simulated_flights import Errors, LensErrors, Plan, write_flight
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.adjust import tested
from vopd.flight.adjust.tested import Named, Prediction, predicted
from vopd.flight.misfits.leave_out import FIX, LANDMARK, PICK, TIME, LeftOut, leave_out
from vopd.flight.project.read import read_flight
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.joint import solve_jointly

SEED = 11


@pytest.mark.parametrize("row", BLUNDER_ROWS, ids=lambda row: str(row.name))
def test_a_blunder_of_five_times_the_noticeable_size_is_named(row: BlunderRow) -> None:
    found = blunders_named(row, SEED, 2)
    assert found.named == bool(row.blunder) and found.other == 0.0


def test_picks_are_predicted_as_by_solving_without_them(tmp_path: Path) -> None:
    """Of a real solve: an update leaves out the second order of its step.

    A frame of six picks of 1 px turns by .1 degree at most, .002, of which the square moves an
    image by 1500 times 4E-6 px.
    """
    plan = BlunderRow("", 2.0).plan._replace(frames=4)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    estimates = vopd.solve_flight(tmp_path / "flight.toml").estimates
    joint = estimates.joint
    assert joint is not None and estimates.reading is not None
    tests = leave_out(joint, estimates.reading)
    model = joint.model
    for k in np.flatnonzero(tests.kind == PICK):
        used = np.arange(len(model.flight.picks.frame)) != tests.pick[k]
        one = solve_jointly(model.flight, model.priors, used, joint.state)
        for rows in model.rows(one.state):
            here = model.pick[rows.picks] == tests.pick[k]
            if here.any():
                off_px = rows.residual[here][0] * model.flight.picks.sigma_px[tests.pick[k]]
                assert_close("updated prediction", tests.off_px[k], off_px)
        gain = joint.normal.cost - one.normal.cost
        assert_close("updated gain", tests.gain[k], gain)


def test_landmarks_without_picks_are_not_left_out(tmp_path: Path) -> None:
    plan = BlunderRow("", 2.0).plan._replace(frames=4)
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    before = tested.tested_flight(vopd.solve_flight(tmp_path / "flight.toml")).tests
    marks = tmp_path / "landmarks.csv"
    head, *rows = marks.read_text().splitlines()
    name = head.split(",").index("landmark")
    unseen = rows[0].split(",")
    unseen[name] = "unseen"
    marks.write_text("\n".join([head, ",".join(unseen), *rows]) + "\n")
    after = tested.tested_flight(vopd.solve_flight(tmp_path / "flight.toml")).tests
    of_before, of_after = (np.sort(one.landmark[one.kind == LANDMARK]) for one in (before, after))
    assert len(of_before) > 2 and of_after.tolist() == (of_before + 1).tolist()


@pytest.mark.parametrize(
    ("sigma_m_s", "kind"), [((0.01, 5.0, 0.01), TIME), ((5.0, 0.01, 0.01), FIX)]
)
def test_a_fix_is_late_within_the_errors_of_its_velocity(
    sigma_m_s: tuple[float, float, float], kind: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 10 m/s to the north, 20 m north is 2 s late; 10 m east is two seconds of 5 m/s.

    Standard deviations of velocities are of north, east, down, and errors of fixes of east, north,
    up.
    """
    none, two = np.zeros(2, int) - 1, np.full((2, 3), np.nan)
    tests = LeftOut(
        np.array([FIX, TIME]), np.array([-1, 0]), none, np.array([0, -1]), none, none + 4,
        *(np.zeros(2) for _ in range(3)), two[:, :2], two.copy(), np.zeros(2), two, none, two,
    )  # fmt: skip
    path = SimpleNamespace(velocity_sigma_m_s=np.array([sigma_m_s]))
    model = SimpleNamespace(
        priors=SimpleNamespace(fixes=0), flight=SimpleNamespace(path=path),
        velocity_m_s=np.array([[0.0, 10.0, 0.0]]),
        fix_sigma_m=np.full((1, 3), 0.02 * tested.NO_PRIOR),
    )  # fmt: skip
    state = SimpleNamespace(fix_m=np.array([[10.0, 20.0, 0.0]]))
    joint: Any = SimpleNamespace(model=model, state=state, factored=None)
    monkeypatch.setattr(tested, "fix_covariances", lambda _: 1e-4 * np.eye(3)[None])
    found = tested._as_time(Named(tests), joint).tests
    assert found.kind[0] == kind
    if kind == TIME:
        assert_close("time", found.error[0, 0], 2.0)


def test_two_landmarks_of_one_frame_predict_no_pick(tmp_path: Path) -> None:
    """Where positions and landmarks are exact, too: nothing else could tell of a pick."""
    plan = Plan(Errors(), landmarks=2, frames=1, stands=True)
    write_flight(tmp_path, plan, np.random.default_rng(2))
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        tested.tested_flight(vopd.solve_flight(tmp_path / "flight.toml"))


def test_a_frame_whose_residuals_tell_no_reading_sigma_is_tested_by_the_stated_one(
    tmp_path: Path,
) -> None:
    """Of landmarks 3 m off six picks have 9 residuals, which the landmarks take up."""
    plan = Plan(Errors(landmark_m=(3.0,)), landmarks=6, frames=1, stands=True)
    write_flight(tmp_path, plan, np.random.default_rng(2))
    file = tmp_path / "flight.toml"
    with refused(VopdError, parts=[tmp_path.as_posix()]):
        tested.tested_flight(vopd.solve_flight(file))
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("[picks]\n", "[picks]\nsigma_px = 1.0\n"), encoding="utf-8")
    assert (tested.tested_flight(vopd.solve_flight(file)).tests.kind == LANDMARK).sum() == 6


def test_freeing_a_wrong_focal_length_helps_the_prediction(tmp_path: Path) -> None:
    plan = BlunderRow("", 0.02).plan
    plan = plan._replace(errors=plan.errors._replace(lens=LensErrors(focal_rel=0.02)))
    write_flight(tmp_path, plan, np.random.default_rng(SEED))
    flight = read_flight(str(tmp_path / "flight.toml"))
    free = replace(flight, options=replace(flight.options, free=("focal",)))
    stated, freed = (tested.tested_flight(solve_flight_read(one)) for one in (flight, free))
    found = predicted(stated, freed)
    assert found.helps and found.median_px[1] < found.median_px[0]
    assert found.frames == plan.frames


def test_the_chance_of_a_prediction_is_that_of_a_sign_test() -> None:
    """Of ten frames nine are better: 11 of 1024 on either side."""
    assert Prediction(60, (2.0, 1.0), (2.0, 1.0), 9, 10).chance == 22 / 1024
    assert Prediction(60, (1.0, 2.0), (1.0, 2.0), 1, 10).helps is False
    assert Prediction(60, (1.0, 2.0), (1.0, 2.0), 4, 10).helps is None
