"""The programs' known slips as data, and which of them a run corrects."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from vopd.findings import VopdError
from vopd.geometry.ellipsoid import ELLIPSOIDS, WGS84, Ellipsoid


@dataclass(frozen=True)
class Erratum:
    """One slip of an original program or report.

    `name` is what a command line calls it; `where` is the place in the source;
    `slip` what stands there, `remedy` what should; `evidence` how it is known;
    `effect` what it does to a result.
    """

    name: str
    program: str
    where: str
    slip: str
    remedy: str
    evidence: str
    effect: str


def _vopd(name: str, where: str, slip: str, remedy: str, evidence: str, effect: str) -> Erratum:
    return Erratum(name, "vopd", where, slip, remedy, evidence, effect)


VOPD_ERRATA = (
    _vopd(
        "latitude-series",
        "A 195 and A 196, the landmarks' geocentric latitude",
        "+ .0000325861111111 sin 4PHI: one zero too many",
        "+ .0003258611111111 sin 4PHI, as for the origin (A 55) and in Appendix A (1.1731 seconds)",
        "Appendix H prints LAT-GOCN 32.66227 for 32.83833; the right series gives 32.66249",
        "landmarks stand up to 33 m off: .02 degree, .4 in yaw and roll looking straight down",
    ),
    _vopd(
        "first-landmark",
        "A 394, the partials for sigma 2",
        "HM1 = XLAM(J)*SALPHA + XMU(1)*CALPHA: XMU of the frame's first landmark for all",
        "XMU(J)",
        "case 4, frame 60 prints SIG1 225.133; with XMU(J) it is 225.120",
        "the solve converges slowly, and up to .02 degree beside the least squares",
    ),
    _vopd(
        "restart",
        "A 452 to A 454, the start of the next frame",
        "angles in degrees compared with TWOPI and PI, which are radians",
        "compare with 360 and 180 degrees: every frame starts from the one before",
        "the listing against its text; no printed frame depends on it",
        "none where all converge; a frame far from group 8's estimate may not",
    ),
    _vopd(
        "earth",
        "A 168 to A 199 and TGTCAM",
        "one Earth radius for every landmark, a spherical vertical for origin and camera",
        "an ellipsoid: geodetic heights, east, north and up by the geodetic vertical",
        "by construction; Appendix H prints one RAD ER KM for landmarks at different latitudes",
        "the vertical is .18 degree off at 33 degrees north; .05 to .07 degree in Appendix H",
    ),
    _vopd(
        "sin-6phi",
        "A 56 and A 196, geodetic to geocentric latitude",
        "+ 7.2222222222E-07 sin 6PHI",
        "- 7.2222222222E-07 sin 6PHI; Appendix A has - 0.0025 seconds",
        "the listing against Appendix A and the series of the ellipsoid",
        "16 cm on the ground at most; below .0001 degree",
    ),
    _vopd(
        "feet-per-km",
        "A 22, DATA VFTPKM = .0003048006",
        "the vehicle's feet become kilometres by a factor that is not 1/FTPKM",
        "1/3280.8336, the factor of every other foot",
        "the printed digits of Appendix H need both factors",
        "5e-8 of the distance from the origin, 2 mm in 40 km; below .00002 degree",
    ),
    _vopd(
        "eight-digits",
        "A 470.1, FORMAT 87 of unit 9",
        "averages of readings pass through a file that keeps eight significant digits",
        "the averages as computed",
        "Appendix H prints XCO 10.17533300 for 10.1753333...",
        "1e-7 mm in the residuals, below .00001 degree",
    ),
    _vopd(
        "standard-deviation",
        "A 447, SUM = SQRT(SUM/TWON)",
        "the sum of squares over 2N observations",
        "over 2N - 3: three angles have been fitted",
        "the printed values are roots of the mean over 2N",
        "no angle; too small by the root of 2N/(2N - 3), half for two landmarks",
    ),
)
"""Program VOPD's slips in the order of their weight (TM X-3050, Appendix B)."""


class Fix(Enum):
    """One correction that a run can make: that of the erratum of the same name."""

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
    """Which errata of program VOPD a run corrects; none by default, which is the original.

    Args:
        chosen: members of `Fix`
        ellipsoid: the Earth under `Fix.EARTH`

    Raises `VopdError` where `chosen` has anything that is no `Fix`.
    """

    chosen: frozenset[Fix] = frozenset()
    ellipsoid: Ellipsoid = WGS84

    def __post_init__(self) -> None:
        for fix in self.chosen:
            if not isinstance(fix, Fix):
                raise VopdError(f"{fix!r} is no Fix: make fixes of names with vopd.errata.fixes()")

    def __contains__(self, fix: Fix) -> bool:
        return fix in self.chosen

    def __bool__(self) -> bool:
        return bool(self.chosen)

    def __str__(self) -> str:
        """The fixes for a reader, in the order of the errata: `earth (WGS 84), restart`."""
        names = {Fix.EARTH: f"earth ({self.ellipsoid.label})"}
        return ", ".join(names.get(fix, fix.value) for fix in Fix if fix in self.chosen)


NO_FIXES = Fixes()


def fixes(*names: str, ellipsoid: str = "wgs84") -> Fixes:
    """The fixes of these names.

    Args:
        names: names of errata as `vopd errata` lists them, or `all`
        ellipsoid: a name of `vopd.geometry.ellipsoid.ELLIPSOIDS`, the Earth under `earth`

    Raises `VopdError` for a name that is not known.
    """
    known = {fix.value: fix for fix in Fix}
    for name in sorted(set(names) - {*known, "all"}):
        raise VopdError(f"no fix is called {name!r}; there are: {', '.join(sorted(known))}, all")
    if ellipsoid not in ELLIPSOIDS:
        raise VopdError(f"no ellipsoid is called {ellipsoid!r}; there are: {', '.join(ELLIPSOIDS)}")
    chosen = set(Fix) if "all" in names else {known[name] for name in names}
    return Fixes(frozenset(chosen), ELLIPSOIDS[ellipsoid])
