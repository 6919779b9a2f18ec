"""Synchronous rub, its growth, and dry whirl over speed, against equations of their own; the command `stability`."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import contact as ct
from casingfem.cli import main
from tests.probed import finite, numbers_of_document, numbers_of_notes, numbers_of_result

R = ct.rotor
SCENES = Path(__file__).parents[3] / "data" / "scenes"
M, K, ZETA, CLEARANCE, RADIUS, MOMENT = 10.0, 4e6, 0.015, 5e-4, 0.25, 2.5e-2
CASING = {"radius": RADIUS, "mass": 20.0, "stiffness": 2e7, "zeta": 0.1}
SPRING = 1e8


def stiffness(w):
    """Dynamic stiffness of disk and casing at a whirl w [rad/s]."""
    pairs = ((M, K, ZETA), (CASING["mass"], CASING["stiffness"], CASING["zeta"]))
    return tuple(k - m * w**2 + 2j * zeta * np.sqrt(k * m) * w for m, k, zeta in pairs)


def rub(*, give=0.0, **more):
    rotor = R.Rotor.of(R.Jeffcott(mass=M, stiffness=K, zeta=ZETA, **more), 70.0, unbalance=R.Unbalance(moment=MOMENT))
    tip = replace(R.rigid_tip(), S=np.diag([give, 0.0]))
    return R.rotor_rub(rotor, R.rigid_casing(**CASING), [tip], clearance=CLEARANCE)


def annular(W, mu):
    """Force and angle of a ring that rubs: r Z_r = U W^2 - f, s Z_c = f, f = F (1 + i mu) e^(i a)."""
    of_rotor, of_casing = stiffness(W)

    def left(unknown):
        force, a = 1e3 * unknown[0], unknown[1]
        f = force * (1.0 + 1j * mu) * np.exp(1j * a)
        apart = ((MOMENT * W**2 - f) / of_rotor - f / of_casing) * np.exp(-1j * a)
        return [1e4 * (apart.real - CLEARANCE - force / SPRING), 1e4 * apart.imag]

    starts = [[guess, angle] for guess in (5.0, 20.0) for angle in np.linspace(-3.0, 3.0, 13)]
    found = [fsolve(left, start, full_output=True, xtol=1e-12)[0] for start in starts]
    force, a = max((one for one in found if np.abs(left(one)).max() < 1e-9), key=lambda one: one[0])
    return 1e3 * force, a


@pytest.mark.parametrize("hz", [70.0, 90.0, 110.0])
def test_synchronous_rub_of_a_ring_has_the_force_and_orbit_of_the_algebraic_solution(hz, held):
    mu, W = 0.1, 2.0 * np.pi * hz
    found = ct.stability.rotor_stability(rub(give=1.0 / SPRING), [hz, hz + 1.0], mu=mu)
    force, a = annular(W, mu)
    orbit = abs(MOMENT * W**2 - force * (1.0 + 1j * mu) * np.exp(1j * a)) / abs(stiffness(W)[0])
    assert found.rub_force[0] == pytest.approx(force, rel=1e-6)
    assert found.rub_orbit[0] == pytest.approx(orbit, rel=1e-6)
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))


@pytest.mark.slow
@pytest.mark.parametrize(("hz", "mu"), [(90.0, 0.1), (110.0, 0.1)])
def test_growth_of_a_synchronous_rub_is_that_of_an_integration(hz, mu):
    """The ring's contact in the frame of the rotor: k (|r - s| - c) along r - s, mu times that across."""
    W, c_r, c_c = 2.0 * np.pi * hz, 2.0 * ZETA * np.sqrt(K * M), 0.2 * np.sqrt(2e7 * 20.0)
    expected = float(ct.stability.rotor_stability(rub(give=1.0 / SPRING), [hz, hz + 1.0], mu=mu).rub_growth[0])
    force, a = annular(W, mu)
    f = force * (1.0 + 1j * mu) * np.exp(1j * a)
    r, s = (MOMENT * W**2 - f) / stiffness(W)[0], f / stiffness(W)[1]

    def slopes(_, x):
        r, u, s, v = x
        apart = r - s
        push = SPRING * max(abs(apart) - CLEARANCE, 0.0) * (1.0 + 1j * mu) * apart / abs(apart)
        free = (MOMENT * W**2 - push - c_r * (u + 1j * W * r) - K * r) / M
        ring = (push - c_c * (v + 1j * W * s) - 2e7 * s) / 20.0
        return [u, free - 2j * W * u + W**2 * r, v, ring - 2j * W * v + W**2 * s]

    start = np.array([r * (1.0 + 1e-6), 0.0, s, 0.0], dtype=complex)
    end = 5.0 / abs(expected)
    t = np.linspace(0.0, end, 8_001)
    run = solve_ivp(slopes, (0.0, end), start, method="DOP853", rtol=1e-10, atol=1e-16, t_eval=t)
    tops = np.abs(run.y[0] - r)[4_000:8_000].reshape(10, -1).max(axis=1)
    rate = np.polyfit(0.05 * end * np.arange(10), np.log(tops), 1)[0]
    assert rate == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("mu", [0.2, 0.4])
