"""The attitude table as a pandas DataFrame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vopd.attitude.conventions import conventions
from vopd.attitude.history import History
from vopd.attitude.table_columns import table
from vopd.findings import VopdError

if TYPE_CHECKING:
    import pandas as pd


def dataframe(histories: Sequence[History]) -> pd.DataFrame:
    """The attitude table of these jobs, a row a frame, with the conventions in `attrs`.

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
    frame = pd.DataFrame(table(histories))
    frame.attrs.update(conventions(histories))
    return frame
