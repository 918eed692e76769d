"""`vopd check` on either side of the limit of each rule, by numbers worked by hand."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from tests.kit.cards import CardEdit, landmarks_again, punch, punch_all, two_frames
from tests.kit.command import vopd
from tests.kit.jobs import film, reread
from vopd.cards.write import write_deck
from vopd.check import check_deck
from vopd.job import Job

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
    """A deck that is questioned, one that is just not, and what is said of the first."""

    beyond: Callable[[], Deck]
    within: Callable[[], Deck]
    message: str
    words: str  # that no finding about the second has
    options: tuple[str, ...] = ()


SPREAD = ("--spread", "0.02")
LIMITS = {
    "an altitude too high": Limit(
        lambda: overhead("140500.2"), lambda: overhead("140499.8"),
        "altitude 140500.2 ft; X, Y, Z give 140000.0 ft on a spherical Earth", "altitude",
    ),
    "an altitude too low": Limit(
        lambda: overhead("139499.8"), lambda: overhead("139500.2"),
        "altitude 139499.8 ft; X, Y, Z give 140000.0 ft on a spherical Earth", "altitude",
    ),
    "fiducials": Limit(
        lambda: rhombus(0.051), lambda: rhombus(0.049),
        "the fiducials of frame 1 form no rectangle: 4.949 to 5.000 in from their centre",
        "rectangle",
    ),
    "readings in x": Limit(
        lambda: apart(0.021, 0.0), lambda: apart(0.02, 0.0),
        "three readings of this point differ by 0.021 in (limit 0.020 in)", "differ by", SPREAD,
    ),
    "readings in y": Limit(
        lambda: apart(0.02, -0.021), lambda: apart(0.02, -0.02),
        "three readings of this point differ by 0.021 in (limit 0.020 in)", "differ by", SPREAD,
    ),
    "the lens table": Limit(
        lambda: lens_of(9.99), lambda: lens_of(10.01),
        "a landmark is 10.00 mm from the centre: the lens table is extrapolated", "lens table",
    ),
    "an ignored landmark beyond the lens table": Limit(
        lambda: lens_of(9.99), lambda: lens_of(9.99, ignored=True),
        "a landmark is 10.00 mm from the centre", "lens table",
    ),
    "frames in order": Limit(
        lambda: edited(punch_all(range(65, 86), 64, "0729")), lambda: edited(),
        "frame 729 comes after frame 730", "comes after",
    ),
    "signs": Limit(
        lambda: edited(punch(39, 21, "      -.01"), punch(39, 11, "        1.")),
        lambda: edited(punch(39, 21, "        0."), punch(39, 11, "       -1.")),
        "minutes -0.01 and degrees 1 differ in sign: read as 0.99983", "differ in sign",
    ),
    "time table": Limit(
        lambda: edited(punch(33, 1, "  730")), lambda: edited(punch(33, 1, "  731")),
        "frame is outside this table, which is extrapolated: frame 731", "extrapolated: frame",
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
    assert limit.message in message
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
