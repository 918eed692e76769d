"""The joint solve of a flight: rotations, errors of fixes, and what its frames have in common.

Weighted least squares of all unknowns under their priors, by Gauss and Newton with Levenberg's
damping, and the covariances of its result by the causes of the errors.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Array, Bools, Floats
from vopd.estimate import COMMON_PART
from vopd.findings import VopdError
from vopd.flight.flight import LEAPS, Flight
from vopd.flight.solve.equations import SHIFT, Model, Priors, Readout, State
from vopd.flight.solve.free import free_parameters
from vopd.flight.solve.normal import NARROW, Factored, Normal, RightSide, frames_by_block, pairs
from vopd.flight.solve.rotations import LOSSES, NOISE_AT_MOST_RAD, SolvedFlight, solve

if TYPE_CHECKING:
    from vopd.flight.solve.held_places import HeldPlaces

NO_PARAMETERS: Mapping[str, Floats] = {}

# Gauss and Newton with Levenberg's damping

PASSES = 60
DONE = 1e-16  # square of a step that needs not be taken, in standard deviations of all unknowns
SMALL = 1e-9  # square of a step whose change of the cost is rounding; one that does not shrink ends
NEAR = 1.0  # square of a step from where on Newton's are tried
NEARER = 0.1  # of that, where they have led away
FIRST_DAMPING, MOST_DAMPING = 1e-3, 1e10
LEAST_DAMPING = 1e-6  # a tenth of it is none
HUNDREDS = 300.0  # standard deviations of the picks that residuals have: the least cost is far
APPROACH = 20  # passes with wider picks
NARROWED, LESS = 10.0, 0.5  # times these, the next time; and of that, residuals that are in reach
SETTLED_RAD = 1e-6  # of a frame's last turn, where the next one is known to be next to nothing


@dataclass(frozen=True, eq=False)
class JointSolution:
    """A flight's rotations, with the places and parameters that were solved with them.

    `solved` has the cameras as solved.
    """

    model: Model
    state: State
    solved: SolvedFlight
    passes: int  # 0 where nothing but rotations is unknown
    formed: Normal | None = None  # `normal`, if the last step has left it

    @property
    def settles(self) -> bool:
        """Whether half of the frames that have an attitude, or more, have converged."""
        known = np.isfinite(self.solved.attitudes.rotation[:, 0, 0])
        return bool(2 * self.solved.attitudes.converged[known].sum() >= known.sum())

    @property
    def holds_places(self) -> bool:
        """Whether positions and landmarks are held where they are stated."""
        return not self.model.flight.options.solve_position

    @cached_property
    def normal(self) -> Normal:
        """The reweighted normal equations at the solution.

        Raises:
            VopdError: if a frame's have no solution
        """
        with solvable(self.model.flight):
            return self.formed or Normal(self.model, self.state)

    @cached_property
    def factored(self) -> Factored:
        """The same with their priors, factored.

        Raises:
            VopdError: if they have no solution
        """
        with solvable(self.model.flight):
            return Factored(self.normal)

    @cached_property
    def covariance(self) -> Covariance:
        """The covariances of rotations and places, by component."""
        return covariance(self)

    @cached_property
    def stated(self) -> tuple[dict[str, float], Floats]:
        """The parameters that are stated and not solved for: their standard deviations, by name.

        With them the changes of the computed images by one standard deviation of each, in
        standard deviations of the picks, (P, 2, C).

        Raises:
            VopdError: if one is without bounds
        """
        model, state = self.model, self.state
        stated = model.flight.options.parameter_sigma.items()
        sigma = {name: one for name, one in stated if one > 0.0 and name not in model.names}
        change = np.zeros((len(model.pick), 2, len(sigma)))
        if not sigma:
            return sigma, change
        more = replace(model.priors, parameter={**model.priors.parameter, **sigma})
        full = model.with_priors(more)
        start = state._replace(parameter=np.concatenate([state.parameter, np.zeros(len(sigma))]))
        for rows in full.rows(start):
            change[rows.picks] = rows.by_parameter[..., len(model.names) :]
        if not np.isfinite(change).all():  # as by refraction through the Earth
            raise no_solution(model.flight)
        return sigma, change * list(sigma.values())

    @cached_property
    def by_stated(self) -> tuple[Floats, Floats, Floats]:
        """Propagate one standard deviation of each of them, as `propagated` does."""
        return propagated(self, self.stated[1])

    @cached_property
    def unfollowed_stated(self) -> Floats:
        """What the unknowns do not follow of them, as `unfollowed` has it."""
        return _unfollowed(self, self.stated[1], self.by_stated)

    @cached_property
    def by_held_places(self) -> HeldPlaces:
        """The errors of positions and landmarks that are held, propagated."""
        from vopd.flight.solve.held_places import HeldPlaces  # of few flights

        return HeldPlaces(self)

    @cached_property
    def marginals(self) -> tuple[Array, Array, Array, Array]:
        """The covariances of turns, places, and what is common, as `marginals` has them."""
        return marginals(self.factored)

    def with_rotations(self, solved: SolvedFlight, flight: Flight) -> JointSolution:
        """Take the same places and parameters with other rotations, and the picks of these.

        Args:
            solved: the flight, its rotations solved at these places
            flight: the flight of this solution
        """
        model, rotation = self.model, solved.attitudes.rotation
        known = np.isfinite(rotation[:, 0, 0])
        taken = solved.used & (solved.attitudes.weight > 0.0)
        own = Model(flight, model.priors, taken, known, flight.picks.sigma_px, loss=model.loss)
        state = self.state._replace(rotation=np.where(known[:, None, None], rotation, np.eye(3)))
        camera_m = flight.path.position_m + own.camera_by_m(state)
        found = replace(solved, flight=flight, camera_m=camera_m, landmark_m=self.solved.landmark_m)
        return JointSolution(own, state, found, self.passes)

    @property
    def beside_free(self) -> State:
        """Take the errors that were solved for without those of freed parameters and of clicks,
        which all tests of residuals take as solved."""
        free = np.isin(self.model.names, free_parameters(self.model.flight))
        return self.state._replace(
            parameter=np.where(free, 0.0, self.state.parameter),
            click_px=np.zeros_like(self.state.click_px),
        )

    @property
    def moved_m(self) -> Floats:
        """From the stated to the solved place, east, north, up (F, 3)."""
        return self.model.moved_m(self.state)

    @cached_property
    def stated_residual(self) -> Floats:
        """Residuals at the stated places and landmarks, (P, 2), linearised here.

        They are the joint residuals and what the errors that were solved for do in the image.
        With the marginal weights they have the cost of the joint solution. Parameters that were
        freed stay as solved.
        """
        model, state = self.model, self.beside_free
        common = model.common_of(state)
        place = np.zeros((model.frames, 3, 1))
        if self.normal.fixes is not None:
            place = self.normal.fixes.at_frames(state.fix_m[..., None])
        moved = self.normal.seen(np.zeros_like(place), place, common[:, None])
        return np.asarray(self.normal.residual + moved[..., 0])


def solve_jointly(
    flight: Flight, priors: Priors, used: Bools | None = None, start: State | None = None,
    readout: Readout | None = None, first: SolvedFlight | None = None,
    since_s: Floats | None = None,
) -> JointSolution:  # fmt: skip
    """Solve rotations, places and parameters of a flight.

    Without priors the rotations are those of `vopd.flight.solve.rotations.solve`.

    Args:
        flight: the flight
        priors: the unknowns besides the rotations
        used: picks that take part, (P,)
        start: where to begin; None: at the stated places
        readout: of a rolling shutter
        first: the flight solved with the same picks; None: it is solved at the stated places
        since_s: times by which the clock's rate counts, (F,); None: since their middle

    Raises:
        VopdError: if the picks do not determine a parameter, or unknowns are too many
    """
    left_out = None if used is None else ~used
    loss = LOSSES[flight.options.loss]
    first = first or solve(widened(flight, priors), left_out)
    rotation, weight = first.attitudes.rotation, first.attitudes.weight
    solved, taken = np.isfinite(rotation[:, 0, 0]), first.used & (weight > 0.0)
    model = Model(flight, priors, taken, solved, flight.picks.sigma_px, readout, loss)
    model.since_s = model.since_s if since_s is None else since_s
    known = np.where(solved[:, None, None], rotation, np.eye(3))
    _check_size(model)
    if priors.fixes is None and not len(model.common_sigma) and readout is None:
        return JointSolution(model, model.start(known), first, 0)
    state = model.start(known)
    if start is not None:
        # one without a solution before has none to begin with
        begun = solved & (start.rotation != np.eye(3)).any(axis=(1, 2))
        click_px = np.zeros_like(start.click_px)  # 0 for clicks that are left out
        click_px[model.clicked] = start.click_px[model.clicked]
        rotation = np.where(begun[:, None, None], start.rotation, known)
        state = start._replace(rotation=rotation, click_px=click_px)
    with solvable(flight):
        begin = Normal(model, state)
        # a pick that was left out has no image
        if start is not None and not np.isfinite(begin.cost):
            begin = Normal(model, model.start(known))
        normal, turn, passes, settled = _descend(_approached(begin))
    weight = np.zeros_like(weight)
    weight[model.pick] = normal.weight * model.scale**2
    attitudes = first.attitudes._replace(
        rotation=np.where(solved[:, None, None], normal.state.rotation, np.nan),
        correction_rad=np.where(solved[:, None], turn, np.nan),
        converged=solved
        & (np.abs(turn).max(axis=1) < (SETTLED_RAD if settled else NOISE_AT_MOST_RAD)),
        weight=weight,
    )
    camera_m = flight.path.position_m + model.camera_by_m(normal.state)
    landmark_m = flight.landmarks.position_m + model.landmark_by_m(normal.state)
    found = replace(
        first, flight=flight, camera_m=camera_m, attitudes=attitudes, landmark_m=landmark_m
    )
    return JointSolution(model, normal.state, found, passes, normal if normal.plain else None)


MOST_COMMON = 3_000  # unknowns that all frames have in common: a dense matrix
MOST_NUMBERS = 100_000_000  # of the covariances of all turns with what is common


def _check_size(model: Model) -> None:
    """Refuse more unknowns in common than are solved for."""
    count, landmarks = len(model.common_sigma), len(model.free)
    most = min(MOST_COMMON, MOST_NUMBERS // max(3 * model.frames, 1))
    clicks = len(model.clicked)
    if count > most and clicks > landmarks:
        raise VopdError(
            f"{model.flight.source}: places are tracked from {clicks} clicks, and "
            f"{max(most - count + 2 * clicks, 0) // 2} can be solved for with {model.frames} "
            "frames; track the flight in parts, a project for each, or every second frame"
        )
    if count > most:
        raise VopdError(
            f"{model.flight.source}: {landmarks} landmarks with a standard deviation are seen, and "
            f"{most // 3} can be solved for with {model.frames} frames; call the best known ones "
            'exact (sigma_m exact in their rows), or hold all by [solve] position = "fixed"'
        )


@contextmanager
def solvable(flight: Flight) -> Iterator[None]:
    """Refuse a flight whose equations, which are solved meanwhile, have no solution.

    Raises:
        VopdError: asking for a coordinate that is far off
    """
    try:
        yield
    except np.linalg.LinAlgError as error:
        raise no_solution(flight) from error


def no_solution(flight: Flight) -> VopdError:
    """Make the error of a flight whose equations have no solution, naming what is far off."""
    leaps = [one.message for one in flight.findings if one.message.endswith(LEAPS)]
    doubted = [f"Doubtful is: {one.message}." for one in flight.findings[:1]]
    far = leaps[0] if leaps else _far_landmark(flight) or " ".join([FAR_OFF, *doubted])
    advice = HOLD if flight.options.solve_position else ""
    return VopdError(
        f"{flight.source}: the equations of its positions and landmarks have no solution within "
        f"rounding: {far}{advice}"
    )


FAR_OFF = "is a coordinate far off, or a number of the lens?"
HOLD = (
    ' [solve] position = "fixed" holds both where they are stated, and warns of those that do not '
    "fit"
)


FAR_TIMES = 30.0  # as far away as most landmarks: where its coordinates may be wrong


def _far_landmark(flight: Flight) -> str:
    """Say of the farthest landmark how far it is, if most are much nearer; else empty."""
    distance_m = flight.pick_range_m
    known = np.isfinite(distance_m)
    if not known.any():
        return ""
    farthest, usual_m = int(np.nanargmax(distance_m)), float(np.median(distance_m[known]))
    if not distance_m[farthest] > FAR_TIMES * usual_m:
        return ""
    name = flight.landmarks.name[flight.picks.landmark[farthest]]
    far_km = distance_m[farthest] / 1000.0
    return (
        f"landmark {name} is {far_km:,.4g} km from the camera, most are {usual_m / 1000.0:.2g} km: "
        "correct its coordinates, or leave it out."
    )


def widened(flight: Flight, priors: Priors) -> Flight:
    """Widen the picks' standard deviations for a first solve of rotations alone.

    By those of their clicks, and for a robust loss by those of places: otherwise an error of the
    place makes blunders of good picks.
    """
    flight = replace(flight, picks=flight.picks.with_clicks_as_own)
    if flight.options.loss == "least-squares":
        return flight
    place = [priors.parameter.get(name, 0.0) for name in SHIFT]
    further = sum(one**2 for one in place if np.isfinite(one)) / 3.0
    if priors.fixes is not None:
        further += float((priors.fixes.frame_sigma_m**2).mean())
    own = np.full(len(flight.landmarks.name), further)
    if priors.landmark_m is not None:
        own = own + (priors.landmark_m**2).mean(axis=1)
    return widened_by(flight, own)


def widened_by(flight: Flight, variance_m2: Floats) -> Flight:
    """Widen the picks' standard deviations by variances of their landmarks, (N,)."""
    picks, marks = flight.picks, flight.landmarks
    away = marks.position_m[picks.landmark] - flight.path.position_m[picks.frame]
    scale = flight.pick_focal_px / np.linalg.norm(away, axis=1)
    wider = np.sqrt(picks.sigma_px**2 + variance_m2[picks.landmark] * scale**2)
    return replace(flight, picks=replace(picks, sigma_px=wider))


