"""What every file says of itself: frames, sequence, ranges, deck, fixes, version."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.version import __version__

BODY = "vehicle body: x forward, y right, z down"
SEQUENCE = (
    "intrinsic z-y-x: yaw about down, then pitch about the new right, then roll about the "
    "new forward; right-handed"
)
QUATERNION = (
    "local north-east-down to vehicle body, Hamilton, scalar first (w x y z), w >= 0; "
    "components in north-east-down are q v q* of those in the body"
)
CAMERA = (
    "camera yaw of the optical axis clockwise from north, pitch above the horizontal, roll "
    "clockwise about the optical axis seen from behind (sigma 1, 2, 3 of NASA TM X-3050)"
)
RANGES = "yaw and roll 0 to 360, pitch -180 to 180, alpha and beta -180 to 180, eta 0 to 180"
ATTACK = "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w in the body"
SIGMAS = "one standard deviation, degrees; missing where the attitude is not determined"


def conventions(histories: Sequence[History]) -> dict[str, str]:
    """The statements of a file about these jobs, a short name and a sentence each.

    Args:
        histories: one or more jobs
    """
    about = histories[0].estimate.about
    sources = ", ".join(dict.fromkeys(h.estimate.about.source for h in histories))
    components = list(dict.fromkeys(c for h in histories for c in h.uncertainty.components))
    return {
        "program": f"vopd {__version__}",
        "deck": sources,
        "fixes": about.fixes or "none: the original's numbers",
        "from frame": f"north, east, down at the vehicle; down {about.down}",
        "to frame": BODY,
        "sequence": SEQUENCE,
        "quaternion": QUATERNION,
        "camera angles": CAMERA,
        "ranges": RANGES,
        "angles of attack": ATTACK,
        "sigmas": f"{SIGMAS}; components: {', '.join(components)}",
        "time": "seconds of flight, group 6",
    }
