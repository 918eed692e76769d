"""`vopd batch`: the outputs of each source, the summary, shards, processes, and what is refused."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.approved.texts import assert_approved
from tests.kit.batch import contents, mixed_sources, small_decks
from tests.kit.command import CASE_1, DECKS, ROOT, vopd
from vopd import read_deck, write_deck


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mixed_sources(tmp_path_factory.mktemp("inputs") / "in")


@pytest.fixture(scope="module")
def undisturbed(inputs: Path) -> dict[str, bytes]:
    ran = vopd("batch", inputs, "-d", inputs.parent / "one")
    assert ran.status == 3, ran.stderr
    return contents(inputs.parent / "one")


def rows(folder: Path) -> dict[str, dict[str, Any]]:
    lines = (folder / "summary.jsonl").read_text().splitlines()
    return {row["source"]: row for row in map(json.loads, lines)}


def test_the_outputs_are_those_of_run_and_attitude(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """Solving decks together changes no byte of any."""
    for deck in sorted(inputs.glob("*.dat")):
        ran = vopd("run", deck, "-q")
        assert undisturbed.get(f"{deck.stem}.lst", b"") == ran.output
        vopd("attitude", deck, "-q", "-o", tmp_path / "table.csv")
        table = tmp_path / "table.csv"
        assert undisturbed.get(f"{deck.stem}.csv") == (
            table.read_bytes() if table.exists() else None
        )
        table.unlink(missing_ok=True)
    ran = vopd("attitude", inputs / "hill" / "flight.toml")
    assert undisturbed["hill/flight.csv"] == ran.output
    assert not any(name.startswith(".") for name in undisturbed)


def test_the_summary_has_a_row_for_each_source(inputs: Path, undisturbed: dict[str, bytes]) -> None:
    """Counts of the decks by hand: `ignored` has four frames, of which one is ignored."""
    found = rows(inputs.parent / "one")
    assert list(found) == sorted(found) and len(found) == 11
    one = found["ignored"]
    assert (one["status"], one["frames"], one["attitudes"]) == ("solved", 4, 3)
    assert one["flags"]["two_landmarks"] == 3 and one["flagged"] == 3
    digest = hashlib.sha256((inputs / "ignored.dat").read_bytes()).hexdigest()
    assert one["input_sha256"] == digest
    assert one["outputs"]["ignored.lst"] == hashlib.sha256(undisturbed["ignored.lst"]).hexdigest()
    assert found["broken"]["status"] == "failed" and "broken.dat" in found["broken"]["error"]
    assert found["lens_out_of_order"]["status"] == "failed"
    assert "lens_out_of_order.lst" in undisturbed and "seconds" not in one
    times = (inputs.parent / "one" / "times.jsonl").read_text().splitlines()
    assert [json.loads(line)["source"] for line in times] == list(found)
    assert all(json.loads(line)["seconds"] > 0.0 for line in times)


def test_errata_that_matter_are_counted_by_job(tmp_path: Path) -> None:
    """They move the angles of all five frames of the one job."""
    vopd("demo", "--frames", "5", "--seed", "5", "-o", tmp_path / "a.dat")
    vopd("batch", tmp_path / "a.dat", "-d", tmp_path / "out")
    assert rows(tmp_path / "out")["a"]["errata"] == 1


def test_strict_asks_for_the_cards_behind_the_last_job(tmp_path: Path) -> None:
    """As of `vopd attitude`: no frame of these has a flag, and errata are corrected."""
    vopd("demo", "--earth", "wgs84", "-o", tmp_path / "a.dat")
    given = "--fix", "all", "--strict"
    assert vopd("batch", tmp_path / "a.dat", "-d", tmp_path / "all", *given).status == 0
    with (tmp_path / "a.dat").open("a", encoding="ascii") as deck:
        deck.write("       1.0\n")
    for command in (("batch", "-d", tmp_path / "more"), ("attitude", "-o", tmp_path / "a.csv")):
        assert vopd(*command, tmp_path / "a.dat", *given).status == 3
    assert rows(tmp_path / "more")["a"]["unread"] == 1


def test_the_summary_as_parquet(inputs: Path, undisturbed: dict[str, bytes]) -> None:
    table = pytest.importorskip("pyarrow.parquet").read_table(
        inputs.parent / "one" / "summary.parquet"
    )
    found = rows(inputs.parent / "one")
    for row, (name, other) in zip(table.to_pylist(), found.items(), strict=True):
        assert row["source"] == name
        assert row.pop("messages") == "\n".join(other["messages"])
        assert all(row[key] == other[key] for key in row if not key.startswith("flag_"))
        flags = {key[5:]: count for key, count in row.items() if key.startswith("flag_") and count}
        assert flags == other["flags"]


def test_what_is_printed(inputs: Path, tmp_path: Path) -> None:
    ran = vopd("batch", inputs, "-d", tmp_path / "out")
    lines = ran.stdout.splitlines()
    assert lines[0].split()[:2] == ["source", "status"]
    assert [line.split()[:2] for line in lines[1:3]] == [
        ["broken", "failed"], ["lens_out_of_order", "failed"],
    ]  # fmt: skip
    assert lines[-1].startswith("11 sources: 2 failed, 9 solved; ")
    assert "broken.dat" in ran.stderr
    assert_approved(ran.stderr)


def test_two_processes_and_three_shards_give_the_same_bytes(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    ran = vopd("batch", inputs, "-d", tmp_path / "two", "--jobs", "2")
    assert ran.status == 3 and contents(tmp_path / "two") == undisturbed
    out = tmp_path / "three"
    shards = ("3/3", "1/3", "2/3")
    statuses = []
    for part in shards:
        assert not (out / "summary.jsonl").exists()
        ran = vopd("batch", inputs, "-d", out, "--shard", part)
        statuses.append(ran.status)
        assert ("ends last writes" in ran.stderr) == (part != "2/3")
    assert contents(out) == undisturbed
    failed = {row["source"] for row in rows(out).values() if row["status"] == "failed"}
    assert failed == {"broken", "lens_out_of_order"}
    of_shard = {part: set(list(rows(out))[int(part[0]) - 1 :: 3]) for part in shards}
    assert statuses == [3 if of_shard[part] & failed else 0 for part in shards]


def test_neither_order_nor_another_source_changes_an_output(
    inputs: Path, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """Decks are solved together with those beside them; rows of the summary stand by name."""
    before = {name: row for name, row in rows(inputs.parent / "one").items() if "/" not in name}
    more = small_decks(tmp_path / "more", 1, frames=7) / "deck000.dat"
    listed = [str(inputs / f"{name}.dat") for name in before][::-1]
    listed.insert(3, str(more.rename(tmp_path / "new.dat")))
    (tmp_path / "list.txt").write_text("\n".join(listed))
    out = tmp_path / "out"
    assert vopd("batch", "--manifest", tmp_path / "list.txt", "-d", out).status == 3
    found = rows(out)
    assert found.pop("new")["frames"] == 7
    assert [*found.items()] == [*before.items()]
    written = {name: content for name, content in contents(out).items() if "summary" not in name}
    assert len([written.pop(f"new.{suffix}") for suffix in ("csv", "lst")]) == 2
    assert written == {name: undisturbed[name] for name in undisturbed if name in written}
    assert len(written) == sum(len(row["outputs"]) for row in before.values())


def test_resume_solves_only_what_has_changed(tmp_path: Path) -> None:
    """A file's time of modification says whether it was written again."""
    folder = small_decks(tmp_path / "in", 4)
    out = tmp_path / "out"
    assert vopd("batch", folder, "-d", out).status == 0
    before = {path: path.stat().st_mtime_ns for path in out.glob("deck*")}

    def written_again() -> set[str]:
        ran = vopd("batch", folder, "-d", out, "--resume")
        assert ran.status == 0, ran.stderr
        again = {p.name for p, time in before.items() if p.stat().st_mtime_ns != time}
        before.update({path: path.stat().st_mtime_ns for path in before})
        return again

    assert written_again() == set()
    shutil.copy(folder / "deck001.dat", folder / "deck000.dat")
    assert written_again() == {"deck000.lst", "deck000.csv"}
    assert (out / "deck000.lst").read_bytes() == (out / "deck001.lst").read_bytes()
    (out / "deck002.csv").write_text("damaged")
    assert written_again() == {"deck002.lst", "deck002.csv"}
    (out / "deck003.lst").unlink()
    before[out / "deck003.lst"] = 0
    assert written_again() == {"deck003.lst", "deck003.csv"}
    folder = folder.rename(tmp_path / "moved")  # the tables name the decks
    assert written_again() == {path.name for path in before}


