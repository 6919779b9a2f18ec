"""Damping and stiffness of a rotating body over its speed, and the range of speeds at which they are known."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.base.arrays import Array
from contact.base.errors import InputError

ROUND = 1e-9  # of a speed: round-off beyond a range


def matrices_at(body: Any, omega_rotation: float) -> tuple[Array, Array]:
    """C [1/s] and K [1/s^2] at a speed [rad/s], (m, m) each; see `ModalBody`."""
    C, K = np.diag(2.0 * body.zeta * body.omega), np.diag(body.omega**2)
    if body.damping is not None:
        C += body.damping
    if body.gyroscopic is not None:
        C += omega_rotation * body.gyroscopic
    if body.stiffness is not None:
        K += body.stiffness
    x = omega_rotation**2 - body.spin**2
    if body.stiffness_by_speed is not None:
        K += x * body.stiffness_by_speed
    if body.gyroscopic_higher is not None:
        C += omega_rotation * _powers(x, body.gyroscopic_higher)
    if body.stiffness_higher is not None:
        K += x * _powers(x, body.stiffness_higher)
    return C, K


def powers_of_speed(body: Any) -> tuple[Array, Array]:
    """Coefficients of Omega, Omega^3, ... in C and of 1, Omega^2, ... in K; see `ModalBody.powers_of_speed`."""
    C = _unshifted(body.gyroscopic, body.gyroscopic_higher, body, 0)
    return C, _unshifted(body.stiffness_by_speed, body.stiffness_higher, body, 1)


def require_between(known: Array, omega_rotation: ArrayLike) -> None:
    """Raise InputError for speeds [rad/s] beyond the lowest and highest known one (2,)."""
    low, high = known / (2.0 * math.pi)
    hz = np.abs(np.ravel(omega_rotation)) / (2.0 * math.pi)
    out = hz[(hz < low * (1.0 - ROUND)) | (hz > high * (1.0 + ROUND))]
    if not out.size:
        return
    share = f" at {out.size} of {hz.size} speeds" if hz.size > 1 else ""
    raise InputError(
        f"speed: found {_span(float(out.min()), float(out.max()))}{share}, expected {_span(low, high)}, the range "
        "of this basis: set rotation.speed_hz of its study nearer to the speed and reduce it again"
    )


def _powers(x: float, parts: Array) -> Array:
    """Sum of x A_1 + x^2 A_2 + ... over parts (k, m, m)."""
    return np.asarray(np.tensordot(x ** np.arange(1.0, 1.0 + len(parts)), parts, 1))


def _unshifted(first: Array | None, higher: Array | None, body: Any, lowest: int) -> Array:
    """Coefficients of powers of Omega^2 for parts of powers of Omega^2 - spin^2 from the `lowest` power on."""
    m = body.omega.size
    own = [np.zeros((m, m)) if first is None else first, *(() if higher is None else higher)]
    found = np.zeros((len(own) + lowest, m, m))
    for j, part in enumerate(own, lowest):
        for i in range(j + 1):
            found[i] += math.comb(j, i) * (-(body.spin**2)) ** (j - i) * part
    return found


def _span(low: float, high: float) -> str:
    """A range of speeds [Hz] in Hz and rpm; one number where both ends are equal."""
    ends = (low,) if low == high else (low, high)
    hz, rpm = (" to ".join(format(by * end, ".5g") for end in ends) for by in (1.0, 60.0))
    return f"{hz} Hz ({rpm} rpm)"
