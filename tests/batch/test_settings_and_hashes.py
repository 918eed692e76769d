"""What makes a batch solve a source again: its options, its input, and what its record says."""

from __future__ import annotations

import hashlib
import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest

from tests.kit.command import CASE_1
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.batch.folder import (
    FAILED,
    SOLVED,
    UNCONVERGED,
    SourceRecord,
    file_sha256,
    input_sha256,
    named_files,
    read_record,
    remove_others,
    unchanged,
)
from vopd.batch.sources import BatchSettings, BatchSource, table_suffix
from vopd.errata import fixes
from vopd.export import FORMATS
from vopd.pipeline import SolveOptions
from vopd.version import __version__

USUAL = BatchSettings("out", "out/.w", SolveOptions(), HistoryOptions())
CHANGED: dict[str, tuple[dict[str, Any], Any]] = {
    "fix": ({"solve": SolveOptions(fixes("restart"))}, "restart"),
    "initial": ({"solve": SolveOptions(initial="closed-form")}, "closed-form"),
    "compare_initial": ({"solve": SolveOptions(compare_initial=True)}, True),
    "limits_1974": ({"solve": SolveOptions(limits_1974=True)}, True),
    "sigmas": ({"history": HistoryOptions(Sigmas(wind=2.0))}, {"wind": 2.0}),
    "max_rate_deg_s": ({"history": HistoryOptions(max_rate_deg_s=40.0)}, 40.0),
    "vertical": ({"history": HistoryOptions(vertical="geocentric")}, "geocentric"),
    "formats": ({"formats": ("csv", "npz")}, ["csv", "npz"]),
    "report": ({"report": True}, True),
}


@pytest.mark.parametrize("name", CHANGED)
def test_an_option_stands_in_the_record_where_it_is_not_the_usual(name: str) -> None:
    changes, stands = CHANGED[name]
    options = json.loads(replace(USUAL, **changes).options)
    assert options == {"formats": ["csv"]} | {name: stands}


def test_every_setting_but_the_folders_is_an_option() -> None:
    assert json.loads(USUAL.options) == {"formats": ["csv"]}
    assert json.loads(replace(USUAL, folder="x", working="y").options) == {"formats": ["csv"]}
    of_solve = {field.name for field in fields(SolveOptions)} - {"fixes"} | {"fix"}
    of_batch = {field.name for field in fields(BatchSettings)} - {
        "folder",
        "working",
        "solve",
        "history",
    }
    of_history = {field.name for field in fields(HistoryOptions)}
    assert of_solve | of_history | of_batch == set(CHANGED)


@pytest.mark.parametrize("field", [field.name for field in fields(Sigmas)])
def test_every_standard_deviation_is_an_option(field: str) -> None:
    options = json.loads(replace(USUAL, history=HistoryOptions(Sigmas(**{field: 0.5}))).options)
    assert options["sigmas"] == {field: 0.5}


def test_suffixes_of_tables() -> None:
    expected = {
        "csv": ".csv", "jsonl": ".jsonl", "npz": ".npz", "parquet": ".parquet", "aem": ".aem",
        "acm": ".acm", "czml": ".czml", "kml": ".kml", "odm": ".geo.txt",
        "colmap": ".images.txt", "opk": ".opk.csv",
    }  # fmt: skip
    assert {form: table_suffix(form) for form in FORMATS} == expected
    page = replace(USUAL, formats=("npz", "odm"), report=True)
    assert page.suffixes == (".lst", ".npz", ".geo.txt", ".html")
    assert USUAL.suffixes == (".lst", ".csv")


# The hash of the input


def test_the_hash_of_a_deck_is_that_of_its_bytes(tmp_path: Path) -> None:
    assert input_sha256(str(CASE_1)) == hashlib.sha256(CASE_1.read_bytes()).hexdigest()
    assert input_sha256(str(tmp_path / "none.dat")) == ""
    assert file_sha256(tmp_path) == file_sha256(tmp_path / "none") == ""


PROJECT = """\
title = "no file"
[picks]
file = "labels"
grid = { file = "deep.csv", more = ["listed.csv", 3] }
[track]
file = "../beside.csv"
"""


