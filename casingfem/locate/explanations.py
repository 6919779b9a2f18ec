"""Explanations of a table: bolts or masses, images by half turns, probabilities, and undetectable changes."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.locate.located import Explanation, Found
from casingfem.locate.mass_places import Masses, refined
from casingfem.locate.misfit import Misfit, Point
from casingfem.locate.sparse_search import Bounds, bounded_step, fitted, scale2, threshold
from casingfem.modal.affine import AffineModel
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.shell.shell import Shell
from casingfem.structure.shell.variation import outer_supports

LIKELY = 9.0  # alternatives whose chi^2/s^2 is within this of the best are listed: 3 sigma
PROMISING = 2.0  # images of what was found that come so near by a linear step are refitted
SAME = 0.01  # of a bolt's stiffness
TWINS = 4  # places whose half turns are all tried: 2^4 combinations


def loosening(factors: FloatArray) -> Bounds:
    """Bounds of loosening: a bolt can lose its whole stiffness; `factors` of a tight one's, (bolts,)."""
    return Bounds(lower=-factors, upper=np.zeros(len(factors)))


def bolted_edge(shell: Shell) -> str:
    """The one edge with bolts.

    Raises
    ------
    ModelError
        locate-bolts.
    """
    edges = [edge for edge, support in outer_supports(shell).items() if isinstance(support, Bolts)]
    if len(edges) != 1:
        raise ModelError("locate-bolts", f"locate among bolts: found {len(edges)} edges with bolts, expected one")
    return edges[0]


def factors_of(model: AffineModel) -> FloatArray:
    """Stiffness of a model's bolts relative to a tight bolt, (bolts,)."""
    shell = model.system.shell
    bolts = outer_supports(shell)[bolted_edge(shell)]
    assert isinstance(bolts, Bolts)
    return np.asarray(bolts.factors)


def sigmas(jacobian: FloatArray, scale: float) -> FloatArray:
    """Standard deviations of fitted values; large if the data hardly depend on them."""
    if not jacobian.shape[1]:
        return np.zeros(0)
    information = jacobian.T @ jacobian
    floor = 1e-14 * np.trace(information) * np.eye(len(information))
    return np.asarray(scale * np.sqrt(np.diag(np.linalg.inv(information + floor))))


def bolts_explained(misfit: Misfit, active: Sequence[int], point: Point, angles: FloatArray) -> tuple[Explanation, ...]:
    """The bolts found, then equivalent alternatives: rotated, mirrored, or some by half a turn."""
    s2 = scale2(point, len(active))
    factors, degrees = factors_of(misfit.model), np.degrees(angles) % 360.0
    bounds = loosening(factors)

    def explanation(at: Point, on: list[int]) -> Explanation:
        spread = np.minimum(sigmas(at.jacobian[:, on], np.sqrt(s2)), 1.0)
        found = [
            Found(place=c + 1, angle_deg=float(degrees[c]), value=float(factors[c] + at.x[c]), sigma=float(s))
            for c, s in zip(on, spread, strict=True)
        ]
        return Explanation(found=tuple(found), behind=float((at.chi2 - point.chi2) / s2))

    listed, seen = [], [point.x]
    for places in images(list(active), angles):
        x, on = np.zeros(len(point.x)), sorted(places)
        x[places] = np.maximum(point.x[list(active)], bounds.lower[places])  # no bolt loses more than it has
        if not np.all(x[places]):
            continue
        if min(np.abs(x - other).max() for other in seen) < SAME:  # alike bolts that change places change nothing
            continue
        seen.append(x)
        there = misfit.at(x)
        if (promised(there, on, bounds) - point.chi2) / s2 < PROMISING * LIKELY:
            listed.append(explanation(fitted(misfit.at, there, on, bounds), on))
    return (explanation(point, list(active)), *likely(listed))


def images(active: list[int], angles: FloatArray) -> Iterator[list[int]]:
    """Images of the active places by half turns of some, then by rotations and mirror images of all, in order.

    Half turns of some change no frequency and no orientation. Rotations and mirror images of all change no frequency of
    a uniform casing. Orientations, a survey or supports may distinguish them, so chi^2 decides.
    """
    for choice in half_turns(len(active)):
        yield from placed(angles[active] + np.pi * np.array(choice), angles)
    for way in (1.0, -1.0) if active else ():
        for start in angles:
            yield from placed(start + way * (angles[active] - angles[active[0]]), angles)


