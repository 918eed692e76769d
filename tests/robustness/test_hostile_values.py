"""Costs of unusual inputs, arguments of another kind; hostile files are in kit/hostile.py."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
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
    "no figure at all": lambda: vopd.run(JOBS).plot([]),
    "one history to draw": lambda: draw("attitude", vopd.run(JOBS).histories()[0]),  # type: ignore[arg-type]
    "a run to draw": lambda: draw("attitude", vopd.run(JOBS)),
    "fixes in a list": lambda: fixes(["restart"]),
    "a rate in words": lambda: vopd.run(JOBS).histories(max_rate_deg_s="10"),
    "a rate that is true": lambda: vopd.run(JOBS).histories(max_rate_deg_s=True),
    "zero in the place of sigmas": lambda: vopd.solve_flight(HILL, sigmas=0),
}


@pytest.mark.parametrize("kind", OTHER_KINDS)
def test_arguments_of_another_kind(kind: str) -> None:
    """Python's own errors, endless recursion, and a start that was the closed form unasked."""
    with refused(vopd.VopdError):
        OTHER_KINDS[kind]()


JOB = JOBS[0]
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
}


@pytest.mark.parametrize("kind", FIELDS)
def test_jobs_of_other_fields(kind: str) -> None:
    """They ended in numpy's errors; a focal length of None went through."""
    with refused(vopd.VopdError):
        vopd.run(FIELDS[kind]())
    with pytest.raises(vopd.VopdError):
        vopd.write_deck([FIELDS[kind]()])


@pytest.mark.parametrize(("job", "kind"), [(1, IndexError), (-2, IndexError), ("1", TypeError)])
def test_a_job_that_a_run_does_not_have(job: Any, kind: type[Exception]) -> None:
    for jobs in (vopd.run(JOBS), JOBS):
        with refused(kind):
            jobs[job]
