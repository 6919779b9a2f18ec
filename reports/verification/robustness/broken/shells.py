"""Broken models, part one: shells as Python builds them. Each entry makes a model and asks for two modes."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import casingfem as cf
from casingfem.structure.field.field import FieldValues
from casingfem.structure.geometry.chart import Bounds, Surface

Make = Callable[[], object]
NAN, INF = float("nan"), float("inf")
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7800.0}
COARSE = cf.ShellMesh(order=6, rows=1, around=9)
FINE = cf.ShellMesh(order=8, rows=2, around=2)


@dataclass(frozen=True, slots=True)
class Broken:
    """A model that must not be computed silently.

    A name, how it is made, the expected code, what the message must name.
    """

    name: str
    make: Make
    code: str
    names: tuple[str, ...] = ()


def steel(**changes: float) -> cf.Material:
    """Steel with something replaced."""
    return cf.Material(**(STEEL | changes))


def frustum(**changes: Any) -> cf.Shell:
    """A clamped frustum with something replaced."""
    parts: dict[str, Any] = {
        "chart": cf.Frustum(r_base=0.50, r_top=0.45, height=0.25),
        "thickness": 20e-3,
        "material": steel(),
        "supports": {"base": cf.Clamped()},
        "mesh": COARSE,
    }
    return cf.Shell(**(parts | changes))


def casing(count: int = 2, method: str = "shell", **changes: Any) -> cf.Modes:
    """Modes of the frustum with something replaced."""
    return cf.modes(frustum(**changes), count, method=method)


def blade(count: int = 2, **changes: Any) -> cf.Modes:
    """Modes of a cantilevered plate with something replaced."""
    parts: dict[str, Any] = {
        "chart": cf.Plate(length=0.2, width=0.1),
        "thickness": 3e-3,
        "material": steel(),
        "supports": {"root": cf.Clamped()},
        "mesh": FINE,
    }
    return cf.modes(cf.Shell(**(parts | changes)), count)


def wavy(harmonics: dict[int, Any], quantity: str = "radius", **changes: Any) -> cf.Modes:
    """The casing on a coarse mesh with a field."""
    field = cf.FourierField.of(harmonics)
    return casing(**({"mesh": COARSE, f"{quantity}_defect": field} | changes))


@dataclass(frozen=True)
class Bent:
    """A user's plate, 0.2 x 0.1 m on [0, 1]^2, with a fault."""

    fault: str = ""

    @property
    def bounds(self) -> Bounds:
        """The unit square."""
        return ((1.0, 0.0), (0.0, 1.0)) if self.fault == "bounds" else ((0.0, 1.0), (0.0, 1.0))

    @property
    def periodic(self) -> bool:
        """Always false."""
        return self.fault == "seam"

    @property
    def edges(self) -> dict[str, tuple[int, int]]:
        """Root and tip."""
        return {"root": (0, 0), "tip": (2, 1) if self.fault == "edge" else (0, 1)}

    def surface(self, a: Any, b: Any, defect: FieldValues | None) -> Surface:
        """A parabola along a, straight across."""
        a, b = np.broadcast_arrays(a, b)
        zero, one = np.zeros_like(a), np.ones_like(a)
        wide = zero if self.fault == "fold" else one
        high = NAN * one if self.fault == "nan" else 0.02 * a**2
        slope = 0.02 * a if self.fault == "slope" else 0.04 * a
        bend = zero if self.fault == "bend" else 0.04 * one
        return Surface(
            x=np.stack([0.2 * a, 0.1 * b * wide, high]),
            x1=np.stack([0.2 * one, zero, slope]),
            x2=np.stack([zero, 0.1 * wide, zero]),
            x11=np.stack([zero, zero, bend]),
            x12=np.stack([zero, zero, zero]),
            x22=np.stack([zero, zero, zero]),
        )

    def directions(self, a: Any, b: Any) -> Any:
        """Cartesian."""
        a, b = np.broadcast_arrays(a, b)
        zero, one = np.zeros_like(a), np.ones_like(a)
        return np.array([[zero, zero, one], [zero, one, zero], [one, zero, zero]])


def own(fault: str) -> Make:
    """A blade on a user's chart with a fault."""
    return lambda: blade(chart=Bent(fault), thickness=2e-3)


