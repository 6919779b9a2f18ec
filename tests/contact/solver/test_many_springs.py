"""Many contacts that each yield by themselves: a bar that rests on springs, and the same answer as the active set."""

import numpy as np
import pytest

import contact as ct


def bar(springs: int, S: np.ndarray | None = None, *, tilt: float = 4e-4) -> ct.Patch:
    """A rigid bar of 2 kg, 2 m long, above this many springs of 1e-9 m/N."""
    x, mass = np.linspace(-1.0, 1.0, springs), 2.0
    inertia = mass * 4.0 / 12.0
    names = tuple(f"c{i}" for i in range(springs))
    body = ct.ModalBody(
        omega=[0.0, 0.0], zeta=[0.0, 0.0], channels=names, S=np.eye(springs) * 1e-9 if S is None else S,
        rows=np.stack([np.full(springs, mass**-0.5), x * inertia**-0.5], 1),
    )  # fmt: skip
    return ct.Patch(
        body=body, normal=names, clearance=0.0, displacement=[1e-3 * mass**0.5, tilt * inertia**0.5],
        load=[-9.81 * mass**0.5, 0.0],
    )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("springs", [3, 300, 400])
def test_a_bar_at_rest_is_borne_by_its_springs(springs: int) -> None:
    result = ct.run(bar(springs), t_end=0.05, dt=1e-4, record=ct.Record(every=50))
    assert result.force[-1].sum() == pytest.approx(19.62, rel=1e-9)
    assert result.force[-1] @ np.linspace(-1.0, 1.0, springs) == pytest.approx(0.0, abs=1e-6)
    assert result.residual.max() < 1e-15


@pytest.mark.parametrize("seed", range(4))
def test_springs_give_the_forces_of_coupled_contacts_whose_coupling_vanishes(seed: int) -> None:
    """A coupling of 1e-9 of S is solved by the active set, which knows nothing of springs."""
    rng = np.random.default_rng(seed)
    count = 12
    alone = np.diag(10.0 ** rng.uniform(-10.0, -8.0, count))
    faint = rng.uniform(-1.0, 1.0, (count, count)) * 1e-19
    results = [ct.run(bar(count, S, tilt=2e-4 * seed), t_end=0.03, dt=1e-4) for S in (alone, alone + faint + faint.T)]
    assert results[0].contact_steps.min() >= 0
    assert np.count_nonzero(results[0].force) > 20
    scale = np.abs(results[1].force).max()
    np.testing.assert_allclose(results[0].force, results[1].force, atol=1e-7 * scale)
    assert results[0].impulse == pytest.approx(results[1].impulse, abs=1e-7 * results[1].impulse.max())
