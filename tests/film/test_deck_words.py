"""What tables, files, pictures and the report say of a deck's results, sentence by sentence."""

from __future__ import annotations

import pytest

from vopd.film import DECK_WORDS

SENTENCES = {
    "source": "deck",
    "no_fixes": "none; these are the original's numbers",
    "surface": "on the film",
    "centre": "centre of the frame",
    "landmark": "its number in group 9",
    "reading": "a landmark's film coordinate",
    "repeated": "by its three readings",
    "vertical": (
        "whether group 7's X, Y, Z, and with them these angles, refer to one or the other depends "
        "on the deck's maker, and no card says it"
    ),
    "own_position": "where the deck's own coordinates put it on WGS 84 (--fix earth puts it there)",
}
COLUMNS = {
    "deck": "the deck's file",
    "job": "the job's number in its deck, from 1",
    "time_s": "flight time",
    "camera_yaw_deg": "SIG1, 0 to 360",
    "camera_pitch_deg": "SIG2, -180 to 180",
    "camera_roll_deg": "SIG3, 0 to 360",
    "vehicle_yaw_deg": "PSI, 0 to 360",
    "vehicle_pitch_deg": "THETA, -180 to 180",
    "vehicle_roll_deg": "PHI, 0 to 360",
    "alpha_deg": "ALPHA, angle of attack in pitch",
    "beta_deg": "BETA, angle of attack in yaw",
    "eta_deg": "ETA, total angle of attack, 0 to 180",
    "vehicle_east_ft": "X, east of group 8's origin",
    "vehicle_north_ft": "Y, north of it",
    "vehicle_up_ft": "Z, up along its vertical",
    "latitude_deg": "of the vehicle, geodetic, as the deck's",
    "altitude_ft": "H, above sea level",
    "last_correction_rad": "the 22nd, largest of three",
}
FLAGS = {
    "not_converged": (
        "the 22nd correction exceeds 1e-6 rad or is not a number",
        "look at the readings and at group 8's first estimate; try --initial closed-form",
    ),
    "undetermined": (
        "fewer than two landmarks, or equations without a solution: the angles are one of "
        "many attitudes that fit; what is not known is named",
        "read more landmarks",
    ),
    "out_of_range": (
        "an angle of camera or vehicle is beyond a full circle: the solve diverged, or group 3 "
        "has a large multiplier or offset; the listing may have asterisks",
        "look at the readings, at group 3 and at group 8's first estimate",
    ),
    "behind_camera": (
        "a landmark lies behind the camera: the solve ended at the other solution",
        "try --initial closed-form",
    ),
    "two_landmarks": (
        "two landmarks only: one degree of freedom, and an exchanged pair cannot be seen",
        "read a third landmark",
    ),
    "weak_geometry": (
        "one rotation axis is determined 20 times worse than the best one (condition number); "
        "it is named",
        "read landmarks farther apart on the film",
    ),
    "outlier": (
        "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); "
        "it is named",
        "read it again, or ignore it (group 11 in one frame, group 12 in all)",
    ),
}
CONVENTIONS = {
    "camera angles": (
        "camera yaw of the optical axis clockwise from north, pitch above the horizontal, "
        "roll clockwise about the optical axis seen from behind (sigma 1, 2, 3 of "
        "NASA TM X-3050)"
    ),
    "position": (
        "longitude east, geodetic latitude as the deck has them; altitude above sea level, group 7"
    ),
    "time": "seconds of flight, group 6",
}


@pytest.mark.parametrize("name", SENTENCES)
def test_a_sentence(name: str) -> None:
    assert getattr(DECK_WORDS, name) == SENTENCES[name]


def test_columns_flags_and_conventions() -> None:
    """Meaning of every column; meaning and advice of every flag; what angles refer to."""
    assert DECK_WORDS.columns == COLUMNS
    assert DECK_WORDS.flags == FLAGS
    assert DECK_WORDS.conventions == CONVENTIONS
