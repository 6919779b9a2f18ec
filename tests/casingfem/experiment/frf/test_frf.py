"""Sets of measured functions: three formats in, the same numbers out, and what does not belong together refused."""

from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf


@pytest.fixture
def three() -> cf.frf.FrfSet:
    rng = np.random.default_rng(311)
    return cf.frf.FrfSet.from_arrays(
        kind="frf",
        x=100.0 + 0.25 * np.arange(33),
        responses=rng.normal(size=(3, 33)) + 1j * rng.normal(size=(3, 33)),
        response_point=[1, 2, 2],
        response_direction=[3, 1, -3],
        reference_point=7,
        reference_direction=3,
        unit="(m/s^2)/N",
        card=("MEASURED: a test of the test",),
    )


def same(left: cf.frf.FrfSet, right: cf.frf.FrfSet) -> bool:
    names = ("x", "responses", "response_point", "response_direction", "reference_point", "reference_direction")
    arrays = all(np.array_equal(getattr(left, name), getattr(right, name)) for name in names)
    return arrays and (left.kind, left.unit) == (right.kind, right.unit)


def test_three_formats_keep_every_bit(three, tmp_path):
    assert same(cf.frf.FrfSet.from_csv(three.to_csv(tmp_path / "f.csv")), three)
    assert same(cf.frf.FrfSet.load(three.save(tmp_path / "f.npz")), three)
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=three.functions(), binary=True)
    assert same(cf.frf.FrfSet.from_uff(path), three)
    assert cf.frf.FrfSet.load(tmp_path / "f.npz").card == three.card
    again = cf.frf.FrfSet.from_csv(cf.frf.FrfSet.from_csv(tmp_path / "f.csv").to_csv(tmp_path / "g.csv"))
    assert again.card == (*three.card, "unit: (m/s^2)/N", "kind: frf")  # each once, also when written twice
    assert not three.responses.flags.writeable


def test_missing_numbers_go_through_every_format(three, tmp_path):
    holes = three.responses.copy()
    holes[1, [0, 7, 8]] = np.nan
    given = replace(three, responses=holes)
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=given.functions(), binary=True)
    for read in (
        cf.frf.FrfSet.from_csv(given.to_csv(tmp_path / "f.csv")),
        cf.frf.FrfSet.load(given.save(tmp_path / "f.npz")),
        cf.frf.FrfSet.from_uff(path),
    ):
        np.testing.assert_array_equal(read.responses, holes)


def test_coherence_is_beside_the_responses_of_a_universal_file(three, tmp_path):
    gamma2 = replace(three, kind="spectrum", responses=np.full((3, 33), 0.9), unit="")
    functions = [replace(each, kind=6, values=each.values.real) for each in gamma2.functions()]
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=[*three.functions(), *functions], binary=True)
    assert same(cf.frf.FrfSet.from_uff(path), three)
    assert same(cf.frf.read_coherence(path), gamma2)
    assert same(cf.frf.read_coherence(gamma2.save(tmp_path / "c.npz")), gamma2)
    assert cf.frf.read_coherence(cf.uff.write_uff(tmp_path / "g.uff", functions=three.functions())) is None
    with pytest.raises(cf.errors.InputError, match=r"ending '\.csv'"):
        cf.frf.read_coherence(tmp_path / "f.csv")


@pytest.mark.parametrize("kind", ["time", "spectrum"])
def test_time_records_and_spectra_too(kind, three, tmp_path):
    values = three.responses.real if kind == "time" else three.responses
    given = replace(three, kind=kind, responses=values, unit="Pa")
    assert same(cf.frf.FrfSet.from_csv(given.to_csv(tmp_path / "f.csv")), given)
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=given.functions(), binary=True)
    assert same(cf.frf.FrfSet.from_uff(path, kind), given)
    assert ("time_s" in (tmp_path / "f.csv").read_text()) == (kind == "time")
    with pytest.raises(cf.errors.InputError, match="expected functions of kind 'frf': divide the cross spectrum"):
        cf.frf.FrfSet.from_uff(path)
    nodes = cf.uff.Nodes(
        labels=np.array([1, 2]), points=np.eye(2, 3), systems=np.zeros(2, int), motions=np.zeros(2, int)
    )
    with pytest.raises(
        cf.errors.InputError, match=r"found no functions, but 2 nodes; expected functions of kind '\w+'$"
    ):
        cf.frf.FrfSet.from_uff(cf.uff.write_uff(tmp_path / "g.uff", nodes=nodes), kind)


