"""The comparison and the update: what fails, and what may not be approved unnamed."""

from __future__ import annotations

import base64
from dataclasses import replace
from pathlib import Path

import pytest

from tests.approved.approved import EXPECTED, GROUPS, Group
from tests.approved.cases import Case, Outcome, read_cases, rounded, run_case
from tests.approved.compare import compare
from tests.approved.content import content
from tests.approved.store import Folders, OneText, Store
from tests.approved.update import refusals, update

TABLE = (
    "# rows: 2\nframe,yaw_deg,last_correction_rad,flags\n1,35.123456,2.1e-16,\n2,36.5,0.0,jump\n"
)
ERRATA = Case("errata-restart", ("errata restart",))
NOTHING: dict[str, list[str]] = {"new": [], "texts": [], "numbers": []}


def kinds(expected: str, actual: str) -> list[str]:
    return [difference.kind for difference in compare(expected, actual)]


@pytest.mark.parametrize(
    ("was", "now", "expected"),
    [
        ("35.123456", "35.123457", []),  # one unit of the last digit
        ("35.123456", "35.123458", ["number"]),
        ("36.5", "36.6", ["number"]),  # few digits are printed as they are
        ("36.5", "36.50000001", []),  # the unit of the column
        ("36.5", "36.5000002", ["number"]),
        ("2.1e-16", "-3.4e-15", []),  # rounding, by a row of its own
        ("2.1e-16", "2.1e-07", ["number"]),
        ("2,36.5", "3,36.5", ["number"]),
        ("rows: 2", "rows: 3", ["number"]),
        ("yaw_deg", "yaw", ["text"]),
        ("rows", "lines", ["text"]),
        ("jump", "", ["text"]),
        ("2,36.5,0.0,jump\n", "", ["rows", "text"]),
        ("36.5", "nan", ["rows", "text"]),
    ],
)
def test_what_differs(was: str, now: str, expected: list[str]) -> None:
    assert kinds(TABLE, TABLE.replace(was, now)) == expected


@pytest.mark.parametrize(
    ("expected", "actual", "kind"),
    [
        ('{"a_deg": [1.0, 2.123456789012]}', '{"a_deg": [1.0, 2.123456781]}', []),
        ('{"a_deg": [1.0, 2.123456789012]}', '{"a_deg": [1.0, 2.1234]}', ["number"]),
        ("  -.00000  13.0", "   .00000  13.0", []),  # a blank in place of the sign
        ("  -.00000  13.0", "   .00003  13.0", ["number"]),
        ("  -.00000  13.0", "    .00000  13.0", ["text"]),
        ("a = 1.0000001  # b", "a = 1.00000011 # b", []),
        ("112.175-158.836", "112.175-158.837", []),
        ("112.175-158.836", "112.175 158.836", ["number"]),
        ("off by 1.5 px", "at most 1.5 px", ["text"]),
        ("off by 1.5 px", "at most 1.6 px", ["number", "text"]),
        ("two lines\nof words 7", "one line of words 7", ["text"]),
        ("two lines\nof words 7", "one line of words 8", ["number", "text"]),
    ],
)
def test_lines(expected: str, actual: str, kind: list[str]) -> None:
    assert kinds(expected, actual) == kind


def test_binary_files_are_their_content() -> None:
    png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (640).to_bytes(4) + (480).to_bytes(4)
    assert content(png) == "PNG, 640 x 480 pixels\n"
    drawing = base64.b64encode(b'<svg viewBox="0 0 72.0 36.2"></svg>')
    assert content(b'<img src="data:image/svg+xml;base64,' + drawing + b'">') == (
        '<img src="data:image/svg+xml;base64,SVG, 72 x 36 points">'
    )


def test_names_are_unique_and_every_expected_output_has_a_case() -> None:
    groups = [read() for read in GROUPS.values()]
    names = [case.name for group in groups for case in group.cases]
    assert len(set(names)) == len(names)
    assert set().union(*(group.store.names() for group in groups)) == set(names)


@pytest.fixture(params=[Folders, OneText])
def kept(request: pytest.FixtureRequest, tmp_path: Path) -> Store:
    """One case with its expected output."""
    store: Store = request.param(tmp_path / "expected")
    done, refused = update(Group([ERRATA], store))
    assert (done["new"], refused) == ([ERRATA.name], {})
    again: Store = request.param(tmp_path / "expected")
    assert again.names() == {ERRATA.name}
    assert again.read(ERRATA.name) == store.read(ERRATA.name)
    return again


@pytest.mark.parametrize(
    ("output", "was", "now", "may"),
    [
        ("stdout", "restart", "begin again", True),
        ("stdout", "360", "361", False),
        ("files/list.json", "", "new", False),
    ],
)
def test_only_words_are_approved_unnamed(
    kept: Store, output: str, was: str, now: str, may: bool
) -> None:
    before = kept.read(ERRATA.name)
    assert before is not None
    changed = before | {output: before.get(output, "").replace(was, now)}
    assert changed != before
    kept.write(ERRATA.name, changed)
    done, refused = update(Group([ERRATA], kept))
    assert (done["texts"], list(refused)) == (([ERRATA.name], []) if may else ([], [ERRATA.name]))
    done, refused = update(Group([ERRATA], kept), numbers=["errata-*"])
    assert (done["numbers"], refused) == ([] if may else [ERRATA.name], {})
    assert kept.read(ERRATA.name) == before
    assert update(Group([ERRATA], kept)) == (NOTHING, {})


