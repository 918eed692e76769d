"""The type of arguments and options that are names of files."""

from __future__ import annotations

import click

FILE_NAME = click.Path(readable=False)
"""A name of a file, or `-`. Shells complete it; whether it can be read is seen when it is read."""
