"""Modes of a casing with many possible small changes on its edges, from one reduced basis.

    K(x) = K0 + sum_c x_c K_c,   M(x) = M0 + sum_c x_c M_c

K_c and M_c act on few dofs of an edge: the springs of one bolt, a mass at one place. The basis contains the modes of
the unchanged casing and the static responses K0^-1 (K_c Phi), K0^-1 (M_c Phi) to each change, so that large changes (a
missing bolt) are as accurate as small ones; `python -m reports.verification.updating.loose_bolt_search` compares it
with full solutions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array

from casingfem.io.arrays import Array, FloatArray
from casingfem.linalg.factor import factorise
from casingfem.modal.fourier import SHIFT
from casingfem.modal.harmonics import DOUBLE, Rings, align_pair, find_doublets, orientation, ring_content
from casingfem.modal.mode_set import Modes, ModeSet, frequency_scale, ranks
from casingfem.modal.modes import modes
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import EdgeMass, Ring
from casingfem.structure.mesh.edge_form import EdgeForm, spring_form
from casingfem.structure.shell.assembly import on_free
from casingfem.structure.shell.edges import edge_line, mass_forms, own_dofs, support_form
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.shell import remade
from casingfem.structure.shell.system import System
from casingfem.structure.shell.variation import outer_supports
from contact.io.brief import brief

ANSWERS, FEWEST = 120, 5  # static answers kept for all changes together, and for each
BEYOND = 3  # nodal diameters past those of the nominal modes that labels know
ALIKE = 1e-9  # of the largest: what a direction must add to the others' strain energy to be kept


class Change(NamedTuple):
    """Addition to stiffness and mass per unit of a change; None for no addition."""

    stiffness: EdgeForm | None = None
    mass: EdgeForm | None = None


def bolt_changes(system: System, edge: str) -> list[Change]:
    """The springs of each bolt of an edge, as for tight bolts: minus one unit is a missing bolt."""
    shell, support = system.shell, system.shell.supports[edge]
    line, own = edge_line(shell, system.grid, edge), own_dofs(shell, system.grid)
    bolts = outer_supports(shell)[edge]
    assert isinstance(bolts, Bolts)
    changes = []
    for bolt in range(1, bolts.count + 1):
        alone = replace(bolts, loose={b: float(b == bolt) for b in range(1, bolts.count + 1)})
        if isinstance(support, Ring):
            form = support_form(shell, system.grid, edge, replace(support, support=alone), own[edge], line)
        else:
            form = spring_form(alone.springs(line))
        there = np.any(form.D, axis=(1, 2))
        changes.append(Change(stiffness=EdgeForm(dofs=form.dofs[there], B=form.B[there], D=form.D[there])))
    return changes


def mass_changes(system: System, edge: str, angles: FloatArray) -> list[Change]:
    """One kilogram at each of some angles [rad] of an edge."""
    if not len(angles):
        return []
    bare = remade(ShellParts, system.shell)  # a search asks this thousands of times, of a shell that is checked
    heavy = replace(bare, masses={edge: [EdgeMass(angle=float(a), mass=1.0) for a in angles]})
    (form,) = mass_forms(heavy, system.grid)
    return [Change(mass=EdgeForm(*(part[k : k + 1] for part in form))) for k in range(len(angles))]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AffineModel:
    """A casing and its changes in a reduced basis.

    Modes are the largest mu of M(x) y = mu (K(x) + s M(x)) y, omega^2 = 1/mu - s: so the lowest are exact to round-off
    relative to themselves, not to the highest frequency of the basis.

    Attributes
    ----------
    system
        The unchanged casing.
    nominal
        Its modes, as many as requested for the basis.
    motions
        Motions of the basis at all dofs, those of nodes first, of rings last, (5 nodes + own, r).
    K, M
        K0 + s M0 and M0 in the basis, (r, r).
    shift
        s [rad^2/s^2], small beside the first elastic eigenvalue: free casings can be reduced too.
    stiffness, mass
        K_c and M_c, (changes, r, r); None if no change has any.
    rings
        Circumferential content of the basis.
    """

    system: System
    nominal: Modes
    motions: FloatArray
    K: FloatArray
    M: FloatArray
    shift: float
    stiffness: FloatArray | None
    mass: FloatArray | None
    rings: Rings

    __repr__ = brief

    def with_changes(self, changes: "Sequence[Change]") -> "AffineModel":
        """The same basis with other changes, close to those for which it was made."""
        stiffness, mass = (products([change[k] for change in changes], self.motions) for k in (0, 1))
        return replace(self, stiffness=stiffness, mass=mass)

    @property
    def changes(self) -> int:
        """Number of changes."""
        return max(len(each) for each in (self.stiffness, self.mass) if each is not None)

    def modes(self, x: FloatArray, count: int) -> "AffineModes":
        """Lowest `count` modes after changes x (changes,), labelled."""
        K, M, on = self.K, self.M, np.flatnonzero(x)
        if self.stiffness is not None:
            K = K + np.tensordot(x[on], self.stiffness[on], 1)
        if self.mass is not None:
            added = np.tensordot(x[on], self.mass[on], 1)
            K, M = K + self.shift * added, M + added
        mu, y = eigh(M, K, subset_by_index=(len(K) - count, len(K) - 1))
        mu, y = mu[::-1], y[:, ::-1] / np.sqrt(mu[::-1])
        freq = np.sqrt(np.maximum(1.0 / mu - self.shift, 0.0)) / (2.0 * np.pi)
        return modes_by_coordinates(freq, y, self.rings, rigid=self.nominal.rigid)

    def derivatives(self, found: "AffineModes") -> FloatArray:
        """G[c, i, j] = phi_i^T (K_c - omega_i^2 M_c) phi_j, (changes, modes, modes), as in `eigen_derivatives`."""
        y, square = found.coordinates, found.omega[:, None] ** 2
        G = np.zeros((self.changes, len(found), len(found)))
        if self.stiffness is not None:
            G += y.T @ (self.stiffness @ y)
        if self.mass is not None:
            G -= square * (y.T @ (self.mass @ y))
        return G


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class AffineModes(ModeSet):
    """Modes by their coordinates (r, modes) in the reduced basis; `fields` are empty."""

    coordinates: FloatArray


def modes_by_coordinates(freq: FloatArray, y: FloatArray, basis: Rings, *, rigid: int) -> AffineModes:
    """Modes labelled by the circumferential content of their basis; y (r, modes) is rotated for perfect pairs."""
    count, of_basis = len(freq), basis.amplitudes
    flat = of_basis.reshape(-1, len(y))  # one product of matrices, where each n and ring would have its own
    rings = Rings((flat @ y).reshape(*of_basis.shape[:-1], count), basis.weights)
    n, purity = rings.label()
    n[:rigid] = -1
    pairs = find_doublets(rings, n)
    for pair in pairs:  # perfect ones have no orientation: cosine and sine, as `labelled` has them
        if np.ptp(freq[list(pair)]) <= DOUBLE * freq[pair[1]]:
            turn = align_pair(*(rings.profile(k, n[pair[0]]) for k in pair))
            y[:, pair] = y[:, pair] @ turn
            rings.amplitudes[..., pair] = rings.amplitudes[..., pair] @ turn
    angle = [orientation(rings.profile(k, n[k]), int(n[k])) if n[k] > 0 else np.nan for k in range(count)]
    return AffineModes(
        freq=freq,
        fields=np.zeros((0, 5, count)),
        nodal_diameters=n,
        purity=purity,
        meridional=ranks(n, pairs),
        doublets=tuple(pairs),
        angle_deg=np.degrees(angle),
        rigid=rigid,
        sturm_count=None,
        dofs=len(y),
        rings=rings,
        coordinates=y,
    )


def affine_model(system: System, changes: Sequence[Change], count: int, nominal: Modes | None = None) -> AffineModel:
    """Reduce a casing to `count` modes (`nominal` if they are known) and the static responses to its changes.

    Raises
    ------
    ValueError
        An open shell.
    """
    shell = system.shell
    if not shell.chart.periodic:
        raise ValueError("an open shell has no nodal diameters")
    known = nominal or modes(shell, count, method="shell", system=system)
    shapes = system.collect(known.fields, known.own)
    most = max(ANSWERS // max(len(changes), 1), FEWEST)
    forms = [form for change in changes for form in change if form is not None]
    pushes = [push for form in forms for push in answers(system, form, shapes, most)]
    shift = float((SHIFT * frequency_scale(shell)) ** 2)
    held = csc_array(system.K + diags_array(shift * system.mass))
    V = independent(held, shapes / np.sqrt(known.omega**2 + shift), factorise(held).solve(np.array(pushes).T))
    fields = system.expand(V)
    motions = np.vstack([fields.reshape(-1, V.shape[1]), system.expand_own(V)])
    stiffness, mass = (products([change[k] for change in changes], motions) for k in (0, 1))
    grid = system.grid
    rings = ring_content(shell.chart, grid, fields, n_max=int(known.nodal_diameters.max()) + BEYOND)
    K, M = V.T @ (held @ V), V.T @ (system.mass[:, None] * V)
    return AffineModel(
        system=system,
        nominal=known,
        motions=motions,
        K=0.5 * (K + K.T),
        M=0.5 * (M + M.T),
        shift=shift,
        stiffness=stiffness,
        mass=mass,
        rings=Rings(np.ascontiguousarray(rings.amplitudes), rings.weights),
    )


def answers(system: System, form: EdgeForm, shapes: FloatArray, most: int) -> FloatArray:
    """Loads (`most`, free) that span the products of a form with the modes, the largest first."""
    A = on_free([form], system.frames, system.free, system.own)
    if system.change is not None:
        A = csc_array(system.change.T @ A @ system.change)
    load = A @ shapes
    rows = np.flatnonzero(np.any(load, axis=1))
    U, size, _ = np.linalg.svd(load[rows], full_matrices=False)
    kept = int(np.count_nonzero(size[:most] > 1e-9 * size[0]))
    loads = np.zeros((kept, system.size))
    loads[:, rows] = (U[:, :kept] * size[:kept]).T
    return loads


def independent(K: csc_array, first: FloatArray, more: FloatArray) -> FloatArray:
    """K-orthonormal basis of K-orthonormal columns (free, m) and further columns (free, k)."""
    for _ in range(2):  # twice is enough (Gram and Schmidt)
        more = more - first @ (first.T @ (K @ more))
    more = more / np.sqrt(np.einsum("ij,ij->j", more, K @ more))
    values, turn = np.linalg.eigh(more.T @ (K @ more))
    kept = values > ALIKE * values[-1]
    return np.hstack([first, more @ (turn[:, kept] / np.sqrt(values[kept]))])


def products(forms: Sequence[EdgeForm | None], motions: Array) -> FloatArray | None:
    """The forms in the basis, (changes, r, r); None if there is none."""
    if all(form is None for form in forms):
        return None
    size = motions.shape[1]
    return np.array([np.zeros((size, size)) if form is None else form.product(motions) for form in forms])