def test_resume_with_other_options_solves_all_again(tmp_path: Path) -> None:
    """Tables of a format that is no longer asked for are removed, and the page about all."""
    folder = small_decks(tmp_path / "in", 2)
    for options in (("csv", "--report"), ("jsonl",)):
        ran = vopd("batch", folder, "-d", tmp_path / "out", "--resume", "--format", *options)
        assert ran.status == 0, ran.stderr
    vopd("batch", folder, "-d", tmp_path / "new", "--format", "jsonl")
    assert contents(tmp_path / "out") == contents(tmp_path / "new")


def test_a_file_that_a_project_names_is_a_part_of_its_input(tmp_path: Path, inputs: Path) -> None:
    shutil.copytree(inputs / "hill", tmp_path / "hill")
    out = tmp_path / "out"
    vopd("batch", tmp_path / "hill", "-d", out)
    first = rows(out)["flight"]
    picks = tmp_path / "hill" / "picks.csv"
    picks.write_text("".join(picks.read_text().splitlines(keepends=True)[:-1]))
    vopd("batch", tmp_path / "hill", "-d", out, "--resume")
    second = rows(out)["flight"]
    assert first["input_sha256"] != second["input_sha256"]
    assert first["outputs"] != second["outputs"]


def test_sources_by_file_pattern_and_manifest(tmp_path: Path, monkeypatch: Any) -> None:
    (tmp_path / "a" / "b").mkdir(parents=True)
    for name in ("a/one.txt", "a/b/two.txt", "three"):
        shutil.copy(CASE_1, tmp_path / name)
    (tmp_path / "list.txt").write_text("# decks\n\na/b/two.txt\nthree\n")
    hill = ROOT / "examples" / "hill"
    monkeypatch.chdir(tmp_path)

    def names(*arguments: str) -> list[str]:
        shutil.rmtree("out", ignore_errors=True)
        ran = vopd("batch", *arguments, "-d", "out", "--fix", "all")
        unused = "--fix: not used: it is for decks\n" * (arguments == (str(hill),))
        assert (ran.status, ran.stderr) == (0, unused)
        return list(rows(Path("out")))

    assert names("a/b/two.txt", "three") == ["three", "two"]
    assert names("a/**/*.txt") == ["b/two", "one"]
    assert names("--manifest", "list.txt") == ["a/b/two", "three"]
    assert names("three", "three", "./three") == ["three"]
    assert names(str(hill)) == ["flight"]


