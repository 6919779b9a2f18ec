"""Arrays from files that are damaged, or made to harm: refused at once, with the member's name."""

import io
import resource
import time
import zipfile
from dataclasses import replace

import numpy as np
import pytest

import casingfem as cf
import contact as ct
from tests.contact.synthetic_rim import blade, ring

READERS = {"contact": (ct.ModalBody.load, ct.InputError), "casingfem": (cf.ModalBasis.load, cf.errors.InputError)}


@pytest.fixture(params=READERS)
def refused(request, tmp_path):
    """A function that has a basis file read that is refused within a second and 200 MB: what is said."""
    read, error = READERS[request.param]

    def message(path):
        started, room = time.perf_counter(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        with pytest.raises(error) as caught:
            read(path)
        assert time.perf_counter() - started < 1.0
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - room < 200e3
        assert str(path) in str(caught.value)
        return str(caught.value)

    return message


def members_of(path):
    with np.load(path) as members:
        return dict(members)


def arrays(tmp_path, body=blade):
    body().save(tmp_path / "whole.npz")
    return members_of(tmp_path / "whole.npz")


def npy(array):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asarray(array))
    return stream.getvalue()


def packed(path, parts, **changed):
    """An npz whose members have these bytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in ({name: npy(array) for name, array in parts.items()} | changed).items():
            archive.writestr(f"{name}.npy", part)
    return path


def header(shape, dtype="<f8"):
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": dtype, "fortran_order": False, "shape": shape})
    return stream.getvalue()


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("rows", lambda a: a + 1j, "member 'rows': found complex128, expected real numbers"),
        ("omega", lambda a: a.astype("M8[s]"), "member 'omega': found datetime64[s], expected numbers or text"),
        ("omega", lambda a: a.astype("m8[s]"), "member 'omega': found timedelta64[s]"),
        ("omega", lambda a: a.astype(str), "member 'omega': found <U"),
        ("omega", lambda a: a.astype(bytes), "member 'omega': found |S"),
        ("zeta", lambda a: a > 1.0, "member 'zeta': found bool, expected real numbers"),
        ("zeta", lambda a: np.array([None, {}]), "member 'zeta': found object"),
        ("rows", lambda a: np.zeros(a.shape, [("x", float)]), "member 'rows': found [('x', '<f8')]"),
        ("channels", lambda a: np.zeros(a.size), "member 'channels': found float64, expected text"),
        ("channels", lambda a: np.array(["span\nflap", "b"]), "channels: found 'span\\nflap', expected a name"),
        ("channels", lambda a: np.array(["span", "\u202eflap"]), "channels: found '\\u202eflap', expected a"),
        ("channels", lambda a: np.array(["span", "span"]), "channels: found 'span' twice"),
        ("omega", lambda a: -a, "rad/s, expected every frequency >= 0"),
        ("omega", lambda a: a[0], "omega"),
        ("S", lambda a: a + np.triu(np.ones_like(a), 1), "S: found asymmetry"),
        ("S", lambda a: -a, "S: found the eigenvalue -"),
        ("n_max", lambda a: np.array(10**12), "n_max: found 1000000000000, expected a whole number"),
        ("n_max", lambda a: np.array(2.5), "n_max: found 2.5, expected a whole number"),
        ("n_max", lambda a: np.array([2, 3]), "n_max: found [2, 3], expected a whole number"),
    ],
)  # fmt: skip
def test_members_of_another_kind(tmp_path, refused, name, change, words):
    parts = arrays(tmp_path)
    np.savez(tmp_path / "changed.npz", **parts | {name: change(parts[name])})
    assert words in refused(tmp_path / "changed.npz")


def test_a_rim_of_a_million_waves_is_refused_before_its_channels_are_named(tmp_path):
    parts = arrays(tmp_path, ring)
    np.savez(tmp_path / "changed.npz", **parts | {"n_max": np.array(10**6)})
    started = time.perf_counter()
    with pytest.raises(ct.InputError, match="expected the 4000002 channels of a rim with n_max = 1000000"):
        ct.ModalBody.load(tmp_path / "changed.npz")
    assert time.perf_counter() - started < 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"omega": header((1 << 23,)) + bytes(1 << 26)}, "largest member: 'omega.npy'"),
        ({"unused": header((1 << 23,)) + bytes(1 << 26)}, "largest member: 'unused.npy'"),
        ({"omega": header((10**13,))}, "member 'omega': found 128 bytes, expected those of an array of float64"),
        ({"omega": header((10**13,), "<U0")}, "member 'omega': found 128 bytes, expected those of an array of <U0"),
        ({"omega": b"hello"}, "member 'omega': EOF: reading magic string"),
        ({"omega": b"\x93NUMPY\x01\x00" + (9000).to_bytes(2, "little") + b"(" * 9000}, "member 'omega': "),
        ({"omega": b"\x93NUMPY\x03\x00" + npy([1.0])[8:]}, "member 'omega': found version (3, 0)"),
    ],
    ids=["bomb", "unused bomb", "size", "width", "text", "nested", "version"],
)
def test_members_made_to_harm(tmp_path, refused, changed, words):
    path = packed(tmp_path / "changed.npz", arrays(tmp_path), **changed)
    assert words in refused(path)


def bits(data, offset, local, value):
    """A field of every header of a zip file's members changed, in its directory and before them."""
    data = bytearray(data)
    for mark, at in ((b"PK\x01\x02", offset), (b"PK\x03\x04", local)):
        place = data.find(mark)
        while place >= 0:
            data[place + at] = value
            place = data.find(mark, place + 4)
    return bytes(data)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda data: bits(data, 8, 6, 1), "member 'format': found it encrypted"),
        (lambda data: bits(data, 10, 8, 97), "member 'format': found it packed by method 97"),
        (lambda data: bits(data, 8, 6, 64), "strong encryption"),
        (lambda data: bits(data, 6, 4, 109), "zip file version 10.9"),
        (lambda data: data[:90] + bytes([data[90] ^ 255]) + data[91:], "member 'format': "),
        (lambda data: data[: len(data) // 2], "not a zip file"),
        (lambda data: b"", "not a zip file"),
        (lambda data: npy([1.0]), "not a zip file"),
    ],
    ids=["encrypted", "method", "strong", "version", "stream", "cut", "empty", "npy"],
)
def test_damaged_archives(tmp_path, refused, damage, words):
    path = packed(tmp_path / "changed.npz", arrays(tmp_path))
    path.write_bytes(damage(path.read_bytes()))
    assert words in refused(path)


