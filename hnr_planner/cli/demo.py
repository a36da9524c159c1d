"""The command ``demo``: real ROS nodes plan on a real map, and a picture shows it."""

from __future__ import annotations

import argparse
from importlib.util import find_spec
from pathlib import Path

from hnr_planner.cli.arguments import BadInputError, keep_map_files, picture

EPILOG = """\
The demo starts a map source and the planning node as processes of their own, asks for a path by
Hit-and-Run and for one by RRT, receives paths and samples in one more process, checks the paths
against the map file, prints a table and draws the picture. It speaks DDS inside this machine only,
in a ROS domain of its own, and leaves no process behind.

examples:
  python -m hnr_planner demo
  python -m hnr_planner demo --map warehouse.yaml --out picture.png
  python -m hnr_planner demo --keep

Exit code 0: all went well. 1: a plan failed, a check failed or a process died. 2: the map is not
usable, or ROS 2 is not there.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        'demo',
        help='plan with real ROS nodes and draw what they did',
        description='Plan with real ROS 2 nodes, check the paths and draw them.',
        epilog=EPILOG,
    )
    parser.add_argument(
        '--map',
        metavar='FILE',
        help='a map of your own, .yaml or .map: start and goal are chosen far apart in it; '
        'default the office that comes with the package',
    )
    parser.add_argument(
        '--keep',
        action='store_true',
        help='leave the nodes running until Ctrl-C, and print calls to try',
    )
    parser.add_argument(
        '--out',
        type=picture,
        default=Path('demo.png'),
        metavar='FILE.png',
        help='the picture; default demo.png',
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the demo and return the exit code."""
    if find_spec('rclpy') is None:
        raise BadInputError(
            'the demo needs ROS 2 (rclpy): source a ROS 2 Jazzy, or `make install` in a clone'
        )
    from hnr_planner.demo.run import run_demo
    from hnr_planner.demo.scene import office_file

    map_file = Path(arguments.map).absolute() if arguments.map else office_file()
    keep_map_files(map_file, arguments.out)
    return run_demo(map_file, arguments.out, keep=arguments.keep)
