"""Mistakes that would explain the residuals of a photograph."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import VopdError, size_text
from vopd.geometry.linear import transform
from vopd.geometry.rotations import rotation_of_directions
from vopd.mistakes import Explanation, Mistake, explanations, likeliest
from vopd.stellar.field import Failure, StarField, image_points_mm, star_directions
from vopd.stellar.files.images import ImageAxes, centred_images, in_file_coordinates
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    LensOfStars,
    calibrate,
    calibrate_from_both_starts,
    least_square,
)
from vopd.stellar.methods.wahba import wahba_rotation
from vopd.stellar.outlier_search import (
    LEAST_VARIANCE,
    AttitudeFit,
    FittedStars,
    Outlier,
    OutlierStart,
    find_outliers,
    fit_attitude,
    fit_together,
)

# Plausible residuals

MIRROR_RATIO, MIRROR_RATIO_OF_FEW, FEW = 5.0, 50.0, 4
"""Ratio of residuals to the reading error of the interstar angles that no chance explains.

A mirrored photograph keeps its interstar angles and fits no attitude. The few
angles of four stars or less tell their reading error roughly: of 400 good
photographs of three stars, five had a ratio above 5."""

ROUNDING = 1e-6
"""Residuals, in principal distances, that the digits of a file may make: no mistake is sought."""

LARGEST_PLATE_MM = 500.0
"""Image coordinates beyond this are hardly mm: the plates of the largest cameras have 360."""

IMPLAUSIBLE_CHANCE = 1e-4  # chance below which a reading sigma is wrong (chi-square test)


class Plausibility(NamedTuple):
    """Plausibility of a photograph's residuals, and the mistake that explains them if not."""

    sigma: float  # standard deviation of the residuals, image units; infinite without a solution
    expected: str = ""  # what they should be, as a clause; empty if they are plausible
    mistake: Explanation | None = None  # the mistake that mends them best, if one does
    # stars that do not fit the others, if no other mistake explains them
    outliers: tuple[Outlier, ...] = ()
    # what to do where the residuals are implausible and no mistake mends them
    unexplained: str = ""

    @property
    def about_stars(self) -> bool:
        """Whether the mistake found is about some of the stars only."""
        return self.mistake is not None and bool(self.mistake.points)

    @property
    def odd(self) -> set[int]:
        """The stars that are named, counted from 0."""
        named = self.mistake.points if self.mistake is not None else ()
        return {one.star for one in self.outliers} | set(named)


def judge(
    file: StarFile,
    stars: StarField,
    reading_sigma: float | None,
    axes: ImageAxes,
    start: OutlierStart = "interstar",
    fitted: FittedStars | None = None,
    *,
    suspicious: bool = True,
) -> Plausibility:
    """Test the residuals of all stars of a file, and try the common mistakes.

    Args:
        file: the file, for its right ascensions and declinations as they are written
        stars: its problem, two stars or more
        reading_sigma: standard deviation of an image coordinate, if it is known, image units
        axes: how the file's image coordinates were read
        start: how the search for stars that do not fit begins
        fitted: the stars with their solution, if it is known
        suspicious: whether a mistake may explain plausible residuals, as `suspicious_photographs`
            tells

    Returns:
        What was found.
    """
    if fitted is None:
        (fitted,) = fit_together([stars], start)
    fit, outliers = fitted.fit, fitted.outliers
    sigma = float(np.sqrt(fit.variance_mm2))
    expected = implausible_residuals(fit, stars, reading_sigma, file.unit, fitted.interstar_mm)
    rounding = sigma <= ROUNDING * float(stars.focal_length_mm[0])
    if not expected and (rounding or not suspicious):
        return Plausibility(sigma)
    mistake = None
    if int(stars.count) > 2 and not (expected and _beyond_plates(file)):
        camera = bool(expected) or bool(_camera_may_explain(stars, fit.matrix, fit.square_mm2))
        mistake = one_mistake(file, stars, fit, axes, outliers, CAMERA_MISTAKES * camera)
        if expected and mistake is None:
            mistake = two_mistakes(file, stars, fit, axes)
        elif camera and mistake is None and int(stars.count) > FEW:
            mistake = several_of_camera(file, stars, fit, axes)
    if not expected and mistake is not None:
        expected = (
            f"mending the mistake named below leaves {size_text(mistake.residual, 3)} {file.unit}"
        )
    unexplained = ""
    if expected and mistake is None:
        agree = reading_sigma is not None and not implausible_residuals(
            fit, stars, None, file.unit, fitted.interstar_mm
        )
        unexplained = fisheye_advice(file, stars) or unexplained_advice(
            file, f"{size_text(sigma, 3)} {file.unit}" if agree else ""
        )
    kept = tuple(outliers) if mistake is None or mistake.points else ()
    return Plausibility(sigma, expected, mistake, kept, unexplained)