def test_a_member_twice(tmp_path, refused):
    path = packed(tmp_path / "changed.npz", arrays(tmp_path))
    with zipfile.ZipFile(path, "a") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr("omega.npy", npy([1.0]))
    assert "found 'omega.npy' 2 times, expected .npy arrays, each once" in refused(path)


@pytest.mark.slow
def test_well_packed_numbers_are_read(tmp_path):
    """Thirty megabytes of zeros pack a thousand times over: no harm."""
    zeros = {"x": np.zeros((4_000_000, 1))}
    np.savez_compressed(tmp_path / "zeros.npz", **zeros)
    with pytest.raises(ct.InputError, match="no key 'format'") as caught:
        ct.ModalBody.load(tmp_path / "zeros.npz")
    assert "unpack" not in str(caught.value)


def moved():
    """Result of a mass that moves freely."""
    body = ct.PointMass(mass=1.0, velocity=1.0)
    return ct.run([body, ct.Wall(x=0.1)], law=ct.Unilateral(), scheme=ct.CentralDifference(), t_end=0.01, dt=1e-3)


@pytest.mark.parametrize("document", ["", "[]", "{}", "[" * 100_000, '{"energy": 1}', '{"energy": {"start": {}}}'])
def test_a_result_with_another_document(tmp_path, document):
    path = moved().save(tmp_path / "result.npz")
    np.savez(path, **members_of(path) | {"document": document})
    with pytest.raises(ct.InputError, match=r"result\.npz: key 'document': found"):
        ct.Result.load(path)


def test_objects_are_not_written(tmp_path):
    result = moved()
    with pytest.raises(ValueError, match="member 'time': found object, expected numbers or text"):
        replace(result, time=result.time.astype(object)).save(tmp_path / "result.npz")
    assert not list(tmp_path.iterdir())
