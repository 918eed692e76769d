"""Mistakes that would explain the residuals of a photograph."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.geometry.linear import transform
from vopd.stellar.field import Failure, StarField, image_points_mm, star_directions
from vopd.stellar.files.images import ImageAxes, centred_images, in_file_coordinates
from vopd.stellar.files.read import StarFile
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    Calibration,
    LensOfStars,
    calibrate,
    calibrate_from_both_starts,
)
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import (
    LEAST_VARIANCE,
    AttitudeFit,
    Outlier,
    OutlierStart,
    find_outliers,
    fit_attitude,
)

# Plausible residuals

MIRROR_RATIO, MIRROR_RATIO_OF_FEW, FEW = 5.0, 50.0, 4
"""Ratio of residuals to the reading error of the interstar angles that no chance explains.

A mirrored photograph keeps its interstar angles and fits no attitude. The few
angles of four stars or less tell their reading error roughly: of 400 good
photographs of three stars, five had a ratio above 5."""

LARGEST_PLATE_MM = 500.0
"""Image coordinates beyond this are hardly mm: the plates of the largest cameras have 360."""

IMPLAUSIBLE_CHANCE = 1e-4
"""Chance below which a reading sigma is wrong (chi-square test)."""


class Plausibility(NamedTuple):
    """Whether the residuals of a photograph are plausible, and which mistake explains them if not.

    Attributes:
        sigma: standard deviation of the residuals, image units; infinite without a solution
        expected: what they should be, as a clause; empty if they are plausible
        mistake: the mistake that mends them best, if one does
        outliers: stars that do not fit the others, if no other mistake explains them
        unexplained: what to do where the residuals are implausible and no mistake mends them
    """

    sigma: float
    expected: str = ""
    mistake: UsualMistake | None = None
    outliers: tuple[Outlier, ...] = ()
    unexplained: str = ""

    @property
    def about_stars(self) -> bool:
        """Whether the mistake found is about some of the stars only."""
        return self.mistake is not None and bool(self.mistake.stars)


def judge(
    file: StarFile,
    stars: StarField,
    reading_sigma: float | None,
    axes: ImageAxes,
    start: OutlierStart = "interstar",
) -> Plausibility:
    """Test the residuals of all stars of a file, and try the common mistakes.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem, two stars or more
        reading_sigma: standard deviation of an image coordinate, if it is known, image units
        axes: how the file's image coordinates were read
        start: how the search for stars that do not fit begins

    Returns:
        What was found.
    """
    fit = fit_attitude(stars)
    sigma = float(np.sqrt(fit.variance_mm2))
    outliers = find_outliers(stars, start=start)
    expected = _implausible(fit, stars, reading_sigma, file.unit)
    mistake = None
    if int(stars.count) > 2 and not (expected and _beyond_plates(file)):
        mistake = one_mistake(file, stars, fit, outliers, axes)
        if expected and mistake is None:
            mistake = two_mistakes(file, stars, fit, axes)
    if not expected and mistake is not None:
        expected = f"mending the mistake named below leaves {mistake.sigma:.3g} {file.unit}"
    unexplained = ""
    if expected and mistake is None:
        agree = reading_sigma is not None and not _implausible(fit, stars, None, file.unit)
        unexplained = _unexplained(file, f"{sigma:.3g} {file.unit}" if agree else "")
    kept = tuple(outliers) if mistake is None or mistake.stars else ()
    return Plausibility(sigma, expected, mistake, kept, unexplained)


def _unexplained(file: StarFile, agreement: str) -> str:
    """Advise what to do about implausible residuals that no mistake mends.

    Args:
        file: the file
        agreement: how well the stars agree with each other; empty if they do not
    """
    if _beyond_plates(file):
        largest = float(np.abs(file.image).max())
        return f"coordinates of {largest:.0f} mm: are they pixels? Name their columns x_px, y_px"
    if len(file.lines) < 3:
        return (
            "two stars cannot tell what is wrong (which stars they are, their coordinates, "
            "the principal distance): add a third one"
        )
    if agreement:
        return f"the stars agree with each other to {agreement}: is the stated sigma too small?"
    return (
        "none of the common mistakes explains this (mirrored or exchanged coordinates, wrong "
        "units, another camera, wrong stars)"
    )


def _beyond_plates(file: StarFile) -> bool:
    """Test whether coordinates in mm are larger than photographs are."""
    return file.unit == "mm" and float(np.abs(file.image).max()) > LARGEST_PLATE_MM


def _implausible(fit: AttitudeFit, stars: StarField, reading_sigma: float | None, unit: str) -> str:
    """Describe what the residuals should be, as a clause; empty if they are plausible."""
    focal = float(stars.focal_length_mm[0])
    if reading_sigma is not None:
        from scipy.special import chdtrc  # slow to import, and most files do without

        ratio = fit.variance_mm2 / reading_sigma**2
        large = chdtrc(fit.freedom, fit.freedom * ratio) < IMPLAUSIBLE_CHANCE
        return f"the stated sigma allows {reading_sigma:.3g} {unit}" if large else ""
    interstar = interstar_reading_sigma_mm(stars)
    ratio = MIRROR_RATIO if int(stars.count) > FEW else MIRROR_RATIO_OF_FEW
    known = bool(np.isfinite(interstar))  # it takes three stars
    if known and fit.variance_mm2 > max(ratio * interstar, 1e-6 * focal) ** 2:
        return f"the interstar angles allow {interstar:.3g} {unit}"
    if fit.variance_mm2 > (LARGEST_RESIDUAL * focal) ** 2:
        return f"a photograph allows {LARGEST_RESIDUAL * focal:.3g} {unit} at most"
    return ""


# A wrong camera

CAMERAS = (("focal",), ("centre",), ("k1",))
"""What may be wrong about a camera."""

SEVERAL_OF_CAMERA = (("focal", "k1"), ("focal", "centre"), ("focal", "centre", "k1"))
"""What may be wrong about it at once."""


class MendedCamera(NamedTuple):
    """A camera that fits the stars.

    Attributes:
        advice: what seems to be wrong and what to do about it
        fit: the attitude that was solved with it
        stars: the problem, with its principal distance
    """

    advice: str
    fit: AttitudeFit
    stars: StarField


def mended_camera(
    stars: StarField,
    free: tuple[str, ...],
    file: StarFile,
    axes: ImageAxes,
    *,
    named: bool,
    far: bool,
) -> MendedCamera | None:
    """Solve a part of the camera with the attitude.

    Args:
        stars: the problem of a file
        free: names of PARAMETERS
        file: the file, for the unit of its images
        axes: how the file's image coordinates were read
        named: whether a principal point can be stated in the file's coordinates
        far: whether the stated camera may be far from the true one

    Returns:
        The camera; None where there is no solution, or no residuals to judge it by.
    """
    unknowns = tuple(name for one in free for name in PARAMETERS[one])
    if 2 * int(stars.count) - 3 - len(unknowns) < 1:
        return None
    if far:
        found = calibrate_from_both_starts(stars, unknowns)
    else:
        found = calibrate(stars, wahba_rotation(stars)[0], unknowns)
    if found.failure != Failure.NONE:
        return None
    mended = replace(stars, focal_length_mm=np.full_like(stars.focal_length_mm, found.lens.focal))
    floor = LEAST_VARIANCE * found.lens.focal**2
    fit = AttitudeFit(max(found.variance, floor), found.freedom, found.matrix)
    return MendedCamera(_advice(found, free, file, axes, named=named), fit, mended)


def _advice(
    found: Calibration, free: tuple[str, ...], file: StarFile, axes: ImageAxes, *, named: bool
) -> str:
    """Advise what to do about a wrong camera."""
    parts = [_part(one, found.lens, file, axes, named=named) for one in free]
    together = f"; --free {','.join(free)} solves them together" if len(free) > 1 else ""
    return ", and ".join(parts) + together


def _part(one: str, lens: LensOfStars, file: StarFile, axes: ImageAxes, *, named: bool) -> str:
    """Advise what to do about one of PARAMETERS."""
    if one == "focal":
        return f"the principal distance seems to be {axes.focal_advice(lens.focal, file.unit)}"
    if one == "k1":
        return f"the lens seems to distort the image: --free k1, or --k1 {axes.k1 + lens.k1:.4g}"
    if not named:
        return "the principal point seems to be another one: --free centre"
    x, y = in_file_coordinates(np.array([lens.centre_x, lens.centre_y]), file, axes).tolist()
    if file.unit == "px":
        return f"the principal point seems to be another one: --centre {x:.6g},{y:.6g}"
    return (
        f"the principal point seems to be at x {x:.4g}, y {y:.4g} mm of the file: subtract them "
        "from its coordinates, or --free centre"
    )


# Wrong coordinates


class MendedStars(NamedTuple):
    """The stars of a file with a mistake undone.

    Attributes:
        advice: what seems to be wrong and what to do about it
        stars: the problem without the mistake
        moved: whether the images are other ones
    """

    advice: str
    stars: StarField
    moved: bool = False


def mended_images(file: StarFile, stars: StarField, axes: ImageAxes) -> Iterator[MendedStars]:
    """Mirror the images, or exchange their x and y.

    Args:
        file: the file, for its coordinates as they are written
        stars: its problem
        axes: how the file's image coordinates were read
    """
    downward = "up: no --y-down" if axes.flipped(file) else "down: --y-down"
    mirrored = (
        f"the photograph is a mirror image of the sky: y seems to point {downward} "
        "(or x and y are exchanged; only the swing tells which)"
    )
    yield MendedStars(mirrored, replace(stars, image_mm=stars.image_mm * [1.0, -1.0]), moved=True)
    if file.unit == "mm":  # the same, a quarter turn away
        return
    try:
        exchanged, _ = centred_images(replace(file, image=file.image[:, ::-1]), axes)
    except VopdError:  # --k1 does not hold there
        return
    advice = "x_px and y_px seem to be exchanged"
    yield MendedStars(advice, replace(stars, image_mm=exchanged), moved=True)


class DirectionMistake(NamedTuple):
    """A mistake in the directions of a file's stars, and how to undo it.

    Attributes:
        kind: the kind of file that may have it
        largest: right ascension and declination as written up to which it is possible
        change: right ascension and declination in degrees, from those as read
        advice: what seems to be wrong and what to do about it
    """

    kind: str
    largest: tuple[float, float]
    change: Callable[[Floats, Floats], tuple[Floats, Floats]]
    advice: str


DIRECTION_MISTAKES = (
    DirectionMistake(
        "ra_hours,dec_deg",
        (np.inf, np.inf),
        lambda ra, dec: (ra / 15.0, dec),
        "right ascension seems to be in degrees: name its column ra_deg",
    ),
    DirectionMistake(
        "ra_deg,dec_deg",
        (24.0, np.inf),
        lambda ra, dec: (ra * 15.0, dec),
        "right ascension seems to be in hours: name its column ra_hours",
    ),
    DirectionMistake(
        "ra_deg,dec_deg",
        (90.0, np.inf),
        lambda ra, dec: (dec, ra),
        "right ascension and declination seem to be exchanged",
    ),
    DirectionMistake(
        "ra_deg,dec_deg",
        (2.0 * np.pi, np.pi / 2.0),
        lambda ra, dec: (np.degrees(ra), np.degrees(dec)),
        "right ascension and declination seem to be in radians: write degrees",
    ),
)


def mended_directions(file: StarFile, stars: StarField) -> Iterator[MendedStars]:
    """Undo each mistake in the directions that a file may have.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem
    """
    for kind, largest, change, advice in DIRECTION_MISTAKES:
        if file.kind == kind and (np.abs(file.positions) <= largest).all():
            directions = star_directions(*change(*file.positions.T))
            yield MendedStars(advice, replace(stars, directions=directions))


# The test of one mistake: its residuals against chance

CHANCE = 1e-4
"""Chance below which a mended mistake makes a difference (F test)."""

LEAST_GAIN = 9.0
"""How many times a mended mistake must make the variance of the residuals smaller."""

LARGEST_RESIDUAL = 0.01
"""Standard deviation of the residuals, in principal distances, that no reading has: half a degree.

