"""Element matrices and what stands on edges as one sum, against the energies of motions."""

import numpy as np
import pytest

from casingfem.linalg.element_sum import ElementSum
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.section import Section
from casingfem.structure.edge.support import ElasticEdge, ShearDiaphragm
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.shell.assembly import assemble
from casingfem.structure.shell.energies import modal_products, point_fields


@pytest.mark.parametrize("supports", [
    {"base": ElasticEdge(k_r=3e8, k_z=2e7, k_face=1e11, around=FourierField.of({2: 0.3})), "top": ShearDiaphragm()},
    {"base": ShearDiaphragm(), "top": Ring(section=Section.rectangle(width=0.02, depth=0.01))},
])  # fmt: skip
def test_the_sum_of_elements_has_the_energy_of_motions(frustum, coarse, supports):
    """Springs that vary around, directions held in an edge's frame, a ring with turns of its own."""
    system = assemble(frustum(mesh=coarse, supports=supports))
    assert isinstance(system.stiffness, ElementSum) is (system.change is None)
    V = np.random.default_rng(4).standard_normal((system.size, 3))
    energies = modal_products(
        system.shell, point_fields(system.shell, system.grid, system.expand(V), system.expand_own(V))
    ).K
    np.testing.assert_allclose(V.T @ (system.stiffness @ V), energies, rtol=1e-10)
    np.testing.assert_allclose(V.T @ (system.K @ V), energies, rtol=1e-10)
