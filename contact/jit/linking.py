"""Machine code that is the same wherever it runs, and of whole loops alone.

Numba links copies of the called functions beside the caller, under names that the whole process shares. Where a name
is there already, the linker takes that function: in the run that compiles, the one compiled by itself; in a run that
reads the cache, the copy. Both are right, but sums are ordered as each was optimised, and results differ in the last
bits. Here the copies become private to their caller, and that before they are optimised: those with one caller become
part of it.

A part that only compiled functions call is copied into each of them and optimised there. To optimise it by itself too,
and to make machine code that nothing calls, took a third of the time to compile a loop: `Part` leaves both out.

LLVM's passes over each function as it is handed over are left out: those over the whole loop begin with the same, and
without them a rub of several tips was compiled in a tenth less time to a loop that is as fast.

Numba's passes for closures, array expressions, literals and `with` find nothing in step loops and are left out, too:
each goes through the whole function, and what they ask for is worked out anew after each.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import binding
from numba.core import typed_passes, untyped_passes
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager

Manager: Any = PassManager
before: Any = untyped_passes
after: Any = typed_passes
PASSES = (
    before.TranslateByteCode, before.FixupArgs, before.IRProcessing, before.RewriteSemanticConstants,
    before.DeadBranchPrune, before.GenericRewrites, before.ReconstructSSA, before.DeadBranchPrune,
    after.NopythonTypeInference, after.PreLowerStripPhis, after.IRLegalization, after.AnnotateTypes,
    after.NativeLowering, after.NoPythonBackend,
)  # fmt: skip
ENVIRONMENT = "_ZN08NumbaEnv"  # how the names begin under which numba looks for a function's environment


class AsWritten(JITCodeLibrary):
    """A compiled function, not optimised before it is linked with those it calls."""

    def _optimize_functions(self, module: Any) -> None:
        library: Any = self
        module.data_layout = library._codegen._data_layout


class SealedLibrary(AsWritten):
    """A compiled function with the functions it calls, closed against all others."""

    def _optimize_final_module(self) -> None:
        _relink(self._final_module, binding.Linkage.linkonce_odr, "internal")
        self._optimise()
        # what callers link is read back as from the cache, so that they too are compiled alike whoever was first
        shared = binding.parse_bitcode(self._final_module.as_bitcode())
        _relink(shared, binding.Linkage.external, "linkonce_odr")
        self._shared_module = shared

    def _optimise(self) -> None:
        optimise: Any = super()._optimize_final_module
        optimise()


class VectorLibrary(SealedLibrary):
    """The same without the compiler's own vectors and copies of loop bodies."""

    def _optimise(self) -> None:
        library: Any = self
        tuning: Any = binding.create_pipeline_tuning_options(speed_level=3)
        tuning.loop_vectorization = tuning.loop_unrolling = False
        builder: Any = binding.create_pass_builder(library._codegen._tm, tuning)
        builder.getModulePassManager().run(library._final_module, builder)


class PartLibrary(AsWritten):
    """A function as it was written, for its callers to take in."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        library: Any = self
        engine = library._codegen._engine
        names = [v.name for v in library._final_module.global_variables if v.name.startswith(ENVIRONMENT)]
        # numba sets the environment of every function it compiles: without a place for it the process would end
        places = [f'@"{name}" = common global i64 0' for name in names if not engine.is_symbol_defined(name)]
        library._codegen._add_module(binding.parse_assembly("\n".join(places)))
        library._finalize_specific()
        library._finalized = True


class SealedPipeline(CompilerBase):
    """Numba's compiler with the passes that step loops need, into sealed libraries."""

    library: type[JITCodeLibrary] = SealedLibrary

    def define_pipelines(self) -> list[PassManager]:
        """What is done one after the other."""
        manager = Manager("step loops")
        for each in PASSES:
            manager.add_pass(each, each.__name__)
        manager.finalize()
        return [manager]

    def compile_extra(self, func: Callable[..., object]) -> Any:
        """Compile a function; its name is that of its library."""
        library: Any = self.library
        self.state.library = library(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        compile_bytecode: Any = super().compile_extra
        return compile_bytecode(func)


class VectorPipeline(SealedPipeline):
    """The same, for loops that are written as vectors where they are long."""

    library = VectorLibrary


class PartPipeline(SealedPipeline):
    """The same, into libraries that hold no machine code."""

    library = PartLibrary


def _relink(module: Any, found: Any, linkage: str) -> None:
    for function in module.functions:
        if not function.is_declaration and function.linkage == found:
            function.linkage = linkage
