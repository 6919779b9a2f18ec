"""What a wall adds up to at a point, term by term: curved, linear and layered; as a beam; its inertia."""

from types import SimpleNamespace

import numpy as np
import pytest

import casingfem as cf
from casingfem.structure.shell.parts import ShellParts, sampled_geometry
from casingfem.structure.shell.plies import layered_inertia, layered_wall, mirrored, turned
from casingfem.structure.shell.wall import (
    constitutive,
    curved_wall,
    inertia,
    linear_wall,
    mean_and_gauss,
    section,
    stretched_rows,
)

STEEL = cf.Material(E=210e9, nu=0.3, rho=7800.0)
CARBON = cf.shell.Lamina(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, G13=4e9, G23=3e9, rho=1600.0)
POINT = np.array([0.1]), np.array([0.4])


def parts(chart=None, **changes):
    given = {"chart": chart or cf.Cylinder(radius=0.5, height=0.3), "thickness": 0.02, "material": STEEL}
    return ShellParts(**given | changes)


def tensor(eps):
    return np.array([[eps[0], 0.5 * eps[2]], [0.5 * eps[2], eps[1]]])


def energy(strain, stretch, b, t, E, nu, shear):
    """Twice the energy of a curved wall by three points of Gauss: eps, chi, gamma and s1, s2 as the theory has them."""
    mu, lam = E / (2.0 * (1.0 + nu)), E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    eps, chi, gamma, (s1, s2) = tensor(strain[:3]), tensor(strain[3:6]), strain[6:], stretch
    total = 0.0
    for x, w in zip(*np.polynomial.legendre.leggauss(3), strict=True):
        z = 0.5 * t * x
        P = np.linalg.inv(np.eye(2) - z * b)
        mixed = P @ (2.0 * eps + z * chi)
        e = 0.5 * (mixed + mixed.T) - eps - b @ P * (z * s1 + 0.5 * (z**2 - t**2 / 12.0) * s2)
        e33, g = s1 + z * s2, P @ gamma
        trace = np.trace(e) + e33
        density = 2.0 * mu * (np.sum(e**2) + e33**2) + lam * trace**2 + shear * g @ g
        total += 0.5 * t * w * np.linalg.det(np.eye(2) - z * b) * density
    return total


@pytest.mark.slow
def test_the_curved_wall_has_the_least_energy_of_its_stretches():
    """The 10 x 10 form of strains and stretches by the energy of its unit vectors, s1 and s2 taken out."""
    E, nu, shear, t = 3.0, 0.27, 0.7, 0.3
    b = np.array([[0.8, 0.35], [0.35, -0.5]])
    unit = np.eye(10)

    def of(v):
        return energy(v[:8], v[8:], b, t, E, nu, shear)

    whole = np.array([[0.5 * (of(u + v) - of(u) - of(v)) for u in unit] for v in unit])
    exact = whole[:8, :8] - whole[:8, 8:] @ np.linalg.solve(whole[8:, 8:], whole[8:, :8])
    at = (np.array([x]) for x in (E, nu, shear, t))
    found = curved_wall(*at, np.array([[0.8], [-0.5], [0.35]]))[..., 0]
    np.testing.assert_allclose(found, exact, rtol=1e-12, atol=1e-14)
    assert np.abs(found[:6, 6:]).max() == 0.0


def test_strains_at_depth_with_their_stretches():
    """A row for each of e_11, e_22, 2 e_12, e_33 and the trace, at one depth."""
    b, z, t = np.array([[0.8, 0.35], [0.35, -0.5]]), 0.1, 0.3
    P = np.linalg.inv(np.eye(2) - z * b)
    rows = stretched_rows(np.array([0.8, -0.5, 0.35])[:, None, None], np.full((1, 1), z), np.full((1, 1), t))[0, 0]
    for column, weight in ((6, z), (7, 0.5 * (z**2 - t**2 / 12.0))):
        e = -weight * b @ P
        e33 = 1.0 if column == 6 else z
        expected = [e[0, 0], e[1, 1], 2.0 * e[0, 1], e33, e[0, 0] + e[1, 1] + e33]
        np.testing.assert_allclose(rows[:, column], expected, rtol=1e-13)


def test_resultants_of_a_linear_wall():
    D = linear_wall(np.arange(1.0, 10.0).reshape(3, 3, 1), np.array([7.0]), np.array([0.5]))[..., 0]
    expected = np.zeros((8, 8))
    expected[:3, :3] = 0.5 * np.arange(1.0, 10.0).reshape(3, 3)
    expected[3:6, 3:6] = np.arange(1.0, 10.0).reshape(3, 3) / 96.0
    expected[6, 6] = expected[7, 7] = 3.5
    np.testing.assert_allclose(D, expected, rtol=1e-15)


