"""`vopd stars`: the orientation of a camera whose position is known (Rae 1987)."""

from __future__ import annotations

import click

from vopd.cli.options import GroupOfCommands
from vopd.cli.stars.radec import radec
from vopd.cli.stars.solve import solve
from vopd.cli.stars.tables import tables


@click.group("stars", cls=GroupOfCommands)
def command() -> None:
    """Solve the orientation of a camera at a known position from stars or ground points.

    The methods and tables are those of S. M. Rae, Alternative Methods of Determining
    the Orientation of a Stellar Camera (1987). Angles are in degrees; image
    coordinates are mm from the principal point of a positive.

    \b
    Example:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
    """


for _subcommand in (solve, radec, tables):
    command.add_command(_subcommand)
