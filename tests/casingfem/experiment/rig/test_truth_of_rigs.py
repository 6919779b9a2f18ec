"""What a rig's own modes are on a circle of probes, and what masses do to what its modes leave out: by hand."""

import numpy as np

import casingfem as cf


def ring(waves, first=0.4, count=7):
    """Modes a cos n(theta - psi) + b at seven probes round a circle, after one that is elsewhere."""
    theta = first + 2.0 * np.pi * np.arange(count) / count
    probes = [
        cf.rig.Probe(9, 1, (0.0, 0.0, 0.0), 0.0),
        *(cf.rig.Probe(k, 1, (0.0, 0.0, 0.0), t) for k, t in enumerate(theta)),
    ]
    rows = [np.r_[5.0, a * np.cos(n * (theta - np.radians(psi))) + b] for n, psi, a, b in waves]
    omega = 100.0 * np.arange(1.0, len(waves) + 1.0)
    return cf.rig.Rig.of(omega=omega, zeta=np.linspace(0.01, 0.02, len(waves)), rows=np.array(rows).T, probes=probes)


def test_without_a_circle_modes_have_no_labels():
    found = cf.rig.truth(ring([(2, 71.0, 1.0, 0.1), (3, 44.0, -1.0, 0.0)]))
    assert found.n.tolist() == [-1, -1]
    assert np.isnan(found.angle_deg).all()
