"""`vopd stars`: the orientation of a camera whose position is known (Rae 1987)."""

from __future__ import annotations

import click

from vopd.cli.options import GroupOfCommands
from vopd.cli.stars.radec import radec
from vopd.cli.stars.solve import solve
from vopd.cli.stars.tables import tables


@click.group("stars", cls=GroupOfCommands)
def command() -> None:
    """Orientation of a camera whose position is known, by stars or ground points.

    Methods and tables of S. M. Rae, Alternative Methods of Determining the
    Orientation of a Stellar Camera (1987). Angles are degrees, image coordinates
    mm from the principal point of a positive.

    \b
    Example:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
    """


for _subcommand in (solve, radec, tables):
    command.add_command(_subcommand)
