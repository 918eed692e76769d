"""Routines of the report's listings, statement for statement, on plain numbers.

The independent side of the tests: written from the listings, sharing nothing
with the package.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from math import acos, atan2, cos, degrees, radians, sin, sqrt
from pathlib import Path

Vector = tuple[float, float, float]
Matrix = list[list[float]]


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1])


def dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a: Vector, by: float) -> Vector:
    return (a[0] * by, a[1] * by, a[2] * by)


def unit(a: Vector) -> Vector:
    return scaled(a, 1.0 / sqrt(dot(a, a)))


def jnkmat(omega_deg: float, phi_deg: float, kappa_deg: float) -> Matrix:
    """JNKMAT."""
    o, p, k = radians(omega_deg), radians(phi_deg), radians(kappa_deg)
    co, so, cp, sp, ck, sk = cos(o), sin(o), cos(p), sin(p), cos(k), sin(k)
    return [
        [ck * cp, so * sp * ck + co * sk, -co * sp * ck + so * sk],
        [-sk * cp, -so * sp * sk + co * ck, co * sp * sk + so * ck],
        [sp, -so * cp, co * cp],
    ]


def inv3x3(r: Matrix) -> Matrix:
    """INV3X3."""
    o = [[0.0] * 3 for _ in range(3)]
    o[0][0] = r[1][1] * r[2][2] - r[2][1] * r[1][2]
    o[0][1] = -r[1][0] * r[2][2] + r[2][0] * r[1][2]
    o[0][2] = r[1][0] * r[2][1] - r[2][0] * r[1][1]
    o[1][0] = -r[0][1] * r[2][2] + r[2][1] * r[0][2]
    o[1][1] = r[0][0] * r[2][2] - r[2][0] * r[0][2]
    o[1][2] = -r[0][0] * r[2][1] + r[2][0] * r[0][1]
    o[2][0] = r[0][1] * r[1][2] - r[1][1] * r[0][2]
    o[2][1] = -r[0][0] * r[1][2] + r[1][0] * r[0][2]
    o[2][2] = r[0][0] * r[1][1] - r[1][0] * r[0][1]
    det = r[0][0] * o[0][0] + r[0][1] * o[0][1] + r[0][2] * o[0][2]
    return [[o[j][i] / det for j in range(3)] for i in range(3)]


def church(stars: list[Vector], photo: list[Vector]) -> Matrix:
    """CHURCH: M, not its transpose."""
    c = [[sum(u[i] * u[j] for u in stars) for j in range(3)] for i in range(3)]
    f = [
        [sum(p[j] * u[i] for u, p in zip(stars, photo, strict=True)) for j in range(3)]
        for i in range(3)
    ]
    inverse = inv3x3(c)
    return [[sum(inverse[i][k] * f[k][j] for k in range(3)) for i in range(3)] for j in range(3)]


def tustar(stars: list[Vector], photo: list[Vector], unit_third: bool) -> Matrix:
    """TUSTAR's OMAT; with unit cross products as eqs. 3.21, 3.22 have them, if asked."""
    p3, u3 = cross(*photo), cross(*stars)
    if unit_third:
        p3, u3 = unit(p3), unit(u3)
    pqr = [[photo[0][i], photo[1][i], p3[i]] for i in range(3)]
    inverse = inv3x3([[stars[0][i], stars[1][i], u3[i]] for i in range(3)])
    return [[sum(pqr[i][k] * inverse[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def twostar(stars: list[Vector], photo: list[Vector]) -> tuple[Vector, float, Matrix]:
    """SUBCRS, PIKFAR, AXIANG, and ROTATE of the axes x, y, z: axis, degrees, M."""
    axis = unit(cross(minus(photo[0], stars[0]), minus(photo[1], stars[1])))
    one, two = (sqrt(dot(u, u)) * sin(acos(dot(u, axis) / sqrt(dot(u, u)))) for u in stars)
    k = 0 if one > two else 1
    foot = scaled(axis, dot(stars[k], axis))
    a, d = minus(stars[k], foot), minus(photo[k], foot)
    angle = acos(dot(a, d) / dot(a, a))
    xx = cross(a, d)
    if sum(abs(axis[i] + xx[i]) for i in range(3)) < sum(map(abs, axis)):
        angle = -angle
    columns = [rotate(e, axis, angle) for e in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    return axis, degrees(angle), [[column[i] for column in columns] for i in range(3)]


def rotate(point: Vector, axis: Vector, angle: float) -> Vector:
    """ROTATE: division by C and all."""
    foot = scaled(axis, dot(point, axis))
    a, b, c = minus(point, foot)
    square = a * a + b * b + c * c
    f = b * sin(angle) * axis[0] - a * sin(angle) * axis[1] + c * cos(angle)
    e = (b * f - square * sin(angle) * axis[0]) / c
    d = (a * f + square * sin(angle) * axis[1]) / c
    return (d + foot[0], e + foot[1], f + foot[2])


def angles_deg(m: Matrix) -> tuple[float, float, float]:
    """omega, phi, kappa as table 6.4 has them: phi by the arc sine."""
    return (
        degrees(atan2(-m[2][1], m[2][2])),
        degrees(atan2(m[2][0], sqrt(1.0 - m[2][0] ** 2))),
        degrees(atan2(-m[1][0], m[0][0])),
    )


def sum_of_squares(
    angles: tuple[float, float, float], stars: list[Vector], image_mm: list[tuple], f: float
) -> float:
    """Of the residuals of RESWTS, uniform weights."""
    m = jnkmat(*angles)
    total = 0.0
    for u, (x, y) in zip(stars, image_mm, strict=True):
        xnumer, ynumer, denom = (dot(tuple(row), u) for row in m)  # type: ignore[arg-type]
        total += (x + f * xnumer / denom) ** 2 + (y + f * ynumer / denom) ** 2
    return total


def stars_corrections(
    angles: tuple[float, float, float],
    stars: list[Vector],
    image_mm: list[tuple],
    f: float,
    count: int,
    listed_weights: bool,
) -> tuple[float, float, float]:
    """STARS: so many corrections, with the partials of PARSHL and the weights of RESWTS."""
    for _ in range(count):
        m = jnkmat(*angles)
        o, p, k = (radians(angle) for angle in angles)
        so, co, sp, cp, sk, ck = sin(o), cos(o), sin(p), cos(p), sin(k), cos(k)
        atwa = [[0.0] * 3 for _ in range(3)]
        atwres = [0.0] * 3
        for (u, v, w), (x, y) in zip(stars, image_mm, strict=True):
            xn, yn, de = (row[0] * u + row[1] * v + row[2] * w for row in m)
            residuals = (x + f * xn / de, y + f * yn / de)
            pxn = (
                -m[0][2] * v + m[0][1] * w,
                -sp * ck * u + so * cp * ck * v - co * cp * ck * w,
                m[1][0] * u + m[1][1] * v + m[1][2] * w,
            )
            pyn = (
                -m[1][2] * v + m[1][1] * w,
                sk * sp * u - so * cp * sk * v + co * cp * sk * w,
                -m[0][0] * u - m[0][1] * v - m[0][2] * w,
            )
            pde = (-m[2][2] * v + m[2][1] * w, cp * u + so * sp * v - co * sp * w, 0.0)
            rows = (
                [f / de * (pxn[j] - xn / de * pde[j]) for j in range(3)],
                [f / de * (pyn[j] - yn / de * pde[j]) for j in range(3)],
            )
            for row, residual in zip(rows, residuals, strict=True):
                weight = reswts(residual) if listed_weights else 1.0
                for i in range(3):
                    atwres[i] += row[i] * weight * residual
                    for j in range(3):
                        atwa[i][j] += row[i] * row[j] * weight
        inverse = inv3x3(atwa)
        angles = tuple(  # type: ignore[assignment]
            angles[i] - degrees(sum(inverse[i][j] * atwres[j] for j in range(3))) for i in range(3)
        )
    return angles


def reswts(residual: float) -> float:
    """The weight RESWTS gives."""
    size = abs(residual)
    weight = 0.0 if size < 0.0000001 else 0.000009 / size**2
    return 3.0 if weight > 9.0 else weight


# Transcribed figures


RAE_GOLDENS = Path(__file__).parents[2] / "golden_outputs" / "rae_1987"
Golden = Callable[[str], list[dict[str, str]]]


def read_golden(name: str) -> list[dict[str, str]]:
    """The rows of a golden file by column name; a file without rows is an error."""
    with (RAE_GOLDENS / name).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows, f"{name} is empty"
    return rows
