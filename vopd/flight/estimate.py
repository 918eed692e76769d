"""Estimates of a flight: angles, residuals and their derivatives, for `vopd.attitude`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.estimate import (
    About,
    Estimate,
    FrameStatus,
    InputErrors,
    MapGrid,
    Position,
    Responses,
    StatedSigmas,
    Units,
    Words,
)
from vopd.flight.angles import AttackAngles, attack_angles, camera_angles, vehicle_angles
from vopd.flight.coordinates import map_grid
from vopd.flight.flight import Flight, FrameSlots
from vopd.flight.solve.errors import (
    ADJUSTED,
    HeldEffects,
    errors_of_sums,
    held_effects,
    places_by_stated,
    stated_components,
    turns_by_errors,
)
from vopd.flight.solve.held import other_solutions_deg, position_ratio
from vopd.flight.solve.joint import NO_PARAMETERS, JointSolution
from vopd.flight.solve.lines_of_sight import vertical_by_position
from vopd.flight.solve.rotations import FlightBlocks, FlightPart, SolvedFlight
from vopd.flight.words import flight_words
from vopd.geometry.earth import NED_FROM_ENU, geodetic, local_axes
from vopd.geometry.lenses import Lenses, LensKind, Projection, project, ray_of_pixel
from vopd.geometry.linear import FAR_FROM_SINGULAR, crossing, inverse
from vopd.geometry.rotations import (
    IMAGE_FROM_CAMERA,
    angles_by_turns,
    body_angles_by_turns,
    turns_by_angles,
)
from vopd.landmark_layout import LandmarkLayout

if TYPE_CHECKING:
    from vopd.scene import Adjusted, JobScene


# Derivatives of residuals by landmarks, position, focal length and time


def pick_responses(
    solved: SolvedFlight,
    slots: FrameSlots,
    used: Bools,
    seen: Projection,
    attack: AttackAngles,
    body_turns: Floats,
) -> Responses:
    """Differentiate residuals by each input, the camera's angles against its local axes held fixed.

    A residual is measured minus computed of image coordinates -u and -v, and so it
    changes as the computed u and v do.

    Args:
        solved: the flight, its rotations and lines of sight
        slots: where each pick stands in arrays of frames
        used: picks that take part, (P,)
        seen: the images of the lines of sight
        attack: the angles of attack
        body_turns: small turns about the body's axes by camera yaw, pitch, roll, (F, 3, 3)
    """
    flight, lines = solved.flight, solved.lines
    picks = flight.picks
    rotation = solved.attitudes.rotation[picks.frame]
    ray = np.einsum("pij,pj->pi", rotation, lines.direction)
    # moved across its line of sight by a length, a landmark turns by that over the distance
    moved = seen.by_turns @ crossing(ray) @ rotation / lines.distance_m[:, None, None]
    at_landmark = flight.landmarks.axes[picks.landmark]
    to_camera = lines.axes[picks.frame] @ at_landmark.swapaxes(1, 2)
    vertical = seen.by_turns @ rotation @ vertical_by_position(lines.camera)[picks.frame]
    position = -moved - vertical
    velocity = np.zeros((len(flight.frame), 3))
    if flight.path.velocity_m_s is not None:
        velocity = flight.path.velocity_m_s @ NED_FROM_ENU
    centre_px = flight.lens.of(picks.frame).by_rows("centre_px")
    focal = (seen.pixel - centre_px) / flight.lens.focal_px.mean()

    def of_frames(values: Floats) -> Floats:
        return slots.coordinates(np.where(used.reshape(-1, *[1] * (values.ndim - 1)), values, 0.0))

    return Responses(
        landmark=of_frames(moved @ to_camera),
        position=of_frames(position),
        focal_length=of_frames(focal),
        time=of_frames(np.einsum("pki,pi->pk", position, velocity[picks.frame])),
        attack_by_camera=attack.by_turns @ body_turns,
        attack_by_time=attack.by_time,
        attack_by_velocity=attack.by_velocity,
    )


# The estimate, in metres and pixels
#
# An estimate's image axes are those of 1974, seen from behind the camera: x to the
# left, y up. Pixels have u to the right and v down, and so image x is -u, and y -v.

FLIGHT_UNITS = Units("m", "px", 1.0, "px", 1.0)


FURTHER = ("distortion", "refraction", "readout")
"""Components of errors that `Responses` has no derivatives for."""

MOST_KEPT = 100_000  # picks of a flight whose estimates are kept, about 500 bytes each


class FlightEstimates:
    """The estimates of a flight by its frames.

    Attributes:
        solved: the flight, freed parameters as solved, and its rotations
        joint: the solution of all its unknowns, from which these are; None: of rotations alone
        reading: the reading sigma in force; None before it is known
        blocks: its frames
        origin_m: the first position that is known, Earth-centred, (3,); NaN: there is none
        origin_axes: east, north, up there as rows, (3, 3)
        landmark_names: by their numbers
        largest_lean_deg: between the geodetic and the geocentric vertical
        velocities_err: whether the velocity of any frame has a standard deviation above 0
    """

    def __init__(
        self,
        solved: SolvedFlight,
        joint: JointSolution | None = None,
        reading: JobReadingSigma | None = None,
    ) -> None:
        self.solved, self.joint, self.reading = solved, joint, reading
        self.blocks = FlightBlocks(solved.flight)
        marks, camera_m = solved.flight.landmarks, solved.camera_m
        known = np.isfinite(camera_m[:, 0])
        self.origin_m = camera_m[known.argmax()] if known.any() else np.full(3, np.nan)
        self.origin_axes = local_axes(self.origin_m[None])[0]
        self.landmark_names = dict(zip(marks.number.tolist(), marks.name, strict=True))
        self.largest_lean_deg = lean_of_verticals_deg(camera_m)
        velocity = solved.flight.path.velocity_sigma_m_s
        self.velocities_err = velocity is not None and bool(np.nan_to_num(velocity).any())
        self._begun: dict[bytes, Estimate] = {}  # whatever the reading sigma
        self._made: dict[bytes, Estimate] = {}
        self._outlier: Bools | None = None  # (P,)
        self._exchanged = np.zeros(0)  # (P,)
        self.doubt = ""  # as `About.doubt`
        self.before_and_after: Callable[[FlightEstimates], Adjusted] | None = None
        """Describes free parameters and residuals, as `JobScene.adjusted` does."""

    @property
    def flight(self) -> Flight:
        """The flight that was solved."""
        return self.solved.flight

    def with_reading(self, reading: JobReadingSigma) -> FlightEstimates:
        """Put a reading sigma in force: estimates are the same, but for errors solved for."""
        found = copy(self)
        found.reading = reading
        solved_for = self.joint is not None and (self.joint.passes or self._held is not None)
        found._made = {} if solved_for else dict(self._made)
        return found

    def scene(self) -> JobScene:
        """Describe the surroundings of the frames, for figures."""
        from vopd.flight.scene import FlightScene  # which few need

        scene = FlightScene(self.solved).scene()
        freed = self.joint is not None and self.joint.model.flight.options.free
        if self.before_and_after is None or not freed:
            return scene
        return replace(scene, adjusted=partial(self.before_and_after, self))

    @property
    def read(self) -> Flight:
        """The flight with all parameters as they are stated."""
        joint = self.joint
        if joint is None or not (joint.model.flight.options.free or joint.model.clicks):
            return self.flight
        stated = joint.model.flight
        picks = stated.picks.with_sigma(self.flight.picks.one_sigma_px)
        return replace(stated, picks=picks)

    @cached_property
    def words(self) -> Words:
        """The words for what is said of the flight."""
        return flight_words(self.solved, self.joint)

    @property
    def layout(self) -> LandmarkLayout:
        """How many picks each frame has."""
        return self.blocks.layout

    def of(self, frames: Ints) -> Estimate:
        """Estimate some frames.

        Args:
            frames: their indices
        """
        key = frames.tobytes()
        made = self._made.get(key)
        if made is None:
            part = self.blocks.part(frames)
            begun = self._begun.get(key) or self._without_reading(part)
            made = begun if self.joint is None else self._with_errors(begun, part, self.joint)
            made = self._with_marks(made, part)
            about = made.about._replace(doubt=self.doubt)
            made = replace(made, about=about, scene=self.scene)
            if self.layout.total <= MOST_KEPT:
                self._begun[key], self._made[key] = begun, made
        return made

    def _without_reading(self, part: FlightPart) -> Estimate:
        """Estimate some frames, but for what the reading sigma moves."""
        one, joint = flight_estimate(self.solved.part(part), self), self.joint
        if joint is None:
            return one
        slots, here = _slots(part), np.tile(one.used, 2)
        further = {name: slots.coordinates(own[part.picks]) for name, own in self._further.items()}
        further = {name: np.where(here[..., None], own, 0.0) for name, own in further.items()}
        if rate := joint.stated[0].get("clock_rate"):
            one = replace(one, late_s=rate * joint.model.since_s[part.frames, None])
        one = replace(one, further={**one.further, **further})
        return self._with_stated_residual(one, part, joint) if joint.passes else one

    def _with_errors(self, one: Estimate, part: FlightPart, joint: JointSolution) -> Estimate:
        """Add to the estimate of some frames the errors that were solved for, or are held."""
        if self.reading is None or not (joint.passes or self._held is not None):
            return one
        known = np.isfinite(self.solved.camera_m[part.frames])
        place_m2 = (joint.covariance.place_m2 + self._places_by_stated)[part.frames]
        if self._held is not None:
            place = self._held.place[part.frames]
            place_m2 = place_m2 + place @ place.swapaxes(1, 2)
        return replace(
            one,
            errors=input_errors(self.solved.part(part), one, self._turns, part.frames),
            moved=np.where(known, joint.moved_m[part.frames], np.nan),
            position_sigma=np.sqrt(np.einsum("fii->fi", place_m2)),
            position_ratio=self._position_ratio[part.frames],
            other_solution_deg=self._other_solutions_deg[part.frames],
        )

    def _with_stated_residual(
        self, one: Estimate, part: FlightPart, joint: JointSolution
    ) -> Estimate:
        """Add residuals at the stated places, for tests."""
        slots, here = _slots(part), np.tile(one.used, 2)
        residual = -slots.coordinates(self._stated_residual[part.picks])
        left_out = ~slots.spread(np.isin(part.picks, joint.model.pick)) & one.used
        if left_out.any():
            residual = np.where(np.tile(left_out, 2), self._residual_beside(one, part), residual)
        return replace(one, test_residual=np.where(here, residual, 0.0))

    def _residual_beside(self, one: Estimate, part: FlightPart) -> Floats:
        """Calculate residuals at the stated positions of picks that took no part, (F, 2L)."""
        landmark = _slots(part).spread(part.flight.picks.landmark)
        moved_m = self._joint.model.moved_m(self._joint.beside_free)
        place_m = np.nan_to_num(moved_m[part.frames])[:, :, None]
        moved = (one.responses.position @ place_m)[..., 0]
        own_m = np.tile(self._joint.state.landmark_m[landmark], (1, 2, 1))
        return np.asarray(one.residual - moved - (one.responses.landmark * own_m).sum(axis=2))

    @property
    def _joint(self) -> JointSolution:
        """The solution of all its unknowns, where there is one."""
        assert self.joint is not None
        return self.joint

    @cached_property
    def _further(self) -> dict[str, Floats]:
        """Changes of the images by errors that are only propagated and have no `Responses`."""
        change, parts = self._joint.stated[1], stated_components(self._joint).items()
        found = {name: self._pixels(change[..., own]) for name, own in parts if name in FURTHER}
        if self._held is not None:
            found[ADJUSTED] = self._pixels(self._held.change)
        return found

    @cached_property
    def _places_by_stated(self) -> Floats:
        return places_by_stated(self._joint)

    @cached_property
    def _position_ratio(self) -> Floats:
        return position_ratio(self._joint.covariance)

    @cached_property
    def _other_solutions_deg(self) -> Floats:
        return other_solutions_deg(self._joint)

    @cached_property
    def _stated_residual(self) -> Floats:
        """Residuals at the stated positions, pixels, (P, 2)."""
        return self._pixels(self._joint.stated_residual[..., None])[..., 0]

    def _pixels(self, values: Floats) -> Floats:
        """Convert values of the picks that took part, in their sigmas, to pixels of all picks."""
        every = np.zeros((len(self.flight.picks.frame), *values.shape[1:]))
        every[self._joint.model.pick] = values / self._joint.model.scale[:, None, None]
        return every

    @cached_property
    def _turns(self) -> dict[str, Floats]:
        return turns_by_errors(self._joint, self._held)

    @cached_property
    def _held(self) -> HeldEffects | None:
        return held_effects(self._joint)

    def sum_errors(self, weight: Floats) -> dict[str, Floats]:
        """Estimate the covariances of k sums over frames, by component, radians squared, (k, k).

        Args:
            weight: what a turn of each frame about the vehicle's forward, right and down axes
                adds to the sums, (F, 3, k)
        """
        return self.camera_errors(self.flight.mount.T @ weight)

    def camera_errors(
        self, weight: Floats, by_parameter: Mapping[str, Floats] = NO_PARAMETERS
    ) -> dict[str, Floats]:
        """Estimate the covariances of k sums over frames, by component, radians squared, (k, k).

        Args:
            weight: what a turn of each frame about the camera's axes adds to the sums, (F, 3, k)
            by_parameter: what parameters, by their names, add to them besides, (k,) each
        """
        assert self.reading is not None
        found = errors_of_sums(self._joint, weight, self._held, by_parameter)
        if not self._joint.passes:  # it was not solved again with the reading sigma in force
            scale = self.reading.sigma / self._joint.model.flight.picks.one_sigma_px
            found["reading"] = found["reading"] * scale**2
        return found

    def mark_outliers(self, outlier: Bools, exchanged: Floats) -> None:
        """Mark picks that do not fit the others of their frames in all estimates.

        Args:
            outlier: the picks, (P,)
            exchanged: those whose labels are exchanged, as `Estimate.exchanged`, (P,)
        """
        self._outlier, self._exchanged = outlier, exchanged
        for key, made in self._made.items():
            part = self.blocks.part(np.frombuffer(key, np.int64))
            self._made[key] = self._with_marks(made, part)

    def contradict(self, doubt: str) -> None:
        """Say in all estimates how the residuals contradict the flight as a whole.

        Args:
            doubt: as `About.doubt`
        """
        self.doubt = doubt
        for key, made in self._made.items():
            self._made[key] = replace(made, about=made.about._replace(doubt=doubt))

    def _with_marks(self, one: Estimate, part: FlightPart) -> Estimate:
        """Add to the estimate of some frames the picks that do not fit."""
        if self._outlier is None:
            return one
        slots, own = _slots(part), part.picks
        outlier, exchanged = (slots.spread(v[own]) for v in (self._outlier, self._exchanged))
        return replace(one, outlier=outlier, exchanged=exchanged)

    def whole(self) -> Estimate:
        """Estimate all frames."""
        return self.of(np.arange(len(self.flight.frame)))


def _slots(part: FlightPart) -> FrameSlots:
    return FrameSlots.of(part.flight.picks.frame, len(part.frames))


def lean_of_verticals_deg(camera_m: Floats) -> float:
    """Find the largest angle between the two verticals, degrees; 0 without a known position."""
    lean = np.abs(geodetic(camera_m).latitude_deg - _geocentric_latitude_deg(camera_m))
    return float(np.fmax.reduce(lean, initial=0.0))


def _geocentric_latitude_deg(camera_m: Floats) -> Floats:
    x, y, z = camera_m.T
    return np.asarray(np.degrees(np.arctan2(z, np.hypot(x, y))))


def input_errors(
    solved: SolvedFlight, estimate: Estimate, turns: Mapping[str, Floats], frames: Ints
) -> dict[str, InputErrors]:
    """Convert errors of the inputs to those of the camera's angles, of the body and of the air.

    Args:
        solved: some frames of a flight
        estimate: of these frames
        turns: of all frames about the camera's axes, and errors of their times, (F, 4, C) each
        frames: the indices of these among all
    """
    by_turns = angles_by_turns(np.radians(estimate.camera_deg)) @ IMAGE_FROM_CAMERA
    by_time = estimate.responses.attack_by_time[:, :, None]
    found = {}
    for name, every in turns.items():
        turn, late_s = every[frames, :3], every[frames, 3:]
        by_turn = -by_turns @ turn, -solved.flight.mount @ turn
        found[name] = InputErrors(*by_turn, np.where(late_s == 0.0, 0.0, by_time * late_s))
    return found


@np.errstate(all="ignore")
def flight_estimate(solved: SolvedFlight, whole: FlightEstimates | None = None) -> Estimate:
    """Convert a solved flight to the estimate that `vopd.attitude` takes.

    Args:
        solved: the flight and its rotations, or some of its frames
        whole: those of all frames, where these are some of them
    """
    whole = whole or FlightEstimates(solved)
    flight, attitudes, picks = solved.flight, solved.attitudes, solved.flight.picks
    rotation, turning = attitudes.rotation, flight.path.turning_rad_s
    known: Bools = np.isfinite(rotation[:, 0, 0])
    slots = FrameSlots.of(picks.frame, len(flight.frame))
    used: Bools = solved.used & (attitudes.weight > 0.0) & known[picks.frame]
    left_out = ~flight.landmarks.takes_part
    weight = np.where(used, attitudes.weight, 0.0)

    camera_deg, vehicle_deg = camera_angles(solved), vehicle_angles(solved)
    attack, radians = attack_angles(solved), np.radians(camera_deg)
    lens = flight.lens.of(picks.frame)
    ray = np.einsum("pij,pj->pi", rotation[picks.frame], solved.lines.direction)
    seen = project(lens, ray)
    residual = -(picks.pixel - seen.pixel)
    by_turns = _part(used, seen.by_turns) @ IMAGE_FROM_CAMERA  # of the image, by turns of the axes
    partials = slots.coordinates(by_turns)
    turn_gain = gain_of_turns(partials, slots.coordinates(np.stack([weight, weight], axis=1)))
    body_turns = flight.mount @ IMAGE_FROM_CAMERA @ turns_by_angles(radians)
    responses = pick_responses(solved, slots, used, seen, attack, body_turns)
    fixes, fix_sigma, further = flight.path.fixes, None, {}
    if picks.clicks is not None:
        from vopd.flight.solve.clicks import errors_of_frames  # of few flights

        further["click"] = errors_of_frames(picks.clicks, slots, used)
    if fixes is not None and fixes.exact:
        further["interpolation"] = responses.position * fixes.frame_sigma_m[:, None]
    elif fixes is not None:
        fix_sigma = fixes.frame_sigma_m
    return Estimate(
        about=About(
            flight.source,
            title=flight.name,
            words=whole.words,
            epoch=flight.epoch,
            doubt=whole.doubt,
        ),
        units=FLIGHT_UNITS,
        frame=flight.frame,
        status=np.where(known, FrameStatus.SOLVED, FrameStatus.UNSOLVED).astype(np.int64),
        solved=np.ones_like(known),
        converged=attitudes.converged | ~known,
        correction_rad=attitudes.correction_rad,
        time_s=flight.time_s,
        position=_position(solved, whole.largest_lean_deg),
        displacement=(solved.camera_m - whole.origin_m) @ whole.origin_axes.T,
        camera_deg=camera_deg,
        vehicle_deg=vehicle_deg,
        vehicle_by_camera=body_angles_by_turns(np.radians(vehicle_deg)) @ body_turns,
        attack_deg=attack.angle_deg,
        airspeed=attack.airspeed_m_s,
        landmark=slots.spread(flight.landmarks.number[picks.landmark]),
        used=slots.spread(used),
        ignored=slots.spread(left_out[picks.landmark]),
        direction=slots.spread(_part(used, solved.lines.direction)),
        image=slots.spread(_part(used, _ideal(flight))),
        image_by_ray=slots.spread(_part(used, _image_by_ray(flight)))
        if flight.lens.kind is LensKind.FISHEYE or isinstance(flight.lens, Lenses)
        else None,
        focal_length=float(flight.lens.focal_px.mean()),
        residual=slots.coordinates(_part(used, residual)),
        partials=partials @ turns_by_angles(radians),
        gain=angles_by_turns(radians) @ turn_gain,
        body_gain=flight.mount @ IMAGE_FROM_CAMERA @ turn_gain,
        responses=responses,
        reading_spread=picks.repeatability_px,
        reading_floor=picks.least_sigma_px,
        relative_sigma=slots.spread(picks.sigma_px / picks.one_sigma_px),
        landmark_names=whole.landmark_names,
        frame_names=list(flight.image_name),
        stated=_stated(flight),
        fix_sigma=fix_sigma,
        further=further,
        landmark_sigma=slots.spread(flight.landmarks.sigma_m[picks.landmark])
        if flight.landmarks.sigma_m.any()
        else None,
        velocity_sigma=flight.path.velocity_sigma_m_s if whole.velocities_err else None,
        grid=_grid(solved),
        gimbal_deg=flight.path.gimbal_deg,
        lens=flight.lens.which if isinstance(flight.lens, Lenses) else None,
        rate_unknown=None if turning is None else np.isnan(turning[:, 0]),
        scene=whole.scene,
    )


def _grid(solved: SolvedFlight) -> MapGrid | None:
    """Project the cameras' places on the map grid: as stated, or where they are solved."""
    flight = solved.flight
    grid, stated_m = flight.grid, flight.path.position_m
    if grid is None or np.array_equal(solved.camera_m, stated_m, equal_nan=True):
        return grid
    return map_grid(grid.crs, solved.camera_m)