def _descend(normal: Normal, most: int = PASSES) -> tuple[Normal, Floats, int, bool]:
    """Descend to the least cost: the equations there, last turns, passes, and if it was reached.

    Reweighting alone never raises the cost of a robust loss, and closes in slowly; Newton's
    steps begin where its own have become small. Only frames that a step makes worse are damped:
    a blunder in one would hold back all. The damping is less after two good steps.
    """
    model = normal.model
    robust = model.loss is not LOSSES["least-squares"]
    own, common, before, newton = np.zeros(model.frames), 0.0, np.inf, False
    turn, near, fell = np.zeros((model.frames, 3)), NEAR, True
    passes = 0
    while passes < most:
        passes += 1
        worse = np.ones(model.frames, bool)
        try:
            step = Factored(normal, common).solve(normal.right)
        except np.linalg.LinAlgError:
            if not newton:  # with the loss's own curvature a pick may seem to say less than nothing
                _check_observed(model, normal)
        else:
            size = _size(normal, step)
            turn, fix, moved = (one[..., 0] for one in step)
            tried = normal.state.moved(turn, fix, moved, model.free, model.clicked)
            less = np.where(own > LEAST_DAMPING, own / 10.0, 0.0) if fell else own
            there = Normal(model, tried, newton, damping=less)
            worse = there.frame_cost > normal.frame_cost
            if there.cost <= normal.cost or (size < SMALL and np.isfinite(there.cost)):
                shrinks = size / before if np.isfinite(before) else 1.0
                settled = size * min(shrinks, 1.0) < DONE or (size < SMALL and shrinks > 0.25)
                normal, own, before = there, less, size
                if fell:
                    common = common / 10.0 if common > LEAST_DAMPING else 0.0
                fell = True
                if settled and not own.any() and common == 0.0:
                    return normal, turn, passes, True
                if robust and not newton and size < near:
                    normal, newton = normal.again(True, damping=own), True
                continue
        fell = False
        if model.priors.fixes is None or not worse.any() or (worse & (own > 1.0)).any():
            common = 10.0 * common if common else FIRST_DAMPING
        own = np.where(worse, np.where(own > 0.0, 10.0 * own, FIRST_DAMPING), own)
        if newton and max(common, own.max()) > 1.0:
            newton, own, common, before = False, np.zeros_like(own), 0.0, np.inf
            near *= NEARER
        if common > MOST_DAMPING:
            break
        normal = normal.again(newton, damping=own)
    return normal, turn, passes, False


