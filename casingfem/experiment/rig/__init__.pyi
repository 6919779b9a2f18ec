from .excitation import BurstRandom, Impact, Random, StepSine
from .files import rig_angles, write_rig_uff
from .noise import Converter, noisy
from .record import record
from .rig import Probe, Rig
from .scan import Tone, Turning, scan
from .structure import Place, circle, rig_of

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
    "Turning",
    "circle",
    "noisy",
    "record",
    "rig_angles",
    "rig_of",
    "scan",
    "write_rig_uff",
]
