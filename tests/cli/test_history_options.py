"""What every command with attitude histories is asked for, option by option."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import handed, vopd
from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.batch import sources
from vopd.cli import attitude, plot, report
from vopd.cli.options import SharedOptions
from vopd.errata import fixes
from vopd.export import FORMATS
from vopd.findings import VopdError
from vopd.pipeline import SolveOptions

USUAL = SharedOptions(SolveOptions(), HistoryOptions(), strict=False, quiet=False)
ASKED = {
    "": USUAL,
    "--fix restart": replace(USUAL, solve=SolveOptions(fixes("restart"))),
    "--fix all --ellipsoid international1924": replace(
        USUAL, solve=SolveOptions(fixes("all", ellipsoid="international1924"))
    ),
    "--fix all": replace(USUAL, solve=SolveOptions(fixes("all", ellipsoid="wgs84"))),
    "--initial closed-form": replace(USUAL, solve=SolveOptions(initial="closed-form")),
    "--initial closed-form --compare-initial": replace(
        USUAL, solve=SolveOptions(initial="closed-form", compare_initial=True)
    ),
    "--limits-1974": replace(USUAL, solve=SolveOptions(limits_1974=True)),
    "--reading-sigma .1": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(reading=0.1))),
    "--fiducial-sigma .2": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(fiducial=0.2))),
    "--landmark-sigma 0": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(landmark=0.0))),
    "--position-sigma 4": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(position=4.0))),
    "--focal-sigma 5": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(focal_length=5.0))),
    "--time-sigma 6": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(time_s=6.0))),
    "--velocity-sigma 7": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(velocity=7.0))),
    "--wind-sigma 8": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(wind=8.0))),
    "--mount-sigma 9": replace(USUAL, history=HistoryOptions(sigmas=Sigmas(mount_deg=9.0))),
    "--max-rate 1e-9": replace(USUAL, history=HistoryOptions(max_rate_deg_s=1e-9)),
    "--vertical geocentric": replace(USUAL, history=HistoryOptions(vertical="geocentric")),
    "--vertical geodetic": replace(USUAL, history=HistoryOptions(vertical="geodetic")),
    "--strict": replace(USUAL, strict=True),
    "-q": replace(USUAL, quiet=True),
}


@pytest.mark.parametrize("options", ASKED)
def test_every_option_of_attitude_histories(
    options: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The same for every command that has them, with the names of the sources in their order."""
    names = ("b.dat", "a.dat")
    words = options.split()
    found = handed(monkeypatch, attitude, "collect_jobs", "attitude", *names, *words)
    assert found == (names, ASKED[options], True)
    out = tmp_path / "f.svg"
    found = handed(monkeypatch, plot, "collect_histories", "plot", *names, "-o", out, *words)
    assert found == (names, ASKED[options])
    out = tmp_path / "f.html"
    found = handed(monkeypatch, report, "collect_histories", "report", *names, "-o", out, *words)
    assert found[:2] == (names, ASKED[options])
    monkeypatch.setattr("vopd.batch.workers.load_ahead", lambda: None)
    found = handed(monkeypatch, sources, "BatchSettings", "batch", *names, "-d", out, *words)
    assert found[2:4] == (ASKED[options].solve, ASKED[options].history)


WRONG = [
    "--max-rate 0",
    "--max-rate -1.5",
    "--max-rate nan",
    "--ellipsoid wgs84",
    "--ellipsoid wgs84 --fix restart",
    "--compare-initial",
    "--fix nothing",
]


@pytest.mark.parametrize("options", WRONG)
def test_options_that_are_wrong_or_have_no_effect(options: str) -> None:
    ran = vopd("attitude", "none.dat", *options.split())
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr)


@pytest.mark.parametrize("form", FORMATS)
def test_only_formats_with_rows_are_written_by_parts(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("attitude", "a.dat", "--format", form, "--epoch", "2000-01-01")
    by_parts = handed(monkeypatch, attitude, "collect_jobs", *words)[2]
    assert by_parts == (form in ("csv", "jsonl"))


EPOCH = datetime(2000, 1, 1, tzinfo=UTC)


@pytest.mark.parametrize("form", ["csv", "aem", "acm", "czml", "kml"])
@pytest.mark.parametrize("given", [None, EPOCH])
@pytest.mark.parametrize("own", [(None, None), (EPOCH, EPOCH), (None, EPOCH)])
def test_the_epoch_is_that_of_the_option_or_of_all_sources(
    form: str, given: datetime | None, own: tuple[datetime | None, ...]
) -> None:
    other = datetime(1999, 1, 1, tzinfo=UTC)
    request = attitude._request(FORMATS["csv"], None, {}, True)
    request = replace(request, epoch=other if given else None)
    jobs: Any = [
        SimpleNamespace(about=SimpleNamespace(epoch=one, source=f"{k}.toml"))
        for k, one in enumerate(own)
    ]
    if given:
        assert attitude._with_epoch(FORMATS[form], request, jobs).epoch == other
    elif own == (EPOCH, EPOCH):
        assert attitude._with_epoch(FORMATS[form], request, jobs).epoch == EPOCH
    elif form in ("csv", "kml"):
        assert attitude._with_epoch(FORMATS[form], request, jobs).epoch is None
    else:
        with pytest.raises(VopdError) as refused:
            attitude._with_epoch(FORMATS[form], request, jobs)
        assert_approved(str(refused.value), parts=[form])
