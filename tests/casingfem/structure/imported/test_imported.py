"""Studies of imported meshes: the command line on five formats, refusals with their key, warnings in words."""

import json

import meshio
import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.modes.mesh_files import WRITERS, group_name
from tests.probed import numbers_of_document

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-thin-curved")  # coarse rings, only compared with each other

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
MATERIAL = "[material]\nE = 210e9\nnu = 0.3\nrho = 7800.0\n"
ENDS = {"base": (2, 0.0), "top": (2, 1.0)}
WALL = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.03)
RING = cf.imported.grid_mesh("hexahedron20", (1, 12, 2), WALL, groups=ENDS, wrap=1)
SKIN = cf.imported.grid_mesh(
    "quad8", (12, 2), lambda u: WALL(np.insert(u, 0, 0.5, axis=1)), groups={"base": (1, 0.0), "top": (1, 1.0)}, wrap=0
)


TETRA = cf.imported.grid_mesh("tetra10", (1, 12, 2), WALL, groups=ENDS, wrap=1)


def study(folder, text, mesh=RING, name="Gmsh 2.2, text"):
    file, write = WRITERS[name]
    write(mesh, folder / file)
    path = folder / "study.toml"
    path.write_text(MATERIAL + text.replace("MESH", file))
    return path


SOLID = '[solid]\nmesh = "MESH"\n[support.base]\nkind = "clamped"\n[modes]\ncount = 6\n'


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.slow
def test_five_formats_on_the_command_line(name, tmp_path, held):
    text = SOLID.replace("support.base", f'support."{group_name(name, "base", ["base", "top"])}"')
    ran = CliRunner().invoke(main, ["modes", str(study(tmp_path, text, name=name)), "--json"])
    assert ran.exit_code == 0, ran.stderr
    found = json.loads(ran.stdout)
    exact = cf.modes(cf.Solid(mesh=RING, material=STEEL, supports={"base": cf.Clamped()}), 6)
    np.testing.assert_allclose([mode["freq_hz"] for mode in found["modes"]], exact.freq, rtol=1e-9)
    assert found["modes"][0]["n"] == exact.nodal_diameters[0]
    assert found["sturm_count"] == exact.sturm_count
    held(1e-4, found=numbers_of_document(found))