def placed(wanted: FloatArray, angles: FloatArray) -> Iterator[list[int]]:
    """The candidates at some angles, if each angle has one and all differ."""
    apart = np.abs(np.angle(np.exp(1j * (wanted[:, None] - angles))))
    places = apart.argmin(axis=1)
    if len(set(places)) == len(wanted) and np.all(apart.min(axis=1) < 1e-6):
        yield places.tolist()


def promised(at: Point, on: list[int], bounds: Bounds) -> float:
    """Expected chi^2 after the best linear step of some changes."""
    step = bounded_step(at, on, bounds.lower[on] - at.x[on], bounds.upper[on] - at.x[on])
    if step is None:
        return at.chi2
    r = at.values + at.jacobian[:, on] @ step
    return float(at.chi2 - at.values @ at.values + r @ r)


def masses_explained(misfit: Misfit, edge: str, best: Masses, candidates: int) -> tuple[Explanation, ...]:
    """The masses found, then the same with some of them moved by half a turn, if the table does not exclude it."""
    s2 = scale2(best.point, 2 * len(best.masses))

    def explanation(at: Masses) -> Explanation:
        by_mass, by_angle = np.split(sigmas(at.jacobian, np.sqrt(s2)), 2)
        degrees = np.degrees(at.angles) % 360.0
        found = [
            Found(
                place=round(degrees[k] / 360.0 * candidates) % candidates + 1,
                angle_deg=float(degrees[k]),
                value=float(at.masses[k]),
                sigma=float(by_mass[k]),
                angle_sigma_deg=float(np.degrees(by_angle[k])),
            )
            for k in np.argsort(degrees)
        ]
        return Explanation(found=tuple(found), behind=float((at.point.chi2 - best.point.chi2) / s2))

    turned = [best.angles + np.pi * np.array(choice) for choice in half_turns(len(best.masses))[1:]]
    listed = [explanation(refined(misfit, edge, angles, best.masses)) for angles in turned]
    return (explanation(best), *likely(listed))


def significant_masses(misfit: Misfit, edge: str, masses: Masses) -> Masses:
    """The masses that are more than three standard deviations from zero."""
    while len(masses.masses):
        spread = sigmas(masses.jacobian, np.sqrt(scale2(masses.point, 2 * len(masses.masses))))
        kept = masses.masses > 3.0 * spread[: len(masses.masses)]
        if kept.all():
            break
        masses = refined(misfit, edge, masses.angles[kept], masses.masses[kept])
    return masses


def half_turns(count: int) -> list[tuple[bool, ...]]:
    """Sets of places to move by half a turn, the empty one first; empty for too many places."""
    return list(product((False, True), repeat=count)) if count <= TWINS else []


def likely(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Explanations close to the best one, the likeliest first."""
    return sorted((e for e in explanations if e.behind < LIKELY), key=lambda e: e.behind)


def visible(point: Point, level: float, scale: float) -> FloatArray:
    """Size above which each single change exceeds the threshold, to first order, (changes,)."""
    lengths = np.linalg.norm(point.jacobian, axis=0)
    needed = threshold(level, len(lengths), len(point.values), 1)
    return np.asarray(scale * np.sqrt(needed) / np.where(lengths > 0.0, lengths, np.nan))


def groups_alike(jacobian: FloatArray, level: float = 0.999) -> tuple[tuple[int, ...], ...]:
    """Groups of places (numbers from 1) whose effects on the table are parallel; groups have two or more."""
    norms = np.linalg.norm(jacobian, axis=0)
    J = jacobian / np.where(norms > 0.0, norms, 1.0)
    cosine = J.T @ J
    groups: list[tuple[int, ...]] = []
    waiting = list(range(len(norms)))
    while waiting:
        first = waiting[0]
        group = [c for c in waiting if cosine[first, c] > level or c == first]
        waiting = [c for c in waiting if c not in group]
        if len(group) > 1:
            groups.append(tuple(c + 1 for c in group))
    return tuple(groups)
