"""Findings: errors and warnings about an input, with their location, and counted by kind."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from reprlib import Repr
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from vopd.arrays import Floats

# Findings: errors and warnings about an input, with their location in it.
#
# An error that is raised carries a finding; a warning is one.

BASIC_DATA = 0  # the number that stands for the basic data where a group's number is asked for
Severity = Literal["error", "warning"]

RULER_TENS = "".join(f"{tens:10d}" for tens in range(1, 9))
RULER_ONES = "1234567890" * 8


@dataclass(frozen=True)
class Finding:
    """An error or a warning about an input, with its location as far as it is known.

    Attributes:
        message: what is wrong
        source: name of the file
        card: number of the card, from 1
        job: number of the job, from 1
        group: number of the group, 1 to 12, or `BASIC_DATA`
        field: what the field means
        columns: first and last column of the field, from 1
        image: text of the card, which is shown under a ruler when `columns` are known
        severity: whether it is an error, which stops a run, or a warning
    """

    message: str
    source: str = ""
    card: int | None = None
    job: int | None = None
    group: int | None = None
    field: str = ""
    columns: tuple[int, int] | None = None
    image: str | None = None
    severity: Severity = "error"

    @property
    def deck(self) -> str:
        """The earlier name of `source`."""
        return self.source

    def __str__(self) -> str:
        return "\n".join([self.headline(), *self._ruler()])

    def headline(self) -> str:
        """Write the finding on one line: source, card, job, group, field, columns, message."""
        columns = ""
        if self.columns is not None:
            first, last = self.columns
            columns = f" (columns {first}-{last})" if last > first else f" (column {first})"
        card = "" if self.card is None else f"card {self.card}"
        job = "" if self.job is None else f"job {self.job}"
        group = "" if self.group is None else group_text(self.group)
        field = (self.field + columns).strip()
        where = ", ".join(part for part in (card, job, group, field) if part)
        text = ": ".join(part for part in (self.source, where, self.message) if part)
        return shortened(text) if LAID_OUT in self.message else one_line(text)

    def _ruler(self) -> list[str]:
        if self.image is None or self.columns is None:
            return []
        first, last = self.columns
        marks = " " * (first - 1) + "^" * (last - first + 1)
        return ["    " + line for line in (RULER_TENS, RULER_ONES, self.image.rstrip(), marks)]

    def warned(self) -> Finding:
        """Turn the finding into a warning."""
        return replace(self, severity="warning")


def group_text(number: int) -> str:
    """Name a group in messages: `group 9`, or `basic data`."""
    return "basic data" if number == BASIC_DATA else f"group {number}"


MOST_RUNS = 20  # frames, and runs of frames, that are named


def frames_text(labels: Sequence[str]) -> str:
    """Write frames as text: `frame 7`, `frames 7, 9-12, 20`, or `frames A.JPG, B.JPG`.

    Of more than `MOST_RUNS` frames and runs of frames, the others are counted.
    """
    runs: list[list[str]] = []
    for label in labels:
        follows = runs and label.isdigit() and runs[-1][-1].isdigit()
        if follows and int(label) == int(runs[-1][-1]) + 1:
            runs[-1].append(label)
        else:
            runs.append([label])
    named = [run[0] if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs]
    left = sum(map(len, runs[MOST_RUNS:]))
    more = f" and {left} more" if left else ""
    return f"frame{'' if len(labels) == 1 else 's'} {', '.join(named[:MOST_RUNS])}{more}"


def first_of(labels: Sequence[str], most: int) -> str:
    """List labels, and of more than so many the first ones and how many more there are.

    Args:
        labels: what is listed
        most: how many are named
    """
    left = len(labels) - most
    return ", ".join(labels[:most]) + f" and {left} more" * (left > 0)


def listed(words: Sequence[str], last: str = "and") -> str:
    """Join two words or more for a sentence, such as "a, b and c".

    Args:
        words: the words
        last: the word before the last of them, "and" or "or"
    """
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def count_text(number: int, one: str, many: str = "") -> str:
    """Write a number with its noun: `1 frame`, `12 more frames`, `1 frame is left out`.

    Args:
        number: how many
        one: what follows 1
        many: what follows other numbers; by default the same with an s
    """
    return f"{number} {one if number == 1 else many or f'{one}s'}"


MOST_WRITTEN_OUT = 1e6  # of sizes


def size_text(value: float, digits: int = 2) -> str:
    """Write a size with some significant digits, without an exponent: `0.31`, `2100`."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < MOST_WRITTEN_OUT else text


