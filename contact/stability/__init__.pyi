from .closed_contact import poles
from .envelope import Envelope, envelope, growth_of
from .growing import of_contact, of_rim
from .growth_map import StabilityMap, scan
from .of_run import of_run
from .on_springs import on_springs, slope_of
from .peaks import Peaks, peaks
from .rotor import of_rotor
from .split_casing import floquet_growth, perfect_mean
from .varied import Cases, growth_of_cases
from .whirling import RotorStability, rotor_stability

__all__ = [
    "Cases",
    "Envelope",
    "Peaks",
    "RotorStability",
    "StabilityMap",
    "envelope",
    "floquet_growth",
    "growth_of",
    "growth_of_cases",
    "of_contact",
    "of_rim",
    "of_rotor",
    "of_run",
    "on_springs",
    "peaks",
    "perfect_mean",
    "poles",
    "rotor_stability",
    "scan",
    "slope_of",
]
