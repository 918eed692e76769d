"""The table of formats: what each is called, takes and needs, and which file has which."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.estimates import REQUEST, level_flight
from vopd.attitude.history import History
from vopd.attitude.long_history import one_part
from vopd.export import FORMATS, FileRequest, of_file
from vopd.findings import VopdError

NAMES = ("epoch", "object_name")
COLUMNS = ("epoch", "columns", "roll_180")
MESSAGE = ("epoch", "originator", "object_name", "object_id")
TABLE: dict[str, tuple[tuple[str, ...], set[str], tuple[str, ...]]] = {
    "csv": ((".csv",), {"by_parts", "together"}, COLUMNS),
    "jsonl": ((".jsonl", ".ndjson"), {"by_parts"}, COLUMNS),
    "npz": ((".npz",), {"binary"}, COLUMNS),
    "parquet": ((".parquet", ".pq"), {"binary", "package"}, COLUMNS),
    "aem": ((".aem",), {"needs_epoch"}, ("aem_version", *MESSAGE)),
    "acm": ((".acm",), {"needs_epoch"}, MESSAGE),
    "czml": ((".czml",), {"needs_epoch"}, NAMES),
    "kml": ((".kml",), set(), NAMES),
    "odm": (("geo.txt",), set(), ()),
    "colmap": (("images.txt",), set(), ()),
    "opk": ((".opk.csv",), set(), ()),
}
MARKS = ("needs_epoch", "binary", "by_parts", "together", "package")


def test_every_format() -> None:
    assert [*FORMATS] == [*TABLE]
    for name, (suffixes, marks, options) in TABLE.items():
        one = FORMATS[name]
        assert (one.name, one.suffixes, set(one.options)) == (name, suffixes, set(options))
        assert {mark for mark in MARKS if getattr(one, mark)} == marks
        assert_approved(f"{name}: {one.about}")
    assert FORMATS["parquet"].package == "pyarrow"


@pytest.mark.parametrize(
    ("name", "form"),
    [
        *((f"a{suffix}", name) for name, row in TABLE.items() for suffix in row[0]),
        *((f"A{suffix}".upper(), name) for name, row in TABLE.items() for suffix in row[0]),
        ("geo.txt", "odm"), ("images.txt", "colmap"), ("a.b.csv", "csv"), ("a.opk.csv", "opk"),
        (".csv", "csv"), ("folder.kml/t.csv", "csv"),
    ],
)  # fmt: skip
def test_the_format_of_a_file(name: str, form: str) -> None:
    assert of_file(name).name == form


@pytest.mark.parametrize("name", ["t.xyz", "t.csv.GZ", "t.txt", "t", "t.csv/t", ""])
def test_a_file_of_no_format(name: str) -> None:
    with refused(VopdError):
        of_file(name)


@pytest.mark.parametrize("form", FORMATS)
def test_what_is_missing_is_said_before_the_first_page(form: str) -> None:
    jobs = [one_part(level_flight())]
    if form in ("aem", "acm", "czml"):
        with refused(VopdError):
            next(FORMATS[form].pages(jobs, replace(REQUEST, epoch=None)))
    with refused(VopdError):
        next(FORMATS[form].pages([], REQUEST))


def test_a_package_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    for work in (
        FORMATS["parquet"].ready,
        lambda: next(FORMATS["parquet"].pages([one_part(level_flight())], REQUEST)),
    ):
        with refused(VopdError):
            work()
    FORMATS["npz"].ready()


def named(name: str, job: int = 1, **changes: Any) -> History:
    one = level_flight(job)
    about = one.about._replace(source=name, **changes)
    return replace(one, estimate=replace(one.estimate, about=about))


def in_feet(name: str) -> History:
    """A job whose table has other columns."""
    one = named(name)
    units = one.estimate.units._replace(length="ft", metres_per_length=0.3048)
    return replace(one, estimate=replace(one.estimate, units=units))


@pytest.mark.parametrize("form", FORMATS)
def test_many_files_are_those_that_are_made_one_by_one(form: str) -> None:
    """Each with its own jobs, names and request; an error of one costs no other."""
    files = [
        ([named("a\n.toml"), named("b.toml", 2)], REQUEST, lambda _: None),
        ([named("c.toml", title="=1")], replace(REQUEST, epoch=None), lambda _: None),
        ([in_feet("e.toml")], REQUEST, lambda _: None),
        ([named("d.toml", 3)], FileRequest(epoch=REQUEST.epoch), lambda _: None),
    ]
    made = FORMATS[form].render_files(files)
    for file, content in zip(files, made, strict=True):
        try:
            assert content == FORMATS[form].render(*file)
        except VopdError as error:
            assert str(content) == str(error) and isinstance(content, VopdError)
            assert form in ("aem", "acm", "czml") and file[1].epoch is None
    first = made[0]
    assert isinstance(first, bytes)
    if form not in ("npz", "parquet"):
        assert "a\\n.toml" in first.decode().replace("\\\\n", "\\n")
