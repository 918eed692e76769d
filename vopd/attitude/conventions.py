"""The conventions that every output file states: axes, rotations, ranges, source and version."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.attitude.history import History
from vopd.version import __version__

GENERAL = {
    "to frame": "vehicle body: x forward, y right, z down",
    "sequence": (
        "intrinsic z-y-x: yaw about down, then pitch about the new right, then roll about the "
        "new forward; right-handed"
    ),
    "quaternion": (
        "local north-east-down to vehicle body, Hamilton, scalar first (w x y z), w >= 0; "
        "components in north-east-down are q v q* of those in the body"
    ),
    "camera angles": (
        "camera yaw of the optical axis clockwise from north, pitch above the horizontal, roll "
        "clockwise about the optical axis seen from behind"
    ),
    "ranges": "yaw and roll 0 to 360, pitch -180 to 180, alpha and beta -180 to 180, eta 0 to 180",
    "angles of attack": (
        "alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), u v w in the body"
    ),
    "position": "longitude east, geodetic latitude, WGS 84; altitude above the ellipsoid",
    "time": "seconds, of the source's own clock",
}
"""What is so for every source unless its `Words` say otherwise, a short name and a sentence."""

SIGMAS = "one standard deviation, degrees; missing where the attitude is not determined"


def conventions(histories: Sequence[History]) -> dict[str, str]:
    """The conventions of a file about these jobs: short names, and a sentence for each.

    Args:
        histories: one or more jobs, of one kind of source
    """
    about = histories[0].about
    sources = ", ".join(dict.fromkeys(h.about.source for h in histories))
    components = dict.fromkeys(c for h in histories for c in h.uncertainty.components)
    stated = {
        "program": f"vopd {__version__}",
        about.words.source: sources,
        "fixes": about.fixes or about.words.no_fixes,
        "from frame": f"north, east, down at the vehicle; down {about.down}",
        **(GENERAL | dict(about.words.conventions)),
        "sigmas": f"{SIGMAS}; components: {', '.join(components)}",
    }
    return {name: sentence for name, sentence in stated.items() if sentence}
