"""Make the pictures of the report and of the page of picks that the documentation shows.

    python -m tools.page_pictures

It writes docs/report.png and docs/pick.png of the example that `vopd new` writes, by a headless
Chromium, reduced, in 160 colours.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

DOCS = Path(__file__).resolve().parent.parent / "docs"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")
WAIT_MS = 6000  # of the page's own time, for its pictures to be decoded
WIDTH, COLOURS, MOST_BYTES = 720, 160, 100_000


def vopd(*arguments: str | Path) -> None:
    """Run a command of vopd."""
    subprocess.run([sys.executable, "-m", "vopd", *map(str, arguments)], check=True)


def picture(page: Path, size: tuple[int, int], top: int, name: str) -> None:
    """Photograph a page.

    Args:
        page: its file
        size: width and height of what is shown, pixels
        top: how many rows above are left out
        name: of the picture in docs
    """
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        raise SystemExit("no chromium: Debian has chromium")
    shot = page.with_suffix(".png")
    width, height = size
    window = f"--window-size={width},{height + top}"
    more = (window, f"--virtual-time-budget={WAIT_MS}", f"--screenshot={shot}", page.as_uri())
    subprocess.run([program, *FLAGS, *more], check=True, capture_output=True)
    shown = Image.open(shot).convert("RGB").crop((0, top, width, top + height))
    shown = shown.resize((WIDTH, height * WIDTH // width), Image.Resampling.LANCZOS)
    file = DOCS / name
    shown.quantize(COLOURS, kmeans=2, dither=Image.Dither.NONE).save(file, optimize=True)
    print(f"{file.relative_to(DOCS.parent)}: {file.stat().st_size:,} bytes")
    if file.stat().st_size > MOST_BYTES:
        raise SystemExit(f"{file} has more than {MOST_BYTES:,} bytes")


def main() -> None:
    """Make both pictures."""
    with TemporaryDirectory() as folder:
        example = Path(folder) / "example"
        vopd("new", example)
        vopd("pick", example / "flight.toml", "-o", example / "pick.html")
        vopd("track", example / "flight.toml")
        vopd("report", example / "flight.toml", "-o", example / "report.html", "--photographs")
        picture(example / "report.html", (1280, 1400), 590, "report.png")
        picture(example / "pick.html", (1000, 760), 0, "pick.png")


if __name__ == "__main__":
    main()
