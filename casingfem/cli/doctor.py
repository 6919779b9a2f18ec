"""`casingfem doctor`: Python, packages and extras of this installation."""

import os
import platform
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import click

from casingfem.cli.running import deliver, options
from casingfem.extras import EXTRAS, remedy
from casingfem.io.side_by_side import usable_cores
from contact.io.outfiles import json_text

PACKAGES = ("casingfem", "numpy", "scipy", "scikit-fem", "numba", "pydantic", "pandas", "matplotlib", "jinja2")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
# OpenBLAS 0.3.34, of numpy 2.5.2, 2.5.3 and 2.5.5, ends the process here on processors without AVX-512: its issue 6026
PRODUCT = "import numpy as np; assert (np.ones((1000, 40)).T @ np.ones((1000, 8)) == 1000.0).all()"


@click.command()
@options
def doctor(as_json: bool, out: Path | None) -> None:
    """Versions, cores, BLAS and its threads, whether numba compiles, and installed extras."""
    document: dict[str, Any] = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "versions": {name: installed(name) for name in PACKAGES},
        "cores": {"machine": os.cpu_count(), "usable": usable_cores()},
        "blas": blas(),
        "products": products(),
        "threads": {name: os.environ.get(name) for name in THREADS},
        "numba": numba_compiles(),
        "machine_code": machine_code(),
        "extras": extras(),
    }
    deliver(document, text(document), as_json=as_json, out=out, files={"doctor.json": json_text(document)})


def installed(name: str) -> str | None:
    """Version of a package, None if it is not installed."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(name)
    except PackageNotFoundError:
        return None


def blas() -> str:
    """Name and version of numpy's BLAS."""
    import numpy as np

    config: Any = np.show_config(mode="dicts")
    found = config.get("Build Dependencies", {}).get("blas", {})
    return f"{found.get('name', 'unknown')} {found.get('version', '')}".strip()


def products() -> dict[str, object]:
    """Whether numpy's matrix product works on this processor, tested in a separate process."""
    done = subprocess.run([sys.executable, "-c", PRODUCT], capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return {"right": True}
    how = f"ended by signal {-done.returncode}" if done.returncode < 0 else done.stderr.strip().rpartition("\n")[2]
    return {"right": False, "why": f"numpy's matrix product: {how}", "install": "pip install 'numpy<2.5.2'"}


def numba_compiles() -> dict[str, object]:
    """Compile and call a small loop."""
    started = time.perf_counter()
    try:
        from numba import njit

        def total(n: int) -> float:
            sum_ = 0.0
            for k in range(n):
                sum_ += k
            return sum_

        compiled: Any = njit(total)
        right = compiled(5) == 10.0
    except Exception as error:  # any error of a broken compiler is a finding
        return {"compiles": False, "why": f"{type(error).__name__}: {error}"}
    return {"compiles": right, "seconds": time.perf_counter() - started}


def machine_code() -> dict[str, object]:
    """Directories of compiled contact loops that are read, the one that is written, and their numbers of loops."""
    from contact.jit import machine_code

    read, written = list(machine_code.directories()), machine_code.writable()
    loops = sum(map(machine_code.kept_in, read))
    return {"read": ", ".join(map(str, read)), "written": None if written is None else str(written), "loops": loops}


def extras() -> dict[str, dict[str, object]]:
    """Each extra: its purpose, its missing packages, and the command that installs them."""
    found: dict[str, dict[str, object]] = {}
    for name, extra in EXTRAS.items():
        missing = [package for package in extra.packages if installed(package) is None]
        install = remedy(name) if missing else None
        found[name] = {"for": extra.purpose, "installed": not missing, "missing": missing, "install": install}
    return found


def extra_lines(name: str, found: dict[str, Any]) -> list[str]:
    """Description of an extra, with the install command if it is missing."""
    state = "installed" if found["installed"] else f"not installed ({', '.join(found['missing'])})"
    lines = [f"{'extra ' + name:<30} {state}: {found['for']}"]
    return lines if found["installed"] else [*lines, f"{'':<30} {found['install']}"]


def text(document: dict[str, Any]) -> str:
    """The findings, one on each line."""
    lines = []
    for key, value in document.items():
        if key == "extras":
            lines += [line for name, found in value.items() for line in extra_lines(name, found)]
        elif isinstance(value, dict):
            lines += [f"{key + '.' + str(name):<30} {'-' if v is None else v}" for name, v in value.items()]
        else:
            lines.append(f"{key:<30} {value}")
    return "\n".join(lines)
