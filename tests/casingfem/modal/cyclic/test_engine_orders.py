"""Engine orders on bladed wheels: closed form of a chain, aliasing, air, the full model, Whitehead's bound."""

import numpy as np
import pytest

import casingfem as cf
from reports.verification.modes.cyclic import bladed_disk, mistuned_wheel, tip_loads

MASS, HZ, COUPLING, ZETA = 0.2, 100.0, 0.04, 1e-3
AIR = cf.modal.Influence(offset=[-1, 0, 1], stiffness=[-60.0, 800.0, 40.0], damping=[0.02, 0.3, -0.05])


def chain(blades=12):
    return cf.modal.BladedWheel.chain(blades=blades, freq_hz=HZ, mass=MASS, coupling=COUPLING)


def exact(order, blades, freq_hz, air=None):
    """Amplitude [m] under 1 N of a wave of the chain of n = order mod N."""
    w, n = 2.0 * np.pi * np.asarray(freq_hz), order % blades
    stiff = MASS * (2.0 * np.pi * HZ) ** 2 * (1.0 + 4.0 * COUPLING * np.sin(np.pi * n / blades) ** 2)
    added = 0.0 * w
    for k, own, damped in () if air is None else zip(air.offset, air.stiffness, air.damping, strict=True):
        added = added + (own + 1j * w * damped) * np.exp(2j * np.pi * n * k / blades)
    return np.abs(1.0 / (stiff * (1.0 + 2j * ZETA) + added - MASS * w**2))


@pytest.mark.parametrize("air", [None, AIR])
@pytest.mark.parametrize("order", [2, 6, 9, 14, 24])
def test_orders_beyond_half_of_the_blades_are_aliased_and_answer_as_their_wave(order, air):
    speeds = np.linspace(95.0, 112.0, 60) / order
    found = cf.modal.engine_order_response(chain(), order, speeds, zeta=ZETA, influence=air)
    assert found.diameter == abs((order + 6) % 12 - 6)
    np.testing.assert_allclose(found.amplitude, np.outer(exact(order, 12, speeds * order, air), np.ones(12)), rtol=1e-9)
    fine = exact(order, 12, np.linspace(95.0, 112.0, 200_001), air)
    assert found.peak == pytest.approx(fine.max(), rel=1e-4)  # the air is that of the tuned resonance
    assert found.amplification == 1.0


@pytest.mark.parametrize("n", [0, 1, 4, 7])
def test_the_stiffness_of_a_wave_in_air_is_that_of_the_forces_between_the_blades(n):
    wave, omega = np.exp(2j * np.pi * n * np.arange(8) / 8), 630.0
    forces = AIR.between(8, omega) @ wave
    np.testing.assert_allclose(forces, AIR.of_diameter(n, 8, omega) * wave, rtol=1e-12)
    assert AIR.between(8, omega)[2, 3] == 40.0 - 0.05j * omega  # on blade 2 by its neighbour 3
    assert AIR.between(8, omega)[7, 0] == 40.0 - 0.05j * omega


def test_air_damps_a_wave_that_runs_with_it_and_not_the_one_against_it():
    with_it, against = (
        cf.modal.engine_order_response(chain(), order, [30.0, 36.0], zeta=ZETA, influence=AIR) for order in (3, 9)
    )
    assert with_it.diameter == against.diameter == 3
    assert with_it.peak != pytest.approx(against.peak, rel=1e-2)


def test_the_largest_amplitude_between_two_speeds_is_that_of_a_fine_sweep():
    deviations = 0.02 * np.random.default_rng(8).standard_normal(12)
    found = cf.modal.engine_order_response(chain(), 3, [31.0, 37.0], zeta=ZETA, deviations=deviations)
    speeds = np.linspace(found.peak_hz - 1e-2, found.peak_hz + 1e-2, 401)
    near = cf.modal.engine_order_response(chain(), 3, speeds, zeta=ZETA, deviations=deviations)
    wide = cf.modal.engine_order_response(chain(), 3, np.linspace(31.0, 37.0, 2000), zeta=ZETA, deviations=deviations)
    assert found.peak == pytest.approx(near.amplitude.max(), rel=1e-6)
    assert wide.amplitude.max() <= found.peak * (1.0 + 1e-9)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*mesh-(kink|thin-curved)")
