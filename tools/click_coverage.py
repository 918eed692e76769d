"""How true the stated sigmas of flights are that are tracked from clicks.

    python -m tools.click_coverage [--flights N]

Errors are drawn as `tests.kit.clicked_flights` says; flights are made and compared without the
package. Printed are the root mean square of all turns over what is
stated, the share of flights whose mean turn is inside its 95 % region, and the sigma of a match.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import fdtri

from tests.kit.clicked_flights import clicked_flight
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.joint import covariance_of_sums

ROWS: dict[str, dict[str, Any]] = {
    "a click of each landmark in every 30th frame": {},
    "all in the first frames": {"every": 60, "reach": 60},
    "six frames apart, 60 clicks": {"every": 6, "reach": 45},
    "matches stated 2.5 times too large": {"stated_px": 0.2},
    "landmarks .02 m": {"landmark_m": 0.02},
}


def main() -> None:
    """Count all rows."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--flights", type=int, default=200, metavar="N")
    count = parser.parse_args().flights
    print("| errors | rms / stated | mean inside 95 % | sigma of a match, px | said of flights |")
    print("|---|---|---|---|---|")
    for name, drawn in ROWS.items():
        squares, stated, inside, sigmas, said = [], [], [], [], 0
        for seed in range(count):
            one = clicked_flight(np.random.default_rng(1000 + seed), **drawn)
            result = solve_flight_read(one.flight)
            joint, reading = result.estimates.joint, result.estimates.reading
            assert joint is not None and reading is not None
            solved = result.estimates.solved.attitudes.rotation
            turn = Rotation.from_matrix(solved @ one.scene.rotation.swapaxes(1, 2)).as_rotvec()
            squares.append((turn**2).sum(axis=1).mean())
            stated.append(np.einsum("fii->f", joint.covariance.turn).mean())
            frames = len(turn)
            weight = np.tile(np.eye(3) / frames, (frames, 1, 1))
            covariance, _ = covariance_of_sums(joint, weight)
            mean = turn.mean(axis=0)
            limit = 3.0 * fdtri(3.0, reading.freedom, 0.95)
            inside.append(mean @ np.linalg.solve(covariance, mean) < limit)
            sigmas.append(reading.sigma)
            said += bool(result.findings)
        ratio = float(np.sqrt(np.mean(squares) / np.mean(stated)))
        print(
            f"| {name} | {ratio:.2f} | {100.0 * np.mean(inside):.1f} | "
            f"{np.mean(sigmas):.4f} ± {np.std(sigmas):.4f} | {said} of {count} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
