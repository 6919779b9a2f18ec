"""Bolts: an edge supported at separate angles, each by springs distributed over a patch."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from scipy.special import spherical_jn

from casingfem.errors import ModelError
from casingfem.io.arrays import Array, read_only
from casingfem.structure.mesh.edge_form import EdgeLine, PointSprings, along_springs
from casingfem.structure.mesh.element import gauss
from contact.io.brief import brief
from contact.io.keys import Key

TURN = 2.0 * np.pi
PATCH = 1.0 / 3.0  # a bolt's patch as part of the spacing, where no width is given


@dataclass(frozen=True, slots=True, kw_only=True)
class Bolts:
    """An edge supported by `count` bolts.

    Each bolt b is a patch of springs about its angle theta_b, of total stiffness k and the density

        p(xi) = 15/(8 width) (1 - xi^2)^2,   xi = 2 (theta - theta_b)/width,   int p dtheta = 1,

    so that its energy is 1/2 int p (k_r u_r^2 + k_theta u_theta^2 + k_z u_z^2 + k_rot w.w) dtheta. A point spring is
    unsuitable, since the deflection of a shear-deformable shell under a point force has no limit as the mesh is
    refined.

    Parameters
    ----------
    count
        Number of bolts; they are numbered 1 to count.
    k
        Stiffness of one bolt [N/m], along (r, theta, z), or one number for all three.
    k_rot
        Rotational stiffness of one bolt [N m/rad], on both rotations of the normal.
    first_angle
        Angle of bolt 1 [rad].
    width
        Width of a patch [rad]; by default a third of the spacing.
    spacing
        Angle between neighbours [rad]; by default evenly around, 2 pi/count.
    loose
        Bolt number -> factor of its stiffness: 0 for a missing one.

    Raises
    ------
    ModelError
        bolt-count, bolt-stiffness, bolt-number or bolt-overlap; a shell also raises bolt-off-edge.

    >>> Bolts(count=24, k=2e8, loose={3: 0.3}).factors[:4].tolist()
    [1.0, 1.0, 0.3, 1.0]
    """

    count: Annotated[int, Key("number of bolts", most=1000)]
    k: float | tuple[float, float, float]
    k_rot: Annotated[float, Key("rotational stiffness of one bolt [N m/rad]", "not negative")] = 0.0
    first_angle: Annotated[float, Key("angle of bolt 1 [degrees]", "turn", degrees=True)] = 0.0
    width: Annotated[
        float | None, Key("width of the patch on which a bolt acts [degrees]", degrees=True, least=1e-3, most=360.0)
    ] = None
    spacing: Annotated[
        float | None,
        Key(
            "angle between neighbouring bolts [degrees]; evenly all around if left out",
            degrees=True,
            least=1e-3,
            most=360.0,
        ),
    ] = None
    loose: Mapping[int, float] = field(default_factory=dict)

    held: ClassVar[tuple[int, ...]] = ()
    frame: ClassVar[Literal["cartesian", "edge"]] = "cartesian"
    uniform: ClassVar[bool] = False  # bolts act at separate angles

    __repr__ = brief

    def __post_init__(self) -> None:
        if not (isinstance(self.count, int | np.integer) and 1 <= self.count <= 1000):
            found = f"bolts.count must be a whole number between 1 and 1000, found {self.count!r}"
            raise ModelError("bolt-count", found)
        if np.ndim(self.k) and len(np.atleast_1d(self.k)) != 3:
            raise ModelError("bolt-stiffness", f"bolts.k must be one number or three, found {self.k!r}")
        values = np.real([*self.stiffness, self.k_rot, *self.loose.values()])
        if not (np.all(np.isfinite(values)) and np.all(values >= 0.0)):
            bad = values[~(np.isfinite(values) & (values >= 0.0))][0]
            raise ModelError(
                "bolt-stiffness", f"bolts.k, k_rot and factors must be finite and not negative, found {bad:g}"
            )
        if not np.any(values[:4]):
            raise ModelError("bolt-stiffness", "bolts: found k = 0 and k_rot = 0, expected one of them above 0")
        for bolt in self.loose:
            if not 1 <= bolt <= self.count:
                raise ModelError("bolt-number", f"bolts.loose: found bolt {bolt}, expected 1 to {self.count}")
        if not np.isfinite(self.first_angle):
            raise ModelError("bolt-off-edge", f"bolts.first_angle must be finite, found {self.first_angle!r}")
        self._check_room()
        object.__setattr__(self, "loose", read_only(self.loose))

    def _check_room(self) -> None:
        pitch, width = self.pitch, self.patch
        if not (np.isfinite(pitch) and np.isfinite(width) and pitch > 0.0 and width > 0.0):
            found = f"found {np.degrees(pitch):.4g} and {np.degrees(width):.4g} deg"
            raise ModelError("bolt-overlap", f"bolts.spacing and width must be positive and finite, {found}")
        last = TURN - (self.count - 1) * pitch  # from the last bolt on to the first
        if last < 0.0:
            found = f"found {self.count} bolts at a spacing of {np.degrees(pitch):.4g} deg, more than one full circle"
            raise ModelError("bolt-overlap", found)
        if width > min(pitch, last) * (1.0 + 1e-12):
            wide, apart = np.degrees(width), np.degrees(min(pitch, last))
            found = f"bolts.width: found {wide:.4g} deg at a spacing of {apart:.4g} deg, so that patches overlap"
            raise ModelError("bolt-overlap", found)

    @property
    def stiffness(self) -> Array:
        """Stiffness of one bolt along (r, theta, z) [N/m]."""
        return np.asarray(np.broadcast_to(self.k, 3))

    @property
    def pitch(self) -> float:
        """Angle between neighbours [rad]."""
        return TURN / self.count if self.spacing is None else self.spacing

    @property
    def patch(self) -> float:
        """Width of a patch [rad]."""
        return PATCH * self.pitch if self.width is None else self.width

    @property
    def angles(self) -> Array:
        """Angles of the bolts [rad], (count,)."""
        return self.first_angle + self.pitch * np.arange(self.count, dtype=float)

    @property
    def factors(self) -> Array:
        """Factor of each bolt's stiffness, (count,)."""
        return np.array([self.loose.get(bolt, 1.0) for bolt in range(1, self.count + 1)])

    @property
    def period(self) -> int:
        """Number of repetitions of the pattern around: the count for equal bolts evenly around, 1 without repetition.

        >>> Bolts(count=24, k=2e8, loose={3: 0.3, 15: 0.3}).period
        2
        """
        if self.spacing is not None:
            return 1
        factors = np.real(self.factors)
        turns = [n for n in range(self.count, 0, -1) if self.count % n == 0]
        return next(n for n in turns if np.array_equal(np.roll(factors, self.count // n), factors))

    def number(self, path: tuple[str, ...]) -> Any:
        """A number by name: ("k",), ("k_rot",) or ("bolts", "3", "k"); k is the largest of the three stiffnesses.

        Raises
        ------
        KeyError
            If there is no such number.

        >>> Bolts(count=8, k=2e8, loose={3: 0.25}).number(("bolts", "3", "k")).item()
        50000000.0
        """
        largest = self.stiffness[np.argmax(np.real(self.stiffness))]
        if path in (("k",), ("k_rot",)):
            return largest if path == ("k",) else self.k_rot
        return largest * self.loose.get(self._bolt(path), 1.0)

    def with_number(self, path: tuple[str, ...], value: Any) -> "Bolts":
        """The same bolts with a named number replaced; three stiffnesses keep their ratios.

        k is that of the tight bolts; those in `loose` keep their stiffness.

        >>> Bolts(count=8, k=(1e8, 1e8, 2e8)).with_number(("bolts", "3", "k"), 1e8).loose[3].item()
        0.5
        """
        if path == ("k_rot",):
            return replace(self, k_rot=value)
        largest = self.number(("k",))
        if not np.real(largest):
            raise KeyError("found bolts with k = 0, expected k above 0: a factor does not change 0")
        part = value / largest
        if path != ("k",):
            return replace(self, loose={**self.loose, self._bolt(path): part})
        scaled = self.k * part if np.ndim(self.k) == 0 else tuple(self.stiffness * part)
        return replace(self, k=scaled, loose={bolt: factor / part for bolt, factor in self.loose.items()})

    def _bolt(self, path: tuple[str, ...]) -> int:
        match path:
            case ("bolts", number, "k") if number.isdecimal() and 1 <= int(number) <= self.count:
                return int(number)
        raise KeyError(f"the numbers of these bolts are k, k_rot and bolts.1.k to bolts.{self.count}.k")

    def require_on(self, span: tuple[float, float], closed: bool, edge: str) -> None:
        """Refuse patches that extend beyond an open edge."""
        low, high = self.angles[0] - 0.5 * self.patch, self.angles[-1] + 0.5 * self.patch
        if not closed and (low < span[0] - 1e-12 or high > span[1] + 1e-12):
            found = f"found patches from {low:.6g} to {high:.6g} rad (m on a straight edge)"
            expected = f"expected them on the edge, from {span[0]:.6g} to {span[1]:.6g}"
            raise ModelError("bolt-off-edge", f"support.{edge}: {found}, {expected}")

    def points(self, breaks: Array, closed: bool, per_part: int) -> tuple[Array, Array, Array]:
        """Gauss points of the patches, split at element boundaries: positions, weights times density, bolt index."""
        lines = breaks
        if closed:
            first, last = (np.floor((self.angles[k] - np.real(breaks[0])) / TURN).astype(int) for k in (0, -1))
            lines = np.concatenate([breaks[:-1] + TURN * turn for turn in range(first - 1, last + 2)])
        low, high = self.angles - 0.5 * self.patch, self.angles + 0.5 * self.patch
        inside = [lines[(np.real(lines) > a) & (np.real(lines) < b)] for a, b in zip(low, high, strict=True)]
        ends = [np.concatenate([[a], cut, [b]]) for a, cut, b in zip(low, inside, high, strict=True)]
        bolt = np.repeat(np.arange(self.count), [len(e) - 1 for e in ends])
        start, size = np.concatenate([e[:-1] for e in ends]), np.concatenate([np.diff(e) for e in ends])
        x, w = gauss(per_part)
        places = start[:, None] + size[:, None] * x
        xi = 2.0 * (places - self.angles[bolt, None]) / self.patch
        weights = size[:, None] * w * 1.875 / self.patch * (1.0 - xi**2) ** 2
        return places.ravel(), weights.ravel(), np.repeat(bolt, per_part)

    def spectrum(self, orders: Array) -> Array:
        """Fourier coefficients of all patches with their factors, int p e^(i k theta) dtheta for each order k.

        One patch has e^(i k theta_b) 15 j_2(x)/x^2 with x = k width/2 and the spherical Bessel function j_2.

        >>> Bolts(count=4, k=1e8, loose={1: 0.0}).spectrum(np.array([0, 1, 4])).real.round(3).tolist()
        [3.0, -0.995, 2.772]
        """
        x = 0.5 * self.patch * np.asarray(orders, dtype=float)
        far = np.maximum(x, 1e-2)
        one = np.where(x > 1e-2, 15.0 * spherical_jn(2, far) / far**2, 1.0 - x**2 / 14.0)
        return np.asarray(one * (np.exp(1j * np.outer(orders, self.angles)) @ self.factors))

    def single(self, line: EdgeLine) -> PointSprings:
        """One tight bolt as springs at the place 0 of an edge."""
        nodes, values = line.interpolate(np.zeros(1))
        blocks = along_springs(self.stiffness[:, None], line.frame(np.zeros(1)).directions)
        return PointSprings(nodes, values, blocks, rotation=np.full(1, self.k_rot))

    def springs(self, line: EdgeLine) -> PointSprings:
        """The patches of springs on an edge, exact for the element's polynomials on any mesh."""
        places, weights, bolt = self.points(line.breaks, line.closed, line.order + 4)
        weights = weights * self.factors[bolt]
        nodes, values = line.interpolate(places)
        blocks = along_springs(self.stiffness[:, None], line.frame(places).directions)
        return PointSprings(nodes, values, blocks * weights[:, None, None], rotation=self.k_rot * weights)
