"""Universal files as other programs write them: wrong byte counts, no last mark, codes in place of units."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import casingfem as cf
from casingfem.cli import main
from reports.verification.robustness.uff_samples import function
from tests.casingfem.experiment.uff.test_uff_split import parse_uff

pyuff = pytest.importorskip("pyuff")

LINES = np.arange(0.0, 200.0, 0.5)
ACCEPTED = "ignore:.*(uff-bytes|uff-end):casingfem.errors.ModelWarning"


def receptance(*modes):
    """Sum of residue/(w0^2 - w^2 + 2 j zeta w0 w) over (frequency [Hz], residue), zeta 1 %."""
    omega = 2.0 * np.pi * LINES
    parts = [(2.0 * np.pi * freq, residue) for freq, residue in modes]
    return sum(residue / (w0**2 - omega**2 + 0.02j * w0 * omega) for w0, residue in parts)


def theirs(path, values, *, binary, even=True, ordinate=8, denominator=13, unit="NONE", **more):
    """A file of pyuff: one function for each row of `values`."""
    x = LINES if even else LINES + 0.01 * np.sin(LINES)
    path.write_bytes(b"")  # in its mode "overwrite" it loses a binary function
    for channel, row in enumerate(values, 1):
        one = pyuff.prepare_58(
            binary=binary, func_type=4, rsp_node=channel, rsp_dir=3, ref_node=1, ref_dir=3, data=row, x=x,
            abscissa_spacing=int(even), abscissa_spec_data_type=18, ordinate_spec_data_type=ordinate,
            orddenom_spec_data_type=denominator, ordinate_axis_units_lab=unit, load_case_id=0, z_axis_value=0.0, **more,
        )  # fmt: skip
        add(path, one)
    return path


def add(path, one, **options):
    """Write one more set; pyuff does not close its files."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        pyuff.UFF(str(path)).write_sets(one, "add", **options)


@pytest.mark.slow
@pytest.mark.filterwarnings(ACCEPTED)
@pytest.mark.parametrize("binary", [0, 1])
def test_modes_of_a_file_of_pyuff_are_those_of_its_functions(binary, tmp_path):
    """Text or bytes, units NONE: the codes 8 over 13 make it a receptance."""
    H = receptance((12.0, 1.0), (90.0, 0.01))
    file = theirs(tmp_path / "theirs.uff", [H, 0.5 * H], binary=binary)
    done = CliRunner().invoke(main, ["identify", str(file), "--open", "--json"])
    assert done.exit_code == 0, done.output
    found = cf.identify(cf.frf.FrfSet.from_uff(file))
    np.testing.assert_allclose(found.freq, [12.0, 90.0], rtol=1e-5)
    assert (np.abs(found.zeta - 0.01) < 3.0 * found.sigma_zeta).all()
    assert found.sigma_zeta.max() < 5e-5
    assert not any("no unit" in note for note in found.notes)


@pytest.mark.filterwarnings(ACCEPTED)
@pytest.mark.parametrize("double", [True, False])
@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("is_complex", [True, False])
@pytest.mark.parametrize("binary", [0, 1])
def test_every_type_that_pyuff_writes_is_read(binary, is_complex, even, double, tmp_path):
    """It writes 8 bytes a number whatever type it states, and counts half of those of complex ones."""
    values = receptance((60.0, 1.0)) if is_complex else receptance((60.0, 1.0)).real
    file = tmp_path / "theirs.uff"
    one = pyuff.prepare_58(
        binary=binary, func_type=4, rsp_node=3, rsp_dir=-2, ref_node=1, ref_dir=3, data=values, x=LINES,
        abscissa_spacing=int(even), ord_data_type=5 if is_complex else 2, z_axis_value=0.0, load_case_id=0,
        orddenom_spec_data_type=13,
    )  # fmt: skip
    file.write_bytes(b"")
    add(file, one, force_double=double)
    (found,) = cf.uff.read_uff(file).functions
    np.testing.assert_allclose(found.values, values, rtol=1e-11 if double or binary else 5e-6)
    np.testing.assert_allclose(found.x, LINES, rtol=5e-6)
    assert found.double == (double or bool(binary))


def test_a_wrong_number_of_bytes_is_named_beside_the_right_one(tmp_path):
    file = theirs(tmp_path / "theirs.uff", np.tile(receptance((60.0, 1.0)), (3, 1)), binary=1)
    words = r"set 58b .*found 6400 bytes of data, expected 3200 as line 2 states, and 2 more such sets; .*\[uff-bytes\]"
    with pytest.warns(cf.errors.ModelWarning, match=words) as caught:
        cf.uff.read_uff(file)
    assert len(caught) == 1


