"""Options of a request to check a path are fulfilled or refused, never ignored."""

from types import SimpleNamespace

from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.validity.check_options import CheckOptions
import pytest


def test_request_without_further_fields_has_the_defaults() -> None:
    options = CheckOptions.of(SimpleNamespace(path=None))
    assert options == CheckOptions()
    options.check(Settings(unknown='free'))


@pytest.mark.parametrize(
    ('field', 'value'),
    [
        ('layer_name', 'voxels'),
        ('footprint', '[[0.1, 0.1], [0.1, -0.1], [-0.1, 0.0]]'),
        ('max_cost', 100),
        ('consider_unknown_as_obstacle', True),
    ],
)
def test_what_the_node_does_not_have_is_refused(field: str, value: object) -> None:
    options = CheckOptions.of(SimpleNamespace(**{field: value}))
    with pytest.raises(Refusal, match=f'{field} must be') as refusal:
        options.check(Settings(unknown='free'))
    assert refusal.value.outcome is Outcome.BAD_REQUEST
    assert str(value).lower() in str(refusal.value).lower()


def test_unknown_cells_block_by_the_parameters_anyway() -> None:
    CheckOptions(unknown_blocks=True).check(Settings())
