"""The command ``demo``: real ROS nodes plan on a map, and a picture shows the result."""

from __future__ import annotations

import argparse
from importlib.util import find_spec
from pathlib import Path

from hnr_planner.cli.argument_types import picture
from hnr_planner.cli.arguments import add_command, BadInputError, keep_map_files
from hnr_planner.cli.extras import require_extra

EPILOG = """\
The demo starts a map source and the planning node as separate processes, requests a path by
Hit-and-Run and one by RRT, receives paths and samples in a third process, checks the paths against
the map file, prints a table and draws the picture. It uses DDS inside this machine only, in a ROS
domain of its own, and leaves no process behind.

examples:
  %(prog)s
  %(prog)s --map warehouse.yaml --out picture.png
  %(prog)s --keep

Exit code 0: every request and check succeeded. 1: a request or a check failed, or a process died.
2: the map is not usable, or ROS 2 or matplotlib is not installed.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``demo`` to the command line."""
    parser = add_command(
        commands,
        'demo',
        run,
        summary='plan with real ROS nodes and draw the result',
        description='Plan with real ROS 2 nodes, check the paths and draw them.',
        epilog=EPILOG,
    )
    parser.add_argument(
        '--map',
        metavar='FILE',
        help='another map, .yaml or .map; start and goal are chosen far apart in it; '
        'default the office map of the package',
    )
    parser.add_argument(
        '--keep',
        action='store_true',
        help='leave the nodes running until Ctrl-C, and print example calls',
    )
    parser.add_argument(
        '--out',
        type=picture,
        default=Path('demo.png'),
        metavar='FILE.png',
        help='the picture; default demo.png',
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the demo and return the exit code; BadInputError names what is not installed."""
    if find_spec('rclpy') is None:
        raise BadInputError(
            'the demo needs ROS 2 (rclpy): source a ROS 2 Jazzy, or `make install` in a clone'
        )
    require_extra('plot', 'the demo')
    from hnr_planner.demo.run import run_demo
    from hnr_planner.demo.scene import office_file

    map_file = Path(arguments.map).absolute() if arguments.map else office_file()
    keep_map_files(map_file, arguments.out)
    return run_demo(map_file, arguments.out, keep=arguments.keep)
