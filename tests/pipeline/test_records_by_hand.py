"""The small records that rooms hand to each other: their defaults, names and codes, typed in."""

from __future__ import annotations

from dataclasses import asdict, fields, replace

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1, DECKS
from tests.kit.estimates import estimate
from tests.kit.jobs import BY_FRAME, BY_LANDMARK, film
from vopd.estimate import (
    About,
    Estimate,
    FrameStatus,
    MapGrid,
    Position,
    Responses,
    StatedSigmas,
    Units,
    Vertical,
    Words,
)
from vopd.findings import BASIC_DATA, Finding, InputError, VopdError, group_text
from vopd.job import Readings
from vopd.results import DeckEnd, Outcome, SolvedJob, Stage, Stop

ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))


def test_words_and_units_of_any_source() -> None:
    assert asdict(Words()) == {
        "source": "source", "no_fixes": "", "surface": "in the image",
        "centre": "principal point", "landmark": "its name or number",
        "reading": "a measured image coordinate", "repeated": "by repeated measurements",
        "vertical": "", "own_position": "", "columns": {}, "flags": {}, "conventions": {},
        "sigma_keys": {},
    }  # fmt: skip
    assert Units() == ("ft", "mm", 0.3048, "µm", 1000.0)
    assert Units._fields == (
        "length", "image", "metres_per_length", "residual", "residuals_per_image",
    )  # fmt: skip
    assert About("a.dat") == (
        "a.dat", 1, "", "", "along the ellipsoid's normal", Words(), None,
    )  # fmt: skip
    assert StatedSigmas() == ((0.0,) * 3, (0.0,) * 3, 0.0, 0.0, (0.0, 0.0))
    with pytest.raises(AttributeError):
        Words().source = "deck"  # type: ignore[misc]


def test_codes_and_names_of_how_frames_end() -> None:
    assert {one.name: int(one) for one in FrameStatus} == {
        "SOLVED": 0, "IGNORED": 1, "EXACT": 2, "STOPPED": 3, "UNSOLVED": 4,
    }  # fmt: skip
    assert {one.name: int(one) for one in Outcome} == {
        "SOLVED": 0, "DROPPED": 1, "EXACT": 2, "EXACT_LATE": 3, "STOPPED": 4,
    }  # fmt: skip
    assert {one.name: str(one) for one in Vertical} == {
        "GEODETIC": "geodetic", "GEOCENTRIC": "geocentric",
    }  # fmt: skip
    assert {one.name: one.value for one in Stage} == {
        "TIME": "before group 1", "LENS": "after group 3", "WIND": "after group 4",
    }  # fmt: skip


def test_what_an_estimate_has_where_its_source_says_nothing() -> None:
    values = {one.name: getattr(estimate(ANGLES), one.name) for one in fields(Estimate)}
    for name in ("landmark_names", "frame_names"):
        values.pop(name)
    bare = Estimate(**values)
    assert (bare.fiducial_sigma, bare.landmark_names, bare.frame_names) == (0.0, {}, ())
    assert bare.stated == StatedSigmas()
    assert (bare.slip_effect_deg, bare.grid, bare.gimbal_deg, bare.outlier) == (None,) * 4
    place = Position(*np.zeros((5, 2)))
    assert (place.vertical, place.to_own_m, place.largest_lean_deg) == ("geodetic", None, None)
    assert MapGrid._fields == ("crs", "easting", "northing", "convergence_deg")
    assert Responses._fields == (
        "landmark", "position", "focal_length", "time", "attack_by_camera", "attack_by_time",
        "attack_by_velocity",
    )  # fmt: skip


def test_names_of_landmarks_and_frames() -> None:
    named = estimate(ANGLES, frame=np.array([41, 52]))
    assert [named.landmark_label(k) for k in (7, 10, 11, np.int64(8))] == [
        "church tower", "<crossing>", "11", "bridge; north end",
    ]  # fmt: skip
    assert [named.frame_label(k) for k in (0, 1)] == ["DJI_0000.JPG", "DJI_0001.JPG"]
    bare = replace(named, landmark_names={}, frame_names=())
    assert bare.landmark_label(7) == "7" and [bare.frame_label(k) for k in (0, 1)] == ["41", "52"]


def test_residuals_as_pairs() -> None:
    """x of every landmark stands before y of every landmark; NaN where one takes no part."""
    used = np.array([[True, True, True, True], [True, False, True, True]])
    e = estimate(ANGLES, residual=np.array([[1.0, 2, 3, 4, 5, 6, 7, 8]] * 2), used=used)
    assert e.residual_xy[0].tolist() == [[1, 5], [2, 6], [3, 7], [4, 8]]
    assert np.isnan(e.residual_xy[1, 1]).all() and e.residual_xy[1, 2].tolist() == [3, 7]


