"""Every field of records read from files whose numbers, places and units are known; faults by file and channel."""

import struct
from dataclasses import replace

import numpy as np
import pytest
from scipy.io import savemat

import casingfem as cf

COUNT = 24
PUSH = 0.25 * (np.arange(COUNT) == 5) + 0.125 * (np.arange(COUNT) == 6)
ONE, TWO = (np.round(64 * np.cos(k * np.arange(COUNT) ** 1.3)) / 64 for k in (0.7, 1.9))


def read(path, text=None, channels=None):
    """The only take of a file, and what a table of channels states of it."""
    if text is not None:
        path.write_text(text, encoding="utf-8")
    table = None
    if channels is not None:
        table = path.with_name("channels.csv")
        table.write_text(channels, encoding="utf-8")
    (take,) = cf.frf.read_records(path, channels=table)
    return take


def check(take, path, *, fs, force, responses, at, unit, force_at=(0, 0), force_unit="N"):
    """Compare every field; `at` are point and direction of each response."""
    assert take.name == take.response.path == take.force.path == str(path)
    assert take.fs == pytest.approx(fs, rel=1e-12)
    np.testing.assert_allclose(take.response.x, np.arange(COUNT) / fs, rtol=1e-12)
    np.testing.assert_allclose(take.force.responses, [force], rtol=1e-12)
    np.testing.assert_allclose(take.response.responses, responses, rtol=1e-12)
    assert list(zip(take.response.response_point, take.response.response_direction, strict=True)) == at
    assert (take.force.response_point.tolist(), take.force.response_direction.tolist()) == (
        [force_at[0]],
        [force_at[1]],
    )
    assert (take.response.unit, take.force.unit) == (unit, force_unit)
    assert not take.response.reference_point.any()
    assert not take.force.reference_direction.any()


def table(head, *columns):
    return "\n".join([head, *(",".join(map(repr, row)) for row in np.column_stack(columns).tolist())]) + "\n"


@pytest.mark.parametrize(
    ("head", "scale", "at", "force_at", "factor"),
    [
        ("time [s],force 5 -x [kN],response 12 z [m/s^2],acc 7 -ry [m/s^2]", 1.0, [(12, 3), (7, -5)], (5, -1), 1e3),
        ("t (ms),hammer 3 r (lbf),velocity 4 +y (mm/s),acc 9 r (mm/s)", 1e3, [(4, 2), (9, 0)], (3, 0), 4.4482216152605),
        ("Zeit_ms,shaker_6_rz [dan],acceleration_11:x [g],rim 2 y [g]", 1e3, [(11, 1), (2, 2)], (6, 6), 10.0),
        ("time,top 4 x [N],base 3 z [],side 8 -z", 1.0, [(3, 3), (8, -3)], (4, 1), 1.0),
        ("time,force [N],response [mm],displacement 8 [mm]", 1.0, [(0, 0), (8, 0)], (0, 0), 1.0),
    ],
)  # fmt: skip
def test_a_table_states_time_kind_place_and_unit_in_its_header(head, scale, at, force_at, factor, tmp_path):
    time = (3.0 + np.arange(COUNT)) / 400.0 * scale
    path = tmp_path / "hits.csv"
    take = read(path, table(head, time, PUSH, ONE, TWO))
    unit = head.rpartition(" ")[2].strip("[]()") if head[-1] in "])" else ""
    check(take, path, fs=400.0, force=PUSH * factor, responses=[ONE, TWO], at=at, unit=unit, force_at=force_at)


def test_a_table_of_channels_chooses_channels_by_name_or_number_and_converts_their_numbers(tmp_path):
    path = tmp_path / "hits.csv"
    text = table("time [s],a,b,c,d", np.arange(COUNT) / 50.0, ONE, PUSH, TWO, ONE)
    rows = "c,response,8,-y,mm,-4\n2,Force,5,,kgf,2\n1,response,31,+rx,mm,\n"
    take = read(path, text, "channel,kind,point,direction,unit,factor\n" + rows)
    check(
        take, path, fs=50.0, force=2.0 * 9.80665 * PUSH, responses=[-4.0 * TWO, ONE], at=[(8, -2), (31, 4)], unit="mm",
        force_at=(5, 0),
    )  # fmt: skip