The report's perturbed sample, with its large errors of .1 to .3 mm, has .003."""


class UsualMistake(NamedTuple):
    """A mistake which, when undone, makes the stars fit.

    Attributes:
        advice: what seems to be wrong and what to do about it
        sigma: standard deviation of the residuals when it is mended, image units
        stars: the stars it is about, counted from 0; empty for all
    """

    advice: str
    sigma: float
    stars: tuple[int, ...] = ()


def by_coordinates(mended: MendedStars, fit: AttitudeFit) -> UsualMistake | None:
    """Test a mistake of coordinates, first by the solution that takes no iteration."""
    if not _roughly_mm2(mended.stars) < fit.variance_mm2:
        return None
    return _mistake(mended.advice, fit, fit_attitude(mended.stars), mended.stars)


def by_camera(
    stars: StarField,
    free: tuple[str, ...],
    fit: AttitudeFit,
    file: StarFile,
    axes: ImageAxes,
    *,
    named: bool = True,
) -> UsualMistake | None:
    """Test a mistake about the camera."""
    far = not fit.variance_mm2 < _largest_mm2(stars)
    found = mended_camera(stars, free, file, axes, named=named, far=far)
    return found and _mistake(found.advice, fit, found.fit, found.stars)


def by_wrong_stars(
    stars: StarField, outliers: list[Outlier], fit: AttitudeFit
) -> UsualMistake | None:
    """Test the stars without those that disagree, if three at least are left."""
    count = stars.used.shape[-1]
    if not outliers or len(outliers) > count - 3:
        return None
    numbers = sorted(outlier.star for outlier in outliers)
    good = stars.select(np.delete(np.arange(count), numbers))
    listed = ", ".join(str(number + 1) for number in numbers)
    alone = len(numbers) == 1
    verb = f"star {listed} disagrees" if alone else f"stars {listed} disagree"
    pronoun = "it" if alone else "them"
    advice = f"{verb} with the others: misidentified, or misread? --reject leaves {pronoun} out"
    return _mistake(advice, fit, fit_attitude(good), good, tuple(numbers))