def test_only_cases_that_are_named_run(kept: Store) -> None:
    kept.write(ERRATA.name, {})
    assert update(Group([ERRATA], kept), only=["run-*"]) == (NOTHING, {})


def test_a_status_is_never_approved(kept: Store) -> None:
    _, refused = update(Group([replace(ERRATA, statuses=(1,))], kept), numbers=["*"])
    assert refused == {ERRATA.name: ["status 0, the case has 1"]}


def test_a_status_that_is_kept_with_the_outputs_is_a_number(tmp_path: Path) -> None:
    trial = Group([Case("trial", ("run no.dat",), statuses=None)], OneText(tmp_path / "a.txt"))
    update(trial)
    assert trial.store.read("trial") == {
        "stdout": "", "stderr": "no.dat: No such file or directory\n", "status": "1",
    }  # fmt: skip
    trial.store.write("trial", {**(trial.store.read("trial") or {}), "status": "0"})
    assert update(trial)[1] == {"trial": ["status: line 1: 0 now 1"]}


def test_a_missing_file_is_refused() -> None:
    outcome = Outcome((0,), {"stdout": ""})
    assert refusals(ERRATA, outcome, {"stdout": "", "stderr": "a"}, False) == [
        "stderr is no longer written"
    ]


def test_update_writes_nothing_else(kept: Store) -> None:
    before = {path: path.stat().st_mtime_ns for path in EXPECTED.rglob("*")}
    kept.write(ERRATA.name, {"stdout": "other words"})
    update(Group([ERRATA], kept), numbers=["*"])
    assert before == {path: path.stat().st_mtime_ns for path in EXPECTED.rglob("*")}


def test_third_parties_have_their_own_words(tmp_path: Path) -> None:
    case = Case("none", ("run no.dat",), statuses=(1,), third_party=("no.dat: ",))
    assert run_case(case, tmp_path).outputs["stderr"].endswith("no.dat: ...\n")


def test_noise_has_no_numbers(tmp_path: Path) -> None:
    case = Case("noise", ("cards case1.dat --card 38",), ("decks/appendix_h/case1.dat",))
    kept = run_case(replace(case, noise=("stdout",)), tmp_path).outputs["stdout"]
    assert kept.startswith("card #, group #: focal length")


def test_long_outputs_are_shortened(tmp_path: Path) -> None:
    case = Case("long", ("demo --frames 20",), every=100)
    lines = run_case(replace(case, every=None), tmp_path).outputs["stdout"].splitlines()
    kept = run_case(case, tmp_path).outputs["stdout"].splitlines()
    assert kept == lines[:40] + lines[40::100]
    assert run_case(replace(case, every=1000), tmp_path).outputs["stdout"].splitlines() == lines


def test_variants_have_all_inputs_and_changes_of_their_own(tmp_path: Path) -> None:
    case = Case(
        "variants",
        ("check {variants}",),
        inputs=("examples/hill",),
        files={"flight.toml": ["F12", "F13"], "more/a.txt": "new"},
        variants={"one": {}, "two": {"flight.toml": ["F13", "F14", "[track]", "[trak]"]}},
        statuses=(1,),
    )
    outcome = run_case(case, tmp_path)
    assert outcome.outputs["stdout"].startswith("one/flight.toml: no errors")
    assert "error: two/flight.toml: [trak] is not known" in outcome.outputs["stdout"]
    assert (tmp_path / "two" / "more" / "a.txt").read_text() == "new"
    assert '"F14"' in (tmp_path / "two" / "flight.toml").read_text()


def test_a_text_that_is_not_there_cannot_be_replaced(tmp_path: Path) -> None:
    case = Case("none", ("check flight.toml",), ("examples/hill",), {"flight.toml": ["F99", "a"]})
    with pytest.raises(ValueError, match=r"'F99' stands there 0 times"):
        run_case(case, tmp_path)


def test_a_case_with_an_unknown_key(tmp_path: Path) -> None:
    (tmp_path / "one.toml").write_text('[[case]]\nname = "a"\ncommand = "run"\nfoo = 1')
    with pytest.raises(ValueError, match=r"one.toml: a: unknown key foo"):
        read_cases(tmp_path / "one.toml")


def test_cells_with_several_numbers_and_counts_of_corrections() -> None:
    cells = "a,residuals_mm,iterations\nb,0.123456789012 -1.5,7\nc,2.5,3\n"
    assert kinds(cells, cells.replace("9012", "9017").replace(",7", ",6")) == []
    assert kinds(cells, cells.replace("-1.5", "-1.6")) == ["number"]
    assert kinds(cells, cells.replace(",7", ",4")) == ["number"]
    assert kinds("\n7 corrections\n", "\n6 corrections\n") == []
    assert kinds("\n7 stars\n", "\n6 stars\n") == ["number"]


def test_digits_that_are_kept() -> None:
    text = "1.23456789 px, -0.000123456 mm, 2026-05-01T11:58:42.5Z, v1.2.3, 12 1.5e-17"
    assert rounded(text, 3) == "1.23 px, -0.000123 mm, 2026-05-01T11:58:42.5Z, v1.2.3, 12 1.5e-17"
    assert rounded(text, None) == text
