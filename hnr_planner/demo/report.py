"""Show the answers of the planning node in a table and a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hnr_planner.demo.answer import ALGORITHMS, Answer
from hnr_planner.demo.check import Check
from hnr_planner.demo.scene import Scene

#: Headings of the table.
HEADINGS = ('algorithm', 'status', 'transitions', 'time', 'length', 'min. clearance', 'path check')


def table(answers: dict[str, Answer], checks: dict[str, Check]) -> str:
    """Return a table of the answers and their checks, one line for each algorithm."""
    rows = [HEADINGS]
    for algorithm, answer in answers.items():
        check = checks[algorithm]
        rows.append(
            (
                algorithm,
                answer.outcome,
                f'{transitions(answer):,}',
                f'{planning_time(answer) * 1e3:.1f} ms',
                f'{check.length:.2f} m',
                f'{check.clearance:.2f} m',
                f'{len(check.problems)} problems'
                if check.problems
                else f'free, {check.segments:,} segments',
            )
        )
    return aligned(rows)


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """
    Return rows of text as aligned columns, with a line of dashes below the first row.

    Each row has the columns of ``HEADINGS``: the first two and the last are aligned to the left,
    the others to the right.
    """
    widths = [max(len(row[col]) for row in rows) for col in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            word.rjust(width) if 2 <= col <= 5 else word.ljust(width)
            for col, (word, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append('  '.join(cells).rstrip())
    lines.insert(1, '  '.join('-' * width for width in widths))
    return '\n'.join(lines)


def draw(scene: Scene, answers: dict[str, Answer], file: Path) -> None:
    """Draw map, samples and path of each answer, side by side, into a file."""
    from hnr_planner import drawing  # needed at the end only

    plans = [
        drawing.Plan(
            _title(algorithm, answer),
            answer.path,
            answer.samples,
            answer.parents,
            scene.start,
            scene.goal,
        )
        for algorithm, answer in answers.items()
    ]
    figure = drawing.figure_of_plans(scene.occupancy, plans, blocked=scene.space.blocked)
    drawing.save(figure, file)


def transitions(answer: Answer) -> int:
    """Return the number of transitions that the node reports; 0 where it reports none."""
    return int(answer.values.get('iterations', '0'))


def planning_time(answer: Answer) -> float:
    """Return the planning time that the node reports [s]; NaN where it reports none."""
    return float(answer.values.get('planning_time', 'nan'))


def _title(algorithm: str, answer: Answer) -> str:
    """Return the heading of the picture's panel for one algorithm."""
    if answer.outcome != 'SOLVED':
        return f'{ALGORITHMS[algorithm]}: {answer.outcome}'
    return (
        f'{ALGORITHMS[algorithm]}: {transitions(answer):,} transitions, '
        f'{planning_time(answer) * 1e3:.1f} ms, path of {float(answer.values["length"]):.1f} m'
    )
