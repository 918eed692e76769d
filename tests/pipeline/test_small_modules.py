"""Findings, fixes, signatures, copies and kinds: the small modules that all rooms use."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS
from tests.kit.jobs import RESULT_ARRAYS, reread
from vopd.errata import NO_FIXES, Fix, Fixes, fixes
from vopd.estimate import About
from vopd.files import SIGNATURES, kind_by_first_bytes
from vopd.findings import (
    MOST_RUNS,
    Finding,
    InputError,
    VopdError,
    angle_text,
    finding_of,
    first_of_each_kind,
    frames_text,
    input_error,
    kind_of,
    raising,
    size_text,
    strict,
)
from vopd.geometry.ellipsoids import ELLIPSOIDS
from vopd.inputs import no_file
from vopd.job import copied_readings_text
from vopd.pipeline import SolveOptions, is_flight, solve_decks, solve_sources
from vopd.results import CONVERGED_RAD, Outcome, SolvedJob, SourceEnd
from vopd.synthetic import Plan
from vopd.synthetic.flight import make


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(0.0312, 2, "0.031"), (9.96, 2, "10"), (99.6, 2, "100"), (324.6, 2, "320"),
     (2064.0, 3, "2060"), (999_400.0, 2, "1000000"), (2e6, 2, "2e+06"), (-151.0, 2, "-150"),
     (1e-9, 2, "1e-09"), (np.inf, 2, "inf")],
)  # fmt: skip
def test_sizes_have_few_digits_and_no_exponent(value: float, digits: int, text: str) -> None:
    """A warning spoke of 3.2e+02 standard deviations."""
    assert size_text(value, digits) == text


@pytest.mark.parametrize(
    ("angle_deg", "circle", "half"),
    [(359.996, "0.00", "0.00"), (359.994, "359.99", "-0.01"), (179.996, "180.00", "180.00"),
     (180.006, "180.01", "-179.99"), (-179.996, "180.00", "180.00"), (-1e-9, "0.00", "0.00"),
     (725.0, "5.00", "5.00"), (-90.0, "270.00", "-90.00"), (np.nan, "nan", "nan")],
)  # fmt: skip
def test_an_angle_that_is_rounded_stays_in_its_range(
    angle_deg: float, circle: str, half: str
) -> None:
    assert [angle_text(angle_deg, 2, one) for one in (False, True)] == [circle, half]


@pytest.mark.parametrize(
    ("labels", "text"),
    [
        (["7"], "frame 7"), (["7", "8"], "frames 7-8"), (["7", "9"], "frames 7, 9"),
        (["7", "9", "10", "11", "20"], "frames 7, 9-11, 20"), (["A.JPG"], "frame A.JPG"),
        (["1.jpg", "2.jpg"], "frames 1.jpg, 2.jpg"), (["9", "8", "7"], "frames 9, 8, 7"),
        (["7", "A", "8"], "frames 7, A, 8"),
    ],
)  # fmt: skip
def test_frames_as_text(labels: list[str], text: str) -> None:
    assert frames_text(labels) == text


def test_of_many_runs_of_frames_the_others_are_counted_by_frames() -> None:
    """Runs of two: 2-3, 5-6 ...; of 22 runs two are left out, which are four frames."""
    assert MOST_RUNS == 20
    for count, more in ((20, ""), (21, " and 2 more"), (22, " and 4 more")):
        labels = [str(3 * k + n) for k in range(1, count + 1) for n in (0, 1)]
        named = ", ".join(f"{3 * k}-{3 * k + 1}" for k in range(1, 21))
        assert frames_text(labels) == f"frames {named}{more}"


FULL = Finding("odd", "a.dat", 12, 2, 9, "latitude", (11, 20), "0123456789ABCDEFGHIJ  ")


@pytest.mark.parametrize(
    ("changes", "headline"),
    [
        ({}, "a.dat: card 12, job 2, group 9, latitude (columns 11-20): odd"),
        ({"columns": (5, 5)}, "a.dat: card 12, job 2, group 9, latitude (column 5): odd"),
        ({"field": ""}, "a.dat: card 12, job 2, group 9, (columns 11-20): odd"),
        ({"group": 0, "columns": None}, "a.dat: card 12, job 2, basic data, latitude: odd"),
        ({"card": None, "job": None, "group": None, "field": "", "columns": None}, "a.dat: odd"),
        ({"source": "", "card": None, "job": None, "field": "", "columns": None}, "group 9: odd"),
    ],
)
def test_the_headline_of_a_finding(changes: dict[str, Any], headline: str) -> None:
    assert replace(FULL, **changes).headline() == headline


def test_a_finding_shows_its_card_under_a_ruler() -> None:
    lines = str(FULL).splitlines()
    assert lines[0] == FULL.headline() and len(lines) == 5
    tens, ones, card, marks = (line.removeprefix("    ") for line in lines[1:])
    assert (
        tens == "         1         2         3         4         5         6         7         8"
    )
    assert ones == "1234567890" * 8 and card == "0123456789ABCDEFGHIJ"
    assert marks == " " * 10 + "^" * 10
    assert str(replace(FULL, columns=(3, 3))).splitlines()[-1] == "    " + "  ^"
    for changes in ({"image": None}, {"columns": None}):
        assert "\n" not in str(replace(FULL, **changes))


def test_errors_are_raised_and_warnings_kept() -> None:
    kept: list[Finding] = []
    report = raising(kept.append)
    warning = FULL.warned()
    assert (warning.severity, warning.message, FULL.severity) == ("warning", "odd", "error")
    report(warning)
    strict(warning)
    with pytest.raises(InputError) as raised:
        report(FULL)
    assert kept == [warning] and raised.value.finding == FULL and str(raised.value) == str(FULL)


def test_kinds_of_findings_are_all_but_the_card_and_the_numbers() -> None:
    one = Finding("'A' is 1.5 off, not -2e-3", "a", 1, 2, 3, "x", severity="warning")
    alike = replace(one, message='"BC" is 12,000 off, not 7', card=9, columns=(1, 2), image="y")
    assert kind_of(alike) == kind_of(one)
    for changes in (
        {"message": "'A' is 1.5 of, not -2e-3"}, {"source": "b"}, {"job": 3}, {"group": 4},
        {"field": "y"}, {"severity": "error"},
    ):  # fmt: skip
        assert kind_of(replace(one, **changes)) != kind_of(one)


@pytest.mark.parametrize(
    ("most", "kept", "left"), [(1, "1a", [4, 1]), (2, "12ab", [3]), (5, "12345ab", [])]
)
def test_the_first_findings_of_each_kind(most: int, kept: str, left: list[int]) -> None:
    """Five of one kind, and two of another among them; the last that is kept is the example."""
    found = [Finding("x", card=int(c)) if c.isdigit() else Finding("y", field=" ", image=c)
             for c in "12a34b5"]  # fmt: skip
    shown, rest = first_of_each_kind(found, most)
    names = [str(one.card) if one.card else str(one.image) for one in shown]
    assert sorted(names) == sorted(kept) and shown == [one for one in found if one in shown]
    assert [count for _, count in rest] == left
    for example, _ in rest:
        assert example == [one for one in shown if one.message == example.message][-1]


# Fixes


def test_fixes_stand_in_the_order_of_the_errata() -> None:
    names = [fix.value for fix in Fix]
    assert (
        str(fixes(*reversed(names)))
        == str(fixes("all"))
        == ", ".join("earth (WGS 84)" if name == "earth" else name for name in names)
    )
    for pair in (("restart", "latitude-series"), ("eight-digits", "first-landmark"),
                 ("standard-deviation", "sin-6phi")):  # fmt: skip
        assert str(fixes(*pair)) == f"{pair[1]}, {pair[0]}"
    for name, ellipsoid in ELLIPSOIDS.items():
        assert str(fixes("earth", ellipsoid=name)) == f"earth ({ellipsoid.label})"
    assert not NO_FIXES and str(NO_FIXES) == "" and Fix.EARTH not in NO_FIXES
    assert Fix.EARTH in fixes("earth") and Fix.RESTART not in fixes("earth")


def test_fixes_that_are_none() -> None:
    unknown: Any = frozenset({"earth"})
    with refused(VopdError):
        fixes("restart", "c", "b")
    with refused(VopdError):
        fixes("all", ellipsoid="x")
    with refused(VopdError):
        Fixes(unknown)
    assert [*ELLIPSOIDS][:2] == ["wgs84", "international1924"]


def test_which_fixes_are_chosen() -> None:
    assert fixes().chosen == frozenset() and fixes("all").chosen == frozenset(Fix)
    assert fixes("restart", "all").chosen == frozenset(Fix)
    assert fixes("earth", "restart").chosen == {Fix.EARTH, Fix.RESTART}
    assert fixes("earth").ellipsoid.label == Fixes().ellipsoid.label == "WGS 84"
    assert fixes("all", ellipsoid="clarke1866").ellipsoid is ELLIPSOIDS["clarke1866"]
    assert bool(fixes("earth")) and not fixes()
    assert [(fix.name, fix.value) for fix in Fix] == [
        ("LATITUDE_SERIES", "latitude-series"), ("FIRST_LANDMARK", "first-landmark"),
        ("RESTART", "restart"), ("EARTH", "earth"), ("SIN_6PHI", "sin-6phi"),
        ("FEET_PER_KM", "feet-per-km"), ("EIGHT_DIGITS", "eight-digits"),
        ("STANDARD_DEVIATION", "standard-deviation"),
    ]  # fmt: skip


# Files and readings


def test_what_a_file_is_by_its_first_bytes() -> None:
    for start, kind in SIGNATURES:
        assert kind_by_first_bytes(start + b"more") == kind
        assert kind_by_first_bytes(b" " + start) is None
        if start != b"\xff\xfe\0\0":  # the mark of UTF-32 begins as that of UTF-16 does
            assert kind_by_first_bytes(start[:-1]) is None
    assert kind_by_first_bytes(b"\xff\xfe\0") == dict(SIGNATURES)[b"\xff\xfe"]
    assert kind_by_first_bytes(b"") is None
    assert_approved([f"{start!r}: {kind}" for start, kind in SIGNATURES])


def test_a_device_is_no_file() -> None:
    """Also the one that is empty, which may stand where a pipe may."""
    assert no_file(os.devnull, pipes=True) == no_file(__file__) == ""
    assert_approved(no_file(os.devnull))


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no system of Unix")
def test_a_device_without_an_end_is_none_even_where_a_pipe_may_be() -> None:
    assert no_file("/dev/zero", pipes=True) == no_file(os.devnull)


@pytest.mark.parametrize(("copied", "said"), [(0, False), (3, False), (4, True), (6, True)])
def test_copies_are_more_than_half_of_the_points(copied: int, said: bool) -> None:
    """Case 1 has four fiducials, and here two landmarks: six points."""
    (job,) = vopd.read_deck(CASE_1)
    r = job.readings
    landmark, fiducial = r.landmark_in[:, :2].copy(), r.fiducial_in.copy()
    every = [fiducial[0, k] for k in range(4)] + [landmark[0, k] for k in range(2)]
    for k, point in enumerate(every):
        point[1:] = point[0]
        if k >= copied:
            point[2, k % 2] += 0.001
    two = reread(r, landmark=r.landmark[:, :2], present=r.present[:, :2], landmark_in=landmark,
                  fiducial_in=fiducial)  # fmt: skip
    text = copied_readings_text(two)
    assert bool(text) is said
    if said:
        assert_approved(text, parts=[f"{copied} of 6"])


# Decks and jobs


def test_findings_of_the_cards_come_before_those_of_the_solve() -> None:
    job = vopd.read_deck(CASE_1)[0]
    lost = replace(job, camera=replace(job.camera, initial_deg=np.array([18.0, 80.0, 285.0])))
    card = Finding("odd", "a.dat", 5, severity="warning")
    run = vopd.run(vopd.Deck((lost, lost), "a.dat", (card,)))
    assert run.findings[0] == card and [one.job for one in run.findings] == [None, 1, 2]
    assert vopd.run(vopd.Deck((job,), "a.dat", (card,))).findings == (card,)


@pytest.mark.parametrize("rows", [50, 51])
def test_the_array_sizes_of_1974_bind_where_they_are_asked_for(rows: int, tmp_path: Path) -> None:
    deck = tmp_path / "long.dat"
    deck.write_text(vopd.write_deck(make(Plan(frames=2, trajectory_rows=rows))[0]))
    for wanted in (False, True):
        *_, end = solve_decks([str(deck)], SolveOptions(limits_1974=wanted))
        assert isinstance(end, SourceEnd)
        assert (end.error is not None) == (wanted and rows == 51)
        assert end.error is None or "the original's array" in str(end.error)


def test_every_deck_has_its_end_after_one_that_failed(tmp_path: Path) -> None:
    """A deck that stops, a good one, one that is not there, and a good one again."""
    stops = str(DECKS / "regression" / "lens_out_of_order.dat")
    names = [stops, str(CASE_1), str(tmp_path / "none.dat"), str(CASE_1)]
    found = [
        (one.source, "job" if isinstance(one, SolvedJob) else one.error is not None)
        for one in solve_decks(names)
    ]
    jobs = [name for name, what in found if what == "job"]
    ends = [(name, failed) for name, failed in found if failed != "job"]
    assert jobs == [stops, str(CASE_1), str(CASE_1)]
    assert ends == [
        (name, failed) for name, failed in zip(names, (True, False, True, False), strict=True)
    ]
    flights = [*solve_sources([str(tmp_path / "none.toml"), str(CASE_1)])]
    assert isinstance(flights[0], SourceEnd) and str(flights[0].error).endswith(
        "No such file or directory"
    )
    assert isinstance(flights[1], SolvedJob)
    assert [is_flight(name) for name in ("a.toml", "A.TOML", "toml", "a.toml.dat", "-")] == [
        True, True, False, False, False,
    ]  # fmt: skip


def test_a_history_flags_what_turns_too_fast_against_a_neighbour() -> None:
    """The run hands all three arguments on."""
    run = vopd.run(vopd.read_deck(DECKS / "appendix_h" / "case4.dat"))
    (slow,), (fast,) = run.histories(), run.histories(max_rate_deg_s=1e-6)
    assert not slow.flags.raised["jump"].any() and fast.flags.raised["jump"].sum() == 2
    (given,) = run.histories(vopd.Sigmas(reading=0.125))
    assert given.uncertainty.reading.sigma == 0.125
    (turned,) = run.histories(vertical="geodetic")
    assert turned.estimate.position.vertical == "geodetic"
    assert slow.estimate.position.vertical == "geocentric"


@pytest.mark.parametrize(
    ("correction", "converged"),
    [(1e-6, True), (1.1e-6, False), (-1e-6, True), (-1.1e-6, False), (np.nan, False)],
)
def test_when_a_frame_has_converged(correction: float, converged: bool) -> None:
    """Every angle, and only of frames that were solved."""
    assert CONVERGED_RAD == 1e-6
    (results,) = vopd.run(vopd.read_deck(CASE_1))
    for angle in range(3):
        last = np.zeros((1, 3))
        last[0, angle] = correction
        for outcome in Outcome:
            one = replace_values(results, correction_rad=last, outcome=np.array([outcome]))
            solved = outcome in (Outcome.SOLVED, Outcome.EXACT_LATE)
            assert one.solved.tolist() == [solved]
            assert one.converged.tolist() == [converged or not solved]


def replace_values(results: Any, **values: Any) -> Any:
    """A copy with other arrays by frame."""
    return replace(results, **values)


def test_the_name_of_a_job() -> None:
    assert About("a.dat").label == "a.dat, job 1" and About("b", 7).label == "b, job 7"


def test_a_run_lists_its_arrays() -> None:
    """For a shell that completes, each is named once, and each is there."""
    run = vopd.run(vopd.read_deck(CASE_1))
    names = dir(run)
    assert names == sorted(set(names))
    for name in ("vehicle_deg", "solved", "focal_length_mm", "points", "findings", "histories"):
        assert (name in names) == hasattr(run, name)
    assert repr(run) == "Run(1 job, 1 frame)"


def test_a_run_has_every_array_of_its_results() -> None:
    """Of one job it is just that."""
    run = vopd.run(vopd.read_deck(CASE_1))
    for name in (*RESULT_ARRAYS, "focal_length_mm", "solved", "converged"):
        np.testing.assert_array_equal(getattr(run, name), getattr(run[0], name))


def test_an_error_in_a_file_of_a_project_is_one_of_the_project() -> None:
    """The file stays in its text; an error in the source itself has its place, and not its name."""
    of_file = finding_of(input_error("odd", "a.csv"), "flight.toml")
    assert of_file == Finding("a.csv: odd", "flight.toml")
    of_project = finding_of(VopdError("flight.toml: odd"), "flight.toml")
    assert of_project == Finding("odd", "flight.toml")
    of_card = Finding("odd", "deck.dat", card=3)
    assert finding_of(InputError(of_card), "deck.dat") == of_card
