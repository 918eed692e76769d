"""Every option of `vopd stars solve`: the one field that it sets, and what it is refused with."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from tests.kit.tagged_images import tagged_image
from vopd.cli.stars.options import camera_parameters, numbers
from vopd.stellar.files.images import MissingOption
from vopd.stellar.files.photograph import StarRequest

USUAL: dict[str, Any] = {
    "axes": {"focal_mm": None, "focal_px": None, "pitch_um": None, "centre_px": None,
             "size_px": None, "y_down": None, "k1": 0.0, "free": ()},
    "method": "collinearity", "pair": None, "all_pairs": False, "reject": False,
    "edit_by_pairs": False, "magnitude_limit": None, "by_elongation": False, "listing": False,
    "camera_m": None, "resection": False, "free": (), "points": (), "shared": None,
    "sky": {"utc": None, "place": None, "pressure_mbar": None, "temperature_c": 10.0,
            "ephemeris": None, "catalogue": None, "mount": None},
    "options": {"initial_deg": None, "start": "svd", "weights": "uniform", "corrections": None,
                "reading_sigma_mm": None, "unit_cross_products": True,
                "rotation_angle": "farther", "rotation": "nearest"},
}  # fmt: skip
"""What is asked for without an option."""

SETS: list[tuple[str, dict[str, Any]]] = [
    ("", {}),
    ("--focal 76", {"axes.focal_mm": 76.0}),
    ("--focal-px 3000.5", {"axes.focal_px": 3000.5}),
    ("--focal 50 --pitch-um 4.3", {"axes.focal_mm": 50.0, "axes.pitch_um": 4.3}),
    ("--centre 10,-20", {"axes.centre_px": (10.0, -20.0)}),
    ("--size 640,480", {"axes.size_px": (640.0, 480.0)}),
    ("--k1 -.25", {"axes.k1": -0.25}),
    ("--k1 0", {}),
    ("--y-down", {"axes.y_down": True}),
    ("--date 2020-01-15T21:00Z", {"sky.utc": datetime(2020, 1, 15, 21, tzinfo=UTC)}),
    ("--date 2020-01-15T21:00:00.25Z",
     {"sky.utc": datetime(2020, 1, 15, 21, 0, 0, 250_000, tzinfo=UTC)}),
    ("--date 2020-01-15T21:00+02:00", {"sky.utc": datetime(2020, 1, 15, 19, tzinfo=UTC)}),
    ("--place 48,11,500", {"sky.place": (48.0, 11.0, 500.0)}),
    ("--place 1,2,3 --pressure 0", {"sky.place": (1.0, 2.0, 3.0), "sky.pressure_mbar": 0.0}),
    ("--place 1,2,3 --pressure 950", {"sky.place": (1.0, 2.0, 3.0), "sky.pressure_mbar": 950.0}),
    ("--place 1,2,3 --temperature -5", {"sky.place": (1.0, 2.0, 3.0), "sky.temperature_c": -5.0}),
    ("--place 1,2,3 --temperature 0", {"sky.place": (1.0, 2.0, 3.0), "sky.temperature_c": 0.0}),
    ("--ephemeris de.bsp", {"sky.ephemeris": "de.bsp"}),
    ("--catalogue hip2.dat", {"sky.catalogue": "hip2.dat"}),
    *((f"--method {one}", {"method": one}) for one in (
        "svd", "church", "church-weighted", "church-weighted-r", "two-star", "single-rotation",
        "all")),
    ("--pair 3,1", {"pair": (3, 1)}),
    ("--all-pairs", {"all_pairs": True}),
    ("--reject", {"reject": True}),
    ("--edit-by-pairs", {"edit_by_pairs": True}),
    ("--magnitude-limit 6.5", {"magnitude_limit": 6.5}),
    ("--weigh-elongation", {"by_elongation": True}),
    ("--rotation as-solved", {"options.rotation": "as-solved"}),
    ("--initial svd", {}),
    ("--initial two-star", {"options.start": "two-star"}),
    ("--initial 1,-2,3", {"options.initial_deg": (1.0, -2.0, 3.0)}),
    ("--weights listed", {"options.weights": "listed"}),
    ("--weights robust", {"options.weights": "robust"}),
    ("--corrections 4", {"options.corrections": 4}),
    ("--listing", {"listing": True}),
    ("--method two-star --cross-products raw",
     {"method": "two-star", "options.unit_cross_products": False}),
    ("--method single-rotation --rotation-angle mean",
     {"method": "single-rotation", "options.rotation_angle": "mean"}),
    ("--reading-sigma .02", {"options.reading_sigma_mm": 0.02}),
    ("--camera 1000,2000,-3", {"camera_m": (1000.0, 2000.0, -3.0)}),
    ("--free focal,k1", {"free": ("focal", "k1")}),
    ("--free centre", {"free": ("centre",)}),
    ("--point 5,-6.5 --point 0,1", {"points": ((5.0, -6.5), (0.0, 1.0))}),
    ("--resection", {"resection": True}),
    ("-q", {}),
    ("--format json", {}),
]  # fmt: skip


def asked(options: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What the solve is asked for."""
    given: list[tuple[tuple[str, ...], StarRequest]] = []

    def solved(files: tuple[str, ...], request: StarRequest) -> None:
        given.append((files, request))
        raise MissingOption("that is all")

    monkeypatch.setattr("vopd.stellar.files.photograph.solve_photographs", solved)
    ran = vopd("stars", "solve", "b.csv", "a.csv", *options.split())
    assert ran.status == 2 and ran.stderr.endswith("Error: that is all.\n")
    ((files, request),) = given
    assert files == ("b.csv", "a.csv")
    return asdict(request)


