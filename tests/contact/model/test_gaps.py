"""Gaps and bodies before them, by numbers worked out by hand: rods, masses, clamped beams, disks, rims."""

import math
from dataclasses import replace

import numpy as np
import pytest

import contact as ct

BEAM = ct.gaps.Cantilever(length=0.4, width=0.03, height=0.004, E=70e9, rho=2700.0, zeta=0.02)
ROD = {"length": 2.0, "area": 0.7, "E": 1.5, "rho": 1.2}


def test_a_clamped_beam_gives_way_statically_as_a_whole():
    """Tip force: L^3/(3 E I) at the tip; line load: L^4/(8 E I) there, and L^5/(20 E I) of its own work."""
    EI, L = 70e9 * 0.03 * 0.004**3 / 12.0, 0.4
    assert BEAM.EI == pytest.approx(EI, rel=1e-14)
    assert BEAM.line_mass == pytest.approx(2700.0 * 0.03 * 0.004, rel=1e-14)
    for count in (1, 6):
        body = BEAM.modes(count)
        whole = body.S + (body.rows / body.omega**2) @ body.rows.T
        np.testing.assert_allclose(whole, np.array([[L**3 / 3, L**4 / 8], [L**4 / 8, L**5 / 20]]) / EI, rtol=1e-12)
        assert body.zeta.tolist() == [0.02] * count
        assert body.channels == ("tip", "uniform")
    assert BEAM.modes().omega.size == 20
    assert BEAM.modes(200).omega.size == 200
    with pytest.raises(ct.InputError, match="modes: found 201, expected a whole number from 1 to 200"):
        BEAM.modes(201)


def test_shapes_of_a_clamped_beam_by_quadrature():
    """cosh - cos - s (sinh - sin) of b x/L: 2 at the tip, up to its sign, and mean 2 s/b."""
    b = np.array([1.8751040687119611, 4.694091132974174, 7.854757438237613])
    body, x = BEAM.modes(3), (np.arange(20000) + 0.5) / 20000
    for i, root in enumerate(b):
        s = (math.sinh(root) - math.sin(root)) / (math.cosh(root) + math.cos(root))
        shape = np.cosh(root * x) - np.cos(root * x) - s * (np.sinh(root * x) - np.sin(root * x))
        tip = math.cosh(root) - math.cos(root) - s * (math.sinh(root) - math.sin(root))
        norm = math.sqrt(BEAM.line_mass * 0.4 * np.mean(shape**2))
        assert body.rows[:, i] == pytest.approx([tip / norm, 0.4 * shape.mean() / norm], rel=1e-6)
        assert body.omega[i] == pytest.approx((root / 0.4) ** 2 * math.sqrt(BEAM.EI / BEAM.line_mass), rel=1e-12)


def test_a_clamped_beam_before_its_stop():
    gap = BEAM.before_stop(clearance=1e-3, load=50.0, velocity=0.3, modes=4)
    (one,), body = gap.sides, BEAM.modes(4)
    assert (one.sign, one.channel, one.body.omega.size) == (-1, "tip", 4)
    assert one.load == pytest.approx(50.0 * body.rows[1], rel=1e-14)
    assert one.velocity == pytest.approx(0.3 * BEAM.line_mass * body.rows[1], rel=1e-14)
    assert gap.clearance == pytest.approx(1e-3 - 50.0 * body.S[0, 1], rel=1e-12)
    still = BEAM.before_stop(clearance=1e-3)
    assert not np.any(still.sides[0].load)
    assert not np.any(still.sides[0].velocity)
    assert (still.sides[0].body.omega.size, still.clearance) == (20, 1e-3)
    assert BEAM.before_stop(clearance=0.0, load=50.0, modes=1).clearance == max(-50.0 * BEAM.modes(1).S[0, 1], 0.0)


@pytest.mark.parametrize("name", ["length", "width", "height", "E", "rho"])
def test_sizes_of_beams_are_above_zero(name):
    with pytest.raises(ct.InputError, match=f"{name}: found 0.0"):
        replace(BEAM, **{name: 0.0})