def materials() -> list[Broken]:
    """Impossible materials, and mixed units."""
    bad = {
        "modulus": [("E", -210e9), ("E", 0.0), ("E", NAN), ("E", INF)],
        "density": [("rho", -7800.0), ("rho", 0.0), ("rho", NAN)],
        "poisson": [("nu", 0.5), ("nu", 0.7), ("nu", 30.0), ("nu", -1.0), ("nu", NAN)],
        "units": [("E", 210e3), ("E", 210.0), ("E", 210e6), ("rho", 7.8), ("rho", 7.8e-9)],
        "poisson-negative": [("nu", -0.3)],
    }
    rows = [
        Broken(
            f"{key} = {value:g}", lambda key=key, value=value: casing(material=steel(**{key: value})), f"material-{c}"
        )
        for c, entries in bad.items()
        for key, value in entries
    ]
    both = Broken(
        "E in psi, rho in lb/in^3",
        lambda: casing(material=steel(E=30e6, rho=0.283)),
        "material-density-units",
    )
    return [*rows, both]


def charts() -> list[Broken]:
    """Mid-surfaces."""
    return [
        Broken("radius = 0", lambda: casing(chart=cf.Cylinder(radius=0.0, height=1.0)), "chart-dimension"),
        Broken("height = -0.25", lambda: casing(chart=cf.Cylinder(radius=0.5, height=-0.25)), "chart-dimension"),
        Broken("r_top = nan", lambda: casing(chart=cf.Frustum(r_base=0.5, r_top=NAN, height=0.2)), "chart-dimension"),
        Broken("lengths in mm", lambda: casing(chart=cf.Cylinder(radius=500.0, height=250.0)), "chart-units"),
        Broken(
            "lengths and wall in mm",
            lambda: casing(chart=cf.Frustum(r_base=500.0, r_top=450.0, height=250.0), thickness=3.0),
            "chart-units",
        ),
        Broken("lengths in km", lambda: blade(chart=cf.Plate(length=2e-4, width=1e-4), thickness=3e-6), "chart-units"),
        Broken("height 2000 radii", lambda: casing(chart=cf.Cylinder(radius=2e-3, height=20.0), thickness=1e-4),
               "chart-aspect"),
        Broken("width over 1000 lengths", lambda: blade(chart=cf.Plate(length=1e-3, width=2.0), thickness=1e-4),
               "chart-aspect"),
        Broken("panel of 7 rad", lambda: blade(chart=cf.Panel(radius=0.5, length=0.2, angle=7.0)), "chart-angle"),
        Broken("panel of 359 degrees, its seam open",
               lambda: blade(chart=cf.Panel(radius=0.5, length=0.2, angle=np.radians(359.0))), "chart-near-closed"),
        Broken("twist 30 as if in degrees",
               lambda: blade(chart=cf.geometry.TwistedPlate(length=0.2, width=0.1, twist=30.0)), "chart-twist-units"),
        Broken("twist nan",
               lambda: blade(chart=cf.geometry.TwistedPlate(length=0.2, width=0.1, twist=NAN)), "chart-twist"),
        Broken("blade without chord", lambda: blade(chart=cf.Blade(length=0.2, chord=(0.1, -0.1))), "blade-shape"),
        Broken("dome up to its pole",
               lambda: casing(chart=cf.Revolved(profile=cf.geometry.Arc(radius=0.5, start=0.0, end=1.571))),
               "meridian-axis"),
        Broken("own chart, slope of another surface", own("slope"), "chart-derivatives"),
        Broken("own chart, curvature left out", own("bend"), "chart-derivatives"),
        Broken("own chart, nan", own("nan"), "chart-not-finite"),
        Broken("own chart, shrunk to a line", own("fold"), "chart-fold"),
        Broken("own chart, said to be closed", own("seam"), "chart-open-seam"),
        Broken("own chart, range backwards", own("bounds"), "chart-bounds"),
        Broken("own chart, edge of a third parameter", own("edge"), "chart-edge"),
    ]  # fmt: skip


