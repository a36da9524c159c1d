"""
Parts: kernels as other kernels call them.

A kernel that Python calls is a root. What it calls are its parts: they become LLVM's intermediate
code, which is linked into the root and optimised there, as a whole and once. Numba on its own
would optimise every part, make machine code of it that nothing ever calls, link the result into
each caller, and do the same again there: that is twice the work for the same machine code.

This is a compiler pipeline in numba's sense, and a code library that stays intermediate code.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import AnalysisPass, register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering


class PartLibrary(JITCodeLibrary):
    """The intermediate code of a part, as it was lowered."""

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        #: What has to be linked into a root that calls the part: this, and all that it calls.
        self.needed: dict[Any, None] = {self: None}

    def add_linking_library(self, library: Any) -> None:
        """Take note of what the root has to link."""
        self.needed[library] = None

    def finalize(self) -> None:
        """Stay as it is: neither link, nor optimise, nor make machine code."""
        self._finalized = True


@register_pass(mutates_CFG=False, analysis_only=True)
class _OfferToRoots(AnalysisPass):
    """Register the code of a part for the calls of other kernels."""

    _name = 'hnr_planner_offer_to_roots'

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Give the part a key in the place of a function that Python could call."""
        key = object()
        lowered = state['cr']
        state.targetctx.insert_user_function(key, lowered.fndesc, tuple(state.library.needed))
        state['cr'] = lowered._replace(cfunc=key)
        return False


class _PartCompiler(CompilerBase):
    """Numba's pipeline, up to intermediate code."""

    def define_pipelines(self) -> list[Any]:
        """Return the pipeline for machine code, with another end."""
        state: Any = self.state
        state.flags.no_compile = True
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        passes = DefaultPassBuilder.define_nopython_pipeline(state)
        passes.add_pass_after(_OfferToRoots, NativeLowering)
        passes.finalize()
        return [passes]


class Part(CPUDispatcher):
    """What compiles a function as a part, for each signature."""

    def __init__(self, function: Any, options: dict[str, Any]) -> None:
        without_wrapper = {**options, 'no_cpython_wrapper': True}
        super().__init__(function, targetoptions=without_wrapper, pipeline_class=_PartCompiler)

    def add_overload(self, code: Any) -> None:
        """Keep the code for other kernels; there is nothing that Python could call."""
        self.overloads[tuple(code.signature.args)] = code
