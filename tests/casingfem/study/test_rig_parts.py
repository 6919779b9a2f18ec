"""[rig] of a study, key by key: lines, forces, probes, records and the scan are those that its tables name."""

import numpy as np
import pytest

import casingfem as cf
from casingfem.experiment.rig.estimate import estimate
from casingfem.experiment.rig.record import measured
from casingfem.study.rig import (
    Layout,
    circle_of,
    excitation,
    laid_out,
    lines_of,
    place_of,
    responses,
    run_rig,
    scanned,
    sensors_of,
    troubled_test,
)
from casingfem.study.tables.rig import PlaceTable, ResponsesTable, RigTable, SensorTable
from tests.casingfem.study.study_texts import STEEL_PLATE, THIN, written

ANGLES = np.radians([17.0, *(30.0 + 72.0 * np.arange(5))])
RIG = cf.rig.Rig.of(
    omega=2.0 * np.pi * np.array([40.0, 90.0]), zeta=[0.02, 0.03], rows=np.random.default_rng(2).normal(size=(6, 2)),
    probes=[cf.rig.Probe(k + 1, 1, (0.0, 0.0, 0.0), float(a)) for k, a in enumerate(ANGLES)],
)  # fmt: skip
LAYOUT = Layout(drives=range(1), sensors=range(1, 3), circle=range(1, 6))
TEST = {"kind": "exact", "band_hz": [20.0, 100.0], "resolution_hz": 0.5}
SCAN = {"height": 0.1, "tones_hz": [41.0, 53.0], "seconds": 0.5, "fs": 400.0, "orders": 1, "mirror_hz": 3.0}


def rig_table(**keys):
    return RigTable(**{"seed": 70, "zeta": 0.01, "drive": [{"height": 0.1}], "quantity": "mobility", **keys})


def answers(**keys):
    return responses(RIG, rig_table(), ResponsesTable(**TEST | keys), LAYOUT, ("a card",))