def unexplained_advice(file: StarFile, agreement: str) -> str:
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


FISHEYE_GAIN = 5.0
"""How many times nearer to the stars a fisheye's rays must be than those of central projection."""
FISHEYE_DEG = 1.5  # root mean square from the stars that a fisheye of this family may leave
WIDEST_DEG = np.arange(5.0, 100.0, 1.0)  # from the axis, of the outermost star


def fisheye_advice(file: StarFile, stars: StarField) -> str:
    """Advise what to do if the photograph is that of a fisheye; empty if it is not.

    Its images lie at the principal distance times the angle from the axis, not times its tangent.
    Each angle of the outermost star is tried for both, with the attitude that fits best.
    """
    radius = np.hypot(*stars.image_mm.T)
    if not radius.max() > 0.0:
        return ""
    aside = stars.image_mm / np.where(radius > 0.0, radius, 1.0)[:, None]
    widest = np.radians(WIDEST_DEG)
    central = np.tan(np.minimum(widest, np.radians(88.0)))[:, None] * radius / radius.max()
    angles = np.stack([widest[:, None] * radius / radius.max(), np.arctan(central)])
    rays = np.concatenate([np.sin(angles)[..., None] * aside, -np.cos(angles)[..., None]], axis=-1)
    matrix, _ = rotation_of_directions(rays, stars.directions, np.ones(len(radius)))
    off = rays - transform(matrix, stars.directions)
    fisheye, plain = np.degrees(np.sqrt((off**2).sum(axis=-1).mean(axis=-1)))
    best = int(fisheye.argmin())
    if fisheye[best] > FISHEYE_DEG or fisheye[best] * FISHEYE_GAIN > plain.min():
        return ""
    scale = radius.max() / widest[best]
    return (
        f"the lens seems to be a fisheye of about {scale:.3g} {file.unit} a radian, and stars are "
        "solved in central projection: undistort their coordinates first (vopd help stellar)"
    )


def _beyond_plates(file: StarFile) -> bool:
    """Test whether coordinates in mm are larger than photographs are."""
    return file.unit == "mm" and float(np.abs(file.image).max()) > LARGEST_PLATE_MM


def implausible_residuals(
    fit: AttitudeFit,
    stars: StarField,
    reading_sigma: float | None,
    unit: str,
    interstar: float,
) -> str:
    """Describe what the residuals should be, as a clause; empty if they are plausible.

    Args:
        fit: the solution
        stars: its problem
        reading_sigma: standard deviation of an image coordinate, if it is known, image units
        unit: the image unit
        interstar: that standard deviation by the interstar angles; NaN if unknown
    """
    focal = float(stars.focal_length_mm[0])
    if reading_sigma is not None:
        from scipy.special import chdtrc  # slow to import, and most files do without

        ratio = fit.variance_mm2 / reading_sigma**2
        large = chdtrc(fit.freedom, fit.freedom * ratio) < IMPLAUSIBLE_CHANCE
        return f"the stated sigma allows {size_text(reading_sigma, 3)} {unit}" if large else ""
    ratio = MIRROR_RATIO if int(stars.count) > FEW else MIRROR_RATIO_OF_FEW
    known = bool(np.isfinite(interstar))  # it takes three stars
    if known and fit.variance_mm2 > max(ratio * interstar, ROUNDING * focal) ** 2:
        return f"the interstar angles allow {size_text(interstar, 3)} {unit}"
    if fit.variance_mm2 > (LARGEST_RESIDUAL * focal) ** 2:
        return f"a photograph allows {size_text(LARGEST_RESIDUAL * focal, 3)} {unit} at most"
    return ""


