"""The configurations in which coverage is counted, one a row of the tables of docs/coverage.md.

A row is counted with 2, 3, 4, 6 and 12 landmarks in a frame. The noise of the readings is
.012 in, .005 mm on the film for the mean of three, unless a row says otherwise.
"""

from __future__ import annotations

from typing import NamedTuple

from tests.kit.coverage_count import Count, count, solved
from tests.kit.film_earths import SPHERE_1974, WGS84, WGS84_CENTRAL
from tests.kit.simulated_films import Errors, Plan, simulate

LANDMARKS = (2, 3, 4, 6, 12)
READINGS = Errors(reading_in=0.012)
ALL = Errors(0.012, 0.02, 3.0, 60.0, 60.0, 0.02, 0.1, 5.0, 5.0)


class Row(NamedTuple):
    """A configuration: the films, and how they are solved."""

    name: str
    plan: Plan
    fixes: tuple[str, ...] = ("all",)
    reading: bool = False  # whether the sigma of the readings is stated, or estimated
    cards: bool = False  # whether the jobs go through cards


def _plan(errors: Errors, **changes: object) -> Plan:
    """Few jobs of many frames, or many of few where an error is common to a job."""
    e = errors
    common = any((e.landmark_ft, e.focal_mm, e.time_s, e.wind_ft_s, e.mount_deg))
    size = {"jobs": 150, "frames": 12} if common else {"jobs": 40, "frames": 50}
    return Plan(errors)._replace(**(size | changes))


POLE = {"pitch_deg": (-92.0, -88.0)}
WRAPS = {"yaw_deg": (-0.05, 0.05), "roll_deg": (-0.05, 0.05), "jitter_deg": (0.01, 2.0, 0.01)}
REST = {"jitter_deg": (0.1, 0.1, 0.1)}
ONE_FRAME = {"jobs": 500, "frames": 1}
IDENTIFIED = READINGS._replace(identification_mm=0.05)

ROWS = (
    Row("readings", _plan(READINGS)),
    Row("readings, sigma given", _plan(READINGS), reading=True),
    Row("readings, poor geometry", _plan(READINGS, poor=True)),
    Row("readings, poor geometry, sigma given", _plan(READINGS, poor=True), reading=True),
    Row("readings, through cards", _plan(READINGS), cards=True),
    Row("readings of .001 in, not rounded", _plan(Errors(reading_in=0.001), decimals=None)),
    Row("readings, one frame a job", _plan(READINGS, **ONE_FRAME)),
    Row("readings, camera pitch within 2 degrees of -90", _plan(READINGS, **POLE)),
    Row("readings, yaw and roll across 0", _plan(READINGS, **WRAPS)),
    Row("readings, faithful run, truth on the sphere of 1974",
        _plan(READINGS, earth=SPHERE_1974), ()),
    Row("identification .05 mm", _plan(IDENTIFIED)),
    Row("identification .05 mm, sigma given", _plan(IDENTIFIED), reading=True),
    Row("identification .05 mm, poor geometry", _plan(IDENTIFIED, poor=True)),
    Row("identification .05 mm, readings of .003 in",
        _plan(IDENTIFIED._replace(reading_in=0.003))),
    Row("identification .05 mm, one frame a job", _plan(IDENTIFIED, **ONE_FRAME)),
    Row("fiducials three times noisier", _plan(READINGS._replace(fiducial_factor=3.0))),
    Row("fiducials three times noisier, sigmas given",
        _plan(READINGS._replace(fiducial_factor=3.0)), reading=True),
    Row("landmarks 100 ft", _plan(READINGS._replace(landmark_ft=100.0))),
    Row("landmarks 100 ft, reading sigma given",
        _plan(READINGS._replace(landmark_ft=100.0)), reading=True),
    Row("landmarks 100 ft, camera at rest",
        _plan(READINGS._replace(landmark_ft=100.0), **REST)),
    Row("positions 100 ft", _plan(READINGS._replace(position_ft=100.0))),
    Row("focal length .05 mm", _plan(READINGS._replace(focal_mm=0.05))),
    Row("time .2 s", _plan(READINGS._replace(time_s=0.2))),
    Row("velocity 10 ft/s", _plan(READINGS._replace(velocity_ft_s=10.0))),
    Row("wind 10 ft/s", _plan(READINGS._replace(wind_ft_s=10.0))),
    Row("velocity 10 ft/s, eta below .2 degree",
        _plan(READINGS._replace(velocity_ft_s=10.0), eta_deg=(0.0, 0.1),
              jitter_deg=(0.05, 0.05, 0.05), acceleration_ft_s2=0.0)),
    Row("mounting .1 degree", _plan(READINGS._replace(mount_deg=0.1))),
    Row("all together", _plan(ALL)),
    Row("all together, camera at rest", _plan(ALL, **REST)),
    Row("all together, reading sigma given", _plan(ALL), reading=True),
    Row("all together, poor geometry", _plan(ALL, poor=True)),
    Row("all together, through cards", _plan(ALL), cards=True),
    Row("all together, camera pitch within 2 degrees of -90", _plan(ALL, **POLE)),
    Row("all together, yaw and roll across 0", _plan(ALL, **WRAPS)),
    Row("all together, faithful run, truth on the sphere of 1974",
        _plan(ALL, earth=SPHERE_1974), ()),
    Row("faithful run, truth on WGS 84", _plan(READINGS, earth=WGS84), ()),
    Row("faithful run, truth on WGS 84, geocentric vertical",
        _plan(READINGS, earth=WGS84_CENTRAL), ()),
)  # fmt: skip


def counted(row: Row, landmarks: int, seed: int, jobs: int | None = None) -> Count:
    """Count a cell of the table.

    Args:
        row: the configuration
        landmarks: in a frame
        seed: of the random numbers
        jobs: how many, in the place of the row's
    """
    plan = row.plan._replace(landmarks=landmarks, jobs=jobs or row.plan.jobs)
    films = simulate(plan, seed)
    return count(solved(films, row.fixes, row.reading, row.cards), films.truth_deg)
