"""Wheels from one sector against the whole wheel: modes, waves, mistuning, the basis for rubs."""

import re
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from reports.verification.modes.cyclic import bent_plate, bladed_disk

N, COUNT = 4, 4
TURNING = cf.Rotation(omega=900.0)
SMALL = (1, 1, 2, 1)
DEVIATIONS = np.array([0.02, -0.01, 0.0, -0.03])
pytestmark = pytest.mark.filterwarnings("ignore:.*mesh-(kink|thin-curved)")


@pytest.fixture(scope="module")
def disk():
    return bladed_disk(N, SMALL)


@pytest.fixture(scope="module")
def tuned(disk):
    return cf.modal.cyclic_reduce(disk, cf.TipNodes("tip", 2), modes=3, zeta=0.002)


def test_a_band_may_contain_no_mode_of_some_diameters_or_of_all(disk):
    first = cf.modal.cyclic_modes(disk, 1, diameters=[0, 1])
    lowest = int(first.freq.argmin())
    found = cf.modal.cyclic_modes(disk, (1.0, first.freq.mean()), diameters=[0, 1])
    assert found.nodal_diameters.tolist() == [first.nodal_diameters[lowest]]
    np.testing.assert_allclose(found.freq, first.freq[lowest], rtol=1e-9)
    none = cf.modal.cyclic_modes(disk, (1.0, 2.0), diameters=[0, 1])
    assert len(none) == len(cf.modal.wheel_modes(none)) == 0
    assert none.records() == []


def test_a_free_wheel_has_its_six_rigid_motions(disk):
    free = cf.imported.CyclicSector(structure=replace(disk.structure, supports={}), sectors=N)
    found = cf.modal.cyclic_modes(free, 3, diameters=[0, 1])
    assert sum(bool(row["rigid"]) for row in found.records()) == 6
    assert found.nodal_diameters[found.rigid].tolist() == [0, 0, 1, 1]
    whole = cf.modal.wheel_modes(found)
    assert whole.rigid == 6
    assert whole.freq[5] < 1e-3 * whole.freq[6]


@pytest.mark.parametrize("make", [lambda: bent_plate(4, counts=(2, 2)), lambda: bladed_disk(4, SMALL)])
def test_modes_of_a_sector_around_the_wheel_solve_its_equations(make):
    """Displacements and, on shells, rotations in the frames of the nodes: K u = omega^2 M u on the whole wheel."""
    found = cf.modal.wheel_modes(cf.modal.cyclic_modes(make(), 2))
    system = found.structure.assembled()
    u = found.fields.reshape(-1, len(found))[system.free]
    inertia = (system.M @ u) * found.omega**2
    np.testing.assert_allclose(system.K @ u, inertia, atol=1e-5 * np.abs(inertia).max())
    assert found.nodal_diameters.tolist().count(1) == 4
    assert len(found.doublets) == 2


@pytest.mark.slow
def test_a_wheel_that_turns_the_other_way_has_the_other_waves():
    one, other = (
        cf.modal.cyclic_whirl(bladed_disk(N, SMALL, TURNING.at(speed)), 2, diameters=[1]) for speed in (900.0, -900.0)
    )
    np.testing.assert_allclose(one.freq, other.freq, rtol=1e-9)
    assert one.sense.tolist() == other.sense.tolist() == [-1, -1, 1, 1]
    assert one.freq_fixed[2] > one.freq[2]
    with pytest.raises(cf.errors.ModelError, match="rotation-none"):
        cf.modal.cyclic_whirl(bladed_disk(N, SMALL))


@pytest.mark.slow
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.0, 0.0, -2.5)])
def test_waves_pass_from_sector_to_sector_with_the_phase_of_their_sense(axis):
    """Whichever way the wheel's axis is given: the sense is that of the rotation."""
    sector = replace(bladed_disk(N, SMALL, TURNING), axis=axis)
    waves = cf.modal.cyclic_whirl(sector, 1)
    labels = list(zip(waves.nodal_diameters.tolist(), waves.sense.tolist(), strict=True))
    assert labels == [(0, 0), (1, -1), (1, 1), (2, 0)]
    assert np.abs(waves.freq[1] / waves.freq[2] - 1.0) > 1e-4
    along = np.sign(axis[2])  # sector 1 follows sector 0 about the axis
    for (n, sense), shape in zip(labels, np.moveaxis(waves.fields, 2, 0), strict=True):
        assert np.abs(shape).max() == pytest.approx(1.0, rel=1e-12)
        phase = np.exp(-2j * np.pi * n / N * (along * sense if sense else 1.0))
        passed = phase * shape[sector.pairs.low] @ sector.turn.matrix.T
        np.testing.assert_allclose(shape[sector.pairs.high], passed, atol=1e-9)


