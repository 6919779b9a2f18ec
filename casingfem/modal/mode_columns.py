"""Columns of a table of modes, for all structures: a casing, an imported part, a wheel from one sector."""

from typing import NamedTuple

from casingfem.io.arrays import BoolArray, FloatArray, IntArray
from contact.io.columns import Column, known, mark, present


class ModeRows(NamedTuple):
    """Arrays (modes,) for the columns; nan, or -1 for n and doublet, if a mode has no such value.

    freq [Hz], n, share of n, rank m, number of the doublet from 1, its relative split, angle [deg], rigid or not.
    """

    freq: FloatArray
    n: IntArray
    purity: FloatArray
    m: IntArray
    doublet: IntArray
    split: FloatArray
    angle_deg: FloatArray
    rigid: BoolArray


COLUMNS = (
    Column("mode", "Number of the mode, from 1.", lambda rows: range(1, len(rows.freq) + 1), format="d"),
    Column("freq_hz", "Natural frequency.", lambda rows: rows.freq, head="freq", unit="Hz", format=".3f"),
    Column("n", "Nodal diameters; none on open shells.", lambda rows: known(rows.n), format="d"),
    Column("n_purity", "Share of n in the circumferential energy of the shape.", lambda rows: present(rows.purity),
           head="share of n", format=".2f"),
    Column("m", "Rank among the modes of the same n, from 1; a doublet counts once.", lambda rows: rows.m, format="d"),
    Column("doublet", "Number of the doublet that the mode belongs to, from 1.", lambda rows: known(rows.doublet),
           format="d", where="files"),
    Column("split_rel", "Difference of a doublet's frequencies over their mean.", lambda rows: present(rows.split),
           head="split", unit="%", format=".4f", scale=100.0),
    Column("angle_deg", "Angle of an antinode of the radial displacement.", lambda rows: present(rows.angle_deg),
           head="angle", unit="deg", format=".2f"),
    Column("rigid", "Whether the mode is a rigid motion.", lambda rows: rows.rigid, head="motion",
           format=mark("rigid")),
)  # fmt: skip
