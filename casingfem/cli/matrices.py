"""Commands on matrices: import those of another program as a basis, export those of a study."""

from dataclasses import asdict
from pathlib import Path

import click

from casingfem.cli.progress import ProgressMessage
from casingfem.cli.running import collected, deliver, free_way, options, with_exit_codes
from contact.io.outfiles import json_text, write_files

TABLE = click.Path(path_type=Path)


def node_list(context: click.Context, option: click.Parameter, value: str | None) -> list[int] | None:
    """List of node numbers, such as 6,79."""
    if value is None:
        return None
    parts = [part.strip() for part in value.split(",")]
    if not all(part.isdecimal() for part in parts):
        raise click.BadParameter(f"found {value!r}, expected node numbers such as 6,79", context, option)
    return list(map(int, parts))


@click.command(name="import")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--nodes",
    type=TABLE,
    metavar="CSV",
    help="Table node,x,y,z, optionally xx,xy,xz,yx,yy,yz (axes of the node); contact nodes without --contact.",
)
@click.option(
    "--dofs", type=TABLE, metavar="CSV", help="Table node,direction with one line for each row of the matrices."
)
@click.option(
    "--contact", callback=node_list, metavar="6,79", help="Nodes with contact, such as 6: channels 6.x 6.y 6.z ..."
)
@click.option(
    "--units", default="m-kg-s", show_default=True, help="Units of length, mass and time in the files, such as mm-t-s."
)
@click.option("--modes", "count", type=click.IntRange(1), default=20, show_default=True, help="Modes kept.")
@click.option(
    "--zeta",
    type=click.FloatRange(0.0, 1.0, max_open=True),
    default=0.0,
    help="Damping ratio if there is neither C nor K4.",
)
@click.option("--nonsymmetric", is_flag=True, help="K and C may be nonsymmetric, as with cross-coupled bearings.")
@click.option("--out", type=TABLE, metavar="NPZ", help="Write the basis there.", callback=free_way)
@click.option("--json", "as_json", is_flag=True, help="One JSON document on stdout, nothing else.")
@with_exit_codes
def import_matrices(
    files: tuple[Path, ...],
    nodes: Path | None,
    dofs: Path | None,
    contact: list[int] | None,
    units: str,
    count: int,
    zeta: float,
    nonsymmetric: bool,
    out: Path | None,
    as_json: bool,
) -> None:
    """Reduce the matrices M, K and maybe C, K4 and G of another program to a basis, and report their properties.

    FILE: DMIG cards (.pch, .bdf), OP4, CalculiX's .sti, .mat, HDF5 or npz, or the .mtx files of stiffness and mass.
    A superelement of Nastran: part.op4 part.pch, the latter gives rows (EXTRN), nodes and their axes (GRID, CORD).
    G is a gyroscopic matrix, skew, per rad/s of the speed: name G, or with GYRO or CORIOLIS in it.
    Reduced sets (Craig-Bampton) are also accepted; their modal dofs are scalars, direction q or 0.
    """
    from casingfem.errors import InputError
    from casingfem.structure.imported.matrix.read import read_matrices
    from casingfem.structure.imported.matrix.tables import read_nodes
    from contact.model.bodies.from_matrices import body_of
    from contact.model.bodies.matrices import Matrices
    from contact.model.bodies.matrix_checks import DIRECTIONS

    if out is not None and out.suffix != ".npz":
        raise click.UsageError(f"--out: found {out.name!r}, expected a file name ending in .npz")
    with ProgressMessage(f"import of {files[0].name}") as working:
        read = read_matrices(files, nodes=nodes, dofs=dofs)
        seen = contact if contact is not None else list(read.boundary if nodes is None else read_nodes(nodes))
        if not seen:
            raise InputError(str(files[0]), found="no nodes with contact", expected="--contact, --nodes, or EXTRN")
        labels = [(node, DIRECTIONS[direction]) for node, direction in read.dofs.tolist()]
        matrices = Matrices.of(
            read.M, read.K, read.C, K4=read.K4, G=read.G, nonsymmetric=nonsymmetric, dofs=labels, units=units,
            axes=read.axes, points={n: x.tolist() for n, x in read.points.items()},
        )  # fmt: skip
        body, facts = body_of(matrices, seen, modes=min(count, matrices.size), zeta=zeta)
    document = {
        "file": None if out is None else str(out),
        "freq_hz": (body.omega / 6.283185307179586).tolist(),
        "zeta": body.zeta.tolist(),
        "channels": list(body.channels),
        "matrices": asdict(facts),
        "words": facts.words,
        "left_out": list(read.left_out),
        "seconds": working.seconds,
        "warnings": collected(),
    }
    if out is not None:
        write_files(out.parent, {out.name: body.save})
    if as_json:
        click.echo(json_text(document), nl=False)
        return
    unused = f"matrices left out: {', '.join(read.left_out)}\n" if read.left_out else ""
    click.echo(f"{facts}\n{unused}{body}\n" + ("not written: give --out FILE.npz" if out is None else f"wrote {out}"))


@click.command(name="export")
@click.argument("file", metavar="STUDY|BASIS", type=click.Path(path_type=Path))
@click.option(
    "--format", "form", type=click.Choice(["mtx", "pch", "op4", "npz", "mat"]), default="mtx", show_default=True
)
@options
def export_matrices(file: Path, form: str, as_json: bool, out: Path | None) -> None:
    """Write the matrices of the structure of STUDY, or of BASIS (an npz), for other programs, SI, to --out DIR.

    A basis is written as channels and scalars; with residual compliance its channels have no mass.
    """
    from casingfem.modal.basis import ModalBasis
    from casingfem.modal.matrices import basis_matrices, structure_matrices
    from casingfem.structure.imported.matrix.write import matrix_files
    from casingfem.study import load_study

    with ProgressMessage(f"matrices of {file.name}") as working:
        if file.suffix == ".npz":
            matrices = basis_matrices(ModalBasis.load(file))
        else:
            matrices = structure_matrices(load_study(file).structure)
        files = matrix_files(matrices, file.stem + ("_matrices" if form == "npz" else ""), form)
    document = {"files": list(files), "dofs": len(matrices.dofs), "seconds": working.seconds}
    text = f"{len(matrices.dofs)} unknowns" + ("" if out is not None else ", not written: give --out DIR")
    deliver(document, text, as_json=as_json, out=out, files=files)
