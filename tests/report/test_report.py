"""The report's page, read as text: what is in it, and what must not be."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import vopd
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History
from vopd.cli import cli
from vopd.export.csv_table import table_text
from vopd.report import report
from vopd.report.tables import SHOWN
from vopd.synthetic.plan import Plan
from vopd.synthetic.scene import make

DECKS = Path(__file__).parents[2] / "decks"
VOID = {"meta", "link", "img", "input", "br", "wbr"}


class Page(HTMLParser):
    """Tables as lists of rows of texts, ids, attributes that load, and whether tags are closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: dict[str, list[list[str]]] = {}
        self.ids: list[str] = []
        self.loads: list[str] = []
        self.scripts = 0
        self._open: list[str] = []
        self._rows: list[list[str]] = []
        self._cell = False
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if tag not in VOID:
            self._open.append(tag)
        self.ids += [given["id"]] if "id" in given else []
        self.loads += [given[name] for name in ("src", "href", "data", "action") if name in given]
        self.scripts += tag == "script"
        assert not [name for name in given if name.startswith("on")]
        if tag == "table":
            self._rows = self.tables[given["id"]] = []
        elif tag == "tr":
            self._rows.append([])
        elif tag in ("td", "th"):
            self._rows[-1].append("")
            self._cell = True

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag
        if tag in ("td", "th"):
            self._cell = False

    def handle_data(self, data: str) -> None:
        if self._cell:
            self._rows[-1][-1] += data


def histories(*names: str, **options: Any) -> list[History]:
    found = []
    for name in names:
        run = vopd.run(vopd.read_deck(DECKS / f"{name}.dat"), deck=f"{name}.dat")
        found += run.histories(**options)
    return found


def page(made: list[History], *rest: Any) -> tuple[str, Page]:
    text = report(made, *rest).decode()
    return text, Page(text)


def flight(frames: int = 30) -> list[History]:
    """A flight with a frame ignored and a landmark read 30 times its error off."""
    job = make(Plan(frames=frames, landmarks=6, seed=2))[0][0]
    readings = job.readings.landmark_in.copy()
    readings[4, 2] += 0.1
    ignored = replace(
        job.ignored, frame=job.readings.frame[7:8], landmark=np.array([[100, 0, 0, 0, 0, 0]])
    )
    job = replace(job, readings=replace(job.readings, landmark_in=readings), ignored=ignored)
    return vopd.run([job], deck="flight.dat").histories()


