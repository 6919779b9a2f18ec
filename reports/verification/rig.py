"""Rows of the verification on tests: the rig against exact answers, the circle scan against closed forms."""

import numpy as np

import casingfem as cf
from casingfem.experiment.circle.record import turning
from casingfem.experiment.rig.estimate import estimate
from casingfem.experiment.rig.excitation import BurstRandom
from casingfem.experiment.rig.record import record
from casingfem.experiment.rig.rig import Converter
from casingfem.experiment.rig.structure import loaded
from reports.tables import Row, check

SEED = 20617
FS = 2000.0


def oscillator() -> Row:
    """One degree of freedom, burst-random record of .25 Hz resolution, at its resonance: 1/(2 zeta omega^2 m)."""
    omega, zeta, m = 2.0 * np.pi * 150.0, 0.01, 2.0
    rig = cf.rig.Rig.of(omega=[omega], zeta=zeta, rows=[[1.0 / np.sqrt(m)]])
    burst = BurstRandom(rms=1.0, band=(20.0, 300.0), part=0.3)
    test = record(rig, [burst], drives=[0], sensors=[0], fs=1024.0, block=4096, blocks=4, seed=SEED,
                  quantity="receptance")  # fmt: skip
    found = estimate(test, window="rectangular", overlap=0.0, band=(149.9, 150.1)).frfs
    exact = 1.0 / (2.0 * zeta * omega**2 * m)
    return check("rig: 1-dof receptance from a record", "exact", exact, float(abs(found.responses[0, 0])), 3.8e-4)


def sensor_mass() -> Row:
    """A sensor of 1 % of the mass: f sqrt(m/(m + m_a))."""
    rig = cf.rig.Rig.of(omega=[700.0], zeta=0.01, rows=[[1.0]])
    found = float(loaded(rig, [0], [0.01]).omega[0])
    return check("rig: a sensor of 1 % of the mass", "exact", 700.0 / np.sqrt(1.01), found, 1e-9)


def converter() -> Row:
    """Noise of a 12-bit converter: LSB^2/12."""
    values = np.random.default_rng(SEED).normal(0.0, 1.0, 200_000)
    adc = Converter(bits=12, full_scale=8.0)
    error = float(np.mean((adc.convert(values) - values) ** 2))
    return check("rig: noise of a converter", "Widrow & Kollar 2008", adc.lsb**2 / 12.0, error, 1.0)


def travelling() -> list[Row]:
    """A standing wave of n = 8 with a fifth of it running forwards: angle, amplitude, travelling part."""
    n, psi, tone, extra = 8, 0.2, 371.3, 0.2
    theta = turning(2.3, FS, 12_000)
    phase = 2.0 * np.pi * tone * np.arange(12_000) / FS
    seen = np.cos(n * (theta - psi)) * np.cos(phase) + extra * np.cos(phase - n * (theta - psi))
    found = cf.circle.demodulate(cf.circle.ScanRecord(fs=FS, velocity=seen, angle=theta, tones=(tone,)), 10).wave(0, n)
    source = "closed form"
    return [
        check("circle scan: antinode [deg]", source, float(np.degrees(psi)), found.angle_deg, 1e-6),
        check("circle scan: amplitude", source, 1.0 + extra, found.amplitude, 1e-6),
        check("circle scan: travelling part", source, extra / (1.0 + extra), found.travelling, 1e-6),
    ]


def bound(quick: bool) -> Row:
    """Scatter of the antinode against the Cramer-Rao bound 2 s/(n A sqrt(N)), noise s half the amplitude A."""
    n, psi, level, count = 8, 0.11, 0.5, 4000
    theta = turning(2.3, FS, count)
    clean = np.cos(n * (theta - psi)) * np.cos(2.0 * np.pi * 371.3 * np.arange(count) / FS)
    rng = np.random.default_rng(SEED)
    errors = []
    for _ in range(100 if quick else 400):
        noisy = clean + level * rng.standard_normal(count)
        found = cf.circle.demodulate(
            cf.circle.ScanRecord(fs=FS, velocity=noisy, angle=theta, tones=(371.3,)), [n]
        ).wave(0, n)
        errors.append(found.angle_deg - np.degrees(psi))
    limit = float(np.degrees(2.0 * level / (n * np.sqrt(count))))
    scatter = float(np.sqrt(np.mean(np.square(errors))))
    return check(
        "circle scan: scatter of the antinode [deg]", "Cramer-Rao bound", limit, scatter, 20.0 if quick else 10.0
    )


def rows(quick: bool) -> list[Row]:
    """All of them."""
    return [oscillator(), sensor_mass(), converter(), *travelling(), bound(quick)]
