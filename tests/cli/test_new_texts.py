"""What a new project is made of, and what is said of it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, vopd
from vopd.cli import new
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.flight import new as new_project
from vopd.flight.new import NewProject

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
    assert given == [(tmp_path / "p", {key: "some.file"})]


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
        "next: vopd check some/where/flight.toml",
    ]  # fmt: skip
    assert {one.name: one.read_bytes() for one in Path("some/where").iterdir()} == contents
    made.needed.clear()
    Path("there").mkdir()
    ran = vopd("new", "there")
    assert ran.stdout.splitlines()[2:] == [
        "there/flight.toml: written", "next: vopd attitude there/flight.toml"
    ]  # fmt: skip


def test_files_that_are_there_already_are_not_touched(tmp_path: Path) -> None:
    """All or none: of those that were written before the error none is left."""
    (tmp_path / "b").write_text("before")
    with pytest.raises(OutputError) as refusal:
        new.write_project(tmp_path, NewProject({"a": b"1", "b": b"2"}))
    assert_approved(str(refusal.value), parts=[tmp_path / "b"])
    assert [one.name for one in tmp_path.iterdir()] == ["b"]
    folder = tmp_path / "c"
    with pytest.raises(VopdError):
        new.write_project(folder, NewProject({"a": b"1", "no/such": b"2"}))
    assert not [*folder.iterdir()]
    with refused(OutputError):
        new.write_project(tmp_path / "b" / "d", NewProject({"a": b"1"}))


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
    assert (ran.status, ran.stderr) == (1, f"{STACK}, job 2: wrong\n")
    monkeypatch.setattr("vopd.convert.deck_to_flight.deck_project", converted)
    monkeypatch.setattr(
        "vopd.cards.read.read_deck",
        lambda _: [
            SimpleNamespace(
                ignored=SimpleNamespace(landmark=np.array([k])),
                readings=SimpleNamespace(frame=range(k)),
            )
            for k in (1, 2, 3)
        ],
    )
    ran = vopd("new", tmp_path / "a", "--deck", "d", "--job", "2")
    assert given == [[2]]
    assert ran.stdout.splitlines()[:3] == ["d, job 2: 2 frames on cards", "odd", "odder"]


# punch
