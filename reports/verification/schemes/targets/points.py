"""Contact targets of many contacts: redundant and degenerate ones, friction that sticks, sixteen in space."""

from __future__ import annotations

import math
import time

import numpy as np

import contact as ct
from casingfem.io.arrays import FloatArray
from contact.record.record import samples
from contact.scheme.modal.patch_stepper import PatchStepper
from contact.solver.friction.coulomb import coulomb
from contact.solver.friction.newton import MOST_ITERATIONS
from contact.solver.unilateral.active_set import unilateral
from reports.tables import Row
from reports.verification.schemes.targets.rods import A_TIME, target

SEED = 20_251


def rows(quick: bool) -> list[Row]:
    """All lines; `quick` draws fewer problems and measures no times."""
    count = 2_000 if quick else 100_000
    return [*_redundant(quick), *_degenerate(count), *_friction(count // 5), *_oscillator(), *_sixteen(quick)]


def residual(A: FloatArray, b: FloatArray, force: FloatArray) -> float:
    """max|min(W_ii force_i, gap_i)| of its scale."""
    own = np.sum(A**2, axis=1) * force
    gap = A @ (A.T @ force) + b
    return float(np.abs(np.minimum(own, gap)).max() / max(np.abs(b).max(), own.max()))


def _redundant(quick: bool) -> list[Row]:
    rng = np.random.default_rng(SEED)
    A = rng.standard_normal((5000, 100))
    b = np.maximum(rng.standard_normal(5000), 0.0) - A @ rng.standard_normal(100)
    unilateral(A[:5], b[:5])  # compiles
    started = time.perf_counter()
    found = unilateral(A, b)
    seconds = time.perf_counter() - started
    head = "5,000 candidates on 100 modes"
    exact = target(f"{head}: residual", 1e-12, residual(A, b, found.force))
    return [exact] if quick else [exact, target(f"{head}: seconds", 0.2, seconds, missed=A_TIME)]


def _problem(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Rows of a Delassus matrix conditioned up to 1e8, half of them repeated half of the time; feasible gaps."""
    contacts, size = int(rng.integers(1, 13)), int(rng.integers(1, 9))
    u, _, v = np.linalg.svd(rng.standard_normal((contacts, size)), full_matrices=False)
    A = u * 10.0 ** (-4.0 * rng.random() * np.linspace(0.0, 1.0, min(contacts, size))) @ v
    if contacts > 2 and rng.random() < 0.5:
        A[contacts // 2 :] = A[: contacts - contacts // 2]
    slack = np.maximum(rng.standard_normal(contacts), 0.0) * (rng.random(contacts) < rng.random())
    return A, slack - A @ rng.standard_normal(size)


def _degenerate(count: int) -> list[Row]:
    rng = np.random.default_rng(SEED + 1)
    failures, worst = 0, 0.0
    for _ in range(count):
        A, b = _problem(rng)
        try:
            worst = max(worst, residual(A, b, unilateral(A, b).force))
        except ct.NumericsError:
            failures += 1
    head = f"{count:,} random and degenerate problems, conditioned to 1e8"
    return [target(f"{head}: failures", 0.0, failures), target(f"{head}: residual", 1e-10, worst)]


def _friction(count: int) -> list[Row]:
    """Random friction problems, mu 0 to 2: well coupled blocks, and blocks coupled so closely that Newton may fail."""
    rng = np.random.default_rng(SEED + 2)
    lines = []
    for name, digits, most in (("conditioned to about 100", 0.0, 0.0), ("conditioned to 1e8", 4.0, 0.02)):
        failures, hard, worst = 0, 0, 0.0
        for _ in range(count):
            contacts, dim = int(rng.integers(1, 7)), int(rng.integers(2, 4))
            size = contacts * dim
            A = np.eye(size) + 0.3 * rng.standard_normal((size, size)) / math.sqrt(size)
            if digits:
                u, _, v = np.linalg.svd(A)
                A = u * 10.0 ** (-digits * rng.random() * np.linspace(0.0, 1.0, size)) @ v
            try:
                found = coulomb(A @ A.T, rng.standard_normal((contacts, dim)), rng.choice([0.0, 0.1, 0.5, 2.0]))
                hard += found.iterations > MOST_ITERATIONS
                worst = max(worst, found.residual)
            except ct.NumericsError:
                failures += 1
        head = f"{count:,} friction problems, mu 0 to 2, {name}"
        lines += [
            target(f"{head}: unsolved", 0.0, failures),
            target(f"{head}: residual", 1e-10, worst),
            target(f"{head}: share that needs more than 50 iterations", most, hard / count),
        ]
    return lines


def _oscillator() -> list[Row]:
    """Unit mass and spring, Coulomb force .1, from x = 1: turning points fall by .2, it stops at 0 after 5 swings."""
    block = ct.ModalBody(omega=[1.0, 0.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
    patch = ct.Patch(body=block, normal=("y",), tangent=(("x",),), load=[0.0, -1.0], displacement=[1.0, 0.0])
    result = ct.run(patch, law=ct.Coulomb(mu=0.1), t_end=30.0, dt=1e-3, record=ct.Record(state_every=1))
    x, t = result.state[:, 0], result.state_time
    moving = float(t[np.abs(x - x[-1]) > 1e-6][-1])
    return [
        target("Coulomb oscillator: rest position", 1e-6, abs(float(x[-1]))),
        target("Coulomb oscillator: time of rest", 1e-3, abs(moving / (5.0 * math.pi) - 1.0)),
        target("Coulomb oscillator: energy dissipated", 1e-6, abs(result.energy.friction + 0.5)),
    ]


def _sixteen(quick: bool) -> list[Row]:
    """Sixteen contacts in three dimensions on 50 modes, pressed down and dragged."""
    rng = np.random.default_rng(31)
    rows = rng.standard_normal((48, 50))
    omega = np.concatenate([np.zeros(6), np.sort(rng.uniform(100.0, 5000.0, 44))])
    names = tuple(f"{direction}{k}" for k in range(16) for direction in "nst")
    body = ct.ModalBody(omega=omega, zeta=np.full(50, 0.002), channels=names, rows=rows, S=np.zeros((48, 48)))
    patch = ct.Patch(
        body=body, normal=names[::3], tangent=tuple(zip(names[1::3], names[2::3], strict=True)), slide=[0.05, 0.02],
        clearance=1e-4 * rng.random(16), load=-5.0 * rows[::3].sum(axis=0),
    )  # fmt: skip
    steps, best = 2_000 if quick else 20_000, math.inf
    for _ in range(1 if quick else 3):
        stepper = ct.ExactModal().prepare(patch, ct.Coulomb(mu=0.3), dt=1e-4, courant=None)
        assert isinstance(stepper, PatchStepper)
        stepper.advance(samples(ct.Record(), 1, 16, 50), 0, 1)
        buffers = samples(ct.Record(every=steps), steps, 16, 50)
        started = time.perf_counter()
        stepper.advance(buffers, 1, steps)
        best = min(best, time.perf_counter() - started)
    head = "16 contacts with friction in three dimensions, 50 modes, solved to 1e-12"
    most = target(f"{head}: most iterations of a step", 50, float(stepper.state.counts[0]))
    if quick:
        return [most]
    return [target(f"{head}: steps/s", 1e4, steps / best, at_least=True, missed=A_TIME), most]
