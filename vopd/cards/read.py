"""Read the jobs that are stacked in a deck. Source: A 25 to A 118."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from vopd.arrays import Floats, Ints, among
from vopd.cards.deck import CardBlock, CardDeck, byte_matrix, refuse_other_file
from vopd.cards.format import BASIC_DATA, GROUPS, CardField, CardGroup, FormatItem, format_items
from vopd.cards.miscount import (
    FIDUCIAL_CARDS,
    LENS_CARDS,
    Miscount,
    find_miscount,
    find_odd_reading,
    looks_like_basic_data,
)
from vopd.cards.numbers import FEW, FieldValues, read_few, read_field
from vopd.cards.sequence import sequence_of
from vopd.cards.text import COLUMNS
from vopd.findings import Finding, InputError, Report, VopdError, count_text, strict
from vopd.inputs import no_file
from vopd.job import (
    GOES_ON,
    Camera,
    Clock,
    Ignored,
    Job,
    LandmarkReadings,
    Landmarks,
    Readings,
    Trajectory,
    Wind,
)
from vopd.landmark_layout import LandmarkLayout

# The fields of the cards of one group


def read_cards(cards: CardBlock, group: CardGroup) -> FieldValues:
    """Read every field of every card of a group (cards, fields); like fields in one go."""
    items = format_items(group.format)
    shape = len(cards), len(items)
    if len(cards) * len(items) <= FEW:
        rows = [row.tobytes().ljust(COLUMNS) for row in cards.text]
        fields = [row[item.first - 1 : item.last] for row in rows for item in items]
        value, unreadable, doubtful = read_few(fields, items * len(rows))
        return FieldValues(value.reshape(shape), unreadable.reshape(shape), doubtful.reshape(shape))
    read = FieldValues(np.zeros(shape), np.zeros(shape, bool), np.zeros(shape, bool))
    for which in group.alike:
        text = [cards.columns(items[k].first, items[k].last) for k in which]
        part = read_field(np.concatenate(text), items[which[0]])
        for all_fields, these in zip(read, part, strict=True):
            all_fields[:, list(which)] = these.reshape(len(which), len(cards)).T
    return read


# The cards of one group as columns of numbers, with a finding for every doubtful field


class GroupTable:
    """The values of a group's cards by the names of the fields."""

    def __init__(self, values: Floats, group: CardGroup) -> None:
        self._values = values
        self._columns = group.columns

    def __getitem__(self, name: str) -> Floats:
        """Look up the values of a field (cards,); of one that repeats, (cards, repeats)."""
        return np.asarray(self._values[:, self._columns[name]])


def read_table(cards: CardBlock, group: CardGroup, report: Report) -> GroupTable:
    """Read every field of every card of a group.

    Returns:
        The group's columns; NaN where a field is not a number.

    Raises:
        InputError: for what ended the block of cards early.
    """
    values = read_cards(cards, group)
    for row, k in values.questionable():
        field, item = group.layout[k]
        if field.name:
            report(_finding(cards, values, row, k, field, item))
    if cards.stopped_by is not None:
        raise InputError(cards.stopped_by)
    return GroupTable(values.value, group)


def read_list(
    cards: CardBlock, group: CardGroup, count: int, report: Report, skip: int = 0
) -> Ints:
    """Read the whole numbers of a group that goes on from card to card.

    Args:
        cards: the group's cards
        group: which group
        count: how many numbers the list has
        report: is given the findings in the order of the deck
        skip: how many numbers at the start are left out

    Returns:
        Numbers `skip` to `count` of the list (count - skip,); 0 where one is not a number.

    Raises:
        InputError: for what ended the block of cards early.
    """
    items = format_items(group.format)
    values = read_cards(cards, group)
    for row, k in values.questionable():
        index = row * len(items) + k
        if skip <= index < count:
            field = group.fields[min(index, len(group.fields) - 1)]
            report(_finding(cards, values, row, k, field, items[k]))
    if cards.stopped_by is not None:
        raise InputError(cards.stopped_by)
    return whole(values.value.ravel()[skip:count])


