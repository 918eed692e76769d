"""Omega, phi, kappa of the camera against the map grid, CSV, with grid and true azimuth.

Without a projected coordinate system the angles are against true east, north, up.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.export.file_request import FileRequest, printable
from vopd.export.photogrammetry import (
    CameraPoses,
    camera_poses,
    grid_from_local,
    omega_phi_kappa_deg,
    some,
    source_text,
)
from vopd.export.tables import not_a_formula
from vopd.findings import Report, VopdError

COLUMNS = (
    "image", "x", "y", "h_m", "omega_deg", "phi_deg", "kappa_deg", "azimuth_true_deg",
    "azimuth_grid_deg", "convergence_deg", "longitude_deg", "latitude_deg",
)  # fmt: skip
HEAD = """\
# {source}
# omega, phi, kappa: image axes (right, up in the picture, backward) in {axes} are
# Rx(omega) Ry(phi) Rz(kappa), right-handed turns of a vector, degrees. Looking straight down
# they are 0 0 0 with the top of the picture to the north.
# Down is {down}.
# x, y: {where}; h_m: metres above the ellipsoid of WGS 84
# azimuth of the optical axis, clockwise; grid azimuth is the true one less the convergence
"""


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, a row for each frame that has an attitude.

    Args:
        histories: the jobs
        request: is not used
        report: is given warnings about frames that are left out

    Raises:
        VopdError: where the jobs have different grids
    """
    found = some([camera_poses(h, report) for h in histories])
    systems = {_system(one) for one in found}
    if len(systems) > 1:
        raise VopdError("the sources have different coordinate systems: write a file for each")
    crs = systems.pop()
    page = io.StringIO()
    page.write(
        HEAD.format(
            down=histories[0].about.down,
            source=source_text(histories),
            axes=f"grid east, grid north, up of {crs}" if crs else "true east, north, up",
            where=f"easting and northing, {crs}" if crs else "longitude and latitude, degrees",
        )
    )
    rows = csv.writer(page, lineterminator="\n")
    rows.writerow(COLUMNS)
    for poses in found:
        rows.writerows(_rows(poses))
    return page.getvalue().encode()


def _system(poses: CameraPoses) -> str:
    grid = poses.history.estimate.grid
    return grid.crs if grid is not None else ""


def _rows(poses: CameraPoses) -> list[list[str]]:
    estimate, k = poses.history.estimate, poses.frames
    longitude, latitude, height = poses.geodetic.T
    x, y, convergence = longitude, latitude, np.zeros(len(k))
    form = "%.9f"
    if estimate.grid is not None:
        x, y = estimate.grid.easting[k], estimate.grid.northing[k]
        convergence = estimate.grid.convergence_deg[k]
        form = "%.4f"
    angles = omega_phi_kappa_deg(grid_from_local(convergence) @ poses.local_from_camera)
    azimuth = estimate.camera_deg[k, 0]
    columns: list[tuple[str, Floats]] = [
        (form, x), (form, y), ("%.4f", height),
        *(("%.6f", np.round(one, 6) + 0.0) for one in angles.T),
        ("%.6f", azimuth), ("%.6f", (azimuth - convergence) % 360.0), ("%.6f", convergence),
        ("%.9f", longitude), ("%.9f", latitude),
    ]  # fmt: skip
    texts = [[text % value for value in values.tolist()] for text, values in columns]
    names = [not_a_formula(printable(name)) for name in poses.name]
    return [[name, *row] for name, *row in zip(names, *texts, strict=True)]
