"""Runs where numba is asked not to compile (NUMBA_DISABLE_JIT) are the runs of compiled loops."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import contact as ct
from tests.contact.loop.test_patch_steps import patch
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3, tips

ROOT = Path(__file__).parents[3]


def bumper(depth, rate, values):
    """A spring of power 3/2."""
    return values[0] * depth**1.5, 1.5 * values[0] * depth**0.5


def scenes():
    """A rim, tips with friction, a bumper with a law of one's own, a patch, a rotor that a blade leaves."""
    turning = ct.Speed.constant(20.0)
    rim = ct.RotatingRim(ring(S=4e-7, imperfect=0.1), blade(S=1e-6), clearance=-1e-5, speed_hz=20.0, lean_deg=25.0)
    rub = ct.Rub(rim3(S=2e-7), (nodes(3),), tips(3), clearance=-1e-5, speed=turning)
    R = ct.rotor
    lost = R.Unbalance(moment=1e-4, release=R.Release(time=1e-4, moment=0.5))
    shaft = R.Rotor.of(R.Jeffcott(mass=10.0, stiffness=4e6, zeta=0.1), 70.0, unbalance=lost)
    rotor = R.rotor_rub(
        shaft, R.rigid_casing(radius=0.25, mass=20.0, stiffness=2e7, zeta=0.1), clearance=1e-6,
        blades=[R.rigid_tip()] * 2, tips=[ct.gaps.ContactPoint(blade=j, angle_deg=180.0 * j) for j in range(2)],
    )  # fmt: skip
    rough = ct.Coulomb(mu=0.2)
    return {
        "rim": (rim, rough, 2e-5), "rub": (rub, rough, 2e-5),
        "patch": (patch(ct, soft=True, friction=True), rough, 0.01),
        "law": (rim, ct.laws.ForceLaw(ct.laws.Response(bumper, (1e9,))), 2e-5), "rotor": (rotor, rough, 2e-5),
    }  # fmt: skip


def impulses():
    """Impulse of each contact of each scene [N s]."""
    return {
        name: ct.run(what, law=law, dt=dt, t_end=60 * dt).impulse.tolist() for name, (what, law, dt) in scenes().items()
    }


@pytest.mark.slow
def test_runs_without_the_compiler_have_the_impulses_of_compiled_loops():
    words = "import json\nfrom tests.contact.jit.test_not_compiled import impulses\nprint(json.dumps(impulses()))"
    plain = subprocess.run(
        [sys.executable, "-c", words], cwd=ROOT, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    assert plain.returncode == 0, plain.stderr
    found, compiled = json.loads(plain.stdout), impulses()
    assert {name for name, values in compiled.items() if max(values) > 0.0} == set(scenes())
    for name, values in compiled.items():
        assert found[name] == pytest.approx(values, rel=1e-9), name
