"""Write the report: the machine, the competitors, the targets, and the sections."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from importlib import metadata
import os
from pathlib import Path
import platform

from benchmarks import ompl
from benchmarks.sections import Bench, Section, verdict_table

EXPLAINED = """\
Times are medians and 95th percentiles in milliseconds: for ours the whole call of `plan()` from
Python on a ready space, for OMPL `setup()` and `solve()` where they run, for grid search the
compiled function. A run without a valid path within 1 s counts as endless; a dash stands where
that is the quantile. Lengths are ratios over the shortest path known for the request, from all
runs and from long searches besides. *Within 1 %* is the time to a path that is at most that much
longer than the shortest: one that can use a given time is asked anew with more and more of it, the
others begin again with another seed and keep the shortest, and all their runs count. Clearance is
the smallest to the occupied cells [m], where a robot has been inflated too. Every path of
everybody is judged by the same exact check of its segments, some by a second, independent one;
`invalid` counts those that failed it. All share one core and take turns.

OMPL in C++ gets a lookup in the same grid for states and an exact cell traversal for motions, and
its own defaults, which it derives from the map. OMPL PyPI is its wheel: there a motion validator
can only be written in Python, here one that hands four numbers to compiled code. With the same
seeds both search alike, so that RRTConnect there against RRTConnect in C++ is what Python costs.
A* and Theta* step between cell centres; whether these see each other is tested exactly. nano-astar
gets the `uint8` grid that it wants. On the spirals, made to be hard, there is one request, from
end to end; on the maps there are 20, at least 40 % of the diagonal apart.

In the picture a line shows the path getting shorter: after one run (the dot), two and more; or
with more and more time, for those that can use it. Names stand at the ends.
"""


def report(bench: Bench, sections: list[Section], seconds: float, picture: str) -> str:
    """Return the report; ``picture`` is the path of the picture relative to it."""
    verdicts = [verdict for section in sections for verdict in section.verdicts]
    parts = ['# Benchmark', _machine(seconds), missing_words(bench.missing)]
    parts += ['## What is asked', verdict_table(verdicts)]
    parts += [
        f'![Time against length]({picture})',
        '## What the numbers mean',
        EXPLAINED,
    ]
    for section in sections:
        parts += [f'## {section.title}', section.body]
    return '\n\n'.join(part.strip() for part in parts if part) + '\n'


def missing_words(missing: list[str]) -> str:
    """Return a paragraph on the competitors that did not run, and why."""
    return '\n'.join(f'**Missing.** {reason}' for reason in missing)


def _machine(seconds: float) -> str:
    versions = [f'Python {platform.python_version()}']
    versions += [
        f'{name} {found}'
        for name, ask in (
            ('NumPy', lambda: metadata.version('numpy')),
            ('numba', lambda: metadata.version('numba')),
            ('OpenCV', lambda: metadata.version('opencv-python-headless')),
            ('OMPL', ompl.native_version),
            ('OMPL PyPI', ompl.wheel_version),
            ('nano-astar', lambda: metadata.version('nano-astar')),
            ('hopsy', lambda: metadata.version('hopsy')),
        )
        if (found := _version(ask))
    ]
    return (
        f'`make bench`, {date.today()}: {_processor()}, {os.cpu_count()} cores, '
        f'{platform.system()}; {", ".join(versions)}; {seconds / 60:.1f} minutes.'
    )


def _version(ask: Callable[[], str]) -> str | None:
    try:
        return ask()
    except (metadata.PackageNotFoundError, ompl.MissingOmpl, OSError):
        return None


def _processor() -> str:
    info = Path('/proc/cpuinfo')
    for line in info.read_text().splitlines() if info.exists() else ():
        if line.startswith('model name'):
            return line.partition(':')[2].strip()
    return platform.machine()
