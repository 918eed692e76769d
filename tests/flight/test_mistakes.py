"""Usual mistakes of a flight: its residuals without each, limits from both sides, other clocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import TOML, long_track, uneven_flight, write_project
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.flight.check import check_flight
from vopd.flight.flight import Flight, FlightOptions, LandmarkSet
from vopd.flight.misfits import mistakes
from vopd.flight.misfits.mistakes import (
    AXES_MISTAKES,
    USUAL_MISTAKES,
    freedom,
    other_clock,
    solved_trial,
    some_frames,
    trial_px,
    typical_px,
    usual_mistakes,
)
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import flight_of, read_flight
from vopd.flight.result import FlightResult, solve_flight_read
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.mistakes import Explanation, Mistake

NAN = float("nan")
ANY: Any = None


@pytest.fixture(autouse=True)
def quiet() -> Iterator[None]:
    """Frames without an attitude are NaN, as in a check."""
    with np.errstate(all="ignore"):
        yield


# Residuals of a trial, its freedom, and which frames are tried


def flight(frame: list[int], landmark: list[int], frames: int, **more: Any) -> Any:
    used = more.get("used", ())
    position = np.zeros((frames, 3))
    position[more.get("lost", [])] = NAN
    return SimpleNamespace(
        frame=np.arange(frames),
        picks=SimpleNamespace(frame=np.array(frame), landmark=np.array(landmark)),
        landmarks=LandmarkSet(("a", "b", "c"), np.zeros((3, 3)), np.zeros((3, 3)), used),
        path=SimpleNamespace(position_m=position),
    )


def estimate(used: list[list[bool]], residual: list[list[float]]) -> Any:
    return SimpleNamespace(used=np.array(used), residual=np.array(residual))


def test_the_root_mean_square_of_the_median_frame() -> None:
    """3 and 4 px in u and v of two picks are 12.5 px2 a coordinate; other frames have 1 and 7."""
    one = flight([0, 0, 1, 1, 2, 2], [0, 1] * 3, 3)
    squares = [[3.0, 3.0, 4.0, 4.0], [1.0] * 4, [7.0, 7.0, 7.0, -7.0]]
    assert_close("ratio", typical_px(one, estimate([[True] * 2] * 3, squares)), np.sqrt(12.5))
    two = flight([0, 0, 1, 1], [0, 1] * 2, 2)
    found = typical_px(two, estimate([[True] * 2] * 2, squares[1:]))
    assert_close("ratio", found, 4.0)  # of two frames the mean


def test_a_pick_without_an_image_counts_a_thousand_pixels() -> None:
    """Once over both coordinates of two picks."""
    one = flight([0, 0], [0, 1], 1)
    found = typical_px(one, estimate([[True, False]], [[2.0, 0.0, 0.0, 0.0]]))
    assert_close("ratio", found, np.sqrt((1000.0**2 + 4.0) / 4))


def test_what_does_not_count() -> None:
    """A check landmark, a frame with one pick, and one without a position."""
    one = flight([0, 0, 0, 1, 2, 2], [0, 1, 2, 0, 0, 1], 3, used=(True, True, False), lost=[2])
    used = [[True, True, False], [False] * 3, [False] * 3]
    residual = [[1.0, 1.0, 0.0, 1.0, 1.0, 0.0], [0.0] * 6, [0.0] * 6]
    assert typical_px(one, estimate(used, residual)) == 1.0
    alone = flight([0, 1], [0, 0], 2)
    assert typical_px(alone, estimate([[False]] * 2, [[0.0] * 2] * 2)) == 1000.0


def test_freedom_is_of_frames_with_an_attitude() -> None:
    """Three picks and two: 6 - 3 and 4 - 3; the last frame has none."""
    given: Any = SimpleNamespace(
        used=np.array([[True, True, True], [True, True, False], [True, True, True]]),
        camera_deg=np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [NAN] * 3]),
    )
    assert freedom(given) == 4


@pytest.mark.parametrize(
    ("tried", "frames", "chosen"),
    [
        (3, 7, [0, 3, 6]),
        (3, 6, [0, 2, 4]),
        (3, 4, [0, 2]),
        (3, 3, [0, 1, 2]),
        (500, 2, [0, 1]),
    ],
)
def test_frames_are_chosen_evenly(
    tried: int, frames: int, chosen: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert mistakes.FRAMES_TRIED == 500
    monkeypatch.setattr(mistakes, "FRAMES_TRIED", tried)
    assert some_frames(uneven_flight([2] * frames)).frame.tolist() == chosen


@pytest.mark.parametrize(
    ("counts", "kept"),
    [
        ([2, 2, 2, 8], [2, 2, 2, 8]),
        ([2, 2, 2, 9], [2, 2, 2]),
        ([1, 1, 1, 4, 4, 16], [1, 1, 1, 4, 4, 16]),  # those with one are not usual frames
        ([1, 1, 1], [1, 1, 1]),
        ([1, 0, 1], [1, 0, 1]),
    ],
)
def test_a_frame_with_more_than_four_times_the_usual_picks_is_left_out(
    counts: list[int], kept: list[int]
) -> None:
    flight = some_frames(uneven_flight(counts))
    assert np.bincount(flight.picks.frame, minlength=len(flight.frame)).tolist() == kept


# Flights without each mistake


def corrected(name: str, project: Project, flight: Flight) -> list[tuple[Flight, str]]:
    """Flights without a mistake of the table, and the advice."""
    (mistake,) = [one for one in (*AXES_MISTAKES, *USUAL_MISTAKES) if one.name == name]
    found = mistake.change(project, flight, solved_trial(flight))
    return [(one, mistake.advice.format(*values)) for one, values in found]


def read(folder: Path, toml: str = TOML) -> tuple[Project, Flight]:
    project = read_project(str(write_project(folder, toml)))
    return project, flight_of(project)


def test_the_most_telling_mistake_comes_first() -> None:
    assert_approved([one.name for one in (*AXES_MISTAKES, *USUAL_MISTAKES)])


def test_u_and_v_of_every_pick_are_exchanged(tmp_path: Path) -> None:
    project, flight = read(tmp_path)
    ((found, advice),) = corrected("u and v exchanged", project, flight)
    assert found.picks.pixel.tolist() == flight.picks.pixel[:, [1, 0]].tolist()
    assert_approved(advice)


def test_labels_of_two_landmarks_that_were_exchanged_in_all_frames() -> None:
    """The first and the third of five: among the exchanges of each two, this one leaves nothing."""
    flight = uneven_flight([5] * 6, noise_px=0.0)
    label = np.array([2, 1, 0, 3, 4])[flight.picks.landmark]
    wrong = replace(flight, picks=replace(flight.picks, landmark=label))
    found = {advice: trial_px(one) for one, advice in corrected("labels exchanged", ANY, wrong)}
    assert len(found) == 10
    best = min(found, key=lambda advice: found[advice])
    assert found[best] < 1e-3 * sorted(found.values())[1]
    names = flight.landmarks.name
    assert f"{names[0]} and {names[2]} exchanged" in best
    same = corrected("labels exchanged", ANY, flight)
    assert all(len(set(one.picks.landmark.tolist())) == 5 for one, _ in same)


@pytest.mark.parametrize(("order", "row"), [([1, 2, 3, 4, 0], "below"), ([4, 0, 1, 2, 3], "above")])
def test_names_that_stand_a_row_off_their_coordinates(order: list[int], row: str) -> None:
    """The row at the end has those of another place, or of the row at the other end."""
    flight = uneven_flight([5] * 6, noise_px=0.0)
    position_m = np.empty((5, 3))
    position_m[order] = flight.landmarks.position_m
    for end_m in (0.0, 500.0):
        moved = position_m.copy()
        moved[0 if row == "below" else 4] += end_m
        wrong = replace(flight, landmarks=replace(flight.landmarks, position_m=moved))
        found = [
            (trial_px(one), advice) for one, advice in corrected("names a row off", ANY, wrong)
        ]
        fit = [advice for size, advice in found if size < 2.0 * trial_px(flight)]
        assert len(fit) == (2 if end_m == 0.0 else 1) and len(found) == 4
        assert all(f"the row {row} in" in advice for advice in fit)


def test_another_frame_rate_is_tried_where_frames_have_numbers(tmp_path: Path) -> None:
    """Usual rates within a factor of three of the stated one, and not that itself."""
    project, flight = read(tmp_path)
    stated = project.section("picks").values["frame_rate_hz"]
    found = corrected("another frame rate", project, flight)
    assert found and all(f"in the place of {stated:g}" in advice for _, advice in found)
    assert not any(f"frame_rate_hz = {stated:g} in" in advice for _, advice in found)
    assert (
        corrected("another frame rate", project.changed("picks", "frame_rate_hz", 1e3), flight)
        == []
    )
    found = corrected("another frame rate", project.changed("picks", "frame_rate_hz", 60), flight)
    rates = [float(advice.split("frame_rate_hz = ")[1].split()[0]) for _, advice in found]
    assert rates == [23.976, 24.0, 25.0, 29.97, 30.0, 48.0, 50.0, 59.94, 120.0]


def test_two_landmarks_tell_nothing_of_their_labels_and_long_flights_take_too_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Ten exchanges of five landmarks in six frames are 300 picks."""
    assert corrected("labels exchanged", ANY, uneven_flight([2] * 6)) == []
    assert len(corrected("labels exchanged", ANY, uneven_flight([3] * 6))) == 3
    five = uneven_flight([5] * 6)
    monkeypatch.setattr(mistakes, "TRIAL_PICKS", 150)
    assert len(corrected("labels exchanged", ANY, five)) == 10
    monkeypatch.setattr(mistakes, "TRIAL_PICKS", 149)
    assert corrected("labels exchanged", ANY, five) == []