@pytest.mark.parametrize(
    ("band", "step", "lines"),
    [
        ([10.0, 11.0], 0.25, [10.0, 10.25, 10.5, 10.75, 11.0]),
        ([10.0, 11.0], 0.3, [10.0, 10.3, 10.6, 10.9]),
        ([0.1, 0.7], 0.1, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
    ],
)
def test_lines_go_from_one_end_of_the_band_to_the_other(band, step, lines):
    test = ResponsesTable(kind="exact", band_hz=band, resolution_hz=step)
    np.testing.assert_allclose(lines_of(test), lines, rtol=1e-14)


BAND = (18.0, 110.0)  # a tenth beyond both ends


@pytest.mark.parametrize(
    ("keys", "force"),
    [
        ({"kind": "random", "force": 3.0}, cf.rig.Random(rms=3.0, band=BAND)),
        ({"kind": "burst-random", "force": 2.0, "part": 0.3}, cf.rig.BurstRandom(rms=2.0, band=BAND, part=0.3)),
        ({"kind": "impact", "force": 5.0}, cf.rig.Impact(peak=5.0, width=0.01)),
        ({"kind": "impact", "width": 0.004}, cf.rig.Impact(peak=1.0, width=0.004)),
    ],
)
def test_the_force_of_a_test(keys, force):
    assert excitation(ResponsesTable(**TEST | keys)) == force


def test_exact_responses_are_those_of_the_rig_and_noise_has_its_own_seed():
    exact = RIG.frfs(20.0 + 0.5 * np.arange(161), sensors=[1, 2], drives=[0], quantity="mobility", card=("a card",))
    frfs, coherence, records = answers()
    assert (coherence, records, frfs.card) == (None, (), exact.card)
    np.testing.assert_array_equal(frfs.responses, exact.responses)
    assert frfs.unit == "(m/s)/N"
    np.testing.assert_array_equal(answers(snr_db=30.0)[0].responses, cf.rig.noisy(exact, 30.0, seed=71).responses)


# 2.56 times 110 Hz over 4 Hz are 70 lines, which 128 samples hold: 512 Hz
@pytest.mark.parametrize(
    ("kind", "force", "block", "window", "overlap"),
    [
        ("random", cf.rig.Random(rms=2.0, band=BAND), 128, "hann", 0.5),
        ("burst-random", cf.rig.BurstRandom(rms=2.0, band=BAND, part=0.4), 128, "rectangular", 0.0),
    ],
)
def test_responses_from_records(kind, force, block, window, overlap):
    frfs, coherence, kept = answers(kind=kind, force=2.0, resolution_hz=4.0, blocks=3, snr_db=40.0, bits=12)
    clean = cf.rig.record(RIG, [force], drives=[0], sensors=[1, 2], fs=4.0 * block, block=block, blocks=3, seed=70,
                   quantity="mobility", card=("a card",))  # fmt: skip
    taken = measured(clean, seed=71, snr_db=40.0, bits=12)
    found = estimate(taken, window=window, overlap=overlap, band=(20.0, 100.0))
    np.testing.assert_array_equal(frfs.responses, found.frfs.responses)
    np.testing.assert_array_equal(coherence.responses, found.coherence.responses)
    assert (frfs.x[0], frfs.x[-1], kept) == (20.0, 100.0, ())


def test_records_are_kept_where_they_are_asked_for():
    more = {"kind": "random", "resolution_hz": 4.0, "blocks": 2, "keep_records": True}
    first, _, kept = answers(**more)
    assert [len(part) for part in kept] == [2, 1]
    assert [part.x.size for part in kept] == [256, 256]
    assert kept[0].x[1] == pytest.approx(1.0 / 512.0, rel=1e-12)
    other, _, _ = answers(**more, estimator="H2")
    assert not np.allclose(first.responses, other.responses)


def test_troubles_are_those_of_the_table():
    test = ResponsesTable(**TEST, snr_db=30.0, troubles={"flipped": 1, "shift": 0.01, "setups": 2})
    found = troubled_test(RIG, rig_table(), test, LAYOUT, ("a card",))
    what = cf.rig.Troubles(snr_db=30.0, flipped=1, shift=0.01, setups=2)
    lines = 20.0 + 0.5 * np.arange(161)
    same = cf.rig.troubled_frfs(
        RIG, lines, what, sensors=[1, 2], drives=[0], seed=71, quantity="mobility", card=("a card",)
    )
    np.testing.assert_array_equal(found.frfs.responses, same.frfs.responses)
    assert troubled_test(RIG, rig_table(), ResponsesTable(**TEST, snr_db=30.0), LAYOUT, ()) is None


@pytest.mark.parametrize("space", [False, True])
def test_the_scan_of_a_table(space):
    more = {"casing_hz": 0.5, "force": 2.0, "snr_db": 20.0, "speckle": 0.1, "runout": [[0.2, 0.3]]}
    table = rig_table(scan=SCAN | more | {"fixed_in": "space" if space else "casing"})
    found = scanned(RIG, table, table.scan, LAYOUT, ("a card",))
    turn = cf.rig.Turning(mirror=3.0, casing=0.5, speckle=0.1, runout=((0.2, 0.3),))
    drive = {"drive_circle": range(1, 6), "drive_angle": np.radians(17.0), "highest": 1} if space else {"drive": 0}
    same = cf.rig.scan(
        RIG,
        turn,
        [cf.rig.Tone(41.0, 2.0), cf.rig.Tone(53.0, 2.0)],
        circle=range(1, 6),
        fs=400.0,
        seconds=0.5,
        seed=72,
        snr_db=20.0,
        card=("a card",),
        **drive,
    )
    np.testing.assert_array_equal(found.record.velocity, same.record.velocity)
    np.testing.assert_array_equal(found.V, same.V)


def test_a_scan_is_driven_by_the_drive_of_its_number():
    table = rig_table(scan=SCAN | {"drive": 2})
    layout = Layout(drives=range(4, 6), sensors=range(0), circle=range(1, 6))
    found = scanned(RIG, table, table.scan, layout, ())
    same = cf.rig.scan(
        RIG,
        cf.rig.Turning(mirror=3.0),
        [cf.rig.Tone(41.0, 1.0), cf.rig.Tone(53.0, 1.0)],
        circle=range(1, 6),
        drive=5,
        fs=400.0,
        seconds=0.5,
        seed=72,
    )
    np.testing.assert_array_equal(found.V, same.V)


@pytest.mark.parametrize(
    ("sensors", "labels"),
    [
        ([{"count": 3}], True),
        ([{"count": 2}], False),
        ([{"count": 9, "direction": "hoop"}], False),
        ([{"count": 9}, {}], False),
        ([], False),
    ],
)
def test_only_a_whole_radial_circle_labels_the_truth(sensors, labels):
    table = rig_table(sensor=[{"height": 0.1, **sensor} for sensor in sensors])
    assert circle_of(table, LAYOUT) == (LAYOUT.sensors if labels else range(0))


@pytest.fixture
def casing(tmp_path):
    return cf.load_study(written(tmp_path, THIN + '[support.base]\nkind = "clamped"\n'))


@pytest.fixture
def plate(tmp_path):
    return cf.load_study(written(tmp_path, STEEL_PLATE))


def test_places_of_a_casing_and_of_a_plate(casing, plate):
    table = PlaceTable(height=0.1, angle_deg=-90.0, direction="hoop", mass=0.02)
    assert place_of(casing, "drive[1]", table, True) == cf.rig.Place(
        at=(0.1, -0.5 * np.pi), direction="hoop", mass=0.02
    )
    table = PlaceTable(at=[0.1, 0.2], direction="normal", mass=0.02)
    assert place_of(plate, "drive[1]", table, False) == cf.rig.Place(at=(0.1, 0.2), direction="normal", mass=0.02)
    with pytest.raises(
        cf.errors.InputError, match=r"rig.drive\[1\].height: found an open chart, expected at = \[a, b\]"
    ):
        place_of(plate, "drive[1]", PlaceTable(height=0.1), False)


def test_sensors_are_one_or_a_circle_of_them(casing, plate):
    table = SensorTable(height=0.1, angle_deg=90.0, direction="hoop", mass=0.02, count=2)
    found = sensors_of(casing, "sensor[1]", table, True)
    assert [(place.direction, place.mass) for place in found] == [("hoop", 0.02)] * 2
    np.testing.assert_allclose([place.at for place in found], [(0.1, 0.5 * np.pi), (0.1, 1.5 * np.pi)], rtol=1e-14)
    assert len(sensors_of(plate, "sensor[1]", SensorTable(at=[0.1, 0.0]), False)) == 1
    with pytest.raises(cf.errors.InputError, match=r"rig.sensor\[1\].count: found 2, expected 1 on an open chart"):
        sensors_of(plate, "sensor[1]", SensorTable(at=[0.1, 0.0], count=2), False)


def test_probes_are_drives_then_sensors_then_the_circle_of_the_scan(casing, plate):
    sensors = [{"height": 0.12, "count": 3}, {"height": 0.13}]
    scanning = SCAN | {"height": 0.2, "orders": 2}
    table = rig_table(drive=[{"height": 0.1}, {"height": 0.11}], sensor=sensors, scan=scanning)
    places, layout = laid_out(casing, table)
    assert layout == Layout(drives=range(2), sensors=range(2, 6), circle=range(6, 13))
    assert [place.at[0] for place in places] == [0.1, 0.11, 0.12, 0.12, 0.12, 0.13] + [0.2] * 7
    assert len(laid_out(casing, rig_table(scan=SCAN | {"points": 4}))[1].circle) == 4
    places, layout = laid_out(casing, rig_table())
    assert (len(places), layout) == (1, Layout(drives=range(1), sensors=range(1, 1), circle=range(1, 1)))
    with pytest.raises(cf.errors.InputError, match=r"rig\.scan: found an open chart, expected a closed casing"):
        laid_out(plate, rig_table(drive=[{"at": [0.1, 0.0]}], scan=SCAN))


ON_PLATE = """[modes]
count = 2
[rig]
seed = 3
zeta = 0.002
[[rig.drive]]
at = [0.2, 0.0]
direction = "normal"
"""


def test_a_rig_of_drives_alone_has_its_truth(tmp_path):
    test = run_rig(cf.load_study(written(tmp_path, STEEL_PLATE + ON_PLATE)))
    assert (test.frfs, test.coherence, test.records, test.scan, test.waves, test.troubles) == (
        None,
        None,
        (),
        *[None] * 3,
    )
    np.testing.assert_array_equal(test.rig.zeta, [0.002, 0.002])
    assert (test.layout.drives, len(test.layout.sensors), test.truth.n.tolist()) == (range(1), 0, [-1, -1])


def test_dampings_are_spread_with_a_seed_of_their_own(tmp_path):
    test = run_rig(cf.load_study(written(tmp_path, STEEL_PLATE + ON_PLATE.replace("zeta", "zeta_spread = 0.3\nzeta"))))
    drawn = np.random.default_rng(6).standard_normal(2)
    np.testing.assert_allclose(test.rig.zeta, 0.002 * np.exp(0.3 * drawn), rtol=1e-12)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('[rig.test]\nkind = "exact"\nband_hz = [1.0, 2.0]\nresolution_hz = 0.5\n', "rig.sensor: found nothing"),
        ("[rig.scan]\nheight = 0.1\ntones_hz = [9.0]\nseconds = 1.0\nfs = 99.0\norders = 1\ndrive = 2\n",
         r"rig.scan.drive: found 2, expected 1 to 1, a \[\[rig.drive\]\]"),
        ("", r"rig: .*off the surface"),
    ],
)  # fmt: skip
def test_a_rig_that_cannot_be_is_refused_by_key(tmp_path, more, words):
    text = STEEL_PLATE + (ON_PLATE + more if more else ON_PLATE.replace("0.2,", "0.3,"))
    with pytest.raises(cf.errors.InputError, match=words) as caught:
        run_rig(cf.load_study(written(tmp_path, text)))
    assert all(line.startswith(f"{tmp_path / 'study.toml'}: rig") for line in caught.value.problems)
