"""All that a file of each format holds, of two jobs that have a bit of everything."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.approved.content import content
from tests.approved.texts import assert_approved
from tests.kit.estimates import ABOUT, EPOCH, REQUEST, estimate
from vopd.attitude.history import History, history
from vopd.attitude.long_history import one_part
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import MapGrid, Units
from vopd.export import FORMATS, MEAN_FORMATS
from vopd.export.tables import dataframe
from vopd.findings import Finding

NAMES = ["a b.jpg", "#c.jpg", "=d,e.jpg", "f\x1b.jpg", "g.jpg", "h.jpg", "i#.jpg"]
SOME = ("frame", "flags", "time_s", "vehicle_roll_deg", "eta_low_95_deg")


@cache
def jobs() -> tuple[History, ...]:
    """In feet, with a mount, against a grid.

    Of the first job two frames are of one time, one has no date, one no time, one no position and
    one no attitude; the second is earlier, has the name of a picture of the first, another lens in
    each frame, a frame that misfits and one whose uncertainty is not known.
    """
    made = []
    for count, start_s in ((7, 40.0), (4, 3.25)):
        k = np.arange(count)
        angles = np.array([351.3, -58.2, 163.7]) + k[:, None] * [4.1, -3.3, 5.2]
        body = (angles + np.array([21.1, 65.4, 11.3])) % 360.0
        body[:, 1] -= 360.0 * (body[:, 1] > 180.0)
        one = estimate(
            angles % 360.0 - [0.0, 360.0, 0.0], noise=0.3, vehicle_deg=body,
            units=Units("ft", "px", 0.3048, "px", 1.0), time_s=start_s + (k * 0.125)[::-1],
            frame_names=NAMES[:count],
            grid=MapGrid("EPSG:32632", 5e5 + 1000.0 * k, 5.2e6 - 7.0 * k, 1.5 - k / 4.0),
        )  # fmt: skip
        made.append(history(one, sigmas=Sigmas(reading=0.6, position=2.0, mount_deg=0.25)))
    first, second = (one.estimate for one in made)
    time_s, here, angles = first.time_s.copy(), first.position, first.camera_deg.copy()
    time_s[1], time_s[3], time_s[5] = time_s[0], np.nan, 1e12
    altitude = here.altitude.copy()
    altitude[2], angles[4] = np.nan, np.nan
    about = ABOUT._replace(title="<b> & \t\u00e9", doubt="it misfits", fixes="restart", epoch=EPOCH)
    first = replace(
        first, time_s=time_s, position=replace(here, altitude=altitude), camera_deg=angles,
        about=about,
    )  # fmt: skip
    named = [NAMES[0], "j.jpg", "k.jpg", "l.jpg"]
    other = ABOUT._replace(source="b\n.toml", job=3, title="", epoch=EPOCH)
    second = replace(second, about=other, frame_names=named, lens=np.array([1, 0, 2, 1]))
    one, two = (replace(was, estimate=now) for was, now in zip(made, (first, second), strict=True))
    doubt = two.uncertainty.covariance_deg2.copy()
    doubt[1] = np.inf
    two = replace(two, uncertainty=replace(two.uncertainty, covariance_deg2=doubt))
    two.flags.raised["misfit"][[1, 2]] = True
    return one, two


def written(form: str, *which: History, **changes: object) -> list[str]:
    """The content of a file, and what is said of it."""
    said: list[Finding] = []
    request = replace(REQUEST, **changes)
    made = FORMATS[form].render(which or jobs(), request, said.append)
    return [content(made), *map(str, said)]


@pytest.mark.parametrize("form", FORMATS)
def test_everything_in_a_file(form: str) -> None:
    columns = ("all",) if form == "csv" else SOME
    assert_approved(written(form, columns=columns, roll_180=form == "csv"))
    if form in ("npz", "jsonl"):
        assert_approved(written(form, jobs()[1]))


@pytest.mark.parametrize("form", ["aem", "kml", "czml"])
def test_everything_in_a_file_of_another_request(form: str) -> None:
    """Version 1 of an AEM; of viewers without names, and KML without an epoch."""
    epoch = None if form == "kml" else EPOCH
    assert_approved(written(form, aem_version=1, object_name=" ", object_id="", epoch=epoch))


@pytest.mark.parametrize("form", ["acm", "colmap"])
def test_everything_in_a_file_of_one_source_twice(form: str) -> None:
    """Beside another that lasts longer."""
    one, two = jobs()
    late = replace(two, estimate=replace(two.estimate, time_s=two.estimate.time_s + 36.9))
    assert_approved(written(form, late, one, two))


@pytest.mark.parametrize("form", ["csv", "jsonl", "npz", "parquet"])
def test_everything_in_a_file_of_means(form: str) -> None:
    assert form in MEAN_FORMATS
    assert_approved(content(FORMATS[form].mean_table([one_part(one) for one in jobs()], REQUEST)))


def test_everything_that_a_data_frame_states() -> None:
    assert_approved(dict(dataframe(jobs()).attrs))
