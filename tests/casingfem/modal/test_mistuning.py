"""Random mistuning: draws equal their full solutions, do not depend on each other, and runs go on."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from tests.casingfem.study.study_texts import STEEL

COUNT = 10
SOFT = cf.ElasticEdge(k_r=2e9, k_theta=5e9, k_z=2e10, k_rot=1e6, k_face=1e10)
SPECTRUM = cf.field.Spectrum(p=[1, 3, 8], median=[0.004, 0.002, 0.001], high=[0.01, 0.005, 0.003])
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
p_max = 3
[modes]
count = 3
[mesh]
order = 7
rows = 1
around = 11
"""
)


def tube(**parts):
    """A short thick tube, on a mesh right to 1e-5 in the modes asked for."""
    usual = {
        "chart": cf.Cylinder(radius=0.5, height=0.3), "supports": {"base": cf.Clamped()},
        "mesh": cf.ShellMesh(order=7, rows=1, around=13),
    }  # fmt: skip
    return cf.Shell(thickness=0.01, material=cf.Material(E=210e9, nu=0.3, rho=7800.0), **usual | parts)


def lab(scale, p_max=10):
    """Radius defects by the example spectrum."""
    return cf.field.RandomField.example(thickness=0.01, radius=0.5, seed=7, scale=scale, p_max=p_max)


def of_draw(found, draw):
    """The rows of one draw: n, m, mean frequency, split, angle."""
    own = found.draw == draw
    return found.n[own], found.m[own], found.freq[own], found.split[own], found.angle_deg[own]


def of_modes(found):
    """The same of a full solution."""
    low, high = np.array(found.doublets).T
    freq = 0.5 * (found.freq[low] + found.freq[high])
    return found.nodal_diameters[low], found.meridional[low], freq, found.splits, found.angle_deg[low]


def field(stream):
    """Another random field, of thickness, modulus or density."""
    return cf.field.RandomField(spectrum=SPECTRUM, seed=5, stream=stream)


