"""Every tolerance of the tests: quantity, unit, absolute tolerance, reason."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Tolerance(NamedTuple):
    """How far a number may be from the expected one."""

    unit: str
    absolute: float
    reason: str


TOLERANCES = {
    "angle wrapped 22 times": Tolerance(
        "deg", 1e-10, "sums of 8000 degrees; 22 times the twelfth decimal"
    ),
    "grey of a reduced frame": Tolerance("1", 0.005, "means of 9,000 in 32 bits, 5E-4"),
    "sigma of a place": Tolerance("1", 0.03, "a clock is solved by velocities of a time before"),
    "symmetric stars": Tolerance("1", 1e-7, "deg, mm, seconds of arc; roundings, steps of 1E-8"),
    "symmetric flight": Tolerance(
        "1", 1e-6, "deg, m, px, or a part: solves end at 1E-8 sigma; decimals of a file are 1E-7 m"
    ),
    "velocity of noisy fixes": Tolerance("m/s", 0.1, "fixes of .1 m a second apart, nine of them"),
    "tail of chi-square": Tolerance("1", 0.004, "its first term; the next is 2/1500 of it, twice"),
    "azimuth of whole pixels": Tolerance("deg", 0.04, "half a pixel of a focal length of 1500"),
    "miss on a map": Tolerance("m", 3.0, "places are whole metres, and a miss has three digits"),
    "horizon of a film": Tolerance("deg", 0.005, "three decimals of a mm, of 10.4"),
    "way north": Tolerance(
        "1", 0.03, "two decimals; a lens whose centre is 3 px beside the middle"
    ),
    "true north on a map": Tolerance("deg", 0.01, "the next term of the convergence is .001"),
    "corner on a screen": Tolerance("px", 0.51, "a frame begins at a whole pixel of the screen"),
    "mark on a page": Tolerance("px", 0.35, "a tenth of a screen's pixel, 3.3 of the image"),
    "click on a page": Tolerance("px", 0.05, "what the page promises; two decimals are .005"),
    "rotation on a page": Tolerance("deg", 1e-6, "what the page promises"),
    "direction on a page": Tolerance("1", 1e-7, "a track of a second, linear: 10 um of 300 m"),
    "landmark predicted on a page": Tolerance("px", 1e-5, "1e-8 degree of 1500 px, and rounding"),
    "warp of a patch": Tolerance("px", 2e-5, "the Earth's curvature in 20 m of 1000"),
    "row of a rolling shutter": Tolerance("px", 2e-4, "rows found in two rounds"),
    "place on the grid": Tolerance("m", 5e-4, "4 decimals; 9 of a degree are .1 mm"),
    "ground on a terrain": Tolerance("m", 0.02, "rays end within a hundredth of a metre"),
    "match of a small patch": Tolerance(
        "px", 0.2, "a tenth of how its rim moves; .4 with equal weights"
    ),
    "height of a terrain": Tolerance("m", 1e-3, "heights are kept in 32 bits, 6E-5 m at 1000 m"),
    "turns of 4,000 draws": Tolerance("1", 0.045, "a ratio; four deviations of 1.1 percent"),
    "match of a drawn patch": Tolerance("px", 0.02, "sampled between four pixels"),
    "match of a searched patch": Tolerance("px", 0.5, "whole pixels of a patch half as large"),
    "ratio of sigmas of matches": Tolerance("1", 0.05, "the gain of a noisy frame, 3 percent"),
    "turn by drawn shifts": Tolerance("rad", 2e-6, "the prior of the turn, .03 rad"),
    "turn by whole frames": Tolerance("rad", 1e-4, "a tenth of a pixel"),
    "running attitude": Tolerance(
        "px", 0.2, "1/50 of a degree at this lens; the rates' errors, .1"
    ),
    "attitude under a long readout": Tolerance(
        "deg", 0.3, "rms, of six clicks of half a pixel, .13 degree each, and shake of 4 to 13 Hz"
    ),
    "tracked pick": Tolerance("px", 0.3, "rms, of 10 kB of H.264: 24 frames of 320 x 180"),
    "track of a turned video": Tolerance(
        "px or 1", 3e-4, "four decimals; the same grey levels are summed in another order"
    ),
    "attitude of a turned video": Tolerance(
        "deg", 1e-3, "1E-4 px of 217 is 2.6E-5, seven times that in yaw and roll at 82 of pitch"
    ),
    "frame by its grey level": Tolerance("1", 0.4, "five grey levels a frame; coding moves two"),
    "presentation time": Tolerance("s", 1e-9, "whole milliseconds"),
    "place or time as a file has it": Tolerance("deg, m, s", 1e-9, "written in decimals"),
    "inch of the reader": Tolerance("in", 1e-12, "twelve digits of the scale of the film"),
    "angle from the film reader": Tolerance(
        "deg", 0.01, "readings of .001 in. are .0007 mm of 10.4, .004 degree; four landmarks"
    ),
    "relative, in blocks or not": Tolerance(
        "1", 1e-9, "sums over landmarks in another order, 1E-16 times a condition of 1E4 or less"
    ),
    "start of a kept frame": Tolerance(
        "deg", 1e-10, "the rule: a converged frame is not solved again for less"
    ),
    "vehicle position": Tolerance(
        "ft", 1e-8, "table values of 1E5 ft; the time has 1E-11 s, 500 ft/s"
    ),
    "time": Tolerance("s", 1e-11, "table values of 100 s, a few roundings"),
    "angle from readings": Tolerance(
        "deg",
        2e-5,
        "unit 9 keeps 5E-7 in. of 10 in., 2E-6 degree; roll and yaw at 86 degrees pitch",
    ),
    "residual of readings": Tolerance(
        "mm", 1e-6, "unit 9 keeps 5E-7 in. of 10 in., which is 3.6E-7 mm"
    ),
    "reciprocal of a flattening": Tolerance(
        "1", 1e-9, "twelve digits are printed; for 1866 it follows from radii of ten digits exactly"
    ),
    "radius of an ellipsoid": Tolerance("m", 1e-6, "the polar radii are printed to 1E-6 m"),
    "latitude and back": Tolerance("rad", 1e-14, "a few roundings; 1E-14 is 6E-8 m on the ground"),
    "geocentric latitude": Tolerance(
        "deg", 1e-10, "RAD has ten digits: 2E-10 of 200 degrees, times .19"
    ),
    "airspeed by hand": Tolerance("ft/s", 1e-7, "seven decimals were worked"),
    "airspeed": Tolerance(
        "ft/s", 1e-8, "speeds of 1E3 ft/s by other means; DPR has ten digits, 1E-11"
    ),
    "solved angle": Tolerance("deg", 1e-6, "no noise; the erratum makes the last passes slow"),
    "correction": Tolerance(
        "rad", 1e-9, "below 10 rad, from normal equations of condition below 1E6"
    ),
    "recovered angle": Tolerance(
        "deg", 1e-10, "film of full precision, last corrections below 1E-13 rad"
    ),
    "wrapped angle": Tolerance(
        "deg", 1e-11, "twelve decimals were worked by hand, angles below 400"
    ),
    "angle after 22 passes": Tolerance(
        "deg", 1e-9, "another solver; frames with condition up to 1E3"
    ),
    "normal equation": Tolerance("mm2/rad", 1e-11, "sums of 6 products of 1 mm by 20 mm/rad"),
    "minimiser's angle": Tolerance(
        "deg", 1e-6, "scipy stops where the sum of squares no longer shows a change"
    ),
    "table value": Tolerance("1", 1e-12, "small decimals worked by hand, a few roundings"),
    "inverse element": Tolerance("1", 1e-9, "elements and condition below 1E3"),
    "determinant": Tolerance("1", 1e-9, "up to 1E5, the product of four pivots"),
    "direction cosine": Tolerance("1", 1e-12, "6378 km cancel to 40 km: 160 roundings of 1E-16"),
    "angle of attack by hand": Tolerance("deg", 5e-6, "five decimals were worked"),
    "attitude, noise-free arrays": Tolerance(
        "deg", 1e-6, "RAD and PI have ten digits: 1E-8 degree, and the solve ends far below"
    ),
    "attitude, noise-free deck": Tolerance(
        "deg", 0.003, "readings of .0001 in. are 2E-4 degree, more about the optical axis"
    ),
    "attitude from 120 m": Tolerance(
        "deg", 2e-5, "RAD has ten digits: a hundredth of a millimetre on the ground"
    ),
    "angle of attack from 120 m": Tolerance(
        "deg", 1e-4, "the same, divided by the smallest part of the velocity in a plane"
    ),
    "share of the Earth's cost": Tolerance(
        "1", 0.03, "a ratio; the sphere's scale of .3 per cent, rays up to 30 degrees aslant"
    ),
    "the Earth's cost": Tolerance(
        "deg", 0.008, "angles of .05; film coordinates weigh landmarks otherwise than directions do"
    ),
    "errata page": Tolerance("deg", 6e-4, "two digits of numbers below .07"),
    "radius, km": Tolerance("km", 1e-8, "6378 km by another formula"),
    "latitude, deg": Tolerance("deg", 1e-10, "the same"),
    "residual": Tolerance("mm", 1e-11, "film coordinates of 10 mm"),
    "film length": Tolerance("mm", 1e-12, "lengths below 10 mm, a few roundings"),
    "printed angle": Tolerance("deg", 5.1e-4, "half of the last of three printed decimals"),
    "sigma of printed covariances": Tolerance(
        "deg", 5e-6, "covariances of .25 have seven digits; that of a sigma of .005 is what is left"
    ),
    "printed time": Tolerance("s", 5.1e-4, "half of the last of three printed decimals"),
    "printed feet": Tolerance("ft", 5.1e-3, "half of the last of two printed decimals"),
    "axis by printed angles": Tolerance(
        "1", 2.7e-5, "three angles of half the third decimal, 9E-6 rad each"
    ),
    "direction by printed feet": Tolerance(
        "1", 1e-9, "three times half the second decimal, of 2E7 ft from the Earth's centre"
    ),
    "six decimals": Tolerance("deg", 2e-6, "a root of squares of three numbers of six decimals"),
    "ten decimals": Tolerance("1", 2e-10, "four components of ten decimals"),
    "rae rotation": Tolerance("1", 1e-9, "elements of a matrix, condition below 1E5"),
    "rae rotation by angles": Tolerance("1", 1e-7, "an arc sine near 1 has half the digits"),
    "rae printed angle": Tolerance("deg", 1e-8, "the golden values have ten decimals"),
    "rae printed cosine": Tolerance("1", 0.6e-8, "half a unit of the eighth decimal"),
    "rae RADEC2 angle": Tolerance("deg", 0.6e-8, "half a unit of the eighth decimal"),
    "rae table 6.4": Tolerance("deg", 0.51e-4, "half a unit of the fourth decimal"),
    "rae table 6.4 early": Tolerance("deg", 1.01e-4, "one unit: three corrections, unknown start"),
    "rae element": Tolerance("1", 1e-12, "double precision through a few products"),
    "rae element near a pole": Tolerance("1", 3e-8, "an arc sine near 1 has half the digits"),
    "rae stack element": Tolerance("1", 1e-12, "sums over a longer axis may round otherwise"),
    "rae weight": Tolerance("mm2", 1.0, "the report has whole numbers, one of them cut"),
    "rae angle": Tolerance("deg", 1e-9, "matrices good to 1E-12, an arc tangent"),
    "rae angle of nine digits": Tolerance("deg", 1e-6, "stars of nine digits, arms above .1"),
    "rae outlier chance": Tolerance("1", 0.01, "a ratio; images are not quite linear in turns"),
    "rae figure": Tolerance("deg", 0.51e-7, "half of the last of seven printed decimals"),
    "rae arc cosine": Tolerance("arcsec", 1e-6, "angles above .1 rad by an arc cosine: 1E-15"),
    "rae stated sigma": Tolerance("1", 0.04, "a ratio; a deviation of 4,000 draws has 1.1 percent"),
    "rae stated correlation": Tolerance("1", 0.08, "covariances over deviations of 4,000 draws"),
    "rae interstar sigma": Tolerance("1", 0.15, "a ratio; medians of 100 estimates from 3 angles"),
    "rae method error": Tolerance("1", 0.05, "a ratio; 5,000 draws, and two printed digits"),
    "rae weighted element": Tolerance("1", 1e-9, "scipy ends where a step is 1E-8 of the errors"),
    "rae sigma by scipy": Tolerance("1", 1e-4, "a ratio; scipy's derivatives are differences"),
    "rae three-point position": Tolerance("m", 0.02, "2,500 m; half the digits near a double root"),
    "rae position by a double root": Tolerance(
        "m", 0.15, "root of 2E-16 over a curvature of 4E-6 is 1E-5 of 2,500 m; 500 m aside 5 times"
    ),
    "rae three-point element": Tolerance("1", 1e-5, "the same, over the distance"),
    "rae resection sigma": Tolerance("1", 0.13, "a ratio; a deviation of 300 draws has 4 percent"),
    "rae resection position": Tolerance("m", 1e-3, "scipy ends where a step is 1E-8 of 1,000 m"),
    "rae resection residual": Tolerance("mm", 1e-6, "the same, at a scale of 1/16"),
    "rae coverage of 4,000": Tolerance("1", 0.014, "four deviations of .34 percent"),
    "rae near the equator": Tolerance("1", 0.05, "a ratio; axes turned by 25 degrees"),
    "rae exact camera": Tolerance("px", 1e-5, "3,000 px to the last digits, correlated unknowns"),
    "sigmas of one draw": Tolerance("1", 4.0, "four deviations, of a fixed seed"),
    "sky direction": Tolerance("arcsec", 0.02, "deflection and the Earth's velocity of two codes"),
    "sky horizon": Tolerance("arcsec", 0.5, "rotation of the Earth: UT1 of 2020 predicted or not"),
    "sky moved star": Tolerance("arcsec", 0.02, "29 years of motion, parallax of two codes"),
    "sky precession": Tolerance("deg", 0.01, "precession and nutation to their first term"),
    "catalogue position": Tolerance("deg", 1e-5, "the five decimals that are printed"),
    "catalogue parallax": Tolerance("mas", 0.01, "two printed decimals"),
    "rounded catalogue": Tolerance("arcsec", 1.0, "stars rounded to .1 s of arc, and 1991 to 2000"),
    "coverage of points": Tolerance("1", 0.035, "three deviations, of 200 pairs that go together"),
    "sigma of a point at night": Tolerance("deg", 0.02, ".25 px of 3200, and of an azimuth at 60"),
    "variance of points": Tolerance("1", 0.21, "three deviations of 400 squares, a tenth each way"),
    "coverage of sixty": Tolerance("1", 0.09, "three deviations of 2.8 percent"),
    "squares of sixty": Tolerance("1", 0.35, "a ratio; three deviations of 10.5 percent"),
    "quaternion of ten digits": Tolerance("rad", 1e-9, "ten printed decimals, doubled"),
    "rae arc cosine, rounded stars": Tolerance("arcsec", 1e-3, "cosines of nine digits"),
    "extrapolated table value": Tolerance("1", 1e-9, "values up to 1E5 by a few operations"),
    "demo time": Tolerance("s", 1e-9, "32nds of a second, which five decimals print exactly"),
    "demo position": Tolerance("ft", 5.1e-5, "half of the last of four printed decimals"),
    "demo angle": Tolerance("deg", 1.1e-6, "two angles of six printed decimals"),
    "demo speed": Tolerance("ft/s", 0.1, "positions to .01 ft, rows .16 s apart; 6 ft/s3 between"),
    "demo altitude": Tolerance("ft", 0.051, "one printed decimal; the next order is 1E-5"),
    "film of eight digits": Tolerance(
        "mm", 2e-6, "unit 9 keeps 5E-7 in., 4E-7 mm, of each of 16 coordinates at most"
    ),
    "flight pixel": Tolerance("px", 1e-9, "coordinates of 1E4 px, a few dozen roundings"),
    "flight ray": Tolerance("1", 1e-13, "undone by iteration to the last bits"),
    "flight partial": Tolerance("px/rad", 1e-5, "central differences of 1E-5 rad of 1E3 px"),
    "flight rotation": Tolerance(
        "deg", 1e-9, "residuals of .02 px: scipy's sum of squares shows no smaller turn"
    ),
    "flight Newton step": Tolerance(
        "deg", 1e-9, "what is left to the minimum, by differences in extended precision"
    ),
    "published angle": Tolerance("deg", 6e-4, "matrices of six and angles of three decimals"),
    "published cosine": Tolerance("1", 2e-6, "matrices of six decimals"),
    "flight response": Tolerance(
        "rad", 2e-7, "central differences of .001: third order, refraction by another path"
    ),
    "flight turn": Tolerance("rad", 1e-7, "turns of 1E-4 rad, second order"),
    "turn by a metre": Tolerance(
        "rad/m", 3e-9, "one radius for those of the ellipsoid, .4 percent of 1.6E-7, by tan 60"
    ),
    "flight angle": Tolerance(
        "deg", 2e-6, "files of a micrometre at 300 m and of 1E-9 px; a track's chord"
    ),
    "flight height": Tolerance("m", 0.01, "two decimals were worked by hand"),
    "flight refraction": Tolerance("rad", 1e-12, "an integral good to 1E-11 of 4E-4"),
    "flight direction": Tolerance("1", 1e-10, "6.4E6 m cancel to 90 m"),
    "flight position": Tolerance("m", 1e-4, "four decimals were worked; 6E6 m in between"),
    "curvature": Tolerance("rad", 2e-8, "the meridian's radius changes by 1E-5 over 10 km"),
    "flight time": Tolerance("s", 1e-12, "a few decimals"),
    "flight speed": Tolerance("m/s", 1e-3, "north turns by 1E-5 rad along the track"),
    "angle of six clicks": Tolerance(
        "deg", 0.25, "clicks of .5 px at 520 px of focal length: .055, four times in roll"
    ),
    "rendered pick": Tolerance(
        "px", 2.5, "clicks of .5 px noise each way, 4 standard deviations; a compressed corner"
    ),
    "angle by cards": Tolerance(
        "deg", 5e-4, "readings of 5E-6 in. of 7.5 in. of focal length, 4E-5 degree; roll four times"
    ),
    "angle of a deck's project": Tolerance(
        "deg", 2e-5, "picks of 5E-5 px of 14,000; the deck's RAD and PI have ten digits"
    ),
    "coordinates on cards": Tolerance(
        "min, or 1E4 ft", 5.1e-6, "half of the last of five decimals of a minute, of one of a foot"
    ),
    "feature without noise": Tolerance(
        "ft", 0.5, "minutes of five decimals, .06 ft, of all; twenty times along a line of sight"
    ),
    "times of a deck's project": Tolerance("s", 6e-10, "half of the last of nine decimals"),
    "five decimals": Tolerance("1", 6e-6, "half of the last of five decimals or more"),
    "motion on cards": Tolerance(
        "ft", 2e-3, "tracks have 1E-6 m; north turns by 1E-5 rad along the track, 20 m/s"
    ),
    "wind on cards": Tolerance(
        "ft/s", 1e-2, "heights have 1E-4 m, between levels a metre and 33 ft/s apart"
    ),
    "trial without noise": Tolerance("px", 1e-5, "picks have 1E-9 px, positions 1E-6 m at 300 m"),
    "mount of rounded elements": Tolerance("1", 2e-7, "elements off by 1E-7 each"),
    "semi-axis by a quantile": Tolerance("1", 1e-9, "quantiles are typed in with 15 digits"),
    "cards of a flight": Tolerance("ft", 2e-5, "files have 1E-6 m; nine digits are 1E-6 ft"),
    "lens by table": Tolerance("px", 0.1, "a line between rows 45 px apart: h2 / 8 of .0003 / px"),
    "pick by readings": Tolerance("px", 2e-3, "readings of 5E-6 in., a pixel is .005 in"),
    "published third decimal": Tolerance("deg", 6e-4, "half of the last of three decimals"),
    "four figures of a field": Tolerance("deg", 6e-3, "half of the last of 47.69 degrees"),
    "four decimals": Tolerance("1", 6e-5, "half of the last of four published decimals"),
    "unit rotation": Tolerance("1", 1e-12, "elements of a rotation by angles and back"),
    "convergence of a sphere": Tolerance("deg", 1e-3, "a sphere's for the ellipsoid's, e2 / 4"),
    "convergence of a datum": Tolerance("deg", 4e-3, "a datum is turned by some seconds of arc"),
    "map on a grid": Tolerance("m", 1.0, "a scale of 1 in 2,500, and the curve of a kilometre"),
    "scale of a grid": Tolerance("m", 0.6, "of 50: a polar grid is true 4 degrees away, 1 %"),
    "angle of an example": Tolerance(
        "deg", 0.15, "picks of .3 to .5 px; yaw and roll near straight down, four deviations"
    ),
    "shipped number": Tolerance("1", 1e-6, "pixels of nine and angles of twelve decimals"),
    "height of a pad": Tolerance(
        "m", 1.0, "whole metres, and a parabola of three trials 10 m apart"
    ),
    "height of another level": Tolerance(
        "m", 0.5, "30 picks of .3 px at 300 to 600 m and 1,500 px: .1 m each, and to whole metres"
    ),
    "speed of images": Tolerance(
        "m/s", 2e-3, "heights to .0001 m, images .1 s apart: two of .00005 m over .2 s or .1 s"
    ),
    "noise of 400 fixes": Tolerance(
        "1", 0.25, "a ratio; of three axes, four deviations of 6 percent of noise beside curvature"
    ),
    "sigma beside fixed places": Tolerance(
        "1", 0.3, "of a ratio; a landmark's parts in the focal length and in frames as independent"
    ),
    "errors of held places": Tolerance(
        "1", 1e-3, "of a ratio; differences of a fiftieth of each error, which solves follow bent"
    ),
    "velocity by differences": Tolerance("m/s", 1e-7, "1e-4 s to either side; the path is smooth"),
    "velocity of a manoeuvre": Tolerance(
        "m/s", 0.25, "four standard deviations; plain differences of .1 m over .4 s have .35"
    ),
    "turning rate of shake": Tolerance(
        "rad/s", 2e-4, "17 frames of 7.5 Hz leave 1.2E-4 of .08; the two beside leave .03"
    ),
    "turn of a readout": Tolerance(
        "deg", 2e-3, "two rounds leave a 500th of .9 degree, by rates of frames at the end"
    ),
    "clock offset": Tolerance(
        "s", 0.05, "30 picks of .3 px, .1 m each, of a camera that passes at 20 m/s"
    ),
    "focal length of a mistake": Tolerance(
        "px", 3.0, "30 picks of .3 px up to 900 px off the axis; 1,500 and 1,490 px as one"
    ),
    "mount to the side": Tolerance(
        "deg", 1.0, "a camera 12 degrees down with a roll of 2: its right is so near to level"
    ),
    "fix that is off": Tolerance(
        "m", 0.6, "three sigmas of what six picks of 1 px tell of a frame's place, .2 m"
    ),
    "time of a late fix": Tolerance("s", 0.04, "the same along a track of 10 m/s, twice"),
    "landmark that is off": Tolerance(
        "m", 0.3, "twenty picks of 1 px at 100 to 200 m: .1 m, and what it draws the others by"
    ),
    "pick moved by a shutter": Tolerance(
        "px", 0.01, "rows settle where another round moves them less than a hundredth of .3 px"
    ),
    "residual of noisy picks": Tolerance("px", 1.5, "five sigmas of .3 px"),
    "angle beside a blunder": Tolerance(
        "deg", 0.01, "picks of .01 px, 4E-4 degree; five of six hold each frame, roll worst"
    ),
    "flight robust step": Tolerance("deg", 1e-6, "the same, for a loss with kinks"),
    "residual beside a solve": Tolerance(
        "px", 0.02, "places moved by 2 m at 300 m, and their squares over twice the distance"
    ),
    "dense algebra": Tolerance(
        "1", 1e-8, "sums of 36 squares; passes that end at 1E-4 have the square of it left"
    ),
    "angle with another lens": Tolerance(
        "deg", 2.0, "the picks were made with a lens that differs by some tenths of a degree"
    ),
    "small turn": Tolerance("deg", 2e-5, "a turn of .02 degree; second order, by tan 60 degrees"),
    "small push": Tolerance("deg", 1e-5, "3 of 550 ft/s, .3 degree; third order"),
    "covariance": Tolerance("deg2", 1e-12, "squares of .02"),
    "probability": Tolerance("1", 1e-3, "interpolation of a table of steps of .05"),
    "likelihood": Tolerance("1", 1e-4, "the passes end at a relative change of 1E-4"),
    "sigma by a search": Tolerance(
        "1", 1e-3, "passes end where the variance changes by 1E-4; common errors of 1E4 sigmas"
    ),
    "fit by scipy": Tolerance("rad", 1e-7, "scipy ends where a step is 1E-8; an arc cosine near 1"),
    "chance by readings of nothing": Tolerance(
        "1", 1e-6, "readings of .01 among other errors of 300: 1E-9 of the variance"
    ),
    "chance of an end": Tolerance(
        "1", 6e-4, "of .025: at 8 deviations the formula leaves .01 of one, at a density of .058"
    ),
    "quantile of two decimals": Tolerance("1", 5.1e-3, "half of the last of two printed decimals"),
    "ratio": Tolerance("1", 1e-12, "two ways to the same sums and roots of a few products"),
    "feet": Tolerance("m", 1e-6, "heights in feet are written with nine decimals"),
    "unit element": Tolerance("1", 1e-15, "elements about 1, a few roundings of 1E-16"),
    "axes after passes": Tolerance(
        "1", 1e-14, "six passes, each a product of rotations: some 6 roundings of 1.1E-16 apiece"
    ),
    "number by a power of ten": Tolerance(
        "1", 4e-16, "a ratio: digits times a rounded power of ten, two roundings of 1.1E-16"
    ),
    "mean reading": Tolerance("in", 1e-14, "a mean of a few readings of 10 in., 2E-15 a rounding"),
    "term of the latitude": Tolerance(
        "deg", 2e-9, "7.2222E-7 by a sine worked to three digits, .2929 for .2930"
    ),
    "angle of a matrix": Tolerance("deg", 1e-9, "elements of 1E-16, a degree from the pole"),
    "angle at a pole": Tolerance(
        "deg", 2e-6, "an arc sine near 1 has the root of 2.2E-16, 1.5E-8 rad or 8.5E-7 degree"
    ),
    "angle near a half turn": Tolerance(
        "deg", 1e-6, "scipy takes an arc sine near 1, which has half the digits"
    ),
    "longitude": Tolerance("deg", 1e-8, "RAD has ten digits"),
    "metres of a latitude": Tolerance("m", 3.0, "a degree is 110.9 km to 2 percent, of 134 m"),
    "position, km": Tolerance("km", 0.002, "feet to ten digits, one millionth of a kilometre"),
    "cosine of a small angle": Tolerance("1", 1e-5, "half the square of .2 degree is 6E-6"),
    "angle there and back": Tolerance("deg", 1e-9, "arc sines at pitches up to 80 degrees"),
    "attitude in space": Tolerance("1", 1e-12, "products of matrices from angles in degrees"),
    "derivative by steps": Tolerance("1", 1e-6, "central differences of 1E-4 degree"),
    "ratio by steps": Tolerance("1", 1e-4, "the same, of gains that nearly cancel"),
    "lean of the vertical": Tolerance("deg", 1e-4, "four decimals were worked, for the origin"),
    "latitude on either Earth": Tolerance(
        "deg", 0.002, "44 km up along verticals .1765 degree apart are 134 m, .0012 degree"
    ),
    "metres by a flat step": Tolerance("m", 25.0, "a degree of 110.9 km to 1 percent, of 2.3 km"),
    "attitude, noisy deck": Tolerance(
        "deg",
        0.1,
        "readings of .003 in. are .012 degree, several times more about the optical axis",
    ),
    "angle left open": Tolerance(
        "1", 0.01, "a ratio to the first order: the second one, and eight digits"
    ),
    "counted reading noise": Tolerance(
        "in", 3.2e-4, "36,000 readings tell a deviation of .02 to .4 percent; four times"
    ),
    "noise of a film": Tolerance(
        "in", 4e-4, "16,000 variances tell the root of their median, .02, to .5 percent; four times"
    ),
    "noise with bad readings": Tolerance(
        "in", 1e-3, "one triple in 56 is bad: the root of the median, .02, grows by 1.3 percent"
    ),
    "simulated film": Tolerance(
        "deg", 5e-5, "decks of .01 ft and 1E-5 minute, .06 ft of 1E5; averages of eight digits"
    ),
    "simulated flight": Tolerance(
        "deg", 2e-5, "picks of four decimals, 3E-5 px of 700 px, 2E-6 degree; twice that about axes"
    ),
    "refraction of 40 km": Tolerance(
        "deg", 5e-5, "heights taken to grow evenly: 31 m of 8 km too high, .3 percent of .015"
    ),
    "limit of a share": Tolerance(
        "1", 2e-3, "four decimals were worked; the effective number has two more hits of 104"
    ),
    "cosine of a printed axis": Tolerance(
        "1", 1e-6, "half the squares of .05 degree in azimuth and in elevation"
    ),
    "seven digits": Tolerance("1", 1e-6, "a ratio; half a unit of the seventh digit, 1 of 1E6"),
    "ten digits": Tolerance("1", 1e-9, "a ratio; half a unit of the tenth digit, 1 of 1E9"),
    "ratio of four digits": Tolerance("1", 6e-4, "half a unit of the fourth digit, 1 of 1,000"),
    "ratio of three digits": Tolerance("1", 0.006, "half a unit of the third digit, 1 of 100"),
    "counted sigma": Tolerance("1", 0.10, "a ratio; the documented agreement, with 2,000 draws"),
    "estimated reading sigma": Tolerance(
        "1", 0.07, "a ratio; 2,000 degrees of freedom or more, 1.6 percent; four times"
    ),
    "reading sigma of a short film": Tolerance(
        "1", 0.3, "a ratio; 100 degrees of freedom, 7 percent; the largest of 24, four times"
    ),
    "condition by hand": Tolerance("1", 1e-9, "a ratio; the root of an eigenvalue 400 times less"),
    "condition by turned rays": Tolerance(
        "1", 1e-6, "a ratio; 1E-9 by differences of 1E-6 rad, times a condition of 1E2"
    ),
    "large condition by turned rays": Tolerance(
        "1", 1e-4, "a ratio; 1E-9 by differences of 1E-6 rad, times a condition of 1E4"
    ),
    "minimiser's residual": Tolerance(
        "mm", 1e-6, "scipy stops where the sum of squares no longer shows a change"
    ),
    "exact fit": Tolerance("mm", 1e-6, "two landmarks fit exactly, as far as scipy goes"),
    "drawn residual": Tolerance("um", 1e-9, "the table's numbers, times 1000"),
    "drawn angle": Tolerance("deg", 1e-9, "angles of 360 degrees unwrapped by whole turns"),
    "reported residual": Tolerance(
        "um", 0.02, "two coordinates of five decimals of a mm, printed to .01"
    ),
    "rae angle of seven decimals": Tolerance(
        "deg", 2e-6, "right ascensions of seven decimals of an hour are 7.5E-7 degree"
    ),
    "rae angle of seven digits": Tolerance(
        "deg", 0.6e-7, "seven printed decimals, one of them cut and not rounded"
    ),
    "rae principal distance": Tolerance(
        "mm", 0.1, "readings of .005 mm 15 mm off are .03 mm of 76"
    ),
    "rae advised point": Tolerance("mm", 5.1e-3, "four printed digits of 18 mm"),
    "rae advised pixel": Tolerance("px", 5.1e-3, "six printed digits of 3,000 px"),
    "rae advised pixel by stars": Tolerance(
        "px", 3.6, "three of the 1.2 px to which 30 stars read to .1 px hold the point"
    ),
    "rae fisheye": Tolerance("px", 9.0, "a radian of 640 px by whole degrees of 74"),
    "rae advised k1": Tolerance("1", 5e-3, "readings of 1 px over .05 r**3 of 20 px, 12 stars"),
    "rae sum of seconds": Tolerance("arcsec", 1e-9, "sums of three of 1E3 seconds, 1E-13 each"),
    "rae defect": Tolerance("1", 1e-14, "products of elements below 1, nine sums of three"),
    "rae root mean square": Tolerance("mm", 1e-15, "eight squares of residuals of .1 mm"),
    "rae cosine of nine digits": Tolerance("1", 0.6e-9, "half a unit of the ninth decimal"),
    "rae axis by seven decimals": Tolerance(
        "deg", 1e-7, "three angles of half the seventh decimal"
    ),
    "rae mean angle": Tolerance(
        "deg", 1e-5, "means of directions and of angles differ in the third order of .01 rad"
    ),
    "rae weight by differences": Tolerance(
        "1", 1e-8, "a ratio; differences of 1E-4 mm, of 1E-6 in a cosine, have 1E-10"
    ),
    "rae sigma by differences": Tolerance(
        "1", 1e-6, "a ratio; 1E-9 by differences of 1E-6 rad, times a condition of 1E2"
    ),
    "rae ground photograph": Tolerance(
        "deg", 5e-4, "images of a micrometre, 4E-4 degree of 152 mm"
    ),
    "rae printed milliseconds": Tolerance("arcsec", 5.1e-4, "half of the last of three decimals"),
    "rae half turn": Tolerance(
        "deg", 0.2, "the mean of 179.9 and 180.1, which is not weighed alike"
    ),
    "rae star that is still": Tolerance("1", 1e-6, "the rule: a star that moves less is still"),
    "rae camera of few stars": Tolerance("px", 3.0, "14 readings of .05 px, 240 px off .6 of them"),
    "difference of card times": Tolerance("s", 1.1e-4, "two times of four decimals"),
    "distortion on cards": Tolerance("um", 0.0501, "half of the last of one decimal"),
    "wind in whole feet": Tolerance("ft/s", 0.501, "half of a foot per second"),
    "reading of large noise": Tolerance("in", 0.06, "six standard deviations of .01, 72 readings"),
    "position of a program": Tolerance("km", 1e-5, "6378 km by RAD of ten digits, 1 cm"),
    "rae printed hundredths": Tolerance("arcsec", 5.01e-3, "half of the last of two decimals"),
    "banded inverse": Tolerance(
        "1", 1e-12, "elements up to 1, condition below 1E3 of a matrix that is the unit and more"
    ),
    "banded log determinant": Tolerance("1", 1e-10, "sums of up to 300 logarithms below 5"),
    "direction by place": Tolerance("1", 1e-5, "a thousandth of the distance to either side"),
    "direction by height": Tolerance("1/m", 1e-13, "1E-16 of a direction over 16 m, 1E-6 of it"),
    "direction by refraction": Tolerance("rad", 1e-7, "turned by .0013 rad to either side"),
    "rod's turn": Tolerance("1", 2e-6, "half of .13 times 100 m of 6371 km, 1E-6"),
    "vertical by place": Tolerance("rad/m", 1e-14, "axes rounded at 1E-16, over 200 m"),
    "image by a parameter": Tolerance("1", 1e-6, "of the largest; differences of pixels of 1E3"),
    "row by an unknown": Tolerance("1", 3e-7, "of the largest; differences of pixels, 1E-13 each"),
    "row by readout": Tolerance(
        "1", 1e-5, "the vertical is that of the frame's place; the derivative's that of the row's"
    ),
    "joint algebra": Tolerance("1", 1e-9, "of the largest; scaled equations of condition 1E5"),
    "updated prediction": Tolerance(
        "px", 0.05, "second order of a step of .1 degree, places of 2 m"
    ),
    "updated gain": Tolerance("1", 0.2, "second order of a step, of gains to 15"),
    "squares of thirty flights": Tolerance(
        "1", 0.45, "one flight has .8, as few clicks turn all of it; three deviations"
    ),
    "shift of the picture": Tolerance("px", 3.0, "left out are the picks it moves most, of 8 px"),
    "sigma of a match": Tolerance("px", 0.005, "3 times 300 degrees of freedom, 2.5 deviations"),
    "joint minimum": Tolerance("sigma", 1e-7, "the solve ends at steps of 1E-8 sigma"),
    "joint cost": Tolerance("1", 1e-8, "sums of squares of 100, residuals to 1E-10"),
    "joint residual": Tolerance("1", 1e-7, "residuals of 3 by marginal weights of condition 1E6"),
    "joint log determinant": Tolerance("1", 1e-9, "sums of some 60 logarithms, condition 1E6"),
    "propagated by solving anew": Tolerance(
        "1", 0.02, "a change of one standard deviation is linear to 1 in 100"
    ),
    "residual as solved": Tolerance(
        "px", 1e-3, "sums of 192 residuals; the lines of sight are traced anew, to 1E-6 px"
    ),
    "dense minimum": Tolerance("sigma", 1e-6, "of all unknowns at once, 1e-8 is usual"),
    "sigma by differences": Tolerance("sigma", 1e-6, "slopes by differences over .01 sigma"),
    "solve of a micrometre": Tolerance("1", 1e-9, "a micrometre of 100 m, and rounding"),
    "reading sigma of two starts": Tolerance("px", 0.01, "a prior of 300 m pulls the place"),
    "two starts": Tolerance("sigma", 0.02, "a prior of 100 m pulls; known to decimetres"),
    "place of a solve": Tolerance("m", 1e-6, "6.4E6 m from the Earth's centre; a metre or two"),
    "reading sigma by rounds": Tolerance(
        "px", 4e-3, "rounds end where it changes by a thousandth of 2 px, from either side"
    ),
    "rotation by another reading sigma": Tolerance(
        "1", 1e-4, "a thousandth more of the sigma moves places by a thousandth of some decimetres"
    ),
    "exact coordinate": Tolerance("m", 1e-6, "its prior is a ten-thousandth of 1 mm"),
    "a hundredth of a millimetre": Tolerance("1", 1e-7, "of 2 m, squared, and rounding"),
    "same solve": Tolerance("1", 1e-8, "the solve ends at steps of 1E-8 sigma"),
    "wide prior": Tolerance("1", 1e-9, "variances of 1E12 in place of infinite ones"),
    "mean by a turn": Tolerance("1", 1e-6, "differences over .002 rad of turns of 1E-13"),
    "direction but for refraction": Tolerance("deg", 3e-4, "of landmarks some hundred metres away"),
    "direction by differences": Tolerance(
        "1", 2e-3, "of a sigma; differences over a tenth of it, the reading sigma to .1 %"
    ),
    "covariance of a mean": Tolerance("deg2", 1e-13, "variances of 1E-4 or less, a few roundings"),
    "half-width of a mean": Tolerance("1", 1e-9, "quantiles of another library"),
    "mean of one frame": Tolerance("1", 1e-6, "of its covariance; the reading sigma to .1 %"),
    "mean of propagated turns": Tolerance("1", 3e-3, "axes of frames .1 degree from the mean's"),
    "mean of one frame, deg": Tolerance("deg", 1e-9, "rotations of 1E-16, by their angles"),
    "gimbal digits": Tolerance("deg", 6e-3, "two digits of each angle in a tag, mean of five"),
    "mount": Tolerance("deg", 1e-3, "the camera's own error beside .3 degree of the vehicle's"),
    "part of a sigma": Tolerance(
        "1", 0.01, "an adjusted project gives the joint solution's angles and sigmas to that"
    ),
    "moved position": Tolerance("m", 1e-6, "six decimals are written; 6E6 m in between"),
    "ratio of positions": Tolerance("1", 1e-6, "an eigenvalue of scipy's; near 1 to 1E-7"),
    "degrees of freedom": Tolerance("1", 1e-8, "sums of 60 shares of condition 1E6"),
    "approved deg": Tolerance(
        "deg", 1e-7, "solves end at 1E-8 deg or below; matrices of condition up to 1E4"
    ),
    "approved deg2": Tolerance("deg2", 1e-7, "variances up to 300, to nine digits"),
    "approved rad": Tolerance("rad", 1e-9, "the same, in radians"),
    "approved last_correction_rad": Tolerance(
        "rad", 1e-7, "far below 1E-6, where a frame has converged: rounding alone"
    ),
    "approved ft": Tolerance("ft", 1e-6, "2E7 ft from the Earth's centre, 4E-9 ft a rounding"),
    "approved m": Tolerance("m", 1e-6, "6.4E6 m from the Earth's centre, 1E-9 m a rounding"),
    "approved ft/s": Tolerance("ft/s", 1e-6, "600 ft/s of positions in tables, by their digits"),
    "approved m/s": Tolerance("m/s", 1e-7, "1E-9 m of 6.4E6 m, twice, over .1 s"),
    "approved px": Tolerance("px", 1e-6, "pixels of 1E4 by angles good to 1E-10"),
    "approved mm": Tolerance("mm", 1e-8, "film coordinates of 10 mm by angles good to 1E-10"),
    "approved s": Tolerance("s", 1e-9, "times of 1E5 s, 1E-11 s a rounding"),
    "approved arcsec": Tolerance("arcsec", 1e-6, "sigmas of 1E3 arcsec to nine digits"),
    "approved arcsec2": Tolerance("arcsec2", 1e-3, "squares of sigmas of 1E3 arcsec, the same"),
    "approved iterations": Tolerance(
        "1", 2, "solves that end at rounding take a pass more or less, by the processor"
    ),
    "approved chance": Tolerance("1", 1e-6, "of a sum of squares good to seven digits"),
    "approved number": Tolerance(
        "1", 1e-7, "ratios, cosines; translations of 10: sines of other processors move them 1E-8"
    ),
}
"""By name; the unit is that of the number compared."""


def within(name: str) -> float:
    """The absolute tolerance of that name."""
    return TOLERANCES[name].absolute


def assert_close(quantity: str, actual: ArrayLike, expected: ArrayLike) -> None:
    """Fail unless every element is as near as the table asks; NaN equals NaN."""
    np.testing.assert_allclose(
        actual,
        expected,
        rtol=0,
        atol=within(quantity),
        err_msg=f"{quantity} ({TOLERANCES[quantity].unit})",
    )
