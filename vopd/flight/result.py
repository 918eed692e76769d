"""A solved flight as the library returns it: angles as arrays, findings, and the table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.estimate import Estimate
from vopd.findings import Finding
from vopd.flight.estimate import FrameAngles, frame_angles
from vopd.flight.flight import Flight
from vopd.flight.flight_estimates import FlightEstimates

if TYPE_CHECKING:
    import pandas as pd

    from vopd.attitude.history import History
    from vopd.attitude.history_parts import HistoryParts
    from vopd.attitude.input_sigmas import Sigmas


@dataclass(frozen=True, eq=False)
class FlightResult:
    """A solved flight: what was read, the angles of every frame, and what is doubtful.

    Args:
        estimates: the result of the solve, from which `estimate` is made
        findings: the warnings about files and solution
    """

    estimates: FlightEstimates
    findings: tuple[Finding, ...]

    @property
    def flight(self) -> Flight:
        """What the project's files hold."""
        return self.estimates.flight

    @cached_property
    def estimate(self) -> Estimate:
        """The estimate of all frames, with residuals and partials; made when it is asked for."""
        return self.estimates.whole()

    @property
    def frame(self) -> Ints:
        """Frame numbers (F,), from 0 where images have names; `image_name` has those."""
        return self.flight.frame

    @property
    def image_name(self) -> tuple[str, ...]:
        """File names of the images (F,); empty where frames have numbers."""
        return self.flight.image_name

    @property
    def time_s(self) -> Floats:
        """Time of every frame (F,), seconds after the project's epoch; NaN where not known."""
        return self.flight.time_s

    @property
    def solved(self) -> Bools:
        """Frames that have an attitude (F,)."""
        return np.asarray(np.isfinite(self.estimates.solved.attitudes.rotation[:, 0, 0]))

    @property
    def camera_deg(self) -> Floats:
        """Camera yaw, pitch, roll (F, 3), degrees; NaN in frames without an attitude."""
        return self._angles.camera_deg

    @property
    def vehicle_deg(self) -> Floats:
        """Vehicle yaw, pitch, roll (F, 3), degrees; those of the camera without a `[vehicle]`."""
        return self._angles.vehicle_deg

    @property
    def attack_deg(self) -> Floats:
        """Alpha, beta, eta (F, 3), degrees; NaN where the velocity is not known."""
        return self._angles.attack.angle_deg

    @cached_property
    def _angles(self) -> FrameAngles:
        return frame_angles(self.estimates.solved)

    @property
    def about(self) -> tuple[str, ...]:
        """What was read, a sentence for each file."""
        return self.flight.about

    def history(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> History:
        """The attitude history of the flight, with uncertainty and flags.

        Args:
            sigmas: standard deviations in the place of those that the project states
            max_rate_deg_s: frames that turn faster against a neighbour are flagged
            vertical: "geodetic" or "geocentric" axes for angles and quaternion; None is
                geodetic

        Raises:
            VopdError: where there is no such vertical
        """
        return self.history_parts(sigmas, max_rate_deg_s, vertical).whole

    def history_parts(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> HistoryParts:
        """The same history in parts of some ten thousand frames, each made when it is come to.

        Arguments and errors as `history`.
        """
        from vopd.attitude.input_sigmas import Sigmas
        from vopd.attitude.long_job import history_of_long_job
        from vopd.attitude.vertical import with_vertical

        return history_of_long_job(
            self.estimates.layout,
            lambda frames: with_vertical(self.estimates.of(frames), vertical),
            sigmas=sigmas or Sigmas(),
            max_rate_deg_s=max_rate_deg_s,
        )

    def to_dataframe(
        self,
        sigmas: Sigmas | None = None,
        max_rate_deg_s: float | None = None,
        vertical: str | None = None,
    ) -> pd.DataFrame:
        """The attitude table as a pandas DataFrame, one row for each frame.

        The columns are those of `vopd attitude`, with units in their names; the
        conventions are in `attrs`.

        Args:
            sigmas: as `history` takes it
            max_rate_deg_s: as `history` takes it
            vertical: as `history` takes it

        Raises:
            VopdError: where pandas is not installed
        """
        from vopd.export.dataframe import dataframe

        return dataframe([self.history(sigmas, max_rate_deg_s, vertical)])

    def __repr__(self) -> str:
        return f"FlightResult({self.flight.source}, {len(self.frame)} frames)"
