"""Star files solved: photographs in, solutions and findings out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from vopd.findings import Finding, InputError, Report
from vopd.stellar.files.findings import KindOfFinding, counted
from vopd.stellar.files.images import MissingOption
from vopd.stellar.files.photograph import SolvedPhotograph, StarRequest, solve_photograph
from vopd.stellar.files.plate_solvers import read_corr_fits, read_plate_solutions
from vopd.stellar.files.read import StarFile, decoded_text, read_bytes, read_star_csv
from vopd.stellar.files.table import as_csv, as_json
from vopd.stellar.files.text import as_text
from vopd.stellar.listed import LISTED_CORRECTIONS, stars_printout

FITS = b"SIMPLE  ="
"""How every FITS file begins."""


def read_photographs(name: str, report: Report) -> list[StarFile]:
    """Read the photographs of a file: CSV, a plate solution in JSON, or astrometry.net's corr.fits.

    The format is known by the content, not by the name.

    Args:
        name: the file's name; `-` is standard input
        report: takes warnings, and errors of one photograph of several

    Raises:
        InputError: the file cannot be read, or is none of these.
        VopdError: where a package that the format needs is not installed.
    """
    data, deck = read_bytes(name)
    if data.startswith(FITS):
        return [read_corr_fits(data, deck)]
    text = decoded_text(data, deck)
    if text.lstrip()[0] in "{[":
        return read_plate_solutions(text, deck, report)
    return read_star_csv(text, deck, report=report)


class SolvedFiles(NamedTuple):
    """The solved photographs of some files, the findings, and the exit status 0, 1 or 3."""

    photographs: list[SolvedPhotograph]
    findings: tuple[Finding, ...]
    status: int


def solution_text(photographs: Sequence[SolvedPhotograph], form: str, request: StarRequest) -> str:
    """Format solutions as `vopd stars solve` prints them.

    Args:
        photographs: what was solved
        form: "text", "json" or "csv"
        request: what was asked for
    """
    if request.listing:
        return "\n".join(_listing(one, request) for one in photographs)
    if form == "json":
        return as_json(photographs)
    if form == "csv":
        return as_csv(photographs)
    return as_text(photographs, robust=request.options.weights == "robust")


def solve_photographs(names: Sequence[str], request: StarRequest) -> SolvedFiles:
    """Read star files and solve their photographs.

    Args:
        names: the files' names; `-` is standard input
        request: what to solve them for

    Returns:
        The photographs. A method or a photograph that fails is a finding and leaves
        the other solutions; the status is then 1, and 3 where a solution did not
        converge or residuals are implausible.

    Raises:
        InputError: there is only one photograph, and it cannot be read, or no method
            can solve it.
        MissingOption: no photograph is solved, and one needs an option that is not given.
    """
    notes: list[Finding] = []
    files: list[StarFile] = []
    for name in names:
        try:
            files += read_photographs(name, notes.append)
        except InputError as error:
            if len(names) == 1:
                raise
            notes.append(error.finding)
    kinds = [KindOfFinding(str(k), finding) for k, finding in enumerate(notes)]
    failed = any(finding.severity == "error" for finding in notes)
    several = len(files) > 1 or len(names) > 1
    photographs = []
    missing = None
    for file, label in zip(files, _labels(files, several=several), strict=True):
        try:
            photographs.append(solve_photograph(file, request, label))
        except InputError as error:
            if not several and not failed:
                raise
            kinds.append(KindOfFinding("unsolvable", error.finding))
            failed = True
        except MissingOption as error:
            kinds.append(KindOfFinding("unsolvable", Finding(str(error))))
            missing, failed = missing or error, True
    if missing is not None and not photographs:
        raise missing
    for one in photographs:
        kinds += one.findings
    statuses = {1} if failed else {one.status for one in photographs}
    status = next((status for status in (1, 3) if status in statuses), 0)
    return SolvedFiles(photographs, tuple(counted(kinds)), status)


def _labels(files: Sequence[StarFile], *, several: bool) -> list[str]:
    """Label each photograph by its name, its file's name, or both."""
    names = Counter(file.photograph for file in files)
    labels = []
    for file in files:
        label = file.photograph or (file.deck if several else "")
        if file.photograph and names[file.photograph] > 1:
            label = f"{file.deck}: {file.photograph}"
        labels.append(label)
    return labels


def _listing(one: SolvedPhotograph, request: StarRequest) -> str:
    """Print a photograph as program STARS does; four corrections unless a number is given."""
    options = request.options
    page = stars_printout(
        one.stars.only(one.used),
        initial_deg=options.initial_deg,
        start=options.start,
        weights=options.weights,
        corrections=options.corrections or LISTED_CORRECTIONS,
        reading_sigma_mm=options.reading_sigma_mm,
    )
    return f"{one.label}\n{page}" if one.label else page
