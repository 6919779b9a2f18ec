"""
Parameters that the data cannot separate
========================================

Frequencies determine E/ρ, not E and ρ. An update of both shows this: their correlation is 1, and the result names the
combination that changes no frequency. The table is SYNTHETIC.
"""

import casingfem as cf
from casingfem.plot.update import figure_corner


def casing(E, rho, thickness):
    """A clamped cylinder."""
    return cf.Shell(
        chart=cf.Cylinder(radius=0.10, height=0.25),
        thickness=thickness,
        material=cf.Material(E=E, nu=0.3, rho=rho),
        supports={"base": cf.Clamped()},
        mesh=cf.ShellMesh(order=6, rows=1, around=13),
    )


truth = cf.modes(casing(205e9, 7800.0, 1.52e-3), count=8)
table = cf.FrequencyTable.from_arrays(
    freq_hz=truth.freq, sigma_hz=5e-4 * truth.freq, n=truth.nodal_diameters, synthetic=True
)
vary = [
    cf.Parameter(name="material.E", lower=180e9, upper=230e9, sigma=10e9),
    cf.Parameter(name="material.rho", lower=7000.0, upper=8500.0, sigma=100.0),
    cf.Parameter(name="shell.thickness", lower=1.3e-3, upper=1.7e-3, sigma=5e-5),
]
fit = cf.update(casing(210e9, 7800.0, 1.5e-3), table, vary)
print(fit)
figure = figure_corner(fit)

assert fit.correlation[0, 1] > 0.95
