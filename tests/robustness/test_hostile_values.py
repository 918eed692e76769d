"""Costs of unusual inputs, arguments of another kind; hostile files are in kit/hostile.py."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit.command import CASE_4, DECKS, ROOT
from tests.kit.flight_project import write_project
from tests.kit.tagged_images import tagged_image
from vopd.errata import fixes
from vopd.figures import draw
from vopd.flight.formats import landmarks as csv_landmarks
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.image_tags import read_tags
from vopd.flight.formats.landmarks import LandmarkRows
from vopd.flight.project import read as reader
from vopd.job import SHAPES


class CountedName(str):
    """A name that counts how often it is compared."""

    __slots__ = ()
    compared = 0

    def __eq__(self, other: object) -> bool:
        CountedName.compared += 1
        return str.__eq__(self, other)

    __hash__ = str.__hash__


def test_each_landmark_is_looked_up_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """50,000 landmarks took 21 s, each compared with all others."""
    project = write_project(tmp_path)
    with (tmp_path / "landmarks.csv").open("a") as file:
        file.writelines(f"more{k},48,15,300\n" for k in range(2000))

    def counted(file: InputFile) -> LandmarkRows:
        rows = csv_landmarks.read_csv_landmarks(file)
        return replace(rows, name=[CountedName(name) for name in rows.name])

    formats = (InputFormat("CSV", csv_landmarks.recognises_csv_landmarks, counted, True),)
    monkeypatch.setattr(reader, "LANDMARK_FORMATS", formats)
    assert len(reader.read_flight(str(project)).landmarks.name) > 2000
    assert CountedName.compared < 20_000


def test_images_of_more_pixels_than_pillow_decodes(tmp_path: Path) -> None:
    """16,000 by 12,000 pixels are 192 megapixels; Pillow refuses above 179, here by the header."""
    path = tmp_path / "a.jpg"
    tagged_image(path, (48, 0, 0.0), (15, 0, 0.0), altitude_m=300.0)
    content = path.read_bytes()
    start = content.rindex(b"\xff\xc0") + 5  # the frame's header: height and width
    size = (12_000).to_bytes(2, "big") + (16_000).to_bytes(2, "big")
    path.write_bytes(content[:start] + size + content[start + 4 :])
    tags = read_tags(path)
    assert tags.size_px == (16_000, 12_000) and tags.position == (15.0, 48.0, 300.0)


def test_warnings_of_a_run_load_no_masked_arrays() -> None:
    """np.unique did, which took 8 ms of each run with a warning."""
    script = (
        "import sys\n"
        "from vopd.cli import cli\n"
        "try:\n"
        f"    cli(['run', {str(DECKS / 'regression' / 'restart.dat')!r}])\n"
        "finally:\n"
        "    print('numpy.ma' in sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT)
    *said, loaded = done.stderr.splitlines()
    assert any(line.startswith("warning:") for line in said) and loaded == "False"


JOBS = vopd.read_deck(CASE_4)
HILL = ROOT / "examples" / "hill" / "flight.toml"
OTHER_KINDS: dict[str, Callable[[], object]] = {
    "a name with a null character": lambda: vopd.read_deck("a\0b"),
    "a name with half a character": lambda: vopd.run("\ud800"),
    "a name that is too long": lambda: vopd.run("a" * 300),
    "a project whose name is too long": lambda: vopd.solve_flight("a" * 300),
    "a deck in the place of its path": lambda: vopd.read_deck(JOBS),
    "several paths": lambda: vopd.run([str(CASE_4)] * 2),
    "a run in the place of jobs": lambda: vopd.run(vopd.run(JOBS)),
    "names of fixes": lambda: vopd.run(JOBS, ["restart"]),
    "another start": lambda: vopd.run(JOBS, initial="closed form"),
    "a path in the place of results": lambda: vopd.listing_text("x.dat"),
    "no results": lambda: vopd.listing_text(None),
    "a path in the place of jobs": lambda: vopd.write_deck("x.dat"),
    "a job before the first": lambda: JOBS.chosen(-1),
    "a deck to adjust": lambda: vopd.adjust(JOBS, "focal"),
    "sigmas of a flight by name": lambda: vopd.solve_flight("x", sigmas={"reading": 1}),
    "one sigma of a history": lambda: vopd.run(JOBS).histories(1.0),
    "a sigma in words": lambda: vopd.Sigmas(reading="1 px"),
    "a sigma that is true": lambda: vopd.Sigmas(reading=True),
    "a sigma of hundreds of digits": lambda: vopd.Sigmas(mount_deg=10**400),
    "no sigma of landmarks": lambda: vopd.Sigmas(landmark=None),
    "bytes in the place of a path": lambda: vopd.run(b"case4.dat"),
    "a folder without a project": lambda: vopd.run(ROOT / "decks" / "appendix_h"),
    "nothing to free": lambda: vopd.adjust(HILL, None),
    "numbers to free": lambda: vopd.adjust(HILL, [3]),
    "bytes to free": lambda: vopd.adjust(HILL, b"focal"),
    "a number in the place of a function": lambda: vopd.adjust(HILL, "focal", 5),
    "a location by number": lambda: vopd.solve_flight(HILL, 5),
    "no name of a figure": lambda: vopd.run(JOBS).plot(None),
    "a width in words": lambda: vopd.run(JOBS).summary("wide"),
    "no figure at all": lambda: vopd.run(JOBS).plot([]),
    "one history to draw": lambda: draw("attitude", vopd.run(JOBS).histories()[0]),  # type: ignore[arg-type]
    "a run to draw": lambda: draw("attitude", vopd.run(JOBS)),
    "fixes in a list": lambda: fixes(["restart"]),
    "a rate in words": lambda: vopd.run(JOBS).histories(max_rate_deg_s="10"),
    "a rate that is true": lambda: vopd.run(JOBS).histories(max_rate_deg_s=True),
    "a start in words": lambda: vopd.run(JOBS, start_deg=[["a", "b", "c"]]),  # type: ignore[list-item]
    "starts of several lengths": lambda: vopd.run(JOBS, start_deg=[[1, 2], [3]]),  # type: ignore[list-item]
    "a masked start": lambda: vopd.run(JOBS, start_deg=np.ma.masked_less([[1.0, 2.0, 3.0]], 2.0)),
    "zero in the place of sigmas": lambda: vopd.solve_flight(HILL, sigmas=0),
}


@pytest.mark.parametrize("kind", OTHER_KINDS)
def test_arguments_of_another_kind(kind: str) -> None:
    """Python's own errors, endless recursion, and a start that was the closed form unasked."""
    with refused(vopd.VopdError):
        OTHER_KINDS[kind]()


