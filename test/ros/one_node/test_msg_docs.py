"""The pages in msg_docs/ and the nodes say the same: names, types, examples that work."""

from array import array
from collections.abc import Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
import re
import shlex
from test.ros.harness import Client, LATCHED, MANY, node_process, NodeProcess, pose, until
from typing import Any

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from hnr_planner.core.trajectories.registry import KINODYNAMIC_ENTRIES
from hnr_planner.ros.messages.outcomes import read_outcome
from hnr_planner.ros.node.planner import SERVICES
from hnr_planner.server.requests.outcomes import Outcome
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, GetPlan
import pytest
from rclpy.action import get_action_server_names_and_types_by_node
from std_srvs.srv import Trigger
import yaml

ROOT = Path(__file__).parents[3]
PAGES = {path.stem: path.read_text() for path in sorted((ROOT / 'msg_docs').glob('*.md'))}
INDEX = PAGES.pop('README')
OFFICE = ROOT / 'config' / 'maps' / 'office.yaml'

#: Topics of every node, on the page of the parameters.
BY_ITSELF = {'/parameter_events', '/rosout'}


@pytest.fixture(scope='module')
def source(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NodeProcess]:
    """Run the map source with the sample map."""
    log = tmp_path_factory.mktemp('source') / 'log'
    with node_process('map_node', log, yaml_filename=OFFICE) as process:
        yield process


@pytest.fixture(scope='module')
def client(planner: NodeProcess, source: NodeProcess) -> Iterator[Client]:
    """Return a client of both nodes."""
    client = Client()
    planner.wait_for('map received')
    yield client
    client.close()


def rows(page: str) -> list[list[str]]:
    """Return the cells of all table rows of a page."""
    lines = [line.strip() for line in page.splitlines() if line.startswith('|')]
    return [[cell.strip().strip('`') for cell in line.strip('|').split('|')] for line in lines]


def documented(node: str) -> set[tuple[str, str, str]]:
    """Return (kind, full name, type) of all that the pages say about a node."""
    found = set()
    for page in PAGES.values():
        entry: dict[str, str] = {}
        for cells in rows(page):
            if cells[0] in ('kind', 'name', 'type'):
                entry[cells[0]] = cells[1]
            if cells[0] == 'type' and _is_there(entry['kind'], node):
                found.add((_kind(entry['kind']), _full(entry['name'], node), entry['type']))
            if len(cells) == 3 and cells[0].startswith(('service', 'topic, published')):
                # A row that names no node is true of each.
                if cells[0].partition('`')[2] in ('', node):
                    found.add((_kind(cells[0]), _full(cells[1], node), cells[2]))
    return found


def _is_there(kind: str, node: str) -> bool:
    """Return whether a page speaks of this node, and of what it has here."""
    words, _, needed = kind.partition(' with ')
    return words.strip('`').endswith(node) and (not needed or bool(find_spec(needed)))


def _kind(words: str) -> str:
    for kind in ('service', 'action'):
        if words.startswith(kind):
            return kind
    return 'subscription' if 'subscribed' in words else 'publisher'


def _full(name: str, node: str) -> str:
    return '/' + name.replace('~', node).lstrip('/')


def test_the_page_of_motions_names_every_planner_as_it_is_listed() -> None:
    listed = [[entry.name, entry.summary] for entry in KINODYNAMIC_ENTRIES]
    assert [cells for cells in rows(PAGES['trajectory']) if cells in listed] == listed


def test_every_planner_of_motions_has_a_page_and_a_service() -> None:
    names = {f'plan_{entry.name}' for entry in KINODYNAMIC_ENTRIES}
    assert names == {name for name in PAGES if name.startswith('plan_kinodynamic_')}
    assert names < set(SERVICES)
    assert set(SERVICES) == {name for name in PAGES if re.fullmatch('plan(_.*)?', name)}


def test_pages_of_the_other_services_lead_to_what_all_share() -> None:
    fields = {*GetPlan.Request.get_fields_and_field_types()}
    assert fields < {cells[0] for cells in rows(PAGES['plan'])}
    for name in (name for name in PAGES if name.startswith('plan_')):
        assert '(plan.md)' in PAGES[name], name
        assert not fields & {cells[0] for cells in rows(PAGES[name])}, name


def in_graph(client: Client, node: str) -> set[tuple[str, str, str]]:
    """Return (kind, full name, type) of all that a node has."""
    ask = {
        'publisher': client.node.get_publisher_names_and_types_by_node,
        'subscription': client.node.get_subscriber_names_and_types_by_node,
        'service': client.node.get_service_names_and_types_by_node,
        'action': partial(get_action_server_names_and_types_by_node, client.node),
    }
    return {
        (kind, name, types[0])
        for kind, names in ask.items()
        for name, types in names(node, '/')
        if '/_action/' not in name  # what an action is made of
    }


#: Topics that are there only while the parameter ``rviz_clicks`` says so.
CLICKS = {'/initialpose', '/goal_pose'}


@pytest.mark.parametrize('node', ['hnr_planner', 'map_source'])
def test_pages_and_graph_name_the_same(client: Client, node: str) -> None:
    until(lambda: node in client.node.get_node_names(), f'{node} in the graph')
    usual = {entry for entry in documented(node) if entry[1] not in CLICKS}
    assert in_graph(client, node) == usual
    if node == 'hnr_planner':
        client.set_parameters(rviz_clicks=True)
        until(lambda: in_graph(client, node) == documented(node), 'the topics of clicks')
        client.set_parameters(rviz_clicks=False)
        until(lambda: in_graph(client, node) == usual, 'an end of clicks')


def test_index_names_every_page() -> None:
    linked = set(re.findall(r'\((\w+)\.md\)', INDEX))
    assert linked == set(PAGES)
    for target in re.findall(r'\]\(([^)#]+)\)', ''.join(PAGES.values())):
        assert (ROOT / 'msg_docs' / target).exists(), target


