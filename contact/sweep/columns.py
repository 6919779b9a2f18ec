"""Columns of a sweep, stored for every run. The varied keys come before them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contact.io.columns import Column, word


def kept(name: str) -> Callable[[Any], list[Any]]:
    """Values of a column in the rows of a sweep's result."""
    return lambda found: [row[name] for row in found.rows]


MEASURED = (
    Column("status", "Outcome: done, diverged, failed or refused.", kept("status"), format=word),
    Column("steps", "Number of steps.", kept("steps"), format="d", where="files"),
    Column("contact_fraction", "Fraction of the time with the contact closed; of several contacts, the largest.",
           kept("contact_fraction"), head="contact, part of the time", format=".4g"),
    Column("closings", "Number of closings of all contacts.", kept("closings"), format="d", where="files"),
    Column("impulse_N_s", "Impulse of all contacts.", kept("impulse_N_s"), head="impulse", unit="N s", format=".4g"),
    Column("peak_force_N", "Largest contact force.", kept("peak_force_N"), head="largest force", unit="N",
           format=".4g"),
    Column("max_penetration_m", "Largest penetration.", kept("max_penetration_m"), where="files"),
    Column("residual_m", "Largest violation of the contact law.", kept("residual_m"), where="files"),
    Column("lost_in_contact_J", "Energy lost in contacts.", kept("lost_in_contact_J"), where="files"),
    Column("friction_J", "Work of friction.", kept("friction_J"), where="files"),
    Column("damping_J", "Work of damping.", kept("damping_J"), where="files"),
    Column("rotation_J", "Work of the rotation of the rim.", kept("rotation_J"), where="files"),
    Column("worn_J", "Energy dissipated by wear of a coating.", kept("worn_J"), where="files"),
    Column("unaccounted_rel", "Energy that the budget does not account for, over its largest entry.",
           kept("unaccounted_rel"), head="energy not accounted for", format=".4g"),
    Column("amplitude_m", "Rms vibration of the rim in the last quarter; without a rim the largest displacement.",
           kept("amplitude_m"), head="amplitude", unit="m", format=".4g"),
    Column("blade_rms_m", "Rms vibration of the blade along the contact's normal in the last quarter.",
           kept("blade_rms_m"), where="files"),
    Column("motion", "Whether the motion grows, is bounded or decays; numerical: grows by the step only.",
           kept("motion"), format=word),
    Column("growth_1_s", "Growth rate of the motion.", kept("growth_1_s"), head="growth", unit="1/s", format=".4g"),
    Column("growth_low_1_s", "Lower end of the 95 % interval of the growth rate.", kept("growth_low_1_s"),
           where="files"),
    Column("growth_high_1_s", "Upper end of the 95 % interval of the growth rate.", kept("growth_high_1_s"),
           where="files"),
    Column("growth_check", "Growth at half the step, if a motion grows: converged, numerical, irregular or depends "
           "on the step.", kept("growth_check"), head="half the step", format=word),
    Column("half_wall_at_s", "Time at which the rim moves by half of its wall, at this growth.",
           kept("half_wall_at_s"), head="half the wall at", unit="s", format=".4g"),
    Column("body", "Body with most of the motion.", kept("body"), format=word),
    Column("n", "Nodal diameters of the motion.", kept("n"), format="d"),
    Column("source", "Source of the energy of the motion.", kept("source"), head="energy from", format=word),
    Column("dominant_n", "Nodal diameters with the largest rms vibration of the rim.", kept("dominant_n"),
           head="dominant n", format="d"),
    Column("dominant_rms_m", "Rms vibration of the rim with these nodal diameters.", kept("dominant_rms_m"),
           where="files"),
    Column("diverged_at_s", "Time at which a run passed a limit of its model.", kept("diverged_at_s"), where="files"),
    Column("flags", "Codes of the warnings of the run.", kept("flags"), format=word),
    Column("why", "Reason why a run was refused, failed or diverged.", kept("why"), format=word),
)  # fmt: skip
COLUMNS = tuple(column.name for column in MEASURED)
