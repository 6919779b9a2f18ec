"""Numbers held: modes of drawn tests with set-ups that miss modes, close pairs on circles, and responses alone.

That identified modes are true within their intervals, the other tests of this folder state.
"""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.experiment.identify.held_modes import numbers_of_modes
from tests.casingfem.experiment.identify.test_completeness import receptances
from tests.casingfem.experiment.identify.test_output_only import ANGLES, FREQ, driven, records

pytestmark = pytest.mark.slow


def drawn_set_ups(seed):
    """Sensors in two to four set-ups with shifted poles; some modes are seen in some set-ups only, some are close.

    From seed 5 on there are two references.
    """
    rng = np.random.default_rng(seed)
    setups, modes = int(rng.integers(2, 5)), int(rng.integers(4, 7))
    part = np.arange(4 * setups) % setups
    gaps = np.where(rng.random(modes) < 0.3, rng.uniform(0.004, 0.012, modes), rng.uniform(0.03, 0.08, modes))
    freqs, zeta = 120.0 * np.cumprod(1.0 + gaps), rng.uniform(1.5e-3, 4e-3, modes)
    shapes = rng.uniform(0.3, 1.0, (len(part), modes)) * rng.choice([-1.0, 1.0], (len(part), modes))
    absent = rng.random((setups, modes)) < 0.2
    shift = rng.uniform(0.3, 2.0) * 2.0 * zeta * rng.uniform(0.7, 1.3, (setups, modes)) * np.arange(setups)[:, None]
    poles = [
        (freqs[k] * (1.0 - shift[s, k]), zeta[k], shapes[:, k] * ((part == s) & ~absent[s, k]))
        for k in range(modes) for s in range(setups)
    ]  # fmt: skip
    lines, noise, places = np.arange(0.94 * freqs[0], 1.06 * freqs[-1], 0.12), rng.uniform(0.05, 0.6), {}
    if seed > 4:
        drives = rng.uniform(0.3, 1.0, (modes, 2)) * rng.choice([-1.0, 1.0], (modes, 2))
        poles = [(f, z, np.kron(shape, drives[k // setups])) for k, (f, z, shape) in enumerate(poles)]
        places = {
            "response_point": np.repeat(np.arange(len(part)), 2),
            "reference_point": np.tile([101, 102], len(part)),
        }
    return receptances(lines, poles, noise=noise, seed=seed, **places), {}


def drawn_circle(seed):
    """Pairs 0.3 to 4 bandwidths apart on uneven sensors, with some of another wave; labels to n = 6 from seed 7."""
    rng = np.random.default_rng(seed)
    theta = np.sort(rng.uniform(0.0, 2.0 * np.pi, int(rng.integers(13, 21))))
    orders = rng.permutation([2, 3, 4, 5, 6])[: int(rng.integers(2, 5))]
    poles, freq = [], 200.0
    for n in orders.tolist():
        freq, zeta, place = freq * rng.uniform(1.004, 1.05), rng.uniform(1e-3, 4e-3), rng.uniform(0.0, np.pi)
        split = rng.uniform(0.3, 4.0) * 2.0 * zeta
        for k, side in enumerate((-0.5, 0.5)):
            shape = np.cos(n * (theta - place) - k * np.pi / 2) + 0.03 * np.cos((n + 1) * theta - k)
            poles.append((freq * (1.0 + side * split), zeta, shape * rng.uniform(0.3, 1.0)))
    lines = np.arange(194.0, 1.04 * freq, 0.1)
    frfs = receptances(lines, poles, noise=rng.uniform(0.02, 2.0), seed=seed)
    return frfs, {"angles": dict(enumerate(np.degrees(theta)))} | ({"n_max": 6} if seed > 6 else {})


def drawn_loads(seed):
    """Accelerations under white forces: pairs at other distances, another noise, a tone."""
    rng = np.random.default_rng(seed)
    freqs = FREQ + np.array([0.0, rng.uniform(-1.0, 2.0), 0.0, rng.uniform(-0.3, 1.0), 0.0])
    y = driven(seed, 60.0, tone=rng.choice([0.0, 0.3]), noise=rng.uniform(0.02, 0.2), freqs=freqs)
    return records(y), {"angles": ANGLES, "band": (100.0, 230.0)}


DRAWN = {
    "set-ups": (drawn_set_ups, range(1, 8)),
    "circle": (drawn_circle, range(1, 9)),
    "loads": (drawn_loads, range(1, 4)),
}


@pytest.mark.parametrize(("kind", "seed"), [(kind, seed) for kind, (_, seeds) in DRAWN.items() for seed in seeds])
def test_numbers_of_a_drawn_test(kind, seed, held):
    frfs, more = DRAWN[kind][0](seed)
    found = cf.identify(frfs, **more)
    assert len(found)
    held(1e-4, **numbers_of_modes(found))