@pytest.fixture
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """As without matplotlib: pictures take a second a page."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)


@pytest.mark.usefixtures("no_pictures")
def test_every_cell_is_the_csv_s() -> None:
    made = [*histories("appendix_h/case4", "appendix_h/cases_1_2_3"), *flight()]
    _, found = page(made)
    head, *rows = found.tables["frames-table"]
    text = table_text(made)
    assert head == ["deck", *SHOWN] and len(rows) == len(text["frame"])
    for k, name in enumerate(head):
        cells = [row[k] for row in rows]
        if name == "flags":
            cells = [";".join(cell.split()) for cell in cells]
        assert cells == text[name], name


@pytest.mark.usefixtures("no_pictures")
def test_one_deck_needs_no_column_for_it() -> None:
    _, found = page(histories("appendix_h/case4"))
    assert found.tables["frames-table"][0] == list(SHOWN)


@pytest.mark.usefixtures("no_pictures")
def test_landmarks_of_several_decks_name_theirs() -> None:
    _, found = page(histories("appendix_h/case2", "appendix_h/case4"))
    head, *rows = found.tables["landmarks-table"]
    assert head[:4] == ["landmark", "deck", "job", "frames"]
    decks = [(row[1], row[0]) for row in rows]
    assert decks == [("appendix_h/case2.dat", n) for n in ("65", "66", "67")] + [
        ("appendix_h/case4.dat", n) for n in ("28", "62", "69")
    ]


@pytest.mark.usefixtures("no_pictures")
def test_every_column_is_explained() -> None:
    text, _ = page(histories("appendix_h/case4"))
    explained = re.findall(r"<dt>(\w+)</dt><dd>[^<]+</dd>", text.split("What the columns are")[1])
    assert explained[: len(SHOWN)] == list(SHOWN)


@pytest.mark.usefixtures("no_pictures")
def test_a_deck_that_failed_is_told_first() -> None:
    made = histories("appendix_h/case4")
    assert "A deck failed" not in page(made, ["a warning"])[0]
    text, _ = page(made, ["x.dat: No such file"], None, None, True)
    assert "A deck failed" in text.split("<main>")[0] and "x.dat: No such file" in text


@pytest.mark.usefixtures("no_pictures")
def test_where_nothing_is_known_it_says_so() -> None:
    """A frame whose residuals vanish has no sigmas."""
    text, _ = page(histories("regression/vanished"))
    assert "<dt>Median sigma of alpha, beta, eta</dt><dd>unknown</dd>" in text
    assert "; 1 frame</dd>" in text


@pytest.mark.usefixtures("no_pictures")
def test_the_flags_are_explained_and_counted() -> None:
    _, found = page(flight())
    head, *rows = found.tables["flags-table"]
    assert [row[0] for row in rows] == list(MEANING)
    counts = {row[0]: int(row[1]) for row in rows}
    assert counts["outlier"] == 1 and counts["jump"] == 0
    assert head == ["flag", "frames", "meaning", "what to do"]


@pytest.mark.usefixtures("no_pictures")
def test_landmarks_by_hand() -> None:
    """Case 4: landmarks 28 and 62 in two frames, a third frame ignored; golden residuals."""
    _, found = page(histories("appendix_h/case4"))
    _, first, second, third = found.tables["landmarks-table"]
    x, y = np.array([0.00888, 0.01133]) * 1e3, np.array([0.02759, 0.03565]) * 1e3
    assert first[:4] == ["28", "1", "2", "0"] and second[0] == "62"
    assert third == ["69", "1", "0", "2", *[""] * 6, "0"]
    expected = [x.mean(), y.mean(), np.sqrt((x**2).mean()), np.sqrt((y**2).mean())]
    expected.append(np.hypot(x[1], y[1]))
    assert np.abs(np.array(first[4:9], float) - expected).max() < 0.02  # of residuals to 10 nm
    assert first[9:] == ["65", "0"]


def test_it_loads_nothing_and_every_id_is_its_own() -> None:
    text, found = page(histories("appendix_h/case4"))
    assert len(found.ids) == len(set(found.ids)) and found.scripts == 1
    for load in found.loads:
        assert load.startswith(("#", "data:")), load
        assert not load.startswith("#") or load[1:] in found.ids
    without_pictures = re.sub(r"base64,[A-Za-z0-9+/=]+", "", text)
    assert not re.findall(r"https?://", without_pictures)
    assert "default-src 'none'" in text and "unsafe-inline" not in text


def test_the_same_page_twice() -> None:
    """But for the pictures, whose SVG names its parts by where they lie in memory."""
    made = histories("appendix_h/case4")
    pages = [re.sub(rb"base64,[A-Za-z0-9+/=]+", b"", report(made)) for _ in range(2)]
    assert pages[0] == pages[1]


@pytest.mark.parametrize("where", ["deck", "title", "remark"])
def test_hostile_names_stay_text(where: str) -> None:
    bad = "</script><script>alert(1)</script><img src=x onerror=alert(2)>&\"'{{style}}"
    (one,) = histories("appendix_h/case4")
    remarks = [bad] if where == "remark" else []
    if where == "deck":
        one = replace(one, deck=bad)
    if where == "title":
        results = replace(one.results, job=replace(one.results.job, title="1" + bad))
        one = replace(one, results=results)
    text, found = page([one], remarks)
    assert found.scripts == 1 and "<script>alert" not in text and "onerror=alert(2)>&" not in text
    assert "{{style}}" in text  # as it was given, not filled in


@pytest.mark.usefixtures("no_pictures")
def test_remarks_sigmas_and_rate_are_said() -> None:
    made = histories("appendix_h/case4")
    sigmas = vopd.Sigmas(reading_mm=0.004, position_ft=120.0, focal_mm=0.02, time_s=0.3)
    text, _ = page(made, ["deck x: card 3: odd"], sigmas, 45.0)
    for said in ("deck x: card 3: odd", "120 ft", "0.02 mm", "0.3 s", "45 degrees a second"):
        assert said in text
    assert "as asked" in text and "by its three readings" not in text


@pytest.mark.usefixtures("no_pictures")
def test_fixes_in_force_are_first() -> None:
    from vopd.errata import fixes

    jobs = vopd.read_deck(DECKS / "appendix_h" / "case4.dat")
    text, _ = page(vopd.run(jobs, fixes("earth"), deck="case4").histories())
    before, after = text.split("Corrected run, not the original")
    assert "earth (WGS 84)" in after[:200] and "<main>" not in before


@pytest.mark.usefixtures("no_pictures")
def test_without_matplotlib_the_rest_is_there() -> None:
    text, found = page(histories("appendix_h/case4"))
    assert "pip install &#x27;vopd[plots]&#x27;" in text and "frames-table" in found.tables


def run(*arguments: str) -> Result:
    return CliRunner().invoke(cli, ["report", *arguments])


def test_the_command(tmp_path: Path) -> None:
    out = tmp_path / "r.html"
    case4 = str(DECKS / "appendix_h" / "case4.dat")
    assert run(case4, "-o", str(out)).exit_code == 0
    assert "frames-table" in Page(out.read_text()).tables
    assert run(case4, "-o", str(out), "--strict").exit_code == 3
    wind = str(DECKS / "regression" / "wind_out_of_order.dat")
    assert run(wind, case4, "-q", "-o", str(out)).exit_code == 1
    text = out.read_text()
    assert "altitudes out of order at position 2" in text and "A deck failed" in text


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (["appendix_h/case4.dat", "-o", "r.pdf"], 2, "name the file .html"),
        (["appendix_h/case4.dat", "-o", "no/such/r.html"], 1, "cannot be written"),
        (["appendix_h/case4.dat", "-o", "r.html", "--time-sigma", "-1"], 2, "time sigma"),
        (["regression/lens_out_of_order.dat", "-o", "r.html"], 1, "out of order"),
        (["none.dat", "-o", "r.html"], 1, "No such file"),
    ],
)
def test_mistakes_leave_no_file(
    arguments: list[str], status: int, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(str(DECKS / arguments[0]), *arguments[1:])
    assert result.exit_code == status and said in result.stderr + str(result.exception)
    assert isinstance(result.exception, SystemExit | vopd.VopdError)
    assert list(tmp_path.iterdir()) == []
