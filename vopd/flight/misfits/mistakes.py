"""Mistakes that would explain a flight's residuals."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.estimate import Estimate
from vopd.findings import VopdError, listed
from vopd.flight.coordinates import M_PER_FT, level_of_heights_m
from vopd.flight.estimate import FlightEstimates, flight_estimate
from vopd.flight.flight import Flight
from vopd.flight.misfits.input_errors import (
    OF_LANDMARK,
    OTHER_MODEL,
    TYPICAL,
    UNEXPLAINED,
    of_other_model,
    of_stated_text,
    times_as_far,
    within_stated_text,
)
from vopd.flight.project.keys import Project
from vopd.flight.project.read import flight_of
from vopd.flight.project.track import height_datum
from vopd.flight.solve.rotations import FlightBlocks, solve
from vopd.geometry.earth import earth_centred_m, geodetic
from vopd.geometry.lenses import MODELS, Lenses
from vopd.inputs import gps_ahead_s
from vopd.mistakes import Explanation, Mistake, explanations, likeliest

DOUBTED = 2.0  # in standard deviations of a pick: from there on mistakes are tried
LEAST_FREEDOM = 4  # more residuals than angles: with fewer, one number explains nearly all
BETTER = 5.0  # a mistake is named where the residuals are so many times smaller without it
ALIKE = 1.3  # residuals of trials that explain a flight as well
MISFIT = 5.0  # in standard deviations of a pick: from there on they are said not to be explained
CAREFUL_PX = 0.5  # residuals that careful picks have
UNSEEN_PX = 1000.0  # what a pick counts whose landmark would have no image
FRAMES_TRIED = 500  # of more frames some are left out
MOST_PICKS = 4.0  # of a frame that is tried, in those that frames usually have
TRIAL_PASSES = 6  # from Wahba's rotation, which are enough where a trial explains the residuals
TRIAL_PICKS = 100_000  # of all landmarks together that are left out one by one
FRAME_RATES_HZ = (10.0, 15.0, 23.976, 24.0, 25.0, 29.97, 30.0, 48.0, 50.0, 59.94, 60.0, 120.0)
MOST_RATIO, SAME = 3.0, 1e-4  # of frame rates that are tried, and of those that are the same
LEAST_LEVEL_M = 150.0  # of the landmarks' heights: a smaller error of the level is estimated
NEAR_PAD_M = 100.0  # by which the pad may be above or below the landmarks
LENS_SIZES = 2.0, 0.5, 1.5, 2.0 / 3.0  # of a calibration, in the size of the images
MOST_EXCHANGED = 8  # landmarks of which each two are exchanged
SMALL = (
    "no usual mistake explains them, and careful picks have as much: is the standard deviation of "
    "a pick stated too small?"
)


def usual_mistakes(
    project: Project, estimates: FlightEstimates, named: bool = False, exchanged: bool = False
) -> list[str]:
    """Name the mistake that explains large residuals best.

    Args:
        project: the project, which is read anew with another clock
        estimates: its solution
        named: whether an error of its inputs is named already; one of `UNIT_MISTAKES` is then
            named in its place if it explains all residuals
        exchanged: whether `exchanges` has tried axes and labels, and found nothing
    """
    sigma = float(np.median(estimates.flight.picks.sigma_px))
    flight, joint = some_frames(estimates.flight), estimates.joint
    far = joint is not None and times_as_far(joint) > 0.0
    known = flight is estimates.flight and not far
    estimate = estimates.whole() if known else solved_trial(flight)
    before = typical_px(flight, estimate)
    if before > DOUBTED * sigma and freedom(estimate) >= LEAST_FREEDOM:
        tables = (AXES_MISTAKES, USUAL_MISTAKES)
        if named or exchanged:
            tables = ((), UNIT_MISTAKES if named else (*UNIT_MISTAKES, *LANDMARK_MISTAKES))
        axes, found = (explanations(table, trial_px, project, flight, estimate) for table in tables)
        # a number that is fitted never fits worse than the mistake that has its value
        below = DOUBTED * sigma if named and not far else np.inf
        text = _best_text(_size_text(flight, estimate, before), before, axes, found, below)
        if text or named:
            return [text] * bool(text)
    if before > MISFIT * sigma:
        if joint is not None and (text := within_stated_text(joint, sigma)):
            return [text]
        size = _size_text(flight, estimate, before)
        by_hand = flight.picks.clicks is None
        return [f"{size}: {SMALL if by_hand and before < CAREFUL_PX else UNEXPLAINED}"]
    return []


def exchanges(flight: Flight, expected_px: float) -> list[str] | None:
    """Name the exchange of image axes or of labels that explains large residuals; or nothing.

    Returns:
        The sentence, if there is any; None where nothing is tried, as the residuals are not large.
    """
    flight = some_frames(flight)
    estimate = solved_trial(flight)
    before = typical_px(flight, estimate)
    if freedom(estimate) < LEAST_FREEDOM or before < BETTER * expected_px:
        return None
    axes, labels = (
        explanations(table, trial_px, None, flight, estimate)
        for table in (AXES_MISTAKES, (*LEVEL_MISTAKES, *PLACE_MISTAKES, *LABEL_MISTAKES))
    )
    text = _best_text(_size_text(flight, estimate, before), before, axes, labels)
    return [text] * bool(text)


def _best_text(
    size: str,
    before: float,
    axes: list[Explanation],
    others: list[Explanation],
    below: float = np.inf,
) -> str:
    """Describe the likeliest mistake that makes residuals `BETTER`; empty if there is none."""
    below = min(before / BETTER, below, UNSEEN_PX / 2.0)
    best = likeliest([*axes, *others], ALIKE, below=below)
    if best is None:
        return ""
    advice = best.advice
    if best in axes:  # both mirror the image: they differ by a quarter turn about its centre
        alike = [one for one in axes if one.residual <= ALIKE * best.residual]
        advice = " or ".join(one.advice for one in alike) + MIRRORED
    elif best.name == RATE:
        rates = [f"{one.values[0]:g}" for one in others
                 if one.name == RATE and one.residual <= ALIKE * best.residual]  # fmt: skip
        advice = RATE_ADVICE.format(" or ".join(rates), *best.values[1:])
    return f"{size}, and {best.residual:.1f} px {advice}"


# Residuals without a mistake


def some_frames(flight: Flight) -> Flight:
    """Choose `FRAMES_TRIED` frames evenly, and none with many more picks than most.

    Arrays by frame and pick then have few empty elements.
    """
    blocks = FlightBlocks(flight)
    frames = np.arange(0, len(flight.frame), max(-(-len(flight.frame) // FRAMES_TRIED), 1))
    count = blocks.layout.count[frames]
    several = count[count >= 2]
    most = MOST_PICKS * np.median(several) if len(several) else np.inf
    return blocks.part(frames[count <= most]).flight


def solved_trial(flight: Flight) -> Estimate:
    """Solve a flight in few passes."""
    return flight_estimate(solve(flight, passes=TRIAL_PASSES))


def freedom(estimate: Estimate) -> int:
    """Count the residuals that there are beyond the angles."""
    used = estimate.used[np.isfinite(estimate.camera_deg[:, 0])]
    return int(2 * used.sum() - 3 * len(used))


def _size_text(flight: Flight, estimate: Estimate, size_px: float) -> str:
    """Say how large residuals are, or that most landmarks cannot be used."""
    count, missing = _picks_missing(flight, estimate)
    if 2 * missing.sum() >= count.sum():  # or the median is between a residual and UNSEEN_PX
        return f"most landmarks cannot be used {TYPICAL}"
    return f"residuals are {size_px:.1f} px {TYPICAL}"


def _picks_missing(flight: Flight, estimate: Estimate) -> tuple[Ints, Ints]:
    """Count the picks of each frame that should take part, and those without an image, (F,)."""
    used = flight.landmarks.takes_part
    frame = flight.picks.frame
    here = used[flight.picks.landmark] & np.isfinite(flight.path.position_m[frame, 0])
    count = np.bincount(frame[here], minlength=len(flight.frame))
    return count, count - estimate.used.sum(axis=1)


def typical_px(flight: Flight, estimate: Estimate) -> float:
    """Find the root mean square residual of the median frame, which one wrong pick does not move.

    Picks that should take part and have no image count `UNSEEN_PX`. Frames without a
    position, or with one pick, have no attitude whatever is mistaken, and do not count.
    """
    count, missing = _picks_missing(flight, estimate)
    squares = (estimate.residual**2).sum(axis=1) + missing * UNSEEN_PX**2
    several = count >= 2
    if not several.any():
        return UNSEEN_PX
    return float(np.median(np.sqrt(squares[several] / (2.0 * count[several]))))


def trial_px(flight: Flight) -> float:
    """Solve a flight without a mistake for its typical residual; infinite if it has too few."""
    estimate = solved_trial(flight)
    return typical_px(flight, estimate) if freedom(estimate) >= LEAST_FREEDOM else np.inf


# The usual mistakes

Corrected = Iterator[tuple[Flight, tuple[object, ...]]]
"""Flights without a mistake, each with the values that the advice names."""


def _turned_over(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Count v of all pixels the other way than the project says."""
    rows = flight.lens.of(flight.picks.frame).by_rows("size_px")[..., 1]
    upward = flight.picks.pixel * [1.0, -1.0]
    upward[:, 1] += rows - 1.0
    way = "down" if flight.picks.v_up else "up"
    advice = IN_FILE if flight.picks.v_said else f'give [picks] v = "{way}"?'
    yield replace(flight, picks=replace(flight.picks, pixel=upward)), (f"{way}ward", advice)


