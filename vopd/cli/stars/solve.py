"""`vopd stars solve`: the attitudes of photographs."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import click

from vopd.cli.options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.stars.options import (
    ALONE,
    image_axes,
    refuse_idle_options,
    sky_request,
    solve_options,
    stated,
)
from vopd.files import ESCAPED, whole_file
from vopd.findings import Finding, Report, VopdError

if TYPE_CHECKING:
    from vopd.stellar.files.photograph import SolvedPhotograph, StarRequest
    from vopd.stellar.sky import SkyRequest


# Formats

SOLUTION_FORMATS = ("text", "json", "csv", "jsonl", "npz", "parquet", "aem", "czml")
SUFFIXES = {
    ".json": "json", ".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl", ".npz": "npz",
    ".parquet": "parquet", ".pq": "parquet", ".aem": "aem", ".czml": "czml",
}  # fmt: skip
BINARY = ("npz", "parquet")
PICTURES = (".png", ".svg", ".pdf", ".jpg", ".jpeg", ".gif", ".tif", ".tiff")


def format_of(output: str, form: str | None) -> str:
    """Choose the format of the output: as stated, or by the suffix of its name.

    Raises:
        click.UsageError: it is binary, and would go to a terminal, or FILE is a picture.
    """
    suffix = PurePath(output).suffix.lower()
    if form is None and suffix in PICTURES:
        raise click.UsageError(
            f"{output}: write the solution to a .json, and vopd plot draws its residuals."
        )
    form = form or SUFFIXES.get(suffix, "text")
    if form in BINARY and output == "-" and sys.stdout.isatty():
        raise click.UsageError(f"{form} is binary: name a file with -o.")
    return form


def render(
    form: str, photographs: Sequence[SolvedPhotograph], request: StarRequest, report: Report
) -> bytes:
    """Render the content of the output.

    Raises:
        VopdError: where a package that the format needs is not installed.
    """
    from vopd.stellar.files import table, text

    if request.listing:
        return text.as_listed(photographs).encode("utf-8", ESCAPED)
    if form == "text":
        return text.as_text(
            photographs,
            robust=request.options.weights == "robust",
            size_px=request.axes.size_px,
        ).encode("utf-8", ESCAPED)
    if form in ("json", "csv"):
        whole = (table.as_json if form == "json" else table.as_csv)(photographs)
        return whole.encode("utf-8", ESCAPED)
    if form in ("aem", "czml"):
        return render_dated(form, photographs, request.sky, report)
    from vopd.export.tables import render_table

    values, columns = table.solution_table(photographs)
    return render_table(form, values, table.stated_conventions(photographs), columns)


# The command


@click.command("solve", short_help="Solve the attitudes of photographs.")
@click.argument("files", type=FILE_NAME, metavar="FILE...", nargs=-1, required=True)
@solve_options
@click.option(
    "--images",
    type=FILE_NAME,
    metavar="DIR|IMAGE",
    help="The photograph, or a folder of several. It gives its size and, from its tags, a first "
    "principal distance, which is then solved for (--free focal).",
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

    FILE is CSV with a header. Its columns are x_mm,y_mm or x_px,y_px, and one of
    ra_deg,dec_deg; ra_hours,dec_deg; u,v,w; or x_m,y_m,z_m (with --camera). With a
    column name alone, the stars are looked up in the Hipparcos catalogue; with none
    of these, they are identified by their pattern. Further columns may be name,
    image (which photograph), utc (when), sigma and mag. Angles may be sexagesimal
    (-4 25 49.68, 5h12m3s). Lines that begin with # are comments; - is standard
    input. FILE may also be corr.fits of astrometry.net, or the result of tetra3 or
    cedar-solve as JSON.

    Pixels need a scale (--focal with --pitch-um, or --focal-px) and the principal
    point (--centre, or the middle of --size); --images takes both from the
    photograph. All results are then in pixels.

    omega, phi, kappa turn the camera's axes about x, y, z in this order. alpha,
    delta are the direction of the optical axis; --point gives the direction of
    another point. Without --pair, two-star and single-rotation solve stars 1 and 2,
    as their programs do.

    The residuals are tested against --reading-sigma or the interstar angles. If they
    are implausible, the command tries common mistakes, also two at once, and names
    those that explain the residuals: right ascension in hours, exchanged or mirrored
    coordinates, a wrong principal distance or point, a lens with distortion,
    misidentified stars.

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
    read = (given[name] for name in ("images", "ephemeris", "catalogue"))
    refuse_to_overwrite((*files, *filter(None, read)), output)
    from vopd.stellar.files.images import MissingOption
    from vopd.stellar.files.photograph import SolvedPhotograph, solve_photographs
    from vopd.stellar.files.read import PixelFormat

    if given["images"] is not None:
        said = _take_from_tags(given, ctx)
        click.echo(said, err=True) if not given["quiet"] else None
    request = _request(given)

    def report(finding: Finding) -> None:
        """Print errors, and warnings unless quiet, on standard error."""
        if finding.severity == "error":
            click.echo(str(finding), err=True)
        elif not given["quiet"]:
            click.echo(f"warning: {finding}", err=True)

    try:
        photographs, findings, status = solve_photographs(files, request)
    except MissingOption as error:
        raise click.UsageError(f"{error}.") from error
    for finding in findings:
        report(finding)
    by_default = given["y_down"] is None and not given["quiet"]
    files_read = [one.file for one in photographs if isinstance(one, SolvedPhotograph)]
    if by_default and any(one.pixels == PixelFormat(y_down=True) for one in files_read):
        click.echo("x_px, y_px: y taken as pointing down; --y-up if it points up", err=True)
    content = render(form, photographs, request, report)
    with whole_file(output) as page:
        page.write(content)
    ctx.exit(status)


def _take_from_tags(given: dict[str, Any], ctx: click.Context) -> str:
    """Take the size of the photographs, and a first principal distance, where none is stated.

    Returns:
        What was taken.

    Raises:
        VopdError: where there is no image, or several of different cameras
    """
    from math import isfinite

    from vopd.flight.formats.image_tags import images_in, tags_of

    images = given["images"]
    tags = tags_of(images_in(Path(images)))[0].values()
    cameras = {(one.size_px, one.focal_px, one.focal_by) for one in tags if isfinite(one.focal_px)}
    sizes = {one.size_px for one in tags}
    if not Path(images).exists():
        raise VopdError(f"{images}: No such file or directory")
    if not tags:
        raise VopdError(f"{images}: no image with tags (.jpg or .tif)")
    if len(sizes) > 1 or len(cameras) > 1:
        raise VopdError(f"{images}: images of several sizes or focal lengths; name one of them")
    (size,) = sizes
    given["size"] = given["size"] or tuple(map(float, size))
    said = f"{images}: {size[0]} x {size[1]} px"
    if given["focal"] is None and given["focal_px"] is None:
        said += ", principal distance"
        for _, focal_px, by in cameras:
            given["focal_px"] = focal_px
            said += f" {focal_px:.5g} px by {by}"
        if not any(stated(ctx, name) for name in ALONE["free"]):
            given["free"] = (*given["free"], *{"focal"} - {*given["free"]})
            said += ", to be solved for with the attitude"
    return said


def _request(given: dict[str, Any]) -> StarRequest:
    """Collect the options in one request."""
    from vopd.stellar.files.photograph import StarRequest
    from vopd.stellar.methods.run import StarOptions

    return StarRequest(
        axes=image_axes(given),
        method=given["method"],
        pair=given["pair"],
        all_pairs=given["all_pairs"],
        reject=given["reject"],
        edit_by_pairs=given["edit_by_pairs"],
        magnitude_limit=given["magnitude_limit"] and given["magnitude_limit"][0],
        by_elongation=given["weigh_elongation"],
        listing=given["listing"],
        camera_m=given["camera"],
        resection=given["resection"],
        free=given["free"],
        points=given["points"],
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


# AEM and CZML, for which photographs must have dates

QUATERNION = "{a} to {b}, Hamilton; components in {a} are q v q* of those in {b}; scalar last"


def render_dated(
    form: str, photographs: Sequence[SolvedPhotograph], sky: SkyRequest, report: Report
) -> bytes:
    """Render an AEM or a CZML file, of each photograph the first solution.

    Raises:
        VopdError: no photograph has a date, or with czml there is no place.
    """
    import numpy as np

    from vopd.export import FileRequest
    from vopd.export.ccsds import DatedAttitudes, dated_aem
    from vopd.export.viewers import dated_czml
    from vopd.geometry.rotations import from_axes
    from vopd.stellar.files.table import stated_conventions
    from vopd.stellar.sky import BODY_FRAME, CAMERA_FRAME, axes_of_body

    dated = [one for one in photographs if one.solved and one.utc is not None]
    if not dated:
        raise VopdError(f"{form} needs dates: --date, or a column utc, and stars by coordinates")
    if form == "czml" and sky.place is None:
        raise VopdError("czml needs the place of the camera: --place")
    axes = [
        axes_of_body(np.array(one.solved[0].matrix), sky.mount, one.local, sky.place)
        for one in dated
    ]
    frame_b = "SENSOR_1" if sky.mount is None else "SC_BODY_1"
    about = CAMERA_FRAME if sky.mount is None else BODY_FRAME
    stated = stated_conventions(dated)
    place = None if sky.place is None else (sky.place[1], sky.place[0], sky.place[2])
    attitudes = DatedAttitudes(
        ", ".join(dict.fromkeys(one.file.source for one in dated)),
        tuple(one.utc for one in dated if one.utc is not None),
        from_axes(np.array([celestial for celestial, _ in axes])),
        "ICRF",
        frame_b,
        {
            **{key: stated[key] for key in ("program", "source", "doubtful") if key in stated},
            "from frame": "ICRF, the axes of J2000" if form == "aem" else "Earth-fixed, WGS 84",
            "to frame": about if form == "aem" else BODY_FRAME,
            "quaternion": QUATERNION.format(a="ICRF" if form == "aem" else "Earth-fixed axes",
                                            b=frame_b if form == "aem" else "the body"),
            "stars": "; ".join(dict.fromkeys(one.epoch.rpartition("; stars ")[2] for one in dated)),
        },
        place,
        None if sky.place is None else from_axes(np.array([fixed for _, fixed in axes])),
    )  # fmt: skip
    writer = dated_aem if form == "aem" else dated_czml
    return writer(attitudes, FileRequest(object_name="CAMERA"), report)
