"""Optional packages: purpose, contents and installation of each extra."""

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

ROOT = Path(__file__).parents[1]  # of a checkout, else the folder of all installed packages


class Extra(NamedTuple):
    """An extra: its purpose and the packages it installs."""

    purpose: str
    packages: tuple[str, ...]


EXTRAS: Mapping[str, Extra] = MappingProxyType(
    {
        "test-data": Extra("responses in HDF5 files, motions for ParaView (--vtu)", ("h5py",)),
        "sampling": Extra("a sampled posterior of an update (update --posterior emcee)", ("emcee",)),
        "cluster": Extra("sweeps and chances on a Dask cluster (sweep, chance --scheduler)", ("distributed",)),
        "excel": Extra("tables in Excel workbooks (.xlsx)", ("openpyxl",)),
        "gpu": Extra("many rubs at once on a CUDA device (contact.gpu.device_runs)", ("numba-cuda",)),
        "direct": Extra("MKL's factorisation for modes of large structures (direct = pardiso)", ("pypardiso",)),
        "docs": Extra("these pages as a site (make docs)", ("sphinx", "furo", "sphinx-gallery", "myst-parser")),
        "dev": Extra(
            "tests, checks and types of the project itself, with the first four",
            (
                "h5py", "emcee", "distributed", "openpyxl", "pytest", "pytest-regressions", "pytest-xdist",
                "mypy", "ruff", "import-linter", "pandas-stubs", "pyuff", "daqp", "setuptools",
            ),
        ),
    }
)  # fmt: skip


def remedy(extra: str) -> str:
    """The command that installs an extra for the running Python, in a checkout or an installed package.

    >>> remedy("sampling").partition(" -m ")[2].startswith("pip install ")
    True
    """
    checkout = (ROOT / "pyproject.toml").is_file()
    where = ["-e", f"{ROOT}[{extra}]"] if checkout else [f"casingfem[{extra}]"]
    return shlex.join([sys.executable, "-m", "pip", "install", *where])
