"""CSV, JSON Lines, npz and Parquet, read back by csv, pandas, json, NumPy and pyarrow."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.attitude_files import (
    ANGLES,
    CASES_123,
    EPOCH,
    NAMES,
    VEHICLE,
    apart_deg,
    column,
    deck_text,
    printed,
    write,
)
from tests.kit.command import DECKS, ROOT, vopd
from tests.kit.histories import histories
from tests.tolerances import assert_close
from vopd.attitude.table import FIXED, INTERVALS, MATRICES, columns_of
from vopd.export import FORMATS

SAID = ("program", "deck", "fixes", "from frame", "to frame", "sequence", "quaternion", "ranges")
QUATERNION = ["quaternion_x", "quaternion_y", "quaternion_z", "quaternion_w"]

Read = tuple[dict[str, str], pd.DataFrame]


def read_csv(path: Path) -> Read:
    lines = path.read_text().splitlines(keepends=True)
    head = [line for line in lines if line.startswith("# ")]
    assert lines[: len(head)] == head
    said = dict(line[2:].rstrip("\n").split(": ", 1) for line in head)
    names = next(csv.reader(lines[len(head) :]))
    table = pd.read_csv(path, comment="#", keep_default_na=False, na_values=[""])
    assert list(table.columns) == names
    return said, table


def read_jsonl(path: Path) -> Read:
    head, *rows = [json.loads(line) for line in path.read_text().splitlines()]
    table = pd.DataFrame(rows)
    assert list(table.columns) == list(head["columns"])
    assert head["columns"]["vehicle_yaw_deg"]["unit"] == "deg"
    return head["conventions"], table


def read_npz(path: Path) -> Read:
    with np.load(path, allow_pickle=False) as archive:
        arrays: dict[str, Any] = {name: archive[name] for name in archive.files}
    columns = json.loads(str(arrays.pop("columns")))
    said = json.loads(str(arrays.pop("conventions")))
    assert list(columns) == list(arrays) and columns["airspeed_ft_s"]["unit"] == "ft/s"
    return said, pd.DataFrame({name: list(array) for name, array in arrays.items()})


def read_parquet(path: Path) -> Read:
    table = pq.read_table(path)
    assert table.schema.field("airspeed_ft_s").metadata[b"unit"] == b"ft/s"
    assert b"PSI" in table.schema.field("vehicle_yaw_deg").metadata[b"meaning"]
    return json.loads(table.schema.metadata[b"conventions"]), table.to_pandas()


READERS = {"csv": read_csv, "jsonl": read_jsonl, "npz": read_npz, "parquet": read_parquet}


@pytest.mark.parametrize("form", READERS)
@pytest.mark.parametrize("name", NAMES)
def test_the_numbers_are_the_listing_s(name: str, form: str, tmp_path: Path) -> None:
    said, table = READERS[form](write(tmp_path, name, f"table.{form}"))
    assert set(SAID) <= set(said)
    assert said["deck"] == str(tmp_path / f"{name}.dat")
    rows = printed(name)
    solved = table[table["status"] == "solved"]
    assert solved["frame"].tolist() == [row["frame"] for row in rows]
    expected = column(rows, ANGLES)
    assert_close("printed angle", apart_deg(solved[ANGLES], expected), 0.0)
    assert_close("printed time", solved["time_s"], column(rows, ["time_s"])[:, 0])
    feet = solved[["vehicle_east_ft", "vehicle_north_ft", "vehicle_up_ft"]]
    assert_close("printed feet", feet, column(rows, ["east", "north", "up"]))
    euler = Rotation.from_quat(solved[QUATERNION].to_numpy()).as_euler("ZYX", degrees=True)
    assert_close("printed angle", apart_deg(euler, column(rows, VEHICLE)), 0.0)


@pytest.mark.parametrize("form", READERS)
def test_an_ignored_frame_has_a_row_without_numbers(form: str, tmp_path: Path) -> None:
    """Case 4: frame 55 is ignored, and flown all the same."""
    _, table = READERS[form](write(tmp_path, "case4", f"table.{form}"))
    first = table.iloc[0]
    assert table["frame"].tolist() == [55, 60, 65] and first["status"] == "ignored"
    assert pd.isna(first["vehicle_yaw_deg"]) and pd.isna(first["sigma_eta_deg"])
    assert first["altitude_ft"] == 120747.4 and first["landmarks"] == 0


def test_full_precision_is_the_same_in_all(tmp_path: Path) -> None:
    tables = [READERS[form](write(tmp_path, "flight", f"t.{form}"))[1] for form in READERS]
    text, *full = tables
    for other in full[1:]:
        for one in full[0].columns.difference([matrix.name for matrix in MATRICES]):
            left, right = full[0][one], other[one]
            same = (left == right) | (left.isna() & right.isna())
            assert same.all() or set(left[~same]) | set(right[~same]) <= {"", None}, one
    yaw = full[0]["vehicle_yaw_deg"]
    assert (text["vehicle_yaw_deg"] == yaw.round(6)).all() and not (yaw == yaw.round(6)).all()


def test_text_has_the_decimals_of_its_column() -> None:
    result = vopd("attitude", "-", stdin=deck_text("case1"))
    rows = [line for line in result.stdout.splitlines() if not line.startswith("#")]
    (row,) = csv.DictReader(io.StringIO("\n".join(rows)))
    assert (row["time_s"], row["frame"], row["landmarks"]) == ("70.871306", "730", "3")
    mantissa, _, exponent = row["last_correction_rad"].partition("e")
    assert len(mantissa.lstrip("-")) == 8 and exponent.lstrip("+-").isdigit()
    decimals = {name: len(row[name].partition(".")[2]) for name in row}
    assert (decimals["vehicle_yaw_deg"], decimals["quaternion_w"]) == (6, 10)
    assert (decimals["airspeed_ft_s"], decimals["residual_rms_mm"]) == (4, 8)


def test_epoch_components_and_fixes_are_stated(tmp_path: Path) -> None:
    options = ("--epoch", "1974-08-27T12:30:00-05:00", "--landmark-sigma", "30", "--fix", "earth")
    said, table = read_csv(write(tmp_path, "case1", "t.csv", *options))
    assert said["time"].endswith("zero is 1974-08-27T17:30:00.000000Z")
    assert said["fixes"] == "earth (WGS 84)" and "normal of" in said["from frame"]
    assert "; components: reading, centre, landmark; they exclude" in said["sigmas"]
    components = table[[f"sigma_{c}_eta_deg" for c in ("reading", "centre", "landmark")]].to_numpy()
    total = np.sqrt((components**2).sum())
    assert_close("six decimals", table["sigma_eta_deg"].item(), total)


def test_several_decks_and_jobs_are_one_table(tmp_path: Path) -> None:
    decks = [str(CASES_123), str(CASES_123.with_name("case1.dat"))]
    result = vopd("attitude", *decks, "-o", str(tmp_path / "t.csv"), "--epoch", EPOCH)
    assert result.status == 0, result.stderr
    said, table = read_csv(tmp_path / "t.csv")
    assert said["deck"] == ", ".join(decks)
    assert table["deck"].tolist() == [decks[0]] * 3 + [decks[1]]
    assert table["job"].tolist() == [1, 2, 3, 1]
    yaws = [printed(f"case{k}")[0]["vehicle_yaw_deg"] for k in (1, 2, 3, 1)]
    assert_close("printed angle", table["vehicle_yaw_deg"], yaws)


def test_what_does_not_print_in_a_deck_s_name_is_escaped(tmp_path: Path) -> None:
    deck = tmp_path / "two\nlines #1, \u00e9.dat"
    deck.write_text(deck_text("case1"))
    for form, reader in READERS.items():
        path = tmp_path / f"t.{form}"
        result = vopd("attitude", str(deck), "-o", str(path), "-q")
        assert result.status == 0, result.stderr
        if form != "csv":  # pandas takes every # for a comment
            said, table = reader(path)
            assert table["deck"].item() == str(deck).replace("\n", "\\n") == said["deck"]
    rows = [x for x in (tmp_path / "t.csv").read_text().splitlines() if not x.startswith("# ")]
    assert len(rows) == 2 and next(csv.reader(rows[1:]))[0] == str(deck).replace("\n", "\\n")


def test_the_page_explains_every_column() -> None:
    page = (ROOT / "docs" / "attitude-files.md").read_text()
    (one_deck,) = histories("appendix_h/case1")
    for one in (*columns_of([one_deck])[: len(FIXED)], *INTERVALS[-2:], *MATRICES):
        assert f"| `{one.name}` | {one.unit} | {one.meaning} |" in page
    for one in FORMATS.values():
        assert f"| `{one.name}` | {' '.join(one.suffixes)} |" in page


def test_a_missing_number_is_null_in_parquet(tmp_path: Path) -> None:
    """Not NaN, which a database would take for a number: frame 55 is ignored."""
    path = tmp_path / "t.parquet"
    assert vopd("attitude", DECKS / "appendix_h" / "case4.dat", "-q", "-o", path).status == 0
    found = pq.read_table(path)
    assert found["camera_yaw_deg"].to_pylist()[0] is None
    assert found["covariance_common_deg2"].null_count == 1
    for name in found.column_names:
        numbers = [value for value in found[name].to_pylist() if isinstance(value, float)]
        assert not np.isnan(numbers).any(), name