def test_dry_whirl_begins_at_the_lower_speed_of_black(mu, held):
    """Rolling at w = R W/c needs mu >= |Im B / Re B|, Re B < 0, B = 1/Z_r + 1/Z_c (Black 1968)."""

    def ratio(w):
        B = sum(1.0 / one for one in stiffness(-w))
        return -B.imag / B.real - mu if B.real < 0.0 else np.inf

    grid = np.linspace(1.0, 3000.0, 30_000)
    inside = np.array([ratio(w) <= 0.0 for w in grid])
    k = int(np.flatnonzero(inside)[0])
    low = brentq(ratio, grid[k - 1], grid[k], xtol=1e-12) if np.isfinite(ratio(grid[k - 1])) else grid[k]
    found = ct.stability.rotor_stability(rub(), [0.05, 1.0, 90.0], mu=mu)
    assert found.dry_from_hz == pytest.approx(low * CLEARANCE / RADIUS / (2.0 * np.pi), rel=1e-6)
    assert found.dry[0] == ""
    assert found.dry[2] == "slipping"
    assert CLEARANCE * 2.0 * np.pi * found.dry_hz[2] < RADIUS * 2.0 * np.pi * 90.0  # the rim moves faster
    assert abs(ratio(2.0 * np.pi * found.dry_hz[2])) < 1e-3
    held(1e-4, **numbers_of_result(found), words=numbers_of_notes(found.words))


def test_dry_whirl_is_impossible_below_the_least_friction():
    least = ct.stability.rotor_stability(rub(), [10.0, 20.0], mu=0.0).least_friction
    for factor, possible in ((0.99, False), (1.02, True)):
        found = ct.stability.rotor_stability(rub(), [10.0, 20.0], mu=factor * least)
        assert np.isfinite(found.dry_from_hz) == possible
    assert "Dry backward whirl is possible from" in found.words


def test_a_rub_of_a_shaft_has_the_growth_of_its_modes_and_one_on_unequal_bearings_leaves_it_to_runs():
    for kyy, known in ((2e7, True), (3e7, False)):
        bearings = [R.Bearing(at=at, kxx=2e7, kyy=kyy, cxx=2e3) for at in (0.0, 0.6)]
        disk = R.Disk(at=0.4, mass=20.0, polar=0.4, diametral=0.22)
        shaft = R.Shaft(pieces=[R.Piece(length=0.6, diameter=0.06, elements=4)], disks=[disk], bearings=bearings)
        rotor = R.Rotor.of(shaft, 100.0, unbalance=R.Unbalance(moment=3e-2), modes=8)
        one = R.rotor_rub(rotor, R.rigid_casing(**CASING), [R.rigid_tip()], clearance=CLEARANCE)
        found = ct.stability.rotor_stability(one, [80.0, 100.0], mu=0.1)
        assert np.isfinite(found.rub_force).all()
        assert np.isfinite(found.rub_growth).all() == known
        assert ("not isotropic" in found.words) == (not known)


@pytest.mark.slow
def test_the_command_lists_growth_rub_and_dry_whirl_over_speed(tmp_path, held):
    answer = CliRunner().invoke(
        main, ["stability", str(SCENES / "blade_off" / "rigid.toml"), "--json", "--out", str(tmp_path)]
    )
    assert answer.exit_code == 0, answer.output
    found = json.loads(answer.stdout)
    assert {"speed_hz", "growth_1_s", "rub_force_n", "rub_growth_1_s", "dry_hz"} <= set(found["rows"][0])
    assert found["rows"][0]["rub_force_n"] is None
    assert found["friction"] == 0.1
    assert found["dry_whirl"]["from_hz"] is None
    assert 0.1 < found["dry_whirl"]["least_friction"]
    assert {file.name for file in tmp_path.iterdir()} == {"stability.json", "stability.csv", "stability.png"}
    held(1e-4, found=finite(found), words=numbers_of_notes(*(str(x) for x in found.values() if isinstance(x, str))))


def test_the_command_finds_the_threshold_of_internal_damping(tmp_path, held):
    text = (SCENES / "jeffcott.toml").read_text(encoding="utf-8")
    text = text.replace("zeta = 0.02", "zeta = 0.02\nzeta_internal = 0.02")
    file = tmp_path / "rotor.toml"
    file.write_text(text.replace("hz = 80.0", "hz = 80.0\nscan = {from_hz = 150.0, to_hz = 250.0, steps = 11}"))
    answer = CliRunner().invoke(main, ["stability", str(file), "--json"])
    assert answer.exit_code == 0, answer.output
    found = json.loads(answer.stdout)
    assert found["bands_hz"][0][0] == pytest.approx(2.0 * np.sqrt(4e5) / (2.0 * np.pi), rel=1e-6)
    assert [row["sense"] for row in found["rows"]] == ["forward"] * 11
    assert "The free motion grows from 201.3" in found["words"]
    held(1e-4, found=numbers_of_document(found))
