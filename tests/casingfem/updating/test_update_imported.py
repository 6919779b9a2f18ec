"""Updates and correlations of imported parts: derivatives, twins found again, study files, nearest nodes, refusals."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.experiment.correlation.sensors import sensors_at_nodes
from casingfem.updating.numbers import mesh_numbers
from casingfem.updating.sensitivity import of_mesh
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


NUMBERS = [
    (solid, "material.E"), (solid, "material.rho"), (solid, "material.nu"), (solid, "solid.material.far.E"),
    (solid, "support.root.k_face"), (shell, "shell.thickness"), (shell, "shell.thicknesses.far"),
    (shell, "shell.material.far.rho"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("make", "name"), NUMBERS, ids=[name for _, name in NUMBERS])
def test_derivatives_are_those_of_the_frequencies(make, name):
    part = make()
    value = cf.updating.get_value(part, name)
    found, h = cf.modes(part, 4), 1e-3
    up, down = (cf.modes(cf.updating.with_value(part, name, value * (1.0 + s * h)), 4).omega ** 2 for s in (1, -1))
    for log, unit in ((False, value), (True, np.log10((1 + h) / (1 - h)) / (2 * h))):
        parameter = cf.Parameter(name=name, lower=0.5 * value, upper=2.0 * value, log=log)
        K, M = of_mesh(found, [parameter], found.fields)
        rate = np.diagonal(K[0] - found.omega**2 * M[0])
        np.testing.assert_allclose(rate, (up - down) / (2 * h * unit), rtol=1e-5, atol=1e-6 * np.abs(rate).max())
        assert cf.updating.eigen_derivatives(found, [parameter]).shape == (1, 4, 4)


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
    [("chart.radius", "an imported part has material.E"), ("support.root.k_r", "an imported part has"), ("E", "has")],
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
    with pytest.raises(cf.errors.ModelError, match=r"update: found shapes to fit on an imported part.*structure-chart"):
        cf.update(make(), table, [cf.Parameter(name="material.E", lower=1e11, upper=3e11)], shapes=shapes)


def test_only_solids_and_shells_have_numbers_to_vary():
    """A structure of one's own has modes, but says nothing of what it is made of."""
    assert "shell.thickness" in mesh_numbers(shell())
    assert "solid.material.far.E" in mesh_numbers(solid())
    with pytest.raises(
        cf.errors.ModelError, match=r"found SimpleNamespace, expected a Solid or MeshShell.*structure-chart"
    ):
        mesh_numbers(SimpleNamespace(mesh=solid().mesh))


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


def test_updated_studies_keep_groups(tmp_path):
    from casingfem.study import updated_toml

    mesh = grouped(solid().mesh)
    write_inp(mesh, tmp_path / "part.inp")
    cells = ",".join(str(k + 1) for k in mesh.groups["far"].cells)
    (tmp_path / "part.inp").write_text((tmp_path / "part.inp").read_text() + f"*ELSET, ELSET=outer\n{cells}\n")
    path = tmp_path / "study.toml"
    own = "[solid.material.outer]\nE = 70e9\nnu = 0.33\nrho = 2700.0\n"
    path.write_text(STUDY.partition("[update]")[0] + own)
    study = cf.load_study(path)
    path.write_text(updated_toml(study, {"solid.material.outer.E": 72e9}, tmp_path))
    assert cf.load_study(path).structure.materials["outer"].E == 72e9


def test_shapes_measured_beside_nodes_correlate_with_their_modes():
    part = solid()
    found = cf.modes(part, 6)
    rng = np.random.default_rng(8)
    nodes = rng.choice(part.mesh.used, 20, replace=False)
    points = part.mesh.points[nodes] + 1e-4
    directions = np.tile([0.0, 0.0, 1.0], (20, 1))
    values = found.fields[nodes, 2]
    test = cf.correlation.MeasuredShapes.from_arrays(
        freq_hz=1.01 * found.freq, values=values, points=points, directions=directions
    )
    result = cf.correlate(found, test, mass="Guyan", system=part.assembled())
    paired = {row: mode for match in result.pairing.matches for row, mode in zip(match.rows, match.modes, strict=True)}
    flapping = [
        mode for mode in range(6) if np.abs(values[:, mode]).max() > 0.1 * np.abs(found.fields[:, :3, mode]).max()
    ]
    assert len(flapping) >= 3
    assert all(paired.get(mode) == mode for mode in flapping)
    assert all(result.mac[mode, mode] > 0.999 for mode in flapping)
    assert result.sensors.distance.max() == pytest.approx(1e-4 * np.sqrt(3), rel=1e-6)
    with pytest.raises(cf.errors.ModelError, match=r"sensor 17 at .* m is .* m from a node"):
        sensors_at_nodes(part, points + 1.0, directions)
