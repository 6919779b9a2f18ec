"""Residues of modes that are waves, but for what each channel is off, eliminated at poles that are known.

With G = Phi^T Phi of a set-up, b = Phi^T y of a channel, L the noise over the variances of its residues A, E x their
means, H = (G + L)^-1 and A = H (b + L E x) eliminated, x from N x = r,

    squares = |y|^2 - b^T H b - r^T x,   N = sum E^T (L - L H L) E + prior,   r = sum E^T L H b.

What a channel gives does not depend on which wave a mode is, but for E: of any number of kinds, and of sets of channels
that see a local mode, only N and r are formed anew, from real parts alone, as those of waves are: all at once for one
or two modes. The equations of the other modes' waves are solved once; what is left of them, of the two or four columns
of the modes in question, is small. Kinds that channels are off by the same have the same H.
"""

from typing import NamedTuple

import numpy as np

from casingfem.experiment.identify.setups.wave_model import WIDE, Products, Shapes, WaveProblem
from casingfem.io.arrays import FloatArray, IntArray


class Eliminated(NamedTuple):
    """Of each channel, set-up by set-up: H, H b, the diagonal of L, all over modes x parts.

    `own` (channels, modes, modes) is L - L H L and `told` (channels, modes) L H b of real parts; `squares` (channels,)
    b^T H b, `logs` (channels,) ln det (G + L) - ln det L.
    """

    H: FloatArray
    free: FloatArray
    L: FloatArray
    own: FloatArray
    told: FloatArray
    squares: FloatArray
    logs: FloatArray


def eliminated(problem: WaveProblem, shapes: Shapes, at: Products) -> Eliminated:
    """The residues of all channels, whatever the waves."""
    m, s, counts = len(at.p), problem.data.window.columns, problem.counts
    whole = np.repeat(at.own[:, : m * s, : m * s], counts, axis=0)
    b = np.concatenate([by[: m * s, :many].T for by, many in zip(at.by_data, counts, strict=True)])
    L = _held(problem, shapes)
    whole[:, np.arange(m * s), np.arange(m * s)] += L
    H = np.asarray(np.linalg.inv(whole), np.float64)
    free = (H @ b[:, :, None])[:, :, 0]
    real = slice(0, m * s, s)
    own = -L[:, real, None] * H[:, real, real] * L[:, None, real]
    own[:, np.arange(m), np.arange(m)] += L[:, real]
    logs = np.linalg.slogdet(whole)[1] - np.log(L).sum(axis=1)
    return Eliminated(H, free, L, own, L[:, real] * free[:, real], np.sum(b * free, axis=1), logs)


def means(problem: WaveProblem, shapes: Shapes, rest: Eliminated) -> tuple[FloatArray, FloatArray, FloatArray]:
    """N, and r, of the columns of all modes' waves, and the diagonal of N without data."""
    D, prior = drawn_to(problem, shapes.kind), prior_of(problem, shapes)
    N = between(D, rest.own, D)
    return N + np.diag(prior), np.einsum("caw,ca->aw", D, rest.told).ravel(), prior


def drawn_to(problem: WaveProblem, kind: IntArray) -> FloatArray:
    """Weighted columns of some kinds of waves, (channels, kinds, columns), set-up by set-up."""
    order = problem.order
    columns = problem.waves.columns[kind][:, order] * problem.weight[order, None]
    return np.ascontiguousarray(columns.swapaxes(0, 1))


def prior_of(problem: WaveProblem, shapes: Shapes) -> FloatArray:
    """What the parts of each mode's wave are held to 0 by, (modes x columns,)."""
    return np.repeat(problem.cluster.noise / (WIDE * shapes.size) ** 2, problem.waves.columns.shape[2])


def between(D: FloatArray, own: FloatArray, E: FloatArray) -> FloatArray:
    """Sum over the channels of D^T own E, (modes x columns, modes x columns)."""
    right = own[:, :, :, None] * E[:, None]
    flat = right.reshape(*own.shape[:2], -1).swapaxes(0, 1)
    return np.asarray(D.transpose(1, 2, 0) @ flat).reshape(D.shape[1] * D.shape[2], -1)


def squares_held(problem: WaveProblem, at: Products, rest: Eliminated) -> float:
    """Squares left by residues without waves, deviations from usual shifts among them."""
    off, pull = pulled(problem, at)
    return float(problem.data.squares.sum() - rest.squares.sum() + pull * np.sum(off**2))


def unlikely_at(problem: WaveProblem, shapes: Shapes, at: Products, rest: Eliminated | None = None) -> float:
    """-2 ln of the likelihood at some poles."""
    rest = eliminated(problem, shapes, at) if rest is None else rest
    N, r, prior = means(problem, shapes, rest)
    fixed = squares_held(problem, at, rest) / problem.cluster.noise + rest.logs.sum()
    return float(fixed + unlikely_by(problem, N[None], r[None])[0] - np.log(prior).sum())


def unlikely_by(problem: WaveProblem, N: FloatArray, r: FloatArray) -> FloatArray:
    """What several equations N x = r (any number, columns) add to it."""
    gain = np.sum(r * np.linalg.solve(N, r[:, :, None])[:, :, 0], axis=1)
    return np.asarray(np.linalg.slogdet(N)[1] - gain / problem.cluster.noise)


def pulled(problem: WaveProblem, at: Products) -> tuple[FloatArray, float]:
    """What ln f of each set-up is off the mode's mean, and what that costs."""
    pull = problem.cluster.noise / problem.shift**2 if at.p.shape[1] > 1 else 0.0
    return at.p - at.p.mean(axis=1, keepdims=True), pull


def _held(problem: WaveProblem, shapes: Shapes) -> FloatArray:
    """The noise over the variances of residues, (channels, modes x parts)."""
    waves, order, parts = problem.waves, problem.order, problem.data.window.columns
    spread = np.stack([waves.off, waves.lag][:parts], axis=2)[shapes.kind][:, order].transpose(1, 0, 2)
    sizes = spread * shapes.size[:, None] * problem.weight[order, None, None]
    return np.asarray(problem.cluster.noise / sizes**2).reshape(len(order), -1)


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
