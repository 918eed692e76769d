"""Which files a batch takes, in which order, and what it calls them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import refused
from vopd.batch.sources import IN_FOLDERS, OWN_FILES, BatchSource, check_names, find_sources
from vopd.findings import VopdError

FILES = (
    "b.dat", "a.deck", "A.CARDS", "sub/flight.toml", "sub/deep/c.dat", "note.txt", "table.csv",
    ".hidden.dat", ".git/d.dat", "sub/.cache/e.dat", "sub/dat", "none.dat.bak",
)  # fmt: skip


def place(folder: Path) -> Path:
    for name in FILES:
        (folder / "in" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "in" / name).write_text("x" * len(name))
    return folder


def found(folder: Path, *given: str, manifest: str | None = None) -> list[BatchSource]:
    return find_sources(given, manifest, str(folder / "out"), (".lst", ".csv"))


def test_a_folder_has_these_in_the_order_of_their_names(tmp_path: Path) -> None:
    """Hidden files, and what is in hidden folders, is left out; capitals come first."""
    home = place(tmp_path) / "in"
    sources = found(tmp_path, str(home))
    names = ["A.CARDS", "a.deck", "b.dat", "sub/deep/c.dat", "sub/flight.toml"]
    assert [one.path for one in sources] == [str(home / name) for name in names]
    assert [one.name for one in sources] == [name.rpartition(".")[0] for name in names]
    assert [one.size for one in sources] == [len(name) for name in names]
    assert [one.flight for one in sources] == [False] * 4 + [True]


def test_a_folder_in_a_folder_that_cannot_be_read_is_not_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home, scandir = place(tmp_path) / "in", os.scandir

    def closed(path: Any) -> Any:
        if str(path).endswith("deep"):
            raise PermissionError(13, "Permission denied", path)
        return scandir(path)

    monkeypatch.setattr(os, "scandir", closed)
    with refused(VopdError):
        found(tmp_path, str(home))


def test_the_order_is_that_of_the_names_however_they_are_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place(tmp_path) / "in")
    sources = found(tmp_path, "sub/*", "b.dat", "note.txt", "a.deck", "./b.dat")
    assert [one.name for one in sources] == ["a", "b", "dat", "flight", "note"]
    (tmp_path / "in" / "list").write_text("sub/deep/c.dat\n \n# note.txt\nb.dat\n../in/a.deck\n")
    sources = found(tmp_path, "note.txt", manifest="list")
    assert [one.name for one in sources] == ["a", "b", "note", "sub/deep/c"]
    assert found(tmp_path, "b.dat", "missing.dat")[1] == ("missing.dat", "missing", 0)


def test_a_pattern_names_from_the_first_wildcard_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place(tmp_path))
    for pattern, names in {
        "in/sub/**/*.dat": ["deep/c"], "in/**/c.dat": ["sub/deep/c"],
        "*/sub/*/c.*": ["in/sub/deep/c"],
        "in/[ab].d*": ["a", "b"], f"{tmp_path}/in/su?/f*": ["sub/flight"],
    }.items():  # fmt: skip
        assert [one.name for one in found(tmp_path, pattern)] == names
    (tmp_path / "x[1].dat").write_text("")
    assert [one.path for one in found(tmp_path, "x[1].dat")] == ["x[1].dat"]


@pytest.mark.parametrize("out", ["in", "in/sub", "in/new/out"])
def test_the_output_folder_is_apart_from_the_inputs(out: str, tmp_path: Path) -> None:
    home = place(tmp_path) / "in"
    with refused(VopdError):
        find_sources([str(home)], None, str(tmp_path / out), (".lst",))


def test_the_output_folder_has_no_input_in_it(tmp_path: Path) -> None:
    home = place(tmp_path) / "in"
    with refused(VopdError):
        find_sources([str(home / "sub/deep/c.dat")], None, str(home / "sub"), (".lst",))
    (tmp_path / "link").symlink_to(home)
    with refused(VopdError):
        find_sources([str(home)], None, str(tmp_path / "link" / "out"), (".lst",))
    for out in ("in2", "i", "out"):  # whose names only begin alike, or not
        assert find_sources([str(home)], None, str(tmp_path / out), (".lst",))


@pytest.mark.parametrize("name", OWN_FILES)
def test_the_batch_keeps_the_names_of_its_own_files(name: str) -> None:
    stem, _, suffix = name.partition(".")
    source = BatchSource(f"x/{stem}.dat", stem, 1)
    with refused(VopdError):
        check_names([source], (".lst", f".{suffix}"))
    check_names([source, source._replace(name=f"sub/{stem}")], (".lst", f".{suffix}x"))


# Refusals, each with its whole sentence


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("in/a.dat", "in/b.cards", "in/note.txt", "in/sub/c.toml", "empty/note.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("12345")
    monkeypatch.chdir(tmp_path)
    return tmp_path


REFUSED = {
    "nothing": ((), None),
    "no name": (("",), None),
    "a stream": (
        ("-",), None
    ),
    "a folder without": (("empty",), None),
    "no match": (("in/*.deck",), None),
    "folders only": (("in/su*",), None),
    "a list of itself": (
        (), "a.dat\n./list\n"
    ),
    "a list of all": (
        (), "*\n"
    ),
    "an empty line is none": ((), "\n#\n"),
    "two of a name": (
        ("in/a.dat", "in/a.deck"), None
    ),
    "the batch's own": (
        ("in/summary.dat",), None
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_every_refusal_in_words(name: str, home: Path) -> None:
    given, manifest = REFUSED[name]
    if manifest is not None:
        (home / "in" / "list").write_text(manifest)
    suffixes = (".lst", ".jsonl") if "own" in name else (".lst", ".csv")
    with refused(VopdError):
        find_sources(given, "in/list" if manifest is not None else None, "out", suffixes)


@pytest.mark.parametrize(
    ("given", "out"),
    [(("in",), "in/out"), (("in",), "in"), (("in/a.dat",), "in"), (("in/sub/c.toml",), ".")],
)
def test_where_the_output_folder_may_not_be(given: tuple[str, ...], out: str, home: Path) -> None:
    with refused(VopdError):
        find_sources(given, None, out, (".lst",))


def test_an_output_folder_above_a_folder_of_inputs_is_refused(home: Path) -> None:
    """Any of the inputs may be the one that is named."""
    with pytest.raises(VopdError) as refusal:
        find_sources(("in",), None, ".", (".lst",))
    assert any(str(home / "in" / one) in str(refusal.value) for one in ("a.dat", "b.cards", "sub"))


@pytest.mark.parametrize(
    ("given", "out"),
    [(("in",), "in2"), (("in",), "in/../out"), (("in/a.dat",), "in/sub"), (("in/a.dat",), "i")],
)
def test_where_the_output_folder_may_be(given: tuple[str, ...], out: str, home: Path) -> None:
    assert find_sources(given, None, out, (".lst",))


def test_suffixes_and_own_files() -> None:
    assert IN_FOLDERS == (".dat", ".deck", ".cards", ".toml")
    assert OWN_FILES == ("summary.jsonl", "summary.parquet", "times.jsonl", "index.html")


def names(*given: str, manifest: str | None = None) -> list[tuple[str, str, int]]:
    return [tuple(one) for one in find_sources(given, manifest, "out", (".lst",))]


def test_a_file_that_is_given_twice_is_one_source(home: Path) -> None:
    """By another path, or by a link; the first name holds."""
    (home / "link.dat").symlink_to(home / "in" / "a.dat")
    a = ("in/a.dat", "a", 5)
    assert names("in/a.dat", "./in/a.dat", "link.dat", "in/*.dat") == [a]
    assert names("link.dat", "in/a.dat") == [("link.dat", "link", 5)]
    assert names("in/a.dat", "in/note.txt") == [a, ("in/note.txt", "note", 5)]


def test_names_of_a_manifest(home: Path) -> None:
    """By the path as it stands there; a path from elsewhere by the file's own name."""
    (home / "in" / "list").write_text(f"sub/c.toml\n{home}/in/a.dat\n../in/b.cards\n")
    assert names(manifest="in/list") == [
        (f"{home}/in/a.dat", "a", 5), ("in/../in/b.cards", "b", 5), ("in/sub/c.toml", "sub/c", 5),
    ]  # fmt: skip
    (home / "in" / "list").write_text("sub\n")
    assert names(manifest="in/list") == [("in/sub/c.toml", "c", 5)]


