"""How likely each kind of wave is for one or two modes, and each set of channels for a local one: all at once.

The equations of the other modes' waves are solved once; what is left of them, of the two or four columns of the modes
in question, is small, and is formed of all kinds together. Kinds that channels are off by the same have the same H.
"""

from __future__ import annotations

import numpy as np

from casingfem.experiment.identify.setups.wave_model import Products, Shapes, WaveProblem
from casingfem.experiment.identify.setups.wave_residues import (
    Eliminated,
    between,
    drawn_to,
    eliminated,
    prior_of,
    squares_held,
    unlikely_by,
)
from casingfem.io.arrays import FloatArray, IntArray


def unlikely_kinds(problem: WaveProblem, shapes: Shapes, at: Products, rest: Eliminated, which: IntArray) -> FloatArray:
    """-2 ln of the likelihood with each kind of wave for some modes, all the same, (kinds,); `rest` is of `shapes`."""
    spread = problem.waves.spread
    found = np.zeros(len(spread))
    for kinds in (np.flatnonzero(spread == k) for k in range(spread.max() + 1)):
        tried = shapes.kind.copy()
        tried[which] = kinds[0]
        as_now = np.array_equal(spread[tried], spread[shapes.kind])
        here = rest if as_now else eliminated(problem, shapes._replace(kind=tried), at)
        found[kinds] = _with_kinds(problem, shapes, here, which, kinds)
        found[kinds] += squares_held(problem, at, here) / problem.cluster.noise + here.logs.sum()
    return np.asarray(found - np.log(prior_of(problem, shapes)).sum())


def _with_kinds(problem: WaveProblem, shapes: Shapes, rest: Eliminated, which: IntArray, kinds: IntArray) -> FloatArray:
    """What the equations of waves add to it, (kinds,), for kinds of the same H."""
    others = np.setdiff1d(np.arange(len(shapes.kind)), which)
    E, D = drawn_to(problem, kinds), drawn_to(problem, shapes.kind[others])
    channels, many, width = E.shape
    prior = prior_of(problem, shapes).reshape(-1, width)
    left = np.ascontiguousarray(E.transpose(1, 2, 0))  # (kinds, columns, channels)
    size = len(which) * width
    both = rest.own[:, which][:, :, which]
    right = both[None, :, :, :, None] * left.swapaxes(1, 2)[:, :, None, None]
    N = (left @ right.reshape(many, channels, -1)).reshape(many, width, len(which), size)
    N = N.swapaxes(1, 2).reshape(many, size, size) + np.diag(prior[which].ravel())
    r = (left @ rest.told[:, which]).swapaxes(1, 2).reshape(many, size)
    if not len(others):
        return unlikely_by(problem, N, r)
    fixed = between(D, rest.own[:, others][:, :, others], D) + np.diag(prior[others].ravel())
    told = np.einsum("caw,ca->aw", D, rest.told[:, others]).ravel()
    towards = (rest.own[:, which][:, :, others, None] * D[:, None]).reshape(channels, -1)
    cross = (left @ towards).reshape(many, width, len(which), -1).swapaxes(1, 2).reshape(many, size, -1)
    solved = np.linalg.solve(fixed, np.column_stack([told, cross.reshape(many * size, -1).T]))
    back = solved[:, 1:].reshape(-1, many, size).swapaxes(0, 1)
    reduced = unlikely_by(problem, N - cross @ back, r - cross @ solved[:, 0])
    return np.asarray(reduced + np.linalg.slogdet(fixed)[1] - told @ solved[:, 0] / problem.cluster.noise)


def unlikely_local(problem: WaveProblem, shapes: Shapes, at: Products, order: IntArray) -> FloatArray:
    """The same where the last mode is local: seen by the first channel of an order, by the first two, ... (sets,)."""
    everywhere = np.arange(len(problem.weight))
    place = np.argsort(problem.order)[order]  # of the channels in that order, where set-ups follow each other
    sides = []
    for seen in (everywhere, everywhere[:0]):
        waves = problem.waves.seen_by(seen)
        trying = problem._replace(waves=waves)
        last = shapes._replace(kind=np.append(shapes.kind[:-1], len(waves.columns) - 1))
        rest, D = eliminated(trying, last, at), drawn_to(trying, last.kind)
        N = (D[:, :, :, None, None] * rest.own[:, :, None, :, None] * D[:, None, None]).reshape(len(D), -1)
        r = (D * rest.told[:, :, None]).reshape(len(D), -1)
        sides.append(np.column_stack([N, r, rest.squares, rest.logs]))
    with_it, without = sides
    sums = without.sum(axis=0) + np.cumsum((with_it - without)[place], axis=0)
    prior = prior_of(problem, shapes)
    size = len(prior)
    N, r = sums[:, : size**2].reshape(-1, size, size) + np.diag(prior), sums[:, size**2 : -2]
    fixed = squares_held(problem, at, rest) + rest.squares.sum()
    held = (fixed - sums[:, -2]) / problem.cluster.noise + sums[:, -1]
    return np.asarray(held + unlikely_by(problem, N, r) - np.log(prior).sum())
