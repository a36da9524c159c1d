"""The pages show what was measured: their tables hold rows that the experiments wrote."""

from pathlib import Path
import re
import shutil

from hnr_planner.experiments import NAMES
from hnr_planner.experiments.__main__ import main
from hnr_planner.experiments.pages import PageError, refresh, refreshed
import pytest

DOCS = Path(__file__).resolve().parents[2] / 'docs'

#: Pages with tables that no experiment writes.
OWN_TABLES = ('theory',)
NUMBERS = """\
| width | mean | all of it |
| --- | ---: | ---: |
| 0.8 | 7 ± 1 | - |
| 1.2 | 5 ± 1 | 2 |

| rooms | mean |
| --- | ---: |
| 0.8 | 3 |
"""
PAGE = """\
# A page

| width | mean | all of it |
| --- | ---: | ---: |
| 1.2 | 1,234 | 9 |

It says | something.

| rooms | mean |
| --- | ---: |
| 0.8 | 99 |

| its own | mean |
| --- | --- |
| 0.8 | kept |
"""


def tables(file: Path) -> dict[str, list[str]]:
    """Return the rows of every table of a file by its header."""
    blocks = re.findall(r'(?:^\|.*\n)+', file.read_text(encoding='utf-8'), re.MULTILINE)
    found = [block.splitlines() for block in blocks]
    assert len({header for header, *_ in found}) == len(found)
    return {header: rows for header, _, *rows in found}


@pytest.mark.parametrize('name', NAMES)
def test_pages_show_rows_as_they_were_written(name: str) -> None:
    written, page = tables(DOCS / 'figures' / f'{name}.md'), tables(DOCS / f'{name}.md')
    shown = {header: rows for header, rows in page.items() if header in written}
    assert shown
    assert shown == page or name in OWN_TABLES
    for header, rows in shown.items():
        assert [row for row in rows if row not in written[header]] == []


def test_rows_follow_the_numbers_and_all_else_stays() -> None:
    expected = PAGE.replace('| 1.2 | 1,234 | 9 |', '| 1.2 | 5 ± 1 | 2 |')
    expected = expected.replace('| 0.8 | 99 |', '| 0.8 | 3 |')
    assert refreshed(PAGE, NUMBERS) == expected
    assert refreshed(expected, NUMBERS) == expected


def test_command_refreshes_every_page(tmp_path: Path) -> None:
    docs = tmp_path / 'docs'
    shutil.copytree(DOCS, docs)
    pages = [docs / f'{name}.md' for name in NAMES]
    for page in pages:
        page.write_text(page.read_text(encoding='utf-8').replace(' ± ', ' ± 9'), encoding='utf-8')
        assert page.read_bytes() != (DOCS / page.name).read_bytes()
    main(docs)
    for page in pages:
        assert page.read_bytes() == (DOCS / page.name).read_bytes()


def test_a_row_that_was_not_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / 'figures').mkdir()
    (tmp_path / 'figures' / 'one.md').write_text(NUMBERS, encoding='utf-8')
    page = tmp_path / 'one.md'
    page.write_text(PAGE.replace('| 1.2 |', '| 1.3 |'), encoding='utf-8')
    before = page.read_bytes()
    with pytest.raises(PageError, match=r"one\.md.*: no row '1\.3' below \| width \|"):
        refresh(tmp_path, 'one')
    assert page.read_bytes() == before