def test_names_may_differ_by_their_suffix_alone_where_outputs_do(home: Path) -> None:
    (home / "in" / "a.b.dat").write_text("")
    assert [one for _, one, _ in names("in/a.dat", "in/a.b.dat")] == ["a", "a.b"]
    sources = find_sources(["in/a.dat", "in/a.b.dat"], None, "out", (".lst",))
    check_names(sources, (".lst", ".b.csv"))
    with refused(VopdError):
        check_names(sources, (".csv", ".b.csv"))
    assert names("none.dat") == [("none.dat", "none", 0)]


# Lines of a manifest


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"a.dat\nb/c.dat\n", ["a.dat", "b/c.dat"]),
        (b"\xef\xbb\xbfa.dat\r\n\r\n  b c.dat \r\n", ["a.dat", "b c.dat"]),
        (
            b"# all\n a.dat # not a comment\n#b.dat\n\xc3\xbc.dat",
            ["a.dat # not a comment", "ü.dat"],
        ),
        (b"", "the manifest is empty: write one source on each line"),
        (b"\xef\xbb\xbf", "the manifest is empty: write one source on each line"),
        (b"# a.dat\n \n", "the manifest is empty: write one source on each line"),
        (b"a.dat\n\xfc.dat\n", "not a text file in UTF-8, at byte 6"),
        (b"a.dat\n\nb\0.dat\n", "a null character in line 3"),
        (None, "No such file or directory"),
    ],
)
def test_lines_of_a_manifest(content: bytes | None, found: Any, tmp_path: Path) -> None:
    """Spreadsheets begin a text with the mark of its byte order, and end lines as Windows does."""
    path = tmp_path / "list"
    if content is not None:
        path.write_bytes(content)
    given: Any = (), str(path), str(tmp_path / "out"), (".lst",)
    if isinstance(found, list):
        assert [os.path.relpath(one.path, tmp_path) for one in find_sources(*given)] == found
    else:
        with refused(VopdError, parts=[path]):
            find_sources(*given)
