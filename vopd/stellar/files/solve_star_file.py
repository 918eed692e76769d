"""What `vopd stars solve` does, from file to text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vopd.findings import DeckError, Finding
from vopd.stellar.failures import Failure
from vopd.stellar.files.input_text import read_text
from vopd.stellar.files.solution_findings import check, explain, explain_outliers
from vopd.stellar.files.solution_output import as_csv, as_json, as_text
from vopd.stellar.files.star_file import StarFile, file_directions, read_star_file
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.run_methods import METHODS, SolvedField, StarOptions, solve
from vopd.stellar.star_field import StarField


@dataclass(frozen=True)
class StarRequest:
    """What to solve a star file for; `pair` counts from 1, `method` may be "all"."""

    focal_length_mm: float
    method: str = "collinearity"
    pair: tuple[int, int] | None = None
    all_pairs: bool = False
    camera_m: tuple[float, ...] | None = None
    options: StarOptions = field(default_factory=StarOptions)


@dataclass(frozen=True)
class StarOutput:
    """The output, what is to be said about it, and the exit status: 0, 1 or 3."""

    text: str
    findings: tuple[Finding, ...]
    status: int


def solve_text(name: str, form: str, request: StarRequest) -> StarOutput:
    """Read a star file (`-`: standard input), solve it, write text, json or csv.

    Raises DeckError for a file that no method can solve; a method's own failure
    is a finding and leaves the others' solutions.
    """
    text, deck = read_text(name)
    findings: list[Finding] = []
    file = read_star_file(text, deck)
    camera = _camera(file, request.camera_m)
    stars = StarField.of(
        file_directions(file, camera, findings.append), file.image_mm, request.focal_length_mm
    )
    check(file, stars)
    methods: tuple[str, ...] = METHODS if request.method == "all" else (request.method,)
    if request.method == "all" and len(file.lines) < 3:
        methods = tuple(method for method in methods if not method.startswith("church"))
    records = solve(stars, methods, _pairs(file, request), request.options)
    findings += _remarks(records, file, stars, request)
    shown = [record for record in records if record.printable]
    if form == "json":
        page = as_json(shown)
    elif form == "csv":
        page = as_csv(shown)
    else:
        page = as_text(shown, file, stars)
    failures = {record.failure for record in records} - {Failure.NONE}
    status = 1 if failures - {Failure.NO_CONVERGENCE} else 3 if failures else 0
    return StarOutput(page, tuple(findings), status)


def _camera(file: StarFile, camera_m: tuple[float, ...] | None) -> np.ndarray | None:
    ground = file.kind == "x_m,y_m,z_m"
    if ground and camera_m is None:
        raise DeckError(Finding("ground points need --camera X,Y,Z", deck=file.deck))
    if camera_m is not None and not ground:
        message = f"--camera is for ground points; the file has {file.kind}"
        raise DeckError(Finding(message, deck=file.deck))
    return None if camera_m is None else np.array(camera_m)


def _pairs(file: StarFile, request: StarRequest) -> np.ndarray | None:
    count = len(file.lines)
    if request.all_pairs:
        return star_pairs(count)
    if request.pair is None:
        return None
    if max(request.pair) > count:
        message = f"there is no star {max(request.pair)}: the file ends with star {count}"
        raise file.error(message, count - 1)
    return np.array([request.pair]) - 1


def _remarks(
    records: Sequence[SolvedField], file: StarFile, stars: StarField, request: StarRequest
) -> list[Finding]:
    findings = [finding for record in records for finding in explain(record, file, stars)]
    whole = not request.all_pairs and request.pair is None
    alone = [r.method for r in records if r.method in ("two-star", "single-rotation")]
    if whole and alone and len(file.lines) > 2:
        message = (
            f"{' and '.join(alone)}: stars 1 and 2 of {len(file.lines)}, as listed; "
            "--pair or --all-pairs for others"
        )
        findings.append(Finding(message, deck=file.deck, severity="warning"))
    if request.all_pairs:
        findings += explain_outliers(file, stars)
    return findings
