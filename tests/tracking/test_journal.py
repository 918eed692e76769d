"""What a run has done so far: rows of its file, also where another run writes it, and patches."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.tolerances import assert_close
from vopd.cli.track import command
from vopd.findings import Finding, VopdError
from vopd.tracking import follow
from vopd.tracking.journal import ROW, Journal
from vopd.tracking.tracker import FOUND, Tracker

ABOUT = {"clicks": "a"}
ROWS = np.zeros(3, ROW)


def test_a_run_goes_on_with_the_blocks_of_the_one_before(tmp_path: Path) -> None:
    path = tmp_path / "t.part"
    Journal(path, ABOUT).add("row", ROWS)
    again = Journal(path, ABOUT)
    again.add("row", ROWS[:1])
    assert [len(block) for block in again.blocks("row")] == [3, 1]
    Journal(path, {"clicks": "b"}).add("row", ROWS[:2])  # those of other clicks are thrown away
    assert [len(block) for block in Journal(path, {"clicks": "b"}).blocks("row")] == [2]


@pytest.mark.parametrize("at", [1, 9, 17, 20, -1])
def test_a_block_that_is_damaged_is_made_again_and_all_behind_it(at: int, tmp_path: Path) -> None:
    """Its kind, its number of rows, its sum or a number of it: tracks of zeros were taken."""
    path = tmp_path / "t.part"
    journal = Journal(path, ABOUT)
    for count in (3, 2, 1):
        journal.add("row", ROWS[:count])
    content = bytearray(path.read_bytes())
    behind = len(content) - 20 - ROWS[:1].nbytes  # the end of the second block, 20 bytes its head
    content[behind - 20 - ROWS[:2].nbytes + at if at > 0 else behind - 1] ^= 64
    path.write_bytes(content)
    again = Journal(path, ABOUT)
    assert [len(block) for block in again.blocks("row")] == [3]
    again.add("row", ROWS[:2])
    assert [len(block) for block in Journal(path, ABOUT).blocks("row")] == [3, 2]


@pytest.mark.parametrize("begun", [False, True])
def test_two_runs_at_a_time_do_not_mix_their_rows(begun: bool, tmp_path: Path) -> None:
    """Tracks were in the file twice, as independent ones with too small standard deviations."""
    path = tmp_path / "t.part"
    if begun:
        Journal(path, ABOUT).add("row", ROWS)
    first, second = Journal(path, ABOUT), Journal(path, ABOUT)
    first.add("row", ROWS)
    with refused(VopdError):
        second.add("row", ROWS)
    first.add("row", ROWS)
    assert len([*first.blocks("row")]) == 2 + begun
    first.remove()
    with pytest.raises(VopdError):
        first.add("row", ROWS)


@pytest.mark.parametrize(("frames", "told"), [(11, True), (10, False)])
def test_the_sigma_of_a_match_is_scaled_where_enough_residuals_tell_it(
    frames: int, told: bool, tmp_path: Path
) -> None:
    """Three landmarks have 6 coordinates a frame for 3 angles; one click has two.

    Each is 3 and 4 px off, a quarter of its variance of 100: .25 by three are .75 a frame. Each
    is found from two clicks and counts once, one that is lost does not, and the last block, which
    ends its kind, has none.
    """
    journal = Journal(tmp_path / "t.part", ABOUT)
    block = np.zeros(3 * frames, ROW)
    block["frame"], block["landmark"] = np.divmod(np.arange(3 * frames), 3)
    block["status"], block["sigma"], block["residual"] = FOUND, 10.0, (3.0, 4.0)
    twice = np.concatenate([block, block])
    lost = block[:3].copy()
    lost["status"], lost["residual"] = FOUND + 1, 1e3
    journal.add("row", np.concatenate([twice, lost]))
    journal.add("row", ROWS[:0])
    clicks: Any = SimpleNamespace(frame=np.zeros(1, np.int64))
    scale, by_residuals = follow._scale(journal, clicks)
    assert by_residuals == told
    expected = np.sqrt(0.25 * 3 * frames / (3 * frames - 2)) if told else 1.0
    assert_close("ratio", scale, expected)


def test_of_how_far_a_click_is_the_largest_distance_is_told() -> None:
    """By the patches of each of two clicks in the frame of the other, 50 and 48 px, and by a third.

    One of a fourth frame is just within six of its standard deviations, and one of a fifth alone.
    """
    clicks: Any = SimpleNamespace(
        frame=np.array([0, 5, 7, 8, 9, 10]), landmark=np.array([0, 0, 0, 0, 1, 1]),
        pixel=np.arange(12.0).reshape(6, 2), sigma_px=np.array([1.0, 1.0, 1.0, 9.0, 0.1, 0.1]),
    )  # fmt: skip
    block = np.zeros(7, ROW)
    block["frame"], block["landmark"] = [5, 0, 7, 0, 8, 9, 10], [0, 0, 0, 0, 0, 1, 1]
    block["click"], block["status"], block["by_click"] = [0, 1, 0, 2, 0, 5, 4], FOUND, np.eye(2)
    own = np.array([1, 0, 2, 0, 3, 4, 5])
    block["pixel"] = clicks.pixel[own]
    block["pixel"][:, 0] += [50.0, -48.0, 30.0, -31.0, 50.0, 3.9, 4.1]
    journal: Any = SimpleNamespace(blocks=lambda _: [block, block[:0]])
    flight = SimpleNamespace(landmarks=SimpleNamespace(name=("a", "b")))
    footage: Any = SimpleNamespace(
        flight=flight, number=10 * np.arange(11), project=SimpleNamespace(name="p.toml")
    )
    nobody: Any = None
    assert_approved([str(one) for one in follow._findings(journal, footage, nobody, clicks)])


def test_a_frame_takes_the_nearest_patch_of_its_own_segment() -> None:
    """Frames 0 and 1 were before a cut; of landmark 7 the patch of frame 4 is nearest to 5."""

    def patch(frame: int, landmark: int) -> Any:
        return SimpleNamespace(patch=SimpleNamespace(frame=frame, landmark=landmark))

    before, near, far, other = patch(1, 3), patch(4, 7), patch(8, 7), patch(9, 5)
    run: Any = SimpleNamespace(
        grounded=dict(enumerate([before, None, far, near, patch(0, 7), other])),
        attitudes=SimpleNamespace(segment=np.repeat([1, 2], [2, 8])), _segment=2,
    )  # fmt: skip
    assert Tracker._nearest(run, 5) == [near, other]
    run._segment = 1
    assert Tracker._nearest(run, 5)[0] is before


def test_clicks_that_are_not_used_are_told_where_the_rest_cannot_be_solved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What tracking goes on with may be in other frames than a solve needs."""

    def refuse(*_: object, **__: object) -> None:
        raise VopdError("no frame has two landmarks")

    monkeypatch.setattr(follow, "solve_flight_read", refuse)
    texts = ["no landmark x (2 picks)", "anything", "frame 9: none of these picks is used"]
    findings = [Finding(text, "flight.toml", severity="warning") for text in texts]
    footage: Any = SimpleNamespace(flight=SimpleNamespace(findings=findings), project=None)
    assert follow._misfit_of_clicks(footage) == [findings[0], findings[2]]


def test_options_in_a_file_are_those_of_the_command() -> None:
    """Each by its first name and with its default; the library's options have them all."""
    own = {one.name: one.opts[0] for one in command.params if one.name in follow.OPTION}
    assert own == follow.OPTION and [*own] == [*follow.TrackOptions._fields]
    usual = {name: value for name, value in follow.TrackOptions()._asdict().items() if value}
    assert usual == {one.name: one.default for one in command.params if one.name in usual}
    options = follow.TrackOptions(0.123456789012, 2.0, 3, 4, 5, 0.7, 1e6)
    assert_approved([str(usual), options.as_text])
