"""Checks of the parts of a shell: incompatible parts, and fields that its mesh cannot resolve."""

import numpy as np

from casingfem.errors import ModelError, warn
from casingfem.structure.edge.bolts import Bolts
from casingfem.structure.edge.ring import EdgeMass, Ring, check_stiffeners
from casingfem.structure.edge.support import Clamped, ElasticEdge, ShearDiaphragm, Symmetry, outer_support
from casingfem.structure.field.field import Field
from casingfem.structure.geometry.chart import is_axisymmetric, require_positive
from casingfem.structure.geometry.chart_checks import check_chart, check_symmetry
from casingfem.structure.geometry.revolved import chart_lines
from casingfem.structure.geometry.strip import ON_LINE, check_strips
from casingfem.structure.geometry.survey_check import check_survey, surveys
from casingfem.structure.shell.parts import ShellParts
from casingfem.structure.shell.plausible import check_wall
from casingfem.structure.shell.plies import Ply, mirrored
from casingfem.structure.shell.variation import (
    SEEN,
    field_samples,
    finest_harmonic,
    following,
    outer_supports,
    springs_per_wave,
    spurious_split,
)
from contact.io.names import hint

WALLS = ("curved", "linear")
SUPPORTS: tuple[type, ...] = (Clamped, ShearDiaphragm, Symmetry, ElasticEdge, Bolts, Ring)


def check_parts(shell: ShellParts) -> None:
    """Refuse incompatible parts; these checks need no mesh."""
    require_positive("shell", "shell-thickness", thickness=shell.thickness)
    if shell.shear_correction is not None:
        require_positive("shell", "shear-correction", shear_correction=shell.shear_correction)
    if shell.wall not in WALLS:
        raise ModelError("shell-wall", f"shell.wall: expected {' or '.join(WALLS)}, found {shell.wall!r}")
    check_plies(shell)
    check_chart(shell.chart)
    known = shell.chart.edges
    for edge, support in shell.supports.items():
        if edge not in known:
            found = f"support.{edge}: this chart has no edge {edge!r}; it has {', '.join(known)}{hint(edge, known)}"
            raise ModelError("support-edge", found)
        if not isinstance(support, SUPPORTS):
            expected = ", ".join(kind.__name__ for kind in SUPPORTS)
            raise ModelError("support-kind", f"support.{edge}: expected {expected}, found {type(support).__name__}")
        held, _ = known[edge]
        if isinstance(support, Ring) and held != 0:
            raise ModelError("ring-edge", f"support.{edge}: found a ring on an edge that runs along the axis")
        across = [other for other in shell.supports if known[other][0] != 0 and shell.supports[other].held]
        if isinstance(support, Ring) and across:  # the ring's own turn at the corner would be free
            raise ModelError("ring-edge", f"support.{edge}: found a ring that ends on the fixed edge {across[0]!r}")
        if isinstance(support, Symmetry):
            check_symmetry(shell.chart, edge)
        holding = outer_support(support)
        if isinstance(holding, Bolts):
            low, high = (float(np.real(end)) for end in shell.chart.bounds[1 - held])
            holding.require_on((low, high), shell.chart.periodic and held == 0, edge)
    for edge, masses in shell.masses.items():
        if edge not in known or not all(isinstance(mass, EdgeMass) for mass in masses):
            expected = f"expected values EdgeMass, on one of {', '.join(known)}"
            raise ModelError("mass-edge", f"masses.{edge}: found {masses!r}, {expected}")
    check_strips(shell.strips, shell.chart.bounds[0], None)
    check_stiffeners(shell.stiffeners, shell.chart.bounds[0], shell.chart.periodic)


def check_plies(shell: ShellParts) -> None:
    """Refuse layers together with features that assume one isotropic wall."""
    if not shell.plies:
        return
    if not all(isinstance(ply, Ply) for ply in shell.plies):
        raise ModelError("shell-plies", f"shell.plies: found {shell.plies!r}, expected values cf.shell.Ply")
    if shell.wall != "linear":
        raise ModelError("shell-plies", f'shell.plies: found wall {shell.wall!r}, expected "linear"')
    if any(strip.material is not None for strip in shell.strips):
        raise ModelError("shell-plies", "shell.plies: found a strip with a material of its own")
    if not mirrored(shell.plies) and any(isinstance(support, Symmetry) for support in shell.supports.values()):
        raise ModelError(
            "shell-plies", "shell.plies: found a plane of symmetry and plies that are not balanced about it"
        )


