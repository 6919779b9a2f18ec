"""Made-up rim and blade bases, small enough to check by hand."""

import numpy as np

import contact as ct

N_MAX = 6
SIZE = 2 * N_MAX + 1


def harmonics(n_max, phi):
    """Rows (1, cos phi .. cos N phi, sin phi .. sin N phi) of a rim at an angle."""
    phases = np.multiply.outer(phi, np.arange(n_max + 1))
    return np.concatenate([np.cos(phases), np.sin(phases[..., 1:])], axis=-1)


def ring(*, S=1e-8, zeta=0.002, imperfect=0.0):
    """Inextensional ring pairs n = 2 .. 6; `imperfect` mixes harmonics into every mode and into S."""
    columns, omega = [], []
    for n in range(2, N_MAX + 1):
        cosine, sine = np.zeros(2 * SIZE), np.zeros(2 * SIZE)
        cosine[n], cosine[SIZE + N_MAX + n] = 1.0, -1.0 / n
        sine[N_MAX + n], sine[SIZE + n] = 1.0, 1.0 / n
        columns += [cosine / np.sqrt(1.0 + 1.0 / n**2), sine / np.sqrt(1.0 + 1.0 / n**2)]
        frequency = 2.0 * np.pi * 20.0 * (n * n - 1)
        omega += [frequency, frequency * (1.0 + imperfect)]
    rows = np.array(columns).T
    compliance = np.diag([S] * SIZE + [0.5 * S] * SIZE)
    if imperfect:
        rng = np.random.default_rng(7)
        rows = rows + imperfect * rng.standard_normal(rows.shape)
        mixing = 0.3 * np.sqrt(S) * rng.standard_normal((2 * SIZE, 4))
        compliance = compliance + mixing @ mixing.T
    return ct.ModalBody(
        omega=omega, zeta=[zeta] * len(omega), channels=ct.bodies.rim_channels(N_MAX), rows=rows,
        S=compliance, kind="rim",
        n_max=N_MAX, radius=0.45,
    )  # fmt: skip


def blade(*, S=2e-8, zeta=0.002, psi=1.6):
    """Two modes seen at the tip; with psi = 0 a blade that only yields through S."""
    rows = [[0.05 * psi, 0.1 * psi], [psi, 0.25 * psi]]
    return ct.ModalBody(
        omega=[2.0 * np.pi * 120.0, 2.0 * np.pi * 900.0], zeta=[zeta] * 2, channels=("span", "flap"),
        rows=rows, S=[[S, S / 4.0], [S / 4.0, 3.0 * S]],
    )  # fmt: skip


def flap_blade(*, S=2e-8):
    """One pure flap mode: the blade of the lean rule kappa = psi^2 sin a (sin a - mu cos a)."""
    return ct.ModalBody(
        omega=[2.0 * np.pi * 120.0],
        zeta=[0.002],
        channels=("span", "flap"),
        rows=[[0.0], [1.0]],
        S=[[S, 0.0], [0.0, S]],
    )


def dense_rows(scene, phi):
    """Q, T, S_nn, S_nt at phi from the definition, with no table and no polynomial."""
    h, a = harmonics(N_MAX, phi), np.radians(scene.lean_deg)
    n, t = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    rows, S = scene.casing.rows, scene.casing.S
    Q = np.concatenate([h @ rows[:SIZE], -n @ scene.blade.rows])
    T = np.concatenate([h @ rows[SIZE:], -t @ scene.blade.rows])
    S_nn = h @ S[:SIZE, :SIZE] @ h + n @ scene.blade.S @ n
    S_nt = h @ S[:SIZE, SIZE:] @ h + n @ scene.blade.S @ t
    return Q, T, S_nn, S_nt
