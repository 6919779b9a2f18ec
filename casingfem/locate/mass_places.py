"""Masses at arbitrary angles: angles are refined together with the masses.

The candidates of a grid are only starting points. Then Gauss-Newton steps change all masses and angles together, with
the derivative dM/dtheta of each mass matrix.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.io.arrays import FloatArray
from casingfem.locate.misfit import Misfit, Point
from casingfem.locate.sparse_search import TRIED, Bounds, gains, keep_searching, significant
from casingfem.modal.affine import AffineModel, mass_changes

STEP = 1e-4  # rad, of the difference that gives dM/dtheta
ROUNDS = 15
HALVINGS = 5
FURTHEST = 0.15  # rad, of one step
FIRST = 0.2  # of the largest linear step: the least mass that a refinement starts from
SETTLED = 1e-6  # relative fall of chi^2 that ends the refinement


class Masses(NamedTuple):
    """Masses [kg] at angles [rad], the casing with them, and the residuals' derivatives by (masses, angles)."""

    angles: FloatArray
    masses: FloatArray
    point: Point
    jacobian: FloatArray


def search_masses(misfit: Misfit, edge: str, angles: FloatArray, *, most: int, level: float) -> Masses:
    """The smallest number of masses that explain a table, at any angle.

    `angles` [rad] are the candidates of the misfit's model.

    Like `sparse_search.search`, but every step also refines the angles.
    """
    none = np.zeros(0)
    start = misfit.at(np.zeros(len(angles)))
    path = [Masses(none, none, start, np.zeros((len(start.values), 0)))]
    accepted = 0
    while keep_searching(len(path) - 1, accepted, most, path[-1].point, level):
        found = next_mass(misfit, edge, angles, path[-1])
        if found is None:
            break
        path.append(found)
        if significant(path[-2].point, found.point, 2 * len(found.masses), level, len(angles)):
            accepted = len(path) - 1
    return path[accepted]


def next_mass(misfit: Misfit, edge: str, angles: FloatArray, at: Masses) -> Masses | None:
    """One more mass, started at the best candidates; None if no mass improves the fit."""
    model, many = misfit.model, len(angles)
    assert model.mass is not None
    there = placed(model, edge, at.angles).mass
    assert there is not None
    both = replace(model, mass=np.concatenate([model.mass, there[: len(at.masses)]]))
    point = replace(misfit, model=both).at(np.concatenate([np.zeros(many), at.masses]))
    upper = np.append(np.full(many, np.inf), at.masses)
    bounds = Bounds(lower=np.append(np.zeros(many), at.masses), upper=upper)  # the masses found before stay
    promised = gains(point, range(many, many + len(at.masses)), bounds)[:many]
    square = np.sum(point.jacobian[:, :many] ** 2, axis=0)
    step = -(point.jacobian[:, :many].T @ point.values) / np.where(square > 0.0, square, 1.0)
    tries = [int(c) for c in np.argsort(-promised, kind="stable")[:TRIED] if promised[c] > 0.0]
    fits = [
        refined(misfit, edge, np.append(at.angles, angles[c]), np.append(at.masses, max(step[c], FIRST * step.max())))
        for c in tries
        if step.max() > 0.0
    ]
    return min(fits, key=lambda fit: fit.point.chi2, default=None)


def placed(model: AffineModel, edge: str, angles: FloatArray) -> AffineModel:
    """A model whose changes are masses at angles [rad], then the derivatives of their matrices by the angles."""
    sides = [mass_changes(model.system, edge, angles + side) for side in (0.0, STEP, -STEP)]
    if not len(angles):
        return replace(model, mass=np.zeros((0, *model.K.shape)))
    model = model.with_changes(sides[0])
    ahead, behind = (model.with_changes(side).mass for side in sides[1:])
    assert model.mass is not None
    assert ahead is not None
    assert behind is not None
    return replace(model, mass=np.concatenate([model.mass, (ahead - behind) / (2.0 * STEP)]))


def refined(misfit: Misfit, edge: str, angles: FloatArray, masses: FloatArray) -> Masses:
    """Gauss-Newton on all masses and angles at once; each step is halved until it reduces chi^2."""
    point, jacobian = at_places(misfit, edge, angles, masses)
    for _ in range(ROUNDS if len(masses) else 0):
        norms = np.linalg.norm(jacobian, axis=0)
        unit = np.where(norms > 0.0, norms, 1.0)
        step = -np.linalg.lstsq(jacobian / unit, point.values, rcond=1e-8)[0] / unit
        before = point.chi2
        for half in range(HALVINGS):
            by_mass, by_angle = np.split(0.5**half * step, 2)
            moved = angles + np.clip(by_angle, -FURTHEST, FURTHEST), np.maximum(masses + by_mass, 0.1 * masses)
            there, its_jacobian = at_places(misfit, edge, *moved)
            if there.chi2 < before:
                (angles, masses), point, jacobian = moved, there, its_jacobian
                break
        if point.chi2 > before * (1.0 - SETTLED):
            break
    return Masses(angles, masses, point, jacobian)


def at_places(misfit: Misfit, edge: str, angles: FloatArray, masses: FloatArray) -> tuple[Point, FloatArray]:
    """The casing with masses at angles, and the derivatives by both."""
    local = replace(misfit, model=placed(misfit.model, edge, angles))
    point = local.at(np.concatenate([masses, np.zeros(len(masses))]))
    return point, point.jacobian * np.concatenate([np.ones(len(masses)), masses])
