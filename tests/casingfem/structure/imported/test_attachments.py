"""Point masses, springs and connections on imported parts: exact solutions, two formats of one model, refusals."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import casingfem as cf
from reports.verification.modes.mesh_files import write_bdf, write_inp

pytestmark = [pytest.mark.filterwarnings(f"ignore:.*{code}") for code in ("mesh-aspect", "mesh-orphan-nodes")]

STEEL = cf.Material(E=210e9, nu=0.0, rho=7800.0)  # nu = 0: beam theory without its anticlastic curvature
L, B = 1.0, 0.02
EI, RHO_A = 210e9 * B**4 / 12.0, 7800.0 * B**2


def skew(a):
    """The matrix of the cross product with a vector."""
    return np.cross(np.eye(3), np.asarray(a))


def beam(offset=0.0, kind="solid"):
    """A slender cantilever along x, and the index of a node of no cell at x = L + offset."""
    if kind == "shell":
        mesh = cf.imported.grid_mesh("quad8", (6, 1), lambda u: np.insert((u - [0.0, 0.5]) * [L, B], 2, 0.0, axis=1),
                         groups={"root": (0, 0.0), "tip": (0, 1.0)})  # fmt: skip
    else:
        mesh = cf.imported.grid_mesh("hexahedron20", (16, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [L, B, B],
                         groups={"root": (0, 0.0), "tip": (0, 1.0)})  # fmt: skip
    count = len(mesh.points)
    points = np.vstack([mesh.points, [[L + offset, 0.0, 0.0]]])
    return replace(mesh, points=points, node_numbers=np.arange(1, count + 2)), count


def hung(mesh, **items):
    return replace(mesh, attachments=cf.imported.Attachments(**items))


def structure(mesh, supports=("root",)):
    held = {name: cf.Clamped() for name in supports}
    if mesh.cell_kind.dim == 2:
        return cf.MeshShell(mesh=mesh, thickness=B, material=STEEL, supports=held)
    return cf.Solid(mesh=mesh, material=STEEL, supports=held)


def joined_to(mesh, node, how):
    tip = mesh.groups["tip"].nodes
    if how == "rigid":
        return {"rigids": (cf.imported.Rigid(reference=node, nodes=tip),)}
    return {"means": (cf.imported.Mean(reference=node, nodes=tip, weights=np.ones(len(tip))),)}


@pytest.mark.parametrize(("kind", "how"), [("solid", "rigid"), ("solid", "mean"), ("shell", "rigid")])
def test_a_cantilever_with_a_tip_mass_swings_as_its_equation_states(kind, how):
    """1 + cos b cosh b + mu b (cos b sinh b - sin b cosh b) = 0, omega = b^2 sqrt(EI/(rho A L^4)), mu = m/(rho A L)."""
    mesh, node = beam(kind=kind)
    mass = 2.0
    found = cf.modes(
        structure(hung(mesh, **joined_to(mesh, node, how), masses=(cf.imported.PointMass(node=node, mass=mass),))), 4
    )
    mu = mass / (RHO_A * L)
    b = brentq(lambda b: 1 / np.cosh(b) + np.cos(b) + mu * b * (np.cos(b) * np.tanh(b) - np.sin(b)), 0.5, 2.0)
    np.testing.assert_allclose(found.freq[0], b**2 * np.sqrt(EI / (RHO_A * L**4)) / (2 * np.pi), rtol=6e-4)
    assert found.sturm_count == len(found.freq)


@pytest.mark.parametrize(("kind", "how"), [("solid", "rigid"), ("solid", "mean"), ("shell", "rigid")])
def test_a_force_on_an_arm_beyond_the_tip_brings_its_moment(kind, how):
    """u = P (L^3/3 + L^2 e + L e^2)/EI where a rigid arm e carries the force."""
    e, P = 0.3, 10.0
    mesh, node = beam(e, kind)
    part = structure(hung(mesh, **joined_to(mesh, node, how)))
    found = cf.solve_static(part, [cf.imported.NodeLoad(node=node + 1, force=(0.0, 0.0, P))])
    np.testing.assert_allclose(found.at(node + 1)[2], P * (L**3 / 3 + L**2 * e + L * e**2) / EI, rtol=6e-4)


def test_an_arm_from_a_node_of_a_shell_brings_its_moment():
    """As above, but the reference is the middle node of the tip itself, whose director alone turns the arm."""
    e, P = 0.3, 10.0
    mesh, node = beam(e, "shell")
    _, middle, _ = mesh.groups["tip"].nodes.tolist()
    part = structure(hung(mesh, rigids=(cf.imported.Rigid(reference=middle, nodes=np.array([node])),)))
    found = cf.solve_static(part, [cf.imported.NodeLoad(node=node + 1, force=(0.0, 0.0, P))])
    np.testing.assert_allclose(found.at(node + 1)[2], P * (L**3 / 3 + L**2 * e + L * e**2) / EI, rtol=6e-4)


@pytest.mark.slow
def test_reduction_at_a_reference_node_keeps_its_static_compliance():
    mesh, node = beam(0.1)
    mass = cf.imported.PointMass(node=node, mass=1.0, inertia=np.diag([1e-3, 2e-3, 3e-3]), offset=(0.0, 0.0, 0.05))
    part = structure(hung(mesh, **joined_to(mesh, node, "rigid"), masses=(mass,)))
    basis = cf.reduce(part, interface=cf.modal.AtNodes((node + 1,)), modes=3)
    whole = basis.rows @ np.diag(basis.omega**-2) @ basis.rows.T + basis.S
    for k, force in enumerate(np.eye(3)):
        moved = cf.solve_static(part, [cf.imported.NodeLoad(node=node + 1, force=tuple(force))]).at(node + 1)
        np.testing.assert_allclose(whole[:, k], moved, atol=1e-9 * np.abs(whole).max())


def block(**items):
    """A free cube of one element, all nodes on a reference in its centre, and the reference's index."""
    cube = cf.imported.grid_mesh("hexahedron20", (1, 1, 1), lambda u: (u - 0.5) * [0.1, 0.2, 0.3])
    count = len(cube.points)
    mesh = replace(cube, points=np.vstack([cube.points, np.zeros((1, 3))]), node_numbers=np.arange(1, count + 2))
    return hung(mesh, rigids=(cf.imported.Rigid(reference=count, nodes=np.arange(count)),), **items), count


