"""Coincidences of casing and blade: closed forms, waves, folding, blades that stiffen with speed; their pictures."""

import numpy as np
import pytest

import casingfem as cf

CASING = {n: [300.0 + 10.0 * (n - 6) ** 2] for n in range(3, 10)}


def test_every_coincidence_satisfies_its_condition():
    found = cf.interactions(CASING, [120.0, 500.0], speed_hz=(0.0, 200.0))
    for c in found.meetings:
        signs = {"sum": (1, 1), "backward": (1, -1), "forward": (-1, 1)}[c.branch]
        assert c.n * c.speed_hz == pytest.approx(signs[0] * c.casing_hz + signs[1] * c.blade_hz)
    assert len(found.of("backward")) == 7  # the low blade
    assert len(found.of("forward")) == 7  # the high one
    assert len(found.of("sum")) == 12  # at 500 Hz n = 3 and 4 would need 297 and 210 Hz
    speeds = [c.speed_hz for c in found.meetings]
    assert speeds == sorted(speeds)


def test_waves_change_sides_with_what_turns():
    """Blade: 8 f = 300 -+ 120. Casing, by ring theory with a = 8 - 16/65: f = (300^2 - 120^2)/(2 a 120), no sum."""
    blade, casing = (
        cf.interactions({8: [300.0]}, [120.0], speed_hz=(0.0, 100.0), turning=turning)
        for turning in ("blade", "casing")
    )
    assert [c.speed_hz for c in blade.meetings] == [22.5, 52.5]
    assert [c.wave for c in blade.meetings] == ["forward", "forward, overtaken"]
    (c,) = casing.meetings
    assert (c.branch, c.wave) == ("backward", "backward")
    assert c.speed_hz == pytest.approx(75600.0 / (2.0 * (8.0 - 16.0 / 65.0) * 120.0), rel=1e-5)
    assert c.casing_hz - 8.0 * c.speed_hz == pytest.approx(120.0, rel=1e-5)
    assert "f_c + f_b = n f is not possible" in repr(casing)


def test_the_table_states_when_the_sum_is_out_of_reach():
    text = repr(cf.interactions({10: [426.0], 8: [371.0]}, [380.0], speed_hz=(0.0, 5.0)))
    assert "n f = 50 Hz < f_c = 426 Hz, and likewise for every n of the table: f_c + f_b = n f is not possible" in text
    assert "f_b = f_c - n f" in text
    assert "resonance; flutter if mu > tan(lean)" in text
    assert "cannot be met" not in repr(cf.interactions({10: [426.0]}, [380.0], speed_hz=(0.0, 50.0)))


def test_a_disk_meets_only_its_own_diameters_folded():
    disk = cf.modal.DiskFrequencies(blades=12, freq={3: (110.0,), 4: (140.0,)})
    found = cf.interactions({3: [200.0], 5: [250.0], 8: [300.0], 9: [320.0]}, disk, speed_hz=(0.0, 200.0))
    met = {(c.n, c.blade_hz) for c in found.meetings}
    assert met == {(3, 110.0), (8, 140.0), (9, 110.0)}


def test_a_blade_that_stiffens_with_speed_is_met_where_it_then_is():
    speed = np.linspace(0.0, 100.0, 201)
    freq = np.sqrt(120.0**2 + 1.7 * speed**2)
    data = cf.modal.Campbell(
        omega=2.0 * np.pi * speed, freq=freq[:, None], southwell=np.zeros(1), overlap=np.ones((201, 1))
    )
    found = cf.interactions({8: [300.0]}, data, speed_hz=(0.0, 90.0)).of("sum")[0]
    # (8 f - 300)^2 = 120^2 + 1.7 f^2
    exact = max(np.roots([64.0 - 1.7, -4800.0, 300.0**2 - 120.0**2]).real)
    assert found.speed_hz == pytest.approx(exact, rel=1e-5)
    assert found.blade_hz == pytest.approx(8.0 * exact - 300.0, rel=1e-5)


@pytest.mark.parametrize(
    ("casing", "blade", "speeds", "turning", "code"),
    [
        (CASING, [120.0], (10.0, 5.0), "blade", "interaction-speed"),
        (CASING, [120.0], (0.0, 5.0), "rotor", "interaction-speed"),
        (CASING, [-120.0], (0.0, 5.0), "blade", "interaction-blade"),
        ({0: [100.0]}, [120.0], (0.0, 5.0), "blade", "interaction-casing"),
    ],
)
def test_bad_input_is_refused(casing, blade, speeds, turning, code):
    with pytest.raises(cf.errors.ModelError, match=code):
        cf.interactions(casing, blade, speed_hz=speeds, turning=turning)


def test_a_disk_cannot_have_more_diameters_than_half_its_blades():
    with pytest.raises(cf.errors.ModelError, match="interaction-blade"):
        cf.modal.DiskFrequencies(blades=12, freq={7: (100.0,)})
