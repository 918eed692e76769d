"""Terrain about landmarks: the shape of the ground, from a GeoTIFF that rasterio reads.

A landmark's own height is known better than the terrain's. The terrain is raised or lowered until
it goes through the landmark, so that its shape alone counts.
"""

from __future__ import annotations

import re
import warnings
from typing import Any

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.files import optional_package
from vopd.findings import Finding, VopdError, first_of
from vopd.flight.coordinates import (
    M_PER_FT,
    HeightDatum,
    earth_centred_positions,
    has_height_axis,
    units_of_crs,
)
from vopd.flight.flight import LandmarkSet
from vopd.flight.project.keys import Project, Section
from vopd.flight.project.track import height_datum
from vopd.geometry.earth import geodetic
from vopd.inputs import no_file

MOST_BYTES = 2**28  # of a block, which GDAL reads as a whole, and up to four at once
CACHE_MB = 100  # of blocks that were read; GDAL's own is a twentieth of the memory
MOST_CELLS = 1000  # along a side of what is read at once: of more, each second, third ... one
LOWEST_M, HIGHEST_M = -500.0, 9000.0  # of land: what is beyond, as -9999, is no height
ABOVE_M = 15.0  # of a landmark above the ground, beyond the others': it is said
APART_M = 50.0  # of half of the landmarks, the same: the terrain is of another place, or in feet
LEVELS_M = 110.0  # of all: no geoid is farther from the ellipsoid
RELIEF, RELIEF_M = 0.03, 10.0  # of landmarks' heights, of their extent and in metres
UNKNOWN_CODE = "unretrievable"  # GDAL's word: it takes WGS 84 in its place
NAMED = 3  # landmarks in a sentence
FEET = re.compile(r"(us[ -]?)?(survey[ -]?)?(ft|foot|feet)([ -]?us)?|international foot", re.I)
"""Units that a GeoTIFF declares of its heights; where it declares another it is metres."""


