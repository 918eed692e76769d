"""`vopd demo`: a deck of a synthetic flight, with its true attitude."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from vopd.cli.options import FILE_NAME, NUMBER, WHOLE, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.files import whole_file
from vopd.synthetic import EARTHS, LIMITS, Plan, PlanError


def _option(flag: str, part: str, about: str, metavar: str = "N") -> Callable[..., Any]:
    """Make an option for a parameter of a `Plan`; its help ends with default and limits."""
    default = getattr(Plan, part)
    first, nargs = (default[0], len(default)) if isinstance(default, tuple) else (default, 1)
    low, high = LIMITS[part]
    shown = f"{default:g}" if nargs == 1 else " ".join(map(str, default))
    within = "" if part == "seed" else f"; {low:,.9g} to {high:,.9g}"
    return click.option(
        flag,
        part,
        type=WHOLE if isinstance(first, int) else NUMBER,
        nargs=nargs,
        default=default,
        metavar=metavar,
        help=f"{about}  [default: {shown}{within}]",
    )


@click.command("demo")
@_option("--frames", "frames", "Frames of film; beyond 9999 the film is read again.")
@_option("--landmarks", "landmarks", "Landmarks read in each frame.")
@_option("--seed", "seed", "Seed of the random numbers; the same options make the same deck.")
@_option("--noise", "noise_in", "Standard deviation of a reading on the film reader.", "IN")
@_option("--jobs", "jobs", "Jobs that are stacked, all of this flight.")
@_option("--trajectory-rows", "trajectory_rows", "Rows of the trajectory table.")
@_option(
    "--swing", "swing_deg", "How far yaw swings to either side; pitch and roll swing less.", "DEG"
)
@_option("--focal", "focal_length_mm", "Focal length.", "MM")
@_option("--frame-size", "frame_in", "Size of a frame of the film on the reader.", "X Y")
@click.option(
    "--earth",
    type=click.Choice(EARTHS),
    default=Plan.earth,
    show_default=True,
    help="Earth on which the film was taken: that of the program, or for --fix all.",
)
@output_option("Write the deck to this file.")
@click.option(
    "--truth",
    type=FILE_NAME,
    metavar="FILE",
    help="Also write the true attitude of every frame, CSV.",
)
@click.pass_context
def command(ctx: click.Context, /, output: str, truth: str | None, **given: Any) -> None:
    """Make a deck of a synthetic flight whose attitude is known.

    The vehicle swings and cones under its parachute, from 150,000 down to
    75,000 ft over New Mexico; its 16-mm camera takes 32 frames per second. The
    deck goes to standard output, or to the file of -o.

    --truth writes a CSV table with a row for each frame: frame, time_s, yaw, pitch
    and roll of camera and vehicle in degrees, and the position east, north, up in
    feet. The Earth, the lens and the camera are those of the 1974 program. A run
    therefore finds the truth, except for the noise of the readings; with --noise 0
    readings are only rounded to the reader's last digit (.001 in). With --earth
    wgs84 a run with --fix all finds the truth, and a run without shows what the
    errata cost.

    --jobs stacks several jobs of the same flight: job 2 ignores landmark 1 in all
    frames, job 3 does not, job 4 has another first estimate, job 5 has the film
    read again, and so on in turn.

    \b
    Examples:
      vopd demo --frames 200 --seed 7 -o flight.dat --truth flight.csv
      vopd run flight.dat -o flight.lst
      vopd demo --noise 0 --landmarks 2 | vopd run -
      vopd demo --earth wgs84 | vopd run --fix all -

    Exit status: 0 all well; 1 the deck cannot be made or written; 2 wrong usage.
    """
    try:
        plan = Plan(**given)
    except PlanError as error:
        option = next(param for param in ctx.command.params if param.name == error.part)
        raise click.BadParameter(error.problem, ctx, option) from None
    refuse_to_overwrite((), output, truth)
    _write(plan, output, truth)


def _write(plan: Plan, output: str, truth: str | None) -> None:
    """Make the flight and write its deck and its truth."""
    from vopd.cards.write import write_deck
    from vopd.synthetic.flight import make, truth_csv

    jobs, true = make(plan)
    deck = write_deck(jobs)
    with whole_file(output) as file:
        file.write(deck.encode("ascii"))
    if truth is not None:
        with whole_file(truth) as file:
            file.write(truth_csv(true).encode("ascii"))
