"""Which jobs are computed together."""

from __future__ import annotations

from vopd.jobs_alike import alike_together


def test_jobs_of_a_kind_are_together_until_they_have_enough_frames() -> None:
    """Kind a ends at its third job, 2 + 3 + 5 = 10 frames; what is left comes last."""
    jobs = [("a", 2), ("b", 1), ("a", 3), ("a", 5), ("b", 8), ("a", 1)]
    assert list(alike_together(jobs, 10)) == [[0, 2, 3], [1, 4], [5]]
    assert list(alike_together(jobs, 9)) == [[0, 2, 3], [1, 4], [5]]
    assert list(alike_together(jobs, 11)) == [[0, 2, 3, 5], [1, 4]]


def test_a_long_job_is_a_group_by_itself() -> None:
    assert list(alike_together([("a", 10), ("a", 1)], 10)) == [[0], [1]]
    assert list(alike_together([], 10)) == []
