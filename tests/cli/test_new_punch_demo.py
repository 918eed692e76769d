"""`vopd new`, `punch` and `demo`: what they are asked for, and what they say."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS, ROOT, handed, vopd
from vopd.cli import adjust, demo, new
from vopd.convert import flight_to_deck
from vopd.files import OutputError
from vopd.findings import Finding, VopdError
from vopd.flight import result as solve_project
from vopd.flight.project import new as new_project
from vopd.flight.project.inspect import NewProject
from vopd.job import Deck


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
    assert ran.stderr.splitlines() == ["warning: f.toml: odd", "f.toml: the lens is lost"]
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
        "frame_in": (14.47, 10.457), "earth": "1974",
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


# A new project

STACK = DECKS / "appendix_h" / "cases_1_2_3.dat"


# new


@pytest.mark.parametrize(
    ("option", "key"),
    [
        ("--gcp", "gcp"), ("--lens", "lens"), ("--picks", "picks"), ("--landmarks", "landmarks"),
        ("--track", "track"), ("--images", "images"), ("--wind", "wind"),
    ],
)  # fmt: skip
def test_a_new_project_is_told_which_file_is_what(
    option: str, key: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[Any] = []
    monkeypatch.setattr(
        new_project, "project_of_files", lambda *one: given.append(one) or NewProject({})
    )
    assert vopd("new", tmp_path / "p", option, "some.file").status == 0
    assert [one[:3] for one in given] == [(tmp_path / "p", {key: "some.file"}, [])]


def test_what_a_new_project_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A sentence for each file, what is needed and why, and which command comes next."""
    monkeypatch.chdir(tmp_path)
    contents = {"flight.toml": b"a\n", "picks.csv": b"b\n"}
    needed = {("camera", "model"): "no lens is given", ("track", "height"): "CSV does not say"}
    made = NewProject(contents, ["one", "two"], needed)
    monkeypatch.setattr(new_project, "example_project", lambda: made)
    ran = vopd("new", Path("some") / "where")
    assert (ran.status, ran.stderr) == (0, "")
    assert ran.stdout.splitlines() == [
        "one", "two", "some/where/flight.toml: written",
        "needed: [camera] model (no lens is given)",
        "needed: [track] height (CSV does not say)",
        "next: vopd new some/where --set camera.model=... --height ...",
    ]  # fmt: skip
    assert {one.name: one.read_bytes() for one in Path("some/where").iterdir()} == contents
    made.needed.clear()
    Path("my flight").mkdir()
    ran = vopd("new", "my flight")
    assert ran.stdout.splitlines()[2:] == [
        "my flight/flight.toml: written", "next: vopd attitude 'my flight/flight.toml'"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("typed", "is_terminal"),
    [("1920x1080\negm96\n\nx\n460\n\n", True), ("1920,1080\n\n12\n\n.5\n", True), ("9,9\n\n", True),
     ("", True), ("9,9\n", False)],
)  # fmt: skip
def test_what_a_new_project_asks(
    typed: str, is_terminal: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the order of what is needed, but no file; a wrong answer is asked for again."""
    needed = {
        ("picks", "file"): "no file", ("camera", "image_size_px"): "no image",
        ("landmarks", "height"): "CSV does not say", ("track", "sigma_m"): "metres; or exact",
        ("track", "height"): "from the ground", ("position", "height"): "CSV does not say",
    }  # fmt: skip
    made = NewProject({}, ["two files"], needed, options={("track", "height"): "--ground"})
    values: dict[tuple[str, str], str] = {}

    def of_files(_: Path, files: Any, answers: Any, ask: Any, *more: Any) -> NewProject:
        ask(made, values)
        return made

    stream = SimpleNamespace(isatty=lambda: is_terminal)
    monkeypatch.setattr(new, "sys", SimpleNamespace(stdin=stream, stdout=stream))
    monkeypatch.setattr(new_project, "project_of_files", of_files)
    monkeypatch.chdir(tmp_path)
    ran = vopd("new", "p", "--picks", "some.file", stdin=typed)
    assert_approved([ran.stdout, values, ran.status])


@pytest.mark.parametrize("quiet", [True, False])
def test_an_adjusted_project_is_told_on_standard_error(
    quiet: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = ROOT / "examples" / "hill" / "flight.toml"
    words = "--free", "focal", "-o", tmp_path / "new", *["-q"] * quiet
    given = handed(monkeypatch, adjust, "write_project", "adjust", flight, *words)
    assert (given[0], given[2:]) == (tmp_path / "new", (True, quiet))


def test_files_that_are_there_already_are_not_touched(tmp_path: Path) -> None:
    """All or none: of those that were written before the error none is left."""
    (tmp_path / "b").write_text("before")
    with refused(OutputError, parts=[tmp_path / "b"]):
        new.write_project(tmp_path, NewProject({"a": b"1", "b": b"2"}))
    assert [one.name for one in tmp_path.iterdir()] == ["b"]
    (tmp_path / "c").mkdir()
    for folder in (tmp_path / "c", tmp_path / "c" / "d" / "e"):  # a folder that it makes goes too
        with pytest.raises(VopdError):
            new.write_project(folder, NewProject({"a": b"1", "no/such": b"2"}))
        assert not [*(tmp_path / "c").iterdir()]
    with refused(OutputError):
        new.write_project(tmp_path / "b" / "d", NewProject({"a": b"1"}))


def test_a_project_that_is_written_again_stays_where_a_file_cannot_be(tmp_path: Path) -> None:
    """The file that was there has a content, the old or the new; one that was not is not left."""
    (tmp_path / "a").write_bytes(b"0")
    with pytest.raises(OutputError):
        of_several = NewProject({"a": b"1", "b": b"1", "no/such": b"2"})
        new.write_project(tmp_path, of_several, again=True)
    assert [one.name for one in tmp_path.iterdir()] == ["a"]


def test_a_name_that_is_neither_a_file_nor_a_folder(tmp_path: Path) -> None:
    """As /dev/null; "File exists", it said."""
    (tmp_path / "gone").symlink_to(tmp_path / "nowhere")
    with refused(OutputError):
        new.write_project(tmp_path / "gone", NewProject({"a": b"1"}))


def test_an_existing_project_is_refused_before_any_file_is_read(tmp_path: Path) -> None:
    (tmp_path / "flight.toml").write_text("before")
    ran = vopd("new", tmp_path, "--deck", "none.dat")
    assert_approved(ran.stderr, parts=[tmp_path / "flight.toml"])


def test_a_project_of_a_deck_names_job_and_frames(tmp_path: Path) -> None:
    ran = vopd("new", tmp_path / "a", "--deck", STACK)
    assert ran.status == 1
    assert_approved(ran.stderr, parts=[STACK])
    assert not (tmp_path / "a").exists()
    ran = vopd("new", tmp_path / "a", "--deck", STACK, "--job", "3")
    assert ran.status == 0 and ran.stdout.startswith(f"{STACK}, job 3: 1 frame on cards\n")
    ran = vopd("new", tmp_path / "b", "--deck", STACK, "--job", "4")
    assert_approved(ran.stderr, parts=[STACK])
    four = DECKS / "appendix_h" / "case4.dat"
    ran = vopd("new", tmp_path / "c", "--deck", four)
    assert ran.stdout.startswith(f"{four}, job 1: 3 frames on cards\n")


def some_job(count: int) -> Any:
    """What `vopd new` looks at in a job of so many frames."""
    ignored = SimpleNamespace(landmark=np.array([count]))
    return SimpleNamespace(ignored=ignored, readings=SimpleNamespace(frame=range(count)))


def test_notes_and_errors_of_a_deck_that_becomes_a_project(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The job that is asked for is the one that is converted."""
    given: list[Any] = []

    def converted(job: Any) -> Any:
        given.append(job.ignored.landmark.tolist())
        return NewProject({"flight.toml": b"x"}, ["odd", "odder"])

    def refusal(_: object) -> None:
        raise VopdError("wrong")

    monkeypatch.setattr("vopd.convert.deck_to_flight.deck_project", refusal)
    ran = vopd("new", tmp_path / "a", "--deck", STACK, "--job", "2")
    assert (ran.status, ran.stderr.splitlines()[-1]) == (1, f"{STACK}, job 2: wrong")
    monkeypatch.setattr("vopd.convert.deck_to_flight.deck_project", converted)
    monkeypatch.setattr(
        "vopd.pipeline.read_deck",
        lambda _: Deck(tuple(some_job(k) for k in (1, 2, 3)), "d"),
    )
    ran = vopd("new", tmp_path / "a", "--deck", "d", "--job", "2")
    assert given == [[2]]
    assert ran.stdout.splitlines()[:3] == ["d, job 2: 2 frames on cards", "odd", "odder"]


# punch


def test_a_deck_s_warnings_are_those_of_a_check(tmp_path: Path) -> None:
    """Card 59 of case 1 has a reading .020 inch off, which becomes a pick."""
    ran = vopd("new", tmp_path / "a", "--deck", CASE_1)
    checked = vopd("check", CASE_1).stdout.splitlines()
    warned = checked[: checked.index("")]
    assert ran.status == 0 and warned[0].startswith("warning:")
    assert ran.stderr.splitlines() == warned
