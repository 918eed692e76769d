"""Mistakes that explain a misfit: repairs of frames, the search for labels, warnings."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from tests.approved.texts import assert_approved
from tests.kit import spherical_film
from tests.kit.command import vopd
from tests.kit.estimates import NAMES, POINTS, estimate
from tests.kit.jobs import reread
from tests.kit.repeated_frame import misread
from tests.tolerances import assert_close
from vopd.attitude import mistakes as label_search
from vopd.attitude.findings import findings_of, misfits, summary_of
from vopd.attitude.history import History
from vopd.attitude.mistakes import (
    MOST_FRAMES,
    MOST_IN_A_FRAME,
    MOST_LANDMARKS,
    MOST_NAMED,
    NEAR,
    NOT_SEARCHED,
    NOTHING,
    OF_THE_WHOLE,
    PASSES,
    PLAUSIBLE,
    Repair,
    fitted_trials,
    landmarks_of,
    misfit_text,
    repairs,
    trial_equations,
    trials,
)
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import Pool, ResidualEquations
from vopd.attitude.sigmas import ErrorComponent, Sigmas, in_force
from vopd.cards.write import write_deck
from vopd.estimate import Estimate
from vopd.findings import Finding, frames_text
from vopd.job import Job
from vopd.pipeline import read_deck, run

ANGLES = np.array([[140.0, -60.0, 20.0]])
MORE = np.vstack([POINTS, [[-1.0, 3.0]]])
NONE = float("nan")


def test_limits_of_the_search() -> None:
    assert (MOST_LANDMARKS, MOST_IN_A_FRAME, MOST_FRAMES, MOST_NAMED) == (24, 200, 1000, 3)
    assert (PASSES, PLAUSIBLE, NEAR) == (12, 0.001, 0.1)
    assert_approved(NOTHING)


def found(e: Estimate, sigma: float, freedom: float = np.inf) -> list[Repair]:
    return repairs(e, 0, [], Pool(sigma, freedom, None))


TRIALS = [((0, 1), None), ((0, 2), None), ((1, 2), None), ((), 0), ((), 1), ((), 2)]


@pytest.mark.parametrize(
    ("chances", "expected"),
    [
        ([0.5, 0.3, 0.06, 0.04, 0.051, 0.9], [5, 0, 1]),
        ([0.5, 0.3, 0.06, 0.04, 0.051, 0.05], [0, 1, 2, 4, 5]),
        ([0.0011, 0.0009, 0.0, 0.0, 0.001, 0.0], [0, 4]),
        ([0.2, 0.2, NONE, 0.2, np.inf, 0.021], [0, 1, 3, 5]),
        ([0.0, 0.0, 0.0009, NONE, 0.0, 0.0], []),
    ],
)
def test_repairs_that_are_plausible_and_not_much_less_likely_than_the_best(
    chances: list[float], expected: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A chance of a thousandth, and a tenth of the best one; alike ones in the order of trials."""
    monkeypatch.setattr(label_search, "chance_of", lambda *_: np.array(chances))
    told = found(estimate(ANGLES, POINTS[:3]), 0.1)
    assert [(one.exchanged, one.without, one.chance) for one in told] == [
        (*TRIALS[k], chances[k]) for k in expected
    ]


def test_a_repair_with_a_landmark_behind_the_camera_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(label_search, "chance_of", lambda *_: np.full(6, 0.5))
    front = np.array([True, False, True, True, False, True])
    fitted = label_search.fitted_trials

    def some_behind(*given: Any) -> Any:
        one = fitted(*given)
        return one and one._replace(in_front=front)

    monkeypatch.setattr(label_search, "fitted_trials", some_behind)
    told = found(estimate(ANGLES, POINTS[:3]), 0.1)
    assert [(one.exchanged, one.without) for one in told] == [
        TRIALS[k] for k in np.flatnonzero(front)
    ]


def exchanged(a: int, b: int, noise: float) -> tuple[Estimate, np.ndarray, np.ndarray]:
    """A frame with two labels exchanged, and what is left of its noise when it is fitted."""
    rng = np.random.default_rng(6)
    errors = rng.normal(0.0, noise, 10)
    image = MORE + errors.reshape(2, 5).T
    right = estimate(ANGLES, MORE)
    fit, *_ = np.linalg.lstsq(right.partials[0], errors, rcond=None)
    left = errors - right.partials[0] @ fit
    swapped = image.copy()
    swapped[[a, b]] = image[[b, a]]
    e = estimate(ANGLES, MORE, residual=(swapped - MORE).T.reshape(1, 10))
    e.__dict__["image"] = swapped[None]
    return e, left, errors


