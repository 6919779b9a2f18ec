"""[rig] of a study file: excitation, measurements and disturbances of the virtual test rig."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from casingfem.experiment.rig.rig import LEAST_ZETA
from casingfem.experiment.rig.troubles import Troubles
from casingfem.study.tables.table import Angle, Pair, Table
from contact.io.plausible import CHECKS, REACH
from contact.io.tables import NotNegative, Positive, table_of

Band = Annotated[list[Positive], Field(min_length=2, max_length=2)]
Direction = Literal["radial", "hoop", "axial", "x", "y", "z", "normal"]
Ratio = Annotated[float, Field(ge=-60, le=300)]
Damping = Annotated[float, Field(ge=LEAST_ZETA, lt=1), CHECKS["zeta"]]

MOST_LINES = 1_000_000  # of a response: a day's record contains no more


class PlaceTable(Table):
    """A place: height and angle_deg on a casing, or at = [a, b], parameters of the chart."""

    height: Annotated[NotNegative, REACH] | None = Field(
        default=None, description="height along the axis of a casing [m]"
    )
    angle_deg: Angle = Field(default=0.0, description="angle around a casing [degrees]")
    at: Pair | None = Field(
        default=None,
        description="place on the chart, by its two parameters [m or rad], instead of height and angle_deg",
    )
    direction: Direction = Field(default="radial", description="direction of the motion")
    mass: Annotated[float, Field(ge=0, le=10)] = Field(default=0.0, description="mass of the sensor at this point [kg]")

    @model_validator(mode="after")
    def _one_way(self) -> "PlaceTable":
        if (self.height is None) == (self.at is None):
            raise ValueError("found height and at, or neither, expected one of them")
        return self


class SensorTable(PlaceTable):
    """[[rig.sensor]]: one sensor or laser spot, or a whole circle of them."""

    count: int = Field(
        default=1, ge=1, le=1000, description="number of points, evenly spaced around a casing from angle_deg on"
    )


@table_of(Troubles)
class TroublesTable(Table):
    """[rig.test.troubles]: imperfections of a hammer test, by default none."""


class ResponsesTable(Table):
    """[rig.test]: frequency responses, exact or from time records."""

    kind: Literal["exact", "random", "burst-random", "impact"] = Field(
        description="exact responses, or the kind of force in simulated records"
    )
    band_hz: Band = Field(description="band of the responses, [from, to] [Hz]")
    resolution_hz: Positive = Field(description="line spacing [Hz]; its reciprocal is the length of a block")
    blocks: int = Field(default=20, ge=1, le=10_000, description="number of blocks of a record")
    force: Positive = Field(default=1.0, description="rms of a random force, peak of an impact [N]")
    part: float = Field(default=0.4, gt=0, lt=1, description="length of a burst as a part of a block [-]")
    width: Positive | None = Field(default=None, description="duration of an impact [s]; 1/band_hz[1] if left out")
    snr_db: Ratio | None = Field(default=None, description="signal-to-noise ratio [dB]; no noise if left out")
    bits: int | None = Field(default=None, ge=4, le=32, description="number of bits of the converter, for records only")
    keep_records: bool = Field(default=False, description="whether the time records are written too")
    estimator: Literal["H1", "H2"] = Field(default="H1", description="estimator of the responses from records")
    troubles: TroublesTable | None = Field(
        default=None, description="disturbances of a real test, for exact responses only"
    )

    @model_validator(mode="after")
    def _ascending(self) -> "ResponsesTable":
        if not self.band_hz[0] < self.band_hz[1]:
            raise ValueError(f"found band_hz = {self.band_hz}, expected two frequencies in order")
        lines = (self.band_hz[1] - self.band_hz[0]) / self.resolution_hz
        if not 1.0 - 1e-9 <= lines <= MOST_LINES:
            found = f"resolution_hz = {self.resolution_hz:g} over band_hz = {self.band_hz}"
            raise ValueError(f"found {found}, expected 2 to {MOST_LINES:,} lines in the band")
        if self.troubles is not None and (self.kind != "exact" or self.snr_db is None):
            raise ValueError('found troubles, expected kind = "exact" and snr_db with them')
        if self.bits is not None and self.kind == "exact":
            raise ValueError("found bits with exact responses, expected records: random, burst-random or impact")
        if self.keep_records and self.kind == "exact":
            raise ValueError("found keep_records with exact responses, expected random, burst-random or impact")
        return self


class ScanTable(Table):
    """[rig.scan]: a laser spot that moves around while tones excite the casing."""

    height: Annotated[NotNegative, REACH] = Field(description="height of the circle of the laser spot [m]")
    tones_hz: Annotated[list[Positive], Field(min_length=1, max_length=100)] = Field(
        description="frequencies of the excitation [Hz]"
    )
    force: Positive = Field(default=1.0, description="amplitude of the force of each tone [N]")
    drive: int = Field(default=1, ge=1, description="number of the table [[rig.drive]] at which the force acts")
    fixed_in: Literal["casing", "space"] = Field(default="casing", description="frame in which the force is fixed")
    mirror_hz: float = Field(default=0.0, ge=-1000, le=1000, description="speed of the laser's mirror [turns/s]")
    casing_hz: float = Field(default=0.0, ge=-1000, le=1000, description="speed of the casing on the lathe [turns/s]")
    seconds: Positive = Field(description="length of the record [s]")
    fs: Positive = Field(description="sampling rate [Hz]")
    orders: int = Field(ge=0, le=200, description="largest number of nodal diameters searched for")
    points: int | None = Field(
        default=None, ge=3, le=1000, description="number of points of the circle; 2 orders + 3 if left out"
    )
    snr_db: Ratio | None = Field(default=None, description="signal-to-noise ratio [dB]; no noise if left out")
    wander: float = Field(default=0.0, ge=0, le=0.1, description="slow variation of the rotation rate, relative [-]")
    speckle: NotNegative = Field(default=0.0, description="speckle noise, which repeats every revolution [m/s]")
    runout: list[Pair] = Field(default=[], description="run-out, [cos, sin] at 1, 2, ... times the rotation rate [m/s]")


class RigTable(Table):
    """[rig]."""

    seed: int = Field(ge=0, description="seed of all random numbers")
    zeta: Damping = Field(description="median damping ratio of the modes [-]")
    zeta_spread: float = Field(
        default=0.0, ge=0, lt=2, description="standard deviation of the logarithm of the modes' damping ratios [-]"
    )
    quantity: Literal["receptance", "mobility", "accelerance"] = Field(
        default="accelerance", description="measured quantity"
    )
    drive: list[PlaceTable] = Field(
        min_length=1, description="tables [[rig.drive]]: points of excitation, at least one"
    )
    sensor: list[SensorTable] = Field(default=[], description="tables [[rig.sensor]]: measured points")
    test: ResponsesTable | None = Field(default=None, description="test of frequency responses")
    scan: ScanTable | None = Field(default=None, description="circle scan")
