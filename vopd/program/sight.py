"""Prepare the input of the solve from film, lens and landmarks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import Fix, Fixes
from vopd.landmark_layout import LandmarkLayout
from vopd.program.average import FilmCoordinates
from vopd.program.lens_correction import LensCorrection, corrected
from vopd.program.orient import Sight
from vopd.program.tgtcam import Dircos
from vopd.results import Results


class FilmSight(NamedTuple):
    """The input of the solve for the frames of a film, without gaps: what `Sight` has for some.

    Attributes:
        layout: which landmarks each frame has
        direction: cosines of the landmarks (N, 3) along east, north, up
        point: x and y (N, 2), mm from the frame's centre, corrected for lens distortion
        xmu1: XMU of the first landmark of each landmark's frame (N,)
        used: which landmarks take part (N,)
        cc: the focal length for every frame (F,), mm
    """

    layout: LandmarkLayout
    direction: Floats
    point: Floats
    xmu1: Floats
    used: Bools
    cc: Floats

    def of(self, frames: Ints) -> Sight:
        """The input for some frames, by landmark and frame.

        Args:
            frames: their indices; they should have like numbers of landmarks
        """
        layout, rows = self.layout.only(frames), self.layout.rows(frames)

        def arranged(values: Floats) -> Floats:
            return np.ascontiguousarray(layout.padded(values[rows], np.nan).T)

        return Sight(
            dircos=Dircos(*(arranged(self.direction[:, k]) for k in range(3))),
            x=arranged(self.point[:, 0]),
            y=arranged(self.point[:, 1]),
            xmu1=arranged(self.xmu1),
            used=np.ascontiguousarray(layout.padded(self.used[rows]).T),
            cc=self.cc[frames],
        )

    @staticmethod
    def joined(films: Sequence[FilmSight]) -> FilmSight:
        """Join the inputs of several films, one film after the other.

        Args:
            films: one or more
        """
        if len(films) == 1:
            return films[0]
        layout = LandmarkLayout(np.concatenate([film.layout.count for film in films]))
        parts = zip(*(film[1:] for film in films), strict=True)
        return FilmSight(layout, *(np.concatenate(part) for part in parts))


def sight(
    film: FilmCoordinates,
    lens: LensCorrection,
    direction: Floats,
    used: Bools,
    focal_length_mm: Floats,
    fixes: Fixes,
    layout: LandmarkLayout,
) -> FilmSight:
    """Prepare the input of the solve.

    Args:
        film: centres and landmarks on the film.
        lens: distance and distortion of the landmarks.
        direction: cosines of the landmarks (N, 3) along east, north, up.
        used: which landmarks take part (N,).
        focal_length_mm: the focal length for every frame (F,).
        fixes: which errata are corrected.
        layout: which landmarks each frame has.
    """
    xmu = direction[:, 1]
    if Fix.FIRST_LANDMARK not in fixes and layout.total:
        first = np.minimum(layout.start, layout.total - 1)  # where none takes part
        taking_part = np.flatnonzero(used)[::-1]
        first[layout.frame[taking_part]] = taking_part  # the first one is put last
        xmu = xmu[first][layout.frame]
    return FilmSight(
        layout=layout,
        direction=direction,
        point=corrected(film, lens, layout),
        xmu1=xmu,
        used=used,
        cc=focal_length_mm,
    )


@np.errstate(all="ignore")
def sight_of(results: Results, focal_length_mm: Floats | None = None) -> Sight:
    """The input of the solve that gave some results, by landmark and frame.

    Args:
        results: one job, or frames of one that have like numbers of landmarks
        focal_length_mm: of every frame (F,), where they are of several jobs
    """
    r, p = results, results.points
    film = sight(
        FilmCoordinates(r.centre_in, p.point_in, r.centre_mm, p.point_mm),
        LensCorrection(p.radius_mm, p.distortion_mm, p.at_centre),
        p.direction,
        p.used,
        r.focal_length_mm if focal_length_mm is None else focal_length_mm,
        r.fixes,
        r.layout,
    )
    return film.of(np.arange(len(r.frame)))