def test_rates_by_which_no_frame_is_on_the_track_are_left_out(tmp_path: Path) -> None:
    """Frame 100 is 2 s after the start of the track by 24 frames a second, whose frames end at 4 s.

    By 15 it would be at 4.5 s, by 48 before it: the others are tried all the same.
    """
    toml = TOML.replace("frame_rate_hz = 10.0", "frame_rate_hz = 24.0")
    toml = toml.replace("first_frame_t_s = 2.0", f"first_frame_t_s = {2.0 - 100 / 24.0!r}")
    path = write_project(tmp_path, toml)
    head, *picks = (tmp_path / "picks.csv").read_text(encoding="utf-8").splitlines()
    later = [f"{100 + int(row.partition(',')[0])},{row.partition(',')[2]}" for row in picks]
    (tmp_path / "picks.csv").write_text("\n".join([head, *later, ""]), encoding="utf-8")
    project = read_project(str(path))
    found = corrected("another frame rate", project, flight_of(project))
    rates = [float(advice.split("frame_rate_hz = ")[1].split()[0]) for _, advice in found]
    assert rates == [23.976, 25.0, 29.97, 30.0]


@pytest.mark.parametrize(
    ("residual_px", "rates"), [((1.0, 1.2, 40.0), "24 or 25 in"), ((1.4, 1.0, 40.0), "25 in")]
)
def test_rates_that_explain_as_well_are_named_together(
    residual_px: tuple[float, ...], rates: str
) -> None:
    found = [
        Explanation(px, f"only {rate:g}", (), "another frame rate", (rate, 60.0))
        for px, rate in zip(residual_px, (24.0, 25.0, 30.0), strict=True)
    ]
    text = mistakes._best_text("residuals are 50.0 px", 50.0, [], found)
    assert f"frame_rate_hz = {rates} the place of 60" in text