JOB = JOBS[0]
FRAMES, FIDUCIALS = JOB.readings.frame, JOB.readings.fiducial_in
FIELDS: dict[str, Callable[[], vopd.Job]] = {
    "no trajectory": lambda: replace(JOB, trajectory=None),
    "a camera in words": lambda: replace(JOB, camera="16 mm"),
    "no title": lambda: replace(JOB, title=None),
    "no focal length": lambda: replace(JOB, camera=replace(JOB.camera, focal_length_mm=None)),
    "a focal length in words": lambda: replace(
        JOB, camera=replace(JOB.camera, focal_length_mm="10.4")
    ),
    "two angles": lambda: replace(JOB, camera=replace(JOB.camera, initial_deg=np.zeros(2))),
    "times without positions": lambda: replace(
        JOB, trajectory=replace(JOB.trajectory, time_s=np.zeros(2))
    ),
    "angles in words": lambda: replace(
        JOB, camera=replace(JOB.camera, offset_deg=np.array(["a", "b", "c"]))
    ),
    "no points": lambda: replace(JOB, readings=replace(JOB.readings, points=None)),
    "half a frame": lambda: replace(JOB, readings=replace(JOB.readings, frame=FRAMES + 0.5)),
    "a frame that is none": lambda: replace(
        JOB, readings=replace(JOB.readings, frame=np.full(len(FRAMES), np.nan))
    ),
    "a masked height": lambda: replace(
        JOB, wind=replace(JOB.wind, altitude_ft=np.ma.masked_less(JOB.wind.altitude_ft, 1e9))
    ),
    "points without their frames": lambda: replace(
        JOB, readings=replace(JOB.readings, points=JOB.readings.points.take(slice(1)))
    ),
    "a title of other letters": lambda: replace(JOB, title="1 Überflug"),
    "a title of two lines": lambda: replace(JOB, title="1 ONE\n2"),
    "a title of 81 columns": lambda: replace(JOB, title="1" * 81),
    "a return group in words": lambda: replace(JOB, return_group="13"),
    "a return group of 0": lambda: replace(JOB, return_group=0),
    "a return group of 14": lambda: replace(JOB, return_group=14),
    "frames without their points": lambda: replace(
        JOB, readings=replace(JOB.readings, frame=FRAMES[:1], fiducial_in=FIDUCIALS[:1])
    ),
}


