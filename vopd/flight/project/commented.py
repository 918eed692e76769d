"""Rows of picks that are taken for comments because the name at their beginning begins with #."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from vopd.findings import VopdError
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.tables import COMMENTS
from vopd.flight.project.keys import VIDEO, Project

OTHER_FILES = (("track", "file"), ("picks", "times"), ("landmarks", "file"), ("picks", "video"))
MOST_NAMES = 3  # that are looked for in other files


def doubts_of_comments(
    project: Project, commented: Mapping[str, str], known: Iterable[str]
) -> list[str]:
    """Doubt that lines of the picks are comments whose name another file has with its #.

    A row that a person has put a # before has a name that is known without it.

    Args:
        project: whose picks have been read
        commented: where comments are that may be rows, by the name that they begin with
        known: the names of images and landmarks that are known
    """
    there = {*known}
    found = {
        name: where for name, where in commented.items() if name.lstrip("#").strip() not in there
    }
    others = [*_other_files(project)] if found else []
    for name, where in [*found.items()][:MOST_NAMES]:
        for other in others:
            if _names(other, name) and not _names(other, name.lstrip("#")):
                message = f"{name} is in {other.name}, and {COMMENTS}"
                return [f"{where}: {message}, or a blank behind # where it is a comment"]
    return []


def _other_files(project: Project) -> Iterator[InputFile]:
    """Open the files and folders that may name images and landmarks."""
    for section, key in OTHER_FILES:
        values = project.section(section)
        if values.has(key) and values.values[key] != VIDEO:
            for name in values.files(key) if key == "video" else (values.text(key),):
                path = project.folder / name
                if path.exists():
                    yield InputFile(name, path)


def _names(file: InputFile, name: str) -> bool:
    """Tell whether a file has a name in it, or a folder a file of it."""
    try:
        if file.path.is_dir():
            return (file.path / name).exists()
        return file.line_of(name) is not None
    except (VopdError, OSError, ValueError):  # no text, or no name of a file
        return False
