"""The terms of a modal model at some lines, against the formulas written out."""

import numpy as np
import pytest

from casingfem.experiment.identify.poles.pole_window import Window, floor_of

LINES = np.array([90.0, 94.0, 98.0, 102.0, 106.0, 110.0, 114.0])
SCALE = 102.0
ALONG = np.array([1.0, 0.5, 0.0, 0.8, 1.0, 0.3, 0.9])
F, ZETA = np.array([97.0, 105.0]), np.array([0.02, 0.05])


def window(**changes):
    data = np.arange(28.0).reshape(14, 2) - 9.0
    given = {
        "freq": LINES,
        "Y": data,
        "power": 0,
        "residues": "real",
        "weight": np.ones(2),
        "floor": 0.0,
        "along": ALONG,
    }
    return Window(**given | changes)


def resonances(freq, power):
    x, w = freq[:, None] / SCALE, F / SCALE
    return (1j * x) ** power * w**2 / (w**2 - x**2 + 2j * ZETA * w * x)


def test_the_floor_is_a_part_of_the_rms_of_an_entry():
    assert floor_of(np.array([[3.0 + 4.0j, 0.0], [1.0j, 1.0]])) == pytest.approx(3e-4 * np.sqrt(27.0 / 8.0), rel=1e-12)


def test_numbers_of_a_window():
    real, both = window(), window(residues="complex")
    assert (real.columns, both.columns) == (1, 2)
    assert real.scale == pytest.approx(SCALE)
    assert real.entries == 2 * 2 * 6
    assert real.as_complex[1, 0] == pytest.approx(real.Y[1, 0] + 1j * real.Y[8, 0])
    assert real.as_complex.shape == (7, 2)
    with pytest.raises(ValueError, match="read-only"):
        real.Y[0, 0] = 1.0
    assert real.leak == 0.0


def test_some_of_the_lines():
    part = window().cut(slice(1, 6, 2))
    assert part.freq.tolist() == [94.0, 102.0, 110.0]
    assert part.along.tolist() == [0.5, 0.8, 0.3]
    assert part.Y.tolist() == window().Y[[1, 3, 5, 8, 10, 12]].tolist()
    assert window().cut(LINES > 106.0).freq.tolist() == [110.0, 114.0]


@pytest.mark.parametrize("power", [0, 1, 2])
@pytest.mark.parametrize(
    ("leak", "lines"), [(0.0, slice(None)), (4.0, slice(None)), (2.0, slice(None)), (4.0, [0, 1, 3, 4, 6])]
)
def test_resonances_leak_to_the_lines_beside_by_a_sixth(power, leak, lines):
    seen = window(power=power, leak=leak, freq=LINES[lines], along=ALONG[lines], Y=np.zeros((2 * len(LINES[lines]), 2)))
    freq, ratio = seen.freq, seen.freq.mean() / SCALE

    def values(by):
        return resonances(freq + by, power) / ratio**power  # x is in units of the mean of the lines

    want = (4.0 * values(0.0) + values(-leak) + values(leak)) / 6.0 * seen.along[:, None]
    np.testing.assert_allclose(seen.values(F, ZETA), want, rtol=1e-12)
    np.testing.assert_allclose(seen.peaks(F, ZETA)[0], want, rtol=1e-12)
    places, apart = seen.places()
    assert apart == (0 if not leak else 1 if leak == 4.0 and len(freq) == 7 else len(freq))
    assert len(places) == len(freq) * (1 if not leak else 3) if apart != 1 else 9


@pytest.mark.parametrize("residues", ["real", "complex"])
def test_columns_of_resonances_and_their_slopes(residues):
    seen = window(power=1, residues=residues)
    plain = resonances(LINES, 1) * ALONG[:, None]
    x, w = LINES[:, None] / SCALE, F / SCALE
    below = w**2 - x**2 + 2j * ZETA * w * x
    by_freq = plain * (2.0 - (2.0 * w**2 + 2j * ZETA * w * x) / below)
    by_zeta = -plain * 2j * ZETA * w * x / below

    def real(columns):
        if residues == "real":
            return np.vstack([columns.real, columns.imag])
        pairs = [part for each in columns.T for part in (each, 1j * each)]
        return np.vstack([np.real(pairs).T, np.imag(pairs).T])

    np.testing.assert_allclose(seen.resonances(F, ZETA), real(plain), rtol=1e-12)
    np.testing.assert_allclose(seen.slopes(F, ZETA), real(np.hstack([by_freq, by_zeta])), rtol=1e-11)
    t = (2.0 * LINES - 204.0) / 24.0
    terms = np.column_stack([t**0, t, 2.0 * t**2 - 1.0, 4.0 * t**3 - 3.0 * t])
    polynomials = (ALONG * 1j * LINES / SCALE)[:, None] * terms
    np.testing.assert_allclose(seen.polynomials(), polynomials, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(seen.residuals(), real(polynomials), rtol=1e-12, atol=1e-14)
    columns = seen.as_columns(plain)
    np.testing.assert_array_equal(columns, plain if residues == "complex" else real(plain))