def angle_in_range(angle_deg: float, decimals: int, half_circle: bool = False) -> float:
    """Round an angle, and bring it into its range: 359.999 to two decimals is 0.

    Args:
        angle_deg: degrees; of NaN it is NaN
        decimals: to which it is rounded
        half_circle: whether the range is above -180 to 180, and not from 0 to below 360
    """
    rounded = round(angle_deg, decimals)
    return 180.0 - (180.0 - rounded) % 360.0 if half_circle else rounded % 360.0


def angle_text(angle_deg: float, decimals: int, half_circle: bool = False) -> str:
    """Write an angle, degrees, rounded as `angle_in_range` does: `0.00` for 359.999."""
    return f"{angle_in_range(angle_deg, decimals, half_circle):.{decimals}f}"


Report = Callable[[Finding], None]
"""A function that is given a finding and keeps it, prints it or raises it."""


LONGEST_MESSAGE = 3_000  # characters of a message: of a longer one the middle is left out


def shortened(text: str) -> str:
    """Leave out the middle of a text that nobody reads: names and cells may have megabytes."""
    half = LONGEST_MESSAGE // 2
    return text if len(text) <= LONGEST_MESSAGE else f"{text[:half]} ... {text[-half:]}"


LAID_OUT = "\n\n"  # in a message of several paragraphs, with lines to copy into a file


def one_line(text: str) -> str:
    """Write a text of limited length on one line: a name in it may have line feeds."""
    return shortened(text).replace("\n", "\\n").replace("\r", "\\r")


class VopdError(Exception):
    """The base class of errors that a user can correct; its text is the message for the user."""

    def __str__(self) -> str:
        return shortened(super().__str__())


def refuse_other_kind(
    value: object, kinds: type | tuple[type, ...], function: str, takes: str
) -> None:
    """Refuse an argument of a public function that is of another kind.

    Raises:
        VopdError: with what the function takes
    """
    if not isinstance(value, kinds):
        name = type(value).__name__
        article = "an" if name[0] in "aeiou" else "a"
        raise VopdError(f"{function} takes {takes}, not {article} {name}")


def refuse_other_word(value: object, words: Sequence[str], name: str) -> None:
    """Refuse an argument of a public function that is none of the words it may be.

    Args:
        value: it
        words: those it may be
        name: of the argument

    Raises:
        VopdError: with all words
    """
    if not isinstance(value, str) or value not in words:
        raise VopdError(f"{name} is {value!r}, not {' or '.join(map(repr, words))}")


def numbers(value: object, name: str) -> Floats:
    """Make an array of the numbers that a public function is given: an array, a list, a table.

    Args:
        value: it
        name: of the argument

    Raises:
        VopdError: where it is anything else, or an element is masked
    """
    import numpy as np  # of few starts

    try:
        found = np.asarray(value)
        if found.dtype.kind not in ("iufO" if found.ndim else "iuf"):
            raise TypeError
        found = np.asarray(found, dtype=np.float64)
    except (TypeError, ValueError):  # numpy's, of words, sets, and lists of several lengths
        raise VopdError(f"{name} is {type(value).__name__}, not an array of numbers") from None
    refuse_masked(value, name)
    return found


def refuse_masked(value: object, name: str) -> None:
    """Refuse an array with masked elements, which `numpy.asarray` takes for numbers.

    Raises:
        VopdError: where there is one
    """
    import numpy as np  # of few starts

    if np.ma.is_masked(value):
        raise VopdError(
            f"{name} has masked elements, which are no numbers: leave them out, or fill them"
        )


class NeededError(VopdError):
    """A value is missing that no file has; there may be others."""


MOST_ERRORS = 10  # that are told together
MORE_ERRORS = "there are more errors: mend these first"


class SeveralErrors(VopdError):
    """Errors of one source, a line each, of which none follows from another."""

    def __init__(self, errors: Sequence[VopdError]) -> None:
        more = [VopdError(MORE_ERRORS)] if len(errors) > MOST_ERRORS else []
        self.errors = [*errors[:MOST_ERRORS], *more]
        super().__init__("\n".join(map(str, self.errors)))


def raise_all(errors: Sequence[VopdError]) -> None:
    """Raise errors of one source together, each text once; nothing where there is none.

    Raises:
        VopdError: the one, or `SeveralErrors`
    """
    each = [one for e in errors for one in (e.errors if isinstance(e, SeveralErrors) else [e])]
    known = [*{str(one): one for one in each}.values()]
    if known:
        raise known[0] if len(known) < 2 else SeveralErrors(known)


