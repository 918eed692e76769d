"""How near joint solutions come to the least cost, found by dense matrices of all unknowns.

    python -m tools.dense_agreement [--problems N]

Half of the problems are short flights with places, landmarks, lens and clock under their
standard deviations, two of three of these with a robust loss; half are solved as `vopd adjust`
does, with nothing stated of some parameters. The dense solution has a geometry of its own and
starts a third of a standard deviation away. Printed are the largest distances of any unknown, in
standard deviations.
"""

from __future__ import annotations

import argparse

import numpy as np

from tests.kit.dense_minimum import LOSSES, dense_minimum, drawn_problem, freed_problem
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.solve.joint import solve_jointly


def main() -> None:
    """Solve the problems both ways, and print the largest distance of each kind."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--problems", type=int, default=50, metavar="N")
    largest: dict[str, list[float]] = {loss: [] for loss in (*LOSSES, "vopd adjust")}
    for seed in range(parser.parse_args().problems):
        if seed % 2:
            flight, names = freed_problem(seed)
            joint, kind = adjust(flight, names).result.estimates.joint, "vopd adjust"
            assert joint is not None
        else:
            joint = solve_jointly(*drawn_problem(seed // 2))
            kind = joint.model.flight.options.loss
        away = dense_minimum(joint, np.random.default_rng(seed)).away
        largest[kind].append(float(np.abs(away).max()))
    for kind, found in largest.items():
        if found:
            print(f"{kind}: {len(found)} problems, at most {max(found):.1e} standard deviations")


if __name__ == "__main__":
    main()