def test_a_set_that_is_empty_is_named_and_the_others_are_read(tmp_path):
    """As pyuff leaves it where a binary function is written in its mode "overwrite"."""
    data = cf.uff.write_uff(
        tmp_path / "f.uff", functions=[function(even=True, is_complex=True, double=True)]
    ).read_bytes()
    for given, words in (
        (b"    -1\n" + data, "line 1, before the first set: found -1 and no set below it"),
        (data + b"    -1\n", r"line \d+, after set 58 \(functions\): found -1 and no set"),
    ):
        with pytest.warns(cf.errors.ModelWarning, match=words + r".*\[uff-empty\]"):
            assert len(parse_uff(given, "f.uff").functions) == 1


@pytest.mark.parametrize("binary", [True, False])
def test_a_function_without_a_last_mark_is_whole_or_refused(binary, tmp_path):
    """Wherever the file is cut: its numbers are all there, or it is refused."""
    given = function(even=True, is_complex=True, double=True)
    whole = cf.uff.write_uff(tmp_path / "f.uff", functions=[given, given], binary=binary).read_bytes()
    read, end = 0, len(whole.rstrip()) - 2
    for cut in range(end - 60, end):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                found = parse_uff(whole[:cut], "f.uff").functions
            except cf.errors.InputError:
                continue
        read += 1
        assert len(found) == 2
        np.testing.assert_allclose(found[1].values, given.values, rtol=1e-12)
        assert re.search(r"found the end of the file, expected -1; .*\[uff-end\]", str(caught[-1].message))
    assert read >= 1


@pytest.mark.parametrize(
    ("codes", "unit", "form"),
    [
        ((8, 13), "NONE", "receptance"), ((11, 13), "NONE", "mobility"), ((12, 13), "", "accelerance"),
        ((12, 0), "NONE", "accelerance"), ((0, 13), "NONE", ""), ((1, 0), "NONE", ""), ((12, 13), "g", "accelerance"),
    ],
)  # fmt: skip
def test_codes_state_the_form_and_files_keep_it(codes, unit, form, tmp_path):
    given = function(even=True, is_complex=True, double=True)
    axes = given.axes._replace(ordinate=cf.uff.Axis(codes[0], unit=unit), denominator=cf.uff.Axis(codes[1]))
    frfs = cf.frf.FrfSet.from_functions([replace(given, kind=4, axes=axes)], "frf")
    assert frfs.form == form
    assert cf.frf.FrfSet.load(frfs.save(tmp_path / "f.npz")).form == form
    assert cf.frf.FrfSet.from_csv(frfs.to_csv(tmp_path / "f.csv")).form == form


@pytest.mark.parametrize(
    ("codes", "unit", "words"),
    [
        ((3, 13), "NONE", "found unit 'strain/excitation force'; expected one such as"),
        ((12, 12), "NONE", "found unit 'acceleration/acceleration'; expected one such as"),
        ((99, 0), "NONE", "found unit 'code 99'; expected one such as"),
        ((8, 13), "m/s^2", "found unit 'm/s^2', which is of accelerance, in a file that states receptance; expected"),
    ],
)
def test_codes_of_other_quantities_and_codes_against_the_unit_need_a_form(codes, unit, words):
    frfs = several(codes, unit)
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        cf.identify(frfs)
    assert cf.identify(frfs, form="receptance").freq[0] == pytest.approx(60.0, rel=1e-5)


def several(codes, unit):
    given = function(even=True, is_complex=True, double=True)
    axes = given.axes._replace(
        abscissa=cf.uff.Axis(18), ordinate=cf.uff.Axis(codes[0], unit=unit), denominator=cf.uff.Axis(codes[1])
    )
    one = replace(given, kind=4, axes=axes, x=LINES, step=0.5, values=receptance((60.0, 1.0)))
    return cf.frf.FrfSet.from_functions([one], "frf")


def test_functions_of_two_forms_make_no_set(tmp_path):
    file = theirs(tmp_path / "a.uff", [receptance((60.0, 1.0))], binary=0, ordinate=12)
    other = theirs(tmp_path / "b.uff", [receptance((60.0, 1.0))], binary=0, ordinate=8)
    file.write_bytes(file.read_bytes() + other.read_bytes())
    words = "found function 2 of code 8 (receptance); expected 12 (accelerance) as the first"
    with pytest.raises(cf.errors.InputError, match=re.escape(words)):
        cf.frf.FrfSet.from_uff(file)
