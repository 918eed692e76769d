"""`vopd.run`: jobs and decks alike, their arrays, findings, and the table as a DataFrame."""

from __future__ import annotations

import ast
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit.jobs import reread
from vopd.attitude.sigmas import Sigmas
from vopd.errata import Fix, fixes
from vopd.findings import Finding, VopdError
from vopd.program.vopd import run as run_job
from vopd.results import SolvedJob
from vopd.solved import Run

DECKS = Path(__file__).parents[2] / "decks"
GOLDEN = Path(__file__).parents[2] / "golden_outputs" / "regression" / "appendix_h"
STACKED = DECKS / "appendix_h" / "cases_1_2_3.dat"  # of 3, 2 and 2 landmarks


def test_a_job_with_a_number_that_is_none_is_refused() -> None:
    """A card cannot hold one, but an array that is made can."""
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    clock = replace(job.clock, time_s=np.full_like(job.clock.time_s, np.nan))
    with refused(VopdError):
        vopd.run(replace(job, clock=clock))


def test_the_arrays_are_those_of_each_job() -> None:
    jobs = vopd.read_deck(STACKED)
    together = vopd.run(jobs)
    alone = [run_job(job) for job in jobs]
    assert len(together) == 3 and list(together) == alone
    for name in ("vehicle_deg", "alpha_deg", "frame", "centre_mm"):
        parts = [getattr(one, name) for one in alone]
        np.testing.assert_array_equal(getattr(together, name), np.concatenate(parts))
    with pytest.raises(AttributeError):
        together.yaw  # noqa: B018


def test_missing_places_are_filled() -> None:
    """A job of two landmarks beside one of three."""
    jobs = vopd.read_deck(STACKED)
    readings = jobs[1].readings
    fewer = replace(
        jobs[1],
        readings=reread(
            readings,
            landmark=readings.landmark[:, :2],
            present=readings.present[:, :2],
            landmark_in=readings.landmark_in[:, :2],
        ),
    )
    together = vopd.run([jobs[0], fewer])
    width = jobs[0].readings.landmark.shape[1]
    assert together.residual_mm.shape == (2, width, 2) and width > 2
    assert np.isnan(together.residual_mm[1, 2:]).all()
    assert not together.used[1, 2:].any() and (together.landmark[1, 2:] == 0).all()


def test_one_job_answers_like_several() -> None:
    job = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")[0]
    one = vopd.run(job)
    assert one[0] == run_job(job) == vopd.run([job])[0]
    assert one.to_dataframe().equals(vopd.run([job]).to_dataframe())
    assert one.vehicle_deg.tolist() == one[0].vehicle_deg.tolist()
    assert one.focal_length_mm.tolist() == [10.4] and one.converged.tolist() == [True]


def test_starts_of_all_frames() -> None:
    deck = vopd.read_deck(STACKED)
    start = np.array([[195.0, -38.0, 285.0], [194.0, -39.0, 284.0], [193.0, -37.0, 286.0]])
    assert vopd.run(deck, start_deg=start).start_deg.tolist() == start.tolist()
    with refused(vopd.VopdError):
        vopd.run(deck, start_deg=start[:2])


def test_fixes_and_the_deck_s_name_reach_every_job() -> None:
    run = vopd.run(vopd.read_deck(STACKED), fixes("earth"))
    assert all(Fix.EARTH in one.fixes for one in run)
    frame = run.to_dataframe()
    assert frame["deck"].tolist() == [str(STACKED)] * 3 and frame["job"].tolist() == [1, 2, 3]
    assert frame.attrs["fixes"] == "earth (WGS 84)"


def bad_start(*angles: float) -> vopd.Job:
    job = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")[0]
    return replace(job, camera=replace(job.camera, initial_deg=np.array(angles)))


def test_a_bad_start_is_a_finding_and_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    """From 18, 80, 285 degrees case 1 ends with its landmarks behind the camera."""
    run = vopd.run(bad_start(18.0, 80.0, 285.0))
    (finding,) = run.findings
    assert (finding.severity, finding.job, finding.group) == ("warning", 1, 8)
    assert "frame 730: landmarks lie behind the camera" in str(finding)
    assert capfd.readouterr() == ("", "")


