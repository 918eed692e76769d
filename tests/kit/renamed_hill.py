"""The flight of examples/hill with names that are long, wide, of other scripts."""

from __future__ import annotations

import csv
import io
import shutil
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.kit.command import ROOT
from vopd.attitude.history import History
from vopd.flight.result import solve_flight

LONG, WIDE = "abcde fgh " * 100, "W" * 1000
ARABIC, JAPANESE, THAI = "الكنيسة القديمة", "教会の塔の上の十字架", "ประภาคาร"
NAMES = {
    "church": LONG, "mast": WIDE, "bridge": "M" * 24, "corner": "@" * 24, "tower": ARABIC,
    "well": JAPANESE,
}  # fmt: skip
EXCHANGED = {("2", "church"): "mast", ("2", "mast"): "church"}


@cache
def renamed() -> History:
    """The hill with such names, and two picks of frame 2 exchanged."""
    with TemporaryDirectory() as name:
        folder = Path(name) / "hill"
        shutil.copytree(ROOT / "examples" / "hill", folder)
        for file in ("landmarks.csv", "picks.csv"):
            with (folder / file).open(encoding="utf-8", newline="") as read:
                rows = list(csv.reader(read))
            made = io.StringIO()
            rows = [[EXCHANGED.get((row[0], one), one) for one in row] for row in rows]
            csv.writer(made).writerows([NAMES.get(one, one) for one in row] for row in rows)
            (folder / file).write_text(made.getvalue(), encoding="utf-8", newline="")
        project = folder / "flight.toml"
        text = project.read_text(encoding="utf-8").replace('"F12"', f'"{WIDE}"')
        project.write_text(text, encoding="utf-8")
        return solve_flight(project).history()
