"""Deviation of the posterior from the Gaussian with covariance (J^T J)^-1.

Close to the solution every weighted residual is expanded to second order,

    r(x) = r0 + J d + 1/2 d^T H d,   d = x - x0,

with H by central differences of the exact Jacobian, half a standard deviation to either side. The Laplace approximation
uses the whole Hessian J^T J + sum_i r_i H_i. A sampler of these residuals needs no further modes (`sampling`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from casingfem.errors import InputError
from casingfem.io.arrays import FloatArray
from casingfem.updating.problem import Problem
from casingfem.updating.result import UpdateResult
from contact.io.columns import Column, mark, table_lines, word
from contact.io.reported import Reported

STEP = 0.5  # of a standard deviation


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Parabolas:
    """Residuals of the data to second order: x0 (p,), r (m,), J (m, p), H (m, p, p)."""

    x0: FloatArray
    r: FloatArray
    J: FloatArray
    H: FloatArray

    def __call__(self, x: FloatArray) -> FloatArray:
        """Residuals (points, m) at points (points, p)."""
        d = np.atleast_2d(x) - self.x0
        return np.asarray(self.r + d @ self.J.T + 0.5 * np.einsum("np,mpq,nq->nm", d, self.H, d))


def at_solution(fit: UpdateResult) -> Problem:
    """The problem of an update, solved at its solution, so that nearby points start from there."""
    problem = fit.problem
    problem.anchor = problem.state(fit.x)
    return problem


def evaluated(problem: Problem, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Residuals and Jacobian at a point near the solution; modes are tracked from those of the solution."""
    home = problem.anchor
    try:
        return problem.state(x).values, problem.data_jacobian(x)
    finally:
        problem.anchor = home


def parabolas(fit: UpdateResult) -> Parabolas:
    """Residuals to second order about the solution: two evaluations for each parameter, inside its bounds."""
    problem = at_solution(fit)
    steps = STEP * np.where(fit.stated_sigma > 0.0, fit.stated_sigma, 1e-3 * (fit.upper - fit.lower))
    H = np.empty((*fit.jacobian.shape, len(fit.x)))
    for k, step in enumerate(steps):
        ends = np.tile(fit.x, (2, 1))
        ends[:, k] = np.clip(fit.x[k] + [-step, step], fit.lower[k], fit.upper[k])
        low, high = (evaluated(problem, x)[1] for x in ends)
        H[:, :, k] = (high - low) / (ends[1, k] - ends[0, k])
    H = 0.5 * (H + H.transpose(0, 2, 1))
    return Parabolas(x0=fit.x, r=fit.values, J=fit.jacobian, H=H)


COLUMNS = (
    Column("name", "Address of the parameter.", lambda found: found.names, head="parameter", format=word),
    Column("log", "Whether the parameter varies in log10; both deviations are then in decades.",
           lambda found: found.log, head="in", format=mark("decades")),
    Column("sigma", "Standard deviation by the whole Hessian.", lambda found: found.sigma, format=".3g"),
    Column("gauss_newton", "Standard deviation by the Gauss-Newton Hessian J^T J.", lambda found: found.gauss_newton,
           head="by J^T J", format=".3g"),
    Column("bend", "Largest departure of a residual from its tangent one standard deviation away, in its own sigma.",
           lambda found: found.bend, format=".3f"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Laplace(Reported):
    """Gaussian approximations of the posterior: by the whole Hessian, and by J^T J (Gauss-Newton).

    Attributes
    ----------
    names, log
        The parameters, and which vary by their logarithm.
    sigma, gauss_newton
        Standard deviations by the whole Hessian and by J^T J, in decades for log parameters, (parameters,).
    bend
        Largest deviation of a residual from its tangent at one standard deviation, in the residual's sigma,
        (parameters,).

    Examples
    --------
    >>> import numpy as np
    >>> found = Laplace(names=("material.E",), log=(True,), covariance=np.array([[1e-4]]),
    ...                 gauss_newton=np.array([0.011]), bend=np.array([0.1]))
    >>> found.sigma.tolist()
    [0.01]
    """

    COLUMNS: ClassVar = COLUMNS

    names: tuple[str, ...]
    log: tuple[bool, ...]
    covariance: FloatArray
    gauss_newton: FloatArray
    bend: FloatArray

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, (parameters,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def to_json(self) -> dict[str, object]:
        """Plain data."""
        return {"kind": "laplace", "parameters": self.records()}

    def __repr__(self) -> str:
        """A row for each parameter."""
        return "\n".join(["posterior (Laplace)", *table_lines(self.COLUMNS, self.records())])


def laplace(fit: UpdateResult, near: Parabolas | None = None) -> Laplace:
    """The Laplace approximation of an update's posterior.

    Raises
    ------
    InputError
        If the solution is no minimum: the Hessian has a negative eigenvalue (a fit that stopped early).

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=7, rows=2, around=2))
    >>> measured = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 3).freq * 1.01, sigma_hz=0.01)
    >>> fit = cf.update(plate, measured, [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    >>> found = laplace(fit)
    >>> bool(abs(found.sigma[0] / found.gauss_newton[0] - 1.0) < 0.05)  # the residuals are nearly linear
    True
    """
    near = parabolas(fit) if near is None else near
    prior = np.diag(fit.given.prior**2)
    hessian = near.J.T @ near.J + prior + np.einsum("m,mpq->pq", near.r, near.H)
    unit = 1.0 / np.sqrt(np.diag(near.J.T @ near.J + prior))
    scaled = hessian * np.outer(unit, unit)
    lowest = float(np.linalg.eigvalsh(scaled)[0])
    if lowest <= 0.0:
        found = f"found a fit that is not a minimum of chi^2 (lowest curvature {lowest:.2g}, expected above 0)"
        raise InputError(f"posterior: {found}: {weakest(fit, scaled)}")
    C = np.linalg.inv(scaled) * np.outer(unit, unit)
    bend = np.array([0.5 * np.abs(near.H[:, k, k]).max() * fit.stated_sigma[k] ** 2 for k in range(len(fit.x))])
    return Laplace(
        names=tuple(p.name for p in fit.parameters),
        log=tuple(p.log for p in fit.parameters),
        covariance=C,
        gauss_newton=fit.stated_sigma,
        bend=bend,
    )


def varied_names(names: Sequence[str], log: Sequence[bool]) -> list[str]:
    """Names of the posterior's variables: parameters, or their decimal logarithms.

    >>> varied_names(["shell.thickness", "support.root.k_face"], [False, True])
    ['shell.thickness', 'log10 support.root.k_face']
    """
    return [f"log10 {name}" if decades else name for name, decades in zip(names, log, strict=True)]


def weakest(fit: UpdateResult, hessian: FloatArray) -> str:
    """Names of the parameters along the direction of lowest curvature."""
    direction = np.linalg.eigh(hessian)[1][:, 0]
    return ", ".join(fit.parameters[k].name for k in np.argsort(-np.abs(direction))[:2])
