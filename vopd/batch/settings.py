"""What a batch is asked for: how to solve its sources and which files to write of each."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cached_property

from vopd.attitude.input_sigmas import Sigmas
from vopd.export import FORMATS
from vopd.pipeline import SolveOptions
from vopd.version import __version__

LISTING, PAGE = ".lst", ".html"


@dataclass(frozen=True)
class BatchSettings:
    """How to solve the sources of a batch, and what to write.

    Args:
        folder: the output folder
        working: the folder of temporary files, in the same file system
        solve: how to solve decks
        sigmas: standard deviations of the inputs
        max_rate_deg_s: frames that turn faster against a neighbour are flagged
        vertical: of the local axes, as `vopd.attitude.vertical` takes it
        formats: of the attitude tables, names of `vopd.export.FORMATS`
        report: whether each source has a page
    """

    folder: str
    working: str
    solve: SolveOptions
    sigmas: Sigmas
    max_rate_deg_s: float | None = None
    vertical: str | None = None
    formats: tuple[str, ...] = ("csv",)
    report: bool = False

    @property
    def version(self) -> str:
        """The version of the package."""
        return __version__

    @cached_property
    def options(self) -> str:
        """All that the outputs depend on besides the input and the version, as JSON."""
        given = {
            "fix": str(self.solve.fixes),
            "initial": self.solve.initial,
            "compare_initial": self.solve.compare_initial,
            "limits_1974": self.solve.limits_1974,
            "sigmas": {name: one for name, one in asdict(self.sigmas).items() if one},
            "max_rate_deg_s": self.max_rate_deg_s,
            "vertical": self.vertical,
            "formats": list(self.formats),
            "report": self.report,
        }
        usual: tuple[object, ...] = ("deck", False, None, {}, "")
        return json.dumps({name: one for name, one in given.items() if one not in usual})

    @property
    def suffixes(self) -> tuple[str, ...]:
        """The suffixes of all files that a source may have, with the dot."""
        page = (PAGE,) if self.report else ()
        return (LISTING, *(table_suffix(one) for one in self.formats), *page)


def table_suffix(form: str) -> str:
    """The suffix of the attitude table in a format, with the dot.

    Args:
        form: a name of `vopd.export.FORMATS`
    """
    return "." + FORMATS[form].suffixes[0].removeprefix(".")
