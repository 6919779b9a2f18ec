"""A shell: chart, thickness, material, supports and imperfection fields; a value that is checked when it is made."""

from dataclasses import dataclass, fields
from typing import TypeVar, cast

from casingfem.errors import ModelError
from casingfem.io.arrays import read_only
from casingfem.structure.mesh.shell_mesh import ShellMesh
from casingfem.structure.shell.checks import check_on_mesh, check_parts
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.variation import default_mesh
from contact.io.brief import brief

Parts = TypeVar("Parts", bound=ShellParts)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shell(ShellParts):
    """A shear-deformable shell on a chart.

    Parameters
    ----------
    chart
        Mid-surface: Frustum, Cylinder, Panel, Plate, TwistedPlate, Blade, or anything that satisfies `Chart`.
    thickness
        Nominal thickness t [m].
    material
        Isotropic material.
    supports
        Edge name -> support; edges not named are free.
    radius_defect
        Relative radius field f: r = r0 (1 + f).
    thickness_defect, modulus_defect, density_defect
        Relative fields of the thickness t (1 + f), of Young's modulus E (1 + f), of the density rho (1 + f).
    shear_correction
        Factor of the transverse shear stiffness, by default 5/(6 - nu), or 5/6 on a linear wall; a large one gives the
        thin-shell (Kirchhoff-Love) limit.
    wall
        "curved": strains and inertia with the metric at every depth of the wall, and the stretch of its normals;
        "linear": strains linear through the wall, as published shell theory has them (`structure.shell.wall`).
    plies
        Layers from the inside out that fill the wall in proportion to their thicknesses; the wall must be linear.
        Layers without a lamina have the shell's material.
    strips
        Bands along the first parameter with their own thickness or material.
    stiffeners
        Rings on a closed casing's wall, between its edges.
    taper
        Designed variation of the thickness: factors from root to tip and across.
    rotation
        Steady rotation: speed and axis; by default at rest.
    masses
        Edge -> point masses on it, or on the centre line of its ring.
    mesh
        Order and element counts; by default chosen for the shell.

    Raises
    ------
    ModelError
        The thickness is not positive, an edge or wall is unknown, or a field is as large as the varied quantity.
    ModelError
        Springs that a pattern makes negative (`springs-negative`); strips that overlap or leave the shell
        (`strip-overlap`, `strip-outside`), or end where a given mesh has no element line (`strip-off-line`);
        stiffeners that are at no place of their own (`stiffener-place`) or on no such line (`stiffener-off-line`).

    Examples
    --------
    >>> from casingfem.structure.geometry.chart import Frustum
    >>> from casingfem.structure.edge.support import Clamped
    >>> from casingfem.structure.material import Material
    >>> steel = Material(E=210e9, nu=0.3, rho=7800.0)
    >>> casing = Shell(chart=Frustum(r_base=0.5, r_top=0.45, height=0.25), thickness=3e-3, material=steel,
    ...                supports={"base": Clamped()})
    >>> casing.mesh.order
    8
    """

    __repr__ = brief

    def __post_init__(self) -> None:
        check_parts(self)
        object.__setattr__(self, "masses", read_only({e: tuple(m) for e, m in self.masses.items() if m}))
        object.__setattr__(self, "supports", read_only(self.supports))
        object.__setattr__(self, "strips", tuple(self.strips))
        object.__setattr__(self, "stiffeners", tuple(self.stiffeners))
        if cast(ShellMesh | None, self.mesh) is None:
            object.__setattr__(self, "mesh", default_mesh(self))
        check_on_mesh(self)


def remade(kind: type[Parts], shell: ShellParts) -> Parts:
    """The same fields as unchecked `ShellParts`, for many small steps, or as a `Shell`."""
    return kind(**{each.name: getattr(shell, each.name) for each in fields(ShellParts)})


def require_shell(structure: object, what: str) -> None:
    """Refuse a structure without a chart where a chart is needed.

    Raises
    ------
    ModelError
        `structure-chart`, with the finding.
    """
    if not isinstance(structure, Shell):
        raise ModelError("structure-chart", f"{what}: found {type(structure).__name__}, which has no chart")