# Usual mistakes, and the photograph with each of them corrected
#
# Hours read as degrees, exchanged or mirrored coordinates, a wrong camera and a
# misidentified star leave large residuals and no other sign. Each is corrected in turn
# and the stars are solved again.


class Corrected(NamedTuple):
    """A photograph with a mistake corrected."""

    stars: StarField  # the problem
    fit: AttitudeFit | None = None  # its attitude, where it is solved already
    wrong: tuple[int, ...] = ()  # the stars that are left out, counted from 0


Corrections = Iterator[tuple[Corrected, tuple[object, ...]]]
"""What a change yields: corrected photographs, and the values that the advice names."""


def _mirrored(file: StarFile, stars: StarField, axes: ImageAxes, fit: AttitudeFit) -> Corrections:
    downward = "up: --y-up" if axes.flipped(file) else "down: --y-down"
    yield Corrected(replace(stars, image_mm=stars.image_mm * [1.0, -1.0])), (downward,)


def _exchanged(file: StarFile, stars: StarField, axes: ImageAxes, fit: AttitudeFit) -> Corrections:
    if file.unit == "mm":  # the same as mirrored, a quarter turn away
        return
    try:
        image, _ = centred_images(replace(file, image=file.image[:, ::-1]), axes)
    except VopdError:  # --k1 does not hold there
        return
    yield Corrected(replace(stars, image_mm=image)), ()


def _other_directions(
    kind: str,
    largest: tuple[float, float],
    change: Callable[[Floats, Floats], tuple[Floats, Floats]],
) -> Callable[..., Corrections]:
    """Make the change of a mistake in right ascension and declination.

    Args:
        kind: the kind of file that may have it
        largest: right ascension and declination as written up to which it is possible
        change: right ascension and declination in degrees, from those as read
    """

    def changed(file: StarFile, stars: StarField, axes: ImageAxes, fit: AttitudeFit) -> Corrections:
        if file.kind == kind and (np.abs(file.positions) <= largest).all():
            directions = star_directions(*change(*file.positions.T))
            yield Corrected(replace(stars, directions=directions)), ()

    return changed


def _with_camera(
    free: tuple[str, ...],
    named: bool,
    file: StarFile,
    stars: StarField,
    axes: ImageAxes,
    fit: AttitudeFit,
) -> Corrections:
    """Solve a part of the camera with the attitude, if there are residuals left to judge it by."""
    unknowns = tuple(name for one in free for name in PARAMETERS[one])
    if 2 * int(stars.count) - 3 - len(unknowns) < 1:
        return
    if fit.variance_mm2 < _largest_mm2(stars):
        found = calibrate(stars, wahba_rotation(stars)[0], unknowns)
    else:  # the camera may be far from the stated one
        found = calibrate_from_both_starts(stars, unknowns)
    if found.failure != Failure.NONE:
        return
    focal = found.lens.focal
    variance = max(found.variance, LEAST_VARIANCE * focal**2)
    solved = AttitudeFit(variance, found.freedom, found.matrix)
    corrected = replace(stars, focal_length_mm=np.full_like(stars.focal_length_mm, focal))
    advice = camera_advice(free, found.lens, file, axes, named=named)
    yield Corrected(corrected, solved), (advice,)


