"""`vopd stars radec`: make fictitious stars for given images (RADEC2)."""

from __future__ import annotations

import click

from vopd.cli.options import FILE_NAME, output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.stars.options import FORMATS, numbers, positive
from vopd.files import whole_file
from vopd.findings import Finding


@click.command("radec", short_help="Make fictitious stars for given images (RADEC2).")
@click.argument("file", type=FILE_NAME, metavar="[FILE]", required=False)
@click.option("--focal", metavar="MM", callback=positive, help="Principal distance.")
@click.option(
    "--attitude", metavar="O,P,K", callback=numbers(3), help="omega, phi, kappa of the camera."
)
@click.option(
    "--image",
    "images",
    metavar="X,Y",
    multiple=True,
    callback=numbers(2),
    help="Coordinates of an image, mm; repeatable.",
)
@click.option("--typed", is_flag=True, help="FILE has the numbers typed to RADEC2, one per line.")
@click.option(
    "--format",
    "form",
    type=FORMATS,
    default="text",
    show_default=True,
    help="text: RADEC2's printout; csv: a FILE for `vopd stars solve`.",
)
@output_option("Write the output to this file.")
def radec(
    file: str | None,
    focal: float | None,
    attitude: tuple[float, ...] | None,
    images: tuple[tuple[float, ...], ...],
    typed: bool,
    form: str,
    output: str,
) -> None:
    """Make fictitious stars: the directions of stars whose images are at x, y (RADEC2).

    The images are those of FILE (CSV with columns x_mm,y_mm; - is standard
    input) or those of --image, which may be repeated. With --typed, FILE holds
    the answers to RADEC2's prompts, one number per line in format F15.6: focal
    length, omega, phi, kappa, then x and y of each image, and 9999.9. In this
    format a number without a point counts millionths.

    Right ascensions are written in -180 to 180, as the original does.

    \b
    Examples:
      vopd stars radec decks/stars/table_6_1.csv --focal 76 --attitude 156.14,-18.75,46.01
      vopd stars radec --focal 76 --attitude 10,20,30 --image 24,24 --image -15,15 --format csv
      vopd stars radec decks/stars/radec2_typed.txt --typed

    Exit status: 0 all well; 1 bad input; 2 wrong usage.
    """
    if typed and (file is None or focal or attitude or images):
        raise click.UsageError("--typed has all input in FILE: no --focal, --attitude or --image.")
    if not typed and (focal is None or attitude is None):
        raise click.UsageError("--focal and --attitude are needed (or --typed).")
    if not typed and (file is None) == (not images):
        raise click.UsageError("Give the images by FILE or by --image.")
    from vopd.stellar.radec import radec_text

    refuse_to_overwrite(() if file is None else (file,), output)
    text = radec_text(file, focal, attitude, images, form, _print_warning)
    with whole_file(output) as page:
        page.write(text.encode())


def _print_warning(finding: Finding) -> None:
    click.echo(f"warning: {finding}", err=True)
