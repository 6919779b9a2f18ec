"""Given matrices M, K, C, G, K4 as a body, reduced to modes with residual compliance.

    K phi = omega^2 M phi,   S = P^T G P - (P^T Phi) diag(1/omega^2) (P^T Phi)^T

P are the unit forces on the contact channels, G the static compliance K^-1. A free body has the compliance of its
elastic modes alone, by inertia relief: G P = u with K u = P - M R R^T P and R^T M u = 0, R its rigid modes. S
represents massless dofs exactly. Modes come from M x = theta (K + s M) x, theta = 1/(omega^2 + s), which resolves the
lowest modes best and admits rigid modes and massless dofs.

K is stored as K + dK, |dK_ij| <= u |K_ij|, u = 2^-24 in single precision. A mode of zero stiffness then comes out as
omega^2 = phi^T dK phi, of either sign, |omega^2| <= u |phi|^T |K| |phi|. A mode within this bound is rigid if it is
negative, below ten times the most negative one, or a rigid motion of the nodes. Other modes near a negative one are
refused. The terms of a mode's strain energy add up to |phi|^T |K| |phi| in magnitude. For a rigid mode they cancel. A
mode whose terms do not cancel is elastic, however stiff other springs are.

The modes are those of M and the symmetric part of K. Phi^T C Phi without the modal damping ratios is their `damping`,
Phi^T G Phi their `gyroscopic`, and the skew part of K between them their `stiffness`.
"""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from contact.base.arrays import Array
from contact.base.errors import InputError
from contact.model.bodies.matrices import Contact, Matrices
from contact.model.bodies.matrix_report import MatrixReport
from contact.model.bodies.rigid_test import rigid_findings

MODES = 20  # modes that are kept by default
DENSE = 1500  # unknowns up to which all modes are computed at once
RIGID = 1e-6  # omega^2 over that of the lowest elastic mode from the seventh on below which a mode is rigid
UNREAL = 1e-12  # the same, where the mode's own springs have no more stiffness: round-off of a condensed stiffness
ROUGH = 1e-2  # of the same: round-off of K that may be taken as zero; it is 0.1 of the lowest elastic frequency
SHIFT = 1e-6  # s over the median K_ii / M_ii
ROUND_OFF = 1e-14  # omega^2 over the median K_ii / M_ii that counts as zero
STRAINED = 0.03  # of a mode: what round-off may add to a rigid motion; the first mode of a cantilever has more
SEEN = 10.0  # times the most negative omega^2: six values of round-off are of one order
INDEPENDENT = 1e-10  # singular values of rigid motions, below which two are the same
NONE, LEAST = 1e-9, 1e-10  # damping between modes that is round-off: over their own, over the largest of all
UNEQUAL = 1e-2  # of masses along x, y, z: one centre and inertia need one mass
NOTHING = 1e-8  # of the static compliance: below it the residual is round-off, of the modes beside a shift of 1e-6


def reduced(
    matrices: Matrices, contact: Contact, *, modes: int | None = None, zeta: float = 0.0
) -> tuple[dict[str, Any], MatrixReport]:
    """Fields of the modal body of matrices at their contact, and a report; 20 modes, or all if fewer.

    Raises InputError for indefinite matrices, unknown dofs, or more modes than the matrices have.
    """
    modes = min(MODES, matrices.size) if modes is None else modes
    if not 1 <= modes <= matrices.size:
        raise InputError(f"modes: found {modes}, expected 1 to {matrices.size}, the number of unknowns")
    channels, P = matrices.loads(contact)
    lam, phi, rigid = lowest_modes(matrices, modes)
    omega = np.sqrt(lam)
    R = phi[:, :rigid]
    G = elastic_compliance(matrices, P, R)
    rows = P.T @ phi
    elastic = rows[:, rigid:] / omega[rigid:]
    total, S = P.T @ G, P.T @ G - elastic @ elastic.T
    S = without_round_off(0.5 * (S + S.T), NOTHING * float(np.abs(total).max()))
    found = rigid_findings(matrices, R, median_rate(matrices))
    damping, rest, coupling = modal_damping(matrices, phi, omega, 0.0 if matrices.K4 is not None else zeta)
    structural, across = None, 0.0
    if matrices.K4 is not None:
        loss, across = loss_factors(matrices, phi, omega)
        damping = damping + 0.5 * loss
        if damping.max(initial=0.0) >= 1.0:
            k = int(damping.argmax())
            raise InputError(f"K4: found a damping ratio of {damping[k]:.3g} in mode {k + 1}, expected less than 1")
        structural = (float(loss[rigid:].min(initial=np.inf)), float(loss[rigid:].max(initial=0.0)))
        structural = structural if structural[0] <= structural[1] else (0.0, 0.0)
    share = float(np.trace(S) / np.trace(total)) if S.any() else 0.0
    facts = report_of(matrices, lam, rigid, len(lam), share, coupling)
    facts = replace(facts, structural=structural, structural_coupling=across, rigid_motion=found)
    body = dict(
        omega=omega,
        zeta=damping,
        channels=channels,
        rows=rows,
        S=S,
        damping=rest,
        gyroscopic=between(matrices.G, phi),
        stiffness=between(matrices.cross, phi),
        participation=matrices.rigid_motions()[:, :3].T @ (matrices.M @ phi),
        provenance=json.dumps({"method": "matrices", "modes": len(lam), "matrices": asdict(facts)}, sort_keys=True),
    )
    return body, facts


