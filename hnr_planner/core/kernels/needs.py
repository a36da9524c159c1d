"""
Needs: machine code that somebody asks for, named so that another process finds it.

A need is a kernel and the types of its arguments. A workload is a function that stands for a use
of the package (finding paths, say): running it once tells which machine code that use needs. What
it told is kept in the cache folder, so that the next process knows without running it.
"""

from collections.abc import Iterable
import importlib
import operator
from pathlib import Path
import pickle
from typing import Any, NamedTuple
import uuid

from hnr_planner.core.kernels.cache_folder import cache_folder


class Need(NamedTuple):
    """Machine code for one signature of one kernel."""

    #: Module and qualified name of the kernel.
    module: str
    name: str
    #: Pickled types of the arguments.
    types: bytes

    def resolve(self) -> tuple[Any, Any]:
        """Return the kernel and the signature; import what is not imported yet."""
        kernel = operator.attrgetter(self.name)(importlib.import_module(self.module))
        return kernel, pickle.loads(self.types)


class Workload(NamedTuple):
    """A function without arguments that makes the calls of a use, by its name."""

    module: str
    name: str

    def run(self) -> None:
        """Make the calls."""
        getattr(importlib.import_module(self.module), self.name)()


def need_of(kernel: Any, signature: Any) -> Need | None:
    """Return a need; None where another process would not find the kernel or its types."""
    function = kernel.py_func
    try:
        need = Need(function.__module__, function.__qualname__, pickle.dumps(signature))
        found, _ = need.resolve()
    except Exception:  # a type that does not pickle, a module that cannot be imported by name
        return None
    return need if found is kernel and function.__module__ != '__main__' else None


def known_needs(workload: Workload) -> list[Need] | None:
    """Return what a workload was found to need; None if it never ran with these sources."""
    try:
        needs: list[Need] = pickle.loads(_file(workload).read_bytes())
    except (OSError, EOFError, pickle.UnpicklingError):
        return None
    return needs


def keep_needs(workload: Workload, needs: Iterable[Need]) -> None:
    """Keep what a workload was found to need, where the cache folder can be written."""
    file = _file(workload)
    temporary = file.with_suffix(f'.{uuid.uuid4().hex[:8]}')
    try:
        temporary.write_bytes(pickle.dumps(list(needs)))
        temporary.replace(file)
    except OSError:
        temporary.unlink(missing_ok=True)


def _file(workload: Workload) -> Path:
    return cache_folder() / f'{workload.module}.{workload.name}.needs'
