"""The typed decorators of compiled functions; numba is imported only when a run starts.

Machine code is compiled for whole loops and is the same in every process. Numba links copies of the called functions
beside the caller, under names that the whole process shares. If a name exists already, the linker takes that function:
in the process that compiles, the separately compiled one; in a process that reads the cache, the copy. Both are
correct, but the order of sums depends on the optimisation, so results differ in the last bits. Here the copies become
private to their caller before they are optimised; those with one caller become part of it.

A part that only compiled functions call is copied into each of them and optimised there. To optimise it by itself too,
and to make machine code that nothing calls, took a third of the time to compile a loop: `Part` leaves both out.

LLVM's passes over each single function are left out, since the passes over the whole loop repeat them. A rub of several
tips compiles in 10 % less time to an equally fast loop.

Numba's passes for closures, array expressions, literals and `with` find nothing in step loops and are left out, too:
each pass visits the whole function, and its analyses are repeated after each.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar, cast

import numba
import numba.experimental.function_type
from llvmlite import binding
from numba.core import typed_passes, types, untyped_passes
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature

from contact.io.interrupts import interrupts_held
from contact.jit.bundle import bundled
from contact.jit.machine_code import MachineCode
from contact.jit.progress import Announcement, Uncollected, announce, calls_looked_up_once, with_room

Manager: Any = PassManager
before: Any = untyped_passes
after: Any = typed_passes
PASSES = (
    before.TranslateByteCode, before.FixupArgs, before.IRProcessing, before.RewriteSemanticConstants,
    before.DeadBranchPrune, before.GenericRewrites, before.ReconstructSSA, before.DeadBranchPrune,
    after.NopythonTypeInference, after.PreLowerStripPhis, after.IRLegalization, after.AnnotateTypes,
    after.NativeLowering, after.NoPythonBackend,
)  # fmt: skip
ENVIRONMENT = "_ZN08NumbaEnv"  # prefix of the names under which numba searches for a function's environment
CFunction: Any = CFunc
normalized: Any = normalize_signature
unliteral: Any = types.unliteral
protocol: Any = types.WrapperAddressProtocol
VECTOR: Any = types.Array(types.float64, 1, "C")
MATRIX: Any = types.Array(types.float64, 2, "C")
Function = TypeVar("Function", bound=Callable[..., object])
# no reference counts: loops get all their arrays, and counting references of views would take longer than the steps
BY_ADDRESS: Any = {"_nrt": False, "error_model": "numpy", "fastmath": {"reassoc", "contract", "nsz"}}
OPTIONS: Any = {**BY_ADDRESS, "no_cfunc_wrapper": True}
# no entry from Python, which numba would compile for each function
PART: Any = {"no_cpython_wrapper": True}


class AsWritten(JITCodeLibrary):
    """A compiled function that is optimised only after it is linked with the functions it calls."""

    def _optimize_functions(self, module: Any) -> None:
        library: Any = self
        module.data_layout = library._codegen._data_layout


class SealedLibrary(AsWritten):
    """A compiled function with the functions it calls, invisible to all others."""

    def finalize(self) -> None:
        """Link the functions that its parts call, each once; optimise and compile."""
        found: dict[Any, None] = dict.fromkeys(self._linking_libraries)
        waiting = list(found)
        while waiting:
            part = waiting.pop()
            if isinstance(part, PartLibrary):
                more = [each for each in part._linking_libraries if each not in found]
                found |= dict.fromkeys(more)
                waiting += more
        self._linking_libraries = list(found)
        finish: Any = super().finalize
        finish()

    def _optimize_final_module(self) -> None:
        _relink(self._final_module, binding.Linkage.linkonce_odr, "internal")
        self._optimise()
        # callers link the code as read back from the cache, so that all processes compile them equally
        shared = binding.parse_bitcode(self._final_module.as_bitcode())
        _relink(shared, binding.Linkage.external, "linkonce_odr")
        self._shared_module = shared

    def _optimise(self) -> None:
        optimise: Any = super()._optimize_final_module
        optimise()


class VectorLibrary(SealedLibrary):
    """A sealed library without the compiler's automatic vectorisation and loop unrolling."""

    def _optimise(self) -> None:
        library: Any = self
        tuning: Any = binding.create_pipeline_tuning_options(speed_level=3)
        tuning.loop_vectorization = tuning.loop_unrolling = False
        builder: Any = binding.create_pass_builder(library._codegen._tm, tuning)
        builder.getModulePassManager().run(library._final_module, builder)


class PartLibrary(AsWritten):
    """A function without optimisation, to be inlined into its callers; `SealedLibrary` links the functions it calls."""

    def finalize(self) -> None:
        """Make it ready for linking."""
        _relink(self._final_module, binding.Linkage.external, "linkonce_odr")
        self._finalize_final_module()

    def _finalize_final_module(self) -> None:
        library: Any = self
        engine = library._codegen._engine
        names = [v.name for v in library._final_module.global_variables if v.name.startswith(ENVIRONMENT)]
        # numba sets the environment of every function it compiles: without a place for it the process would end
        places = [f'@"{name}" = common global i64 0' for name in names if not engine.is_symbol_defined(name)]
        library._codegen._add_module(binding.parse_assembly("\n".join(places)))
        library._finalize_specific()
        library._finalized = True


class ApartLibrary(PartLibrary):
    """A part that its callers call, not inline: the time to optimise a function grows faster than its size."""

    def finalize(self) -> None:
        """Make it ready for linking."""
        for function in self._final_module.functions:
            if not function.is_declaration:
                function.add_function_attribute("noinline")
        super().finalize()


