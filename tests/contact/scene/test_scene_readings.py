"""What tables of scene files mean: profiles, harmonics, tips, laws, ranges and records, by values written out."""

import math
from statistics import NormalDist

import numpy as np
import pytest

import contact as ct
from contact.scene.laws import CoatingTable, contact_law
from contact.scene.parts import RecordTable
from contact.scene.patch import PatchBodyTable, PatchFile
from contact.scene.rim import BladeTable, CasingTable, DiskCasingTable, DiskFile
from contact.scene.roundness import GapTable, RandomRoundness
from contact.scene.rub import RubBlade, RubClosing, RubNode, RubSpeed, RubWhirl, read_profile, turned
from contact.scene.scheme import SchemeTable
from tests.contact.synthetic_rim import blade, ring
from tests.contact.synthetic_rub import nodes, rim3

COAT = {"E": 8e8, "yield_stress": 2e4, "hardening": 1e6, "thickness": 2e-3, "width": 0.03, "tip": 0.05}


def test_a_profile_is_two_columns_below_its_header_without_comments_and_empty_lines(tmp_path):
    file = tmp_path / "round.csv"
    file.write_text("# made by hand\n\n theta_deg , depth_m\n-5,1e-5\n# between\n\n0.0, 2e-5 \n90,-3e-5\n")
    assert read_profile(file) == ([-5.0, 0.0, 90.0], [1e-5, 2e-5, -3e-5])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "found no header theta_deg,depth_m"), ("depth_m,theta_deg\n1,2\n", "found no header"),
        ("theta_deg,depth_m\n", "found no line below the header"),
        ("theta_deg,depth_m\n0,1\n1\n", "line 3: found '1', expected two numbers"),
        ("theta_deg,depth_m\n\n0,1,2\n", "line 3: found '0,1,2', expected two numbers"),
        ("theta_deg,depth_m\n0,inf\n", "line 2: found '0,inf', expected two finite numbers"),
        ("theta_deg,depth_m\nnan,0\n", "line 2: found 'nan,0', expected two finite numbers"),
        ("theta_deg,depth_m\n0,1\n7,1\n7,2\n", "line 4: found 7 deg after 7, expected ascending"),
        ("theta_deg,depth_m\n0,1\n7,1\n5,2\n", "line 4: found 5 deg after 7, expected ascending"),
    ],
)  # fmt: skip
def test_profiles_that_say_something_else_are_refused_with_their_line(tmp_path, text, words):
    (tmp_path / "round.csv").write_text(text)
    with pytest.raises(ct.InputError, match=words):
        read_profile(tmp_path / "round.csv")


def test_a_profile_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(ct.InputError, match="found no such file, expected one"):
        read_profile(tmp_path / "none.csv")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ct.InputError, match=r"found the mark of UTF-16, expected UTF-8 text"):
        read_profile(tmp_path / "bytes.csv")


def test_random_harmonics_are_lognormal_through_median_and_ninetieth_percentile():
    lines = [{"p": 2, "median": 1e-5, "high": 3e-5}, {"p": 5, "median": 2e-6, "high": 2e-6}]
    table = RandomRoundness(seed=7, spectrum=lines)
    for draw in (0, 3):
        size, turn = np.random.default_rng([7, 0, draw]).random((2, 2)).T
        normal = NormalDist()
        first = 1e-5 * math.exp(math.log(3.0) * normal.inv_cdf(size[0]) / normal.inv_cdf(0.9))
        found = table.terms(draw)
        assert [term["p"] for term in found] == [2, 5]
        for term, amplitude, phase in zip(found, (first, 2e-6), 2.0 * math.pi * turn, strict=True):
            exact = amplitude * math.cos(phase), amplitude * math.sin(phase)
            assert (term["cos"], term["sin"]) == pytest.approx(exact, rel=1e-12)
    scaled = RandomRoundness(seed=7, spectrum=lines, rms=4e-5).terms(3)
    ratio = scaled[0]["cos"] / found[0]["cos"]
    assert sum(t["cos"] ** 2 + t["sin"] ** 2 for t in scaled) / 2.0 == pytest.approx(1.6e-9, rel=1e-12)
    assert [t["sin"] for t in scaled] == pytest.approx([ratio * t["sin"] for t in found], rel=1e-12)


