"""Which files a batch takes, in which order, and what it calls them."""

from __future__ import annotations

from pathlib import Path

import pytest

from vopd.batch.sources import OWN_FILES, BatchSource, _check_names, find_sources
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
    with pytest.raises(VopdError, match="the output folder is inside the inputs"):
        find_sources([str(home)], None, str(tmp_path / out), (".lst",))


def test_the_output_folder_has_no_input_in_it(tmp_path: Path) -> None:
    home = place(tmp_path) / "in"
    with pytest.raises(VopdError, match=r"has the input .*c\.dat in it"):
        find_sources([str(home / "sub/deep/c.dat")], None, str(home / "sub"), (".lst",))
    (tmp_path / "link").symlink_to(home)
    with pytest.raises(VopdError, match="the output folder is inside the inputs"):
        find_sources([str(home)], None, str(tmp_path / "link" / "out"), (".lst",))
    for out in ("in2", "i", "out"):  # whose names only begin alike, or not
        assert find_sources([str(home)], None, str(tmp_path / out), (".lst",))


@pytest.mark.parametrize("name", OWN_FILES)
def test_the_batch_keeps_the_names_of_its_own_files(name: str) -> None:
    stem, _, suffix = name.partition(".")
    source = BatchSource(f"x/{stem}.dat", stem, 1)
    with pytest.raises(VopdError, match=f"its output {name} would have .* the batch itself"):
        _check_names([source], (".lst", f".{suffix}"))
    _check_names([source, source._replace(name=f"sub/{stem}")], (".lst", f".{suffix}x"))
