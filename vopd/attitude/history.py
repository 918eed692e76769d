"""A job's attitude history: what its results mean, how sure they are, and what to distrust."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.flags import Flags, flags
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.landmark_geometry import Geometry, geometry
from vopd.attitude.position import Place, place
from vopd.attitude.quaternion import from_yaw_pitch_roll
from vopd.attitude.solution import solution
from vopd.attitude.uncertainty import Uncertainty, uncertainty
from vopd.findings import VopdError
from vopd.results import Outcome, Results

STATUS = {
    Outcome.SOLVED: "solved",
    Outcome.DROPPED: "ignored",
    Outcome.EXACT: "exact",
    Outcome.EXACT_LATE: "exact",
    Outcome.STOPPED: "stopped",
}
"""What a row's `status` says of how its frame ended."""


@dataclass(frozen=True, eq=False)
class History:
    """One job of a deck. Frame axis first in every array."""

    deck: str
    job: int  # its number in the deck, from 1
    results: Results
    place: Place
    quaternion: Floats  # (F, 4) local north-east-down to vehicle body, w x y z, w >= 0
    residual_rms_mm: Floats  # (F,) over 2N
    geometry: Geometry
    uncertainty: Uncertainty
    flags: Flags

    @property
    def has_attitude(self) -> Bools:
        """Frames whose vehicle angles are known (F,): not ignored, not stopped, numbers."""
        return np.asarray(np.isfinite(self.results.vehicle_deg).all(axis=1))

    @property
    def status(self) -> list[str]:
        """How each frame ended: a word of `STATUS`."""
        return [STATUS[Outcome(code)] for code in self.results.outcome]

    @property
    def deck_name(self) -> list[str]:
        """The deck, for every frame."""
        return [self.deck] * len(self.results.frame)

    @property
    def job_number(self) -> Ints:
        """The job's number, for every frame (F,)."""
        return np.full(len(self.results.frame), self.job)

    @property
    def landmarks(self) -> Ints:
        """How many landmarks take part (F,)."""
        return np.asarray(self.results.used.sum(axis=1))

    @property
    def last_correction_rad(self) -> Floats:
        """The largest of the 22nd corrections (F,); NaN where there was none."""
        largest = np.abs(self.results.correction_rad).max(axis=1)
        return np.asarray(np.where(self.results.solved, largest, np.nan))

    @property
    def flag_text(self) -> list[str]:
        """The flags of every frame as one text."""
        return self.flags.text()


@np.errstate(all="ignore")
def history(
    results: Results,
    deck: str = "",
    job: int = 1,
    *,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> History:
    """The attitude history of a job that `vopd.run` has solved.

    `sigmas` are the standard deviations of what the job was given. Frames that
    turn faster than `max_rate_deg_s` against a neighbour are flagged; None
    looks for none. Raises `VopdError` where the rate is not above 0.
    """
    if max_rate_deg_s is not None and not max_rate_deg_s > 0.0:
        raise VopdError(f"maximum rate: {max_rate_deg_s:g} degrees a second is not above 0")
    solved = solution(results)
    shape = geometry(solved)
    doubt = uncertainty(solved, sigmas)
    quaternion = from_yaw_pitch_roll(results.vehicle_deg)
    squares = np.where(results.used[..., None], results.residual_mm, 0.0) ** 2
    rms = np.sqrt(squares.sum(axis=(1, 2)) / (2.0 * results.used.sum(axis=1)))
    return History(
        deck=deck,
        job=job,
        results=results,
        place=place(results),
        quaternion=quaternion,
        residual_rms_mm=np.where(np.isfinite(results.camera_deg[:, 0]), rms, np.nan),
        geometry=shape,
        uncertainty=doubt,
        flags=flags(solved, shape, quaternion, rms, doubt.reading_mm, max_rate_deg_s),
    )
