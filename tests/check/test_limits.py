"""`vopd check` on either side of the limit of each rule, by numbers worked by hand."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.cards import CardEdit, landmarks_again, punch, punch_all, two_frames
from tests.kit.command import CASE_1, vopd
from tests.kit.jobs import film, reread
from vopd.cards.write import write_deck
from vopd.check import check_deck
from vopd.findings import Finding
from vopd.job import Job, Readings
from vopd.pipeline import read_deck

Deck = list[str]


def edited(*edits: CardEdit) -> Deck:
    """The clean deck of two frames with some cards punched anew."""
    cards = two_frames()
    for edit in edits:
        edit(cards)
    return cards


def of_job(job: Job) -> Deck:
    """The job as cards, its readings to a thousandth of an inch."""
    readings, camera = job.readings, job.camera
    tables = {
        name: getattr(camera, name).round(4) for name in ("lens_radius_mm", "lens_distortion_um")
    }
    points = {name: getattr(readings, name).round(3) for name in ("landmark_in", "fiducial_in")}
    exact = replace(job, readings=reread(readings, **points), camera=replace(camera, **tables))
    return write_deck([exact]).splitlines()


def overhead(altitude: str) -> Deck:
    """The last position is 140000 ft straight above the origin, which is at sea level."""
    return edited(
        punch(37, 11, "        0.        0.   140000."),
        punch(37, 71, altitude.rjust(10)),
        punch(38, 31, " 20925.698"),
    )


def rhombus(difference_in: float) -> Deck:
    """Fiducials right and left, above and below their centre: 5 in and 5 in less the difference."""
    near = 5.0 - difference_in
    corners = np.array([[12.0, 7.0], [2.0, 7.0], [7.0, 7.0 + near], [7.0, 7.0 - near]])
    blur = np.array([-0.001, 0.0, 0.001])[:, None]
    job = film(1)
    fiducial = (corners[:, None] + blur)[None]
    return of_job(replace(job, readings=reread(job.readings, fiducial_in=fiducial)))


def apart(dx: float, dy: float) -> Deck:
    """The first landmark of a film of copies, with one reading that is off by dx, dy inches."""
    job = film(1)
    middle = job.readings.landmark_in.mean(axis=2, keepdims=True).round(3)
    landmark = middle + np.array([-0.001, 0.0, 0.001])[:, None]
    landmark[0, 0] = middle[0, 0] + np.array([[0.0, 0.0], [0.0, 0.0], [dx, dy]])
    fiducial = job.readings.fiducial_in.round(3)
    return of_job(
        replace(job, readings=reread(job.readings, landmark_in=landmark, fiducial_in=fiducial))
    )


def lens_of(largest_mm: float, ignored: bool = False) -> Deck:
    """The outermost landmark is exactly 10 mm from the centre, and may be ignored."""
    job = film(1)
    centre = np.array([7.0, 5.0])
    away = np.array([[0.0, 10.0], [3.0, 0.0], [-3.0, 0.0], [0.0, -3.0], [3.0, 3.0]]) / MM_PER_INCH
    blur = np.array([-0.001, 0.0, 0.001])[:, None]
    corners = centre + np.array([[-5.0, -4.0], [5.0, -4.0], [5.0, 4.0], [-5.0, 4.0]])
    table = np.linspace(0.0, largest_mm, 25)
    out = job.ignored.everywhere.copy()
    out[0] = 11 if ignored else 0
    return of_job(
        replace(
            job,
            camera=replace(job.camera, lens_radius_mm=table, lens_distortion_um=0.0 * table),
            ignored=replace(job.ignored, everywhere=out),
            readings=reread(
                job.readings,
                landmark_in=((centre + away)[:, None] + blur)[None],
                fiducial_in=(corners[:, None] + blur)[None],
            ),
        )
    )


MM_PER_INCH = 0.713816400205


class Limit(NamedTuple):
    """A deck that is questioned, one that is just not, and the numbers said of the first."""

    beyond: Callable[[], Deck]
    within: Callable[[], Deck]
    numbers: tuple[str, ...]
    words: str  # that no finding about the second has
    options: tuple[str, ...] = ()


SPREAD = ("--spread", "0.02")
LIMITS = {
    "an altitude too high": Limit(
        lambda: overhead("140500.2"), lambda: overhead("140499.8"),
        ("140500.2", "140000.0"), "altitude",
    ),
    "an altitude too low": Limit(
        lambda: overhead("139499.8"), lambda: overhead("139500.2"),
        ("139499.8", "140000.0"), "altitude",
    ),
    "fiducials": Limit(
        lambda: rhombus(0.051), lambda: rhombus(0.049),
        ("1", "4.949", "5.000"),
        "rectangle",
    ),
    "readings in x": Limit(
        lambda: apart(0.021, 0.0), lambda: apart(0.02, 0.0),
        ("0.021", "0.020"), "differ by", SPREAD,
    ),
    "readings in y": Limit(
        lambda: apart(0.02, -0.021), lambda: apart(0.02, -0.02),
        ("0.021", "0.020"), "differ by", SPREAD,
    ),
    "the lens table": Limit(
        lambda: lens_of(9.99), lambda: lens_of(10.01),
        ("10.00",), "lens table",
    ),
    "an ignored landmark beyond the lens table": Limit(
        lambda: lens_of(9.99), lambda: lens_of(9.99, ignored=True),
        ("10.00",), "lens table",
    ),
    "frames in order": Limit(
        lambda: edited(punch_all(range(65, 86), 64, "0729")), lambda: edited(),
        ("729", "730"), "comes after",
    ),
    "signs": Limit(
        lambda: edited(punch(39, 21, "      -.01"), punch(39, 11, "        1.")),
        lambda: edited(punch(39, 21, "        0."), punch(39, 11, "       -1.")),
        ("-0.01", "1", "0.99983"), "differ in sign",
    ),
    "time table": Limit(
        lambda: edited(punch(33, 1, "  730")), lambda: edited(punch(33, 1, "  731")),
        ("731",), "extrapolated: frame",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_either_side_of_a_limit(name: str) -> None:
    """It is told once, beyond the limit, as a warning."""
    limit = LIMITS[name]

    def told(cards: Deck) -> list[str]:
        ran = vopd("check", "--format", "json", *limit.options, "-", stdin="\n".join(cards))
        (report,) = json.loads(ran.stdout)
        assert report["errors"] == [] and ran.status == 0
        messages = [one["message"] for one in report["warnings"]]
        return [one for one in messages if limit.words in one]

    (message,) = told(limit.beyond())
    assert_approved(message, parts=limit.numbers)
    assert told(limit.within()) == []


def test_the_axis_of_a_wide_reading() -> None:
    """Columns 41 to 47 of the card of the point's first reading are x, and 51 to 57 are y."""
    for deck, columns in ((apart(0.03, 0.025), (41, 47)), (apart(0.025, 0.03), (51, 57))):
        found = check_deck(io.BytesIO("\n".join(deck).encode()), "deck.dat", spread_in=0.02)
        assert [one.columns for one in found if "differ by 0.03" in one.message] == [columns]


