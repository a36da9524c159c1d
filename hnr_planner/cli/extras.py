"""Check for libraries that only some commands need, and that need not be on a robot."""

from __future__ import annotations

from importlib.util import find_spec

from hnr_planner.cli.arguments import BadInputError

#: The extras of ``setup.py`` that commands need, and the libraries in each.
EXTRAS = {
    'plot': ('matplotlib',),
    'experiments': ('joblib', 'matplotlib', 'tqdm'),
    'cluster': ('dask', 'distributed'),
    'watch': ('matplotlib', 'tornado'),
}


def require_extra(extra: str, what: str) -> None:
    """
    Refuse a command where a library of an extra is missing, and name what installs it.

    Parameters
    ----------
    extra : str
        One of ``EXTRAS``.
    what : str
        What needs the extra, such as an option, for the message.

    Raises
    ------
    BadInputError
        When a library of the extra cannot be imported.

    """
    missing = [library for library in EXTRAS[extra] if find_spec(library) is None]
    if missing:
        packages = ' '.join(f'python3-{library}' for library in missing)
        raise BadInputError(
            f"{what} needs {', '.join(missing)}: pip install 'hnr_planner[{extra}]', "
            f'or apt install {packages}'
        )
