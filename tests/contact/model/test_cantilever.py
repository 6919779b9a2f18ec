"""A clamped beam before a stop: closed-form modes, compliance, the propped beam it comes to rest as."""

from dataclasses import replace

import numpy as np
import pytest

import contact as ct

BEAM = ct.gaps.Cantilever(length=0.5, width=0.02, height=0.005, E=210e9, rho=7800.0, zeta=0.02)


def test_modes_are_the_published_ones_and_static_compliance_is_whole():
    body = BEAM.modes(12)
    b = np.sqrt(body.omega) * BEAM.length * (BEAM.line_mass / BEAM.EI) ** 0.25
    np.testing.assert_allclose(b[:5], [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839], rtol=1e-8)
    whole = body.S + (body.rows / body.omega**2) @ body.rows.T
    np.testing.assert_allclose(whole[0], [BEAM.length**3 / 3.0 / BEAM.EI, BEAM.length**4 / 8.0 / BEAM.EI], rtol=1e-12)
    assert np.linalg.eigvalsh(body.S).min() > 0.0
    assert body.S[0, 0] < 1e-4 * whole[0, 0]
    shares = BEAM.line_mass * BEAM.modes(200).rows[1] ** 2 / BEAM.length  # a unit field in modes: sum of squares 1
    assert shares.sum() == pytest.approx(1.0, abs=3e-3)


@pytest.mark.parametrize(("load", "clearance"), [(10.0, 1e-3), (20.0, 1e-6), (10.0, 5e-3)])
def test_it_comes_to_rest_as_a_propped_cantilever(load, clearance):
    gap = replace(BEAM, zeta=0.3).before_stop(clearance=clearance, load=load)
    result = ct.run(gap, scheme=ct.ExactModal(law="forward"), t_end=3.0, dt=1e-5, record=ct.Record(every=100))
    reaction = 3.0 * load * BEAM.length / 8.0 - 3.0 * BEAM.EI * clearance / BEAM.length**3
    assert result.force[-1, 0] == pytest.approx(max(reaction, 0.0), rel=1e-9, abs=1e-9)
    free = load * BEAM.length**4 / 8.0 / BEAM.EI  # tip of the free beam
    assert result.gap[-1, 0] == pytest.approx(max(clearance - free, 0.0), rel=1e-6, abs=1e-15)


def test_a_beam_thrown_at_the_stop_brings_its_own_energy():
    gap = replace(BEAM, zeta=0.0).before_stop(clearance=1e-3, velocity=1.0, modes=60)
    result = ct.run(gap, scheme=ct.ExactModal(law="forward"), t_end=0.05, dt=5e-7)
    whole = 0.5 * BEAM.line_mass * BEAM.length
    assert result.energy.start.kinetic == pytest.approx(whole, rel=0.02)  # in 60 modes
    assert result.impulse[0] > 0.0
    assert abs(result.energy.unaccounted) < 1e-10 * whole


@pytest.mark.parametrize("change", [{"length": 0.0}, {"E": -1.0}, {"zeta": np.nan}])
def test_beams_that_cannot_be_are_refused(change):
    with pytest.raises(ct.InputError, match=next(iter(change))):
        replace(BEAM, **change)
    with pytest.raises(ct.InputError, match="modes"):
        BEAM.modes(0)
