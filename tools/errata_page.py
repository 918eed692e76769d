"""Write or check docs/errata.md, which is made from the errata's data and four runs of the cases.

python tools/errata_page.py --write
python tools/errata_page.py --check
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from made_page import write_or_check

import vopd
from vopd.errata import VOPD_ERRATA, Erratum, fixes
from vopd.geometry.ellipsoids import ELLIPSOIDS
from vopd.stellar.errata import RAE_ERRATA

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "errata.md"

HEAD = """# Errata

An erratum is something that an original program or report has wrong; its fix is what it should
have. `vopd errata` lists them. A run keeps all errata of program VOPD, so that it prints what the
original printed; `vopd run --fix NAME` corrects one of them, and `--fix all` corrects all. This
page is made from the data of the package by `tools/errata_page.py`.

```console
$ vopd errata restart
restart
  where     A 452 to A 454, the start of the next frame
  original  angles in degrees are compared with TWOPI and PI, which are radians
  fix       comparison with 360 and 180 degrees: every frame starts from the
            angles of the one before
  evidence  the listing differs from the report's text; no printed frame depends
            on it
  effect    none where all frames converge; frames far from group 8's first
            estimate may not
```

A run with fixes says so under the title of every page, and on standard error:

```console
$ vopd run -q decks/appendix_h/case1.dat --fix earth --fix first-landmark
corrected run, not the original: first-landmark, earth (WGS 84)
1   VIKING BLDT AV-4 FORWARD MILLIKEN CAMERA
 CORRECTED RUN, NOT THE ORIGINAL: first-landmark, earth (WGS 84)
...
```

With the fix `earth`:

- The Earth is an ellipsoid: {ellipsoids} (`--ellipsoid`).
- Altitudes of landmarks are heights above it; the height of the origin is RZ less 20925.698
  thousand feet.
- X, Y, Z are east, north and up at the geodetic latitude of the origin. The camera's angles refer
  to east, north and up at the geodetic latitude of the camera.
- LAT-GOCN and RAD ER KM print the true geocentric latitude and radius.
- A foot is 1/3280.8336 km everywhere.

The fixes `latitude-series`, `sin-6phi` and `feet-per-km` then change nothing more.

## Effect on the report's four cases

How much each fix changes the camera's yaw, pitch and roll, and the printed standard deviation, in
the frames of Appendix H. What all of them together change in the frames of any deck is in the
columns `slip_effect` of [`vopd attitude`](uncertainty.md#the-models-own-error).

"""


def effects() -> str:
    """The table of what each fix changes, by case and frame."""
    rows = [
        "| fix | case, frame | yaw, deg | pitch, deg | roll, deg | standard deviation, mm |",
        "|---|---|---|---|---|---|",
    ]
    cases = {n: vopd.read_deck(ROOT / f"decks/appendix_h/case{n}.dat")[0] for n in range(1, 5)}
    plain = {n: vopd.run(job) for n, job in cases.items()}
    for name in [*(erratum.name for erratum in VOPD_ERRATA), "all"]:
        for n, job in cases.items():
            fixed = vopd.run(job, fixes(name))
            moved = (fixed.camera_deg - plain[n].camera_deg + 180.0) % 360.0 - 180.0
            spread = fixed.residual_deviation_mm - plain[n].residual_deviation_mm
            for k in np.flatnonzero(fixed.solved):
                cells = " | ".join(map(figure, [*moved[k], spread[k]]))
                rows.append(f"| {name} | {n}, {fixed.frame[k]} | {cells} |")
    return "\n".join(rows) + "\n"


def figure(moved: float) -> str:
    """Two digits; what is rounding noise is printed as 0."""
    return f"{moved:+.2g}" if abs(moved) >= 1e-7 else "0"


def entries(errata: tuple[Erratum, ...]) -> str:
    """Each erratum as a section."""
    return "\n".join(
        f"### {e.name}\n\n- **Where:** {e.where}\n- **Original:** {e.original}\n"
        f"- **Fix:** {e.fix}\n- **Evidence:** {e.evidence}\n- **Effect:** {e.effect}\n"
        for e in errata
    )


def page() -> str:
    """The whole page."""
    ellipsoids = ", ".join(label for label, _, _ in ELLIPSOIDS.values())
    return (
        HEAD.replace("{ellipsoids}", ellipsoids)
        + effects()
        + "\n## Program VOPD (NASA TM X-3050)\n\n"
        + entries(VOPD_ERRATA)
        + "\n## Rae (1987)\n\nWhat `vopd stars` does by default is said in each fix.\n\n"
        + entries(RAE_ERRATA)
    )


if __name__ == "__main__":
    sys.exit(write_or_check(PAGE, lambda _: page(), __doc__))