def _approached(begin: Normal) -> Normal:
    """Approach the least cost with picks whose standard deviations are widened, less each time.

    Where residuals are hundreds of times what is stated, as far from the camera's place, the least
    cost lies along a narrow curved valley: with wider picks the way is straight. It ends where
    residuals stay, as with a wrong lens.
    """
    model, best, wider = begin.model, begin, _usual_residual(begin)
    if not HUNDREDS < wider < np.inf:
        return begin
    while wider > NARROWED:
        wide = copy(model)
        wide.scale = model.scale / wider
        there = Normal(model, _descend(Normal(wide, best.state), APPROACH)[0].state)
        if not there.cost < best.cost:
            break
        best, left = there, _usual_residual(there)
        if left > LESS * wider:
            break
        wider = min(wider / NARROWED, left)
    return best


def _usual_residual(normal: Normal) -> float:
    """Estimate the root mean square of the residuals, in standard deviations of the picks."""
    return float(np.sqrt((normal.residual**2).mean())) if len(normal.residual) else 0.0


def _size(normal: Normal, step: tuple[Floats, Floats, Floats]) -> float:
    """Measure a step in standard deviations of all unknowns, squared."""
    right, (turn, fix, common) = normal.right, step
    total = float((right.turn * turn).sum() + (right.common * common).sum())
    if normal.fixes is None:
        return total
    place = normal.fixes.at_frames(fix)
    return total + float((right.fix * fix).sum() + (right.place * place).sum())