def walls() -> list[Broken]:
    """Thickness, shear, strips."""
    flange = cf.Strip(start=0.2, end=0.25, thickness=30e-3)
    return [
        Broken("thickness = 0", lambda: casing(thickness=0.0), "shell-thickness"),
        Broken("thickness = -3e-3", lambda: casing(thickness=-3e-3), "shell-thickness"),
        Broken("thickness = inf", lambda: casing(thickness=INF), "shell-thickness"),
        Broken("thickness 3 (mm) on a casing in m", lambda: casing(thickness=3.0), "shell-thickness-size"),
        Broken("thickness 3 (mm) on a blade in m", lambda: blade(thickness=3.0), "shell-thickness-size"),
        Broken("thickness = radius", lambda: casing(thickness=0.5), "shell-thickness-size"),
        Broken("thickness a third of the radius", lambda: casing(thickness=0.15), "shell-thick"),
        Broken("thickness most of the width", lambda: blade(thickness=0.08), "shell-thick"),
        Broken("thickness 1e-6, converted twice", lambda: blade(thickness=1e-6), "shell-thin"),
        Broken("shear correction 0", lambda: casing(shear_correction=0.0), "shear-correction"),
        Broken("shear correction nan", lambda: casing(shear_correction=NAN), "shear-correction"),
        Broken("shear correction 6/5, upside down", lambda: casing(shear_correction=1.2), "shear-correction"),
        Broken("strip beyond the casing", lambda: casing(strips=(replace(flange, end=0.3),)), "strip-outside"),
        Broken("strips over each other", lambda: casing(strips=(flange, replace(flange, start=0.1, end=0.22))),
               "strip-overlap"),
        Broken("strip without thickness", lambda: casing(strips=(replace(flange, thickness=0.0),)), "shell-thickness"),
        Broken("strip off the element lines", lambda: casing(strips=(flange,), mesh=COARSE), "strip-off-line"),
        Broken("taper to nothing", lambda: blade(taper=cf.Taper(along=(1.0, 0.0))), "taper-thickness"),
    ]  # fmt: skip


def fields() -> list[Broken]:
    """Imperfections of fields."""
    survey = cf.FourierField.of({0: 0.01})
    return [
        Broken("radius field of 4 (mm), not 0.004", lambda: wavy({8: 4.0}), "field-range"),
        Broken("radius field in per cent", lambda: wavy({4: 0.4}), "field-large"),
        Broken("mean radius 20 times", lambda: wavy({0: 20.0}), "field-range"),
        Broken("thickness negative by its field", lambda: wavy({2: 1.2}, "thickness"), "field-range"),
        Broken("modulus field below -1", lambda: wavy({2: 1.5}, "modulus"), "field-range"),
        Broken("density nine tenths gone", lambda: wavy({2: 0.95}, "density"), "field-range"),
        Broken("thickness tripled", lambda: wavy({0: 2.0}, "thickness"), "field-large"),
        Broken("nan coefficient", lambda: wavy({4: NAN}), "field-coefficients"),
        Broken("infinite coefficient", lambda: wavy({4: (0.0, INF)}), "field-coefficients"),
        Broken("sine of p = 0", lambda: wavy({0: (0.0, 0.1)}), "field-harmonics"),
        Broken("negative harmonic", lambda: wavy({-3: 0.001}), "field-harmonics"),
        Broken("harmonic 2.5", lambda: cf.FourierField(p=np.array([2.5]), cos=[[0.1]], sin=[[0.0]]),
               "field-harmonics"),
        Broken("harmonic 40 on 54 nodes around", lambda: wavy({40: 1e-3}), "field-mesh"),
        Broken("radius field on a flat plate", lambda: blade(radius_defect=survey), "field-no-radius"),
        Broken("spectrum with high below median", lambda: cf.field.Spectrum(p=[2], median=[0.2], high=[0.1]),
               "field-spectrum"),
    ]  # fmt: skip


