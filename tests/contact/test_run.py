"""run and Result: chunks, recording, files, determinism, what import costs."""

import importlib
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from contact.judged import judged, too_much
from contact.model.bodies.chain import assemble
from contact.model.gaps.rub import rub_of
from contact.run import steps
from contact.scheme.modal.rub_stepper import RubStepper
from tests.contact.synthetic_rim import blade, ring

BAR = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0, velocity=-10.0, elements=40)


def rub(**options):
    scene = ct.RotatingRim(ring(imperfect=0.05), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=20.0)
    return ct.run(scene, law=ct.Coulomb(mu=0.2), t_end=0.05, dt=1e-5, **options)


def impact(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], t_end=2.0, courant=0.9, **options)


def modal(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], t_end=2.0, dt=1e-3, scheme=ct.ExactModal(law="forward"), **options)


def kept(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], t_end=2.0, dt=1e-3, scheme=ct.ExactModal(law="energy"), **options)


@pytest.mark.parametrize("make", [impact, modal, kept, rub])
def test_chunks_and_recording_change_no_bit(make, monkeypatch):
    whole = make()
    monkeypatch.setattr(importlib.import_module("contact.run"), "CHUNK", 37)
    done = []
    parts = make(record=ct.Record(every=5, state_every=10), progress=done.append)
    assert np.array_equal(parts.force, whole.force[::5])
    assert np.array_equal(parts.impulse_history, whole.impulse_history[::5])
    assert parts.intervals == whole.intervals
    assert np.array_equal(parts.impulse, whole.impulse)
    assert parts.energy == whole.energy
    assert parts.state.shape[0] == (whole.steps - 1) // 10 + 1
    assert done[-1] == 1.0
    assert done == sorted(done)


def test_the_same_input_gives_the_same_bits():
    assert np.array_equal(rub().force, rub().force)


def test_a_result_is_saved_whole_and_read_back(tmp_path):
    result = rub(record=ct.Record(every=2, state_every=4))
    result.save(tmp_path / "rub.npz")
    again = ct.Result.load(tmp_path / "rub.npz")
    assert np.array_equal(again.force, result.force)
    assert again.energy == result.energy
    assert again.intervals == result.intervals
    assert again.every == 2
    assert repr(again) == repr(result)
    assert again.source["numpy"] == np.__version__
    assert [file.name for file in tmp_path.iterdir()] == ["rub.npz"]
    with pytest.raises(ct.InputError, match="format"):
        ct.ModalBody.load(tmp_path / "rub.npz")
    with np.load(tmp_path / "rub.npz") as kept:
        np.savez(tmp_path / "flat.npz", **{**kept, "state": kept["state"][:, 0]})
    with pytest.raises(
        ct.InputError, match=r"flat.npz: key 'state': found shape .*, expected \(samples, coordinates\)"
    ):
        ct.Result.load(tmp_path / "flat.npz")


def test_the_printed_result_answers_the_first_questions():
    text = repr(impact())
    for word in ("267 steps", "closings", "impulse", "residual", "lost in contact", "unaccounted"):
        assert word in text


def test_the_json_document():
    document = json.loads(json.dumps(rub().to_dict(), allow_nan=False))
    assert set(document) >= {"contacts", "bodies", "energy", "steps", "seconds"}
    assert set(document["contacts"][0]) >= {
        "time", "force", "intervals", "impulse", "max_penetration", "residual", "reversals"
    }  # fmt: skip
    assert document["bodies"][0]["mean_velocity"] is None
    energy = impact().to_dict()["energy"]
    assert energy["end"] == pytest.approx(energy["start"] - energy["lost_in_contact"], rel=1e-12)


def test_bodies_come_masses_first():
    mass, rod = (
        ct.PointMass(mass=1.0, velocity=1.0),
        ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=10),
    )
    result = ct.run([rod, mass], t_end=1.0, courant=0.5)
    assert [(m.kind, m.number) for m in result.motions] == [("mass", 1), ("rod", 0)]


def test_the_end_mass_of_a_rod_sits_where_it_faces_its_neighbour():
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=2, end_mass=3.0)
    assert assemble([rod, ct.Wall(x=2.0)]).mass.tolist() == [0.25, 0.5, 3.25, 0.0]
    assert assemble([ct.Wall(x=-1.0), rod]).mass.tolist() == [0.0, 3.25, 0.5, 0.25]


def test_signs_and_windows():
    result = impact()
    assert (result.lam <= 0.0).all()
    assert np.array_equal(result.lam, -result.force)
    total = np.sum(result.windowed_force()[:, 0]) * result.dt
    assert total == pytest.approx(result.impulse[0], rel=1e-3)
    assert np.allclose(result.windowed_force(result.dt), result.force, atol=1e-9 * 300.0)
    means = np.convolve(result.force[:, 0], np.full(5, 0.2), mode="same")
    assert np.allclose(result.windowed_force(5.0 * result.dt)[2:-2, 0], means[2:-2], atol=1e-9 * 300.0)
    assert result.windowed_force()[:, 0] == pytest.approx(result.windowed_force(result.window)[:, 0])


