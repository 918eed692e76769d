"""The pages of `vopd stars tables` line by line: titles, heads, labels, decimals, marks, notes."""

from __future__ import annotations

import re

import pytest

from vopd.stellar.tables_1987 import ReportRow, ReportTable, as_text, compared_row, tables

SKY = ["right ascension", "declination", "x mm", "y mm"]
PAIRS = ["stars 1,2", "stars 1,3", "stars 1,4", "stars 2,3", "stars 2,4", "stars 3,4"]
METHODS = ["collinearity", "two-star unit", "two-star raw", "single-rotation"]
STARS = ["star 1", "star 2", "star 3", "star 4"]
ANGLE = r"-?\d+°\d\d'\d\d\.\d{4}\""
MILLIMETRES = r"-?\d+\.\d{3}"
LOST = "The figures are lost in the scan."

PAGES = (
    (
        "Table 6.1. Error-free images; stars by RADEC2, principal distance 76 mm",
        SKY,
        STARS,
        [ANGLE, ANGLE, MILLIMETRES, MILLIMETRES],
        [],
    ),
    (
        "Table 6.2. Direction cosines of the stars and of the perturbed images",
        ["U", "V", "W", "P", "Q", "R"],
        STARS,
        [r"-?0\.\d{10}"] * 6,
        ["* misprint (the R of row 4 stands in row 3 too): should be -0.91402619"],
    ),
    (
        "Table 6.3. Perturbed images; stars by RADEC2, principal distance 76 mm",
        SKY,
        STARS,
        [ANGLE, ANGLE, MILLIMETRES, MILLIMETRES],
        [],
    ),
    (
        "Table 6.4. Errors of the angles, truth minus estimate, degrees",
        ["omega", "phi", "kappa"],
        ["collinearity", "church-weighted", "church"],
        [r"-?0\.\d{7}"] * 3,
        [
            "* misprint (an 8 for a 5): should be -0.2315",
            "+ one unit off. STARS prints the angles before each of its four corrections: those",
            "  after three come last. From 140, -10, 45, say, their errors are 0.0151, 0.0216, "
            "-0.0605.",
        ],
    ),
    (
        "Table 6.5. Rotation axes and angles of the single rotations",
        ["XR", "YR", "ZR", "angle, deg", "sin(D1,D2)"],
        PAIRS,
        [r"-?0\.\d{8}", r"-?0\.\d{8}", r"-?0\.\d{8}", r"-?15\d\.\d{8}", r"0\.\d\d"],
        ["The report's values are lost in the scan. sin(D1,D2) is not among them."],
    ),
    *(
        (
            f"Figure 6.{k}. Error of {name}, truth minus estimate, degrees",
            METHODS,
            PAIRS,
            [r"-?[01]\.\d{7}"] * 4,
            [LOST],
        )
        for k, name in ((1, "omega"), (2, "phi"), (3, "kappa"))
    ),
    (
        "As listed. What TUSTAR and TRUOPK answer, degrees",
        ["omega", "phi", "kappa", "alpha", "delta", "swing"],
        ["TUSTAR, stars 1,2 of table 6.1", "TRUOPK, church", "TRUOPK, church-weighted"],
        None,
        [],
    ),
)


@pytest.fixture(scope="module")
def made() -> list[ReportTable]:
    return tables()


@pytest.mark.parametrize("k", range(len(PAGES)), ids=[page[0].split(".")[0] for page in PAGES])
def test_title_heads_labels_decimals_and_notes(k: int, made: list[ReportTable]) -> None:
    assert len(made) == len(PAGES)
    title, heads, labels, forms, notes = PAGES[k]
    page = made[k]
    assert (page.title, list(page.columns), list(page.notes)) == (title, heads, notes)
    assert [row.label for row in page.rows] == labels
    for row in page.rows if forms else ():
        for form, cell in zip(forms, row.computed, strict=True):
            assert re.fullmatch(form, cell), cell
        assert len(row.printed) in (0, len(heads))


def test_images_of_tables_6_1_and_6_3_and_what_tustar_and_truopk_answer(
    made: list[ReportTable],
) -> None:
    """The report's data; on exact images TUSTAR errs in phi and delta alone (appendix D)."""
    images = [[row.computed[2:] for row in made[k].rows] for k in (0, 2)]
    assert images == [
        [["24.000", "24.000"], ["-15.000", "15.000"], ["-24.000", "-24.000"],
         ["20.000", "-10.000"]],
        [["24.100", "23.800"], ["-15.200", "15.300"], ["-23.700", "-24.000"],
         ["19.800", "-10.000"]],
    ]  # fmt: skip
    tustar, *truopk = (list(row.computed) for row in made[-1].rows)
    assert tustar == ["156.1413", "-167.6259", "46.0052", "50.0000", "68.9639", "10.0000"]
    assert truopk == [["not found"] * 3] * 2


def test_where_computed_and_printed_numbers_stand() -> None:
    """Labels to the longest, `computed` and `printed` in ten columns, cells to the widest."""
    rows = [
        ReportRow("one", ["1.25", "-2.5"], ["1.3", "-2.56789"], ["*", ""]),
        ReportRow("three", ["3.5", "4.5"]),
    ]
    text = as_text(ReportTable("A title", ("a", "bb"), rows, ["* a note"]))
    assert text == (
        "A title\n"
        "                       a        bb\n"
        "one    computed     1.25      -2.5\n"
        "       printed       1.3* -2.56789\n"
        "three  computed      3.5       4.5\n"
        "* a note\n"
    )


def test_where_nothing_was_printed_the_label_alone_stands_before_the_numbers() -> None:
    rows = [ReportRow("one", ["1", "22"]), ReportRow("three", ["3", "4"])]
    text = as_text(ReportTable("A title", ("head", "b"), rows))
    assert text == "A title\n       head     b\none       1    22\nthree     3     4\n"


@pytest.mark.parametrize(
    ("table", "key", "column", "number", "text", "mark"),
    [
        ("6.2", "3", "R", -0.914026192, "-0.95994801", "*"),
        ("6.2", "3", "R", -0.959948010, "-0.95994801", ""),  # agrees: no mark, misprint or not
        ("6.2", "3", "Q", -0.914026192, "-0.95994801", "+"),
        ("6.2", "4", "R", -0.914026192, "-0.95994801", "+"),
        ("6.4", "church", "kappa", -0.2314807, "-0.2318", "*"),
        ("6.4", "church", "kappa", -0.2314807, "-0.231", ""),  # to the printed digits
        ("6.4", "church", "kappa", -0.2314807, "-0.2314", "*"),
        ("6.4", "collinearity", "kappa", -0.0604366, "-0.0605", "+"),
        ("6.4", "collinearity", "kappa", -0.0604366, "-0.0604", ""),
    ],
)
def test_which_mark_a_printed_number_has(
    table: str, key: str, column: str, number: float, text: str, mark: str
) -> None:
    row = compared_row(table, key, "a label", [number], [column], 5, [text])
    assert row == ReportRow("a label", [f"{number:.5f}"], [text], [mark])
