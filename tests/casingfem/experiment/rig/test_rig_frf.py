"""Frequency responses of the virtual test rig: one degree of freedom, the full model, what is left out, noise."""

import numpy as np
import pytest

import casingfem as cf

SEED = 20611


def test_one_degree_of_freedom_answers_as_its_equation_states():
    m, k, zeta = 2.5, 4e6, 0.02
    omega = np.sqrt(k / m)
    rig = cf.rig.Rig.of(omega=[omega], zeta=[zeta], rows=[[1.0 / np.sqrt(m)]])
    freq = np.linspace(10.0, 500.0, 40)
    w = 2.0 * np.pi * freq
    exact = 1.0 / (k - m * w**2 + 1j * w * 2.0 * zeta * np.sqrt(k * m))
    for quantity, power in (("receptance", 0), ("mobility", 1), ("accelerance", 2)):
        got = rig.frfs(freq, sensors=[0], drives=[0], quantity=quantity).responses[0]
        np.testing.assert_allclose(got, exact * (1j * w) ** power, rtol=1e-12)


@pytest.fixture(scope="module")
def casing(coarse, frustum):
    return cf.modes(frustum(mesh=coarse, radius_defect=cf.FourierField.of({8: 0.001})), 60, method="shell")


def test_static_answer_is_that_of_the_whole_model_however_few_the_modes(casing):
    system = cf.shell.assemble(casing.shell)
    rig = cf.rig.rig_of(casing, [cf.rig.Place(at=(0.25, 0.3)), cf.rig.Place(at=(0.2, 1.1))], zeta=0.002, system=system)
    c, s = np.cos(0.3), np.sin(0.3)
    pushed = cf.shell.solve_static(casing.shell, [cf.loads.PointLoad(at=(0.25, 0.3), force=(c, s, 0.0))], system=system)
    at = pushed.at(0.2, 1.1) @ [np.cos(1.1), np.sin(1.1), 0.0]
    assert rig.receptance([1], [0], [0.0])[0, 0, 0] == pytest.approx(at, rel=1e-8)
    without = cf.rig.Rig.of(omega=rig.omega, zeta=rig.zeta, rows=rig.rows)
    assert abs(without.receptance([1], [0], [0.0])[0, 0, 0] / at - 1.0) > 0.01


@pytest.mark.slow
def test_what_is_left_out_is_made_good_below_the_last_mode(casing, coarse):
    few = cf.modes(casing.shell, 24, method="shell")
    places = [cf.rig.Place(at=(0.25, 0.3)), *cf.rig.circle(0.25, 4)]
    full, cut = (cf.rig.rig_of(m, places, zeta=0.002) for m in (casing, few))
    bare = cf.rig.Rig.of(omega=cut.omega, zeta=cut.zeta, rows=cut.rows)
    freq = np.linspace(0.2, 0.6, 50) * few.freq[-1]
    H, with_S, without = (r.receptance([1, 2, 3, 4], [0], freq) for r in (full, cut, bare))
    error, blind = (np.linalg.norm(x - H) / np.linalg.norm(H) for x in (with_S, without))
    assert error < 0.02
    assert blind > 4.0 * error


def test_directions_have_their_numbers(casing):
    at = (0.25, np.pi / 2)
    rig = cf.rig.rig_of(
        casing, [cf.rig.Place(at=at, direction=d) for d in ("radial", "hoop", "axial", "x", "y")], zeta=0.002
    )
    assert [p.direction for p in rig.probes] == [1, 2, 3, 0, 0]
    assert {p.node for p in rig.probes} == {1}
    np.testing.assert_allclose(rig.rows[0], rig.rows[4], atol=1e-12)
    np.testing.assert_allclose(rig.rows[1], -rig.rows[3], atol=1e-12)


@pytest.mark.slow
def test_the_normal_of_a_cone_points_into_it(coarse, frustum):
    """Along the axis times around: where it is narrower above, in and down, as height to difference of radii."""
    modes = cf.modes(frustum(mesh=coarse), 8, method="shell")
    chart, places = modes.shell.chart, [cf.rig.Place(at=(0.1, 0.7), direction=d) for d in ("radial", "axial", "normal")]
    rig = cf.rig.rig_of(modes, places, zeta=0.002)
    slope = np.array([chart.height, chart.r_base - chart.r_top])
    exact = -slope @ rig.rows[:2] / np.linalg.norm(slope)
    np.testing.assert_allclose(rig.rows[2], exact, atol=1e-12 * np.abs(exact).max())
    assert rig.probes[2].direction == 0


