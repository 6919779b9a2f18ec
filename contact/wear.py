"""What a coating has lost: worn depth by angle, and its history."""

from __future__ import annotations

from dataclasses import dataclass

from contact.model.arrays import Array, readonly

WEAR_ARRAYS = ("angle", "made", "cut", "worn", "map_time", "map")
WEAR_NUMBERS = ("volume", "stated", "dissipated", "bare")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Wear:
    """Worn depth of each bar of a coating at the end of a run, and over time.

    `angle` (cells,) of the bars in the casing's frame [rad]; `made` deviation of the rim's radius as made [m], `cut`
    the depth machined before the run, `worn` by the run. `map` (times, cells): worn depth at `map_time` [s].
    `volume` worn [m^3]; `dissipated` energy summed over the steps [J], `stated` what the law says a coating worn like
    this has taken; their difference is round-off. `bare`: how many bars are worn to the casing.
    """

    angle: Array
    made: Array
    cut: Array
    worn: Array
    map_time: Array
    map: Array
    volume: float
    stated: float
    dissipated: float
    bare: int

    def __post_init__(self) -> None:
        for name in WEAR_ARRAYS:
            object.__setattr__(self, name, readonly(getattr(self, name)))

    @property
    def before(self) -> Array:
        """Deviation of the radius before the run [m], (cells,)."""
        return self.made + self.cut

    @property
    def after(self) -> Array:
        """Deviation of the radius after the run [m], (cells,)."""
        return self.made + self.cut + self.worn

    @property
    def residual(self) -> float:
        """Energy dissipated over what the worn profile stands for, minus 1; 0 without wear."""
        return self.dissipated / self.stated - 1.0 if self.stated else self.dissipated

    def __repr__(self) -> str:
        return (
            f"worn {1e9 * self.volume:.4g} mm^3, at most {1e6 * float(self.worn.max()):.4g} um, {self.bare} of "
            f"{self.worn.size} bars to the casing; {self.dissipated:.4g} J dissipated, residual {self.residual:.1e}"
        )
