"""What an imported shell is made of: middles, folds on both sides of what is allowed, walls, springs on its edges."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.structure.imported.parts import STEEL, flat, squares

PLIES = (cf.shell.Ply(thickness=1.0),)
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}
PLATE = cf.imported.grid_mesh("quad", (2, 1), lambda u: flat(u * [2.0, 3.0]), groups=ENDS)
OWN = replace(PLATE, groups={**PLATE.groups, "one": cf.imported.Group(nodes=PLATE.cells[1], cells=[1])})


def folded(angle):
    """Two squares that meet at an angle [degrees]."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    mesh = squares(np.zeros((6, 2)), [[0, 1, 2, 3], [1, 4, 5, 2]], cell_numbers=np.array([7, 8]), source="roof")
    x = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1 + c, 0, s], [1 + c, 1, s]]
    return replace(mesh, points=np.array(x))


def shell_of(mesh):
    return cf.MeshShell(mesh=mesh, thickness=0.1, material=STEEL)


@pytest.mark.parametrize("angle", [0.0, 9.9, -9.9])
def test_small_kinks_pass_without_a_word(angle):
    assert shell_of(folded(angle)).assembled().dofs == 5


@pytest.mark.parametrize(("angle", "dofs"), [(10.1, 5), (-10.1, 5), (24.9, 5), (25.1, 6), (60.9, 6)])
def test_kinks_are_doubted(angle, dofs):
    with pytest.warns(cf.errors.ModelWarning, match=rf"roof: 2 cells \(7, 8\) meet at up to {abs(angle):.0f} degrees"):
        assert shell_of(folded(angle)).assembled().dofs == dofs


@pytest.mark.parametrize("angle", [61.1, 90.0, -120.0, 174.0])
def test_at_a_fold_both_walls_have_their_own_director_and_one_rotation(angle):
    system = shell_of(folded(angle)).assembled()
    assert system.dofs == 6
    assert system.rigid == 6
    assert system.size == 2 * 6 + 4 * 5


def test_a_wall_folded_back_over_itself_is_refused():
    with pytest.raises(cf.errors.ModelError, match=r"roof: 2 cells \(7, 8\) overlap.*at 2 nodes \(2, 3\)"):
        shell_of(folded(176.0))


@pytest.mark.parametrize("t", [0.0, -1.0, np.nan, np.inf])
def test_thicknesses_are_above_zero(t):
    with pytest.raises(cf.errors.ModelError, match=rf"shell\.thickness must be above 0, found {t!r}"):
        cf.MeshShell(mesh=PLATE, thickness=t, material=STEEL)
    with pytest.raises(cf.errors.ModelError, match=rf"shell\.thicknesses\.one must be above 0, found {t!r}"):
        cf.MeshShell(mesh=OWN, thickness=0.1, thicknesses={"one": t}, material=STEEL)


def test_walls_and_inertia_of_groups():
    brass = cf.Material(E=100e9, nu=0.35, rho=8500.0)
    shell = cf.MeshShell(mesh=OWN, thickness=0.1, thicknesses={"one": 0.2}, material=STEEL, materials={"one": brass})
    assert shell.walls().tolist() == [[0.1, 0.2], [210e9, 100e9], [0.3, 0.35], [7800.0, 8500.0]]
    moments = shell.inertia(np.arange(2), np.zeros((3, 2, 1)))[:, :, 0]
    np.testing.assert_allclose(moments, [[780.0, 1700.0], [0.0, 0.0], [0.65, 8500.0 * 0.008 / 12.0]], rtol=1e-13)
    np.testing.assert_allclose(shell.density(), [780.0, 1700.0], rtol=1e-13)
    assert (shell.fibres, shell.wall, shell.shear_correction) == (None, "curved", None)
    layered = cf.MeshShell(mesh=OWN, thickness=0.1, material=STEEL, wall="linear", plies=PLIES,
                        angle_from=(1.0, 0.0, 0.0))  # fmt: skip
    assert layered.fibres.tolist() == [1.0, 0.0, 0.0]
    system = shell.assembled()
    assert system.wall == 0.1
    assert system.frequency_scale == pytest.approx(np.sqrt(100e9 / 8500.0) * 0.1 / 13.0, rel=1e-12)


@pytest.mark.parametrize(("degrees", "seen"), [(2.6, True), (2.5, False), (180.0 - 2.5, False)])
def test_plies_do_not_count_from_a_direction_across_the_wall(degrees, seen):
    """1 less the cosine is a thousandth at 2.56 degrees."""
    angle = np.radians(degrees)
    given = {"mesh": PLATE, "thickness": 0.1, "material": STEEL, "wall": "linear",
             "plies": PLIES, "angle_from": (0.0, 5.0 * np.sin(angle), 5.0 * np.cos(angle))}  # fmt: skip
    if seen:
        assert len(cf.MeshShell(**given).plies) == 1
    else:
        with pytest.raises(cf.errors.ModelError, match=r"shell\.angle_from: found .*to 2 cells \(1, 2\)"):
            cf.MeshShell(**given)


@pytest.mark.parametrize(("given", "told"), [
    ({"wall": "bent"}, r"shell\.wall: expected curved or linear, found 'bent'"),
    ({"plies": PLIES}, r"shell\.plies: found wall 'curved', expected wall \"linear\""),
    ({"plies": PLIES, "wall": "linear", "materials": {"one": STEEL}}, "found materials of groups"),
    ({"plies": PLIES, "wall": "linear", "angle_from": (0.0, 0.0, 0.0)}, "expected a vector"),
    ({"plies": PLIES, "wall": "linear", "angle_from": (0.0, np.inf, 0.0)}, "expected a vector"),
])  # fmt: skip
def test_layers_need_a_linear_wall_of_one_material_and_a_direction(given, told):
    with pytest.raises(cf.errors.ModelError, match=told):
        cf.MeshShell(mesh=OWN, thickness=0.1, material=STEEL, **given)
