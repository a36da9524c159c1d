"""
Needs: requests for machine code, which name a kernel so that another process finds it.

A need is a kernel and the types of its arguments. A workload is a function that stands for a use
of the package (finding paths, say): running it once shows which machine code that use needs. The
list of these needs is kept in the cache folder, so that the next process need not run the
workload.
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
    """A request for machine code of one kernel for one signature (the types of its arguments)."""

    #: Module and qualified name of the kernel.
    module: str
    name: str
    #: Pickled types of the arguments.
    types: bytes

    def resolve(self) -> tuple[Any, Any]:
        """Return the kernel and the signature; import the kernel's module if necessary."""
        kernel = operator.attrgetter(self.name)(importlib.import_module(self.module))
        return kernel, pickle.loads(self.types)


class Workload(NamedTuple):
    """
    A function that makes the kernel calls of one use of the package, given by module and name.

    The function takes no arguments.
    """

    module: str
    name: str

    def run(self) -> None:
        """Import the function's module if necessary, and call the function."""
        getattr(importlib.import_module(self.module), self.name)()


def need_of(kernel: Any, signature: Any) -> Need | None:
    """
    Return the need for machine code of ``kernel`` for ``signature``.

    None if another process could not find the kernel by its name, or could not unpickle the types.
    """
    function = kernel.py_func
    try:
        need = Need(function.__module__, function.__qualname__, pickle.dumps(signature))
        found, _ = need.resolve()
    except Exception:  # a type that does not pickle, a module that cannot be imported by name
        return None
    return need if found is kernel and function.__module__ != '__main__' else None


def known_needs(workload: Workload) -> list[Need] | None:
    """Return the needs that ``keep_needs`` has kept for a workload; None if there are none."""
    try:
        needs: list[Need] = pickle.loads(_file(workload).read_bytes())
    except (OSError, EOFError, pickle.UnpicklingError):
        return None
    return needs


def keep_needs(workload: Workload, needs: Iterable[Need]) -> None:
    """Write the needs of a workload to the cache folder; do nothing if that fails."""
    file = _file(workload)
    temporary = file.with_suffix(f'.{uuid.uuid4().hex[:8]}')
    try:
        temporary.write_bytes(pickle.dumps(list(needs)))
        temporary.replace(file)
    except OSError:
        temporary.unlink(missing_ok=True)


def _file(workload: Workload) -> Path:
    return cache_folder() / f'{workload.module}.{workload.name}.needs'
