"""Checks of the arrays of a modal body: shapes, names of channels, frequencies, a skew gyroscopic matrix."""

from __future__ import annotations

from typing import Any

import numpy as np

from contact.base.arrays import Array, require_not_negative, require_positive, require_shape
from contact.base.errors import InputError
from contact.io.names import names_fault
from contact.io.npz import compliance_fault
from contact.model.bodies.channels import rim_channels

OPTIONAL = (
    "recovery", "recovery_S", "recovery_points", "recovery_cells", "lines", "line_thickness", "output_rows", "output_S",
    "gyroscopic", "stiffness_by_speed", "gyroscopic_higher", "stiffness_higher", "damping", "stiffness",
    "participation", "out_of_roundness", "known_speeds",
)  # fmt: skip
SQUARES = ("gyroscopic", "stiffness_by_speed", "damping", "stiffness")  # (m, m), of the modes
HIGHER = ("gyroscopic_higher", "stiffness_higher")  # (k, m, m)
LEAST_OMEGA = 1e-50  # rad/s: the square of less has few digits or none
SKEW = 1e-8  # of the largest entry: symmetric part of a gyroscopic matrix that is round-off


def check(body: Any) -> None:
    """Refuse arrays of a `ModalBody` that do not fit each other, negative frequencies, or an indefinite S.

    Raises InputError.
    """
    m, K = body.omega.size, len(body.channels)
    for name, shape in (("omega", (m,)), ("zeta", (m,)), ("rows", (K, m)), ("S", (K, K))):
        require_shape(name, getattr(body, name), shape)
    if body.recovery is not None:
        require_shape("recovery", body.recovery, (len(body.recovery), m))
        if body.recovery_S is not None:
            require_shape("recovery_S", body.recovery_S, (len(body.recovery), K))
    for key in ("channels", "outputs"):
        if fault := names_fault(getattr(body, key)):
            raise InputError(f"{key}: found {fault}")
    wanted = len(body.outputs)
    for name, shape in (
        ("output_rows", (wanted, m)),
        ("output_S", (wanted, K)),
        *((square, (m, m)) for square in SQUARES),
        ("participation", (3, m)),
        ("known_speeds", (2,)),
        ("out_of_roundness", (max(body.rim_lines, 1) if body.kind == "rim" else 0, 2 * body.n_max + 1)),
    ):
        if getattr(body, name) is not None:
            require_shape(name, getattr(body, name), shape)
    for name in HIGHER:
        if (parts := getattr(body, name)) is not None:
            require_shape(name, parts, (len(parts), m, m))
    heads = {name.partition(".")[0] for name in body.channels}
    if body.sectors and heads != {f"sector{j}" for j in range(body.sectors)}:
        raise InputError(
            f"sectors: found {body.sectors} and channels of {len(heads)} sectors, expected channels sector0.*, ..."
        )
    _check_modes(body.omega, body.zeta)
    if body.gyroscopic is not None:
        _check_skew("gyroscopic", body.gyroscopic)
    for k, part in enumerate(() if body.gyroscopic_higher is None else body.gyroscopic_higher):
        _check_skew(f"gyroscopic_higher[{k}]", part)
    if fault := compliance_fault(body.S):
        raise InputError(f"S: found {fault}")
    _check_kind(body)


def _check_kind(body: Any) -> None:
    if body.kind == "point":
        return
    if body.kind != "rim":
        raise InputError(f"kind: found {body.kind!r}, expected 'rim' or 'point'")
    require_not_negative(n_max=body.n_max, radius=body.radius, thickness=body.thickness)
    size = 2 * body.n_max + 1
    directions = 3 if any("axial" in name for name in body.channels) else 2
    lines = max(len(body.channels) // (size * directions), 1)
    expected = size * directions * lines
    if len(body.channels) != expected or body.channels != rim_channels(body.n_max, directions, lines):
        raise InputError(
            f"channels: found {len(body.channels)} ({', '.join(body.channels[:3])}, ...), expected the {expected} "
            f"channels of a rim with n_max = {body.n_max}: radial.cos0, radial.cos1, ..."
        )
    if body.lines is not None:
        require_shape("lines", body.lines, (body.rim_lines, 2))
        require_not_negative(**{"radii of lines": float(body.lines[:, 1].min())})
    if body.line_thickness is not None:
        require_shape("line_thickness", body.line_thickness, (body.rim_lines,))
        require_positive(line_thickness=float(body.line_thickness.min()))


def _check_skew(name: str, G: Array) -> None:
    scale, even = float(np.abs(G).max(initial=0.0)), np.abs(G + G.T)
    if even.max(initial=0.0) > SKEW * scale:
        i, j = (int(k) for k in np.unravel_index(int(even.argmax()), even.shape))
        raise InputError(
            f"{name}: found {G[i, j]:.6g} at ({i}, {j}) and {G[j, i]:.6g} at ({j}, {i}), expected a skew-symmetric "
            "matrix, G[i, j] = -G[j, i]"
        )


def _check_modes(omega: Array, zeta: Array) -> None:
    if omega.size and float(omega.min()) < 0.0:
        raise InputError(f"omega: found {omega.min():g} rad/s, expected every frequency >= 0")
    if np.any(tiny := (omega > 0.0) & (omega < LEAST_OMEGA)):
        raise InputError(f"omega: found {omega[tiny][0]:g} rad/s, expected 0, a rigid motion, or >= {LEAST_OMEGA:g}")
    if zeta.size and not 0.0 <= float(zeta.min()) <= float(zeta.max()) < 1.0:
        raise InputError(f"zeta: found {zeta.min():g} .. {zeta.max():g}, expected 0 <= zeta < 1")
