"""
Configuration of the site for Sphinx: ``make docs`` builds it into ``docs/_build/html``.

All sources of the site lie in ``docs/`` or are linked from there (``ros``, ``examples``,
``config``, ``benchmark.md``, ``changelog.rst``, ``contributing.md``). It is built from a copy of
this folder in which the links are files, as ROS's rosdoc2 makes one too; that one works in its
copy, and finds the package there by the link ``hnr_planner``. Nothing is compiled and nothing is
downloaded: kernels run interpreted, and other projects are linked by the inventories in
``inventories/``.
"""

from importlib import import_module
from importlib.util import find_spec
import os
from pathlib import Path
import re
import sys

os.environ['HNR_PLANNER_KERNELS'] = 'interpreted'  # before the first import of the package
sys.path.insert(0, str(Path.cwd()))  # a clone, or rosdoc2's copy of this folder

project = 'hnr_planner'
author = 'The hnr_planner developers'
release = version = import_module('hnr_planner').__version__
html_title = f'hnr_planner {version}'

extensions = [
    'myst_parser',
    'sphinx.ext.autodoc',
    'sphinx.ext.autosummary',
    'sphinx.ext.intersphinx',
    'sphinx.ext.mathjax',
    'sphinx.ext.napoleon',
    'sphinx.ext.viewcode',
]
# Builders of others may lack it: then there is no gallery, and all else is built.
if find_spec('sphinx_gallery'):
    extensions.append('sphinx_gallery.gen_gallery')

templates_path = ['_templates']
source_suffix = {'.md': 'markdown', '.rst': 'restructuredtext'}
exclude_patterns = [
    '_build',
    'examples',
    'hnr_planner',
    # What rosdoc2 adds, of which the site has its own.
    '__readme_include.rst',
    'hnr_planner.*',
    'index.rst',
    'modules.rst',
    'standard_docs',
    'standards.rst',
]
# The shapes in docstrings, such as (n, state_dim), look like references.
suppress_warnings = ['ref.python']

html_theme = 'furo'
html_static_path = ['_static']
html_css_files = ['site.css']
html_show_copyright = False

myst_enable_extensions = ['colon_fence', 'deflist']
myst_heading_anchors = 4

autosummary_generate = True
autodoc_typehints = 'none'
autodoc_member_order = 'bysource'
autodoc_default_options = {'members': True, 'inherited-members': False}
autodoc_preserve_defaults = True
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

intersphinx_mapping = {
    name: (url, (f'inventories/{name}.inv',))
    for name, url in {
        'numpy': 'https://numpy.org/doc/stable/',
        'python': 'https://docs.python.org/3/',
        'shapely': 'https://shapely.readthedocs.io/en/stable/',
    }.items()
}

sphinx_gallery_conf = {
    'examples_dirs': 'examples',
    'gallery_dirs': 'gallery',
    'filename_pattern': r'/(?!ask_the_node)\w+\.py',
    'ignore_pattern': '__init__',
    'within_subsection_order': 'FileNameSortKey',
    'download_all_examples': False,
    'min_reported_time': 60,
    'remove_config_comments': True,
    'show_signature': False,
    'show_memory': False,
    'backreferences_dir': None,
    'default_thumb_file': None,
}

#: Where a link that is right in the repository leads on the site: (folder of the page, the
#: beginning of the link, what replaces it). Pages of msg_docs/ are in ros/ on the site.
MOVED = (
    ('', '../msg_docs/README.md', 'ros/README.md'),
    ('', '../msg_docs/', 'ros/'),
    ('', '../benchmarks/results.md', 'benchmark.md'),
    ('', '../docs/', ''),
    ('', 'docs/', ''),
    ('', '../README.md', 'index.md'),
    ('', '../CONTRIBUTING.md', 'contributing.md'),
    ('', '../config/', 'config/'),
    ('', '../CITATION.cff', 'CITATION.cff'),
    ('ros/', '../docs/', '../'),
    ('ros/', '../README.md', '../index.md'),
    ('ros/', '../benchmarks/results.md', '../benchmark.md'),
)


def relink(app: object, docname: str, source: list[str]) -> None:
    """
    Make the links of a page, which are right in the repository, right on the site.

    The index of msg_docs/ also gets all its pages as children.
    """
    folder = docname.rpartition('/')[0]
    folder = f'{folder}/' if folder else ''
    for page_folder, old, new in MOVED:
        if page_folder == folder:
            source[0] = re.sub(rf'\]\({re.escape(old)}', f']({new}', source[0])
    if docname == 'ros/README':
        source[0] += '\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n'


def setup(app: object) -> None:
    """Connect to Sphinx."""
    app.connect('source-read', relink)  # type: ignore[attr-defined]
