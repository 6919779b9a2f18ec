"""Updates and correlations of imported parts: derivatives, twins found again, study files, nearest nodes, refusals."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.modes.mesh_files import write_inp

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
ALUMINIUM = cf.Material(E=70e9, nu=0.33, rho=2700.0)
ENDS = {"root": (0, 0.0), "tip": (0, 1.0)}


def grouped(mesh):
    """The mesh with its outer half as a group of cells."""
    far = np.flatnonzero(mesh.points[mesh.cells].mean(axis=1)[:, 0] > 0.1)
    group = cf.imported.Group(nodes=np.unique(mesh.cells[far]), cells=far)
    return replace(mesh, groups={**mesh.groups, "far": group})


def solid(**change):
    mesh = cf.imported.grid_mesh(
        "hexahedron20", (6, 2, 1), lambda u: (u - [0.0, 0.5, 0.5]) * [0.2, 0.05, 0.008], groups=ENDS
    )
    part = cf.Solid(
        mesh=grouped(mesh), material=STEEL, materials={"far": ALUMINIUM}, supports={"root": cf.ElasticEdge(k_face=1e13)}
    )
    return replace(part, **change)


def shell(**change):
    mesh = cf.imported.grid_mesh(
        "quad9", (6, 2), lambda u: np.insert((u - [0.0, 0.5]) * [0.2, 0.05], 2, 0.0, axis=1), groups=ENDS
    )
    part = cf.MeshShell(
        mesh=grouped(mesh), thickness=4e-3, material=STEEL, thicknesses={"far": 3e-3}, materials={"far": ALUMINIUM},
        supports={"root": cf.Clamped()},
    )  # fmt: skip
    return replace(part, **change)


def table_of(part, count=6, noise=0.0):
    freq = cf.modes(part, count).freq
    rng = np.random.default_rng(3)
    return cf.FrequencyTable.from_arrays(freq_hz=freq * (1 + noise * rng.standard_normal(count)), sigma_hz=1e-4 * freq)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "truth"),
    [
        (solid, {"material.E": 190e9, "support.root.k_face": 3e12, "solid.material.far.rho": 3000.0}),
        (shell, {"shell.thickness": 4.4e-3, "shell.thicknesses.far": 2.5e-3}),
    ],
)
def test_a_twin_is_found_again(make, truth):
    start, twin = make(), make()
    for name, value in truth.items():
        twin = cf.updating.with_value(twin, name, value)
    vary = [
        cf.Parameter(name=name, lower=0.1 * value, upper=10.0 * value, log=name.endswith("k_face"))
        for name, value in truth.items()
    ]
    fit = cf.update(start, table_of(twin, 8), vary)
    np.testing.assert_allclose(fit.value, list(truth.values()), rtol=1e-4)
    assert fit.stopped.startswith("converged")
    assert type(fit.structure) is type(start)
    assert "rms" in repr(fit).lower()


def test_groups_of_a_shell_have_their_own_wall():
    """A cantilever in two halves weighs what they weigh."""
    part = shell()
    system = replace(part, supports={}).assembled()
    total = np.zeros((len(part.mesh.points), 5, 1))
    total[:, 2] = 1.0
    x = system.restrict(total)
    expected = 0.05 * 0.1 * (7800 * 4e-3 + 2700 * 3e-3)
    assert float((x.T @ (system.M @ x)).item()) == pytest.approx(expected, rel=1e-12)
    with pytest.raises(cf.errors.ModelError, match=r"shell.thicknesses.far must be above 0"):
        shell(thicknesses={"far": 0.0})
    with pytest.raises(cf.errors.ModelError, match="no group 'fra'"):
        shell(thicknesses={"fra": 1e-3})


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("chart.radius", r"an imported part, expected one of material\.E"),
        ("support.root.k_r", "an imported part"),
        ("E", "such number"),
    ],
)
def test_numbers_that_are_not_there_are_listed(name, message):
    with pytest.raises(cf.errors.InputError, match=message):
        cf.update(solid(), table_of(solid()), [cf.Parameter(name=name, lower=1.0, upper=2.0)])


@pytest.mark.slow
def test_angles_are_left_out_with_a_warning_and_shapes_refused():
    table = table_of(solid())
    angled = replace(table, angle_deg=np.full(len(table), 10.0))
    vary = [cf.Parameter(name="material.E", lower=1e11, upper=3e11)]
    with pytest.warns(cf.errors.ModelWarning, match="update-angles"):
        cf.update(solid(), angled, vary)
    spun = solid(rotation=cf.Rotation(omega=10.0, centre=(-0.1, 0.0, 0.0)))
    with pytest.raises(cf.errors.ModelError, match="rotation-update"):
        cf.update(spun, table, vary)


@pytest.mark.parametrize("make", [solid, shell])
def test_shapes_are_not_fitted_on_an_imported_part(make):
    plate = cf.Shell(
        chart=cf.Cylinder(radius=0.3, height=0.2), thickness=3e-3, material=STEEL, supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=1, around=7),
    )  # fmt: skip
    shapes = cf.updating.SensorShapes.on_edge(plate, "top", np.zeros(1), np.ones((1, 1)), 0.1)
    table = cf.FrequencyTable.from_arrays(freq_hz=[100.0], sigma_hz=1.0)
    with pytest.raises(cf.errors.ModelError, match=r"update: found shapes to fit to an imported part.*structure-chart"):
        cf.update(make(), table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)], shapes=shapes)


STUDY = """[material]
E = 200e9
nu = 0.3
rho = 7800.0
[solid]
mesh = "part.inp"
[support.root]
kind = "clamped"
[update]
table = "test.csv"
[[update.parameter]]
name = "material.E"
lower = 150e9
upper = 250e9
"""


@pytest.mark.slow
def test_update_and_correlate_on_the_command_line(tmp_path):
    twin = solid(materials={}, supports={"root": cf.Clamped()})
    write_inp(twin.mesh, tmp_path / "part.inp")
    found = cf.modes(twin, 6)
    rows = "".join(f"{k},,{f},{1e-4 * f},,\n" for k, f in enumerate(found.freq, 1))
    (tmp_path / "test.csv").write_text("# SYNTHETIC\nmode,n,freq_hz,sigma_hz,angle_deg,zeta\n" + rows)
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    ran = CliRunner().invoke(main, ["update", str(path), "--json", "--out", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.stderr
    assert json.loads(ran.stdout)["parameters"][0]["value"] == pytest.approx(210e9, rel=1e-6)
    again = cf.load_study(tmp_path / "out" / "study_updated.toml").structure
    assert again.material.E == pytest.approx(210e9, rel=1e-6)
    assert len(again.mesh.points) == len(twin.mesh.points)
