"""Sections of the report: input, modes, reduction, provenance."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from casingfem.errors import ModelError
from casingfem.modal.basis import ModalBasis
from casingfem.modal.campbell import MODES, campbell
from casingfem.modal.mode_set import Modes, ModeSet
from casingfem.plot.body.turning import turning_shapes
from casingfem.plot.modes import figure_frequencies, figure_rim, groups
from casingfem.plot.page import Cell, Picture, Section, Table
from casingfem.plot.pages.quantities import chart_rows, spaced, values_of
from casingfem.structure.edge.ring import Ring
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.field.survey.survey import SurveyField
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.imported.shell import MeshShell
from casingfem.structure.imported.solid import Solid
from casingfem.structure.imported.turning_structure import rotation_of
from casingfem.structure.material import Material
from casingfem.structure.shell.plies import Ply
from casingfem.structure.shell.shell import Shell
from casingfem.study import MeshStudy, Study

TURNED = 12  # shapes that a reader can turn
SPEEDS, FOLLOWED = 12, 8  # speeds and most modes of a Campbell diagram
SHOWN = 4  # harmonics of a field that are named


def inputs_section(study: Study | MeshStudy) -> Section:
    """The structure in one table, and the comment lines of the measured table."""
    rows = structure_rows(study.structure) if isinstance(study, Study) else mesh_rows(study.structure)
    paragraphs = []
    if study.shapes is not None and study.file.update is not None:
        name = Path(str(study.file.update.shapes)).name
        paragraphs.append(f"Mode shapes at {len(study.shapes.a)} sensors from {name}.")
    if study.table is not None:
        name = "Synthetic" if study.table.synthetic else "Measured"
        paragraphs.append(
            f"{name} frequencies: {len(study.table)} rows of {Path(study.table.path).name}. Comment lines of the file:"
        )
    card = "\n".join(study.table.card) if study.table is not None else ""
    table = Table("The structure, as given in the study.", ("quantity", "value"), rows)
    return Section("Inputs", tuple(paragraphs), tables=(table,), preformatted=card)


def structure_rows(shell: Shell) -> tuple[tuple[Cell, ...], ...]:
    """Chart, thickness, material, supports, fields, mesh."""
    rows = chart_rows(shell.chart)
    rows.append(("thickness", f"{1e3 * shell.thickness:.6g} mm"))
    rows.append(("material", material_words(shell.material)))
    rows += [(f"ply {k}", ply_words(ply, shell)) for k, ply in enumerate(shell.plies, 1)]
    if shell.taper is not None:
        rows.append(("taper", f"factors along {shell.taper.along}, across {shell.taper.across}"))
    for k, strip in enumerate(shell.strips):
        own = "" if strip.material is None else f"; {material_words(strip.material)}"
        text = f"from {strip.start:g} to {strip.end:g} m: {1e3 * strip.thickness:.6g} mm{own}"
        rows.append((f"strip {k + 1}", text))
    for k, stiffener in enumerate(shell.stiffeners, 1):
        own = "" if stiffener.material is None else f"; {material_words(stiffener.material)}"
        section, (r, z) = stiffener.section, stiffener.offset
        sides = f"{1e3 * section.width:.6g} x {1e3 * section.depth:.6g} mm"
        place = f"its centre {1e3 * r:.6g} mm (radial) and {1e3 * z:.6g} mm (axial) from the middle of the wall"
        rows.append((f"stiffener {k}", f"at {stiffener.at:g} m: {sides}, {place}{own}"))
    rows += support_rows(shell.supports)
    rows += [(f"edge {edge}", "free") for edge in shell.chart.edges if edge not in shell.supports]
    rows += [(f"{name} imperfection", waves_of(field)) for name, field in shell.defects.items()]
    mesh = shell.mesh
    rows.append(("mesh", f"order {mesh.order}, {len(mesh.breaks) - 1} rows, {mesh.columns} elements around"))
    return tuple(rows)


def mesh_rows(structure: Solid | MeshShell) -> tuple[tuple[Cell, ...], ...]:
    """File, cells, size, materials and supports of an imported part."""
    mesh = structure.mesh
    box = " x ".join(f"{length:.4g}" for length in np.ptp(mesh.points[mesh.used], axis=0))
    rows = [("mesh", f"{Path(mesh.source).name}: {len(mesh.cells)} {mesh.kind} cells, {len(mesh.used)} nodes")]
    rows.append(("box", f"{box} m"))
    if isinstance(structure, MeshShell):
        parts = [f"{1e3 * structure.thickness:.6g} mm"]
        parts += [f"{name} {1e3 * value:.6g} mm" for name, value in structure.thicknesses.items()]
        rows.append(("thickness", ", ".join(parts)))
    rows.append(("material", material_words(structure.material)))
    rows += [(f"material of {name}", material_words(one)) for name, one in structure.materials.items()]
    if isinstance(structure, MeshShell):
        rows += [(f"ply {k}", ply_words(ply, structure)) for k, ply in enumerate(structure.plies, 1)]
    if mesh.attachments:
        rows.append(("attached", repr(mesh.attachments)))
    return tuple(rows + support_rows(structure.supports, "group"))


def support_rows(supports: Mapping[str, object], what: str = "edge") -> list[tuple[str, str]]:
    """Rows on the support of each edge or group; a ring with its section and its own support."""
    rows = []
    for name, one in supports.items():
        rows.append((f"{what} {name}", f"{spaced(one).lower()} {support_words(one)}".strip()))
        if isinstance(one, Ring) and one.support is not None:
            rows.append((f"ring of {what} {name}", f"{spaced(one.support).lower()} {support_words(one.support)}"))
    return rows


def support_words(support: object) -> str:
    """The numbers of a support, and the variation of its springs around."""
    words = values_of(support)
    if isinstance(support, Ring):
        section = f"{1e3 * support.section.width:.6g} x {1e3 * support.section.depth:.6g} mm"
        own = None if support.material is None else material_words(support.material)
        return ", ".join(part for part in (section, own, words) if part)
    if isinstance(support, ElasticEdge) and support.patterns:
        shared = not isinstance(support.around, Mapping)
        patterns = {"around": support.pattern("k_face")} if shared else support.patterns
        return words + "".join(f"; {name}: {waves_of(pattern)}" for name, pattern in patterns.items())
    return words


def material_words(material: Material) -> str:
    """The numbers of a material.

    >>> material_words(Material(E=210e9, nu=0.3, rho=7800.0))
    'E 210 GPa, nu 0.3, rho 7800 kg/m³'
    """
    return f"E {1e-9 * material.E:.5g} GPa, nu {material.nu:g}, rho {material.rho:.6g} kg/m³"


def ply_words(ply: Ply, shell: Shell | MeshShell) -> str:
    """Thickness, angle and material of a layer."""
    thickness = shell.thickness * ply.thickness / sum(one.thickness for one in shell.plies)
    if (own := ply.lamina) is None:
        return f"{1e3 * thickness:.4g} mm of the material"
    moduli = ", ".join(f"{name} {1e-9 * getattr(own, name):.5g}" for name in ("E1", "E2", "G12", "G13", "G23"))
    return f"{1e3 * thickness:.4g} mm at {ply.angle_deg:g}°: {moduli} GPa, nu12 {own.nu12:g}, rho {own.rho:.6g} kg/m³"


def waves_of(pattern: object) -> str:
    """A field in one line: its harmonics, its survey, or its type."""
    if isinstance(pattern, SurveyField):
        off = len(pattern.set_aside) + len(pattern.doubted)
        stray = f", {off} stray points" if off else ""
        return (
            f"{pattern.points} points at {pattern.heights} heights of {Path(pattern.path).name}{stray}; harmonics to "
            f"{pattern.max_harmonic}, residual {1e6 * pattern.residual_rms_m:.3g} µm (rms)"
        )
    if not isinstance(pattern, FourierField):
        return spaced(pattern).lower()
    terms = [(p, *pattern.coefficients(p)) for p in pattern.harmonics]
    words = [f"p = {p}: {cos:+.3g} cos {sin:+.3g} sin" for p, cos, sin in terms[:SHOWN]]
    return ", ".join(words) + (f" and {len(terms) - SHOWN} more harmonics" if len(terms) > SHOWN else "")


def modes_section(found: ModeSet, reference: Modes | None, *, updated: bool = False) -> Section:
    """Frequencies by n, shapes, rims, and the table; `updated`: an update follows, which changes the frequencies."""
    counted = "could not be computed" if found.sturm_count is None else f"is {found.sturm_count}"
    paragraphs = [
        f"{len(found)} modes of {found.dofs:,} unknowns. The Sturm count, the number of modes up to the last one by "
        f"inertia, {counted}."
    ]
    if updated:
        paragraphs.insert(0, "The structure has the values of the study here, before the update.")
    wide = [k for k in range(len(found.doublets)) if found.splits[k] > 1e-4]
    if wide:
        k = max(wide, key=lambda k: float(found.splits[k]))
        n = found.nodal_diameters[found.doublets[k][0]]
        paragraphs.append(
            f"{len(wide)} of {len(found.doublets)} doublets are split by more than 0.01 %, n = {n} the most: "
            f"by {100.0 * found.splits[k]:.3g} %."
        )
    figures = [Picture.of(figure_frequencies(found, reference), frequencies_caption(found, reference))]
    closed = found.rings is not None
    which, words = ("one of each pair, ", "radial") if closed else ("", "normal")
    shown = groups(found, 2 * TURNED)
    if shown:
        caption = (
            f"The lowest modes, {which}drawn exaggerated and slowed to one speed; colour is the {words} displacement, "
            "red outward and blue inward."
        )
        if isinstance(found, Modes) and found.shell.defects:
            caption += " The other pictures show the imperfections of the shell."
        figures.append(turning_shapes(found, [group[0] for group in shown[:TURNED]], caption))
    if shown and isinstance(found, Modes) and closed:
        figures.append(
            Picture.of(
                figure_rim(found, shown[:8]),
                "Radial displacement around the edge that moves most, seen along the axis: lower member of each pair "
                "solid blue, upper dashed orange, the undeformed circle grey. Ticks outside and the angle in the "
                "middle give the first antinode; they are left out where equal frequencies leave the orientation "
                "undetermined.",
            )
        )
    table = Table.of(f"All {len(found)} modes", found.COLUMNS, found.records(), folded=True)
    return Section("Modes", tuple(paragraphs), tuple(figures), (table,))


def campbell_section(structure: Shell | MeshStructure, count: int) -> Section:
    """Frequencies over speed with engine orders, up to one and a half times the speed of the study."""
    rotation = rotation_of(structure)
    assert rotation is not None
    try:
        found = campbell(structure, np.linspace(0.0, 1.5 * abs(rotation.omega), SPEEDS), min(count, FOLLOWED))
    except ModelError as error:
        return Section("Campbell diagram", (f"The diagram could not be computed: {error}.",))
    return Section(
        "Campbell diagram",
        figures=(
            Picture.of(found.plot(), "Frequencies over speed, without Coriolis forces; lines are engine orders."),
        ),
        tables=(Table.of("Speeds at which an engine order coincides with a mode.", MODES, found.modes_met()),),
    )


def frequencies_caption(found: ModeSet, reference: Modes | None) -> str:
    """Caption of the frequency diagram."""
    if found.rings is None:
        return "Frequencies in ascending order."
    words = "Frequencies by number of nodal diameters; a bar joins the two members of a pair, its length is the split."
    if reference is None:
        return words + " This shell is axisymmetric, so the two modes of each pair have the same frequency."
    return (
        words
        + " Grey: the same shell without imperfections, where the two modes of a pair have the same frequency; one "
        "line for each m."
    )


def reduction_section(basis: ModalBasis, *, updated: bool) -> Section:
    """The modal basis in numbers."""
    which = "updated" if updated else "given"
    rows: tuple[tuple[Cell, ...], ...] = (
        ("interface", f"{basis.kind}, {len(basis.channels)} channels"),
        ("method", str(basis.provenance.get("method", "-"))),
        ("modes", f"{len(basis)}, from {basis.freq[0]:.2f} to {basis.freq[-1]:.1f} Hz"),
        ("damping ratio", f"up to {basis.zeta.max():g}"),
        ("share of S in the static compliance", f"{100.0 * basis.S.trace() / basis.compliance.trace():.2f} %"),
    )
    paragraph = (
        f"The {which} structure, reduced to the channels at which contact acts. S is the residual compliance, the "
        "static response of all omitted modes: with it, the static response to forces at the channels is that of the "
        "full model."
    )
    return Section("Reduction", (paragraph,), tables=(Table("The modal basis.", ("quantity", "value"), rows),))


def provenance_section(study: Study | MeshStudy, seconds: dict[str, float]) -> Section:
    """Hash, versions, run times."""
    source = study.source
    versions: tuple[tuple[Cell, ...], ...] = tuple(source["versions"].items())
    rows: tuple[tuple[Cell, ...], ...] = (("input", f"{source['study']}, sha256 {source['sha256']}"), *versions)
    times: tuple[tuple[Cell, ...], ...] = tuple((name, round(value, 2)) for name, value in seconds.items())
    tables = (Table("Input and versions.", ("", ""), rows), Table("Run times.", ("part", "seconds"), times))
    return Section("Provenance", tables=tables)