def _mistake(
    advice: str,
    fit: AttitudeFit,
    mended: AttitudeFit,
    stars: StarField,
    wrong: tuple[int, ...] = (),
) -> UsualMistake | None:
    """Believe a mistake if the residuals without it are plausible and smaller than by chance."""
    if not mended.variance_mm2 * LEAST_GAIN < fit.variance_mm2:
        return None
    if not mended.variance_mm2 < _largest_mm2(stars):
        return None
    ratio = fit.variance_mm2 / mended.variance_mm2  # infinite without a solution: no chance
    from scipy.special import fdtrc

    if fdtrc(fit.freedom, mended.freedom, ratio) > CHANCE:
        return None
    return UsualMistake(advice, float(np.sqrt(mended.variance_mm2)), wrong)


def _largest_mm2(stars: StarField) -> float:
    """Bound the variance of residuals that readings can have."""
    return (LARGEST_RESIDUAL * float(stars.focal_length_mm[0])) ** 2


def _roughly_mm2(stars: StarField) -> float:
    """Estimate the variance of the residuals by the singular-value solution, without iteration."""
    matrix, _ = wahba_rotation(stars)
    computed = image_points_mm(transform(matrix, stars.directions), stars.focal_length_mm)
    return float(((stars.image_mm - computed) ** 2).sum() / (2 * len(computed) - 3))