def wave(code, bits, values, *, rate=800, extra=b"", extensible=False, **head):
    """Bytes of a sound file; chunks of odd length are padded, as the format demands."""
    channels = len(values)
    flat = values.T.ravel()
    if code == 3:
        body = flat.astype(f"<f{bits // 8}").tobytes()
    else:
        whole = np.round(flat * 2.0 ** (bits - 1)).astype(np.int64)
        body = b"".join(int(k).to_bytes(bits // 8, "little", signed=True) for k in whole)
    step = channels * bits // 8
    given = {"code": 0xFFFE if extensible else code, "channels": channels, "rate": rate, "step": step, "bits": bits}
    given |= head
    form = struct.pack(
        "<HHIIHH", given["code"], given["channels"], given["rate"], rate * step, given["step"], given["bits"]
    )
    if extensible:
        form += struct.pack("<HHIH", 22, bits, 0, code) + b"\0" * 14
    chunks = extra + b"fmt " + struct.pack("<I", len(form)) + form + b"data" + struct.pack("<I", len(body)) + body
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


ODD = b"note" + struct.pack("<I", 3) + b"abc\0"
THREE = (
    "channel,kind,point,direction,unit,factor\n1,force,6,y,N,8\n2,response,4,-z,m/s,2\nchannel 3,response,4,x,m/s,-3\n"
)


@pytest.mark.parametrize(("code", "bits"), [(1, 16), (1, 24), (1, 32), (3, 32), (3, 64)])
@pytest.mark.parametrize("extensible", [False, True])
def test_a_sound_file_of_any_width_has_fractions_of_full_scale(code, bits, extensible, tmp_path):
    path = tmp_path / "run.wav"
    values = np.array([PUSH, 0.5 * ONE, -0.75 * TWO])
    path.write_bytes(wave(code, bits, values, extra=ODD, extensible=extensible))
    check(
        read(path, channels=THREE), path, fs=800.0, force=8.0 * PUSH, responses=[ONE, 2.25 * TWO],
        at=[(4, -3), (4, 1)], unit="m/s", force_at=(6, 2),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"RIFF\x04\0\0\0WAVE" + ODD, "found no part 'fmt'; expected a WAVE file of 16, 24 or 32 bits"),
        (b"RIFF\x04\0\0\0WAVEfmt \x0f\0\0\0" + b"\0" * 16 + b"data\0\0\0\0", "found 15 bytes of format; expected 16"),
        (wave(1, 16, np.zeros((3, 9)), rate=0), "found 3 channels, 0 Hz, 6 bytes a sample of 16 bits; expected con"),
        (wave(1, 16, np.zeros((3, 9)), step=8), "found 3 channels, 800 Hz, 8 bytes a sample of 16 bits"),
        (wave(1, 16, np.zeros((3, 9)), channels=0, step=0), "found 0 channels, 800 Hz, 0 bytes a sample of 16 bits"),
        (wave(1, 8, np.zeros((3, 9))), "found coding 1 of 8 bits; expected a WAVE file"),
        (wave(3, 16, np.zeros((3, 9)).astype("<f2")), "found coding 3 of 16 bits; expected a WAVE file"),
        (wave(1, 16, np.zeros((3, 0))), "found no samples; expected a record"),
        (wave(1, 16, np.zeros((3, 9)))[:-1], "found 53 bytes in the part 'data'; expected 54, as the file states"),
    ],
)  # fmt: skip
def test_a_sound_file_that_contradicts_itself_is_refused(content, words, tmp_path):
    path = tmp_path / "run.wav"
    path.write_bytes(content)
    with pytest.raises(cf.errors.InputError) as caught:
        read(path, channels=THREE)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


