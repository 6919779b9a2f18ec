"""Files of the test rig: universal files with geometry, and the table of its own modes; all are marked SYNTHETIC."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from textwrap import wrap

import numpy as np

from casingfem.experiment.frequency_table import FrequencyTable
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.rig import SYNTHETIC, Rig
from casingfem.experiment.rig.scan import circle_content
from casingfem.experiment.uff.nodes import HEADER_LINES, Nodes, TraceLine, Units
from casingfem.experiment.uff.write import write_uff

WIDTH = 80  # columns of a line of text in a universal file
COLOR = 8
PACKAGES = ("casingfem", "numpy", "scipy")
EXACT = 1e-9  # relative uncertainty that a table must have


def origin(rig: Rig, source: str = "") -> tuple[str, ...]:
    """Comment lines on the origin of a file: versions, the hash of the rig's numbers, and a source.

    >>> origin(Rig.of(omega=[9.0], zeta=0.01, rows=[[1.0]]))[1][:20]
    'rig: sha256 0665c6bb'
    """
    parts = (rig.omega, rig.zeta, rig.rows, rig.S)
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()
    versions = []
    for package in PACKAGES:
        try:
            versions.append(f"{package} {version(package)}")
        except PackageNotFoundError:  # a copy that was not installed
            versions.append(f"{package}, not installed")
    return (f"versions: {', '.join(versions)}", f"rig: sha256 {digest}", *((source,) if source else ()))


def write_rig_uff(path: str | os.PathLike[str], rig: Rig, sets: Sequence[FrfSet]) -> Path:
    """Write sets of functions with the rig's nodes: sets 151, 164 (SI), 2411, 82, 58b.

    The header and each function's text are marked SYNTHETIC first; the header has the first lines of the card.

    Raises
    ------
    ValueError
        The sets are not marked SYNTHETIC, so they are not the rig's.

    Examples
    --------
    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> rig = cf.rig.rig_of(cf.modes(casing, 2), [cf.rig.Place(at=(0.1, angle)) for angle in (0.0, 1.0)], zeta=0.002)
    >>> import tempfile
    >>> frfs = rig.frfs([400.0, 500.0, 600.0], sensors=[0, 1], drives=[0])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = write_rig_uff(f"{folder}/rig.uff", rig, [frfs])
    ...     len(cf.uff.read_uff(file).functions)
    2
    """
    for functions in sets:
        if not functions.card or not functions.card[0].startswith("SYNTHETIC"):
            raise ValueError(f"{path}: found a set whose card does not begin with SYNTHETIC, expected the rig's own")
    card = list(dict.fromkeys(line for functions in sets for line in functions.card))
    header = [part for line in card for part in wrap(line, WIDTH, subsequent_indent="  ")][:HEADER_LINES]
    text = tuple(line[:WIDTH] for line in (SYNTHETIC, *card[1:4]))
    nodes = rig_nodes(rig)
    return write_uff(
        path,
        header=header,
        units=Units(),
        nodes=nodes,
        lines=[TraceLine(number=1, name="probes", color=COLOR, nodes=nodes.labels)],  # as test software draws them
        functions=[replace(function, text=text) for functions in sets for function in functions.functions()],
        binary=True,
    )


def rig_nodes(rig: Rig) -> Nodes:
    """Each node of the probes, once."""
    places = {probe.node: probe.point for probe in rig.probes}
    none = np.zeros(len(places), np.int64)
    return Nodes(labels=np.array(list(places)), points=np.array(list(places.values())), systems=none, motions=none)


def rig_angles(rig: Rig) -> dict[int, float]:
    """Angle about the axis [deg] of every node, in the form for `identify`.

    >>> import casingfem as cf
    >>> casing = cf.Shell(chart=cf.Cylinder(radius=0.3, height=0.1), thickness=4e-3, supports={"base": cf.Clamped()},
    ...                   material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    ...                   mesh=cf.ShellMesh(order=6, rows=2, around=9))
    >>> rig = cf.rig.rig_of(cf.modes(casing, 2), [cf.rig.Place(at=(0.1, angle)) for angle in (0.0, 1.0)], zeta=0.002)
    >>> {node: round(angle, 3) for node, angle in rig_angles(rig).items()}
    {1: 0.0, 2: 57.296}
    """
    return {probe.node: float(np.degrees(probe.angle)) for probe in rig.probes}


def truth(rig: Rig, circle: Sequence[int] = (), card: Sequence[str] = ()) -> FrequencyTable:
    """Frequencies and damping of the rig's modes and, from shapes on a circle of probes, n and antinodes.

    They belong to the structure with all its sensors attached. Without a circle there are no labels.

    >>> truth(Rig.of(omega=[600.0], zeta=0.01, rows=[[1.0]])).zeta.tolist()
    [0.01]
    """
    n = np.full(len(rig), -1)
    angle = np.full(len(rig), np.nan)
    if len(circle):
        orders, transform = circle_content(rig, circle)
        content = (transform @ rig.rows[list(circle)])[orders >= 0]
        n = np.abs(content).argmax(axis=0)
        phase = np.angle(content[n, np.arange(len(rig))])
        with np.errstate(divide="ignore", invalid="ignore"):
            angle = np.where(n > 0, np.mod(np.degrees(-phase) / n, 180.0 / n), np.nan)
    return FrequencyTable.from_arrays(
        freq_hz=rig.freq,
        sigma_hz=EXACT * rig.freq,
        n=n,
        angle_deg=angle,
        zeta=rig.zeta,
        card=(SYNTHETIC, "the rig's own modes, which its records are made of: the truth, not a test's result", *card),
    )
