"""Files of the test rig: what is written is what is read, and says SYNTHETIC."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.circle.record import turning
from casingfem.experiment.rig.files import origin

ANGLES = (0.0, 2.0, 4.0)
PROBES = [cf.rig.Probe(k + 1, 1, (float(np.cos(a)), float(np.sin(a)), 0.25), a) for k, a in enumerate(ANGLES)]
RIG = cf.rig.Rig.of(omega=[600.0, 700.0], zeta=0.01, rows=[[1.0, 0.3], [0.2, -0.4], [0.6, 0.1]], probes=PROBES)


@pytest.fixture
def frfs():
    clean = RIG.frfs(np.arange(80.0, 120.0, 0.5), sensors=[1, 2], drives=[0], card=origin(RIG, "study: x"))
    return cf.rig.noisy(clean, 40.0, seed=818)


def test_universal_files_give_back_functions_geometry_and_card(frfs, tmp_path):
    path = cf.rig.write_rig_uff(tmp_path / "rig.uff", RIG, [frfs])
    back, file = cf.frf.FrfSet.from_uff(path), cf.uff.read_uff(path)
    assert np.array_equal(back.responses, frfs.responses)
    np.testing.assert_allclose(back.x, frfs.x, rtol=1e-12)
    for name in ("response_point", "response_direction", "reference_point", "reference_direction"):
        assert np.array_equal(getattr(back, name), getattr(frfs, name))
    assert back.unit == frfs.unit
    assert back.card[0] == frfs.card[0]
    assert all(function.text[0].startswith("SYNTHETIC") for function in file.functions)
    np.testing.assert_allclose(file.nodes.points, [p.point for p in PROBES], rtol=1e-14)
    assert file.lines[0].nodes.tolist() == [1, 2, 3]
    assert not file.skipped


def test_time_records_too(tmp_path):
    test = cf.rig.record(
        RIG,
        [cf.rig.Random(rms=1.0, band=(50.0, 150.0))],
        drives=[0],
        sensors=[1, 2],
        fs=512.0,
        block=256,
        blocks=2,
        seed=5,
    )
    responses, forces = test.functions()
    path = cf.rig.write_rig_uff(tmp_path / "time.uff", RIG, [responses])
    back = cf.frf.FrfSet.from_uff(path, "time")
    assert np.array_equal(back.responses, test.response)
    assert (back.unit, forces.unit) == ("m/s^2", "N")
    assert forces.response_point.tolist() == [1]


def test_the_card_names_seed_versions_and_hash(frfs):
    card = "\n".join(frfs.card)
    assert frfs.card[0].startswith("SYNTHETIC")
    for words in ("seed 818", "versions: casingfem", "rig: sha256", "study: x"):
        assert words in card
    other = cf.rig.Rig.of(omega=[600.0, 700.1], zeta=0.01, rows=RIG.rows)
    assert origin(RIG)[1] != origin(other)[1]


def test_measured_functions_are_not_the_rigs(frfs, tmp_path):
    with pytest.raises(ValueError, match="does not say SYNTHETIC"):
        cf.rig.write_rig_uff(tmp_path / "rig.uff", RIG, [replace(frfs, card=("measured by hand",))])


def test_scans_come_back(tmp_path):
    scan = cf.circle.ScanRecord(fs=100.0, velocity=np.arange(50.0), angle=turning(1.0, 100.0, 50), tones=(9.0, 11.0),
                      force=np.ones(50), card=("SYNTHETIC: x", "seed 3"))  # fmt: skip
    back = cf.circle.ScanRecord.load(scan.save(tmp_path / "scan.npz"))
    for name in ("velocity", "angle", "force"):
        assert np.array_equal(getattr(back, name), getattr(scan, name))
    assert (back.fs, back.tones, back.card) == (scan.fs, scan.tones, scan.card)
    bare = replace(scan, force=None)
    assert cf.circle.ScanRecord.load(bare.save(tmp_path / "scan.npz")).force is None


def test_files_that_are_no_scans_are_refused(tmp_path, frfs):
    path = frfs.save(tmp_path / "frfs.npz")
    with pytest.raises(cf.errors.InputError, match="an npz without angle"):
        cf.circle.ScanRecord.load(path)
    path.write_bytes(b"no zip")
    with pytest.raises(cf.errors.InputError, match="no readable npz"):
        cf.circle.ScanRecord.load(path)


def test_angles_by_node():
    assert cf.rig.rig_angles(RIG)[2] == pytest.approx(np.degrees(2.0))
