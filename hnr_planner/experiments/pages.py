"""
The tables in the pages of ``docs/``: rows of those that an experiment writes.

A page shows some rows of ``docs/figures/NAME.md``. A table is known by its header and a row by its
first cell, so that the numbers of a page follow those of a new run by themselves; the sentences
around them do not.
"""

from __future__ import annotations

from pathlib import Path
import re

from hnr_planner.core.errors import HnrError

TABLE = re.compile(r'(?:^\|.*\n)+', re.MULTILINE)


class PageError(HnrError, ValueError):
    """A page shows a row that its experiment did not write."""


def refresh(docs: Path, name: str) -> None:
    """Bring the page of an experiment up to date; PageError says which row is not there."""
    page, numbers = docs / f'{name}.md', docs / 'figures' / f'{name}.md'
    try:
        text = refreshed(page.read_text(encoding='utf-8'), numbers.read_text(encoding='utf-8'))
    except PageError as error:
        raise PageError(f'{page} and {numbers}: {error}') from None
    page.write_text(text, encoding='utf-8')


def refreshed(page: str, numbers: str) -> str:
    """
    Return a page with the rows as the numbers have them now.

    Parameters
    ----------
    page, numbers : str
        Markdown. A table of the page whose header no table of the numbers has stays as it is.

    Raises
    ------
    PageError
        A table of the page has the header of one of the numbers, but a row that is not there.

    """
    tables = {}
    for table in TABLE.findall(numbers):
        header, _, *rows = table.splitlines()
        tables[header] = {_first_cell(row): row for row in rows}

    def current(table: re.Match[str]) -> str:
        header, rule, *rows = table[0].splitlines()
        if header not in tables:
            return table[0]
        missing = {_first_cell(row) for row in rows} - tables[header].keys()
        if missing:
            raise PageError(f'no row {min(missing)!r} below {header}')
        return '\n'.join([header, rule, *(tables[header][_first_cell(row)] for row in rows), ''])

    return TABLE.sub(current, page)


def _first_cell(row: str) -> str:
    return row.split('|')[1].strip()
