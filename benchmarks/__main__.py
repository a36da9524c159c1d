"""
Compare with OMPL, grid search and hopsy: ``python -m benchmarks [--quick] [--only SECTION ...]``.

HNR_MAPS names a folder of further maps. The full run writes ``benchmarks/results.md`` and
``docs/benchmark.png``; a quick one, and one of some sections only, write into
``build/benchmarks``. The figures of a quick run are rough.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
import time

from benchmarks.answers import answers
from benchmarks.clearance import clearance
from benchmarks.competitors import Competitor, lineup
from benchmarks.dimensions import dimensions
from benchmarks.every_problem import every_problem
from benchmarks.exact import exact
from benchmarks.first_path import first_path
from benchmarks.interpreted import interpreted
from benchmarks.kept_routes import kept_routes
from benchmarks.kinodynamic import kinodynamic
from benchmarks.picture import draw
from benchmarks.pinned import on_one_core
from benchmarks.poses import poses
from benchmarks.problems import missing_maps, Problem, problems
from benchmarks.progress import say
from benchmarks.properties import properties
from benchmarks.race import FULL, QUICK, race, Standing
from benchmarks.report import missing_words, report
from benchmarks.roadmap import roadmap
from benchmarks.rounded_sampling import rounded_sampling
from benchmarks.sampling import sampling
from benchmarks.sections import Bench, SectionOf, verdict_table
from benchmarks.short_path import short_path
from benchmarks.success import success
from hnr_planner.core import warm_up
from hnr_planner.core.kernels import modes

ROOT = Path(__file__).resolve().parents[1]

#: Sections of the report, in order.
SECTIONS: tuple[SectionOf, ...] = (
    first_path,
    short_path,
    success,
    exact,
    roadmap,
    dimensions,
    sampling,
    rounded_sampling,
    clearance,
    kinodynamic,
    kept_routes,
    poses,
    answers,
    properties,
    interpreted,
    every_problem,
)
#: Sections on the races of all competitors; those races are not run for the others alone.
OF_RACES = (first_path, short_path, success, exact, every_problem)


def main() -> None:
    """Measure, print, and write the report."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks', description=__doc__)
    parser.add_argument('--quick', action='store_true', help='some minutes, for a look')
    names = [section.__name__ for section in SECTIONS]
    parser.add_argument('--only', nargs='+', metavar='SECTION', choices=names, help=str(names))
    asked = parser.parse_args()
    quick, chosen = asked.quick, [s for s in SECTIONS if s.__name__ in (asked.only or names)]
    began = time.perf_counter()
    # Machine code is measured, also in the processes that sections start.
    modes.set_mode(os.environ.setdefault(modes.VARIABLE, modes.Mode.COMPILED.value))
    warm_up()
    courses = problems(quick)
    raced = courses if any(section in OF_RACES for section in chosen) else []
    with on_one_core():
        taking_part, missing = lineup()
        missing += missing_maps()
        if missing:
            say(missing_words(missing))
        standings = [_race(problem, taking_part, quick) for problem in raced]
    bench = Bench(quick, courses, standings, missing)
    sections = [section(bench) for section in chosen]

    results, picture = _places(is_whole=not (quick or asked.only))
    if standings:
        draw(standings, picture)
    seconds = time.perf_counter() - began
    beside = os.path.relpath(picture, results.parent)
    results.write_text(report(bench, sections, seconds, beside))
    say(f'\n{verdict_table([v for section in sections for v in section.verdicts])}')
    say(f'\n{seconds:.0f} s. All of it: {results} and {picture}')


def _race(problem: Problem, taking_part: list[Competitor], quick: bool) -> Standing:
    """Run one problem, and print which paths were invalid."""
    began = time.perf_counter()
    standing = race(problem, taking_part, QUICK if quick else FULL)
    say(f'{problem.name}: {time.perf_counter() - began:.0f} s')
    for entry in standing.entries:
        for complaint in entry.judge.complaints[:1]:
            say(f'{entry.competitor.label}: {complaint}')
    return standing


def _places(is_whole: bool) -> tuple[Path, Path]:
    """Return the files of the report and the picture: in the repository for a whole run."""
    folder = ROOT / 'build' / 'benchmarks'
    places = (ROOT / 'benchmarks', ROOT / 'docs') if is_whole else (folder, folder)
    for place in places:
        place.mkdir(parents=True, exist_ok=True)
    return places[0] / 'results.md', places[1] / 'benchmark.png'


if __name__ == '__main__':
    main()
