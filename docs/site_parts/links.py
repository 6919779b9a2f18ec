"""Links that lead out of docs/ to files: here to a page of the site, a copy of the file, or to nothing."""

import re
from pathlib import Path

from sphinx.application import Sphinx

LINK = re.compile(r"(?<!!)\[([^][]+)\]\(([^)#\s]+)(#[\w-]+)?\)")


def here(app: Sphinx, docname: str, source: list[str]) -> None:
    """Rewrite the links of a page."""
    folder, own = Path(app.env.doc2path(docname)).parent, Path(app.srcdir).resolve()

    def to(found: re.Match[str]) -> str:
        words, target, anchor = found[1], found[2], found[3] or ""
        if "://" in target:
            return found[0]
        path = (folder / target).resolve()
        up = "../" * len(folder.resolve().relative_to(own).parts)
        if path.is_relative_to(own / "gallery") or path.is_relative_to(own / "tutorial"):
            part = path.relative_to(own).with_suffix("").as_posix()
            return f"[{words}]({up}built/{part if path.suffix else f'{part}/index'})"
        if path == own.parent / "README.md":
            return f"[{words}](/index.md{anchor})"
        if path.is_dir():
            return words
        return found[0]

    source[0] = LINK.sub(to, source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", here)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
