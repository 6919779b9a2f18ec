"""Channels of a set in order: sensors by references, angles of the sensors, measured quantities."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from casingfem.errors import InputError
from casingfem.experiment.frf.forms import FORMS, power_of_unit
from casingfem.experiment.frf.frf_set import FrfSet
from casingfem.io.arrays import Array, FloatArray, IntArray, freeze
from contact.io.brief import brief


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorGrid:
    """Sensors (point, direction, angle [rad], nan where unknown) and the channel of each sensor and reference.

    `channels` (sensors, references) index the set; `references` (references, 2) are points and directions. `places`
    (sensors, 3) are positions [m], nan where unknown.
    """

    points: IntArray
    directions: IntArray
    theta: FloatArray
    references: IntArray
    channels: IntArray
    places: FloatArray

    __repr__ = brief

    def __post_init__(self) -> None:
        freeze(self, "points", "directions", "theta", "references", "channels", "places")

    def __len__(self) -> int:
        return len(self.points)


def sensor_grid(
    frfs: FrfSet, angles: Mapping[int, float] | None, places: Mapping[int, ArrayLike] | None = None
) -> SensorGrid:
    """Sort the channels of a set; angles [deg] and positions [m] by response point.

    Raises
    ------
    InputError
        A sensor has no channel to one of the references, a channel is repeated, or a sensor has no angle.
    """
    responses = np.column_stack([frfs.response_point, frfs.response_direction])
    references = np.column_stack([frfs.reference_point, frfs.reference_direction])
    sensors, sensor = np.unique(responses, axis=0, return_inverse=True)
    bases, base = np.unique(references, axis=0, return_inverse=True)
    channels = np.full((len(sensors), len(bases)), -1)
    for k, at in enumerate(zip(sensor.ravel().tolist(), base.ravel().tolist(), strict=True)):
        if channels[at] >= 0:
            found = f"channels {channels[at] + 1} and {k + 1} from the same sensor to the same reference"
            raise InputError(frfs.path, found=found, expected="each once")
        channels[at] = k
    if np.any(channels < 0):
        row, column = np.argwhere(channels < 0)[0]
        found = f"no channel from point {sensors[row, 0]} to reference {bases[column, 0]}"
        raise InputError(frfs.path, found=found, expected="every sensor with every reference")
    theta = np.full(len(sensors), np.nan)
    if angles is not None:
        for k, point in enumerate(sensors[:, 0].tolist()):
            if point not in angles or not np.isfinite(angles[point]):
                raise InputError(frfs.path, found=f"no angle for point {point}", expected="an angle of every sensor")
            theta[k] = np.radians(angles[point])
    nowhere = np.full(3, np.nan)
    known = {} if places is None else places
    stands = [np.asarray(known.get(point, nowhere), float) for point in sensors[:, 0].tolist()]
    return SensorGrid(
        points=sensors[:, 0],
        directions=sensors[:, 1],
        theta=theta,
        references=bases,
        channels=channels,
        places=np.array(stands),
    )


def angles_of(places: Mapping[int, FloatArray]) -> dict[int, float]:
    """Angle about the z axis [deg] of each position, by point."""
    return {point: float(np.degrees(np.arctan2(place[1], place[0]))) for point, place in places.items()}


def form_of(frfs: FrfSet, form: str | None) -> int | None:
    """Power of j omega of the responses relative to receptances: as stated, or from the unit and the set's own form.

    None if neither is known.

    Raises
    ------
    InputError
        The unit is not one of motion, or unit and form of the file contradict each other.

    >>> form_of(FrfSet.from_arrays(kind="frf", x=[1.0], responses=[[1j]], unit="(m/s^2)/N"), None)
    2
    """
    if form is not None:
        if form not in FORMS:
            raise InputError(frfs.path, found=f"form {form!r}", expected=" or ".join(FORMS))
        return FORMS[form]
    say = "form=" + "|".join(FORMS)
    try:
        power = power_of_unit(frfs.unit)
    except ValueError as error:
        raise InputError(frfs.path, found=str(error), expected=f"one such as (m/s^2)/N, or {say}") from None
    stated = FORMS.get(frfs.form)
    if None not in (power, stated) and power != stated:
        names = {value: name for name, value in FORMS.items()}
        found = f"unit {frfs.unit!r}, which is of {names[power or 0]}, in a file that states {frfs.form}"
        raise InputError(frfs.path, found=found, expected=f"one of the two, or {say}")
    return stated if power is None else power


def radial_signs(grid: SensorGrid) -> Array:
    """Sign of each sensor, (sensors,): a negative direction reverses the response."""
    return np.where(grid.directions < 0, -1.0, 1.0)
