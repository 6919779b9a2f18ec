"""Pages of examples show no assertions: a page leaves them out, the script that it offers for download has them."""

import re

from sphinx.application import Sphinx

ASSERTION = re.compile(r"^ {4}assert .*\n(?: {5,}.*\n| {4}[)\]}].*\n)*", re.MULTILINE)
EMPTY = re.compile(r"^\.\. code-block:: Python\n(?: {3}:.*\n)*\n*(?=\S|\Z)", re.MULTILINE)


def without_assertions(text: str) -> str:
    r"""A page of an example without its assertions.

    >>> without_assertions("    print(x)\n    assert abs(\n        x\n    ) < 1.0\n    y = 2\n")
    '    print(x)\n    y = 2\n'
    >>> without_assertions("Equal.\n\n.. code-block:: Python\n\n    assert x == 1.0\n\nMore.\n")
    'Equal.\n\nMore.\n'
    """
    return EMPTY.sub("", ASSERTION.sub("", text))


def shown(app: Sphinx, docname: str, source: list[str]) -> None:
    """Leave the assertions of an example out of its page."""
    if docname.startswith("built/"):
        source[0] = without_assertions(source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", shown)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
