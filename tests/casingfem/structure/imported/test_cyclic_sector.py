"""Sectors of wheels: which nodes pair, what is refused; nodes on the axis."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
ENDS = {"low": (1, 0.0), "high": (1, 1.0), "base": (2, 0.0), "rim": (0, 1.0)}
WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
CASING = cf.Shell(chart=cf.Cylinder(radius=0.4, height=0.6), thickness=0.01, material=STEEL, supports={})


def wheel_structure(sector):
    """The whole wheel as one part."""
    return cf.modal.wheel_modes(cf.modal.cyclic_modes(sector, 1, diameters=[1])).structure


def part(place=lambda u: u, **given):
    """An eighth of a frustum's wall."""
    mesh = cf.imported.grid_mesh("hexahedron20", (1, 2, 2), lambda u: WALL(place(u * [1.0, 0.125, 1.0])), groups=ENDS)
    return cf.Solid(mesh=mesh, material=STEEL, **{"supports": {"base": cf.Clamped()}, **given})


def wedge(layers, sectors, prism=((0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5))):
    """A sector of a full shaft, of linear tetrahedra with nodes on the axis; `prism` cuts each layer."""
    angle = 2.0 * np.pi / sectors
    ring = np.array([[0.0, 0.0], [0.1, 0.0], [0.1 * np.cos(angle), 0.1 * np.sin(angle)]])
    points = np.array([[*xy, 0.05 * k] for k in range(layers + 1) for xy in ring])
    cells = np.concatenate([3 * k + np.array(prism) for k in range(layers)])
    edges = np.diff(points[cells], axis=1, prepend=points[cells][:, :1])[:, 1:]
    flipped = np.linalg.det(edges) < 0
    cells[flipped] = cells[flipped][:, [0, 2, 1, 3]]
    return cf.imported.MeshData(
        kind="tetra", points=points, cells=cells, groups={"foot": cf.imported.Group(nodes=np.arange(3))}
    )


def test_faces_are_found_named_or_swapped_alike():
    found = cf.imported.CyclicSector(structure=part(), sectors=8).pairs
    for names in (("low", "high"), ("high", "low")):
        pairs = cf.imported.CyclicSector(structure=part(), sectors=8, faces=names).pairs
        assert set(zip(*pairs, strict=True)) == set(zip(*found, strict=True))
    assert len(found.low) == 13


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
@pytest.mark.parametrize("sectors", [4, 5])
def test_nodes_on_the_axis_move_as_each_diameter_lets_them(sectors):
    solid = cf.Solid(mesh=wedge(4, sectors), material=STEEL, supports={"foot": cf.Clamped()})
    found = cf.modal.cyclic_modes(cf.imported.CyclicSector(structure=solid, sectors=sectors), 4)
    whole = cf.modes(wheel_structure(found.sector), 10)
    np.testing.assert_allclose(cf.modal.wheel_modes(found).freq[:10], whole.freq, rtol=1e-9)


def moved(mesh, node, shift):
    points = mesh.points.copy()
    points[node] += shift
    return replace(mesh, points=points)


def weighed(solid):
    masses = cf.imported.Attachments(masses=(cf.imported.PointMass(node=3, mass=1.0),))
    return replace(solid, mesh=replace(solid.mesh, attachments=masses))


def bent(radius):
    """A node of the high face moved along the axis."""
    solid = part()
    node = solid.mesh.groups["high"].nodes[-1]
    return replace(solid, mesh=moved(solid.mesh, node, [0.0, 0.0, radius]))


@pytest.mark.parametrize("faces", [None, ("low", "high")])
def test_a_node_that_misses_its_partner_is_named_with_the_distance(faces):
    solid = bent(1e-3)
    number = solid.mesh.labels[solid.mesh.groups["high"].nodes[-1]]
    with pytest.raises(cf.errors.ModelError, match=r"rotated by 45 degrees.*0\.001 m.*cyclic-faces") as caught:
        cf.imported.CyclicSector(structure=solid, sectors=8, faces=faces)
    assert str(number) in str(caught.value)
    cf.imported.CyclicSector(structure=solid, sectors=8, faces=faces, tolerance=2e-3)


