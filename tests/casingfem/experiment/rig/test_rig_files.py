"""Files of the test rig: what is written is what is read, and says SYNTHETIC."""

from dataclasses import replace

import numpy as np
import pytest

from casingfem.errors import InputError
from casingfem.experiment.circle.record import ScanRecord, turning
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.experiment.rig.excitation import Random
from casingfem.experiment.rig.files import origin, rig_angles, write_rig_uff
from casingfem.experiment.rig.record import record
from casingfem.experiment.rig.rig import Probe, Rig, noisy
from casingfem.experiment.uff.read import read_uff

ANGLES = (0.0, 2.0, 4.0)
PROBES = [Probe(k + 1, 1, (float(np.cos(a)), float(np.sin(a)), 0.25), a) for k, a in enumerate(ANGLES)]
RIG = Rig.of(omega=[600.0, 700.0], zeta=0.01, rows=[[1.0, 0.3], [0.2, -0.4], [0.6, 0.1]], probes=PROBES)


@pytest.fixture
def frfs():
    clean = RIG.frfs(np.arange(80.0, 120.0, 0.5), sensors=[1, 2], drives=[0], card=origin(RIG, "study: x"))
    return noisy(clean, 40.0, seed=818)


def test_universal_files_give_back_functions_geometry_and_card(frfs, tmp_path):
    path = write_rig_uff(tmp_path / "rig.uff", RIG, [frfs])
    back, file = FrfSet.from_uff(path), read_uff(path)
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
    test = record(RIG, [Random(rms=1.0, band=(50.0, 150.0))], drives=[0], sensors=[1, 2], fs=512.0, block=256, blocks=2,
                  seed=5)  # fmt: skip
    responses, forces = test.functions()
    path = write_rig_uff(tmp_path / "time.uff", RIG, [responses])
    back = FrfSet.from_uff(path, "time")
    assert np.array_equal(back.responses, test.response)
    assert (back.unit, forces.unit) == ("m/s^2", "N")
    assert forces.response_point.tolist() == [1]


def test_the_card_names_seed_versions_and_hash(frfs):
    card = "\n".join(frfs.card)
    assert frfs.card[0].startswith("SYNTHETIC")
    for words in ("seed 818", "versions: casingfem", "rig: sha256", "study: x"):
        assert words in card
    other = Rig.of(omega=[600.0, 700.1], zeta=0.01, rows=RIG.rows)
    assert origin(RIG)[1] != origin(other)[1]


def test_measured_functions_are_not_the_rigs(frfs, tmp_path):
    with pytest.raises(ValueError, match="does not say SYNTHETIC"):
        write_rig_uff(tmp_path / "rig.uff", RIG, [replace(frfs, card=("measured by hand",))])


def test_scans_come_back(tmp_path):
    scan = ScanRecord(fs=100.0, velocity=np.arange(50.0), angle=turning(1.0, 100.0, 50), tones=(9.0, 11.0),
                      force=np.ones(50), card=("SYNTHETIC: x", "seed 3"))  # fmt: skip
    back = ScanRecord.load(scan.save(tmp_path / "scan.npz"))
    for name in ("velocity", "angle", "force"):
        assert np.array_equal(getattr(back, name), getattr(scan, name))
    assert (back.fs, back.tones, back.card) == (scan.fs, scan.tones, scan.card)
    bare = replace(scan, force=None)
    assert ScanRecord.load(bare.save(tmp_path / "scan.npz")).force is None


def test_files_that_are_no_scans_are_refused(tmp_path, frfs):
    path = frfs.save(tmp_path / "frfs.npz")
    with pytest.raises(InputError, match="an npz without angle"):
        ScanRecord.load(path)
    path.write_bytes(b"no zip")
    with pytest.raises(InputError, match="no readable npz"):
        ScanRecord.load(path)


def test_angles_by_node():
    assert rig_angles(RIG)[2] == pytest.approx(np.degrees(2.0))
