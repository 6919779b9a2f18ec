"""Importance sampling of a rare event around the points that subset simulation has found.

Near the event the response depends on few directions. These have the largest mean square of its gradient (P.
Constantine, Active Subspaces, 2015), which follows from a regression of the normal scores of the responses. The
regression has linear terms, and products with the directions in which the second moment E[u u^T] of the points is
larger than chance explains. In these directions the sampling density is a sum of normal kernels (D. Scott, Multivariate
Density Estimation, 1992). Wide kernels in a part of the draws bound the weights (T. Hesterberg, Technometrics 37, 1995,
185). The mean of the weights phi/q over points with the event is the probability, without bias for any density q.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp, ndtri
from scipy.stats import rankdata

from casingfem.io.arrays import FloatArray

WIDE = 0.3  # of the draws have kernels of the spread of a normal number
MARGIN = 1.5  # times the largest second moment that independent normal numbers have by chance
PART = 0.05  # of the largest mean square of the gradient: directions with less are left out
MOST = 3  # directions with a density of their own
FULL = 4  # points at least for each coefficient of the regression
KERNELS = 200


class Density(NamedTuple):
    """A density of normal numbers with another distribution in some directions.

    Attributes
    ----------
    directions : orthonormal, (dimension, own); in all others the numbers are standard normal
    centres : of the kernels, (kernels, own)
    narrow : square root of their covariance, (own, own)
    """

    directions: FloatArray
    centres: FloatArray
    narrow: FloatArray

    def drawn(self, size: int, rng: np.random.Generator) -> FloatArray:
        """Points (size, dimension)."""
        u = rng.standard_normal((size, len(self.directions)))
        noise = rng.standard_normal((size, self.centres.shape[1]))
        wide = rng.random(size) < WIDE
        z = self.centres[rng.integers(0, len(self.centres), size)]
        z = z + np.where(wide[:, None], noise, noise @ self.narrow.T)
        return np.asarray(u + (z - u @ self.directions) @ self.directions.T)

    def log_weights(self, u: FloatArray) -> FloatArray:
        """Logarithm of phi/q at points (size, dimension)."""
        z = u @ self.directions
        step = z[:, None] - self.centres
        narrow = step @ np.linalg.inv(self.narrow).T
        wide, tight = (logsumexp(-0.5 * np.sum(part**2, axis=-1), axis=1) for part in (step, narrow))
        tight = tight - np.log(np.linalg.det(self.narrow))
        q = np.logaddexp(np.log(WIDE) + wide, np.log1p(-WIDE) + tight) - np.log(len(self.centres))
        return np.asarray(-0.5 * np.sum(z**2, axis=1) - q)


def directions_of(u: FloatArray, y: FloatArray, independent: int) -> FloatArray | None:
    """Directions (dimension, own) on which responses y of points u (points, dimension) depend; None if too many."""
    points, dimension = u.shape
    moment, vectors = np.linalg.eigh(u.T @ u / points)
    edge = MARGIN * (1.0 + np.sqrt(dimension / independent)) ** 2
    room = max(points // (FULL * dimension) - 1, 0)
    rough = vectors[:, moment > edge][:, ::-1][:, : min(MOST, room)]
    z = u @ rough
    products = (z[:, :, None] * u[:, None]).reshape(points, -1)
    scores = ndtri((rankdata(y) - 0.5) / points)
    found = np.linalg.lstsq(np.column_stack([np.ones(points), u, products]), scores, rcond=1e-8)[0]
    C = found[1 + dimension :].reshape(-1, dimension)
    gradient = found[1 : 1 + dimension] + z @ C + (u @ C.T) @ rough.T
    square, vectors = np.linalg.eigh(gradient.T @ gradient)
    own = vectors[:, square > PART * square[-1]][:, ::-1]
    return np.asarray(own) if own.shape[1] <= MOST else None


def density_of(found: FloatArray, directions: FloatArray, independent: int, rng: np.random.Generator) -> Density:
    """The density of points (points, dimension) in some directions; `independent`: number of independent points."""
    z, own = found @ directions, directions.shape[1]
    spread = np.atleast_2d(np.cov(z.T)) + 1e-12 * np.eye(own)
    width = (4.0 / ((own + 2) * independent)) ** (1.0 / (own + 4))  # Silverman's rule
    chosen = rng.permutation(len(z))[:KERNELS]
    return Density(directions, z[chosen], width * np.linalg.cholesky(spread))
