"""
Compiled kernels: how plain functions become machine code, and back.

``@kernel`` compiles a function with numba: without the GIL, so that a node stays responsive while
it plans, and cached on disk, so that only the first start on a machine waits for the compiler.
``interpreted(kernel)`` gives the same function as plain Python again, kernels it calls included:
both must agree to the last bit, and tests hold them to it.

Numba's cache looks at the file of the kernel alone: a change in another file of the core would be
answered from machine code of the past. So the cache lies in a folder named by the contents of all
of the core's sources, and every edit starts a new one.
"""

import atexit
from collections.abc import Callable, Iterator
from functools import cache
import hashlib
import os
from pathlib import Path
import shutil
import tempfile
import types
from typing import Any
import warnings

from numba import njit
from numba.core import config
from numba.core.dispatcher import Dispatcher

CORE = Path(__file__).resolve().parents[1]
OPTIONS: dict[str, Any] = {'nogil': True, 'error_model': 'numpy'}
#: For what is put in wherever it is called.
INLINED: Any = {'forceinline': True}


def source_digest(folder: Path) -> str:
    """Digest of the names and contents of every Python file below ``folder``."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob('*.py')):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@cache
def cache_folder() -> Path:
    """
    Folder of the compiled kernels of exactly these sources.

    It lies in the user's cache (``NUMBA_CACHE_DIR`` or ``XDG_CACHE_HOME`` where set). Where that
    cannot be written a temporary folder takes its place, with a warning: every start compiles.
    """
    home = os.environ.get('NUMBA_CACHE_DIR') or os.environ.get('XDG_CACHE_HOME') or '~/.cache'
    folder = Path(home).expanduser() / 'hnr_planner' / source_digest(CORE)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        temporary = Path(tempfile.mkdtemp(prefix='hnr_planner_'))
        atexit.register(shutil.rmtree, temporary, ignore_errors=True)
        warnings.warn(
            f'compiled kernels cannot be kept in {folder} ({error}); using {temporary} instead, '
            f'so every start compiles again: set NUMBA_CACHE_DIR to a folder that can be written',
            RuntimeWarning,
            stacklevel=2,
        )
        return temporary


def kernel(function: Callable[..., Any], **more: Any) -> Dispatcher:
    """Compile ``function`` at its first call: no GIL, cached, IEEE arithmetic kept to the bit."""
    numba_config: Any = config
    before = numba_config.CACHE_DIR
    numba_config.CACHE_DIR = str(cache_folder())
    try:
        return njit(cache=True, **OPTIONS, **more)(function)
    finally:
        numba_config.CACHE_DIR = before


def inlined(function: Callable[..., Any]) -> Dispatcher:
    """
    Compile a kernel whose code is put in wherever a kernel calls it.

    A call hands on every field of every array: for the small parts of an inner loop that is more
    work than they do themselves.
    """
    return kernel(function, **INLINED)


def recompiled(function: Dispatcher) -> Dispatcher:
    """Return a kernel's function as another kernel, whose code is kept with its callers' only."""
    inline = INLINED if function.targetoptions.get('forceinline') else {}
    return njit(**OPTIONS, **inline)(function.py_func)


@cache
def interpreted(function: Dispatcher) -> Callable[..., Any]:
    """Return ``function`` as plain Python, with every kernel that it calls interpreted too."""
    python = function.py_func
    scope = dict(python.__globals__)
    for name in _global_names(python.__code__):
        if isinstance(scope.get(name), Dispatcher):
            scope[name] = interpreted(scope[name])
    return types.FunctionType(
        python.__code__, scope, python.__name__, python.__defaults__, python.__closure__
    )


def _global_names(code: types.CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _global_names(constant)
