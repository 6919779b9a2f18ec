"""Structures that many tests share. Meshes are coarse where the point is an invariant."""

import gc
import importlib
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import IO

import numpy as np
import pandas as pd
import pytest
from pytest_regressions.num_regression import NumericRegressionFixture
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling

import casingfem as cf
from casingfem.io import probe
from contact.io import workers

# On an empty cache a loop takes longer to compile than its tests to run. Files that compile the same loops go to one
# process and go first, so that no two processes compile the same thing; what comes later finds the loops compiled. The
# loop of several contacts is that of the first file: the other group comes to it last.
# Files that need a browser go to one process, which starts one.
LOOPS = {
    "several contacts": [
        "test_patch.py",
        "test_one_step.py",
        "test_one_step_daqp.py",
        "test_bladed_disk.py",
        "test_scene_rub.py",
        "test_wear_tips.py",
        "test_rub.py",
        "test_rub_forces.py",
        "test_force_laws.py",
        "test_scene_laws.py",
        "test_turning_steps.py",
    ],
    "one contact": [
        "test_rim.py",
        "test_run_many.py",
        "test_beam.py",
        "test_record.py",
        "test_exact_modal.py",
        "test_scene.py",
        "test_scene_patch.py",
        "test_interaction.py",
        "test_stability.py",
        "test_wear.py",
        "test_docs.py",
    ],
    "browser": ["test_picture_gate.py", "test_plot_report.py", "test_pages_in_a_browser.py"],
}
# then those that take long, so that none is left for the end
LONG = (
    "test_chance.py",
    "test_localisation.py",
    "test_mistuning.py",
    "test_cli.py",
    "test_readme.py",
    "test_update_judged.py",
    "test_cli_contact.py",
    "test_turning_basis.py",
    "test_modes.py",
    "test_mesh_spin.py",
    "test_updating.py",
    "test_mesh_reduction.py",
    "test_completeness.py",
    "test_cli_correlate.py",
    "test_study_rig.py",
    "test_machine_code.py",
    "test_reference_frustum.py",
    "test_results.py",
    "test_cli_identify.py",
    "test_estimates.py",
    "test_ring.py",
    "test_output_only.py",
    "test_update_shapes.py",
    "test_plain_step.py",
    "test_checkpoint.py",
    "test_reading_writes_nothing.py",
    "test_identification.py",
    "test_broken_models.py",
    "test_matrices.py",
    "test_publication.py",
    "test_rubbing.py",
    "test_cli_update_shapes.py",
    "test_wheel.py",
    "test_sensitivity.py",
    "test_ahead.py",
    "test_hostile_input.py",
    "test_circle_scan.py",
    "test_rotor_contact.py",
    "test_report_mutants.py",
    "test_rotor_stability.py",
    "test_update_imported.py",
    "test_imported.py",
)
GROUP = {file: group for group, files in LOOPS.items() for file in files}
PLACE = {file: place for place, file in enumerate([*GROUP, *LONG])}


class Groups(LoadScopeScheduling):
    """A group of files, or a file, goes to one process. (Nodes of pytest 9.2 lose the marks of `--dist loadgroup`.)"""

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        return GROUP.get(Path(file).name, file)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> Groups:
    """Groups of tests in the order of the tests, not by their number."""
    config.option.loadscopereorder = False
    return Groups(config, log)


@pytest.hookimpl(tryfirst=True)
def pytest_collection(session: pytest.Session) -> None:
    """Each worker imports its share of all test files before it collects them all.

    Otherwise every worker would compile every file: where no bytecode is on disk that takes longer than the imports.
    A file that cannot be imported here fails when it is collected.
    """
    given = getattr(session.config, "workerinput", None)
    if given is None or [Path(each).name for each in session.config.args] != session.config.getini("testpaths"):
        return
    own, count = int(given["workerid"].removeprefix("gw")), int(given["workercount"])
    for file in sorted(Path(__file__).parent.rglob("test_*.py"))[own::count]:
        if str(file.parent) != sys.path[0]:
            sys.path.insert(0, str(file.parent))
        with suppress(Exception), warnings.catch_warnings():
            warnings.simplefilter("error")
            importlib.import_module(file.stem)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What compiles comes first, then what takes long."""
    items.sort(key=lambda item: PLACE.get(item.path.name, len(PLACE)))


def pytest_collection_finish() -> None:
    """Tests and libraries stay until the end: a collector that never examines them again saves a twentieth."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 100)


STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
REFERENCE = Path(__file__).parents[1] / "data" / "reference"


def reference_frustum(**changes: object) -> cf.Shell:
    """The frustum of data/reference/reference_frustum.csv, with anything replaced."""
    parts = {
        "chart": cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        "thickness": 3e-3,
        "material": STEEL,
        "supports": {"base": cf.Clamped()},
    }
    return cf.Shell(**(parts | changes))


@pytest.fixture(scope="session")
def steel() -> cf.Material:
    return STEEL


@pytest.fixture(scope="session")
def reference() -> Callable[[str], pd.DataFrame]:
    """Read a table of data/reference by name."""

    def read(name: str) -> pd.DataFrame:
        return pd.read_csv(REFERENCE / name, comment="#")

    return read


@pytest.fixture(scope="session")
def frustum() -> Callable[..., cf.Shell]:
    return reference_frustum


@pytest.fixture(scope="session")
def coarse() -> cf.ShellMesh:
    """Seven nodes along the meridian, 54 around: 1,890 dofs, good to n = 6."""
    return cf.ShellMesh(order=6, rows=1, around=9)


@pytest.fixture(scope="session")
def perfect_modes() -> cf.Modes:
    """First 40 modes of the reference frustum by the two-dimensional shell on the default mesh."""
    return cf.modes(reference_frustum(), 40, method="shell")


@pytest.fixture(scope="session")
def split_modes() -> cf.Modes:
    """First 40 modes with cos 8 theta, 0.2 % of the radius."""
    return cf.modes(reference_frustum(radius_defect=cf.FourierField.of({8: 0.002})), 40)


def forked(task: str, path: Path, module: str, function: str, stdout: IO[bytes] | int) -> tuple[int, str]:
    """As `probe.in_child`, in a copy of this process, which has loaded what readers need."""
    import resource

    call = getattr(importlib.import_module(module), function)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a fork beside threads; readers warn as in a process of their own
        child = os.fork()
        if child == 0:
            code = 1
            try:
                resource.setrlimit(resource.RLIMIT_CPU, (int(probe.SECONDS) + 1,) * 2)
                resource.setrlimit(resource.RLIMIT_AS, (int(probe.BYTES) + used,) * 2)
                stream = BytesIO() if isinstance(stdout, int) else stdout
                code = probe.give(stream, call, path)
                stream.flush()
            finally:
                os._exit(code)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    fault = f"its reader took more than {probe.SECONDS:g} s or {probe.BYTES / 1e9:g} GB, or crashed"
    return 0 if task == "read" and code == probe.REFUSED else code, fault


@pytest.fixture(scope="session", autouse=sys.platform == "linux")
def children_are_copies(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Readers and workers are copies of this process: a new one loads for seconds what they need.

    `test_probe.py` and `test_workers.py` test new ones. Programs copy themselves where they have one thread; here the
    threads of pytest-xdist wait for the network, and keep no lock.
    """
    threads = tmp_path_factory.mktemp("threads")
    (threads / "one").touch()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(probe, "in_child", forked)
        patched.setattr(workers, "THREADS", threads)
        yield


@pytest.fixture
def held(num_regression: NumericRegressionFixture) -> Callable[..., None]:
    """Hold arrays against those kept in a file beside the test: column for column, to `rtol`.

    Whoever changes numbers on purpose writes the file anew by `pytest --force-regen`, and reads in its difference what
    became of them. Numbers small beside the largest of their column are compared to `small` (1 %) of `rtol` of that; a
    fit that stops at a tolerance leaves its residuals open by a part of their standard deviation: there it is 1.
    Columns of phases or signs that another processor may choose otherwise do not belong here. That the numbers are
    true, other tests say.
    """

    def check(rtol: float = 1e-6, small: float = 0.01, **columns: object) -> None:
        found: dict[str, np.ndarray] = {}
        for name, column in columns.items():
            values = np.ravel(np.asarray(column))
            parts = (
                {f"{name}.re": values.real, f"{name}.im": values.imag} if np.iscomplexobj(values) else {name: values}
            )
            # without the NaN a column of whole numbers would come back from its file as such, and be compared exactly
            found |= {key: np.append(np.asarray(part, dtype=float), np.nan) for key, part in parts.items()}
        tops = {name: max((abs(x) for x in part if np.isfinite(x)), default=0.0) for name, part in found.items()}
        num_regression.check(found, tolerances={n: {"rtol": rtol, "atol": small * rtol * tops[n]} for n in found})

    return check
