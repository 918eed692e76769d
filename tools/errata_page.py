"""Write or check docs/errata.md, which is made from the errata's data and four runs of the cases.

python tools/errata_page.py --write
python tools/errata_page.py --check
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

import vopd
from vopd.errata import VOPD_ERRATA, Erratum, fixes
from vopd.geometry.ellipsoid import ELLIPSOIDS
from vopd.stellar.rae1987.errata import RAE_ERRATA

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "errata.md"

HEAD = """# Errata

The known slips of the original programs, as data of the package: `vopd errata` prints them, and
`vopd run --fix NAME` runs without one of program VOPD's (`--fix all` without any). What a run
prints without `--fix` is the original's. This page is made from the same data by
`tools/errata_page.py`.

```console
$ vopd errata restart
restart
  where     A 452 to A 454, the start of the next frame
  slip      angles in degrees compared with TWOPI and PI, which are radians
  remedy    compare with 360 and 180 degrees: every frame starts from the one
            before
  evidence  the listing against its text; no printed frame depends on it
  effect    none where all converge; a frame far from group 8's estimate may not
```

A corrected run says so under the title of every page, and on standard error:

```console
$ vopd run decks/appendix_h/case1.dat --fix earth --fix first-landmark
corrected run, not the original: first-landmark, earth (WGS 84)
1   VIKING BLDT AV-4 FORWARD MILLIKEN CAMERA
 CORRECTED RUN, NOT THE ORIGINAL: first-landmark, earth (WGS 84)
...
```

Under `earth` the Earth is an ellipsoid, {ellipsoids} (`--ellipsoid`);
landmark altitudes are heights above it; the origin's height is RZ less 20925.698 thousand feet;
X, Y, Z are east, north and up at the origin's geodetic latitude, and the camera's angles refer to
east, north and up at the camera's own; LAT-GOCN and RAD ER KM then print the true geocentric
latitude and radius, and a foot is 1/3280.8336 km everywhere. The fixes `latitude-series`,
`sin-6phi` and `feet-per-km` have nothing left to do then.

## Effect on the report's four cases

How far each fix moves the camera's yaw, pitch and roll, and the listing's standard deviation, in
the frames of Appendix H.

"""


def effects() -> str:
    """A table of what each fix moves, by case and frame."""
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
    """Two digits; what is rounding noise is nothing."""
    return f"{moved:+.2g}" if abs(moved) >= 1e-7 else "0"


def entries(errata: tuple[Erratum, ...]) -> str:
    """Each erratum as a section."""
    return "\n".join(
        f"### {e.name}\n\n- **Where:** {e.where}\n- **Slip:** {e.slip}\n- **Remedy:** {e.remedy}\n"
        f"- **Evidence:** {e.evidence}\n- **Effect:** {e.effect}\n"
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
        + "\n## Rae (1987)\n\nThe default of `vopd stars` is named in each remedy.\n\n"
        + entries(RAE_ERRATA)
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    if parser.parse_args().write:
        PAGE.write_text(page(), encoding="utf-8")
        return 0
    if PAGE.read_text(encoding="utf-8") == page():
        return 0
    print("docs/errata.md is not current: run tools/errata_page.py --write", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
