"""Sample the posterior with emcee, from second-order residuals of the update, within its bounds and priors.

The affine-invariant ensemble sampler (Goodman & Weare, Comm. App. Math. Comp. Sci. 5, 2010, 65) by emcee
(Foreman-Mackey et al., PASP 125, 2013, 306), extra `sampling`. The density is exp(-1/2 |r|^2 - 1/2 |prior|^2) with r to
second order (`posterior.parabolas`); some samples are evaluated with their own modes to measure the error of this
expansion.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from casingfem.errors import InputError, MissingExtraError
from casingfem.extras import remedy
from casingfem.io.arrays import FloatArray
from casingfem.updating.result import UpdateResult
from casingfem.updating.uncertainty.posterior import Parabolas, at_solution, evaluated, parabolas, varied_names
from contact.io.columns import Column, mark, table_lines, word
from contact.io.reported import Reported

LEVELS = (0.025, 0.5, 0.975)


def quantile(level: float) -> Callable[["PosteriorSamples"], FloatArray]:
    """Quantile of each parameter at a given share of the samples."""
    return lambda found: np.asarray(np.quantile(found.samples, level, axis=0))


COLUMNS = (
    Column("name", "Address of the parameter.", lambda found: found.names, head="parameter", format=word),
    Column("log", "Whether the parameter varies in log10; its numbers are decimal logarithms then.",
           lambda found: found.log, head="values", format=mark("log10")),
    *(Column(name, f"Value below which {100 * level:g} % of the samples lie.", quantile(level),
             head=f"{100 * level:g} %", format=".5g")
      for name, level in zip(("low", "median", "high"), LEVELS, strict=True)),
    Column("sigma", "Standard deviation of the samples.", lambda found: found.sigma, format=".3g"),
    Column("gauss_newton", "Standard deviation by the Gauss-Newton Hessian J^T J.", lambda found: found.gauss_newton,
           head="by J^T J", format=".3g"),
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PosteriorSamples(Reported):
    """Samples of a posterior in the solver's variables (decades for log parameters).

    Attributes
    ----------
    names, log
        The parameters, and which vary by their logarithm.
    samples
        (samples, parameters), thinned until nearly independent; decimal logarithms of log parameters.
    gauss_newton
        Standard deviations of (J^T J)^-1, (parameters,).
    acceptance, autocorrelation
        Accepted share of the moves, and the longest autocorrelation time of the chains [steps].
    gap
        Largest difference between the second-order residuals and those from computed modes, over some samples, in
        sigma.

    Examples
    --------
    >>> found = PosteriorSamples(names=("material.E",), log=(False,), samples=np.array([[1.0], [3.0]]),
    ...                          gauss_newton=np.ones(1), acceptance=0.4, autocorrelation=20.0, gap=0.01)
    >>> found.sigma.round(3).tolist()
    [1.414]
    """

    COLUMNS: ClassVar = COLUMNS

    names: tuple[str, ...]
    log: tuple[bool, ...]
    samples: FloatArray
    gauss_newton: FloatArray
    acceptance: float
    autocorrelation: float
    gap: float

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, (parameters,)."""
        return np.asarray(self.samples.std(axis=0, ddof=1))

    def columns(self) -> dict[str, FloatArray]:
        """One row for each sample, one column for each parameter."""
        return dict(zip(varied_names(self.names, self.log), self.samples.T, strict=True))

    def to_json(self) -> dict[str, object]:
        """Plain data."""
        return {
            "kind": "emcee",
            "parameters": list(self.records()),
            "levels": list(LEVELS),
            "samples": len(self.samples),
            "acceptance": self.acceptance,
            "autocorrelation": self.autocorrelation,
            "gap": self.gap,
        }

    def __repr__(self) -> str:
        """Quantiles of each parameter, and the quality of the chains."""
        lines = ["posterior (emcee)", *table_lines(self.COLUMNS, self.records())]
        lines.append(
            f"{len(self.samples)} samples, {self.acceptance:.0%} of the moves accepted, autocorrelation time "
            f"{self.autocorrelation:.0f} steps; error of the quadratic model of the residuals: {self.gap:.2g} sigma"
        )
        return "\n".join(lines)