def test_a_rigid_block_with_an_eccentric_mass_on_springs_is_the_six_by_six_pencil():
    k = np.array([1e5, 2e5, 3e5, 4e3, 5e3, 6e3])
    off = np.array([0.3, -0.2, 0.1])
    J = np.array([[0.3, 0.02, 0.0], [0.02, 0.4, 0.05], [0.0, 0.05, 0.5]])
    node = 20
    springs = tuple(
        cf.imported.Spring(terms=(cf.imported.Term(node, c, 1.0),), stiffness=value) for c, value in enumerate(k)
    )
    mesh, _ = block(springs=springs, masses=(cf.imported.PointMass(node=node, mass=7.0, inertia=J, offset=tuple(off)),))
    system = structure(mesh, ()).assembled()
    own = 7800.0 * 0.1 * 0.2 * 0.3
    sides = np.array([0.1, 0.2, 0.3])
    M = np.diag([own] * 3 + [own * (sides @ sides - side**2) / 12.0 for side in sides])
    arm = skew(off)
    M += np.block([[7.0 * np.eye(3), -7.0 * arm], [7.0 * arm, J - 7.0 * arm @ arm]])
    assert system.size == 6
    assert system.rigid == 0
    found = eigh(system.K.toarray(), system.M.toarray(), eigvals_only=True)
    np.testing.assert_allclose(found, eigh(np.diag(k), M, eigvals_only=True), rtol=1e-8)


def test_a_mass_on_a_spring_apart_from_the_cells_has_its_own_frequency():
    mesh, node = beam(0.5)
    springs = (
        cf.imported.Spring(terms=(cf.imported.Term(node, 1, 1.0),), stiffness=50.0),
        cf.imported.Spring(terms=(cf.imported.Term(node, 2, 1.0),), stiffness=18.0),
    )
    ground = cf.imported.Spring(terms=(cf.imported.Term(node, 0, 1.0),), stiffness=1e12)
    found = cf.modes(
        structure(hung(mesh, masses=(cf.imported.PointMass(node=node, mass=2.0),), springs=(*springs, ground))), 2
    )
    np.testing.assert_allclose(2.0 * np.pi * found.freq, [3.0, 5.0], rtol=1e-8)


def test_weight_of_point_masses_bends_the_beam():
    mesh, _ = beam()
    tip = mesh.groups["tip"].nodes
    masses = tuple(cf.imported.PointMass(node=int(node), mass=2.0 / len(tip)) for node in tip)
    part = structure(hung(mesh, masses=masses))
    heavy, bare = (
        cf.solve_static(s, [cf.loads.Gravity(acceleration=(0.0, 0.0, -9.81))]) for s in (part, structure(mesh))
    )
    change = (heavy.fields - bare.fields)[tip, 2].mean()
    np.testing.assert_allclose(change, -2.0 * 9.81 * L**3 / (3.0 * EI), rtol=1e-3)


@pytest.mark.slow
def test_connections_and_springs_between_nodes_leave_six_rigid_motions_and_know_no_axes():
    """A free part, a mass on a mean of its end, a second mass on a slanted spring; then all of it turned."""
    mesh, node = beam(0.05)
    far = np.array([[L + 0.1, 0.04, 0.03]])
    mesh = replace(mesh, points=np.vstack([mesh.points, far]), node_numbers=np.arange(1, node + 3))

    def free(mesh):
        axis = mesh.points[node + 1] - mesh.points[node]
        axis /= np.linalg.norm(axis)
        terms = [
            cf.imported.Term(end, c, s * float(axis[c])) for end, s in ((node, 1.0), (node + 1, -1.0)) for c in range(3)
        ]
        items = joined_to(mesh, node, "mean") | {"masses": (cf.imported.PointMass(node=node + 1, mass=0.5),)}
        across = [
            cf.imported.Spring(
                terms=(cf.imported.Term(node, c, 1.0), cf.imported.Term(node + 1, c, -1.0)), stiffness=1e5
            )
            for c in range(3)
        ]
        return structure(
            hung(mesh, **items, springs=(cf.imported.Spring(terms=tuple(terms), stiffness=1e6), *across)), ()
        )

    turn = np.linalg.qr(np.arange(9.0).reshape(3, 3) ** 2 + np.eye(3))[0]
    turn *= np.sign(np.linalg.det(turn))
    one, other = free(mesh), free(replace(mesh, points=mesh.points @ turn.T))
    slanted = replace(one.mesh, attachments=replace(one.mesh.attachments, springs=one.mesh.attachments.springs[:1]))
    assert structure(slanted, ()).assembled().rigid == 6
    values = []
    for part in (one, other):
        system = part.assembled()
        values.append(eigh(system.K.toarray(), system.M.toarray(), eigvals_only=True, subset_by_index=[0, 14]))
    np.testing.assert_allclose(values[0][6:], values[1][6:], rtol=1e-6)


def test_equations_make_displacements_one():
    """Two beams of one mesh, tied tip to tip along z by an equation, share a force."""
    mesh, _ = beam()
    tip = mesh.groups["tip"].nodes
    first, *others = tip.tolist()
    equations = tuple(
        cf.imported.Equation(terms=(cf.imported.Term(node, 2, 1.0), cf.imported.Term(first, 2, -1.0)))
        for node in others
    )
    found = cf.solve_static(
        structure(hung(mesh, equations=equations)), [cf.imported.NodeLoad(node=first + 1, force=(0, 0, 1.0))]
    )
    np.testing.assert_allclose(found.fields[tip, 2], found.fields[first, 2], rtol=1e-12)
    np.testing.assert_allclose(found.fields[first, 2], L**3 / (3.0 * EI), rtol=2e-3)