def whole(values: Floats) -> Ints:
    """Convert values to whole numbers; NaN becomes 0, as it has been reported before."""
    return np.where(np.isnan(values), 0.0, values).astype(np.int64)


def _finding(
    cards: CardBlock, values: FieldValues, row: int, k: int, field: CardField, item: FormatItem
) -> Finding:
    """Report a field that is unreadable, or a number in it that is doubtful."""
    punched = cards.image(row)[item.first - 1 : item.last]
    columns = item.first, item.last
    if values.unreadable[row, k]:
        kind = "a whole number" if item.kind == "I" else "a number"
        message = f"not {kind}: {punched.strip()!r}"
        return cards.finding(row, message, field.meaning, columns)
    if any(map(str.isdigit, punched)):
        message = f"blanks read as zeros: {punched!r} is {values.value[row, k]:.12g}"
    else:
        message = f"a number without digits: {punched.strip()!r} is {values.value[row, k]:.12g}"
    return cards.finding(row, message, field.meaning, columns).warned()


# The control cards, groups 1 to 12, whose values stay from job to job

LIMITS_1974: Mapping[str, tuple[int, str]] = {
    "III": (50, "IX(50)"),
    "IWV": (50, "ALT(50)"),
    "NT": (100, "IOUT(100)"),
    "NFR": (200, "NPT(200)"),
    "NTFR": (100, "IFRM(100)"),
    "NPT": (6, "IDENT(6)"),
    "NOUT": (100, "IFM(100)"),
    "ITGT": (90, "TTHJ(90)"),
}
"""Largest value of a field, and the array of 1974 that limits it. Source: A 2 to A 18."""


