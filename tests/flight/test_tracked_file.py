"""The tracked file: what is written is read, and what is wrong is named with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from vopd.findings import VopdError
from vopd.flight.formats.files import open_input
from vopd.flight.formats.picks import Names
from vopd.flight.formats.tracked import (
    COLUMNS,
    HEAD,
    TrackedRows,
    read_tracked,
    tracked_lines,
)

HEADER = ",".join(COLUMNS)
CLICK = "0,mast,100.5,200.25,0.5,0,1,0,0,1,1,clicked"
TRACK = "1,mast,101.5,201.25,0.08,0,1.01,0.02,-0.02,1.01,0.95,tracked"


def read(folder: Path, *rows: str, header: str = HEADER) -> TrackedRows:
    folder.joinpath("tracked.csv").write_text("\n".join([HEAD, header, *rows]) + "\n")
    return read_tracked(open_input("tracked.csv", folder))


def test_rows_that_are_written_are_read(tmp_path: Path) -> None:
    rows = TrackedRows(
        frame=np.array([0, 1, 2]),
        landmark=Names(['mast, "tall"'] * 3),
        pixel=np.array([[100.5, 200.25], [101.5, 201.25], [np.nan, np.nan]]),
        sigma_px=np.array([0.5, 0.08, np.nan]),
        from_frame=np.array([0, 0, 0]),
        by_click=np.array([np.eye(2), [[1.01, 0.02], [-0.02, 1.01]], np.full((2, 2), np.nan)]),
        correlation=np.array([1.0, 0.95, np.nan]),
        status=np.array([0, 1, 4]),
        digest={"clicks": "ab" * 32, "project": "cd" * 32, "options": "--to 0.4 --patch 21"},
    )
    (tmp_path / "tracked.csv").write_text("".join(tracked_lines(rows)))
    again = read_tracked(open_input("tracked.csv", tmp_path))
    assert [*again.landmark] == [*rows.landmark]
    for name in ("frame", "pixel", "sigma_px", "from_frame", "by_click", "correlation", "status"):
        np.testing.assert_array_equal(getattr(again, name), getattr(rows, name), name)
    assert again.digest == rows.digest


@pytest.mark.parametrize(
    "rows",
    [
        [CLICK, TRACK.replace("tracked", "found")],
        [CLICK, TRACK.replace(",0,1.01", ",3,1.01")],
        [CLICK, TRACK.replace(",0,1.01", ",,1.01")],
        [CLICK, TRACK.replace(",0,1.01", ",x,1.01")],
        [CLICK, TRACK.replace("1.01,0.02", "nan,0.02")],
        [CLICK, TRACK.replace("1.01,0.02", ",0.02")],
        [CLICK, TRACK.replace("1.01,0.02", "1e9,0.02")],
        [CLICK, TRACK.replace("101.5", "")],
        [CLICK, TRACK.replace("0.08", "")],
        [CLICK, TRACK, TRACK],
        [CLICK, TRACK.replace("1,mast", "one,mast", 1)],
        [CLICK, TRACK.replace("1,mast", "1,", 1)],
        [CLICK.replace("100.5,200.25", ",")],
        [CLICK, CLICK.replace("0,mast", "1,mast")],
        [],
        [CLICK, TRACK, TRACK.replace("1,mast", "2,mast").replace("0.95", "1.01")],
        [CLICK, TRACK.replace("0.95", "-5")],
        [CLICK.replace("clicked", "lost"), TRACK],
    ],
    ids=[
        "status", "no click", "no source", "source", "nan", "part of a matrix", "stretched", "no u",
        "no sigma", "twice", "frame", "no landmark", "click without a pixel",
        "click of another frame", "no row", "correlation", "correlation below -1",
        "click that is lost",
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(tmp_path: Path, rows: list[str]) -> None:
    with refused(VopdError):
        read(tmp_path, *rows)


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    header = HEADER.replace(",dvu", "")
    with refused(VopdError):
        read(tmp_path, "0,mast,1,2,0.5,0,1,0,1,1,clicked", header=header)


def test_a_missing_header_is_named(tmp_path: Path) -> None:
    with refused(VopdError):
        read(tmp_path, TRACK, header=CLICK)


def test_a_sigma_that_no_pick_has_is_told_by_its_line(tmp_path: Path) -> None:
    few = read(tmp_path, CLICK, TRACK.replace("0.08", "1e-9"), TRACK.replace("1,mast,", "2,mast,"))
    assert_approved(few.where(few.status == 1).doubts)
    assert read(tmp_path, CLICK, TRACK.replace("0.08", "1e-4")).doubts == ()


def test_rows_without_a_pixel_take_their_status_alone(tmp_path: Path) -> None:
    found = read(tmp_path, CLICK, "7,mast,,,,,,,,,,occluded")
    assert np.isnan(found.pixel[1]).all()
    assert found.status.tolist() == [0, 2]