def project(folder: Path) -> Path:
    """A project that names a folder, files in a table and in a list, and one beside its folder."""
    home = folder / "p"
    (home / "labels" / "inner").mkdir(parents=True)
    for name in ("labels/b.json", "labels/a.json", "deep.csv", "listed.csv", "../beside.csv",
                 "labels/inner/c.json", "not named.csv"):  # fmt: skip
        (home / name).write_text(name)
    (home / "flight.toml").write_text(PROJECT)
    return home / "flight.toml"


def test_files_that_a_project_names(tmp_path: Path) -> None:
    path = project(tmp_path)
    found = [name for name, _ in named_files(path.read_bytes(), path.parent)]
    assert found == ["../beside.csv", "deep.csv", "labels/a.json", "labels/b.json", "listed.csv"]
    assert [*named_files(b"not toml =", path.parent)] == []


@pytest.mark.parametrize(
    ("change", "differs"),
    [
        ("flight.toml", True), ("deep.csv", True), ("listed.csv", True), ("labels/a.json", True),
        ("../beside.csv", True), ("not named.csv", False), ("labels/inner/c.json", False),
    ],
)  # fmt: skip
def test_the_hash_changes_with_every_file_that_is_named(
    change: str, differs: bool, tmp_path: Path
) -> None:
    path = project(tmp_path)
    before = input_sha256(str(path))
    with (path.parent / change).open("a") as file:
        file.write("\n")
    assert (input_sha256(str(path)) != before) is differs


def test_the_hash_changes_with_the_name_of_a_file_in_a_folder(tmp_path: Path) -> None:
    """An image's name is its frame's."""
    path = project(tmp_path)
    before = input_sha256(str(path))
    (path.parent / "labels" / "a.json").rename(path.parent / "labels" / "aa.json")
    assert input_sha256(str(path)) != before


# Records


RECORD = SourceRecord("a", "a.dat", SOLVED, "", "digest", "1", "options")


def test_a_record_is_read_as_it_was_written() -> None:
    full = replace(
        RECORD, source="Zürich \udcff", error="line\nline", jobs=2, frames=3, attitudes=4,
        flagged=5, not_converged=6, warnings=7, flags={"jump": 8}, outputs={"a.csv": "x"},
        seconds=0.25,
    )  # fmt: skip
    line = full.line()
    assert line.endswith(b"}\n") and line.count(b"\n") == 1
    again = read_record(line.decode("utf-8"))
    assert again == full
    assert set(full.row()) == {field.name for field in fields(SourceRecord)} - {"seconds"}
    for other in ("", "{", line.decode()[:-20], "[]", "3", '{"source": "a"}', '{"no": 1}'):
        assert read_record(other) is None


@pytest.mark.parametrize(
    ("changes", "holds"),
    [
        ({}, True), ({"status": UNCONVERGED}, True), ({"status": FAILED}, False),
        ({"version": "0"}, False), ({"options": "{}"}, False), ({"input_sha256": "0"}, False),
        ({"outputs": {"a.csv": "0"}}, False), ({"outputs": {"none.csv": "0"}}, False),
    ],
)  # fmt: skip
def test_when_an_earlier_record_still_holds(
    changes: dict[str, Any], holds: bool, tmp_path: Path
) -> None:
    settings = replace(USUAL, folder=str(tmp_path))
    (tmp_path / "a.dat").write_text("deck")
    (tmp_path / "a.csv").write_text("table")
    digest, table = (hashlib.sha256(text).hexdigest() for text in (b"deck", b"table"))
    record = replace(
        RECORD, version=__version__, options=settings.options, input_sha256=digest,
        outputs={"a.csv": table},
    )  # fmt: skip
    record = replace(record, **changes)
    source = BatchSource(str(tmp_path / "a.dat"), "a", 4)
    assert unchanged([source], settings, {"a": record}) == ([record] if holds else [])
    assert unchanged([source._replace(name="b")], settings, {"a": record}) == []


def test_outputs_that_are_not_written_again_are_removed(tmp_path: Path) -> None:
    for name in ("a.lst", "a.csv", "other.csv"):
        (tmp_path / name).write_text(name)
    before = replace(RECORD, outputs={"a.lst": "", "a.csv": "", "gone.npz": ""})
    remove_others(
        before, replace(RECORD, outputs={"a.lst": ""}), replace(USUAL, folder=str(tmp_path))
    )
    remove_others(None, RECORD, replace(USUAL, folder=str(tmp_path)))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.lst", "other.csv"]
