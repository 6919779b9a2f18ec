"""casingfem: shell modes with imperfections, model updating and modal reduction.

import casingfem as cf

casing = cf.Shell(chart=cf.Frustum(r_base=0.50, r_top=0.45, height=0.25), thickness=3e-3,
material=cf.Material(E=210e9, nu=0.3, rho=7800.0), supports={"base": cf.Clamped()})
print(cf.modes(casing, count=40))
"""

import lazy_loader

# what the package exports is in __init__.pyi, and each name is loaded when it is first used
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