def without_round_off(S: Array, level: float) -> Array:
    """Remove round-off from a residual compliance.

    Slightly negative eigenvalues, or the whole matrix if it is only round-off.
    """
    if np.abs(S).max() <= level:
        return np.zeros_like(S)
    values, vectors = np.linalg.eigh(S)
    below = (values < 0.0) & (values > -level)
    if not below.any():
        return S
    values[below] = 0.0
    mended = (vectors * values) @ vectors.T
    return np.asarray(0.5 * (mended + mended.T))


def lowest_modes(matrices: Matrices, count: int) -> tuple[Array, Array, int]:
    """omega^2 ascending (at most `count`, without massless dofs), mass-normalised modes, rigid ones first."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    M, K, n = matrices.M, matrices.K, matrices.size
    rate = median_rate(matrices)
    shift = SHIFT * rate
    if n <= DENSE:
        try:
            theta, X = eigh(M.toarray(), (K + shift * M).toarray())
        except np.linalg.LinAlgError:
            expected = "one without negative modes"
            raise InputError(f"K: found an indefinite or singular stiffness, expected {expected}") from None
        if theta[0] < -1e-9 * theta[-1]:
            raise InputError("M: found negative modal masses, expected a mass matrix without negative eigenvalues")
        theta, X = theta[::-1], X[:, ::-1]
        alive = theta > 1e-15 * theta[0]
        theta, X = theta[alive], X[:, alive]
    else:
        factor = factored(K + shift * M)
        inverse = LinearOperator((n, n), matvec=factor.solve)
        start = factor.solve(M @ np.random.default_rng(7).standard_normal(n))
        wanted = min(max(count, 7) + 6, n - 1)
        try:
            values, X = eigsh(K, wanted, M=M, sigma=-shift, OPinv=inverse, which="LM", v0=start)
        except ArpackError as error:
            massive = np.count_nonzero(M.diagonal())
            found = f"found fewer than {wanted} modes of {n} dofs, of which {massive} have mass ({error})"
            raise InputError(f"M, K: {found}: if few dofs have mass, condense the massless ones") from None
        order = np.argsort(values)
        theta, X = 1.0 / (values[order] + shift), X[:, order]
        if (theta < 0.0).any():
            raise InputError("K: found an indefinite stiffness, expected one without negative modes")
    X = X / np.sqrt(np.einsum("ij,ij->j", X, M @ X))
    lam = 1.0 / theta - shift
    rigid = rigid_modes(matrices, lam, X, lowest_elastic(lam, rate))
    lam[:rigid] = 0.0
    kept = min(count, len(lam))
    if kept < rigid:
        raise InputError(f"modes: found {count}, expected at least the {rigid} rigid modes of these matrices")
    return lam[:kept], np.ascontiguousarray(X[:, :kept]), rigid


def rigid_modes(matrices: Matrices, lam: Array, X: Array, level: float) -> int:
    """Number of rigid modes among X (n, m), mass-normalised; `level` is the lowest elastic omega^2.

    Raises InputError where omega^2 is more negative than the precision of K explains, or rigid modes are not separate.
    """
    candidates = int(np.count_nonzero(lam < level))
    lowest = X[:, : max(candidates, 1)]
    springs = np.einsum("ij,ij->j", np.abs(lowest), abs(matrices.K) @ np.abs(lowest))
    noise = matrices.rounding * springs
    least = np.full(len(noise), RIGID * level)
    if lam[0] > -UNREAL * level:
        least = np.clip(RIGID * springs, UNREAL * level, least)
    bound = np.maximum(least, np.minimum(noise, ROUGH * level))
    if lam[0] < -bound[0]:
        found = f"found omega^2 = {lam[0]:.3g} rad^2/s^2, expected a stiffness without negative modes"
        raise InputError(f"K: {found}; rounding errors of K explain down to {-bound[0]:.3g}")
    lam, bound, least = lam[:candidates], bound[:candidates], least[:candidates]
    noisy = candidates > 0 and lam[0] < -RIGID * level
    zero = lam < least
    if not zero.all():
        zero |= (lam < bound) & ((strain(matrices, lowest) < STRAINED) | (noisy & (lam < -SEEN * lam[0])))
    if noisy and (lost := lam[~zero & (lam < noise[:candidates])]).size:
        found = f"found omega^2 = {lam[0]:.3g} and {lost[0]:.3g} rad^2/s^2, which rounding errors of K can explain"
        advice = "give K in double precision, or the positions of its nodes"
        raise InputError(f"K: {found}, expected elastic modes above the rounding errors: {advice}")
    return candidates if zero.all() else int(np.argmin(zero))


def strain(matrices: Matrices, X: Array) -> Array:
    """Part of mass-normalised modes outside the rigid motions of all nodes, 0 to 1, (m,)."""
    known = np.array([matrices.points[node] for node, _ in matrices.dofs if node in matrices.points])
    R = matrices.rigid_motions(known.mean(axis=0) if len(known) else None)
    R = R / np.maximum(np.sqrt(np.einsum("ij,ij->j", R, matrices.M @ R)), np.finfo(float).tiny)
    left = X - R @ (np.linalg.pinv(R.T @ (matrices.M @ R), rcond=INDEPENDENT) @ (R.T @ (matrices.M @ X)))
    return np.asarray(np.sqrt(np.maximum(np.einsum("ij,ij->j", left, matrices.M @ left), 0.0)))


def lowest_elastic(lam: Array, rate: float) -> float:
    """omega^2 of the first mode from the seventh on that exceeds round-off; that of the last one if none does.

    A part has at most six rigid modes; unconnected parts or a mechanism have more. Larger values, such as the mode of a
    support's penalty, are replaced by the median rate K_ii / M_ii.

    >>> lowest_elastic(np.array([0.0] * 8 + [4.0, 9.0]), 20.0), lowest_elastic(np.array([4.0, 1e20]), 20.0)
    (4.0, 20.0)
    """
    beyond = lam[min(6, len(lam) - 1) :]
    elastic = beyond[beyond > ROUND_OFF * rate]
    return min(float(elastic[0] if elastic.size else beyond[-1]), rate)


def factored(A: Any) -> Any:
    """Factors of a sparse matrix; a singular one is refused."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    try:
        return splu(csc_array(A))
    except RuntimeError:
        raise InputError("K: found a singular stiffness, expected mass or stiffness at every dof") from None


