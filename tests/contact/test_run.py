"""run and Result: chunks, recording, files, determinism, what import costs."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import contact as ct
from tests.contact.synthetic_rim import blade, ring

BAR = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=5.0, velocity=-10.0, elements=40)


def rub(**options):
    scene = ct.RotatingRim(ring(imperfect=0.05), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=20.0)
    return ct.run(scene, law=ct.Coulomb(mu=0.2), **{"t_end": 0.05, "dt": 1e-5} | options)


def impact(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], **{"t_end": 2.0, "courant": 0.9} | options)


def modal(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], scheme=ct.ExactModal(law="forward"), **{"t_end": 2.0, "dt": 1e-3} | options)


def kept(**options):
    return ct.run([BAR, ct.Wall(x=0.0)], scheme=ct.ExactModal(law="energy"), **{"t_end": 2.0, "dt": 1e-3} | options)


@pytest.mark.slow
def test_a_longer_rub_begins_as_the_shorter_one_whose_compiled_calls_end_at_other_steps():
    """A call takes a fixed part of a rub's steps."""
    short = rub(record=ct.Record(state_every=1))
    for factor in (1.013, 1.21):
        long = rub(record=ct.Record(state_every=1), t_end=factor * 0.05)
        for name in ("time", "force", "gap", "impulse_history", "state"):
            assert np.array_equal(getattr(long, name)[: short.steps], getattr(short, name))
        assert [span for span in long.intervals[0] if span[1] < 0.049] == [
            span for span in short.intervals[0] if span[1] < 0.049
        ]


@pytest.mark.slow
@pytest.mark.parametrize("make", [impact, modal, kept, rub])
def test_a_run_of_several_compiled_calls_loses_no_sample_no_contact_and_no_impulse(make):
    """Calls end at 20,000 steps at most, which is no multiple of the samples kept."""
    done = []
    options = {"dt": 1e-6, "t_end": 0.05} if make is rub else {"dt": 2e-5, "t_end": 1.0, "courant": None}
    whole, parts = make(**options), make(record=ct.Record(every=7, state_every=14), progress=done.append, **options)
    assert whole.steps > 45_000
    assert np.array_equal(parts.time, whole.time[::7])
    assert np.array_equal(parts.force, whole.force[::7])
    assert np.array_equal(parts.impulse_history, whole.impulse_history[::7])
    assert parts.state.shape[0] == (whole.steps - 1) // 14 + 1
    assert (parts.intervals, parts.energy) == (whole.intervals, whole.energy)
    assert np.array_equal(parts.impulse, whole.impulse)
    assert whole.impulse[0] == pytest.approx(whole.force[:, 0].sum() * whole.dt, rel=1e-9)
    closed = np.diff(np.r_[0, whole.force[:, 0] > 0.0])
    assert len(whole.intervals[0]) == np.count_nonzero(closed == 1)
    assert len(done) > 3
    assert done == sorted(done)
    assert done[-1] == 1.0


@pytest.mark.parametrize(
    "given",
    [
        {}, {"gravity": 0.0}, {"t_end": 0.7}, {"dt": 0.02}, {"on_limit": "stop"}, {"record": ct.Record(every=2)},
        {"scheme": ct.MoreauJean()}, {"law": ct.Penalty(stiffness=10.0)}, {"courant": 0.5},
    ],
    ids=str,
)  # fmt: skip
def test_what_a_call_gives_takes_the_place_of_what_the_scene_states(given):
    """Zero too; a step of one kind replaces the other's; what is left out stays."""
    rod = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=5, x=0.1, velocity=-1.0)
    scene = ct.Scene(
        what=[rod, ct.Wall()], t_end=0.3, dt=0.01, gravity=9.81, law=ct.Unilateral(), scheme=ct.CentralDifference(),
        record=ct.Record(every=3), on_limit="flag",
    )  # fmt: skip
    if "law" in given:
        scene = replace(scene, scheme=ct.scheme.PenaltyDifference())
    changed = replace(scene, **given | ({"dt": None} if "courant" in given else {}))
    found, expected = ct.run(scene, **given), ct.run(changed)
    for name in ("time", "force", "gap"):
        assert np.array_equal(getattr(found, name), getattr(expected, name))
    assert (found.dt, found.scheme, found.steps) == (expected.dt, expected.scheme, expected.steps)


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


RESTING = [ct.Wall(x=0.0), ct.PointMass(mass=1.0, x=0.0, velocity=0.0)]


@pytest.mark.parametrize("scheme", [ct.CentralDifference(), ct.ExactModal(law="forward")])
def test_a_mass_at_rest_raises_no_alarm(scheme):
    """Its energy is that of the half step at the start; contact takes it out, and that is no gain."""
    result = ct.run(RESTING, scheme=scheme, gravity=9.81, t_end=1.0, dt=1e-3)
    assert result.impulse[0] == pytest.approx(9.81, rel=2e-3)
    assert result.energy.load_step == pytest.approx(9.81**2 * 1e-6)
    assert result.flags == ()


@pytest.mark.slow
def test_a_long_run_stores_a_million_samples_at_most():
    options = {"gravity": 9.81, "t_end": 1.2, "dt": 1e-6}
    thinned, whole = ct.run(RESTING, **options), ct.run(RESTING, record=ct.Record(every=1), **options)
    assert (thinned.steps, thinned.every, thinned.time.size) == (1_200_000, 2, 600_000)
    assert whole.time.size == 1_200_000  # what the caller asks for is stored
    assert np.array_equal(thinned.impulse, whole.impulse)
    assert thinned.intervals == whole.intervals
    assert thinned.energy == whole.energy
    assert "stored: 600,000 samples, one of every 2 steps (at most 1,000,000" in repr(thinned)
    assert "stored:" not in repr(whole)
    assert impact().every == 1


@pytest.mark.parametrize(("t_end", "dt"), [(1e8, 1e-3), (1e50, 1e-50)])
def test_absurdly_many_steps_are_refused(t_end, dt):
    with pytest.raises(
        ct.InputError,
        match=r"t_end: found 1e\+\d+ s with dt = .* s, .* steps or about .* computing time, expected at",
    ):
        ct.run(RESTING, gravity=9.81, t_end=t_end, dt=dt)


@pytest.mark.slow
def test_all_that_contact_exports_is_light():
    heavy = "numba", "skfem", "matplotlib", "pandas", "pydantic", "scipy", "casingfem"
    code = f"import sys; from contact import *; sys.exit(', '.join(m for m in {heavy} if m in sys.modules) or 0)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_histories_longer_than_asked_for_are_left_out_of_the_document_and_counted():
    result = impact()
    numbers, ends = 4 * result.time.size * result.impulse.size, 2 * sum(map(len, result.intervals))
    assert 0 < ends < numbers // 8
    histories = {name: numbers // 4 for name in ("time", "force", "gap", "windowed_force")}

    def left_out(most):
        document = result.to_dict(most=most)
        (one,) = document["contacts"]
        assert {"time", "force", "gap", "windowed_force", "intervals"} - set(one) == set(document["left_out"])
        return document["left_out"]

    assert left_out(None) == left_out(numbers) == {}
    assert left_out(numbers - 1) == left_out(ends) == histories
    assert left_out(ends - 1) == histories | {"intervals": ends}
