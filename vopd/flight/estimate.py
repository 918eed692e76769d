"""Estimates of a flight: angles, residuals and their derivatives, for `vopd.attitude`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.conventions import POSITION
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
from vopd.findings import count_text
from vopd.flight.coordinates import map_grid
from vopd.flight.flight import Flight, FrameSlots, Refraction
from vopd.flight.solve.errors import (
    ADJUSTED,
    HeldEffects,
    covariance_of_common,
    errors_of_sums,
    held_effects,
    places_by_stated,
    stated_components,
    turns_by_errors,
)
from vopd.flight.solve.free import free_text
from vopd.flight.solve.held import other_solutions_deg, position_ratio
from vopd.flight.solve.joint import JointSolution
from vopd.flight.solve.lines_of_sight import EARTH_RADIUS_M, sight_lines
from vopd.flight.solve.rotations import (
    IMAGE_FROM_CAMERA,
    FlightBlocks,
    FlightPart,
    SolvedFlight,
)
from vopd.geometry.earth import NED_FROM_ENU, geodetic, local_axes
from vopd.geometry.lenses import Lenses, LensKind, Projection, project, ray_of_pixel
from vopd.geometry.linear import FAR_FROM_SINGULAR, crossing, inverse
from vopd.geometry.rotations import (
    FORWARD,
    angles_by_turns,
    body_angles_by_turns,
    body_angles_deg,
    camera_angles_deg,
    from_yaw_pitch_roll,
    rotation_vectors_deg,
    turns_by_angles,
)
from vopd.landmark_layout import LandmarkLayout

if TYPE_CHECKING:
    from vopd.scene import Change, JobScene

# Angles of attack


class AttackAngles(NamedTuple):
    """Angles of attack of F frames; NaN where the velocity is not known."""

    angle_deg: Floats  # (F, 3) alpha, beta, eta
    airspeed_m_s: Floats  # (F,)
    by_turns: Floats  # (F, 3, 3) by small turns about forward, right, down
    by_time: Floats  # (F, 3) radians a second, by the change of the velocity
    by_velocity: Floats  # (F, 3, 3) radians by north, east, down of the velocity, m/s


@np.errstate(all="ignore")
def angles_of_attack(
    body_to_ned: Floats, velocity_m_s: Floats, acceleration_m_s2: Floats
) -> AttackAngles:
    """Find the angles of attack and their derivatives.

    Alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), with forward, right
    and down components u, v, w of the velocity relative to the air.

    Args:
        body_to_ned: forward, right, down as columns in north, east, down, (F, 3, 3)
        velocity_m_s: north, east, down relative to the air, (F, 3)
        acceleration_m_s2: its change a second, (F, 3)
    """
    to_body = body_to_ned.swapaxes(1, 2)
    inside = (to_body @ velocity_m_s[..., None])[..., 0]
    u, v, w = inside.T
    across = np.hypot(v, w)
    angles = np.stack([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(across, u)], axis=1)
    zero = np.zeros_like(u)
    wu, vu, all2 = u**2 + w**2, u**2 + v**2, u**2 + across**2
    rows = [
        np.stack([-w / wu, zero, u / wu], axis=1),
        np.stack([-v / vu, u / vu, zero], axis=1),
        np.stack([-across / all2, u * v / (across * all2), u * w / (across * all2)], axis=1),
    ]
    by_velocity = np.stack(rows, axis=1)
    angles[all2 == 0.0] = np.nan  # what does not move through the air has no direction in it
    return AttackAngles(
        np.degrees(angles),
        np.sqrt(all2),
        by_velocity @ crossing(inside),
        (by_velocity @ to_body @ acceleration_m_s2[..., None])[..., 0],
        by_velocity @ to_body,
    )


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
    vertical = seen.by_turns @ rotation @ _vertical_by_position(solved)[picks.frame]
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


def _vertical_by_position(solved: SolvedFlight) -> Floats:
    """Differentiate the turn of east, north, up, radians, by metres east, north, up: (F, 3, 3)."""
    latitude = np.radians(solved.lines.camera.latitude_deg)
    turn = np.zeros((len(latitude), 3, 3))
    turn[:, 0, 1] = -1.0 / EARTH_RADIUS_M
    turn[:, 1, 0] = 1.0 / EARTH_RADIUS_M
    turn[:, 2, 0] = np.tan(latitude) / EARTH_RADIUS_M
    return turn


# Comparison with the gimbal's angles, which are never used in a solve


def gimbal_sentence(camera_deg: Floats, gimbal_deg: Floats) -> str:
    """Describe the rotations from the gimbal's attitudes to the solved ones, in a sentence.

    They are rotations about the camera's own axes: near nadir yaw and roll differ by tens of
    degrees where the attitudes differ by one.

    Args:
        camera_deg: solved yaw, pitch, roll, (F, 3)
        gimbal_deg: those of the gimbal, (F, 3); NaN where not known
    """
    known = np.isfinite(camera_deg).all(axis=1) & np.isfinite(gimbal_deg).all(axis=1)
    if not known.any():
        return "in the images' tags, and no frame with an attitude has them"
    turn = rotation_vectors_deg(
        from_yaw_pitch_roll(gimbal_deg[known]), from_yaw_pitch_roll(camera_deg[known])
    )
    middle, low, high = np.median(turn, axis=0), turn.min(axis=0), turn.max(axis=0)
    parts = ", ".join(
        f"{axis} {middle[k]:+.2f} ({low[k]:+.2f} to {high[k]:+.2f})"
        for axis, k in (("right", 1), ("down", 2), ("forward", 0))
    )
    count = count_text(len(turn), "frame")
    return (
        "not used; rotation from the gimbal's attitude to the solved one about the camera's axes, "
        f"degrees, median of {count} and range: {parts}"
    )


# Words of flights in tables, files, pictures and the report

ATTACK = (
    "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w the velocity "
    "{against} in the body"
)


OWN_LEVEL = "as the landmarks' file counts heights"
SIGMA_KEYS = {
    "position": "[track] or [position] sigma_m",
    "landmark": "[landmarks] sigma_m",
    "focal": "[uncertainty] focal_rel",
    "principal_point": "[uncertainty] principal_px",
    "distortion": "[uncertainty] k1, k2, p1p2",
    "refraction": "[atmosphere] sigma_k",
    "time": "[track] sigma_t_s",
    "readout": "[uncertainty] readout_ms",
    "mount": "--mount-sigma",
    "velocity": "[track] velocity_sigma_m_s",
    "wind": "[wind] sigma_m_s",
    "click": "[picks] tracked_from: tracks of another program share those of their clicks",
}
"""Where the standard deviation of each component of a flight's uncertainty is stated."""