def test_connections_hang_on_connections():
    """A rigid arm of two links is one of their length; links in a ring are refused."""
    mesh, node = beam(0.2)
    mesh = replace(mesh, points=np.vstack([mesh.points, [[L + 0.5, 0.1, 0.0]]]), node_numbers=np.arange(1, node + 3))
    tip = mesh.groups["tip"].nodes
    two = (cf.imported.Rigid(reference=node, nodes=tip), cf.imported.Rigid(reference=node + 1, nodes=np.array([node])))
    one = (cf.imported.Rigid(reference=node + 1, nodes=tip),)
    load = [cf.imported.NodeLoad(node=node + 2, force=(0.0, 1.0, 2.0))]
    found, exact = (cf.solve_static(structure(hung(mesh, rigids=r)), load).at(node + 2) for r in (two, one))
    np.testing.assert_allclose(found, exact, rtol=1e-9)
    ring = (*two, cf.imported.Rigid(reference=int(tip[0]), nodes=np.array([node + 1])))
    with pytest.raises(cf.errors.ModelError, match="in a circle"):
        structure(hung(mesh, rigids=ring)).assembled()


BDF_ITEMS = """GRID,{n},,1.1,0.01,0.
GRID,{m},,1.1,0.2,0.
RBE2,901,{n},123456,{tip}
CONM2,902,{n},,1.5,0.,0.,0.,,+
+,2.-3,,3.-3,,,4.-3
CELAS2,903,2.+5,{n},3
CELAS2,904,3.+4,{n},4
CONM2,905,{m},,0.25
CELAS1,906,77,{n},2,{m},2
PELAS,77,1.+6
CELAS2,907,1.+7,{m},1
CELAS2,908,1.+7,{m},3
MPC,5,{a},2,1.,{b},2,-2.,,+
+,,{c},3,.5
"""
INP_ITEMS = """*NODE
{n}, 1.1, 0.01, 0.
{m}, 1.1, 0.2, 0.
*KINEMATIC COUPLING, REF NODE={n}
tip
*ELEMENT, TYPE=MASS, ELSET=m1
902, {n}
*MASS, ELSET=m1
1.5
*ELEMENT, TYPE=ROTARYI, ELSET=r1
912, {n}
*ROTARY INERTIA, ELSET=r1
2e-3, 3e-3, 4e-3
*ELEMENT, TYPE=SPRING1, ELSET=s1
903, {n}
*SPRING, ELSET=s1
3
2e5
*ELEMENT, TYPE=SPRING1, ELSET=s2
904, {n}
*SPRING, ELSET=s2
4
3e4
*ELEMENT, TYPE=MASS, ELSET=m2
905, {m}
*MASS, ELSET=m2
0.25
*ELEMENT, TYPE=SPRINGA, ELSET=s3
906, {n}, {m}
*SPRING, ELSET=s3
1e6
*ELEMENT, TYPE=SPRING1, ELSET=s4
907, {m}
*SPRING, ELSET=s4
1
1e7
*ELEMENT, TYPE=SPRING1, ELSET=s5
908, {m}
*SPRING, ELSET=s5
3
1e7
*EQUATION
3
{a}, 2, 1., {b}, 2, -2., {c}, 3, 0.5
"""


def both_files(folder, factor=1.0):
    """One model with everything on it as a bulk data file and as an input file."""
    mesh = cf.imported.grid_mesh("hexahedron20", (4, 1, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [L, 0.1, 0.05] * factor,
                     groups={"root": (0, 0.0), "tip": (0, 1.0)})  # fmt: skip
    count = len(mesh.points)
    inner = np.setdiff1d(np.arange(count), np.concatenate([g.nodes for g in mesh.groups.values()]))[:3] + 1
    numbers = dict(zip("nmabc", [count + 1, count + 2, *inner.tolist()], strict=True))
    write_bdf(mesh, folder / "part.bdf")
    write_inp(mesh, folder / "part.inp")
    tip = (mesh.groups["tip"].nodes + 1).tolist()
    rows = ",".join(map(str, tip[:5])) + ",+\n+," + ",".join(map(str, tip[5:]))
    text = (folder / "part.bdf").read_text()
    (folder / "part.bdf").write_text(text.replace("ENDDATA", BDF_ITEMS.format(tip=rows, **numbers) + "ENDDATA"))
    with (folder / "part.inp").open("a") as file:
        file.write(INP_ITEMS.format(**numbers))
    return folder / "part.bdf", folder / "part.inp"


def test_one_model_in_two_formats_has_the_same_modes(tmp_path):
    bdf, inp = both_files(tmp_path)
    meshes = {"SPC 1": cf.read_mesh(bdf), "root": cf.read_mesh(inp)}
    assert repr(meshes["SPC 1"].attachments) == "2 point masses, 5 springs, 1 rigid connection, 1 equation"
    found = [cf.modes(structure(mesh, (name,)), 8).freq for name, mesh in meshes.items()]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)
    bare = cf.modes(structure(replace(meshes["root"], attachments=cf.imported.Attachments())), 8).freq
    assert np.abs(found[1] / bare - 1.0).min() > 1e-3