@pytest.mark.parametrize("key", ["", 'v = "down"', 'v = "up"'])
def test_v_is_turned_over_within_the_height_of_the_image(key: str, tmp_path: Path) -> None:
    """The image has 1080 rows, the last of them is 1079."""
    project, flight = read(tmp_path, TOML.replace("[landmarks]", f"{key}\n[landmarks]"))
    pixel = np.tile([[3.0, 0.0], [4.0, 1079.0], [5.0, 10.5]], (10, 1))
    turned = replace(flight, picks=replace(flight.picks, pixel=pixel))
    ((found, _),) = corrected("v counted the other way", project, turned)
    assert found.picks.pixel[:3].tolist() == [[3.0, 1079.0], [4.0, 0.0], [5.0, 1068.5]]


def test_a_flight_with_v_turned_over_has_no_residuals_without_it(tmp_path: Path) -> None:
    project, flight = read(tmp_path)
    pixel = flight.picks.pixel * [1.0, -1.0] + [0.0, 1079.0]
    turned = replace(flight, picks=replace(flight.picks, pixel=pixel))
    ((found, advice),) = corrected("v counted the other way", project, turned)
    assert trial_px(found) < within("trial without noise")
    assert advice.endswith('give [picks] v = "up"?')
    said = replace(turned, picks=replace(turned.picks, v_said=True))  # where the key is refused
    ((_, advice),) = corrected("v counted the other way", project, said)
    assert "[picks]" not in advice


