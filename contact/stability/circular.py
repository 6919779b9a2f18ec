"""A rotor and a casing in circular motion: receptances at the contact, complex coordinates of isotropic bodies.

A force f e^(i w t) in the plane x + i y rotates with the contact point. An isotropic rotor moves on a circle with the
same frequency. For other bodies the circle is the mean over the directions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.rub import Rub
from contact.model.rotor.rotor import Rotor, nodes_of
from contact.model.rotor.rotor_rub import casing_of
from contact.stability.split_casing import perfect_mean

Complex = NDArray[np.complex128]
ROUND = 1e-3  # largest remainder of J J + 1 for a rotor that is the same in all directions
FORWARD = np.array([1.0, -1.0j])  # x and y of a force that turns from x to y


class Seen(NamedTuple):
    """Motion due to a normal force of 1 N and a tangential one of `mu` N, at the rotating contact point [m].

    `whirl` (w,) complex: normal and tangential motion of the wave of one nodal diameter; `local` (w,): normal motion
    of all other waves and of the residual compliance.
    """

    whirl: Complex
    local: Array


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Circular:
    """A body in complex coordinates z of circular motion: z'' + C z' + K z = w f, r = 2 w^H z; (m,), (m, m)."""

    C: Complex
    K: Complex
    w: Complex


def rotor_receptance(rotor: Rotor, whirl: Array, speed: float) -> Complex:
    """Circular motion of the disk per rotating force at `whirl` (w,) and a rotor speed [rad/s], (w,) [m/N].

    >>> from contact.model.rotor.jeffcott import Jeffcott
    >>> rotor = Rotor.of(Jeffcott(mass=2.0, stiffness=800.0), 1.0)
    >>> rotor_receptance(rotor, np.array([0.0, 10.0]), 3.0).real.round(6).tolist()  # 1/(k - m w^2)
    [0.00125, 0.001667]
    """
    C, K = rotor.matrices(speed)
    plane = rotor.plane
    square = K - whirl[:, None, None] ** 2 * np.eye(len(K)) + 1j * whirl[:, None, None] * C
    moved = np.linalg.solve(square, np.broadcast_to((plane.T @ FORWARD)[:, None], (whirl.size, len(K), 1)))[..., 0]
    at = [rotor.body.channel(f"{rotor.at}.{axis}") for axis in "xy"]
    still = 0.5 * float(np.trace(rotor.body.S[np.ix_(at, at)]))
    return np.asarray(0.5 * (moved @ (plane.T @ np.array([1.0, 1.0j]))) + still)


def casing_receptance(casing: ModalBody, line: int, whirl: Array, mu: float) -> Seen:
    """Motion of a casing at a point of one rim line that rotates at `whirl` (w,) [rad/s], averaged over a turn."""
    N, size = casing.n_max, 2 * casing.n_max + 1
    first = line * casing.directions * size
    rows = casing.rows[first : first + 2 * size].reshape(2, size, -1)
    waves = rows[:, : N + 1].astype(complex)
    waves[:, 1:] += 1j * rows[:, N + 1 :]  # a cos n theta + b sin n theta = Re (a + i b) e^(-i n theta)
    S = casing.S[first : first + 2 * size, first : first + 2 * size].reshape(2, size, 2, size)
    C, K = casing.matrices(0.0)
    found = np.zeros((2, whirl.size, N + 1))
    for n in range(N + 1):
        force = waves[0, n] + mu * waves[1, n]
        moved = _answer(C, K, n * whirl, force)
        share = 1.0 if n == 0 else 0.5
        found[:, :, n] = share * np.real(np.conj(waves[:, n]) @ moved.T)
        own = [n] if n == 0 else [n, N + n]
        still = sum(S[:, i, :, i] for i in own) * share
        found[:, :, n] += (still @ np.array([1.0, mu]))[:, None]
    local = found[0].sum(axis=1) - found[0, :, 1]
    return Seen(found[0, :, 1] + 1j * found[1, :, 1], local)


def _answer(C: Array, K: Array, rate: Array, force: Complex) -> Complex:
    """(K - w^2 - i w C)^-1 force for motions e^(-i w t) at each w (n,), (n, m)."""
    if not (np.count_nonzero(C - np.diag(np.diag(C))) or np.count_nonzero(K - np.diag(np.diag(K)))):
        return np.asarray(force / (np.diag(K) - rate[:, None] ** 2 - 1j * rate[:, None] * np.diag(C)))
    one = np.eye(len(K))
    return np.array([np.linalg.solve(K - w * w * one - 1j * w * C, force) for w in rate.tolist()])


