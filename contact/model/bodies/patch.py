"""A modal body that touches the ground at several points, with or without friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array, readonly, require_shape
from contact.base.errors import InputError
from contact.io.brief import brief
from contact.model.bodies.modal_body import ModalBody


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Patch:
    """k contacts of one modal body with rigid ground.

    Gap i: g_i = clearance_i + pressed_i + u of channel normal[i] (positive opens); its slip is the velocity of the
    channels tangent[i] less that of the ground, `slide` (k, 1 or 2) [m/s]. Without `tangent` there is no friction; with
    one channel each the contacts are two-dimensional, with two three-dimensional. Modal `displacement`, `velocity` at t
    = 0 and constant `load` (m,) are zero when left out; `pressed` (k,) [m] is the motion of the normals under the load
    through the residual compliance.

    Raises InputError for unknown channels, shapes that do not fit, gaps that are negative at t = 0.

    >>> block = ModalBody(omega=[1.0, 0.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
    >>> patch = Patch(body=block, normal=("y",), tangent=(("x",),), load=[0.0, -1.0], displacement=[1.0, 0.0])
    >>> patch.contacts, patch.dimensions
    (1, 2)
    """

    body: ModalBody
    normal: tuple[str, ...]
    tangent: tuple[tuple[str, ...], ...] = ()
    clearance: ArrayLike = 0.0
    slide: ArrayLike = 0.0
    displacement: ArrayLike | None = None
    velocity: ArrayLike | None = None
    load: ArrayLike | None = None
    pressed: ArrayLike = 0.0

    __repr__ = brief

    def __post_init__(self) -> None:
        _require_names("normal", self.normal)
        for names in (self.tangent, *self.tangent):
            _require_names("tangent", names)
        k, m = len(self.normal), self.body.omega.size
        if k == 0:
            raise InputError("normal: found no channel, expected one for each contact")
        widths = [len(pair) for pair in self.tangent]
        if self.tangent and (len(widths) != k or set(widths) not in ({1}, {2})):
            found = f"{len(widths)} entries of {', '.join(map(str, widths))} channels"
            raise InputError(f"tangent: found {found}, expected {k} entries of one channel each, or of two each")
        for name in (*self.normal, *(channel for pair in self.tangent for channel in pair)):
            self.body.channel(name)
        for name in ("clearance", "pressed"):
            object.__setattr__(self, name, _spread(name, getattr(self, name), (k,)))
        width = max(self.dimensions - 1, 1)
        object.__setattr__(self, "slide", _spread("slide", self.slide, (k, width)))
        for name in ("displacement", "velocity", "load"):
            given = getattr(self, name)
            values = readonly(np.zeros(m) if given is None else given)
            require_shape(name, values, (m,))
            object.__setattr__(self, name, values)
        clearance = np.asarray(self.clearance)
        gaps = clearance + self.rows()[:: self.dimensions] @ np.asarray(self.displacement)
        if gaps.min() < -1e-12 * max(1.0, float(np.abs(clearance).max())):
            worst = int(gaps.argmin())
            raise InputError(f"clearance: contact {worst + 1} penetrates by {-gaps[worst]:g} m at t = 0, expected >= 0")

    @property
    def contacts(self) -> int:
        """Number of contacts k."""
        return len(self.normal)

    @property
    def opening(self) -> Array:
        """Gaps when the modes are at rest under the load, (k,) [m].

        Negative where the residual compliance is compressed.
        """
        opening: Array = np.asarray(self.clearance) + np.asarray(self.pressed)
        return opening

    @property
    def load_response(self) -> float:
        """f^T M^-1 f of the constant loads [J/s^2]."""
        load = np.asarray(self.load)
        return float(load @ load)

    @property
    def dimensions(self) -> int:
        """1 without friction, else 2 or 3."""
        return 1 + (len(self.tangent[0]) if self.tangent else 0)

    def channels(self) -> list[int]:
        """Channels of the body in the order normal, tangent(s), contact by contact."""
        tangents = self.tangent or ((),) * self.contacts
        names = [name for n, pair in zip(self.normal, tangents, strict=True) for name in (n, *pair)]
        return [self.body.channel(name) for name in names]

    def rows(self) -> Array:
        """Contact rows, (k dimensions, m)."""
        return self.body.rows[self.channels()]

    def compliance(self) -> Array:
        """Residual compliance between the contact directions, (k dimensions, k dimensions)."""
        chosen = self.channels()
        return self.body.S[np.ix_(chosen, chosen)]


def _spread(name: str, value: object, shape: tuple[int, ...]) -> Array:
    """A number for all contacts, or one for each; raises InputError unless all are finite and there is one for each."""
    given = np.asarray(value, float)
    if not np.isfinite(given).all():
        raise InputError(f"{name}: found {given.tolist()}, expected finite numbers")
    try:
        return readonly(np.broadcast_to(given, shape))
    except ValueError:
        raise InputError(f"{name}: found shape {given.shape}, expected a number, or {shape}") from None


def _require_names(name: str, given: object) -> None:
    """Raise InputError for a text, whose letters would be read as names."""
    if isinstance(given, str):
        raise InputError(f"{name}: found the text {given!r}, expected a tuple of channel names")
