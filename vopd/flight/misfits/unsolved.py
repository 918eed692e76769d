"""Frames without an attitude, and picks that are not used: which, and why."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, VopdError, count_text, first_of
from vopd.flight.flight import Flight, frame_label, pick_label
from vopd.flight.misfits.input_errors import OF_LANDMARK
from vopd.flight.project.picks import NO_LANDMARK, NONE_USED
from vopd.flight.solve.rotations import SolvedFlight
from vopd.geometry.lenses import UNSEEN_MEANING, Unseen


def require_two_landmarks(flight: Flight) -> None:
    """Refuse a flight in which no frame has two landmarks."""
    frame, marks = flight.picks.frame, flight.picks.landmark
    takes_part = flight.landmarks.takes_part[marks]
    count = np.bincount(frame[takes_part], minlength=len(flight.frame))
    if count.max(initial=0) < 2:
        why = [
            one.message
            for one in flight.findings
            if one.message.startswith(NO_LANDMARK) or one.message.endswith(NONE_USED)
        ]
        if np.bincount(frame).max(initial=0) > 1:
            names = [flight.landmarks.name[k] for k in np.unique(marks[~takes_part]).tolist()]
            why.insert(0, f"[solve] check_landmarks leaves out {first_of(names, 5)}")
        if why:
            more = f"; {len(why) - 3} more like these" if len(why) > 3 else ""
            raise VopdError(
                f"{flight.source}: no frame has two landmarks that can be used: "
                f"{'; '.join(why[:3])}{more}"
            )
        raise VopdError(
            f"{flight.source}: no frame has two landmarks (frames: {len(count)}, one at most in "
            "each). One landmark gives the direction of its line of sight alone: the turn about "
            "it stays free, so that of three angles two are tied together and none is known by "
            "itself. Pick a second landmark in each image, the farther from the first the better."
        )


def picks_outside(flight: Flight) -> list[Finding]:
    """Count the picks that lie outside their images, and name the first."""
    picks = flight.picks
    width, height = flight.lens.of(picks.frame).by_rows("size_px").T
    u, v = picks.pixel.T
    outside = (u < -0.5) | (u > width - 0.5) | (v < -0.5) | (v > height - 0.5)
    if not outside.any():
        return []
    first = int(np.flatnonzero(outside)[0])
    wide, high = (int(np.broadcast_to(one, u.shape)[first]) for one in (width, height))
    hint = '; does v point up? then give [picks] v = "up"' if (v < 0).mean() > 0.5 else ""
    if _about_the_middle(u / width, v / height):
        hint = (
            f"; are they counted from the middle of the image? u + {wide / 2:g} and v + "
            f"{high / 2:g} count from its corner, and {high / 2:g} - v if v points up"
        )
    text = (
        f"{count_text(int(outside.sum()), 'pick')} outside the image of {wide} x {high}, the first "
        f"{flight.landmarks.name[picks.landmark[first]]} in "
        f"{frame_label(flight, int(picks.frame[first]))} at {u[first]:g}, {v[first]:g}{hint}"
    )
    return [Finding(text, flight.source, severity="warning")]


SOME = 0.15  # of the picks, left of the image


def _about_the_middle(u: Floats, v: Floats) -> bool:
    """Tell whether picks, in parts of the image, lie as if its middle counted 0."""
    within = (np.abs(u) <= 0.5).all() and (np.abs(v) <= 0.5).all()
    return bool(within and (u < 0.0).mean() > SOME)


def picks_set_aside(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    """Name picks whose landmark has no image; a landmark that has none in all its frames once."""
    aside, landmark, texts = solved.attitudes.set_aside, flight.picks.landmark, []
    if not aside.any():
        return []
    known, first, own, count = np.unique(
        landmark, return_index=True, return_inverse=True, return_counts=True
    )
    alike = np.bincount(own[aside == aside[first][own]], minlength=len(known)) == count
    for k in np.flatnonzero(aside).tolist():
        why, one = UNSEEN_MEANING[Unseen(int(aside[k]))], own[k]
        if count[one] == 1 or not alike[one]:
            texts.append(
                f"{pick_label(flight, k)} {why} as the others have it; its pick is not used"
            )
        elif k == first[one]:
            name = flight.landmarks.name[landmark[k]]
            texts.append(
                f"{name} {why} in all {count[one]} frames that show it, as the others have it, and "
                "is not used" + f": {OF_LANDMARK}" * bool(aside[k] == Unseen.BEHIND_CAMERA)
            )
    return [Finding(text, flight.source, severity="warning") for text in texts]


NOT_CONVERGED = (
    "the solve did not converge, and the angles are those of its last step; look at the positions, "
    "the picks and their stated standard deviations"
)


def frames_unsolved(flight: Flight, solved: SolvedFlight) -> list[Finding]:
    """List frames without an attitude, by reason, and those that did not converge."""
    unknown = np.isnan(solved.attitudes.rotation[:, 0, 0])
    lost = unknown & np.isfinite(flight.path.position_m[:, 0])
    picked = np.bincount(flight.picks.frame, minlength=len(flight.frame))
    reasons = (
        (lost & (picked < 2), "fewer than two landmarks: two of three angles at most, no attitude"),
        (lost & (picked >= 2), "its landmarks lie on one line of sight, or too few can be used"),
        (~unknown & ~solved.attitudes.converged, NOT_CONVERGED),
    )
    tell = []
    for which, why in reasons:
        labels = [frame_label(flight, int(k)) for k in np.flatnonzero(which)]
        if labels:
            told = f"{first_of(labels, 5)}: {why}"
            tell.append(Finding(told, flight.source, severity="warning"))
    return tell
