"""Clicks that do not fit: on another mast, of another landmark, beside it.

All places tracked from such a click disagree with the others, and agree with each other: it is one
mistake, and named once. A place that is far off is left out by itself, before. Clicks and places
are observations alike: a mistake in one makes others seem wrong, but most is gained without that
one (Baarda, A testing procedure for use in geodetic networks, 1968). A place that one track has
elsewhere than the others is left out, too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.special import chdtrc

from vopd.arrays import Array, Bools, Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE, chance_text
from vopd.findings import Finding, VopdError, count_text, first_of
from vopd.flight.flight import Flight, frame_label, pick_label
from vopd.flight.misfits.exchanged import exchanged_places
from vopd.flight.misfits.input_errors import REJECTED, significant_errors
from vopd.flight.misfits.leave_out import FRAME, PICK, leave_out_picks
from vopd.flight.misfits.stabilised import shifts_of_frames
from vopd.flight.solve.equations import Model
from vopd.flight.solve.errors import every_prior, priors_of
from vopd.flight.solve.joint import JointSolution, solve_jointly

TOLD = 0.1  # of a click's variance that the others must say: with less it is not tested
MOST_WRONG = 0.5  # of the clicks
MOST_TRIED = 5  # clicks that seem wrong and are not, one after the other
MOST_NAMED = 3
EXCHANGED = 6.0  # standard deviations of a click from where the other landmark is computed
SEVERAL = 3  # clicks that seem wrong: fewer are no error of the lens
MEDIAN = 2.0 * np.log(2.0)  # of chi-square of two
ROUNDS = 8  # of leaving out places that are far off, one of each frame
AS_FAR = 0.25  # of the largest gain: places of other frames that are left out with it
FEW = 0.1  # of the readings: if more are far off, each by itself is not what is wrong


def without_wrong_clicks(flight: Flight) -> tuple[Flight, list[Finding]]:
    """Leave out clicks that do not fit the others, and single places that do not.

    They are found with the sigmas that the tracked file states.

    Args:
        flight: as it was read

    Returns:
        The flight without them, and what is said of them.
    """
    try:
        return _without(flight)
    except (VopdError, np.linalg.LinAlgError):  # the solve says why
        return flight, []


def _without(flight: Flight) -> tuple[Flight, list[Finding]]:
    """Leave out one click after the other; those of a landmark all of whose clicks go stay.

    That landmark is what does not fit, and it is tested with the others.
    """
    read, every = flight, flight.picks.clicks
    assert every is not None
    tells: dict[int, str] = {}
    joint, far = _without_far_places(solve_jointly(flight, priors_of(flight)))
    flight = joint.model.flight
    if not joint.settles or _is_of_all(joint):  # tests of such a solution tell nothing
        return read, []
    if joint.stated[0]:  # an error of clock or lens, as large as is stated, is no click's
        joint = solve_jointly(flight, every_prior(flight))
    seems = np.zeros(len(every.frame), bool)  # wrong, and is not
    while seems.sum() < MOST_TRIED and len(tells) < MOST_WRONG * len(every.frame):
        squares = _squares(joint)
        limit = SIGNIFICANCE / max(np.isfinite(squares).sum(), 1)
        squares[seems] = np.nan
        chance = chdtrc(2.0, squares)
        if not (chance < limit).any():
            break
        worst, clicks = int(np.nanargmax(squares)), flight.picks.clicks
        assert clicks is not None
        less = without_readings(flight, clicks.click == worst)
        again = solve_jointly(less, every_prior(less), start=joint.state)
        away_px = _away_px(again, flight, worst)
        size_px = float(every.sigma_px[worst])
        if again.settles and chdtrc(2.0, float((away_px**2).sum()) / size_px**2) < limit:
            flight, joint = less, again
            tells[worst] = _wrong_text(read, worst, away_px, float(chance[worst]))
        else:
            seems[worst] = True
    out = np.isin(np.arange(len(every.frame)), list(tells))
    count, gone = (np.bincount(every.landmark[some], minlength=1) for some in (out | True, out))
    gone = np.append(gone, np.zeros(len(count) - len(gone), np.int64))
    stays = (out & ((gone > 1) & (gone == count))[every.landmark]).tolist()
    wrong, more = [click for click in tells if not stays[click]], list[str]()
    of_wrong = np.isin(every.click, wrong)
    # beside a mistake of another kind places seem far off, or until a wrong click is left out
    alone = np.zeros_like(far)
    if far.any() and not any(stays) and not seems.any():
        alone = far & ~_fits(_errors_px(joint, read), read)
    if any(stays):
        flight = without_readings(read, of_wrong)
    else:
        if (far & ~alone & ~of_wrong).any():
            flight = without_readings(read, of_wrong | alone)
            joint = solve_jointly(flight, joint.model.priors, start=joint.state)
        flight, more = _without_contrary(flight, joint)
    flight = _with_wrong(flight, read, wrong)
    swapped = _exchanged_texts(joint, read, wrong)
    texts = [text for click, text in tells.items() if not stays[click] and click not in swapped]
    texts += [*dict.fromkeys(swapped.values()), *more]
    texts += _far_texts(joint, read, alone & ~of_wrong)
    return flight, [Finding(one, read.source, severity="warning") for one in texts]


def _is_of_all(joint: JointSolution) -> bool:
    """Tell whether one error of lens, clock, positions or picture explains several clicks.

    It is then named by the tests of the flight, and no click is wrong. Places that were tracked
    with such an error may be off by themselves, so that it explains the clicks alone better.
    """
    wrong = _seem_wrong(_squares(joint))
    if wrong:
        shifts = shifts_of_frames(joint)
        if shifts.stabilised and shifts.rest < REJECTED**2:
            return True
    if wrong < SEVERAL:
        return False
    clicks = solve_clicks_alone(joint.model.flight)
    return any(_one_error_explains(one) for one in (joint, clicks))


def _seem_wrong(squares: Floats) -> int:
    """Count clicks whose errors are larger than is stated."""
    limit = SIGNIFICANCE / max(int(np.isfinite(squares).sum()), 1)
    return int((chdtrc(2.0, squares) < limit).sum())


def _one_error_explains(joint: JointSolution) -> bool:
    found = significant_errors(joint, True)
    return bool(found) and found[0].error.landmark < 0 and found[0].rest < REJECTED**2


def solve_clicks_alone(flight: Flight) -> JointSolution:
    """Solve a flight by its clicks, without the places that are tracked from them.

    Args:
        flight: of clicks and tracks
    """
    clicks = flight.picks.clicks
    assert clicks is not None
    tracked = flight.picks.frame[clicks.pick] != clicks.frame[clicks.click]
    alone = without_readings(flight, tracked)
    return solve_jointly(alone, priors_of(alone))


def _without_far_places(joint: JointSolution) -> tuple[JointSolution, Bools]:
    """Leave out places that make clicks seem wrong, and are far from where their clicks have them.

    Args:
        joint: the solution of a flight

    Returns:
        The solution without them, and their readings, (R,).
    """
    first, read, every = joint, joint.model.flight, joint.model.flight.picks.clicks
    assert every is not None
    far = np.zeros(len(every.pick), bool)
    for _ in range(ROUNDS):
        tried = np.zeros_like(far)
        tried[~far] = _suspected_readings(joint)
        if not tried.any():
            return joint, far
        again = _solved_without(read, far | tried, joint)
        fits = chdtrc(2.0, _jumps(again, read)) >= SIGNIFICANCE / len(far)
        if not (tried & ~fits).any():
            return joint, far
        far |= tried & ~fits
        joint = _solved_without(read, far, joint) if (tried & fits).any() else again
        if far.sum() > FEW * len(far):
            break
    return first, np.zeros_like(far)


def _fits(away_px: Floats, flight: Flight) -> Bools:
    """Tell whether readings are no farther off than an error of their click may be, (R,)."""
    clicks = flight.picks.clicks
    assert clicks is not None
    squares = (away_px**2).sum(axis=1) / clicks.sigma_px[clicks.click] ** 2
    return np.asarray(chdtrc(2.0, squares) >= SIGNIFICANCE / len(squares))


def _solved_without(read: Flight, out: Bools, before: JointSolution) -> JointSolution:
    """Solve a flight without some readings, (R,), given a solution before."""
    less = without_readings(read, out)
    return solve_jointly(less, priors_of(less), start=before.state)


def _suspected_readings(joint: JointSolution) -> Bools:
    """Find the readings that gain most by being left out, if clicks seem wrong, (R,).

    They are those of a click, or of the worst pick, and of the worst of other frames. Of a frame
    with two picks nothing tells which one is wrong: both are taken.
    """
    model, squares = joint.model, _squares(joint)
    picks, clicks = model.flight.picks, model.flight.picks.clicks
    assert clicks is not None
    if not _seem_wrong(squares) or model.clicks is None:
        return np.zeros(len(clicks.pick), bool)
    tests, gain = leave_out_picks(joint), np.zeros(len(picks.frame))
    own, whole = tests.kind == PICK, tests.kind == FRAME
    gain[tests.pick[own]] = tests.gain[own]
    gain[model.pick] += model.clicks.squares(joint.state.click_px)
    of_frame, most = np.zeros((2, model.frames))
    of_frame[tests.frame[whole]] = tests.gain[whole]
    used = picks.frame[model.pick]
    two = (np.bincount(used, minlength=model.frames) == 2)[used]
    gain[model.pick] = np.where(two, of_frame[used], gain[model.pick])
    gain = np.nan_to_num(gain)
    np.maximum.at(most, picks.frame, gain)
    if np.nanmax(squares) >= most.max():
        return np.asarray(clicks.click == np.nanargmax(squares))
    worst = (gain > AS_FAR * most.max()) & (gain == most[picks.frame])
    return np.asarray(worst[clicks.pick])


def _jumps(joint: JointSolution, flight: Flight) -> Floats:
    """Weigh how far readings are from where the others of their clicks have them, (R,).

    Chi-square of two by the click's standard deviation, or by the spread of the click's readings
    where that is larger, as with wrong coordinates of a landmark; NaN: there is no image.

    Args:
        joint: the solution
        flight: the flight with all readings
    """
    clicks, away = flight.picks.clicks, _errors_px(joint, flight)
    assert clicks is not None
    squares = np.full(len(away), np.nan)
    for click, sigma_px in enumerate(clicks.sigma_px):
        rows = np.flatnonzero((clicks.click == click) & np.isfinite(away).all(axis=1))
        if len(rows):
            own = ((away[rows] - np.median(away[rows], axis=0)) ** 2).sum(axis=1)
            squares[rows] = own / max(sigma_px**2, float(np.median(own)) / MEDIAN)
    return squares


def _exchanged_texts(joint: JointSolution, read: Flight, wrong: list[int]) -> dict[int, str]:
    """Say which of the clicks that are left out are exchanged.

    Args:
        joint: solved without them
        read: the flight with them
        wrong: their indices
    """
    rows, clicks = _own_rows(read, wrong), read.picks.clicks
    assert clicks is not None
    own, pick = clicks.click[rows], clicks.pick[rows]
    seen, expected = read.picks.pixel[pick] + clicks.off_px[rows], _images_px(joint, read)[pick]
    limit_px = EXCHANGED * clicks.sigma_px[own]
    found: dict[int, str] = {}
    for i, j in exchanged_places(clicks.frame[own], seen, expected, limit_px):
        a, b = (read.landmarks.name[clicks.landmark[own[k]]] for k in (i, j))
        text = (
            f"{frame_label(read, int(clicks.frame[own[i]]))}: the clicks of {a} and {b} are "
            "exchanged: each lies where the other is computed; they and the places that are "
            "tracked from them are not used: exchange their names, and run vopd track again"
        )
        found |= {int(own[i]): text, int(own[j]): text}
    return found


def _own_rows(read: Flight, wrong: list[int]) -> Ints:
    """List the readings that are clicks themselves, of some clicks."""
    clicks = read.picks.clicks
    assert clicks is not None
    of_frame = read.picks.frame[clicks.pick] == clicks.frame[clicks.click]
    return np.flatnonzero(np.isin(clicks.click, wrong) & of_frame)


def _with_wrong(flight: Flight, read: Flight, wrong: list[int]) -> Flight:
    """Keep where clicks are that are left out of a flight, for figures.

    Args:
        flight: without them
        read: the flight with them
        wrong: their indices
    """
    every, left = read.picks.clicks, flight.picks.clicks
    assert every is not None and left is not None
    own = _own_rows(read, wrong)
    pixel = read.picks.pixel[every.pick[own]] + every.off_px[own]
    at = np.stack([every.frame, every.landmark], axis=1)[every.click[own]]
    known = np.concatenate([at, pixel], axis=1)
    return replace(flight, picks=replace(flight.picks, clicks=replace(left, wrong=known)))


def _squares(joint: JointSolution) -> Floats:
    """Weigh the errors that the solve finds of clicks, chi-square of two, (C,); NaN: says little.

    Of the prior P and what is left M the error has the covariance P - M.
    """
    model = joint.model
    size_px = model.common_sigma[model.of_clicks][::2]
    known: Array = joint.factored.common[model.of_clicks, model.of_clicks]
    at = 2 * np.arange(len(size_px))[:, None, None] + np.arange(2)
    left = known[at.swapaxes(1, 2), at]
    told = size_px[:, None, None] ** 2 * np.eye(2) - left
    error = joint.state.click_px[model.clicked]
    tested = np.linalg.eigvalsh(told)[:, 0] > TOLD * size_px**2
    told[~tested] = np.eye(2)
    squares = np.einsum("qi,qi->q", error, np.linalg.solve(told, error[..., None])[..., 0])
    out = np.full(len(joint.state.click_px), np.nan)
    out[model.clicked] = np.where(tested, squares, np.nan)
    return out


def _away_px(joint: JointSolution, flight: Flight, click: int) -> Floats:
    """Find how far a click is off by the places tracked from it, (2,): the median over them.

    Args:
        joint: solved without it
        flight: the flight with it
        click: its index
    """
    clicks = flight.picks.clicks
    assert clicks is not None
    away = _errors_px(joint, flight)[clicks.click == click]
    known = np.isfinite(away).all(axis=1)
    if not known.any():
        return np.zeros(2)
    return np.asarray(np.median(away[known], axis=0))


def _errors_px(joint: JointSolution, flight: Flight) -> Floats:
    """Compare readings with a solution, in the pixels of their clicks, (R, 2); NaN: no image.

    Args:
        joint: the solution; the errors of clicks that it has are taken off
        flight: the flight with all readings
    """
    clicks = flight.picks.clicks
    assert clicks is not None
    place = flight.picks.pixel[clicks.pick] + clicks.off_px
    away = place - _images_px(joint, flight)[clicks.pick]
    errors = np.linalg.solve(clicks.by_click, away[..., None])[..., 0]
    return np.asarray(errors - joint.state.click_px[clicks.click])


def _images_px(joint: JointSolution, flight: Flight) -> Floats:
    """Compute the images of all picks of a flight in a solution, (P, 2); NaN: there is none."""
    count = len(flight.picks.frame)
    found = np.full((count, 2), np.nan)
    solved = np.isfinite(joint.solved.attitudes.rotation[:, 0, 0])
    priors = replace(joint.model.priors, click_px=None)
    every = Model(flight, priors, np.ones(count, bool), solved, flight.picks.sigma_px)
    for rows in every.rows(joint.state):
        residual = rows.residual / every.scale[rows.picks][..., None]
        at = every.pick[rows.picks]
        found[at] = flight.picks.pixel[at] - residual
    return found


def _without_contrary(flight: Flight, joint: JointSolution) -> tuple[Flight, list[str]]:
    """Leave out the reading that is farthest from the solution where readings contradict."""
    model, clicks = joint.model, flight.picks.clicks
    if clicks is None or model.clicks is None:
        return flight, []
    spare = model.clicks.spare
    squares = model.clicks.squares(joint.state.click_px)
    # a match may be worse than its file states, all of them as much
    usual = np.median(squares[spare > 0] / (2.0 * spare[spare > 0])) if spare.any() else 1.0
    chance = chdtrc(2.0 * np.maximum(spare, 1), squares / max(usual, 1.0))
    contrary = np.zeros(len(flight.picks.frame), bool)
    limit = SIGNIFICANCE / max(int((spare > 0).sum()), 1)
    contrary[model.pick] = (spare > 0) & (chance < limit)
    if not contrary.any():
        return flight, []
    rows = np.flatnonzero(contrary[clicks.pick])
    away = np.hypot(*_errors_px(joint, flight).T)[rows]
    order = rows[np.lexsort((-np.nan_to_num(away, nan=np.inf), clicks.pick[rows]))]
    first = np.append(True, np.diff(clicks.pick[order]) > 0)
    out = np.zeros(len(clicks.pick), bool)
    out[order[first]] = True
    labels = [pick_label(flight, int(k)) for k in np.flatnonzero(contrary)]
    told = (
        f"{first_of(labels, MOST_NAMED)}: the places tracked from several clicks contradict each "
        "other; the one that is farthest from the solution is not used"
    )
    return without_readings(flight, out), [told]


def _far_texts(joint: JointSolution, read: Flight, far: Bools) -> list[str]:
    """Say which places are far off, if any.

    Args:
        joint: solved without them
        read: the flight with them
        far: their readings, (R,)
    """
    clicks = read.picks.clicks
    assert clicks is not None
    if not far.any():
        return []
    away, labels = clicks.by_click @ _errors_px(joint, read)[..., None], list[str]()
    for k in np.flatnonzero(far):
        off_px = np.hypot(*away[k, :, 0])
        off = f" ({off_px:.1f} px off)" if np.isfinite(off_px) else ""
        labels.append(pick_label(read, int(clicks.pick[k])) + off)
    return [
        f"{first_of(labels, MOST_NAMED)}: tracked far from where the others have the landmark, and "
        "no error of a click explains that: not used; run vopd track again"
    ]


def _wrong_text(flight: Flight, click: int, away_px: Floats, chance: float) -> str:
    """Say that a click does not fit."""
    clicks = flight.picks.clicks
    assert clicks is not None
    name = flight.landmarks.name[clicks.landmark[click]]
    places = count_text(int((clicks.click == click).sum()) - 1, "place")
    u, v = away_px
    return (
        f"{frame_label(flight, int(clicks.frame[click]))}: the click of {name} does not fit the "
        f"other clicks, it is {np.hypot(u, v):.1f} px off ({u:+.1f}, {v:+.1f}; "
        f"{clicks.sigma_px[click]:g} stated; chance {chance_text(chance)}): it and {places} that "
        "are tracked from it are not used; click it again, and run vopd track again"
    )


def without_readings(flight: Flight, out: Bools) -> Flight:
    """Take readings out of a flight, and picks that have none without them.

    Args:
        flight: of clicks and tracks
        out: readings that are left out, (R,)
    """
    picks, clicks = flight.picks, flight.picks.clicks
    assert clicks is not None
    rows = np.flatnonzero(~out)
    kept = np.unique(clicks.pick[rows])
    left = clicks.readings(rows, np.searchsorted(kept, clicks.pick[rows]))
    shift = np.zeros((len(kept), 2))
    np.add.at(shift, left.pick, left.off_px * left.part[:, None])
    left = replace(left, off_px=left.off_px - shift[left.pick])
    sigma_px = np.bincount(left.pick, left.own_px**-2.0, len(kept)) ** -0.5
    fewer = replace(
        picks,
        frame=picks.frame[kept],
        landmark=picks.landmark[kept],
        pixel=picks.pixel[kept] + shift,
        sigma_px=np.asarray(sigma_px),
        part=None if picks.part is None else picks.part[kept],
        clicks=left,
    )
    return replace(flight, picks=fewer)
