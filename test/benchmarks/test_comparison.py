"""The page docs/comparison.md quotes the benchmark's report: every figure, in its place."""

from pathlib import Path
import re

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / 'docs' / 'comparison.md').read_text()
REPORT = (ROOT / 'benchmarks' / 'results.md').read_text()


def rows(text: str, section: str) -> list[list[str]]:
    """Return the cells of all table rows of a section, a header before those of its table."""
    lines = [line for line in part(text, section).splitlines() if re.match(r'\| (?!---)', line)]
    return list(map(cells, lines))


def part(text: str, section: str) -> str:
    """Return the text of a section."""
    return text.partition(f'\n## {section}\n')[2].partition('\n## ')[0]


def cells(line: str) -> list[str]:
    """Return the cells of a row of a table."""
    return [cell.strip() for cell in line.strip('|').split('|')]


FIRST, LENGTH, MOTIONS, ASKED = (
    {name: figures for name, *figures in rows(REPORT, section)}
    for section in (
        'Time to the first path',
        'Length in the time of a wavefront',
        'Robots with inertia',
        'What is asked',
    )
)


def table(section: str, head: str) -> dict[str, list[str]]:
    """Return the figures by name of the table of a section whose first heading is ``head``."""
    after = part(REPORT, section).partition(f'\n| {head} |')[2]
    lines = after.partition('\n\n')[0].splitlines()[2:]
    return {name: figures for name, *figures in map(cells, lines)}


FAR = table('The shortest path, proved', 'far requests')
DIMENSIONS = table('In n dimensions', 'first path [ms]')
POSES = {
    name: figures
    for name, drive, *figures in rows(REPORT, 'Robots that are not round')
    if drive == 'car'
}


def of_map(name: str) -> list[str]:
    """Return times of the first paths, to within 1 % and of the wavefront, and its length."""
    return [FIRST[name][k] for k in (0, 2, 6)] + LENGTH[name][4:7]


def of_course(name: str) -> list[str]:
    """Return times of the first motions, and how long ours and SST's take after a second."""
    return MOTIONS[name][:3] + [duration.removesuffix(' s') for duration in MOTIONS[name][10:]]


def of_walk(name: str) -> list[str]:
    """Return the steps a second [M] of ours and hopsy's."""
    return re.findall(r'[\d.]+(?= M)', ASKED[f'steps a second, {name}'][1])


def of_problem(name: str) -> list[str]:
    """Return median times of first paths: ours, of RRTConnect, BiEST and BKPIECE1."""
    return [DIMENSIONS[name][k].partition(' / ')[0] for k in (0, 2, 3, 4)]


def of_car(name: str) -> list[str]:
    """Return times to our first and shortened path, its length, and times of OMPL's planners."""
    return [POSES[name][k] for k in (1, 3, 4, 6, 8)]


RECORDED = {
    'map': of_map,
    'far requests': lambda name: FAR[name][:4],
    'problem': of_problem,
    'car': of_car,
    'course': of_course,
    'walk, set': of_walk,
}


def quoted() -> list[tuple[str, list[str], list[str]]]:
    """Return name, figures and what the report has for every row of the page."""
    found = []
    for name, *figures in rows(PAGE, 'Measured'):
        if name in RECORDED:
            recorded = RECORDED[name]
        else:
            found.append((name, figures, recorded(name)))
    return found


def test_every_table_is_read() -> None:
    assert len(quoted()) == 40


@pytest.mark.parametrize(('name', 'figures', 'recorded'), quoted())
def test_figures_are_those_of_the_report(
    name: str, figures: list[str], recorded: list[str]
) -> None:
    assert figures == recorded, name


def test_figures_in_the_text_are_those_of_the_report() -> None:
    text = PAGE.partition('## Measured')[2]
    quoted = re.findall(r'\d\.?\d*e\+\d\d|[\d.]+(?= ms (?:besides|to))', text)
    assert len(quoted) == 6
    assert [figure for figure in quoted if figure not in REPORT] == []
