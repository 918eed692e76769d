"""The project file: its sections and keys, each kind of value, and what is said of a wrong one."""

from __future__ import annotations

import re
from datetime import UTC, date, datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest

from vopd.findings import VopdError
from vopd.flight.files import InputFile, InputFormat
from vopd.flight.project import KEYS, Project, Section, epoch_of, read_project


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refused:
        action()
    return str(refused.value)


def test_every_section_and_key() -> None:
    expected = {
        "flight": "name epoch",
        "camera": "lens model camera pixel_grid image_size_px",
        "picks": "file pixel_grid v sigma_px frame_rate_hz first_frame_t_s times utc_offset_h",
        "landmarks": "file crs height sigma_m",
        "track": "file crs height clock offset_s sigma_m sigma_t_s lever_arm_m interpolate",
        "position": "lat_deg lon_deg h_m x_m y_m z_m crs height sigma_m lever_arm_m",
        "vehicle": "mount",
        "wind": "file",
        "atmosphere": "refraction",
        "solve": "loss blunders check_landmarks frames",
        "uncertainty": "focal_rel principal_px",
    }
    assert {name: " ".join(keys) for name, keys in KEYS.items()} == expected


def test_the_table_of_the_documentation_has_every_key_in_its_section() -> None:
    page = Path(__file__).parents[2] / "docs" / "flight-project.md"
    table = page.read_text(encoding="utf-8").partition("| section, key |")[2].partition("\n\n")[0]
    found: dict[str, set[str]] = {}
    name = ""
    for row in table.splitlines()[2:]:
        _, keys, text, _ = row.split("|")
        names = re.findall(r"`(\[?\w+\]?)`", keys)
        if names[0].startswith("["):
            name = names.pop(0).strip("[]")
        found.setdefault(name, set()).update(names or re.findall(r"`(\w+)`", text))
    assert found == {name: set(keys) for name, keys in KEYS.items()}


def section(**values: Any) -> Section:
    return Section("p.toml", "s", values)


@pytest.mark.parametrize("wrong", [5, 1.5, True, [1], {"a": 1}, ["x"]])
def test_a_text_is_in_quotes(wrong: Any) -> None:
    message = f"p.toml: [s] k: {wrong!r} is not a text in quotes"
    assert told(lambda: section(k=wrong).text("k")) == message
    assert told(lambda: section(k=wrong).text("k", ("a", "b"), "a")) == message


def test_texts_and_choices() -> None:
    one = section(k="abc")
    assert one.text("k") == one.text("k", default="x") == one.text("k", ("abc", "d")) == "abc"
    assert section().text("k", ("abc", "d"), "d") == section().text("k", default="d") == "d"
    assert section().text("k", default="") == ""
    assert told(lambda: section().text("k")) == "p.toml: [s] k: is needed"
    assert told(lambda: section().text("k", ("a", "b"))) == "p.toml: [s] k: is needed: a, b"
    assert told(lambda: one.text("k", ("abd", "x"))) == (
        "p.toml: [s] k: 'abc' is not known; did you mean abd?"
    )
    assert told(lambda: one.text("k", ("x", "y"))) == (
        "p.toml: [s] k: 'abc' is not known; known are x, y"
    )
    assert section(k=["a", "b"]).texts("k") == ("a", "b") and section().texts("k") == ()
    for wrong in ("a", 5, ["a", 1], {"a": "b"}):
        message = f"p.toml: [s] k: {wrong!r} is not a list of texts in quotes"
        assert told(lambda wrong=wrong: section(k=wrong).texts("k")) == message


NOT_FINITE = [True, False, "1", [1], {}, float("nan"), float("inf"), -float("inf")]


@pytest.mark.parametrize("wrong", NOT_FINITE)
def test_numbers_are_finite(wrong: Any) -> None:
    message = f"p.toml: [s] k: {wrong!r} is not a finite number"
    assert told(lambda: section(k=wrong).number("k")) == message
    assert told(lambda: section(k=wrong).number("k", 1.0, above=0.0)) == message
    assert told(lambda: section(k=[1, wrong]).numbers("k", 2)) == message