def test_uneven_abscissas_keep_their_bits(three, tmp_path):
    given = replace(three, x=np.sort(np.random.default_rng(5).uniform(1.0, 2.0, 33)))
    path = cf.uff.write_uff(tmp_path / "f.uff", functions=given.functions(), binary=True)
    assert same(cf.frf.FrfSet.from_uff(path), given)


def test_functions_that_do_not_belong_together_are_refused(three):
    first, second, _ = three.functions()
    ordinate = second.axes.ordinate._replace(unit="m/s")
    for odd, words in (
        (replace(second, x=second.x + 1.0), "function 2 over other abscissas"),
        (replace(second, axes=second.axes._replace(ordinate=ordinate)), "function 2 in 'm/s'"),
        (replace(second, axes=second.axes._replace(abscissa=ordinate)), "expected frequency in Hz"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.FrfSet.from_functions([first, odd], "frf")


CSV = (
    "# unit: m/N\nfreq_hz,response_point,response_direction,reference_point,reference_direction,real,imag\n"
    "10,1,3,1,3,0.5,0\n20,1,3,1,3,0.6,0\n10,2,3,1,3,0.5,1\n20,2,3,1,3,0.6,2\n"
)


def test_places_have_their_radius_and_none_below_0(tmp_path):
    file = tmp_path / "angles.csv"
    file.write_text("point,angle_deg,radius_m,z_m\n4,90,0.5,0.1\n7,30,0,0.2\n")
    angles, places = cf.frf.read_places(file)
    assert angles == {4: 90.0, 7: 30.0}
    np.testing.assert_allclose([places[4], places[7]], [[0.0, 0.5, 0.1], [0.0, 0.0, 0.2]], atol=1e-16)
    file.write_text("point,angle_deg,radius_m,z_m\n4,90,0.5,0.1\n7,30,-1e-9,0.2\n")
    with pytest.raises(
        cf.errors.InputError, match=r"angles\.csv, line 3, column 'radius_m': found -1e-09; expected 0 or more"
    ):
        cf.frf.read_places(file)


def test_a_table_written_by_hand(tmp_path):
    (tmp_path / "f.csv").write_text(CSV)
    found = cf.frf.FrfSet.from_csv(tmp_path / "f.csv")
    assert found.responses.tolist() == [[0.5, 0.6], [0.5 + 1j, 0.6 + 2j]]
    assert found.response_point.tolist() == [1, 2]
    assert repr(found) == "FrfSet(frf, 2 channels, 2 lines, 10 to 20 Hz, m/N)"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("# unit: m/N\n", "", "no card line 'unit"),
        ("# unit", "# kind: thing\n# unit", "kind 'thing'"),
        ("imag\n", "imaginary\n", "line 2, column 'imaginary': found an unknown column"),
        ("20,2,3,1,3,0.6,2\n", "", "line 5: found 1 rows of a channel over other abscissas"),
        ("20,2,3,1,3,0.6,2", "21,2,3,1,3,0.6,2", "over other abscissas"),
        ("20,", "5,", "5 after 10"),
        ("0.6,2", "nan,2", "found 'nan'; expected a finite number such as .*, or an empty cell where there is none"),
        ("10,1,3", "10,1.5,3", "whole number"),
    ],
)
def test_broken_tables_are_refused(old, new, words, tmp_path):
    assert old in CSV
    (tmp_path / "f.csv").write_text(CSV.replace(old, new))
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.FrfSet.from_csv(tmp_path / "f.csv")


def test_arrays_that_do_not_fit_are_refused(three):
    for change, words in (
        ({"x": three.x[:-1]}, "x \\(32,\\)"),
        ({"reference_point": np.array([1])}, "reference_point \\(1,\\)"),
        ({"responses": three.responses * np.inf}, "nan"),
        ({"kind": "time"}, "complex time record"),
        ({"kind": "other"}, "kind 'other'"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            replace(three, **change)