def columns_written(folder: Path, files: tuple[str, ...], write: Any) -> None:
    """Write latitude and longitude of tables another way: `write` gives both as texts."""
    for name in files:
        path = folder / name
        head, *rows = (line.split(",") for line in path.read_text(encoding="utf-8").splitlines())
        at, on = head.index("lat_deg"), head.index("lon_deg")
        for row in rows:
            row[at], row[on] = write(float(row[at]), float(row[on]))
        path.write_text("".join(f"{','.join(row)}\n" for row in [head, *rows]), encoding="utf-8")


def sixtieths(parts: int) -> Any:
    """Write degrees, minutes (and seconds) one after the other, as 47.3836 for 47 38' 36"."""

    def text(degrees: float) -> str:
        units = round(abs(degrees) * 60.0**parts * 1e8)
        unit = 60**parts * 10**8
        minutes = units % unit / (unit / 60)
        if parts == 1:
            return f"{units // unit}.{minutes * 1e8:010.0f}"
        return f"{units // unit}.{int(minutes):02d}{minutes % 1.0 * 60.0 * 1e8:010.0f}"

    return lambda latitude, longitude: (text(latitude), text(longitude))


BOTH, MARKS_ALONE = ("landmarks.csv", "track.csv"), ("landmarks.csv",)


@pytest.mark.parametrize(
    ("files", "write", "words"),
    [
        (BOTH, lambda a, b: (str(b), str(a)), "latitudes and longitudes of all exchanged"),
        (BOTH, sixtieths(2), "of all latitudes and longitudes taken for minutes and seconds"),
        (MARKS_ALONE, sixtieths(2), "of the landmarks' latitudes and longitudes taken for minutes"),
        (BOTH[1:], sixtieths(1), "of the camera's latitudes and longitudes taken for minutes:"),
        (BOTH, lambda a, b: (str(a), str(-b)), "the wrong sign in all longitudes"),
    ],
    ids=["exchanged", "seconds", "of landmarks", "minutes", "mirrored"],
)  # fmt: skip
def test_degrees_that_are_written_another_way(
    files: tuple[str, ...], write: Any, words: str, tmp_path: Path
) -> None:
    project = write_project(tmp_path, noise_px=0.3)
    columns_written(tmp_path, files, write)
    assert words in " ".join(one.message for one in check_flight(str(project)))


FIXED = "lat_deg = 47.6435\nlon_deg = 16.4759\nh_m = 1000.0\nsigma_m = 'exact'\n"


