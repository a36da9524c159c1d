"""
Parts: kernels as other kernels call them.

A kernel that Python calls is a root. The kernels that a root calls are its parts: they become
LLVM's intermediate code, which is linked into the root and optimised there, as a whole and once.
Numba on its own would optimise every part, make machine code of the part that nothing ever calls,
link the result into each caller, and optimise it again there: twice the work for the same code.

This is a compiler pipeline in numba's sense, and a code library that stays intermediate code.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering


class PartLibrary(JITCodeLibrary):
    """The code library of one part: LLVM's intermediate code, never optimised on its own."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        #: Libraries to link into a root that calls the part: this one, and those of its callees.
        self.needed: dict[Any, None] = {self: None}

    def add_linking_library(self, library: Any) -> None:
        """Add ``library`` to those that a root has to link, instead of linking it here."""
        self.needed[library] = None

    def finalize(self) -> None:
        """Mark the library as final, but neither link, nor optimise, nor make machine code."""
        self._finalized = True


@register_pass(mutates_CFG=False, analysis_only=True)
class _OfferToRoots(AnalysisPass):
    """Compiler pass that registers the code of a part for calls by other kernels."""

    _name = 'hnr_planner_offer_to_roots'

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """
        Register the part under a new key, by which calls of other kernels find its code.

        The key takes the place of the function that Python could call. Return False: the code is
        not changed.
        """
        key = object()
        lowered = state['cr']
        state.targetctx.insert_user_function(key, lowered.fndesc, tuple(state.library.needed))
        state['cr'] = lowered._replace(cfunc=key)
        return False


class _PartCompiler(CompilerBase):
    """Numba's compiler, which ends with intermediate code instead of machine code."""

    def define_pipelines(self) -> list[Any]:
        """Return numba's nopython pipeline, with the pass ``_OfferToRoots`` after lowering."""
        state: Any = self.state
        state.flags.no_compile = True
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        passes = DefaultPassBuilder.define_nopython_pipeline(state)
        passes.add_pass_after(_OfferToRoots, NativeLowering)
        passes.finalize()
        return [passes]


class Part(CPUDispatcher):
    """A dispatcher that compiles a function as a part, once for each signature."""

    def __init__(self, function: Any, options: dict[str, Any]) -> None:
        without_wrapper = {**options, 'no_cpython_wrapper': True}
        super().__init__(function, targetoptions=without_wrapper, pipeline_class=_PartCompiler)

    def add_overload(self, code: Any) -> None:
        """Store compiled code for calls by other kernels; Python cannot call it."""
        self.overloads[tuple(code.signature.args)] = code
