"""The least-squares problem of an update: residuals and Jacobian at solver variables, with tracked modes."""

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from casingfem.experiment.correlation.frequency_unit import refuse_unpaired
from casingfem.experiment.correlation.pairing import Pairing, pair
from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.io.arrays import FloatArray, frozen
from casingfem.modal.modes import MeshModes, Modes, modes
from casingfem.modal.neighbour import Solution, counted, solved, solved_near
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.shell import Shell, remade
from casingfem.structure.shell.system import System
from casingfem.updating.addresses import get_value, with_value
from casingfem.updating.following import LostModeError, followed, paired_rows
from casingfem.updating.parameters import Parameter
from casingfem.updating.shapes import SensorShapes, shape_jacobian, shape_values
from casingfem.updating.targets import Rates, jacobian, rates, values
from contact.io.brief import brief
from contact.io.progress import quietly

Progress = Callable[[int, float], None]  # (evaluation, RMS of the weighted residuals)


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """One evaluated point; `solution` is None for perfect casings, whose harmonics are solved separately."""

    shell: Shell | MeshStructure
    modes: Modes | MeshModes
    solution: Solution | None
    pairing: Pairing
    values: FloatArray


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Given:
    """Inputs of a problem, frozen; a result keeps them to set up the problem again after the fit.

    `prior` and `exact` are the final ones of the fit; the others are as in `Problem`.
    """

    shell: Shell | MeshStructure
    table: FrequencyTable
    vary: tuple[Parameter, ...]
    count: int
    reach: float
    shapes: SensorShapes | None
    start: FloatArray
    prior: FloatArray
    exact: bool

    __repr__ = brief

    def with_priors(self, x: FloatArray, values: FloatArray, jacobian: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Residuals of the data at x and their Jacobian, with the rows of the priors below."""
        held = self.prior > 0.0
        away = (self.prior * (x - self.start))[held]
        return np.concatenate([values, away]), np.vstack([jacobian, np.diag(self.prior)[held]])

    def problem(self) -> "Problem":
        """Set up a problem without evaluated points."""
        made = Problem(self.shell, self.table, self.vary, self.count, self.reach, shapes=self.shapes, exact=self.exact)
        made.prior = self.prior
        return made


@dataclass(eq=False)
class Problem:
    """Residuals and Jacobian of an update, in the form that least-squares solvers need.

    The last evaluated point is kept, since the Jacobian is needed after the residual. `anchor` is the last point with a
    Jacobian, which the solver has accepted; modes are tracked and restarted from there. `prior` is one over the
    standard deviations of the regularisation towards the start, 0 for none. With `exact` every point is solved without
    a restart.
    """

    shell: Shell | MeshStructure
    table: FrequencyTable  # with the model's error in its sigma
    vary: Sequence[Parameter]
    count: int
    reach: float
    progress: Progress | None = None
    shapes: SensorShapes | None = None
    exact: bool = False
    shapes_wait: bool = False  # shapes pair rows, but are not fitted yet
    system: System | None = None  # the shell as given, assembled; used up by its first solution
    start: FloatArray = field(init=False)
    prior: FloatArray = field(init=False)
    history: list[float] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    lost: LostModeError | None = None
    anchor: State | None = None
    _key: bytes = b""
    _state: State | None = None
    _jacobian: FloatArray | None = None
    _rates: tuple[FloatArray, list[tuple[tuple[int, ...], tuple[int, ...]]], Rates] | None = None

    def __post_init__(self) -> None:
        self.start = np.array([p.to_internal(get_value(self.shell, p.name)) for p in self.vary], dtype=float)
        self.prior = np.array([0.0 if p.sigma is None else 1.0 / p.sigma for p in self.vary])

    @property
    def given(self) -> Given:
        """The inputs of the problem."""
        return Given(
            shell=self.shell, table=self.table, vary=tuple(self.vary), count=self.count, reach=self.reach,
            shapes=self.shapes, start=frozen(self.start), prior=frozen(self.prior), exact=self.exact,
        )  # fmt: skip

    def structure(self, x: FloatArray) -> Shell | MeshStructure:
        """The shell at solver variables x, fully checked; unchanged at the start."""
        if np.array_equal(x, self.start):
            return self.shell
        bare = remade(ShellParts, self.shell) if isinstance(self.shell, Shell) else self.shell
        for parameter, value in zip(self.vary, x, strict=True):
            bare = with_value(bare, parameter.name, float(parameter.from_internal(value)))
        return remade(Shell, bare) if isinstance(bare, ShellParts) else bare

    def state(self, x: FloatArray) -> State:
        """Modes, pairing and residuals at x.

        Raises
        ------
        LostModeError
            If a mode with a row cannot be tracked to that point.
        """
        key = np.asarray(x, dtype=float).tobytes()
        if self._state is None or key != self._key:
            with quietly():
                state = self._evaluated(self.structure(x))
            self.adopt(x, state)
            self.history.append(float(np.sqrt(np.mean(state.values**2))))
            if self.progress is not None:
                self.progress(len(self.history), self.history[-1])
        assert self._state is not None
        return self._state

    def paired_anew(self, x: FloatArray) -> State:
        """Evaluate x with new pairing by label and frequency; modes are tracked from there from now on."""
        state = self.state(x)
        self.anchor = None
        fresh = self._make(state.modes, state.solution, self._pairing(state.modes))
        self.adopt(x, fresh)
        self.anchor = fresh
        return fresh

    def begin_at(self, x: FloatArray, known: State) -> None:
        """Use the modes of a point that another problem of the same structure has solved; rows are paired anew."""
        self.adopt(x, self._make(known.modes, known.solution, self._pairing(known.modes)))

    def solve_afresh(self) -> None:
        """Solve every point without a restart from now on."""
        self.exact, self.anchor, self._state = True, None, None

    def counted(self, x: FloatArray) -> State | None:
        """Evaluate x with its modes counted; return None if some are missing."""
        state = self.state(x)
        if state.solution is None:
            return state
        whole = counted(state.solution)
        return None if whole is None else replace(state, solution=whole, modes=whole.modes)

    def fun(self, x: FloatArray) -> FloatArray:
        """Weighted residuals, followed by those of the priors."""
        held = self.prior > 0.0
        return np.concatenate([self.state(x).values, (self.prior * (x - self.start))[held]])

    def jac(self, x: FloatArray) -> FloatArray:
        """Derivatives of the residuals of `fun`."""
        return np.vstack([self.data_jacobian(x), np.diag(self.prior)[self.prior > 0.0]])

    def data_jacobian(self, x: FloatArray) -> FloatArray:
        """Derivatives of the data's residuals; modes are tracked from x from now on."""
        state = self.state(x)
        self.anchor = state
        if self._jacobian is None:
            started = time.perf_counter()
            matches = state.pairing.matches
            self._jacobian = jacobian(state.modes, self.table, matches, self._rates_at(state))
            if self.shapes is not None and state.solution is not None and not self.shapes_wait:
                shaped = shape_jacobian(state.solution, self.vary, self.shapes, matches)
                self._jacobian = np.vstack([self._jacobian, shaped])
            self.seconds["sensitivities"] += time.perf_counter() - started
        return self._jacobian

    def _rates_at(self, state: State) -> Rates:
        """Rates at a point: those of the last one, if modes and pairs are the same."""
        fields, pairs = state.modes.fields, [(match.rows, match.modes) for match in state.pairing.matches]
        if self._rates is None or self._rates[0] is not fields or self._rates[1] != pairs:
            at = rates(state.modes, state.solution, self.vary, self.table, state.pairing.matches)
            self._rates = fields, pairs, at
        return self._rates[2]

    def _evaluated(self, shell: Shell | MeshStructure) -> State:
        """Modes of a structure, tracked from the anchor; with half as many more modes if one is not found at first.

        A new pairing in the same groups is used if it fits better: if two modes have mixed, their labels decide.
        """
        found, solution = self._solve(shell, self.count)
        fresh = self._make(found, solution, self._pairing(found))
        if self.anchor is None:
            return fresh
        same = paired_rows(fresh.pairing) == paired_rows(self.anchor.pairing)
        try:
            carried = self._followed(found, solution)
        except LostModeError as error:
            if same:
                return fresh
            self.lost = error
            carried = self._followed(*self._solve(shell, self.count + max(8, self.count // 2)))
            self.lost = None
        return fresh if same and np.sum(fresh.values**2) < np.sum(carried.values**2) else carried

    def _followed(self, found: Modes | MeshModes, solution: Solution | None) -> State:
        assert self.anchor is not None
        started = time.perf_counter()
        try:
            pairing = followed(self.anchor.pairing, self.anchor.modes, found, self.table)
        finally:
            self.seconds["pairing"] += time.perf_counter() - started
        return self._make(found, solution, pairing)

    def _solve(self, shell: Shell | MeshStructure, count: int) -> tuple[Modes | MeshModes, Solution | None]:
        found: Modes | MeshModes
        solution: Solution | None = None
        if not isinstance(shell, Shell) or (shell.axisymmetric and self.shapes is None):
            found = modes(shell, count)
        else:
            known = None if self.exact or count > self.count or self.anchor is None else self.anchor.solution
            if known is None:
                system, self.system = self.system if shell is self.shell else None, None
                solution = solved(shell, count, system)
            else:
                solution = solved_near(shell, known, count)
            found = solution.modes
        for part, spent in found.seconds.items():
            self.seconds[part] += spent
        return found, solution

    def _pairing(self, found: Modes | MeshModes) -> Pairing:
        """The pairing of the rows by label and frequency."""
        started = time.perf_counter()
        alike = self.shapes.mac(found) if self.shapes is not None and isinstance(found, Modes) else None
        pairing = pair(found, self.table, reach=self.reach, shape_mac=alike)
        self.seconds["pairing"] += time.perf_counter() - started
        if not pairing.matches:
            refuse_unpaired(self.table, found.freq, getattr(found, "nodal_diameters", None), self.reach)
        return pairing

    def _make(self, found: Modes | MeshModes, solution: Solution | None, pairing: Pairing) -> State:
        pairing = replace(pairing, matches=tuple(sorted(pairing.matches, key=lambda match: match.rows)))
        residual = values(found, self.table, pairing.matches)
        if self.shapes is not None and not self.shapes_wait and isinstance(found, Modes):
            residual = np.append(residual, shape_values(found, self.shapes, pairing.matches))
        return State(found.structure, found, solution, pairing, residual)

    def adopt(self, x: FloatArray, state: State) -> None:
        """Make a point the current one."""
        self._key, self._state, self._jacobian = np.asarray(x, dtype=float).tobytes(), state, None