@pytest.mark.parametrize(("a", "b"), [(0, 1), (1, 4), (2, 3)])
def test_the_exchange_that_was_made_is_found_with_its_chance(a: int, b: int) -> None:
    """That of residuals as large as those that least squares leave of the noise, chi-square with
    2 x 5 - 3 degrees.
    """
    e, left, _ = exchanged(a, b, 1e-3)
    (first, *_) = found(e, 1.2e-3)
    assert (first.exchanged, first.without) == ((a, b), None)
    squares = float((left**2).sum())
    assert_close("ratio of three digits", first.chance, chi2.sf(squares / 1.2e-3**2, 7))


def test_the_landmark_that_is_off_is_found() -> None:
    e, _, errors = exchanged(0, 0, 1e-3)
    wrong = e.image.copy()
    wrong[0, 3] += 0.4, -0.7
    e.__dict__["image"] = wrong
    (first, *others) = found(e, 1.2e-3)
    assert (first.exchanged, first.without) == ((), 3) and not others
    keep = np.tile(np.arange(5) != 3, 2)
    b = estimate(ANGLES, MORE).partials[0][keep]
    fit, *_ = np.linalg.lstsq(b, errors[keep], rcond=None)
    squares = float(((errors[keep] - b @ fit) ** 2).sum())
    assert_close("ratio of three digits", first.chance, chi2.sf(squares / 1.2e-3**2, 5))


def test_a_frame_that_looks_away_is_explained_by_the_attitude_that_does_not() -> None:
    """The 1974 solve ended half a turn away: no landmark is wrong, and none is named."""
    _, left, errors = exchanged(0, 0, 1e-3)
    e = estimate(ANGLES, MORE)
    e.__dict__["image"] = e.image + errors.reshape(2, 5).T
    assert len(found(e, 1.2e-3)) > 1  # a frame that looks at its landmarks is not asked
    away = estimate(ANGLES, MORE)
    away.__dict__["image"] = e.image
    away.__dict__["camera_deg"] = ANGLES * [1.0, -1.0, 1.0] + [180.0, 0.0, 0.0]
    (only,) = found(away, 1.2e-3)
    assert only.in_front and (only.exchanged, only.without) == ((), None)
    squares = float((left**2).sum())
    assert_close("ratio of three digits", only.chance, chi2.sf(squares / 1.2e-3**2, 7))
    away.__dict__["image"] = MORE[::-1][None]  # and one that fits no attitude
    assert not any(one.in_front for one in found(away, 1.2e-3))


def test_a_frame_of_two_landmarks_has_no_repair() -> None:
    assert found(estimate(ANGLES, POINTS[:2]), 0.1) == []


def test_landmarks_that_take_no_part_are_neither_tried_nor_in_the_way() -> None:
    """One is left out by the user, behind the camera, and one has no direction."""
    e = estimate(ANGLES, np.vstack([MORE, [[2.0, -3.0]]]))
    direction = e.direction.copy()
    direction[0, 1] *= -1.0
    direction[0, 4] = np.nan
    used = np.array([[True, False, True, True, True, True]])
    one = estimate(ANGLES, np.vstack([MORE, [[2.0, -3.0]]]), direction=direction, used=used)
    with np.errstate(all="ignore"):
        fitted = fitted_trials(one, 0, np.zeros(12))
    assert fitted is not None
    pairs = [(0, 2), (0, 3), (0, 5), (2, 3), (2, 5), (3, 5)]
    assert [repair.exchanged for repair in fitted.repair] == [*pairs, *[()] * 4]
    assert [repair.without for repair in fitted.repair][6:] == [0, 2, 3, 5]
    assert fitted.in_front[6:].all()


