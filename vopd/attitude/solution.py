"""A job's solution taken apart: residuals, partials and gain of every frame.

Frame axis first. The 2L film coordinates of a frame stand in one axis: x of
every landmark, then y; what is not used is 0 throughout. Radians and millimetres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.program.constants import ftpkm, rad
from vopd.program.film import sight_of
from vopd.program.orient import Sight, equations
from vopd.program.positions import directions
from vopd.program.tgtcam import Dircos
from vopd.results import Results

SINGULAR = 1e-14  # of the singular values of P'B, squares of the partials' own


@dataclass(frozen=True)
class Solution:
    """The collinearity equations at the solution.

    `partials` B are the correct ones of the computed coordinates by the camera's
    yaw, pitch, roll. `gain` is what the solve makes of a change of the residuals,
    (P'B)^-1 P' with the partials P of the run: with the slip `first-landmark` it
    ends where P'(residuals) is zero, which is not quite the least squares, P = B.
    """

    results: Results
    sight: Sight
    radians: Floats  # (F, 3)
    residual: Floats  # (F, 2L) measured minus computed
    partials: Floats  # (F, 2L, 3)
    gain: Floats  # (F, 3, 2L); NaN where a frame has no solution
    used: Bools  # (F, L)

    def residual_at(
        self, direction: Floats | None = None, focal_mm: Floats | None = None
    ) -> Floats:
        """The residuals (F, 2L) with the same angles and other directions or focal length."""
        seen = self.sight
        if direction is not None:
            seen = seen._replace(
                dircos=Dircos(*(np.ascontiguousarray(direction[..., k].T) for k in range(3)))
            )
        if focal_mm is not None:
            seen = seen._replace(cc=focal_mm)
        return _flat(equations(self.radians.T, seen)[0])

    def moved_vehicle(self, shift_ft: Floats) -> Floats:
        """Directions (F, L, 3) with the vehicle moved east, north, up by (F, 3) or (3,)."""
        r = self.results
        marks = r.longitude_deg, r.geocentric_latitude_deg, r.radius_km
        return directions(r.job, r.fixes, r.vehicle_ft + shift_ft, *marks)

    def moved_landmarks(self, shift_ft: Floats) -> Floats:
        """Directions (F, L, 3) with every landmark moved east, north, up by (3,)."""
        r = self.results
        east, north, up = shift_ft / ftpkm
        latitude = np.radians(r.geocentric_latitude_deg)
        return directions(
            r.job,
            r.fixes,
            r.vehicle_ft,
            r.longitude_deg + np.degrees(east / (r.radius_km * np.cos(latitude))),
            r.geocentric_latitude_deg + np.degrees(north / r.radius_km),
            r.radius_km + up,
        )


@np.errstate(all="ignore")
def solution(results: Results) -> Solution:
    """The equations of every frame of a job at the angles it was solved to."""
    seen = sight_of(results)
    radians = results.camera_deg / rad
    _, slipped = equations(radians.T, seen)
    eps, b = equations(radians.T, seen._replace(xmu1=seen.dircos.xmu))
    partials, own = -_columns(b), -_columns(slipped)
    gain = _gain(own, partials, results)
    return Solution(results, seen, radians, _flat(eps), partials, gain, results.used)


def _gain(own: Floats, partials: Floats, results: Results) -> Floats:
    """(P'B)^-1 P' (F, 3, 2L): what the angles make of a change of the measured coordinates.

    NaN where P'B is singular but for rounding: an angle that nothing holds has
    no deviation, not that of a pseudo-inverse.
    """
    crossed = own.swapaxes(1, 2) @ partials
    known = results.solved & (results.used.sum(axis=1) >= 2) & np.isfinite(crossed).all((1, 2))
    regular = np.where(known[:, None, None], crossed, np.eye(3))
    sizes = np.linalg.svd(regular, compute_uv=False)
    known &= sizes[:, 2] > SINGULAR * sizes[:, 0]
    inverse = np.linalg.inv(np.where(known[:, None, None], crossed, np.eye(3)))
    gain = inverse @ own.swapaxes(1, 2)
    return np.asarray(np.where(known[:, None, None], gain, np.nan))


def _flat(eps: Floats) -> Floats:
    """(2, L, F) to (F, 2L)."""
    return np.moveaxis(eps, -1, 0).reshape(eps.shape[-1], -1)


def _columns(b: Floats) -> Floats:
    """(2, 3, L, F) to (F, 2L, 3)."""
    return np.moveaxis(b, (3, 0, 2, 1), (0, 1, 2, 3)).reshape(b.shape[3], -1, 3)