def _check_observed(model: Model, normal: Normal) -> None:
    """Check that each parameter without a prior is seen by a pick.

    Raises:
        VopdError: naming those that are not
    """
    free = ~np.isfinite(model.sigma)
    own = np.diag(normal.common)[: len(free)]
    missing = [n for n, f, o in zip(model.names, free, own, strict=True) if f and not o > 0.0]
    if missing:
        names = ", ".join(missing)
        raise VopdError(f"no pick depends on {names}: state a standard deviation or leave it out")


# Covariances

UNKNOWN_M = 1e3  # a move of cameras that stands for that of an infinite standard deviation
DERIVATIVE = 1e-30  # imaginary part that carries a derivative: its square is nothing


class Covariance(NamedTuple):
    """Covariances of turns of F frames about the camera's axes, rad^2, and of their places."""

    turn: Floats  # (F, 3, 3)
    component: dict[str, Floats]  # (F, 4, 4) each, of turn and time, s; those in common marked
    place_m2: Floats  # (F, 3, 3) east, north, up
    place_prior_m2: Floats  # (F, 3, 3)
    turn_place: Floats  # (F, 3, 3) of both, rows: the turn


def covariance(solution: JointSolution) -> Covariance:
    """Estimate the covariances of rotations and places, by component.

    Those by component are of the turns and of the error of the frame's time, which is not 0 if
    the clock is solved for: the velocity depends on it, and both are estimated from one flight.

    The part of errors p with the prior P in the variance of x is Cov(x, p) P^-1 Cov(p, x), and
    so the derivative of Cov(x, x) by a factor of P. For fixes, which are many, that derivative
    is carried through the elimination as an imaginary part.
    """
    model, robust = solution.model, solution.model.loss is not LOSSES["least-squares"]
    if model.priors.fixes is None:
        factored, found = solution.factored, solution.marginals
    else:
        factored = Factored(solution.normal, fix_scale=1.0 + 1j * DERIVATIVE)
        found = marginals(factored)
    turn, place, mixed, by_common = found
    late = late_by_common(model)
    whole = _with_late(turn, by_common, late, factored.common)
    late_by = late[:, None] @ factored.common.real
    component = _by_component(model, np.concatenate([by_common.real, late_by], axis=1))
    if model.priors.fixes is not None:
        component["position"] = np.asarray(-whole.imag / DERIVATIVE)
        between = model.priors.fixes.between
        if between is not None:
            gaps = Factored(solution.normal, fix_scale=1.0 + 1j * DERIVATIVE * between[:, None])
            component["interpolation"] = _derivative(gaps, late)
            component["position"] -= component["interpolation"]
            if model.priors.fixes.exact:
                del component["position"]
    given = sum(component.values(), np.zeros(whole.shape))
    reading = np.asarray(whole.real) - given
    if robust:  # a pick of weight w has the variance w^2, and its part is as much less
        varied = Factored(solution.normal.again(carry=1j * DERIVATIVE))
        reading = _derivative(varied, late)
    component = {"reading": reading} | component
    total = (given + reading)[:, :3, :3]
    return Covariance(total, component, place.real, _prior_places(model), mixed.real)