@pytest.mark.parametrize("fixed", ["none", "right"])
@pytest.mark.parametrize("end_mass", [0.0, 0.9])
def test_modes_of_a_rod_solve_its_equation_and_leave_its_static_compliance(fixed, end_mass):
    """Far end free or held; at the other E A u' = omega^2 m u of the mass there; unit mass by quadrature."""
    rod = ct.Rod(**ROD, fixed=fixed, end_mass=end_mass)
    body = ct.gaps.rod_modes(rod, modes=5, zeta=0.03, end="left")
    mass, EA, c = 1.2 * 0.7 * 2.0, 1.5 * 0.7, math.sqrt(1.5 / 1.2)
    xi = (np.arange(4000) + 0.5) / 4000
    assert body.zeta.tolist() == [0.03] * 5
    beta = body.omega * 2.0 / c
    for k, (b, omega) in enumerate(zip(beta, body.omega, strict=True)):
        shape, slope = (np.cos, lambda x: -np.sin(x)) if fixed == "none" else (np.sin, np.cos)
        assert EA * b / 2.0 * slope(b) == pytest.approx(omega**2 * end_mass * shape(b), abs=1e-9)
        norm = math.sqrt(mass * np.mean(shape(b * xi) ** 2) + end_mass * shape(b) ** 2)
        assert body.rows[0, k] == pytest.approx(shape(b) / norm, rel=1e-6)
        assert body.recovery[0, k] == pytest.approx((1.0 if fixed == "none" else 0.0) / norm, rel=1e-6)
        low = k * math.pi - (math.pi / 2.0 if fixed == "none" else 0.0)
        assert low - 1e-9 <= b <= low + math.pi / 2.0 + 1e-9
    elastic = body.omega > 0.0
    assert elastic.tolist() == [fixed != "none", True, True, True, True]
    many = ct.gaps.rod_modes(rod, modes=4000, end="left")
    whole = np.sum((many.rows[0, many.omega > 0.0] / many.omega[many.omega > 0.0]) ** 2)
    kept = np.sum((body.rows[0, elastic] / body.omega[elastic]) ** 2)
    assert body.S[0, 0] == pytest.approx(whole - kept, rel=5e-3)
    assert ct.gaps.rod_modes(rod, end="left").omega.size == 50
    assert not ct.gaps.rod_modes(rod, end="left").zeta.any()


def test_channels_of_a_rod_are_its_free_end():
    assert ct.gaps.rod_modes(ct.Rod(**ROD, fixed="left"), modes=2).channels == ("right",)
    assert ct.gaps.rod_modes(ct.Rod(**ROD, fixed="right"), modes=2).channels == ("left",)
    assert ct.gaps.rod_modes(ct.Rod(**ROD), modes=2, end="right").channels == ("right",)
    with pytest.raises(ct.InputError, match="expected a rod with one contact end"):
        ct.gaps.rod_modes(ct.Rod(**ROD), modes=2)


def test_sides_of_a_gap_are_one_system():
    body = ct.ModalBody(omega=[1.0, 2.0], zeta=[0.1, 0.2], channels=("x", "y"), rows=[[1.0, 2.0], [3.0, 4.0]],
                        S=[[0.5, 0.1], [0.1, 0.25]])  # fmt: skip
    one = ct.gaps.Side(body=body, channel="y", sign=-1, velocity=[5.0, 6.0], load=[7.0, 8.0], potential=2.0, mass=3.0)
    gap = ct.PointGap(sides=(one, ct.gaps.Side(body=body, channel="x", sign=1, potential=0.5)), clearance=0.125)
    found = ct.gaps.point_system(gap)
    assert found.Q.tolist() == [-3.0, -4.0, 1.0, 2.0]
    assert (found.omega.tolist(), found.zeta.tolist()) == ([1.0, 2.0] * 2, [0.1, 0.2] * 2)
    assert (found.load.tolist(), found.velocity.tolist()) == ([7.0, 8.0, 0.0, 0.0], [5.0, 6.0, 0.0, 0.0])
    assert (found.first.tolist(), found.potential, found.masses[0]) == ([0, 2, 4], 2.5, 3.0)
    assert (found.S_nn(0.3), found.clearance(0.3), found.S_nt(0.3), found.S_tt(0.3)) == (0.75, 0.125, 0.0, 0.0)
    assert not found.compliance_turns
    assert gap.load_response == 113.0
    plain = ct.gaps.Side(body=body, channel="y", sign=1)
    assert (plain.name, plain.potential, math.isnan(plain.mass)) == ("body", 0.0, True)
    assert ct.PointGap(sides=(plain,)).clearance == 0.0
    for name in ("velocity", "load"):
        with pytest.raises(ct.InputError, match=name):
            ct.gaps.Side(body=body, channel="y", sign=1, **{name: [1.0]})


