"""The files that a project names, by its content alone: it need not be one that is read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vopd.inputs import parse_toml


def named_files(project: bytes, folder: Path) -> Iterator[tuple[str, Path]]:
    """List the files that texts of a project name, and those of the folders that they name.

    After them come those that its table of lenses names, `[camera] of_images`.

    Args:
        project: the content of the project file
        folder: the project's
    """
    try:
        keys = parse_toml(project)
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
    camera = keys.get("camera")
    table = camera.get("of_images") if isinstance(camera, dict) else None
    if isinstance(table, str):
        from vopd.flight.formats.image_lenses import lens_files  # of few projects

        beside = Path(table).parent
        yield from (((beside / name).as_posix(), one) for name, one in lens_files(folder / table))


def _texts(value: Any) -> Iterator[str]:
    """List all texts among the values of a project."""
    if isinstance(value, str) and value:
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _texts(one)
