"""The command ``compile``: compile all machine code now, for installers and images."""

from __future__ import annotations

import argparse
from pathlib import Path
import sys
from tempfile import gettempdir
import time

from hnr_planner.cli.arguments import add_command, BadInputError

#: Least time between two lines of progress where stdout is no terminal [s].
INTERVAL = 10.0
EPILOG = """\
example:
  %(prog)s

Without it nothing waits either: requests run interpreted until a background process has compiled
what they need, and later starts load it. That process ends with the one that started it, so that
commands, which are short, stay slow for a while. With it the first requests are as fast as others.
The machine code lies in the user's cache folder (~/.cache/hnr_planner), or where NUMBA_CACHE_DIR
or XDG_CACHE_HOME point. It is valid for this machine's kind of processor and for this version:
compile on the robot, or in an image that runs on the same kind of processor.

Exit code 0: everything is compiled. 2: nothing can be kept, or compilation is switched off.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``compile`` to the command line."""
    add_command(
        commands,
        'compile',
        run,
        summary='compile all machine code now, for installers and images',
        description='Compile everything that plans and samples on maps need, and keep it.',
        epilog=EPILOG,
    )


def run(arguments: argparse.Namespace) -> int:
    """
    Compile every kernel that is not in the cache folder yet, and return the exit code.

    The progress is printed. BadInputError is raised where compilation is switched off, or where
    the cache folder cannot be written.
    """
    from hnr_planner.core.kernels.cache_folder import cache_folder
    from hnr_planner.core.kernels.modes import Mode, mode
    from hnr_planner.core.warming import compile_all

    if mode() is Mode.INTERPRETED:
        raise BadInputError(
            'compilation is switched off: unset NUMBA_DISABLE_JIT and HNR_PLANNER_KERNELS'
        )
    began = time.monotonic()
    folder = cache_folder()
    if _is_temporary(folder):
        raise BadInputError(
            'the cache folder cannot be written, so nothing would be kept: set NUMBA_CACHE_DIR to '
            'a folder that can'
        )
    print(f'compiling into {folder}', flush=True)
    progress = Progress()
    n_compiled = compile_all(progress=progress.show)
    progress.end()
    seconds = time.monotonic() - began
    print(f'{progress.n_total} kernels ready, {n_compiled} of them compiled now, {seconds:.0f} s')
    return 0


def note_if_interpreted() -> None:
    """Print a note on stderr where kernels that this process needed are not compiled yet."""
    compilation = sys.modules.get('hnr_planner.core.kernels.compilation')
    if compilation is not None and compilation.status().pending:
        print(
            'note: this ran interpreted, many times slower than machine code; '
            '`python3 -m hnr_planner compile` compiles all of it once, in some minutes',
            file=sys.stderr,
        )


def _is_temporary(folder: Path) -> bool:
    """Return whether a cache folder lies in the temporary folder that this process has made."""
    home = folder.parents[1]
    return home.parent == Path(gettempdir()) and home.name.startswith('hnr_planner_')


class Progress:
    """
    Display of the progress of compilation on stdout.

    On a terminal it is one line that is overwritten; elsewhere it is a new line when a kernel is
    done at least ``INTERVAL`` seconds after the line before.
    """

    def __init__(self) -> None:
        self.n_total = 0
        self._is_terminal = sys.stdout.isatty()
        self._shown = time.monotonic()

    def show(self, n_done: int, n_total: int, name: str) -> None:
        """
        Show that ``n_done`` of ``n_total`` kernels are done, ``name`` being the last of them.

        The name is shown on a terminal only.
        """
        self.n_total = n_total
        if self._is_terminal:
            print(f'\r\033[K{n_done} of {n_total}  {name}', end='', flush=True)
        elif time.monotonic() - self._shown >= INTERVAL:
            self._shown = time.monotonic()
            print(f'{n_done} of {n_total}', flush=True)

    def end(self) -> None:
        """Remove the line of progress from a terminal; do nothing elsewhere."""
        if self._is_terminal:
            print('\r\033[K', end='', flush=True)
