"""Energy budget of a run: stored, supplied, dissipated and unaccounted energy; and why a run diverged."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """Energy at one time [J]; `residual` = lam S lam/2 is the energy in the compliance of omitted modes.

    `discrete` is the kinetic + strain + potential energy in the scheme's own quadratic form, whose balance is an
    identity: D^T M D/(2 h^2) + u_{n-1}^T K u_n/2 - f^T (u_n + u_{n-1})/2, D = u_n - u_{n-1}.

    >>> one = Stored(kinetic=1.0, strain=0.5, potential=0.0, residual=0.1, discrete=1.6)
    >>> round(one.total, 3)
    1.6
    """

    kinetic: float
    strain: float
    potential: float
    residual: float
    discrete: float

    @property
    def total(self) -> float:
        """Kinetic + strain + potential + residual [J]."""
        return self.kinetic + self.strain + self.potential + self.residual


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBudget:
    """end - start = work of contact, rotation, friction, damping and loads + numerical + unaccounted [J].

    `contact` is the work of the contact forces along the gaps, in leapfrog schemes sum lam_n (g_{n+1} - g_{n-1})/2;
    `rotation` the work due to the motion of the contact point over the rim, `friction` = work of the tangential force
    on the bodies, `damping` <= 0, `external` that of loads that vary in time, `body_force` that of gravity on a
    rotating body and of a whirling frame. Constant loads (gravity) have a potential and need no work term.
    `algorithmic` is the energy that the scheme adds, by its own formulas (`scheme.protocol`, 5); `numerical` is that
    and the difference between the energies and their discrete form. `unaccounted` is round-off, or an error of a
    scheme. `load_step` = h^2 f^T M^-1 f is the work of the constant loads over one step from rest: since schemes
    evaluate energy at half steps, the work of contact may be in error by this amount. `overlap` bounds the work of
    separating bodies that overlap at t = 0: the largest forces times the overlap.

    >>> a = Stored(kinetic=2.0, strain=0.0, potential=0.0, residual=0.0, discrete=2.0)
    >>> b = Stored(kinetic=1.5, strain=0.25, potential=0.0, residual=0.0, discrete=1.75)
    >>> budget = EnergyBudget(start=a, end=b, contact=-0.25, rotation=0.0, friction=0.0, damping=0.0)
    >>> budget.lost_in_contact, budget.unaccounted
    (0.25, 0.0)
    """

    start: Stored
    end: Stored
    contact: float
    rotation: float
    friction: float
    damping: float
    external: float = 0.0
    body_force: float = 0.0
    algorithmic: float = 0.0
    load_step: float = 0.0
    overlap: float = 0.0

    __repr__ = brief

    @property
    def lost_in_contact(self) -> float:
        """Energy lost in impacts [J], positive; energy stored in S at the end is not lost."""
        return -self.contact - (self.end.residual - self.start.residual)

    @property
    def explained(self) -> float:
        """Energy that contact may appear to add without an error of the scheme [J]."""
        return self.load_step + self.overlap

    @property
    def numerical(self) -> float:
        """Energy the scheme adds [J]: its algorithmic part, and the part outside its discrete form."""
        discrete = self.end.discrete - self.start.discrete
        seen = (self.end.total - self.end.residual) - (self.start.total - self.start.residual) - discrete
        return self.algorithmic + seen

    @property
    def unaccounted(self) -> float:
        """Change of discrete energy minus all work [J]: round-off."""
        work = self.contact + self.rotation + self.friction + self.damping + self.external + self.body_force
        work += self.algorithmic
        return self.end.discrete - self.start.discrete - work

    @property
    def others(self) -> float:
        """Initial energy, and energy exchanged with everything except the contact [J]; sum of absolute values."""
        start, fell = self.start, self.start.potential - self.end.potential
        parts = (start.kinetic, start.strain, start.residual, fell, self.rotation, self.friction, self.external,
                 self.body_force, self.load_step)  # fmt: skip
        return sum(map(abs, parts))

    def since(self, earlier: EnergyBudget) -> EnergyBudget:
        """Change since an earlier budget of the same run."""
        works = ("contact", "rotation", "friction", "damping", "external", "body_force", "algorithmic")
        since = {name: getattr(self, name) - getattr(earlier, name) for name in works}
        return replace(self, start=earlier.end, **since)

    @property
    def scale(self) -> float:
        """Largest energy of the budget [J], for comparison with `unaccounted`."""
        ends = (self.start, self.end)
        parts = [value for s in ends for value in (s.kinetic, s.strain, s.potential)]
        parts += (self.contact, self.rotation, self.friction, self.external, self.body_force)
        return max(map(abs, parts))

    def to_dict(self) -> dict[str, object]:
        """Totals first, then parts; ready for JSON."""
        return {
            "start": self.start.total, "end": self.end.total, "lost_in_contact": self.lost_in_contact,
            "unaccounted": self.unaccounted, "rotation": self.rotation, "friction": self.friction,
            "damping": self.damping, "external": self.external, "body_force": self.body_force,
            "numerical": self.numerical,
            "parts": {"start": asdict(self.start), "end": asdict(self.end)},
        }  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Divergence:
    """The limit that a run passed after `step` steps, at `time` [s], and the motion that led to it.

    `limit`: "wall" (half of its thickness), "radius" (a tenth of it), "gap" (contacts on the ground), "rotor" (without
    a casing), "energy" or "overflow". `reached` and `allowed` in metres, for the energy in joules, nan for an overflow.
    `growth` [1/s] of the force's variation just before, nan with too few samples; `theory` [1/s] of a permanently
    closed contact at this speed, nan without poles. `words`: all of this as text, and what limits such a motion in
    reality.

    >>> Divergence(limit="wall", step=5, time=1e-3, reached=2e-3, allowed=1.5e-3, words="").to_dict()["growth_1_s"]
    """

    limit: str
    step: int
    time: float
    reached: float
    allowed: float
    words: str
    growth: float = math.nan
    theory: float = math.nan

    def to_dict(self) -> dict[str, object]:
        """JSON-ready."""
        named = {"reached": self.reached, "allowed": self.allowed, "growth_1_s": self.growth, "theory_1_s": self.theory}
        found: dict[str, object] = {name: value if math.isfinite(value) else None for name, value in named.items()}
        return {"limit": self.limit, "step": self.step, "time": self.time, **found, "words": self.words}
