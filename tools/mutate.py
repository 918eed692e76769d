"""Change the code in small ways, one at a time, and count the changes that the tests notice.

    python tools/mutate.py flight export --sample 20   # test some changes of two rooms
    python tools/mutate.py --write                     # docs/mutation.md from all results

The changes are those of cosmic-ray: another operator, comparison or number, a condition negated,
a decorator left out, a loop not entered. A room is tested by its own tests, in a copy of the
repository: first by the quickest of those that run the changed line. The changes that these do
not notice are made together and tested by all, and one by one only where a test fails. Which
changes are tested is fixed by `--seed`. Results are kept in a file, and a change that was noticed
is not tested again: a run that was stopped goes on, a larger sample adds to a smaller, and
survivors are tested again, with the tests that there are now.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.operators.operator import Operator
from cosmic_ray.plugins import get_operator, operator_names

ROOT = Path(__file__).parents[1]
PAGE, REASONS = ROOT / "docs" / "mutation.md", ROOT / "tools" / "mutation_reasons.toml"
MARKS = "<!-- results -->\n", "<!-- end of results -->\n"
LEFT_OUT = re.compile(
    r"NoOp|ExceptionReplacer|ComparisonOperator_\w+_(Is|IsNot)$"
    r"|BinaryOperator_\w+_(LShift|RShift|BitXor|FloorDiv|Mod)$"
    r"|BinaryOperator_(Add|Sub|Mul|Div|Pow|Mod|FloorDiv)_(BitOr|BitAnd)$"
)
"""Operators that make no sense of an expression: every test would notice them."""
MORE_TESTS = {
    "files": "tests/pipeline tests/check tests/film tests/figures tests/synthetic tests/attitude "
    "tests/cards tests/test_house.py tests/test_docs.py "
    "tests/pipeline/test_records.py tests/cli/test_errata.py "
    "tests/cli/test_output_files.py tests/cli/test_run.py tests/cli/test_signals.py",
    "export": "tests/export tests/stellar/test_file_sky.py",
    "cli": "tests/cli tests/convert/test_flight_to_deck.py tests/figures/test_figures.py "
    "tests/stellar/test_command.py tests/stellar/test_file_sky.py "
    "tests/convert/test_deck_to_flight.py tests/compare/test_undetermined.py",
    "listing": "tests/listing tests/compare",
    "geometry": "tests/geometry tests/attitude tests/flight tests/stellar",
}
"""The tests of rooms that have not only those of the folder of their name."""
FIRST_S = 10.0
"""How long the tests that run a changed line may take together, before all tests of the room."""


class Mutant(NamedTuple):
    """A change: the file, the line, the line before and after, and the file's text after."""

    path: str
    line: int
    before: str
    after: str
    text: str

    @property
    def key(self) -> str:
        """What names this change of this version of the file."""
        return hashlib.sha256(f"{self.path}\n{self.text}".encode()).hexdigest()[:16]


def rooms() -> dict[str, list[Path]]:
    """The modules of every room; `files` are those of no folder."""
    found = defaultdict(list)
    for path in sorted((ROOT / "vopd").rglob("*.py")):
        parts = path.relative_to(ROOT / "vopd").parts
        found[parts[0] if len(parts) > 1 else "files"].append(path)
    return dict(found)


def sample(room: str, count: int, seed: int) -> list[Mutant]:
    """The first changes of a room in an order that the seed fixes, each at another place."""
    places = [place for path in rooms()[room] for place in places_of(path)]
    chance = random.Random(f"{seed} {room}")
    chance.shuffle(places)
    chosen: list[Mutant] = []
    for path, at, possible in places:
        if len(chosen) == count:
            break
        name, occurrence = chance.choice(possible)
        mutant = made(path, at, name, occurrence)
        if mutant is not None:
            chosen.append(mutant)
    return chosen


@cache
def operators() -> dict[str, Operator]:
    """The operators of cosmic-ray that need no setting, by name."""
    kinds = {name: get_operator(name) for name in operator_names() if not LEFT_OUT.search(name)}
    return {name: kind() for name, kind in kinds.items() if not kind.arguments()}


Place = tuple[Path, tuple[int, int], list[tuple[str, int]]]