def _exchanged_axes(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Exchange u and v of all picks."""
    exchanged = flight.picks.pixel[:, ::-1]
    yield replace(flight, picks=replace(flight.picks, pixel=exchanged)), ()


def _from_feet(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Take the heights of landmarks, of the camera, or of both for feet."""

    def lower(section: str, position_m: Floats) -> Floats:
        own = project.section(section)
        datum, where = height_datum(own, project.section("landmarks")), geodetic(position_m)
        place = position_m[np.isfinite(position_m[:, 0])][:1]
        level = level_of_heights_m(datum, own.values.get("crs"), place, project.name)
        height = (where.height_m - level) * M_PER_FT + level
        return earth_centred_m(where.latitude_deg, where.longitude_deg, height)

    where = "track" if project.has("track") else "position"
    marks = lower("landmarks", flight.landmarks.position_m)
    lowered = replace(flight, landmarks=replace(flight.landmarks, position_m=marks))
    path = replace(flight.path, position_m=lower(where, flight.path.position_m))
    yield lowered, ("the landmarks'",)
    yield replace(flight, path=path), ("the camera's",)
    yield replace(lowered, path=path), ("all",)


def _from_the_pad(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Raise the camera by about the landmarks' height: its own counts from the ground there."""
    where, marks = geodetic(flight.path.position_m), geodetic(flight.landmarks.position_m)
    ground_m = float(np.median(marks.height_m[np.isfinite(marks.height_m)]))
    if abs(ground_m) < LEAST_LEVEL_M:
        return

    def raised(by_m: float) -> Flight:
        place = earth_centred_m(where.latitude_deg, where.longitude_deg, where.height_m + by_m)
        return replace(flight, path=replace(flight.path, position_m=place))

    by_m = ground_m
    for step_m in (NEAR_PAD_M / 2.0, NEAR_PAD_M / 10.0):  # to the least squares of three trials
        below, here, above = (trial_px(raised(by_m + k * step_m)) ** 2 for k in (-1.0, 0.0, 1.0))
        bent = below - 2.0 * here + above
        if not 0.0 < bent < np.inf:
            return
        by_m += float(np.clip(0.5 * (below - above) / bent, -2.0, 2.0)) * step_m
    if abs(by_m - ground_m) < NEAR_PAD_M:
        yield raised(by_m), (by_m, "position" if flight.path.of_position else "track", by_m)


def _at(position_m: Floats, change: Callable[[Floats], Floats]) -> Floats:
    """Change latitude and longitude of positions (N, 2), degrees; NaN if that is no latitude."""
    where = geodetic(position_m)
    degrees = change(np.stack([where.latitude_deg, where.longitude_deg], axis=1))
    degrees[np.abs(degrees[:, 0]) > 90.0] = np.nan
    return earth_centred_m(degrees[:, 0], degrees[:, 1], where.height_m)


def _other_places(flight: Flight, change: Callable[[Floats], Floats]) -> Iterator[Flight]:
    """Change latitudes and longitudes of landmarks, of the camera, and of both."""
    path = replace(flight.path, position_m=_at(flight.path.position_m, change))
    marks = replace(flight.landmarks, position_m=_at(flight.landmarks.position_m, change))
    yield replace(flight, landmarks=marks)
    yield replace(flight, path=path)
    yield replace(flight, landmarks=marks, path=path)


def _exchanged_degrees(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Exchange latitudes and longitudes of all: those of one are far from the others."""
    *_, every = _other_places(flight, lambda degrees: degrees[:, ::-1].copy())
    if flight.grid is None:
        yield every, ()


def _from_sixtieths(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Take the digits behind the point for minutes and seconds, or for minutes and their parts."""
    if flight.grid is not None:
        return
    for digits, change in (("minutes and seconds", _of_seconds), ("minutes", _of_minutes)):
        for one, whose in zip(_other_places(flight, change), WHOSE, strict=True):
            yield one, (whose, digits)


WHOSE = ("the landmarks'", "the camera's", "all")


def _of_seconds(degrees: Floats) -> Floats:
    """Read 47.3824 as 47 degrees 38 minutes 24 seconds; NaN where these are 60 or more."""
    whole, rest = np.divmod(np.round(np.abs(degrees), 10), 1.0)
    minutes, rest = np.divmod(100.0 * rest, 1.0)
    seconds = 100.0 * rest
    out = np.where((minutes < 60.0) & (seconds < 60.0), 1.0, np.nan) * np.sign(degrees)
    return np.asarray(out * (whole + minutes / 60.0 + seconds / 3600.0))


def _of_minutes(degrees: Floats) -> Floats:
    """Read 47.3840 as 47 degrees 38.40 minutes; NaN where these are 60 or more."""
    whole, rest = np.divmod(np.abs(degrees), 1.0)
    out = np.where(rest < 0.6, 1.0, np.nan) * np.sign(degrees)
    return np.asarray(out * (whole + rest / 0.6))


def _by_another_clock(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Exchange GPS time and UTC."""
    if not project.has("track"):
        return
    ahead_s = gps_ahead_s(flight.epoch)
    for shift, clock in ((-ahead_s, "GPS time"), (ahead_s, "UTC and not GPS time")):
        try:
            shifted = _with_offset(project, shift)
        except VopdError:
            continue
        if shifted.path.velocity_m_s is None:
            return
        yield shifted, (shift, clock)


def _with_offset(project: Project, more_s: float) -> Flight:
    """Read a project anew, its track later by so much."""
    given = project.section("track").number("offset_s")
    return some_frames(flight_of(project.changed("track", "offset_s", given + more_s)))


def _at_another_rate(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Take the frames' numbers for those of another usual frame rate."""
    stated = project.section("picks").values.get("frame_rate_hz")
    if not project.has("track") or not isinstance(stated, int | float):
        return
    for rate in FRAME_RATES_HZ:
        if not 1.0 / MOST_RATIO < rate / stated < MOST_RATIO or abs(rate / stated - 1.0) < SAME:
            continue
        try:
            changed = some_frames(flight_of(project.changed("picks", "frame_rate_hz", rate)))
        except VopdError:
            continue
        yield changed, (rate, stated)


def _at_another_size(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Take the lens for a calibration of the same pictures in another size."""
    camera = project.section("camera")
    own = camera.size("image_size_px")
    if camera.has("lens_size_px") or own is None:
        return
    for times in LENS_SIZES:
        size = [round(times * side) for side in own]
        try:
            scaled = some_frames(flight_of(project.changed("camera", "lens_size_px", size)))
        except VopdError:
            continue
        if trial_px(scaled) < MISFIT * float(np.median(flight.picks.sigma_px)):  # the very size
            yield scaled, tuple(size)


def _picked_in_smaller_pictures(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Take the picks for those in the same pictures made smaller, in which all of them are."""
    for times in [one for one in LENS_SIZES if one > 1.0]:
        smaller = replace(flight, lens=flight.lens.scaled(1.0 / times))
        size_px = smaller.lens.of(flight.picks.frame).by_rows("size_px")
        if (flight.picks.pixel + 0.5 > size_px).any():  # (0, 0) is the first pixel's centre
            continue
        if trial_px(smaller) < MISFIT * float(np.median(flight.picks.sigma_px)):  # the very size
            stated = [round(times * side) for side in flight.lens.size_px]
            yield smaller, (*smaller.lens.size_px, times, *stated)


def _of_the_other_model(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Take four coefficients of a lens for those of the other model that has as many."""
    kind = OTHER_MODEL.get(flight.lens.kind)
    if kind is None or isinstance(flight.lens, Lenses) or flight.lens.k[4:].any():
        return
    k = np.zeros(max(MODELS[kind].counts))
    k[:4] = flight.lens.k[:4]
    stated = float(k[0])  # a k1 that is mistaken by as much looks the same
    hint = of_stated_text(stated + of_other_model(flight.lens.kind), stated)
    also = f" Or is the true k1 {hint}" if hint else ""
    yield replace(flight, lens=replace(flight.lens, kind=kind, k=k)), (kind.value, also)


def _exchanged_labels(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Exchange the labels of each two of the worst landmarks in all frames."""
    squares = np.zeros(len(flight.landmarks.name) + 1)
    index = np.searchsorted(np.sort(flight.landmarks.number), estimate.landmark)
    place = np.append(np.argsort(flight.landmarks.number), len(squares) - 1)[index]
    x, y = np.split(estimate.residual, 2, axis=1)
    np.add.at(squares, place[estimate.used], (x**2 + y**2)[estimate.used])
    worst = np.argsort(-squares[:-1], kind="stable")[:MOST_EXCHANGED]
    worst = worst[squares[worst] > 0.0]
    pairs = list(combinations(sorted(worst.tolist()), 2))
    if len(worst) < 3 or len(pairs) * len(flight.picks.frame) > 2 * TRIAL_PICKS:
        return
    for one, other in pairs:
        label = flight.picks.landmark.copy()
        label[flight.picks.landmark == one], label[flight.picks.landmark == other] = other, one
        names = flight.landmarks.name[one], flight.landmarks.name[other]
        yield replace(flight, picks=replace(flight.picks, landmark=label)), names


def _labels_dealt_anew(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Give all labels to other landmarks, as the angles between the picks show."""
    from vopd.flight.misfits.exchanged import labels_of_all_frames  # of few flights

    name, rather = flight.landmarks.name, labels_of_all_frames(flight)
    moved = np.flatnonzero(rather != np.arange(len(rather))).tolist()
    if len(moved) > 2:
        told = [f"{name[k]} to {name[rather[k]]}" for k in moved]
        picks = replace(flight.picks, landmark=rather[flight.picks.landmark])
        yield replace(flight, picks=picks), (listed(told),)


def _names_a_row_off(project: Project | None, flight: Flight, estimate: Estimate) -> Corrected:
    """Give each landmark the coordinates of the row below or above: one is left without, or not."""
    marks = flight.landmarks
    last = len(marks.name) - 1
    for step, end, row in ((-1, last, "below"), (1, 0, "above")):
        position_m = np.roll(marks.position_m, step, axis=0)
        without = marks.takes_part & (np.arange(last + 1) != end)
        for used in (without, marks.takes_part):
            shifted = replace(marks, position_m=position_m, used=tuple(used.tolist()))
            yield replace(flight, landmarks=shifted), (row,)


def _without_a_landmark(project: Project, flight: Flight, estimate: Estimate) -> Corrected:
    """Leave out each landmark in all frames."""
    marks = flight.landmarks
    used = np.array(marks.used or (True,) * len(marks.name), dtype=bool)
    picked = np.bincount(flight.picks.landmark, minlength=len(used)) > 0
    several = np.flatnonzero(used & picked)
    if len(several) * len(flight.picks.frame) > TRIAL_PICKS:
        return
    for k in several:
        left = used & (np.arange(len(used)) != k)
        yield replace(flight, landmarks=replace(marks, used=tuple(left.tolist()))), (marks.name[k],)


IN_FILE = "is that so, though the format of their file counts it downward?"
RATE = "another frame rate"
RATE_ADVICE = "with [picks] frame_rate_hz = {} in the place of {:g}: is that of the video right?"

AXES_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "v counted the other way",
        _turned_over,
        "with v counted {}: {}",
    ),
    Mistake(
        "u and v exchanged",
        _exchanged_axes,
        "with u and v of all picks exchanged: are the two columns in this order?",
    ),
)
"""Mistakes by which the image is mirrored."""

MIRRORED = (
    " If the camera is then upside down, or turned by half a turn, it is the picture or the map "
    "that is mirrored: the wrong sign in all longitudes or latitudes, x and y exchanged in all "
    "files"
)
"""What looks like the mistakes by which the image is mirrored."""

LEVEL_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "heights from the pad",
        _from_the_pad,
        "with the camera {:+.0f} m, about the landmarks' height: do its heights count from the pad "
        "or the take-off? [{}] height = {{ ground_m = {:.0f} }} says so",
    ),
)
"""A level of heights that is far from that of the others."""

PLACE_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "latitudes and longitudes exchanged",
        _exchanged_degrees,
        "with latitudes and longitudes of all exchanged: are the columns in this order?",
    ),
    Mistake(
        "degrees with sixtieths",
        _from_sixtieths,
        "with the digits behind the point of {} latitudes and longitudes taken for {}: give "
        "decimal degrees",
    ),
)
"""Latitudes and longitudes that are read as others."""

LABEL_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "labels exchanged",
        _exchanged_labels,
        "with {} and {} exchanged in all frames: are their names right?",
    ),
    Mistake(
        "labels dealt anew",
        _labels_dealt_anew,
        "with {} renamed in all frames: are their names right?",
    ),
    Mistake(
        "names a row off",
        _names_a_row_off,
        "with each landmark at the coordinates of the row {} in its file: do names and coordinates "
        "stand in the same rows, and were the landmarks picked under their own names?",
    ),
)

UNIT_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "heights in feet",
        _from_feet,
        'with {} heights taken for feet: are they in feet? For a CSV columns = {{ h_ft = "..." }} '
        "says so, or the header h_ft",
    ),
    Mistake(
        "GPS time for UTC",
        _by_another_clock,
        "with the track {:+.0f} s: is its clock {}?",
    ),
    Mistake(
        "picks in smaller pictures",
        _picked_in_smaller_pictures,
        "with picks in pictures of {0} x {1} px: were they clicked in these? Multiply u and v by "
        "{2:.4g}; or is it the lens that was calibrated in pictures of {3} x {4} px?",
    ),
    Mistake(
        "a lens of another size",
        _at_another_size,
        "with a lens of pictures of {0} x {1} px: was it calibrated at that size? [camera] "
        "lens_size_px = [{0}, {1}]",
    ),
    Mistake(
        "a lens of the other model",
        _of_the_other_model,
        'with a lens of model = "{}" and the same coefficients: was it calibrated as one?{}',
    ),
    Mistake(
        RATE,
        _at_another_rate,
        RATE_ADVICE,
    ),
)
"""Units, clocks and sizes that a fitted number may stand for."""

LANDMARK_MISTAKES: tuple[Mistake[Flight], ...] = (
    Mistake(
        "a wrong landmark",
        _without_a_landmark,
        f"without {{}}: {OF_LANDMARK}",
    ),
)

USUAL_MISTAKES: tuple[Mistake[Flight], ...] = (
    *UNIT_MISTAKES,
    *LABEL_MISTAKES,
    *LANDMARK_MISTAKES,
)
"""The most telling mistake first."""


# Clocks by which a track covers frames


def other_clock(project: Project) -> str:
    """Hint at another clock by which a track covers frames, if it covers none; else nothing."""
    if not project.has("track"):
        return ""
    offset = project.section("track").values.get("offset_s", 0.0)
    ahead_s = gps_ahead_s(project.section("flight").date("epoch"))
    for shift in (-ahead_s, ahead_s):
        if isinstance(offset, int | float):
            try:
                flight_of(project.changed("track", "offset_s", offset + shift))
            except VopdError:
                continue
            return f"; with the track {shift:+.0f} s, as GPS time is ahead of UTC, it does"
    return ""