def late_by_common(model: Model) -> Floats:
    """Differentiate the errors of the frames' times by what is common to them, (F, K)."""
    out = np.zeros((model.frames, len(model.common_sigma)))
    out[:, : len(model.names)] = model.late_by(model.names)
    return out


def _with_late(turn: Array, by_common: Array, late: Floats, common: Array) -> Array:
    """Add the error of each frame's time to the covariances of turns, (F, 4, 4)."""
    mixed = np.einsum("fik,fk->fi", by_common, late)
    out = np.empty((len(turn), 4, 4), turn.dtype)
    out[:, :3, :3], out[:, :3, 3], out[:, 3, :3] = turn, mixed, mixed
    out[:, 3, 3] = np.einsum("fk,kl,fl->f", late, common, late, optimize=True)
    return out


def _derivative(factored: Factored, late: Floats) -> Floats:
    """Take the part of what the imaginary part of the equations varies, (F, 4, 4)."""
    turn, _, _, by_common = marginals(factored)
    return np.asarray(-_with_late(turn, by_common, late, factored.common).imag / DERIVATIVE)


def _by_component(model: Model, by_common: Floats) -> dict[str, Floats]:
    """Add up the parts of what is common, (B, a, a), from covariances (B, a, K) with it."""
    scaled = by_common / model.common_sigma
    found = {}
    for name in dict.fromkeys(model.component):
        own = scaled[:, :, [one == name for one in model.component]]
        found[name + COMMON_PART] = own @ own.swapaxes(1, 2)
    return found


