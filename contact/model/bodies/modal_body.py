"""A body in modal coordinates with its residual compliance: arrays only, read from npz without pickle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact.base.arrays import Array, keep_readonly, read_npz, require_not_negative, require_positive
from contact.base.errors import InputError
from contact.io.names import hint
from contact.io.npz import whole, write_npz
from contact.model.bodies.matrices_over_speed import matrices_at, powers_of_speed, require_between
from contact.model.bodies.modal_checks import HIGHER, OPTIONAL, SQUARES, check

if TYPE_CHECKING:
    from contact.model.bodies.matrices import Contact
    from contact.model.bodies.matrix_checks import Dof

FORMAT = "casingfem-modal-basis-1"
MADE_BY = "`casingfem reduce STUDY --out DIR` or `casingfem import` writes a basis"
REQUIRED = ("omega", "zeta", "channels", "rows", "S", "kind")
TEXTS = ("format", "channels", "kind", "outputs", "provenance")


class Basis(Protocol):
    """A reduced basis: its arrays under the names that its file uses."""

    def arrays(self) -> Mapping[str, Any]:
        """Plain arrays by name."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ModalBody:
    """m mass-normalised modes, seen through K interface channels.

    q'' + C q' + K q = rows^T lam,  u = rows q + S lam  (lam: forces on the channels), in the body's own frame, with
    C = diag(2 zeta omega) + damping + Omega gyroscopic and
    K = diag(omega^2) + stiffness + (Omega^2 - spin^2) stiffness_by_speed, of a body that turns at Omega [rad/s]; with
    x = Omega^2 - spin^2 also C + Omega x^j gyroscopic_higher[j - 1] and K + x^(j + 1) stiffness_higher[j - 1].

    `omega` [rad/s], `zeta` (m,); `rows` (K, m) [1/sqrt(kg)]; `S` (K, K) [m/N], symmetric: static compliance of all
    modes that are not kept. `kind` "point" (any named channels) or "rim": channels radial.cos0 .. radial.sinN, then
    tangential.cos0 .. tangential.sinN, then maybe axial alike, with `n_max` = N, mean `radius` and least `thickness` of
    the wall [m], 0 if unknown; for several rim lines line0.radial.cos0 .. line1... Of each line `lines` (L, 2) are
    axial place and radius [m], `line_thickness` (L,) the wall there [m]; in a file without them every line has the same
    `radius` and `thickness`. `recovery` (R, m), `recovery_S` (R, K) and `recovery_points` (R, 3) give displacements
    elsewhere, `recovery_cells` the cells between those points, for drawing; `output_rows` (O, m) and `output_S` (O, K)
    the quantities named in `outputs`. `gyroscopic` (m, m) [1/s per rad/s]: the Coriolis matrix 2 G of the modes, skew,
    in the body's frame, which turns at Omega > 0 about the axis of a rim from x to y. `stiffness_by_speed` (m, m)
    [1/s^2 per (rad/s)^2]: stiffening by centrifugal stress minus spin softening; `spin` [rad/s] is the speed at which
    the modes were computed. `damping` (m, m) [1/s] and `stiffness` (m, m) [1/s^2]: coupling of the modes beyond their
    own damping and stiffness, such as by cross-coupled bearings; they may be nonsymmetric. `gyroscopic_higher` and
    `stiffness_higher` (k, m, m): effect of omitted modes on the kept ones at higher powers of the speed; the former are
    skew, too. `matrices` gives C and K at a speed. `known_speeds` (2,) [rad/s]: the lowest and highest speed at which
    these matrices are valid, for a part whose steady shape depends on the speed; None if they are valid at every speed.
    `participation` (3, m) [sqrt(kg)]: modal force per acceleration of the whole body, Phi^T M e, along x, y and the
    axis of a rim, along span, flap and chord of a blade. `sectors`: number of equal sectors of a wheel, else 0, with
    channels sector0.span, ..., sector1.span, ... `out_of_roundness` (L, 2 N + 1) [m]: deviation of each rim line's
    radius, cos0 .. cosN, sin1 .. sinN.

    Raises InputError for shapes that do not fit, NaN, negative frequencies, an asymmetric or indefinite S, a gyroscopic
    matrix that is not skew.

    >>> body = ModalBody(omega=[100.0], zeta=[0.01], channels=("span",), rows=[[2.0]], S=[[0.0]])
    >>> body
    ModalBody(point, 1 modes, 15.92 .. 15.92 Hz, 1 channels)
    """

    omega: Array
    zeta: Array
    channels: tuple[str, ...]
    rows: Array
    S: Array
    kind: str = "point"
    n_max: int = 0
    sectors: int = 0
    radius: float = 0.0
    thickness: float = 0.0
    provenance: str = "{}"
    recovery: Array | None = None
    recovery_S: Array | None = None
    recovery_points: Array | None = None
    recovery_cells: Array | None = None
    lines: Array | None = None
    line_thickness: Array | None = None
    outputs: tuple[str, ...] = ()
    output_rows: Array | None = None
    output_S: Array | None = None
    gyroscopic: Array | None = None
    stiffness_by_speed: Array | None = None
    gyroscopic_higher: Array | None = None
    stiffness_higher: Array | None = None
    damping: Array | None = None
    stiffness: Array | None = None
    participation: Array | None = None
    out_of_roundness: Array | None = None
    known_speeds: Array | None = None
    spin: float = 0.0

    def __post_init__(self) -> None:
        keep_readonly(self, "omega", "zeta", "rows", "S", *OPTIONAL)
        for name in OPTIONAL:
            if getattr(self, name) is not None and getattr(self, name).size == 0:
                object.__setattr__(self, name, None)
        object.__setattr__(self, "channels", tuple(str(name) for name in self.channels))
        object.__setattr__(self, "outputs", tuple(str(name) for name in self.outputs))
        check(self)

    @property
    def directions(self) -> int:
        """Directions of a rim's motion: radial, tangential and, when there are three, axial."""
        return 3 if any("axial" in name for name in self.channels[-1:]) else 2  # they come last

    @property
    def rim_lines(self) -> int:
        """Number of lines around a rim at which contact acts."""
        return len(self.channels) // ((2 * self.n_max + 1) * self.directions)

    def roundness(self, line: int = 0) -> list[dict[str, float]]:
        """Out-of-roundness of a rim line, terms {p, cos, sin} [m]; raises InputError where the basis has none."""
        if self.out_of_roundness is None:
            raise InputError(
                "out_of_roundness: found none in the basis, expected a basis of a whole casing from casingfem reduce, "
                "or harmonics [{p = ..., cos = ..., sin = ...}]"
            )
        c, N = self.out_of_roundness[line], self.n_max
        return [{"p": p, "cos": float(c[p]), "sin": float(c[N + p])} for p in range(1, N + 1) if c[p] or c[N + p]]

    def line_radius(self, line: int) -> float:
        """Radius of one rim line [m]; the mean radius where the basis has no lines."""
        return self.radius if self.lines is None else float(self.lines[line, 1])

    def line_wall(self, line: int) -> float:
        """Least thickness of the wall at one rim line [m], 0 if unknown."""
        return self.thickness if self.line_thickness is None else float(self.line_thickness[line])

    def __repr__(self) -> str:
        freq = self.omega / (2.0 * np.pi)
        band = f"{freq.min():.4g} .. {freq.max():.4g} Hz" if freq.size else "rigid"
        return f"ModalBody({self.kind}, {self.omega.size} modes, {band}, {len(self.channels)} channels)"

    def channel(self, name: str) -> int:
        """Row number of a channel; raises InputError that lists the existing channels."""
        if name not in self.channels:
            expected = f"one of {', '.join(self.channels)}{hint(name, self.channels)}"
            raise InputError(f"channel: found {name!r}, expected {expected}")
        return self.channels.index(name)

    def matrices(self, omega_rotation: float = 0.0) -> tuple[Array, Array]:
        """C [1/s] and K [1/s^2] of q'' + C q' + K q = rows^T lam, both (m, m), of the rotating body.

        `omega_rotation` [rad/s] is positive from x to y about the axis of a rim. Wheels and blades rotate about the
        axis of their study.

        >>> pair = ModalBody(omega=[3.0, 3.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2),
        ...                  S=np.zeros((2, 2)), gyroscopic=[[0.0, -2.0], [2.0, 0.0]])
        >>> [part.tolist() for part in pair.matrices(0.5)]
        [[[0.0, -1.0], [1.0, 0.0]], [[9.0, 0.0], [0.0, 9.0]]]
        """
        self.require_known(omega_rotation)
        return matrices_at(self, omega_rotation)

    @property
    def varies(self) -> bool:
        """Whether C or K depends on the speed."""
        return any(getattr(self, name) is not None for name in ("gyroscopic", "stiffness_by_speed", *HIGHER))

    def require_known(self, omega_rotation: ArrayLike) -> None:
        """Raise InputError at speeds [rad/s], one or many, where the matrices of the body are not known.

        >>> part = ModalBody(omega=[9.0], zeta=[0.0], channels=("x",), rows=[[1.0]], S=[[0.0]], spin=6.0,
        ...                  stiffness_by_speed=[[0.5]], known_speeds=[2.0 * np.pi, 4.0 * np.pi])
        >>> part.require_known(3.0 * np.pi)
        >>> part.require_known([0.0, 3.0 * np.pi, 8.0 * np.pi])
        Traceback (most recent call last):
        contact.base.errors.InputError: speed: found 0 to 4 Hz (0 to 240 rpm) at 2 of 3 speeds, expected 1 to 2 Hz ...
        """
        if self.known_speeds is not None:
            require_between(np.asarray(self.known_speeds), omega_rotation)

    def without_rotation(self) -> ModalBody:
        """The body with the same modal stiffness at every speed, and without Coriolis forces."""
        return replace(
            self, gyroscopic=None, stiffness_by_speed=None, gyroscopic_higher=None, stiffness_higher=None,
            known_speeds=None,
        )  # fmt: skip

    def powers_of_speed(self) -> tuple[Array, Array]:
        """Coefficients of Omega, Omega^3, ... in C and of 1, Omega^2, Omega^4, ... in K, without the modes' own terms.

        Shapes (k, m, m) and (k + 1, m, m); `damping` and `stiffness` are left out.
        """
        return powers_of_speed(self)

    def poles(self, omega_rotation: float = 0.0) -> NDArray[np.complex128]:
        """Poles [1/s, rad/s] of the rotating free body in its own frame, (2 m,), by ascending imaginary part.

        The eigenvalues s of s^2 + C s + K = 0, of `matrices` at this speed. A wave on a rim that runs with a positive
        rotation has a lower frequency than the one against it.

        >>> pair = ModalBody(omega=[3.0, 3.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2),
        ...                  S=np.zeros((2, 2)), gyroscopic=[[0.0, -2.0], [2.0, 0.0]], stiffness_by_speed=-np.eye(2))
        >>> pair.poles(0.5).imag.round(9).tolist()
        [-3.5, -2.5, 2.5, 3.5]
        """
        C, K = self.matrices(omega_rotation)
        m = self.omega.size
        scale = float(self.omega.max(initial=0.0)) or 1.0
        none, one = np.zeros((m, m)), scale * np.eye(m)
        found = np.linalg.eigvals(np.block([[none, one], [-K / scale, -C]])).astype(complex)
        return np.asarray(found[np.argsort(found.imag, kind="stable")])

    def truncated(self, omega_max: float) -> ModalBody:
        """Drop modes above `omega_max` [rad/s]; S receives their static compliance rows rows^T / omega^2.

        Coupling of dropped and kept modes by rotation, `damping` and `stiffness` is lost.
        """
        keep = self.omega <= omega_max
        gone = self.rows[:, ~keep] / self.omega[~keep]
        elsewhere: dict[str, Any] = {}
        for name, soft in (("recovery", "recovery_S"), ("output_rows", "output_S")):
            if (rows := getattr(self, name)) is not None:
                lost, had = rows[:, ~keep] / self.omega[~keep] @ gone.T, getattr(self, soft)
                elsewhere |= {name: rows[:, keep], soft: lost if had is None else had + lost}
        for name in SQUARES:
            elsewhere[name] = None if getattr(self, name) is None else getattr(self, name)[np.ix_(keep, keep)]
        for name in HIGHER:
            elsewhere[name] = None if getattr(self, name) is None else getattr(self, name)[:, keep][:, :, keep]
        return replace(
            self, omega=self.omega[keep], zeta=self.zeta[keep], rows=self.rows[:, keep], S=self.S + gone @ gone.T,
            participation=None if self.participation is None else self.participation[:, keep], **elsewhere,
        )  # fmt: skip

    def retuned(self, freq_hz: float) -> ModalBody:
        """The same body with another stiffness: all frequencies scaled so that the lowest elastic one is `freq_hz`.

        `damping` is multiplied by the ratio r of the frequencies, `stiffness` by its square. `gyroscopic` and
        `stiffness_by_speed` stay; of their higher powers the j-th is divided by r^(2 j).

        >>> ModalBody(omega=[10.0, 30.0], zeta=[0.0, 0.0], channels=("tip",), rows=[[1.0, 1.0]],
        ...           S=[[4.0]]).retuned(10.0 / np.pi).S.tolist()
        [[1.0]]
        """
        require_positive(freq_hz=freq_hz)
        elastic = self.omega[self.omega > 0.0]
        if not elastic.size:
            raise InputError("freq_hz: found a body of rigid modes only, expected an elastic mode to retune")
        ratio = 2.0 * np.pi * freq_hz / float(elastic.min())
        powers = {"S": -2, "recovery_S": -2, "output_S": -2, "damping": 1, "stiffness": 2}
        scaled = {
            name: ratio**power * given for name, power in powers.items() if (given := getattr(self, name)) is not None
        }
        for name in HIGHER:
            if (given := getattr(self, name)) is not None:
                scaled[name] = given * ratio ** (-2.0 * np.arange(1, 1 + len(given)))[:, None, None]
        return replace(self, omega=self.omega * ratio, **scaled)

    def detuned(self, scatter: float, *, seed: int) -> ModalBody:
        """Multiply each frequency by 1 + scatter x, x normal and seeded: the effect of small imperfections on pairs."""
        require_not_negative(scatter=scatter)
        draw = np.random.default_rng(seed).standard_normal(self.omega.size)
        return replace(self, omega=self.omega * (1.0 + scatter * draw))

    def save(self, path: str | Path) -> None:
        """Write npz without pickle, complete or not at all (temporary name, then moved)."""
        data: dict[str, Any] = {
            "format": FORMAT, "omega": self.omega, "zeta": self.zeta, "channels": np.array(self.channels),
            "rows": self.rows, "S": self.S, "kind": self.kind, "n_max": self.n_max, "radius": self.radius,
            "provenance": self.provenance, "outputs": np.array(self.outputs, dtype=np.str_), "spin": self.spin,
            "thickness": self.thickness, "sectors": self.sectors,
        }  # fmt: skip
        data |= {name: getattr(self, name) for name in OPTIONAL if getattr(self, name) is not None}
        write_npz(Path(path), data)

    @staticmethod
    def from_matrices(
        M: Any,
        K: Any,
        C: Any = None,
        *,
        dofs: Sequence[Dof],
        contact: Contact,
        points: Mapping[int, Sequence[float]] | None = None,
        units: str = "m-kg-s",
        modes: int | None = None,
        zeta: float = 0.0,
        K4: Any = None,
        G: Any = None,
        nonsymmetric: bool = False,
        axes: Mapping[int, Any] | None = None,
    ) -> ModalBody:
        """Modes and residual compliance of given matrices M, K and maybe C, G, K4, dense or sparse.

        `dofs`: (node, direction) of each row, directions x, y, z, rx, ry, rz or 1 to 6; q or 0 for a scalar, such as a
        mode of a Craig-Bampton set. `contact`: nodes (channels 6.x, 6.y, 6.z), dofs, or channel name -> row over the
        dofs. `points`: node -> x, y, z. `units` of all of them, length-mass-time. `modes` kept: 20 if left out, or all
        if they are fewer. `zeta` where there is no C and no K4. Coupling of modes by C, and damping above critical,
        become their `damping`. `G`: gyroscopic matrix, skew, which is added to C after multiplication by the speed
        [rad/s]. K and C may differ from their transposes where they are given as `nonsymmetric`: modes and residual
        compliance are those of the symmetric part of K, the skew part is the `stiffness` between the modes kept. `K4`:
        structural damping, the imaginary part of K; a mode has zeta = phi^T K4 phi / (2 omega^2). `axes`: node ->
        directions of its own x, y, z, rows (3, 3), for nodes whose dofs are not along the axes of the points; channels
        are along the latter. A free body keeps its rigid modes; modes left out go into S, as do massless dofs. The
        provenance contains what `ct.bodies.body_of` reports: mass, inertia, rigid modes, symmetry, frequencies,
        residual compliance.

        Raises InputError naming the matrix, dof or unit that cannot be used, or the node at which a free part resists
        rigid motion: wrong axes, positions or units.

        >>> two = ModalBody.from_matrices([[2.0, 0.0], [0.0, 1.0]], [[2e6, -1e6], [-1e6, 1e6]], contact=[2],
        ...                               dofs=[(1, "x"), (2, "x")], modes=1)
        >>> two.channels, f"{(two.rows**2 / two.omega**2 + two.S).item():.6g}"  # the static compliance 1/k + 1/k
        (('2.x',), '2e-06')
        """
        from contact.model.bodies.matrices import Matrices
        from contact.model.bodies.matrix_modes import reduced

        matrices = Matrices.of(
            M, K, C, dofs=dofs, points=points, units=units, K4=K4, G=G, nonsymmetric=nonsymmetric, axes=axes
        )  # fmt: skip
        return ModalBody(**reduced(matrices, contact, modes=modes, zeta=zeta)[0])

    @staticmethod
    def load(path: str | Path) -> ModalBody:
        """Read a modal basis file; raises InputError that names the file and the key."""
        data = read_npz(Path(path), FORMAT, REQUIRED, TEXTS, MADE_BY)
        if unknown := sorted(data.keys() - {"format", *ModalBody.__dataclass_fields__}):
            found = ", ".join(unknown)
            raise InputError(
                f"{path}: found unknown keys {found}, expected those of this version: reduce the structure again"
            )
        try:
            return of_arrays(data)
        except (InputError, TypeError, ValueError) as error:
            raise InputError(f"{path}: {error}") from error

    @staticmethod
    def of(basis: Basis) -> ModalBody:
        """The body of a reduced basis in memory, as `load` reads it from the file of `basis.save`; raises InputError.

        >>> class Own:  # cf.reduce(...) gives one
        ...     def arrays(self):
        ...         return {"format": FORMAT, "omega": np.array([10.0]), "zeta": np.zeros(1), "rows": np.ones((1, 1)),
        ...                 "S": np.zeros((1, 1)), "channels": np.array(["span"]), "kind": np.array("point"),
        ...                 "n_max": np.array(0), "sectors": np.array(0)}
        >>> ModalBody.of(Own()).channels
        ('span',)
        """
        if not hasattr(basis, "arrays"):
            raise InputError(f"basis: found {type(basis).__name__}, expected a reduced basis (cf.reduce)")
        data = basis.arrays()
        if missing := [name for name in REQUIRED if name not in data]:
            raise InputError(f"basis: missing {', '.join(missing)}")
        return of_arrays(data)


def of_arrays(data: Mapping[str, Any]) -> ModalBody:
    """A body from the arrays of a basis."""
    return ModalBody(
        omega=data["omega"], zeta=data["zeta"], rows=data["rows"], S=data["S"],
        channels=tuple(str(name) for name in np.atleast_1d(data["channels"])), kind=str(data["kind"]),
        n_max=whole(data, "n_max"), sectors=whole(data, "sectors"),
        radius=float(data.get("radius", np.array(0.0))),
        outputs=tuple(str(name) for name in np.atleast_1d(data.get("outputs", np.zeros(0, dtype=np.str_)))),
        spin=float(data.get("spin", np.array(0.0))), thickness=float(data.get("thickness", np.array(0.0))),
        provenance=str(data.get("provenance", "{}")), **{n: data[n] for n in OPTIONAL if n in data},
    )  # fmt: skip