@pytest.mark.parametrize(("options", "sets"), SETS, ids=[options for options, _ in SETS])
def test_an_option_sets_its_field_and_no_other(
    options: str, sets: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = {k: dict(one) if isinstance(one, dict) else one for k, one in USUAL.items()}
    for name, value in sets.items():
        first, _, second = name.partition(".")
        if second:
            expected[first][second] = value
        else:
            expected[first] = value
    assert asked(options, monkeypatch) == expected


@pytest.mark.parametrize(
    ("mount", "rows"),
    [  # the body's forward, right and down in camera axes: x right, y down, z along the axis
        ("forward", [[0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        ("down", [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        ("0,0,0", [[0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        ("90,0,0", [[-1, 0, 0], [0, 0, 1], [0, 1, 0]]),
    ],
)
def test_the_mount(mount: str, rows: list[list[int]], monkeypatch: pytest.MonkeyPatch) -> None:
    found = asked(f"--mount {mount}", monkeypatch)["sky"]["mount"]
    assert np.round(found, 12).tolist() == rows


COLLINEARITY = ("--initial two-star", "--weights robust", "--corrections 3", "--listing")
REFUSED = [
    "--pair 1,2 --all-pairs",
    *(f"--method {method} {pairs}"
      for method in ("church", "church-weighted", "church-weighted-r")
      for pairs in ("--pair 1,2", "--all-pairs")),
    *(f"--listing {more}"
      for more in ("--pair 1,2", "--all-pairs", "--format json", "--format csv", "--method all",
                   "-o page.json")),
    *(f"--point 1,2 {more}" for more in ("--listing", "--format csv")),
    "--reject --edit-by-pairs",
    *(f"{edit} {pairs}"
      for edit in ("--reject", "--edit-by-pairs") for pairs in ("--pair 1,2", "--all-pairs")),
    "--k1 .1 --free k1",
    "--k1 .1 --free focal,k1",
    *(f"--method svd {option}"
      for option in COLLINEARITY),
    "--cross-products raw",
    "--rotation-angle mean",
    *(f"--resection {option}"
      for option in (*COLLINEARITY, "--cross-products raw", "--rotation-angle mean",
                     "--method svd", "--pair 1,2", "--all-pairs", "--camera 1,2,3", "--reject",
                     "--edit-by-pairs", "--rotation nearest", "--free focal",
                     "--date 2020-01-15T21:00Z", "--place 48,11,500", "--mount down",
                     "--ephemeris a.bsp")),
    *(f"--free focal {option}"
      for option in (*COLLINEARITY, "--cross-products raw", "--rotation-angle mean",
                     "--method svd", "--pair 1,2", "--all-pairs", "--rotation nearest")),
    "--pressure 900",
    "--temperature 9",
    "--focal 0",
    "--focal-px -1",
    "--pitch-um 0",
    "--reading-sigma 0",
    "--centre 1",
    "--centre 1,2,3",
    "--centre 1,-2e12",
    "--camera 1,2",
    "--initial 1,2",
    "--free focal,k2",
    "--pair 1,1",
    "--pair 0,1",
    "--pair 1,2.5",
    "--corrections 0",
    "--corrections 1001",
    "--date yesterday",
    "--place 91,0,0",
    "--mount -361,0,0",
    *(f"-o page{suffix}"
      for suffix in (".png", ".svg", ".pdf", ".jpg", ".jpeg", ".gif", ".tif", ".tiff", ".PNG")),
]  # fmt: skip


@pytest.mark.parametrize("options", REFUSED)
def test_what_is_refused(options: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Wrong usage, before a file is read."""
    monkeypatch.chdir(tmp_path)
    ran = vopd("stars", "solve", "a.csv", *options.split())
    assert (ran.status, ran.stdout) == (2, "")
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize(
    "options",
    ["--method all --weights robust", "--method all --cross-products raw", "--listing -o page.txt",
     "--free focal --camera 1,2,3", "--free focal --reject", "--free focal --edit-by-pairs",
     "--pair 1,2 --method two-star", "--all-pairs --method svd", "--corrections 1",
     "--corrections 1000", "--reading-sigma 1e12", "--k1 .1 --free focal", "--listing -q"],
)  # fmt: skip
def test_what_is_taken_together(options: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert asked(options, monkeypatch)


def test_names_and_numbers_may_have_blanks() -> None:
    context, given = click.Context(click.Command("solve")), click.Option(["--x"], metavar="X,Y")
    assert camera_parameters(context, given, " focal , centre,k1") == ("focal", "centre", "k1")
    assert camera_parameters(context, given, None) == ()
    assert numbers(2)(context, given, " -1.5, 2") == (-1.5, 2.0)
    assert numbers(2)(context, given, None) is None
    assert numbers(2)(context, given, ("1,2", "3,4")) == ((1.0, 2.0), (3.0, 4.0))
    assert numbers(2)(context, given, ()) == ()
    assert numbers(2)(context, given, "-1e12,1e12") == (-1e12, 1e12)
    for text in ("1", "1,2,3", "1,1.1e12", "-1.1e12,1", "1,nan", "1,", "1,x"):
        with refused(click.BadParameter):
            numbers(2)(context, given, text)


def test_a_photograph_brings_size_and_principal_distance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """76 mm of a camera whose 36 mm of film have 7,200 pixels: 15,200 px, but for the width."""
    pixels = Path(__file__).parents[2] / "decks" / "stars" / "orion_pixels.csv"
    tagged_image(tmp_path / "orion.jpg", lens={0xA405: 91}, size_px=(6000, 5200))
    tagged_image(tmp_path / "untold.jpg", size_px=(6000, 5200))
    shutil.copy(pixels, tmp_path / "stars.csv")
    monkeypatch.chdir(tmp_path)
    stated = vopd("stars", "solve", "stars.csv", "--size", "6000,5200", "--free", "focal", "-q")
    for image in ("orion.jpg", "untold.jpg"):
        taken = vopd("stars", "solve", "stars.csv", "--images", image)
        assert taken.status == 0
        assert_approved(taken.stderr.splitlines()[:1])
        assert taken.stdout.splitlines()[:4] == stated.stdout.splitlines()[:4]
    church = "stars", "solve", "stars.csv", "--method", "church"  # which frees nothing
    held = vopd(*church, "--size", "6000,5200", "--focal-px", str(91.0 * 6000.0 / 36.0), "-q")
    assert vopd(*church, "--images", "orion.jpg").stdout == held.stdout != ""
    known = vopd("stars", "solve", "stars.csv", "--images", "orion.jpg", "--focal-px", "15200")
    assert (known.status, "\nfocal " in known.stdout, "\nfocal " in taken.stdout) == (
        0,
        False,
        True,
    )
    assert vopd("stars", "solve", "stars.csv", "--images", ".").status == 0
    half = ("--size", "3000,2600", "--focal-px", "15200")  # of a file whose pixels are of another
    own = vopd("stars", "solve", "stars.csv", "--images", "orion.jpg", *half)
    assert own.stdout == vopd("stars", "solve", "stars.csv", *half).stdout != known.stdout
    Path("few.csv").write_text("\n".join(Path("stars.csv").read_text().splitlines()[:4]))
    few = vopd("stars", "solve", "few.csv", "--images", "orion.jpg", "--free", "k1,centre")
    assert "--free k1,centre,focal takes" in few.stderr  # in this order, in each run
    tagged_image(Path("narrow.jpg"), size_px=(600, 520))
    for images in (".", "stars.csv", "none"):
        refused_one = vopd("stars", "solve", "stars.csv", "--images", images)
        assert refused_one.status == 1
        assert_approved(refused_one.stderr)
