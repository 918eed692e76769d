"""Values that are too large, too deep or too many, one in a file of a good project.

Each is a sentence that names the file and ends with status 1.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.kit.command import DECKS, ROOT
from tests.kit.command import vopd as run
from tests.kit.flight_project import TOML, write_project
from tests.kit.judge import flight_commands, judge_all
from tests.kit.tagged_images import tagged_image
from vopd.flight import read as reader
from vopd.flight.files import InputFile, InputFormat
from vopd.flight.formats import landmarks as csv_landmarks
from vopd.flight.formats.landmarks import LandmarkRows
from vopd.flight.image_tags import read_tags

HILL = ROOT / "examples" / "hill"
LENS = 'lens = { model = "brown"'
LONG, LARGE = "9" * 5000, "9" * 400
HEXADECIMAL = "0x" + "f" * 5000
DEEP = "[" * 5000 + "]" * 5000
DEEP_ENOUGH = "[" * 1000 + "]" * 1000  # PyYAML takes a second and more for 5000
TOO_DEEP = "lists or tables stand in each other by the hundreds"
TOO_LONG = "a whole number has thousands of digits"


def nine(count: int, merge: bool = False) -> str:
    """YAML of 9 ** count elements, or keys that are merged, in `count` lines."""
    lines = ["a: &a {k: 1}" if merge else "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for k in range(1, count):
        of = ", ".join([f"*{chr(96 + k)}"] * 9)
        here = chr(97 + k)
        lines.append(f"{here}: &{here} " + (f"{{<<: [{of}]}}" if merge else f"[{of}]"))
    return "\n".join([*lines, ""])


HOSTILE = {  # how the name of a file ends, its text, and the sentence
    "toml lists": ("toml", f"loss = {DEEP}", f"not valid TOML: {TOO_DEEP}"),
    "toml digits": ("toml", f"loss = {LONG}", f"not valid TOML: {TOO_LONG}"),
    "toml hexadecimal": ("toml", f"loss = {HEXADECIMAL}", "of digits is not a text in quotes"),
    "json lists": ("json", f'{{"camera_matrix": {DEEP}}}', TOO_DEEP),
    "json digits": ("json", f'{{"camera_matrix": {LONG}}}', TOO_LONG),
    "json size": (
        "json",
        f'{{"image_width": {LARGE}, "image_height": 9, "camera_matrix": [1,0,1,0,1,1,0,0,1]}}',
        "a number is too large",
    ),
    "opensfm lists": ("json", f'{{"width": 1, "focal": {DEEP}}}', TOO_DEEP),
    "opensfm size": (
        "json",
        '{"a": {"width": Infinity, "height": 1, "focal": 1}}',
        "a: a camera needs width, height, focal as numbers: a number is too large",
    ),
    "mrcal lists": ("cameramodel", f'{{"lensmodel": "LENSMODEL_PINHOLE", "a": {DEEP}}}', "nested"),
    "mrcal minus": (
        "cameramodel", f'{{"lensmodel": "LENSMODEL_PINHOLE", "a": {"-" * 50000}1}}', TOO_DEEP
    ),
    "mrcal digits": ("cameramodel", f'{{"a": "LENSMODEL_", "b": {LONG}}}', TOO_LONG),
    "yaml lists": ("yml", f"camera_matrix: {DEEP_ENOUGH}", f"not valid YAML: {TOO_DEEP}"),
    "yaml digits": ("yml", f"camera_matrix: {LONG}", f"not valid YAML: {TOO_LONG}"),
    "yaml many": ("yml", f"{nine(9)}camera_matrix: *i", "a matrix has more than 100 elements"),
    "yaml merged": ("yml", f"{nine(9, True)}camera_matrix: *i", "not valid YAML"),
    "yaml in itself": ("yml", "camera_matrix: &a {data: *a}", "or of rows of numbers: one is"),
    "yaml model": (
        "yml",
        f"{nine(9)}camera_matrix: [1, 0, 1, 0, 1, 1, 0, 0, 1]\nd: []\ndistortion_model: *i",
        "distortion model [[[...], [...]",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_values(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    suffix, text, sentence = HOSTILE[name]
    shutil.copytree(HILL, tmp_path, dirs_exist_ok=True)
    project = tmp_path / "flight.toml"
    lines = project.read_text().splitlines()
    named = project.name if suffix == "toml" else f"lens.{suffix}"
    if suffix == "toml":
        lines += ["[solve]", text]
    else:
        lines = [f'lens = "{named}"' if one.startswith(LENS) else one for one in lines]
        (tmp_path / named).write_text(text)
    project.write_text("\n".join(lines))
    monkeypatch.chdir(tmp_path)
    assert judge_all(flight_commands("flight.toml")) == []
    ran = run("attitude", "flight.toml")
    assert ran.status == 1 and named in ran.stderr and sentence in ran.stderr
    assert len(ran.stderr) < 1000


@pytest.mark.parametrize("epoch", ["0001-01-01T00:00:00+14:00", "9999-12-31T23:59:59-14:00"])
def test_epochs_that_utc_does_not_have(epoch: str, tmp_path: Path) -> None:
    project = write_project(tmp_path)
    project.write_text(f"[flight]\nepoch = {epoch}\n{TOML[TOML.index('[camera]') :]}")
    ran = run("check", project)
    assert ran.status == 1 and "[flight] epoch: is a date and time with its zone" in ran.stdout


def test_files_of_picks_and_landmarks_in_json(tmp_path: Path) -> None:
    project = write_project(tmp_path)
    toml = project.read_text()
    for key, text in (
        ("picks", f'{{"shapes": {DEEP}}}'),
        ("landmarks", f'{{"type": "FeatureCollection", "features": {DEEP}}}'),
    ):
        (tmp_path / "own.json").write_text(text)
        project.write_text(toml.replace(f"{key}.csv", "own.json"))
        ran = run("attitude", project)
        assert ran.status == 1 and "own.json" in ran.stderr and TOO_DEEP in ran.stderr


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

    formats = (InputFormat("CSV", csv_landmarks.recognises_csv_landmarks, counted),)
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