def camera_advice(
    free: tuple[str, ...], lens: LensOfStars, file: StarFile, axes: ImageAxes, *, named: bool
) -> str:
    """Advise what to do about a wrong camera."""
    parts = [_part(one, lens, file, axes, named=named) for one in free]
    every = [one for one in PARAMETERS if one in (*free, *axes.free)]
    together = f"; --free {','.join(every)} solves them together" if len(every) > 1 else ""
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


def _without_outliers(
    known: list[Outlier] | None,
    file: StarFile,
    stars: StarField,
    axes: ImageAxes,
    fit: AttitudeFit,
) -> Corrections:
    """Leave out the stars that disagree, if three at least are left.

    Args:
        known: these stars; None: they are searched for
    """
    outliers = find_outliers(stars) if known is None else known
    count = stars.used.shape[-1]
    if not outliers or len(outliers) > count - 3:
        return
    wrong = tuple(sorted(outlier.star for outlier in outliers))
    good = stars.select(np.delete(np.arange(count), wrong))
    listed = ", ".join(str(number + 1) for number in wrong)
    alone = len(wrong) == 1
    subject = f"star {listed} disagrees" if alone else f"stars {listed} disagree"
    yield Corrected(good, fit_attitude(good), wrong), (subject, "it" if alone else "them")


def camera_mistake(*free: str, named: bool = True) -> Mistake[Corrected]:
    """Describe a wrong camera.

    Args:
        free: names of PARAMETERS, what is wrong about it
        named: whether a principal point can be stated in the file's coordinates
    """
    return Mistake("another " + " and ".join(free), partial(_with_camera, free, named), "{}")


def star_mistake(outliers: list[Outlier] | None = None) -> Mistake[Corrected]:
    """Describe wrong stars: these, or those that are found."""
    advice = "{} with the others: misidentified, or misread? --reject leaves {} out"
    return Mistake("wrong stars", partial(_without_outliers, outliers), advice)


IMAGE_MISTAKES: tuple[Mistake[Corrected], ...] = (
    Mistake(
        "a mirror image",
        _mirrored,
        "the photograph is a mirror image of the sky: y seems to point {} "
        "(or x to point left, or x and y are exchanged; only the swing tells which)",
    ),
    Mistake("x and y exchanged", _exchanged, "x_px and y_px seem to be exchanged"),
)
DIRECTION_MISTAKES: tuple[Mistake[Corrected], ...] = (
    Mistake(
        "degrees for hours",
        _other_directions("ra_hours,dec_deg", (np.inf, np.inf), lambda ra, dec: (ra / 15.0, dec)),
        "right ascension seems to be in degrees: name its column ra_deg",
    ),
    Mistake(
        "hours for degrees",
        _other_directions("ra_deg,dec_deg", (24.0, np.inf), lambda ra, dec: (ra * 15.0, dec)),
        "right ascension seems to be in hours: name its column ra_hours",
    ),
    Mistake(
        "right ascension and declination exchanged",
        _other_directions("ra_deg,dec_deg", (90.0, np.inf), lambda ra, dec: (dec, ra)),
        "right ascension and declination seem to be exchanged",
    ),
    Mistake(
        "radians",
        _other_directions(
            "ra_deg,dec_deg",
            (2.0 * np.pi, np.pi / 2.0),
            lambda ra, dec: (np.degrees(ra), np.degrees(dec)),
        ),
        "right ascension and declination seem to be in radians: write degrees",
    ),
)
CAMERA_MISTAKES = (camera_mistake("focal"), camera_mistake("centre"), camera_mistake("k1"))
SEVERAL_OF_CAMERA = (
    camera_mistake("focal", "k1"),
    camera_mistake("focal", "centre"),
    camera_mistake("focal", "centre", "k1"),
)
"""Several things that may be wrong about a camera at once, the fewest unknowns first."""


def both(first: Mistake[Corrected], second: Mistake[Corrected]) -> Mistake[Corrected]:
    """Combine two mistakes: the second is corrected in what the first has left."""

    def change(file: StarFile, stars: StarField, axes: ImageAxes, fit: AttitudeFit) -> Corrections:
        for one, values in first.change(file, stars, axes, fit):
            for other, more in second.change(file, one.stars, axes, fit):
                yield other, (*values, *more)

    names = f"{first.name}, and {second.name}"
    return Mistake(names, change, f"{first.advice}, and {second.advice}")


