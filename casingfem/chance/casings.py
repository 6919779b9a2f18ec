"""The casings of a family: their pairs, their rims and their bases, from one perfect casing."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from casingfem.chance.fields import RandomSeries
from casingfem.errors import NumericsError
from casingfem.io.arrays import Array, FloatArray, IntArray
from casingfem.modal.basis import ModalBasis
from casingfem.modal.family.family import perfect_shell
from casingfem.modal.family.splits import SplitMap
from casingfem.modal.interface.chart_rows import rim_shape
from casingfem.modal.interface.kinds import Rim
from casingfem.modal.reduction import reduce
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.shell.shell import Shell
from contact.model.bodies.modal_body import ModalBody
from contact.model.bodies.modal_checks import HIGHER, SQUARES

NEAR = 1e-2  # of a frequency: a mode of the basis and a wave with as many nodal diameters
SEEN = 1e-8  # of the largest radial motion squared: a rim does not see less
PROBE = 1e-3  # relative radius of the wave that the rim's shape is measured by
AROUND = 512  # angles at which a rim is looked at
TURNED = 1e-4  # how far modes of the two descriptions may differ from a rotation of each other


@dataclass(frozen=True, eq=False, kw_only=True)
class Casings:
    """A perfect casing and its random variants.

    Attributes
    ----------
    shell : one of the casings
    rim, modes, zeta : interface at the contact, number of modes, damping ratio
    pairs : map from imperfections to pairs
    random : function from random numbers to series
    """

    shell: Shell
    rim: Rim
    modes: int
    zeta: float
    pairs: SplitMap
    random: RandomSeries

    @classmethod
    def of(cls, shell: Shell, rim: Rim, modes: int, zeta: float) -> "Casings":
        """The casings of a shell with random fields, whose perfect casing must be a family."""
        pairs = SplitMap.of(shell, modes)
        assert pairs is not None  # `load` has refused what is none
        return cls(shell=shell, rim=rim, modes=modes, zeta=zeta, pairs=pairs, random=RandomSeries.of(shell))

    @cached_property
    def perfect(self) -> ModalBody:
        """The perfect casing's basis."""
        return ModalBody.of(self.reduced(self.modes))

    def reduced(self, modes: int) -> ModalBasis:
        """The perfect casing, reduced to this number of modes."""
        return reduce(perfect_shell(self.shell), self.rim, modes=modes, zeta=self.zeta)

    @cached_property
    def pair_of_mode(self) -> IntArray:
        """Index of the pair of each mode of the perfect basis, -1 for a mode without pair, (modes,)."""
        hz, radial = self.perfect.omega / (2.0 * np.pi), self.perfect.rows[: 2 * self.rim.n_max + 1]
        sines = np.vstack([np.zeros(hz.size), radial[self.rim.n_max + 1 :]])
        n = np.argmax(radial[: self.rim.n_max + 1] ** 2 + sines**2, axis=0)
        apart = np.abs(hz[:, None] / self.pairs.freq - 1.0) + (n[:, None] != self.pairs.n)
        return np.where(apart.min(axis=1) < NEAR, apart.argmin(axis=1), -1)

    def ratios(self, freq: FloatArray) -> FloatArray:
        """Frequencies of the modes over those of the perfect casing, by mean frequencies of pairs, (casings, modes)."""
        found = np.ones((len(freq), len(self.pair_of_mode)))
        known = self.pair_of_mode >= 0
        found[:, known] = (freq / self.pairs.freq)[:, self.pair_of_mode[known]]
        return found

    @cached_property
    def rim_factor(self) -> float:
        """Deviation of the rim's radius [m] per unit of the relative radius field."""
        perfect = perfect_shell(self.shell)
        if "radius" not in self.random.quantities:
            return 0.0
        p = min(2, self.rim.n_max)
        bent = replace(perfect, radius_defect=FourierField.of({p: PROBE}))
        return float(rim_shape(bent, self.rim)[0, p] / PROBE)

    def deviation(self, series: Array) -> Array:
        """Coefficients d_p of the deviation of the rims' radius [m], Re sum_p d_p e^(i p theta); (casings, p)."""
        top = series.shape[-1] // 2
        if "radius" not in self.random.quantities:
            return np.zeros((len(series), 1), dtype=complex)
        found = 2.0 * self.rim_factor * series[:, self.random.quantities.index("radius"), top:]
        found[:, 0] = 0.0  # a mean is part of the clearance
        return np.asarray(found)

    def bodies(self, series: Array) -> list[ModalBody]:
        """The bases of casings with the series F (casings, l, 2 p_max + 1), from their modes in the family's waves.

        Their lowest modes are kept. All others are static, with the residual compliance of the perfect casing.
        """
        found = self.pairs.lot(series)
        return [self.body(*each) for each in zip(found.value, found.root @ found.y, strict=True)]

    def body(self, value: FloatArray, y: FloatArray) -> ModalBody:
        """The basis of one casing with omega^2 `value` and modes `y` on the members of the family's waves."""
        wide = self.wide
        z = wide.turn.T @ y
        rest = z[:, self.modes :] / np.sqrt(value[self.modes :])
        kept, pushed = z[:, : self.modes], wide.body.rows @ rest
        squares = {
            name: kept.T @ given @ kept for name in SQUARES if (given := getattr(wide.body, name)) is not None
        } | {
            name: np.array([kept.T @ part @ kept for part in given])
            for name in HIGHER
            if (given := getattr(wide.body, name)) is not None
        }
        return replace(
            wide.body,
            omega=np.sqrt(value[: self.modes]),
            zeta=np.full(self.modes, self.zeta),
            rows=wide.body.rows @ kept,
            S=wide.body.S + pushed @ pushed.T,
            participation=None if wide.body.participation is None else wide.body.participation @ kept,
            out_of_roundness=None,
            **squares,
        )

    @cached_property
    def wide(self) -> "Wide":
        """The perfect casing with all waves of the family, and the relation of its modes to them."""
        return wide_of(ModalBody.of(self.reduced(len(self.pairs.window.kept))), self)


