"""`vopd demo` from the outside: what it writes, what it refuses, what its help says."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd


@pytest.fixture(autouse=True)
def in_a_new_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_deck_on_standard_output_is_the_deck_in_a_file() -> None:
    printed = vopd("demo", "--frames", "3", "--seed", "5")
    saved = vopd("demo", "--frames", "3", "--seed", "5", "-o", "deck.dat", "--truth", "true.csv")
    assert (printed.status, printed.stderr) == (0, "")
    assert (saved.status, saved.stdout, saved.stderr) == (0, "", "")
    assert Path("deck.dat").read_bytes() == printed.output
    assert Path("true.csv").read_text(encoding="ascii").count("\n") == 1 + 3
    truth = vopd("demo", "--frames", "3", "--seed", "5", "-o", "deck.dat", "--truth", "-")
    assert truth.output == Path("true.csv").read_bytes()


def test_the_deck_runs() -> None:
    vopd("demo", "--noise", ".002", "--landmarks", "3", "--jobs", "2", "-o", "deck.dat")
    result = vopd("run", "deck.dat", "--limits-1974")
    assert (result.status, result.stderr) == (0, "")
    assert result.stdout.count("STANDARD DEVIATION") == 48


@pytest.mark.parametrize(
    "options",
    [
        *(f"--seed {seed}" for seed in range(12)),
        "--frames 600",
        "--frames 1 --landmarks 2",
        "--jobs 6",
        "--noise .01 --frames 100",
        "--landmarks 12 --swing 40 --frames 60",
    ],
)
def test_the_check_finds_nothing(options: str) -> None:
    """The chance of a warning is 1 in 1000 for a deck; every landmark is in some frame."""
    vopd("demo", *options.split(), "-o", "deck.dat")
    done = vopd("check", "--strict", "deck.dat")
    assert (done.status, done.stdout) == (0, "deck.dat: no errors, no warnings\n")


def test_readings_without_noise_are_copies_and_the_check_says_so() -> None:
    vopd("demo", "--noise", "0", "-o", "deck.dat")
    done = vopd("check", "deck.dat")
    assert done.status == 0
    assert_approved(done.stdout)


@pytest.mark.parametrize(
    "option",
    [
        ("--frames", "2"),
        ("--landmarks", "3"),
        ("--seed", "1"),
        ("--noise", ".1"),
        ("--jobs", "2"),
        ("--trajectory-rows", "9"),
        ("--swing", "5"),
        ("--focal", "20"),
        ("--frame-size", "20", "15"),
    ],
)
def test_every_option_changes_the_deck(option: tuple[str, ...]) -> None:
    usual = vopd("demo").stdout
    other = vopd("demo", *option)
    assert other.status == 0
    assert other.stdout != usual


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ("--frames 0", 2),
        ("--frames 1e3", 2),
        ("--landmarks 1", 2),
        ("--landmarks 100", 2),
        ("--noise -0.1", 2),
        ("--noise nan", 2),
        ("--frame-size 9 0", 2),
        ("--jobs 0", 2),
        ("--landmarks 99", 1),
        ("--focal 10.1234567890123", 1),
        ("-o no/such/place.dat", 1),
        ("-o one --truth one", 1),
        ("--truth -", 1),
    ],
)
def test_refusals(arguments: str, status: int) -> None:
    result = vopd("demo", *arguments.split())
    assert (result.status, result.stdout) == (status, "")
    assert_approved(result.stderr)
    assert not list(Path().iterdir())


def test_help_teaches() -> None:
    help_text = vopd("demo", "--help").stdout
    for word in ("Examples", "--noise 0", "[default: 24; 1 to 99,999]", "Exit status", "--truth"):
        assert word in help_text
    assert "demo" in vopd("--help").stdout
