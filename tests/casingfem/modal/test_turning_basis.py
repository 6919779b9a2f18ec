"""Rotation in a reduced basis: whirl of the full model, a ring in closed form, the sense of its waves, refusals."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.verification.modes.cyclic import bladed_disk
from reports.verification.rotation import drum, ring_waves

pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-(kink|thin-curved)")
STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
BASE = {"base": cf.Clamped()}


def poles(body, omega):
    """Frequencies [rad/s] ascending in the turning frame and mode shapes (modes, modes) of a body that turns."""
    C, K = body.matrices(omega)
    m = len(C)
    values, vectors = np.linalg.eig(np.block([[np.zeros((m, m)), np.eye(m)], [-K, -C]]))
    upper = np.flatnonzero(values.imag > 0.0)
    upper = upper[np.argsort(values.imag[upper])]
    return values.imag[upper], vectors[:m, upper]


def senses(body, vectors, omega):
    """Nodal diameters of the radial motion on the rim, and 1 for a wave that runs with the rotation, else -1."""
    N = body.n_max
    radial = (body.rows @ vectors)[: 2 * N + 1]
    c, s = radial[: N + 1], np.concatenate([0.0 * radial[:1], radial[N + 1 :]])
    forward, backward = np.abs(c + 1j * s), np.abs(c - 1j * s)  # c cos + s sin: with s = -i c it runs to larger theta
    n = np.hypot(forward, backward)[1:].argmax(axis=0) + 1
    at = np.arange(len(n))
    return n, (np.sign(forward[n, at] - backward[n, at]) * np.sign(omega)).astype(int)


def receptance(body, omega, frequency):
    """Displacements of the interface under harmonic unit forces, in the frame of a body that turns."""
    C, K = body.matrices(omega)
    dynamic = K + 1j * frequency * C - frequency**2 * np.eye(len(K))
    return body.rows @ np.linalg.solve(dynamic, body.rows.T) + body.S


@pytest.fixture(scope="module")
def frustum():
    return cf.Shell(
        chart=cf.Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=STEEL, supports=BASE
    )


@pytest.fixture(scope="module")
def casing():
    return cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, supports=BASE, material=STEEL,
                    mesh=cf.ShellMesh(order=6, rows=2, around=9))  # fmt: skip


def whirl(part, omega, count):
    return 2.0 * np.pi * cf.whirl_modes(replace(part, rotation=cf.Rotation(omega=omega)), count).freq


@pytest.mark.campaign
def test_reference_frustum_at_300_rpm_whirls_as_its_full_model(frustum):
    """20 modes; n = 10 at 422.01 Hz parts into 423.87 and 425.76 Hz."""
    omega = 2.0 * np.pi * 5.0
    body = ct.ModalBody.of(cf.reduce(frustum, cf.Rim("top", n_max=16), modes=20))
    found, vectors = poles(body, omega)
    exact = cf.whirl_modes(replace(frustum, rotation=cf.Rotation(omega=omega)), 8)
    np.testing.assert_allclose(found[:8] / (2.0 * np.pi), exact.freq, rtol=2e-9)
    n, sense = senses(body, vectors[:, :8], omega)
    assert n.tolist() == exact.nodal_diameters.tolist()
    assert sense.tolist() == exact.sense.tolist()
    upper = body.poles(omega).imag[len(found) :]
    np.testing.assert_allclose(upper, found, rtol=1e-9)
    pair = [found[k] / (2.0 * np.pi) for s in (1, -1) for k in np.flatnonzero((n == 10) & (sense == s))]
    np.testing.assert_allclose(pair, [423.87, 425.76], atol=0.01)
    assert body.omega[np.abs(body.omega - found[6]).argmin()] / (2.0 * np.pi) == pytest.approx(422.01, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("spin", "speeds"), [(0.0, (900.0,)), (-900.0, (-1200.0,))])
def test_frequencies_err_by_less_than_a_millionth_where_the_speed_changes_none_by_two_fifths(casing, spin, speeds):
    """By its projections alone the basis at rest errs by 7e-5 and 2e-4, that at speed by 1e-4 beside its speed."""
    part = replace(casing, rotation=cf.Rotation(omega=spin)) if spin else casing
    basis = cf.reduce(part, cf.Rim("top", n_max=8), modes=20)
    body = ct.ModalBody.of(basis)
    assert basis.gyroscopic_higher.shape == basis.stiffness_higher.shape == (2, 20, 20)
    for omega in speeds:
        found = poles(body, omega)[0][:6]
        np.testing.assert_allclose(found, whirl(casing, omega, 6), rtol=1e-6)


@pytest.mark.slow
def test_a_basis_in_a_file_whirls_as_the_one_in_memory_and_one_without_higher_powers_is_read(casing, tmp_path):
    basis = cf.reduce(casing, cf.Rim("top", n_max=8), modes=8)
    body = ct.ModalBody.load(basis.save(tmp_path / "casing.npz"))
    body.save(tmp_path / "again.npz")
    for one in (body, ct.ModalBody.load(tmp_path / "again.npz"), ct.ModalBody.of(basis)):
        np.testing.assert_array_equal(one.poles(700.0), body.poles(700.0))
    plain = replace(basis, gyroscopic_higher=np.zeros((0, 0, 0)), stiffness_higher=np.zeros((0, 0, 0)))
    older = ct.ModalBody.load(plain.save(tmp_path / "older.npz")).poles(700.0)
    assert 1e-6 < np.abs(older / body.poles(700.0) - 1.0).max() < 1e-3


@pytest.mark.slow
def test_ring_at_rest_reduced_turns_as_the_closed_form():
    """Carrier's ring with springs: the basis is made without a rotation, the rim's axis is that of the chart."""
    omega = 240.0
    k = 1.5 * omega**2
    ring = replace(drum(0.5, 0.004, 0.002, omega, k), rotation=None)
    body = ct.ModalBody.of(cf.reduce(ring, cf.Rim("top", n_max=4), modes=30))
    found, vectors = poles(body, omega)
    n, sense = senses(body, vectors, omega)
    still = 3 * 8 / np.sqrt(10.0) * np.sqrt(210e9 * 0.002**2 / 12 / 7800.0) / 0.25
    strain = 7800.0 * omega**2 * 0.25 / 210e9
    for s, exact in zip((1, -1), ring_waves(3, omega, still=still, springs=k), strict=True):
        assert np.abs(found[(n == 3) & (sense == s)] / exact - 1.0).min() < 4.0 * strain


@pytest.mark.slow
def test_rim_turns_about_its_own_axis_whichever_way_the_study_turns():
    """A speed about -z is a negative speed about z: same receptances, same spin."""
    wall = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=2e-3, supports=BASE, material=STEEL,
                    rotation=cf.Rotation(omega=-300.0), mesh=cf.ShellMesh(order=6, rows=1, around=9))  # fmt: skip
    other = replace(wall, rotation=cf.Rotation(omega=300.0, axis=(0.0, 0.0, -2.0)))
    one, two = (ct.ModalBody.of(cf.reduce(part, cf.Rim("top", n_max=8), modes=12)) for part in (wall, other))
    assert one.spin == two.spin == -300.0
    expected = receptance(one, -500.0, 7600.0)
    np.testing.assert_allclose(receptance(two, -500.0, 7600.0), expected, atol=1e-6 * np.abs(expected).max())
    assert np.abs(receptance(two, 500.0, 7600.0) - expected).max() > 0.1 * np.abs(expected).max()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["quad9", "hexahedron20"])
def test_imported_casing_at_rest_turns_as_its_full_model(kind):
    """About an axis of its own; the full model turns at the speed."""
    wall, flat = cf.imported.revolved((0.2, 0.2), (0.0, 0.1), 0.006), kind == "quad9"
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # z -> x
    mesh = cf.imported.grid_mesh(
        kind, (24, 4) if flat else (1, 24, 3), lambda u: wall(np.insert(u, 0, 0.5, axis=1) if flat else u) @ turn.T,
        groups={"base": (2 - flat, 0.0), "top": (2 - flat, 1.0)}, wrap=1 - flat,
    )  # fmt: skip
    axis, omega = tuple(turn[:, 2].tolist()), 200.0
    more = {"thickness": 0.006} if flat else {}
    part = (cf.MeshShell if flat else cf.Solid)(mesh=mesh, material=STEEL, supports=BASE, **more)
    body = ct.ModalBody.of(cf.reduce(part, cf.Rim("top", n_max=6, axis=axis), modes=16))
    found, vectors = poles(body, omega)
    exact = cf.whirl_modes(replace(part, rotation=cf.Rotation(omega=omega, axis=axis)), 6)
    np.testing.assert_allclose(found[:6] / (2.0 * np.pi), exact.freq, rtol=1e-5)
    assert np.abs(found[:6] / body.omega[:6] - 1.0).max() > 1e-3
    n, sense = senses(body, vectors[:, :6], omega)
    assert sense[np.argsort(n, kind="stable")].tolist() == [1, -1] * 3  # of each pair the forward wave is the lower one


@pytest.mark.slow
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_tip_turns_from_span_to_flap(way):
    """x'' of the flap + 2 Omega x' of the span = force: with all motion of the body along both, p^T G p = 2 m."""
    chart = cf.Plate(length=0.2, width=0.1)
    rotation = cf.Rotation.of_blade(chart, omega=50.0, hub_radius=0.3)
    axis = tuple(way * x for x in rotation.axis)
    blade = cf.Shell(chart=chart, thickness=4e-3, material=STEEL, supports={"root": cf.Clamped()},
                     rotation=replace(rotation, axis=axis), mesh=cf.ShellMesh(order=6, rows=2, around=1))  # fmt: skip
    body = ct.ModalBody.of(cf.reduce(blade, cf.Tip(), modes=60))
    span, flap, _ = body.participation
    masses = [part @ part for part in (span, flap)]
    assert flap @ body.gyroscopic @ span == pytest.approx(2.0 * min(masses), rel=0.2)
    assert body.spin == -way * 50.0  # the blade's chord is against the axis that turns span to flap
    nodes = cf.reduce(blade, cf.TipNodes(count=2), modes=60)
    np.testing.assert_allclose(nodes.gyroscopic, body.gyroscopic, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 0.0, -2.5)])
