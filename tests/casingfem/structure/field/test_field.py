"""Fields: exact derivatives, rotation, complex coefficients, sums."""

import numpy as np
import pytest

import casingfem as cf

Z, THETA = np.linspace(-0.1, 0.3, 7)[:, None], np.linspace(0.0, 6.0, 11)


def random_field(seed: int, harmonics: int = 6, degrees: int = 4) -> cf.FourierField:
    rng = np.random.default_rng(seed)
    p = rng.choice(np.arange(1, 30), harmonics, replace=False)
    cos, sin = rng.normal(size=(2, harmonics, degrees))
    return cf.FourierField(p=p, cos=cos, sin=sin, z_mid=0.1, z_half=0.2)


def assert_equal_fields(a: cf.field.Field, b: cf.field.Field, tolerance: float = 1e-12) -> None:
    for name, x, y in zip(cf.field.FieldValues._fields, a.derivatives(Z, THETA), b.derivatives(Z, THETA), strict=True):
        scale = max(1.0, float(np.abs(y).max()))
        np.testing.assert_allclose(x, y, rtol=0, atol=tolerance * scale, err_msg=name)


def test_value_is_the_series():
    field = random_field(7, harmonics=3, degrees=3)
    zeta = (Z - 0.1) / 0.2
    expected = sum(
        (field.cos[h, d] * np.cos(p * THETA) + field.sin[h, d] * np.sin(p * THETA)) * zeta**d
        for h, p in enumerate(field.harmonics)
        for d in range(3)
    )
    np.testing.assert_allclose(field.derivatives(Z, THETA).value, expected, atol=1e-13)


@pytest.mark.parametrize(("seed", "degrees"), [(1, 1), (2, 2), (3, 3), (4, 5)])
def test_derivatives_agree_with_central_differences(seed, degrees):
    field, h = random_field(seed, degrees=degrees), 1e-5
    f = field.derivatives(Z, THETA)
    plus_z, minus_z = field.derivatives(Z + h, THETA), field.derivatives(Z - h, THETA)
    plus_t, minus_t = field.derivatives(Z, THETA + h), field.derivatives(Z, THETA - h)

    def close(exact, plus, minus):
        np.testing.assert_allclose(exact, (plus - minus) / (2 * h), atol=3e-6 * (1 + np.abs(exact).max()))

    close(f.d_z, plus_z.value, minus_z.value)
    close(f.d_theta, plus_t.value, minus_t.value)
    close(f.d_zz, plus_z.d_z, minus_z.d_z)
    close(f.d_z_theta, plus_z.d_theta, minus_z.d_theta)
    close(f.d_z_theta, plus_t.d_z, minus_t.d_z)
    close(f.d_theta_theta, plus_t.d_theta, minus_t.d_theta)


@pytest.mark.parametrize(("seed", "angle"), [(1, 0.0), (2, 1.3), (3, -7.0), (4, 6.9)])
def test_rotation_moves_crests_forward_and_back(seed, angle):
    field = random_field(seed)
    turned = field.rotated(angle)
    for a, b in zip(turned.derivatives(Z, THETA), field.derivatives(Z, THETA - angle), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-11 * (1 + np.abs(b).max()))
    assert_equal_fields(turned.rotated(-angle), field)


def test_complex_step_through_a_coefficient_is_the_exact_sensitivity():
    field = random_field(11)
    p, step = field.harmonics[2], 1e-30
    cos, _ = field.coefficients(p)
    shape = cf.FourierField.of({p: 1.0}).derivatives(Z, THETA)
    for moved, exact in zip(field.with_harmonic(p, cos=cos + 1j * step).derivatives(Z, THETA), shape, strict=True):
        np.testing.assert_allclose(moved.imag / step, np.broadcast_to(exact, moved.shape), atol=1e-12 * p**2)
    turned = field.with_harmonic(p, cos=cos + 1j * step).rotated(0.3)
    assert turned.cos.dtype == complex
    assert turned.derivatives(0.1, p * 0.0 + 0.3).value.imag == pytest.approx(step)


def test_shapes_broadcast_from_z_and_theta():
    field = random_field(3)
    assert field.derivatives(0.1, 0.2).value.shape == ()
    assert all(x.shape == (7, 11) for x in field.derivatives(Z, THETA))
    assert field.derivatives(np.zeros((3, 1)), np.zeros((2, 1, 5))).d_zz.shape == (2, 3, 5)
    assert cf.FourierField.of({8: 0.1}).derivatives(Z, 0.0).value.shape == (7, 1)
    assert not np.any(cf.FourierField.of({}).derivatives(Z, THETA).value)