def check_on_mesh(shell: ShellParts) -> None:
    """Refuse strips, fields, walls and springs that the mesh cannot resolve; warn of bolts that it does not follow."""
    if shell.chart.periodic and not isinstance(shell.mesh.around, int | np.integer):
        found = "found break points on a closed chart, expected the number of equal elements"
        raise ModelError("mesh-around", f"mesh.around: {found}")
    start, end = shell.chart.bounds[0]
    lines = start + (end - start) * shell.mesh.breaks
    check_strips(shell.strips, (start, end), lines)
    slack = ON_LINE * float(np.real(end - start))
    for name, at in shell.stations.items():
        if np.abs(np.real(lines) - at).min() > slack:
            raise ModelError("stiffener-off-line", f"mesh.rows: found no element line at {at:g} m, the place of {name}")
    for line in chart_lines(shell.chart):
        if np.abs(np.real(lines) - line).min() > slack:
            found = f"found no element line at s = {line:g} m along the meridian, where two pieces meet"
            raise ModelError("meridian-off-line", f"mesh.rows: {found}")
    for quantity, defect in shell.defects.items():
        check_field(shell, f"{quantity}_defect", defect)
        for survey in surveys(defect):
            check_survey(survey, quantity, shell.chart, float(np.real(shell.thickness)))
    check_wall(shell)
    for edge, holding in outer_supports(shell).items():
        if isinstance(holding, ElasticEdge) and holding.patterns:
            check_springs(shell, edge, holding)
        if isinstance(holding, Bolts) and is_axisymmetric(shell.chart):  # other surfaces have no pairs to keep whole
            check_bolt_mesh(shell, edge, holding)


def check_bolt_mesh(shell: ShellParts, edge: str, bolts: Bolts) -> None:
    """Warn if the mesh does not follow the bolts, so that it splits pairs that equal bolts do not split."""
    if shell.mesh.columns == following(shell.mesh.columns, bolts.count):
        return
    wall, steel = shell.thickness, shell.material
    if isinstance(ring := shell.supports[edge], Ring):
        wall, steel = ring.section.width, ring.material or steel
    ratio = springs_per_wave(bolts, float(np.real(steel.E)), float(np.real(steel.nu)), float(np.real(wall)))
    split = spurious_split(bolts, shell.mesh, ratio)
    if split > SEEN:
        found = f"found {bolts.count} bolts on {shell.mesh.columns} elements around"
        effect = f"they split pairs of modes, which equal bolts would not, by about {split:.0e} of the frequency"
        warn("bolt-mesh", f"support.{edge}: {found}; {effect}", stacklevel=6)


def check_springs(shell: ShellParts, edge: str, support: ElasticEdge) -> None:
    """Refuse springs whose pattern makes them negative."""
    held, end = shell.chart.edges[edge]
    points = max(361, *(2 * field_samples(field) + 1 for field in support.patterns.values()))
    ends = [np.linspace(*span, points) for span in shell.chart.bounds]
    ends[held] = np.full(points, shell.chart.bounds[held][end])
    for spring in (name for name in support.patterns if getattr(support, name)):
        lowest = float(np.real(support.factor(spring, *ends)).min())
        if not lowest >= 0.0:
            found = f"found cos and sin that multiply {spring} by {lowest:.3g} at one place, expected 0 or more"
            raise ModelError("springs-negative", f"support.{edge}.around: {found}")


def check_field(shell: ShellParts, name: str, defect: Field) -> None:
    """Refuse a field that is not finite, is as large as the varied quantity, or is finer than the mesh."""
    counts = (9, max(361, 2 * field_samples(defect) + 1))
    a, b = (np.linspace(*ends, count) for ends, count in zip(shell.chart.bounds, counts, strict=True))
    values = np.real(defect.derivatives(a[:, None], b[None, :]).value)
    if not np.all(np.isfinite(values)):
        raise ModelError("field-not-finite", f"{name}: the field is not finite everywhere on the surface")
    if values.min() <= -0.9 or values.max() > 9.0:
        reached = values.min() if values.min() <= -0.9 else values.max()
        raise ModelError("field-range", f"{name}: the field reaches {reached:.3g}, expected values from -0.9 to 9")
    nodes = shell.mesh.order * shell.mesh.columns
    finest = finest_harmonic(shell, defect) if shell.chart.periodic else 0
    if 2 * finest > nodes:
        found = f"{finest} waves on {nodes} nodes around; the mesh resolves {nodes // 2} at most"
        raise ModelError("field-mesh", f"{name}: {found}")
