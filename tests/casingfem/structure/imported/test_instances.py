"""Abaqus parts and assemblies: instances moved and turned, their sets, surfaces and numbers; refusals with the line."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.mesh_files import write_inp

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BAR = cf.imported.grid_mesh(
    "hexahedron20", (2, 1, 1), lambda u: u * [1.0, 0.2, 0.1], groups={"root": (0, 0.0), "tip": (0, 1.0)}
)


def part(folder, name="P"):
    write_inp(BAR, folder / "flat.inp")
    body = (folder / "flat.inp").read_text().partition("*NODE\n")[2]
    return f"*PART, NAME={name}\n*NODE\n{body}*SURFACE, NAME=END\n1, S1\n*END PART\n"


def read(folder, text):
    (folder / "part.inp").write_text(text)
    return cf.read_mesh(folder / "part.inp")


def test_one_instance_keeps_numbers_and_names_where_it_is_put(tmp_path):
    """Shifted first, then turned by 90 degrees about an axis along z through (1, 0, 0)."""
    text = part(tmp_path) + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n0.5, 0., 2.\n"
    text += "1., 0., 0., 1., 0., 5., 90.\n*END INSTANCE\n*NSET, NSET=held, INSTANCE=I\nroot\n*END ASSEMBLY\n"
    found = read(tmp_path, text)
    x, y, z = BAR.points.T
    np.testing.assert_allclose(found.points, np.stack([1.0 - y, (x + 0.5) - 1.0, z + 2.0], axis=1), atol=1e-12)
    assert np.array_equal(found.cells, BAR.cells)
    assert found.node_numbers.tolist() == list(range(1, len(BAR.points) + 1))
    assert np.array_equal(found.groups["root"].nodes, BAR.groups["root"].nodes)
    assert np.array_equal(found.groups["held"].nodes, BAR.groups["root"].nodes)
    assert len(found.groups["END"].facets) == 1


def test_two_instances_of_one_part_make_one_bar_when_joined(tmp_path):
    """The second begins where the first ends; sets are called I.set, numbers go on beyond a power of ten."""
    text = part(tmp_path) + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=one, PART=P\n*END INSTANCE\n"
    text += "*INSTANCE, NAME=two, PART=P\n1., 0., 0.\n*END INSTANCE\n"
    text += "*NSET, NSET=far, INSTANCE=two\ntip\n*NSET, NSET=nodes, INSTANCE=two\n1, 2\n"
    text += "*ELSET, ELSET=all\none.body, two.body\n*SURFACE, NAME=both\none.body, S1\n*END ASSEMBLY\n"
    (tmp_path / "part.inp").write_text(text)
    with pytest.raises(cf.errors.ModelError, match="2 parts that"):
        cf.Solid(mesh=cf.read_mesh(tmp_path / "part.inp"), material=STEEL)
    found = cf.read_mesh(tmp_path / "part.inp", join=1e-6)
    long = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), lambda u: u * [2.0, 0.2, 0.1], groups={"root": (0, 0.0)})
    assert len(found.points) == len(long.points)
    held, exact = (
        cf.modes(cf.Solid(mesh=mesh, material=STEEL, supports={name: cf.Clamped()}), 4).freq
        for mesh, name in ((found, "one.root"), (long, "root"))
    )
    np.testing.assert_allclose(held, exact, rtol=1e-9)
    assert np.ptp(found.points[found.groups["far"].nodes, 0]) == 0.0
    assert found.points[found.groups["far"].nodes[0], 0] == pytest.approx(2.0)
    assert len(found.groups["all"].cells) == 4
    assert {"one.tip", "two.tip", "two.root"} <= set(found.groups)
    assert set(found.cell_numbers.tolist()) == {1, 2, 101, 102}


@pytest.mark.parametrize(
    ("assembly", "message"),
    [
        ("", r"\*PART: found several parts without \*INSTANCE"),
        ("*INSTANCE, NAME=I, PART=Q\n*END INSTANCE\n", r"\*INSTANCE: found no part 'Q'"),
        ("*INSTANCE, NAME=I, PART=P\n1., 2.\n*END INSTANCE\n", "expected dx, dy, dz"),
        ("*INSTANCE, NAME=I, PART=P\n1., 2., x\n*END INSTANCE\n", "found '1., 2., x', expected numbers"),
        ("*INSTANCE, NAME=I, PART=P\n1., 2., 3., 4.\n*END INSTANCE\n", "expected dx, dy, dz, and"),
        ("*INSTANCE, NAME=I, PART=P\n1,2,3\n1,1,1,2,2,2\n*END INSTANCE\n", "expected dx, dy, dz, and"),
        ("*INSTANCE, NAME=I, PART=P\n1,2,3\n1,1,1,2,2,2,90\n1,2,3\n*END INSTANCE\n", "expected dx, dy, dz"),
        ("*INSTANCE, NAME=I, PART=P\n1,2,3\n1,1,1,2,2,x,90\n*END INSTANCE\n", "found '1,1,1,2,2,x,90', expected"),
        ("*INSTANCE, NAME=I, PART=P\n1., 2., 1e15\n*END INSTANCE\n", r"found '1\., 2\., 1e15', expected numbers below"),
        (
            "*INSTANCE, PART=P\n*END INSTANCE\n",
            r"\*INSTANCE: found the name '', expected a name that no other instance",
        ),
        ("*INSTANCE, NAME=a, PART=P\n*END INSTANCE\n*INSTANCE, NAME=A, PART=P\n*END INSTANCE\n", "the name 'A'"),
        (
            "*INSTANCE, NAME=I, PART=P\n0,0,0\n1,1,1,1,1,1,90.\n*END INSTANCE\n",
            "found one place",
        ),
        ("*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*NSET, NSET=A, INSTANCE=J\n1\n", "no instance"),
        ("*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n*NSET, NSET=A, INSTANCE=I\nrot\n", "no set 'rot' above this line"),
    ],
)
def test_assemblies_that_cannot_be_laid_out_name_the_line(assembly, message, tmp_path):
    text = part(tmp_path) + (part(tmp_path, "P2") if not assembly else "") + assembly
    with pytest.raises(cf.errors.ModelError, match=f"part.inp: line \\d+: .*{message}"):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("rows", "moved"),
    [
        ("5., 6., 7.", (5.5, 6.25, 9.0)),
        ("1., 2., 3.\n1., 2., 3., 1., 2., 7., 90.,", (0.75, 2.5, 5.0)),  # about the axis from (1, 2, 3) along z
        ("0., 0., 0.\n0,0,1,2,2,1,180", (0.25, 0.5, 0.0)),  # about one along (1, 1, 0) at z = 1
        ("0,0,0\n0,0,0,0,2,0,-90", (-2.0, 0.25, 0.5)),  # about y
        ("1., 2., 9.99e14", (1.5, 2.25, 9.99e14)),
    ],
)
def test_an_instance_is_shifted_and_then_turned_about_its_axis(rows, moved, tmp_path):
    """The point (0.5, 0.25, 2)."""
    body = "*PART, NAME=P\n*NODE\n1, .5, .25, 2.\n2, 1., 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.\n"
    body += "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*END PART\n"
    found = read(tmp_path, f"{body}*INSTANCE, NAME=I, PART=P\n{rows}\n*END INSTANCE\n")
    np.testing.assert_allclose(found.points[0], moved, rtol=1e-13, atol=1e-13)
