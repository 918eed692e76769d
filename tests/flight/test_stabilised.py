"""A picture that is shifted from frame to frame: sizes, false alarms, and a rendered video."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.clicked_flights import ClickedFlight, clicked_flight, with_rows
from tests.kit.command import vopd
from tests.kit.joint_flights import at_frames, axes, turned_out
from tests.tolerances import assert_close
from tools.render_video import Settings, make
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.misfits import stabilised
from vopd.flight.misfits.input_errors import SHIFTED
from vopd.flight.misfits.misfit import MISFITS
from vopd.flight.result import solve_flight_read

FRAMES = 40


def drawn(seed: int, landmarks: int = 6) -> ClickedFlight:
    rng = np.random.default_rng(seed)
    return clicked_flight(rng, FRAMES, landmarks, every=20, reach=FRAMES)


def shifted(one: ClickedFlight, size_px: float, seed: int) -> Flight:
    """Shift the picture of each frame, by so much rms of u and v together."""
    shift = np.random.default_rng(seed).normal(0.0, size_px / np.sqrt(2.0), (FRAMES, 2))
    pixel = one.rows.pixel + shift[one.rows.frame]
    return with_rows(one.flight, replace(one.rows, pixel=pixel))


def said(flight: Flight) -> list[str]:
    return [one.message for one in solve_flight_read(flight).findings if SHIFTED in one.message]


def test_shifts_are_named_with_their_size() -> None:
    sizes = []
    for seed in range(6):
        result = solve_flight_read(shifted(drawn(seed), 8.0, seed))
        (message,) = [one.message for one in result.findings if SHIFTED in one.message]
        assert result.misfits and not any("the click of" in one.message for one in result.findings)
        sizes.append(float(message.split(", by ")[1].split()[0]))
    assert_close("shift of the picture", np.sqrt(np.mean(np.square(sizes))), 8.0)


def test_shifts_make_a_flight_doubtful_whose_picks_have_their_size() -> None:
    result = solve_flight_read(shifted(drawn(0), 5.0, 0))
    texts = [one.message for one in result.findings]
    assert any(SHIFTED in one for one in texts) and result.misfits
    assert not any(one.startswith(MISFITS) for one in texts)


def placed(flight: Flight, rng: np.random.Generator, size_m: float, stated_m: float) -> Flight:
    """Move each frame's position by an error of its own."""
    fixes = TrackFixes(np.arange(FRAMES), np.ones((FRAMES, 1)), np.full((FRAMES, 3), stated_m))
    moved = at_frames(fixes, rng.normal(0.0, size_m, (FRAMES, 3)))
    position_m = flight.path.position_m + turned_out(axes(flight.path.position_m), moved)
    return replace(flight, path=replace(flight.path, position_m=position_m, fixes=fixes))


def with_lens(flight: Flight, focal: float = 0.0, k1: float = 0.0, px: float = 0.0) -> Flight:
    lens = flight.lens
    own = replace(
        lens, focal_px=lens.focal_px * (1.0 + focal), centre_px=lens.centre_px + px,
        k=lens.k + k1 * (np.arange(len(lens.k)) == 0),
    )  # fmt: skip
    return replace(flight, lens=own)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda flight, _: flight,
        lambda flight, rng: placed(flight, rng, 0.02, 0.02),
        lambda flight, rng: placed(flight, rng, 3.0, 3.0),
        lambda flight, _: with_lens(flight, focal=0.04),
        lambda flight, _: with_lens(flight, k1=0.02, px=10.0),
    ],
)
def test_other_errors_are_no_shifts(wrong: Callable[..., Flight]) -> None:
    for seed in (0, 1):
        flight = wrong(drawn(seed, 5 + seed).flight, np.random.default_rng(seed))
        assert said(flight) == []


def test_positions_that_are_off_by_themselves_are_not_called_stabilised_alone() -> None:
    """Of a picture that looks nearly straight down both have the same residuals."""
    for seed in range(3):
        flight = placed(drawn(seed).flight, np.random.default_rng(seed), 0.1, 0.02)
        assert all("or for positions" in one for one in said(flight))


@pytest.mark.parametrize("evidence", [5.9, 6.1])
def test_positions_are_named_beside_shifts_that_they_explain_as_well(
    evidence: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As well is within 6 of chi-square."""
    one = clicked_flight(np.random.default_rng(3), 8, 4, every=4, reach=5)
    joint = solve_flight_read(one.flight).estimates.joint
    assert joint is not None
    found = stabilised.Shifts(12.0, 1e-9, evidence)
    monkeypatch.setattr(stabilised, "shifts_of_frames", lambda _: found)
    said = stabilised.shifts_text(joint)
    assert ("or for positions" in said) == (evidence < 6.0)
    assert_approved(said)


def test_a_rendered_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shifts of 8 px rms: said, with status 3."""
    settings = Settings(seed=5, size=(640, 360), frames=36, clicks=12, stabilised_px=8.0)
    make(tmp_path, settings)
    project = tmp_path / "flight.toml"
    text = project.read_text(encoding="utf-8")
    project.write_text(text.replace("[picks]", '[picks]\ntracked = "tracked.csv"'), "utf-8")
    monkeypatch.chdir(tmp_path)
    assert vopd("track", "flight.toml").status == 0
    done = vopd("attitude", "flight.toml", "-o", "a.csv")
    assert done.status == 3
    assert_approved("".join(f"{one}\n" for one in done.stderr.splitlines() if "warning" in one))
