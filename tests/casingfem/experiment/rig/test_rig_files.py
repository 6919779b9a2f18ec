"""Files of the test rig: what is written is what is read, and is marked SYNTHETIC."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf

ANGLES = (0.0, 2.0, 4.0)
PROBES = [cf.rig.Probe(k + 1, 1, (float(np.cos(a)), float(np.sin(a)), 0.25), a) for k, a in enumerate(ANGLES)]
RIG = cf.rig.Rig.of(omega=[600.0, 700.0], zeta=0.01, rows=[[1.0, 0.3], [0.2, -0.4], [0.6, 0.1]], probes=PROBES)


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


def test_scans_come_back(tmp_path):
    scan = cf.circle.ScanRecord(
        fs=100.0,
        velocity=np.arange(50.0),
        angle=cf.circle.turning(1.0, 100.0, 50),
        tones=(9.0, 11.0),
        force=np.ones(50),
        card=("SYNTHETIC: x", "seed 3"),
    )
    back = cf.circle.ScanRecord.load(scan.save(tmp_path / "scan.npz"))
    for name in ("velocity", "angle", "force"):
        assert np.array_equal(getattr(back, name), getattr(scan, name))
    assert (back.fs, back.tones, back.card) == (scan.fs, scan.tones, scan.card)
    bare = replace(scan, force=None)
    assert cf.circle.ScanRecord.load(bare.save(tmp_path / "scan.npz")).force is None


def test_angles_by_node():
    assert cf.rig.rig_angles(RIG)[2] == pytest.approx(np.degrees(2.0))