# One mistake, and two
#
# Hours read as degrees, exchanged or mirrored coordinates, a wrong camera and a
# misidentified star leave large residuals and no other sign. Where the residuals
# are implausible, each mistake is mended in turn and the stars are solved again.

AS_GOOD = 3.0
"""Ratio of residuals up to which the simpler mistake is believed.

A mistake about all stars is simpler than one about some, and fewer unknowns of the camera are."""


def one_mistake(
    file: StarFile, stars: StarField, fit: AttitudeFit, outliers: list[Outlier], axes: ImageAxes
) -> UsualMistake | None:
    """Find the common mistake that, mended, makes the residuals much smaller; None if none does.

    Args:
        file: the file, for its coordinates as they are written
        stars: its problem
        fit: the solution of the stars as they are
        outliers: stars that do not fit the others
        axes: how the file's image coordinates were read
    """
    coordinates = (*mended_images(file, stars, axes), *mended_directions(file, stars))
    tried = [by_coordinates(mended, fit) for mended in coordinates]
    cameras = [by_camera(stars, free, fit, file, axes) for free in CAMERAS]
    best = _best([*tried, *cameras, by_wrong_stars(stars, outliers, fit)])
    if best is None or best not in cameras:
        return best
    several = _several_of_camera(stars, fit, file, axes)
    better = several is not None and several.sigma**2 * LEAST_GAIN < best.sigma**2
    return several if better else best


