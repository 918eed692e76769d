"""The options that correct the original's slips, shared by the commands that solve decks."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import click

from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.geometry.ellipsoid import ELLIPSOIDS


def fix_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add --fix and --ellipsoid; the command is given one argument, `fixes`."""

    @click.option(
        "--fix", metavar="NAME", multiple=True, help="Correct a slip, or all; repeatable."
    )
    @click.option(
        "--ellipsoid", type=click.Choice(list(ELLIPSOIDS)), help="The Earth under --fix earth."
    )
    @wraps(function)
    def with_fixes(*, fix: tuple[str, ...], ellipsoid: str | None, **others: Any) -> Any:
        if ellipsoid and not {"earth", "all"} & set(fix):
            raise click.UsageError("--ellipsoid goes with --fix earth or --fix all.")
        try:
            chosen = fixes(*fix, ellipsoid=ellipsoid or "wgs84")
        except VopdError as error:
            raise click.UsageError(f"--fix: {error}.") from error
        return function(**others, fixes=chosen)

    return with_fixes
