"""
Sections of the report, each a function of the results.

To add one, write a function that takes a ``Bench`` and returns a ``Section``, and list it in
``SECTIONS`` of ``__main__``. Its verdicts go into the table at the top of the report.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from benchmarks.problems import Problem
from benchmarks.race import Standing
import numpy as np


@dataclass(frozen=True)
class Bench:
    """
    Input of the sections.

    Attributes
    ----------
    quick : bool
        Whether to measure little, for a first look.
    problems : list of Problem
        Maps and requests.
    standings : list of Standing
        Results of all competitors on each problem.
    missing : list of str
        Sentences about what cannot run on this machine, and why.

    """

    quick: bool
    problems: list[Problem]
    standings: list[Standing] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)


class Verdict(NamedTuple):
    """Target, measurement as text, and whether the target is reached."""

    what: str
    to_reach: str
    measured: str
    met: bool


class Section(NamedTuple):
    """Section of the report: heading, body in Markdown, and verdicts."""

    title: str
    body: str
    verdicts: list[Verdict] = []  # noqa: RUF012


SectionOf = Callable[[Bench], Section]


def table(head: str, rows: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown; the columns in ``head`` are separated by bars."""
    names = head.split(' | ')
    lines = [names, ['---'] + ['---:'] * (len(names) - 1), *rows]
    return '\n'.join('| ' + ' | '.join(line) + ' |' for line in lines)


def verdict_table(verdicts: list[Verdict]) -> str:
    """Return a table of targets, measurements and verdicts."""
    return table(
        'what | to reach | measured | reached',
        ([v.what, v.to_reach, v.measured, 'yes' if v.met else '**no**'] for v in verdicts),
    )


def milliseconds(seconds: float) -> str:
    """Return a time with three digits; a dash for none."""
    return f'{1e3 * seconds:.3g}' if np.isfinite(seconds) else '-'


def ratio(value: float) -> str:
    """Return a ratio as text; a dash for none."""
    return f'{value:.3f}' if np.isfinite(value) else '-'


def shortfalls(fails: dict[str, bool]) -> str:
    """Return the names of the targets that are missed (True), as text; 'no' for none."""
    return ', '.join(what for what, short in fails.items() if short) or 'no'


def on_all(what: str, to_reach: str, falls_short: dict[str, str], n_problems: int) -> Verdict:
    """Return the verdict on a target on all problems, with the ``falls_short`` of each by name."""
    held = f'on {n_problems - len(falls_short)} of {n_problems} problems'
    but = ', '.join(f'{name} {words}' for name, words in falls_short.items())
    return Verdict(what, to_reach, f'{held}; not on: {but}' if but else held, not falls_short)
