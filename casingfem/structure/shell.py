"""A shell: chart, thickness, material, supports and imperfection fields. A value; nothing is computed here."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from casingfem.arrays import Array
from casingfem.structure.chart import Chart, Surface, require_positive
from casingfem.structure.field import Field
from casingfem.structure.material import Material
from casingfem.structure.mesh import ShellMesh
from casingfem.structure.support import Clamped, ElasticEdge, ShearDiaphragm, Support


class ShellGeometry(NamedTuple):
    """Mid-surface and thickness at points."""

    surface: Surface
    thickness: Array


def default_mesh(chart: Chart) -> ShellMesh:
    """The mesh used when none is given, chosen by `python -m reports.frustum_convergence`."""
    if chart.periodic:
        return ShellMesh(order=7, rows=(0.0, 0.12, 1.0), around=21)
    return ShellMesh(order=8, rows=2, around=2)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shell:
    """A shear-deformable shell on a chart.

    Parameters
    ----------
    chart
        Mid-surface: Frustum, Cylinder, Panel, Plate, or anything that satisfies `Chart`.
    thickness
        Nominal thickness t [m].
    material
        Isotropic material.
    supports
        Edge name -> support; edges not named are free.
    radius_defect
        Relative radius field f: r = r0 (1 + f).
    thickness_defect
        Relative thickness field: t (1 + field).
    mesh
        Order and element counts; a default for the kind of chart if left out.

    Raises
    ------
    ValueError
        Not positive thickness, an unknown edge, or a field as large as the surface itself.

    Examples
    --------
    >>> from casingfem.structure.chart import Frustum
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=steel,
    ...                supports={"base": Clamped()})
    >>> casing.mesh.order
    7
    """

    chart: Chart
    thickness: float
    material: Material
    supports: Mapping[str, Support] = field(default_factory=dict)
    radius_defect: Field | None = None
    thickness_defect: Field | None = None
    mesh: ShellMesh = field(default=None)  # type: ignore[assignment]  # replaced in __post_init__

    def __post_init__(self) -> None:
        require_positive("shell", thickness=self.thickness)
        known = self.chart.edges
        for edge, support in self.supports.items():
            if edge not in known:
                raise ValueError(
                    f"support.{edge}: this chart has no edge {edge!r}; it has {', '.join(known)}"
                )
            if not isinstance(support, Clamped | ShearDiaphragm | ElasticEdge):
                raise ValueError(
                    f"support.{edge}: expected Clamped, ShearDiaphragm or ElasticEdge, "
                    f"found {type(support).__name__}"
                )
        object.__setattr__(self, "supports", MappingProxyType(dict(self.supports)))
        if self.mesh is None:
            object.__setattr__(self, "mesh", default_mesh(self.chart))
        for name in ("radius_defect", "thickness_defect"):
            self._check_field(name)

    def _check_field(self, name: str) -> None:
        defect: Field | None = getattr(self, name)
        if defect is None:
            return
        a, b = (np.linspace(*ends, count) for ends, count in zip(self.chart.bounds, (9, 361), strict=True))
        values = np.real(defect.derivatives(a[:, None], b[None, :]).value)
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name}: the field is not finite everywhere on the surface")
        if values.min() <= -0.9:
            raise ValueError(
                f"{name}: the field reaches {values.min():.3g}; it is relative and must stay above -0.9"
            )

    @property
    def axisymmetric(self) -> bool:
        """Whether nothing varies around: no fields, and springs equal all along their edges."""
        even = all(
            not support.around.harmonics
            for support in self.supports.values()
            if isinstance(support, ElasticEdge)
        )
        return self.chart.periodic and even and self.radius_defect is None and self.thickness_defect is None

    def geometry(self, a: Array, b: Array) -> ShellGeometry:
        """Mid-surface and thickness at parameters (a, b)."""
        defect = None if self.radius_defect is None else self.radius_defect.derivatives(a, b)
        thickness = self.thickness + np.zeros(np.broadcast(a, b).shape)
        if self.thickness_defect is not None:
            thickness = thickness * (1.0 + self.thickness_defect.derivatives(a, b).value)
        return ShellGeometry(surface=self.chart.surface(a, b, defect), thickness=thickness)
