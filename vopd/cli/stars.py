"""`vopd stars`: the orientation of a camera whose position is known (Rae 1987)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from vopd.cli.file_options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite, whole_file
from vopd.findings import Finding, VopdError

METHODS = ["collinearity", "church", "church-weighted", "two-star", "single-rotation", "all"]
FORMATS = click.Choice(["text", "json", "csv"])


Callback = Callable[[click.Context, click.Parameter, Any], Any]


def _numbers(count: int) -> Callback:
    """Reads `count` numbers with commas between, or none."""

    def convert(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
        from vopd.stellar.sexagesimal import parse_number

        if value is None or isinstance(value, tuple):
            return tuple(convert(ctx, param, one) for one in value) if value else value
        try:
            numbers = tuple(parse_number(part) for part in value.split(","))
        except ValueError as error:
            raise click.BadParameter(f"{value!r}: {error}.") from None
        if len(numbers) != count or max(map(abs, numbers)) > 1e12:
            raise click.BadParameter(f"{value!r} is not {param.metavar}, numbers up to 1e12.")
        return numbers

    return convert


def _positive(ctx: click.Context, param: click.Parameter, value: Any) -> float | None:
    numbers = _numbers(1)(ctx, param, value)
    if numbers and numbers[0] <= 0.0:
        raise click.BadParameter("must be more than 0.")
    return numbers and float(numbers[0])


def _pair(ctx: click.Context, param: click.Parameter, value: Any) -> tuple[int, int] | None:
    numbers = _numbers(2)(ctx, param, value)
    if numbers is None:
        return None
    one, other = map(int, numbers)
    if (one, other) != numbers or min(numbers) < 1:
        raise click.BadParameter(f"{value!r} is not two stars, counted from 1.")
    if one == other:
        raise click.BadParameter("names the same star twice.")
    return one, other


def _warn(finding: Finding) -> None:
    click.echo(f"warning: {finding}", err=True)


@click.group("stars")
def command() -> None:
    """Orientation of a camera whose position is known, by stars or ground points.

    Methods and tables of S. M. Rae, Alternative Methods of Determining the
    Orientation of a Stellar Camera (1987). Angles are degrees, image coordinates
    mm from the principal point of a positive.

    \b
    Example:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
    """


@command.command("solve", short_help="Solve the attitude of one photograph.")
@click.argument("file", type=FILE_NAME, metavar="FILE")
@click.option(
    "--focal",
    metavar="MM",
    required=True,
    callback=_positive,
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
    callback=_pair,
    help="Solve these two stars only, counted from 1.",
)
@click.option("--all-pairs", is_flag=True, help="Solve every pair, and see who disagrees.")
@click.option(
    "--initial",
    metavar="O,P,K",
    callback=_numbers(3),
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
    callback=_positive,
    help="Error of a reading: scales robust weights, bounds those of church-weighted.",
)
@click.option(
    "--camera", metavar="X,Y,Z", callback=_numbers(3), help="Camera position, for ground points."
)
@click.option("--format", "form", type=FORMATS, default="text", show_default=True)
@output_option("The output's file, written whole.")
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
    try:
        refuse_to_overwrite((file,), output)
        text, failures = _solve(file, form, given)
        with whole_file(output) as page:
            page.write(text.encode())
    except VopdError as error:
        click.echo(str(error), err=True)
        ctx.exit(1)
    ctx.exit(failures)


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
    from vopd.stellar.command import Request, solve_text
    from vopd.stellar.solve import Options

    options = Options(
        initial_deg=given["initial"],
        weights=given["weights"],
        corrections=given["corrections"],
        reading_sigma_mm=given["reading_sigma"],
        unit_cross_products=given["cross_products"] == "unit",
    )
    request = Request(
        given["focal"], given["method"], given["pair"], given["all_pairs"], given["camera"], options
    )
    outcome = solve_text(file, form, request)
    for finding in outcome.findings:
        prefix = "warning: " if finding.severity == "warning" else ""
        click.echo(f"{prefix}{finding}", err=True)
    return outcome.text, outcome.status


@command.command("radec", short_help="Make fictitious stars of given images (RADEC2).")
@click.argument("file", type=FILE_NAME, metavar="[FILE]", required=False)
@click.option("--focal", metavar="MM", callback=_positive, help="Principal distance.")
@click.option(
    "--attitude", metavar="O,P,K", callback=_numbers(3), help="omega, phi, kappa of the camera."
)
@click.option(
    "--image", "images", metavar="X,Y", multiple=True, callback=_numbers(2), help="An image, mm."
)
@click.option("--typed", is_flag=True, help="FILE is what was typed to RADEC2: a number a line.")
@click.option(
    "--format",
    "form",
    type=FORMATS,
    default="text",
    show_default=True,
    help="text: RADEC2's printout; csv: a FILE for `vopd stars solve`.",
)
@output_option("The output's file, written whole.")
@click.pass_context
def radec(
    ctx: click.Context,
    file: str | None,
    focal: float | None,
    attitude: tuple[float, ...] | None,
    images: tuple[tuple[float, ...], ...],
    typed: bool,
    form: str,
    output: str,
) -> None:
    """Make fictitious stars: where a star must stand to be imaged at x, y (RADEC2).

    The images are those of FILE (CSV with columns x_mm,y_mm; - is standard
    input) or of --image, as often as there are images. With --typed, FILE holds
    the answers to RADEC2's prompts, a number a line in format F15.6: focal
    length, omega, phi, kappa, then x and y of each image, and 9999.9. There a
    number without a point counts millionths.

    Right ascensions come out in -180 to 180, as the original's.

    \b
    Examples:
      vopd stars radec decks/stars/table_6_1.csv --focal 76 --attitude 156.14,-18.75,46.01
      vopd stars radec --focal 76 --attitude 10,20,30 --image 24,24 --image -15,15 --format csv
      vopd stars radec decks/stars/radec2_typed.txt --typed

    Exit status: 0 all well; 1 bad input; 2 wrong usage.
    """
    if typed and (file is None or focal or attitude or images):
        raise click.UsageError("--typed takes all from FILE: no --focal, --attitude or --image.")
    if not typed and (focal is None or attitude is None):
        raise click.UsageError("--focal and --attitude are needed (or --typed).")
    if not typed and (file is None) == (not images):
        raise click.UsageError("Give the images by FILE or by --image.")
    from vopd.stellar.fictitious import radec_text

    try:
        if file is not None:
            refuse_to_overwrite((file,), output)
        text = radec_text(file, focal, attitude, images, form, _warn)
        with whole_file(output) as page:
            page.write(text.encode())
    except VopdError as error:
        click.echo(str(error), err=True)
        ctx.exit(1)


@command.command("tables", short_help="Print the report's tables and figures, recomputed.")
@output_option("The output's file, written whole.")
@click.pass_context
def tables(ctx: click.Context, output: str) -> None:
    """Print the report's tables 6.1 to 6.5 and the values of figures 6.1 to 6.3.

    Each is computed from the sample data, with what the report printed beneath
    it where that is legible; * and + mark where the two differ, and the notes
    under a table say why. The figures and table 6.5 are lost in the scan: what
    stands here is recomputed, for all six pairs of stars.
    """
    from vopd.stellar.table_text import as_text
    from vopd.stellar.tables import tables as compute

    try:
        with whole_file(output) as page:
            page.write("\n".join(as_text(table) for table in compute()).encode())
    except VopdError as error:
        click.echo(str(error), err=True)
        ctx.exit(1)
