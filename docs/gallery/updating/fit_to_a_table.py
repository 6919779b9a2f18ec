"""
Fit a blade to a measured table
===============================

The fan blade of Olson and Lindberg: seven MEASURED frequencies, and three parameters with prior knowledge.
"""

import casingfem as cf
from casingfem.examples import DATA
from casingfem.plot.body.shapes import figure_shapes
from casingfem.plot.update import Paired, figure_errors

blade = cf.Shell(
    chart=cf.Panel(radius=0.6096, length=0.3048, angle=0.5),
    thickness=3.048e-3,
    material=cf.Material(E=206.85e9, nu=0.3, rho=7857.2),
    supports={"root": cf.ElasticEdge(k_face=1e16)},
    mesh=cf.ShellMesh(order=6, rows=2, around=2),
)
table = cf.FrequencyTable.from_csv(DATA / "experiments" / "olson_lindberg.csv")
vary = [
    cf.Parameter(name="shell.thickness", lower=2.9e-3, upper=3.3e-3, sigma=5e-5),
    cf.Parameter(name="chart.radius", lower=0.55, upper=0.67, sigma=0.015),
]
fit = cf.update(blade, table, vary, model_error=0.01)
figure = figure_shapes(fit.after, [0, 1, 2])

# %%
# The first modes of the updated blade. The parameters, and the frequencies before and after:

print(fit)
models = {"imperfect": Paired(fit.before, fit.pairing_before), "updated": Paired(fit.after, fit.pairing)}
figure = figure_errors(table, models)

assert fit.rms_after < fit.rms_before
assert abs(fit.rms_after - 0.019) < 0.002