@pytest.mark.parametrize(
    ("changes", "factor"),
    [({}, 5.0 / 5.7), ({"wall": "linear"}, 5.0 / 6.0), ({"shear_correction": 0.7}, 0.7),
     ({"shear_correction": 0.7, "wall": "linear"}, 0.7)],
)  # fmt: skip
def test_the_shear_of_each_kind_of_wall(changes, factor):
    shell = parts(cf.Plate(length=0.3, width=2.0), **changes)
    D = constitutive(shell, shell.geometry(*POINT), np.zeros((3, 1)))[..., 0]
    assert D[6, 6] == pytest.approx(factor * STEEL.shear_modulus * 0.02, rel=1e-13)
    assert D[7, 7] == pytest.approx(D[6, 6], rel=1e-13)
    assert D[3, 4] == pytest.approx(0.3 * 210e9 / 0.91 * 0.02**3 / 12.0, rel=1e-12)
    beam = section(shell, shell.geometry(*POINT), 0)
    assert beam.shear[0] == pytest.approx(D[6, 6], rel=1e-13)
    assert (beam.bending[0], beam.mass[0]) == (pytest.approx(210e9 * 0.02**3), pytest.approx(7800.0 * 0.02))


def test_layers_add_up_over_their_depths():
    """int (1, z, z^2) C dz by the bounds of each ply; the modulus twice that of the material doubles all plies."""
    angles = (20.0, None, -70.0)
    plies = tuple(
        cf.shell.Ply(thickness=2.0) if angle is None else cf.shell.Ply(thickness=1.0, angle_deg=angle, lamina=CARBON)
        for angle in angles
    )
    t, faces = 0.8, [-0.4, -0.2, 0.2, 0.4]
    E, nu, k = np.array([420e9]), np.array([0.3]), np.array([0.9])
    own = 420e9 / 0.91 * np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    isotropic = own, 420e9 / 2.6 * np.eye(2)
    layers = [isotropic if a is None else [2.0 * part for part in turned(CARBON, a)] for a in angles]
    expected = np.zeros((8, 8))
    for (C, H), low, high in zip(layers, faces[:-1], faces[1:], strict=True):
        one, first, second = ((high**p - low**p) / p for p in (1, 2, 3))
        expected[:3, :3] += one * C
        expected[:3, 3:6] += first * C
        expected[3:6, :3] += first * C
        expected[3:6, 3:6] += second * C
        expected[6:, 6:] += 0.9 * one * H
    found = layered_wall(plies, STEEL, E, nu, np.array([t]), k)[..., 0]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14 * expected.max())
    mass = layered_inertia(plies, STEEL, np.array([3900.0]), np.array([t]))[:, 0]  # half the material's density
    np.testing.assert_allclose(mass[0], 0.4 * 800.0 + 0.4 * 3900.0, rtol=1e-13)
    assert mass[1] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(mass[2], 2.0 * 800.0 * (0.4**3 - 0.2**3) / 3.0 + 2.0 * 3900.0 * 0.2**3 / 3.0, rtol=1e-13)


def test_a_lamina_turns_as_a_tensor_in_every_entry():
    c, s = np.cos(np.radians(25.0)), np.sin(np.radians(25.0))
    Q = np.array([[c, s], [-s, c]])
    C, G = turned(CARBON, 25.0)
    own = CARBON.stiffness

    def along(e):
        m = Q @ tensor(e) @ Q.T
        return np.array([m[0, 0], m[1, 1], 2.0 * m[0, 1]])

    exact = np.array([[along(u) @ own @ along(v) for u in np.eye(3)] for v in np.eye(3)])
    np.testing.assert_allclose(C, exact, rtol=1e-12)
    np.testing.assert_allclose(G, Q.T @ np.diag([4e9, 3e9]) @ Q, rtol=1e-12)
    across, shear = turned(CARBON, 90.0)
    assert (across[0, 2], across[1, 2], shear[0, 1]) == (0.0, 0.0, 0.0)
    divisor = 1.0 - 0.09 * 10.0 / 140.0
    np.testing.assert_allclose(
        own, np.array([[140e9, 3e9, 0], [3e9, 10e9, 0], [0, 0, 5e9 * divisor]]) / divisor, rtol=1e-14
    )


@pytest.mark.parametrize(
    ("changes", "refused"),
    [
        ({"rho": 1e-25}, False), ({"rho": 0.99e-25}, True), ({"E1": 1e25}, False), ({"E1": 1.01e25}, True),
        ({"nu12": np.sqrt(14.0) - 1e-6}, False), ({"nu12": np.sqrt(14.0) + 1e-6}, True),
        ({"E1": 4.0, "E2": 1.0, "nu12": 2.0}, True), ({"E1": 4.0, "E2": 1.0, "nu12": -2.0}, True),
    ],
)  # fmt: skip
def test_laminae_at_their_bounds(changes, refused):
    given = {name: getattr(CARBON, name) for name in ("E1", "E2", "nu12", "G12", "G13", "G23", "rho")} | changes
    if refused:
        with pytest.raises(ValueError, match=r"between 1e-25 and 1e25|must be below E1/E2"):
            cf.shell.Lamina(**given)
    else:
        cf.shell.Lamina(**given)


def test_walls_that_appear_the_same_in_a_mirror():
    def of(*angles):
        return mirrored(tuple(cf.shell.Ply(thickness=1.0, angle_deg=angle, lamina=CARBON) for angle in angles))

    assert of(0.0, 90.0)
    assert of(0.0, 180.0)
    assert not of(30.0, -30.0)  # balanced, but stretch couples with twist
    assert not of(30.0)
    assert mirrored((cf.shell.Ply(thickness=1.0, angle_deg=33.0), cf.shell.Ply(thickness=2.0)))


