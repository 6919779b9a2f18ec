"""Made-up bases for rubs: a rim seen in three directions on two lines, and a blade with several tip nodes."""

import numpy as np

import contact as ct

N_MAX = 5
SIZE = 2 * N_MAX + 1


def rim3(*, S=2e-8, lines=2, seed=11):
    """A casing of ten modes with every harmonic in every row, and a full residual compliance."""
    rng = np.random.default_rng(seed)
    channels = ct.bodies.rim_channels(N_MAX, 3, lines)
    rows = rng.standard_normal((len(channels), 10))
    mixing = np.sqrt(S / 20.0) * rng.standard_normal((len(channels), 20))
    return ct.ModalBody(
        omega=np.linspace(300.0, 9000.0, 10), zeta=[0.003] * 10, channels=channels, rows=rows,
        S=mixing @ mixing.T + S * np.eye(len(channels)), kind="rim", n_max=N_MAX, radius=0.4,
    )  # fmt: skip


def round_rim(*, S=2e-8, lines=2, seed=11):
    """A casing of five pairs of modes that are the same from every angle, as is its residual compliance."""
    rng = np.random.default_rng(seed)
    channels = ct.bodies.rim_channels(N_MAX, 3, lines)
    rows = np.zeros((len(channels) // SIZE, SIZE, 10))
    for n in range(1, N_MAX + 1):
        a, b = rng.standard_normal((2, len(rows)))
        rows[:, n, 2 * n - 2], rows[:, N_MAX + n, 2 * n - 2] = a, b
        rows[:, n, 2 * n - 1], rows[:, N_MAX + n, 2 * n - 1] = -b, a
    return ct.ModalBody(
        omega=np.repeat(np.linspace(300.0, 9000.0, 5), 2), zeta=[0.003] * 10, channels=channels,
        rows=rows.reshape(-1, 10), S=S * np.eye(len(channels)), kind="rim", n_max=N_MAX, radius=0.4,
    )  # fmt: skip


def nodes(count, *, S=3e-8, seed=5):
    """A blade of three modes seen at `count` tip nodes along span, flap and chord."""
    rng = np.random.default_rng(seed)
    channels = [f"node{k}.{name}" for k in range(count) for name in ("span", "flap", "chord")]
    mixing = np.sqrt(S) * rng.standard_normal((3 * count, 3 * count)) / np.sqrt(3 * count)
    return ct.ModalBody(
        omega=[700.0, 2300.0, 8000.0], zeta=[0.002] * 3, channels=channels,
        rows=1.5 * rng.standard_normal((3 * count, 3)), S=mixing @ mixing.T + S * np.eye(3 * count),
    )  # fmt: skip


def tips(count, *, blade=0, angle=10.0, lean=15.0, axial=True):
    """Tip nodes of one blade, side by side, alternately on the two rim lines."""
    return [
        ct.ContactPoint(
            blade=blade, line=k % 2, span=f"node{k}.span", flap=f"node{k}.flap",
            axial=f"node{k}.chord" if axial else None, angle_deg=angle + 0.5 * k, lean_deg=lean, clearance=1e-6 * k,
        )
        for k in range(count)
    ]  # fmt: skip
