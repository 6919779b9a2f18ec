"""Cost of start-up: processor seconds and modules of `casingfem --help` and of importing the packages.

`python -m reports.benchmarks.start_up [--quick] [--out DIR]`. Each command runs in a process of its own, with its files
in the disk cache. Times are user and system seconds of that process; a busy machine makes them longer. The first rows
give the times of Python, numpy and click alone, as lower bounds. Importing a package loads none of its modules: each
name is loaded when it is first used, so the last rows use one.
"""

import os
import subprocess
import sys
from pathlib import Path
from statistics import median

from reports.tables import Row, command_line, show, write

HELP = "from casingfem.cli import main; main(['--help'], standalone_mode=False)"
COMMANDS = {
    "python": "pass",
    "import numpy": "import numpy",
    "import click": "import click",
    "casingfem --help": HELP,
    "import casingfem": "import casingfem",
    "import contact": "import contact",
    "casingfem.Shell": "import casingfem; casingfem.Shell",
    "casingfem.modes": "import casingfem; casingfem.modes",
    "contact.Rod": "import contact; contact.Rod",
    "contact.run": "import contact; contact.run",
}
HEAVY = ("numpy", "scipy", "pydantic", "pandas", "matplotlib", "skfem", "meshio", "numba", "rich", "jinja2")
TELL = "; import sys; print(*sys.modules, file=sys.stderr)"


def main(out: Path, quick: bool = False) -> list[Row]:
    """Print and write the table; returns its rows."""
    times = 1 if quick else 15
    rows = []
    for name, code in COMMANDS.items():
        modules = loaded(code)  # and warms the files
        spent = [seconds(code) for _ in range(times)]
        heavy = [package for package in HEAVY if package in modules]
        rows.append(
            {
                "command": name,
                "median [s]": median(spent),
                "least [s]": min(spent),
                "modules": len(modules),
                "of them heavy": ", ".join(heavy) or None,
            }
        )
    show(f"User and system seconds of {times} processes each", rows)
    write(out / "start_up.csv", rows)
    return rows


def loaded(code: str) -> set[str]:
    """Names of the modules that a process has loaded at its end."""
    done = subprocess.run([sys.executable, "-c", code + TELL], capture_output=True, text=True, check=True)
    return set(done.stderr.split())


def seconds(code: str) -> float:
    """User and system seconds of a process."""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{code!r} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    command_line(__doc__, main)
