"""The console: standard streams, messages, progress, and exit statuses."""

from __future__ import annotations

import errno
import io
import os
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import click

from vopd.files import ROOT, Terminal
from vopd.findings import Finding, Kind, VopdError, count_text, kind_of, shortened, strict

# Messages on standard error: warnings, errors, and the progress of long work.

ALIKE = 3  # this many warnings of one kind are shown
COLUMNS = 80  # where the screen does not say how wide it is
PATIENCE_S = 1.0  # work that ends sooner shows no progress
EVERY_S = 0.2


def screen_columns() -> int:
    """Measure the width that a text is set for: that of the terminal, or of COLUMNS."""
    from vopd.screen import fitted

    return fitted(shutil.get_terminal_size((COLUMNS, 24)).columns)


def notes(quiet: bool) -> Callable[[str], None]:
    """Choose how notes on a picture or a page are said: on standard error, or not at all."""
    return (lambda _: None) if quiet else partial(click.echo, err=True)


class Messages:
    """Print the first warnings of each kind and count the others; raise findings that are errors.

    Args:
        quiet: print no warnings
        on_message: is given the text of every warning and error, also of those not printed
    """

    def __init__(
        self, quiet: bool = False, on_message: Callable[[str], object] = lambda _: None
    ) -> None:
        self._quiet = quiet
        self._on_message = on_message
        self._seen: Counter[Kind] = Counter()
        self.warnings = 0

    def __call__(self, finding: Finding) -> None:
        strict(finding)
        self._on_message(str(finding))
        self.warnings += 1
        kind = kind_of(finding)
        self._seen[kind] += 1
        if not self._quiet and self._seen[kind] <= ALIKE:
            click.echo(f"warning: {finding}", err=True)

    def error(self, message: str) -> None:
        """Print an error, after the number of warnings that were not shown."""
        self.close()
        self._on_message(message)
        click.echo(message, err=True)

    def close(self) -> None:
        """Print how many warnings were not shown."""
        for (_, source, job, group, field, _), count in self._seen.items():
            if count > ALIKE and not self._quiet:
                more = f"{count_text(count - ALIKE, 'more warning')} like these"
                alike = Finding(more, source, job=job, group=group, field=field)
                click.echo(f"warning: {alike}", err=True)
        self._seen.clear()


class Progress:
    """A line on standard error that counts finished work; shown only on a terminal.

    Args:
        unit: what is counted
        total: how many there will be, if it is known; the time that is left is shown then
        rate: show how many there are a second
        stopped: what to say where the process is stopped meanwhile, after the count
    """

    running: ClassVar[list[Progress]] = []

    def __init__(
        self,
        unit: str,
        clock: Callable[[], float] = time.monotonic,
        total: int | None = None,
        stopped: str = "",
        rate: bool = False,
    ) -> None:
        self._stopped = stopped
        self.running.append(self)
        self._unit = unit
        self._clock = clock
        self._start = clock()
        self._next = self._start + PATIENCE_S
        self.total = total
        self._rate = rate
        self._count = 0
        self._shown = 0  # characters

    def add(self, count: int) -> None:
        """Add to the count and show it."""
        self._count += count
        if self not in self.running:
            self.running.append(self)
        if (now := self._clock()) >= self._next and sys.stderr.isatty():
            self._next = now + EVERY_S
            text = self._text(now)
            click.echo("\r" + text.ljust(self._shown), nl=False, err=True)
            self._shown = len(text)

    def stop_text(self) -> str:
        """Say how far the work has come; empty if it has hardly begun."""
        if not self._stopped or self._clock() < self._start + PATIENCE_S:
            return ""
        done = self._done() if self.total is None else f"{self._count} of {self.total} done"
        return f"{done}; {self._stopped}"

    def _done(self) -> str:
        unit = self._unit.removesuffix("s") if self._count == 1 else self._unit
        return f"{self._count} {unit}"

    def _text(self, now: float) -> str:
        if self.total is None:
            return self._done()
        left_s = (now - self._start) / max(self._count, 1) * (self.total - self._count)
        minutes, seconds = divmod(round(left_s), 60)
        done = f"{self._count} of {self.total} {self._unit}"
        if self._rate:
            done += f", {self._count / max(now - self._start, 1e-9):.1f} a second"
        return f"{done}, about {minutes} min {seconds:02} s left"

    def close(self) -> None:
        """Clear the line."""
        if self in self.running:
            self.running.remove(self)
        if self._shown:
            click.echo("\r" + " " * max(self._shown, 20) + "\r", nl=False, err=True)
            self._shown = 0


# Turn exceptions into messages on standard error and an exit status, for all commands.


DAMAGED = "marshal data"  # in what Python says of a file .pyc that breaks off
NOT_LOADED = "failed to map segment"  # what the system says of a library and too little memory


class ReaderGone(Exception):
    """The program that reads standard output has closed it, so nothing more can be written."""