def test_wheel_turns_towards_the_next_sector(axis):
    """Waves of one nodal diameter: frequencies and the sector that they reach next, whichever way the axis points."""
    N, omega = 4, 900.0
    sector = replace(bladed_disk(N, (1, 1, 2, 1), cf.Rotation(omega=omega)), axis=axis)
    body = ct.ModalBody.of(cf.modal.cyclic_reduce(sector, cf.TipNodes("tip", 1), modes=6))
    way = np.sign(axis[2])
    assert body.spin == way * omega
    found, vectors = poles(body, way * omega)
    tips = (body.rows @ vectors).reshape(N, 3, -1)[:, 1]
    ahead = np.abs(np.fft.fft(tips, axis=0))[[-1 % N, 1]]  # e^(-i n theta) e^(i omega t) runs to larger theta
    exact = cf.modal.cyclic_whirl(sector, 1, diameters=[1])
    for sense, freq in zip(exact.sense, exact.freq, strict=True):
        k = int(np.abs(found - 2.0 * np.pi * freq).argmin())
        assert found[k] / (2.0 * np.pi) == pytest.approx(freq, rel=1e-4)
        assert np.sign(ahead[0, k] - ahead[1, k]) == sense * way


def test_casing_that_turns_about_another_axis_than_its_rim_is_refused():
    mesh = cf.ShellMesh(order=4, rows=1, around=9)
    wall = cf.Shell(chart=cf.Cylinder(radius=0.2, height=0.1), thickness=4e-3, supports=BASE, material=STEEL, mesh=mesh)
    for rotation in (cf.Rotation(omega=1.0, axis=(0.0, 1.0, 1.0)), cf.Rotation(omega=0.0, centre=(0.01, 0.0, 0.0))):
        with pytest.raises(
            cf.errors.ModelError, match=r"rotation: found the axis .* expected .* \(0\.0, 0\.0, 1\.0\) .*reduce-axis"
        ):
            cf.reduce(replace(wall, rotation=rotation), cf.Rim("top", n_max=2), modes=4)
