"""Every statement that a file makes about its numbers, in full, and what it depends on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, WORDS, estimate, position
from vopd.attitude.conventions import conventions, reading_sigma_text
from vopd.attitude.history import History, history
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.version import __version__

ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))
SIGMAS = (
    "one standard deviation, degrees; infinite where the landmarks do not determine the angle, "
    "missing where a frame has no attitude; components: reading"
)
GENERAL = {
    "program": f"vopd {__version__}",
    "flight": "hand.toml",
    "from frame": "north, east, down at the vehicle; down along the ellipsoid's normal",
    "vertical": "geodetic; geodetic and geocentric vertical are up to 0.190 degree apart here",
    "to frame": "vehicle body: x forward, y right, z down",
    "sequence": (
        "intrinsic z-y-x: yaw about down, then pitch about the new right, then roll about the new "
        "forward; right-handed"
    ),
    "quaternion": (
        "scalar first (w x y z), w >= 0; it is the rotation that carries the axes north, east, "
        "down into forward, right, down of the vehicle; rotating a vector's components in the body "
        "by it gives its components in north, east, down"
    ),
    "camera angles": (
        "camera yaw of the optical axis clockwise from north, pitch above the horizontal, roll "
        "clockwise about the optical axis seen from behind"
    ),
    "ranges": "yaw and roll 0 to 360, pitch -180 to 180, alpha and beta -180 to 180, eta 0 to 180",
    "angles of attack": (
        "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w in the body"
    ),
    "position": "longitude east, geodetic latitude, WGS 84; altitude above the ellipsoid",
    "time": "seconds, of the source's own clock",
    "sigmas": SIGMAS,
    "intervals": (
        "95 %; half_width_95 is half the width of an angle's interval; that of eta, which cannot "
        "be below 0, goes from eta_low_95 to eta_high_95"
    ),
    "covariance": (
        "of small turns of the vehicle about its forward, right and down axes, degrees squared"
    ),
    "common errors": "none: the errors of every component differ from frame to frame",
    "reading sigma": "job 1: 0.25 px, as given, 0.5 times the spread of repeated readings",
}


def made(
    sigmas: Sigmas | None = None, words: dict[str, Any] | None = None, **changes: Any
) -> History:
    """Two frames with a reading sigma of .25 px, and repeated readings of .5 px."""
    about = ABOUT._replace(words=replace(WORDS, **(words or {})))
    of_about = {name: changes.pop(name) for name in about._fields if name in changes}
    e = estimate(ANGLES, about=about._replace(**of_about), reading_spread=0.5, **changes)
    return history(e, sigmas=sigmas or Sigmas(reading=0.25))


def changed(*several: History) -> dict[str, str]:
    """The statements that differ from those of the usual job."""
    found = conventions(several)
    assert set(GENERAL) <= set(found)
    return {name: text for name, text in found.items() if GENERAL.get(name) != text}


def test_every_statement_about_a_usual_job() -> None:
    assert_approved(conventions([made()]))
    assert [*conventions([made()])] == [*GENERAL]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"words": {"no_fixes": "none"}}, {"fixes": "none"}),
        ({"words": {"no_fixes": "none"}, "fixes": "restart"}, {"fixes": "restart"}),
        ({"fixes": "earth (WGS 84)"}, {"fixes": "earth (WGS 84)"}),
        ({"words": {"conventions": {"time": "s", "position": "here"}}},
         {"time": "s", "position": "here"}),
        ({"words": {"conventions": {"time": "", "more": "said"}}}, {"more": "said"}),
        ({"words": {"vertical": "open"}}, {"vertical": GENERAL["vertical"] + "; open"}),
        ({"down": "to the centre"},
         {"from frame": "north, east, down at the vehicle; down to the centre"}),
        ({"source": "b.toml"}, {"flight": "b.toml"}),
        ({"job": 3}, {"reading sigma": GENERAL["reading sigma"].replace("job 1", "job 3")}),
    ],
)  # fmt: skip
def test_what_a_source_says_otherwise(changes: dict[str, Any], said: dict[str, str]) -> None:
    if said == {"more": "said"}:  # an empty statement is none
        found = conventions([made(**changes)])
        assert_approved(found)
    else:
        assert_approved(changed(made(**changes)))


def test_the_lean_between_the_verticals_is_the_largest_of_all_jobs() -> None:
    place = position(2)
    away = {
        lean: made(
            position=replace(
                place, geocentric_latitude_deg=place.latitude_deg - np.array([lean, np.nan])
            )
        )
        for lean in (0.0, 0.05, 0.1239, -0.15)
    }  # fmt: skip
    assert_approved(changed(away[0.05]))
    assert_approved(conventions([away[-0.15], away[0.05]])["vertical"])
    assert_approved(conventions([away[0.05], away[0.1239]])["vertical"])
    assert conventions([away[0.0]])["vertical"] == "geodetic"
    known = made(position=replace(place, largest_lean_deg=0.175))
    assert_approved(changed(known))
    other = made(position=replace(place, vertical="geocentric"))
    assert_approved(changed(other))
    none = position(0)
    empty = [made(), made()]
    object.__setattr__(empty[1].estimate, "position", none)
    assert_approved(conventions(empty)["vertical"])
    assert conventions(empty[1:])["vertical"] == "geodetic"


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ([(0, 0, 0.25)], "0.250 degree (camera_yaw)"),
        ([(1, 1, -0.3)], "0.300 degree (camera_pitch)"),
        ([(1, 2, 0.3), (0, 5, -0.4004)], "0.400 degree (vehicle_roll)"),
        ([(0, 3, 0.1), (0, 8, 0.9)], "0.100 degree (vehicle_yaw)"),
        ([(0, 4, 0.1), (1, 5, np.nan)], "0.100 degree (vehicle_pitch)"),
    ],
)  # fmt: skip
def test_the_largest_effect_of_the_errata(effects: list[tuple[int, int, float]], said: str) -> None:
    """Of camera and vehicle, in any frame of any job; not of the angles of attack."""
    jobs = [np.zeros((2, 9)), np.zeros((2, 9))]
    for k, (frame, angle, size) in enumerate(effects):
        jobs[k][frame, angle] = size
    several = [made(slip_effect_deg=jobs[0]), made(slip_effect_deg=jobs[1]), made()]
    assert_approved(conventions(several)["sigmas"], parts=[said])
    assert_approved(conventions(several[::-1])["sigmas"], parts=[said])


def test_components_of_all_jobs_are_named_once() -> None:
    one = made(Sigmas(reading=0.25, position=1.0, focal_length=0.1))
    other = made(Sigmas(reading=0.25, position=1.0, landmark=2.0, time_s=0.1))
    found = changed(made(), one, other)
    assert_approved(found["sigmas"])
    assert_approved(found["common errors"])


def scaled(**changes: Any) -> History:
    """A job with such a reading sigma."""
    one = made()
    scale = replace(JobReadingSigma(0.25, np.inf, "given", np.ones(2), 0.25), **changes)
    return replace(one, uncertainty=replace(one.uncertainty, reading=scale))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, "0.25 px, as given, 0.5 times the spread of repeated readings"),
        ({"sigma": 0.0}, "0 px, as given"),
        ({"sigma": 0.123456}, "0.123 px, as given, 0.247 times the spread of repeated readings"),
        ({"freedom": 12.34},
         "0.25 px, as given, 12.3 degrees of freedom, 0.5 times the spread of repeated readings"),
        ({"sigma": 0.0, "source": "residuals"}, "0 px, from the residuals of all frames"),
        ({"sigma": 0.0, "source": "sample"}, "0 px, from the residuals of a sample of the frames"),
        ({"sigma": 0.0, "source": "repeated"},
         "0 px, from repeated readings, which is more than the residuals show"),
        ({"sigma": 0.0, "source": "resolution"},
         "0 px, from the resolution of the readings, which is more than the residuals show"),
    ],
)  # fmt: skip
def test_every_source_of_a_reading_sigma(changes: dict[str, Any], said: str) -> None:
    assert_approved(reading_sigma_text(scaled(**changes)))
    assert changed(scaled(**changes)).get("reading sigma", f"job 1: {said}") == f"job 1: {said}"


@pytest.mark.parametrize("count", [1, 8, 9, 12])
def test_reading_sigmas_of_the_first_eight_jobs_are_stated(count: int) -> None:
    for sources in ("a", "ab"):
        jobs = [made(source=sources[k % len(sources)], job=k + 1) for k in range(count)]
        if len(sources) == 2 and count == 1:
            continue
        assert_approved(conventions(jobs)["reading sigma"])