class InputError(VopdError):
    """An error in an input that cannot be read or solved; `finding` has the location."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding)
        self.finding = finding


def input_error(message: str, source: str) -> InputError:
    """Make an error in a file, without a place or with one in the message."""
    return InputError(Finding(message, source))


def findings_in(error: VopdError, source: str) -> list[Finding]:
    """Make findings of an error, or of several, whose texts may leave out of which source they are.

    Args:
        error: of the source, or of a file that it names
        source: a project or a deck
    """
    errors = error.errors if isinstance(error, SeveralErrors) else [error]
    return [finding_of(one, source) for one in errors]


def finding_of(error: VopdError, source: str) -> Finding:
    """Make a finding of one error, as `findings_in` does."""
    if isinstance(error, InputError) and error.finding.source == source:
        return error.finding
    return Finding(str(error).removeprefix(f"{source}: "), source)


DeckError = InputError  # the earlier name of `InputError`


def strict(finding: Finding) -> None:
    """Raise errors and ignore warnings: the default report function."""
    if finding.severity == "error":
        raise InputError(finding)


def raising(keep: Report) -> Report:
    """Make a report function that raises errors and passes warnings to `keep`."""

    def report(finding: Finding) -> None:
        strict(finding)
        keep(finding)

    return report


# Sort findings into kinds, so that similar ones can be counted instead of shown.

_VARYING = r"'[^']*'|\"[^\"]*\"|[-+]?\d[\d.,]*(?:e[-+]?\d+)?"
"""What differs between the messages of one kind: quoted text and numbers."""


Kind = tuple[Severity, str, int | None, int | None, str, str]


def kind_of(finding: Finding) -> Kind:
    """Name the kind of a finding: everything but the card and the numbers in the message."""
    words = re.sub(_VARYING, "#", finding.message)
    return finding.severity, finding.source, finding.job, finding.group, finding.field, words


def first_of_each_kind(
    findings: Iterable[Finding], most: int
) -> tuple[list[Finding], list[tuple[Finding, int]]]:
    """Select the first findings of each kind, and count the others.

    Returns:
        The findings that are kept, in their order; and for each kind that has more, its last
        kept finding and the number of those left out.
    """
    seen: Counter[Kind] = Counter()
    kept: list[Finding] = []
    example: dict[Kind, Finding] = {}
    for finding in findings:
        kind = kind_of(finding)
        seen[kind] += 1
        if seen[kind] <= most:
            kept.append(finding)
            example[kind] = finding
    return kept, [(example[k], count - most) for k, count in seen.items() if count > most]


# Wrong values, and words that are not known

SHOWN = Repr()
"""Writes the beginning of a wrong value for a message: YAML of a few lines may hold gigabytes."""
SHOWN.maxstring = SHOWN.maxother = 200  # characters
SHOWN.maxlist, SHOWN.maxlevel = 12, 2


def shown(value: object) -> str:
    """Write a wrong value for a message, the beginning of it if it is long.

    Args:
        value: it, of any kind
    """
    from datetime import date, time  # of few starts

    if isinstance(value, date | time):  # of TOML
        return value.isoformat()
    try:
        return SHOWN.repr(value)
    except ValueError:  # the digits of a whole number that has thousands
        return "a whole number of thousands of digits"


def did_you_mean(word: str, known: Sequence[str]) -> str:
    """Suggest a word for a mistyped one: `; did you mean x?`, or the words that are known."""
    some = known[:MANY_WORDS]
    near = [one for one in some if _bare_word(one) == _bare_word(word)] or nearest_word(word, some)
    if not near:
        return f"; {several(known)}"
    unseen = near[0] != word and _seen(near[0]) == _seen(word)
    return f"; did you mean {near[0]}?" + " (they differ by characters that are not seen)" * unseen


def several(known: Sequence[str]) -> str:
    """List the words that are known: `known are x, y`, or the first of many."""
    more = f" and {len(known) - MANY_NAMED} more" if len(known) > MANY_NAMED else ""
    return f"known are {', '.join(known[:MANY_NAMED])}{more}"


def nearest_word(word: str, known: Iterable[str]) -> list[str]:
    """Find the known word that is most like a mistyped one: one, or none if none is like it."""
    from difflib import get_close_matches  # of few starts

    return get_close_matches(word[:LONG_WORD], [*islice(known, MANY_WORDS)], 1)


def _bare_word(word: str) -> str:
    """Write a word in small letters, as it is seen, and a number without zeros before it."""
    small = _seen(word[:LONG_WORD]).lower()
    return small.lstrip("0") if small.isdigit() else small


def _seen(word: str) -> str:
    """Leave out of a word what is not seen, such as blanks at its ends, or without width."""
    import unicodedata  # of few starts

    shown_part = (one for one in unicodedata.normalize("NFKC", word) if one.isprintable())
    return " ".join("".join(shown_part).split())


MANY_NAMED = 40  # words that are listed
MANY_WORDS = 2_000  # among which a like one is looked for: it takes 20 microseconds each
LONG_WORD = 100  # characters
