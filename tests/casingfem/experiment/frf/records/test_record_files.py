"""Records of every kind of file give the same responses; files that state too little are refused in plain words."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.io import savemat, wavfile

import casingfem as cf

FS, BLOCK = 1024.0, 1024
RIG = cf.rig.Rig.of(
    omega=2.0 * np.pi * np.array([61.0, 147.3]), zeta=[0.02, 0.012], rows=[[1.0, 0.4], [-0.4, 0.9]],
    probes=[cf.rig.Probe(7, 3, (0.0, 0.0, 0.0), 0.0), cf.rig.Probe(9, -3, (1.0, 0.0, 0.0), 0.0)],
)  # fmt: skip
TAP = cf.rig.Impact(peak=40.0, width=6e-3, delay=0.05)


@pytest.fixture(scope="module")
def take():
    return cf.rig.record(RIG, [TAP], drives=[0], sensors=[0, 1], fs=FS, block=BLOCK, blocks=3, seed=1).take()


@pytest.fixture(scope="module")
def wanted(take):
    return cf.frf.estimate(take)


def functions(take, hits=None):
    """Functions of a universal file, those of each hit after one another, forces first."""
    found = []
    for start in (0,) if hits is None else range(0, hits * BLOCK, BLOCK):
        for part in (take.force, take.response):
            stop = None if hits is None else start + BLOCK
            x = part.x[: None if hits is None else BLOCK]
            own = replace(part, x=x, responses=part.responses[:, start:stop])
            for f in own.functions():
                found.append(replace(f, axes=f.axes._replace(ordinate=cf.uff.Axis(unit=part.unit))))
    return found


def csv_of(take):
    rows = np.vstack([take.force.x, take.force.responses, take.response.responses]).T
    head = "time [s],force 7 z [N],response 7 z [m/s^2],response 9 -z [m/s^2]"
    return "\n".join([head, *(",".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def written(kind, take, folder):
    """The file of a kind, and the table of its channels where it needs one."""
    path, table = folder / f"records.{kind}", None
    force, response = take.force.responses, take.response.responses
    if kind == "uff":
        cf.uff.write_uff(path, functions=functions(take), binary=True)
    elif kind == "csv":
        path.write_text(csv_of(take))
    elif kind in ("npz", "mat"):
        arrays = {
            "fs": FS, "force": force[0], "response": response, "points": [7, 9], "directions": [3, -3],
            "force_point": 7, "force_direction": 3, "unit": "m/s^2",
        }  # fmt: skip
        if kind == "npz":
            np.savez(path, **arrays)
        else:
            savemat(path, arrays)
    else:
        full = [50.0, *[float(2.0 * np.abs(response).max())] * 2]
        values = np.vstack([force, response]) / np.array(full)[:, None]
        wavfile.write(path, int(FS), np.round(values.T * 2.0**31).astype(np.int32))
        table = folder / "channels.csv"
        kinds = [("force", 7, "z", "N"), ("response", 7, "z", "m/s^2"), ("response", 9, "-z", "m/s^2")]
        lines = [f"{k + 1},{a},{b},{c},{d},{full[k]!r}" for k, (a, b, c, d) in enumerate(kinds)]
        table.write_text("\n".join(["channel,kind,point,direction,unit,factor", *lines]) + "\n")
    return path, table


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["uff", "csv", "npz", "mat", "wav"])
def test_every_kind_of_file_gives_the_same_responses(kind, take, wanted, tmp_path):
    path, table = written(kind, take, tmp_path)
    found = cf.frf.estimate(cf.frf.read_records(path, channels=table))
    for name in ("response_point", "response_direction", "reference_point", "reference_direction"):
        assert getattr(found.frfs, name).tolist() == getattr(wanted.frfs, name).tolist(), name
    assert found.frfs.unit == "(m/s^2)/N"
    scale = np.abs(wanted.frfs.responses).max()
    np.testing.assert_allclose(found.frfs.responses, wanted.frfs.responses, atol=3e-6 * scale)


@pytest.mark.slow
def test_hits_in_records_of_their_own_are_put_together_in_either_order(take, tmp_path):
    by_hit = functions(take, hits=3)
    by_channel = [by_hit[3 * hit + channel] for channel in range(3) for hit in range(3)]
    found = []
    for name, order in (("hits", by_hit), ("channels", by_channel)):
        path = cf.uff.write_uff(tmp_path / f"{name}.uff", functions=order, binary=True)
        found.append(cf.frf.estimate(cf.frf.read_records(path)))
    assert [len(each.hits) for each in found] == [3, 3]
    np.testing.assert_array_equal(found[0].frfs.responses, found[1].frfs.responses)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda f: f[1:], "no channel of a force among function 1"),
        (lambda f: f[:1], "no response among function 1"),
        (
            lambda f: [f[0], replace(f[1], x=2.0 * f[1].x, step=2.0 * f[1].step)],
            "function 2 at 512 samples a second, function 1 at 1024",
        ),
        (lambda f: [f[0], replace(f[1], x=f[1].x[:900], values=f[1].values[:900])], "900 samples from 0 s"),
        (
            lambda f: [replace(f[0], axes=f[0].axes._replace(ordinate=cf.uff.Axis())), *f[1:]],
            "state them with --channels",
        ),
        (
            lambda f: [*f[:2], replace(f[2], axes=f[2].axes._replace(ordinate=cf.uff.Axis(unit="m/s")))],
            "expected one unit",
        ),
        (lambda f: [replace(each, kind=4, values=each.values + 0j) for each in f], "expected time records"),
    ],
)
def test_universal_files_that_state_too_little_are_refused(change, words, take, tmp_path):
    path = cf.uff.write_uff(tmp_path / "records.uff", functions=change(functions(take)), binary=True)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.read_records(path)


def test_a_fault_names_the_record_where_a_file_has_several(take, tmp_path):
    def slow(function):
        return replace(function, x=2.0 * function.x, step=2.0 * function.step)

    one, two = functions(take)[:2], functions(take, 2)
    width = len(two) // 2
    for given, name in (([one[0], slow(one[1])], "u.uff: "), ([*two[:-1], slow(two[-1])], "u.uff, record 2: ")):
        path = cf.uff.write_uff(tmp_path / "u.uff", functions=given, binary=True)
        at = 2 if given[0] is one[0] else width
        with pytest.raises(cf.errors.InputError, match=f"{name}found function {at} at 512 samples a second"):
            cf.frf.read_records(path)


def test_responses_without_a_unit_give_responses_without_one(take, tmp_path):
    bare = [
        f if k == 0 else replace(f, axes=f.axes._replace(ordinate=cf.uff.Axis())) for k, f in enumerate(functions(take))
    ]
    path = cf.uff.write_uff(tmp_path / "records.uff", functions=bare, binary=True)
    found = cf.frf.estimate(cf.frf.read_records(path))
    assert found.frfs.unit == ""
    assert any("no unit" in note for note in found.notes)


def test_a_record_of_a_day_is_refused_before_it_is_read(tmp_path):
    for name in ("day.uff", "day.wav", "day.csv"):
        with (tmp_path / name).open("wb") as file:
            file.truncate(11_059_200_000)  # 24 h of eight channels of two bytes at 8 kHz; nothing is on the disk
        with pytest.raises(
            cf.errors.InputError, match=r"found 11059\.2 MB; expected at most 500 MB: cut the record to the test"
        ):
            cf.frf.read_records(tmp_path / name)


def test_sound_files_are_whole_and_need_a_table_of_channels(take, tmp_path):
    path, table = written("wav", take, tmp_path)
    with pytest.raises(
        cf.errors.InputError, match="3 channels of a sound file without units; expected a table of channels"
    ):
        cf.frf.read_records(path)
    data = path.read_bytes()
    for bad, words in ((data[:-8], "it is cut short"), (b"RIFX" + data[4:], "expected a WAVE file"),
                       (data[:20] + b"\x55" + data[21:], "coding 85 of 32 bits")):  # fmt: skip
        path.write_bytes(bad)
        with pytest.raises(cf.errors.InputError, match=words):
            cf.frf.read_records(path, channels=table)
    for bits, values in ((16, np.int16), (32, np.float32)):
        wavfile.write(path, 1000, (np.linspace(-0.5, 0.5, 99) * (2.0**15 if bits == 16 else 1.0)).astype(values))
        (tmp_path / "one.csv").write_text("channel,kind,point,unit\n1,force,1,N\n")
        with pytest.raises(cf.errors.InputError, match="no response"):
            cf.frf.read_records(path, channels=tmp_path / "one.csv")


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.csv", "force [N],response [m]\n1,2\n", "a column of times first"),
        ("b.csv", "time [s],force [N],response [m]\n0,1,2\n0.1,1,2\n0.9,1,2\n", "expected even steps"),
        ("c.csv", "time [h],force [N],response [m]\n0,1,2\n", "expected s or ms"),
        ("d.csv", "time [s],force [N],response [m]\n0,1,2\n", "found 1 rows; expected times that ascend"),
        ("e.csv", "time [s],force [N],response [m]\n0.1,1,2\n0.1,1,2\n", "found 2 rows; expected times that ascend"),
        ("d.txt", "", "ending '.txt'"),
    ],
)
def test_tables_of_records_are_refused_with_line_or_column(name, content, words, tmp_path):
    (tmp_path / name).write_text(content)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.read_records(tmp_path / name)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"fs": 1e3, "force": np.zeros(40)}, "arrays force, fs"),
        ({"fs": 1e3, "force": np.zeros(40), "response": np.zeros((2, 41))}, r"response \(2, 41\) for 1 hit of 40"),
        ({"fs": -1.0, "force": np.zeros(40), "response": np.zeros(40)}, "-1 samples a second"),
        ({"fs": 1e3, "rate": 1.0, "force": np.zeros(40), "response": np.zeros(40)}, "fs and rate for fs"),
        ({"time": np.r_[0.0:39.0, 99.0], "force": np.zeros(40), "response": np.zeros(40)}, "uneven times"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.zeros(40), "unit": ["m", "s"]}, "2 entries in unit"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.zeros(40), "points": [1, 2]}, "2 numbers in points"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.full(40, 1e300)}, "numbers up to 1e"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.zeros(40), "unit": "furlong per fortnight"}, "the unit"),
        ({"fs": 1e3, "force": np.full(40, np.nan), "response": np.zeros(40)}, "nan or infinity in force"),
        ({"fs": "1e3", "force": np.ones(40), "response": np.zeros(40)}, "fs of type <U3; expected real numbers"),
        ({"fs": 1e3, "force": np.ones(40) + 0j, "response": np.zeros(40)}, "force of type complex128; expected real"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.full(40, "0")}, "response of type <U1; expected real"),
        ({"fs": np.nan, "force": np.ones(40), "response": np.zeros(40)}, "nan samples a second"),
        ({"fs": 1e3, "force": np.ones(40), "response": np.zeros(40), "points": 1.5}, "1 numbers in points"),
        ({"time": np.arange(39.0), "force": np.ones(40), "response": np.zeros(40)}, "39 times for 40 samples"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(arrays, words, tmp_path):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.read_records(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("time [s],force 1 x [g],response 2 x [m/s^2]", r"force 1 x \[g\]: found the unit 'g'; expected N"),
        ("time [s],force 1 x [N],response 2 x [furlong]", "found the unit 'furlong'; expected a unit of a motion"),
        (
            "time [s],force 1 x [N],response 2 q [m/s^2]",
            "found no point or direction; expected word, point and direction",
        ),
        ("time [s],force 1 -r [N],response 2 r [m/s^2]", "found no point or direction"),
    ],
)
def test_a_table_of_records_states_points_directions_and_units_of_force_and_motion(header, words, tmp_path):
    (tmp_path / "hits.csv").write_text(
        header + "\n" + "\n".join(f"{k / 256},{float(k == 20)},{k % 7}" for k in range(64))
    )
    with pytest.raises(cf.errors.InputError, match=words):
        cf.frf.read_records(tmp_path / "hits.csv")


def test_radial_sensors_have_direction_r_and_a_force_without_a_unit_is_taken_for_newtons(tmp_path):
    rows = "\n".join(f"{k / 256},{100.0 * (k == 20)},{(k > 20) * 0.7 ** (k - 20) * (-1) ** k}" for k in range(128))
    (tmp_path / "hits.csv").write_text("time [s],force 9 r,response 2 r [m/s^2]\n" + rows)
    found = cf.frf.estimate(cf.frf.read_records(tmp_path / "hits.csv"), test="hammer")
    assert (found.frfs.unit, found.frfs.response_point.tolist(), found.frfs.reference_point.tolist()) == (
        "(m/s^2)/N",
        [2],
        [9],
    )
    assert any("N is assumed" in note for note in found.notes)
