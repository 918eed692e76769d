"""What is said of the attitude where yaw and roll are nearly one turn: numbers by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import TOML, write_project
from vopd import solve_flight
from vopd.attitude.history import History, are_others
from vopd.attitude.included import included_text, names_mount, one_turn_text, one_turn_texts
from vopd.attitude.long_history import one_part
from vopd.attitude.summary import text


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> dict[str, History]:
    """A camera that is the vehicle, and one that is mounted on it."""
    found = {}
    for mount in ("forward", "down"):
        toml = f'{TOML}[vehicle]\nmount = "{mount}"\n'
        project = write_project(tmp_path_factory.mktemp(mount), toml)
        found[mount] = solve_flight(project).history()
    return found


def unsure(of: History, yaw: float, roll: float, body: str = "vehicle") -> History:
    """The same with turns of .1, .02 and .3 degree about the axes, and these sigmas of angles."""
    u, count = of.uncertainty, len(of.landmarks)
    total, first = u.total.copy(), 3 if body == "vehicle" else 0
    total[:, [first, first + 2]] = yaw, roll
    covariance = np.tile(np.diag([0.1, 0.02, 0.3]) ** 2, (count, 1, 1))
    new = replace(u, total=total, half_width_95=2.0 * total, covariance_deg2=covariance)
    return replace(of, uncertainty=new)


def test_the_worst_turn_is_told_where_yaw_and_roll_are_twice_as_unsure(
    solved: dict[str, History],
) -> None:
    """Half of the interval is twice sigma here: 2 times .3 degree."""
    own = solved["forward"]
    assert "0.6 degree (95 %)" in one_turn_text(unsure(own, 0.7, 0.61))
    assert one_turn_text(unsure(own, 0.7, 0.59)) == one_turn_text(own) == ""
    assert_approved([one_turn_text(unsure(own, 0.7, 0.61)), included_text(unsure(own, 9.0, 9.0))])


def test_whose_angles_they_are_is_told_where_there_are_two(solved: dict[str, History]) -> None:
    """A mount is no advice to those who have one."""
    down = unsure(solved["down"], 0.7, 0.7, "camera")
    assert one_turn_text(down) == "" and one_turn_text(down, body="camera")
    both = unsure(down, 0.7, 0.7)
    assert len(one_turn_texts([both])) == 2
    assert_approved(one_turn_texts([down, both]))


def test_a_camera_that_looks_up_is_not_advised_to_look_down(solved: dict[str, History]) -> None:
    own = unsure(solved["forward"], 9.0, 9.0)
    up = replace(
        own.estimate, vehicle_deg=-own.estimate.vehicle_deg, camera_deg=-own.estimate.camera_deg
    )
    assert one_turn_text(own).startswith(one_turn_text(replace(own, estimate=up)))
    assert len(one_turn_text(own)) > len(one_turn_text(replace(own, estimate=up))) > 0


def test_whether_the_mount_is_named_goes_with_the_sentence(solved: dict[str, History]) -> None:
    for own in (solved["forward"], unsure(solved["forward"], 9.0, 9.0)):
        named = "mount" in included_text(own)
        assert names_mount(own) is named is (own is not solved["forward"])
    assert not names_mount(unsure(solved["down"], 9.0, 9.0))


def test_angles_that_are_printed_alike_are_the_same() -> None:
    """Within a millionth of a degree, around the circle; unknown ones say nothing."""
    vehicle = np.array([[179.9999999, 0.0, -5.0], [np.nan] * 3])
    camera = np.array([[-179.9999999, 9e-7, -5.0], [np.nan] * 3])
    assert not are_others(camera, vehicle) and not are_others(vehicle[:0], vehicle[:0])
    assert are_others(camera + np.array([0.0, 2e-7, 0.0]), vehicle)


def test_frames_without_sigmas_say_nothing(solved: dict[str, History]) -> None:
    for free in (0.0, np.inf, np.nan):
        assert one_turn_text(unsure(solved["forward"], free, 9.0)) == ""


def test_the_page_says_it_once(solved: dict[str, History]) -> None:
    """The hint of a camera that looks down is part of it, and not at the end too."""
    own = solved["forward"]
    down = replace(own.estimate, camera_deg=own.estimate.camera_deg - [0.0, 77.0, 0.0])
    down = replace(down, vehicle_deg=down.camera_deg)
    shown = text([one_part(replace(unsure(own, 9.0, 9.0), estimate=down))])
    assert " ".join(shown.split()).count('mount = "down"') == 1
    plain = text([one_part(replace(own, estimate=down))])
    assert " ".join(plain.split()).count('mount = "down"') == 1
    assert "one turn" in " ".join(shown.split()) and "one turn" not in plain