def at_the_boundary(command: Callable[[], object]) -> int:
    """Run a click command; print errors that the user can correct; return the exit status.

    Args:
        command: runs a click command with `standalone_mode` off, so that it raises
    """
    returned = 0
    try:
        returned = command_status(command)
        sys.stdout.flush()
    except (BrokenPipeError, ReaderGone):
        discard_output()
    except OSError as error:  # a full disk, noticed while writing or while flushing
        discard_output()
        where, why = error.filename or "standard output", error.strerror
        if error.errno in (errno.EMFILE, errno.ENFILE):
            where = "the system's limit (ulimit -n)"
        elif error.errno == errno.ENOENT and not error.filename:  # os.getcwd says no name
            where, why = "the current folder", "it has been removed: go to another, and repeat"
        click.echo(f"{where}: {why}", err=True)
        return 1
    except MemoryError:
        click.echo("there is not enough memory for this input", err=True)
        return 1
    except ImportError as error:
        if NOT_LOADED not in str(error):
            raise
        click.echo("there is not enough memory to load numpy and scipy (ulimit -v)", err=True)
        return 1
    return returned


def command_status(command: Callable[[], object]) -> int:
    """Run a click command and return its exit status; wrong usage is explained."""
    try:
        returned = command()
    except click.ClickException as error:
        error.message = shortened(error.message)  # type: ignore[misc, unused-ignore]
        error.show()
        return error.exit_code
    except click.Abort as error:  # which click makes of the end of standard input, too
        if DAMAGED not in str(error.__cause__):
            return 130
        click.echo(
            "a compiled file of Python is damaged, as a full disk leaves one: delete the folders "
            f"__pycache__ in {sys.prefix} and {ROOT / 'vopd'}, and repeat the command",
            err=True,
        )
        return 1
    except VopdError as error:
        click.echo(str(error), err=True)
        return 1
    return returned if isinstance(returned, int) else 0


def discard_output() -> None:
    """Discard the rest of standard output, which the interpreter would flush again at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())


# The standard streams of the process


def prepare_streams() -> None:
    """Make the standard streams behave the same, whoever started the process.

    A closed descriptor is taken, so that no other file gets its number: reading
    standard input or writing standard output is then an error of that stream.
    Messages that standard error cannot take are lost and stop nothing. No
    character is an error, whatever the encoding. A terminal gets no control
    character of a name or a file, which could move its cursor, hide text or
    change its settings; files and pipes get the bytes as they are.
    """
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:  # opened the wrong way round, to fail when it is used
            os.open(os.devnull, os.O_WRONLY if descriptor != 1 else os.O_RDONLY)
    sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = _standard_output(sys.stdout)
    if sys.stdout.isatty():
        encoding = sys.stdout.encoding
        sys.stdout = _shown_on(sys.stdout.detach(), encoding)
    encoding = "utf-8" if sys.stderr is None else sys.stderr.encoding
    messages = io.BufferedWriter(_Messages(2, "wb", closefd=False))
    if messages.isatty():
        sys.stderr = _Lines(
            io.BufferedWriter(Terminal(messages, encoding)),
            encoding=encoding, errors="backslashreplace", line_buffering=True,
        )  # fmt: skip
        return
    sys.stderr = io.TextIOWrapper(
        messages, encoding=encoding, errors="backslashreplace", line_buffering=True
    )


def _standard_output(stream: Any) -> io.TextIOWrapper:
    """Open a stream that writes all it is given; one without a buffer may write a part."""
    encoding = "utf-8" if stream is None else stream.encoding
    if stream is None or not isinstance(stream.buffer, io.BufferedWriter):
        raw = io.FileIO(1, "wb", closefd=False)
        stream = io.TextIOWrapper(io.BufferedWriter(raw), encoding=encoding, line_buffering=True)
    stream.reconfigure(errors="backslashreplace")
    assert isinstance(stream, io.TextIOWrapper)
    return stream


def _shown_on(terminal: Any, encoding: str) -> io.TextIOWrapper:
    """Open a stream whose text and bytes reach a terminal without control characters."""
    return io.TextIOWrapper(
        io.BufferedWriter(Terminal(terminal, encoding)),
        encoding=encoding,
        errors="backslashreplace",
        line_buffering=True,
    )


class _Lines(io.TextIOWrapper):
    """Messages on a terminal: a line that is too wide for it is broken at words.

    The lines after a first one, such as a card under its ruler or what is to be copied into a
    file, stay as they are.
    """

    def write(self, text: str, /) -> int:
        from vopd.screen import wrapped

        first, end, rest = text.partition("\n")
        if first[:1] not in ("", " ", "\r"):
            first = wrapped(first, screen_columns(), "  ")
        super().write(first + end + rest)
        return len(text)


class _Messages(io.FileIO):
    """Standard error: what it cannot take is lost."""

    def write(self, data: Any, /) -> int:
        try:
            return super().write(data) or len(data)
        except OSError:
            return len(data)
