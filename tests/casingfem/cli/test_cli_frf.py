"""casingfem frf: records in, responses with coherence and geometry, page and pictures out; identify goes on."""

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main

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


@pytest.mark.slow
def test_the_file_of_responses_has_the_nodes_and_lines_of_the_records(records, tmp_path):
    result = invoke("frf", records, "--seconds", 1.0, "--before", 0.02, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    given, found = cf.uff.read_uff(records), cf.uff.read_uff(tmp_path / "frfs.uff")
    assert given.lines
    np.testing.assert_array_equal(found.nodes.labels, given.nodes.labels)
    np.testing.assert_allclose(found.nodes.points, given.nodes.points, rtol=1e-7)
    assert [line.nodes.tolist() for line in found.lines] == [line.nodes.tolist() for line in given.lines]


@pytest.mark.slow
def test_the_file_of_responses_states_estimate_and_window_under_any_comment(records, tmp_path):
    given, comment = cf.uff.read_uff(records), [f"comment {k} {'x' * 60}" for k in range(7)]
    path = cf.uff.write_uff(tmp_path / "a.uff", header=comment, nodes=given.nodes, functions=given.functions)
    result = invoke("frf", path, "--seconds", 1.0, "--before", 0.02, "--exponential", 0.3, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    card = cf.frf.FrfSet.from_uff(tmp_path / "frfs.uff").card
    assert card[-2:] == ("H1 of 3 hits, 2048 samples at 2048 Hz, force window", "exponential_window_s: 0.3")
    assert card[0] == comment[0]
