"""Reduction: static pushes equal the full model, for every basis and any number of modes."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.linalg.factor import factorise
from casingfem.modal.interface.chart_rows import rim_rows, tip_directions, tip_rows
from casingfem.modal.interface.view import load_columns
from casingfem.modal.reduction import free_vectors

RIM = cf.Rim("top", n_max=8)


@pytest.fixture(scope="module")
def casing(frustum):
    """Imperfect, elastically embedded."""
    edge = cf.ElasticEdge(k_face=5e12, around=cf.FourierField.of({4: (0.3, 0.1)}))
    shell = frustum(
        radius_defect=cf.FourierField.of({2: 0.004, 8: 0.002}),
        supports={"base": edge},
        mesh=cf.ShellMesh(order=6, rows=1, around=9),
    )
    return cf.shell.assemble(shell)


@pytest.fixture(scope="module")
def blade(steel):
    shell = cf.Shell(
        chart=cf.Panel(radius=0.3, length=0.12, angle=0.25), thickness=2e-3, material=steel,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=6, rows=2, around=1),
    )  # fmt: skip
    return cf.shell.assemble(shell)


def bodies(request_name, casing, blade):
    return (casing, RIM, rim_rows) if request_name == "rim" else (blade, cf.Tip(), tip_rows)


def full_solution(system, rows):
    """Displacements (3 points, channels) under unit interface loads, and the interface's compliance."""
    P = load_columns(system, rows)
    u = factorise(system.K).solve(P)
    return system.expand(u)[:, :3].reshape(-1, P.shape[1]), P.T @ u


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rim", "tip"])
@pytest.mark.parametrize(
    ("method", "count"), [("free", 1), ("free", 7), ("free", 30), ("craig-bampton", 1), ("craig-bampton", 12)]
)
def test_static_push_equals_the_full_model(casing, blade, kind, method, count):
    system, interface, rows_of = bodies(kind, casing, blade)
    made = cf.reduce(system.shell, interface, modes=count, method=method, system=system)
    _, compliance = full_solution(system, rows_of(system, interface)[0])
    assert np.abs(made.compliance - compliance).max() < 1e-10 * np.abs(compliance).max()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["rim", "tip"])
@pytest.mark.parametrize("method", ["free", "craig-bampton"])
def test_recovery_gives_the_full_static_solution(casing, blade, kind, method):
    system, interface, rows_of = bodies(kind, casing, blade)
    made = cf.reduce(system.shell, interface, modes=9, method=method, recovery=True, system=system)
    exact, _ = full_solution(system, rows_of(system, interface)[0])
    static = made.recovery @ (made.rows.T / made.omega[:, None] ** 2) + made.recovery_S
    assert np.abs(static - exact).max() < 1e-9 * np.abs(exact).max()
    np.testing.assert_array_equal(made.recovery_points, system.points)


@pytest.mark.slow
def test_free_basis_is_the_shells_modes(casing):
    made = cf.reduce(casing.shell, RIM, modes=12, system=casing, zeta=0.002)
    found = cf.modes(casing.shell, 12, system=casing)
    np.testing.assert_allclose(made.omega, found.omega, rtol=1e-12)
    rows, _ = rim_rows(casing, RIM)
    np.testing.assert_allclose(made.rows, rows @ found.fields.reshape(-1, 12), atol=1e-9 * np.abs(made.rows).max())
    np.testing.assert_array_equal(made.zeta, np.full(12, 0.002))


@pytest.mark.slow
def test_craig_bampton_frequencies_lie_above_the_exact_ones_and_close(casing):
    made = cf.reduce(casing.shell, RIM, modes=60, method="craig-bampton", system=casing)
    exact = cf.modes(casing.shell, 10, system=casing).omega
    assert len(made) == 60 + 2 * 17
    error = made.omega[:10] / exact - 1
    assert error.min() > -1e-10
    assert error.max() < 3e-3
    assert np.all(made.S == 0.0)


@pytest.mark.slow
def test_craig_bampton_converges_with_its_fixed_modes(casing):
    exact = cf.modes(casing.shell, 8, system=casing).omega
    errors = [
        np.abs(cf.reduce(casing.shell, RIM, modes=count, method="craig-bampton", system=casing).omega[:8] / exact - 1)
        for count in (5, 40)
    ]
    assert errors[1].max() < 0.3 * errors[0].max()