def test_harmonics_alone_have_the_spread_of_rayleigh_amplitudes():
    alike = RandomRoundness(seed=3, harmonics=[2, 4], rms=1e-4)
    ratio = math.sqrt(math.log(10.0) / math.log(2.0))
    lines = [{"p": p, "median": 5.0, "high": 5.0 * ratio} for p in (2, 4)]
    lined = RandomRoundness(seed=3, spectrum=lines, rms=1e-4)
    for one, other in zip(alike.terms(2), lined.terms(2), strict=True):
        assert one == pytest.approx(other, rel=1e-12)


def test_a_gap_has_its_given_harmonics_then_those_of_its_draw():
    given = [{"p": 3, "cos": 1e-5, "sin": -2e-5}]
    random = RandomRoundness(seed=1, harmonics=[2], rms=1e-5)
    casing = ring()
    plain = GapTable.model_validate({"clearance": 0.0, "out_of_roundness": given})
    assert plain.terms(casing) == given
    for more, draw in (({}, 0), ({"draw": 4}, 4)):
        table = GapTable.model_validate({**plain.model_dump(), "random_out_of_roundness": random.model_dump(), **more})
        assert table.terms(casing) == given + random.terms(draw)
    surveyed = GapTable(clearance=0.0, out_of_roundness="basis")
    with pytest.raises(ct.InputError, match="found 'basis' with 2 rim lines, which may differ"):
        surveyed.terms(rim3())


def test_nodes_of_a_sector_turn_with_it_and_number_their_tracks_by_line():
    given = [
        RubNode(span="a.span", flap="a.flap", angle_deg=1.0, clearance=2e-6),
        RubNode(span="b.span", flap="b.flap", line=1, axial="b.chord"),
        RubNode(span="c.span", flap="c.flap", angle_deg=-2.0),
        RubNode(span="d.span", flap="d.flap", track=9),
    ]
    found = turned(given, 1, 4)
    assert [node.angle_deg for node in found] == [91.0, 90.0, 88.0, 90.0]
    assert [(node.line, node.track) for node in found] == [(0, 0), (1, 0), (0, 1), (0, 9)]
    assert [node.span for node in found] == [f"sector1.{k}.span" for k in "abcd"]
    assert [node.flap for node in found] == [f"sector1.{k}.flap" for k in "abcd"]
    assert [node.axial for node in found] == [None, "sector1.b.chord", None, None]
    assert found[0].clearance == 2e-6


def test_places_left_out_are_those_of_the_basis():
    plain = RubBlade(basis="b")
    assert [(n.span, n.flap, n.axial) for n in plain.nodes(blade())] == [("span", "flap", None)]
    sliding = RubBlade(basis="b", axial=True).nodes(nodes(2))
    assert [(n.span, n.axial) for n in sliding] == [("node0.span", "node0.chord"), ("node1.span", "node1.chord")]
    own = RubBlade(basis="b", node=[RubNode(span="node1.span", flap="node1.flap")])
    assert own.nodes(nodes(2)) == own.node


def test_speeds_and_closings_are_numbers_or_tables_over_time():
    assert RubSpeed(hz=-3.0).law().omega(5.0) == pytest.approx(-6.0 * math.pi, rel=1e-13)
    assert RubSpeed(hz=[1.0, 3.0], time=[0.0, 2.0]).law().omega(0.5) == pytest.approx(3.0 * math.pi, rel=1e-12)
    assert RubClosing(by=[0.0, 4e-5], time=[0.0, 2.0]).law().at(0.5) == pytest.approx(1e-5, rel=1e-12)
    closing = RubClosing(by=4e-5, time_constant=0.3).law()
    assert closing.at(0.3) == pytest.approx(4e-5 * (1.0 - math.exp(-1.0)), rel=1e-3)
    for given in (
        {"by": 1.0}, {"by": [1.0]}, {"by": 1.0, "time": [0.0]}, {"by": 1.0, "time": [0.0], "time_constant": 1.0},
        {"by": [1.0], "time": [0.0], "time_constant": 1.0}, {"by": [1.0], "time_constant": 1.0},
    ):  # fmt: skip
        with pytest.raises(ValueError, match="expected one by with time_constant, or a list of them with time"):
            RubClosing.model_validate(given)
    assert RubWhirl(amplitude=1e-6, per_rev=2.0, hz=3.0, phase_deg=4.0).law() == ct.gaps.Whirl(
        amplitude=1e-6, per_rev=2.0, hz=3.0, phase_deg=4.0
    )