CASINGS = {
    "all four fields, on springs": {
        "radius_defect": lab(0.1), "thickness_defect": field(1), "modulus_defect": field(2), "density_defect": field(3),
        "supports": {"base": SOFT},
    },
    "free, with a part that is the same for all": {
        "radius_defect": cf.FourierField.of({4: (5e-4, 2e-4), 3: 3e-4}) + lab(0.1), "supports": {},
    },
    "published wall theory": {"thickness_defect": field(1), "wall": "linear"},
    "slender, with a torsion among the modes": {
        "radius_defect": lab(0.1), "thickness_defect": field(1), "chart": cf.Cylinder(radius=0.1, height=0.5),
    },
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fields", CASINGS.values(), ids=CASINGS)
def test_draws_are_their_full_solutions(fields):
    shell = tube(**fields)
    found = cf.modal.mistune(shell, 2, count=COUNT)
    drawn = {name: redrawn(part, 1) for name, part in fields.items()}
    full = of_modes(cf.modes(tube(**drawn), COUNT, method="shell"))
    n, m, freq, split, angle = of_draw(found, 1)
    np.testing.assert_array_equal((n, m), full[:2])
    np.testing.assert_allclose(freq, full[2], rtol=3e-5)
    np.testing.assert_allclose(split, full[3], rtol=1e-2, atol=5e-3 * full[3].max())
    wide = full[3] > 0.05 * full[3].max()
    apart = np.mod(angle - full[4] + 90.0 / n, 180.0 / n) - 90.0 / n
    assert np.abs(apart[wide]).max() < 0.1


def redrawn(part, draw):
    """A random field, or a sum with one, of another draw; anything else as it is."""
    if isinstance(part, cf.field.SumField):
        return cf.field.SumField(tuple(redrawn(each, draw) for each in part.fields))
    return part.redrawn(draw) if isinstance(part, cf.field.RandomField) else part


@pytest.mark.slow
@pytest.mark.parametrize(
    "parts",
    [
        {"radius_defect": lab(2.0)},
        {"radius_defect": lab(0.3), "supports": {"base": cf.Bolts(count=9, k=1e9, k_rot=1e5)}},
        {"radius_defect": lab(0.3) + cf.FourierField(p=[3], cos=[[0.0, 1e-3]], sin=[[0.0, 0.0]])},
    ],
    ids=["as large as the wall", "on bolts", "beside a field that varies along the axis"],
)
def test_what_is_not_near_a_perfect_casing_is_solved_in_full(parts):
    shell = tube(**parts | {"mesh": cf.ShellMesh(order=5, rows=1, around=9)})
    n, m, freq, split, angle = of_draw(cf.modal.mistune(shell, 1, count=6), 0)
    full = of_modes(cf.modes(shell, 6, method="shell"))
    for mine, theirs in zip((n, m, freq, split, angle), full, strict=True):
        np.testing.assert_array_equal(mine, theirs)


@pytest.mark.slow
def test_a_split_grows_with_its_own_harmonic_and_its_angle_follows_the_field():
    """Of thickness alone: first order in p = 2 n; a crest at 30 degrees takes the stiffer member with it."""
    splits = []
    for size in (1e-3, 2e-3):
        even = cf.field.Spectrum(p=[8], median=[size], high=[size])
        found = cf.modal.mistune(tube(thickness_defect=cf.field.RandomField(spectrum=even, seed=1)), 3, count=6)
        splits.append(found.split[found.n == 4])
        assert found.split[found.n != 4].max() < 1e-2 * splits[-1].min()
        np.testing.assert_allclose(splits[-1], splits[-1][0], rtol=1e-6)  # phases differ, sizes do not
    np.testing.assert_allclose(splits[1], 2.0 * splits[0], rtol=1e-4)


def test_mesh_is_chosen_for_the_spectrum_not_for_the_draw(frustum):
    random = cf.field.RandomField.example(thickness=3e-3, radius=0.475, seed=7)
    meshes = {frustum(radius_defect=random.redrawn(k)).mesh for k in range(12)}
    assert len(meshes) == 1


def test_only_casings_of_revolution_have_pairs_and_something_must_be_random(steel):
    random = cf.field.RandomField(spectrum=cf.field.Spectrum(p=[2], median=[0.01], high=[0.02]), seed=1)
    plate = cf.Shell(chart=cf.Plate(length=1.0, width=0.5), thickness=0.01, material=steel, thickness_defect=random)
    with pytest.raises(ValueError, match="expected a casing of revolution"):
        cf.modal.mistune(plate, 2)
    with pytest.raises(ValueError, match="found a shell without random fields"):
        cf.modal.mistune(tube(radius_defect=cf.FourierField.of({3: 1e-3})), 2)


@pytest.mark.slow
def test_a_summary_counts_draws_and_has_their_quantiles():
    found = cf.modal.mistune(tube(radius_defect=lab(0.3)), 7, count=8)
    assert found.draws == 7
    for row in found.records():
        own = (found.n == row["n"]) & (found.m == row["m"])
        assert row["draws"] == own.sum() > 0
        assert row["split_90"] == pytest.approx(np.quantile(found.split[own], 0.9))
        assert row["shift_50"] == pytest.approx(np.median(found.freq[own] / row["freq_hz"] - 1.0))
    assert "7 draws" in repr(found)


# --- the command ----------------------------------------------------------------------------------------------


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def tables(out):
    return {name: (out / name).read_bytes() for name in ("mistune.csv", "mistune_summary.csv")}


def run(study, out, draws, *more):
    """The command's document."""
    arguments = ["mistune", str(study), "--draws", str(draws), "--json", "--out", str(out), *more]
    result = CliRunner().invoke(main, arguments)
    assert (result.exit_code, result.stderr) == (0, "")
    return json.loads(result.stdout)


def test_a_study_without_random_fields_is_refused(study):
    study.write_text(STUDY.replace('random = "example"\nseed = 7\nscale = 0.2\np_max = 3', "harmonics = [{p = 3}]"))
    result = CliRunner().invoke(main, ["mistune", str(study), "--draws", "2"])
    assert result.exit_code == 2
    assert "study.toml: imperfection: found a shell without random fields" in result.stderr


@pytest.mark.slow
def test_more_draws_are_added_a_spoilt_chunk_is_made_again_and_another_study_is_refused(study, tmp_path):
    out = tmp_path / "out"
    first = run(study, out, 12, "--processes", "2")
    assert first["resumed"] == 0
    assert first["checked"]["0"]["freq"] < 1e-4
    before = tables(out)
    more = run(study, out, 20, "--processes", "1")
    assert more["resumed"] == 10
    assert (out / "mistune.csv").read_text().startswith(before["mistune.csv"].decode().rsplit("\n", 1)[0])
    chunk = sorted((out / "draws").glob("draws_*.json"))[0]
    chunk.write_text(chunk.read_text()[:-20])
    after = tables(out)
    assert run(study, out, 20, "--processes", "1")["resumed"] == 10
    assert tables(out) == after
    printed = CliRunner().invoke(main, ["mistune", str(study), "--draws", "20", "--out", str(out)]).stdout
    near, resumed = 20 - len(more["solved_in_full"]), "20 draws were read from earlier results"
    for line in (f"{near} draws from the perfect casing's modes: estimated error of a frequency ", resumed):
        assert line in printed
    shell = cf.load_study(study).shell
    rows = np.loadtxt((out / "mistune.csv").read_text().splitlines(), delimiter=",", comments="#", skiprows=3)
    np.testing.assert_array_equal(rows[:, 3], cf.modal.mistune(shell, 20, count=3).freq)
    study.write_text(STUDY.replace("seed = 7", "seed = 8"))
    result = CliRunner().invoke(main, ["mistune", str(study), "--draws", "2", "--out", str(out)])
    assert result.exit_code == 2
    assert "draws contains draws of another study or version: give another --out" in result.stderr


@pytest.mark.campaign
def test_a_killed_run_goes_on_to_the_same_bits(study, tmp_path):
    """Kill -9 after the first chunk, resume with another number of processes; against a run that was left alone."""
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    arguments = ["mistune", str(study), "--draws", "200", "--json", "--out"]
    line = [sys.executable, "-m", "casingfem", *arguments, str(broken), "--processes", "1"]
    process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120.0
    while not list(broken.glob("draws/draws_*.json")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    children = children_of(process.pid)
    process.kill()
    assert process.wait() == -signal.SIGKILL, "it was through before it could be killed"
    kept = sorted(broken.glob("draws/draws_*.json"))
    assert 1 <= len(kept) < 20
    assert not list(broken.glob("mistune*"))
    assert children
    assert gone(children)  # nobody waits for work for ever
    kept = sorted(broken.glob("draws/draws_*.json"))
    assert run(study, broken, 200, "--processes", "2")["resumed"] == 10 * len(kept)
    run(study, whole, 200, "--processes", "1")
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
