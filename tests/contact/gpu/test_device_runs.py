"""Runs on a CUDA device: on the simulator those of the compiled loop; without a device they are refused."""

import os
import subprocess
import sys

import numpy as np
import pytest

import contact as ct
from contact.gpu import device_runs
from tests.contact.gpu.simulated_runs import scenes
from tests.contact.test_run_many import scene


def simulated(path):
    """The arrays of `simulated_runs`."""
    environment = {**os.environ, "NUMBA_ENABLE_CUDASIM": "1"}
    line = [sys.executable, "-m", "tests.contact.gpu.simulated_runs", str(path)]
    subprocess.run(line, env=environment, check=True, timeout=300)
    with np.load(path) as found:
        return dict(found)


@pytest.mark.slow
def test_runs_of_the_kernel_are_those_of_the_compiled_loop(tmp_path):
    found = simulated(tmp_path / "runs.npz")
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


def test_a_machine_without_a_device_gets_a_sentence(monkeypatch):
    from numba import cuda

    monkeypatch.setattr(cuda, "is_available", lambda: False)
    expected = r"^gpu: found no CUDA device, expected a CUDA device with its driver, and the extra gpu .*ct\.run_many"
    with pytest.raises(ct.InputError, match=expected):
        device_runs([scene()])