def test_channels_have_the_directions_of_their_own_probes():
    probes = [
        cf.rig.Probe(7, 1, (0.0, 0.0, 0.0), 0.0),
        cf.rig.Probe(8, -2, (0.0, 0.0, 0.0), 0.0),
        cf.rig.Probe(9, 3, (0.0, 0.0, 0.0), 0.0),
    ]
    S = 1e-6 * np.array([[3.0, 1.0, 2.0], [1.0, 4.0, 0.5], [2.0, 0.5, 5.0]])
    rig = cf.rig.Rig.of(omega=[9.0], zeta=0.01, rows=[[1.0], [2.0], [3.0]], S=S, probes=probes)
    frfs = rig.frfs([1.0], sensors=[2, 0], drives=[1])
    assert frfs.response_direction.tolist() == [3, 1]
    assert frfs.reference_direction.tolist() == [-2, -2]
    some = rig.taking([2, 0])
    assert [p.node for p in some.probes] == [9, 7]
    np.testing.assert_allclose(some.receptance([0], [1], [1.0]), rig.receptance([2], [0], [1.0]), rtol=1e-12)


def test_a_converter_errs_by_a_twelfth_of_its_step_squared():
    rng = np.random.default_rng(SEED)
    values = rng.normal(0.0, 1.0, 200_000)
    adc = cf.rig.Converter(bits=12, full_scale=8.0)
    error = adc.convert(values) - values
    assert np.mean(error**2) == pytest.approx(adc.lsb**2 / 12.0, rel=0.01)
    narrow = cf.rig.Converter(bits=12, full_scale=1.0).convert(values)
    assert (narrow.min(), narrow.max()) == (-1.0, 1.0 - 1.0 / 2048)


def test_a_circle_has_at_least_one_place():
    assert cf.rig.circle(0.25, 1, first_angle=0.3) == [cf.rig.Place(at=(0.25, 0.3))]
    with pytest.raises(cf.errors.InputError, match="count: found 0, expected at least one place"):
        cf.rig.circle(0.25, 0)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"omega": [0.0]}, "above 0"),
        ({"omega": [9.0, 8.0], "rows": [[1.0, 1.0]]}, "ascending"),
        ({"omega": [-1.0]}, "above 0"),
        ({"omega": [], "rows": [[]]}, "at least one frequency"),
        ({"omega": [np.inf]}, "omega: found nan or infinity"),
        ({"zeta": [2.0]}, "zeta: found 2, expected damping ratios from 1e-09 to below 1, not per cent"),
        ({"zeta": [1.0]}, "zeta: found 1, expected damping ratios"),
        ({"zeta": [0.0]}, "zeta: found 0, expected damping ratios"),
        ({"omega": [9.0, 9.5], "zeta": [0.5, -0.1], "rows": [[1.0, 1.0]]}, "zeta: found -0.1, expected damping ratios"),
        ({"S": [[np.nan]]}, "S: found nan or infinity, expected finite numbers of shape"),
        ({"rows": [[1.0, 2.0]]}, r"shape \(1, 2\), expected finite numbers of shape \(1, 1\)"),
        ({"rows": [[np.nan]]}, "nan or infinity"),
        ({"rows": [1.0]}, r"expected \(probes, modes\)"),
        ({"S": [[1.0, 0.0]]}, "S: found shape"),
    ],
)
def test_a_rig_that_cannot_be_is_refused(arrays, words):
    with pytest.raises(cf.errors.InputError, match=words):
        cf.rig.Rig.of(**({"omega": [9.0], "zeta": 0.01, "rows": [[1.0]]} | arrays))


def test_a_rig_has_frequencies_in_hz_and_may_have_two_alike():
    rig = cf.rig.Rig.of(omega=[9.0, 9.0], zeta=0.01, rows=[[1.0, 1.0]])
    np.testing.assert_allclose(rig.freq, [9.0 / (2.0 * np.pi)] * 2, rtol=1e-15)
    assert (len(rig), rig.S.tolist(), rig.probes) == (2, [[0.0]], (cf.rig.Probe(1, 0, (0.0, 0.0, 0.0), 0.0),))
    assert not rig.rows.flags.writeable


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: cf.rig.Place(at=(0.1, 0.2), mass=-1e-3), "mass: found -0.001 kg, expected 0 or more"),
        (
            lambda: cf.rig.Place(at=(0.1, 0.2), direction="up"),
            "direction: found 'up', expected one of radial, hoop, axial, x, y, z, normal",
        ),
    ],
)
def test_a_place_that_cannot_be_is_refused(made, words):
    assert cf.rig.Place(at=(0.1, 0.2), mass=0.0).mass == 0.0
    with pytest.raises(cf.errors.InputError, match=words):
        made()


def test_a_loose_body_is_refused(frustum, coarse):
    loose = cf.modes(frustum(mesh=coarse, supports={}), 8, method="shell")
    with pytest.raises(cf.errors.InputError, match="6 rigid motions"):
        cf.rig.rig_of(loose, [cf.rig.Place(at=(0.25, 0.0))], zeta=0.002)
