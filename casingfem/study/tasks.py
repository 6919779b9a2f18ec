"""Tasks of a study: the update and the reduction it describes, with errors that name its keys."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from casingfem.io.arrays import FloatArray
from casingfem.modal.basis import ModalBasis
from casingfem.modal.cyclic.bladed import BladedWheel, Influence
from casingfem.modal.cyclic.engine_orders import (
    Amplification,
    EngineOrderResponse,
    OrderLoad,
    amplification,
    engine_order_response,
)
from casingfem.modal.cyclic.reduction import OF_A_DIAMETER, cyclic_reduce
from casingfem.modal.reduction import reduce
from casingfem.structure.imported.assembly import MeshStructure
from casingfem.structure.shell.shell import Shell
from casingfem.study.imported import MeshStudy
from casingfem.study.load import Study
from casingfem.study.problems import StudyError
from casingfem.updating.problem import Progress
from casingfem.updating.regularisation import Regularisation
from casingfem.updating.result import UpdateResult
from casingfem.updating.uncertainty.posterior import Laplace, laplace
from casingfem.updating.uncertainty.prediction import LeftOut, leave_one_out
from casingfem.updating.uncertainty.sampling import PosteriorSamples, sample_posterior
from casingfem.updating.updating import update
from contact.io.tables import value_of


def run_update(study: Study | MeshStudy, progress: Progress | None = None) -> UpdateResult:
    """Run the update of a study.

    Raises
    ------
    StudyError
        Without [update], or if its table and parameters do not define an update.
    """
    tables = study.file.update
    if tables is None or study.table is None:
        raise study.error("update", "nothing", "a table [update]: table, [[update.parameter]]")
    try:
        return update(
            study.start,
            study.table,
            list(study.parameters),
            count=tables.count,
            reach=tables.reach,
            model_error=tables.model_error,
            shapes=study.shapes,
            regularise=None
            if tables.regularise is None
            else Regularisation(rule=tables.regularise, names=tuple(tables.regularised)),
            progress=progress,
            outliers=tables.outliers,
        )
    except ValueError as error:
        raise StudyError([f"{study.path}: update: {error}"]) from error


def judge_update(
    study: Study | MeshStudy, fit: UpdateResult, *, left_out: bool, posterior: str | None, say: Callable[[str], None]
) -> dict[str, LeftOut | Laplace | PosteriorSamples]:
    """Requested results beyond the fit, by their keys in the JSON document.

    Raises
    ------
    StudyError
        If it is impossible: too few rows, a fit that is not a minimum, or no emcee.
    """
    found: dict[str, LeftOut | Laplace | PosteriorSamples] = {}
    try:
        if left_out:
            say("predicting rows left out")
            found["leave_one_out"] = leave_one_out(fit)
        if posterior is not None:
            say(f"posterior by {posterior}")
            found["posterior"] = laplace(fit) if posterior == "laplace" else sample_posterior(fit)
    except ValueError as error:
        raise StudyError([f"{study.path}: update: {error}"]) from error
    return found


Answer = tuple[EngineOrderResponse, Amplification | None]


def run_response(study: Study | MeshStudy) -> tuple[BladedWheel, list[Answer]]:
    """The wheel of a study, and for each [[response]] the amplitudes over speed and the draws of mistuned blades.

    Raises
    ------
    StudyError
        Without [cyclic], [reduce] or [[response]], or if its channels or its force do not exist on the wheel.
    """
    wheel, tables = study.wheel if isinstance(study, MeshStudy) else None, study.file.response
    if wheel is None:
        raise study.error("cyclic", "none", "a wheel: [cyclic] with its sectors, which engine orders need")
    if study.interface is None or study.file.reduce is None:
        raise study.error("reduce", "nothing", "a table [reduce] with the interface of the blade's tip")
    if not tables:
        raise study.error("response", "none", "a table [[response]]: order, from_hz, to_hz, zeta")
    count = study.file.reduce.modes if "modes" in study.file.reduce.model_fields_set else OF_A_DIAMETER
    try:
        loads = [value_of(table, OrderLoad) for table in tables]
        channels = sorted({load.channel for load in loads})
        if len(channels) > 1:
            raise study.error("response.channel", ", ".join(channels), "one channel in all tables [[response]]")
        bladed = BladedWheel.of(wheel.sector, study.interface, channel=channels[0], modes=count, blade=wheel.blade)
        paths = [None if table.influence is None else study.path.parent / table.influence for table in tables]
        answers = [answer(bladed, wheel.deviations, *pair) for pair in zip(loads, paths, strict=True)]
    except StudyError:
        raise
    except ValueError as error:
        raise StudyError([f"{study.path}: response: {error}"]) from error
    return bladed, answers


def answer(wheel: BladedWheel, deviations: FloatArray | None, load: OrderLoad, path: Path | None) -> Answer:
    """Amplitudes over speed under one engine order, and the requested draws.

    `path` locates the aerodynamic coefficients.
    """
    air = None if path is None else Influence.from_csv(path)
    found = engine_order_response(
        wheel, load.order, load.speeds, force=load.force, zeta=load.zeta, deviations=deviations, influence=air
    )
    if load.sigma is None:
        return found, None
    drawn = amplification(
        wheel, load.order, sigma=load.sigma, draws=load.draws, seed=load.seed, zeta=load.zeta, influence=air,
        band_hz=(load.order * load.from_hz, load.order * load.to_hz),
    )  # fmt: skip
    return found, drawn


def run_reduce(study: Study | MeshStudy, shell: Shell | MeshStructure | None = None) -> ModalBasis:
    """Run the reduction of a study, for its own structure or another one (such as an updated one).

    Raises
    ------
    StudyError
        Without [reduce], or if this reduction is impossible.
    """
    tables = study.file.reduce
    if tables is None or study.interface is None:
        raise study.error("reduce", "nothing", "a table [reduce]: interface, modes")
    wheel = study.wheel if isinstance(study, MeshStudy) else None
    if wheel is not None:
        for key in ("method", "output"):
            if key in tables.model_fields_set:
                expected = "no such key, as a wheel is reduced with free modes and without outputs"
                raise study.error(f"reduce.{key}", f"{key} and [cyclic]", expected)
    try:
        if wheel is not None:
            basis = cyclic_reduce(
                wheel.sector,
                study.interface,
                modes=tables.modes if "modes" in tables.model_fields_set else OF_A_DIAMETER,
                zeta=tables.zeta,
                deviations=wheel.deviations,
                blade=wheel.blade,
            )
        else:
            basis = reduce(
                study.structure if shell is None else shell,
                study.interface,
                modes=tables.modes,
                method=tables.method,
                zeta=tables.zeta,
                recovery=tables.recovery,
                outputs=[table.output() for table in tables.output],
            )
    except ValueError as error:
        raise StudyError([f"{study.path}: reduce: {error}"]) from error
    return replace(basis, provenance={**basis.provenance, "source": study.source})
