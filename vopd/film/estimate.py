"""Make the estimate of a deck's job: residuals, partials and gain of every frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints, distinct_in_rows
from vopd.errata import Fix
from vopd.estimate import About, Estimate, EstimateBlock, FrameStatus, Units
from vopd.film.image_axis import columns, flat
from vopd.film.joined_jobs import joined_jobs
from vopd.film.position import position
from vopd.film.reading_noise import ReadingNoise, reading_noises
from vopd.film.responses import responses
from vopd.film.slip_effect import slip_effects_deg
from vopd.film.words import DECK_WORDS
from vopd.geometry.body_angles import turns_by_body_angles
from vopd.geometry.lens import radial_factor
from vopd.geometry.linear_algebra import inverse, singular_values
from vopd.job import Job
from vopd.program.constants import rad
from vopd.program.orient import Sight, equations
from vopd.program.tgtcam import Dircos
from vopd.results import Outcome, Results
from vopd.solved_job import SolvedJob

DOWN_1974 = "toward the Earth's centre (as in 1974)"
TOGETHER = 4000  # frames
SINGULAR = 1e-14  # of the singular values of P'B, squares of the partials' own

STATUS = {
    Outcome.SOLVED: FrameStatus.SOLVED,
    Outcome.DROPPED: FrameStatus.IGNORED,
    Outcome.EXACT: FrameStatus.EXACT,
    Outcome.EXACT_LATE: FrameStatus.EXACT,
    Outcome.STOPPED: FrameStatus.STOPPED,
}


def film_estimate(
    results: Results, source: str = "", job: int = 1, whole: Job | None = None
) -> Estimate:
    """Make the estimate of one job of a deck, for `vopd.attitude`.

    Args:
        results: one job as `vopd.program.vopd.run` solved it
        source: the deck's name, for tables and files
        job: the job's number in its deck, from 1
        whole: the job with all its frames, where `results` has only some of them
    """
    (estimate,) = _with_slip_effects([(results, source, job, whole)])
    return estimate


Part = tuple[Results, str, int, Job | None]
"""The arguments of `film_estimate`."""


def _with_slip_effects(parts: Sequence[Part]) -> list[Estimate]:
    """The estimates of jobs, or of blocks of jobs, whose frames are solved once more together."""
    made = _without_slip_effects(parts)
    determined = [np.asarray(np.isfinite(one.gain).all(axis=(1, 2))) for one in made]
    effects = slip_effects_deg([part[0] for part in parts], determined)
    return [replace(one, slip_effect_deg=effect) for one, effect in zip(made, effects, strict=True)]


def _without_slip_effects(parts: Sequence[Part]) -> list[Estimate]:
    """The estimates of jobs; those of one largest number of landmarks are made together."""
    alike: dict[int, list[int]] = {}
    for k, (results, *_) in enumerate(parts):
        alike.setdefault(results.layout.widest, []).append(k)
    made: dict[int, Estimate] = {}
    for indices in alike.values():
        made |= zip(indices, _joined_estimates([parts[k] for k in indices]), strict=True)
    return [made[k] for k in range(len(parts))]


def sight_of(results: Results, focal_length_mm: Floats) -> Sight:
    """The input of the solve that gave some results, by landmark and frame.

    Args:
        results: frames of one job or of several
        focal_length_mm: of every frame (F,)
    """
    layout, points = results.layout, results.points
    away = points.point_mm - results.centre_mm[layout.frame]
    image = radial_factor(points.radius_mm, points.distortion_mm)[:, None] * away

    def arranged(values: Floats) -> Floats:
        return np.ascontiguousarray(layout.padded(values, np.nan).T)

    dircos = Dircos(*(arranged(points.direction[:, k]) for k in range(3)))
    used = np.ascontiguousarray(layout.padded(points.used).T)
    xmu1 = dircos.xmu
    if Fix.FIRST_LANDMARK not in results.fixes and len(used):
        first = np.take_along_axis(xmu1, used.argmax(axis=0)[None], axis=0)
        xmu1 = np.broadcast_to(first, used.shape)
    return Sight(dircos, arranged(image[:, 0]), arranged(image[:, 1]), xmu1, used, focal_length_mm)


@np.errstate(all="ignore")
def _joined_estimates(parts: Sequence[Part]) -> list[Estimate]:
    """The estimates of some jobs.

    The partials B are the correct ones of the computed coordinates by the camera's
    yaw, pitch, roll. The gain is what the solve makes of a change of the residuals,
    (P'B)^-1 P' with the partials P of the run: with the erratum `first-landmark` in
    it the run ends where P'(residuals) is zero, which is not quite least squares.
    """
    joined = joined_jobs([part[0] for part in parts])
    results = joined.results
    seen = sight_of(results, joined.focal_length_mm)
    radians = results.camera_deg / rad
    _, of_run = equations(radians.T, seen)
    residual, correct = equations(radians.T, seen._replace(xmu1=seen.dircos.xmu))
    partials = -columns(correct)
    gain = _gain(-columns(of_run), partials, results)
    vehicle_by_camera = np.zeros((len(results.frame), 3, 3))
    vehicle_by_camera[:, range(3), range(3)] = joined.multiplier
    body_turns = turns_by_body_angles(np.radians(results.vehicle_deg)) @ vehicle_by_camera
    by_frame = {
        "frame": results.frame,
        "status": _status(results.outcome),
        "solved": results.solved,
        "converged": results.converged,
        "correction_rad": results.correction_rad,
        "time_s": results.time_s,
        "position": position(joined),
        "displacement": results.vehicle_ft,
        "camera_deg": results.camera_deg,
        "vehicle_deg": results.vehicle_deg,
        "vehicle_by_camera": vehicle_by_camera,
        "attack_deg": np.stack([results.alpha_deg, results.beta_deg, results.eta_deg], axis=1),
        "airspeed": results.airspeed_ft_s,
        "landmark": results.landmark,
        "used": results.used,
        "ignored": results.ignored,
        "direction": results.direction,
        "image": np.stack([seen.x.T, seen.y.T], axis=-1),
        "residual": flat(residual),
        "partials": partials,
        "gain": gain,
        "body_gain": body_turns @ gain,
        "responses": responses(joined, seen, radians),
        "relative_sigma": np.ones(results.used.shape),
    }
    noises = reading_noises([whole or one.job for one, _, _, whole in parts])
    return [
        _estimate(part, noise, {name: _only(value, frames) for name, value in by_frame.items()})
        for part, noise, frames in zip(parts, noises, joined.frames, strict=True)
    ]


def _only(value: Any, frames: slice) -> Any:
    """Some frames of an array, or of every array of a named tuple."""
    if not isinstance(value, tuple):
        return value[frames]
    return type(value)(*(v[frames] if isinstance(v, np.ndarray) else v for v in value))


def _estimate(part: Part, noise: ReadingNoise, by_frame: dict[str, Any]) -> Estimate:
    """The estimate of one job, by what it has for every frame."""
    results, source, job, _ = part
    return Estimate(
        about=_about(results, source, job),
        units=Units(),
        focal_length=results.job.camera.focal_length_mm,
        reading_spread=noise.spread_mm,
        reading_floor=noise.resolution_mm,
        fiducial_sigma=noise.fiducial_mm,
        **by_frame,
    )


def estimates_of_jobs(jobs: Sequence[SolvedJob]) -> list[list[EstimateBlock]]:
    """Make the estimates of many jobs; short jobs together are faster than one after the other.

    Args:
        jobs: solved jobs, all with the same fixes

    Returns:
        The blocks of every job: frames with like numbers of landmarks.
    """
    blocks = [one.results.layout.blocks() for one in jobs]
    parts = (part for one, frames in zip(jobs, blocks, strict=True) for part in _parts(one, frames))
    made = iter([estimate for some in _by_frames(parts) for estimate in _with_slip_effects(some)])
    return [[EstimateBlock(frames, next(made)) for frames in of_job] for of_job in blocks]


def _parts(one: SolvedJob, blocks: Sequence[Ints]) -> list[Part]:
    if len(blocks) == 1:
        return [(one.results, one.deck, one.number, None)]
    whole = one.results.job
    return [(one.results.as_job(frames), one.deck, one.number, whole) for frames in blocks]


def _by_frames(parts: Iterable[Part]) -> Iterator[list[Part]]:
    """Parts in groups of about `TOGETHER` frames, which bounds the memory."""
    some: list[Part] = []
    frames = 0
    for part in parts:
        some.append(part)
        frames += len(part[0].frame)
        if frames >= TOGETHER:
            yield some
            some, frames = [], 0
    if some:
        yield some


def _about(results: Results, source: str, job: int) -> About:
    title = results.job.title[1:].strip()  # column 1 is the printer's carriage control
    about = About(source, job, title, str(results.fixes), DOWN_1974, DECK_WORDS)
    if Fix.EARTH in results.fixes:
        about = about._replace(down=f"along the normal of {results.fixes.ellipsoid.label}")
    return about


def _status(outcome: Ints) -> Ints:
    return np.array([STATUS[one] for one in Outcome])[outcome]


def _gain(of_run: Floats, partials: Floats, results: Results) -> Floats:
    """(P'B)^-1 P' (F, 3, 2L): what the angles make of a change of the measured coordinates.

    NaN where P'B is singular but for rounding: an angle that nothing determines has
    no standard deviation, not that of a pseudo-inverse.
    """
    crossed = of_run.swapaxes(1, 2) @ partials
    known: Bools = results.solved & (distinct_in_rows(results.landmark, results.used) >= 2)
    sizes = singular_values(crossed).sizes
    known &= sizes[:, 2] > SINGULAR * sizes[:, 0]
    gain = inverse(crossed) @ of_run.swapaxes(1, 2)
    return np.asarray(np.where(known[:, None, None], gain, np.nan))
