"""Random mistuning: restarts equal solutions from nothing, draws do not depend on each other, runs go on."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from casingfem.cli.sweep import files_of_draws, words_of_draws
from casingfem.modal import mistuning
from casingfem.modal.mistuning import Pair, drawn_modes, mean_modes, mean_shell, redrawn_shell
from casingfem.modal.neighbour import guarded, restarted_modes
from casingfem.study.mistuning import MistuneRun, run_mistune
from tests.casingfem.study.study_texts import STEEL

COUNT = 12
STUDY = (
    STEEL
    + """
[chart]
kind = "cylinder"
radius = 0.5
height = 0.3
[shell]
thickness = 0.01
[support.base]
kind = "clamped"
[[imperfection]]
of = "radius"
random = "example"
seed = 7
scale = 0.2
p_max = 12
[modes]
count = 6
[mesh]
order = 5
rows = 1
around = 9
"""
)


@pytest.fixture(scope="module")
def casing(frustum, coarse):
    random = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7, p_max=12)
    spectrum = cf.field.Spectrum.between({2: 0.01, 8: 0.003}, {2: 0.02, 8: 0.006})
    return frustum(
        mesh=coarse,
        radius_defect=cf.FourierField.of({3: 0.001}) + random,
        modulus_defect=cf.field.RandomField(spectrum=spectrum, seed=7, stream=1),
    )


@pytest.fixture(scope="module")
def mean(casing):
    return mean_modes(casing, COUNT)


@pytest.mark.slow
def test_a_restart_gives_the_frequencies_splits_and_angles_of_a_solution_from_nothing(casing, mean):
    for draw in (0, 3):
        drawn = redrawn_shell(casing, draw)
        quick, full = restarted_modes(drawn, mean, COUNT), cf.modes(drawn, COUNT, method="shell")
        np.testing.assert_allclose(quick.freq, full.freq, rtol=3e-6)
        np.testing.assert_array_equal(quick.nodal_diameters, full.nodal_diameters)
        np.testing.assert_allclose(quick.splits, full.splits, atol=3e-6)
        np.testing.assert_allclose(quick.angle_deg, full.angle_deg, atol=0.05)
        assert quick.sturm_count == full.sturm_count == COUNT
    spoilt = replace(full, freq=full.freq * (1.0 + 1e-3 * (np.arange(COUNT) == 5)))
    assert mistuning.restart_error(spoilt) == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.slow
def test_each_block_step_gains_digits(casing, mean):
    drawn = redrawn_shell(casing, 3)
    exact = cf.modes(drawn, COUNT, method="shell").freq
    errors = [np.abs(restarted_modes(drawn, mean, COUNT, steps=k).freq / exact - 1).max() for k in (1, 2, 3)]
    assert errors[0] > 30 * errors[1] > 900 * errors[2]


@pytest.mark.slow
def test_the_inertia_sees_what_a_restart_cannot_reach(frustum, coarse, mean):
    """Cosine members alone, on a casing with a plane of symmetry: the sine members stay out of reach."""
    half = cf.modes(mean_shell(frustum(mesh=coarse)), 40, method="shell")
    low = [pair[0] for pair in half.doublets]
    known = replace(half, freq=half.freq[::2], fields=half.fields[:, :, low], own=half.own[:, low])
    with pytest.raises(cf.errors.NumericsError, match="modes lie below"):
        restarted_modes(frustum(mesh=coarse, radius_defect=cf.FourierField.of({8: 0.002})), known, COUNT)


@pytest.mark.slow
def test_a_draw_whose_restart_fails_is_solved_from_nothing(casing, mean, monkeypatch):
    def fails(*arguments):
        raise cf.errors.NumericsError("13 modes lie below, 12 were found")

    restarted = drawn_modes(casing, mean, COUNT, 1)
    monkeypatch.setattr(mistuning, "restarted_modes", fails)
    solved = drawn_modes(casing, mean, COUNT, 1)
    assert (restarted[1], solved[1]) == (True, False)
    np.testing.assert_allclose(restarted[0].freq, solved[0].freq, rtol=3e-6)


@pytest.mark.parametrize(("count", "known"), [(1, 9), (12, 20), (16, 24), (40, 60)])
def test_a_restart_starts_from_half_as_many_modes_again_and_eight_more_at_least(count, known):
    assert guarded(count) == known


def test_a_restart_wants_modes_enough_of_the_same_mesh(casing, mean):
    with pytest.raises(ValueError, match="needs 26 or more, of a shell on the same mesh"):
        restarted_modes(casing, mean, 22)
    with pytest.raises(ValueError, match="on the same mesh"):
        restarted_modes(replace(casing, mesh=replace(casing.mesh, around=11)), mean, 4)


def test_what_is_not_random_stays(casing):
    bare = mean_shell(casing)
    assert bare.radius_defect.harmonics == (3,)
    assert bare.modulus_defect is None
    one, two = (redrawn_shell(casing, k).radius_defect.derivatives(0.1, 0.2).value for k in (1, 2))
    assert one != two
    with pytest.raises(ValueError, match="nothing of this shell is random"):
        redrawn_shell(bare, 1)


def test_mesh_is_chosen_for_the_spectrum_not_for_the_draw(frustum):
    random = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7)
    meshes = {frustum(radius_defect=random.redrawn(k)).mesh for k in range(12)}
    assert len(meshes) == 1


def test_summary_counts_and_quantiles():
    rows = [Pair(k, 4, 1, 100.0 + k, 0.01 * k, 3.0) for k in range(11)] + [Pair(0, 5, 1, 90.0, 0.2, float("nan"))]
    perfect = [Pair(-1, 4, 1, 100.0, 0.0, 0.0), Pair(-1, 5, 1, 90.0, 0.0, 0.0), Pair(-1, 9, 2, 300.0, 0.0, 0.0)]
    found = cf.modal.Mistuning.of(rows, perfect)
    five, four, nine = found.summary()
    assert (four["n"], four["draws"], five["draws"], nine["draws"], nine["split_50"]) == (4, 11, 1, 0, None)
    assert [four[f"split_{k}"] for k in (50, 90, 99)] == pytest.approx([0.05, 0.09, 0.099])
    assert [four[f"shift_{k}"] for k in (10, 50, 90)] == pytest.approx([0.01, 0.05, 0.09])
    assert found.draws == 11
    assert repr(found).splitlines()[2].split()[:5] == ["4", "1", "100.000", "11", "5.0000"]
    assert set(repr(found).splitlines()[3].split()[4:]) == {"-"}


def test_only_casings_of_revolution_have_pairs(steel):
    from casingfem import Plate, Shell

    field = cf.field.RandomField(spectrum=cf.field.Spectrum(p=[2], median=[0.01], high=[0.02]), seed=1)
    plate = Shell(chart=Plate(length=1.0, width=0.5), thickness=0.01, material=steel, thickness_defect=field)
    with pytest.raises(ValueError, match="pairs of casings of revolution"):
        cf.mistune(plate, 2)


@pytest.mark.slow
def table_of(text):
    """Names of the columns and numbers to the last digit (pandas' reader rounds in some versions)."""
    head, *rows = (line.split(",") for line in text.splitlines() if not line.startswith("#"))
    return head, np.array([[float(x or "nan") for x in row] for row in rows])


def test_tables_of_draws_are_read_back_and_the_largest_error_is_told():
    rows = [Pair(0, 4, 1, 101.0, 0.02, 3.5), Pair(0, 5, 2, 92.0, 0.03, float("nan")), Pair(1, 4, 1, 99.0, 0.04, 7.5)]
    perfect = [Pair(-1, 4, 1, 100.0, 0.0, 0.0), Pair(-1, 5, 2, 90.0, 0.0, 0.0), Pair(-1, 9, 2, 300.0, 0.0, 0.0)]
    found = cf.modal.Mistuning.of(rows, perfect)
    source = {"study": "study.toml", "sha256": "beef", "versions": {"casingfem": "1.2"}}
    files = files_of_draws(found, {"source": source, "doublets": found.summary()})
    draws, summary = (table_of(files[name]) for name in ("mistune.csv", "mistune_summary.csv"))
    assert draws[0] == ["draw", "n", "m", "freq_hz", "split_rel", "angle_deg"]
    np.testing.assert_array_equal(draws[1], np.array(rows, dtype=float))
    assert summary[0] == list(found.summary()[0])
    np.testing.assert_array_equal(
        summary[1],
        np.array([[np.nan if x is None else x for x in row.values()] for row in found.summary()], dtype=float),
    )
    run = MistuneRun(found=found, errors={0: 3e-9, 50: 2e-8, 100: 4e-10}, from_nothing=(7, 9), resumed=5)
    assert words_of_draws(run).splitlines()[1:] == [
        "3 draws also solved from nothing: frequencies differ by 2.0e-08 at most",
        "2 draws solved from nothing: the restart had missed modes",
        "5 draws were there already",
    ]


# --- the command ----------------------------------------------------------------------------------------------


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def tables(out):
    return {name: (out / name).read_bytes() for name in ("mistune.csv", "mistune_summary.csv")}


def test_a_study_without_random_fields_is_refused(study):
    study.write_text(STUDY.replace('random = "example"\nseed = 7\nscale = 0.2\np_max = 12', "harmonics = [{p = 3}]"))
    result = CliRunner().invoke(main, ["mistune", str(study), "--draws", "2"])
    assert result.exit_code == 2
    assert "study.toml: imperfection: nothing of this shell is random" in result.stderr


@pytest.mark.campaign
def test_a_killed_run_goes_on_to_the_same_bits(study, tmp_path):
    """Kill -9 after the first chunk, resume with another number of processes; against a run that was left alone."""
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    arguments = ["mistune", str(study), "--draws", "10", "--json", "--out"]
    line = [sys.executable, "-m", "casingfem", *arguments, str(broken), "--processes", "1"]
    process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120.0
    while not list(broken.glob("draws/draws_*.json")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    children = children_of(process.pid)
    process.kill()
    assert process.wait() == -signal.SIGKILL, "it was through before it could be killed"
    kept = sorted(broken.glob("draws/draws_*.json"))
    assert len(kept) == 1
    assert not list(broken.glob("mistune*"))
    for chunk in kept:
        assert len(json.loads(chunk.read_text())["draws"]["pairs"]) >= 5
    assert children
    assert gone(children)  # nobody waits for work for ever
    resumed = CliRunner().invoke(main, [*arguments, str(broken), "--processes", "2"])
    assert (resumed.exit_code, resumed.stderr) == (0, "")
    document = json.loads(resumed.stdout)
    assert document["resumed"] == 5 * len(kept)
    chunk = broken / "draws" / "draws_000005_000009.json"
    chunk.write_text(chunk.read_text().replace("1", "2", 1))
    assert document["restart_errors"]["0"] < 1e-6
    assert CliRunner().invoke(main, [*arguments, str(whole), "--processes", "1"]).exit_code == 0
    assert tables(whole) == tables(broken)
    assert json.loads(CliRunner().invoke(main, [*arguments, str(broken)]).stdout)["resumed"] == 5
    assert tables(whole) == tables(broken)
    assert (whole / "mistune.png").stat().st_size > 5000


def children_of(pid):
    listing = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    return [int(word) for word in listing.stdout.split()]


def gone(pids):
    deadline = time.monotonic() + 20.0
    while any(alive(pid) for pid in pids) and time.monotonic() < deadline:
        time.sleep(0.05)
    return not any(alive(pid) for pid in pids)


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return (
        "Z" not in subprocess.run(["ps", "-o", "stat=", str(pid)], capture_output=True, text=True, check=False).stdout
    )


@pytest.mark.slow
def test_draws_of_another_study_are_not_mixed_in(study, tmp_path):
    loaded = cf.load_study(study)
    first = run_mistune(loaded, 2, processes=1, folder=tmp_path / "draws")
    alone = cf.mistune(loaded.shell, 2, count=6)
    np.testing.assert_array_equal(first.found.freq, alone.freq)
    study.write_text(STUDY.replace("seed = 7", "seed = 8"))
    with pytest.raises(cf.errors.InputError, match=r"study\.toml: .*draws holds draws of another study or version"):
        run_mistune(cf.load_study(study), 2, processes=1, folder=tmp_path / "draws")
