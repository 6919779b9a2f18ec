"""The picture of an example of the gallery: what it calls `figure`, pyplot's or not."""

from typing import Any

from sphinx_gallery.scrapers import figure_rst

from casingfem.plot.style import png


def save(block: Any, variables: dict[str, Any], settings: dict[str, Any], **_: Any) -> str:
    """Write `figure` once, after the block that drew it; the text that shows it."""
    shown = variables["example_globals"].get("figure")
    if shown is None or getattr(shown, "in_gallery", False):
        return ""
    shown.in_gallery = True
    path = next(variables["image_path_iterator"])
    with open(path, "wb") as stream:
        stream.write(png(shown, dpi=110))
    return str(figure_rst([path], settings["src_dir"], shown.get_suptitle()))
