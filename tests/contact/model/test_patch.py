"""Several contacts of one modal body: stick and slip against closed forms, redundancy, the ledger, bad input."""

import math

import numpy as np
import pytest

import contact as ct

pytestmark = pytest.mark.slow  # whichever comes first compiles the loop


def body(omega, rows, names, S=None, zeta=0.0):
    rows = np.atleast_2d(rows)
    S = np.zeros((len(rows), len(rows))) if S is None else S
    return ct.ModalBody(omega=omega, zeta=np.full(len(omega), zeta), channels=names, rows=rows, S=S)


def oscillator(**changes):
    """Mass 1 on a spring 1 along x, pressed on the ground with force 1 along y."""
    block = body([1.0, 0.0], np.eye(2), ("x", "y"))
    given = {"body": block, "normal": ("y",), "tangent": (("x",),), "load": [0.0, -1.0], "displacement": [1.0, 0.0]}
    return ct.Patch(**{**given, **changes})


def run(patch, mu, t_end, dt, **more):
    law = ct.Coulomb(mu=mu) if mu else ct.Unilateral()
    return ct.run(patch, law=law, scheme=ct.ExactModal(), t_end=t_end, dt=dt, **more)


@pytest.mark.parametrize(
    ("mu", "rest", "stops"), [(0.1, 0.0, 5.0), (0.07, -0.02, 7.0), (0.3, -0.2, 2.0), (1.2, 1.0, 0.0)]
)
def test_a_coulomb_oscillator_comes_to_rest_where_the_closed_form_states(mu, rest, stops):
    """Each half swing is a cosine about +-mu, so that turning points fall by 2 mu, until one lies within mu of zero."""
    turning, swings = 1.0, 0
    while abs(turning) > mu * (1.0 + 1e-9):
        turning = -math.copysign(1.0, turning) * (abs(turning) - 2.0 * mu)
        swings += 1
    assert (turning, swings) == (pytest.approx(rest, abs=1e-12), stops)
    result = run(oscillator(), mu, 30.0, 1e-3, record=ct.Record(state_every=1))
    x = result.state[:, 0]
    assert x[-1] == pytest.approx(rest, abs=2e-7)
    assert np.ptp(x[result.state_time > stops * np.pi + 0.01]) < 1e-8
    assert result.energy.friction == pytest.approx(0.5 * rest**2 - 0.5, abs=2e-6)
    assert abs(result.energy.unaccounted) < 1e-12


def test_the_rest_position_converges_with_the_square_of_the_step():
    steps = np.array([0.1, 0.093, 0.081, 0.077, 0.064, 0.058, 0.051])

    def error(dt):  # where a turning point falls within its step is luck: the mean over several steps
        runs = [run(oscillator(), 0.07, 30.0, h, record=ct.Record(state_every=1)) for h in dt]
        return np.sqrt(np.mean([(result.state[-1, 0] + 0.02) ** 2 for result in runs]))

    assert error(steps) > 100.0 * error(steps / 16.0)


def test_a_belt_drags_a_block_to_the_friction_limit_and_keeps_it_there():
    patch = oscillator(displacement=[0.0, 0.0], slide=0.3, body=body([1.0, 0.0], np.eye(2), ("x", "y"), zeta=0.2))
    result = run(patch, 0.5, 80.0, 1e-2, record=ct.Record(state_every=1))
    assert result.state[-1, 0] == pytest.approx(0.5, rel=1e-3)
    sticking = np.diff(result.state[:, 0])[80:110] / 1e-2
    np.testing.assert_allclose(sticking, 0.3, rtol=1e-9)  # it rides with the belt, once it is as fast


def test_one_frictionless_contact_is_the_point_gap():
    rows = np.array([[1.0, 0.7, 0.4]])
    bar = body([0.0, 30.0, 70.0], rows, ("tip",), S=np.array([[1e-5]]))
    velocity = np.array([-2.0, 0.3, 0.0])
    side = ct.gaps.Side(body=bar, channel="tip", sign=1, velocity=velocity)
    one = ct.run(ct.PointGap(sides=(side,), clearance=0.05), scheme=ct.ExactModal(law="forward"), t_end=1.0, dt=1e-3)
    many = run(ct.Patch(body=bar, normal=("tip",), clearance=0.05, velocity=velocity), 0.0, 1.0, 1e-3)
    assert one.impulse[0] > 1.0
    np.testing.assert_allclose(many.force, one.force, rtol=1e-9, atol=1e-9 * one.force.max())
    np.testing.assert_allclose(many.gap, one.gap, atol=1e-12)
    assert many.energy.lost_in_contact == pytest.approx(one.energy.lost_in_contact, rel=1e-9)


