"""contact: dynamic unilateral contact on rods, linear structures, modal bodies and rotating rims.

Bodies (Rod, PointMass, Wall, LinearBody, ModalBody), gaps (PointGap, RotatingRim, Rub, Patch), laws
(Unilateral, Penalty, Coulomb) and schemes (`contact.scheme`) are frozen values;
`run` brings them together and returns a Result. Scene files: `load_scene`. Less common names are in these modules:
`ct.bodies`, `ct.gaps`, `ct.laws`, `ct.rotor`, `ct.scheme`, `ct.stability`, `ct.cycles`, `ct.scene`, `ct.record`,
`ct.reference`.

>>> import contact as ct
>>> left = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20, x=-1.1, velocity=1.0)
>>> right = ct.Rod(length=1.0, area=1.0, E=1.0, rho=1.0, elements=20)
>>> result = ct.run([left, right], law=ct.Unilateral(), scheme=ct.CentralDifference(), t_end=4.0, courant=0.9)
>>> round(float(result.impulse[0]), 2)
0.98
"""

import lazy_loader

# what the package exports is in __init__.pyi, and each name is loaded when it is first used
_exported, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Look up a name of the stub file, or the version, when it is first used."""
    if name == "__version__":
        from contact.version import __version__

        return __version__
    return _exported(name)
