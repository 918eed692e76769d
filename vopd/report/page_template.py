"""The templates of the pages, and the style and script that each page has in it."""

from __future__ import annotations

import base64
import hashlib
from importlib.resources import files
from typing import TYPE_CHECKING

from vopd.findings import VopdError

if TYPE_CHECKING:
    from jinja2 import Template


def page_template(name: str) -> Template:
    """A template of this folder, which escapes every text that is put into it.

    Args:
        name: the file

    Raises:
        VopdError: where jinja2 is not installed
    """
    try:
        from jinja2 import Environment, FunctionLoader, StrictUndefined
    except ImportError as error:
        raise VopdError("jinja2 is not installed: pip install 'vopd[report]'") from error
    loader = FunctionLoader(_file)
    environment = Environment(autoescape=True, undefined=StrictUndefined, loader=loader)
    return environment.get_template(name)


def style_and_script() -> dict[str, str]:
    """The values `style`, `script` and `policy` of a template.

    The policy, of content security, allows this style, this script and embedded images only.
    """
    style, script = _file("page.css"), _file("page.js")
    policy = (
        f"default-src 'none'; img-src data:; style-src {_allowed(style)}; "
        f"script-src {_allowed(script)}; base-uri 'none'; form-action 'none'"
    )
    return {"style": style, "script": script, "policy": policy}


def _allowed(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
    return f"'sha256-{digest}'"


def _file(name: str) -> str:
    return (files("vopd.report") / name).read_text(encoding="utf-8")
