"""Pages by fortranformat: the WRITE statements of the listing in their order (A 132 to A 448).

The FORMATs are typed from the report, as its printed pages prove them; nothing of
`vopd.listing` is used. fortranformat is the authority for columns, rounding
and asterisks, but for

- the zero before a decimal point, which the printer of 1974 did not print;
- exact ties, which it rounds away from zero and C's printf to the even digit;
- minus zero, whose sign it drops;
- NaN and infinities, which it does not take.
"""

from __future__ import annotations

from functools import cache

from fortranformat import FortranRecordWriter

from vopd.results import Outcome, Results

HEADINGS = {
    89: " L-MARK LONGITUDE  LAT-GOCN RAD ER KM  LAT-GODT  ALTITUDE-FT    XLAM       XMU       XNU",
    92: "0VEHICLE        X         Y         Z     XPC       YPC      CC",
    95: "0 L-MARK  XCO FINAL     YCO FINAL",
    96: "0L-MARK        X              Y           R DIST         DELTA R",
    98: "0 FRAME   TIME     SIG1     SIG2     SIG3     XP     YP        PSI      THETA      PHI"
    "   ALPHA    BETA     ETA",
    100: "0 RESIDUALS  RX(I)           RY(I)        L-MARK",
}
FORMATS = {
    88: "(6X,5HFRAME,I4,26HIGNORED BY USERS DIRECTION)",
    90: "(I5,2X,26HIGNORED BY USERS DIRECTION)",
    91: "(I5,2X,2F10.5,F10.3,F10.5,F11.3,3F10.7)",
    93: "(7X,3F10.2,3F10.5)",
    94: "(I4,2F15.8)",
    97: "(1H ,I3,4F15.5)",
    99: "(I5,4F9.3,2F7.3,2F11.3,F9.3,3F8.3)",
    101: "(2X,2F16.8,I10)",
    102: "(1P2E21.8)",
    104: "(1H0,8X,31HSTANDARD DEVIATION OF RESIDUALS,F13.5)",
}


@cache
def writer(text: str) -> FortranRecordWriter:
    return FortranRecordWriter(text)


def no_leading_zeros(line: str) -> str:
    """A zero before the point gives its place to what stands before it."""
    for k in range(1, len(line) - 1):
        if line[k : k + 2] == "0." and line[k - 1] in " -":
            line = line[: k - 1] + " " + line[k - 1] + line[k + 1 :]
    return line


def write(number: int, *values: object) -> str:
    plain = [value.item() if hasattr(value, "item") else value for value in values]
    line = writer(FORMATS[number]).write(plain)
    return (line if number == 102 else no_leading_zeros(line)) + "\n"


def page(r: Results, f: int) -> str:
    """The page of frame `f`, to the end that its outcome gives it."""
    if r.outcome[f] == Outcome.DROPPED:
        return "\n\n\n" + write(88, r.frame[f])
    used = [k for k in range(r.used.shape[1]) if r.used[f, k]]
    text = r.job.title + "\n\n" + HEADINGS[89] + "\n"
    text += "".join(write(90, r.landmark[f, k]) for k in range(r.used.shape[1]) if r.ignored[f, k])
    for k in used:
        text += write(
            91, r.landmark[f, k], r.longitude_deg[f, k], r.geocentric_latitude_deg[f, k],
            r.radius_kft[f, k], r.latitude_deg[f, k], r.altitude_ft[f, k], *r.direction[f, k],
        )  # fmt: skip
    text += HEADINGS[92] + "\n"
    text += write(93, *r.vehicle_ft[f], *r.centre_in[f], r.job.camera.focal_length_mm)
    text += HEADINGS[95] + "\n"
    text += "".join(write(94, r.landmark[f, k], *r.point_in[f, k]) for k in used)
    if r.outcome[f] != Outcome.EXACT:
        text += HEADINGS[96] + "\n"
        for k in used:
            text += write(
                97, r.landmark[f, k], *r.point_mm[f, k], r.radius_mm[f, k], r.distortion_mm[f, k]
            )
        text += HEADINGS[98] + "\n"
        text += write(
            99, r.frame[f], r.time_s[f], *r.camera_deg[f], *r.centre_mm[f], *r.vehicle_deg[f],
            r.alpha_deg[f], r.beta_deg[f], r.eta_deg[f],
        )  # fmt: skip
        text += HEADINGS[100] + "\n"
        text += "".join(write(101, *r.residual_mm[f, k], r.landmark[f, k]) for k in used)
    if r.outcome[f] in (Outcome.EXACT, Outcome.EXACT_LATE):
        text += "".join("\n\n" + write(102, *r.residual_mm[f, k]) for k in used)
        return text + "\n\n\n END OF JOB\n"
    return text + write(104, r.residual_deviation_mm[f])
