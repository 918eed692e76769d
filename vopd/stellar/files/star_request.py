"""The options of `vopd stars solve`, as one record."""

from __future__ import annotations

from dataclasses import dataclass, field

from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.reading_errors import ErrorModel
from vopd.stellar.methods.run import StarOptions
from vopd.stellar.sky.sky_request import SkyRequest


@dataclass(frozen=True)
class StarRequest:
    """The options of `vopd stars solve`.

    Attributes:
        axes: how image coordinates are read, and the principal distance
        method: one of METHODS, or "all"
        pair: solve these two stars only, counted from 1
        all_pairs: solve every pair
        reject: leave out stars that do not fit the others
        edit_by_pairs: find those stars by the attitudes of all pairs
        errors: how the reading error of a star depends on the star
        listing: write the printout of program STARS instead of the solutions
        camera_m: the camera's position, metres, for ground points
        resection: solve the camera's position too
        sky: date and place of the photograph, and files about stars
        free: what of the camera is solved with the attitude: focal, centre, k1
        options: how to solve
    """

    axes: ImageAxes
    method: str = "collinearity"
    pair: tuple[int, int] | None = None
    all_pairs: bool = False
    reject: bool = False
    edit_by_pairs: bool = False
    errors: ErrorModel = field(default_factory=ErrorModel)
    listing: bool = False
    camera_m: tuple[float, ...] | None = None
    resection: bool = False
    sky: SkyRequest = field(default_factory=SkyRequest)
    free: tuple[str, ...] = ()
    options: StarOptions = field(default_factory=StarOptions)

    @property
    def rejects(self) -> bool:
        """Whether stars that do not fit the others are left out."""
        return self.reject or self.edit_by_pairs
