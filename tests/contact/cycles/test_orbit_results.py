"""What a continuation found, as lines, rows and documents; what changes between neighbours; when a file is written."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import contact as ct
from contact.cycles.branch import Tangent, passed, signs
from contact.cycles.passage import Event, Extremes, pressing
from contact.cycles.shooting import _free_time, _nearer


def orbit(value, *, multiplier=0.5, periods=1, closings=(2, 0), touching=(), size=1e-3, **more):
    given = {"M": np.eye(2), "gap": np.array([0.25, -0.5]), "force": np.array([3.0, 7.0]), "rests": (0, 0)} | more
    return ct.cycles.Orbit(
        name="freq_hz", value=value, period=0.5, periods=periods, start=0.0, x=np.zeros(2), closings=closings,
        multipliers=np.array([multiplier, 0.1j]), amplitude={"tip": size, "rim": 2.0 * size}, touching=touching,
        iterations=1, **given,
    )  # fmt: skip


def special(kind, value):
    return ct.cycles.Special(kind=kind, orbit=orbit(value), before=orbit(value - 1e-6))


def found(grazings=1):
    points = (orbit(1.0), orbit(2.0), orbit(1.5, multiplier=-1.5, closings=(0, 0), touching=(1,)))
    specials = (special("fold", 2.25), *[special("grazing", 1.75)] * grazings)
    main = ct.cycles.Branch(points=points, specials=specials, end="a corner")
    other = ct.cycles.Branch(points=(orbit(3.0, periods=2),), specials=())
    return ct.cycles.Cycles(name="freq_hz", branches=(main, other), seconds=4.0)


def test_an_orbit_is_kept_inside_the_unit_circle_and_counts_the_contacts_that_touch():
    assert (orbit(1.0, multiplier=-0.999).stable, orbit(1.0, multiplier=1.0).stable) == (True, False)
    assert orbit(1.0, multiplier=-3.0).multiplier == 3.0
    assert [orbit(1.0, closings=c, touching=t).contacts for c, t in (((0, 0), ()), ((1, 0), (0,)), ((0, 3), (0,)))] == [
        0, 1, 2,
    ]  # fmt: skip


def test_columns_of_a_branch():
    branch = found().branches[0]
    assert branch.value.tolist() == [1.0, 2.0, 1.5]
    assert branch.stable.tolist() == [True, True, False]
    assert branch.multiplier.tolist() == [0.5, 0.5, 1.5]
    assert branch.amplitude("rim").tolist() == [2e-3] * 3
    assert branch.stretches == ((True, 1.0, 2.0), (False, 1.5, 1.5))
    assert [s.orbit.value for s in branch.of("fold")] == [2.25]


def test_the_lines_of_a_continuation():
    assert repr(found()).splitlines() == [
        "branch 1: 3 orbits over freq_hz",
        "  stable   1 to 2",
        "  UNSTABLE 1.5 to 1.5",
        "  fold at 2.25: tip 0.001 m, rim 0.002 m",
        "  grazing at 1.75: tip 0.001 m, rim 0.002 m",
        "  ends at 1.5: a corner",
        "branch 2: 1 orbits over freq_hz, closing after 2 periods",
        "  stable   3 to 3",
    ]
    four, five = repr(found(4)), repr(found(5))
    assert four.count("grazing at 1.75") == 4
    assert "times a contact" not in four
    assert five.count("grazing at") == 0
    assert "  5 times a contact begins or ceases to close (grazing)" in five.splitlines()


def test_rows_and_marks_of_a_continuation():
    rows = found().records()
    assert rows == found().records()
    assert rows[2] == {
        "branch": 1, "freq_hz": 1.5, "periods": 1, "amplitude_tip": 1e-3, "amplitude_rim": 2e-3, "multiplier": 1.5,
        "stable": False, "contacts": 1, "closings": 0, "gap": -0.5, "force": 7.0,
    }  # fmt: skip
    assert (rows[3]["branch"], rows[3]["periods"], rows[0]["closings"]) == (2, 2, 2)
    assert found().marks() == [
        {"kind": kind, "branch": 1, "freq_hz": value, "amplitude_tip": 1e-3, "amplitude_rim": 2e-3}
        for kind, value in (("fold", 2.25), ("grazing", 1.75))
    ]
    free = ct.cycles.Cycles(
        name="v", branches=(ct.cycles.Branch(points=(orbit(1.0, gap=np.zeros(0), force=np.zeros(0)),), specials=()),)
    )
    assert (free.records()[0]["gap"], free.records()[0]["force"], free.seconds) == (math.inf, 0.0, 0.0)


def test_the_document_of_a_continuation():
    document = found().to_dict()
    assert (document["parameter"], document["seconds"], document["end"]) == ("freq_hz", 4.0, "a corner")
    point = {"freq_hz": 1.5, "amplitude": {"tip": 1e-3, "rim": 2e-3}, "multiplier": 1.5, "stable": False, "contacts": 1}
    assert document["points"][2] == point
    assert [fold["freq_hz"] for fold in document["folds"]] == [2.25]
    assert [(event["kind"], event["freq_hz"]) for event in document["events"]] == [("fold", 2.25), ("grazing", 1.75)]
    assert [(part["periods"], len(part["points"]), part["end"]) for part in document["branches"]] == [(2, 1, "")]


def test_a_continuation_in_a_file(tmp_path):
    with np.load(found().save(tmp_path / "found.npz")) as file:
        assert file["branch"].tolist() == [1, 1, 1, 2]
        assert file["value"].tolist() == [1.0, 2.0, 1.5, 3.0]
        assert file["channels"].tolist() == ["tip", "rim"]
        assert file["special_branch"].tolist() == [1, 1]
        assert file["special_value"].tolist() == [2.25, 1.75]
        assert file["amplitude"].tolist() == [[1e-3, 2e-3]] * 4


@pytest.mark.parametrize(
    ("multipliers", "counts"),
    [
        ([1.0, -1.0], (0, 0, 0)), ([1.5, 2.0], (2, 0, 0)), ([-1.5, 0.5], (0, 1, 0)),
        ([0.6 + 0.7j, 0.6 - 0.7j], (0, 0, 0)), ([1.0 + 1.0j, 1.0 - 1.0j], (0, 0, 2)),
    ],
)  # fmt: skip
def test_multipliers_beyond_the_unit_circle_are_counted(multipliers, counts):
    at = SimpleNamespace(multipliers=np.array(multipliers, complex), closings=(3, 4), rests=(0, 2))
    assert signs(at, Tangent(np.zeros(2), 0.0))[0] is False
    assert signs(at, Tangent(np.zeros(2), 1e-9))[0] is True
    assert signs(at, Tangent(np.zeros(2), 1.0))[1:4] == counts
    assert signs(at, Tangent(np.zeros(2), 1.0)).closings == (3, -2)


def walked(*edges, fails=math.inf):
    """Orbits by the length walked, whose one contact closes once more beyond each edge."""

    def at(length):
        if length > fails:
            raise ct.NumericsError("no orbit")
        closings = (sum(length > edge for edge in edges),)
        return SimpleNamespace(value=length, multipliers=np.zeros(1), closings=closings, rests=(0,))

    along = Tangent(np.zeros(1), 1.0)
    course = SimpleNamespace(next=lambda _, __, length: at(length), tangent=lambda *_: along)
    last = SimpleNamespace(value=1.0, multipliers=np.zeros(1), closings=(len(edges),), rests=(0,))
    return passed(course, at(0.0), last, along, 1.0, along)


def test_changes_between_neighbours_are_located_one_after_the_other():
    """To 2^-16 of the step, the last orbit before and the first after each."""
    one, two = walked(0.3, 0.72)
    for change, edge in ((one, 0.3), (two, 0.72)):
        assert change.kind == "grazing"
        assert change.before.value <= edge < change.orbit.value <= edge + 2.0**-15
    assert walked() == []
    assert len(walked(*np.linspace(0.1, 0.9, 9))) == 8  # at most
    (coarse,) = walked(0.3, fails=0.4)  # beyond which nothing is found
    assert (coarse.before.value, coarse.orbit.value) == (0.0, 1.0)


def flown(*events, start=10.0, rigid=(True, True)):
    passage = SimpleNamespace(start=start, events=events)
    return passage, SimpleNamespace(plant=SimpleNamespace(rigid=np.array(rigid)))


def test_an_orbit_begins_in_the_middle_of_its_longest_flight():
    """Of two contacts: one closed from .2 to .5 s, the other from .4 to .9 s, and hit again at 1.3 s."""
    hits = (
        Event(10.2, 0, True, True, 0.0), Event(10.4, 1, True, True, 0.0), Event(10.5, 0, False, False, 0.0),
        Event(10.9, 1, False, False, 0.0), Event(11.3, 1, True, False, 1.0),
    )  # fmt: skip
    assert _free_time(*flown(*hits), 2.0) == pytest.approx(1.65)
    assert _free_time(*flown(*hits), 1.5) == pytest.approx(1.1)
    assert _free_time(*flown(), 2.0) == 0.0
    assert _free_time(*flown(*hits, rigid=(False, False)), 2.0) == 0.0


def test_newtons_step_is_the_longest_that_comes_nearer_or_as_it_is():
    x, change, off = np.array([1.0]), np.array([8.0]), SimpleNamespace(x=np.array([3.0]))

    def closing(distance):
        return lambda trial: SimpleNamespace(x=trial + distance(trial[0]))

    for near, taken in ((10.0, 9.0), (6.0, 5.0), (4.0, 3.0), (1.6, 1.5), (1.4, 9.0)):
        trial, after = _nearer(closing(lambda at, near=near: 1.0 if at < near else 2.0), x, off, change)
        assert trial.tolist() == [taken]
        assert after.x.tolist() == [taken + (1.0 if taken < near else 2.0)]


def test_least_gaps_and_largest_forces_so_far():
    """A closed contact is at zero or deeper, and its force is that of the phase; an open one keeps its force."""
    gap, force = np.array([0.5, -0.25]), np.array([2.0, 3.0])
    before = Extremes(gap=gap, force=force, most=np.array([1.0]), least=np.array([-1.0]))
    work = SimpleNamespace(least=np.array([0.125, 9.0, -4.0]), most=np.array([9.0, 5.0, 6.0]))
    after = before.after(SimpleNamespace(closed=(1,)), work)
    assert (after.gap.tolist(), after.force.tolist()) == ([0.125, -0.25], [2.0, 5.0])
    assert (after.most.tolist(), after.least.tolist()) == ([6.0], [-4.0])
    other = before.after(SimpleNamespace(closed=(0,)), work)
    assert (other.gap.tolist(), other.force.tolist()) == ([0.0, 9.0], [9.0, 3.0])


def test_forces_press_where_gaps_would_be_negative():
    W = np.array([[2.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 4.0]])
    assert pressing(W, np.array([1.0, 0.0, 2.0])).tolist() == [0.0] * 3
    lam = pressing(W, np.array([-4.0, 1.0, -2.0]))
    np.testing.assert_allclose(lam, [2.0, 0.0, 0.5], rtol=1e-14)
    gap = W @ lam + [-4.0, 1.0, -2.0]
    np.testing.assert_allclose(gap, [0.0, 2.5, 0.0], atol=1e-14)
    lam = pressing(W, np.array([5.0, -3.0, 0.5]))  # the second draws the third in
    np.testing.assert_allclose(lam, [0.0, 11.5 / 11.0, 1.5 / 11.0], rtol=1e-13)
    np.testing.assert_allclose(pressing(W, np.array([5.0, -3.0, 1.0])), [0.0, 1.0, 0.0], rtol=1e-14)