@pytest.mark.slow
def test_a_page_on_an_imported_part(tmp_path):
    path = study(tmp_path, SOLID + '[reduce]\ninterface = "top"\nn_max = 4\nmodes = 6\n')
    ran = CliRunner().invoke(main, ["report", str(path), "--out", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.stderr
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    for words in ("24 hexahedron20 cells", "E 210 GPa", "group base", "No mode is missing", "residual compliance"):
        assert words in page, words
    assert 'data-live="shapes"' in page
    assert "mode 1: " in page


def test_materials_by_group_and_foundations(tmp_path):
    text = (
        '[solid]\nmesh = "MESH"\n[solid.material.body]\nE = 70e9\nnu = 0.33\nrho = 2700.0\n'
        '[support.base]\nkind = "elastic"\nk_face = 1e12\n'
    )
    structure = cf.load_study(study(tmp_path, text)).structure
    assert structure.materials["body"].rho == 2700.0
    with pytest.raises(TypeError):
        structure.materials["body"] = None
    assert structure.supports["base"].k_face == 1e12


ROTATION = "[rotation]\nspeed_hz = 50.0\naxis = [0.0, 0.0, 1.0]\npoint = [-0.15, 0.0, 0.0]\n"


def test_rotation_of_an_imported_part(tmp_path):
    structure = cf.load_study(study(tmp_path, SOLID + ROTATION)).structure
    assert structure.rotation.omega == pytest.approx(100 * np.pi)
    assert structure.rotation.centre == (-0.15, 0.0, 0.0)
    named = ROTATION.replace("[0.0, 0.0, 1.0]", '"x"').replace("point", "centre")
    assert cf.load_study(study(tmp_path, SOLID + named)).structure.rotation.axis == (1.0, 0.0, 0.0)
    shell = SOLID.replace("[solid]", "[shell]\nthickness = 0.03")
    assert cf.load_study(study(tmp_path, shell + ROTATION, SKIN)).structure.rotation.omega > 0.0


def test_the_hash_covers_the_mesh(tmp_path):
    path = study(tmp_path, SOLID)
    before = cf.load_study(path).source["sha256"]
    mesh = tmp_path / "gmsh22.msh"
    mesh.write_text(mesh.read_text() + "\n")
    assert cf.load_study(path).source["sha256"] != before


BAD = {
    "no file": (SOLID.replace("MESH", "other.msh"), "solid.mesh: .*other.msh: found no such file, expected one"),
    "no group": (SOLID.replace("support.base", "support.bsae"), "no group 'bsae' .did you mean 'base'"),
    "chart beside": (SOLID + '[chart]\nkind = "cylinder"\nradius = 1.0\nheight = 1.0\n', r"no \[chart\] beside"),
    "rig beside": (SOLID + '[mesh]\norder = 3\n', r"no \[mesh\] beside an imported mesh"),
    "reduce group": (SOLID + '[reduce]\ninterface = "tpo"\n', "reduce.interface: .*no group 'tpo' .did you mean 'top'"),
    "reduce nothing": (SOLID + "[reduce]\nmodes = 3\n", "reduce: found none of interface, lines and at, expected one"),
    "reduce two": (SOLID + '[reduce]\ninterface = "top"\nat = [3]\n', "reduce: found interface and at, expected one"),
    "reduce at pieces": (SOLID + "[reduce]\nat = [3]\nnodes = 2\n", "reduce.nodes: found nodes and at"),
    "reduce lines": (SOLID + '[reduce]\ninterface = "top"\nlines = [0.1]\n', "reduce.lines: .*no such key here"),
    "rim in pieces": (SOLID + '[reduce]\ninterface = "top"\nnodes = 2\nn_max = 3\n', "reduce.n_max: found 3"),
    "shell beside": (SOLID + "[shell]\nthickness = 0.01\n", r"shell: found \[shell\] and \[solid\]"),
    "no axis": (SOLID + "[rotation]\nspeed_hz = 5.0\n", "rotation.axis: found nothing"),
    "hub": (SOLID + ROTATION + "hub_radius = 0.2\n", "rotation.hub_radius: found it on an imported mesh"),
    "two points": (SOLID + ROTATION + "centre = [0.0, 0.0, 0.0]\n", "found centre and point"),
    "springs": (SOLID.replace('"clamped"', '"elastic"\nk_r = 1e6'), "support.base: found k_r, expected k_face alone"),
    "diaphragm": (SOLID.replace("clamped", "shear-diaphragm"), "expected clamped, fixed or elastic"),
    "directions": (SOLID.replace('"clamped"', '"fixed"\ndirections = ["w"]'), "support.base.directions"),
    "twice": (SOLID.replace('"clamped"', '"fixed"\ndirections = ["x", "x"]'), "each once"),
    "scale": (SOLID.replace("MESH\"", "MESH\"\nscale = 0.0"), "solid.scale"),
    "key": (SOLID.replace("MESH\"", "MESH\"\nscael = 1.0"), "did you mean scale"),
    "scale without mesh": (SOLID.replace("solid", "shell").replace('mesh = "MESH"', "thickness = 1.0\nscale = 2.0"),
                           "chart: found nothing"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_studies_name_the_key(name, tmp_path):
    text, message = BAD[name]
    path = study(tmp_path, text)
    with pytest.raises(cf.errors.InputError, match=message):
        cf.load_study(path)
    ran = CliRunner().invoke(main, ["modes", str(path)])
    assert ran.exit_code == 2


def test_what_imported_meshes_cannot_is_refused_in_words(tmp_path):
    path = study(tmp_path, SOLID)
    ran = CliRunner().invoke(main, ["mistune", str(path), "--out", str(tmp_path)])
    assert ran.exit_code == 2
    assert "solid: found an imported mesh, expected a shell on a [chart]" in ran.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "mesh"),
    [(SOLID, RING), (SOLID, TETRA), (SOLID.replace("[solid]", "[shell]\nthickness = 0.03"), SKIN)],
    ids=["bricks", "tetrahedra", "shell"],
)
def test_shapes_of_imported_parts_for_paraview_and_test_software(text, mesh, tmp_path):
    """Volume cells with their displacements; nodes by the file's numbers, edges of the outside, one set 55 a mode."""
    path = study(tmp_path, text, mesh, name="Abaqus/CalculiX")
    ran = CliRunner().invoke(main, ["modes", str(path), "--vtu", "--uff", "--modes", "1,2", "--out", str(tmp_path)])
    assert ran.exit_code == 0, ran.stderr
    structure = cf.load_study(path).structure
    exact = cf.modes(structure, 6)
    read = meshio.read(tmp_path / "vtu" / "mode_002.vtu")
    np.testing.assert_allclose(read.points, structure.mesh.points, atol=1e-12)
    (cells,) = read.cells
    assert cells.type == structure.mesh.kind
    assert np.array_equal(cells.data, structure.mesh.cells)
    np.testing.assert_allclose(read.point_data["displacement"], exact.fields[:, :3, 1], rtol=1e-9, atol=1e-12)
    universal = cf.uff.read_uff(tmp_path / "modes.uff", strict=True)
    assert len(universal.shapes) == 2
    assert np.array_equal(universal.nodes.labels, structure.mesh.labels)
    np.testing.assert_allclose(universal.shapes[0].values, exact.fields[:, :3, 0], rtol=1e-5, atol=1e-6)
    (line,) = universal.lines
    sides = np.append(line.nodes, 0).reshape(-1, 3)
    assert set(sides[:, :2].ravel()) <= set(universal.nodes.labels)
    assert len(np.unique(np.sort(sides[:, :2], axis=1), axis=0)) == len(sides)


@pytest.mark.filterwarnings("default::casingfem.errors.ModelWarning")
def test_warnings_come_in_words_on_stderr(tmp_path):
    linear = cf.imported.grid_mesh("hexahedron", (1, 12, 2), WALL, groups=ENDS, wrap=1)
    ran = CliRunner().invoke(main, ["modes", str(study(tmp_path, SOLID, linear)), "--json"])
    assert ran.exit_code == 0
    assert "warning: gmsh22.msh: 24 linear cells (hexahedron)" in ran.stderr
    json.loads(ran.stdout)


def test_fixed_is_refused_on_a_chart(tmp_path):
    path = tmp_path / "study.toml"
    chart = '[chart]\nkind = "cylinder"\nradius = 0.5\nheight = 0.3\n[shell]\nthickness = 0.01\n'
    path.write_text(MATERIAL + chart + '[support.base]\nkind = "fixed"\ndirections = ["x"]\n')
    with pytest.raises(cf.errors.InputError, match=r"support.base: kind: found 'fixed', which is for imported meshes"):
        cf.load_study(path)


BLADE = cf.imported.grid_mesh(
    "hexahedron20", (4, 3, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [0.11, 0.04, 5.4e-3],
    groups={"base": (0, 0.0), "top": (0, 1.0)},
)  # fmt: skip


def test_reduce_at_nodes_writes_the_basis_with_its_channels(tmp_path):
    number = int(BLADE.node_numbers[BLADE.groups["top"].nodes[0]])
    reduce = f'[reduce]\nat = [{number}]\nmodes = 4\nzeta = 0.002\nout = "two.npz"\n'
    output = f'[[reduce.output]]\nname = "s"\nnode = {number}\nstress = "xx"\n'
    ran = CliRunner().invoke(main, ["reduce", str(study(tmp_path, SOLID + reduce + output, BLADE)), "--json"])
    assert ran.exit_code == 0, ran.stderr
    assert json.loads(ran.stdout)["channels"] == [f"{number}.{axis}" for axis in "xyz"]
    basis = cf.ModalBasis.load(tmp_path / "two.npz")
    assert basis.provenance["source"]["study"] == "study.toml"
    assert basis.outputs == ("s",)
    bent = cf.solve_static(
        cf.load_study(tmp_path / "study.toml").structure, [cf.imported.NodeLoad(node=number, force=(0.0, 0.0, 1.0))]
    )
    np.testing.assert_allclose(basis.compliance[:, 2], bent.at(number), rtol=1e-7, atol=1e-15)


RUB = """[scene]
kind = "rub"
t_end = 0.05
[casing]
basis = "casing.npz"
[[blade]]
basis = "blade.npz"
lean_deg = 10.0
[contact]
clearance = 1e-4
friction = 0.2
out_of_roundness = [{p = 2, cos = 2e-4}]
[speed]
turning = "blades"
hz = 5.0
[scheme]
kind = "exact-modal"
dt = 2e-5
"""


@pytest.mark.slow
def test_an_imported_blade_rubs_on_an_imported_casing_by_the_command_line(tmp_path):
    """Study files, bases and a rub; each part by its own mesh file."""
    casing = '[shell]\nmesh = "MESH"\nthickness = 0.03\n[support.base]\nkind = "clamped"\n'
    rim = '[reduce]\ninterface = "top"\nn_max = 4\nmodes = 12\nzeta = 0.002\nout = "casing.npz"\n'
    tip = '[reduce]\ninterface = "top"\nnodes = 2\nmodes = 4\nzeta = 0.002\nout = "blade.npz"\n'
    for text, mesh in ((casing + rim, SKIN), (SOLID + tip, BLADE)):
        ran = CliRunner().invoke(main, ["reduce", str(study(tmp_path, text, mesh)), "--out", str(tmp_path)])
        assert ran.exit_code == 0, ran.stderr
    (tmp_path / "scene.toml").write_text(RUB)
    ran = CliRunner().invoke(main, ["rub", str(tmp_path / "scene.toml"), "--json"])
    assert ran.exit_code == 0, ran.stderr
    contacts = json.loads(ran.stdout)["contacts"]
    assert len(contacts) == 2
    assert sum(contact["impulse"] for contact in contacts) > 0.0