def supports() -> list[Broken]:
    """Supports that are impossible or missing."""
    edge, bolts, full = cf.ElasticEdge, cf.Bolts, {"count": 8, "k": 1e8}
    return [
        Broken("support on no edge", lambda: casing(supports={"bottom": cf.Clamped()}), "support-edge"),
        Broken("casing's edge on a blade", lambda: blade(supports={"base": cf.Clamped()}), "support-edge"),
        Broken("a word for a support", lambda: casing(supports={"base": "clamped"}), "support-kind"),
        Broken("all springs zero", lambda: casing(supports={"base": edge(k_face=0.0)}), "support-no-springs"),
        Broken("negative spring", lambda: casing(supports={"base": edge(k_r=-1e8)}), "support-springs"),
        Broken("nan spring", lambda: casing(supports={"base": edge(k_z=NAN)}), "support-springs"),
        Broken("infinite spring", lambda: casing(supports={"base": edge(k_face=INF)}), "support-springs"),
        Broken("springs that pull where they should push",
               lambda: casing(supports={"base": edge(k_r=1e8, around=cf.FourierField.of({2: 1.5}))}),
               "springs-negative"),
        Broken("pattern of an unknown spring",
               lambda: edge(k_r=1e8, around={"k_x": cf.FourierField.of({2: 0.1})}), "support-springs"),
        Broken("axial springs alone", lambda: casing(supports={"base": edge(k_z=1e8)}), "support-incomplete"),
        Broken("springs a million million times too soft",
               lambda: casing(supports={"base": edge(k_face=10.0)}), "support-soft"),
        Broken("no bolts", lambda: casing(supports={"base": bolts(count=0, k=1e8)}), "bolt-count"),
        Broken("bolts without stiffness", lambda: casing(supports={"base": bolts(count=8, k=0.0)}), "bolt-stiffness"),
        Broken("a loose bolt that is not there",
               lambda: casing(supports={"base": bolts(loose={9: 0.0}, **full)}), "bolt-number"),
        Broken("bolts over each other", lambda: casing(supports={"base": bolts(width=1.0, **full)}), "bolt-overlap"),
        Broken("bolts off the edge",
               lambda: blade(chart=cf.Panel(radius=0.5, length=0.2, angle=0.2), supports={"root": bolts(**full)}),
               "bolt-off-edge"),
        Broken("bolts between the elements",
               lambda: casing(supports={"base": bolts(count=8, k=1e8)}, mesh=COARSE), "bolt-mesh"),
    ]  # fmt: skip


def requests() -> list[Broken]:
    """Meshes, and requests for modes."""
    mesh = cf.ShellMesh
    rim = cf.Rim("top", n_max=6)

    def reduced(interface: object, modes: int = 4, **parts: Any) -> object:
        return cf.reduce(frustum(mesh=COARSE, **parts), interface, modes=modes)

    return [
        Broken("order 1", lambda: mesh(order=1), "mesh-order"),
        Broken("order 7.5", lambda: mesh(order=7.5), "mesh-order"),
        Broken("no elements around", lambda: mesh(around=0), "mesh-around"),
        Broken("rows not increasing", lambda: mesh(rows=(0.0, 0.6, 0.5, 1.0)), "mesh-rows"),
        Broken("rows in metres", lambda: mesh(rows=(0.0, 0.1, 0.25)), "mesh-rows"),
        Broken("rows with nan", lambda: mesh(rows=(0.0, NAN, 1.0)), "mesh-rows"),
        Broken("a mesh of a hundred million unknowns", lambda: mesh(order=10, rows=100, around=2000), "mesh-too-large"),
        Broken("mesh too coarse for the modes asked",
               lambda: casing(count=12, thickness=3e-3, method="shell", mesh=COARSE), "mesh-coarse"),
        Broken("one quadratic element", lambda: blade(mesh=mesh(order=2, rows=1, around=1)), "mesh-coarse"),
        Broken("no modes", lambda: casing(count=0), "modes-count"),
        Broken("more modes than unknowns", lambda: blade(count=10_000), "modes-count"),
        Broken("band from high to low", lambda: cf.modes(frustum(), band=(900.0, 300.0)), "modes-band"),
        Broken("band with nan", lambda: cf.modes(frustum(), band=(NAN, 300.0)), "modes-band"),
        Broken("unknown method", lambda: casing(method="magic"), "modes-method"),
        Broken("harmonics one by one on a wavy casing", lambda: wavy({8: 0.01}, method="fourier"), "modes-method"),
        Broken("reduction of a free casing", lambda: reduced(rim, supports={}), "reduce-rigid"),
        Broken("contact on a clamped edge", lambda: reduced(cf.Rim("base", n_max=6)), "interface-held"),
        Broken("rim finer than the mesh", lambda: reduced(cf.Rim("top", n_max=60)), "interface-harmonics"),
        Broken("tip of a casing", lambda: reduced(cf.Tip("tip")), "interface-edge"),
        Broken("damping in per cent", lambda: cf.reduce(frustum(), rim, zeta=2.0), "reduce-damping"),
    ]  # fmt: skip


def rows() -> list[Broken]:
    """All of them."""
    return [*materials(), *charts(), *walls(), *fields(), *supports(), *requests()]