class ControlCards:
    """The values of groups 1 to 12; a group keeps its values until it is read again.

    The cards of the listing that read them: group 1 A 26, 2 A 28, 3 A 32, 4 A 34, 5 A 36,
    6 A 38, 7 A 42, 8 A 46, 9 A 62, 10 A 71, 11 A 73, 12 A 79; the return group is used in A 118.

    Args:
        deck: the deck that is read
        report: is given the findings
        limits: largest values of fields, `LIMITS_1974` or none
    """

    title: str
    wind: Wind
    clock: Clock
    landmarks: Landmarks
    ignored: Ignored
    return_group: int
    frame_counts: Ints  # landmarks in each frame

    def __init__(
        self, deck: CardDeck, report: Report, limits: Mapping[str, tuple[int, str]]
    ) -> None:
        self._deck = deck
        self._report = report
        self._limits = limits
        self._tables: dict[int, GroupTable] = {}
        self._count: dict[str, int] = {}

    def read(self, number: int) -> None:
        """Read the cards of one group.

        Args:
            number: the group, 1 to 12

        Raises:
            InputError: where reading cannot go on
        """
        group = GROUPS[number]
        cards = self._deck.take(self._cards_of(number), group.number)
        if group.is_list:
            getattr(self, f"_list_{number}")(cards)  # _list_5, _list_10, _list_12
        else:
            if number != 2:
                self._tables[number] = read_table(cards, group, self._report)
            # _group_2, _group_3, _group_4, _group_6, _group_9
            getattr(self, f"_group_{number}", lambda _: None)(cards)
        if cards.stopped_by is not None:
            raise InputError(cards.stopped_by)

    def _cards_of(self, number: int) -> int:
        if number == 1:
            return LENS_CARDS
        counted_by = {4: "IWV", 6: "NTFR", 7: "III", 9: "NT", 11: "NOUT"}
        return self._count[counted_by[number]] if number in counted_by else 1

    @property
    def camera(self) -> Camera:
        """The camera as groups 1, 3 and 8 describe it."""
        lens, mounting, start = self._tables[1], self._tables[3], self._tables[8]
        return Camera(
            focal_length_mm=float(start["CC"][0]),
            lens_radius_mm=lens["XRR"],
            lens_distortion_um=lens["RRR"],
            multiplier=_row(mounting, "S1M", "S2M", "S3M"),
            offset_deg=_row(mounting, "S1A", "S2A", "S3A"),
            initial_deg=_row(start, "SIG1", "SIG2", "SIG3"),
        )

    @property
    def trajectory(self) -> Trajectory:
        """The trajectory of group 7 about the origin of group 8."""
        path, origin = self._tables[7], self._tables[8]
        return Trajectory(
            time_s=path["TX"],
            position_ft=np.stack([path[name] for name in ("XXX", "YYY", "ZZZ")], axis=1),
            velocity_ft_s=np.stack([path[name] for name in ("VVX", "VVY", "VVZ")], axis=1),
            altitude_ft=path["H"],
            origin_latitude_deg=float(origin["PHI"][0]),
            origin_longitude_deg=float(origin["THZ"][0]),
            origin_radius_kft=float(origin["RZ"][0]),
        )

    # What is done with a group besides reading its table, and how its list is read

    def _group_2(self, cards: CardBlock) -> None:
        if len(cards):
            self.title = cards.image(0)

    def _group_3(self, cards: CardBlock) -> None:
        for index, name in enumerate(("III", "IWV")):
            self._keep(name, int(whole(self._tables[3][name])[0]), cards, index)

    def _group_4(self, _: CardBlock) -> None:
        table = self._tables[4]
        self.wind = Wind(table["ALT"], np.stack([table["VXO"], table["VYO"]], axis=1))

    def _list_5(self, cards: CardBlock) -> None:
        group = GROUPS[5]
        counts = read_list(cards, group, 3, self._report)
        for index, name in enumerate(("NT", "NFR", "NTFR")):
            self._keep(name, int(counts[index]), cards, index)
        total = 3 + self._count["NFR"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.followed_by(self._deck.take(more, group.number))
        self._count_cards = cards
        self.frame_counts = read_list(cards, group, total, self._report, skip=3)
        largest = self._limits.get("NPT", (np.inf, ""))[0]
        wrong = (self.frame_counts < 1) | (self.frame_counts > largest)
        for k in np.flatnonzero(wrong):
            if k and not self.frame_counts[k:].any():
                frames = count_text(self._count["NFR"], "frame")
                message = f"0: at least 1 is needed, or is NFR ({frames}) too large?"
                finding = self._finding(cards, 3 + int(k), message)
                self._report(finding)
                raise InputError(finding)
            self._keep("NPT", int(self.frame_counts[k]), cards, 3 + int(k))

    def _group_6(self, _: CardBlock) -> None:
        table = self._tables[6]
        self.clock = Clock(whole(table["IFRM"]), table["TIMX"])

    def _group_9(self, cards: CardBlock) -> None:
        table = self._tables[9]
        number = whole(table["ITGT"])
        columns = (table[name] for name in ("THJ", "THJMI", "PHIJ", "PHIJMI", "RJ"))
        landmarks, old = Landmarks(number, *columns), getattr(self, "landmarks", None)
        if old is not None:  # what an earlier job defined stays, unless it is given again
            landmarks = Landmarks.concat([old.take(~among(old.number, number)), landmarks])
        self.landmarks = landmarks
        if "ITGT" in self._limits:
            for row, given in enumerate(number):
                self._keep("ITGT", int(given), cards, 0, row)

    def _list_10(self, cards: CardBlock) -> None:
        count = read_list(cards, GROUPS[10], 1, self._report)
        self._keep("NOUT", int(count[0]), cards, 0, least=0)

    def _list_12(self, cards: CardBlock) -> None:
        total = 1 + self._count["NT"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.followed_by(self._deck.take(more, 12))
        numbers = read_list(cards, GROUPS[12], total, self._report)
        out = self._tables[11]
        self.ignored = Ignored(whole(out["IFM"]), whole(out["JOUT"]), numbers[1:])
        self.return_group = int(numbers[0])
        self._return_cards = cards

    def bad_return(self) -> Finding:
        """Report that no group has the number of the return group of group 12."""
        message = f"{self.return_group} is not a return group (1 to 12, or 13 to stop)"
        return self._finding(self._return_cards, 0, message)

    def count_finding(self, index: int, message: str) -> Finding:
        """Make a finding about one number of group 5.

        Args:
            index: which number of the list, from 0
            message: what is wrong
        """
        return self._finding(self._count_cards, index, message)

    def _keep(
        self, name: str, value: int, cards: CardBlock, index: int, row: int = 0, least: int = 1
    ) -> None:
        """Keep a count; raises `InputError` where it is too small, or larger than its array was."""
        self._count[name] = value
        largest, array = self._limits.get(name, (None, ""))
        if value < least:
            message = f"{value}: at least {least} is needed"
        elif largest is not None and value > largest:
            message = f"{value}: the original's array {array} takes {largest} at most"
        else:
            return
        finding = self._finding(cards, index, message, row)
        self._report(finding)
        raise InputError(finding)

    def _finding(self, cards: CardBlock, index: int, message: str, row: int = 0) -> Finding:
        """Make a finding about one field; in a list, `index` goes on from card to card."""
        group = GROUPS[cards.where.group or 0]
        layout = group.layout
        row, index = row + index // len(layout), index % len(layout)
        field, item = layout[index]
        if group.is_list and row > 0:
            field = group.fields[-1]
        return cards.finding(row, message, field.meaning, (item.first, item.last))


def _row(table: GroupTable, *names: str) -> Floats:
    return np.array([table[name][0] for name in names])


# The basic data: three readings of every point of every frame

CARDS_AT_A_TIME = 24_000
POINT_CARDS = 3  # cards of another frame that show a wrong count, and not a mispunched number
_LANDMARK, _X, _Y, _FRAME = format_items(BASIC_DATA.format)
_LANDMARK_FIELD = "landmark number", (_LANDMARK.first, _LANDMARK.last)
_FRAME_FIELD = "frame number", (_FRAME.first, _FRAME.last)


def read_basic_data(
    deck: CardDeck, landmarks_per_frame: Ints, defined: Ints, report: Report
) -> Readings:
    """Read the basic data of a deck.

    Args:
        deck: the deck, which has come to the first card of the basic data
        landmarks_per_frame: how many landmarks group 5 counts in each frame (F,)
        defined: the landmark numbers that group 9 has defined so far
        report: is given the findings

    Returns:
        The readings of all frames.

    Raises:
        InputError: where the cards contradict the counts, so that the next frame cannot be found,
            or where the deck ends early.
    """
    parts: list[Readings] = []
    for counts in _portions(landmarks_per_frame):
        cards = deck.take(int((FIDUCIAL_CARDS + 3 * counts).sum()), BASIC_DATA.number)
        parts.append(_read_frames(cards, counts, defined, report))
    _look_for_more(deck, int(parts[-1].frame[-1]), int(landmarks_per_frame[-1]), report)
    first_card: dict[int, Finding] = {}
    for part in reversed(parts):
        first_card |= part.first_card
    return replace(Readings.concat(parts), first_card=first_card)


def _portions(counts: Ints) -> list[Ints]:
    """Divide the counts of frames into portions of about `CARDS_AT_A_TIME` cards."""
    portion = np.cumsum(FIDUCIAL_CARDS + 3 * counts) // CARDS_AT_A_TIME
    return np.split(counts, np.flatnonzero(np.diff(portion)) + 1)


def _read_frames(cards: CardBlock, counts: Ints, defined: Ints, report: Report) -> Readings:
    """Read frames from their cards, as far as there are cards."""
    if cards.stopped_by is not None:
        if cards.stopped_by.image is None:  # the deck ends
            _blame_card(cards, counts)
        _check_counts_so_far(cards, counts, report)
    table = read_table(cards, BASIC_DATA, report)
    number, frame = whole(table["ISAVE"]), whole(table["IFRAM"])
    xy = np.stack([table["XSAVE"], table["YSAVE"]], axis=1)
    sizes = FIDUCIAL_CARDS + 3 * counts
    ends = np.cumsum(sizes)
    starts = ends - sizes
    fiducial_rows = starts[:, None] + np.arange(FIDUCIAL_CARDS)
    is_fiducial = np.zeros(len(cards), bool)
    is_fiducial[fiducial_rows] = True
    reading_rows = np.flatnonzero(~is_fiducial).reshape(-1, 3)  # (landmark, reading), in order

    _check_frames(cards, frame, starts, counts, report)
    three = number[reading_rows]
    if (three != three[:, 2:]).any():
        _blame_card(cards, counts)
    _check_numbers(cards, number, fiducial_rows.ravel(), reading_rows, report)
    return Readings(
        LandmarkLayout(counts),
        LandmarkReadings(
            landmark=number[reading_rows[:, 2]],  # the third reading counts
            landmark_in=xy[reading_rows],
        ),
        frame=frame[ends - 1],
        fiducial_in=xy[fiducial_rows].reshape(-1, 4, 3, 2),
        first_card=_first_cards(cards, number[reading_rows[:, 0]], reading_rows[:, 0], defined),
    )


def _check_counts_so_far(cards: CardBlock, counts: Ints, report: Report) -> None:
    """Look for the frame whose count is the reason that the deck ends too early."""
    column = read_field(cards.columns(_FRAME.first, _FRAME.last), _FRAME)
    starts = np.cumsum(FIDUCIAL_CARDS + 3 * counts) - (FIDUCIAL_CARDS + 3 * counts)
    begun = starts < len(cards)
    _check_frames(cards, whole(column.value), starts[begun], counts[begun], report, odd_ones=False)


def _check_frames(
    cards: CardBlock,
    frame: Ints,
    starts: Ints,
    counts: Ints,
    report: Report,
    *,
    odd_ones: bool = True,
) -> None:
    """Compare the frame numbers of each frame's cards, which must all be the same.

    One or two odd cards are reported as mispunched, if `odd_ones` asks for it. Three make a
    point, so that a count must be wrong: reading cannot go on. Raises `InputError` then.
    """
    ends = np.minimum(starts + FIDUCIAL_CARDS + 3 * counts, len(frame))
    whose = np.repeat(frame[ends - 1], ends - starts)
    different = np.flatnonzero(frame[: len(whose)] != whose)
    if not len(different):
        return
    _blame_card(cards, counts)
    for k in sorted(set((np.searchsorted(starts, different, side="right") - 1).tolist())):
        own = frame[starts[k] : ends[k]]
        usual = _most_frequent(own)
        if np.count_nonzero(own != usual) >= POINT_CARDS:
            before = int(frame[starts[k] - 1]) if k else None
            row, message = _wrong_count(own, int(counts[k]), before)
            if before == own[0]:
                message += f", for which group 5 counts {count_text(counts[k - 1], 'landmark')}"
            finding = cards.finding(int(starts[k]) + row, message, *_FRAME_FIELD)
            report(finding)
            raise InputError(finding)
        if odd_ones:
            row = int((own != usual).argmax())
            message = f"frame {own[row]} among the cards of frame {usual}"
            report(cards.finding(int(starts[k]) + row, message, *_FRAME_FIELD))


def _blame_card(cards: CardBlock, counts: Ints) -> None:
    """Raise `Miscount` if one card too few or too many puts the frames out of step."""
    cause = find_odd_reading(cards, counts)
    if cause is not None:
        raise Miscount(cause)


def _wrong_count(own: Ints, count: int, before: int | None) -> tuple[int, str]:
    """Find the first card that shows a wrong count of group 5: its index, and what is wrong."""
    if own[0] == before:
        return 0, f"a further card of frame {before}"
    row = int((own != own[0]).argmax())
    landmarks = count_text(count, "landmark")
    return row, f"a card of frame {own[row]}, where group 5 counts {landmarks} for frame {own[0]}"


def _most_frequent(numbers: Ints) -> int:
    """Find the most frequent of some numbers; the smallest of several."""
    values, times = np.unique(numbers, return_counts=True)
    return int(values[times.argmax()])


def _check_numbers(
    cards: CardBlock, number: Ints, fiducials: Ints, readings: Ints, report: Report
) -> None:
    """Check the numbers of landmarks, alike in three readings, and of fiducials, which are 0."""
    for row in fiducials[number[fiducials] != 0]:
        message = f"landmark {number[row]} on a card that should be a fiducial's (00)"
        report(cards.finding(int(row), message, *_LANDMARK_FIELD).warned())
    three = number[readings]
    for rows in readings[(three != three[:, 2:]).any(axis=1)]:
        first, second, third = number[rows]
        odd = rows[0] if second == third else rows[1] if first == third else rows[2]
        message = f"three readings of one landmark are numbered {first}, {second}, {third}"
        report(cards.finding(int(odd), message, *_LANDMARK_FIELD))


def _first_cards(cards: CardBlock, number: Ints, rows: Ints, defined: Ints) -> dict[int, Finding]:
    """Find where each landmark that group 9 has not defined is first read."""
    undefined = np.flatnonzero(~among(number, defined))
    if not len(undefined):
        return {}
    found, at = np.unique(number[undefined], return_index=True)
    return {
        int(n): cards.finding(
            int(rows[undefined[k]]), f"landmark {n} is not defined in group 9", *_LANDMARK_FIELD
        )
        for n, k in zip(found, at, strict=True)
    }


def _look_for_more(deck: CardDeck, frame: int, count: int, report: Report) -> None:
    """Report a further landmark card of the last frame: group 5 counts too few landmarks."""
    card = deck.next_card(BASIC_DATA.number)
    if not len(card):
        return
    items = format_items(BASIC_DATA.format)
    fields = [read_field(card.columns(item.first, item.last), item) for item in items]
    punched = [card.columns(item.first, item.last) for item in (_X, _Y, _FRAME)]
    if any(field.unreadable[0] for field in fields) or any((text == 32).all() for text in punched):
        return
    if fields[3].value[0] == frame and fields[0].value[0] != 0:
        counted = count_text(count, "landmark")
        message = f"group 5 counts {counted} for frame {frame}, and here is one more"
        report(card.finding(0, message, *_FRAME_FIELD))


# The jobs that are stacked in a deck (A 25 to A 118)

STOP = 13
LAST_CARD = sys.maxsize
LOOKED_AT = 400  # cards behind an error among which a miscount is looked for


@contextmanager
def open_deck(path: str | Path) -> Iterator[BinaryIO]:
    """Open a deck for reading.

    Args:
        path: the deck's file; `-` is standard input

    Raises:
        VopdError: where the file cannot be opened.
    """
    if str(path) == "-":
        yield sys.stdin.buffer  # not ours to close
        return
    if kind := no_file(path, pipes=True):
        raise VopdError(f"{path}: {kind}")
    try:
        file = open(path, "rb")  # noqa: PTH123, SIM115 (closed below; only opening may fail so)
    except IsADirectoryError as error:
        message = "is a folder, without a project flight.toml; vopd new writes one, and vopd batch"
        message += " takes all decks and projects of a folder"
        if Path(path, "flight.toml").is_file():
            message = "is a folder with a flight project, not a deck of 80-column cards; vopd "
            message += "attitude, plot, report and check take it"
        raise VopdError(f"{path}: {message}") from error
    except OSError as error:
        raise VopdError(f"{path}: {error.strerror}") from error
    with file:
        yield file


def read_jobs(
    file: BinaryIO,
    name: str,
    report: Report = strict,
    *,
    limits_1974: bool = False,
    on_cards: Callable[[CardBlock], object] = lambda _: None,
) -> Iterator[Job]:
    """Read the jobs of a deck one by one, each when it is asked for.

    What is wrong with a later job is found only when that job is read, so that
    the pages of the jobs before it can be printed first.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        report: is given every finding; by default errors are raised and warnings are dropped
        limits_1974: whether a deck that exceeds the original's array sizes is an error
        on_cards: is called with every block of cards that is read

    Yields:
        The jobs in the order of the deck.

    Raises:
        InputError: where a card cannot be read, or reading cannot go on.
        VopdError: where the file is empty or is not a deck.
    """
    control_cards: list[CardBlock] = []  # of the job that is being read

    def keep(cards: CardBlock) -> None:
        if cards.where.group != BASIC_DATA.number:
            control_cards.append(cards)
        on_cards(cards)

    deck = CardDeck(file, name, report, keep)
    if deck.at_end():
        raise VopdError(f"{name}: the deck is empty")
    refuse_other_file(deck.next_bytes(), name)
    control = ControlCards(deck, report, LIMITS_1974 if limits_1974 else {})
    stored: Readings | None = None
    group = 1
    while group != STOP:
        if group <= 2:
            stored = None
        control_cards.clear()
        for number in range(group, 13):
            if number == 2 and deck.at_end():
                return
            try:
                control.read(number)
            except InputError as error:
                if stored is None:
                    _blame_count(control_cards, deck, error)
                raise
            if number == 1:
                _warn_of_sequence(control_cards[-1], report)
            if number == 5 and stored is not None:
                _check_stored(stored, control, report)
        if stored is None:
            if _out_of_step(control_cards[-1], deck):
                _blame_count(control_cards, deck)
            counts, defined = control.frame_counts, control.landmarks.number
            stored = read_basic_data(deck, counts, defined, report)
        yield _job(control, stored)
        group = control.return_group
        if not 1 <= group <= STOP:
            raise InputError(control.bad_return())
    if not deck.at_end():
        message = f"{GOES_ON} (return group {STOP})"
        if looks_like_basic_data(deck.next_card(BASIC_DATA.number).text).any():
            frames = count_text(len(control.frame_counts), "frame")
            message += f": readings of a further frame, where group 5 counts {frames}"
        else:
            message += "; NGO = 1 reads a further whole deck, 3 to 12 its cards from that group on"
        report(Finding(message, name, deck.taken + 1, severity="warning"))


def _out_of_step(last: CardBlock, deck: CardDeck) -> bool:
    """Tell whether the film's readings begin before the end of group 12, or not behind it."""
    follows = deck.next_card(BASIC_DATA.number).text
    begun = looks_like_basic_data(last.text[-1:])
    return bool(begun.any() or not looks_like_basic_data(follows).any())


def _blame_count(
    control_cards: list[CardBlock], deck: CardDeck, error: InputError | None = None
) -> None:
    """Raise `Miscount` if a group with a card too few or too many explains what was read."""
    first = control_cards[0]
    start = first.where.group or 0
    rows = [row.tobytes() for cards in control_cards for row in cards.text]
    rows += [row.tobytes() for row in deck.following(LOOKED_AT)]
    cause = find_miscount(byte_matrix(rows), first.first, start, deck.name)
    before = error.finding.card if error is not None else None
    if cause is not None and (before or LAST_CARD) >= (cause.card or 0):
        raise Miscount(cause) from error


def _warn_of_sequence(cards: CardBlock, report: Report) -> None:
    """Warn of sequence numbers in columns 73 to 80 of group 1, which the program never reads."""
    if numbers := sequence_of(cards.text):
        message = (
            f"sequence numbers ({numbers.example}): the program reads columns 73 to 80 as data in "
            "the title and groups 5, 7 and 12; vopd cards --strip-sequence writes the deck without"
        )
        report(cards.finding(0, message, "", (73, 80), "warning"))


def _job(control: ControlCards, stored: Readings) -> Job:
    """Make the job that the cards in force describe."""
    return Job(
        title=control.title,
        camera=control.camera,
        trajectory=control.trajectory,
        wind=control.wind,
        clock=control.clock,
        landmarks=control.landmarks,
        ignored=control.ignored,
        readings=_first_frames(stored, len(control.frame_counts)),
        return_group=control.return_group,
    )


def _check_stored(stored: Readings, control: ControlCards, report: Report) -> None:
    """Check group 5 of a later job, which may only leave out frames at the end.

    Raises `InputError` for more frames than are stored, or other numbers of landmarks.
    """
    counts = control.frame_counts
    if len(counts) > len(stored.frame):
        message = f"{count_text(len(counts), 'frame')}, but only {len(stored.frame)} have been read"
        finding = control.count_finding(1, message)
        report(finding)
        raise InputError(finding)
    for k in (counts != stored.layout.count[: len(counts)]).nonzero()[0]:
        have = int(stored.layout.count[k])
        counted = f"{count_text(counts[k], 'landmark')} in frame {stored.frame[k]}"
        message = f"{counted}, but {have} have been read"
        finding = control.count_finding(3 + int(k), message)
        report(finding)
        raise InputError(finding)


def _first_frames(stored: Readings, count: int) -> Readings:
    """Take the frames of this job; the other readings stay stored for the jobs after it."""
    return stored if count == len(stored.frame) else stored.take(slice(count))
