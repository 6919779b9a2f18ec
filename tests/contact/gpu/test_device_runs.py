"""Runs on a CUDA device: on the simulator those of the compiled loop; without a device they are refused."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import contact as ct
from contact.gpu import device_runs
from tests.contact.gpu.simulated_runs import scenes, stopping
from tests.contact.test_run_many import scene


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """The arrays and the text of `simulated_runs`."""
    path = tmp_path_factory.mktemp("simulated") / "runs.npz"
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
    line = [sys.executable, "-m", "tests.contact.gpu.simulated_runs", str(path)]
    subprocess.run(line, env=environment, check=True, timeout=300)
    with np.load(path) as found:
        return dict(found), json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_runs_of_the_kernel_are_those_of_the_compiled_loop(simulated):
    found, _ = simulated
    runs = [ct.run(one) for one in scenes()]
    assert max(found["contact_steps"]) > 50
    for k, one in enumerate(runs):
        assert found["stopped"][k] == ""
        assert (found["steps"][k], found["contact_steps"][k]) == (one.steps, one.contact_steps[0])
        sums = {
            "impulse": one.impulse[0], "peak": one.peak_force[0], "penetration": one.max_penetration[0],
            "work": one.energy.contact, "rotation": one.energy.rotation, "friction": one.energy.friction,
            "damping": one.energy.damping,
        }  # fmt: skip
        scale = max(abs(sums[name]) for name in ("work", "rotation", "friction", "damping"))
        for name, value in sums.items():
            size = scale if name in ("work", "rotation", "friction", "damping") else abs(value)
            assert found[name][k] == pytest.approx(value, rel=0.0, abs=1e-12 * size + 1e-18)


@pytest.mark.slow
def test_runs_of_the_kernel_stop_where_the_tip_or_the_rim_goes_too_far(simulated):
    """The tip stops as in `ct.run`; a bound of the rim's deflection, looked at every 64 steps, is above the deflection.

    The rim deflects by 5.9 mm at step 65, which half of a wall of 30 mm exceeds even as a bound.
    """
    _, text = simulated
    assert text["stopped"] == ["the tip passed its limit"] * 2 + ["the rim may pass its limit"] * 3 + [""] * 2
    for one, steps in zip(stopping()[:2], text["steps"], strict=False):
        with pytest.raises(ct.NumericsError, match="diverged") as stopped:
            ct.run(one)
        assert stopped.value.result.steps == steps
    assert text["steps"][2:] == [0, 64, 64, 70, 70]
    for one, most in zip(stopping()[2:], [0, 65, 65], strict=False):
        with pytest.raises(ct.NumericsError, match="diverged") as stopped:
            ct.run(one)
        assert stopped.value.result.steps >= most


@pytest.mark.slow
def test_groups_of_runs_report_their_share_and_give_the_same_and_other_scenes_are_refused(simulated):
    _, text = simulated
    assert text["shares"] == [1.0, 128.0 / 130.0, 1.0]
    assert text["same"]
    none, sizes, model = text["refused"]
    assert none == "gpu: found scenes of [] modes, expected at least one scene, all with as many modes"
    assert sizes == "gpu: found scenes of [11, 12] modes, expected at least one scene, all with as many modes"
    expected = "a rotating rim with one tip at constant speed, without coating: use ct.run_many"
    assert model == f"gpu: scene 1: found another model of contact, expected {expected}"


def test_a_machine_without_a_device_gets_a_sentence(monkeypatch):
    from numba import cuda

    monkeypatch.setattr(cuda, "is_available", lambda: False)
    expected = r"^gpu: found no CUDA device, expected a CUDA device with its driver, and the extra gpu .*ct\.run_many"
    with pytest.raises(ct.InputError, match=expected):
        device_runs([scene()])
