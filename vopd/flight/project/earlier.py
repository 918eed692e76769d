"""A project that `vopd new` wrote before: completed by further options, or the lines to edit."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from vopd.files import from_folder
from vopd.findings import VopdError
from vopd.flight.project.inspect import FOCAL_REL, OF_FOCAL
from vopd.flight.project.keys import ROWS, VIDEO, KeyValues, from_toml, toml_text, written_keys
from vopd.flight.project.new import NAME, OWN_HEAD, SAYS_EXAMPLE, Answer, sure_keys
from vopd.video import stills_in

_FILES = ("picks", "landmarks", "track", "wind")


@dataclass
class Earlier:
    """What an earlier project has: its files, as options name them, and its other values."""

    values: KeyValues
    files: dict[str, str]
    video: tuple[str, ...]


def earlier_project(
    folder: Path, files: Mapping[str, str], video: Sequence[str], answers: Sequence[Answer]
) -> Earlier:
    """Read a project that `vopd new` wrote and nobody edited, without what options replace.

    Args:
        folder: where it is
        files: files that are given now, by what they are
        video: the files of the video that is given now
        answers: what is said now

    Raises:
        VopdError: where it was edited; the lines that the options stand for are named
    """
    try:
        text = (folder / NAME).read_bytes().decode()
    except (OSError, UnicodeDecodeError) as error:
        raise VopdError(f"{folder / NAME}: is there already; name another folder") from error
    values = written_keys(text, OWN_HEAD)
    if values is None:
        raise VopdError(_lines_to_edit(folder, text, files, video, answers))
    before = Earlier(values, {}, ())
    _name_files(before, folder)
    _leave_out(before, files, video, answers)
    return before


def _name_files(before: Earlier, folder: Path) -> None:
    """Move the names of files from the values to where options would have put them."""
    values = before.values

    def names(section: str, key: str) -> list[str]:
        found = from_toml(values[section, key])
        several = found if isinstance(found, list) else [found]
        return [os.path.normpath(folder / one) for one in several]

    for section in _FILES:
        if (section, "file") in values:
            (name,) = names(section, "file")
            if section != "picks" or Path(name).exists():  # clicks that are still to be made
                before.files[section] = name
            del values[section, "file"]
    lens = values.get(("camera", "lens"), "{")
    if not lens.startswith("{"):
        (before.files["lens"],) = names("camera", "lens")
        del values["camera", "lens"]
    if values.get(("picks", "times")) == toml_text(VIDEO):
        before.video = tuple(names("picks", "video"))
        del values["picks", "times"], values["picks", "video"]
        return
    for key in ("times", "video"):
        if ("picks", key) in values and stills_in(Path(names("picks", key)[0])):
            (before.files["images"],) = names("picks", key)
            del values["picks", key]
    track = before.files.get("track")
    if track is not None and Path(track).is_dir():  # the tags of images
        before.files.setdefault("images", track)


def _leave_out(
    before: Earlier, files: Mapping[str, str], video: Sequence[str], answers: Sequence[Answer]
) -> None:
    """Leave out what the options of now take the place of."""
    said = {key for one in answers for key in one.keys}
    gone = sure_keys(answers)
    if ("track", "sigma_m") in said - gone:  # of which a part is each position's own
        gone.add(("track", "sigma_bias_m"))
    lens, other_lens = ("camera", "lens"), "lens" in files or ("camera", "lens") in gone
    if other_lens and lens in before.values and before.values.get(OF_FOCAL) == f"{FOCAL_REL:g}":
        gone.add(OF_FOCAL)  # of the focal length that tags had
    if video or "images" in files:
        gone |= {("picks", key) for key in ("times", "video", "frame_rate_hz")}
        before.files.pop("images", None)
        before.video = ()
    stands = any(section == "position" for section, _ in gone)
    other = {"track"} if stands else {"position"} if "track" in files else set[str]()
    gone |= {key for key in before.values if key[0] in other}
    for key in gone:
        before.values.pop(key, None)
    replaced = ["picks", "landmarks"] if "gcp" in files else []
    for kind in [*replaced, *other, *(["lens"] if ("camera", "lens") in gone else [])]:
        before.files.pop(kind, None)


def _lines_to_edit(
    folder: Path,
    text: str,
    files: Mapping[str, str],
    video: Sequence[str],
    answers: Sequence[Answer],
) -> str:
    """Name the lines of an edited project that options stand for."""
    wanted = {key: one.value for one in answers for key in one.keys}

    def quoted(*names: str) -> str:
        texts = [toml_text(from_folder(one, folder)) for one in names]
        return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"

    for kind, name in files.items():
        sections = {"gcp": ["picks", "landmarks"], "lens": ["camera"], "images": ["picks"]}
        key = {"lens": "lens", "images": "video"}.get(kind, "file")
        wanted |= {(section, key): quoted(name) for section in sections.get(kind, [kind])}
    if video:
        wanted |= {("picks", "video"): quoted(*video), ("picks", "times"): toml_text(VIDEO)}
    lines, section = list[str](), ""
    for number, line in enumerate(text.splitlines(), 1):
        if header := re.match(r"\s*\[(\w+)\]", line):
            section = header[1]
        named_key = re.match(r"\s*(?:#\s*)?(\w+)\s*=", line)
        if named_key and (value := wanted.pop((section, named_key[1]), None)) is not None:
            lines.append(f"  line {number}, [{section}]: {named_key[1]} = {value}")
    sure = sure_keys(answers)
    for (section, key), value in wanted.items():
        is_file = ROWS[section, key].kind in ("file", "files")
        if (section, key) in sure or is_file or f"\n[{section}]" in text:
            lines.append(f"  under [{section}]: {key} = {value}")
    state = "is the example" if SAYS_EXAMPLE in text else "is not as vopd new wrote it"
    return (
        f"{folder / NAME}: is there already and {state}: edit it, or name "
        "another folder. The options stand for these lines:\n" + "\n".join(lines)
    )
