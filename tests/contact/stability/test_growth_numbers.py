"""Numbers held: poles of closed contact, peaks over speed, Floquet growth and periodic motions."""

import numpy as np
import pytest

import contact as ct
from tests.contact.cycles.bodies import random_body
from tests.contact.stability.rates import floquet_growth, growth
from tests.contact.synthetic_rim import blade, ring
from tests.probed import numbers_of_result, probed

B6 = ct.gaps.HandPair(
    casing=ct.gaps.ModalPair(n=8, freq_hz=300.0, modal_mass=1.5, zeta=1e-3),
    blade=ct.gaps.ModalPair(freq_hz=120.0, modal_mass=0.4, zeta=2e-3),
    compliance=1e-4,
)
SPEEDS = np.linspace(2.0, 60.0, 30)


def rim(**more):
    return ct.RotatingRim(ring(), blade(), **({"clearance": -1e-5, "speed_hz": 5.0, "lean_deg": 10.0} | more))


def two_blades():
    tips = [ct.ContactPoint(blade=k, angle_deg=180.0 * k, lean_deg=10.0) for k in range(2)]
    return ct.Rub(ring(), (blade(), blade(psi=0.8)), tips, clearance=-1e-5)


@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_numbers_of_closed_contact(mu, held):
    of_rim = ct.gaps.rim_contact(rim(), mu=mu)
    every = np.stack([np.sort_complex(p) for p in ct.stability.poles(of_rim, np.array([5.0, 40.0]))])
    mean = ct.stability.perfect_mean(ring(imperfect=0.05))
    held(
        rim=growth(of_rim, SPEEDS),
        size=np.abs(every),
        mean=mean.omega,
        zeta=mean.zeta,
        squares=np.sum(mean.rows**2, axis=0),
        S=probed(mean.S),
    )


WHAT = {"pair": lambda: B6, "rim": lambda: rim(out_of_roundness=[{"p": 2, "cos": 5e-5}]), "rub": two_blades}


@pytest.mark.parametrize("name", WHAT)
def test_numbers_of_peaks(name, held):
    found = ct.stability.peaks(WHAT[name](), SPEEDS, **({} if name == "pair" else {"mu": 0.3}))
    numbers = ("speed_hz", "growth", "from_hz", "to_hz", "n", "casing_share", "freq_hz")
    held(
        1e-5,
        **{what: [getattr(row, what) for row in found.rows] for what in numbers},
        map=found.map.growth,
        peak=[found.map.peak_speed_hz, found.map.peak_growth],
        bands=found.map.bands_hz,
        blades=found.blade_hz,
        **numbers_of_result(found),
    )


def test_numbers_of_split_casings(held):
    split = ct.RotatingRim(ring(imperfect=0.03), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=10.0)
    held(1e-7, growth=[floquet_growth(split, hz) for hz in (31.0, 45.0)])


@pytest.mark.parametrize("kind", ["hard", "soft", "yielding"])
@pytest.mark.slow
def test_numbers_of_periodic_motions(kind, held):
    more = {"hard": {"restitution": 0.3}, "soft": {"stiffness": 30.0}, "yielding": {"compliance": 0.05}}[kind]
    family = random_body(3, 2, **more).over("freq_hz", freq_hz=0.2)
    found = ct.cycles.orbit(family, 0.2, settle=30)
    held(
        1e-3 if kind == "hard" else 1e-5,  # after impacts without a spring the last bits come back magnified
        period=[found.period, found.periods, found.start],
        x=found.x,
        sizes=np.sort(np.abs(found.multipliers)),
        force=found.force,
        amplitude=list(found.amplitude.values()),
        counts=[*found.closings, *found.rests, *found.touching],
    )
