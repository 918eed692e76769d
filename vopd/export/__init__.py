"""The file formats of the attitude table: one registry, one module a format.

Each format's module has `render(histories, request, report)`, which gives the
whole file as bytes, so that nothing is written before all of it is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import PurePath

from vopd.attitude.history import History
from vopd.export.request import Request, printable
from vopd.findings import Report, VopdError, strict


@dataclass(frozen=True)
class Format:
    """A file format. `options` are the fields of `Request`, epoch apart, that it makes use of."""

    name: str
    suffixes: tuple[str, ...]
    module: str
    about: str
    needs_epoch: bool = False
    binary: bool = False
    options: tuple[str, ...] = ()
    package: str = ""  # an optional one, of the extra with the format's name

    def ready(self) -> None:
        """Raise `VopdError` where an optional package is not installed."""
        if self.package:
            try:
                import_module(self.package)
            except ImportError as error:
                extra = f"pip install 'vopd[{self.name}]'"
                raise VopdError(f"{self.package} is not installed: {extra}") from error

    def render(
        self, histories: Sequence[History], request: Request, report: Report = strict
    ) -> bytes:
        """The file's content; `report` is given warnings, as of frames that are left out.

        Raises `VopdError` where no frame is left, a time has no date, or a
        needed package or epoch is missing.
        """
        if self.needs_epoch and request.epoch is None:
            raise VopdError(f"{self.name} needs the epoch of time zero")
        if not histories:
            raise VopdError("the deck has no job")
        self.ready()
        said = [_printable_source(h) for h in histories]
        content: bytes = import_module(self.module).render(said, request, report)
        return content


def _printable_source(history: History) -> History:
    """The history with a source name that every format can hold."""
    about = history.about._replace(source=printable(history.about.source))
    return replace(history, estimate=replace(history.estimate, about=about))


FORMATS = {
    one.name: one
    for one in (
        Format(
            "csv",
            (".csv",),
            "vopd.export.delimited",
            "the default; conventions in lines that begin with #",
        ),
        Format(
            "jsonl",
            (".jsonl", ".ndjson"),
            "vopd.export.json_lines",
            "JSON Lines, an object a frame",
        ),
        Format("npz", (".npz",), "vopd.export.npz", "NumPy, an array a column", binary=True),
        Format(
            "parquet",
            (".parquet", ".pq"),
            "vopd.export.parquet",
            "for data frames; pip install 'vopd[parquet]'",
            binary=True,
            package="pyarrow",
        ),
        Format(
            "aem",
            (".aem",),
            "vopd.export.aem",
            "CCSDS Attitude Ephemeris Message; needs --epoch",
            needs_epoch=True,
            options=("aem_version", "originator", "object_name", "object_id"),
        ),
        Format(
            "czml",
            (".czml",),
            "vopd.export.czml",
            "for Cesium: place and orientation; needs --epoch",
            needs_epoch=True,
            options=("object_name",),
        ),
        Format(
            "kml",
            (".kml",),
            "vopd.export.kml",
            "for Google Earth: a track with --epoch, or a path",
            options=("object_name",),
        ),
    )
}
"""Every format by its name."""


def of_file(name: str) -> Format:
    """The format of a file by its suffix. Raises `VopdError` where it has none of the known."""
    suffix = PurePath(name).suffix.lower()
    for one in FORMATS.values():
        if suffix in one.suffixes:
            return one
    known = " ".join(s for one in FORMATS.values() for s in one.suffixes)
    what = f"suffix {suffix!r} is not known" if suffix else "no suffix that names a format"
    raise VopdError(f"{name}: {what}; known are {known}")
