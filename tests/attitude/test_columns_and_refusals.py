"""What is refused, which columns a table of several jobs has, and how its rows are taken."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.estimates import ABOUT, PIXELS, WORDS, estimate
from vopd.attitude import table as table_values
from vopd.attitude.history import history
from vopd.attitude.long_history import one_part
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import ROWS_AT_ONCE, column_name, columns_of, row_blocks, table_blocks
from vopd.attitude.vertical import with_vertical
from vopd.estimate import Estimate
from vopd.findings import VopdError

NONE = float("nan")


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
        assert_approved(str(raised.value), parts=[NAMES[name], text])
    assert getattr(Sigmas(**{name: 0.0}), name) == 0.0
    assert getattr(Sigmas(), name) == (None if name in ("reading", "fiducial") else 0.0)


def one_of(**changes: Any) -> Estimate:
    return estimate([[140.0, -60.0, 20.0]], **changes)


def test_sources_of_different_kinds_are_not_one_table() -> None:
    """Neither of other units nor of other kinds; other words for the same units may differ."""
    usual = history(one_of())
    deck = ABOUT._replace(source="b.dat", words=replace(WORDS, source="deck"))
    feet = one_of(about=ABOUT._replace(source="b.dat"), units=PIXELS._replace(length="ft"))
    for other in (one_of(about=deck), feet):
        with refused(VopdError):
            columns_of([usual, usual, history(other)])
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
    with refused(VopdError):
        with_vertical(e, "plumb")
    assert with_vertical(e, None) is with_vertical(e, "geodetic") is e
    other = with_vertical(e, "geocentric")
    assert_approved(other.about.down)
    assert other.position.vertical == "geocentric"
    back = with_vertical(other, "geodetic")
    assert_approved(back.about.down)
