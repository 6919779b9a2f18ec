"""Tables and figures, each a script with `main(out, quick=False)`.

`verification`: is it right? `benchmarks`: how fast is it? `studies`: what does the chain give? `tools`: for
maintainers.

BLAS keeps to one thread by default otherwise, as the command line does: factorisations here are small, and beside
other work two threads that wait for each other take ten times as long.
"""

import os

from casingfem.__main__ import threads

os.environ.update(threads(os.environ))
