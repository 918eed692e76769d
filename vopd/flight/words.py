"""Words of a flight: what its tables, files, pictures and report say of how it was solved."""

from __future__ import annotations

from math import atan2, degrees, hypot

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.conventions import POSITION
from vopd.attitude.included import WEAVING
from vopd.estimate import Words
from vopd.findings import count_text, first_of, size_text
from vopd.flight.angles import camera_angles
from vopd.flight.flight import CameraPath, Flight, Refraction
from vopd.flight.solve.clicks import ClickEquations
from vopd.flight.solve.equations import coefficients_of
from vopd.flight.solve.errors import covariance_of_common
from vopd.flight.solve.free import COMMON, free_text
from vopd.flight.solve.joint import JointSolution
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.rotations import SolvedFlight, pick_errors_px
from vopd.geometry.linear import norm
from vopd.geometry.rotations import FORWARD, from_yaw_pitch_roll, rotation_vectors_deg

# Comparison with the gimbal's angles, which are never used in a solve


def gimbal_sentence(camera_deg: Floats, gimbal_deg: Floats, *, used: bool = False) -> str:
    """Describe the rotations from the gimbal's attitudes to the solved ones, in a sentence.

    They are rotations about the camera's own axes: near nadir yaw and roll differ by tens of
    degrees where the attitudes differ by one.

    Args:
        camera_deg: solved yaw, pitch, roll, (F, 3)
        gimbal_deg: those of the gimbal, (F, 3); NaN where not known
        used: whether they are the vehicle's attitudes, from which the mount is solved for
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
    use = "the mount comes from it" if used else "not used"
    return (
        f"{use}; rotation from the gimbal's attitude to the solved one about the camera's axes, "
        f"degrees, median of {count} and range: {parts}"
    )


# How the camera is mounted


def mount_sentence(mount: Floats) -> str:
    """Say where the camera looks in the vehicle, and where the top of its picture points.

    Args:
        mount: the rotation from camera axes (right, down, forward) to body axes, (3, 3)
    """
    view, top = (_along(axis) for axis in (mount[:, 2], -mount[:, 1]))
    return f"in the vehicle the camera looks {view}; the top of its picture points {top}"


WAYS = {0.0: "forward", 90.0: "right", -90.0: "left", 180.0: "back", -180.0: "back"}
NEARLY_DEG = 85.0  # elevation above which a direction is nearly up
UPRIGHT = 1e-3  # of a unit vector that is not up or down: less has no way


def _along(axis: Floats) -> str:
    """Describe a direction in body axes: where it points, and how far up or down from there."""
    forward, right, down = axis.tolist()
    level = hypot(forward, right)
    if level < UPRIGHT:
        return "down" if down > 0.0 else "up"
    azimuth = round(degrees(atan2(right, forward)), 1)
    elevation = round(degrees(atan2(-down, level)), 1)
    aside = f"{abs(azimuth):g} degrees {'right' if azimuth > 0.0 else 'left'} of forward"
    way = WAYS.get(azimuth, aside)
    if way is aside and abs(elevation) > NEARLY_DEG:  # its azimuth is that of hardly anything
        return f"{'up' if elevation > 0.0 else 'down'}, {90.0 - abs(elevation):.1g} degrees off"
    if not elevation:
        return way
    return f"{way} and {abs(elevation):g} degrees {'up' if elevation > 0.0 else 'down'}"


# Landmarks that check the solution


def check_sentence(solved: SolvedFlight) -> str:
    """Say how far landmarks that take no part are from where they were picked; empty without one.

    Args:
        solved: the solution, whose frames tell where each landmark would be
    """
    flight, picks = solved.flight, solved.flight.picks
    has = np.isfinite(solved.attitudes.rotation[:, 0, 0])
    rows = np.flatnonzero(~flight.landmarks.takes_part[picks.landmark] & has[picks.frame])
    if not len(rows):
        return ""
    landmark, off_px = picks.landmark[rows], pick_errors_px(solved)[rows]
    square = np.where(np.isfinite(off_px), off_px**2, np.inf).mean(axis=1)
    sizes = [
        (float(np.sqrt(square[landmark == one].mean())), int((landmark == one).sum()), one)
        for one in np.unique(landmark).tolist()
    ]
    told = [
        f"{flight.landmarks.name[one]} "
        + (f"{size_text(size)} px rms" if np.isfinite(size) else "behind the camera")
        + f" in {count_text(count, 'frame')}"
        for size, count, one in sorted(sizes, reverse=True)
    ]
    return f"picked minus computed, of landmarks that take no part: {first_of(told, MOST_CHECKS)}"


MOST_CHECKS = 5  # landmarks that take no part, of which the sizes are told


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
    "refraction": "[atmosphere] sigma_k",
    "time": "[track] sigma_t_s",
    "readout": "[uncertainty] readout_ms",
    "mount": "[vehicle] mount_sigma_deg",
    "velocity": "[track] velocity_sigma_m_s",
    "wind": "[wind] sigma_m_s",
    "click": "[picks] tracked_from: tracks of another program share those of their clicks",
}
"""Where the standard deviation of each component of a flight's uncertainty is stated.

