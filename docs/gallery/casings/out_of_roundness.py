"""
Out-of-roundness of a rim in contact
====================================

The gap of a rub contains the rim's deviation from a circle, in metres. `cf.modal.out_of_roundness` computes it from the
casing's field, as terms for a rub.
"""

import matplotlib.pyplot as plt
import numpy as np

import casingfem as cf

casing = cf.Shell(
    chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
    thickness=3e-3,
    material=cf.Material(E=210e9, nu=0.3, rho=7800.0),
    supports={"base": cf.Clamped()},
    radius_defect=cf.FourierField.of({2: 4e-4, 3: (1e-4, 2e-4)}),
)
terms = cf.modal.out_of_roundness(casing, cf.Rim("top", n_max=20))
print(terms)

theta = np.linspace(0.0, 2.0 * np.pi, 361)
gap = sum(t.get("cos", 0.0) * np.cos(t["p"] * theta) + t.get("sin", 0.0) * np.sin(t["p"] * theta) for t in terms)
figure, axes = plt.subplots(subplot_kw={"projection": "polar"}, layout="constrained")
axes.plot(theta, 0.45 + 200.0 * gap)
axes.plot(theta, np.full(theta.size, 0.45), color="0.6", linewidth=1)
axes.set_title("the rim, its deviation drawn 200 times")

# %%
# A deviation of 0.04 % of the rim's radius of 0.45 m is 0.18 mm.

two = next(term for term in terms if term["p"] == 2)
assert abs(two["cos"] - 4e-4 * 0.45) < 1e-9
