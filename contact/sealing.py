"""Machine code that is the same wherever it runs: a compiled function calls its own copies of what it calls.

Numba links copies of the called functions beside the caller, under names that the whole process shares. Where a name
is there already, the linker takes that function: in the run that compiles, the one compiled by itself; in a run that
reads the cache, the copy. Both are right, but sums are ordered as each was optimised, and results differ in the last
bits. Here the copies become private to their caller before machine code is made of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import binding
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class SealedLibrary(JITCodeLibrary):
    """A compiled function with the functions it calls, closed against all others."""

    def _optimize_final_module(self) -> None:
        optimise: Any = super()._optimize_final_module
        optimise()
        # what callers link is read back as from the cache, so that they too are compiled alike whoever was first
        shared = binding.parse_bitcode(self._final_module.as_bitcode())
        _relink(shared, binding.Linkage.external, "linkonce_odr")
        self._shared_module = shared
        _relink(self._final_module, binding.Linkage.linkonce_odr, "internal")


class SealedPipeline(Compiler):
    """Numba's compiler, into sealed libraries."""

    def compile_extra(self, func: Callable[..., object]) -> Any:
        """Compile a function; its name is that of its library."""
        library: Any = SealedLibrary
        self.state.library = library(self.state.targetctx.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        compile_bytecode: Any = super().compile_extra
        return compile_bytecode(func)


def _relink(module: Any, found: Any, linkage: str) -> None:
    for function in module.functions:
        if not function.is_declaration and function.linkage == found:
            function.linkage = linkage
