"""Simulated films as jobs made of arrays, and as decks of cards; the same numbers in both."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tests.kit.simulated_films import FOCAL_MM, FRAME_S, LENS_MM, LENS_UM, SimulatedFilms
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind

TOP_FT = 300000.0


def job_of(films: SimulatedFilms, k: int) -> Job:
    """The k-th job, made of arrays."""
    last = k == len(films.origin) - 1
    frames, count = films.landmark_in.shape[1:3]
    number, landmark = np.arange(frames) + 1, np.arange(count) + 11
    path, origin = films.position_ft[k], films.origin[k]
    minutes = [a[k] for a in (films.longitude_min, films.latitude_min)]
    whole = [np.trunc(m / 60.0) for m in minutes]
    rest = [(m - 60.0 * w).round(5) for m, w in zip(minutes, whole, strict=True)]
    return Job(
        title="1SIMULATED".ljust(80),
        camera=Camera(
            FOCAL_MM, LENS_MM, LENS_UM, films.multiplier[k], films.offset_deg[k],
            films.truth_deg[k, 0, :3].round(3),
        ),
        trajectory=Trajectory(
            films.time_s, path, films.velocity_ft_s[k], path[:, 2], *origin.tolist()
        ),
        wind=Wind(np.array([0.0, TOP_FT]), np.tile(films.wind_ft_s[k], (2, 1))),
        clock=Clock(np.array([1, frames + 1]), films.time_s[0] + FRAME_S * np.array([0.0, frames])),
        landmarks=Landmarks(landmark, whole[0], rest[0], whole[1], rest[1], films.altitude_ft[k]),
        ignored=Ignored(np.zeros(0, int), np.zeros((0, 6), int), np.zeros(count, int)),
        readings=Readings.of(
            frame=number,
            fiducial_in=films.fiducial_in[k],
            landmark=np.tile(landmark, (frames, 1)),
            present=films.seen[k],
            landmark_in=films.landmark_in[k],
        ),
        return_group=13 if last else 1,
    )  # fmt: skip


def jobs_of(films: SimulatedFilms) -> list[Job]:
    """All jobs, made of arrays."""
    return [job_of(films, k) for k in range(len(films.origin))]


def deck_of(films: SimulatedFilms) -> str:
    """All jobs as one deck of cards, punched after Appendix F and the FORMATs of the listing."""
    cards = [card for k in range(len(films.origin)) for card in _cards(job_of(films, k))]
    return "\n".join(cards) + "\n"


def _row(*values: float, width: int = 10) -> str:
    return "".join(_real(value, width) for value in values)


def _real(value: float, width: int) -> str:
    """A number with its point punched, at the right edge of its columns."""
    text = repr(round(float(value), 6))
    assert len(text) < width and "e" not in text, text
    return text.rjust(width)


def _whole(values: list[int]) -> Iterator[str]:
    """Whole numbers, sixteen a card."""
    for k in range(0, len(values), 16):
        yield "".join(f"{value:5d}" for value in values[k : k + 16])


def _cards(job: Job) -> Iterator[str]:
    camera, path, marks = job.camera, job.trajectory, job.landmarks
    frames, count = job.readings.landmark.shape
    for pair in zip(LENS_MM, LENS_UM, strict=True):
        yield _row(*pair)
    yield "1SIMULATED"
    mounting = np.stack([camera.multiplier, camera.offset_deg], axis=1).ravel()
    yield f"{frames:5d}{2:5d}" + "".join(f"{v:.0f}.".rjust(5) for v in mounting)
    for altitude, wind in zip(job.wind.altitude_ft, job.wind.velocity_ft_s, strict=True):
        yield _row(altitude, *wind)
    yield from _whole([count, frames, 2, *job.readings.present.sum(axis=1).tolist()])
    for number, time_s in zip(job.clock.frame, job.clock.time_s, strict=True):
        yield f"{number:5d}{_real(time_s, 10)}"
    for row in zip(
        path.time_s, path.position_ft, path.velocity_ft_s, path.altitude_ft, strict=True
    ):
        yield _row(row[0], *row[1], *row[2], row[3])
    yield _row(
        FOCAL_MM, path.origin_latitude_deg, path.origin_longitude_deg,
        path.origin_radius_kft, *camera.initial_deg,
    )  # fmt: skip
    for row in zip(
        marks.number, marks.longitude_deg, marks.longitude_min, marks.latitude_deg,
        marks.latitude_min, marks.altitude_ft, strict=True,
    ):  # fmt: skip
        yield f"{row[0]:10d}" + _row(*row[1:])
    yield f"{0:5d}"
    yield from _whole([job.return_group, *[0] * count])
    yield from _basic_data(job)


def _basic_data(job: Job) -> Iterator[str]:
    """The film reader's cards: thousandths of an inch without a point."""
    r = job.readings
    for k, frame in enumerate(r.frame):
        points = np.concatenate([r.fiducial_in[k], r.landmark_in[k][r.present[k]]])
        numbers = [0] * 4 + r.landmark[k][r.present[k]].tolist()
        for number, three in zip(numbers, points, strict=True):
            for x, y in (three * 1000.0).round().astype(int):
                yield f"{'':8}{number:02d}{'':30}{x:7d}   {y:7d}      {frame:4d}"
