"""A wheel, tuned or mistuned, as a modal basis with channels at the tips of all its blades."""

import numpy as np

from casingfem.errors import ModelError
from casingfem.io.arrays import FloatArray
from casingfem.modal.basis import ModalBasis
from casingfem.modal.cyclic.mistuned import Deviations, checked_deviations, mixed, richer
from casingfem.modal.cyclic.waves import wheel_waves
from casingfem.modal.interface.kinds import AtNodes, Interface, Rim
from casingfem.modal.interface.mesh_rows import node_places
from casingfem.modal.interface.view import view
from casingfem.modal.reduction import provenance
from casingfem.structure.geometry.rotation import axis_frame
from casingfem.structure.imported.assembly import MeshSystem
from casingfem.structure.imported.cyclic.sector import CyclicSector, assemble_cyclic
from casingfem.structure.imported.cyclic.wheel import blade_stiffness

DIRECTIONS = ("span", "flap", "chord")
OF_A_DIAMETER = 6  # modes of each kept, by default


def cyclic_reduce(
    sector: CyclicSector,
    interface: Interface,
    *,
    modes: int = OF_A_DIAMETER,
    zeta: float = 0.0,
    deviations: Deviations | None = None,
    blade: str | None = None,
) -> ModalBasis:
    """Reduce a wheel to its tips: N sectors times the channels of one, as a body for the blades of a rub.

    Parameters
    ----------
    sector
        One supported sector.
    interface
        `Tip`, `TipNodes` or `AtNodes` of the sector; at nodes span is radial, flap along growing angles, chord along
        the axis. Channels sector0.span, sector0.flap, ..., in axes rotated with each sector.
    modes
        Number of kept modes of each nodal diameter, with pairs counted once; the wheel has N times as many.
    zeta
        Damping ratio given to every mode.
    deviations, blade
        Mistuning, as in `mistuned_modes`.

    Raises
    ------
    ModelError
        The errors of `reduce` and `mistuned_modes`; `interface-edge` for a rim.

    Examples
    --------
    >>> import casingfem as cf
    >>> wall = cf.imported.revolved((0.5, 0.45), (0.0, 0.25), 0.12)
    >>> part = cf.imported.grid_mesh("hexahedron20", (1, 3, 1), lambda u: wall(u * [1.0, 0.125, 1.0]),
    ...                              groups={"base": (2, 0.0), "top": (2, 1.0)})
    >>> held = cf.Solid(mesh=part, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
    >>> sector = cf.imported.CyclicSector(structure=held, sectors=8)
    >>> basis = cyclic_reduce(sector, cf.Tip("top"), modes=1)
    >>> basis.sectors, len(basis), basis.channels[0]
    (8, 8, 'sector0.span')
    """
    if isinstance(interface, Rim):
        found = "interface: found a Rim on a wheel, expected Tip, TipNodes or AtNodes"
        raise ModelError("interface-edge", found)
    if not 0.0 <= zeta < 1.0:
        raise ModelError("reduce-damping", f"zeta must lie in [0, 1), found {zeta!r}")
    if not any(sector.structure.supports.values()):
        raise ModelError("reduce-rigid", "found a structure without supports, expected one without rigid motions")
    values = None if deviations is None else checked_deviations(deviations, sector.sectors)
    mistuned = values is not None and bool(values.any())
    system = assemble_cyclic(sector)
    if not 1 <= modes < system.system.size // 2:
        raise ModelError("modes-count", f"modes must lie between 1 and {system.system.size // 2 - 1}, found {modes!r}")
    seen = view(system.system, interface)
    P, channels = seen.loads, seen.channels
    if isinstance(interface, AtNodes):
        P, channels = cylindrical(sector, system.system, interface, P)
    if not P.any():
        raise ModelError("interface-held", "interface: found fixed nodes, where forces have no effect")
    stiff = blade_stiffness(sector.structure, system.system, blade) if mistuned else None
    waves = wheel_waves(system, richer(modes) if mistuned else modes, P, stiff)
    omega, turn = mixed(waves, values if mistuned else None)
    rows, count = waves.rows() @ turn, sector.sectors * modes
    rest = rows[:, count:] / omega[count:]
    rotation = sector.structure.rotation
    kept = turn[:, :count]
    added, gyroscopic = (
        np.zeros((0, 0)) if rotation is None else kept.T @ A @ kept for A in (waves.added, waves.gyroscopic)
    )
    sense = 1.0 if rotation is None else float(np.sign(rotation.direction @ np.asarray(sector.axis)))
    return ModalBasis(
        omega=omega[:count],
        zeta=np.full(count, zeta),
        channels=tuple(f"sector{j}.{name}" for j in range(sector.sectors) for name in channels),
        rows=rows[:, :count],
        S=rest @ rest.T,
        kind="point",
        sectors=sector.sectors,
        spin=0.0 if rotation is None else sense * rotation.omega + 0.0,
        gyroscopic=0.5 * sense * (gyroscopic - gyroscopic.T),
        stiffness_by_speed=0.5 * (added + added.T),
        provenance=provenance(system.system, "cyclic", modes)
        | seen.facts
        | {"sectors": sector.sectors, "mistuning": None if values is None else values.tolist()},
    )


def cylindrical(
    sector: CyclicSector, system: MeshSystem, at: AtNodes, P: FloatArray
) -> tuple[FloatArray, tuple[str, ...]]:
    """Loads at nodes along the radius, the angle and the axis, (free, channels), and their names."""
    e1, e2, a = axis_frame(sector.axis)
    across = sector.turn.across(system.points[node_places(system, at.nodes)])
    if not np.all(np.abs(across) > 1e-9 * system.structure.mesh.size):
        number = at.nodes[int(np.abs(across).argmin())]
        raise ModelError("interface-nodes", f"at: found node {number} on the wheel's axis")
    c, s = (across / np.abs(across)).real[:, None], (across / np.abs(across)).imag[:, None]
    units = np.stack([c * e1 + s * e2, c * e2 - s * e1, np.broadcast_to(a, (len(across), 3))], axis=1)
    turned = np.einsum("fkc,kdc->fkd", P.reshape(len(P), -1, 3), units).reshape(len(P), -1)
    return turned, tuple(f"{number}.{name}" for number in at.nodes for name in DIRECTIONS)
