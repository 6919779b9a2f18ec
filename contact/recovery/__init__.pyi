from .displacements import at_channels, at_points, casing_motion, rub_forces, support_forces
from .histories import RubFilm, TipMotion, force_table, rub_film, strain_energy, tip_motion

__all__ = [
    "RubFilm",
    "TipMotion",
    "at_channels",
    "at_points",
    "casing_motion",
    "force_table",
    "rub_film",
    "rub_forces",
    "strain_energy",
    "support_forces",
    "tip_motion",
]
