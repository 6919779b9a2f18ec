"""Tied faces: those that match against one mesh, others against CalculiX and one mesh; rigid and linear motions."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.mesh_files import write_inp
from tests.casingfem.structure.imported.parts import STEEL, supported

ENDS = {"low": (0, 0.0), "high": (0, 1.0)}
QUIET = ("mesh-linear-cells", "mesh-thin-curved")
pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in QUIET]


def block(kind, counts, start, length):
    return cf.imported.grid_mesh(kind, counts, lambda u: u * [length, 0.1, 0.12] + [start, 0.0, 0.0], groups=ENDS)


def pair(kind, first, other):
    """Blocks of 0.3 and 0.4 m in a row, 0.1 by 0.12 m, nothing joined."""
    return cf.imported.beside({"a": block(kind, first, 0.0, 0.3), "b": block(kind, other, 0.3, 0.4)})


GLUE = cf.imported.Gluing(follower="b.low", master="a.high")


@pytest.mark.slow
def test_faces_that_do_not_match_are_those_of_calculix():
    """2 x 2 x 2 and 3 x 3 x 3 C3D20, *TIE with ADJUST: *FREQUENCY of CalculiX 2.20, E = 210e9, nu = 0.3, rho = 7800."""
    part = supported(cf.imported.tied(pair("hexahedron20", (2, 2, 2), (3, 3, 3)), [GLUE]), "a.low")
    found = cf.modes(part, 6).freq
    np.testing.assert_allclose(found, [171.8851, 204.6305, 995.9702, 1057.227, 1147.342, 1868.787], rtol=5e-7)
    one = cf.modes(supported(block("hexahedron20", (5, 3, 3), 0.0, 0.7), "low"), 6).freq
    np.testing.assert_allclose(found, one, rtol=8e-3)  # the coarse half, 0.7 % at the worst


def sectors(kind, first, other):
    """Half rings of a tube one above the other, meshed with other pieces around: the joint is curved."""

    def upon(z):
        place = cf.imported.revolved((0.5, 0.5), z, 0.05)
        if kind == "quad8":
            return lambda u: place(np.column_stack([np.full(len(u), 0.5), 0.5 * u[:, 0], u[:, 1]]))
        return lambda u: place(u * [1.0, 0.5, 1.0])

    axis = 1 if kind == "quad8" else 2
    ends = {"low": (axis, 0.0), "high": (axis, 1.0)}
    return cf.imported.beside({"a": cf.imported.grid_mesh(kind, first, upon((0.0, 0.2)), groups=ends),
                   "b": cf.imported.grid_mesh(kind, other, upon((0.2, 0.5)), groups=ends)})  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "first", "other"), [("hexahedron20", (1, 4, 1), (1, 7, 2)), ("quad8", (4, 1), (7, 2))]
)
def test_ties_across_a_curved_joint_resist_no_rigid_motion(kind, first, other):
    """Nodes that follow are moved onto the facets; free, the part has six motions, all with no energy."""
    mesh = cf.imported.tied(sectors(kind, first, other), [GLUE])
    if kind == "quad8":
        part = cf.MeshShell(mesh=mesh, thickness=0.05, material=STEEL)
    else:
        part = cf.Solid(mesh=mesh, material=STEEL)
    system = part.assembled()
    values = cf.modes(part, 8, system=system)
    assert system.rigid == 6
    assert values.freq[5] < 1e-2 * values.freq[6]
    assert values.sturm_count == len(values.freq)
    moved = np.linalg.norm(mesh.points - sectors(kind, first, other).points, axis=1)
    assert 0.0 < moved.max() < 2e-3


def test_a_linear_motion_passes_a_tie_unchanged():
    part = cf.Solid(mesh=cf.imported.tied(pair("tetra10", (1, 2, 1), (1, 1, 3)), [GLUE]), material=STEEL)
    system = part.assembled()
    gradient = np.array([[1.0, 0.3, -0.2], [0.1, -0.5, 0.4], [0.0, 0.7, 0.6]])
    field = (part.mesh.points @ gradient.T)[:, :, None]
    np.testing.assert_allclose(system.expand(system.collect(field)), field, atol=1e-13)


@pytest.mark.slow
def test_shells_are_tied_edge_to_edge():
    """A clamped plate of two pieces, three and four cells wide, against one of four."""

    def plate(counts, start, length):
        return cf.imported.grid_mesh(
            "quad8", counts, lambda u: np.insert(u * [length, 0.4] + [start, 0.0], 2, 0.0, axis=1), groups=ENDS
        )

    pieces = cf.imported.beside({"a": plate((2, 3), 0.0, 0.3), "b": plate((2, 4), 0.3, 0.3)})
    found, one = (
        cf.modes(cf.MeshShell(mesh=mesh, thickness=5e-3, material=STEEL, supports={name: cf.Clamped()}), 4).freq
        for mesh, name in ((cf.imported.tied(pieces, [GLUE]), "a.low"), (plate((4, 4), 0.0, 0.6), "low"))
    )
    np.testing.assert_allclose(found, one, rtol=4e-3)
    across = cf.imported.grid_mesh(
        "quad8", (2, 3), lambda u: np.stack([0.0 * u[:, 0] + 0.3, 0.4 * u[:, 1], 0.3 * u[:, 0]], 1), groups=ENDS
    )
    standing = cf.imported.tied(
        cf.imported.beside({"a": plate((2, 3), 0.0, 0.3), "b": across}),
        [cf.imported.Gluing(follower="b.low", master="a")],
    )
    with pytest.raises(
        cf.errors.ModelError, match=r"tie: node \d+: found walls that meet at an angle.*mesh-attachment"
    ):
        cf.MeshShell(mesh=standing, thickness=5e-3, material=STEEL, supports={"a.low": cf.Clamped()}).assembled()


def test_what_a_support_keeps_stays_fixed():
    """Clamped along a side that both blocks share, follower nodes included."""
    both = cf.imported.tied(pair("hexahedron20", (1, 1, 2), (1, 1, 3)), [GLUE])
    side = np.flatnonzero(both.points[:, 2] == 0.0)
    held = cf.imported.Group(nodes=side)
    mesh = cf.imported.MeshData(kind=both.kind, points=both.points, cells=both.cells, groups={"side": held},
                                attachments=both.attachments)  # fmt: skip
    shapes = cf.modes(supported(mesh, "side"), 3).fields
    assert not shapes[side].any()
    assert np.abs(shapes).max() > 0.0


SURFACES = """*SURFACE, NAME=Lower
{a}, S4
*SURFACE, NAME=Upper, TYPE=NODE
b.low
*TIE, NAME=T1, POSITION TOLERANCE={far}
{names}
"""


def file_of(tmp_path, names="upper, lower", far=0.01):
    write_inp(pair("hexahedron", (1, 1, 1), (1, 2, 2)), tmp_path / "a.inp")
    with (tmp_path / "a.inp").open("a") as file:
        file.write(SURFACES.format(a=1, names=names, far=far))
    return tmp_path / "a.inp"


def test_ties_of_input_files_are_read_by_surfaces(tmp_path):
    """TYPE=NODE follows; the same as from Python, numbers of the tolerance in the file's lengths."""
    found = cf.read_mesh(file_of(tmp_path), scale=1e-3)
    assert repr(found.attachments) == "1 tie"
    wanted = cf.imported.tied(pair("hexahedron", (1, 1, 1), (1, 2, 2)), [GLUE]).attachments.glued[0]
    np.testing.assert_array_equal(found.attachments.glued[0].nodes, wanted.nodes)
    np.testing.assert_allclose(found.attachments.glued[0].weights @ np.ones(4), np.ones(len(wanted.nodes)), rtol=1e-12)
    assert {"Upper", "Lower"} <= set(found.groups)


