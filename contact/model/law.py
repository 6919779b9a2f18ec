"""Contact laws, and the one place where the sign of the contact force is stated.

Sign
----
Public convention, that of the source study: gap g >= 0, contact pressure lam <= 0, g lam = 0. `Result.lam` is
in this sign. Everything else (loops, `Result.force`, impulse, files) uses the compressive *force* >= 0: force = -lam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Protocol, TypeVar

from contact.base.arrays import Array, require_count, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.io.keys import Key
from contact.model.laws.force_law import Response, spring

Depth = TypeVar("Depth", float, Array)
MOST_BARS = 10_000  # under a tip


def pressure(force: Array) -> Array:
    """Contact pressure in the public sign, lam = -force <= 0."""
    return -force


class Law(Protocol):
    """Interface of a contact law for schemes; a law of your own sets unused parts to zero or None.

    `stiffness` [N/m] of a spring in the contact, 0 for a rigid one; `updates` of multipliers in a step, to a
    `tolerance` [m]; `mu` of friction; `coating` that wears; `response` of a compliant contact.
    """

    @property
    def words(self) -> str:
        """Name in the label of a run."""

    @property
    def stiffness(self) -> float:
        """Stiffness of the contact spring [N/m]; 0: rigid."""

    @property
    def updates(self) -> int:
        """Multiplier updates in a step; 0: none."""

    @property
    def tolerance(self) -> float:
        """Tolerance at which updates end [m]."""

    @property
    def mu(self) -> float:
        """Coefficient of friction; 0: none."""

    @property
    def coating(self) -> Abradable | None:
        """The abradable coating, or None."""

    @property
    def response(self) -> Response | None:
        """Force and slope at a depth; None for a rigid contact or a coating."""


def kind(law: Law) -> str:
    """Name of the class in this module by whose rules schemes treat the law.

    >>> kind(Penalty(stiffness=1e6)), kind(Coulomb(mu=0.0))
    ('Penalty', 'Coulomb')
    """
    if law.coating is not None:
        return "Abradable"
    if law.stiffness > 0.0:
        return "AugmentedLagrangian" if law.updates > 0 else "Penalty"
    if law.response is not None:
        return "ForceLaw"
    return "Coulomb" if law.mu > 0.0 or law.words == Coulomb.words else "Unilateral"


@dataclass(frozen=True, slots=True, kw_only=True)
class Unilateral:
    """Rigid frictionless contact: g >= 0, lam <= 0, g lam = 0 (Signorini).

    >>> Unilateral()
    Unilateral()
    """

    words: ClassVar[str] = "Lagrange"
    stiffness: ClassVar[float] = 0.0
    updates: ClassVar[int] = 0
    tolerance: ClassVar[float] = 0.0
    mu: ClassVar[float] = 0.0
    coating: ClassVar[None] = None
    response: ClassVar[None] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Penalty:
    """Contact spring: force = stiffness <-g>, so the gap becomes negative; `stiffness` [N/m] > 0.

    >>> Penalty(stiffness=1e9).stiffness
    1000000000.0
    """

    stiffness: float
    updates: ClassVar[int] = 0
    tolerance: ClassVar[float] = 0.0
    mu: ClassVar[float] = 0.0
    coating: ClassVar[None] = None

    def __post_init__(self) -> None:
        require_positive(stiffness=self.stiffness)

    @property
    def words(self) -> str:
        """Name in the label of a run."""
        return f"penalty {self.stiffness:.3g} N/m"

    @property
    def response(self) -> Response:
        """Force and slope of the spring."""
        return Response(spring, (self.stiffness, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Coulomb:
    """Rigid contact with friction of coefficient `mu` >= 0: |force_T| <= mu force_N, in slip -mu force_N v_T/|v_T|.

    A tip sticks if a force inside the cone keeps it at rest. `Result.reversals` counts the contact steps in which a
    single tip slips against the direction of rotation.

    >>> Coulomb(mu=0.3).mu
    0.3
    """

    mu: float
    words: ClassVar[str] = "Coulomb"
    stiffness: ClassVar[float] = 0.0
    updates: ClassVar[int] = 0
    tolerance: ClassVar[float] = 0.0
    coating: ClassVar[None] = None
    response: ClassVar[None] = None

    def __post_init__(self) -> None:
        require_not_negative(mu=self.mu)


@dataclass(frozen=True, slots=True, kw_only=True)
class Abradable:
    """Coating of a rim: adjacent bars around it, elastic-plastic with linear hardening; plastic flow is wear.

    A bar of length `thickness` whose surface the tip has pressed by d has the stress E (d - w)/thickness. Where that
    exceeds `yield_stress` + `hardening` w/thickness it flows and its worn depth w grows (M. Legrand, A. Batailly, C.
    Pierre, J. Comput. Nonlinear Dyn. 7, 2012, 011018). At w = thickness the casing is bare: the surface there is as
    stiff as the bars and yields no further.

    `E`, `yield_stress`, `hardening` [Pa]; `thickness` [m]; the tip covers `width` [m] along the axis and `tip` [m]
    around, `bars` of them; `machined` [m] is cut before the run, from the rim's highest point to a
    circle; `mu` of friction, as for `Coulomb`.

    >>> coating = Abradable(E=1e9, yield_stress=5e6, hardening=1e8, thickness=2e-3, width=0.04, tip=2e-3)
    >>> coating.stress(1e-4), round(coating.dissipated(1e-4))
    (10000000.0, 750)
    """

    E: Annotated[float, Key("Young's modulus [Pa]", "positive", "E")]
    yield_stress: Annotated[float, Key("stress at which the coating wears [Pa]", "positive", "stress")]
    hardening: Annotated[
        float, Key("slope of the stress over plastic strain above this stress [Pa]", "not negative", "stress")
    ]
    thickness: Annotated[float, Key("thickness [m]", "positive", "thickness")]
    width: Annotated[float, Key("width of the strip along the axis [m]", "positive", "reach")]
    tip: Annotated[float, Key("length of a blade's tip around the rim [m]", "positive", "reach")]
    bars: Annotated[int, Key("number of bars of the coating under a tip", most=MOST_BARS)] = 6
    machined: Annotated[
        float,
        Key(
            "depth that is machined to a circle before the run, at the rim's highest point [m]",
            "not negative",
            "clearance",
        ),
    ] = 0.0
    mu: float = 0.0
    words: ClassVar[str] = "abradable coating"
    stiffness: ClassVar[float] = 0.0
    updates: ClassVar[int] = 0
    tolerance: ClassVar[float] = 0.0
    response: ClassVar[None] = None

    def __post_init__(self) -> None:
        require_positive(E=self.E, yield_stress=self.yield_stress, thickness=self.thickness, width=self.width)
        require_positive(tip=self.tip)
        require_not_negative(hardening=self.hardening, machined=self.machined, mu=self.mu)
        if self.machined > self.thickness:
            expected = f"at most the thickness {self.thickness:g} m"
            raise InputError(f"machined: found {self.machined:g} m, expected {expected}")
        require_count(bars=self.bars)
        if self.bars > MOST_BARS:
            expected = f"a whole number from 1 to {MOST_BARS:,} under the tip"
            raise InputError(f"bars: found {self.bars!r}, expected {expected}")

    @property
    def coating(self) -> Abradable:
        """The law itself."""
        return self

    @property
    def under_tip(self) -> float:
        """Elastic stiffness of all bars under a tip [N/m]."""
        return self.E * self.width * self.tip / self.thickness

    def stress(self, worn: Depth) -> Depth:
        """Stress at which a bar with this worn depth [m] yields [Pa]."""
        return self.yield_stress + self.hardening * worn / self.thickness

    def dissipated(self, worn: Depth) -> Depth:
        """Energy of wearing a bar to this depth, per area [J/m^2]: integral of the stress over the depth."""
        return worn * self.stress(0.5 * worn)