def test_numbers_and_their_limits() -> None:
    assert section(k=5).number("k") == 5.0 and isinstance(section(k=5).number("k"), float)
    assert section(k=-0.5).number("k", 7.0) == -0.5 and section().number("k", 7.0) == 7.0
    assert section().number("k", 0.0) == 0.0 and section(k=0).number("k", 7.0) == 0.0
    assert told(lambda: section().number("k")) == "p.toml: [s] k: is needed"
    assert (
        told(lambda: section(k=1.5).number("k", above=1.5)) == "p.toml: [s] k: 1.5 is not above 1.5"
    )
    assert told(lambda: section(k=-1).number("k", above=0.0)) == "p.toml: [s] k: -1 is not above 0"
    assert section(k=1.5000001).number("k", above=1.5) == 1.5000001
    assert section(k=[1, 2.5]).numbers("k", 2) == (1.0, 2.5)
    assert section().numbers("k", 2, (3, 4)) == (3.0, 4.0)
    assert told(lambda: section().numbers("k", 3)) == "p.toml: [s] k: is needed, 3 numbers"
    for wrong in ([1], [1, 2, 3], 5, "12", {"a": 1, "b": 2}):
        message = f"p.toml: [s] k: {wrong!r} is not a list of 2 numbers"
        assert told(lambda wrong=wrong: section(k=wrong).numbers("k", 2)) == message


def test_standard_deviations() -> None:
    assert section().sigma("k") is None and section().sigma("k", 3) is None
    assert section(k=0).sigma("k") == (0.0,) and section(k=2).sigma("k", 3) == (2.0,) * 3
    assert section(k=[0, 1]).sigma("k", 2) == (0.0, 1.0)
    below = "a standard deviation is not below 0"
    for values, least in (([1, -0.5], "-0.5"), ([-3, 0], "-3"), (-2, "-2"), ([-1, -4], "-4")):
        message = f"p.toml: [s] k: {least}: {below}"
        assert told(lambda values=values: section(k=values).sigma("k", 2)) == message
    assert told(lambda: section(k=[1, 2]).sigma("k", 3)).endswith("is not a list of 3 numbers")


def test_inline_tables_have_keys_of_their_own() -> None:
    inside = section(k={"abc": 1}).section("k", ("abc", "d"))
    assert (inside.project, inside.name, inside.values) == ("p.toml", "s.k", {"abc": 1})
    assert told(lambda: inside.text("abc")) == "p.toml: [s.k] abc: 1 is not a text in quotes"
    assert told(lambda: section(k={"abd": 1}).section("k", ("abc", "d"))) == (
        "p.toml: [s.k] abd: there is no such key; did you mean abc?"
    )
    for wrong in (5, True, "x", [], [1]):
        message = f"p.toml: [s] k: {wrong!r} is not a table, {{ abc = ... }}"
        assert told(lambda wrong=wrong: section(k=wrong).section("k", ("abc", "d"))) == message
    assert inside.has("abc") and not inside.has("d")


# The file


GOOD = '[camera]\nlens = "l"\n[picks]\nfile = "p"\n[landmarks]\nfile = "m"\n[track]\nfile = "t"\n'


def project(folder: Path, text: str | bytes) -> Project:
    (folder / "p.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_project("as given", str(folder / "p.toml"))


def test_a_project_is_named_as_the_user_named_it(tmp_path: Path) -> None:
    found = project(tmp_path, b"\xef\xbb\xbf" + GOOD.encode())
    assert (found.name, found.folder) == ("as given", tmp_path)
    assert [*found.sections] == ["camera", "picks", "landmarks", "track"]
    assert found.has("track") and not found.has("position") and not found.has("wind")
    assert found.section("wind").values == {} and found.section("wind").name == "wind"
    assert told(lambda: found.section("wind").text("file")) == "as given: [wind] file: is needed"
    assert told(lambda: found.section("picks").text("v")) == "as given: [picks] v: is needed"
    direct = read_project(str(tmp_path / "p.toml"))
    assert (direct.name, direct.folder) == (str(tmp_path / "p.toml"), tmp_path)
    assert project(tmp_path, GOOD + "[wind]\n").has("wind")  # whose file is then asked for
    fixed = project(tmp_path, GOOD.replace('[track]\nfile = "t"', "[position]\nh_m = 1"))
    assert fixed.has("position")


TRACKS = "[track] for a camera that moves, or [position] for one that does not"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"[flight]\nname = '\xfc'\n", "not a text file in UTF-8"),
        ("[flight\n", "not valid TOML: "), ("a = 1\na = 2\n", "not valid TOML: "),
        ("[pick]\n", "[pick] is not known; did you mean picks?"),
        ("x = 1\n", "[x] is not known; known are flight, camera, picks, landmarks, track, positi"),
        ("flight = 1\n", "flight is a section: write [flight]"),
        ("[[camera]]\n", "camera is a section: write [camera]"),
        ('[flight]\nnam = "x"\n', "[flight] nam: there is no such key; did you mean name?"),
        (GOOD.replace("lens", "file"), "[camera] file: there is no such key; known are lens, mod"),
        (GOOD.replace('[camera]\nlens = "l"\n', ""), "the section [camera] is needed"),
        (GOOD.replace('[picks]\nfile = "p"\n', ""), "the section [picks] is needed"),
        (GOOD.replace('[landmarks]\nfile = "m"\n', ""), "the section [landmarks] is needed"),
        (GOOD.replace('[track]\nfile = "t"\n', ""), f"{TRACKS}: neither is there"),
        (GOOD + "[position]\n", f"{TRACKS}: both are there"),
    ],
)  # fmt: skip
def test_projects_that_are_refused(text: str | bytes, message: str, tmp_path: Path) -> None:
    said = told(lambda: project(tmp_path, text))
    assert said.startswith(f"as given: {message}")