def test_a_missing_source_fails_alone(tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, tmp_path / "no-such.dat", "-d", tmp_path / "out")
    assert ran.status == 3 and "no-such.dat: No such file or directory" in ran.stderr
    ran = vopd("batch", tmp_path / "no-such.dat", "-d", tmp_path / "none")
    assert ran.status == 1
    assert rows(tmp_path / "none")["no-such"]["input_sha256"] == ""


def empty_manifest(place: Path) -> list[Any]:
    (place / "list.txt").write_text("# nothing\n\n")
    return ["--manifest", place / "list.txt", "-d", place / "out"]


def same_name(place: Path) -> list[Any]:
    for name in ("a", "b"):
        (place / name).mkdir()
        shutil.copy(CASE_1, place / name / "deck.dat")
    shutil.copy(CASE_1, place / "a" / "deck.cards")
    return [place / "a" / "deck.dat", place / "a" / "deck.cards", "-d", place / "out"]


def name_of_the_summary(place: Path) -> list[Any]:
    shutil.copy(CASE_1, place / "summary.dat")
    return [place / "summary.dat", "-d", place / "out", "--format", "jsonl"]


def inside(place: Path) -> list[Any]:
    same_name(place)
    return [place / "a", "-d", place / "a" / "out"]


def around(place: Path) -> list[Any]:
    same_name(place)
    return [place / "a" / "deck.dat", "-d", place / "a"]


def no_source_in_folder(place: Path) -> list[Any]:
    return [DECKS / "stars", "-d", place / "out"]


def no_match(place: Path) -> list[Any]:
    return [place / "*.dat", "-d", place / "out"]


def a_file(place: Path) -> list[Any]:
    (place / "file").write_text("mine")
    return [CASE_1, "-d", place / "file"]


def standard_input(place: Path) -> list[Any]:
    return ["-", "-d", place / "out"]


