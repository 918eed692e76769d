"""The hash of what a source is solved from: a deck, or a project with the files that it names."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vopd.pipeline import is_flight


def input_sha256(path: str) -> str:
    """The SHA-256 of a deck, or of a project and all files and folders that it names.

    Args:
        path: the deck or the project

    Returns:
        The hash as hexadecimal digits; empty where the file cannot be read.
    """
    try:
        content = Path(path).read_bytes()
    except OSError:
        return ""
    digest = hashlib.sha256(content)
    if is_flight(path):
        for name, file in named_files(content, Path(path).parent):
            digest.update(f"\0{name}\0".encode("utf-8", "surrogateescape"))
            digest.update(file_sha256(file).encode())
    return digest.hexdigest()


def file_sha256(path: Path) -> str:
    """The SHA-256 of a file as hexadecimal digits; empty where it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def named_files(project: bytes, folder: Path) -> Iterator[tuple[str, Path]]:
    """Every file that a text of a project names, and every file of a folder that one names.

    Args:
        project: the content of the project file
        folder: the project's
    """
    try:
        keys = tomllib.loads(project.decode("utf-8-sig"))
    except (ValueError, RecursionError):  # solving it says what is wrong
        return
    for text in sorted(set(_texts(keys))):
        path = folder / text
        try:
            if path.is_dir():
                inside = sorted(one for one in path.iterdir() if one.is_file())
                yield from ((f"{text}/{one.name}", one) for one in inside)
            elif path.is_file():
                yield text, path
        except (OSError, ValueError):  # a text that cannot be a path
            continue


def _texts(value: Any) -> Iterator[str]:
    """All texts among the values of a project."""
    if isinstance(value, str) and value:
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _texts(one)