def sample_posterior(fit: UpdateResult, *, steps: int = 3000, seed: int = 20, checks: int = 4) -> PosteriorSamples:
    """Sample the posterior of an update.

    Parameters
    ----------
    fit
        The update.
    steps
        Steps of each of 4 p + 8 walkers; the first third is left out.
    seed
        Seed of the walkers.
    checks
        Number of samples evaluated with computed modes.

    Raises
    ------
    MissingExtraError
        Without emcee.
    InputError
        If the chains are too short to be independent of their start.

    Examples
    --------
    >>> import casingfem as cf
    >>> plate = cf.Shell(chart=cf.Plate(length=0.2, width=0.1), thickness=1e-3, supports={"root": cf.Clamped()},
    ...                  material=cf.Material(E=200e9, nu=0.3, rho=7800.0),
    ...                  mesh=cf.ShellMesh(order=7, rows=2, around=2))
    >>> measured = cf.FrequencyTable.from_arrays(freq_hz=cf.modes(plate, 3).freq * 1.01, sigma_hz=0.01)
    >>> fit = cf.update(plate, measured, [cf.Parameter(name="material.E", lower=150e9, upper=250e9)])
    >>> found = sample_posterior(fit, steps=400, seed=20, checks=1)
    >>> found.names, bool(abs(found.sigma[0] / found.gauss_newton[0] - 1.0) < 0.5)
    (('material.E',), True)
    """
    try:
        import emcee
    except ImportError as error:
        raise MissingExtraError(f'posterior = "emcee" needs the package emcee: {remedy("sampling")}') from error
    near = parabolas(fit)
    random = np.random.default_rng(seed)
    walkers = 4 * len(fit.x) + 8
    first = fit.x + fit.stated_sigma * random.standard_normal((walkers, len(fit.x)))
    first = np.clip(first, fit.lower, fit.upper)
    sampler = emcee.EnsembleSampler(walkers, len(fit.x), lambda x: log_density(x, fit, near), vectorize=True)
    state = np.random.RandomState(seed).get_state()  # the kind that emcee keeps
    sampler.run_mcmc(emcee.State(first, random_state=state), steps, skip_initial_state_check=True)
    forgotten = float(np.max(sampler.get_autocorr_time(quiet=True, tol=0)))
    if not steps > 20.0 * forgotten:
        expected = (
            f"expected at least {int(20.0 * forgotten) + 1}, 20 times their autocorrelation time: take more steps"
        )
        raise InputError(f"posterior: found chains of {steps} steps, {expected}")
    samples = sampler.get_chain(discard=steps // 3, thin=max(1, int(forgotten / 2.0)), flat=True)
    return PosteriorSamples(
        names=tuple(p.name for p in fit.parameters),
        log=tuple(p.log for p in fit.parameters),
        samples=samples,
        gauss_newton=fit.stated_sigma,
        acceptance=float(np.mean(sampler.acceptance_fraction)),
        autocorrelation=forgotten,
        gap=worst_gap(fit, near, samples[random.choice(len(samples), checks, replace=False)]),
    )


def log_density(x: FloatArray, fit: UpdateResult, near: Parabolas) -> FloatArray:
    """Logarithm of the posterior at points (points, parameters), up to a constant."""
    prior = fit.given.prior * (x - fit.given.start)
    density = -0.5 * (np.sum(near(x) ** 2, axis=1) + np.sum(prior**2, axis=1))
    inside = np.all((x >= fit.lower) & (x <= fit.upper), axis=1)
    return np.where(inside, density, -np.inf)


def worst_gap(fit: UpdateResult, near: Parabolas, points: FloatArray) -> float:
    """Largest difference between second-order residuals and those from computed modes at some points, in sigma."""
    problem = at_solution(fit)
    return max(float(np.abs(evaluated(problem, x)[0] - near(x)[0]).max()) for x in points)