def places_of(path: Path) -> Iterator[Place]:
    """Where a file can be changed: line and column, and the operators that can change it there."""
    tree = get_ast(path.read_text(encoding="utf-8"))
    found: dict[tuple[int, int], list[tuple[str, int]]] = defaultdict(list)
    seen: Counter[str] = Counter()
    for node in ast_nodes(tree):
        for name, operator in operators().items():
            for start, _ in operator.mutation_positions(node):
                found[start].append((name, seen[name]))
                seen[name] += 1
    for at in sorted(found):
        yield path, at, found[at]


def made(path: Path, at: tuple[int, int], name: str, occurrence: int) -> Mutant | None:
    """The changed file; None where no code is changed, or what is made of it is none."""
    text = path.read_text(encoding="utf-8")
    changed = mutate_code(text, get_operator(name)(), occurrence)
    try:
        if changed is None or meaning(changed) == meaning(text):
            return None
    except SyntaxError:  # of a comma that a change has nothing before
        return None
    old, new = text.splitlines(), changed.splitlines()
    row = next(k for k, (one, other) in enumerate(zip(old, new, strict=False)) if one != other)
    return Mutant(
        path.relative_to(ROOT).as_posix(), at[0], old[row].strip(), new[row].strip(), changed
    )


def meaning(text: str) -> str:
    """A file without what no run depends on: annotations of functions, and docstrings."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        elif isinstance(node, ast.arg):
            node.annotation = None
        elif isinstance(node, ast.AnnAssign):
            node.annotation = ast.Name("object")
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            node.value = ast.Constant(None)
    return ast.dump(tree)


def passes_with(
    copy: Path, mutants: list[Mutant], tests: list[str], timeout_s: float | None
) -> bool:
    """Whether some tests pass in a copy of the repository with changes; too slow is not."""
    for one in mutants:
        (copy / one.path).write_text(one.text, encoding="utf-8")
    try:
        return pytest(copy, ["-x", *tests], timeout_s).returncode == 0
    except subprocess.TimeoutExpired:
        return False
    finally:
        for one in mutants:
            shutil.copy(ROOT / one.path, copy / one.path)


def of_different_files(mutants: list[Mutant]) -> list[list[Mutant]]:
    """The changes in groups that can be made at the same time, one of each file."""
    groups: list[list[Mutant]] = []
    for one in mutants:
        free = [group for group in groups if one.path not in {other.path for other in group}]
        if free:
            free[0].append(one)
        else:
            groups.append([one])
    return groups


def note(results: Path, room: str, one: Mutant, survived: bool) -> None:
    """Add a change to the results."""
    row = one._asdict() | {"room": room, "survived": survived, "key": one.key}
    del row["text"]
    with results.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
    print("survived" if survived else "noticed ", f"{one.path}:{one.line}: {one.after}")


def pytest(
    copy: Path, given: list[str], timeout_s: float | None = None
) -> subprocess.CompletedProcess[str]:
    """Run pytest in one process in a copy of the repository."""
    command = [sys.executable, "-m", "pytest", "-n", "0", "-q", "-p", "no:cacheprovider", *given]
    environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        command, cwd=copy, env=environment, capture_output=True, text=True, timeout=timeout_s
    )


class Coverage(NamedTuple):
    """Which tests of a room run which lines, and how long each test takes."""

    lines: dict[str, dict[int, set[str]]]
    seconds: dict[str, float]

    def first(self, mutant: Mutant) -> list[str]:
        """The quickest tests that run the changed line, or its file where none runs the line."""
        lines = self.lines.get(mutant.path, {})
        above = [line for line in sorted(lines) if mutant.line - 4 <= line <= mutant.line]
        tests = lines[above[-1]] if above else set().union(*lines.values())
        tests = {test for test in tests if test in self.seconds}
        quickest = sorted(tests, key=lambda test: (self.seconds[test], test))
        until = accumulate(self.seconds[test] for test in quickest)
        return [test for test, end in zip(quickest, until, strict=True) if end <= FIRST_S]


def coverage_of(copy: Path, room: str) -> Coverage:
    """Run the tests of a room once, without any change, and note which lines each runs."""
    cover = ["--cov=vopd", "--cov-context=test", "--cov-report=", "--durations=0"]
    done = pytest(copy, [*cover, "--durations-min=0", "-o", "addopts=", *tests_of(room)])
    if done.returncode:
        raise SystemExit(f"{room}: its tests fail without any change\n{done.stdout[-3000:]}")
    seconds: dict[str, float] = defaultdict(float)
    for took, test in re.findall(r"(?m)^([\d.]+)s (?:setup|call) +(.+?) *$", done.stdout):
        seconds[test] += float(took)
    report = [sys.executable, "-m", "coverage", "json", "--show-contexts", "-q", "-o", "lines.json"]
    subprocess.run(report, cwd=copy, check=True)
    files = json.loads((copy / "lines.json").read_text(encoding="utf-8"))["files"]
    lines = {
        path: {
            int(line): {context.split("|")[0] for context in contexts if context}
            for line, contexts in file["contexts"].items()
            if any(contexts)
        }
        for path, file in files.items()
    }
    return Coverage(lines, seconds)


def tests_of(room: str) -> list[str]:
    return MORE_TESTS.get(room, f"tests/{room}").split()


def test_rooms(names: list[str], count: int, seed: int, seconds: float, results: Path) -> None:
    """Test the sample of some rooms until the time is over, and add to the results."""
    end = time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve() / "copy"
        listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
        for name in listed.stdout.splitlines():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
        for room in names:
            known = {key for key, row in read(results).items() if not row["survived"]}
            mutants = [one for one in sample(room, count, seed) if one.key not in known]
            if not mutants:
                continue
            began = time.monotonic()
            coverage = coverage_of(copy, room)
            timeout_s = 3.0 * (time.monotonic() - began) + 20.0
            unnoticed: list[Mutant] = []
            for one in mutants:
                if time.monotonic() > end:
                    print("the time is over: run this again to go on")
                    return
                first = coverage.first(one)
                if not first or passes_with(copy, [one], first, timeout_s):
                    unnoticed.append(one)
                else:
                    note(results, room, one, survived=False)
            for group in of_different_files(unnoticed):
                together = len(group) > 1 and passes_with(copy, group, tests_of(room), timeout_s)
                for one in group:
                    survived = together or passes_with(copy, [one], tests_of(room), timeout_s)
                    note(results, room, one, survived)


def read(results: Path) -> dict[str, dict[str, object]]:
    """All results by the changes' keys; the last one counts."""
    lines = results.read_text(encoding="utf-8").splitlines() if results.exists() else []
    return {row["key"]: row for row in map(json.loads, lines)}


