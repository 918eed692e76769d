"""The file formats of the attitude table: one table of formats, a function for each.

The function of a format is called with histories, request and report, and returns the
whole file as bytes; where the file has rows, one after the other, it makes the file page
by page.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import PurePath
from typing import TYPE_CHECKING

from vopd.findings import Report, VopdError, strict

if TYPE_CHECKING:  # a command that offers the formats does not wait for what makes them
    from vopd.attitude.history import History
    from vopd.attitude.long_history import HistoryParts
    from vopd.estimate import About
    from vopd.export.file_request import FileRequest, TableFile


@dataclass(frozen=True)
class AttitudeFormat:
    """A file format of the attitude table."""

    name: str
    suffixes: tuple[str, ...]
    module: str
    function: str  # of the module: renders the whole file, or makes its pages where `by_parts`
    about: str  # a line for the help
    needs_epoch: bool = False
    binary: bool = False
    options: tuple[str, ...] = ()  # the fields of `FileRequest` that it uses, besides the epoch
    by_parts: bool = False  # a job's parts are written one after the other
    together: bool = False  # the rows of many files are made together
    package: str = ""  # an optional one, installed by the extra with the format's name

    def ready(self) -> None:
        """Check that the format can be written.

        Raises:
            VopdError: where its optional package is not installed
        """
        if self.package:
            try:
                import_module(self.package)
            except ImportError as error:
                extra = f"pip install 'vopd[{self.name}]'"
                raise VopdError(f"{self.package} is not installed: {extra}") from error

    def pages(
        self, jobs: Sequence[HistoryParts], request: FileRequest, report: Report = strict
    ) -> Iterator[bytes]:
        """Make the content of the file page by page, `by_parts` with one part of a job at a time.

        Args:
            jobs: one or more, of one kind of source
            request: epoch and names
            report: is given warnings, for instance about frames that are left out

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
        function = getattr(import_module(self.module), self.function)
        if self.by_parts:
            yield from function(named, request, report)
        else:
            yield function([job.whole for job in named], request, report)

    def render(
        self, histories: Sequence[History], request: FileRequest, report: Report = strict
    ) -> bytes:
        """Make the content of the file at once; arguments and errors as `pages`."""
        from vopd.attitude.long_history import one_part

        return b"".join(self.pages(list(map(one_part, histories)), request, report))

    def render_files(self, files: Sequence[TableFile]) -> list[bytes | VopdError]:
        """Make the contents of many files, each as `render` does, or the error of each.

        Args:
            files: what each is to hold
        """
        if self.together:
            from vopd.attitude.long_history import with_about

            named = [
                file._replace(
                    histories=[with_about(h, _printable(h.about)) for h in file.histories]
                )
                for file in files
            ]
            return list(import_module(self.module).render_files(named))
        return [self._rendered(file) for file in files]

    def _rendered(self, file: TableFile) -> bytes | VopdError:
        try:
            return self.render(*file)
        except VopdError as error:
            return error


def _printable(about: About) -> About:
    """The same with a source name that every format can hold."""
    from vopd.export.file_request import printable

    return about._replace(source=printable(about.source))


FORMATS = {
    one.name: one
    for one in (
        AttitudeFormat(
            "csv",
            (".csv",),
            "vopd.export.tables",
            "pages_csv",
            "the default; conventions in lines that begin with #",
            by_parts=True,
            together=True,
        ),
        AttitudeFormat(
            "jsonl",
            (".jsonl", ".ndjson"),
            "vopd.export.tables",
            "pages_json_lines",
            "JSON Lines, an object a frame",
            by_parts=True,
        ),
        AttitudeFormat(
            "npz",
            (".npz",),
            "vopd.export.tables",
            "render_npz",
            "NumPy, an array a column",
            binary=True,
        ),
        AttitudeFormat(
            "parquet",
            (".parquet", ".pq"),
            "vopd.export.tables",
            "render_parquet",
            "for data frames; pip install 'vopd[parquet]'",
            binary=True,
            package="pyarrow",
        ),
        AttitudeFormat(
            "aem",
            (".aem",),
            "vopd.export.ccsds",
            "render_aem",
            "CCSDS Attitude Ephemeris Message; needs --epoch",
            needs_epoch=True,
            options=("aem_version", "originator", "object_name", "object_id"),
        ),
        AttitudeFormat(
            "acm",
            (".acm",),
            "vopd.export.ccsds",
            "render_acm",
            "CCSDS Attitude Comprehensive Message, with variances; needs --epoch",
            needs_epoch=True,
            options=("originator", "object_name", "object_id"),
        ),
        AttitudeFormat(
            "czml",
            (".czml",),
            "vopd.export.viewers",
            "render_czml",
            "for Cesium: position and orientation; needs --epoch",
            needs_epoch=True,
            options=("object_name",),
        ),
        AttitudeFormat(
            "kml",
            (".kml",),
            "vopd.export.viewers",
            "render_kml",
            "for Google Earth: a track with --epoch, or a path",
            options=("object_name",),
        ),
        AttitudeFormat(
            "odm",
            ("geo.txt",),
            "vopd.export.photogrammetry",
            "render_odm_geo",
            "OpenDroneMap: position and yaw, pitch, roll of each image",
        ),
        AttitudeFormat(
            "colmap",
            ("images.txt",),
            "vopd.export.photogrammetry",
            "render_colmap",
            "COLMAP: rotation and translation of each image",
        ),
        AttitudeFormat(
            "opk",
            (".opk.csv",),
            "vopd.export.photogrammetry",
            "render_omega_phi_kappa",
            "omega, phi, kappa against the map grid, and grid azimuth, CSV",
        ),
    )
}
"""Every format by its name."""


def of_file(name: str) -> AttitudeFormat:
    """The format of a file, by the suffix of its name.

    Args:
        name: the file's name

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
