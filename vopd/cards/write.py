"""Write jobs as a deck of cards; reading the deck gives the same jobs."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.format import BASIC_DATA, GROUPS, FormatItem, format_items
from vopd.cards.numbers import nearest_that_fits, write_number
from vopd.cards.read import read_jobs
from vopd.cards.text import COLUMNS
from vopd.findings import InputError, VopdError, group_text, refuse_other_kind
from vopd.job import Job, checked_fields

Rows = Sequence[Sequence[float]]


def write_deck(jobs: Job | Sequence[Job]) -> str:
    """Write the card deck of one job, or of several that are stacked.

    Every number is punched so that reading it gives the same bits. A number
    that has too many digits for its columns must be rounded before.

    Args:
        jobs: one job, or several in order. Each but the first is read from the return group of the
            one before it, so what comes before that group must be the same in both.

    Returns:
        The deck as text, a card a line, without trailing blanks.

    Raises:
        VopdError: where a number does not fit its columns, with the nearest number that does;
            where a job differs from the one before it in what is not read again; or where the
            last one's return group reads on.

    Source: TM X-3050, Appendix F.
    """
    several: Sequence[Job] = jobs if isinstance(jobs, Sequence) else [jobs]
    for job in several:
        refuse_other_kind(job, Job, "vopd.write_deck", "jobs, as vopd.read_deck reads them")
    several = [*map(checked_fields, several)]
    several[:1] = map(_with_all_landmarks, several[:1])
    cards: list[str] = []
    start = 1
    for job in several:
        control = _control_cards(job)
        for number in range(start, 13):
            cards += control[number]
        if start <= 2:
            cards += basic_data_cards(job)
        start = job.return_group
    deck = "\n".join(card.rstrip() for card in cards) + "\n"
    _check(deck, several)
    return deck


def _with_all_landmarks(job: Job) -> Job:
    """Count those landmarks too that earlier jobs of a stack defined: no card before has them."""
    everywhere = job.ignored.everywhere
    padded = np.zeros(max(len(everywhere), len(job.landmarks.number)), np.int64)
    padded[: len(everywhere)] = everywhere
    return replace(job, ignored=replace(job.ignored, everywhere=padded))


def _control_cards(job: Job) -> dict[int, list[str]]:
    """Write the cards of each group."""
    camera, path, out = job.camera, job.trajectory, job.ignored
    there_before = len(job.landmarks.number) - len(out.everywhere)
    marks = job.landmarks.take(slice(there_before, None))
    mounting = np.stack([camera.multiplier, camera.offset_deg], axis=1).ravel()
    per_frame = job.readings.layout.count
    counts = [len(out.everywhere), len(per_frame), len(job.clock.frame), *per_frame]
    tables: dict[int, Rows] = {
        1: _rows(camera.lens_radius_mm, camera.lens_distortion_um),
        3: [[len(path.time_s), len(job.wind.altitude_ft), *mounting]],
        4: _rows(job.wind.altitude_ft, job.wind.velocity_ft_s),
        6: _rows(job.clock.frame, job.clock.time_s),
        7: _rows(path.time_s, path.position_ft, path.velocity_ft_s, path.altitude_ft),
        8: [
            [
                camera.focal_length_mm, path.origin_latitude_deg, path.origin_longitude_deg,
                path.origin_radius_kft, *camera.initial_deg,
            ]
        ],
        9: _rows(*marks.by_row().values()),
        11: _rows(out.frame, out.landmark),
    }  # fmt: skip
    lists = {5: counts, 10: [len(out.frame)], 12: [job.return_group, *out.everywhere]}
    cards = {number: [_card(number, row) for row in rows] for number, rows in tables.items()}
    for number, values in lists.items():
        cards[number] = [_card(number, values[k : k + 16]) for k in range(0, len(values), 16)]
    cards[2] = [job.title.ljust(COLUMNS)]
    return cards


def _rows(*columns: Floats | Ints) -> Rows:
    flat = [column[:, None] if column.ndim == 1 else column for column in columns]
    rows: Rows = np.concatenate(flat, axis=1).tolist()
    return rows


def _card(number: int, values: Sequence[float]) -> str:
    group, card = GROUPS[number], ""
    for (field, item), value in zip(group.layout, values, strict=False):
        text = write_number(value, item)
        if text is None:
            raise _does_not_fit(group.number, field.meaning, value, item)
        card = card.ljust(item.first - 1) + text
    return card


def _does_not_fit(group: int, field: str, value: float, item: FormatItem) -> VopdError:
    rounded = nearest_that_fits(value, item)
    return VopdError(
        f"{group_text(group)}, {field}: {value} does not fit in {item.width} columns"
        + (f"; {rounded}, it does" if rounded else "")
    )


def basic_data_cards(job: Job) -> list[str]:
    """Write the cards of the film reader: three for each fiducial and each landmark of every frame.

    Raises:
        VopdError: where a number does not fit its columns
    """
    readings = job.readings
    landmark_item, _, _, frame_item = format_items(BASIC_DATA.format)
    cards: list[str] = []
    for k, (frame, fiducials) in enumerate(zip(readings.frame, readings.fiducial_in, strict=True)):
        span = readings.layout.span(k)
        tail = write_number(frame, frame_item)
        if tail is None:
            raise _does_not_fit(BASIC_DATA.number, "frame number", frame, frame_item)
        tail = tail.replace(" ", "0") if frame >= 0 else tail
        numbers = [0] * 4 + readings.points.landmark[span].tolist()
        points = readings.points.landmark_in[span]
        point_readings = np.concatenate([fiducials, points]).tolist()
        for point, (number, three) in enumerate(zip(numbers, point_readings, strict=True), 1):
            if not 0 <= number <= 99:
                raise _does_not_fit(BASIC_DATA.number, "landmark number", number, landmark_item)
            kind = 1 if point <= 4 else 4
            for reading, (x, y) in enumerate(three, 1):
                head = f"{kind}0000 1 {number:02d}1 {reading:02d}{point:05d}"
                cards.append(f"{head:40}{_inches(x)}   {_inches(y)}      {tail}")
    return cards


def _inches(value: float) -> str:
    """Write a reading as the film reader punched it: in thousandths if it is whole thousandths."""
    thousandths = round(value * 1000.0) if np.isfinite(value) else 0
    if abs(thousandths) < 10**6 and thousandths / 1000.0 == value:
        return f"{'-' if np.signbit(value) else ' '}{abs(thousandths):06d}"
    item = format_items(BASIC_DATA.format)[1]
    text = write_number(value, item)
    if text is None:
        raise _does_not_fit(BASIC_DATA.number, "reading", value, item)
    return text


def _check(deck: str, jobs: Sequence[Job]) -> None:
    """Check that the deck reads back as the jobs: a return group may skip what has changed."""
    read = read_jobs(io.BytesIO(deck.encode("ascii", "replace")), "the deck")
    for number, job in enumerate(jobs, 1):
        back = next(read, None)
        for part in fields(Job):
            if back is None or getattr(back, part.name) != getattr(job, part.name):
                raise VopdError(
                    f"job {number}: {part.name.replace('_', ' ')} cannot be written in a deck"
                    + (f" after return group {jobs[number - 2].return_group}" if number > 1 else "")
                )
    try:
        next(read, None)
    except InputError as error:
        raise VopdError(
            f"job {len(jobs)}: return group {jobs[-1].return_group} reads on, and no job comes "
            "behind it: dataclasses.replace(job, return_group=13) ends the deck"
        ) from error
