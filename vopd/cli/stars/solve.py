"""`vopd stars solve`: the attitude of one photograph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from vopd.cli.file_options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.stars.formats import SOLUTION_FORMATS, format_of, render
from vopd.cli.stars.image_options import image_axes, image_options
from vopd.cli.stars.number_options import initial_angles, numbers, positive, star_pair
from vopd.whole_file import whole_file

if TYPE_CHECKING:
    from vopd.stellar.files.photograph import StarRequest
    from vopd.stellar.files.solve_star_file import SolvedFiles

METHODS = (
    "collinearity",
    "svd",
    "church",
    "church-weighted",
    "church-weighted-r",
    "two-star",
    "single-rotation",
    "all",
)

ONLY_FOR = {
    "initial": ("collinearity",),
    "weights": ("collinearity",),
    "corrections": ("collinearity",),
    "listing": ("collinearity",),
    "cross_products": ("two-star",),
    "rotation_angle": ("single-rotation",),
}
"""Options that do nothing with other methods than these."""


@click.command("solve", short_help="Solve the attitude of one photograph.")
@click.argument("files", type=FILE_NAME, metavar="FILE...", nargs=-1, required=True)
@image_options
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
@click.option("--all-pairs", is_flag=True, help="Solve every pair, and compare the stars.")
@click.option("--reject", is_flag=True, help="Leave out stars that do not fit the others.")
@click.option(
    "--edit-by-pairs",
    is_flag=True,
    help="The same, beginning with the attitudes of all pairs (recommendation 4 of the report).",
)
@click.option(
    "--magnitude-limit",
    metavar="MAG",
    callback=numbers(1),
    help="Weigh stars by column mag: at this magnitude the noise of a star's light is as large "
    "as all other reading errors.",
)
@click.option(
    "--weigh-elongation",
    is_flag=True,
    help="Weigh stars by column elongation, the length of an image over its width.",
)
@click.option(
    "--rotation",
    type=click.Choice(["nearest", "as-solved"]),
    default="nearest",
    show_default=True,
    help="Attitude of a matrix that is not quite a rotation: the nearest rotation, or the "
    "elements as solved, as the report's programs print them.",
)
@click.option(
    "--initial",
    metavar="svd|two-star|O,P,K",
    default="svd",
    show_default=True,
    callback=initial_angles,
    help="Where collinearity starts: from --method svd, from the widest pair as in the report, "
    "or from these omega, phi, kappa.",
)
@click.option(
    "--weights",
    type=click.Choice(["uniform", "listed", "robust"]),
    default="uniform",
    show_default=True,
    help="Weights of collinearity: listed follows RESWTS to the letter, robust is Huber's.",
)
@click.option(
    "--corrections",
    type=click.IntRange(1, 1000),
    metavar="N",
    help="Make exactly this many corrections of collinearity (STARS makes 4). "
    "Default: to convergence.",
)
@click.option(
    "--listing",
    is_flag=True,
    help="Print what program STARS prints: angles and residuals before each correction.",
)
@click.option(
    "--cross-products",
    type=click.Choice(["unit", "raw"]),
    default="unit",
    show_default=True,
    help="The fictitious star of two-star: as in eqs. 3.21, 3.22, or as listed.",
)
@click.option(
    "--rotation-angle",
    type=click.Choice(["farther", "mean"]),
    default="farther",
    show_default=True,
    help="The angle of single-rotation: of the star farther from the axis, or the mean of both.",
)
@click.option(
    "--reading-sigma",
    metavar="SIGMA",
    callback=positive,
    help="Standard deviation of an image coordinate, in the file's unit: for the stated "
    "uncertainty, the test of the residuals, robust weights and church-weighted. Default: from "
    "the interstar angles.",
)
@click.option(
    "--camera", metavar="X,Y,Z", callback=numbers(3), help="Camera position, for ground points."
)
@click.option(
    "--resection",
    is_flag=True,
    help="Solve the camera's position too, from four ground points or more.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(SOLUTION_FORMATS),
    help="By default what the suffix of -o says; text on standard output.",
)
@output_option("Write the output to this file.")
@click.option("-q", "--quiet", is_flag=True, help="No warnings.")
@click.pass_context
def solve(ctx: click.Context, /, files: tuple[str, ...], output: str, **given: Any) -> None:
    """Solve the attitude of one photograph, or of several.

    FILE is CSV with a header: x_mm,y_mm or x_px,y_px, and one of ra_deg,dec_deg;
    ra_hours,dec_deg; u,v,w; x_m,y_m,z_m (with --camera). It may have the columns
    name, mag, and image, which tells several photographs apart. Angles may be
    sexagesimal (-4 25 49.68, 5h12m3s). Lines that begin with # are comments, - is
    standard input. FILE may also be corr.fits of astrometry.net, or what tetra3 or
    cedar-solve return, as JSON.

    Pixels need their scale (--focal with --pitch-um, or --focal-px) and the
    principal point (--centre, or --size whose middle it is). All results are then
    in pixels.

    omega, phi, kappa turn the camera's axes about x, y, z in this order; alpha,
    delta are where the optical axis points. Without --pair, two-star and
    single-rotation solve stars 1 and 2, as their programs do.

    The residuals are compared with --reading-sigma or with the interstar angles.
    Where they are implausible common mistakes are tried: right ascension in
    hours, exchanged or mirrored coordinates, a wrong principal distance, a
    misidentified star. The one that explains them is named.

    \b
    Examples:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --all-pairs --method two-star
      vopd stars solve decks/stars/ground_points.csv --focal 152.4 --camera 1000,2000,3000

    Exit status: 0 all well, warnings or not; 1 bad input, or a method could not
    solve it (the others are printed); 2 wrong usage; 3 no convergence, or
    implausible residuals.
    """
    form = format_of(output, given.pop("form"))
    _refuse_idle_options(ctx, given, form)
    refuse_to_overwrite(files, output)
    request = _request(given)
    solved = _solve(files, request, quiet=given["quiet"])
    content = render(form, solved.photographs, request)
    with whole_file(output) as page:
        page.write(content)
    ctx.exit(solved.status)


def _refuse_idle_options(ctx: click.Context, given: dict[str, Any], form: str) -> None:
    """Refuse options that exclude each other or would do nothing."""
    method, pairs = given["method"], given["pair"] or given["all_pairs"]
    if given["pair"] and given["all_pairs"]:
        raise click.UsageError("--pair and --all-pairs exclude each other.")
    if pairs and method.startswith("church"):
        raise click.UsageError(f"--method {method} takes three stars at least, not a pair.")
    if given["listing"] and (pairs or form != "text" or method == "all"):
        raise click.UsageError("--listing is for text output of collinearity with all stars.")
    if given["reject"] and given["edit_by_pairs"]:
        raise click.UsageError("--reject and --edit-by-pairs exclude each other.")
    for option in ("reject", "edit_by_pairs"):
        if pairs and given[option]:
            name = "--" + option.replace("_", "-")
            raise click.UsageError(f"{name} is for all stars at once, not for pairs.")
    if given["resection"]:
        _refuse_with_resection(ctx, given)
    for name, methods in ONLY_FOR.items():
        source = ctx.get_parameter_source(name)
        if source == click.core.ParameterSource.COMMANDLINE and method not in (*methods, "all"):
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"{option} is for {' and '.join(methods)}, not {method}.")


def _refuse_with_resection(ctx: click.Context, given: dict[str, Any]) -> None:
    """Refuse options that a resection has no use for."""
    for name in (*ONLY_FOR, "method", "pair", "all_pairs", "camera", "reject", "edit_by_pairs",
                 "rotation"):  # fmt: skip
        if ctx.get_parameter_source(name) == click.core.ParameterSource.COMMANDLINE:
            option = "--" + name.replace("_", "-")
            raise click.UsageError(f"--resection and {option} exclude each other.")


def _request(given: dict[str, Any]) -> StarRequest:
    """What the options ask for."""
    from vopd.stellar.files.photograph import StarRequest
    from vopd.stellar.files.reading_errors import ErrorModel
    from vopd.stellar.methods.run_methods import StarOptions

    return StarRequest(
        axes=image_axes(given),
        method=given["method"],
        pair=given["pair"],
        all_pairs=given["all_pairs"],
        reject=given["reject"],
        edit_by_pairs=given["edit_by_pairs"],
        errors=ErrorModel(
            given["magnitude_limit"] and given["magnitude_limit"][0], given["weigh_elongation"]
        ),
        listing=given["listing"],
        camera_m=given["camera"],
        resection=given["resection"],
        options=StarOptions(
            initial_deg=None if isinstance(given["initial"], str) else given["initial"],
            start="two-star" if given["initial"] == "two-star" else "svd",
            weights=given["weights"],
            corrections=given["corrections"],
            reading_sigma_mm=given["reading_sigma"],
            unit_cross_products=given["cross_products"] == "unit",
            rotation_angle=given["rotation_angle"],
            rotation=given["rotation"],
        ),
    )


def _solve(files: tuple[str, ...], request: StarRequest, *, quiet: bool) -> SolvedFiles:
    """The solved photographs; findings go to standard error."""
    from vopd.stellar.files.image_axes import MissingOption
    from vopd.stellar.files.solve_star_file import solve_photographs

    try:
        solved = solve_photographs(files, request)
    except MissingOption as error:
        raise click.UsageError(f"{error}.") from error
    for finding in solved.findings:
        if finding.severity == "error":
            click.echo(str(finding), err=True)
        elif not quiet:
            click.echo(f"warning: {finding}", err=True)
    return solved
