"""Histories, tables and pages of many jobs, made together, are those of each job alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import DECKS
from tests.kit.jobs import reread
from vopd.attitude import history as attitude_history
from vopd.attitude.history import (
    History,
    HistoryOptions,
    histories,
    history,
    taken_together,
)
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.export import FORMATS, FileRequest, TableFile
from vopd.film import film_estimate
from vopd.findings import VopdError
from vopd.job import Job
from vopd.listing.pages import pages, pages_of_jobs
from vopd.program.vopd import run
from vopd.results import Results
from vopd.synthetic import Plan
from vopd.synthetic.flight import make


def jobs() -> list[Job]:
    """Films of one camera, two with misread frames; a run that is stopped, and other cameras."""
    made: list[Job] = []
    for seed, (frames, landmarks, noise) in enumerate(
        [(12, 4, 0.003), (1, 4, 0.003), (9, 4, 0.3), (6, 2, 0.003), (5, 4, 0.0), (8, 4, 0.02)]
    ):
        (job,), _ = make(Plan(frames=frames, landmarks=landmarks, seed=seed, noise_in=noise))
        made.append(job)
    read = made[0].readings
    landmark = read.landmark.copy()
    landmark[3, :2] = landmark[3, 1::-1]  # an exchange of two labels
    made.append(replace(made[0], readings=reread(read, landmark=landmark)))
    for name in ("wind_out_of_order", "time_out_of_order", "ignored", "zero_residuals", "vanished"):
        made += vopd.read_deck(DECKS / "regression" / f"{name}.dat")
    return made


@pytest.fixture(scope="module")
def results() -> list[Results]:
    return [run(job) for job in jobs()]


@pytest.fixture(scope="module")
def estimates(results: list[Results]) -> list[Estimate]:
    return [film_estimate(one, "film.dat", k) for k, one in enumerate(results, 1)]


ALL = Sigmas(landmark=50.0, position=30.0, focal_length=0.01, time_s=0.01, velocity=3.0, wind=2.0)


@pytest.mark.parametrize(
    ("sigmas", "rate"),
    [(Sigmas(), None), (ALL, 20.0), (Sigmas(reading=0.01, fiducial=0.0), 1.0), (Sigmas(0.0), None)],
)
def test_histories(estimates: list[Estimate], sigmas: Sigmas, rate: float | None) -> None:
    """All values of the table, to the last bit, and the reading sigmas."""
    together = histories(estimates, HistoryOptions(sigmas, rate))
    for one, estimate in zip(together, estimates, strict=True):
        alone = history(estimate, sigmas=sigmas, max_rate_deg_s=rate)
        assert one.estimate is estimate
        assert one.uncertainty.reading == alone.uncertainty.reading
        assert list(one.flags.raised) == list(alone.flags.raised)
        values = table([one])
        for name, expected in table([alone]).items():
            np.testing.assert_array_equal(values[name], expected, err_msg=name)


def test_what_is_taken_together(estimates: list[Estimate], monkeypatch: pytest.MonkeyPatch) -> None:
    """Jobs with other numbers of landmarks, cameras or names are not, nor too many frames."""
    camera = replace(estimates[1], focal_length=11.0)
    named = replace(estimates[1], frame_names=["a.jpg"] * len(estimates[1].frame))
    some = [*estimates[:4], camera, named, estimates[4]]
    assert sorted(taken_together(some)) == [[0, 1, 2, 6], [3], [4], [5]]
    monkeypatch.setattr(attitude_history, "JOBS_TOGETHER", 13)  # frames
    assert sorted(taken_together(some)) == [[0, 1], [2, 6], [3], [4], [5]]


def test_pages(results: list[Results]) -> None:
    corrected = run(results[0].job, fixes("all"))
    several = [*results, corrected]
    printed = [b"".join(pieces) for pieces in pages_of_jobs(several)]
    assert printed == [b"".join(pages(one)) for one in several]


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_files(estimates: list[Estimate], form: str) -> None:
    """Files of one job and of two; the components of the uncertainty differ between them."""
    made = histories(estimates, HistoryOptions())
    other = histories(estimates[:3], HistoryOptions(ALL))
    several: list[list[History]] = [[one] for one in made] + [made[:2], other, made[3:4] * 2]
    request = FileRequest()
    files = [TableFile(some, request) for some in several]
    alone = [FORMATS[form].render(some, request) for some in several]
    assert FORMATS[form].render_files(files) == alone


def test_a_file_that_cannot_be_made_costs_no_other(estimates: list[Estimate]) -> None:
    made = histories(estimates[:2], HistoryOptions())
    files = [TableFile([one], FileRequest()) for one in made]
    found = FORMATS["aem"].render_files(files)
    assert_approved([str(one) for one in found])
    assert all(isinstance(one, VopdError) for one in found)