def test_a_pair_as_a_rim_has_its_two_waves():
    casing = ct.gaps.ModalPair(n=2, freq_hz=300.0, modal_mass=4.0, zeta=0.01)
    rows = ct.gaps.pair_rim(casing, radius=0.3).rows
    expected = np.zeros((10, 2))
    expected[[2, 4], [0, 1]], expected[[9, 7], [0, 1]] = 0.5, [-0.25, 0.25]
    np.testing.assert_array_equal(rows, expected)
    assert ct.gaps.pair_rim(casing, radius=0.3).zeta.tolist() == [0.01, 0.01]


def test_a_disk_of_mistuned_blades_as_a_body():
    disk = ct.gaps.BladedDisk(
        blades=3, freq_hz=100.0, modal_mass=0.25, coupling=0.3, mistuning=[0.0, 0.1, -0.2], zeta=0.01, compliance=3e-6,
        lean_deg=12.0,
    )  # fmt: skip
    own = np.array([1.0, 1.21, 0.64]) + 0.6
    expected = (200.0 * math.pi) ** 2 * (np.diag(own) - 0.3 * (np.ones((3, 3)) - np.eye(3)))
    np.testing.assert_allclose(disk.stiffness, expected, rtol=1e-12)
    body = disk.body()
    flaps = body.rows[1::2]
    np.testing.assert_allclose(flaps @ np.diag(body.omega**2) @ flaps.T, 4.0 * expected, rtol=1e-9)
    assert not body.rows[::2].any()
    np.testing.assert_array_equal(body.S, 3e-6 * np.eye(6))
    assert body.zeta.tolist() == [0.01] * 3
    assert body.channels == ("span0", "flap0", "span1", "flap1", "span2", "flap2")
    tips = disk.tips()
    assert [(tip.span, tip.flap, tip.angle_deg, tip.lean_deg, tip.track) for tip in tips] == [
        (f"span{j}", f"flap{j}", 120.0 * j, 12.0, 0) for j in range(3)
    ]
    plain = ct.gaps.BladedDisk(blades=3, freq_hz=100.0, modal_mass=0.25)
    assert (plain.coupling, plain.zeta, plain.compliance, plain.lean_deg) == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("name", "value"),
    [("freq_hz", 0.0), ("modal_mass", -1.0), ("coupling", -0.1), ("compliance", -1.0), ("zeta", -0.1),
     ("lean_deg", math.nan), ("blades", 1)],
)  # fmt: skip
def test_disks_that_cannot_be_are_refused(name, value):
    with pytest.raises(ct.InputError, match=f"{name}: found {value}"):
        ct.gaps.BladedDisk(**{"blades": 3, "freq_hz": 100.0, "modal_mass": 0.25} | {name: value})


@pytest.mark.parametrize(
    ("omega", "mass", "known"),
    [([0.0, 9.0], 4.0, True), ([9.0, 0.0], 4.0, True), ([5.0, 9.0], 4.0, False), ([0.0, 0.0], 4.0, False),
     ([0.0, 9.0], math.nan, False)],
)  # fmt: skip
def test_mean_velocity_and_momentum_are_those_of_the_one_rigid_motion_of_a_body_of_known_mass(omega, mass, known):
    body = ct.ModalBody(omega=omega, zeta=[0.0, 0.0], channels=("x",), rows=[[0.5, 0.1]], S=[[1e-6]])
    velocity = [6.0 if w == 0.0 else 0.2 for w in omega]
    side = ct.gaps.Side(body=body, channel="x", sign=1, velocity=velocity, mass=mass)
    (motion,) = ct.run(ct.PointGap(sides=(side,), clearance=9.0), t_end=0.1, dt=1e-3).motions
    expected = (3.0, 12.0) if known else (math.nan, math.nan)
    assert (motion.mean_velocity, motion.momentum) == pytest.approx(expected, nan_ok=True)
