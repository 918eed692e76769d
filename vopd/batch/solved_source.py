"""A source that was solved, and its listing and tables, which are made for many at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice

from vopd.attitude.findings import misfit_findings
from vopd.attitude.history import History
from vopd.batch.settings import BatchSettings
from vopd.batch.sources import BatchSource
from vopd.export import FORMATS
from vopd.export.file_request import FileRequest, TableFile, own_epoch
from vopd.findings import Finding, VopdError
from vopd.flight.result import FlightResult
from vopd.listing.pages import pages_of_jobs
from vopd.results import SolvedJob
from vopd.solved import Run


@dataclass
class SolvedSource:
    """What has been made of a source.

    Attributes:
        source: the source
        input_sha256: hash of its input
        jobs: solved jobs of a deck
        flight: a solved flight
        findings: all warnings
        error: what ended it early
        pages: of each job of a deck
        histories: of each job, or of the flight
        tables: by format; the error of one that cannot be made
    """

    source: BatchSource
    input_sha256: str
    jobs: list[SolvedJob] = field(default_factory=list)
    flight: FlightResult | None = None
    findings: list[Finding] = field(default_factory=list)
    error: VopdError | None = None
    pages: list[bytes] = field(default_factory=list)
    histories: list[History] = field(default_factory=list)
    tables: dict[str, bytes | VopdError] = field(default_factory=dict)

    @property
    def has_attitude(self) -> bool:
        """Whether any frame has an attitude."""
        return any(h.has_attitude.any() for h in self.histories)


def make_outputs(sources: Sequence[SolvedSource], settings: BatchSettings) -> None:
    """Make pages, histories and tables of sources.

    Args:
        sources: as the pipeline has solved them
        settings: what to make
    """
    rate, vertical = settings.max_rate_deg_s, settings.vertical
    jobs = [job for one in sources for job in one.jobs]
    pages = iter(pages_of_jobs([job.results for job in jobs]))
    histories = iter(Run(jobs).histories(settings.sigmas, rate, vertical))
    for one in sources:
        one.pages = [b"".join(pieces) for pieces in islice(pages, len(one.jobs))]
        one.histories = list(islice(histories, len(one.jobs)))
        if one.flight is not None:
            one.histories.append(one.flight.history(settings.sigmas, rate, vertical))
        one.findings.extend(finding for h in one.histories for finding in misfit_findings(h))
    _make_tables([one for one in sources if one.has_attitude], settings)


def _make_tables(sources: Sequence[SolvedSource], settings: BatchSettings) -> None:
    for form in settings.formats:
        files = []
        for one in sources:
            request = FileRequest(epoch=own_epoch(one.histories))
            files.append(TableFile(one.histories, request, one.findings.append))
        for one, table in zip(sources, FORMATS[form].render_files(files), strict=True):
            one.tables[form] = table
