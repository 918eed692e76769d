"""Sources that a batch refuses, each with its whole sentence, and files that are one or two."""

from __future__ import annotations

from pathlib import Path

import pytest

from vopd.batch.sources import IN_FOLDERS, OWN_FILES, _check_names, find_sources
from vopd.findings import VopdError


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("in/a.dat", "in/b.cards", "in/note.txt", "in/sub/c.toml", "empty/note.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("12345")
    monkeypatch.chdir(tmp_path)
    return tmp_path


NO_DECK = (
    "there is no deck and no project in this folder; taken are files that end in .dat .deck "
    ".cards .toml: name others by a pattern, such as 'empty/*.txt'"
)
REFUSED = {
    "nothing": ((), None, "there is no source: give a deck, a project, a folder or --manifest"),
    "no name": (("",), None, "a source has no name: give a file, a folder or a pattern"),
    "a stream": (
        ("-",), None, "-: standard input cannot be a source of a batch: write it to a file"
    ),
    "a folder without": (("empty",), None, f"empty: {NO_DECK}"),
    "no match": (("in/*.deck",), None, "in/*.deck: no file matches this pattern"),
    "folders only": (("in/su*",), None, "in/su*: no file matches this pattern"),
    "a list of itself": (
        (), "a.dat\n./list\n", "in/list: the manifest names itself as a source: ./list"
    ),
    "a list of all": (
        (), "*\n", "in/list: the manifest names itself as a source: *"
    ),
    "an empty line is none": ((), "\n#\n", "in/list: the manifest is empty: write one source on "
                                         "each line"),
    "two of a name": (
        ("in/a.dat", "in/a.deck"), None,
        "in/a.deck: its output a.lst would have the same name as that of in/a.dat; rename the "
        "source, or give the folder that both are in",
    ),
    "the batch's own": (
        ("in/summary.dat",), None,
        "in/summary.dat: its output summary.jsonl would have the same name as that of the batch "
        "itself; rename the source, or give the folder that both are in",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_every_refusal_in_words(name: str, home: Path) -> None:
    given, manifest, said = REFUSED[name]
    if manifest is not None:
        (home / "in" / "list").write_text(manifest)
    suffixes = (".lst", ".jsonl") if "own" in name else (".lst", ".csv")
    with pytest.raises(VopdError) as refused:
        find_sources(given, "in/list" if manifest is not None else None, "out", suffixes)
    assert str(refused.value) == said


@pytest.mark.parametrize(
    ("given", "out", "said"),
    [
        (("in",), "in/out", "in/out: the output folder is inside the inputs; name another"),
        (("in",), "in", "in: the output folder is inside the inputs; name another"),
        (("in/a.dat",), "in", "in: the output folder has the input HOME/in/a.dat in it; "
                              "name another"),
        (("in",), ".", ".: the output folder has the input HOME/in/a.dat in it; name another"),
        (("in",), "in2", None), (("in",), "in/../out", None), (("in/a.dat",), "in/sub", None),
        (("in/a.dat",), "i", None),
    ],
)  # fmt: skip
def test_where_the_output_folder_may_be(
    given: tuple[str, ...], out: str, said: str | None, home: Path
) -> None:
    if said is None:
        assert find_sources(given, None, out, (".lst",))
        return
    with pytest.raises(VopdError) as refused:
        find_sources(given, None, out, (".lst",))
    one_of = {said.replace("HOME", str(home)).replace("a.dat", name)
              for name in ("a.dat", "b.cards", "sub/c.toml")}  # fmt: skip
    assert str(refused.value) in one_of


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
    _check_names(sources, (".lst", ".b.csv"))
    with pytest.raises(VopdError, match=r"its output a\.b\.csv would have the same name"):
        _check_names(sources, (".csv", ".b.csv"))
    assert names("none.dat") == [("none.dat", "none", 0)]
