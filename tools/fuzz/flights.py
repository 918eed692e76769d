"""Flight projects in every mix of formats, and damage to them."""

from __future__ import annotations

import re
from random import Random

from mutations import mutate

from tests.kit.flight_files import (
    LANDMARKS,
    LENSES,
    OTHER_LENSES,
    PICKS,
    POSITION,
    TRACKS,
    WINDS,
    project,
)

MORE = {  # sections whose keys may all be left out
    "vehicle": [
        'mount = "down"',
        "mount = { ypr_deg = [90, 0, 0] }",
        "mount = { matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]] }",
    ],
    "atmosphere": ['refraction = "off"', "refraction = { k = 0.13 }"],
    "solve": ['loss = "huber"', 'loss = "cauchy"\nblunders = "drop"', 'check_landmarks = ["mast"]'],
    "uncertainty": ["focal_rel = 0.001\nprincipal_px = [0.5, 0.5]"],
}
VALUES = """0 -1 1 2 1e308 -1e308 1e-308 nan inf -inf true [] {} [1,2] [1,2,3] [[1,2],[3,4]] "" "x"
"centre" "corner" "same" "ellipsoid" "egm96" "EPSG:4326" "EPSG:32633" "EPSG:4979" "EPSG:0" "."
"no-such" "flight.toml" "picks.csv" "/dev/null" 2026-05-01T11:58:42Z 0001-01-01
9999-12-31T23:59:59Z {undulation_m=1e9} {ypr_deg=[0,90,0]} {k=1e6} 90 -90.0 360 1e12 "a\\u0000b"
"../x" """.split()  # noqa: SIM905
WORD = re.compile(rb'"[^"\n]*"|[-+.\w]+')


def random_project(random: Random) -> dict[str, bytes]:
    """All files of an undamaged project, each part in any of its formats."""
    lens = random.choice([*LENSES.values()] * 2 + [*OTHER_LENSES.values()])
    picks = random.choice([*PICKS.values()])
    track = random.choice([*TRACKS.values(), POSITION])
    if picks.frames_by == "number" and track.frames_by == "image" and random.random() < 0.9:
        picks = PICKS["CVAT images"]
    wind = random.choice([None, *WINDS.values()])
    if track is POSITION and random.random() < 0.9:
        wind = None
    more = "".join(
        f"[{name}]\n{random.choice(keys)}\n" for name, keys in MORE.items() if random.random() < 0.3
    )
    landmarks = random.choice([*LANDMARKS.values()])
    files = project(lens, picks, landmarks, track, wind, more)
    return {name: text.encode() for name, text in files.items()}


def damaged_project(random: Random) -> dict[str, bytes]:
    """A project of which one to three files are damaged, mostly by what they mean."""
    files = random_project(random)
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        name = random.choice(["flight.toml", *files])
        if random.random() < 0.02:
            del files[random.choice([*files])]
            return files or {"flight.toml": b""}
        change = _key if name == "flight.toml" and random.random() < 0.6 else _word
        if random.random() < 0.4:
            files[name] = _number(files[name], random)
        elif random.random() < 0.5:
            files[name] = mutate(files[name], [*files.values()], random)
        else:
            files[name] = change(files[name], random)
    return files


def long_project(size: int, random: Random) -> dict[str, bytes]:
    """A project whose picks, or whose track, have about so many bytes, damaged a little."""
    picks, track = PICKS["CSV of frames"], TRACKS[random.choice(("CSV by seconds", "GPX"))]
    files = {
        name: text.encode()
        for name, text in project(
            LENSES["inline"], picks, LANDMARKS["CSV, geodetic"], track
        ).items()
    }
    if random.random() < 0.7:
        rows = files["picks.csv"].splitlines()[1:]
        ends = [row.partition(b",")[2] for row in rows[:6]]
        frames = size // sum(len(end) + 7 for end in ends)
        rows = [b"%d,%s" % (frame, end) for frame in range(frames) for end in ends]
        files["picks.csv"] = b"frame,landmark,u_px,v_px\n" + b"\n".join(rows) + b"\n"
        files["flight.toml"] = files["flight.toml"].replace(b"_hz = 10.0", b"_hz = 100000.0")
        name = "picks.csv"
    else:
        name = next(name for name in files if name.startswith("track"))
        files[name] = _long_track(files[name], size)
    if random.random() < 0.7:
        files[name] = random.choice((_word, _word, lambda d, r: mutate(d, [d], r)))(
            files[name], random
        )
    return files


def _long_track(track: bytes, size: int) -> bytes:
    """A track of about so many bytes, at one position for the same three seconds."""
    lines = track.splitlines(keepends=True)
    at = next(k for k, line in enumerate(lines) if line.startswith((b"1.0,", b"<trkpt")))
    copies = size // len(lines[at])
    rows = []
    for k in range(copies):
        time_s = 1.0 + 3.0 * k / copies
        if lines[at].startswith(b"1.0,"):
            rows.append(b"%.9f" % time_s + lines[at][3:])
        else:
            time = b"<time>2026-05-01T11:58:%09.6fZ<" % (42.0 + time_s)
            rows.append(re.sub(b"<time>[^<]*<", time, lines[at]))
    return b"".join([*lines[:at], *rows, *lines[at + 4 :]])


def _key(data: bytes, random: Random) -> bytes:
    """A key of the project has another value, another name, stands twice, or is left out."""
    lines = data.split(b"\n")
    k = random.randrange(len(lines))
    key, equals, _ = lines[k].partition(b" = ")
    changed = [
        key + b" = " + random.choice(VALUES).encode(),
        key + b" = " + random.choice(VALUES).encode(),
        b"#" + lines[k],
        lines[k] + b"\n" + lines[k],
        key[:-1] + equals + lines[k][len(key) + len(equals) :],
    ]
    lines[k] = random.choice(changed)
    return b"\n".join(lines)


def _number(data: bytes, random: Random) -> bytes:
    """A number with a point is changed so that it stays one: by sign, size, or by a little."""
    found = list(re.finditer(rb"-?\d+\.\d+", data))
    if not found:
        return data
    match = random.choice(found)
    value = float(match[0])
    new = random.choice((
        -value, 0.0, value + random.gauss(0.0, 1e-3), value + random.gauss(0.0, 30.0),
        value * 10.0 ** random.randint(-12, 12), float(random.choice(found)[0]), value + 360.0,
    ))  # fmt: skip
    return data[: match.start()] + b"%.12g" % new + data[match.end() :]


def _word(data: bytes, random: Random) -> bytes:
    """A number, a name or a text in quotes is exchanged for another one, here or everywhere."""
    found = WORD.findall(data)
    if not found:
        return data
    old = random.choice(found)
    new = random.choice([random.choice(found), random.choice(VALUES).encode(), b"", old + b"0"])
    if random.random() < 0.2:
        return data.replace(old, new)
    which = [match for match in WORD.finditer(data) if match[0] == old]
    match = random.choice(which)
    return data[: match.start()] + new + data[match.end() :]
