"""Errata of Rae's report and of its program listings (`vopd errata --program rae`).

Each row has a name, where it stands, what stands there, what this package does
instead, how the error is known, and what it changes in a result. Where the
package keeps what stands there, as the default or by name, the row says so.
"""

from __future__ import annotations

from vopd.errata import Erratum

_TEXT = (
    (
        "eq-2-2",
        "equation 2.2",
        "m12 in the numerator of y",
        "m21, as in eq. 2.4 and subroutine NUMDEN",
        "the second row of M makes y; NUMDEN takes ORMTRX(2,1)",
        "none on the report's numbers: the listing has it right",
    ),
    (
        "eq-3-10",
        "equations 3.10 and 3.11",
        "the unknowns are a column of M, [m11 m21 m31]",
        "the row [m11 m12 m13], as in eq. 3.7",
        "eq. 3.7 and program CHURCH, which calls its result M transpose",
        "taken by the letter, the equations would give the transpose",
    ),
    (
        "weighting-omega-k",
        "section 3.2, the discussion of weights",
        "m31, m32, m33 determine omega and k",
        "omega and phi",
        "eq. 3.5: kappa comes from m21 and m11",
        "wR acts on omega and phi; radial image errors alone reach these two",
    ),
    (
        "eq-3-5",
        "equation 3.5 and the text below it",
        "m12, m13, m22, m23 are to pick the right one of eight combinations",
        "omega = atan2(-m32, m33), phi = arcsin(m31) clipped, kappa = atan2(-m21, m11); "
        "kappa = 0 where phi is +-90",
        "none of the four elements contains cos phi, so that phi and 180 - phi pass alike",
        "the choice is left open between two attitudes",
    ),
    (
        "eq-3-17",
        "equation 3.17",
        "weight wR is infinite for an image at the principal point",
        "an error that says so, by default; with a reading sigma, sigma**2 beside x**2 + y**2",
        "the derivative of R vanishes there, and the first order variance with it",
        "division by zero; an image near the point outweighs all others",
    ),
    (
        "eq-3-20",
        "equation 3.20",
        "the weights 6468 and 6714 for a format of 24 by 36 mm",
        "they belong to 24 by 32 mm; 24 by 36 mm has the ratios 1.131 and 1.201",
        "eqs. 3.15 and 3.16 at the corners; the third ratio, 36.5, is right",
        "none: nothing is computed from them",
    ),
    (
        "section-4-inverse",
        "section 4, last paragraphs",
        "the rotation that carries stars to images is applied to the camera's axes",
        "it is M; the camera's axes take its inverse",
        "eq. 3.1: M [U V W]' = [P Q R]'",
        "rows there mean columns; TWOSTAR's COSXZP, COSYZP, COSZZP are m13, m23, m33",
    ),
    (
        "eq-4-8-sign",
        "text below equation 4.8",
        "the cross product's direction is compared with [CX CY CZ]",
        "compared with the axis, as listing AXIANG does",
        "[CX CY CZ] is the axis times the projection, which may be negative",
        "the angle's sign is wrong for stars more than 90 degrees from the axis",
    ),
    (
        "eq-4-10",
        "equation 4.10",
        "exponent -1/2",
        "+1/2, as the listing has it",
        "the projection of a vector grows with its length",
        "none for unit vectors",
    ),
    (
        "section-5-equation",
        "section 5, below equation 5.1",
        "direction cosines `defined by equations 3.5`",
        "equations 2.5",
        "2.5 defines U, V, W; 3.5 the angles of M",
        "none",
    ),
    (
        "table-6-2",
        "table 6.2, star 3, R",
        "-0.95994801",
        "-0.91402619",
        "P, Q, R must have length 1; row 4 has the same R",
        "none: nothing is computed from it",
    ),
    (
        "table-6-4",
        "table 6.4, Church uniformly weighted, kappa",
        "-0.2318",
        "-0.2315",
        "listing CHURCH gives -.231481; the five other Church values of the table agree",
        "none: nothing is computed from it",
    ),
)

