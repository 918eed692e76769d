"""`vopd` and `python -m vopd`: the command line as a process."""

from __future__ import annotations

from vopd.cli import cli

if __name__ == "__main__":
    cli()
