"""Run the demo, from the map to the picture."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import json
from pathlib import Path
import sys
from tempfile import TemporaryDirectory
import time

from hnr_planner.demo.answer import ALGORITHMS, Answer
from hnr_planner.demo.check import Check, check_path
from hnr_planner.demo.processes import free_domain, Interruptions, ProcessError, Processes, Screen
from hnr_planner.demo.report import draw, table
from hnr_planner.demo.scene import choose_scene, Scene
import numpy as np

#: Time limit of the planner for each request [s].
TIME_LIMIT = 10.0
#: Seed of the searches.
SEED = 2016
#: Time for the nodes to start [s].
READY_WITHIN = 180.0
#: Exit codes.
DONE, FAILED, INTERRUPTED = 0, 1, 130


def run_demo(map_file: Path, out: Path, *, keep: bool = False) -> int:
    """
    Run the demo and return its exit code.

    Parameters
    ----------
    map_file : Path
        The map, .yaml or .map.
    out : Path
        The picture to write.
    keep : bool
        Leave the nodes running until Ctrl-C, and print example calls for them.

    Returns
    -------
    int
        0 for success, 1 when a request, a check or a process failed (a line on stderr says which),
        130 when interrupted.

    Raises
    ------
    MapFileError, SceneError
        When the map cannot be read, or has too little free space for a request.

    """
    screen, interruptions = Screen(), Interruptions()
    with interruptions.caught():
        try:
            screen.say('demo', f'reading {map_file}')
            scene = choose_scene(map_file)
            _introduce(scene, screen)
            with _nodes(scene, screen, interruptions) as (processes, domain, folder):
                answers = _ask(scene, processes, folder)
                well = _show(scene, answers, out)
                if keep:
                    _print_calls(scene, domain)
                    _wait_for_interruption(processes)
        except KeyboardInterrupt:
            print('interrupted: every process has been ended', file=sys.stderr)
            return INTERRUPTED
        except ProcessError as error:
            print(f'failed: {error}', file=sys.stderr)
            return FAILED
    return DONE if well else FAILED


def _introduce(scene: Scene, screen: Screen) -> None:
    """Print the map's size, the robot's radius, start and goal."""
    rows, cols = scene.occupancy.data.shape
    resolution = scene.occupancy.resolution
    screen.say(
        'demo',
        f'{cols} x {rows} cells of {resolution:g} m, robot radius {scene.robot_radius:g} m',
    )
    (ax, ay), (bx, by) = scene.start, scene.goal
    screen.say('demo', f'from ({ax:.2f}, {ay:.2f}) to ({bx:.2f}, {by:.2f}) m')


@contextmanager
def _nodes(
    scene: Scene, screen: Screen, interruptions: Interruptions
) -> Iterator[tuple[Processes, int, Path]]:
    """
    Run the map source and the planner in the block; end them at its end.

    Yield the processes, their ROS domain, and a temporary folder for messages. ProcessError is
    raised where a process had to be killed, or ended with an error.
    """
    domain = free_domain()
    with TemporaryDirectory(prefix='hnr_planner_demo_') as name:
        folder = Path(name)
        processes = Processes(screen, interruptions, domain, folder / 'log')
        screen.say('demo', f'starting the map source and the planner in ROS domain {domain}')
        try:
            processes.start('map', 'hnr_planner.ros.node.map_node', _map_arguments(scene))
            processes.start(
                'planner', 'hnr_planner.ros.node.planner_node', _planner_arguments(scene)
            )
            yield processes, domain, folder
        finally:
            complaints = processes.stop()
        if complaints:
            raise ProcessError('; '.join(complaints))


def _map_arguments(scene: Scene) -> list[str]:
    """
    Return the ROS arguments of the map source.

    The name of the map file is in quotes, so that ROS takes any name for a string.
    """
    file = json.dumps(str(scene.file), ensure_ascii=False)
    return ['--ros-args', '-p', f'yaml_filename:={file}']


def _planner_arguments(scene: Scene) -> list[str]:
    """Return the ROS arguments of the planner: robot radius [m], time limit [s] and seed."""
    parameters = {
        'robot_radius': scene.robot_radius,
        'time_limit': TIME_LIMIT,
        'seed': SEED,
    }
    pairs = [f'{name}:={value!r}' for name, value in parameters.items()]
    return ['--ros-args', *(word for pair in pairs for word in ('-p', pair))]


def _ask(scene: Scene, processes: Processes, folder: Path) -> dict[str, Answer]:
    """
    Let the client request a path by each algorithm; return the answers by algorithm.

    ``folder`` is where the client writes the answers. ProcessError is raised where the client
    fails.
    """
    ends = [word for name in ('start', 'goal') for word in _point_argument(scene, name)]
    limits = ['--ready-within', str(READY_WITHIN), '--answer-within', str(2 * TIME_LIMIT)]
    processes.start('client', 'hnr_planner.demo.client', [*ends, '--out', str(folder), *limits])
    processes.wait_for(
        'client', READY_WITHIN + 5 * TIME_LIMIT, 'waiting for the planner to answer ...'
    )
    return {algorithm: Answer.read(folder, algorithm) for algorithm in ALGORITHMS}


def _point_argument(scene: Scene, name: str) -> list[str]:
    """Return the client's arguments for the start or the goal, with all digits."""
    return [f'--{name}', *(repr(value) for value in getattr(scene, name))]