_LISTINGS = (
    (
        "reswts",
        "appendix B, RESWTS",
        "reweighting is switched on: (.003/residual)**2, 3 where this passes 9, 0 below 1E-7 mm",
        "uniform weights by default; these rules to the letter as weights `listed`; Huber's, "
        "with a first pass unweighted and a test of convergence, as `robust`",
        "table 6.4 is the uniform solution",
        "the weights are not monotone, the result depends on the start, and data without "
        "errors have no weight at all: no solution",
    ),
    (
        "rawdat-overwrites",
        "appendix B, RAWDAT",
        "the first data block and the first start angles are overwritten by the second",
        "the data are the caller's",
        "the assignments follow each other",
        "STARS as listed never solves its first block",
    ),
    (
        "rawdat-radian",
        "appendix B, RAWDAT, start value of omega",
        "57.2967700001 degrees in a radian",
        "57.2957795131",
        "the two lines below it",
        "omega starts at 19.99965 in place of 20 degrees; the solution is the same",
    ),
    (
        "stars-four-corrections",
        "appendix B, STARS, DO 990",
        "four corrections; angles and residuals are printed before each, so never after the last",
        "to convergence, 50 corrections at most; exactly N if asked",
        "table 6.4's collinearity row: .0216 and -.0605 come out after three corrections from "
        "many starts (omega 140, phi -10, kappa 45 is one), .0215 and -.0604 at convergence",
        "the last printed digits depend on the start",
    ),
    (
        "stars-behind",
        "appendix B, STARS",
        "the sign of DENOM is not looked at",
        "an error that names the stars behind the camera",
        "the second data block from its start ends with DENOM > 0 for all its stars",
        "an attitude that looks away from its stars is reported as a solution",
    ),
    (
        "dprdms-constants",
        "appendix B, DPRDMS",
        "minutes are multiplied by 2.90888209E-4 and seconds by 4.8481368E-6",
        "both are 60",
        "they are the radians in a minute and a second; the fraction is in degrees",
        "minutes are printed as 0",
    ),
    (
        "dprdms-rrmin",
        "appendix B, DPRDMS",
        "RRMIN is never set",
        "it is the whole minutes",
        "it stands on the right of SEC only",
        "the seconds are whatever the store held",
    ),
    (
        "dprdms-sign",
        "appendix B, DPRDMS",
        "the sign is that of the whole degrees",
        "the sign is written for the whole angle",
        "IDEG is 0 for angles between -1 and 0 degrees",
        "such angles are printed as positive",
    ),
    (
        "church-weights",
        "appendix C, CHURCH",
        "no weights, and alpha, delta, swing only",
        "formula weights (eqs. 3.15 to 3.17) beside uniform; omega, phi, kappa as well",
        "table 6.4 has a weighted row and omega, phi, kappa",
        "the listing cannot have made that row",
    ),
    (
        "truopk-integer",
        "appendix C, TRUOPK",
        "M12, M13, M22, M23 are integers by the implicit rule",
        "taken as numbers in `truopk`",
        "IMPLICIT DOUBLE PRECISION covers A-H and O-Z",
        "called with double precision elements it compares with other bits' meaning",
    ),
    (
        "truopk-t12",
        "appendix C, TRUOPK, third test",
        "T12 stands once for T22",
        "kept in `truopk`; not used elsewhere",
        "the other tests are squares",
        "the test can pass or fail for any m22",
    ),
    (
        "truopk-tolerance",
        "appendix C, TRUOPK",
        "relative tests to .3 percent, divided by the element",
        "kept in `truopk`, which answers NaN where nothing passes; angles come from arc tangents",
        "a Church matrix is less orthogonal than that, and an element may be 0",
        "finds no angles for the Church matrices of table 6.4: it cannot have made the table",
    ),
    (
        "tustar-degrees",
        "appendix D, TUSTAR",
        "DCOS is given omega and alpha in degrees",
        "kept in `tustar` only",
        "OMEGA and ALPHA are multiplied by DEGRAD the line before",
        "on its own error-free data it prints PHI -167.6259 for -18.7472 and DELTA 68.9639 for 60",
    ),
    (
        "tustar-fictitious-star",
        "appendix D, TUSTAR",
        "the cross products are not divided by the sines a and b",
        "unit cross products by default (eqs. 3.21, 3.22); `raw` as listed",
        "the equations divide; the two sines differ where the readings err",
        "stars 1,2 of table 6.3: kappa 46.7869 in place of 46.6756",
    ),
    (
        "testu-pair",
        "appendix D, TESTU",
        "only the pair 1,2 is solved",
        "any pair, or all at once; 1,2 is the default",
        "its one CALL",
        "figures 6.1 to 6.3 need six pairs",
    ),
    (
        "tustar-arccos",
        "appendix D, TUSTAR",
        "arc cosines of scalar products are not clipped",
        "angles by the arc tangent of cross and scalar product",
        "rounding takes the product of a unit vector with itself past 1",
        "small angles lose half their digits, or are no number",
    ),
    (
        "inv3x3-determinant",
        "appendices C and D, INV3X3",
        "the determinant is never tested",
        "stars that coincide or lie on one great circle are refused, to sin 1e-6",
        "their matrix has no inverse",
        "division by zero, or an attitude made of rounding",
    ),
    (
        "twostar-focal-sign",
        "appendix E, XYRDIN",
        "R = +F / distance",
        "R = -f / distance, as eq. 3.2",
        "all other programs and eq. 3.2",
        "the photograph is mirrored, and the attitude another",
    ),
    (
        "rotate-division",
        "appendix E, ROTATE",
        "divides by C, a component of the arm",
        "Rodrigues' formula",
        "eqs. 4.18 and 4.19 are 0/0 where C is 0",
        "no number for some axes",
    ),
    (
        "subcrs-axis-in-plane",
        "appendix E, SUBCRS",
        "no test of how well D1 and D2 determine the axis",
        "sin(D1, D2) with every single rotation: an error below 1e-6, a warning below .2",
        "it is .10 for stars 2,4 of table 6.3, .30 for 1,2 and .71 for 1,3",
        "this, not the choice of star, is why the report finds some pairs poor",
    ),
    (
        "radec2-f15-6",
        "appendix A, RADEC2, FORMAT F15.6",
        "a number typed without a point counts millionths",
        "kept for typed input, with a warning",
        "the rule of the F format",
        "76 is read as .000076",
    ),
    (
        "radec2-range",
        "appendix A, RADEC2",
        "right ascension comes out in -180 to 180",
        "kept",
        "table 6.1 prints -4 25 49.68",
        "none on an attitude",
    ),
)

RAE_ERRATA: tuple[Erratum, ...] = tuple(
    Erratum(name, "rae", where, original, fix, evidence, effect)
    for name, where, original, fix, evidence, effect in _TEXT + _LISTINGS
)
"""All errata: those of the text in the report's order, then those of the listings."""
