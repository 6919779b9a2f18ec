"""Sections of the report: what went in, modes, reduction, provenance."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path

from casingfem.modal.basis import ModalBasis
from casingfem.modal.mode_set import Modes
from casingfem.plot.modes import figure_frequencies, figure_rim, groups
from casingfem.plot.page import Cell, Picture, Section, Table
from casingfem.plot.shapes import moving_shapes
from casingfem.structure.edge.support import ElasticEdge
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.shell.shell import Shell
from casingfem.study import Study

UNITS = {
    "angle": "rad",
    "twist": "rad",
    "camber": "rad",
    "k_r": "N/m²",
    "k_theta": "N/m²",
    "k_z": "N/m²",
    "k_rot": "N",
    "k_face": "N/m³",
    "E": "Pa",
    "nu": "",
    "rho": "kg/m³",
}


def inputs_section(study: Study) -> Section:
    """The structure in one table, and the card of the measured table."""
    tables = [Table("The structure as the study describes it.", ("quantity", "value"), structure_rows(study.shell))]
    paragraphs = []
    if study.table is not None:
        name = "Synthetic" if study.table.synthetic else "Measured"
        paragraphs.append(f"{name} frequencies: {len(study.table)} rows of {Path(study.table.path).name}; its card:")
    if study.shapes is not None and study.file.update is not None:
        name = Path(str(study.file.update.shapes)).name
        paragraphs.insert(0, f"Mode shapes at {len(study.shapes.a)} sensors from {name}.")
    card = "\n".join(study.table.card) if study.table is not None else ""
    return Section("Inputs", tuple(paragraphs), tables=tuple(tables), preformatted=card)


def structure_rows(shell: Shell) -> tuple[tuple[Cell, ...], ...]:
    """Chart, thickness, material, supports, fields, mesh."""
    rows = [("surface", f"{type(shell.chart).__name__}: {values_of(shell.chart)}")]
    rows.append(("thickness", f"{shell.thickness:.6g} m"))
    rows.append(("material", f"E = {shell.material.E:.6g} Pa, nu = {shell.material.nu:g}, "
                 f"rho = {shell.material.rho:.6g} kg/m³"))  # fmt: skip
    if shell.taper is not None:
        rows.append(("taper", f"factors along {shell.taper.along}, across {shell.taper.across}"))
    for k, strip in enumerate(shell.strips):
        own = "" if strip.material is None else f"; {values_of(strip.material)}"
        text = f"from {strip.start:g} to {strip.end:g} m: {strip.thickness:.6g} m{own}"
        rows.append((f"strip {k + 1}", text))
    for edge, support in shell.supports.items():
        rows.append((f"edge {edge}", f"{type(support).__name__} {values_of(support)}".strip()))
    rows += [(f"edge {edge}", "free") for edge in shell.chart.edges if edge not in shell.supports]
    rows += [(f"{name} imperfection", repr(field).splitlines()[0]) for name, field in shell.defects.items()]
    mesh = shell.mesh
    rows.append(("mesh", f"order {mesh.order}, {len(mesh.breaks) - 1} rows, {mesh.around} elements around"))
    return tuple(rows)


def values_of(owner: object) -> str:
    """The numbers of a value object, zeros left out."""
    if not is_dataclass(owner):
        return repr(owner)
    numbers = {f.name: getattr(owner, f.name) for f in fields(owner)}
    plain = [f"{k} = {v:g} {UNITS.get(k, 'm')}" for k, v in numbers.items() if isinstance(v, int | float) and v != 0.0]
    laws = {k: ", ".join(f"{station:g}" for station in v) for k, v in numbers.items() if isinstance(v, tuple)}
    plain += [f"{k} = ({law}) {UNITS.get(k, 'm')}" for k, law in laws.items()]
    if isinstance(owner, ElasticEdge) and owner.patterns:
        shared = not isinstance(owner.around, Mapping)
        patterns = {"around": owner.pattern("k_face")} if shared else owner.patterns
        waves = [f"; {name}: {waves_of(pattern)}" for name, pattern in patterns.items()]
        return ", ".join(plain) + "".join(waves)
    return ", ".join(plain)


def waves_of(pattern: object) -> str:
    """A pattern along an edge in one line: its harmonics, or what kind of field it is."""
    if not isinstance(pattern, FourierField):
        return repr(pattern).splitlines()[0]
    terms = [(p, *pattern.coefficients(p)) for p in pattern.harmonics]
    return ", ".join(f"p = {p}: {cos:+.3g} cos {sin:+.3g} sin" for p, cos, sin in terms)


def modes_section(found: Modes, reference: Modes | None) -> Section:
    """Frequencies by n, shapes, rims, and the table."""
    counted = "could not be taken" if found.sturm_count is None else f"is {found.sturm_count}"
    paragraphs = [
        f"{len(found)} modes of {found.dofs} unknowns. The Sturm count, the number of modes up to the last one by "
        f"inertia, {counted}."
    ]
    wide = [k for k in range(len(found.doublets)) if found.splits[k] > 1e-4]
    if wide:
        k = max(wide, key=lambda k: float(found.splits[k]))
        n = found.nodal_diameters[found.doublets[k][0]]
        paragraphs.append(
            f"{len(wide)} of {len(found.doublets)} doublets are split by more than 0.01 %, n = {n} the most: "
            f"by {100.0 * found.splits[k]:.3g} %."
        )
    figures = [Picture.of(figure_frequencies(found, reference), frequencies_caption(found, reference))]
    shown = groups(found, 8)
    if shown:
        first = [group[0] for group in shown[:6]]
        which, words = ("one of each pair, ", "radial") if found.shell.chart.periodic else ("", "normal")
        figures.append(
            moving_shapes(
                found,
                first,
                f"The lowest modes, {which}drawn exaggerated and slowed to one speed; colour is the {words} "
                "displacement, red outward and blue inward.",
            )
        )
    if shown and found.shell.chart.periodic:
        figures.append(
            Picture.of(
                figure_rim(found, shown),
                "Radial displacement around the edge that moves most, seen along the axis: lower member of each pair "
                "solid blue, upper dashed orange, the undeformed circle grey. Ticks outside and the angle in the "
                "middle give the first antinode where a mode has an orientation of its own; equal frequencies leave "
                "it open.",
            )
        )
    return Section("Modes", tuple(paragraphs), tuple(figures), (modes_table(found, reference),))


def frequencies_caption(found: Modes, reference: Modes | None) -> str:
    """What the frequency diagram shows."""
    if not found.shell.chart.periodic:
        return "Frequencies in ascending order."
    words = "Frequencies by number of nodal diameters; a bar joins the two members of a pair, its length is the split."
    if reference is None:
        return words + " Nothing varies around this shell, so its pairs are double."
    return (
        words + " Grey: the same shell without imperfections, all its pairs double, one line for each number of waves "
        "along the axis."
    )


def modes_table(found: Modes, reference: Modes | None) -> Table:
    """All modes, folded."""
    rows: list[tuple[Cell, ...]] = []
    for row in found.records():
        split = row["split_rel"]
        rows.append(
            (
                int(str(row["mode"])),
                f"{row['freq_hz']:.3f}",
                "rigid" if row["rigid"] else None if row["n"] is None else int(str(row["n"])),
                None if row["n_purity"] is None else round(float(str(row["n_purity"])), 3),
                int(str(row["m"])),
                None if split is None else f"{100.0 * float(str(split)):.4f}",
                None if row["angle_deg"] is None else f"{row['angle_deg']:.2f}",
            )
        )
    columns = ("mode", "frequency [Hz]", "n", "share of n", "m", "split [%]", "antinode [deg]")
    return Table(f"All {len(found)} modes", columns, tuple(rows), folded=True)


def reduction_section(basis: ModalBasis, *, updated: bool) -> Section:
    """The modal basis in numbers."""
    which = "updated" if updated else "given"
    rows: tuple[tuple[Cell, ...], ...] = (
        ("interface", f"{basis.kind}, {len(basis.channels)} channels"),
        ("method", str(basis.provenance.get("method", "-"))),
        ("modes", f"{len(basis)}, from {basis.freq[0]:.2f} to {basis.freq[-1]:.1f} Hz"),
        ("damping ratio", f"{basis.zeta.max():g}"),
        ("static compliance carried by S", f"{100.0 * basis.S.trace() / basis.compliance.trace():.2f} %"),
    )
    paragraph = (
        f"The {which} structure reduced to what contact sees. S is the residual compliance: the static answer of "
        "all modes left out, so that a static push gives the full model's answer."
    )
    return Section("Reduction", (paragraph,), tables=(Table("The modal basis.", ("quantity", "value"), rows),))


def provenance_section(study: Study, seconds: dict[str, float]) -> Section:
    """Hash, versions, run times."""
    source = study.source
    versions: tuple[tuple[Cell, ...], ...] = tuple(source["versions"].items())
    rows: tuple[tuple[Cell, ...], ...] = (("input", f"{source['study']}, sha256 {source['sha256']}"), *versions)
    times: tuple[tuple[Cell, ...], ...] = tuple((name, round(value, 2)) for name, value in seconds.items())
    tables = (
        Table("What made this page.", ("", ""), rows),
        Table("Run times.", ("part", "seconds"), times),
    )
    return Section("Provenance", tables=tables)