ARRAYS = {
    "hits first": {
        "fs": 250.0, "force": np.array([PUSH, 2.0 * PUSH]), "response": np.array([[ONE, TWO], [TWO, -ONE]]),
        "points": [14, 3], "directions": [2, -3], "force_point": [7, 8], "force_direction": [1, -2], "unit": "mm/s",
        "force_unit": "kN",
    },
    "samples first": {
        "t": (1.0 + np.arange(COUNT)) / 250.0, "hammer": np.array([PUSH, 2.0 * PUSH]).T[:, :],
        "acceleration": np.array([[ONE, TWO], [TWO, -ONE]]), "nodes": [14, 3], "direction": [2, -3],
        "reference": [7, 8], "reference_direction": [1, -2], "units": "mm/s", "force_unit": "kN",
    },
}  # fmt: skip


@pytest.mark.parametrize("name", ARRAYS)
@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_arrays_state_each_hit_with_its_place(name, kind, tmp_path):
    path = tmp_path / f"hits.{kind}"
    np.savez(path, **ARRAYS[name]) if kind == "npz" else savemat(path, ARRAYS[name])
    takes = cf.frf.read_records([path])
    own = [
        replace(take, response=replace(take.response, path="a"), force=replace(take.force, path="a"), name="a")
        for take in takes
    ]
    assert [take.name for take in takes] == [f"{path}, hit 1", f"{path}, hit 2"]
    for take, force, responses, force_at in zip(
        own, (PUSH, 2.0 * PUSH), ([ONE, TWO], [TWO, -ONE]), ((7, 1), (8, -2)), strict=True
    ):
        check(
            take, "a", fs=250.0, force=1e3 * force, responses=responses, at=[(14, 2), (3, -3)], unit="mm/s",
            force_at=force_at,
        )  # fmt: skip


@pytest.mark.parametrize(
    "response", [ONE, ONE[None], ONE[:, None], ONE[None, None]], ids=["row", "1 x n", "n x 1", "1 x 1 x n"]
)
def test_one_channel_of_one_hit_may_have_any_shape(response, tmp_path):
    path = tmp_path / "hit.npz"
    np.savez(path, rate=64.0, force=PUSH, response=response)
    check(read(path), path, fs=64.0, force=PUSH, responses=[ONE], at=[(1, 0)], unit="")


def test_a_long_record_without_forces_has_its_responses_and_card(tmp_path):
    np.savez(tmp_path / "run.npz", fs=64.0, response=np.array([ONE, TWO]), points=[9, 4], directions=[3, -1], unit="g")
    found = cf.frf.read_responses(tmp_path / "run.npz")
    np.testing.assert_array_equal(found.responses, [ONE, TWO])
    np.testing.assert_array_equal(found.x, np.arange(COUNT) / 64.0)
    assert (found.response_point.tolist(), found.response_direction.tolist(), found.unit) == ([9, 4], [3, -1], "g")
    assert found.path == str(tmp_path / "run.npz")
    (tmp_path / "run.csv").write_text(table("time [s],force 1 x [N]", np.arange(COUNT) / 50.0, PUSH))
    with pytest.raises(cf.errors.InputError, match="found no response; expected channels of responses"):
        cf.frf.read_responses(tmp_path / "run.csv")
    np.savez(tmp_path / "hits.npz", fs=64.0, force=np.array([PUSH, PUSH]), response=np.ones((2, 1, COUNT)))
    with pytest.raises(cf.errors.InputError, match="found 2 records; expected one record: join the records"):
        cf.frf.read_responses(tmp_path / "hits.npz")


def functions(**changes):
    """A force and two responses of a universal file in milliseconds; `changes` of each by its number."""
    axis = cf.uff.Axis(17, label="time", unit="ms")
    found = []
    for k, (values, node, direction, unit) in enumerate(((PUSH, 3, -1, "kN"), (ONE, 8, 2, "g"), (TWO, 6, -3, "g"))):
        whole = cf.frf.FrfSet.from_arrays(
            kind="time", x=1e3 * (5.0 + np.arange(COUNT) / 128.0), responses=[values], unit=unit, response_point=node,
            response_direction=direction,
        ).functions()[0]  # fmt: skip
        whole = replace(whole, axes=cf.uff.Axes(axis, cf.uff.Axis(label="response", unit=unit)))
        found.append(changes.get(f"at_{k}", lambda one: one)(whole))
    return found


