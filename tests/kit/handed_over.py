"""What a command hands to the function that does its work, which is not done."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.kit.command import vopd


class Told(Exception):
    """The work is not done: what was asked for is known."""


def telling(told: list[Any]) -> Callable[..., Any]:
    """A function that notes its arguments and ends the command."""

    def work(*arguments: Any, **named: Any) -> Any:
        told.append((*arguments, *named.values()))
        raise Told

    return work


def handed(monkeypatch: pytest.MonkeyPatch, module: Any, name: str, *words: Any) -> Any:
    """What `name` is given when the command runs."""
    told: list[Any] = []
    monkeypatch.setattr(module, name, telling(told))
    with pytest.raises(Told):
        vopd(*words)
    return told[0]