def covariance_by_picks(solution: JointSolution) -> tuple[Floats, Floats]:
    """Estimate the covariance of what is common to the frames, and its part by the picks, (K, K).

    With a robust loss a pick of weight w has the variance w^2, as in `covariance`.
    """
    model, total = solution.model, np.asarray(solution.factored.common)
    if not len(total):
        return total, total
    scale = 1.0 + 1j * DERIVATIVE
    varied = Factored(solution.normal, fix_scale=scale, common_scale=scale).common
    given = -varied.imag / DERIVATIVE
    if model.loss is LOSSES["least-squares"]:
        return total, np.asarray(total - given)
    varied = Factored(solution.normal.again(carry=1j * DERIVATIVE)).common
    by_picks = np.asarray(-varied.imag / DERIVATIVE)
    return given + by_picks, by_picks


def marginals(factored: Factored) -> tuple[Array, Array, Array, Array]:
    """Estimate covariances of turns, places, both (F, 3, 3), of turns and what is common (F, 3, K).

    A turn is u - Gx x - Gc c, with u by the readings of its own frame; the place is x = x0 - Z c
    with x0 by the fixes. So the turn is u - Gx x0 - E c with E = Gc - Gx Z.
    """
    normal, model, common = factored.normal, factored.model, factored.common
    frames, size, fixes = model.frames, normal.size, factored.fixes
    kind = np.result_type(common, *(one.inverse for one in normal.parts[:1]))
    unknown = complex(np.nan, np.nan) if kind == np.complex128 else np.nan
    turn, place, mixed = (np.full((frames, 3, 3), unknown, kind) for _ in range(3))
    by_common = np.full((frames, 3, size), unknown, kind)
    through = fixes.at_frames(factored.back) if fixes is not None else np.zeros((frames, 3, size))
    own = places_by_fixes(factored)
    for one in normal.parts:
        gains = one.inverse @ one.mixed
        by_place = np.zeros((len(one.frames), 3, 3))
        if fixes is not None:
            by_place, gains = gains[..., :3], gains[..., 3:]
        e = np.zeros((len(one.frames), size + 3, 3), gains.dtype)
        np.add.at(e, (np.arange(len(e))[:, None], one.column), gains.swapaxes(1, 2))
        e = e[:, :size].swapaxes(1, 2) - by_place @ through[one.frames]
        x0, z = own[one.frames], model.place_by_common(one.frames) - through[one.frames]
        by = e @ common
        turn[one.frames] = (
            one.inverse + by_place @ x0 @ by_place.swapaxes(1, 2) + by @ e.swapaxes(1, 2)
        )
        place[one.frames] = x0 + z @ common @ z.swapaxes(1, 2)
        mixed[one.frames] = -by_place @ x0 - by @ z.swapaxes(1, 2)
        by_common[one.frames] = -by
    return turn, place, mixed, by_common


