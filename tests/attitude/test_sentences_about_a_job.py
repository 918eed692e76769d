"""What is said of a whole job: how far its positions are off, what misfits, what is refused."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, PIXELS, WORDS, estimate
from vopd.attitude import table_values
from vopd.attitude.history import history
from vopd.attitude.history_parts import one_part
from vopd.attitude.history_summary import HistorySummary
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.misfit_findings import findings_of
from vopd.attitude.own_position import farthest_from_own_text, report_own_position
from vopd.attitude.table_columns import column_name, columns_of
from vopd.attitude.table_values import ROWS_AT_ONCE, row_blocks, table_blocks
from vopd.attitude.vertical import with_vertical
from vopd.estimate import Estimate
from vopd.findings import Finding, VopdError

NONE = float("nan")


def off(*east_north: tuple[float, float], source: str = "a.dat", job: int = 1) -> Any:
    """A job whose own coordinates put the vehicle so many metres east and north of the file's."""
    about = ABOUT._replace(
        source=source, job=job, words=replace(WORDS, own_position=f"where {source} has it")
    )
    to_own = np.array(east_north).reshape(-1, 2) if east_north != ((),) else None
    position = SimpleNamespace(to_own_m=to_own)
    return SimpleNamespace(about=about, estimate=SimpleNamespace(position=position))


@pytest.mark.parametrize(
    ("east_north", "said"),
    [
        ((0.0, 5.0), "5 m south"), ((0.0, -5.0), "5 m north"), ((5.0, 0.0), "5 m west"),
        ((-5.0, 0.0), "5 m east"), ((3.0, 40.0), "40 m south and 3 m west"),
        ((-3.0, -40.0), "40 m north and 3 m east"), ((0.49, 7.0), "7 m south"),
        ((0.51, 7.0), "7 m south and 1 m west"), ((7.0, 0.49), "7 m west"),
        ((7.0, -0.5), "7 m west"), ((0.0, 1.0), "1 m south"), ((0.0, 0.999), ""),
        ((0.6, 0.8), "1 m south and 1 m west"), ((0.6, 0.79), ""), ((NONE, 9.0), ""),
        ((0.0, 12345.6), "12346 m south"), ((0.0, np.inf), ""),
    ],
)  # fmt: skip
def test_how_far_the_farthest_position_is_off(east_north: tuple[float, float], said: str) -> None:
    """The file's position is on the other side; less than a metre, or half of one, is not said."""
    expected = f"; the vehicle is up to {said} of where a.dat has it" if said else ""
    assert farthest_from_own_text([off(east_north)]) == expected
    near = off((0.3, 0.3), (NONE, NONE))
    for several in ([near, off(east_north)], [off((0.1, 0.1), east_north, (0.2, 0.0))]):
        assert farthest_from_own_text(several) == expected
    assert farthest_from_own_text([off(()), off(east_north)]) == expected


def test_no_frame_and_no_own_coordinates() -> None:
    assert farthest_from_own_text([off(())]) == ""
    empty = off((0.0, 0.0))
    empty.estimate.position.to_own_m = np.zeros((0, 2))
    assert farthest_from_own_text([empty]) == ""


def test_a_warning_for_every_job_that_is_off() -> None:
    told: list[Finding] = []
    jobs = [off((0.0, 5.0)), off((0.0, 0.1), job=2), off((7.0, 0.0), source="b.dat", job=3)]
    report_own_position(jobs, told.append)
    text = "in this file the vehicle is up to {} of where {} has it"
    assert told == [
        Finding(text.format("5 m south", "a.dat"), "a.dat", job=1, severity="warning"),
        Finding(text.format("7 m west", "b.dat"), "b.dat", job=3, severity="warning"),
    ]


def misfits(*told: str) -> list[Finding]:
    labels = [(str(10 * k), text) for k, text in enumerate(told, 1)]
    return findings_of(ABOUT._replace(job=4), HistorySummary(misfits=labels))


MISFIT = "misfit, the residuals have a chance below 0.001; what explains them: "


@pytest.mark.parametrize(
    ("told", "messages"),
    [
        (["a (chance 0.50)"], ["frame 10: " + MISFIT + "a (chance 0.50)"]),
        ([""], ["frame 10: " + MISFIT + "not searched"]),
        (["a (chance 0.50)", "b (chance 0.40)", "a (chance 0.07)"],
         ["frames 10, 30: " + MISFIT + "a (chance 0.07 or more)",
          "frame 20: " + MISFIT + "b (chance 0.40)"]),
        (["c", "b", "a"], [f"frame {10 * k}: {MISFIT}{one}" for k, one in enumerate("cba", 1)]),
        (["a", "b", "c", "d"], [*(f"frame {10 * k}: {MISFIT}{one}" for k, one in
                                  enumerate("abc", 1)),
                                "1 more frames misfit; the flags say what explains them"]),
        (["a", "b", "c", "d", "e", "d"],
         ["frames 40, 60: " + MISFIT + "d", "frame 10: " + MISFIT + "a",
          "frame 20: " + MISFIT + "b",
          "2 more frames misfit; the flags say what explains them"]),
        ([], []),
    ],
)  # fmt: skip
def test_warnings_about_frames_that_misfit(told: list[str], messages: list[str]) -> None:
    """Three repairs at most, those of the most frames first, in the order of the frames; each
    with the least of its chances.
    """
    assert misfits(*told) == [
        Finding(one, "hand.toml", job=4, severity="warning") for one in messages
    ]


# What is refused

