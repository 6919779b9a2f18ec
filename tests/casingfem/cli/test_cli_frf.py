"""casingfem frf: records in, responses with coherence and geometry, page and pictures out; identify goes on."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.experiment.frf.files import file_coherence

THETA = np.r_[np.radians(np.arange(12) * 30.0 + 5.0), 0.4]
RIG = cf.rig.Rig.of(
    omega=2 * np.pi * np.array([200.0, 201.0, 330.0]), zeta=0.002,
    rows=np.column_stack([np.cos(3 * (THETA - 0.1)), np.sin(3 * (THETA - 0.1)), np.cos(2 * (THETA - 0.3))]),
    probes=[cf.rig.Probe(k + 1, 1, (np.cos(a), np.sin(a), 0.0), a) for k, a in enumerate(THETA)],
)  # fmt: skip


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    tap = cf.rig.Impact(peak=40.0, width=2.5e-3, delay=0.05)
    test = cf.rig.record(RIG, [tap], drives=[12], sensors=range(12), fs=2048.0, block=4096, blocks=3, seed=2)
    return cf.rig.write_rig_uff(tmp_path_factory.mktemp("records") / "records.uff", RIG, test.functions())


def invoke(*arguments):
    return CliRunner().invoke(main, [*map(str, arguments)])


@pytest.mark.slow
def test_records_become_responses_and_those_modes(records, tmp_path):
    result = invoke("frf", records, "--exponential", 0.4, "--out", tmp_path / "out", "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert (document["channels"], document["averages"], document["test"]) == (12, 3, "hammer")
    assert [hit["used"] for hit in document["hits"]] == [True] * 3
    page = (tmp_path / "out" / "frfs.html").read_text(encoding="utf-8")
    for words in ("SYNTHETIC", "3 of 3 hits are used", "Hits of the hammer", "ringing left"):
        assert words in page, words
    coherence = file_coherence(tmp_path / "out" / "frfs.uff")
    assert np.median(coherence.responses.real, axis=1) == pytest.approx(document["median_coherence"], abs=1e-3)
    assert min(document["median_coherence"]) > 0.99
    found = invoke("identify", tmp_path / "out" / "frfs.uff", "--json")
    modes = json.loads(found.stdout)["modes"]
    assert [mode["n"] for mode in modes] == [3, 3, 2]
    np.testing.assert_allclose([mode["freq_hz"] for mode in modes], RIG.freq, rtol=1e-5)
    np.testing.assert_allclose([mode["zeta"] for mode in modes], 0.002, rtol=0.01)


@pytest.mark.slow
def test_the_options_reach_the_estimate_and_bad_input_is_refused(records, tmp_path):
    result = invoke("frf", records, "--seconds", 1.0, "--before", 0.02, "--estimator", "Hv", "--band", 100, 400)
    assert result.exit_code == 0, result.output
    assert "300 lines, 100 to 399 Hz" in result.stdout
    for arguments, words in (
        ((records, "--exponential", -1.0), "exponential: found -1.0"),
        ((records, "--test", "shaker", "--seconds", 100.0), "blocks of 204800 samples"),
        ((tmp_path / "none.uff",), "no such file"),
        ((records, "--channels", records), "channels"),
    ):
        result = invoke("frf", *arguments)
        assert result.exit_code == 2, result.output
        assert "Traceback" not in result.output
        if words != "channels":
            assert words in result.output