class SealedPipeline(CompilerBase):
    """Numba's compiler with the passes that step loops need, into sealed libraries."""

    library: type[JITCodeLibrary] = SealedLibrary

    def define_pipelines(self) -> list[PassManager]:
        """List the passes of the compiler in order."""
        manager = Manager("step loops")
        for each in PASSES:
            manager.add_pass(each, each.__name__)
        manager.finalize()
        return [manager]

    def compile_extra(self, func: Callable[..., object]) -> Any:
        """Compile a function; the library is named after it."""
        library: Any = self.library
        self.state.library = library(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        compile_bytecode: Any = super().compile_extra
        return compile_bytecode(func)


class VectorPipeline(SealedPipeline):
    """The sealed pipeline for loops whose long inner loops are written as vectors."""

    library = VectorLibrary


class PartPipeline(SealedPipeline):
    """The sealed pipeline for libraries without machine code."""

    library = PartLibrary


class ApartPipeline(SealedPipeline):
    """The sealed pipeline for parts that are not inlined."""

    library = ApartLibrary


def _relink(module: Any, found: Any, linkage: str) -> None:
    for function in module.functions:
        if not function.is_declaration and function.linkage == found:
            function.linkage = linkage


announce(Announcement(), Uncollected())


def jit_entry(function: Function) -> Function:
    """Compile a step loop that Python calls and that allocates nothing to machine code, cached on disk.

    Sums may be reassociated and products contracted, so that reductions vectorise; NaN keeps its meaning,
    so that a run that diverges is seen. The same input gives bit-identical results on one machine.
    """
    return compiled(function, OPTIONS)


def jit_vectors(function: Function) -> Function:
    """Compile a step loop whose long loops are written with `contact.jit.vector`, else as `jit_entry`.

    The other loops run once or twice; vectorising them only costs compile time.
    """
    return compiled(function, OPTIONS, pipeline=VectorPipeline)


def jit(function: Function) -> Function:
    """Compile a function that compiled functions call, else as `jit_entry`; Python calls compile it again."""
    return part(function, OPTIONS)


def jit_apart(function: Function) -> Function:
    """Compile a large part of a step loop that most steps or most runs do not call, else as `jit`."""
    return compiled(function, {**OPTIONS, **PART}, Part, ApartPipeline)


def jit_inside(function: Function) -> Function:
    """Compile a part of a step loop into its caller, else as `jit`: passing the many arrays of a state costs more."""
    return part(function, {**OPTIONS, "forceinline": True})


class Loop(CPUDispatcher):
    """A compiled function that is compiled once for all whole numbers.

    Otherwise numba compiles separately for each literal number that is passed, and for variables.
    """

    def compile(self, sig: Any) -> Any:
        """Compile for arguments of these types."""
        known: Any = super()
        with interrupts_held(), calls_looked_up_once():  # an exception in a callback of LLVM would be lost
            return with_room(known.compile, sig)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Types and template of a call from a compiled function."""
        known: Any = super()
        return known.get_call_template(
            [unliteral(kind) for kind in args], {name: unliteral(kind) for name, kind in kws.items()}
        )


class Entry(Loop):
    """A compiled function that Python calls; NamedTuples are passed as bundles."""

    def __call__(self, *args: Any) -> Any:
        """Run it."""
        run: Any = super().__call__
        return run(*[bundled(value) for value in args])


class Part(Loop):
    """A compiled function without its own machine code and without an entry from Python.

    It becomes part of its callers.
    """

    def __call__(self, *args: Any, **kws: Any) -> Any:
        """Also compile it as an entry, for a test or a single call; it must not return arrays."""
        return entry(self.py_func)(*args, **kws)


@cache
def entry(function: Callable[..., Any]) -> Callable[..., Any]:
    """The entry of a part, made when Python first calls it."""
    return compiled(function, OPTIONS)


def part(function: Function, options: dict[str, Any]) -> Function:
    """Mark a function that only compiled callers use; unchanged if numba is set not to compile."""
    return compiled(function, {**options, **PART}, Part, PartPipeline)


class ByAddress(protocol):  # type: ignore[misc]
    """A compiled function that loops call by its address: compiled once for all loops, and only if `used`.

    A subclass names the `function`, as Python has it, and its signature `kind`. A part of a loop that is compiled apart
    has the `pipeline` of the loop, so that its sums have the same order there.
    """

    kind: Any
    function: Callable[..., Any]
    pipeline: Any = SealedPipeline

    def __init__(self, *, used: bool) -> None:
        self.used = used

    def __call__(self, *arguments: Any) -> Any:
        """Run it in Python if numba does not compile."""
        return type(self).function(*arguments)

    def __wrapper_address__(self) -> int:
        """Address of the function; 0 if the run never calls it."""
        return address_of(self.function, self.kind, self.pipeline) if self.used else 0

    def signature(self) -> Any:
        """Argument types and return type."""
        return self.kind


@cache
def address_of(function: Callable[..., Any], kind: Any, pipeline: Any) -> int:
    """Compile a function that is called by its address."""
    made: Any = CFunction(function, normalized(kind), {}, BY_ADDRESS, pipeline_class=pipeline)
    made._cache = MachineCode(function)
    with interrupts_held(), calls_looked_up_once():
        with_room(made.compile)
    return int(made.address)


def compiled(
    function: Function, options: dict[str, Any], kind: type[Loop] = Entry,
    pipeline: type[SealedPipeline] = SealedPipeline,
) -> Function:  # fmt: skip
    """Compile with numba; entries are cached on disk, parts have no machine code of their own."""
    made: Any = numba.njit(pipeline_class=pipeline, **options)(function)
    if isinstance(made, CPUDispatcher):
        made.__class__ = kind
        if kind is Entry:
            dispatcher: Any = made
            dispatcher._cache = MachineCode(function)
    return cast(Function, made)
