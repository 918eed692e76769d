"""Which estimates of a flight are kept, and what a result hands on and gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import three_frames, uneven_flight
from vopd.attitude import long_history as long_job
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.flight import result as flight_estimates
from vopd.flight.result import FlightEstimates, FlightResult
from vopd.flight.solve import solve


def test_estimates_of_few_picks_are_kept_and_of_many_made_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert flight_estimates.MOST_KEPT == 100_000
    estimates = FlightEstimates(solve(uneven_flight([4, 3, 5])))
    pairs = np.array([0, 2]), np.array([0, 1])
    first, other = (estimates.of(frames) for frames in pairs)
    assert estimates.of(pairs[0].copy()) is first and estimates.of(pairs[1]) is other
    assert first.frame.tolist() == [0, 2] and other.frame.tolist() == [0, 1]
    assert estimates.whole() is estimates.of(np.arange(3))
    for most, same in ((12, True), (11, False)):
        monkeypatch.setattr(flight_estimates, "MOST_KEPT", most)
        anew = FlightEstimates(estimates.solved)
        assert (anew.of(pairs[0]) is anew.of(pairs[0])) == same


def test_what_is_said_of_the_whole_flight_is_in_each_part(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Any] = []
    monkeypatch.setattr(flight_estimates, "whole_flight", lambda _: "whole")
    monkeypatch.setattr(flight_estimates, "flight_estimate", lambda *given: made.append(given[1]))
    FlightEstimates(solve(three_frames())).of(np.array([1]))
    assert made == ["whole"]


def test_a_history_is_asked_for_with_all_that_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[Any] = []

    def asked(layout: Any, estimate_of: Any, options: HistoryOptions) -> Any:
        given.append((estimate_of(np.array([1])).frame.tolist(), options))
        return type("Parts", (), {"whole": "the history"})

    monkeypatch.setattr(long_job, "history_of_long_job", asked)
    monkeypatch.setattr("vopd.export.tables.dataframe", lambda histories: histories)
    result = FlightResult(FlightEstimates(solve(three_frames())), ())
    sigmas = Sigmas(reading=0.7)
    assert result.history(sigmas, 5.0, "geocentric") == "the history"
    assert result.to_dataframe(sigmas, 5.0, "geocentric") == ["the history"]
    result.history_parts(HistoryOptions(sigmas, 5.0, "geocentric"))
    assert given == [([9], HistoryOptions(sigmas, 5.0, "geocentric"))] * 3
    given.clear()
    result.history()
    assert given == [([9], HistoryOptions())]


def test_what_a_result_gives_of_its_flight() -> None:
    flight = replace(three_frames(), about=("a lens", "a track"))
    result = FlightResult(FlightEstimates(solve(flight)), ())
    assert result.flight is flight and result.about == ("a lens", "a track")
    assert result.frame.tolist() == [7, 9, 12] and result.image_name == ("a.jpg", "b.jpg", "c.jpg")
    assert result.time_s is flight.time_s and result.solved.tolist() == [False, True, True]
    assert len(result.estimate.frame) == 3 and result.estimate is result.estimate
    assert repr(result) == "FlightResult(flight.toml, 3 frames)"
