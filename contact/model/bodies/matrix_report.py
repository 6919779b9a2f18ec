"""Report on given matrices and the kept modes: mass, centre, inertia, coupling, residual compliance."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MatrixReport:
    """Properties of matrices: mass, centre, inertia, rigid modes, precision.

    `mass` [kg] along x, y, z (equal for a whole body without scalar dofs left out); `centre` [m] and `inertia` [kg m^2]
    about it, None without points; `rigid` modes at zero frequency; `skew` of M and K relative to the entries in the
    same rows; `massless` dofs; `freq_hz` the lowest elastic frequencies; `kept` modes of `size` unknowns; `residual`
    the share of S in the static compliance at the contact; `coupling` the largest damping between two modes by C over
    their own; `structural` the least and largest loss factor g of a mode by structural damping, `structural_coupling`
    the largest between two modes over their own; None without. `gyroscopic` and `cross`: whether there is a gyroscopic
    matrix, a nonsymmetric stiffness; `rigid_motion` the finding of the rigid-body test.

    >>> import contact as ct
    >>> import numpy as np
    >>> K = 1e6 * np.array([[2.0, -1.0], [-1.0, 1.0]])
    >>> chain = ct.bodies.Matrices.of(K=K, M=np.eye(2), dofs=[(1, "x"), (2, "x")])
    >>> _, report = ct.bodies.body_of(chain, [(2, "x")])
    >>> report.size, report.rigid, [round(one, 2) for one in report.freq_hz]
    (2, 0, [98.36, 257.52])
    """

    size: int
    mass: tuple[float, float, float]
    centre: tuple[float, ...] | None
    inertia: tuple[tuple[float, ...], ...] | None
    rigid: int
    massless: int
    skew: tuple[float, float]
    freq_hz: tuple[float, ...]
    kept: int
    residual: float
    coupling: float | None
    structural: tuple[float, float] | None = None
    structural_coupling: float = 0.0
    gyroscopic: bool = False
    cross: bool = False
    rigid_motion: str = ""

    def __str__(self) -> str:
        """The lines of the printout."""
        lines = [
            f"{self.size} unknowns, {self.massless} of them without mass, {self.rigid} rigid modes",
            f"mass [kg]: {' '.join(f'{m:.6g}' for m in self.mass)} along x, y, z",
        ]
        if self.centre is not None and self.inertia is not None:
            lines.append(f"centre [m]: {' '.join(f'{x:.6g}' for x in self.centre)}")
            rows = "; ".join(" ".join(f"{x:.6g}" for x in row) for row in self.inertia)
            lines.append(f"inertia about it [kg m^2]: {rows}")
        else:
            lines.append("inertia: unknown, since positions of nodes are missing or the masses along x, y and z differ")
        lines.append(f"asymmetry of M and K: {self.skew[0]:.1e}, {self.skew[1]:.1e} of the other entries of their rows")
        lines.append(f"lowest elastic frequencies [Hz]: {' '.join(f'{f:.6g}' for f in self.freq_hz)}")
        if self.coupling is not None:
            lines.append(
                f"damping between modes: up to {self.coupling:.2g} of the damping of these modes, kept in the basis"
            )
        if self.gyroscopic:
            lines.append("gyroscopic matrix: kept in the basis, for each rad/s of the speed")
        if self.cross:
            lines.append("nonsymmetric stiffness: its skew part couples the modes; the residual compliance neglects it")
        if self.structural is not None:
            least, most = self.structural
            lines.append(
                f"structural damping: loss factors g from {least:.4g} to {most:.4g}, converted to zeta = g/2 of each "
                "mode, which is exact at resonance only"
            )
            if self.structural_coupling > 0.0:
                share = f"up to {self.structural_coupling:.2g} of the damping of these modes"
                lines.append(f"structural damping between modes: {share}, neglected")
        if self.rigid_motion:
            lines.append(self.rigid_motion)
        return "\n".join([*lines, self.words])

    @property
    def words(self) -> str:
        """Whether the basis has residual compliance, and what follows from that."""
        if self.residual > 0.0:
            return (
                f"residual compliance: included, {100 * self.residual:.3g} % of the static compliance at the contact; "
                f"without it the contact would be too stiff by this amount with {self.kept} modes"
            )
        return (
            "residual compliance: none, since all modes are kept. Statics are exact, but the contact point has mass "
            "and the step must resolve the highest mode: keep fewer modes, so that S replaces the others"
        )
