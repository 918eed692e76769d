"""Attitude of a vehicle or a camera from landmarks in its images.

Example::

    import vopd
    flight = vopd.solve_flight("examples/hill/flight.toml")
    print(flight)                       # short: angles, uncertainty, doubtful frames
    print(flight.vehicle_deg)           # yaw, pitch, roll of every frame
    print(flight.to_dataframe())        # with uncertainty and flags; needs pandas

    run = vopd.run("decks/appendix_h/case1.dat")
    print(run, run.vehicle_deg)

`solve_flight` solves all frames of a flight project; `adjust` also solves for lens, clock or
landmarks. `run` solves all jobs of a 1974 card deck. `read_deck` reads the jobs of a deck, so that
you can change them before you run them; `write_deck` writes them as cards. `listing_text` returns
the pages that program VOPD (NASA TM X-3050) printed. A module is imported when it is first used.

These names are public and will stay. Functions: `adjust`, `listing_text`, `read_deck`, `run`,
`solve_flight`, `write_deck`. Results: `Adjustment`, `FlightResult`, `Results`, `Run`. Input:
`Deck`, `Job`, `Sigmas`. Messages: `Finding`, `VopdError`, `InputError`, `DeckError`.
"""

from __future__ import annotations

from vopd.version import __version__

TYPE_CHECKING = False  # as typing's, which takes as long to import as all the rest
if TYPE_CHECKING:
    from typing import Any

    from vopd.attitude.sigmas import Sigmas
    from vopd.cards.write import write_deck
    from vopd.findings import DeckError, Finding, InputError, VopdError
    from vopd.flight.adjust.adjustment import Adjustment, adjust
    from vopd.flight.result import FlightResult, solve_flight
    from vopd.job import Deck, Job
    from vopd.listing.pages import listing_text
    from vopd.pipeline import read_deck, run
    from vopd.results import Results
    from vopd.solved import Run

_HOMES = {
    "Adjustment": "vopd.flight.adjust.adjustment",
    "DeckError": "vopd.findings",
    "Finding": "vopd.findings",
    "InputError": "vopd.findings",
    "VopdError": "vopd.findings",
    "Deck": "vopd.job",
    "Job": "vopd.job",
    "FlightResult": "vopd.flight.result",
    "Results": "vopd.results",
    "adjust": "vopd.flight.adjust.adjustment",
    "listing_text": "vopd.listing.pages",
    "read_deck": "vopd.pipeline",
    "Run": "vopd.solved",
    "Sigmas": "vopd.attitude.sigmas",
    "run": "vopd.pipeline",
    "solve_flight": "vopd.flight.result",
    "write_deck": "vopd.cards.write",
}

__all__ = [
    "Adjustment",
    "Deck",
    "DeckError",
    "Finding",
    "FlightResult",
    "InputError",
    "Job",
    "Results",
    "Run",
    "Sigmas",
    "VopdError",
    "__version__",
    "adjust",
    "listing_text",
    "read_deck",
    "run",
    "solve_flight",
    "write_deck",
]


if not TYPE_CHECKING:  # a type checker would take every name for one of the package

    def __getattr__(name: str) -> Any:
        if name not in _HOMES:
            raise AttributeError(f"module 'vopd' has no attribute {name!r}")
        from importlib import import_module

        return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