@pytest.mark.slow
@pytest.mark.parametrize("method", ["free", "craig-bampton"])
def test_modes_are_orthonormal(casing, method):
    made = cf.reduce(casing.shell, RIM, modes=10, method=method, recovery=True, system=casing)
    if method == "free":
        found = cf.modes(casing.shell, 10, system=casing)
        phi = casing.collect(found.fields, found.own)
        np.testing.assert_allclose(phi.T @ (casing.mass[:, None] * phi), np.eye(10), atol=1e-9)
    # kinetic energy of the translations alone: less than one by the rotations' share
    mass = np.zeros(len(casing.frames) * 5)
    mass[casing.free] = casing.mass
    weights = mass.reshape(-1, 5)[:, :3].ravel()
    gram = made.recovery.T @ (weights[:, None] * made.recovery)
    np.testing.assert_allclose(gram, np.eye(len(made)), atol=5e-3)


@pytest.mark.slow
def test_residual_compliance_is_symmetric_positive_and_falls_with_modes(casing):
    traces = []
    for count in (1, 10, 40):
        S = cf.reduce(casing.shell, RIM, modes=count, system=casing).S
        assert np.array_equal(S, S.T)
        assert np.linalg.eigvalsh(S).min() > -1e-12 * np.trace(S)
        traces.append(np.trace(S))
    assert traces[0] > traces[1] > traces[2] > 0.0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::casingfem.errors.ModelWarning")  # springs that soft are a mistyped unit
def test_residual_compliance_does_not_depend_on_how_soft_the_support_is(steel):
    def residual(springs):
        casing = cf.Shell(
            chart=cf.Cylinder(radius=0.2, height=0.02),
            thickness=2e-3,
            material=steel,
            supports={"base": cf.ElasticEdge(k_r=springs, k_theta=springs, k_z=springs)},
            mesh=cf.ShellMesh(order=5, rows=1, around=8),
        )
        return cf.reduce(casing, cf.Rim("top", n_max=6), modes=20).S

    firm, soft = residual(1e3), residual(1.0)  # first frequencies of 9 Hz and 0.3 Hz
    assert np.abs(soft - firm).max() < 2e-3 * np.abs(firm).max()


def test_diaphragm_edges_are_reduced_in_their_own_frame(frustum):
    tube, held = cf.Cylinder(radius=0.5, height=0.3), {"base": cf.ShearDiaphragm(), "top": cf.ElasticEdge(k_z=1e9)}
    system = cf.shell.assemble(frustum(chart=tube, supports=held, mesh=cf.ShellMesh(order=6, rows=1, around=7)))
    with_frames = cf.reduce(system.shell, cf.Rim("top", n_max=3), modes=4, system=system, recovery=True)
    springs = {"base": cf.ElasticEdge(k_r=1e15, k_theta=1e15), "top": cf.ElasticEdge(k_z=1e9)}
    near = cf.modes(frustum(chart=tube, supports=springs, mesh=system.grid.mesh), 4, method="shell")
    np.testing.assert_allclose(with_frames.freq, near.freq, rtol=1e-3)


@pytest.mark.parametrize("support", [cf.Clamped(), cf.ShearDiaphragm()], ids=["clamped", "diaphragm"])
def test_a_held_rim_cannot_be_pushed(frustum, support):
    tube = frustum(chart=cf.Cylinder(radius=0.5, height=0.3), supports={"base": cf.Clamped(), "top": support})
    with pytest.raises(ValueError, match="'top' is held, nothing can be pushed there"):
        cf.reduce(replace(tube, mesh=cf.ShellMesh(order=4, rows=1, around=7)), cf.Rim("top", n_max=3), modes=4)


def test_round_trip_and_provenance(casing, tmp_path):
    made = cf.reduce(casing.shell, RIM, modes=6, system=casing, recovery=True)
    again = cf.ModalBasis.load(made.save(tmp_path / "casing.npz"))
    np.testing.assert_array_equal(again.compliance, made.compliance)
    assert again.provenance == made.provenance
    assert made.provenance["method"] == "free"
    assert made.provenance["dofs"] == casing.size
    assert len(str(made.provenance["matrices"])) == 64
    assert made.n_max == 8
    assert made.radius == pytest.approx(0.45, rel=1e-3)
    assert made.channels[:3] == ("radial.cos0", "radial.cos1", "radial.cos2")


@pytest.mark.slow
def test_provenance_tells_two_structures_apart(casing, frustum):
    other = cf.reduce(frustum(mesh=casing.grid.mesh), RIM, modes=2)
    assert other.provenance["matrices"] != cf.reduce(casing.shell, RIM, modes=2).provenance["matrices"]