def median_rate(matrices: Matrices) -> float:
    """Median K_ii / M_ii [rad^2/s^2] of dofs with stiffness; masses without springs are left out."""
    masses, springs = matrices.M.diagonal(), matrices.K.diagonal()
    heavy = masses > 0.0
    if not heavy.any():
        raise InputError("M: found no mass on its diagonal, expected entries > 0")
    rates = springs[heavy] / masses[heavy]
    if not (rates > 0.0).any():
        raise InputError("K: found no stiffness on its diagonal at dofs with mass, expected entries > 0")
    return float(np.median(rates[rates > 0.0]))


def elastic_compliance(matrices: Matrices, P: Array, R: Array) -> Array:
    """Static displacements under unit forces on the channels, (n, channels); for a free body by inertia relief.

    Its forces are balanced by those that accelerate it: K u + M R a = P and R^T M u = 0.
    """
    from scipy.sparse import block_array, csc_array

    if not R.shape[1]:
        return np.asarray(factored(matrices.K).solve(P))
    momenta = matrices.M @ R
    scale = float(np.abs(matrices.K.diagonal()).mean() / np.abs(momenta).max())
    border = csc_array(scale * momenta)
    bordered = block_array([[matrices.K, border], [border.T, None]])
    solved = factored(bordered).solve(np.vstack([P, np.zeros((R.shape[1], P.shape[1]))]))
    return np.asarray(solved[: matrices.size])


