"""`casingfem modes` of a wheel of sectors: its modes by nodal diameter, waves with Coriolis forces, mistuned modes."""

from pathlib import Path

from casingfem.cli.mode_files import modes_csv, shapes, universal
from casingfem.cli.model_warnings import collected
from casingfem.cli.running import ProgressMessage, deliver
from casingfem.modal.cyclic.mistuned import mistuned_modes
from casingfem.modal.cyclic.modes import cyclic_modes, wheel_modes
from casingfem.modal.cyclic.reduction import OF_A_DIAMETER
from casingfem.modal.cyclic.whirl import cyclic_whirl
from casingfem.study import MeshStudy
from casingfem.study.cyclic import Wheel
from contact.io.outfiles import Content, json_text


def print_wheel(
    study: MeshStudy,
    wheel: Wheel,
    *,
    as_json: bool,
    out: Path | None,
    sigma: float,
    shown: tuple[int, ...] | None,
    vtu: bool,
    uff: bool,
) -> None:
    """Compute what the study of a wheel asks for, print it, and write its files."""
    asked = study.file.modes
    count = asked.count if "count" in asked.model_fields_set else OF_A_DIAMETER
    if asked.band_hz is not None and (wheel.coriolis or wheel.deviations is not None):
        raise study.error("modes.band_hz", "a band of a mistuned or whirling wheel", "count, of each nodal diameter")
    with ProgressMessage(f"modes of {study.path.name}") as working:
        wanted = asked.wanted.get("band", count)
        found = cyclic_modes(wheel.sector, wanted, diameters=wheel.diameters)
        working.say(f"modes of {study.path.name}: waves, mistuning")
        whirl = cyclic_whirl(wheel.sector, count, diameters=wheel.diameters) if wheel.coriolis else None
        mistuned = None
        if wheel.deviations is not None:
            mistuned = mistuned_modes(wheel.sector, wheel.deviations, count, blade=wheel.blade)
    if found.rigid.any() and asked.elastic_only:
        what = f"true, and {int(found.rigid.sum())} rigid modes"
        raise study.error("modes.elastic_only", what, "a structure whose supports leave no rigid motion")
    parts = [part for part in (found, whirl, mistuned) if part is not None]
    document = {
        "modes": found.records(),
        "whirl": None if whirl is None else whirl.records(),
        "mistuned": None if mistuned is None else mistuned.records(),
        "sectors": wheel.sector.sectors,
        "dofs": found.unknowns,
        "seconds": found.seconds,
        "sturm_counts": {str(n): counted for n, counted in found.sturm_counts.items()},
        "warnings": collected(),
        "source": study.source,
    }
    files: dict[str, Content] = {
        "modes.json": json_text(document, indent=1),
        "modes.csv": modes_csv(found, study, sigma),
    }
    if vtu or uff:
        whole = wheel_modes(found)
        files |= (shapes(whole, shown) if vtu else {}) | (universal(whole, shown) if uff else {})
    deliver(document, "\n".join(map(repr, parts)), as_json=as_json, out=out, files=files)
