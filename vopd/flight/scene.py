"""The scene of a solved flight, and the photographs of its frames."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.lines_of_sight import sight_lines
from vopd.flight.readout import row_shifts_px
from vopd.flight.solve import SolvedFlight
from vopd.geometry.earth import local_axes
from vopd.geometry.lenses import project, ray_of_pixel
from vopd.scene import ImageScene, JobScene

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
            self.photograph if named else None,
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

    def _picks(self, k: int) -> Ints:
        return np.flatnonzero(self._flight.picks.frame == k)

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
        k = self.index(number, name)
        picks = self._picks(k)
        ray = ray_of_pixel(self._flight.lens, self._flight.picks.pixel[picks])
        to_earth = self._solved.attitudes.rotation[k] @ self._axes(k)
        return self._flight.picks.landmark[picks], np.asarray(ray @ to_earth)

    def _axes(self, k: int) -> Floats:
        return np.asarray(local_axes(self._solved.camera_m[k][None])[0])

    def image(self, number: int, name: str) -> ImageScene:
        """Project the landmarks on the image of a frame."""
        flight, k = self._flight, self.index(number, name)
        lens, picks, rotation = flight.lens, self._picks(k), self._solved.attitudes.rotation[k]
        every = np.arange(len(flight.landmarks.name))
        lines = sight_lines(
            self._solved.camera_m[[k]],
            self._landmark_m,
            np.zeros_like(every),
            every,
            flight.refraction,
        )
        computed = project(lens, lines.direction @ rotation.T).pixel
        own = flight.picks.landmark[picks]
        shift = self._row_shift_px[picks] if flight.shutter is not None else 0.0
        return ImageScene(
            lens.size_px,
            own,
            flight.picks.pixel[picks] + shift,
            computed[own] + shift,
            self._solved.used[picks] & (self._solved.attitudes.weight[picks] > 0.0),
            computed,
            lambda direction: project(lens, direction @ rotation.T).pixel,
            lambda pixel: ray_of_pixel(lens, pixel) @ rotation,
        )

    @cached_property
    def _row_shift_px(self) -> Floats:
        """How far each pick of a rolling shutter was moved to its frame's time, (P, 2)."""
        flight, rates = self._flight, self._flight.path.turning_rad_s
        if rates is None or flight.picks.part is None:
            return np.zeros_like(flight.picks.pixel)
        lines = self._solved.lines
        return row_shifts_px(flight, self._solved.attitudes.rotation, rates, lines.distance_m)

    def _on_grid(self, position_m: Floats) -> tuple[Floats, Floats]:
        from vopd.flight.coordinates import map_grid

        assert self._flight.grid is not None
        found = map_grid(self._flight.grid.crs, position_m)
        assert found is not None
        return np.stack([found.easting, found.northing], axis=1), found.convergence_deg

    def photograph(self, number: int, name: str) -> Image:
        """Read the photograph of a frame, upright.

        Raises:
            VopdError: if there is none, or it cannot be read
        """
        return photograph(self._flight, number, name)


def photograph(flight: Flight, number: int, name: str) -> Image:
    """Read the photograph of a frame of a flight: its image, or a frame of its video.

    Args:
        flight: whose project says where they are
        number: of the frame
        name: of its image; empty for the frame of a video

    Raises:
        VopdError: if there is none, or it cannot be read
    """
    from vopd.video import open_frames

    if not name:
        frames = open_frames([str(one) for one in flight.video])
        if not 0 <= number < len(frames):
            raise VopdError(f"{frames.source}: has no frame {number}")
        (picture,) = frames.pictures([number])
        return picture
    assert flight.folder is not None
    of_video = [one if one.is_dir() else one.parent for one in flight.video]
    beside = (image_file(one, name) for one in (*of_video, flight.folder))
    found = next(filter(None, beside), None)
    if found is None:
        raise VopdError(f"{name} is not in the project's folder; --images names its folder")
    (picture,) = open_frames([str(found)]).pictures([0])
    return picture


def image_file(folder: Path, name: str) -> Path | None:
    """Find an image in a folder, or in a folder within it.

    Args:
        folder: of the project, or of the images
        name: of the image's file, as the picks have it
    """
    try:
        beside = [folder, *sorted(one for one in folder.iterdir() if one.is_dir())]
        return next((one / name for one in beside if (one / name).is_file()), None)
    except (OSError, ValueError):  # a name that no file can have
        return None