def two_mistakes(
    file: StarFile, stars: StarField, fit: AttitudeFit, axes: ImageAxes
) -> UsualMistake | None:
    """Find two mistakes that only together explain the residuals; arguments as `one_mistake`."""
    tried = [_several_of_camera(stars, fit, file, axes)]
    images = list(mended_images(file, stars, axes))
    directions = list(mended_directions(file, stars))
    for image in images:
        for direction in mended_directions(file, image.stars):
            both = MendedStars(f"{image.advice}, and {direction.advice}", direction.stars)
            tried.append(by_coordinates(both, fit))
    for mended in (*images, *directions):
        for second in _second_mistakes(mended, fit, file, axes):
            tried.append(second._replace(advice=f"{mended.advice}, and {second.advice}"))
    return _best(tried)


def _several_of_camera(
    stars: StarField, fit: AttitudeFit, file: StarFile, axes: ImageAxes
) -> UsualMistake | None:
    """Find the fewest unknowns of the camera that leave residuals nearly as small as any."""
    tried = [by_camera(stars, free, fit, file, axes) for free in SEVERAL_OF_CAMERA]
    found = [one for one in tried if one is not None]
    least = min((one.sigma for one in found), default=0.0)
    return next((one for one in found if one.sigma <= AS_GOOD * least), None)


def _second_mistakes(
    mended: MendedStars, fit: AttitudeFit, file: StarFile, axes: ImageAxes
) -> Iterator[UsualMistake]:
    """Test a second mistake beside mended coordinates: the camera, or some stars."""
    for free in CAMERAS:
        found = by_camera(mended.stars, free, fit, file, axes, named=not mended.moved)
        if found is not None:
            yield found
    wrong = by_wrong_stars(mended.stars, find_outliers(mended.stars), fit)
    if wrong is not None:
        yield wrong


def _best(tried: Iterable[UsualMistake | None]) -> UsualMistake | None:
    """Choose the mistake with the least residuals, one about all stars before one about some.

    Of several that leave the same, to three digits, it is the first.
    """
    found = [one for one in tried if one is not None]
    if not found:
        return None
    largest = AS_GOOD * min(one.sigma for one in found)
    return min(
        found, key=lambda one: (one.sigma > largest, bool(one.stars), float(f"{one.sigma:.3g}"))
    )
