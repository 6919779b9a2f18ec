"""The surroundings of every test, set before numpy is loaded: `pytest` alone does what `make test` does.

Two threads of BLAS in each of two workers wait for each other: the suite takes several times as long.
"""

import os

from casingfem.__main__ import threads

os.environ.update(threads(os.environ))
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ["CASINGFEM_PROGRESS"] = "off"  # a slow machine would add lines to what tests compare