OF_OTHER_IMAGES = tuple(camera_mistake(name, named=False) for name in ("focal", "centre", "k1"))
TWO_MISTAKES = (
    *(both(one, other) for one in IMAGE_MISTAKES for other in DIRECTION_MISTAKES),
    *(both(one, other) for one in IMAGE_MISTAKES for other in (*OF_OTHER_IMAGES, star_mistake())),
    *(
        both(one, other)
        for one in DIRECTION_MISTAKES
        for other in (*CAMERA_MISTAKES, star_mistake())
    ),
)


# The mistake that is believed: its residuals against chance

CHANCE = 1e-4  # chance below which a corrected mistake makes a difference (F test)
LEAST_GAIN = 9.0
"""How many times a corrected mistake must make the variance of the residuals smaller."""

LARGEST_RESIDUAL = 0.01
"""Standard deviation of the residuals, in principal distances, that no reading has: half a degree.

The report's perturbed sample, with its large errors of .1 to .3 mm, has .003."""

AS_GOOD = 3.0
"""Ratio of residuals up to which the simpler mistake is believed.

A mistake about all stars is simpler than one about some, and fewer unknowns of the camera are."""


def one_mistake(
    file: StarFile,
    stars: StarField,
    fit: AttitudeFit,
    axes: ImageAxes,
    outliers: list[Outlier],
    camera: tuple[Mistake[Corrected], ...] = CAMERA_MISTAKES,
) -> Explanation | None:
    """Find the usual mistake that, corrected, makes the residuals much smaller; None if none does.

    Args:
        file: the file, for its coordinates as they are written
        stars: its problem
        fit: the solution of the stars as they are
        axes: how the file's image coordinates were read
        outliers: stars that do not fit the others
        camera: the mistakes of the camera that are tried
    """
    cameras = tried(camera, file, stars, fit, axes)
    others = tried((*IMAGE_MISTAKES, *DIRECTION_MISTAKES), file, stars, fit, axes)
    wrong = tried((star_mistake(outliers),), file, stars, fit, axes)
    best = simplest([*others, *cameras, *wrong])
    if best is None or best not in cameras:
        return best
    several = several_of_camera(file, stars, fit, axes)
    better = several is not None and several.residual**2 * LEAST_GAIN < best.residual**2
    return several if better else best


def several_of_camera(
    file: StarFile, stars: StarField, fit: AttitudeFit, axes: ImageAxes
) -> Explanation | None:
    """Find what is wrong about a camera where no single thing is; arguments as `one_mistake`.

    An ordinary lens is off in its principal point and distorts: either alone, corrected, may
    leave most of the residuals.
    """
    return likeliest(tried(SEVERAL_OF_CAMERA, file, stars, fit, axes), AS_GOOD)


NOTICED = 3.0
"""How many times smaller a camera must make the variance by its derivatives to be solved for.

To be named it must do so `LEAST_GAIN` times."""


def _camera_may_explain(stars: StarField, matrix: Floats, square_mm2: Floats | float) -> Bools:
    """Test whether a camera makes plausible residuals much smaller, without solving for it.

    All of its unknowns together are estimated from their derivatives at the stated camera.

    Args:
        stars: problems, stack (...)
        matrix: their attitudes, (..., 3, 3)
        square_mm2: sums of squares of their residuals, (...)
    """
    return np.asarray(~(least_square(stars, matrix) * NOTICED > square_mm2))