def flight_words(solved: SolvedFlight, joint: JointSolution | None = None) -> Words:
    """Choose the words for one flight.

    Args:
        solved: its solution
        joint: the same, with what was solved for besides the rotations
    """
    flight = solved.flight
    altitude = OWN_LEVEL if flight.own_level else Words.altitude
    conventions = {
        "input": "; ".join(flight.about),
        "solve": f"{_unknowns(solved).format(flight.options.loss)}; WGS 84; "
        "residuals in pixels of the image as it was taken, x to the left, y up",
        "pixels": "u right, v down, (0, 0) the centre of the first pixel",
        "refraction": _refraction(flight.refraction, solved),
        "angles of attack": _attack_words(flight),
        "position": POSITION.format(altitude=altitude),
        "time": _time(flight),
    }
    if flight.path.gimbal_deg is not None:
        conventions["gimbal"] = gimbal_sentence(camera_angles(solved), flight.path.gimbal_deg)
    if joint is not None and joint.model.clicks is not None:
        from vopd.flight.misfits.click_tests import clicks_text  # of few flights

        conventions["clicks"] = clicks_text(joint)
    if joint is not None and joint.model.flight.options.free:
        conventions["solved for"] = free_text(joint, covariance_of_common(joint))
    fixes = flight.path.fixes
    if solved.landmark_m is not None and fixes is not None and fixes.weight.shape[1] > 1:
        conventions["mean"] = (
            "frames between the same fixes of the track share their errors: a mean over frames has "
            "the covariance that vopd attitude --mean states, not common + (all - common) / F"
        )
    if np.isfinite(flight.grid_convergence_deg):
        conventions["grid azimuth"] = (
            f"true azimuth less {flight.grid_convergence_deg:.4f} degree, the meridian "
            "convergence of the landmarks' CRS at the first frame"
        )
    return Words(
        source="project",
        jobs=False,
        landmark="its name",
        reading="a pick's u or v",
        attack=flight.path.wind_m_s is not None or not np.array_equal(flight.mount, FORWARD),
        altitude=altitude,
        columns={"altitude_m": altitude},
        sigma_keys=_sigma_keys(solved),
        flags={
            "undetermined": (
                "fewer than two landmarks in different directions, or no position: no angles; "
                "what is not known is named",
                "pick two landmarks at least, where two are in view; without a position, look at "
                "the track's times",
            ),
            "outlier": (
                "landmarks do not fit the others (chi-square test, F test where the reading sigma "
                "is estimated, .001 a frame, four landmarks or more); they are named",
                "look at its pick in that image and at its coordinates",
            ),
            "second_solution": (
                "an attitude with the landmarks on the camera's other side fits as well, and the "
                "solve has taken the one with the landmarks in front; or another position within "
                "its standard deviations fits as well, and how far its attitude is turned is named",
                "nothing where the view is beyond doubt; a fourth landmark decides between two "
                "positions",
            ),
        },
        conventions=conventions,
    )


