"""Solutions as text: attitudes, details of a single one, disagreements of stars."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import stdtrit

from vopd.findings import count_text, size_text
from vopd.geometry.sexagesimal import format_dms
from vopd.screen import aligned
from vopd.stellar.angles import ARCSEC
from vopd.stellar.files.images import image_edges
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.interstar_angles import star_disagreement_arcsec
from vopd.stellar.listed import LISTED_CORRECTIONS, stars_printout
from vopd.stellar.methods.run import ANGLE_NAMES, REDUCED_WEIGHT, SolvedStars
from vopd.stellar.sky import OF_PLACE, OF_VEHICLE, moment_text

_Column = tuple[str, Sequence[float | None], str, int]  # title, values, format, width

MOVED = "the last correction still moved an image"
ROUNDING = 1e-9  # orthogonality defect that rounding alone may make


def as_text(
    photographs: Sequence[SolvedPhotograph],
    *,
    robust: bool = False,
    size_px: Sequence[float] | None = None,
) -> str:
    """Format solutions as text for people.

    Returns:
        Where the cameras point, why that is doubtful, and a table of the attitudes; of a single one
        its residuals and matrix too; of all pairs each star's disagreement with the others.
    """
    rows = [(photograph, one) for photograph in photographs for one in photograph.solved]
    pages = []
    if len(rows) == 1:
        photograph, one = rows[0]
        residuals, table = _residuals(one, photograph.file, robust=robust), _table(rows)
        if photograph.epoch:
            pages += [_answer(photograph, one, size_px), residuals, table]
        else:
            pages += [table, residuals]
        pages.append(_details(one, photograph.file))
    elif rows:
        pages += [_directions([row for row in rows if row[0].epoch])]
        pages += [_horizon(rows, OF_PLACE), _horizon(rows, OF_VEHICLE), _table(rows)]
        pages = [page for page in pages if page]
    if any(one.points for _, one in rows):
        pages.insert(1, _points([row for row in rows if row[1].points]))
    if doubts := [
        f"doubtful: {one.label}: {text}\n" if one.label else f"doubtful: {text}\n"
        for one in photographs
        for text in one.doubts
        if one.solved
    ]:
        pages.insert(1, "".join(doubts))
    if len(rows) > 1 and rows[0][1].camera is not None:
        pages += _cameras(rows)
    if len(rows) > 1 and any("azimuth_deg" in (one.sky or {}) for _, one in rows):
        pages.append(f"{EXACT_SKY}\n")
    dates: dict[str, dict[str, None]] = {}  # those that differ by their dates alone are one
    for photograph in photographs:
        if photograph.epoch and photograph.solved:
            epoch, undated = photograph.epoch, photograph.epoch
            if photograph.utc:
                undated = epoch.replace(moment_text(photograph.utc), "the date of each photograph")
            dates.setdefault(undated, {})[epoch] = None
    if dates:
        epochs = [undated if len(of) > 1 else next(iter(of)) for undated, of in dates.items()]
        pages.append("".join(f"right ascension and declination: {epoch}\n" for epoch in epochs))
    for photograph in photographs:
        if any(one.disagreement_arcsec is not None for one in photograph.solved):
            pages.append(_disagreements(photograph))
    return "\n".join(pages)


WHOLE_TURN = 360.0  # degrees
HALF_WIDTHS = "+- is half of the 95 % interval"


def half_widths(sigmas_deg: Sequence[float] | None, freedom: float | None) -> list[float | None]:
    """Halve the 95 % intervals of right ascension, declination and position angle, degrees.

    Near a pole that of a right ascension may be all around, 180.

    Args:
        sigmas_deg: the standard deviations of these three; None: they are not known
        freedom: degrees of freedom of the reading sigma; None: it is stated
    """
    if sigmas_deg is None:
        return [None] * 3
    student = float(stdtrit(math.inf if freedom is None else freedom, 0.975))
    return [min(student * sigma, WHOLE_TURN / 2.0) for sigma in sigmas_deg]


def _half_widths(one: SolvedStars) -> list[float | None]:
    return half_widths(one.angle_sigmas_deg and one.angle_sigmas_deg[3:], one.reading_freedom)


def _decimals(half: float | None) -> int:
    """Choose the decimals that a half-width allows: two of its digits."""
    return 5 if not half else min(max(1 - math.floor(math.log10(half * 1.005)), 0), 7)


def with_half(value: float, half: float | None, unknown: int = 5) -> list[str]:
    """Write an angle and half of its interval, to two digits of that.

    Args:
        value: degrees
        half: of its 95 % interval; empty where it is unknown
        unknown: decimals of the angle where it is
    """
    decimals = _decimals(half) if half else unknown
    value = round(value, decimals) + 0.0  # no -0
    value = 0.0 if value == WHOLE_TURN else value
    return [f"{value:.{decimals}f}", "" if half is None else f"{half:.{decimals}f}"]


def hours_text(ra_deg: float, decimals: int) -> str:
    """Write a right ascension as hours, minutes and seconds."""
    hours = ra_deg / 15.0
    if round(hours * 3600.0, decimals) >= 86400.0:
        hours = 0.0
    text = format_dms(hours, decimals)
    for mark, letter in zip("°'\"", "hms", strict=True):
        text = text.replace(mark, letter)
    return text


def _sexagesimal(
    ra_deg: float, dec_deg: float, half_ra_deg: float | None, half_dec_deg: float | None
) -> tuple[str, str]:
    """Write a right ascension in hours and a declination, with the digits that they have."""
    seconds = None if half_ra_deg is None else half_ra_deg * 240.0
    arc = None if half_dec_deg is None else half_dec_deg * 3600.0
    hours = hours_text(ra_deg, min(_decimals(seconds), 3))
    return hours, format_dms(dec_deg, min(_decimals(arc), 3))


def _pointed(one: SolvedStars) -> tuple[float, float, float]:
    """Take right ascension, 0 to 360, declination and position angle, degrees."""
    alpha, delta, swing = one.angles_deg[3:]
    return alpha % 360.0, delta, swing % 360.0


def _answer(photograph: SolvedPhotograph, one: SolvedStars, size_px: Sequence[float] | None) -> str:
    """Say where the camera points, at which scale, and what it sees."""
    stars, unit = photograph.stars, photograph.file.unit
    halves, values = _half_widths(one), _pointed(one)
    sexagesimal = _sexagesimal(*values[:2], *halves[:2])
    notes = (*sexagesimal, "of the y axis, from north to east")
    rows = []
    for name, value, half, note in zip(
        ("right ascension", "declination", "position angle"), values, halves, notes, strict=True
    ):
        shown, width = with_half(value, half)
        rows.append([name, shown, f"+- {width}" if width else "", "deg", note])
    focal = float(np.ravel(stars.focal_length_mm)[0])  # as solved, where it was
    scale = ARCSEC / focal
    rows.append(["scale", f"{scale:.5g}", "", "", f"seconds of arc a {unit}, on the axis"])
    image = np.asarray(stars.image_mm).reshape(-1, 2)[photograph.used]
    ends = np.stack([image.min(axis=0), image.max(axis=0)])
    what = "of the stars"
    if size_px is not None and unit == "px" and photograph.axes is not None:
        edges = image_edges(photograph.file, photograph.axes, focal, one.camera or {})
        if np.isfinite(edges).all():  # of a lens that reaches them
            ends, what = edges, "of the image"
    wide, high = np.degrees(np.ptp(np.arctan(ends / focal), axis=0)).tolist()
    rows.append(["field", f"{wide:.4g} x {high:.4g}", "", "deg", what])
    known = [f"; {HALF_WIDTHS}"] if halves[0] is not None else []
    head = f"{photograph.file.source}: {count_text(len(one.stars), 'star')}, {one.method}, rms "
    head += f"{size_text(one.rms, 3)} {unit}{''.join(known)}"
    lines = aligned(rows, {0, 2, 3, 4}, {2, 3})
    return "\n".join([head, *lines]) + "\n"


def _directions(rows: Sequence[tuple[SolvedPhotograph, SolvedStars]]) -> str:
    """Tabulate where the cameras point."""
    if not rows:
        return ""
    units = list(dict.fromkeys(photograph.file.unit for photograph, _ in rows))
    head = ["image", "method", "stars", "ra", "+-", "dec", "+-", "angle", "+-"]
    below = ["", "", "", "deg", "", "deg", "", "deg", "", *units]
    table = [[*head, *("rms" for _ in units)], below]
    for photograph, one in rows:
        cells = [
            cell
            for value, half in zip(_pointed(one), _half_widths(one), strict=True)
            for cell in with_half(value, half)
        ]
        rms = [size_text(one.rms, 3) if photograph.file.unit == unit else "" for unit in units]
        table.append([photograph.label, one.method, _stars(one.stars), *cells, *rms])
    if not any(row[0] for row in table[2:]):
        table = [row[1:] for row in table]
    if not any(half is not None for _, one in rows for half in _half_widths(one)):
        keep = [k for k, cell in enumerate(table[0]) if cell != "+-"]
        table = [[row[k] for k in keep] for row in table]
    return _laid_out(table)


def _horizon(rows: Sequence[tuple[SolvedPhotograph, SolvedStars]], names: Sequence[str]) -> str:
    """Tabulate angles against the horizon of those photographs that have them.

    Args:
        rows: photographs and their solutions
        names: names of the angles, as in `OF_PLACE`
    """
    heads = [name.removesuffix("_deg").replace("_", " ") for name in names]
    table = [
        ["image", "method", *(cell for head in heads for cell in (head, "+-"))],
        ["", "", *(cell for _ in heads for cell in ("deg", ""))],
    ]
    for photograph, one in rows:
        sky = one.sky or {}
        if names[0] not in sky:
            continue
        cells = []
        for name in names:
            sigma = sky.get(f"sigma_{name}")
            half = None if sigma is None else half_widths([sigma], one.reading_freedom)[0]
            cells += with_half(sky[name], half)
        table.append([photograph.label, one.method, *cells])
    keep = [k for k in range(len(table[0])) if any(row[k] for row in table[2:])]
    return _laid_out([[row[k] for k in keep] for row in table]) if keep else ""


def _laid_out(table: list[list[str]]) -> str:
    """Align a table below its heads: names to the left, and a +- close to its angle."""
    left = {k for k, cell in enumerate(table[0]) if cell in ("image", "method", "stars")}
    close = {k for k, cell in enumerate(table[0]) if cell == "+-"}
    return "\n".join(aligned(table, left, close)) + "\n"


POINT_ANGLES = {
    "ra_deg": "ra", "dec_deg": "dec", "alpha_deg": "alpha", "delta_deg": "delta",
    "azimuth_deg": "azimuth", "elevation_deg": "elevation",
}  # fmt: skip
AS_SEEN = "points as they are seen, without correction for refraction or aberration"
READ_ALIKE = "; their own readings count\nas good as those of the stars"


def _points(rows: Sequence[tuple[SolvedPhotograph, SolvedStars]]) -> str:
    """Tabulate the directions of points that were asked for."""
    known = {name for _, one in rows for point in one.points or [] for name in point}
    shown = [name for name in POINT_ANGLES if name in known]
    units = "/".join(dict.fromkeys(photograph.file.unit for photograph, _ in rows))
    angles = [cell for name in shown for cell in (POINT_ANGLES[name], "+-")]
    table = [
        ["image", "method", "x", "y", *angles],
        ["", "", units, units, *(cell for _ in shown for cell in ("deg", ""))],
    ]
    for photograph, one in rows:
        for point in one.points or []:
            cells = []
            for name in shown:
                sigma = point.get(f"sigma_{name}")
                half = None if sigma is None else half_widths([sigma], one.reading_freedom)[0]
                cells += with_half(point[name], half) if name in point else ["", ""]
            at = (f"{point[axis]:g}" for axis in "xy")
            table.append([photograph.label, one.method, *at, *cells])
    keep = [k for k in range(len(table[0])) if k > 1 or len({row[k] for row in table[2:]}) > 1]
    table = [[row[k] for k in keep] for row in table]
    sure = any(one.rotation_covariance_arcsec2 is not None for _, one in rows)
    return f"{AS_SEEN}{READ_ALIKE * sure}\n{_laid_out(table)}"


def _table(rows: Sequence[tuple[SolvedPhotograph, SolvedStars]]) -> str:
    """Tabulate the attitudes, one a line."""
    solved = [one for _, one in rows]
    labels = [photograph.label for photograph, _ in rows]
    units = list(dict.fromkeys(photograph.file.unit for photograph, _ in rows))
    by_unit: list[_Column] = [
        (f"rms {unit}", [one.rms if p.file.unit == unit else None for p, one in rows], ".5f", 9)
        for unit in units
    ]
    wide = max(map(len, labels))
    pointed = all(photograph.epoch for photograph, _ in rows)  # alpha, delta, swing stand above
    margin = max(wide, len("image")) + 1 if wide else 0
    angles: list[_Column] = [
        (name.replace("_", " "), [one.angles_deg[k] for one in solved], ".7f", 12)
        for k, name in enumerate(
            ANGLE_NAMES if len(solved) == 1 or not (wide and pointed) else ANGLE_NAMES[:3]
        )
    ]
    columns: list[_Column] = [
        *angles,
        *by_unit,
        ("sigma sec", [one.rotation_rms_arcsec for one in solved], ".1f", 10),
        ("sin(D1,D2)", [one.conditioning for one in solved], ".3f", 10),
        ("discr. sec", [one.interstar_discrepancy_arcsec for one in solved], ".2f", 10),
    ]
    shown = [column for column in columns if any(value is not None for value in column[1])]
    if len(rows) == 1:  # one below the other: it is too wide for a screen
        (one,) = solved
        moved = "" if one.converged or one.iterations == 0 else f"\n{MOVED}"
        cells = [[title, format(values[0] or 0.0, form)] for title, values, form, _ in shown]
        head = f"{one.method}, stars {_stars(one.stars)}"
        return "\n".join([head, *aligned(cells, {0})]) + f"{moved}\n"
    head = f"{'image' if wide else '':<{margin}}"
    by = max(len(one.method) for one in solved) if wide else 17
    lines = [f"{head}{'method':<{by}} {'stars':<9}" + "".join(f" {t:>{w}}" for t, _, _, w in shown)]
    for k, one in enumerate(solved):
        line = f"{labels[k]:<{margin}}{one.method:<{by}} {_stars(one.stars):<9}"
        for _, values, form, width in shown:
            value = values[k]
            line += f" {'' if value is None else format(value, form):>{width}}"
        lines.append(line.rstrip() + ("" if one.converged or one.iterations == 0 else "  *"))
    if any(one.iterations and not one.converged for one in solved):
        lines.append(f"* {MOVED}")
    return "\n".join(lines) + "\n"


def _details(one: SolvedStars, file: StarFile) -> str:
    """Format matrix and uncertainty of one solution."""
    lines = ["matrix"]
    if one.orthogonality_defect > ROUNDING:
        lines = [f"matrix (as solved its orthogonality defect is {one.orthogonality_defect:.1e})"]
    lines += ["".join(f" {element:15.10f}" for element in row) for row in one.matrix]
    if one.iterations:
        lines += ["", count_text(one.iterations, "correction")]
    if one.rotation_sigma_arcsec is not None:
        lines += _uncertainty(one, file.unit)
    elif one.reading_sigma is None:
        text = "two stars do not tell the reading error; --reading-sigma states it"
        lines += ["", f"no standard deviations: {text}"]
    if one.sky is not None and (pointing := _pointing(one.sky, one.reading_freedom)):
        lines += ["", *pointing]
    if one.camera is not None:
        lines += ["", *_camera(one, file.unit)]
    if one.camera_m is not None and one.camera_sigma_m is not None:
        place = " ".join(f"{value:.3f}" for value in one.camera_m)
        sigmas = " ".join(f"{value:.3f}" for value in one.camera_sigma_m)
        lines += ["", f"camera at {place} m, standard deviations {sigmas} m"]
    if one.axis is not None:
        axis = " ".join(f"{component:.10f}" for component in one.axis)
        lines += ["", f"one rotation: {one.angle_deg:.7f} degrees about {axis},"]
        lines += [f"right ascension {one.axis_ra_deg:.7f}, declination {one.axis_dec_deg:.7f}"]
    return "\n".join(lines) + "\n"


def _residuals(one: SolvedStars, file: StarFile, *, robust: bool) -> str:
    """Tabulate the residuals of one solution, star by star."""
    lines = ["residuals, observed minus computed" + (", and weights" if one.weights else "")]
    lines.append(f"{'star':>6} {f'x {file.unit}':>11} {f'y {file.unit}':>11}")
    reduced = False
    for k, (star, residual) in enumerate(zip(one.stars, one.residuals, strict=True)):
        line = f"{star:6d}" + "".join(f" {value:11.6f}" for value in residual)
        if one.weights:
            line += "".join(f" {value:11.3g}" for value in one.weights[k])
            small = robust and max(one.weights[k]) < REDUCED_WEIGHT
            reduced |= small
            line += " *" if small else "  "
        lines.append(f"{line}  {file.names[star - 1]}".rstrip())
    if reduced:
        every = all(max(weights) < REDUCED_WEIGHT for weights in one.weights or ())
        fate = "as of all stars, which are in the rms" if every else "the star is not in the rms"
        lines.append(f"* weight below {REDUCED_WEIGHT:g}: {fate}")
    return "\n".join(lines) + "\n"


def _camera(one: SolvedStars, of_file: str) -> list[str]:
    """Format what was solved of the camera."""
    lines = []
    for name, value in (one.camera or {}).items():
        sigma = (one.camera_sigmas or {}).get(name)
        unit = "" if name == "k1" else f" {of_file}"
        stated = "" if sigma is None else f", standard deviation {size_text(sigma)}{unit}"
        lines.append(f"{name} {value:.8g}{unit}{stated}")
    return lines


def _cameras(rows: Sequence[tuple[SolvedPhotograph, SolvedStars]]) -> list[str]:
    """Format the camera of several photographs: one, or one each."""
    by_camera: dict[tuple[str, ...], list[str]] = {}
    for photograph, one in rows:
        lines = tuple(_camera(one, photograph.file.unit))
        by_camera.setdefault(lines, []).append(photograph.label)
    if len(by_camera) == 1:
        ((lines, labels),) = by_camera.items()
        return ["\n".join([f"one camera of {count_text(len(labels), 'photograph')}", *lines, ""])]
    return ["\n".join([f"camera of {', '.join(of)}", *own, ""]) for own, of in by_camera.items()]


def _pointing(sky: dict[str, float], freedom: float | None) -> list[str]:
    """Format the pointing of the optical axis: right ascension, declination, azimuth, vehicle.

    Args:
        sky: angles and standard deviations by the names of their columns
        freedom: degrees of freedom of the reading sigma; None: it is stated
    """
    half = dict[str, float | None]()
    for name in sky:
        sigma = sky.get(f"sigma_{name}")
        half[name] = None if sigma is None else half_widths([sigma], freedom)[0]

    def told(label: str, name: str) -> str:
        value, width = with_half(sky[name], half[name])
        return f"{label} {value}{f' +- {width}' * bool(width)}"

    lines = []
    if "ra_of_date_deg" in sky:
        hours, arc = _sexagesimal(
            sky["ra_of_date_deg"], sky["dec_of_date_deg"],
            half["ra_of_date_deg"], half["dec_of_date_deg"],
        )  # fmt: skip
        lines.append(
            f"optical axis: {told('right ascension of date', 'ra_of_date_deg')} = {hours}, "
            f"{told('declination', 'dec_of_date_deg')} = {arc}"
        )
    if "azimuth_deg" in sky:
        lines.append(", ".join(map(told, ("azimuth", "elevation", "camera roll"), OF_PLACE)))
    if "vehicle_yaw_deg" in sky:
        lines.append(", ".join(map(told, ("vehicle yaw", "pitch", "roll"), OF_VEHICLE)))
    if "azimuth_deg" in sky:
        lines.append(EXACT_SKY)
    return lines


EXACT_SKY = (
    "date and place count as exact: in a second of the date the sky turns by 0.0042 degree, over "
    "a kilometre of the place by 0.009"
)


def _uncertainty(one: SolvedStars, unit: str) -> list[str]:
    """Format the standard deviations of axes and angles, and the region of the optical axis."""
    assert one.rotation_sigma_arcsec and one.angle_sigmas_deg and one.boresight_95_arcsec
    assert one.reading_sigma is not None
    x, y, z = one.rotation_sigma_arcsec
    known = "as stated" if one.reading_freedom is None else "as the residuals tell"
    major, minor = one.boresight_95_arcsec
    lines = [
        "",
        "standard deviations, for image coordinates good to "
        f"{size_text(one.reading_sigma, 3)} {unit} ({known}):",
        f"about the camera's x, y, z {x:.1f} {y:.1f} {z:.1f} seconds of arc",
        "in degrees "
        + ", ".join(
            f"{name.removesuffix('_deg')} {sigma:.5f}"
            for name, sigma in zip(ANGLE_NAMES, one.angle_sigmas_deg, strict=True)
        ),
        f"with a probability of 95 percent the optical axis lies in an ellipse with semi-axes of "
        f"{major:.1f} and {minor:.1f}",
        f"seconds of arc, the longer one {one.boresight_95_angle_deg:.0f} degrees from north "
        "toward east",
    ]
    if one.weighted_rms is not None:
        lines.append(f"weighted rms of the residuals {size_text(one.weighted_rms, 3)} {unit}")
    return lines


def _disagreements(photograph: SolvedPhotograph) -> str:
    """Tabulate the sum and median of each star's interstar discrepancies."""
    total, median = star_disagreement_arcsec(photograph.stars)
    lines = [photograph.label] if photograph.label else []
    lines += [
        "disagreement of each star with the others: angles between the stars minus angles",
        "between their images, sizes added up, and their median, seconds of arc",
        f"{'star':>6} {'sum':>12} {'median':>12}",
    ]
    for k, name in enumerate(photograph.file.names):
        lines.append(f"{k + 1:6d} {total[k]:12.2f} {median[k]:12.2f}  {name}".rstrip())
    return "\n".join(lines) + "\n"


def _stars(stars: Sequence[int]) -> str:
    """Format the stars' numbers, a long run as `1-30`."""
    if len(stars) > 4 and list(stars) == list(range(stars[0], stars[-1] + 1)):
        return f"{stars[0]}-{stars[-1]}"
    return ",".join(map(str, stars))


# What program STARS prints


def as_listed(photographs: Sequence[SolvedPhotograph]) -> str:
    """Print photographs as program STARS does; four corrections unless a number is given."""
    pages = []
    for one in photographs:
        options = one.options
        page = stars_printout(
            one.stars.select(one.used),
            initial_deg=options.initial_deg,
            start=options.start,
            weights=options.weights,
            corrections=options.corrections or LISTED_CORRECTIONS,
            reading_sigma_mm=options.reading_sigma_mm,
        )
        pages.append(f"{one.label}\n{page}" if one.label else page)
    return "\n".join(pages)