def test_index_names_every_type() -> None:
    for link, _, _, types in rows(INDEX)[2:]:
        page = link.split(']')[0].removeprefix('[')
        for kind in re.findall(r'\w+/\w+/\w+', types):
            assert kind in PAGES[page], (page, kind)


@pytest.mark.parametrize('page', PAGES)
def test_every_page_has_an_example(page: str) -> None:
    (example,) = re.findall(r'## Try it\n.*?```bash\n(.*?)```', PAGES[page], re.DOTALL)
    assert all(line.startswith('ros2 ') for line in example.splitlines())


def examples(command: str) -> list[list[str]]:
    """Return the words of every example line that starts with a command."""
    lines = re.findall(rf'^{command} (.*)$', '\n'.join(PAGES.values()), re.MULTILINE)
    return [shlex.split(line) for line in lines]


TYPES = {
    'geometry_msgs/msg/PoseStamped': PoseStamped,
    'geometry_msgs/msg/PoseWithCovarianceStamped': PoseWithCovarianceStamped,
    'nav_msgs/msg/OccupancyGrid': OccupancyGrid,
    'nav_msgs/srv/GetPlan': GetPlan,
    'nav_msgs/srv/GetMap': GetMap,
    'std_srvs/srv/Trigger': Trigger,
}


def fill(message: Any, values: dict[str, Any]) -> Any:
    """Set fields of a message from what the example says, as the command line does."""
    for name, value in values.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        elif isinstance(value, list) and isinstance(value[0], dict):
            setattr(message, name, [fill(PoseStamped(), item) for item in value])
        elif isinstance(value, list):
            setattr(message, name, array('b', value))
        else:
            setattr(message, name, value)
    return message


NEED_A_REGION = {f'/hnr_planner/plan_kinodynamic_{name}' for name in ('hit_and_run', 'rrt')}


def test_service_examples_work(client: Client) -> None:
    called = set()
    for name, kind, *fields in examples('ros2 service call'):
        if 'odom' in str(fields) or 'nav2_msgs' in kind:
            continue  # needs more than the wheels of ROS, see the tests of frames and of Nav2
        if name in NEED_A_REGION:
            continue  # needs another parameter, see the tests of motions
        service = TYPES[kind]
        request = fill(service.Request(), yaml.safe_load(fields[0]) if fields else {})
        answer = client.call(service, name, request)
        called.add(name)
        if service is GetPlan:
            assert len(answer.plan.poses) > 10
            assert client.outcome_of(answer.plan)[0] is Outcome.SOLVED
        elif service is GetMap:
            assert answer.map.info.width > 100
        else:
            assert answer.success
    assert called == {'/map_source/map', '/hnr_planner/cancel', '/hnr_planner/sample'} | {
        f'/hnr_planner/plan{suffix}'
        for suffix in ('', '_rrt', '_hit_and_run', '_kinodynamic_connect')
    }


def test_echo_examples_name_real_topics(client: Client) -> None:
    published = {name for kind, name, _ in documented('hnr_planner') if kind == 'publisher'}
    echoed = {words[0] for words in examples('ros2 topic echo')}
    assert echoed == published - BY_ITSELF


def publishing_example(client: Client, topic: str) -> None:
    """Publish what the example says to whoever listens."""
    (words,) = (words for words in examples('ros2 topic pub') if words[-3] == topic)
    kind = TYPES[words[-2]]
    qos = LATCHED if 'transient_local' in words else MANY
    publisher = client.node.create_publisher(kind, f'/{topic}', qos)
    until(publisher.get_subscription_count, f'a subscription to {topic}')
    publisher.publish(fill(kind(), yaml.safe_load(words[-1])))


def test_examples_of_clicks_work(client: Client, planner: NodeProcess) -> None:
    client.set_parameters(rviz_clicks=True)
    publishing_example(client, 'initialpose')
    planner.wait_for('the start is')
    answered = len(client.outcomes)
    publishing_example(client, 'goal_pose')
    until(lambda: len(client.outcomes) > answered, 'the outcome of a click')
    assert read_outcome(client.outcomes[-1])[0] is Outcome.SOLVED
    client.set_parameters(rviz_clicks=False)


def test_parameter_examples_work(client: Client) -> None:
    for node, name, value in examples('ros2 param set'):
        (answer,) = client.set_parameters(node, **{name: yaml.safe_load(value)})
        assert answer.successful, answer.reason


def test_page_of_outcomes_names_them_all(client: Client) -> None:
    """Names and values, on the page and in a real message."""
    page = PAGES['outcome']
    assert [cells[0] for cells in rows(page) if cells[0].isupper()] == [o.name for o in Outcome]
    until(lambda: client.outcomes, 'an outcome')
    values = {item.key for item in client.outcomes[-1].status[0].values}
    named = {name for cells in rows(page) for name in re.findall(r'[a-z_]+', cells[0])}
    assert values <= named


def test_example_of_keepout_zones_works(client: Client, planner: NodeProcess) -> None:
    publishing_example(client, 'keepout')
    planner.wait_for('keepout mask from keepout received')
    assert (
        client.outcome_of(client.plan(pose(3.0, 2.0), pose(6.0, 5.5)))[0] is Outcome.INVALID_GOAL
    )


def test_example_of_a_map_works(client: Client, planner: NodeProcess) -> None:
    """Stands last: it replaces the map of the other examples."""
    publishing_example(client, 'map')
    planner.wait_for('3 x 2 cells of 1 m')
    published = {words[-3] for words in examples('ros2 topic pub')}
    assert published == {'map', 'map_updates', 'keepout', 'initialpose', 'goal_pose'}
