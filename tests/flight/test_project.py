"""The project file: its sections and keys, each kind of value, and what is said of a wrong one."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from datetime import UTC, date, datetime, timedelta, timezone
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved, refused
from vopd.findings import VopdError
from vopd.flight.formats.by_content import InputFormat
from vopd.flight.formats.files import InputFile
from vopd.flight.project.keys import (
    KEYS,
    SECTIONS,
    Key,
    Project,
    Section,
    keys_of,
    project_text,
    read_project,
    toml_numbers,
    toml_text,
)


def told(action: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        action()
    return str(refusal.value)


def test_every_key_is_in_its_section_and_its_example_is_read() -> None:
    """Keys of inline tables have the name of the key of the table in that of their section."""
    assert len({(key.section, key.name) for key in KEYS}) == len(KEYS)
    assert [section for section, _ in groupby(KEYS, lambda key: key.section.partition(".")[0])] == [
        *SECTIONS
    ]
    read = {
        "text": Section.text, "file": Section.text, "number": Section.number,
        "numbers": Section.numbers, "size": Section.size, "sigma": Section.sigma,
        "texts": Section.texts, "files": Section.files, "date": Section.date,
    }  # fmt: skip
    for key in KEYS:
        table, _, name = key.section.partition(".")
        assert not name or name in keys_of(table)
        assert key.default is None or not key.choices or key.default in key.choices
        if key.example:
            values = tomllib.loads(f"{key.name} = {key.example}")
            read[key.kind](Section("p.toml", key.section, values), key.name)
            assert key.comment


def test_the_table_of_the_documentation_is_made_of_the_keys() -> None:
    tool = Path(__file__).parents[2] / "tools" / "key_table.py"
    run = subprocess.run([sys.executable, tool, "--check"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_a_key_without_a_row_has_no_reader() -> None:
    with pytest.raises(KeyError):
        Section("p.toml", "picks", {"w": 1.0}).number("w")
    with pytest.raises(AssertionError):
        Section("p.toml", "picks", {"v": 1.0}).number("v")


def picks(**values: Any) -> Section:
    return Section("p.toml", "picks", values)


def track(**values: Any) -> Section:
    return Section("p.toml", "track", values)


@pytest.mark.parametrize("wrong", [5, 1.5, True, [1], {"a": 1}, ["x"]])
def test_a_text_is_in_quotes(wrong: Any) -> None:
    assert_approved(told(lambda: picks(file=wrong).text("file")), parts=[f"{wrong!r}"])
    assert_approved(told(lambda: picks(v=wrong).text("v")), parts=[f"{wrong!r}"])


def test_texts_and_choices() -> None:
    assert picks(file="abc").text("file") == "abc" and picks(v="up").text("v") == "up"
    assert picks().text("v") == "down" and Section("p.toml", "flight", {}).text("name") == ""
    assert told(lambda: picks().text("file")) == "p.toml: [picks] file: is needed"
    needed = "p.toml: [picks] pixel_grid: is needed: centre, corner, one-based"
    assert told(lambda: picks().text("pixel_grid")) == needed
    assert_approved(told(lambda: picks(v="dwn").text("v")))
    assert_approved(told(lambda: picks(v="x").text("v")))
    assert track(clock="x").text("clock", ("x", "y")) == "x"
    assert told(lambda: track().text("clock", ("x", "y"))).endswith("is needed: x, y")
    solve = Section("p.toml", "solve", {"check_landmarks": ["a", "b"]})
    assert solve.texts("check_landmarks") == ("a", "b")
    assert Section("p.toml", "solve", {}).texts("check_landmarks") == ()
    for wrong in ("a", 5, ["a", 1], {"a": "b"}):
        one = Section("p.toml", "solve", {"check_landmarks": wrong})
        assert_approved(told(lambda one=one: one.texts("check_landmarks")), parts=[f"{wrong!r}"])


NOT_FINITE = [True, False, "1", [1], {}, float("nan"), float("inf"), -float("inf")]


@pytest.mark.parametrize("wrong", NOT_FINITE)
def test_numbers_are_finite(wrong: Any) -> None:
    of_picks, of_track = picks(sigma_px=wrong), track(offset_s=wrong)
    lists = track(lever_arm_m=[1, wrong, 1], sigma_m=[1, wrong, 1])
    assert_approved(told(lambda: of_picks.number("sigma_px")), parts=[f"{wrong!r}"])
    assert_approved(told(lambda: of_track.number("offset_s", 1.0)), parts=[f"{wrong!r}"])
    arm = told(lambda: lists.numbers("lever_arm_m"))
    assert_approved(arm, parts=[f"{wrong!r}"])
    assert_approved(told(lambda: lists.sigma("sigma_m")), parts=[f"{wrong!r}"])


def test_a_date_in_the_place_of_a_number_is_written_as_in_the_file() -> None:
    for text in ("2026-05-01T09:30:00+00:00", "2026-05-01", "09:30:00"):
        section = track(offset_s=tomllib.loads(f"x = {text}")["x"])
        assert_approved(told(lambda one=section: one.number("offset_s", 1.0)), parts=[text])


def test_numbers_and_their_limits() -> None:
    five = track(offset_s=5).number("offset_s")
    assert five == 5.0 and isinstance(five, float)
    assert track(offset_s=-0.5).number("offset_s", 7.0) == -0.5
    assert track(offset_s=0).number("offset_s", 7.0) == 0.0 == track().number("offset_s")
    assert picks().number("utc_offset_h", 0.0) == 0.0 and picks().number("sigma_px") == 1.0
    rate = "p.toml: [picks] frame_rate_hz: "
    assert told(lambda: picks().number("frame_rate_hz")) == f"{rate}is needed"
    assert_approved(told(lambda: picks(frame_rate_hz=0).number("frame_rate_hz")), parts=[rate])
    minus = told(lambda: picks(frame_rate_hz=-1.5).number("frame_rate_hz"))
    assert_approved(minus, parts=[rate])
    lens = Section("p.toml", "camera.lens", {"fx_px": 1.0000001, "fy_px": 1, "k": [1, 2.5]})
    assert lens.number("fx_px") == 1.0000001 and lens.numbers("k") == (1.0, 2.5)
    assert_approved(told(lambda: lens.number("fy_px")))
    assert told(lambda: lens.numbers("sensor_mm")).endswith("sensor_mm: is needed, 2 numbers")
    assert track(lever_arm_m=[1, 2.5, 0]).numbers("lever_arm_m") == (1.0, 2.5, 0.0)
    for wrong in ([1], [1, 2], 5, "123", {"a": 1, "b": 2, "c": 3}):
        one = track(lever_arm_m=wrong)
        assert_approved(told(lambda one=one: one.numbers("lever_arm_m")), parts=[f"{wrong!r}"])


MOST = {"lat_deg": 90.0, "lon_deg": 360.0, "undulation_m": 1e5, "ground_m": 1e5}


@pytest.mark.parametrize("key", [one for one in KEYS if one.name in MOST], ids=str)
def test_places_and_levels_are_of_the_earth(key: Key) -> None:
    most = MOST[key.name]
    for size in (most, -most):
        section = Section("p.toml", key.section, {key.name: size})
        assert section.number(key.name) == size
        beyond = Section("p.toml", key.section, {key.name: 1.001 * size})
        with pytest.raises(VopdError, match=rf"{key.name}: must be -"):
            beyond.number(key.name)


def test_standard_deviations() -> None:
    def doubt(**values: Any) -> Section:
        return Section("p.toml", "uncertainty", values)

    assert doubt().sigma("focal_rel") is None and track().sigma("sigma_m") is None
    assert doubt(focal_rel=0).sigma("focal_rel") == (0.0,)
    assert track(sigma_m=2).sigma("sigma_m") == (2.0,) * 3
    assert doubt(principal_px=[0, 1]).sigma("principal_px") == (0.0, 1.0)
    for values, least in (([1, -0.5], "-0.5"), ([-3, 0], "-3"), (-2, "-2"), ([-1, -4], "-4")):
        one = doubt(principal_px=values)
        assert_approved(told(lambda one=one: one.sigma("principal_px")), parts=[least])
    assert_approved(told(lambda: track(sigma_m=[1, 2]).sigma("sigma_m")))
    for key in ("mount_sigma_deg", "attitude_sigma_deg"):
        for degrees in (180, 181):
            one = Section("p.toml", "vehicle", {key: degrees})
            if degrees == 180:
                assert one.sigma(key) == (180.0,)
            else:
                assert_approved(told(lambda one=one, key=key: one.sigma(key)))


def test_inline_tables_have_keys_of_their_own() -> None:
    def vehicle(mount: Any) -> Section:
        return Section("p.toml", "vehicle", {"mount": mount})

    inside = vehicle({"ypr_deg": [1, 2, 3]}).section("mount")
    found = (inside.project, inside.name, inside.values)
    assert found == ("p.toml", "vehicle.mount", {"ypr_deg": [1, 2, 3]})
    assert_approved(told(lambda: vehicle({"ypr_deg": 1}).section("mount")))
    assert_approved(told(lambda: vehicle({"ypr": 1}).section("mount")))
    for wrong in (5, True, "x", [], [1]):
        assert_approved(
            told(lambda wrong=wrong: vehicle(wrong).section("mount")), parts=[f"{wrong!r}"]
        )
    assert inside.has("ypr_deg") and not inside.has("matrix")


# The file


GOOD = '[camera]\nlens = "l"\n[picks]\nfile = "p"\n[landmarks]\nfile = "m"\n[track]\nfile = "t"\n'


def project(folder: Path, text: str | bytes) -> Project:
    (folder / "p.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_project("as given", str(folder / "p.toml"))


@pytest.mark.parametrize("when", ["2016-12-31T23:59:60Z", "12026-05-01T11:58:42Z"])
def test_dates_that_toml_does_not_have(when: str, tmp_path: Path) -> None:
    text = f"# ä\n[flight]\nepoch = {when}\n{GOOD}"
    assert_approved(told(lambda: project(tmp_path, text)))


def test_a_project_is_named_as_the_user_named_it(tmp_path: Path) -> None:
    found = project(tmp_path, b"\xef\xbb\xbf" + GOOD.encode())
    assert (found.name, found.folder) == ("as given", tmp_path)
    assert [*found.sections] == ["camera", "picks", "landmarks", "track"]
    assert found.has("track") and not found.has("position") and not found.has("wind")
    assert found.section("wind").values == {} and found.section("wind").name == "wind"
    assert told(lambda: found.section("wind").text("file")) == "as given: [wind] file: is needed"
    needed = "as given: [picks] pixel_grid: is needed: centre, corner, one-based"
    assert told(lambda: found.section("picks").text("pixel_grid")) == needed
    direct = read_project(str(tmp_path / "p.toml"))
    assert (direct.name, direct.folder) == (str(tmp_path / "p.toml"), tmp_path)
    assert not project(tmp_path, GOOD + "[wind]\n").has("wind")  # a header alone
    fixed = project(tmp_path, GOOD.replace('[track]\nfile = "t"', "[position]\nh_m = 1"))
    assert fixed.has("position")


def test_files_that_a_section_needs() -> None:
    with refused(VopdError):
        Section("p.toml", "picks", {}).files("video")
    assert Section("p.toml", "picks", {"video": "a.mp4"}).files("video") == ("a.mp4",)


@pytest.mark.parametrize(
    "text",
    [
        b"[flight]\nname = '\xfc'\n",
        "[flight\n", "a = 1\na = 2\n",
        "[pick]\n",
        "x = 1\n",
        "flight = 1\n",
        "[[camera]]\n",
        '[flight]\nnam = "x"\n',
        GOOD.replace("lens", "file"),
        GOOD.replace('[camera]\nlens = "l"\n', ""),
        GOOD.replace('[picks]\nfile = "p"\n', ""),
        GOOD.replace('[landmarks]\nfile = "m"\n', ""),
        GOOD.replace('[track]\nfile = "t"\n', ""),
        GOOD + "[position]\nh_m = 1\n",
        GOOD.replace('"l"', r'"C:\Users\l.yml"'),
        GOOD.replace('"l"', r'"D:\lens.yml"'),
        GOOD.replace('"l"', '{ model = "brown", model = "fisheye" }'),
        GOOD.replace('"l"', '{ model = "brown" }\nlens.fx_px = 1500.0'),
        GOOD.replace('"l"', '"a\x01b"'),
    ],
)  # fmt: skip
def test_projects_that_are_refused(text: str | bytes, tmp_path: Path) -> None:
    said = told(lambda: project(tmp_path, text))
    assert_approved(said)


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
    assert_approved(told(lambda: found.open("landmarks")), parts=[tmp_path])
    assert_approved(told(lambda: found.open("camera", "lens")), parts=[tmp_path])
    assert told(lambda: found.open("wind")) == "as given: [wind] file: is needed"
    bad = found.changed("picks", "file", 5)
    assert_approved(told(lambda: bad.open("picks")))
    for names in (5, [], ["a.mp4", 5]):
        several = found.changed("picks", "video", names).section("picks")
        assert_approved(told(lambda several=several: several.files("video")))
    empty = found.changed("picks", "file", " ")
    assert_approved(told(lambda: empty.open("picks")))


def test_an_epoch_has_a_zone() -> None:
    def epoch(value: Any) -> datetime | None:
        values = {} if value is None else {"epoch": value}
        return Section("p.toml", "flight", values).date("epoch")

    noon = datetime(2026, 5, 1, 12, 0, 0, 250_000, tzinfo=UTC)
    assert epoch(None) is None and epoch(noon) == noon
    there = epoch(noon.astimezone(timezone(timedelta(hours=5, minutes=30))))
    assert there == noon and there is not None and there.tzinfo is UTC
    for wrong in (noon.replace(tzinfo=None), date(2026, 5, 1), "2026-05-01T11:58:42Z", 5):
        assert_approved(told(lambda wrong=wrong: epoch(wrong)))


# The text of a new project


def test_every_line_of_a_new_project() -> None:
    """Comments begin in column 44, or a blank after a longer value."""
    values = {("camera", "image_size_px"): "[64, 48]", ("wind", "file"): '"w.csv"'}
    needed = {("picks", "pixel_grid"): "why", ("track", "file"): "", ("track", "sigma_m"): ""}
    head, *lines = project_text(values, needed, "one\n\ntwo").split("\n\n")
    assert head == "# one\n#\n# two"
    marked = {*needed, ("position", "sigma_m")}
    found = [line for line in "\n".join(lines).splitlines() if "[" not in line.partition(" = ")[0]]
    for key, line in zip([key for key in KEYS if key.example], found, strict=True):
        known = values.get((key.section, key.name))
        text = f"# {key.name} = {key.example}" if known is None else f"{key.name} = {known}"
        mark = f"NEEDED ({key.new_option}), " * ((key.section, key.name) in marked)
        assert line == f"{text:43} # {mark}{key.comment}"


def test_the_name_of_a_source_is_a_comment_of_toml() -> None:
    """Which has no control characters but tabs."""
    head = project_text({}, {}, "vopd adjust a\x1b[31m\x7f\t/flight.toml").splitlines()[0]
    assert head == "# vopd adjust a\\x1b[31m\\x7f\t/flight.toml"
    assert tomllib.loads(head) == {}


def sections(values: dict[tuple[str, str], str], needed: dict[tuple[str, str], str]) -> list[str]:
    lines = project_text(values, needed, "x").splitlines()
    return [line for line in lines if line.removeprefix("# ").startswith("[")]


def test_a_new_project_has_a_track_or_a_position() -> None:
    rest = ["[vehicle]", "[wind]", "[atmosphere]", "[solve]", "[uncertainty]"]
    usual = ["[flight]", "[camera]", "[picks]", "[landmarks]"]
    assert sections({}, {}) == [*usual, "[track]", *rest]
    assert sections({("track", "file"): '"t"'}, {}) == [*usual, "[track]", *rest]
    assert sections({("position", "h_m"): "1"}, {}) == [*usual, "[position]", *rest]
    assert sections({}, {("track", "file"): ""}) == [*usual, "[track]", "[position]", *rest]


def test_a_header_alone_is_no_section(tmp_path: Path) -> None:
    """Its keys are comments, as in a new project."""
    found = project(tmp_path, GOOD + "[position]\n[wind]\n[solve]\n")
    assert [*found.sections] == ["camera", "picks", "landmarks", "track", "solve"]


def test_values_as_toml() -> None:
    assert toml_text('é "a" \\ b') == '"é \\"a\\" \\\\ b"'
    every = "".join(map(chr, [*range(0x300), 0x2028, 0x1F600]))  # TOML has no delete in a text
    assert tomllib.loads(f"x = {toml_text(every)}")["x"] == every
    assert toml_numbers(1920, 0.1, 123456.789012) == "[1920, 0.1, 123456.789012]"


OF_ANOTHER_KIND = {
    "text": 1.5, "file": 1.5, "number": "x", "numbers": "x", "size": "x", "sigma": "x",
    "texts": 1.5, "files": 1.5, "date": "x",
}  # fmt: skip


@pytest.mark.parametrize(
    "key",
    [key for key in KEYS if "." not in key.section],
    ids=lambda key: f"{key.section}.{key.name}",
)
def test_a_value_of_another_kind_is_refused_where_nothing_reads_it_too(key: Key) -> None:
    if key.kind in OF_ANOTHER_KIND:
        section = Section("p.toml", key.section, {key.name: OF_ANOTHER_KIND[key.kind]})
        with pytest.raises(VopdError, match=rf"\[{key.section}\] {key.name}: "):
            section.check()