def _unknowns(solved: SolvedFlight) -> str:
    if solved.landmark_m is None:
        return "rotation by {} with the camera's position given"
    return "rotation by {}, with positions and landmarks under their standard deviations"


def _sigma_keys(solved: SolvedFlight) -> dict[str, str]:
    """Say where components of the uncertainty can be stated that the project does not call exact.

    Refraction that is left out is one of them where it would raise lines of sight enough.
    """
    flight = solved.flight
    keys = {name: key for name, key in SIGMA_KEYS.items() if name not in flight.options.exact}
    if flight.shutter is None:
        keys.pop("readout", None)
    if flight.picks.followed is None or not flight.picks.followed.any():
        del keys["click"]
    if flight.refraction.k == 0.0 and "refraction" not in flight.options.parameter_sigma:
        raised_deg = _standard_refraction_deg(solved)
        keys.pop("refraction", None)
        if raised_deg >= LEAST_RAISED_DEG:
            keys["refraction"] = (
                f"[atmosphere] refraction: the standard one raises lines of sight by "
                f"{raised_deg:.2g} degree at most"
            )
    return keys


LEAST_RAISED_DEG = 0.001  # by refraction that is left out: less is not named


def _standard_refraction_deg(solved: SolvedFlight) -> float:
    """Estimate how far standard refraction raises the longest line of sight, degrees."""
    flight, picks = solved.flight, solved.flight.picks
    mark_m = flight.landmarks.position_m[picks.landmark]
    far = np.linalg.norm(mark_m - solved.camera_m[picks.frame], axis=1)
    pick, one = int(np.nan_to_num(far).argmax()), np.zeros(1, np.int64)
    camera_m = solved.camera_m[picks.frame[pick]]
    lines = sight_lines(camera_m[None], mark_m[pick][None], one, one, Refraction())
    return float(np.nan_to_num(np.degrees(lines.raised_rad[0])))


def _refraction(refraction: Refraction, solved: SolvedFlight) -> str:
    if refraction.k == 0.0:
        return "off"
    way = "decaying with height over 8 km" if refraction.decays else "constant"
    raised_deg = np.degrees(solved.raised_most_rad)
    most = ""
    if np.isfinite(raised_deg):
        most = f"; it raises lines of sight by {raised_deg:.5f} degree at most"
    return f"coefficient {refraction.k:g} at the ground, {way}{most}"


def _attack_words(flight: Flight) -> str:
    if flight.path.velocity_m_s is None:
        return "none: the velocity is not known"
    known = flight.path.wind_m_s is not None
    against = "relative to the air" if known else "against the ground, as no wind is given,"
    return ATTACK.format(against=against)