class Terrain:
    """A GeoTIFF of heights.

    Args:
        name: of the file, for messages
        dataset: as rasterio has opened it
        section: `[landmarks]` of the project
    """

    def __init__(self, name: str, dataset: Any, section: Section) -> None:
        self.name, self._dataset, self._section = name, dataset, section
        self._rasterio = optional_package("rasterio", "terrain")
        self._transform = optional_package("rasterio.warp", "terrain").transform
        self._refused = optional_package("rasterio._err", "terrain")  # GDAL's own, not public
        self._covered = np.zeros(0, bool)  # places that were read, whether they are in the file
        self._unit_m = M_PER_FT if FEET.fullmatch(dataset.units[0] or "") else 1.0
        self._units = units_of_crs(dataset.crs.to_wkt(), name)  # of its grid, and of its heights
        for own in self._units[1]:
            self._unit_m = self._unit_m if own.is_metre else own.metres
        self._odd_m = float("nan")  # of a cell that was read, beyond the heights of land

    def heights_m(self, position_m: Floats) -> Floats:
        """Read heights, metres from where the file counts them, at Earth-centred positions, (n,).

        Args:
            position_m: (n, 3)

        Returns:
            NaN outside the file, and where it has no height.

        Raises:
            VopdError: where the file is damaged
        """
        found = np.full(len(position_m), np.nan)
        here, data = geodetic(position_m), self._dataset
        x, y = self._converted("EPSG:4326", data.crs, here.longitude_deg, here.latitude_deg)
        if data.crs.is_geographic:  # the file may count from 0 to 360, or across 180
            middle = (data.bounds.left + data.bounds.right) / 2.0
            x = x + 360.0 * np.round((middle - x) / 360.0)
        grid = ~data.transform
        across = grid.a * x + grid.b * y + grid.c
        down = grid.d * x + grid.e * y + grid.f
        u, v = across - 0.5, down - 0.5
        inside = (across >= 0.0) & (down >= 0.0) & (across <= data.width) & (down <= data.height)
        self._covered = inside
        if not inside.any():
            return found
        u = np.clip(u[inside], 0.0, data.width - 1.0)
        v = np.clip(v[inside], 0.0, data.height - 1.0)
        low = np.floor([u.min(), v.min()]).astype(int)
        high = np.minimum(np.floor([u.max(), v.max()]).astype(int) + 2, [data.width, data.height])
        size = high - low
        shape = np.minimum(size, MOST_CELLS)
        window = self._rasterio.windows.Window(*low.tolist(), *size.tolist())
        try:
            # without one GDAL writes to standard error
            with self._rasterio.Env(GDAL_CACHEMAX=CACHE_MB):
                cells = data.read(1, window=window, out_shape=tuple(shape[::-1]), masked=True)
        except self._rasterio.errors.RasterioError as error:
            raise self._section.error(
                "terrain", f"{self.name} cannot be read at the landmarks: is it complete?"
            ) from error
        stored = np.ma.filled(cells.astype(float), np.nan)
        height = (stored * data.scales[0] + data.offsets[0]) * self._unit_m
        beyond = ~((height > LOWEST_M) & (height < HIGHEST_M))
        odd = stored[beyond & np.isfinite(height)]
        self._odd_m = float(odd[0]) if len(odd) else self._odd_m
        height[beyond] = np.nan
        step = size / shape
        column, row = (u - low[0] + 0.5) / step[0] - 0.5, (v - low[1] + 0.5) / step[1] - 0.5
        found[inside] = _bilinear(height, column, row)
        return found

    def above_m(self, position_m: Floats) -> Floats:
        """Find how far Earth-centred positions are above it, its heights as they stand, (n,)."""
        return np.asarray(geodetic(position_m).height_m - self.heights_m(position_m))

    def about(self, marks: LandmarkSet, used: Ints) -> tuple[list[str], list[Finding]]:
        """Compare heights of landmarks with the terrain's.

        Args:
            marks: the landmarks
            used: indices of those that are clicked

        Returns:
            A line for the summary, and warnings.

        Raises:
            VopdError: where the terrain is that of another place
        """
        position_m = marks.position_m[used]
        names = [marks.name[k] for k in used.tolist()]
        raw_m = self.heights_m(position_m)
        known = np.isfinite(raw_m)
        if not known.any():
            message = self._odd_text() or self._elsewhere(position_m)
            raise self._section.error("terrain", message)
        warned = []
        if not known.all():
            some = first_of(
                [name for name, one in zip(names, known, strict=True) if not one], NAMED
            )
            warned.append(
                f"[landmarks] terrain: {self.name} has no height at {some}: the ground there is "
                "taken as level"
            )
        try:
            above = self._above_of(position_m[known], raw_m[known])
        except VopdError:  # a grid is not there, which the shape of the ground does not need
            lines = [f"terrain: {self.name}; heights are not compared, for want of its geoid"]
            return lines, self._told(warned)
        usual = float(np.median(above))
        off = np.abs(above - usual)
        if np.median(off) > APART_M or abs(usual) > LEVELS_M:
            warned.append(
                f"[landmarks] terrain: {self.name}: heights of the landmarks less the terrain's "
                f"are {above.min():.0f} to {above.max():.0f} m: is it of this place, and in metres?"
            )
        lines = [
            f"terrain: {self.name}, {abs(usual):.1f} m {'below' if usual >= 0.0 else 'above'} the "
            f"landmarks (median of {len(above)}); it is laid through each of them"
        ]
        own = [name for name, one in zip(names, known, strict=True) if one]
        high = np.flatnonzero(off > ABOVE_M)
        if len(high) and not warned:
            some = first_of([f"{own[k]} ({above[k] - usual:+.0f} m)" for k in high], NAMED)
            lines.append(
                f"  not on the ground: {some}; for masts patch_px = 13 in the file of landmarks"
            )
        return lines, self._told(warned)

    def _above_of(self, position_m: Floats, raw_m: Floats) -> Floats:
        """Find how far positions are above the terrain, its heights in its own height system."""
        here = geodetic(position_m)
        name = self._dataset.crs.to_wkt()
        datum: HeightDatum | None = HeightDatum("same")
        if has_height_axis(name, self.name):
            datum = None
        elif self._section.has("height"):
            datum = height_datum(self._section)
        if datum is not None:
            name = "EPSG:4326"
            x, y = here.longitude_deg, here.latitude_deg
        else:
            own = self._dataset.crs
            x, y = self._converted("EPSG:4326", own, here.longitude_deg, here.latitude_deg)
            raw_m = raw_m / self._units[1][0].metres
        ground = np.stack([x, y, raw_m], axis=1)
        on_it = earth_centred_positions(ground, datum is not None, name, datum, self.name)
        return np.asarray(here.height_m - geodetic(on_it).height_m)

    def _converted(self, source: Any, target: Any, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Convert coordinates; NaN of places that a projection does not show.

        Raises:
            VopdError: where the terrain's coordinate reference system is not one of the Earth's
        """
        try:
            found = self._transform(source, target, x.tolist(), y.tolist())
            return np.array(found[0]), np.array(found[1])
        except self._refused.CPLE_NotSupportedError as error:
            kind = self._dataset.crs.to_wkt().partition(",")[0]
            raise self._section.error(
                "terrain", f"{self.name}: its coordinate reference system, {kind}, ...], is not "
                "one that coordinates on the Earth can be converted to: export it in another, such "
                "as UTM"
            ) from error  # fmt: skip
        except self._refused.CPLE_BaseError:
            if len(x) == 1:  # of more, one place would cost the others
                return np.full(1, np.nan), np.full(1, np.nan)
        each = [self._converted(source, target, x[k : k + 1], y[k : k + 1]) for k in range(len(x))]
        return np.concatenate([one for one, _ in each]), np.concatenate([one for _, one in each])

    def _odd_text(self) -> str:
        """Name the value of a cell that is no height; empty if none is known."""
        if np.isnan(self._odd_m):
            return ""
        return (
            f"{self.name} has cells of {self._odd_m:.9g} near the landmarks, which is no height of "
            f"land: declare that they have none, as by gdal_translate -a_nodata {self._odd_m:.9g}"
        )

    def _told(self, warned: list[str]) -> list[Finding]:
        odd = [f"[landmarks] terrain: {self._odd_text()}"] * (not np.isnan(self._odd_m))
        every = [*warned, *odd, *self._doubt_of_unit()]
        return [Finding(one, self._section.project, severity="warning") for one in every]

    def _doubt_of_unit(self) -> list[str]:
        """Doubt heights of no declared unit on a grid in feet: they mostly are feet, too."""
        if self._dataset.units[0] or self._unit_m != 1.0:
            return []
        return [
            f"[landmarks] terrain: {self.name}: its grid counts in {one.name}, and its heights, of "
            "no declared unit, are taken for metres: declare it, gdal_edit.py -units ft, or m"
            for one in self._units[0][:1]
            if one.is_foot
        ]

    def _elsewhere(self, position_m: Floats) -> str:
        here = geodetic(position_m)
        bounds = self._dataset.bounds
        x, y = np.array([[bounds.left, bounds.right], [bounds.bottom, bounds.top]])
        longitude, latitude = self._converted(self._dataset.crs, "EPSG:4326", x, y)
        place = f"latitude {here.latitude_deg.mean():.4f}, "
        place += f"longitude {here.longitude_deg.mean():.4f}"
        if self._covered.any():
            return f"{self.name} has no height at the landmarks, {place}: its cells there are empty"
        if not (np.abs([*longitude, *latitude]) <= 360.0).all():
            return f"{self.name} has no height at the landmarks, {place}: is it of this place?"
        return (
            f"{self.name} has no height at the landmarks, {place}: it is of latitude "
            f"{latitude.min():.4f} to {latitude.max():.4f}, longitude {longitude.min():.4f} to "
            f"{longitude.max():.4f}"
        )


def relief_text(landmark_m: Floats) -> list[str]:
    """Say that a terrain would help where landmarks differ much in height; else nothing.

    Args:
        landmark_m: of those that are clicked, east, north, up, (N, 3)
    """
    *level_m, high_m = np.ptp(landmark_m, axis=0).tolist()
    wide_m = float(np.hypot(*level_m))
    if high_m < max(RELIEF * wide_m, RELIEF_M):
        return []
    return [
        f"the landmarks' heights differ by {high_m:.0f} m: where the ground slopes, a match drifts "
        "by some hundredths of a pixel; [landmarks] terrain prevents that"
    ]


def _bilinear(grid: Floats, column: Floats, row: Floats) -> Floats:
    """Interpolate between the four cells about each place; NaN where one of them has none."""
    height, width = grid.shape
    left = np.clip(np.floor(column).astype(int), 0, max(width - 2, 0))
    top = np.clip(np.floor(row).astype(int), 0, max(height - 2, 0))
    x, y = np.clip(column - left, 0.0, 1.0), np.clip(row - top, 0.0, 1.0)
    right, below = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    upper = grid[top, left] * (1.0 - x) + grid[top, right] * x
    lower = grid[below, left] * (1.0 - x) + grid[below, right] * x
    return np.asarray(upper * (1.0 - y) + lower * y)


def read_terrain(project: Project) -> Terrain | None:
    """Open the terrain of a project; None if it names none.

    Args:
        project: whose `[landmarks] terrain` names the file

    Raises:
        VopdError: where it is no raster of heights, or rasterio is not installed
    """
    section = project.section("landmarks")
    if not section.has("terrain"):
        return None
    name = section.text("terrain")
    path = project.folder / name
    if not path.is_file():
        raise section.error("terrain", f"{name}: {no_file(path) or 'there is no such file'}")
    rasterio = optional_package("rasterio", "terrain", "[landmarks] terrain")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a file without a place, which is an error below
            # no other driver: some take what they read from other files, or from a network
            dataset = rasterio.open(path, driver="GTiff")
    except rasterio.errors.RasterioError as error:
        message = f"{name}: not a GeoTIFF that can be read: is it complete?"
        raise section.error("terrain", message) from error
    placed = dataset.transform
    if dataset.crs is None or placed.is_identity or not abs(placed.determinant) > 0.0:
        raise section.error(
            "terrain", f"{name} does not say where it is: give it a coordinate reference system, "
            "as by gdal_translate -a_srs EPSG:... -a_ullr ..."
        )  # fmt: skip
    if UNKNOWN_CODE in dataset.crs.to_wkt():
        raise section.error(
            "terrain", f"{name}: the code of its coordinate reference system is not known: give it "
            "the one that it is in, as by gdal_translate -a_srs EPSG:..."
        )  # fmt: skip
    if dataset.count > 1 or np.dtype(dataset.dtypes[0]).kind == "c":
        has = f"{dataset.count} bands" if dataset.count > 1 else "complex numbers"
        raise section.error("terrain", f"{name} has {has}: a terrain is one band of heights")
    rows, columns = dataset.block_shapes[0]
    if rows * columns * np.dtype(dataset.dtypes[0]).itemsize > MOST_BYTES:
        raise section.error(
            "terrain", f"{name} has blocks of {columns} x {rows} cells, too many for the memory: "
            "write it in smaller ones, as by gdal_translate -co TILED=YES"
        )  # fmt: skip
    return Terrain(name, dataset, section)
