"""What the commands of star photographs hand on and print, and the streams of a process."""

from __future__ import annotations

import io
import os
import select
import sys
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import click
import pytest

from vopd.cli import cli
from vopd.cli.console import _Messages, _standard_output, prepare_streams
from vopd.cli.stars.solve import _printed
from vopd.export import tables as plain_table
from vopd.findings import Finding
from vopd.stellar.files import solve as solve_star_file
from vopd.stellar.files import table as solution_table

dated_files: Any = import_module("vopd.cli.stars.solve")
formats = dated_files

WARNING, ERROR = Finding("odd", "a.csv", severity="warning"), Finding("wrong", "a.csv")


@pytest.mark.parametrize("quiet", [False, True])
def test_errors_are_printed_and_warnings_unless_they_shall_not(
    quiet: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    report = _printed(quiet)
    report(WARNING)
    report(ERROR)
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err == ("" if quiet else "warning: a.csv: odd\n") + "a.csv: wrong\n"


@pytest.mark.parametrize("form", formats.SOLUTION_FORMATS)
def test_what_each_format_of_a_solution_is_made_of(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[Any] = []

    def note(name: str, content: bytes | str) -> Any:
        def made(*arguments: Any) -> Any:
            given.append((name, *arguments))
            return content

        return made

    table = SimpleNamespace(values="values", conventions="stated", columns="columns")
    monkeypatch.setattr(solve_star_file, "solution_text", note("text", "Zürich"))
    monkeypatch.setattr(dated_files, "render_dated", note("dated", b"dated"))
    monkeypatch.setattr(plain_table, "render_table", note("table", b"table"))
    monkeypatch.setattr(solution_table, "solution_table", lambda _: table)
    photographs: Any = ["one"]
    request: Any = SimpleNamespace(sky="sky")
    content = formats.render(form, photographs, request, print)
    expected = {
        "text": (("text", photographs, form, request), "Zürich".encode()),
        "dated": (("dated", form, photographs, "sky", print), b"dated"),
        "table": (("table", form, "values", "stated", "columns"), b"table"),
    }
    kind = {"aem": "dated", "czml": "dated", "jsonl": "table", "npz": "table", "parquet": "table"}
    wanted, bytes_of = expected[kind.get(form, "text")]
    assert given == [wanted] and content == bytes_of


@pytest.mark.parametrize("stream", [None, SimpleNamespace(buffer=io.BytesIO(), encoding="ascii")])
def test_a_standard_output_without_a_buffer_is_given_one(stream: Any) -> None:
    """Lines are written when they end; a character that the encoding lacks is escaped."""
    made = _standard_output(stream)
    try:
        assert made.line_buffering and isinstance(made.buffer, io.BufferedWriter)
        assert made.encoding == ("utf-8" if stream is None else "ascii")
        assert made.errors == "backslashreplace"
    finally:
        made.detach().detach()  # type: ignore[attr-defined]


def test_a_standard_output_with_a_buffer_stays() -> None:
    stream = io.TextIOWrapper(io.BufferedWriter(io.BytesIO()), encoding="ascii")  # type: ignore[arg-type]
    made = _standard_output(stream)
    assert made is stream and made.errors == "backslashreplace"
    made.write("ü")
    made.flush()
    assert stream.buffer.raw.getvalue() == b"\\xfc"  # type: ignore[attr-defined]


def test_messages_that_standard_error_cannot_take_are_lost() -> None:
    """As if they had been written: a pipe that is full, one that nobody reads, a closed one."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    messages = _Messages(writer, "wb", closefd=False)
    assert messages.write(b"four") == 4 and os.read(reader, 9) == b"four"
    while messages.write(b"x" * 65536) == 65536 and len(select.select([], [writer], [], 0)[1]):
        pass
    assert messages.write(b"more") == 4
    os.close(reader)
    assert messages.write(b"nobody") == 6
    os.close(writer)
    assert messages.write(b"closed") == 6


@pytest.mark.parametrize("encoding", ["ascii", "utf-8", "latin-1"])
def test_standard_error_takes_every_character(
    encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the encoding that it has, each line at once."""
    output = io.TextIOWrapper(io.BufferedWriter(io.BytesIO()))  # type: ignore[arg-type]
    monkeypatch.setattr(sys, "stdout", output)
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(encoding=encoding))
    prepare_streams()
    made: Any = sys.stderr
    assert (made.encoding, made.errors, made.line_buffering) == (encoding, "backslashreplace", True)
    assert sys.stdout.errors == "backslashreplace"


def test_the_command_line_leaves_exceptions_to_its_own_boundary(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is called vopd, whatever the script is, and ends with the status of the command."""
    given: list[Any] = []
    monkeypatch.setattr(click.Group, "main", lambda _, *one, **named: given.append(named) or 5)
    with pytest.raises(SystemExit) as ended:
        cli.main(["run"])
    assert ended.value.code == 5
    assert given == [{"prog_name": "vopd", "standalone_mode": False}]
