"""The list of all checks: conditions in a job that the original did not report."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from vopd.cards.format import BASIC_DATA
from vopd.check import control_rules, earth_rule, film_rules
from vopd.check.card_locations import CardLocations
from vopd.findings import Finding
from vopd.job import Job

Rule = Callable[[Job, CardLocations, float | None], Iterator[Finding]]
"""Is given a job, the locations of its cards and the limit of the spread of readings, inches
(None takes it from the readings), and yields findings at the cards they are about."""

RULES: tuple[tuple[Rule, tuple[int, ...]], ...] = (
    (film_rules.reading_spread, (BASIC_DATA.number,)),
    (film_rules.copied_readings, (BASIC_DATA.number,)),
    (film_rules.fiducials, (BASIC_DATA.number,)),
    (film_rules.frame_order, (BASIC_DATA.number,)),
    (film_rules.too_few_landmarks, (5, 12, BASIC_DATA.number)),
    (film_rules.lens_reach, (1, BASIC_DATA.number)),
    (control_rules.unused_landmarks, (9,)),
    (control_rules.signs, (9,)),
    (control_rules.tables_in_order, (1, 4, 6, 7, 11, 12)),
    (control_rules.tables_span, (4, 6, 7)),
    (control_rules.altitudes, (7, 8)),
    (control_rules.ignored_all, (12,)),
    (earth_rule.earth_of_1974, (5, 6, 7, 8, 9, 11, 12, BASIC_DATA.number)),
)
"""Every rule, and the groups that must have been read anew to ask it again."""
