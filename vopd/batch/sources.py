"""The sources of a batch, by file, folder, pattern or manifest; their hashes; its settings."""

from __future__ import annotations

import glob
import hashlib
import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePath
from typing import NamedTuple

from vopd.attitude.history import HistoryOptions
from vopd.attitude.sigmas import Sigmas
from vopd.export import FORMATS
from vopd.files import A_VIDEO, ENDS, kind_by_first_bytes, not_utf8, size_and_ends
from vopd.findings import VopdError
from vopd.flight.project.named import named_files
from vopd.inputs import no_file, read_limited
from vopd.pipeline import SolveOptions, is_flight

IN_FOLDERS = (".dat", ".deck", ".cards", ".toml")
"""Suffixes of the files that are taken from a folder; files that are named may have any."""


class BatchSource(NamedTuple):
    """A deck or a flight project of a batch."""

    path: str  # as it is opened, and as tables name it
    name: str  # of its outputs, without a suffix; folders are parted by /
    size: int  # bytes; 0 where the file cannot be read

    @property
    def flight(self) -> bool:
        """Tell a flight project from a deck."""
        return is_flight(self.path)


def find_sources(
    given: Sequence[str], manifest: str | None, folder: str, suffixes: Sequence[str]
) -> list[BatchSource]:
    """List all sources of a batch in the order of their names.

    A source of a folder is named by its path in that folder, one of a pattern by its path
    below the folders that the pattern names in full, one of a manifest by its path as it
    stands there, and a file that is given by its own name. Sources that would have one name
    are named by their paths below the folder that all of these are in.

    Args:
        given: files, folders, or patterns with `*`, `?`, `[]` or `**`
        manifest: a text file that has one of those on each line, relative to its own folder
        folder: the output folder
        suffixes: those of all outputs that a source may have, and with the dot

    Raises:
        VopdError: where there is no source, two have outputs of the same name, or the
            output folder and the sources are not apart
    """
    found: dict[str, BatchSource] = {}
    for path, name in _all_of(given, manifest):
        real = os.path.realpath(path)
        if real not in found:
            found[real] = BatchSource(path, PurePath(name).with_suffix("").as_posix(), _size(path))
    if not found:
        raise VopdError("there is no source: give a deck, a project, a folder or --manifest")
    _check_folder(found, given, folder)
    sources = sorted(_apart([*found.values()]), key=lambda one: (one.name, one.path))
    check_names(sources, suffixes)
    return sources


def _apart(found: list[BatchSource]) -> list[BatchSource]:
    """Name sources of one name by their paths below the folder that all of them are in."""
    count = Counter(one.name for one in found)
    paths = {one.path: os.path.abspath(one.path) for one in found if count[one.name] > 1}  # noqa: PTH100
    try:
        folder = os.path.commonpath([os.path.dirname(one) for one in paths.values()])  # noqa: PTH120
    except ValueError:  # none, or on several drives
        return found
    names = {
        path: PurePath(os.path.relpath(one, folder)).with_suffix("").as_posix()
        for path, one in paths.items()
    }
    return [one._replace(name=names.get(one.path, one.name)) for one in found]


def _all_of(given: Sequence[str], manifest: str | None) -> Iterator[tuple[str, str]]:
    """List path and name of every file, the name still with its suffix."""
    for one in given:
        yield from _matching(one, PurePath(one).name)
    if manifest is None:
        return
    home, entries = os.path.dirname(manifest), _entries(manifest)  # noqa: PTH120
    for entry in entries:
        inside = not PurePath(entry).is_absolute() and ".." not in PurePath(entry).parts
        path = os.path.join(home, entry)  # noqa: PTH118
        for file, name in _matching(path, entry if inside else PurePath(entry).name):
            if os.path.realpath(file) == os.path.realpath(manifest):
                raise VopdError(f"{manifest}: the manifest names itself as a source: {entry}")
            yield file, name