def test_findings_come_in_the_order_of_the_cards() -> None:
    """And of one card in the order of its columns, whatever is found first."""
    cards = edited(
        punch(37, 71, "   151014 "),  # found while reading
        punch(56, 41, " 010200"),  # by the first rule
        punch(30, 1, "   141000."),
        punch(36, 1, "      70.3"),  # the table ends before the frames do
        punch(37, 1, "      70.5"),
        punch(32, 1, "   0 "),
    )
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck.dat")
    places = [(one.card, one.columns) for one in found]
    on_37 = [(37, (1, 10)), (37, (71, 80)), (37, (71, 80))]
    assert places == [(30, (1, 10)), (32, (1, 5)), *on_37, (56, (41, 47))]


def test_landmarks_of_an_earlier_job_are_not_questioned_again() -> None:
    """Landmark 68 is in no frame of the first job; the second does not give it again."""
    cards = landmarks_again(edited(punch(41, 9, "68"), punch_all(range(62, 65), 9, "66")))
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "deck.dat")
    assert [one.card for one in found if "is in no frame" in one.message] == [41]


# Rules that look at several frames or landmarks


(JOB,) = read_deck(CASE_1)
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
    deck = write_deck([job]).encode()
    return [one for one in check_deck(io.BytesIO(deck), "deck") if words in one.message]


ORDERS = (
    (3, 5, 7, 9),
    (3, 7, 5, 9),
    (3, 7, 5, 4),
    (9, 3, 5, 7),
    (3, 3, 5, 7),
    (5, 7, 5, 6),
    (3, 9, 3, 9),
)


@pytest.mark.parametrize("numbers", ORDERS)
def test_the_order_of_frames(numbers: tuple[int, ...]) -> None:
    """Each is compared with the one before it, and with all before it for its own number."""
    found = [one for words in ("comes after", "read before")
             for one in questioned(of_frames(*numbers), words)]  # fmt: skip
    said = {((one.card or 0) - CONTROL - 1) / FRAME: one.message for one in found}
    assert_approved(said)
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
    assert_approved([(one.card, one.message.partition(";")[0]) for one in found])


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
    assert_approved([one.message for one in found])
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
    deck = io.BytesIO(write_deck([job]).encode())
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
    assert_approved(found.message)


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
    assert_approved([one.message for one in found], parts=[f"{100000.0 + above_ft:.1f}"])
    assert [(one.card, one.columns) for one in found] == [(36, (71, 80)), (37, (71, 80))]
