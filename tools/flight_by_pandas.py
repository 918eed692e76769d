"""The attitude of a flight by numpy and pandas alone, as somebody would write it in a day.

    python tools/flight_by_pandas.py FOLDER TABLE.csv

It takes the flights of tools/long_flight.py (camera, picks, landmarks and track of these) and
solves all frames at once: yaw, pitch and roll with standard deviations from the residuals.
tools/benchmark.py measures `vopd attitude` against it.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd

PASSES, STEP = 6, 1e-6  # of Gauss and Newton; of a numerical derivative, rad
A_M, E2 = 6378137.0, 0.0066943799901413165


def earth_centred(table: pd.DataFrame) -> np.ndarray:
    """Convert latitude, longitude and height on WGS 84."""
    lat, lon = np.radians(table.lat_deg.to_numpy()), np.radians(table.lon_deg.to_numpy())
    h, n = table.h_m.to_numpy(), A_M / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    east, up = (n + h) * np.cos(lat), (n * (1 - E2) + h) * np.sin(lat)
    return np.stack([east * np.cos(lon), east * np.sin(lon), up], axis=1)


def distorted(xy: np.ndarray, k: list[float]) -> np.ndarray:
    """Apply the lens of Brown: k1, k2, p1, p2, k3."""
    (x, y), r2 = xy.T, (xy**2).sum(axis=1)
    radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))
    dx = 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)
    dy = k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y
    return np.stack([x * radial + dx, y * radial + dy], axis=1)


def turns(vector: np.ndarray) -> np.ndarray:
    """Convert rotation vectors to matrices (Rodrigues)."""
    angle = np.linalg.norm(vector, axis=1)[:, None, None]
    x, y, z = vector.T
    o = np.zeros_like(x)
    cross = np.stack([o, -z, y, z, o, -x, -y, x, o], axis=1).reshape(-1, 3, 3)
    first = np.sinc(angle / np.pi)
    return np.eye(3) + first * cross + 0.5 * np.sinc(angle / 2 / np.pi) ** 2 * cross @ cross


def main(folder: Path, out: Path) -> None:
    """Read, solve, write."""
    project = tomllib.loads((folder / "flight.toml").read_text())
    lens, timing = project["camera"]["lens"], project["picks"]
    focal = np.array([lens["fx_px"], lens["fy_px"]])
    centre = np.array([lens["cx_px"], lens["cy_px"]])
    picks = pd.read_csv(folder / "picks.csv").sort_values("frame", kind="stable")
    marks = pd.read_csv(folder / "landmarks.csv")
    track = pd.read_csv(folder / "track.csv")

    frame, first, inverse, count = np.unique(
        picks.frame.to_numpy(), return_index=True, return_inverse=True, return_counts=True
    )
    time_s = timing["first_frame_t_s"] + frame / timing["frame_rate_hz"]
    path = earth_centred(track)
    camera = np.stack([np.interp(time_s, track.t_s, path[:, k]) for k in range(3)], axis=1)
    where = pd.Series(range(len(marks)), index=marks.landmark)
    line = earth_centred(marks)[where.loc[picks.landmark].to_numpy()] - camera[inverse]

    degrees = [np.interp(time_s, track.t_s, track[name]) for name in ("lat_deg", "lon_deg")]
    lat, lon = np.radians(degrees)
    north = np.stack([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)], axis=1)
    east = np.stack([-np.sin(lon), np.cos(lon), 0 * lon], axis=1)
    ned = np.stack([north, east, np.cross(north, east)], axis=1)
    line = np.einsum("pij,pj->pi", ned[inverse], line)
    line /= np.linalg.norm(line, axis=1)[:, None]

    pixel = picks[["u_px", "v_px"]].to_numpy()
    seen = (pixel - centre) / focal
    xy = seen.copy()
    for _ in range(10):
        xy += seen - distorted(xy, lens["k"])
    ray = np.column_stack([xy, np.ones(len(xy))])
    ray /= np.linalg.norm(ray, axis=1)[:, None]

    def per_frame(values: np.ndarray) -> np.ndarray:
        return np.add.reduceat(values, first, axis=0)

    u, _, vt = np.linalg.svd(per_frame(ray[:, :, None] * line[:, None, :]))
    sign = np.ones((len(frame), 3))
    sign[:, 2] = np.linalg.det(u @ vt)
    turn = (u * sign[:, None, :]) @ vt

    def residual(turn: np.ndarray) -> np.ndarray:
        view = np.einsum("pij,pj->pi", turn[inverse], line)
        return pixel - (distorted(view[:, :2] / view[:, 2:], lens["k"]) * focal + centre)

    for _ in range(PASSES):
        now = residual(turn)
        small = turns(STEP * np.eye(3))
        by = np.stack([(now - residual(one @ turn)) / STEP for one in small], axis=2)
        normal = per_frame(np.einsum("pki,pkj->pij", by, by))
        right = per_frame(np.einsum("pki,pk->pi", by, now))
        turn = turns(np.linalg.solve(normal, right[:, :, None])[:, :, 0]) @ turn

    square = per_frame((residual(turn) ** 2).sum(axis=1))
    sigma_px = np.sqrt(square.sum() / (2 * len(picks) - 3 * len(frame)))
    body = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]) @ turn  # forward, right, down, in NED
    yaw = np.degrees(np.arctan2(body[:, 0, 1], body[:, 0, 0])) % 360
    pitch = np.degrees(-np.arcsin(body[:, 0, 2]))
    roll = np.degrees(np.arctan2(body[:, 1, 2], body[:, 2, 2]))
    sigma = np.degrees(sigma_px * np.sqrt(np.diagonal(np.linalg.inv(normal), axis1=1, axis2=2)))
    columns = {"frame": frame, "t_s": time_s, "landmarks": count}
    columns |= {"yaw_deg": yaw, "pitch_deg": pitch, "roll_deg": roll}
    columns |= {f"sigma_{axis}_deg": sigma[:, k] for k, axis in enumerate("xyz")}
    columns["rms_px"] = np.sqrt(square / (2 * count))
    pd.DataFrame(columns).to_csv(out, index=False, float_format="%.6f")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
