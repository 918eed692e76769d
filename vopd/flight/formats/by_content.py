"""Formats of files, told by their content: the first that recognises a file reads it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from vopd.files import names_stars, reason
from vopd.findings import MANY_NAMED
from vopd.flight.formats.columns import (
    GEODETIC,
    OF_STARS,
    SYNONYMS,
    TIME,
    mapped,
    other_sense,
    other_unit,
)
from vopd.flight.formats.files import UNEXPECTED, InputFile
from vopd.flight.formats.tables import header_names, is_nested
from vopd.inputs import is_number

R = TypeVar("R")


class InputFormat(NamedTuple, Generic[R]):
    """A format of a file: one row of a table of formats."""

    name: str
    recognises: Callable[[InputFile], bool]  # by content
    read: Callable[..., R]
    has_columns: bool = False  # which a project may map: a CSV


def read_by_content(formats: Sequence[InputFormat[R]], file: InputFile, *more: Any) -> R:
    """Read a file by the first format that recognises it.

    Args:
        formats: the formats that are looked for
        file: the file
        more: further arguments of the formats' readers

    Raises:
        VopdError: where none does
    """
    others = [what for what in file.logs if not any(what in one.name for one in formats)]
    if others:  # before a CSV, whose commas NMEA has
        raise file.error(file.logs[others[0]])
    for one in formats:
        if one.recognises(file):
            if file.columns and not one.has_columns:
                raise file.error(f"columns are of a CSV, and the file is {one.name}")
            try:
                return one.read(file, *more)
            except UNEXPECTED as error:  # a value of another kind than the format has there
                raise file.error(f"not as {one.name} should be: {reason(error)}") from error
    if file.is_video:
        raise file.error("is a video: vopd new DIR --video FILE makes a project of it")
    known = ", ".join(one.name for one in formats)
    if not any("folder" in one.name for one in formats):
        file.refuse_folder()
    what = "is a folder that" if file.given is None and file.path.is_dir() else "the format"
    of_columns = [one.name for one in formats if one.has_columns]
    hint = _unnamed(file, of_columns[0]) if of_columns else ""
    raise file.error(f"{what} is not recognised; known are {known}{hint}")


FROM = "from_deg"
TIE_POINTS = "OPENSFM_TRACKS_VERSION"
OF_TIE_POINTS = (
    ": the tie points of OpenSfM's tracks.csv have coordinates by the images alone, and no "
    "landmark; clicks of surveyed ones are in ground_control_points.json or gcp_list.txt"
)


def _unnamed(file: InputFile, known: str) -> str:
    """Say what to do where the columns of a table are not known; empty if it is no table.

    Args:
        file: the table
        known: the format that it may be, with the names of its columns
    """
    if is_nested(file):
        return ""
    if file.head.lower().startswith("sep="):
        return "; its first line, sep=, is a spreadsheet's: remove that line"
    header = header_names(file)
    if header and header[0].startswith(TIE_POINTS):
        return OF_TIE_POINTS
    if len(header) < 2:
        given = isinstance(file.columns, list)
        return f"; columns names {', '.join(header)} alone: name all of its columns" * given
    if any(map(is_number, header)):
        return (
            '; a CSV without a header needs columns = ["...", "..."], the names of all of them '
            "(vopd new --columns picks:NAME,NAME,...)"
        )
    if not {*header} - {*SYNONYMS, *TIME}:
        return ""  # a table of another kind
    if names_stars(header):
        return OF_STARS
    wanted = (TIME[0], *GEODETIC, *[FROM] * (FROM in known))
    some = (other_unit(one, name) for one in header for name in wanted)
    if units := [*filter(None, some)]:
        return f"; {'; '.join(units)}"
    if FROM in known and (senses := [*filter(None, (other_sense(one, FROM) for one in header))]):
        return f"; {'; '.join(senses)}"
    names = ", ".join(header[:MANY_NAMED])
    return f"; its columns are {names}: rename them, or map them, {mapped('...', '...')}"