def test_couplings_to_surfaces_and_bodies_of_sets_are_rigid_connections(tmp_path):
    """*COUPLING takes all nodes of the faces, their middles included; *RIGID BODY those of the set."""
    _, inp = both_files(tmp_path)
    plain = inp.read_text()
    by_nodes = cf.read_mesh(inp).attachments.rigids[0]
    head = plain.index("*KINEMATIC COUPLING")
    tail = plain[plain.index("\n", plain.index("\n", head) + 1) + 1 :]
    reference = re.search(r"REF NODE=(\d+)", plain)[1]
    face = "*SURFACE, NAME=end\n4, S4\n*COUPLING, REF NODE={}, SURFACE=end, CONSTRAINT NAME=c\n*KINEMATIC\n"
    for text in (face, "*RIGID BODY, REF NODE={}, NSET=tip\n"):
        inp.write_text(plain[:head] + text.format(reference) + tail)
        found = cf.read_mesh(inp).attachments.rigids[0]
        np.testing.assert_array_equal(found.nodes, by_nodes.nodes)
        assert found.components == by_nodes.components


def test_a_mean_in_two_formats_and_three_ways_is_one(tmp_path):
    """RBE3 of equal weights, *DISTRIBUTING COUPLING with an element DCOUP3D, *DISTRIBUTING on a surface of nodes."""
    bdf, inp = both_files(tmp_path)
    plain, bulk = inp.read_text(), bdf.read_text()
    head, tail = plain.index("*KINEMATIC COUPLING"), plain.index("*ELEMENT, TYPE=MASS")
    reference = re.search(r"REF NODE=(\d+)", plain)[1]
    rigid = re.search(r"RBE2,901,(\d+),123456,(.*),\+\n\+,(.*)\n", bulk)
    mean = f"RBE3,901,,{rigid[1]},123456,1.,123,,,+\n+,{rigid[2]},,,,+\n+,{rigid[3]}\n"
    bdf.write_text(bulk.replace(rigid[0], mean))
    ways = (
        "*ELEMENT, TYPE=DCOUP3D, ELSET=d\n950, {}\n*DISTRIBUTING COUPLING, ELSET=d\ntip, 1.\n",
        "*SURFACE, NAME=end, TYPE=NODE\ntip\n*COUPLING, REF NODE={}, SURFACE=end\n*DISTRIBUTING\n",
    )
    found = [cf.read_mesh(bdf).attachments.means[0]]
    for text in ways:
        inp.write_text(plain[:head] + text.format(reference) + plain[tail:])
        found.append(cf.read_mesh(inp).attachments.means[0])
    for mean in found[1:]:
        assert (mean.reference, mean.components) == (found[0].reference, (0, 1, 2, 3, 4, 5))
        np.testing.assert_array_equal(mean.nodes, found[0].nodes)
        np.testing.assert_array_equal(mean.weights, found[0].weights)
    inp.write_text(
        plain[:head] + "*SURFACE, NAME=end\n4, S4\n*COUPLING, REF NODE=1, SURFACE=end\n*DISTRIBUTING\n" + plain[tail:]
    )
    with pytest.warns(
        cf.errors.ModelWarning, match=r"\*DISTRIBUTING on a surface of elements \(line \d+\).*mesh-left-out"
    ):
        cf.read_mesh(inp)


def test_masses_and_springs_need_the_units_of_the_file(tmp_path):
    """The same numbers in mm, t, s: a thousandth of the size, masses a thousand times larger, stiffness alike."""
    bdf, _ = both_files(tmp_path)
    si, mm = cf.read_mesh(bdf).attachments, cf.read_mesh(bdf, units="mm-t-s").attachments
    assert mm.masses[0].mass == pytest.approx(1e3 * si.masses[0].mass)
    np.testing.assert_allclose(mm.masses[0].inertia, 1e-3 * si.masses[0].inertia)
    assert [m.stiffness / s.stiffness for m, s in zip(mm.springs, si.springs, strict=True)] == pytest.approx(
        [1e3, 1e3, 1e-3, 1e3, 1e3]
    )
    with pytest.raises(
        cf.errors.ModelError,
        match=r"found 2 point masses, .*equation and scale = 0\.001, which does not scale masses.*mesh-scale",
    ):
        cf.read_mesh(bdf, scale=1e-3)
    with pytest.raises(cf.errors.ModelError, match="beside units"):
        cf.read_mesh(bdf, scale=1e-3, units="mm-t-s")
    with pytest.raises(cf.errors.ModelError, match="units: found 'mm'"):
        cf.read_mesh(bdf, units="mm")


TETRA = """BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,0.,1.,0.
GRID,4,,0.,0.,1.,{cd}
GRID,5,,0.,0.,2.
GRID,6,,0.,0.,3.
CTETRA,1,7,1,2,3,4
SPC1,3,123,1,3
{card}
ENDDATA
"""
INP = """*NODE
1,0.,0.,0.
2,1.,0.,0.
3,0.,1.,0.
4,0.,0.,1.
5,0.,0.,2.
*ELEMENT,TYPE=C3D4,ELSET=E
1,1,2,3,4
"""


SURFACE = "*SURFACE,NAME=S,TYPE=NODE\n1\n2\n*COUPLING,REF NODE=5,SURFACE=S\n"


def test_masses_of_bulk_data_have_the_signs_and_factors_of_the_manual(tmp_path):
    """Products of inertia are with a minus in the matrix; PARAM, WTMASS multiplies masses, not offsets."""
    path = tmp_path / "a.bdf"
    card = "CONM2,9,5,,4.,.1,.2,.3,,+\n+,1.,.5,2.,.25,.125,3.\nPARAM,WTMASS,.5"
    path.write_text(TETRA.format(cd="", card=card))
    (mass,) = cf.read_mesh(path).attachments.masses
    assert (mass.mass, mass.offset) == (2.0, (0.1, 0.2, 0.3))
    wanted = 0.5 * np.array([[1.0, -0.5, -0.25], [-0.5, 2.0, -0.125], [-0.25, -0.125, 3.0]])
    np.testing.assert_array_equal(mass.inertia, wanted)


