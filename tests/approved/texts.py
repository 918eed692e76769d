"""Texts of the program in tests of the library: each test's stand in a file of `texts/`.

A test calls `assert_approved` on what the program says, or catches an error by `refused`. Its texts
in their order stand under its name in the file of its module; `python -m tests.approved.update
--texts` writes them. A test fails unless it comes to each of its texts, and to no other.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import pytest

from tests.approved.cases import HERE, normalised
from tests.approved.compare import compare
from tests.kit.command import ROOT
from vopd.findings import Finding, VopdError
from vopd.version import __version__ as vopd_version

UPDATE = "python -m tests.approved.update --texts"
SHORT_ID = re.compile(r"[\w.+, /=-]{1,40}")
"""Parameters that a heading names; of others, such as a long input, it has their place from 0."""

OF_THE_SYSTEM = ("Is a directory", "Not a directory", "Permission denied")
"""Why a system does not open a file, which is another reason on another system."""

Texts = dict[str, list[str]]
"""Texts of a module by the heading of their test."""


@dataclass
class Test:
    """A test that runs: the texts approved for it, and those that it has come to.

    Attributes:
        module: its path from the folder of tests
        heading: its name in that module, with its parameters
        approved: None where nothing is approved for it
        is_updated: whether texts are collected and not compared
        temporary: the folder of temporary folders
    """

    __test__ = False
    module: str
    heading: str
    approved: list[str] | None
    is_updated: bool = False
    temporary: Path | None = None
    said: list[str] = field(default_factory=list)

    def compare(self, text: str) -> None:
        """Compare a text with the next of this test.

        Raises:
            AssertionError: it differs, or none is approved
        """
        self.said.append(text)
        if self.is_updated:
            return
        update = f"{UPDATE} tests/{self.module}"
        if self.approved is None:
            raise AssertionError(f"no text is approved for {self.heading}: {update}\n{text}")
        if len(self.said) > len(self.approved):
            raise AssertionError(f"no text {len(self.said)} of it is approved: {update}\n{text}")
        expected = self.approved[len(self.said) - 1]
        if found := compare(expected, text):
            differences = "\n".join(one.what for one in found)
            raise AssertionError(f"not as approved:\n{text}\napproved:\n{expected}\n{differences}")

    def finish(self) -> None:
        """Raise an AssertionError unless the test came to every text that is approved for it."""
        if not self.is_updated and self.approved and len(self.said) < len(self.approved):
            left = self.approved[len(self.said) :]
            raise AssertionError(f"not come to: {left}; or {UPDATE} tests/{self.module}")


RUNNING: list[Test] = []
"""The test that runs; the last one where a test runs another."""


def assert_approved(value: object, *, parts: Iterable[object] = (), others_after: str = "") -> None:
    """Fail unless what the program says is approved for the test that runs.

    Args:
        value: a text; of a list or dict each part is a line
        parts: numbers and names in it that the test works out by itself, in their order
        others_after: words after which another package goes on in its own
    """
    test = RUNNING[-1]
    text = as_text(value)
    end = 0
    for part in map(str, parts):
        at = text.find(part, end)
        assert at >= 0, f"{part!r} is not in: {text[end:]}"
        end = at + len(part)
    text = without_place(text, test.temporary)
    if others_after:
        before, found, _ = text.partition(others_after)
        assert found, f"{others_after!r} is not in: {text}"
        text = f"{before}{found}..."
    test.compare(text)


@contextmanager
def refused(
    kind: type[BaseException] = VopdError, *, parts: Iterable[object] = (), others_after: str = ""
) -> Iterator[pytest.ExceptionInfo[BaseException]]:
    """Fail unless an error is raised whose text is approved for the test that runs."""
    with pytest.raises(kind) as error:
        yield error
    assert_approved(str(error.value), parts=parts, others_after=others_after)


def as_text(value: object) -> str:
    """Format a value: a line for each part of a list or dict, parts of those beside each other."""
    if isinstance(value, Mapping):
        return "\n".join(f"{key}: {_line(part)}" for key, part in value.items())
    if isinstance(value, list | tuple) and type(value).__str__ in (list.__str__, tuple.__str__):
        return "\n".join(map(_line, value))
    return _line(value)


def _line(value: object) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{key}: {_line(part)}" for key, part in value.items())
    if isinstance(value, list | tuple) and type(value).__str__ in (list.__str__, tuple.__str__):
        return " | ".join(map(_line, value))
    if isinstance(value, Finding):
        return f"{value.severity}: {value}"
    return str(value)


def without_place(text: str, temporary: Path | None) -> str:
    """Replace what differs from place to place: folders, the version, hashes; control characters.

    Args:
        temporary: the folder of temporary folders, of which each becomes FOLDER
    """
    if temporary is not None:
        text = re.sub(re.escape(f"{temporary}{os.sep}") + r"[\w.-]+", "FOLDER", text)
    text = normalised(text, ROOT).replace("FOLDER" + os.sep, "FOLDER/")
    text = re.sub(rf"(?<![\w.]){re.escape(vopd_version)}(?![\w.])", "VERSION", text)
    text = re.sub(f": ({'|'.join(OF_THE_SYSTEM)})$", ": (the system's words)", text, flags=re.M)
    return re.sub(r"[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]", lambda m: ascii(m[0])[1:-1], text)


def heading(item: pytest.Function) -> str:
    """Name a test in the file of its module."""
    callspec = getattr(item, "callspec", None)
    if callspec is None:
        return item.originalname
    name = callspec.id if SHORT_ID.fullmatch(callspec.id) else ""
    return f"{item.originalname}[{name or '#' + '-'.join(map(str, callspec.indices.values()))}]"


def texts_file(module: str, place: Path = HERE / "texts") -> Path:
    """Name the file of a test module, which is named from the folder of tests."""
    return place / Path(module).with_name(Path(module).stem.removeprefix("test_") + ".txt")


@cache
def read_texts(path: Path) -> Texts:
    """Read the texts of a module: "- " before the first line of each, blanks before its others."""
    texts: Texts = {}
    said: list[str] = []
    for line in path.read_bytes().decode().split("\n")[:-1] if path.exists() else []:
        if line.startswith("-"):
            said.append(line[2:])
        elif not line or line.startswith("  "):
            said[-1] += f"\n{line[2:]}"
        else:
            assert line not in texts, f"{path}: {line} stands there twice"
            said = texts[line] = []
    return texts


def write_texts(path: Path, texts: Texts) -> None:
    """Write the texts of a module; a file without any is removed."""
    read_texts.cache_clear()
    if not texts:
        path.unlink(missing_ok=True)
        return
    lines = []
    for name, said in texts.items():
        lines.append(name)
        for text in said:
            first, *more = text.split("\n")
            lines += [f"- {first}".rstrip(" ") if not first else f"- {first}"]
            lines += [f"  {line}" if line else "" for line in more]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(("\n".join(lines) + "\n").encode())


def module_of(item: pytest.Item) -> str:
    """Name the module of a test, from the folder of tests."""
    return item.path.relative_to(ROOT / "tests").as_posix()


def of_item(item: pytest.Function, is_updated: bool) -> Test:
    """Begin a test, with what is approved for it."""
    module, name = module_of(item), heading(item)
    said = read_texts(texts_file(module)).get(name)
    place = Path(item.config.stash[TEMPORARY]) if TEMPORARY in item.config.stash else None
    return Test(module, name, said, is_updated, place)


TEMPORARY = pytest.StashKey[str]()
COLLECTED = pytest.StashKey[list[Test]]()
"""Tests that have run, where texts are updated."""
