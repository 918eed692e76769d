"""The scene of a solved flight, and the photographs of its frames."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.files import optional_package
from vopd.findings import VopdError
from vopd.flight.formats.photographs import photograph
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.readout import row_shifts_px
from vopd.flight.solve.rotations import SolvedFlight
from vopd.geometry.lenses import Lens, Lenses, project, ray_of_pixel
from vopd.scene import ImageScene, JobScene, Views

if TYPE_CHECKING:
    from PIL.Image import Image


class FlightScene:
    """The scene of a flight; each frame's part is made when it is asked for.

    Args:
        solved: the flight, its rotations and positions
    """

    def __init__(self, solved: SolvedFlight) -> None:
        self._solved, self._flight = solved, solved.flight

    def scene(self) -> JobScene:
        """Make the record that figures are drawn from."""
        flight, places = self._flight, self._landmark_m
        grid = flight.grid
        named = bool(flight.video) or bool(flight.image_name and flight.folder)
        return JobScene(
            flight.landmarks.name,
            places,
            ~flight.landmarks.takes_part,
            self._solved.camera_m,
            self.index,
            self.sight,
            self.image,
            self.views,
            self.photograph if named else None,
            self.photographs if named else None,
            grid.crs if grid else "",
            self.clicks if flight.picks.clicks is not None else None,
            self._on_grid if grid else None,
        )

    @property
    def _landmark_m(self) -> Floats:
        own = self._solved.landmark_m
        return self._flight.landmarks.position_m if own is None else own

    def index(self, number: int, name: str) -> int:
        """Find a frame by its number, or by its image."""
        flight = self._flight
        if flight.image_name:
            return flight.image_name.index(name)
        return int(np.flatnonzero(flight.frame == number)[0])

    def clicks(self) -> tuple[Ints, Ints, Floats, Bools]:
        """List a person's clicks: frames, landmarks, pixels, and which are not used."""
        picks, clicks = self._flight.picks, self._flight.picks.clicks
        assert clicks is not None
        of_frame = picks.frame[clicks.pick] == clicks.frame[clicks.click]
        rows = np.flatnonzero(of_frame)
        own = clicks.click[rows]
        at = np.concatenate([clicks.frame[own], clicks.wrong[:, 0].astype(int)])
        mark = np.concatenate([clicks.landmark[own], clicks.wrong[:, 1].astype(int)])
        pixel = picks.pixel[clicks.pick[rows]] + clicks.off_px[rows]
        wrong = np.arange(len(at)) >= len(own)
        return at, mark, np.concatenate([pixel, clicks.wrong[:, 2:]]), wrong

    def sight(self, number: int, name: str) -> tuple[Ints, Floats]:
        """Trace the picks of a frame: landmarks, and Earth-centred unit vectors."""
        views = self.views(np.array([self.index(number, name)]))
        return views.landmark, views.ray

    def image(self, number: int, name: str) -> ImageScene:
        """Project the landmarks on the image of a frame."""
        k = self.index(number, name)
        lens, rotation = self._lens(k), self._solved.attitudes.rotation[k]
        views = self.views(np.array([k]))
        return ImageScene(
            lens.size_px,
            views.landmark,
            views.pixel,
            views.fitted,
            views.used,
            views.computed[0],
            lambda direction: project(lens, direction @ rotation.T).pixel,
            lambda pixel: ray_of_pixel(lens, pixel) @ rotation,
        )

    def views(self, frames: Ints) -> Views:
        """Project the landmarks on the images of some frames, at once.

        Args:
            frames: their indices, in order
        """
        flight, solved = self._flight, self._solved
        rotation, camera_m = solved.attitudes.rotation[frames], solved.camera_m[frames]
        picks = np.flatnonzero(np.isin(flight.picks.frame, frames))
        at, own = np.searchsorted(frames, flight.picks.frame[picks]), flight.picks.landmark[picks]
        frame, mark = np.divmod(
            np.arange(len(frames) * len(self._landmark_m)), len(self._landmark_m)
        )
        lines = sight_lines(camera_m, self._landmark_m, frame, mark, flight.refraction)
        ray = np.einsum("pij,pj->pi", rotation[frame], lines.direction)
        computed = project(flight.lens.of(frames[frame]), ray).pixel.reshape(len(frames), -1, 2)
        shift = self._row_shift_px[picks] if flight.shutter is not None else 0.0
        pixel = flight.picks.pixel[picks]
        seen = ray_of_pixel(flight.lens.of(frames[at]), pixel)
        lenses = [self._lens(k) for k in frames.tolist()]
        border = {id(one): _border(one) for one in {id(one): one for one in lenses}.values()}
        around = np.array([border[id(one)] for one in lenses])
        middle_px = (np.array([one.size_px for one in lenses]) - 1.0) / 2.0
        middle = ray_of_pixel(flight.lens.of(frames), middle_px)

        def pixel_of(direction: Floats) -> Floats:
            count, own = direction.shape[:2]
            seen = np.einsum("nij,nhj->nhi", rotation, direction).reshape(-1, 3)
            lens = flight.lens.of(np.repeat(frames, own))
            return np.asarray(project(lens, seen).pixel.reshape(count, own, 2))

        return Views(
            np.array([one.size_px for one in lenses]),
            at,
            own,
            pixel + shift,
            computed[at, own] + shift,
            solved.used[picks] & (solved.attitudes.weight[picks] > 0.0),
            np.einsum("pj,pji,pik->pk", seen, rotation[at], lines.axes[at], optimize=True),
            computed,
            np.einsum("nbj,nji->nbi", around, rotation),
            np.einsum("nj,nji->ni", middle, rotation),
            pixel_of,
        )

    def _lens(self, k: int) -> Lens:
        """Look up the lens of a frame."""
        lens = self._flight.lens
        return lens.each[lens.which[k]] if isinstance(lens, Lenses) else lens

    @cached_property
    def _row_shift_px(self) -> Floats:
        """How far each pick of a rolling shutter was moved to its frame's time, (P, 2)."""
        flight = self._flight
        if flight.path.turning_rad_s is None or flight.picks.part is None:
            return np.zeros_like(flight.picks.pixel)
        solved = self._solved
        return row_shifts_px(flight, solved.attitudes.rotation, solved.lines.distance_m)

    def _on_grid(self, position_m: Floats) -> tuple[Floats, Floats]:
        from vopd.flight.coordinates import east_north_m

        assert self._flight.grid is not None
        return east_north_m(self._flight.grid.crs, position_m)

    def photograph(self, number: int, name: str) -> Image:
        """Read the photograph of a frame, upright.

        Raises:
            VopdError: if there is none, or it cannot be read
        """
        return photograph(self._flight, number, name)

    def photographs(self, frames: list[tuple[int, str]]) -> Iterator[tuple[int, Image | VopdError]]:
        """Read the photographs of many frames; those of a video in one pass through it.

        Args:
            frames: number and name of the image of each

        Yields:
            The place of a frame in the list, and its photograph, or the error that it has.
        """
        from vopd.video import open_frames

        place = {number: k for k, (number, name) in enumerate(frames) if not name}
        if place:
            try:
                video = open_frames([str(one) for one in self._flight.video])
                pillow = optional_package("PIL.Image", "images", "showing frames")
                ends = min(place), max(place)
                for number, picture in video.decoded(*ends, lost=lambda _: None):
                    if number in place:
                        yield place.pop(number), pillow.fromarray(picture)
            except VopdError as error:
                yield from ((k, error) for k in place.values())
                place = {}
        for k, (number, name) in enumerate(frames):
            if (
                name or number in place
            ):  # by name, of a folder of numbered images, or beyond the end
                try:
                    yield k, self.photograph(number, name)
                except VopdError as error:
                    yield k, error


BORDER = 4  # points along each side of an image, from corner to corner


def _border(lens: Lens) -> Floats:
    """Trace points around the image, from its upper left corner to the right, in camera axes."""
    share = np.arange(BORDER) / BORDER
    side = np.stack([share, np.zeros(BORDER)], axis=1)
    sides = [side, [1.0, 0.0] + side[:, ::-1], 1.0 - side, [0.0, 1.0] - side[:, ::-1]]
    return ray_of_pixel(lens, np.concatenate(sides) * (np.array(lens.size_px) - 1.0))
