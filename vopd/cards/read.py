"""Read the control cards, groups 1 to 12, and keep their values from job to job."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vopd.arrays import Floats, Ints, among
from vopd.cards.card_block import CardBlock
from vopd.cards.deck import CardDeck
from vopd.cards.format import GROUPS
from vopd.cards.group_table import GroupTable, Reading, read_list, read_table, whole
from vopd.findings import DeckError, Finding, Report
from vopd.job import Camera, Clock, Ignored, Landmarks, Trajectory, Wind

LENS_CARDS = 25

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

    def read(self, number: int) -> Reading[None]:
        """Read the cards of one group.

        Args:
            number: the group, 1 to 12

        Raises:
            DeckError: where reading cannot go on
        """
        group = GROUPS[number]
        cards = self._deck.take(self._cards_of(number), group.number)
        if group.is_list:
            yield from getattr(self, f"_list_{number}")(cards)
        else:
            if number != 2:
                self._tables[number] = yield from read_table(cards, group, self._report)
            getattr(self, f"_group_{number}", lambda _: None)(cards)
        if cards.stopped_by is not None:
            raise DeckError(cards.stopped_by)

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

    def _list_5(self, cards: CardBlock) -> Reading[None]:
        group = GROUPS[5]
        counts = yield from read_list(cards, group, 3, self._report)
        for index, name in enumerate(("NT", "NFR", "NTFR")):
            self._keep(name, int(counts[index]), cards, index)
        total = 3 + self._count["NFR"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.followed_by(self._deck.take(more, group.number))
        self._count_cards = cards
        self.frame_counts = yield from read_list(cards, group, total, self._report, skip=3)
        largest = self._limits.get("NPT", (np.inf, ""))[0]
        wrong = (self.frame_counts < 1) | (self.frame_counts > largest)
        for k in np.flatnonzero(wrong):
            self._keep("NPT", int(self.frame_counts[k]), cards, 3 + int(k))

    def _group_6(self, _: CardBlock) -> None:
        table = self._tables[6]
        self.clock = Clock(whole(table["IFRM"]), table["TIMX"])

    def _group_9(self, cards: CardBlock) -> None:
        table = self._tables[9]
        number = whole(table["ITGT"])
        columns = [table[name] for name in ("THJ", "THJMI", "PHIJ", "PHIJMI", "RJ")]
        old = getattr(self, "landmarks", None)
        if old is not None:  # what an earlier job defined stays, unless it is given again
            kept = ~among(old.number, number)
            before = (
                old.longitude_deg, old.longitude_min, old.latitude_deg, old.latitude_min,
                old.altitude_ft,
            )  # fmt: skip
            columns = [np.append(b[kept], c) for b, c in zip(before, columns, strict=True)]
            number = np.append(old.number[kept], number)
        self.landmarks = Landmarks(number, *columns)
        if "ITGT" in self._limits:
            for row, given in enumerate(whole(table["ITGT"])):
                self._keep("ITGT", int(given), cards, 0, row)

    def _list_10(self, cards: CardBlock) -> Reading[None]:
        count = yield from read_list(cards, GROUPS[10], 1, self._report)
        self._keep("NOUT", int(count[0]), cards, 0, least=0)

    def _list_12(self, cards: CardBlock) -> Reading[None]:
        total = 1 + self._count["NT"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.followed_by(self._deck.take(more, 12))
        numbers = yield from read_list(cards, GROUPS[12], total, self._report)
        out = self._tables[11]
        self.ignored = Ignored(whole(out["IFM"]), whole(out["JOUT"]), numbers[1:])
        self.return_group = int(numbers[0])
        self._return_cards = cards

    def bad_return(self) -> Finding:
        """The finding that no group has the number that the return group of group 12 names."""
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
        """Keep a count; raises `DeckError` where it is too small, or larger than its array was."""
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
        raise DeckError(finding)

    def _finding(self, cards: CardBlock, index: int, message: str, row: int = 0) -> Finding:
        """A finding about one field; in a list, `index` goes on from card to card."""
        group = GROUPS[cards.where.group or 0]
        layout = group.layout
        row, index = row + index // len(layout), index % len(layout)
        field, item = layout[index]
        if group.is_list and row > 0:
            field = group.fields[-1]
        return cards.finding(row, message, field.meaning, (item.first, item.last))


def _row(table: GroupTable, *names: str) -> Floats:
    return np.array([table[name][0] for name in names])