@pytest.mark.slow
@pytest.mark.parametrize("method", ["free", "craig-bampton"])
def test_two_calls_agree_bit_by_bit(casing, method):
    a, b = (cf.reduce(casing.shell, RIM, modes=6, method=method, system=casing) for _ in range(2))
    assert a.rows.tobytes() == b.rows.tobytes()
    assert a.omega.tobytes() == b.omega.tobytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "rubin"}, "method must be one of free, craig-bampton, found 'rubin'"),
        ({"zeta": -0.1}, "zeta must lie in"),
        ({"zeta": 1.0}, "zeta must lie in"),
        ({"zeta": float("nan")}, "zeta must lie in"),
    ],
)
def test_refuses_options_that_are_none(casing, options, message):
    with pytest.raises(ValueError, match=message):
        cf.reduce(casing.shell, RIM, system=casing, **options)


def test_refuses_an_interface_the_shell_does_not_have(casing, blade):
    with pytest.raises(ValueError, match="open panel"):
        cf.reduce(casing.shell, cf.Tip(), system=casing)
    with pytest.raises(ValueError, match="closed casing"):
        cf.reduce(blade.shell, cf.Rim("tip"), system=blade)


@pytest.mark.parametrize("method", ["free", "craig-bampton"])
@pytest.mark.filterwarnings("ignore:.*support-incomplete")
@pytest.mark.parametrize("supports", [{}, {"base": cf.ElasticEdge(k_z=1e12)}], ids=["free", "sliding"])
def test_refuses_rigid_motions(frustum, supports, method):
    shell = frustum(supports=supports, mesh=cf.ShellMesh(order=6, rows=1, around=9))
    with pytest.raises(ValueError, match="rigid motions"):
        cf.reduce(shell, RIM, modes=6, method=method)


@pytest.mark.parametrize("method", ["free", "craig-bampton"])
@pytest.mark.parametrize("count", [0, -2, 10**6])
def test_refuses_a_number_of_modes_there_is_not(casing, method, count):
    with pytest.raises((ValueError, RuntimeError), match=r"count|modes"):
        cf.reduce(casing.shell, RIM, modes=count, method=method, system=casing)


@pytest.mark.slow
def test_participation_is_the_modal_force_of_gravity_and_gives_a_blades_sag(casing, blade):
    """Phi^T M a against the nodal loads of the same body force; rows (Phi^T M a)/omega^2 against the mesh's statics."""
    a = np.array([1.5, -9.0, 4.0])
    for system, interface, rows_of in (bodies("tip", casing, blade), bodies("rim", casing, blade)):
        basis = cf.reduce(system.shell, interface, modes=30, system=system)
        axes = np.eye(3) if isinstance(interface, cf.Rim) else tip_directions(system, interface)
        load = system.restrict(
            cf.loads.Gravity(acceleration=tuple((a @ axes).tolist())).nodal(system.shell, system.grid)[:, :, None]
        )
        vectors, _ = free_vectors(system, 30)
        force = basis.participation.T @ a
        assert force == pytest.approx((vectors.T @ load)[:, 0], abs=1e-9 * np.abs(force).max())
        if not isinstance(interface, cf.Rim):  # of a casing's rim thirty modes know little: few have one diameter
            rows, _ = rows_of(system, interface)
            exact = (load_columns(system, rows).T @ factorise(system.K).solve(load))[:, 0]
            assert np.abs(basis.rows @ (force / basis.omega**2) - exact).max() <= 1e-3 * np.abs(exact).max()


@pytest.mark.slow
def test_effective_masses_are_those_of_a_cantilever_beam(steel):
    """First three flap modes: .6131, .1883 and .0647 of the mass (Blevins 1979, of the thin beam)."""
    strip = cf.Shell(
        chart=cf.Plate(length=0.4, width=0.02), thickness=1e-3, material=replace(steel, nu=0.0),
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=7, rows=3, around=1),
    )  # fmt: skip
    basis = cf.reduce(strip, cf.Tip(), modes=12)
    shares = np.sort(basis.participation[1] ** 2)[::-1][:3] / (0.4 * 0.02 * 1e-3 * steel.rho)
    assert shares == pytest.approx([0.6131, 0.1883, 0.0647], rel=2e-3)
    assert basis.participation.shape == (3, 12)


def test_participation_survives_the_file(blade, tmp_path):
    basis = cf.reduce(blade.shell, cf.Tip(), modes=4, system=blade)
    again = cf.ModalBasis.load(basis.save(tmp_path / "blade.npz"))
    assert np.array_equal(again.participation, basis.participation)