def _part(used: Bools, values: Floats) -> Floats:
    """Keep the values of picks that take part, 0 for the others."""
    return np.where(used.reshape(-1, *[1] * (values.ndim - 1)), values, 0.0)


def _ideal(flight: Flight) -> Floats:
    """Remove the lens's distortion from picks: image coordinates (P, 2)."""
    ray = ray_of_pixel(flight.lens.of(flight.picks.frame), flight.picks.pixel)
    return np.asarray(-flight.lens.focal_px.mean() * ray[:, :2] / ray[:, 2:])


def _image_by_ray(flight: Flight) -> Floats:
    """Differentiate image coordinates of picks by their rays in image axes, (P, 2, 3)."""
    lens = flight.lens.of(flight.picks.frame)
    ray = ray_of_pixel(lens, flight.picks.pixel)
    by_ray = project(lens, ray).by_turns @ crossing(ray)
    return np.asarray(-by_ray @ IMAGE_FROM_CAMERA.T)


def gain_of_turns(partials: Floats, weight: Floats) -> Floats:
    """Solve for small turns by the residuals, (F, 3, 2L); NaN if they are not determined."""
    weighted = partials.swapaxes(1, 2) * weight[:, None]
    normal = weighted @ partials
    plain = inverse(normal)
    condition = np.linalg.norm(normal, axis=(1, 2)) * np.linalg.norm(plain, axis=(1, 2))
    doubtful = ~(condition < FAR_FROM_SINGULAR)
    sizes = np.linalg.eigvalsh(np.nan_to_num(normal[doubtful]))
    singular = np.zeros_like(doubtful)
    singular[doubtful] = ~(sizes[:, 0] > 1e-14 * sizes[:, 2])
    return np.where(singular[:, None, None], np.nan, plain) @ weighted


def _position(solved: SolvedFlight, largest_lean_deg: float) -> Position:
    where = solved.lines.camera
    return Position(
        where.latitude_deg,
        where.longitude_deg,
        where.height_m,
        NED_FROM_ENU @ solved.lines.axes,
        _geocentric_latitude_deg(solved.camera_m),
        largest_lean_deg=largest_lean_deg,
    )


def _stated(flight: Flight) -> StatedSigmas:
    """Collect the standard deviations that are one for the flight."""
    common, place = flight.options.parameter_sigma, flight.path.bias_sigma_m
    return StatedSigmas(
        focal_length=common.get("focal", 0.0),
        time_s=common.get("clock", 0.0),
        principal_point=(common.get("centre_u", 0.0), common.get("centre_v", 0.0)),
        place=(float(place[0]), float(place[1]), float(place[2])),
        wind=flight.path.wind_sigma_m_s,
        mount_deg=flight.mount_sigma_deg,
    )
