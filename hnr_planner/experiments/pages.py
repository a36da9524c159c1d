"""
Update the tables in the pages of ``docs/`` from the tables that the experiments write.

A page, ``docs/NAME.md``, shows some rows of ``docs/figures/NAME.md``. A table is identified by its
header and a row by its first cell, so the numbers of a page can be updated after a new run. The
text around the tables is written by hand.
"""

from __future__ import annotations

from pathlib import Path
import re

from hnr_planner.core.errors import HnrError

#: Consecutive lines of a Markdown table.
TABLE = re.compile(r'(?:^\|.*\n)+', re.MULTILINE)


class PageError(HnrError, ValueError):
    """Error: a page shows a row that its experiment did not write."""


def refresh(docs: Path, name: str) -> None:
    """Update the page of an experiment in place; raise PageError that names a missing row."""
    page, numbers = docs / f'{name}.md', docs / 'figures' / f'{name}.md'
    try:
        text = refreshed(page.read_text(encoding='utf-8'), numbers.read_text(encoding='utf-8'))
    except PageError as error:
        raise PageError(f'{page} and {numbers}: {error}') from None
    page.write_text(text, encoding='utf-8')


def refreshed(page: str, numbers: str) -> str:
    """
    Return a page whose rows are replaced by the rows of ``numbers`` with the same first cell.

    Parameters
    ----------
    page, numbers : str
        Markdown. Tables of the page with a header that ``numbers`` does not have stay unchanged.

    Raises
    ------
    PageError
        When a table of the page has a row that the table of ``numbers`` does not have.

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