def test_a_friction_that_presses_harder_than_the_contact_pushes_ends_the_run_at_its_touch():
    """Painleve's paradox: one mode turns each normal force N into a gap of (1 - mu) N; above mu = 1 no N opens it."""
    block = body([1.0], [[1.0], [1.0]], ("y", "x"))
    patch = ct.Patch(
        body=block, normal=("y",), tangent=(("x",),), slide=-1.0, velocity=[-1.0], clearance=0.01
    )  # fmt: skip
    assert run(patch, 0.5, 0.1, 1e-3).flags == ()
    with pytest.raises(ct.NumericsError, match=r"step 10 .*no forces satisfy Coulomb's law") as error:
        run(patch, 2.0, 0.1, 1e-3)
    assert [(flag.code, flag.failed) for flag in error.value.result.flags] == [("unconverged", True)]


@pytest.mark.parametrize("soft", [0.0, 1e-5])
def test_the_gap_of_an_open_contact_is_where_its_body_is(soft):
    rows = np.array([[1.0, 0.7, 0.4]])
    bar = body([0.0, 30.0, 70.0], rows, ("tip",), S=np.array([[soft]]))
    patch = ct.Patch(body=bar, normal=("tip",), clearance=0.05, velocity=[-2.0, 0.3, 0.0])
    result = run(patch, 0.0, 0.1, 1e-3, record=ct.Record(every=1, state_every=1))
    open_at = np.flatnonzero(result.force[:-1, 0] == 0.0)
    assert 10 < len(open_at) < 99
    place = 0.05 + result.state @ rows[0]  # the gap of a sample is that after its step
    np.testing.assert_allclose(result.gap[open_at, 0], place[open_at + 1], atol=1e-13)


def test_redundant_contacts_share_a_force_and_change_nothing():
    rows = np.array([[1.0, 0.7, 0.4]] * 5)
    names = tuple(f"tip{k}" for k in range(5))
    bar = body([0.0, 30.0, 70.0], rows, names)
    given = {"clearance": 0.05, "velocity": [-2.0, 0.3, 0.0]}
    one, five = (run(ct.Patch(body=bar, normal=normal, **given), 0.0, 1.0, 1e-3) for normal in (names[:1], names))
    np.testing.assert_allclose(five.force.sum(axis=1), one.force[:, 0], atol=1e-9 * one.force.max())
    assert five.max_penetration.max() < 1e-15


def table(contacts=16, modes=50, slide=(0.05, 0.02)):
    """A body on many points of the ground, three-dimensional, pressed down on all of them."""
    rng = np.random.default_rng(31)
    rows = rng.standard_normal((3 * contacts, modes))
    omega = np.concatenate([np.zeros(6), np.sort(rng.uniform(100.0, 5000.0, modes - 6))])
    names = tuple(f"{direction}{k}" for k in range(contacts) for direction in "nst")
    return ct.Patch(
        body=body(omega, rows, names, zeta=0.002), normal=names[::3], clearance=1e-4 * rng.random(contacts),
        tangent=tuple((names[k + 1], names[k + 2]) for k in range(0, 3 * contacts, 3)), slide=slide,
        load=-5.0 * rows[::3].sum(axis=0),
    )  # fmt: skip


def test_sticking_is_distinguished_from_slipping_step_by_step(tmp_path):
    result = run(oscillator(), 0.3, 30.0, 1e-3, record=ct.Record(every=10))
    (pauses,) = result.sticking
    assert pauses[-1][0] == pytest.approx(2.0 * np.pi, abs=5e-3)  # two half swings, then rest at -.2 for good
    assert pauses[-1][1] == pytest.approx(30.0, abs=1e-2)
    assert sum(end - start for start, end in pauses[:-1]) < 0.01
    result.save(tmp_path / "run.npz")
    assert ct.Result.load(tmp_path / "run.npz").sticking == result.sticking
    assert run(oscillator(tangent=()), 0.0, 1.0, 1e-2).sticking == ()


STEPS = np.array([0.1, 0.093, 0.081, 0.077, 0.064, 0.058, 0.051])  # where an event falls within its step is luck


def event_errors(make, exact, fine):
    """RMS errors over several steps of the instants that `make` finds in a run of step dt, one for each of `exact`."""
    found = np.array([make(dt) for dt in STEPS / fine])
    return np.sqrt(np.mean((found - exact) ** 2, axis=0))


def on_a_belt(dt, **change):
    """From rest on a belt of .3 m/s, mu N = .5: when it sticks to the belt, and when the spring tears it off."""
    ((first, *_),) = run(oscillator(**{"displacement": [0.0, 0.0], "slide": 0.3, **change}), 0.5, 2.5, dt).sticking
    return first