def test_a_finding_s_defaults_and_errors() -> None:
    assert asdict(Finding("odd")) == {
        "message": "odd", "deck": "", "card": None, "job": None, "group": None, "field": "",
        "columns": None, "image": None, "severity": "error",
    }  # fmt: skip
    assert str(Finding("odd")) == "odd" and BASIC_DATA == 0
    assert [group_text(k) for k in (0, 1, 12)] == ["basic data", "group 1", "group 12"]
    error = InputError(Finding("odd", "a.dat"))
    assert isinstance(error, VopdError) and str(error) == "a.dat: odd"


def test_ends_and_solved_jobs() -> None:
    assert DeckEnd("a") == ("a", None, ()) and DeckEnd._fields == ("deck", "error", "findings")
    (results,) = vopd.run(vopd.read_deck(CASE_1))
    assert SolvedJob("a", 2, results).findings == ()
    assert results.stop is None
    assert [one.name for one in fields(Stop)] == [
        "frame_index", "stage", "group", "table", "position", "vari", "vard",
    ]  # fmt: skip


FRAME = {
    "frame": "", "outcome": "", "time_s": "", "vehicle_ft": "3", "centre_in": "2", "centre_mm": "2",
    "start_deg": "3", "camera_deg": "3", "vehicle_deg": "3", "alpha_deg": "", "beta_deg": "",
    "eta_deg": "", "airspeed_ft_s": "", "residual_deviation_mm": "", "correction_rad": "3",
    "last_pass": "", "singular": "", "outside_clock": "", "outside_trajectory": "",
    "outside_wind": "",
}  # fmt: skip
LANDMARK = {
    "landmark": "", "used": "", "ignored": "", "longitude_deg": "", "latitude_deg": "",
    "geocentric_latitude_deg": "", "altitude_ft": "", "radius_km": "", "radius_kft": "",
    "direction": "3", "point_in": "2", "point_mm": "2", "radius_mm": "", "distortion_mm": "",
    "residual_mm": "2", "at_centre": "",
}  # fmt: skip


KINDS = dict.fromkeys(("frame", "outcome", "landmark", "last_pass"), np.int64) | dict.fromkeys(
    (
        "used", "ignored", "at_centre", "singular", "outside_clock", "outside_trajectory",
        "outside_wind",
    ),
    np.bool_,
)  # fmt: skip


def test_the_shape_of_every_array_of_results() -> None:
    """As it is declared, and as it is."""
    (results,) = vopd.run(vopd.read_deck(CASE_1))
    shapes = {name: ("F", *more.split()) for name, more in FRAME.items()}
    shapes |= {name: ("F", "L", *more.split()) for name, more in LANDMARK.items()}
    assert (set(BY_FRAME), set(BY_LANDMARK)) == (set(FRAME), set(LANDMARK))
    sizes = {"F": 1, "L": 3}
    for name, axes in shapes.items():
        expected = tuple(sizes.get(axis) or int(axis) for axis in axes)
        assert getattr(results, name).shape == expected, name
        assert getattr(results, name).dtype == KINDS.get(name, np.float64), name
    assert results.focal_length_mm.tolist() == [results.job.camera.focal_length_mm]


def test_counts_and_some_frames_of_results() -> None:
    """Landmarks that take part, not those that are there; a job of some frames has their cards."""
    job = film(2)
    (results,) = vopd.run(job)
    assert results.used_count.tolist() == results.layout.count.tolist() == [5, 5]
    ignored = replace(job.ignored, everywhere=job.readings.landmark[0, :1])
    (fewer,) = vopd.run(replace(job, ignored=ignored))
    assert fewer.used_count.tolist() == [4, 4] and fewer.layout.count.tolist() == [5, 5]
    last = results.as_job(np.array([1]))
    assert last.frame.tolist() == results.frame[1:].tolist()
    assert last.job.readings.frame.tolist() == results.job.readings.frame[1:].tolist()
    assert len(results.job.readings.frame) == 2
    assert last.camera_deg.tolist() == results.camera_deg[1:].tolist()
    assert last.focal_length_mm.tolist() == [results.job.camera.focal_length_mm]
    assert results.focal_length_mm.shape == (2,)


def test_a_run_that_stopped_has_the_landmarks_of_its_frames() -> None:
    """Not those of the frames behind, also where its results are made anew with other values."""
    (job,) = vopd.read_deck(DECKS / "regression" / "wind_out_of_order.dat")
    film_job = replace(job, readings=Readings.concat([job.readings] * 2))
    (stopped,) = vopd.run(film_job)
    assert stopped.stop is not None and len(stopped.frame) < len(film_job.readings.frame)
    anew = replace(stopped, stop=None)
    assert len(anew.layout.count) == len(anew.frame) == len(anew.landmark)
    assert anew.layout.count.tolist() == film_job.readings.layout.count[: len(anew.frame)].tolist()
    assert anew.stop is None and anew.landmark.tolist() == stopped.landmark.tolist()
