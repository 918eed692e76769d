"""Star attitudes as AEM and CZML, for which photographs must have dates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vopd.export.dated_attitudes import DatedAttitudes, dated_aem
from vopd.export.file_request import FileRequest
from vopd.export.star_czml import dated_czml
from vopd.findings import Report, VopdError
from vopd.geometry.rotations import from_axes
from vopd.stellar.files.solution_table import solution_table
from vopd.stellar.sky.body_axes import BODY_FRAME, CAMERA_FRAME, axes_of_body

if TYPE_CHECKING:
    from vopd.stellar.files.solved_photograph import SolvedPhotograph
    from vopd.stellar.sky.sky_request import SkyRequest

QUATERNION = "{a} to {b}, Hamilton; components in {a} are q v q* of those in {b}; scalar last"


def render_dated(
    form: str, photographs: Sequence[SolvedPhotograph], sky: SkyRequest, report: Report
) -> bytes:
    """The content of an AEM or a CZML file; of each photograph the first solution.

    Args:
        form: "aem" or "czml"
        photographs: what was solved
        sky: place and mount
        report: takes warnings

    Raises:
        VopdError: no photograph has a date, or with czml there is no place.
    """
    dated = [one for one in photographs if one.solved and one.utc is not None]
    if not dated:
        raise VopdError(f"{form} needs dates: --date, or a column utc, and stars by coordinates")
    if form == "czml" and sky.place is None:
        raise VopdError("czml needs the place of the camera: --place")
    axes = [
        axes_of_body(np.array(one.solved[0].matrix), sky.mount, one.local, sky.place)
        for one in dated
    ]
    frame_b = "SENSOR_1" if sky.mount is None else "SC_BODY_1"
    about = CAMERA_FRAME if sky.mount is None else BODY_FRAME
    stated = solution_table(photographs).conventions
    place = None if sky.place is None else (sky.place[1], sky.place[0], sky.place[2])
    fixed = [one.earth_fixed for one in axes]
    attitudes = DatedAttitudes(
        ", ".join(dict.fromkeys(one.file.deck for one in dated)),
        tuple(one.utc for one in dated if one.utc is not None),
        from_axes(np.array([one.celestial for one in axes])),
        "ICRF",
        frame_b,
        {
            "program": stated["program"],
            "source": stated["source"],
            "from frame": "ICRF, the axes of J2000" if form == "aem" else "Earth-fixed, WGS 84",
            "to frame": about if form == "aem" else BODY_FRAME,
            "quaternion": QUATERNION.format(a="ICRF" if form == "aem" else "Earth-fixed axes",
                                            b=frame_b if form == "aem" else "the body"),
            "stars": dated[0].epoch,
        },
        place,
        None if sky.place is None else from_axes(np.array(fixed)),
    )  # fmt: skip
    writer = dated_aem if form == "aem" else dated_czml
    return writer(attitudes, FileRequest(object_name="CAMERA"), report)
