"""What a continuation found, as lines, rows and documents; what changes between neighbours; when a file is written."""

import math

import numpy as np

import contact as ct


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
        "branch 2: 1 orbits over freq_hz, repeating after 2 periods",
        "  stable   3 to 3",
    ]
    four, five = repr(found(4)), repr(found(5))
    assert four.count("grazing at 1.75") == 4
    assert "grazing events" not in four
    assert five.count("grazing at") == 0
    assert "  5 grazing events: a contact begins or ceases to close" in five.splitlines()


def test_rows_and_marks_of_a_continuation():
    rows = found().records()
    assert rows == found().records()
    assert rows[2] == {
        "branch": 1, "freq_hz": 1.5, "periods": 1, "amplitude_tip": 1e-3, "amplitude_rim": 2e-3, "multiplier": 1.5,
        "growth_1_s": math.log(1.5) / 0.5, "stable": False, "contacts": 1, "closings": 0, "gap": -0.5, "force": 7.0,
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
    point = {
        "freq_hz": 1.5, "amplitude": {"tip": 1e-3, "rim": 2e-3}, "multiplier": 1.5, "growth_1_s": math.log(1.5) / 0.5,
        "stable": False, "contacts": 1,
    }  # fmt: skip
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
