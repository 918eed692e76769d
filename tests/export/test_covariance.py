"""Covariances in every format, also where nothing determines a turn: the values are infinite."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from tests.kit import repeated_frame
from tests.kit.jobs import reread
from tests.tolerances import assert_close
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.export import FORMATS, FileRequest
from vopd.export.tables import dataframe
from vopd.film import film_estimate
from vopd.pipeline import run

EPOCH = datetime(1974, 8, 27, 17, 30, tzinfo=UTC)
AXES = ("forward", "right", "down")
READERS = ("csv", "jsonl", "npz", "parquet", "dataframe")


@cache
def made() -> tuple[History, ...]:
    """A deck of two frames; in the first one landmark, twice, in the second four; 30 ft each."""
    job = repeated_frame.repeated(landmarks=[0, 1, 2, 3], draws=3)
    present = job.readings.present.copy()
    present[0, 1:] = False
    ignored = replace(job.ignored, frame=np.array([3]), landmark=np.array([[100, 0, 0, 0, 0, 0]]))
    readings = reread(job.readings, present=present)
    (solved,) = run(replace(job, readings=readings, ignored=ignored)).jobs
    return (history(film_estimate(solved.results, "two.dat"), sigmas=Sigmas(landmark=30.0)),)


def content(form: str) -> bytes:
    return FORMATS[form].render(made(), FileRequest(epoch=EPOCH))


def rows_of(form: str) -> list[dict[str, Any]]:
    """What each reader finds, a row a frame; missing is None or NaN."""
    if form == "csv":
        lines = [line for line in content(form).decode().splitlines() if line[0] != "#"]
        return list(csv.DictReader(io.StringIO("\n".join(lines))))
    if form == "jsonl":

        def refuse(name: str) -> float:
            raise AssertionError(f"{name} is not JSON")

        text = content(form).decode().splitlines()[1:]
        return [json.loads(line, parse_constant=refuse) for line in text]
    if form == "npz":
        with np.load(io.BytesIO(content(form)), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files if archive[name].ndim}
        return [{name: array[k] for name, array in arrays.items()} for k in range(3)]
    if form == "parquet":
        return pq.read_table(io.BytesIO(content(form))).to_pylist()
    return dataframe(made()).to_dict("records")


def number(value: Any) -> float:
    return math.nan if value in ("", None) else float(value)


@pytest.mark.parametrize("form", READERS)
def test_six_columns_of_each_part(form: str) -> None:
    """Infinite where two axes have a part in the free turn; in JSON that is null."""
    first, second, ignored = rows_of(form)
    (one,) = made()
    for part in ("", "common_"):
        whole = getattr(one.uncertainty, f"covariance_{part}deg2")
        for i in range(3):
            for j in range(i, 3):
                name = f"covariance_{part}{AXES[i]}_{AXES[j]}_deg2"
                undetermined = number(first[name])
                assert math.isnan(undetermined) if form == "jsonl" else math.isinf(undetermined)
                if form not in ("jsonl", "csv"):
                    assert undetermined == whole[0, i, j]
                assert_close("seven digits", number(second[name]) / whole[1, i, j], 1.0)
                assert math.isnan(number(ignored[name]))
    assert math.isnan(number(ignored["sigma_vehicle_yaw_deg"]))
    sigma = number(first["sigma_vehicle_yaw_deg"])
    assert math.isnan(sigma) if form == "jsonl" else sigma == math.inf


@pytest.mark.parametrize("form", READERS[1:])
@pytest.mark.parametrize("part", ["", "common_"])
def test_a_matrix_a_frame(form: str, part: str) -> None:
    first, second, ignored = (row[f"covariance_{part}deg2"] for row in rows_of(form))
    (one,) = made()
    whole = getattr(one.uncertainty, f"covariance_{part}deg2")
    assert_close("ratio", np.array(second, float) / whole[1], np.ones((3, 3)))
    if form == "jsonl":
        assert first == [[None] * 3] * 3 and ignored is None
    else:
        assert (np.array(first, float) == whole[0]).all() and np.isinf(whole[0]).all()
        assert ignored is None if form == "parquet" else np.isnan(ignored).all()


def test_the_matrix_has_the_columns_elements() -> None:
    (_, row, _) = rows_of("jsonl")
    matrix = np.array(row["covariance_deg2"])
    assert (matrix == matrix.T).all()
    for i, one in enumerate(AXES):
        for j, other in enumerate(AXES[i:], i):
            assert matrix[i, j] == row[f"covariance_{one}_{other}_deg2"]


def test_the_common_part_is_that_of_the_landmarks() -> None:
    """The rest is the covariance of the same job without errors of the landmarks."""
    (one,) = made()
    given = Sigmas(reading=0.01, fiducial=0.01)
    without = history(one.estimate, sigmas=given).uncertainty
    both = history(one.estimate, sigmas=replace(given, landmark=30.0)).uncertainty
    assert (without.covariance_common_deg2[1] == 0.0).all()
    rest = both.covariance_deg2[1] - both.covariance_common_deg2[1]
    assert_close("ratio", rest / without.covariance_deg2[1], np.ones((3, 3)))
    assert_close("ratio", both.covariance_independent_deg2[1] / rest, np.ones((3, 3)))
    assert np.isinf(both.covariance_independent_deg2[0]).all()


def test_matrices_are_described() -> None:
    head = json.loads(content("jsonl").decode().splitlines()[0])
    for part in ("", "common_"):
        told = head["columns"][f"covariance_{part}deg2"]
        assert told["unit"] == "deg2" and "forward, right and down" in told["meaning"]
    schema = pq.read_schema(io.BytesIO(content("parquet")))
    assert schema.field("covariance_deg2").metadata[b"unit"] == b"deg2"


@pytest.mark.parametrize("form", ["kml", "czml", "aem"])
def test_a_viewer_is_never_given_an_infinite_number(form: str) -> None:
    text = content(form).decode()
    described = text.replace("infinite where", "")
    assert "Infinity" not in described and ">inf<" not in described and " inf" not in described
    assert "nan" not in described.lower()


def test_a_spreadsheet_reads_inf() -> None:
    """As pandas does, which the documentation shows."""
    frame = pd.read_csv(io.BytesIO(content("csv")), comment="#")
    found = frame["sigma_vehicle_yaw_deg"]
    assert found[0] == np.inf and np.isfinite(found[1]) and np.isnan(found[2])
    assert table(made())["sigma_vehicle_yaw_deg"][0] == np.inf
