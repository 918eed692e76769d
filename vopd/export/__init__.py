"""The file formats of the attitude table, and what the user specifies for a file of any format."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from html import escape
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from vopd.files import optional_package
from vopd.findings import Report, VopdError, strict

if TYPE_CHECKING:  # a command that offers the formats does not wait for what makes them
    from vopd.attitude.history import History
    from vopd.attitude.long_history import HistoryParts
    from vopd.estimate import About


def created_now() -> datetime:
    """Take the current time in UTC, to the second, or SOURCE_DATE_EPOCH of the environment.

    Raises:
        VopdError: where that is not a number of seconds since 1970
    """
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        return datetime.now(UTC).replace(microsecond=0)
    try:
        return datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError) as error:
        raise VopdError(
            f"SOURCE_DATE_EPOCH: {given!r} is not a number of seconds since 1970"
        ) from error


@dataclass(frozen=True)
class FileRequest:
    """What the user specifies for a file.

    Args:
        epoch: the moment of time zero, with its time zone; None if unknown
        aem_version: of CCSDS 504.0-B, 1 or 2
        originator: who made an AEM or ACM
        object_name: what the vehicle is called; empty if unknown
        object_id: its international designator, in an AEM or ACM; empty if unknown
        created: the date that an AEM or ACM bears
        columns: of the table, by name; "all" and "basic" stand for several
        roll_180: whether roll is -180 to 180 in the table, and not 0 to 360
    """

    epoch: datetime | None = None
    aem_version: int = 2
    originator: str = "VOPD"
    object_name: str = ""
    object_id: str = ""
    created: datetime = field(default_factory=created_now)
    columns: tuple[str, ...] = ("all",)
    roll_180: bool = False


@dataclass(frozen=True)
class AttitudeFormat:
    """A file format of the attitude table."""

    name: str
    suffixes: tuple[str, ...]
    about: str  # a line for the help
    needs_epoch: bool = False
    binary: bool = False
    options: tuple[str, ...] = ()  # the fields of `FileRequest` that it uses
    by_parts: bool = False  # a job's parts are written one after the other
    together: bool = False  # the rows of many files are made together
    package: str = ""  # an optional one, installed by the extra with the format's name

    def ready(self) -> None:
        """Check that the format can be written.

        Raises:
            VopdError: where its optional package is not installed
        """
        if self.package:
            optional_package(self.package, self.name)

    def pages(
        self, jobs: Sequence[HistoryParts], request: FileRequest, report: Report = strict
    ) -> Iterator[bytes]:
        """Make the content of the file page by page, `by_parts` with one part of a job at a time.

        Raises:
            VopdError: before the first page, where no frame is left, or a needed package or
                epoch is missing
        """
        if self.needs_epoch and request.epoch is None:
            raise VopdError(f"{self.name} needs the epoch of time zero")
        if not jobs:
            raise VopdError("there is no job to write")
        self.ready()
        named = [job.with_about(_printable(job.about)) for job in jobs]
        if self.by_parts:
            yield from _writer(self.name)(named, request, report)
        else:
            yield _writer(self.name)([job.whole for job in named], request, report)

    def mean_table(self, jobs: Sequence[HistoryParts], request: FileRequest) -> bytes:
        """Make the content of a file of mean attitudes, a row a job, in one of `MEAN_FORMATS`.

        Raises:
            VopdError: where a job has no mean
        """
        from vopd.export.tables import render_means

        named = [job.with_about(_printable(job.about)).whole for job in jobs]
        return render_means(self.name, named, request)

    def render(
        self, histories: Sequence[History], request: FileRequest, report: Report = strict
    ) -> bytes:
        """Make the content of the file at once; arguments and errors as `pages`."""
        from vopd.attitude.long_history import one_part

        return b"".join(self.pages(list(map(one_part, histories)), request, report))

    def render_files(
        self, files: Sequence[tuple[Sequence[History], FileRequest, Report]]
    ) -> list[bytes | VopdError]:
        """Make the contents of many files, each as `render` does, or the error of each."""
        if self.together:
            from vopd.attitude.long_history import with_about
            from vopd.export.tables import render_files

            return list(
                render_files(
                    [
                        ([with_about(h, _printable(h.about)) for h in histories], request)
                        for histories, request, _ in files
                    ]
                )
            )
        made: list[bytes | VopdError] = []
        for file in files:
            try:
                made.append(self.render(*file))
            except VopdError as error:
                made.append(error)
        return made


def _printable(about: About) -> About:
    """Replace the name of a source by one that every format can hold."""
    return about._replace(source=printable(about.source))


TABLE_OPTIONS = ("epoch", "columns", "roll_180")  # the fields of `FileRequest` that a table uses
FORMATS = {
    one.name: one
    for one in (
        AttitudeFormat(
            "csv", (".csv",), "the default; conventions in lines that begin with #",
            options=TABLE_OPTIONS, by_parts=True, together=True,
        ),
        AttitudeFormat(
            "jsonl", (".jsonl", ".ndjson"), "JSON Lines, an object a frame",
            options=TABLE_OPTIONS, by_parts=True,
        ),
        AttitudeFormat(
            "npz", (".npz",), "NumPy, an array a column", options=TABLE_OPTIONS, binary=True,
        ),
        AttitudeFormat(
            "parquet", (".parquet", ".pq"), "for data frames; needs pyarrow",
            options=TABLE_OPTIONS, binary=True, package="pyarrow",
        ),
        AttitudeFormat(
            "aem", (".aem",), "CCSDS Attitude Ephemeris Message; needs --epoch", needs_epoch=True,
            options=("epoch", "aem_version", "originator", "object_name", "object_id"),
        ),
        AttitudeFormat(
            "acm", (".acm",), "CCSDS Attitude Comprehensive Message, with variances; needs --epoch",
            needs_epoch=True, options=("epoch", "originator", "object_name", "object_id"),
        ),
        AttitudeFormat(
            "czml", (".czml",), "for Cesium: position and orientation; needs --epoch",
            needs_epoch=True, options=("epoch", "object_name"),
        ),
        AttitudeFormat(
            "kml", (".kml",), "for Google Earth; needs times; with --epoch a track",
            options=("epoch", "object_name"),
        ),
        AttitudeFormat(
            "odm", ("geo.txt",), "OpenDroneMap: position and yaw, pitch, roll of each image",
        ),
        AttitudeFormat(
            "colmap", ("images.txt",), "COLMAP: rotation and translation of each image",
        ),
        AttitudeFormat(
            "opk", (".opk.csv",), "omega, phi, kappa against the map grid, and grid azimuth, CSV",
        ),
    )
}  # fmt: skip
"""Every format by its name."""

MEAN_FORMATS = ("csv", "jsonl", "npz", "parquet")  # those that can hold a table of mean attitudes


def _writer(name: str) -> Callable[..., Any]:
    """Import the function that writes a format, and the module of that format alone.

    It is called with histories, request and report, and gives the file; where the format is
    written `by_parts`, it is called with jobs and gives pages.
    """
    if name in ("csv", "jsonl", "npz", "parquet"):
        from vopd.export import tables

        writers: dict[str, Callable[..., Any]] = {
            "csv": tables.pages_csv,
            "jsonl": tables.pages_json_lines,
            "npz": tables.render_npz,
            "parquet": tables.render_parquet,
        }
        return writers[name]
    if name in ("aem", "acm"):
        from vopd.export import ccsds

        return {"aem": ccsds.render_aem, "acm": ccsds.render_acm}[name]
    if name in ("czml", "kml"):
        from vopd.export import viewers

        return {"czml": viewers.render_czml, "kml": viewers.render_kml}[name]
    from vopd.export import photogrammetry

    return {
        "odm": photogrammetry.render_odm_geo,
        "colmap": photogrammetry.render_colmap,
        "opk": photogrammetry.render_omega_phi_kappa,
    }[name]


def of_file(name: str) -> AttitudeFormat:
    """Find the format of a file by the suffix of its name.

    Raises:
        VopdError: where it has no suffix of a known format
    """
    lower = PurePath(name).name.lower()
    fitting = [(s, one) for one in FORMATS.values() for s in one.suffixes if lower.endswith(s)]
    if fitting:
        return max(fitting, key=lambda pair: len(pair[0]))[1]
    suffix = PurePath(name).suffix.lower()
    known = " ".join(s for one in FORMATS.values() for s in one.suffixes)
    what = f"the suffix {suffix!r} is not known" if suffix else "no suffix that names a format"
    raise VopdError(f"{name}: {what}; known suffixes are {known}")


# The epoch, statements and names that several formats write

ZERO = "; zero is "  # what a statement of the time says before the epoch


def own_epoch(histories: Sequence[History]) -> datetime | None:
    """Find the epoch that all sources state; None if one states none or another."""
    stated = {h.about.epoch for h in histories}
    return stated.pop() if len(stated) == 1 else None


def utc(epoch: datetime, microseconds: int) -> str:
    """Write date and time in ISO 8601, without Z, some microseconds after the epoch.

    Leap seconds are not counted.
    """
    moment = (epoch + timedelta(microseconds=microseconds)).astimezone(UTC)
    return moment.replace(tzinfo=None).isoformat(timespec="microseconds")


def has_date(epoch: datetime, microseconds: int) -> bool:
    """Tell whether `utc` can write this moment: it lies in the years 1 to 9999."""
    try:
        utc(epoch, microseconds)
    except OverflowError:
        return False
    return True


def statements(histories: Sequence[History], request: FileRequest, **own: str) -> dict[str, str]:
    """State the conventions, with the epoch added."""
    from vopd.attitude.conventions import conventions

    stated = conventions(histories)
    time, _, zero = stated["time"].partition(ZERO)
    if request.epoch is not None:
        zero = f"{utc(request.epoch, 0)}Z"
    elif len({h.about.epoch for h in histories}) > 1:
        zero = "each source's own epoch"
    stated["time"] = f"{time}{ZERO}{zero}" if zero else time
    return {key: printable(text) for key, text in (stated | own).items()}


def html(stated: dict[str, str]) -> str:
    """Write statements as an HTML table, for viewers that show a description as HTML."""
    rows = (f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in stated.items())
    return f"<table>{''.join(rows)}</table>"


def title(history: History) -> str:
    """Title a job: by its own title, else by source and number."""
    return printable(history.about.title) or history.about.label


def name(request: FileRequest, history: History) -> str:
    """Name the vehicle for a viewer: as the user does, else by the title of the job."""
    return printable(request.object_name.strip()) or title(history)


def printable(text: str) -> str:
    """Escape what is not printable: line ends, bytes that are not UTF-8."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