def test_with_harmonic_replaces_only_the_constant_term():
    field = random_field(5)
    p = field.harmonics[1]
    changed = field.with_harmonic(p, sin=0.25)
    assert changed.coefficients(p) == (field.coefficients(p)[0], 0.25)
    np.testing.assert_array_equal(changed.sin[:, 1:], field.sin[:, 1:])
    np.testing.assert_array_equal(changed.cos, field.cos)
    added = field.with_harmonic(31, cos=0.5)
    assert added.coefficients(31) == (0.5, 0.0)
    assert (added.z_mid, added.z_half, added.max_harmonic) == (0.1, 0.2, 31)
    assert field.coefficients(31) == (0.0, 0.0)
    assert field.amplitude(31) == 0.0


def test_sums_merge_when_they_can_and_agree_when_they_cannot():
    a, b = random_field(1), random_field(2)
    merged = a + b
    assert isinstance(merged, cf.FourierField)
    assert_equal_fields(merged, cf.field.SumField((a, b)))
    constant = cf.FourierField.of({4: 0.1, 40: (0.0, 0.2)})
    assert isinstance(constant + a, cf.FourierField)
    assert_equal_fields(constant + a, cf.field.SumField((a, constant)))
    other = cf.FourierField(p=np.array([2]), cos=np.ones((1, 2)), sin=np.ones((1, 2)), z_half=3.0)
    both = a + other
    assert isinstance(both, cf.field.SumField)
    assert isinstance(both, cf.field.Field)
    assert both.max_harmonic == max(a.max_harmonic, 2)
    assert_equal_fields(both.rotated(0.4), cf.field.SumField((a.rotated(0.4), other.rotated(0.4))))
    assert len((both + a).fields) == 3


@pytest.mark.parametrize("degrees", [2, 3])
def test_a_sum_with_a_constant_keeps_the_other_ones_scale(degrees):
    a, constant = random_field(4, degrees=degrees), cf.FourierField.of({4: 0.1, 40: (0.0, 0.2)})
    for total in (a + constant, constant + a):
        assert isinstance(total, cf.FourierField)
        assert (total.z_mid, total.z_half) == (0.1, 0.2)
        assert_equal_fields(total, cf.field.SumField((a, constant)))


@pytest.mark.parametrize("scale", [{"z_mid": 0.0, "z_half": 0.2}, {"z_mid": 0.1, "z_half": 0.3}])
def test_fields_of_another_scale_stay_apart_in_a_sum(scale):
    a, other = random_field(4), cf.FourierField(p=[2], cos=[[0.1, 0.2]], sin=[[0.3, -0.1]], **scale)
    assert isinstance(a + other, cf.field.SumField)
    expected = a.derivatives(Z, THETA).value + other.derivatives(Z, THETA).value
    np.testing.assert_allclose((a + other).derivatives(Z, THETA).value, expected, rtol=1e-13)


@pytest.mark.parametrize("which", ["cos", "sin"])
def test_a_sum_with_one_complex_part_keeps_it(which):
    stepped, real = cf.FourierField.of({3: 0.1}).with_harmonic(3, **{which: 0.1 + 1e-30j}), cf.FourierField.of({3: 0.2})
    shape = np.cos(3 * THETA) if which == "cos" else np.sin(3 * THETA)
    for total in (stepped + real, real + stepped):
        np.testing.assert_allclose(total.derivatives(0.0, THETA).value.imag / 1e-30, shape, rtol=1e-12, atol=1e-14)


def test_a_users_own_field_joins_a_sum():
    class Dent:
        def derivatives(self, z, theta):
            bump = np.exp(-np.square(theta)) + 0.0 * np.asarray(z)
            return cf.field.FieldValues(bump, 0 * bump, -2 * theta * bump, 0 * bump, 0 * bump, bump)

        def rotated(self, angle):
            raise NotImplementedError

    total = cf.FourierField.of({2: 0.1}) + Dent()
    assert total.derivatives(0.0, 0.0).value == pytest.approx(1.1)
    assert total.max_harmonic is None
    assert total.n_resolved is None


def test_a_sum_resolves_what_its_coarsest_survey_does():
    class Surveyed:
        def __init__(self, n_resolved):
            self.n_resolved = n_resolved

    assert cf.field.SumField((Surveyed(35), cf.FourierField.of({50: 0.1}), Surveyed(11))).n_resolved == 11


def test_arrays_are_read_only_and_not_shared():
    p, cos = np.array([2]), np.ones((1, 1))
    field = cf.FourierField(p=p, cos=cos, sin=np.zeros((1, 1)))
    cos[0] = 5.0
    assert field.amplitude(2) == 1.0
    with pytest.raises(ValueError, match="read-only"):
        field.cos[0, 0] = 2.0


