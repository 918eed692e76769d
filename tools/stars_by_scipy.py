"""Attitudes of photographs of stars by scipy, one by one: what `vopd stars solve` is measured by.

    python tools/stars_by_scipy.py STARS.csv FOCAL_MM TABLE.csv

The rotation and its sensitivity matrix, nothing tested; the attitude is that of `--method svd`.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation


def main(stars: Path, focal_mm: float, table: Path) -> None:
    """Solve all photographs of a star file."""
    photographs: dict[str, list[list[float]]] = {}
    with stars.open() as file:
        for image, *values in list(csv.reader(file))[1:]:
            photographs.setdefault(image, []).append([*map(float, values)])
    with table.open("w") as file:
        writer = csv.writer(file)
        for image, rows in photographs.items():
            x, y, ra, dec = np.array(rows).T
            ra, dec = np.radians(ra), np.radians(dec)
            sky = np.stack([np.cos(ra) * np.cos(dec), np.sin(ra) * np.cos(dec), np.sin(dec)], 1)
            seen = np.stack([x, y, np.full_like(x, -focal_mm)], axis=1)
            seen /= np.linalg.norm(seen, axis=1)[:, None]
            turn, rssd, spread = Rotation.align_vectors(seen, sky, return_sensitivity=True)
            angles = turn.as_euler("xyz", degrees=True)
            writer.writerow([image, *angles, rssd, *np.sqrt(np.diagonal(spread))])


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3]))