@pytest.mark.parametrize(
    ("make", "given", "words"),
    [
        (part, {"sectors": 9, "faces": ("low", "high")}, "of 45 degrees between.*of 8 sectors.*cyclic-sectors"),
        (part, {"sectors": 9}, "rotated by 40 degrees.*cyclic-faces"),
        (part, {"sectors": 16}, "found several sectors.*cyclic-sectors"),
        (part, {"sectors": 1}, "found 1.*cyclic-sectors"),
        (lambda: CASING, {"sectors": 8}, "cyclic: found Shell, expected a Solid or MeshShell.*structure-unknown"),
        (lambda: weighed(part()), {"sectors": 8}, "a sector with 1 point mass.*mesh-attachment"),
        (part, {"sectors": 8, "faces": ("low", "rim")}, "nodes in 'low'.*cyclic-faces"),
        (part, {"sectors": 8, "faces": ("low", "hgh")}, "did you mean 'high'.*mesh-no-group"),
        (lambda: part(rotation=cf.Rotation(omega=9.0, axis=(1.0, 0.0, 0.0))), {"sectors": 8}, "cyclic-axis"),
        (lambda: part(rotation=cf.Rotation(omega=9.0, centre=(0.1, 0.0, 0.0))), {"sectors": 8}, "cyclic-axis"),
        (
            lambda: part(supports={"base": cf.imported.Fixed(directions=("x",))}),
            {"sectors": 8},
            "found fixed x.*cyclic-support",
        ),
    ],
)
def test_what_is_no_sector_is_refused(make, given, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        cf.imported.CyclicSector(structure=make(), **given)


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
def test_a_part_that_meets_itself_on_the_axis_alone_is_no_sector():
    quarter = cf.Solid(mesh=wedge(2, 4), material=STEEL)
    assert len(cf.imported.CyclicSector(structure=quarter, sectors=4).pairs.low) == 6
    found = r"rotated by 120 degrees about \(0.*only nodes on the axis.*cyclic-faces"
    with pytest.raises(cf.errors.ModelError, match=found):
        cf.imported.CyclicSector(structure=quarter, sectors=3)


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
def test_other_diagonals_on_the_faces_are_refused():
    other = wedge(2, 4, prism=[[0, 1, 2, 5], [0, 1, 5, 3], [1, 3, 5, 4]])
    with pytest.raises(cf.errors.ModelError, match=r"facet lies on nodes \[1.*4\], which form no facet.*cyclic-faces"):
        cf.imported.CyclicSector(structure=cf.Solid(mesh=other, material=STEEL), sectors=4)


def test_supports_must_keep_both_faces_alike():
    solid = part()
    groups = dict(solid.mesh.groups) | {"pin": cf.imported.Group(nodes=solid.mesh.groups["low"].nodes[:1])}
    pinned = cf.Solid(mesh=replace(solid.mesh, groups=groups), material=STEEL, supports={"pin": cf.Clamped()})
    with pytest.raises(cf.errors.ModelError, match=r"have different supports.*cyclic-support"):
        cf.modal.cyclic_modes(cf.imported.CyclicSector(structure=pinned, sectors=8), 1)


@pytest.mark.slow
@pytest.mark.parametrize("faces", [None, ("low", "high")])
def test_two_halves_make_a_whole(faces):
    """A half turn lays each face on the other: every pair of nodes is found twice, and used once."""
    mesh = cf.imported.grid_mesh("hexahedron20", (1, 12, 1), lambda u: WALL(u * [1.0, 0.5, 1.0]), groups=ENDS)
    half = cf.Solid(mesh=mesh, material=STEEL, supports={"base": cf.Clamped()})
    found = cf.modal.cyclic_modes(cf.imported.CyclicSector(structure=half, sectors=2, faces=faces), 5)
    assert len(found.sector.pairs.low) == 8
    assert len(np.intersect1d(found.sector.pairs.low, found.sector.pairs.high)) == 0
    whole = cf.modes(wheel_structure(found.sector), 6)
    np.testing.assert_allclose(cf.modal.wheel_modes(found).freq[:6], whole.freq, rtol=1e-8)
