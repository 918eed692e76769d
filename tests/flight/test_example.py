"""The example that is shipped is the one that the tests know the truth of."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.kit.command import vopd
from tests.kit.flight_project import truth_deg, write_project
from tests.tolerances import within
from vopd.flight.result import solve_flight

EXAMPLES = Path(__file__).parents[2] / "examples"
HILL = EXAMPLES / "hill"


def test_the_example_is_near_the_truth_that_its_page_states() -> None:
    angles = solve_flight(str(HILL / "flight.toml")).estimate.camera_deg
    assert np.abs(angles - truth_deg() % 360.0 + [0.0, 360.0, 0.0]).max() < within(
        "angle of an example"
    )


def test_the_example_is_the_project_of_the_tests(tmp_path: Path) -> None:
    """All but the last digits, which another machine may round otherwise."""
    write_project(tmp_path, noise_px=0.3)
    assert (tmp_path / "flight.toml").read_text() == (HILL / "flight.toml").read_text()
    for name in ("picks.csv", "landmarks.csv", "track.csv"):
        made, shipped = ((folder / name).read_text().split() for folder in (tmp_path, HILL))
        assert len(made) == len(shipped)
        for one, other in zip(made[1:], shipped[1:], strict=True):
            for a, b in zip(one.split(","), other.split(","), strict=True):
                assert a == b or abs(float(a) - float(b)) < within("shipped number")


def test_the_survey_and_the_camera_on_the_post_are_near_their_truth(tmp_path: Path) -> None:
    """The angles that docs/drone.md and docs/fixed-camera.md state."""
    survey = EXAMPLES / "survey"
    files = ("--gcp", survey / "gcp_list.txt", "--lens", survey / "cameras.json")
    assert vopd("new", tmp_path / "s", *files, "--track", survey / "geo.txt").status == 0
    project = tmp_path / "s" / "flight.toml"
    project.write_text(project.read_text().replace("# height =", "height ="))
    truth = [[12, -84, 1.5], [10, -85, 0.8], [11, -83, -1.0], [9, -86, 2.2]]
    for path, expected in (
        (project, truth),
        (EXAMPLES / "summits" / "flight.toml", [[2.5, 6, -0.7]]),
    ):
        flight = solve_flight(path)
        off = (flight.camera_deg - expected + 180.0) % 360.0 - 180.0
        assert np.abs(off).max() < within("angle of an example") and flight.findings == ()
