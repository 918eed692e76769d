"""The columns of the attitude table: names, units, rows, and what is stated without a value."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import estimate
from tests.kit.histories import histories
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import FIXED, columns_of, table
from vopd.attitude.uncertainty import ANGLES
from vopd.cards.read import read_deck
from vopd.findings import VopdError
from vopd.pipeline import run

DECKS = Path(__file__).parents[2] / "decks"


def test_units_are_part_of_the_names() -> None:
    endings = {"deg": "_deg", "s": "_s", "ft": "_ft", "ft/s": "_ft_s", "mm": "_mm", "rad": "_rad"}
    for column in columns_of(histories("appendix_h/case1"))[: len(FIXED)]:
        assert column.unit == "" or column.name.endswith(endings[column.unit]), column
        assert column.meaning


def test_a_row_a_frame_of_all_jobs() -> None:
    made = run(read_deck(DECKS / "appendix_h" / "cases_1_2_3.dat")).histories()
    values = table(made)
    assert {len(column) for column in values.values()} == {3}
    assert list(values) == [column.name for column in columns_of(made)]
    yaw = [h.estimate.vehicle_deg[0, 0] for h in made]
    assert values["vehicle_yaw_deg"].tolist() == yaw
    assert values["job"].tolist() == [1, 2, 3] and values["landmarks"].tolist() == [3, 2, 2]


def test_how_frames_ended() -> None:
    words = {}
    for name in ("ignored", "zero_residuals", "vanished", "wind_out_of_order"):
        solved = run(read_deck(DECKS / "regression" / f"{name}.dat"))
        words[name] = {word for h in solved.histories() for word in h.status}
    assert words["ignored"] == {"ignored", "solved"}
    assert "exact" in words["zero_residuals"] and "exact" in words["vanished"]
    assert words["wind_out_of_order"] == {"stopped"}


def test_components_stand_apart_and_only_those_asked_for() -> None:
    jobs = read_deck(DECKS / "appendix_h" / "case1.dat")
    plain = table(run(jobs).histories())
    more = table(run(jobs).histories(Sigmas(focal_length=0.01)))
    added = {f"sigma_focal_{angle}_deg" for angle in ANGLES}
    assert set(more) - set(plain) == added
    assert {f"sigma_centre_{angle}_deg" for angle in ANGLES} <= set(plain)


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("name", [field.name for field in fields(Sigmas)])
def test_what_is_no_standard_deviation(name: str, value: float) -> None:
    with refused(VopdError):
        Sigmas(**{name: value})


def test_the_root_mean_square_of_residuals_is_over_both_coordinates() -> None:
    """Of 1, 2, 3, 4 in x and none in y: the root of 30 / 8, and without the last of 14 / 6."""
    residual = np.tile([1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0], (2, 1))
    used = np.array([[True] * 4, [True] * 3 + [False]])
    made = history(estimate([[10.0, -60.0, 20.0]] * 2, residual=residual, used=used))
    assert_close("table value", table([made])["residual_rms_px"], np.sqrt([30 / 8, 14 / 6]))
