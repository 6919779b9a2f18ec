"""The version of the installed distribution, which contains both packages, and versions that affect results."""

import platform
from functools import cache
from importlib.metadata import version

__version__ = version("casingfem")


def versions() -> dict[str, str]:
    """Versions of the packages a result depends on."""
    return dict(_installed())


@cache
def _installed() -> dict[str, str]:
    """Version, cached, since reading package metadata took a third of the time of a short run."""
    return {"python": platform.python_version(), **{name: version(name) for name in ("casingfem", "numpy", "numba")}}