@pytest.mark.parametrize("where", ["track", "position"])
@pytest.mark.parametrize(
    ("marks", "camera", "geoid_m"),
    [("ellipsoid", "ellipsoid", (0.0, 0.0)), ("same", "same", (0.0, 0.0)),
     ("-37.9", "45.5", (-37.9, 45.5))],
)  # fmt: skip
def test_heights_in_feet_are_turned_about_their_own_level(
    where: str, marks: str, camera: str, geoid_m: tuple[float, float], tmp_path: Path
) -> None:
    """A height of 1000 ft above a geoid is 304.8 m above it; the place stays.

    The track has no position for the first frame.
    """
    fixed = f'[position]\nheight = "ellipsoid"\n{FIXED}'
    text = TOML if where == "track" else TOML.partition("[track]")[0] + fixed
    head, middle, end = text.split('"ellipsoid"')
    of_marks, of_camera = (
        f'"{one}"' if one.isalpha() else f"{{ undulation_m = {one} }}" for one in (marks, camera)
    )
    project, flight = read(tmp_path, f"{head}{of_marks}{middle}{of_camera}{end}")
    high = [
        earth_centred_m([47.0] * len(rows), [16.0] * len(rows), [1000.0 + geoid] * len(rows))
        for rows, geoid in zip((flight.landmarks.name, flight.frame), geoid_m, strict=True)
    ]
    high[1][0] = np.nan
    flight = replace(
        flight, landmarks=replace(flight.landmarks, position_m=high[0]),
        path=replace(flight.path, position_m=high[1]),
    )  # fmt: skip
    found = corrected("heights in feet", project, flight)
    assert len(found) == 3
    for (one, _), lowered in zip(found, [(True, False), (False, True), (True, True)], strict=True):
        positions = (one.landmarks.position_m, one.path.position_m)
        for position, low, geoid in zip(positions, lowered, geoid_m, strict=True):
            place = geodetic(position[-1])
            assert_close("flight height", place.height_m, geoid + (304.8 if low else 1000.0))
            assert_close("ratio", place.latitude_deg, 47.0)


@pytest.mark.parametrize(("above_m", "named"), [(-95.0, True), (95.0, True), (105.0, False)])
def test_heights_that_count_from_the_pad_are_named_with_its_height(
    above_m: float, named: bool, tmp_path: Path
) -> None:
    """A pad within 100 m of the landmarks' median height; one farther off is no pad there."""
    project = write_project(tmp_path, noise_px=0.3)
    marks = (tmp_path / "landmarks.csv").read_text(encoding="utf-8").splitlines()[1:]
    pad_m = above_m + float(np.median([float(line.split(",")[3]) for line in marks]))
    head, *lines = (tmp_path / "track.csv").read_text(encoding="utf-8").splitlines()
    cells = [line.rpartition(",") for line in lines]
    rows = [f"{rest},{float(height) - pad_m:.6f}" for rest, _, height in cells]
    (tmp_path / "track.csv").write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    said = " ".join(one.message for one in check_flight(str(project)))
    assert ("ground_m = " in said) == named
    if named:
        found_m = float(said.partition("ground_m = ")[2].split()[0])
        assert abs(found_m - pad_m) < within("height of a pad")


def test_a_camera_s_height_in_feet_is_found_also_where_it_does_not_move(tmp_path: Path) -> None:
    """At 540 m the camera stands 45.5 m above the ellipsoid less than its height in feet says."""
    feet = (540.0 - 45.5) / 0.3048
    fixed = (
        f"[position]\nlat_deg = 47.6435\nlon_deg = 16.4759\nh_m = {feet!r}\n"
        "height = { undulation_m = 45.5 }\nsigma_m = 'exact'\n"
    )
    path = write_project(tmp_path, TOML.split("[track]")[0] + fixed)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join(rows[:7]))
    project = read_project(str(path))
    left = [trial_px(one) for one, _ in corrected("heights in feet", project, flight_of(project))]
    assert [px < within("trial without noise") for px in left] == [False, True, False]