def suspicious_photographs(
    files: Sequence[StarFile],
    fields: Sequence[StarField],
    axes: ImageAxes,
    fitted: Sequence[FittedStars],
) -> list[bool]:
    """Test photographs together: may a mistake make plausible residuals much smaller?

    Nothing is iterated: a mistake of the camera is estimated from its derivatives, others from
    the singular-value solution. Where neither helps, `judge` finds none.
    """
    found = np.array([bool(one.outliers) for one in fitted])
    variance = np.array([one.fit.variance_mm2 for one in fitted])
    square = np.array([one.fit.square_mm2 for one in fitted])
    for indices, stack in StarField.stacks(fields):
        matrix = np.stack([fitted[k].fit.matrix for k in indices])
        found[indices] |= _camera_may_explain(stack, matrix, square[indices])
    corrected = [
        (k, changed.stars)
        for k, (file, stars, one) in enumerate(zip(files, fields, fitted, strict=True))
        if not found[k]
        for mistake in (*IMAGE_MISTAKES, *DIRECTION_MISTAKES)
        for changed, _ in mistake.change(file, stars, axes, one.fit)
    ]
    for indices, stack in StarField.stacks([stars for _, stars in corrected]):
        numbers = np.array([corrected[k][0] for k in indices])
        better = _roughly_mm2(stack) < variance[numbers]
        found[numbers[better]] = True
    return [bool(one) for one in found]


def two_mistakes(
    file: StarFile, stars: StarField, fit: AttitudeFit, axes: ImageAxes
) -> Explanation | None:
    """Find two mistakes that only together explain the residuals; arguments as `one_mistake`."""
    several = several_of_camera(file, stars, fit, axes)
    found = tried(TWO_MISTAKES, file, stars, fit, axes)
    return simplest([*([several] if several else []), *found])


def tried(
    mistakes: tuple[Mistake[Corrected], ...],
    file: StarFile,
    stars: StarField,
    fit: AttitudeFit,
    axes: ImageAxes,
) -> list[Explanation]:
    """Solve a photograph with each mistake corrected; arguments as `one_mistake`."""

    def residual(one: Corrected) -> float:
        """Find the residuals of a corrected photograph; infinite if chance may explain them."""
        if one.fit is None and not _roughly_mm2(one.stars) < fit.variance_mm2:
            return np.inf
        return believed(one.fit or fit_attitude(one.stars), fit, one.stars)

    return explanations(mistakes, residual, file, stars, axes, fit, points=lambda one: one.wrong)


def believed(corrected: AttitudeFit, fit: AttitudeFit, stars: StarField) -> float:
    """Find the residuals without a mistake; infinite unless plausible and smaller than by chance.

    Args:
        corrected: the solution without the mistake
        fit: the solution with it
        stars: the problem without the mistake, for its principal distance
    """
    if not corrected.variance_mm2 * LEAST_GAIN < fit.variance_mm2:
        return np.inf
    if not corrected.variance_mm2 < _largest_mm2(stars):
        return np.inf
    ratio = fit.variance_mm2 / corrected.variance_mm2  # infinite without a solution: no chance
    from scipy.special import fdtrc

    explained = fdtrc(fit.freedom, corrected.freedom, ratio) > CHANCE
    return np.inf if explained else float(np.sqrt(corrected.variance_mm2))


def simplest(found: list[Explanation]) -> Explanation | None:
    """Choose the mistake with the least residuals, one about all stars before one about some.

    Of several that leave the same, to three digits, it is the first.
    """
    return likeliest(
        found, AS_GOOD, order=lambda one: (bool(one.points), float(f"{one.residual:.3g}"))
    )


def _largest_mm2(stars: StarField) -> float:
    """Bound the variance of residuals that readings can have."""
    return (LARGEST_RESIDUAL * float(stars.focal_length_mm[0])) ** 2


def _roughly_mm2(stars: StarField) -> Floats:
    """Estimate variances of residuals by the singular-value solution, without iteration, (...)."""
    matrix, _ = wahba_rotation(stars)
    computed = image_points_mm(transform(matrix, stars.directions), stars.focal_length_mm)
    square = ((stars.image_mm - computed) ** 2).sum(axis=(-2, -1))
    return np.asarray(square / (2 * computed.shape[-2] - 3))
