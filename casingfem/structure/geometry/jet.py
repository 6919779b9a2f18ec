"""Jets: numbers with their first and second derivatives by two parameters.

A surface computed with jets has exact metric and curvature; products and functions follow the chain rule

    (f g),ij = f,ij g + f,i g,j + f,j g,i + f g,ij,    g(f),ij = g'' f,i f,j + g' f,ij.

Everything is analytic, so complex steps in the parameters of the formula work.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from casingfem.io.arrays import Array
from casingfem.structure.geometry.chart import Surface

SMALL = 0.3  # below this angle sinc is summed as a series


@dataclass(frozen=True, slots=True, eq=False)
class Jet:
    """Value and derivatives d1, d2, d11, d12, d22 at points, six arrays of one shape.

    >>> x, y = jets(np.array(2.0), np.array(3.0))
    >>> z = x * x * y + 1.0
    >>> [float(part) for part in (z.value, z.d1, z.d2, z.d11, z.d12, z.d22)]
    [13.0, 12.0, 4.0, 6.0, 4.0, 0.0]
    """

    value: Array
    d1: Array
    d2: Array
    d11: Array
    d12: Array
    d22: Array

    @property
    def parts(self) -> tuple[Array, ...]:
        """The six numbers in order."""
        return self.value, self.d1, self.d2, self.d11, self.d12, self.d22

    def __add__(self, other: Jet | complex) -> Jet:
        if isinstance(other, Jet):
            return Jet(*(a + b for a, b in zip(self.parts, other.parts, strict=True)))
        return Jet(self.value + other, *self.parts[1:])

    def __neg__(self) -> Jet:
        return self * -1.0

    def __sub__(self, other: Jet | complex) -> Jet:
        return self + other * -1.0

    def __rsub__(self, other: complex) -> Jet:
        return self * -1.0 + other

    def __mul__(self, other: Jet | complex) -> Jet:
        if not isinstance(other, Jet):
            return Jet(*(part * other for part in self.parts))
        f, g = self, other
        return Jet(
            f.value * g.value,
            f.d1 * g.value + f.value * g.d1,
            f.d2 * g.value + f.value * g.d2,
            f.d11 * g.value + 2.0 * f.d1 * g.d1 + f.value * g.d11,
            f.d12 * g.value + f.d1 * g.d2 + f.d2 * g.d1 + f.value * g.d12,
            f.d22 * g.value + 2.0 * f.d2 * g.d2 + f.value * g.d22,
        )

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Jet | complex) -> Jet:
        return self * (reciprocal(other) if isinstance(other, Jet) else 1.0 / other)

    def __rtruediv__(self, other: complex) -> Jet:
        return reciprocal(self) * other

    def __pow__(self, k: float) -> Jet:
        x = self.value
        slope = k * x ** (k - 1.0) if k else 0.0 * x
        bend = k * (k - 1.0) * x ** (k - 2.0) if k not in (0.0, 1.0) else 0.0 * x
        return self.through(x**k, slope, bend)

    def through(self, g: Array, slope: Array, bend: Array) -> Jet:
        """A function of this jet, from its value, slope and second derivative at `value`."""
        d1, d2 = self.d1, self.d2
        bent = bend * d1**2 + slope * self.d11, bend * d1 * d2 + slope * self.d12, bend * d2**2 + slope * self.d22
        return Jet(g, slope * d1, slope * d2, *bent)


def jets(a: Array, b: Array) -> tuple[Jet, Jet]:
    """The two parameters of a chart with their derivatives, broadcast against each other.

    Sums, products, quotients, powers with a constant exponent, `sin`, `cos`, `exp` and `sqrt` of them have the
    derivatives that a chart's `surface` needs.

    >>> import casingfem as cf
    >>> a, b = cf.geometry.jets(np.array(2.0), np.array(3.0))
    >>> float((a * b).d12)
    1.0
    """
    a, b = np.broadcast_arrays(a, b)
    zero, one = np.zeros_like(a + b), np.ones_like(a + b)
    return Jet(a + zero, one, zero, zero, zero, zero), Jet(b + zero, zero, one, zero, zero, zero)


def sin(x: Jet) -> Jet:
    """Sine of a quantity with its derivatives.

    >>> import casingfem as cf
    >>> a, _ = cf.geometry.jets(np.array(0.0), np.array(3.0))
    >>> float(cf.geometry.sin(a).d1)
    1.0
    """
    s, c = np.sin(x.value), np.cos(x.value)
    return x.through(s, c, -s)


def cos(x: Jet) -> Jet:
    """Cosine of a quantity with its derivatives.

    >>> import casingfem as cf
    >>> a, _ = cf.geometry.jets(np.array(0.0), np.array(3.0))
    >>> float(cf.geometry.cos(a).d11)
    -1.0
    """
    s, c = np.sin(x.value), np.cos(x.value)
    return x.through(c, -s, -c)


def exp(x: Jet) -> Jet:
    """Exponential of a quantity with its derivatives.

    >>> import casingfem as cf
    >>> a, _ = cf.geometry.jets(np.array(0.0), np.array(3.0))
    >>> float(cf.geometry.exp(2.0 * a).d11)
    4.0
    """
    e = np.exp(x.value)
    return x.through(e, e, e)


def sqrt(x: Jet) -> Jet:
    """Square root of a quantity with its derivatives.

    >>> import casingfem as cf
    >>> a, _ = cf.geometry.jets(np.array(4.0), np.array(3.0))
    >>> float(cf.geometry.sqrt(a).d1)
    0.25
    """
    return x**0.5


def reciprocal(x: Jet) -> Jet:
    """1/x."""
    r = 1.0 / x.value
    return x.through(r, -(r**2), 2.0 * r**3)


def sinc(x: Jet) -> Jet:
    """sin(x)/x, even and analytic at 0, where the series sum (-1)^k x^(2k)/(2k + 1)! is used."""
    small = np.abs(x.value) < SMALL
    y = np.where(small, 1.0, x.value)
    s, c = np.sin(y), np.cos(y)
    far = (s / y, c / y - s / y**2, -s / y - 2.0 * c / y**2 + 2.0 * s / y**3)
    near = _sinc_series(np.where(small, x.value, 0.0))
    return x.through(*(np.where(small, a, b) for a, b in zip(near, far, strict=True)))


def _sinc_series(x: Array) -> tuple[Array, Array, Array]:
    """Value, slope and second derivative of the series; the error of eight terms is 1e-22 at `SMALL`."""
    value, slope, bend = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    term = 1.0
    for k in range(8):
        value = value + term * x ** (2 * k)
        if k:
            slope = slope + term * 2 * k * x ** (2 * k - 1)
            bend = bend + term * 2 * k * (2 * k - 1) * x ** (2 * k - 2)
        term /= -(2 * k + 2) * (2 * k + 3)
    return value, slope, bend


def surface(x: Jet, y: Jet, z: Jet) -> Surface:
    """The surface of three Cartesian coordinates.

    >>> a, b = jets(np.array(0.0), np.array(2.0))
    >>> surface(a, b, a * b).x12.tolist()
    [0.0, 0.0, 1.0]
    """
    return Surface(*(np.stack(part) for part in zip(x.parts, y.parts, z.parts, strict=True)))