def manifest_of_itself(place: Path) -> list[Any]:
    (place / "list.txt").write_text(f"{CASE_1}\nlist.txt\n")
    return ["--manifest", place / "list.txt", "-d", place / "out"]


def folder_as_a_manifest(place: Path) -> list[Any]:
    return ["--manifest", place, "-d", place / "out"]


def picture_as_a_manifest(place: Path) -> list[Any]:
    (place / "list.png").write_bytes(b"\x89PNG\r\n\x1a\n more")
    return ["--manifest", place / "list.png", "-d", place / "out"]


def archive_as_a_manifest(place: Path) -> list[Any]:
    (place / "list.gz").write_bytes(b"\x1f\x8b\x08 more")
    return ["--manifest", place / "list.gz", "-d", place / "out"]


REFUSED = (
    empty_manifest,
    same_name,
    name_of_the_summary,
    inside,
    around,
    no_source_in_folder,
    no_match,
    a_file,
    standard_input,
    manifest_of_itself,
    folder_as_a_manifest,
    picture_as_a_manifest,
    archive_as_a_manifest,
)


@pytest.mark.parametrize("make", REFUSED, ids=lambda one: one.__name__)
def test_what_is_refused_before_anything_is_done(
    make: Callable[[Path], list[Any]], tmp_path: Path
) -> None:
    arguments = make(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    ran = vopd("batch", *arguments)
    assert (ran.status, ran.stdout) == (1, "")
    assert_approved(ran.stderr)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "options",
    [["--shard", "0/3"], ["--shard", "4/3"], ["--shard", "a/b"], ["--jobs", "0"], ["-d", ""]],
)
def test_wrong_usage(options: list[str], tmp_path: Path) -> None:
    ran = vopd("batch", CASE_1, "-d", tmp_path / "out", *options)
    assert ran.status == 2 and not (tmp_path / "out").exists()
    assert vopd("batch", "-d", tmp_path / "out").status == 2


def test_a_folder_that_holds_a_batch(tmp_path: Path) -> None:
    """Of this version it needs --resume; of another it is refused, and nothing changes."""
    out = tmp_path / "out"
    vopd("batch", CASE_1, "-d", out)
    ran = vopd("batch", CASE_1, "-d", out)
    assert ran.status == 1 and "give --resume" in ran.stderr
    summary = out / "summary.jsonl"
    summary.write_text(summary.read_text().replace('"version": "', '"version": "0.0.'))
    before = contents(out)
    ran = vopd("batch", CASE_1, "-d", out, "--resume")
    assert ran.status == 1 and "holds a batch of vopd 0.0." in ran.stderr
    assert contents(out) == before


def test_shards_with_other_options_are_refused(tmp_path: Path) -> None:
    sources = [CASE_1, DECKS / "appendix_h" / "case2.dat"]
    vopd("batch", *sources, "-d", tmp_path / "out", "--shard", "1/2")
    ran = vopd("batch", *sources, "-d", tmp_path / "out", "--shard", "2/2", "--fix", "all")
    assert ran.status == 1
    assert_approved(ran.stderr)


def test_a_quiet_part_says_nothing_of_the_others(tmp_path: Path) -> None:
    sources = [CASE_1, DECKS / "appendix_h" / "case2.dat"]
    told = vopd("batch", *sources, "-d", tmp_path / "told", "--shard", "1/2").stderr
    quiet = vopd("batch", *sources, "-d", tmp_path / "quiet", "--shard", "1/2", "-q").stderr
    assert "part 1 of 2 is finished" in told and "part 1 of 2" not in quiet


def test_a_part_without_a_source_has_nothing_to_do(tmp_path: Path) -> None:
    """Also of a complete batch, which it is not going to begin again."""
    out = tmp_path / "out"
    first = vopd("batch", CASE_1, "-d", out, "--shard", "2/2")
    assert (first.status, first.stdout, out.exists()) == (0, "", False)
    assert_approved(first.stderr)
    assert vopd("batch", CASE_1, "-d", out, "--shard", "2/2", "-q").stderr == ""
    assert vopd("batch", CASE_1, "-d", out, "--shard", "1/2").status == 0
    before = contents(out)
    assert vopd("batch", CASE_1, "-d", out, "--shard", "2/2").status == 0
    assert contents(out) == before and "summary.jsonl" in before


