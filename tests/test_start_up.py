"""What starts quickly stays so: which modules are loaded, not how long that takes."""

import ast
import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

import casingfem
import contact
from reports.benchmarks.start_up import HEAVY, HELP, loaded, main

ROOT = Path(__file__).parents[1]
STUBS = sorted(
    ".".join(stub.parent.relative_to(ROOT).parts)
    for package in ("casingfem", "contact")
    for stub in (ROOT / package).rglob("__init__.pyi")
)
# of contact, casingfem loads what writes files, and what its package loads itself
WRITERS = {
    "contact",
    "contact.io",
    "contact.io.publication.digests",
    "contact.io.infiles",
    "contact.io.trust",
    "contact.io.interrupts",
    "contact.io.publication",
    *(f"contact.io.publication.{part}" for part in ("lock", "manifest", "moves", "reading", "recovery", "staging")),
    "contact.io.names",
    "contact.io.npz",
    "contact.io.outfiles",
    "contact.io.progress",
}


@pytest.mark.slow
@pytest.mark.parametrize("code", [HELP, "import casingfem", "import contact"], ids=["help", "casingfem", "contact"])
def test_starting_loads_no_heavy_package(code):
    modules = loaded(code)
    assert [package for package in HEAVY if package in modules] == []
    assert "importlib.metadata" not in modules
    other = "casingfem" if code == "import contact" else "contact"
    assert {name for name in modules if name.split(".")[0] == other} <= WRITERS


@pytest.mark.slow
def test_a_name_is_loaded_when_it_is_used_and_what_it_does_not_need_stays_away():
    modules = loaded("import contact; contact.Rod")
    assert "contact.model.bodies.body" in modules
    assert not modules & {"contact.result", "contact.model.gaps.rub", "scipy", "numba", "pydantic"}


@pytest.mark.parametrize("name", STUBS)
def test_every_name_of_a_stub_is_there_and_comes_from_its_module(name):
    package = importlib.import_module(name)
    stub = Path(package.__file__).with_suffix(".pyi")
    parts = ast.parse(stub.read_text(encoding="utf-8")).body
    home = {alias.name: part.module for part in parts if isinstance(part, ast.ImportFrom) for alias in part.names}
    stated = ast.literal_eval(parts[-1].value)
    assert sorted(stated) == sorted(home) == sorted(package.__all__) == sorted(dir(package))
    for one, module in home.items():
        where = importlib.import_module(f"{name}.{module or one}")
        assert getattr(package, one) is (getattr(where, one) if module else where)


@pytest.mark.parametrize(("package", "most"), [(casingfem, 60), (contact, 40)])
def test_the_top_of_a_package_has_few_names_with_its_rooms(package, most):
    assert sum(not name.startswith("_") for name in package.__all__) <= most


@pytest.mark.slow
def test_a_module_loaded_first_does_not_take_the_place_of_a_function_of_its_name():
    loaded("import contact.run, contact.stability.closed_contact, contact.run_many\n"
           "from contact import run, run_many\n"
           "assert callable(run) and callable(run_many) and callable(contact.run)")  # fmt: skip


def test_a_name_that_is_not_there_is_refused_by_its_name():
    name = "modess"
    with pytest.raises(AttributeError, match=f"casingfem attribute {name}"):
        getattr(casingfem, name)


@pytest.mark.campaign
def test_the_report_has_a_row_for_each_command(tmp_path):
    rows = {row["command"]: row for row in main(tmp_path, quick=True)}
    assert rows["import numpy"]["of them heavy"] == "numpy"
    assert rows["import contact"]["of them heavy"] is None
    assert rows["casingfem.modes"]["modules"] > rows["casingfem.Shell"]["modules"] > rows["import casingfem"]["modules"]
    assert all(0.0 < row["least [s]"] <= row["median [s]"] for row in rows.values())


SHOWN = """import os, runpy, sys
sys.argv = ["casingfem", "--version"]
try:
    runpy.run_module("casingfem", run_name="__main__")
except SystemExit:
    print([os.environ.get(name) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")])
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "found"),
    [
        ({}, [None, "1", "1"]), ({"OMP_NUM_THREADS": "4"}, ["4", None, None]),
        ({"OPENBLAS_NUM_THREADS": "4"}, [None, "4", None]), ({"MKL_NUM_THREADS": "4"}, [None, None, "4"]),
    ],
)  # fmt: skip
def test_the_command_line_gives_blas_one_thread_unless_the_environment_sets_a_number(given, found):
    kept = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    command = [sys.executable, "-c", SHOWN]
    done = subprocess.run(command, env=kept | given, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == str(found)


UPDATED = """import numpy, scipy.linalg, threadpoolctl
import casingfem as cf
import contact as ct

def threads():
    return sorted({one["num_threads"] for one in threadpoolctl.threadpool_info() if one["user_api"] == "blas"})

plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
                 material=cf.Material(E=200e9, nu=0.3, rho=7800.0), mesh=cf.ShellMesh(order=4, rows=1, around=1))
threadpoolctl.threadpool_limits(2)
seen = []
table = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 2).freq * 1.01, sigma_hz=0.01)
vary = [cf.Parameter(name="material.E", lower=150e9, upper=250e9)]
rod = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=20, x=5.0, velocity=-10.0)

def first(*_):
    seen.append(threads())
    raise KeyboardInterrupt

for work in (
    lambda: cf.update(plate, table, vary, progress=first),
    lambda: ct.run([rod, ct.Wall(x=0.0)], t_end=2.0, courant=0.9, progress=first),
):
    try:
        work()
    except KeyboardInterrupt:
        print(threads(), *seen)
        seen.clear()
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "inside"),
    [({}, "[1]"), ({"OMP_NUM_THREADS": "2,1"}, "[2]")],
)
def test_an_update_and_a_run_in_a_script_use_one_blas_thread_unless_the_environment_sets_a_number(given, inside):
    kept = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    command = [sys.executable, "-W", "ignore", "-c", UPDATED]
    done = subprocess.run(command, env=kept | given, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-2:] == [f"[2] {inside}"] * 2
