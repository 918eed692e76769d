"""Which outputs are refused before any work: by every pair of files, and for every reason."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from vopd.cli import output
from vopd.cli.output import refuse_to_overwrite
from vopd.files import OutputError, file_status

AT_ONCE: list[tuple[tuple[str, ...], tuple[str | None, ...], str]] = [
    (("in",), ("out",), ""),
    (("in",), ("out", "other"), ""),
    (("in",), (None, "out"), ""),
    (("in",), ("out", None), ""),
    (("in",), (None, None), ""),
    (("in",), ("in",), "in"),
    (("in",), ("./in",), "./in"),
    (("in",), ("soft",), "soft"),
    (("soft",), ("hard",), "hard"),
    (("out", "in"), ("in",), "in"),
    (("in", "out"), ("in",), "in"),
    (("in",), (None, "in"), "in"),
    (("in",), ("out", "in"), "in"),
    ((), ("out", "out"), "out"),
    ((), ("out", "./out"), "./out"),
    ((), ("new", "./new"), "./new"),
    ((), ("in", "hard"), "hard"),
    ((), ("-", "-"), "-"),
    ((), ("-", "out", "-"), "-"),
    ((), ("-", None, "out"), ""),
    (("-",), ("-",), ""),
    (("new",), ("./new",), "./new"),
    (("-", "in"), ("out",), ""),
    ((os.devnull,), (os.devnull, os.devnull), ""),
    (("loop",), ("out",), ""),
]


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("in", "out", "other"):
        Path(name).write_text(name)
    os.link("in", "hard")
    Path("soft").symlink_to("in")
    Path("loop").symlink_to("loop")
    Path("folder").mkdir()


@pytest.mark.parametrize(("inputs", "outputs", "refused"), AT_ONCE)
def test_no_file_is_needed_twice(
    inputs: tuple[str, ...], outputs: tuple[str | None, ...], refused: str
) -> None:
    """By whatever name; standard output is one output, and devices are as many as one likes."""
    if refused:
        with pytest.raises(OutputError) as error:
            refuse_to_overwrite(inputs, *outputs)
        assert_approved(str(error.value), parts=[refused])
    else:
        refuse_to_overwrite(inputs, *outputs)


@pytest.mark.parametrize(
    ("inputs", "photograph"),
    [
        (("images",), "images/f0.png"),
        (("project.toml",), "f0.png"),
        (("project.toml",), "elsewhere/f0.png"),
        (("other", "night.json"), "f0.png"),
        (("other", "night.json", "images"), "images/within/f0.png"),
    ],
)
def test_photographs_that_an_input_names_are_needed(
    inputs: tuple[str, ...], photograph: str
) -> None:
    """Those of a folder, or where figures look for them; no picture that nothing names."""
    for name in ("images/within", "elsewhere"):
        Path(name).mkdir(parents=True)
    Path("project.toml").write_text('[picks]\nfile = "picks.csv"  # vopd plot -o figure.png\n')
    Path("picks.csv").write_text("image,landmark\nf0.png,mast\nbig-g0.png,mast\n")
    sources = ["stars.csv", 'the "second".csv']
    Path("night.json").write_text(json.dumps([{"image": "f0.png", "source": s} for s in sources]))
    Path("stars.csv").write_text("image\nf0.png\n")
    for name in (photograph, "figure.png", "images/f0.csv", "elsewhere/g0.png"):
        Path(name).touch()
    with refused(OutputError):
        refuse_to_overwrite(inputs, photograph)
    for name in sources if "night.json" in inputs else ():
        with pytest.raises(OutputError):
            refuse_to_overwrite(inputs, name)
    for name in ("figure.png", "f1.png", "images/f0.csv", "images/f2.png", "elsewhere/g0.png"):
        refuse_to_overwrite(inputs, name)
    Path("é.png").touch()
    Path("Night.JSON").write_text(json.dumps([{"image": "é.png", "source": "Stars.csv"}]))
    for name in ("é.png", "Stars.csv"):
        with pytest.raises(OutputError):
            refuse_to_overwrite(("Night.JSON",), name)


@pytest.mark.parametrize(
    "output",
    [
        "folder",
        "no/out",
        "in/out",
        "folder/",
        "new/",
        "",
    ],
)
def test_outputs_that_cannot_be_written(output: str) -> None:
    for given in ((output,), (None, output), ("out", output)):
        with pytest.raises(OutputError) as error:
            refuse_to_overwrite((), *given)
        assert_approved(str(error.value), parts=[output])


@pytest.mark.parametrize(
    "command", ["errata", "stars tables", "stars radec --focal 76 --attitude 1,2,3 --image 1,2"]
)
def test_a_command_without_input_leaves_a_read_only_file(command: str) -> None:
    Path("out").chmod(0o444)
    before = Path("out").read_bytes()
    assert vopd(*command.split(), "-o", "out").status == 1
    assert Path("out").read_bytes() == before


@pytest.mark.parametrize("mode", [0o444, 0o400, 0o644])
def test_a_file_without_permission_to_write_is_read_only(
    mode: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By its mode, whoever asks; or by what the system says."""
    Path("out").chmod(mode)
    if mode == 0o644:
        refuse_to_overwrite((), "out")
        monkeypatch.setattr(os, "access", lambda path, _: path != "out")
    else:
        monkeypatch.setattr(os, "access", lambda *_: True)
    with refused(OutputError):
        refuse_to_overwrite((), "out")


