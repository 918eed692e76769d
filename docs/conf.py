"""The documentation as a site, made by Sphinx from the Markdown pages and the docstrings.

    python -m sphinx -W --keep-going -c docs . docs/_build

The source folder is the repository, not docs/: so the README files of the decks and of the golden
outputs are pages too, and every link between files is the same here and on the project's forge.
"""

from __future__ import annotations

import re
from pathlib import Path

from pygments.lexers.shell import BashSessionLexer
from sphinx.application import Sphinx

from vopd.version import __version__

project = "vopd"
author = "The vopd developers"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]

root_doc = "docs/site/index"
include_patterns = [
    "*.md",
    "docs/**",
    "decks/**.md",
    "golden_outputs/**.md",
    "tools/**.md",
]
exclude_patterns = ["docs/_build", "docs/site/templates"]
templates_path = [str(Path(__file__).parent / "site" / "templates")]

myst_heading_anchors = 4  # links to headings, as the forge has them
myst_enable_extensions: list[str] = []  # what the forge does not know is not used
smartquotes = False  # what stands in a docstring can be pasted
default_role = "py:obj"  # `name` in a docstring is a link where the name is documented

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: f"vopd.arrays.{name}" for name in ("Floats", "Ints", "Bools")}
maximum_signature_line_length = 80
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True  # attributes that a docstring lists are not listed twice
autosummary_ignore_module_all = False

html_theme = "furo"
html_title = f"vopd {release}"
html_extra_path = ["site/static"]  # sends a reader from / to the first page
html_copy_source = False
html_show_copyright = False


class ConsoleLexer(BashSessionLexer):
    """A ```console block, in which only a line that begins with `$ ` is a command."""

    _ps1rgx = re.compile(r"^(\$ )(.*\n?)")


def setup(app: Sphinx) -> None:
    """Add to Sphinx what it has no setting for."""
    app.add_lexer("console", ConsoleLexer)