@pytest.mark.parametrize("kind", FIELDS)
def test_jobs_of_other_fields(kind: str) -> None:
    """They ended in numpy's errors; a focal length of None went through."""
    with refused(vopd.VopdError):
        vopd.run(FIELDS[kind]())
    with pytest.raises(vopd.VopdError):
        vopd.write_deck([FIELDS[kind]()])


STORED: dict[str, Callable[[Any], Any]] = {
    "another byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "more bytes": lambda a: a.astype(np.longdouble),
    "columns first": np.asfortranarray,
    "every second": lambda a: np.repeat(a, 2, axis=0)[::2],
    "nothing masked": np.ma.masked_array,
}


@pytest.mark.parametrize("how", STORED)
@pytest.mark.parametrize("name", SHAPES)
def test_numbers_of_a_job_stored_in_another_way_are_the_same_numbers(name: str, how: str) -> None:
    """More bytes ended in numpy's errors, or moved the last digits."""
    part, _, own = name.rpartition(".")
    value = np.atleast_1d(getattr(attrgetter(part)(JOB), own))
    stored = STORED[how](value)
    other = replaced(JOB, name, stored if SHAPES[name] else stored[0])
    assert (run := vopd.run(other)).camera_deg.tobytes() == vopd.run(JOB).camera_deg.tobytes()
    assert run[0].job == JOB and vopd.write_deck(other) == vopd.write_deck(JOB)


def replaced(record: Any, name: str, value: Any) -> Any:
    own, _, rest = name.partition(".")
    return replace(record, **{own: replaced(getattr(record, own), rest, value) if rest else value})


def test_angles_in_four_bytes_are_those_numbers() -> None:
    """Numpy's error, as two forms of a first estimate were compared byte by byte."""
    camera = replace(JOB.camera, initial_deg=JOB.camera.initial_deg.astype(np.float32))
    same = replace(JOB.camera, initial_deg=camera.initial_deg.astype(np.float64))
    angles = [vopd.run(replace(JOB, camera=one)).camera_deg for one in (camera, same)]
    assert angles[0].tobytes() == angles[1].tobytes()


@pytest.mark.parametrize("part", ["fiducial_in", "landmark_in"])
def test_a_reading_that_is_no_number_is_on_no_card(part: str) -> None:
    """Python's own error, of a whole number."""
    readings = JOB.readings
    if part == "fiducial_in":
        wrong = replace(readings, fiducial_in=np.full_like(FIDUCIALS, np.nan))
    else:
        none = np.full_like(readings.points.landmark_in, np.inf)
        wrong = replace(readings, points=replace(readings.points, landmark_in=none))
    with refused(vopd.VopdError):
        vopd.write_deck(replace(JOB, readings=wrong))


@pytest.mark.parametrize(("job", "kind"), [(1, IndexError), (-2, IndexError), ("1", TypeError)])
def test_a_job_that_a_run_does_not_have(job: Any, kind: type[Exception]) -> None:
    for jobs in (vopd.run(JOBS), JOBS):
        with refused(kind):
            jobs[job]
