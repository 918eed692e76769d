"""Count the size of the package and of its tests; the table stands in docs/architecture.md.

python tools/size.py            # print the table
python tools/size.py --write    # and put it into docs/architecture.md
"""

from __future__ import annotations

import argparse
import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = "docs/architecture.md"
FLIGHT = "examples/hill/flight.toml"
CARD_ROOMS = ("cards", "program")
BEGIN, END = "<!-- size -->", "<!-- end of size -->"

AIMS = (  # a count; before the package became half as many files (22 November 2026); its aim
    ("files of the package", "404", "150"),
    ("lines of the package", "40,314", "30,000"),
    ("records (NamedTuple, dataclass, TypedDict)", "240", "80"),
    ("import lines, % of the package's lines of code", "13.7", "9"),
    (f"modules of the package that `vopd attitude {FLIGHT}` loads", "195", "80"),
    ("... of them of `cards/` and `program/`", "33", "0"),
    ("sentences of the package that stand in a .py of the tests, %", "75", "5"),
    ("private names that tests import", "79", "20"),
    ("files of the tests in Python", "495", "280"),
    ("lines of the tests in Python", "68,076", "50,000"),
    ("function docstrings that begin with a verb, %", "19 (23 by this rule)", "70"),
)

VERBS = """
abort accept accumulate add adjust advance advise align allocate allow announce answer append
apply approximate arrange ask assemble assert assign attach average balance begin bin bind blend
bound bracket break bring broadcast build cache calculate call cancel cast catch center change
check choose clamp classify clean clear clip close collapse collect combine compare compile
complete compose compress compute concatenate condense confirm connect construct consume continue
convert copy correct count cover create cut deal decide declare decode decompose decrease deduce
define delete deliver demand derive describe detect determine differentiate discard display
distort distribute divide drain draw drop edit embed emit empty encode end enforce ensure enter
enumerate escape estimate evaluate exchange exclude execute expand expect explain export express
extend extract factor fall fetch fill filter find finish fit fix flag flatten flip flush fold
follow forget format gather generate get give go group guard guess guide halve handle hash help
hide hold identify ignore import improve include increase indent infer inform initialise insert
inspect integrate interpolate intersect introduce invert invoke iterate join keep label launch lay
lead leave let light limit linearise link list load locate lock log look lower make map mark mask
match measure merge minimise mirror modify move multiply name narrow negate normalise note notice
number obtain offer omit open orient pack pad page parse partition pass paste patch perform
permute pick place plan plot point prefer prepare present preserve print process produce project
propagate propose prove pull punch push put quantify query quote raise rank read rearrange rebuild
receive recognise recompute reconstruct record recover reduce refer refine refuse register reject
release relate remember remove rename render reorder repair repeat replace report represent
request require rescale reset reshape resolve respond restart restore restrict retain retry return
reverse rewrite rotate round route run sample save say scale scan score search select send
separate serialise set settle shade shape share shift shorten show shrink sign simplify simulate
skip slice smooth solve sort space speak specify spell split spread square stack start state step
stop store strip subtract suggest sum summarise supply suppress swap switch synchronise tabulate
tag take tell terminate test tilt total trace track train transfer transform translate transpose
treat trim try turn undo unfold unite unpack update upgrade use validate vary verify view visit
wait walk warn wash weigh weight widen work wrap write yield zero
"""
"""Verbs in the imperative: the first word of a docstring counts if it is one of these."""
NOUN_BEFORE = ("of", "and", "or", "is", "are", "with", "in", "by")
"""A first word before one of these is a noun: "Name of ...", "Report and ...", and "Group 9"."""
NOUN_TOO = """
name number place mark order cost report point sum index page record space plan group format list
test label scale shape state step total track weight sample score search sign square stack view
limit note offset cut end answer use work look run cover bound display drop fall fit fix flag hash
help link map mask match measure pick plot process query quote rank request set share shift slice
split spread start stop store switch transfer transform change check call cast cache count copy
draw edit average balance exchange
"""
"""Of the verbs, those that are nouns too, for which the word after them decides."""


