"""What every file says of itself: frames, sequence, ranges, deck, fixes, version."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.errata import Fix
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

    `histories` must not be empty.
    """
    fixes = histories[0].results.fixes
    decks = ", ".join(dict.fromkeys(h.deck for h in histories))
    local = "north, east, down at the vehicle; down toward the Earth's centre (as in 1974)"
    if Fix.EARTH in fixes:
        local = (
            f"north, east, down at the vehicle; down along the normal of {fixes.ellipsoid.label}"
        )
    return {
        "program": f"vopd {__version__}",
        "deck": decks,
        "fixes": str(fixes) if fixes else "none: the original's numbers",
        "from frame": local,
        "to frame": BODY,
        "sequence": SEQUENCE,
        "quaternion": QUATERNION,
        "camera angles": CAMERA,
        "ranges": RANGES,
        "angles of attack": ATTACK,
        "sigmas": SIGMAS + "; shares: " + ", ".join(_shares(histories)),
        "time": "seconds of flight, group 6",
    }


def _shares(histories: Sequence[History]) -> list[str]:
    return list(dict.fromkeys(s for h in histories for s in h.uncertainty.shares))
