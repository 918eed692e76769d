"""Count the printed digits that depend on the computer: on numpy, its processor's functions, libm.

    python tools/digits_by_machine.py
    python tools/digits_by_machine.py --python OTHER/bin/python --decks FOLDER

All decks are run again with each of numpy's functions for newer processors disabled in
turn, with the C library's functions for older ones, with other versions of numpy (those of
the interpreters given with --python), and with values moved by some units in the last place.
Digits that differ from those of the plain run are counted by field, and by whether the
frame converged. Without --decks these are the sample decks and a thousand generated ones.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from other_sines import other_sines  # noqa: E402

from vopd.listing.compare import compare_listings  # noqa: E402
from vopd.listing.pages import frame_pages  # noqa: E402
from vopd.pipeline import solve_decks  # noqa: E402
from vopd.results import SolvedJob  # noqa: E402

Pages = dict[str, tuple[bool, str]]  # by deck, job and frame: whether it converged, and its page
OLD_LIBM = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable"
VERSION = "import numpy, sys; print(sys.version.split()[0], numpy.__version__)"
FEATURES = f"""import sys
sys.path.insert(0, {str(ROOT / "tools")!r})
from other_processor import features
print(*features())
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", action="append", default=[], help="another interpreter")
    parser.add_argument("--decks", type=Path, help="a folder of decks")
    parser.add_argument("--pages", nargs=3, help=argparse.SUPPRESS)  # one run: seed, units, file
    given = parser.parse_args()
    if given.pages:
        seed, units, out = given.pages
        with other_sines(int(seed), int(units)):
            Path(out).write_text(json.dumps(pages_of(given.decks)), encoding="utf-8")
        return
    with tempfile.TemporaryDirectory() as folder:
        decks = given.decks or generated(Path(folder))
        plain = run(sys.executable, {}, decks)
        digits = [0, 0]
        for converged, page in plain.values():
            digits[converged] += sum(map(str.isdigit, page))
        print(f"{len(plain)} frames, {digits[True]} digits where they converged, {digits[False]} "
              "where not; digits that differ:")  # fmt: skip
        for name, pages in runs([sys.executable, *given.python], decks):
            print(f"{name}: {moved(plain, pages)}", flush=True)


def runs(pythons: list[str], decks: Path) -> Iterator[tuple[str, Pages]]:
    """Each way of computing, by name, and the pages that it makes."""
    for python in pythons:
        name = f"Python {said(python, VERSION).replace(' ', ', numpy ')}"
        yield name, run(python, {}, decks)
        features = said(python, FEATURES).split()
        for feature in [*features, " ".join(features)] if len(features) > 1 else features:
            yield (
                f"{name} without {feature}",
                run(python, {"NPY_DISABLE_CPU_FEATURES": feature}, decks),
            )
    yield "the C library without FMA", run(pythons[0], {"GLIBC_TUNABLES": OLD_LIBM}, decks)
    for units in (1, 4):
        for seed in (1, 2, 3):
            name = f"values moved by up to {units} units in the last place, seed {seed}"
            yield name, run(pythons[0], {}, decks, seed, units)


def said(python: str, script: str) -> str:
    """What an interpreter prints."""
    return subprocess.run(
        [python, "-c", script], check=True, capture_output=True, text=True
    ).stdout.strip()


def run(python: str, settings: dict[str, str], decks: Path, seed: int = 0, units: int = 0) -> Pages:
    """The pages of all frames of all decks, made by another process."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        command = [python, __file__, "--decks", decks, "--pages", str(seed), str(units), out.name]
        environment = os.environ | {"PYTHONPATH": str(ROOT)} | settings
        subprocess.run(command, check=True, env=environment)
        pages: Pages = json.loads(out.read())
    return pages


def pages_of(decks: Path) -> Pages:
    """The page of every frame of every deck of a folder."""
    found: Pages = {}
    for one in solve_decks(map(str, sorted(decks.rglob("*.dat")))):
        if isinstance(one, SolvedJob):
            for k, converged in enumerate(one.results.converged.tolist()):
                page = b"".join(frame_pages(one.results, k, k + 1)).decode()
                found[f"{one.source} {one.number} {k}"] = converged, page
    return found


def moved(plain: Pages, pages: Pages) -> str:
    """How many digits differ, by field, in frames that converged and in others."""
    counts: dict[bool, Counter[str]] = {True: Counter(), False: Counter()}
    frames = {True: 0, False: 0}
    for where, (converged, page) in plain.items():
        other = pages[where][1]
        frames[converged] += other != page
        for one in compare_listings(page, other, 0).differences if other != page else ():
            length = max(len(one.expected), len(one.actual))
            pairs = zip(one.expected.rjust(length), one.actual.rjust(length), strict=True)
            counts[converged][one.field or one.kind] += sum(a != b for a, b in pairs)
    told = []
    for converged, name in ((True, "that converged"), (False, "that did not converge")):
        fields = ", ".join(f"{field} {n}" for field, n in counts[converged].items())
        told.append(f"{counts[converged].total()} in {frames[converged]} frames {name}")
        told[-1] += f" ({fields})" if fields else ""
    return "; ".join(told)


def generated(folder: Path) -> Path:
    """The sample decks, and a thousand generated ones, in a folder."""
    from tests.test_generated_decks import DECKS, deck

    for path in (ROOT / "decks").glob("*/*.dat"):
        (folder / path.name).write_bytes(path.read_bytes())
    for seed in range(DECKS):
        (folder / f"{seed}.dat").write_bytes(deck(seed))
    return folder


if __name__ == "__main__":
    main()
