"""The known errata of the original programs, and which of them a run corrects."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from vopd.findings import VopdError, refuse_other_kind
from vopd.geometry.ellipsoids import ELLIPSOIDS, WGS84, Ellipsoid


class Erratum(NamedTuple):
    """An erratum: something that an original program or report has wrong.

    Args:
        name: name of the erratum on the command line
        program: `vopd` (TM X-3050) or `rae` (Rae, 1987)
        where: cards of the listing, equation or table
        original: what the original has there
        fix: what it should have
        evidence: how that is known
        effect: how much it changes a result
    """

    name: str
    program: str
    where: str
    original: str
    fix: str
    evidence: str
    effect: str


def _vopd(name: str, where: str, original: str, fix: str, evidence: str, effect: str) -> Erratum:
    """Describe an erratum of program VOPD."""
    return Erratum(name, "vopd", where, original, fix, evidence, effect)


VOPD_ERRATA = (
    _vopd(
        "latitude-series",
        "A 195, the landmarks' geocentric latitude",
        "+ .0000325861111111 sin 4PHI: one zero too many",
        "+ .0003258611111111 sin 4PHI, as for the origin (A 56) and in Appendix A (1.1731 seconds)",
        "Appendix H prints LAT-GOCN 32.66227 for 32.83833; the correct series gives 32.66249",
        "landmarks are up to 33 m from their true position: .02 degree in the angles, and .4 "
        "degree in yaw and roll of a camera that looks straight down",
    ),
    _vopd(
        "first-landmark",
        "A 394, the partials for sigma 2",
        "HM1 = XLAM(J)*SALPHA + XMU(1)*CALPHA: XMU of the frame's first landmark is used for all",
        "XMU(J), of the landmark itself",
        "case 4, frame 60 prints SIG1 225.133; with XMU(J) it is 225.120",
        "the solve converges slowly, to angles up to .02 degree from the least-squares solution",
    ),
    _vopd(
        "restart",
        "A 452 to A 454, the start of the next frame",
        "angles in degrees are compared with TWOPI and PI, which are radians",
        "comparison with 360 and 180 degrees: every frame starts from the angles of the one before",
        "the listing differs from the report's text; no printed frame depends on it",
        "none where all frames converge; frames far from group 8's first estimate may not",
    ),
    _vopd(
        "earth",
        "A 49 to A 61, A 186 to A 199 and TGTCAM",
        "one Earth radius for every landmark, and a spherical vertical for origin and camera",
        "an ellipsoid: heights are geodetic, and up is along the geodetic vertical",
        "a sphere is an approximation; Appendix H prints one RAD ER KM for several latitudes",
        "the vertical is wrong by .18 degree at 33 degrees north; angles by .05 to .07 degree in "
        "Appendix H",
    ),
    _vopd(
        "sin-6phi",
        "A 56, A 57, A 195 and A 196, geodetic to geocentric latitude",
        "+ 7.2222222222E-07 sin 6PHI",
        "- 7.2222222222E-07 sin 6PHI; Appendix A has - 0.0025 seconds",
        "Appendix A and the series for an ellipsoid have the other sign",
        "16 cm on the ground at most; angles change by less than .0001 degree",
    ),
    _vopd(
        "feet-per-km",
        "A 22, DATA VFTPKM = .0003048006",
        "the vehicle's position is converted to kilometres by a factor that is not 1/FTPKM",
        "1/3280.8336, as for every other length in feet",
        "the printed digits of Appendix H come out only with both factors",
        "5e-8 of the distance from the origin, 2 mm in 40 km; less than .00002 degree",
    ),
    _vopd(
        "eight-digits",
        "A 471, FORMAT 87 of unit 9",
        "averages of readings pass through a file that keeps eight significant digits",
        "the averages as computed",
        "Appendix H prints XCO 10.17533300 for 10.1753333...",
        "residuals change by 1e-7 mm, angles by less than .00001 degree",
    ),
    _vopd(
        "standard-deviation",
        "A 447, SUM = SQRT(SUM/TWON)",
        "the sum of squares is divided by the 2N observations",
        "divided by 2N - 3, because three angles have been fitted",
        "the printed values are square roots of means over 2N",
        "no angle changes; the printed value is too small by the square root of 2N/(2N - 3), a "
        "factor of 2 for two landmarks",
    ),
)
"""The errata of program VOPD, the largest effect first (TM X-3050, Appendix B)."""


class Fix(Enum):
    """A fix that a run can apply: that of the erratum of the same name."""

    LATITUDE_SERIES = "latitude-series"
    FIRST_LANDMARK = "first-landmark"
    RESTART = "restart"
    EARTH = "earth"
    SIN_6PHI = "sin-6phi"
    FEET_PER_KM = "feet-per-km"
    EIGHT_DIGITS = "eight-digits"
    STANDARD_DEVIATION = "standard-deviation"


@dataclass(frozen=True)
class Fixes:
    """The fixes that a run applies; by default none, which reproduces the original program.

    Args:
        chosen: members of `Fix`
        ellipsoid: the figure of the Earth that `Fix.EARTH` uses

    Raises:
        VopdError: if `chosen` has anything that is not a member of `Fix`.
    """

    chosen: frozenset[Fix] = frozenset()
    ellipsoid: Ellipsoid = WGS84

    def __post_init__(self) -> None:
        for fix in self.chosen:
            if not isinstance(fix, Fix):
                raise VopdError(f"{fix!r} is not a Fix: vopd.errata.fixes() makes them from names")

    def __contains__(self, fix: Fix) -> bool:
        return fix in self.chosen

    def __bool__(self) -> bool:
        return bool(self.chosen)

    def __str__(self) -> str:
        """List the names of the fixes in the order of the errata: `restart, earth (WGS 84)`."""
        names = {Fix.EARTH: f"earth ({self.ellipsoid.label})"}
        return ", ".join(names.get(fix, fix.value) for fix in Fix if fix in self.chosen)


NO_FIXES = Fixes()  # the original program, with all its errata


def fixes(*names: str, ellipsoid: str = "wgs84") -> Fixes:
    """Make fixes from their names.

    Args:
        names: names of errata as `vopd errata` lists them, or `all`
        ellipsoid: figure of the Earth that the fix `earth` uses, a name in
            `vopd.geometry.earth.ELLIPSOIDS`

    Returns:
        The fixes, for `vopd.run`.

    Raises:
        VopdError: if a name is not known.
    """
    known = {fix.value: fix for fix in Fix}
    for one in names:
        refuse_other_kind(one, str, "vopd.errata.fixes", "names, each by itself")
    for name in sorted(set(names) - {*known, "all"}):
        raise VopdError(f"no fix is called {name!r}; there are: {', '.join(sorted(known))}, all")
    if ellipsoid not in ELLIPSOIDS:
        raise VopdError(f"no ellipsoid is called {ellipsoid!r}; there are: {', '.join(ELLIPSOIDS)}")
    chosen = set(Fix) if "all" in names else {known[name] for name in names}
    return Fixes(frozenset(chosen), ELLIPSOIDS[ellipsoid])
