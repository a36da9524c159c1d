"""
Ours, OMPL and grid search side by side: ``python -m benchmarks [--quick]``.

HNR_MAPS names a folder of further maps. The full run writes ``benchmarks/results.md`` and
``docs/benchmark.png``; a quick one writes into ``build/benchmarks`` and is good for a look only.
"""

from __future__ import annotations

import argparse
from itertools import chain
import os
from pathlib import Path
import sys
import time

from benchmarks import ompl
from benchmarks.answers import answers
from benchmarks.competitors import competitors
from benchmarks.picture import draw
from benchmarks.problems import problems
from benchmarks.properties import properties, Property
from benchmarks.race import FULL, QUICK, race, Standing
from benchmarks.report import duel_table, length_table, property_table, report
from hnr_planner.core import warm_up

ROOT = Path(__file__).resolve().parents[1]


def main() -> None:
    """Measure, print, and write the report."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks', description=__doc__)
    parser.add_argument('--quick', action='store_true', help='two minutes, for a look')
    quick = parser.parse_args().quick
    began = time.perf_counter()
    missing = _missing()
    warm_up()

    standings = _race(quick, with_ompl=not missing)
    measured = _measure(quick)

    places = ROOT / 'build' / 'benchmarks', ROOT / 'build' / 'benchmarks'
    places = places if quick else (ROOT / 'benchmarks', ROOT / 'docs')
    for place in places:
        place.mkdir(parents=True, exist_ok=True)
    results, picture = places[0] / 'results.md', places[1] / 'benchmark.png'
    seconds = time.perf_counter() - began
    results.write_text(report(standings, measured, seconds, missing))
    draw(standings, picture)
    if not missing:
        print(f'\nFirst path, ms:\n{duel_table(standings)}')
    print(f'\nLength in the time of a wavefront, ms:\n{length_table(standings)}')
    print(f'\nOurs alone:\n{property_table(measured)}')
    print(f'\n{seconds:.0f} s. All of it: {results} and {picture}')


def _missing() -> str:
    """Say what OMPL's planners would need to take part; empty when they can."""
    try:
        ompl.build()
    except ompl.MissingOmpl as reason:
        print(f'Going on without OMPL. {reason}', file=sys.stderr)
        return str(reason)
    return ''


def _race(quick: bool, with_ompl: bool) -> list[Standing]:
    """Run all problems, everybody on one core."""
    taking_part, standings = competitors(with_ompl), []
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    for problem in problems(quick):
        standings.append(race(problem, taking_part, QUICK if quick else FULL))
        for entry in standings[-1].entries:
            for complaint in entry.complaints[:1]:
                print(f'\n{entry.competitor.name}: {complaint}', end='')
        print()
    os.sched_setaffinity(0, cores)
    return standings


def _measure(quick: bool) -> list[Property]:
    measured = []
    for row in chain(properties(quick), answers(20 if quick else 200)):
        print(f'{row.what}: {row.measured}')
        measured.append(row)
    return measured


if __name__ == '__main__':
    main()
