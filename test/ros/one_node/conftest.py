"""The node that all files of this folder share; each finds it as if it had just started."""

from collections.abc import Iterator
from contextlib import closing
from dataclasses import fields
from test.ros.harness import Client, node_process, NodeProcess
from test.ros.transitions import ACTIVATE, change, CLEANUP, CONFIGURE, DEACTIVATE

from hnr_planner.server.parameters.settings import Settings
import pytest

NAMES = [field.name for field in fields(Settings)]


@pytest.fixture(scope='package')
def shared_node(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run one planning node for all tests of this folder."""
    log = tmp_path_factory.mktemp('planner') / 'log'
    with node_process('planner_node', log) as process:
        yield process


@pytest.fixture(scope='module')
def planner(shared_node: NodeProcess) -> Iterator[NodeProcess]:
    """Return the node, and let it forget afterwards what a module brought it to."""
    shared_node.begin_log()
    with closing(Client()) as client:
        usual = client.get_parameters(*NAMES)
    yield shared_node
    with closing(Client()) as client:
        # This ends all searches, and the node forgets its map, zones, transforms and last path.
        assert change(client, DEACTIVATE, CLEANUP) == [True, True]
        values = zip(NAMES, usual, client.get_parameters(*NAMES), strict=True)
        changed = {name: before for name, before, now in values if now != before}
        assert all(answer.successful for answer in client.set_parameters(**changed))
        assert change(client, CONFIGURE, ACTIVATE) == [True, True]
