"""How `make docs` builds these pages: Sphinx with furo, the gallery's scripts run, warnings are errors."""

import logging
import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent)]  # the pages' own modules; those of the checkout

os.environ["OPENBLAS_NUM_THREADS"] = "1"

logging.getLogger("skfem").setLevel(logging.WARNING)  # Sphinx shows what others only log

import casingfem  # noqa: E402

project = "casingfem"
html_show_copyright = False
version = release = casingfem.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "site_parts.api",
    "site_parts.mathml",
    "site_parts.links",
    "site_parts.checks",
]
exclude_patterns = ["gallery", "tutorial"]  # what is made of them is in built/
suppress_warnings = [
    "ref.python",  # fields of several classes have one name, and types of one name are in both packages
    "config.cache",  # the gallery's settings hold a function
]
html_theme = "furo"
html_title = f"casingfem {release}"
html_static_path, html_css_files = ["site_parts/static"], ["formulas.css"]
html_copy_source = False
html_math_renderer = "mathml"
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 4
default_role = "literal"
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
add_module_names = False
sphinx_gallery_conf = {
    "examples_dirs": ["tutorial", "gallery"],
    "gallery_dirs": ["built/tutorial", "built/gallery"],
    "subsection_order": [
        "gallery/casings", "gallery/blades", "gallery/measurements", "gallery/updating", "gallery/contact",
        "gallery/interaction",
    ],
    "filename_pattern": r"\.py$",
    "image_scrapers": ("site_parts.pictures.save",),
    "capture_repr": (),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 2,
    "remove_config_comments": True,
}  # fmt: skip