def test_a_folder_of_images_that_cannot_be_listed_is_left_to_its_reader(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What it holds is not known, and that is no reason against an output elsewhere."""

    def listed(self: Path) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    monkeypatch.setattr(Path, "iterdir", listed)
    refuse_to_overwrite(("folder",), "new")
    with pytest.raises(OutputError):
        refuse_to_overwrite(("folder", "in"), "in")


def test_a_photograph_of_the_second_input_is_needed_where_the_first_has_another() -> None:
    """The first names a file of the same name that is elsewhere, or nowhere."""
    for folder in ("a", "b", "c"):
        Path(folder).mkdir()
        Path(folder, "stars.json").write_text('[{"image": "f0.png"}]')
    for folder in ("a", "b"):
        Path(folder, "f0.png").touch()
    for inputs in (("a/stars.json", "b/stars.json"), ("c/stars.json", "b/stars.json")):
        with refused(OutputError):
            refuse_to_overwrite(inputs, "b/f0.png")
    refuse_to_overwrite(("a/stars.json", "c/stars.json"), "b/f0.png")


def test_a_folder_without_permission_to_write(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing new can be made in it, and no file replaced; a device is written as it is."""
    folder = os.path.realpath("folder")
    Path("folder/old").write_text("before")
    os.mkfifo("folder/pipe")
    monkeypatch.setattr(os, "access", lambda path, _: os.path.realpath(path) != folder)
    for name in ("folder/new", "folder/old"):
        with pytest.raises(OutputError) as error:
            refuse_to_overwrite((), name)
        assert_approved(str(error.value), parts=[name])
    refuse_to_overwrite((), "folder/pipe")
    refuse_to_overwrite((), "new")


def test_standard_streams_are_the_files_that_they_come_from_and_go_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    streams: dict[object, str] = {0: "in", 1: "out"}
    monkeypatch.setattr(output, "file_status", lambda name: file_status(streams.get(name, name)))
    for inputs, outputs in ((("-",), "in"), (("out",), "-"), (("-", "out"), "-")):
        with refused(OutputError):
            refuse_to_overwrite(inputs, outputs)
    with refused(OutputError):
        refuse_to_overwrite((), "out", "-")
    for inputs, outputs in ((("-",), "out"), (("in",), "-"), (("-",), "-")):
        refuse_to_overwrite(inputs, outputs)


def test_a_pipe_is_one_standard_output_and_may_be_the_input_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    os.mkfifo("pipe")
    monkeypatch.setattr(output, "file_status", lambda name: file_status("pipe"))
    monkeypatch.setattr(output, "_check_place", lambda _: None)
    refuse_to_overwrite(("-", "pipe"), "-", "pipe", "pipe")
    with refused(OutputError):
        refuse_to_overwrite((), "-", "-")


def test_standard_output_is_not_a_file_of_that_name() -> None:
    Path("-").mkdir()
    refuse_to_overwrite(("in",), "-")
