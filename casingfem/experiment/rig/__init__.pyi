from .estimate import estimate
from .excitation import BurstRandom, Impact, Random, StepSine
from .files import rig_angles, truth, write_rig_uff
from .record import measured, record
from .rig import Converter, Probe, Rig, noisy
from .scan import Tone, Turning, scan
from .structure import Place, circle, loaded, rig_of
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
    "estimate",
    "loaded",
    "measured",
    "noisy",
    "record",
    "rig_angles",
    "rig_of",
    "scan",
    "troubled_frfs",
    "truth",
    "write_rig_uff",
]
