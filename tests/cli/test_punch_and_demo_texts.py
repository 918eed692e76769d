"""What is said of a punched flight, and what a synthetic one is asked for."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.command import vopd
from vopd.cli import demo
from vopd.convert import flight_to_deck
from vopd.findings import Finding, VopdError
from vopd.flight import result as solve_project


def punched(*options: str, rows: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    numbers = tuple(("landmark", k, f"mark {k}") for k in range(1, rows + 1))
    flight = "job", numbers, ("the lens is lost",)
    found = (Finding("odd", "f.toml", severity="warning"),)
    monkeypatch.setattr(solve_project, "solve_flight", lambda _: SimpleNamespace(findings=found))
    monkeypatch.setattr(flight_to_deck, "flight_job", lambda _: flight)
    monkeypatch.setattr("vopd.cards.write.write_deck", lambda jobs: f"{jobs[0]} on cards\n")
    monkeypatch.chdir(tmp_path)
    return vopd("punch", "f.toml", *options)


def row(number: int) -> str:
    return f"landmark,{number},mark {number}"


@pytest.mark.parametrize("rows", [0, 1, 12, 13, 20])
def test_what_is_said_of_a_punched_flight(
    rows: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Warnings, what is lost, and the first 12 numbers, with the count of the others."""
    ran = punched(rows=rows, tmp_path=tmp_path, monkeypatch=monkeypatch)
    assert (ran.status, ran.output) == (0, b"job on cards\n")
    named = [f"    {row(k)}\n" for k in range(1, min(rows, 12) + 1)]
    assert_approved(ran.stderr, parts=[*named, *([rows - 12] if rows > 12 else [])])


@pytest.mark.parametrize("rows", [0, 13])
def test_the_numbers_of_a_punched_flight_in_a_file(
    rows: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran = punched("--numbers", "n.csv", rows=rows, tmp_path=tmp_path, monkeypatch=monkeypatch)
    assert ran.stderr.splitlines() == ["f.toml: odd", "f.toml: the lens is lost"]
    lines = ["kind,number,name", *(row(k) for k in range(1, rows + 1))]
    assert Path("n.csv").read_bytes() == "".join(f"{line}\n" for line in lines).encode()
    ran = punched("-q", "-o", "d", rows=rows, tmp_path=tmp_path, monkeypatch=monkeypatch)
    assert (ran.stdout, ran.stderr) == ("", "") and Path("d").read_bytes() == b"job on cards\n"


@pytest.mark.parametrize(
    ("options", "status"),
    [
        (("f.toml", "-o", "n", "--numbers", "n"), 1),
        (("f.toml", "--numbers", "f.toml"), 1),
        (("f.toml", "-o", "f.toml"), 1),
        (("f.dat",), 2),
    ],
)
def test_a_flight_that_is_not_punched(
    options: tuple[str, ...], status: int, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("f.toml").write_text("x")
    ran = vopd("punch", *options)
    assert ran.status == status
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize("message", ["f.toml: wrong", "wrong"])
def test_an_error_of_a_punched_flight_has_its_name_once(
    message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(_: object) -> None:
        raise VopdError(message)

    monkeypatch.setattr(solve_project, "solve_flight", refused)
    ran = vopd("punch", "f.toml")
    assert (ran.status, ran.stdout, ran.stderr) == (1, "", "f.toml: wrong\n")


# demo


@pytest.mark.parametrize(
    ("option", "text", "field", "value"),
    [
        ("--frames", "7", "frames", 7), ("--landmarks", "5", "landmarks", 5),
        ("--seed", "9", "seed", 9), ("--noise", ".01", "noise_in", 0.01),
        ("--jobs", "3", "jobs", 3), ("--trajectory-rows", "8", "trajectory_rows", 8),
        ("--swing", "11", "swing_deg", 11.0), ("--focal", "25", "focal_length_mm", 25.0),
        ("--frame-size", "12 9", "frame_in", (12.0, 9.0)),
    ],
)  # fmt: skip
def test_every_option_of_a_synthetic_flight(
    option: str, text: str, field: str, value: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[Any] = []
    monkeypatch.setattr(demo, "_write", lambda *one: given.append(one))
    assert vopd("demo", option, *text.split(), "--truth", "t.csv").status == 0
    ((plan, output, truth),) = given
    usual = {
        "frames": 24, "landmarks": 4, "seed": 0, "noise_in": 0.003, "jobs": 1,
        "trajectory_rows": 50, "swing_deg": 20.0, "focal_length_mm": 10.4,
        "frame_in": (14.47, 10.457),
    }  # fmt: skip
    assert vars(plan) == usual | {field: value} and (output, truth) == ("-", "t.csv")


def test_errors_of_a_synthetic_flight_name_their_option(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for option, text in (("--noise", "2"), ("--swing", "46"), ("--jobs", "0")):
        ran = vopd("demo", option, text)
        assert ran.status == 2 and f"Error: Invalid value for '{option}': {text} is" in ran.stderr
    ran = vopd("demo", "-o", "d", "--truth", "./d")
    assert (ran.status, ran.stdout) == (1, "")
    assert_approved(ran.stderr)


# errata


def test_the_truth_is_written_wherever_the_deck_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vopd.synthetic.flight.make", lambda _: ("jobs", "true"))
    monkeypatch.setattr("vopd.cards.write.write_deck", lambda jobs: f"{jobs}\n")
    monkeypatch.setattr("vopd.synthetic.flight.truth_csv", lambda true: f"{true}\n")
    monkeypatch.chdir(tmp_path)
    assert vopd("demo", "--truth", "t.csv").output == b"jobs\n"
    assert Path("t.csv").read_bytes() == b"true\n"
    assert vopd("demo", "--truth", "-", "-o", "d").output == b"true\n"
    assert Path("d").read_bytes() == b"jobs\n" and vopd("demo").output == b"jobs\n"