def test_repr_names_the_largest_harmonics_first():
    text = repr(cf.FourierField.of({2: 1e-4, 8: (0.0, 0.004)}))
    assert text.splitlines()[2].split() == ["8", "4.000e-03", "11.25"]
    assert "degree 3 along z on 0.1 +- 0.2 m" in repr(random_field(1))
    assert "and 8 smaller" in repr(random_field(1, harmonics=20))
    assert repr(random_field(1, harmonics=13)).splitlines()[-1].split() == ["...", "and", "1", "smaller", "ones"]
    assert len(repr(random_field(1, harmonics=12)).splitlines()) == 14
    assert repr(cf.FourierField.of({})) == "FourierField(0 harmonics, |f| <= 0.00e+00)"


def test_repr_shows_a_bound_of_the_field_and_where_crests_are():
    title, _, *rows = repr(
        cf.FourierField.of({0: -1e-3, 1: (0.0, 2e-3), 2: (0.0, -3e-3), 5: (3e-3, 4e-3)})
    ).splitlines()
    assert title == "FourierField(4 harmonics, |f| <= 1.10e-02)"
    crests = [["5", "5.000e-03", "10.63"], ["2", "3.000e-03", "-45.00"], ["1", "2.000e-03", "90.00"]]
    assert [row.split() for row in rows] == [*crests, ["0", "1.000e-03", "180.00"]]
    steep = cf.FourierField(p=[2, 7], cos=[[0.1, 9.0], [0.2, 0.0]], sin=np.zeros((2, 2)))
    assert [row.split()[0] for row in repr(steep).splitlines()[2:]] == ["7", "2"]  # by their constant parts


def test_amplitude_and_highest_harmonic():
    assert cf.FourierField.of({4: (0.3, -0.4)}).amplitude(4) == pytest.approx(0.5, rel=1e-15)
    assert cf.FourierField.of({}).max_harmonic == 0
    assert cf.FourierField.of({10_000: 0.1}).max_harmonic == 10_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p": [-1]}, ">= 0, found -1"),
        ({"p": [1.5]}, "whole numbers"),
        ({"p": [2, 2], "cos": np.ones((2, 1)), "sin": np.ones((2, 1))}, "harmonic 2 is given twice"),
        ({"cos": [1.0]}, r"cos must have shape \(harmonics, degrees\), not \(1,\)"),
        (
            {"cos": np.ones((1, 2))},
            r"shape \(1, 2\) and sin of shape \(1, 1\), expected one row for each of",
        ),
        ({"cos": [[np.nan]]}, "cos contains values that are not finite"),
        ({"p": [0], "sin": [[0.1]]}, "use cos for the mean"),
        ({"z_half": 0.0}, "z_half = "),
        ({"z_mid": np.inf}, "finite numbers"),
        ({"z_half": np.inf}, "z_half = inf"),
        ({"z_half": -1.0}, r"z_half = -1\.0"),
        ({"p": [[3]]}, "list of whole numbers"),
        ({"p": [10_001]}, "<= 10000, found 10001"),
        ({"cos": np.ones((1, 0)), "sin": np.ones((1, 0))}, r"cos must have shape .* not \(1, 0\)"),
        ({"sin": [[np.inf]]}, "sin contains values that are not finite"),
    ],
)
def test_nonsense_is_refused_by_name(arguments, message):
    good = {"p": [3], "cos": [[1.0]], "sin": [[0.0]]}
    with pytest.raises(ValueError, match=message):
        cf.FourierField(**(good | arguments))


def test_a_harmonic_of_three_numbers_is_refused():
    with pytest.raises(ValueError, match=r"one number \(cos\) or a pair"):
        cf.FourierField.of({2: 0.1, 3: (0.1, 0.2, 0.3)})


def test_thirty_harmonics_on_a_mesh_are_those_of_each_point():
    field = random_field(1, harmonics=29, degrees=1)
    z, theta = np.random.default_rng(9).uniform(size=(2, 4, 7))
    together = field.derivatives(z, theta)
    for place in np.ndindex(z.shape):
        alone = field.derivatives(z[place], theta[place])
        for all_of, one in zip(together, alone, strict=True):
            np.testing.assert_allclose(all_of[place], one, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("step", [0.0, 1e-30j])
def test_points_that_share_their_places_are_as_those_alone(step):
    """Points of a mesh are in rows, and are evaluated once a row and once an angle."""
    field = random_field(7, harmonics=3, degrees=2)
    z, theta = np.array([[0.3, 0.3, -0.1], [0.1, 0.3, 0.1]]) + step, np.array([[2.0, -1.0, 2.0], [2.0, 0.5, -1.0]])
    together = np.array(field.derivatives(z, theta))
    alone = np.array([np.array(field.derivatives(*place)) for place in zip(z.ravel(), theta.ravel(), strict=True)])
    np.testing.assert_allclose(together.reshape(6, -1), alone.T, rtol=1e-13)
