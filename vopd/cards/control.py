"""The control cards, groups 1 to 12, into what the program keeps of them (A 25 to A 82)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.card import CardDeck, Cards
from vopd.cards.groups import GROUPS
from vopd.cards.table import Table, read_list, read_table, whole
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
"""Field to the largest value its array takes, and that array (A 2 to A 18)."""


class ControlCards:
    """The control cards in force: each group read stays until it is read again."""

    title: str
    wind: Wind
    clock: Clock
    landmarks: Landmarks
    ignored: Ignored
    return_group: int
    frame_counts: Ints  # landmarks in each frame

    def __init__(self, deck: CardDeck, report: Report, limits: Mapping[str, tuple[int, str]]):
        self._deck = deck
        self._report = report
        self._limits = limits
        self._tables: dict[int, Table] = {}
        self._count: dict[str, int] = {}

    def read(self, number: int) -> None:
        """Read one group and take in what it says."""
        group = GROUPS[number]
        cards = self._deck.take(self._cards_of(number), group.number)
        if not group.is_list and number != 2:
            self._tables[number] = read_table(cards, group, self._report)
        getattr(self, f"_group_{number}", lambda _: None)(cards)
        if cards.trouble is not None:
            raise DeckError(cards.trouble)

    def _cards_of(self, number: int) -> int:
        if number == 1:
            return LENS_CARDS
        counted_by = {4: "IWV", 6: "NTFR", 7: "III", 9: "NT", 11: "NOUT"}
        return self._count[counted_by[number]] if number in counted_by else 1

    @property
    def camera(self) -> Camera:
        lens, mounting, guess = self._tables[1], self._tables[3], self._tables[8]
        return Camera(
            focal_length_mm=float(guess["CC"][0]),
            lens_radius_mm=lens["XRR"],
            lens_distortion_um=lens["RRR"],
            multiplier=_row(mounting, "S1M", "S2M", "S3M"),
            offset_deg=_row(mounting, "S1A", "S2A", "S3A"),
            initial_deg=_row(guess, "SIG1", "SIG2", "SIG3"),
        )

    @property
    def trajectory(self) -> Trajectory:
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

    # What a group says beyond its table

    def _group_2(self, cards: Cards) -> None:
        if len(cards):
            self.title = cards.image(0)

    def _group_3(self, cards: Cards) -> None:
        for place, name in enumerate(("III", "IWV")):
            self._keep(name, int(whole(self._tables[3][name])[0]), cards, place)

    def _group_4(self, _: Cards) -> None:
        table = self._tables[4]
        self.wind = Wind(table["ALT"], np.stack([table["VXO"], table["VYO"]], axis=1))

    def _group_5(self, cards: Cards) -> None:
        group = GROUPS[5]
        counts = read_list(cards, group, 3, self._report)
        for place, name in enumerate(("NT", "NFR", "NTFR")):
            self._keep(name, int(counts[place]), cards, place)
        total = 3 + self._count["NFR"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.then(self._deck.take(more, group.number))
        self._count_cards = cards
        self.frame_counts = read_list(cards, group, total, self._report, skip=3)
        largest = self._limits.get("NPT", (np.inf, ""))[0]
        wrong = (self.frame_counts < 1) | (self.frame_counts > largest)
        for k in np.flatnonzero(wrong):
            self._keep("NPT", int(self.frame_counts[k]), cards, 3 + int(k))

    def _group_6(self, _: Cards) -> None:
        table = self._tables[6]
        self.clock = Clock(whole(table["IFRM"]), table["TIMX"])

    def _group_9(self, cards: Cards) -> None:
        table = self._tables[9]
        number = whole(table["ITGT"])
        columns = [table[name] for name in ("THJ", "THJMI", "PHIJ", "PHIJMI", "RJ")]
        old = getattr(self, "landmarks", None)
        if old is not None:  # what an earlier job defined stays, unless it is given again
            kept = ~np.isin(old.number, number)
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

    def _group_10(self, cards: Cards) -> None:
        count = int(read_list(cards, GROUPS[10], 1, self._report)[0])
        self._keep("NOUT", count, cards, 0, least=0)

    def _group_12(self, cards: Cards) -> None:
        total = 1 + self._count["NT"]
        more = -(-total // 16) - 1
        if more > 0:
            cards = cards.then(self._deck.take(more, 12))
        numbers = read_list(cards, GROUPS[12], total, self._report)
        out = self._tables[11]
        self.ignored = Ignored(whole(out["IFM"]), whole(out["JOUT"]), numbers[1:])
        self.return_group = int(numbers[0])
        self._return_cards = cards

    def bad_return(self) -> Finding:
        """The remark that the return group is none."""
        message = f"no return group: {self.return_group} (1 to 12, or 13 to stop)"
        return self._finding(self._return_cards, 0, message)

    def count_finding(self, place: int, message: str) -> Finding:
        """A remark about a count of group 5, by its place in the list."""
        return self._finding(self._count_cards, place, message)

    def _keep(
        self, name: str, value: int, cards: Cards, place: int, row: int = 0, least: int = 1
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
        finding = self._finding(cards, place, message, row)
        self._report(finding)
        raise DeckError(finding)

    def _finding(self, cards: Cards, place: int, message: str, row: int = 0) -> Finding:
        """A remark about field `place` of a group, counted on from card to card in a list."""
        group = GROUPS[cards.where.group or 0]
        layout = group.layout()
        row, place = row + place // len(layout), place % len(layout)
        field, item = layout[place] if row == 0 else (group.fields[-1], layout[place][1])
        if not group.is_list:
            field = layout[place][0]
        return cards.finding(row, message, field.meaning, (item.first, item.last))


def _row(table: Table, *names: str) -> Floats:
    return np.array([table[name][0] for name in names])
