"""Texts read as files of a flight project, without a folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from vopd.findings import VopdError
from vopd.flight.files import InputFile, InputFormat, read_by_content
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion, LensRead


def read_text(formats: Sequence[InputFormat[Any]], name: str, text: str, *more: Any) -> Any:
    """What a text says by the first of these formats that recognises it."""
    return read_by_content(formats, InputFile(name, Path("nowhere") / name, text), *more)


def text_told(formats: Sequence[InputFormat[Any]], name: str, text: str, *more: Any) -> str:
    """The message by which a text is refused."""
    with pytest.raises(VopdError) as refused:
        read_text(formats, name, text, *more)
    return str(refused.value)


def read_lens_text(text: str, **question: Any) -> LensRead:
    """The lens in a text, the file of which is called `lens`."""
    found: LensRead = read_text(LENS_FORMATS, "lens", text, LensQuestion(**question))
    return found


def lens_told(text: str, **question: Any) -> str:
    """The message by which the text of a lens is refused."""
    return text_told(LENS_FORMATS, "lens", text, LensQuestion(**question))