def sources(folder: Path) -> list[Path]:
    """List the Python files below a folder."""
    return sorted(folder.rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    """Parse a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def lines(paths: Iterable[Path]) -> int:
    """Count the lines of files."""
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in paths)


def records(paths: Iterable[Path]) -> int:
    """Count the classes that are a NamedTuple, a dataclass or a TypedDict.

    A plain dict with fixed keys looks like any other and is not counted.
    """
    kinds = {"NamedTuple", "dataclass", "TypedDict"}
    found = 0
    for path in paths:
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef):
                parts = [*node.bases, *node.decorator_list]
                names = {
                    name.attr if isinstance(name, ast.Attribute) else getattr(name, "id", "")
                    for name in (n.func if isinstance(n, ast.Call) else n for n in parts)
                }
                found += bool(names & kinds)
    return found


def documented(path: Path) -> Iterator[tuple[ast.AST, ast.Constant]]:
    """Iterate over the strings that are statements: docstrings, each with its parent."""
    for node in ast.walk(tree(path)):
        for child in ast.iter_child_nodes(node):
            value = child.value if isinstance(child, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield node, value


def import_share(paths: Iterable[Path]) -> float:
    """Divide the lines of import statements by those of code, in percent.

    Code is what is neither blank nor a comment nor a docstring.
    """
    imported = code = 0
    for path in paths:
        text = path.read_text(encoding="utf-8").splitlines()
        prose = {
            number
            for _, string in documented(path)
            for number in range(string.lineno, (string.end_lineno or 0) + 1)
        }
        code += sum(
            bool(line.strip()) and not line.lstrip().startswith("#") and number not in prose
            for number, line in enumerate(text, 1)
        )
        imported += sum(
            (node.end_lineno or node.lineno) - node.lineno + 1
            for node in ast.walk(tree(path))
            if isinstance(node, ast.Import | ast.ImportFrom)
        )
    return 100.0 * imported / max(code, 1)


def loaded(root: Path, flight: str = FLIGHT) -> list[str]:
    """List the modules of the package that `vopd attitude` loads for a flight."""
    program = (
        "import sys, os\n"
        f"sys.argv = ['vopd', 'attitude', '-q', {flight!r}, '-o', os.devnull, '--format', 'csv']\n"
        "from vopd.cli import cli\n"
        "try: cli()\n"
        "except SystemExit as end: assert not end.code, end.code\n"
        "print(*(name for name in sys.modules if name.split('.')[0] == 'vopd'))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=root, capture_output=True, text=True, check=True
    )
    return run.stdout.splitlines()[-1].split()


def texts(path: Path) -> set[str]:
    """List the string literals of a file without its docstrings, white space made one blank.

    Of an f-string each piece between its fields is one.
    """
    prose = {id(string) for _, string in documented(path)}
    return {
        " ".join(node.value.split())
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose
    }


def repeated_sentences(package: Iterable[Path], tests: Iterable[Path]) -> float:
    """Divide the sentences of the package that stand in a test by all of them, in percent.

    A sentence is a string literal of four words or more, with blanks between: names of columns
    and addresses are none. It stands in a test if it is part of one of the test's string
    literals. Docstrings are neither.
    """

    def is_sentence(text: str) -> bool:
        """Test whether a text has four words, each with two letters beside each other."""
        return sum(bool(re.search("[A-Za-z]{2}", word)) for word in text.split()) >= 4

    said = {text for path in package for text in texts(path) if is_sentence(text)}
    tested = "\n".join(text for path in tests for text in texts(path))
    return 100.0 * sum(text in tested for text in said) / max(len(said), 1)


def private_names(tests: Iterable[Path]) -> int:
    """Count the names with a leading underscore that tests import from the package."""
    return len(
        {
            (node.module, alias.name)
            for path in tests
            for node in ast.walk(tree(path))
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "vopd"
            for alias in node.names
            if alias.name.startswith("_") and not alias.name.startswith("__")
        }
    )


def begins_with_verb(docstring: str) -> bool:
    """Test whether the first word is one of `VERBS`, and not a noun in its place."""
    first, *rest = docstring.split()[:2] or [""]
    after = rest[0].lower() if rest else ""
    word = first.lower().rstrip(".:")
    follows = after.rstrip(",.;:")
    noun = word in NOUN_TOO.split() and (follows in NOUN_BEFORE or follows.isdigit())
    return word in VERBS.split() and not noun


def verb_share(paths: Iterable[Path]) -> float:
    """Divide the function docstrings that begin with a verb by all of them, in percent."""
    begins = [
        begins_with_verb(string.value)
        for path in paths
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        for string in [node.body[0].value if isinstance(node.body[0], ast.Expr) else None]
        if isinstance(string, ast.Constant) and isinstance(string.value, str)
    ]
    return 100.0 * sum(begins) / max(len(begins), 1)


def counts(root: Path) -> list[str]:
    """Count everything in `AIMS`, in its order."""
    package, tests = sources(root / "vopd"), sources(root / "tests")
    modules = loaded(root)
    of_cards = [name for name in modules if (name + ".").split(".")[1] in CARD_ROOMS]
    return [
        f"{len(package):,}",
        f"{lines(package):,}",
        f"{records(package):,}",
        f"{import_share(package):.1f}",
        f"{len(modules):,}",
        f"{len(of_cards):,}",
        f"{repeated_sentences(package, tests):.0f}",
        f"{private_names(tests):,}",
        f"{len(tests):,}",
        f"{lines(tests):,}",
        f"{verb_share(package):.0f}",
    ]


def table(now: Iterable[str]) -> str:
    """Format the table as Markdown."""
    rows = [
        f"| {what} | {before} | {value} | {aim} |"
        for (what, before, aim), value in zip(AIMS, now, strict=True)
    ]
    return "\n".join(["| | before | now | aim |", "|---|---|---|---|", *rows, ""])


def main() -> None:
    """Print the table, and put it into the page if asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--write", action="store_true", help=f"put the table into {PAGE}")
    parser.add_argument("--root", type=Path, default=ROOT, help="another checkout to count")
    given = parser.parse_args()
    made = table(counts(given.root))
    print(made, end="")
    if given.write:
        page = given.root / PAGE
        before, rest = page.read_text(encoding="utf-8").split(f"{BEGIN}\n")
        after = rest.split(END)[1]
        page.write_text(f"{before}{BEGIN}\n{made}{END}{after}", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
