"""Approve what the cases of tests/approved print now: `python -m tests.approved.update`.

With --texts: what the program says in tests of the library, of all or of the files and tests named.

Words are rewritten. A number beyond its tolerance, a changed number of rows, a file that is
new or missing is refused unless --numbers names the case; a changed status always: it
stands in the case. The summary is meant for the message of the commit.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import warnings
from collections.abc import Iterable, Sequence
from fnmatch import fnmatch
from pathlib import Path

import pytest

from tests.approved.approved import GROUPS, Group
from tests.approved.cases import HERE, Case, Outcome, run_case
from tests.approved.compare import compare
from tests.approved.store import Outputs
from tests.approved.texts import (
    COLLECTED,
    Test,
    Texts,
    heading,
    module_of,
    read_texts,
    texts_file,
    write_texts,
)
from tests.kit.command import ROOT

TEXTS = HERE / "texts"


def refusals(case: Case, outcome: Outcome, expected: Outputs, numbers: bool) -> list[str]:
    """List the differences that may not be approved.

    Args:
        numbers: whether numbers, rows and files of this case may change
    """
    found = []
    if case.statuses is not None and outcome.statuses != case.statuses:
        found.append(f"status {_list(outcome.statuses)}, the case has {_list(case.statuses)}")
    if numbers:
        return found
    for name in sorted(expected.keys() - outcome.outputs.keys()):
        found.append(f"{name} is no longer written")
    for name in sorted(outcome.outputs.keys() - expected.keys()):
        found.append(f"{name} is new")
    for name in sorted(expected.keys() & outcome.outputs.keys()):
        for difference in compare(expected[name], outcome.outputs[name]):
            if difference.kind != "text":
                found.append(f"{name}: {difference.what}")
    return found


def update(
    group: Group, only: Sequence[str] = ("*",), numbers: Sequence[str] = ()
) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """Run cases and write the outputs that may be approved.

    Args:
        only: names of the cases; * stands for any part of a name
        numbers: names of cases whose numbers may change

    Returns: names of cases by what was done (new, texts, numbers), and what was refused by case.
    """
    done: dict[str, list[str]] = {"new": [], "texts": [], "numbers": []}
    refused = {}
    for case in group.cases:
        if not any(fnmatch(case.name, one) for one in only):
            continue
        expected = group.store.read(case.name)
        with tempfile.TemporaryDirectory() as place:
            outcome = run_case(case, Path(place))
        named = expected is None or any(fnmatch(case.name, one) for one in numbers)
        if found := refusals(case, outcome, expected or {}, named):
            refused[case.name] = found
        elif expected is None or _differs(expected, outcome.outputs):
            beyond = expected is not None and refusals(case, outcome, expected, False)
            done["new" if expected is None else "numbers" if beyond else "texts"].append(case.name)
            group.store.write(case.name, outcome.outputs)
    return done, refused


def _differs(expected: Outputs, outputs: Outputs) -> bool:
    """Tell whether anything beyond tolerated digits is different: noise is not written anew."""
    return expected.keys() != outputs.keys() or any(
        compare(text, outputs[name]) for name, text in expected.items()
    )


def _list(statuses: Iterable[int]) -> str:
    return ", ".join(map(str, statuses))


def moved_numbers(approved: Sequence[str], said: Sequence[str]) -> list[str]:
    """List the numbers of a test's texts that are beyond their tolerance, or no longer there.

    A text that is new, after the others, may have any.
    """
    if len(said) < len(approved):
        return [f"{len(approved)} texts, now {len(said)}"]
    return [
        difference.what
        for was, now in zip(approved, said, strict=False)
        for difference in compare(was, now)
        if difference.kind != "text"
    ]


def merged(
    approved: Texts, tests: Iterable[Test], there: Sequence[str], numbers: Sequence[str] = ()
) -> tuple[Texts, dict[str, list[str]], dict[str, list[str]]]:
    """Put the texts of the tests that ran into those of their module.

    Args:
        there: headings of all tests of the module, in their order; texts of others are removed
        numbers: headings whose numbers may change; * stands for any part

    Returns: the texts, headings by what was done (new, texts, numbers, removed), and refusals.
    """
    said = {test.heading: test.said for test in tests}
    done: dict[str, list[str]] = {"new": [], "texts": [], "numbers": [], "removed": []}
    refused = {}
    texts = {}
    done["removed"] += [name for name in approved if name not in there]
    for name in there:
        was, now = approved.get(name, []), said.get(name)
        found = [] if now is None else moved_numbers(was, now)
        if found and not any(fnmatch(_plain(name), _plain(one)) for one in numbers):
            refused[name] = found
            now = None
        if now is None or (len(was) == len(now) and not any(map(compare, was, now))):
            now = was
        elif now:
            done["numbers" if found else "texts" if was else "new"].append(name)
        else:
            done["removed"].append(name)
        if now:
            texts[name] = now
    return texts, done, refused


def _plain(heading: str) -> str:
    """Take brackets for themselves, which a pattern of fnmatch does not."""
    return heading.replace("[", "<").replace("]", ">")


class Collected:
    """A plugin of pytest that collects the texts of the tests that pass."""

    def __init__(self) -> None:
        self.there: dict[str, list[str]] = {}
        self.tests: list[Test] = []
        self.failed: list[str] = []

    def pytest_configure(self, config: pytest.Config) -> None:
        config.stash[COLLECTED] = self.tests

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        for item in items:
            if isinstance(item, pytest.Function):
                self.there.setdefault(module_of(item), []).append(heading(item))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.failed.append(report.nodeid)


def update_texts(
    only: Sequence[str], numbers: Sequence[str]
) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """Run tests and write the texts that may be approved.

    Args:
        only: files of tests, and tests in them; nothing stands for all files that have texts

    Returns: headings by what was done, and what was refused by heading.
    """
    names = only or [
        path.relative_to(ROOT).as_posix()
        for path in sorted((ROOT / "tests").rglob("test_*.py"))
        if "tests.approved.texts" in path.read_text(encoding="utf-8")
    ]
    collected = Collected()
    pytest.main(
        [*names, "-o", "addopts=-q", "-p", "no:cacheprovider", "--continue-on-collection-errors"],
        plugins=[collected],
    )
    done: dict[str, list[str]] = {"new": [], "texts": [], "numbers": [], "removed": []}
    refused = {name: ["failed"] for name in collected.failed}
    for module, there in collected.there.items():
        path = texts_file(module)
        approved = read_texts(path)
        if any("::" in name for name in only):  # of the others nothing is known
            there = [*approved, *(name for name in there if name not in approved)]
        ran = [test for test in collected.tests if test.module == module]
        texts, of_module, bad = merged(approved, ran, there, numbers)
        write_texts(path, texts)
        for what, headings in of_module.items():
            done[what] += [f"{module}::{name}" for name in headings]
        refused |= {f"{module}::{name}": found for name, found in bad.items()}
    for path in sorted(TEXTS.rglob("*.txt")) if not only else []:
        if not (module := module_with_texts(path)).exists():
            done["removed"].append(module.relative_to(ROOT / "tests").as_posix())
            path.unlink()
    return done, refused


def module_with_texts(path: Path) -> Path:
    """Name the test module of a file of texts."""
    inside = path.relative_to(TEXTS)
    return ROOT / "tests" / inside.with_name(f"test_{inside.stem}.py")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.approved.update", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("case", nargs="*", help="which cases; * stands for any part")
    parser.add_argument("--numbers", action="append", default=[], metavar="CASE")
    parser.add_argument("--texts", action="store_true", help="of tests; CASE is a file or test")
    asked = parser.parse_args(arguments)
    warnings.simplefilter("error")
    failed = False
    for name in ["texts"] if asked.texts else GROUPS:
        if asked.texts:
            done, refused = update_texts(asked.case, asked.numbers)
        else:
            done, refused = update(GROUPS[name](), asked.case or ["*"], asked.numbers)
        for what, names in done.items():
            if names:
                print(f"{name}: {what} ({len(names)}): {', '.join(names)}")
        for case, found in refused.items():
            print(f"refused: {case}", *found[:5], *(["..."] if found[5:] else []), sep="\n    ")
        failed |= bool(refused)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
