"""Damage to an input: bytes, fields, cards, counts and the order of cards."""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

NUMBERS = """0 -0 . - + 1 -1 2 3 99 999 9999 99999 -99999 9999999 1.E30 -1.E30 1.E-30 1.E99 1.E308
1.E309 -1.E308 1.D5 1E 1E+ .5.5 12-3 NAN INF -Inf 1_0 ***** 1e400 0x10 180. -180. 90. 360. -90.
1.E10 3.E38 4. 12 13 14 100 1000 20000 300 730""".split()  # noqa: SIM905
NUMBERS.append("955462E -8")
STRANGE = [b"\0", b"\t", b"\f", b"\xff", b"\xef\xbb\xbf", b"\r", b"\x1a", b"=", b",", b'"']


def mutate(data: bytes, others: list[bytes], random: Random) -> bytes:
    """An input with one to five kinds of damage."""
    for _ in range(random.choice((1, 1, 1, 2, 3, 5))):
        data = random.choice(MUTATIONS)(data, others, random)
    return data


def some_bytes(data: bytes, others: list[bytes], random: Random) -> bytes:
    """One to eight bytes changed, left out or put in."""
    array = bytearray(data or b" ")
    for _ in range(random.randint(1, 8)):
        at = random.randrange(len(array) + 1)
        new = random.choice((bytes([random.randrange(256)]), random.choice(STRANGE), b" ", b"9"))
        array[at : at + random.randint(0, 1)] = new
    return bytes(array)


def a_number(data: bytes, others: list[bytes], random: Random) -> bytes:
    """A number of the input is another one, of the same width where that is possible."""
    found = list(re.finditer(rb"[-+.\w]+", data))
    if not found:
        return data
    match = random.choice(found)
    new = random.choice(NUMBERS).encode()
    if random.random() < 0.2 and len(match[0]) > 1:  # one character of it
        at = random.randrange(len(match[0]))
        new = match[0][:at] + random.choice(b"0123456789.-+E ").to_bytes() + match[0][at + 1 :]
    start = match.start()
    while start and len(new) > match.end() - start and data[start - 1 : start] == b" ":
        start -= 1  # a longer number takes the blanks before it
    width = match.end() - start
    new = new.rjust(width) if random.random() < 0.9 else new.ljust(width)
    return data[:start] + new + data[match.end() :]


def a_field(data: bytes, others: list[bytes], random: Random) -> bytes:
    """Some columns of a card, or of all cards of a stretch, hold another number or nothing."""
    lines = data.split(b"\n")
    first = random.randrange(len(lines))
    column, width = random.randrange(0, 80, random.choice((1, 5, 10))), random.choice((1, 2, 5, 10))
    new = random.choice(["", *NUMBERS])[:width].rjust(width).encode()
    for k in range(first, min(len(lines), first + random.choice((1, 1, 1, 3, 1000)))):
        line = lines[k].ljust(column)
        lines[k] = line[:column] + new + line[column + width :]
    return b"\n".join(lines)


def a_count(data: bytes, others: list[bytes], random: Random) -> bytes:
    """A small whole number, as the counts that say how many cards follow, is another."""
    found = list(re.finditer(rb"(?<=[ \n])\d{1,3}(?=[ \n])", data))
    if not found:
        return data
    match = random.choice(found)
    value = int(match[0])
    new = random.choice((value + 1, value - 1, 0, 2 * value, -value, 99, 999, 99999, 20000))
    text = str(new).encode()
    start = max(0, match.end() - len(text))
    if random.random() < 0.2:  # left-justified: FORTRAN reads blanks as zeros
        return data[: match.start()] + text + data[match.start() + len(text) :]
    return data[:start] + text + data[match.end() :]


def cards(data: bytes, others: list[bytes], random: Random) -> bytes:
    """Cards left out, doubled, moved, turned round, cut short, too long or blank."""
    lines = data.split(b"\n")
    first = random.randrange(len(lines))
    last = min(len(lines), first + random.choice((1, 1, 1, 2, 3, 10, 50)))
    part = lines[first:last]
    rest = lines[:first] + lines[last:]
    at = random.randrange(len(rest) + 1)
    cut = random.randrange(81)
    return b"\n".join(
        random.choice((
            rest,
            lines[:first] + part * random.choice((2, 2, 3, 40)) + lines[last:],
            rest[:at] + part + rest[at:],
            lines[:first] + part[::-1] + lines[last:],
            lines[:first] + random.sample(part, len(part)) + lines[last:],
            lines[:first] + [line[:cut] for line in part] + lines[last:],
            lines[:first] + [line.ljust(random.choice((80, 81, 200))) + b"X" for line in part]
            + lines[last:],
            lines[:first] + [b""] * len(part) + lines[last:],
        ))
    )  # fmt: skip


def spliced(data: bytes, others: list[bytes], random: Random) -> bytes:
    """The beginning of one input with the end of another, or several in a row."""
    other = random.choice(others)
    if random.random() < 0.3:
        return data + other
    lines, more = data.split(b"\n"), other.split(b"\n")
    at = random.randrange(len(lines))
    near = min(len(more), max(0, at + random.choice((0, 0, random.randint(-3, 3)))))
    return b"\n".join(lines[:at] + more[near:])


def ended(data: bytes, others: list[bytes], random: Random) -> bytes:
    """Broken off, or with other ends of lines."""
    return random.choice((
        data[: random.randrange(len(data) + 1)],
        data.replace(b"\n", b"\r\n"),
        data.replace(b"\n", b"\r"),
        data.rstrip(b"\n"),
        data.replace(b" ", b"\t", random.randint(1, 5)),
        data + b"\n" * random.choice((1, 100)),
        data + b"\x1a",
        b"\xef\xbb\xbf" + data,
        b"",
    ))  # fmt: skip


Mutation = Callable[[bytes, list[bytes], Random], bytes]
MUTATIONS: list[Mutation] = [
    *[a_number] * 6, *[a_count] * 3, *[a_field] * 3, *[cards] * 4, some_bytes, spliced, ended,
]  # fmt: skip