def test_strict(tmp_path: Path) -> None:
    assert vopd("batch", CASE_1, "-d", tmp_path / "one").status == 0
    assert vopd("batch", CASE_1, "-d", tmp_path / "two", "--strict").status == 3


def test_a_flight_whose_track_leaps_is_doubtful_without_a_flag(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The fix of the fourth second stands 220 m aside, after the last frame; the next are right."""
    shutil.copytree(ROOT / "examples" / "hill", tmp_path / "hill")
    track = tmp_path / "hill" / "track.csv"
    text = track.read_text().replace("\n4.0,47.643", "\n4.0,47.645")
    track.write_text(f"{text}5.0,47.644039602691,16.476099617188,546.0\n")
    project, out = tmp_path / "hill" / "flight.toml", tmp_path / "out"
    ran = vopd("batch", project, "-d", out, "--report", "--strict")
    (row,) = (json.loads(line) for line in (out / "summary.jsonl").read_text().splitlines())
    assert (ran.status, row["status"], row["flagged"], row["mistaken"]) == (3, "solved", 0, 1)
    assert (out / "flight.html").exists()
    assert vopd("batch", project, "-d", tmp_path / "again").status == 0
    monkeypatch.chdir(project.parent)
    project.rename("my flight.toml")
    text = vopd("attitude", "my flight.toml", "--format", "text").stdout
    assert_approved(text[text.index("doubtful ") :])


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
def test_a_device_is_no_source(tmp_path: Path) -> None:
    ran = vopd("batch", "/dev/zero", "-d", tmp_path / "out")
    assert ran.status == 1
    assert_approved(ran.stderr)


def test_an_error_in_the_program_costs_one_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The others of its chunk are solved again, one by one."""
    from vopd.batch import solve as solved_source

    right = solved_source.findings_of

    def wrong(about: Any, summary: Any) -> Any:
        if about.source.endswith("deck001.dat"):
            raise ZeroDivisionError("by design")
        return right(about, summary)

    monkeypatch.setattr(solved_source, "findings_of", wrong)
    folder = small_decks(tmp_path / "in", 3)
    ran = vopd("batch", folder, "-d", tmp_path / "out")
    found = rows(tmp_path / "out")
    assert ran.status == 3
    assert [one["status"] for one in found.values()] == ["solved", "failed", "solved"]
    assert "ZeroDivisionError: by design" in found["deck001"]["error"]


def test_an_impossible_focal_length_costs_no_other_deck_its_first_estimate(tmp_path: Path) -> None:
    """Two landmarks give no first estimate then: the deck starts from group 8, as if alone."""
    (job,) = read_deck(CASE_1)
    bad = replace(job, camera=replace(job.camera, focal_length_mm=-10.0))
    place = tmp_path / "in"
    place.mkdir()
    (place / "bad.dat").write_text(write_deck([bad]))
    shutil.copy(CASE_1, place / "good.dat")
    ran = vopd("batch", place, "-d", tmp_path / "out", "--initial", "closed-form")
    assert ran.status == 0 and "2 solved" in ran.stdout
    good = vopd("run", CASE_1, "--initial", "closed-form")
    assert (tmp_path / "out" / "good.lst").read_text() == good.stdout
    from_group_8 = vopd("run", place / "bad.dat")
    assert (tmp_path / "out" / "bad.lst").read_text() == from_group_8.stdout


@pytest.mark.usefixtures("no_figures")
def test_reports_and_the_page_about_all(tmp_path: Path) -> None:
    """The page has every source, the failed one first, and links to the reports that there are."""
    pytest.importorskip("jinja2")
    (tmp_path / "broken.dat").write_text("\n".join(CASE_1.read_text().splitlines()[:30]))
    out = tmp_path / "out"
    ran = vopd("batch", CASE_1, tmp_path / "broken.dat", "-d", out, "--report")
    assert ran.status == 3
    page = (out / "index.html").read_text(encoding="utf-8")
    assert re.findall(r'href="(\./[^"]*)"', page) == ["./case1.html"]
    assert page.index("broken") < page.index("./case1.html")
    assert "1 of 2 sources failed" in page and "2 sources: 1 failed, 1 solved" in page
    vopd("report", CASE_1, "-o", tmp_path / "alone.html")
    assert (out / "case1.html").read_bytes() == (tmp_path / "alone.html").read_bytes()
    assert rows(out)["broken"]["outputs"] == {}
