"""Approved texts of tests: what fails, what is written, and that each has its test."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.approved import texts
from tests.approved.texts import (
    Test,
    as_text,
    assert_approved,
    heading,
    read_texts,
    without_place,
    write_texts,
)
from tests.approved.update import TEXTS, merged, module_with_texts
from tests.kit.command import ROOT
from vopd.findings import Finding

OTHERS: dict[str, list[str]] = {"new": [], "texts": [], "numbers": [], "removed": []}
FILES = ("tests/__init__.py", "tests/conftest.py", "tests/tolerances.py", "tests/kit/__init__.py",
         "tests/kit/command.py", "pyproject.toml")  # fmt: skip
MODULE = """
import pytest
from tests.approved.texts import assert_approved, refused

@pytest.mark.parametrize("text", ["short", "a longer\\ninput"])
def test_two(text, tmp_path):
    with refused(ValueError):
        raise ValueError(f"{tmp_path / 'a.txt'}: {text!r} is 2.5 ft")
    assert_approved(["one", ("two", 3)])

def test_one():
    assert_approved("0.123456789", others_after="0")
"""
TEXT = """\
test_two[short]
- FOLDER/a.txt: 'short' is 2.5 ft
- one
  two | 3
test_two[#1]
- FOLDER/a.txt: 'a longer\\ninput' is 2.5 ft
- one
  two | 3
test_one
- 0...
"""


def running(*approved: str) -> Test:
    return Test("room/test_a.py", "test_one", [*approved])


@pytest.mark.parametrize(
    ("approved", "said"),
    [
        (["a b"], ["a c"]),
        (["a 1"], ["a 2"]),
        (["a 1.2345678"], ["a 1.2346678"]),
        (["a"], []),
        (["a", "b"], ["a"]),
        (["a", "b"], ["b", "a"]),
        (["a"], ["a", "a"]),
        ([""], [" "]),
    ],
)
def test_what_fails(approved: list[str], said: list[str]) -> None:
    test = running(*approved)
    with pytest.raises(AssertionError):
        for text in said:
            test.compare(text)
        test.finish()


def test_what_passes() -> None:
    """Another last digit is another processor's."""
    test = running("a 1.2345678", "")
    test.compare("a 1.2345679")
    test.compare("")
    test.finish()


@pytest.mark.parametrize("parts", [["2"], ["1", "1"], ["3", "1"]])
def test_parts_that_a_test_works_out_are_in_the_text_in_their_order(
    parts: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(texts, "RUNNING", [running("1 by 3")])
    assert_approved("1 by 3", parts=[1, "3"])
    with pytest.raises(AssertionError, match="is not in"):
        assert_approved("1 by 3", parts=parts)


def test_findings_have_their_severity() -> None:
    assert as_text([Finding("bad", "a.dat", card=7, severity="warning")]) == (
        "warning: a.dat: card 7: bad"
    )


def test_a_test_without_texts_fails_with_the_command_that_writes_them() -> None:
    test = Test("room/test_a.py", "test_one", None)
    with pytest.raises(AssertionError, match=r"update --texts tests/room/test_a\.py"):
        test.compare("a")


def test_files_of_texts(tmp_path: Path) -> None:
    path = tmp_path / "room" / "a.txt"
    written = {"test_a": ["a", "", "\n", "- b\n\n  c\n", " "], "test_b[#1-2]": ["  d"]}
    write_texts(path, written)
    assert read_texts(path) == written
    write_texts(path, {})
    assert not path.exists() and read_texts(path) == {}


def test_parts_are_lines() -> None:
    parts = {"a": 1.5, "b": ["c", ("d", None)]}
    assert as_text(parts) == "a: 1.5\nb: c | d | None"
    assert as_text([parts, "e"]) == "a: 1.5; b: c | d | None\ne"


def test_places_and_control_characters(tmp_path: Path) -> None:
    text = f"{tmp_path / 'a'}, {ROOT / 'decks'}: \x1b[0m \r\n\udc80\t."
    assert without_place(text, tmp_path.parent) == (
        "FOLDER/a, FOLDER/decks: \\x1b[0m \\r\n\\udc80\t."
    )


@pytest.mark.parametrize(
    ("said", "what"),
    [
        (["a 1"], ""),
        (["b 1"], "texts"),
        (["a 1", "new 5"], "texts"),
        (["a 2"], "numbers"),
        (["a 1 1"], "numbers"),
        ([], "numbers"),
    ],
)
def test_only_words_are_written_unnamed(said: list[str], what: str) -> None:
    approved = {"test_a[x]": ["a 1"], "test_z": ["z"]}
    ran = [Test("", "test_a[x]", None, said=said)]
    there = ["test_a[x]"]
    kept, done, refused = merged(approved, ran, there)
    assert done == OTHERS | {"removed": ["test_z"]} | ({what: there} if what == "texts" else {})
    assert [*refused] == (there if what == "numbers" else [])
    assert kept == {"test_a[x]": ["a 1"] if what == "numbers" else said}
    kept, done, refused = merged(approved, ran, there, numbers=["test_a[[]*", "test_a[x*"])
    assert not refused and kept == ({"test_a[x]": said} if said else {})


def test_texts_of_a_new_test_and_of_one_that_did_not_run() -> None:
    approved = {"test_b": ["b"], "test_a": ["a"]}
    ran = [Test("", "test_new", None, said=["7"]), Test("", "test_none", None)]
    kept, done, refused = merged(approved, ran, ["test_a", "test_new", "test_none", "test_b"])
    assert list(kept.items()) == [("test_a", ["a"]), ("test_new", ["7"]), ("test_b", ["b"])]
    assert (done, refused) == (OTHERS | {"new": ["test_new"]}, {})


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True, check=False
    )


def test_from_the_update_to_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder of tests with one module."""
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, tmp_path / name)
    unneeded = shutil.ignore_patterns("test_*", "texts", "trials", "expected", "inputs")
    shutil.copytree(ROOT / "tests" / "approved", tmp_path / "tests" / "approved", ignore=unneeded)
    module = tmp_path / "tests" / "test_a.py"
    module.write_text(MODULE)
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{ROOT}" if sys.platform != "win32" else f"{ROOT}")
    tests = ("pytest", "-n", "0", "-p", "no:cacheprovider", "tests")
    done = run(tmp_path, "tests.approved.update", "--texts")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "texts: new (3): test_a.py::test_two[short], " in done.stdout
    kept = tmp_path / "tests" / "approved" / "texts" / "a.txt"
    assert kept.read_text() == TEXT
    kept.write_text(TEXT.replace("2.5 ft", "3.5 ft", 1).replace("0...", "0...\n- 1"))
    failed = run(tmp_path, *tests)
    assert failed.returncode == 1 and "2 failed, 1 passed" in failed.stdout
    refused = run(tmp_path, "tests.approved.update", "--texts")
    assert refused.returncode == 1 and "refused: test_a.py::test_two[short]" in refused.stdout
    assert "refused: test_a.py::test_one" in refused.stdout


def test_every_text_has_its_test(request: pytest.FixtureRequest) -> None:
    """Parameters are looked at where their tests are collected."""
    there: dict[Path, set[str]] = {}
    for item in request.session.items:
        if isinstance(item, pytest.Function):
            there.setdefault(item.path, set()).add(heading(item))
    named = any("::" in name for name in request.config.args)
    part = named or bool(request.config.option.keyword)
    for path in TEXTS.rglob("*.txt"):
        module = module_with_texts(path)
        assert module.exists(), f"{path.name} has texts of {module}, which is no longer there"
        source = ast.parse(module.read_text(encoding="utf-8"))
        functions = {one.name for one in ast.walk(source) if isinstance(one, ast.FunctionDef)}
        headings = {*read_texts(path)}
        lost = {name for name in headings if name.partition("[")[0] not in functions}
        lost |= headings - there[module] if module in there and not part else set()
        assert not lost, f"{path.name} has texts of tests that are no longer there: {lost}"