def test_laws_of_a_contact_are_coated_sliding_or_neither():
    assert contact_law(0.0, None) == ct.Unilateral()
    assert contact_law(1e-9, None) == ct.Coulomb(mu=1e-9)
    assert contact_law(0.2, None, CoatingTable(**COAT)) == ct.Abradable(**COAT, mu=0.2)
    assert contact_law(0.0, None, CoatingTable(**COAT, bars=2, machined=1e-4)) == ct.Abradable(
        **COAT, bars=2, machined=1e-4, mu=0.0
    )


def test_methods_take_the_numbers_that_are_given_and_their_own_otherwise():
    law, scheme = SchemeTable(kind="newmark", dt=1.0, beta=0.3).method()
    assert (law, scheme) == (ct.Unilateral(), ct.Newmark(beta=0.3))
    law, scheme = SchemeTable(kind="hht", dt=1.0, law="augmented-lagrangian", stiffness=5.0).method()
    assert (law.stiffness, law.updates, scheme) == (5.0, 50, ct.scheme.HHT())
    assert (
        SchemeTable(kind="hht", dt=1.0, law="augmented-lagrangian", stiffness=5.0, updates=3).method()[0].updates == 3
    )
    assert SchemeTable(kind="penalty", dt=1.0, stiffness=5.0).method() == (
        ct.Penalty(stiffness=5.0), ct.PenaltyDifference()
    )  # fmt: skip
    assert SchemeTable(kind="exact-modal", law="forward").method()[1] == ct.ExactModal(law="forward")
    assert SchemeTable(kind="exact-modal", modes=7).method()[1] == ct.ExactModal(modes=7)


def test_bodies_of_a_rim_are_detuned_and_retuned_only_where_asked(tmp_path):
    ring().save(tmp_path / "casing.npz")
    blade().save(tmp_path / "blade.npz")
    omega = ring().omega
    assert CasingTable(basis="casing.npz", seed=5).body(tmp_path).omega.tolist() == omega.tolist()
    found = CasingTable(basis="casing.npz", scatter=0.01, seed=5).body(tmp_path).omega
    assert found.tolist() == ring().detuned(0.01, seed=5).omega.tolist()
    assert found.tolist() != omega.tolist()
    assert BladeTable(basis="blade.npz").body(tmp_path).omega.tolist() == blade().omega.tolist()
    retuned = BladeTable(basis="blade.npz", freq_hz=150.0).body(tmp_path)
    assert retuned.omega[0] == pytest.approx(300.0 * math.pi, rel=1e-12)


def test_a_patch_of_the_file_has_its_loads_and_what_they_press():
    S = [[1e-3, 2e-4], [2e-4, 3e-3]]
    table = PatchBodyTable(
        omega=[3.0, 0.0], channels=["x", "y"], rows=[[1.0, 2.0], [3.0, -4.0]], S=S, load={"x": 5.0, "y": -2.0}
    )
    body = table.modes(None)
    assert (body.zeta.tolist(), body.S.tolist()) == ([0.0, 0.0], S)
    assert table.modal_load(body).tolist() == [5.0 - 6.0, 10.0 + 8.0]
    assert table.pressed(body, ["y", "x"]) == pytest.approx([5.0 * 2e-4 - 2.0 * 3e-3, 5e-3 - 4e-4], rel=1e-13)
    bare = PatchBodyTable(omega=[3.0], channels=["x"], rows=[[1.0]], zeta=[0.1])
    assert bare.modes(None).S.tolist() == [[0.0]]
    assert bare.modes(None).zeta.tolist() == [0.1]
    assert bare.pressed(bare.modes(None), ["x"]).tolist() == [0.0]
    for name, more in (("rows", {"rows": [[1.0], [1.0, 2.0]]}), ("S", {"S": [[1.0], [1.0, 2.0]]})):
        ragged = PatchBodyTable(**{"omega": [3.0], "channels": ["x"], "rows": [[1.0]]} | more)
        with pytest.raises(ct.InputError, match=f"{name}: found rows of different lengths"):
            ragged.modes(None)


