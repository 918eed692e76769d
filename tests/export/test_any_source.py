"""A history of an estimate made by hand, without a deck: every format, figure and the report."""

from __future__ import annotations

import csv
import io
import json
import re
import sys
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import POINTS, estimate
from tests.kit.histories import about, histories
from tests.kit.html_page import Page, frame_columns
from tests.tolerances import assert_close
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.export import FORMATS, FileRequest
from vopd.export.tables import dataframe
from vopd.export.viewers import KML_POSITION
from vopd.figures import FIGURES, draw
from vopd.figures.style import svg
from vopd.findings import VopdError
from vopd.report import report

EPOCH = datetime(2026, 5, 1, 9, 0, tzinfo=UTC)
OF_DECKS = re.compile(
    r"\bdecks?\b|\bcards?\b|\bgroup \d|\bfilm\b|\b22nd\b|sea level|1974|SIG1|_ft\b|_mm\b|µm|\bmm\b"
)
"""What nobody must read who has never seen a card deck."""


@cache
def made() -> History:
    """Six frames of four named landmarks; in the fourth "=A1" is far from where it should be."""
    one = estimate(np.tile([140.0, -60.0, 20.0], (6, 1)), POINTS, 0.01)
    residual = one.residual.copy()
    residual[3, 2] += 2.0
    return history(replace(one, residual=residual), sigmas=Sigmas(position=10.0))


def text_of(form: str) -> str:
    content = FORMATS[form].render([made()], FileRequest(epoch=EPOCH))
    return content.decode("utf-8", "replace")


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_says_nothing_of_decks(form: str) -> None:
    text = text_of(form).replace(KML_POSITION, "")  # what KML itself takes altitude for
    if FORMATS[form].binary:
        assert "deck" not in text
    else:
        assert not OF_DECKS.search(text), OF_DECKS.search(text)
        assert "hand.toml" in text and ("flight" in text or form == "czml")


def test_columns_have_the_units_and_the_names_of_the_source() -> None:
    rows = [line for line in text_of("csv").splitlines() if not line.startswith("#")]
    first, *_ = table_rows = list(csv.DictReader(io.StringIO("\n".join(rows))))
    assert first["flight"] == "hand.toml" and first["image"] == "DJI_0000.JPG"
    assert first["altitude_m"] == "1200.0000" and first["airspeed_m_s"] == "30.0000"
    assert float(first["residual_rms_px"]) > 0.0
    assert table_rows[3]["flags"] == "outlier:=A1"
    frame = dataframe([made()])
    assert list(frame["image"]) == [f"DJI_{k:04}.JPG" for k in range(6)]
    assert frame.attrs["flight"] == "hand.toml" and "fixes" not in frame.attrs


def test_sigmas_are_in_the_units_of_the_source() -> None:
    """10 m; the responses to each of three axes are .01 px a metre."""
    one = made()
    through = np.degrees(one.estimate.gain[0].sum(axis=1) * 0.01 * 10.0 * np.sqrt(3.0))
    found = one.uncertainty.components["position"][0, :3]
    assert_close("ratio", found / np.abs(through), 1.0)


def test_positions_in_metres() -> None:
    packet = json.loads(text_of("czml"))[1]
    _, longitude, latitude, height = packet["position"]["cartographicDegrees"][:4]
    assert (longitude, latitude, height) == (7.44, 46.95, 1200.0)
    assert "<name>DJI_0002.JPG</name>" in text_of("kml")


@pytest.mark.parametrize("name", [one for one in FIGURES if one not in ("map", "patches")])
def test_every_figure_names_landmarks_units_and_images(name: str) -> None:
    figure = draw(name, [made()], "DJI_0003.JPG" if name == "image" else None)
    texts = [figure.subfigs[0].get_suptitle()]
    for axis in figure.subfigs[0].axes:
        texts += [axis.get_xlabel(), axis.get_ylabel()]
        texts += [label.get_text() for label in axis.get_xticklabels()]
        texts += [note.get_text() for note in axis.texts]
        legend = axis.get_legend()
        texts += [note.get_text() for note in legend.get_texts()] if legend else []
    shown = "\n".join(texts)
    assert not OF_DECKS.search(shown), shown
    if name in ("residuals", "image"):
        assert "church tower" in shown and "px" in shown
    if name == "image":
        assert "DJI_0003.JPG" in shown
    assert svg(figure).startswith("<?xml")


def test_a_job_without_places_has_no_map() -> None:
    with pytest.raises(VopdError, match="no map"):
        draw("map", [made()])


def test_a_frame_that_is_not_there() -> None:
    with refused(VopdError):
        draw("image", [made()], 4)


def test_the_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """The figures are drawn above; here are their captions."""
    module = sys.modules["vopd.report"]
    monkeypatch.setattr(module, "draw", lambda name, *_, **__: name)
    monkeypatch.setattr(module, "svg", lambda name: f"<svg>{name}</svg>")
    text = report([made()]).decode()
    found = Page(text)
    shown = re.sub(r"base64,[A-Za-z0-9+/=]+|<style>.*?</style>|<script>.*?</script>", "", text)
    columns = frame_columns(text)
    assert not OF_DECKS.search(shown), OF_DECKS.search(shown)
    assert found.tables["frames-table"][0][1:3] == ["frame", "image"]
    assert columns["image"][2] == "DJI_0002.JPG"
    _, *landmarks = found.tables["landmarks-table"]
    names = ["church tower", "bridge; north end", "=A1", "<crossing>"]
    assert [row[0] for row in landmarks] == names
    worst = landmarks[2]
    assert worst[-2:] == ["DJI_0003.JPG", "1"] and "&lt;crossing&gt;" in text
    assert "Fixes in force" not in text


def test_sources_of_different_kinds_make_no_table() -> None:
    with refused(VopdError):
        table([made(), *histories("appendix_h/case1")])


# Spreadsheets


@pytest.mark.parametrize("name", ["=1+2.dat", "+x.dat", "-2+3.dat", "@SUM(A1).dat", "a,=b.dat"])
def test_no_cell_of_a_csv_is_a_formula(name: str) -> None:
    one = about(made(), source=name)
    text = FORMATS["csv"].render([one], FileRequest()).decode()
    for row in csv.reader(io.StringIO(text)):
        for cell in row:
            number = re.fullmatch(r"-\d+\.\d+(e[+-]\d+)?", cell)
            assert number or not cell.strip().startswith(("=", "+", "-", "@")), cell
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("# ")))
    assert rows[1][0].lstrip("'") == name


def test_standard_input_keeps_its_name() -> None:
    text = FORMATS["csv"].render([about(made(), source="-")], FileRequest()).decode()
    assert text.splitlines()[-1].startswith("-,1,6,")
