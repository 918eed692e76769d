"""What a run has done so far, where another run writes it at the same time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import refused
from vopd.findings import VopdError
from vopd.tracking.journal import ROW, Journal

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