def test_intervals_can_be_joined():
    result = rub()
    assert result.merged_intervals(0.0) == result.intervals
    apart = replace(result, intervals=(((0.0, 1.0), (1.5, 2.0), (2.25, 3.0), (4.0, 5.0)), ((7.0, 8.0),)), window=0.5)
    assert apart.merged_intervals(0.75) == (((0.0, 3.0), (4.0, 5.0)), ((7.0, 8.0),))
    assert apart.merged_intervals(0.25) == apart.intervals  # an opening as long as the pause stays one
    assert apart.merged_intervals() == (((0.0, 1.0), (1.5, 3.0), (4.0, 5.0)), ((7.0, 8.0),))


def test_a_failed_run_keeps_what_it_recorded(monkeypatch):
    advance, last = RubStepper.advance, 500

    def fails(run, out, first, steps):
        advance(run, out, first, max(min(steps, last - first), 0))
        return last if first + steps > last else -1

    monkeypatch.setattr(RubStepper, "advance", fails)
    scene = ct.RotatingRim(ring(S=0.0), blade(S=0.0), clearance=1e-5, speed_hz=5.0, blade_velocity=[0.01, 0.0])
    with pytest.raises(ct.NumericsError, match=r"step 500 \(t = 0.005 s\): no forces found that obey") as caught:
        ct.run(scene, t_end=1.0, dt=1e-5)
    kept = caught.value.result
    assert kept.steps == kept.time.size == last


RESTING = [ct.Wall(x=0.0), ct.PointMass(mass=1.0, x=0.0, velocity=0.0)]


@pytest.mark.parametrize("scheme", [ct.CentralDifference(), ct.ExactModal(law="forward")])
def test_a_mass_at_rest_raises_no_alarm(scheme):
    """Its energy is that of the half step at the start; contact takes it out, and that is no gain."""
    result = ct.run(RESTING, scheme=scheme, gravity=9.81, t_end=1.0, dt=1e-3)
    assert result.impulse[0] == pytest.approx(9.81, rel=2e-3)
    assert result.energy.load_step == pytest.approx(9.81**2 * 1e-6)
    assert result.flags == ()


@pytest.mark.parametrize(("by", "mu"), [(1e-5, 0.0), (1e-4, 0.3)])
@pytest.mark.slow
def test_bodies_that_overlap_at_the_start_are_pushed_apart_without_an_alarm(by, mu):
    """What the overlap stored comes out by contact: no more than the largest force along it, and most of it."""
    rim = ct.RotatingRim(ring(S=4e-7, zeta=0.01), blade(S=1e-6, zeta=0.01), clearance=-by, speed_hz=5.0, lean_deg=25.0)
    for what in (rim, rub_of(rim)):
        law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
        result = ct.run(what, law=law, t_end=0.02, dt=2e-5, on_limit="flag")
        energy = result.energy
        assert energy.overlap == pytest.approx(by * result.peak_force[0], rel=1e-9)
        assert 0.1 * energy.overlap < -energy.lost_in_contact < energy.overlap
        assert "energy-grows" not in [flag.code for flag in result.flags]
        gained = replace(energy, contact=energy.contact + 2.0 * energy.overlap)
        told = judged(what, law, replace(result, energy=gained)), too_much(law, replace(result, energy=gained))
        assert told[1] is not None or "energy-grows" in [flag.code for flag in told[0]]


@pytest.mark.slow
def test_a_long_run_stores_a_million_samples_at_most():
    options = {"gravity": 9.81, "t_end": 2.5, "dt": 1e-6}
    thinned, whole = ct.run(RESTING, **options), ct.run(RESTING, record=ct.Record(every=1), **options)
    assert (thinned.steps, thinned.every, thinned.time.size) == (2_500_000, 3, 833_334)
    assert whole.time.size == 2_500_000  # what the caller asks for is stored
    assert np.array_equal(thinned.impulse, whole.impulse)
    assert thinned.intervals == whole.intervals
    assert thinned.energy == whole.energy
    assert "stored: 833,334 samples, one of every 3 steps (at most 1,000,000" in repr(thinned)
    assert "stored:" not in repr(whole)
    assert impact().every == 1


def test_events_keep_no_buffer_alive():
    problem = assemble(RESTING, gravity=9.81)
    stepper = ct.CentralDifference().prepare(problem, ct.Unilateral(), dt=1e-3, courant=None)
    for chunk in steps(stepper, 1000, record=ct.Record(every=100)):
        assert chunk.samples.event_time.base is None


@pytest.mark.parametrize(("t_end", "dt"), [(1e8, 1e-3), (1e50, 1e-50)])
def test_absurdly_many_steps_are_refused(t_end, dt):
    with pytest.raises(
        ct.InputError,
        match=r"t_end: found 1e\+\d+ s with dt = .* s, which is .* steps, about .* computing, expected at",
    ):
        ct.run(RESTING, gravity=9.81, t_end=t_end, dt=dt)


@pytest.mark.slow
def test_all_that_contact_exports_is_light():
    heavy = "numba", "skfem", "matplotlib", "pandas", "pydantic", "scipy", "casingfem"
    code = f"import sys; from contact import *; sys.exit(', '.join(m for m in {heavy} if m in sys.modules) or 0)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