def between(skew: Any, phi: Array) -> Array | None:
    """A skew matrix projected on the modes, (m, m); None without it."""
    if skew is None:
        return None
    found = phi.T @ (skew @ phi)
    return np.asarray(0.5 * (found - found.T))


def modal_damping(
    matrices: Matrices, phi: Array, omega: Array, zeta: float
) -> tuple[Array, Array | None, float | None]:
    """Modal damping ratios, the rest of Phi^T C Phi, and the largest coupling of two modes; None, None without C.

    A mode gets its ratio if that is below 1; the damping of other modes, such as rigid ones, is in the matrix.
    """
    if matrices.C is None:
        return np.full(len(omega), zeta), None, None
    c = np.asarray(phi.T @ (matrices.C @ phi))
    own = np.diag(c)
    if own.min() < -RIGID * np.abs(own).max():
        raise InputError(
            f"C: found negative damping in mode {int(own.argmin()) + 1}, expected damping that dissipates energy"
        )
    own = np.abs(own)
    vibrates = (omega > 0.0) & (own < 2.0 * omega)
    ratio = np.divide(own, 2.0 * omega, out=np.zeros(len(omega)), where=vibrates)
    size = np.sqrt(np.outer(own, own))
    off = np.abs(c - np.diag(np.diag(c)))
    coupling = np.divide(off, size, out=np.zeros_like(off), where=size > 0.0).max(initial=0.0)
    rest = c - np.diag(np.where(vibrates, np.diag(c), 0.0))
    rest[np.abs(rest) <= NONE * size + LEAST * own.max(initial=0.0)] = 0.0
    return ratio, rest if rest.any() else None, float(coupling)


def loss_factors(matrices: Matrices, phi: Array, omega: Array) -> tuple[Array, float]:
    """Loss factor g = phi^T K4 phi / phi^T K phi of each mode (structural damping), and the largest coupling of two.

    A rigid mode has none.
    """
    k4 = phi.T @ (matrices.K4 @ phi)
    own = np.diag(k4)
    size = float(np.abs(own).max(initial=0.0))
    if own.min(initial=0.0) < -RIGID * size:
        raise InputError(
            f"K4: found negative damping in mode {int(own.argmin()) + 1}, expected damping that dissipates energy"
        )
    own = np.maximum(own, 0.0)
    elastic = omega > 0.0
    stiffness = np.einsum("ij,ij->j", phi, matrices.K @ phi)  # omega^2, to more digits
    loss = np.divide(own, stiffness, out=np.zeros_like(omega), where=elastic)
    root = np.sqrt(np.outer(own, own))
    off = np.abs(k4 - np.diag(np.diag(k4)))
    part = np.divide(off, root, out=np.zeros_like(off), where=(root > 0.0) & np.outer(elastic, elastic))
    return loss, float(part.max(initial=0.0))


def report_of(
    matrices: Matrices, lam: Array, rigid: int, kept: int, residual: float, coupling: float | None
) -> MatrixReport:
    """Report on matrices and the kept modes."""
    motions = matrices.rigid_motions()
    inertia = motions.T @ (matrices.M @ motions)
    mass = np.diag(inertia)[:3]
    known = all(node in matrices.points for node, axis in matrices.dofs if axis != "q") and mass.min() > 0.0
    known = known and np.ptp(mass) <= UNEQUAL * mass.max()  # supports may leave out single directions
    centre = about = None
    if known:
        # the mean of the diagonal's three masses: the part of the first moment that is skew gives the centre
        m = float(mass.mean())
        first = inertia[:3, 3:]
        x = np.array([first[1, 2] - first[2, 1], first[2, 0] - first[0, 2], first[0, 1] - first[1, 0]]) / (2.0 * m)
        steiner = m * (x @ x * np.eye(3) - np.outer(x, x))
        centre = tuple(x.tolist())
        about = tuple(map(tuple, (inertia[3:, 3:] - steiner).tolist()))
    a, b, c = mass.tolist()
    return MatrixReport(
        size=matrices.size,
        mass=(a, b, c),
        centre=centre,
        inertia=about,
        rigid=rigid,
        massless=int(np.count_nonzero(matrices.M.diagonal() == 0.0)),
        skew=matrices.skew,
        freq_hz=tuple((np.sqrt(lam[rigid : rigid + 6]) / (2.0 * np.pi)).tolist()),
        kept=kept,
        residual=residual,
        coupling=coupling,
        gyroscopic=matrices.G is not None,
        cross=matrices.cross is not None,
    )