def test_the_closed_form_needs_no_first_estimate() -> None:
    lost = bad_start(18.0, 80.0, 285.0)
    found = vopd.run(lost, initial="closed-form")
    assert [f"{angle:.3f}" for angle in found.camera_deg[0]] == ["195.270", "-38.653", "285.837"]
    assert found.findings == ()
    compared = vopd.run(lost, initial="closed-form", compare_initial=True)
    (finding,) = compared.findings
    assert "frame 730: the deck's first estimate leads to another attitude" in str(finding)
    np.testing.assert_array_equal(compared.camera_deg, found.camera_deg)


def test_warnings_about_cards_come_back_with_the_results(tmp_path: Path) -> None:
    cards = (DECKS / "appendix_h" / "case1.dat").read_text().splitlines()
    cards[31] = "   0 " + "    48.073"  # not right-justified: its last blank is a zero
    deck = tmp_path / "blanks.dat"
    deck.write_text("\n".join(cards) + "\n")
    read = vopd.read_deck(deck)
    assert [finding.card for finding in read.findings] == [32, 59]  # and a reading of .020 in
    assert vopd.run(read).findings[0] == read.findings[0]


def test_two_sightings_of_one_landmark_are_one_landmark() -> None:
    """Case 2 without landmark 65 shows 66 and 67; here both are 66."""
    job = vopd.read_deck(DECKS / "appendix_h" / "case2.dat")[0]
    alike = np.where(job.readings.landmark == 67, 66, job.readings.landmark)
    run = vopd.run(replace(job, readings=reread(job.readings, landmark=alike)))
    assert "frame 730: one landmark, read twice" in str(run.findings[0])
    table = run.to_dataframe()
    assert "undetermined" in table["flags"][0]
    assert np.isposinf(table["sigma_vehicle_yaw_deg"][0])


def test_an_undefined_landmark_is_an_error() -> None:
    job = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")[0]
    unknown = replace(job.landmarks, number=job.landmarks.number + 10)
    with refused(vopd.VopdError):
        vopd.run(replace(job, landmarks=unknown))


def test_the_dataframe_has_the_listing_s_numbers() -> None:
    """Case 4 as appendix H prints it: frame 55 ignored, 60 and 65."""
    frame = vopd.run(vopd.read_deck(DECKS / "appendix_h" / "case4.dat")).to_dataframe()
    assert frame["status"].tolist() == ["ignored", "solved", "solved"]
    printed = frame.loc[1, ["camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"]]
    assert [f"{angle:.3f}" for angle in printed] == ["225.133", "-86.339", "181.954"]
    assert frame.loc[0, ["vehicle_yaw_deg", "eta_deg", "quaternion_w"]].isna().all()


def test_options_of_the_table() -> None:
    run = vopd.run(vopd.read_deck(DECKS / "appendix_h" / "case4.dat"))
    plain = run.to_dataframe()
    more = run.to_dataframe(vopd.Sigmas(position=100.0), max_rate_deg_s=0.01)
    assert "sigma_position_eta_deg" in more and "sigma_position_eta_deg" not in plain
    assert (more["sigma_eta_deg"][1:] > plain["sigma_eta_deg"][1:]).all()
    assert more["flags"][1].endswith("jump") and "jump" not in plain["flags"][1]


def test_without_pandas_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    run = vopd.run(vopd.read_deck(STACKED))
    with refused(vopd.VopdError):
        run.to_dataframe()


def test_a_table_out_of_order_ends_the_run() -> None:
    jobs = vopd.read_deck(DECKS / "regression" / "wind_out_of_order.dat")
    run = vopd.run([*jobs, *jobs])
    assert len(run) == len(jobs) and run[-1].stop is not None
    assert "END OF CASE" not in vopd.listing_text(run)


def test_no_job() -> None:
    with refused(vopd.VopdError):
        vopd.run([]).to_dataframe()
    with refused(vopd.VopdError):
        vopd.run([]).vehicle_deg  # noqa: B018


