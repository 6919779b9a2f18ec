from .exact import (
    BarHistory,
    Bounces,
    ExactContact,
    ImpactOrbit,
    bar_by_characteristics,
    bouncing_bar,
    driven_orbit,
    force_error,
    rod_on_wall,
    stopped_period,
    two_rods,
)
from .waves import Impact, impact_by_characteristics, lcm_step

__all__ = [
    "BarHistory",
    "Bounces",
    "ExactContact",
    "Impact",
    "ImpactOrbit",
    "bar_by_characteristics",
    "bouncing_bar",
    "driven_orbit",
    "force_error",
    "impact_by_characteristics",
    "lcm_step",
    "rod_on_wall",
    "stopped_period",
    "two_rods",
]
