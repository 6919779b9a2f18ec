"""Following modes whose label is a toss-up: where two nodal diameters share a mode, either may name it.

Between two steps of an update a mode that is half n = 4 and half n = 12 may change its label, and its row of the table
is lost although the mode is there. Before a step is judged by the rows it lost, such modes are tried under their
second label.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from casingfem.arrays import IntArray
from casingfem.experiment.correlation import Pairing, pair
from casingfem.experiment.measurement import FrequencyTable
from casingfem.modal.harmonics import find_doublets, orientation
from casingfem.modal.mode_set import Modes, ranks

Rows = tuple[tuple[int, ...], ...]
MIXED = 0.25  # a second n with this share of a mode's energy may name it
MOST = 6  # mixed modes tried: 2^6 pairings at most


def paired_rows(pairing: Pairing) -> Rows:
    """Which rows of the table pair, and how they are grouped."""
    return tuple(sorted(match.rows for match in pairing.matches))


def keeps(pairing: Pairing, rows: Rows) -> bool:
    """Whether these rows still pair, grouped as they were; more may."""
    return set(rows) <= set(paired_rows(pairing))


def relabelled(modes: Modes, n: IntArray) -> Modes:
    """The same modes under other nodal diameters: doublets, orientations, ranks and purities follow."""
    if modes.rings is None:
        return modes
    shares = modes.rings.shares()
    pairs = find_doublets(modes.rings, n)
    angle = [orientation(modes.rings.profile(k, label), label) if label > 0 else np.nan for k, label in enumerate(n)]
    return replace(
        modes,
        nodal_diameters=n,
        purity=shares[n, np.arange(len(n))],
        doublets=tuple(pairs),
        meridional=ranks(n, pairs),
        angle_deg=np.degrees(angle),
    )


def followed(modes: Modes, table: FrequencyTable, reach: float, rows: Rows | None) -> tuple[Modes, Pairing]:
    """Modes and their pairing; if `rows` no longer pair, mixed modes are tried under their second label."""
    pairing = pair(modes, table, reach=reach)
    if rows is None or modes.rings is None or keeps(pairing, rows):
        return modes, pairing
    shares = modes.rings.shares()
    second = shares.argsort(axis=0)[-2]
    mixed = np.flatnonzero((shares[second, np.arange(len(modes))] > MIXED) & (modes.nodal_diameters > 0))
    mixed = mixed[np.argsort(-shares[second[mixed], mixed], kind="stable")][:MOST]
    choices = sorted(product((False, True), repeat=len(mixed)), key=sum)
    for choice in choices[1:]:
        n = modes.nodal_diameters.copy()
        turned = mixed[list(choice)]
        n[turned] = second[turned]
        other = relabelled(modes, n)
        found = pair(other, table, reach=reach)
        if keeps(found, rows):
            return other, found
    return modes, pairing
