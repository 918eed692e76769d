"""Rules that look at several frames or landmarks, by films of case 1 whose numbers are by hand."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1
from tests.kit.jobs import reread
from vopd.check import check_deck
from vopd.findings import Finding
from vopd.job import Job, Readings

(JOB,) = vopd.read_deck(CASE_1)
CONTROL, FRAME = 43, 21
"""Cards of groups 1 to 12 where group 5 takes one card, and of a frame with three landmarks."""


def of_frames(*numbers: int) -> Job:
    """Case 1 with its frame so many times, by these numbers; its landmarks are 65, 66, 67."""
    r = JOB.readings
    arrays = (r.fiducial_in, r.landmark, r.present, r.landmark_in)
    count = len(numbers)
    return replace(
        JOB, readings=Readings.of(np.array(numbers), *(np.repeat(a, count, axis=0) for a in arrays))
    )


def questioned(job: Job, words: str) -> list[Finding]:
    """The findings with these words."""
    deck = vopd.write_deck([job]).encode()
    return [one for one in check_deck(io.BytesIO(deck), "deck") if words in one.message]


ORDERS = {  # numbers of frames: what is said, by the frame's index
    (3, 5, 7, 9): {},
    (3, 7, 5, 9): {2: "frame 5 comes after frame 7"},
    (3, 7, 5, 4): {2: "frame 5 comes after frame 7", 3: "frame 4 comes after frame 5"},
    (9, 3, 5, 7): {1: "frame 3 comes after frame 9"},
    (3, 3, 5, 7): {1: "frame 3 has been read before"},
    (5, 7, 5, 6): {2: "frame 5 has been read before"},
    (3, 9, 3, 9): {2: "frame 3 has been read before", 3: "frame 9 has been read before"},
}


@pytest.mark.parametrize("numbers", ORDERS)
def test_the_order_of_frames(numbers: tuple[int, ...]) -> None:
    """Each is compared with the one before it, and with all before it for its own number."""
    found = [one for words in ("comes after", "read before")
             for one in questioned(of_frames(*numbers), words)]  # fmt: skip
    said = {((one.card or 0) - CONTROL - 1) / FRAME: one.message for one in found}
    assert said == ORDERS[numbers]
    assert all(one.severity == "warning" and one.columns == (64, 67) for one in found)


@pytest.mark.parametrize(
    ("out", "all_of_them"),
    [((), False), ((65,), False), ((65, 66), False), ((65, 66, 67), True), ((65, 65, 66), False)],
)
def test_when_every_landmark_is_to_be_ignored(out: tuple[int, ...], all_of_them: bool) -> None:
    everywhere = np.array([*out, 0, 0, 0][:3])
    job = replace(JOB, ignored=replace(JOB.ignored, everywhere=everywhere))
    found = questioned(job, "every landmark is to be ignored: the last two of each frame are kept")
    assert [(one.card, one.group, one.columns) for one in found] == (
        [(CONTROL, 12, (6, 10))] if all_of_them else []
    )


def test_each_frame_with_one_landmark_is_named() -> None:
    job = of_frames(5, 6, 7)
    landmark = job.readings.landmark.copy()
    landmark[0], landmark[2] = 66, 67
    found = questioned(replace(job, readings=reread(job.readings, landmark=landmark)), "has only")
    assert [(one.card, one.message.partition(";")[0]) for one in found] == [
        (CONTROL + 1, "frame 5 has only landmark 66"),
        (CONTROL + 1 + 2 * FRAME, "frame 7 has only landmark 67"),
    ]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_each_unused_landmark_is_named_at_its_card(count: int) -> None:
    """Group 9 has cards 39 to 41."""
    number = JOB.landmarks.number.copy()
    number[-count:] = 90 + np.arange(count)
    used = JOB.readings.landmark.copy()
    used[used >= 65] = 65
    job = replace(
        JOB,
        landmarks=replace(JOB.landmarks, number=number),
        readings=reread(JOB.readings, landmark=used),
    )
    found = questioned(job, "is in no frame")
    unused = [n for n in number.tolist() if n != 65]
    assert [one.message for one in found] == [f"landmark {n} is in no frame" for n in unused]
    assert [one.card for one in found] == [39 + number.tolist().index(n) for n in unused]


@pytest.mark.parametrize("point", range(7))
@pytest.mark.parametrize("frame", [0, 1, 2])
def test_the_card_of_every_point_that_is_read_too_far_apart(frame: int, point: int) -> None:
    """That of its first reading: three cards a point, and four fiducials before the landmarks."""
    job = of_frames(5, 6, 7)
    fiducial, landmark = (
        np.tile(a[:, :, :1], (1, 1, 3, 1))
        for a in (job.readings.fiducial_in, job.readings.landmark_in)
    )
    spoiled, index = (fiducial, point) if point < 4 else (landmark, point - 4)
    spoiled[frame, index, 2, 1] = round(spoiled[frame, index, 2, 1] + 0.3, 3)
    job = replace(job, readings=reread(job.readings, fiducial_in=fiducial, landmark_in=landmark))
    (found,) = questioned(job, "three readings of this point differ by 0.300 in")
    assert (found.card, found.columns) == (CONTROL + 1 + FRAME * frame + 3 * point, (51, 57))


@pytest.mark.parametrize(("spread_in", "told"), [(None, 0), (0.0119, 7), (0.0121, 0), (0.0, 7)])
def test_the_limit_of_the_spread_is_that_of_the_deck_or_the_given_one(
    spread_in: float | None, told: int
) -> None:
    """All seven points are read .006 in either side of the middle: so noisy is this reader."""
    blur = np.array([-0.006, 0.0, 0.006])[:, None]
    middle = {
        name: getattr(JOB.readings, name)[:, :, 1:2] + blur
        for name in ("fiducial_in", "landmark_in")
    }
    job = replace(JOB, readings=reread(JOB.readings, **{k: v.round(3) for k, v in middle.items()}))
    deck = io.BytesIO(vopd.write_deck([job]).encode())
    asked = {} if spread_in is None else {"spread_in": spread_in}
    found = [one for one in check_deck(deck, "deck", **asked) if "differ by" in one.message]
    assert len(found) == told
    limit = f"(limit {spread_in or 0.0:.3f} in)"
    assert all(one.message.endswith(f"differ by 0.012 in {limit}") for one in found)


def test_corners_are_compared_by_their_distance() -> None:
    """Two opposite corners at 7 and 5.1, the others at 7 and 5: the roots of 75.01 and of 74."""
    corners = np.array([[7.0, 5.1], [-7.0, 5.0], [-7.0, -5.1], [7.0, -5.0]]) + 9.0
    fiducial = np.repeat(corners[None, :, None], 3, axis=2).round(3)
    job = replace(JOB, readings=reread(JOB.readings, fiducial_in=fiducial))
    (found,) = questioned(job, "form no rectangle")
    assert found.message == (
        "the fiducials of frame 730 form no rectangle: 8.602 to 8.661 in from their centre"
    )


@pytest.mark.parametrize("above_ft", [-1000.0, 0.0, 2000.0])
def test_altitudes_above_the_sea_and_positions_above_the_origin(above_ft: float) -> None:
    """The origin is so many feet above sea level, and every point 100000 ft straight above it."""
    path = JOB.trajectory
    high = replace(
        path,
        position_ft=np.array([[0.0, 0.0, 100000.0]] * 4),
        altitude_ft=np.array([100000.0, 100499.0, 100501.0, 99499.0]) + above_ft,
        origin_radius_kft=20925.698 + above_ft / 1000.0,
    )
    found = questioned(replace(JOB, trajectory=high), "X, Y, Z give")
    assert [one.message for one in found] == [
        f"altitude {altitude + above_ft:.1f} ft; "
        f"X, Y, Z give {100000.0 + above_ft:.1f} ft on a spherical Earth"
        for altitude in (100501.0, 99499.0)
    ]
    assert [(one.card, one.columns) for one in found] == [(36, (71, 80)), (37, (71, 80))]
