"""`vopd stars solve`: the attitude of one photograph."""

from __future__ import annotations

from typing import Any

import click

from vopd.cli.output import refuse_to_overwrite, whole_file
from vopd.cli.stars.number_options import FORMATS, numbers, output_option, positive, star_pair

METHODS = ["collinearity", "church", "church-weighted", "two-star", "single-rotation", "all"]


@click.command("solve", short_help="Solve the attitude of one photograph.")
@click.argument("file", metavar="FILE")
@click.option(
    "--focal",
    metavar="MM",
    required=True,
    callback=positive,
    help="Principal distance.",
)
@click.option(
    "--method",
    type=click.Choice(METHODS),
    default="collinearity",
    show_default=True,
    help="How to solve; all: every method that can.",
)
@click.option(
    "--pair",
    metavar="I,J",
    callback=star_pair,
    help="Solve these two stars only, counted from 1.",
)
@click.option("--all-pairs", is_flag=True, help="Solve every pair, and see who disagrees.")
@click.option(
    "--initial",
    metavar="O,P,K",
    callback=numbers(3),
    help="Start of collinearity: omega, phi, kappa. Default: the widest pair's closed form.",
)
@click.option(
    "--weights",
    type=click.Choice(["uniform", "listed", "robust"]),
    default="uniform",
    show_default=True,
    help="Of collinearity: listed is RESWTS to the letter, robust is Huber's.",
)
@click.option(
    "--corrections",
    type=click.IntRange(1, 1000),
    metavar="N",
    help="Of collinearity: exactly so many, as listed (STARS makes 4). Default: to convergence.",
)
@click.option(
    "--cross-products",
    type=click.Choice(["unit", "raw"]),
    default="unit",
    show_default=True,
    help="Of two-star: the fictitious star as eqs. 3.21, 3.22 have it, or as listed.",
)
@click.option(
    "--reading-sigma",
    metavar="MM",
    callback=positive,
    help="Error of a reading: scales robust weights, bounds those of church-weighted.",
)
@click.option(
    "--camera", metavar="X,Y,Z", callback=numbers(3), help="Camera position, for ground points."
)
@click.option("--format", "form", type=FORMATS, default="text", show_default=True)
@output_option
@click.pass_context
def solve(ctx: click.Context, /, file: str, form: str, output: str, **given: Any) -> None:
    """Solve the attitude of one photograph.

    FILE is CSV with a header: x_mm,y_mm and one of ra_deg,dec_deg; u,v,w;
    x_m,y_m,z_m (with --camera); a column `name` if you like. Angles may be
    sexagesimal (-4 25 49.68, 5h12m3s). Lines that begin with # are comments,
    - is standard input.

    omega, phi, kappa turn the camera's axes about x, y, z in this order; alpha,
    delta are where the optical axis points. Without --pair, two-star and
    single-rotation solve stars 1 and 2, as their listings do.

    \b
    Examples:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --all-pairs --method two-star
      vopd stars solve decks/stars/ground_points.csv --focal 152.4 --camera 1000,2000,3000

    Exit status: 0 all well, warnings or not; 1 bad input, or a method could not
    solve it (the others are printed); 2 wrong usage; 3 no convergence.
    """
    _check_usage(ctx, given)
    refuse_to_overwrite((file,), output)
    text, status = _solve(file, form, given)
    with whole_file(output) as page:
        page.write(text.encode())
    ctx.exit(status)


def _check_usage(ctx: click.Context, given: dict[str, Any]) -> None:
    """Refuse options that would do nothing."""
    method = given["method"]
    if given["pair"] and given["all_pairs"]:
        raise click.UsageError("--pair and --all-pairs exclude each other.")
    if (given["pair"] or given["all_pairs"]) and method.startswith("church"):
        raise click.UsageError(f"--method {method} takes three stars at least, not a pair.")
    serves = {
        "initial": ("collinearity",),
        "weights": ("collinearity",),
        "corrections": ("collinearity",),
        "cross_products": ("two-star",),
        "reading_sigma": ("church-weighted", "collinearity"),
    }
    for name, methods in serves.items():
        source = ctx.get_parameter_source(name)
        if source == click.core.ParameterSource.COMMANDLINE and method not in (*methods, "all"):
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{option} is for {' and '.join(methods)}, not {method}.")
    scaled = given["weights"] == "robust" or method in ("church-weighted", "all")
    if given["reading_sigma"] is not None and not scaled:
        raise click.UsageError("--reading-sigma scales --weights robust; these are not.")


def _solve(file: str, form: str, given: dict[str, Any]) -> tuple[str, int]:
    """The output and the exit status; remarks go to standard error."""
    from vopd.stellar.files.solve_star_file import StarRequest, solve_text
    from vopd.stellar.methods.run_methods import StarOptions

    options = StarOptions(
        initial_deg=given["initial"],
        weights=given["weights"],
        corrections=given["corrections"],
        reading_sigma_mm=given["reading_sigma"],
        unit_cross_products=given["cross_products"] == "unit",
    )
    request = StarRequest(
        given["focal"], given["method"], given["pair"], given["all_pairs"], given["camera"], options
    )
    outcome = solve_text(file, form, request)
    for finding in outcome.findings:
        prefix = "warning: " if finding.severity == "warning" else ""
        click.echo(f"{prefix}{finding}", err=True)
    return outcome.text, outcome.status