@np.errstate(all="ignore")
def test_errors_of_landmarks_go_with_the_landmark_and_others_stay() -> None:
    """x and y of what stands in column 0 have the errors of landmark 2 where they are exchanged."""
    e = estimate(ANGLES, POINTS[:3])
    fitted = fitted_trials(e, 0, np.zeros(6))
    assert fitted is not None
    own = np.arange(18.0).reshape(1, 6, 3) + 1.0
    shared = -np.arange(12.0).reshape(1, 6, 2) - 1.0
    variance = np.arange(1.0, 7.0)[None]
    given = ResidualEquations(np.zeros((1, 6)), np.zeros((1, 6, 3)), variance, shared, own)
    made = trial_equations(fitted, given)
    x, y = own[0, :3], own[0, 3:]
    assert made.own[1].tolist() == [*x[[2, 1, 0]].tolist(), *y[[2, 1, 0]].tolist()]
    assert made.shared[1].tolist() == shared[0].tolist()
    assert made.variance[1].tolist() == variance[0].tolist()
    assert made.own[3].tolist() == [[0.0] * 3, *x[1:].tolist(), [0.0] * 3, *y[1:].tolist()]
    for part in (made.residual, made.partials, made.variance, made.shared):
        assert not part[3, [0, 3]].any()


def test_the_search_takes_the_sigmas_in_force(monkeypatch: pytest.MonkeyPatch) -> None:
    """The test's reading sigma with its degrees of freedom, and the errors that are given."""
    asked: list[tuple[Pool, list[ErrorComponent]]] = []

    def search(_: object, frame: int, components: list[ErrorComponent], pool: Pool) -> list[Repair]:
        asked.append((pool, components))
        return [Repair((), frame, 0.123)]

    monkeypatch.setattr(label_search, "repairs", search)
    e = estimate(np.repeat(ANGLES, 3, axis=0))
    chance = np.array([0.5, 0.0009, 0.0011])
    scale = JobReadingSigma(0.0, 7.0, "sample", chance, 0.25)
    text = misfit_text(e, scale, in_force(e, Sigmas(position=3.0, landmark=5.0)))
    assert text == ["", "without bridge, north end (chance 0.12)", ""]
    ((pool, (landmark, position)),) = asked
    assert pool == (0.25, 7.0, None)
    assert position.residual[1].tolist() == np.full((8, 3), -0.03).tolist()
    assert landmark.residual[1].tolist() == np.full((8, 3), 0.05).tolist()


# What is tried for a frame that misfits, how much of it is told, and in which words


LABEL_ANGLES = np.tile([140.0, -60.0, 20.0], (4, 1))


def told(
    monkeypatch: pytest.MonkeyPatch, found: list[Repair], misfit: list[bool], **more: Any
) -> list[str]:
    """The text of four frames, where the search finds these repairs in each."""
    monkeypatch.setattr(label_search, "repairs", lambda *_: found)
    e = estimate(LABEL_ANGLES)
    scale: Any = SimpleNamespace(misfit=np.array(misfit), test_sigma=1.0, freedom=np.inf)
    return misfit_text(e, scale, in_force(e, Sigmas(reading=1.0)), **more)


def test_three_repairs_of_a_frame_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """The likeliest come first; a landmark's name keeps no semicolon, which separates flags."""
    found = [
        Repair((0, 1), None, 0.416), Repair((), 3, 0.3), Repair((), 2, 0.204),
        Repair((2, 3), None, 0.1), Repair((), 0, 0.05),
    ]  # fmt: skip
    names = {k: NAMES[k + 7].replace(";", ",") for k in range(4)}
    texts = [
        f"exchange {names[0]}+{names[1]} (chance 0.42)",
        f"without {names[3]} (chance 0.30)",
        f"without {names[2]} (chance 0.20)",
    ]
    for count in (1, 2, 3, 5):
        text = told(monkeypatch, found[:count], [False, True, False, False])
        assert text == ["", " or ".join(texts[:count]), "", ""]


def test_that_nothing_explains_a_frame_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, [], [True, False, False, True]) == [NOTHING, "", "", NOTHING]
    assert told(monkeypatch, [Repair((), 0, 0.5)], [False] * 4) == [""] * 4