def test_bushes_of_coincident_grids_are_springs_along_the_basic_axes(tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card="GRID,7,,0.,0.,1.\nCBUSH,9,3,4,7,,,,0\nPBUSH,3,K,1.,,3.\n,,B,.1"))
    springs = cf.read_mesh(path).attachments.springs
    assert [(s.stiffness, s.terms) for s in springs] == [
        (1.0, (cf.imported.Term(3, 0, 1.0), cf.imported.Term(6, 0, -1.0))),
        (3.0, (cf.imported.Term(3, 2, 1.0), cf.imported.Term(6, 2, -1.0))),
    ]


@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("CELAS1,9,3,4,1", "line 10: CELAS1: found the property 3 without a PELAS"),
        ("CELAS2,9,-1.,4,1", "CELAS2: found the stiffness -1"),
        ("CELAS2,9,0.,4,1", "CELAS2: found the stiffness 0, expected one above 0"),
        ("CELAS2,9,1.", "CELAS2: found no grid"),
        ("CELAS2,9,1.,4,12", "components 12, expected one"),
        ("CELAS2,9,1.,4,8", "components '8'"),
        ("CELAS2,9,1.,4,1,5,4", "displacement and"),
        ("CONM2,9,5,3,1.,.1", "CONM2: coordinate system 3: found no system 3"),
        ("CONM2,9,5,,-1.", "CONM2: found the mass -1"),
        ("CONM2,9,8,,1.", "grid 8, although it is used"),
        ("RBE2,9,5,1237,4", "components '1237'"),
        ("RBE2,9,5,123", "dependent grid"),
        ("RBE2,9,5,123,2,THRU,4", "found THRU, expected the numbers of all grids"),
        ("RBE3,9,,5,123,1.,123456,1,2", "expected 123"),
        ("RBE3,9,,5,123,1.,123,1,2,3\n,UM,1,123", "found UM"),
        ("RBE3,9,,5,123,1.,123", "RBE3: found no grid with"),
        ("RBE3,9,,5,123,1,123,1", "RBE3: found 1, expected a weight such as 1.0"),
        ("RBE3,9,,5,123,0.,123,1", "RBE3: found the stiffness 0"),
        ("RBAR,9,4,5,123456,1", "expected 123456 at one"),
        ("RBAR,9,4,5,123,456", "expected 123456 at one"),
        ("MPC,1,4,1,1.,3,1,-1.\nMPC,2,4,2,1.,3,2,-1.", "found MPC cards of a second set"),
        ("MPC,1,4,1,1.", "1 terms"),
    ],
)
def test_cards_that_are_not_understood_are_refused_by_line(card, told, tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card=card))
    with pytest.raises(cf.errors.ModelError, match=told):
        cf.read_mesh(path)


@pytest.mark.parametrize(
    ("card", "kind", "wanted"),
    [
        ("CELAS2,9,1e-9,4,1", "springs", {"stiffness": 1e-9, "terms": (cf.imported.Term(3, 0, 1.0),)}),
        (
            "CELAS2,9,2.,4,5,5,6",
            "springs",
            {"stiffness": 2.0, "terms": (cf.imported.Term(3, 4, 1.0), cf.imported.Term(4, 5, -1.0))},
        ),
        ("CELAS2,9,2.,,,4,3", "springs", {"stiffness": 2.0, "terms": (cf.imported.Term(3, 2, 1.0),)}),
        ("CELAS1,9,3,4,1\nPELAS,3,7.,,,4,8.", "springs", {"stiffness": 7.0}),
        ("CELAS1,9,4,4,1\nPELAS,3,7.,,,4,8.", "springs", {"stiffness": 8.0}),
        ("CELAS1,3,,4,1\nPELAS,3,7.", "springs", {"stiffness": 7.0}),
        ("CONM2,9,5,,0.,,,,,+\n+,1.,,1.,,,1.", "masses", {"mass": 0.0, "node": 4}),
        ("RBE2,9,5,123456,4,6", "rigids", {"reference": 4, "nodes": [3, 5], "components": (0, 1, 2, 3, 4, 5)}),
        ("RBE2,9,5,36,4,1.2-5", "rigids", {"reference": 4, "nodes": [3], "components": (2, 5)}),
        ("RBE3,9,,5,123,1e-9,123,1,2\n+,3,ALPHA,6.5-6", "means", {"weights": [1e-9] * 3, "nodes": [0, 1, 2]}),
        ("RBE3,9,,5,123,1.,123,1,2\n+,4.,123,3", "means", {"weights": [1.0, 1.0, 4.0], "reference": 4}),
        ("RBAR,9,4,5,123456,,,123", "rigids", {"reference": 3, "nodes": [4], "components": (0, 1, 2)}),
        ("RBAR,9,4,5,,123456,12", "rigids", {"reference": 4, "nodes": [3], "components": (0, 1)}),
    ],
)
def test_cards_are_what_the_manual_states(card, kind, wanted, tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card=card))
    (found,) = getattr(cf.read_mesh(path).attachments, kind)
    for name, value in wanted.items():
        of_it = getattr(found, name)
        assert (np.asarray(of_it).tolist() if isinstance(value, list) else of_it) == value