def page(results: Path) -> str:
    """The table of scores, and the survivors with their reasons."""
    rows = list(read(results).values())
    reasons = tomllib.loads(REASONS.read_text(encoding="utf-8"))
    survivors = [row for row in rows if row["survived"]]
    why = {row["key"]: reasons.get(f"{row['path']}: {row['after']}", "") for row in survivors}
    lines = ["| room | changes | noticed | no difference | score |", "|---|---|---|---|---|"]
    for room in [*sorted({str(row["room"]) for row in rows}), "all"]:
        some = [row for row in rows if room in (row["room"], "all")]
        alive = [row for row in some if row["survived"]]
        noticed = len(some) - len(alive)
        same = sum(why[row["key"]].startswith("no difference") for row in alive)
        score = 100.0 * noticed / max(len(some) - same, 1)
        lines.append(f"| {room} | {len(some)} | {noticed} | {same} | {score:.0f} % |")
    lines += ["", "Changes that no test noticed:", ""]
    for row in sorted(survivors, key=lambda row: str(row["path"])):
        told = why[row["key"]] or "not looked at yet"
        lines.append(f"- `{row['path']}`: `{row['before']}` became `{row['after']}`: {told}")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rooms", nargs="*", help="folders of vopd, or files; by default all")
    parser.add_argument("--sample", type=int, default=20, help="changes of each room")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="end after this time")
    parser.add_argument("--results", type=Path, default=ROOT / "mutation.jsonl")
    parser.add_argument("--write", action="store_true", help="write docs/mutation.md, test nothing")
    given = parser.parse_args()
    if given.write:
        before, _, rest = PAGE.read_text(encoding="utf-8").partition(MARKS[0])
        _, _, after = rest.partition(MARKS[1])
        PAGE.write_text(
            before + MARKS[0] + page(given.results) + MARKS[1] + after, encoding="utf-8"
        )
        return
    unknown = set(given.rooms) - rooms().keys()
    if unknown:
        parser.error(f"no such room: {', '.join(unknown)}; there are {', '.join(rooms())}")
    test_rooms(given.rooms or list(rooms()), given.sample, given.seed, given.seconds, given.results)


if __name__ == "__main__":
    main()