@pytest.mark.parametrize(("misfits", "text"), [(2, NOTHING), (3, OF_THE_WHOLE)])
def test_what_explains_most_frames_of_a_flight_that_misfits(
    misfits: int, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What nothing in a frame explains is of the whole flight, if most of its frames misfit."""
    monkeypatch.setattr(label_search, "repairs", lambda *_: [])
    e = estimate(LABEL_ANGLES)
    e = replace(e, about=e.about._replace(doubt="the flight misfits: by its focal length"))
    scale: Any = SimpleNamespace(misfit=np.arange(4) < misfits, test_sigma=1.0, freedom=np.inf)
    found = misfit_text(e, scale, in_force(e, Sigmas(reading=1.0)))
    assert found == [text] * misfits + [""] * (4 - misfits)


def test_frames_of_a_flight_that_misfits_are_searched_where_some_are_explained(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 100 every sixth is tried first, which are twenty at most."""
    e = estimate(np.repeat(LABEL_ANGLES, 25, axis=0))
    e = replace(e, about=e.about._replace(doubt="the flight misfits: by its focal length"))
    scale: Any = SimpleNamespace(misfit=np.ones(100, bool), test_sigma=1.0, freedom=np.inf)
    sigmas, asked = in_force(e, Sigmas(reading=1.0)), list[int]()

    def search(_: object, frame: int, *more: object) -> list[Repair]:
        asked.append(frame)
        return [Repair((), None, 0.5)] * (frame in good)

    monkeypatch.setattr(label_search, "repairs", search)
    good: set[int] = set()
    assert misfit_text(e, scale, sigmas) == [OF_THE_WHOLE] * 100
    assert asked == list(range(0, 100, 6))
    good = {6, 7}
    text = misfit_text(e, scale, sigmas)
    assert [k for k, one in enumerate(text) if one != OF_THE_WHOLE] == [6, 7]


@pytest.mark.parametrize("most", [0, 1, 2, 3, 4])
def test_only_so_many_frames_are_searched(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    text = told(monkeypatch, [], [True, False, True, True], most=most)
    searched = (0, 2, 3)[:most]
    assert text == ["" if k == 1 else NOTHING if k in searched else NOT_SEARCHED for k in range(4)]


@pytest.mark.parametrize(("count", "swaps", "drops"), [(1, 0, 0), (2, 0, 0), (3, 3, 3), (5, 10, 5)])
def test_every_pair_is_exchanged_and_every_landmark_left_out(
    count: int, swaps: int, drops: int
) -> None:
    """Of three landmarks or more: with two no exchange can be told, and one determines nothing."""
    used = np.arange(6) < count
    tried, labels, parts = trials(used, np.flatnonzero(used))
    assert len(tried) == len(labels) == len(parts) == swaps + drops
    assert len({(one.exchanged, one.without) for one in tried}) == swaps + drops
    for one, label, kept in zip(tried, labels, parts, strict=True):
        expected, left = np.arange(6), used.copy()
        if one.without is None:
            a, b = one.exchanged
            expected[[a, b]] = b, a
        else:
            left[one.without] = False
        assert label.tolist() == expected.tolist() and kept.tolist() == left.tolist()


@np.errstate(all="ignore")
def test_of_many_landmarks_the_worst_are_searched() -> None:
    """Landmark k has a residual of k; only the last are tried."""
    points = np.tile(POINTS, (10, 1)) + np.arange(40)[:, None] / 100.0
    e = estimate(LABEL_ANGLES[:1], points)
    fitted = fitted_trials(e, 0, np.tile(np.arange(40.0), 2))
    assert fitted is not None
    drops = [one.without for one in fitted.repair if one.without is not None]
    assert drops == list(range(40 - MOST_LANDMARKS, 40))


@np.errstate(all="ignore")
@pytest.mark.parametrize("more", [0, 1])
def test_a_frame_of_very_many_landmarks_is_not_searched(more: int) -> None:
    count = MOST_IN_A_FRAME + more
    points = np.tile(POINTS, (51, 1))[:count] + np.arange(count)[:, None] / 100.0
    fitted = fitted_trials(estimate(LABEL_ANGLES[:1], points), 0, np.arange(2.0 * count))
    assert (fitted is None) == bool(more)


# The warnings about frames that misfit: the same repair together, few lines, and all counted


EXCHANGED = (2, 3, 4, 8)  # indices of frames
MOVED = 12  # index of the frame with one misread landmark


@cache
def film() -> Job:
    """20 frames, in four of which two labels are exchanged, in one a landmark is misread."""
    truth = np.tile([140.0, -80.0, 60.0], (20, 1))
    job = misread(spherical_film.job(truth, truth[0]), 1e-3, np.random.default_rng(1))
    label, read = job.readings.landmark.copy(), job.readings.landmark_in.copy()
    for k in EXCHANGED:
        label[k, [0, 2]] = label[k, [2, 0]]
    read[MOVED, 1] += 0.15
    readings = reread(job.readings, landmark=label, landmark_in=read.round(3))
    return replace(job, readings=readings)


@cache
def made() -> History:
    (one,) = run(film()).histories()
    return one


def with_details(*details: str) -> History:
    """A history with frames that misfit, and these details."""
    one = made()
    raised = np.arange(20) < len(details)
    flags = replace(
        one.flags,
        raised=one.flags.raised | {"misfit": raised},
        detail=one.flags.detail | {"misfit": [*details, *[""] * (20 - len(details))]},
    )
    return replace(one, flags=flags)


def misfit_findings(one: History) -> list[Finding]:
    """The warnings but for that of the errata, which a film on the sphere of 1974 has none of."""
    found = findings_of(one.about, summary_of([one]))
    return [finding for finding in found if "misfit" in finding.message]


def test_frames_with_the_same_repair_are_one_warning() -> None:
    names = [str(n) for n in film().readings.landmark[0].tolist()]
    first, second = misfit_findings(made())
    assert first.severity == "warning" and first.job == 1
    assert_approved(first.message)
    exchanges = (f"{names[0]}+{names[2]}", f"{names[2]}+{names[0]}")
    assert any(f"exchange {pair} (chance " in first.message for pair in exchanges)
    assert " or more)" in first.message
    assert second.message.startswith("frame 13: misfit")
    assert f"without {names[1]} (chance " in second.message


def test_the_least_chance_of_each_repair() -> None:
    one = with_details(
        "exchange 3+7 (chance 0.42) or without 3 (chance 0.05)",
        "exchange 3+7 (chance 0.31) or without 3 (chance 0.08)",
        "without 5 (chance 0.90)",
    )
    repairs, left = misfits(summary_of([one]))
    assert left == 0
    assert repairs == [
        ("frames 1-2", "exchange 3+7 (chance 0.31 or more) or without 3 (chance 0.05 or more)"),
        ("frame 3", "without 5 (chance 0.90)"),
    ]


def test_many_repairs_are_few_lines() -> None:
    details = [f"without {k} (chance 0.50)" for k in (1, 2, 3, 4, 5, 5)]
    messages = [str(one) for one in misfit_findings(with_details(*details))]
    assert len(messages) == 4 and messages[0].startswith("job 1: frames 5-6: misfit")
    assert_approved(messages[-1])


def test_frames_that_were_not_searched() -> None:
    (one,) = misfit_findings(with_details(NOT_SEARCHED, NOT_SEARCHED))
    assert one.message.endswith("what explains them: not searched")
    assert misfit_findings(with_details()) == []


def test_standard_error_has_them_and_quiet_leaves_them_out(tmp_path: Path) -> None:
    deck = tmp_path / "exchanged.dat"
    assert vopd("demo", "--frames", "20", "--landmarks", "5", "-o", deck).status == 0
    (job,) = read_deck(deck)
    label = job.readings.landmark.copy()
    label[[2, 3], 0], label[[2, 3], 2] = label[[2, 3], 2], label[[2, 3], 0]
    deck.write_text(write_deck([replace(job, readings=reread(job.readings, landmark=label))]))
    done = vopd("attitude", deck, "-o", tmp_path / "t.csv")
    told = [line for line in done.stderr.splitlines() if "misfit" in line]
    first, second = job.readings.frame[[2, 3]].tolist()
    assert len(told) == 1 and f"job 1: frames {first}-{second}: misfit" in told[0]
    assert "exchange" in told[0] and "exchange" in (tmp_path / "t.csv").read_text()
    assert vopd("attitude", deck, "-o", tmp_path / "t.csv", "-q").stderr == ""


def test_very_many_frames_are_named_in_part_and_counted() -> None:
    """0, 2, ..., 58 are 30 frames that do not follow each other; 0 to 999 are one run."""
    text = frames_text([str(k) for k in range(0, 60, 2)])
    assert text.startswith("frames 0, 2, 4, ") and text.endswith(", 36, 38 and 10 more")
    assert frames_text([str(k) for k in range(1000)]) == "frames 0-999"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("without 6 (chance 0.12)", ["6"]), ("without west pier", ["west pier"]),
        ("exchange 3+7 (chance 0.42)", ["3", "7"]), ("exchange a+b and exchange c+d", [*"abcd"]),
        ("exchange 3+7 (chance 0.31) or without 3 (chance 0.08)", []), (NOTHING, []), ("", []),
    ],
)  # fmt: skip
def test_landmarks_of_a_repair(text: str, names: list[str]) -> None:
    """Of several repairs that are as likely none is marked."""
    assert landmarks_of(text) == names