def test_a_layered_wall_as_a_beam_bends_with_all_else_free():
    """A cross-ply: along its length both curvatures and stretches but its own are free."""
    plies = (
        cf.shell.Ply(thickness=1.0, angle_deg=0.0, lamina=CARBON),
        cf.shell.Ply(thickness=2.0, angle_deg=90.0, lamina=CARBON),
    )
    shell = parts(cf.Plate(length=0.3, width=2.0), wall="linear", plies=plies)
    D = layered_wall(plies, STEEL, *(np.array([x]) for x in (210e9, 0.3, 0.02, 5.0 / 6.0)))[..., 0]
    for way in (0, 1):
        beam = section(shell, shell.geometry(*POINT), way)
        assert beam.bending[0] == pytest.approx(12.0 / np.linalg.inv(D)[3 + way, 3 + way], rel=1e-10)
        assert beam.shear[0] == pytest.approx(D[6 + way, 6 + way], rel=1e-12)
        assert beam.mass[0] == pytest.approx(1600.0 * 0.02, rel=1e-14)


@pytest.mark.parametrize(
    ("chart", "H", "K"),
    [
        (cf.Plate(length=0.3, width=2.0), 0.0, 0.0),
        (cf.Cylinder(radius=0.5, height=0.3), 1.0, 0.0),  # the normal points in
        (cf.Revolved(profile=cf.geometry.Arc(radius=0.25, start=0.0, end=1.0)), 4.0, 16.0),
        (
            cf.geometry.TwistedPlate(length=0.3, width=2.0, twist=0.6),
            0.0,
            -4.0 / 1.64**2,
        ),  # -k^2/(1 + (k y)^2)^2, k y = 0.8
    ],
)
def test_curvatures_and_inertia(chart, H, K):
    """rho (t + K t^3/12), -rho H t^3/6 and rho (t^3/12 + K t^5/80) of a curved wall."""
    shell, t = parts(chart), 0.02
    geometry = shell.geometry(*POINT)
    found = [float(each[0]) for each in mean_and_gauss(geometry.surface)]
    assert found == pytest.approx([H, K], rel=1e-12, abs=1e-13)
    mass = inertia(shell, geometry)[:, 0]
    expected = 7800.0 * np.array([t + K * t**3 / 12, -H * t**3 / 6, t**3 / 12 + K * t**5 / 80])
    np.testing.assert_allclose(mass, expected, rtol=1e-12, atol=1e-16)
    flat = inertia(parts(chart, wall="linear"), geometry)[:, 0]
    np.testing.assert_allclose(flat, [7800.0 * t, 0.0, 7800.0 * t**3 / 12], rtol=1e-15)


def test_layers_follow_the_way_that_the_normal_appears():
    """From the inside of a casing out: a normal a1 x a2 that points in counts them the other way."""
    plies = (cf.shell.Ply(thickness=1.0), cf.shell.Ply(thickness=2.0))
    assert parts(plies=plies).layers == plies[::-1]
    tube = cf.Cylinder(radius=0.5, height=0.3)

    def downwards(a, b, defect):
        surface = tube.surface(0.3 - a, b, defect)
        return surface._replace(x1=-surface.x1)

    turned_over = SimpleNamespace(bounds=tube.bounds, surface=downwards, directions=tube.directions)
    assert parts(turned_over, plies=plies).layers == plies
    assert parts(cf.Plate(length=0.3, width=0.1), plies=plies).layers == plies


def test_the_thinnest_wall_counts_strips_and_taper():
    strips = (cf.Strip(start=0.0, end=0.1, thickness=5e-3), cf.Strip(start=0.2, end=0.3, thickness=0.05))
    assert parts(strips=strips).thinnest == 5e-3
    assert parts(strips=strips[1:]).thinnest == 0.02
    taper = cf.Taper(along=(1.0, 0.5), across=(1.0, 0.8))
    assert parts(strips=strips, taper=taper).thinnest == pytest.approx(2e-3, rel=1e-14)


def test_a_shell_is_sampled_in_every_row_of_its_mesh():
    """Rows from 0 to 0.1 and on to 0.3: five places in each, the strip's end on its own side in both."""
    strip = cf.Strip(start=0.0, end=0.1, thickness=5e-3)
    mesh = cf.ShellMesh(order=2, rows=(0.0, 1.0 / 3.0, 1.0), around=3)
    at = sampled_geometry(parts(cf.Plate(length=0.3, width=2.0), strips=(strip,), mesh=mesh), 3)
    np.testing.assert_allclose(
        at.surface.x[0, :, :, 0], [[0.0, 0.025, 0.05, 0.075, 0.1], [0.1, 0.15, 0.2, 0.25, 0.3]], atol=1e-15
    )
    np.testing.assert_allclose(at.surface.x[1, 0, 0], [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(at.thickness, np.repeat([5e-3, 0.02], 15).reshape(2, 5, 3))
