"""Tables and figures, each a script with `main(out, quick=False)`.

`verification` compares results with references. `benchmarks` measures times. `studies` runs the whole chain. `tools`
are for maintainers.

BLAS uses one thread unless the environment sets another number, as on the command line. The factorisations are small.
On a busy machine two threads that wait for each other take ten times as long.
"""

import os

from casingfem.__main__ import threads

os.environ.update(threads(os.environ))