@pytest.mark.parametrize(
    ("names", "told"),
    [
        ("lower, upper", r"line \d+: \*TIE: found the surface 'upper' of nodes, expected one of element faces"),
        ("upper, middle", r"line \d+: \*TIE: found no surface 'middle'"),
        ("upper", r"line \d+: \*TIE: found 'upper', expected two surfaces"),
    ],
)
def test_ties_that_name_no_faces_are_refused_by_line(names, told, tmp_path):
    with pytest.raises(cf.errors.ModelError, match=told):
        cf.read_mesh(file_of(tmp_path, names))


def test_faces_that_are_not_there_or_apart_are_named():
    both = pair("hexahedron", (1, 1, 1), (1, 2, 2))
    with pytest.raises(cf.errors.ModelError, match=r"tie: found no group 'b\.hih' \(did you mean b\.high.*mesh-tie"):
        cf.imported.tied(both, [cf.imported.Gluing(follower="b.hih", master="a.high")])
    corner = replace(both, groups={**both.groups, "pin": cf.imported.Group(nodes=both.groups["a.high"].nodes[:3])})
    with pytest.raises(cf.errors.ModelError, match=r"tie: found a group 'pin' without facets.*mesh-tie"):
        cf.imported.tied(corner, [cf.imported.Gluing(follower="b.low", master="pin")])
    with pytest.raises(cf.errors.ModelError, match=r"0.4 m or more between 'b.high' and 'a.high'.*mesh-tie"):
        cf.imported.tied(both, [cf.imported.Gluing(follower="b.high", master="a.high")])
    with pytest.warns(cf.errors.ModelWarning, match=r"9 nodes .* of 'b' beyond .* from 'a.high'.*mesh-tie-loose"):
        found = cf.imported.tied(both, [cf.imported.Gluing(follower="b", master="a.high", tolerance=0.01)])
    assert len(found.attachments.glued[0].nodes) == 9
    with pytest.raises(cf.errors.ModelError, match=r"(?s)3 parts .*tie their faces.*mesh-parts"):
        cf.Solid(mesh=cf.imported.beside({"a": block("hexahedron", (1, 1, 1), 0.0, 0.1), "b": both}), material=STEEL)