def test_a_universal_file_states_place_and_unit_of_each_function(tmp_path):
    path = cf.uff.write_uff(tmp_path / "hit.uff", header=["a test", "of a rim"], functions=functions(), binary=True)
    take = read(path)
    check(
        take, path, fs=128.0, force=1e3 * PUSH, responses=[ONE, TWO], at=[(8, 2), (6, -3)], unit="g", force_at=(3, -1)
    )
    assert take.response.card[:2] == ("a test", "of a rim")


def test_a_roving_sensor_has_another_channel_in_each_hit(tmp_path):
    """A function that repeats a channel begins a hit; the hits are not sorted by channel, which are unequal."""
    force, one, two = functions()
    path = cf.uff.write_uff(tmp_path / "hits.uff", functions=[force, one, force, two], binary=True)
    takes = cf.frf.read_records(path)
    assert [take.response.response_point.tolist() for take in takes] == [[8], [6]]
    np.testing.assert_allclose(takes[1].response.responses[0], TWO, rtol=1e-6)


@pytest.mark.parametrize(("kind", "unit", "taken"), [(0, "ms", True), (0, "h", False), (1, "ms", True)])
def test_a_real_function_of_no_stated_kind_over_time_is_a_record(kind, unit, taken, tmp_path):
    path = tmp_path / "hit.uff"
    given = {f"at_{k}": lambda one: replace(abscissa(unit=unit)(one), kind=kind) for k in range(3)}
    cf.uff.write_uff(path, functions=functions(**given), binary=True)
    if taken:
        (take,) = cf.frf.read_records(path)
        assert take.fs == pytest.approx(128.0)
    else:
        with pytest.raises(cf.errors.InputError, match="expected times in s"):
            cf.frf.read_records(path)
    other = {f"at_{k}": lambda one: abscissa(kind=18, label="frequency")(replace(one, kind=0)) for k in range(3)}
    cf.uff.write_uff(path, functions=functions(**other), binary=True)
    with pytest.raises(cf.errors.InputError, match="expected time records"):
        cf.frf.read_records(path)


@pytest.mark.parametrize(
    ("faster", "words"),
    [
        (0, "function 2 at 128 samples a second, function 1 at 256"),
        (1, "function 2 at 256 samples a second, function 1 at 128"),
    ],
)
def test_a_channel_of_a_higher_or_a_lower_rate_is_refused(faster, words, tmp_path):
    def fast(one):
        return replace(one, x=one.x[0] + 0.5 * (one.x - one.x[0]), step=0.5 * one.step)

    path = cf.uff.write_uff(tmp_path / "hit.uff", functions=functions(**{f"at_{faster}": fast}), binary=True)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.read_records(path)


def abscissa(**changes):
    return lambda one: replace(one, axes=one.axes._replace(abscissa=one.axes.abscissa._replace(**changes)))


def uneven(one):
    return replace(one, x=one.x + 3.0 * (np.arange(COUNT) == 7), step=0.0)


def later(one, by=2.0):
    return replace(one, x=one.x + by)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"at_1": abscissa(unit="h")}, "found function 2 over 24 points in 'h'; expected times in s"),
        ({"at_2": uneven}, "found uneven times in function 3; expected even steps: export as sampled"),
        ({"at_2": later}, "found 24 samples from 5002 s in function 3; expected 24 from 5000 s, as function 1 has"),
        ({"at_2": lambda one: later(one, -2.0)}, "found 24 samples from 4998 s in function 3; expected 24 from 5000 s"),
        ({"at_0": lambda one: replace(one, kind=12, values=one.values + 0j)}, "found no channel of a force among f"),
        ({f"at_{k}": lambda one: replace(one, kind=4, values=one.values + 0j) for k in range(3)},
         "expected time records (set 58, function type 1)"),
    ],
)  # fmt: skip
def test_functions_that_are_no_records_are_refused(changes, words, tmp_path):
    path = cf.uff.write_uff(tmp_path / "hit.uff", functions=functions(**changes), binary=True)
    with pytest.raises(cf.errors.InputError) as caught:
        cf.frf.read_records(path)
    assert words in str(caught.value)


