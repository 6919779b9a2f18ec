"""Someone's matrices M, K, C as a body: reduced to modes with residual compliance.

    K phi = omega^2 M phi,   S = P^T G P - (P^T Phi) diag(1/omega^2) (P^T Phi)^T

P are the unit forces on the contact channels, G the static compliance K^-1. A free body has the compliance of its
elastic modes alone, by inertia relief: G P = u with K u = P - M R R^T P and R^T M u = 0, R its rigid modes. Massless
dofs are kept by S exactly. Modes come from M x = theta (K + s M) x, theta = 1/(omega^2 + s), in which the lowest ones
are the sharpest, rigid modes and massless dofs do no harm.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.bodies.matrices import Contact, Matrices
from contact.model.bodies.matrix_report import MatrixReport, report_of

MODES = 20  # kept where nothing is said
DENSE = 1500  # unknowns up to which all modes are computed at once
RIGID = 1e-6  # omega^2 over that of the seventh mode below which a mode is rigid
NOTHING = 1e-9  # of the static compliance: below it the residual is round-off


def reduced(
    matrices: Matrices, contact: Contact, *, modes: int | None = None, zeta: float = 0.0
) -> tuple[dict[str, Any], MatrixReport]:
    """Fields of the modal body that matrices are at their contact, and what they are; 20 modes, or all if fewer.

    Raises InputError for indefinite matrices, dofs that are not there, or more modes than there are.
    """
    modes = min(MODES, matrices.size) if modes is None else modes
    if not 1 <= modes <= matrices.size:
        raise InputError(f"modes: found {modes}, expected 1 to the {matrices.size} unknowns")
    channels, P = matrices.loads(contact)
    lam, phi, rigid = lowest_modes(matrices, modes)
    omega = np.sqrt(lam)
    R = phi[:, :rigid]
    G = elastic_compliance(matrices, P, R)
    rows = P.T @ phi
    elastic = rows[:, rigid:] / omega[rigid:]
    total, S = P.T @ G, P.T @ G - elastic @ elastic.T
    S = 0.5 * (S + S.T)
    if np.abs(S).max() <= NOTHING * np.abs(total).max():
        S = np.zeros_like(S)
    damping, coupling = modal_damping(matrices, phi, omega, zeta)
    facts = report_of(matrices, lam, rigid, len(lam), float(np.trace(S) / np.trace(total)), coupling)
    body = dict(
        omega=omega,
        zeta=damping,
        channels=channels,
        rows=rows,
        S=S,
        participation=matrices.rigid_motions()[:, :3].T @ (matrices.M @ phi),
        provenance=json.dumps({"method": "matrices", "modes": len(lam), "matrices": asdict(facts)}, sort_keys=True),
    )
    return body, facts


def lowest_modes(matrices: Matrices, count: int) -> tuple[Array, Array, int]:
    """omega^2 ascending (at most `count`, those of massless dofs left out), mass-normalised modes, rigid ones first."""
    from scipy.linalg import eigh
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    M, K, n = matrices.M, matrices.K, matrices.size
    shift = _shift(matrices)
    if n <= DENSE:
        try:
            theta, X = eigh(M.toarray(), (K + shift * M).toarray())
        except np.linalg.LinAlgError:
            raise InputError(
                "K: found an indefinite or singular stiffness, expected one without negative modes"
            ) from None
        if theta[0] < -1e-9 * theta[-1]:
            raise InputError("M: found negative modal masses, expected a mass matrix without negative eigenvalues")
        theta, X = theta[::-1], X[:, ::-1]
        alive = theta > 1e-15 * theta[0]
        theta, X = theta[alive], X[:, alive]
    else:
        factor = splu(csc_array(K + shift * M))
        inverse = LinearOperator((n, n), matvec=factor.solve)
        start = factor.solve(M @ np.random.default_rng(7).standard_normal(n))
        wanted = min(max(count, 7) + 6, n - 1)
        values, X = eigsh(K, wanted, M=M, sigma=-shift, OPinv=inverse, which="LM", v0=start)
        order = np.argsort(values)
        theta, X = 1.0 / (values[order] + shift), X[:, order]
        if (theta < 0.0).any():
            raise InputError("K: found an indefinite stiffness, expected one without negative modes")
    X = X / np.sqrt(np.einsum("ij,ij->j", X, M @ X))
    lam = 1.0 / theta - shift
    level = float(lam[min(6, len(lam) - 1)])
    if lam[0] < -RIGID * level:
        raise InputError(f"K: found omega^2 = {lam[0]:.3g} rad^2/s^2, expected a stiffness without negative modes")
    rigid = int(np.count_nonzero(lam < RIGID * level))
    lam[:rigid] = 0.0
    kept = min(count, len(lam))
    if kept < rigid:
        raise InputError(f"modes: found {count}, expected at least the {rigid} rigid modes of these matrices")
    return lam[:kept], np.ascontiguousarray(X[:, :kept]), rigid


def _shift(matrices: Matrices) -> float:
    """Shift s [rad^2/s^2], small beside what springs hold: masses that none holds say nothing of the others."""
    masses, springs = matrices.M.diagonal(), matrices.K.diagonal()
    heavy = masses > 0.0
    if not heavy.any():
        raise InputError("M: found no mass on its diagonal")
    rates = springs[heavy] / masses[heavy]
    if not (rates > 0.0).any():
        raise InputError("K: found no stiffness on its diagonal where there is mass")
    return 1e-6 * float(np.median(rates[rates > 0.0]))


def elastic_compliance(matrices: Matrices, P: Array, R: Array) -> Array:
    """Static displacements under unit forces on the channels, (n, channels), of a free body by inertia relief."""
    from scipy.sparse import block_array, csc_array
    from scipy.sparse.linalg import splu

    if not R.shape[1]:
        return np.asarray(splu(csc_array(matrices.K)).solve(P))
    momenta = matrices.M @ R
    scale = float(np.abs(matrices.K.diagonal()).mean() / np.abs(momenta).max())
    border = csc_array(scale * momenta)
    bordered = csc_array(block_array([[matrices.K, border], [border.T, None]]))
    balanced = P - momenta @ (R.T @ P)
    solved = splu(bordered).solve(np.vstack([balanced, np.zeros((R.shape[1], P.shape[1]))]))
    return np.asarray(solved[: matrices.size])


def modal_damping(matrices: Matrices, phi: Array, omega: Array, zeta: float) -> tuple[Array, float | None]:
    """Damping ratios, and the largest coupling between modes that they leave out (None without C)."""
    if matrices.C is None:
        return np.full(len(omega), zeta), None
    c = phi.T @ (matrices.C @ phi)
    own = np.abs(np.diag(c))
    ratio = np.divide(own, 2.0 * omega, out=np.full(len(omega), zeta), where=omega > 0.0)
    if ratio.max(initial=0.0) >= 1.0:
        k = int(ratio.argmax())
        raise InputError(f"C: found a damping ratio of {ratio[k]:.3g} in mode {k + 1}, expected less than 1")
    size = np.sqrt(np.outer(own, own))
    off = np.abs(c - np.diag(np.diag(c)))
    return ratio, float(np.divide(off, size, out=np.zeros_like(off), where=size > 0.0).max(initial=0.0))
