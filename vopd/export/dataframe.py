"""The attitude table as a pandas DataFrame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.attitude.table_values import matrices, table
from vopd.findings import VopdError

if TYPE_CHECKING:
    import pandas as pd


def dataframe(histories: Sequence[History]) -> pd.DataFrame:
    """The attitude table of these jobs, a row a frame, with the conventions in `attrs`.

    The columns of `matrices` hold an array of 3 x 3 in each row; `numpy.stack` makes one
    array of such a column.

    Args:
        histories: one or more jobs, of one kind of source

    Raises:
        VopdError: where pandas is not installed, or there is no job
    """
    try:
        import pandas as pd
    except ImportError as error:
        raise VopdError("pandas is not installed: pip install 'vopd[pandas]'") from error
    if not histories:
        raise VopdError("the run has no job")
    arrays = {name: list(frames) for name, frames in matrices(histories).items()}
    frame = pd.DataFrame(table(histories) | arrays)
    frame.attrs.update(conventions(histories))
    return frame
