"""The report of public sets: peaks are found or missed by the modes, missing sets are named with where to get them."""

import numpy as np
import pytest

from reports.verification.updating.public_sets import SETS, main, readings

LINES = np.arange(1000.0)  # Hz
SEEN = np.array([51.5, 142.2, 278.7, 460.4, 687.2, 958.5])


def beam(folder, freqs):
    """Three SYNTHETIC accelerances in the text files of the first set."""
    place = folder / "ladisk" / "pyuff" / "data"
    place.mkdir(parents=True)
    s, omega = 2j * np.pi * LINES, 2.0 * np.pi * np.asarray(freqs)
    noise = np.random.default_rng(4).standard_normal((3, 2, len(LINES)))
    for point in range(3):
        residues = np.cos(0.7 + (point + 1.0) * np.arange(1.0, len(omega) + 1.0))
        modes = [a * s**2 / (s**2 + 0.02 * w * s + w**2) for a, w in zip(residues, omega, strict=True)]
        H = sum(modes) + 1e-3 * (noise[point, 0] + 1j * noise[point, 1])
        np.savetxt(place / f"meas_point_{point + 1}.txt", H)


@pytest.mark.slow
def test_a_peak_without_a_mode_is_missed_and_missing_sets_are_named(tmp_path, capsys):
    beam(tmp_path, np.delete(SEEN, 2))
    (row,) = main(tmp_path / "out", folder=tmp_path)
    assert (row["set"], row["seen"], row["sure"], row["missed"], row["other sure"]) == ("beam", 6, 5, 1, 0)
    printed = capsys.readouterr().out
    for each in SETS[1:]:
        assert f"git clone https://github.com/{each.repository} " in printed
    assert "278.7" in next(line for line in printed.splitlines() if line.endswith("-") and "missed" in line)


def test_every_public_set_has_readings_of_its_peaks():
    seen = readings()
    assert set(seen) == {each.name for each in SETS}
    assert all(peak.within > 0.0 for peaks in seen.values() for peak in peaks)
