"""`vopd stars solve`: the attitudes of photographs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from vopd.cli.file_options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.stars.formats import SOLUTION_FORMATS, format_of, render
from vopd.cli.stars.image_options import image_axes, image_options
from vopd.cli.stars.options import method_options, refuse_idle_options
from vopd.cli.stars.sky_options import sky_options, sky_request
from vopd.files import whole_file

if TYPE_CHECKING:
    from vopd.findings import Finding, Report
    from vopd.stellar.files.solve import SolvedFiles
    from vopd.stellar.files.star_request import StarRequest


@click.command("solve", short_help="Solve the attitudes of photographs.")
@click.argument("files", type=FILE_NAME, metavar="FILE...", nargs=-1, required=True)
@image_options
@sky_options
@method_options
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
    ra_hours,dec_deg; u,v,w; x_m,y_m,z_m (with --camera); or only name, for stars
    of the Hipparcos catalogue. It may have the columns name, image and utc (which
    photograph, and when), sigma, mag. Angles may be sexagesimal (-4 25 49.68,
    5h12m3s). Lines that begin with # are comments, - is standard input. FILE may
    also be corr.fits of astrometry.net, or what tetra3 or cedar-solve return, as
    JSON.

    Pixels need their scale (--focal with --pitch-um, or --focal-px) and the
    principal point (--centre, or --size whose middle it is). All results are then
    in pixels.

    omega, phi, kappa turn the camera's axes about x, y, z in this order; alpha,
    delta are where the optical axis points. Without --pair, two-star and
    single-rotation solve stars 1 and 2, as their programs do.

    The residuals are compared with --reading-sigma or with the interstar angles.
    Where they are implausible common mistakes are tried, also two at once: right
    ascension in hours, exchanged or mirrored coordinates, a wrong principal
    distance or point, a lens with distortion, misidentified stars. What explains
    them is named.

    \b
    Examples:
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --method all
      vopd stars solve decks/stars/table_6_3.csv --focal 76 --all-pairs --method two-star
      vopd stars solve decks/stars/ground_points.csv --focal 152.4 --camera 1000,2000,3000
      vopd stars solve decks/stars/orion.csv --focal 76 --date 2020-01-15T21:00Z --place 48,11,500

    Exit status: 0 all well, warnings or not; 1 bad input, or a method could not
    solve it (the others are printed); 2 wrong usage; 3 no convergence, or
    implausible residuals.
    """
    form = format_of(output, given.pop("form"))
    refuse_idle_options(ctx, given, form)
    refuse_to_overwrite(files, output)
    request = _request(given)
    solved = _solve(files, request, quiet=given["quiet"])
    report = _printed(given["quiet"])
    content = render(form, solved.photographs, request, report)
    with whole_file(output) as page:
        page.write(content)
    ctx.exit(solved.status)


def _request(given: dict[str, Any]) -> StarRequest:
    """What the options ask for."""
    from vopd.stellar.files.reading_errors import ErrorModel
    from vopd.stellar.files.star_request import StarRequest
    from vopd.stellar.methods.run import StarOptions

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
        free=given["free"],
        sky=sky_request(given),
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
    from vopd.stellar.files.images import MissingOption
    from vopd.stellar.files.solve import solve_photographs

    try:
        solved = solve_photographs(files, request)
    except MissingOption as error:
        raise click.UsageError(f"{error}.") from error
    report = _printed(quiet)
    for finding in solved.findings:
        report(finding)
    return solved


def _printed(quiet: bool) -> Report:
    """A report that prints errors, and warnings unless it shall be quiet, on standard error."""

    def report(finding: Finding) -> None:
        if finding.severity == "error":
            click.echo(str(finding), err=True)
        elif not quiet:
            click.echo(f"warning: {finding}", err=True)

    return report
