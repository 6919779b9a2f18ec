"""Parts of the evaluation of circles against what they say: orders distinguished, labels, lines, noise."""

import numpy as np
import pytest

import casingfem as cf


def test_a_record_comes_back_with_or_without_force(tmp_path):
    for force in (None, [4.0, 5.0, 6.0]):
        given = cf.circle.ScanRecord(
            fs=8.0, velocity=[1.0, 2.0, 3.5], angle=[0.5, 0.75, 1.25], tones=(3.0, 4.0), force=force, card=("a", "b")
        )
        found = cf.circle.ScanRecord.load(given.save(tmp_path / "scan.npz"))
        assert (found.fs, found.tones, found.card) == (8.0, (3.0, 4.0), ("a", "b"))
        assert found.velocity.tolist() == [1.0, 2.0, 3.5]
        assert found.angle.tolist() == [0.5, 0.75, 1.25]
        assert (found.force is None) if force is None else (found.force.tolist() == force)
        assert found.seconds == 0.375
        assert not given.velocity.flags.writeable
        assert found.rate == pytest.approx(0.75 / (2.0 * np.pi * 2.0) * 8.0, rel=1e-14)


def test_a_tacho_spans_the_record_and_has_two_pulses():
    np.testing.assert_allclose(cf.circle.from_tacho([0.0, 2.0], 2.0, 5), np.pi * np.array([0.0, 0.5, 1.0, 1.5, 2.0]))
    for pulses, words in (([0.1, 2.0], "from 0.1 to 2 s, expected them to span the record, 0 to 2 s"),
                          ([0.0, 1.9], "from 0 to 1.9 s"), ([0.0], "two pulses or more"), ([0.0, np.nan], "two pulses"),
                          ([[0.0, 2.0]], "two pulses")):  # fmt: skip
        with pytest.raises(cf.errors.InputError, match=words):
            cf.circle.from_tacho(pulses, 2.0, 5)