def _time(flight: Flight) -> str:
    if flight.epoch is None:
        return "seconds of the flight"
    zero = flight.epoch.replace(tzinfo=None).isoformat(timespec="microseconds")
    return f"seconds of the flight; zero is {zero}Z"


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
        self._begun: dict[bytes, Estimate] = {}  # whatever the reading sigma
        self._made: dict[bytes, Estimate] = {}
        self._outlier: Bools | None = None  # (P,)
        self._exchanged = np.zeros(0)  # (P,)
        self.doubt = ""  # as `About.doubt`

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
        return replace(scene, adjusted=self._adjusted) if freed else scene

    def _adjusted(self) -> tuple[Sequence[Change], Sequence[str], Floats]:
        """Describe freed parameters and residuals before and after; it solves as stated, too."""
        from vopd.flight.adjust.adjustment import adjustment_of
        from vopd.flight.adjust.table import changes, residual_sizes
        from vopd.flight.result import FlightResult

        made = adjustment_of(FlightResult(self, ()))
        return changes(made), *residual_sizes(made)

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
        assert self.reading is not None
        found = errors_of_sums(self._joint, self.flight.mount.T @ weight, self._held)
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

    def __iter__(self) -> Iterator[Estimate]:
        return (self.of(part.frames) for part in self.blocks)

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


@np.errstate(all="ignore")
def camera_angles(solved: SolvedFlight) -> Floats:
    """Convert the rotations of all frames to camera yaw, pitch, roll (F, 3), degrees."""
    return camera_angles_deg(IMAGE_FROM_CAMERA @ solved.attitudes.rotation)


@np.errstate(all="ignore")
def vehicle_angles(solved: SolvedFlight) -> Floats:
    """Convert the rotations of all frames to vehicle yaw, pitch, roll (F, 3), degrees."""
    return body_angles_deg(_body_to_ned(solved))


@np.errstate(all="ignore")
def turned_vehicle_deg(solved: SolvedFlight, frames: Ints, turn_rad: Floats) -> Floats:
    """Convert small turns of frames to changes of vehicle yaw, pitch, roll (T, 3), degrees.

    Args:
        solved: the flight
        frames: index of the frame of each, (T,); negative: NaN
        turn_rad: about the camera's axes, (T, 3)
    """
    angles = vehicle_angles(solved)[frames]
    by_turns = body_angles_by_turns(np.radians(angles))
    changed = -np.einsum("tij,jk,tk->ti", by_turns, solved.flight.mount, turn_rad)
    return np.where(frames[:, None] >= 0, np.degrees(changed), np.nan)


def _body_to_ned(solved: SolvedFlight) -> Floats:
    rotation = solved.attitudes.rotation.swapaxes(1, 2)
    return np.asarray(NED_FROM_ENU @ rotation @ solved.flight.mount.T)


@np.errstate(all="ignore")
def attack_angles(solved: SolvedFlight) -> AttackAngles:
    """Find the angles of attack of all frames; NaN if the velocity is not known."""
    path, body_to_ned = solved.flight.path, _body_to_ned(solved)
    if path.velocity_m_s is None:
        unknown = np.full((len(body_to_ned), 3), np.nan)
        return angles_of_attack(body_to_ned, unknown, unknown)
    still = np.zeros((len(body_to_ned), 3))
    wind = still.copy()
    if path.wind_m_s is not None:
        wind[:, :2] = path.wind_m_s
    change = still if path.acceleration_m_s2 is None else path.acceleration_m_s2
    return angles_of_attack(body_to_ned, path.velocity_m_s - wind, change)


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
    seen = project(lens, _of_frames(rotation[picks.frame], solved.lines.direction))
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
        velocity_sigma=flight.path.velocity_sigma_m_s,
        grid=_grid(solved),
        gimbal_deg=flight.path.gimbal_deg,
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


def _of_frames(rotation: Floats, direction: Floats) -> Floats:
    return np.asarray(np.einsum("pij,pj->pi", rotation, direction))


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