@pytest.mark.parametrize(
    ("text", "kind", "wanted"),
    [
        (
            "*ELEMENT,TYPE=SPRING1,ELSET=S\n9,4\n*SPRING,ELSET=S\n3\n1e-9\n",
            "springs",
            {"terms": (cf.imported.Term(3, 2, 1.0),)},
        ),
        (
            "*ELEMENT,TYPE=SPRING2,ELSET=S\n9,4,5\n*SPRING,ELSET=S\n1,2\n5.\n",
            "springs",
            {"terms": (cf.imported.Term(3, 0, 1.0), cf.imported.Term(4, 1, -1.0)), "stiffness": 5.0},
        ),
        (
            "*ELEMENT,TYPE=SPRINGA,ELSET=S\n9,4,6\n*SPRING,ELSET=S\n5.\n*NODE\n6,3.,0.,5.\n",
            "springs",
            {
                "terms": (
                    cf.imported.Term(3, 0, 0.6),
                    cf.imported.Term(3, 2, 0.8),
                    cf.imported.Term(5, 0, -0.6),
                    cf.imported.Term(5, 2, -0.8),
                )
            },
        ),
        (
            "*EQUATION\n3\n4,1,1.,3,1,-1.,\n1,2,.5\n",
            "equations",
            {"terms": (cf.imported.Term(3, 0, 1.0), cf.imported.Term(2, 0, -1.0), cf.imported.Term(0, 1, 0.5))},
        ),
        ("*ELEMENT,TYPE=MASS,ELSET=M\n9,4\n*MASS,ELSET=M\n0.\n", "masses", {"mass": 0.0, "node": 3}),
        (
            "*ELEMENT,TYPE=ROTARYI,ELSET=M\n9,4\n*ROTARY INERTIA,ELSET=M\n1.,2.,3.,0.\n",
            "masses",
            {"inertia": [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]},
        ),
        (
            "*ELEMENT,TYPE=DCOUP3D,ELSET=S\n9,5\n*DISTRIBUTING COUPLING,ELSET=S\n4,1e-9\n3\n",
            "means",
            {"nodes": [2, 3], "weights": [1.0, 1e-9], "reference": 4},
        ),
        (f"{SURFACE}*DISTRIBUTING\n", "means", {"nodes": [0, 1], "weights": [1.0, 1.0], "reference": 4}),
        (f"{SURFACE}*KINEMATIC\n2,3\n6\n", "rigids", {"nodes": [0, 1], "components": (1, 2, 5)}),
        (f"{SURFACE}*KINEMATIC\n", "rigids", {"components": (0, 1, 2, 3, 4, 5), "reference": 4}),
        ("*MPC\nBEAM,4,5\n", "rigids", {"nodes": [3], "reference": 4}),
    ],
)
def test_keywords_are_what_the_manual_states(text, kind, wanted, tmp_path):
    path = tmp_path / "a.inp"
    path.write_text(INP + text)
    (found,) = getattr(cf.read_mesh(path).attachments, kind)
    for name, value in wanted.items():
        of_it = getattr(found, name)
        assert (np.asarray(of_it).tolist() if isinstance(value, list) else of_it) == value


def test_single_directions_of_turned_grids_are_refused_and_all_three_are_not(tmp_path):
    path = tmp_path / "a.bdf"
    for single in ("12", "12346", "12356"):
        path.write_text(TETRA.format(cd="2", card=f"RBE2,9,5,{single},4"))
        with pytest.raises(cf.errors.ModelError, match=r"single components of grid 4, .*\(CD\)"):
            cf.read_mesh(path)
    for whole, components in (("123", (0, 1, 2)), ("456", (3, 4, 5)), ("123456", (0, 1, 2, 3, 4, 5))):
        path.write_text(TETRA.format(cd="2", card=f"RBE2,9,5,{whole},4"))
        assert cf.read_mesh(path).attachments.rigids[0].components == components


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "*ELEMENT,TYPE=MASS,ELSET=M\n9,4\n",
            r"line 9: found element 9 of type MASS without a property, expected \*MASS",
        ),
        ("*MASS,ELSET=E\n2.5\n", r"line 9: \*MASS: found element 1 of another type, expected MASS"),
        ("*ELEMENT,TYPE=SPRING1,ELSET=S\n9,4\n*SPRING,ELSET=S\n1e6\n", "1 data lines"),
        ("*ELEMENT,TYPE=SPRING2,ELSET=S\n9,4,5\n*SPRING,ELSET=S\n1,4\n1e6\n", "expected 2"),
        ("*ELEMENT,TYPE=SPRING1,ELSET=S\n9,4\n*SPRING,ELSET=S,NONLINEAR\n1\n1.\n", "found NONLINEAR"),
        ("*EQUATION\n2\n4,1,1.\n", "found 3 cells"),
        ("*EQUATION\n1\n4,1,1.\n", "found 3 cells, expected 3 for each of 1 terms"),
        ("*NSET,NSET=N\n1,2\n*EQUATION\n2\n4,1,1.,N,1,-1.\n", "found 2 nodes in 'N', expected one"),
        ("*NSET,NSET=N\n1,2\n*KINEMATIC COUPLING,REF NODE=N\n3\n", "found 2 nodes as REF NODE, expected one"),
        ("*MPC\nBEAM,4\n", r"\*MPC: found BEAM, 4, expected a kind"),
        ("*ELEMENT,TYPE=SPRING1,ELSET=S\n9,4\n*SPRING,ELSET=S\n1\n0.\n", "found the stiffness 0, expected one above"),
        (
            "*ELEMENT,TYPE=SPRINGA,ELSET=S\n9,4,5\n*SPRING,ELSET=S\n1\n1e6\n",
            r"found 2 data lines, expected 1 \(the stiffness\)",
        ),
        ("*ELEMENT,TYPE=MASS,ELSET=M\n9,4\n*MASS,ELSET=M\n-1e-9\n", r"\*MASS: found -1e-9, expected numbers of 0"),
        ("*ELEMENT,TYPE=ROTARYI,ELSET=M\n9,4\n*ROTARY INERTIA,ELSET=M\n1.,1.\n", "expected I11, I22, I33 alone"),
        ("*ELEMENT,TYPE=ROTARYI,ELSET=M\n9,4\n*ROTARY INERTIA,ELSET=M\n1.,1.,1.,.1\n", "I33 alone"),
        ("*SURFACE,NAME=S\nE\n", "found 'E', expected an element or set and a face such as S1"),
        (f"{SURFACE}*DISTRIBUTING,WEIGHTING METHOD=LINEAR\n", "found a weighting method or degrees of freedom"),
        (f"{SURFACE}*DISTRIBUTING\n1,3\n", "found a weighting method or degrees of freedom, expected neither"),
        ("*MPC\nSLIDER,4,5,1\n", r"\*MPC: found SLIDER"),
        ("*KINEMATIC\n1,3\n", r"without \*COUPLING"),
        ("*COUPLING,REF NODE=5,SURFACE=S\n*KINEMATIC\n1,3\n", "no surface 'S'"),
        ("*DISTRIBUTING\n", r"without \*COUPLING"),
        ("*ELEMENT,TYPE=DCOUP3D,ELSET=S\n9,5\n*DISTRIBUTING COUPLING,ELSET=S\n4,-1.\n", "weight -1"),
        (
            "*ELEMENT,TYPE=DCOUP3D,ELSET=S\n9,5\n*DISTRIBUTING COUPLING,ELSET=S\n4,0.\n",
            "the weight 0, expected one ab",
        ),
        ("*ELEMENT,TYPE=DCOUP3D,ELSET=S\n9,5\n*DISTRIBUTING COUPLING,ELSET=S\n", "COUPLING: found no nodes"),
        ("*NGEN\n1,4\n", "elements written out"),
        ("*ELEMENT,TYPE=SPRING2,ELSET=S\n9,4\n", "line 10: found '9,4', expected an element number and 2 nodes"),
        ("*ELEMENT,TYPE=SPRING1,ELSET=S\n9,4,5\n", "line 10: found '9,4,5', expected an element number and 1 nodes"),
        *(
            (f"*ELEMENT,TYPE=MASS,ELSET=M\n9,4\n*MASS,ELSET=M\n{cell}\n", f"line 12: found '{cell}', expected a number")
            for cell in ("2.x", "nan", "inf", "1e999")
        ),
        *(
            (f"*EQUATION\n2\n4,{cell},1.,3,1,-1.\n", f"line 10: found '{cell}', expected a degree of freedom 1 to 6")
            for cell in ("0", "7", "-1", "1.")
        ),
        ("*NSET\n1\n", r"line 9: found \*NSET without a name"),
        ("*ELSET,GENERATE\n1,2\n", r"line 9: found \*ELSET without a name"),
        (
            "*NODE\n7,0.,0.,1.\n*ELEMENT,TYPE=SPRINGA,ELSET=S\n9,4,7\n*SPRING,ELSET=S\n\n1e6\n",
            r"line 13: SPRINGA 9: found two nodes at one place, expected a distance between them",
        ),
        ("*TRANSFORM,NSET=N\n1.,0.,0.,0.,1.,0.\n*EQUATION\n2\n4,1,1.,3,1,-1.\n", "along the global axes"),
    ],
)
def test_keywords_that_are_not_understood_are_refused_by_line(text, told, tmp_path):
    path = tmp_path / "a.inp"
    path.write_text(INP + text)
    with pytest.raises(cf.errors.ModelError, match=told):
        cf.read_mesh(path)