def places_by_fixes(factored: Factored) -> Array:
    """Estimate covariances of the places by the fixes, what is common being known (F, 3, 3)."""
    fixes = factored.fixes
    if fixes is None or factored.chain is None:
        return np.zeros((factored.model.frames, 3, 3))
    diagonal, beside = factored.chain.selected_inverse()
    out = np.zeros((len(fixes.block), 3, 3), diagonal.dtype)
    if fixes.together > NARROW:
        shape = -1, 3, fixes.together, 3
        for block, some in frames_by_block(fixes, np.arange(len(out))):
            weight = fixes.by_block[some].reshape(-1, 2, fixes.together)
            own = (diagonal[block], beside[block], diagonal[block + 1])
            for (a, b), part in zip(((0, 0), (0, 1), (1, 1)), own, strict=True):
                flat = part.reshape(fixes.together, -1)
                left = (weight[:, a] @ flat).reshape(shape)
                both = (left * weight[:, b, None, :, None]).sum(axis=2)
                out[some] += both if a == b else both + both.swapaxes(1, 2)
        return out
    for one, other in pairs(fixes.by_block):
        (upper, row), (lower, column) = divmod(one, fixes.together), divmod(other, fixes.together)
        rows, columns = slice(3 * row, 3 * row + 3), slice(3 * column, 3 * column + 3)
        if upper == lower:
            part = diagonal[fixes.block + upper, rows, columns]
        elif upper < lower:
            part = beside[fixes.block, rows, columns]
        else:
            part = beside[fixes.block, columns, rows].swapaxes(1, 2)
        out += part * (fixes.by_block[:, one] * fixes.by_block[:, other])[:, None, None]
    return out


def _prior_places(model: Model) -> Floats:
    """Add up prior covariances of the frames' places, east, north, up (F, 3, 3)."""
    by = model.place_by_common(np.arange(model.frames))
    most = np.abs(by).max(axis=(0, 1), initial=0.0)
    unknown = UNKNOWN_M / np.where(most > 0.0, most, 1.0)
    by = by * np.where(np.isfinite(model.common_sigma), model.common_sigma, unknown)
    out = by @ by.swapaxes(1, 2)
    if model.priors.fixes is not None:
        out[:, np.arange(3), np.arange(3)] += model.priors.fixes.frame_sigma_m**2
    return np.asarray(out)