def patch_file(contacts, friction=0.0):
    body = {"omega": [3.0], "channels": ["x", "y"], "rows": [[1.0], [2.0]]}
    return PatchFile.model_validate({
        "scene": {"kind": "patch", "t_end": 1.0}, "body": body, "contact": contacts, "ground": {"friction": friction},
        "scheme": {"kind": "exact-modal", "dt": 0.1},
    })  # fmt: skip


def test_contacts_of_a_patch_have_tangents_and_slides_all_or_none():
    with_slide = patch_file([{"normal": "y", "tangent": ["x"], "slide": [0.3], "clearance": 0.2}], 0.1).patch(None)
    assert (with_slide.tangent, with_slide.slide.tolist(), with_slide.clearance.tolist()) == ((("x",),), [[0.3]], [0.2])
    assert patch_file([{"normal": "y", "tangent": ["x"]}]).patch(None).slide.tolist() == [[0.0]]
    assert patch_file([{"normal": "y"}, {"normal": "x"}]).patch(None).tangent == ()
    for contacts, friction, words in (
        ([{"normal": "y"}], 0.1, "ground.friction found without tangents"),
        ([{"normal": "y"}, {"normal": "y", "tangent": ["x"]}], 0.0, "different numbers of tangents"),
        ([], 0.0, "at least 1 item"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=words):
            patch_file(contacts, friction)


def test_channels_of_a_record_are_rows_or_a_file_of_them(tmp_path):
    (tmp_path / "channels.csv").write_text("# two\n1,2,3\n4,5,6\n")
    found = RecordTable(state_every=2, channels="channels.csv").record(tmp_path)
    assert (np.asarray(found.channels).tolist(), found.state_every) == ([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], 2)
    (tmp_path / "channels.csv").write_text("1,2,3\n")
    assert np.shape(RecordTable(state_every=2, channels="channels.csv").record(tmp_path).channels) == (1, 3)
    assert np.asarray(RecordTable(at=[0.1], channels=[[1.0]]).record(tmp_path).channels).tolist() == [[1.0]]
    for text in ("1,x\n", None):
        if text is not None:
            (tmp_path / "other.csv").write_text(text)
        with pytest.raises(ct.InputError, match=r"channels: .*, expected (rows of numbers|one)"):
            RecordTable(state_every=2, channels="other.csv" if text else "none.csv").record(tmp_path)


def test_a_disk_kicks_the_cosine_of_its_pair_and_has_no_file():
    pair = {"n": 3, "freq_hz": 200.0, "modal_mass": 2.0, "zeta": 0.01, "radius": 0.3, "kick": -0.7}
    file = DiskFile.model_validate({
        "scene": {"kind": "disk", "t_end": 1.0}, "casing": {"pair": pair}, "speed": {"hz": -4.0},
        "disk": {"blades": 3, "freq_hz": 100.0, "modal_mass": 0.5}, "contact": {"clearance": 1e-4},
        "scheme": {"kind": "exact-modal", "dt": 1e-5},
    })  # fmt: skip
    rub = file.rub(None)
    assert rub.casing_start.velocity.tolist() == [-0.7, 0.0]
    assert (rub.casing.radius, rub.clearance, rub.speed.hz.tolist()[0], len(rub.tips)) == (0.3, 1e-4, -4.0, 3)
    assert rub.casing.omega.tolist() == pytest.approx([400.0 * math.pi] * 2, rel=1e-12)
    assert (file.files(), file.model_copy(update={"casing": DiskCasingTable(basis="b")}).files()) == ([], ["b"])


def test_a_disk_before_a_basis_is_not_kicked(tmp_path):
    rim3().save(tmp_path / "casing.npz")
    file = DiskFile.model_validate({
        "scene": {"kind": "disk", "t_end": 1.0}, "casing": {"basis": "casing.npz"}, "speed": {"hz": 4.0},
        "disk": {"blades": 3, "freq_hz": 100.0, "modal_mass": 0.5}, "contact": {"clearance": 1e-4},
        "scheme": {"kind": "exact-modal", "dt": 1e-5},
    })  # fmt: skip
    rub = file.rub(tmp_path)
    assert not rub.casing_start.velocity.any()
    assert rub.casing_start.velocity.size == 10