def _show(scene: Scene, answers: dict[str, Answer], out: Path) -> bool:
    """
    Check the answers, print the table and write the picture; return whether all is well.

    It is False where an outcome is other than SOLVED, or a check found a fault; each is printed as
    one line on stderr.
    """
    checks = {}
    for algorithm, answer in answers.items():
        checks[algorithm] = check_path(
            answer.path,
            scene.occupancy,
            scene.start,
            scene.goal,
            robot_radius=scene.robot_radius,
        )
    print(f'\n{table(answers, checks)}\n')
    draw(scene, answers, out)
    print(f'picture: {out}')
    problems = [
        f'{algorithm}: {problem}'
        for algorithm, answer in answers.items()
        for problem in _problems(answer, checks[algorithm])
    ]
    for problem in problems:
        print(f'failed: {problem}', file=sys.stderr)
    return not problems


def _problems(answer: Answer, check: Check) -> list[str]:
    """Return descriptions of the faults of an answer and of its check; empty for a good answer."""
    if answer.outcome != 'SOLVED':
        return [f'{answer.outcome}: {answer.values.get("why", "no reason was given")}']
    problems = list(check.problems)
    if not np.array_equal(answer.response, answer.path):
        problems.append("the topic's path is not the path of the service's answer")
    if len(answer.samples) == 0:
        problems.append('no samples were published')
    return problems


def _print_calls(scene: Scene, domain: int) -> None:
    """Print example calls for the running nodes, in their ROS domain."""
    start, goal = (
        f'{{header: {{frame_id: map}}, pose: {{position: {{x: {x:.2f}, y: {y:.2f}}}}}}}'
        for x, y in (scene.start, scene.goal)
    )
    latched = '--once --qos-durability transient_local --qos-reliability reliable'
    ends = ' '.join(
        f'--{name} {x:.2f} {y:.2f}'
        for name, (x, y) in (('start', scene.start), ('goal', scene.goal))
    )
    print(
        f"""
The nodes stay up; Ctrl-C ends them. In another terminal, with ROS 2 Jazzy sourced:

  export ROS_DOMAIN_ID={domain} ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
  ros2 service call /hnr_planner/plan nav_msgs/srv/GetPlan "{{start: {start}, goal: {goal}}}"
  ros2 topic echo {latched} /hnr_planner/outcome
  ros2 topic echo {latched} --field poses /hnr_planner/path
  ros2 topic echo {latched} --no-arr /hnr_planner/samples
  ros2 param set /hnr_planner robot_radius 0.1
  ros2 service call /hnr_planner/cancel std_srvs/srv/Trigger

Without the ros2 command, the demo's own client asks:

  export ROS_DOMAIN_ID={domain} ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
  {sys.executable} -m hnr_planner.demo.client {ends}
""",
        flush=True,
    )


def _wait_for_interruption(processes: Processes) -> None:
    """Wait for Ctrl-C, and return after it; raise ProcessError when a node has ended."""
    try:
        while True:
            processes.check_alive()
            time.sleep(0.2)
    except KeyboardInterrupt:
        print('ending the nodes', flush=True)
