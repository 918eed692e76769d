"""Approve what the cases of tests/approved print now: `python -m tests.approved.update`.

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

from tests.approved.approved import GROUPS, Group
from tests.approved.cases import Case, Outcome, run_case
from tests.approved.compare import compare
from tests.approved.store import Outputs


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


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.approved.update", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("case", nargs="*", default=["*"], help="which cases; * stands for any part")
    parser.add_argument("--numbers", action="append", default=[], metavar="CASE")
    asked = parser.parse_args(arguments)
    warnings.simplefilter("error")
    failed = False
    for name, read in GROUPS.items():
        group = read()
        done, refused = update(group, asked.case, asked.numbers)
        for what, names in done.items():
            if names:
                print(f"{name}: {what} ({len(names)}): {', '.join(names)}")
        for case, found in refused.items():
            print(f"refused: {case}", *found[:5], *(["..."] if found[5:] else []), sep="\n    ")
        failed |= bool(refused)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
