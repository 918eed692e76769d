"""A new flight project from the files that there are, or from the example."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

from vopd.flight.new import (
    NewProject,
    look_at_landmarks,
    look_at_lens,
    look_at_picks,
    look_at_times,
    look_at_track,
    look_at_wind,
)
from vopd.flight.project_text import KeyValues, project_text, toml_text

NAME = "flight.toml"
EXAMPLE = (
    "picks.csv", "landmarks.csv", "track.csv", "lens.json", "wind.csv", "truth.csv",
    "frame_000.png", "frame_050.png", "frame_100.png",
)  # fmt: skip
"""The files of the example; tools/example_flight.py makes them."""
EXAMPLE_VALUES: KeyValues = {
    ("flight", "name"): '"drone over six masts"',
    ("flight", "epoch"): "2026-05-01T09:30:00.240Z",
    ("camera", "lens"): '"lens.json"',
    ("camera", "image_size_px"): "[640, 360]",
    ("picks", "file"): '"picks.csv"',
    ("picks", "pixel_grid"): '"centre"',
    ("picks", "sigma_px"): "0.5",
    ("picks", "frame_rate_hz"): "25.0",
    ("picks", "first_frame_t_s"): "0.0",
    ("landmarks", "file"): '"landmarks.csv"',
    ("landmarks", "height"): '"ellipsoid"',
    ("landmarks", "sigma_m"): "[0.05, 0.05, 0.1]",
    ("track", "file"): '"track.csv"',
    ("track", "height"): '"ellipsoid"',
    ("track", "clock"): '"utc"',
    ("track", "sigma_m"): "[0.02, 0.02, 0.04]",
    ("track", "sigma_t_s"): "0.002",
    ("wind", "file"): '"wind.csv"',
}
HEAD = "A flight project: vopd check, attitude, plot and report take this file.\n"
EXAMPLE_HEAD = (
    HEAD
    + """\
The example: a drone with a video camera over fields with six landmarks. The frames are
rendered, the picks have errors of half a pixel, and truth.csv has the true angles.
To make it yours, replace the files and the values that differ. Lines that begin with #
are keys that are not used here, each with an example."""
)
OWN_HEAD = (
    HEAD
    + """\
Lines that begin with # are keys that are not used, each with an example. Remove the #
from those that are marked NEEDED, and give their values; then run vopd check."""
)


def example_project() -> NewProject:
    """The example: a project that runs at once, with its truth."""
    folder = files("vopd.flight") / "example"
    new = NewProject({name: (folder / name).read_bytes() for name in EXAMPLE})
    new.contents[NAME] = project_text(EXAMPLE_VALUES, {}, EXAMPLE_HEAD).encode()
    new.said.append("an example: 21 frames of a drone's video over six landmarks, with its truth")
    return new


def project_of_files(folder: Path, given: Mapping[str, str]) -> NewProject:
    """A project from files of the user, which stay where they are.

    Args:
        folder: where the project will be
        given: the files by what they are: lens, picks, landmarks, track, wind, gcp (picks
            and landmarks in one), images (a folder, whose tags are the track, or with another
            track by time the frames' times)

    Raises:
        VopdError: where a file cannot be read, or is not of a known format
    """
    named = dict(given)
    if "gcp" in named:
        gcp = named.pop("gcp")
        named = {"picks": gcp, "landmarks": gcp} | named
    images = named.pop("images", None)
    if "track" not in named and images is not None:
        named["track"] = images
    new, values = NewProject(), KeyValues()
    values["flight", "name"] = toml_text(folder.resolve().name)
    look_at_lens(new, values, folder, named.get("lens"))
    by_number = look_at_picks(new, values, folder, named.get("picks"))
    look_at_landmarks(new, values, folder, named.get("landmarks"))
    track = look_at_track(new, values, folder, named.get("track"))
    if track is not None and named["track"] != images:
        look_at_times(new, values, folder, track, images, by_number)
    if "wind" in named:
        look_at_wind(new, values, folder, named["wind"])
    new.contents[NAME] = project_text(values, new.needed, OWN_HEAD).encode()
    return new