def _entries(manifest: str) -> list[str]:
    try:
        if kind := no_file(manifest, pipes=True):
            raise VopdError(f"{manifest}: {kind}")
        with open(manifest, "rb") as file:  # noqa: PTH123
            lines = read_limited(file).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise VopdError(f"{manifest}: {not_utf8(error.object, error.start)}") from error
    except OSError as error:
        raise VopdError(f"{manifest}: {error.strerror}") from error
    except ValueError as error:
        raise VopdError(f"{manifest}: {error}") from error
    for number, line in enumerate(lines, 1):
        if "\0" in line or len(line) > LONGEST_NAME:
            what = "a null character" if "\0" in line else f"more than {LONGEST_NAME} characters"
            raise VopdError(f"{manifest}: line {number}: the name of a source has {what}")
    entries = [line.strip() for line in lines]
    entries = [line for line in entries if line and not line.startswith("#")]
    if not entries:
        raise VopdError(f"{manifest}: the manifest is empty: write one source on each line")
    return entries


LONGEST_NAME = 4096  # characters of a line of a manifest: no file has a longer name


def _matching(one: str, name: str) -> Iterator[tuple[str, str]]:
    """List the files of one argument with their names."""
    if not one:
        raise VopdError("a source has no name: give a file, a folder or a pattern")
    if one == "-":
        raise VopdError("-: standard input cannot be a source of a batch: write it to a file")
    if os.path.isdir(one):  # noqa: PTH112
        files = list(_in_folder(one))
        if not files:
            known = " ".join(IN_FOLDERS)
            raise VopdError(
                f"{one}: there is no deck and no project in this folder; taken are files that "
                f"end in {known}: name others by a pattern, such as '{one}/*.txt'"
            )
        yield from files
    elif glob.has_magic(one) and not os.path.exists(one):  # noqa: PTH110
        start = _fixed_part(one)
        paths = [path for path in glob.glob(one, recursive=True) if os.path.isfile(path)]  # noqa: PTH113, PTH207
        if not paths:
            raise VopdError(f"{one}: no file matches this pattern")
        for path in paths:
            yield path, os.path.relpath(path, start or ".")
    else:
        yield one, name


def _in_folder(folder: str) -> Iterator[tuple[str, str]]:
    """List the decks and projects of a folder and its folders; hidden ones are left out.

    Raises:
        VopdError: where one of the folders cannot be read
    """

    def refuse(error: OSError) -> None:
        raise VopdError(f"{error.filename}: {error.strerror}") from error

    for place, folders, files in os.walk(folder, onerror=refuse):
        folders[:] = [one for one in folders if not one.startswith(".")]
        for file in files:
            if file.lower().endswith(IN_FOLDERS) and not file.startswith("."):
                path = os.path.join(place, file)  # noqa: PTH118
                yield path, os.path.relpath(path, folder)


def _fixed_part(pattern: str) -> str:
    """Take the folders of a pattern before the first that has a wildcard."""
    fixed = []
    for part in PurePath(pattern).parts:
        if glob.has_magic(part):
            break
        fixed.append(part)
    return os.path.join(*fixed) if fixed else ""  # noqa: PTH118


def _size(path: str) -> int:
    try:
        return os.path.getsize(path)  # noqa: PTH202
    except OSError:  # the record of the source will say so
        return 0


def _check_folder(files: Iterable[str], given: Sequence[str], folder: str) -> None:
    out = os.path.realpath(folder)
    inputs = [os.path.realpath(one) for one in given if os.path.isdir(one)]  # noqa: PTH112
    for one in inputs:
        if _within(out, one):
            raise VopdError(f"{folder}: the output folder is inside the inputs; name another")
    for file in files:
        if _within(file, out):
            raise VopdError(f"{folder}: the output folder has the input {file} in it; name another")


def _within(path: str, folder: str) -> bool:
    return path == folder or path.startswith(os.path.join(folder, ""))  # noqa: PTH118


