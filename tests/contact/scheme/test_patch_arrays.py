"""A patch at its start: rows, compliance and limits against written-out formulas."""

import math

import numpy as np
import pytest

import contact as ct
from contact.scheme.modal.patch_stepper import _reach, _roots
from contact.scheme.modal.propagator import propagator

H = 0.02


def patch(*, S=0.0, friction=True, **more):
    body = ct.ModalBody(
        omega=[5.0, 9.0, 0.0], zeta=[0.02, 0.01, 0.0], channels=("n1", "s1", "n2", "s2"),
        rows=np.arange(1.0, 13.0).reshape(4, 3) - 6.5, S=S * (np.eye(4) + 0.25),
    )  # fmt: skip
    tangent = {"tangent": (("s1",), ("s2",)), "slide": [[0.3], [-0.2]]} if friction else {}
    given = {"clearance": [3.0, 4.0], "displacement": [0.1, 0.2, -0.3], "velocity": [0.4, -0.5, 0.6]}
    return ct.Patch(
        body=body, normal=("n1", "n2"), load=[2.0, 3.0, -4.0], pressed=[-0.5, 0.25], **tangent, **given | more
    )


@pytest.mark.parametrize("S", [0.0, 0.3])
@pytest.mark.parametrize("mu", [0.0, 0.4])
def test_a_patch_starts_with_its_rows_compliance_and_motion(mu, S):
    problem = patch(S=S)
    run = ct.ExactModal().prepare(problem, ct.Coulomb(mu=mu) if mu else ct.Unilateral(), dt=H, courant=None)
    s, steady, dim, rows = run.state, run.steady, 2 if mu else 1, np.arange(1.0, 13.0).reshape(4, 3) - 6.5
    C = S * (np.eye(4) + 0.25)
    p = propagator(np.array([5.0, 9.0, 0.0]), np.array([0.02, 0.01, 0.0]), np.array([2.0, 3.0, -4.0]), H)
    chosen = slice(None) if mu else slice(None, None, 2)
    W = (rows * p.c @ rows.T + C)[chosen, chosen]
    assert steady.rows[:, :3].tolist() == rows[chosen].tolist()
    assert run.work.normal[0, :, :3].tolist() == rows[::2].tolist()
    assert run.rows.still.tolist() == C[chosen, chosen].tolist()
    assert run.stiffest == pytest.approx((np.diag(rows * p.c @ rows.T) + np.diag(C))[::2].max(), rel=1e-13)
    if mu:
        np.testing.assert_allclose(run.rows.W, W, rtol=1e-13)
        assert steady.roots.size == 0
    else:
        np.testing.assert_allclose(steady.roots @ steady.roots.T, W, rtol=1e-11)
        assert steady.roots.shape[1] <= (2 if S else 3)
        assert run.rows.W.size == 0
    q, d = np.array([0.1, 0.2, -0.3]), p.backward(np.array([0.1, 0.2, -0.3]), np.array([0.4, -0.5, 0.6]))
    np.testing.assert_allclose(s.d, d, rtol=1e-13)
    np.testing.assert_allclose(s.now, [2.5, 4.25] + rows[::2] @ q, rtol=1e-13)
    np.testing.assert_allclose(s.last, [2.5, 4.25] + rows[::2] @ (q - d), rtol=1e-13)
    np.testing.assert_allclose(run.rows.glide, [0.0, -0.3 * H, 0.0, 0.2 * H] if mu else [0.0, 0.0], rtol=1e-13)
    np.testing.assert_allclose(s.weight, (1.0 - p.al) / (2.0 * p.c), rtol=1e-12)
    np.testing.assert_allclose(s.kick, p.c * [2.0, 3.0, -4.0], rtol=1e-13)
    s.lam[:] = np.arange(2.0, 2.0 + s.lam.size)
    s.contact[:] = rows[chosen].T @ s.lam
    assert run.dimensions == dim
    found = run.stored()
    assert found.residual == pytest.approx(0.5 * s.lam @ C[chosen, chosen] @ s.lam, rel=1e-13)
    assert found.kinetic == pytest.approx(p.stored(q, d, rows[chosen].T @ s.lam, 0.0, 0.0).kinetic, rel=1e-12)
    assert (run.size, run.blocks, run.limits[0]) == (3, (("body 1", 0, 3),), math.inf)


def test_roots_of_fewer_contacts_than_modes_have_as_many_columns_as_contacts():
    rows, c = np.arange(1.0, 9.0).reshape(2, 4) ** 1.5, np.array([0.1, 0.2, 0.3, 0.4])
    few = _roots(rows * np.sqrt(c), np.zeros((0, 0)))
    assert few.shape == (2, 2)
    np.testing.assert_allclose(few @ few.T, rows * c @ rows.T, rtol=1e-12)
    np.testing.assert_allclose(
        _roots(rows[:, :2] * np.sqrt(c[:2]), np.zeros((0, 0))), rows[:, :2] * np.sqrt(c[:2]), rtol=1e-14
    )


def test_how_far_a_gap_could_move_counts_start_load_and_a_million_steps_of_rigid_modes():
    problem = patch(friction=False)
    parts = propagator(np.array([5.0, 9.0, 0.0]), np.zeros(3), np.zeros(3), H)
    time = 1e6 * H
    moved = [0.1 + 0.4 / 5.0 + 4.0 / 25.0, 0.2 + 0.5 / 9.0 + 6.0 / 81.0, 0.3 + 0.6 * time + 2.0 * time**2]
    normal = np.abs(problem.body.rows[::2])
    assert _reach(problem, normal, parts) == pytest.approx((normal @ moved + [2.5, 4.25]).max(), rel=1e-13)
    run = ct.ExactModal().prepare(problem, ct.Unilateral(), dt=H, courant=None)
    np.testing.assert_allclose(run.limits[1:], [1e6 * (normal @ moved + [2.5, 4.25]).max(), 0.0, 0.0], rtol=1e-13)
    still = ct.Patch(body=problem.body, normal=("n1",))
    assert _reach(still, normal[:1], parts) == math.inf


def test_a_patch_refuses_laws_it_has_not():
    for law in ("averaged", "energy"):
        with pytest.raises(ct.InputError, match=f"found '{law}' with several contacts"):
            ct.ExactModal(law=law).prepare(patch(), ct.Unilateral(), dt=H, courant=None)
    with pytest.raises(ct.InputError, match="on a Patch without tangent"):
        ct.ExactModal().prepare(patch(friction=False), ct.Coulomb(mu=0.1), dt=H, courant=None)
    coat = {"E": 1.0, "yield_stress": 1.0, "hardening": 0.0, "thickness": 1.0, "width": 1.0, "tip": 1.0}
    with pytest.raises(ct.InputError, match="Abradable on Patch"):
        ct.ExactModal().prepare(patch(), ct.Abradable(**coat), dt=H, courant=None)
