from .around_rim import ForceMap, RimMotion, Section, force_over_angle, once_a_turn, rim_motion
from .displacements import at_channels, at_points, casing_motion, rub_forces, support_forces
from .histories import RubFilm, TipMotion, force_table, rub_film, strain_energy, tip_motion

__all__ = [
    "ForceMap",
    "RimMotion",
    "RubFilm",
    "Section",
    "TipMotion",
    "at_channels",
    "at_points",
    "casing_motion",
    "force_over_angle",
    "force_table",
    "once_a_turn",
    "rim_motion",
    "rub_film",
    "rub_forces",
    "strain_energy",
    "support_forces",
    "tip_motion",
]
