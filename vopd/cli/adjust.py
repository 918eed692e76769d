"""`vopd adjust`: solve for what all frames know together: lens, clock, landmarks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from vopd.cards.deck import refuse_other_file
from vopd.cards.read import open_deck
from vopd.cli.adjust_deck import adjusted_deck, searched_deck
from vopd.cli.console import Messages, Progress, notes
from vopd.cli.new import refuse_existing, write_project
from vopd.cli.options import (
    FILE_NAME,
    FOLDER_OR_FILE,
    NUMBER,
    SOURCE_NAME,
    WholeRange,
    fix_options,
    quiet_option,
    stated_sigma,
)
from vopd.cli.output import refuse_to_overwrite
from vopd.errata import Fixes
from vopd.files import whole_file
from vopd.findings import count_text
from vopd.pipeline import is_flight

if TYPE_CHECKING:
    from vopd.flight.adjust.adjustment import Adjustment
    from vopd.flight.project.keys import Project


@click.command("adjust")
@click.argument("source", type=SOURCE_NAME, metavar="SOURCE")
@click.option(
    "--free",
    metavar="NAME[,NAME...]",
    multiple=True,
    help="What to solve for, by the names above; repeatable.  [default: [solve] free of the "
    "project]",
)
@click.option("--correlations", is_flag=True, help="Also print the correlations of the parameters.")
@click.option(
    "--test",
    is_flag=True,
    help="Leave out each landmark, frame, fix and pick in turn: name those that do not fit, and "
    "show how well picks are predicted with and without the freed parameters.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "csv", "json"]),
    default="text",
    show_default=True,
    help="Format of the table; with --test the CSV has the tests.",
)
@click.option(
    "-o",
    "--output",
    type=FOLDER_OR_FILE,
    metavar="DIR|DECK",
    help="From a flight: write a project with the solved values and their covariance. From a "
    "deck: write the deck with the landmark in group 9; with --trials the stacked deck.",
)
@click.option(
    "--figure",
    type=FILE_NAME,
    metavar="FILE",
    help="Draw parameters and residuals before and after: .png, .svg or .pdf.",
)
@click.option(
    "--trials",
    is_flag=True,
    help="In a deck: locate the landmark by the report's stacked jobs of trial coordinates.",
)
@click.option(
    "--landmark-sigma",
    type=NUMBER,
    metavar="FT",
    callback=stated_sigma,
    help="In a deck: standard deviation of the landmark's coordinates in group 9, along each "
    "axis.  [default: none]",
)
@click.option("--job", type=WholeRange(min=1), metavar="N", help="Which job of a deck.")
@fix_options
@quiet_option
@click.pass_context
def command(
    ctx: click.Context,
    source: str,
    free: tuple[str, ...],
    correlations: bool,
    test: bool,
    form: str,
    output: str | None,
    figure: str | None,
    trials: bool,
    landmark_sigma: float | None,
    job: int | None,
    fixes: Fixes,
    quiet: bool,
) -> None:
    """Solve for lens, clock and landmarks with all frames of a flight together.

    SOURCE is a flight project, whose name ends in .toml, or a deck. One frame determines its
    three angles; all frames together also determine the focal length or the clock. The table
    shows each parameter before and after, with standard deviations, and whether the picks
    hold it. A parameter that they do not hold keeps its stated value; the table names the
    parameters that it trades with. [solve] free = ["focal", "k1"] in a project makes vopd
    attitude, plot and report do the same.

    \b
    Names:
        focal aspect centre k1 k2 p1p2     the lens
        clock clock-rate track-offset      the track: s, parts per million, m
        readout                            the rolling shutter, ms
        mount                              the camera in the vehicle, degrees; needs
                                           [vehicle] attitude
        landmarks landmark:NAME            listed in the table; landmarks with a
                                           sigma_m are solved for in any case

    In a deck, --free landmark:NUMBER locates one landmark of group 9: by least squares of
    all readings or, with --trials, by the report's stacked jobs of trial latitudes,
    longitudes and altitudes. Everything else on the cards counts as exact. If the deck has
    several jobs, --job chooses one, and -o writes a deck of that job alone.

    A standard deviation in the project, such as [uncertainty] focal_rel, constrains its
    parameter. Without one, only the picks determine it. vopd help adjust explains which
    parameters to free in which case.

    -o DIR writes a project with the solved lens, landmarks and offsets, and their covariance
    in covariance.json. vopd attitude, plot and report keep these values fixed and propagate
    the covariance, so that the same picks do not count twice.

    \b
    Examples:
        vopd adjust flight.toml --free focal
        vopd adjust flight.toml --free focal,k1,clock --correlations
        vopd adjust flight.toml --free landmark:tower --format csv
        vopd adjust flight.toml --test                   free nothing, only test
        vopd adjust flight.toml --free focal -o adjusted
        vopd adjust flight.toml --free focal --figure adjusted.png
        vopd attitude adjusted/flight.toml
        vopd adjust film.dat --free landmark:66 --fix all -o located.dat
        vopd adjust film.dat --free landmark:66 --trials -o stack.dat

    Exit status: 0 the table is printed (also if a parameter is not held); 1 the
    source could not be read or solved, or the output not written; 2 wrong usage; 3
    the table is printed, but some frame did not converge, the flight misfits, or
    the trials do not settle.
    """
    from vopd.flight.adjust.table import as_csv, as_json, as_text
    from vopd.flight.solve.free import names_of

    suffix = "" if figure is None else figure_suffix(figure)
    names = names_of(",".join(free))
    if free and not names:
        raise click.UsageError("--free: name what is to be solved for, as --free focal,k1.")
    deck = not is_flight(source)
    if deck and source != "-" and not Path(source).is_fifo():
        with open_deck(source) as file:  # what is no deck, as a video, before options of decks
            refuse_other_file(file.read(4096), source)
    given: dict[str, object] = {"--job": job is not None, "--fix": fixes, "--test": test}
    given |= {"--trials": trials, "--landmark-sigma": landmark_sigma is not None}
    given |= {"--figure": figure is not None, "--correlations": correlations}
    _check_options(deck, given)
    if correlations and test and form == "csv":
        raise click.UsageError("--correlations: the CSV of --test has none; JSON has both.")
    if output == "-" and not deck:
        raise click.UsageError("-o -: a project is a folder of files: name one.")
    refuse_to_overwrite((source,), "-", output if deck else None, figure)  # - has the table
    if trials:
        ctx.exit(searched_deck(source, job, names, fixes, output, form, quiet))
    if deck:
        if not names and not test:
            raise click.UsageError("name the landmark to be located: --free landmark:NUMBER.")
        made = adjusted_deck(source, job, names, fixes, landmark_sigma, output, quiet)
    else:
        if output is not None:
            from vopd.flight.adjust.project import COVARIANCE
            from vopd.flight.project.new import NAME

            refuse_existing(Path(output), [NAME, COVARIANCE])
        made, project = _adjusted(source, ",".join(free) if names else "", test)
        if output is not None:
            from vopd.flight.adjust.project import adjusted_project

            written = adjusted_project(project, made, Path(output))
            write_project(Path(output), written, to_errors=True, quiet=quiet)
    messages = Messages(quiet)
    for finding in made.result.findings:
        messages(finding)
    messages.close()
    tests = _tests_of(made, form) if test else None
    if figure is not None:
        _draw(made, figure, suffix, quiet)
    if form == "csv" and tests is not None:
        click.echo(tests, nl=False)
    elif form == "json":
        click.echo(as_json(made, correlations, tests), nl=False)
    else:
        click.echo({"text": as_text, "csv": as_csv}[form](made, correlations), nl=False)
        click.echo(f"\n{tests}" if tests is not None else "", nl=False)
    converged = made.result.estimates.solved.attitudes.converged | ~made.result.solved
    ctx.exit(0 if converged.all() and not made.result.misfits else 3)


FOR_DECKS = {
    "--trials": "trials are a search of decks; --free solves for all that is free at once",
    "--landmark-sigma": "state sigma_m in [landmarks] or in the landmark's row",
    "--job": "leave it out",
    "--fix": "leave it out",
}
NOT_FOR_TRIALS = {
    "--landmark-sigma": ", which weigh no prior",
    "--test": ": test the deck by itself",
    "--figure": ", which have a table alone",
    "--correlations": ", which have a table alone",
}


def _check_options(deck: bool, given: dict[str, object]) -> None:
    """Refuse options that a flight does not have, and those that do not go together."""
    for name, why in FOR_DECKS.items():
        if given[name] and not deck:
            raise click.UsageError(f"{name} is for decks: {why}.")
    for name, why in NOT_FOR_TRIALS.items():
        if given[name] and given["--trials"]:
            raise click.UsageError(f"{name} is not for --trials{why}.")


def _adjusted(source: str, free: str, test: bool) -> tuple[Adjustment, Project]:
    """Read and solve a flight, with a line of progress on a terminal."""
    from vopd.flight.adjust.adjustment import adjust, flight_to_adjust

    flight, project = flight_to_adjust(source)
    names = free or flight.options.free
    if not names and not test:
        raise click.UsageError(
            "name what is to be solved for: --free focal,k1, or [solve] free in the project."
        )
    progress = Progress(f"solves of {count_text(len(flight.frame), 'frame')}")
    try:
        return adjust(flight, names, lambda: progress.add(1)), project
    finally:
        progress.close()


def figure_suffix(figure: str) -> str:
    """Check what kind of figure it is, before anything is solved.

    Raises:
        click.UsageError: if its name is that of no figure
        VopdError: if matplotlib is not installed
    """
    from vopd.figures.style import SUFFIXES, ready

    suffix = Path(figure).suffix.lower()
    if suffix not in SUFFIXES:
        raise click.UsageError(f"--figure {figure}: name the file .png, .svg or .pdf.")
    ready()
    return suffix


def _draw(made: Adjustment, figure: str, suffix: str, quiet: bool) -> None:
    """Draw parameters and residuals before and after."""
    from vopd.figures.adjust import draw_adjusted
    from vopd.figures.style import save
    from vopd.flight.parameters import before_and_after

    drawn = draw_adjusted(made.result.flight.source, *before_and_after(made.result.estimates))
    content = save(drawn, suffix, note=notes(quiet))
    with whole_file(figure) as file:
        file.write(content)


def _tests_of(made: Adjustment, form: str) -> Any:
    """Test a flight by leaving out, and the same with nothing free."""
    from dataclasses import replace

    from vopd.flight.adjust import tested_table
    from vopd.flight.adjust.tested import predicted, tested_flight
    from vopd.flight.result import solve_flight_read
    from vopd.flight.solve.free import FREE

    result = made.result
    flight, prediction = result.read, None
    tested = tested_flight(result)
    free = [one.name for one in made.parameters if one.held and one.after != one.before]
    if free:
        options = replace(flight.options, free=(), kept=())
        stated = solve_flight_read(replace(flight, options=options), doubted=False)
        prediction = predicted(tested_flight(stated), tested)
    if form == "json":
        return tested_table.as_dict(tested, prediction)
    if form == "csv":
        return tested_table.as_csv(tested)
    kept = {one.name for one in flight.options.kept}
    names = [n for n in flight.options.free if n not in FREE or not kept >= {*FREE[n]}]
    return tested_table.as_text(tested, prediction, names)
