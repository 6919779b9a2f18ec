"""Compute poles and residues of growing orders from correlations: covariance-driven stochastic subspace identification.

With the block Hankel matrix H of the correlations at steps of lag, H = U S V^H, the observability and controllability
matrices of order n are O = U_n S_n^1/2 and G = S_n^1/2 V_n^H. The system matrix solves O_up A = O_down; its eigenvalues
are exp(p h), and C psi, psi^-1 G contain the shapes and the references' shares (Peeters and De Roeck, Mech. Syst.
Signal Process. 13, 1999, 855). Residues are of rank one by construction, so that shapes distinguish close modes.
Their product does not depend on how a shape is scaled, so that residues of several orders can be compared and averaged.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.lscf import Stabilisation
from casingfem.experiment.identify.output_only.correlations import SKIPPED, Zoomed
from casingfem.experiment.identify.thresholds import Thresholds
from casingfem.io.arrays import Array, BoolArray, FloatArray, IntArray

LEAST_ROWS = 10  # block rows of the Hankel matrix
NEAR = 2.0  # times the limits of a cluster, within which a pole is that of its mode


class Swept(NamedTuple):
    """Poles [rad/s] (poles,), residues (poles, sensors, references) and the order of each."""

    poles: Array
    A: Array
    order: IntArray

    def at(self, kept: BoolArray | IntArray) -> Swept:
        """The poles with these indices."""
        return Swept(self.poles[kept], self.A[kept], self.order[kept])


class Cluster(NamedTuple):
    """Candidate mode: the median pole, the mean residues, and the orders in which it recurs."""

    pole: complex
    A: Array
    orders: IntArray


def swept(zoom: Zoomed, orders: range) -> Swept:
    """Stable poles of each order, with their residues."""
    z = zoom.z
    sensors, references = z.shape[:2]
    rows = max(LEAST_ROWS, -(-2 * orders.stop // references))
    lags = SKIPPED + np.add.outer(np.arange(rows), np.arange(rows))
    H = z[:, :, lags].transpose(2, 0, 3, 1).reshape(rows * sensors, rows * references)
    U, sizes, V = np.linalg.svd(H, full_matrices=False)
    poles, A, order = list[Array](), list[Array](), list[IntArray]()
    for n in orders:
        root = np.sqrt(sizes[:n])
        seen, G = U[:, :n] * root, root[:, None] * V[:n, :references]
        values, vectors = np.linalg.eig(np.linalg.lstsq(seen[:-sensors], seen[sensors:], rcond=None)[0])
        s = np.log(np.where(values == 0.0, 1e-300, values)) / zoom.step
        stable = s.real < 0.0
        shares = np.linalg.solve(vectors, G) / (values**SKIPPED)[:, None]
        imag = np.mod(s.imag, 2.0 * np.pi / zoom.step) + 2.0 * np.pi * zoom.low
        poles.append((s.real + 1j * imag)[stable])
        A.append(np.einsum("sk,kr->ksr", seen[:sensors] @ vectors, shares)[stable])
        order.append(np.full(int(stable.sum()), n))
    return Swept(np.concatenate(poles), np.concatenate(A), np.concatenate(order))


def fits_in(zoom: Zoomed, most: int) -> int:
    """Largest order up to `most` whose Hankel matrix fits into the lags."""
    references = zoom.z.shape[1]
    half = zoom.z.shape[2] // 2  # positive lags
    for largest in range(most, 0, -1):
        rows = max(LEAST_ROWS, -(-2 * (largest + 1) // references))
        if 2 * SKIPPED + 2 * rows - 1 <= half and largest < rows * min(references, zoom.z.shape[0]):
            return largest
    return 0


def alike(found: Swept, pole: complex, A: Array, rules: Thresholds, times: float = 1.0) -> tuple[BoolArray, FloatArray]:
    """Poles that agree with a given pole in frequency, damping and shape, and their modal assurance with it."""
    wide = -2.0 * pole.real
    near = np.abs(found.poles.imag - pole.imag) < times * rules.same_freq * wide
    near &= np.abs(found.poles.real - pole.real) < times * rules.same_zeta * -pole.real
    mac = assurance(found.A, A)
    return near & (mac > 1.0 - times * (1.0 - rules.same_shape)), mac


def assurance(A: Array, B: Array) -> FloatArray:
    """Modal assurance of residues (poles, sensors, references) with others (sensors, references), (poles,)."""
    products = np.abs(np.einsum("ksr,sr->k", A.conj(), B)) ** 2
    sizes = np.sum(np.abs(A) ** 2, axis=(1, 2)) * np.sum(np.abs(B) ** 2)
    return np.asarray(products / (sizes + 1e-300))


def clusters(found: Swept, orders: range, rules: Thresholds) -> tuple[list[Cluster], Stabilisation]:
    """Poles that recur over the orders, ascending, and the diagram of all.

    The pole with the most neighbours in other orders forms a cluster with them. The next cluster is formed from the
    remaining poles.
    """
    zeta = -found.poles.real / np.abs(found.poles)
    free, stable = zeta < rules.zeta_most, np.zeros(len(zeta), bool)
    near = np.array([alike(found, complex(pole), A, rules)[0] for pole, A in zip(found.poles, found.A, strict=True)])
    done = list[Cluster]()
    while free.any():
        counts = [len(np.unique(found.order[row & free])) if ok else 0 for row, ok in zip(near, free, strict=True)]
        best = int(np.argmax(counts))
        if counts[best] < max(2.0, rules.recurs * len(orders)):
            break
        members = near[best] & free
        done.append(_cluster(found.at(members)))
        stable |= members
        free &= ~members
    diagram = Stabilisation(freq=np.abs(found.poles) / (2.0 * np.pi), zeta=zeta, order=found.order, stable=stable)
    return sorted(done, key=lambda cluster: cluster.pole.imag), diagram


def _cluster(members: Swept) -> Cluster:
    pole = complex(np.median(members.poles.real), np.median(members.poles.imag))
    return Cluster(pole, members.A.mean(axis=0), np.unique(members.order))


def again(found: Swept, cluster: Cluster, rules: Thresholds) -> Cluster | None:
    """Find the mode of a cluster in another sweep: the most similar pole of each order; None if there is none."""
    near, mac = alike(found, cluster.pole, cluster.A, rules, NEAR)
    likely = np.where(near, mac, -1.0)
    best = [
        int(at[np.argmax(likely[at])]) for n in np.unique(found.order) if len(at := np.flatnonzero(found.order == n))
    ]
    kept = np.array([k for k in best if near[k]], np.int64)
    return _cluster(found.at(kept)) if len(kept) else None