@pytest.mark.slow
def test_a_table_of_waves_shows_what_turns_with_the_wheel_and_what_is():
    waves = cf.modal.cyclic_whirl(bladed_disk(N, SMALL, TURNING), 1, diameters=[2, 1])
    turns = 900.0 / (2.0 * np.pi)
    fixed = [abs(waves.freq[0] - turns), waves.freq[1] + turns, waves.freq[2]]
    np.testing.assert_allclose(waves.freq_fixed, fixed, rtol=1e-14)
    title, *rows = repr(waves).splitlines()
    assert title.split() == ["n", "wave", "turning", "[Hz]", "at", "rest", "[Hz]"]
    assert [row.split() for row in rows] == [
        [str(n), wave, f"{f:.3f}", f"{at:.3f}"]
        for n, wave, f, at in zip((1, 1, 2), ("backward", "forward", "single"), waves.freq, fixed, strict=True)
    ]
    assert [(row["n"], row["sense"], row["freq_hz"], row["freq_fixed_hz"]) for row in waves.records()] == [
        (n, s, pytest.approx(f, rel=1e-14), pytest.approx(at, rel=1e-14))
        for n, s, f, at in zip((1, 1, 2), (-1, 1, 0), waves.freq, fixed, strict=True)
    ]
    assert len(waves) == 3


@pytest.mark.slow
def test_all_blades_alike_scale_nothing_but_the_stiffness_of_a_whole_sector(disk):
    tuned = cf.modal.wheel_modes(cf.modal.cyclic_modes(disk, 3)).freq
    np.testing.assert_allclose(cf.modal.mistuned_modes(disk, [0.05] * N, 3).freq, 1.05 * tuned, rtol=1e-9)


@pytest.mark.slow
def test_the_basis_knows_how_the_stiffness_grows_with_speed():
    """Poles, and answers at the tips near the lowest of them, with a basis made at another speed."""
    at, higher = (
        cf.modal.cyclic_reduce(bladed_disk(N, SMALL, TURNING.at(w)), cf.TipNodes("tip", 1), modes=6)
        for w in (900.0, 2000.0)
    )
    grown = np.diag(at.omega**2) + (2000.0**2 - 900.0**2) * at.stiffness_by_speed
    np.testing.assert_allclose(np.sqrt(np.linalg.eigvalsh(grown))[:N], np.sort(higher.omega)[:N], rtol=2e-4)
    driven = (0.9 * higher.omega.min()) ** 2 * np.eye(len(at))
    answer = at.rows @ np.linalg.solve(grown - driven, at.rows.T) + at.S
    wanted = higher.rows @ np.linalg.solve(np.diag(higher.omega**2) - driven, higher.rows.T) + higher.S
    size = np.abs(wanted).max()
    assert np.abs(answer - wanted).max() < 1e-3 * size
    still = at.rows @ np.linalg.solve(np.diag(at.omega**2) - driven, at.rows.T) + at.S
    assert np.abs(still - wanted).max() > 3e-2 * size


def test_the_basis_is_a_body_whose_tips_are_around(tuned, tmp_path):
    body = ct.ModalBody.load(tuned.save(tmp_path / "wheel.npz"))
    assert (body.sectors, len(body.channels), len(body.omega)) == (N, 6 * N, 3 * N)
    assert cf.ModalBasis.load(tmp_path / "wheel.npz").sectors == N


def loose(disk):
    return cf.imported.CyclicSector(structure=replace(disk.structure, supports={}), sectors=N)


def test_nodes_of_a_wheel_are_off_its_axis():
    """A quarter of a square block: one edge of it is the axis."""
    steel, groups = cf.Material(E=210e9, nu=0.3, rho=7800.0), {"low": (1, 0.0), "high": (0, 0.0), "held": (2, 0.0)}
    mesh = cf.imported.grid_mesh("hexahedron20", (2, 2, 1), lambda u: u * [0.1, 0.1, 0.05], groups=groups)
    part = cf.Solid(mesh=mesh, material=steel, supports={"held": cf.Clamped()})
    quarter = cf.imported.CyclicSector(structure=part, sectors=4)
    on, off = (int(mesh.node_numbers[np.linalg.norm(mesh.points - at, axis=1).argmin()]) for at in
               ([0.0, 0.0, 0.05], [0.1, 0.1, 0.05]))  # fmt: skip
    assert cf.modal.cyclic_reduce(quarter, cf.modal.AtNodes((off,)), modes=1).channels[:3] == tuple(
        f"sector0.{off}.{name}" for name in ("span", "flap", "chord")
    )
    with pytest.raises(cf.errors.ModelError, match=f"at: found node {on} on the wheel's axis.*interface-nodes"):
        cf.modal.cyclic_reduce(quarter, cf.modal.AtNodes((off, on)), modes=1)


