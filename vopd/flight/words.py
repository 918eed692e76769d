"""What tables, files, pictures and the report say of flights, and of no other source."""

from __future__ import annotations

import numpy as np

from vopd.estimate import Words
from vopd.flight.flight import Flight, Refraction
from vopd.flight.gimbal_comparison import gimbal_sentence
from vopd.flight.solved_flight import IMAGE_FROM_CAMERA, SolvedFlight
from vopd.geometry.camera_axes import camera_angles_deg

ATTACK = (
    "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w the velocity "
    "{against} in the body"
)


def flight_words(solved: SolvedFlight) -> Words:
    """The words for one flight.

    Args:
        solved: its solution
    """
    flight = solved.flight
    conventions = {
        "input": "; ".join(flight.about),
        "solve": f"rotation by {flight.options.loss} with the camera's position given; WGS 84; "
        "residuals in pixels of the image as it was taken, x to the left, y up",
        "pixels": "u right, v down, (0, 0) the centre of the first pixel",
        "refraction": _refraction(flight.refraction, solved),
        "angles of attack": _attack(flight),
        "time": _time(flight),
    }
    if flight.path.gimbal_deg is not None:
        camera_deg = camera_angles_deg(IMAGE_FROM_CAMERA @ solved.attitudes.rotation)
        conventions["gimbal"] = gimbal_sentence(camera_deg, flight.path.gimbal_deg)
    if np.isfinite(flight.grid_convergence_deg):
        conventions["grid azimuth"] = (
            f"true azimuth less {flight.grid_convergence_deg:.4f} degree, the meridian "
            "convergence of the landmarks' CRS at the first frame"
        )
    return Words(
        source="project",
        landmark="its name",
        reading="a pick's u or v",
        repeated="by points picked several times"
        if np.isfinite(flight.picks.repeatability_px)
        else "as stated in the project",
        sigma_keys={
            "position": "[track] or [position] sigma_m",
            "landmark": "[landmarks] sigma_m",
            "focal": "[uncertainty] focal_rel",
            "principal_point": "[uncertainty] principal_px",
            "time": "[track] sigma_t_s",
        },
        flags={
            "undetermined": (
                "fewer than two landmarks in different directions, or no position: no angles; "
                "what is not known is named",
                "pick more landmarks; look at the track's times",
            ),
            "outlier": (
                "a landmark does not fit the others (F test, .001 a frame, four landmarks or "
                "more); it is named",
                "look at its pick in that image and at its coordinates",
            ),
            "second_solution": (
                "an attitude with the landmarks on the camera's other side fits as well; the solve "
                "has taken the one with the landmarks in front",
                "none is needed where the view is beyond doubt",
            ),
        },
        conventions=conventions,
    )


def _refraction(refraction: Refraction, solved: SolvedFlight) -> str:
    if refraction.k == 0.0:
        return "off"
    way = "decaying with height over 8 km" if refraction.decays else "constant"
    raised_deg = np.degrees(solved.raised_most_rad)
    most = ""
    if np.isfinite(raised_deg):
        most = f"; it raises lines of sight by {raised_deg:.5f} degree at most"
    return f"coefficient {refraction.k:g} at the ground, {way}{most}"


def _attack(flight: Flight) -> str:
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
