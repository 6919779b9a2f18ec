"""What a run stores: at instants, as channels, in chunks of any size; the same numbers for every scheme."""

import numpy as np
import pytest

import contact as ct
from reports.verification.schemes.cases import methods
from tests.contact.synthetic_rim import blade, ring

BAR = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=2.0, velocity=-10.0, elements=12)
WALL = ct.Wall(x=0.0)
INSTANTS = (0.0, 0.103, 0.31, 0.31004, 0.5)


def rods(method):
    return lambda **more: ct.run([BAR, WALL], law=method.law, scheme=method.scheme, t_end=0.5, courant=0.4,
                               on_limit="flag", **more)  # fmt: skip


def modal(law):
    return lambda **more: ct.run([BAR, WALL], scheme=ct.ExactModal(law=law, modes=9), t_end=0.5, dt=2e-3, **more)


def rim(**more):
    scene = ct.RotatingRim(ring(imperfect=0.05), blade(), clearance=-1e-5, speed_hz=5.0, lean_deg=20.0)
    return ct.run(scene, law=ct.Coulomb(mu=0.2), t_end=0.5, dt=2e-4, **more)


def patch(**more):
    block = ct.ModalBody(omega=[1.0, 0.0], zeta=[0.0, 0.0], channels=("x", "y"), rows=np.eye(2), S=np.zeros((2, 2)))
    given = ct.Patch(body=block, normal=("y",), tangent=(("x",),), load=[0.0, -1.0], displacement=[1.0, 0.0])
    return ct.run(given, law=ct.Coulomb(mu=0.1), t_end=0.5, dt=1e-3, **more)


def tree(**more):
    """A linear body whose band order is not the order of its coordinates."""
    K = np.array([[2.0, 0.0, -1.0, 0.0], [0.0, 2.0, -1.0, -1.0], [-1.0, -1.0, 3.0, 0.0], [0.0, -1.0, 0.0, 2.0]])
    body = ct.LinearBody(M=np.ones(4), K=K, Q=[[0.0, 1.0, 0.0, 0.0]], gap0=[0.1], velocity=[1.0, -2.0, 3.0, 0.5])
    return ct.run(body, t_end=0.5, dt=1e-3, **more)


KINDS = {
    **{method.name: rods(method) for method in methods(50.0)},
    "forward law": modal("forward"), "energy law": modal("energy"), "rim": rim, "patch": patch, "linear body": tree,
}  # fmt: skip
QUICK = ("forward Lagrange", "linear body")  # the others compile other loops


