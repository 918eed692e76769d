"""The summary of a batch for people, from records made by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tests.kit.command import vopd
from vopd.batch.folder import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.batch.run import summary_text, totals, worst_first

GOOD = SourceRecord("a", "a.dat", SOLVED, "", "", "", "", jobs=1, frames=5, attitudes=4)
DOUBTFUL = replace(
    GOOD, source="b/long name", flagged=3, warnings=2, flags={"outlier": 1, "two_landmarks": 2}
)
LOST = replace(GOOD, source="c", status=UNCONVERGED, not_converged=1, flagged=1)
MORE_LOST = replace(LOST, source="d", not_converged=2)
BROKEN = SourceRecord("e", "e.dat", FAILED, "e.dat: breaks off", "", "", "")


def test_the_worst_come_first() -> None:
    """Failed, then by frames that did not converge, then by flags; alike ones stay in order."""
    alike = replace(GOOD, source="z")
    records = [alike, GOOD, DOUBTFUL, LOST, MORE_LOST, BROKEN]
    order = [one.source for one in worst_first(records)]
    assert order == ["e", "d", "c", "b/long name", "z", "a"]


def test_the_table_and_its_totals() -> None:
    assert summary_text([GOOD, DOUBTFUL, BROKEN]) == (
        "source       status  frames  attitudes  flagged  flags\n"
        "e            failed       0          0        0\n"
        "b/long name  solved       5          4        3  outlier:1 two_landmarks:2\n"
        "a            solved       5          4        0\n"
        "3 sources: 1 failed, 2 solved; 10 frames, 8 with an attitude\n"
    )
    assert totals([LOST]) == "1 source: 1 not converged; 5 frames, 4 with an attitude"


def test_twenty_sources_are_shown() -> None:
    records = [replace(GOOD, source=f"deck {k}") for k in range(22)]
    for count, more in ((20, []), (22, ["... and 2 more, none worse than the last of these"])):
        lines = summary_text(records[:count]).splitlines()
        assert [line.split("  ")[0] for line in lines[1:21]] == [f"deck {k}" for k in range(20)]
        assert lines[21:-1] == more


def test_twenty_failures_are_told(tmp_path: Path) -> None:
    missing = [tmp_path / f"no-{k:02d}.dat" for k in range(22)]
    for count, more in ((20, []), (22, ["2 more sources failed; summary.jsonl says why"])):
        ran = vopd("batch", *missing[:count], "-d", tmp_path / f"out{count}")
        lines = ran.stderr.splitlines()
        assert ran.status == 1 and lines[20:] == more
        told = [f"{path}: No such file or directory" for path in missing[:20]]
        assert lines[:20] == told