def test_stick_and_slip_are_located_to_second_order():
    """x = .5 (1 - cos t) until x' = .3, then with the belt until the spring pulls .5."""
    caught = math.asin(0.6)
    exact = [caught, caught + 0.5 * math.cos(caught) / 0.3]
    coarse, fine = (event_errors(on_a_belt, exact, f) for f in (4, 16))
    assert (coarse > 12.0 * fine).all()  # 16 at order two, 4 at order one
    assert (fine < 1e-5).all()


def test_two_slip_directions_are_one_when_the_motion_is_straight():
    """The same oscillator seen by tangents at 37 degrees to its motion."""
    rows = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])
    block = body([1.0, 0.0, 2.0], rows, ("s", "y", "t"))
    more = {"displacement": np.zeros(3), "load": [0.0, -1.0, 0.0], "slide": [0.24, 0.18], "tangent": (("s", "t"),)}
    np.testing.assert_allclose(on_a_belt(0.02, body=block, **more), on_a_belt(0.02), atol=1e-9)


def test_a_block_that_rests_at_its_first_turn_does_so_when_the_closed_form_states():
    def make(dt):
        ((pause,),) = run(oscillator(), 0.6, 4.0, dt).sticking
        return [pause[0]]

    coarse, fine = (event_errors(make, [math.pi], f) for f in (4, 16))
    assert coarse > 12.0 * fine
    ((pause,),) = run(oscillator(), 0.6, 4.0, 1e-3).sticking
    assert pause[1] == pytest.approx(4.0, abs=1e-9)


def test_a_turn_without_rest_has_no_length():
    """At pi the spring pulls .4 against .3: the slip turns at once; at 2 pi it rests."""
    (turn, rest) = run(oscillator(), 0.3, 10.0, 5e-3).sticking[0]
    assert turn == (pytest.approx(math.pi, abs=1e-5), turn[0])
    assert rest[0] == pytest.approx(2.0 * math.pi, abs=5e-3)  # the turn cost part of a step


def test_a_contact_that_opens_while_it_sticks_stops_sticking():
    patch = oscillator(load=[0.0, 0.0], displacement=[0.0, 0.0], velocity=[0.0, -1.0], clearance=0.01,
                       body=body([1.0, 50.0], np.eye(2), ("x", "y")))  # fmt: skip
    result = run(patch, 0.3, 0.1, 1e-4)
    ((closed,),), ((stuck,),) = result.intervals, result.sticking
    assert stuck[0] == pytest.approx(closed[0], abs=1e-4)
    assert stuck[1] == pytest.approx(closed[1], abs=1e-9)


def test_a_load_within_the_cone_sticks_for_as_long_as_it_acts():
    block = body([0.0, 0.0], np.eye(2), ("x", "y"))
    patch = ct.Patch(body=block, normal=("y",), tangent=(("x",),), load=[0.29, -1.0])
    result = run(patch, 0.3, 100.0, 1e-3, record=ct.Record(every=100, state_every=100))
    assert np.abs(result.state).max() < 1e-12
    np.testing.assert_allclose(result.force[1:, 0], 1.0, rtol=1e-9)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"normal": ()}, "normal"),
        ({"normal": ("z",)}, "channel"),
        ({"normal": "y"}, "normal: found the text 'y', expected a tuple of channel names"),
        ({"tangent": "x"}, "tangent: found the text 'x', expected a tuple of channel names"),
        ({"tangent": ("x",)}, "tangent: found the text 'x', expected a tuple of channel names"),
        ({"tangent": (("x",), ("x",))}, "tangent: found 2 entries of 1, 1 channels, expected 1 entries of one channel"),
        ({"tangent": (("x", "x", "x"),)}, "tangent: found 1 entries of 3 channels, expected 1 entries of one channel"),
        (
            {"normal": ("y", "y"), "tangent": (("x",), ("x", "y"))},
            "found 2 entries of 1, 2 channels, expected 2 entries of one channel each, or of two each",
        ),
        ({"displacement": [0.0, -0.1]}, "penetrates"),
        ({"load": [1.0]}, "load"),
        ({"velocity": [np.nan, 0.0]}, "velocity"),
    ],
)
def test_patches_that_cannot_be_are_refused(change, word):
    with pytest.raises(ct.InputError, match=word):
        oscillator(**change)


def test_laws_and_schemes_that_do_not_fit_are_refused():
    with pytest.raises(ct.InputError, match="without tangent"):
        run(oscillator(tangent=()), 0.1, 1.0, 1e-2)
    with pytest.raises(ct.InputError, match="averaged"):
        ct.run(oscillator(), law=ct.Coulomb(mu=0.1), scheme=ct.ExactModal(law="averaged"), t_end=1.0, dt=1e-2)
    with pytest.raises(ct.LimitError, match="resonance"):
        run(oscillator(), 0.1, 10.0, 3.0)