SUMMARY, SUMMARY_TABLE, TIMES = "summary.jsonl", "summary.parquet", "times.jsonl"
BATCH_PAGE = "index.html"
OWN_FILES = (SUMMARY, SUMMARY_TABLE, TIMES, BATCH_PAGE)
"""The files of a batch itself, in the output folder."""


def check_names(sources: Sequence[BatchSource], suffixes: Sequence[str]) -> None:
    """Refuse sources of which two would have outputs of one name, or one of the batch itself."""
    taken: dict[str, str] = dict.fromkeys(OWN_FILES, "the batch itself")
    for source in sources:
        for suffix in suffixes:
            if suffix == LISTING and source.flight:
                continue
            output = source.name + suffix
            key = os.path.normcase(output)
            if key in taken:
                raise VopdError(
                    f"{source.path}: its output {output} would have the same name as that of "
                    f"{taken[key]}; rename the source"
                )
            taken[key] = source.path


# The hash of the input: of a deck, or of a project with the files that it names


def input_sha256(path: str) -> str:
    """Hash a deck, or a project with all files and folders that it names, by SHA-256.

    Args:
        path: the deck or the project

    Returns:
        The hash as hexadecimal digits; empty where the file cannot be read.
    """
    if no_file(path):
        return ""
    if not is_flight(path):
        return file_sha256(Path(path))
    try:
        content = Path(path).read_bytes()
    except OSError:
        return ""
    digest = hashlib.sha256(content)
    for name, file in named_files(content, Path(path).parent):
        digest.update(f"\0{name}\0".encode("utf-8", "surrogateescape"))
        digest.update(_named_sha256(file).encode())
    return digest.hexdigest()


def _named_sha256(path: Path) -> str:
    """Hash a file that a project names: of a video of more than 32 MB its size and both ends."""
    try:
        with path.open("rb") as file:
            is_video = kind_by_first_bytes(file.read(16)) == A_VIDEO
        if is_video and path.stat().st_size > 2 * ENDS:
            return hashlib.sha256(b"".join(size_and_ends(path))).hexdigest()
    except OSError:
        return ""
    return file_sha256(path)


def file_sha256(path: Path) -> str:
    """Hash a file by SHA-256, as hexadecimal digits; empty if it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


# Settings: how to solve the sources, and which files to write of each

LISTING, PAGE = ".lst", ".html"


@dataclass(frozen=True)
class BatchSettings:
    """How to solve the sources of a batch, and what to write.

    Args:
        folder: the output folder
        working: the folder of temporary files, in the same file system
        solve: how to solve decks
        history: options of the attitude histories
        formats: of the attitude tables, names of `vopd.export.FORMATS`
        report: which sources have a page: "" none, "flagged" those with a flag or a failure, "all"
    """

    folder: str
    working: str
    solve: SolveOptions
    history: HistoryOptions
    formats: tuple[str, ...] = ("csv",)
    report: str = ""

    @cached_property
    def options(self) -> str:
        """State all that the outputs depend on besides input and version, as JSON."""
        stated = Sigmas()
        sigmas = {
            name: one
            for name, one in vars(self.history.sigmas).items()
            if one != getattr(stated, name)
        }
        given = {
            "fix": str(self.solve.fixes),
            **{name: one for name, one in vars(self.solve).items() if name != "fixes"},
            **vars(self.history),
            "sigmas": sigmas,
            "formats": list(self.formats),
            "report": self.report,
        }
        usual: tuple[object, ...] = ("deck", False, None, {}, "")
        return json.dumps({name: one for name, one in given.items() if one not in usual})

    @property
    def suffixes(self) -> tuple[str, ...]:
        """List the suffixes of all files that a source may have, with the dot."""
        page = (PAGE,) if self.report else ()
        return (LISTING, *(table_suffix(one) for one in self.formats), *page)


def table_suffix(form: str) -> str:
    """Name the suffix of the attitude table in a format, with the dot."""
    return "." + FORMATS[form].suffixes[0].removeprefix(".")