NAMES = {
    "reading": "reading", "fiducial": "fiducial", "landmark": "landmark", "position": "position",
    "focal_length": "focal length", "time_s": "time", "velocity": "velocity", "wind": "wind",
    "mount_deg": "mount",
}  # fmt: skip


@pytest.mark.parametrize("name", [*NAMES])
def test_what_is_no_standard_deviation_is_named(name: str) -> None:
    for value, text in ((-0.5, "-0.5"), (np.inf, "inf"), (NONE, "nan"), (-1e-300, "-1e-300")):
        with pytest.raises(VopdError) as raised:
            Sigmas(**{name: value})
        assert str(raised.value) == (
            f"{NAMES[name]} sigma: {text} is not a standard deviation: 0 or more"
        )
    assert getattr(Sigmas(**{name: 0.0}), name) == 0.0
    assert getattr(Sigmas(), name) == (None if name in ("reading", "fiducial") else 0.0)


def one_of(**changes: Any) -> Estimate:
    return estimate([[140.0, -60.0, 20.0]], **changes)


def test_sources_of_different_kinds_are_not_one_table() -> None:
    """Neither of other units nor of other kinds; other words for the same units may differ."""
    usual = history(one_of())
    deck = ABOUT._replace(source="b.dat", words=replace(WORDS, source="deck"))
    apart = "hand.toml and b.dat have different kinds or units: write a table for each"
    feet = one_of(about=ABOUT._replace(source="b.dat"), units=PIXELS._replace(length="ft"))
    for other in (one_of(about=deck), feet):
        with pytest.raises(VopdError) as raised:
            columns_of([usual, usual, history(other)])
        assert str(raised.value) == apart
    words = ABOUT._replace(source="c", words=replace(WORDS, reading="a point"))
    assert columns_of([usual, history(one_of(about=words))])


def test_columns_that_any_job_has_and_words_of_the_source() -> None:
    usual = history(one_of(frame_names=()), sigmas=Sigmas(reading=1.0))
    bare = {one.name for one in columns_of([usual])}
    cases = {
        "image": one_of(), "gimbal_yaw_deg": one_of(frame_names=(), gimbal_deg=np.zeros((1, 3))),
        "slip_effect_eta_deg": one_of(frame_names=(), slip_effect_deg=np.zeros((1, 9))),
    }  # fmt: skip
    for name, other in cases.items():
        assert name not in bare
        for several in ([usual, history(other)], [history(other), usual]):
            assert name in {one.name for one in columns_of(several)}
    words = replace(WORDS, columns={"time_s": "of day", "altitude_m": "above the sea"})
    named = columns_of([history(one_of(about=ABOUT._replace(words=words)))])
    meanings = {one.name: one.meaning for one in named}
    assert meanings["time_s"] == "of day" and meanings["altitude_m"] == "above the sea"
    assert meanings["frame"] == "frame number"
    columns = columns_of([usual])
    assert columns_of([usual]) == columns  # nothing was added to what is kept
    assert column_name("{source}_{length}_{image}", usual.estimate) == "flight_m_px"


@pytest.mark.parametrize("rows", [0, 1, 999, 1000, 1001, 2500])
def test_rows_a_thousand_at_a_time(rows: int) -> None:
    assert ROWS_AT_ONCE == 1000
    found = [*row_blocks({"a": np.arange(rows), "b": -np.arange(rows)})]
    assert [len(one["a"]) for one in found] == [1000] * (rows // 1000) + [rows % 1000] * (
        rows % 1000 > 0
    )
    assert [k for one in found for k in one["a"].tolist()] == list(range(rows))
    assert all(np.array_equal(one["b"], -one["a"]) for one in found)


def test_blocks_of_rows_of_jobs_of_which_one_lacks_what_another_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Component by component and errata: NaN, and as many rows as the job has frames."""
    plain = history(one_of(), sigmas=Sigmas(reading=1.0))
    more = history(one_of(slip_effect_deg=np.ones((1, 9))), sigmas=Sigmas(reading=1.0, wind=2.0))
    columns = columns_of([plain, more])
    lacking, having = table_blocks([one_part(plain), one_part(more)], columns)
    for name in ("sigma_wind_alpha_deg", "sigma_wind_camera_yaw_deg", "slip_effect_eta_deg"):
        assert np.isnan(lacking[name]).tolist() == [True]
        assert np.isfinite(having[name]).tolist() == [True]
    assert [*lacking] == [*having] == [one.name for one in columns]
    monkeypatch.setattr(table_values, "ROWS_AT_ONCE", 2)
    long = history(estimate(np.tile([140.0, -60.0, 20.0], (3, 1))), sigmas=Sigmas(reading=1.0))
    blocks = [*table_blocks([one_part(long)], columns_of([long]))]
    assert [one["frame"].tolist() for one in blocks] == [[1, 2], [3]]


def test_a_vertical_that_is_none() -> None:
    e = one_of()
    with pytest.raises(VopdError) as raised:
        with_vertical(e, "plumb")
    assert str(raised.value) == "no vertical is called 'plumb'; there are: geodetic, geocentric"
    assert with_vertical(e, None) is with_vertical(e, "geodetic") is e
    other = with_vertical(e, "geocentric")
    assert other.about.down == (
        "toward the Earth's centre; the solve had down along the ellipsoid's normal"
    )
    assert other.position.vertical == "geocentric"
    back = with_vertical(other, "geodetic")
    assert back.about.down.startswith("along the ellipsoid's normal; the solve had down toward")
