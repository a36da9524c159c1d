"""Planning and sampling do not import the libraries of the theory."""

from pathlib import Path

import hnr_planner.core

CORE = Path(hnr_planner.core.__file__).parent


def test_the_rest_of_the_core_does_not_import_it():
    others = [path for path in CORE.rglob('*.py') if path.parent.name != 'theory']
    assert len(others) > 40
    assert not [path for path in others if 'core.theory' in path.read_text()]
