"""Synthetic responses of imperfect frusta whose modes are known, for `reports.verification.updating.identification`.

Each casing is the reference frustum with a wall whose thickness has harmonics 2n, n = 2..16, of seeded size and phase:
splits from about 0.05 to 1 %. Damping is 0.1 to 0.5 %, alike within a pair to a tenth. A rim of 24 uneven radial
sensors, radial forces at one or two points of the rim, accelerance over lines 1/8 Hz apart, with the compliance of all
modes left out, and noise 40 dB below the rms of each channel.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.rig import noisy
from casingfem.experiment.rig.structure import Place, rig_of
from casingfem.io.arrays import FloatArray
from casingfem.modal.modes import Modes, modes
from casingfem.structure.field.fourier import FourierField
from casingfem.structure.shell.assembly import assemble
from reports.verification.modes.frustum import reference_frustum

SENSORS, JITTER_DEG = 24, 4.0
ORDERS = range(2, 17)
THICKNESS = 1.5e-3, 3e-2  # relative amplitude of a harmonic, log-uniform
DAMPING = 1e-3, 5e-3, 0.1
STEP_HZ = 0.125
COUNT, ENDS = 46, (30, 44)  # modes computed; the band ends in the widest gap behind one of these
SNR_DB = 40.0


class TestSet(NamedTuple):
    """Responses, angles [deg] of their sensors by point, and the truth.

    The first `count` of `modes` lie in the band; `angle_deg` are their antinodes at the rim.
    """

    frfs: FrfSet
    angles: dict[int, float]
    modes: Modes
    zeta: FloatArray
    angle_deg: FloatArray
    count: int


def make_set(seed: int, references: int, sensors: int = SENSORS) -> TestSet:
    """One casing and its responses at a number of sensors to forces at one or two points."""
    rng = np.random.default_rng(seed)
    low, high = np.log(THICKNESS)
    size, phase = np.exp(rng.uniform(low, high, len(ORDERS))), rng.uniform(0.0, 2.0 * np.pi, len(ORDERS))
    waves = {2 * n: (a * np.cos(p), a * np.sin(p)) for n, a, p in zip(ORDERS, size.tolist(), phase, strict=True)}
    shell = replace(reference_frustum(), thickness_defect=FourierField.of(waves))
    system = assemble(shell)
    found = modes(shell, COUNT)
    zeta = np.exp(rng.uniform(*np.log(DAMPING[:2]), COUNT))
    for lower, upper in found.doublets:
        zeta[upper] = zeta[lower] * rng.uniform(1.0 - DAMPING[2], 1.0 + DAMPING[2])
    around = 2.0 * np.pi * np.arange(sensors) / sensors + np.radians(rng.uniform(-JITTER_DEG, JITTER_DEG, sensors))
    at = np.r_[around, rng.uniform(0.0, 2.0 * np.pi, 2)]
    rig = rig_of(found, [Place(at=(0.25, float(angle))) for angle in at], zeta=zeta, system=system)
    gaps = np.diff(found.freq[ENDS[0] : ENDS[1]])
    count = ENDS[0] + int(gaps.argmax()) + 1
    lines = np.arange(0.98 * found.freq[0], found.freq[count - 1 : count + 1].mean(), STEP_HZ)
    frfs = rig.frfs(lines, sensors=range(sensors), drives=range(sensors, sensors + references))
    angles = {probe.node: float(np.degrees(probe.angle)) for probe in rig.probes[:sensors]}
    return TestSet(noisy(frfs, SNR_DB, seed=seed), angles, found, zeta, rim_angles(found), count)


def rim_angles(found: Modes) -> FloatArray:
    """Antinodes of the radial displacement of the rim's own n [deg], in [0, 180/n); nan where n = 0."""
    assert found.rings is not None
    n = found.nodal_diameters
    radial = found.rings.amplitudes[n, -1, 0, np.arange(len(n))]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(n > 0, np.mod(np.degrees(-np.angle(radial)) / n, 180.0 / n), np.nan)
