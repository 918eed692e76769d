"""Which format `vopd stars solve` writes, and what its dated files state."""

from __future__ import annotations

from datetime import UTC, datetime
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import click
import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.tolerances import assert_close
from vopd.export.ccsds import DatedAttitudes
from vopd.findings import VopdError

dated_files: Any = import_module("vopd.cli.stars.solve")
formats = dated_files

SUFFIXES = {
    ".json": "json", ".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl", ".npz": "npz",
    ".parquet": "parquet", ".pq": "parquet", ".aem": "aem", ".czml": "czml", ".txt": "text",
    "": "text", ".JSON": "json", ".Pq": "parquet", ".dat": "text",
}  # fmt: skip
PICTURES = (".png", ".svg", ".pdf", ".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".PNG")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_format_is_that_of_the_suffix_or_the_one_asked_for(suffix: str) -> None:
    assert formats.format_of(f"t{suffix}", None) == SUFFIXES[suffix]
    for form in formats.SOLUTION_FORMATS:
        assert formats.format_of(f"t{suffix}", form) == form
    assert formats.format_of("-", None) == "text"


@pytest.mark.parametrize("suffix", PICTURES)
def test_a_picture_is_no_solution(suffix: str) -> None:
    with refused(click.UsageError):
        formats.format_of(f"t{suffix}", None)
    assert formats.format_of(f"t{suffix}", "json") == "json"


@pytest.mark.parametrize("form", formats.SOLUTION_FORMATS)
def test_only_binary_formats_are_not_sent_to_a_terminal(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = SimpleNamespace(stdout=SimpleNamespace(isatty=lambda: True))
    monkeypatch.setattr(formats, "sys", terminal)
    assert formats.format_of("t.dat", form) == form
    if form in ("npz", "parquet"):
        with refused(click.UsageError):
            formats.format_of("-", form)
    else:
        assert formats.format_of("-", form) == form


HALF = np.sqrt(0.5)
FIRST, LATER = (datetime(2020, 1, 15, hour, tzinfo=UTC) for hour in (21, 22))
ABOUT_Z = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
ABOUT_X = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""The axes, as rows, after a quarter turn about z, and about x."""


def photograph(deck: str, utc: datetime | None, number: int, solved: bool = True) -> Any:
    matrix = number * np.eye(3, k=1)
    both = [SimpleNamespace(matrix=matrix), SimpleNamespace(matrix=np.zeros((3, 3)))]
    return SimpleNamespace(
        file=SimpleNamespace(source=deck), utc=utc, solved=both if solved else [],
        local=f"local {number}", epoch=f"epoch {number}",
    )  # fmt: skip


def dated(
    form: str, mount: Any, place: Any, monkeypatch: pytest.MonkeyPatch
) -> tuple[DatedAttitudes, list[Any]]:
    """What a dated file is made of, and what its axes are."""
    axes: list[Any] = []
    made: list[Any] = []

    def axes_of(*given: Any) -> Any:
        axes.append(given)
        return ABOUT_Z, ABOUT_X

    for room, name in (("ccsds", "dated_aem"), ("viewers", "dated_czml")):
        monkeypatch.setattr(
            f"vopd.export.{room}.{name}",
            lambda *one, name=name: made.append((name, *one)) or b"file",
        )
    monkeypatch.setattr("vopd.stellar.sky.axes_of_body", axes_of)
    stated = {"program": "vopd 1", "source": "the source", "more": "x"}
    monkeypatch.setattr("vopd.stellar.files.table.stated_conventions", lambda _: stated)
    photographs = [
        photograph("b.csv", None, 1), photograph("b.csv", LATER, 2),
        photograph("a.csv", FIRST, 3, solved=False), photograph("b.csv", FIRST, 4),
        photograph("a.csv", LATER, 5),
    ]  # fmt: skip
    sky: Any = SimpleNamespace(mount=mount, place=place)
    assert dated_files.render_dated(form, photographs, sky, print) == b"file"
    ((name, attitudes, request, report),) = made
    assert name == f"dated_{form}" and report is print and request.object_name == "CAMERA"
    for (matrix, *rest), number in zip(axes, (2, 4, 5), strict=True):
        assert matrix.tolist() == (number * np.eye(3, k=1)).tolist()
        assert rest == [mount, f"local {number}", place]
    return attitudes, axes


@pytest.mark.parametrize("place", [None, (48.0, 11.0, 500.0)])
@pytest.mark.parametrize("mount", [None, "mount"])
@pytest.mark.parametrize("form", ["aem", "czml"])
def test_what_a_dated_file_states(
    form: str, mount: Any, place: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of each photograph with a date its first solution; longitude stands before latitude."""
    if form == "czml" and place is None:
        with refused(VopdError):
            dated(form, mount, place, monkeypatch)
        return
    found, _ = dated(form, mount, place, monkeypatch)
    assert found.title == "b.csv, a.csv" and found.moments == (LATER, FIRST, LATER)
    assert (found.frame_a, found.frame_b) == ("ICRF", "SC_BODY_1" if mount else "SENSOR_1")
    assert_close("unit rotation", found.quaternion, [[HALF, 0.0, 0.0, HALF]] * 3)
    assert found.place == (None if place is None else (11.0, 48.0, 500.0))
    if place is None:
        assert found.earth_fixed is None
    else:
        assert_close("unit rotation", found.earth_fixed, [[HALF, HALF, 0.0, 0.0]] * 3)
    assert_approved(found.stated)


@pytest.mark.parametrize("form", ["aem", "czml"])
def test_a_dated_file_needs_a_date(form: str) -> None:
    sky: Any = SimpleNamespace(mount=None, place=(1.0, 2.0, 3.0))
    for photographs in ([], [photograph("a", None, 1)], [photograph("a", FIRST, 1, solved=False)]):
        with refused(VopdError, parts=[form]):
            dated_files.render_dated(form, photographs, sky, print)
