"""Every column of the attitude table: its name, unit, meaning, and the value it takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, estimate
from vopd.arrays import Floats
from vopd.attitude.geometry import LandmarkGeometry
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import columns_of, matrices, table
from vopd.estimate import FrameStatus

ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))
TURN = "of small turns of the vehicle about its"
ERRATA = "the angle with all errata corrected minus this one; no sigma includes it"
NAMES = (
    "camera_yaw", "camera_pitch", "camera_roll", "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
GENERAL = [
    ("flight", "", "the file"),
    ("job", "", "the job's number in its file, from 1"),
    ("frame", "", "frame number"),
    ("image", "", "the name of the frame's image"),
    ("status", "", "solved, ignored, exact (no residuals at all), stopped"),
    ("time_s", "s", "time"),
    ("camera_yaw_deg", "deg", "of the optical axis, clockwise from north, 0 to 360"),
    ("camera_pitch_deg", "deg", "of the optical axis, above the horizontal, -180 to 180"),
    ("camera_roll_deg", "deg", "about the optical axis, 0 to 360"),
    ("vehicle_yaw_deg", "deg", "heading, clockwise from north, 0 to 360"),
    ("vehicle_pitch_deg", "deg", "nose above the horizontal, -180 to 180"),
    ("vehicle_roll_deg", "deg", "right wing down, 0 to 360"),
    ("alpha_deg", "deg", "angle of attack in pitch"),
    ("beta_deg", "deg", "angle of attack in yaw"),
    ("eta_deg", "deg", "total angle of attack, 0 to 180"),
    ("airspeed_m_s", "m/s", "speed relative to the air"),
    ("vehicle_east_m", "m", "east of the track's origin"),
    ("vehicle_north_m", "m", "north of it"),
    ("vehicle_up_m", "m", "up along its vertical"),
    ("latitude_deg", "deg", "of the vehicle, geodetic"),
    ("longitude_deg", "deg", "positive east, -180 to 180"),
    ("altitude_m", "m", "above the ellipsoid"),
    ("quaternion_w", "", "local north-east-down to body; scalar, >= 0"),
    ("quaternion_x", "", "north and forward part"),
    ("quaternion_y", "", "east and right part"),
    ("quaternion_z", "", "down part"),
    ("landmarks", "", "how many take part"),
    ("residual_rms_px", "px", "root mean square of the residuals"),
    ("reading_sigma_px", "px", "standard deviation of an image coordinate, one for the job"),
    ("degrees_of_freedom", "", "of the reading sigma, where it was estimated from residuals"),
    ("misfit_chance", "", "of residuals as large as the frame's, or larger"),
    ("condition", "", "of the partials by turns of the camera"),
    ("last_correction_rad", "rad", "of the last pass, largest of three"),
    ("flags", "", "what to distrust; a colon before a detail"),
    *((f"gimbal_{one}_deg", "deg", "in the image's tags, not used") for one in ("yaw", "pitch",
                                                                              "roll")),
    *((f"sigma_{one}_deg", "deg", "standard deviation, all components together") for one in NAMES),
    *(
        (f"sigma_{part}_{one}_deg", "deg", f"standard deviation, component {part}")
        for part in ("reading", "position")
        for one in NAMES
    ),
    *((f"half_width_95_{one}_deg", "deg", "half of the 95 % interval's width")
      for one in NAMES[:8]),
    ("eta_low_95_deg", "deg", "lower end of the 95 % interval of eta"),
    ("eta_high_95_deg", "deg", "upper end of the 95 % interval of eta"),
    *(
        (f"covariance_{part}{one}_{other}_deg2", "deg2", f"{TURN} {one} and {other} axes, {what}")
        for part, what in (
            ("", "all components"), ("common_", "errors that are the same in all frames"),
        )
        for one, other in (
            ("forward", "forward"), ("forward", "right"), ("forward", "down"), ("right", "right"),
            ("right", "down"), ("down", "down"),
        )
    ),
    *((f"slip_effect_{one}_deg", "deg", ERRATA) for one in NAMES),
]  # fmt: skip
DECIMALS_6 = ("gimbal", "sigma_", "half_width", "eta_low", "eta_high", "slip_effect")


def numbers(start: float, *shape: int) -> Floats:
    return start + np.arange(float(np.prod(shape))).reshape(shape)


def covariance(start: float) -> Floats:
    """Symmetric: start + 3 i + j where i is the smaller index, and 9 more in the second frame."""
    upper = np.triu(numbers(start, 2, 3, 3))
    return np.asarray(upper + np.triu(upper, 1).swapaxes(1, 2))


def made() -> History:
    """Two frames in which every value of the table is another number."""
    one = history(
        estimate(ANGLES, about=ABOUT._replace(job=3), reading_spread=0.5),
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
    assert list(found) == [name for name, _, _ in GENERAL]
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