@pytest.mark.parametrize("name", ["CONM1,9,4", "CMASS2,9,3.,4,1", "CGAP,9,3,4,5", "CSHEAR,9,3,1,2,3,4", "RROD,9,4,5",
                                  "RSPLINE,9", "NSM,1", "DMIG,K2GG,0", "SPOINT,9",
                                  "CELAS2,9,1.,4,1,7,0"])  # fmt: skip
def test_other_cards_with_stiffness_or_mass_are_not_passed_over_in_silence(name, tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card=name + "\nMAT1,1,2.+11\nPARAM,POST,-1\nCORD2R,2,,0.,0.,0.,0.,0.,1.\n,1."))
    with pytest.warns(cf.errors.ModelWarning, match=f"1 {name.partition(',')[0]} .*mesh-left-out"):
        cf.read_mesh(path)


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
@pytest.mark.parametrize(
    ("card", "told"),
    [
        ("CELAS2,9,1.,4,5", "node 4: found the rotation about y, expected x, y or z: nodes of solids have"),
        (
            "RBE2,9,5,123,4\nRBE2,10,6,123,4",
            r"RBE2 10 \(line 11\): node 4: found a motion that RBE2 9 \(line 10\) already prescribes",
        ),
        ("RBE2,9,5,123,1", "node 1: found a support on a"),
        ("RBE3,9,,5,123,1.,123,1,2", "2 nodes in a line"),
        ("CONM2,9,4,,1.,.1", "node 4: found the rotation"),
        ("RBE2,9,5,123,4,2", "node 5: found a rotation with neither stiffness nor mass"),
    ],
)
def test_what_cannot_be_attached_is_refused_by_card_and_node(card, told, tmp_path):
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card=card))
    part = cf.Solid(mesh=cf.read_mesh(path), material=STEEL, supports={"SPC 3": cf.Clamped()})
    with pytest.raises(cf.errors.ModelError, match=told + ".*mesh-attachment"):
        part.assembled()


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
def test_a_mean_of_nodes_in_one_place_or_in_a_line_is_refused_wherever_they_are(tmp_path):
    """Round-off leaves the fit of their rotation some stiffness."""
    path, rng = tmp_path / "a.bdf", np.random.default_rng(5)
    for spread, count in ((0.0, 20), (1.0, 3)):
        for x, along in rng.normal(size=(count, 2, 3)):
            grids = [f"GRID,{7 + k},,{','.join(f'{c:.6f}' for c in x + spread * k * along)}" for k in range(3)]
            path.write_text(TETRA.format(cd="", card="\n".join([*grids, "RBE3,9,,5,123,1.,123,7,8\n,9"])))
            part = cf.Solid(mesh=cf.read_mesh(path), material=STEEL, supports={"SPC 3": cf.Clamped()})
            with pytest.raises(cf.errors.ModelError, match="3 nodes in a line, expected three that span a triangle"):
                part.assembled()