@pytest.mark.parametrize("deviations", [None, [0.02, -0.01, 0.0, -0.03]])
def test_a_wheel_answers_as_its_full_model_tuned_and_mistuned(deviations):
    """The whole wheel of 20-node bricks with each blade's modulus, solved at 24 frequencies about three resonances."""
    sector, tips, zeta, order = bladed_disk(4, (1, 1, 2, 1)), cf.TipNodes("tip", 1), 0.01, 3
    wheel = cf.modal.BladedWheel.of(sector, tips, channel="flap", modes=4, blade="blade")
    whole = mistuned_wheel(sector, np.zeros(4) if deviations is None else np.array(deviations))
    system, loads = whole.assembled(), tip_loads(sector, whole, tips)
    P = loads[:, 1 :: loads.shape[1] // 4]
    f = P @ np.exp(2j * np.pi * order * np.arange(4) / 4)
    own = np.sort(wheel.freq[wheel.diameters == 1])[:3]
    freq = np.sort(np.outer(own, np.linspace(0.97, 1.03, 8)).ravel())
    K, M = (np.asarray(part.todense()) for part in (system.K, system.M))
    full = [np.abs(P.T @ np.linalg.solve(K * (1.0 + 2j * zeta) - (2 * np.pi * at) ** 2 * M, f)) for at in freq]
    found = cf.modal.engine_order_response(wheel, order, freq / order, zeta=zeta, deviations=deviations)
    assert np.abs(found.amplitude - full).max() < 2e-6 * np.max(full)


def test_large_deviations_exceed_whiteheads_bound():
    """A soft blade moves further by itself: the bound holds for small deviations."""
    drawn = [-0.374, 0.019, -0.004, 0.1, 0.026, 0.048, 0.025, -0.039, -0.034, 0.023, -0.0, 0.03]
    found = cf.modal.engine_order_response(chain(), 3, [20.0, 45.0], zeta=ZETA, deviations=drawn)
    assert found.amplification > found.bound


def drawn(draws):
    """Drawn chains: their worst amplification is below Whitehead's bound and over three fifths of it."""
    found = cf.modal.amplification(chain(), 3, sigma=0.02, draws=draws, seed=3, zeta=ZETA)
    assert found.bound == pytest.approx(0.5 * (1.0 + np.sqrt(12.0)))
    assert 0.6 * found.bound < found.amplification.max() < found.bound
    assert 1.0 < found.quantile(0.5) < found.quantile(0.99) < found.amplification.max()
    return found


@pytest.mark.slow
def test_amplification_of_drawn_chains_is_below_whiteheads_bound():
    drawn(400)


def test_the_worst_deviations_give_the_largest_amplification():
    found = cf.modal.amplification(chain(6), 2, sigma=0.02, draws=12, seed=4, zeta=ZETA)
    assert found.amplification.argmax() not in (0, 11)
    one = cf.modal.engine_order_response(chain(6), 2, [40.0, 65.0], zeta=ZETA, deviations=found.worst)
    assert one.amplification == pytest.approx(found.amplification.max(), rel=1e-9)
    assert np.std(found.worst) < 0.06
    again = cf.modal.amplification(chain(6), 2, sigma=0.02, draws=12, seed=5, zeta=ZETA)
    assert not np.allclose(again.amplification, found.amplification)
    with pytest.raises(ValueError, match="draws = 0"):
        cf.modal.amplification(chain(6), 2, sigma=0.02, draws=0, seed=4, zeta=ZETA)
    with pytest.raises(ValueError, match=r"sigma = 0\.2"):
        cf.modal.amplification(chain(6), 2, sigma=0.2, draws=1, seed=4, zeta=ZETA)


def test_amplitudes_are_proportional_to_the_force_which_is_one_newton_by_default():
    speeds = [33.0, 34.0, 35.0]
    one = cf.modal.engine_order_response(chain(), 3, speeds, zeta=ZETA, deviations=0.01 * np.cos(np.arange(12)))
    three = cf.modal.engine_order_response(
        chain(), 3, speeds, force=3.0, zeta=ZETA, deviations=0.01 * np.cos(np.arange(12))
    )
    np.testing.assert_allclose(three.amplitude, 3.0 * one.amplitude, rtol=1e-12)
    np.testing.assert_allclose([three.peak, three.tuned_peak], [3.0 * one.peak, 3.0 * one.tuned_peak], rtol=1e-12)
    np.testing.assert_allclose(three.tuned, 3.0 * one.tuned, rtol=1e-12)
    assert 33.0 < one.peak_hz < 35.0
    assert one.amplification == pytest.approx(one.peak / one.tuned_peak)


@pytest.mark.campaign
def test_amplification_comes_near_whiteheads_bound_and_does_not_pass_it():
    """Many drawn chains, then a climb from the worst of them."""
    wheel, order, found = chain(), 3, drawn(10_000)
    rng, values, most, size = np.random.default_rng(7), np.array(found.worst), 0.0, 0.3
    for k in range(600):
        tried = values * (1.0 + size * rng.standard_normal(12) * (rng.random(12) < 0.4)) if k else values
        one = cf.modal.engine_order_response(wheel, order, [20.0, 45.0], zeta=ZETA, deviations=np.maximum(tried, -0.5))
        if one.amplification > most:
            values, most = np.maximum(tried, -0.5), one.amplification
        size *= 0.8 if k % 40 == 39 else 1.0
    assert 0.85 * found.bound < most < found.bound


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: cf.modal.engine_order_response(chain(), 0, [30.0], zeta=ZETA), "response.order: found 0"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0, 20.0], zeta=ZETA), "ascending speeds"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0, 31.0, 31.0], zeta=ZETA), "ascending speeds"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [0.0, 31.0], zeta=ZETA), "ascending speeds above 0"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0, np.inf], zeta=ZETA), "ascending speeds"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [[30.0], [31.0]], zeta=ZETA), "ascending speeds"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [], zeta=ZETA), "ascending speeds"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0], zeta=1.5), "response.zeta: found 1.5"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0], zeta=1.0), "response.zeta: found 1"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [30.0], zeta=-0.1), "response.zeta: found -0.1"),
        (lambda: cf.modal.engine_order_response(chain(), 3, [33.0, 34.0]), "a wheel without damping"),
        (
            lambda: cf.modal.engine_order_response(
                chain(), 3, [33.0, 34.0], zeta=ZETA,
                influence=cf.modal.Influence(offset=[0], stiffness=[0.0], damping=[-5.0]),
            ),
            "or one that flutters",
        ),
        (lambda: cf.modal.Influence(offset=[0, 0], stiffness=[1.0, 1.0], damping=[0.0, 0.0]), "each offset once"),
        (lambda: cf.modal.Influence(offset=[0], stiffness=[np.nan], damping=[0.0]), "influence.stiffness"),
        (lambda: cf.modal.BladedWheel.chain(blades=1, freq_hz=10.0, mass=1.0, coupling=0.1), "chain: found blades = 1"),
        (lambda: cf.modal.BladedWheel.chain(blades=5, freq_hz=0.0, mass=1.0, coupling=0.1), "freq_hz = 0, mass = 1"),
        (lambda: cf.modal.BladedWheel.chain(blades=5, freq_hz=10.0, mass=0.0, coupling=0.1), "freq_hz = 10, mass = 0"),
        (lambda: cf.modal.BladedWheel.chain(blades=5, freq_hz=10.0, mass=1.0, coupling=-0.1), "coupling = -0.1"),
        (lambda: cf.modal.amplification(chain(), 3, sigma=0.0, draws=5, seed=1, zeta=ZETA), "sigma = 0"),
        (
            lambda: cf.modal.BladedWheel.of(bladed_disk(4, (1, 1, 2, 1)), cf.TipNodes("tip", 1), channel="twist"),
            "response.channel: found 'twist'",
        ),
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:.*mesh-(kink|thin-curved)")
def test_responses_that_cannot_be_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()
