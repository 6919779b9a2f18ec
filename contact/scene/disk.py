"""Scene files of kind "disk": a disk of blades before a turning casing, every tip a contact."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from contact.base.arrays import readonly
from contact.model.bodies.modal_body import ModalBody
from contact.model.gaps.bladed_disk import BladedDisk, pair_rim
from contact.model.gaps.permanent import ModalPair
from contact.model.gaps.rub import Rub, Start
from contact.model.gaps.rub_laws import RimProfile, Speed
from contact.scene.coating import CoatingTable
from contact.scene.record import RecordTable
from contact.scene.roundness import Roundness
from contact.scene.scheme import Friction, NotNegative, Positive, RunHead, ScanTable, Table

Ratio = Annotated[FiniteFloat, Field(ge=0, lt=1)]


class DiskHead(RunHead):
    """[scene] of kind "disk"."""

    kind: Literal["disk"]


class DiskPairTable(Table):
    """[casing.pair]: a casing by its pair of n diameters alone; `kick` modal velocity of its cosine at t = 0."""

    n: Annotated[int, Field(ge=1)]
    freq_hz: Positive
    modal_mass: Positive
    radius: Positive
    zeta: Ratio = 0.0
    kick: FiniteFloat = 0.0


class DiskCasingTable(Table):
    """[casing]: a modal basis file of kind "rim", or a pair."""

    basis: str | None = None
    pair: DiskPairTable | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> DiskCasingTable:
        if (self.basis is None) == (self.pair is None):
            raise ValueError(f"{'nothing' if self.basis is None else 'basis and pair'} found, expected one of both")
        return self

    def modes(self, folder: Path) -> ModalBody:
        """The casing; a basis file is found in `folder`. Raises InputError."""
        if self.pair is None:
            return ModalBody.load(folder / str(self.basis))
        given = self.pair
        pair = ModalPair(n=given.n, freq_hz=given.freq_hz, modal_mass=given.modal_mass, zeta=given.zeta)
        return pair_rim(pair, radius=given.radius)


class DiskTable(Table):
    """[disk]: the fields of `BladedDisk`."""

    blades: Annotated[int, Field(ge=2, le=1000)]
    freq_hz: Positive
    modal_mass: Positive
    coupling: NotNegative = 0.0
    mistuning: list[FiniteFloat] | None = None
    zeta: Ratio = 0.0
    compliance: NotNegative = 0.0
    lean_deg: Annotated[FiniteFloat, Field(gt=-90, lt=90)] = 0.0


class DiskContact(Roundness):
    """[contact]: clearance [m], friction coefficient, out-of-roundness."""

    clearance: FiniteFloat
    friction: Friction = 0.0


class DiskSpeed(Table):
    """[speed]: turns per second; `scan` the speeds of interactions."""

    hz: FiniteFloat
    scan: ScanTable | None = None


class DiskScheme(Table):
    """[scheme] of a disk: exact-modal."""

    kind: Literal["exact-modal"]
    law: Literal["auto", "forward", "averaged"] = "auto"
    dt: Positive


class DiskFile(Table):
    """A disk of blades before a turning casing."""

    scene: DiskHead
    casing: DiskCasingTable
    disk: DiskTable
    contact: DiskContact
    coating: CoatingTable | None = None
    speed: DiskSpeed
    scheme: DiskScheme
    record: RecordTable | None = None

    def files(self, folder: Path) -> tuple[Path, ...]:
        """The basis file, if the casing has one."""
        return () if self.casing.basis is None else (folder / self.casing.basis,)

    def rub(self, folder: Path) -> Rub:
        """The scene; a basis file is found in `folder`. Raises InputError."""
        casing, disk = self.casing.modes(folder), BladedDisk(**self.disk.model_dump())
        kick = np.zeros(casing.omega.size)
        kick[0] = 0.0 if self.casing.pair is None else self.casing.pair.kick
        return Rub(
            casing, (disk.body(),), disk.tips(), clearance=self.contact.clearance,
            speed=Speed.constant(self.speed.hz), profile=RimProfile.fourier(self.contact.terms(casing)),
            casing_start=Start(velocity=readonly(kick)),
        )  # fmt: skip