@pytest.mark.parametrize("own_s", [0.0, 2.5])
def test_both_clocks_are_tried_on_top_of_the_own_offset(own_s: float, tmp_path: Path) -> None:
    """The camera climbs by 2 m/s: with a track that is 18 s later it is 36 m lower."""
    path = write_project(tmp_path, TOML + f"offset_s = {own_s}\n")
    long_track(tmp_path)
    project = read_project(str(path))
    flight = flight_of(project)
    (gps, first), (utc, second) = corrected("GPS time for UTC", project, flight)
    up = local_axes(flight.path.position_m[:1])[0, 2]
    for one, climbed_m in ((gps, 36.0), (utc, -36.0)):
        moved = (one.path.position_m - flight.path.position_m) @ up
        assert np.abs(moved - climbed_m).max() < within("flight height")
    assert "-18 s" in first and "+18 s" in second
    (tmp_path / "track.csv").write_text(
        "\n".join((tmp_path / "track.csv").read_text().splitlines()[:45])
    )  # up to 13 s
    project = read_project(str(path))
    (one,) = corrected("GPS time for UTC", project, flight_of(project))
    assert one[1] == second


def test_positions_that_have_no_clock_have_no_other_one(tmp_path: Path) -> None:
    name = "GPS time for UTC"
    fixed = '[position]\nheight = "ellipsoid"\n' + FIXED
    assert corrected(name, *read(tmp_path, TOML.partition("[track]")[0] + fixed)) == []
    path = write_project(tmp_path)
    for file in ("picks.csv", "track.csv"):
        head, *rows = (tmp_path / file).read_text().splitlines()
        rows = [f"{int(float(row[0]))}.jpg,{row.partition(',')[2]}" for row in rows]
        head = head.replace("frame", "image").replace("t_s", "image")
        (tmp_path / file).write_text("\n".join([head, *rows]))
    project = read_project(str(path))
    assert corrected(name, project, flight_of(project)) == []


def test_each_landmark_that_is_picked_and_used_is_left_out_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The church is a check landmark, the barn is never picked; 5 of 30 picks are 150."""
    path = write_project(tmp_path, TOML + '[solve]\ncheck_landmarks = ["church"]\n')
    marks = tmp_path / "landmarks.csv"
    marks.write_text(marks.read_text() + "barn,47.6,16.4,400\n")
    project = read_project(str(path))
    flight = flight_of(project)
    assert flight.landmarks.used == (False, *[True] * 6)
    found = corrected("a wrong landmark", project, flight)
    assert [one.landmarks.used for one, _ in found] == [
        (False, *(k != left for k in range(1, 6)), True) for left in range(1, 6)
    ]
    names = [advice.partition(":")[0] for _, advice in found]
    assert names == [f"without {name}" for name in ("mast", "bridge", "corner", "tower", "well")]
    assert mistakes.TRIAL_PICKS == 100_000
    monkeypatch.setattr(mistakes, "TRIAL_PICKS", 150)
    assert len(corrected("a wrong landmark", project, flight)) == 5
    monkeypatch.setattr(mistakes, "TRIAL_PICKS", 149)
    assert corrected("a wrong landmark", project, flight) == []


# Which mistake is named


HELD = FlightOptions(solve_position=False)


def noisy(scale: float, counts: tuple[int, ...] = (5,) * 6) -> FlightResult:
    """A flight whose errors of picks are so many times the same ones."""
    flight = uneven_flight(counts)
    flight = replace(flight, path=replace(flight.path, lever_arm_m=None), options=HELD)
    exact = uneven_flight(counts, noise_px=0.0).picks.pixel
    pixel = exact + scale * (flight.picks.pixel - exact)
    return solve_flight_read(replace(flight, picks=replace(flight.picks, pixel=pixel)))


def with_sigma(result: FlightResult, sigma_px: Floats) -> Any:
    """The same with other standard deviations, for `usual_mistakes`."""
    picks = replace(result.flight.picks, sigma_px=sigma_px)
    return SimpleNamespace(
        flight=replace(result.flight, picks=picks), joint=result.estimates.joint,
        whole=lambda: result.estimate,
    )  # fmt: skip


def typical(result: FlightResult) -> float:
    return typical_px(result.flight, result.estimate)


def told(
    monkeypatch: pytest.MonkeyPatch, estimates: Any, changes: list[tuple[Flight, str]]
) -> list[str]:
    table = [
        Mistake(advice, lambda *_, one=one: [(one, ())], advice)  # type: ignore[misc]
        for one, advice in changes
    ]
    monkeypatch.setattr(mistakes, "AXES_MISTAKES", ())
    monkeypatch.setattr(mistakes, "USUAL_MISTAKES", table)
    return [*usual_mistakes(ANY, estimates)]


@pytest.mark.parametrize(("sigmas", "named"), [(1.99, False), (2.01, True)])
def test_mistakes_are_tried_from_twice_the_usual_sigma_on(
    sigmas: float, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The usual sigma is that of the median pick."""
    result, good = noisy(8.0), noisy(0.1).flight
    sigma = np.full(30, typical(result) / sigmas)
    sigma[:14] *= 9.0
    said = told(monkeypatch, with_sigma(result, sigma), [(good, "that")])
    assert [one.endswith(" px that") for one in said] == [True] * named


