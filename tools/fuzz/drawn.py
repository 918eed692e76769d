"""Small flights drawn at random, with wrong picks: too little often holds what is asked for."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random

import numpy as np

from tests.kit.joint_flights import CENTRE, FOCAL, SIZE, Priors, drone, flight_of, geodetic
from vopd.arrays import Floats
from vopd.flight.solve.free import FREE

RATE_HZ = 10.0
SIGMA_M = ('"exact"', "0.02", "0.3", "5.0", "[3.0, 3.0, 0.0]", "[0.0, 0.0, 20.0]")
STATED = {  # keys that may all be left out
    "camera": ('readout_ms = 20.0\nreadout = "down"\nframe_time = "middle"',),
    "picks": ("sigma_px = 1.0",),
    "track": ("lever_arm_m = [0.1, 0.2, 0.3]", 'interpolate = "cubic"', "offset_s = 0.02"),
    "vehicle": ('mount = "down"', "mount_sigma_deg = 0.1"),
    "atmosphere": ('refraction = "off"', "sigma_k = 0.1"),
    "solve": (
        'loss = "huber"', 'blunders = "drop"', 'position = "fixed"', 'check_landmarks = ["P1"]',
    ),
    "uncertainty": (
        "focal_rel = 0.01", "principal_px = [3.0, 3.0]", "k1 = 0.01", "clock_rate_ppm = 50.0",
    ),
}  # fmt: skip


def drawn_project(random: Random) -> dict[str, bytes]:
    """A flight of one to six frames and two to seven landmarks, 100 metres below.

    The camera hovers or flies. Up to three picks are wrong, and two may be exchanged.
    """
    rng = np.random.default_rng(random.getrandbits(32))
    scene = drone(
        rng, random.randint(1, 6), random.randint(2, 7), seen=random.choice((0.7, 0.9, 1.0)),
        spacing_m=random.choice((0.0, 0.5, 20.0)), tilt_deg=random.choice((0.0, 30.0, 60.0)),
    )  # fmt: skip
    errors = {"focal": random.choice((0.0, 30.0)), "k1": random.choice((0.0, 0.1))}
    flight = flight_of(rng, scene, 1.0, Priors(None, None, errors))
    pixel = flight.picks.pixel.copy()
    wrong = random.sample(range(len(pixel)), min(len(pixel), random.randint(0, 3)))
    pixel[wrong] += rng.normal(0.0, random.choice((20.0, 300.0, 3000.0)), (len(wrong), 2))
    if len(pixel) > 1 and random.random() < 0.3:
        pixel[:2] = pixel[[1, 0]]
    picks = (
        f"{frame},P{landmark},{u:.3f},{v:.3f}"
        for frame, landmark, (u, v) in zip(scene.frame, scene.landmark, pixel, strict=True)
    )
    position_m = flight.path.position_m
    step_m = np.diff(position_m[:2], axis=0) if len(position_m) > 1 else np.array([[0.5, 0.3, 0.1]])
    track_m = np.vstack([position_m[:1] - step_m, position_m, position_m[-1:] + step_m])
    track = (f"{k / RATE_HZ:.1f},{row}" for k, row in enumerate(_rows(track_m), -1))
    marks = (f"P{k},{row}" for k, row in enumerate(_rows(flight.landmarks.position_m)))
    return {
        "flight.toml": _keys(random).encode(),
        "picks.csv": _csv("frame,landmark,u_px,v_px", picks),
        "landmarks.csv": _csv("landmark,lat_deg,lon_deg,h_m", marks),
        "track.csv": _csv("t_s,lat_deg,lon_deg,h_m", track),
    }


def _keys(random: Random) -> str:
    """Write the project, with some of the keys that may be left out."""
    focal = f"fx_px = {FOCAL}, fy_px = {FOCAL}"
    lens = f'{{ model = "brown", {focal}, cx_px = {CENTRE[0]}, cy_px = {CENTRE[1]} }}'
    place = 'height = "ellipsoid"\nsigma_m = '
    sections = {
        "camera": [f"image_size_px = [{SIZE[0]}, {SIZE[1]}]", 'pixel_grid = "centre"'],
        "picks": ['file = "picks.csv"', f'pixel_grid = "centre"\nframe_rate_hz = {RATE_HZ}'],
        "landmarks": ['file = "landmarks.csv"', place + random.choice(SIGMA_M)],
        "track": ['file = "track.csv"', place + random.choice(SIGMA_M)],
    }
    sections["camera"].append(f"lens = {lens}")
    sections["picks"].append("first_frame_t_s = 0.0")
    sections["track"].append(random.choice(('sigma_t_s = "exact"', "sigma_t_s = 0.05")))
    if random.random() < 0.3:
        sections["track"].append("sigma_bias_m = [1.0, 1.0, 2.0]")
    for name, keys in STATED.items():
        sections.setdefault(name, []).extend(key for key in keys if random.random() < 0.2)
    free = ", ".join(f'"{name}"' for name in random.sample([*FREE], random.choice((0, 0, 1, 2, 3))))
    sections["solve"].append(f"free = [{free}]")
    return "".join(f"[{name}]\n" + "\n".join(keys) + "\n" for name, keys in sections.items())


def _rows(position_m: Floats) -> Iterable[str]:
    """Write Earth-centred positions, (n, 3), as latitude, longitude and height."""
    latitude, longitude, height = geodetic(position_m)
    for where in zip(np.degrees(latitude), np.degrees(longitude), height, strict=True):
        yield "{:.12f},{:.12f},{:.6f}".format(*where)


def _csv(header: str, rows: Iterable[str]) -> bytes:
    return "\n".join([header, *rows, ""]).encode()