def blade_give(rub: Rub, speed: float, mu: float) -> float:
    """Normal motion of the first tip on its blade per contact force, with friction, at a speed [rad/s] [m/N]."""
    tip = rub.tips[0]
    blade, (normal, along) = rub.blades[tip.blade], tip.directions(rub.blades[tip.blade])[:2]
    push = normal + mu * along
    found = float(normal @ blade.S @ push)
    if not blade.omega.size:
        return found
    K = np.diag(blade.omega**2) + (0.0 if blade.stiffness is None else np.asarray(blade.stiffness))
    for stiff in rub.stiffening:
        if stiff.blade == tip.blade:
            K = K + (speed**2 - (2.0 * math.pi * stiff.at_hz) ** 2) * stiff.stiffness_by_speed
    return found + float((normal @ blade.rows) @ np.linalg.solve(K, push @ blade.rows))


def circular_rotor(rotor: Rotor, speed: float) -> Circular | None:
    """The rotor in complex coordinates at a speed [rad/s]; None if it is not isotropic."""
    body = rotor.body
    names = {axis: [f"{node}.{axis}" for node in nodes_of(body)] for axis in ("x", "y", "rx", "ry")}
    kept = [k for k in range(len(names["x"])) if all(names[axis][k] in body.channels for axis in names)]
    ahead = [*names["x"], *(names["rx"][k] for k in kept)]
    aside = [*names["y"], *(names["ry"][k] for k in kept)]
    x, y = (np.array([body.rows[body.channel(name)] for name in part]) for part in (ahead, aside))
    scale = np.linalg.norm(np.hstack([x, y]), axis=1)
    x, y = (part[scale > 0.0] / scale[scale > 0.0, None] for part in (x, y))
    J = np.linalg.lstsq(np.vstack([x, y]), np.vstack([-y, x]), rcond=1e-9)[0]  # x J = -y, y J = x
    J = 0.5 * (J - J.T)
    m = len(J)
    C, K = rotor.matrices(speed)
    turned = [float(np.linalg.norm(J @ A - A @ J)) > ROUND * float(np.linalg.norm(A)) for A in (C, K)]
    if float(np.linalg.norm(J @ J + np.eye(m))) > ROUND * math.sqrt(m) or any(turned):
        return None
    return _complexed(J, C, K, rotor.plane)


def circular_casing(rub: Rub) -> Circular:
    """The waves of one nodal diameter of the perfect casing nearest to that of a rub, in complex coordinates.

    Raises InputError for a casing without a pair of one nodal diameter.
    """
    casing = perfect_mean(casing_of(rub))
    N = casing.n_max
    size, first = 2 * N + 1, rub.tips[0].line * casing.directions * (2 * N + 1)
    radial, along = casing.rows[first : first + size], casing.rows[first + size : first + 2 * size]
    ring = 0.5 * np.array([radial[1] - along[N + 1], radial[N + 1] + along[1]])  # x and y of a ring that does not bend
    cos, sin = (np.flatnonzero(np.abs(row) > 1e-9 * float(np.abs(ring).max(initial=1e-300))) for row in ring)
    if not cos.size or cos.size != sin.size:
        raise InputError("casing: found no pair of modes of one nodal diameter, expected one: keep more modes")
    own = np.concatenate([cos, sin])
    J = np.zeros((own.size, own.size))
    J[cos.size :, : cos.size], J[: cos.size, cos.size :] = np.eye(cos.size), -np.eye(cos.size)
    C, K = casing.matrices(0.0)
    return _complexed(J, C[np.ix_(own, own)], K[np.ix_(own, own)], ring[:, own])


def _complexed(J: Array, C: Array, K: Array, plane: Array) -> Circular:
    """Coordinates z = U^H q that are multiplied by e^(i angle) in a rotation by an angle: J U = i U."""
    values, vectors = np.linalg.eigh(1j * J)  # -1 where J U = i U
    U = vectors[:, values < 0.0]
    return Circular(C=U.conj().T @ C @ U, K=U.conj().T @ K @ U, w=0.5 * (U.conj().T @ (plane[0] - 1j * plane[1])))