@pytest.mark.parametrize("kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind not in QUICK)) for kind in KINDS])
def test_instants_and_channels_are_what_a_full_record_keeps_there(kind):
    make = KINDS[kind]
    whole = make(record=ct.Record(state_every=1))
    stored = np.hstack([whole.state, whole.tip_force])
    R = np.random.default_rng(5).standard_normal((3, stored.shape[1]))
    steps = sorted({min(round(t / whole.dt), whole.steps - 1) for t in INSTANTS})
    some = make(record=ct.Record(at=INSTANTS, channels=R))
    assert len(steps) < len(INSTANTS)  # two instants share a step
    assert np.array_equal(some.time, whole.time[steps])
    assert np.array_equal(some.state_time, whole.state_time[steps])
    for name in ("force", "gap", "impulse_history"):
        assert np.array_equal(getattr(some, name), getattr(whole, name)[steps])
    np.testing.assert_allclose(some.state, stored[steps] @ R.T, atol=1e-13 * np.abs(stored).max())
    assert np.array_equal(some.impulse, whole.impulse)
    assert some.energy == whole.energy
    assert some.intervals == whole.intervals


@pytest.mark.parametrize("kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind not in QUICK)) for kind in KINDS])
def test_the_figures_of_a_result_are_those_of_its_record(kind):
    result = KINDS[kind](record=ct.Record(state_every=1))
    force, closed = result.force, result.force > 0.0
    history = np.cumsum(force, axis=0) * result.dt
    assert result.peak_force.max() > 0.0
    assert np.array_equal(result.peak_force, force.max(axis=0))
    assert np.array_equal(result.max_penetration, np.maximum(-result.gap, 0.0).max(axis=0))
    assert np.array_equal(result.contact_steps, closed.sum(axis=0))
    np.testing.assert_allclose(result.impulse_history, history, rtol=1e-12, atol=1e-14 * history.max())
    assert np.array_equal(result.impulse, result.impulse_history[-1])
    turns = np.diff(np.vstack([np.zeros(closed.shape[1]), closed]), axis=0)
    for k, pairs in enumerate(result.intervals):
        first, after = (np.flatnonzero(turns[:, k] == sign) for sign in (1.0, -1.0))
        begin, end = np.array(pairs).T
        assert len(begin) == len(first)
        assert np.abs(begin - result.time[first]).max() <= (1.0 + 1e-9) * result.dt
        assert np.abs(end[: len(after)] - result.time[after]).max(initial=0.0) <= (1.0 + 1e-9) * result.dt
    assert np.array_equal(result.lam, -force)


@pytest.mark.slow
@pytest.mark.parametrize("method", [m for m in methods(50.0) if isinstance(m.law, ct.Penalty)], ids=lambda m: m.name)
def test_a_contact_spring_pushes_by_its_stiffness_and_its_law_is_violated_by_the_penetration(method):
    result = rods(method)()
    assert result.max_penetration[0] > 1.0
    np.testing.assert_allclose(result.force, 50.0 * np.maximum(-result.gap, 0.0), rtol=1e-12, atol=1e-14)
    assert np.array_equal(result.residual, result.max_penetration)
    assert ("penetration", True) in [(flag.code, flag.failed) for flag in result.flags]  # of a rod 10 m long


def test_channels_beside_a_regular_record():
    whole, part = (tree(record=ct.Record(state_every=50, channels=c)) for c in (None, [[0.0, 0.0, 1.0, 0.0]]))
    assert part.time.size == whole.time.size
    np.testing.assert_allclose(part.state[:, 0], whole.state[:, 2], rtol=1e-15)
    assert whole.state_of("body 1").shape == (10, 4)
    with pytest.raises(ct.InputError, match="1 channels of all bodies"):
        part.state_of("body 1")


def test_both_survive_a_file(tmp_path):
    result = tree(record=ct.Record(at=[0.2], channels=np.eye(4)[:2]))
    result.save(tmp_path / "run.npz")
    again = ct.Result.load(tmp_path / "run.npz")
    assert np.array_equal(again.channels, np.eye(4)[:2])
    assert np.array_equal(again.state, result.state)
    assert again.every == 0
    assert repr(again) == repr(result)
    assert "stored: 1 samples, at the steps nearest to the instants" in repr(result)


@pytest.mark.slow
def test_modal_coordinates_and_tip_forces_are_apart_in_a_result_and_in_its_file(tmp_path):
    result = KINDS["rim"](record=ct.Record(state_every=10))
    path = result.save(tmp_path / "run.npz")
    np.testing.assert_allclose(result.tip_force[:, 0], result.force[::10, 0], rtol=1e-12)
    again = ct.Result.load(path)
    assert again.blocks == result.blocks
    assert [name for name, _, _ in again.blocks] == ["casing", "blade"]
    assert np.array_equal(again.state, result.state)
    assert np.array_equal(again.tip_force, result.tip_force)


def test_buffers_stay_small_however_wide_the_state():
    record = ct.Record(state_every=1)
    assert record.chunk(contacts=1, coordinates=100_000) < 100
    assert record.chunk(contacts=1, coordinates=10**9) == 1
    assert ct.Record(state_every=1, channels=np.ones((2, 100_000))).chunk(contacts=1, coordinates=100_000) > 20_000


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"at": []}, "at: found"),
        ({"at": [-0.1]}, "at: found"),
        ({"at": [np.nan]}, "at: found"),
        ({"at": [0.1], "every": 2}, "with every"),
        ({"at": [0.1], "channels": [[np.inf]]}, "finite rows"),
        ({"channels": [[1.0]]}, "found neither state_every nor at"),
    ],
)
def test_records_that_cannot_be_are_refused(given, words):
    with pytest.raises(ct.InputError, match=words):
        ct.Record(**given)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"at": [0.6]}, "expected at most 0.5 s, the end of the run"),
        ({"at": [0.1], "channels": [[1.0, 2.0]]}, "rows of 2 numbers, expected 4"),
    ],
)
def test_records_that_do_not_fit_the_run_are_refused(given, words):
    with pytest.raises(ct.InputError, match=words):
        tree(record=ct.Record(**given))


SCENE = """
[scene]
kind = "rods"
t_end = 1.0
[[mass]]
mass = 1.0
x = 0.1
velocity = -1.0
[wall]
[scheme]
kind = "forward-lagrange"
dt = 0.01
[record]
"""


def test_scene_files_have_both(tmp_path):
    file = tmp_path / "scene.toml"
    (tmp_path / "rows.csv").write_text("# wall, mass\n0.0, 1.0\n1.0, -2.0\n")
    found = []
    for channels in ("[[0.0, 1.0], [1.0, -2.0]]", '"rows.csv"'):
        file.write_text(f"{SCENE}at = [0.05, 0.5]\nchannels = {channels}\n")
        found.append(ct.run(ct.load_scene(file)))
    assert found[0].state.shape == (2, 2)
    assert found[0].state[0, 0] == pytest.approx(-0.05)
    assert np.array_equal(found[0].state, found[1].state)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("at = []", "record.at: "),
        (f"every = {10**25}", "record: every: found over 1e18, expected at most 10000000"),
        ("at = [0.1]\nevery = 3", "record: at: found with every"),
        ("channels = [[1.0]]", "record: channels found without state_every or at"),
        ("at = [0.1]\nchannels = [[1.0], [1.0, 2.0]]", "record: channels of different lengths"),
        ('at = [0.1]\nchannels = "none.csv"', "record: channels: "),
    ],
)
def test_broken_tables_name_their_key(tmp_path, lines, words):
    (tmp_path / "scene.toml").write_text(f"{SCENE}{lines}\n")
    with pytest.raises(ct.scene.SceneError) as caught:
        ct.load_scene(tmp_path / "scene.toml")
    assert words in str(caught.value)


@pytest.mark.parametrize("name", ["every", "state_every"])
@pytest.mark.parametrize("value", [2.5, 2.0, np.inf, np.nan, "3", None, 10**25])
def test_counts_are_whole_numbers(name, value):
    with pytest.raises(ct.InputError, match=f"^{name}: found "):
        ct.Record(**{name: value})
