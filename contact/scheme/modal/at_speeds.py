"""Coefficients of modes over a range of speeds, interpolated between nodes; exact for a single speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from contact.base.arrays import Array, readonly
from contact.base.errors import LimitError
from contact.model.bodies.body_matrices import BodyMatrices
from contact.scheme.modal.coupled import Coupled, Form, coupled, form, top_of
from contact.scheme.modal.propagator import Propagator, propagator, with_coupled

EXACT = 1e-12  # of the largest entry: error of the interpolated coefficients between the nodes
TURN = 1e-5  # [rad]
LONGEST = 256  # steps
NODES = (5, 9, 17, 33)
Matrices = list[tuple[Array, Array]]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class AtSpeeds:
    """Propagators at Chebyshev nodes of a range of speeds [rad/s]; one if the speed is constant or has no effect.

    `stretch` steps use the coefficients at the speed in their middle. `stacked` has the arrays of the coupled modes at
    all nodes by name, (nodes, b, b) each.
    """

    nodes: Array
    parts: tuple[Propagator, ...]
    stretch: int = 1
    stacked: Mapping[str, Array] = field(default_factory=dict)

    @property
    def vary(self) -> bool:
        """Whether the coefficients depend on the speed."""
        return len(self.parts) > 1

    @property
    def top(self) -> float:
        """Highest frequency [rad/s]."""
        return max(part.top for part in self.parts)

    def at(self, omega: float) -> Propagator:
        """Coefficients at a speed within the range."""
        if not self.vary:
            return self.parts[0]
        weights, found = self.weights(omega), self.parts[0].coupled
        assert found is not None
        arrays: dict[str, Any] = {
            name: readonly(np.tensordot(weights, values, axes=1)) for name, values in self.stacked.items()
        }
        return replace(self.parts[0], coupled=replace(found, top=self.top, **arrays))

    def discrete(self, omega: float, q: Array, d: Array) -> float:
        """Discrete energy of the coupled modes at a speed [J], from q and d of all modes."""
        first = self.parts[0].coupled
        assert first is not None
        q, d = q[first.modes], d[first.modes]
        energy = 0.5 * (self.stacked["inertia"] @ d @ d + self.stacked["stiff"] @ q @ (q - d))
        return float(self.weights(omega) @ energy)

    def push(self, omega: float, force: Array) -> Array:
        """Response of a step at a speed to forces on all modes."""
        first = self.parts[0].coupled
        assert first is not None
        found = self.parts[0].c * force
        found[first.modes] = self.weights(omega) @ (self.stacked["c"] @ force[first.modes])
        return np.asarray(found)

    def middle(self, stretch: int) -> float:
        """Middle of a stretch of steps, each of which extends from t - h to t + h [s]."""
        return (stretch * self.stretch + 0.5 * (self.stretch - 1)) * self.parts[0].h

    def weights(self, omega: float) -> Array:
        """Weights of the nodes at a speed: Lagrange polynomials in barycentric form."""
        away = omega - self.nodes
        if (hit := np.flatnonzero(away == 0.0)).size:
            return np.asarray(np.eye(away.size)[hit[0]])
        k = np.arange(away.size)
        shares = (-1.0) ** k * np.where((k == 0) | (k == away.size - 1), 0.5, 1.0) / away
        return np.asarray(shares / shares.sum())


def _stacked(parts: Sequence[Propagator]) -> dict[str, Array]:
    """Arrays of the coupled modes at all nodes, by name."""
    found = [part.coupled for part in parts if part.coupled is not None]
    names = [one.name for one in fields(Coupled) if one.name not in ("h", "modes", "top")]
    return {name: readonly(np.array([getattr(part, name) for part in found])) for name in names}


def chebyshev(low: float, high: float, count: int) -> Array:
    """Chebyshev extreme points of a range, with its ends.

    >>> chebyshev(0.0, 2.0, 3).round(12).tolist()
    [0.0, 1.0, 2.0]
    """
    turns = np.cos(np.pi * np.arange(count) / (count - 1))
    return np.asarray(0.5 * (low + high) - 0.5 * (high - low) * turns)


def highest(matrices: Matrices, found: Form) -> float:
    """Highest frequency [rad/s] at any of the speeds."""
    return max(float(found.omega.max(initial=0.0)), *(top_of(C, K, found.blocks) for C, K in matrices))


def at_speeds(
    bodies: BodyMatrices, omega: Array, zeta: Array, load: Array, low: float, high: float, fastest: float,
    step: Callable[[float], float],
) -> AtSpeeds:  # fmt: skip
    """Coefficients of bodies between two speeds [rad/s]; `step` gives the time step from the highest frequency.

    `fastest` [rad/s^2] is the largest angular acceleration: within a stretch it changes the phase of no mode by more
    than 1e-5 rad. Nodes are added until interpolated coefficients are exact to 1e-12. Raises LimitError if that takes
    too many, since the speed changes the modes too much within one step.
    """
    if not bodies.coupled:
        h = step(float(omega.max(initial=0.0)))
        return AtSpeeds(nodes=np.array([low]), parts=(propagator(omega, zeta, load, h),))

    def made(speeds: Array) -> tuple[Propagator, ...]:
        return tuple(
            with_coupled(found.omega, found.zeta, load, h, coupled(C, K, found.modes, found.blocks, h))
            for C, K in map(bodies.at, speeds.tolist())
        )

    constant = low == high or not bodies.vary
    seen = [bodies.at(speed) for speed in ([high] if constant else chebyshev(low, high, NODES[0]).tolist())]
    found = form(seen, omega, zeta)
    top = highest(seen, found)
    h = step(top)
    if not found.modes.size:
        return AtSpeeds(nodes=np.array([high]), parts=(propagator(found.omega, found.zeta, load, h),))
    if constant:
        part = coupled(*seen[0], found.modes, found.blocks, h, top)
        return AtSpeeds(nodes=np.array([high]), parts=(with_coupled(found.omega, found.zeta, load, h, part),))
    for count in NODES:
        nodes = chebyshev(low, high, count)
        parts, stretch = made(nodes), _stretch(seen, high - low, fastest, h)
        table = AtSpeeds(nodes=nodes, parts=parts, stretch=stretch, stacked=_stacked(parts))
        between = 0.5 * (nodes[:-1] + nodes[1:])
        if max(map(_error, made(between), map(table.at, between.tolist()))) <= EXACT:
            return table
    raise LimitError(
        f"dt: found {h:g} s, in which modes change too much between the speeds {low / (2.0 * math.pi):g} and "
        f"{high / (2.0 * math.pi):g} Hz, expected a smaller dt"
    )


def _stretch(matrices: Matrices, span: float, fastest: float, h: float) -> int:
    """Number of steps that may use C and K of their middle.

    A frequency that changes by r t changes the phase by r t^2/8.
    """
    (C, K), others = matrices[0], matrices[-1]
    stiff = np.sqrt(np.maximum(np.abs(np.diag(K)), 1e-300))
    change = np.abs(others[0] - C).sum(axis=1).max() + (np.abs(others[1] - K).sum(axis=1) / stiff).max()
    seconds = math.sqrt(8.0 * TURN * span / (change * fastest)) if change * fastest > 0.0 else math.inf
    return int(min(max(1.0, seconds / h), LONGEST))


def _error(exact: Propagator, found: Propagator) -> float:
    """Largest error of the coefficients of the modes, relative to the largest entry."""
    if exact.coupled is None or found.coupled is None:
        return 0.0
    names, parts = ("alpha", "beta", "c"), (exact.coupled, found.coupled)
    pairs = [[getattr(part, name) for part in parts] for name in names]
    return max(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in pairs)
