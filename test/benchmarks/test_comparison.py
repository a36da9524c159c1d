"""The page docs/comparison.md quotes the benchmark's report: every figure of its tables."""

from pathlib import Path
import re

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / 'docs' / 'comparison.md').read_text()
REPORT = (ROOT / 'benchmarks' / 'results.md').read_text()


def rows(text: str) -> list[list[str]]:
    """Return the cells of all table rows."""
    lines = [line for line in text.splitlines() if line.startswith('| ')]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


MEASURED = [row for row in rows(PAGE.partition('## Measured')[2]) if re.search(r'\d', row[-1])]


def test_the_tables_are_read() -> None:
    assert len(MEASURED) > 15


@pytest.mark.parametrize('row', MEASURED, ids=lambda row: row[0])
def test_figures_are_those_of_the_report(row: list[str]) -> None:
    name, *figures = row
    quoted = [cells for cells in rows(REPORT) if re.search(rf'(^|, ){re.escape(name)}$', cells[0])]
    recorded = set(re.findall(r'[\d.]+', ' '.join(' '.join(cells[1:]) for cells in quoted)))
    assert [figure for figure in figures if figure not in recorded] == []


def test_figures_in_the_text_are_those_of_the_report() -> None:
    text = PAGE.partition('## Measured')[2]
    quoted = re.findall(r'\d\.?\d*e\+\d\d|[\d.]+(?= ms (?:besides|to))', text)
    assert len(quoted) == 6
    assert [figure for figure in quoted if figure not in REPORT] == []
