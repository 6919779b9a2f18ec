"""Numbers held: fits to drawn tables with noise, wrong rows, priors and bounds, and what is predicted of each row."""

import numpy as np
import pytest

import casingfem as cf
from tests.casingfem.updating.test_update_judged import BOUNDS, blade
from tests.probed import finite, numbers_of_result


@pytest.fixture(scope="module")
def freq():
    """Frequencies of a blade unlike the start."""
    return cf.modes(blade(200e9, 3.04e-3, 0.31), 10).freq


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 6])
def test_numbers_of_a_drawn_update(seed, freq, held):
    rng = np.random.default_rng(seed)
    rows = int(rng.integers(5, 11))
    wrong = rng.choice(rows, int(rng.integers(0, 3)), replace=False)
    sigma = rng.uniform(5e-4, 3e-3, rows)
    measured = freq[:rows] * (1.0 + rng.uniform(0.3, 2.0) * sigma * rng.standard_normal(rows))
    measured[wrong] *= 1.0 + rng.choice([-1.0, 1.0], wrong.size) * rng.uniform(0.02, 0.06, wrong.size)
    order = np.argsort(measured)
    table = cf.FrequencyTable.from_arrays(freq_hz=measured[order], sigma_hz=(sigma * freq[:rows])[order])
    names = rng.permutation(list(BOUNDS))[: int(rng.integers(1, 4))].tolist()
    vary = []
    for name in names:
        log, known = rng.random() < 0.3, rng.random() < 0.4
        width = float(rng.uniform(0.01, 0.1)) * BOUNDS[name][0]
        low, high = BOUNDS[name]
        vary.append(
            cf.Parameter(name=name, lower=low, upper=high, log=bool(log), sigma=width if known and not log else None)
        )
    fit = cf.update(blade(), table, vary, model_error=float(rng.choice([0.0, 2e-3])), count=12)
    left = cf.updating.leave_one_out(fit)
    held(1e-3, **numbers_of_result(fit), **numbers_of_result(left, "left "), sure=finite(cf.updating.laplace(fit)))
