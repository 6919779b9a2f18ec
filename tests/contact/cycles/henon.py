"""Maps as families of motions, to test periodic orbits: x' = v - x^2 + b y, y' = x (Henon, 1976), and a pitchfork."""

import math
from types import SimpleNamespace

import numpy as np

import contact as ct

B = 0.3
FOLD, FLIP = -((1.0 - B) ** 2) / 4.0, 3.0 * (1.0 - B) ** 2 / 4.0


class Henon:
    """The map as a family of motions of period 2 s; `asked` is what was followed from where."""

    name = "v"
    channels = ("x", "y")
    begin = np.zeros(2)

    def __init__(self):
        self.asked = []

    def at(self, value):
        plant = SimpleNamespace(rigid=np.array([True, False]))
        return SimpleNamespace(v=value, family=self, plant=plant, closed_at=lambda *_: ()), 2.0

    def step(self, v, x):
        return np.array([v - x[0] ** 2 + B * x[1], x[0]]), np.array([[-2.0 * x[0], B], [1.0, 0.0]])


class Fork(Henon):
    """x' = (1 + v) x - x^3, y' = b y: of period 1 in x = 0, and from v = 0 on in x = +-sqrt(v), too."""

    def step(self, v, x):
        return np.array([(1.0 + v) * x[0] - x[0] ** 3, B * x[1]]), np.diag([1.0 + v - 3.0 * x[0] ** 2, B])


def followed_map(motion, x, start, period, *, tangent=True, extremes=True):
    motion.family.asked.append((start, period))
    x, M, amplitude = np.array(x, dtype=float), np.eye(2), np.zeros(2)
    for _ in range(round(period / 2.0)):
        amplitude = np.maximum(amplitude, np.abs(x))
        x, slope = motion.family.step(motion.v, x)
        M = slope @ M
        if not np.abs(x[0]) < 1e6:
            raise ct.NumericsError("it leaves")
    return SimpleNamespace(start=start, x=x, M=M if tangent else None, events=(), gap=np.ones(2), force=np.zeros(2),
                           amplitude=amplitude, first=())  # fmt: skip


def fixed(v, sign=1.0):
    return (-(1.0 - B) + sign * math.sqrt((1.0 - B) ** 2 + 4.0 * v)) / 2.0
