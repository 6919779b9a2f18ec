"""The adapter of MKL Pardiso, what it hands over and reads back: against a stand-in, and against MKL where it is.

MKL takes .3 GB to download, too much for the development extra; with `pip install -e '.[direct]'` both are run.
"""

import gc
import sys
from types import ModuleType

import numpy as np
import pytest
from scipy.sparse import csc_array, triu
from test_slicing import with_spectrum

import casingfem as cf
from casingfem.linalg.eigen import solve_modes
from casingfem.linalg.factor import factorise
from casingfem.linalg.pencil import make_pencil


class PyPardisoError(Exception):
    pass


class DensePardiso:
    """The part of pypardiso 0.4.7 that is used, with Pardiso's meaning, in dense arithmetic.

    A symmetric indefinite matrix (mtype -2) is its sorted upper triangle by rows; output parameters count from one.
    """

    freed = 0

    def __init__(self, mtype=11):
        assert mtype == -2
        self.iparm = {}

    def whole(self, A):
        assert A.format == "csr"
        assert A.has_sorted_indices
        assert triu(A).nnz == A.nnz
        upper = A.toarray()
        return upper + np.triu(upper, 1).T

    def factorize(self, A):
        if not np.diff(A.indptr).all():
            raise ValueError("Matrix A is singular, because it contains empty row(s)")
        if not np.isfinite(A.data).all():
            raise PyPardisoError(-4)
        values = np.linalg.eigvalsh(self.whole(A))
        zero = np.abs(values) < 1e-13 * np.abs(values).max()
        self.iparm = {23: np.int32(np.count_nonzero(values < 0.0)), 14: np.int32(np.count_nonzero(zero))}

    def solve(self, A, b):
        return np.linalg.solve(self.whole(A), b)

    def get_iparm(self, i):
        return self.iparm[i]

    def free_memory(self, everything=False):
        assert everything
        DensePardiso.freed += 1


def stand_in(monkeypatch):
    package, wrapper = ModuleType("pypardiso"), ModuleType("pypardiso.pardiso_wrapper")
    package.PyPardisoSolver, wrapper.PyPardisoError = DensePardiso, PyPardisoError
    monkeypatch.setitem(sys.modules, "pypardiso", package)
    monkeypatch.setitem(sys.modules, "pypardiso.pardiso_wrapper", wrapper)


@pytest.fixture(params=["stand-in", "MKL"])
def pypardiso(request, monkeypatch):
    if request.param == "MKL":
        pytest.importorskip("pypardiso")
    else:
        stand_in(monkeypatch)


@pytest.mark.slow
@pytest.mark.usefixtures("pypardiso")
def test_it_agrees_with_superlu():
    K, M = with_spectrum(np.arange(1.0, 200.0), sparse_mass=True)
    a, b = (solve_modes(K, M, 30, shift=-0.1, direct=direct) for direct in ("superlu", "pardiso"))
    np.testing.assert_allclose(a.eigenvalues, b.eigenvalues, rtol=1e-9)
    pencil = make_pencil(K, M)
    for sigma in (0.5, 17.5, 100.5, 300.0):
        assert pencil.count_below(sigma, "pardiso") == pencil.count_below(sigma, "superlu") == min(int(sigma), 199)


@pytest.mark.usefixtures("pypardiso")
def test_solutions_and_inertia_of_an_indefinite_matrix():
    A = np.array([[2.0, 1.0, 0.0], [1.0, -3.0, 0.5], [0.0, 0.5, 0.7]])
    factor = factorise(csc_array(A), "pardiso")
    rhs = np.array([[1.0, 0.0], [-2.0, 4.0], [0.5, 3.0]])
    np.testing.assert_allclose(A @ factor.solve(rhs), rhs, atol=1e-12)
    np.testing.assert_allclose(A @ factor.solve(rhs[:, 0]), rhs[:, 0], atol=1e-12)
    assert factor.negative() == 1


@pytest.mark.usefixtures("pypardiso")
@pytest.mark.parametrize(("A", "words"), [
    (np.ones((2, 2)), "the matrix is singular: the structure is not supported"),
    (np.diag([1.0, 0.0]), "Pardiso could not factorise the matrix: Matrix A is singular"),
])  # fmt: skip
def test_a_singular_matrix_is_refused(A, words):
    with pytest.raises(cf.errors.NumericsError, match=words):
        factorise(csc_array(A), "pardiso")


@pytest.mark.slow
def test_its_own_errors_are_reported_and_its_memory_is_given_back(monkeypatch):
    stand_in(monkeypatch)
    with pytest.raises(cf.errors.NumericsError, match="Pardiso could not factorise the matrix: -4"):
        factorise(csc_array(np.diag([1.0, np.nan])), "pardiso")
    gc.collect()  # factors of other tests
    before = DensePardiso.freed
    factor = factorise(csc_array(np.eye(2)), "pardiso")
    assert DensePardiso.freed == before
    del factor
    gc.collect()
    assert DensePardiso.freed == before + 1


def test_without_the_package_its_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pypardiso", None)
    with pytest.raises(cf.errors.NumericsError, match=r"pip install .*direct"):
        factorise(csc_array(np.eye(2)), "pardiso")
