"""Interfaces: Fourier amplitudes of a rim, the mean motion of a tip."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.modal.interface.chart_rows import (
    interface_rows,
    node_rows,
    rim_lines,
    rim_rows,
    tip_directions,
    tip_rows,
)


@pytest.fixture(scope="module")
def casing(frustum):
    return cf.shell.assemble(frustum(mesh=cf.ShellMesh(order=6, rows=1, around=11)))


def motion(system, radial, tangential):
    theta = system.grid.nodes[1]
    c, s = np.cos(theta), np.sin(theta)
    r, t = radial(theta), tangential(theta)
    return np.stack([r * c - t * s, r * s + t * c, *np.zeros((3, len(theta)))], axis=1).ravel()


def test_rim_rows_give_the_fourier_amplitudes_of_both_directions(casing):
    rows, names = rim_rows(casing, cf.Rim("top", n_max=6))
    found = rows @ motion(
        casing,
        lambda x: 0.5 + 2 * np.cos(3 * x) - np.sin(5 * x),
        lambda x: 3 * np.sin(x) + 0.25 * np.cos(6 * x),
    )
    expected = dict.fromkeys(names, 0.0) | {
        "radial.cos0": 0.5,
        "radial.cos3": 2.0,
        "radial.sin5": -1.0,
        "tangential.sin1": 3.0,
        "tangential.cos6": 0.25,
    }
    np.testing.assert_allclose(found, [expected[name] for name in names], atol=1e-5)


def test_rim_rows_touch_only_their_edge(casing):
    rows, _ = rim_rows(casing, cf.Rim("top", n_max=4))
    touched = np.flatnonzero(np.abs(rows).max(axis=0)) // 5
    assert set(touched) == set(casing.grid.edges["top"].nodes)


@pytest.mark.parametrize(
    ("rim", "message"),
    [
        (cf.Rim("tip"), "closed casing with 'tip'; this one has base, top"),
        (cf.Rim(n_max=4), "found neither an edge nor lines"),
        (cf.Rim(lines=(0.1, 0.1), n_max=4), r"lines: found 0\.1, 0\.1 m, .* once each"),
        (cf.Rim("top", n_max=0), "between 1 and 22"),
        (cf.Rim("top", n_max=23), "found 23"),
    ],
)
def test_refuses_a_rim_that_is_none(casing, rim, message):
    with pytest.raises(ValueError, match=message):
        rim_rows(casing, rim)


def test_tip_rows_are_the_mean_over_the_edge(steel):
    plate = cf.Shell(
        chart=cf.Plate(length=0.3, width=0.1), thickness=2e-3, material=steel, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=4, rows=2, around=2),
    )  # fmt: skip
    system = cf.shell.assemble(plate)
    rows, names = tip_rows(system, cf.Tip())
    x, y = system.points.T[:2]
    fields = np.stack([x + 3 * y**2, 0 * x, 5 * x + y, 0 * x, 0 * x], axis=1).ravel()
    assert names == ("span", "flap")
    np.testing.assert_allclose(rows @ fields, [0.3 + 3 * 0.1**2 / 12, 1.5], rtol=1e-12)


def test_tip_of_a_panel_flaps_along_its_normal(steel):
    panel = cf.Shell(
        chart=cf.Panel(radius=0.6, length=0.3, angle=0.5), thickness=3e-3, material=steel,
        supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=4, rows=1, around=2),
    )  # fmt: skip
    system = cf.shell.assemble(panel)
    rows, _ = tip_rows(system, cf.Tip())
    shift = np.zeros((len(system.frames), 5))
    shift[:, 0] = 1.0  # the normal at mid-edge is -+x, z the span
    assert np.abs(rows @ shift.ravel()) == pytest.approx([0.0, 1.0], abs=1e-12)


def test_a_rim_needs_a_casing_and_a_tip_a_blade(steel, casing):
    plate = cf.Shell(chart=cf.Plate(length=1.0, width=1.0), thickness=0.01, material=steel, mesh=cf.ShellMesh(order=2))
    with pytest.raises(ValueError, match="closed casing"):
        rim_rows(cf.shell.assemble(plate), cf.Rim("tip"))
    with pytest.raises(ValueError, match="open panel or plate"):
        tip_rows(casing, cf.Tip("top"))
    with pytest.raises(ValueError, match="edge 'nose'"):
        tip_rows(cf.shell.assemble(plate), cf.Tip("nose"))


def test_a_rim_in_three_directions_on_several_lines(casing):
    """Amplitudes that vary linearly along z, on lines between the nodes."""
    z, theta = casing.grid.nodes
    fields = np.zeros((len(z), 5))
    radial, axial = z * np.cos(3 * theta), (1.0 - z) * np.sin(2 * theta)
    fields[:, 0], fields[:, 1], fields[:, 2] = radial * np.cos(theta), radial * np.sin(theta), axial
    rim = cf.Rim("top", n_max=5, axial=True, lines=(0.11, 0.2347))
    rows, names = rim_rows(casing, rim)
    found = dict(zip(names, rows @ fields.ravel(), strict=True))
    expected = dict.fromkeys(names, 0.0)
    for k, place in enumerate(rim.lines):
        expected[f"line{k}.radial.cos3"] = place
        expected[f"line{k}.axial.sin2"] = 1.0 - place
    np.testing.assert_allclose(list(found.values()), list(expected.values()), atol=1e-4)
    lines = rim_lines(casing.shell, rim)
    np.testing.assert_allclose(lines[:, 0], rim.lines, atol=1e-12)
    np.testing.assert_allclose(lines[:, 1], 0.5 - 0.05 * np.array(rim.lines) / 0.25, atol=1e-12)
    edge, _ = rim_rows(casing, cf.Rim("top", n_max=5, axial=True))
    line, _ = rim_rows(casing, cf.Rim("top", n_max=5, axial=True, lines=(0.25,)))
    np.testing.assert_allclose(line @ fields.ravel(), edge @ fields.ravel(), atol=1e-4)
    with pytest.raises(ValueError, match=r"expected places from 0 to 0\.25"):
        rim_rows(casing, cf.Rim("top", n_max=5, lines=(0.3,)))


def test_the_radius_of_a_line_is_the_mean_of_the_whole_turn(frustum):
    """A harmonic of the radius is no change of it."""
    uneven = frustum(mesh=cf.ShellMesh(order=6, rows=1, around=11), radius_defect=cf.FourierField.of({2: (1e-2, 5e-3)}))
    ((_, radius),) = rim_lines(uneven, cf.Rim("top", n_max=3))
    assert radius == pytest.approx(0.45, rel=1e-4)


def test_pieces_of_a_tip_average_to_the_tip_and_know_their_directions(steel):
    chart = cf.Panel(radius=0.3, length=0.12, angle=0.25)
    shell = cf.Shell(
        chart=chart, thickness=2e-3, material=steel, supports={"root": cf.Clamped()}, mesh=cf.ShellMesh(order=5)
    )
    system = cf.shell.assemble(shell)
    along, across = system.grid.nodes
    fields = np.stack([1.0 + 3.0 * across**2, np.sin(9.0 * across), along * (1.0 + across), across, along], axis=1)
    pieces, names = node_rows(system, cf.TipNodes(count=4))
    tip, _ = tip_rows(system, cf.Tip())
    values = (pieces @ fields.ravel()).reshape(4, 3)
    np.testing.assert_allclose(values[:, :2].mean(axis=0), tip @ fields.ravel(), rtol=1e-5)
    assert names[-1] == "node3.chord"
    directions = tip_directions(system, cf.TipNodes())
    np.testing.assert_allclose(directions @ directions.T, np.eye(3), atol=1e-12)
    turn = np.zeros_like(fields)  # along the edge: nothing but chord, and more of it in no piece than in another
    turn[:, :3] = directions[2]
    np.testing.assert_allclose((pieces @ turn.ravel()).reshape(4, 3), np.tile([0.0, 0.0, 1.0], (4, 1)), atol=1e-9)
    with pytest.raises(ValueError, match="between 1 and 100, found 0"):
        node_rows(system, cf.TipNodes(count=0))


def test_pieces_of_a_tip_of_uneven_curvature_have_equal_lengths(steel):
    """Else their mean would not be that of the whole edge; along this one the length per angle changes by a fifth."""
    shell = cf.Shell(
        chart=cf.Panel(radius=0.3, length=0.12, angle=1.0),
        thickness=2e-3,
        material=steel,
        supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=4),
        radius_defect=cf.FourierField.of({3: (0.0, 0.1)}),
    )
    system = cf.shell.assemble(shell)
    across = system.grid.nodes[1]
    fields = np.stack([across, across**2, 1.0 - across, across, across], axis=1).ravel()
    pieces, _ = node_rows(system, cf.TipNodes(count=3))
    tip, _ = tip_rows(system, cf.Tip())
    np.testing.assert_allclose((pieces @ fields).reshape(3, 3)[:, :2].mean(axis=0), tip @ fields, rtol=1e-6)


@pytest.mark.parametrize(
    ("interface", "words"),
    [
        (cf.modal.AtNodes((3, 4)), "at: found nodes 3, 4 of a chart, whose nodes have no numbers"),
        (cf.Rim("top", n_max=2, axis=(1.0, 0.0, 0.0)), "a Rim of a chart turns about z, found another axis"),
        (cf.Rim("top", n_max=2, point=(0.0, 0.1, 0.0)), "a Rim of a chart turns about z, found another axis"),
        (cf.Rim("top", n_max=2, lines=(-0.01, 0.1)), r"lines: found -0.01 m, expected places from 0 to 0.25 m"),
        (cf.Rim("top", n_max=2, lines=(0.1, 0.26)), r"lines: found 0.26 m, expected places from 0 to 0.25 m"),
    ],
)
def test_interfaces_that_a_casing_does_not_have_are_refused(casing, interface, words):
    with pytest.raises(cf.errors.ModelError, match=words):
        interface_rows(casing, interface)


def test_lines_may_stand_on_both_ends_of_a_casing(casing):
    rows, names = interface_rows(casing, cf.Rim("top", n_max=2, lines=(0.0, 0.25)))
    assert rows.shape == (20, 5 * len(casing.points))
    assert names[-1] == "line1.tangential.sin2"


@pytest.mark.parametrize(("count", "refused"), [(1, False), (100, False), (101, True)])
def test_a_tip_of_a_panel_has_one_to_a_hundred_pieces(steel, count, refused):
    chart = cf.Panel(radius=0.3, length=0.12, angle=0.25)
    shell = cf.Shell(
        chart=chart, thickness=2e-3, material=steel, supports={"root": cf.Clamped()},
        mesh=cf.ShellMesh(order=3, rows=1, around=1),
    )  # fmt: skip
    if refused:
        with pytest.raises(cf.errors.ModelError, match=r"TipNodes\.count must lie between 1 and 100, found 101"):
            interface_rows(cf.shell.assemble(shell), cf.TipNodes(count=count))
        return
    system = cf.shell.assemble(shell)
    rows, names = interface_rows(system, cf.TipNodes(count=count))
    assert rows.shape == (3 * count, 5 * len(system.points))
    assert len(names) == 3 * count
    chord = tip_directions(system, cf.Tip())[2]
    theta = system.grid.nodes[1]
    along = system.points[theta.argmax()] - system.points[theta.argmin()]
    assert chord @ along > 0.0  # towards larger angles