def test_a_flight_is_no_deck_and_a_deck_is_no_flight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each says which function solves the other."""
    monkeypatch.chdir(DECKS / "appendix_h")
    for other in ("flight.toml", ".", "../../examples/hill"):
        with refused(vopd.VopdError):
            vopd.run(other)
    for no_flight in (vopd.read_deck(STACKED), "cases_1_2_3.dat"):
        with refused(vopd.VopdError):
            vopd.solve_flight(no_flight)  # type: ignore[arg-type]
    with refused(vopd.VopdError):
        vopd.run(5)  # type: ignore[arg-type]


def test_the_whole_listing() -> None:
    printed = vopd.listing_text(vopd.run(vopd.read_deck(STACKED)))
    assert printed == (GOLDEN / "cases_1_2_3.lst").read_text()


# Runs of several jobs by hand


def stub(count: int, findings: tuple[Finding, ...] = (), landmarks: int = 2) -> SolvedJob:
    results: Any = SimpleNamespace(
        frame=np.arange(count), time_s=np.arange(float(count)),
        landmark=np.arange(count * landmarks).reshape(count, landmarks) + 1,
        residual_mm=np.ones((count, landmarks, 2)), used=np.ones((count, landmarks), bool),
    )  # fmt: skip
    return SolvedJob("a", 1, results, findings)


def test_arrays_of_a_run_of_jobs_with_other_numbers_of_landmarks() -> None:
    first, second = Finding("1"), Finding("2")
    run = Run([stub(2, (first,)), stub(1, (second, first), 3)])
    assert run.findings == (first, second, first)
    assert len(run) == 2 and repr(run) == "Run(2 jobs, 3 frames)" and repr(Run([])) == (
        "Run(0 jobs, 0 frames)"
    )  # fmt: skip
    assert run[0] is run.jobs[0].results and run[0:2] == tuple(job.results for job in run.jobs)
    assert run.time_s.tolist() == [0.0, 1.0, 0.0]
    assert run.landmark.tolist() == [[1, 2, 0], [3, 4, 0], [1, 2, 3]]
    assert run.used.tolist() == [[True, True, False]] * 2 + [[True] * 3]
    assert np.isnan(run.residual_mm[:2, 2]).all() and np.isfinite(run.residual_mm[2]).all()
    for name in ("focal_length_mm", "solved", "converged", *("frame", "eta_deg", "at_centre")):
        assert name in dir(run)
    with pytest.raises(AttributeError) as raised:
        run.yaw  # noqa: B018
    assert "has no attribute 'yaw'" in str(raised.value)
    with refused(VopdError):
        Run([]).time_s  # noqa: B018


def test_options_of_a_run_reach_its_table(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[Any, ...]] = []

    class Told(Run):
        def histories(self, *given: Any) -> list[Any]:
            told.append(given)
            return []

    monkeypatch.setattr("vopd.export.tables.dataframe", lambda _: None)
    Told([]).to_dataframe(Sigmas(0.5), 2.0, "geodetic")
    Told([]).to_dataframe()
    assert told == [(Sigmas(0.5), 2.0, "geodetic"), (None, None, None)]


def test_what_the_package_offers() -> None:
    names = [
        "Adjustment", "Deck", "DeckError", "Finding", "FlightResult", "InputError", "Job",
        "Results", "Run", "Sigmas", "VopdError", "__version__", "adjust", "listing_text",
        "read_deck", "run", "solve_flight", "write_deck",
    ]  # fmt: skip
    assert vopd.__all__ == dir(vopd) == names
    for name in names:
        found = getattr(vopd, name)
        assert name in ("__version__", "DeckError") or found.__name__ == name
    assert vopd.DeckError is vopd.InputError
    with pytest.raises(AttributeError, match=r"^module 'vopd' has no attribute 'solve'$"):
        getattr(vopd, "solve")  # noqa: B009


def test_a_type_checker_sees_no_other_names() -> None:
    """A module with a function `__getattr__` has every name, to one that reads its text."""
    tree = ast.parse(Path(vopd.__file__).read_text(encoding="utf-8"))
    seen = {one.name for one in tree.body if isinstance(one, ast.FunctionDef)}
    assert "__getattr__" not in seen and "__getattr__" in vars(vopd)
