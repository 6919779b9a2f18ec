"""Tables of study.toml that many tests begin with; each test adds the tables that matter to it."""

from pathlib import Path

STEEL = """
[material]
E = 210e9
nu = 0.3
rho = 7800.0
"""
FRUSTUM = f"""{STEEL}[chart]
kind = "frustum"
r_base = 0.50
r_top = 0.45
height = 0.25
"""
THIN = f"""{FRUSTUM}[shell]
thickness = 3.0e-3
"""
# short and thick: few nodal diameters, so a coarse mesh resolves all that is asked of it
THICK = f"""{FRUSTUM}[shell]
thickness = 20e-3
[[imperfection]]
of = "radius"
harmonics = [{{p = 6, cos = 0.004}}]
[support.base]
kind = "elastic"
k_face = 1e12
[modes]
count = 6
[mesh]
order = 5
rows = 1
around = 9
[reduce]
interface = "top"
n_max = 6
modes = 8
"""
# a cantilever plate with three modes
PLATE = """
material = {E = 70e9, nu = 0.3, rho = 2700.0}
chart = {kind = "plate", length = 0.3, width = 0.1}
shell = {thickness = 3e-3}
support.root = {kind = "clamped"}
modes = {count = 3}
mesh = {order = 4, rows = 1, around = 1}
"""
# a clamped steel plate on one element
STEEL_PLATE = f"""{STEEL}[chart]
kind = "plate"
length = 0.2
width = 0.04
[shell]
thickness = 3e-3
[support.root]
kind = "clamped"
[mesh]
order = 5
rows = 1
around = 1
"""


def written(folder: Path, text: str) -> Path:
    """Write study.toml."""
    file = folder / "study.toml"
    file.write_text(text, encoding="utf-8")
    return file


def named(problems: list[str]) -> list[str]:
    """What was wrong in s.toml, without the file's name."""
    return [problem.removeprefix("s.toml: ") for problem in problems]
