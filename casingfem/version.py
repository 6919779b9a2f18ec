"""The version of the installed distribution, which contains both packages."""

from importlib.metadata import version

__version__ = version("casingfem")
