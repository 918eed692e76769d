"""The report's search for a feature's coordinates: stacked jobs of trial coordinates.

Source: TM X-3050, "Landmark selection". A series of latitudes is run about an estimate; the
vehicle's angles are compared with those from the known landmarks alone, and the best latitude is
kept. Longitudes follow at that latitude, then altitudes, and all again until they stand.

Two things are added to it. Angles are compared in standard deviations of their differences, so
that a direction in which the known landmarks tell little counts little. And each round ends with a
trial in which all three move together, to where the slopes of the angles in its series lead: where
latitude, longitude and altitude trade with each other, as they do when all frames look from nearly
one direction, the report's rounds would close in by a part in thousands each.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.convert.feature import (
    NAMES,
    along_one_line,
    by_position,
    check_feature,
    coordinates_of,
    frames_that_locate,
    ignoring,
    place_m,
    with_coordinates,
)
from vopd.errata import Fixes
from vopd.findings import VopdError, count_text
from vopd.geometry.earth import M_PER_KM
from vopd.geometry.rotations import (
    camera_axes,
    from_axes,
    partials_by_turns,
    rotation_vectors_deg,
)
from vopd.job import Job
from vopd.program.constants import factor
from vopd.program.positions import earth_fixed, origin_of
from vopd.program.vopd import run_jobs
from vopd.results import Results

SIDE = 4  # trials on either side of the estimate
FIRST_STEP = np.array([0.1 / 60.0, 0.1 / 60.0, 500.0])  # .1 minute is 600 ft
LAST_STEP = np.array([1e-3 / 60.0, 1e-3 / 60.0, 10.0])
FINER = 4.0  # times, from round to round
STANDS = 0.1  # of the last step: a round that moves less ends the search
MOST_SERIES = 12  # of one coordinate, each about the end of the one before
MOST_ROUNDS = 20
READING_IN = 0.003  # of the film reader, as in vopd demo
FARTHEST = 0.5  # of the distance, by which a reading may leave a feature free
MOST_STEPS = 8.0  # steps that all three together move at most
AGAIN_AT_GROUP_9, END = 9, 13  # NGO
NOWHERE = np.full(3, np.nan)
KNOWN, TOGETHER, FOUND = "known landmarks", "all three", "found"


class Trial(NamedTuple):
    """One job of the stack: the coordinates of the feature, and how the angles differ there."""

    job: int  # its number in the stack, from 1
    round: int  # from 1; 0 before the first
    varied: str  # latitude, longitude, altitude, all three; known landmarks; found
    coordinates: Floats  # (3,) latitude, longitude, degrees, altitude, feet; NaN: not used
    difference_deg: Floats  # (3,) of the vehicle's yaw, pitch, roll, root mean square over frames
    apart_in: float  # the differences as a shift of the feature's image, on the film reader
    best: bool  # of its series


class FeatureTrials(NamedTuple):
    """A search by trial coordinates."""

    # the stack; the first has the known landmarks alone, the last the feature as found
    jobs: list[Job]
    trials: list[Trial]  # what each of them shows
    coordinates: Floats  # of the feature as found, (3,)
    last_step: Floats  # between the trials of the last round, (3,)
    frames: int  # how many were compared
    stands: bool  # whether the last round moved none of the coordinates


def search_feature(
    job: Job,
    number: int,
    fixes: Fixes,
    name: str = "",
    on_jobs: Callable[[int], object] = lambda _: None,
) -> FeatureTrials:
    """Search the coordinates of a landmark by trials, from those of its card.

    Args:
        job: of the deck
        number: of the landmark
        fixes: errata that are corrected in all jobs
        name: of the deck, for messages
        on_jobs: is called with the number of jobs after each series

    Raises:
        VopdError: if the landmark is not on the cards once, its frames do not locate it, or a job
            cannot be run
    """
    check_feature(job, number, name)
    compared = frames_that_locate(job, number)[1]
    if compared.sum() < 2:
        raise VopdError(
            f"{name}: {count_text(int(compared.sum()), 'frame')} of landmark {number} with two "
            "known landmarks beside it, by which the attitude is known without it; trials need two "
            "such frames, from different places: read more, or ignore fewer landmarks in groups 11 "
            "and 12"
        )
    search = _Search(job, number, fixes, name, compared, on_jobs)
    at, step, stands = coordinates_of(job, number), FIRST_STEP, False
    for round_ in range(1, MOST_ROUNDS + 1):
        before = at
        at, far = search.round(round_, at, step)
        stands = bool((np.abs(at - before) < STANDS * LAST_STEP).all())
        if stands:
            break
        if not far:
            step = np.maximum(step / FINER, LAST_STEP)
    search.check_held(at)
    search.run(round_, FOUND, at[None])
    jobs = [replace(one, return_group=AGAIN_AT_GROUP_9) for one in search.jobs[:-1]]
    jobs.append(replace(search.jobs[-1], return_group=END))
    return FeatureTrials(jobs, search.trials, at, step, int(compared.sum()), stands)


class _Search:
    """The stack as it grows, and the attitudes that its jobs are compared with.

    Attributes:
        jobs: of the stack
        trials: what each shows
    """

    def __init__(
        self,
        job: Job,
        number: int,
        fixes: Fixes,
        name: str,
        compared: Bools,
        on_jobs: Callable[[int], object],
    ) -> None:
        self._job, self._number = ignoring(job, number, False), number
        self._fixes, self._name, self._on_jobs = fixes, name, on_jobs
        self.jobs = [ignoring(job, number, True)]
        self.trials = [Trial(1, 0, KNOWN, NOWHERE, NOWHERE, np.nan, False)]
        (self._known,) = self._solved(self.jobs)
        self._compared = compared & np.isfinite(self._known.camera_deg).all(axis=1)
        self._attitude = from_axes(camera_axes(np.radians(self._known.camera_deg)))
        self._by_turns = np.zeros((len(compared), 2, 3))
        self._slopes = np.zeros((0, 3))  # of the last round, by the coordinates

    def _solved(self, jobs: list[Job]) -> list[Results]:
        found = run_jobs(jobs, self._fixes)
        for one in found:
            if isinstance(one, VopdError):
                raise VopdError(f"{self._name}: {one}") from one
            if one.stop is not None:
                raise VopdError(
                    f"{self._name}: group {one.stop.group}: {one.stop.table} must increase, and do "
                    f"not at position {one.stop.position}"
                )
        return [one for one in found if isinstance(one, Results)]

    def round(self, round_: int, at: Floats, step: Floats) -> tuple[Floats, bool]:
        """Run a series of each coordinate, and a trial of all three.

        Args:
            round_: its number
            at: the estimate, (3,)
            step: between trials, (3,)

        Returns:
            The next estimate, and whether it lies farther away than a round goes.
        """
        self._by_turns[:] = 0.0  # the first trial of the round weighs its angles
        slopes = []
        for axis in range(3):
            at, slope, left, least = self._series(round_, axis, at, step)
            slopes.append(slope * step[axis])
        by_step = np.stack([slope.ravel() for slope in slopes], axis=1)
        self._slopes = by_step / step
        turned = np.linalg.lstsq(by_step, -left.ravel(), rcond=None)[0]
        largest = float(np.abs(turned).max())
        far = largest > MOST_STEPS
        tried = at + turned * step / max(largest / MOST_STEPS, 1.0)
        (there,) = (self.run(round_, TOGETHER, tried[None]) ** 2).sum(axis=(1, 2))
        if there < least:
            self.trials[-1] = self.trials[-1]._replace(best=True)
            return tried, far
        return at, False

    def check_held(self, at: Floats) -> None:
        """Check that the frames hold a landmark along its line of sight.

        Raises:
            VopdError: if a reading leaves it free by half of its distance
        """
        known, count = self._known, int(self._compared.sum())
        camera_m = earth_fixed(origin_of(known.job), self._fixes, known.vehicle_ft) * M_PER_KM
        away_m = place_m(at[None], self._fixes) - camera_m[self._compared]
        reach_m = float(np.linalg.norm(away_m, axis=1).mean())
        weakest = np.linalg.svd(self._slopes @ by_position(at, self._fixes), compute_uv=False)[-1]
        reading = READING_IN * factor / self._job.camera.focal_length_mm
        if not reading < FARTHEST * reach_m * weakest:
            raise VopdError(along_one_line(self._name, self._number, count))

    def _series(
        self, round_: int, axis: int, at: Floats, step: Floats
    ) -> tuple[Floats, Floats, Floats, float]:
        """Run trials of one coordinate about an estimate, and again about the last if it is best.

        Returns:
            The best coordinates (3,), between the trials by a parabola; the slopes of the
            differences (F, 2) and the differences there; and their squares at the best trial.
        """
        for _ in range(MOST_SERIES):
            coordinates = np.tile(at, (2 * SIDE + 1, 1))
            coordinates[:, axis] += np.arange(-SIDE, SIDE + 1) * step[axis]
            apart = self.run(round_, NAMES[axis], coordinates)
            squares = (apart**2).sum(axis=(1, 2))
            best = int(np.argmin(squares))
            first = len(self.trials) - len(squares)
            self.trials[first + best] = self.trials[first + best]._replace(best=True)
            at = coordinates[best]
            if 0 < best < 2 * SIDE:
                break
        else:
            raise VopdError(
                f"{self._name}: trials of {NAMES[axis]} have no best one, up to {at[axis]:.5g}: "
                f"look at the readings of landmark {self._number}, or start from coordinates that "
                "are nearer in group 9"
            )
        before, here, after = squares[best - 1 : best + 2]
        past = 0.5 * (before - after) / (before - 2.0 * here + after)
        slope = (apart[best + 1] - apart[best - 1]) / (2.0 * step[axis])
        at[axis] += past * step[axis]
        return at, slope, apart[best] + slope * past * step[axis], float(here)

    def run(self, round_: int, varied: str, coordinates: Floats) -> Floats:
        """Run trials, and compare their angles with those from the known landmarks.

        Args:
            round_: its number
            varied: what differs from trial to trial
            coordinates: of the trials, (T, 3)

        Returns:
            The differences of the attitudes as shifts of the feature's image, with the standard
            deviation of its reading, in focal lengths (T, F, 2); infinite for a trial that has no
            attitude in a frame.
        """
        jobs = [with_coordinates(self._job, self._number, one) for one in coordinates]
        results = self._solved(jobs)
        if not self._by_turns.any():
            self._by_turns = self._weights(results[len(results) // 2])
        apart = np.stack([self._apart(one) for one in results])[:, self._compared]
        per_in = self._job.camera.focal_length_mm / factor
        for job, result, own in zip(jobs, results, apart, strict=True):
            turned = result.vehicle_deg[self._compared] - self._known.vehicle_deg[self._compared]
            turned = (turned + 180.0) % 360.0 - 180.0
            self.jobs.append(job)
            self.trials.append(
                Trial(
                    len(self.jobs),
                    round_,
                    varied,
                    coordinates_of(job, self._number),
                    np.sqrt((turned**2).mean(axis=0)),
                    float(np.sqrt((own**2).mean()) * per_in),
                    False,
                )
            )
        self._on_jobs(len(self.jobs))
        return apart

    def _apart(self, result: Results) -> Floats:
        """Weigh how the cameras of a trial are turned from those of the known landmarks, (F, 2)."""
        attitude = from_axes(camera_axes(np.radians(result.camera_deg)))
        turn = np.radians(rotation_vectors_deg(self._attitude, attitude))
        apart = (self._by_turns @ turn[..., None])[..., 0]
        return np.where(np.isfinite(apart), apart, np.inf)

    def _weights(self, result: Results) -> Floats:
        """Find the weights of turns, (F, 2, 3), that have the differences in their own deviations.

        With the readings' equal standard deviation, N of the known landmarks and B of the feature,
        the attitudes with and without it differ by N^-1 B' S^-1 r, S = 1 + B N^-1 B', for a
        residual r of the feature, and S^-1/2 r has the standard deviation of a reading.
        """
        points, frame = result.points, result.layout.frame
        axes = camera_axes(np.radians(result.camera_deg))
        seen = (axes[frame] @ points.direction[..., None])[..., 0]
        x, y = seen[:, 0] / seen[:, 2], seen[:, 1] / seen[:, 2]
        by_turns = partials_by_turns(x, y, np.ones_like(x))
        own = points.used & (points.landmark == self._number) & self._compared[frame]
        known = np.flatnonzero(points.used & ~own)
        normal = np.zeros((len(axes), 3, 3))
        np.add.at(normal, frame[known], by_turns[known].swapaxes(1, 2) @ by_turns[known])
        weights = np.zeros((len(axes), 2, 3))
        some, at = frame[own], by_turns[own]
        more, ways = np.linalg.eigh(at @ np.linalg.pinv(normal[some]) @ at.swapaxes(1, 2))
        root = (ways * (np.sqrt(1.0 + more) / more)[:, None]) @ ways.swapaxes(1, 2)
        weights[some] = root @ at
        return weights
