"""B6: a turning n-diameter pair held against a fixed blade diverges where the 6-state eigenvalues say."""

import numpy as np
import pytest

import contact as ct

N = 8
CASING, BLADE, STIFFNESS = (300.0, 1.5), (120.0, 0.4), 1e4  # (Hz, kg), N/m

pytestmark = pytest.mark.slow  # they compile loops for seconds


def pair(speed_hz):
    """n = 8 pair and one radial blade mode, joined by S = 1/k and pressed together by 1 mm."""
    size = 2 * N + 1
    rows = np.zeros((2 * size, 2))
    rows[N, 0] = rows[2 * N, 1] = 1.0 / np.sqrt(CASING[1])
    casing = ct.ModalBody(
        omega=[2 * np.pi * CASING[0]] * 2, zeta=[0.0, 0.0], channels=ct.bodies.rim_channels(N), rows=rows,
        S=np.zeros((2 * size, 2 * size)), kind="rim", n_max=N, radius=0.5,
    )  # fmt: skip
    blade = ct.ModalBody(
        omega=[2 * np.pi * BLADE[0]], zeta=[0.0], channels=("span", "flap"),
        rows=[[1.0 / np.sqrt(BLADE[1])], [0.0]], S=np.eye(2) / STIFFNESS,
    )  # fmt: skip
    return ct.RotatingRim(casing, blade, clearance=-1e-3, speed_hz=speed_hz)


def eigenvalue_growth(speed_hz):
    """Largest real part of the eigenvalues of permanent contact, in the blade's frame [1/s]."""
    (fc, mc), (fb, mb), k, a = CASING, BLADE, STIFFNESS, N * 2 * np.pi * speed_hz
    wc, wb = 2 * np.pi * fc, 2 * np.pi * fb
    K = np.array([[wc**2 - a**2 + k / mc, 0, -k / mc], [0, wc**2 - a**2, 0], [-k / mb, 0, wb**2 + k / mb]])
    C = np.array([[0, 2 * a, 0], [-2 * a, 0, 0], [0, 0, 0]])
    return np.linalg.eigvals(np.block([[np.zeros((3, 3)), np.eye(3)], [-K, -C]])).real.max()


def simulated_growth(speed_hz):
    """Growth rate of the blade's vibration over the time in which the contact stays closed [1/s]."""
    result = ct.run(pair(speed_hz), t_end=0.85, dt=2e-5, record=ct.Record(every=5, state_every=5))
    assert result.contact_steps[0] == result.steps
    q = result.state_of("blade")[:, 0]
    window = 1000  # .1 s
    starts = np.arange(4000, q.size - window, 250)
    level = [np.std(q[i : i + window]) for i in starts]
    return np.polyfit(result.state_time[starts], np.log(level), 1)[0]


def test_divergence_at_the_published_speed():
    assert eigenvalue_growth(52.844) == pytest.approx(3.7883, rel=1e-4)
    assert simulated_growth(52.844) == pytest.approx(3.7883, rel=0.02)


@pytest.mark.parametrize("speed_hz", [52.5, 22.5])
def test_no_growth_at_the_unloaded_sum_nor_at_the_difference(speed_hz):
    assert eigenvalue_growth(speed_hz) < 1e-6
    assert abs(simulated_growth(speed_hz)) < 0.05