That of the distortion depends on the lens.
"""


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
    vehicle = flight.vehicle
    if vehicle is not None and vehicle.turned_deg is not None:
        conventions["mount"] = (
            f"{mount_sentence(flight.mount)}; as {vehicle.name} has the vehicle's attitudes: what "
            "these are off together, as yaws from magnetic and not from true north, turns the "
            "vehicle, and no sigma has it"
        )
    elif not np.allclose(flight.mount, FORWARD):
        conventions["mount"] = mount_sentence(flight.mount)
    if check := check_sentence(solved):
        conventions["check landmarks"] = check
    if flight.path.gimbal_deg is not None:
        used = vehicle is not None and vehicle.of_gimbal
        gimbal = flight.path.gimbal_deg
        conventions["gimbal"] = gimbal_sentence(camera_angles(solved), gimbal, used=used)
    if joint is not None and joint.model.clicks is not None:
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
    coefficients = coefficients_of(flight.lens)
    own = [key for (_, key), names in COMMON.items() if names[0] in coefficients]
    keys = SIGMA_KEYS | {"distortion": f"[uncertainty] {', '.join(own)}"}
    keys = {name: key for name, key in keys.items() if name not in flight.options.exact}
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
                f"{size_text(raised_deg)} degree at most"
            )
    if hidden := _hidden_weave_text(flight.path):
        keys[WEAVING] = hidden
    return keys


LEAST_WEAVE_M = 1e-3  # of exact positions: their rounding hides less


def _hidden_weave_text(path: CameraPath) -> str:
    """Describe a weave that the noise of a track's positions hides; nothing where it is small."""
    if path.weave is None or path.velocity_m_s is None or path.velocity_sigma_m_s is None:
        return ""
    (amplitude_m, period_s), toward = path.weave, path.velocity_m_s.copy()
    if path.wind_m_s is not None:
        toward[:, :2] -= path.wind_m_s
    speed_m_s, sigma_m_s = norm(toward), path.velocity_sigma_m_s.max(axis=1)
    known, most_m_s = np.isfinite(speed_m_s * sigma_m_s), 2.0 * np.pi * amplitude_m / period_s
    if amplitude_m < LEAST_WEAVE_M or not known.any():
        return ""
    if most_m_s < np.sqrt(2.0) * np.median(sigma_m_s[known]):
        return ""
    moved_deg = degrees(atan2(most_m_s, np.median(speed_m_s[known])))
    return (
        f"[track] with vn_m_s, ve_m_s, vd_m_s: {size_text(amplitude_m)} m in {size_text(period_s)} "
        f"s, which the noise of its positions hides, is {size_text(moved_deg)} degree"
    )


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


# Clicks


def clicks_text(joint: JointSolution) -> str:
    """Describe the clicks of a flight, and how far they are off as the solve finds.

    Args:
        joint: the solution of a flight with clicks
    """
    model, clicks = joint.model, joint.model.flight.picks.clicks
    assert clicks is not None and isinstance(model.clicks, ClickEquations)
    error = joint.state.click_px[model.clicked]
    if not len(error):
        return "no click is of a frame that could be solved"
    left = np.diag(joint.factored.common)[model.of_clicks]
    count = count_text(len(error), "click")
    stated_px = float(np.sqrt((clicks.sigma_px[model.clicked] ** 2).mean()))
    return (
        f"{count}, off by {np.sqrt((error**2).mean()):.2f} px rms of u and v "
        f"({size_text(stated_px)} stated), known to {np.sqrt(left.mean()):.2f} px"
    )
