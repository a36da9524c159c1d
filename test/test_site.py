"""The site: its reference has every public name, and versions agree wherever they are printed."""

import importlib
from pathlib import Path
import re

import hnr_planner
import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = ROOT / 'docs' / 'reference'


def documented(page: Path) -> dict[str, list[str]]:
    """Return the names that a page of the reference lists, by their module."""
    names: dict[str, list[str]] = {}
    module = ''
    in_list = False
    for line in page.read_text().splitlines():
        if match := re.match(r'\.\. (?:py:)?currentmodule:: (\S+)', line):
            module = match[1]
        elif line.startswith(('.. autosummary::', '.. py:data::')):
            in_list = True
            names.setdefault(module, []).extend(re.findall(r'data:: (\w+)', line))
        elif in_list and (match := re.fullmatch(r' {3,}(\w+)', line)):
            names[module].append(match[1])
        elif line and not line.startswith(' '):
            in_list = False
    return names


@pytest.mark.parametrize(
    'module', ['hnr_planner', 'hnr_planner.maps', 'hnr_planner.drawing', 'hnr_planner.core.theory']
)
def test_the_reference_has_every_public_name_once(module: str) -> None:
    listed = [
        name
        for page in sorted(REFERENCE.glob('*.rst'))
        for name in documented(page).get(module, [])
    ]
    assert sorted(listed) == sorted(importlib.import_module(module).__all__)


def test_the_reference_leads_to_all_its_pages() -> None:
    index = (REFERENCE / 'index.rst').read_text()
    pages = {page.stem for page in REFERENCE.glob('*.rst')} - {'index'}
    assert pages == {line.strip() for line in index.splitlines() if line.strip() in pages}


def test_links_out_of_the_folder_lead_to_what_they_are_named_for() -> None:
    for name, target in {
        'ros': 'msg_docs',
        'examples': 'examples',
        'config': 'config',
        'benchmark.md': 'benchmarks/results.md',
        'changelog.rst': 'CHANGELOG.rst',
        'contributing.md': 'CONTRIBUTING.md',
        'CITATION.cff': 'CITATION.cff',
        'hnr_planner': 'hnr_planner',
    }.items():
        assert (ROOT / 'docs' / name).resolve() == ROOT / target


def test_the_version_is_the_same_everywhere() -> None:
    version = hnr_planner.__version__
    for file, said in {
        'setup.py': f"version='{version}'",
        'package.xml': f'<version>{version}</version>',
        'CITATION.cff': f'\nversion: {version}\n',
        'docs/citing.md': f'version = {{{version}}}',
        'CHANGELOG.rst': f'\n{version} (',
    }.items():
        assert said in (ROOT / file).read_text(), file


def test_the_citation_names_the_paper_and_this_software() -> None:
    citation = yaml.safe_load((ROOT / 'CITATION.cff').read_text())
    assert {'cff-version', 'message', 'title', 'authors', 'license'} <= set(citation)
    (paper,) = citation['references']
    page = (ROOT / 'docs' / 'citing.md').read_text()
    assert paper['title'] in page and paper['url'] in page
    assert all(author['family-names'] in page for author in paper['authors'])