def test_a_project_that_is_not_there(tmp_path: Path) -> None:
    missing = str(tmp_path / "none.toml")
    assert told(lambda: read_project(missing)) == f"{missing}: No such file or directory"
    assert told(lambda: read_project("x", missing)) == "x: No such file or directory"


def test_a_changed_project_keeps_the_rest(tmp_path: Path) -> None:
    found = project(tmp_path, GOOD)
    new = found.changed("picks", "file", "q").changed("wind", "file", "w")
    assert new.section("picks").values == {"file": "q"} and new.section("wind").text("file") == "w"
    assert new.section("wind").project == "as given" and new.name == "as given"
    assert found.section("picks").values == {"file": "p"} and not found.has("wind")
    more = found.changed("picks", "v", "up").section("picks").values
    assert more == {"file": "p", "v": "up"}


def test_a_file_is_read_once_for_each_section_and_name(tmp_path: Path) -> None:
    found, seen = project(tmp_path, GOOD), []

    def read(file: InputFile) -> str:
        seen.append(file.name)
        return file.name.upper()

    formats = [InputFormat("x", lambda file: True, read)]
    one, other = InputFile("a", tmp_path, ""), InputFile("b", tmp_path, "")
    assert [found.read("picks", file, formats) for file in (one, other, one)] == ["A", "B", "A"]
    assert found.changed("picks", "v", "up").read("picks", one, formats) == "A"
    assert seen == ["a", "b"]
    assert found.read("track", one, formats) == "A" and seen == ["a", "b", "a"]
    assert project(tmp_path, GOOD).read("picks", one, formats) == "A" and len(seen) == 4


def test_files_are_named_by_their_keys(tmp_path: Path) -> None:
    found = project(tmp_path, GOOD)
    (tmp_path / "p").write_text("x")
    assert found.open("picks").text == "x" and found.open("picks").name == "p"
    nowhere = f"No such file or directory (paths are relative to {tmp_path})"
    assert told(lambda: found.open("landmarks")) == f"as given: [landmarks] file: m: {nowhere}"
    assert told(lambda: found.open("camera", "lens")) == f"as given: [camera] lens: l: {nowhere}"
    assert told(lambda: found.open("wind")) == "as given: [wind] file: is needed"
    bad = found.changed("picks", "file", 5)
    assert told(lambda: bad.open("picks")) == "as given: [picks] file: 5 is not a text in quotes"
    empty = found.changed("picks", "file", " ")
    assert told(lambda: empty.open("picks")) == (
        "as given: [picks] file: the name of a file is needed"
    )


def test_an_epoch_has_a_zone(tmp_path: Path) -> None:
    def epoch(value: Any) -> datetime | None:
        given = Section("p.toml", "flight", {} if value is None else {"epoch": value})
        return epoch_of(Project("p.toml", tmp_path, {"flight": given}))

    noon = datetime(2026, 5, 1, 12, 0, 0, 250_000, tzinfo=UTC)
    assert epoch(None) is None and epoch(noon) == noon
    there = epoch(noon.astimezone(timezone(timedelta(hours=5, minutes=30))))
    assert there == noon and there is not None and there.tzinfo is UTC
    for wrong in (noon.replace(tzinfo=None), date(2026, 5, 1), "2026-05-01T11:58:42Z", 5):
        assert told(lambda wrong=wrong: epoch(wrong)) == (
            "p.toml: [flight] epoch: is a date and time with its zone, as 2026-05-01T11:58:42Z"
        )
