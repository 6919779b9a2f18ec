"""Reduction: static pushes equal the full model, for every basis and any number of modes."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

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
def test_a_fixed_rim_cannot_be_pushed(frustum, support):
    tube = frustum(chart=cf.Cylinder(radius=0.5, height=0.3), supports={"base": cf.Clamped(), "top": support})
    with pytest.raises(ValueError, match="'top' is fixed, so forces there have no effect"):
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
def test_provenance_shows_two_structures_apart(casing, frustum):
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
    with pytest.raises(ValueError, match="reduce-rigid"):
        cf.reduce(shell, RIM, modes=6, method=method)


@pytest.mark.parametrize("method", ["free", "craig-bampton"])
@pytest.mark.parametrize("count", [0, -2, 10**6])
def test_refuses_a_number_of_modes_there_is_not(casing, method, count):
    with pytest.raises((ValueError, RuntimeError), match=r"count|modes"):
        cf.reduce(casing.shell, RIM, modes=count, method=method, system=casing)


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


@pytest.mark.slow
def test_a_line_of_a_rim_at_an_edge_is_that_edge_and_one_between_reads_the_shape_there(casing):
    """Rows of the modes: amplitudes of cosine and sine of the radial and hoop displacement along the line."""
    low, high = np.real(casing.shell.chart.bounds[0])
    at = low + 0.37 * (high - low)
    edge, lines = (
        cf.reduce(casing.shell, rim, modes=6, system=casing)
        for rim in (cf.Rim("top", n_max=4), cf.Rim(n_max=4, lines=(at, high)))
    )
    assert len(lines.channels) == 2 * len(edge.channels)
    rows = {name: row for name, row in zip(lines.channels, lines.rows, strict=True)}
    last = [name for name in lines.channels][len(edge.channels) :]
    np.testing.assert_allclose([rows[name] for name in last], edge.rows, atol=1e-3 * np.abs(edge.rows).max())
    found = cf.modes(casing.shell, 6, system=casing)
    theta = 2.0 * np.pi * np.arange(512) / 512
    out = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    sensors = cf.updating.SensorShapes(a=np.full(512, at), b=theta, directions=out, shapes=np.ones((512, 1)), sigma=1.0)
    amplitude = np.fft.rfft(sensors.readings(found), axis=0)[:5] / 512
    expected = np.concatenate([amplitude.real[:1], 2.0 * amplitude.real[1:], -2.0 * amplitude.imag[1:]])
    radial = lines.rows[:9]
    signs = np.sign(np.sum(radial * expected, axis=0))
    np.testing.assert_allclose(radial, expected * signs, atol=1e-4 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("rim", "words"),
    [
        (lambda: cf.Rim("top", n_max=0), "n_max must lie between 1 and 18"),
        (lambda: cf.Rim("top", n_max=19), "n_max must lie between 1 and 18 on this mesh, found 19"),
        (lambda: cf.Rim("rim", n_max=2), "expected a closed casing with"),
        (lambda: cf.Rim(n_max=2), "found neither an edge nor lines"),
        (lambda: cf.Rim(n_max=2, lines=(0.1, 0.1)), r"lines: found 0.1, 0.1 m, expected places from 0 to 0.25\d* m"),
        (lambda: cf.Rim(n_max=2, lines=(-1e-6, 0.1)), "lines: found -1e-06 m, expected places"),
        (lambda: cf.Tip("top"), "Tip"),
    ],
)
def test_interfaces_that_a_casing_does_not_have_are_refused(casing, rim, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        cf.reduce(casing.shell, rim(), modes=2, system=casing)


@pytest.mark.parametrize("count", [0, 101])
def test_a_tip_has_one_to_a_hundred_pieces(blade, count):
    with pytest.raises(cf.errors.ModelError, match=f"count must lie between 1 and 100, found {count}"):
        cf.reduce(blade.shell, cf.TipNodes("tip", count=count), modes=2, system=blade)
