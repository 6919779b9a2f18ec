from .excitation import BurstRandom, Impact, Random, StepSine
from .files import rig_angles, write_rig_uff
from .record import record
from .rig import Converter, Probe, Rig, noisy
from .scan import Tone, Turning, scan
from .structure import Place, circle, rig_of
from .troubles import Troubles, troubled_frfs

__all__ = [
    "BurstRandom",
    "Converter",
    "Impact",
    "Place",
    "Probe",
    "Random",
    "Rig",
    "StepSine",
    "Tone",
    "Troubles",
    "Turning",
    "circle",
    "noisy",
    "record",
    "rig_angles",
    "rig_of",
    "scan",
    "troubled_frfs",
    "write_rig_uff",
]