def test_hits_whose_channels_are_counted_differently_are_refused(tmp_path):
    force, one, two = functions()
    path = cf.uff.write_uff(tmp_path / "hits.uff", functions=[force, force, one, two, two], binary=True)
    with pytest.raises(
        cf.errors.InputError, match="records: 2 of force 3, 1 of response 8, 2 of response 6; expected eq"
    ):
        cf.frf.read_records(path)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("channel,kind,point,unit,colour\n1,force,7,N,red\n", "column 'colour': found an unknown column; expec"),
        ("channel,kind,point\n1,force,7\n", "column 'unit': found no such column; expected channel,kind"),
        ("channel,kind,point,direction,unit\n1,force,7,up,N\n", "column 'direction': found 'up'; expected x, y"),
        ("channel,kind,point,direction,unit\n1,force,7,-r,N\n", "column 'direction': found '-r'"),
        ("channel,kind,point,unit,factor\n1,force,7,N,0\n", "column 'factor': found 0; expected another number"),
        ("channel,kind,point,unit\n,force,7,N\n", "column 'channel': found"),
        ("channel,kind,point,unit\na,force,7,N\n1,response,7,m\n", "found one channel twice in"),
        ("channel,kind,point,unit\n1,push,7,N\n", "column 'kind': found 'push'; expected force or response"),
        ("channel,kind,point,unit\n1,force,7,N\n1,response,8,m\n",
         "column 'channel': found '1'; expected each channel once"),
        ("channel,kind,point,unit\n1,force,7,N\n15,response,8,m\n", "found channel 15 of"),
        ("channel,kind,point,unit\n0,force,7,N\n", "found channel 0 of"),
        ("channel,kind,point,unit\nx,force,7,N\n", "expected one of a, b, c, d, e, f, g, h (9 in all), each once"),
        ("channel,kind,point,unit\n1,force,7,furlong\n2,response,7,m\n", "csv, 1: found the unit 'furlong'"),
        ("channel,kind,point,unit\n1,force,7,N\n2,response,7,m\n3,response,7,mm\n", "found responses in m and mm"),
        ("channel,kind,point,unit\n1,force,7,N\n2,response,7,(inch)/(sec)/(sec)\n",
         "found the unit '(inch)/(sec)/(sec)'; expected at most 12 letters, such as m/s^2: state it with --channels"),
        ("channel,kind,point,unit\n1,force,7,N\n2,response,7,m/s/s/(1234)\n", "csv, 2: found the unit 'm/s/s/(1234)'"),
    ],
)  # fmt: skip
def test_a_table_of_channels_is_refused_by_column_and_value(rows, words, tmp_path):
    head = "time [s]," + ",".join("abcdefghi")
    text = table(head, np.arange(COUNT) / 50.0, *[PUSH + k for k in range(9)])
    with pytest.raises(cf.errors.InputError) as caught:
        read(tmp_path / "hits.csv", text, rows)
    assert words in str(caught.value)


def test_records_of_other_channels_or_units_are_not_averaged(tmp_path):
    def take(unit, point, force="N"):
        return read(
            tmp_path / f"{point}.csv",
            table(f"time [s],force 5 x [{force}],response {point} z [{unit}]", np.arange(COUNT) / 50.0, PUSH, ONE),
        )

    for other, words in (
        (take("mm", 7), r"7\.csv: found the unit 'mm', .*6\.csv has 'm'; expected one unit"),
        (take("m", 7), r"7\.csv: found responses at points 7, .*6\.csv has 6; expected the same channels"),
        (take("m", 7, force="V"), r"7\.csv: found the unit 'V', .*6\.csv has 'N'; expected one unit"),
    ):
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.estimate([take("m", 6), other], test="hammer")