@pytest.mark.parametrize(("times", "named"), [(4.98, False), (5.02, True)])
def test_a_mistake_is_named_where_residuals_are_a_fifth_without_it(
    times: float, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = with_sigma(noisy(1.0), np.full(30, 0.01))
    tried = [(noisy(2.0).flight, "this"), (noisy(1.0 / times).flight, "that")]
    (said,) = told(monkeypatch, result, tried)
    assert said.endswith(" px that") == named
    assert ("no usual mistake explains them" in said) != named


@pytest.mark.parametrize(("sigmas", "named"), [(4.99, False), (5.01, True)])
def test_residuals_are_unexplained_from_five_sigmas_on(
    sigmas: float, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = noisy(8.0)
    said = told(monkeypatch, with_sigma(result, np.full(30, typical(result) / sigmas)), [])
    assert len(said) == named


@pytest.mark.parametrize(("frames", "tried"), [(3, False), (4, True)])
def test_mistakes_are_tried_from_four_residuals_more_than_angles_on(
    frames: int, tried: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A frame with two picks has one; a trial with fewer explains nothing."""
    result = noisy(8.0, (2,) * frames)
    small = with_sigma(result, np.full(2 * frames, 1e-3))
    said = told(monkeypatch, small, [(noisy(0.1, (2,) * 4).flight, "that")])
    assert any(one.endswith(" px that") for one in said) == tried
    said = told(monkeypatch, small, [(noisy(0.1, (2,) * 3).flight, "that")])
    assert not any(one.endswith(" px that") for one in said)


# Other clocks by which a track covers frames


@pytest.mark.parametrize("own", [None, 0.0, 5, -40.0])
@pytest.mark.parametrize(
    ("ahead_s", "hint", "year"),
    [(18.0, "-18", 2026), (-18.0, "+18", 2026), (25.0, "", 2026), (0.0, "", 2026),
     (16.0, "-16", 2014), (-16.0, "+16", 2014), (18.0, "", 2005)],
)  # fmt: skip
def test_another_clock_is_tried_on_top_of_the_offset_of_the_project(
    own: float | None, ahead_s: float, hint: str, year: int, tmp_path: Path
) -> None:
    """Times of the track are later by `ahead_s` than they should be with the project's offset."""
    toml = TOML.replace("2026-05-01", f"{year}-05-01")
    path = write_project(tmp_path, toml + ("" if own is None else f"offset_s = {own}\n"))
    head, *rows = (tmp_path / "track.csv").read_text().splitlines()
    cells = [row.partition(",") for row in rows]
    late = [f"{float(one) + ahead_s - (own or 0.0)},{rest}" for one, _, rest in cells]
    (tmp_path / "track.csv").write_text("\n".join([head, *late]))
    if ahead_s:
        with refused(VopdError):
            read_flight(str(path))
        assert f"track {hint} s" in other_clock(read_project(str(path))) or not hint
        assert bool(other_clock(read_project(str(path)))) == bool(hint)
    else:
        assert len(read_flight(str(path)).frame) == 5
    assert other_clock(Project("p.toml", tmp_path, {})) == ""


def test_an_offset_that_is_no_number_has_no_other_clock(tmp_path: Path) -> None:
    with refused(VopdError):
        other_clock(read_project(str(write_project(tmp_path, TOML + 'offset_s = "2"\n'))))