@dataclass(frozen=True, eq=False, slots=True)
class Wide:
    """A perfect casing's basis, and its modes by the members of the family: modes = members @ turn."""

    body: ModalBody
    turn: FloatArray


def wide_of(body: ModalBody, own: Casings) -> Wide:
    """Rotation of each pair, from the radial motion of both sides on the rim.

    A mode without motion of the rim is assigned to the next free wave, since its orientation does not matter there.
    """
    n, value, radial = members_of(own.pairs, own.rim)
    turn, top = np.zeros((len(n), body.omega.size)), body.n_max
    waiting, unseen = list(range(len(n))), []
    radially = body.rows[: 2 * top + 1]
    content = radially[: top + 1] ** 2 + np.vstack([np.zeros(body.omega.size), radially[top + 1 :] ** 2])
    for mode in range(body.omega.size):
        waves = int(content[:, mode].argmax())
        close = [k for k in waiting if n[k] == waves and abs(np.sqrt(value[k]) / body.omega[mode] - 1.0) < NEAR]
        if not close or content[waves, mode] < SEEN * content.max():
            unseen.append(mode)
            continue
        waiting.remove(close[0])
        if waves == 0:
            turn[close[0], mode] = np.sign(body.rows[0, mode] * radial[close[0]]) or 1.0
            continue
        both = np.flatnonzero((n == waves) & (value == value[close[0]]))
        seen = body.rows[[waves, top + waves], mode] / radial[close[0]]
        turn[both, mode] = seen / np.linalg.norm(seen)
    for mode, k in zip(unseen, sorted(waiting, key=lambda k: float(value[k])), strict=True):
        turn[k, mode] = 1.0
    off = float(np.abs(turn.T @ turn - np.eye(len(turn.T))).max())
    if off > TURNED:
        raise NumericsError(
            f"chance: found modes of the perfect casing that differ from its waves by {off:.1e}, expected at most "
            f"{TURNED:g}: take another number of modes in [reduce]"
        )
    return Wide(body, turn)


def members_of(pairs: SplitMap, rim: Rim) -> tuple[IntArray, FloatArray, FloatArray]:
    """Nodal diameters, omega^2 and radial motion at the rim of the members of the family's waves."""
    own, window, shell = pairs.expansion, pairs.window, pairs.expansion.shell
    motion = own.waves.motion[..., window.waves[window.of]]
    if rim.lines:
        (low, high), _ = np.real(shell.chart.bounds)
        heights = np.linspace(low, high, motion.shape[0])
        node = int(np.abs(heights - rim.lines[0]).argmin())
    else:
        node = 0 if shell.chart.edges[rim.edge][1] == 0 else -1
    n = window.n[window.of]
    return n, window.value[window.of], np.where(n > 0, np.sqrt(2.0), 1.0) * motion[node, 0].real