def turning_ring(speed, k):
    """A ring about z as a wheel of eight sectors, both its edges on springs of k [N/m^3], or free."""
    wall = cf.imported.revolved((0.5, 0.5), (0.0, 0.05), 0.02)
    mesh = cf.imported.grid_mesh(
        "hexahedron20", (1, 1, 1), lambda u: wall(u * [1.0, 0.125, 1.0]), groups={"base": (2, 0.0), "top": (2, 1.0)}
    )
    springs = dict.fromkeys(("base", "top"), cf.ElasticEdge(k_face=k)) if k else {}
    steel = cf.Material(E=210e9, nu=0.3, rho=7800.0)
    ring = cf.Solid(mesh=mesh, material=steel, supports=springs, rotation=cf.Rotation(omega=speed))
    return cf.imported.CyclicSector(structure=ring, sectors=8)


@pytest.mark.slow
def test_a_ring_on_soft_springs_is_unstable_beyond_its_own_frequency():
    """Its way across the axis, seen in the turning frame: w^2 = k/m - Omega^2."""
    own = np.sqrt(2.0 * 1e6 / (7800.0 * 0.05))

    def lowest(speed):
        return cf.modal.cyclic_modes(turning_ring(speed * own, 1e6), 1, diameters=[1]).freq[0]

    for below in (0.99, 0.99995):  # the second leaves 0.51 rad^2/s^2
        assert (2.0 * np.pi * lowest(below) / own) ** 2 == pytest.approx(1.0 - below**2, abs=1e-6)
    with pytest.raises(
        cf.errors.ModelError, match=r"modes: found omega\^2 = -103\.\d rad\^2/s\^2, n = 1.*rotation-unstable"
    ):
        lowest(1.01)


@pytest.mark.parametrize("speed", [1.0, 10.0, 100.0])
def test_a_free_wheel_turns_and_slides_along_its_axis_at_any_speed(speed):
    """Both are rigid, omega = 0 but for round-off of either sign; across the axis it leaves the turning frame."""
    wheel = turning_ring(speed, 0.0)
    found = cf.modal.cyclic_modes(wheel, 3, diameters=[0])
    assert found.rigid.tolist() == [True, True, False]
    np.testing.assert_allclose(found.freq[:2], 0.0, atol=0.01)
    with pytest.raises(cf.errors.ModelError, match=r"omega\^2 = -.* rad\^2/s\^2, n = 1") as refused:
        cf.modal.cyclic_modes(wheel, 1, diameters=[1])
    told = re.search(r"= (-[\d.e+]+) rad", str(refused.value))
    assert told is not None
    assert float(told[1]) == pytest.approx(-(speed**2), rel=1e-3, abs=1e-3)  # K holds it to some 1e-4


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda disk: cf.modal.cyclic_modes(disk, 1, diameters=[3]),
            r"found \[3\], expected some of 0 to 2.*cyclic-diameters",
        ),
        (lambda disk: cf.modal.mistuned_modes(disk, [0.1] * 3), "found 3 values, expected 4.*cyclic-mistuning"),
        (lambda disk: cf.modal.mistuned_modes(disk, [0.1, 0.0, 0.0, -1.0]), "found -1, expected 4.*cyclic-mistuning"),
        (lambda disk: cf.modal.mistuned_modes(disk, DEVIATIONS, blade="vane"), "mesh-no-group"),
        (lambda disk: cf.modal.cyclic_reduce(disk, cf.Rim("tip", 2)), "interface-edge"),
        (lambda disk: cf.modal.cyclic_reduce(disk, cf.TipNodes("tip", 2), zeta=1.0), "reduce-damping"),
        (lambda disk: cf.modal.cyclic_reduce(disk, cf.TipNodes("hub", 1)), "interface-held"),
        (
            lambda disk: cf.modal.cyclic_reduce(loose(disk), cf.TipNodes("tip", 2)),
            "found a structure without supports.*reduce-rigid",
        ),
        (
            lambda disk: cf.modal.cyclic_reduce(disk, cf.TipNodes("tip", 2), modes=0),
            "between 1 and 74, found 0.*modes-count",
        ),
        (
            lambda disk: cf.modal.cyclic_reduce(disk, cf.TipNodes("tip", 2), modes=75),
            "between 1 and 74, found 75.*modes-count",
        ),
    ],
)
def test_what_a_wheel_cannot_be_asked_is_refused(disk, call, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        call(disk)
