"""The warnings about frames that misfit: the same repair together, few lines, and all counted."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from tests.approved.texts import assert_approved
from tests.kit import spherical_film
from tests.kit.command import vopd
from tests.kit.jobs import reread
from tests.kit.repeated_frame import misread
from vopd.attitude.findings import misfit_findings, misfits, summary_of
from vopd.attitude.history import History
from vopd.attitude.mistakes import best_exchange
from vopd.cards.read import read_deck
from vopd.cards.write import write_deck
from vopd.findings import frames_text
from vopd.job import Job
from vopd.pipeline import run

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
    (one,) = misfit_findings(with_details("", ""))
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


def test_the_best_exchange_of_a_frame_is_the_one_that_was_made() -> None:
    """The readings have errors of .001 in; where nothing is exchanged every exchange is worse."""
    estimate = made().estimate
    pair, worse = best_exchange(estimate, 0)
    assert pair
    for k in EXCHANGED:
        pair, rms = best_exchange(estimate, k)
        assert pair == (0, 2) and 100.0 * rms < worse


def test_very_many_frames_are_named_in_part_and_counted() -> None:
    """0, 2, ..., 58 are 30 frames that do not follow each other; 0 to 999 are one run."""
    text = frames_text([str(k) for k in range(0, 60, 2)])
    assert text.startswith("frames 0, 2, 4, ") and text.endswith(", 36, 38 and 10 more")
    assert frames_text([str(k) for k in range(1000)]) == "frames 0-999"
