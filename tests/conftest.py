"""Structures that many tests share. Meshes are coarse where the point is an invariant."""

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from casingfem.modal.modes import Modes, modes
from casingfem.structure.chart import Frustum
from casingfem.structure.field import FourierField
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.shell import Shell
from casingfem.structure.support import Clamped

STEEL = Material(E=210e9, nu=0.3, rho=7800.0)
REFERENCE = Path(__file__).parents[1] / "data" / "reference"


def reference_frustum(**changes: object) -> Shell:
    """The frustum of data/reference/reference_frustum.csv, with anything replaced."""
    parts = {
        "chart": Frustum(r_base=0.50, r_top=0.45, height=0.25),
        "thickness": 3e-3,
        "material": STEEL,
        "supports": {"base": Clamped()},
    }
    return Shell(**(parts | changes))


@pytest.fixture(scope="session")
def steel() -> Material:
    return STEEL


@pytest.fixture(scope="session")
def reference() -> Callable[[str], pd.DataFrame]:
    """Read a table of data/reference by name."""

    def read(name: str) -> pd.DataFrame:
        return pd.read_csv(REFERENCE / name, comment="#")

    return read


@pytest.fixture(scope="session")
def frustum() -> Callable[..., Shell]:
    return reference_frustum


@pytest.fixture(scope="session")
def coarse() -> ShellMesh:
    """Seven nodes along the meridian, 54 around: 1,890 dofs, good to n = 6."""
    return ShellMesh(order=6, rows=1, around=9)


@pytest.fixture(scope="session")
def perfect_modes() -> Modes:
    """First 40 modes of the reference frustum by the two-dimensional shell on the default mesh."""
    return modes(reference_frustum(), 40, method="shell")


@pytest.fixture(scope="session")
def split_modes() -> Modes:
    """First 40 modes with cos 8 theta, .2 % of the radius."""
    return modes(reference_frustum(radius_defect=FourierField.of({8: 0.002})), 40)