def covariance_of_sums(
    solution: JointSolution, weight: Floats, by_parameter: Mapping[str, Floats] = NO_PARAMETERS
) -> tuple[Floats, dict[str, Floats]]:
    """Estimate the covariance of k sums over frames, with the whole covariance of the flight.

    Args:
        solution: of the flight
        weight: what a turn of each frame about the camera's axes adds to the sums, (F, 3, k)
        by_parameter: what parameters, by their names, add to the sums besides, (k,) each

    Returns:
        The covariance (k, k), and its components.
    """
    model, normal, k = solution.model, solution.normal, weight.shape[2]
    turn, fix, common = solution.factored.solve(right_of_sums(solution, weight, by_parameter))
    place = np.zeros_like(weight)
    found = {name: one[0] for name, one in _by_component(model, common.T[None]).items()}
    if normal.fixes is not None:
        place = normal.fixes.at_frames(fix)
        scaled, between = fix / model.fix_sigma_m[..., None], normal.fixes.between
        if between is not None:
            found["interpolation"] = np.einsum("jik,jil->kl", scaled[between], scaled[between])
            scaled = scaled[~between]
        if not normal.fixes.exact:
            found["position"] = np.einsum("jik,jil->kl", scaled, scaled)
    seen = normal.seen(turn, place, common) * normal.weight[:, None, None]
    by_readings = np.einsum("pik,pil->kl", seen, seen)
    if model.clicks is not None:  # by what readings of the same picks differ
        own = common[model.of_clicks]
        by_readings = by_readings + own.T @ model.clicks.normal @ own
    found = {"reading": by_readings} | found
    return sum(found.values(), np.zeros((k, k))), found


def right_of_sums(
    solution: JointSolution, weight: Floats, by_parameter: Mapping[str, Floats]
) -> RightSide:
    """Write sums over frames as right sides; the arguments are those of `covariance_of_sums`."""
    model, k = solution.model, weight.shape[2]
    nothing = np.zeros((*model.fix_sigma_m.shape, k))
    own = np.zeros((solution.normal.size, k))
    for row, name in enumerate(model.names):
        own[row] = by_parameter.get(name, 0.0)
    return RightSide(weight, np.zeros_like(weight), nothing, own)


def seen_by_sums(solution: JointSolution, right: RightSide) -> Floats:
    """Find what k sums of the unknowns lose by the images of picks, (P, 2, k).

    Args:
        solution: of the flight
        right: what each unknown adds to the sums
    """
    normal = solution.normal
    turn, fix, common = solution.factored.solve(right)
    place = np.zeros_like(turn) if normal.fixes is None else normal.fixes.at_frames(fix)
    return np.asarray(normal.seen(turn, place, common) * normal.weight[:, None, None])


def propagated(solution: JointSolution, change: Floats) -> tuple[Floats, Floats, Floats]:
    """Propagate errors that are not solved for: turns (F, 3, k), fixes (J, 3, k), and what is
    common (K, k).

    Args:
        solution: of the flight
        change: of the computed images by one standard deviation of each error, in standard
            deviations of the picks, (P, 2, k)
    """
    weighted = -change * solution.normal.weight[:, None, None]
    return solution.factored.solve(solution.normal.right_side(weighted))


def weighed(joint: JointSolution, change: Floats) -> tuple[Floats, Floats]:
    """Weigh changes of the images as the residuals are: their products, and those with residuals.

    Args:
        joint: the solution of a flight
        change: of the computed images, in standard deviations of the picks, (P, 2, k)

    Returns:
        X'WX (k, k) and X'Wr (k,).
    """
    left, normal, k = unfollowed(joint, change), joint.normal, change.shape[2]
    square = change.reshape(-1, k).T @ left.reshape(-1, k)
    right = np.einsum("pik,pi->k", change * normal.weight[:, None, None], normal.residual)
    return (square + square.T) / 2.0, right


def unfollowed(joint: JointSolution, change: Floats) -> Floats:
    """Take from changes of the images what the unknowns follow of them, weighted, (P, 2, k).

    Args:
        joint: the solution of a flight
        change: of the computed images, in standard deviations of the picks, (P, 2, k)
    """
    return _unfollowed(joint, change, propagated(joint, change))


def _unfollowed(
    joint: JointSolution, change: Floats, moved: tuple[Floats, Floats, Floats]
) -> Floats:
    normal, (turn, fix, common) = joint.normal, moved
    place = np.zeros_like(turn)
    if normal.fixes is not None:
        place = normal.fixes.at_frames(fix)
    left = change + normal.seen(turn, place, common)
    return np.asarray(left * normal.weight[:, None, None])
