"""Libraries that only some commands need, and that a robot does without."""

from __future__ import annotations

from importlib.util import find_spec

from hnr_planner.cli.arguments import BadInputError

#: The extras of ``setup.py`` that commands need, and the libraries in each.
EXTRAS = {'plot': ('matplotlib',), 'experiments': ('joblib', 'matplotlib', 'tqdm')}


def require_extra(extra: str, what: str) -> None:
    """
    Refuse a command whose libraries are missing, and name what installs them.

    Parameters
    ----------
    extra : str
        One of ``EXTRAS``.
    what : str
        What needs it, such as an option, for the message.

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
