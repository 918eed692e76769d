"""The attitude table: columns, values, refusals."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.estimates import ABOUT, PIXELS, WORDS, estimate
from tests.kit.histories import histories
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude import table as table_values
from vopd.attitude.geometry import LandmarkGeometry
from vopd.attitude.history import History, history
from vopd.attitude.long_history import one_part
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import (
    FIXED,
    ROWS_AT_ONCE,
    chosen_columns,
    column_name,
    columns_of,
    matrices,
    row_blocks,
    table,
    table_blocks,
)
from vopd.attitude.uncertainty import ANGLES
from vopd.attitude.vertical import with_vertical
from vopd.estimate import Estimate, FrameStatus
from vopd.findings import VopdError
from vopd.pipeline import read_deck, run

FRAME_ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))
NAMES = (
    "camera_yaw", "camera_pitch", "camera_roll", "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
DECIMALS_6 = (
    "gimbal", "sigma_", "half_width", "eta_low", "eta_high", "slip_effect", "covariance_factor",
)  # fmt: skip


def numbers(start: float, *shape: int) -> Floats:
    return start + np.arange(float(np.prod(shape))).reshape(shape)


def covariance(start: float) -> Floats:
    """Symmetric: start + 3 i + j where i is the smaller index, and 9 more in the second frame."""
    upper = np.triu(numbers(start, 2, 3, 3))
    return np.asarray(upper + np.triu(upper, 1).swapaxes(1, 2))


def made() -> History:
    """Two frames in which every value of the table is another number."""
    one = history(
        estimate(FRAME_ANGLES, about=ABOUT._replace(job=3), reading_spread=0.5),
        sigmas=Sigmas(reading=0.5, position=2.0),
    )
    e = one.estimate
    place = replace(
        e.position,
        latitude_deg=numbers(100, 2), longitude_deg=numbers(110, 2), altitude=numbers(120, 2),
        geocentric_latitude_deg=numbers(130, 2),
    )  # fmt: skip
    doubt = one.uncertainty
    return replace(
        one,
        estimate=replace(
            e, frame=np.array([41, 52]), status=np.array([FrameStatus.SOLVED, FrameStatus.EXACT]),
            time_s=numbers(200, 2), camera_deg=numbers(210, 2, 3), vehicle_deg=numbers(220, 2, 3),
            attack_deg=numbers(230, 2, 3), airspeed=numbers(240, 2), position=place,
            displacement=numbers(250, 2, 3), gimbal_deg=numbers(260, 2, 3),
            slip_effect_deg=numbers(270, 2, 9), correction_rad=-numbers(290, 2, 3),
        ),
        quaternion=numbers(300, 2, 4),
        residual_rms=numbers(310, 2),
        geometry=LandmarkGeometry(numbers(320, 2), np.array([0, 1]), numbers(325, 2, 4)),
        uncertainty=replace(
            doubt, total=numbers(400, 2, 9), half_width_95=numbers(420, 2, 9),
            freedom=numbers(440, 2, 9), eta_interval_95_deg=numbers(460, 2, 2),
            components={"reading": numbers(470, 2, 9), "position": numbers(490, 2, 9)},
            covariance_deg2=covariance(510), covariance_common_deg2=covariance(530),
            covariance_factor_95=numbers(560, 2),
            reading=replace(doubt.reading,
                sigma=550.0, freedom=551.0, chance=numbers(552, 2), test_sigma=554.0
            ),
        ),
    )  # fmt: skip


def test_name_unit_and_meaning_of_every_column_in_their_order() -> None:
    columns = columns_of([made()])
    assert_approved([(one.name, one.unit, one.meaning) for one in columns])
    for one in columns[34:]:
        assert one.decimals == (6 if one.name.startswith(DECIMALS_6) else None), one.name


def test_the_value_of_every_column() -> None:
    found = {name: column.tolist() for name, column in table([made()]).items()}
    assert list(found) == [one.name for one in columns_of([made()])]
    assert found.pop("flight") == ["hand.toml"] * 2
    assert found.pop("image") == ["DJI_0000.JPG", "DJI_0001.JPG"]
    assert found.pop("status") == ["solved", "exact"]
    assert found.pop("job") == [3, 3] and found.pop("frame") == [41, 52]
    assert found.pop("flags") == made().flag_text and found.pop("landmarks") == [4, 4]
    assert found.pop("last_correction_rad") == [292.0, 295.0]
    starts = {"camera": 210, "vehicle": 220, "gimbal": 260}
    expected: dict[str, tuple[float, int]] = {  # of the first frame, and the step to the second
        "time_s": (200, 1), "airspeed_m_s": (240, 1), "vehicle_east_m": (250, 3),
        "vehicle_north_m": (251, 3), "vehicle_up_m": (252, 3), "latitude_deg": (100, 1),
        "longitude_deg": (110, 1), "altitude_m": (120, 1), "residual_rms_px": (310, 1),
        "reading_sigma_px": (550, 0), "degrees_of_freedom": (551, 0), "misfit_chance": (552, 1),
        "condition": (320, 1), "alpha_deg": (230, 3), "beta_deg": (231, 3), "eta_deg": (232, 3),
        "eta_low_95_deg": (460, 2), "eta_high_95_deg": (461, 2),
        "covariance_factor_95": (560, 1),
    }  # fmt: skip
    expected |= {f"quaternion_{one}": (300 + k, 4) for k, one in enumerate("wxyz")}
    for name, start in starts.items():
        for k, one in enumerate(("yaw", "pitch", "roll")):
            expected[f"{name}_{one}_deg"] = (start + k, 3)
    for name, start in (
        ("sigma", 400), ("sigma_reading", 470), ("sigma_position", 490), ("slip_effect", 270),
        ("half_width_95", 420),
    ):  # fmt: skip
        for k, one in enumerate(NAMES[: 8 if name == "half_width_95" else 9]):
            expected[f"{name}_{one}_deg"] = (start + k, 9)
    body = ("forward", "right", "down")
    for part, start in (("", 510), ("common_", 530)):
        for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            expected[f"covariance_{part}{body[i]}_{body[j]}_deg2"] = (start + 3 * i + j, 9)
    assert found == {name: [first, first + step] for name, (first, step) in expected.items()}


def test_covariances_as_matrices() -> None:
    found = matrices([made()])
    assert list(found) == ["covariance_deg2", "covariance_common_deg2"]
    assert np.array_equal(found["covariance_deg2"], covariance(510))
    assert np.array_equal(found["covariance_common_deg2"], covariance(530))


def test_only_the_uncertainty_may_be_infinite() -> None:
    """Elsewhere what is not finite is missing."""
    one = made()
    far = np.array([np.inf, -np.inf])
    e = replace(
        one.estimate, time_s=far, camera_deg=np.repeat(far[:, None], 3, axis=1), airspeed=far,
        position=replace(one.estimate.position, altitude=far),
    )  # fmt: skip
    wide = np.repeat(np.abs(far)[:, None], 9, axis=1)
    doubt = replace(one.uncertainty, total=wide, half_width_95=wide)
    found = table([replace(one, estimate=e, uncertainty=doubt)])
    for name in ("time_s", "camera_yaw_deg", "camera_roll_deg", "airspeed_m_s", "altitude_m"):
        assert np.isnan(found[name]).all(), name
    for name in ("sigma_eta_deg", "half_width_95_beta_deg"):
        assert np.isposinf(found[name]).all(), name


# The columns of the attitude table: names, units, rows, and what is stated without a value


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


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), 1e-10])
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


# What is refused, which columns a table of several jobs has, and how its rows are taken


NONE = float("nan")


REFUSED_NAMES = {
    "reading": "reading", "fiducial": "fiducial", "landmark": "landmark", "position": "position",
    "focal_length": "focal length", "time_s": "time", "velocity": "velocity", "wind": "wind",
    "mount_deg": "mount",
}  # fmt: skip


@pytest.mark.parametrize("name", [*REFUSED_NAMES])
def test_what_is_no_standard_deviation_is_named(name: str) -> None:
    for value, text in ((-0.5, "-0.5"), (np.inf, "inf"), (NONE, "nan"), (-1e-300, "-1e-300")):
        with pytest.raises(VopdError) as raised:
            Sigmas(**{name: value})
        assert_approved(str(raised.value), parts=[REFUSED_NAMES[name], text])
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


@pytest.mark.parametrize("name", [field.name for field in fields(Sigmas)])
def test_a_standard_deviation_of_numpy_is_the_same_number(name: str) -> None:
    """In four bytes it had seven digits, and one of the wind ended in numpy's error."""
    solved = run("decks/appendix_h/case1.dat")
    sigmas = [Sigmas(**{name: one}) for one in (float(np.float32(0.1)), np.float32(0.1))]
    one, other = (solved.histories(some)[0].uncertainty.total for some in sigmas)
    assert one.tobytes() == other.tobytes()


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


@pytest.mark.parametrize("name", ["vehicle_yaw_dg", "yaw", "sigma_yaw", "temperature"])
def test_a_column_that_there_is_not_has_a_neighbour(name: str) -> None:
    with refused(VopdError):
        chosen_columns([history(one_of())], [name])


def test_a_roll_of_half_circles_says_so() -> None:
    h = history(one_of())
    (plain,), (half,) = (chosen_columns([h], ["vehicle_roll_deg"], one) for one in (False, True))
    assert half.lowest == -180.0
    assert_approved([plain.meaning, half.meaning])


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