MIDDLE, LAST = 4, 6  # two nodes of the beam of shells, numbered 5 and 7 from 1


def sums(coefficient, component):
    return {
        "equations": (
            cf.imported.Equation(
                terms=(cf.imported.Term(MIDDLE, component, coefficient), cf.imported.Term(LAST, 0, 1.0))
            ),
        )
    }


@pytest.mark.parametrize(
    ("taken", "refused", "told"),
    [
        (
            sums(1e-9, 0),
            sums(0.0, 0),
            "equation: node 5: found a coefficient of 0 in the first term, expected a term that the equation",
        ),
        (sums(1.0, 2), sums(1.0, 3), "equation: node 5: found a rotation of a shell's node in the first term"),
        (sums(1.0, 2), sums(1.0, 4), "equation: node 5: found a rotation of a shell's node in the first term"),
        (
            {"rigids": (cf.imported.Rigid(reference=MIDDLE, nodes=np.array([LAST]), where="RBE2 8"),)},
            {"rigids": (cf.imported.Rigid(reference=MIDDLE, nodes=np.array([LAST, MIDDLE]), where="RBE2 8"),)},
            "RBE2 8: node 5: found the reference node among the nodes that follow it",
        ),
        *(
            (
                {"rigids": (cf.imported.Rigid(reference=MIDDLE, nodes=np.array([LAST]), components=whole),)},
                {"rigids": (cf.imported.Rigid(reference=MIDDLE, nodes=np.array([LAST]), components=part),)},
                "rigid connection: node 7: found one or two rotations of a shell's node, expected all three or none",
            )
            for whole, part in (((0, 1, 2), (0, 1, 2, 4)), ((0, 3, 4, 5), (0, 3, 5)))
        ),
        (
            {
                "means": (
                    cf.imported.Mean(
                        reference=MIDDLE, nodes=np.arange(6, 12), weights=np.ones(6), components=(0, 1, 2)
                    ),
                )
            },
            {
                "means": (
                    cf.imported.Mean(reference=MIDDLE, nodes=np.arange(6, 12), weights=np.ones(6), components=(0, 3)),
                )
            },
            "mean connection: node 5: found rotations of a node that belongs to cells, expected x, y, z alone",
        ),
    ],
)
def test_what_nodes_of_shells_cannot_follow_is_refused(taken, refused, told):
    mesh, _ = beam(kind="shell")
    structure(hung(mesh, **taken)).assembled()
    with pytest.raises(cf.errors.ModelError, match=told + ".*mesh-attachment"):
        structure(hung(mesh, **refused)).assembled()


@pytest.mark.filterwarnings("ignore:.*mesh-linear-cells")
def test_a_motion_that_only_a_small_inertia_feels_is_not_loose(tmp_path):
    """A turn about the line of two nodes, which has no stiffness: mass is not measured by the scale of stiffness."""
    path = tmp_path / "a.bdf"
    path.write_text(TETRA.format(cd="", card="RBE2,9,5,123,4,2\nCONM2,10,5,,1.-6,,,,,+\n+,1.-9,,1.-9,,,1.-9"))
    part = cf.Solid(mesh=cf.read_mesh(path), material=STEEL, supports={"SPC 3": cf.Clamped()})
    assert part.assembled().K.shape == (6, 6)


@pytest.mark.filterwarnings("ignore:.*material-units")
@pytest.mark.parametrize("kind", ["solid", "shell"])
@pytest.mark.slow
def test_a_light_beam_with_a_tip_mass_stiffens_as_it_turns(kind):
    """Under the force m Omega^2 L its cubic shape gains 6/5 Omega^2 square to the plane of rotation, 1 less in it."""
    mesh, _ = beam(kind=kind)
    tip = mesh.groups["tip"].nodes
    light = cf.Material(E=210e9, nu=0.0, rho=1e-3)
    masses = tuple(cf.imported.PointMass(node=int(node), mass=2.0 / len(tip)) for node in tip)
    for axis in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        part = replace(structure(hung(mesh, masses=masses)), material=light,
                       rotation=cf.Rotation(omega=0.0, axis=axis))  # fmt: skip
        found = cf.campbell(part, [0.0, 5.0], count=2)
        np.testing.assert_allclose(sorted(found.southwell), [0.2, 1.2], atol=5e-3)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*material-units")
def test_a_tip_mass_at_speed_swings_on_a_tensioned_beam():
    """Without mass of its own it is a spring T/(L - tanh(a L)/a), a = sqrt(T/EI), T = m Omega^2 L; less m Omega^2."""
    mesh, _ = beam()
    tip, omega = mesh.groups["tip"].nodes, 75.0
    masses = tuple(cf.imported.PointMass(node=int(node), mass=2.0 / len(tip)) for node in tip)
    part = structure(hung(mesh, masses=masses))
    part = replace(part, material=cf.Material(E=210e9, nu=0.0, rho=1.0))
    system = part.assembled()
    added = part.spin(system, cf.Rotation(omega=omega, axis=(0.0, 0.0, 1.0)))
    T = 2.0 * omega**2 * L
    a = np.sqrt(T / EI)
    k = T / (L - np.tanh(a * L) / a)
    exact = np.sqrt([k / 2.0 - omega**2, k / 2.0])
    for stiffness in (added.stiffness(omega), added.steady(omega)):
        K = (system.K + stiffness).toarray()
        # 1/omega^2 of M against K: the light mesh's own frequencies, 1e6 times higher, would drown omega^2 in round-off
        last = [len(K) - 2, len(K) - 1]
        found = 1.0 / eigh(system.M.toarray(), K, eigvals_only=True, subset_by_index=last)[::-1]
        np.testing.assert_allclose(np.sqrt(found), exact, rtol=5e-4)
